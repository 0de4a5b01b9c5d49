"""The interface between a compiled model and everything that runs it.

A compiled model (NumPy module or C library) implements `System`; so does a class in a test.  States are
plain lists of floats, x = (q, v, z) with coordinates, speeds and the work integral; see `architecture` in
the docs for the equations and their names.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Protocol

from lagc.base.records import dataclass
from lagc.codegen.python.support.base import FAILED, FIRST_LOOK, Options, Trajectory
from lagc.kernels.language.statuses import (
    CHATTERING,
    INCONSISTENT,
    INTERRUPTED,
    INVALID,
    MAX_STEPS,
    MISPLACED,
    NOT_CONVERGED,
    NOT_FINITE,
    OK,
    PARADOX,
    PENETRATION,
    REDUNDANT,
    SINGULAR_MASS,
    STEP_UNDERFLOW,
    TERMINATED,
)
from lagc.lowering.program import Interface

__all__ = [
    "CHATTERING",
    "DECLARED",
    "FAILED",
    "FIRST_LOOK",
    "FIXED",
    "INCONSISTENT",
    "INTERRUPTED",
    "INVALID",
    "MAX_STEPS",
    "MISPLACED",
    "NOT_CONVERGED",
    "NOT_FINITE",
    "OK",
    "PARADOX",
    "PENETRATION",
    "REDUNDANT",
    "RUN",
    "SCENE",
    "SINGULAR_MASS",
    "STEP_UNDERFLOW",
    "TERMINATED",
    "UNSTATED",
    "Checked",
    "Options",
    "System",
    "Trajectory",
    "Vector",
    "arrived",
    "contradicting",
    "contradiction",
    "rates_at",
    "row_gradients",
]  # fmt: skip

Vector = Sequence[float]
MOST_NAMED = 6  # constraints in a message
_PART = 1e-6  # of the size of a gradient, that of a combination which is no round-off

# How firmly an initial value is stated: see `lagc.kernels.initialization.workspace`.
UNSTATED, DECLARED, SCENE, RUN, FIXED = range(5)


@dataclass(frozen=True, slots=True)
class Checked:
    """A run whose error is known by a check in lock step (`kernels/verification`).

    By quantity (coordinates, speeds, outputs, discrete variables): `errors`, their `scales`, the `sizes` of
    their terms, and 1 in `constant` if it does not move, 2 if round-off keeps it from the accuracy of its own
    range, so that it has the scale of its scaling group.  `estimated` is the largest error over scale,
    infinite if the run did not reach its end; the accuracy is met `until` this time.  `rtol` is the tolerance
    of the run, `alone` tells that it is relative to each state alone.  `rhs` counts the evaluations of all
    `attempts`.  `work_error` is that of the work integral, in J, `time_error` that of the times of jumps, in
    s."""

    trajectory: Trajectory
    errors: list[float]
    scales: list[float]
    sizes: list[float]
    constant: list[int]
    estimated: float
    until: float
    rtol: float
    alone: bool
    attempts: int
    rhs: int
    work_error: float = 0.0
    time_error: float = 0.0


class System(Protocol):
    """A compiled model with its parameters: functions, names, energies, outputs. Immutable: its functions
    depend on their arguments alone, any number of threads may call them, and it pickles.  The result of
    `assemble` for `solve`, and `culprit`, belong to the thread."""

    interface: Interface
    backend: str
    nq: int
    nv: int
    nz: int
    nc: int
    nh: int
    nx: int
    quaternions: tuple[int, ...]

    @property
    def culprit(self) -> int: ...

    @property
    def parameters(self) -> Sequence[float]:
        """The array p: parameters, then inputs."""
        ...

    def bind(self, values: Sequence[float]) -> System:
        """The same model with other values of p."""
        ...

    def on(self, t: float, x: Vector) -> System:
        """The same system on the branch of (t, x): the modes of all relations stay fixed.  Its integrations
        are as usual."""
        ...

    def integrate(
        self,
        options: Options,
        t0: float,
        x0: Vector,
        times: Sequence[float],
        progress: Callable[[float], None] | None = None,
    ) -> Trajectory:
        """Integrate from the consistent state (t0, x0) to times[-1]; the states at `times` come from dense
        output. KeyboardInterrupt raised in `progress` ends the run with the results so far (status
        INTERRUPTED)."""
        ...

    def verify(
        self,
        options: Options,
        x0: Vector,
        times: Sequence[float],
        accuracy: float,
        scales: Vector,
        progress: Callable[[float], None] | None = None,
    ) -> Checked:
        """Integrate as `integrate` does from (times[0], x0), with a tolerance for which the error of each
        quantity is at most `accuracy` of its scale: its range, or of `scales` the one that is positive. Of
        the options, `method`, `max_step`, `report` and `watch` are used."""
        ...

    def rhs(self, t: float, x: Vector, xdot: list[float], lam: list[float]) -> int: ...

    def position(self, t: float, x: Vector) -> list[float]: ...

    def velocity(self, t: float, x: Vector) -> list[float]: ...

    def scales(self, t: float, x: Vector) -> list[float]: ...

    def assemble(self, t: float, x: Vector) -> int: ...

    def solve(self, r: Vector) -> list[float]: ...

    def displace(self, t: float, x: Vector, d: Vector) -> list[float]: ...

    def accelerations(self, t: float, x: Vector) -> tuple[list[float], list[float]]:
        """Return (a[nv], lam[nc])."""
        ...

    def energies(self, t: float, x: Vector) -> list[float]: ...

    def gaps(self, t: float, x: Vector) -> list[float]:
        """The gap of each contact."""
        ...

    def seated(self, t: float, x: Vector) -> list[float]:
        """x, projected onto the constraints and onto the contacts that touch by their modes in x."""
        ...

    def outputs(self, t: float, x: Vector) -> list[float]: ...

    def output_columns(self, times: Vector, states: Sequence[Vector]) -> list[Sequence[float]]:
        """The values of each output at all of these states."""
        ...

    def start(self) -> list[float]: ...

    def conditions(self, t: float, x: Vector) -> tuple[list[float], list[float], list[float]]:
        """Return c, J and the sizes of the initial equations (see `Program`)."""
        ...

    def limits(self) -> list[float]:
        """The derived values that have bounds (`interface.limits`)."""
        ...

    def measures(self) -> tuple[list[float], list[float]]:
        """Return s and the largest values (see `Program`)."""
        ...


def arrived(run: Trajectory) -> bool:
    """Whether a run reached its end, or was terminated by a `when` clause."""
    return run.status in (OK, TERMINATED)


def rates_at(system: System, t: float, x: Sequence[float]) -> list[float] | None:
    """Return dx/dt at (t, x), or None if it is not determined."""
    xdot, lam = [0.0] * system.nx, [0.0] * system.nc
    return None if system.rhs(t, x, xdot, lam) in (*FAILED, PARADOX) else xdot


def row_gradients(system: System, t: float, x: Sequence[float]) -> list[list[float]]:
    """The gradients of all constraints in the speeds, nc x nv."""
    interface, slopes = system.interface, system.conditions(t, x)[1]
    found = []
    for k in range(system.nh, system.nh + system.nc):
        row = [0.0] * system.nv
        for place in interface.condition_entries(k):
            j = interface.condition_columns[place] - system.nq
            if 0 <= j < system.nv:
                row[j] = slopes[place]
        found.append(row)
    return found


class Counted:
    """`system` with a count of its evaluations outside of integrations, for the cost of a run."""

    def __init__(self, system: System):
        self.system, self._counts = system, [0]

    @property
    def evaluations(self) -> int:
        return self._counts[0]

    def bind(self, values: Sequence[float]) -> Counted:
        """The system with other parameters and the same count."""
        return self.share_count(self.system.bind(values))

    def on(self, t: float, x: Vector) -> Counted:
        """The system on the branch of (t, x) with the same count."""
        return self.share_count(self.system.on(t, x))

    def share_count(self, system: System) -> Counted:
        """Return a record of another system that shares the count."""
        found = Counted(system)
        found._counts = self._counts
        return found

    def __getattr__(self, name: str) -> Any:
        return getattr(self.system, name)

    def rhs(self, t: float, x: Vector, xdot: list[float], lam: list[float]) -> int:
        self._counts[0] += 1
        return self.system.rhs(t, x, xdot, lam)

    def energies(self, t: float, x: Vector) -> list[float]:
        self._counts[0] += 1
        return self.system.energies(t, x)


def work_of(system: System, x: Sequence[float]) -> float:
    """The work integral of a state; 0 if there is none."""
    return x[system.nq + system.nv] if system.nz else 0.0


def state_name(system: System, k: int) -> str:
    """The name of state k (an index of x) for a message."""
    names = system.interface.state_names
    if 0 <= k < len(names):
        return f"`{names[k]}`"
    first = system.nq + system.nv + system.nz
    if first <= k < system.nx:
        return f"`{system.interface.discretes[k - first].name}`"
    return "the work of the given actions" if k == len(names) else "a state"


def speed_name(system: System, k: int) -> str:
    names = system.interface.v_names
    return f"`{names[k]}`" if 0 <= k < len(names) else "some speed"


def idle_actuator(system: System, status: int, culprit: int) -> tuple[str, str] | None:
    """Return the constraint equation of an evaluation that failed since its actuator cannot hold it, and the
    actuator; None if that is not the reason."""
    row = culprit - len(system.interface.contacts)
    if status != PARADOX or not 0 <= row < system.nc:
        return None
    label = system.interface.row_labels[row]
    actuator = dict(system.interface.servos).get(label.partition("[")[0])
    return (label, actuator) if actuator else None


def row_name(system: System, k: int) -> str:
    labels = system.interface.row_labels
    return f"constraint `{labels[k]}`" if 0 <= k < len(labels) else "a constraint"


def contradicting(system: System, t: float, x: Sequence[float], k: int) -> list[int]:
    """Constraint k, and those whose gradients combine to its own at (t, x)."""
    from lagc.mechanics.identities.linear_algebra import least_norm  # where a run failed

    if k < 0:
        return []
    gradients = row_gradients(system, t, x)
    others = [i for i in range(system.nc) if i != k]
    factors = least_norm([[gradients[i][j] for i in others] for j in range(system.nv)], gradients[k])
    parts = [abs(factor) * max(map(abs, gradients[i]), default=0.0) for i, factor in zip(others, factors)]
    least = _PART * max(map(abs, gradients[k]), default=0.0)
    return sorted([k, *(i for i, part in zip(others, parts) if part > least)])


def contradiction(system: System, rows: Sequence[int], where: str = "") -> str:
    """The message for constraints that contradict each other; `where` follows."""
    names = "".join([f" `{system.interface.row_labels[k]}`," for k in rows[:MOST_NAMED]]).rstrip(",")
    return f"the constraints{names}{more(rows, MOST_NAMED)} contradict each other{where}"


def more(parts: Sequence[object], most: int) -> str:
    """ " and N more" if `parts` has more than `most` entries."""
    return f" and {len(parts) - most} more" if len(parts) > most else ""


def event_names(system: System, k: int) -> tuple[str, ...]:
    """The names of an event: of a relation or, behind the relations, of a `when` clause."""
    relations = system.interface.relations
    return (relations[k],) if k < len(relations) else system.interface.whens[k - len(relations)].names
