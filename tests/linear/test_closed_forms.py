"""Equilibria, modes and linear models of models whose closed forms are known."""

from collections.abc import Sequence
from functools import cache
from math import acos, cos, exp, pi, sin, sqrt

import numpy as np
import pytest

import lagc
from lagc.reports.linear import heading
from lagc.simulation.linearization import equilibria
from lagc.simulation.linearization.derivatives import pseudo_inverse
from lagc.simulation.linearization.linear_model import Linear
from tests.simulation.test_groups_at_rest import PLATFORM

G = 9.81
CLOSE = 1e-10  # relative: eigenvalues of small matrices, of equilibria that Newton's method found


@cache
def model_of(name: str, scene: str | None = None) -> lagc.CompiledModel:
    return lagc.load(name).compile(scene, backend="numpy")


def found(name: str, scene: str | None = None, **parameters: float) -> list[Linear]:
    return model_of(name, scene).equilibria(parameters=parameters)


def at(linear: Linear) -> dict[str, float]:
    interface = linear.system.interface
    return dict(zip((*interface.q_names, *interface.v_names), linear.x))


def assert_spectrum(linear: Linear, expected: Sequence[complex]) -> None:
    """The same eigenvalues, with their multiplicities, in any order."""
    values, size = list(linear.eigenvalues), max(map(abs, expected), default=0.0)
    assert len(values) == len(expected)
    for value in expected:
        nearest = min(values, key=lambda other: abs(other - value))
        assert abs(nearest - value) <= CLOSE * size, (value, linear.eigenvalues)
        values.remove(nearest)


def pairs(*squares: float) -> list[complex]:
    """The eigenvalues +-sqrt(s) of y'' = s y."""
    return [sign * root for s in squares for root in [complex(s) ** 0.5] for sign in (1, -1)]


def test_a_pendulum_hangs_or_stands() -> None:
    down, up = found("course/simple_pendulum", "vacuum", l=0.7)
    assert at(down)["theta"] == 0.0 and at(up)["theta"] == pytest.approx(pi)
    assert_spectrum(down, pairs(-G / 0.7))
    assert_spectrum(up, pairs(G / 0.7))
    assert down.stability == "stable: energy is least there" and up.stability == "unstable"


LEAST = """model Bowl
  coordinate Length x(start = 0.1), y(start = 0.1);
  body p = Particle(mass = 1, at = {x, y, 0});
  potential V = 1 [N/m]*({ENERGY});
  MORE
end Bowl;
"""


@pytest.mark.sample(1)
@pytest.mark.parametrize(
    ("energy", "more", "verdict"),
    [
        ("x^2 + y^2", "", "stable: energy is least there"),
        ("x^2 + y^2", "lagrangian B = 9 [kg/s]*(x*der(y) - y*der(x));", "neutral"),  # is stable, untold
        ("-x^2 - y^2", "lagrangian B = 9 [kg/s]*(x*der(y) - y*der(x));", "neutral"),  # by the speeds alone
        ("x^2 + y^4/(1 [m2])", "", "neutral"),
        ("x^2 + (0.3 [m] - y)^3/(1 [m])", "", "neutral"),  # found where it still bends upwards
        ("x^2 + y^2", "force f = {-(1 [N/m])*x, 0, 0} at p;", "neutral"),  # that it is a spring's is not seen
        ("x^2 - y^2", "constraint c: y = x^3/(1 [m2]);", "stable: energy is least there"),
        ("x^2 - y^2", "constraint c: x = y^3/(1 [m2]);", "unstable"),
        ("x^2 + y^2", "force f = -(1 [kg/m])*norm(velocity(p))*velocity(p) at p;", "neutral"),
    ],
)
def test_where_energy_is_least_a_motion_stays(energy: str, more: str, verdict: str) -> None:
    text = LEAST.replace("{ENERGY}", energy).replace("MORE", more)
    (linear, *_) = lagc.loads(text).compile(backend="numpy").equilibria()
    assert linear.stability and linear.stability.startswith(verdict)


@pytest.mark.sample(1)
@pytest.mark.parametrize(("product", "verdict"), [("0.7", "stable: energy is least there"), ("p", "neutral")])
def test_an_inertia_with_products_that_is_surely_positive_is_as_good_as_one_without(
    product: str, verdict: str
) -> None:
    text = f"""model Hanging
  parameter Real p = 0;
  coordinate Angle a(start = 0.1), b(start = 0.1);
  frame A = rotate_x(world, a);
  frame B = rotate_y(A, b);
  body s = Solid(mass = 2, frame = B,
    inertia = 1 [kg.m2]*{{{{2, 0.3, 0.1}}, {{0.3, 3, {product}}}, {{0.1, {product}, 2.5}}}},
    com = {{0, 0, 0}} - 0.5 [m]*B.z);
  Gravity g(g = 9.81, direction = {{0, 0, -1}});
end Hanging;
"""
    (linear, *_) = lagc.loads(text).compile(backend="numpy").equilibria()
    assert linear.stability and linear.stability.startswith(verdict)


def test_where_nothing_moves_nothing_is_said_of_stability() -> None:
    still = lagc.loads(
        LEAST.replace("{ENERGY}", "x^2").replace("MORE", "constraint c: x = 1 [m]; constraint d: y = x;")
    )
    linear = still.compile(backend="numpy").linearize()
    assert not linear.states and linear.stability is None and linear.to_dict()["stability"] is None
    assert heading(linear) == "an equilibrium; nothing moves"


@pytest.mark.full
def test_drag_without_a_slope_at_rest_leaves_it_as_it_is() -> None:
    """norm(v) v divides by the speed, which is 0; nothing depends on time for that."""
    for one, other in zip(found("course/simple_pendulum", "room"), found("course/simple_pendulum", "vacuum")):
        assert np.array_equal(one.A, other.A)
        assert (one.stability == "unstable") == (other.stability == "unstable")
        assert not one.time_dependent and not one.linear


def test_on_a_string_it_does_the_same_and_the_string_pulls_or_pushes() -> None:
    down, up = found("course/string_pendulum")
    for linear, sign in ((down, 1.0), (up, -1.0)):
        assert linear.states == ("x", "der(x)")
        assert at(linear)["z"] == pytest.approx(-0.5 * sign) and at(linear)["x"] == 0.0
        assert linear.lam == pytest.approx([-sign * G])  # m g along the gradient of norm(position) = l
        assert_spectrum(linear, pairs(-sign * G / 0.5))
        assert linear.C[linear.outputs.index("tension")].tolist() == pytest.approx([0.0, 0.0], abs=1e-12)


def test_a_pendulum_on_a_cart_is_free_to_be_anywhere() -> None:
    up, down = found("classic/cart_pendulum", "falling", M=2.0, m=0.5, l=0.3)
    for linear, sign in ((up, 1.0), (down, -1.0)):
        assert linear.free == 1 and linear.idle == ("x", "der(x)")
        assert_spectrum(linear, [0.0, 0.0, *pairs(sign * 2.5 * G / (2.0 * 0.3))])


def test_two_pendulums_have_four_equilibria() -> None:
    """M y'' = -K y with K of the configurations: (m1 + m2) g l cos theta1, m2 g l cos theta2; equal
    masses."""
    linears = found("classic/double_pendulum", "small")
    assert [linear.stability == "unstable" for linear in linears] == [False, True, True, True]
    assert len(linears) == 4
    for linear in linears:
        c1, c2 = cos(at(linear)["theta1"]), cos(at(linear)["theta2"])
        mass = np.array([[2.0, c1 * c2], [c1 * c2, 1.0]])
        squares = np.linalg.eigvals(-np.linalg.inv(mass) @ np.diag([2.0 * G * c1, G * c2]))
        assert_spectrum(linear, pairs(*squares))
    assert_spectrum(linears[0], pairs(-(2 - sqrt(2)) * G, -(2 + sqrt(2)) * G))


@pytest.mark.full
def test_a_bead_on_a_turning_hoop_stays_out_or_below() -> None:
    fast, slow = 6.0, 2.0
    below, out, top, other = _by_angle(found("classic/bead_on_hoop_angle", "fast", w=fast))
    tilted = acos(G / fast**2)
    assert [at(e)["theta"] for e in (below, out, other)] == pytest.approx([0.0, tilted, -tilted])
    assert_spectrum(below, pairs(fast**2 - G))
    assert_spectrum(out, pairs(-((fast * sin(tilted)) ** 2)))
    assert_spectrum(other, pairs(-((fast * sin(tilted)) ** 2)))
    assert_spectrum(top, pairs(fast**2 + G))
    below, top = found("classic/bead_on_hoop_angle", "fast", w=slow)
    assert_spectrum(below, pairs(slow**2 - G))


def _by_angle(linears: list[Linear]) -> tuple[Linear, Linear, Linear, Linear]:
    """Below, out, on the top, out on the other side."""
    one, two, three, four = sorted(linears, key=lambda e: e.x[0] % (2 * pi))
    return one, two, three, four


@pytest.mark.full
def test_trojans_go_around_the_triangular_points() -> None:
    """l^4 + l^2 + 27/4 mu (1 - mu) = 0 (w = 1); the collinear points are unstable."""
    mu = 9.537e-4
    linears = found("classic/lagrange_points", "tadpole")
    triangular = [e for e in linears if abs(at(e)["y"]) > 0.5]
    assert sorted(at(e)["y"] for e in triangular) == pytest.approx([-sqrt(0.75), sqrt(0.75)])
    for linear in triangular:
        assert at(linear)["x"] == pytest.approx(0.5 - mu)
        root = sqrt(1.0 - 27.0 * mu * (1.0 - mu))
        assert_spectrum(linear, pairs((-1.0 + root) / 2.0, (-1.0 - root) / 2.0))
    assert all(linear.stability == "unstable" for linear in linears if linear not in triangular)


@pytest.mark.full
def test_a_chain_of_springs() -> None:
    linear = found("classic/spring_chain", "lab", k=3.0, m=0.2)[0]
    assert linear.x == [0.0] * 16
    squares = [-4.0 * 3.0 / 0.2 * sin(j * pi / 18.0) ** 2 for j in range(1, 9)]
    assert_spectrum(linear, pairs(*squares))
    slowest = linear.modes[:8, list(np.abs(linear.eigenvalues)).index(min(np.abs(linear.eigenvalues)))]
    assert slowest == pytest.approx([sin(i * pi / 9.0) / sin(4 * pi / 9.0) for i in range(1, 9)], abs=1e-9)


def test_a_governor_with_a_drive() -> None:
    """The steady motion phi' = w - T/c, here with no torque left: theta decoupled but for Coriolis."""
    m, mass, length, inertia, w, c, d = 1.0, 2.0, 0.2, 0.05, 14.0, 5.0, 0.3
    theta = acos((m + mass) * G / (m * length * w**2))
    model = model_of("classic/watt_governor", "driven")
    linear = model.linearize(0.0, [theta, 0.0, 0.0, w])
    assert linear.steady and not linear.equilibrium and linear.idle == ("phi",)
    a = 2.0 * m * length**2 + 4.0 * mass * length**2 * sin(theta) ** 2
    b = 2.0 * m * length**2 * sin(theta) ** 2 + inertia
    slope = 2.0 * m * length**2 * cos(2 * theta) * w**2 - 2.0 * (m + mass) * G * length * cos(theta)
    coupling = 4.0 * m * length**2 * sin(theta) * cos(theta) * w
    matrix = np.array([[0, 1, 0], [slope / a, -d / a, coupling / a], [0, -coupling / b, -c / b]])
    assert_spectrum(linear, [0.0, *np.linalg.eigvals(matrix)])


def test_where_slopes_vanish_for_a_moment_nothing_is_steady() -> None:
    """Pendulums at rest at the horizontal, where gravity has no slope: A is zero in the angles, but is not
    for long."""
    for name, x in (
        ("course/simple_pendulum", [pi / 2, 0.0]),
        ("classic/double_pendulum", [pi / 2, pi / 2, 0.0, 0.0]),
    ):
        linear = model_of(name).linearize(0.0, x)
        assert not linear.steady and linear.momentary and linear.stability is None and not linear.idle


def test_a_conical_pendulum() -> None:
    """Nutation about the cone: square phi'^2 (1 + 3 cos^2 theta)."""
    theta = 1.1
    varying = sqrt(G / cos(theta))
    model = model_of("classic/spherical_pendulum_angles", "lab")
    linear = model.linearize(0.0, [theta, 0.4, 0.0, varying])
    assert linear.steady and linear.idle == ("phi",)
    assert_spectrum(linear, [0.0, 0.0, *pairs(-(varying**2) * (1.0 + 3.0 * cos(theta) ** 2))])


def test_a_disc_that_rolls_upright_leans_and_turns() -> None:
    """Square of the wobble 12/5 spin^2 - 4/5 g/r: stable faster than sqrt(g r/3) (Routh)."""
    r = 0.26
    model = model_of("classic/rolling_disc", "table")
    for spin in (1.0, 3.0, 8.0):
        x = [0.0, 0.0, r, 0.3, 0.0, 0.0, r * spin * cos(0.3), r * spin * sin(0.3), 0.0, 0.0, 0.0, spin]
        linear = model.linearize(0.0, x)
        assert linear.steady and linear.states[-1] in ("der(spin)", "der(lean)", "der(yaw)")
        square = -(12.0 / 5.0 * spin**2 - 4.0 / 5.0 * G / r)
        assert_spectrum(linear, [*([0.0] * (len(linear.states) - 2)), *pairs(square)])


def test_a_sleigh_runs_straight_with_its_weight_ahead() -> None:
    """theta' decays with m a v/(I + m a^2); backwards it grows so."""
    model = model_of("classic/chaplygin_sleigh", "ice")
    for speed in (0.5, -0.5):
        linear = model.linearize(0.0, [0.0, 0.0, 0.0, speed, 0.0, 0.0])
        rate = -0.2 * speed / (0.1 + 0.2**2)
        assert linear.steady
        assert_spectrum(linear, [0.0] * (len(linear.states) - 1) + [rate])


@pytest.mark.full
def test_a_ball_on_a_turntable_goes_in_circles() -> None:
    """At 2/7 of the turntable's rate, about any point (S. Earnshaw)."""
    linear = found("classic/sphere_on_turntable", "table")[0]
    omega = dict(zip([f.name for f in linear.system.interface.parameters], linear.system.parameters))
    varying = 2.0 / 7.0 * next(value for name, value in omega.items() if name.lower() == "omega")
    values = [value for value in linear.eigenvalues if value]
    assert sorted(value.imag for value in values) == pytest.approx([-varying, varying])
    assert all(value.real == 0.0 for value in values)


SERVO = """
model Servo "a mass between a spring and what is driven by hand"
  parameter Mass m = 2 [kg], M = 3 [kg];
  parameter Stiffness k = 5 [N/m];
  parameter Damping c = 0.4 [N.s/m];
  input Force u;
  input Force w;
  coordinate Length x, y;
  body a = Particle(mass = m, at = {x, 0, 0});
  body b = Particle(mass = M, at = {y, 0, 0});
  potential spring = 1/2*k*x^2;
  dissipation damper = 1/2*c*der(x)^2;
  force push = u*world.x at a;
  force pull = w*world.x at b;
  constraint rod: y = x + 1 [m];
  output Acceleration ax = der(der(x));
  output Force inside = reaction(rod);
  output Length gap = y - x;
end Servo;
"""


def test_inputs_and_outputs_with_a_constraint() -> None:
    linear = lagc.loads(SERVO).compile(backend="numpy").linearize()
    m, mass, k, c = 2.0, 3.0, 5.0, 0.4
    assert linear.states == ("x", "der(x)") and linear.inputs == ("u", "w")
    total = m + mass
    assert linear.A.tolist() == [[0.0, 1.0], pytest.approx([-k / total, -c / total])]
    assert linear.B.tolist() == [[0.0, 0.0], pytest.approx([1.0 / total, 1.0 / total])]
    # M y'' = w + lam, the residual being y - x - 1
    ax, inside, gap = linear.C.tolist()
    assert ax == pytest.approx([-k / total, -c / total])
    assert inside == pytest.approx([-mass * k / total, -mass * c / total])
    assert gap == [0.0, 0.0]
    assert linear.D.tolist() == [
        pytest.approx([1.0 / total, 1.0 / total]),
        pytest.approx([mass / total, mass / total - 1.0]),
        [0.0, 0.0],
    ]


def test_what_changes_with_time_is_of_the_moment() -> None:
    linear = found("classic/kapitza_pendulum", "shaken")[0]
    assert linear.momentary and linear.stability is None
    driven = model_of("classic/driven_oscillator", "resonance").linearize(0.3)
    assert driven.linear and not driven.equilibrium and driven.stability == "asymptotically stable"


SPRING = """model Spring
  parameter Length l = 1 [m];
  parameter AngularVelocity w = 1 [rad/s];
  coordinate Length x(start = 0.1*l);
  body b = Particle(mass = 1 [kg], at = {x, 0, 0});
  potential V = (1 [kg])*w^2*(x^2/2 FURTHER);
end Spring;
"""


@pytest.mark.sample(1)
@pytest.mark.parametrize(
    "further, linear, time_dependent",
    [("", True, False), ("+ x^4/l^2/4", False, False), ("- 0.3*x^2*sin(w*time)", False, True)],
)
def test_what_it_depends_on_does_not_depend_on_units(
    further: str, linear: bool, time_dependent: bool
) -> None:
    model = lagc.loads(SPRING.replace("FURTHER", further)).compile(backend="numpy")
    for size in (1e-12, 1.0, 1e16):
        for pace in (1e-14, 1.0, 1e9):
            found = model.linearize(parameters={"l": size, "w": pace})
            assert (found.linear, found.time_dependent) == (linear, time_dependent), (size, pace)


FALLING = """model Falling
  parameter Real[s-1] k = 5;
  coordinate Length x(start = 1 [m], rate = -5 [m/s]);
  body b = Particle(mass = 1 [kg], at = {x, 0, 0});
  potential W = -1/2*(1 [kg])*k^2*x^2;
end Falling;
"""


def test_a_motion_that_rounding_moves_has_a_model_and_a_note() -> None:
    """exp(-k t), which rounding leaves by 1e-16 exp(k t)."""
    model = lagc.loads(FALLING).compile(backend="numpy")
    linear = model.linearize(4.0)
    (note,) = linear.notes
    known = float(note.split("relative error of ")[1].split(":")[0])
    assert abs(linear.x[0] - exp(-20.0)) <= known <= 1e-5
    assert np.array_equal(linear.A, [[0.0, 1.0], [25.0, 0.0]])
    assert not model.linearize(1.0).notes
    with pytest.raises(ArithmeticError, match="predictable"):
        model.linearize(8.0)


TRIES = 32
RUBBED = """model Rubbed
  coordinate Angle a(start = 1.2), b(start = -0.3);
  coordinate Length x(start = 0.9 [m]);
  body pin = Particle(mass = 0.5 [kg], at = {0.3 [m]*cos(a), 0, 0.3 [m]*sin(a)});
  body slider = Particle(mass = 1.1 [kg], at = {x, 0, 0});
  constraint along: x = 0.3 [m]*cos(a) + 0.8 [m]*cos(b);
  constraint level: 0 [m] = 0.3 [m]*sin(a) + 0.8 [m]*sin(b);
  Gravity field(g = 9.81 [m/s2], direction = {0, 0, -1});
  force rub = {-0.5 [N]*sign(der(x)), 0, 0} at slider;
end Rubbed;
"""


@pytest.mark.full
def test_at_rest_dry_friction_pushes_neither_way() -> None:
    """The pin of a slider-crank rests above or below its axle, and no linear model tells what is about it.
    A search that friction makes uneven: which tries end depends on the machine's last bits."""
    model = lagc.loads(RUBBED).compile(backend="numpy")
    system = model.differentiated()
    configurations = equilibria.equilibria(system, system.start(), tries=TRIES)
    assert configurations
    for one in configurations:
        assert abs(cos(one.x[0])) < CLOSE and one.x[3:] == [0.0, 0.0, 0.0]
    with pytest.raises(ArithmeticError, match="forces are discontinuous"):
        model.equilibria(tries=TRIES)


@pytest.mark.full
def test_whole_turns_of_many_angles_are_taken_off_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whether something is an equilibrium is asked a few times, however many links have turned."""
    asked: list[object] = []
    met = equilibria._Search._is_met
    monkeypatch.setattr(equilibria._Search, "_is_met", lambda *given: asked.append(given) or met(*given))
    for n in (3, 12):
        asked.clear()
        system = lagc.load("chain").compile(parameters={"n": n}, backend="numpy").differentiated()
        start = [2.0 * pi * k for k in range(1, n + 1)] + [0.0] * n
        (one,) = equilibria.equilibria(system, start, tries=0)
        assert one.x == pytest.approx([0.0] * 2 * n, abs=1e-12)
        assert len(asked) <= 5


@pytest.mark.parametrize("least", (1.0, 1e-6, 1e-13, 0.0))
def test_matrices_are_inverted_as_far_as_they_tell(least: float) -> None:
    dice = np.random.default_rng(1)
    left, right = (np.linalg.qr(dice.normal(size=(6, 6)))[0] for _ in range(2))
    sizes = np.array([3.0, 2.0, 1.0, 1.0, 0.5, least])
    told = np.where(sizes > 1e-9, 1.0 / np.maximum(sizes, 1e-9), 0.0)
    expected = right * told @ left.T
    found = pseudo_inverse(left * sizes @ right.T, equilibria.DEPENDENT)
    assert found == pytest.approx(expected, abs=1e-8 * told.max())


def test_a_motion_that_is_wrong_has_none() -> None:
    """On its cut the energy of an angle leaps, which no run sees: all agree on what is no motion."""
    text = """model Leaping
      coordinate Length x(start = 0.8), y(rate = 0.9);
      body p = Particle(mass = 1 [kg], at = {x, y, 0});
      potential V = 1/2*1 [N/m]*(x^2 + y^2) + 0.03 [J]*atan2(y, x);
    end Leaping;"""
    with pytest.raises(ArithmeticError, match="out of balance"):
        lagc.loads(text).compile(backend="numpy").linearize(4.0)


SKATE = """model Skate
  coordinate Length x, y(start = 0.2 [m]);
  coordinate Angle a(start = 0.1);
  frame f = rotate_z(world, a);
  body b = Solid(mass = 1 [kg], com = {x, y, 0}, frame = f, inertia = 6 [kg.m2]*{1, 1, 1});
  constraint blade: dot(velocity(b), f.y) = 0;
  potential V = 1 [N.m]*cos(a) + 2 [N/m]*(y - 0.3 [m])^2;
end Skate;
"""


@pytest.mark.full
def test_a_blade_holds_along_a_line_of_configurations_of_other_energies() -> None:
    """Along and against the axis it stands anywhere, held by its multiplier against the spring, and turns by
    6 a'' = sin(a): two families."""
    one, other = lagc.loads(SKATE).compile(backend="numpy").equilibria()
    for linear, a, values in ((one, 0.0, [6**-0.5, 0, 0, 0, -(6**-0.5)]),
                              (other, pi, [6**-0.5 * 1j, 0, 0, 0, -(6**-0.5) * 1j])):  # fmt: skip
        there = at(linear)
        assert abs(there["a"]) == pytest.approx(a, abs=CLOSE)
        assert linear.lam == pytest.approx([4.0 * (there["y"] - 0.3) * cos(a)], abs=CLOSE)
        assert_spectrum(linear, values)


@pytest.mark.full
def test_no_equilibrium() -> None:
    assert found("classic/kepler") == []


@pytest.mark.full
def test_a_configuration_where_nothing_is_finite_leaves_the_others() -> None:
    """Of the car axis, some random configurations lie where roots have no derivative."""
    found = lagc.load("classic/car_axis").compile(backend="numpy").equilibria()
    assert found and all(np.isfinite(linear.A).all() for linear in found)


CHAIN = """model Many
  coordinate Length x[COUNT];
  for i in 1:COUNT loop body b[i] = Particle(mass = 1 [kg], at = {x[i], 0, 0}); end for;
  for i in 1:COUNT loop potential V[i] = 1/2*1 [N/m]*x[i]^2; end for;
end Many;"""


def test_large_systems_are_looked_at_from_fewer_configurations() -> None:
    """So that what they cost is bounded."""
    found = [
        equilibria.tries_for(
            lagc.loads(CHAIN.replace("COUNT", str(n))).compile(backend="numpy").differentiated()
        )
        for n in (2, 10, 200)
    ]
    assert found == [equilibria.TRIES, equilibria.TRIES, equilibria.FEWEST]


@pytest.mark.full
def test_the_cusp_of_a_curve_is_no_equilibrium() -> None:
    """At u = pi the cycloid has no inertia and its force none; along its arc s'' = -g s/4a, s = 4a there."""
    (found,) = lagc.load("classic/cycloid_pendulum").compile(backend="numpy").equilibria()
    assert found.x[0] == pytest.approx(0.0, abs=1e-9)
    with pytest.raises(ArithmeticError, match="no inertia"):
        lagc.load("classic/spherical_pendulum_angles").compile(backend="numpy").equilibria()


PANELS = """model Panels "of crossed rods, hinged above one another"
  structural Integer n = 1;
  coordinate Length x[2*n], y[2*n], z[2*n];
  point A[0] = {0, 0, 0};
  point B[0] = {1, 0, 0} [m];
  for i in 1:n loop
    point A[i] = {x[i], y[i], z[i] - i*1 [m]};
    point B[i] = {1 [m] + x[i+n], y[i+n], z[i+n] - i*1 [m]};
    body a[i] = Particle(mass = 1 [kg], at = A[i]);
    body b[i] = Particle(mass = 1 [kg], at = B[i]);
    constraint l[i]: norm(A[i] - A[i-1]) = 1 [m];
    constraint r[i]: norm(B[i] - B[i-1]) = 1 [m];
    constraint h[i]: norm(A[i] - B[i]) = 1 [m];
    constraint d1[i]: norm(B[i] - A[i-1]) = sqrt(2)*1 [m];
    constraint d2[i]: norm(A[i] - B[i-1]) = sqrt(2)*1 [m];
  end for;
  Gravity field(g = 9.81, direction = {0, 0, -1});
end Panels;
"""


@pytest.mark.full
@pytest.mark.parametrize("n", (1, 2))
def test_a_panel_is_no_pair_of_pendulums(n: int) -> None:
    """Its rods allow it to be twisted to first order, and no further: a pendulum has the frequency sqrt(g/d),
    a double one of panels sqrt((2 -+ sqrt(2)) g/d); what else there is belongs to twists."""
    all_found = lagc.loads(PANELS).compile(parameters={"n": n}, backend="numpy").equilibria()
    assert len(all_found) == 2**n
    for linear in all_found:
        assert linear.equilibrium and linear.higher_order_rigid and linear.notes
        assert "undecided" in (linear.stability or "")
    hanging = [abs(z) for z in all_found[0].eigenvalues]
    for square in [1.0] if n == 1 else [2.0 - sqrt(2.0), 2.0 + sqrt(2.0)]:
        assert min(abs(z - sqrt(square * G)) for z in hanging) < 1e-6


@pytest.mark.full
def test_rows_that_are_redundant_everywhere_halt_nothing() -> None:
    linear = lagc.loads(PLATFORM).compile(backend="numpy").equilibria()[0]
    assert not linear.higher_order_rigid and linear.stability != "unstable"
    assert_spectrum(linear, [1j * sqrt(G), -1j * sqrt(G)])


@pytest.mark.full
@pytest.mark.parametrize(("up", "phi"), [("-", 0.1), ("", 2.9)])
def test_rounding_at_half_a_turn_acts_on_nothing(up: str, phi: float) -> None:
    """A bob on a skate: its angle may be measured from below or from above."""
    text = f"""model Skate
  coordinate Length x, y;
  coordinate Angle th, phi(start = {phi});
  parameter Mass m = 3 [kg], mp = 0.5 [kg];
  parameter Length l = 0.7 [m];
  frame F = rotate_z(world, th);
  body cart = Solid(mass = m, inertia = {{1, 1, 2}}, frame = F, com = {{x, y, 0}});
  body bob = Particle(mass = mp, at = {{x, y, 0}} + l*(sin(phi)*F.x {up or "+"} cos(phi)*F.z));
  constraint knife: dot(velocity(cart), F.y) = 0;
  Gravity field;
  dissipation fr = 0.15 [N.s/m]*dot(velocity(cart), F.x)^2;
end Skate;
"""
    linear = lagc.loads(text).compile(backend="numpy").equilibria()[0]
    assert linear.stability == "asymptotically stable"
    assert set(linear.idle) == {"x", "y", "th", "der(th)"}
