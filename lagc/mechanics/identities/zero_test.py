"""Zero tests of expressions, on all branches.

**Branches** of piecewise expressions: every comparison is taken as true and as false. A property holds on
each branch, whether or not tested states lie on it: a force may act beyond three turns only. Comparisons of
parameters alone are decided by their values.

If there are many conditions, branches are blended: each condition is a random number c of the finite field,
and `if` is c x + (1 - c) y. An expression that is zero then is zero for all c, so on every branch.

**Tests.** The first test evaluates in a finite field, branch by branch. A zero there is a proof; another
value refutes it if every relation of the expression's functions is known. The second test evaluates numbers:
an expression *seems* to vanish if terms that are not zero cancel on all states tried, on every branch.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import combinations, product
from typing import TypeAlias

from lagc.base.records import dataclass
from lagc.mechanics.identities.samples import magnitudes
from lagc.semantics.model import Model
from lagc.symbolic.finite_field import WRITTEN, P, Point, Undefined, has_root
from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.operators import COMPARISONS, OPERATORS
from lagc.symbolic.walk import evaluate, reachable, substitute, symbols

Signs = dict[Node, int]  # difference of two sides -> 1 or -1, or 0: both are blended
_SIDES = {op: row.sides for op, row in OPERATORS.items() if row.sides is not None}
_SEED = 91
_MOST = 8  # differences whose combinations of signs are all tried
_MOST_PAIRED = 12  # differences whose pairs are


def spelt_out(graph: Graph, nodes: Sequence[Node]) -> list[Node]:
    """Return `nodes` with comparisons in the place of abs, sign, min, max and roots of squares."""
    # abs, sign, min, max and sqrt(u^2) become choices by a comparison; a field has no order, but a comparison
    # can be true or false.
    kinks = [node for node in reachable(nodes) if node.op in _SIDES or _is_root_of_square(node)]
    if not kinks:
        return list(nodes)
    spelt: dict[Node, Node] = {}
    for node in kinks:  # arguments before users
        args = substitute(graph, node.args, spelt)
        if node.op == "sqrt":
            (x,) = args
            factor, square = (x.value, x.args[0]) if x.op == "scale" else (1.0, x)
            root = graph.scale(
                math.sqrt(factor), graph.product((b, e // 2) for b, e in zip(square.args, square.value))
            )
            spelt[node] = graph.select(graph.binary("lt", graph.zero, root), root, -root)
        else:
            spelt[node] = _SIDES[node.op](graph, *args)
    return substitute(graph, nodes, spelt)


def _is_root_of_square(node: Node) -> bool:
    if node.op != "sqrt":
        return False
    (x,) = node.args
    if x.op == "scale" and x.value > 0.0:
        x = x.args[0]
    return x.op == "mul" and all(e % 2 == 0 for e in x.value)


@dataclass(frozen=True, slots=True)
class Comparison:
    """lt, le or eq of two sides whose difference is `factor` times `difference`."""

    node: Node
    difference: Node
    factor: float

    def holds(self, sign: int) -> bool:
        return self.node.op != "eq" and sign * self.factor < 0

    def share(self, below: int) -> int:
        """Return the number that stands for the comparison if `below` stands for `difference < 0`."""
        return 0 if self.node.op == "eq" else below if self.factor > 0 else (1 - below) % P


class Branches:
    """The branches of `nodes`, which hold no abs, sign, min, max; `values` are those of the parameters."""

    def __init__(self, graph: Graph, nodes: Sequence[Node], values: Mapping[Node, float]):
        self._graph, self._values = graph, values
        self.comparisons = [self._comparison(x) for x in reachable(nodes) if x.op in COMPARISONS]
        free = [c for c in self.comparisons if not symbols([c.node]) <= values.keys()]
        self.differences = list(dict.fromkeys(c.difference for c in free))

    def _comparison(self, node: Node) -> Comparison:
        # Both sides of a comparison, and the comparison in the other direction, ask for one difference.
        difference = self._graph.sub(*node.args)
        if difference.op == "scale":
            return Comparison(node, difference.args[0], difference.value)
        turned = self._graph.sub(node.args[1], node.args[0])
        if turned.index < difference.index:
            return Comparison(node, turned, -1.0)
        return Comparison(node, difference, 1.0)

    @property
    def complete(self) -> bool:
        """Whether `sign_combinations` gives all branches."""
        return len(self.differences) <= _MOST

    def sign_combinations(self) -> Iterator[Signs]:
        """Return the combinations of signs: all of them, or if they are many, those that differ from equal
        signs in one or two."""
        count = len(self.differences)
        # 2^n combinations of signs up to n = 8; else equal signs, with one or two turned.
        if self.complete:
            for signs in product((1, -1), repeat=count):
                yield dict(zip(self.differences, signs))
            return
        other = [(k,) for k in range(count)]
        pairs = list(combinations(range(count), 2)) if count <= _MOST_PAIRED else []
        for rest in (1, -1):
            for turned in [(), *other, *pairs]:
                yield {d: -rest if k in turned else rest for k, d in enumerate(self.differences)}

    def blended(self) -> Signs:
        return dict.fromkeys(self.differences, 0)

    def truths(self, signs: Signs) -> dict[Node, int]:
        """Return the value of every comparison if the differences have these signs."""
        # A blended difference has a random share for `< 0`; others are true or false by their sign;
        # comparisons of parameters by their values.
        found: dict[Node, int] = {}
        chance = Point(_SEED)
        blended = sorted([d for d, sign in signs.items() if not sign], key=lambda d: d.index)
        shares = {d: chance.draw() for d in blended}
        for c in self.comparisons:
            if c.difference in shares:
                found[c.node] = c.share(shares[c.difference])
            elif c.difference in signs:
                found[c.node] = c.holds(signs[c.difference])
            else:
                found[c.node] = bool(evaluate([c.node], self._values)[0])
        return found


Truths: TypeAlias = Mapping[Node, int]  # of a blended condition any number of the field
State: TypeAlias = Mapping[Node, float]
_SEEMS = 1e-11  # of its terms: what cancels leaves 1e-16, times what linear systems amplify
_CLEARLY = 1e-3  # of its terms: no rounding
_POINTS = 3
_ROOTED_POINTS = 6  # each draws the signs of roots
_TRIES = 60  # points tried for those, where roots of random numbers are not there


@dataclass(frozen=True, slots=True)
class Ground:
    """The domain of a test. `place` gives a point of the field the values of the domain and returns whether
    it meets all conditions; Undefined if it cannot. `states` gives numerical states on a branch, or (None) as
    they are. `support` are the expressions of both. `digits` as in `Point`."""

    graph: Graph
    values: State  # of the parameters, to decide on comparisons of them
    support: Sequence[Node]
    place: Callable[[Point, Truths], bool]
    states: Callable[[Truths | None], Sequence[State]]
    digits: int = WRITTEN


@dataclass(frozen=True, slots=True)
class Placed:
    """A point, and whether it meets all that the ground demands."""

    point: Point
    met: bool


class ZeroTest:
    """Answers for one ground; points are made once for each branch."""

    def __init__(self, ground: Ground):
        self._ground = ground
        self._points: dict[frozenset[tuple[Node, int]], list[Placed]] = {}

    def vanish(self, nodes: Sequence[Node]) -> bool | None:
        """Return True if all of `nodes` are proved to vanish, False if they seem to, None if they do not."""
        ground = self._ground
        asked = [node for node in spelt_out(ground.graph, nodes) if not node.is_zero]
        if not asked:
            return True
        branches = Branches(ground.graph, [*ground.support, *asked], ground.values)
        proved, rooted = self._on_branches(asked, branches)
        # A zero that depends on the signs of roots, or that numbers alone support, must also hold at states
        # as they are.
        if proved is not None and (not proved or rooted):
            plain = cancels(asked, ground.states(None), strict=False)
            return proved if plain else None
        return proved

    def vanish_each(self, asked: Sequence[Sequence[Node]]) -> list[bool | None]:
        """Return `vanish` of each. One that is clearly not zero at a state is not tested further."""
        # A value of more than a thousandth of its terms is no round-off: most expressions are settled by one
        # evaluation.
        nodes = [node for each in asked for node in each]
        sizes = [
            (x, *size) for s in self._ground.states(None)[:1] for x, size in zip(nodes, magnitudes(nodes, s))
        ]
        clear = {node for node, value, size in sizes if math.inf > abs(value) > _CLEARLY * size}
        return [self.vanish(each) if clear.isdisjoint(each) else None for each in asked]

    def _on_branches(self, asked: Sequence[Node], branches: Branches) -> tuple[bool | None, bool]:
        """Return the verdict of the field, or of numbers on branches where it has none, and whether roots
        occurred."""
        # First all branches at once. A zero there is a zero on each.
        if len(branches.differences) > 1:
            blended = branches.blended()
            verdict, rooted = self._in_field(asked, blended, branches.truths(blended))
            if verdict or (verdict is False and not branches.complete):
                return verdict or None, rooted
        # Else branch by branch; numbers take over where the field cannot tell. One branch that does not
        # vanish settles it.
        proved, rooted = branches.complete, False
        for signs in branches.sign_combinations():
            truths = branches.truths(signs)
            verdict, with_roots = self._in_field(asked, signs, truths)
            rooted = rooted or with_roots
            if verdict is None:
                proved = False
                verdict = cancels(asked, [{**s, **truths} for s in self._ground.states(truths)])
            if not verdict:
                return None, rooted
        return proved, rooted

    def points(self, nodes: Sequence[Node]) -> Iterator[tuple[list[Placed], dict[Node, int]]]:
        """Return points and the truths of comparisons for each branch of `nodes`; blended if there are too
        many."""
        ground = self._ground
        branches = Branches(ground.graph, [*ground.support, *nodes], ground.values)
        for signs in branches.sign_combinations() if branches.complete else [branches.blended()]:
            truths = branches.truths(signs)
            yield self._placed(signs, truths), truths

    def _in_field(self, nodes: Sequence[Node], signs: Signs, truths: Truths) -> tuple[bool | None, bool]:
        """Return whether `nodes` vanish on this branch (None: not decided), and whether roots occurred."""
        zero: list[bool] = []
        exact, rooted = True, False
        # Zero at all points: a proof up to the probability degree / P. Not zero: a refutation if every value
        # was exact.
        for placed in self._placed(signs, truths):
            try:
                zero.append(not any(placed.point.values(nodes, truths)))
            except Undefined:
                continue
            exact = exact and placed.met and placed.point.exact
            rooted = rooted or placed.point.rooted
        if len(zero) < 2:
            return None, rooted
        if all(zero):
            return True, rooted
        return (False if exact else None), rooted

    def _placed(self, signs: Signs, truths: Truths) -> list[Placed]:
        key = frozenset(signs.items())
        if key not in self._points:
            self._points[key] = list(self._place(truths))
        return self._points[key]

    def _place(self, truths: Truths) -> Iterator[Placed]:
        # With roots there are points only where all squares have roots; if none is found, roots become
        # functions without relations.
        found = 0
        under = [node.args[0] for node in reachable(self._ground.support) if has_root(node)]
        for roots, tries in ((True, _TRIES), (False, _POINTS)):
            for seed in range(tries):
                point = Point(seed, roots, self._ground.digits)
                try:
                    if roots and not point.seek_roots(under, truths):
                        break
                    met = self._ground.place(point, truths)
                    point.values(self._ground.support, truths)
                except Undefined:
                    continue
                yield Placed(point, met)
                found += 1
                if found == (_ROOTED_POINTS if point.rooted else _POINTS):
                    return
            if found:
                return


def cancels(nodes: Sequence[Node], states: Sequence[State], strict: bool = True) -> bool:
    """Return whether all of `nodes` vanish on every state where they have values; with `strict`, on at least
    one state, by cancellation of nonzero terms."""
    # Values against the sizes of their terms, at states where both exist.
    seen = [False] * len(nodes)
    for state in states:
        for k, (value, size) in enumerate(magnitudes(nodes, state)):
            if math.isfinite(value) and math.isfinite(size):
                if abs(value) > _SEEMS * size:
                    return False
                seen[k] = seen[k] or size > 0.0
    return all(seen) or not strict


def defaults(model: Model) -> dict[Node, float]:
    """Return the values of the parameters, 1 for those that the run must give."""
    return {p.symbol: 1.0 if p.value is None else p.value for p in model.parameters}
