"""What a model of size n costs: everything should grow as n does.

    python -m tests.benchmarks growth [--families NAMES] [--up-to N]

Compiling is timed in a cold process with an empty cache, imports included, from the model's text to the first
right-hand side in Python, and in C with what the C compiler takes; `MB` is the most memory until then.
Right-hand sides and C are those of `lagc build`.  All times are of the CPU.  An exponent is the slope between
logarithms over the last factor of ten of the sizes, of those from 50 on.  Peers are asked for the models that
they have, in the same run; the least of some rounds is taken of all.
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

from tests.benchmarks import peers
from tests.benchmarks.installed import run
from tests.benchmarks.native import Native
from tests.benchmarks.tables import Cell, machine, table

LONGEST = 120.0  # s of one size
LAST = 30.0  # s of compiling, beyond which no larger size is tried
PEER_LIMIT = 30.0  # s; a peer that needs longer for one size is not tried for a larger one
PATIENCE = 600.0  # s for the first answer: Pinocchio's harness is compiled for it
ROUNDS = 3
SMALLEST = 50  # of the sizes that exponents are taken from

COLD = """
import json, resource, sys
def cpu():
    used = map(resource.getrusage, (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(u.ru_utime + u.ru_stime for u in used)
def first(backend):
    system = compiled.load(backend)
    x = system.start()
    system.rhs(0.0, x, [0.0] * len(x), [0.0] * compiled.interface.nc)
    return list(x)
began = cpu()
import lagc
compiled = lagc.load(sys.argv[1]).compile(parameters={"n": int(sys.argv[2])}, backend="numpy")
compiled.program
compiling = cpu()
x = first("numpy")
python = cpu()
status = dict(line.split(":", 1) for line in open("/proc/self/status"))
first("c")
c = cpu()
from lagc.compiler.pipeline import render
print(json.dumps({"x": x, "operations": compiled.operations, "MB": int(status["VmHWM"].split()[0]) / 1024.0,
    "first": python - began, "C": compiling - began + c - python, "constrained": compiled.interface.nc > 0,
    "sources": render(compiled.program, "c")}))
"""
MEASURED = ("operations", "us a rhs", "kB of C", "s of cc", "s to rhs", "s to rhs in C", "MB")


class Peer(NamedTuple):
    """A row of what a peer takes: us of a right-hand side, operations, s to the first one."""

    us: float | None = None
    operations: int | None = None
    seconds: float | None = None


class Family(NamedTuple):
    model: str
    sizes: tuple[int, ...]
    pieces: Callable[[int], int] = lambda n: n  # bodies
    peers: Callable[[int], Mapping[str, Peer]] = lambda n: {}


NAMES = ("casadi", "pinocchio", "mujoco")
_GAVE_UP: set[str] = set()


def planar(n: int) -> dict[str, Peer]:
    """The planar chain: casadi as articulated bodies, written by hand."""
    found: dict[str, Peer] = {}
    for name, script in zip(NAMES, ("casadi_aba_c", "pinocchio", "mujoco")):
        if name not in _GAVE_UP:
            answer = peers.chain(script, n, PATIENCE if n == SIZES[0] else PEER_LIMIT) or {}
            seconds = answer.get("t_rhs")
            if seconds is None:
                _GAVE_UP.add(name)
            else:
                found[name] = Peer(1e6 * seconds, answer.get("ops"), answer["t_cpu"])
    return found


def balls(n: int) -> dict[str, Peer]:
    found = peers.balls(n, PATIENCE if n == SIZES[0] else PEER_LIMIT) if "balls" not in _GAVE_UP else {}
    if not found:
        _GAVE_UP.add("balls")
    return {name: Peer(1e6 * seconds, count) for name, (seconds, count) in found.items()}


SIZES = (2, 5, 10, 20, 50, 100, 200, 500, 1000)
FAMILIES = {
    "chain": Family("classic/chain", (*SIZES, 2000, 5000, 10000), peers=planar),
    "relative_chain": Family("large/relative_chain", SIZES),
    "rope": Family("large/rope", SIZES),
    "ball_chain": Family("large/ball_chain", SIZES, peers=balls),
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


def measured(family: Family, n: int) -> tuple[dict[str, float], dict[str, Peer]]:
    """Raises TimeoutExpired."""
    with tempfile.TemporaryDirectory() as cache:
        words = [sys.executable, "-c", COLD, family.model, str(n)]
        cold = json.loads(run(words, cache, LONGEST).stdout)
    native = Native(cold["sources"], state(cold))
    asked: dict[str, Peer] = {}
    seconds = math.inf
    for _ in range(ROUNDS if peers.available() else 1):
        seconds = min(seconds, *(native.rhs() for _ in range(ROUNDS)))
        for name, peer in family.peers(n).items() if peers.available() else ():
            before = asked.get(name, peer)
            asked[name] = min(before, peer, key=lambda p: p.us or math.inf)
    values = (
        cold["operations"], 1e6 * seconds, sum(map(len, cold["sources"].values())) / 1e3, native.seconds,
        cold["first"], cold["C"], cold["MB"],
    )  # fmt: skip
    return dict(zip(MEASURED, values)), asked


def exponent(pieces: Sequence[int], values: Sequence[float]) -> float | None:
    """The slope of least squares between logarithms."""
    few = max(SMALLEST, max(pieces) / 10.0)
    known = [(math.log(n), math.log(v)) for n, v in zip(pieces, values) if n >= few]
    if len(known) < 2:
        return None
    return linear_regression(*zip(*known)).slope


def rows(family: Family, most: int) -> list[list[Cell]]:
    """A row a size, with the peers' right-hand sides, and one of exponents."""
    found: list[list[Cell]] = []
    pieces: list[int] = []
    columns: dict[str, list[float]] = {name: [] for name in MEASURED}
    for n in family.sizes:
        if family.pieces(n) > most:
            break
        try:
            values, asked = measured(family, n)
        except subprocess.TimeoutExpired:
            found.append([f"{n} takes longer than {LONGEST:g} s"])
            break
        count = family.pieces(n)
        pieces.append(count)
        for name, value in values.items():
            columns[name].append(value)
        us = values["us a rhs"]
        own = [value if name != "operations" else int(value) for name, value in values.items()]
        others: list[Cell] = []
        for name in NAMES:
            peer = asked.get(name, Peer())
            others += [peer.us, us / peer.us if peer.us else None]
        casadi = asked.get(NAMES[0], Peer())
        found.append(
            [count, round(values["operations"] / count), *own, *others, casadi.operations, casadi.seconds]
        )
        if values["s to rhs in C"] + values["s of cc"] > LAST:
            break
    grown = [exponent(pieces, values) for values in columns.values()] if len(pieces) > 1 else []
    found.append(["exponent", None, *(round(e, 2) if e is not None else None for e in grown)])
    return [row + [None] * (len(HEAD) - len(row)) for row in found]


HEAD = (
    "bodies", "a body", *MEASURED, *(word for name in NAMES for word in (f"{name} us", "lagc/it")),
    "casadi ops", "casadi s",
)  # fmt: skip


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
