"""The handmade systems with the integrators of lagc in place of their own."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import cos, exp, pi, sin, sqrt

from lagc.simulation.system import NOT_FINITE, OK, SINGULAR_MASS, Checked, Options, Trajectory, Vector
from tests.interfaces import field, interface
from tests.simulation import systems
from tests.simulation.handmade import integrate, verify
from tests.simulation.systems import LINE, PLANE, Handmade


class Integrated(Handmade):
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


class Oscillator(Integrated, systems.Oscillator):
    """x'' = -k x from x = 1."""


class Pendulum(Integrated, systems.Rod):
    """Unit mass on a string, in x and y."""


class Kepler(Integrated):
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


class DoublePendulum(Integrated):
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


class Runaway(Integrated):
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


class Massless(Integrated):
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
