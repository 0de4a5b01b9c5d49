"""Friction between bodies that both move, and on surfaces that turn, against closed forms."""

import math

import numpy as np
import pytest

import lagc
from lagc.diagnostics.faults import Refused

G = 9.81
WEDGE = """model M
  parameter Angle a = 30 [deg];
  parameter Real mu = 0.2;
  coordinate Length s, x, z;
  Gravity field(g = 9.81 [m/s2]);
  body wedge = Solid(mass = 3 [kg], inertia = {{0, 0, 0}}, frame = world, com = {{s, 0, 0}});
  body block = Particle(mass = 1 [kg], at = {{x, 0, z}});
  constraint slope: z*cos(a) >= (x - s)*sin(a) (friction = mu, {});
  scene t
    simulate(stop = 1 [s]);
  end t;
end M;
"""
SLIP = "slip = (der(x) - der(s))*cos(a) + der(z)*sin(a)"


@pytest.mark.parametrize(
    "law",
    [
        "at = block, against = wedge",
        "on = wedge, at = block, against = block",
        pytest.param(SLIP, marks=pytest.mark.full),
    ],
)
def test_a_block_slides_on_a_wedge_that_moves(law: str) -> None:
    """The push is that of Newton's laws for both; m a = N n + mu N t + m g, M A = -(N n + mu N t)."""
    run = lagc.loads(WEDGE.format(law)).compile(backend="numpy").simulate(rtol=1e-9, points=2)
    c, s, mu = math.cos(math.radians(30.0)), 0.5, 0.2
    push = G * c / ((c + mu * s) * c + s * (s - mu * c) * (1.0 + 1.0 / 3.0))
    across = push * (s - mu * c)
    expected = [across / 3.0, -across, push * (c + mu * s) - G]
    assert [run.final[f"der({k})"] for k in "sxz"] == pytest.approx(expected, rel=1e-12)


BALLS = """model Balls
  parameter Mass m = 0.17 [kg], M = 0.3 [kg];
  parameter Length r = 0.028 [m], R = 0.04 [m];
  parameter Real mu = 0.1, e = 0.9;
  coordinate Length x1(start = -0.1 [m], rate = 1 [m/s]), y1(start = 0.02 [m]), z1(start = 0.01 [m]);
  coordinate Length x2, y2, z2;
  coordinate Orientation o1(rate = {10, -20, 30} [rad/s]), o2(rate = {5, 6, -7} [rad/s]);
  point C1 = {x1, y1, z1};
  point C2 = {x2, y2, z2};
  body one = Solid(mass = m, inertia = 2/5*m*r^2*{1, 1, 1}, frame = rotate(world, o1), com = C1);
  body two = Solid(mass = M, inertia = 2/5*M*R^2*{1, 1, 1}, frame = rotate(world, o2), com = C2);
  point P = C2 + R*normalize(C1 - C2);
  constraint hit: norm(C1 - C2) >= r + R (restitution = e, friction = mu, on = one, against = two, at = P);
  scene t
    simulate(stop = 0.1 [s]);
  end t;
  output AngularVelocity w1[3] = angular_velocity(one), w2[3] = angular_velocity(two);
end Balls;
"""


@pytest.mark.full
@pytest.mark.parametrize("mu", [0.1, 1.0])
def test_two_balls_with_spin_collide_in_space(mu: float) -> None:
    """p_n = (1 + e) m' u_n; p_t = 2/7 m' u_t, or mu p_n if that is less, with the reduced mass m'."""
    run = lagc.loads(BALLS).compile(backend="c").simulate(rtol=1e-10, parameters={"mu": mu})
    (hit,) = run.events
    m, other, r, far, e = 0.17, 0.3, 0.028, 0.04, 0.9
    v, w1, w2 = np.array([1.0, 0.0, 0.0]), np.array([10.0, -20.0, 30.0]), np.array([5.0, 6.0, -7.0])
    n = np.array([-0.1, 0.02, 0.01]) + v * hit.t
    assert np.linalg.norm(n) == pytest.approx(r + far, rel=1e-12)
    n = n / np.linalg.norm(n)
    u = v + np.cross(w1, -r * n) - np.cross(w2, far * n)
    along, reduced = u - (u @ n) * n, m * other / (m + other)
    push = -(1.0 + e) * reduced * (u @ n)
    hold = 2.0 / 7.0 * reduced * np.linalg.norm(along)
    rub = -min(mu * push, hold) * along / np.linalg.norm(along)
    assert (mu * push < hold) == (mu == 0.1) and hit.impulse == pytest.approx(push, rel=1e-9)
    one, two = v + (push * n + rub) / m, -(push * n + rub) / other
    spins = (
        w1 + np.cross(-r * n, rub) / (0.4 * m * r**2),
        w2 - np.cross(far * n, rub) / (0.4 * other * far**2),
    )
    found = [run.final[f"der({k}{i})"] for i in (1, 2) for k in "xyz"]
    assert found == pytest.approx([*one, *two], abs=1e-9)
    turned = [run.final[f"w{i}[{k}]"] for i in (1, 2) for k in (1, 2, 3)]
    assert turned == pytest.approx([*spins[0], *spins[1]], abs=1e-7)


@pytest.mark.full
@pytest.mark.parametrize("arguments", ["at = p", "slip = velocity(p)"])
def test_a_marble_slides_in_a_bowl(arguments: str) -> None:
    """Friction along a sphere, with the gap of a square: m a = m g + N n - mu N v/|v|, in steps of the
    classical Runge-Kutta method."""
    text = f"""model Bowl
  coordinate Length x(start = 0.6 [m]), y(rate = 1 [m/s]), z(start = -0.8 [m]);
  Gravity field(g = 9.81 [m/s2]);
  body p = Particle(mass = 2 [kg], at = {{x, y, z}});
  constraint bowl: x^2 + y^2 + z^2 <= 1 [m2] (friction = 0.1, {arguments});
  scene t
    simulate(stop = 1 [s]);
  end t;
end Bowl;
"""
    run = lagc.loads(text).compile(backend="numpy").simulate(rtol=1e-8, points=2)

    def rates(state: np.ndarray) -> np.ndarray:
        r, v = state[:3], state[3:]
        weight, n = np.array([0.0, 0.0, -G]), -r / np.linalg.norm(r)
        push = v @ v - weight @ n
        return np.array([*v, *(weight + push * (n - 0.1 * v / np.linalg.norm(v)))])

    state, h = np.array([0.6, 0.0, -0.8, 0.0, 1.0, 0.0]), 1.0 / 400.0
    for _ in range(400):
        k1 = rates(state)
        k2 = rates(state + h / 2.0 * k1)
        k3 = rates(state + h / 2.0 * k2)
        state = state + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + rates(state + h * k3))
    assert [run.final[name] for name in ("x", "y", "z")] == pytest.approx(state[:3], abs=1e-7)


@pytest.mark.parametrize(
    ("law", "message"),
    [("against = wedge", "`against` needs `at`"),
     ("on = world, at = {x, 0, z}, against = world", "no velocity"),
     ("at = block, against = a", "needs a body"),
     (f"{SLIP}, against = wedge", "`against` needs `at`")],
)  # fmt: skip
def test_what_is_against_nothing_is_refused(law: str, message: str) -> None:
    with pytest.raises(Refused) as found:
        lagc.loads(WEDGE.format(law)).compile(backend="numpy")
    texts = [f"{fault.message} {fault.remedy}" for fault in found.value.faults]
    assert any(message in text for text in texts), texts


def test_what_a_contact_moves_has_no_warning() -> None:
    assert lagc.load("block_on_wedge").check() == []
