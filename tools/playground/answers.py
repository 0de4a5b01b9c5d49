"""The Python side of the playground: requests and answers are JSON.

    {"do": "check" | "whole" | "fixes" | "complete" | "hover" | "run", "text": ...}

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
from lagc.base.records import replace
from lagc.compiler.checking import look
from lagc.compiler.stages import Choice
from lagc.diagnostics.faults import Fault, Refused, Source, as_json
from lagc.editor.document import Document
from lagc.editor.fixes import fix
from lagc.host.budgets import Limits
from lagc.reports.animation.page import page, page_data
from lagc.reports.animation.shown import show
from lagc.reports.equations.latex import equation_rows
from lagc.semantics.model import Model

sys.setrecursionlimit(3000)  # of the stack that a browser gives
NAME = "model.lag"
POINTS = 301
LONGEST = 60.0  # s, of a run
PATIENCE = 2.0  # s, for names and dimensions
SLOW = "write an earlier `stop`, or install lagc: it compiles to C"
LONG_LATEX = 20_000  # characters
MOST_SLIDERS, MOST_FIXES, MOST_OFFERS = 24, 3, 200

Answer = dict[str, Any]


def answer(request: str) -> str:
    asked = json.loads(request)
    try:
        found = _ANSWERS[asked["do"]](asked)
    except Refused as refused:
        found = {
            "faults": _faults([replace(f, remedy=SLOW) if f.code == "LAG0801" else f for f in refused.faults])
        }
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


@lru_cache(1)
def _document(text: str) -> Document:
    return Document(NAME, text, quick=PATIENCE)


def check(asked: Answer) -> Answer:
    """Return the faults of syntax, or else of names and dimensions."""
    return {"faults": _faults(_document(asked["text"]).faults)}


def whole(asked: Answer) -> Answer:
    """Return the faults of all models and scenes of the text, also those of equations and initial values."""
    with Limits(time=LONGEST):
        return {"faults": _faults(look(Source(NAME, asked["text"]), Choice()).faults)}


def fixes(asked: Answer) -> Answer:
    """Return for the first faults that `check` names a tried fix, or null."""
    document = _document(asked["text"])
    tried = [fix(document, fault) for fault in document.faults[:MOST_FIXES]]
    return {
        "fixes": [
            f and {"title": f.title, "edits": [[e.start, e.end, e.text] for e in f.edits]} for f in tried
        ]
    }


def complete(asked: Answer) -> Answer:
    """Return what may be written at an offset."""
    offers = _document(asked["text"]).completions(asked["offset"])[:MOST_OFFERS]
    return {"offers": [{"label": o.label, "kind": o.kind, "detail": o.detail} for o in offers]}


def hover(asked: Answer) -> Answer:
    """Return what is known of the name or the expression at an offset."""
    found = _document(asked["text"]).hover(asked["offset"])
    return {"hover": found and {"text": found.text, "from": found.start, "to": found.end}}


@lru_cache(2)
def _compiled(text: str, scene: str | None) -> lagc.CompiledModel:
    return lagc.loads(text, NAME).compile(scene, backend="numpy")


@lru_cache(2)
def _about(text: str, scene: str | None) -> Answer:
    """Return what does not depend on the values of parameters."""
    compiled = _compiled(text, scene)
    model, rows = compiled.model, equation_rows(compiled.equations)
    counts = ((len(compiled.equations.v), "equation of motion", "equations of motion"),
              (compiled.operations, "operation", "operations"))  # fmt: skip
    return {
        "model": model.name, "scenes": [*model.scenes], "scene": compiled.interface.scene,
        "about": model.description, "sliders": _sliders(model, compiled.artifact.built_in),
        "latex": rows if sum(map(len, rows)) < LONG_LATEX else [r"\text{too long to show here}"],
        "count": ", ".join([f"{n} {one if n == 1 else many}" for n, one, many in counts]),
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
        try:
            compiled = _compiled(text, scene)
        except Refused:
            scene = None  # where the scene is gone, the first one
            compiled = _compiled(text, scene)
        made = compiled.simulate(points=POINTS, parameters=asked.get("parameters") or None)
        shown = page(page_data(show(made._source("")))).html if made.times else ""
    return {
        **_about(text, scene), "page": shown, "status": made.status, "message": made.message,
        "accuracy": made.estimated, "steps": made.cost.steps, "end": made.times[-1] if made.times else 0.0,
        "run_s": made.cost.run_s, "all_s": perf_counter() - began,
    }  # fmt: skip


_ANSWERS = {f.__name__: f for f in (check, whole, fixes, complete, hover, run)}
