"""Problems with published or closed values: the files of references."""

from __future__ import annotations

import json
import os
from functools import cache
from typing import Any

from lagc.host.model_library import references_folder
from lagc.study.hard.case import Found, Lab, how

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
