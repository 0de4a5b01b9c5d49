"""Sets of contacts that share a load: they hold it as long as some forces within their friction cones do."""

import math
import shutil
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.optimize import linprog

import lagc
from lagc.api import Run
from tests.contact.law_kernels import FOUND, KERNELS, ONE, STICKS, fill, in_python, values

Array = Any
BACKENDS = ["numpy", pytest.param("c", marks=pytest.mark.full)]
BOX = """model M
  parameter Real mu = 0.3, mu_s = 0.4;
  coordinate Length x, z(start = 0.1 [m]);
  coordinate Angle a;
  frame B = rotate_y(world, a);
  body box = Solid(mass = 1 [kg], inertia = {1, 1, 1}*0.01 [kg.m2], frame = B, com = {x, 0, z});
  point P[1] = position(box) - 0.2 [m]*B.x - 0.1 [m]*B.z;
  point P[2] = position(box) + 0.2 [m]*B.x - 0.1 [m]*B.z;
"""
CORNERS = """  for i in 1:2 loop
    constraint corner[i]: P[i].z >= 0 (friction = mu, static = mu_s, at = P[i]);
  end for;
  output Force N[2] = {reaction(corner[i]) for i in 1:2};
end M;"""
WEIGHT = "  Gravity field(g = 10 [m/s2]);\n"


@cache
def _compiled(text: str, backend: str) -> Any:
    return lagc.loads(text).compile(backend=backend)


def _box(force: str, backend: str, stop: float, **parameters: float) -> Run:
    return _compiled(BOX + force + CORNERS, backend).simulate(stop, parameters=parameters)


def _told(run: Run) -> list[str]:
    return [event.name for event in run.events if event.kind in ("slips", "sticks", "opens")]


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_box_rests_while_some_forces_hold_it(backend: str) -> None:
    """Pulled by 3.8 N at a weight of 10 N: 0.38 is below the static friction of 0.4, if the corners share."""
    run = _box(WEIGHT + "  force push = min(time/(1 [s]), 1)*3.8 [N]*world.x at box;\n", backend, 5.0, mu=0.2)
    assert run.status == "ok" and _told(run) == [] and np.all(run["x"] == 0.0) and np.all(run["a"] == 0.0)
    first, second = run.final["N[1]"], run.final["N[2]"]  # the torque 0.38 N m is balanced by 0.2 m (N2 - N1)
    assert first == pytest.approx(4.05, abs=1e-12) and second == pytest.approx(5.95, abs=1e-12)


@pytest.mark.sample(1)
@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(("mu", "mu_s"), [(0.3, 0.3), (0.2, 0.4)])
def test_a_box_that_is_pushed_slips_once_at_its_limit(backend: str, mu: float, mu_s: float) -> None:
    """F = t 1 N/s: both corners slip where t = mu_s m g, and v = ((t^2 - t0^2)/2 - mu m g (t - t0))/m
    then."""
    run = _box(WEIGHT + "  force push = 1 [N/s]*time*world.x at box;\n", backend, 5.0, mu=mu, mu_s=mu_s)
    t0 = 10.0 * mu_s
    assert _told(run) == ["corner[1] slips", "corner[2] slips"]
    assert [event.t for event in run.events] == pytest.approx([t0, t0], rel=1e-9)
    speed = (25.0 - t0 * t0) / 2.0 - 10.0 * mu * (5.0 - t0)
    assert run.final["der(x)"] == pytest.approx(speed, rel=1e-6)


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_box_slips_on_a_board_that_tilts_at_the_angle_of_friction(backend: str) -> None:
    weight = "  force weight = 9.81 [N]*{sin(1 [deg/s]*time), 0, -cos(1 [deg/s]*time)} at box;\n"
    run = _box(weight, backend, 22.0)
    assert [event.t for event in run.events] == pytest.approx([math.degrees(math.atan(0.4))] * 2, rel=1e-9)
    early = _compiled(BOX + weight + CORNERS, backend).simulate(0.1)
    assert early.status == "ok" and _told(early) == [] and early.final["x"] == 0.0
    assert early.cost.steps < 300  # nothing of the size of round-off controls the steps


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_box_at_rest_under_a_varying_weight_is_in_balance(backend: str) -> None:
    run = _box("  force weight = {1 [N/s]*time, 0, -10 [N] - 0.01 [N/s2]*time^2} at box;\n", backend, 2.0)
    assert run.status == "ok", run.message
    assert not run.events and np.all(run["x"] == 0.0) and np.all(run["der(a)"] == 0.0)


@pytest.mark.parametrize("backend", BACKENDS)
def test_corners_of_different_friction_hold_what_the_better_one_can(backend: str) -> None:
    """Friction 0.6 and 0.2 under a force F at the height of the centre: both corners at their limits bear
    0.6 N1 + 0.2 N2 = F with N1 + N2 = 10 and 0.2 (N2 - N1) = 0.1 F, so F = 40/11."""
    text = CORNERS.replace("friction = mu, static = mu_s", "friction = 1 - 0.4*i")
    push = WEIGHT + "  force push = 1 [N/s]*time*world.x at box;\n"
    run = _compiled(BOX + push + text, backend).simulate(3.7)
    assert run.events[0].t == pytest.approx(40.0 / 11.0, rel=1e-9) and run.events[0].kind == "slips"


BEAD = """model M
  coordinate Length x(rate = 1 [m/s]), z(start = 0);
  body bead = Particle(mass = 1 [kg], at = {x, 0, z});
  Gravity field(g = 10 [m/s2]);
  constraint lower: z >= 0 (friction = 0.2, at = bead);
  constraint upper: z <= 0 (friction = 0.2, at = bead);
  output Force Nl = reaction(lower), Nu = reaction(upper);
end M;"""


@pytest.mark.parametrize("backend", BACKENDS)
def test_of_two_opposite_walls_the_lower_one_bears(backend: str) -> None:
    """It stops after v/(mu g), at v^2/(2 mu g): the upper wall does not pull."""
    run = _compiled(BEAD, backend).simulate(2.0)
    assert run.final["x"] == pytest.approx(0.25, abs=1e-6)
    assert run.final["Nl"] == pytest.approx(10.0, abs=1e-9) and run.final["Nu"] == 0.0
    assert _told(run) == ["lower sticks", "upper sticks"]
    assert [event.t for event in run.events] == pytest.approx([0.5, 0.5], abs=1e-6)


TABLE = """model M
  coordinate Length z(start = 0);
  coordinate Orientation o;
  frame B = rotate(world, o);
  point O = {0, 0, z};
  body top = Solid(mass = 10 [kg], inertia = {1, 1, 1} [kg.m2], frame = B,
                   com = O + 0.6 [m]*B.x + 0.6 [m]*B.y);
  Gravity field(g = 10 [m/s2]);
  point P[1] = O + B.x*1[m] + B.y*1[m];
  point P[2] = O - B.x*1[m] + B.y*1[m];
  point P[3] = O - B.x*1[m] - B.y*1[m];
  point P[4] = O + B.x*1[m] - B.y*1[m];
  for i in 1:4 loop
    constraint foot[i]: P[i].z >= 0;
  end for;
  constraint noyaw: dot(B.x, world.y) = 0;
  output Force N[4] = {reaction(foot[i]) for i in 1:4};
end M;"""


@pytest.mark.parametrize("backend", BACKENDS)
def test_feet_share_a_load_by_the_smallest_forces_that_push(backend: str) -> None:
    """Equilibrium leaves N = (80, 0, 20, 0) + s (-1, 1, -1, 1); 60, 20, 0, 20 is the smallest one >= 0."""
    run = _compiled(TABLE, backend).simulate(1.0)
    shares = [run.final[f"N[{i}]"] for i in (1, 2, 3, 4)]
    assert shares == pytest.approx([60.0, 20.0, 0.0, 20.0], abs=1e-11) and run.final["z"] == 0.0


def body(chance: Any, space: bool, flat: bool) -> tuple[Array, Array, Array, list[tuple[int, int, float]]]:
    """Return rows, inverse masses, a force, and the contacts (first row, slips, friction) of a random body on
    2 to 8 contacts; `flat`: on one plane."""
    d, count = (3, int(chance.integers(3, 9))) if space else (2, int(chance.integers(2, 9)))
    places = chance.uniform(-1.0, 1.0, (count, d))
    places[:, -1] = -0.5 if flat else chance.uniform(-1.0, -0.1, count)
    rows = []
    for place in places:
        for axis in (np.eye(d)[-1], *np.eye(d)[:-1]):
            turn = np.cross(place, axis) if space else [place[0] * axis[1] - place[1] * axis[0]]
            rows.append(np.concatenate([axis, turn]))
    m, n = chance.uniform(0.5, 5.0), len(rows[0])
    masses = np.concatenate([np.full(d, m), chance.uniform(0.1, 1.0, n - d)])
    force = np.zeros(n)
    force[d - 1] = -10.0 * m
    force[: d - 1] = chance.normal(size=d - 1) * 1.5 * m
    force[d:] = chance.normal(size=n - d) * m
    contacts = [(d * i, d - 1, float(chance.uniform(0.1, 1.0))) for i in range(count)]
    return np.array(rows), 1.0 / masses, force, contacts


def margin(rows: Array, force: Array, contacts: Sequence[tuple[int, int, float]], sides: int = 360) -> float:
    """Return the largest margin t, up to the weight, with mu p_n - |p_t| >= t for forces that balance the
    load, by linear programming: exact in the plane, and in space with polygons inside of the cones."""
    n = rows.shape[0]
    bounds, inner = [], math.cos(math.pi / sides)
    for first, slips, mu in contacts:
        angles = (0.0, math.pi) if slips == 1 else np.arange(sides) * 2.0 * math.pi / sides
        for angle in angles:
            row = np.zeros(n + 1)
            row[first], row[n] = -mu * (1.0 if slips == 1 else inner), 1.0
            row[first + 1] = math.cos(angle)
            if slips == 2:
                row[first + 2] = math.sin(angle)
            bounds.append(row)
    cost = np.append(np.zeros(n), -1.0)
    balance, ends = np.hstack([rows.T, np.zeros((rows.shape[1], 1))]), [*[(None, None)] * n]
    most = float(np.max(np.abs(force)))
    found = linprog(cost, np.array(bounds), np.zeros(len(bounds)), balance, -force, [*ends, (None, most)])
    return float(found.x[n]) if found.status == 0 else -math.inf


def check(kernels: dict[str, Any], chance: Any, space: bool, flat: bool) -> bool:
    """Solve the law of a random body. Return whether the contacts can hold it; they rest if they can, by
    forces in their cones, and never if they cannot."""
    rows, inverse, force, contacts = body(chance, space, flat)
    W, b = (rows * inverse) @ rows.T, (rows * inverse) @ force
    work = kernels["make"]()
    fill(work, W, b, [slips for _, slips, _ in contacts], [mu for *_, mu in contacts])
    code, found = kernels["set_law"](work), values(work)
    holds, size = margin(rows, force, contacts), float(np.max(np.abs(force)))
    p, u = found["p"], found["u"]
    moves = float(np.max(np.abs(u))) > 1e-7 * float(np.max(np.abs(b)))
    if code in (ONE, FOUND):
        for first, slips, mu in contacts:
            assert p[first] >= -1e-8 * size
            if found["mode"][first // (slips + 1)] == STICKS:
                aside = np.linalg.norm(p[first + 1 : first + 1 + slips])
                assert aside <= mu * p[first] + 1e-7 * np.max(np.abs(p))
        if not moves:
            assert np.allclose(rows.T @ p, -force, atol=1e-8 * size)
    if holds > 1e-9 * size:
        assert code in (ONE, FOUND) and not moves
    elif holds < -(1e-3 if space else 1e-9) * size:
        assert code not in (ONE, FOUND) or moves
    return holds > 0.0


LADDER = """model Ladder
  parameter Real mu = 0.9;
  coordinate Length x(start = 1 [m]*cos(65 [deg])), y(start = 1 [m]*sin(65 [deg]));
  coordinate Angle phi(start = 65 [deg]);
  frame F = rotate_z(world, -phi);
  body ladder = Solid(mass = 8 [kg], inertia = {0, 1, 1}, frame = F, com = {x, y, 0});
  point A = {x, y, 0} - 1 [m]*F.x;
  point B = {x, y, 0} + 1 [m]*F.x;
  constraint wall: A.x >= 0 (friction = mu, at = A);
  constraint floor: B.y >= 0 (friction = mu, at = B);
  Gravity field(direction = {0, -1, 0});
end Ladder;
"""


@pytest.mark.parametrize("backend", BACKENDS)
def test_forces_that_are_one_choice_of_many_are_named(backend: str) -> None:
    """A ladder that rests on two rough contacts is statically indeterminate; one that slides is not."""
    model = lagc.loads(LADDER).compile(backend=backend)
    resting, sliding = (model.simulate(0.2, parameters={"mu": mu}) for mu in (0.9, 0.1))
    (note,) = [note for note in resting.notes if "one choice of many" in note]
    assert note.endswith("`wall`, `floor`") and resting.open_reactions == ("wall", "floor")
    assert not [note for note in sliding.notes if "one choice of many" in note] and not sliding.open_reactions


@pytest.mark.sample(1)
@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("space", [False, True])
def test_random_bodies_rest_where_some_forces_hold_them(space: bool, seed: int, tmp_path: Path) -> None:
    """400 bodies, of which most rest, against linear programs; in C where there are many."""
    chance, many = np.random.default_rng([seed, space]), seed > 0 and shutil.which("gcc") is not None
    kernels = KERNELS.c(tmp_path) if many else in_python()
    held = [check(kernels, chance, space, bool(k % 2)) for k in range(10 if many else 3)]
    assert any(held)


@pytest.mark.parametrize("moment", [0.0, -1.5])
def test_shares_along_gaps_in_m_and_in_rad_do_not_depend_on_units(moment: float) -> None:
    """A beam on two feet and on a stop of its angle, which push it by 10 N and turn it by `moment`: the same
    forces where lengths are in mm, and equal ones of the feet where the stop is not needed."""
    found = []
    for unit in (1.0, 1000.0):  # gaps of this many in a m
        rows = np.array([[unit, 0.3 * unit], [unit, -0.3 * unit], [0.0, 1.0]])
        W, b = (rows * [1.0, 1.0 / 0.1]) @ rows.T, rows @ [-10.0, -moment / 0.1]
        work = in_python()["make"]()
        fill(work, W, b, [0, 0, 0], [0.0, 0.0, 0.0], unit=[0, 0, 1])
        assert in_python()["set_law"](work) in (ONE, FOUND)
        found.append(values(work)["p"] * [unit, unit, 1.0])
    p = found[0]
    assert found[1] == pytest.approx(p, rel=1e-9)
    assert p[0] + p[1] == pytest.approx(10.0, rel=1e-12) and np.all(p >= 0.0)
    assert 0.3 * (p[0] - p[1]) + p[2] == pytest.approx(moment, abs=1e-12)
    if moment == 0.0:
        assert p == pytest.approx([5.0, 5.0, 0.0], abs=1e-9)


CHAIR = """model Chair
  parameter Angle b = 30 [deg];
  coordinate Length x, y, z(start = 0.5 [m]);
  coordinate Orientation o;
  frame B = rotate(world, o);
  body chair = Solid(mass = 5 [kg], inertia = {0.4, 0.5, 0.6} [kg.m2], frame = B, com = {x, y, z});
  for i in 1:2 loop
    point P[i] = position(chair) + 0.2 [m]*B.x - 0.5 [m]*B.z + (2*i - 3)*0.2 [m]*B.y;
    point Q[i] = position(chair) - 0.9 [m]*B.x - 0.5 [m]*B.z + (2*i - 3)*0.2 [m]*B.y;
    constraint front[i]: P[i].z >= 0 (friction = 0.5, static = 0.6, at = P[i]);
    constraint rear[i]: Q[i].z >= 0 (friction = 0.5, static = 0.6, at = Q[i]);
  end for;
  force weight = 5 [kg]*10 [m/s2]*{-sin(b), 0, -cos(b)} at chair;
end Chair;"""


@pytest.mark.full
@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(("angle", "slides"), [(29.0, False), (30.9, False), (31.0, True)])
def test_a_chair_let_go_on_a_slope_begins_by_static_friction(
    backend: str, angle: float, slides: bool
) -> None:
    """It rests up to atan 0.6 = 30.96 deg, and slides with g (sin b - 0.5 cos b) beyond."""
    b = math.radians(angle)
    run = _compiled(CHAIR, backend).simulate(1.0, parameters={"b": b})
    expected = -5.0 * (math.sin(b) - 0.5 * math.cos(b)) if slides else 0.0
    assert run.status == "ok" and run.final["x"] == pytest.approx(expected, abs=1e-6)
