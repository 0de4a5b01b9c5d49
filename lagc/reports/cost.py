"""The report of `lagc cost`: a table, and one stand-alone page."""

from collections.abc import Sequence
from math import isfinite
from typing import Any

from lagc.base.text import WIDTH, broken, entry, printable, table
from lagc.kernels.integrators.tableaus import adapts
from lagc.reports.stand_alone import stand_alone
from lagc.study.advice import Point
from lagc.study.cost import Study


def text(study: Study, heading: str, everything: bool = False) -> str:
    """Return the report for a terminal; `everything`: all settings, not the front alone."""
    recorded = f"{study.recorded} recorded times"
    lines = broken(
        f"{heading}, {study.stop:g} s, {study.operations} operations a right-hand side, {recorded}", WIDTH
    )
    if study.reference is not None:
        lines += entry("reference", study.reference.words, 13)
    if study.points:
        spreads = sorted(100.0 * p.spread for p in study.points)
        rounds = min(len(p.times) for p in study.points)
        lines += entry(
            "clock",
            f"CPU time of the C code alone, the least of {rounds} rounds in turn; +% is the median above it, "
            f"{spreads[len(spreads) // 2]:.1f} % (worst {spreads[-1]:.1f} %)",
            13,
        )
        lines += entry("spent", f"{study.spent:.0f} s of {study.budget:.0f} s (--budget)", 13)
        lines += ["", *_table(study, everything)]
    lines += _closing(study)
    return "\n".join(map(printable, lines)) + "\n"


def _closing(study: Study) -> list[str]:
    """Return the advice, the verified runs and the notes."""
    lines = ["", *_advice(study)] if study.points and study.advice else []
    if study.verified:
        lines += ["", *_verified(study)]
    if study.compilers:
        (first, base), *others = study.compilers.items()
        words = [f"{name} {1e3 * s:.3g} ms ({s / base:.2f} times)" for name, s in others]
        lines += ["", *entry("compiler", f"{first} {1e3 * base:.3g} ms, {', '.join(words)}", 13)]
    return lines + [line for note in study.notes for line in entry("note", note, 13)]


def _table(study: Study, everything: bool) -> list[str]:
    shown: Sequence[Point] = study.points if everything else study.front
    shown = sorted(shown, key=lambda p: -p.error) if not everything else shown
    head = ["error", "of", "method", "setting", f"{'ms':>8}", f"{'+%':>5}", f"{'rhs':>7}", f"{'steps':>7}"]
    rows = []
    for p in shown:
        worst = study.names[max(range(len(study.names)), key=p.errors.__getitem__)]
        rows.append(
            [f"{p.error:.0e}", worst, p.setting.method, str(p.setting), f"{1e3 * p.seconds:8.3g}",
             f"{100 * p.spread:5.1f}", f"{p.rhs:7d}", f"{p.steps:7d}"]
        )  # fmt: skip
    lines, hidden = table(head, rows), len(study.points) - len(shown)
    if not everything:
        lines += entry(
            "", f"(the front: no other beats them in error and time; --all shows {hidden} others)", 2
        )
    return lines


def _advised(study: Study) -> list[list[str]]:
    """Return the settings to take as the rows of a table, the first its head."""
    rows = [["for", "take", "costs", "one digit more", "nearby"]] if study.advice else []
    for a in study.advice:
        if a.setting is None:
            rows.append([f"{a.target:.0e}", "none in double precision", "", "", ""])
            continue
        digit = "not in double precision" if a.digit is None else f"{100 * a.digit:+.0f} %"
        met = f"{a.met} of {a.tried}" if a.tried else "not tried"
        rows.append(
            [f"{a.target:.0e}", f"{a.setting.method} {a.setting}", f"{1e3 * a.seconds:.3g} ms", digit, met]
        )
    return rows


def _advice(study: Study) -> list[str]:
    head, *rows = _advised(study)
    lines = table(head, rows)
    for method in dict.fromkeys(a.setting.method for a in study.advice if a.setting is not None):
        if method not in study.laws:
            lines += entry("", f"({method}: all settings meet it; the errors are those of round-off)", 2)
            continue
        law = study.laws[method]
        size = "rtol" if adapts(method) else "step"
        most = f"nine of ten runs below {law.scatter:.1f} times that"
        lines += entry("", f"({method}: error = {law.factor:.2g} {size}^{law.power:.2f}, {most})", 2)
    return [*lines, "  (nearby: motions with parameters up to 1 % off that meet the target)"]


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
    return stand_alone(heading, headline(study), _advised(study), picture, text(study, heading, True))
