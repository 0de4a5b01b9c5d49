"""The equations of motion as formulas: collected terms, cancelled common factors, short names.

Each equation is the derived one up to a factor that is a number or a product of parameters.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from fractions import Fraction
from functools import cached_property
from math import inf
from typing import TypeAlias

from lagc.base.records import dataclass, replace
from lagc.mechanics.formulation.equations import EquationsOfMotion
from lagc.reports.algebra.collect import Collector, Sum, positive_first
from lagc.reports.algebra.expansion import HIGHEST, LONG, Algebra, Parts, TooLarge
from lagc.reports.algebra.polynomials import Frozen, Polynomial, frozen, scaled
from lagc.reports.algebra.trigonometric_identities import (
    ShortAlgebra,
    TurningAlgebra,
    shorten,
    unit_quaternion,
    without_noise,
)
from lagc.reports.equations.modes import Law
from lagc.reports.names import pi_of
from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.walk import reachable, symbols


class NamingAlgebra(ShortAlgebra):
    """Represents `shared` nodes and long expressions by symbols of `graph`, with their `definitions`. Nothing
    long is multiplied out, so there is no limit."""

    def __init__(self, graph: Graph, shared: Iterable[Node], nonnegative: Iterable[Node] = ()) -> None:
        super().__init__(nonnegative, limit=1 << 62)
        self._graph = graph
        self._shared = set(shared)
        self._named: dict[Frozen, Polynomial] = {}
        self.definitions: list[tuple[Node, Polynomial]] = []

    def multiply(self, p: Polynomial, q: Polynomial) -> Polynomial:
        if len(p) * len(q) > LONG**2 and min(len(p), len(q)) > 1:
            p, q = self._name(p), self._name(q)
        return super().multiply(p, q)

    def power(self, p: Polynomial, n: int) -> Polynomial:
        return super().power(self._name(p) if n > HIGHEST else p, n)

    def _name(self, p: Polynomial) -> Polynomial:
        """A symbol for `p`, where it has several terms, but for the factor that all of them share."""
        if len(p) < 2:
            return p
        c, common, rest = self.content(p)
        return super().multiply({common: c}, self._symbol_for(rest))

    def _symbol_for(self, p: Polynomial) -> Polynomial:
        key = frozen(p)
        if key not in self._named:
            node = self._graph.symbol("shown part", str(len(self._named)))
            self.definitions.append((node, p))
            self._named[key] = self.symbol_only(node)
        return self._named[key]

    def _longest(self, node: Node) -> float:
        """The terms of what has no name."""
        return LONG

    def _parts(self, node: Node) -> Parts:
        return []  # what would be long has a name

    def _convert(self, node: Node) -> Polynomial:
        p = super()._convert(node)
        if len(p) < 2 or (node not in self._shared and len(p) <= self._longest(node)):
            return p
        return self._name(p)


class SharedAlgebra(NamingAlgebra):
    """Sums that are not shared stay as they are, whatever their length: they may follow a rule."""

    def _longest(self, node: Node) -> float:
        return inf if node.op == "add" else LONG

    def _parts(self, node: Node) -> Parts:
        # Added up in one pass: one addition after the other copies what is added up so far each time.
        return Algebra._parts(self, node) if node.op == "add" and node not in self._shared else []


@dataclass(frozen=True, slots=True)
class Formula:
    """`left` = `right`. The kinds are shared, kinematic, motion, position, velocity, event, and those of laws
    of contacts (see `modes.Law`); `label` names the origin. At an event, `left` takes the value `right` when
    the `condition` of a clause becomes true; clauses have numbers. An equation of motion is `left` times
    its `factor`."""

    kind: str
    label: str
    left: Sum
    right: Sum
    condition: Sum | None = None
    clause: int = 0
    factor: Sum | None = None


ZERO = Sum(())
LETTER = "letter"  # the kind of symbols that a form of the equations brings
WORK, PER_ENTRY = 60_000, 100  # products, and for each entry of M
MOST_WORK = 1_000_000  # some seconds


Motion: TypeAlias = "Callable[[EquationsOfMotion, Collector], list[Formula]]"  # a form of the equations


def formulas(
    equations: EquationsOfMotion, laws: Sequence[Law] = (), motion: Motion | None = None
) -> Formulas:
    """Return the formulas of `equations`, multiplied out, or with shared parts s1, s2, ... if that is too
    long. `motion` gives the equations of motion, by default those that are divided by common factors."""
    kinds = (ShortAlgebra, TurningAlgebra) if motion is None else (TurningAlgebra,)  # of an inverse of M
    motion = motion or divided
    known = nonnegative(equations)
    work = min(WORK + PER_ENTRY * len(equations.v) ** 2, MOST_WORK)
    # From the most readable to the one that always ends: multiplied out, with total angles taken together
    # along frames, with names for shared parts.
    for kind in kinds:
        algebra = kind(known, work)
        with suppress(TooLarge):
            collector = collector_of(SymbolKinds(equations), algebra)
            found = everything(equations, collector, motion(equations, collector), laws)
            algebra.end_limit()
            return with_long_sums(equations, collector, found)
    naming = NamingAlgebra(equations.graph, shared(_roots(equations, laws)), known)
    collector = collector_of(SymbolKinds(equations), naming)
    found = everything(equations, collector, motion(equations, collector), laws)
    return Formulas(collector, found, naming.definitions)


@dataclass(frozen=True)
class Formulas:
    """`parts`: symbols that stand for others, in an order in which each is made of those before it."""

    collector: Collector
    found: list[Formula]
    parts: list[tuple[Node, Polynomial]]

    @cached_property
    def definitions(self) -> list[Formula]:
        """A formula for each part.  To collect one may name further parts, which are put before it."""
        collect, symbol = self.collector.collect, self.collector.algebra.symbol_only
        pending, ordered, found = list(reversed(self.parts)), [], []
        collected: dict[Node, Formula] = {}
        while pending:
            node, p = pending[-1]
            if node not in collected:
                known = len(self.parts)
                collected[node] = Formula("shared", node.record.name, collect(symbol(node)), collect(p))
                pending += reversed(self.parts[known:])
            else:
                ordered.append(pending.pop())
                found.append(collected[node])
        self.parts[:] = ordered
        return found

    @property
    def named(self) -> list[Node]:
        """The symbols of all parts, in the order of their definitions."""
        count = len(self.definitions)  # orders the parts
        return [node for node, _ in self.parts[:count]]


def everything(
    equations: EquationsOfMotion, collector: Collector, motion: Sequence[Formula], laws: Sequence[Law] = ()
) -> list[Formula]:
    """Return all formulas; `motion` are the equations of motion among them."""
    return [
        *_kinematic(equations, collector),
        *motion,
        *_rows(equations, collector),
        *_laws(equations, collector, laws),
        *_events(equations, collector),
    ]


def divided(
    equations: EquationsOfMotion, collector: Collector, found: Sequence[Polynomial] | None = None
) -> list[Formula]:
    """Return the equations of motion without common factors; `found` is a polynomial a speed that
    vanishes."""
    if found is None:
        found = motion_polynomials(equations, collector.algebra)
    return [
        Formula(
            "motion",
            name,
            collector.collect(collector.cancel(p)),
            ZERO,
            factor=collector.collect(collector.common_factor(p)),
        )
        for name, p in zip(equations.v_names, found)
    ]


def nonnegative(equations: EquationsOfMotion) -> list[Node]:
    return [p.symbol for p in equations.model.parameters if p.minimum >= 0]


class SymbolKinds:
    """The symbols of `equations` by kind, and their ranks in the order of terms."""

    def __init__(self, equations: EquationsOfMotion) -> None:
        model = equations.model
        self.pi = pi_of(equations)
        parameters = [*(p.symbol for p in model.parameters), *model.undetermined]
        if self.pi is not None:
            parameters.insert(0, self.pi)
        forces = [force for contact in equations.contacts for force in contact.forces]
        trailing = [*equations.lam, *forces]
        ordered = (*parameters, *equations.q, *equations.v, *equations.a, *trailing)
        self.ranks = {node: rank for rank, node in enumerate(ordered)}
        self.parameters, self.rates = frozenset(parameters), frozenset(equations.v)
        self.leading, self.trailing = frozenset(equations.a), frozenset(trailing)
        self.cancelled = frozenset(p.symbol for p in model.parameters if p.minimum >= 0 or p.value)


def collector_of(kinds: SymbolKinds, algebra: Algebra, within: Sequence[Node] | None = None) -> Collector:
    """Return a collector of terms in the order of the symbols of equations, or of those in `within`."""
    ranks = kinds.ranks
    if within is not None:
        ranks = {node: ranks[node] for node in (*symbols(within), kinds.pi) if node in ranks}
    algebra.pi = kinds.pi
    numbers = {node: algebra.symbol(node) for node in sorted(ranks, key=ranks.__getitem__)}
    return Collector(
        algebra,
        parameters={k for node, k in numbers.items() if node in kinds.parameters},
        leading=[k for node, k in numbers.items() if node in kinds.leading],
        rates={k for node, k in numbers.items() if node in kinds.rates},
        trailing=[k for node, k in numbers.items() if node in kinds.trailing],
        cancelled={k for node, k in numbers.items() if node in kinds.cancelled},
    )


def with_long_sums(equations: EquationsOfMotion, collector: Collector, formulas: list[Formula]) -> Formulas:
    """Return the formulas with a symbol for each long sum, under a root or in a denominator, that is written
    twice or more."""
    algebra = collector.algebra
    # How often each atom is written: an atom that is met again brings its arguments once.
    times: dict[int, int] = {}
    pending: list[int | Sum | None] = [part for f in formulas for part in (f.left, f.right, f.condition)]
    while pending:
        part = pending.pop()
        if isinstance(part, Sum):
            pending += [base for product in part.terms for base, _ in product.factors]
        elif part is not None:
            times[part] = times.get(part, 0) + 1
            if times[part] == 1:
                inner = algebra.atoms[part].args
                pending += [atom for p in inner for monomial, _ in p for atom, _ in monomial]
    found: list[tuple[Node, Polynomial]] = []
    for number in sorted(times):  # those within others come first
        atom = algebra.atoms[number]
        if times[number] > 1 and atom.op == "sum" and len(atom.args[0]) >= LONG:
            algebra.named[number] = equations.graph.symbol("shown part", str(len(found)))
            found.append((algebra.named[number], tidy(equations, algebra, dict(atom.args[0]))))
    return Formulas(collector, formulas, found)


def _kinematic(equations: EquationsOfMotion, collector: Collector) -> list[Formula]:
    """q' = N v + n of coordinates for which that says more than q' = v."""
    algebra, formulas, own = collector.algebra, [], set(equations.v)
    which = [i for i, e in enumerate(equations.qdot) if not (e in own and _is_rate(e))]
    for i, p in zip(which, algebra.polynomials([equations.qdot[i] for i in which])):
        right = collector.factored(tidy(equations, algebra, p))
        rate = algebra.symbol_only(rate_of(equations, equations.q[i]))
        formulas.append(Formula("kinematic", equations.q[i].record.name, collector.collect(rate), right))
    return formulas


def rate_of(equations: EquationsOfMotion, q: Node) -> Node:
    """Return the symbol of the rate of a coordinate, where that is no speed."""
    return equations.graph.symbol("shown rate", q.record.name)


def _is_rate(speed: Node) -> bool:
    return speed.record.kind == "rate" and not speed.record.is_body_rate


def motion_polynomials(equations: EquationsOfMotion, algebra: Algebra) -> list[Polynomial]:
    """M a + h - tau - G^T lam, shortened, nothing cancelled."""
    found, every = [], range(len(equations.v))
    for i, inertia in zip(every, equations.mass_rows(every)):
        total, force = algebra.polynomials([equations.bias_forces[i], equations.given_forces[i]])
        total = algebra.add(total, scaled(force, Fraction(-1)))
        for j, entry in inertia.items():
            e, s = algebra.polynomials([entry, equations.a[j]])
            total = algebra.add(total, algebra.multiply(tidy(equations, algebra, e), s))
        for row in equations.rows:
            if i in row.jacobian:
                e, s = algebra.polynomials([row.jacobian[i], row.multiplier])
                total = algebra.add(total, scaled(algebra.multiply(e, s), Fraction(-1)))
        found.append(tidy(equations, algebra, total))
    return found


def tidy(equations: EquationsOfMotion, algebra: Algebra, p: Polynomial) -> Polynomial:
    """`p` by the identities of trigonometry and of unit quaternions, without rounding noise."""
    p = shorten(algebra, without_noise(algebra, p))
    own = algebra.orientations
    if equations.quaternions and not own:
        own.update((algebra.symbol(q), i) for i in equations.quaternions for q in equations.q[i : i + 4])
    for i in sorted({own[a] for monomial in p for a, exponent in monomial if a in own and exponent >= 2}):
        w, x, y, z = [algebra.symbol(q) for q in equations.q[i : i + 4]]
        p = unit_quaternion(algebra, p, (w, x, y, z))
    return p


def _rows(equations: EquationsOfMotion, collector: Collector) -> list[Formula]:
    algebra, rows = collector.algebra, equations.rows
    formulas = []
    for row, p in zip(rows, algebra.polynomials([row.residual for row in rows])):
        p = tidy(equations, algebra, p)
        by_rate = row.linear and not row.holonomic
        left = collector.collect(p, sorted(collector.rates)) if by_rate else collector.collect(p)
        formulas.append(Formula(row.level.value, row.label, Sum(positive_first(left.terms)), ZERO))
    return formulas


def _laws(equations: EquationsOfMotion, collector: Collector, laws: Sequence[Law]) -> list[Formula]:
    algebra, found = collector.algebra, list[Formula]()
    for law in laws:
        given = [law.left, law.right, *([law.condition] if law.condition is not None else [])]
        left, right, *others = [
            collector.collect(tidy(equations, algebra, p)) for p in algebra.polynomials(given)
        ]
        if law.kind == "closed" and not right.terms and all(term.coefficient < 0 for term in left.terms):
            left = Sum(tuple([replace(term, coefficient=-term.coefficient) for term in left.terms]))
        condition = others[0] if others else None
        found.append(Formula(law.kind, law.label, Sum(positive_first(left.terms)), right, condition))
    return found


def _events(equations: EquationsOfMotion, collector: Collector) -> list[Formula]:
    """Return the new values of states at the moment that the conditions of clauses `when` become true."""
    algebra, formulas = collector.algebra, []
    for clause, when in enumerate(equations.whens):
        for state, value in when.changes:
            condition, left, right = algebra.polynomials([when.condition, state, value])
            formulas.append(
                Formula(
                    "event", "", collector.collect(left),
                    collector.collect(tidy(equations, algebra, right)), collector.collect(condition), clause,
                )
            )  # fmt: skip
    return formulas


def _roots(equations: EquationsOfMotion, laws: Sequence[Law]) -> list[Node]:
    """Return the expressions that the formulas are made of."""
    return [
        *equations.qdot,
        *[entry for row in equations.mass_rows(range(len(equations.v))) for entry in row.values()],
        *equations.bias_forces,
        *equations.given_forces,
        *[entry for row in equations.rows for entry in row.jacobian.values()],
        *conditions(equations, laws),
    ]


def conditions(equations: EquationsOfMotion, laws: Sequence[Law]) -> list[Node]:
    """Return the expressions that the formulas of constraints, contacts and events are made of."""
    events = [node for when in equations.whens for pair in when.changes for node in pair]
    held = [node for law in laws for node in (law.left, law.right)]
    return [*[row.residual for row in equations.rows], *held, *events]


def shared(roots: Sequence[Node]) -> set[Node]:
    """Sums and products below `roots` that are used more than once."""
    uses: dict[Node, int] = {}
    for node in (*reachable(roots), *roots):
        for below in node.args:
            uses[below] = uses.get(below, 0) + 1
    return {
        node
        for node, times in uses.items()
        if times > 1 and node.op in ("add", "mul") and any(a.args for a in node.args)
    }
