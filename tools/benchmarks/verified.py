"""Errors that verified runs estimate beside those that they make, and the price.

    python -m tools.benchmarks verified [--all] [--scratch FOLDER] [--points N] [--words PART,PART]

Motions of the library (a sample without --all), or of the models in a folder, at accuracies from 1e-3 to
1e-10.  The truth is in quadruple precision where that takes seconds and the motion has no events, else in
double at the finest tolerance; errors below its own are left out.  The price is the number of right-hand
sides over those of the run that is returned.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from time import perf_counter

import numpy as np

import lagc
from lagc.api import CompiledModel
from lagc.diagnostics.faults import Refused
from lagc.host import cache
from lagc.host.model_library import library_models
from lagc.simulation.backends.compile import CannotCompile
from lagc.study.probe import Array, Failed, Late, Probe, Setting
from tools.benchmarks.tables import Cell, machine, table

ACCURACIES = tuple(10.0**-k for k in range(3, 11))
EVERY = 7  # model of the sample
LONGEST = 10.0  # s of a motion
POINTS = 201
BUDGET = 10.0  # s of a run that gives a truth
TRUTHS = {
    "quad": (Setting("dop853", rtol=1e-16), Setting("dop853", rtol=1e-18)),
    "double": (Setting("dopri5", rtol=1e-13), Setting("dop853", rtol=3e-15)),
}
CLEAR = 10.0  # least ratio of an error to that of its truth
FINE = (1e-14, 1e-13)  # tolerances of runs of models with events
FLOOR = 1e-13  # of the scale: errors below are left out


@dataclass(frozen=True)
class Outcome:
    """One verified run: what was asked, estimated and made; `ratios` are those of estimated and true errors
    of each quantity."""

    motion: str
    asked: float
    status: str
    estimated: float
    true: float
    ratio: float | None
    ratios: tuple[float, ...]
    price: float
    integrations: int

    @property
    def broken(self) -> bool:
        """Whether the run promises more than it has."""
        return self.status == "ok" and self.true > self.asked


@dataclass(frozen=True)
class Truth:
    """Values of the quantities `names` at the recorded times as sums hi + lo, and how well each is known."""

    names: list[str]
    hi: Array
    lo: Array
    known: Array
    times: Array
    jumps: Array


def own_truth(model: CompiledModel, stop: float, points: int) -> Truth | None:
    """The motion of a model with events, whose first ones a probe does not let act, by two fine runs."""
    fine, other = (model.simulate(stop, method="dop853", rtol=rtol, points=points) for rtol in FINE)
    if fine.status != "ok" or len(fine.times) != len(other.times) or len(fine.events) != len(other.events):
        return None
    names = [*fine.state_names, *(output.name for output in model.interface.outputs)]
    high, low = (np.array([run.column(name) for name in names]).T for run in (fine, other))
    jumps = np.array([event.t for event in fine.events])
    known = np.abs(high - low).max(axis=0)
    return Truth(names, high, np.zeros_like(high), known, np.array(fine.times), jumps)


def truth(model: CompiledModel, stop: float, points: int) -> Truth | None:
    """The motion at all recorded times; None where there is none."""
    from lagc.compiler import pipeline, stages

    if model.interface.relations or model.interface.whens or model.interface.discretes:
        return own_truth(model, stop, points)

    program = pipeline.delivered(model.compilation)
    times = [float(t) for t in np.linspace(0.0, stop, points)]
    x0, values = [float(x) for x in model.start(None)], model._bound(None)
    own = program.interface
    names = [*own.q_names, *own.v_names, *(output.name for output in own.outputs)]
    for real, settings in TRUTHS.items():
        with suppress(Failed, Late, CannotCompile):
            probe = Probe(stages.render(program, "c", real=real), own, values, x0, real)
            shots = []
            for setting in settings:
                probe.deadline = perf_counter() + BUDGET
                shots.append(probe.run(setting, times))
            other, best = shots
            rows = min(len(best.hi), len(other.hi))
            with np.errstate(all="ignore"):
                apart = np.abs((best.hi[:rows] - other.hi[:rows]) + (best.lo[:rows] - other.lo[:rows]))
            known = apart.max(axis=0)
            recorded = np.array(times[:rows])
            return Truth(names, best.hi[:rows], best.lo[:rows], known, recorded, np.array([]))
    return None


def outcomes(name: str, model: CompiledModel, stop: float, points: int) -> Iterator[Outcome]:
    exact = truth(model, stop, points)
    if exact is None:
        print(f"{name}: no truth", file=sys.stderr)
        return
    for asked in ACCURACIES:
        with cache.unused():
            run = model.simulate(stop, accuracy=asked, points=points)
        price, count = run.cost.rhs / max(run.cost.alone, 1), run.cost.integrations
        estimated = run.estimated if run.estimated is not None else np.inf
        rows = min(len(exact.hi), len(run.times))
        values: Array = np.array([run.column(each) for each in exact.names]).T[:rows]
        with np.errstate(all="ignore"):
            apart = np.abs((values - exact.hi[:rows]) - exact.lo[:rows])
        # Times of jumps may be wrong by the accuracy of the time of the run: beside them one run has jumped.
        beside = np.abs(exact.times[:rows, None] - exact.jumps[None, :]) <= 2.0 * asked * stop
        apart = np.where(np.any(beside, axis=1, keepdims=True), 0.0, apart).max(axis=0)
        errors = np.array([run.errors.get(each, 0.0) for each in exact.names])
        scales = np.array([run.scales.get(each, 0.0) for each in exact.names])
        clear = (scales > 0.0) & (apart > CLEAR * exact.known) & (apart > FLOOR * scales)
        true = float((apart[clear] / scales[clear]).max(initial=0.0))
        yield Outcome(
            name, asked, run.status, estimated, true, estimated / true if true and not run.cut else None,
            tuple(errors[clear] / apart[clear]) if not run.cut else (), price, count,
        )  # fmt: skip


def motions(asked: argparse.Namespace) -> Iterator[tuple[str, CompiledModel, float]]:
    names = library_models()[:: 1 if asked.all or asked.words else EVERY]
    if asked.words:
        names = [name for name in names if any(word in name for word in asked.words.split(","))]
    if asked.scratch:
        names = sorted(map(str, Path(asked.scratch).glob("*.lag")))
    for name in names:
        try:
            model = lagc.load(name).compile(backend="c")
        except Refused as refused:
            print(f"{name}: {refused}", file=sys.stderr)
            continue
        own = float(model.interface.simulate.get("stop", LONGEST))
        yield Path(name).name, model, own if asked.scratch else min(LONGEST, own)


def shares(values: list[float]) -> list[Cell]:
    """Median and least, then the shares below 0.8, in [1/2, 2] and in [1, 5] in per cent."""
    if not values:
        return [None] * 5
    found = np.array(values)
    parts = (found < 0.8, (found >= 0.5) & (found <= 2.0), (found >= 1.0) & (found <= 5.0))
    return [median(values), min(values), *(f"{100.0 * part.mean():.1f} %" for part in parts)]


HEAD = ("asked", "runs", "ok", "ok above", "median", "least", "< 0.8", "[1/2, 2]", "[1, 5]", "price",
        "at 90 %", "integrations")  # fmt: skip


def row(label: str, found: list[Outcome]) -> list[Cell]:
    prices = sorted(each.price for each in found if each.status == "ok") or [0.0]
    return [
        label, len(found), sum(each.status == "ok" for each in found), sum(each.broken for each in found),
        *shares([each.ratio for each in found if each.ratio is not None]),
        median(prices), prices[int(0.9 * (len(prices) - 1))],
        float(np.mean([each.integrations for each in found])),
    ]  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(
        prog="python -m tools.benchmarks verified", description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )  # fmt: skip
    parser.add_argument("--all", action="store_true", help="all models of the library")
    parser.add_argument("--scratch", metavar="FOLDER", help="models of a folder in place of the library")
    parser.add_argument("--points", type=int, default=POINTS, help="recorded times")
    parser.add_argument("--words", help="parts of names, separated by commas")
    asked = parser.parse_args()
    print(machine())
    found: list[Outcome] = []
    for name, model, stop in motions(asked):
        own = list(outcomes(name, model, stop, asked.points))
        found += own
        cells = [each.status[:1] if each.status == "failed" else "" for each in own]
        said = [f"{each.ratio:.2g}{cell}" if each.ratio else f"-{cell}" for each, cell in zip(own, cells)]
        said = [f"{word}!" if each.broken else word for each, word in zip(own, said)]
        print(f"{name:<32}", *(f"{word:>7}" for word in said), flush=True)
    if not found:
        return
    rows = [row(f"{asked_:.0e}", [each for each in found if each.asked == asked_]) for asked_ in ACCURACIES]
    table("Verified runs: estimated over true error", HEAD, [*rows, row("all", found)])
    table("Of each quantity", ("", *HEAD[4:9]), [["", *shares([r for each in found for r in each.ratios])]])
    for each in found:
        if each.broken:
            print(f"above what was asked: {each.motion} {each.asked:.0e}: {each.true:.2g}")


if __name__ == "__main__":
    main()
