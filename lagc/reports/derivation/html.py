"""A solution in HTML: a page of its own, or a part of a notebook. Sections fold; formulas are MathML."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

from lagc.reports.derivation.document import Block, Formulas, Heading, Items, Picture, Table, spelt
from lagc.reports.derivation.mathml import cells, to_mathml

_STYLE = """
body { font: 17px/1.5 Georgia, serif; max-width: 46em; margin: 1.5em auto; padding: 0 1em; color: #1b1b1b }
summary { font-size: 1.25em; font-weight: bold; margin: 1.1em 0 .4em; cursor: pointer }
h1 { font-size: 1.6em } h3 { margin: 1.2em 0 .2em } table { border-collapse: collapse; margin: .6em 0 }
td, th { padding: .2em .8em; border-bottom: 1px solid #ccc; text-align: left }
svg { max-width: 100%; height: auto }
"""
_SCROLL = '<div style="overflow-x:auto">{}</div>'  # what is wider than the page


def to_page(blocks: Sequence[Block], language: str) -> str:
    """Return a complete page that loads nothing."""
    title = next((spelt(b.text, escape, escape, "{}") for b in blocks if isinstance(b, Heading)), "")
    viewport = '<meta name="viewport" content="width=device-width, initial-scale=1">'
    head = f'<meta charset="utf-8">{viewport}<title>{title}</title><style>{_STYLE}</style>'
    body = to_fragment(blocks, "open")
    return f'<!DOCTYPE html>\n<html lang="{language}"><head>{head}</head><body>\n{body}\n</body></html>\n'


def to_fragment(blocks: Sequence[Block], state: str = "") -> str:
    """Return the solution for a notebook, its sections folded; with the `state` "open" they are not."""
    found, number = list[str](), 0
    for block in blocks:
        if isinstance(block, Heading) and block.level == 2:
            found += ["</details>"] * (number > 0)
            number += 1
            found.append(f"<details {state}><summary>{number}. {_html(block.text)}</summary>")
        else:
            found.append(_block(block))
    return "\n".join([*found, *["</details>"] * (number > 0)])


def _block(block: Block) -> str:
    if isinstance(block, Heading):
        return f"<h{block.level}>{_html(block.text)}</h{block.level}>"
    if isinstance(block, Formulas):
        rows = "".join(map(_row, block.latex))
        return _SCROLL.format(f'<math display="block"><mtable displaystyle="true">{rows}</mtable></math>')
    if isinstance(block, Items):
        return "<ul>" + "".join([f"<li>{_html(item)}</li>" for item in block.items]) + "</ul>"
    if isinstance(block, Picture):
        return _SCROLL.format(block.svg.decode())
    if isinstance(block, Table):
        tags = ["th", *["td"] * (len(block.rows) - 1)]
        rows = "".join(["<tr>" + "".join([f"<{tag}>{_html(cell)}</{tag}>" for cell in row]) + "</tr>"
                        for tag, row in zip(tags, block.rows)])  # fmt: skip
        return _SCROLL.format(f"<table>{rows}</table>")
    return f"<p>{_html(block)}</p>"


def _row(latex: str) -> str:
    """Return a row of formulas that are aligned at their equals signs."""
    style = '<mtd style="text-align:{};padding:.15em .1em">{}</mtd>'
    return "<mtr>" + "".join(map(style.format, ("right", "left"), cells(latex))) + "</mtr>"


def _html(text: str) -> str:
    return spelt(text, escape, to_mathml, "<b>{}</b>")
