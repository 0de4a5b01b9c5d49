"""Velocities and loads as linear maps of the speeds at a few configurations, and the forms of their power."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence

from lagc.base.records import dataclass
from lagc.mechanics.formulation.equations import Row
from lagc.mechanics.formulation.states import States
from lagc.mechanics.identities.constraint_manifold import jacobian, onto, scales
from lagc.mechanics.numeric.cancellation import VANISHES, magnitudes
from lagc.mechanics.numeric.dense_linear import Span, dot
from lagc.mechanics.numeric.samples import samples
from lagc.symbolic.derivative import gradient
from lagc.symbolic.graph import Node

LARGEST = 60  # speeds and constraints beyond which poses are not compared
_CONFIGURATIONS = 2
_SLOW = 1e-2  # of random speeds: so slow that laws as tanh(v/v0) are not saturated
KEPT = 1e-7  # of the largest: less is round-off, or the residual of a pose on the constraints

Matrix = list[list[float]]


@dataclass(frozen=True, slots=True)
class Pose:
    """A state with speeds, and `allowed` directions of the speeds; None: all."""

    state: Mapping[Node, float]
    allowed: Matrix | None = None

    def given(self, values: Mapping[Node, float]) -> Pose:
        """Return the configuration with other values of parameters."""
        return Pose({**self.state, **values}, self.allowed)

    def along(self, matrix: Matrix) -> Matrix:
        """Return a map on the allowed directions."""
        if self.allowed is None:
            return matrix
        found = [[dot(row, direction) for direction in self.allowed] for row in matrix]
        most = max((abs(x) for row in found for x in row), default=0.0)
        return [[x if abs(x) > KEPT * most else 0.0 for x in row] for row in found]


def poses(states: States, rows: Sequence[Row] = ()) -> list[Pose]:
    """Return configurations near the start with the values of the parameters; if `rows` are given, on
    these."""
    slow = [*states.v, *states.rates]
    found = [
        {**state, **{x: _SLOW * state[x] for x in slow}}
        for state in samples(states.model, _CONFIGURATIONS, vary=False)
    ]
    if not rows:
        return [Pose(state) for state in found]
    if len(rows) + len(states.v) > LARGEST:
        return []
    sizes = [scales(states)[v] for v in states.v]
    met = [state for state in map(onto(states, rows), found) if state is not None]
    return [Pose(state, _directions(rows, sizes, state)) for state in met]


def _directions(rows: Sequence[Row], sizes: Sequence[float], state: Mapping[Node, float]) -> Matrix:
    held = Span(jacobian([row for row in rows if row.linear], sizes, state))
    found = []
    for j in range(len(sizes)):
        direction = held.remainder([float(i == j) for i in range(len(sizes))])
        found.append([x * size for x, size in zip(direction, sizes)])
    return found


class Maps:
    """Derivatives of vectors by the speeds, made once for each vector."""

    def __init__(self, states: States):
        self._states = states
        self._slopes: dict[tuple[Node, ...], list[dict[Node, Node]]] = {}

    def slopes(self, vector: Sequence[Node]) -> list[dict[Node, Node]]:
        """Return the derivatives of each component; `vector` is in rates."""
        key, states = tuple(vector), self._states
        if key not in self._slopes:
            one = states.graph.one
            self._slopes[key] = [
                gradient(states.graph, {x: one}, states.place_of_v) for x in states.in_speeds(vector)
            ]
        return self._slopes[key]

    def at(self, vector: Sequence[Node], pose: Pose) -> Matrix:
        """Return the derivatives, a row a component."""
        slopes = self.slopes(vector)
        entries = magnitudes([x for row in slopes for x in row.values()], pose.state)
        most = max((size for _, size in entries if math.isfinite(size)), default=0.0)
        found = iter(entries)
        place = self._states.place_of_v
        matrix = [[0.0] * len(place) for _ in slopes]
        for row, own in zip(matrix, slopes):
            for v in own:
                x, size = next(found)
                row[place[v]] = x if abs(x) > VANISHES * min(size, most) else 0.0
        return matrix


def combined(parts: Iterable[tuple[float, Matrix]]) -> Matrix:
    """Return the sum of maps, each times a number."""
    first, *others = [[[c * x for x in row] for row in matrix] for c, matrix in parts]
    for matrix in others:
        first = [[x + y for x, y in zip(a, b)] for a, b in zip(first, matrix)]
    return first


def power_form(force: Matrix, velocity: Matrix) -> Matrix:
    """Return the symmetric form of minus the power of a force on a velocity."""
    n = len(velocity[0])
    columns = [[row[j] for row in velocity] for j in range(n)]
    pushes = [[row[j] for row in force] for j in range(n)]
    product = [[-dot(u, f) for f in pushes] for u in columns]
    sizes = [[sum(abs(a * b) for a, b in zip(u, f)) for f in pushes] for u in columns]
    form = [[0.5 * (product[i][j] + product[j][i]) for j in range(n)] for i in range(n)]
    return [
        [x if abs(x) > VANISHES * (sizes[i][j] + sizes[j][i]) else 0.0 for j, x in enumerate(row)]
        for i, row in enumerate(form)
    ]


def has_minimum(matrix: Matrix, force: Sequence[float] | None = None) -> bool:
    """Return whether 1/2 v.matrix v - force.v is bounded below: by elimination, the largest pivot first."""
    n = len(matrix)
    given = force or [0.0] * n
    diagonal = [matrix[i][i] for i in range(n)]
    for i in range(n):
        if diagonal[i] < 0.0 or (diagonal[i] == 0.0 and (any(matrix[i]) or given[i])):
            return False
    kept = [i for i in range(n) if diagonal[i] > 0.0]
    unit = {i: 1.0 / math.sqrt(diagonal[i]) for i in kept}
    left = {i: {j: matrix[i][j] * unit[i] * unit[j] for j in kept} for i in kept}
    push = {i: given[i] * unit[i] for i in kept}
    most = max(map(abs, push.values()), default=0.0)
    while left:
        k = max(left, key=lambda i: left[i][i])
        pivot = left[k][k]
        if pivot <= KEPT:
            break
        base, at = left.pop(k), push.pop(k)
        for i, row in left.items():
            factor = row.pop(k) / pivot
            for j in row:
                row[j] -= factor * base[j]
            push[i] -= factor * at
    flat = all(abs(x) <= KEPT for row in left.values() for x in row.values())
    return flat and all(abs(x) <= KEPT * most for x in push.values())
