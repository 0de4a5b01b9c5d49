"""Systems at rest, and motions of any size and pace against closed forms."""

import random
from math import cos, floor, log2, pi, sin, sqrt
from typing import Any

import pytest

import lagc
from lagc.api import Run

GRAVITY = "effect gravity\n Gravity field;\n end gravity;\n scene lab uses gravity;\n"
RING = "constraint ring: norm(position(bob)) = l;"


def pendulum(start: str) -> str:
    return f"""model Pendulum
  parameter Mass m = 1 [kg];
  parameter Length l = 0.5 [m];
  coordinate Angle theta(start = {start});
  body bob = Particle(mass = m, at = l*{{sin(theta), 0, -cos(theta)}});
  {GRAVITY}end Pendulum;
"""


def on_a_ring(z: str, more: str = "") -> str:
    return f"""model Ring
  parameter Mass m = 1 [kg];
  parameter Length l = 0.7 [m];
  coordinate Length x, y, z(start = {z});
  body bob = Particle(mass = m, at = {{x, y, z}});
  {RING}
  {more}
  {GRAVITY}end Ring;
"""


RESTING = {
    "hanging": pendulum("0"),
    "upside down": pendulum("180 [deg]"),
    "on a string": on_a_ring("-0.7 [m]"),
    "on top of a sphere": on_a_ring("0.7 [m]"),
    "stated twice": on_a_ring("-0.7 [m]", "constraint again: 2*norm(position(bob)) = 2*l;"),
    "nothing acts": "model Free\n coordinate Length x, y(start = 1e-10 [m]);\n"
    " body b = Particle(mass = 1e-27 [kg], at = {x, y, 0});\nend Free;\n",
    "all is zero": "model Zero\n coordinate Angle a;\n"
    " body b = Particle(mass = 1 [kg], at = {a*1 [m], 0, 0});\n"
    " potential v = 1/2*3 [J]*a^2;\nend Zero;\n",
    "balanced scales": f"""model Scales
  parameter Mass m = 0.1 [kg], M = 0.2 [kg], n = 0.3 [kg];
  parameter Length l = 0.4 [m], h = 0.05 [m];
  coordinate Angle a;
  body left = Particle(mass = m + M, at = {{l*cos(a), 0, l*sin(a)}} + h*{{sin(a), 0, -cos(a)}});
  body right = Particle(mass = n, at = {{-l*cos(a), 0, -l*sin(a)}} + h*{{sin(a), 0, -cos(a)}});
  {GRAVITY}end Scales;
""",
    "a bead where the hoop turns too fast": f"""model Bead
  parameter Mass m = 0.2 [kg];
  parameter Length R = 0.3 [m];
  parameter AngularVelocity w = 9 [rad/s];
  coordinate Angle th;
  frame H = rotate_z(world, w*time);
  body b = Particle(mass = m, at = R*(sin(th)*H.x - cos(th)*H.z));
  {GRAVITY}end Bead;
""",
    "on an offset wire": f"""model Wire
  parameter Length c = 0.37 [m];
  coordinate Length x(start = 0.37 [m]), z(start = 0.1 [m]);
  body b = Particle(mass = 0.2 [kg], at = {{x, 0, z}});
  constraint wire: z = 0.1 [m] - 1.7 [1/m]*(x - c)^2;
  {GRAVITY}end Wire;
""",
    "rows that depend on each other": """model Rod
  coordinate Length x, y, u(start = 1 [m]), w;
  body a = Particle(mass = 1 [kg], at = {x, y, 0});
  body b = Particle(mass = 1 [kg], at = {u, w, 0});
  potential s = 1/2*3.3 [N/m]*(norm(position(a) - position(b)) - 1.1 [m])^2;
  constraint c1: x = 0;
  constraint c2: y = 0;
  constraint c3: u = 1 [m];
  constraint c4: w + y = 0;
  constraint c5: x + y = 0;
end Rod;
""",
}


@pytest.mark.sample(3)
@pytest.mark.parametrize("name", sorted(RESTING))
def test_what_rounding_alone_would_move_rests(name: str) -> None:
    run = lagc.loads(RESTING[name]).compile(backend="numpy").simulate(100.0)
    assert run.status == "ok", run.message
    assert any("equilibrium" in note or "leave no motion" in note for note in run.notes)
    assert all(list(x) == list(run.states[0]) for x in run.states)


@pytest.mark.sample(6)
@pytest.mark.parametrize("name", sorted(RESTING))
@pytest.mark.parametrize("method", ["dop853", "dopri5"])
def test_rounding_does_not_starve_the_steps(name: str, method: str) -> None:
    """By hand: the run takes what happens, in few steps."""
    run = lagc.loads(RESTING[name]).compile(backend="numpy").simulate(2.0, method=method, rtol=1e-10)
    assert run.status == "ok", run.message
    assert run.cost.steps + run.cost.rejected < 300


def hanging(k: float, m: float, g: float) -> str:
    """A mass on a spring, from where it hangs at rest but for the rounding of these numbers."""
    return f"""model Hanging
  parameter Mass m = {m!r} [kg];
  parameter Stiffness k = {k!r} [N/m];
  coordinate Length x;
  body b = Particle(mass = m, at = {{0, 0, x}});
  potential s = 1/2*k*(x + m*{g!r} [m/s2]/k)^2;
  effect gravity
    Gravity field(g = {g!r} [m/s2], direction = {{0, 0, 1}});
  end gravity;
  scene lab uses gravity;
end Hanging;
"""


def test_springs_that_carry_their_loads() -> None:
    rng = random.Random(5)
    for _ in range(6):
        k, m, g = (10.0 ** rng.uniform(-12.0, 12.0) for _ in range(3))
        period = 2.0 * pi * sqrt(m / k)
        run = lagc.loads(hanging(k, m, g)).compile(backend="numpy").simulate(5.0 * period, accuracy=1e-8)
        assert run.status == "ok", (k, m, g, run.message)
        assert max(abs(x[0]) for x in run.states) <= 1e-12 * m * g / k


OSCILLATOR = """model Oscillator
  parameter Mass m = 1 [kg];
  parameter Stiffness k = 1 [N/m];
  coordinate Length x;
  body b = Particle(mass = m, at = {x, 0, 0});
  potential s = 1/2*k*x^2;
end Oscillator;
"""


def of(run: Run, name: str) -> Any:
    return run[name].tolist()


@pytest.mark.sample(1)
@pytest.mark.parametrize("seed", range(6))
def test_oscillators_of_any_size(seed: int) -> None:
    rng = random.Random(seed)
    m, k, a = (10.0 ** rng.uniform(-27.0, 20.0) for _ in range(3))
    w = sqrt(k / m)
    system = lagc.loads(OSCILLATOR).compile(backend="numpy")
    run = system.simulate(9.0 / w, accuracy=1e-9, parameters={"m": m, "k": k}, starts={"x": a})
    true = max(
        max(abs(x - a * cos(w * t)) / a, abs(v + a * w * sin(w * t)) / (a * w)) / 2.0  # of the range
        for t, x, v in zip(run.t, of(run, "x"), of(run, "der(x)"))
    )
    assert run.status == "ok", run.message
    assert true <= run.estimated <= 1e-9


def test_an_oscillator_whose_mass_has_few_digits_moves() -> None:
    """Below the smallest normal number, 2.2e-308, a last place is no share of a number."""
    system = lagc.loads(OSCILLATOR).compile(backend="numpy")
    run = system.simulate(3.0, accuracy=1e-9, parameters={"m": 1e-310, "k": 1e-310}, starts={"x": 1.0})
    assert run.status == "ok" and abs(run.final["x"] - cos(3.0)) <= 1e-9


@pytest.mark.parametrize("angle", [1e-3, 1e-12, 1e-15, 1e-20])
def test_pendulums_that_hardly_swing(angle: float) -> None:
    run = lagc.loads(pendulum(f"{angle!r} [rad]")).compile(backend="numpy").simulate(3.0, accuracy=1e-8)
    w = sqrt(9.81 / 0.5)
    slower = angle * angle / 16.0  # of the period, to second order
    true = max(abs(x / angle - cos(w * t / (1.0 + slower))) for t, x in zip(run.t, of(run, "theta")))
    assert run.status == "ok" and run.estimated <= 1e-8
    assert true <= 1e-8 + angle * angle


def test_near_the_top_it_falls() -> None:
    # the last place of the angle moves the speed at the end by 1e-7 to 1e-6
    run = lagc.loads(pendulum("3.14159265 [rad]")).compile(backend="numpy").simulate(3.0, accuracy=1e-5)
    w, off = sqrt(9.81 / 0.5), pi - 3.14159265
    assert run.status == "ok", run.message
    assert pi - of(run, "theta")[-1] == pytest.approx(off * (2.718281828459045 ** (3.0 * w)) / 2.0, rel=1e-3)


KEPLER = """model Kepler
  parameter Mass m = 1 [kg];
  parameter Real[kg.m3/s2] C = 1;
  coordinate Length x, y;
  body b = Particle(mass = m, at = {x, y, 0});
  potential coulomb = -C/norm(position(b));
end Kepler;
"""


@pytest.mark.parametrize(
    "m, C, a",
    [
        (9.1093837e-31, 2.30707755e-28, 5.29177e-11),  # an electron about a proton
        (5.972e24, 5.972e24 * 1.32712440018e20, 1.495978707e11),  # the Earth, in kg, m, s
        (2e30, 2e30 * 1.3e31, 2.5e20),  # a star about a galaxy
    ],
)
def test_orbits_of_any_size(m: float, C: float, a: float) -> None:
    e = 0.3
    n = sqrt(C / m / a**3)  # mean motion
    speed = a * n * sqrt((1.0 + e) / (1.0 - e))
    starts = {"x": a * (1.0 - e), "der(y)": speed}
    system = lagc.loads(KEPLER).compile(backend="numpy")
    run = system.simulate(10.0 / n, accuracy=1e-9, parameters={"m": m, "C": C}, starts=starts, points=41)
    true = 0.0
    for t, x, y in zip(run.t, of(run, "x"), of(run, "y")):
        anomaly = n * t
        for _ in range(60):
            anomaly -= (anomaly - e * sin(anomaly) - n * t) / (1.0 - e * cos(anomaly))
        exact = a * (cos(anomaly) - e), a * sqrt(1.0 - e * e) * sin(anomaly)
        true = max(true, abs(x - exact[0]) / a, abs(y - exact[1]) / a)
    assert run.status == "ok", run.message
    assert true <= 1.3 * run.estimated <= 1.3e-9  # the size that errors are relative to is 1.3 a


LATE = [  # force (N) on 1 kg at rest, the time that is looked at, where it is then
    ("if time > 5 [s] then 1 [N] else 0 [N]", 10.0, 12.5),
    ("if time > 5 [s] and time < 6 [s] then 1 [N] else 0 [N]", 20.0, 14.5),
    ("(3 [N])*max(0, time/(1 [s]) - 5)", 10.0, 62.5),
    ("(3 [N])*max(0, time/(1 [s]) - 5)^2", 10.0, 156.25),
    ("(1 [N])*max(0, time/(1 [s]) - 50)", 100.0, 50.0**3 / 6.0),
    ("(1 [N])*sign(sin(pi*time/(5 [s])))", 20.0, 50.0),
]


@pytest.mark.sample(2)
@pytest.mark.parametrize("backend", ["numpy", "c"])
@pytest.mark.parametrize(("force", "stop", "end"), LATE)
def test_what_rests_is_set_in_motion_later(force: str, stop: float, end: float, backend: str) -> None:
    text = f"""model Late
  coordinate Length x;
  body b = Particle(mass = 1 [kg], at = {{x, 0, 0}});
  force push = ({force})*world.x at b;
end Late;"""
    run = lagc.loads(text).compile(backend=backend).simulate(stop)
    assert run.status == "ok", run.message
    assert run["x"][-1] == pytest.approx(end, rel=1e-6)


@pytest.mark.parametrize("balanced", ["(1e15 [N])*world.x at a", "-(1e15 [N/m])*velocity(a)*(1 [s]) at a"])
def test_no_rest_beside_what_rests(balanced: str) -> None:
    """The rounding of great forces in balance on one body moves no other."""
    text = f"""model Beside
  coordinate Length x(start = 1 [m]), y(start = 1 [m]);
  body a = Particle(mass = 1 [kg], at = {{x, 0, 0}});
  body b = Particle(mass = 1 [kg], at = {{0, y, 0}});
  force one = {balanced};
  force other = -({balanced.partition(" at")[0]}) at a;
  force push = (0.1 [N])*world.y at b;
end Beside;"""
    run = lagc.loads(text).compile(backend="numpy").simulate(10.0)
    assert run["y"][-1] == pytest.approx(6.0)


@pytest.mark.full
@pytest.mark.parametrize("seed", range(8))
def test_no_rest_beside_what_is_pressed(seed: int) -> None:
    """A force that a wire bears is rounded by more than a gentle one that nothing bears, of the same body or
    of another: that moves what it acts on all the same."""
    rng = random.Random(seed)
    force, slope, push = 10.0 ** rng.uniform(14.0, 16.0), rng.uniform(0.1, 2.0), rng.uniform(0.01, 0.1)
    where = "{x, y, z}" if seed % 2 else "{x, 0, z}"
    text = f"""model Pressed
  parameter Force F = {force!r} [N], f = {push!r} [N];
  parameter Real s = {slope!r};
  coordinate Length x(start = 1 [m]), y(start = 1 [m]), z(start = {slope!r} [m]);
  body a = Particle(mass = 1 [kg], at = {where});
  body b = Particle(mass = 1 [kg], at = {{0, {"0" if seed % 2 else "y"}, 0}});
  constraint wire: z = s*x;
  potential V = -F*(s*x - z) - f*y;
end Pressed;"""
    run = lagc.loads(text).compile(backend="numpy").simulate(10.0)
    assert run["y"][-1] == pytest.approx(1.0 + 0.5 * push * run.t[-1] ** 2, rel=1e-9)
    if run.status == "ok":  # along the wire no force acts but what rounding leaves of the other
        assert run["x"][-1] == pytest.approx(1.0, rel=1e-6)


@pytest.mark.sample(6)
@pytest.mark.parametrize("places", [-8, -4, -2, -1, 1, 2, 3, 4, 8])
@pytest.mark.parametrize("offset", [1e15, 3.7])
def test_a_few_last_places_beside_an_equilibrium(places: int, offset: float) -> None:
    """It swings by them about the equilibrium, and is said to rest where that is within the estimate."""
    start = offset + places * 2.0**-52 * 2.0 ** floor(log2(offset))
    text = f"""model Beside
  coordinate Length x(start = {start!r} [m]);
  body b = Particle(mass = 1 [kg], at = {{x, 0, 0}});
  potential s = 1/2*4 [N/m]*(x - {offset!r} [m])^2;
end Beside;"""
    run = lagc.loads(text).compile(backend="numpy").simulate(3.0)
    true = max(
        abs((x - offset) - (start - offset) * cos(2.0 * t)) / offset for t, x in zip(run.t, of(run, "x"))
    )
    assert run.status == "failed" or true <= run.estimated
