"""The problems of the report: a model for lagc, and for other tools the equations as a person writes them.

`rates(f, x)` gives the derivatives of x = (q, v); `f` has sin, cos and sqrt for numbers or for expressions
of a tool.  Constraints are solved for their multipliers, in the coordinates of the model.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

Rates = Callable[[Any, Sequence[Any]], list[Any]]
G = 9.81
LINKS, LINK = 10, 0.2
TOP_A, TOP_C, TOP_MGL = 1.0, 0.5, 1.0
CRANK, ROD, FLYWHEEL, ROD_MASS, PISTON, BRAKE = 0.05, 0.15, 0.005, 0.4, 0.5, 0.005
STIFF, DAMPER = 1e6, 2e4
REBOUND = 0.8

SPRING = f"""\
model StiffSpring "A mass on a stiff spring with a damper, as a pendulum"
  coordinate Length s(start = 0.001 [m]);
  coordinate Angle theta(start = 60 [deg]);
  body bob = Particle(mass = 1 [kg], at = (1 [m] + s)*{{sin(theta), 0, -cos(theta)}});
  potential spring = 1/2*({STIFF:g} [N/m])*s^2;
  dissipation damper = 1/2*({DAMPER:g} [N.s/m])*der(s)^2;
  Gravity field(g = 9.81 [m/s2], direction = {{0, 0, -1}});
end StiffSpring;
"""
IMPACT = f"""\
model Impacts "A pendulum that meets a wall at its lowest point"
  coordinate Angle theta(start = 60 [deg]);
  body bob = Particle(mass = 1 [kg], at = (1 [m])*{{sin(theta), 0, -cos(theta)}});
  Gravity field(g = 9.81 [m/s2], direction = {{0, 0, -1}});
  when theta < 0 then
    reinit(der(theta), -{REBOUND}*der(theta));
  end when;
end Impacts;
"""


@dataclass(frozen=True)
class Problem:
    """`model`: a name of the library or a text; `states` in the order of x.  At an event x[0] falls below 0
    and x[1] is multiplied by -`rebound`."""

    name: str
    title: str
    model: str
    stop: float
    states: tuple[str, ...]
    rates: Rates
    scene: str | None = None
    parameters: dict[str, float] = field(default_factory=dict)
    starts: dict[str, float] = field(default_factory=dict)
    stiff: bool = False
    rebound: float = 0.0


def solve(matrix: Sequence[Sequence[Any]], right: Sequence[Any]) -> list[Any]:
    """Solve linear equations of numbers or expressions by elimination in the given order; numbers that are 0
    cost nothing."""
    m, b, n = [list(row) for row in matrix], list(right), len(right)

    def absent(x: Any) -> bool:
        return isinstance(x, float) and x == 0.0

    for k in range(n):
        for i in range(k + 1, n):
            if absent(m[i][k]):
                continue
            part = m[i][k] / m[k][k]
            for j in range(k + 1, n):
                if not absent(m[k][j]):
                    m[i][j] = m[i][j] - part * m[k][j]
            b[i] = b[i] - part * b[k]
    for k in reversed(range(n)):
        for j in range(k + 1, n):
            if not absent(m[k][j]):
                b[k] = b[k] - m[k][j] * b[j]
        b[k] = b[k] / m[k][k]
    return b


def double_pendulum(f: Any, x: Sequence[Any]) -> list[Any]:
    a, b, u, v = x
    c, s = f.cos(a - b), f.sin(a - b)
    first, second = -(s * v * v) - 2.0 * G * f.sin(a), s * u * u - G * f.sin(b)
    d = 2.0 - c * c
    return [u, v, (first - c * second) / d, (2.0 * second - c * first) / d]


def kepler(f: Any, state: Sequence[Any]) -> list[Any]:
    x, y, u, v = state
    square = x * x + y * y
    cube = square * f.sqrt(square)
    return [u, v, -x / cube, -y / cube]


def string_pendulum(f: Any, state: Sequence[Any]) -> list[Any]:
    x, z, u, v = state
    multiplier = (G * z - u * u - v * v) / (x * x + z * z)
    return [u, v, multiplier * x, multiplier * z - G]


def chain(f: Any, x: Sequence[Any]) -> list[Any]:
    n = LINKS
    angles, speeds = x[:n], x[n:]
    squares = [w * w for w in speeds]
    sines = [[f.sin(angles[i] - angles[j]) if i > j else 0.0 for j in range(n)] for i in range(n)]
    cosines = [[f.cos(angles[i] - angles[j]) if i > j else 1.0 for j in range(n)] for i in range(n)]
    right = []
    for i in range(n):
        force = -(G / LINK * (n - i)) * f.sin(angles[i])
        for j in range(n):
            if i > j:
                force = force - float(n - i) * sines[i][j] * squares[j]
            elif i < j:
                force = force + float(n - j) * sines[j][i] * squares[j]
        right.append(force)
    matrix = [[float(n - max(i, j)) * cosines[max(i, j)][min(i, j)] for j in range(n)] for i in range(n)]
    return [*speeds, *solve(matrix, right)]


def heavy_top(f: Any, x: Sequence[Any]) -> list[Any]:
    _, theta, _, u, v, w = x
    s, c = f.sin(theta), f.cos(theta)
    spin = w + u * c
    about = (TOP_C * spin * v - 2.0 * TOP_A * u * v * c) / (TOP_A * s)
    nod = u * u * s * c - TOP_C / TOP_A * spin * u * s + TOP_MGL / TOP_A * s
    return [u, v, w, about, nod, u * v * s - about * c]


def slider_crank(f: Any, x: Sequence[Any]) -> list[Any]:
    """M a = h + G^T lambda and G a = gamma."""
    phi, psi, _, u, v, w = x
    r, b, m = CRANK, ROD, ROD_MASS
    cp, sp, cs, ss = f.cos(phi), f.sin(phi), f.cos(psi), f.sin(psi)
    half = m * r * b / 2.0
    c, s = cp * cs - sp * ss, sp * cs + cp * ss  # of phi + psi
    across = -half * c
    matrix = [
        [FLYWHEEL + m * r * r, across, 0.0, r * sp, -(r * cp)],
        [across, m * b * b / 3.0, 0.0, b * ss, b * cs],
        [0.0, 0.0, PISTON, 1.0, 0.0],
        [r * sp, b * ss, 1.0, 0.0, 0.0],
        [-(r * cp), b * cs, 0.0, 0.0, 0.0],
    ]
    right = [
        -(BRAKE * u) - half * s * v * v, -(half * s * u * u), 0.0 * w,
        -(r * cp * u * u) - b * cs * v * v, b * ss * v * v - r * sp * u * u,
    ]  # fmt: skip
    return [u, v, w, *solve(matrix, right)[:3]]


def spring(f: Any, x: Sequence[Any]) -> list[Any]:
    s, theta, u, w = x
    length = 1.0 + s
    return [u, w, length * w * w - STIFF * s - DAMPER * u + G * f.cos(theta),
            -(G * f.sin(theta) + 2.0 * u * w) / length]  # fmt: skip


def pendulum(f: Any, x: Sequence[Any]) -> list[Any]:
    return [x[1], -G * f.sin(x[0])]


def named(*coordinates: str) -> tuple[str, ...]:
    return (*coordinates, *(f"der({q})" for q in coordinates))


PROBLEMS = (
    Problem("double_pendulum", "double pendulum, 10 s", "double_pendulum", 10.0, named("theta1", "theta2"),
            double_pendulum, starts={"theta1": 2.0, "theta2": 2.0}),
    Problem("kepler", "Kepler's ellipse, e = 0.6, 8 turns", "kepler", 50.0, named("x", "y"), kepler),
    Problem("string_pendulum", "pendulum in x and z, constrained", "string_pendulum", 10.0, named("x", "z"),
            string_pendulum),
    Problem("chain", "chain of ten links, 5 s", "chain", 5.0,
            named(*(f"th[{i}]" for i in range(1, LINKS + 1))), chain, parameters={"n": LINKS}),
    Problem("heavy_top", "heavy top, Euler's angles", "heavy_top", 10.0, named("phi", "theta", "psi"),
            heavy_top),
    Problem("slider_crank", "slider-crank, loop constraint", "slider_crank", 0.5, named("phi", "psi", "s"),
            slider_crank, scene="braked"),
    Problem("spring", "stiff damped spring pendulum", SPRING, 10.0, named("s", "theta"), spring, stiff=True),
    Problem("impacts", "pendulum with impacts on a wall", IMPACT, 10.0, named("theta"), pendulum,
            rebound=REBOUND),
)  # fmt: skip
