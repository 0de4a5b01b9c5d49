"""Where the mechanics of rigid constraints allows no jump and no kink.

A row of a constraint, the place of a body and a declared speed that bend or jump ask for a jump of
the speeds, which is an impact: no equation of motion holds it.  An energy that jumps is a force
without bound that its gradient, zero nearly everywhere, does not show.  Forces may jump.

An angle, `atan2`, jumps by a turn on its cut.  In an energy that is a warning: many a motion never comes
there, and one that does is seen by its balance of energy.  A row or a place is not, and sine and cosine
say the same.  A row at a tip, as of a cone, is a warning too.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence

from lagc.diagnostics.faults import Fault, Refused, Span
from lagc.mechanics.formulation.states import States
from lagc.mechanics.lint.discontinuities import Break, Ranks, Way, find_break, ranked
from lagc.mechanics.lint.outlines import Outlines
from lagc.mechanics.lint.tips import find_tip
from lagc.semantics.model import Body, Constraint, Lagrangian, Potential
from lagc.symbolic.graph import Node

_ANGLE = "let the angle be a coordinate `a`, with `y*cos(a) = x*sin(a)`"


def refuse_breaks(states: States, breaking: Collection[Node]) -> tuple[Fault, ...]:
    """Warnings: LAG0425 of energies that jump on the cut of an angle, LAG0426 of rows without a gradient at a
    point.

    Raises Refused: LAG0421 a constraint with a kink or jump, LAG0422 a body whose place or frame has
    one, LAG0423 an energy that jumps, LAG0424 a declared speed that does."""
    spelt = () if states.plain else states.spelt.values()
    above = set(breaking)  # with all that is made of these
    for node in states.graph.nodes:
        if not above.isdisjoint(node.args):
            above.add(node)
    smooth = above.isdisjoint(spelt)
    positions = ranked(states.q)
    place = ranked([*states.q, states.model.time])
    rates = ranked([*states.rates, *(speed.symbol for speed in states.model.speeds)])
    everything = ranked([*place, *rates])
    outlines = Outlines(states, list(everything)) if smooth else None
    quiet: set[Way] = set()  # of bodies along a chain each has the roots of those before it

    def find(nodes: Sequence[Node], leaves: Ranks, slopes: bool = True) -> Break | None:
        if smooth and above.isdisjoint(nodes):
            return None
        outline = outlines.of(nodes) if outlines else None
        if outline and not find_break(states, outline.nodes, ranked(outline.leaves), slopes):
            return None
        return find_break(states, nodes, leaves, slopes, quiet=quiet)

    def find_in_row(c: Constraint) -> Fault | None:
        if smooth and above.isdisjoint(c.residuals):
            return None
        outline = outlines.of(c.residuals) if outlines else None
        if outline and not _broken_row(states, c, outline.nodes, ranked(outline.leaves), outline.leaves):
            return None
        return _broken_row(states, c, c.residuals, everything, states.q)

    faults: list[Fault | None] = []
    for constraint in states.model.constraints:
        faults.append(find_in_row(constraint))
    for body in states.model.bodies:
        axes = [x for row in body.frame.axes for x in row] if body.frame is not None else []
        faults.append(_bent_body(body, find([*body.position, *axes], place)))
    for action in states.model.actions:
        if isinstance(action, Potential):
            torn = find([action.energy], positions, slopes=False)
            faults.append(_torn_energy(action.name, action.span, torn))
        elif isinstance(action, Lagrangian):
            for broken in (find([action.function], place, slopes=False), find([action.function], rates)):
                faults.append(_torn_energy(action.name, action.span, broken))
    for speed in states.model.speeds:
        torn = find([speed.expression], place, slopes=False)
        faults.append(_torn_speed(speed.name, speed.span, torn))
    found = list(dict.fromkeys(fault for fault in faults if fault is not None))
    if any(fault.severity == "error" for fault in found):
        raise Refused(found)
    return tuple(found)


def _broken_row(
    states: States, c: Constraint, residuals: Sequence[Node], leaves: Ranks, positions: Sequence[Node]
) -> Fault | None:
    broken = find_break(states, residuals, leaves, True, rows=True)
    return _bent_row(c, broken) if broken else _pointed(c, find_tip(states, residuals, leaves, positions))


def jumps_in_time(states: States, energy: Node) -> bool:
    """Whether `energy` jumps at certain times: what it does then is no change of a stored energy."""
    return find_break(states, [energy], ranked([states.model.time]), slopes=False) is not None


# -- what is said -----------------------------------------------------------------------------


def _bent_row(c: Constraint, found: Break) -> Fault:
    remedy = "write it with a function whose slope does not jump, or let a force act in its place"
    return Fault(
        "LAG0421",
        f"the constraint `{c.name}` has a {found.kind} where {found.where}: the speeds would jump there",
        c.span,
        remedy=_ANGLE if found.cut else remedy,
    )


def _pointed(c: Constraint, tip: str | None) -> Fault | None:
    if tip is None:
        return None
    return Fault(
        "LAG0426",
        f"the constraint `{c.name}` has no gradient where {tip}: no motion is determined through there",
        c.span,
        severity="warning",
        remedy="see that the motion stays away from there, or write the surface with a rounded tip",
    )


def _bent_body(body: Body, found: Break | None) -> Fault | None:
    if found is None:
        return None
    return Fault(
        "LAG0422",
        f"the place of `{body.name}` has a {found.kind} where {found.where}: its velocity would jump there",
        body.span,
        remedy=_ANGLE if found.cut else "write it with a function whose slope does not jump",
    )


def _torn_energy(name: str, span: Span, found: Break | None) -> Fault | None:
    if found is None:
        return None
    if found.cut:
        return Fault(
            "LAG0425",
            f"the energy `{name}` jumps where {found.where}: no motion can be followed through there",
            span,
            severity="warning",
            remedy="let the angle be a coordinate, or turn the cut to where the motion does not come",
        )
    return Fault(
        "LAG0423",
        f"the energy `{name}` has a {found.kind} where {found.where}: no finite force goes with it",
        span,
        remedy="let it change over a distance, or write the forces that are meant with `force`",
    )


def _torn_speed(name: str, span: Span, found: Break | None) -> Fault | None:
    if found is None:
        return None
    return Fault(
        "LAG0424",
        f"the speed `{name}` has a jump where {found.where}, though nothing moves faster there",
        span,
        remedy="declare a speed that changes with the motion alone",
    )
