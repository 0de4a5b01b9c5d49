"""Zero test of expressions: exact evaluation at random points of a finite field.

A symbol is a random integer modulo the prime P.  Sums, products and quotients are those of the field.  An
angle is a random point of the circle c^2 + s^2 = 1 with the addition theorems.  A function without known
relations has random values, the same for the same arguments.  All these maps preserve sums, products and
relations, so an expression that vanishes identically vanishes here.  A non-zero rational function of symbols,
circles and exponentials vanishes at a random point with a probability of its degree over P = 2^61 (J. T.
Schwartz, *J. ACM* 27, 1980; R. Zippel, 1979).  Nothing is expanded, and a coefficient of 1e-300 counts like
any other.  Signs of roots are drawn with the point.
"""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from fractions import Fraction
from typing import Any, TypeAlias

from lagc.symbolic.graph import Node
from lagc.symbolic.operators import LOOKED_UP
from lagc.symbolic.walk import missing

P = (1 << 61) - 1  # a Mersenne prime, 3 modulo 4: u^((P + 1)/4) is a root of u where there is one
_PARTS = 72_072_000  # angles and exponents are whole multiples of these parts of their terms
_MOST_ROOTS = 8  # the largest number of roots for which one symbol is drawn
_MOST_DECIMALS = 20  # the largest number whose products are compared
_ULPS = 4
_MOST_TURNS, _FINEST_TURN = 1000, 360
WRITTEN = 12  # digits: decimal numbers with at most these are taken as written

Linear: TypeAlias = dict["int | str", Fraction]  # value of a term -> coefficient; "1": a number; "pi"
Circle: TypeAlias = tuple[int, int]  # cosine, sine


class Undefined(Exception):
    """The expression has no value at this point: a division by zero, or no square root."""


class Point:
    """Values of symbols and functions, drawn from `seed` unless they are set.

    `exact`: every function so far has all of its relations, so an expression that is not zero here is not
    identically zero.  `rooted`: roots occurred, whose signs are drawn, and the statement holds for
    expressions that are zero for no choice of signs.  With `roots` False a root is a function without
    relations.  Decimal numbers of up to `digits` digits are taken as written."""

    def __init__(self, seed: int, roots: bool = True, digits: int = WRITTEN) -> None:
        self._state = 2 * seed + 1
        self._roots, self._digits = roots, digits
        self.exact, self.rooted = True, False
        self.symbols: dict[Node, int] = {}
        self._drawn: dict[tuple[object, ...], int] = {}
        self._numbers: dict[float, int] = {}
        self._decimals: dict[float, int] = {}
        self._known: dict[Node, int] = {}
        self._forms: dict[Node, Linear] = {}
        self._circles: dict[Node, Circle] = {}  # cosine and sine of each
        self._found: tuple[dict[Node, Any], ...] = (self._known, self._forms, self._circles)

    def draw(self) -> int:
        """Return a random number from 1 to P - 1."""
        # A 128-bit linear congruential generator, its upper half: the same points on every machine.
        self._state = (self._state * 47026247687942121848144207491837523525 + 1) % (1 << 128)
        return (self._state >> 64) % (P - 1) + 1

    def place(self, values: Mapping[Node, int]) -> None:
        self.symbols.update(values)
        for found in self._found:
            found.clear()

    def keep(self, values: Mapping[Node, float]) -> None:
        """Set the values of symbols to these numbers."""
        self.place({symbol: self._number(value) for symbol, value in values.items()})

    def seek_roots(self, under: Sequence[Node], truths: Mapping[Node, int]) -> bool:
        """Draw symbols until all nodes in `under` are squares.  Return False if there are too many. Every
        second random number is a square, so symbols are drawn one by one.  Call it before any value is
        known."""
        # A symbol is drawn again until all roots that are complete with it have squares below them. Values
        # that later symbols do not change are kept.
        order = list[tuple[Node, list[Node]]]()  # symbols, and the nodes that have a value once it is known
        latest = dict[Node, int]()  # position of the last symbol below a node
        for x in under:
            for node in missing([x], latest):
                latest[node] = max([latest[a] for a in node.args], default=-1)
                if node.op == "symbol":
                    latest[node] = len(order)
                    order.append((node, []))
            if latest[x] >= 0:
                order[latest[x]][1].append(x)
        for symbol, ready in order:
            before = [len(found) for found in self._found]  # entries that later symbols do not change
            for _ in range(8 << len(ready) if len(ready) <= _MOST_ROOTS else 0):
                self.symbols[symbol] = self.draw()
                if self._all_squares(ready, truths):
                    break
                for found, kept in zip(self._found, before):
                    while len(found) > kept:
                        found.popitem()
            else:
                return False
        return True

    def _all_squares(self, nodes: Sequence[Node], truths: Mapping[Node, int]) -> bool:
        """Return whether all nodes are squares, tested in order because later ones may contain earlier
        roots."""
        try:
            return all(is_square(self.values([node], truths)[0]) for node in nodes)
        except Undefined:
            return False

    def values(self, nodes: Sequence[Node], truths: Mapping[Node, int] | None = None) -> list[int]:
        """Return the values of `nodes`; `truths` holds all comparisons in them, the same at every call.
        Raises Undefined."""
        known = self._known
        for node in missing(nodes, known):
            known[node] = self._value(node, truths or {})
        return [known[node] for node in nodes]

    def _value(self, node: Node, truths: Mapping[Node, int]) -> int:
        # The operations of the field; choices are blended by their share, truth values are 0, 1 or a share:
        # `and` is the product, `not` 1 - x.
        op, known = node.op, self._known
        if op == "add":
            return (known[node.args[0]] + known[node.args[1]]) % P
        if op == "mul":
            product = 1
            for base, exponent in zip(node.args, node.value):
                product = product * power(known[base], exponent) % P
            return product
        if op == "scale":
            return self._number(node.value) * known[node.args[0]] % P
        if op == "const":
            return self._number(node.value)
        if op == "symbol":
            if node not in self.symbols:
                self.symbols[node] = self.draw()
            return self.symbols[node]
        if op == "select":
            share, x, y = (known[a] for a in node.args)
            return (share * x + (1 - share) * y) % P
        if op in ("lt", "le", "eq"):
            return truths[node]
        if op == "not":
            return (1 - known[node.args[0]]) % P
        if op in ("and", "or"):
            one, other = (known[a] for a in node.args)
            both = one * other
            return (both if op == "and" else one + other - both) % P
        return self._function(node, op)

    def _function(self, node: Node, op: str) -> int:
        # Functions with identities (circle, exponential, roots, stairs) follow these; all others are random,
        # and then a value that is not zero refutes nothing.
        x = self._known[node.args[0]]
        if op in ("sin", "cos", "tan"):
            c, s = self._circle_of(node.args[0])
            return s if op == "sin" else c if op == "cos" else s * power(c, -1) % P
        if op in ("exp", "sinh", "cosh", "tanh"):
            return self._exponential(op, self._form(node.args[0]))
        if op == "sqrt":
            return self._root(x)
        if op == "pow":
            return self._pow(x, node.args[1])
        if op == "floor":
            return self._floor(x, self._form(node.args[0]))
        if op in LOOKED_UP:
            return self._random_value(op, node.value, x)
        self.exact = False
        return self._random_value(op, *(self._known[a] for a in node.args))

    def _random_value(self, *key: object) -> int:
        """Return a random value, the same for the same `key`."""
        if key not in self._drawn:
            self._drawn[key] = self.draw()
        return self._drawn[key]

    # -- numbers ---------------------------------------------------------------

    def _number(self, value: float) -> int:
        if value not in self._numbers:
            self._numbers[value] = self._exact_number(value)
        return self._numbers[value]

    def _exact_number(self, value: float) -> int:
        # Floats are taken for the numbers that they stand for: multiples of pi, decimals as written,
        # fractions. Another float is a number without known relations.
        if not math.isfinite(value):
            self.exact = False
            return self._random_value("not finite", repr(value))
        turns = turns_of(value)
        if turns:
            return residue(turns) * self._random_value("pi") % P
        meant = fraction(value, self._digits)
        if meant is None:
            self.exact = False
            return self._rounded_number(value)
        return residue(meant)

    def _rounded_number(self, value: float) -> int:
        """Return the value of a rounded decimal number. It is random, except for multiples, products and
        quotients of earlier ones, and cosines of numbers that are sines."""
        # Earlier decimals, their inverses and products of two: a quotient of small fractions to round-off
        # says that both are multiples.
        found = self._decimals.items()
        bases = [*found, *((1.0 / a, power(x, -1)) for a, x in found if a)]
        if len(bases) <= _MOST_DECIMALS:
            bases += [(a * b, x * y) for n, (a, x) in enumerate(bases) for b, y in bases[: n + 1]]
        for known, number in bases:
            quotient = value / known if known else 0.0  # a product may overflow
            ratio = Fraction(quotient if math.isfinite(quotient) else 0.0).limit_denominator(100)
            if ratio and abs(float(ratio) * known - value) <= _ULPS * math.ulp(value):
                return residue(ratio) * number % P
        # A new decimal is the sine of a random angle: so its sine and cosine fulfil s^2 + c^2 = 1.
        cosine, sine = self._circle(value)
        self._decimals[value] = sine
        if abs(value) < 1.0:
            self._decimals[math.sqrt(1.0 - value * value)] = cosine
        return sine

    def _circle(self, key: object) -> Circle:
        # The rational parametrization of the circle: ((1 - u^2) / (1 + u^2), 2 u / (1 + u^2)).
        u = self._random_value("circle", key)
        whole = power(1 + u * u, -1)
        return (1 - u * u) * whole % P, 2 * u * whole % P

    # -- functions -------------------------------------------------------------

    def _form(self, node: Node) -> Linear:
        """Return `node` as a linear form, which the addition theorems of circles and exponentials need."""
        # Without recursion: arguments of sums and factors first.
        forms = self._forms
        stack = [node]
        while stack:
            top = stack[-1]
            inner = [a for a in top.args if a not in forms] if top.op in ("add", "scale") else []
            if inner:
                stack.extend(inner)
                continue
            stack.pop()
            if top not in forms:
                forms[top] = self._split(top)
        return forms[node]

    def _split(self, node: Node) -> Linear:
        if node.op == "add":
            # Sums stay linear forms of their terms with exact coefficients, so that equal decimals cancel.
            total = dict(self._forms[node.args[0]])
            for term, c in self._forms[node.args[1]].items():
                total[term] = total.get(term, Fraction(0)) + c
            return {term: c for term, c in total.items() if c}
        if node.op == "const":
            turns, number = turns_of(node.value), fraction(node.value, self._digits)
            if turns:
                return {"pi": turns}
            if number is not None:
                return {"1": number} if number else {}
        elif node.op == "scale":
            turns, number = turns_of(node.value), fraction(node.value, self._digits)
            if not turns and number is not None:
                return {term: number * c for term, c in self._forms[node.args[0]].items()}
            if turns:
                node = node.args[0]
                return self._term(self._known[node] * self._random_value("pi") % P, turns)
        return self._term(self._known[node], Fraction(1))

    @staticmethod
    def _term(value: int, c: Fraction) -> Linear:
        """Return c times a term; a term and its opposite are the same."""
        # Terms with opposite values share a circle: sin(-u) = -sin(u).
        if not value:
            return {}
        return {value: c} if 2 * value < P else {P - value: -c}

    def _multiples(self, form: Linear) -> Iterable[tuple[tuple[object, ...], int]]:
        """Yield (base, integer multiple) of each term; a term with an odd denominator is a base itself."""
        # Whole multiples of the finest part of a term keep the addition theorems: u/2 and u/3 are 3 and 2
        # parts of u/6.
        for term, c in form.items():
            if _PARTS % c.denominator == 0:
                yield ("part", term), c.numerator * (_PARTS // c.denominator)
            else:
                yield ("whole", term, abs(c)), 1 if c > 0 else -1

    def _circle_of(self, angle: Node) -> Circle:
        """Return cosine and sine of an angle."""
        if angle in self._circles:
            # Quarter turns are exact; other terms turn by multiples of their own circle, term after term.
            return self._circles[angle]
        rest = dict(self._form(angle))
        quarters = 0
        if "pi" in rest and rest["pi"].denominator <= 2:
            quarters = int(2 * rest.pop("pi"))
        turned = [(1, 0), (0, 1), (P - 1, 0), (0, P - 1)][quarters % 4]
        for base, n in self._multiples(rest):
            turned = _sum_of_angles(turned, _multiple(self._circle(base), n))
        self._circles[angle] = turned
        return turned

    def _exponential(self, op: str, form: Linear) -> int:
        # e^(sum n_i x_i) = product of e_i^n_i; sinh and cosh by halves of sum and difference.
        grown = 1
        for base, n in self._multiples(form):
            grown = grown * power(self._random_value("exp", base), n) % P
        if op == "exp":
            return grown
        shrunk = power(grown, -1)
        double = {"sinh": (grown - shrunk), "cosh": (grown + shrunk)}
        if op in double:
            return double[op] * _HALF % P
        return double["sinh"] * power(double["cosh"], -1) % P

    def _root(self, x: int) -> int:
        if not self._roots:
            self.exact = False
            return self._random_value("sqrt", x)
        self.rooted = True
        # P is 3 modulo 4, so x^((P+1)/4) is a root of x if there is one. Its sign is drawn, once for each x.
        root = pow(x, (P + 1) // 4, P)
        if root * root % P != x:
            raise Undefined
        return root if self._random_value("sign", x) % 2 else -root % P

    def _floor(self, x: int, form: Linear) -> int:
        """Apply floor(n + u) = n + floor(u) for integers n and floor(-u) = -1 - floor(u), the only relations
        used."""
        # floor(n + u) = n + floor(u) takes the integer out; u and -u share one random value.
        number = form.get("1", Fraction(0))
        rest = (x - residue(number)) % P
        if not rest:
            return math.floor(number) % P
        if 2 * rest > P:
            return (-1 - self._stairs(P - rest, -number)) % P
        return self._stairs(rest, number) % P

    def _stairs(self, rest: int, number: Fraction) -> int:
        whole = math.floor(number)
        return whole + self._random_value("floor", rest, number - whole)

    def _pow(self, x: int, exponent: Node) -> int:
        """Return x^(n + rest) = x^n x^rest for the integer part n of the number in the exponent."""
        # x^(n + 1/2) is a power and a root; another exponent has a random value for its part behind the
        # integer.
        form = dict(self._form(exponent))
        number = form.pop("1", Fraction(0))
        whole = math.floor(number)
        if not form and number - whole == Fraction(1, 2):
            return power(x, whole) * self._root(x) % P
        self.exact = False
        rest = sorted((str(term), c) for term, c in form.items())
        return power(x, whole) * self._random_value("pow", x, number - whole, *rest) % P


def _sum_of_angles(a: Circle, b: Circle) -> Circle:
    return (a[0] * b[0] - a[1] * b[1]) % P, (a[0] * b[1] + a[1] * b[0]) % P


def _multiple(angle: Circle, n: int) -> Circle:
    # Doubling and adding: n turns in log n steps.
    if n < 0:
        angle, n = (angle[0], -angle[1] % P), -n
    total = (1, 0)
    while n:
        if n & 1:
            total = _sum_of_angles(total, angle)
        angle = _sum_of_angles(angle, angle)
        n >>= 1
    return total


def power(x: int, n: int) -> int:
    """Return x^n.  Raises Undefined for a division by zero."""
    if n < 0 and x % P == 0:
        raise Undefined
    return pow(x, n, P)


def has_root(node: Node) -> bool:
    """Return whether the node contains the square root of its first argument."""
    if node.op != "pow":
        return node.op == "sqrt"
    exponent = node.args[1]
    return exponent.op == "const" and math.isfinite(exponent.value) and exponent.value % 1.0 == 0.5


def is_square(x: int) -> bool:
    return pow(x, (P - 1) // 2, P) == 1


_HALF = (P + 1) // 2


def residue(x: Fraction) -> int:
    """Return a fraction as an element of the field."""
    return x.numerator * power(x.denominator, -1) % P


def turns_of(value: float) -> Fraction | None:
    """Return the simple non-zero multiple of pi that equals a float up to round-off, or None."""
    # Multiples k/n of pi with n up to 360 and at most 1000 half turns: numbers that a person writes.
    if not math.isfinite(value) or abs(value) > _MOST_TURNS * math.pi or _is_written(value):
        return None
    near = Fraction(value / math.pi).limit_denominator(_FINEST_TURN)
    return near if near and abs(float(near) * math.pi - value) <= _ULPS * math.ulp(value) else None


def fraction(value: float, digits: int = WRITTEN) -> Fraction | None:
    """Return the decimal of up to `digits` digits, or the fraction, that equals a float up to round-off, or
    None."""
    # Few digits: as written. Else the nearest fraction with a small denominator, to round-off.
    if not math.isfinite(value):
        return None
    if _is_written(value, digits):
        return Fraction(repr(value))
    scale = Fraction(10) ** math.floor(math.log10(abs(value)))
    near = Fraction(value) / scale
    near = near.limit_denominator(100_000) * scale
    return near if abs(float(near) - value) <= _ULPS * math.ulp(value) else None


def _is_written(value: float, most: int = WRITTEN) -> bool:
    """Return whether a number has few digits or is an integer, so that it is taken as written."""
    digits = repr(abs(value)).partition("e")[0].replace(".", "").strip("0")
    return len(digits) <= most or value == int(value)


# -- linear equations in the field ----------------------------------------------------------------

Entries: TypeAlias = dict[int, int]  # column -> value, zeros left out
RIGHT = -1  # the column of the right-hand side


class Echelon:
    """Rows taken in one by one, each reduced by those before."""

    def __init__(self) -> None:
        self.rows: dict[int, Entries] = {}  # pivot -> row, one at the pivot

    def reduce(self, row: Mapping[int, int]) -> Entries:
        """Return `row` less its part along the rows taken in."""
        # Each base row has a 1 at its pivot; one pass in their order suffices, as later bases are reduced by
        # earlier ones.
        rest = {j: x for j, x in row.items() if x}
        for pivot, base in self.rows.items():
            factor = rest.get(pivot)
            if factor:
                _subtract(rest, factor, base)
        return rest

    def grows(self, row: Mapping[int, int]) -> bool:
        """Take a row in. Return False if it depends on those before."""
        rest = self.reduce(row)
        # The first column that is not zero is the pivot: exact arithmetic needs no choice.
        pivot = next((j for j in rest if j != RIGHT), None)
        if pivot is None:
            return False
        scale = power(rest[pivot], -1)
        rest = {j: x * scale % P for j, x in rest.items()}
        self.rows[pivot] = rest
        return True

    @property
    def rank(self) -> int:
        return len(self.rows)

    def solution(self, columns: Iterable[int], draw: Callable[[], int]) -> Entries:
        """Return x with rows . x = right, with free entries drawn."""
        # Back substitution from the last pivot; columns without one are drawn.
        values = {j: 0 if j in self.rows else draw() for j in columns}
        values[RIGHT] = P - 1
        for pivot, row in reversed(self.rows.items()):
            values[pivot] = -sum(x * values[j] for j, x in row.items() if j != pivot) % P
        del values[RIGHT]
        return values


def _subtract(row: Entries, factor: int, base: Mapping[int, int]) -> None:
    for j, x in base.items():
        value = (row.get(j, 0) - factor * x) % P
        if value:
            row[j] = value
        else:
            row.pop(j, None)


def solve_exactly(
    rows: Iterable[Mapping[int, int]], columns: Iterable[int], draw: Callable[[], int]
) -> Entries | None:
    """Return x with row . x = row[RIGHT] for all rows, with free entries drawn; None if the rows contradict
    each other."""
    taken = Echelon()
    for row in rows:
        if not taken.grows(row) and taken.reduce(row):
            return None
    return taken.solution(columns, draw)
