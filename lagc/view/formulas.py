"""The equations of motion as formulas: terms collected, common factors cancelled, names short.

Each equation is the derived one up to a factor that is a number or a product of parameters.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction

from lagc.expr.graph import Node
from lagc.mechanics.equations import EquationsOfMotion
from lagc.view.algebra import Algebra, Exponent, Monomial, Polynomial, divided, scaled
from lagc.view.trigonometry import shorten, unit_quaternion


@dataclass(frozen=True, slots=True)
class Product:
    """coefficient * atom^exponent * ... * (sum)^exponent ..."""

    coefficient: Fraction
    factors: tuple[tuple[int | Sum, Exponent], ...]


@dataclass(frozen=True, slots=True)
class Sum:
    terms: tuple[Product, ...]


@dataclass(frozen=True, slots=True)
class Formula:
    """`left` = `right`; kind kinematic, motion, position, velocity; `label` says of what."""

    kind: str
    label: str
    left: Sum
    right: Sum


@dataclass(frozen=True, slots=True)
class Name:
    """A symbol as people see it: `base` with so many time derivatives; `full` the model's name."""

    base: str
    full: str
    order: int = 0


@dataclass(frozen=True)
class Sheet:
    algebra: Algebra
    names: dict[Node, Name]
    formulas: tuple[Formula, ...]


ZERO = Sum(())


def sheet(equations: EquationsOfMotion) -> Sheet:
    """The formulas of `equations`.  Raises TooLarge where they are too long to be multiplied out."""
    model = equations.model
    parameters = [p.symbol for p in model.parameters] + [i.symbol for i in model.inputs]
    algebra = Algebra(nonnegative=[p.symbol for p in model.parameters if p.minimum >= 0])
    for node in (*parameters, *equations.q, *equations.v, *equations.a, *equations.lam):
        algebra.symbol(node)
    cancelled = {algebra.symbol(p.symbol) for p in model.parameters if p.minimum >= 0 or p.value}
    collector = Collector(
        algebra,
        parameters={algebra.symbol(n) for n in parameters},
        leading=[algebra.symbol(n) for n in equations.a],
        rates={algebra.symbol(n) for n in equations.v},
        trailing=[algebra.symbol(n) for n in equations.lam],
        cancelled=cancelled,
    )
    formulas = [*_kinematic(equations, collector), *_motion(equations, collector), *_rows(equations, collector)]
    return Sheet(algebra, names(equations), tuple(formulas))


def _kinematic(equations: EquationsOfMotion, collector: Collector) -> list[Formula]:
    """q' = N v + n, where that says more than q' = v."""
    own = set(equations.v)
    known = [(i, e) for i, e in enumerate(equations.qdot) if not (e in own and _is_rate(equations, e))]
    formulas = []
    for (i, _), p in zip(known, collector.algebra.polynomials([e for _, e in known])):
        right = collector.factored(tidy(equations, collector.algebra, p))
        left = collector.collect(collector.algebra.single(collector.algebra.symbol(equations.q[i])))
        formulas.append(Formula("kinematic", equations.q_names[i], left, right))
    return formulas


def _is_rate(equations: EquationsOfMotion, speed: Node) -> bool:
    return equations.v_names[equations.v.index(speed)].startswith("der(")


def _motion(equations: EquationsOfMotion, collector: Collector) -> list[Formula]:
    """M a + h - tau - G^T lam = 0, a formula a speed."""
    return [
        Formula("motion", name, collector.collect(collector.cancel(p)), ZERO)
        for name, p in zip(equations.v_names, motion_polynomials(equations, collector.algebra))
    ]


def motion_polynomials(equations: EquationsOfMotion, algebra: Algebra) -> list[Polynomial]:
    """M a + h - tau - G^T lam, shortened, nothing cancelled."""
    found = []
    for i, (h, tau) in enumerate(zip(equations.bias_forces, equations.given_forces)):
        terms: list[tuple[Node, Node]] = []
        for j, a in enumerate(equations.a):
            entry = equations.mass_matrix.get((i, j) if i >= j else (j, i))
            if entry is not None:
                terms.append((entry, a))
        total, force = algebra.polynomials([h, tau])
        total = algebra.add(total, scaled(force, Fraction(-1)))
        for entry, a in terms:
            e, s = algebra.polynomials([entry, a])
            total = algebra.add(total, algebra.multiply(tidy(equations, algebra, e), s))
        for row, lam in zip(equations.rows, equations.lam):
            if i in row.jacobian:
                e, s = algebra.polynomials([row.jacobian[i], lam])
                total = algebra.add(total, scaled(algebra.multiply(e, s), Fraction(-1)))
        found.append(tidy(equations, algebra, total))
    return found


def tidy(equations: EquationsOfMotion, algebra: Algebra, p: Polynomial) -> Polynomial:
    """`p` by the identities of trigonometry and of unit quaternions."""
    p = shorten(algebra, p)
    for i in equations.quaternions:
        w, x, y, z = [algebra.symbol(q) for q in equations.q[i : i + 4]]
        p = unit_quaternion(algebra, p, (w, x, y, z))
    return p


def _rows(equations: EquationsOfMotion, collector: Collector) -> list[Formula]:
    algebra = collector.algebra
    formulas = []
    for row, p in zip(equations.rows, algebra.polynomials([row.residual for row in equations.rows])):
        kind = "position" if row.kind == "holonomic" else "velocity"
        p = tidy(equations, algebra, p)
        by_rate = row.kind == "velocity" and row.linear
        left = collector.collect(p, sorted(collector.rates)) if by_rate else collector.collect(p)
        formulas.append(Formula(kind, row.label, left, ZERO))
    return formulas


@dataclass(frozen=True)
class Collector:
    """Collects terms: accelerations first, multipliers last, parameters gathered before the rest."""

    algebra: Algebra
    parameters: set[int]
    leading: list[int]
    rates: set[int]
    trailing: list[int]
    cancelled: set[int]

    def cancel(self, p: Polynomial) -> Polynomial:
        """`p` without the number and the parameters that all terms share; its first term positive."""
        if not p:
            return p
        c, common, _ = self.algebra.content(p)
        factor = {a: e for a, e in common if a in self.cancelled}
        ordered = sorted(p, key=self._term_key)
        c = abs(c) if p[ordered[0]] > 0 else -abs(c)
        powers = self.algebra.multiply({tuple(sorted((a, -e) for a, e in factor.items())): 1 / c}, p)
        return powers

    def collect(self, p: Polynomial, leading: Sequence[int] | None = None) -> Sum:
        """`p` with the terms of each atom of `leading` (the accelerations) gathered and put first."""
        leading = self.leading if leading is None else leading
        heads = [*leading, *self.trailing]
        parts: dict[int | None, Polynomial] = {}
        for monomial, c in p.items():
            head = next((a for a, e in monomial if e == 1 and a in heads), None)
            rest = tuple([(a, e) for a, e in monomial if a != head])
            parts.setdefault(head, {})[rest] = c
        terms: list[Product] = []
        for head in (*leading, None, *self.trailing):
            if head is None and None in parts:
                terms += sorted(self._gathered(parts[None]), key=self._is_constant)
            elif head in parts:
                terms.append(self._headed(head, parts[head]))
        return Sum(tuple(terms))

    def _headed(self, head: int | None, p: Polynomial) -> Product:
        """p*head, with what the terms of p share before a sum in parentheses."""
        assert head is not None
        if len(p) > 1:
            c, shared, p = self._shared(p)
        else:
            c, shared = Fraction(1), ()
        terms = self._gathered(p)
        if len(terms) == 1:
            (term,) = terms
            return Product(c * term.coefficient, (*sorted((*shared, *term.factors), key=_sums_last), (head, 1)))
        if terms[0].coefficient < 0:
            c, terms = -c, [Product(-t.coefficient, t.factors) for t in terms]
        return Product(c, (*shared, (Sum(tuple(terms)), 1), (head, 1)))

    def _shared(self, p: Polynomial) -> tuple[Fraction, Monomial, Polynomial]:
        """The number and the parameters that all terms of p share, and the rest."""
        c, common, _ = self.algebra.content(p)
        powers = {a: e for a, e in common if a in self.parameters}
        return c, tuple(powers.items()), {divided(m, powers): value / c for m, value in p.items()}

    def factored(self, p: Polynomial) -> Sum:
        """As `collect`, with a number that all terms share before one pair of parentheses."""
        c = self.algebra.content(p)[0]
        if len(p) < 2 or abs(c) == 1:
            return self.collect(p)
        return Sum((Product(c, ((self.collect(scaled(p, 1 / c)), 1),)),))

    def _gathered(self, p: Polynomial) -> list[Product]:
        """Terms with the same coordinates and speeds become one, with a sum of parameters before."""
        groups: dict[Monomial, Polynomial] = {}
        for monomial in sorted(p, key=self._term_key):
            mine = tuple([(a, e) for a, e in monomial if a not in self.parameters])
            coefficient = tuple([(a, e) for a, e in monomial if a in self.parameters])
            groups.setdefault(mine, {})[coefficient] = p[monomial]
        return [self._product(coefficient, mine) for mine, coefficient in groups.items()]

    def _product(self, coefficient: Polynomial, mine: Monomial) -> Product:
        if not mine and len(coefficient) > 1:
            c, common, rest = Fraction(1), (), coefficient
        else:
            c, common, rest = self.algebra.content(coefficient)
        factors: list[tuple[int | Sum, Exponent]] = list(common)
        if rest != {(): 1}:
            inner = tuple([Product(rest[m], tuple(m)) for m in sorted(rest, key=self._term_key)])
            if inner[0].coefficient < 0:
                c, inner = -c, tuple([Product(-t.coefficient, t.factors) for t in inner])
            factors.append((Sum(inner), 1))
        return Product(c, (*factors, *sorted(mine, key=self._factor_key)))

    def _is_constant(self, product: Product) -> bool:
        return all(isinstance(f, Sum) or f in self.parameters for f, _ in product.factors)

    def _factor_key(self, factor: tuple[int, Exponent]) -> tuple[int, int]:
        """In a product: parameters, coordinates, functions, rates."""
        atom, _ = factor
        if self.algebra.atoms[atom].op != "symbol":
            return (2, atom)
        return (0 if atom in self.parameters else 3 if atom in self.rates else 1, atom)

    def _term_key(self, monomial: Monomial) -> tuple[object, ...]:
        """In a sum: accelerations, then high degree in the rates, then the order of the symbols."""
        head = min([a for a, _ in monomial if a in self.leading], default=len(self.algebra.atoms) + 1)
        last = min([a for a, _ in monomial if a in self.trailing], default=-1)
        degree = sum([e for a, e in monomial if a in self.rates])
        functions = len([a for a, _ in monomial if self.algebra.atoms[a].op != "symbol"])
        return (last, head, -degree, functions, monomial)


def _sums_last(factor: tuple[int | Sum, Exponent]) -> bool:
    return isinstance(factor[0], Sum)


def names(equations: EquationsOfMotion) -> dict[Node, Name]:
    """How each symbol is shown: `field.g` as `g` where no other name ends so."""
    model = equations.model
    own = [(p.symbol, p.name) for p in model.parameters] + [(i.symbol, i.name) for i in model.inputs]
    inside = {i + k for i in equations.quaternions for k in range(4)}
    moving = [(s, n) for i, (s, n) in enumerate(zip(equations.q, equations.q_names)) if i not in inside]
    short = _shortener([n for _, n in own + moving] + [n for n in equations.v_names if "(" not in n])
    found = {symbol: Name(short(name), name) for symbol, name in own + moving}
    for i in inside:
        found[equations.q[i]] = Name(equations.q_names[i], equations.q_names[i])
    for speed, acceleration, name in zip(equations.v, equations.a, equations.v_names):
        full = name[4:-1] if name.startswith("der(") else name
        order = 1 if name.startswith("der(") else 0
        base = full if ".rate." in full else short(full)
        found[speed] = Name(base, full, order)
        found[acceleration] = Name(base, full, order + 1)
    for symbol, row in zip(equations.lam, equations.rows):
        found[symbol] = Name(f"lambda_{row.label}", f"lambda_{row.label}")
    taken = {n.base for n in found.values()}
    found[equations.time] = Name("time" if "t" in taken else "t", "time")
    return found


def _shortener(full: Sequence[str]) -> Callable[[str], str]:
    ends: dict[str, set[str]] = {}
    for name in full:
        ends.setdefault(name.rpartition(".")[2], set()).add(name)
    return lambda name: name.rpartition(".")[2] if len(ends.get(name.rpartition(".")[2], ())) == 1 else name
