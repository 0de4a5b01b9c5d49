"""Integrable velocity constraints.

Velocity rows restrict positions if their forms are closed along each other and the holonomic rows: dw(X, Y) =
0 for all X, Y that all of them annihilate (F. W. Warner, *Foundations of Differentiable Manifolds and Lie
Groups*, th. 2.32). The largest such set of rows is taken. All steps are linear algebra at points of a finite
field on the constraints, so no tolerance is involved.

Combinations of rows may restrict positions where no row does. They are in the first derived system: the w in
the span of all forms with dw = 0 on what all annihilate (R. L. Bryant et al., *Exterior Differential
Systems*, 1991, ch. II). Where this is larger than what the rows bring, the number of relations is not proved.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

from lagc.base.records import dataclass, field
from lagc.mechanics.formulation.equations import Row
from lagc.mechanics.formulation.states import States, quaternion_rate, rate_symbols
from lagc.mechanics.identities.sampling_domains import on_rows
from lagc.mechanics.identities.zero_test import ZeroTest, spelt_out
from lagc.semantics.model import Coordinate
from lagc.symbolic.derivative import gradient, seeds, tangent
from lagc.symbolic.finite_field import Echelon, Entries, P, Point, Undefined
from lagc.symbolic.graph import Node
from lagc.symbolic.walk import substitute, symbols


@dataclass(frozen=True, slots=True)
class Form:
    """sum of coefficients[x] dx over positions x and time, and d(coefficients[x])/dy, by (x, y)."""

    coefficients: dict[Node, Node]
    slopes: dict[tuple[Node, Node], Node]

    @property
    def nodes(self) -> list[Node]:
        return [*self.coefficients.values(), *self.slopes.values()]


@dataclass(frozen=True, slots=True)
class Integrable:
    """The reasons of the integrable rows by label; the number of relations between positions that they add to
    the holonomic rows, and whether it is `proved`; labels of rows that were not examined, and of those that
    may be integrable with combinations of others."""

    rows: dict[str, str] = field(default_factory=dict)
    relations: int = 0
    proved: bool = True
    open: tuple[str, ...] = ()
    doubtful: frozenset[str] = frozenset()


class _Verdict(NamedTuple):
    """The verdict of a point: the reasons of the integrable rows, the rows that may be integrable with
    combinations of others, the number of relations that the integrable rows add, and the most that all may
    add."""

    reasons: dict[str, str]
    doubtful: set[str]
    relations: int
    most: int


def rate_coefficients(states: States, forces: Mapping[int, Node]) -> dict[Node, Node]:
    """Return weights on the speeds, carried to the rates: rate -> sum of forces[j] dv_j/d(rate)."""
    spelt = states.in_rates([states.v[j] for j in forces])
    pairs = list(zip(spelt, forces.values()))
    return gradient(states.graph, seeds(states.graph, pairs), list(states.rates))


def _velocity_form(states: States, row: Row) -> Form:
    """Return the form of an affine velocity row in dq and dt."""
    graph = states.graph
    weights = rate_coefficients(states, row.jacobian)
    found: dict[Node, Node] = {}
    for c in states.model.coordinates:
        on_rates = [weights.get(rate, graph.zero) for rate in rate_symbols(c)]
        if isinstance(c, Coordinate):
            found[c.symbol] = on_rates[0]
        else:  # a rotation w in body axes has e' = 1/2 e*(0, w), and w = 2 conj(e)*e'
            found.update(zip(c.symbols, [4.0 * x for x in quaternion_rate(c.symbols, on_rates)]))
    found[states.model.time] = substitute(graph, [row.rate], states.rest)[0]
    coefficients = {x: node for x, node in found.items() if not node.is_zero}
    slopes: dict[tuple[Node, Node], Node] = {}
    for x, node in coefficients.items():
        leaves = [s for s in symbols([node]) if s.record.kind in ("coordinate", "time")]
        for y in sorted(leaves, key=lambda s: s.index):
            slope = tangent(node.graph, [node], {y: node.graph.one})[0]
            if not slope.is_zero:
                slopes[x, y] = slope
    return _spelt_out(states, Form(coefficients, slopes))


def _exact_form(states: States, position: Node) -> Form:
    """Return d(position)."""
    where = [*states.q, states.model.time]
    return _spelt_out(states, Form(gradient(states.graph, {position: states.graph.one}, where), {}))


def _spelt_out(states: States, form: Form) -> Form:
    """Return the form with comparisons in the place of abs, sign, min, max."""
    nodes = iter(spelt_out(states.graph, form.nodes))
    coefficients = {x: next(nodes) for x in form.coefficients}
    return Form(coefficients, {pair: next(nodes) for pair in form.slopes})


def integrable_rows(states: States, rows: Sequence[Row], tries: Sequence[Mapping[Node, float]]) -> Integrable:
    """Return the affine velocity rows among `rows` that restrict positions: those that do on every branch.
    The holonomic rows are independent; `tries` meet all rows."""
    graph = states.graph
    forms = {row.label: _velocity_form(states, row) for row in rows if not row.holonomic and row.linear}
    if not forms:
        return Integrable()
    lengths = [graph.sum(states.q[i + k] ** 2 for k in range(4)) for i in states.quaternions]
    units = [_exact_form(states, length) for length in lengths]
    holonomic = [_exact_form(states, row.residual) for row in rows if row.holonomic]
    test = _Closedness(forms, units, holonomic)
    verdicts: list[_Verdict] = []
    exact = True
    points = ZeroTest(on_rows(states, [row for row in rows if row.linear], tries)).points(test.nodes)
    for placed, truths in points:
        tried = 0
        for x in placed:
            try:
                verdicts.append(test.at(x.point, truths))
            except Undefined:
                continue
            exact = exact and x.met and x.point.exact and not x.point.rooted
            tried += 1
            if tried == 2:
                break
        if not tried:
            return Integrable(open=tuple(forms))
    common = set(forms).intersection(*(v.reasons for v in verdicts))
    doubtful = set().union(*(v.doubtful for v in verdicts)) if exact else set(forms)
    relations = min(v.relations for v in verdicts)
    proved = exact and relations == min(v.most for v in verdicts)
    reasons = {label: verdicts[0].reasons[label] for label in forms if label in common}
    return Integrable(reasons, relations, proved, doubtful=frozenset(doubtful))


class _Closedness:
    """The test of velocity forms by label, beside the exact ones of unit quaternions and holonomic rows."""

    def __init__(self, forms: dict[str, Form], units: Sequence[Form], holonomic: Sequence[Form]):
        self.forms, self.units, self.exact = forms, units, [*units, *holonomic]
        every = [*forms.values(), *self.exact]
        self.nodes = [node for form in every for node in form.nodes]
        places = {x for form in every for x in form.coefficients}
        places |= {y for form in every for _, y in form.slopes}
        self._column = {x: k for k, x in enumerate(sorted(places, key=lambda x: x.index))}

    def at(self, point: Point, truths: Mapping[Node, int]) -> _Verdict:
        """Return the verdict of a point. Raises Undefined."""
        self._values = {id(f): self._row(f, point, truths) for f in (*self.forms.values(), *self.exact)}
        inside = self._closed(self.forms, point, truths)
        alike = set(inside)
        while len(closed := self._closed(inside, point, truths)) < len(inside):
            inside = closed
        reasons = {label: self._reason(form, point, truths) for label, form in inside.items()}
        relations = self._echelon([*self.exact, *inside.values()]).rank - self._echelon(self.exact).rank
        return _Verdict(reasons, alike - set(inside), relations, self._most(point, truths))

    def _closed(self, forms: Mapping[str, Form], point: Point, truths: Mapping[Node, int]) -> dict[str, Form]:
        """Return the forms that are closed along all of them."""
        motions = self._motions(self._echelon([*forms.values(), *self.exact]), point)
        return {x: form for x, form in forms.items() if not self._slope(form, motions, point, truths)}

    def _most(self, point: Point, truths: Mapping[Node, int]) -> int:
        """Return the dimension of the first derived system beside the exact forms."""
        rows, columns = self._echelon(self.exact), list[Form]()
        for form in self.forms.values():
            if rows.grows(self._values[id(form)]):
                columns.append(form)
        vanishing = Echelon()  # of c with sum of c_i dw_i(a, b) = 0, drawn pairs a, b in turn
        for _ in columns:
            motions = self._motions(rows, point)
            slopes = [self._slope(form, motions, point, truths) for form in columns]
            vanishing.grows(dict(enumerate(slopes)))
        return len(columns) - vanishing.rank

    def _reason(self, form: Form, point: Point, truths: Mapping[Node, int]) -> str:
        """Return why a form is integrable, with as few others as will do."""
        for words, beside in (("on its own", self.units), ("with the holonomic rows", self.exact)):
            motions = self._motions(self._echelon([form, *beside]), point)
            if not self._slope(form, motions, point, truths):
                return f"{words} it is the rate of a relation between positions"
        return "with other velocity rows it is the rate of a relation between positions"

    def _row(self, form: Form, point: Point, truths: Mapping[Node, int]) -> Entries:
        values = point.values(list(form.coefficients.values()), truths)
        return {self._column[x]: value for x, value in zip(form.coefficients, values)}

    def _echelon(self, forms: Iterable[Form]) -> Echelon:
        found = Echelon()
        for form in forms:
            found.grows(self._values[id(form)])
        return found

    def _motions(self, rows: Echelon, point: Point) -> tuple[Entries, Entries]:
        """Return two motions that `rows` annul, drawn: what vanishes for them does for all such pairs."""
        one, two = (rows.solution(range(len(self._column)), point.draw) for _ in range(2))
        return one, two

    def _slope(
        self, form: Form, motions: tuple[Entries, Entries], point: Point, truths: Mapping[Node, int]
    ) -> int:
        """Return dw(a, b) = sum of dA_x/dy (b_x a_y - a_x b_y) for the form w."""
        a, b = motions
        values = point.values(list(form.slopes.values()), truths)
        places = ((self._column[x], self._column[y]) for x, y in form.slopes)
        return sum(e * (b[x] * a[y] - a[x] * b[y]) for (x, y), e in zip(places, values)) % P
