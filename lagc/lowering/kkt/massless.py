"""Speeds that nothing gives inertia: rows determine them, or their accelerations cannot be found."""

from __future__ import annotations

from collections.abc import Sequence

from lagc.base.records import replace
from lagc.diagnostics.faults import Fault, Refused, Span
from lagc.lowering.kkt.articulated_body import plain
from lagc.lowering.kkt.fill_ordering import eliminate
from lagc.mechanics.formulation.equations import EquationsOfMotion
from lagc.mechanics.formulation.states import rate_symbols


def with_pivots(equations: EquationsOfMotion) -> EquationsOfMotion:
    """`equations` as elimination can solve them.

    A massless speed on which no force acts and that has a row of its own, `der(y) = ...`, has no pivot
    and needs no force: y'' = gamma is asked of a unit of inertia too, so that the multiplier comes out
    as 0, whatever the units.  Raises Refused, LAG0501 for each speed that neither inertia nor rows
    determine.
    """
    bare = [j for j in range(len(equations.v)) if j not in equations.massive]
    if not bare or eliminate(plain(equations).structure) is not None:
        return equations
    tied = _tied(equations, [j for j in range(len(equations.v)) if j not in bare])
    loose = [j for j in bare if j not in tied]
    found = _with_units(equations, loose)
    if eliminate(plain(found).structure) is not None:
        return found
    culprits = [j for j in loose if j not in found.massive] or bare
    raise Refused([_fault(equations, j) for j in culprits])


def _with_units(equations: EquationsOfMotion, loose: Sequence[int]) -> EquationsOfMotion:
    matrix, given = dict(equations.further_inertia), list(equations.given_forces)
    loads = dict(equations.loads)
    forces, one = equations.applied_forces, equations.graph.one
    for j in loose:
        rows = [row for row in equations.rows if j in row.jacobian]
        if len(rows) == 1 and forces[j].is_zero:
            slope = rows[0].jacobian[j]
            if len(rows[0].jacobian) == 1 and slope in (one, -one):
                given[j], matrix[j, j] = slope * rows[0].gamma, one
                loads[equations.v[j]] = given[j]
    return replace(equations, further_inertia=matrix, given_forces=tuple(given), loads=loads)


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
    rows = ", ".join(f"`{row.label}`" for row in equations.rows if j in row.jacobian)
    if rows:
        return Fault(
            "LAG0501",
            f"nothing that has mass moves with `{name}`, and {rows} alone cannot balance what acts on it",
            span,
            remedy=f"where no force acts on it, solve the constraint for its rate, `der({name}) = ...`; else"
            " give it an inertia, which changes no other motion where constraints alone give its rate",
        )
    return Fault(
        "LAG0501",
        f"nothing that has mass moves with `{name}`, so its acceleration cannot be found",
        span,
        remedy=f"put a body where `{name}` moves it, tie it to one by a constraint, or, where it is"
        " a given function of time, write that function in its place",
    )
