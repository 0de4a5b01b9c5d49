"""The n-fold pendulum: from the model's text to the first right-hand side, in a cold process.

Nothing of the model is cached; the time of the interpreter's start is left out, imports are in.
Stages are CPU times within one process.

    python -m tests.benchmarks.chain [--peers NAMES] [--n NUMBERS]
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
from statistics import median
from typing import Any

from tests.benchmarks import peers
from tests.benchmarks.installed import run
from tests.benchmarks.tables import Cell, machine, table

NUMBERS = (1, 2, 5, 10, 20, 50, 100, 200)
TARGETS = {10: 0.2, 100: 1.0}
PEERS = ("casadi_sx_c", "casadi_aba_c", "casadi_ldl_vm", "sympy_lagrange", "sympy_kane", "heyoka_lagrangian")
PEER_LIMIT = 30.0  # s; a peer that needs longer for one n is not tried for a larger one
STAGES = ("imports", "parse", "resolve", "derive", "optimize", "render", "load", "first rhs")

WORKER = """
import sys, time
clock, wall = time.process_time, time.perf_counter
marks, began = [clock()], wall()
n = int(sys.argv[1])
def mark(): marks.append(clock())
import lagc
from lagc.compiler.pipeline import Choice, Compilation, derive, optimize, parse, render, resolve
from lagc.host import model_library as library
import lagc.semantics.resolve, lagc.syntax.parse, lagc.mechanics.derive, lagc.lowering.lower_equations
import lagc.codegen.python.emit, lagc.simulation.backends.python
mark()
tree = parse(library.read("chain")); mark()
model = resolve(tree, Choice(parameters={"n": float(n)})); mark()
equations = derive(model); mark()
program = optimize(equations, work=True); mark()
sources = render(program, "numpy"); mark()
system = lagc.simulation.backends.load(program.interface, sources, "numpy"); mark()
x = system.start()
xdot, lam = [0.0] * len(x), [0.0]
status = system.rhs(0.0, x, xdot, lam); mark()
total = wall() - began
for _ in range(3): system.rhs(0.0, x, xdot, lam)
again = clock(); count = 0
while clock() - again < 0.05:
    system.rhs(0.0, x, xdot, lam); count += 1
import json
print(json.dumps({"stages": [b - a for a, b in zip(marks, marks[1:])], "wall": total, "status": status,
    "rhs": (clock() - again) / count, "nodes": len(model.graph.nodes), "solve": program.interface.solve,
    "operations": program.interface.operations}))
"""
WHOLE = """
import sys, time
clock, wall = time.process_time, time.perf_counter
first, began = clock(), wall()
import lagc
compiled = lagc.load("chain").compile(parameters={"n": int(sys.argv[1])})
value = compiled.system.rhs(0.0, compiled.system.start(), [0.0] * compiled.interface.nx, [])
print(clock() - first, wall() - began, compiled.backend)
"""


def child(text: str, n: int, cache: str) -> str:
    """What the program says, run in a process of its own."""
    return run([sys.executable, "-c", text, str(n)], cache).stdout


def stages(numbers: tuple[int, ...], rounds: int) -> dict[int, float]:
    """Print the stages of each n; the CPU seconds of all stages."""
    taken: dict[int, list[dict[str, Any]]] = {n: [] for n in numbers}
    with tempfile.TemporaryDirectory() as cache:
        for _ in range(rounds):
            for n in numbers:
                taken[n].append(json.loads(child(WORKER, n, cache)))
    rows: list[list[Cell]] = []
    totals: dict[int, float] = {}
    for n, runs in taken.items():
        parts = [1e3 * median(column) for column in zip(*(r["stages"] for r in runs))]
        totals[n] = median(sum(r["stages"]) for r in runs)
        one = runs[0]
        cells: list[Cell] = [round(p, 1) for p in parts]
        rhs = 1e6 * median(float(r["rhs"]) for r in runs)
        rows.append(
            [n, *cells, round(1e3 * totals[n], 1), one["nodes"], one["operations"], one["solve"], rhs]
        )
    head = ["n", *STAGES, "all", "nodes", "operations", "solve", "us a rhs"]
    table("Stages, NumPy backend (ms of CPU)", head, rows)
    return totals


def whole(numbers: tuple[int, ...], rounds: int) -> dict[int, float]:
    """Print load, compile and a first right-hand side through the interface, nothing kept."""
    taken: dict[int, list[list[str]]] = {n: [] for n in numbers}
    for _ in range(rounds):
        for n in numbers:
            with tempfile.TemporaryDirectory() as cache:
                taken[n].append(child(WHOLE, n, cache).split())
    rows: list[list[Cell]] = []
    totals: dict[int, float] = {}
    for n, runs in taken.items():
        totals[n] = median(float(r[0]) for r in runs)
        rows.append([n, totals[n], median(float(r[1]) for r in runs), runs[0][2], TARGETS.get(n)])
    table("From text to first right-hand side, empty cache, imports included (s)",
          ["n", "CPU", "wall", "backend (auto)", "target"], rows)  # fmt: skip
    return totals


def against(names: tuple[str, ...], numbers: tuple[int, ...], own: dict[int, float]) -> None:
    rows: list[list[Cell]] = [["lagc", *(own.get(n) for n in numbers)]]
    ratios: list[list[Cell]] = []
    for name in names:
        row: list[Cell] = [name]
        ratio: list[Cell] = [name]
        for n in numbers:
            found = (peers.chain(name, n, PEER_LIMIT) or {}) if row[-1] != "-" else {}
            seconds = found.get("t_cpu")
            row.append(seconds if seconds is not None else found.get("note", "-"))
            ratio.append(seconds / own[n] if seconds is not None else "-")
            if seconds is None:
                row += ["-"] * (len(numbers) - len(row) + 1)
                ratio += ["-"] * (len(numbers) - len(ratio) + 1)
                break
        rows.append(row)
        ratios.append(ratio)
    head = ["", *(f"n = {n}" for n in numbers)]
    table("From model to first right-hand side, cold process (CPU s, with compilers)", head, rows)
    table("The same, x lagc", head, ratios)


def main(words: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--peers", default=",".join(PEERS))
    parser.add_argument("--n", default=",".join(map(str, NUMBERS)))
    parser.add_argument("--rounds", type=int, default=3)
    asked = parser.parse_args(words)
    numbers = tuple(int(n) for n in asked.n.split(","))
    print(machine())
    stages(numbers, asked.rounds)
    own = whole(numbers, asked.rounds)
    if peers.available():
        against(tuple(filter(None, asked.peers.split(","))), numbers, own)


if __name__ == "__main__":
    main()
