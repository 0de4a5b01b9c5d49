"""States on the constraints: positions moved onto phi = 0, then speeds onto rate = 0.

Gauss-Newton with steps of least norm, without dependent rows, for questions of rank and consistency at
compile time. The initial state of a run is computed by `kernels.initialization`.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence

from lagc.base.records import dataclass
from lagc.mechanics.formulation.equations import Row, SlipRow
from lagc.mechanics.formulation.states import States
from lagc.mechanics.identities.linear_algebra import Span, dimension, least_norm
from lagc.mechanics.identities.samples import VANISHES, Chance, magnitudes, samples, unit_sizes
from lagc.semantics.model import UNSTATED
from lagc.symbolic.derivative import gradient
from lagc.symbolic.graph import Node
from lagc.symbolic.walk import evaluate, reachable

_ITERATIONS = 40
_CONVERGED = 1e-12
_NEAR, _FAR = 0.02, 0.4  # steps of a walk, of the sizes of the coordinates
_SHORT, _AWAY = 1e-3, 0.03  # steps by which motions are counted, and how much of one is a motion
_QUICK, _SLOW = 6, 0.3  # Newton's last steps, each half of that before where surfaces touch
_TINY, _TURNED = 1e-7, 0.1  # a step of the sizes, and how much a gradient changes that turns in it
_SPREADS = (0.0, 0.1, 0.5, 1.0, 1.0, 2.0, 2.0)  # sizes of values that nobody stated, from the guess
_STEPS = 4
_MANY = 40  # rows with which fewer states will do
LARGEST = 150  # rows for which states are looked for

State = dict[Node, float]


def onto(states: States, rows: Sequence[Row]) -> Callable[[Mapping[Node, float]], State | None]:
    """Return a function that moves a state onto `rows`; it returns None where that fails."""
    return _Manifold(states, rows).onto_rows


@dataclass(frozen=True, slots=True)
class Consistent:
    """States on the rows with the default parameters: the initial state moved onto them (None if that fails),
    states beside it, and states farther along motions that the rows allow.

    Where surfaces only touch, as a sphere and its tangent plane, no rank gives the number of motions of the
    positions; `freedom` counts them."""

    start: State | None
    beside: list[State]
    far: list[State]
    freedom: int | None = None

    @property
    def by_distance(self) -> list[State]:
        """The farthest first: the least special."""
        return [*reversed(self.far), *self.beside, *([] if self.start is None else [self.start])]


def walk(states: States, rows: Sequence[Row]) -> Consistent:
    """Return consistent states, found by steps along random motions that the rows allow."""
    # The initial state first, with its own speeds.
    manifold = _Manifold(states, rows)
    for given in samples(states.model, 1, vary=False, spread=0.0):
        start = manifold.start({**given, states.model.time: 0.0})
        if start is None:
            break
        # Near states show whether the initial state is special; far ones are the least special.
        few = len(rows) > _MANY
        beside = list(manifold.steps(start, _NEAR, 1 if few else 2, restart=True))
        turning = any(manifold.turns(state) for state in (start, *beside))
        freedom = None
        # Where surfaces touch or a gradient turns, ranks say too little: motions are counted.
        if manifold.tangential or turning:
            freedom = _Manifold(states, [row for row in rows if row.holonomic]).freedom(start)
        return Consistent(start, beside, list(manifold.steps(start, _FAR, 1 if few else _STEPS)), freedom)
    # Without an initial state on the rows: random states moved onto them.
    found = (manifold.onto_rows(s) for s in samples(states.model, _STEPS, vary=False))
    return Consistent(None, [], [s for s in found if s is not None])


def scales(states: States) -> dict[Node, float]:
    """Return the sizes of q and v; the size of a rate is that of its coordinate per second."""
    sizes = unit_sizes(states.model)
    found: dict[Node, float] = {}
    for symbols, units in ((states.q, states.q_units), (states.v, states.v_units)):
        found.update((x, sizes.get(unit.removesuffix("/s"), 1.0)) for x, unit in zip(symbols, units))
    return found


def jacobian(
    rows: Sequence[Row | SlipRow], sizes: Sequence[float], state: Mapping[Node, float]
) -> list[list[float]]:
    """Return the Jacobian of `rows` in units of the `sizes` of the speeds."""
    values = iter(magnitudes([node for row in rows for node in row.jacobian.values()], state))
    return [dense({j: next(values) for j in row.jacobian}, sizes) for row in rows]


def dense(entries: Mapping[int, tuple[float, float]], sizes: Sequence[float]) -> list[float]:
    """Return a row of values without the sizes of their terms; zero if all entries cancel to round-off."""
    # A row that cancels as a whole to round-off counts as zero, not as a direction of round-off.
    found = [0.0] * len(sizes)
    reach = max((size * sizes[j] for j, (_, size) in entries.items()), default=0.0)
    if any(abs(x) * sizes[j] > VANISHES * reach for j, (x, _) in entries.items()):
        for j, (x, _) in entries.items():
            found[j] = x * sizes[j]
    return found


class _Manifold:
    """The rows, with the sizes of the unknowns."""

    def __init__(self, states: States, rows: Sequence[Row]):
        graph = states.graph
        self.states, self.rows = states, rows
        self.scales = scales(states)
        self.chance = Chance(4096)
        norms = [graph.sum(states.q[i + k] ** 2 for k in range(4)) - 1.0 for i in states.quaternions]
        # The unit quaternions are conditions too.
        self.positions = [*(row.residual for row in rows if row.holonomic), *norms]
        self.slopes = [gradient(graph, {x: graph.one}, states.q) for x in self.positions]
        self.tangential = False  # positions were met so slowly as those of surfaces that touch

    def start(self, given: Mapping[Node, float]) -> State | None:
        """Return a state on the rows that keeps stated values if possible, from the guesses of the others or
        from points beside them. A point that is reached only linearly, as where surfaces touch, is not
        accepted."""
        states = self.states
        # First the unstated coordinates alone, from points farther and farther from the guess; then all
        # coordinates.
        free = [x for x, s in zip(states.q, states.starts_q) if s.stated.level == UNSTATED]
        slowly: State | None = None
        for moving in (free, list(states.q)):
            for spread in _SPREADS[: 1 if len(self.rows) > _MANY else None] if moving else ():
                beside = {x: given[x] + spread * self.scales[x] * self.chance.draw() for x in moving}
                self.tangential = False
                state = self.onto_rows({**given, **beside}, moving)
                if state is not None and not self.tangential:
                    return state
                slowly = slowly or state
        self.tangential = slowly is not None
        return slowly

    def onto_rows(self, given: Mapping[Node, float], free: Sequence[Node] | None = None) -> State | None:
        """Return `given` moved onto the rows by the coordinates `free`, or by all; None if that fails."""
        state, moving = dict(given), free or self.states.q
        # Positions by phi = 0, then speeds by rate = 0 at these positions.
        if len(self.rows) > LARGEST or not self._solve(self.positions, self.slopes, moving, state):
            return None
        slopes = [{self.states.v[j]: node for j, node in row.jacobian.items()} for row in self.rows]
        return state if self._solve([row.rate for row in self.rows], slopes, self.states.v, state) else None

    def turns(self, state: State) -> bool:
        """Return whether the gradient of a row turns within a tiny step, as that of a norm does where it is
        zero."""
        # The Jacobian at the state and a tiny step beside it.
        sizes = [self.scales[x] for x in self.states.v]
        near = {**state, **{q: state[q] + _TINY * self.scales[q] * self.chance.draw() for q in self.states.q}}
        for here, beside in zip(jacobian(self.rows, sizes, state), jacobian(self.rows, sizes, near)):
            largest = max(map(abs, here), default=0.0)
            changes = [abs(x - y) for x, y in zip(here, beside)]
            if not all(change <= _TURNED * largest for change in changes) and largest != 0.0:
                return True  # and where it is no number
        return False

    def freedom(self, start: State) -> int:
        """Return the dimension of the positions that short steps from the start reach in all directions that
        the rows allow."""
        # Each step leaves along another random direction; those that come back onto the rows span the motions
        # that there are.
        found: list[list[float]] = []
        for _ in range(min(len(self.states.q), _MANY) + 1):
            moved = self._displaced(start, _SHORT)
            if self._solve(self.positions, self.slopes, self.states.q, moved):
                direction = [(moved[x] - start[x]) / (_SHORT * self.scales[x]) for x in self.states.q]
                found.append(direction)
        return dimension(found, _AWAY)

    def steps(self, start: State, size: float, count: int, restart: bool = False) -> Iterator[State]:
        """Yield the states on the rows that `count` steps of `size` reach, one after another or each from the
        start."""
        state = start
        # A step that leads to no state is tried again with a tenth of its size.
        for _ in range(count):
            moved = self.onto_rows(self._displaced(state, size))
            if moved is None:
                moved = self.onto_rows(self._displaced(state, 0.1 * size))
            if moved is not None:
                yield moved
                state = start if restart else moved

    def _displaced(self, state: State, size: float) -> State:
        """Return a state displaced along a random motion that the rows allow, with other speeds and another
        time."""
        states = self.states
        sizes = [self.scales[x] for x in states.v]
        pushed = {x: self.chance.draw() * s for x, s in zip(states.v, sizes)}
        table = jacobian(self.rows, sizes, state)
        # A random vector less its part along the rows, in the sizes of the speeds: a velocity that the rows
        # allow.
        drawn = [self.chance.draw() for _ in sizes]
        direction = Span(table).remainder(drawn)
        longest = max(map(abs, direction), default=0.0) or 1.0
        # The step of the coordinates is that of qdot, without the motion that drives impose.
        rest = evaluate(states.qdot, {**state, **dict.fromkeys(states.v, 0.0)})
        speeds = {x: size * d / longest * s for x, d, s in zip(states.v, direction, sizes)}
        moved = evaluate(states.qdot, {**state, **speeds})
        places = {q: state[q] + b - a for q, a, b in zip(states.q, rest, moved)}
        pushed[states.model.time] = state[states.model.time] + size * abs(self.chance.draw())
        return {**state, **pushed, **places}

    def _solve(
        self,
        residuals: Sequence[Node],
        slopes: Sequence[Mapping[Node, Node]],
        unknowns: Sequence[Node],
        state: State,
    ) -> bool:
        flat = [*residuals, *(node for slope in slopes for node in slope.values())]
        sizes = [self.scales[x] for x in unknowns]
        place = {x: k for k, x in enumerate(unknowns)}
        lengths: list[float] = []
        below = reachable(flat)
        for _ in range(_ITERATIONS):
            values = magnitudes(flat, state, below)
            # Residuals that are round-off of their terms are met, and also those that the gradient makes so.
            if not any(value for value, _ in values[: len(residuals)]):
                return True  # whatever the slopes: a norm has none where it is zero
            if not all(math.isfinite(size) for _, size in values):
                return False
            entries = iter(values[len(residuals) :])
            tables = [{x: next(entries) for x in slope} for slope in slopes]
            matrix = [dense({place[x]: a for x, a in row.items() if x in place}, sizes) for row in tables]
            reach = [max(map(abs, row), default=0.0) for row in matrix]
            wanted = [-value for value, _ in values[: len(residuals)]]
            if all(
                abs(r) <= max(_CONVERGED * far, 8e-16 * size)
                for r, far, (_, size) in zip(wanted, reach, values)
            ):
                slow = len(lengths) > _QUICK and lengths[-1] > _SLOW**_QUICK * lengths[-1 - _QUICK]
                self.tangential = self.tangential or slow
                return True
            # The step of least norm, in units of the sizes of the unknowns (Gauss-Newton).
            step = least_norm(matrix, wanted)
            lengths.append(max(map(abs, step)))
            if lengths[-1] == 0.0:
                return False
            for x, d, size in zip(unknowns, step, sizes):
                state[x] += d * size
        return False
