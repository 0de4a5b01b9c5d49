"""Clauses `when`: whether their conditions hold, and the values that states take."""

from __future__ import annotations

from collections.abc import Sequence

from lagc.base.records import replace
from lagc.lowering.functions import made
from lagc.lowering.modes import Switch
from lagc.lowering.program import Function
from lagc.lowering.storage import STATE, Places
from lagc.mechanics.formulation.equations import EquationsOfMotion
from lagc.symbolic.walk import symbols


def changing(
    equations: EquationsOfMotion, moving: EquationsOfMotion, switches: Sequence[Switch]
) -> tuple[EquationsOfMotion, EquationsOfMotion]:
    """Both without the clauses that no motion comes to, as inputs alone decide them, and without new values
    of states that were left out; `moving` are the frozen equations."""
    modes, states = {switch.mode for switch in switches}, {*equations.q, *equations.v}
    pairs = [
        [replace(when, changes=tuple([pair for pair in when.changes if pair[0] in states])) for when in both]
        for both in zip(equations.whens, moving.whens)
        if modes & symbols([both[1].condition])
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
    found = [made(along, "holds", along.state, (("c", truths),), described, seldom=True)]
    values = [value for when in clauses for _, value in when.changes]
    if values:
        described = "what states are when conditions become true"
        found.append(made(at, "reinit", STATE, (("r", values),), described, seldom=True))
    return found
