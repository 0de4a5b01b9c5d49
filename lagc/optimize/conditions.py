"""The conditions of a consistent start, their derivatives, and the units of its unknowns."""

from __future__ import annotations

from lagc.expr.derivative import gradient
from lagc.expr.graph import Node
from lagc.mechanics.equations import EquationsOfMotion


def condition_rows(equations: EquationsOfMotion) -> list[Node]:
    """The residuals that vanish at a consistent start, and the rates that were stated."""
    phi = [row.residual for row in equations.rows if row.holonomic]
    psi = [row.rate for row in equations.rows]
    own = [residual for residual, _ in equations.initial_conditions]
    return [*phi, *psi, *own, *(s.rate for s in equations.stated_rates)]


def condition_slopes(equations: EquationsOfMotion) -> list[dict[int, Node]]:
    """d(row)/d(q, v, stated rates) of each of `condition_rows`: column -> derivative, zeros left out."""
    graph, n = equations.graph, len(equations.q) + len(equations.v)
    places = {x: k for k, x in enumerate((*equations.q, *equations.v))}
    found: list[dict[int, Node]] = []
    for row in condition_rows(equations):
        slopes = gradient(graph, {row: graph.one}, places)
        found.append({places[x]: slope for x, slope in slopes.items()})
    for k in range(len(equations.stated_rates)):  # each is its rate less its value
        found[k - len(equations.stated_rates)][n + k] = graph.const(-1.0)
    return found


def start_units(equations: EquationsOfMotion) -> list[str]:
    """The units of the unknowns of the start, each once."""
    rates = [s.unit for s in equations.stated_rates]
    return list(dict.fromkeys([*equations.q_units, *equations.v_units, *rates]))
