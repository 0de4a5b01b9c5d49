"""Lagrange's equations of a model by differences in 90 digits.

Taken from the model: positions and axes of its bodies, masses, energies, the vectors and partial
velocities of given forces, and the residuals of its constraints.  Everything that the compiler
derives from these (velocities, mass matrix, bias forces, generalized forces, Jacobian and the
right-hand side of the constraints, the change to declared speeds) is found anew: by central
differences with a step of 1e-15, whose error of 1e-30 is far below that of doubles, and Euler-Lagrange,
for the body rates w of an orientation in the form of Euler and Poincare, d(p)/dt + w x p = dL/d(turn).
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import mpmath

from lagc.semantics.model import (
    Coordinate,
    Dissipation,
    Force,
    Lagrangian,
    Model,
    Orientation,
    Potential,
    Torque,
)
from lagc.symbolic.graph import Node
from lagc.symbolic.walk import reachable

mp = mpmath.mp.clone()
mp.dps = 90
STEP = mp.mpf(10) ** -15

_BINARY: dict[str, Callable[[Any, Any], Any]] = {
    "atan2": mp.atan2, "pow": mp.power, "min": min, "max": max, "lt": lambda a, b: a < b,
    "le": lambda a, b: a <= b, "eq": lambda a, b: a == b, "and": lambda a, b: a and b,
    "or": lambda a, b: a or b,
}  # fmt: skip


class Expressions:
    """Nodes that are evaluated together, again and again."""

    def __init__(self, nodes: Sequence[Node]):
        self.nodes = list(nodes)
        self.order = reachable(self.nodes)

    def __call__(self, given: Mapping[Node, Any]) -> list[Any]:
        known: dict[Node, Any] = {}
        for node in self.order:
            known[node] = given[node] if node in given else _value(node, [known[a] for a in node.args])
        return [known[node] for node in self.nodes]


def _value(node: Node, x: list[Any]) -> Any:
    op = node.op
    if op == "const":
        return mp.mpf(node.value)
    if op == "add":
        return x[0] + x[1]
    if op == "scale":
        return mp.mpf(node.value) * x[0]
    if op == "mul":
        product = mp.mpf(1)
        for base, exponent in zip(x, node.value):
            product *= base**exponent
        return product
    if op == "select":
        return x[1] if x[0] else x[2]
    if op == "not":
        return not x[0]
    if op == "abs":
        return abs(x[0])
    if op in _BINARY:
        return _BINARY[op](x[0], x[1])
    return getattr(mp, op)(x[0])


def slope(function: Callable[[Any], list[Any]]) -> list[Any]:
    """d(function(s))/ds at 0."""
    return [(a - b) / (2 * STEP) for a, b in zip(function(STEP), function(-STEP))]


class Oracle:
    """The equations at one state: coordinates q, values of the speeds v, time t, by symbol."""

    def __init__(self, model: Model, state: Mapping[Node, float], speeds: Sequence[Node]):
        self.model = model
        self.fixed = {
            p.symbol: mp.mpf(state[p.symbol]) for p in (*model.parameters, *model.inputs, *model.discretes)
        }
        self.q_symbols = [s for c in model.coordinates for s in _places(c)]
        self.r_symbols = [s for c in model.coordinates for s in _rates(c)]
        self.speeds = list(speeds)
        self.t = mp.mpf(state[model.time])
        self.q = _unit([mp.mpf(state[s]) for s in self.q_symbols], model)
        self.v = [mp.mpf(state[s]) for s in self.speeds]
        bodies = model.bodies
        axes = [b.frame.axes for b in bodies if b.frame is not None]
        self.poses = Expressions(
            [x for b in bodies for x in b.position] + [x for a in axes for r in a for x in r]
        )
        inertias = [b.inertia for b in bodies if b.inertia is not None]
        self.masses = Expressions([b.mass for b in bodies])(self.fixed)
        self.inertias = Expressions([x for i in inertias for r in i for x in r])(self.fixed)
        self.declared = Expressions([s.expression for s in model.speeds])
        self.potential = Expressions([a.energy for a in model.actions if isinstance(a, Potential)])
        self.free = Expressions([a.function for a in model.actions if isinstance(a, Lagrangian)])
        self.damping = Expressions([a.function for a in model.actions if isinstance(a, Dissipation)])
        pushes = [(a.vector, a.velocity) for a in model.actions if isinstance(a, Force)]
        turns = [a for a in model.actions if isinstance(a, Torque)]
        self.vectors = Expressions([x for f, _ in pushes for x in f] + [x for a in turns for x in a.vector])
        self.pushed = Expressions([x for _, u in pushes for x in u])
        turned = [(a.frame.axes, a.reaction.axes if a.reaction else None) for a in turns]
        self.turned = [(Expressions([x for r in a for x in r]), b and Expressions([x for r in b for x in r]))
                       for a, b in turned]  # fmt: skip
        self.residuals = Expressions([x for c in model.constraints for x in c.residuals])
        rates = set(self.r_symbols) | {s.symbol for s in model.speeds}
        self.is_holonomic = [rates.isdisjoint(reachable([x])) for c in model.constraints for x in c.residuals]

    # -- kinematics, in the rates ----------------------------------------------------------

    def at(self, q: Sequence[Any], r: Sequence[Any], t: Any) -> dict[Node, Any]:
        """The values of all symbols; declared speeds are found from the rates."""
        known = {
            **self.fixed,
            **dict(zip(self.q_symbols, q)),
            **dict(zip(self.r_symbols, r)),
            self.model.time: t,
        }
        for speed in self.model.speeds:
            known[speed.symbol] = Expressions([speed.expression])(known)[0]
        return known

    def rates(self, q: Sequence[Any], v: Sequence[Any], t: Any) -> list[Any]:
        """The rates that go with speeds: the declared ones are affine in the rates."""
        if not self.model.speeds:
            return list(v)
        n = len(self.r_symbols)

        def speeds(r: Sequence[Any]) -> list[Any]:
            known = self.at(q, r, t)
            return [known[s] for s in self.speeds]

        offset = speeds([mp.mpf(0)] * n)
        columns = [[a - b for a, b in zip(speeds(unit(n, j)), offset)] for j in range(n)]
        matrix = mp.matrix([[columns[j][i] for j in range(n)] for i in range(n)])
        return list(mp.lu_solve(matrix, mp.matrix([x - y for x, y in zip(v, offset)])))

    def moved(self, q: Sequence[Any], r: Sequence[Any], s: Any) -> list[Any]:
        found: list[Any] = []
        place, rates = iter(q), iter(r)
        for c in self.model.coordinates:
            if isinstance(c, Coordinate):
                found.append(next(place) + s * next(rates))
                continue
            w, x, y, z = (next(place) for _ in range(4))
            a, b, d = (next(rates) * s / 2 for _ in range(3))
            found += [w - x * a - y * b - z * d, x + w * a + y * d - z * b, y + w * b + z * a - x * d,
                      z + w * d + x * b - y * a]  # fmt: skip
        return found

    def kinetic(self, q: Sequence[Any], r: Sequence[Any], t: Any) -> Any:
        """Of the bodies, and of the free terms."""
        here = self.poses(self.at(q, r, t))
        rate = slope(lambda s: self.poses(self.at(self.moved(q, r, s), r, t + s)))
        n = 3 * len(self.masses)
        total = mp.mpf(0)
        for k, mass in enumerate(self.masses):
            total += mass * sum(x * x for x in rate[3 * k : 3 * k + 3]) / 2
        for k in range((len(here) - n) // 9):
            w = spin(here[n + 9 * k : n + 9 * k + 9], rate[n + 9 * k : n + 9 * k + 9])
            inertia = self.inertias[9 * k : 9 * k + 9]
            total += sum(w[i] * inertia[3 * i + j] * w[j] for i in range(3) for j in range(3)) / 2
        return total + sum(self.free(self.at(q, r, t)))

    # -- Euler-Lagrange, in the rates --------------------------------------------------------------

    def momenta(self, q: Sequence[Any], r: Sequence[Any], t: Any) -> list[Any]:
        """dL/d(rate) by differences."""
        n = len(r)

        def along(j: int) -> Any:
            return slope(lambda s: [self.kinetic(q, [x + s * (i == j) for i, x in enumerate(r)], t)])[0]

        return [along(j) for j in range(n)]

    def mass_matrix_of_rates(self) -> list[list[Any]]:
        r = self.rates(self.q, self.v, self.t)
        n = len(r)
        columns = [
            slope(lambda s, j=j: self.momenta(self.q, [x + s * (i == j) for i, x in enumerate(r)], self.t))
            for j in range(n)
        ]
        return [[columns[j][i] for j in range(n)] for i in range(n)]

    def forces_of_rates(self) -> list[Any]:
        """Everything that is not M r' and not of the constraints, on the right-hand side."""
        q, t, n = self.q, self.t, len(self.r_symbols)
        r = self.rates(q, self.v, t)
        rate = slope(lambda s: self.momenta(self.moved(q, r, s), r, t + s))
        found = []
        for j in range(n):
            turn = unit(n, j)
            along = slope(
                lambda s, turn=turn: [self.kinetic(self.moved(q, turn, s), r, t), *self.potential(
                    self.at(self.moved(q, turn, s), r, t))]
            )  # fmt: skip
            damping = slope(
                lambda s, turn=turn: self.damping(self.at(q, [a + s * b for a, b in zip(r, turn)], t))
            )
            found.append(along[0] - sum(along[1:]) - sum(damping) - rate[j])
        for first in self._turning():
            p, w = self.momenta(q, r, t)[first : first + 3], r[first : first + 3]
            for k in range(3):
                i, j = (k + 1) % 3, (k + 2) % 3
                found[first + k] -= w[i] * p[j] - w[j] * p[i]
        return [a + b for a, b in zip(found, self._given(q, r, t))]

    def _turning(self) -> list[int]:
        """The first rate of each orientation."""
        found, place = [], 0
        for c in self.model.coordinates:
            if isinstance(c, Orientation):
                found.append(place)
            place += len(_rates(c))
        return found

    def _given(self, q: Sequence[Any], r: Sequence[Any], t: Any) -> list[Any]:
        vectors = self.vectors(self.at(q, r, t))
        n, pushes = len(r), len(self.pushed.nodes)
        found = []
        for j in range(n):
            turn = unit(n, j)
            partial = slope(
                lambda s, turn=turn: self.pushed(self.at(q, [a + s * b for a, b in zip(r, turn)], t))
            )
            force = sum(a * b for a, b in zip(vectors[:pushes], partial))
            for k, (frame, other) in enumerate(self.turned):
                moment = vectors[pushes + 3 * k : pushes + 3 * k + 3]
                w = self._turn(frame, q, r, t, turn)
                if other is not None:
                    w = [a - b for a, b in zip(w, self._turn(other, q, r, t, turn))]
                force += sum(a * b for a, b in zip(moment, w))
            found.append(force)
        return found

    def _turn(
        self, axes: Expressions, q: Sequence[Any], r: Sequence[Any], t: Any, turn: Sequence[Any]
    ) -> list[Any]:
        """The partial angular velocity of a frame, in world axes."""
        here = axes(self.at(q, r, t))
        rate = slope(lambda s: axes(self.at(self.moved(q, turn, s), r, t)))
        w = spin(here, rate)
        return [sum(here[3 * i + j] * w[j] for j in range(3)) for i in range(3)]

    def row_rates(self, q: Sequence[Any], r: Sequence[Any], t: Any) -> list[Any]:
        """The rates of holonomic residuals, and the residuals that restrict velocities."""
        values = self.residuals(self.at(q, r, t))
        rates = slope(lambda s: self.residuals(self.at(self.moved(q, r, s), r, t + s)))
        return [
            rate if holonomic else value for value, rate, holonomic in zip(values, rates, self.is_holonomic)
        ]

    # -- in the speeds --------------------------------------------------------------------------------

    def equations(self) -> tuple[Any, Any, Any, Any]:
        """M, the forces beside M v' (r = tau - h), G and gamma, in the speeds of the model."""
        q, v, t, n = self.q, self.v, self.t, len(self.v)
        r = self.rates(q, v, t)
        zero = self.rates(q, [mp.mpf(0)] * n, t)
        columns = [[a - b for a, b in zip(self.rates(q, unit(n, j), t), zero)] for j in range(n)]
        change = mp.matrix([[columns[j][i] for j in range(n)] for i in range(n)])
        drift = mp.matrix(slope(lambda s: self.rates(self.moved(q, r, s), v, t + s)))
        mass = mp.matrix(self.mass_matrix_of_rates())
        forces = mp.matrix(self.forces_of_rates()) - mass * drift
        if not self.is_holonomic:
            return change.T * mass * change, change.T * forces, None, None
        rows = [
            slope(lambda s, j=j: self.row_rates(q, [x + s * (i == j) for i, x in enumerate(r)], t))
            for j in range(n)
        ]
        jacobian = mp.matrix([[rows[j][k] for j in range(n)] for k in range(len(self.is_holonomic))])
        ahead = slope(lambda s: self.row_rates(self.moved(q, r, s), r, t + s))
        gamma = -mp.matrix(ahead) - jacobian * drift
        return change.T * mass * change, change.T * forces, jacobian * change, gamma


def unit(n: int, j: int) -> list[Any]:
    return [mp.mpf(i == j) for i in range(n)]


def spin(axes: Sequence[Any], rate: Sequence[Any]) -> list[Any]:
    """The angular velocity in the frame's own axes, from R^T R' (both by rows)."""

    def entry(i: int, j: int) -> Any:
        return sum(axes[3 * k + i] * rate[3 * k + j] for k in range(3))

    return [entry(2, 1), entry(0, 2), entry(1, 0)]


def _places(c: Coordinate | Orientation) -> tuple[Node, ...]:
    return (c.symbol,) if isinstance(c, Coordinate) else c.symbols


def _rates(c: Coordinate | Orientation) -> tuple[Node, ...]:
    return (c.rate_symbol,) if isinstance(c, Coordinate) else c.rate_symbols


def _unit(q: list[Any], model: Model) -> list[Any]:
    """Quaternions of unit norm to all digits."""
    found: list[Any] = []
    place = iter(q)
    for c in model.coordinates:
        part = [next(place) for _ in _places(c)]
        norm = mp.sqrt(sum(x * x for x in part)) if isinstance(c, Orientation) else mp.mpf(1)
        found += [x / norm for x in part]
    return found
