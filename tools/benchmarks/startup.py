"""Whole processes of the command line: cold (empty cache), warm, and where the time of imports goes.

CPU time of the child and its wall time, medians; the bare interpreter is shown beside them.
"""

from __future__ import annotations

import os
import resource
import shutil
import sys
import tempfile
import time
from collections.abc import Sequence
from statistics import median

from tools.benchmarks.installed import folder, run
from tools.benchmarks.tables import Cell, machine, table

ROUNDS = 9
TARGETS: dict[str, float] = {"sim, cold": 0.4, "sim, warm": 0.15}
LAGC = (sys.executable, "-m", "lagc")
SIM = (*LAGC, "sim", "simple_pendulum")
CASES: dict[str, tuple[Sequence[str], bool]] = {  # words, with an empty cache
    "python -c pass": ((sys.executable, "-c", "pass"), False),
    "python -I -S -c pass": ((sys.executable, "-I", "-S", "-c", "pass"), False),
    "import lagc": ((sys.executable, "-c", "import lagc"), False),
    "--version": ((*LAGC, "--version"), False),
    "--help": ((*LAGC, "--help"), False),
    "check": ((*LAGC, "check", "simple_pendulum"), True),
    "equations": ((*LAGC, "equations", "simple_pendulum"), True),
    "sim, cold": (SIM, True),
    "sim, warm": (SIM, False),
    "sim --backend c, warm": ((*SIM, "--backend", "c"), False),
}


def child(words: Sequence[str], cache: str) -> tuple[float, float, str]:
    """CPU and wall seconds of one process, and what it wrote to its error output."""
    folder()
    before, began = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    done = run(words, cache)
    wall, after = time.perf_counter() - began, resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return cpu, wall, done.stderr


def imports(words: Sequence[str], cache: str, shown: int = 12) -> list[list[Cell]]:
    """The modules whose own import costs most, as rows [name, ms, ms with what it imports]."""
    _, _, said = child([words[0], "-X", "importtime", *words[1:]], cache)
    found: list[tuple[float, float, str]] = []
    for line in said.splitlines():
        parts = line.removeprefix("import time:").split("|")
        if line.startswith("import time:") and parts[0].strip().isdigit():
            found.append((int(parts[0]) / 1e3, int(parts[1]) / 1e3, parts[2].strip()))
    found.sort(reverse=True)
    total: list[list[Cell]] = [[f"all {len(found)} modules", sum(f[0] for f in found), None]]
    return total + [[name, own, whole] for own, whole, name in found[:shown]]


def main() -> None:
    print(machine())
    root = tempfile.mkdtemp(prefix="lagc-startup-")
    warm = os.path.join(root, "warm")
    times: dict[str, list[tuple[float, float]]] = {name: [] for name in CASES}
    for words, _ in CASES.values():
        child(words, warm)
    child(SIM, os.path.join(root, "first"))
    for number in range(ROUNDS):
        for name, (words, cold) in CASES.items():
            cache = os.path.join(root, f"{number}-{name}") if cold else warm
            times[name].append(child(words, cache)[:2])
    rows: list[list[Cell]] = []
    for name, taken in times.items():
        cpu, wall = (1e3 * median(column) for column in zip(*taken))
        target = TARGETS.get(name)
        rows.append([name, cpu, wall, 1e3 * min(w for _, w in taken), 1e3 * target if target else None])
    table("Whole processes (ms)", ["", "CPU, median", "wall, median", "wall, least", "target"], rows)
    for name, cache in (("cold", os.path.join(root, "traced")), ("warm", warm)):
        table(f"Imports of `lagc sim simple_pendulum`, {name} (ms)", ["module", "own", "with its imports"],
              imports(SIM, cache))  # fmt: skip
    shutil.rmtree(root)


if __name__ == "__main__":
    main()
