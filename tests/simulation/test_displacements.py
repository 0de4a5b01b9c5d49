"""Coordinates that are displacements from places, and begin at zero: their size is that of the places, and
the motion that of coordinates from the origin."""

import math

import mpmath as mp
import pytest

import lagc

ACCURACY = 1e-8


def pendulum(length: float, speed: float) -> str:
    return f"""model Pendulum
  coordinate Length x(start = 0, rate = {speed!r}), z;
  body bob = Particle(mass = 2, at = {{x, 0, z - {length!r} [m]}});
  constraint rod: norm(position(bob)) = {length!r} [m];
  Gravity g(g = 9.81, direction = {{0, 0, -1}});
end Pendulum;
"""


@pytest.mark.sample(1)
@pytest.mark.parametrize("length", (1.0, 1e-4, 1e6))
@pytest.mark.parametrize("backend", ("numpy", "c"))
def test_a_pendulum_swings_from_its_place(length: float, backend: str) -> None:
    frequency, speed = math.sqrt(9.81 / length), 0.1 * math.sqrt(length)
    model = lagc.loads(pendulum(length, speed)).compile(backend=backend)
    run = model.simulate(stop=2 * math.pi / frequency, accuracy=ACCURACY)
    assert run.status == "ok", run.message
    k = speed / (2 * frequency * length)  # the sine of half the largest angle
    sines = [k * float(mp.ellipfun("sn", t * frequency, k=k)) for t in run.t]
    exact = [2 * length * s * math.sqrt(1 - s**2) for s in sines]
    assert max(abs(run["x"] - exact)) <= ACCURACY * max(map(abs, exact))


def strip(n: int, displaced: bool) -> str:
    lines = ["model Strip", "  parameter Length l = 1;"]
    for i in range(1, n + 1):
        place = f"{i}*l + x{i}" if displaced else f"x{i}"
        lines.append(f"  coordinate Length x{i}(start = {0 if displaced else i}), z{i}(rate = 0.05);")
        lines.append(f"  body p{i} = Particle(mass = 1, at = {{{place}, 0, z{i}}});")
        before = f" - position(p{i - 1})" if i > 1 else ""
        lines.append(f"  constraint rod{i}: norm(position(p{i}){before}) = l;")
    lines += ["  Gravity g(g = 9.81, direction = {0, 0, -1});", "end Strip;\n"]
    return "\n".join(lines)


@pytest.mark.full
@pytest.mark.parametrize("n", (1, 2, 3, 5, 12))
def test_a_strip_of_rods_moves_as_from_the_origin(n: int) -> None:
    runs = [
        lagc.loads(strip(n, displaced)).compile(backend="numpy").simulate(stop=1, accuracy=ACCURACY)
        for displaced in (True, False)
    ]
    assert all(run.status == "ok" for run in runs)
    assert not [note for run in runs for note in run.notes if "own ranges" not in note]
    displaced, plain = runs
    for i in range(1, n + 1):
        for name, shift in ((f"x{i}", float(i)), (f"z{i}", 0.0)):
            far = abs(displaced[name] + shift - plain[name]).max()
            assert far <= 2 * n * ACCURACY


RAIL = """model Rail
  parameter Length l = %s;
  parameter Angle al = 30 [deg];
  parameter Real k = 2;
  coordinate Length x, y;
  point A = %s;
  body b = Particle(mass = 1, at = A);
  constraint r: norm(A) = l;
  Gravity g(g = 9.81, direction = {0, 0, -1});
end Rail;
"""
HORIZONTAL = ("{l + x*cos(al), 0, y + x*sin(al)}", "{l + k*x, 0, k*y}", "{l - 1e-9*x, 0, y}", "{l + x, 0, y}")


@pytest.mark.sample(1)
@pytest.mark.parametrize("length", (1.0, 1e-3))
@pytest.mark.parametrize("place", HORIZONTAL)
def test_displacements_along_any_direction(place: str, length: float) -> None:
    """From the horizontal: sin(phi/2) = k sn(u, k) with k^2 = 1/2, u a quarter period before its end."""
    frequency = math.sqrt(9.81 / length)
    model = lagc.loads(RAIL % (length, place)).compile(backend="numpy")
    run = model.simulate(stop=1 / frequency, accuracy=ACCURACY)
    assert run.status == "ok" and not run.notes, run.message
    quarter = float(mp.ellipk(0.5))
    height = -length * math.cos(
        2 * math.asin(math.sqrt(0.5) * float(mp.ellipfun("sn", quarter - 1, k=math.sqrt(0.5))))
    )
    x, y = run["x"][-1], run["y"][-1]
    found = {"{l + x*cos(al), 0, y + x*sin(al)}": y + x / 2, "{l + k*x, 0, k*y}": 2 * y}.get(place, y)
    assert found == pytest.approx(height, abs=10 * ACCURACY * length)


BESIDE = """model Beside
  coordinate Length a, b, x(start = 1 [mm]), y;
  body p = Particle(mass = 1, at = {x, y, 0});
  body q = Particle(mass = 1, at = {a, b, 0});
  constraint rod: norm({x, y, 0}) = 1 [mm];
  constraint tie: %s;
  force f = {0, 1 [mN], 0} at p;
end Beside;
"""
TIES = (
    "a - 1e-9*b + 3 [m]*cos(b/(1 [m])) = 3 [m]",
    "1e-9*b - a - 3 [m]*cos(b/(1 [m])) = -3 [m]",
    "1e-310*b - a - 3 [m]*cos(b/(1 [m])) = -3 [m]",
    "norm({a, 0, b + 6.4e6 [m]}) = 6.4e6 [m]",
)


@pytest.mark.sample(1)
@pytest.mark.parametrize("tie", TIES)
def test_what_one_is_displaced_from_is_nothing_to_others(tie: str) -> None:
    run = lagc.loads(BESIDE % tie).compile(backend="numpy").simulate(stop=20, accuracy=ACCURACY)
    assert run.status == "ok", run.message
    assert max(abs(run["x"] ** 2 + run["y"] ** 2 - 1e-6)) <= 1e-15 * 1e-6


@pytest.mark.sample(1)
@pytest.mark.parametrize("backend", ("numpy", "c"))
def test_what_only_rounding_moves_beside_a_displacement_does_not_shorten_steps(backend: str) -> None:
    """A particle has its place by two displacements along an axis that turns freely: nothing turns it."""
    text = RAIL.replace("  Gravity", "  coordinate Angle th(start = 0.5);\n"
                        "  body w = Solid(mass = 1, inertia = {1, 1, 1}, frame = rotate_y(world, th),"
                        " com = {0, 0, 0});\n"
                        "  Gravity") % (1.0, "{l + x*cos(th), 0, y + x*sin(th)}")  # fmt: skip
    run = lagc.loads(text).compile(backend=backend).simulate(stop=1 / math.sqrt(9.81), accuracy=ACCURACY)
    assert run.status == "ok" and run.cost.steps < 1000, run.message
    assert abs(run["th"] - 0.5).max() <= 1e-15
    quarter, k = float(mp.ellipk(0.5)), math.sqrt(0.5)
    height = -math.cos(2 * math.asin(k * float(mp.ellipfun("sn", quarter - 1, k=k))))
    assert run["y"][-1] + run["x"][-1] * math.sin(0.5) == pytest.approx(height, abs=10 * ACCURACY)


TRUSS = """model Truss
  coordinate Length x1, z1, x2, z2;
  coordinate Angle th(start = 0.3);
  body a = Particle(mass = 1, at = {1 [m] + x1, 0, z1});
  body b = Particle(mass = 1, at = {1 [m] + x2, 0, 1 [m] + z2});
  body p = Particle(mass = 1, at = {5 [m] + 1 [m]*sin(th), 0, -1 [m]*cos(th)});
  constraint r1: norm(position(a)) = 1 [m];
  constraint r2: norm(position(a) - {0, 0, 1} [m]) = sqrt(2)*1 [m];
  constraint r3: norm(position(b) - {0, 0, 1} [m]) = 1 [m];
  constraint r4: norm(position(b) - position(a)) = 1 [m];
  force f = {0 [N], 0 [N], -1 [N]*sin(3*time/(1 [s]))} at b;
  Gravity g;
  output Force rod = reaction(r4);
end Truss;
"""


def test_a_truss_at_rest_under_a_load_in_time_beside_what_moves() -> None:
    run = lagc.loads(TRUSS).compile(backend="numpy").simulate(stop=3, accuracy=ACCURACY)
    assert run.status == "ok", run.message
    assert max(abs(run[name]).max() for name in ("x1", "z1", "x2", "z2")) <= 1e-15
    alone = """model Alone
      coordinate Angle th(start = 0.3);
      body p = Particle(mass = 1, at = {1 [m]*sin(th), 0, -1 [m]*cos(th)});
      Gravity g;
    end Alone;"""
    other = lagc.loads(alone).compile(backend="numpy").simulate(stop=3, accuracy=ACCURACY)
    assert run["th"][-1] == pytest.approx(other["th"][-1], abs=2 * ACCURACY)
    # the rods that bear the node: r3 is level, so r4, upright, carries its weight and the load
    assert abs(run["rod"]) == pytest.approx([9.81 + math.sin(3 * t) for t in run.t], abs=1e-6)


@pytest.mark.parametrize("power", (1.5, 2.0, 3.0))
def test_what_departs_from_zero_by_a_high_power(power: float) -> None:
    """angle = t^2/2, x'' = angle^power: x = t^n/(2^power n (n - 1)), n = 2 power + 2, from zero, where every
    first step is as wrong by its own size."""
    text = f"""model Late
      coordinate Length x;
      coordinate Angle a;
      body cart = Particle(mass = 1, at = {{x, 0, 0}});
      body wheel = Solid(mass = 1, inertia = {{1, 1, 1}}, frame = rotate_z(world, a), com = {{0, 0, 0}});
      torque drive = {{0, 0, 1 [N.m]}} on wheel;
      force late = {{1 [N]*max(a, 0)^{power}, 0, 0}} at cart;
    end Late;"""
    run = lagc.loads(text).compile(backend="numpy").simulate(stop=2, accuracy=ACCURACY)
    assert run.status == "ok" and run.cost.steps < 1000, run.message
    n = 2 * power + 2
    exact = [t**n / (2**power * n * (n - 1)) for t in run.t]
    assert run["x"] == pytest.approx(exact, abs=ACCURACY * exact[-1])


BUFFER = """model Buffer
  parameter Time T = 0.6 [s];
  coordinate Length x;
  body a = Particle(mass = 1, at = {x, 0, 0});
  force push = {1 [N]*max(0, (time - T)/(1 [s])), 0, 0} at a;
  force spring = {-100 [N]*max(0, x/(1 [m])), 0, 0} at a;
end Buffer;"""


def test_what_rests_is_pushed_against_a_spring_of_one_side() -> None:
    """x = (t - T - sin(10 (t - T))/10)/100: nothing moves until T, and then all by powers of the time."""
    system = lagc.loads(BUFFER).compile(backend="numpy")
    for begin in (0.05, 0.556, 0.6, 0.9, 1.05, 1.103, 1.2):
        run = system.simulate(stop=1.5, parameters={"T": begin}, accuracy=1e-6)
        assert run.status == "ok", (begin, run.message)
        exact = [max(0.0, t - begin - math.sin(10.0 * (t - begin)) / 10.0) / 100.0 for t in run.t]
        exact = [value if t > begin else 0.0 for t, value in zip(run.t, exact)]
        assert run["x"] == pytest.approx(exact, abs=1e-6 * max(exact))


LATE_ANGLE = """model LateAngle
  parameter Time T = 0.2 [s];
  coordinate Length x, w(start = 1 [m]);
  coordinate Angle y;
  body a = Particle(mass = 1, at = {x, w, 0});
  body b = Solid(mass = 1, inertia = {1, 1, 1}, frame = rotate_z(world, y), com = {0, 0, 0});
  potential V = 1/2*(9 [N/m])*w^2;
  force f = {1e-6*(1 [N])*max(0, (time - T)/(1 [s]))^2.5, 0, 0} at a;
  torque c = 0.1*(1 [N.m])*max(0, x/(1 [m]))*world.z on b;
end LateAngle;"""


@pytest.mark.sample(4)
@pytest.mark.parametrize("begin", (0.0, 0.2))
@pytest.mark.parametrize("accuracy", (1e-6, 1e-8, 1e-10))
def test_what_a_condition_switches_is_as_small_as_what_it_looks_at(begin: float, accuracy: float) -> None:
    """x = 1e-6 u^4.5/(3.5 4.5), y = 1e-7 u^6.5/(3.5 4.5 5.5 6.5), u = t - T: in the end 1e-7 m and 1e-9 rad
    beside the meter of w, whose last places are no reason for x to set out late."""
    run = (
        lagc.loads(LATE_ANGLE)
        .compile(backend="numpy")
        .simulate(stop=1.5, parameters={"T": begin}, accuracy=accuracy)
    )
    assert run.status == "ok", run.message
    exact = 1e-7 * (1.5 - begin) ** 6.5 / (3.5 * 4.5 * 5.5 * 6.5)
    assert run["y"][-1] == pytest.approx(exact, rel=accuracy)


@pytest.mark.parametrize("rtol", (1e-5, 1e-7, 1e-9))
def test_a_kind_that_sets_out_late_does_not_end_a_run_that_is_steered_by_hand(rtol: float) -> None:
    run = lagc.loads(LATE_ANGLE).compile(backend="numpy").simulate(stop=1.5, method="dop853", rtol=rtol)
    assert run.status == "ok", run.message
    assert run["y"][-1] == pytest.approx(1e-7 * 1.3**6.5 / (3.5 * 4.5 * 5.5 * 6.5), rel=10 * rtol)


THREE = """model Three
  parameter Time T = 0.2 [s];
  coordinate Length x, y, z;
  body a = Particle(mass = 1, at = {x, 0, 0});
  body b = Particle(mass = 1, at = {0, y, 0});
  body d = Particle(mass = 1, at = {0, 0, z});
  force fx = {1 [N]*max(0, (time - T)/(1 [s])), 0, 0} at a;
  force fy = {0, 1 [N/m]*x, 0} at b;
  force fz = {0, 0, 1 [N]*max(0, y/(1 [m]))^1.5} at d;
end Three;"""


def test_conditions_that_leave_zero_one_after_the_other() -> None:
    """With u = t - T x = u^3/6, y = u^5/120, z = 120^-1.5 u^9.5/(8.5 9.5)."""
    system = lagc.loads(THREE).compile(backend="numpy")
    for begin in [k / 20 for k in range(0, 24, 2)]:
        run = system.simulate(stop=1.5, parameters={"T": begin}, accuracy=1e-6)
        assert run.status == "ok", (begin, run.message)
        u = 1.5 - begin
        exact = [u**3 / 6, u**5 / 120, 120**-1.5 * u**9.5 / (8.5 * 9.5)]
        assert [run[name][-1] for name in "xyz"] == pytest.approx(exact, rel=1e-6)


PAIR = """model Pair
  parameter Time T = 0.1 [s];
  parameter Mass m1 = 1, m2 = 2;
  coordinate Length x, y;
  body a = Particle(mass = m1, at = {x, 0, 0});
  body b = Particle(mass = m2, at = {y, 0, 0});
  potential c = 1/2*(1 [N/m])*(x - y)^2;
  force f = {if time > T then 1 [N] else 0 [N], 0, 0} at a;
end Pair;"""


@pytest.mark.sample(1)
@pytest.mark.parametrize("accuracy", (1e-3, 1e-4, 1e-5, 1e-8))
def test_a_pair_at_rest_is_pushed_and_swings(accuracy: float) -> None:
    """With u = t - T, M = m1 + m2, w^2 = M/(m1 m2): x - y = (1 - cos w u)/(m1 w^2), m1 x + m2 y = u^2/2.
    All is at rest until T, and the first attempt at a step behind it is far too long."""
    system = lagc.loads(PAIR).compile(backend="numpy")
    for m1, m2, begin in ((0.33, 2.43, 3.3), (0.117, 5.82, 0.1), (1.01, 6.92, 1 / 3), (0.21, 0.45, 1 / 3)):
        run = system.simulate(stop=begin + 20, parameters={"m1": m1, "m2": m2, "T": begin}, accuracy=accuracy)
        assert run.status == "ok", run.message
        w = math.sqrt((m1 + m2) / (m1 * m2))
        swing, mean = math.sin(20 * w) / (m1 * w), 20 / (m1 + m2)
        exact = [mean + m2 / (m1 + m2) * swing, mean - m1 / (m1 + m2) * swing]
        speeds = [run["der(x)"][-1], run["der(y)"][-1]]
        assert speeds == pytest.approx(exact, abs=accuracy * max(map(abs, exact)))


STAGES = """model Stages
  parameter Time T = 0.1 [s];
  parameter Real A = 98, B = 1.25;
  coordinate Angle a;
  coordinate Length x;
  body ba = Solid(mass = 1, inertia = {1, 1, 1}, frame = rotate_z(world, a), com = {0, 0, 0});
  body bx = Particle(mass = 1, at = {x, 0, 0});
  torque fa = 20*A*(1 [N.m])*max(0, (time - T)/(1 [s]))^3*world.z on ba;
  force fx = {42*B*(1 [N])*max(0, a/A), 0, 0} at bx;
end Stages;"""


@pytest.mark.parametrize("method", ("dop853", "dopri5"))
def test_steered_by_hand_one_moves_another(method: str) -> None:
    run = lagc.loads(STAGES).compile(backend="numpy").simulate(stop=2.1, method=method, rtol=1e-5)
    assert run.status == "ok", run.message
    assert run["x"][-1] == pytest.approx(1.25 * 2.0**7, rel=1e-3)
