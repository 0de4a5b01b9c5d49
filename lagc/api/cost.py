"""The price of accuracy, for a compiled model."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from random import Random
from time import perf_counter, process_time
from typing import TYPE_CHECKING, Any

from lagc.api.values import Parametrized, quantities, seconds
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
        from lagc.compiler import pipeline, stages
        from lagc.simulation.backends.compile import CannotCompile
        from lagc.study.cost import Study, study
        from lagc.study.probe import Failed, Late, Probe

        request = Request(
            stop=seconds("stop", stop), points=points,
            starts=bound_starts(self.interface, quantities("starts", starts)),
        )  # fmt: skip
        times = request.completed({**self.interface.simulate, "accuracy": 1e-6}).grid()
        values = self._bound(parameters)
        system = self._loaded.system("numpy").bind(values)
        x0 = self._loaded.initialize(system, request).x
        program = pipeline.with_all_methods(self._loaded.compilation)
        interface = program.interface

        double = stages.render(program, "c")

        def make(real: str, flags: tuple[str, ...]) -> Probe:
            sources = double if real == "double" else stages.render(program, "c", real=real)
            return Probe(sources, interface, values, x0, real, flags)

        def verify(accuracy: float) -> tuple[Verified, Array | None]:
            asked = Request(stop=times[-1], accuracy=accuracy, points=points, starts=request.starts)
            self._loaded.system("c")
            start = process_time()
            run = self.run(asked, values)
            return _verified(run, accuracy, process_time() - start, names)

        def nearby(k: int) -> Probe | None:
            """Return the probe with parameters of up to 1 % more or less; None where that has no initial
            state."""
            dice = Random(k)
            moved = [value * (1.0 + dice.uniform(-NEAR, NEAR)) for value in values]
            with suppress(Refused, ValueError, ArithmeticError):
                beside = self._loaded.initialize(system.bind(moved), request).x
                return Probe(double, interface, moved, beside)
            return None

        def sizes(table: Array) -> Array:
            return term_sizes(self._loaded.compilation.equations, system, x0, times, table)

        names = (*interface.q_names, *interface.v_names, *(o.name for o in interface.outputs))
        begun = Study(names, times[-1], len(times), interface.operations, budget=budget, began=began)
        try:
            return study(make, verify, sizes, nearby, begun, times, progress)
        except CannotCompile as error:
            raise Refused([Fault("LAG0701", f"the cost cannot be measured: {error}")]) from None
        except (Failed, Late) as failed:
            message = f"the cost cannot be measured: the motion does not reach {times[-1]:g} s: {failed}"
            raise Refused([Fault("LAG0620", message, remedy="see `lagc sim` for the reason")]) from None


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


def _verified(
    found: Solution, accuracy: float, spent: float, names: tuple[str, ...]
) -> tuple[Verified, Array | None]:
    import numpy as np

    from lagc.study.cost import Verified

    outcome = Verified(accuracy, found.status, found.estimated, float("nan"), spent, found.cost.rhs)
    if found.status == "failed":
        return outcome, None
    return outcome, np.array([found.column(name) for name in names]).T
