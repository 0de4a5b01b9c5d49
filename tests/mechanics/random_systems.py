"""Seeded random systems: trees of particles and solids, loops closed by rows, random actions.

One description is read by two parties: `model` builds the lagc Model, and `oracle` differentiates
the same positions numerically in many digits.  A system is written once, over any numbers that add
and multiply, with `sin` and `cos` given.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

from lagc.mechanics.formulation.states import rate_symbols
from lagc.semantics.model import Model
from lagc.symbolic.graph import Node
from tests.mechanics.builder import Builder

Vector = list[Any]
Matrix = list[list[Any]]


@dataclass(frozen=True)
class Functions:
    """sin and cos of the numbers in use."""

    sin: Callable[[Any], Any]
    cos: Callable[[Any], Any]


@dataclass(frozen=True)
class Link:
    """Carried by link `parent` (-1: the ground): an offset, a joint, then a body or none."""

    parent: int
    joint: str  # "x" "y" "z" turn about an axis; "X" "Y" "Z" slide along one; "free" a quaternion
    offset: tuple[float, float, float]
    drive: tuple[float, float]  # amplitude and frequency of a given motion along x of the offset
    mass: float
    com: tuple[float, float, float]
    inertia: tuple[float, float, float] | None


@dataclass(frozen=True)
class System:
    seed: int
    planar: bool
    links: tuple[Link, ...]
    springs: tuple[tuple[int, int, float], ...]  # between bodies, k
    wave: tuple[float, ...]  # coefficients of a potential in the coordinates and time
    drag: tuple[tuple[int, float], ...]
    torques: tuple[tuple[int, tuple[float, float, float]], ...]
    damping: float
    magnetic: float
    loops: tuple[tuple[int, int, float], ...]  # distance between two bodies
    pfaffian: tuple[tuple[float, ...], ...]
    quadratic: bool
    state: tuple[float, ...] = field(default=())


def random_system(seed: int) -> System:
    """A system of 1 to 5 links."""
    r = random.Random(seed)
    planar = r.random() < 0.4
    n = r.randint(1, 5)
    quaternion = not planar and r.random() < 0.3

    def triple(size: float = 1.0) -> tuple[float, float, float]:
        x, y, z = (round(r.uniform(-size, size), 3) for _ in range(3))
        return (x, y, 0.0) if planar else (x, y, z)

    links = []
    for i in range(n):
        kinds = ["z", "z", "X", "Y"] if planar else ["x", "y", "z", "X", "Y", "Z"]
        joint = "free" if quaternion and i == 0 else r.choice(kinds)
        inertia = None
        if r.random() < 0.6 or joint == "free":
            a, b, c = (round(r.uniform(0.1, 1.0), 3) for _ in range(3))
            inertia = (a, b, c)
        drive = (0.0, 1.0)
        if r.random() < 0.2:
            drive = (round(r.uniform(0.1, 0.5), 3), round(r.uniform(0.5, 3.0), 3))
        parent = i - 1 if r.random() < 0.7 else r.randint(-1, i - 1)
        mass = round(r.uniform(0.2, 2.0), 3)
        links.append(Link(parent, joint, triple(), drive, mass, triple(), inertia))

    def pairs(chance: float) -> tuple[tuple[int, int, float], ...]:
        return tuple(
            (i, j, round(r.uniform(0.5, 2.0), 3)) for i in range(n) for j in range(i) if r.random() < chance
        )

    return System(
        seed=seed,
        planar=planar,
        links=tuple(links),
        springs=pairs(0.2),
        wave=tuple(round(r.uniform(-1, 1), 3) for _ in range(4)),
        drag=tuple((i, round(r.uniform(0.05, 0.5), 3)) for i in range(n) if r.random() < 0.2),
        torques=tuple((i, triple()) for i in range(n) if r.random() < 0.2),
        damping=round(r.uniform(0, 1), 3) if r.random() < 0.4 else 0.0,
        magnetic=round(r.uniform(0, 1), 3) if r.random() < 0.3 else 0.0,
        loops=pairs(0.15)[:2],
        pfaffian=tuple(
            tuple(round(r.uniform(-1, 1), 3) for _ in range(4)) for _ in range(r.choice([0, 0, 1]))
        ),
        quadratic=n > 2 and r.random() < 0.3,  # else the speeds are over-determined
    )


_GROUND: tuple[Vector, Matrix] = ([0, 0, 0], [[1, 0, 0], [0, 1, 0], [0, 0, 1]])


def turn(axis: str, angle: Any, f: Functions) -> Matrix:
    c, s = f.cos(angle), f.sin(angle)
    return {
        "x": [[1, 0, 0], [0, c, -s], [0, s, c]],
        "y": [[c, 0, s], [0, 1, 0], [-s, 0, c]],
        "z": [[c, -s, 0], [s, c, 0], [0, 0, 1]],
    }[axis]


def turn_by_quaternion(e: Sequence[Any]) -> Matrix:
    w, x, y, z = e
    return [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]


def product(a: Matrix, b: Matrix) -> Matrix:
    return [[sum((a[i][k] * b[k][j] for k in range(3)), start=0) for j in range(3)] for i in range(3)]


def apply(a: Matrix, v: Sequence[Any]) -> Vector:
    return [sum((a[i][k] * v[k] for k in range(3)), start=0) for i in range(3)]


def shapes(s: System) -> list[slice]:
    """Which q each link's joint has."""
    found, at = [], 0
    for link in s.links:
        width = 4 if link.joint == "free" else 1
        found.append(slice(at, at + width))
        at += width
    return found


def poses(s: System, q: Sequence[Any], t: Any, f: Functions) -> list[tuple[Vector, Matrix]]:
    """Centre of mass and axes of every link."""
    joints: list[tuple[Vector, Matrix]] = []
    found: list[tuple[Vector, Matrix]] = []
    for link, part in zip(s.links, shapes(s)):
        origin, axes = joints[link.parent] if link.parent >= 0 else _GROUND
        offset: Vector = list(link.offset)
        if link.drive[0]:
            offset[0] = offset[0] + link.drive[0] * f.sin(link.drive[1] * t)
        if link.joint in "XYZ":
            k = "XYZ".index(link.joint)
            offset[k] = offset[k] + q[part][0]
        place = [a + b for a, b in zip(origin, apply(axes, offset))]
        if link.joint == "free":
            axes = product(axes, turn_by_quaternion(q[part]))
        elif link.joint in "xyz":
            axes = product(axes, turn(link.joint, q[part][0], f))
        joints.append((place, axes))
        found.append(([a + b for a, b in zip(place, apply(axes, link.com))], axes))
    return found


def potential(s: System, q: Sequence[Any], t: Any, f: Functions) -> Any:
    """Gravity, springs of length 0 and a wave."""
    places = [place for place, _ in poses(s, q, t, f)]
    total: Any = 0
    for link, place in zip(s.links, places):
        total = total + 9.81 * link.mass * (place[1] if s.planar else place[2])
    for i, j, k in s.springs:
        total = total + 0.5 * k * square([a - b for a, b in zip(places[i], places[j])])
    a, b, c, w = s.wave
    return total + a * f.sin(b * q[0] + c * q[-1] + w * t)


def square(v: Sequence[Any]) -> Any:
    return v[0] * v[0] + v[1] * v[1] + v[2] * v[2]


def loop_residuals(s: System, q: Sequence[Any], t: Any, f: Functions) -> list[Any]:
    places = [place for place, _ in poses(s, q, t, f)]
    return [square([a - b for a, b in zip(places[i], places[j])]) - d * d for i, j, d in s.loops]


def rate_residuals(s: System, q: Sequence[Any], v: Sequence[Any], t: Any, f: Functions) -> list[Any]:
    """Pfaffian rows with coefficients that turn with the first and last coordinate, and |v|^2 = 2."""
    found = []
    for a, b, c, d in s.pfaffian:
        row: Any = d * f.cos(a * t)
        for k, x in enumerate(v):
            row = row + (a + f.sin(b * q[0] + c * k + q[-1])) * x
        found.append(row)
    if s.quadratic:
        found.append(sum((x * x for x in v), start=0) - 2.0)
    return found


def damping(s: System, q: Sequence[Any], v: Sequence[Any], t: Any, f: Functions) -> Any:
    return sum((0.5 * s.damping * (1.5 + f.sin(q[0])) * x * x for x in v), start=0)


def magnetic(s: System, q: Sequence[Any], v: Sequence[Any], t: Any, f: Functions) -> Any:
    """A free term with parts linear and quadratic in the rates."""
    first, last = q[0], q[-1]
    return s.magnetic * (f.sin(last + t) * v[0] * (1 + first) + 0.3 * f.cos(first) * v[0] * v[-1])


def model(s: System) -> Model:
    """The system as a Model; velocities by the graph's own derivative."""
    b = Builder(f"Random{s.seed}")
    f = Functions(b.graph.sin, b.graph.cos)
    q: list[Node] = []
    for i, link in enumerate(s.links):
        if link.joint == "free":
            _, orientation = b.orientation(f"o{i}")
            q.extend(orientation.symbols)
        else:
            q.append(b.coordinate(f"q{i}"))
    v = [rate for c in b.coordinates for rate in rate_symbols(c)]
    frames: dict[int, Any] = {-1: b.world}
    for i, ((place, _), link) in enumerate(zip(poses(s, q, b.time, f), s.links)):
        frame = frames[link.parent]
        if link.joint == "free":
            frame = b.frames[0]  # the first link, on the ground
        elif link.joint in "xyz":
            frame = b.rotate(f"F{i}", frame, link.joint, q[shapes(s)[i]][0])
        frames[i] = frame
        if link.inertia is None:
            b.particle(f"b{i}", b.graph.const(link.mass), place)
        else:
            b.solid(f"b{i}", b.graph.const(link.mass), link.inertia, frame, place)
    b.potential("V", b.graph.as_node(potential(s, q, b.time, f)))
    for i, k in s.drag:
        body = b.bodies[i]
        b.force(f"drag{i}", [-k * x * (1.0 + square(body.velocity)) for x in body.velocity], body.position)
    for i, moment in s.torques:
        parent = s.links[i].parent
        b.torque(f"torque{i}", moment, frames[i], frames[parent] if parent >= 0 else None)
    if s.damping:
        b.dissipation("damping", damping(s, q, v, b.time, f))
    if s.magnetic:
        b.lagrangian("magnetic", magnetic(s, q, v, b.time, f))
    for k, residual in enumerate(loop_residuals(s, q, b.time, f)):
        b.constraint(f"loop{k}", residual)
    for k, residual in enumerate(rate_residuals(s, q, v, b.time, f)):
        b.constraint(f"rate{k}", residual)
    return b.model()
