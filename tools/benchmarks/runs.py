"""Many runs of one model: CPU time of a run by a loop over C, by sweeps, and by heyoka's batch mode.

1000 double pendulums of 10 s with other first angles, in one process.  All are timed in turn; the least time
counts.
"""

from __future__ import annotations

import ctypes
import importlib
from collections.abc import Callable
from ctypes import byref, c_double, c_long, c_size_t, sizeof
from math import inf, pi
from time import process_time
from typing import Any

import numpy as np

import lagc
from lagc.host.packages import is_installed
from lagc.simulation.request import Request
from lagc.simulation.simulate import by_hand
from lagc.study.sweep import worker
from tools.benchmarks.problems import PROBLEMS
from tools.benchmarks.tables import Cell, machine, table

RUNS, STOP, RTOL, ACCURACY, BATCH, ROUNDS = 1000, 10.0, 1e-9, 1e-6, 8, 5
ANGLES = np.linspace(pi / 3, 2 * pi / 3, RUNS)
AXES = {"start(theta1)": ANGLES.tolist()}


def in_c(system: lagc.CompiledModel) -> Callable[[], None]:
    """Return a loop over the generated C."""
    model: Any = system._loaded.system("c").model  # type: ignore[attr-defined]
    call, p = model.functions, (c_double * (model.interface.prepared + len(system.interface.parameters)))()
    options = by_hand(Request(stop=STOP, rtol=RTOL).completed(system.interface.simulate))
    options.report = False
    o, grid, done, work = model.options(options), (c_double * 1)(STOP), c_size_t(0), model.work()
    p[: len(system.interface.parameters)] = [f.value for f in system.interface.parameters]
    call["bind"](p)
    state, x = ctypes.create_string_buffer(call["state_size"]()), (c_double * 4)()

    def run() -> None:
        for angle in ANGLES:
            call["start"](p, x)
            x[0], done.value = angle, 0
            ctypes.memset(work, 0, sizeof(work))
            call["begin"](state, c_double(0.0), x)
            call["record"](p, state, byref(o), grid, c_size_t(1), x, byref(done), c_long(0), work)

    return run


def sweep(system: lagc.CompiledModel, alone: float, **given: Any) -> Callable[[], None]:
    """Return a sweep that makes single runs for the first `alone` seconds."""

    def run() -> None:
        worker.ALONE = alone
        worker._last.key = ""
        assert system.sweep(AXES, stop=STOP, **given).counts == {"ok": RUNS}

    return run


def heyoka() -> Callable[[], None]:
    """Return the runs of heyoka, some side by side."""
    hy: Any = importlib.import_module("heyoka")
    (problem,) = [problem for problem in PROBLEMS if problem.model == "double_pendulum"]
    x = hy.make_vars(*(f"x{i}" for i in range(4)))
    batch = hy.taylor_adaptive_batch([*zip(x, problem.rates(hy, x))], np.zeros((4, BATCH)), tol=RTOL)

    def run() -> None:
        for first in range(0, RUNS, BATCH):
            batch.set_time(0.0)
            batch.state[:] = 0.0
            batch.state[0], batch.state[1] = ANGLES[first : first + BATCH], pi / 2
            batch.propagate_until(STOP)

    return run


def main() -> None:
    print(machine())
    system = lagc.load("double_pendulum").compile(backend="c")
    system.simulate(STOP, rtol=RTOL)
    cases = {
        f"loop over C, rtol {RTOL:g}": in_c(system),
        f"sweep, rtol {RTOL:g}, run by run": sweep(system, inf, rtol=RTOL),
        f"sweep, rtol {RTOL:g}, in lanes": sweep(system, 0.0, rtol=RTOL),
        f"sweep, accuracy {ACCURACY:g}": sweep(system, inf, accuracy=ACCURACY),
    }
    if is_installed("heyoka"):
        cases[f"heyoka, tol {RTOL:g}, batches of {BATCH}"] = heyoka()
    times: dict[str, list[float]] = {name: [] for name in cases}
    for number in range(ROUNDS + 1):
        for name, run in cases.items():
            began = process_time()
            run()
            if number:  # the first compiles
                times[name].append(process_time() - began)
    first = min(next(iter(times.values())))
    rows: list[list[Cell]] = [[n, 1e6 * min(t) / RUNS, min(t) / first] for n, t in times.items()]
    table("Many runs, CPU time of each", ["", "us", "over the loop"], rows)


if __name__ == "__main__":
    main()
