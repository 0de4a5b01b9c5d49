"""Derivatives in Python, against closed forms."""

import math
import pickle

import pytest

import lagc

pytestmark = pytest.mark.usefixtures("own_cache")

STRING = """
model String "a driven mass on a string"
  parameter Mass m = 2 [kg];
  parameter Length l = 0.5 [m];
  parameter AngularVelocity w = 3 [rad/s];
  input Force u = 0.3;
  coordinate Length x(start = 0.3 [m]), z(start = -0.4 [m]);
  body bob = Particle(mass = m, at = {x, 0, z});
  force push = {u, 0, m*x*w^2} at bob;
  constraint string: x^2 + z^2 = l^2;
  output Force pull = reaction(string)*l;
end String;
"""


@pytest.fixture(scope="module")
def pendulum() -> lagc.CompiledModel:
    return lagc.load("simple_pendulum").compile(scene="vacuum", backend="numpy")


@pytest.fixture(scope="module")
def string() -> lagc.CompiledModel:
    return lagc.loads(STRING).compile(backend="numpy")


def test_of_a_pendulum(pendulum: lagc.CompiledModel) -> None:
    g, r, m, theta, rate = 9.81, 0.5, 1.0, 0.7, 2.0
    x = [theta, rate]
    found = pendulum.jacobian("rates", "state", 0.0, x)
    assert found.tolist() == [[0.0, 1.0], [pytest.approx(-g / r * math.cos(theta)), 0.0]]
    (row,) = pendulum.jacobian("accelerations", ["l", "time"], 0.0, x)
    assert row.tolist() == pytest.approx([g / r**2 * math.sin(theta), 0.0])
    bound = pendulum.bind({"l": 0.7, "m": 2.0})
    assert bound.jacobian("forces", "theta", 0.0, x)[0, 0] == pytest.approx(-2.0 * g * 0.7 * math.cos(theta))
    (row,) = pendulum.jacobian("inertia", ("l", "accelerations"), 0.0, x, a=[3.0])
    assert row.tolist() == pytest.approx([2 * m * r * 3.0, m * r * r])
    again = pendulum.jacobian("forces", "theta", 0.0, x, parameters={"l": (70, "cm"), "m": 2.0})
    assert again.tolist() == bound.jacobian("forces", "theta", 0.0, x).tolist()
    assert pickle.loads(pickle.dumps(pendulum)).jacobian("rates", "state", 0.0, x).tolist() == found.tolist()


def test_constraints_are_taken_into_account(string: lagc.CompiledModel) -> None:
    """lam = -(m v^2 + u x + m w^2 x z)/(2 l^2): m a = f + 2 (x, z) lam, x a_x + z a_z = -v^2."""
    m, r, w, u, x, z, s = 2.0, 0.5, 3.0, 0.3, 0.3, -0.4, 1.5
    state = [x, z, s * -z / r, s * x / r]
    square = x * x + z * z

    def lam(x: float, z: float, v2: float) -> float:
        return -(m * v2 + u * x + m * w * w * x * z) / (2 * (x * x + z * z))

    force = lam(x, z, s * s)
    by_x = -(u + m * w * w * z) / (2 * square) - 2 * x / square * force
    by_z = -m * w * w * x / (2 * square) - 2 * z / square * force
    by_v = [-m * v / square for v in state[2:]]
    (row,) = string.jacobian("multipliers", "state", 0.0, state)
    assert row.tolist() == pytest.approx([by_x, by_z, *by_v], rel=1e-13)
    (row,) = string.jacobian("multipliers", ("m", "w", "l", "inputs"), 0.0, state)
    expected = [-(s * s + w * w * x * z) / (2 * square), -m * w * x * z / square, 0.0, -x / (2 * square)]
    assert row.tolist() == pytest.approx(expected, rel=1e-13)
    table = string.jacobian("accelerations", ("x", "u"), 0.0, state)
    expected_x = [2 * (force + x * by_x) / m, w * w + 2 * z * by_x / m]
    assert table[:, 0].tolist() == pytest.approx(expected_x, rel=1e-13)
    assert table[0, 1] == pytest.approx((1 - x * x / square) / m, rel=1e-13)
    (row,) = string.jacobian("outputs", ("x", "l"), 0.0, state)
    assert row.tolist() == pytest.approx([by_x * r, force], rel=1e-13)
    phi, psi = string.jacobian("conditions", ("state", "l"), 0.0, state)
    assert phi.tolist() == pytest.approx([2 * x, 2 * z, 0.0, 0.0, -2 * r])
    assert psi.tolist() == pytest.approx([2 * state[2], 2 * state[3], 2 * x, 2 * z, 0.0])
    assert string.jacobian("rows", "multipliers", 0.0, state).tolist() == [[0.0]]
    assert string.jacobian("forces", "multipliers", 0.0, state, lam=[0.0])[:, 0].tolist() == [2 * x, 2 * z]


def test_starts_depend_on_parameters(pendulum: lagc.CompiledModel) -> None:
    disc = lagc.load("classic/rolling_disc").compile(backend="numpy")
    found = disc.jacobian("start", ("r", "lean0"))
    k = disc.state_names.index("z")
    assert found[k].tolist() == pytest.approx([math.cos(0.3), -0.26 * math.sin(0.3)])


def test_sides_of_switches() -> None:
    """x - a t^2 passes 0; the square of x counts in steps of e."""
    text = """model M
      parameter Acceleration a = 3 [m/s2]; parameter Area e = 0.01 [m2];
      coordinate Length x(start = 1 [m]);
      body b = Particle(mass = 1 [kg], at = {x, 0, 0});
      force f = {(if x > a*time^2 then 1 [N] else 2 [N]) + 1 [N]*floor(x^2/e), 0, 0} at b;
    end M;"""
    model = lagc.loads(text).compile(backend="numpy")
    t, x, a, e = 0.5, 0.9, 3.0, 0.01
    found = model.jacobian("indicators", ("time", "state", "a", "e"), t, [x, 0.0])
    order = ["whole number" in name for name in model.interface.relations]
    sign, steps = found[order.index(False)], found[order.index(True)]
    sense = sign[1]  # which of both sides is that of which the expression counts is free
    assert abs(sense) == 1.0
    assert (sense * sign).tolist() == pytest.approx([-2 * a * t, 1.0, 0.0, -t * t, 0.0])
    assert steps.tolist() == pytest.approx([0.0, 2 * x / e, 0.0, 0.0, -x * x / e**2])
    plain = lagc.load("simple_pendulum").compile(backend="numpy")
    assert plain.jacobian("indicators", "state").shape == (0, 2)


@pytest.mark.parametrize(
    "of, wrt, x, kind",
    [("motion", "state", None, KeyError), ("rates", "thet", None, KeyError),
     ("rates", "multipliers", None, KeyError), ("rates", "state", [0.0], ValueError),
     ("rates", "state", [math.nan, 0.0], ArithmeticError)],
)  # fmt: skip
def test_what_makes_no_sense_is_said(
    of: str, wrt: str, x: list[float] | None, kind: type[Exception], pendulum: lagc.CompiledModel
) -> None:
    with pytest.raises(kind):
        pendulum.jacobian(of, wrt, 0.0, x)
