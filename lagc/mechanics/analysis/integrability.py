"""Integrable velocity constraints, alone or in combination.

The forms of all affine velocity rows span a codistribution I. A combination restricts positions if it
annihilates all motions that can be made of the allowed ones, Lie brackets included. These combinations are
the last derived flag of I (R. L. Bryant et al., *Exterior Differential Systems*, 1991, ch. II). A row in this
flag is integrable; other relations in it are counted. All steps are linear algebra at points of a finite
field on the constraints, so no tolerance is involved.

For many positions or long rows, brackets become too long. A row then counts as integrable if it is closed
along the others, dw(X, Y) = 0 for all X, Y that all of them annihilate (F. W. Warner, *Foundations of
Differentiable Manifolds and Lie Groups*, th. 2.32). Combinations are not searched.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from itertools import combinations, product

from lagc.base.records import dataclass, field
from lagc.mechanics.formulation.equations import Row
from lagc.mechanics.formulation.speeds import solve_rows
from lagc.mechanics.formulation.states import States, quaternion_rate, rate_symbols
from lagc.mechanics.identities.sampling_domains import on_rows
from lagc.mechanics.identities.zero_test import Truths, ZeroTest
from lagc.mechanics.numeric.dense_linear import Echelon, Entries
from lagc.mechanics.numeric.piecewise_branches import spelt_out
from lagc.semantics.model import Coordinate
from lagc.symbolic.derivative import gradient, seeds, tangent
from lagc.symbolic.finite_field import P, Point, Undefined
from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.walk import reachable, substitute, symbols


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


LARGEST = 16  # positions; the brackets of more become long
LONGEST = 10_000  # nodes of fields whose brackets are formed

Field = dict[Node, Node]


class TooLong(Exception):
    """Brackets are too long to be formed."""


def reachable_directions(
    graph: Graph, forms: Sequence[Form], where: Sequence[Node], point: Point, truths: Truths
) -> list[Entries]:
    """Return a basis, at `point`, of the directions of all motions that the forms admit, by place in `where`.
    Raises Undefined if something has no value there, TooLong if fields or brackets are too long."""
    span = _Span(where, point, truths)
    fields = [x for x in _fields(graph, forms, where, point, truths) if span.grows(x)]
    latest = fields
    while latest and span.size < len(where):
        if len(reachable([node for x in latest for node in x.values()])) > LONGEST:
            raise TooLong
        pairs = (
            product(fields, latest) if latest is not fields else combinations(fields, 2)
        )  # [y, x] = -[x, y]
        latest = [z for x, y in pairs if span.grows(z := _bracket(graph, x, y))]
    return span.directions


def _fields(
    graph: Graph, forms: Sequence[Form], where: Sequence[Node], point: Point, truths: Truths
) -> list[Field]:
    """A field for each position that is free, the others solved for."""
    column = {x: k for k, x in enumerate(where)}
    rows: list[dict[int, Node]] = []
    reduced = Echelon()
    for form in forms:
        values = point.values(list(form.coefficients.values()), truths)
        if reduced.grows({column[x]: value for x, value in zip(form.coefficients, values)}):
            rows.append({column[x]: node for x, node in form.coefficients.items()})
    pivots = list(reduced.rows)
    found: list[Field] = []
    for k, x in enumerate(where):
        if k not in pivots:
            right = [-row.get(k, graph.zero) for row in rows]
            solved = solve_rows(graph, rows, right, pivots)
            field = {where[j]: node for j, node in solved.items() if not node.is_zero}
            found.append({**field, x: graph.one})
    return found


def _bracket(graph: Graph, x: Field, y: Field) -> Field:
    """[x, y] = dy.x - dx.y"""
    ahead = dict(zip(y, tangent(graph, list(y.values()), x)))
    back = dict(zip(x, tangent(graph, list(x.values()), y)))
    zero = graph.zero
    found = {k: ahead.get(k, zero) - back.get(k, zero) for k in {**ahead, **back}}
    return {k: node for k, node in found.items() if not node.is_zero}


class _Span:
    """The directions met so far at a point."""

    def __init__(self, where: Sequence[Node], point: Point, truths: Truths):
        self._column = {x: k for k, x in enumerate(where)}
        self._point, self._truths = point, truths
        self._rows = Echelon()
        self.directions: list[Entries] = []

    @property
    def size(self) -> int:
        return len(self.directions)

    def grows(self, field: Field) -> bool:
        """Take the field's direction in; False where it is none that is new."""
        values = self._point.values(list(field.values()), self._truths)
        row = {self._column[x]: value for x, value in zip(field, values)}
        if not self._rows.grows(row):
            return False
        self.directions.append(row)
        return True


@dataclass(frozen=True, slots=True)
class Integrable:
    """The reasons of the integrable rows by label; the number of relations between positions that velocity
    rows add to the holonomic ones, and how many of these belong to no single row; whether all is proved;
    labels of rows that were not examined."""

    rows: dict[str, str] = field(default_factory=dict)
    relations: int = 0
    combinations: int = 0
    proved: bool = True
    open: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class _Place:
    """A point of the field on the constraints."""

    point: Point
    truths: Truths

    def row(self, form: Form, column: Mapping[Node, int]) -> Entries:
        values = self.point.values(list(form.coefficients.values()), self.truths)
        return {column[x]: value for x, value in zip(form.coefficients, values)}


def integrable_rows(states: States, rows: Sequence[Row], tries: Sequence[Mapping[Node, float]]) -> Integrable:
    """Return the affine velocity rows among `rows` that restrict positions. The holonomic rows are
    independent; `tries` meet all rows."""
    asked = [row for row in rows if not row.holonomic and row.linear]
    if not asked:
        return Integrable()
    graph = states.graph
    forms = {row.label: spelt(graph, velocity_form(states, row)) for row in asked}
    holonomic = [spelt(graph, exact_form(states, row.residual)) for row in rows if row.holonomic]
    given = [*unit_forms(states), *holonomic]
    zero_test = ZeroTest(on_rows(states, [row for row in rows if row.linear], tries))
    found: list[Integrable] = []
    for labels, beside in _parts(forms, given):
        part = _Part({x: forms[x] for x in labels}, beside, bool(holonomic))
        found.append(part.answer(zero_test))
    integrable = {label: why for x in found for label, why in x.rows.items()}
    return Integrable(
        {label: integrable[label] for label in forms if label in integrable},
        sum(x.relations for x in found),
        sum(x.combinations for x in found),
        all(x.proved for x in found),
        tuple([label for x in found for label in x.open]),
    )


def _parts(forms: Mapping[str, Form], given: Sequence[Form]) -> list[tuple[list[str], list[Form]]]:
    """The forms in groups that share no position, each with those given that belong to it."""
    everything = [*forms.values(), *given]
    group = list(range(len(everything)))
    owner: dict[Node, int] = {}
    for k, form in enumerate(everything):
        for x in places([form]):
            old, new = group[owner.setdefault(x, k)], group[k]
            if old != new:
                group = [new if g == old else g for g in group]
    found: list[tuple[list[str], list[Form]]] = []
    for g in dict.fromkeys(group[: len(forms)]):
        labels = [label for label, own in zip(forms, group) if own == g]
        found.append((labels, [form for form, own in zip(given, group[len(forms) :]) if own == g]))
    return found


class _Part:
    """Velocity forms by label, and the exact ones that go with them."""

    def __init__(self, forms: dict[str, Form], given: Sequence[Form], holonomic: bool):
        self.forms, self.given, self.holonomic = forms, given, holonomic
        self.where = places([*forms.values(), *given])
        self.column = {x: k for k, x in enumerate(self.where)}

    def answer(self, zero_test: ZeroTest) -> Integrable:
        """Integrable on each branch; the fewest relations of all branches."""
        nodes = [x for form in (*self.forms.values(), *self.given) for x in form.nodes]
        verdicts: list[tuple[dict[str, str], int, int]] = []
        proved = True
        for placed, truths in zero_test.points(nodes):
            tried = 0
            for x in placed:
                try:
                    verdicts.append(self._at(_Place(x.point, truths)))
                except Undefined:
                    continue
                proved = proved and x.met and x.point.exact and not x.point.rooted
                tried += 1
                if tried == 2:
                    break
            if not tried:
                return Integrable(open=tuple(self.forms))
        common = set(verdicts[0][0]).intersection(*(found for found, _, _ in verdicts))
        rows = {label: why for label, why in verdicts[0][0].items() if label in common}
        relations = min(count for _, count, _ in verdicts)
        return Integrable(rows, relations, min(more for _, _, more in verdicts), proved)

    def _at(self, place: _Place) -> tuple[dict[str, str], int, int]:
        """Reasons of integrable rows, all new relations, and those of combinations alone."""
        if len(self.where) <= LARGEST:
            with suppress(TooLong):
                return self._reached(place)
        reasons = self._closed_rows(place)
        return reasons, self._rank(place, reasons) - self._rank(place, ()), 0

    def _reached(self, place: _Place) -> tuple[dict[str, str], int, int]:
        """The same by brackets.  Raises TooLong."""
        kept = self._kept(place, [*self.forms.values(), *self.given])
        inside = {label for label, form in self.forms.items() if self._annuls(place, form, kept)}
        whole = len(self.where) - len(kept)
        reasons = {label: self._reason(place, label) for label in self.forms if label in inside}
        return reasons, whole - self._rank(place, ()), whole - self._rank(place, inside)

    def _rank(self, place: _Place, labels: Iterable[str]) -> int:
        """Of the forms given and the labelled ones."""
        held = Echelon()
        for form in (*self.given, *(self.forms[label] for label in labels)):
            held.grows(place.row(form, self.column))
        return held.rank

    def _kept(self, place: _Place, forms: Sequence[Form]) -> list[Entries]:
        (graph,) = {x.graph for x in self.where}
        return reachable_directions(graph, forms, self.where, place.point, place.truths)

    def _annuls(self, place: _Place, form: Form, directions: Sequence[Entries]) -> bool:
        values = place.row(form, self.column)
        return not any(sum(e * x.get(j, 0) for j, e in values.items()) % P for x in directions)

    def _reason(self, place: _Place, label: str) -> str:
        """With as few other rows as will do."""
        own = self.forms[label]
        units = [form for form in self.given if form.is_unit]
        if self._closed(place, own, *self._motions(place, [own, *units])):
            return "on its own it is the rate of a relation between positions"
        if self._closed(place, own, *self._motions(place, [own, *self.given])):
            return "with the holonomic rows it is the rate of a relation between positions"
        others = [x for x in self.forms if x != label]
        for x in list(others):
            rest = [self.forms[y] for y in others if y != x]
            if self._annuls(place, own, self._kept(place, [own, *rest, *self.given])):
                others.remove(x)
        names = ", ".join(f"`{x}`" for x in others)
        beside = " and the holonomic rows" if self.holonomic else ""
        return f"together with {names}{beside} it is the rate of a relation between positions"

    def _closed_rows(self, place: _Place) -> dict[str, str]:
        """The largest set of rows that are closed along each other and the holonomic ones."""
        inside = dict(self.forms)
        while inside:
            motions = self._motions(place, [*inside.values(), *self.given])
            closed = {x: form for x, form in inside.items() if self._closed(place, form, *motions)}
            if len(closed) == len(inside):
                break
            inside = closed
        return dict.fromkeys(inside, "the rows together are the rates of relations between positions")

    def _motions(self, place: _Place, along: Sequence[Form]) -> tuple[Entries, Entries]:
        """Two that the forms `along` annul, drawn: what vanishes for them does for all such pairs."""
        rows = Echelon()
        for form in along:
            rows.grows(place.row(form, self.column))
        one, two = (rows.solution(range(len(self.where)), place.point.draw) for _ in range(2))
        return one, two

    def _closed(self, place: _Place, form: Form, a: Entries, b: Entries) -> bool:
        """dw(a, b) = sum of dA_x/dy (b_x a_y - a_x b_y) = 0 for the form w."""
        values = place.point.values(list(form.slopes.values()), place.truths)
        places = ((self.column[x], self.column[y]) for x, y in form.slopes)
        return not sum(e * (b[x] * a[y] - a[x] * b[y]) for (x, y), e in zip(places, values)) % P
