"""The sections on Lagrange's equations, on the result, and on the form with L."""

from __future__ import annotations

from collections.abc import Sequence

from lagc.reports.derivation.actions import rate_index
from lagc.reports.derivation.document import FormulaRow, Text, joined, math
from lagc.reports.derivation.draft import Draft
from lagc.reports.derivation.writer import WIDTH, Written, broken, in_parentheses, seen_width, width_of, words
from lagc.reports.equations.latex import LatexWriter
from lagc.reports.equations.modes import IMPACTS, Mode, modes
from lagc.reports.equations.page import Page, page
from lagc.reports.names import where
from lagc.reports.patterns.formula_trees import Term as Product
from lagc.reports.patterns.formula_trees import Total
from lagc.symbolic.graph import Node

SHORT, PAIR = 60, 38  # characters: of dK/dq' inside d/dt( ), of two derivatives on one line


def write_equations(draft: Draft) -> None:
    """Write, for each parameter, the derivatives of K, the equation with every term named, and d/dt carried
    out."""
    say, rates, equations = draft.say, draft.rates, draft.equations
    draft.heading(2, say("h_lagrange"))
    right = r"\hat Q_j"
    right += r" + \sum_k \lambda_k\, a_{kj}" if equations.rows or equations.contacts else ""
    right += r" + \tilde Q_j^{im}" if any(c.slips for c in equations.contacts) else ""
    if rates.positions:
        left = r"\frac{d}{dt}\frac{\partial K}{\partial \dot q_j} - \frac{\partial K}{\partial q_j}"
        draft.formula(FormulaRow(left, (right,)))
    if rates.rotations:
        left = r"\frac{d}{dt}\frac{\partial K}{\partial \vec\omega} + \vec\omega \times \frac{\partial K}{\partial \vec\omega} - \frac{\partial K}{\partial \vec\vartheta}"
        draft.formula(FormulaRow(left, (r"\vec Q",)))
    changes = rates.change(draft.opened(draft.momenta))
    turned = rates.gyroscopic(draft.momenta)
    true = (rates.momenta(rates.kinetic), rates.slopes(rates.kinetic))
    for j in range(len(rates.symbols)):
        key = "equation_of" if j in rates.positions else "rotation_of"
        draft.heading(3, say(key, math(rate_index(draft, j))))
        _write_equation(draft, j, changes[j], turned.get(j), (true[0][j], true[1][j]))


def _write_equation(draft: Draft, j: int, change: Node, turned: Node | None, true: tuple[Node, Node]) -> None:
    writer, dq = draft.writer, draft.writer.symbol(draft.rates.symbols[j])
    along = rate_index(draft, j) if turned is None else rf"\vartheta_{{{rate_index(draft, j)}}}"
    by_rate, by_place = rf"\frac{{\partial K}}{{\partial {dq}}}", rf"\frac{{\partial K}}{{\partial {along}}}"
    momentum = writer.lines(draft.momenta[j], f"dK/dq' {j}", of=true[0])
    slope = writer.lines(draft.slopes[j], f"dK/dq {j}", of=true[1])
    if len(momentum) == len(slope) == 1 and width_of([*momentum, *slope]) < PAIR:
        draft.formula(FormulaRow(by_rate, (rf"{momentum[0]}, \qquad {by_place} = {slope[0]}",)))
    else:
        draft.formula(FormulaRow(by_rate, momentum), FormulaRow(by_place, slope))
    is_short = len(momentum) == 1 and width_of(momentum) <= SHORT
    left = rf"\frac{{d}}{{dt}}\left({momentum[0]}\right)" if is_short else rf"\frac{{d}}{{dt}}{by_rate}"
    if turned is not None and not writer.is_zero(turned):
        text = "".join(writer.lines(turned, f"w x dK/dw {j}"))
        left += (
            f" - {text[1:]}"
            if text.startswith("-") and len(writer.polynomial(turned)) == 1
            else f" + {in_parentheses(text)}"
        )
    if slope != ("0",):
        fits = len(slope) == 1 and width_of(slope) + (width_of(momentum) if is_short else 0) <= SHORT
        single = fits and slope[0].startswith("-") and " + " not in slope[0] and " - " not in slope[0]
        left += (
            f" + {slope[0][1:]}" if single else f" - {in_parentheses(slope[0])}" if fits else f" - {by_place}"
        )
    right = broken(_named_terms(draft, j) or ["0"])
    if seen_width(left) + width_of(right) > WIDTH:
        draft.formula(FormulaRow("", (left,)), FormulaRow("=", right))
    else:
        draft.formula(FormulaRow(left, right))
    draft.formula(FormulaRow(rf"\frac{{d}}{{dt}}{by_rate}", writer.lines(change, f"d/dt dK/dq' {j}")))


def _named_terms(draft: Draft, j: int) -> list[str]:
    """Return the generalized forces along a rate, each with the name of its action or constraint."""
    writer, found = draft.writer, list[str]()
    for term in [*draft.rates.given, *draft.rates.reactions]:
        force = term.forces.get(j)
        if force is None or writer.is_zero(force):
            continue
        text, sign = writer.text(force, f"term {term.name} {j}"), ""
        if text.startswith("-") and " + " not in text and " - " not in text:
            text, sign = text[1:], "-"
        name = words(term.name.rpartition(".")[2])
        name += f": {draft.say.word('friction')}" if term.kind == "imperfect" else ""
        found.append(rf"{sign}\underbrace{{{text}}}_{{\text{{{name}}}}}")
    return found


# -- result -------------------------------------------------------------------------------------------


def write_result(draft: Draft) -> None:
    """Write the equations as `lagc equations` does, in each mode of a contact, with what they were divided
    by."""
    draft.heading(2, draft.say("h_result"))
    if not draft.rates.declared.plain:
        draft.paragraph(draft.say("along_speeds"))
        law = r"\sum_j E_j \, \frac{\partial \dot q_j}{\partial u_i} = \sum_j Q_j \, \frac{\partial \dot q_j}{\partial u_i}"
        draft.formula(FormulaRow("", (law,)))
    found = modes(draft.equations)
    for mode in found:
        if len(found) > 1:
            draft.paragraph(draft.say("mode", _mode_name(draft, mode)))
        _write_mode(draft, mode)


def _mode_name(draft: Draft, mode: Mode) -> Text:
    """Return the name of a mode in the language of the solution."""
    if not mode.title:
        return draft.say("open")
    keys = {"touches": "closed", "sticks": "sticks", "slips": "slips"}
    found = [draft.say(keys[word]) for word in mode.title.split() if word in keys]
    return joined(found, f" {draft.say.word('and')} ") if found else draft.say("all_contacts")


def _write_mode(draft: Draft, mode: Mode) -> None:
    found = page(mode.equations, draft.full, mode.laws)
    writer = LatexWriter(found.names, found.ruled)
    rows: dict[str, list[FormulaRow]] = {"": [], "impact": [], "event": []}
    motion = 0
    for kind, group in found.by_kind():
        into = rows["impact" if kind in IMPACTS else kind if kind == "event" else ""]
        for line in group:
            note = ""
            if kind == "motion" and not found.ruled:
                note = _factor_note(draft, found, motion)
                _record_motion(draft, mode, found, line.left, motion)
                motion += 1
            into.append(_result_row(writer, line.left, writer.line(line), note))
    for key, own in rows.items():
        if own and key:
            draft.paragraph(draft.say(key))
        if own:
            draft.formula(*own)
    for short, full in where(writer.seen):
        draft.paragraph(draft.say("where_short", math(writer.letters(short, short)), full))


def _result_row(writer: LatexWriter, left: Total, text: str, note: str) -> FormulaRow:
    """Return an equation as `lagc equations` writes it, a long sum in lines."""
    before, sign, after = text.partition(" &")
    terms = [writer.part(x) for x in left.terms] if not writer.cut else []
    lines = broken(terms) if terms and seen_width(before) > WIDTH else (before,)
    return FormulaRow("", lines, f" {sign.replace('&', '').strip()}{after}{note}")


def _record_motion(draft: Draft, mode: Mode, found: Page, left: Total, j: int) -> None:
    """Record that an equation times its factor is M a + h - tau - G^T lambda in this mode."""
    equations = mode.equations
    (row,) = equations.mass_rows([j])
    terms = [m * equations.a[k] for k, m in row.items()]
    terms += [equations.bias_forces[j], -equations.given_forces[j]]
    terms += [-(r.multiplier * r.jacobian[j]) for r in equations.rows if j in r.jacobian]
    whole = Total((Product(False, 1, ((left, 1), (found.factors[j], 1))),))
    if not any(line.kind == "shared" for line in found.lines):
        one = draft.graph.one
        draft.writer.written.append(
            Written(f"result {j} {mode.title}", ((whole, one),), draft.graph.sum(terms))
        )


def _factor_note(draft: Draft, found: Page, j: int) -> str:
    """Return "(divided by l)" or "(times 2)", in words of the language; "" for the factor 1."""
    factor = found.factors[j]
    (term,) = factor.terms
    if not term.factors and term.size == 1 and not term.negative:  # type: ignore[union-attr]
        return ""
    sign = "-" if term.negative else ""  # type: ignore[union-attr]
    inverse = 1 / term.size  # type: ignore[union-attr,operator]
    if not term.factors and inverse == int(inverse):  # type: ignore[union-attr]
        return rf" \qquad \text{{({draft.say.word('times_by')} }} {sign}{int(inverse)}\text{{)}}"
    text = LatexWriter(found.names).total(factor)
    return rf" \qquad \text{{({draft.say.word('divided_by')} }} {text}\text{{)}}"


def write_lagrangian(draft: Draft) -> None:
    """Write the equations with L = K + U, where all actions derive from U and no constraint is explicit."""
    say, rates, equations, writer = draft.say, draft.rates, draft.equations, draft.writer
    draft.heading(2, say("h_lagrangian"))
    reasons = _reasons(draft)
    if reasons:
        draft.paragraph(say("not_lagrangian", joined(reasons, ", ")))
        return
    draft.paragraph(say("all_derive"))
    function = -equations.potential
    draft.formula(FormulaRow("L", writer.lines(draft.kinetic + function, "L", of=rates.kinetic + function)))
    rows = []
    places = rates.slopes(function)
    for j, rate in enumerate(rates.symbols):
        along = rate_index(draft, j)
        if j not in rates.positions:
            along = rf"\vartheta_{{{along}}}"
        left = rf"\frac{{\partial L}}{{\partial {writer.symbol(rate)}}}"
        rows.append(FormulaRow(left, writer.lines(draft.momenta[j], f"dL/dq' {j}")))
        slope = writer.lines(draft.slopes[j] + places[j], f"dL/dq {j}")
        rows.append(FormulaRow(rf"\frac{{\partial L}}{{\partial {along}}}", slope))
    draft.formula(*rows)
    if not rates.rotations:
        left = r"\frac{d}{dt}\frac{\partial L}{\partial \dot q_j} - \frac{\partial L}{\partial q_j}"
        draft.formula(FormulaRow(left, ("0",), rf"\quad\text{{: {say.word('same')}}}"))


def _reasons(draft: Draft) -> Sequence[Text]:
    """Return why the form with L does not apply."""
    say, equations = draft.say, draft.equations
    from_potential = ("potential", "lagrangian")
    without = [c.name for c in equations.contributions if not (c.conservative and c.kind in from_potential)]
    labels = dict.fromkeys([*[r.label for r in equations.rows], *[c.label for c in equations.contacts]])
    return [
        *[say("because_action", name) for name in without],
        *[say("because_row", label) for label in labels],
    ]
