"""Errors and CPU times of all tools on one problem, and the machine that they are measured on.

The reference is in quadruple precision.  An error is the largest of all states at the recorded times,
relative to the range of the state.  All settings are timed in turn, so that a disturbance of the machine
meets them all; the least time counts.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from datetime import date
from importlib.metadata import PackageNotFoundError, version
from statistics import median
from typing import Any

import numpy as np

from lagc.study.cost import Reference, refer
from lagc.study.probe import Array
from lagc.version import __version__
from tools.benchmarks.problems import Problem
from tools.benchmarks.tables import machine
from tools.benchmarks.tools import Task, Tool, task
from tools.benchmarks.workers import Unable, Worker

POINTS, EVERY = 201, 10  # times of the reference; each tenth is recorded by the tools
TOLERANCES = tuple(10.0**-k for k in range(2, 14))
TARGETS = (1e-3, 1e-6, 1e-9)
LEAST_TIME = 2e-3  # s of one measurement: shorter runs are repeated
LONGEST = 1.0  # s: after a longer run no finer tolerance is tried
PREPARES = 0.1  # s: a longer first run may have compiled for its tolerance
PATIENCE = 1.5  # s for all rounds of one setting
ROUNDS, QUICK_ROUNDS = 9, 1
BUDGET, QUICK_BUDGET = 20.0, 1.0  # s for a reference


def power(tolerance: float) -> str:
    return f"{tolerance:.0e}".replace("e-0", "e-")


def short(x: float) -> float:
    return float(f"{x:.3g}")


@dataclass
class Dot:
    """One setting: the true error and the CPU times in s."""

    tolerance: float
    error: float
    times: list[float] = field(default_factory=list)

    @property
    def seconds(self) -> float:
        return min(self.times)


@dataclass
class Line:
    """All settings of a tool on a problem; `ready`: CPU time in s to the first result."""

    tool: str
    dots: list[Dot] = field(default_factory=list)
    ready: float = 0.0
    note: str = ""  # why there are no more dots

    def fastest(self, target: float) -> float | None:
        """The CPU time in s of the fastest run with at most that error."""
        return min((d.seconds for d in self.dots if d.error <= target), default=None)

    def made(self, tolerance: float) -> float | None:
        """The error at a tolerance."""
        return next((d.error for d in self.dots if d.tolerance == tolerance), None)


@dataclass
class Part:
    """The results of one problem; `agreement` of two references."""

    name: str
    title: str
    agreement: float
    lines: list[Line]

    def line(self, tool: str) -> Line | None:
        return next((line for line in self.lines if line.tool == tool and line.dots), None)


@dataclass
class Report:
    """All of a run of the benchmarks."""

    day: str
    machine: str
    versions: dict[str, str]  # of the tools
    missing: dict[str, str]  # packages that are not installed
    parts: list[Part] = field(default_factory=list)

    def to_dict(self) -> dict[str, Any]:
        return {
            "date": self.day, "machine": self.machine, "versions": self.versions, "missing": self.missing,
            "problems": [
                {"name": part.name, "title": part.title, "reference_agreement": short(part.agreement),
                 "tools": [
                     {"tool": line.tool, "ready_s": short(line.ready), "note": line.note,
                      "points": [[short(x) for x in (d.tolerance, d.error, d.seconds, median(d.times))]
                                 for d in line.dots]}
                     for line in part.lines
                 ]}
                for part in self.parts
            ],
            "columns_of_points": ["tolerance", "error", "least_seconds", "median_seconds"],
        }  # fmt: skip


def begun(tools: Sequence[Tool]) -> Report:
    """A report without results."""
    versions, missing = {"lagc": __version__}, {}
    for package in dict.fromkeys(t.package for t in tools if t.package):
        try:
            versions[package] = version(package)
        except PackageNotFoundError:
            missing[package] = "not installed"
    return Report(date.today().isoformat(), machine(), versions, missing)


def reference(problem: Problem, budget: float) -> tuple[Task, Reference]:
    """The problem, and its motion at all times."""
    fine = task(problem, POINTS)

    def sizes(values: Array) -> Array:
        found: Array = np.abs(values).max(axis=0)
        found[len(fine.x0) :] = np.nan  # outputs are not compared
        return found

    exact = refer(fine.probe("quad"), fine.probe(), fine.times, sizes, budget)
    return Task(problem, fine.model, fine.x0, fine.times[::EVERY]), exact


def error(values: Array, exact: Reference) -> float:
    true = exact.shot.hi[::EVERY, : values.shape[1]]
    if values.shape != true.shape or not np.isfinite(values).all():
        return float("inf")
    return float((np.abs(values - true) / exact.scales[: values.shape[1]]).max())


def measure(problem: Problem, tools: Sequence[Tool], quick: bool = False) -> Part:
    asked, exact = reference(problem, QUICK_BUDGET if quick else BUDGET)
    lines = [Line(tool.name) for tool in tools]
    workers = [Worker(tool, asked) for tool in tools]
    for line, worker in zip(lines, workers):
        first(line, worker, exact, TARGETS if quick else TOLERANCES)
    for k in range(QUICK_ROUNDS if quick else ROUNDS):
        for line, worker in zip(lines, workers):
            for dot in line.dots:
                repeats = max(1, int(LEAST_TIME / dot.seconds))
                if k < 2 or sum(dot.times) * repeats < PATIENCE:
                    with suppress(Unable):
                        again = worker.ask(dot.tolerance, repeats, repeats * dot.seconds)[1]
                        dot.times.append(max(again, 1e-9))
    for worker in workers:
        worker.end()
    return Part(problem.name, problem.title, exact.agreement, lines)


def first(line: Line, worker: Worker, exact: Reference, tolerances: Sequence[float]) -> None:
    """Fill in the errors of a tool."""
    for tolerance in tolerances:
        try:
            values, seconds, ready = worker.ask(tolerance, 1)
        except Unable as reason:
            line.note = str(reason) if reason.over else f"fails at {tolerance:.0e}: {reason}"
            if reason.over:
                return
            continue
        line.ready = line.ready or ready
        if seconds > PREPARES:
            values, seconds, _ = worker.ask(tolerance, 1)
        made = error(values, exact)
        if made < float("inf"):
            line.dots.append(Dot(tolerance, made, [max(seconds, 1e-9)]))
        if seconds > LONGEST:
            line.note = f"finer than {tolerance:.0e} not tried: {seconds:.1f} s"
            return
