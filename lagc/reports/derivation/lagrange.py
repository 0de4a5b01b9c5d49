"""The sections on Lagrange's equations, on the result, and on the form with L."""

from lagc.reports.derivation.actions import index
from lagc.reports.derivation.document import Row, math
from lagc.reports.derivation.draft import Draft
from lagc.reports.derivation.writer import (
    WIDTH,
    Written,
    broken,
    in_parentheses,
    seen_width,
    split_sign,
    width_of,
    words,
)
from lagc.reports.equations.latex import LatexWriter
from lagc.reports.equations.modes import IMPACTS, Mode, modes
from lagc.reports.equations.page import Page, page
from lagc.reports.names import where
from lagc.reports.patterns.formula_trees import Term, Total
from lagc.symbolic.graph import Node

SHORT, PAIR = 50, 38  # characters: of dK/dq' inside d/dt( ), of two derivatives on one line
EQUATION = r"\frac{d}{dt}\frac{\partial K}{\partial \dot q_j} - \frac{\partial K}{\partial q_j}"
ROTATION = (
    r"\frac{d}{dt}\frac{\partial K}{\partial \vec\omega} + "
    r"\vec\omega \times \frac{\partial K}{\partial \vec\omega} - \frac{\partial K}{\partial \vec\vartheta}"
)
CHAIN = r"\frac{\partial \dot q_j}{\partial u_i}"
SPEEDS = rf"\sum_j E_j \, {CHAIN} = \sum_j Q_j \, {CHAIN}"
RESULTS = {"touches": "closed", "sticks": "sticks", "slips": "slips"}  # words of titles of modes


def write_equations(draft: Draft) -> None:
    """Write, for each parameter, the derivatives of K, the equation with every term named, and d/dt carried
    out."""
    rates, equations = draft.rates, draft.equations
    draft.heading("h_lagrange")
    right = r"\hat Q_j"
    right += r" + \sum_k \lambda_k\, a_{kj}" if equations.rows or equations.contacts else ""
    right += r" + \tilde Q_j^{im}" if any(c.slips for c in equations.contacts) else ""
    general = [Row(EQUATION, (right,))] if rates.positions else []
    draft.formula(*general, *([Row(ROTATION, (r"\vec Q",))] if rates.rotations else []))
    changes, turned = rates.change(draft.opened(draft.momenta)), rates.gyroscopic(draft.momenta)
    true = list(zip(rates.momenta(rates.kinetic), rates.slopes(rates.kinetic)))
    for j in range(len(rates.symbols)):
        draft.heading(
            "equation_of" if j in rates.positions else "rotation_of", math(index(draft, j)), level=3
        )
        _write_equation(draft, j, changes[j], turned.get(j, draft.graph.zero), true[j])


def _write_equation(draft: Draft, j: int, change: Node, turned: Node, true: tuple[Node, Node]) -> None:
    """Write the equation of one rate; `turned` is w x dK/dw, `true` are the derivatives of K as it was
    derived."""
    writer, (rate, along) = draft.writer, _letters(draft, j)
    by_rate, by_place = (
        rf"\frac{{\partial K}}{{\partial {rate}}}",
        rf"\frac{{\partial K}}{{\partial {along}}}",
    )
    momentum = writer.lines(draft.momenta[j], f"dK/dq' {j}", of=true[0])
    slope = writer.lines(draft.slopes[j], f"dK/dq {j}", of=true[1])
    if len(momentum) == len(slope) == 1 and width_of([*momentum, *slope]) < PAIR:
        draft.formula(Row(by_rate, (rf"{momentum[0]}, \qquad {by_place} = {slope[0]}",)))
    else:
        draft.formula(Row(by_rate, momentum), Row(by_place, slope))
    # The left side has the derivatives themselves where they are short, else their names.
    is_short = len(momentum) == 1 and width_of(momentum) <= SHORT
    left = [rf"\frac{{d}}{{dt}}\left({momentum[0]}\right)" if is_short else rf"\frac{{d}}{{dt}}{by_rate}"]
    if not writer.is_zero(turned):
        sign, text = split_sign("".join(writer.lines(turned, f"w x dK/dw {j}")))
        left.append(f"{sign}{text if sign else in_parentheses(text)}")
    if slope != ("0",):
        fits = len(slope) == 1 and width_of(slope) + (width_of(momentum) if is_short else 0) <= SHORT
        sign, text = split_sign(slope[0]) if fits else ("", by_place)
        left.append(text if sign else f"-{in_parentheses(text)}")
    shown, right = broken(left, 10**9), broken(_named_terms(draft, j) or ["0"])
    if width_of(shown) + width_of(right) > WIDTH:
        draft.formula(Row("", shown), Row("=", right))
    else:
        draft.formula(Row(shown[0], right))
    draft.formula(draft.row(rf"\frac{{d}}{{dt}}{by_rate}", change, f"d/dt dK/dq' {j}"))


def _letters(draft: Draft, j: int) -> tuple[str, str]:
    """Return the letters of a rate and of its position; those of an angle about an axis of an orientation."""
    along = index(draft, j)
    return draft.writer.symbol(draft.rates.symbols[j]), (
        along if j in draft.rates.positions else rf"\vartheta_{{{along}}}"
    )


def _named_terms(draft: Draft, j: int) -> list[str]:
    """Return the generalized forces along a rate, each with the name of its action or constraint."""
    found = []
    for term in [*draft.rates.given_terms, *draft.rates.reactions]:
        if j in term.forces and not draft.writer.is_zero(term.forces[j]):
            sign, text = split_sign(draft.writer.text(term.forces[j], f"term {term.name} {j}"))
            name = words(term.name.rpartition(".")[2])
            name += f": {draft.say('friction')}" if term.kind == "imperfect" else ""
            found.append(rf"{sign}\underbrace{{{text}}}_{{\text{{{name}}}}}")
    return found


# -- result -------------------------------------------------------------------------------------------


def write_result(draft: Draft) -> None:
    """Write the equations as `lagc equations` does, in each mode of a contact, with what they were divided
    by."""
    draft.heading("h_result")
    if not draft.rates.declared.plain:
        draft.paragraph("along_speeds")
        draft.formula(Row("", (SPEEDS,)))
    found, legend = modes(draft.equations), dict[str, str]()
    for mode in found:
        if len(found) > 1:
            keys = [RESULTS[word] for word in mode.title.split() if word in RESULTS]
            title = draft.say.all_of(*keys) if keys else draft.say("all_contacts" if mode.title else "open")
            draft.paragraph("mode", title)
        legend |= _write_mode(draft, mode)
    if legend:
        draft.blocks.append("; ".join([draft.say("where_short", *pair) for pair in legend.items()]))


def _write_mode(draft: Draft, mode: Mode) -> dict[str, str]:
    """Write the equations of a mode; return the short names in them, each with the one of the model."""
    found = page(mode.equations, draft.full, mode.laws)
    writer = LatexWriter(found.names, found.ruled)
    # Long lines are broken at their terms, unless they follow rules, which stay as they are.
    rows: dict[str, list[Row]] = {"": [], "impact": [], "event": []}
    motion = 0
    for kind, group in found.by_kind():
        into = rows["impact" if kind in IMPACTS else kind if kind == "event" else ""]
        for line in group:
            left, _, right = writer.line(line).partition(" &")
            terms = (
                [] if found.ruled or seen_width(left) <= WIDTH else [writer.part(x) for x in line.left.terms]
            )
            note = ""
            if kind == "motion" and not found.ruled:
                note = _factor_note(draft, found, motion)
                _record_motion(draft, mode, found, line.left, motion)
                motion += 1
            into.append(Row("", broken(terms) if terms else (left,), f" {right}{note}"))
    for key, own in rows.items():
        if own and key:
            draft.paragraph(key)
        if own:
            draft.formula(*own)
    return {math(writer.letters(short, short)): full for short, full in where(writer.seen)}


def _record_motion(draft: Draft, mode: Mode, found: Page, left: Total, j: int) -> None:
    """Record that an equation times its factor is M a + h - tau - G^T lambda in this mode; with letters for
    shared parts it is not recorded."""
    equations, one = mode.equations, draft.graph.one
    (row,) = equations.mass_rows([j])
    terms = [m * equations.a[k] for k, m in row.items()]
    terms += [equations.bias_forces[j], -equations.given_forces[j]]
    terms += [-(r.multiplier * r.jacobian[j]) for r in equations.rows if j in r.jacobian]
    whole = Total((Term(False, 1, ((left, 1), (found.factors[j], 1))),))
    if not any(line.kind == "shared" for line in found.lines):
        written = Written(f"result {j} {mode.title}", ((whole, one),), draft.graph.sum(terms))
        draft.writer.written.append(written)


def _factor_note(draft: Draft, found: Page, j: int) -> str:
    """Return "(divided by l)" or "(times 2)", in words of the language; "" for the factor 1."""
    text = LatexWriter(found.names).total(found.factors[j])
    if text == "1":
        return ""
    half = text.startswith(r"\frac{1}{") and text.endswith("}") and text[9:-1].isdigit()
    key, by = ("times_by", text[9:-1]) if half else ("divided_by", text)
    return rf" \qquad \text{{({draft.say(key)} }} {by}\text{{)}}"


def write_lagrangian(draft: Draft) -> None:
    """Write the equations with L = K + U, where all actions derive from U and no constraint is explicit."""
    say, rates, equations = draft.say, draft.rates, draft.equations
    draft.heading("h_lagrangian")
    kinds = ("potential", "lagrangian")
    others = [c.name for c in equations.contributions if not (c.conservative and c.kind in kinds)]
    rows = dict.fromkeys([*(x.label for x in equations.rows), *(c.label for c in equations.contacts)])
    if others or rows:
        reasons = [*[say("because_action", x) for x in others], *[say("because_row", x) for x in rows]]
        draft.paragraph("not_lagrangian", ", ".join(reasons))
        return
    draft.paragraph("all_derive")
    # L takes the place of K: the derivatives of U by the rates vanish, those by the coordinates join dK/dq.
    U = -equations.potential
    draft.formula(Row("L", draft.writer.lines(draft.kinetic + U, "L", of=rates.kinetic + U)))
    found = []
    for j, slope in enumerate(rates.slopes(U)):
        rate, along = _letters(draft, j)
        found.append(draft.row(rf"\frac{{\partial L}}{{\partial {rate}}}", draft.momenta[j], f"dL/dq' {j}"))
        slope = draft.slopes[j] + slope
        found.append(draft.row(rf"\frac{{\partial L}}{{\partial {along}}}", slope, f"dL/dq {j}"))
    draft.formula(*found)
    if not rates.rotations:
        draft.formula(Row(EQUATION.replace("K", "L"), ("0",), rf"\quad\text{{: {say('same')}}}"))
