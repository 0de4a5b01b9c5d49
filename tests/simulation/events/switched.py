"""A particle on a line under forces that are piecewise constant in time and place, and its motion to 40
digits: one parabola after the other."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from random import Random

from mpmath import floor, fmod, mp, mpf, sign, sqrt

DIGITS = 40
STOP = 5.0
TINY, HERE = mpf(10) ** -30, mpf(10) ** -25  # a moment later; at the same place
Force = Callable[[mpf, mpf], mpf]  # of time and place


@dataclass
class Case:
    x: float
    v: float
    terms: list[str] = field(default_factory=list)  # of the force, in the language
    forces: list[Force] = field(default_factory=list)
    times: list[mpf] = field(default_factory=list)  # at which forces change
    places: list[mpf] = field(default_factory=list)

    @property
    def text(self) -> str:
        start = f"start = {self.x!r} [m], rate = {self.v!r} [m/s], fixed = true"
        return (f"model M\n  coordinate Length x({start});\n"
                "  body b = Particle(mass = 1 [kg], at = {x, 0, 0});\n"
                f"  force f = {{{' + '.join(self.terms)}, 0, 0}} at b;\nend M;")  # fmt: skip


@mp.workdps(DIGITS)
def case(seed: int) -> Case:
    chance = Random(seed)
    made = Case(chance.uniform(-1.0, 1.0), chance.uniform(-2.0, 2.0))
    constant = chance.uniform(-1.0, 1.0)
    made.terms.append(f"{constant!r} [N]")
    made.forces.append(lambda t, x: mpf(constant))
    for _ in range(chance.randint(1, 3)):
        kind = chance.choice((_pulse, _square, _barrier, _step, _wedge, _stairs, _walls))
        kind(made, chance, chance.choice((1.0, -1.0)) * 10.0 ** chance.uniform(-1.0, 2.0))
    return made


def _pulse(made: Case, chance: Random, f: float) -> None:
    begin = chance.uniform(0.0, 4.0)
    end = begin + 10.0 ** chance.uniform(-5.0, 0.0)
    made.terms.append(f"(if time > {begin!r} [s] and time <= {end!r} [s] then {f!r} [N] else 0 [N])")
    made.times += [mpf(begin), mpf(end)]
    made.forces.append(lambda t, x: mpf(f) if begin < t <= end else mpf(0))


def _square(made: Case, chance: Random, f: float) -> None:
    period, share = 10.0 ** chance.uniform(-2.0, 0.3), chance.uniform(0.1, 0.9)
    on = share * period
    made.terms.append(f"(if mod(time, {period!r} [s]) < {on!r} [s] then {f!r} [N] else {-f!r} [N])")
    starts = [n * mpf(period) for n in range(int(STOP / period) + 2)]
    made.times += [*starts, *(t + on for t in starts)]
    made.forces.append(lambda t, x: mpf(f) if fmod(t, mpf(period)) < on else -mpf(f))


def _barrier(made: Case, chance: Random, f: float) -> None:
    left = chance.uniform(-2.0, 2.0)
    right = left + 10.0 ** chance.uniform(-4.0, 0.0)
    made.terms.append(f"(if x > {left!r} [m] and x < {right!r} [m] then {f!r} [N] else 0 [N])")
    made.places += [mpf(left), mpf(right)]
    made.forces.append(lambda t, x: mpf(f) if left < x < right else mpf(0))


def _step(made: Case, chance: Random, f: float) -> None:
    at = chance.uniform(-2.0, 2.0)
    made.terms.append(f"(if x >= {at!r} [m] then {f!r} [N] else 0 [N])")
    made.places.append(mpf(at))
    made.forces.append(lambda t, x: mpf(f) if x >= at else mpf(0))


def _wedge(made: Case, chance: Random, f: float) -> None:
    made.terms.append(f"{-abs(f)!r} [N]*sign(x)")
    made.places.append(mpf(0))
    made.forces.append(lambda t, x: -mpf(abs(f)) * sign(x))


def _stairs(made: Case, chance: Random, f: float) -> None:
    period = chance.uniform(0.2, 2.0)
    made.terms.append(f"{f!r} [N]*floor(time/({period!r} [s]))/10")
    made.times += [n * mpf(period) for n in range(1, int(STOP / period) + 2)]
    made.forces.append(lambda t, x: mpf(f) * floor(t / mpf(period)) / 10)


def _walls(made: Case, chance: Random, f: float) -> None:
    made.terms.append(f"{-abs(f)!r} [N]*(if abs(x) > 1.5 [m] then sign(x) else 0)")
    made.places += [mpf(1.5), mpf(-1.5)]
    made.forces.append(lambda t, x: -mpf(abs(f)) * sign(x) if abs(x) > 1.5 else mpf(0))


def motion(made: Case, times: Sequence[float]) -> list[tuple[mpf, mpf]] | None:
    """Place and velocity at `times`; None where a place of change is all but touched, or not left again."""
    with mp.workdps(DIGITS):
        t, x, v = mpf(0), mpf(made.x), mpf(made.v)
        changes, found = sorted(set(made.times)), list[tuple[mpf, mpf]]()
        while len(found) < len(times):
            here = any(abs(x - place) < HERE for place in made.places)
            ahead = x + sign(v) * TINY if here else x
            a = sum(force(t + TINY, ahead) for force in made.forces)
            until = min([s for s in changes if s > t + 10 * TINY], default=mpf(2 * STOP))
            for place in made.places:
                under = v * v - 2 * a * (x - place)
                if a != 0 and abs(under) < 1e-9 and 0 < -v / a < until - t:
                    return None
                until = min([until, *(t + way for way in _ways(x - place, v, a, under))])
            while len(found) < len(times) and times[len(found)] <= until:
                part = times[len(found)] - t
                found.append((x + v * part + a * part * part / 2, v + a * part))
            part, t = until - t, until
            x, v = x + v * part + a * part * part / 2, v + a * part
            if any(abs(x - place) < HERE for place in made.places) and abs(v) < 1e-7:
                return None
        return found


def _ways(x: mpf, v: mpf, a: mpf, under: mpf) -> list[mpf]:
    """Times after which x + v t + a t^2 / 2 is zero."""
    if a == 0:
        found = [-x / v] if v != 0 else []
    else:
        found = [(-v - sqrt(under)) / a, (-v + sqrt(under)) / a] if under >= 0 else []
    return [t for t in found if t > mpf(10) ** -20]
