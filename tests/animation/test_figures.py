"""Figures that a model declares: their sizes and places, and that nothing else depends on them."""

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import lagc
from lagc.cli.main import main
from lagc.diagnostics.faults import Refused
from tests.animation.pages import Page

LIBRARY = Path(__file__).resolve().parents[2] / "models"
TEXT = """model M
  parameter Length r = 0.2 [m], l = 1 [m];
  coordinate Angle a(start = 1 [rad]), b(start = 0.5 [rad]);
  frame F = rotate_y(world, a);
  body wheel = Solid(mass = 1 [kg], inertia = {1, 2, 1} [kg.m2], frame = F, com = {0, 0, 0});
  body bob = Particle(mass = 1 [kg], at = l*{sin(b), 0, -cos(b)});
  Gravity field;
  FIGURE
end M;
"""


def run_of(figure: str) -> Any:
    system = lagc.loads(TEXT.replace("FIGURE", figure)).compile(backend="numpy")
    return system.simulate(stop=1.0, points=51, method="dop853", rtol=1e-9)


@pytest.mark.parametrize("name", ["atwood_machine", "bead_on_hoop_angle", "bead_on_hoop"])
def test_figures_change_no_code(name: str, tmp_path: Path) -> None:
    text = (LIBRARY / "classic" / f"{name}.lag").read_text()
    without = re.sub(r"  draw .*\n", "", text)
    assert without != text
    written = []
    for k, each in enumerate((text, without)):
        folder = tmp_path / str(k)
        folder.mkdir()
        model = folder / "model.lag"
        model.write_text(each)
        assert main(["build", str(model), "--target", "c", "-o", str(folder), "-q"]) == 0
        written.append({x.name: x.read_bytes() for x in folder.iterdir() if x.suffix == ".c"})
    assert written[0] == written[1]


def test_a_figure_replaces_that_of_its_body() -> None:
    shown = run_of("draw w = Cylinder(on = wheel, axis = F.y, radius = r, length = r/4);").scene()
    wheel, bob = shown.bodies
    assert wheel.shape["kind"] == "cylinder" and np.allclose(wheel.shape["axis"], [0.0, 1.0, 0.0])
    assert (wheel.shape["r"], wheel.shape["h"]) == (0.2, 0.05)
    assert bob.shape["kind"] == "sphere"
    both = run_of(
        "draw w = Box(on = wheel, size = {0.1, 0.2, 0.3} [m]);\n  draw c = Ball(on = wheel, radius = r);"
    )
    assert [part["kind"] for part in both.scene().bodies[0].shape["parts"]] == ["box", "sphere"]


def test_a_ring_replaces_the_rod_to_its_centre() -> None:
    ring = "draw rail = Ring(on = {0, 0, 0}, axis = world.y, radius = RADIUS);"
    assert [x.kind for x in run_of("").scene().links] == ["rod"]
    assert not run_of(ring.replace("RADIUS", "1 [m]")).scene().links
    assert [x.kind for x in run_of(ring.replace("RADIUS", "2 [m]")).scene().links] == ["rod"]


def test_lines_coils_and_planes() -> None:
    scene = run_of(
        "draw rope = Line(bob, {1, 0, 0}, {1, 0, 1});\n"
        "  draw s = Coil(bob, {0, 0, 2});\n"
        "  draw floor = Plane(on = {0, 0, -2}, axis = {0, 0, 3});"
    ).scene()
    assert [x.kind for x in scene.links] == ["rod", "line", "line"]
    assert [x.kind for x in scene.springs] == ["spring"]
    rail = run_of("draw rail = Line({l*{cos(0.1*k), 0, sin(0.1*k)} for k in 0:31});").scene()
    assert [x.kind for x in rail.links] == ["rod"] + 31 * ["line"]
    (plane,) = scene.surfaces
    assert np.allclose(plane.n, [0, 0, 1]) and plane.c == -2.0


def test_places_of_a_page(tmp_path: Path) -> None:
    """The ends of a rope are where the masses are; the axis of a ring turns with the hoop."""
    path = tmp_path / "page.html"
    run = run_of("draw rope = Line(bob, {1, 0, 0});\n  draw ring = Ring({0, 0, 1}, F.x, r);")
    run.animate(str(path))
    page = Page(path.read_text())
    times, data = np.linspace(0.0, 1.0, 23), page.data
    rope = page.path("rope, 0", times, "figure")
    b = np.interp(times, run.t, run["b"])
    closed = np.stack([np.sin(b), 0.0 * b, -np.cos(b)], 1)
    assert np.abs(rope - closed).max() <= data["error"] + 1e-4  # of the interpolation of b
    (figure,) = data["figures"]
    axis = np.stack([page.channel(c, page.n) for c in figure["axis"]], 1)
    a = np.interp(page.t, run.t, run["a"])
    assert np.abs(axis - np.stack([np.cos(a), 0.0 * a, -np.sin(a)], 1)).max() < 1e-4


@pytest.mark.parametrize(
    ("figure", "words"),
    [
        ("draw w = Cylindre(on = wheel);", "did you mean `Cylinder`"),
        ("draw w = r;", "a figure is one of"),
        ("draw w = Ball(on = wheel);", "needs the argument `radius`"),
        ("draw w = Ball(on = wheel, radius = 1 [kg]);", "must be Length"),
        ("draw w = Ball(on = wheel, radius = r*cos(a));", "must not change with time"),
        ("draw w = Box(on = bob, size = {1, 2, 3} [m]);", "a box turns with a solid"),
        ("draw w = Box(on = wheel, size = {1, 2} [m]);", "takes 3 lengths; 2 are given"),
        ("draw w = Line(bob);", "two points or more"),
        ("draw w = Plane(on = bob, axis = world.z);", "must not change with time"),
        ("draw w = Ring(on = bob, axis = {0, 0, 0}, radius = r);", "the zero vector has no direction"),
        ("draw w = Ball(on = velocity(bob)*1 [s], radius = r);", "must not depend on a rate"),
    ],
)
def test_refused(figure: str, words: str) -> None:
    with pytest.raises(Refused) as refused:
        lagc.loads(TEXT.replace("FIGURE", figure)).compile()
    assert words in str(refused.value)
