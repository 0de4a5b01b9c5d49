"""Warnings if a constraint, a place, an energy or a declared speed jumps or has a kink.

The speeds would jump there, which is an impact. A motion may never get there, so the model is accepted, and a
clause `when` stops a run that does. Roots, quotients and angles are not examined: a run stops where a row has
no gradient or the energy is out of balance.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import NamedTuple

from lagc.diagnostics.faults import Fault, Span
from lagc.mechanics.formulation.equations import WhenEquations
from lagc.mechanics.formulation.states import States
from lagc.mechanics.lint.discontinuities import Break, find_break
from lagc.semantics.model import Lagrangian, Potential, When
from lagc.symbolic.graph import Node
from lagc.symbolic.walk import depends

_ROUND = "write it with a function whose slope does not jump"


class Cuts(NamedTuple):
    """Warnings, and the clauses that stop a run at a jump."""

    warnings: tuple[Fault, ...]
    whens: tuple[WhenEquations, ...]


def find_cuts(states: States, relations: Collection[Node]) -> Cuts:
    """Return warnings LAG0421 of constraints and LAG0422 of places with a jump or kink, LAG0423 of energies
    and LAG0424 of declared speeds with a jump; `relations` are the candidates."""
    model = states.model
    above = set(relations)
    for node in states.graph.nodes:
        if not above.isdisjoint(node.args):
            above.add(node)
    all_smooth = above.isdisjoint([] if states.plain else states.spelt.values())
    positions = list(states.q)
    place = [*positions, model.time]
    rates = [*states.rates, *(speed.symbol for speed in model.speeds)]
    warnings: list[Fault] = []
    stopping: list[tuple[Fault, Break]] = []

    def look(
        nodes: Sequence[Node],
        leaves: Sequence[Node],
        slopes: bool,
        code: str,
        what: str,
        remedy: str,
        span: Span,
    ) -> None:
        if all_smooth and above.isdisjoint(nodes):
            return
        found = find_break(states, nodes, leaves, slopes, rows=code == "LAG0421")
        if found is None:
            return
        message = f"{what} has a {found.kind} where {found.where}; a run that gets there stops"
        fault = Fault(code, message, span, remedy=remedy, severity="warning")
        if fault not in warnings:
            warnings.append(fault)
        stopping.append((fault, found))

    remedy = f"{_ROUND}, or let a force act in its place"
    in_rates = depends([x for c in model.constraints for x in c.residuals], rates)
    for c in model.constraints:
        for nonholonomic in (False, True):  # a kink is a jump of the forces
            rows = [x for x in c.residuals if (x in in_rates) == nonholonomic]
            leaves = [*place, *rates] if nonholonomic else place
            look(rows, leaves, not nonholonomic, "LAG0421", f"the constraint `{c.name}`", remedy, c.span)
    for body in model.bodies:
        axes = [x for row in body.frame.axes for x in row] if body.frame is not None else []
        what = f"the place of `{body.name}`"
        look([*body.position, *axes], place, True, "LAG0422", what, _ROUND, body.span)
    remedy = "let it change over a distance, or write the forces that are meant with `force`"
    for action in model.actions:
        what = f"the energy `{action.name}`"
        if isinstance(action, Potential):
            look([action.energy], positions, False, "LAG0423", what, remedy, action.span)
        elif isinstance(action, Lagrangian):
            look([action.function], place, False, "LAG0423", what, remedy, action.span)
            look([action.function], rates, True, "LAG0423", what, remedy, action.span)
    remedy = "declare a speed that changes with the motion alone"
    for speed in model.speeds:
        what = f"the speed `{speed.name}`"
        look([speed.expression], place, False, "LAG0424", what, remedy, speed.span)
    return Cuts(tuple(warnings), tuple(w for fault, found in stopping for w in _stops(fault, found)))


def _stops(fault: Fault, found: Break) -> list[WhenEquations]:
    """Clauses that end a run as failed where the relation changes."""
    assert fault.span is not None
    words, reason = found.where.replace("`", ""), fault.message.partition(";")[0]
    clauses = [When(words, c, (), reason, (), fault.span, fails=True) for c in found.conditions]
    return [WhenEquations(clause, clause.condition, ()) for clause in clauses]


def jumps_in_time(states: States, energy: Node) -> bool:
    """Return whether `energy` jumps at certain times: the change is no change of a stored energy."""
    return find_break(states, [energy], [states.model.time], slopes=False) is not None
