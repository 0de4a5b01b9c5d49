"""Which affine velocity rows are in fact integrable, alone or together with others.

The forms of all rows span a codistribution I.  A combination of them restricts positions where it
annuls all motions that can be made of those allowed, brackets included (`brackets`): these
combinations are the largest integrable part of I (the last of its derived flag; R. L. Bryant et al.,
*Exterior Differential Systems*, 1991, ch. II).  A row that lies in that part is integrable; of
relations that lie in no row alone the number is told.  All of it is linear algebra at points of a
finite field on the constraints, so no tolerance decides.

For many positions, or long rows, brackets become too long.  Rows are then taken for integrable where they
are closed along each other, dw(X, Y) = 0 for all X, Y that all of them annul (F. W. Warner, *Foundations of
Differentiable Manifolds and Lie Groups*, th. 2.32); combinations are not looked for.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress

from lagc.base.records import dataclass, field
from lagc.mechanics.analysis.lie_brackets import LARGEST, TooLong, reachable_directions
from lagc.mechanics.analysis.pfaffian_forms import Form, exact_form, places, spelt, unit_forms, velocity_form
from lagc.mechanics.formulation.equations import Row
from lagc.mechanics.formulation.states import States
from lagc.mechanics.identities.sampling_domains import on_rows
from lagc.mechanics.identities.zero_test import Judge, Truths
from lagc.mechanics.numeric.finite_field_linear import Echelon, Entries
from lagc.symbolic.finite_field import P, Point, Undefined
from lagc.symbolic.graph import Node


@dataclass(frozen=True, slots=True)
class Integrable:
    """Label -> why, of the integrable rows; how many relations between positions the velocity rows add
    to the holonomic ones, and how many of these lie in no row alone; whether all that is proved; and
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
    """The affine velocity rows among `rows` that restrict positions.

    The holonomic rows are to be independent; `tries` meet all.
    """
    asked = [row for row in rows if not row.holonomic and row.linear]
    if not asked:
        return Integrable()
    graph = states.graph
    forms = {row.label: spelt(graph, velocity_form(states, row)) for row in asked}
    holonomic = [spelt(graph, exact_form(states, row.residual)) for row in rows if row.holonomic]
    given = [*unit_forms(states), *holonomic]
    judge = Judge(on_rows(states, [row for row in rows if row.linear], tries))
    found: list[Integrable] = []
    for labels, beside in _parts(forms, given):
        part = _Part({x: forms[x] for x in labels}, beside, bool(holonomic))
        found.append(part.answer(judge))
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

    def answer(self, judge: Judge) -> Integrable:
        """Integrable on each branch; the fewest relations of all branches."""
        nodes = [x for form in (*self.forms.values(), *self.given) for x in form.nodes]
        verdicts: list[tuple[dict[str, str], int, int]] = []
        proved = True
        for placed, truths in judge.points(nodes):
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
