"""Problems with published or closed values: the files of references."""

from __future__ import annotations

import json
import os
from functools import cache, partial
from typing import Any

from lagc.host.model_library import references_folder
from lagc.study.hard.case import Case, Figure, Found, Lab, how

HARD = {
    "arenstorf_orbit": "Close passages of the moon; the orbit amplifies errors a millionfold.",
    "babyboot": "A chaotic range: the twist feels each swing.",
    "bead_on_hoop": "A constraint that moves with time, and its forces.",
    "car_axis": "Index 3, stiff springs, a ground that moves.",
    "chaplygin_sleigh": "A constraint that cannot be integrated, and a motion that grows straight.",
    "euler_top": "Orientation in space, without a singularity of angles.",
    "foucault_pendulum": "A slow precession under a fast swing.",
    "four_bar": "Accelerations of a closed loop.",
    "heavy_top": "Nutation and precession of a fast top.",
    "heavy_top_bruels": "A fast top with orientation and a constraint in space.",
    "henon_heiles": "A potential with ordered and chaotic orbits.",
    "kepler_e06": "An orbit with fast and slow parts.",
    "kepler_e09": "An orbit with very fast and slow parts.",
    "kepler_e099": "Speeds at the ends of the orbit that differ 199 times.",
    "moving_rail": "A constraint that moves with time.",
    "msl_double_pendulum": "A chaotic range, with a damper in a joint.",
    "msl_pendulum": "A damper in a joint.",
    "msl_point_gravity_body2": "A close passage of the centre.",
    "n_four_bar_1": "The rank drops in the flat configuration, twice in a turn.",
    "n_four_bar_2": "The rank drops by two in the flat configuration.",
    "n_four_bar_40": "The rank drops by 40 in the flat configuration, with 81 coordinates.",
    "pleiades": "Seven stars with near collisions.",
    "racket_flip": "A turn about the middle axis, which is unstable.",
    "simple_pendulum": "The first problem of the IFToMM benchmark, in Cartesian coordinates.",
    "sphere_on_turntable": "Rolling on a ground that turns.",
    "spherical_pendulum": "A string in space that passes near the vertical.",
    "wedge_and_block": "Two bodies that slide on each other.",
}  # what is hard, by file
GROUP = f"{len(HARD)} problems with published or closed values"
LONG = {"n_four_bar_40"}  # Python measures the first sample


@cache
def read(name: str) -> dict[str, Any]:
    """The file `name` of the references; see `tests/physics/references.py` for its fields."""
    with open(os.path.join(references_folder(), f"{name}.json"), encoding="utf-8") as file:
        found: dict[str, Any] = json.load(file)
    return found


def _measure(name: str, lab: Lab) -> Found:
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


def _line(reference: dict[str, Any]) -> str:
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


def _case(name: str) -> Case:
    reference = read(name)
    return Case(
        name, f"{name.replace('_', ' ')}, values of the literature", HARD[name], reference["citation"],
        "A global error is asked a decade below the figure, or a local one far below it; the source states "
        f"its values so: {reference['stated_accuracy']}.",
        reference["model"], _line(reference),
        (Figure("values, relative", reference["accuracy"]),),
        partial(_measure, name), GROUP,
    )  # fmt: skip


CASES = tuple([_case(name) for name in HARD])
