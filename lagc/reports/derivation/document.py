"""The parts of a written solution, without the marks of a format.

A text is a sequence of spans: plain words, names in bold face, formulas in LaTeX. A block is a heading, a
paragraph, rows of formulas, a list or a table. `markdown`, `latex_document` and `html` write blocks.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

from lagc.base.records import dataclass


@dataclass(frozen=True, slots=True)
class Span:
    """Words of one kind: "plain", "bold", or "math" for a formula in LaTeX."""

    kind: str
    text: str


Text: TypeAlias = tuple[Span, ...]


@dataclass(frozen=True, slots=True)
class Heading:
    """The title is of level 1, a section of level 2, an equation within it of level 3."""

    level: int
    text: Text


@dataclass(frozen=True, slots=True)
class Paragraph:
    text: Text


@dataclass(frozen=True, slots=True)
class FormulaRow:
    """`left` = the sum of the `lines`, with a `note` behind the last, all in LaTeX. Without a `left` the row
    has no equals sign; "=" continues the row before."""

    left: str
    lines: tuple[str, ...]
    note: str = ""


@dataclass(frozen=True, slots=True)
class FormulaBlock:
    """Rows that are aligned at their equals signs."""

    rows: tuple[FormulaRow, ...]


@dataclass(frozen=True, slots=True)
class ItemList:
    items: tuple[Text, ...]


@dataclass(frozen=True, slots=True)
class Table:
    """The first row is the head."""

    rows: tuple[tuple[Text, ...], ...]


@dataclass(frozen=True, slots=True)
class Picture:
    """An image, in SVG and for LaTeX in PDF; files that hold it are called `name`."""

    name: str
    svg: bytes
    pdf: bytes


Block: TypeAlias = Heading | Paragraph | FormulaBlock | ItemList | Table | Picture


def plain(text: str) -> Text:
    return (Span("plain", text),)


def bold(text: str) -> Text:
    return (Span("bold", text),)


def math(latex: str) -> Text:
    return (Span("math", latex),)


def joined(texts: Sequence[Text], separator: str) -> Text:
    """Return `texts` with a plain `separator` between them."""
    spans: list[Span] = []
    for k, text in enumerate(texts):
        spans += [*(plain(separator) if k else ()), *text]
    return tuple(spans)


def aligned_rows(block: FormulaBlock) -> list[str]:
    """Return the lines of a block between `\\begin{aligned}` and `\\end{aligned}`, with `&` at the equals
    signs."""
    found: list[str] = []
    for row in block.rows:
        first, *others = row.lines
        head = {"": "& ", "=": "&= "}.get(row.left, f"{row.left} &= ")
        lines = [head + first, *[rf"&\quad {line}" for line in others]]
        lines[-1] += row.note
        found += lines
    return found
