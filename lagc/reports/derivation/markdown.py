"""A solution in Markdown, with formulas as LaTeX between dollar signs."""

from __future__ import annotations

import re
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


def to_markdown(blocks: Sequence[Block]) -> str:
    """Return the blocks in Markdown. Sections have numbers."""
    found, number = list[str](), 0
    for block in blocks:
        if isinstance(block, Heading):
            number += block.level == 2
            mark = f"{'#' * block.level} " + (f"{number}. " if block.level == 2 else "")
            found.append(mark + _text(block.text))
        elif isinstance(block, Paragraph):
            found.append(_text(block.text))
        elif isinstance(block, FormulaBlock):
            rows = " \\\\\n".join(aligned_rows(block))
            found.append(f"$$\n\\begin{{aligned}}\n{rows}\n\\end{{aligned}}\n$$")
        elif isinstance(block, ItemList):
            found.append("\n".join([f"- {_text(item)}" for item in block.items]))
        elif isinstance(block, Table):
            found.append(_table(block))
        elif isinstance(block, Picture):
            found.append(f"![]({block.name}.svg)")
    return "\n\n".join(found) + "\n"


def _table(table: Table) -> str:
    lines = ["| " + " | ".join([_text(cell, in_table=True) for cell in row]) + " |" for row in table.rows]
    return "\n".join([lines[0], "|" + " --- |" * len(table.rows[0]), *lines[1:]])


def _text(text: Text, in_table: bool = False) -> str:
    found = []
    for span in text:
        if span.kind == "math":  # a bar would end the cell
            found.append(f"${span.text.replace('|', chr(92) + 'vert ') if in_table else span.text}$")
        else:
            words = re.sub(r"([\\`*_{}\[\]<>#|$])", r"\\\1", span.text)
            found.append(f"**{words}**" if span.kind == "bold" else words)
    return "".join(found)
