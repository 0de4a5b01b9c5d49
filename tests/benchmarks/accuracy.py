"""The first promise: the asked, the estimated and the true global error, and what they cost.

The true error is that of the coordinates and speeds at the times of published values or closed
forms (tests/references), scaled as `lagc.simulation.global_error.verified_run` does; it cannot be told below
the accuracy of the reference itself.  Runs are made without remembered tolerances.
"""

from __future__ import annotations

import os
import time

from lagc.api import CompiledModel
from lagc.simulation.error_measure import scaling_groups
from lagc.simulation.solution import Solution
from tests.benchmarks.tables import Cell, machine, table
from tests.physics.references import Reference, Sample, compiled, names, read

ACCURACIES = (1e-4, 1e-6, 1e-8, 1e-10)


def true_error(run: Solution, model: CompiledModel, sample: Sample) -> float:
    """The largest error of the states that the sample tells."""
    interface = model.interface
    states = [*interface.q_names, *interface.v_names]
    last = list(run.states[-1])
    errors = []
    for group in scaling_groups(interface):
        size = max(abs(x[i]) for x in run.states for i in group)
        told = [i for i in group if states[i] in sample.values]
        errors += [abs(last[i] - sample.values[states[i]]) / size for i in told]
    return max(errors)


def rows(name: str) -> list[list[Cell]]:
    reference: Reference = read(name)
    model = compiled(name, "c")
    model.load("c")
    states = {*model.interface.q_names, *model.interface.v_names}
    telling = [s for s in reference.samples if s.t > 0.0 and not states.isdisjoint(s.values)]
    if not telling:
        return []
    sample = telling[-1]
    os.environ["LAGC_CACHE"] = ""  # nothing remembered
    found: list[list[Cell]] = []
    for accuracy in ACCURACIES:
        if accuracy < reference.accuracy:
            continue
        began = time.process_time()
        run = model.simulate(sample.t, accuracy=accuracy, points=201, starts=reference.starts)
        spent = time.process_time() - began
        true = true_error(run, model, sample)
        kept = run.status == "ok" and true <= accuracy
        found.append([name, f"{sample.t:g}", f"{accuracy:g}", run.estimated, true,
                      "yes" if kept else run.status if run.status != "ok" else "NO",
                      true / run.estimated if run.estimated else None,
                      run.cost.rhs, run.cost.integrations, spent * 1e3])  # fmt: skip
    return found


def main() -> None:
    print(machine())
    found: list[list[Cell]] = []
    own = os.environ.get("LAGC_CACHE")
    for name in names():
        found += rows(name)
        os.environ.pop("LAGC_CACHE", None)
        if own is not None:
            os.environ["LAGC_CACHE"] = own
    head = ["reference", "to s", "asked", "estimated", "true", "kept", "true/estimated", "rhs", "runs", "ms"]
    table("The asked accuracy (C backend; all integrations and the comparison, CPU)", head, found)


if __name__ == "__main__":
    main()
