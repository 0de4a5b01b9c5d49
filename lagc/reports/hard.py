"""The report of `lagc hard`: a table for a terminal and for documents, one case in words, plain data."""

from textwrap import fill
from typing import Any

from lagc.base.text import printable, table
from lagc.reports.stand_alone import stand_alone
from lagc.study.hard.case import Case, Figure, Hard, Row

NAMES = {"c": "C", "numpy": "Python"}
WIDTH, ONE_LINE = 100, 10**6


def text(found: Hard, heading: str) -> str:
    """Return the table for a terminal."""
    rows = []
    for row in found.rows:
        for k, figure in enumerate(row.case.figures):
            first = k == 0
            rows.append([
                row.case.name if first else "", NAMES[row.backend] if first else "", figure.words,
                _number(figure.most), _value(row, k), _mark(row, k), _method(row) if first else "",
                f"{row.seconds:.2f} s" if first else "",
            ])  # fmt: skip
    head = ["case", "in", "figure", "required", "measured", "", "method", "time"]
    lines = [heading, "", *table(head, rows, width=ONE_LINE)]
    notes = [(row.case.name, word) for row in found.rows for word in _said(row)]
    lines += [f"  note  {name}: {word}" for name, word in dict.fromkeys(notes)]
    lines += ["", f"  {headline(found)}"]
    return "\n".join(map(printable, lines)) + "\n"


def headline(found: Hard) -> str:
    """Return how many cases keep their figures, in one sentence."""
    names = dict.fromkeys(row.case.name for row in found.rows)
    unmet = dict.fromkeys(row.case.name for row in found.rows if not row.meets_figures)
    words = f"kept: {len(names) - len(unmet)} of {len(names)} cases"
    words += f"; missed: {', '.join(unmet)}" if unmet else ""
    return words if found.complete else f"{words}; ended early"


def _said(row: Row) -> list[str]:
    said = [*row.notes, row.found.said if row.found else "", row.failure]
    return [word for word in said if word]


def _number(value: float) -> str:
    return f"{value:.2g}" if value else "0"


def _value(row: Row, k: int) -> str:
    value = row.found.values[k] if row.found else None
    return "-" if value is None else _number(value)


def _is_met(row: Row, k: int) -> bool:
    if row.found is None:
        return False
    value = row.found.values[k]
    return value is None or value <= row.case.figures[k].most


def _mark(row: Row, k: int) -> str:
    if row.found is None:
        return "failed"
    return "" if _is_met(row, k) else "missed"


def _method(row: Row) -> str:
    return row.found.method if row.found else ""


def markdown(found: Hard, made: str) -> str:
    """Return the table for a document; `made` tells where and when it was measured."""
    columns = [NAMES[backend] for backend in found.backends]
    lines = [fill(f"{headline(found)}. Measured by `lagc hard --markdown` on {made}.", WIDTH), ""]
    lines.append(f"| case | figure | required | {' | '.join(columns)} | method |")
    lines.append(f"| {' | '.join('---' for _ in range(len(columns) + 4))} |")
    # A group of cases is one row with its worst share, every other case a row for each figure.
    groups: dict[str, list[Row]] = {}
    for row in found.rows:
        groups.setdefault(row.case.group or row.case.title, []).append(row)
    for title, own in groups.items():
        if own[0].case.group:
            cells = [_worst(own, backend) for backend in found.backends]
            lines.append(f"| {title} | error over its figure, largest | 1 | {' | '.join(cells)} | |")
            continue
        for k, figure in enumerate(own[0].case.figures):
            cells = [title if k == 0 else "", figure.words, _number(figure.most)]
            cells += [_cell(own, backend, k) for backend in found.backends]
            lines.append(f"| {' | '.join([*cells, _method(own[0]) if k == 0 else ''])} |")
    notes = dict.fromkeys(f"{row.case.name}: {note}" for row in found.rows for note in row.notes)
    if notes:
        lines += ["", fill(f"Shorter in Python: {'; '.join(notes)}.", WIDTH)]
    return "\n".join(lines) + "\n"


def _worst(own: list[Row], backend: str) -> str:
    """The largest share of the figure among the rows of a group, and the cases that miss theirs."""
    rows = [row for row in own if row.backend == backend]
    shares = [
        v / f.most for row in rows if row.found for v, f in zip(row.found.values, row.case.figures) if v
    ]
    unmet = ", ".join(row.case.name for row in rows if not row.meets_figures)
    return _number(max(shares, default=0.0)) + (f" **missed: {unmet}**" if unmet else "")


def _cell(own: list[Row], backend: str, k: int) -> str:
    for row in own:
        if row.backend == backend:
            mark = _mark(row, k)
            return f"{_value(row, k)} **{mark}**" if mark else _value(row, k)
    return ""


def listing(cases: tuple[Case, ...]) -> str:
    """Return the names and titles of all cases."""
    lines = table(
        ["case", "", "figures"], [[c.name, c.title, _figures(c.figures)] for c in cases], width=ONE_LINE
    )
    return "\n".join(map(printable, lines)) + "\n"


def _figures(figures: tuple[Figure, ...]) -> str:
    return ", ".join(f"{f.words}: {_number(f.most)}" for f in figures)


def explanation(case: Case, path: str) -> str:
    """Return what is hard about a case, its figures and their reason; `path` is the file of its model."""
    parts = [("what is hard", case.hard), ("source", case.source), ("why", case.why), ("model", path)]
    lines = [f"{case.name}: {case.title}", ""]
    for word, content in parts:
        head = f"  {word:14}"
        lines.append(fill(content, WIDTH, initial_indent=head, subsequent_indent=" " * len(head),
                          break_long_words=False, break_on_hyphens=False))  # fmt: skip
    lines += [f"  {'run it':14}{case.line}", ""]
    return "\n".join(map(printable, lines)) + "\n"


def to_dict(found: Hard) -> dict[str, Any]:
    """Return the study as the object that `lagc hard --json` prints."""
    return {
        "complete": found.complete, "kept": found.meets_figures,
        "cases": [
            {"name": row.case.name, "title": row.case.title, "backend": row.backend,
             "kept": row.meets_figures, "method": _method(row), "seconds": row.seconds,
             "model": row.case.model, "line": row.case.line,
             "failure": row.failure, "said": row.found.said if row.found else "", "notes": list(row.notes),
             "figures": [
                 {"figure": figure.words, "required": figure.most, "kept": _is_met(row, k),
                  "measured": row.found.values[k] if row.found else None}
                 for k, figure in enumerate(row.case.figures)
             ]}
            for row in found.rows
        ],
    }  # fmt: skip


def page(found: Hard, heading: str, picture: str) -> str:
    """Return one stand-alone HTML page; `picture` is an element `<svg>`."""
    return stand_alone(heading, headline(found), (), picture, text(found, heading))
