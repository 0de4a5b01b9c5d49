"""Andrews' squeezing mechanism over 30 ms: seven bodies, three loops, projected on its constraints.

Work-precision of the generated C against the reference values of tests/references (the largest
error of the seven angles at 0.03 s, relative to the largest angle); one right-hand side in C and in Python.
"""

from __future__ import annotations

import json
from pathlib import Path

from lagc import load
from tests.benchmarks.native import Native
from tests.benchmarks.tables import Cell, cpu_seconds, machine, table

REFERENCE = Path(__file__).parents[1] / "references" / "andrews_squeezer.json"
TOLERANCES = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11)
ACCURACIES = (1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10)
STOP = 0.03
TARGET = 0.25  # ms to 1e-6


def main() -> None:
    print(machine())
    (last,) = [s for s in json.loads(REFERENCE.read_text())["samples"] if s["t"] == STOP]
    compiled = load("andrews_squeezer").compile(backend="numpy")
    names = compiled.interface.q_names
    system = compiled.load("numpy")
    x = [float(a) for a in compiled.start()]
    native = Native.shipped("andrews_squeezer", x)

    values = [float(last["values"][name]) for name in names]

    def error(found: tuple[float, ...]) -> float:
        """Relative to the largest angle, as `accuracy` is."""
        return max(abs(a - b) for a, b in zip(found, values)) / max(map(abs, values))

    state, xdot, lam = [*x, 0.0], [0.0] * (len(x) + 1), [0.0] * compiled.interface.nc
    python = cpu_seconds(lambda: system.rhs(0.0, state, xdot, lam))
    seconds = native.rhs()
    rows: list[list[Cell]] = [
        ["C (compiled -O2)", seconds * 1e6, 1.0, compiled.operations],
        ["Python floats", python * 1e6, python / seconds, compiled.operations],
    ]
    table("One right-hand side (us of CPU)", ["", "us", "x C", "operations"], rows)

    rows = []
    runs: list[tuple[float, float]] = []
    for method in ("dop853", "dopri5"):
        for tolerance in TOLERANCES:
            run = native.run(STOP, tolerance, method)
            runs.append((error(run.x), run.seconds))
            rows.append([f"{method} {tolerance:g}", run.status, error(run.x), run.seconds * 1e3, run.steps,
                         run.rejected, run.rhs, 1e6 * run.seconds / run.rhs])  # fmt: skip
    head = ["", "status", "error", "ms", "steps", "rejected", "rhs", "us a rhs, all included"]
    table("Work and precision in C, with projection (CPU)", head, rows)

    rows = []
    for accuracy in ACCURACIES:
        good = [seconds for reached, seconds in runs if reached <= accuracy]
        target = TARGET if accuracy == 1e-6 else None
        rows.append([f"{accuracy:g}", min(good) * 1e3 if good else "not reached", target])
    table("The fastest run that reached the error (ms of CPU)", ["error", "ms", "target"], rows)


if __name__ == "__main__":
    main()
