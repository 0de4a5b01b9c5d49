"""A solution in HTML: a page of its own, or a part of a notebook. Sections fold; formulas are MathML."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

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
from lagc.reports.derivation.mathml import cells, to_mathml

_STYLE = """
body { font: 17px/1.5 Georgia, serif; max-width: 46em; margin: 1.5em auto; padding: 0 1em; color: #1b1b1b }
h1 { font-size: 1.6em } summary { font-size: 1.25em; font-weight: bold; margin: 1.1em 0 .4em; cursor: pointer }
h3 { margin: 1.2em 0 .2em } table { border-collapse: collapse; margin: .6em 0 }
td, th { padding: .2em .8em; border-bottom: 1px solid #ccc; text-align: left }
.formula { overflow-x: auto; padding: .25em 0 } svg { max-width: 100%; height: auto }
@media print { summary { list-style: none } }
"""
_ALIGN = ("right", "left")


def to_page(blocks: Sequence[Block], language: str) -> str:
    """Return a complete page that loads nothing."""
    title = next((b.text for b in blocks if isinstance(b, Heading)), ())
    words = escape("".join([span.text for span in title]))
    viewport = '<meta name="viewport" content="width=device-width, initial-scale=1">'
    head = f'<meta charset="utf-8">{viewport}<title>{words}</title><style>{_STYLE}</style>'
    return f'<!DOCTYPE html>\n<html lang="{language}"><head>{head}</head><body>\n{_body(blocks, "open")}\n</body></html>\n'


def to_fragment(blocks: Sequence[Block]) -> str:
    """Return the solution for a notebook, its sections folded."""
    return _body(blocks, "")


def _body(blocks: Sequence[Block], state: str) -> str:
    found, number = list[str](), 0
    for block in blocks:
        if isinstance(block, Heading) and block.level == 2:
            found += ["</details>"] * (number > 0)
            number += 1
            found.append(f"<details {state}><summary>{number}. {_text(block.text)}</summary>")
        else:
            found.append(_block(block))
    return "\n".join([*found, *["</details>"] * (number > 0)])


def _block(block: Block) -> str:
    if isinstance(block, Heading):
        return f"<h{block.level}>{_text(block.text)}</h{block.level}>"
    if isinstance(block, Paragraph):
        return f"<p>{_text(block.text)}</p>"
    if isinstance(block, FormulaBlock):
        return _formula(block)
    if isinstance(block, ItemList):
        return "<ul>" + "".join([f"<li>{_text(item)}</li>" for item in block.items]) + "</ul>"
    if isinstance(block, Picture):
        return f"<div>{block.svg.decode()}</div>"
    return _table(block)


def _formula(block: FormulaBlock) -> str:
    """Return rows that are aligned at their equals signs; what is wider than the page scrolls."""
    rows = []
    for latex in aligned_rows(block):
        found = cells(latex)
        inner = [
            f'<mtd style="text-align:{side};padding:.15em .1em">{cell}</mtd>'
            for side, cell in zip(_ALIGN, found)
        ]
        rows.append(f"<mtr>{''.join(inner)}</mtr>")
    table = f"<mtable displaystyle=true>{''.join(rows)}</mtable>"
    return f'<div class="formula" style="overflow-x:auto"><math display="block">{table}</math></div>'


def _table(table: Table) -> str:
    tags = ["th", *["td"] * (len(table.rows) - 1)]
    rows = ["<tr>" + "".join([f"<{tag}>{_text(cell)}</{tag}>" for cell in row]) + "</tr>"
            for tag, row in zip(tags, table.rows)]  # fmt: skip
    return f"<table>{''.join(rows)}</table>"


def _text(text: Text) -> str:
    found = []
    for span in text:
        if span.kind == "math":
            found.append(to_mathml(span.text))
        else:
            words = escape(span.text)
            found.append(f"<b>{words}</b>" if span.kind == "bold" else words)
    return "".join(found)
