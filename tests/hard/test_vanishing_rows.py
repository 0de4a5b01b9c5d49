"""Rows whose gradient vanishes at a configuration, where the others determine the motion: a wheel that rolls
in or on a circular track, its rolling written as one vector, against the one-coordinate pendulum
theta'' = -g sin(theta) / (s (1 + k)), s the distance of the centres and k m r^2 the moment of inertia."""

import math
import random

import numpy
import pytest
from scipy.integrate import solve_ivp

import lagc
from lagc.api import Run
from lagc.mechanics.formulation.equations import EquationsOfMotion

ANGLES = """
model Track
  parameter Length R = 1 [m], r = 0.2 [m], s = %(s)s [m];
  parameter Real k = 0.5;
  coordinate Angle th(start = %(start)s [deg], rate = %(rate)s [rad/s], fixed = true), phi;
  point down = %(down)s;
  point side = %(side)s;
  point G = s/(1 [m])*(cos(th)*down + sin(th)*side);
  point contact = R/(1 [m])*(cos(th)*down + sin(th)*side);
  frame B = rotate(world, cross(down, side)/(1 [m2]), phi);
  body wheel = Solid(mass = 2 [kg], inertia = k*2 [kg]*r^2*{1, 1, 1}, frame = B, com = G);
  Gravity field(direction = down/(1 [m]));
  constraint roll: velocity(wheel, at = contact) = {0, 0, 0};
  output Length along = dot(G, side)/(1 [m]);
end Track;
"""
PLACES = ANGLES.replace(
    "coordinate Angle th(start = %(start)s [deg], rate = %(rate)s [rad/s], fixed = true), phi;",
    "coordinate Length a(start = %(a)s [m], rate = %(da)s [m/s], fixed = true), "
    "b(start = %(b)s [m], rate = %(db)s [m/s], fixed = true); coordinate Angle phi;",
).replace("s/(1 [m])*(cos(th)*down + sin(th)*side)", "(a*down + b*side)/(1 [m])").replace(
    "R/(1 [m])*(cos(th)*down + sin(th)*side)", "R/s*G"
).replace("constraint roll:", "constraint track: norm(G) = s;\n  constraint roll:")  # fmt: skip
PLANES = {
    "xz": ("{0, 0, -1}", "{1, 0, 0}"),
    "zx": ("{1, 0, 0}", "{0, 0, 1}"),
    "yx": ("{-1, 0, 0}", "{0, 1, 0}"),
    "yz": ("{0, 0, -1}", "{0, -1, 0}"),
    "tilted": ("{0.6, 0, -0.8}", "{0.64, 0.6, 0.48}"),
}
STARTS = [(0.0, 1.5), (90.0, 0.0), (-90.0, 0.0), (180.0, 2.0), (120.0, 0.0), (37.0, -1.0), (0.0, 7.0)]


def text(way: str, plane: str, start: float, rate: float, outside: bool = False) -> str:
    s = 1.2 if outside else 0.8
    angle = math.radians(start)
    down, side = PLANES[plane]
    places = {
        "a": s * math.cos(angle), "b": s * math.sin(angle),
        "da": -s * math.sin(angle) * rate, "db": s * math.cos(angle) * rate,
    }  # fmt: skip
    model = ANGLES if way == "angles" else PLACES
    return model % {"s": s, "start": start, "rate": rate, "down": down, "side": side, **places}


def pendulum(start: float, rate: float, s: float, times: numpy.ndarray) -> numpy.ndarray:
    def slope(t: float, y: numpy.ndarray) -> list[float]:
        return [y[1], -9.81 * math.sin(y[0]) / (s * 1.5)]

    begin = [math.radians(start), rate]
    return solve_ivp(slope, (0.0, times[-1]), begin, "DOP853", times, rtol=1e-12, atol=1e-13).y[0]


def rolled(model: str, backend: str = "numpy") -> Run:
    run = lagc.loads(model).compile(backend=backend).simulate(stop=1.5, accuracy=1e-6, points=16)
    assert run.status == "ok", run.message
    return run


@pytest.mark.sample(1, 12)
@pytest.mark.parametrize("way", ["angles", "places"])
@pytest.mark.parametrize(("plane", "start"), [
    *(("xz", start) for start in STARTS), *((plane, STARTS[k]) for plane in PLANES for k in (0, 1)),
    ("tilted", (90.0, 1.5)), ("tilted", (180.0, 2.0)), ("tilted", (-90.0, 1.5)),
])  # fmt: skip
def test_a_wheel_rolls_in_a_track(way: str, plane: str, start: tuple[float, float]) -> None:
    run = rolled(text(way, plane, *start))
    expected = 0.8 * numpy.sin(pendulum(*start, 0.8, run.t))
    assert run["along"] == pytest.approx(expected, abs=1e-5)


@pytest.mark.sample(1)
@pytest.mark.parametrize("start", [(180.0, 0.5), (90.0, 0.0), (0.0, 1.0)])
def test_a_wheel_rolls_on_a_track(start: tuple[float, float]) -> None:
    run = rolled(text("angles", "zx", *start, outside=True))
    assert run["along"] == pytest.approx(1.2 * numpy.sin(pendulum(*start, 1.2, run.t)), abs=1e-5)


@pytest.mark.full
@pytest.mark.parametrize(("way", "plane", "start"), [
    ("angles", "xz", STARTS[1]), ("angles", "zx", STARTS[0]), ("places", "zx", STARTS[1]),
])  # fmt: skip
def test_both_backends_take_the_same_steps(way: str, plane: str, start: tuple[float, float]) -> None:
    model = text(way, plane, *start)
    one, other = rolled(model), rolled(model, "c")
    assert one.states == other.states


def test_the_force_of_the_track_is_shared_along_the_tangent() -> None:
    """Friction is m k s theta'' along the track, whichever of its rows vanish."""
    model = text("angles", "xz", 90.0, 0.0).replace(
        "output", "output Force f[3] = reaction(roll);\n  output", 1
    )
    run = rolled(model)
    angle = pendulum(90.0, 0.0, 0.8, run.t)
    force = 2 * 0.5 * 0.8 * (-9.81 * numpy.sin(angle) / (0.8 * 1.5))
    tangent = numpy.array([numpy.cos(angle), 0 * angle, numpy.sin(angle)])
    for k in (1, 3):
        assert run[f"f[{k}]"] == pytest.approx(-force * tangent[k - 1], abs=2e-4)


# -- rows that only touch zero ---------------------------------------------------------------------

TWO = """
model Two
  parameter Real k = 3, l = %(l)s;
  coordinate Length x(start = %(size)s [m]), y(start = 0.4 [m]), z;
  parameter Length one = 1 [m];
  body a = Particle(mass = 1, at = {x, y, 0});
  body b = Particle(mass = 1, at = {z, one, 0.5*x});
  %(lines)s
end Two;
"""


def derived(length: float, size: float, lines: str) -> EquationsOfMotion:
    return lagc.loads(TWO % {"l": length, "size": size, "lines": lines}).compile().equations


APART = "position(a) - position(b)"
SAME = "`position(a) = position(b)`"
GENERIC = "a row of its own: `a = b`"
TOUCHING = {
    f"norm({APART}) = 0": SAME, f"0 = norm({APART})": SAME, f"norm({APART})^2 = 0": SAME,
    f"3*norm({APART})*norm({APART}) = 0": SAME, f"dot({APART}, {APART}) = 0": SAME,
    f"sqrt(dot({APART}, {APART})) = 0": SAME, "norm(velocity(a)) = 0": "`velocity(a) = {0, 0, 0}`",
    "norm({x - one, y, 0}) = 0": "`x = one` and `y = 0`, each as a row of its own",
    "norm({x, y, 0}) + norm({0, y, z}) = 0": "`x = 0`, `y = 0` and `z = 0`, each as a row of its own",
    "-norm({x, y, 0})/2 - norm({0, y, z}) = 0": GENERIC, "x^2 = 0": "`x = 0`", "0 = x^2": "`x = 0`",
    "x*x = 0": "`x = 0`", "x*y*x*y = 0": GENERIC, "(x - one)^2 = 0": "`x = one`",
    "der(x)^2 = 0": "`der(x) = 0`", "x^3 = 0": "`x = 0`",
    "(x - one)^2 + y^2 = 0": "`x = one` and `y = 0`, each as a row of its own",
    "-(x^2 + 2*y^4/one^2 + z^2) = 0": "`x = 0`, `y = 0` and `z = 0`, each as a row of its own",
    "k*(x - one)^2 = 0": "`x = one`", "x^2*(one^2 + y^2) = 0": "`x = 0`", "1 - cos(x/one) = 0": "`x/one = 0`",
    "cos(x/one) = 1": "`x/one = 0`", "k*x^2*(y - one)^4 = 0": GENERIC,
    "sqrt(x^2 + y^2 + z^2) = 0": "`x = 0`, `y = 0` and `z = 0`, each as a row of its own",
    "der(x)^2 + der(y)^2 = 0": "`der(x) = 0` and `der(y) = 0`, each as a row of its own",
}  # fmt: skip
CROSSING = [
    "x = 0", "norm(position(a)) = one", "norm(position(a)) = l*one", "x^2 + y^2 = l^2*one^2", "x^2 = l*one^2",
    "x*y = l*one^2", "x*y = 0", "sin(x/one) = 0", "atan2(y, x) = l", "(x - one)^2 = l*one^2",
    "(x - y)^3 = l*one^3", "norm(position(a) - position(b)) = l*one", "exp(x/one) = 1",
    "x^2 + y^2 - z^2 = 0", "der(x)^2 + der(y)^2 = 1 [m2/s2]", "der(x)*der(y) = 1 [m2/s2]",
    "position(a) = position(b)",
]  # fmt: skip


STEEP = ["cosh(2*y/one) = 1", "max(x, 0)^2 = 0"]
TOUCHING[STEEP[0]] = "`2*y/one = 0`"


@pytest.mark.sample(6, 12)
@pytest.mark.parametrize(("row", "size"), [
    *((row, size) for row in TOUCHING if row not in STEEP for size in (1e-6, 0.3, 1e6)),
    *((row, 0.3) for row in STEEP),
])  # fmt: skip
def test_rows_that_touch_zero_are_refused_with_what_they_say(row: str, size: float) -> None:
    with pytest.raises(lagc.Refused) as refused:
        derived(0.3, size, f"constraint c: {row};")
    (fault,) = refused.value.faults
    assert fault.code == "LAG0413"
    assert fault.remedy is not None and TOUCHING.get(row, GENERIC) in fault.remedy


@pytest.mark.sample(5, 12)
@pytest.mark.parametrize("size", [1e-6, 0.3, 1e6])
@pytest.mark.parametrize("row", CROSSING)
@pytest.mark.parametrize("length", [1e-9, 0.3, 1e9])
def test_rows_that_cross_zero_are_accepted(row: str, length: float, size: float) -> None:
    try:
        derived(length, size, f"constraint c: {row};")
    except lagc.Refused as refused:
        assert "LAG0413" not in [fault.code for fault in refused.faults]


MIXED = """
model Mixed
  coordinate Length x(start = %(size)s [m]), y(start = 0.4*%(size)s [m]), z;
  coordinate Angle u(start = 0.4), v(start = 0.3);
  parameter Length one = %(size)s [m];
  body a = Particle(mass = 1, at = {x + one*sin(v), y + one*cos(v)*sin(u), z});
  body b = Particle(mass = 1, at = {z, one*sin(u), one*cos(v)});
  constraint c: %(row)s;
end Mixed;
"""
TOUCHES = ["1 - cos(u) = 0", "cosh(u) = 1", "(u - v)^3*exp(v) = 0", "cosh(x/one) = 1", "1 - cos(x/one) = 0"]
CROSSES = ["sin(u) = 0", "exp(u) = 1.2", "x^3 = one^3", "x*y = one^2", "u^2 - v^2 = 0.01",
           "u^2 + x^2/one^2 = 1"]  # fmt: skip


@pytest.mark.sample(1)
@pytest.mark.parametrize("size", [1e-15, 1e-12, 1e-4, 1e4, 1e12, 1e15])
def test_angles_beside_lengths_of_any_size(size: float) -> None:
    for row in (*TOUCHES, *CROSSES):
        try:
            assert lagc.loads(MIXED % {"size": size, "row": row}).compile().equations.rows
            touches = False
        except lagc.Refused as refused:
            touches = [fault.code for fault in refused.faults] == ["LAG0413"]
            assert touches, row
        assert touches == (row in TOUCHES), row


def forms(seed: int) -> dict[str, str]:
    """Two random independent forms in x, y and z: u is small at the start, v is not."""
    chance = random.Random(seed)
    rows = [[round(chance.uniform(-2, 2), 3) for _ in range(3)] for _ in range(2)]
    levels = [0.3 * a + 0.4 * b - at for (a, b, _), at in zip(rows, (0.02, chance.uniform(0.5, 1)))]
    u, v = (f"({a}*x + {b}*y + {c}*z - {d:.6f}*one)" for (a, b, c), d in zip(rows, levels))
    return {"u": u, "v": v}


WHERE = ("wherever", "is zero, which is one way")
WHEREVER, FACTOR = WHERE
MADE = {
    "u^2*v": FACTOR, "u*v^3": FACTOR, "u^2*v*u": FACTOR, "u^2*sin(v/one)": FACTOR,
    "u*norm({v, u - v, 0})": FACTOR,
    "u^2*v^2": WHEREVER, "u^2 + v^2": WHEREVER, "(u + v)^2": WHEREVER,
    "u^2*exp(v/one)": WHEREVER, "norm({u, v, 0}) + norm({0, v, u})": WHEREVER,
    "u*v": "nowhere", "u^2 - v^2": "nowhere", "u^2*one - v^3": "nowhere", "u^2 - v*one": "nowhere",
    "u*v*(u + v)": "nowhere", "u*(one^2 + v^2)": "nowhere", "norm({u, v, 0}) - one": "nowhere",
    "u*norm({u, v, one})": "nowhere", "norm({u, v, 0}) - norm({v, one, 0})": "nowhere",
}  # fmt: skip


@pytest.mark.sample(1)
@pytest.mark.parametrize("made", MADE)
def test_where_gradients_vanish_over_random_forms(made: str) -> None:
    for seed in range(4):
        found = forms(7 * seed + len(made))
        line = f"constraint c: {''.join(found.get(c, c) for c in made)} = 0;"
        try:
            faults = derived(0.3, 0.3, line).warnings
        except lagc.Refused as refused:
            faults = tuple(refused.faults)
        assert {fault.code for fault in faults} <= {"LAG0413"}
        where = next((words for words in WHERE for fault in faults if words in fault.message), "nowhere")
        assert where == MADE[made], line


@pytest.mark.parametrize("row", ["x^2 = r*one", "x^2 + y^2 = r^2", "x^3 = r*one^2", "(x - y)^2 = r*(x + y)"])
def test_values_of_parameters_refuse_no_row(row: str) -> None:
    """With r = 0 it only touches; what is compiled holds for any r."""
    lines = f"parameter Length r = 0; constraint c: {row};"
    assert derived(0.3, 0.3, lines).rows


MANY = """
model Many
  structural Integer n = 90;
  coordinate Length x[n](each start = 1 [m]), y[n](each start = 0.5 [m]);
  for i in 1:n loop
    body b[i] = Particle(mass = 1 [kg], at = {x[i], y[i], 0});
  end for;
  for i in 1:n-1 loop
    constraint c[i]: x[i]^2 + y[i]^2 = 1 [m2];
  end for;
  constraint last: %(row)s;
end Many;
"""


@pytest.mark.full
@pytest.mark.parametrize(
    ("row", "touches"), [("1 - cos(x[n]/(1 [m])) = 0", True), ("1 - cos(x[n]/(1 [m])) = 0.5", False)]
)
def test_however_many_rows_there_are_each_is_asked(row: str, touches: bool) -> None:
    try:
        assert len(lagc.loads(MANY % {"row": row}).compile().equations.rows) == 90
        refused = False
    except lagc.Refused as found:
        refused = [fault.code for fault in found.faults] == ["LAG0413"]
    assert refused == touches
