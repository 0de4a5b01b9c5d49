"""Starts of loops whose rows depend on each other where they are closed, and not elsewhere: what was stated
stays wherever the loop can be closed with it."""

import math
import random
import shutil

import pytest

from lagc.mechanics.analysis.analysis import analyse
from lagc.simulation.initialization.initialize import consistent_start
from lagc.simulation.system import OK
from tests.simulation.initialization.generated_starts import (
    Starts,
    compilation_of,
    program_of,
    stated_moves,
    system_of,
)

needs_gcc = pytest.mark.skipif(shutil.which("gcc") is None, reason="there is no gcc")


def cranks(n: int, r: float, d: float, declared: str = "") -> str:
    """Equal cranks c0, c1, .. at distances d, pinned to one bar: 2 n rows of rank n + 2, one motion."""
    lines = ["model Cranks", "  parameter Length l = 1 [m];", declared]
    lines += ["  coordinate Length x, y;", "  coordinate Angle p;"]
    lines += ["  frame P = rotate_z(world, p);", "  point G = {x, y, 0};"]
    lines += ["  body bar = Solid(mass = 2, inertia = {1, 1, 1}, frame = P, com = G);"]
    for k in range(n):
        if f" c{k}(" not in declared:
            lines.append(f"  coordinate Angle c{k};")
        lines.append(f"  frame C{k} = rotate_z(world, c{k});")
        pin = f"{{{k * d!r}*l, 0, 0}}"
        lines.append(f"  body k{k} = Solid(mass = 1, inertia = {{1, 1, 1}}, frame = C{k}, com = {pin});")
        lines.append(f"  constraint j{k}: G + {k * d!r}*l*P.x = {pin} + {r!r}*l*C{k}.x;")
    return "\n".join([*lines, "end Cranks;\n"])


def bars(factors: list[float], r: float, d: float) -> str:
    """Two equal cranks a, b, joined by parallel bars at these parts of r."""
    lines = ["model Bars", "  parameter Length l = 1 [m];"]
    lines += ["  coordinate Angle a(start = 1 [rad], rate = 3 [rad/s]), b;"]
    lines += ["  frame A = rotate_z(world, a);", "  frame B = rotate_z(world, b);"]
    lines += ["  body m = Solid(mass = 1, inertia = {1, 1, 1}, frame = B, com = {0, 0, 0});"]
    for k, part in enumerate(factors):
        lines.append(f"  coordinate Angle p{k};\n  frame P{k} = rotate_z(world, p{k});")
        arm = f"{part * r!r}*l"
        lines.append(f"  body m{k} = Particle(mass = 1, at = {arm}*A.x + {0.5 * d!r}*l*P{k}.x);")
        lines.append(f"  constraint l{k}: {arm}*A.x + {d!r}*l*P{k}.x = {{{d!r}*l, 0, 0}} + {arm}*B.x;")
    return "\n".join([*lines, "end Bars;\n"])


BENNETT = """\
model Bennett
  parameter Length a = 1 [m];
  parameter Angle al = {al!r} [rad], be = {be!r} [rad];
  parameter Length b = a*sin(be)/sin(al);
  coordinate Angle t1(rate = 2 [rad/s]), t2, t3, t4;
  frame F1 = rotate_z(world, t1);
  point P1 = a*F1.x;
  frame G1 = rotate_x(F1, al);
  frame F2 = rotate_z(G1, t2);
  point P2 = P1 + b*F2.x;
  frame G2 = rotate_x(F2, be);
  frame F3 = rotate_z(G2, t3);
  point P3 = P2 + a*F3.x;
  frame G3 = rotate_x(F3, al);
  frame F4 = rotate_z(G3, t4);
  point P4 = P3 + b*F4.x;
  frame G4 = rotate_x(F4, be);
  body p1 = Particle(mass = 1, at = P1);
  body p2 = Particle(mass = 1, at = P2);
  body p3 = Particle(mass = 1, at = P3);
  constraint close: P4 = {{0, 0, 0}};
  constraint o1: G4.x.y = 0;
  constraint o2: G4.x.z = 0;
  constraint o3: G4.y.z = 0;
end Bennett;
"""


def turned(angle: float) -> float:
    """Between -pi and pi."""
    return math.remainder(angle, 2 * math.pi)


def near(twins: Starts, given: dict[str, float]) -> dict[str, float]:
    """The start with `given` stated by the run, the same bits in C; none of `given` moved."""
    interface = twins.interface
    names = [*interface.q_names, *interface.v_names]
    x, levels = twins.guess, list(interface.start_levels)
    for name, value in given.items():
        x[names.index(name)], levels[names.index(name)] = value, 3
    found = twins.by_python(0.0, x, levels)
    assert repr(found) == repr(twins.by_c(0.0, x, levels))
    assert found[0] == OK, given
    values = dict(zip(names, found[2]))
    assert {name: values[name] for name in given} == given
    return values


@pytest.mark.full
@needs_gcc
@pytest.mark.parametrize("seed", range(2))
def test_cranks_follow_the_one_that_is_stated(seed: int) -> None:
    """All are at its angle and turn with it, whole turns aside; the bar is level: the loop has no other
    configuration.  As exact as rows that are met to 1e-15 tell where cos or sin is flat: 1e-6 rad near the
    dead centres, which are kept away from by 2 degrees."""
    dice = random.Random(seed)
    n = 3 + seed
    twins = Starts(program_of(cranks(n, dice.uniform(0.1, 1.0), dice.uniform(0.1, 1.0))))
    for _ in range(6):
        angle = dice.choice((0.0, math.pi)) + dice.choice((-1.0, 1.0)) * dice.uniform(0.035, math.pi / 2)
        found = near(twins, {"c0": angle, "der(c0)": 3.0})
        for k in range(n):
            assert abs(turned(found[f"c{k}"] - angle)) < 1e-9
            assert abs(found[f"der(c{k})"] - 3.0) < 1e-9
        assert abs(turned(found["p"])) < 1e-9


@pytest.mark.full
@needs_gcc
@pytest.mark.parametrize("seed", range(2))
def test_parallel_bars_keep_the_stated_crank(seed: int) -> None:
    dice = random.Random(seed)
    parts = [1.0, 0.5, 0.7][: 2 + seed]
    twins = Starts(program_of(bars(parts, dice.uniform(0.1, 1.0), dice.uniform(0.1, 1.0))))
    for _ in range(6):
        angle = dice.choice((0.0, math.pi)) + dice.choice((-1.0, 1.0)) * dice.uniform(0.035, math.pi / 2)
        found = near(twins, {"a": angle})
        assert abs(turned(found["b"] - angle)) < 1e-9
        assert abs(found["der(b)"] - 3.0) < 1e-9


@pytest.mark.sample(1)
@pytest.mark.parametrize("seed", range(3))
def test_of_stated_cranks_only_those_that_are_off_move(seed: int) -> None:
    """All but one at the same angle: that one moves to it, however little it is off."""
    dice = random.Random(seed)
    n = 3 + seed % 2
    system = system_of(cranks(n, dice.uniform(0.1, 1.0), dice.uniform(0.1, 1.0)))
    for off in (1e-5, 1e-3, 0.05, 0.3):
        angle, odd = dice.uniform(0.3, 1.3), dice.randrange(n)
        given = {f"c{k}": angle for k in range(n)} | {"der(c0)": 3.0}
        given[f"c{odd}"] += off
        start = consistent_start(system, 0.0, given)
        assert stated_moves(start) == [f"c{odd}"]
        assert start.x[system.interface.q_names.index(f"c{odd}")] == pytest.approx(angle, abs=1e-9)
        assert "and" not in start.notes[0].replace(" and constraint", "")  # few conditions are named


@pytest.mark.full
@pytest.mark.parametrize("seed", range(3))
def test_bennetts_linkage_moves_what_is_off(seed: int) -> None:
    """t3 = -t1, t4 = -t2 and tan(t1/2) tan(t2/2) = sin((be + al)/2) / sin((be - al)/2) (G. T. Bennett, 1903);
    its six rows have rank three."""
    dice = random.Random(seed)
    al, be = dice.uniform(0.3, 0.8), dice.uniform(0.9, 1.4)
    system = system_of(BENNETT.format(al=al, be=be))
    ratio = math.sin((be + al) / 2) / math.sin((be - al) / 2)
    t1 = dice.choice((-1.0, 1.0)) * dice.uniform(0.8, 2.2)
    t2 = 2.0 * math.atan(ratio / math.tan(t1 / 2))
    true = {"t1": t1, "t2": t2, "t3": -t1, "t4": -t2}
    for off in (["t2", "t4"], ["t4"], ["t1"]):
        given = {name: v + (dice.uniform(0.05, 0.2) if name in off else 0.0) for name, v in true.items()}
        start = consistent_start(system, 0.0, given)
        assert [name for name in stated_moves(start) if name in true] == off
        for name, value in zip(system.interface.q_names, start.x):
            assert value == pytest.approx(true[name], abs=1e-9)


DISC = """\
model Disc
  parameter Length R = {R!r} [m];
  coordinate Length x, y, z(start = R);
  coordinate Angle psi, th, phi;
  frame A = rotate_z(world, psi);
  frame B = rotate_x(A, th);
  frame C = rotate_z(B, phi);
  point G = {{x, y, z}};
  point P = G - R*{down};
  body disc = Solid(mass = 1, inertia = 1 [kg]*R^2*{{1/4, 1/4, 1/2}}, frame = C, com = G);
  constraint touch: P.z = 0;
  constraint roll: velocity(disc, at = P) = {{0, 0, 0}};
end Disc;
"""


@pytest.mark.full
@needs_gcc
@pytest.mark.parametrize("down", ("B.y", "{0, 0, 1}"))
def test_a_stated_velocity_of_a_wheel_or_ball_asks_for_moderate_rates(down: str) -> None:
    """Rolling with x' = u is done by turns of u / R about two axes, with y' and z' up to u: the solution of
    least norm, in these sizes, has no rate above 2 u / R.  At right angles exactly, near them, elsewhere."""
    dice = random.Random(down)
    twins = Starts(program_of(DISC.format(R=0.4, down=down)))
    for off in (0.0, 1e-12, 1e-6, 1e-3, 0.3):
        for th in (-0.5 * math.pi + off, 0.5 * math.pi - off, 1.5 * math.pi + off):
            z = 0.4 * math.sin(th) if down == "B.y" else 0.4
            found = near(twins, {"th": th, "psi": dice.choice((0.0, 0.4, 1.0)), "z": z, "der(x)": 2.0})
            assert max(abs(found[f"der({name})"]) for name in ("psi", "th", "phi")) <= 2.0 * 2.0 / 0.4


@pytest.mark.full
@pytest.mark.parametrize("seed", range(3))
def test_one_motion_is_told_from_any_stated_crank(seed: int) -> None:
    """What `explain` says: n cranks and a bar have n + 2 rows that count, parallel bars one each and one."""
    dice = random.Random(seed)
    for degrees in (10, 50, 80, 110, 140, 170):
        declared = f"  coordinate Angle c0(start = {degrees} [deg]);"
        text = cranks(3, dice.uniform(0.1, 1.0), dice.uniform(0.1, 1.0), declared)
        told = analyse(compilation_of(text).equations)
        assert told.degrees_of_freedom == 1 and len(told.redundant) == 1
        text = bars([1.0, 0.5], dice.uniform(0.1, 1.0), dice.uniform(0.1, 1.0))
        told = analyse(compilation_of(text.replace("1 [rad]", f"{degrees} [deg]")).equations)
        assert told.degrees_of_freedom == 1 and len(told.redundant) == 1


def table(strings: int, dice: random.Random) -> str:
    """Six coordinates, a row for each string of length 1; x and z are stated, y and the angles are not."""
    lines = ["model Table", "  parameter Length l = 1 [m];"]
    x = dice.uniform(0.1, 0.5)
    z = -math.sqrt(1.0 - x * x) * dice.uniform(0.8, 1.0)
    lines += [f"  coordinate Length x(start = {x!r} [m], rate = 1 [m/s]), y, z(start = {z!r} [m]);"]
    lines += ["  coordinate Angle al, be, ga;", "  frame F1 = rotate_z(world, ga);"]
    lines += ["  frame F2 = rotate_x(F1, al);", "  frame F = rotate_y(F2, be);", "  point G = {x, y, z};"]
    lines += ["  body plate = Solid(mass = 3, inertia = {1, 1, 1}, frame = F, com = G);"]
    for k in range(strings):
        r, phi = dice.uniform(0.2, 1.0), 2 * math.pi * (k + dice.uniform(0.0, 0.7)) / strings
        a, b = r * math.cos(phi), r * math.sin(phi)
        arms = [f"({a!r})*l*{frame}.x + ({b!r})*l*{frame}.y" for frame in ("F", "world")]
        lines.append(f"  constraint s{k}: norm(G + {arms[0]} - ({arms[1]})) = l;")
    return "\n".join([*lines, "end Table;\n"])


@pytest.mark.sample(0, 2)
@needs_gcc
@pytest.mark.parametrize("seed", range(4))
def test_a_plate_on_equal_strings_hangs_on_all(seed: int) -> None:
    """The guess is singular: at y = 0 no string depends on y.  On three strings the plate may tilt; on four,
    whose equations depend on each other where it is level, it stays level and moves as one string."""
    dice = random.Random(seed)
    twins = Starts(program_of(table(3 + seed % 2, dice)))
    levels = twins.interface.start_levels
    found = twins.by_python(0.0, twins.guess, levels)
    assert repr(found) == repr(twins.by_c(0.0, twins.guess, levels))
    assert found[0] == OK
    x, y, z, *angles = found[2][:6]
    vx, vy, vz, *turning = found[2][6:]
    assert (x, z, vx) == (twins.guess[0], twins.guess[2], 1.0)
    if seed % 2:
        assert angles == turning == [0.0, 0.0, 0.0]
        assert abs(math.hypot(x, y, z) - 1.0) < 1e-15 and abs(x * vx + y * vy + z * vz) < 1e-15
