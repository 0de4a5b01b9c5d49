"""The section on conserved quantities."""

from __future__ import annotations

from lagc.mechanics.analysis.analysis import Conserved
from lagc.mechanics.balance.energy import BY_DEGREES, WHOLE
from lagc.reports.algebra.expansion import TooLarge
from lagc.reports.algebra.polynomials import NotFinite, frozen
from lagc.reports.derivation.document import FormulaRow, Text, bold, joined, plain
from lagc.reports.derivation.draft import Draft
from lagc.semantics.model import Lagrangian
from lagc.symbolic.graph import Node

CONSTANT = r" = \text{const}"


def write_conserved(draft: Draft) -> None:
    """Write the conserved quantities, equal ones once, and why they are so."""
    draft.heading(2, draft.say("h_conserved"))
    same: dict[object, list[Conserved]] = {}
    for quantity in draft.analysis.conserved:
        if not quantity.expression.is_zero:
            same.setdefault(_key(draft, quantity.expression), []).append(quantity)
    if not same:
        draft.paragraph(draft.say("nothing"))
    until = _until(draft)
    for found in same.values():
        title = joined([bold(x.name) for x in found], " = ")
        draft.paragraph(draft.say("conserved_line", title, _reason(draft, found[0]), until))
        draft.formula(_row(draft, found[0]))


def _key(draft: Draft, node: Node) -> object:
    try:
        return frozen(draft.writer.polynomial(node))
    except (TooLarge, NotFinite):
        return node


def _reason(draft: Draft, quantity: Conserved) -> Text:
    """Return the reason in the language of the solution, and whether it only seems so."""
    say, (kind, _, rest) = draft.say, quantity.name.partition("(")
    coordinate = rest.partition(")")[0]
    if kind in ("momentum", "angular_momentum"):
        reason = say("since_cyclic", bold(coordinate)) if coordinate else say(f"since_{kind}")
    else:
        reason = say("since_energy" if kind == "energy" else "since_jacobi")
    cut = (*plain(", "), *say("between_cuts")) if "atan2" in quantity.reason else ()
    return (*reason, *cut, *(() if quantity.proved else (*plain(" "), *say("seems"))))


def _until(draft: Draft) -> Text:
    """Return when it holds, if not always."""
    equations = draft.equations
    rough = [bool(c.normals) for c in equations.contacts]
    keys = ["between_events"] if any(w.changes for w in equations.whens) else []
    keys += ["while_open"] if not all(rough) else []
    keys += ["without_rubbing"] if any(rough) else []
    return tuple([span for key in keys for span in (*plain(", "), *draft.say(key))])


def _row(draft: Draft, quantity: Conserved) -> FormulaRow:
    """Return the quantity; the energy by its parts, a momentum as dK/dq' is written above."""
    equations, writer, rates = draft.equations, draft.writer, draft.rates
    free = any(isinstance(x, Lagrangian) for x in draft.model.actions)
    if equations.balance in (WHOLE, BY_DEGREES) and quantity.expression is equations.energy and not free:
        text = "K" if equations.balance == WHOLE else "K_2 - K_0"
        return FormulaRow("", (text + ("" if writer.is_zero(equations.potential) else " - U"),), CONSTANT)
    names = {
        f"momentum({equations.q_names[rates.states.place_of_q[q]]})": j for j, q in rates.positions.items()
    }
    about = f"conserved {quantity.name}"
    if quantity.name in names and not free and rates.declared.plain:
        lines = writer.lines(draft.momenta[names[quantity.name]], about, of=quantity.expression)
        return FormulaRow("", lines, CONSTANT)
    return FormulaRow("", writer.lines(quantity.expression, about), CONSTANT)
