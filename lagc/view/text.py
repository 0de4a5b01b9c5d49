"""Formulas as plain text: `l*theta'' + g*sin(theta) = 0`."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from contextlib import suppress
from decimal import Context
from fractions import Fraction
from functools import cached_property

from lagc.expr.graph import Node
from lagc.expr.operators import INFIX
from lagc.view.abridged import FEW, TERMS, Series, Term, linear, series
from lagc.view.algebra import HALF, TABLE
from lagc.view.collect import Collector, Product, Sum
from lagc.view.names import Name
from lagc.view.polynomials import Exponent, Frozen

_LONGEST = 10**17  # of an integer with all its digits
_CLEARLY = 5  # characters that a quotient is shorter than the decimal number that it stands for
_DIGITS = Context(prec=17, Emin=-(10**9), Emax=10**9)


class TextWriter:
    """Writes sums and products; a subclass changes a notation by overriding one small method."""

    times = "*"
    index = re.compile(r"(?<=[\[,])\d+(?=[,\]])")

    def __init__(self, collector: Collector, names: Mapping[Node, Name], abridged: bool = False) -> None:
        """`abridged`: long sums are written as series, and cut."""
        self.collector, self.abridged = collector, abridged
        self.algebra = collector.algebra
        self.names = names
        self.seen: set[Name] = set()

    # -- sums and products ----------------------------------------------------

    def sum(self, terms: Sum) -> str:
        if self.abridged and len(terms.terms) > FEW:
            return self._abridged(terms)
        return self._added([self.product(product) for product in terms.terms])

    def _abridged(self, terms: Sum) -> str:
        plain = [Term(x.coefficient, self.product(Product(Fraction(1), x.factors))) for x in terms.terms]
        parts = series(plain, self.index)
        cut = self.more(len(parts) - TERMS) if len(parts) > TERMS else ""
        return self._added([self._part(part) for part in parts[:TERMS]]) + cut

    def _part(self, part: Term | Series) -> str:
        if isinstance(part, Term):
            return self._times(part.coefficient, part.text)
        k = self._variable
        pieces = [part.pieces[0]]
        for index, piece in zip(part.indices, part.pieces[1:]):
            pieces += [linear(*index, k, self.times), piece]
        text = "".join(pieces)
        if part.weight[1]:
            weight = linear(*part.weight, k, self.times)
            text = f"{self.parentheses(weight) if part.weight[0] else weight}{self.times}{text}"
        sign = "-" if part.factor < 0 else ""
        return sign + self.series(k, part.first, part.last, self._times(abs(part.factor), text))

    def _times(self, c: Fraction, text: str) -> str:
        """A coefficient and the rest of a product."""
        top, bottom = self.coefficient(abs(c))
        factor = self.quotient(top, [], bottom, [])
        return ("-" if c < 0 else "") + (text if factor == "1" else f"{factor}{self.times}{text}")

    @cached_property
    def _variable(self) -> str:
        """The letter that counts in series."""
        taken = {name.base.partition("[")[0] for name in self.names.values()}
        return next(x for x in ("k", "j", "m", "n", "index", "count") if x not in taken or x == "count")

    def series(self, variable: str, first: int, last: int, text: str) -> str:
        return f"sum({variable} = {first}..{last}, {text})"

    def more(self, count: int) -> str:
        return f" + ... ({count} more terms)"

    def _added(self, parts: Sequence[str]) -> str:
        text = ""
        for written in parts:
            if not text:
                text = written
            elif written.startswith("-"):
                text += f" - {written[1:]}"
            else:
                text += f" + {written}"
        return text or "0"

    def product(self, product: Product) -> str:
        c = product.coefficient
        over = [self.factor(f, e) for f, e in product.factors if e > 0]
        under = [self.factor(f, -e) for f, e in product.factors if e < 0]
        sign = "-" if c < 0 else ""
        top, bottom = self.coefficient(abs(c))
        return sign + self.quotient(top, over, bottom, under)

    def quotient(self, top: str, over: list[str], bottom: str, under: list[str]) -> str:
        above = self.times.join(([top] if top != "1" or not over else []) + over)
        below = ([bottom] if bottom != "1" else []) + under
        if not below:
            return above
        return f"{above}/{below[0]}" if len(below) == 1 else f"{above}/({self.times.join(below)})"

    def coefficient(self, c: Fraction) -> tuple[str, str]:
        """c >= 0 as the number above and the number below the line."""
        above, below, written = str(c.numerator), str(c.denominator), _decimal(c)
        if (c.denominator <= 99 and c.numerator < _LONGEST) or len(above + below) + _CLEARLY < len(written):
            return above, below
        return self.decimal(written), "1"

    def decimal(self, written: str) -> str:
        return written

    def factor(self, base: int | Sum, exponent: Exponent) -> str:
        if not isinstance(base, Sum) and base in self.algebra.named:
            name = self.symbol(self.algebra.named[base], 1)
            return self.root(name) if exponent == HALF else self.raised(name, exponent)
        atomic = isinstance(base, Sum) or self.algebra.atoms[base].op == "sum"
        if exponent.denominator == 2 and atomic:
            if exponent == HALF:
                return self.root(self._inside(base))
            return self.raised(self.parentheses(self._inside(base)), exponent)
        if atomic:
            return self.raised(self.parentheses(self._inside(base)), exponent)
        assert not isinstance(base, Sum)
        return self.atom(base, exponent)

    def _inside(self, base: int | Sum) -> str:
        return self.sum(base) if isinstance(base, Sum) else self.frozen(self.algebra.atoms[base].args[0])

    def frozen(self, p: Frozen) -> str:
        return self.sum(self.collector.inside(dict(p)))

    # -- notation -------------------------------------------------------------

    def parentheses(self, text: str) -> str:
        return f"({text})"

    def root(self, text: str) -> str:
        return f"sqrt({text})"

    def raised(self, base: str, exponent: Exponent) -> str:
        if exponent == 1:
            return base
        return f"{base}^{exponent}" if exponent.denominator == 1 else f"{base}^({exponent})"

    def atom(self, number: int, exponent: Exponent) -> str:
        atom = self.algebra.atoms[number]
        if atom.node is not None:
            return self.symbol(atom.node, exponent)
        return self.function(atom.op, [self.frozen(a) for a in atom.args], exponent)

    def symbol(self, node: Node, exponent: Exponent) -> str:
        name = self.named(node)
        text = node.record.name if name is None else name.base + "'" * name.order
        return self.raised(text, exponent)

    def named(self, node: Node) -> Name | None:
        name = self.names.get(node)
        if name is not None:
            self.seen.add(name)
        return name

    def function(self, op: str, args: list[str], exponent: Exponent) -> str:
        if op == "abs":
            return self.raised(f"|{args[0]}|", exponent)
        if op in INFIX:
            text = f"({args[0]} {INFIX[op]} {args[1]})"
        elif op == "pow":
            text = f"(({args[0]})^({args[1]}))"
        elif op == "select":
            text = f"(if {args[0]} then {args[1]} else {args[2]})"
        else:
            text = f"{op.removeprefix(TABLE)}({', '.join(args)})"
        return self.raised(text, exponent)


def _decimal(c: Fraction) -> str:
    """c > 0 with the digits of a double, also where none is as large or as small."""
    with suppress(OverflowError):
        if float(c) > 0.0:
            return repr(float(c))
    top, bottom = (_DIGITS.create_decimal(number) for number in (c.numerator, c.denominator))
    return f"{_DIGITS.divide(top, bottom).normalize(_DIGITS):e}"
