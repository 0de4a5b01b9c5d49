"""Random motions at which velocities are compared: bare ones, or those that the constraints allow."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence

from lagc.base.records import dataclass
from lagc.mechanics.formulation.equations import Row
from lagc.mechanics.formulation.states import States
from lagc.mechanics.identities.constraint_manifold import onto
from lagc.mechanics.numeric.samples import Chance, samples
from lagc.semantics.model import Frame
from lagc.symbolic.evaluate import evaluate, extend
from lagc.symbolic.graph import Node
from lagc.symbolic.vectors import dot, sub

_STATES = 4  # positions that are tried
_MOTIONS = 16  # from each of them
_LARGEST = 60  # speeds and rows beyond which motions on the constraints are not looked for
_NEAR_REST = 1e-9  # of the rates, where a law has no value at rest
KEPT = 1e-7  # what is left, relative, of what vanishes on states that meet the rows to 1e-12

Numbers = tuple[float, float, float]
State = dict[Node, float]


@dataclass(frozen=True, slots=True)
class Motion:
    """A state of the motion and the same at rest; both give rates and declared speeds, and keep what is
    found in them.  `place` counts the positions that motions are from."""

    place: int
    state: State
    rest: State
    near: tuple[State, State]  # all but at rest, forth and back

    def change(self, find: Callable[[State], Numbers]) -> Numbers:
        """What the rates bring of a vector."""
        moving, still = find(self.state), find(self.rest)
        if not all(map(math.isfinite, still)):  # a law such as that of dry friction: its mean
            forth, back = (find(state) for state in self.near)
            still = _halfway(forth, back)
        return sub(moving, still)

    def given(self, values: Mapping[Node, float]) -> Motion:
        """The same with other values of parameters."""

        def changed(state: State) -> State:
            return {**{x: value for x, value in state.items() if x.op == "symbol"}, **values}

        near = changed(self.near[0]), changed(self.near[1])
        return Motion(self.place, changed(self.state), changed(self.rest), near)

    def towards(self, other: Motion, share: float) -> Motion:
        """That share of the way to another motion from the same place."""

        def part(a: State, b: State) -> State:
            return {x: value + share * (b[x] - value) for x, value in a.items() if x.op == "symbol"}

        near = part(self.near[0], other.near[0]), part(self.near[1], other.near[1])
        return Motion(self.place, part(self.state, other.state), self.rest, near)


def random_motions(
    states: States,
    rows: Sequence[Row] = (),
    sizes: Mapping[Node, float] | None = None,
    each: int = _MOTIONS,
    vary: bool = True,
) -> Iterator[Motion]:
    """Random motions, with speeds up to `sizes` (1 where none is given), `each` from a place: those that
    `rows` allow, where they are not too many to tell.  With `vary` off the parameters keep their values."""
    chance = Chance(77003)
    bound = onto(states, rows) if rows and len(rows) + len(states.v) <= _LARGEST else None
    for place, sample in enumerate(samples(states.model, _STATES, vary)):
        for _ in range(each):
            speeds = {v: (sizes or {}).get(v, 1.0) * chance.draw() for v in states.v}
            given = {**sample, **speeds}
            state = given if bound is None else bound(given)
            if state is None:
                break
            sample = {**sample, **{q: state[q] for q in states.q}}
            yield _motion(states, state, place)


def equal_speeds(
    states: States, moving: Sequence[Node], vectors: Sequence[Callable[[State], Numbers]]
) -> dict[Node, float]:
    """For each speed of `moving` the size at which alone it brings 1 to the largest of `vectors`."""
    found: dict[Node, float] = {}
    still = dict.fromkeys(states.v, 0.0)
    for sample in samples(states.model, 1):
        for v in moving:
            alone = _motion(states, {**sample, **still, v: 1.0})
            size = max(length(alone.change(vector)) for vector in vectors)
            if size > 0.0:
                found[v] = 1.0 / size
    return found


def _motion(states: States, state: State, place: int = 0) -> Motion:
    rates = dict(zip(states.rates, evaluate(list(states.rates.values()), state)))

    def at(factor: float) -> State:
        scaled = {**state, **{rate: factor * x for rate, x in rates.items()}}
        spelt = states.spelt
        return {**scaled, **dict(zip(spelt, evaluate(list(spelt.values()), scaled)))}

    return Motion(place, at(1.0), at(0.0), (at(_NEAR_REST), at(-_NEAR_REST)))


def values(vector: Sequence[Node], state: State) -> Numbers:
    extend(state, vector)
    x, y, z = vector
    return state[x], state[y], state[z]


def turned(frame: Frame, x: Numbers, state: State) -> Numbers:
    """Components in `frame` to those in the world."""
    a, b, c = (dot(values(row, state), x) for row in frame.axes)
    return a, b, c


def scaled(c: float, a: Numbers) -> Numbers:
    return c * a[0], c * a[1], c * a[2]


def _halfway(a: Numbers, b: Numbers) -> Numbers:
    return (a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2


def length(a: Numbers) -> float:
    return math.hypot(*a)
