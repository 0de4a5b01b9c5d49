"""Formulas as trees whose numbers may follow a counter.

Polynomials of atoms become trees of symbols with separate indices. Formulas that differ in numbers alone have
the same `pattern`; a rule replaces the numbers by linear expressions of a counter.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Hashable, Iterable, Mapping
from fractions import Fraction
from typing import Any, TypeAlias

from lagc.base.records import dataclass, replace
from lagc.reports.algebra.collect import Collector, Product, Sum
from lagc.reports.algebra.polynomials import Exponent
from lagc.reports.names import Names
from lagc.symbolic.graph import Node

INDEX = re.compile(r"(?<=[\[,])\d+(?=[,\]])")


@dataclass(frozen=True, slots=True)
class Linear:
    """constant + the sum of slopes times counters; no slope is zero."""

    constant: int | Fraction
    slopes: tuple[tuple[str, int | Fraction], ...]


Number: TypeAlias = int | Fraction | Linear
Numbers: TypeAlias = list[Any]  # int for indices, Fraction for coefficients
Counters: TypeAlias = tuple[tuple[str, Number, Number], ...]  # name, first, last


@dataclass(frozen=True, slots=True)
class Symbol:
    """`node`, or what differs from it in its `indices`; `kind` is its name without these. Symbols with equal
    kinds and indices are equal."""

    node: Node
    kind: Hashable
    indices: tuple[Number, ...]

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Symbol) and (self.kind, self.indices) == (other.kind, other.indices)

    def __hash__(self) -> int:
        return hash((self.kind, self.indices))


@dataclass(frozen=True, slots=True)
class Call:
    op: str
    args: tuple[Total, ...]


@dataclass(frozen=True, slots=True)
class Term:
    """A product: `size` is the absolute value of its coefficient."""

    negative: bool
    size: Number
    factors: tuple[tuple[Form, Exponent], ...]


@dataclass(frozen=True, slots=True)
class Series:
    """The sum of `body` over the counter, from `first` to `last`; nothing where that is less."""

    counter: str
    first: Number
    last: Number
    body: Part


@dataclass(frozen=True, slots=True)
class Total:
    terms: tuple[Part, ...]


@dataclass(frozen=True, slots=True)
class Line:
    """`left` = `right` for all values of the counters, each as (name, first, last), with bounds in earlier
    ones; its kind and its origin. At an event, `left` takes the value `right` when the `condition` of a
    `clause` becomes true."""

    kind: str
    label: str
    indices: tuple[Number, ...]  # of the label
    left: Total
    right: Total
    condition: Total | None = None
    clause: Number = 0
    counters: Counters = ()


Part: TypeAlias = Term | Series
Form: TypeAlias = Symbol | Call | Total


class Former:
    """Makes forms of what a collector made, with the `names` of symbols."""

    def __init__(self, collector: Collector, names: Names) -> None:
        self._collector, self._algebra, self._names = collector, collector.algebra, names
        self._atoms: dict[int, Form] = {}

    def total(self, found: Sum) -> Total:
        return Total(tuple([self._term(product) for product in found.terms]))

    def line(
        self, kind: str, label: str, left: Sum, right: Sum, condition: Sum | None = None, clause: int = 0
    ) -> Line:
        given = None if condition is None else self.total(condition)
        return Line(kind, label, indices(label), self.total(left), self.total(right), given, clause)

    def _term(self, product: Product) -> Term:
        factors = [(self._factor(base), e) for base, e in product.factors]
        return Term(product.coefficient < 0, abs(product.coefficient), tuple(factors))

    def _factor(self, base: int | Sum) -> Form:
        if isinstance(base, Sum):
            return self.total(base)
        if base not in self._atoms:
            self._atoms[base] = self._atom(base)
        return self._atoms[base]

    def _atom(self, number: int) -> Form:
        atom = self._algebra.atoms[number]
        node = self._algebra.named.get(number, atom.node)
        if node is not None:
            return self._symbol(node)
        args = tuple([self.total(found) for found in self._collector.arguments(number)])
        return args[0] if atom.op == "sum" else Call(atom.op, args)

    def _symbol(self, node: Node) -> Symbol:
        name = self._names.get(node)
        if name is None:
            return Symbol(node, node, ())
        return Symbol(
            node, (INDEX.sub("", name.full), INDEX.sub("", name.base), name.order), indices(name.base)
        )


def indices(name: str) -> tuple[int, ...]:
    return tuple([int(found) for found in INDEX.findall(name)])


def filled(name: str, numbers: list[str]) -> str:
    """`name` with `numbers` in the place of its indices."""
    left = iter(numbers)
    return INDEX.sub(lambda _: next(left), name)


def changed(
    form: Any, change: Callable[[Number], Number], terms: Callable[[Part], Iterable[Part]] | None = None
) -> Any:
    """Return `form` with its numbers changed, always in the same order. `terms` gives what stands for each
    part of a sum."""

    def inner(x: Any) -> Any:
        return changed(x, change, terms)

    if isinstance(form, Symbol):
        return Symbol(form.node, form.kind, tuple([change(x) for x in form.indices]))
    if isinstance(form, Call):
        return Call(form.op, tuple([inner(x) for x in form.args]))
    if isinstance(form, Total):
        return Total(tuple([y for x in form.terms for y in ([inner(x)] if terms is None else terms(x))]))
    if isinstance(form, Term):
        size = change(form.size)
        return Term(form.negative, size, tuple([(inner(x), e) for x, e in form.factors]))
    if isinstance(form, Series):
        return Series(form.counter, change(form.first), change(form.last), inner(form.body))
    own = tuple([change(x) for x in form.indices])
    counters = tuple([(name, change(first), change(last)) for name, first, last in form.counters])
    left, right = inner(form.left), inner(form.right)
    condition = None if form.condition is None else inner(form.condition)
    return Line(form.kind, form.label, own, left, right, condition, change(form.clause), counters)


def pattern(form: Any, numbers: Numbers) -> Hashable:
    """Return a form without its numbers, which are added to `numbers`; slopes stay."""

    def removed(number: Number) -> Number:
        numbers.append(number.constant if isinstance(number, Linear) else number)
        return Linear(0, number.slopes) if isinstance(number, Linear) else 0

    found: Hashable = changed(form, removed)
    return replace(found, label=INDEX.sub("", found.label)) if isinstance(found, Line) else found


def value(number: Number, at: Mapping[str, int]) -> Number:
    """Return a number with values for some of its counters."""
    if not isinstance(number, Linear):
        return number
    constant = number.constant + sum([c * at[x] for x, c in number.slopes if x in at])
    slopes = tuple([(x, c) for x, c in number.slopes if x not in at])
    return Linear(constant, slopes) if slopes else constant


def written_out(form: Any, at: Mapping[str, int]) -> Any:
    """Return `form` for values of all counters, its series term by term."""
    found = changed(form, lambda x: value(x, at), lambda part: terms_of(part, at))
    return replace(found, counters=()) if isinstance(found, Line) else found


def terms_of(part: Part, at: Mapping[str, int]) -> list[Term]:
    """The terms that it stands for, for values of all counters."""
    if isinstance(part, Term):
        return [written_out(part, at)]
    return [
        x for k in _between(part.first, part.last, at) for x in terms_of(part.body, {**at, part.counter: k})
    ]


def _between(first: Number, last: Number, at: Mapping[str, int]) -> range:
    bounds = value(first, at), value(last, at)
    assert isinstance(bounds[0], int) and isinstance(bounds[1], int)
    return range(bounds[0], bounds[1] + 1)


def all_of(line: Line) -> list[Line]:
    """The lines that `line` stands for."""
    places: list[dict[str, int]] = [{}]
    for name, first, last in line.counters:
        places = [{**at, name: k} for at in places for k in _between(first, last, at)]
    return [written_out(line, at) for at in places]


def counted(form: Any) -> set[str]:
    found: set[str] = set()

    def seen(number: Number) -> Number:
        if isinstance(number, Linear):
            found.update(x for x, _ in number.slopes)
        return number

    changed(form, seen)
    return found


def renumbered(form: Any, numbers: list[Number]) -> Any:
    """`form` with other numbers, in which a counter may stand, for its own; slopes stay."""
    left = iter(numbers)

    def change(old: Number) -> Number:
        new = next(left)
        if not isinstance(old, Linear):
            return new
        constant, more = (new.constant, new.slopes) if isinstance(new, Linear) else (new, ())
        return replace(old, constant=constant, slopes=(*old.slopes, *more))

    return changed(form, change)
