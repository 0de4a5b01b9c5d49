"""The conditions of a consistent start, their derivatives, and the units of its unknowns.

Conditions that build on shared sums, as the places of points along a chain, have as many derivatives as there
are pairs of a condition and an unknown before it.  Where these are far more than the conditions are made of,
the derivatives are given by unknowns *and* sums, and those of each sum likewise; the run puts them together.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence

from lagc.expr.derivative import gradient
from lagc.expr.graph import Graph, Node
from lagc.expr.walk import reachable, substitute
from lagc.mechanics.equations import EquationsOfMotion
from lagc.records import dataclass

_WORTH = 2  # times as many derivatives as by sums


@dataclass(frozen=True, slots=True)
class Slopes:
    """The derivatives of each condition, and of each sum by what comes before it: column -> derivative, zeros
    left out.  The columns are the unknowns, then the sums."""

    rows: list[dict[int, Node]]
    sums: list[dict[int, Node]]
    unknowns: int

    @property
    def columns(self) -> list[list[int]]:
        """The unknowns that each condition depends on."""
        if not self.sums:
            return [list(row) for row in self.rows]
        known = [1 << k for k in range(self.unknowns)]
        for own in self.sums:
            known.append(_union(known[k] for k in own))
        found = [_union(known[k] for k in row) for row in self.rows]
        return [[k for k in range(self.unknowns) if bits >> k & 1] for bits in found]


def _union(sets: Iterable[int]) -> int:
    found = 0
    for bits in sets:
        found |= bits
    return found


def condition_rows(equations: EquationsOfMotion) -> list[Node]:
    """The residuals that vanish at a consistent start, and the rates that were stated."""
    phi = [row.residual for row in equations.rows if row.holonomic]
    psi = [row.rate for row in equations.rows]
    own = [residual for residual, _ in equations.initial_conditions]
    return [*phi, *psi, *own, *(s.rate for s in equations.stated_rates)]


def condition_slopes(equations: EquationsOfMotion) -> Slopes:
    """d(row)/d(q, v, stated rates) of each of `condition_rows`."""
    rows = condition_rows(equations)
    found = _by(equations, rows, _shared(rows, (*equations.q, *equations.v)))
    parts = sum([len(own) for own in (*found.rows, *found.sums)])
    if parts > sum(map(len, found.columns)):  # some derivatives turned out to be 0
        return _by(equations, rows, ())
    return found


def _by(equations: EquationsOfMotion, rows: Sequence[Node], shared: Sequence[Node]) -> Slopes:
    """By unknowns and the sums that are `shared`."""
    n, rates = len(equations.q) + len(equations.v), len(equations.stated_rates)
    places = {x: k for k, x in enumerate((*equations.q, *equations.v))}
    sums = {x: n + rates + k for k, x in enumerate(shared)}
    slopes = _through(equations.graph, rows, places, sums)
    for k in range(rates):  # each is its rate less its value
        slopes[len(rows) - rates + k][n + k] = equations.graph.const(-1.0)
    return Slopes(slopes[: len(rows)], slopes[len(rows) :], n + rates)


def _shared(rows: Sequence[Node], leaves: Iterable[Node]) -> list[Node]:
    """The sums that are used more than once, where that leaves far fewer derivatives."""
    order = reachable(rows)
    users = Counter([*rows, *(a for node in order for a in set(node.args))])
    whole = {x: 1 << k for k, x in enumerate(leaves)}
    own, sums, next_bit = dict(whole), dict[Node, int](), len(whole)
    for node in order:
        if node in whole:
            continue
        bits = _union(whole.get(a, 0) for a in node.args)
        if bits:
            whole[node], own[node] = bits, _union(own.get(a, 0) for a in node.args)
            if node.op == "add" and users[node] > 1 and own[node].bit_count() > 1:
                sums[node], own[node] = own[node], 1 << next_bit
                next_bit += 1
    plain = sum([whole.get(row, 0).bit_count() for row in rows])
    fewer = sum([own.get(row, 0).bit_count() for row in rows]) + sum([b.bit_count() for b in sums.values()])
    return list(sums) if plain > _WORTH * fewer else []


def _through(
    graph: Graph, rows: Sequence[Node], places: Mapping[Node, int], sums: Mapping[Node, int]
) -> list[dict[int, Node]]:
    """The derivatives of `rows`, then of `sums`, by what has `places` and by sums."""
    symbols = {x: graph.symbol("sum", str(k)) for x, k in sums.items()}
    found: dict[Node, Node] = dict(symbols)
    made: dict[Node, Node] = {}
    for node in reachable(rows) if sums else ():
        args = tuple([found[a] for a in node.args])
        made[node] = graph.rebuild(node, args) if args else node
        found.setdefault(node, made[node])
    by = {**places, **{symbols[x]: k for x, k in sums.items()}}
    nodes = [*(found.get(row, row) for row in rows), *(made[x] for x in sums)]
    slopes = [gradient(graph, {node: graph.one}, by) for node in nodes]
    back = {symbol: x for x, symbol in symbols.items()}
    values = substitute(graph, [slope for own in slopes for slope in own.values()], back) if sums else ()
    value = iter(values)
    return [{by[x]: next(value) if sums else slope for x, slope in own.items()} for own in slopes]


def start_units(equations: EquationsOfMotion) -> list[str]:
    """The units of the unknowns of the start, each once."""
    rates = [s.unit for s in equations.stated_rates]
    return list(dict.fromkeys([*equations.q_units, *equations.v_units, *rates]))
