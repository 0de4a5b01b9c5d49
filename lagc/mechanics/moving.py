"""What carries inertia, and the mass matrix that it makes.

With the partial velocities d(v_C)/d(v_j) and d(w)/d(v_j)

    M_ij = sum of m dv_C/dv_i . dv_C/dv_j + dw/dv_i . I dw/dv_j

(see `inertia`).  The sums over the bodies are reverse sweeps over the graph of the velocities, so a
chain of n links costs O(n^2) nodes: M is made where it is asked for.
"""

from __future__ import annotations

from collections.abc import Sequence

from lagc.expr.derivative import gradient, seeds, tangent
from lagc.expr.graph import Graph, Node
from lagc.expr.vectors import Matrix, Vector, matvec, scale
from lagc.expr.walk import depends, linked
from lagc.meaning.model import Body
from lagc.records import dataclass


@dataclass(frozen=True, slots=True)
class Moving:
    """The velocity of a centre of mass, or an angular velocity in body axes, and its inertia."""

    body: Body
    velocity: Vector  # in v
    at_rest: Vector  # what is left of it when every rate is zero: the drive's share
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


def mass_matrix(graph: Graph, speeds: Sequence[Node], parts: Sequence[Moving]) -> dict[tuple[int, int], Node]:
    """M_ij with i >= j, zeros left out."""
    flat = [x for part in parts for x in part.velocity]
    moving = depends(flat, speeds)
    arguments = {node: [a for a in node.args if a in moving] for node in moving}
    users: dict[Node, list[Node]] = {node: [] for node in moving}
    for node, below in arguments.items():
        for a in below:
            users[a].append(node)
    carried: dict[Node, list[int]] = {}
    for k, part in enumerate(parts):
        for node in part.velocity:
            carried.setdefault(node, []).append(k)
    index = {v: i for i, v in enumerate(speeds)}
    matrix: dict[tuple[int, int], Node] = {}
    for i, speed in enumerate(speeds):
        # Only what this speed changes, and what that depends on, is looked at.
        changed = linked([speed], users) if speed in moving else []
        driven = [parts[k] for k in sorted({k for node in changed for k in carried.get(node, ())})]
        partial = tangent(graph, [x for part in driven for x in part.velocity], {speed: graph.one}, changed)
        pairs: list[tuple[Node, Node]] = []
        for part, rate in zip(driven, triples(partial)):
            if not all(x.is_zero for x in rate):
                pairs.extend(zip(part.velocity, part.momentum(rate)))
        within = linked([node for node, _ in pairs if node in moving], arguments)
        wrt = [node for node in within if index.get(node, i + 1) <= i]
        row = gradient(graph, seeds(graph, pairs), sorted(wrt, key=index.__getitem__), within)
        matrix.update(((i, index[v]), node) for v, node in row.items())
    return matrix
