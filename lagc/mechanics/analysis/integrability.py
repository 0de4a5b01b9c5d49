"""Integrable velocity constraints, alone or in combination.

A combination of velocity rows restricts positions if it annihilates all directions that motions reach, Lie
brackets of allowed motions included. These combinations are the last derived flag of the rows' forms (R. L.
Bryant et al., *Exterior Differential Systems*, 1991, ch. II). All steps are linear algebra at points of a
finite field on the constraints, so no tolerance is involved.

The largest set of rows that are closed along each other lies in this flag: dw(X, Y) = 0 for all X, Y that
all of them and the holonomic rows annihilate (F. W. Warner, *Foundations of Differentiable Manifolds and Lie
Groups*, th. 2.32). Brackets are formed only where the first derived system is larger. If they become too
long, those that were formed bound the number of relations.
"""

from collections.abc import Iterable, Mapping, Sequence
from itertools import combinations, product
from typing import NamedTuple, TypeAlias

from lagc.base.records import dataclass, field
from lagc.mechanics.formulation.equations import Row
from lagc.mechanics.formulation.states import States, quaternion_rate, rate_symbols, solve_rows
from lagc.mechanics.identities.sampling_domains import on_rows
from lagc.mechanics.identities.zero_test import ZeroTest, spelt_out
from lagc.semantics.model import Coordinate
from lagc.symbolic.derivative import gradient, seeds, tangent
from lagc.symbolic.finite_field import Echelon, Entries, P, Point, Undefined
from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.walk import reachable, substitute, symbols

LONGEST = 10_000  # nodes that the brackets of a step differentiate

Field: TypeAlias = dict[Node, Node]  # position -> its rate


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
    combinations of others, the number of relations that are found, and the most that there may be."""

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
    # The row as a differential form in positions and time: weights on rates become weights on dq; body rates
    # of a quaternion by w = 2 conj(e) e'.
    weights = rate_coefficients(states, row.jacobian)
    found: dict[Node, Node] = {}
    for c in states.model.coordinates:
        on_rates = [weights.get(rate, graph.zero) for rate in rate_symbols(c)]
        if isinstance(c, Coordinate):
            found[c.symbol] = on_rates[0]
        else:  # a rotation w in body axes has e' = 1/2 e*(0, w), and w = 2 conj(e)*e'
            found.update(zip(c.symbols, [4.0 * x for x in quaternion_rate(c.symbols, on_rates)]))
    found[states.model.time] = substitute(graph, [row.rate], states.zero_rates)[0]
    coefficients = {x: node for x, node in found.items() if not node.is_zero}
    slopes: dict[tuple[Node, Node], Node] = {}
    # Derivatives of the coefficients, for dw.
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
    # Rows that are linear in the speeds are forms; unit quaternions and holonomic rows are exact forms beside
    # them.
    forms = {row.label: _velocity_form(states, row) for row in rows if not row.holonomic and row.linear}
    if not forms:
        return Integrable()
    lengths = [graph.sum(states.q[i + k] ** 2 for k in range(4)) for i in states.quaternions]
    units = [_exact_form(states, length) for length in lengths]
    holonomic = [_exact_form(states, row.residual) for row in rows if row.holonomic]
    test = _Test(graph, forms, units, holonomic)
    verdicts: list[_Verdict] = []
    exact = True
    # A few points on each branch: a rank at a random point is the generic one.
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
    # A row is integrable if it is at every point.
    common = set(forms).intersection(*(v.reasons for v in verdicts))
    doubtful = set().union(*(v.doubtful for v in verdicts)) if exact else set(forms)
    relations = min(v.relations for v in verdicts)
    proved = exact and relations == min(v.most for v in verdicts)
    reasons = {label: verdicts[0].reasons[label] for label in forms if label in common}
    return Integrable(reasons, relations, proved, doubtful=frozenset(doubtful))


def _bracket(graph: Graph, x: Field, y: Field) -> Field:
    """Return [x, y] = dy.x - dx.y."""
    ahead = dict(zip(y, tangent(graph, list(y.values()), x)))
    back = dict(zip(x, tangent(graph, list(x.values()), y)))
    return {k: ahead.get(k, graph.zero) - back.get(k, graph.zero) for k in {**ahead, **back}}


class _Test:
    """The test of velocity forms by label, beside the exact ones of unit quaternions and holonomic rows."""

    def __init__(
        self, graph: Graph, forms: dict[str, Form], units: Sequence[Form], holonomic: Sequence[Form]
    ):
        self.graph, self.forms, self.units, self.exact = graph, forms, units, [*units, *holonomic]
        every = [*forms.values(), *self.exact]
        self.nodes = [node for form in every for node in form.nodes]
        places = {x for form in every for x in form.coefficients}
        places |= {y for form in every for _, y in form.slopes}
        self._column = {x: k for k, x in enumerate(sorted(places, key=lambda x: x.index))}

    def at(self, point: Point, truths: Mapping[Node, int]) -> _Verdict:
        """Return the verdict of a point. Raises Undefined."""
        # Largest set of forms that are closed along each other: those that are not leave, until none does.
        every = [*self.exact, *self.forms.values()]
        self._values = {id(f): self._entries(f.coefficients, point, truths) for f in every}
        inside = alike = self._closed_forms(self.forms, point, truths)
        while len(closed := self._closed_forms(inside, point, truths)) < len(inside):
            inside = closed
        # Relations that they give: the rank that they add to the exact forms.
        exact = self._echelon(self.exact).rank
        relations = self._echelon([*self.exact, *inside.values()]).rank - exact
        rows, taken = Echelon(), list[Form]()
        for form in every:
            if rows.grows(self._values[id(form)]):
                taken.append(form)
        # The first derived system bounds them from above; if both agree, no bracket is needed.
        most = self._derived_dimension(rows, taken, point, truths) - exact
        if relations < most:
            reach, whole = self._reach(rows, taken, point, truths)
            most = min(most, len(self._column) - reach.rank - exact)
            alike = {label: form for label, form in alike.items() if self._annuls(form, reach)}
            if whole:
                relations, inside = most, alike
        reasons = {label: self._reason(form, point, truths) for label, form in inside.items()}
        return _Verdict(reasons, set(alike) - set(inside), relations, most)

    def _derived_dimension(
        self, rows: Echelon, taken: Sequence[Form], point: Point, truths: Mapping[Node, int]
    ) -> int:
        """Return the dimension of the first derived system of the independent forms `taken`."""
        # c . dw(a, b) = 0 for all allowed a, b: each random pair gives one equation for c.
        vanishing = Echelon()  # of c with sum of c_i dw_i(a, b) = 0, drawn pairs a, b in turn
        for _ in taken:
            motions = self._motions(rows, point)
            slopes = [self._slope(form, motions, point, truths) for form in taken]
            vanishing.grows(dict(enumerate(slopes)))
        return len(taken) - vanishing.rank

    def _reach(
        self, rows: Echelon, taken: Sequence[Form], point: Point, truths: Mapping[Node, int]
    ) -> tuple[Echelon, bool]:
        """Return the span of the motions that `taken` allow and of their brackets, and whether all brackets
        are in it."""
        # A field for each position that is free, the others solved for.
        zero, where = self.graph.zero, list(self._column)
        matrix = [{self._column[x]: node for x, node in form.coefficients.items()} for form in taken]
        fields = list[Field]()
        for k, x in enumerate(where):
            if k not in rows.rows:
                right = [-row.get(k, zero) for row in matrix]
                solved = solve_rows(self.graph, matrix, right, list(rows.rows))
                fields.append({x: self.graph.one, **{where[j]: node for j, node in solved.items()}})
        # Brackets of the fields, once a pair since [x, y] = -[y, x]; then with those new in the step before.
        reach = Echelon()
        latest = [x for x in fields if reach.grows(self._entries(x, point, truths))]
        pairs: Iterable[tuple[Field, Field]] = combinations(fields, 2)
        while latest:
            if len(fields) * len(reachable([node for x in latest for node in x.values()])) > LONGEST:
                return reach, False
            brackets = (_bracket(self.graph, x, y) for x, y in pairs)
            latest = [z for z in brackets if reach.grows(self._entries(z, point, truths))]
            pairs = product(fields, latest)
        return reach, True

    def _annuls(self, form: Form, directions: Echelon) -> bool:
        values = self._values[id(form)]
        return not any(sum(e * x.get(j, 0) for j, e in values.items()) % P for x in directions.rows.values())

    def _closed_forms(
        self, forms: Mapping[str, Form], point: Point, truths: Mapping[Node, int]
    ) -> dict[str, Form]:
        """Return the forms that are closed along all of them."""
        motions = self._motions(self._echelon([*forms.values(), *self.exact]), point)
        return {x: form for x, form in forms.items() if not self._slope(form, motions, point, truths)}

    def _reason(self, form: Form, point: Point, truths: Mapping[Node, int]) -> str:
        """Return why a form is integrable, with as few others as will do."""
        for words, beside in (("on its own", self.units), ("with the holonomic rows", self.exact)):
            motions = self._motions(self._echelon([form, *beside]), point)
            if not self._slope(form, motions, point, truths):
                return f"{words} it is the rate of a relation between positions"
        return "with other velocity rows it is the rate of a relation between positions"

    def _entries(self, nodes: Mapping[Node, Node], point: Point, truths: Mapping[Node, int]) -> Entries:
        values = point.values(list(nodes.values()), truths)
        return {self._column[x]: value for x, value in zip(nodes, values)}

    def _echelon(self, forms: Iterable[Form]) -> Echelon:
        found = Echelon()
        for form in forms:
            found.grows(self._values[id(form)])
        return found

    def _motions(self, rows: Echelon, point: Point) -> tuple[Entries, Entries]:
        """Return two motions that `rows` annul, drawn: what vanishes for them does for all such pairs."""
        # Any vector that the rows annul, with its free entries drawn.
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
