"""Models of any size, against the formulas of their stories and against one another."""

import math

import numpy
import pytest
from scipy.integrate import solve_ivp

import lagc
from lagc.api import Run
from lagc.host.model_library import library_models

ASKED = 1e-8
G = 9.81


def run(name: str, n: int, stop: float, **parameters: float) -> Run:
    made = lagc.load(f"large/{name}").compile(parameters={"n": n, **parameters}, backend="numpy")
    return made.simulate(stop=stop, accuracy=ASKED, points=41)


def assert_close(found: numpy.ndarray, expected: numpy.ndarray) -> None:
    """Within the accuracy that was asked for, of the largest value."""
    assert numpy.abs(found - expected).max() <= 2.0 * ASKED * max(1.0, numpy.abs(expected).max())


def integrated(rates, start: list[float], t: numpy.ndarray) -> numpy.ndarray:
    found = solve_ivp(rates, (t[0], t[-1]), start, method="DOP853", t_eval=t, rtol=1e-12, atol=1e-13)
    assert found.success
    return found.y


def test_a_pushed_lattice_moves_as_the_sum_of_its_modes() -> None:
    n, m, k, force = 9, 1.0, 100.0, 1.0
    found = run("lattice", n, 3.0)
    expected = force * found.t**2 / (2 * n * m)
    for j in range(1, n):
        omega = 2.0 * math.sqrt(k / m) * abs(math.sin(math.pi * j / n))
        expected = expected + force / (n * m * omega**2) * (1.0 - numpy.cos(omega * found.t))
    assert_close(found["u[1]"], expected)


def test_a_ring_of_bodies_breathes_as_in_keplers_problem() -> None:
    n = 7
    found = run("n_body", n, 2.0)
    attracted = 0.25 * sum(1.0 / math.sin(math.pi * j / n) for j in range(1, n))
    radius, _ = integrated(lambda t, x: [x[1], 1.0 / x[0] ** 3 - attracted / x[0] ** 2], [1.0, 0.0], found.t)
    for i in range(1, n + 1):
        assert_close(found[f"R[{i}]"], radius)


def test_joint_angles_add_up_to_angles_from_the_vertical() -> None:
    """Two rods: Lagrange's equations in the angles from the vertical."""
    n, m, length = 2, 1.0, 0.2
    found = run("relative_chain", n, 2.0)
    own, far = m * length**2 / 3.0, m * length**2
    start = [math.radians(10.0), math.radians(20.0), 0.0, 0.0]

    def rates(t: float, x: list[float]) -> list[float]:
        a, b, u, w = x
        cross = 0.5 * far * math.cos(a - b)
        bend = 0.5 * far * math.sin(a - b)
        mass = numpy.array([[own + far, cross], [cross, own]])
        force = [
            -bend * w * w - 1.5 * m * G * length * math.sin(a),
            bend * u * u - 0.5 * m * G * length * math.sin(b),
        ]
        return [u, w, *numpy.linalg.solve(mass, force)]

    a, b, *_ = integrated(rates, start, found.t)
    assert_close(found["q[1]"], a)
    assert_close(found["q[1]"] + found["q[2]"], b)


@pytest.mark.full
def test_a_ladder_whose_sides_are_parallel_moves_as_a_chain() -> None:
    n = 4
    found = run("truss", n, 1.0)
    chain = lagc.load("classic/chain").compile(parameters={"n": n, "l": 0.3}, backend="numpy")
    start = {f"th[{i}]": math.radians(20.0) for i in range(1, n + 1)}
    rates = {f"der(th[{i}])": 1.0 for i in range(1, n + 1)}
    expected = chain.simulate(stop=1.0, accuracy=ASKED, points=41, starts={**start, **rates})
    for i in range(1, n + 1):
        assert_close(found[f"a[{i}]"], expected[f"th[{i}]"])
        assert_close(found[f"b[{i}]"], expected[f"th[{i}]"])


def test_a_rope_of_one_piece_is_a_spherical_pendulum() -> None:
    found = run("rope", 1, 2.0)
    turn = math.sin(math.radians(40.0)) ** 2 * 2.0

    def rates(t: float, x: list[float]) -> list[float]:
        return [x[1], turn**2 * math.cos(x[0]) / math.sin(x[0]) ** 3 - G * math.sin(x[0])]

    assert_close(found["a[1]"], integrated(rates, [math.radians(40.0), 0.0], found.t)[0])


def test_a_mobile_whose_sides_are_equal_is_a_double_pendulum() -> None:
    """With both lower bobs as one."""
    plain = lagc.load("large/mobile").compile(parameters={"n": 3}, without=["crosswise"], backend="numpy")
    found = plain.simulate(stop=1.0, accuracy=ASKED, points=41)
    length, upper, lower = 0.3, 3.0, 2.0  # of all bobs, and of the lower ones

    def rates(t: float, x: list[float]) -> list[float]:
        a, b, u, w = x
        cross, bend = lower * math.cos(a - b), lower * math.sin(a - b)
        mass = numpy.array([[upper, cross], [cross, lower]])
        weight = G / length
        force = [-bend * w * w - upper * weight * math.sin(a), bend * u * u - lower * weight * math.sin(b)]
        return [u, w, *numpy.linalg.solve(mass, force)]

    a, b, *_ = integrated(rates, [math.radians(30.0), math.radians(30.0), 0.0, 0.0], found.t)
    assert_close(found["th[1]"], a)
    assert_close(found["th[2]"], b)
    assert_close(found["th[3]"], b)


def test_a_net_of_one_knot_is_an_elastic_pendulum() -> None:
    found = run("net", 1, 0.5)
    d, m, k = 0.2, 0.05, 200.0

    def rates(t: float, x: list[float]) -> list[float]:
        place = numpy.array([x[0], x[1], -d + x[2]])
        length = numpy.linalg.norm(place)
        pull = -k / m * (length - d) * place / length
        return [*x[3:], pull[0], pull[1], pull[2] - G]

    x, y, z, *_ = integrated(rates, [0.0, 0.0, 0.0, 0.0, 0.5, 0.0], found.t)
    assert_close(found["y[1]"], y)
    assert_close(found["z[1]"], z)
    assert_close(found["x[1]"], x)


def test_a_rod_on_a_ball_joint_is_a_top() -> None:
    """Euler's equations about the fixed point, and the orientation by its quaternion."""
    found = run("ball_chain", 1, 1.0)
    m, length, a, b = 1.0, 0.3, 0.03, 0.06
    fixed = numpy.array([b * b / 12 + length**2 / 3, a * a / 12 + length**2 / 3, (a * a + b * b) / 12])

    def rates(t: float, x: list[float]) -> list[float]:
        w, i, j, k, *turn = x
        down = [-2 * (i * k - w * j), -2 * (j * k + w * i), -(1 - 2 * (i * i + j * j))]  # in the rod's axes
        torque = numpy.cross([0.0, 0.0, -length / 2.0], numpy.array(down) * m * G)
        inertia = m * fixed
        change = (torque - numpy.cross(turn, inertia * turn)) / inertia
        p, q, s = turn
        quaternion = [
            -i * p - j * q - k * s,
            w * p + j * s - k * q,
            w * q + k * p - i * s,
            w * s + i * q - j * p,
        ]
        return [*(0.5 * value for value in quaternion), *change]

    expected = integrated(rates, [1.0, 0.0, 0.0, 0.0, 0.5, 1.0, 2.0], found.t)
    for name, values in zip(("w", "x", "y", "z"), expected):
        assert_close(found[f"link[1].o.{name}"], values)


@pytest.mark.full
def test_every_large_model_has_a_size() -> None:
    names = [name for name in library_models() if name.startswith("large/")]
    assert len(names) == 8
    for name in names:
        smaller = lagc.load(name).compile(parameters={"n": 3}, backend="numpy")
        assert smaller.interface.nv >= 3
