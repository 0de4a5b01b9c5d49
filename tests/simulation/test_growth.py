"""Motions along which rounding grows and errors of the method do not: estimates against closed forms."""

import re
from dataclasses import replace
from math import atan, cos, cosh, exp, pi, sin
from random import Random

import mpmath
import pytest

import lagc
from lagc.api import Run
from tests.simulation.test_rounding import Exact, true_error

pytestmark = pytest.mark.usefixtures("no_cache")
ACCURACY = 1e-6


def told(text: str, way: float, w: float, exact: Exact) -> Run:
    """A run that is `ok` where the last place, grown by exp(way), is far below the accuracy asked, and not
    where it is far above; nor `ok` with a greater error than asked.

    What was growing longest is most of the error: the rounding of the first steps, single draws of which the
    estimate knows the size.  So an error may be twice what is said.
    """
    stop = way / w
    run = lagc.loads(text).compile(backend="numpy").simulate(stop, accuracy=ACCURACY, points=41)
    true = true_error(run, exact)
    assert run.estimated is not None
    assert run.status == "failed" or true <= ACCURACY, (true, run.estimated)
    assert true <= 2.5 * run.estimated, (true, run.message)
    assert run.status == ("ok" if way <= 14.0 else "failed" if way >= 26.0 else run.status), run.message
    assert list(run.states[0]) == pytest.approx(exact(0.0), rel=1e-15)
    if run.status == "failed":  # it is told until when that is an answer
        until = re.search(r"until t = (\S+) s", run.message)
        if until is None:  # where nothing is beyond, a finer run ends
            assert run.times[-1] < stop and "not a finite number" in run.message, run.message
            return run
        assert 10.0 / w < float(until[1]) < stop, run.message
        kept = sum(t <= float(until[1]) for t in run.times)
        sure = replace(run, times=run.times[:kept], states=run.states[:kept])
        assert true_error(sure, exact) <= 2.0 * ACCURACY
    return run


def saddle(w: float) -> str:
    return f"""model Saddle
  coordinate Length x(start = 1 [m], rate = {-w!r} [m/s]);
  body b = Particle(mass = 1 [kg], at = {{x, 0, 0}});
  potential v = -1/2*({w!r} [rad/s])^2*(1 [kg])*x^2;
end Saddle;"""


@pytest.mark.sample(1)
@pytest.mark.parametrize("way", [5.0, 10.0, 14.0, 18.0, 22.0, 26.0, 32.0])
def test_down_a_saddle(way: float) -> None:
    """Exactly onto it: truncation stays in the stable direction, and the last place grows by exp(way)."""
    for w in (0.2, 0.7, 1.0, 3.0, 7.0):
        run = told(saddle(w), way, w, lambda t, w=w: [exp(-w * t), -w * exp(-w * t)])  # type: ignore[misc]
        assert way > 18.0 or run.status == "ok", run.message


@pytest.mark.sample(1)
@pytest.mark.parametrize("way", [8.0, 14.0, 18.0, 20.0, 22.0, 26.0])
@pytest.mark.parametrize("term", ["sqrt(x/(1 [m]))", "log(x/(1 [m]))", "(x/(1 [m]))^1.5"])
def test_down_a_saddle_with_nothing_beyond(way: float, term: str) -> None:
    """A term too small to move anything is undefined there: displaced to one side, a run does not arrive."""
    for w in (0.7, 1.4):
        text = saddle(w).replace(";\nend", f" + (1e-60 [J])*{term};\nend")
        told(text, way, w, lambda t, w=w: [exp(-w * t), -w * exp(-w * t)])  # type: ignore[misc]


@pytest.mark.sample(2)
@pytest.mark.parametrize("seed", range(10))
def test_a_saddle_among_oscillators(seed: int) -> None:
    """Of which the errors of the method tell nothing, with the coordinates mixed."""
    chance = Random(seed)
    w, k, way = chance.uniform(1.0, 4.0), chance.uniform(1.0, 6.0), chance.uniform(8.0, 30.0)
    a, size = chance.randint(-3, 3) / 4.0, chance.choice((1.0, 0.5, 2.0))
    # p = x + a y falls down the saddle, r = y swings; a and the starts have few digits
    text = f"""model Mixed
  coordinate Length x(start = {1.0 - a * size!r} [m], rate = {-w!r} [m/s]), y(start = {size!r} [m]);
  body p = Particle(mass = 1 [kg], at = {{x + {a!r}*y, 0, 0}});
  body r = Particle(mass = 1 [kg], at = {{0, y, 0}});
  potential v = -1/2*({w!r} [N/m]*{w!r})*(x + {a!r}*y)^2 + 1/2*({k!r} [N/m]*{k!r})*y^2;
end Mixed;"""

    def exact(t: float) -> list[float]:
        p, y, v = exp(-w * t), size * cos(k * t), -k * size * sin(k * t)
        return [p - a * y, y, -w * p - a * v, v]

    told(text, way, w, exact)


@pytest.mark.sample(0, 10)
@pytest.mark.parametrize("way", [3.0, 8.0, 12.0, 16.0, 18.0, 20.0, 24.0])
@pytest.mark.parametrize("w", [0.75, 1.7, 4.0])
def test_a_pendulum_that_rises_to_its_top(w: float, way: float) -> None:
    """From below with exactly the energy of the top: theta = 4 atan(exp(w t)) - pi."""
    text = f"""model Rising
  coordinate Angle theta(start = 0, rate = 2*{w!r} [rad/s]);
  kinetic K = 1/2*1 [kg.m2]*der(theta)^2;
  potential V = -1 [kg.m2]*({w!r} [rad/s])^2*cos(theta);
end Rising;"""
    told(text, way, w, lambda t: [4.0 * atan(exp(w * t)) - pi, 2.0 * w / cosh(w * t)])


@pytest.mark.sample(2)
@pytest.mark.parametrize("way", [6.0, 14.0, 20.0, 26.0])
@pytest.mark.parametrize("w", [0.7, 3.0])
def test_down_a_saddle_on_a_line(w: float, way: float) -> None:
    """The same with a constraint."""
    text = f"""model OnALine
  coordinate Length x(start = 1 [m], rate = {-w!r} [m/s]), y(start = 0.5 [m], rate = {-0.5 * w!r} [m/s]);
  body b = Particle(mass = 1 [kg], at = {{x, y, 0}});
  constraint line: x = 2*y;
  potential v = -1/2*({w!r} [rad/s])^2*(1 [kg])*(x^2 + y^2);
end OnALine;"""

    def exact(t: float) -> list[float]:
        p = exp(-w * t)
        return [p, 0.5 * p, -w * p, -0.5 * w * p]

    told(text, way, w, exact)


@pytest.mark.sample(1)
@pytest.mark.parametrize("seed", range(6))
def test_past_a_saddle_again_and_again(seed: int) -> None:
    """In one well of two, x'' = x - x^3 from rest near the top between them: x = X dn(X t/sqrt(2) + K, k).

    Rounding of the fast part of the motion decides how long it stays near the top the next time, and the
    growth from the start tells nothing of that. The estimate is one sample of the round-off, hence the 8.
    """
    chance = Random(seed)
    near, stop, accuracy = 10.0 ** chance.uniform(-3.0, -1.0), chance.uniform(30.0, 60.0), 1e-9
    text = f"""model Wells
  coordinate Length x(start = {near!r} [m]);
  body b = Particle(mass = 1 [kg], at = {{x, 0, 0}});
  potential v = -1/2*(1 [N/m])*x^2 + 1/4*(1 [N/m^3])*x^4;
end Wells;"""
    with mpmath.workdps(40):
        least = mpmath.mpf(near)
        far = mpmath.sqrt(2 - least**2)
        m = 1 - (least / far) ** 2
        quarter, w = mpmath.ellipk(m), far / mpmath.sqrt(2)

    def exact(t: float) -> list[float]:
        with mpmath.workdps(40):
            sn, cn, dn = (
                mpmath.ellipfun(name, w * mpmath.mpf(t) + quarter, m=m) for name in ("sn", "cn", "dn")
            )
            return [float(far * dn), float(-far * w * m * sn * cn)]

    run = lagc.loads(text).compile(backend="numpy").simulate(stop, accuracy=accuracy, points=41)
    true = true_error(run, exact)
    assert run.estimated is not None and true <= 8.0 * run.estimated, (true, run.message)
    assert run.status == "failed" or true <= accuracy


@pytest.mark.full
@pytest.mark.parametrize("accuracy", [1e-7, 1e-8])
def test_what_rounding_brings_does_not_depend_on_what_is_recorded(accuracy: float) -> None:
    """Arenstorf's orbit closes: its state after a period is the first one."""
    model = lagc.load("classic/arenstorf_orbit").compile(backend="numpy")
    stop = model.interface.simulate["stop"]
    for points in (2, *Random(accuracy).sample(range(3, 1000), 3)):
        run = model.simulate(stop, accuracy=accuracy, points=points)
        assert run.status == "ok" and run.estimated is not None, run.message
        sizes = [max(abs(x[i]) for x in run.states for i in pair) for pair in ((0, 1), (2, 3))]
        first, last = run.states[0], run.states[-1]
        true = max(abs(a - b) / sizes[i // 2] for i, (a, b) in enumerate(zip(first, last)))
        assert true <= run.estimated <= accuracy
