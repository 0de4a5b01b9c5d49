"""The tools of the report: each integrates a problem to a tolerance; states are given at the recorded times.

A package is imported when its tool is made.  A tool that is not installed, or that has no way to state a
problem, raises ImportError or Without with the reason.
"""

from __future__ import annotations

import contextlib
import importlib
import math
import os
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from time import process_time
from typing import Any

import numpy as np

import lagc
from lagc.api import CompiledModel
from lagc.compiler import pipeline, stages
from lagc.host import cache
from lagc.kernels import EXPLICIT, IMPLICIT, METHODS
from lagc.study.probe import Array, Probe, Setting
from tools.benchmarks import dop853
from tools.benchmarks.problems import Problem

Run = Callable[[float, int], tuple[Array, float]]
# `run(tolerance, repeats)`: a row for each recorded time, and the CPU time of one run in s


class Without(Exception):
    """The tool cannot state the problem; the message says why."""


@dataclass(frozen=True)
class Task:
    """A problem, compiled by lagc, with its initial state and the recorded times."""

    problem: Problem
    model: CompiledModel
    x0: list[float]
    times: list[float]

    def probe(self, real: str = "double", method: str | None = None) -> Probe:
        contents = pipeline.Contents([method] if method else EXPLICIT)
        program = pipeline.delivered(self.model.compilation, contents)
        sources = stages.render(program, "c", real=real)
        return Probe(sources, program.interface, self.model._bound(None), self.x0, real)


def task(problem: Problem, points: int) -> Task:
    source = lagc.loads(problem.model) if "\n" in problem.model else lagc.load(problem.model)
    model = source.compile(problem.scene, parameters=problem.parameters, backend="c")
    x0 = [float(x) for x in model.start(None, **problem.starts)]
    return Task(problem, model, x0, [float(t) for t in np.linspace(0.0, problem.stop, points)])


def timed(once: Callable[[float], Array]) -> Run:
    """A run that is called from Python."""

    def run(tolerance: float, repeats: int) -> tuple[Array, float]:
        began = process_time()
        for _ in range(repeats):
            found = once(tolerance)
        return found, (process_time() - began) / repeats

    return run


def by_hand(method: str) -> Callable[[Task], Run]:
    def make(task: Task) -> Run:
        if method in IMPLICIT and not task.problem.stiff:
            raise Without("for stiff problems")
        probe, nx = task.probe(method=method), len(task.x0)

        def run(tolerance: float, repeats: int) -> tuple[Array, float]:
            shot = probe.run(Setting(method, rtol=tolerance), task.times, repeats)
            return shot.hi[:, :nx], shot.seconds

        return run

    return make


def verified(task: Task) -> Run:
    model, problem = task.model, task.problem
    model.load("c")

    def run(accuracy: float) -> Array:
        with cache.unused():
            found = model.simulate(
                problem.stop, accuracy=accuracy, points=len(task.times), starts=problem.starts
            )
        if found.status != "ok":
            raise ArithmeticError(found.message)
        return np.array([found.column(name) for name in problem.states]).T

    return timed(run)


def heyoka(task: Task) -> Run:
    hy: Any = importlib.import_module("heyoka")
    x = hy.make_vars(*(f"x{i}" for i in range(len(task.x0))))
    system = list(zip(x, task.problem.rates(hy, x)))
    start, grid, made = np.array(task.x0), np.array(task.times), {}

    def impact(integrator: Any, _: int) -> bool:
        integrator.state[1] *= -task.problem.rebound
        return True

    def prepared(tol: float) -> Any:
        events = {}
        if task.problem.rebound:
            falling = hy.event_direction.negative
            events = {"t_events": [hy.t_event(x[0], direction=falling, callback=impact)]}
        compact = len(start) > 8  # the machine code of long equations takes minutes otherwise
        return hy.taylor_adaptive(system, start.copy(), tol=tol, compact_mode=compact, **events)

    def run(tol: float) -> Array:
        if tol not in made:  # compiled for a tolerance
            made[tol] = prepared(tol)
        integrator = made[tol]
        integrator.time = 0.0
        integrator.state[:] = start
        if task.problem.rebound:
            integrator.reset_cooldowns()
        return np.asarray(integrator.propagate_grid(grid)[-1])

    return timed(run)


def _casadi(task: Task) -> tuple[Any, Any, Any]:
    if task.problem.rebound:
        raise Without("no events, or experimental ones")
    ca: Any = importlib.import_module("casadi")
    x = ca.SX.sym("x", len(task.x0))
    return ca, x, ca.vertcat(*task.problem.rates(ca, [x[i] for i in range(len(task.x0))]))


def casadi_dop853(task: Task) -> Run:
    if task.problem.stiff:
        raise Without("not for stiff problems")
    ca, x, rates = _casadi(task)
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        made = dop853.casadi_folder(ca.Function("rhs", [x], [rates]))
    return timed(dop853.solver(made, task.x0, task.times))


def casadi_cvodes(task: Task) -> Run:
    ca, x, rates = _casadi(task)
    made: dict[float, Any] = {}
    words = {} if task.problem.stiff else {
        "linear_multistep_method": "adams", "nonlinear_solver_iteration": "functional"
    }  # fmt: skip

    def run(tol: float) -> Array:
        if tol not in made:
            options = {"reltol": tol, "abstol": tol, "max_num_steps": 10**7, **words}
            made[tol] = ca.integrator("I", "cvodes", {"x": x, "ode": rates}, 0, task.times[1:], options)
        return np.vstack([task.x0, np.array(made[tol](x0=task.x0)["xf"]).T])

    return timed(run)


def in_python(problem: Problem) -> Callable[[float, Array], list[float]]:
    rates: Callable[..., list[float]] = problem.rates
    return lambda t, x: rates(math, x.tolist())


Piece = Callable[[list[float], Array], tuple[Array, Array, float | None]]


def _pieces(task: Task, part: Piece) -> Array:
    """The rows of a motion of pieces that end at impacts; `part(times, x)` gives the rows at the times that
    it reaches, its last state, and the time of the impact or None."""
    times, x, rows = task.times, np.array(task.x0), [np.array([task.x0])]
    while True:
        found, x, impact = part(times, x)
        rows.append(found)
        if impact is None:
            return np.vstack(rows)
        times, x = [impact, *(t for t in times if t > impact)], np.array([0.0, -task.problem.rebound * x[1]])


def scipy(method: str, stiff: bool | None = None) -> Callable[[Task], Run]:
    """`stiff`: for stiff problems alone, or for all others."""

    def make(task: Task) -> Run:
        if stiff is not None and stiff != task.problem.stiff:
            raise Without("for stiff problems" if stiff else "not for stiff problems")
        solve: Any = importlib.import_module("scipy.integrate").solve_ivp
        rates = in_python(task.problem)

        def wall(t: float, x: Array) -> float:
            return float(x[0])

        wall.terminal, wall.direction = True, -1  # type: ignore[attr-defined]

        def run(tol: float) -> Array:
            def part(times: list[float], x: Array) -> tuple[Array, Array, float | None]:
                found = solve(
                    rates, (times[0], times[-1]), x, method=method, rtol=tol, atol=tol, t_eval=times[1:],
                    events=wall if task.problem.rebound else None,
                )  # fmt: skip
                if found.status < 0:
                    raise ArithmeticError(found.message)
                rows = found.y.T if len(found.t) else np.zeros((0, len(x)))
                if found.status == 0:
                    return rows, rows[-1], None
                return rows, found.y_events[0][-1], float(found.t_events[0][-1])

            return _pieces(task, part)

        return timed(run)

    return make


def sundials(task: Task) -> Run:
    cvode: Any = importlib.import_module("sksundae.cvode")
    rates, problem = in_python(task.problem), task.problem

    def into(t: float, x: Array, dx: Array) -> None:
        dx[:] = rates(t, x)

    def wall(t: float, x: Array, into: Array) -> None:
        into[0] = x[0]

    wall.terminal, wall.direction = [True], [-1]  # type: ignore[attr-defined]
    words: dict[str, Any] = {"eventsfn": wall, "num_events": 1} if problem.rebound else {}
    words["method"] = "BDF" if problem.stiff else "Adams"

    def run(tol: float) -> Array:
        def part(times: list[float], x: Array) -> tuple[Array, Array, float | None]:
            found = cvode.CVODE(into, rtol=tol, atol=tol, max_num_steps=10**7, **words).solve(times, x)
            if not found.success:
                raise ArithmeticError(found.message)
            rows = found.y[np.isin(found.t, times[1:])]  # of two times alone it records the steps
            return rows, found.y[-1], float(found.t[-1]) if found.status == 2 else None

        return _pieces(task, part)

    return timed(run)


class Text:
    """An expression as the text of a Modelica equation."""

    def __init__(self, text: str):
        self.text = text

    @staticmethod
    def binary(sign: str, swapped: bool = False) -> Any:
        def joined(self: Text, other: Text | float) -> Text:
            there = other.text if isinstance(other, Text) else f"({other!r})"
            left, right = (there, self.text) if swapped else (self.text, there)
            return Text(f"({left} {sign} {right})")

        return joined

    def __neg__(self) -> Text:
        return Text(f"(-{self.text})")


for _sign, _name in zip("+-*/", ("add", "sub", "mul", "truediv")):
    setattr(Text, f"__{_name}__", Text.binary(_sign))
    setattr(Text, f"__r{_name}__", Text.binary(_sign, True))


class TextFunctions:
    """Functions of texts."""

    def __getattr__(self, name: str) -> Callable[[Text], Text]:
        return lambda x: Text(f"{name}({x.text})")


def rumoca(task: Task) -> Run:
    rm: Any = importlib.import_module("rumoca")
    n, problem = len(task.x0), task.problem
    if n > 8:
        raise Without("the equations as one text would be too long")
    rates = problem.rates(TextFunctions(), [Text(f"x{i}") for i in range(n)])
    lines = [f"  Real x{i}(start = {value!r}, fixed = true);" for i, value in enumerate(task.x0)]
    equations = [f"  der(x{i}) = {rate.text};" for i, rate in enumerate(rates)]
    if problem.rebound:
        equations.append(f"  when x0 < 0 then\n    reinit(x1, -{problem.rebound}*pre(x1));\n  end when;")
    text = "\n".join(["model P", *lines, "equation", *equations, "end P;", ""])
    model = rm.Session().loads(text, model="P")
    kind = "bdf" if problem.stiff else "rk-like"

    def run(tol: float) -> Array:
        config = rm.SimConfig(solver=kind, rtol=tol, atol=tol)
        found = model.simulate(t=(0.0, problem.stop), dt=problem.stop / (len(task.times) - 1), config=config)
        early = np.array(task.times) - 1e-12 * problem.stop
        rows = np.searchsorted(found.time, early)  # events are recorded too
        return np.array([found.to_dict()["data"][f"x{i}"] for i in range(n)]).T[rows]

    return timed(run)


@dataclass(frozen=True)
class Tool:
    """`package`: the distribution whose version is told; None for lagc itself.  `asks`: the tolerance is the
    global error that is asked for."""

    name: str
    make: Callable[[Task], Run]
    package: str | None = None
    asks: bool = False


TOOLS = (
    *(Tool(f"lagc, C, {m}", by_hand(m)) for m in ("dop853", "radau5", "taylor") if m in METHODS),
    Tool("lagc, accuracy=", verified, asks=True),
    Tool("heyoka", heyoka, "heyoka"),
    Tool("casadi's C in DOP853", casadi_dop853, "casadi"),
    Tool("casadi, CVODES", casadi_cvodes, "casadi"),
    Tool("scikit-sundae, CVODE", sundials, "scikit-sundae"),
    Tool("SciPy, DOP853", scipy("DOP853", False), "scipy"),
    Tool("SciPy, LSODA", scipy("LSODA"), "scipy"),
    Tool("SciPy, Radau", scipy("Radau", True), "scipy"),
    Tool("rumoca", rumoca, "rumoca"),
)


def alone() -> None:
    """One thread for all tools."""
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ[name] = "1"


def chosen(words: Sequence[str] | None) -> list[Tool]:
    """The tools whose name has one of the words; lagc always, all for None."""
    return [t for t in TOOLS if t.package is None or words is None or any(w in t.name for w in words)]
