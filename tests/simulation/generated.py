"""Small models as Programs, each with its equations of motion written out by hand."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from lagc.lowering.program import Function, Program
from tests.simulation.traced import PTX, cos, program, sin, trace

GOOD = (1.0, 0.0)  # health of a solve


def double_pendulum() -> Program:
    """Two equal point masses on rods of length l, absolute angles; no constraints."""

    def equations(p: Any, t: Any, x: Any) -> tuple[Sequence[Any], Sequence[Any]]:
        m, length, g = p[0], p[1], p[2]
        a, b, u, v = x[0], x[1], x[2], x[3]
        c, s = cos(a - b), sin(a - b)
        mass = (2.0 * m * length * length, m * length * length * c, m * length * length)
        coupling, weight = m * length * length * s, m * g * length
        force = (-(coupling * v * v) - 2.0 * weight * sin(a), coupling * u * u - weight * sin(b))
        return mass, force

    def rhs(p: Any, t: Any, x: Any) -> Any:
        (m11, m21, m22), (f1, f2) = equations(p, t, x)
        low = m21 / m11
        pivot = m22 - low * m21
        b = (f2 - low * f1) / pivot
        return (x[2], x[3], (f1 - m21 * b) / m11, b), (), (pivot / m22, 0.0)

    def system(p: Any, t: Any, x: Any) -> Any:
        mass, force = equations(p, t, x)
        return (x[2], x[3]), mass, force, (), ()

    functions = [
        trace("rhs", PTX, (("xdot", 4), ("lam", 0), ("health", 2)), rhs),
        trace("system", PTX, (("qdot", 2), ("M", 3), ("r", 2), ("G", 0), ("gamma", 0)), system),
        trace("start", ("p",), (("x", 4),), lambda p: ((2.0, 2.5, 0.0, 0.0),)),
        trace("energies", PTX, (("e", 3),), _double_energy),
    ]
    return program("double_pendulum", 2, 2, 0, 0, functions, {"m": 1.0, "l": 1.0, "g": 9.81})


def _double_energy(p: Any, t: Any, x: Any) -> Any:
    m, length, g = p[0], p[1], p[2]
    a, b, u, v = x[0], x[1], x[2], x[3]
    kinetic = m * length * length * (u * u + 0.5 * v * v + u * v * cos(a - b))
    potential = -(m * g * length * (2.0 * cos(a) + cos(b)))
    return ((kinetic, potential, kinetic + potential),)


def pendulum(
    copies: Sequence[float] = (1.0,), straight: bool = True, gamma: Sequence[float] | None = None
) -> Program:
    """A point mass (x, y) on a rod of length l; row k is copies[k] (x^2 + y^2 - l^2)/2 = 0.

    Its acceleration, with `gamma`, is that many m/s^2 t wrong.  With dependent rows the straight
    solve reports a vanishing pivot, as an LDL^T would.
    """
    nc = len(copies)
    wrong = gamma or (0.0,) * nc

    def rows(p: Any, t: Any, x: Any) -> tuple[list[Any], list[Any]]:
        g = [c * x[i] for c in copies for i in (0, 1)]
        speed = x[2] * x[2] + x[3] * x[3]
        return g, [-(c * speed) + e * t for c, e in zip(copies, wrong)]

    def system(p: Any, t: Any, x: Any) -> Any:
        g, right = rows(p, t, x)
        return (x[2], x[3]), (p[0], 0.0, p[0]), (0.0, -(p[0] * p[2])), g, right

    def rhs(p: Any, t: Any, x: Any) -> Any:
        g, right = rows(p, t, x)
        schur = (g[0] * g[0] + g[1] * g[1]) / p[0]
        lam = (right[0] + g[1] * p[2]) / schur
        a = (g[0] * lam / p[0], g[1] * lam / p[0] - p[2])
        return (x[2], x[3], *a), (lam, *((0.0,) * (nc - 1))), GOOD if nc == 1 else (0.0, 0.0)

    def solve(w: Any, r: Any) -> Any:
        """w = (m, gx, gy, schur)."""
        s = (r[2] - (w[1] * r[0] + w[2] * r[1]) / w[0]) / w[3]
        return (((r[0] + w[1] * s) / w[0], (r[1] + w[2] * s) / w[0], s, *((0.0,) * (nc - 1))),)

    def refine(w: Any, r: Any, s: Any) -> Any:
        rest = (
            r[0] - (w[0] * s[0] - w[1] * s[2]),
            r[1] - (w[0] * s[1] - w[2] * s[2]),
            r[2] - (w[1] * s[0] + w[2] * s[1]),
        )
        d = solve(w, rest)[0]
        return ((s[0] + d[0], s[1] + d[1], s[2] + d[2], *((0.0,) * (nc - 1))),)

    def factor(w: Any) -> Any:
        schur = (w[1] * w[1] + w[2] * w[2]) / w[0]
        return (w[0], w[1], w[2], schur), GOOD if nc == 1 else (0.0, 0.0)

    def phi(p: Any, t: Any, x: Any) -> Any:
        return ([c * 0.5 * (x[0] * x[0] + x[1] * x[1] - p[1] * p[1]) for c in copies],)

    def psi(p: Any, t: Any, x: Any) -> Any:
        return ([c * (x[0] * x[2] + x[1] * x[3]) for c in copies],)

    def scales(p: Any, t: Any, x: Any) -> Any:
        return ([abs(c) * 0.5 * (x[0] * x[0] + x[1] * x[1] + p[1] * p[1]) for c in copies],)

    def reaches(p: Any, t: Any, x: Any, c: Any) -> Any:
        slopes = [abs(k) * abs(x[0]) + abs(k) * abs(x[1]) for k in copies]
        return ([*(s * c[0] for s in slopes), *(s * c[1] for s in slopes), c[0], c[1]],)

    functions = [
        trace("system", PTX, (("qdot", 2), ("M", 3), ("r", 2), ("G", 2 * nc), ("gamma", nc)), system),
        trace("reaches", (*PTX, "c"), (("s", 2 * nc + 2),), reaches),
        trace("position", PTX, (("phi", nc),), phi),
        trace("velocity", PTX, (("psi", nc),), psi),
        trace("gamma_sizes", PTX, (("s", nc),), lambda p, t, x: ([0.0] * nc,)),
        trace("gradient_sizes", PTX, (("s", nc),), lambda p, t, x: ([0.0] * nc,)),
        trace("scales", PTX, (("s", nc),), scales),
        trace("start", ("p",), (("x", 4),), lambda p: ((0.6, -0.8, 1.6, 1.2),)),
    ]
    if straight:
        functions += [
            trace("rhs", PTX, (("xdot", 4), ("lam", nc), ("health", 2)), rhs),
            trace("watch", ("p", "health"), (("health", 2),), lambda p, health: ((health[0], 0.0),)),
            trace("assemble", PTX, (("w", 4),), lambda p, t, x: ((p[0], *rows(p, t, x)[0][:2], 0.0),)),
            trace("factor", ("w",), (("w", 4), ("health", 2)), factor),
            trace("solve", ("w", "r"), (("s", 2 + nc),), solve),
            trace("refine", ("w", "r", "s"), (("s", 2 + nc),), refine),
        ]
    return program(
        "pendulum", 2, 2, nc, nc, functions, {"m": 2.0, "l": 1.0, "g": 9.81},
        solve="straight" if straight else "looped", work_size=4 if straight else 0,
    )  # fmt: skip


def turned(q: Sequence[Any], c: Sequence[Any]) -> list[Any]:
    """R(q) c for a unit quaternion q."""
    w, i, j, k = q
    a, b, d = c
    return [
        (1.0 - 2.0 * (j * j + k * k)) * a + 2.0 * (i * j - w * k) * b + 2.0 * (i * k + w * j) * d,
        2.0 * (i * j + w * k) * a + (1.0 - 2.0 * (i * i + k * k)) * b + 2.0 * (j * k - w * i) * d,
        2.0 * (i * k - w * j) * a + 2.0 * (j * k + w * i) * b + (1.0 - 2.0 * (i * i + j * j)) * d,
    ]


def cross(a: Sequence[Any], b: Sequence[Any]) -> list[Any]:
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


INERTIA = (0.4, 0.9, 1.1)
ARM = (0.3, 0.0, -0.7)  # from the centre of mass to the pivot


def body_on_a_pivot() -> Program:
    """A rigid body, place and unit quaternion, whose point ARM is held at the origin; gravity along -z.

    Speeds: velocity of the centre, angular velocity in body axes; work integral of gravity.
    """
    columns = [cross((1.0 * (i == 0), 1.0 * (i == 1), 1.0 * (i == 2)), ARM) for i in range(3)]

    def parts(x: Any) -> tuple[list[Any], list[Any], list[Any], list[Any]]:
        place = [x[i] for i in range(3)]
        q = [x[i] for i in range(3, 7)]
        v = [x[i] for i in range(7, 10)]
        omega = [x[i] for i in range(10, 13)]
        return place, q, v, omega

    def rates(q: Sequence[Any], o: Sequence[Any]) -> list[Any]:
        w, i, j, k = q
        return [
            0.5 * r
            for r in (-(i * o[0]) - j * o[1] - k * o[2], w * o[0] + j * o[2] - k * o[1],
                      w * o[1] + k * o[0] - i * o[2], w * o[2] + i * o[1] - j * o[0])
        ]  # fmt: skip

    def system(p: Any, t: Any, x: Any) -> Any:
        _, q, v, omega = parts(x)
        mass = []
        for i in range(6):
            mass += [0.0] * i + [p[0] if i < 3 else INERTIA[i - 3]]
        gyro = cross(omega, [a * b for a, b in zip(INERTIA, omega)])
        force = (0.0, 0.0, -(p[0] * p[1]), *(-a for a in gyro))
        turns = [turned(q, c) for c in columns]
        rows = []
        for i in range(3):
            rows += [1.0 * (i == j) for j in range(3)] + [turns[j][i] for j in range(3)]
        right = turned(q, cross(omega, cross(omega, ARM)))
        return (*v, *rates(q, omega)), mass, force, rows, [-a for a in right]

    def phi(p: Any, t: Any, x: Any) -> Any:
        place, q, _, _ = parts(x)
        return ([a + b for a, b in zip(place, turned(q, ARM))],)

    def psi(p: Any, t: Any, x: Any) -> Any:
        _, q, v, omega = parts(x)
        return ([a + b for a, b in zip(v, turned(q, cross(omega, ARM)))],)

    def displace(p: Any, t: Any, x: Any, d: Any) -> Any:
        return ((d[0], d[1], d[2], *rates([x[i] for i in range(3, 7)], [d[i] for i in range(3, 6)])),)

    def energies(p: Any, t: Any, x: Any) -> Any:
        place, _, v, omega = parts(x)
        kinetic = 0.5 * p[0] * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
        for a, o in zip(INERTIA, omega):
            kinetic = kinetic + 0.5 * a * o * o
        return ((kinetic, p[0] * p[1] * place[2], kinetic + p[0] * p[1] * place[2]),)

    functions: list[Function] = [
        trace("system", PTX, (("qdot", 7), ("M", 21), ("r", 6), ("G", 18), ("gamma", 3)), system),
        trace("position", PTX, (("phi", 3),), phi),
        trace("velocity", PTX, (("psi", 3),), psi),
        trace("gamma_sizes", PTX, (("s", 3),), lambda p, t, x: ((0.0, 0.0, 0.0),)),
        trace("gradient_sizes", PTX, (("s", 3),), lambda p, t, x: ((0.0, 0.0, 0.0),)),
        trace("scales", PTX, (("s", 3),), lambda p, t, x: ((1.0, 1.0, 1.0),)),
        trace("reaches", (*PTX, "c"), (("s", 8),), lambda p, t, x, c: ((*(c[0],) * 4, *(c[1],) * 4),)),
        trace("displace", (*PTX, "d"), (("dq", 7),), displace),
        trace("energies", PTX, (("e", 3),), energies),
        trace("power", PTX, (("e", 1),), lambda p, t, x: ((-(p[0] * p[1] * x[9]),),)),
    ]
    omega, place = (0.3, 2.0, 1.0), [-a for a in ARM]
    start = (*place, 1.0, 0.0, 0.0, 0.0, *(-a for a in cross(omega, ARM)), *omega, 0.0)
    functions.append(trace("start", ("p",), (("x", 14),), lambda p: (start,)))
    return program(
        "body", 7, 6, 3, 3, functions, {"m": 1.5, "g": 9.81}, nz=1, quaternions=(3,), solve="looped"
    )


def masses(matrix: Sequence[float], force: Callable[[Any], Sequence[Any]]) -> Program:
    """Two coordinates with a constant mass matrix (m11, m21, m22) and a force of x."""

    def system(p: Any, t: Any, x: Any) -> Any:
        return (x[2], x[3]), matrix, force(x), (), ()

    functions = [
        trace("system", PTX, (("qdot", 2), ("M", 3), ("r", 2), ("G", 0), ("gamma", 0)), system),
        trace("start", ("p",), (("x", 4),), lambda p: ((1.0, 1.0, -1.0, 0.0),)),
    ]
    return program("masses", 2, 2, 0, 0, functions, {}, solve="looped")
