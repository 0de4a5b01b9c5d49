"""Parameters that fit measured values in the sense of least squares, with confidence intervals.

Residuals of a quantity are divided by their standard deviation.  Of several quantities these are not known:
they are estimated in turn with the parameters (feasible generalized least squares).  G. A. F. Seber,
C. J. Wild, Nonlinear Regression, 1989, sections 2.1 and 5.1; for several responses section 11.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from importlib import import_module
from math import inf, nan, sqrt
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from lagc.base.records import dataclass, field
from lagc.host.packages import is_installed

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from lagc.simulation.solution import Solution

    Array: TypeAlias = NDArray[np.float64]

SCIPY = "a fit needs scipy: pip install scipy"
CLOSE = 0.01  # relative change of the standard deviations at which they have converged
ROUNDS = 10
TOLERANCE = 1e-10  # relative, of parameters and of the sum of squares
SINGULAR = 10.0  # times the accuracy of the derivatives, relative: a singular value that is none
PART = 1e-3  # of a singular direction: a parameter that belongs to it
SHOWN = 0.01  # of the largest change, in its words
CORRELATED = 0.98
PATTERN, FEWEST = 1.0, 10  # Durbin-Watson statistic, points: residuals that follow each other

# Values of each quantity at its measured times, and their derivatives by the parameters.
Evaluated: TypeAlias = "tuple[list[Array], list[Array]]"
Evaluate: TypeAlias = "Callable[[Sequence[float]], Evaluated | None]"


@dataclass(frozen=True)
class Measured:
    """Measured values of a quantity over time, in SI units; `column` is their name in the data.  `gaps`
    further rows have no value or no time."""

    quantity: str
    column: str
    unit: str
    times: Array
    values: Array
    gaps: int = 0


@dataclass(frozen=True)
class Parameter:
    """A parameter or initial value that is fitted: where the search begins, and its bounds."""

    name: str
    unit: str
    begin: float
    low: float = -inf
    high: float = inf


@dataclass
class Fit:
    """The result of a fit, in SI units.

    `values` are the fitted ones, `deviations` their standard deviations and `intervals` the half widths of
    their `confidence` intervals; infinite for a parameter that the data do not determine.  `residuals`
    (measured - computed) and `sigmas`, their standard deviations, belong to the measured quantities.
    `unseen` has a sentence for each direction that the data do not determine.  `run` is the motion with these
    values, over the measured times."""

    parameters: tuple[Parameter, ...]
    measured: tuple[Measured, ...]
    confidence: float
    values: dict[str, float] = field(default_factory=dict)
    deviations: dict[str, float] = field(default_factory=dict)
    intervals: dict[str, float] = field(default_factory=dict)
    correlation: Any = None  # matrix of the parameters
    freedom: int = 0  # measured values less parameters that they determine
    residuals: dict[str, Any] = field(default_factory=dict)
    sigmas: dict[str, float] = field(default_factory=dict)
    unseen: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    converged: bool = False
    evaluations: int = 0
    run: Solution | None = None

    def __repr__(self) -> str:
        found = [f"{name} = {self.values[name]:.6g} +- {self.intervals[name]:.2g}" for name in self.values]
        return f"<{type(self).__name__}: {', '.join(found)}>"


class NotEvaluated(ArithmeticError):
    """The motion with the values at which the search begins does not reach the measured times."""


def fit(
    parameters: Sequence[Parameter], measured: Sequence[Measured], evaluate: Evaluate, accuracy: float,
    confidence: float = 0.95,
) -> Fit:  # fmt: skip
    """Return the fit.  `evaluate(values)` returns None where there is no motion; `accuracy` is that of its
    results.  Raises NotEvaluated, ImportError without scipy."""
    if not is_installed("scipy"):
        raise ImportError(SCIPY)
    found = Fit(tuple(parameters), tuple(measured), confidence)
    search = _Search(found, evaluate)
    x = np.array([p.begin for p in parameters])
    if search.at(x) is None:
        raise NotEvaluated
    # The scales of the first round are the deviations of the measured values from their mean.
    counts = np.array([len(m.values) for m in measured])
    least = [accuracy * float(np.abs(m.values).max()) or accuracy for m in measured]
    sigmas = np.array([max(float(np.std(m.values)), low) for m, low in zip(measured, least)])
    for _ in range(ROUNDS):
        result = search.minimize(x, sigmas)
        x, before = result.x, sigmas
        sums = np.array([float(r @ r) for r in search.residuals(x)])
        freedom = counts * max(1.0 - len(parameters) / counts.sum(), 1.0 / counts.sum())
        sigmas = np.maximum(np.sqrt(sums / freedom), least)
        if len(measured) == 1 or np.all(np.abs(sigmas - before) <= CLOSE * before):
            break
    found.converged, found.evaluations = bool(result.status > 0), search.evaluations
    found.values = {p.name: float(value) for p, value in zip(parameters, x)}
    found.residuals = {m.quantity: r for m, r in zip(measured, search.residuals(x))}
    found.sigmas = {m.quantity: float(sigma) for m, sigma in zip(measured, sigmas)}
    _intervals(found, search.jacobian(x, sigmas), search.stacked(x, sigmas), accuracy)
    found.notes = tuple(_notes(found, least, sums))
    return found


class _Search:
    """Residuals and their derivatives, evaluated once for each value of the parameters."""

    def __init__(self, found: Fit, evaluate: Evaluate):
        self.found, self.evaluate = found, evaluate
        self.known: tuple[bytes, Evaluated | None] = b"", None
        self.evaluations = 0

    def at(self, x: Array) -> Evaluated | None:
        if self.known[0] != x.tobytes():
            self.evaluations += 1
            self.known = x.tobytes(), self.evaluate(x.tolist())
        return self.known[1]

    def residuals(self, x: Array) -> list[Array]:
        """Measured less computed values; infinite where there is no motion: the search turns back."""
        computed = self.at(x)
        if computed is None:
            return [np.full(len(m.values), inf) for m in self.found.measured]
        return [m.values - y for m, y in zip(self.found.measured, computed[0])]

    def stacked(self, x: Array, sigmas: Array) -> Array:
        return np.concatenate([r / sigma for r, sigma in zip(self.residuals(x), sigmas)])

    def jacobian(self, x: Array, sigmas: Array) -> Array:
        computed = self.at(x)
        assert computed is not None  # the search asks for it at points that it accepted
        return np.vstack([-slopes / sigma for slopes, sigma in zip(computed[1], sigmas)])

    def minimize(self, x: Array, sigmas: Array) -> Any:
        least_squares = import_module("scipy.optimize").least_squares
        low, high = ([getattr(p, end) for p in self.found.parameters] for end in ("low", "high"))
        # LSMR damps a direction that the data do not determine: its values stay near the first ones.  It
        # needs a plane to search in.
        solver = "lsmr" if len(x) > 1 else "exact"
        return least_squares(
            self.stacked, np.clip(x, low, high), self.jacobian, (low, high), x_scale="jac",
            tr_solver=solver, xtol=TOLERANCE, ftol=TOLERANCE, gtol=None, args=(sigmas,),
        )  # fmt: skip


def _intervals(found: Fit, jacobian: Array, residuals: Array, accuracy: float) -> None:
    """Fill in deviations, intervals and correlations: s^2 (J^T J)^-1 by the singular values of J, whose
    columns are divided by their lengths, with Student's t.  Directions without a singular value are
    `unseen`."""
    names, x = list(found.values), np.array([*found.values.values()])
    lengths = np.linalg.norm(jacobian, axis=0)
    scale = np.where(lengths > 0.0, lengths, 1.0)
    _, singular, rows = np.linalg.svd(jacobian / scale, full_matrices=True)
    singular = np.append(singular, np.zeros(len(x) - len(singular)))
    seen = singular > SINGULAR * accuracy * max(float(singular.max()), 0.0)
    found.unseen = tuple([_unseen(names, x, row / scale) for row in rows[~seen]])
    found.freedom = len(residuals) - int(seen.sum())
    inverse = rows[seen].T / singular[seen]
    # Divided by their deviations, the squares add up to all values less all parameters, or to less where the
    # deviations are bounded by the accuracy of the run.
    squares = max(float(residuals @ residuals), float(len(residuals) - len(x)))
    variance = squares / found.freedom if found.freedom > 0 else nan
    covariance = variance * inverse @ inverse.T / np.outer(scale, scale)
    lost = np.abs(rows[~seen]).max(axis=0, initial=0.0) > PART
    deviations = np.where(lost, inf, np.sqrt(np.diag(covariance)))
    quantile = nan
    if found.freedom > 0:
        quantile = float(import_module("scipy.special").stdtrit(found.freedom, 0.5 + 0.5 * found.confidence))
    found.deviations = dict(zip(names, deviations.tolist()))
    found.intervals = dict(zip(names, (quantile * deviations).tolist()))
    sizes = np.sqrt(np.diag(covariance))
    with np.errstate(all="ignore"):
        found.correlation = covariance / np.outer(sizes, sizes)


def _unseen(names: Sequence[str], x: Array, direction: Array) -> str:
    """A sentence on a direction in which the values may change without any effect on the computed ones."""
    relative = direction / np.where(x != 0.0, np.abs(x), 1.0)
    relative = relative / relative[np.argmax(np.abs(relative))]
    parts = [(name, part, value) for name, part, value in zip(names, relative, x) if abs(part) > SHOWN]
    if len(parts) == 1:
        return f"`{parts[0][0]}` cannot be seen: no measured value depends on it"
    changes = [f"`{n}` by {part:+.3g}{' %' if value else ' in SI units'}" for n, part, value in parts]
    between = ", ".join([f"`{name}`" for name, _, _ in parts[:-1]]) + f" and `{parts[-1][0]}`"
    return f"{between} cannot be separated: a change of {', '.join(changes)} changes no measured value"


def _notes(found: Fit, least: Sequence[float], sums: Array) -> list[str]:
    """Findings on the fit that a reader of the intervals should know."""
    notes = [] if found.converged else ["the search ended before it converged: the values are not the best"]
    if found.freedom <= 0:
        notes.append("there are not more measured values than parameters: no interval can be given")
    for p in found.parameters:
        value, half = found.values[p.name], found.intervals[p.name]
        size = max(abs(value), abs(p.begin)) * 1e-6
        if min(abs(value - p.low), abs(value - p.high)) <= size:
            notes.append(f"`{p.name}` is at its bound: its interval is not valid")
        elif half < inf and half >= abs(value) > 0.0:
            notes.append(f"the data hardly determine `{p.name}`: its interval contains 0")
    names = list(found.values)
    for i, j in zip(*np.triu_indices(len(names), 1)):
        share = found.correlation[i, j]
        if abs(share) > CORRELATED and max(found.intervals[names[k]] for k in (i, j)) < inf:
            both = f"`{names[i]}` and `{names[j]}` are correlated ({share:+.4f})"
            notes.append(f"{both}: a change of one makes up for a change of the other")
    for m, low, total in zip(found.measured, least, sums):
        if m.gaps:
            rows = m.gaps + len(m.values)
            notes.append(f"{m.gaps} of {rows} rows have no value of `{m.column}` or no time")
        r = found.residuals[m.quantity]
        if sqrt(total / len(r)) <= 10.0 * low:
            notes.append(
                f"`{m.column}` fits to the accuracy of the run: the intervals are those of it, not of noise"
            )
        elif len(r) >= FEWEST and float(np.diff(r) @ np.diff(r)) < PATTERN * total:
            durbin = f"Durbin-Watson {float(np.diff(r) @ np.diff(r)) / total:.2g}, 2 for noise"
            pattern = f"the residuals of `{m.column}` follow a pattern ({durbin})"
            notes.append(f"{pattern}: the model lacks something, and the intervals are too small")
    return notes
