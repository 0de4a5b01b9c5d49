"""Constraints that an actuator holds: inverse dynamics, and closed forms that a perfect constraint misses."""

import math
from collections.abc import Sequence

import pytest
from scipy.integrate import solve_ivp

import lagc
from lagc.diagnostics.faults import Refused

BACKENDS = ["numpy", pytest.param("c", marks=pytest.mark.full)]
RELATIVE = """model Relative
  coordinate Length x, y;
  body one = Particle(mass = 3 [kg], at = {x, 0, 0});
  body two = Particle(mass = 2 [kg], at = {x + y, 0, 0});
  force motor = {1 [N], 0, 0} at one;
  constraint path: y = 0.2 [m]*sin(3 [rad/s]*time)BY;
  output Real u = reaction(path);
end Relative;
"""


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_cart_that_a_motor_moves(backend: str) -> None:
    """u = (M + m) x'' + m l (theta'' cos - theta'^2 sin), l theta'' = -g sin - x'' cos."""
    a, w, length = 0.3, 4.0, 0.6

    def turn(t: float, theta: float) -> float:
        return (-9.81 * math.sin(theta) + a * w * w * math.sin(w * t) * math.cos(theta)) / length

    def rates(t: float, y: Sequence[float]) -> list[float]:
        return [y[1], turn(t, y[0])]

    known = solve_ivp(rates, (0.0, 2.0), [0.4, 0.0], "DOP853", rtol=1e-13, atol=1e-13).y[:, -1]
    run = lagc.load("driven_cart_pole").compile(backend=backend).simulate(2.0, accuracy=1e-9)
    assert run.status == "ok" and run.estimated is not None
    assert abs(run.final["theta"] - known[0]) <= 0.4 * run.estimated + 1e-11
    moved = turn(2.0, known[0]) * math.cos(known[0]) - known[1] ** 2 * math.sin(known[0])
    force = -2.5 * a * w * w * math.sin(2.0 * w) + 0.5 * length * moved
    assert run.final["u"] == pytest.approx(force, abs=1e-7)


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("method", ["dop853", pytest.param("radau5", marks=pytest.mark.full)])
def test_an_actuator_elsewhere_than_the_constraint(backend: str, method: str) -> None:
    """No force acts on the second mass: x'' = -y''. The motor gives -m1 y''. A perfect constraint keeps the
    momentum of both instead."""
    stop, rate = 1.3, 0.2 * 3.0
    text = RELATIVE.replace("BY", " (by = motor)")
    run = lagc.loads(text).compile(backend=backend).simulate(stop, accuracy=1e-9, method=method)
    assert run.status == "ok" and run.estimated is not None
    assert run.final["x"] == pytest.approx(rate * stop - 0.2 * math.sin(3.0 * stop), abs=1e-9)
    assert run.final["u"] == pytest.approx(3.0 * 0.2 * 9.0 * math.sin(3.0 * stop), abs=1e-8)
    free = RELATIVE.replace("BY", "").replace("output Real u", "output Force u")
    free = free.replace("  force motor = {1 [N], 0, 0} at one;\n", "")
    perfect = lagc.loads(free).compile(backend="numpy").simulate(stop, accuracy=1e-9)
    assert perfect.final["x"] == pytest.approx(0.4 * (rate * stop - 0.2 * math.sin(3.0 * stop)), abs=1e-9)


@pytest.mark.parametrize(
    ("place", "bound"),
    [
        ("x + y", "y = 0.1 [m]*sin(time*1 [1/s])"),
        ("x + 0.6 [m]*sin(theta)", "x + 0.6 [m]*sin(theta) = 0.1 [m]*sin(time*1 [1/s])"),
        ("x + 0.6 [m]*sin(theta)", "x + 0.6 [m]*sin(theta) = 0"),  # an equilibrium, with u = 0
    ],
)
def test_an_actuator_that_cannot_reach_is_named(place: str, bound: str) -> None:
    """A mass behind a spring, where the relative degree is 4, and the bob of a crane that hangs."""
    crane = "theta" in place
    bodies = (
        "coordinate Angle theta;\n  body b = Particle(mass = 1 [kg], at = {x + 0.6 [m]*sin(theta), 0, "
        "-0.6 [m]*cos(theta)});\n  Gravity field;"
        if crane
        else "coordinate Length y;\n  body b = Particle(mass = 1 [kg], at = {y, 0, 0});\n"
        "  potential spring = 1/2*50 [N/m]*(y - x)^2;"
    )
    text = f"""model M
  coordinate Length x;
  body cart = Particle(mass = 2 [kg], at = {{x, 0, 0}});
  {bodies}
  force motor = {{1 [N], 0, 0}} at cart;
  constraint path: {bound} (by = motor);
end M;"""
    with pytest.raises(Refused) as caught:
        lagc.loads(text).compile(backend="numpy").simulate(1.0)
    (fault,) = caught.value.faults
    assert fault.code == "LAG0625" and "`motor` cannot hold the constraint `path`" in fault.message
    assert fault.span is not None and fault.span.text == "path" and fault.remedy


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("constraint path: x = 0 (by = b);", "LAG0221"),
        ("constraint path: x = 0 (of = motor);", "LAG0209"),
        ("constraint path: {x, y} = {0, 0} (by = motor);", "LAG0221"),
        ("constraint one: x = 0 (by = motor);\n  constraint two: y = 0 (by = motor);", "LAG0221"),
    ],
)
def test_refusals(text: str, code: str) -> None:
    model = f"""model M
  coordinate Length x, y;
  body b = Particle(mass = 1 [kg], at = {{x, 0, y}});
  force motor = {{1 [N], 0, 0}} at b;
  {text}
end M;"""
    with pytest.raises(Refused) as caught:
        lagc.loads(model).compile(backend="numpy")
    assert caught.value.faults[0].code == code and caught.value.faults[0].remedy


@pytest.mark.parametrize("backend", BACKENDS)
def test_the_actuator_that_does_nothing_is_named_among_several(backend: str) -> None:
    text = """model Both
  coordinate Length x, y(start = 0.5 [m]);
  body a = Particle(mass = 1 [kg], at = {x, 0, 0});
  body b = Particle(mass = 1 [kg], at = {0, y, 0});
  force good = {1 [N], 0, 0} at a;
  force idle = {0, 0.5 [N] - y*1 [N/m], 0} at b;
  constraint one: x = 0 (by = good);
  constraint two: y = 0.5 [m] + 0.1 [m/s2]*time^2 (by = idle);
end Both;
"""
    with pytest.raises(Refused, match="`idle` cannot hold the constraint `two`"):
        lagc.loads(text).compile(backend=backend).simulate(1.0)
