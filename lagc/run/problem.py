"""Problem: all that integrators, projection and start-up know of a mechanical system.

A compiled model is one implementation (NumPy module or C library), a hand-written class in a
test another.  States are plain lists of floats, x = (q, v, z); see `architecture` in the docs
for the equation and its names.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

from lagc.optimize.program import Interface

Vector = Sequence[float]

OK = 0
SINGULAR_MASS = 1  # the mass matrix is not positive definite; `Problem.culprit` = index of v
REDUNDANT = 2  # rows are dependent: solved with least-norm multipliers; culprit = row
INCONSISTENT = 3  # rows contradict each other; culprit = row
NOT_FINITE = 4  # NaN or infinity; culprit = index of x
STEP_UNDERFLOW = 5
MAX_STEPS = 6
INTERRUPTED = 7


class Problem(Protocol):
    nq: int
    nv: int
    nz: int
    nc: int
    nh: int
    quaternions: tuple[int, ...]
    culprit: int

    @property
    def nx(self) -> int: ...

    def rhs(self, t: float, x: Vector, xdot: list[float], lam: list[float]) -> int:
        """Write xdot[nx] and the multipliers lam[nc]; a status above.  REDUNDANT is a success."""
        ...

    def position(self, t: float, x: Vector) -> list[float]:
        """phi[nh]."""
        ...

    def velocity(self, t: float, x: Vector) -> list[float]:
        """d(phi)/dt and psi, nc rows."""
        ...

    def scales(self, t: float, x: Vector) -> list[float]:
        """The size of each row's terms (nc, > 0): residuals are judged against it."""
        ...

    def assemble(self, t: float, x: Vector) -> int:
        """Form and factor [M G^T; G 0] at (t, x) for the `solve`s that follow; a status."""
        ...

    def solve(self, r: Vector) -> list[float]:
        """s = (s1, s2) with M s1 - G^T s2 = r1, G s1 = r2, from the last `assemble`."""
        ...

    def displace(self, t: float, x: Vector, d: Vector) -> list[float]:
        """dq = N(t,q) d."""
        ...


@dataclass(frozen=True)
class Options:
    """How to integrate one trajectory.

    `method` is a key of `lagc.run.methods.METHODS`.  `step` > 0 asks for fixed steps (rtol,
    atol unused).  `max_steps` 0 means no limit.  `project` False leaves the constraints to drift
    (for tests).
    """

    method: str = "dop853"
    rtol: float = 1e-9
    atol: float = 1e-9
    step: float = 0.0
    first_step: float = 0.0  # 0: chosen
    max_step: float = 0.0  # 0: no limit
    max_steps: int = 0
    project: bool = True


@dataclass
class Trajectory:
    """States at the asked times (as many as were reached), and what it took.

    `status` OK, or what stopped it, at time `t` with state `x` (kept) and `culprit`.
    `position_drift`, `velocity_drift`: largest scaled residuals over the accepted steps.
    """

    times: list[float]
    states: list[list[float]]
    t: float
    x: list[float]
    status: int = OK
    culprit: int = -1
    steps: int = 0
    rejected: int = 0
    rhs: int = 0
    fallbacks: int = 0  # solves that needed the pivoted QR
    redundant_rows: tuple[int, ...] = ()
    position_drift: float = 0.0
    velocity_drift: float = 0.0


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
