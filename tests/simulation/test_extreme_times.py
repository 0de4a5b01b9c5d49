"""Ways from 1e-308 s to 1e308 s: the motion is right, or it is said that they take too many steps."""

from functools import cache
from typing import Any

import pytest

import lagc
from lagc.simulation.system import MAX_STEPS, OK, STEP_UNDERFLOW, Options
from tests.simulation.driven import InC, InPython

pytestmark = pytest.mark.usefixtures("own_cache")
PARTICLE = (
    "coordinate Length x(start = 1 [m], rate = {v} [m/s]); body b = Particle(mass = 1, at = {{x, 0, 0}});"
)
MODELS = {  # text, acceleration at the start in x
    "free": (PARTICLE.format(v=1.5), 0.0),
    "spring": (PARTICLE.format(v=0.0) + "potential s = (2 [N/m])*x^2;", -4.0),
    "moving": (PARTICLE.format(v=-0.75) + "potential s = (2 [N/m])*x^2;", -4.0),
    "string": (
        "coordinate Length x(start = 0.6), y(start = -0.8); body b = Particle(mass = 1, at = {x, y, 0}); "
        "constraint s: x^2 + y^2 = (1 [m2]); potential V = (10 [N])*y;", -4.8),
}  # fmt: skip
LIMIT = 100  # steps
POWERS = (-308, -300, -230, -160, -154, -100, -31, -9, 31, 60, 100, 150, 154, 160, 230, 300, 308)
SPANS = [way * 10.0**e for e in POWERS for way in (1.0, -1.0)]


@cache
def system(name: str, backend: str) -> Any:
    return lagc.loads(f"model M {MODELS[name][0]} end M;").compile(backend=backend).load(backend)


def arrived(name: str, options: Options, t1: float) -> tuple[int, int, float, list[float], int]:
    """Status, culprit, time, state and steps after `advance`: the same in C and in Python."""
    found = []
    for backend, kind in (("c", InC), ("numpy", InPython)):
        run = kind(system(name, backend), options, 0.0, system(name, backend).start())
        status = run.advance(t1)
        t, x, _, steps, *_ = run.facts()
        culprit = run.state.culprit if isinstance(run, InC) else run.run.culprit
        found.append((status, culprit, t, x, steps))
    assert found[0] == found[1]
    return found[0]


@pytest.mark.sample(1, 11)
@pytest.mark.parametrize("name", MODELS)
@pytest.mark.parametrize("method", ["dop853", "dopri5", "bs32"])
@pytest.mark.parametrize("first", [0.0, 1e-3])
def test_ways_of_any_length(name: str, method: str, first: float) -> None:
    acceleration = MODELS[name][1]
    for t1 in SPANS:
        options = Options(method, rtol=1e-9, first_step=first, max_steps=LIMIT)
        status, culprit, t, x, steps = arrived(name, options, t1)
        start = system(name, "c").start()
        v = start[system(name, "c").nq]
        assert culprit == -1
        if abs(t1) < 1.0 or (name == "free" and first == 0.0):
            assert (status, t) == (OK, t1)
            # to the first order, whose rest is 1e-18 of it at 1e-9 s
            assert x[0] == pytest.approx(start[0] + v * t1, rel=1e-15)
            assert x[system(name, "c").nq] - v == pytest.approx(
                acceleration * t1, rel=1e-12, abs=1e-15 * abs(v)
            )
        elif status == STEP_UNDERFLOW:  # of the way, 1e-38 or less
            assert abs(t1) >= 1e38 * min(first or 1.0, 1e-3) and (t, x, steps) == (0.0, start, 0)
        else:
            assert status == (OK if name == "free" else MAX_STEPS) and abs(t1) <= 1e40


@pytest.mark.sample(1)
@pytest.mark.parametrize("name", MODELS)
def test_fixed_steps_on_ways_of_any_length(name: str) -> None:
    start, nq = system(name, "c").start(), system(name, "c").nq
    for t1 in SPANS:
        for step in (0.3, abs(t1) / 3.0):
            if step > 1.0:
                continue
            status, culprit, t, x, steps = arrived(name, Options("rk4", step=step, max_steps=LIMIT), t1)
            assert culprit == -1
            if abs(t1) < 1.0:
                assert (status, t) == (OK, t1) and steps in (1, 3)
                assert x[0] == pytest.approx(start[0] + start[nq] * t1, rel=1e-15)
            else:
                assert status == (MAX_STEPS if abs(t1) < 1e38 else STEP_UNDERFLOW)
                assert steps == (LIMIT if abs(t1) < 1e38 else 0)
