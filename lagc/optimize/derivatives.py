"""Exact derivatives of all that the equations are made of, sparse, for those who ask.

    the stack   qdot              nq           rates of the coordinates
                inertia           nv           M a
                force             nv           tau - h + G^T lam
                row               nc           G a - gamma
                condition         nh + nc + .. of a consistent start, see `conditions`
                start             nq + nv + .. start values, then the stated rates that are no speeds
                output            ny
    side              one a switch, what it changes at
    reinit            new values that clauses `when` give, one after the other

Each function has the derivatives of the stack by one group of what it depends on, at any a and lam: of the
forces without constraints at lam = 0, of -gamma at a = 0.  Where there are switches it is one of modes, too:
on each branch, what a run takes to be smooth there.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from lagc.expr.derivative import gradient
from lagc.expr.graph import Node
from lagc.mechanics.equations import EquationsOfMotion
from lagc.optimize.block import Block
from lagc.optimize.conditions import condition_rows
from lagc.optimize.freezing import Switch
from lagc.optimize.program import Function
from lagc.optimize.symbols import Places, cheapest, lower


class Derivatives(NamedTuple):
    """The stack itself, and its derivatives by each group: a function, and the places of what it stores."""

    values: Function
    by: dict[str, tuple[Function, tuple[tuple[int, int], ...]]]  # (row, column) of each entry


def stack(equations: EquationsOfMotion, switches: Sequence[Switch] = ()) -> dict[str, list[Node]]:
    """What is differentiated, block by block."""
    graph = equations.graph
    inertia: list[list[Node]] = [[] for _ in equations.v]
    for (i, j), m in sorted(equations.mass_matrix.items()):
        inertia[i].append(m * equations.a[j])
        if i != j:
            inertia[j].append(m * equations.a[i])
    force = [[r] for r in equations.applied_forces]
    for row, lam in zip(equations.rows, equations.lam):
        for j, slope in sorted(row.jacobian.items()):
            force[j].append(slope * lam)
    rows = [
        graph.sub(graph.sum(slope * equations.a[j] for j, slope in sorted(row.jacobian.items())), row.gamma)
        for row in equations.rows
    ]
    return {
        "qdot": list(equations.qdot),
        "inertia": [graph.sum(parts) for parts in inertia],
        "force": [graph.sum(parts) for parts in force],
        "row": rows,
        "condition": condition_rows(equations),
        "start": [s.value for s in equations.starts],
        "output": [o.expression for o in equations.outputs],
        "side": [switch.side for switch in switches],
        "reinit": [value for when in equations.whens for _, value in when.changes],
    }


def groups(places: Places) -> dict[str, list[Node]]:
    """What the stack is differentiated by, in the order of the arrays of generated functions."""
    equations = places.equations
    given = [symbol for symbol, (array, _) in places.arrays.items() if array == "p"]
    return {
        "time": [equations.time],
        "state": [*equations.q, *equations.v],
        "acceleration": [*equations.a, *equations.lam],
        "parameter": given,
    }


def derivatives(places: Places, switches: Sequence[Switch]) -> Derivatives:
    """By the names of `groups`; one reverse sweep a row of the stack."""
    graph, by = places.graph, groups(places)
    every = [symbol for symbols in by.values() for symbol in symbols]
    rows = [node for block in stack(places.equations, switches).values() for node in block]
    slopes = [gradient(graph, {node: graph.one}, every) for node in rows]
    found = {}
    for name, symbols in by.items():
        entries = {(i, k): row[x] for i, row in enumerate(slopes) for k, x in enumerate(symbols) if x in row}
        about = f"derivatives of the stack by {name}"
        found[name] = _function(places, f"by_{name}", "J", list(entries.values()), about), tuple(entries)
    about = "the stack: qdot, M a, forces, rows, conditions, starts, outputs, sides, new values"
    return Derivatives(_function(places, "stack", "s", rows, about), found)


def _function(places: Places, name: str, array: str, nodes: Sequence[Node], about: str) -> Function:
    def make(nodes: Sequence[Node]) -> Function:
        block = Block()
        for k, value in enumerate(lower(places, block, nodes)[1]):
            block.store(array, k, value)
        return block.function(name, (*places.state, "a", "lam"), ((array, len(nodes)),), about)

    return cheapest(places, nodes, make, seldom=True)
