"""Many runs of a compiled model: swept parameters and initial values, random samples."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from math import inf, nan
from typing import TYPE_CHECKING, Any

from lagc.api.columns import name_and_unit, read_columns, reading
from lagc.api.values import Parametrized, quantities, real, seconds, words
from lagc.base.records import replace
from lagc.base.run_options import RUN_OPTIONS
from lagc.base.text import Quantity
from lagc.compiler.loaded import Loaded
from lagc.diagnostics.faults import Fault, Refused
from lagc.host import cache
from lagc.host.budgets import of_this_machine, running, size_text
from lagc.kernels import DEFAULT_METHOD
from lagc.simulation.request import Request, bound_guesses, bound_scales, bound_starts, si, unknown
from lagc.simulation.solution import columns_of, units_of
from lagc.version import __version__

if TYPE_CHECKING:
    from lagc.study.sweep.plan import Distribution, Plan, Values
    from lagc.study.sweep.table import Sweep

NUMBER = 8.0  # bytes
FINAL_POINTS = 13  # recorded points where final values alone are kept: those of the energy balance


class Sweepable(Parametrized):
    """A compiled model that can be run at many points."""

    def sweep(
        self,
        axes: str | os.PathLike[str] | Mapping[str, Any],
        *,
        zip: bool = False,
        samples: int | None = None,
        seed: int = 0,
        keep: str | Sequence[str] = "final",
        executor: Any = None,
        journal: str | None = None,
        progress: Callable[[Sweep], None] = lambda sweep: None,
        parameters: Mapping[str, Any] | None = None,
        starts: Mapping[str, Any] | None = None,
        guesses: Mapping[str, Any] | None = None,
        scales: Mapping[str, Any] | None = None,
        **options: Any,
    ) -> Sweep:
        """Run the model at many points and return a row of results for each.

        axes: values by the name of a parameter, an input, or an initial value `start(theta)`: numbers in SI,
            a pair of numbers and a unit, or a text as on the command line: "0.5:1.5:100", "10:80:8[deg]",
            "normal(1, 0.05)".  The points are all combinations, the last axis fastest.
        zip: the n-th point has the n-th value of each axis instead; so a DataFrame, or the path of a CSV file
            with names and units in its header, are points.
        samples, seed: the number of random points of axes that are distributions.
        keep: what a row has of each quantity: "final", "max", "min", "rms", or several of these.
        executor: None for this process, a number of worker processes, an `Executor` of
            `concurrent.futures`, or a Dask client.  All give the same bits.
        journal: a file that keeps finished runs; with the same file, the same sweep goes on.
        progress: a function that is called some times a second with the results so far.
        options: stop, accuracy, method, rtol, atol, step, max_step, every, points, as for `simulate`.

        A run that fails or is refused is a row with its code and message.  KeyboardInterrupt ends the sweep
        with the runs so far.  Raises Refused if an argument is invalid or a worker has another version of
        lagc, ImportError, OSError if the journal cannot be written."""
        from lagc.study.sweep.plan import plan_of

        # All that can be wrong is refused before the first of perhaps a million runs: the request, each axis,
        # and then how they combine.
        request = self.sweep_request(options, starts, guesses, scales)
        if isinstance(axes, str | os.PathLike):
            found = axes_in(os.fspath(axes))
        else:
            found = {name: _axis(name, value) for name, value in axes.items()}
        plan = plan_of(found, self.axis_values, zip, samples, seed)
        return self.run_sweep(plan, request, words("keep", keep), executor, journal, progress, parameters)

    def run_sweep(
        self, plan: Plan, request: Request, keep: Sequence[str], executor: Any, journal: str | None,
        progress: Callable[[Sweep], None], parameters: Mapping[str, Any] | None = None,
        most_time: float = inf,
    ) -> Sweep:  # fmt: skip
        """Run the points of a plan.  `most_time` is the longest time of a run in s: one that would take more
        is refused."""
        import pickle
        from array import array

        from lagc.study.sweep.journal import Journal
        from lagc.study.sweep.sweep import Running
        from lagc.study.sweep.worker import Task, version

        # Points do not change a motion, but its error is estimated at them too: a few, whoever runs it.
        if tuple(keep) == ("final",) and request.every is request.points is None:
            request = replace(request, points=FINAL_POINTS)
        request = request.completed(self.interface.simulate)
        loaded, backend = self._chosen(request)
        table = self._table(plan, request, keep, backend)
        values = self._values(plan.names, parameters)
        # The key of everything asked: the journal of another sweep, or of another lagc, is not continued.
        swept = [cache.digest(array("d", c).tobytes()) for block in plan.blocks for c in block.columns]
        asked = [repr(part) for part in (request, values, plan.names, swept, tuple(keep), most_time)]
        shape = repr([len(block) for block in plan.blocks])
        key = cache.key(self.interface.model_hash, self.interface.scene, backend, version(), shape, *asked)
        # Workers get the model once, pickled; the key tells whether a journal belongs to this sweep.
        task = Task(pickle.dumps(loaded), key, version(), backend, request, tuple(values), plan.names,
                    tuple(keep), most_time)  # fmt: skip
        # A limit of time is asked about whenever progress is shown.
        look = running(lambda t: progress(table)) or (lambda t: None)
        file = None if journal is None else Journal(journal, key)
        try:
            Running(table, task, lambda: look(1.0), file).run(executor)
        except KeyboardInterrupt:
            table.interrupted = True
        finally:
            if file is not None:
                file.close()
        return table

    def _chosen(self, request: Request) -> tuple[Loaded, str]:
        """Return the model that all workers run, with one backend: C if there is a compiler, for `auto`."""
        from lagc.simulation.backends.compile import CannotCompile
        from lagc.simulation.supervision import has_compiler

        compilation, asked = self._loaded.compilation, self._loaded.asked
        if asked != "auto":
            return self._loaded, asked
        if has_compiler():
            found = Loaded(compilation, "c")
            try:
                found.taking(request.method or DEFAULT_METHOD).system("c").start()  # compiles
                return found, "c"
            except CannotCompile:
                pass
        return Loaded(compilation, "numpy"), "numpy"

    def _table(self, plan: Plan, request: Request, keep: Sequence[str], backend: str) -> Sweep:
        """Return the table without results.  Raises Refused if it needs too much memory, or for `keep`."""
        from lagc.study.sweep.table import Sweep
        from lagc.study.sweep.worker import FIRST, KEPT

        for word in keep:
            if word not in KEPT:
                raise Refused([unknown(word, KEPT, "number to keep", "LAG0604")])
        interface = self.interface
        own = units_of(interface)
        quantities_ = columns_of(interface)
        columns = [name if kind == "final" else f"{kind}({name})" for kind in keep for name in quantities_]
        needed = NUMBER * len(plan) * (len(FIRST) + len(columns))
        if needed > of_this_machine():
            message = f"{len(plan)} runs of {len(columns)} numbers need about {size_text(needed)} of memory"
            remedy = "sweep fewer points, or keep fewer numbers"
            raise Refused([Fault("LAG0804", message, remedy=remedy)])
        units = {name: own[q] for name, q in zip(columns, [*quantities_] * len(keep))}
        units.update({name: self._unit(name) for name in plan.names})
        options = {name: getattr(request, name) for name in (*RUN_OPTIONS, "method")}
        metadata = {
            "tool": f"lagc {__version__}", "model": interface.model, "scene": interface.scene,
            "effects": list(interface.effects), "source": interface.source_name,
            "model_hash": interface.model_hash, "backend": backend, "options": options, "seed": plan.seed,
        }  # fmt: skip
        return Sweep(plan, columns, units, metadata)

    def _values(self, varied: Sequence[str], parameters: Mapping[str, Any] | None) -> list[float]:
        """Return the array p.  Raises Refused for a parameter without a value that does not vary."""
        values = self._bound(parameters, demanding=False)
        fields = (*self.interface.parameters, *self.interface.inputs)
        if any(value != value and f.name not in varied for f, value in zip(fields, values)):
            self._bound(parameters)
        return values

    def _unit(self, name: str) -> str:
        """Return the SI unit of a parameter, an input or an initial value.  Raises Refused: LAG0601, LAG0606,
        LAG0607."""
        from lagc.study.sweep.worker import started

        interface = self.interface
        start = started(name)
        if start is not None:
            bound_starts(interface, {start: 0.0})
            discretes = {x.name: x.unit for x in interface.discretes}
            return {**dict(zip(interface.state_names, interface.state_units)), **discretes}[start]
        if name in self.artifact.built_in:
            self._with_given({name: nan})
        known = {f.name: f.unit for f in (*interface.parameters, *interface.inputs, *self.artifact.unused)}
        if name not in known:
            starts = [f"start({n})" for n in interface.state_names]
            raise Refused([unknown(name, [*known, *starts], "parameter or input", "LAG0601")])
        return known[name]

    def axis_values(self, name: str, numbers: Sequence[float], unit: str | None) -> list[float]:
        """Return the values of an axis in SI units.  Raises Refused: LAG0602, LAG0605, and as `_unit`."""
        own, faults = self._unit(name), list[Fault]()
        found = [si(name, Quantity(float(number), unit), own, faults) for number in numbers]
        if faults:
            raise Refused(faults[:1])
        return [value for value in found if value is not None]

    def sweep_request(self, options: Mapping[str, Any], starts: Any, guesses: Any, scales: Any) -> Request:
        """Return the request of the runs.  Raises TypeError for an unknown option, Refused."""
        for name in options:
            if name not in RUN_OPTIONS and name != "method":
                raise TypeError(f"a sweep has no option {name!r}")
        times = {n: seconds(n, options[n]) for n, option in RUN_OPTIONS.items()
                 if option.unit == "s" and n in options}  # fmt: skip
        given = quantities("starts", starts)
        more: dict[str, Any] = {**options, **times}
        return Request(
            **more, starts=bound_starts(self.interface, given),
            guesses=bound_guesses(self.interface, quantities("guesses", guesses), given),
            scales=bound_scales(self.interface, quantities("scales", scales)),
        )  # fmt: skip


def axes_in(path: str) -> dict[str, Values | Distribution]:
    """Return the columns of a CSV file as axes.  Raises Refused (LAG0602, LAG0702)."""
    from lagc.study.sweep.plan import Values

    found: dict[str, Values | Distribution] = {}
    columns, places = read_columns(path)
    for head, column in columns.items():
        name, unit = name_and_unit(head)
        found[name] = Values([reading(name, *read) for read in zip(column, places)], unit)
    return found


def _axis(name: str, value: Any) -> Values | Distribution:
    """Return an axis as Python users give it.  Raises Refused, TypeError or ValueError."""
    from lagc.study.sweep.plan import Values, parse

    if isinstance(value, str):
        return parse(name, value)
    unit = None
    if isinstance(value, tuple) and len(value) == 2 and isinstance(value[1], str):
        value, unit = value
    numbers = value if hasattr(value, "__len__") else [value]
    return Values([real(name, number) for number in numbers], unit)
