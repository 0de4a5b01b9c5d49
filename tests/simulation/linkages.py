"""Planar linkages of point masses on rods, as Programs."""

from __future__ import annotations

from collections.abc import Sequence
from math import cos, sin
from typing import Any

from lagc.lowering.program import Program
from tests.simulation.traced import PTX, program, trace

Rod = tuple[int | tuple[float, float], int | tuple[float, float], float]


def points(name: str, count: int, rods: Sequence[Rod], start: Sequence[float]) -> Program:
    """`count` unit masses in the plane, q = (x0, y0, x1, ...), on rods to each other or to fixed places."""
    n, nc = 2 * count, len(rods)

    def end(x: Any, at: int | tuple[float, float], offset: int) -> tuple[Any, Any]:
        if isinstance(at, int):
            return x[offset + 2 * at], x[offset + 2 * at + 1]
        return at if offset == 0 else (0.0, 0.0)

    def along(x: Any, rod: Rod, offset: int) -> tuple[Any, Any]:
        (ax, ay), (bx, by) = end(x, rod[0], offset), end(x, rod[1], offset)
        return bx - ax, by - ay

    def system(p: Any, t: Any, x: Any) -> Any:
        mass = [1.0 if i == j else 0.0 for i in range(n) for j in range(i + 1)]
        force = [0.0 if i % 2 == 0 else -p[0] for i in range(n)]
        rows, right = [], []
        for rod in rods:
            dx, dy = along(x, rod, 0)
            u, v = along(x, rod, n)
            row: list[Any] = [0.0] * n
            for at, sign in ((rod[0], -1.0), (rod[1], 1.0)):
                if isinstance(at, int):
                    row[2 * at], row[2 * at + 1] = sign * dx, sign * dy
            rows += row
            right.append(-(u * u + v * v))
        return [x[n + i] for i in range(n)], mass, force, rows, right

    def phi(p: Any, t: Any, x: Any) -> Any:
        return ([0.5 * (d[0] * d[0] + d[1] * d[1] - r[2] * r[2]) for r in rods for d in (along(x, r, 0),)],)

    def psi(p: Any, t: Any, x: Any) -> Any:
        return ([a[0] * b[0] + a[1] * b[1] for r in rods for a, b in ((along(x, r, 0), along(x, r, n)),)],)

    def reaches(p: Any, t: Any, x: Any, c: Any) -> Any:
        slopes = [2.0 * (abs(d[0]) + abs(d[1])) for r in rods for d in (along(x, r, 0),)]
        return ([*(s * c[0] for s in slopes), *(s * c[1] for s in slopes), c[0], c[1]],)

    def energies(p: Any, t: Any, x: Any) -> Any:
        kinetic: Any = 0.0
        potential: Any = 0.0
        for i in range(n):
            kinetic = kinetic + 0.5 * x[n + i] * x[n + i]
        for i in range(count):
            potential = potential + p[0] * x[2 * i + 1]
        return ((kinetic, potential, kinetic + potential),)

    sizes = (("qdot", n), ("M", n * (n + 1) // 2), ("r", n), ("G", nc * n), ("gamma", nc))
    functions = [
        trace("system", PTX, sizes, system),
        trace("position", PTX, (("phi", nc),), phi),
        trace("velocity", PTX, (("psi", nc),), psi),
        trace("gamma_sizes", PTX, (("s", nc),), lambda p, t, x: ([0.0] * nc,)),
        trace("gradient_sizes", PTX, (("s", nc),), lambda p, t, x: ([0.0] * nc,)),
        trace("scales", PTX, (("s", nc),), lambda p, t, x: ([r[2] * r[2] for r in rods],)),
        trace("reaches", (*PTX, "c"), (("s", 2 * nc + 2),), reaches),
        trace("energies", PTX, (("e", 3),), energies),
        trace("start", ("p",), (("x", 2 * n),), lambda p: (list(start),)),
    ]
    return program(name, n, n, nc, nc, functions, {"g": 9.81}, solve="looped")


def four_bar(count: int, angle: float, speed: float, spare: bool = False) -> Program:
    """`count` parallelograms in a row: cranks of length 1 on the places (i, 0), at `angle` and turning
    with `speed`, masses at their ends, joined by rods of length 1.  All are in line at angle 0 and pi,
    where motions that keep the cranks parallel meet others.  `spare`: one more rod from the first
    mass to the last.
    """
    rods: list[Rod] = []
    places: list[float] = []
    for i in range(count + 1):
        rods.append(((float(i), 0.0), i, 1.0))
        places += [i + cos(angle), sin(angle)]
        if i:
            rods.append((i - 1, i, 1.0))
    if spare:
        rods.append((0, count, float(count)))
    speeds = [-speed * sin(angle), speed * cos(angle)] * (count + 1)
    return points("four_bar", count + 1, rods, [*places, *speeds])
