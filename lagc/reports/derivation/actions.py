"""The sections on given actions and on the forces of constraints."""

from collections.abc import Sequence

from lagc.mechanics.formulation.equations import ContactRow, Law
from lagc.mechanics.formulation.equations import Row as Constraint
from lagc.reports.derivation.document import Row, Table, bold, math
from lagc.reports.derivation.draft import Draft
from lagc.reports.derivation.rates import Term
from lagc.reports.derivation.writer import broken, in_parentheses, seen_width, subscript, words
from lagc.reports.names import slip_speeds
from lagc.semantics.model import Dissipation, Force, Potential, Torque
from lagc.symbolic.graph import Node

POWER = r"\mathcal{P}^*"
SLOPES = (
    r"\frac{\partial \mathcal{L}}{\partial q_j} - \frac{d}{dt}\frac{\partial \mathcal{L}}{\partial \dot q_j}"
)
TABLE = 80  # characters of a row of the table of several constraints


def write_actions(draft: Draft) -> None:
    """Write the torsor of each action, its virtual power and its generalized forces, or its U."""
    draft.heading("h_actions")
    if not draft.model.actions:
        draft.paragraph("no_actions")
    # A term of the Lagrangian is kinetic, holds rates (then Q_j is its Euler-Lagrange expression), or is a
    # potential.
    with_rates = {x.name for x in draft.rates.free_terms}
    for action, term in zip(draft.model.actions, draft.rates.given_terms):
        name = bold(action.name)
        if isinstance(action, Potential):
            if action.gravity is None:
                draft.paragraph("potential", name)
            else:
                _write_weights(draft, action, *action.gravity)
            _write_function(draft, "U", -action.energy, term)
        elif isinstance(action, Force | Torque):
            _write_load(draft, action, term)
        elif isinstance(action, Dissipation):
            draft.paragraph("dissipation", name)
            _write_function(draft, "D", action.function, term)
        elif action.is_kinetic:
            draft.paragraph("kinetic_term", name)
        elif action.name in with_rates:
            draft.paragraph("free_term", name, math(SLOPES))
            _write_function(draft, r"\mathcal{L}", action.function, term)
        else:
            draft.paragraph("potential", name)
            _write_function(draft, "U", action.function, term)


def _write_function(draft: Draft, letter: str, function: Node, term: Term) -> None:
    (function,) = draft.rates.in_rates([function])
    draft.formula(
        draft.row(letter, function, f"{letter} of {term.name}"), *force_rows(draft, r"\hat Q", term)
    )


def _write_weights(draft: Draft, action: Potential, strength: Node, direction: Sequence[Node]) -> None:
    """Write the virtual power of the weights, m g d . V*, of the bodies that move along d."""
    writer, rates = draft.writer, draft.rates
    along, sign, terms = "".join(draft.vector(direction, "the direction of gravity")), "", list[str]()
    if along.startswith("-") and " " not in along[1:]:
        along, sign = along[1:], "-"
    for body in draft.model.bodies:
        fall = draft.graph.sum(x * d for x, d in zip(rates.virtual(body.velocity), direction))
        if not writer.is_zero(body.mass) and not writer.is_zero(fall):
            mass, g = (in_parentheses(writer.text(x, "a weight")) for x in (body.mass, strength))
            velocity = rf"\vec{{V}}^*({draft.centres[body.name]})"
            terms.append(rf"{sign}{mass} \, {g} \, {in_parentheses(along)} \cdot {velocity}")
    draft.paragraph("weight", bold(action.name))
    power = rates.virtual_power(action)
    draft.formula(
        Row(POWER, broken(terms or ["0"])),
        draft.row("=", power, f"virtual power of {action.name}", stars=True),
    )
    draft.paragraph("has_function")


def _write_load(draft: Draft, action: Force | Torque, term: Term) -> None:
    """Write the torsor of a force at its point, or of a couple, its virtual power and its Q_j."""
    rates, name = draft.rates, action.name
    # A load that holds a constraint is its vector times a multiplier.
    factor = rates.actuators.get(name, draft.graph.one)
    vector = draft.vector([factor * x for x in rates.in_rates(action.vector)], name)
    if isinstance(action, Force):
        at = _place(draft, action)
        draft.paragraph("torsor", bold(name), math(at))
        star = draft.vector(rates.virtual(action.velocity), f"virtual velocity of {name}", stars=True)
        velocity, product = rf"\vec{{V}}^*({at})", rf"\vec{{R}} \cdot \vec{{V}}^*({at})"
        couple = rf", \qquad \vec{{M}}({at}) = \vec{{0}}"
        draft.formula(Row(r"\vec{R}", vector, couple), Row(velocity, star))
    else:
        draft.paragraph("couple", bold(name), math(subscript(action.frame.name)))
        omega = draft.omega(action.frame, "^*")
        if action.reaction is not None:
            omega = rf"\left({omega} - {draft.omega(action.reaction, '^*')}\right)"
        product = rf"\vec{{M}} \cdot {omega}"
        draft.formula(Row("", (r"\vec{R} = \vec{0}, \qquad \vec{M} = " + vector[0], *vector[1:])))
    power = draft.row(
        f"{POWER} = {product}", rates.virtual_power(action), f"virtual power of {name}", stars=True
    )
    draft.formula(power, *force_rows(draft, r"\hat Q", term))


def _place(draft: Draft, action: Force) -> str:
    """Return the letters of the point of a force, or its words."""
    text = action.target.text if action.target is not None else "P"
    if text in [*(p.name for p in draft.model.points), *(b.name for b in draft.model.bodies)]:
        return draft.centres.get(text, draft.writer.name(text))
    return rf"\text{{{words(text)}}}"


def force_rows(draft: Draft, letter: str, term: Term) -> list[Row]:
    """Return a row Q_j = ... for each rate along which a term acts."""
    acting = [(j, force) for j, force in sorted(term.forces.items()) if not draft.writer.is_zero(force)]
    rows = [draft.row(f"{letter}_{{{index(draft, j)}}}", x, f"Q of {term.name}") for j, x in acting]
    return rows or [Row(f"{letter}_j", ("0",))]


def index(draft: Draft, j: int) -> str:
    """Return the letters of the coordinate of a rate, or of the rate of an orientation."""
    return draft.writer.symbol(draft.rates.positions.get(j, draft.rates.symbols[j]))


# -- forces of constraints --------------------------------------------------------------------------


def write_forces(draft: Draft) -> None:
    """Write the generalized forces of constraints: lambda_k a_kj of perfect ones, the law of others."""
    rows, symbol = draft.equations.rows, draft.writer.symbol
    draft.heading("h_forces")
    draft.paragraph("implicit_perfect", math(r"\tilde Q_j = 0"))
    # Several perfect constraints are a table of a_kj where that is no wider than a page, else a paragraph
    # each.
    terms = {term.name: term for term in draft.rates.reactions if term.kind == "perfect"}
    table = _table(draft, [row for row in rows if row.law is Law.PERFECT])
    if table is not None:
        draft.paragraph("explicit_table", math(r"\tilde Q_j = \sum_k \lambda_k\, a_{kj}"))
        draft.blocks.append(table)
    actuators = {c.labels[0]: c.actuator for c in draft.model.constraints if c.actuator}
    for row in rows:
        if row.law is Law.SERVO:
            draft.paragraph("servo", bold(row.label), bold(actuators[row.label]))
        elif table is None:
            draft.paragraph("explicit_perfect", bold(row.label), math(symbol(row.multiplier)))
            draft.formula(*force_rows(draft, r"\tilde Q", terms[row.label]))
    for contact in draft.equations.contacts:
        if not contact.normals:
            draft.paragraph("contact_push", bold(contact.label), math(rf"{symbol(contact.multiplier)} \ge 0"))
            draft.formula(*force_rows(draft, r"\tilde Q", terms[contact.label]))
        if contact.slips:
            draft.paragraph("contact_rubs", math(", ".join([symbol(slip.force) for slip in contact.slips])))
            own = [t for t in draft.rates.reactions if t.name == contact.label and t.kind == "imperfect"]
            draft.formula(*[row for term in own for row in force_rows(draft, r"\tilde Q^{im}", term)])
        draft.paragraph("law_of")
        head = (draft.say("mode_column"), draft.say("law_column"))
        draft.blocks.append(Table((head, *[(mode, math(law)) for mode, law in _laws(draft, contact)])))


def _table(draft: Draft, rows: Sequence[Constraint]) -> Table | None:
    """Return the coefficients a_kj of several constraints, where their rows are no wider than a page."""
    writer, graph, count = draft.writer, draft.graph, range(len(draft.rates.symbols))
    if len(rows) < 2 or len(count) > TABLE // 4:
        return None
    found = [[math("a_{kj}"), *[math(index(draft, j)) for j in count]]]
    for row in rows:
        slopes = draft.rates.along(graph.one, row.rate)
        cells = [writer.text(slopes.get(j, graph.zero), f"a of {row.label}") for j in count]
        if sum(seen_width(cell) + 4 for cell in cells) > TABLE:
            return None
        found.append([f"{math(writer.symbol(row.multiplier))} ({row.label})", *map(math, cells)])
    return Table(tuple([tuple(row) for row in found]))


def _laws(draft: Draft, contact: ContactRow) -> list[tuple[str, str]]:
    """Return the law of a contact by mode (C. A. Coulomb, 1785)."""
    say, writer = draft.say, draft.writer
    push = writer.symbol(contact.multiplier)
    if not contact.slips:
        gap = writer.text(contact.gap, f"gap of {contact.label}")
        return [(say("open"), rf"{gap} > 0,\ {push} = 0"), (say("closed"), rf"{gap} = 0,\ {push} \ge 0")]
    # |F| <= mu_s N while it sticks, F = -mu N u/|u| while it slips; in one direction |F| and sgn u.
    speeds = [writer.symbol(speed) for speed in slip_speeds(contact)]
    forces = [writer.symbol(slip.force) for slip in contact.slips]
    sliding, sticking = (
        in_parentheses(writer.text(x, f"friction of {contact.label}")) for x in contact.frictions
    )
    if len(speeds) == 1:
        size, along = rf"\left|{forces[0]}\right|", [rf"\operatorname{{sgn}} {speeds[0]}"]
    else:
        size, speed = (rf"\sqrt{{{' + '.join([f'{{{x}}}^2' for x in own])}}}" for own in (forces, speeds))
        along = [rf"\frac{{{u}}}{{{speed}}}" for u in speeds]
    slips = r",\ ".join([rf"{f} = -{sliding}\,{push}\,{u}" for f, u in zip(forces, along)])
    zeros = "".join([rf"{u} = 0,\ " for u in speeds])
    closed = ("closed",) if not contact.normals else ()
    opens = [(say("open"), rf"{push} = 0,\ {', '.join(forces)} = 0")] if closed else []
    sticks = (say.all_of(*closed, "sticks"), rf"{zeros}{size} \le {sticking}\,{push}")
    return [*opens, sticks, (say.all_of(*closed, "slips"), slips)]
