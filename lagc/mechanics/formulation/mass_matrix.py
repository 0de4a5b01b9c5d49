"""Velocities that carry inertia, and the mass matrix.

With the partial velocities d(v_C)/d(v_j) and d(w)/d(v_j)

    M_ij = sum of m dv_C/dv_i . dv_C/dv_j + dw/dv_i . I dw/dv_j

(see `inertia`). The sums are reverse sweeps over the graph of the velocities: a chain of n links costs O(n)
nodes for each row. M is formed when it is used.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence

from lagc.base.records import dataclass
from lagc.semantics.model import Body
from lagc.symbolic.derivative import gradient, seeds, tangent
from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.vectors import Matrix, Vector, matvec, scale
from lagc.symbolic.walk import depends, linked


@dataclass(frozen=True, slots=True)
class Moving:
    """The velocity of a centre of mass, or an angular velocity in body axes, and its inertia."""

    body: Body
    velocity: Vector  # in v
    at_rest: Vector  # the same when every rate is zero: the drive's share
    explicit: Vector  # its derivative by t alone, coordinates and rates held
    mass: Node | Matrix

    def momentum(self, velocity: Vector) -> Vector:
        """The linear or angular momentum that goes with `velocity`."""
        if isinstance(self.mass, tuple):
            return matvec(self.mass, velocity)
        return scale(self.mass, velocity)

    @property
    def carried(self) -> list[Node]:
        """The components of the velocity that inertia goes with."""
        if not isinstance(self.mass, tuple):
            return list(self.velocity)
        return [x for x, row in zip(self.velocity, self.mass) if not all(m.is_zero for m in row)]


def triples(flat: Sequence[Node]) -> list[Vector]:
    """The vectors whose components stand one after the other."""
    return [(flat[k], flat[k + 1], flat[k + 2]) for k in range(0, len(flat), 3)]


def inertial_forces(
    graph: Graph, speeds: Sequence[Node], accelerations: Sequence[Node], parts: Sequence[Moving]
) -> list[Node]:
    """M a, in two sweeps: M is not made for it."""
    flat = [x for part in parts for x in part.velocity]
    rates = triples(tangent(graph, flat, dict(zip(speeds, accelerations))))
    pairs = [pair for part, rate in zip(parts, rates) for pair in zip(part.velocity, part.momentum(rate))]
    found = gradient(graph, seeds(graph, pairs), speeds)
    return [found.get(v, graph.zero) for v in speeds]


class Inertia:
    """Rows of M, each in time in proportion to what its speed moves and what that is made of."""

    def __init__(self, graph: Graph, speeds: Sequence[Node], parts: Sequence[Moving]):
        self._graph, self._speeds, self._parts = graph, speeds, parts
        moving = depends([x for part in parts for x in part.velocity], speeds)
        self._arguments = {node: [a for a in node.args if a in moving] for node in moving}
        self._users: dict[Node, list[Node]] = {node: [] for node in moving}
        for node, below in self._arguments.items():
            for a in below:
                self._users[a].append(node)
        self._carried: dict[Node, list[int]] = {}
        for k, part in enumerate(parts):
            for node in part.velocity:
                self._carried.setdefault(node, []).append(k)
        self._index = {v: i for i, v in enumerate(speeds)}

    def row(self, i: int, columns: Collection[int]) -> dict[int, Node]:
        """M_ij with j in columns, zeros left out."""
        graph, speed, index = self._graph, self._speeds[i], self._index
        changed = linked([speed], self._users) if speed in self._users else []
        driven = [self._parts[k] for k in sorted({k for x in changed for k in self._carried.get(x, ())})]
        partial = tangent(graph, [x for part in driven for x in part.velocity], {speed: graph.one}, changed)
        pairs: list[tuple[Node, Node]] = []
        for part, rate in zip(driven, triples(partial)):
            if not all(x.is_zero for x in rate):
                pairs.extend(zip(part.velocity, part.momentum(rate)))
        within = linked([node for node, _ in pairs if node in self._arguments], self._arguments)
        wrt = sorted((x for x in within if index.get(x, -1) in columns), key=index.__getitem__)
        return {index[v]: m for v, m in gradient(graph, seeds(graph, pairs), wrt, within).items()}
