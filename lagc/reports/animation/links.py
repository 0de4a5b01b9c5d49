"""Rods, spokes, arms, springs and dampers: distances that never change, or that an energy depends on."""

import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from lagc.base.records import dataclass
from lagc.reports.animation.places import EXACT, Sample
from lagc.reports.animation.states import SAMPLES, Array, Given
from lagc.semantics.model import Coordinate, Dissipation, Potential
from lagc.symbolic.graph import Node
from lagc.symbolic.walk import reachable, symbols

MOST_PLACES = 700  # of more, distances are taken between neighbours in the text and to some fixed places
NEIGHBOURS, FIXED = 8, 8


@dataclass(frozen=True, slots=True)
class Link:
    """A line between two places. `kind`: rod, spoke of the solid at place `body`, string with its greatest
    `length`, line that the model declares, spring or damper. `slope` is that of the residual `name` by the
    distance."""

    kind: str
    a: int
    b: int
    length: float = 0.0
    name: str = ""
    slope: float = 0.0
    body: int | None = None

    def as_data(self) -> dict[str, Any]:
        return {"kind": self.kind, "a": self.a, "b": self.b, "length": self.length, "name": self.name}


class Distances:
    """The distances `d`, (pairs, samples), of pairs of places i, j."""

    def __init__(self, sample: Sample):
        places = np.array([i for i in sample.known if np.isfinite(sample.x[i]).all()], int)
        n = len(places)
        if n <= MOST_PLACES:
            i, j = np.triu_indices(n, 1)
        else:
            i = np.repeat(np.arange(n), NEIGHBOURS)
            j = i + np.tile(np.arange(1, NEIGHBOURS + 1), n)
            i, j = i[j < n], j[j < n]
            for k in [k for k, place in enumerate(places) if not sample.moves(place)][:FIXED]:
                others = np.delete(np.arange(n), k)
                i, j = np.append(i, np.full(n - 1, k)), np.append(j, others)
        self.i, self.j = places[i], places[j]
        self.d = np.linalg.norm(sample.x[self.i] - sample.x[self.j], axis=1)


def rods(sample: Sample, distances: Distances) -> list[Link]:
    """Return a rod where a distance is always the same, and the spokes of solids to their places. Of many
    redundant rods, the shortest that tie all places."""
    mean = distances.d.mean(axis=1)
    rigid = (np.ptp(distances.d, axis=1) < EXACT * mean) & (mean > 1e-9 * sample.scale)
    inside = {(a, b) for s in sample.solids for a, _ in s.attached for b, _ in s.attached}
    found = [
        (int(a), int(b), float(d))
        for a, b, d in zip(distances.i[rigid], distances.j[rigid], mean[rigid])
        if (sample.moves(a) or sample.moves(b)) and (a, b) not in inside
    ]
    kept = _spanning(found) if len(found) > 2 * len(sample.known) else found
    links = [Link("rod", a, b, d) for a, b, d in kept]
    for s in sample.solids:
        links += [Link("spoke", s.place, i, body=s.place)
                  for i, _ in s.attached if i != sample.first[s.place]]  # fmt: skip
    return links


def _spanning(found: Sequence[tuple[int, int, float]]) -> Iterator[tuple[int, int, float]]:
    """Yield the shortest links that tie all places (J. B. Kruskal, 1956)."""
    root: dict[int, int] = {}

    def top(k: int) -> int:
        while root.setdefault(k, k) != k:
            k = root[k]
        return k

    for a, b, d in sorted(found, key=lambda link: link[2]):
        if top(a) != top(b):
            root[top(a)] = top(b)
            yield a, b, d


def arms(sample: Sample, links: Sequence[Link]) -> list[Link]:
    """Return a rod from each particle that one angle moves on a circle, and that nothing else holds, to the
    centre of the circle, which becomes a place."""
    # A particle that something holds needs no arm.
    tied = {x for link in links for x in (link.a, link.b)}
    tied |= {i for solid in sample.solids for i, _ in solid.attached}
    angles = {c.symbol for c in sample.model.coordinates if isinstance(c, Coordinate) and c.unit == "rad"}
    found: list[Link] = []
    for k, body in enumerate(sample.model.bodies):
        if sample.first[k] in tied or body.frame is not None:
            continue
        for angle in [s for s in symbols(body.position) if s in angles]:
            circle = _circle(sample, list(body.position), angle)
            if circle is not None:
                pivot = sample.add_pivot(f"pivot of {body.name}", circle[0])
                found.append(Link("rod", pivot, k, circle[1]))
                break
    return found


def _circle(sample: Sample, position: list[Node], angle: Node) -> tuple[Array, float] | None:
    """Return the fixed centre and the radius of the circle on which an angle moves a position, if there is
    one."""
    now = sample.given[angle]
    x = [sample.values(position, {**sample.given, angle: now + turn})
         for turn in (0.0, 0.5 * math.pi, math.pi, 1.0)]  # fmt: skip
    centre, radius = (x[0] + x[2]) / 2.0, np.linalg.norm(x[0] - x[2], axis=0) / 2.0
    if not np.isfinite(radius).all() or not radius.max() > EXACT * sample.scale:
        return None
    is_round = all(np.allclose(np.linalg.norm(y - centre, axis=0), radius, rtol=EXACT) for y in x[1:])
    fixed = np.ptp(centre, axis=1).max() < EXACT * sample.scale
    if is_round and fixed and np.ptp(radius) < EXACT * radius.max():
        return centre[:, 0], float(radius[0])
    return None


def springs(sample: Sample, distances: Distances) -> list[Link]:
    """Return the springs and dampers: an energy or a dissipation depends on a length, which is a distance or
    differs from it by a constant."""
    table: dict[str, list[int]] = {}
    for k, change in enumerate(distances.d[:, 0] - distances.d[:, 1]):
        table.setdefault(_key(change), []).append(k)
    found: dict[tuple[int, int, str], Link] = {}
    for action in sample.model.actions:
        if not isinstance(action, Potential | Dissipation):
            continue
        node = action.energy if isinstance(action, Potential) else action.function
        lengths = [n for n in reachable([node]) if _may_be_length(n)]
        for length, v in zip(lengths, sample.values(lengths) if lengths else ()):
            pair = _pair_of(distances, table.get(_key(v[0] - v[1]), ()), v)
            kind = "spring" if isinstance(action, Potential) else "damper"
            if pair is not None and (kind == "damper" or _is_elastic(sample, node, length, v)):
                a, b = pair
                found.setdefault((a, b, kind), Link(kind, a, b, name=action.name))
    return list(found.values())


def _key(change: float) -> str:
    return f"{abs(change):.8e}"


def _pair_of(distances: Distances, pairs: Sequence[int], v: Array) -> tuple[int, int] | None:
    """Return the places of the first of some pairs whose distance changes as a length does, or against it."""
    for k in pairs:
        d = distances.d[k]
        for offset in (d - v, d + v):
            if np.ptp(offset) <= 1e-9 * d.max() and np.ptp(d) > EXACT * d.max():
                return int(distances.i[k]), int(distances.j[k])
    return None


def _may_be_length(node: Node) -> bool:
    if node.op == "symbol":
        return bool(node.record.kind == "coordinate")
    return node.op in ("sqrt", "abs", "add") or (node.op == "mul" and 0.5 in map(float, node.value))


def _is_elastic(sample: Sample, energy: Node, length: Node, v: Array) -> bool:
    """Return whether an energy is a convex function of this length, plus one of all else: the concave one of
    an attraction is no spring."""

    def change(given: Given) -> Array:
        x = [sample.values([energy], {**given, length: at}) for at in (v, np.full(SAMPLES, v[0]))]
        difference: Array = x[0][0] - x[1][0]
        return difference

    # The change of the energy with the length is the same wherever all else is: then it is a sum of a
    # function of the length and one of the others.
    one = {node: value[0] if np.ndim(value) else value for node, value in sample.given.items()}
    here, there = change(sample.given), change(one)
    if not np.abs(here - there).max() <= EXACT * np.abs(there).max():
        return False
    step = 1e-3 * v
    x = [sample.values([energy], {**sample.given, length: v + s * step})[0] for s in (-1, 0, 1)]
    curvature = x[0] - 2.0 * x[1] + x[2]
    return bool((curvature > EXACT * np.abs(there).max()).all())
