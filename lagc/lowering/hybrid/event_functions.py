"""The functions by which a run tells that a condition changes, and when."""

from __future__ import annotations

from collections.abc import Sequence

from lagc.base.records import replace
from lagc.lowering.event_relations import EventRelation
from lagc.lowering.program import Function
from lagc.lowering.program_functions import made
from lagc.lowering.storage import STATE, Places
from lagc.mechanics.formulation.equations import EquationsOfMotion
from lagc.symbolic.derivative import tangent
from lagc.symbolic.enclosures import Ends, enclosures
from lagc.symbolic.graph import Node
from lagc.symbolic.walk import symbols


def relation_functions(natural: Places, along: Places, relations: Sequence[EventRelation]) -> list[Function]:
    """Return the functions of the relations, None if there are none: `modes` of the state alone;
    `indicators`, `indicator_rates` and, unless all belong to contacts, `own_modes` on given modes; `edges` of
    counted relations; `slopes` of those of time alone; `enclosure` of the others; `late` of those that
    accelerations or reactions decide, which are constants in the others."""
    if not relations:
        return []
    late = [relation for relation in relations if relation.late]
    one, zero = natural.graph.one, natural.graph.zero
    relations = [replace(x, side=zero, own=one, natural=one) if x.late else x for x in relations]
    found = [_modes(natural, relations), _indicators(along, relations), _rates(along, relations)]
    if len(relations) > sum(1 + len(contact.slips) for contact in along.equations.contacts):
        found.append(_own(along, relations))
    if any(relation.edges for relation in relations):
        found.append(_edges(along, relations))
    timed = [relation for relation in relations if relation.slope is not None]
    others = relations[len(timed) :]
    return [
        *found,
        *([_slopes(along, timed)] if timed else []),
        *([_enclosure(along, others)] if others else []),
        *([_late(along, late)] if late else []),
    ]


def _late(along: Places, late: Sequence[EventRelation]) -> Function:
    """Return the function of late indicators, and of the modes that they give, with the accelerations,
    multipliers and forces of contacts in `known`."""
    equations = along.equations
    given = [*equations.a, *equations.lam]
    arrays = {**along.arrays, **{node: ("known", k) for k, node in enumerate(given)}}
    for force in [force for contact in equations.contacts for force in contact.forces]:
        arrays[force] = ("known", len(given) + arrays[force][1])
    parts = (("e", [relation.side for relation in late]), ("m", [relation.own for relation in late]))
    inputs, about = (*along.state, "known"), "event indicators of accelerations and reactions, their modes"
    return made(replace(along, arrays=arrays), "late", inputs, parts, about, rare=True)


def _modes(natural: Places, relations: Sequence[EventRelation]) -> Function:
    values = [relation.natural for relation in relations]
    words = [relation.words for relation in relations]
    return made(natural, "modes", STATE, (("modes", values),), "mode of each relation", words)


def _indicators(along: Places, relations: Sequence[EventRelation]) -> Function:
    values = [relation.side for relation in relations]
    return made(along, "indicators", along.state, (("e", values),), "event indicators", rare=True)


def _own(along: Places, relations: Sequence[EventRelation]) -> Function:
    values = [relation.own for relation in relations]
    return made(
        along, "own_modes", along.state, (("e", values),), "the mode that each indicator gives", rare=True
    )


def _edges(along: Places, relations: Sequence[EventRelation]) -> Function:
    """Of those that count; else zeros."""
    zero = along.graph.zero
    values = [end for relation in relations for end in relation.edges or (zero, zero)]
    return made(along, "edges", ("modes",), (("e", values),), "edges of the modes", rare=True)


def _rates(along: Places, relations: Sequence[EventRelation]) -> Function:
    """de/dt with the rates of the state given."""
    equations, graph = along.equations, along.graph
    states = [*equations.q, *equations.v]
    rates = [graph.symbol("change", str(k)) for k in range(len(states))]
    seeds = {**dict(zip(states, rates)), equations.time: graph.one}
    values = tangent(graph, [relation.side for relation in relations], seeds)
    more = replace(along, arrays={**along.arrays, **{node: ("d", k) for k, node in enumerate(rates)}})
    inputs = (*along.state, "d")
    return made(more, "indicator_rates", inputs, (("e", values),), "rates of the event indicators", rare=True)


def _slopes(along: Places, timed: Sequence[EventRelation]) -> Function:
    values = [relation.slope for relation in timed if relation.slope is not None]
    return made(
        along, "slopes", ("p", "modes"), (("e", values),), "slopes of indicators of time alone", rare=True
    )


def _enclosure(along: Places, others: Sequence[EventRelation]) -> Function:
    """Return the function of the smallest and the largest values of the indicators in a box, given as the
    smallest and then the largest time and states."""
    more, boxes = boxed(along)
    ends = enclosures(along.graph, [relation.side for relation in others], boxes)
    values = [end for pair in ends for end in pair]
    inputs = ("p", "modes", "box")
    return made(more, "enclosure", inputs, (("e", values),), "bounds of indicators in a box", rare=True)


def boxed(along: Places) -> tuple[Places, dict[Node, Ends]]:
    """With the ends of a box of time and states: the least of all, then the largest."""
    equations, graph = along.equations, along.graph
    leaves = [equations.time, *equations.q, *equations.v]
    arrays = dict(along.arrays)
    boxes: dict[Node, Ends] = {}
    for k, leaf in enumerate(leaves):
        low, high = graph.symbol("least", str(k)), graph.symbol("largest", str(k))
        boxes[leaf] = low, high
        arrays[low], arrays[high] = ("box", k), ("box", len(leaves) + k)
    for k, variable in enumerate(equations.model.discretes):
        arrays[variable.symbol] = ("box", 2 * len(leaves) + k)
    return replace(along, arrays=arrays), boxes


def in_boxes(along: Places, found: Sequence[Node], name: str, about: str) -> list[Function]:
    """Their values, and what they keep to in a box of time and states; none where there are none."""
    if not found:
        return []
    places, boxes = boxed(along)
    ends = [end for pair in enclosures(along.graph, found, boxes) for end in pair]
    inputs = ("p", *along.state[3:], "box")
    bounds = "bounds of these in a box"
    return [
        made(along, f"{name}s", along.state, (("e", found),), about, rare=True),
        made(places, f"{name}_bounds", inputs, (("e", ends),), bounds, rare=True),
    ]


def changing(
    equations: EquationsOfMotion, moving: EquationsOfMotion, relations: Sequence[EventRelation]
) -> tuple[EquationsOfMotion, EquationsOfMotion]:
    """Return both without clauses that no motion reaches (inputs alone decide them) and without new values of
    states that were left out. `moving` are the frozen equations."""
    discretes = [variable.symbol for variable in equations.model.discretes]
    deciding = {*(relation.mode for relation in relations), *(discretes if relations else ())}
    states = {*equations.q, *equations.v, *discretes}
    pairs = [
        [replace(when, changes=tuple([pair for pair in when.changes if pair[0] in states])) for when in both]
        for both in zip(equations.whens, moving.whens)
        if deciding & symbols([both[1].condition])
    ]
    return (
        replace(equations, whens=tuple([when for when, _ in pairs])),
        replace(moving, whens=tuple([when for _, when in pairs])),
    )


def whens(at: Places, along: Places) -> list[Function]:
    """`holds` on the branches that modes tell, `reinit` by the state alone; none where no clause is."""
    graph, clauses = along.graph, along.equations.whens
    if not clauses:
        return []
    truths = [graph.select(when.condition, graph.one, graph.zero) for when in clauses]
    described = "1 where the condition of a `when` holds"
    found = [made(along, "holds", along.state, (("c", truths),), described, rare=True)]
    values = [value for when in clauses for _, value in when.changes]
    if values:
        described = "what states are when conditions become true"
        found.append(made(at, "reinit", STATE, (("r", values),), described, rare=True))
    return found
