"""Write `docs/gallery.md`: a picture, the description and the equations of each model of the library.

    python tools/gallery.py [FOLDER]

All models of a folder of the library share one picture, in colours of a palette, so that the pages stay
small. A model without bodies has a plot of its coordinates instead.  Prints each model with its time.
"""

from __future__ import annotations

import io
import math
import sys
from collections.abc import Sequence
from pathlib import Path
from time import perf_counter
from typing import Any

import lagc
from lagc.base.text import one_line
from lagc.host.model_library import library_models
from lagc.reports.animation.film import Camera, Drawing, set_limits
from lagc.reports.animation.frames import Frames
from lagc.reports.equations.write import write

ROOT = Path(__file__).resolve().parent.parent
COLUMNS, SIDE, DPI = 7, 1.6, 75  # pictures beside each other, inches, dots for each inch
COLORS = 32  # of a picture
MOST_UNKNOWNS, MOST_LINES, WIDEST = 9, 16, 160  # of equations: larger ones are left out
MOMENT = 0.6  # of the run: the frame that is drawn
LONGEST = 20.0  # s, of a run, unless all of it takes more than a thousand
HEAD = """# Gallery

The models of the library, `lagc sim NAME --animate` shows each of them move. The pictures are inferred from
the equations; some models add a line `draw`. This page is written by `python tools/gallery.py`.
"""


def run_of(name: str) -> tuple[lagc.CompiledModel, lagc.Run]:
    system = lagc.load(name).compile()
    stop = system.interface.simulate.get("stop", 10.0)
    return system, system.simulate(
        stop if stop > 1e3 else min(stop, LONGEST), points=401, method="dop853", rtol=1e-6
    )


def draw(axes: Any, run: lagc.Run) -> None:
    """Draw a run at one moment, or its coordinates over time if there are no bodies."""
    scene = run.scene()
    axes.set_axis_off()
    if not scene.bodies:
        for name in run.system.interface.q_names:
            axes.plot(run.t, run[name], lw=0.8)
        return
    frames, camera = Frames(scene, run), Camera(scene)
    set_limits(axes, [frames], camera)
    Drawing(axes, scene, frames, int(MOMENT * (len(frames.t) - 1)), camera).draw()


def equations_text(system: lagc.CompiledModel) -> str:
    """Return the equations of a model; "" if they are long."""
    if len(system.equations.v) + len(system.equations.rows) > MOST_UNKNOWNS:
        return ""
    text = write(system.equations, "text", False)
    lines = text.splitlines()
    return text if len(lines) <= MOST_LINES and max(map(len, lines)) <= WIDEST else ""


def sheet(path: Path, names: Sequence[str]) -> list[str]:
    """Draw the models of a folder into one picture, and return their paragraphs."""
    from matplotlib.figure import Figure
    from PIL import Image

    columns = min(COLUMNS, len(names))
    rows = math.ceil(len(names) / columns)
    figure = Figure(figsize=(SIDE * columns, SIDE * rows), dpi=DPI)
    paragraphs: list[str] = []
    for k, name in enumerate(names):
        began = perf_counter()
        axes = figure.add_subplot(rows, columns, k + 1)
        axes.set_title(name.rpartition("/")[2], fontsize=5.5, pad=2)
        system, run = run_of(name)
        draw(axes, run)
        about, equations = one_line(system.model.description), equations_text(system)
        block = f"\n\n```\n{equations}\n```" if equations else ""
        paragraphs.append(f"**[{name}](../models/{name}.lag)** {about}{block}")
        print(f"{name}: {perf_counter() - began:.1f} s", flush=True)
    figure.subplots_adjust(0.005, 0.005, 0.995, 0.97, 0.04, 0.14)
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png")
    with Image.open(buffer) as image:
        image.convert("RGB").quantize(COLORS).save(path, optimize=True)
    return paragraphs


def main(folder: Path) -> None:
    (folder / "gallery").mkdir(parents=True, exist_ok=True)
    by_folder: dict[str, list[str]] = {}
    for name in library_models():
        by_folder.setdefault(name.partition("/")[0], []).append(name)
    parts = [HEAD]
    for title, names in by_folder.items():
        paragraphs = sheet(folder / "gallery" / f"{title}.png", names)
        parts.append(
            f"## {title}\n\n![the models of {title}](gallery/{title}.png)\n\n"
            + "\n\n".join(paragraphs)
            + "\n"
        )
    (folder / "gallery.md").write_text("\n".join(parts), encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "docs")
