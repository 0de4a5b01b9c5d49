"""The scene that a model implies, against what its author drew on paper. The gallery of the documents against
the library."""

import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import lagc
from lagc.host.model_library import library_models

ROOT = Path(__file__).resolve().parents[2]

# links by kind, surfaces by kind, springs and dampers, pins, whether the motion is plane, up
SCENES: dict[str, tuple[dict[str, int], dict[str, int], dict[str, int], int, bool, str]] = {
    "course/simple_pendulum": ({"rod": 1}, {}, {}, 0, True, "z"),
    "classic/double_pendulum": ({"rod": 2}, {}, {}, 0, True, "z"),
    "classic/elastic_pendulum": ({}, {}, {"spring": 1}, 0, True, "z"),
    "contact/newtons_cradle": ({"rod": 5}, {}, {}, 0, True, "z"),
    "contact/tumbling_box": ({}, {"plane": 1}, {}, 0, True, "y"),
    "contact/bouncing_ball": ({}, {"plane": 1}, {}, 0, True, "y"),
    "contact/roll_off_sphere": ({}, {"sphere": 1}, {}, 0, True, "y"),
    "contact/slack_rope": ({"string": 1}, {}, {}, 0, True, "z"),
    "classic/rolling_disc": ({}, {"plane": 1}, {}, 0, False, "z"),
    "classic/two_bodies_on_a_spring": ({}, {}, {"spring": 1}, 0, False, "z"),
    "classic/kepler": ({}, {}, {}, 0, True, "y"),
}


def counted(kinds: list[str]) -> dict[str, int]:
    return {kind: kinds.count(kind) for kind in sorted(set(kinds))}


@pytest.mark.sample(4)
@pytest.mark.parametrize("name", SCENES)
def test_scenes(name: str) -> None:
    links, surfaces, springs, pins, is_plane, up = SCENES[name]
    scene = lagc.load(name).compile(backend="numpy").simulate(stop=2.0, points=101, method="dop853").scene()
    assert counted([link.kind for link in scene.links if link.kind != "spoke"]) == links
    assert counted([row.kind for row in scene.surfaces]) == surfaces
    assert counted([link.kind for link in scene.springs]) == springs
    assert len(scene.rows.pins) == pins
    assert (scene.normal is not None) == is_plane
    assert np.allclose(np.abs(scene.up), np.eye(3)["xyz".index(up)])


def solid(inertia: str) -> Any:
    text = (
        "model M\n  parameter Mass m = 2 [kg];\n  coordinate Length x(rate = 1 [m/s]);\n"
        "  coordinate Orientation o;\n  frame B = rotate(world, o);\n"
        f"  body b = Solid(mass = m, inertia = {inertia}, frame = B, com = {{x, 0, 0}});\nend M;\n"
    )
    run = lagc.loads(text).compile(backend="numpy").simulate(stop=1.0, points=11, method="rk4", step=0.1)
    (body,) = run.scene().bodies
    return body.shape


def test_figures_have_the_moments_of_inertia_of_the_solid() -> None:
    """The moments of a homogeneous rod, cylinder, ball and box of 2 kg, from their sizes."""
    m, r, h, length = 2.0, 0.3, 0.8, 1.5
    rod = solid(
        f"{{1e-9, {m * length**2 / 12}, {m * length**2 / 12}}}"
    )  # none about its axis is not a regular inertia
    assert rod["kind"] == "rod" and rod["length"] == pytest.approx(length)
    across = m * (3 * r * r + h * h) / 12
    cylinder = solid(f"{{{across}, {across}, {m * r * r / 2}}}")
    assert cylinder["kind"] == "cylinder" and np.abs(cylinder["axis"]) == pytest.approx([0, 0, 1], abs=1e-9)
    assert (cylinder["r"], cylinder["h"]) == pytest.approx((r, h))
    ball = solid(f"{{{0.4 * m * r * r}, {0.4 * m * r * r}, {0.4 * m * r * r}}}")
    assert ball["kind"] == "sphere" and ball["r"] == pytest.approx(r)
    a, b, c = 0.2, 0.5, 0.9
    moments = [m / 12 * (y * y + z * z) for y, z in ((b, c), (c, a), (a, b))]
    box = solid(f"{{{moments[0]}, {moments[1]}, {moments[2]}}}")
    axes = np.abs(np.array(box["axes"]))
    assert box["kind"] == "box" and sorted(box["size"]) == pytest.approx([a, b, c])
    assert axes @ np.array(box["size"]) == pytest.approx([a, b, c])


def test_gravity_in_any_direction_is_found() -> None:
    text = (
        "model M\n  parameter Mass m = 3 [kg];\n  coordinate Length x, y, z;\n"
        "  body b = Particle(mass = m, at = {x, y, z});\n"
        "  potential V = -m*(2 [m/s2]*x - 6 [m/s2]*y + 3 [m/s2]*z);\nend M;\n"
    )
    scene = lagc.loads(text).compile(backend="numpy").simulate(stop=1.0, points=11, method="dop853").scene()
    assert scene.sample.gravity == pytest.approx([2.0, -6.0, 3.0])
    assert scene.up == pytest.approx([-2 / 7, 6 / 7, -3 / 7])


def test_an_attraction_is_no_spring() -> None:
    text = (
        "model M\n  parameter Mass m = 1 [kg];\n"
        "  coordinate Length x(start = 1 [m]), y(start = 0.2 [m], rate = 1 [m/s]);\n"
        "  point O = {0, 0, 0};\n  body b = Particle(mass = m, at = {x, y, 0});\n"
        "  parameter Real k = 1;\n  potential V = SPRING;\nend M;\n"
    )
    for energy, count in (
        ("-k*1 [J.m]/norm(position(b) - O)", 0), ("0.5*k*1 [N/m]*(norm(position(b) - O) - 0.4 [m])^2", 1),
        ("0.5*k*1 [N/m]*(norm(position(b) - O) - 0.4 [m])^2 + m*9.81 [m/s2]*y", 1),
    ):  # fmt: skip
        run = (
            lagc.loads(text.replace("SPRING", energy)).compile(backend="numpy").simulate(stop=1.0, points=51)
        )
        assert len(run.scene().springs) == count, energy


def test_a_scene_does_not_depend_on_names_or_order() -> None:
    """The double pendulum with its declarations in another order and other names has the same rods."""
    text = (ROOT / "models/classic/double_pendulum.lag").read_text()
    renamed = re.sub(r"\bbob2\b", "aaa", text)
    assert renamed != text

    def drawn(source: str, names: dict[str, str]) -> set[Any]:
        scene = (
            lagc.loads(source).compile(backend="numpy").simulate(stop=1.0, points=51, method="dop853").scene()
        )
        place = scene.places
        ends = [{names.get(place[i].name, place[i].name) for i in (link.a, link.b)} for link in scene.links]
        return {(frozenset(pair), round(link.length, 9)) for pair, link in zip(ends, scene.links)}

    assert drawn(text, {}) == drawn(renamed, {"aaa": "bob2"})


@pytest.mark.full
@pytest.mark.parametrize("name", library_models())
def test_every_library_model_has_a_scene_with_all_its_bodies(name: str) -> None:
    system = lagc.load(name).compile(backend="numpy")
    stop = system.interface.simulate.get("stop", 10.0)
    run = system.simulate(min(stop, 2.0) if stop < 1e3 else stop, points=51, method="dop853", rtol=1e-6)
    scene = run.scene()
    assert [body.name for body in scene.bodies] == [body.name for body in system.model.bodies]
    assert all(body.shape["kind"] for body in scene.bodies)
    assert math.isfinite(scene.size) and scene.size > 0.0 and math.isfinite(scene.scale)
    assert np.linalg.norm(scene.up) == pytest.approx(1.0)
    count = len(scene.places)
    for link in (*scene.links, *scene.springs):
        assert 0 <= link.a < count and 0 <= link.b < count and link.a != link.b


@pytest.mark.parametrize("name", ["course/disc_on_a_slope_explicit", "contact/billiard"])
def test_a_plane_is_drawn_where_a_round_solid_touches_it(name: str) -> None:
    """The gap is written for the centre, at the distance of the radius from the plane through the origin."""
    scene = lagc.load(name).compile(backend="numpy").simulate(stop=0.2, points=21, method="dop853").scene()
    assert [row.c for row in scene.surfaces if row.kind == "plane"] == [0.0]


DOCS = Path(__file__).resolve().parents[2] / "docs"
MOST_BYTES = 100_000  # of a picture: the repository stays light


def test_the_gallery_has_every_model_of_the_library_once() -> None:
    text = (DOCS / "gallery.md").read_text(encoding="utf-8")
    named = re.findall(r"^\*\*\[(\S+)\]\(\.\./models/(\S+)\.lag\)\*\*", text, re.MULTILINE)
    assert [name for name, _ in named] == [path for _, path in named] == library_models()


def test_its_pictures_are_there_and_small() -> None:
    text = (DOCS / "gallery.md").read_text(encoding="utf-8")
    pictures = re.findall(r"!\[.*?\]\((\S+)\)", text)
    assert {Path(picture).stem for picture in pictures} == {
        name.partition("/")[0] for name in library_models()
    }
    assert all(0 < (DOCS / picture).stat().st_size < MOST_BYTES for picture in pictures)
