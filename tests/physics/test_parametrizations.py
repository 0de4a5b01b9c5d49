"""Two parametrizations of one system move alike: constraints written into the coordinates
(implicit) and constraints with multipliers (explicit), angles and Cartesian coordinates,
rates and quasi-speeds.  Neither is derived from the other."""

import math
from collections.abc import Callable

import pytest

import lagc

ACCURACY = 1e-9
Map = Callable[[dict[str, float], float], dict[str, float]]


def _same(*names: str) -> Map:
    return lambda f, t: {n: f[n] for n in names}


def _disc(f: dict[str, float], t: float) -> dict[str, float]:
    return {"x": f["x"], "theta": f["theta"], "y": f["y"], "E": f["E"]}


def _string(f: dict[str, float], t: float) -> dict[str, float]:
    return {"theta": math.atan2(f["x"], -f["z"]), "E": f["E"]}


def _spherical(f: dict[str, float], t: float) -> dict[str, float]:
    return {"theta": math.acos(-f["z"] / math.hypot(f["x"], f["y"], f["z"])), "z": f["z"], "E": f["E"]}


def _double(f: dict[str, float], t: float) -> dict[str, float]:
    dx, dz = f["x2"] - f["x1"], f["z2"] - f["z1"]
    return {"theta1": math.atan2(f["x1"], -f["z1"]), "theta2": math.atan2(dx, -dz), "E": f["E"]}


_ANGLES = _same("theta", "z", "E")
_DISC = _same("s", "phi", "slip", "E")
_BEAD = _same("theta", "E")
_LADDER = _same("theta", "E")
_SLEIGH = _same("x", "y", "theta", "side")
_SLIDE = _same("x", "y", "E")
_ON_SPHERE = _same("x", "y", "N", "E")
_ON_WALL = _same("x", "y", "theta", "W", "E")
_SPHERE = _same("x", "y", "psi", "theta", "phi")
_TUBE = _same("x", "y", "r", "N")
_TWO_ANGLES = _same("theta1", "theta2", "E")
_WEDGE = _same("X", "x", "y", "E")
_WHEEL = _same("x", "theta")

PAIRS: list[tuple[str, str, float, Map, Map]] = [
    ("course/string_pendulum", "course/simple_pendulum", 10.0, _string, _same("theta", "E")),
    ("course/string_pendulum", "course/pendulum_tension", 3.0, _same("tension"), _same("tension")),
    ("course/disc_on_a_line_explicit", "course/disc_on_a_line_implicit", 5.0, _disc, _disc),
    ("course/wheel_explicit", "course/wheel_implicit", 5.0, _WHEEL, _WHEEL),
    ("course/wheel_rolling_explicit", "course/wheel_rolling_implicit", 5.0, _WHEEL, _WHEEL),
    ("course/sphere_on_a_plane_explicit", "course/sphere_on_a_plane_implicit", 5.0, _SPHERE, _SPHERE),
    ("course/moving_slide_explicit", "course/moving_slide_implicit", 1.0, _SLIDE, _SLIDE),
    ("course/rough_tube_explicit", "course/rough_tube_implicit", 1.0, _TUBE, _TUBE),
    ("course/rough_wedge_explicit", "course/rough_wedge_implicit", 0.5, _WEDGE, _WEDGE),
    ("course/leaving_sphere_explicit", "course/leaving_sphere_implicit", 0.3, _ON_SPHERE, _ON_SPHERE),
    ("course/leaving_wall_explicit", "course/leaving_wall_implicit", 0.5, _ON_WALL, _ON_WALL),
    ("course/disc_on_a_slope_explicit", "course/disc_on_a_slope_implicit", 1.0, _DISC, _DISC),
    ("classic/bead_on_hoop", "classic/bead_on_hoop_angle", 5.0, _BEAD, _BEAD),
    ("classic/spherical_pendulum", "classic/spherical_pendulum_angles", 5.0, _spherical, _ANGLES),
    ("classic/double_pendulum_explicit", "classic/double_pendulum", 2.0, _double, _TWO_ANGLES),
    ("classic/sliding_ladder_explicit", "classic/sliding_ladder_implicit", 1.5, _LADDER, _LADDER),
    ("classic/chaplygin_sleigh", "classic/chaplygin_sleigh_speeds", 5.0, _SLEIGH, _SLEIGH),
]  # fmt: skip


@pytest.mark.sample(2)
@pytest.mark.parametrize(("first", "second", "stop", "seen1", "seen2"), PAIRS, ids=[p[1] for p in PAIRS])
def test_pair_moves_alike(first: str, second: str, stop: float, seen1: Map, seen2: Map) -> None:
    found = []
    for name, seen in ((first, seen1), (second, seen2)):
        run = lagc.load(name).compile().simulate(stop, accuracy=ACCURACY / 10, points=2)
        assert run.status == "ok", run.message
        found.append(seen(run.final, stop))
    one, two = found
    assert one.keys() == two.keys()
    for name in one:
        scale = max(1.0, abs(two[name]))
        difference = one[name] - two[name]
        if name.startswith("theta"):
            difference = math.remainder(difference, 2.0 * math.pi)
        assert abs(difference) <= ACCURACY * scale, (name, one[name], two[name])


def test_disc_rolls_alike_with_its_height_built_in() -> None:
    """What is left of the vertical row of rolling is 0 = 0 then, and bears nothing."""
    disc = lagc.load("rolling_disc").source.text
    built_in = disc.replace("y, z(start = r*cos(lean0));", "y;").replace(
        "G = {x, y, z}", "G = {x, y, r*cos(lean)}"
    )
    built_in = built_in.replace("  constraint touch: z = r*cos(lean);\n", "")
    built_in = built_in.replace("  output", "  output Force up = reaction(roll)[3];\n  output")
    one, two = (
        lagc.loads(text).compile(backend="numpy").simulate(2.0, accuracy=ACCURACY / 10, points=2).final
        for text in (disc, built_in)
    )
    assert two.pop("up") == 0.0 and len(two) == len(one) - 2  # z and its rate
    for name, value in two.items():
        assert abs(one[name] - value) <= ACCURACY * max(1.0, abs(value)), name
