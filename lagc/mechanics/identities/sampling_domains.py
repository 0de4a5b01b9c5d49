"""Domains in which identities are tested: all states, or the states of the motion.

All states: positions, rates and time are free; quaternions have length one. On the motion: holonomic rows are
solved for coordinates or parameters that they contain linearly (a loop for its lengths) or as squares (a rod
for its length); velocity rows hold; accelerations and multipliers solve the equations of motion.

Rows may have solutions of several kinds: a loop also closes for lengths of zero. Rows are therefore solved
only for unknowns for which they can be solved at a state of the motion too. An expression that vanishes for
all these solutions vanishes on the motion.
"""

import math
from collections.abc import Mapping, Sequence
from itertools import chain
from typing import TypeVar

from lagc.base.records import dataclass
from lagc.mechanics.formulation.equations import EquationsOfMotion, Row
from lagc.mechanics.formulation.states import States
from lagc.mechanics.identities.constraint_manifold import dense
from lagc.mechanics.identities.linear_algebra import Span, solve
from lagc.mechanics.identities.samples import VANISHES, magnitudes, samples
from lagc.mechanics.identities.zero_test import Ground, State, Truths, defaults, spelt_out
from lagc.symbolic.derivative import gradient, tangent
from lagc.symbolic.finite_field import RIGHT, P, Point, Undefined, is_square, power, solve_exactly
from lagc.symbolic.graph import Node
from lagc.symbolic.walk import evaluate, reachable, symbols

Number = TypeVar("Number", int, float)

_STATES = 3
_FAR_AWAY = (3.0, 30.0)  # sizes of the coordinates
_MOST_ROWS = 40  # for which unknowns are chosen
_DRAWS = 40
_ALL_DIGITS = 15  # that a double keeps of a number that is written
LARGEST = 160  # accelerations and multipliers that are solved for


def all_states(states: States) -> Ground:
    """Return the domain of all states: positions, rates, speeds and time are free."""
    return on_rows(states, (), [*samples(states.model, _STATES), *far_away(states)])


def far_away(states: States) -> list[dict[Node, float]]:
    """Return states many sizes of the coordinates away, and later, where roots that are |u| have another
    sign."""
    time = states.model.time
    drawn = [(spread, s) for spread in _FAR_AWAY for s in samples(states.model, 2, spread=spread)]
    return [{**s, time: spread * s[time]} for spread, s in drawn]


def on_rows(states: States, rows: Sequence[Row], tries: Sequence[Mapping[Node, float]]) -> Ground:
    """Return the domain in which positions and speeds meet the rows; `tries` are such states."""
    placing = _Placing(states, rows, tries)
    return Ground(states.graph, defaults(states.model), placing.support, placing.place, lambda truths: tries)


def at_defaults(states: States, rows: Sequence[Row], tries: Sequence[Mapping[Node, float]]) -> Ground:
    """Return the domain of `on_rows` with parameters and inputs at their defaults, as these are written."""
    model = states.model
    values = {p.symbol: p.value for p in model.parameters if p.value is not None}
    values.update((u.symbol, u.default) for u in model.inputs)
    placing = _Placing(states, rows, tries, values)
    return Ground(states.graph, values, placing.support, placing.place, lambda truths: tries, _ALL_DIGITS)


def on_motion(
    equations: EquationsOfMotion,
    states: States,
    rows: Sequence[tuple[int, Row]],
    tries: Sequence[Mapping[Node, float]],
) -> Ground:
    """Return the domain of the motion: `on_rows` with the accelerations and multipliers of the independent
    `rows`, by index."""
    motion = _Motion(equations, states, rows, tries)

    def numbers(truths: Truths | None) -> Sequence[Mapping[Node, float]]:
        moved = (motion.with_motion({**s, **(truths or {})}) for s in tries)
        return [m for m in moved if m is not None]

    return Ground(states.graph, defaults(states.model), motion.support, motion.place, numbers)


def _turn(states: States, point: Point) -> None:
    """Give the point unit quaternions: r r/|r|^2 for a random r."""
    for i in states.quaternions:
        w, x, y, z = (point.draw() for _ in range(4))
        n = power(w * w + x * x + y * y + z * z, -1)
        squared = (w * w - x * x - y * y - z * z, 2 * w * x, 2 * w * y, 2 * w * z)
        point.place({states.q[i + k]: e * n % P for k, e in enumerate(squared)})


class _Placing:
    """Points and speeds on rows, with symbols that keep `values`."""

    def __init__(
        self,
        states: States,
        rows: Sequence[Row],
        tries: Sequence[Mapping[Node, float]],
        values: Mapping[Node, float] | None = None,
    ):
        self.states, self._values = states, values or {}
        # Rows that are linear in some unknowns together are solved as linear equations; of the others, those
        # that are quadratic in one unknown by a root.
        graph = states.graph
        residuals = [row.residual for row in rows if row.holonomic]
        scalars = [x for x in _scalars(states) if x not in self._values]
        unknowns = _solvable(scalars, residuals)
        holonomic = _solvable_residuals(residuals, unknowns, tries[0]) if tries and unknowns else []
        left = [x for x in residuals if x not in holonomic]
        squares = _squares(scalars, left, holonomic, tries[0]) if tries else []
        # The domain is complete if all rows are met this way: only then does a value that is not zero refute.
        known = len(holonomic) + len(squares) == len(residuals)
        self.complete = all(row.linear for row in rows) and known
        slopes = [gradient(graph, {x: graph.one}, unknowns) for x in holonomic]
        rates = [row.rate for row in rows if row.linear]
        jacobians = [row.jacobian for row in rows if row.linear]
        # All expressions that are evaluated at a point, with their comparisons spelt out together.
        flat = [
            *holonomic,
            *rates,
            *(x for table in slopes for x in table.values()),
            *(x for table in jacobians for x in table.values()),
            *(x for square in squares for x in square.nodes),
        ]
        self.support = spelt_out(graph, flat)
        entries = iter(self.support)
        self._residuals = [next(entries) for _ in holonomic]
        self._rates = [next(entries) for _ in rates]
        self._slopes = [{unknowns.index(x): next(entries) for x in table} for table in slopes]
        self._jacobians = [{j: next(entries) for j in table} for table in jacobians]
        self._squares = [_Square(x.unknown, x.others, [next(entries) for _ in x.nodes]) for x in squares]
        self._unknowns = unknowns

    def place(self, point: Point, truths: Truths) -> bool:
        # Quaternions, values that are kept, linear unknowns, squares, then speeds: each uses the ones before.
        _turn(self.states, point)
        point.keep(self._values)
        met = self._meet(point, truths, self._unknowns, self._residuals, self._slopes)
        for square in self._squares:
            square.place(point, truths)
        moving = self._meet(point, truths, self.states.v, self._rates, self._jacobians)
        return met and moving and self.complete

    @staticmethod
    def _meet(
        point: Point,
        truths: Truths,
        unknowns: Sequence[Node],
        residuals: Sequence[Node],
        slopes: Sequence[Mapping[int, Node]],
    ) -> bool:
        """Solve rows that are linear in the unknowns for them; False where they cannot all hold."""
        if not residuals:
            return True
        # At zero unknowns the residuals are the offsets of the linear equations.
        random = dict(zip(unknowns, point.values(unknowns)))
        point.place(dict.fromkeys(unknowns, 0))
        offsets = point.values(residuals, truths)
        table = [dict(zip(s, point.values(list(s.values()), truths))) for s in slopes]
        rows = [{RIGHT: -x % P, **row} for x, row in zip(offsets, table)]
        found = solve_exactly(rows, range(len(unknowns)), point.draw)
        point.place(random if found is None else {unknowns[j]: x for j, x in found.items()})
        return found is not None


@dataclass(frozen=True, slots=True)
class _Square:
    """A row that is a quadratic polynomial in one `unknown`: `nodes` are its residual and its first two
    derivatives; `others` may be drawn again until there is a root."""

    unknown: Node
    others: list[Node]
    nodes: list[Node]

    def place(self, point: Point, truths: Truths) -> None:
        """Solve it, with one sign or the other.  Raises Undefined."""
        # a u^2 / 2 + b u + c = 0: c, b, a at u = 0. The discriminant must be a square, else other unknowns
        # are drawn again.
        for _ in range(_DRAWS):
            point.place({self.unknown: 0})
            c, b, a = point.values(self.nodes, truths)
            discriminant = (b * b - 2 * a * c) % P
            if a and is_square(discriminant):
                root = pow(discriminant, (P + 1) // 4, P) * (1 if point.draw() % 2 else -1)
                point.place({self.unknown: (root - b) * power(a, -1) % P})
                return
            point.place({x: point.draw() for x in self.others})
        raise Undefined


def _squares(
    asked: Sequence[Node], residuals: Sequence[Node], solved: Sequence[Node], state: State
) -> list[_Square]:
    """Return for each residual one of `asked` that earlier solved ones do not contain and for which it can be
    solved at `state`; residuals without one are left out."""
    fixed = symbols(solved)
    found: list[_Square] = []
    # A residual whose symbols are fixed by earlier ones cannot be met by these.
    for residual in residuals[:_MOST_ROWS]:
        held = symbols([residual]) - fixed
        polynomial = held - symbols(a for y in reachable([residual]) if not _adds_up(y) for a in y.args)
        for x in asked if polynomial else ():
            if x not in polynomial:
                continue
            graph = x.graph
            slope = tangent(graph, [residual], {x: graph.one})[0]
            curve = tangent(graph, [slope], {x: graph.one})[0]
            ((value, size),) = magnitudes([slope], state)
            if not curve.is_zero and x not in symbols([curve]) and abs(value) > VANISHES * size:
                found.append(
                    _Square(x, [y for y in asked if y in held and y is not x], [residual, slope, curve])
                )
                fixed |= held
                break
    return found


def _adds_up(node: Node) -> bool:
    """Return whether a node is a polynomial in its arguments."""
    return node.op in ("add", "scale") or (node.op == "mul" and min(node.value) > 0)


def _scalars(states: States) -> list[Node]:
    """Return the coordinates that are no parts of quaternions, and the parameters."""
    quaternions = {states.q[i + k] for i in states.quaternions for k in range(4)}
    return [x for x in (*states.q, *(p.symbol for p in states.model.parameters)) if x not in quaternions]


def _solvable(asked: Sequence[Node], residuals: Sequence[Node]) -> list[Node]:
    """Return symbols of `asked` in which all residuals together are linear."""
    if not residuals or len(residuals) > _MOST_ROWS:
        return []
    graph = residuals[0].graph
    slopes = [gradient(graph, {x: graph.one}, asked) for x in residuals]
    found: list[Node] = []
    # One unknown after the other joins if the slopes by those before stay free of it, and its own of them.
    inside: set[Node] = set()  # symbols of the slopes by those found
    for x in asked:
        own = symbols([table[x] for table in slopes if x in table])
        if any(x in table for table in slopes) and x not in inside | own and own.isdisjoint(found):
            found.append(x)
            inside |= own
    return found


def _solvable_residuals(
    residuals: Sequence[Node], unknowns: Sequence[Node], state: Mapping[Node, float]
) -> list[Node]:
    """Return the residuals that can be solved for the unknowns together at `state`."""
    graph = unknowns[0].graph
    # Rows that are independent in these unknowns at a state of the motion.
    sizes = [abs(state[x]) or 1.0 for x in unknowns]
    place = {x: k for k, x in enumerate(unknowns)}
    slopes = [gradient(graph, {x: graph.one}, unknowns) for x in residuals]
    entries = iter(magnitudes([node for table in slopes for node in table.values()], state))
    matrix = [dense({place[x]: next(entries) for x in table}, sizes) for table in slopes]
    return [residuals[k] for k in Span(matrix).independent()]


class _Motion(_Placing):
    """Accelerations and multipliers too."""

    def __init__(
        self,
        equations: EquationsOfMotion,
        states: States,
        rows: Sequence[tuple[int, Row]],
        tries: Sequence[Mapping[Node, float]],
    ):
        kept = [row for _, row in rows]
        super().__init__(states, kept, tries)
        flat = [
            *equations.mass_matrix.values(),
            *equations.given_forces,
            *equations.bias_forces,
            *(row.gamma for row in kept),
            *(x for row in kept for x in row.jacobian.values()),
        ]
        self._flat = spelt_out(states.graph, flat)
        self.support = [*self.support, *self._flat]
        self._places = list(equations.mass_matrix)
        self._columns = [list(row.jacobian) for row in kept]
        self._unknown = [*equations.a, *(row.multiplier for _, row in rows)]
        self._others = [x for k, x in enumerate(equations.lam) if k not in {k for k, _ in rows}]

    def place(self, point: Point, truths: Truths) -> bool:
        met = super().place(point, truths)
        matrix, right = self._system(point.values(self._flat, truths))
        table = [{RIGHT: r % P, **{j: x % P for j, x in row.items()}} for row, r in zip(matrix, right)]
        found = solve_exactly(table, range(len(self._unknown)), point.draw)
        if found is None:
            return False
        point.place({**{self._unknown[j]: x for j, x in found.items()}, **dict.fromkeys(self._others, 0)})
        return met

    def with_motion(self, state: Mapping[Node, float]) -> dict[Node, float] | None:
        """Return `state` with the a and lam of its motion; None if the system is singular there."""
        matrix, right = self._system(evaluate(self._flat, state))
        dense = [[row.get(j, 0.0) for j in range(len(right))] for row in matrix]
        solution = solve(dense, right) if all(map(math.isfinite, chain(right, *dense))) else None
        if solution is None:
            return None
        return {**state, **dict.fromkeys(self._others, 0.0), **dict(zip(self._unknown, solution))}

    def _system(self, values: Sequence[Number]) -> tuple[list[dict[int, Number]], list[Number]]:
        """Return the matrix and the right-hand side of M a - G^T lam = tau - h, G a = gamma."""
        entry = iter(values)
        n, p = len(self.states.v), len(self._columns)
        matrix: list[dict[int, Number]] = [{} for _ in range(n + p)]
        for i, j in self._places:
            matrix[i][j] = matrix[j][i] = next(entry)
        given = [next(entry) for _ in range(n)]
        right = [t - next(entry) for t in given] + [next(entry) for _ in range(p)]
        for k, columns in enumerate(self._columns, n):
            for j in columns:
                x = next(entry)
                matrix[k][j], matrix[j][k] = x, -x
        return matrix, right
