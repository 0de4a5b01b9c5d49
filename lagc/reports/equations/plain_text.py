"""Formulas as plain text: `l*theta'' + g*sin(theta) = 0`."""

import re
from collections.abc import Mapping, Sequence
from contextlib import suppress
from decimal import MAX_EMAX, MIN_EMIN, Context
from fractions import Fraction

from lagc.reports.algebra.expansion import HALF, TABLE
from lagc.reports.algebra.polynomials import Exponent, number_content
from lagc.reports.names import Name, Names
from lagc.reports.patterns.formula_trees import (
    Call,
    Counters,
    Form,
    Line,
    Linear,
    Number,
    Part,
    Symbol,
    Term,
    Total,
    filled,
)
from lagc.symbolic.graph import Node
from lagc.symbolic.operators import INFIX

TERMS = 30  # of a sum that is cut

_LONGEST = 10**17  # of an integer with all its digits
_CLEARLY = 5  # characters that a quotient is shorter than the decimal number that it stands for
_DIGITS = Context(prec=17, Emin=MIN_EMIN, Emax=MAX_EMAX)


class TextWriter:
    """Writes forms; a subclass changes a notation by overriding one small method."""

    times = "*"
    relations: Mapping[str, str] = {
        "=": "{} = {}",
        "contact": "{} >= {}",
        "complement": "0 <= {}  _|_  {} >= 0",
        "bound": "{} <= {}",
        "stick": "{} <= {}  if {} = 0",
        "slip": "{} = {}  if {} <> 0",
        "impact": "{} := {}",
        "event": "{} := {}  when {}",
    }

    def __init__(self, names: Names, cut: bool = False) -> None:
        """`cut`: of sums of many terms some are written."""
        self.names, self.cut = names, cut
        self.seen: set[Name] = set()

    def line(self, line: Line) -> str:
        condition = "" if line.condition is None else self.total(line.condition)
        written = self.relations.get(line.kind, self.relations["="])
        return written.format(self.total(line.left), self.total(line.right), condition) + self.counters(
            line.counters
        )

    # -- sums and products ----------------------------------------------------

    def total(self, found: Total) -> str:
        parts = [self.part(part) for part in (found.terms[:TERMS] if self.cut else found.terms)]
        left = len(found.terms) - len(parts)
        return self._added(parts) + (self.more(left) if left else "")

    def part(self, part: Part) -> str:
        if isinstance(part, Term):
            return self.term(part)
        first, last = self.number(part.first), self.number(part.last)
        body = self.part(part.body)
        sign = "-" if body.startswith("-") else ""
        return sign + self.series(part.counter, first, last, body.removeprefix("-"))

    def series(self, counter: str, first: str, last: str, text: str) -> str:
        return f"sum({counter} = {first}..{last}, {text})"

    def counters(self, counters: Counters) -> str:
        """The values that they take."""
        ranges = [f"{k} = {self.number(a)}..{self.number(b)}" for k, a, b in counters]
        return f"    for {', '.join(ranges)}" if ranges else ""

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

    def term(self, term: Term) -> str:
        over = [self.factor(f, e) for f, e in term.factors if e > 0]
        under = [self.factor(f, -e) for f, e in term.factors if e < 0]
        sign = "-" if term.negative else ""
        top, bottom = self.coefficient(term.size)
        return sign + self.quotient(top, over, bottom, under)

    def quotient(self, top: str, over: list[str], bottom: str, under: list[str]) -> str:
        above = self.times.join(([top] if top != "1" or not over else []) + over)
        below = ([bottom] if bottom != "1" else []) + under
        if not below:
            return above
        return f"{above}/{below[0]}" if len(below) == 1 else f"{above}/({self.times.join(below)})"

    def coefficient(self, c: Number) -> tuple[str, str]:
        """c >= 0 as the number above and the number below the line."""
        if isinstance(c, Linear):
            return self._counting(c)
        above, below, written = str(c.numerator), str(c.denominator), _decimal(c)
        if (c.denominator <= 99 and c.numerator < _LONGEST) or len(above + below) + _CLEARLY < len(written):
            return above, below
        return self.decimal(written), "1"

    def _counting(self, c: Linear) -> tuple[str, str]:
        """Return a coefficient that counts: integers in parentheses behind their common factor, over a
        number."""
        numbers = [Fraction(x) for x in (c.constant, *[slope for _, slope in c.slopes])]
        unit = number_content([x for x in numbers if x])
        whole = Linear(numbers[0] / unit, tuple([(k, x / unit) for (k, _), x in zip(c.slopes, numbers[1:])]))
        top, bottom = self.coefficient(unit)
        text = self.number(whole)
        text = text if re.fullmatch(r"\w+", text) else self.parentheses(text)
        return (text if top == "1" else f"{top}{self.times}{text}"), bottom

    def number(self, number: Number) -> str:
        """Return a number of an index, or of the bound of a sum: `k + 1`, `13 - k`."""
        if not isinstance(number, Linear):
            return str(number)
        parts = [
            ("-" if c < 0 else "") + (k if abs(c) == 1 else f"{abs(c)}{self.times}{k}")
            for k, c in number.slopes
        ]
        parts.sort(key=lambda part: part.startswith("-"))
        constant = [str(number.constant)] if number.constant else []
        first = number.constant > 0 and parts[0].startswith("-")
        return self._added([*constant, *parts] if first else [*parts, *constant])

    def decimal(self, written: str) -> str:
        return written

    def factor(self, form: Form, exponent: Exponent) -> str:
        if isinstance(form, Symbol):
            if exponent == HALF and form.node.record.kind == "shown part":
                return self.root(self.symbol(form, 1))
            return self.symbol(form, exponent)
        if isinstance(form, Call):
            return self.function(form.op, [self.total(x) for x in form.args], exponent)
        if exponent == HALF:
            return self.root(self.total(form))
        return self.raised(self.parentheses(self.total(form)), exponent)

    # -- notation -------------------------------------------------------------

    def parentheses(self, text: str) -> str:
        return f"({text})"

    def root(self, text: str) -> str:
        return f"sqrt({text})"

    def raised(self, base: str, exponent: Exponent) -> str:
        if exponent == 1:
            return base
        return f"{base}^{exponent}" if exponent.denominator == 1 else f"{base}^({exponent})"

    def symbol(self, symbol: Symbol, exponent: Exponent) -> str:
        name = self.named(symbol.node)
        if name is None:
            return self.raised(symbol.node.record.name, exponent)
        return self.raised(self.indexed(name.base, symbol) + "'" * name.order, exponent)

    def indexed(self, text: str, symbol: Symbol | Line) -> str:
        return filled(text, [self.number(x) for x in symbol.indices])

    def named(self, of: Node | str) -> Name | None:
        name = self.names.get(of)
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
            text = f"{self.table(op) if op.startswith(TABLE) else op}({', '.join(args)})"
        return self.raised(text, exponent)

    def table(self, op: str) -> str:
        """Return the name of a table, with a prime for each slope."""
        own = op.rstrip("'")
        name = self.named(own)
        assert name is not None, op
        return self.slope(name.base, op[len(own) :])

    def slope(self, base: str, primes: str) -> str:
        return base + primes


def _decimal(c: int | Fraction) -> str:
    """c > 0 with the digits of a double, also where none is as large or as small."""
    with suppress(OverflowError):
        if float(c) > 0.0:
            return repr(float(c))
    top, bottom = (_DIGITS.create_decimal(number) for number in (c.numerator, c.denominator))
    return f"{_DIGITS.divide(top, bottom).normalize(_DIGITS):e}"
