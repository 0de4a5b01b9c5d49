"""How the cost of each stage of compiling grows with the model: seconds at the largest size, and exponents.

CPU time of the process, the least of some runs.  An exponent is that of the two largest sizes, of the pieces
that a model has (an n-body model n^2 of them).  `python -m tools.benchmarks.stages [FAMILY ...]`.
"""

from __future__ import annotations

import gc
import math
import sys
import time
from collections.abc import Callable
from typing import Any, NamedTuple

from lagc.compiler import checking, pipeline, stages
from lagc.compiler.stages import Choice
from lagc.diagnostics.faults import Fault, Refused, Source
from lagc.host import model_library
from lagc.host.budgets import Limits
from lagc.lowering.program import Program
from tools.benchmarks.tables import Cell, machine, table

LEAST = 0.3  # s of CPU a size, beyond which it is not measured again
MOST = 60.0  # beyond which larger sizes are left out
RUNS = 3
NOISE = 0.02  # s at the largest size, below which an exponent says nothing


class Family(NamedTuple):
    text: Callable[[int], str]
    sizes: tuple[int, ...]
    structural: bool = False  # n is a parameter of the model
    pieces: Callable[[int], int] = lambda n: n


def shipped(name: str) -> Callable[[int], str]:
    return lambda _: model_library.read(name).text


def instances(row: str, last: str = "") -> Callable[[int], str]:
    """n uncoupled parts with one row each."""
    part = (
        "model Part\n  coordinate Length x(start = 0.6 [m]), y(start = 0.8 [m]);\n"
        f"  body b = Particle(mass = 3 [kg], at = {{x, y, 0}});\n  constraint c: {row};\n{last}end Part;\n"
    )
    return lambda n: f"{part}model M\n  Part a[{n}];\nend M;\n"


def lines(line: Callable[[int], str], last: Callable[[int], str] = lambda n: "") -> Callable[[int], str]:
    first = "  parameter Mass m = 1 [kg];\n  parameter Length L = 1 [m];\n  parameter Energy E = 1 [J];\n"
    body = "  coordinate Length x(start = 1 [m]), y;\n  body b = Particle(mass = m, at = {x, y, 0});\n"
    return lambda n: f"model M\n{first}{body}{''.join(map(line, range(n)))}{last(n)}end M;\n"


def scenes(n: int) -> str:
    effect = "  effect g\n    Gravity field;\n  end g;\n"
    one = lines(lambda k: f"  scene s{k} uses g\n    start x = {k} [m];\n  end s{k};\n")(n)
    return one.replace("  scene s0 ", f"{effect}  scene s0 ", 1)


def uncoupled(n: int) -> str:
    spring = "  potential V{0} = 1/2*(1 [N/m])*x{0}^2;\n"
    bodies = (
        f"  coordinate Length x{k}(start = 1 [m]);\n  body b{k} = Particle(mass = m, at = {{x{k}, 0, 0}});\n"
        + spring.format(k)
        for k in range(n)
    )
    return "model M\n  parameter Mass m = 1 [kg];\n" + "".join(bodies) + "end M;\n"


def product(n: int) -> str:
    factors = "*".join(f"(1 + x/L/{k + 2})" for k in range(n))
    return lines(lambda _: "", lambda _: f"  potential V = E*{factors};\n")(n)


def roots(function: str) -> Callable[[int], str]:
    """A sum of n functions that end somewhere, each of two of n + 1 coordinates."""

    def text(n: int) -> str:
        declared = "".join(
            f"  coordinate Length x{k}(start = {k + 1} [m]);\n"
            f"  body b{k} = Particle(mass = m, at = {{x{k}, 0, 0}});\n"
            for k in range(n + 1)
        )
        terms = " + ".join(f"{function}((2*L + x{k + 1} - x{k})/L)" for k in range(n))
        first = "  parameter Mass m = 1 [kg];\n  parameter Length L = 1 [m];\n  parameter Energy E = 1 [J];\n"
        return f"model M\n{first}{declared}  potential V = E*({terms});\nend M;\n"

    return text


CIRCLE = "x^2 + y^2 = 1 [m2]"
APART = "  constraint d: x^2 + y^2 = 2 [m2];\n"
CHAINS = (12, 25, 50, 100)
FAMILIES = {
    "rows": Family(instances(CIRCLE), (50, 100, 200, 400)),
    "contradictions": Family(instances("x^2 + y^2 = -1 [m2]"), (25, 50, 100, 200)),
    "moved": Family(instances("x^2 + y^2 = 4 [m2]"), (25, 50, 100, 200)),
    "scenes": Family(scenes, (100, 200, 400, 800)),
    "uncoupled": Family(uncoupled, (250, 500, 1000, 2000)),
    "parameters": Family(lines(lambda k: f"  parameter Real p{k} = {k};\n"), (12500, 25000, 50000, 100000)),
    "product": Family(product, (375, 750, 1500, 3000)),
    "logarithms": Family(roots("log"), CHAINS),
    "roots": Family(roots("sqrt"), CHAINS),
    "n_body": Family(shipped("large/n_body"), (5, 10, 20, 40), True, lambda n: n * n),
    "net": Family(shipped("large/net"), (2, 4, 6, 10), True, lambda n: n * n),
    "truss": Family(shipped("large/truss"), CHAINS, True),
    "lattice": Family(shipped("large/lattice"), CHAINS, True),
    "mobile": Family(shipped("large/mobile"), (13, 25, 51, 101), True),
    "rope": Family(shipped("large/rope"), CHAINS, True),
    "ball_chain": Family(shipped("large/ball_chain"), CHAINS, True),
    "relative_chain": Family(shipped("large/relative_chain"), CHAINS, True),
    "chain": Family(shipped("classic/chain"), CHAINS, True),
    "spring_chain": Family(shipped("classic/spring_chain"), CHAINS, True),
}


class Stages:
    """The stages of one model, each from what the one before has made."""

    def __init__(self, text: str, n: int, structural: bool):
        self.source = Source("m.lag", text)
        self.choice = Choice(parameters={"n": n} if structural else {})
        self.made: dict[str, Any] = {}

    def parse(self) -> Any:
        return stages.parse(self.source)

    def resolve(self) -> Any:
        return stages.resolve(self.made["parse"], self.choice)

    def derive(self) -> Any:
        return stages.derive(self.made["resolve"])

    def optimize(self) -> Program:
        return stages.optimize(self.made["derive"], work=True)

    def start(self) -> Any:
        from lagc.simulation.initialization.dry_run import try_start
        from lagc.simulation.request import bound_parameters

        program = self.made["optimize"]
        left = pipeline.unused(self.made["resolve"], program.interface)
        values = bound_parameters(program.interface, {}, left, demanding=False)
        return try_start(program, values)

    def render(self) -> Any:
        return stages.render(self.made["optimize"], "c")

    def equations(self) -> Any:
        from lagc.reports.equations.write import write

        return write(self.made["derive"], full=False)

    def explain(self) -> Any:
        from lagc.reports.explain import explanation

        return explanation(self.made["derive"], self.made["optimize"])

    def check(self) -> list[Fault]:
        """All of it, from the text."""
        return checking.check(self.source, self.choice)


NEEDS = {
    "resolve": ["parse"], "derive": ["resolve"], "optimize": ["derive"], "start": ["optimize"],
    "render": ["optimize"], "equations": ["derive"], "explain": ["optimize"],
}  # fmt: skip
STAGES = ("parse", "resolve", "derive", "optimize", "start", "render", "equations", "explain", "check")


def seconds(one: Stages, stage: str) -> float:
    """CPU seconds, the least of some; infinite where it takes too long.  What is refused is a result too."""
    least, spent = math.inf, 0.0
    for _ in range(RUNS):
        gc.collect()
        began = time.process_time()
        try:
            with Limits(time=MOST):
                one.made[stage] = getattr(one, stage)()
        except Refused as refused:
            if refused.faults[0].code == "LAG0801":
                return math.inf
        took = time.process_time() - began
        least, spent = min(least, took), spent + took
        if spent > LEAST:
            break
    return least


def grown(family: Family) -> list[list[Cell]]:
    """A row a stage: seconds at each size, and the exponent of the two largest that were measured."""
    taken: dict[str, list[float]] = {stage: [] for stage in STAGES}
    for n in family.sizes:
        one = Stages(family.text(n), n, family.structural)
        for stage in STAGES:
            over = bool(taken[stage]) and taken[stage][-1] > MOST / 8.0
            possible = all(part in one.made for part in NEEDS.get(stage, ()))
            taken[stage].append(seconds(one, stage) if possible and not over else math.inf)
    rows: list[list[Cell]] = []
    for stage, times in taken.items():
        known = [(family.pieces(n), t) for n, t in zip(family.sizes, times) if t < math.inf]
        exponent: Cell = None
        if len(known) > 1 and known[-1][1] > NOISE:
            (few, short), (many, long) = known[-2:]
            exponent = round(math.log(long / short) / math.log(many / few), 2)
        rows.append([stage, *(t if t < math.inf else None for t in times), exponent])
    return rows


def main() -> None:
    print(machine())
    for name in sys.argv[1:] or FAMILIES:
        family = FAMILIES[name]
        table(f"{name} (s)", ["", *map(str, family.sizes), "exponent"], grown(family))


if __name__ == "__main__":
    main()
