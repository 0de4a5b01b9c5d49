"""Films and pictures of a scene by matplotlib: .gif, .mp4, and the pictures of a gallery.

The drawing has two dimensions: outlines are hulls of projected points, drawn from the back to the front.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from lagc.reports.animation.frames import Frames
from lagc.reports.animation.links import Link
from lagc.reports.animation.places import Solid
from lagc.reports.animation.scene import Scene
from lagc.reports.animation.shown import Shown
from lagc.reports.animation.states import Array, values
from lagc.reports.animation.surfaces import Row
from lagc.reports.plots.plot import COLORS as PALETTE

if TYPE_CHECKING:
    from matplotlib.axes import Axes

COLORS = (*PALETTE[:6], "#8f6bb3", "#7f7f7f")
ENDINGS = (".gif", ".mp4")
EDGE, GREY, WOOD, GREEN, GROUND, DARK = "#101418", "#79828c", "#b08d57", "#2e9e5b", "#8f9aa6", "#3c444d"
ARROWS = {"weight": "#8a8f98", "load": "#e69f00", "reaction": "#d81b60"}
FRAMES_PER_SECOND = 25
MOST_PICTURES, FEW_PICTURES = 250, 50  # of a film
MOST_NAMED = 12  # bodies: of more, only the path of the last one is drawn


class Camera:
    """A parallel projection: the axes `x` and `y` of the picture, and `z` towards the eye."""

    def __init__(self, scene: Scene):
        up = scene.up
        if scene.normal is not None:
            z = scene.normal
        else:
            if abs(up[2]) > 0.9:
                side = np.array([0.45, -np.sign(up[2]), 0.0])
            else:
                side = np.array([0.45, 0.0, 1.0]) if abs(up[1]) > 0.9 else np.array([0.0, 0.45, 1.0])
            z = side / np.linalg.norm(side) + 0.42 * up
            z = z / np.linalg.norm(z)
        y = up - (up @ z) * z
        self.y, self.z = y / np.linalg.norm(y), z
        self.x = np.cross(self.y, self.z)

    def __call__(self, points: Any) -> Array:
        """Return points (n, 3) in the picture, (n, 2)."""
        p = np.asarray(points, float)
        return np.stack([p @ self.x, p @ self.y], axis=-1)

    def point(self, p: Any) -> tuple[float, float]:
        """Return one point in the picture."""
        x, y = self(p)
        return float(x), float(y)


def rotation(q: Array) -> Array:
    """Return the rotation matrix of a unit quaternion w x y z."""
    w, x, y, z = q
    return np.array(
        [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
         [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
         [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]
    )  # fmt: skip


def parts_of(shape: Mapping[str, Any]) -> Sequence[Mapping[str, Any]]:
    """Return the figures that a body consists of."""
    parts: Sequence[Mapping[str, Any]] = shape.get("parts", (shape,))
    return parts


def outline(shape: Mapping[str, Any]) -> Array:
    """Return points in the axes of the body whose hull is its outline, (n, 3)."""
    kind = shape["kind"]
    found: Array
    if kind == "hull":
        found = np.array(shape["corners"], float)
        return found
    if kind == "box":
        corners = np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)])
        found = corners * np.array(shape["size"]) / 2.0 @ np.array(shape["axes"]).T
        return found
    axis = np.array(shape["axis"])
    one = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    one = one / np.linalg.norm(one)
    turn = np.linspace(0.0, 2.0 * math.pi, 37)
    rim = shape["r"] * (np.outer(np.cos(turn), one) + np.outer(np.sin(turn), np.cross(axis, one)))
    half = (shape.get("h") or shape.get("length") or 0.0) / 2.0 * axis
    found = np.concatenate([rim + half, rim - half]) + np.array(shape.get("at", (0.0, 0.0, 0.0)))
    return found


def hull(points: Array) -> Array:
    """Return the convex hull of points in the plane (A. M. Andrew, 1979)."""
    p = sorted(set(map(tuple, np.round(points, 12).tolist())))
    if len(p) < 3:
        return np.array(p)
    sides: list[tuple[float, ...]] = []
    for row in (p, p[::-1]):
        side: list[tuple[float, ...]] = []
        for c in row:
            while len(side) > 1 and not _turns_left(side[-2], side[-1], c):
                side.pop()
            side.append(c)
        sides += side[:-1]
    return np.array(sides)


def _turns_left(a: Sequence[float], b: Sequence[float], c: Sequence[float]) -> bool:
    return (b[0] - a[0]) * (c[1] - a[1]) > (b[1] - a[1]) * (c[0] - a[0])


class Drawing:
    """The drawing of frame i into axes of matplotlib. Parts are kept by their depth, and drawn from the back
    to the front."""

    def __init__(self, axes: Axes, scene: Scene, frames: Frames, i: int, camera: Camera, faint: float = 1.0):
        self.axes, self.scene, self.frames, self.i = axes, scene, frames, i
        self.camera, self.faint = camera, faint
        self.parts: list[tuple[float, Callable[[], object]]] = []

    def draw(self, surfaces: bool = True) -> None:
        for row in self.scene.surfaces if surfaces else ():
            self._surface(row)
        for k, body in enumerate(self.scene.bodies):
            self._path(k, body)
            self._body(COLORS[k % len(COLORS)] if len(self.scene.bodies) <= MOST_NAMED else COLORS[0], body)
        for figure in self.scene.figures:
            axis = (
                None
                if figure.axis is None
                else values(figure.axis, self.frames.symbol_values, len(self.frames.t))
            )
            shape = figure.shape if axis is None else {**figure.shape, "axis": axis[:, self.i].tolist()}
            self._figure(GREY, self.frames.p[figure.place, :, self.i], np.eye(3), shape)
        # Bodies, figures and links enter `parts` with their depth; marks lie above all of them.
        for link in (*self.scene.links, *self.scene.springs):
            self._link(link)
        for _, put in sorted(self.parts, key=lambda part: part[0]):
            put()
        for i in self.scene.feet if surfaces else ():
            self.axes.plot(*self._flat(i), "s", color=DARK, ms=4, zorder=4)
        for i in self.scene.hinges:
            self.axes.plot(*self._flat(i), "o", color=DARK, ms=3, zorder=4)

    def forces(self, shown: Shown, scale: float) -> None:
        """Draw loads and reactions, `scale` m for each N."""
        for arrow in shown.arrows:
            tip = arrow.v[:, self.i] * scale
            if (
                arrow.kind != "weight"
                and np.isfinite(tip).all()
                and np.linalg.norm(tip) > 0.01 * self.scene.size
            ):
                foot = arrow.p[:, self.i]
                a, b = self.camera.point(foot), self.camera.point(foot + tip)
                style = {
                    "arrowstyle": "-|>",
                    "color": ARROWS[arrow.kind],
                    "lw": 1.1,
                    "shrinkA": 0,
                    "shrinkB": 0,
                }
                self.axes.annotate("", b, a, arrowprops=style, zorder=6)

    def _flat(self, place: int) -> Array:
        return self.camera(self.frames.p[place, :, self.i])

    def _surface(self, row: Row) -> None:
        from matplotlib.patches import Circle, Polygon

        sample = self.scene.sample
        if row.kind == "sphere":
            self.axes.add_patch(Circle(self.camera.point(row.at), row.radius, color=GROUND, alpha=0.25, lw=0))
        if row.kind != "plane":
            return
        n, middle = np.array(row.n), (sample.low + sample.high) / 2.0
        foot = middle + n * (row.c - n @ middle)
        one = np.cross(n, sample.normal if sample.normal is not None else np.eye(3)[np.argmin(np.abs(n))])
        if not np.linalg.norm(one):
            return
        one = 0.62 * max(sample.scale, sample.size) * one / np.linalg.norm(one)
        if sample.normal is not None:
            self.axes.plot(*self.camera([foot - one, foot + one]).T, color=GROUND, lw=1.6, zorder=0)
        else:
            other = np.cross(n, one)
            corners = [foot + a * one + b * other for a, b in ((-1, -1), (-1, 1), (1, 1), (1, -1))]
            self.axes.add_patch(Polygon(self.camera(corners), fc=GROUND, ec="none", alpha=0.22, zorder=0))

    def _path(self, k: int, body: Solid) -> None:
        bodies = self.scene.bodies
        if (len(bodies) > MOST_NAMED and k < len(bodies) - 1) or not self.scene.sample.moves(body.place):
            return
        color, path = COLORS[k % len(COLORS)], self.camera(self.frames.p[body.place].T)
        self.axes.plot(*path.T, color=color, lw=0.7, alpha=0.3 * self.faint, zorder=1)
        self.axes.plot(*path[: self.i + 1].T, color=color, lw=0.9, alpha=0.9 * self.faint, zorder=1)

    def _body(self, color: str, body: Solid) -> None:
        turn = rotation(self.frames.q[body.place][self.i]) if body.place in self.frames.q else np.eye(3)
        for shape in parts_of(body.shape):
            self._figure(color, self.frames.p[body.place, :, self.i], turn, shape)

    def _figure(self, color: str, at: Array, turn: Array, shape: Mapping[str, Any]) -> None:
        """Draw a figure with its centre and its rotation."""
        from matplotlib.patches import Circle, Patch, Polygon

        patch: Patch
        alpha = self.faint * (0.4 if shape.get("faint") else 0.95)
        if shape["kind"] == "sphere":
            patch = Circle(self.camera.point(at), shape["r"], fc=color, ec=EDGE, lw=0.5, alpha=alpha)
        elif shape["kind"] == "ring":
            rim = self.camera(outline({**shape, "h": 0.0})[:37] @ turn.T + at)
            patch = Polygon(rim, closed=True, fill=False, ec=color, lw=3, alpha=self.faint)
        else:
            edge = hull(self.camera(outline(shape) @ turn.T + at))
            patch = Polygon(edge, fc=color, ec=EDGE, lw=0.6, alpha=alpha)
        depth = float(at @ self.camera.z)
        self.parts.append((depth, lambda: self.axes.add_patch(patch)))
        if shape["kind"] == "cylinder":  # a diameter shows the turn
            mark = self.camera(outline({**shape, "h": 0.0})[[0, 18]] @ turn.T + at)
            self.parts.append((depth, lambda: self.axes.plot(*mark.T, color=EDGE, lw=0.8, zorder=3)))

    def _link(self, link: Link) -> None:
        a, b = self.frames.p[link.a, :, self.i], self.frames.p[link.b, :, self.i]
        line, size = self.camera([a, b]), self.scene.size
        style: dict[str, Any] = {"color": GREY, "lw": 1.8, "alpha": self.faint}
        if link.kind in ("string", "line"):
            style.update(color=WOOD, lw=1.0)
        elif link.kind == "damper":
            style.update(lw=3.0, alpha=0.5 * self.faint)
        elif link.kind == "spring":
            s, along = np.linspace(0.0, 1.0, 80), line[1] - line[0]
            across = np.array([-along[1], along[0]]) / (np.linalg.norm(along) or 1.0) * 0.03 * size
            wave = np.sin(18.0 * math.pi * s) * np.minimum(1.0, 10.0 * np.minimum(s, 1.0 - s))
            line = np.outer(1.0 - s, line[0]) + np.outer(s, line[1]) + np.outer(wave, across)
            style.update(color=GREEN, lw=1.0)
        depth = float((a + b) @ self.camera.z) / 2.0
        self.parts.append((depth - 1e-6 * size, lambda: self.axes.plot(*line.T, zorder=2, **style)))


def set_limits(axes: Axes, shown: Sequence[Frames], camera: Camera) -> None:
    """Set the limits of axes, equal in both directions, to hold the whole motion."""
    axes.set_aspect("equal")
    axes.set_axis_off()
    scene = shown[0].scene
    places = [*(body.place for body in scene.bodies), *scene.feet]
    p = np.concatenate([camera(frames.p[i].T) for frames in shown for i in places if i < len(frames.p)])
    p = p[np.isfinite(p).all(axis=1)]
    reach = 0.06 * scene.size
    for shape in [
        *(part for body in scene.bodies for part in parts_of(body.shape)),
        *(f.shape for f in scene.figures),
    ]:
        round_ = shape["kind"] == "sphere"
        reach = max(reach, shape["r"] if round_ else float(np.abs(outline(shape)).max()))
    low, high = p.min(axis=0) - 1.1 * reach, p.max(axis=0) + 1.1 * reach
    grow = 0.05 * float((high - low).max())
    axes.set_xlim(low[0] - grow, high[0] + grow)
    axes.set_ylim(low[1] - grow, high[1] + grow)


def force_scale(shown: Shown) -> float:
    """Return m for each N: nearly all arrows are shorter than a fifth of the mechanism."""
    sizes = [np.linalg.norm(arrow.v, axis=0) for arrow in shown.arrows if arrow.kind != "weight"]
    lengths = np.concatenate(sizes) if sizes else np.zeros(0)
    lengths = lengths[np.isfinite(lengths) & (lengths > 0.0)]
    return 0.2 * shown.scene.size / float(np.quantile(lengths, 0.95)) if len(lengths) else 0.0


def check_film(path: str) -> None:
    """Raise ImportError if the packages that a film needs are missing."""
    from shutil import which

    from lagc.host.packages import PICTURES, is_installed

    ending = os.path.splitext(path)[1].lower()
    if not (is_installed("matplotlib") and is_installed("PIL")):
        raise ImportError(PICTURES)
    if ending == ".mp4" and which("ffmpeg") is None:
        raise ImportError("an .mp4 needs the program ffmpeg; a .gif does without")


def film(shown: Shown, path: str) -> None:
    """Write a film of the run into the file `path`, by its ending: .gif or .mp4. Its speed is the real one
    for runs of 2 to 10 s. Raises ImportError if a package is missing, OSError."""
    check_film(path)
    from matplotlib.animation import AbstractMovieWriter, FFMpegWriter, FuncAnimation, PillowWriter
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6.0, 4.5), dpi=90)
    axes = figure.add_axes((0.01, 0.01, 0.98, 0.92))
    frames, camera, scale = shown.frames, Camera(shown.scene), force_scale(shown)
    count = int(min(MOST_PICTURES, max(FEW_PICTURES, FRAMES_PER_SECOND * frames.t[-1])))
    times = np.linspace(0.0, frames.t[-1], count)
    model = shown.scene.model

    def step(k: int) -> list[Any]:
        axes.clear()
        set_limits(axes, [each for _, each in shown.all_frames], camera)
        # Ghosts first, so that the run itself lies above them.
        for number, (_, each) in enumerate(reversed(shown.all_frames)):
            i = int(np.searchsorted(each.t, times[k], side="right")) - 1
            is_leader = number == len(shown.ghosts)
            drawing = Drawing(axes, each.scene, each, i, camera, 1.0 if is_leader else 0.25)
            drawing.draw(is_leader)
            if is_leader:
                drawing.forces(shown, scale)
        axes.set_title(f"{model.name}, {model.scene}, t = {times[k]:.3g} s", fontsize=9)
        return []

    writer: AbstractMovieWriter = PillowWriter(fps=FRAMES_PER_SECOND)
    if path.lower().endswith(".mp4"):
        writer = FFMpegWriter(fps=FRAMES_PER_SECOND, bitrate=1200)
    FuncAnimation(figure, step, frames=count).save(path, writer=writer)
