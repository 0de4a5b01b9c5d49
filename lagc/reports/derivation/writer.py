"""Formulas of a solution, by the algebra and the writer of `lagc equations`.

Every formula that is written is recorded with the expression that it stands for, so that tests can compare
their values.
"""

import re
from collections.abc import Sequence
from fractions import Fraction
from math import isqrt

from lagc.base.records import dataclass
from lagc.reports.algebra.collect import Product, Sum, positive_first
from lagc.reports.algebra.expansion import TABLE, TooLarge
from lagc.reports.algebra.polynomials import Exponent, Frozen, NotFinite, Polynomial, frozen
from lagc.reports.algebra.trigonometric_identities import TurningAlgebra
from lagc.reports.derivation.phrases import Phrases
from lagc.reports.derivation.rates import Rates
from lagc.reports.equations.formulas import SymbolKinds, collector_of, nonnegative, tidy
from lagc.reports.equations.latex import VERBATIM, LatexWriter, letter
from lagc.reports.names import Name, names
from lagc.reports.patterns.formula_trees import Former, Symbol, Total, indices
from lagc.symbolic.graph import Node
from lagc.symbolic.walk import reachable

WIDTH = 64  # characters that are seen on a line
MOST, SHOWN = 40, 8  # terms of a formula that is written in full; terms shown of a longer one
PRODUCTS, FEWER = 10_000, 3_000  # of one formula; of a vector in one set of unit vectors
LONGEST = 200  # terms of a sum that is multiplied out
ROOT_TERMS = 5  # of a sum whose square is looked for


class StarWriter(LatexWriter):
    """A fraction of numbers stands before its product; virtual rates have a star; a part that stays together
    is written with parentheses."""

    def __init__(self, shown: dict[Node | str, Name], rates: dict[Node, Node]):
        super().__init__(shown)
        self.rates = rates  # of virtual rates
        self.parts: dict[Node, str] = {}

    def quotient(self, top: str, over: list[str], bottom: str, under: list[str]) -> str:
        if under or bottom == "1" or not over:
            return super().quotient(top, over, bottom, under)
        return self.times.join([rf"\tfrac{{{top}}}{{{bottom}}}", *over])

    def symbol(self, symbol: Symbol, exponent: Exponent) -> str:
        if symbol.node in self.parts:
            return self.raised(rf"\left({self.parts[symbol.node]}\right)", exponent)
        rate = self.rates.get(symbol.node)
        if rate is None:
            return super().symbol(symbol, exponent)
        return super().symbol(Symbol(rate, symbol.kind, symbol.indices), Fraction(1)) + "^{*}"


@dataclass(frozen=True, slots=True)
class Written:
    """The sum of forms, each times the value of its node, stands for `node`."""

    about: str
    forms: tuple[tuple[Total, Node], ...]
    node: Node


class FormulaWriter:
    """Writes expressions in LaTeX. Beyond `MOST` terms a formula is abbreviated, unless it is written `full`;
    `abbreviated` counts them."""

    def __init__(self, rates: Rates, say: Phrases, full: bool = False):
        self.rates, self.graph, self.say, self.full = rates, rates.graph, say, full
        equations = rates.equations
        self.names = names(equations)
        for node in (*rates.states.v, *rates.states.a):
            record = node.record
            self.names.setdefault(node, Name(record.base, record.base, record.order))
        for rate, star in rates.stars.items():
            self.names[star] = self.names[rate]
        self.algebra = TurningAlgebra(nonnegative(equations))
        self.collector = collector_of(SymbolKinds(equations), self.algebra)
        self.collector.leading.extend(self.algebra.symbol(a) for a in rates.states.a if a not in equations.a)
        self.stars = [self.algebra.symbol(s) for s in rates.stars.values()]
        self.collector.rates.update(self.algebra.symbol(v) for v in rates.states.v)
        self.collector.rates.update(self.stars)
        self.latex = StarWriter(self.names, {star: rate for rate, star in rates.stars.items()})
        self.former = Former(self.collector, self.names)
        self.parts: dict[Frozen, Node] = {}
        self.meanings: dict[Node, Node] = {}  # of the symbols of parts
        self.written: list[Written] = []
        self.abbreviated = 0

    # -- polynomials --------------------------------------------------------------------------------

    def polynomials(self, nodes: Sequence[Node], products: int = PRODUCTS) -> list[Polynomial]:
        """Raises NotFinite, and TooLarge where they take more than so many products, or are too long."""
        self.algebra.limit = self.algebra.spent + products
        found = self.algebra.polynomials(list(nodes))
        found = [tidy(self.rates.equations, self.algebra, p) for p in found]
        if any(len(p) > LONGEST for p in found):
            raise TooLarge
        return found

    def polynomial(self, node: Node) -> Polynomial:
        return self.polynomials([node])[0]

    def is_zero(self, node: Node) -> bool:
        """Whether it vanishes when it is multiplied out."""
        try:
            return node.is_zero or not self.polynomial(node)
        except (TooLarge, NotFinite):
            return False

    def node_of(self, p: Polynomial) -> Node:
        """Return the expression of a polynomial. Raises TooLarge for tables and functions of three
        arguments."""
        graph, atoms, total = self.graph, self.algebra.atoms, self.graph.zero
        for monomial, c in p.items():
            term = graph.const(float(c))
            for number, e in monomial:
                atom = atoms[number]
                base = atom.node
                if base is None:
                    args = [self.node_of(dict(arg)) for arg in atom.args]
                    base = args[0] if atom.op == "sum" else self._function(atom.op, args)
                term = term * (base ** int(e) if e == int(e) else graph.sqrt(base) ** int(2 * e))
            total = total + term
        return total

    def _function(self, op: str, args: Sequence[Node]) -> Node:
        if len(args) > 2 or op.startswith(TABLE):
            raise TooLarge
        return self.graph.unary(op, args[0]) if len(args) == 1 else self.graph.binary(op, args[0], args[1])

    def part(self, p: Polynomial) -> Node:
        """Return a symbol for a sum that stays together."""
        key = frozen(p)
        if key not in self.parts:
            node = self.parts[key] = self.graph.symbol("part", str(len(self.parts)))
            form = self.total(p)
            self.latex.parts[node] = self.latex.total(form)
            self.names[node] = Name(f"part {len(self.parts)}", f"part {len(self.parts)}")
            self.collector.rates.add(self.algebra.symbol(node))
            self.meanings[node] = self.node_of(p)
            self.record("a sum that stays together", form, self.meanings[node])
        return self.parts[key]

    def symbols_in(self, p: Polynomial) -> set[Node]:
        """Return the symbols in a polynomial and in its functions."""
        found, pending = set[Node](), [dict(p)]
        while pending:
            for number in {number for monomial in pending.pop() for number, _ in monomial}:
                atom = self.algebra.atoms[number]
                found.update([atom.node] if atom.node is not None else [])
                pending += [dict(arg) for arg in atom.args]
        return found

    # -- forms --------------------------------------------------------------------------------------

    def total(self, p: Polynomial, leading: Sequence[int] | None = None) -> Total:
        """Return the terms of `p`, those of each atom in `leading` gathered."""
        found = self.collector.collect(p, leading)
        return self.former.total(Sum(positive_first(found.terms)) if leading is None else found)

    def factored(self, p: Polynomial, leading: Sequence[int] | None = None) -> Total:
        """Return `p` as one product, where its terms share a factor: that before one pair of parentheses."""
        c, common, rest = self.algebra.content(p)
        if len(p) < 2 or not common:
            return self.total(p, leading)
        if c < 0 and any(x < 0 for x in rest.values()):
            c, rest = -c, {m: -x for m, x in rest.items()}
        root = self._square_root(rest)
        inner = Sum(positive_first(self.collector.collect(root or rest, leading).terms))
        moving = self.collector.rates
        before = [(a, e) for a, e in common if a not in moving]
        after = [(a, e) for a, e in common if a in moving]
        exponent = 1 if root is None else 2
        return self.former.total(Sum((Product(c, (*before, (inner, exponent), *after)),)))

    def _square_root(self, p: Polynomial) -> Polynomial | None:
        """Return s with p = s^2, if s is a sum of a few terms."""
        roots: Polynomial = {}
        for m, c in p.items():
            root = Fraction(isqrt(abs(c.numerator)), isqrt(c.denominator))
            if all(e % 2 == 0 for _, e in m) and root * root == c:
                roots[tuple([(a, e // 2) for a, e in m])] = root
        n = len(roots)
        if not 2 <= n <= ROOT_TERMS or n * (n + 1) // 2 != len(p):
            return None
        first, *others = sorted(roots)
        for signs in range(2 ** len(others)):
            s = {m: roots[m] * (-1 if signs >> k & 1 else 1) for k, m in enumerate(others)}
            s[first] = roots[first]
            if self.algebra.multiply(s, s) == p:
                return s
        return None

    def record(self, about: str, form: Total, node: Node) -> None:
        self.written.append(Written(about, ((form, self.graph.one),), node))

    # -- text ---------------------------------------------------------------------------------------

    def lines(
        self, node: Node, about: str, leading: Sequence[int] | None = None, width: int = WIDTH,
        of: Node | None = None,
    ) -> tuple[str, ...]:  # fmt: skip
        """Return a sum as lines of `width`. It is recorded as that of `node`, or of an equal expression
        `of`."""
        try:
            form = self.total(self.polynomial(node), leading)
        except (TooLarge, NotFinite):
            self.abbreviated += 1
            return (rf"\text{{({self.say('parts', len(reachable([node])))})}}",)
        return self.shown(form, about, node if of is None else of, width)

    def shown(self, form: Total, about: str, node: Node, width: int = WIDTH) -> tuple[str, ...]:
        """Return a form as lines; it is recorded as that of `node`."""
        self.record(about, form, node)
        terms = [self.latex.part(x) for x in form.terms] or ["0"]
        if len(terms) > MOST and not self.full:
            self.abbreviated += 1
            more = self.say("more_terms", len(terms) - SHOWN)
            terms = [*terms[:SHOWN], rf"\ldots \ \text{{({more})}}"]
        return broken(terms, width)

    def text(self, node: Node, about: str = "") -> str:
        """Return the formula of an expression on one line."""
        return "".join(self.lines(node, about, width=10**9))

    def symbol(self, node: Node) -> str:
        """Return the letters of a symbol."""
        return self.latex.symbol(Symbol(node, node, indices(self.names[node].base)), Fraction(1))

    def name(self, name: str) -> str:
        """Return a name of the model as a letter with subscripts."""
        return letter(name)


def subscript(name: str) -> str:
    """Return a name of the model as it stands in a subscript."""
    base = name.rpartition(".")[2]
    return base if len(base) == 1 else rf"\mathrm{{{words(base)}}}"


def words(name: str) -> str:
    """Return a name as words between the braces of `\\text`."""
    return name.replace("_", " ").translate(VERBATIM)


def seen_width(text: str) -> int:
    """Return about how many characters of a formula are seen on its line."""
    text = re.sub(r"\\(left|right|,|;|quad|mathrm|mathit|vec|dot|ddot|text|underbrace)(?![a-z])", "", text)
    text = re.sub(r"\\t?frac\{(\d+)\}\{\d+\}", r"\1", text)
    text = re.sub(r"\\[A-Za-z]+", "x", re.sub(r"\\(sin|cos|tan)", "xxx", text))
    return len(re.sub(r"[{}^_ ]", "", re.sub(r" [-+] ", "+++", text)))


def width_of(lines: Sequence[str]) -> int:
    return sum(map(seen_width, lines))


def broken(terms: Sequence[str], width: int = WIDTH) -> tuple[str, ...]:
    """Return terms, added, in lines of about `width` characters."""
    lines, line = [], ""
    for k, term in enumerate(terms):
        text = term if not k else f" - {term[1:]}" if term.startswith("-") else f" + {term}"
        if line and seen_width(line) + seen_width(text) > width:
            lines.append(line)
            line = ""
        line += text
    return (*lines, line)


def is_sum(text: str) -> bool:
    """Whether a formula has several terms, outside of all braces and parentheses."""
    depth = 0
    for piece in re.findall(r"\\left|\\right|[{}]| [-+] ", text):
        depth += {"{": 1, r"\left": 1, "}": -1, r"\right": -1}.get(piece, 0)
        if piece.strip() in "+-" and depth == 0:
            return True
    return False


def split_sign(text: str) -> tuple[str, str]:
    """Return the sign "-" of a single term and the term without it; "" and the formula otherwise."""
    return ("-", text[1:]) if text.startswith("-") and not is_sum(text[1:]) else ("", text)


def in_parentheses(text: str) -> str:
    """Return `text` in parentheses where it is a sum or has a sign."""
    return rf"\left({text}\right)" if is_sum(text) or text.startswith("-") else text
