"""Passivity check: warnings of loads and dissipations that can add energy although friction was meant.

A load opposes a velocity if the quadratic form of minus its power on that velocity is nowhere negative. The
form consists of derivatives by the speeds, at a few configurations with the values of the parameters, and at
random speeds if the law is not linear.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import chain, combinations

from lagc.base.records import dataclass
from lagc.diagnostics.faults import Fault, Span
from lagc.mechanics.formulation.equations import Contribution, Row
from lagc.mechanics.formulation.states import States
from lagc.mechanics.lint.velocity_maps import (
    KEPT,
    LARGEST,
    Maps,
    Matrix,
    Pose,
    combined,
    has_minimum,
    poses,
    power_form,
)
from lagc.mechanics.numeric.cancellation import VANISHES, magnitudes
from lagc.mechanics.numeric.dense_linear import Span as Spanned
from lagc.mechanics.numeric.dense_linear import dot
from lagc.semantics.model import Force, Model, Parameter, Torque
from lagc.symbolic.derivative import gradient
from lagc.symbolic.evaluate import evaluate
from lagc.symbolic.graph import Node
from lagc.symbolic.vectors import Vector, add, cross, sub
from lagc.symbolic.walk import depends, reachable, symbols

Load = Force | Torque
_POLYNOMIAL = ("symbol", "add", "scale", "mul")
_MOST = 40  # loads that are looked at
_NEAR = 12  # bodies or frames whose velocities a load is compared with


@dataclass(frozen=True, slots=True)
class _Velocity:
    """The sum of `sign` * vector (world components, in rates), and its words."""

    terms: tuple[tuple[float, Vector], ...]
    words: str
    span: Span | None = None

    def less(self, other: _Velocity) -> _Velocity:
        opposite = tuple([(-sign, vector) for sign, vector in other.terms])
        return _Velocity((*self.terms, *opposite), f"{self.words} - {other.words}", self.span)


@dataclass(frozen=True, slots=True)
class _Pair:
    """Loads of one vector, forth and back, and the velocity that their power is taken on."""

    load: Load
    acted: _Velocity


class _Forms:
    """Forms of power at configurations, bare and on the constraints."""

    def __init__(self, states: States, rows: Sequence[Row]):
        self.maps = Maps(states)
        self.bare = poses(states)
        self.bound = poses(states, rows) if rows else self.bare

    def of(self, load: Load, velocity: _Velocity, pose: Pose) -> Matrix:
        moved = combined((sign, self.maps.at(vector, pose)) for sign, vector in velocity.terms)
        return power_form(pose.along(self.maps.at(load.vector, pose)), pose.along(moved))

    def takes(self, load: Load, velocity: _Velocity, at: Sequence[Pose]) -> bool:
        """Return whether the form is nowhere negative, and not zero throughout."""
        forms = [self.of(load, velocity, pose) for pose in at]
        return all(map(has_minimum, forms)) and any(x for form in forms for row in form for x in row)

    def brings(self, loads: Sequence[tuple[Load, _Velocity]], at: Sequence[Pose]) -> bool:
        """Return whether the sum of the forms is negative in some direction."""
        for pose in at:
            forms = [(1.0, self.of(load, velocity, pose)) for load, velocity in loads]
            if not has_minimum(combined(forms)):
                return True
        return False

    def is_law(self, pair: _Pair, pose: Pose) -> bool:
        """Return whether the vector depends on the velocity of its point and on no other motion, with power
        of both signs."""
        moved = combined((sign, self.maps.at(vector, pose)) for sign, vector in pair.acted.terms)
        force, held = self.maps.at(pair.load.vector, pose), Spanned(moved)
        for row in force:
            rest = held.remainder(row)
            if dot(rest, rest) > KEPT**2 * dot(row, row):
                return False
        form = self.of(pair.load, pair.acted, pose)
        return not has_minimum(form) and not has_minimum(combined([(-1.0, form)]))


def active_loads(states: States, rows: Sequence[Row]) -> Iterator[Fault]:
    """Yield LAG0412 of loads that oppose another velocity than the one they act on, or oppose that one in
    some directions only, or that a negative parameter turns into a drive."""
    loads = _moved(states)[:_MOST]
    if not loads or len(states.v) > LARGEST:
        return
    forms = _Forms(states, rows)
    acted = [(load, _acted(load)) for load in loads]
    doubtful = [x for x in acted if forms.brings([x], forms.bare)]
    linear = [x for x, _ in doubtful if _is_linear(states, forms, x)]
    asked = [x for x, _ in doubtful if not _is_plain(x) or x in linear or _negative(states, x)]
    pairs = [pair for pair in _paired(forms, asked) if forms.brings([(pair.load, pair.acted)], forms.bare)]
    together = [(pair.load, pair.acted) for pair in pairs]
    if not pairs or not forms.brings(together, forms.bound):
        return
    for pair in pairs:
        negative = _negative(states, pair.load)
        upright = {p.symbol: abs(p.value or 0.0) for p in negative}
        if negative and forms.takes(pair.load, pair.acted, [x.given(upright) for x in forms.bare]):
            yield _turned(pair.load, negative)
            continue
        if not forms.brings([(pair.load, pair.acted)], forms.bound):
            continue
        candidates = iter(()) if _is_plain(pair.load) else _candidates(states, pair)
        opposed = next((c for c in candidates if forms.takes(pair.load, c, forms.bound)), None)
        if opposed:
            yield _opposes_another(pair, opposed)
            continue
        splits = pair.load in linear and any(forms.is_law(pair, x) for x in forms.bare)
        if splits and forms.brings(acted, forms.bound):
            yield _opposes_in_part(pair)


def _moved(states: States) -> list[Load]:
    """Return the loads that depend on the rates, and on no reaction."""
    loads = [x for x in states.model.actions if isinstance(x, Load)]
    rates = [*states.rates, *(speed.symbol for speed in states.model.speeds)]
    moving = depends(chain.from_iterable(x.vector for x in loads), rates)
    found = [x for x in loads if not moving.isdisjoint(x.vector)]
    return [x for x in found if all(s.record.kind != "multiplier" for s in symbols(x.vector))]


def _is_linear(states: States, forms: _Forms, load: Load) -> bool:
    return not depends([x for row in forms.maps.slopes(load.vector) for x in row.values()], states.v)


def _negative(states: States, load: Load) -> list[Parameter]:
    """Return the parameters that the load depends on and whose values are negative."""
    known = symbols(load.vector)
    return [p for p in states.model.parameters if p.value is not None and p.value < 0.0 and p.symbol in known]


def _is_plain(load: Load) -> bool:
    """Return whether it is written with the velocity that it acts on, and with no other."""
    written = list(dict.fromkeys(vector for vector, _ in load.mentioned))
    if isinstance(load, Force):
        return written == [load.velocity]
    return load.reaction is None and written == [load.frame.spin]


def _paired(forms: _Forms, loads: Sequence[Load]) -> list[_Pair]:
    """Return loads, those with the vectors of others, or their opposites, taken together with these."""
    found: list[_Pair] = []
    for load in loads:
        velocity = _acted(load)
        for k, pair in enumerate(found):
            sign = _ratio(load, pair.load, forms.bare) if type(load) is type(pair.load) else 0.0
            if sign:
                terms = tuple([(sign * s, vector) for s, vector in velocity.terms])
                found[k] = _Pair(pair.load, _Velocity((*pair.acted.terms, *terms), pair.acted.words))
                break
        else:
            found.append(_Pair(load, velocity))
    return found


def _ratio(one: Load, other: Load, at: Sequence[Pose]) -> float:
    """Return 1 or -1 where the vectors are equal or opposite, else 0."""
    signs = [1.0, -1.0]
    for pose in at:
        a, b = (evaluate(x.vector, pose.state) for x in (one, other))
        size = VANISHES * (max(map(abs, a)) + max(map(abs, b)))
        signs = [s for s in signs if all(abs(x - s * y) <= size for x, y in zip(a, b))]
    return signs[0] if signs and at else 0.0


def _acted(load: Load) -> _Velocity:
    words = load.target.text if load.target else ""
    if isinstance(load, Force):
        return _Velocity(((1.0, load.velocity),), words)
    terms = [(1.0, load.frame.spin)]
    if load.reaction is not None:
        terms.append((-1.0, load.reaction.spin))
    return _Velocity(tuple(terms), words)


def _candidates(states: States, pair: _Pair) -> Iterator[_Velocity]:
    """Yield velocities that a load may be meant to oppose: those in its expression, those of bodies or frames
    that depend on the same rates, those of material points at its point, and differences."""
    load, model = pair.load, states.model
    written = [_Velocity(((1.0, v),), span.text, span) for v, span in load.mentioned]
    yield from written
    for a, b in combinations(written, 2):
        yield a.less(b)
    rates = symbols(states.in_rates(load.vector)) & states.rates.keys()
    known = list(_of_bodies(model, load) if isinstance(load, Force) else _of_frames(model))
    near = [v for v in known if rates & symbols(states.in_rates([x for _, u in v.terms for x in u]))][:_NEAR]
    yield from near
    for a in near:
        yield from (a.less(b) for b in known[:_NEAR] if b is not a)


def _of_bodies(model: Model, load: Force) -> Iterator[_Velocity]:
    for body in model.bodies:
        yield _Velocity(((1.0, body.velocity),), f"velocity({body.name})")
    point = load.target.text if load.target else ""
    for body in model.bodies:
        if load.at is not None and not load.on_body and body.frame is not None:
            velocity = add(body.velocity, cross(body.frame.spin, sub(load.at, body.position)))
            yield _Velocity(((1.0, velocity),), f"velocity({body.name}, at = {point})")


def _of_frames(model: Model) -> Iterator[_Velocity]:
    for frame in model.frames:
        yield _Velocity(((1.0, frame.spin),), f"angular_velocity({frame.name})")


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


# -- dissipations ------------------------------------------------------------------------------


def active_dissipations(
    states: States, rows: Sequence[Row], contributions: Sequence[Contribution]
) -> Iterator[Fault]:
    """Yield LAG0412 of quadratic dissipations whose form is negative or unbounded in a motion. A linear part
    in the range of the form is the drive of a damper, 1/2 c (v - u)^2."""
    spans: Mapping[str, Span] = {x.name: x.span for x in states.model.actions}
    for c in contributions:
        if c.kind == "dissipation" and c.forces and len(states.v) <= LARGEST and _falls(states, rows, c):
            yield Fault(
                "LAG0412",
                f"the dissipation `{c.name}` can bring energy into the system: there are motions along "
                "which its force points",
                spans.get(c.name),
                remedy="a dissipation grows with the rates in every direction, such as `1/2*c*der(x)^2` "
                "with c > 0, or `1/2*c*(der(x) - der(y))^2`; what drives is written as a force",
                severity="warning",
            )


def _falls(states: States, rows: Sequence[Row], c: Contribution) -> bool:
    graph, forces = states.graph, list(c.forces.values())
    if any(x.op not in _POLYNOMIAL for x in depends(reachable(forces), states.v)):
        return False
    slopes = [gradient(graph, {force: -graph.one}, states.place_of_v) for force in forces]
    if depends([x for own in slopes for x in own.values()], states.v):
        return False
    falling = [_is_unbounded(states, c, slopes, pose) for pose in poses(states)]
    if not any(falling) or not rows:
        return any(falling)
    return any(_is_unbounded(states, c, slopes, pose) for pose in poses(states, rows))


def _is_unbounded(states: States, c: Contribution, slopes: Sequence[Mapping[Node, Node]], pose: Pose) -> bool:
    n, place = len(states.v), states.place_of_v
    rest = {**pose.state, **dict.fromkeys(states.v, 0.0)}
    values = iter(magnitudes([x for own in slopes for x in own.values()], rest))
    matrix = [[0.0] * n for _ in range(n)]
    for j, own in zip(c.forces, slopes):
        for v in own:
            x, size = next(values)
            if abs(x) > VANISHES * size:
                matrix[j][place[v]] += x / 2
                matrix[place[v]][j] += x / 2
    force = [0.0] * n
    for j, (x, size) in zip(c.forces, magnitudes(list(c.forces.values()), rest)):
        force[j] = x if abs(x) > VANISHES * size else 0.0
    if pose.allowed is not None:
        halves = pose.along(matrix)
        matrix = pose.along([list(column) for column in zip(*halves)])
        (force,) = pose.along([force])
    return not has_minimum(matrix, force)
