"""A particle on a line under a constant force, with clauses `when` that change its place and speed: walls,
kicks, speed limits; and its motion to 40 digits."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from random import Random

from mpmath import mp, mpf, sqrt

DIGITS = 40
STOP = 5.0
HERE = mpf(10) ** -25
MOST = 60  # events
State = tuple[mpf, mpf]


@dataclass
class Clause:
    """It acts where c0 + ct t + cx x + cv v passes zero upwards."""

    condition: str
    action: str
    c: tuple[float, float, float, float]
    change: Callable[[mpf, mpf], State]


@dataclass
class Case:
    x: float
    v: float
    force: float
    clauses: list[Clause] = field(default_factory=list)

    @property
    def text(self) -> str:
        start = f"start = {self.x!r} [m], rate = {self.v!r} [m/s], fixed = true"
        lines = "".join(f"  when {c.condition} then {c.action}; end when;\n" for c in self.clauses)
        return (f"model M\n  coordinate Length x({start});\n"
                "  body b = Particle(mass = 1 [kg], at = {x, 0, 0});\n"
                f"  force f = {{{self.force!r} [N], 0, 0}} at b;\n{lines}end M;")  # fmt: skip


def case(seed: int) -> Case:
    chance = Random(seed)
    made = Case(chance.uniform(-1.0, 1.0), chance.uniform(-3.0, 3.0), chance.uniform(-10.0, 10.0))
    for kind in chance.sample((_floor, _ceiling, _kick, _kick, _limit, _return), chance.randint(1, 4)):
        made.clauses.append(kind(chance))
    return made


def _bounce(chance: Random) -> tuple[str, Callable[[mpf, mpf], State]]:
    e = chance.uniform(0.5, 1.2)
    return f"reinit(der(x), -{e!r}*der(x))", lambda x, v: (x, -e * v)


def _floor(chance: Random) -> Clause:
    place = -chance.uniform(1.0, 2.0)
    return Clause(f"x < {place!r} [m]", *_first(_bounce(chance), (place, 0.0, -1.0, 0.0)))


def _ceiling(chance: Random) -> Clause:
    place = chance.uniform(1.0, 2.0)
    return Clause(f"{place!r} [m] <= x", *_first(_bounce(chance), (-place, 0.0, 1.0, 0.0)))


def _kick(chance: Random) -> Clause:
    time, more = chance.uniform(0.0, STOP), chance.uniform(-3.0, 3.0)
    return Clause(
        f"time >= {time!r} [s]", f"reinit(der(x), der(x) + {more!r} [m/s])", (-time, 1.0, 0.0, 0.0),
        lambda x, v: (x, v + more),
    )  # fmt: skip


def _limit(chance: Random) -> Clause:
    speed, share = chance.uniform(3.0, 6.0), chance.uniform(-0.9, 0.9)
    return Clause(
        f"der(x) > {speed!r} [m/s]", f"reinit(der(x), {share!r}*der(x))", (-speed, 0.0, 0.0, 1.0),
        lambda x, v: (x, share * v),
    )  # fmt: skip


def _return(chance: Random) -> Clause:
    place, back = chance.uniform(0.5, 1.5), chance.uniform(-0.9, 0.4)
    return Clause(
        f"x > {place!r} [m]", f"reinit(x, {back!r} [m]); reinit(der(x), 0.5*der(x))", (-place, 0.0, 1.0, 0.0),
        lambda x, v: (mpf(back), mpf(0.5) * v),
    )  # fmt: skip


def _first(action: tuple[str, Callable[[mpf, mpf], State]], c: tuple[float, float, float, float]):  # type: ignore[no-untyped-def]
    return action[0], c, action[1]


@mp.workdps(DIGITS)
def motion(made: Case, times: Sequence[float]) -> tuple[list[State], list[mpf]] | None:
    """The states at `times`, and the times of events; None where these are very many, or one time is too near
    to an event to be on either side of it."""
    a, t, x, v = mpf(made.force), mpf(0), mpf(made.x), mpf(made.v)
    states: list[State] = []
    events: list[mpf] = []
    while len(states) < len(times):
        found = [(_next(c.c, t, x, v, a), k) for k, c in enumerate(made.clauses)]
        soon = min([when for when, _ in found if when is not None], default=mpf(2 * STOP))
        while len(states) < len(times) and times[len(states)] < soon:
            h = mpf(times[len(states)]) - t
            states.append((x + h * (v + h * a / 2), v + h * a))
        if len(states) == len(times):
            break
        h = soon - t
        t, x, v = soon, x + h * (v + h * a / 2), v + h * a
        due = [k for when, k in found if when is not None and when - soon < HERE]
        while due:
            events.append(t)
            if len(events) > MOST:
                return None
            before = [_holds(c.c, t, x, v, a) for c in made.clauses]
            for k in due:
                x, v = made.clauses[k].change(x, v)
            after = [_holds(c.c, t, x, v, a) for c in made.clauses]
            due = [k for k, (b, c) in enumerate(zip(before, after)) if c and not b]
    if any(abs(mpf(time) - event) < 1e-3 for time in times for event in events):
        return None
    return states, events


def _value(c: Sequence[float], t: mpf, x: mpf, v: mpf) -> mpf:
    return c[0] + c[1] * t + c[2] * x + c[3] * v


def _holds(c: Sequence[float], t: mpf, x: mpf, v: mpf, a: mpf) -> bool:
    value = _value(c, t, x, v)
    return value > HERE or (abs(value) <= HERE and c[1] + c[2] * v + c[3] * a > 0)


def _next(c: Sequence[float], t: mpf, x: mpf, v: mpf, a: mpf) -> mpf | None:
    """When the condition comes true next."""
    e0, e1, e2 = _value(c, t, x, v), c[1] + c[2] * v + c[3] * a, mpf(c[2]) * a / 2
    if e2 == 0:
        roots = [-e0 / e1] if e1 else []
    else:
        inside = e1 * e1 - 4 * e2 * e0
        roots = [(-e1 + s * sqrt(inside)) / (2 * e2) for s in (1, -1)] if inside > 0 else []
    ahead = [h for h in roots if h > HERE and e1 + 2 * e2 * h > 0]
    return t + min(ahead) if ahead else None
