"""The constraint Jacobian by rows. An entry is a node; entries of rows that share sums are formed when they
are used.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

from lagc.symbolic.derivative import Slopes, by_sums, gradient, slopes
from lagc.symbolic.graph import Graph, Node

_FEW = 2000  # entries, which are all formed


class Entries(Mapping[int, Node]):
    """Row `k` of `slopes`: speed -> entry.  Those that vanish though structure does not tell are zero."""

    __slots__ = ("_found", "k", "slopes")

    def __init__(self, slopes: Slopes, k: int):
        self.slopes, self.k = slopes, k
        self._found: dict[int, Node] | None = None

    def __iter__(self) -> Iterator[int]:
        return iter(self.slopes.columns[self.k])

    def __len__(self) -> int:
        return len(self.slopes.columns[self.k])

    def __contains__(self, j: object) -> bool:
        return j in self.slopes.columns[self.k]

    def __getitem__(self, j: int) -> Node:
        if self._found is None:
            self._found = self.slopes.entries(self.k)
        return self._found[j]


def gradients(graph: Graph, nodes: Sequence[Node], places: Mapping[Node, int]) -> list[Mapping[int, Node]]:
    """Return the derivatives of each of `nodes` by the variables in `places`, without structural zeros: place
    -> entry."""
    found = slopes(graph, nodes, places, len(places), _FEW)
    return _entries(found) if found.sums else list(found.rows)


def weighted(
    graph: Graph, sums: Sequence[Mapping[Node, Node]], places: Mapping[Node, int]
) -> list[Mapping[int, Node]]:
    """Return the derivatives of weighted sums of expressions, as `gradients` does."""
    nodes = list(dict.fromkeys(x for own in sums for x in own))
    found = by_sums(graph, nodes, places, len(places), _FEW)
    if found is None:
        return [{places[x]: a for x, a in gradient(graph, own, places).items()} for own in sums]
    number = {x: k for k, x in enumerate(nodes)}
    return _entries(found.weighted([{number[x]: a for x, a in own.items()} for own in sums]))


def opposite(graph: Graph, rows: Sequence[Mapping[int, Node]]) -> list[Mapping[int, Node]]:
    """Return `rows` times -1."""
    less = graph.const(-1.0)
    new = {id(x): x.weighted([{k: less} for k in range(len(x.rows))]) for x in _by_sums(rows)}
    return [
        Entries(new[id(row.slopes)], row.k) if isinstance(row, Entries) else {j: -x for j, x in row.items()}
        for row in rows
    ]


def added(graph: Graph, rows: Sequence[Mapping[int, Node]]) -> dict[int, Node]:
    """Return the sum of `rows` without zeros."""
    total: dict[int, Node] = {}
    plain = [row for row in rows if not isinstance(row, Entries)]
    for row in (*plain, *(shared.total(_numbers(rows, shared)) for shared in _by_sums(rows))):
        for j, x in row.items():
            total[j] = graph.add(total[j], x) if j in total else x
    return {j: x for j, x in total.items() if not x.is_zero}


def formed_of(rows: Iterable[Mapping[int, Node]]) -> list[Node]:
    """Return all nodes that the entries of `rows` are made of."""
    found: list[Node] = []
    for row in rows:
        found += () if isinstance(row, Entries) else row.values()
    for shared in _by_sums(rows):
        found += shared.nodes
    return found


def with_values(
    rows: Sequence[Mapping[int, Node]], values: Callable[[Sequence[Node]], Sequence[Node]]
) -> list[Mapping[int, Node]]:
    """Return `rows` with all nodes that their entries are made of replaced by `values` of them."""
    new = {id(shared): shared.mapped(values) for shared in _by_sums(rows)}
    return [
        Entries(new[id(row.slopes)], row.k)
        if isinstance(row, Entries)
        else dict(zip(row, values(list(row.values()))))
        for row in rows
    ]


def with_places(
    rows: Sequence[Mapping[int, Node]], places: Mapping[int, int], size: int
) -> list[Mapping[int, Node]]:
    """Return `rows` with the speeds at other places of `size`; speeds without a place have no entries."""
    new = {id(shared): shared.placed(places, size) for shared in _by_sums(rows)}
    return [
        Entries(new[id(row.slopes)], row.k)
        if isinstance(row, Entries)
        else {places[j]: x for j, x in row.items() if j in places}
        for row in rows
    ]


def _entries(found: Slopes) -> list[Mapping[int, Node]]:
    return [Entries(found, k) for k in range(len(found.rows))]


def _numbers(rows: Iterable[Mapping[int, Node]], shared: Slopes) -> list[int]:
    """Return the numbers of the rows that are formed of `shared`."""
    return [row.k for row in rows if isinstance(row, Entries) and row.slopes is shared]


def _by_sums(rows: Iterable[Mapping[int, Node]]) -> list[Slopes]:
    """Return the sums that entries are put together from."""
    return list({id(row.slopes): row.slopes for row in rows if isinstance(row, Entries)}.values())
