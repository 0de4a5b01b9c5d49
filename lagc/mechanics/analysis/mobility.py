"""Degrees of freedom: the rank of the Jacobian of the rows at states that meet them.

The rank is evaluated near the initial state, along motions that the rows allow (`constraint_manifold`):
elsewhere rows that depend on each other in a closed loop are independent. The largest rank counts. It is
proved if it cannot be larger: if it is the number of rows, or the rank at a random point of a finite field,
which also distinguishes rows that agree in double precision. Where surfaces touch, motions are counted by
steps (`Consistent.freedom`).
"""

from collections.abc import Iterator, Mapping, Sequence

from lagc.base.records import dataclass, replace
from lagc.mechanics.formulation.equations import Row
from lagc.mechanics.formulation.states import States
from lagc.mechanics.identities.constraint_manifold import Consistent, jacobian, scales
from lagc.mechanics.identities.linear_algebra import Span
from lagc.mechanics.identities.samples import samples
from lagc.mechanics.identities.sampling_domains import at_defaults, on_rows
from lagc.mechanics.identities.zero_test import Ground, Placed, ZeroTest, spelt_out
from lagc.symbolic.finite_field import Echelon, Undefined
from lagc.symbolic.graph import Node
from lagc.symbolic.walk import depends


@dataclass(frozen=True, slots=True)
class Mobility:
    """The rows, by index, that follow from earlier ones, and the rank of all. `at_start` is the rank at the
    start (None: not found), `proved` as in the module; `examined` is False if no consistent state was found:
    the rank is then that beside the constraints. `unseen` rows are proved to be independent although they are
    not in double precision; they count in `rank` and not in `at_start`. `entangled` rows have multipliers
    that are not unique."""

    spare: frozenset[int]
    rank: int
    at_start: int | None
    proved: bool
    examined: bool
    unseen: frozenset[int] = frozenset()
    entangled: frozenset[int] = frozenset()


def mobility(states: States, rows: Sequence[Row], met: Consistent) -> Mobility:
    """Return the rank of `rows` and the redundant ones, at the states that meet all rows of the system."""
    found, best = _mobility(states, rows, met)
    return replace(found, entangled=best.entangled()) if best is not None and found.spare else found


def _mobility(states: States, rows: Sequence[Row], met: Consistent) -> tuple[Mobility, Span | None]:
    if not rows:
        return Mobility(frozenset(), 0, 0, True, True), None
    # Ranks at states beside the start, and at the start itself, which may be singular.
    tried = [*(met.beside or met.far), *([] if met.start is None else [met.start])]
    spans = [_span(states, rows, state) for state in tried or samples(states.model, 2, vary=False)]
    if not spans:
        return Mobility(frozenset(), min(len(rows), len(states.v)), None, False, False), None
    # The largest rank is that of nearly all states.
    best = max(spans, key=lambda span: span.rank)
    spare = frozenset(range(len(rows))) - set(best.independent())
    at_start = None if met.start is None else spans[-1].rank
    # Where surfaces touch, the motions that steps found count: rank = speeds - motions.
    if met.freedom is not None:
        holonomic = [row for row in rows if row.holonomic]
        places = max(_span(states, holonomic, state).rank for state in tried)
        rank = best.rank - places + len(states.v) - met.freedom
        return Mobility(spare, rank, at_start, False, True), best
    # The rank is proved if it is the number of rows, or the rank at random points of the field.
    moved = [row for row in rows if row.holonomic] if _depend_on_places(states, rows) else []
    if tried and (
        best.rank == len(rows) or best.rank == _largest(states, rows, on_rows(states, moved, met.by_distance))
    ):
        return Mobility(spare, best.rank, at_start, True, True), best
    # In the field a rank may be larger than in double precision: rows that differ by less than round-off.
    kept = _exactly(states, rows, at_defaults(states, moved, met.by_distance))
    if kept is None or len(kept) < best.rank:
        return Mobility(spare, best.rank, at_start, False, bool(tried)), best
    return Mobility(frozenset(range(len(rows))) - kept, len(kept), at_start, True, True, spare & kept), best


def _span(states: States, rows: Sequence[Row], state: Mapping[Node, float]) -> Span:
    sizes = scales(states)
    return Span(jacobian(rows, [sizes[x] for x in states.v], state))


def _depend_on_places(states: States, rows: Sequence[Row]) -> bool:
    return bool(depends([node for row in rows for node in row.jacobian.values()], states.q))


def _largest(states: States, rows: Sequence[Row], ground: Ground) -> int | None:
    """Return the rank at random points of the field, which bounds the rank from above; None if branches
    differ in it."""
    ranks = {len(kept) for _, kept in _in_field(states, rows, ground)}
    return ranks.pop() if len(ranks) == 1 else None


def _exactly(states: States, rows: Sequence[Row], ground: Ground) -> frozenset[int] | None:
    """Return the first rows that span all rows, if no number was rounded and all points meet the rows; else
    None."""
    found = list(_in_field(states, rows, ground))
    sure = all(placed.met and placed.point.exact for placed, _ in found)
    kept = {k for _, k in found}
    return kept.pop() if sure and len(kept) == 1 else None


def _in_field(states: States, rows: Sequence[Row], ground: Ground) -> Iterator[tuple[Placed, frozenset[int]]]:
    """Yield points of the field on all branches, each with the first rows that span all rows there."""
    flat = spelt_out(states.graph, [node for row in rows for node in row.jacobian.values()])
    for placed, truths in ZeroTest(ground).points(flat):
        for x in placed:
            try:
                values = iter(x.point.values(flat, truths))
            except Undefined:
                continue
            taken = Echelon()
            tables = [{j: next(values) for j in row.jacobian} for row in rows]
            yield x, frozenset(k for k, table in enumerate(tables) if taken.grows(table))
