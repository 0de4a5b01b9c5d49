"""Functions of events: indicators of relations and clauses, contacts, and guards of narrow terms.

**Narrow terms** are negligible for most of a motion, and large for a moment. These are exp, tanh and atan of
varying arguments, powers with varying exponents, and quotients by divisors that never vanish, as in a bell or
a smooth step. Each is scaled so that 1 is large.
"""

from collections.abc import Sequence, Set

from lagc.base.records import replace
from lagc.lowering.event_relations import EventRelation, deciding
from lagc.lowering.program import Function
from lagc.lowering.program_functions import made
from lagc.lowering.storage import STATE, Places
from lagc.mechanics.formulation.equations import EquationsOfMotion
from lagc.symbolic.derivative import gradient, tangent
from lagc.symbolic.enclosures import Ends, enclosures, intervals
from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.walk import depends, reachable, substitute, symbols


def relation_functions(natural: Places, along: Places, relations: Sequence[EventRelation]) -> list[Function]:
    """Return the functions of the relations, None if there are none: `modes` of the state alone;
    `indicators`, `indicator_rates` and, unless all belong to contacts, `own_modes` on given modes; `edges` of
    counted relations; `slopes` of those of time alone; `enclosure` of the others; `late` of those that
    accelerations or reactions decide, which are constants in the others."""
    if not relations:
        return []
    late = [relation for relation in relations if relation.late]
    one, zero = natural.graph.one, natural.graph.zero
    # Accelerations and reactions need the modes to be computed: indicators that depend on them are constants
    # here, and `late` evaluates them after the solution.
    relations = [replace(x, side=zero, own=one, natural=one) if x.late else x for x in relations]
    found = [_modes(natural, relations), _indicators(along, relations), _rates(along, relations)]
    # Contacts have their own laws for modes (complementarity). Only other relations need `own_modes`.
    if len(relations) > sum(1 + len(contact.slips) for contact in along.equations.contacts):
        found.append(_indicator_modes(along, relations))
    if any(relation.edges for relation in relations):
        found.append(_edges(along, relations))
    # Relations of time alone come first in the list; their crossing is computed by division with the slope
    # instead of being searched for.
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
    # All unknowns of the saddle-point system in one array: accelerations, multipliers, forces of contacts.
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


def _indicator_modes(along: Places, relations: Sequence[EventRelation]) -> Function:
    values = [relation.own for relation in relations]
    return made(
        along, "own_modes", along.state, (("e", values),), "the mode that each indicator gives", rare=True
    )


def _edges(along: Places, relations: Sequence[EventRelation]) -> Function:
    """Return the edges of relations that count; zeros for others."""
    zero = along.graph.zero
    values = [end for relation in relations for end in relation.edges or (zero, zero)]
    return made(along, "edges", ("modes",), (("e", values),), "edges of the modes", rare=True)


def _rates(along: Places, relations: Sequence[EventRelation]) -> Function:
    """Return the function de/dt for given rates of the state."""
    equations, graph = along.equations, along.graph
    states = [*equations.q, *equations.v]
    rates = [graph.symbol("change", str(k)) for k in range(len(states))]
    # The chain rule in forward mode along (1, q', v'), with rates as inputs: the caller has them already.
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
    # Interval arithmetic, done symbolically: an indicator whose enclosure in the box of a step excludes zero
    # cannot have changed sign in it, not even twice (R. E. Moore, *Interval Analysis*, 1966).
    ends = enclosures(along.graph, [relation.side for relation in others], boxes)
    values = [end for pair in ends for end in pair]
    inputs = ("p", "modes", "box")
    return made(more, "enclosure", inputs, (("e", values),), "bounds of indicators in a box", rare=True)


def boxed(along: Places) -> tuple[Places, dict[Node, Ends]]:
    """Return the places with the ends of a box of time and states: all lower ends, then all upper ends."""
    equations, graph = along.equations, along.graph
    leaves = [equations.time, *equations.q, *equations.v]
    arrays = dict(along.arrays)
    boxes: dict[Node, Ends] = {}
    for k, leaf in enumerate(leaves):
        low, high = graph.symbol("least", str(k)), graph.symbol("largest", str(k))
        boxes[leaf] = low, high
        arrays[low], arrays[high] = ("box", k), ("box", len(leaves) + k)
    # Discrete variables have one value in a box.
    for k, variable in enumerate(equations.model.discretes):
        arrays[variable.symbol] = ("box", 2 * len(leaves) + k)
    return replace(along, arrays=arrays), boxes


def in_boxes(along: Places, found: Sequence[Node], name: str, about: str) -> list[Function]:
    """Return the functions of the values of `nodes` and of their bounds in a box of time and states; none
    without nodes."""
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
    # Modes and discrete variables are the only things that events change: a condition without them is decided
    # by inputs, before the run.
    deciding = {*(relation.mode for relation in relations), *(discretes if relations else ())}
    states = {*equations.q, *equations.v, *discretes}
    pairs = [
        # Clauses of both forms of the equations are dropped in pairs, as they share numbers.
        [replace(when, changes=tuple([pair for pair in when.changes if pair[0] in states])) for when in both]
        for both in zip(equations.whens, moving.whens)
        if deciding & symbols([both[1].condition])
    ]
    return (
        replace(equations, whens=tuple([when for when, _ in pairs])),
        replace(moving, whens=tuple([when for _, when in pairs])),
    )


def whens(at: Places, along: Places) -> list[Function]:
    """Return `holds` on the branches that modes tell, and `reinit` by the state alone; none without
    clauses."""
    graph, clauses = along.graph, along.equations.whens
    if not clauses:
        return []
    # A condition is one node of truth; C wants a real that a threshold can be compared with.
    truths = [graph.select(when.condition, graph.one, graph.zero) for when in clauses]
    described = "1 where the condition of a `when` holds"
    found = [made(along, "holds", along.state, (("c", truths),), described, rare=True)]
    values = [value for when in clauses for _, value in when.changes]
    if values:
        described = "what states are when conditions become true"
        found.append(made(at, "reinit", STATE, (("r", values),), described, rare=True))
    return found


def contact_functions(at: Places, along: Places) -> list[Function]:
    """Return `gaps`, `contact_rows`, `restitutions` and `frictions`, none without contacts.
    `at` is the state alone, `along` the branches of a run."""
    contacts = at.equations.contacts
    if not contacts:
        return []
    labels = [contact.label for contact in contacts]
    gaps = [contact.gap for contact in contacts]
    laws = [contact.restitution for contact in contacts]
    # Two coefficients for each contact, sliding and sticking; smooth ones have zeros.
    frictions = [
        node for contact in along.equations.contacts for node in (contact.frictions or (at.graph.zero,) * 2)
    ]
    made_of = (("f", frictions),)
    with_friction = any(contact.slips for contact in contacts)
    return [
        *(
            [made(along, "frictions", along.state, made_of, "friction of each contact")]
            if with_friction
            else []
        ),
        made(at, "gaps", STATE, (("g", gaps),), "gap of each contact", labels, rare=True),
        _rows(along),
        *([_normals(along)] if any(contact.normals for contact in contacts) else []),
        made(at, "restitutions", STATE, (("r", laws),), "restitution of each contact", labels, rare=True),
    ]


def _rows(along: Places) -> Function:
    """Return the gradient of each row by the speeds, its rate, and its acceleration where v' = 0."""
    equations, zero = along.equations, along.graph.zero
    contacts, columns = equations.contacts, range(len(equations.v))
    # Dense rows: the dimension of the contact problem is small, and Delassus' matrix G M^-1 G^T fills them
    # anyway.
    gradients = [own.get(j, zero) for contact in contacts for own in contact.jacobians for j in columns]
    rates, biases = list[Node](), list[Node]()
    for contact in contacts:
        # Row u = R v + (terms of time), its derivative R v' + bias: normal direction first, then the slip of
        # each contact.
        rates += [contact.rate, *(slip.rate for slip in contact.slips)]
        biases += [contact.bias, *(slip.bias for slip in contact.slips)]
    parts = (("R", gradients), ("u", rates), ("bias", biases))
    return made(along, "contact_rows", along.state, parts, "rows of the contacts")


def _normals(along: Places) -> Function:
    """Return the components of the normal forces of two-sided contacts, sums of accelerations, multipliers
    and forces of contacts: the derivatives by these, and the rest."""
    equations, graph = along.equations, along.graph
    nodes = [node for contact in equations.contacts for node in contact.normals]
    known = [*equations.a, *equations.lam, *(f for contact in equations.contacts for f in contact.forces)]
    found: list[Node] = []
    # The forces are linear in accelerations, multipliers and contact forces: N = sum of d N/d x * x + N(0),
    # exact with derivatives at any point.
    for node in nodes:
        slopes = gradient(graph, {node: graph.one}, known)
        found += [slopes.get(x, graph.zero) for x in known]
    rest = substitute(graph, nodes, dict.fromkeys(known, graph.zero))
    return made(along, "normals", along.state, (("N", found), ("bias", rest)), "normal forces")


_STEEP = ("exp", "tanh", "atan")
_MOST = 10_000  # narrow terms; of more, none is looked at


def features(equations: EquationsOfMotion) -> tuple[Node, ...]:
    # Functions with a narrow transition can hide between the evaluations of a step: exponentials,
    # saturations, powers with a varying exponent, and quotients near the smallest value of the divisor.
    changing = [equations.time, *equations.q, *equations.v]
    moving = depends(deciding(equations), changing)
    moved = sorted(moving, key=lambda node: node.index)
    found = [node for node in moved if node.op in _STEEP or (node.op == "pow" and node.args[1] in moving)]
    graph = equations.graph
    below = [pair for node in moved for pair in divisors(graph, node, moving)]
    # Without a box the enclosure is global: a divisor with a positive least value never vanishes, but may
    # come near it.
    ranges = intervals([base for base, _ in below], {})
    for base, divides in below:
        least = ranges[base][0]
        # least/base is 1 at the closest approach and falls on both sides: a feature as steep as the quotient.
        if least > 0.0:
            found.append(graph.select(divides, graph.div(graph.const(least), base), graph.one))
    found = [node for node in dict.fromkeys(found) if not node.is_const]
    return tuple(found) if len(found) <= _MOST else ()


def divisors(graph: Graph, node: Node, moving: Set[Node]) -> list[tuple[Node, Node]]:
    """Return the varying bases of negative powers, each with the condition that the exponent, which may be a
    parameter, is negative."""
    if node.op == "mul":
        return [(base, graph.one) for base, e in zip(node.args, node.value) if e < 0 and base in moving]
    if node.op == "pow" and node.args[0] in moving:
        base, exponent = node.args
        # The sign of a constant exponent is known; one of a parameter is compared when the function is
        # evaluated.
        below = graph.one if exponent in moving else graph.binary("lt", exponent, graph.zero)
        return [] if below.is_zero else [(base, below)]
    return []


def poles(equations: EquationsOfMotion) -> tuple[Node, ...]:
    """Return the divisors, each once and without a root around it; 1 on branches that do not divide."""
    roots, graph = deciding(equations), equations.graph
    moving = depends(roots, [equations.time, *equations.q, *equations.v])
    found: dict[Node, list[tuple[Node, Node]]] = {}  # with the nodes that divide by them, and when these do
    for node in reachable(roots):
        for base, divides in divisors(graph, node, moving):
            # sqrt(u) vanishes where u does; u itself changes sign there, which is easier to see.
            found.setdefault(base.args[0] if base.op == "sqrt" else base, []).append((node, divides))
    ranges = intervals(list(found), {})
    # Divisors that can be shown never to vanish are no poles.
    near = [base for base in found if ranges[base][0] <= 0.0 <= ranges[base][1]]
    if not near or len(near) > _MOST:
        return ()
    asked = _conditions_of_use(graph, roots)
    return tuple([
        _where(graph, base, [_conjunction(graph, asked[node], divides) for node, divides in found[base]])
        for base in near
    ])  # fmt: skip


def _conditions_of_use(graph: Graph, roots: Sequence[Node]) -> dict[Node, Node]:
    """Return, for each node, the condition under which the values of `roots` depend on it."""
    # Backwards through the graph, users before operands, so that a node's own condition is complete before it
    # is passed on to its operands.
    asked = dict.fromkeys(roots, graph.one)
    for node in reversed(reachable(roots)):
        for k, below in enumerate(node.args):
            own = asked[node]
            # The branches of a choice are used only while its condition has their value; the condition itself
            # is always used.
            if node.op == "select" and k > 0:
                branch = node.args[0] if k == 1 else graph.logical_not(node.args[0])
                own = _conjunction(graph, own, branch)
            known = asked.get(below)
            if known is not None and own is not known:
                # Several users: used if any of them is. `1 or x` is 1 at once, which keeps conditions short.
                own = graph.one if graph.one in (own, known) else graph.binary("or", own, known)
            asked[below] = own
    return asked


def _conjunction(graph: Graph, x: Node, y: Node) -> Node:
    if graph.one in (x, y):
        return y if x is graph.one else x
    return graph.binary("and", x, y)


def _where(graph: Graph, base: Node, conditions: Sequence[Node]) -> Node:
    if graph.one in conditions:
        return base
    found = conditions[0]
    for condition in conditions[1:]:
        found = graph.binary("or", found, condition)
    return graph.select(found, base, graph.one)
