"""Mechanical systems written by hand, for the runner's tests: no stage of the compiler is used."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from copy import copy
from math import cos, exp, pi, sin, sqrt
from typing import Any

from lagc.lowering.program import Interface
from lagc.simulation.system import NOT_FINITE, OK, SINGULAR_MASS, Checked, Options, Trajectory, Vector
from tests.interfaces import field, interface
from tests.simulation.handmade import integrate, verify

# What one coordinate x, or two coordinates x and y, are called.
LINE: dict[str, Any] = {"q_names": ("x",), "v_names": ("der(x)",), "q_units": ("m",), "v_units": ("m/s",)}
PLANE: dict[str, Any] = {
    "nq": 2, "nv": 2, "q_names": ("x", "y"), "v_names": ("der(x)", "der(y)"), "q_units": ("m",) * 2,
    "v_units": ("m/s",) * 2,
}  # fmt: skip


class Handmade(ABC):
    """What the systems below share: sizes, and the integrators of lagc."""

    backend = "hand"
    culprit = -1

    def __init__(self, interface: Interface) -> None:
        self.interface = interface
        self.nq, self.nv, self.nz = interface.nq, interface.nv, interface.nz
        self.nc, self.nh, self.quaternions = interface.nc, interface.nh, interface.quaternions
        self.kinds = interface.kinds
        self.parameters = [f.value or 0.0 for f in interface.parameters]
        self.runs: list[Options] = []

    @property
    def nx(self) -> int:
        return self.nq + self.nv + self.nz

    def bind(self, values: Sequence[float]) -> Handmade:
        other = copy(self)
        other.parameters = list(values)
        return other

    def on(self, t: float, x: Vector) -> Handmade:
        return self

    def displace(self, t: float, x: Vector, d: Vector) -> list[float]:
        return list(d)

    def position(self, t: float, x: Vector) -> list[float]:
        return []

    def gaps(self, t: float, x: Vector) -> list[float]:
        return []

    def velocity(self, t: float, x: Vector) -> list[float]:
        return []

    def scales(self, t: float, x: Vector) -> list[float]:
        return []

    def reaches(self, t: float, x: Vector, sizes: Sequence[float]) -> list[float]:
        return []

    def assemble(self, t: float, x: Vector) -> int:
        return OK

    def solve(self, r: Vector) -> list[float]:
        return list(r)

    def energies(self, t: float, x: Vector) -> list[float]:
        return [0.0, 0.0, 0.0]

    def outputs(self, t: float, x: Vector) -> list[float]:
        return []

    def output_columns(self, times: Vector, states: Sequence[Vector]) -> list[Sequence[float]]:
        return [*zip(*map(self.outputs, times, states))] or [()] * len(self.interface.outputs)

    def conditions(self, t: float, x: Vector) -> tuple[list[float], list[float], list[float]]:
        return [], [], []

    def measures(self) -> tuple[list[float], list[float]]:
        return [], [0.0] * len(set(self.interface.start_units))

    @abstractmethod
    def rhs(self, t: float, x: Vector, xdot: list[float], lam: list[float]) -> int: ...

    def accelerations(self, t: float, x: Vector) -> tuple[list[float], list[float]]:
        xdot, lam = [0.0] * self.nx, [0.0] * self.nc
        self.rhs(t, x, xdot, lam)
        return xdot[self.nq : self.nq + self.nv], lam

    def integrate(
        self,
        options: Options,
        t0: float,
        x0: Vector,
        times: Sequence[float],
        progress: Callable[[float], None] | None = None,
    ) -> Trajectory:
        self.runs.append(options)
        return integrate(self, options, t0, x0, times, progress)

    def verify(
        self,
        options: Options,
        x0: Vector,
        times: Sequence[float],
        accuracy: float,
        scales: Vector,
        progress: Callable[[float], None] | None = None,
    ) -> Checked:
        found = verify(self, options, x0, times, accuracy, scales, progress)
        self.runs.append(options)
        return found


class Oscillator(Handmade):
    """x'' = -k x, with an output 2 x.  x = cos(sqrt(k) t) from x = 1."""

    def __init__(self, **given: Any) -> None:
        own = {"parameters": (field("k", 1.0, "N/m"),), "outputs": (field("double", None, "m"),)}
        super().__init__(interface(**{**LINE, **own, **given}))

    def start(self) -> list[float]:
        return [1.0, 0.0]

    def rhs(self, t: float, x: Vector, xdot: list[float], lam: list[float]) -> int:
        xdot[0], xdot[1] = x[1], -self.parameters[0] * x[0]
        return OK

    def energies(self, t: float, x: Vector) -> list[float]:
        kinetic, potential = 0.5 * x[1] * x[1], 0.5 * self.parameters[0] * x[0] * x[0]
        return [kinetic, potential, kinetic + potential]

    def outputs(self, t: float, x: Vector) -> list[float]:
        return [2.0 * x[0]]


class Pendulum(Handmade):
    """Unit mass at (x, y), x^2 + y^2 = l^2, in gravity g; the guess is off the circle."""

    def __init__(self, guess: Sequence[float] = (0.6, -0.9, 0.5, 0.5), **given: Any) -> None:
        own: dict[str, Any] = {
            "nc": 1, "nh": 1, "row_labels": ("string",), "row_units": ("m2",),
            "condition_ends": (2, 6), "condition_columns": (0, 1, 0, 1, 2, 3),
            "parameters": (field("l", 1.0, "m"), field("g", 9.81, "m/s2")),
        }  # fmt: skip
        super().__init__(interface(**{**PLANE, **own, **given}))
        self.guess = list(guess)

    def start(self) -> list[float]:
        return list(self.guess)

    def position(self, t: float, x: Vector) -> list[float]:
        return [x[0] * x[0] + x[1] * x[1] - self.parameters[0] ** 2]

    def velocity(self, t: float, x: Vector) -> list[float]:
        return [2.0 * (x[0] * x[2] + x[1] * x[3])]

    def scales(self, t: float, x: Vector) -> list[float]:
        return [max(1e-30, x[0] * x[0] + x[1] * x[1] + self.parameters[0] ** 2)]

    def conditions(self, t: float, x: Vector) -> tuple[list[float], list[float], list[float]]:
        a, b, u, v = [2.0 * s for s in x[:4]]
        return (
            [*self.position(t, x), *self.velocity(t, x)],
            [a, b, u, v, a, b],
            [*self.scales(t, x), abs(x[0] * u) + abs(x[1] * v)],
        )

    def reaches(self, t: float, x: Vector, sizes: Sequence[float]) -> list[float]:
        slopes = 2.0 * (abs(x[0]) + abs(x[1]))
        return [slopes * sizes[1], slopes * sizes[2]]

    def rhs(self, t: float, x: Vector, xdot: list[float], lam: list[float]) -> int:
        a, b, u, v = x[:4]
        lam[0] = (self.parameters[1] * b - u * u - v * v) / (2.0 * (a * a + b * b))
        xdot[:4] = [u, v, 2.0 * a * lam[0], 2.0 * b * lam[0] - self.parameters[1]]
        return OK

    def energies(self, t: float, x: Vector) -> list[float]:
        kinetic, potential = 0.5 * (x[2] ** 2 + x[3] ** 2), self.parameters[1] * x[1]
        return [kinetic, potential, kinetic + potential]


class Rod(Pendulum):
    """The pendulum with its linear equations: M = 1, G = 2 (x, y)."""

    def assemble(self, t: float, x: Vector) -> int:
        self.g = 2.0 * x[0], 2.0 * x[1]
        return OK

    def solve(self, r: Vector) -> list[float]:
        a, b = self.g
        s = (r[2] - a * r[0] - b * r[1]) / (a * a + b * b)
        return [r[0] + a * s, r[1] + b * s, s]


class Spun(Handmade):
    """A free orientation `o` turning at constant body rates: a quaternion and three speeds."""

    def __init__(self, guess: Sequence[float]) -> None:
        super().__init__(
            interface(
                nq=4,
                nv=3,
                q_names=("o.w", "o.x", "o.y", "o.z"),
                v_names=("o.rate.x", "o.rate.y", "o.rate.z"),
                q_units=("",) * 4,
                v_units=("rad/s",) * 3,
                quaternions=(0,),
            )
        )
        self.guess = list(guess)

    def start(self) -> list[float]:
        return list(self.guess)

    def rhs(self, t: float, x: Vector, xdot: list[float], lam: list[float]) -> int:
        w, i, j, k, a, b, c = x
        xdot[:4] = [0.5 * r for r in (-i * a - j * b - k * c, w * a + j * c - k * b,
                                      w * b + k * a - i * c, w * c + i * b - j * a)]  # fmt: skip
        xdot[4:] = [0.0, 0.0, 0.0]
        return OK


class Kepler(Handmade):
    """A planet about a fixed sun with GM = 1 and semi-major axis 1, from the pericentre."""

    def __init__(self, eccentricity: float = 0.9) -> None:
        super().__init__(interface(**PLANE, parameters=(field("e", eccentricity),)))

    def start(self) -> list[float]:
        e = self.parameters[0]
        return [1.0 - e, 0.0, 0.0, sqrt((1.0 + e) / (1.0 - e))]

    def rhs(self, t: float, x: Vector, xdot: list[float], lam: list[float]) -> int:
        a, b, u, v = x
        cube = (a * a + b * b) * sqrt(a * a + b * b)
        xdot[:] = [u, v, -a / cube, -b / cube]
        return OK

    def exact(self, t: float) -> tuple[float, float]:
        """By Kepler's equation, M = E - e sin E, with Newton's iteration."""
        e, mean = self.parameters[0], t % (2.0 * pi)
        anomaly = mean if e < 0.8 else pi
        for _ in range(60):
            anomaly -= (anomaly - e * sin(anomaly) - mean) / (1.0 - e * cos(anomaly))
        return cos(anomaly) - e, sqrt(1.0 - e * e) * sin(anomaly)


class DoublePendulum(Handmade):
    """Two unit masses on unit rods, thrown high: chaotic."""

    def __init__(self) -> None:
        super().__init__(interface(nq=2, nv=2, q_units=("rad",) * 2, v_units=("rad/s",) * 2))

    def start(self) -> list[float]:
        return [2.5, 2.5, 0.0, 0.0]

    def rhs(self, t: float, x: Vector, xdot: list[float], lam: list[float]) -> int:
        a, b, u, v = x
        g, c, s = 9.81, cos(a - b), sin(a - b)
        f1 = -s * v * v - 2.0 * g * sin(a)
        f2 = s * u * u - g * sin(b)
        d = 2.0 - c * c
        xdot[:] = [u, v, (f1 - c * f2) / d, (2.0 * f2 - c * f1) / d]
        return OK


class Runaway(Handmade):
    """x' = v, v' = exp(x): reaches infinity in finite time."""

    def __init__(self) -> None:
        super().__init__(interface(**LINE))

    def start(self) -> list[float]:
        return [0.0, 1.0]

    def rhs(self, t: float, x: Vector, xdot: list[float], lam: list[float]) -> int:
        if x[0] > 700.0:
            self.culprit = 1
            return NOT_FINITE
        xdot[:] = [x[1], exp(x[0])]
        return OK


class Massless(Handmade):
    """The mass vanishes when x passes 1."""

    def __init__(self) -> None:
        super().__init__(interface(**LINE))

    def start(self) -> list[float]:
        return [0.0, 1.0]

    def rhs(self, t: float, x: Vector, xdot: list[float], lam: list[float]) -> int:
        if x[0] >= 1.0:
            self.culprit = 0
            return SINGULAR_MASS
        xdot[:] = [x[1], 0.0]
        return OK


def norm(values: Sequence[float]) -> float:
    return sqrt(sum(v * v for v in values))
