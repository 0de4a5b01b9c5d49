"""Loads that oppose one velocity and act on another: warnings, the equations stay as written.

Where friction was meant, such a load can bring energy.  What a load does that depends on the rates,
its vector less that at rest, opposes a velocity where its power on it is never positive.  That is
asked at random motions that the constraints allow: velocities that are the same there are the same.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from itertools import chain, combinations, groupby, islice

from lagc.base.records import dataclass
from lagc.diagnostics.faults import Fault, Span
from lagc.mechanics.formulation.equations import Contribution, Row
from lagc.mechanics.formulation.states import States
from lagc.mechanics.lint.dissipation_sign import takes
from lagc.mechanics.lint.random_motions import (
    KEPT,
    Motion,
    Numbers,
    State,
    equal_speeds,
    length,
    random_motions,
    scaled,
    turned,
    values,
)
from lagc.mechanics.numeric.cancellation import VANISHES
from lagc.semantics.model import Force, Frame, Model, Parameter, Torque
from lagc.symbolic.graph import Node
from lagc.symbolic.vectors import Vector, add, cross, dot, sub
from lagc.symbolic.walk import depends, symbols

Load = Force | Torque
_PLACES = 2  # at which a load is asked whether it takes energy from every motion
_NEXT = 5  # motions that each is taken together with, less 1
_MOST = 40  # loads that are looked at
_APART = 1e-3  # of a velocity: what it keeps beside others
_NEAR = 12  # bodies or frames whose velocities a load is compared with


@dataclass(frozen=True, slots=True)
class _Velocity:
    """The sum of `sign` * axes . components (world axes where `axes` is None), and its words."""

    terms: tuple[tuple[float, Frame | None, Vector], ...]
    words: str
    span: Span | None = None

    @property
    def nodes(self) -> list[Node]:
        return [x for _, _, vector in self.terms for x in vector]

    def less(self, other: _Velocity) -> _Velocity:
        opposite = tuple([(-sign, frame, vector) for sign, frame, vector in other.terms])
        return _Velocity((*self.terms, *opposite), f"{self.words} - {other.words}", self.span)

    def value(self, state: State) -> Numbers:
        total = [0.0, 0.0, 0.0]
        for sign, frame, vector in self.terms:
            x = values(vector, state)
            if frame is not None:
                x = turned(frame, x, state)
            for k in range(3):
                total[k] += sign * x[k]
        return total[0], total[1], total[2]


@dataclass(frozen=True, slots=True)
class _Pair:
    """Loads of one vector, forth and back, and the velocity that their power is taken on."""

    load: Load
    acted: _Velocity

    def vector(self, state: State) -> Numbers:
        return values(self.load.vector, state)

    def power(self, motion: Motion, velocity: _Velocity) -> tuple[float, float]:
        """Of what the rates bring of the vector, on what they bring of a velocity; and its size."""
        force, moved = motion.change(self.vector), motion.change(velocity.value)
        return dot(force, moved), length(force) * length(moved)


def feeding_loads(
    states: States, rows: Sequence[Row], contributions: Sequence[Contribution]
) -> Iterator[Fault]:
    """LAG0412 of loads that oppose another velocity than that which they act on, or that which they act
    on in some directions and not in others, or that a negative parameter turns from a friction into a
    drive."""
    moved = _moved(states)
    brought = {c.name: c for c in contributions}
    places = list(islice(random_motions(states, each=1, vary=False), _PLACES)) if moved else []
    taking = {load.name: takes(states, brought[load.name], places) for load in moved}
    fair = [load for load in moved if _is_plain(load) and not _negative(states, load)]
    loads = [x for x in moved if not taking[x.name] and (x not in fair or taking[x.name] is False)][:_MOST]
    pairs = _paired(loads, list(random_motions(states))) if loads else []
    for pair in pairs:
        moving = _speeds_of(states, pair)
        sizes = equal_speeds(states, moving, [v.value for v in (pair.acted, *_written(pair.load))])
        if not _brings(pair, random_motions(states, (), sizes)):
            continue
        negative = _negative(states, pair.load)
        upright = {p.symbol: abs(p.value or 0.0) for p in negative}
        if negative and _takes(
            pair, pair.acted, [m.given(upright) for m in random_motions(states, (), sizes)]
        ):
            yield _turned(pair.load, negative)
            continue
        candidates = [] if _is_plain(pair.load) else list(_candidates(states, pair))
        sizes = equal_speeds(states, moving, [pair.acted.value, *(c.value for c in candidates)])
        motions = list(random_motions(states, rows, sizes))
        if not _brings(pair, motions) or _take_together(pairs, motions):
            continue
        opposed = next((c for c in candidates if _takes(pair, c, motions)), None)
        if opposed:
            yield _opposes_another(pair, opposed)
        elif _is_split(pair, motions) and not _take_together([_Pair(x, _acted(x)) for x in moved], motions):
            yield _opposes_in_part(pair)


def _speeds_of(states: States, pair: _Pair) -> list[Node]:
    """The speeds that the vector or the velocity depends on: all of them where some are declared."""
    if not states.plain:
        return list(states.v)
    reached = symbols([*pair.load.vector, *pair.acted.nodes])
    return [v for v in states.v if v in reached]


def _moved(states: States) -> list[Load]:
    """The loads that depend on the rates."""
    loads = [x for x in states.model.actions if isinstance(x, Load)]
    rates = [*states.rates, *(speed.symbol for speed in states.model.speeds)]
    moving = depends(chain.from_iterable(x.vector for x in loads), rates)
    return [x for x in loads if not moving.isdisjoint(x.vector)]


def _negative(states: States, load: Load) -> list[Parameter]:
    """The parameters that the load depends on and whose values are negative."""
    known = symbols(load.vector)
    return [p for p in states.model.parameters if p.value is not None and p.value < 0.0 and p.symbol in known]


def _is_plain(load: Load) -> bool:
    """Whether it is written with the velocity that it acts on, and with no other."""
    written = list(dict.fromkeys(vector for vector, _ in load.mentioned))
    if isinstance(load, Force):
        return written == [load.velocity]
    return load.reaction is None and written == [load.frame.spin]


def _is_split(pair: _Pair, motions: Sequence[Motion]) -> bool:
    """Whether from one place the vector is a linear function of the velocity that is acted on, and of
    nothing else that moves, with power of both signs on it."""
    for _, group in groupby(motions, lambda motion: motion.place):
        here = list(group)
        powers = list(_powers(pair, here))
        taken = any(p < -KEPT * size for p, size in powers)
        if taken and any(p > KEPT * size for p, size in powers) and _is_law(pair, here):
            return True
    return False


def _is_law(pair: _Pair, motions: Sequence[Motion]) -> bool:
    """Whether motions from one place with velocities that are combinations of others' have the vectors
    that are the same combinations."""
    known: list[tuple[Numbers, Numbers]] = []  # velocities of length 1, orthogonal to each other
    for motion in motions:
        velocity, force = motion.change(pair.acted.value), motion.change(pair.vector)
        reach, size = length(velocity), length(force)
        for v, f in known:
            part = dot(v, velocity)
            velocity, force = sub(velocity, scaled(part, v)), sub(force, scaled(part, f))
            size += abs(part) * length(f)
        left = length(velocity)
        if left > _APART * reach:
            known.append((scaled(1.0 / left, velocity), scaled(1.0 / left, force)))
        elif not length(force) <= KEPT / _APART * size:
            return False
    return True


def _brings(pair: _Pair, motions: Iterable[Motion]) -> bool:
    """Whether the power on the velocity that is acted on is ever positive."""
    return any(p > KEPT * size for p, size in _powers(pair, motions))


def _powers(pair: _Pair, motions: Iterable[Motion]) -> Iterator[tuple[float, float]]:
    """Of motions, and between each two from one place where it is the largest, for a law that is linear in
    the rates."""
    known: list[tuple[Motion, float]] = []
    for motion in motions:
        power, size = pair.power(motion, pair.acted)
        known.append((motion, power))
        yield power, size
    for (one, start), (other, end) in chain(*(zip(known, known[k:]) for k in range(1, _NEXT))):
        if one.place == other.place:
            middle, _ = pair.power(one.towards(other, 0.5), pair.acted)
            bend = start + end - 2.0 * middle
            if bend < 0.0:
                yield pair.power(one.towards(other, 0.5 - 0.25 * (end - start) / bend), pair.acted)


def _takes(pair: _Pair, velocity: _Velocity, motions: Sequence[Motion]) -> bool:
    """Whether the power is never positive, and not zero throughout."""
    powers = [pair.power(motion, velocity) for motion in motions]
    known = [(p, size) for p, size in powers if math.isfinite(p)]
    return any(p < -KEPT * size for p, size in known) and all(p <= KEPT * size for p, size in known)


def _take_together(pairs: Sequence[_Pair], motions: Sequence[Motion]) -> bool:
    for motion in motions:
        powers = [pair.power(motion, pair.acted) for pair in pairs]
        if sum(p for p, _ in powers) > KEPT * sum(size for _, size in powers):
            return False
    return True


def _paired(loads: Sequence[Load], motions: Sequence[Motion]) -> list[_Pair]:
    """Loads with the vectors of others, or their opposites, taken together with these."""
    found: list[_Pair] = []
    for load in loads:
        velocity = _acted(load)
        for k, pair in enumerate(found):
            sign = _ratio(load, pair.load, motions) if type(load) is type(pair.load) else 0
            if sign:
                terms = tuple([(sign * s, frame, vector) for s, frame, vector in velocity.terms])
                acted = _Velocity((*pair.acted.terms, *terms), pair.acted.words)
                found[k] = _Pair(pair.load, acted)
                break
        else:
            found.append(_Pair(load, velocity))
    return found


def _acted(load: Load) -> _Velocity:
    words = load.target.text if load.target else ""
    if isinstance(load, Force):
        return _Velocity(((1.0, None, load.velocity),), words)
    terms = [(1.0, load.frame, load.frame.angular_velocity)]
    if load.reaction is not None:
        terms.append((-1.0, load.reaction, load.reaction.angular_velocity))
    return _Velocity(tuple(terms), words)


def _ratio(one: Load, other: Load, motions: Sequence[Motion]) -> int:
    """1 or -1 where the vectors are equal or opposite, else 0."""
    signs = {1, -1}
    for motion in motions:
        a, b = values(one.vector, motion.state), values(other.vector, motion.state)
        size = VANISHES * (length(a) + length(b))
        signs -= {s for s in signs if not length((a[0] - s * b[0], a[1] - s * b[1], a[2] - s * b[2])) <= size}
        if not signs:
            break
    return max(signs, default=0)


def _written(load: Load) -> list[_Velocity]:
    return [_Velocity(((1.0, None, v),), span.text, span) for v, span in load.mentioned]


def _candidates(states: States, pair: _Pair) -> Iterator[_Velocity]:
    """What a load may be meant to oppose: velocities that it was written with, those of bodies or frames
    that move with what it depends on, of the bodies' material points where it acts, and of frames in the
    frames that they turn in; and the differences of these."""
    load, model = pair.load, states.model
    written = _written(load)
    yield from written
    for a, b in combinations(written, 2):
        yield a.less(b)
    rates = symbols(states.in_rates(load.vector)) & states.rates.keys()
    known = list(_of_bodies(model, load) if isinstance(load, Force) else _of_frames(model))
    near = [v for v in known if rates & symbols(states.in_rates(v.nodes))][:_NEAR]
    yield from near
    for a in near:
        yield from (a.less(b) for b in known[:_NEAR] if b is not a)


def _of_bodies(model: Model, load: Force) -> Iterator[_Velocity]:
    for body in model.bodies:
        yield _Velocity(((1.0, None, body.velocity),), f"velocity({body.name})")
    point = load.target.text if load.target else ""
    for body in model.bodies:
        if load.at is not None and body.frame is not None:
            velocity = add(body.velocity, cross(body.frame.spin, sub(load.at, body.position)))
            yield _Velocity(((1.0, None, velocity),), f"velocity({body.name}, at = {point})")


def _of_frames(model: Model) -> Iterator[_Velocity]:
    for frame in model.frames:
        yield _Velocity(((1.0, frame, frame.angular_velocity),), f"angular_velocity({frame.name})")


def _turned(load: Load, negative: Sequence[Parameter]) -> Fault:
    names = ", ".join(f"`{p.name}`" for p in negative)
    return Fault(
        "LAG0412",
        f"`{load.name}` brings energy into the system: with {names} above zero it would oppose the motion "
        "that it acts on",
        load.span,
        remedy=f"give {names} the other sign; a drive may stay as it is",
        severity="warning",
    )


def _opposes_in_part(pair: _Pair) -> Fault:
    load = pair.load
    return Fault(
        "LAG0412",
        f"`{load.name}` opposes the velocity of `{pair.acted.words}` in some directions and drives it in "
        "others: it can bring energy into the system",
        load.span,
        remedy="a friction that is linear in the velocity has coefficients of one sign, and those between "
        "directions are smaller: c12 + c21 <= 2*sqrt(c11*c22); what drives may stay as it is",
        severity="warning",
    )


def _opposes_another(pair: _Pair, opposed: _Velocity) -> Fault:
    load = pair.load
    kind = "force" if isinstance(load, Force) else "torque"
    acts = f"acts {'at' if kind == 'force' else 'on'} `{pair.acted.words}`, which moves otherwise"
    remedy = (
        "a friction acts on the velocity that it opposes: write both alike, "
        + (
            "`velocity(b, at = P)` with `on b at P`, or `velocity(P)` with `at P`"
            if kind == "force"
            else "`angular_velocity(B) - angular_velocity(A)` with `on B from A`"
        )
        + ", and its opposite on the other body; a drive or a control may stay as it is"
    )
    return Fault(
        "LAG0412",
        f"`{load.name}` opposes the velocity `{opposed.words}` and {acts}: "
        "it can bring energy into the system",
        load.target,
        () if opposed.span is None else ((opposed.span, "the velocity that it opposes"),),
        remedy,
        "warning",
    )
