"""Interval enclosures of expressions, as numbers (`intervals`) and as expressions of the bounds
(`enclosures`).

R. E. Moore, *Interval Analysis*, Prentice-Hall 1966.  Round-off is neglected.  A symbolic enclosure may be
wider than necessary; an unknown bound is `UNKNOWN` or not a number.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from typing import TypeAlias

from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.operators import EVERYWHERE, OPERATORS, Interval
from lagc.symbolic.walk import depends, missing, reachable


def intervals(nodes: Sequence[Node], given: Mapping[Node, Interval]) -> dict[Node, Interval]:
    """Return the interval of each node below `nodes`; a symbol that is not in `given` may be any number."""
    found: dict[Node, Interval] = {}
    for node in reachable(nodes):
        found[node] = given.get(node) or _interval(node, [found[a] for a in node.args])
    return found


def extended(known: dict[Node, Interval], node: Node) -> Interval:
    """Return the interval of a node, and add those of all nodes below it to `known`."""
    for below in missing([node], known):
        known[below] = _interval(below, [known[a] for a in below.args])
    return known[node]


def _interval(node: Node, x: Sequence[Interval]) -> Interval:
    op = node.op
    if op == "const":
        # Sums, factors and products by interval arithmetic, from the ends of the arguments.
        return (node.value, node.value)
    if op == "add":
        return (x[0][0] + x[1][0], x[0][1] + x[1][1])
    if op == "scale":
        return _hull([_times(node.value, end) for end in x[0]])
    if op == "mul":
        # Powers first, since x^2 is not x times an independent x.
        found = (1.0, 1.0)
        for base, exponent in zip(x, node.value):
            power = _power(base, exponent)
            found = _hull([_times(a, b) for a in found for b in power])
        return found
    # Kinks and tables: from the sign, or from the pieces that are reached.
    if op == "abs":
        low, high = x[0]
        return (max(low, -high, 0.0), max(-low, high))
    if op == "select":
        return _hull([*x[1], *x[2]])
    if op == "pow" and x[0][0] >= 0.0:
        return (0.0, math.inf)
    if op == "symbol":
        return EVERYWHERE
    if op == "piece":
        return (node.value.piece(x[0][0]), node.value.piece(x[0][1]))
    if op == "entry":
        numbers = node.value.numbers
        begin, end = (int(min(max(a, 0.0), len(numbers) - 1.0)) for a in x[0])
        reached = numbers[begin : end + 1]
        return (min(reached), max(reached))
    # Other functions: between the values at the ends if they rise, else anywhere in their range.
    row = OPERATORS[op]
    low, high = row.within
    if row.rising:
        first, last = (_at(row.value, [interval[k] for interval in x]) for k in (0, 1))
        return (low if math.isnan(first) else first, high if math.isnan(last) else last)
    return (low, high)


def _at(function: Callable[..., float], x: Sequence[float]) -> float:
    try:
        return float(function(*x))
    except (ValueError, OverflowError):
        return math.nan


def _times(a: float, b: float) -> float:
    return 0.0 if a == 0.0 or b == 0.0 else a * b


def _power(base: Interval, n: int) -> Interval:
    low, high = base
    # An even power is that of the distance from zero.
    if n % 2 == 0:
        low, high = max(low, -high, 0.0), max(-low, high)
    if n > 0:
        return (_raised(low, n), _raised(high, n))
    # A divisor that contains zero has no bound.
    if low < 0.0 < high or low == high == 0.0:
        return EVERYWHERE
    return (
        -math.inf if high == 0.0 else 1.0 / _raised(high, -n),
        math.inf if low == 0.0 else 1.0 / _raised(low, -n),
    )


def _raised(x: float, n: int) -> float:
    try:
        return float(x**n)
    except OverflowError:
        return math.inf if x > 0.0 or n % 2 == 0 else -math.inf


def _hull(ends: Sequence[float]) -> Interval:
    return (min(ends), max(ends))


Ends: TypeAlias = tuple[Node, Node]

UNKNOWN = 1e75  # a product of a few of these is finite, also with 0
_QUARTER, _HALF = 0.5 * math.pi, math.pi


def enclosures(graph: Graph, nodes: Sequence[Node], leaves: Mapping[Node, Ends]) -> list[Ends]:
    """Return the smallest and largest value of each of `nodes`; symbols that are not in `leaves` are
    constant."""
    moving = depends(nodes, leaves)
    found: dict[Node, Ends] = dict(leaves)
    made = _Enclosure(graph)
    for node in reachable(nodes):
        if node not in found:
            ends = [found[a] for a in node.args]
            found[node] = made.of(node, ends) if node in moving else (node, node)
    return [found[node] for node in nodes]


class _Enclosure:
    def __init__(self, graph: Graph) -> None:
        self.graph = graph
        self.unknown: Ends = (graph.const(-UNKNOWN), graph.const(UNKNOWN))

    def of(self, node: Node, x: Sequence[Ends]) -> Ends:
        graph, op = self.graph, node.op
        # The rules of Moore, with expressions for the ends. A monotonic function maps ends to ends; others
        # have rules of their own.
        if op == "add":
            return graph.add(x[0][0], x[1][0]), graph.add(x[0][1], x[1][1])
        if op == "scale":
            ends = [graph.scale(node.value, end) for end in x[0]]
            return (ends[0], ends[1]) if node.value > 0.0 else (ends[1], ends[0])
        if op == "mul":
            return self._product(x, node.value)
        if op in ("sin", "cos"):
            shift = 0.0 if op == "sin" else _QUARTER
            return self._wave(op, x[0], _QUARTER - shift)
        if op in ("abs", "cosh"):
            near, far = self._distances(x[0])
            if op == "abs":
                return near, far
            return graph.unary(op, self._growing(near)), graph.unary(op, self._growing(far))
        if op == "tan":
            return self._tangent(x[0])
        if op == "pow":
            return self._power(*x)
        if op == "atan2":
            return self._angle(*x)
        # A choice by what does not move keeps both ends of its branch; another choice may be anywhere in its
        # range.
        if op == "select" and x[0][0] is x[0][1]:
            return graph.select(x[0][0], x[1][0], x[2][0]), graph.select(x[0][0], x[1][1], x[2][1])
        if op == "acos":
            return graph.unary(op, self._within(x[0][1])), graph.unary(op, self._within(x[0][0]))
        # Arguments outside of the domain are those of a box that is wider than the motion: they are clipped.
        if OPERATORS[op].rising:
            ends = [graph.rebuild(node, tuple([self._clipped(op, e[k]) for e in x])) for k in (0, 1)]
            return ends[0], ends[1]
        low, high = OPERATORS[op].within
        known = math.isfinite(low) and math.isfinite(high)
        return (graph.const(low), graph.const(high)) if known else self.unknown

    def _clipped(self, op: str, end: Node) -> Node:
        """Return a bound clipped to the domain of the function."""
        if op == "sqrt" or op == "log":
            return self.graph.binary("max", end, self.graph.const(0.0 if op == "sqrt" else 1.0 / UNKNOWN))
        if op == "exp" or op == "sinh":
            return self._growing(end)
        return self._within(end) if op == "asin" else end

    def _growing(self, end: Node) -> Node:
        """Limit an exponent so that the result is not far beyond UNKNOWN; a factor may make it small
        again."""
        return self.graph.binary("min", end, self.graph.const(2.0 * math.log(UNKNOWN)))

    def _within(self, end: Node) -> Node:
        graph = self.graph
        return graph.binary("max", -graph.one, graph.binary("min", graph.one, end))

    def _distances(self, x: Ends) -> Ends:
        """Return the smallest and the largest distance of an interval from zero."""
        graph, (low, high) = self.graph, x
        near = graph.binary("max", graph.zero, graph.binary("max", low, -high))
        return near, graph.binary("max", -low, high)

    def _product(self, bases: Sequence[Ends], exponents: Sequence[int]) -> Ends:
        graph = self.graph
        # Constant factors multiply the ends once, with one hull for their sign.
        constant = [(b[0], e) for b, e in zip(bases, exponents) if b[0] is b[1]]
        found: Ends | None = None
        for base, exponent in zip(bases, exponents):
            if base[0] is not base[1]:
                power = self._raised(base, exponent)
                found = power if found is None else self._times(found, power)
        assert found is not None
        if constant:
            factor = graph.product(constant)
            found = self._hull([graph.mul(factor, end) for end in found])
        return found

    def _times(self, x: Ends, y: Ends) -> Ends:
        return self._hull(list(dict.fromkeys([self.graph.mul(a, b) for a in x for b in y])))

    def _hull(self, ends: Sequence[Node]) -> Ends:
        graph, low, high = self.graph, ends[0], ends[0]
        for end in ends[1:]:
            low, high = graph.binary("min", low, end), graph.binary("max", high, end)
        return low, high

    def _raised(self, x: Ends, n: int) -> Ends:
        # Odd powers are monotonic; even ones begin at the least distance from zero.
        graph = self.graph
        low, high = self._distances(x) if n % 2 == 0 else x
        size = abs(n)
        low, high = graph.power(low, size), graph.power(high, size)
        if n > 0:
            return low, high
        # 1 / x is between the inverses of the ends if both have one sign, else unknown.
        apart = graph.binary("lt", graph.zero, graph.mul(*x))  # both ends on one side of zero
        least, most = self.unknown
        return graph.select(apart, graph.div(graph.one, high), least), graph.select(
            apart, graph.div(graph.one, low), most
        )

    def _wave(self, op: str, x: Ends, crest: float) -> Ends:
        """Return the range of a sine or cosine with this crest."""
        # A crest is in the interval if floor((end - crest) / (2 pi)) differs at both ends, and a trough
        # likewise.
        graph, ends = self.graph, [self.graph.unary(op, end) for end in x]

        def passes(place: float) -> Node:
            turns = [graph.unary("floor", (end - place) * (0.5 / _HALF)) for end in x]
            return graph.binary("lt", turns[0], turns[1])

        low, high = self._hull(ends)
        return (
            graph.select(passes(crest - _HALF), -graph.one, low),
            graph.select(passes(crest), graph.one, high),
        )

    def _tangent(self, x: Ends) -> Ends:
        graph = self.graph
        # Both ends on one branch of the tangent: it rises there.
        branch = [graph.unary("floor", end * (1.0 / _HALF) + 0.5) for end in x]
        one = graph.binary("le", branch[1], branch[0])
        return (
            graph.select(one, graph.unary("tan", x[0]), self.unknown[0]),
            graph.select(one, graph.unary("tan", x[1]), self.unknown[1]),
        )

    def _angle(self, y: Ends, x: Ends) -> Ends:
        """Return the range of atan2: extremes at the corners, or a full turn if the branch cut is inside."""
        graph, zero = self.graph, self.graph.zero
        low, high = self._hull([graph.binary("atan2", b, a) for b in y for a in x])
        sides = [graph.binary("lt", zero, x[0]), graph.binary("lt", zero, y[0])]
        sides.append(graph.binary("lt", y[1], zero))
        beside = graph.binary("or", sides[0], graph.binary("or", sides[1], sides[2]))
        least, most = OPERATORS["atan2"].within
        return graph.select(beside, low, graph.const(least)), graph.select(beside, high, graph.const(most))

    def _power(self, base: Ends, exponent: Ends) -> Ends:
        """Return the range of a power; a negative base has values if the exponent is an integer, which a
        parameter may be."""
        graph, n = self.graph, exponent[0]
        low, high = [graph.unary("log", self._clipped("log", end)) for end in base]
        ends = [graph.unary("exp", self._growing(end)) for end in self._times((low, high), exponent)]
        least, most = self.unknown
        if n.is_const and n.value > 0.0 and n.value != int(n.value):
            least, most = graph.zero, ends[1]
        positive = graph.binary("lt", graph.zero, base[0])
        return graph.select(positive, ends[0], least), graph.select(positive, ends[1], most)
