"""The price of accuracy, for a compiled model."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from time import perf_counter, process_time
from typing import TYPE_CHECKING, Any

from lagc.api.values import Parametrized, quantities, seconds
from lagc.compiler.loaded import Loaded
from lagc.diagnostics.faults import Fault, Refused
from lagc.simulation.request import Request, bound_starts

if TYPE_CHECKING:
    from lagc.mechanics.formulation.equations import EquationsOfMotion
    from lagc.simulation.solution import Solution
    from lagc.simulation.system import System
    from lagc.study.cost import Study, Verified
    from lagc.study.probe import Array, Probe

BUDGET = 30.0  # s
POINTS = 301  # recorded times
NEAR = 0.01  # part of a parameter by which nearby ones differ
LOOKED = 8  # states of a motion at which the sizes of terms are taken


class Measurable(Parametrized):
    """A compiled model whose accuracy has a price that can be measured."""

    run: Callable[..., Any]

    def cost(
        self,
        stop: float | None = None,
        *,
        points: int = POINTS,
        budget: float = BUDGET,
        parameters: Mapping[str, Any] | None = None,
        starts: Mapping[str, Any] | None = None,
        progress: Callable[[float, str], None] = lambda part, doing: None,
    ) -> Study:
        """Measure errors and CPU times of many settings on the motion to `stop`, against a reference.

        points: the number of recorded times at which errors are taken.
        budget: about the wall time to spend, in s.  An interruption (KeyboardInterrupt) ends it early.
        progress: a function that is called with the part done, from 0 to 1, and a word.

        `lagc.reports.cost` prints the result.  Raises Refused if an argument is invalid, if there is no
        consistent initial state or C compiler, or if the motion does not reach `stop`.
        """
        began = perf_counter()
        from lagc.simulation.backends.compile import CannotCompile
        from lagc.study.cost import Study, study
        from lagc.study.probe import Failed, Late

        # Times, parameters and initial state are the same for all settings, so that only the setting differs.
        request = Request(
            stop=seconds("stop", stop), points=points,
            starts=bound_starts(self.interface, quantities("starts", starts)),
        )  # fmt: skip
        values = self._bound(parameters)
        bench = _Bench(self._loaded, self.run, request, values)
        times, interface = bench.times, bench.program.interface
        begun = Study(bench.names, times[-1], len(times), interface.operations, budget=budget, began=began)
        try:
            return study(bench.probe, bench.verify, bench.sizes, bench.nearby, begun, times, progress)
        except CannotCompile as error:
            raise Refused([Fault("LAG0701", f"the cost cannot be measured: {error}")]) from None
        except (Failed, Late) as failed:
            message = f"the cost cannot be measured: the motion does not reach {times[-1]:g} s: {failed}"
            raise Refused([Fault("LAG0620", message, remedy="see `lagc sim` for the reason")]) from None


class _Bench:
    """One motion of a loaded model, and what measures it: probes in C, and verified runs by `run`."""

    def __init__(
        self, loaded: Loaded, run: Callable[..., Solution], request: Request, values: Sequence[float]
    ) -> None:
        from lagc.compiler import pipeline, stages

        interface = loaded.artifact.interface
        self.loaded, self.run, self.request, self.values = loaded, run, request, values
        self.times = request.completed({**interface.simulate, "accuracy": 1e-6}).grid()
        self.system = loaded.system("numpy").bind(values)
        self.x0 = loaded.initialize(self.system, request).x
        # One C source with all methods; single and quad precision are other sources of the same program.
        self.program = pipeline.with_all_methods(loaded.compilation)
        self.double = stages.render(self.program, "c")
        own = self.program.interface
        self.names = (*own.q_names, *own.v_names, *(o.name for o in own.outputs))

    def probe(self, real: str, flags: tuple[str, ...]) -> Probe:
        from lagc.compiler import stages
        from lagc.study.probe import Probe

        sources = self.double if real == "double" else stages.render(self.program, "c", real=real)
        return Probe(sources, self.program.interface, self.values, self.x0, real, flags)

    def nearby(self, k: int) -> Probe | None:
        """Return the probe with parameters of up to 1 % more or less; None where that has no initial
        state.  Motions nearby tell how much of an error is chaos and how much is the method."""
        from random import Random

        from lagc.study.probe import Probe

        dice = Random(k)
        moved = [value * (1.0 + dice.uniform(-NEAR, NEAR)) for value in self.values]
        with suppress(Refused, ValueError, ArithmeticError):
            start = self.loaded.initialize(self.system.bind(moved), self.request).x
            return Probe(self.double, self.program.interface, moved, start)
        return None

    def verify(self, accuracy: float) -> tuple[Verified, Array | None]:
        """Return the outcome of a run of this accuracy, and its values; None if it failed."""
        import numpy as np

        from lagc.study.cost import Verified

        asked = Request(stop=self.times[-1], accuracy=accuracy, points=self.request.points,
                        starts=self.request.starts)  # fmt: skip
        self.loaded.system("c")  # as a user runs it: in C, and with the search for its tolerance
        start = process_time()
        run = self.run(asked, self.values)
        spent = process_time() - start
        outcome = Verified(accuracy, run.status, run.estimated, float("nan"), spent, run.cost.rhs)
        failed = run.status == "failed"
        return outcome, None if failed else np.array([run.column(name) for name in self.names]).T

    def sizes(self, table: Array) -> Array:
        equations = self.loaded.compilation.equations
        return term_sizes(equations, self.system, self.x0, self.times, table)


def term_sizes(
    equations: EquationsOfMotion, system: System, x0: Sequence[float], times: Sequence[float], table: Array
) -> Array:
    """Return the size of the terms of each state and output over a motion from the state x0 of a system in
    Python, from LOOKED rows of its values; contacts are as in x0.

    A state has the largest value of its unit."""
    import numpy as np

    from lagc.mechanics.identities.samples import magnitudes
    from lagc.simulation.values import values_at

    nx = system.nq + system.nv
    units = [*equations.q_units, *equations.v_units]
    largest = np.abs(table[:, :nx]).max(axis=0)
    states = [max(x for x, other in zip(largest, units) if other == unit) for unit in units]
    outputs = np.zeros(len(equations.outputs))
    for k in range(0, len(table), max(len(table) // LOOKED, 1)):
        values = values_at(equations, system, times[k], [*table[k, :nx].tolist(), *x0[nx:]])
        found = magnitudes([o.expression for o in equations.outputs], values)
        outputs = np.maximum(outputs, [size for _, size in found])
    return np.array([*states, *outputs])
