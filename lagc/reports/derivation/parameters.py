"""The sections on parameters and on explicit constraints, and the count of unknowns."""

from lagc.mechanics.analysis.analysis import RowKind
from lagc.mechanics.formulation.equations import ContactRow
from lagc.mechanics.formulation.equations import Row as Constraint
from lagc.reports.derivation.document import Items, Row, Table, bold, math
from lagc.reports.derivation.draft import Draft
from lagc.reports.derivation.implicit import implicit_constraints
from lagc.reports.names import slip_speeds
from lagc.semantics.model import Coordinate
from lagc.symbolic.walk import depends


def write_parameters(draft: Draft) -> None:
    """Name the parameters, and the implicit constraints that made them fewer."""
    say, symbol = draft.say, draft.writer.symbol
    draft.heading("h_parameters")
    rows = []
    for c in draft.model.coordinates:
        if isinstance(c, Coordinate):
            rows.append((math(symbol(c.symbol)), c.description, c.unit or "1"))
        else:
            letters, rates = (r",\, ".join(map(symbol, x)) for x in (c.symbols, c.rate_symbols))
            meaning = ": ".join([*[c.description] * bool(c.description), say("orientation", math(rates))])
            rows.append((math(letters), meaning, "1"))
    if any(meaning for _, meaning, _ in rows):
        draft.blocks.append(Table(((say("parameter"), say("meaning"), say("unit")), *rows)))
    else:
        draft.blocks.append(", ".join([f"{letters} ({unit})" for letters, _, unit in rows]))
    if draft.model.speeds:
        _write_speeds(draft)
    if draft.model.bodies:
        _write_count_of_free(draft)


def _write_speeds(draft: Draft) -> None:
    """Define the declared speeds, and the rates by them."""
    symbol, speeds = draft.writer.symbol, draft.model.speeds
    spelt = draft.rates.in_rates([speed.expression for speed in speeds])
    draft.paragraph("speeds")
    draft.formula(*[draft.row(symbol(u.symbol), x, f"speed {u.name}") for u, x in zip(speeds, spelt)])
    draft.paragraph("rates_of_speeds")
    solved = [(rate, x) for rate, x in draft.rates.declared.rates.items() if rate != x]
    draft.formula(*[draft.row(symbol(rate), x, f"rate {rate.record.name}") for rate, x in solved])


def _write_count_of_free(draft: Draft) -> None:
    bodies, n = draft.model.bodies, len(draft.rates.symbols)
    kinds = {True: "particle_3", False: "solid_6"}
    each = "; ".join([draft.say(kinds[b.frame is None], math(draft.writer.name(b.name))) for b in bodies])
    free = sum(3 if b.frame is None else 6 for b in bodies)
    if free == n:
        draft.paragraph("free_all", free, each)
    elif free < n:  # a coordinate of something without mass
        draft.paragraph("free_more", free, each, n)
    else:
        draft.paragraph("free_count", free, each, n, free - n)
        found = implicit_constraints(draft)
        draft.blocks += [Items(tuple([x.text for x in found]))] if found else []


def write_constraints(draft: Draft) -> None:
    """Write the explicit constraints, their kinds, and their rates in the form a_kj q_j' + b_k = 0."""
    equations = draft.equations
    draft.heading("h_constraints")
    if not equations.rows and not equations.contacts:
        draft.paragraph("none_explicit")
    kinds = {kind.label: kind for kind in draft.analysis.constraints}
    for row in equations.rows:
        _write_row(draft, row, kinds[row.label])
    draft.blocks += [reason.replace("`", "") for reason in equations.dropped]
    for contact in equations.contacts:
        _write_contact(draft, contact)


def _write_row(draft: Draft, row: Constraint, kind: RowKind) -> None:
    if row.holonomic:
        word = "holonomic"
    elif kind.integrable is None:
        word = "velocity_row"
    else:
        word = "integrable" if kind.integrable else "nonholonomic"
    words = [word, "rheonomic" if row.time_dependent else "scleronomic"]
    words += ["exterior"] if _moves_one_body(draft, row) else []
    draft.blocks.append(f"{bold(row.label)}: " + ", ".join(map(draft.say, words)))
    if row.holonomic:
        draft.formula(draft.row("", row.residual, row.label, " = 0"))
        draft.paragraph("its_rate", math(r"a_{kj}\,\dot q_j + b_k = 0"))
    _write_rate(draft, row, " = 0")


def _write_rate(draft: Draft, row: Constraint | ContactRow, relation: str) -> None:
    """Write the rate of a constraint or of a gap, gathered by the rates of coordinates."""
    writer = draft.writer
    leading = [writer.algebra.symbol(v) for v in draft.rates.symbols]
    (rate,) = draft.rates.in_rates([row.rate])
    draft.formula(Row("", writer.lines(rate, f"rate of {row.label}", leading), relation))


def _moves_one_body(draft: Draft, row: Constraint) -> bool:
    """Whether the rates that a constraint restricts move one body alone: it is exterior then."""
    forces = draft.rates.along(draft.graph.one, row.rate)
    rates = [v for j, v in enumerate(draft.rates.symbols) if j in forces]
    bodies = [(*b.velocity, *(b.frame.spin if b.frame is not None else ())) for b in draft.model.bodies]
    return len([body for body in bodies if depends(body, rates)]) == 1


def _write_contact(draft: Draft, contact: ContactRow) -> None:
    say = draft.say
    kind = say("one_sided", say("with_friction" if contact.slips else "without_friction"))
    draft.blocks.append(f"{bold(contact.label)}: {say('always_closed') if contact.normals else kind}")
    if not contact.normals:
        draft.formula(draft.row("", contact.gap, contact.label, r" \ge 0"))
        draft.paragraph("its_rate", math(r"a_{kj}\,\dot q_j + b_k \ge 0"))
        _write_rate(draft, contact, r" \ge 0")
    if contact.slips:
        draft.paragraph("slip")
        rates = draft.rates.in_rates([slip.rate for slip in contact.slips])
        letters = ["" if speed == slip.rate else draft.writer.symbol(speed)
                   for speed, slip in zip(slip_speeds(contact), contact.slips)]  # fmt: skip
        draft.formula(*[draft.row(u, rate, f"slip of {contact.label}") for u, rate in zip(letters, rates)])


def write_count(draft: Draft) -> None:
    """Count unknowns and equations: n + p, of one contact by its modes."""
    say, n, p = draft.say, len(draft.equations.v), len(draft.equations.rows)
    draft.heading("h_count")
    contacts = draft.equations.contacts
    if len(contacts) != 1 or contacts[0].normals:
        freedom = say("dof", draft.analysis.degrees_of_freedom)
        draft.blocks.append(f"{math(f'n + p = {n} + {p}')}: {say('count_line')} {freedom}")
        return
    slips = len(contacts[0].slips)
    rows = [(say("open"), p), (say.all_of("closed", "slips") if slips else say("closed"), p + 1)]
    rows += [(say.all_of("closed", "sticks"), p + 1 + slips)] if slips else []
    head = (say("mode_column"), math("n + p"))
    draft.blocks.append(Table((head, *[(mode, math(f"{n} + {p}")) for mode, p in rows])))
