"""Which affine velocity rows are in fact integrable: Frobenius' theorem, asked at random states.

A row is the Pfaffian form w = sum of A_i dq_i + b dt.  With the forms of some rows, w is closed
along them, dw(X, Y) = 0 for all X, Y that they all annul, for every one of them, if and only if
they restrict positions after all (F. W. Warner, *Foundations of Differentiable Manifolds*, th.
2.32).  Asked of a row alone, of a row with the holonomic ones, and of all rows together.
A quaternion's forms are d(e): body rates are w = 2 E(e)^T e', and |e| = 1 is one more form.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from lagc.expr.derivative import gradient, tangent
from lagc.expr.evaluate import evaluate
from lagc.expr.graph import Node
from lagc.expr.walk import substitute, symbols
from lagc.meaning.model import Coordinate
from lagc.mechanics.equations import Row
from lagc.mechanics.linear import null_space
from lagc.mechanics.samples import samples
from lagc.mechanics.states import States, quaternion_rate, rate_symbols, seeds

_STATES = 3
_CLOSED = 1e-9  # relative; what cancels leaves about 1e-16


@dataclass(frozen=True, slots=True)
class Form:
    """sum of coefficients[x] dx over positions x and time, and d(coefficients[x])/dy, by (x, y)."""

    coefficients: dict[Node, Node]
    slopes: dict[tuple[Node, Node], Node]


def integrable_rows(states: States, rows: Sequence[Row]) -> dict[str, str]:
    """Label -> why, of the affine velocity rows that are integrable."""
    asked = [row for row in rows if row.kind == "velocity" and row.linear]
    if not asked:
        return {}
    forms = {row.label: _form(states, row) for row in asked}
    closed = [_exact(states, row.residual) for row in rows if row.kind == "holonomic"]
    graph = states.graph
    norms = [graph.sum(states.q[i + k] ** 2 for k in range(4)) for i in states.quaternions]
    units = [_exact(states, norm) for norm in norms]
    tries = list(samples(states.model, _STATES))
    found: dict[str, str] = {}
    for label, form in forms.items():
        if _is_closed([form], [form, *units], tries):
            found[label] = "on its own it is the rate of a relation between positions"
        elif closed and _is_closed([form], [form, *units, *closed], tries):
            found[label] = "with the holonomic rows it is the rate of a relation between positions"
    others = [form for label, form in forms.items() if label not in found]
    everything = [*forms.values(), *units, *closed]
    all_affine = len(asked) == sum(row.kind == "velocity" for row in rows)
    if len(others) > 1 and all_affine and _is_closed(others, everything, tries):
        reason = "all rows together are the rates of relations between positions"
        found.update((label, reason) for label in forms if label not in found)
    return {label: found[label] for label in forms if label in found}


def rate_coefficients(states: States, forces: Mapping[int, Node]) -> dict[Node, Node]:
    """Weights on the speeds, carried to the rates: rate -> sum of forces[j] dv_j/d(rate)."""
    spelt = states.in_rates([states.v[j] for j in forces])
    pairs = list(zip(spelt, forces.values()))
    return gradient(states.graph, seeds(states.graph, pairs), list(states.rates))


def _form(states: States, row: Row) -> Form:
    graph = states.graph
    weights = rate_coefficients(states, row.jacobian)
    coefficients: dict[Node, Node] = {}
    for c in states.model.coordinates:
        on_rates = [weights.get(rate, graph.zero) for rate in rate_symbols(c)]
        if isinstance(c, Coordinate):
            coefficients[c.symbol] = on_rates[0]
        else:
            turned = quaternion_rate(c.symbols, on_rates)
            coefficients.update(zip(c.symbols, [4.0 * x for x in turned]))
    coefficients[states.model.time] = substitute(graph, [row.rate], states.rest)[0]
    return _with_slopes({x: node for x, node in coefficients.items() if not node.is_zero})


def _exact(states: States, position: Node) -> Form:
    places = [*states.q, states.model.time]
    return Form(gradient(states.graph, {position: states.graph.one}, places), {})


def _with_slopes(coefficients: dict[Node, Node]) -> Form:
    slopes: dict[tuple[Node, Node], Node] = {}
    for x, node in coefficients.items():
        leaves = [s for s in symbols([node]) if s.value[0] in ("coordinate", "time")]
        for y in sorted(leaves, key=lambda s: s.index):
            slope = tangent(node.graph, [node], {y: node.graph.one})[0]
            if not slope.is_zero:
                slopes[x, y] = slope
    return Form(coefficients, slopes)


def _is_closed(asked: Sequence[Form], along: Sequence[Form], tries: Sequence[Mapping[Node, float]]) -> bool:
    """dw(X, Y) = 0 for the `asked` forms, for all X, Y that the forms `along` annul."""
    places = _places(along)
    column = {x: k for k, x in enumerate(places)}
    verdicts: list[bool] = []
    for state in tries:
        matrix = [_values(form.coefficients, state) for form in along]
        if not all(math.isfinite(e) for row in matrix for e in row.values()):
            continue
        basis = null_space([[row.get(x, 0.0) for x in places] for row in matrix], len(places))
        verdicts.append(all(_vanishes(form, state, basis, column) for form in asked))
    return bool(verdicts) and all(verdicts)


def _places(forms: Sequence[Form]) -> list[Node]:
    met = {x for form in forms for x in form.coefficients}
    met |= {y for form in forms for _, y in form.slopes}
    return sorted(met, key=lambda x: x.index)


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
