"""Clauses `when` in terms of the states."""

from __future__ import annotations

from lagc.diagnostics.faults import Fault, Refused
from lagc.mechanics.formulation.equations import WhenEquations
from lagc.mechanics.formulation.states import States


def when_equations(states: States) -> tuple[WhenEquations, ...]:
    """Raises Refused (LAG0427) where a new value is given to what is no state."""
    known, faults, found = {*states.q, *states.v}, [], []
    for clause in states.model.whens:
        for symbol, _ in clause.changes:
            if symbol not in known:
                given = ", ".join([f"`{v.record.name}`" for v in states.v])
                faults.append(
                    Fault(
                        "LAG0427",
                        f"`{symbol.record.name}` is no state of its own, as speeds are declared",
                        clause.span,
                        remedy=f"give new values to the speeds: {given}",
                    )
                )
        (condition,) = states.in_speeds([clause.condition])
        values = states.in_speeds([value for _, value in clause.changes])
        changes = tuple(zip([symbol for symbol, _ in clause.changes], values))
        found.append(WhenEquations(clause, condition, changes))
    if faults:
        raise Refused(faults)
    return tuple(found)
