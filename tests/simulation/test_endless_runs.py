"""Runs that would take very long: where no motion is possible the answer is rest, hopeless ones end soon
and say why, and long ones that are not go on."""

import math
import random

import pytest
from scipy.integrate import solve_ivp

import lagc
from lagc.simulation.request import Request
from lagc.simulation.simulate import simulate
from lagc.simulation.solution import Solution
from lagc.simulation.supervision import LONG, is_stuck
from lagc.simulation.system import Options, Trajectory
from tests.simulation.systems import Oscillator

pytestmark = pytest.mark.usefixtures("no_cache")

DOOR = """model Door "on three hinges, the third out of line by e"
  parameter Mass m = 20 [kg];
  parameter Length h = {h!r} [m];
  parameter Real e = {e!r};
  coordinate Length x, y, z;
  coordinate Orientation o(rate = {{0, 0, 1}} [rad/s]);
  frame B = rotate(world, o);
  body door = Solid(mass = m, inertia = {{5, 6, 1.2}}, frame = B, com = {{x, y, z}} + 0.4*h*B.x);
  constraint low: {{x, y, z}} - 0.4*h*B.z = {{0, 0, -0.4*h}};
  constraint middle: {{x, y, z}} = {{0, 0, 0}};
  constraint high: {{x, y, z}} + {k!r}*h*B.z + e*h*B.x = {{e*h, 0, {k!r}*h}};
  Gravity field(direction = {{{down}}});
  {more}
end Door;
"""
PENDULUM = """coordinate Angle th(start = 1);
  body bob = Particle(mass = m, at = {sin(th)*h, 0, -cos(th)*h});"""
PLATE = """model Plate "on three parallel rods, of which the third is longer"
  parameter Length l = 1 [m], d = {d!r} [m];
  coordinate Length x(start = 0.6), y(start = -0.8);
  coordinate Angle a;
  frame B = rotate_z(world, a);
  body b = Solid(mass = 1 [kg], inertia = {{1, 1, 0.5}}, frame = B, com = {{x, y, 0}});
  constraint one: norm({{x, y, 0}} - l/2*B.x + {{l/2, 0, 0}}) = l;
  constraint two: norm({{x, y, 0}} + l/2*B.x - {{l/2, 0, 0}}) = l;
  constraint three: norm({{x, y, 0}} + l/10*B.x - {{l/10 - d, 0, 0}}) = l;
  potential V = (9.81 [N])*y;
end Plate;
"""
POINT = """model Point
  parameter Length l = 1 [m];
  coordinate Length x(start = {x!r}), y(start = {y!r}), z;
  body b = Particle(mass = 1 [kg], at = {{x, y, z}});
  constraint flat: z = 0;
  {rows}
end Point;
"""


def run(text: str, stop: float = 1.0, backend: str = "numpy") -> Solution:
    found = lagc.loads(text).compile(backend=backend).simulate(stop, points=41)
    assert found.cost.rhs < 3e6
    return found


@pytest.mark.sample(1)
@pytest.mark.parametrize("seed", range(8))
def test_three_points_out_of_line_do_not_move(seed: int) -> None:
    chance = random.Random(seed)
    down = ", ".join(f"{chance.uniform(-1, 1):.3f}" for _ in "xyz")
    e, h, k = 10.0 ** chance.uniform(-4.3, -1.0), chance.uniform(0.5, 4.0), chance.uniform(0.2, 0.8)
    push = "force push = 3 [N]*sin(time*(2 [1/s]))*world.y at door;" if seed % 2 else ""
    found = run(DOOR.format(e=e, h=h, k=k, down=down, more=push))
    assert found.status == "ok" and any("leave no motion" in note for note in found.notes)
    assert all(x == found.states[0] for x in found.states)


@pytest.mark.full
def test_beside_what_moves_a_row_of_nothing_contradicts_nothing() -> None:
    found = run(DOOR.format(e=1e-2, h=2.0, k=0.4, down="0, -1, -0.3", more=PENDULUM), backend="c")
    assert "contradict" not in found.message


@pytest.mark.full
@pytest.mark.parametrize("d", [1e-2, 1e-4, 1e-5])
def test_rods_of_which_one_is_a_little_off(d: float) -> None:
    found = run(PLATE.format(d=d), backend="c")
    if found.status == "ok":
        assert all(x == found.states[0] for x in found.states)
    else:
        assert "nearly depends on others" in found.message


def test_driven_rows_move() -> None:
    rows = "constraint one: x = (1 [m/s])*time; constraint two: y = 0;"
    found = run(POINT.format(x=0.0, y=0.0, rows=rows))
    assert found.status == "ok" and found["x"][-1] == pytest.approx(1.0, abs=1e-6)
    rows = "constraint one: der(x) = 1 [m/s]; constraint two: y = 0;"
    assert run(POINT.format(x=0.0, y=0.0, rows=rows))["x"][-1] == pytest.approx(1.0, abs=1e-6)


@pytest.mark.full
@pytest.mark.parametrize(("more", "y"), [("", 0.7), ("+ x^2/l", 0.2)])
def test_a_radius_that_vanishes_ends_the_motion(more: str, y: float) -> None:
    # the particle keeps its angular momentum and turns faster and faster
    row = f"constraint c: sqrt(x^2 + y^2) {more} = 2*l*(1 - time/(1 [s]));"
    found = run(POINT.format(x=0.5, y=y, rows=row), 3.0, "c")
    assert found.status == "failed" and "the cause is not known" not in found.message, found.message
    assert 0.9 < found.times[-1] + 0.075 <= 1.08


@pytest.mark.sample(1)
@pytest.mark.parametrize(
    ("c", "r", "force"), [(3.0, 2.0, "9.81, 0"), (0.5, 0.5, "0, 0"), (-2.0, 1.0, "0, 9.81")]
)
def test_circles_that_touch_hold_at_one_point(c: float, r: float, force: str) -> None:
    rows = f"""constraint one: x^2 + y^2 = l^2; constraint two: (x - {c} [m])^2 + y^2 = ({r} [m])^2;
    force f = {{{force}, 0}} [N] at b;"""
    found = run(POINT.format(x=0.8, y=0.3, rows=rows), backend="c")
    at = math.copysign(1.0, c)
    if found.status == "ok":
        assert found["x"] == pytest.approx(at, abs=1e-6) and abs(found["y"]).max() < 1e-6
    else:
        assert "nearly depends on others" in found.message


@pytest.mark.sample(1)
@pytest.mark.parametrize("mu", [1.5, 4.0])
def test_friction_that_sticks_is_named(mu: float) -> None:
    text = f"""model Stick
  coordinate Length x(rate = 1 [m/s]);
  body b = Particle(mass = 1 [kg], at = {{x, 0, 0}});
  force F = ({-mu} [N]*sign(der(x)) + 1 [N])*world.x at b;
end Stick;"""
    found = lagc.loads(text).compile(backend="c").simulate(10.0, points=41)
    stops = 1.0 / (mu - 1.0)
    assert found.status == "failed" and "a smooth law, such as tanh(v/v0)" in found.message
    assert found.cost.rhs < 1000
    at = float(found.message.rpartition("at t = ")[2].split(" s")[0])
    assert at == pytest.approx(stops, rel=1e-5)


@pytest.mark.full
def test_what_fails_coarsely_may_go_well_finely() -> None:
    # two spheres with centres close together: a circle, on which the particle is a pendulum
    text = """model Circle
  coordinate Length x(start = 0.3 [m]), y(start = 0.1), z(start = 0.9);
  body b = Particle(mass = 1 [kg], at = {x, y, z});
  constraint one: x^2 + y^2 + z^2 = 1 [m2];
  constraint two: x^2 + y^2 + (z - 1e-4 [m])^2 = (1 + 1e-8 - 1.8e-4)*(1 [m2]);
  potential V = (9.81 [N])*x;
end Circle;"""
    found = run(text, 2.0, "c")
    r, y = math.sqrt(0.19), found["y"][0]
    truth = solve_ivp(lambda _, s: [s[1], 9.81 / r * math.sin(s[0])], (0, 2), [math.asin(y / r), 0.0],
                      rtol=1e-11, atol=1e-12)  # fmt: skip
    assert found.status == "ok", found.message
    assert found["y"][-1] == pytest.approx(r * math.sin(truth.y[0, -1]), abs=2e-6)


PACES = {
    "steady": lambda n: n * 1e-3,
    "first slow, then fast": lambda n: min(n, 1500) * 1.0 + max(n - 1500, 0) * 1e-3,
    "ever faster, exponentially": lambda n: 100.0 * math.log(1.0 + n / 100.0),
    "to a singularity": lambda n: 1e3 * (1.0 - 1.0 / (1.0 + n / 100.0)),
    "geometrically": lambda n: 1e3 * (1.0 - 0.999**n),
}


@pytest.mark.parametrize("name", PACES)
def test_only_times_that_converge_end_a_run_in_full_swing(name: str) -> None:
    system, checks, ended = Oscillator(), [(0.0, 0, 0.0)], False
    for steps in [1024 * 2**k for k in range(8)]:
        t = PACES[name](steps)
        x = [math.cos(t), -math.sin(t)]
        done = Trajectory([0.0], [[1.0, 0.0]], t, x, steps=steps, rhs=12 * steps)
        ended = ended or is_stuck(system, done, 1e12, math.inf, checks)
        assert checks[-1][2] * (1e12 - t) / t > LONG
    assert ended == (name in ("to a singularity", "geometrically"))


@pytest.mark.full
def test_looks_come_after_twice_as_many_steps() -> None:
    seen: list[int] = []

    def watch(run: Trajectory) -> bool:
        seen.append(run.steps)
        assert len(run.states) == len(run.times) and run.t == pytest.approx(0.01 * run.steps)
        return len(seen) == 3

    options = Options(step=0.01, watch=watch)
    for backend in ("c", "numpy"):
        seen.clear()
        system = lagc.load("simple_pendulum").compile(backend=backend).load(backend)
        done = system.integrate(options, 0.0, system.start(), [float(k) for k in range(101)])
        assert seen == [1024, 2048, 4096] and done.steps == 4096 and len(done.states) == 41


@pytest.mark.full
def test_a_long_motion_goes_on() -> None:
    found = simulate(Oscillator(), Request(stop=3000.0, accuracy=1e-3))
    assert found.status == "ok" and found.cost.steps > 2000
    assert found.column("x")[-1] == pytest.approx(math.cos(3000.0), abs=1e-3)
