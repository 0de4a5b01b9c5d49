"""The report of `lagc cost`: a table, and one stand-alone page."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from math import isfinite
from typing import Any

from lagc.base.text import printable
from lagc.kernels.integrators.tableaus import adapts
from lagc.study.advice import Point
from lagc.study.cost import Study

QUANTITIES = 6  # columns of errors by quantity
PAGE = """<!DOCTYPE html>
<html lang="en">
<head><meta charset="utf-8"><title>{title}</title>
<style>
body {{ font: 15px/1.5 system-ui, sans-serif; max-width: 60em; margin: 2em auto; padding: 0 1em }}
svg {{ max-width: 100%; height: auto }}
pre {{ font-size: 12px; line-height: 1.35; overflow-x: auto; background: #f6f6f6; padding: 1em }}
</style></head>
<body><h1>{title}</h1>
{picture}
<pre>{table}</pre>
</body></html>
"""


def text(study: Study, heading: str, everything: bool = False) -> str:
    """Return the report for a terminal; `everything`: all settings, not the front alone."""
    recorded = f"{study.recorded} recorded times"
    lines = [f"{heading}, {study.stop:g} s, {study.operations} operations of a right-hand side, {recorded}"]
    if study.reference is not None:
        lines.append(f"  reference  {study.reference.words}")
    if study.points:
        spreads = sorted(100.0 * p.spread for p in study.points)
        rounds = min(len(p.times) for p in study.points)
        lines.append(
            f"  clock      CPU time of the C code alone, the least of {rounds} rounds in turn; +% is the "
            f"median above it, {spreads[len(spreads) // 2]:.1f} % (worst {spreads[-1]:.1f} %)"
        )
        lines.append(f"  spent      {study.spent:.0f} s of {study.budget:.0f} s (--budget)")
        lines += ["", *_table(study, everything)]
    if study.points and study.advice:
        lines += ["", *_advice(study)]
    if study.verified:
        lines += ["", *_verified(study)]
    if study.compilers:
        (first, base), *others = study.compilers.items()
        words = [f"{name} {1e3 * s:.3g} ms ({s / base:.2f} times)" for name, s in others]
        lines += ["", f"  compiler   {first} {1e3 * base:.3g} ms, {', '.join(words)}"]
    lines += [f"  note       {note}" for note in study.notes]
    return "\n".join(map(printable, lines)) + "\n"


def _table(study: Study, everything: bool) -> list[str]:
    shown: Sequence[Point] = study.points if everything else study.front
    shown = sorted(shown, key=lambda p: -p.error) if not everything else shown
    worst = sorted(range(len(study.names)), key=lambda k: -max(p.errors[k] for p in study.points))
    columns = sorted(worst[:QUANTITIES])
    names = [study.names[k] for k in columns]
    head = f"  {'error':>7}  {'method':7} {'setting':16} {'ms':>8} {'+%':>5} {'rhs':>9} {'steps':>8}"
    head += f" {'rejected':>8}"
    lines = [head + "".join(f"  {name:>8}" for name in names)]
    for p in shown:
        line = f"  {p.error:7.0e}  {p.setting.method:7} {p.setting!s:16} {1e3 * p.seconds:8.3g} "
        line += f"{100 * p.spread:5.1f} {p.rhs:9d} {p.steps:8d} {p.rejected:8d}"
        lines.append(
            line + "".join(f"  {p.errors[k]:>{max(8, len(name))}.0e}" for k, name in zip(columns, names))
        )
    hidden = len(study.points) - len(shown)
    words = (
        []
        if everything
        else [f"the front: settings that no other beats in error and time; --all shows {hidden} others"]
    )
    if len(study.names) > len(columns):
        words.append(f"the {len(columns)} quantities with the largest errors of {len(study.names)}")
    return [*lines, *([f"  ({'; '.join(words)})"] if words else [])]


def _advice(study: Study) -> list[str]:
    lines = [f"  {'for':6} {'take':26} {'costs':>10}   {'one digit more':24}  nearby"]
    for a in study.advice:
        if a.setting is None:
            lines.append(f"  {a.target:<6.0e} no setting in double precision is sure to meet it")
            continue
        digit = "not in double precision" if a.digit is None else f"{100 * a.digit:+.0f} %"
        take = f"{a.setting.method} {a.setting}"
        met = f"{a.met} of {a.tried}" if a.tried else "not tried"
        lines.append(f"  {a.target:<6.0e} {take:26} {1e3 * a.seconds:7.3g} ms   {digit:24}  {met}")
    for method in dict.fromkeys(a.setting.method for a in study.advice if a.setting is not None):
        if method not in study.laws:
            lines.append(f"  ({method}: all settings meet it; the errors are those of round-off)")
            continue
        law = study.laws[method]
        size = "rtol" if adapts(method) else "step"
        lines.append(
            f"  ({method}: error = {law.factor:.2g} {size}^{law.power:.2f}, nine of ten runs below "
            f"{law.scatter:.1f} times that)"
        )
    lines.append("  (nearby: motions with parameters up to 1 % off that meet the target)")
    return lines


def _verified(study: Study) -> list[str]:
    lines = ["  `lagc sim --accuracy`: all runs that verify, in one process"]
    for v in study.verified:
        made = f"made {v.error:.0e}" if isfinite(v.error) else v.status
        said = "" if v.estimated is None else f", estimated {v.estimated:.0e}"
        lines.append(f"  {v.asked:<6.0e} {1e3 * v.seconds:7.3g} ms, {v.rhs} right-hand sides, {made}{said}")
    return lines


def headline(study: Study) -> str:
    """Return the price of a digit in one sentence."""
    taken = [a for a in study.advice if a.setting is not None]
    digits = [a.digit for a in taken if a.digit is not None]
    if not digits:
        return "what accuracy costs"
    low, high = (f"{100 * d:.0f}" for d in (min(digits), max(digits)))
    methods = dict.fromkeys(a.setting.method for a in taken if a.setting is not None)
    return (
        f"one digit more costs {low if low == high else f'{low} to {high}'} %, with {', then '.join(methods)}"
    )


def to_dict(study: Study) -> dict[str, Any]:
    """Return the study as the object that `lagc cost --json` prints."""
    reference = study.reference
    return {
        "stop": study.stop, "recorded": study.recorded, "operations": study.operations,
        "quantities": list(study.names), "complete": study.complete, "spent_s": study.spent,
        "budget_s": study.budget,
        "reference": None if reference is None else {
            "words": reference.words, "agreement": reference.agreement, "second_method": reference.second,
            "scales": [float(x) for x in reference.scales],
        },
        "points": [
            {"method": p.setting.method, "rtol": p.setting.rtol or None, "step": p.setting.step or None,
             "error": p.error, "errors": [float(e) for e in p.errors], "seconds": p.seconds,
             "spread": p.spread, "rhs": p.rhs, "steps": p.steps, "rejected": p.rejected, "front": p in front}
            for front in [study.front] for p in study.points
        ],
        "laws": {
            method: {"factor": law.factor, "power": law.power, "scatter": law.scatter}
            for method, law in study.laws.items()
        },
        "advice": [
            {"target": a.target, "method": a.setting and a.setting.method, "met": a.met, "tried": a.tried,
             "rtol": (a.setting and a.setting.rtol) or None, "step": (a.setting and a.setting.step) or None,
             "seconds": a.seconds, "one_digit_more": a.digit}
            for a in study.advice
        ],
        "verified": [
            {"asked": v.asked, "status": v.status, "estimated": v.estimated,
             "error": v.error if isfinite(v.error) else None, "seconds": v.seconds, "rhs": v.rhs}
            for v in study.verified
        ],
        "compilers": dict(study.compilers), "notes": list(study.notes),
    }  # fmt: skip


def page(study: Study, heading: str, picture: str) -> str:
    """Return one stand-alone HTML page; `picture` is an element `<svg>`."""
    return stand_alone(f"{heading}: {headline(study)}", picture, text(study, heading, True))


def stand_alone(title: str, picture: str, table: str) -> str:
    return PAGE.format(title=escape(title), picture=picture, table=escape(table))
