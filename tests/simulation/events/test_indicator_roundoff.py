"""An event indicator that crosses zero by round-off changes nothing."""

import math

import pytest

import lagc

pytestmark = pytest.mark.usefixtures("no_cache")

# The sum in brackets is 0, evaluated it is some last places of b.
MODEL = """model Noisy
  parameter Real b = 1e6;
  parameter Angle a = 1;
  parameter Length l = 1 [m];
  parameter Stiffness k0 = 1 [N/m], k = 100 [N/m];
  coordinate Angle x(start = -0.5, rate = 1);
  body p = Particle(mass = 1 [kg], at = {l*x, 0, 0});
  potential soft = k0*(l*x)^2/2;
  potential wall = k*l^2*max(0, x + b*(sin(x + a) - sin(x)*cos(a) - cos(x)*sin(a)))^2/2;
  scene lab
    simulate(stop = 20 [s]);
  end lab;
end Noisy;"""
SOFT, HARD = 1.0, math.sqrt(101.0)  # rad/s below 0 and above


def exact(t: float) -> tuple[float, float]:
    """x and its rate: halves of two circles, one after the other."""
    speed = math.hypot(0.5, 1.0)
    t -= math.atan(0.5)  # from when it passes 0 upwards
    t %= math.pi / SOFT + math.pi / HARD
    frequency, since, sign = (HARD, t, 1) if t < math.pi / HARD else (SOFT, t - math.pi / HARD, -1)
    return sign * speed / frequency * math.sin(frequency * since), sign * speed * math.cos(frequency * since)


@pytest.mark.full
@pytest.mark.parametrize("backend", ["numpy", "c"])
@pytest.mark.parametrize("b", [0.0, 1e3, 1e5, 1e6, 1e7])
def test_a_wall_with_roundoff(b: float, backend: str) -> None:
    """The force of the wall is off by k b eps, 0.2 % of the largest at most, and in no direction."""
    system = lagc.loads(MODEL).compile(backend=backend)
    run = system.simulate(parameters={"b": b}, accuracy=1e-4, points=41)
    assert run.status == "ok", run.message
    assert len(run.events) == len([t for t in crossings() if t < 20.0])
    for t, x, rate in zip(run.t, run["x"], run["der(x)"]):
        assert (x, rate) == pytest.approx(exact(t), abs=2e-4 * math.hypot(0.5, 1.0) + 1e-10 * b)


def crossings() -> list[float]:
    found = [math.atan(0.5)]
    while found[-1] < 20.0:
        found.append(found[-1] + math.pi / (HARD if len(found) % 2 else SOFT))
    return found


UNSTABLE = """model Unstable
  coordinate Length x(rate = 7);
  body p = Particle(mass = 1 [kg], at = {x, 0, 0});
  dissipation c = 1/2*1e8 [kg/s]*der(x)^2;
  when der(x) < 0.2 [m/s] then
  end when;
end Unstable;"""


def test_repeated_crossings_are_not_taken_for_roundoff() -> None:
    """A step of 1e4 time constants: its polynomial swings where its equations do not, wherever one looks."""
    system = lagc.loads(UNSTABLE).compile(backend="numpy")
    run = system.simulate(method="dop853", step=1e-4, stop=3e-4, points=4)
    assert run.cost.rhs < 1_000
