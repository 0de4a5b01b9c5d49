"""Speeds that nothing gives inertia: their accelerations cannot be found."""

from __future__ import annotations

from collections.abc import Mapping

from lagc.diagnostics.faults import Fault, Refused, Span
from lagc.expr.graph import Node
from lagc.mechanics.equations import EquationsOfMotion
from lagc.mechanics.states import rate_symbols
from lagc.optimize.ldlt import Entry, eliminate


def refuse_massless(equations: EquationsOfMotion, entries: Mapping[Entry, Node]) -> None:
    """Raise Refused, LAG0501 for each speed without inertia of its own that no constraint ties to
    one that has."""
    n = len(equations.v)
    bare = [j for j in range(n) if (j, j) not in entries]
    if not bare or eliminate(n, len(equations.rows), entries) is not None:
        return
    tied = _tied(equations, [j for j in range(n) if j not in bare])
    culprits = [j for j in bare if j not in tied] or bare
    raise Refused([_fault(equations, j) for j in culprits])


def _tied(equations: EquationsOfMotion, massive: list[int]) -> set[int]:
    """The speeds that rows tie, one to the next, to a speed with inertia."""
    found = set(massive)
    left = [set(row.jacobian) for row in equations.rows]
    while True:
        touching = [columns for columns in left if not found.isdisjoint(columns)]
        if not touching:
            return found
        left = [columns for columns in left if found.isdisjoint(columns)]
        for columns in touching:
            found |= columns


def _fault(equations: EquationsOfMotion, j: int) -> Fault:
    name = equations.v_names[j]
    span: Span | None = None
    for c in equations.model.coordinates:
        if equations.v[j] in rate_symbols(c):
            name, span = c.name, c.span
    for speed in equations.model.speeds:
        if speed.symbol is equations.v[j]:
            span = speed.span
    return Fault(
        "LAG0501",
        f"nothing that has mass moves with `{name}`, so its acceleration cannot be found",
        span,
        remedy=f"put a body where `{name}` moves it, tie it to one by a constraint, or, where it is"
        " a given function of time, write that function in its place",
    )
