"""A solution as a LaTeX document."""

from __future__ import annotations

import unicodedata
from collections.abc import Sequence

from lagc.reports.derivation.document import (
    Block,
    FormulaBlock,
    Heading,
    ItemList,
    Paragraph,
    Picture,
    Table,
    Text,
    aligned_rows,
)
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
LEVELS = {1: "section*", 2: "section", 3: "subsection*"}


def to_latex(blocks: Sequence[Block], language: str) -> str:
    """Return a document for pdflatex, or any other LaTeX, with amsmath."""
    body = "\n\n".join([_block(block) for block in blocks])
    return f"% language: {language}\n{_HEAD}\\begin{{document}}\n\n{body}\n\n\\end{{document}}\n"


def _block(block: Block) -> str:
    if isinstance(block, Heading):
        return rf"\{LEVELS[block.level]}{{{_text(block.text)}}}"
    if isinstance(block, Paragraph):
        return _text(block.text)
    if isinstance(block, FormulaBlock):
        rows = " \\\\\n".join(aligned_rows(block))
        return f"\\begin{{align*}}\n{rows}\n\\end{{align*}}"
    if isinstance(block, ItemList):
        items = "\n".join([rf"\item {_text(item)}" for item in block.items])
        return f"\\begin{{itemize}}\n{items}\n\\end{{itemize}}"
    if isinstance(block, Picture):
        return rf"\includegraphics[width=\linewidth]{{{block.name}.pdf}}"
    return _table(block)


def _table(table: Table) -> str:
    columns = len(table.rows[0])
    shape = "l" * columns if columns > 3 else "l" + r"p{0.55\linewidth}" + "l" * (columns - 2)
    head, *rows = [" & ".join([_text(cell) for cell in row]) + r" \\" for row in table.rows]
    lines = "\n".join([head, r"\hline", *rows])
    return f"\\begin{{center}}\n\\begin{{tabular}}{{{shape}}}\n{lines}\n\\end{{tabular}}\n\\end{{center}}"


def _text(text: Text) -> str:
    found = []
    for span in text:
        if span.kind == "math":
            found.append(f"${span.text}$")
        else:
            words = "".join(map(_character, span.text))
            found.append(rf"\textbf{{{words}}}" if span.kind == "bold" else words)
    return "".join(found)


def _character(character: str) -> str:
    """Return a character as LaTeX writes it: those of Latin 1 as they are, Greek letters as formulas, others
    by their names."""
    if character < "\u0100":
        return character.translate(VERBATIM)
    name = unicodedata.name(character, "")
    letter = name.rpartition(" ")[2].lower() if name.startswith("GREEK SMALL LETTER") else ""
    return f"$\\{letter}$" if letter in GREEK else f"({name.lower()})"
