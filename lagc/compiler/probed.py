"""Expressions of a model over a finished run.

The model is compiled once more with the expressions as outputs, and these are evaluated at the recorded
states. The run itself does not change: outputs of a run count in its error estimate, these do not.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from lagc.base.records import dataclass, replace
from lagc.compiler.loaded import Loaded
from lagc.compiler.pipeline import Compilation
from lagc.diagnostics.faults import Fault, Refused
from lagc.simulation.request import bound_parameters
from lagc.simulation.solution import Solution
from lagc.simulation.system import System

if TYPE_CHECKING:
    from lagc.simulation.solution import Array


@dataclass(frozen=True)
class Probe:
    """The values of an expression: `values` has a row for each state, with the shape of the expression."""

    text: str
    unit: str
    values: Array


def probe(
    loaded: Loaded,
    run: Solution,
    texts: Sequence[str],
    times: Sequence[float] | None = None,
    states: Sequence[Sequence[float]] | None = None,
) -> list[Probe]:
    """Return the values of expressions at the recorded states of `run`, or at other `states` and their
    `times`. Raises Refused for an expression that is wrong, or depends on a state that the run does not
    have."""
    system = _bound(loaded, run, texts)
    times, states = run.times if times is None else times, run.states if states is None else states
    interface, n = system.interface, len(times)
    # Each text is an output of its own, `probe(1)` or, of a vector or matrix, `probe(1)[1,2]`: the last
    # name gives the shape.
    rows = np.array(system.output_columns(times, states)).reshape(len(interface.outputs), n).T
    found: list[Probe] = []
    for k, text in enumerate(texts):
        own = f"probe({k + 1})"
        places = [i for i, o in enumerate(interface.outputs) if o.name.partition("[")[0] == own]
        last = interface.outputs[places[-1]].name if places else own
        sizes = [int(word) for word in last[len(own) + 1 : -1].split(",") if word]
        unit = next((interface.outputs[i].unit for i in places), "")
        found.append(Probe(text, unit, rows[:, places].reshape(n, *sizes)))
    return found


def compile_probes(loaded: Loaded, texts: Sequence[str]) -> System:
    """Return the system with the expressions as outputs.  Raises Refused."""
    own, texts = loaded.root, tuple(texts)
    with own.lock:
        if texts not in own.probed:
            choice = replace(own.compilation.choice, probes=texts)
            made = Compilation(own.compilation.source, choice, own.compilation.roots)
            own.probed[texts] = Loaded(made, "numpy").system("numpy")
        return own.probed[texts]


def _bound(loaded: Loaded, run: Solution, texts: Sequence[str]) -> System:
    """Return the system with the expressions as outputs and the parameters of `run`."""
    own, of_run, system = loaded.root, run.system.interface, compile_probes(loaded, texts)
    interface = system.interface
    if (interface.state_names, interface.discretes) != (of_run.state_names, of_run.discretes):
        lists = [{*i.state_names, *(d.name for d in i.discretes)} for i in (interface, of_run)]
        missing = ", ".join(f"`{name}`" for name in sorted(lists[0] - lists[1]))
        message = (
            f"{' and '.join(f'`{text}`' for text in texts)} depends on {missing}, which the run does not have"
        )
        raise Refused([Fault("LAG0606", message, remedy="declare it as an output, or run without `outputs`")])
    fields = (*of_run.parameters, *of_run.inputs)
    known = dict(zip([field.name for field in fields], run.parameters))
    given = {name: value for name, value in own.compilation.choice.parameters.items() if name not in known}
    unused = loaded.artifact.unused
    values = bound_parameters(interface, given, unused, demanding=False)
    names = [field.name for field in (*interface.parameters, *interface.inputs)]
    return system.bind([known.get(name, value) for name, value in zip(names, values)])
