"""Hard cases: their texts and figures, how they are measured, and those with published values."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from time import process_time
from typing import Any, TypeAlias

from lagc.diagnostics.faults import Refused
from lagc.host.model_library import references_folder

Load: TypeAlias = Callable[[str], Any]  # `lagc.load`
Tell: TypeAlias = Callable[[float, str], None]  # part done, and what is being done
BACKENDS = ("c", "numpy")


class RunFailed(Exception):
    """A run that failed; the message tells why."""


@dataclass(frozen=True)
class Figure:
    """A quantity that is 0 for the exact motion, and the largest value that is required."""

    words: str
    most: float


@dataclass(frozen=True)
class Found:
    """The measured values, one for each figure, None where it is not for this backend.  `said` is what else
    the run told; `run` the motion."""

    values: tuple[float | None, ...]
    method: str
    said: str = ""
    run: Any = None


@dataclass(frozen=True)
class Case:
    """One hard case.  `model` names the library model, `line` is a command that runs it, `source` tells where
    the figure or the reference comes from, and `why` how it follows from the method.  Cases of one `group`
    are one row of a document."""

    name: str
    title: str
    hard: str
    source: str
    why: str
    model: str
    line: str
    figures: tuple[Figure, ...]
    measure: Callable[[Lab], Found]
    group: str = ""


class Lab:
    """The models and runs of one measurement.

    `backend` is "c" or "numpy"; long runs last the `part` of their full length, and the hundredth of it or
    so in Python.  `seconds` is the CPU time spent on compiling.
    """

    def __init__(self, load: Load, backend: str, part: float = 1.0, tell: Tell = lambda part, doing: None):
        self.load, self.backend, self.part, self.tell = load, backend, part, tell
        self.seconds = 0.0
        self.notes: list[str] = []

    def compile(self, model: str, scene: str | None = None, **given: Any) -> Any:
        """The compiled library model, loaded; `given` as for `ModelFile.compile`."""
        began = process_time()
        made = self.load(model).compile(scene, backend=self.backend, **given)
        made.load(self.backend)
        self.seconds += process_time() - began
        return made

    def clock(self, stop: float) -> Callable[[float], None]:
        """The function that a run to `stop` calls with the time reached."""
        return lambda t: self.tell(t / stop if stop else 1.0, f"t = {t:.4g} s")

    def run(self, model: Any, stop: float, **given: Any) -> Any:
        """A run to its end; `given` as for `CompiledModel.simulate`.  Raises RunFailed if it fails."""
        found = model.simulate(stop, progress=self.clock(stop), **given)
        if found.interrupted:
            raise KeyboardInterrupt
        if found.status == "failed":
            raise RunFailed(found.message)
        return found

    def long(self, full: float, python: float, what: str) -> tuple[float, float]:
        """The length of a long run, and the factor from it to the full length."""
        length = full * self.part if self.backend == "c" else python
        if length < full:
            self.notes.append(f"{length:,.0f} of {full:,.0f} {what}; values that grow are scaled to all")
        return length, full / length


def how(run: Any) -> str:
    """The method of a run in words."""
    if run.step:
        return f"{run.method}, step {run.step:g} s"
    asked = "" if run.asked is None else f", accuracy {run.asked:.0e} asked"
    return f"{run.method}, rtol {run.rtol:.0e}{asked}"


@dataclass
class Row:
    """One case in one backend: `found` is None if the run failed, as `failure` tells."""

    case: Case
    backend: str
    found: Found | None
    seconds: float  # of CPU time, without compiling
    failure: str = ""
    notes: tuple[str, ...] = ()

    @property
    def meets_figures(self) -> bool:
        """Whether all figures are kept."""
        return self.found is not None and all(
            value is None or value <= figure.most
            for value, figure in zip(self.found.values, self.case.figures, strict=True)
        )


@dataclass
class Hard:
    """The rows so far; `complete` is False where the user ended the study early."""

    rows: list[Row] = field(default_factory=list)
    backends: tuple[str, ...] = BACKENDS
    complete: bool = False

    @property
    def meets_figures(self) -> bool:
        return all(row.meets_figures for row in self.rows)


def measured(case: Case, lab: Lab) -> Row:
    """Measure one case in one backend."""
    began = process_time()
    found, failure = None, ""
    try:
        found = case.measure(lab)
        found = replace(found, values=tuple([None if v is None else float(v) for v in found.values]))
    except RunFailed as error:
        failure = str(error)
    except Refused as error:
        failure = error.faults[0].message
    seconds = process_time() - began - lab.seconds
    return Row(case, lab.backend, found, seconds, failure, tuple(lab.notes))


def study(
    cases: Sequence[Case], load: Load, backends: Sequence[str], progress: Tell, part: float = 1.0
) -> Hard:
    """Measure the cases one after the other.  `progress` may raise KeyboardInterrupt, which ends the study
    with the rows so far."""
    found, total = Hard(backends=tuple(backends)), max(len(cases) * len(backends), 1)
    try:
        for case in cases:
            for backend in backends:
                done, doing = len(found.rows), f"{case.name} ({backend})"

                # Defaults bind the values of this turn of the loop.
                def tell(inner: float, words: str, done: int = done, doing: str = doing) -> None:
                    progress((done + min(max(inner, 0.0), 1.0)) / total, f"{doing} {words}")

                tell(0.0, "")
                found.rows.append(measured(case, Lab(load, backend, part, tell)))
        found.complete = True
    except KeyboardInterrupt:
        pass
    return found


# -- published values ------------------------------------------------------------------------------

LONG = {"n_four_bar_40"}  # Python measures the first sample


@cache
def read(name: str) -> dict[str, Any]:
    """The file `name` of the references; see `tests/physics/references.py` for its fields."""
    with open(os.path.join(references_folder(), f"{name}.json"), encoding="utf-8") as file:
        found: dict[str, Any] = json.load(file)
    return found


def values(name: str, lab: Lab) -> Found:
    """Measure the largest error of the values of a reference, over the largest size of each."""
    reference = read(name)
    samples, accuracy = reference["samples"], reference["accuracy"]
    shown = samples[0] if lab.backend != "c" and name in LONG else samples[-1]
    model = lab.compile(reference["model"], reference.get("scene"),
                        parameters=reference.get("parameters", {}))  # fmt: skip
    starts, tolerance = reference.get("starts", {}), reference.get("tolerance")
    if tolerance is None:  # a decade finer: the error estimate is good to a factor of about 2
        run = lab.run(model, shown["t"], accuracy=accuracy / 10, points=101, starts=starts)
    else:
        run = lab.run(model, shown["t"], method="dop853", rtol=tolerance, atol=tolerance, points=101,
                      starts=starts)  # fmt: skip
    worst = 0.0
    for quantity, value in shown["values"].items():
        scale = max(abs(s["values"].get(quantity, 0.0)) for s in samples)
        worst = max(worst, abs(run.final[quantity] - value) / scale)
    return Found((worst,), how(run), run=run)


def line(reference: dict[str, Any]) -> str:
    """Return the command that computes the values of a reference."""
    words = ["lagc sim", reference["model"]]
    if reference.get("scene"):
        words.append(f"--scene {reference['scene']}")
    words += [f"-p {name}={value!r}" for name, value in reference.get("parameters", {}).items()]
    words += [f"--start '{name}={value!r}'" for name, value in reference.get("starts", {}).items()]
    tolerance = reference.get("tolerance")
    words.append(f"--stop {reference['samples'][-1]['t']:g}")
    asked = f"--accuracy {reference['accuracy'] / 10:.0e}"
    words.append(f"--method dop853 --rtol {tolerance:g} --atol {tolerance:g}" if tolerance else asked)
    return " ".join(words)
