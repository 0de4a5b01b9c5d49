"""The sections on conserved quantities and on reactions.

Where M is diagonal and there are one or two multipliers, a person solves for them:

    (G M^-1 D) lambda = gamma - G M^-1 (tau - h)

with D the directions in which the forces act: the gradients of perfect constraints, and of a contact that
slips the normal less mu sgn(u) of the slip.
"""

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import NamedTuple

from lagc.mechanics.analysis.analysis import Conserved
from lagc.mechanics.balance.energy import BY_DEGREES, WHOLE
from lagc.mechanics.formulation.equations import Law
from lagc.reports.algebra.expansion import TooLarge
from lagc.reports.algebra.polynomials import Exponent, NotFinite, Polynomial, frozen
from lagc.reports.algebra.trigonometric_identities import shorten
from lagc.reports.derivation.document import Row, bold
from lagc.reports.derivation.draft import Draft
from lagc.reports.names import slip_speeds
from lagc.reports.patterns.formula_trees import Term, Total
from lagc.semantics.model import Lagrangian
from lagc.symbolic.graph import Node
from lagc.symbolic.walk import symbols

MULTIPLIERS, TERMS = 2, 40  # that are solved for; terms of a solution that is written


def write_conserved(draft: Draft) -> None:
    """Write the conserved quantities, equal ones once, and why they are so."""
    draft.heading("h_conserved")
    same: dict[object, list[Conserved]] = {}
    for quantity in draft.analysis.conserved:
        if not quantity.expression.is_zero:
            same.setdefault(_key(draft, quantity.expression), []).append(quantity)
    if not same:
        draft.paragraph("nothing")
    equations = draft.equations
    rough = [bool(c.normals) for c in equations.contacts]
    until = ["between_events"] if any(w.changes for w in equations.whens) else []
    until += [] if all(rough) else ["while_open"]
    until += ["without_rubbing"] if any(rough) else []
    for found in same.values():
        title, reason = " = ".join([bold(x.name) for x in found]), _reason(draft, found[0])
        draft.paragraph("conserved_line", title, ", ".join([reason, *map(draft.say, until)]))
        draft.formula(_conserved_row(draft, found[0]))


def _key(draft: Draft, node: Node) -> object:
    try:
        return frozen(draft.writer.polynomial(node))
    except (TooLarge, NotFinite):
        return node


def _reason(draft: Draft, quantity: Conserved) -> str:
    """Return the reason in the language of the solution, and whether it only seems so."""
    kind, _, rest = quantity.name.partition("(")
    coordinate = rest.partition(")")[0]
    keys = {
        "energy": "since_energy",
        "momentum": "since_momentum",
        "angular_momentum": "since_angular_momentum",
    }
    reason = (
        draft.say("since_cyclic", bold(coordinate))
        if coordinate
        else draft.say(keys.get(kind, "since_jacobi"))
    )
    reason += f", {draft.say('between_cuts')}" if "atan2" in quantity.reason else ""
    return reason if quantity.proved else f"{reason} {draft.say('seems')}"


def _conserved_row(draft: Draft, quantity: Conserved) -> Row:
    """Return the quantity; the energy by its parts, a momentum as dK/dq' is written above."""
    equations, rates, constant = draft.equations, draft.rates, r" = \text{const}"
    free = any(isinstance(x, Lagrangian) for x in draft.model.actions)
    if quantity.expression is equations.energy and equations.balance in (WHOLE, BY_DEGREES) and not free:
        text = "K" if equations.balance == WHOLE else "K_2 - K_0"
        return Row("", (text + ("" if draft.writer.is_zero(equations.potential) else " - U"),), constant)
    names = {f"momentum({q.record.name})": j for j, q in rates.positions.items()}
    about, own = f"conserved {quantity.name}", names.get(quantity.name)
    if own is None or free or not rates.declared.plain:
        return draft.row("", quantity.expression, about, constant)
    return Row("", draft.writer.lines(draft.momenta[own], about, of=quantity.expression), constant)


# -- reactions ----------------------------------------------------------------------------------------


class Held(NamedTuple):
    """A row G a = `bias` that holds, and the force along `direction` that holds it."""

    gradient: Mapping[int, Node]
    bias: Node
    direction: Mapping[int, Node]
    force: Node


def write_reactions(draft: Draft) -> None:
    """Write the outputs that hold multipliers, and the multipliers where they are short."""
    equations = draft.equations
    forces = {*equations.lam, *(f for c in equations.contacts for f in c.forces)}
    asked = [output for output in equations.outputs if symbols([output.expression]) & forces]
    rows = [draft.row(draft.writer.name(x.name), x.expression, f"output {x.name}") for x in asked]
    solved = [(title, own) for title, held in _modes(draft) if (own := _solved(draft, held))]
    if rows or solved:
        draft.heading("h_reactions")
    if rows:
        draft.formula(*rows)
    if solved:
        draft.paragraph("reaction_solved")
    for title, own in solved:
        if title:
            draft.paragraph("mode", title)
        draft.formula(*own)


def _modes(draft: Draft) -> list[tuple[str, list[Held]]]:
    """Return the rows that hold in each mode of the model; none where M is not diagonal."""
    equations, say = draft.equations, draft.say
    # By hand M^-1 is written where M is diagonal, and for one contact, whose modes are few.
    diagonal = all(i == j for i, j in equations.mass_matrix) and len(equations.mass_matrix) == len(
        equations.v
    )
    servo = any(row.law is Law.SERVO for row in equations.rows)
    contacts = equations.contacts
    if not diagonal or servo or equations.unit_pivots or len(contacts) > 1:
        return []
    always = [Held(row.jacobian, row.gamma, row.jacobian, row.multiplier) for row in equations.rows]
    if not contacts:
        return [("", always)]
    (contact,) = contacts
    if contact.normals or len(contact.slips) > 1:
        return []
    normal = Held(contact.jacobian, -contact.bias, contact.jacobian, contact.multiplier)
    if not contact.slips:
        return [(say("closed"), [*always, normal])]
    (slip,), (speed,) = contact.slips, slip_speeds(contact)
    if speed != slip.rate:
        draft.writer.meanings.setdefault(speed, slip.rate)
    # While it slips, friction is -mu sgn(u) times the normal force, so one unknown acts along both
    # directions.
    along, friction = dict(contact.jacobian), -(contact.frictions[0] * draft.graph.unary("sign", speed))
    for j, slope in slip.jacobian.items():
        along[j] = along.get(j, draft.graph.zero) + friction * slope
    sticks = Held(slip.jacobian, -slip.bias, slip.jacobian, slip.force)
    return [
        (say.all_of("closed", "sticks"), [*always, normal, sticks]),
        (say.all_of("closed", "slips"), [*always, normal._replace(direction=along)]),
    ]


def _solved(draft: Draft, rows: Sequence[Held]) -> list[Row]:
    """Return a row for each force, by Cramer's rule; none where it is long."""
    graph, equations = draft.graph, draft.equations
    mass, applied = {i: m for (i, _), m in equations.mass_matrix.items()}, equations.applied_forces
    if not 1 <= len(rows) <= MULTIPLIERS or symbols(applied) & {row.force for row in rows}:
        return []

    def product(left: Mapping[int, Node], right: Mapping[int, Node]) -> Node:
        return graph.sum(g * right[j] / mass[j] for j, g in left.items() if j in right)

    # G M^-1 D and gamma - G M^-1 (tau - h), by Cramer for one or two unknowns.
    A = [[product(row.gradient, each.direction) for each in rows] for row in rows]
    b = [row.bias - product(row.gradient, dict(enumerate(applied))) for row in rows]
    quotients = [(b[0], A[0][0])]
    if len(rows) == 2:
        determinant = A[0][0] * A[1][1] - A[0][1] * A[1][0]
        tops = (b[0] * A[1][1] - A[0][1] * b[1], A[0][0] * b[1] - A[1][0] * b[0])
        quotients = [(top, determinant) for top in tops]
    try:
        return [_quotient_row(draft, row.force, *pair) for row, pair in zip(rows, quotients)]
    except (TooLarge, NotFinite):
        return []


def _quotient_row(draft: Draft, force: Node, top: Node, bottom: Node) -> Row:
    """Return force = top/bottom with common factors cancelled. Raises TooLarge beyond `TERMS`."""
    writer, algebra, least = draft.writer, draft.writer.algebra, dict[int, Exponent]()
    # Above and below are multiplied by the powers that leave no fraction within, then by what they share.
    pair = writer.polynomials([top, bottom])
    for atom, e in [factor for p in pair for monomial in p for factor in monomial]:
        least[atom] = min(least.get(atom, 0), e, 0)
    clear: Polynomial = {tuple(sorted([(a, -e) for a, e in least.items() if e])): Fraction(1)}
    above, below = (shorten(algebra, algebra.multiply(p, clear)) for p in pair)
    if not below or len(above) + len(below) > TERMS:
        raise TooLarge
    c, common, rest = algebra.content(below)
    own, shared, inner = algebra.content(above) if above else (Fraction(0), (), {})
    sign = 1 if inner == rest else -1 if inner == {m: -x for m, x in rest.items()} else 0
    if len(rest) > 1 and sign:  # both sides have the same sum as a factor
        above, rest = {shared: own * sign}, {(): Fraction(1)}
    if 2 * sum(x < 0 for x in rest.values()) > len(rest):
        above, rest = ({m: -x for m, x in p.items()} for p in (above, rest))
    over = writer.factored(algebra.multiply(above, algebra.power({common: c}, -1)))
    if len(rest) > 1:
        over = Total((Term(False, 1, ((over, 1), (writer.total(rest), -1))),))
    return Row(writer.symbol(force), writer.shown(over, f"{force.record.name} solved", top / bottom))
