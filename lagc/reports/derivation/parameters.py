"""The sections on parameters and on explicit constraints, and the count of unknowns."""

from __future__ import annotations

from lagc.mechanics.analysis.analysis import RowKind
from lagc.mechanics.formulation.equations import ContactRow, Row
from lagc.reports.derivation.document import FormulaRow, ItemList, Table, Text, bold, joined, math, plain
from lagc.reports.derivation.draft import Draft
from lagc.reports.derivation.implicit import implicit_constraints
from lagc.semantics.model import Coordinate
from lagc.symbolic.walk import depends


def write_parameters(draft: Draft) -> None:
    """Name the parameters, and the implicit constraints that made them fewer."""
    say, writer, model = draft.say, draft.writer, draft.model
    draft.heading(2, say("h_parameters"))
    rows: list[tuple[Text, ...]] = []
    for c in model.coordinates:
        if isinstance(c, Coordinate):
            rows.append((math(writer.symbol(c.symbol)), plain(c.description), plain(c.unit or "1")))
        else:
            letters = math(r",\, ".join([writer.symbol(x) for x in c.symbols]))
            rates = math(r",\, ".join([writer.symbol(x) for x in c.rate_symbols]))
            rows.append(
                (
                    letters,
                    joined([plain(c.description)] * bool(c.description) + [say("orientation", rates)], ": "),
                    plain("1"),
                )
            )
    if any(meaning for _, meaning, _ in rows if any(span.text for span in meaning)):
        head = tuple([say(key) for key in ("parameter", "meaning", "unit")])
        draft.blocks.append(Table((head, *rows)))
    else:
        draft.paragraph(joined([(*letters, *plain(f" ({unit[0].text})")) for letters, _, unit in rows], ", "))
    _write_speeds(draft)
    if model.bodies:
        _write_count_of_free(draft)


def _write_speeds(draft: Draft) -> None:
    """Define the declared speeds, and the rates by them."""
    model, writer, rates = draft.model, draft.writer, draft.rates
    if not model.speeds:
        return
    spelt = rates.in_rates([speed.expression for speed in model.speeds])
    draft.paragraph(draft.say("speeds"))
    draft.formula(*[FormulaRow(writer.symbol(s.symbol), writer.lines(x, f"speed {s.name}"))
                    for s, x in zip(model.speeds, spelt)])  # fmt: skip
    draft.paragraph(draft.say("rates_of_speeds"))
    solved = [(rate, x) for rate, x in rates.declared.rates.items() if rate != x]
    draft.formula(
        *[FormulaRow(writer.symbol(r), writer.lines(x, f"rate {r.record.name}")) for r, x in solved]
    )


def _write_count_of_free(draft: Draft) -> None:
    say, bodies, n = draft.say, draft.model.bodies, len(draft.rates.symbols)
    kinds = [
        say("particle_3" if b.frame is None else "solid_6", math(draft.writer.name(b.name))) for b in bodies
    ]
    free, each = sum(3 if b.frame is None else 6 for b in bodies), joined(kinds, "; ")
    if free == n:
        draft.paragraph(say("free_all", str(free), each))
    elif free < n:  # a coordinate of what has no mass
        draft.paragraph(say("free_more", str(free), each, str(n)))
    else:
        draft.paragraph(say("free_count", str(free), each, str(n), str(free - n)))
        found = implicit_constraints(draft)
        if found:
            draft.blocks.append(ItemList(tuple([x.text for x in found])))


def write_constraints(draft: Draft) -> None:
    """Write the explicit constraints, their kinds, and their rates in the form a_kj q_j' + b_k = 0."""
    draft.heading(2, draft.say("h_constraints"))
    equations = draft.equations
    if not equations.rows and not equations.contacts:
        draft.paragraph(draft.say("none_explicit"))
    kinds = {kind.label: kind for kind in draft.analysis.constraints}
    for row in equations.rows:
        _write_row(draft, row, kinds[row.label])
    for reason in equations.dropped:
        draft.paragraph(plain(reason.replace("`", "")))
    for contact in equations.contacts:
        _write_contact(draft, contact)


def _write_row(draft: Draft, row: Row, kind: RowKind) -> None:
    say, writer = draft.say, draft.writer
    word = (
        "holonomic"
        if row.holonomic
        else {True: "integrable", False: "nonholonomic"}.get(kind.integrable, "velocity_row")
    )
    side = _side(draft, row)
    words = [word, "rheonomic" if row.time_dependent else "scleronomic", *([side] if side else [])]
    draft.paragraph((*bold(row.label), *plain(": "), *joined([say(key) for key in words], ", ")))
    if row.holonomic:
        draft.formula(FormulaRow("", writer.lines(row.residual, row.label), " = 0"))
        draft.paragraph(say("its_rate", math(r"a_{kj}\,\dot q_j + b_k = 0")))
    draft.formula(_rate_row(draft, row, " = 0"))


def _rate_row(draft: Draft, row: Row | ContactRow, relation: str) -> FormulaRow:
    leading = [draft.writer.algebra.symbol(v) for v in draft.rates.symbols]
    rate = draft.rates.in_rates_and_speeds(row.rate)
    return FormulaRow("", draft.writer.lines(rate, f"rate of {row.label}", leading), relation)


def _side(draft: Draft, row: Row) -> str:
    """Return "exterior" where one body alone is moved, "interior" where several are: the constraint is between
    them if its gradient does not vanish on one of them alone."""
    rates = [
        v for j, v in enumerate(draft.rates.symbols) if j in draft.rates.along(draft.graph.one, row.rate)
    ]
    moving = [
        b for b in draft.model.bodies if depends([*b.velocity, *(b.frame.spin if b.frame else ())], rates)
    ]
    return "exterior" if len(moving) == 1 else ""


def _write_contact(draft: Draft, contact: ContactRow) -> None:
    say, writer = draft.say, draft.writer
    rubs = say("with_friction" if contact.slips else "without_friction")
    kind = say("always_closed") if contact.normals else say("one_sided", rubs)
    draft.paragraph((*bold(contact.label), *plain(": "), *kind))
    if not contact.normals:
        draft.formula(FormulaRow("", writer.lines(contact.gap, contact.label), r" \ge 0"))
        draft.paragraph(say("its_rate", math(r"a_{kj}\,\dot q_j + b_k \ge 0")))
        draft.formula(_rate_row(draft, contact, r" \ge 0"))
    if contact.slips:
        draft.paragraph(say("slip"))
        draft.formula(*slip_rows(draft, contact))


def slip_rows(draft: Draft, contact: ContactRow) -> list[FormulaRow]:
    """Return the definitions of the slips of a contact; one that is a rate itself needs no letter."""
    from lagc.reports.names import slip_speeds

    leading = [draft.writer.algebra.symbol(v) for v in draft.rates.symbols]
    found = []
    for speed, slip in zip(slip_speeds(contact), contact.slips):
        rate = draft.rates.in_rates_and_speeds(slip.rate)
        lines = draft.writer.lines(rate, f"slip of {contact.label}", leading)
        found.append(FormulaRow("" if speed == slip.rate else draft.writer.symbol(speed), lines))
    return found


def write_count(draft: Draft) -> None:
    """Count unknowns and equations: n + p, of one contact by its modes."""
    say, n, p = draft.say, len(draft.equations.v), len(draft.equations.rows)
    draft.heading(2, say("h_count"))
    contacts = draft.equations.contacts
    if len(contacts) == 1 and not contacts[0].normals:
        (contact,) = contacts
        closed, conjunction = say("closed"), plain(f" {say.word('and')} ")
        slips = (*closed, *conjunction, *say("slips")) if contact.slips else closed
        rows: list[tuple[Text, Text]] = [(say("open"), _sum(n, p)), (slips, _sum(n, p + 1))]
        if contact.slips:
            rows.append(((*closed, *conjunction, *say("sticks")), _sum(n, p + 1 + len(contact.slips))))
        draft.blocks.append(Table(((say("mode_column"), math("n + p")), *rows)))
    else:
        freedom = say("dof", str(draft.analysis.degrees_of_freedom))
        draft.paragraph(
            (*math(f"n + p = {n} + {p}"), *plain(": "), *say("count_line"), *plain(" "), *freedom)
        )


def _sum(n: int, p: int) -> Text:
    return math(f"{n} + {p}")
