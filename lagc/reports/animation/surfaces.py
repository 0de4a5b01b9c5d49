"""Surfaces, strings and pins: residuals and gaps as functions of a place, or of the distance of two."""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from lagc.base.records import dataclass, field, replace
from lagc.reports.animation.links import Distances, Link
from lagc.reports.animation.places import EXACT, Sample, positions
from lagc.reports.animation.states import SAMPLES, Array
from lagc.semantics.model import Constraint, Contact
from lagc.symbolic.graph import Node
from lagc.symbolic.walk import symbols

UNCHANGED = 1e-12  # a residual with a smaller range restricts nothing that is drawn


@dataclass(frozen=True, slots=True)
class Row:
    """A residual or gap as geometry. `kind`: plane n.x = c, sphere about `at`, distance of two places, or
    touch, the distance at which two places touch. `slope` is that of the residual by the distance from the
    plane, or by that of the places."""

    kind: str
    name: str
    one_sided: bool
    places: tuple[int, ...]
    slope: float = 0.0
    n: tuple[float, ...] = ()
    c: float = 0.0
    at: tuple[float, ...] = ()
    radius: float = 0.0
    length: float = 0.0

    def as_data(self) -> dict[str, Any]:
        own = (
            {"n": list(self.n), "c": self.c}
            if self.kind == "plane"
            else {"at": list(self.at), "radius": self.radius}
        )
        return {
            "kind": self.kind,
            "name": self.name,
            "one_sided": self.one_sided,
            "places": list(self.places),
            **own,
        }


@dataclass(slots=True)
class Rows:
    """The rows of the constraints and contacts of a model.  `known` by label; `touching` are the places at
    which each contact acts; `pins` are fixed places, or rails with an axis."""

    known: dict[str, Row] = field(default_factory=dict)
    touching: dict[str, list[int]] = field(default_factory=dict)
    surfaces: list[Row] = field(default_factory=list)
    links: list[Link] = field(default_factory=list)
    pins: list[dict[str, Any]] = field(default_factory=list)


def read_rows(sample: Sample, distances: Distances) -> Rows:
    """Return what the constraints and contacts of a model look like."""
    rows = Rows()
    written = [
        (label, c, node) for c in sample.model.constraints for label, node in zip(c.labels, c.residuals)
    ]
    asked: list[tuple[str, Constraint | Contact, Node]] = [*written]
    asked += [(c.label, c, c.gap) for c in sample.model.contacts if not c.normals]
    # Each residual is compared with the places that move: a plane first, since a plane is a sphere of
    # infinite radius, and a distance before a sphere, which it is for a fixed place.
    moving = [i for i in sample.known if sample.moves(i) and np.isfinite(sample.x[i]).all()]
    by_constraint: dict[str, list[Row]] = {}
    for (label, c, node), r in zip(asked, sample.values([node for *_, node in asked]) if asked else ()):
        if not np.isfinite(r).all() or np.ptp(r) < UNCHANGED:
            continue
        found = _plane(sample, moving, r) or _distance(sample, distances, r) or _sphere(sample, moving, r)
        if found is None:
            rows.touching[label] = _bodies_moved_by(sample, node)
            continue
        found = replace(found, name=label, one_sided=isinstance(c, Contact))
        rows.known[label] = found
        by_constraint.setdefault(c.name, []).append(found)
    # Planes of one constraint that meet in a point or a line are a pin or a rail, not surfaces.
    for name, group in by_constraint.items():
        pin = _pin(sample, name, group)
        if pin is not None:
            rows.pins.append(pin)
        else:
            for row in group:
                _sort(sample, rows, row)
    return rows


def _plane(sample: Sample, places: Sequence[int], r: Array) -> Row | None:
    """Return the plane if r is affine in the position of a place."""
    for i in places:
        basis = np.column_stack([sample.x[i].T, np.ones(SAMPLES)])
        fit, *_ = np.linalg.lstsq(basis, r, rcond=1e-9)
        size = float(np.linalg.norm(fit[:3]))
        error = np.abs(basis @ fit - r).max()
        if size > 1e-9 and error < EXACT * (np.abs(r).max() + size * sample.scale):
            n, c = fit[:3] / size, float(-fit[3] / size)
            return Row("plane", "", False, (i,), slope=size, n=tuple(n.tolist()), c=c)
    return None


def _distance(sample: Sample, distances: Distances, r: Array) -> Row | None:
    """Return the pair of places if r is an affine function of their distance, or of its square."""
    for power in (1, 2):
        d = distances.d**power
        with np.errstate(all="ignore"):
            # Two samples give slope and offset for all pairs at once; the others have to agree.
            slope = (r[0] - r[1]) / (d[:, 0] - d[:, 1])
            rest = r[0] - slope * d[:, 0]
            fits = np.abs(slope[:, None] * d + rest[:, None] - r).max(axis=1) < EXACT * np.abs(r).max()
        fits &= np.isfinite(slope) & (np.abs(slope) > 1e-9)
        for k in np.flatnonzero(fits)[:1]:
            length = max(float(-rest[k] / slope[k]), 0.0) ** (1.0 / power)
            if length > 1e-9 * sample.scale:
                ends = (int(distances.i[k]), int(distances.j[k]))
                by_distance = float(slope[k]) * (1.0 if power == 1 else 2.0 * length)
                return Row("distance", "", False, ends, slope=by_distance, length=length)
    return None


def _sphere(sample: Sample, places: Sequence[int], r: Array) -> Row | None:
    """Return the sphere if r is a |x - C|^2 + const for a place x, or its root minus a constant."""
    for i in places:
        x = sample.x[i]
        square = (x**2).sum(axis=0)
        for left, feature in ((r, square), (square - r**2, r)):
            basis = np.column_stack([feature, x.T, np.ones(SAMPLES)])
            fit, *_ = np.linalg.lstsq(basis, left, rcond=1e-9)
            if abs(fit[0]) < 1e-9 or np.abs(basis @ fit - left).max() > EXACT * np.abs(left).max():
                continue
            if feature is r:  # |x|^2 - r^2 = 2 R r + 2 C.x + R^2 - |C|^2
                radius, centre = abs(fit[0]) / 2.0, fit[1:4] / 2.0
            else:  # r = a (|x - C|^2 - R^2)
                centre = -fit[1:4] / (2.0 * fit[0])
                radius = max(float(centre @ centre - fit[4] / fit[0]), 0.0) ** 0.5
            return Row("sphere", "", False, (i,), at=tuple(centre.tolist()), radius=float(radius))
    return None


def _bodies_moved_by(sample: Sample, node: Node) -> list[int]:
    """Return the bodies that move only by coordinates of `node`."""

    def coordinates(nodes: Sequence[Node]) -> set[Node]:
        return {s for s in symbols(nodes) if s.record.kind == "coordinate"}

    wanted = coordinates([node])
    moved = [coordinates(body.position) for body in sample.model.bodies]
    return [k for k, by in enumerate(moved) if by and by <= wanted]


def _pin(sample: Sample, name: str, group: Sequence[Row]) -> dict[str, Any] | None:
    """Return the fixed point at which two or three planes hold one place; along their line if it is free."""
    planes = [row for row in group if row.kind == "plane"]
    if len(planes) < 2 or len({row.places for row in planes}) != 1 or planes[0].one_sided:
        return None
    n = np.array([row.n for row in planes])
    point, *_ = np.linalg.lstsq(n, np.array([row.c for row in planes]), rcond=None)
    if sample.normal is not None:
        point = point + sample.normal * (sample.x[planes[0].places[0]][:, 0] @ sample.normal)
    whole = len(planes) == 3 or sample.normal is not None
    axis = None if whole else np.cross(n[0], n[1]).tolist()
    return {"name": name, "at": point.tolist(), "kind": "pin" if whole else "rail", "axis": axis}


def _sort(sample: Sample, rows: Rows, row: Row) -> None:
    """Put a row among the links or the surfaces. A gap that closes at the greatest distance is a string, at
    the least one a sphere about a fixed place, or two places that touch."""
    if row.kind != "distance":
        rows.touching[row.name] = list(row.places)
        same = next((k for k, s in enumerate(rows.surfaces) if _is_same_plane(sample, s, row)), None)
        if same is None:
            rows.surfaces.append(row)
        else:
            rows.surfaces[same] = replace(rows.surfaces[same], places=rows.surfaces[same].places + row.places)
        return
    # A gap grows with its slope times the distance: a negative slope bounds the distance from above.
    fixed = [i for i in row.places if not sample.moves(i)]
    if not row.one_sided or row.slope < 0.0:
        kind = "string" if row.one_sided else "rod"
        a, b = row.places
        rows.links.append(Link(kind, a, b, row.length, row.name, row.slope))
    elif fixed:
        others = tuple(i for i in row.places if i != fixed[0])
        rows.touching[row.name] = list(others)
        at = tuple(sample.x[fixed[0]][:, 0].tolist())
        rows.surfaces.append(replace(row, kind="sphere", at=at, radius=row.length, places=others))
    else:
        rows.touching[row.name] = list(row.places)
        rows.surfaces.append(replace(row, kind="touch"))


def _is_same_plane(sample: Sample, a: Row, b: Row) -> bool:
    if a.kind != "plane" or b.kind != "plane" or not np.allclose(np.cross(a.n, b.n), 0.0, atol=1e-9):
        return False
    return bool(abs(a.c - b.c * np.sign(np.dot(a.n, b.n))) < 1e-9 * sample.scale)


def radii_at_contact(sample: Sample, rows: Rows) -> Iterator[tuple[int, float]]:
    """Yield the radii of particles that touch one another: half of their distance in a contact. Where a gap
    is no distance, that of the run, if it is the same whenever they touch, and never less."""
    for row in rows.surfaces:
        if row.kind == "touch":
            yield from ((i, row.length / 2.0) for i in row.places)
    interface, x = sample.run.system.interface, np.array(sample.run.states)
    columns = {d.name: x.shape[1] - len(interface.discretes) + k for k, d in enumerate(interface.discretes)}
    for label, pair in rows.touching.items():
        if len(pair) != 2 or label not in columns or label in rows.known:
            continue
        touches = x[:, columns[label]] != 0.0
        some = np.flatnonzero(touches)[:: max(1, int(touches.sum()) // 12)]
        chosen = np.concatenate([some, np.arange(0, len(x), 1 + len(x) // 12)])
        given = sample.of_run(np.array(sample.run.times)[chosen], x[chosen])
        at = positions([sample.places[i] for i in pair], given, len(chosen))
        d = np.linalg.norm(at[0] - at[1], axis=0)
        there = d[: len(some)]
        if len(some) >= 3 and np.ptp(there) <= 1e-6 * d.max() and d.min() >= (1.0 - 1e-6) * there.min():
            yield from ((i, float(there.min()) / 2.0) for i in pair)
