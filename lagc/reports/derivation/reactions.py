"""The section on reactions: outputs that ask for them, and multipliers solved for in each mode.

Where M is diagonal and there are one or two multipliers, a person solves for them:

    (G M^-1 D) lambda = gamma - G M^-1 (tau - h)

with D the directions in which the forces act: the gradients of perfect constraints, and of a contact that
slips the normal less mu sgn(u) of the slip.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction

from lagc.base.records import dataclass
from lagc.mechanics.formulation.equations import ContactRow, Law
from lagc.reports.algebra.expansion import TooLarge
from lagc.reports.algebra.polynomials import Exponent, NotFinite, Polynomial
from lagc.reports.algebra.trigonometric_identities import shorten
from lagc.reports.derivation.document import FormulaRow, Text, joined
from lagc.reports.derivation.draft import Draft
from lagc.reports.names import slip_speeds
from lagc.reports.patterns.formula_trees import Term, Total
from lagc.symbolic.graph import Node
from lagc.symbolic.walk import symbols

MULTIPLIERS = 2  # that are solved for
TERMS = 40  # of a solution that is written


@dataclass(frozen=True, slots=True)
class Held:
    """A row G a = `bias` that holds, and the force along `direction` that holds it."""

    gradient: Mapping[int, Node]
    bias: Node
    direction: Mapping[int, Node]
    force: Node


def write_reactions(draft: Draft) -> None:
    """Write the outputs that hold multipliers, and the multipliers where they are short."""
    say, writer, equations = draft.say, draft.writer, draft.equations
    forces = {*equations.lam, *(f for c in equations.contacts for f in c.forces)}
    rows = []
    for output in equations.outputs:
        if symbols([output.expression]) & forces:
            lines = writer.lines(output.expression, f"output {output.name}")
            rows.append(FormulaRow(writer.name(output.name), lines))
    solved = [(title, own) for title, held in _modes(draft) if (own := _solved(draft, held))]
    if rows or solved:
        draft.heading(2, say("h_reactions"))
    if rows:
        draft.formula(*rows)
    if solved:
        draft.paragraph(say("reaction_solved"))
    for title, own in solved:
        if title:
            draft.paragraph(say("mode", title))
        draft.formula(*own)


def _modes(draft: Draft) -> list[tuple[Text, list[Held]]]:
    """Return the rows that hold in each mode of the model; none where M is not diagonal."""
    equations, say = draft.equations, draft.say
    n = len(equations.v)
    diagonal = all(i == j for i, j in equations.mass_matrix) and len(equations.mass_matrix) == n
    if not diagonal or any(row.law is Law.SERVO for row in equations.rows) or equations.unit_pivots:
        return []
    always = [Held(row.jacobian, row.gamma, row.jacobian, row.multiplier) for row in equations.rows]
    if not equations.contacts:
        return [((), always)]
    if len(equations.contacts) > 1 or equations.contacts[0].normals:
        return []
    (contact,) = equations.contacts
    closed = Held(contact.jacobian, -contact.bias, contact.jacobian, contact.multiplier)
    if not contact.slips:
        return [(say("closed"), [*always, closed])]
    if len(contact.slips) > 1:
        return []
    (slip,) = contact.slips
    sticks = Held(slip.jacobian, -slip.bias, slip.jacobian, slip.force)
    conjunction = f" {say.word('and')} "
    return [
        (joined([say("closed"), say("sticks")], conjunction), [*always, closed, sticks]),
        (joined([say("closed"), say("slips")], conjunction), [*always, _slipping(draft, contact)]),
    ]


def _slipping(draft: Draft, contact: ContactRow) -> Held:
    """Return the row of a contact that slips: its friction is -mu lambda sgn(u) along the slip."""
    (slip,), (speed,) = contact.slips, slip_speeds(contact)
    if speed != slip.rate:
        draft.writer.meanings.setdefault(speed, slip.rate)
    factor = -(contact.frictions[0] * draft.graph.unary("sign", speed))
    along = dict(contact.jacobian)
    for j, slope in slip.jacobian.items():
        along[j] = along.get(j, draft.graph.zero) + factor * slope
    return Held(contact.jacobian, -contact.bias, along, contact.multiplier)


def _solved(draft: Draft, rows: Sequence[Held]) -> list[FormulaRow]:
    """Return a row for each force, none where it is long."""
    if not 1 <= len(rows) <= MULTIPLIERS:
        return []
    graph, equations = draft.graph, draft.equations
    mass = {i: m for (i, _), m in equations.mass_matrix.items()}
    applied = equations.applied_forces
    if symbols(applied) & {row.force for row in rows}:
        return []
    A = [[graph.sum(g * row.direction[j] / mass[j] for j, g in each.gradient.items() if j in row.direction)
          for row in rows] for each in rows]  # fmt: skip
    b = [each.bias - graph.sum(g * applied[j] / mass[j] for j, g in each.gradient.items()) for each in rows]
    if len(rows) == 1:
        quotients = [(b[0], A[0][0])]
    else:  # G. Cramer's rule
        determinant = A[0][0] * A[1][1] - A[0][1] * A[1][0]
        quotients = [
            (b[0] * A[1][1] - A[0][1] * b[1], determinant),
            (A[0][0] * b[1] - A[1][0] * b[0], determinant),
        ]
    try:
        return [_quotient_row(draft, row.force, *pair) for row, pair in zip(rows, quotients)]
    except (TooLarge, NotFinite):
        return []


def _quotient_row(draft: Draft, force: Node, top: Node, bottom: Node) -> FormulaRow:
    """Return force = top/bottom with common factors cancelled. Raises TooLarge beyond `TERMS`."""
    writer, algebra = draft.writer, draft.writer.algebra
    above, below = _without_denominators(draft, writer.polynomials([top, bottom]))
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
    lines = writer.shown(over, f"{force.record.name} solved", top / bottom)
    return FormulaRow(writer.symbol(force), lines)


def _without_denominators(draft: Draft, pair: Sequence[Polynomial]) -> tuple[Polynomial, Polynomial]:
    """Return both polynomials times the powers that stand below a line in either."""
    algebra, least = draft.writer.algebra, dict[int, Exponent]()
    for p in pair:
        for monomial in p:
            for atom, e in monomial:
                if e < 0:
                    least[atom] = min(least.get(atom, 0), e)
    clear: Polynomial = {tuple(sorted([(a, -e) for a, e in least.items()])): Fraction(1)}
    above, below = (shorten(algebra, algebra.multiply(p, clear)) for p in pair)
    return above, below
