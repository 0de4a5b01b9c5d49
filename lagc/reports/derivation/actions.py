"""The sections on given actions and on the forces of constraints."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from lagc.mechanics.formulation.equations import ContactRow, Law, Row
from lagc.reports.derivation.document import FormulaRow, Table, Text, bold, math, plain
from lagc.reports.derivation.draft import Draft
from lagc.reports.derivation.rates import Term
from lagc.reports.derivation.writer import broken, in_parentheses, subscript, words
from lagc.reports.names import slip_speeds
from lagc.semantics.model import Dissipation, Force, Lagrangian, Potential, Torque
from lagc.symbolic.graph import Node

POWER, GIVEN = r"\mathcal{P}^*", r"\hat Q"
COLUMNS = 8  # rates beside which the forces of several constraints are one table


def write_actions(draft: Draft) -> None:
    """Write the torsor of each action, its virtual power and its generalized forces, or its U."""
    draft.heading(2, draft.say("h_actions"))
    if not draft.model.actions:
        draft.paragraph(draft.say("no_actions"))
    for action, term in zip(draft.model.actions, draft.rates.given):
        if isinstance(action, Potential):
            _write_potential(draft, action, term)
        elif isinstance(action, Force):
            _write_force(draft, action, term)
        elif isinstance(action, Torque):
            _write_torque(draft, action, term)
        elif isinstance(action, Dissipation):
            draft.paragraph(draft.say("dissipation", bold(action.name)))
            _write_function(draft, "D", action.function, term)
        else:
            _write_free_term(draft, action, term)


def _write_function(draft: Draft, letter: str, function: Node, term: Term) -> None:
    (function,) = draft.rates.in_rates([function])
    row = FormulaRow(letter, draft.writer.lines(function, f"{letter} of {term.name}"))
    draft.formula(row, *force_rows(draft, GIVEN, term))


def _write_free_term(draft: Draft, term: Lagrangian, forces: Term) -> None:
    say, name = draft.say, bold(term.name)
    if term.is_kinetic:
        draft.paragraph(say("kinetic_term", name))
    elif term.name in {x.name for x in draft.rates.free_terms}:
        law = r"\frac{\partial \mathcal{L}}{\partial q_j} - \frac{d}{dt}\frac{\partial \mathcal{L}}{\partial \dot q_j}"
        draft.paragraph(say("free_term", name, math(law)))
        _write_function(draft, r"\mathcal{L}", term.function, forces)
    else:
        draft.paragraph(say("potential", name))
        _write_function(draft, "U", term.function, forces)


def _write_potential(draft: Draft, action: Potential, term: Term) -> None:
    say, writer = draft.say, draft.writer
    if action.gravity is None:
        draft.paragraph(say("potential", bold(action.name)))
    else:
        power = draft.rates.virtual_power(action)
        draft.paragraph(say("weight", bold(action.name)))
        lines = writer.lines(power, f"virtual power of {action.name}", writer.stars)
        draft.formula(FormulaRow(POWER, _weights(draft, *action.gravity)), FormulaRow("=", lines))
        draft.paragraph(say("has_function"))
    _write_function(draft, "U", -action.energy, term)


def _weights(draft: Draft, strength: Node, direction: Sequence[Node]) -> tuple[str, ...]:
    """Return the virtual power of the weights, m g d . V*, of the bodies that move along d."""
    writer, terms = draft.writer, list[str]()
    along = "".join(draft.vector(direction, "the direction of gravity"))
    sign, axis = (
        ("-", along[1:])
        if along.startswith("-") and " + " not in along and " - " not in along
        else ("", along)
    )
    axis = in_parentheses(axis)
    for body in draft.model.bodies:
        star = draft.rates.virtual(body.velocity)
        fall = draft.graph.sum(x * d for x, d in zip(star, direction))
        if not writer.is_zero(body.mass) and not writer.is_zero(fall):
            mass, g = (in_parentheses(writer.text(x, "a weight")) for x in (body.mass, strength))
            velocity = draft.velocity_letters(draft.centres[body.name], "^*")
            terms.append(rf"{sign}{mass} \, {g} \, {axis} \cdot {velocity}")
    return broken(terms) if terms else ("0",)


def _write_force(draft: Draft, action: Force, term: Term) -> None:
    writer, rates = draft.writer, draft.rates
    at = _place(draft, action)
    draft.paragraph(draft.say("torsor", bold(action.name), math(at)))
    factor = rates.actuators.get(action.name, draft.graph.one)
    force = [factor * x for x in rates.in_rates(action.vector)]
    torsor = FormulaRow(
        r"\vec{R}", draft.vector(force, action.name), rf", \qquad \vec{{M}}({at}) = \vec{{0}}"
    )
    star = draft.vector(rates.virtual(action.velocity), f"virtual velocity of {action.name}", writer.stars)
    velocity = draft.velocity_letters(at, "^*")
    power = writer.lines(rates.virtual_power(action), f"virtual power of {action.name}", writer.stars)
    draft.formula(torsor, FormulaRow(velocity, star))
    draft.formula(
        FormulaRow(rf"{POWER} = \vec{{R}} \cdot {velocity}", power), *force_rows(draft, GIVEN, term)
    )


def _place(draft: Draft, action: Force) -> str:
    """Return the letters of the point of a force, or its words."""
    text = action.target.text if action.target is not None else "P"
    named = {x.name for x in (*draft.model.points, *draft.model.bodies)}
    if text in named:
        return draft.centres.get(text, draft.writer.name(text))
    return rf"\text{{{words(text)}}}"


def _write_torque(draft: Draft, action: Torque, term: Term) -> None:
    writer, rates = draft.writer, draft.rates
    frame = math(subscript(action.frame.name or "body"))
    draft.paragraph(draft.say("couple", bold(action.name), frame))
    omega = draft.rotation_letters(action.frame, "^*")
    if action.reaction is not None:
        omega = rf"\left({omega} - {draft.rotation_letters(action.reaction, '^*')}\right)"
    factor = rates.actuators.get(action.name, draft.graph.one)
    torque = draft.vector([factor * x for x in rates.in_rates(action.vector)], action.name)
    draft.formula(FormulaRow("", (r"\vec{R} = \vec{0}, \qquad \vec{M} = " + torque[0], *torque[1:])))
    power = writer.lines(rates.virtual_power(action), f"virtual power of {action.name}", writer.stars)
    draft.formula(FormulaRow(rf"{POWER} = \vec{{M}} \cdot {omega}", power), *force_rows(draft, GIVEN, term))


def force_rows(draft: Draft, letter: str, term: Term) -> list[FormulaRow]:
    """Return a row Q_j = ... for each rate along which a term acts."""
    rows = []
    for j, force in sorted(term.forces.items()):
        if not draft.writer.is_zero(force):
            rows.append(
                FormulaRow(
                    f"{letter}_{{{rate_index(draft, j)}}}", draft.writer.lines(force, f"Q of {term.name}")
                )
            )
    return rows or [FormulaRow(f"{letter}_j", ("0",))]


def rate_index(draft: Draft, j: int) -> str:
    """Return the letters of the coordinate of a rate, or of the rate of an orientation."""
    return draft.writer.symbol(draft.rates.positions.get(j, draft.rates.symbols[j]))


# -- forces of constraints --------------------------------------------------------------------------


def write_forces(draft: Draft) -> None:
    """Write the generalized forces of constraints: lambda_k a_kj of perfect ones, the law of others."""
    say, equations = draft.say, draft.equations
    draft.heading(2, say("h_forces"))
    draft.paragraph(say("implicit_perfect", math(r"\tilde Q_j = 0")))
    terms = {term.name: term for term in draft.rates.reactions if term.kind == "perfect"}
    perfect = [row for row in equations.rows if row.law is Law.PERFECT]
    tabled = len(perfect) > 1 and len(draft.rates.symbols) <= COLUMNS
    if tabled:
        _write_table(draft, perfect)
    actuators = {c.labels[0]: c.actuator for c in draft.model.constraints if c.actuator}
    for row in equations.rows:
        if row.law is Law.SERVO:
            draft.paragraph(say("servo", bold(row.label), bold(actuators.get(row.label, ""))))
        elif not tabled:
            draft.paragraph(
                say("explicit_perfect", bold(row.label), math(draft.writer.symbol(row.multiplier)))
            )
            draft.formula(*force_rows(draft, r"\tilde Q", terms[row.label]))
    for contact in equations.contacts:
        _write_contact(draft, contact, terms)


def _write_table(draft: Draft, rows: Sequence[Row]) -> None:
    """Write the coefficients a_kj of several constraints as one table."""
    writer, graph = draft.writer, draft.graph
    draft.paragraph(draft.say("explicit_table", math(r"\tilde Q_j = \sum_k \lambda_k\, a_{kj}")))
    head: tuple[Text, ...] = (
        math("a_{kj}"),
        *[math(rate_index(draft, j)) for j in range(len(draft.rates.symbols))],
    )
    found: list[tuple[Text, ...]] = [head]
    for row in rows:
        slopes = draft.rates.along(graph.one, row.rate)
        cells = [
            math(writer.text(slopes.get(j, graph.zero), f"a of {row.label}"))
            for j in range(len(draft.rates.symbols))
        ]
        found.append(((*math(writer.symbol(row.multiplier)), *plain(f" ({row.label})")), *cells))
    draft.blocks.append(Table(tuple(found)))


def _write_contact(draft: Draft, contact: ContactRow, terms: Mapping[str, Term]) -> None:
    """Write the forces of a contact and their law in each mode."""
    say, writer = draft.say, draft.writer
    push = writer.symbol(contact.multiplier)
    if not contact.normals:
        draft.paragraph(say("contact_push", bold(contact.label), math(rf"{push} \ge 0")))
        draft.formula(*force_rows(draft, r"\tilde Q", terms[contact.label]))
    if contact.slips:
        letters = ", ".join([writer.symbol(slip.force) for slip in contact.slips])
        draft.paragraph(say("contact_rubs", math(letters)))
        own = [t for t in draft.rates.reactions if t.name == contact.label and t.kind == "imperfect"]
        draft.formula(*[row for term in own for row in force_rows(draft, r"\tilde Q^{im}", term)])
    draft.paragraph(say("law_of"))
    head = (say("mode_column"), say("law_column"))
    draft.blocks.append(Table((head, *_laws(draft, contact))))


def _laws(draft: Draft, contact: ContactRow) -> list[tuple[Text, Text]]:
    """Return the law of a contact by mode (C. A. Coulomb, 1785)."""
    say, writer = draft.say, draft.writer
    push = writer.symbol(contact.multiplier)
    if not contact.slips:
        gap = writer.text(contact.gap, f"gap of {contact.label}")
        return [
            (say("open"), math(rf"{gap} > 0,\ {push} = 0")),
            (say("closed"), math(rf"{gap} = 0,\ {push} \ge 0")),
        ]
    speeds = [_slip_letters(draft, contact, k) for k in range(len(contact.slips))]
    forces = [writer.symbol(slip.force) for slip in contact.slips]
    sliding, sticking = (writer.text(x, f"friction of {contact.label}") for x in contact.frictions)
    size, speed = _length(forces), _length(speeds)
    laws = [
        rf"{f} = -{in_parentheses(sliding)}\,{push}\,\frac{{{u}}}{{{speed}}}" for f, u in zip(forces, speeds)
    ]
    closed = say("closed") if not contact.normals else ()
    conjunction = plain(f" {say.word('and')} ") if closed else ()
    found = [] if contact.normals else [(say("open"), math(rf"{push} = 0,\ {', '.join(forces)} = 0"))]
    sticks = math(rf"{', '.join(speeds)} = 0,\ {size} \le {in_parentheses(sticking)}\,{push}")
    found.append(((*closed, *conjunction, *say("sticks")), sticks))
    found.append(((*closed, *conjunction, *say("slips")), math(r",\ ".join(laws))))
    return found


def _slip_letters(draft: Draft, contact: ContactRow, k: int) -> str:
    speed = slip_speeds(contact)[k]
    return draft.writer.symbol(speed)


def _length(letters: Sequence[str]) -> str:
    if len(letters) == 1:
        return rf"\left|{letters[0]}\right|"
    squares = " + ".join([f"{{{x}}}^2" for x in letters])
    return rf"\sqrt{{{squares}}}"
