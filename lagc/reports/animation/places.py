"""The places of a model: bodies, points and joints, at random configurations and over the run."""

from typing import Any

import numpy as np

from lagc.base.records import dataclass, field
from lagc.reports.animation.states import (
    SAMPLES,
    Array,
    Given,
    of_states,
    random_configurations,
    rates_of,
    values,
)
from lagc.semantics.model import Figure, Frame, Model, Potential
from lagc.simulation.solution import Solution
from lagc.symbolic.graph import Node
from lagc.symbolic.vectors import Vector

EXACT = 1e-8  # relative: a difference below it is none
LEAST_SIZE = 0.02  # of the travel: the least size of the mechanism that figures are drawn for
LEAST_GRAVITY = 1e-6  # of the largest potential energy over mass and travel: less is rounding


@dataclass(frozen=True, slots=True)
class Place:
    """A place with a name. `kind` is body, point, joint, origin, figure or pivot; `position` are its nodes,
    `at` the coordinates of a constant one instead."""

    name: str
    kind: str
    position: tuple[Node, ...] = ()
    at: tuple[float, ...] = ()


@dataclass(slots=True)
class Solid:
    """A body with numbers: `place` is its index in the places, `attached` are places that are fixed in its
    frame with their coordinates there, `axes` the frame at the random configurations (3, 3, samples)."""

    name: str
    place: int
    frame: Frame | None
    mass: float
    inertia: Array | None
    axes: Array | None = None
    attached: list[tuple[int, Array]] = field(default_factory=list)
    shape: dict[str, Any] = field(default_factory=dict)


def places_of(model: Model) -> list[Place]:
    """Return the places of a model; those of its bodies first, those of figures last."""
    found = [Place(body.name, "body", body.position) for body in model.bodies]
    found += [Place(point.name, "point", point.position) for point in model.points]
    for joint in model.joints:
        if joint.at is not None:
            found.append(Place(joint.name, "joint", joint.at))
        if joint.to is not None:
            found.append(Place(f"{joint.name}, to", "joint", joint.to))
    found.append(Place("origin", "origin", at=(0.0, 0.0, 0.0)))
    return found + [Place(name, "figure", x) for f in model.figures for name, x in zip(names_of(f), f.points)]


def names_of(figure: Figure) -> list[str]:
    """Return the names of the places of a figure."""
    return [f"{figure.name}, {k}" for k in range(len(figure.points))]


def positions(places: list[Place], given: Given, size: int) -> Array:
    """Return where the places are, (places, 3, size)."""
    nodes = [node for place in places for node in place.position]
    rows = values(nodes, given, size) if nodes else np.zeros((0, size))
    found = np.empty((len(places), 3, size))
    k = 0
    for place, x in zip(places, found):
        if place.position:
            x[:] = rows[k : k + 3]
            k += 3
        else:
            x[:] = np.array(place.at)[:, None]
    return found


class Sample:
    """A model at random configurations, from which a scene is inferred.

    `x` are its places there, (places, 3, samples); `first[i]` is the first place that always is where place i
    is. `low` and `high` are the corners of the box of all places over the run, `scale` is its diagonal, and
    `size` that of the mechanism at one time. `up` is a unit vector, `normal` that of the plane of a plane
    motion (None: in space), `gravity` the acceleration of gravity (None: no such potential)."""

    def __init__(self, model: Model, run: Solution):
        self.model, self.run = model, run
        self.given = random_configurations(model, run)
        self.places = places_of(model)
        self.x = positions(self.places, self.given, SAMPLES)
        self.first = _first_names(self.x)
        self.low, self.high, self.scale, self.size = self._measure()
        self.solids = [self._solid(k) for k in range(len(model.bodies))]
        radii = [2.0 * np.sqrt(2.5 * np.trace(b.inertia) / 3.0 / b.mass)
                 for b in self.solids if b.inertia is not None and b.mass > 0.0]  # fmt: skip
        self.size = float(max([self.size, LEAST_SIZE * self.scale, *radii]))
        self.gravity = self._gravity()
        self.normal, self.up = self._plane_of_motion()

    def values(self, nodes: list[Node] | Vector, given: Given | None = None) -> Array:
        """Return nodes at the random configurations, (len(nodes), samples)."""
        return values(nodes, self.given if given is None else given, SAMPLES)

    @property
    def known(self) -> list[int]:
        """The places from which a scene is inferred, each once: not those of figures alone."""
        return [i for i in dict.fromkeys(self.first) if self.places[i].kind != "figure"]

    def moves(self, i: int) -> bool:
        return bool(np.ptp(self.x[i], axis=1).max() > EXACT * self.scale)

    def add_pivot(self, name: str, at: Array) -> int:
        """Add a fixed place and return its index."""
        self.places.append(Place(name, "pivot", at=tuple(at.tolist())))
        self.x = np.concatenate([self.x, np.repeat(at[None, :, None], SAMPLES, 2)])
        self.first.append(len(self.first))
        return len(self.first) - 1

    def of_run(self, times: Array, states: Array) -> Given:
        """Return the values of all symbols at states of the run."""
        return of_states(self.model, self.run, times, states, rates_of(self.run, times, states))

    def _measure(self) -> tuple[Array, Array, float, float]:
        """Return the corners of the box of all places over the run, its diagonal and the median of its
        diagonals at one time."""
        times, states = np.array(self.run.times), np.array(self.run.states)
        rates = np.zeros(states.shape)  # no place depends on a rate
        x = positions(self.places, of_states(self.model, self.run, times, states, rates), len(times))
        low, high = np.nanmin(x, axis=(0, 2)), np.nanmax(x, axis=(0, 2))
        named = [i for i, place in enumerate(self.places) if place.kind != "origin"] or [0]
        spread = np.nanmax(x[named], axis=0) - np.nanmin(x[named], axis=0)
        size = float(np.nanmedian(np.linalg.norm(spread, axis=0)))
        return low, high, float(np.linalg.norm(high - low)) or 1.0, size

    def _solid(self, k: int) -> Solid:
        """Return body k with the places that are fixed in its frame."""
        body = self.model.bodies[k]
        nodes = [body.mass, *(node for row in body.inertia or () for node in row)]
        mass, *flat = self.values(nodes)[:, 0]
        solid = Solid(body.name, k, body.frame, float(mass), np.array(flat).reshape(3, 3) if flat else None)
        if body.frame is None:
            return solid
        solid.axes = self.values([node for row in body.frame.axes for node in row]).reshape(3, 3, SAMPLES)
        for i in self.known:
            arm = np.einsum("rcs,rs->cs", solid.axes, self.x[i] - self.x[k])
            if np.ptp(arm, axis=1).max() < EXACT * max(self.scale, float(np.abs(arm).max())):
                solid.attached.append((i, arm.mean(axis=1)))
        return solid

    def _gravity(self) -> Array | None:
        """Return g if a potential is -sum m g.r + const of all bodies."""
        masses = np.array([solid.mass for solid in self.solids])
        moment = np.einsum("b,bcs->cs", masses, self.x[: len(masses)])
        basis = np.column_stack([-moment.T, np.ones(SAMPLES)])
        for action in self.model.actions:
            if not isinstance(action, Potential) or not np.isfinite(basis).all():
                continue
            energy = self.values([action.energy])[0]
            if not np.isfinite(energy).all():
                continue
            fit, *_ = np.linalg.lstsq(basis, energy, rcond=1e-9)
            most = float(np.abs(energy).max())
            least = LEAST_GRAVITY * most / max(float(masses.sum()) * self.scale, 1e-300)
            if np.abs(basis @ fit - energy).max() <= EXACT * most and np.linalg.norm(fit[:3]) > least:
                gravity: Array = fit[:3]
                return gravity
        return None

    def _plane_of_motion(self) -> tuple[Array | None, Array]:
        """Return the normal of a plane motion, or None, and up: against gravity, else y or z."""
        x = np.concatenate([self.x[i].T for i in self.known])
        x = x[np.isfinite(x).all(axis=1)]
        x = x - x.mean(axis=0)
        _, s, rows = np.linalg.svd(x, full_matrices=False)
        spins = [self.values(body.frame.spin) for body in self.model.bodies if body.frame is not None]
        candidates = [rows[2]] if len(s) > 2 and s[1] > 1e-9 * s[0] else [np.eye(3)[k] for k in (1, 2, 0)]
        normal = next((n for n in candidates if self._is_normal(n, x, spins)), None)
        if normal is not None and normal[np.argmax(np.abs(normal))] < 0.0:
            normal = -normal
        g = self.gravity
        if g is not None and (normal is None or abs(g @ normal) < 0.5 * np.linalg.norm(g)):
            up = -g / np.linalg.norm(g)
        else:
            up = np.eye(3)[2 if normal is None or abs(normal[2]) < 0.5 else 1]
        if normal is not None and abs(normal[1]) > 0.9:
            normal = -np.abs(normal)  # seen from -y: x to the right, z up
        return normal, up

    def _is_normal(self, n: Array, x: Array, spins: list[Array]) -> bool:
        """Return whether no place leaves the plane across n, and every body turns about n."""
        flat = float(np.abs(x @ n).max()) <= EXACT * self.scale
        return flat and all(np.abs(np.cross(w.T, n)).max() <= 1e-9 * (1.0 + np.abs(w).max()) for w in spins)


def _first_names(x: Array) -> list[int]:
    """Return for each place the first place that is at the same position in all configurations."""
    size = float(np.nanmax(np.abs(x))) or 1.0
    seen: dict[tuple[float, ...], int] = {}
    keys = [tuple(np.round(row[:, :6].ravel() / size, 9) + 0.0) for row in x]
    return [seen.setdefault(key, i) for i, key in enumerate(keys)]
