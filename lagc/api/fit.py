"""Parameters of a compiled model that fit measured values."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from itertools import zip_longest
from math import isfinite, nan
from typing import TYPE_CHECKING, Any

from lagc.api.columns import name_and_unit, read_columns, reading
from lagc.api.values import Parametrized, quantities, words
from lagc.base.records import replace
from lagc.base.text import Quantity
from lagc.diagnostics.faults import Fault, Refused
from lagc.host.budgets import Exhausted, reached
from lagc.simulation.request import Request, bound_starts, si, unknown
from lagc.simulation.solution import columns_of, units_of

if TYPE_CHECKING:
    from lagc.api.run import Run
    from lagc.study.fit import Evaluated, Fit, Measured, Parameter

OPTIONS = ("accuracy", "method", "rtol", "atol", "max_step")
TIMES = ("time", "t")  # the column of the times, if none is named


class Fittable(Parametrized):
    """A compiled model whose parameters can be fitted."""

    run: Callable[..., Run]

    def fit(
        self,
        data: str | os.PathLike[str] | Mapping[str, Sequence[float]],
        vary: str | Sequence[str],
        columns: Mapping[str, str],
        *,
        parameters: Mapping[str, Any] | None = None,
        starts: Mapping[str, Any] | None = None,
        confidence: float = 0.95,
        progress: Callable[[float], None] | None = None,
        **options: Any,
    ) -> Fit:
        """Find the parameters with which the motion fits measured values best, by least squares.

        data: a CSV file, or columns by name (a dict, a DataFrame).  A value that is empty or NaN is left out.
        vary: names of parameters, inputs and initial values `start(theta)` to find; the search begins at
            the values of the model, or at those of `parameters` and `starts`, and stays within their bounds.
        columns: the column of each measured quantity, with a unit if it is not SI: {"theta": "angle[deg]"};
            "time" names that of the times (default: `time`, `t` or the first one).  A unit may also stand in
            the header.
        confidence: of the intervals.
        options: accuracy, method, rtol, atol, max_step, as for `simulate`.

        The derivatives are the sensitivities of the motion.  Raises Refused if an argument is invalid or the
        motion of the first values ends before the data, ImportError without scipy."""
        from lagc.study.fit import NotEvaluated, fit

        for name, value in options.items():
            if name not in OPTIONS and value is not None:
                raise TypeError(f"a fit has no option {name!r}")
        # All times of all measured quantities in one run: a row for each time, and each quantity reads its
        # own.
        measured = measured_values(data, columns, self._unit_of)
        given, times = quantities("starts", starts), {float(t) for m in measured for t in m.times}
        request = Request(
            **options, times=tuple(sorted(times)), starts=bound_starts(self.interface, given),
            sensitivity=words("vary", vary),
        ).completed(self.interface.simulate)  # fmt: skip
        base = self._bound(parameters)
        motions = _Motions(self, request, base, self._parameters(request, base), measured, progress)
        # Residuals are known as well as the motion: a search for less than its error would follow round-off.
        accuracy = request.accuracy or request.rtol or 1e-9
        try:
            found = fit(motions.wanted, measured, motions.evaluate, accuracy, confidence)
        except NotEvaluated:
            message = f"there is nothing to fit with the first values: {motions.last.message}"
            remedy = "begin with other values, or leave out what was measured later"
            raise Refused([Fault("LAG0620", message, remedy=remedy)]) from None
        # Once more with the values found, for the run that is returned and plotted.
        found.run = motions.run([*found.values.values()])
        return found

    def _unit_of(self, quantity: str) -> str:
        """Return the SI unit of a quantity that can be measured.  Raises Refused (LAG0601)."""
        known = {name: units_of(self.interface)[name] for name in columns_of(self.interface)}
        if quantity not in known:
            raise Refused([unknown(quantity, known, "quantity", "LAG0601")])
        return known[quantity]

    def _parameters(self, request: Request, base: Sequence[float]) -> list[Parameter]:
        """Return what is fitted, with its first value and its bounds.  Raises Refused."""
        from lagc.compiler.run_sensitivities import directions_of
        from lagc.study.fit import Parameter

        if not request.sensitivity:
            raise Refused([Fault("LAG0601", "a fit needs names of parameters to find, such as `l`")])
        fields = [*self.interface.parameters, *self.interface.inputs]
        unused = {f.name: f for f in self.artifact.unused}
        x = self._loaded.initialize(self._loaded.system("numpy").bind(list(base)), request).x
        found = []
        for d in directions_of(self._loaded, request.sensitivity):
            if d.parameter is not None:
                f = fields[d.parameter]
                found.append(Parameter(d.name, d.unit, base[d.parameter], f.minimum, f.maximum))
            elif d.state is not None:
                found.append(Parameter(d.name, d.unit, x[d.state]))
            else:
                found.append(Parameter(d.name, d.unit, unused[d.name].value or 0.0))
        return found


class _Motions:
    """The motions of a fit: those of `model` with the values of the `wanted` parameters."""

    last: Run

    def __init__(
        self, model: Fittable, request: Request, base: Sequence[float], wanted: Sequence[Parameter],
        measured: Sequence[Measured], progress: Callable[[float], None] | None,
    ):  # fmt: skip
        self.model, self.request, self.base, self.wanted = model, request, base, wanted
        self.measured, self.progress = measured, progress
        fields = (*model.interface.parameters, *model.interface.inputs)
        self.places = {f.name: k for k, f in enumerate(fields)}

    def run(self, values: Sequence[float]) -> Run:
        p, starts = list(self.base), dict(self.request.starts)
        for parameter, value in zip(self.wanted, values):
            if parameter.name in self.places:
                p[self.places[parameter.name]] = value
            elif parameter.name.startswith("start("):
                starts[parameter.name[len("start(") : -1]] = value
        found = self.model.run(replace(self.request, starts=starts), p, self.progress)
        if found.interrupted:
            raise Exhausted if reached() else KeyboardInterrupt
        return found

    def evaluate(self, values: Sequence[float]) -> Evaluated | None:
        """Return values and slopes at the measured times; None if no motion reaches them."""
        try:
            self.last = self.run(values)
        except Refused:
            if not hasattr(self, "last"):  # with the first values
                raise
            return None
        return _compared(self.last, self.measured, [p.name for p in self.wanted])


def _compared(run: Run, measured: Sequence[Measured], names: Sequence[str]) -> Evaluated | None:
    """Return values and slopes of a run at the measured times; None if it does not reach them."""
    import numpy as np

    place = {t: k for k, t in enumerate(run.times)}
    values, slopes = [], []
    for m in measured:
        if m.times[-1] not in place:
            return None
        rows = [place[float(t)] for t in m.times]
        values.append(run[m.quantity][rows])
        slopes.append(np.column_stack([run.sensitivity(m.quantity, name)[rows] for name in names]))
        if not (np.isfinite(values[-1]).all() and np.isfinite(slopes[-1]).all()):
            return None
    return values, slopes


def measured_values(
    data: Any, columns: Mapping[str, str], unit_of: Callable[[str], str]
) -> tuple[Measured, ...]:
    """Return the measured quantities in the order of time.  `unit_of` tells the SI unit of a quantity.
    Raises Refused: LAG0601, LAG0602, LAG0605."""
    import numpy as np

    from lagc.study.fit import Measured

    file = os.fspath(data) if isinstance(data, str | os.PathLike) else ""
    table, places = read_columns(file) if file else (dict(data), ())
    # By the name without a unit, so that `angle` finds the column `angle [deg]`.
    heads = {name_and_unit(str(name))[0]: (str(name), name_and_unit(str(name))[1]) for name in table}
    asked = dict(columns)
    # Without a column of time by name, the first one is taken, as in most tables of measurements.
    clock = asked.pop("time", None) or next((name for name in TIMES if name in heads), next(iter(heads), ""))
    if not asked:
        raise Refused([Fault("LAG0601", "a fit needs measured quantities, such as `theta=angle`")])

    def column(quantity: str, word: str, own: str) -> tuple[str, Any]:
        name, unit = name_and_unit(word)
        if name not in heads:
            raise Refused([unknown(name, heads, "column", "LAG0601")])
        head, written = heads[name]
        # A unit that is asked for comes before that of the header.
        unit, faults = unit or written, list[Fault]()
        numbers = [reading(name, *read) for read in zip_longest(table[head], places, fillvalue="")]
        found = [si(quantity, Quantity(v, unit), own, faults) if isfinite(v) else nan for v in numbers]
        if faults:
            raise Refused(faults[:1])
        return name, np.array(found, dtype=float)

    _, times = column("time", clock, "s")
    if (times < 0).any():
        message = f"the column `{clock}` has the time {times.min():g} s; a run begins at 0"
        raise Refused([Fault("LAG0602", message, remedy="subtract the first time from all")])
    result = []
    for quantity, word in asked.items():
        own = unit_of(quantity)
        name, values = column(quantity, word, own)
        # Quantities may be missing at different times, so each keeps times of its own; stable sorting leaves
        # equal times in the order of the file.
        kept = np.isfinite(times) & np.isfinite(values)
        order = np.argsort(times[kept], kind="stable")
        if not len(order):
            message = f"the column `{name}` has no numbers"
            raise Refused([Fault("LAG0602", f"`{file}`: {message}" if file else message)])
        gaps = len(kept) - len(order)
        result.append(Measured(quantity, name, own, times[kept][order], values[kept][order], gaps))
    return tuple(result)
