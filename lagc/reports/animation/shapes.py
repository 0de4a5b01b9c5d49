"""Figures of bodies, from their inertia and the places that are fixed in them.

A figure is plain data: `kind` with its sizes in m, in the axes of the body. `true` tells that the sizes are
those of the body; other figures are only marks. A solid has the shape of equal moments of inertia: a rod of
the length sqrt(12 I/m), a cylinder of the radius sqrt(2 I/m), a box, a ball of the radius sqrt(5/2 I/m).
"""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from lagc.reports.animation.links import Link
from lagc.reports.animation.places import Sample, Solid
from lagc.reports.animation.states import Array
from lagc.semantics.model import Figure, Joint

Shape = dict[str, Any]

MARK = 0.03  # of the size of the mechanism: the radius of a particle
LEAST_MASS = 0.35  # of a mark, that of a very light particle
THICK = 0.35  # of a mark, the radius of a rod
RING = 0.012  # of the size of the mechanism: the thickness of a ring that is declared
EQUAL = 1e-6  # relative, of two moments of inertia


def find_shapes(sample: Sample, links: Sequence[Link], radii: Mapping[int, float]) -> None:
    """Give each body its figure; `radii` are those of particles by their places."""
    mark = MARK * sample.size
    for link in links:
        if link.kind == "rod":
            mark = min(mark, max(0.3 * link.length, 0.004 * sample.size))
    # The radius of a particle grows with the cube root of its mass.
    total = max((b.mass for b in sample.solids), default=1.0) or 1.0
    for body in sample.solids:
        if body.inertia is not None:
            body.shape = _solid(sample, body, body.inertia, mark)
            continue
        share = max(LEAST_MASS, max(body.mass / total, 0.0) ** (1.0 / 3.0))
        radius = radii.get(body.place, mark * share)
        body.shape = {"kind": "sphere", "r": float(radius), "true": body.place in radii}
        slide = next((j for j in sample.model.joints if _guides(j, body)), None)
        if slide is not None and slide.axis is not None:
            axes = _axes_with(sample.values(slide.axis)[:, 0])
            size = [3.6 * mark, 2.4 * mark, 2.4 * mark]
            body.shape = {"kind": "box", "axes": axes.tolist(), "size": size, "true": False}
    _rings(sample)
    for body in sample.solids:
        figures = [f for f in sample.model.figures if f.body == body.name]
        if figures:
            parts = [declared_shape(sample, figure, body) for figure in figures]
            body.shape = parts[0] if len(parts) == 1 else {"kind": "group", "parts": parts, "true": True}


def declared_shape(sample: Sample, figure: Figure, body: Solid | None = None) -> Shape:
    """Return a figure that the model declares, in the axes of its body; without one its axis is y."""
    sizes = [float(x) for x in sample.values(list(figure.sizes))[:, 0]] if figure.sizes else []
    axis = np.array([0.0, 1.0, 0.0])
    if figure.axis is not None and body is not None:
        axis = sample.values(figure.axis)[:, 0]
        axis = axis if body.axes is None else body.axes[:, :, 0].T @ axis
    if figure.kind == "Ball":
        return {"kind": "sphere", "r": sizes[0], "true": True}
    if figure.kind == "Box":
        return {"kind": "box", "axes": np.eye(3).tolist(), "size": sizes, "true": True}
    if figure.kind == "Cylinder":
        return {"kind": "cylinder", "axis": axis.tolist(), "r": sizes[0], "h": sizes[1], "true": True}
    thick = RING * sample.size
    return {"kind": "ring", "axis": axis.tolist(), "r": sizes[0], "thick": thick, "true": True}


def _guides(joint: Joint, body: Solid) -> bool:
    return joint.kind == "Prismatic" and body.name in joint.between and "world" in joint.between


def _axes_with(x: Array) -> Array:
    """Return perpendicular unit vectors as columns, the first one along x."""
    y = np.cross(x, np.eye(3)[np.argmin(np.abs(x))])
    y = y / np.linalg.norm(y)
    return np.column_stack([x, y, np.cross(x, y)])


def _solid(sample: Sample, body: Solid, inertia: Array, mark: float) -> Shape:
    """Return the figure of a solid with inertia."""
    mass, (moments, axes) = body.mass, np.linalg.eigh(inertia)
    if np.linalg.det(axes) < 0.0:
        axes[:, 0] = -axes[:, 0]
    named = [arm for k, arm in body.attached if sample.places[k].kind in ("point", "joint")]
    arms = [arm for arm in named if np.linalg.norm(arm) > 1e-6 * sample.scale]
    rank = np.linalg.matrix_rank(np.array(arms), tol=1e-6 * sample.scale) if arms else 0
    if mass <= 0.0 or moments[2] <= 0.0:
        return {"kind": "sphere", "r": 0.5 * mark, "true": False}
    if len(arms) >= 3 and rank >= 2:
        return {"kind": "hull", "corners": [arm.tolist() for arm in arms], "true": True}
    if moments[0] < EQUAL * moments[2] and abs(moments[1] - moments[2]) < EQUAL * moments[2]:
        length = math.sqrt(12.0 * moments[2] / mass)
        return {"kind": "rod", "axis": axes[:, 0].tolist(), "length": length, "r": THICK * mark, "true": True}
    if sample.normal is not None:
        flat = _flat(sample, body, moments, arms, mark)
        if flat is not None:
            return flat
    return _of_equal_moments(mass, moments, axes, arms, mark)


def _flat(sample: Sample, body: Solid, moments: Array, arms: Sequence[Array], mark: float) -> Shape | None:
    """Return the figure in a plane motion, where only the moment about the normal acts: a rod between two
    places, else a disc. None for a ball without places."""
    assert sample.normal is not None and body.axes is not None and body.inertia is not None
    if abs(moments[0] - moments[2]) <= EQUAL * moments[2] and not arms:
        return None
    axis = body.axes[:, :, 0].T @ sample.normal
    if len(arms) == 2:
        length = float(np.linalg.norm(arms[0] - arms[1]))
        direction = ((arms[0] - arms[1]) / length).tolist()
        return {"kind": "rod", "axis": direction, "length": length, "r": THICK * mark,
                "at": ((arms[0] + arms[1]) / 2.0).tolist(), "true": True}  # fmt: skip
    radius = math.sqrt(2.0 * float(axis @ body.inertia @ axis) / body.mass)
    return {
        "kind": "cylinder",
        "axis": axis.tolist(),
        "r": radius,
        "h": 0.12 * mark,
        "true": False,
        "faint": True,
    }


def _of_equal_moments(mass: float, moments: Array, axes: Array, arms: Sequence[Array], mark: float) -> Shape:
    """Return a ball, a cylinder or a box with these moments; a ball with places inside is faint."""
    for k in range(3):
        a, b = (i for i in range(3) if i != k)
        if abs(moments[a] - moments[b]) >= EQUAL * moments[2]:
            continue
        if abs(moments[k] - moments[a]) < EQUAL * moments[2]:
            radius = math.sqrt(2.5 * moments[0] / mass)
            inside = any(np.linalg.norm(arm) < 0.9 * radius for arm in arms)
            return {"kind": "sphere", "r": radius, "true": not inside, "faint": inside}
        height = math.sqrt(max(12.0 / mass * (moments[a] - moments[k] / 2.0), 0.0))
        return {"kind": "cylinder", "axis": axes[:, k].tolist(), "r": math.sqrt(2.0 * moments[k] / mass),
                "h": max(height, 0.3 * mark), "true": True}  # fmt: skip
    sides = [math.sqrt(max(6.0 / mass * (moments.sum() - 2.0 * x), 0.0)) for x in moments]
    return {"kind": "box", "axes": axes.tolist(), "size": [max(x, 0.3 * mark) for x in sides], "true": True}


def _rings(sample: Sample) -> None:
    """Make rings of solids that two joints hold by crossing axes through the centre (gimbals): in the plane
    of the axes, around all that they carry."""
    hinges: dict[str, list[Joint]] = {}
    for joint in sample.model.joints:
        if joint.kind == "Revolute" and joint.axis is not None and joint.at is not None:
            for end in joint.between:
                hinges.setdefault(end, []).append(joint)
    reach: dict[str, float] = {}
    # From the innermost body out: a ring is as large as all that it carries.
    for body in reversed(sample.solids):
        joints = hinges.get(body.name, [])
        carried = [reach.get(j.between[1], 0.0) for j in joints]
        reach[body.name] = max([_reach(body.shape), *carried])
        axis = _across_hinges(sample, body, joints)
        if axis is None:
            continue
        inner = max([reach.get(j.between[1], 0.0) for j in joints if j.between[0] == body.name], default=0.0)
        radius = 1.18 * (inner or reach[body.name])
        body.shape = {
            "kind": "ring",
            "axis": axis.tolist(),
            "r": radius,
            "thick": 0.05 * radius,
            "true": False,
        }
        reach[body.name] = 1.08 * radius


def _across_hinges(sample: Sample, body: Solid, joints: Sequence[Joint]) -> Array | None:
    """Return the normal of the axes of two joints, in the frame of the body, if they cross in its centre."""
    if len(joints) < 2 or body.inertia is None or body.axes is None:
        return None
    here = body.axes[:, :, 0]
    for joint in joints:
        assert joint.at is not None
        if not np.allclose(sample.values(joint.at), sample.x[body.place], atol=1e-9 * sample.scale):
            return None
    one, other = (here.T @ sample.values(j.axis)[:, 0] for j in joints[:2] if j.axis is not None)
    across = np.cross(one, other)
    size = float(np.linalg.norm(across))
    if size <= 0.3:
        return None
    unit: Array = across / size
    return unit


def _reach(shape: Mapping[str, Any]) -> float:
    if shape.get("kind") == "sphere":
        return float(shape["r"])
    if shape.get("kind") == "cylinder":
        return math.hypot(shape["r"], shape["h"] / 2.0)
    return 0.0
