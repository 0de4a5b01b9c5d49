"""What `explain` tells: counts, cyclic coordinates, conserved quantities, integrable rows. Reactions that the
equations leave open: the null space of G^T decides, at any scale of an equation."""

import random

import pytest

import lagc
from lagc.lowering.lower_equations import optimize
from lagc.mechanics.analysis.analysis import Analysis, analyse
from lagc.mechanics.derive import derive
from lagc.mechanics.identities.linear_algebra import Span
from lagc.reports.explain import explanation
from lagc.symbolic.graph import Node
from lagc.symbolic.walk import evaluate
from tests.mechanics.builder import Builder
from tests.mechanics.models import (
    ALL,
    constant_speed,
    knife_edge,
    rheonomic_disc,
    rolling_ball,
    string_pendulum,
)
from tests.mechanics.numbers import random_state
from tests.reports.models import equations_of


def of(name: str) -> Analysis:
    return analyse(derive(ALL[name]()))


def conserved(a: Analysis) -> list[str]:
    return [c.name for c in a.conserved]


@pytest.mark.parametrize(
    "name, unknowns, freedom, positions",
    [
        ("pendulum", 1, 1, 1),
        ("string pendulum", 3, 1, 1),
        ("rolling ball", 9, 3, 5),
        ("knife edge", 4, 2, 3),
        ("constant speed", 4, 2, 3),
    ],
)
def test_counts(name: str, unknowns: int, freedom: int, positions: int) -> None:
    a = of(name)
    assert (a.unknowns, a.degrees_of_freedom, a.positional_freedom) == (unknowns, freedom, positions)


def test_a_row_stated_twice_takes_one_freedom() -> None:
    b = Builder()
    x, y = b.coordinate("x"), b.coordinate("y")
    b.particle("p", b.parameter("m"), (x, y, 0.0))
    b.constraint("a", x * x + y * y - 1.0)
    b.constraint("b", 2.0 * x * x + 2.0 * y * y - 2.0)
    a = analyse(derive(b.model()))
    assert (a.rows, a.degrees_of_freedom, a.redundant) == (2, 1, ("b",))
    assert "energy" in conserved(a)


@pytest.mark.parametrize("turning, name", [(0.0, "energy"), (2.0, "K2 - K0 + V")])
def test_of_what_is_driven_jacobis_integral_is_kept_and_not_the_energy(turning: float, name: str) -> None:
    """A bead on a hoop: it turns, or stands."""
    b = Builder()
    q = b.coordinate("q")
    away, turn = b.graph.sin(q), turning * b.time
    b.particle("p", b.parameter("m"), (away * b.graph.cos(turn), away * b.graph.sin(turn), -b.graph.cos(q)))
    assert conserved(analyse(derive(b.model())))[0] == name


def test_string_pendulum() -> None:
    a = analyse(derive(string_pendulum()))
    assert a.cyclic == ("x",)
    assert conserved(a) == ["energy"]  # the string pulls along x
    assert [(c.label, c.holonomic, c.time_dependent, c.affine) for c in a.constraints] == [
        ("string", True, False, True)
    ]


def test_cyclic_angle_that_symbols_do_not_show() -> None:
    """The sum of two angles is cyclic without gravity when written relative; here the first angle."""
    b = Builder()
    g = b.graph
    first, second = b.coordinate("first"), b.coordinate("second")
    elbow = (g.cos(first), g.sin(first), 0.0)
    hand = (elbow[0] + g.cos(first + second), elbow[1] + g.sin(first + second), 0.0)
    b.particle("a", g.one, elbow)
    b.particle("b", g.one, hand)
    a = analyse(derive(b.model()))
    assert a.cyclic == ("first",)
    assert conserved(a)[:2] == ["energy", "momentum(first)"]


def test_a_force_along_a_cyclic_coordinate_breaks_its_momentum() -> None:
    b = Builder()
    x, y = b.coordinate("x"), b.coordinate("y")
    b.particle("p", b.parameter("m"), (x, y, 0.0))
    b.dissipation("drag", b.der(x) ** 2)
    a = analyse(derive(b.model()))
    assert a.cyclic == ("x", "y")
    assert conserved(a) == ["momentum(y)", "momentum().y"]


def test_kinetic_energy_by_degree() -> None:
    b = Builder()
    r = b.coordinate("r")
    w, g = b.parameter("w", 2.0), b.graph
    lift = 0.3 * b.time
    b.particle("bead", b.parameter("m"), (r * g.cos(w * b.time), r * g.sin(w * b.time), r + lift))
    e = derive(b.model())
    parts = analyse(e).kinetic_parts
    assert parts is not None
    state = random_state(e, 1)
    speed, reach = state[e.v[0]], state[e.q[0]]
    assert evaluate(parts, state) == pytest.approx(
        [speed**2, 0.3 * speed, 0.5 * (4.0 * reach**2 + 0.09)], rel=1e-12
    )


def test_no_split_of_a_kinetic_energy_that_is_not_quadratic() -> None:
    b = Builder()
    x = b.coordinate("x")
    b.lagrangian("relativistic", -b.graph.sqrt(1.0 - b.der(x) ** 2))
    a = analyse(derive(b.model()))
    assert a.kinetic_parts is None
    assert conserved(a) == ["energy", "momentum(x)"]


def test_drives_and_friction_leave_nothing_conserved() -> None:
    assert conserved(analyse(derive(rheonomic_disc()))) == []


# -- which velocity rows are integrable ---------------------------------------------


def answers(b: Builder) -> dict[str, bool | None]:
    return {c.label: c.integrable for c in analyse(derive(b.model())).constraints}


def plane() -> tuple[Builder, list[Node]]:
    b = Builder()
    q = [b.coordinate(k) for k in ("x", "y", "phi")]
    frame = b.rotate("F", b.world, "z", q[2])
    b.solid("s", b.parameter("m"), (0.1, 0.1, 0.2), frame, (q[0], q[1], 0.0))
    return b, q


def test_knife_edge_is_not_integrable() -> None:
    (row,) = analyse(derive(knife_edge())).constraints
    assert (row.integrable, row.affine, row.holonomic) == (False, True, False)


def test_drives_belong_to_the_form() -> None:
    b, (x, y, phi) = plane()
    g = b.graph
    b.constraint("integrable", b.der(x) - g.cos(b.time))
    b.constraint("not", b.der(y) - b.time * b.der(phi))
    assert answers(b) == {"integrable": True, "not": False}


@pytest.mark.parametrize("scaled", [False, True])
def test_axle_with_two_wheels_turns_by_their_difference(scaled: bool) -> None:
    """2 L yaw = R (phi1 - phi2): a combination of the rows, with changing coefficients or not."""
    b = Builder()
    x, y, yaw, phi1, phi2 = (b.coordinate(k) for k in ("x", "y", "yaw", "phi1", "phi2"))
    g = b.graph
    frame = b.rotate("F", b.world, "z", yaw)
    b.solid("axle", b.parameter("m"), (0.1, 0.1, 0.2), frame, (x, y, 0.0))
    b.lagrangian("wheels", 0.5 * (b.der(phi1) ** 2 + b.der(phi2) ** 2), is_kinetic=True)
    forward = b.der(x) * g.cos(yaw) + b.der(y) * g.sin(yaw)
    turn, radius = b.parameter("L", 0.7) * b.der(yaw), b.parameter("R", 0.3)
    factor = 2.0 + g.sin(x + phi1) if scaled else g.one
    b.constraint("right", factor * (forward + turn - radius * b.der(phi1)))
    b.constraint("left", forward - turn - radius * b.der(phi2))
    b.constraint("side", b.der(y) * g.cos(yaw) - b.der(x) * g.sin(yaw))
    a = analyse(derive(b.model()))
    assert {c.label: c.integrable for c in a.constraints} == {"right": False, "left": False, "side": False}
    assert (a.degrees_of_freedom, a.positional_freedom, a.seems.positional_freedom) == (2, 4, False)


def test_spin_about_one_axis_of_a_quaternion() -> None:
    """Without the two other body rates a solid turns about one axis: positions are restricted."""
    b = Builder()
    frame, o = b.orientation("o")
    b.solid("s", b.parameter("m"), (0.1, 0.2, 0.3), frame)
    b.constraint("x", o.rate_symbols[0])
    assert answers(b) == {"x": False}
    b.constraint("y", o.rate_symbols[1])
    assert answers(b) == {"x": True, "y": True}


def test_rolling_ball_and_constant_speed() -> None:
    assert [c.integrable for c in analyse(derive(rolling_ball())).constraints] == [None, False, False]
    (row,) = analyse(derive(constant_speed())).constraints
    assert (row.integrable, row.affine) == (None, False)


BEAM = """\
model Beam "A beam on three supports, held along x by one"
  parameter Length l = 2 [m];
  coordinate Length x, z;
  coordinate Angle th;
  frame F = rotate_y(world, th);
  body beam = Solid(mass = 3 [kg], inertia = {{1, 1, 1}}, frame = F, com = {{x, 0, z}});
  constraint left: {a!r}*dot(position(beam) - l*F.x, world.z) = 0;
  constraint middle: {b!r}*z = 0;
  constraint right: {c!r}*dot(position(beam) + l*F.x, world.z) = 0;
  constraint along: x = 0;
  effect gravity
    Gravity field;
  end gravity;
  scene s uses gravity
    simulate(stop = 1 [s]);
  end s;
end Beam;
"""
SPINNING = """\
model Door "A door on two hinges, each of three equations, that share the force along the axis"
  parameter Length L = 1 [m];
  coordinate Length x, y, z(start = 0.1 [m]);
  coordinate Orientation o(rate = {{0, 0, 2}} [rad/s]);
  frame F = rotate(world, o);
  body door = Solid(mass = 3 [kg], inertia = {{1, 1, 1}}, frame = F, com = {{x, y, z}} + 0.5*L*F.x);
  constraint low: {a!r}*({{x, y, z}} - 0.4*L*F.z) = {a!r}*L*{{0, 0, -0.3}};
  constraint high: {{x, y, z}} + 0.4*L*F.z = L*{{0, 0, 0.5}};
  scene s simulate(stop = 1 [s]); end s;
end Door;
"""


@pytest.mark.parametrize("scales", [(1.0, 1.0, 1.0), (1.0, 1e4, 1.0), (1e-3, 1.0, 50.0)])
def test_all_supports_of_a_beam_are_named(scales: tuple[float, float, float]) -> None:
    a, b, c = scales
    system = lagc.loads(BEAM.format(a=a, b=b, c=c)).compile(backend="numpy")
    run = system.simulate()
    assert run.open_reactions == ("left", "middle", "right")
    assert run.to_dict()["open_reactions"] == ["left", "middle", "right"]
    (note,) = [note for note in run.notes if "reactions open" in note]
    assert all(f"`{name}`" in note for name in ("left", "middle", "right")) and "`along`" not in note
    equations = equations_of(BEAM.format(a=a, b=b, c=c))
    facts = explanation(equations, optimize(equations))
    assert facts["open_reactions"] == ["left", "middle", "right"] and len(facts["redundant"]) == 1


def test_hinges_share_the_force_along_their_axis_alone() -> None:
    run = lagc.loads(SPINNING.format(a=1e3)).compile(backend="numpy").simulate()
    assert run.open_reactions == ("low[3]", "high[3]")


def test_a_motion_with_unique_reactions_names_none() -> None:
    run = lagc.load("models/classic/four_bar.lag").compile(backend="numpy").simulate(0.1)
    assert run.open_reactions == ()


@pytest.mark.parametrize("seed", range(40))
def test_rows_of_random_null_spaces(seed: int) -> None:
    """Against the singular vectors of numpy; rows differ in size by up to 1e6."""
    np = pytest.importorskip("numpy")
    dice = random.Random(seed)
    n, columns = dice.randint(2, 9), 12
    rows = [[dice.gauss(0, 1) * (dice.random() < 0.5) for _ in range(columns)] for _ in range(n)]
    for _ in range(dice.randint(0, 3)):
        of = dice.sample(range(len(rows)), dice.randint(1, 2))
        rows.append([sum(dice.choice((1, 2, -3)) * rows[k][j] for k in of) for j in range(columns)])
    factors = [10.0 ** dice.uniform(-3, 3) for _ in rows]
    rows = [[f * x for x in row] for f, row in zip(factors, rows)]
    unit = np.array([np.array(r) / (np.linalg.norm(r) or 1.0) for r in rows])
    left, sizes, _ = np.linalg.svd(unit)
    null = left[:, sum(sizes > 1e-10) :]
    expected = {k for k in range(len(rows)) if np.linalg.norm(null[k]) > 1e-8}
    assert Span(rows).entangled() == expected
