"""How many motions the rows leave: the rank of their Jacobian at states that meet them.

Off the constraints the rank of a closed loop is too large: rows that depend on each other where the
loop is closed do not elsewhere.  So it is taken beside the start, along motions that the rows allow
(`manifold.walk`), and the largest one counts: postures where it is less are passed.  It is proved
where it cannot be larger: as many as there are rows, or as at a random point of a finite field.
Where surfaces touch, motions are counted by steps instead (`Consistent.freedom`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from lagc.expr.graph import Node
from lagc.expr.modular import Undefined
from lagc.expr.walk import depends
from lagc.mechanics.branches import spelt_out
from lagc.mechanics.equations import Row
from lagc.mechanics.finite import Echelon
from lagc.mechanics.grounds import on_rows
from lagc.mechanics.judge import Judge
from lagc.mechanics.linear import Span
from lagc.mechanics.manifold import Consistent, jacobian, scales
from lagc.mechanics.samples import samples
from lagc.mechanics.states import States
from lagc.records import dataclass


@dataclass(frozen=True, slots=True)
class Mobility:
    """Of rows by index: those that follow from the ones before, and the rank of all.

    `at_start` is the rank at the start (None: not found); `proved` as the module says; `examined` is
    False where no consistent state was found: then the rank is that beside the constraints.
    """

    spare: frozenset[int]
    rank: int
    at_start: int | None
    proved: bool
    examined: bool


def mobility(states: States, rows: Sequence[Row], met: Consistent) -> Mobility:
    """Rank and redundant rows among `rows`, at the states that meet all rows of the system."""
    if not rows:
        return Mobility(frozenset(), 0, 0, True, True)
    tried = [*(met.beside or met.far), *([] if met.start is None else [met.start])]
    spans = [_span(states, rows, state) for state in tried or samples(states.model, 2, vary=False)]
    if not spans:
        return Mobility(frozenset(), min(len(rows), len(states.v)), None, False, False)
    best = max(spans, key=lambda span: span.rank)
    spare = frozenset(range(len(rows))) - set(best.independent())
    at_start = None if met.start is None else spans[-1].rank
    if met.freedom is not None:
        holonomic = [row for row in rows if row.kind == "holonomic"]
        places = max(_span(states, holonomic, state).rank for state in tried)
        return Mobility(spare, best.rank - places + len(states.v) - met.freedom, at_start, False, True)
    proved = bool(tried) and best.rank in (len(rows), _largest(states, rows, met))
    return Mobility(spare, best.rank, at_start, proved, bool(tried))


def _span(states: States, rows: Sequence[Row], state: Mapping[Node, float]) -> Span:
    sizes = scales(states)
    return Span(jacobian(rows, [sizes[x] for x in states.v], state))


def _largest(states: States, rows: Sequence[Row], met: Consistent) -> int | None:
    """The rank at random points of the field, the same on all branches: none is larger."""
    flat = spelt_out(states.graph, [node for row in rows for node in row.jacobian.values()])
    holonomic = [row for row in rows if row.kind == "holonomic"]
    judge = Judge(on_rows(states, holonomic if depends(flat, states.q) else [], met.all))
    ranks: set[int] = set()
    for placed, truths in judge.points(flat):
        for x in placed:
            try:
                values = iter(x.point.values(flat, truths))
            except Undefined:
                continue
            taken = Echelon()
            for row in rows:
                taken.grows({j: next(values) for j in row.jacobian})
            ranks.add(taken.rank)
    return ranks.pop() if len(ranks) == 1 else None
