"""Dry friction in several joints of a mechanism stops all of them at once."""

from math import asin, atan2, cos, pi, sin, sqrt

import pytest

import lagc

pytestmark = pytest.mark.usefixtures("own_cache")

FORCE = 0.5  # N, along each of two crossed rails
BLOCK = """coordinate Length z(rate = {rate});
  body block = Particle(mass = 1 [kg], at = {{0, 0, z}});
  force drag = {{0, 0, -1 [N]*sign(der(z))}} at block;"""
BY_ANGLE = """model Trammel
  parameter Length l = 1;
  coordinate Angle a(start = 0.7, rate = 1);
  body p = Particle(mass = 1 [kg], at = {l*cos(a), 0, 0});
  body q = Particle(mass = 1 [kg], at = {0, l*sin(a), 0});
  force f = {-0.5 [N]*sign(der(l*cos(a))), 0, 0} at p;
  force g = {0, -0.5 [N]*sign(der(l*sin(a))), 0} at q;
end Trammel;"""
BY_ROW = """model Trammel
  coordinate Length x(start = 0.8, rate = -0.5, fixed = true), y(start = 0.6);
  body p = Particle(mass = 1 [kg], at = {x, 0, 0});
  body q = Particle(mass = 1 [kg], at = {0, y, 0});
  constraint rod: x^2 + y^2 = 1 [m2];
  force f = {-0.5 [N]*sign(der(x)), 0, 0} at p;
  force g = {0, -0.5 [N]*sign(der(y)), 0} at q;
  BLOCK
end Trammel;"""


def last_angle(angle: float, rate: float) -> float:
    """The work of friction, F (sin a - cos a), takes all of the energy."""
    return pi / 4.0 + asin((0.5 * rate**2 / FORCE + sin(angle) - cos(angle)) / sqrt(2.0))


@pytest.mark.sample(1)
@pytest.mark.parametrize("backend", ["numpy", "c"])
def test_a_trammel_stops(backend: str) -> None:
    system = lagc.loads(BY_ANGLE).compile(backend=backend)
    for accuracy in (1e-4, 1e-6, 1e-8, 1e-10):
        run = system.simulate(3.0, accuracy=accuracy)
        assert run.status == "ok" and run.estimated is not None, run.message
        end = last_angle(0.7, 1.0)
        assert abs(run["a"][-1] - end) <= run.estimated * end and abs(run["der(a)"][-1]) < 1e-15


@pytest.mark.sample(1)
@pytest.mark.parametrize("later", [None, 1e-12, 1e-7, 1e-4, 0.1])
def test_a_loop_stops_and_an_independent_block_moves_on(later: float | None) -> None:
    """A block that would stop a little later does."""
    stops = 1.21399769375707 if later is None else 1.21399769375707 + later
    block = "" if later is None else BLOCK.format(rate=repr(stops))
    system = lagc.loads(BY_ROW.replace("BLOCK", block)).compile(backend="numpy")
    end = last_angle(atan2(0.6, 0.8), 0.5 / 0.6)
    for rtol in (1e-5, 1e-8, 1e-11):
        run = system.simulate(3.0, method="dop853", rtol=rtol)
        assert run.status == "ok" and len(run.events) == 2 + (later is not None), run.message
        assert (run["x"][-1], run["y"][-1]) == pytest.approx((cos(end), sin(end)), abs=10.0 * rtol)
        assert max(abs(run["der(x)"][-1]), abs(run["der(y)"][-1])) < 1e-15
        if later is not None:
            assert run["z"][-1] == pytest.approx(stops**2 / 2.0, rel=1e-12)
