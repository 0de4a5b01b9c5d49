"""A solution in Markdown, in LaTeX, and in PDF by a LaTeX of this machine."""

import os
import re
import shutil
import subprocess
import unicodedata
from collections.abc import Mapping, Sequence

from lagc.reports.derivation.document import Block, Formulas, Heading, Items, Picture, Table, spelt
from lagc.reports.equations.latex import GREEK, VERBATIM

_HEAD = r"""\documentclass[11pt,a4paper]{article}
\usepackage[T1]{fontenc}
\usepackage[utf8]{inputenc}
\usepackage{amsmath}
\usepackage{graphicx}
\usepackage[margin=22mm]{geometry}
\setlength{\parindent}{0pt}
\setlength{\parskip}{4pt}
\allowdisplaybreaks
"""
_LEVELS = {1: "section*", 2: "section", 3: "subsection*"}
PROGRAMS = ("pdflatex", "lualatex", "xelatex", "tectonic")
SECONDS = 120.0  # of one pass of LaTeX


def to_markdown(blocks: Sequence[Block]) -> str:
    """Return the blocks in Markdown, with formulas between dollar signs. Sections have numbers."""
    found, number = list[str](), 0
    for block in blocks:
        if isinstance(block, Heading):
            number += block.level == 2
            index = f"{number}. " if block.level == 2 else ""
            found.append(f"{'#' * block.level} {index}{_markdown(block.text)}")
        elif isinstance(block, Formulas):
            rows = " \\\\\n".join(block.latex)
            found.append(f"$$\n\\begin{{aligned}}\n{rows}\n\\end{{aligned}}\n$$")
        elif isinstance(block, Items):
            found.append("\n".join([f"- {_markdown(item)}" for item in block.items]))
        elif isinstance(block, Table):
            rule = "|" + " --- |" * len(block.rows[0])
            lines = ["| " + " | ".join([_markdown(x, r"\vert ") for x in row]) + " |" for row in block.rows]
            found.append("\n".join([lines[0], rule, *lines[1:]]))
        else:
            found.append(f"![]({block.name}.svg)" if isinstance(block, Picture) else _markdown(block))
    return "\n\n".join(found) + "\n"


def _markdown(text: str, bar: str = "|") -> str:
    """Return a text in Markdown; a `bar` in a formula would end the cell of a table."""
    escaped = r"([\\`*_{}\[\]<>#|$])"
    return spelt(text, lambda x: re.sub(escaped, r"\\\1", x), lambda x: f"${x.replace('|', bar)}$", "**{}**")


def to_latex(blocks: Sequence[Block]) -> str:
    """Return a document for pdflatex, or any other LaTeX, with amsmath."""
    body = "\n\n".join(map(_latex_block, blocks))
    return f"{_HEAD}\\begin{{document}}\n\n{body}\n\n\\end{{document}}\n"


def _latex_block(block: Block) -> str:
    if isinstance(block, Heading):
        return rf"\{_LEVELS[block.level]}{{{_latex(block.text)}}}"
    if isinstance(block, Formulas):
        lines = " \\\\\n".join(block.latex)
        return f"\\begin{{align*}}\n{lines}\n\\end{{align*}}"
    if isinstance(block, Items):
        items = "\n".join([rf"\item {_latex(item)}" for item in block.items])
        return f"\\begin{{itemize}}\n{items}\n\\end{{itemize}}"
    if isinstance(block, Table):
        columns = len(block.rows[0])
        shape = "l" + ("l" if columns > 3 else r"p{0.55\linewidth}") + "l" * (columns - 2)
        head, *rows = [" & ".join(map(_latex, row)) + r" \\" for row in block.rows]
        lines = "\n".join([head, r"\hline", *rows])
        return f"\\begin{{center}}\n\\begin{{tabular}}{{{shape}}}\n{lines}\n\\end{{tabular}}\n\\end{{center}}"
    if isinstance(block, Picture):
        return rf"\includegraphics[width=\linewidth]{{{block.name}.pdf}}"
    return _latex(block)


def _latex(text: str) -> str:
    return spelt(text, lambda x: "".join(map(_character, x)), lambda x: f"${x}$", r"\textbf{{{}}}")


def _character(character: str) -> str:
    """Return a character as LaTeX writes it: those of Latin 1 as they are, Greek letters as formulas, others
    by their names."""
    if character < "\u0100":
        return character.translate(VERBATIM)
    name = unicodedata.name(character, "")
    letter = name.rpartition(" ")[2].lower() if name.startswith("GREEK SMALL LETTER") else ""
    return f"$\\{letter}$" if letter in GREEK else f"({name.lower()})"


class NoLatex(Exception):
    """No LaTeX is installed, or it failed; the message says what to do."""


def to_pdf(latex: str, pictures: Mapping[str, bytes]) -> bytes:
    """Return a document in PDF; `pictures` are files that it refers to. Raises NoLatex."""
    from lagc.host.atomic_write import scratch

    program = next((name for name in PROGRAMS if shutil.which(name)), None)
    if program is None:
        known = ", ".join(PROGRAMS)
        raise NoLatex(f"a PDF needs a LaTeX: none of {known} is installed; write .tex or .html instead")
    # The program may not run others, nor ask; its first error is the reason that is given.
    options = [] if program == "tectonic" else ["-interaction=nonstopmode", "-no-shell-escape"]
    said = ["! no PDF was made"]
    with scratch() as folder:
        for name, data in {"solution.tex": latex.encode(), **pictures}.items():
            with open(os.path.join(folder, name), "wb") as file:
                file.write(data)
        try:
            done = subprocess.run([program, *options, "solution.tex"], cwd=folder, capture_output=True,
                                  stdin=subprocess.DEVNULL, timeout=SECONDS)  # fmt: skip
            said = [
                line for line in done.stdout.decode(errors="replace").splitlines() if line[:1] == "!"
            ] + said
            with open(os.path.join(folder, "solution.pdf"), "rb") as file:
                return file.read()
        except (OSError, subprocess.TimeoutExpired):
            raise NoLatex(f"{program} failed: {said[0][2:]}; write .tex or .html instead") from None
