"""A page for each model of the library, with its picture, its equations and its text, and a page of all."""

from __future__ import annotations

import io
import shutil
import sys
from collections.abc import Sequence
from html import escape
from pathlib import Path
from time import perf_counter

import lagc
from lagc.base.text import one_line
from lagc.host.model_library import library_models, read
from lagc.reports.derivation.html import cells
from lagc.reports.equations.latex import equation_rows
from tools.gallery import COLORS, draw, run_of
from tools.site.tree import WIDE

SIZE, DPI = (4.4, 3.0), 110  # inches of a picture, dots for each
MOST_UNKNOWNS, LONGEST = 60, 12_000  # of equations that are shown; characters in LaTeX
HEAD = f"""{WIDE}# Gallery

Each model is in the library: `lagc sim NAME --animate` shows it move, and its page has a button that opens
it in the [playground](how-to/playground.md).

"""
FOLDERS = {
    "course": "A course", "classic": "Classics", "mechanisms": "Mechanisms", "contact": "Contact and impact",
    "effects": "Effects", "hard": "Hard cases", "large": "Large models",
}  # fmt: skip


def write(docs: Path, names: Sequence[str] = ()) -> None:
    """Write the gallery of the library, or of some models, into the pages `docs`."""
    found: dict[str, list[str]] = {folder: [] for folder in FOLDERS}
    shutil.rmtree(docs / "gallery")
    for name in names or library_models():
        began = perf_counter()
        found[name.partition("/")[0]].append(_card(name, _page(docs / "gallery", name)))
        print(f"{name}: {perf_counter() - began:.1f} s", file=sys.stderr, flush=True)
    parts = [f"## {FOLDERS[folder]}\n\n<div class=\"gallery\" markdown=\"0\">\n{''.join(cards)}</div>\n"
             for folder, cards in found.items() if cards]  # fmt: skip
    (docs / "gallery.md").write_text(HEAD + "\n".join(parts), encoding="utf-8")


def _card(name: str, about: str) -> str:
    title = name.rpartition("/")[2].replace("_", " ")
    width, height = (round(x * DPI) for x in SIZE)
    picture = f'<img src="gallery/{name}.png" alt="" loading="lazy" width="{width}" height="{height}">'
    return f'<a href="gallery/{name}.html">{picture}<b>{title}</b><span>{escape(about)}</span></a>\n'


def _page(folder: Path, name: str) -> str:
    """Write the page of a model and its picture, and return the description of the model."""
    system, run = run_of(name)
    text, title = read(name).text, name.rpartition("/")[2]
    page = folder / f"{name}.md"
    page.parent.mkdir(parents=True, exist_ok=True)
    page.with_suffix(".png").write_bytes(_picture(run))
    about = one_line(system.model.description)
    rows = _equations(system)
    many = f"{len(system.equations.v)} equations of motion: `lagc equations {title}` prints them.\n"
    page.write_text(
        f"{WIDE}# {title.replace('_', ' ').capitalize()}\n\n{about}\n{{: .about }}\n\n"
        f'<div class="model" markdown="1">\n![{title} in motion]({title}.png)\n\n'
        f'<div markdown="1">\n'
        f'<a class="md-button md-button--primary" href="../../playground/index.html#model={name}">'
        f"Open in the playground</a>\n\n"
        f"```sh\nlagc sim {title} --animate\nlagc derive {title} -o solution.html\n```\n"
        f"</div>\n</div>\n\n## Equations\n\n{rows or many}\n## Model\n\n```lag\n{text.rstrip()}\n```\n",
        encoding="utf-8",
    )
    return about


def _picture(run: lagc.Run) -> bytes:
    from matplotlib.figure import Figure
    from PIL import Image

    figure = Figure(figsize=SIZE, dpi=DPI)
    axes = figure.add_axes((0.02, 0.02, 0.96, 0.96))
    draw(axes, run)
    drawn, found = io.BytesIO(), io.BytesIO()
    figure.savefig(drawn, format="png")
    with Image.open(drawn) as image:
        image.convert("RGB").quantize(COLORS).save(found, "png", optimize=True)
    return found.getvalue()


def _equations(system: lagc.CompiledModel) -> str:
    """Return the equations in MathML, which needs no script; "" if they are long."""
    if len(system.equations.v) + len(system.equations.rows) > MOST_UNKNOWNS:
        return ""
    latex = equation_rows(system.equations)
    if sum(map(len, latex)) > LONGEST:
        return ""
    rows = [f'<math display="block"><mrow>{"".join(cells(row))}</mrow></math>' for row in latex]
    return f'<div class="equations">{"".join(rows)}</div>\n'
