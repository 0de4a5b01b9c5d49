"""Speeds without inertia move before those of bodies; guesses say where to search and state nothing."""

from math import atan2, cos, hypot, sin

import pytest

import lagc
from lagc.diagnostics.faults import Refused
from tests.simulation.programs import BACKENDS

INTEGRAL = """\
model Integral
  coordinate Length x{rate};
  coordinate Length y;
  body b = Particle(mass = 1 [kg], at = {{x, 0, 0}});
  constraint filter: der(y) = 1 [m/s] - der(x);
end Integral;
"""
MOTOR = """\
model Motor "A DC motor with PI control of its speed, from rest"
  parameter Real R = 0.5, L = 4.5e-3, k = 0.5, kp = 1, ki = 5 "in SI units";
  parameter Action f = 0.01 [N.m.s/rad];
  parameter Inertia J = 0.02 [kg.m2];
  parameter AngularVelocity want = 1 [rad/s];
  coordinate Angle theta;
  coordinate Real i, sum;
  frame A = rotate_z(world, theta);
  body rotor = Solid(mass = 1 [kg], inertia = {J, J, J}, frame = A, com = {0, 0, 0});
  torque drive = {0, 0, k*i*1 [N.m] - f*der(theta)} on rotor;
  constraint control: der(sum) = want - der(theta);
  constraint circuit:
    L*der(i)*1 [s] = (kp*(want - der(theta)) - k*der(theta))*1 [s] + ki*sum - R*i;
end Motor;
"""
LINK = """\
model Link "Two rods from (0, 0) and (3, 0) m that meet: above or below"
  parameter Length a = 2 [m], b = 2 [m], d = 3 [m];
  coordinate Angle p{p}, q{q};
  body tip = Particle(mass = 1 [kg], at = {{a*cos(p), a*sin(p), 0}});
  constraint meet: {{a*cos(p), a*sin(p), 0}} = {{d + b*cos(q), b*sin(q), 0}};
end Link;
"""


@BACKENDS
@pytest.mark.parametrize(("rate", "expected"), [("", (0.0, 1.0)), ("(rate = 3)", (3.0, -2.0))])
def test_an_integral_gives_way_before_a_body(backend: str, rate: str, expected: tuple[float, float]) -> None:
    system = lagc.loads(INTEGRAL.format(rate=rate)).compile(backend=backend)
    assert tuple(system.start()[2:]) == expected


def test_speeds_of_bodies_move_where_speeds_without_inertia_cannot() -> None:
    """der(x) + der(z) = 1 needs a body; the filter follows: the least change is 1/2 each."""
    text = INTEGRAL.format(rate="").replace(
        "  constraint", "  coordinate Length z;\n  body c = Particle(mass = 1, at = {0, 0, z});\n"
        "  constraint both: der(x) + der(z) = 1 [m/s];\n  constraint"
    )  # fmt: skip
    start = lagc.loads(text).compile(backend="numpy").start()
    assert list(start[3:]) == pytest.approx([0.5, 0.5, 0.5], rel=1e-14)


def test_a_motor_with_a_controller_starts_at_rest() -> None:
    """Against the exponential of the matrix of this linear system, computed with SciPy."""
    linalg, np = pytest.importorskip("scipy.linalg"), pytest.importorskip("numpy")
    R, L, k, f, J, kp, ki = 0.5, 4.5e-3, 0.5, 0.01, 0.02, 1.0, 5.0
    matrix = np.array(
        [[-R / L, -(kp + k) / L, ki / L, kp / L], [k / J, -f / J, 0, 0], [0, -1, 0, 1], [0] * 4]
    )
    current, speed, area, _ = linalg.expm(matrix * 0.02) @ [0.0, 0.0, 0.0, 1.0]
    run = lagc.loads(MOTOR).compile(backend="numpy").simulate(0.02, accuracy=1e-9)
    assert (run["i"][0], run["der(theta)"][0], run["sum"][0]) == (0.0, 0.0, 0.0)
    for name, value in (("i", current), ("der(theta)", speed), ("sum", area)):
        assert run[name][-1] == pytest.approx(value, rel=1e-8)


@pytest.mark.parametrize("above", [True, False])
def test_a_guess_chooses_a_posture_and_leaves_what_is_stated(above: bool) -> None:
    side, p = (1 if above else -1), 0.5
    text = LINK.format(p=f"(start = {p * side})", q=f"(guess = {2.0 * side})")
    found = lagc.loads(text).compile(backend="numpy").start()
    # two sides and the angle between them give the third side, which must be b: p moves to meet it
    assert hypot(2 * cos(found[0]) - 3, 2 * sin(found[0])) == pytest.approx(2, rel=1e-12)
    assert found[1] == pytest.approx(atan2(2 * sin(found[0]), 2 * cos(found[0]) - 3), rel=1e-12)
    assert found[0] * side > 0


def test_a_guess_of_a_run_replaces_a_statement() -> None:
    """Stated values share the move of a contradiction; a guess leaves it to the others."""
    text = """\
    model M
      coordinate Length x(start = 1), y(start = 1);
      body b = Particle(mass = 1 [kg], at = {x, y, 0});
      constraint c: x + y = 1 [m];
    end M;
    """
    system = lagc.loads(text).compile(backend="numpy")
    run = system.simulate(0.1, guesses={"y": 5.0})
    assert (run["x"][0], run["y"][0]) == (1.0, 0.0)
    run = system.simulate(0.1, guesses={"x": 5.0}, starts={"y": 3.0})
    assert (run["x"][0], run["y"][0]) == (-2.0, 3.0)
    with pytest.raises(Refused, match=r"LAG0608: a guess for `y` has no effect: .* stated for this run"):
        system.simulate(0.1, guesses={"y": 5.0}, starts={"y": 3.0})
    with pytest.raises(Refused, match="LAG0606"):
        system.simulate(0.1, guesses={"z": 5.0})
    fixed = lagc.loads(text.replace("y(start = 1)", "y(start = 1, fixed = true)"))
    with pytest.raises(Refused, match="LAG0608: a guess for `y` has no effect: its initial value is fixed"):
        fixed.compile(backend="numpy").simulate(0.1, guesses={"y": 5.0})


def test_a_guess_excludes_a_start() -> None:
    for other in ("start = 1", "fixed = true"):
        with pytest.raises(Refused, match=r"LAG0209: `guess` and `.*` exclude each other"):
            lagc.loads(LINK.format(p=f"({other}, guess = 1)", q="")).compile()
