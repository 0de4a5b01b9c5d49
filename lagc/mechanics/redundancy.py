"""Redundant rows of the constraints.

The Jacobian is reduced, row by row, on a few random states (`samples`). A velocity row that is proved to
depend on earlier rows, by exact values in a finite field on the constraints, is left out, so that the
multipliers stay unique. Other dependent rows stay, as do holonomic ones: the run shares their forces. The
initialization refuses rows that contradict each other.

**Reduction.** A line that depends on the lines before has no remainder beside them. Rows that are given by
sums (see `Entries`) are not put together: the sums are unknowns too, and the definition of each is a line
before the first row that builds on it. Rows depend on each other as they do without.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from heapq import heapify, heappop, heappush
from typing import NamedTuple

from lagc.base.records import dataclass, replace
from lagc.diagnostics.faults import Fault, Refused, Span
from lagc.mechanics.formulation.constraints import Classified
from lagc.mechanics.formulation.equations import Row
from lagc.mechanics.formulation.jacobian import Entries
from lagc.mechanics.formulation.states import States
from lagc.mechanics.identities.constraint_manifold import onto
from lagc.mechanics.identities.samples import VANISHES, magnitudes, samples
from lagc.symbolic.finite_field import RIGHT, Echelon
from lagc.symbolic.graph import Node
from lagc.symbolic.operators import CHOICE, CORNER, STEP, smooth_as
from lagc.symbolic.walk import reachable, symbols

_STATES = 3
_SIDED = smooth_as(CORNER, STEP, CHOICE) | {"sqrt"}


@dataclass(frozen=True, slots=True)
class Redundant:
    """A row that follows from those of index `others`."""

    row: int
    others: tuple[int, ...]


class Dropped(NamedTuple):
    """A row that is left out: its label, those of the rows that it follows from, and the reason."""

    label: str
    others: tuple[str, ...]
    reason: str


def drop_idle(states: States, classified: Sequence[Classified]) -> tuple[list[Classified], list[Dropped]]:
    """Return the rows with a coordinate or speed, and those that are proved to hold always, as may a
    component of a vector. The proof holds for all values of parameters, so roots and choices such as
    sqrt(l^2) = l are not proved. Raises Refused: LAG0409 a row without coordinates and speeds that is not
    proved."""
    # A row without coordinates and speeds restricts nothing: it must vanish identically, which the field can
    # prove.
    idle = [x.row for x in classified if not x.row.jacobian]
    if not idle:
        return list(classified), []
    from lagc.mechanics.identities.sampling_domains import (
        all_states,  # what proves is loaded where there is a question
    )
    from lagc.mechanics.identities.zero_test import ZeroTest

    zero_test = ZeroTest(all_states(states))
    faults = [
        _motionless(row)
        for row in idle
        if _has_branches([row.residual]) or not zero_test.vanish([row.residual])
    ]
    if faults:
        raise Refused(faults)
    return [x for x in classified if x.row.jacobian], [_dropped_row(row, ()) for row in idle]


def shared_reactions(states: States, dropped: Sequence[Dropped]) -> tuple[Fault, ...]:
    """Return warnings: LAG0428 of outputs and conditions with reactions that rows share, if one of them was
    left out. The reaction of a repeated row is that of both."""
    found, model = [], states.model
    asking = [(x.name, x.expression, x.span) for x in model.outputs]
    asking += [(x.words, x.condition, x.span) for x in model.whens]
    for name, expression, span in asking:
        asked = {x.record.owner for x in symbols([expression]) if x.record.kind == "multiplier"}
        for row in dropped:
            others = row.others if len(row.others) > 1 else ()
            if row.others and not asked.isdisjoint({row.label, *others}):
                found.append(_shared_fault(name, span, row))
                break
    return tuple(found)


def _shared_fault(name: str, span: Span, row: Dropped) -> Fault:
    rows = ", ".join([f"`{label}`" for label in (row.label, *row.others)])
    return Fault(
        "LAG0428",
        f"`{name}` is one of many: {rows} share a reaction, and `{row.label}` is given no part of it",
        span,
        remedy="what they do together is determined: leave one of these rows out",
        severity="warning",
    )


def _has_branches(nodes: Iterable[Node]) -> bool:
    """Return whether a root or a choice is below them, whose side only the values at hand decide."""
    return any(node.op in _SIDED for node in reachable(nodes))


def _motionless(row: Row) -> Fault:
    return Fault(
        "LAG0409",
        f"the constraint `{row.label}` restricts no coordinate and no speed",
        row.span,
        remedy="remove it, also where it repeats what places of bodies say already; a condition between "
        "parameters belongs in the default of a parameter",
    )


def drop_redundant(
    states: States, classified: Sequence[Classified]
) -> tuple[list[Classified], list[Dropped]]:
    """Return the rows that stay and those that do not."""
    # Candidates by numbers at random states; a row is left out only after a proof in the field.
    found = dependent_rows(states, [x.row for x in classified])
    if not found:
        return list(classified), []
    spare = {r.row for r in found}
    independent = [x.row for k, x in enumerate(classified) if k not in spare]
    dropped: dict[int, Dropped] = {}
    for redundant in found:
        row, others = classified[redundant.row].row, [classified[k].row for k in redundant.others]
        # Holonomic rows stay in any case: a mechanism may leave a singular position, and the run shares
        # forces.
        if row.holonomic or (not others and _has_branches(row.jacobian.values())):
            continue
        if follows(states, row, independent):
            dropped[redundant.row] = _dropped_row(row, others)
    kept = [x for k, x in enumerate(classified) if k not in dropped]
    return kept, list(dropped.values())


def dependent_rows(states: States, rows: Sequence[Row]) -> list[Redundant]:
    """Return the rows whose Jacobian depends on that of rows before, on every state tried."""
    # A line is dependent if its remainder is round-off on every state. On one state alone it may be so by
    # chance.
    tried = [table for _, table in tables(states, rows, _STATES)]
    found: list[Redundant] = []
    for line in _coupled_lines(tried):
        reduced = [table.reduce(line) for table in tried]
        depends = [table.depends(line, left) for table, (left, _) in zip(tried, reduced)]
        row = tried[0].rows[line]
        if row is not None and all(depends):
            found.append(Redundant(row, _rows_in(tried[0], line, reduced[0][1])))
            continue
        for table, settled, (left, factors) in zip(tried, depends, reduced):
            if not settled:
                table.add(line, left, factors)
    return found


def _rows_in(table: Reduced, line: int, factors: Mapping[int, float]) -> tuple[int, ...]:
    """Return the rows that a line is a combination of, without those whose share is round-off."""
    # Weights of rows whose share in the line is more than round-off.
    size = dict(zip(table.rows, table.sizes))
    made = table.made_of(factors).items()
    return tuple(sorted([k for k, x in made if abs(x) * size[k] > VANISHES * table.sizes[line]]))


def _coupled_lines(tried: Sequence[Reduced]) -> list[int]:
    """Return the lines that may depend on each other."""
    if not tried:
        return []
    lines = range(len(tried[0].rows))
    sure = [[table.surely(line) for table in tried] for line in lines]
    return entangled([{j: all([own[j] for own in each]) for j in each[0]} for each in sure])


def entangled(rows: Sequence[Mapping[int, bool]]) -> list[int]:
    """Return the rows that may depend on each other, each given as column -> whether its entry is surely
    nonzero: a vanishing sum contains no row that is alone in a column, recursively."""
    # Columns with one row: that row cannot be part of a vanishing sum. Removing it may leave another alone.
    users: dict[int, set[int]] = {}
    for k, row in enumerate(rows):
        for j in row:
            users.setdefault(j, set()).add(k)
    left = set(range(len(rows)))
    alone = [j for j, found in users.items() if len(found) == 1]
    while alone:
        j = alone.pop()
        for k in [k for k in users[j] if rows[k][j]]:
            left.discard(k)
            for other in rows[k]:
                users[other].discard(k)
                if len(users[other]) == 1:
                    alone.append(other)
    return sorted(left)


def _dropped_row(row: Row, others: Sequence[Row]) -> Dropped:
    why = f"it follows from {_labels(others)}" if others else "it holds whatever the motion"
    return Dropped(row.label, tuple([y.label for y in others]), f"row `{row.label}` is left out: {why}")


def _labels(rows: Sequence[Row]) -> str:
    return ", ".join(f"`{row.label}`" for row in rows)


def follows(states: States, row: Row, others: Sequence[Row]) -> bool:
    """Return whether it is proved, on the constraints, that rate and Jacobian of `row` are one combination of
    those of `others`, with the same numbers for all configurations, speeds, parameters and branches."""
    from lagc.mechanics.identities.sampling_domains import on_rows  # loaded where there is a question
    from lagc.mechanics.identities.zero_test import ZeroTest, spelt_out
    from lagc.symbolic.finite_field import Undefined

    # All points are written beside each other, as one long row for each constraint: a combination that holds
    # for all of them has the same numbers at each point.
    rows = [*others, row]
    flat = [x for r in rows for x in (r.rate, *r.jacobian.values())]
    spelt = spelt_out(states.graph, flat)
    # States on the other constraints, so that roots have the signs that they have in a motion.
    met = map(onto(states, others), samples(states.model, _STATES, vary=False))
    tries = [state for state in met if state is not None]
    ground = replace(on_rows(states, [r for r in others if r.holonomic], tries), values={})
    beside: list[dict[int, int]] = [{} for _ in rows]  # all points beside each other: one combination for all
    width, count = len(states.v) + 1, 0
    for placed, truths in ZeroTest(ground).points(spelt):
        for x in placed:
            x.point.place({v: x.point.draw() for v in states.v})
            try:
                values = iter(x.point.values(spelt, truths))
            except Undefined:
                continue
            for r, entries in zip(rows, beside):
                entries.update((count * width + 1 + j, next(values)) for j in (RIGHT, *r.jacobian))
            count += 1
    # The last row follows if it reduces to nothing over the others; one point alone would prove too little.
    taken = Echelon()
    for entries in beside[:-1]:
        taken.grows(entries)
    return count > 1 and not taken.reduce(beside[-1])


_WORTH = 0.1  # of a line's largest entry: less is no pivot

Columns = Mapping[int, tuple[float, float]]  # of a line: value and size of each entry


class _Base(NamedTuple):
    line: int
    pivot: int
    entries: dict[int, float]
    factors: dict[int, float]  # of the bases before that were taken from it


class Reduced:
    """The lines on one state; `rows` are the rows that they are, None of the definition of a sum."""

    def __init__(self, rows: Sequence[int | None], lines: Sequence[Columns]):
        self.rows = rows
        self.entries = [{j: x for j, (x, _) in line.items()} for line in lines]
        self.sizes = [max([size for _, size in line.values()], default=0.0) for line in lines]
        self._bases: list[_Base] = []
        self._of_pivot: dict[int, int] = {}
        self._last = {j: k for k, line in enumerate(lines) for j in line}  # line that has an entry there

    def surely(self, line: int) -> dict[int, bool]:
        """Return, by column, whether the entry is more than round-off."""
        return {j: abs(x) > VANISHES * self.sizes[line] for j, x in self.entries[line].items()}

    def reduce(self, line: int) -> tuple[dict[int, float], dict[int, float]]:
        """Return the remainder of a line, and the factor of each base that was taken from it."""
        # Sparse elimination: the bases whose pivots the line has, in the order in which they were made, as
        # each may bring in later pivots.
        left, factors = dict(self.entries[line]), dict[int, float]()
        waiting = [self._of_pivot[j] for j in left if j in self._of_pivot]
        heapify(waiting)
        while waiting:
            k = heappop(waiting)
            base = self._bases[k]
            factors[k] = left.pop(base.pivot) / base.entries[base.pivot]
            for j, x in base.entries.items():
                if j in left:
                    left[j] -= factors[k] * x
                elif j != base.pivot:
                    left[j] = -factors[k] * x
                    if j in self._of_pivot:
                        heappush(waiting, self._of_pivot[j])
        return left, factors

    def depends(self, line: int, left: Mapping[int, float]) -> bool:
        return max(map(abs, left.values()), default=0.0) <= VANISHES * self.sizes[line]

    def add(self, line: int, left: dict[int, float], factors: dict[int, float]) -> None:
        """Add the remainder of a line, unless it is zero, as a base for the lines to come; its pivot is in
        the column that these are done with first."""
        # Markowitz in one direction: of the entries that are large enough the column that the fewest lines
        # behind still need.
        largest = max(map(abs, left.values()), default=0.0)
        if largest:
            pivots = [j for j, x in left.items() if abs(x) >= _WORTH * largest]
            pivot = min(pivots, key=lambda j: (self._last[j], -abs(left[j])))
            self._of_pivot[pivot] = len(self._bases)
            self._bases.append(_Base(line, pivot, left, factors))

    def made_of(self, factors: Mapping[int, float]) -> dict[int, float]:
        """Return the rows, with their weights, that a combination of bases with these factors consists of."""
        # Backwards: a base is its line less its own factors of bases before.
        weights, found = dict(factors), dict[int, float]()
        for k in range(len(self._bases) - 1, -1, -1):
            weight, base = weights.pop(k, 0.0), self._bases[k]
            row = self.rows[base.line]
            if weight and row is not None:
                found[row] = weight
            for i, x in base.factors.items() if weight else ():
                weights[i] = weights.get(i, 0.0) - weight * x
        return found


def tables(
    states: States, rows: Sequence[Row], count: int, vary: bool = True
) -> Iterator[tuple[dict[Node, float], Reduced]]:
    """Yield `count` random states, as `samples` does, each with the lines of `rows` there."""
    # Values and sizes of all entries at each state, from one evaluation.
    lines = list(_lines([row.jacobian for row in rows]))
    numbers = [line.row for line in lines]
    nodes = [node for line in lines for node in line.slopes.values()]
    for sample in samples(states.model, count, vary) if rows else ():
        values = magnitudes(nodes, sample)
        if all(math.isfinite(size) for _, size in values):
            value = iter(values)
            own = [{j: next(value) for j in line.slopes} for line in lines]
            yield sample, Reduced(numbers, _scaled(lines, own))


class _Line(NamedTuple):
    row: int | None
    column: int | None  # of the sum that it defines
    slopes: Mapping[int, Node]


def _lines(rows: Sequence[Mapping[int, Node]]) -> Iterator[_Line]:
    """Yield the lines of `rows`: each row after the definitions of the sums that it uses."""
    known: set[int] = set()
    for k, row in enumerate(rows):
        # A row of shared sums comes after the definitions of the sums that it needs and no row before needed.
        if not isinstance(row, Entries):
            yield _Line(k, None, row)
            continue
        own, first, sums = row.slopes.rows[row.k], row.slopes.leaves, row.slopes.sums
        wanted = {j for j in own if j >= first} - known
        new, waiting = set(wanted), list(wanted)
        while waiting:
            below = {j for j in sums[waiting.pop() - first] if j >= first} - known - new
            new |= below
            waiting += below
        for column in sorted(new):
            yield _Line(None, column, sums[column - first])
        known |= new
        yield _Line(k, None, own)


def _scaled(lines: Sequence[_Line], found: Sequence[Columns]) -> list[Columns]:
    """Return the columns with each sum in units of its size at speeds of 1, so that units of sums do not
    count."""
    # A sum has its own unit: its size at speeds of 1. Lines of sums before it are known then.
    units: dict[int, float] = {}
    measured: list[Columns] = []
    for line, columns in zip(lines, found):
        if line.row is not None and not units:
            measured.append(columns)
            continue
        sized = {j: (x * units.get(j, 1.0), size * units.get(j, 1.0)) for j, (x, size) in columns.items()}
        if line.column is not None:
            unit = max([size for _, size in sized.values()], default=0.0) or 1.0
            units[line.column] = unit
            sized = {j: (x / unit, size / unit) for j, (x, size) in sized.items()}
            sized[line.column] = (-1.0, 1.0)
        measured.append(sized)
    return measured
