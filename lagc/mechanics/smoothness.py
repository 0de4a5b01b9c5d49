"""Where the mechanics of rigid constraints allows no jump and no kink.

A row of a constraint, the place of a body and a declared speed that bend or jump ask for a jump of
the speeds, which is an impact: no equation of motion holds it.  An energy that jumps is a force
without bound that its gradient, zero nearly everywhere, does not show.  Forces may jump.

An angle, `atan2`, jumps by a turn on its cut.  In an energy that is a warning: many a motion never comes
there, and one that does is seen by its balance of energy.  A row or a place is not, and sine and cosine
say the same.
"""

from __future__ import annotations

from collections.abc import Sequence

from lagc.diagnostics.faults import Fault, Refused, Span
from lagc.expr.graph import Node
from lagc.meaning.model import Body, Constraint, Lagrangian, Potential
from lagc.mechanics.breaks import CORNERS, ENDS, POLES, STEPS, Break, find_break
from lagc.mechanics.states import States

_ANGLE = "let the angle be a coordinate `a`, with `y*cos(a) = x*sin(a)`"
_BREAKING = STEPS | CORNERS | POLES | ENDS


def refuse_breaks(states: States) -> tuple[Fault, ...]:
    """Warnings, LAG0425, of energies that jump on the cut of an angle.

    Raises Refused: LAG0421 a constraint with a kink or jump, LAG0422 a body whose place or frame has
    one, LAG0423 an energy that jumps, LAG0424 a declared speed that does."""
    if not any(node.op in _BREAKING for node in states.graph.nodes):
        return ()
    place = [*states.q, states.model.time]
    rates = [*states.rates, *(speed.symbol for speed in states.model.speeds)]
    faults: list[Fault | None] = []
    for constraint in states.model.constraints:
        broken = find_break(states, constraint.residuals, [*place, *rates], slopes=True, rows=True)
        faults.append(_bent_row(constraint, broken))
    for body in states.model.bodies:
        axes = [x for row in body.frame.axes for x in row] if body.frame is not None else []
        broken = find_break(states, [*body.position, *axes], place, slopes=True)
        faults.append(_bent_body(body, broken))
    for action in states.model.actions:
        if isinstance(action, Potential):
            faults.append(_torn_energy(action.name, action.span, _jump(states, action.energy, states.q)))
        elif isinstance(action, Lagrangian):
            faults.append(_torn_energy(action.name, action.span, _jump(states, action.function, place)))
            bent = find_break(states, [action.function], rates, slopes=True)
            faults.append(_torn_energy(action.name, action.span, bent))
    for speed in states.model.speeds:
        faults.append(_torn_speed(speed.name, speed.span, _jump(states, speed.expression, place)))
    found = list(dict.fromkeys(fault for fault in faults if fault is not None))
    if any(fault.severity == "error" for fault in found):
        raise Refused(found)
    return tuple(found)


def jumps_in_time(states: States, energy: Node) -> bool:
    """Whether `energy` jumps at certain times: what it does then is no change of a stored energy."""
    return _jump(states, energy, [states.model.time]) is not None


def _jump(states: States, node: Node, leaves: Sequence[Node]) -> Break | None:
    return find_break(states, [node], leaves, slopes=False)


# -- what is said -----------------------------------------------------------------------------


def _bent_row(c: Constraint, found: Break | None) -> Fault | None:
    if found is None:
        return None
    remedy = "write it with a function whose slope does not jump, or let a force act in its place"
    return Fault(
        "LAG0421",
        f"the constraint `{c.name}` has a {found.kind} where {found.where}: the speeds would jump there",
        c.span,
        remedy=_ANGLE if found.cut else remedy,
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
