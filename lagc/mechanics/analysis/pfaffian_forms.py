"""Affine velocity rows as Pfaffian forms, w = sum of A_i dq_i + b dt.

A quaternion's forms are in d(e): body rates are w = 2 E(e)^T e', and |e| = 1 is one more form.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from lagc.base.records import dataclass
from lagc.mechanics.formulation.equations import Row
from lagc.mechanics.formulation.states import States, quaternion_rate, rate_symbols
from lagc.mechanics.numeric.piecewise_branches import spelt_out
from lagc.semantics.model import Coordinate
from lagc.symbolic.derivative import gradient, seeds, tangent
from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.walk import substitute, symbols


@dataclass(frozen=True, slots=True)
class Form:
    """sum of coefficients[x] dx over positions x and time, and d(coefficients[x])/dy, by (x, y)."""

    coefficients: dict[Node, Node]
    slopes: dict[tuple[Node, Node], Node]
    is_unit: bool = False  # of the length of a quaternion

    @property
    def nodes(self) -> list[Node]:
        return [*self.coefficients.values(), *self.slopes.values()]


def spelt(graph: Graph, form: Form) -> Form:
    """Comparisons in the place of abs, sign, min, max."""
    nodes = iter(spelt_out(graph, form.nodes))
    coefficients = {x: next(nodes) for x in form.coefficients}
    return Form(coefficients, {pair: next(nodes) for pair in form.slopes}, form.is_unit)


def rate_coefficients(states: States, forces: Mapping[int, Node]) -> dict[Node, Node]:
    """Weights on the speeds, carried to the rates: rate -> sum of forces[j] dv_j/d(rate)."""
    spelt = states.in_rates([states.v[j] for j in forces])
    pairs = list(zip(spelt, forces.values()))
    return gradient(states.graph, seeds(states.graph, pairs), list(states.rates))


def velocity_form(states: States, row: Row) -> Form:
    """The form of an affine velocity row."""
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


def exact_form(states: States, position: Node) -> Form:
    """d(position)."""
    where = [*states.q, states.model.time]
    return Form(gradient(states.graph, {position: states.graph.one}, where), {})


def unit_forms(states: States) -> list[Form]:
    """d|e|^2 of each quaternion."""
    graph = states.graph
    norms = [graph.sum(states.q[i + k] ** 2 for k in range(4)) for i in states.quaternions]
    return [Form(exact_form(states, norm).coefficients, {}, is_unit=True) for norm in norms]


def places(forms: Sequence[Form]) -> list[Node]:
    """The positions (and time) that the forms speak of, in order."""
    met = {x for form in forms for x in form.coefficients}
    met |= {y for form in forms for _, y in form.slopes}
    return sorted(met, key=lambda x: x.index)


def _with_slopes(coefficients: dict[Node, Node]) -> Form:
    slopes: dict[tuple[Node, Node], Node] = {}
    for x, node in coefficients.items():
        leaves = [s for s in symbols([node]) if s.record.kind in ("coordinate", "time")]
        for y in sorted(leaves, key=lambda s: s.index):
            slope = tangent(node.graph, [node], {y: node.graph.one})[0]
            if not slope.is_zero:
                slopes[x, y] = slope
    return Form(coefficients, slopes)
