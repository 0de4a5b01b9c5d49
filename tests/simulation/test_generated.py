"""Generated C and Python at work: both give the same bits, and see what is wrong with a system."""

from typing import Any

import pytest

import lagc
from lagc.codegen.c.emit import render as render_c
from lagc.simulation.system import INCONSISTENT, NOT_FINITE, OK, REDUNDANT, Options
from tests.simulation.programs import (
    BACKENDS,
    NAMES,
    PENDULUM,
    build,
    built,
    needs_compiler,
    program,
    programs,
    rates,
)


@pytest.mark.sample(1, 12)
@needs_compiler
@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize(
    "options",
    [
        Options(),
        Options(method="dopri5", rtol=1e-6, atol=1e-8),
        Options(step=0.02),
        Options(method="dopri5", step=0.02, project=False),
        Options(rtol=1e-4, atol=1e-4, max_steps=5),
        Options(first_step=0.3, max_step=0.1),
    ],
    ids=["default", "dopri5", "fixed", "drifting", "limited", "bounded"],
)
def test_c_and_python_agree_bitwise(name: str, options: Options) -> None:
    c, python = built(name, "c"), built(name, "numpy")
    x = c.start()
    assert x == python.start()
    times = [0.05 * i for i in range(41)]
    one, other = (vars(s.integrate(options, 0.0, x, times)) for s in (c, python))
    assert repr(one) == repr(other)
    assert len(one["times"]) == 41 or options.max_steps


@pytest.mark.sample(4)
@needs_compiler
@pytest.mark.parametrize("name", NAMES)
def test_going_back_agrees_too(name: str) -> None:
    c, python = built(name, "c"), built(name, "numpy")
    x = c.start()
    one, other = (s.integrate(Options(), 1.0, x, [0.7, 0.0]) for s in (c, python))
    assert one.status == OK and repr(one.states) == repr(other.states)


def test_only_what_a_model_needs_is_written() -> None:
    plain = "".join(render_c(programs()["double pendulum"]).values())
    for word in ("project(", "orthogonalise", "normalise", "#if LAGC", "malloc"):
        assert word not in plain, word
    assert " project(" in "".join(render_c(programs()["pendulum"]).values())
    assert "normalise" in "".join(render_c(programs()["body"]).values())


@pytest.mark.sample(1)
@BACKENDS
def test_contradicting_rows_are_named(backend: str) -> None:
    """The second row's acceleration leaves the first's by 3 m^2/s^2 a second."""
    rod, late = "(x^2 + y^2 - l^2)/2", "0.5 [m2/s3]*time^3"
    rows = f"constraint rod: {rod} = 0; constraint again: {rod} + {late} = 0; end Pendulum"
    system = build(program(PENDULUM.replace("end Pendulum", rows)), backend)
    x = system.start()
    assert rates(system, x)[0] == REDUNDANT
    status, _, _ = rates(system, x, t=1.0)
    assert status == INCONSISTENT and system.culprit == 1
    run = system.integrate(Options(), 0.0, x, [2.0])
    assert run.status == INCONSISTENT and run.culprit == 1 and run.t < 0.1


POINT = """model Point
  coordinate Length x(start = 1 [m], rate = -1 [m/s]), y(start = 1 [m]);
  body b = Particle(mass = 1 [kg], at = {{x, y, 0}});
  force f = {{0, {}, 0}} at b;
end Point;
"""


@pytest.mark.sample(1)
@BACKENDS
def test_what_is_not_a_number_is_named(backend: str) -> None:
    system = build(program(POINT.format("1 [N.m]/(x - 1 [m])")), backend)
    assert rates(system, system.start())[0] == NOT_FINITE
    assert system.culprit == 3


@pytest.mark.sample(1)
@BACKENDS
def test_a_run_ends_at_the_border_of_its_equations(backend: str) -> None:
    """sqrt(x) where x falls through 0 at t = 1."""
    system = build(program(POINT.format("1 [N]*sqrt(x/(1 [m]))")), backend)
    run = system.integrate(Options(), 0.0, system.start(), [0.5, 2.0])
    assert run.status == NOT_FINITE and run.culprit == 3
    assert run.t == pytest.approx(1.0, abs=1e-3) and run.times == [0.5]
    assert run.states[0][0] == pytest.approx(0.5, abs=1e-8)


@pytest.mark.sample(5)
@BACKENDS
@pytest.mark.parametrize("options", [{"step": 0.5, "method": name} for name in ("rk4", "dop853", "dopri5")]
                         + [{"rtol": 1e-6, "method": "dopri5"}])  # fmt: skip
def test_a_place_beyond_all_numbers_ends_a_motion_though_nothing_depends_on_it(
    options: dict[str, Any], backend: str
) -> None:
    text = "model F coordinate Length y; body b = Particle(mass = 1, at = {y, 0, 0}); end F;"
    system = lagc.loads(text).compile(backend=backend).system
    found = system.integrate(Options(**options), 0.0, [1.0, 1e308], [0.0, 1.0, 10.0], None)
    assert found.status == NOT_FINITE
    assert found.times[-1] < 10.0
    slow = system.integrate(Options(**options), 0.0, [1.0, 1e300], [0.0, 10.0], None)
    assert slow.status == OK and slow.states[-1][0] == pytest.approx(1e301, rel=1e-12)
