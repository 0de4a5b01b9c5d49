"""What a model of size n costs: everything should grow as n does.

    python -m tools.benchmarks growth [--families NAMES] [--up-to N]

Compiling is timed in a cold process with an empty cache, imports included, from the model's text to the first
right-hand side in Python, and in C with what the C compiler takes; `MB` is the most memory until then.
Right-hand sides and C are those of `lagc build`.  All times are of the CPU.  An exponent is the slope between
logarithms over the last factor of ten of the sizes, of those from 50 on.
"""

from __future__ import annotations

import argparse
import json
import math
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from statistics import linear_regression
from typing import Any, NamedTuple

from tools.benchmarks.installed import run
from tools.benchmarks.native import Native
from tools.benchmarks.tables import Cell, machine, table

LONGEST = 120.0  # s of one size
LAST = 30.0  # s of compiling, beyond which no larger size is tried
ROUNDS = 3
SMALLEST = 50  # of the sizes that exponents are taken from

COLD = """
import json, resource, sys
def cpu():
    used = map(resource.getrusage, (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(u.ru_utime + u.ru_stime for u in used)
began = cpu()
import lagc
compiled = lagc.load(sys.argv[1]).compile(parameters={"n": int(sys.argv[2])}, backend=sys.argv[3])
system = compiled.system
x = system.start()
system.rhs(0.0, x, [0.0] * len(x), [0.0] * compiled.interface.nc)
seconds = cpu() - began
status = dict(line.split(":", 1) for line in open("/proc/self/status"))
from lagc.compiler.stages import render
print(json.dumps({"x": list(x), "operations": compiled.operations, "constrained": compiled.interface.nc > 0,
    "MB": int(status["VmHWM"].split()[0]) / 1024.0, "seconds": seconds,
    "sources": render(compiled.program, "c")}))
"""
MEASURED = ("operations", "us a rhs", "kB of C", "s of cc", "s to rhs", "s to rhs in C", "MB")


class Family(NamedTuple):
    model: str
    sizes: tuple[int, ...]
    pieces: Callable[[int], int] = lambda n: n  # bodies


SIZES = (2, 5, 10, 20, 50, 100, 200, 500, 1000)
FAMILIES = {
    "chain": Family("classic/chain", (*SIZES, 2000, 5000, 10000)),
    "relative_chain": Family("large/relative_chain", SIZES),
    "rope": Family("large/rope", SIZES),
    "ball_chain": Family("large/ball_chain", SIZES),
    "mobile": Family("large/mobile", (3, 5, 11, 21, 51, 101, 201, 501, 1001)),
    "net": Family("large/net", (2, 3, 4, 5, 7, 10, 14, 22, 32), lambda n: n * n),
    "lattice": Family("large/lattice", SIZES),
    "truss": Family("large/truss", SIZES),
    "n_body": Family("large/n_body", (2, 5, 10, 20, 50, 70, 100)),
}


def state(cold: Mapping[str, Any]) -> list[float]:
    """The start, and nowhere special where no constraint holds it."""
    x: list[float] = cold["x"]
    return x if cold["constrained"] else [a + 0.1 * math.sin(1.7 * k + 0.4) for k, a in enumerate(x)]


def first_result(model: str, n: int, backend: str) -> dict[str, Any]:
    """Of a cold process.  Raises TimeoutExpired."""
    with tempfile.TemporaryDirectory() as cache:
        words = [sys.executable, "-c", COLD, model, str(n), backend]
        found: dict[str, Any] = json.loads(run(words, cache, LONGEST).stdout)
    return found


def measured(family: Family, n: int) -> dict[str, float]:
    """Raises TimeoutExpired."""
    python, cold = (first_result(family.model, n, backend) for backend in ("numpy", "c"))
    native = Native(cold["sources"], state(cold))
    seconds = min(native.rhs() for _ in range(ROUNDS))
    values = (
        cold["operations"], 1e6 * seconds, sum(map(len, cold["sources"].values())) / 1e3, native.seconds,
        python["seconds"], cold["seconds"], python["MB"],
    )  # fmt: skip
    return dict(zip(MEASURED, values))


def exponent(pieces: Sequence[int], values: Sequence[float]) -> float | None:
    """The slope of least squares between logarithms."""
    few = max(SMALLEST, max(pieces) / 10.0)
    known = [(math.log(n), math.log(v)) for n, v in zip(pieces, values) if n >= few]
    if len(known) < 2:
        return None
    return linear_regression(*zip(*known)).slope


def rows(family: Family, most: int) -> list[list[Cell]]:
    """A row a size, and one of exponents."""
    found: list[list[Cell]] = []
    pieces: list[int] = []
    columns: dict[str, list[float]] = {name: [] for name in MEASURED}
    for n in family.sizes:
        if family.pieces(n) > most:
            break
        try:
            values = measured(family, n)
        except subprocess.TimeoutExpired:
            found.append([f"{n} takes longer than {LONGEST:g} s"])
            break
        count = family.pieces(n)
        pieces.append(count)
        for name, value in values.items():
            columns[name].append(value)
        own = [value if name != "operations" else int(value) for name, value in values.items()]
        found.append([count, round(values["operations"] / count), *own])
        if values["s to rhs in C"] + values["s of cc"] > LAST:
            break
    grown = [exponent(pieces, values) for values in columns.values()] if len(pieces) > 1 else []
    found.append(["exponent", None, *(round(e, 2) if e is not None else None for e in grown)])
    return [row + [None] * (len(HEAD) - len(row)) for row in found]


HEAD = ("bodies", "a body", *MEASURED)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--families", default=",".join(FAMILIES), help="separated by commas")
    parser.add_argument("--up-to", type=int, default=10000, help="bodies")
    asked = parser.parse_args()
    print(machine())
    for name in asked.families.split(","):
        table(name, HEAD, rows(FAMILIES[name], asked.up_to))


if __name__ == "__main__":
    main()
