"""Which affine velocity rows are in fact integrable: Frobenius' theorem, asked at random states.

A form w that is closed along some forms, dw(X, Y) = 0 for all X, Y that they all annul, for every
one of them, restricts positions after all (F. W. Warner, *Foundations of Differentiable Manifolds
and Lie Groups*, th. 2.32).  Asked of a row alone, of a row with the holonomic ones, and of all rows
together; whether their combinations bring more is asked of the brackets of the motions left.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from lagc.expr.evaluate import evaluate
from lagc.expr.graph import Node
from lagc.mechanics.brackets import relations
from lagc.mechanics.equations import Row
from lagc.mechanics.forms import Form, exact_form, places, unit_forms, velocity_form
from lagc.mechanics.linear import null_space
from lagc.mechanics.samples import samples
from lagc.mechanics.states import States
from lagc.records import dataclass

_STATES = 3
_CLOSED = 1e-9  # relative; what cancels leaves about 1e-16


@dataclass(frozen=True, slots=True)
class Integrable:
    """Label -> why, of the integrable rows; and how many more relations between positions their
    combinations bring."""

    rows: dict[str, str]
    combinations: int


def integrable_rows(states: States, rows: Sequence[Row]) -> Integrable:
    """The affine velocity rows among `rows` that restrict positions."""
    asked = [row for row in rows if row.kind == "velocity" and row.linear]
    if not asked:
        return Integrable({}, 0)
    forms = {row.label: velocity_form(states, row) for row in asked}
    holonomic = [exact_form(states, row.residual) for row in rows if row.kind == "holonomic"]
    units = unit_forms(states)
    tries = list(samples(states.model, _STATES))
    found: dict[str, str] = {}
    for label, form in forms.items():
        if _is_closed([form], [form, *units], tries):
            found[label] = "on its own it is the rate of a relation between positions"
        elif holonomic and _is_closed([form], [form, *units, *holonomic], tries):
            found[label] = "with the holonomic rows it is the rate of a relation between positions"
    others = [form for label, form in forms.items() if label not in found]
    everything = [*forms.values(), *units, *holonomic]
    all_affine = len(asked) == sum(row.kind == "velocity" for row in rows)
    if len(others) > 1 and all_affine and _is_closed(others, everything, tries):
        reason = "all rows together are the rates of relations between positions"
        found.update((label, reason) for label in forms if label not in found)
    more = 0
    if len(found) < len(asked) > 1 and tries:
        total = relations(states.graph, [*units, *holonomic, *forms.values()], tries[0])
        if total is not None:
            more = max(0, total - len(units) - len(holonomic) - len(found))
    return Integrable({label: found[label] for label in forms if label in found}, more)


def _is_closed(asked: Sequence[Form], along: Sequence[Form], tries: Sequence[Mapping[Node, float]]) -> bool:
    """dw(X, Y) = 0 for the `asked` forms, for all X, Y that the forms `along` annul."""
    where = places(along)
    column = {x: k for k, x in enumerate(where)}
    verdicts: list[bool] = []
    for state in tries:
        matrix = [_values(form.coefficients, state) for form in along]
        if not all(math.isfinite(e) for row in matrix for e in row.values()):
            continue
        basis = null_space([[row.get(x, 0.0) for x in where] for row in matrix], len(where))
        verdicts.append(all(_vanishes(form, state, basis, column) for form in asked))
    return bool(verdicts) and all(verdicts)


def _values(table: Mapping[Node, Node], state: Mapping[Node, float]) -> dict[Node, float]:
    return dict(zip(table, evaluate(list(table.values()), state)))


def _vanishes(
    form: Form, state: Mapping[Node, float], basis: Sequence[Sequence[float]], column: Mapping[Node, int]
) -> bool:
    """dw(X, Y) = sum of dA_x/dy (Y_x X_y - X_x Y_y) for all pairs of the basis."""
    values = evaluate(list(form.slopes.values()), state)
    entries = [(column[x], column[y], e) for (x, y), e in zip(form.slopes, values)]
    size = max((abs(e) for _, _, e in entries), default=0.0)
    for n, first in enumerate(basis):
        for second in basis[:n]:
            terms = [e * (second[x] * first[y] - first[x] * second[y]) for x, y, e in entries]
            reach = size * max(map(abs, first)) * max(map(abs, second))
            if abs(sum(terms)) > _CLOSED * reach:
                return False
    return True
