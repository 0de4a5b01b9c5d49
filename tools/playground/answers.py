"""The Python side of the playground: requests and answers are JSON.

    {"do": "check" | "whole" | "run" | "complete" | "hover", "text": ...}

Runs are `lagc sim` of the backend `numpy`, printed Python, whose bits are those of a native run.
"""

from __future__ import annotations

import json
import math
import sys
from functools import lru_cache
from time import perf_counter
from typing import Any

import lagc
from lagc.compiler.checking import look
from lagc.compiler.stages import Choice
from lagc.diagnostics.faults import Fault, Refused, Source, as_json
from lagc.host.budgets import Limits
from lagc.reports.animation.page import page, page_data
from lagc.reports.animation.shown import show
from lagc.reports.equations.latex import equations_latex
from lagc.semantics.model import Model

sys.setrecursionlimit(3000)  # of the stack that a browser gives
NAME = "model.lag"
POINTS = 301
LONGEST = 60.0  # s, of a run
LONG_LATEX = 20_000  # characters
MOST_SLIDERS = 24

Answer = dict[str, Any]


def answer(request: str) -> str:
    asked = json.loads(request)
    try:
        found = _ANSWERS[asked["do"]](asked)
    except Refused as refused:
        found = {"faults": _faults(refused.faults)}
    except RecursionError:
        found = {"faults": _faults([Fault("LAG0802", "the model needs more memory than a browser gives")])}
    return json.dumps(found, allow_nan=False)


def _faults(faults: list[Fault]) -> list[Answer]:
    """Return faults as `--format json` has them, with the offsets of their places."""
    rows = as_json(faults)
    for row, fault in zip(rows, faults):
        if fault.span is not None and fault.span.source.name == NAME:
            row["from"], row["to"] = fault.span.start, fault.span.end
    return rows


def check(asked: Answer) -> Answer:
    """Return the faults of the whole text: of all its models and scenes."""
    with Limits(time=LONGEST):
        return {"faults": _faults(look(Source(NAME, asked["text"]), Choice()).faults)}


@lru_cache(2)
def _compiled(text: str, scene: str | None) -> lagc.CompiledModel:
    return lagc.loads(text, NAME).compile(scene, backend="numpy")


@lru_cache(2)
def _about(text: str, scene: str | None) -> Answer:
    """Return what does not depend on the values of parameters."""
    compiled = _compiled(text, scene)
    model, latex = compiled.model, equations_latex(compiled.equations)
    count = len(compiled.equations.v)
    return {
        "model": model.name, "scenes": [*model.scenes], "scene": compiled.interface.scene,
        "about": model.description, "sliders": _sliders(model, compiled.artifact.built_in),
        "latex": latex.strip().removeprefix("$$").removesuffix("$$") if len(latex) < LONG_LATEX else "",
        "count": f"{count} equation{'s' * (count != 1)} of motion, {compiled.operations} operations",
    }  # fmt: skip


def _sliders(model: Model, built_in: tuple[str, ...]) -> list[Answer]:
    """Return the parameters that a run may change, each with a range about its value within its bounds."""
    found = []
    for p in model.parameters:
        if p.value is None or p.whole or p.name in built_in or not math.isfinite(p.value):
            continue
        low, high = sorted((0.0, 2.0 * p.value)) if p.value else (-1.0, 1.0)
        bounds = (p.minimum, p.maximum)
        low, high = (x if math.isfinite(x) and abs(x) <= 10.0 * abs(p.value or 1.0) else y
                     for x, y in zip(bounds, (max(low, p.minimum), min(high, p.maximum))))  # fmt: skip
        if low < high:
            found.append({"name": p.name, "unit": p.unit, "value": p.value, "low": low, "high": high,
                          "about": p.description})  # fmt: skip
    return found[:MOST_SLIDERS]


def run(asked: Answer) -> Answer:
    """Return the motion of a scene as the data of its animation, with equations and parameters."""
    began, text, scene = perf_counter(), asked["text"], asked.get("scene") or None
    with Limits(time=LONGEST):
        compiled = _compiled(text, scene)
        made = compiled.simulate(points=POINTS, parameters=asked.get("parameters") or None)
        shown = page(page_data(show(made._source("")))).html if made.times else ""
    return {
        **_about(text, scene), "page": shown, "status": made.status, "message": made.message,
        "accuracy": made.estimated, "steps": made.cost.steps, "end": made.times[-1] if made.times else 0.0,
        "run_s": made.cost.run_s, "all_s": perf_counter() - began,
        "states": [*made.states[-1]] if made.states and asked.get("states") else None,
    }  # fmt: skip


_ANSWERS = {"check": check, "whole": check, "run": run}
