"""The scene of a model: all that is drawn of it, inferred from the resolved model itself.

The inference reads no formula.  It evaluates places, distances, constraints and energies at configurations
that are drawn at random, and keeps what is the same at all of them: a distance that never changes is a rod, a
residual that is affine in a place is a plane, a root in an energy that equals a distance is a spring.
"""

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from lagc.base.records import dataclass, replace
from lagc.reports.animation.links import Distances, Link, arms, rods, springs
from lagc.reports.animation.places import EXACT, Place, Sample, Solid, names_of
from lagc.reports.animation.shapes import Shape, declared_shape, find_shapes
from lagc.reports.animation.states import Array
from lagc.reports.animation.surfaces import Row, Rows, radii_at_contact, read_rows
from lagc.semantics.model import Model
from lagc.simulation.solution import Solution
from lagc.symbolic.vectors import Vector

FAR = 0.25  # a mechanism of less than this part of its travel is followed


@dataclass(frozen=True, slots=True)
class Drawn:
    """A figure that the model declares and that no body carries: its shape with the axis y, its place, and
    its axis in the world, if it has one."""

    name: str
    shape: Shape
    place: int
    axis: Vector | None


@dataclass(slots=True)
class Scene:
    """Places, bodies, links, surfaces and springs of a model, in m, and the `figures` that it declares at
    places. `first`, `low`, `high`, `scale`, `size`,
    `up`, `normal` and `gravity` as in `Sample`; `feet` are fixed places that hold something, `hinges` moving
    ones that two solids share; `travels`: the camera follows the heaviest body."""

    sample: Sample
    rows: Rows
    links: list[Link]
    springs: list[Link]
    figures: list[Drawn]
    feet: list[int]
    hinges: list[int]
    travels: bool

    @property
    def model(self) -> Model:
        return self.sample.model

    @property
    def places(self) -> list[Place]:
        return self.sample.places

    @property
    def bodies(self) -> list[Solid]:
        return self.sample.solids

    @property
    def surfaces(self) -> list[Row]:
        return self.rows.surfaces

    @property
    def normal(self) -> Array | None:
        return self.sample.normal

    @property
    def up(self) -> Array:
        return self.sample.up

    @property
    def size(self) -> float:
        return self.sample.size

    @property
    def scale(self) -> float:
        return self.sample.scale

    def place_of(self, name: str, *kinds: str) -> int | None:
        """Return the index of a place by its name, and its kind if some are given."""
        places = enumerate(self.places)
        return next((i for i, p in places if p.name == name and (not kinds or p.kind in kinds)), None)

    def as_data(self) -> dict[str, Any]:
        """Return the scene as plain data, for one's own drawing."""
        s = self.sample
        return {
            "scale": s.scale, "size": s.size, "low": s.low.tolist(), "high": s.high.tolist(),
            "up": s.up.tolist(), "normal": _listed(s.normal), "gravity": _listed(s.gravity),
            "feet": self.feet, "hinges": self.hinges, "travels": self.travels,
            "places": [{"name": p.name, "kind": p.kind, "same": s.first[i]} for i, p in enumerate(s.places)],
            "bodies": [{"name": b.name, "place": b.place, "mass": b.mass, "shape": b.shape,
                        "line": self.model.bodies[b.place].span.line} for b in s.solids],
            "links": [link.as_data() for link in self.links],
            "springs": [link.as_data() for link in self.springs],
            "surfaces": [row.as_data() for row in self.surfaces], "pins": self.rows.pins,
            "figures": [{"name": f.name, "shape": f.shape, "place": f.place} for f in self.figures],
        }  # fmt: skip


def _listed(x: Array | None) -> list[float] | None:
    return None if x is None else [float(value) for value in x]


def infer(model: Model, run: Solution) -> Scene:
    """Return the scene of a model, with the sizes that it has in this run."""
    sample = Sample(model, run)
    distances = Distances(sample)
    links = rods(sample, distances)
    # Constraints may bring strings; arms are for particles that nothing else holds, so they come after all
    # links.
    rows = read_rows(sample, distances)
    links += rows.links
    links += arms(sample, links)
    elastic = springs(sample, distances)
    figures = _declared(sample, rows, links, elastic)
    joined = [*links, *elastic]
    # A mechanism that stands on something is drawn with its travel, another one is followed by the camera;
    # sizes of figures depend on that.
    feet = _feet(sample, joined)
    extended = sample.size > 1.05 * 0.02 * sample.scale  # more than a single particle
    travels = not feet and not rows.pins and extended and sample.size < FAR * sample.scale
    if not travels:
        sample.size = max(sample.size, 0.6 * sample.scale)
    radii: dict[int, float] = {}
    for i, radius in radii_at_contact(sample, rows):
        radii[i] = min(radii.get(i, radius), radius)
    find_shapes(sample, links, radii)
    rows.surfaces = [_under_round(sample, row) for row in rows.surfaces]
    held: dict[int, int] = {}
    for body in sample.solids:
        for i, _ in body.attached:
            held[i] = held.get(i, 0) + 1
    hinges = [i for i, count in held.items() if count > 1 and sample.moves(i)]
    drawn = [link for link in links if not _is_covered(sample, link)]
    return Scene(sample, rows, drawn, elastic, figures, feet, hinges, travels)


def _under_round(sample: Sample, row: Row) -> Row:
    """Return the plane that round solids touch, where their centres stay on a plane: it goes through the
    origin, as far from the centres as their radius."""
    round_ = [b.shape.get("r") for b in sample.solids if b.place in row.places and b.inertia is not None]
    same = all(r is not None and abs(r - abs(row.c)) <= 1e-6 * r for r in round_)
    return replace(row, c=0.0) if row.kind == "plane" and round_ and same else row


def _declared(sample: Sample, rows: Rows, links: list[Link], elastic: list[Link]) -> list[Drawn]:
    """Add lines, coils and planes that the model declares, and return its other figures. A ring takes the
    place of the rods from its centre to what moves along it."""
    found = []
    for figure in sample.model.figures:
        places = [i for i, p in enumerate(sample.places) if p.kind == "figure" and p.name in names_of(figure)]
        if figure.kind == "Line":
            links += [Link("line", a, b, name=figure.name) for a, b in pairwise(places)]
        elif figure.kind == "Coil":
            elastic += [Link("spring", a, b, name=figure.name) for a, b in pairwise(places)]
        elif figure.kind == "Plane":
            assert figure.axis is not None
            n, at = sample.values(figure.axis)[:, 0], sample.x[places[0]][:, 0]
            rows.surfaces.append(Row("plane", figure.name, False, (), n=tuple(n.tolist()), c=float(n @ at)))
        elif not figure.body:
            shape = declared_shape(sample, figure)
            found.append(Drawn(figure.name, shape, places[0], figure.axis))
            if figure.kind == "Ring":
                links[:] = [x for x in links if not _is_radius(sample, x, places[0], shape["r"])]
    return found


def _is_radius(sample: Sample, link: Link, centre: int, radius: float) -> bool:
    """Return whether a rod leads from the centre of a ring to what moves along it."""
    ends = [np.allclose(sample.x[i], sample.x[centre], atol=EXACT * sample.scale) for i in (link.a, link.b)]
    return link.kind == "rod" and any(ends) and abs(link.length - radius) <= 1e-6 * radius


def _feet(sample: Sample, joined: Sequence[Link]) -> list[int]:
    """Return the fixed places that hold something. If nothing holds a mechanism, it may travel far."""
    held = {x for link in joined for x in (link.a, link.b)}
    held |= {i for body in sample.solids for i, _ in body.attached}
    held |= {sample.first[i] for i, place in enumerate(sample.places) if place.kind == "joint"}
    placed = {sample.first[body.place] for body in sample.solids}
    drawn = {i for i, place in enumerate(sample.places) if place.kind == "figure"}
    return sorted(i for i in held - drawn if not sample.moves(i) and i not in placed)


def _is_covered(sample: Sample, link: Link) -> bool:
    """Return whether a figure hides a link: a spoke of a hull, a rod inside of a disc."""
    by_place = {body.place: body.shape for body in sample.solids}
    for i in (link.a, link.b):
        shape = by_place.get(i, {})
        if link.kind == "spoke" and shape.get("kind") in ("hull", "rod") and i == link.body:
            return True
        is_round = shape.get("kind") in ("cylinder", "sphere") and shape["true"]
        if link.kind == "rod" and is_round and link.length <= 1.001 * shape["r"]:
            return True
    return False
