"""The page of a study: one file without network access or script, in the look of the pages of animations."""

from collections.abc import Sequence
from html import escape

STYLE = """:root{--paper:#fff;--stage:#f3f5f7;--ink:#1d2733;--soft:#5d6975;--line:#c9d1d9;--accent:#0b63a5}
@media(prefers-color-scheme:dark){:root{--paper:#14181d;--stage:#1b2127;--ink:#e4e9ee;--soft:#9aa7b3;
--line:#3a444e;--accent:#6cb4f0}}
body{margin:0;background:var(--paper);color:var(--ink);font:14px/1.4 system-ui,sans-serif}
header{padding:8px 14px;display:flex;flex-wrap:wrap;gap:2px 14px;align-items:baseline;
border-bottom:1px solid var(--line)}
h1{font-size:17px;margin:0}header p{margin:0;color:var(--soft)}
main{max-width:72em;margin:0 auto;padding:14px}.wide{overflow-x:auto}
table{border-collapse:collapse}th{text-align:left;color:var(--soft);font-weight:600}
th,td{padding:5px 18px 5px 0;border-bottom:1px solid var(--line);white-space:nowrap}
td:nth-child(2){font-weight:600;color:var(--accent)}
svg{display:block;width:100%;min-width:48em;height:auto;background:#fff;border-radius:6px}
.wide{margin:14px 0}
pre{font:12px/1.4 ui-monospace,monospace;overflow-x:auto;background:var(--stage);padding:12px}
summary{cursor:pointer;font-weight:600}"""
PAGE = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>{title}</title>
<meta name="viewport" content="width=device-width,initial-scale=1">
<style>{style}</style></head>
<body><header><h1>{title}</h1><p>{headline}</p></header><main>
{advice}<div class="wide">{picture}</div>
<details{open}><summary>All measurements</summary><pre>{text}</pre></details>
</main></body></html>
"""
Rows = Sequence[Sequence[str]]


def stand_alone(title: str, headline: str, advice: Rows, picture: str, text: str) -> str:
    """Return one HTML page: the advice as a table, whose first row is its head, then the picture, an element
    `<svg>`, and the whole report, folded if there is advice."""
    return PAGE.format(
        title=escape(title), headline=escape(headline), style=STYLE, advice=_table(advice), picture=picture,
        text=escape(text), open="" if advice else " open",
    )  # fmt: skip


def _table(rows: Rows) -> str:
    if not rows:
        return ""
    head, *body = [[escape(cell) for cell in row] for row in rows]
    lines = [f"<tr>{''.join(f'<td>{cell}</td>' for cell in row)}</tr>" for row in body]
    titles = "".join([f"<th>{cell}</th>" for cell in head])
    return f'<div class="wide"><table><tr>{titles}</tr>\n{chr(10).join(lines)}</table></div>\n'
