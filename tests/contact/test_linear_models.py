"""Linear models of what touches, against closed forms and differences of the rates in the same mode."""

import json
from math import cos, radians
from pathlib import Path

import numpy as np
import pytest

import lagc
from lagc import Refused
from lagc.api import CompiledModel
from lagc.cli.main import main
from lagc.simulation.linearization.linear_model import Linear

BLOCK = """model Block
  parameter Mass m = 2 [kg];
  parameter Stiffness k = 50 [N/m];
  parameter Real mu = 0.3;
  input Force u, lift;
  coordinate Length x(start = 0.01 [m]), y;
  Gravity field(g = 10 [m/s2], direction = {0, -1, 0});
  body block = Particle(mass = m, at = {x, y, 0});
  potential spring = 1/2*k*x^2;
  force push = {u, lift, 0} at block;
  constraint floor: y >= 0 ARGUMENTS;
  output Force N = reaction(floor);
end Block;
"""
FRICTION = "(friction = mu, slip = der(x))"


def _block(arguments: str = "", **inputs: float) -> CompiledModel:
    return lagc.loads(BLOCK.replace("ARGUMENTS", arguments)).compile(backend="numpy", inputs=inputs)


def _differences(model: CompiledModel, found: Linear) -> np.ndarray:
    """d(rate)/d(y) of the rates in the mode at the state, by central differences along dx/dy."""
    whole = np.array(model.simulate(0.0).states[-1])
    n, first = len(found.x), len(whole) - len(model.interface.discretes)
    state = np.concatenate([found.x, whole[first:]])
    columns = []
    for move in found.motions.T:
        far = np.concatenate([1e-5 * move, np.zeros(len(state) - n)])
        columns.append((model.rhs(found.t, state + far) - model.rhs(found.t, state - far))[:n] / 2e-5)
    return np.array(columns).T[found.indices]


def test_a_block_on_a_floor_oscillates_on_its_spring() -> None:
    found = _block().linearize()
    assert found.contacts == {"floor": "touches"} and found.states == ("x", "der(x)")
    assert found.A.tolist() == [[0.0, 1.0], [-25.0, 0.0]]
    assert found.B.tolist() == [[0.0, 0.0], [0.5, 0.0]]
    assert found.D.tolist() == [[0.0, -1.0]]  # the lift takes from the push
    assert found.to_dict()["multipliers"] == {"floor": pytest.approx(20.0, rel=1e-14)}


@pytest.mark.full
def test_an_open_contact_is_not_there() -> None:
    text = BLOCK.replace("ARGUMENTS", "").replace(", y;", ", y(start = 0.5 [m]);")
    found = lagc.loads(text).compile(backend="numpy").linearize()
    free = "\n".join([line for line in text.splitlines() if "floor" not in line])
    without = lagc.loads(free).compile(backend="numpy").linearize()
    assert found.contacts == {"floor": "open"} and found.states == without.states
    assert np.array_equal(found.A, without.A) and np.array_equal(found.B, without.B)


def test_loads_of_pushes_follow_them() -> None:
    """Drag of 0.2 s/m of the push; none while the contact is open."""
    text = BLOCK.replace("ARGUMENTS", "").replace(
        "  output", "  force drag = {-0.2 [s/m]*reaction(floor)*der(x), 0, 0} at block;\n  output"
    )
    lies = lagc.loads(text).compile(backend="numpy").linearize()
    assert np.allclose(lies.A, [[0.0, 1.0], [-25.0, -2.0]], 1e-12)
    flies = lagc.loads(text.replace(", y;", ", y(start = 1 [m]);")).compile(backend="numpy").linearize()
    assert flies.contacts == {"floor": "open"} and not flies.A[2:, 2:].any()


def test_a_block_that_sticks_is_held() -> None:
    """It moves nowhere, and friction takes the force of the spring."""
    found = _block(FRICTION).linearize()
    assert found.contacts == {"floor": "sticks"} and found.states == ("x",)
    assert found.A.tolist() == [[0.0]]
    forces = found.to_dict()["multipliers"]
    assert forces == {"floor": pytest.approx(20.0), "floor.slip[1]": pytest.approx(0.5)}


@pytest.mark.parametrize(("speed", "word", "sign"), [(0.5, "forwards", 1.0), (-0.5, "backwards", -1.0)])
def test_a_block_that_slides_feels_its_friction(speed: float, word: str, sign: float) -> None:
    """Friction does not depend on the state, but on the lift: mu (m g - lift)."""
    model = _block(FRICTION)
    found = model.linearize(starts={"der(x)": speed})
    assert found.contacts == {"floor": f"slips {word}"}
    assert np.allclose(found.A, [[0.0, 1.0], [-25.0, 0.0]], 1e-12)
    assert np.allclose(found.B, [[0.0, 0.0], [0.5, sign * 0.15]], 1e-12)


def test_the_states_given_by_hand_and_those_of_a_motion() -> None:
    model = _block(FRICTION)
    given = model.linearize(x=[0.02, 0.0, 0.5, 0.0])
    assert given.contacts == {"floor": "slips forwards"}
    later = model.linearize(1.0, starts={"der(x)": 0.5})
    assert later.contacts == {"floor": "sticks"}


VEE = """model Vee
  parameter Mass m = 3 [kg];
  parameter Angle a = 40 [deg];
  parameter Stiffness k = 12 [N/m];
  coordinate Length x, y(start = 0.1 [m]), z;
  Gravity field(g = 10 [m/s2], direction = {0, 0, -1});
  body ball = Particle(mass = m, at = {x, y, z});
  potential spring = 1/2*k*y^2;
  constraint right: z*cos(a) >= x*sin(a);
  constraint left: z*cos(a) >= -x*sin(a);
end Vee;
"""


@pytest.mark.full
def test_a_ball_in_a_groove_moves_along_it() -> None:
    model = lagc.loads(VEE).compile(backend="numpy")
    (found,) = model.equilibria()
    assert found.contacts == {"right": "touches", "left": "touches"}
    assert found.states == ("y", "der(y)") and found.stability == "stable: energy is least there"
    assert found.eigenvalues == pytest.approx([2j, -2j])
    push = 30.0 / (2.0 * cos(radians(40.0)))
    assert found.lam == pytest.approx([push, push], rel=1e-12)


ROPE = """model Rope "a rod that hangs on a rope"
  parameter Mass m = 1.5 [kg];
  parameter Length l = 2 [m], r = 0.5 [m];
  coordinate Length x, z(start = -2 [m]);
  coordinate Angle phi;
  Gravity field(g = 10 [m/s2], direction = {0, 0, -1});
  point P = {x, 0, z};
  frame B = rotate_y(world, phi);
  body rod = Solid(mass = m, inertia = {1/3*m*r^2, 1/3*m*r^2, 0}, frame = B, com = P - r*B.z);
  constraint rope: norm(P) <= l;
  output Force tension = reaction(rope);
end Rope;
"""


@pytest.mark.full
def test_a_rod_on_a_taut_rope_is_a_double_pendulum() -> None:
    """M = m [l^2, l r; l r, 4/3 r^2] and K = m g [l, 0; 0, r] in the angles of rope and rod."""
    found = lagc.loads(ROPE).compile(backend="numpy").linearize()
    assert found.contacts == {"rope": "touches"} and found.equilibrium
    length, r, g = 2.0, 0.5, 10.0
    mass = np.array([[length**2, length * r], [length * r, 4.0 / 3.0 * r**2]])
    squares = np.linalg.eigvals(np.linalg.solve(mass, g * np.diag([length, r])))
    rates = sorted(value.imag for value in found.eigenvalues if value.imag > 0.0)
    assert rates == pytest.approx(sorted(np.sqrt(squares)), rel=1e-12)
    assert found.stability == "stable: energy is least there"


@pytest.mark.sample(1, 5)
@pytest.mark.parametrize(
    "name", ["slack_rope", "incline", "roll_off_sphere", "slide_off_sphere", "billiard", "rolling_cart"]
)
def test_linear_models_are_the_slopes_of_the_rates(name: str) -> None:
    model = lagc.load(name).compile(backend="numpy")
    found = model.linearize()
    assert set(found.contacts.values()) <= {"touches", "sticks", "slips", "slips forwards"}
    size = np.abs(found.A).max()
    assert np.allclose(found.A, _differences(model, found), 1e-7, 1e-7 * size)


def test_a_belt_that_is_switched_holds_its_speed() -> None:
    found = lagc.load("conveyor").compile(backend="numpy").linearize(0.2)
    assert found.contacts == {"belt": "sticks"} and found.inputs == ()


@pytest.mark.full
def test_equilibria_on_a_belt_slide() -> None:
    """The friction of a belt that moves stretches the spring by mu m g/k (J. P. Den Hartog, 7.3)."""
    (found,) = lagc.load("block_on_belt").compile(backend="numpy").equilibria()
    assert found.contacts == {"belt": "slips backwards"}
    assert found.x[0] == pytest.approx(0.2 * 9.81 / 10.0, rel=1e-12)


@pytest.mark.full
def test_equilibria_in_all_modes() -> None:
    """A magnet above a floor: c/(h - y)^2 = m g is met once in the air, where the block is unstable. It may
    lie on the floor, too."""
    text = """model Magnet
      coordinate Length y(start = 0.1 [m]);
      Gravity field(g = 10 [m/s2], direction = {0, -1, 0});
      body block = Particle(mass = 1 [kg], at = {0, y, 0});
      potential magnet = -1.6 [N.m2]/(1 [m] - y);
      constraint floor: y >= 0;
    end Magnet;
    """
    found = lagc.loads(text).compile(backend="numpy").equilibria()
    assert [one.contacts["floor"] for one in found] == ["open", "touches"]
    assert found[0].x[0] == pytest.approx(0.6, rel=1e-12) and found[0].stability == "unstable"
    assert found[1].lam == pytest.approx([10.0 - 1.6])


@pytest.mark.parametrize(
    ("arguments", "lift", "u", "said"),
    [
        ("", 20.0, 0.0, "`floor` touches there, with a push of zero"),
        (FRICTION, 0.0, 6.5, "`floor` sticks there, and is about to slip"),
    ],
)
def test_where_two_modes_meet(arguments: str, lift: float, u: float, said: str) -> None:
    with pytest.raises(ArithmeticError, match=said):
        _block(arguments, u=u, lift=lift).linearize()


def test_a_state_that_approaches_has_an_impact() -> None:
    with pytest.raises(ArithmeticError, match="`floor` has an impact"):
        _block().linearize(x=[0.0, 0.0, 0.0, -1.0])
    with pytest.raises(ArithmeticError, match="`floor` has an impact"):
        _block().linearize(starts={"der(y)": -1.0})
    with pytest.raises(ArithmeticError, match="`floor` is open there, with a gap of zero"):
        _block().linearize(starts={"der(y)": 1.0})
    with pytest.raises(Refused, match="beyond the bound"):
        _block().linearize(x=[0.0, -0.1, 0.0, 0.0])


def test_just_before_an_impact_two_modes_meet() -> None:
    ball = lagc.load("bouncing_ball").compile(backend="numpy")
    fall = (2.0 / 9.81) ** 0.5
    assert ball.linearize(0.99 * fall).contacts == {"floor": "open"}
    with pytest.raises(ArithmeticError, match="`floor` is open there, with a gap of zero"):
        ball.linearize(fall * (1.0 - 1e-12))


def test_pushes_that_many_share() -> None:
    """A plate on four feet: the pushes are not determined, and a note says so."""
    text = """model Plate
      coordinate Length z, x;
      coordinate Angle a, b;
      Gravity field(g = 10 [m/s2], direction = {0, 0, -1});
      frame A = rotate_x(world, a);
      frame B = rotate_y(A, b);
      body plate = Solid(mass = 1 [kg], inertia = 0.1 [kg.m2]*{1, 1, 1.5}, frame = B, com = {x, 0, z});
      constraint feet: {z + a*(1 [m]) + b*(1 [m]), z + a*(1 [m]) - b*(1 [m]),
        z - a*(1 [m]) + b*(1 [m]), z - a*(1 [m]) - b*(1 [m])} >= {0, 0, 0, 0};
      potential spring = 1/2*(9 [N/m])*x^2;
    end Plate;
    """
    found = lagc.loads(text).compile(backend="numpy").linearize(starts={"x": 0.1})
    assert found.eigenvalues == pytest.approx([3j, -3j])
    assert any("share their pushes" in note for note in found.notes)


def test_derivatives_by_hand_are_refused() -> None:
    with pytest.raises(Refused) as refused:
        _block().jacobian("rates", "state")
    assert refused.value.faults[0].code == "LAG0623"


def test_generated_derivatives_are_refused_too(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    asked = ["build", "bouncing_ball", "--target", "c", "--derivatives", "-o", str(tmp_path / "made")]
    assert main(asked) == 1 and "LAG0623" in capsys.readouterr().err
    assert not (tmp_path / "made").exists()


def test_the_command_names_the_mode(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["linearize", "slack_rope"]) == 0
    assert "contacts rope touches" in capsys.readouterr().out
    assert main(["linearize", "slack_rope", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["linear"][0]["contacts"] == {"rope": "touches"}
