"""Exact derivatives of all that the equations are made of, sparse, for those who ask.

    the stack   qdot              nq           rates of the coordinates
                inertia           nv           M a
                force             nv           tau - h + G^T lam
                row               nc           G a - gamma
                condition         nh + nc + .. of a consistent start, see `conditions`
                start             nq + nv + .. start values, then the stated rates that are no speeds
                output            ny
    indicator         event indicators, one for each relation
    reinit            new values that clauses `when` give, one after the other

Each function has the derivatives of the stack by one group of what it depends on, at any a and lam: of the
forces without constraints at lam = 0, of -gamma at a = 0.  Where rows share so much that these would be long,
one function has what the stack changes by along a direction in all that it depends on.  With
relations these are functions of modes too: they belong to the branch of the run.
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple

from lagc.base.records import replace
from lagc.lowering.event_relations import EventRelation
from lagc.lowering.program import Function
from lagc.lowering.scalar.value_numbering import Block
from lagc.lowering.storage import Places, cheapest, lower
from lagc.mechanics.formulation.equations import EquationsOfMotion
from lagc.symbolic.derivative import Slopes, gradient, slopes, tangent
from lagc.symbolic.graph import Node
from lagc.symbolic.walk import depends, within

MOST = 16  # times that a sweep a row may pass each part of the equations: beyond, one goes along a direction
TOGETHER = 1024  # rows whose sweeps are counted at once


class Derivatives(NamedTuple):
    """The stack and its derivatives by each group: a function, and the places of its outputs. If these would
    be too long, only the derivative along a direction."""

    values: Function
    by: dict[str, tuple[Function, tuple[tuple[int, int], ...]]]  # (row, column) of each entry
    along: Function | None = None

    @property
    def functions(self) -> list[Function]:
        those = [function for function, pattern in self.by.values() if pattern]
        return [self.values, *those, *([] if self.along is None else [self.along])]

    @property
    def patterns(self) -> dict[str, tuple[tuple[int, int], ...]]:
        return {name: pattern for name, (_, pattern) in self.by.items()}


def motion_by_entries(equations: EquationsOfMotion) -> dict[str, list[Node]]:
    """Return the terms that determine the accelerations, by the entries of M and G."""
    # M a by entries of the symmetric matrix: each off-diagonal one counts in two rows.
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
        "inertia": [graph.sum(parts) for parts in inertia],
        "force": [graph.sum(parts) for parts in force],
        "row": rows,
    }


def motion_by_sweeps(equations: EquationsOfMotion) -> dict[str, list[Node]]:
    """Return the same terms by sweeps through the graph: as long as the equations, not as M and G."""
    graph = equations.graph
    # The same sums by one sweep through the graph: for models whose matrices have more entries than the graph
    # has nodes.
    along = tangent(graph, [row.rate for row in equations.rows], dict(zip(equations.v, equations.a)))
    forces = zip(equations.applied_forces, equations.constraint_forces)
    return {
        "inertia": equations.inertial_forces,
        "force": [graph.add(applied, own) for applied, own in forces],
        "row": [graph.sub(own, row.gamma) for own, row in zip(along, equations.rows)],
    }


def stack(
    equations: EquationsOfMotion,
    relations: Sequence[EventRelation] = (),
    motion: Callable[[EquationsOfMotion], dict[str, list[Node]]] = motion_by_entries,
) -> dict[str, list[Node]]:
    """Return the nodes that are differentiated, block by block."""
    return {
        "qdot": list(equations.qdot),
        **motion(equations),
        "condition": condition_rows(equations),
        "start": [s.value for s in equations.starts],
        "output": [o.expression for o in equations.outputs],
        "indicator": [relation.side for relation in relations],
        "reinit": [value for when in equations.whens for _, value in when.changes],
    }


def groups(places: Places) -> dict[str, list[Node]]:
    """Return the variables of differentiation, in the order of the arrays of generated functions."""
    equations = places.equations
    given = [symbol for symbol, (array, _) in places.arrays.items() if array == "p"]
    return {
        "time": [equations.time],
        "state": [*equations.q, *equations.v],
        "acceleration": [*equations.a, *equations.lam],
        "parameter": given,
    }


def derivatives(places: Places, relations: Sequence[EventRelation], along: bool = False) -> Derivatives:
    """Return the derivatives by the names of `groups`, by a reverse sweep for each row of the stack; or the
    derivative along a direction d, by one forward sweep, where it is shorter or `along` asks for it."""
    # Rows with many common parts make gradients with many entries; the one along a direction is as long
    # as the rows.
    equations, by = places.equations, groups(places)
    every = [symbol for symbols in by.values() for symbol in symbols]
    swept = _rows(stack(equations, relations, motion_by_sweeps))
    if along or entangled(swept, every, MOST):
        return Derivatives(_values(places, swept), {}, _directional(places, swept, every))
    rows = _rows(stack(equations, relations))
    slopes = [gradient(places.graph, {node: places.graph.one}, every) for node in rows]
    found = {}
    for name, symbols in by.items():
        entries = {(i, k): row[x] for i, row in enumerate(slopes) for k, x in enumerate(symbols) if x in row}
        about = f"derivatives of the stack by {name}"
        found[name] = _function(places, f"by_{name}", "J", list(entries.values()), about), tuple(entries)
    return Derivatives(_values(places, rows), found)


def _rows(parts: dict[str, list[Node]]) -> list[Node]:
    return [node for part in parts.values() for node in part]


def entangled(rows: Sequence[Node], leaves: Sequence[Node], most: int) -> bool:
    """Return whether reverse sweeps, one for each row, would pass nodes that rows share more than `most`
    times on average."""
    # Rows above each node as bits: a reverse sweep for each row passes a node once for each row above it. The
    # sum of these numbers is the work.
    moving, passed = depends(rows, leaves), 0
    for first in range(0, len(rows), TOGETHER):
        some = rows[first : first + TOGETHER]
        above = dict.fromkeys(moving, 0)  # which rows, as bits of a number
        for k, row in enumerate(some):
            above[row] = above.get(row, 0) | 1 << k
        for node in reversed(within(some, moving)):
            passed += above[node].bit_count()
            for argument in node.args:
                if argument in moving:
                    above[argument] |= above[node]
        if passed > most * len(moving):
            return True
    return False


def _values(places: Places, rows: Sequence[Node]) -> Function:
    about = "the stack: qdot, M a, forces, rows, conditions, starts, outputs, sides, new values"
    return _function(places, "stack", "s", rows, about)


def _directional(places: Places, rows: Sequence[Node], every: Sequence[Node]) -> Function:
    graph = places.graph
    seeds = {x: graph.symbol("direction", str(k)) for k, x in enumerate(every)}
    ahead = {**places.arrays, **{d: ("d", k) for k, d in enumerate(seeds.values())}}
    about = "changes of the stack along a direction in time, state, accelerations and multipliers, parameters"
    return _function(replace(places, arrays=ahead), "along", "s", tangent(graph, rows, seeds), about, ("d",))


def _function(
    places: Places, name: str, array: str, nodes: Sequence[Node], about: str, more: tuple[str, ...] = ()
) -> Function:
    def make(nodes: Sequence[Node]) -> list[Function]:
        block = Block()
        for k, value in enumerate(lower(places, block, nodes)[1]):
            block.store(array, k, value)
        return [block.function(name, (*places.state, "a", "lam", *more), ((array, len(nodes)),), about)]

    (found,) = cheapest(places, nodes, make, rare=True)
    return found


def condition_rows(equations: EquationsOfMotion) -> list[Node]:
    """Return the residuals that vanish at a consistent start, and the stated rates."""
    phi = [row.residual for row in equations.rows if row.holonomic]
    psi = [row.rate for row in equations.rows]
    own = [residual for residual, _ in equations.initial_conditions]
    return [*phi, *psi, *own, *(s.rate for s in equations.stated_rates)]


def condition_slopes(equations: EquationsOfMotion) -> Slopes:
    """Return the derivatives of `condition_rows` by q, v and the stated rates."""
    unknowns, rows = (*equations.q, *equations.v), condition_rows(equations)
    n, rates = len(unknowns), len(equations.stated_rates)
    # A stated rate is an unknown too: rate - value has the derivative -1 by its value.
    found = slopes(equations.graph, rows, {x: k for k, x in enumerate(unknowns)}, n + rates)
    value = equations.graph.const(-1.0)  # each stated rate is its rate less its value
    stated = [{**own, n + k: value} for k, own in enumerate(found.rows[len(rows) - rates :])]
    return replace(found, rows=[*found.rows[: len(rows) - rates], *stated])


def start_units(equations: EquationsOfMotion) -> list[str]:
    """Return the units of the unknowns of the start, each once."""
    rates = [s.unit for s in equations.stated_rates]
    return list(dict.fromkeys([*equations.q_units, *equations.v_units, *rates]))
