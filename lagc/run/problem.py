"""Problem: all that integrators, projection and start-up know of a mechanical system.

A compiled model is one implementation (NumPy module or C library), a hand-written class in a
test another.  States are plain lists of floats, x = (q, v, z); see `architecture` in the docs
for the equation and its names.  Statuses, options and trajectories are those of generated modules.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Protocol

from lagc.optimize.program import Interface
from lagc.render.numpy.support.base import (
    FAILED,
    INCONSISTENT,
    INTERRUPTED,
    MAX_STEPS,
    NOT_FINITE,
    OK,
    REDUNDANT,
    SINGULAR_MASS,
    STEP_UNDERFLOW,
    Options,
    Trajectory,
)
from lagc.render.numpy.support.problem import Problem, Vector

__all__ = [
    "FAILED", "INCONSISTENT", "INTERRUPTED", "MAX_STEPS", "NOT_FINITE", "OK", "REDUNDANT", "SINGULAR_MASS",
    "STEP_UNDERFLOW", "Options", "Problem", "System", "Trajectory", "Vector",
]  # fmt: skip


class System(Problem, Protocol):
    """A compiled model with its parameters bound: a Problem with names, energies, outputs.

    Backends (`lagc.run.backends`): NumPy module, C library.  `parameters` is the array p and may
    be changed between calls.
    """

    interface: Interface
    parameters: list[float]
    backend: str

    def integrate(
        self,
        options: Options,
        t0: float,
        x0: Vector,
        times: Sequence[float],
        progress: Callable[[float], None] | None = None,
    ) -> Trajectory:
        """From (t0, x0), consistent, to times[-1] exactly; states at `times` by dense output.

        KeyboardInterrupt raised in `progress` ends it with what was computed (status INTERRUPTED).
        """
        ...

    def accelerations(self, t: float, x: Vector) -> tuple[list[float], list[float]]:
        """(a[nv], lam[nc])."""
        ...

    def energies(self, t: float, x: Vector) -> list[float]: ...

    def outputs(self, t: float, x: Vector) -> list[float]: ...

    def start(self) -> list[float]: ...

    def initial(self, t: float, x: Vector) -> tuple[list[float], list[float]]:
        """c[ni] and J[ni*(nq+nv)] by rows."""
        ...
