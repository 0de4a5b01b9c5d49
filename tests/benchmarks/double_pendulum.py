"""The double pendulum: one right-hand side at the state at which the peers have theirs, and work-precision
over 10 s, from rest at (2, 2) rad.

Right-hand sides are timed in turns, and the least counts: others on the machine make all slower, not faster.
The reference is the state at 10 s from an extrapolation with 40 digits (the peers' script makes it).
The error is the largest of the angles and their rates at 10 s.
"""

from __future__ import annotations

import os
import tempfile
from math import cos, sin
from unittest.mock import patch

from lagc import load
from lagc.api import Run
from tests.benchmarks import peers
from tests.benchmarks.native import Native
from tests.benchmarks.tables import Cell, cpu_seconds, machine, table

REFERENCE = (-0.60216261066, -10.50147451571, -6.24216709502, -4.89796966316)
START = (2.0, 2.0, 0.0, 0.0)
AT = (0.3 + 0.8 * sin(0.4), 0.3 + 0.8 * sin(2.1), 0.5, 0.5 * cos(2.3))  # `test_state` of the peers
ROUNDS = 3
STOP = 10.0
TOLERANCES = (1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13, 1e-14)
RHS_PEERS = ("casadi_aba_c", "casadi_sx_c", "casadi_tension_c", "heyoka_lagrangian", "pinocchio", "mujoco")
RUN_PEERS = (
    "c_dop853_casadi", "heyoka_taylor", "numbalsoda_dop853", "casadi_cvodes_adams",
    "scipy_dop853_explicit_math", "scipy_dop853_lambdify",
)  # fmt: skip
LIMITS = (1e-6, 1e-9)


def error(x: tuple[float, ...]) -> float:
    return max(abs(a - b) for a, b in zip(x, REFERENCE))


def fastest(runs: list[tuple[float, float, int | None]], limit: float) -> tuple[float | None, int | None]:
    """Of (error, seconds, rhs): the time and count of the fastest that meets the limit."""
    good = [r for r in runs if r[0] <= limit]
    if not good:
        return None, None
    best = min(good, key=lambda r: r[1])
    return best[1], best[2]


def right_hand_sides(native: Native) -> None:
    least = native.rhs(AT)
    others: dict[str, tuple[float | None, Cell]] = {}
    for _ in range(ROUNDS):
        for peer in RHS_PEERS if peers.available() else ():
            least = min(least, *(native.rhs(AT) for _ in range(3)))
            found = peers.chain(peer, 2, limit=100.0) or {}
            times = [s for s in (found.get("t_rhs"), others.get(peer, (None, None))[0]) if s is not None]
            others[peer] = min(times, default=None), found.get("note", found.get("ops"))
    compiled = load("double_pendulum").compile(backend="numpy")
    system = compiled.load("numpy")
    xdot, lam, x = [0.0] * 5, [0.0], [*AT, 0.0]
    python = cpu_seconds(lambda: system.rhs(0.0, x, xdot, lam))
    rows: list[list[Cell]] = [
        ["lagc, C (compiled -O2)", least * 1e6, 1.0, compiled.operations],
        ["lagc, Python floats", python * 1e6, python / least, compiled.operations],
    ]
    for name, (s, ops) in others.items():
        rows.append([name, s * 1e6 if s else None, s / least if s else None, ops])
    table("One right-hand side (us of CPU)", ["", "us", "x lagc", "operations"], rows)


def work_precision(native: Native) -> None:
    rows: list[list[Cell]] = []
    ours: dict[str, list[tuple[float, float, int | None]]] = {}
    for method in ("dop853", "dopri5"):
        for tolerance in TOLERANCES:
            if method == "dopri5" and tolerance < 1e-11:
                continue
            run = native.run(STOP, tolerance, method)
            ours.setdefault(f"lagc, C {method}", []).append((error(run.x), run.seconds, run.rhs))
            rows.append([f"lagc, C {method}", f"{tolerance:g}", error(run.x), run.seconds * 1e3, run.rhs])
    for peer in RUN_PEERS if peers.available() else ():
        found = peers.work_precision(peer) or {}
        runs = [(r["err"], r["t"], r.get("nfev")) for r in found.get("runs", []) if "t" in r]
        ours[peer] = runs
        if not runs:
            rows.append([peer, found.get("note", "-"), None, None, None])
    head = ["", "tolerance", "error at 10 s", "ms", "right-hand sides"]
    table("10 s of the double pendulum: work and precision", head, rows)
    least = {limit: fastest(ours["lagc, C dop853"], limit)[0] for limit in LIMITS}
    summary: list[list[Cell]] = []
    for name, runs in ours.items():
        row: list[Cell] = [name]
        for limit in LIMITS:
            seconds, count = fastest(runs, limit)
            row += [seconds * 1e3 if seconds else "not reached", _ratio(seconds, least[limit]), count]
        summary.append(row)
    head = ["", "ms to 1e-6", "x lagc", "rhs", "ms to 1e-9", "x lagc", "rhs"]
    table("The fastest run that reached the error (CPU)", head, summary)


def _ratio(a: float | None, b: float | None) -> float | None:
    return a / b if a is not None and b is not None else None


def asked() -> None:
    """What `lagc sim` gives when an accuracy is asked for: the tolerance is its own business.

    `again`: the tolerance that met the accuracy is remembered.
    """
    rows: list[list[Cell]] = []
    compiled = load("double_pendulum").compile(backend="c")
    compiled.load("c")
    for accuracy in (1e-6, 1e-9):

        def simulate(accuracy: float = accuracy) -> Run:
            return compiled.simulate(STOP, accuracy=accuracy, starts={"theta1": 2.0, "theta2": 2.0}, points=2)

        with tempfile.TemporaryDirectory() as folder, patch.dict(os.environ, LAGC_CACHE=""):
            first = cpu_seconds(simulate, 3)
            run = simulate()
            os.environ["LAGC_CACHE"] = folder
            again = cpu_seconds(simulate, 3)
        cost = run.cost
        rows.append([f"{accuracy:g}", run.estimated, error(tuple(run.states[-1][:4])), cost.rhs,
                     cost.integrations, first * 1e3, again * 1e3])  # fmt: skip
    head = ["asked", "estimated (relative)", "true error", "rhs", "integrations", "ms", "ms again"]
    table("10 s with a verified accuracy, from Python (CPU)", head, rows)


def main() -> None:
    print(machine())
    native = Native.shipped("double_pendulum", START)
    right_hand_sides(native)
    work_precision(native)
    asked()


if __name__ == "__main__":
    main()
