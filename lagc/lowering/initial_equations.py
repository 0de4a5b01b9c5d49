"""The conditions of a consistent start, their derivatives, and the units of its unknowns."""

from __future__ import annotations

from lagc.base.records import replace
from lagc.mechanics.formulation.equations import EquationsOfMotion
from lagc.symbolic.derivative import Slopes, slopes
from lagc.symbolic.graph import Node


def condition_rows(equations: EquationsOfMotion) -> list[Node]:
    """The residuals that vanish at a consistent start, and the rates that were stated."""
    phi = [row.residual for row in equations.rows if row.holonomic]
    psi = [row.rate for row in equations.rows]
    own = [residual for residual, _ in equations.initial_conditions]
    return [*phi, *psi, *own, *(s.rate for s in equations.stated_rates)]


def condition_slopes(equations: EquationsOfMotion) -> Slopes:
    """d(row)/d(q, v, stated rates) of each of `condition_rows`."""
    unknowns, rows = (*equations.q, *equations.v), condition_rows(equations)
    n, rates = len(unknowns), len(equations.stated_rates)
    found = slopes(equations.graph, rows, {x: k for k, x in enumerate(unknowns)}, n + rates)
    value = equations.graph.const(-1.0)  # each stated rate is its rate less its value
    stated = [{**own, n + k: value} for k, own in enumerate(found.rows[len(rows) - rates :])]
    return replace(found, rows=[*found.rows[: len(rows) - rates], *stated])


def start_units(equations: EquationsOfMotion) -> list[str]:
    """The units of the unknowns of the start, each once."""
    rates = [s.unit for s in equations.stated_rates]
    return list(dict.fromkeys([*equations.q_units, *equations.v_units, *rates]))
