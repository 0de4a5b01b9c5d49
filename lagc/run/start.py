"""A consistent start: the guesses changed as little as the conditions at the start demand.

Unknowns are the coordinates and speeds that are not held; conditions are phi = 0, the rates of
all rows, unit quaternions, and the `initial` section.  Gauss-Newton with steps of minimum norm,
each unknown weighted by max(|x|, 1); positions first, then speeds, and all together where a
condition ties both.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from math import isfinite, sqrt

from lagc.records import dataclass
from lagc.run.leastnorm import least_norm
from lagc.run.problem import System

TARGET = 1e-13  # scaled residual at which the iteration is content
ACCEPTED = 1e-9  # and at which a start is taken, when it can be improved no more
_ITERATIONS = 60
_SPREADS = (0.0, 0.01, 0.1, 0.5, 1.0)  # how far from the guesses further attempts begin


@dataclass(frozen=True, slots=True)
class Change:
    """A start value that was not as given; SI."""

    name: str
    given: float
    used: float
    unit: str

    def __str__(self) -> str:
        unit = f" {self.unit}" if self.unit else ""
        return f"`{self.name}` starts at {self.used:.6g}{unit} instead of {self.given:.6g}{unit}"


@dataclass(frozen=True, slots=True)
class Missed:
    """A condition that the start does not meet: `name` as the user knows it, by how much (SI)."""

    name: str
    amount: float
    unit: str

    def __str__(self) -> str:
        return f"{self.name} is missed by {self.amount:.3g}{' ' + self.unit if self.unit else ''}"


@dataclass(frozen=True, slots=True)
class Start:
    """The state to begin with.  `missed` is empty where it is consistent."""

    x: list[float]
    changes: tuple[Change, ...] = ()
    missed: tuple[Missed, ...] = ()
    held: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class _Condition:
    """One scalar equation: what it is called, and whether it speaks of positions only."""

    name: str
    unit: str
    is_position: bool


def names(system: System) -> list[str]:
    """Of x[:nq+nv]."""
    return [*system.interface.q_names, *system.interface.v_names]


def consistent_start(
    system: System, t: float = 0.0, given: dict[str, float] | None = None, held: Collection[str] = ()
) -> Start:
    """The start of `system` at time `t`, with the values of `given` (by name) in place of the model's.

    Names in `held` keep their value, like the ones that the model holds, unless no start is
    consistent with them; then they are guesses too.
    """
    interface = system.interface
    every = names(system)
    guess = list(system.start())
    for i, name in enumerate(every):
        if given and name in given:
            guess[i] = given[name]
    fixed = list(interface.start_fixed)
    wanted = guess[:]
    _normalise(guess, system.quaternions)
    if system.nc == 0 and not interface.initial_places and not system.quaternions:
        return Start(guess)
    strict = [f or name in held for f, name in zip(fixed, every)]
    search = _Search(system, t, guess)
    x, worst = search.run(strict)
    if worst > ACCEPTED and strict != fixed:
        strict = fixed
        x, worst = search.run(strict)
    units = [*interface.q_units, *interface.v_units]
    changes = tuple(
        Change(name, a, b, unit)
        for name, a, b, unit in zip(every, wanted, x, units)
        if abs(a - b) > 1e-9 * max(abs(a), 1.0)
    )
    if worst <= ACCEPTED:
        return Start(x, changes)
    return Start(x, changes, search.missed(x), tuple(n for n, f in zip(every, strict) if f))


def _normalise(x: list[float], quaternions: Sequence[int]) -> None:
    for k in quaternions:
        length = sqrt(sum(x[i] * x[i] for i in range(k, k + 4)))
        if length == 0.0:
            x[k : k + 4] = [1.0, 0.0, 0.0, 0.0]
        else:
            x[k : k + 4] = [x[i] / length for i in range(k, k + 4)]


class _Search:
    """The conditions of one system at one time, and the iteration that meets them."""

    def __init__(self, system: System, t: float, guess: list[float]):
        self.system, self.t, self.guess = system, t, guess
        self.n = system.nq + system.nv
        self.weights = [max(abs(a), 1.0) for a in guess[: self.n]]
        interface = system.interface
        self.conditions = [
            *(_Condition(f"constraint `{label}`", unit, True)
              for label, unit in zip(interface.row_labels[: system.nh], interface.row_units)),
            *(_Condition(f"the unit length of `{interface.q_names[k].rpartition('.')[0]}`", "", True)
              for k in system.quaternions),
            *(_Condition(f"the rate of constraint `{label}`" if i < system.nh else f"constraint `{label}`",
                         _rate_unit(unit) if i < system.nh else unit, False)
              for i, (label, unit) in enumerate(zip(interface.row_labels, interface.row_units))),
            *(_Condition(f"the condition at {place}", "", self._is_of_positions(i))
              for i, place in enumerate(interface.initial_places)),
        ]  # fmt: skip

    def run(self, fixed: Sequence[bool]) -> tuple[list[float], float]:
        """The best state found and its largest scaled residual."""
        best, worst = self.guess, float("inf")
        for attempt, spread in enumerate(_SPREADS):
            x, size = self._attempt(self._spread(fixed, spread, attempt), fixed)
            if size < worst:
                best, worst = x, size
            if worst <= ACCEPTED or all(fixed):
                break
        return best, worst

    def missed(self, x: list[float]) -> tuple[Missed, ...]:
        residuals = self.residuals(x)
        scaled = self._scaled(x, residuals)
        return tuple(
            Missed(c.name, abs(r), c.unit)
            for c, r, s in zip(self.conditions, residuals, scaled)
            if not s <= ACCEPTED
        )

    def residuals(self, x: list[float]) -> list[float]:
        system, t = self.system, self.t
        lengths = [0.5 * (sum(x[i] * x[i] for i in range(k, k + 4)) - 1.0) for k in system.quaternions]
        phi = system.position(t, x) if system.nh else []
        psi = system.velocity(t, x) if system.nc else []
        own = system.initial(t, x)[0] if system.interface.initial_places else []
        return [*phi, *lengths, *psi, *own]

    def _attempt(self, x: list[float], fixed: Sequence[bool]) -> tuple[list[float], float]:
        nq, every = self.system.nq, range(self.n)
        positions = [i for i, c in enumerate(self.conditions) if c.is_position]
        speeds = [i for i, c in enumerate(self.conditions) if not c.is_position]
        x = self._solve(x, positions, [i for i in every if i < nq and not fixed[i]])
        x = self._solve(x, speeds, [i for i in every if i >= nq and not fixed[i]])
        if self.worst(x) > ACCEPTED:
            x = self._solve(x, [*positions, *speeds], [i for i in every if not fixed[i]])
        return x, self.worst(x)

    def worst(self, x: list[float]) -> float:
        return _largest(self._scaled(x, self.residuals(x)))

    def _scaled(self, x: list[float], residuals: list[float]) -> list[float]:
        """Residuals over the size of their terms."""
        system = self.system
        scales = [max(s, 1e-300) for s in system.scales(self.t, x)] if system.nc else []
        own: list[float] = []
        if system.interface.initial_places:
            _, jacobian = system.initial(self.t, x)
            for i in range(len(system.interface.initial_places)):
                row = jacobian[i * self.n : (i + 1) * self.n]
                own.append(max(1e-300, *(abs(a) * max(abs(b), 1.0) for a, b in zip(row, x))))
        every = [*scales[: system.nh], *(1.0 for _ in system.quaternions), *scales, *own]
        return [abs(r) / s for r, s in zip(residuals, every)]

    def _solve(self, x: list[float], rows: list[int], columns: list[int]) -> list[float]:
        """Gauss-Newton on `rows` in the unknowns `columns`, halving steps that do not help."""

        def size(x: list[float]) -> tuple[float, list[float]]:
            residuals = self.residuals(x)
            scaled = self._scaled(x, residuals)
            return sqrt(sum(scaled[i] * scaled[i] for i in rows)), [residuals[i] for i in rows]

        if not rows or not columns:
            return x
        norm, residuals = size(x)
        for _ in range(_ITERATIONS):
            if norm <= TARGET or not isfinite(norm):
                break
            jacobian = self._jacobian(x, rows, columns)
            step = least_norm(jacobian, [-r for r in residuals])
            factor, found = 1.0, False
            while factor > 1e-4 and not found:
                trial = x[:]
                for j, d in zip(columns, step):
                    trial[j] += factor * d * self.weights[j]
                trial_norm, trial_residuals = size(trial)
                found = trial_norm < norm * (1.0 - 0.1 * factor)
                factor *= 0.5
            if not found:
                break
            x, norm, residuals = trial, trial_norm, trial_residuals
        return x

    def _jacobian(self, x: list[float], rows: list[int], columns: list[int]) -> list[list[float]]:
        """d(residual)/d(x / weight) by central differences (a column two evaluations)."""
        jacobian = [[0.0] * len(columns) for _ in rows]
        for k, j in enumerate(columns):
            h = 6e-6 * self.weights[j]
            above, below = x[:], x[:]
            above[j] += h
            below[j] -= h
            up, down = self.residuals(above), self.residuals(below)
            width = (above[j] - below[j]) / self.weights[j]
            for row, i in enumerate(rows):
                jacobian[row][k] = (up[i] - down[i]) / width
        return jacobian

    def _spread(self, fixed: Sequence[bool], spread: float, attempt: int) -> list[float]:
        """The guess, moved by up to `spread` of each weight: a guess may be a singular posture."""
        x = self.guess[:]
        if spread == 0.0:
            return x
        state = 12345 + attempt
        for i in range(self.n):
            state = (1103515245 * state + 12345) % 2147483648
            if not fixed[i] and i < self.system.nq:
                x[i] += spread * self.weights[i] * (state / 1073741824 - 1.0)
        _normalise(x, [k for k in self.system.quaternions if not any(fixed[k : k + 4])])
        return x

    def _is_of_positions(self, row: int) -> bool:
        """Whether initial condition `row` does not react to any speed, here and elsewhere."""
        probe = self.guess[:]
        for i in range(self.n):
            probe[i] += 0.37 + 0.11 * (i % 7)
        moved = self.guess[:]
        moved[: self.system.nq] = probe[: self.system.nq]
        start, end = row * self.n + self.system.nq, (row + 1) * self.n
        return not any(any(self.system.initial(self.t, x)[1][start:end]) for x in (self.guess, probe, moved))


def _largest(values: list[float]) -> float:
    """Their maximum; infinity where one is not a number."""
    return max((v if v == v else float("inf") for v in values), default=0.0)


def _rate_unit(unit: str) -> str:
    return f"{unit}/s" if unit else "1/s"
