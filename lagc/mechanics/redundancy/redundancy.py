"""Redundant rows.

The Jacobian is reduced, row by row, on a few random states (`samples`). A velocity row that is proved to
depend on earlier rows, by exact values in a finite field on the constraints, is left out, so that the
multipliers stay unique. Other dependent rows stay, as do holonomic ones: the run shares their forces. The
initialization refuses rows that contradict each other.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

from lagc.base.records import dataclass, replace
from lagc.diagnostics.faults import Fault, Refused, Span
from lagc.mechanics.formulation.constraints import Classified
from lagc.mechanics.formulation.equations import Row
from lagc.mechanics.formulation.states import States
from lagc.mechanics.identities.constraint_manifold import onto
from lagc.mechanics.numeric.cancellation import VANISHES
from lagc.mechanics.numeric.samples import samples
from lagc.mechanics.redundancy.row_reduction import Reduced, tables
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
    idle = [x.row for x in classified if not x.row.jacobian]
    if not idle:
        return list(classified), []
    from lagc.mechanics.identities.sampling_domains import (
        anywhere,  # what proves is loaded where there is a question
    )
    from lagc.mechanics.identities.zero_test import ZeroTest

    zero_test = ZeroTest(anywhere(states))
    faults = [
        _motionless(row) for row in idle if _sided([row.residual]) or not zero_test.vanish([row.residual])
    ]
    if faults:
        raise Refused(faults)
    return [x for x in classified if x.row.jacobian], [_dropped(row, ()) for row in idle]


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
                found.append(_shared(name, span, row))
                break
    return tuple(found)


def _shared(name: str, span: Span, row: Dropped) -> Fault:
    rows = ", ".join([f"`{label}`" for label in (row.label, *row.others)])
    return Fault(
        "LAG0428",
        f"`{name}` is one of many: {rows} share a reaction, and `{row.label}` is given no part of it",
        span,
        remedy="what they do together is determined: leave one of these rows out",
        severity="warning",
    )


def _sided(nodes: Iterable[Node]) -> bool:
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
    found = dependent_rows(states, [x.row for x in classified])
    if not found:
        return list(classified), []
    spare = {r.row for r in found}
    independent = [x.row for k, x in enumerate(classified) if k not in spare]
    dropped: dict[int, Dropped] = {}
    for redundant in found:
        row, others = classified[redundant.row].row, [classified[k].row for k in redundant.others]
        if row.holonomic or (not others and _sided(row.jacobian.values())):
            continue
        if follows(states, row, independent):
            dropped[redundant.row] = _dropped(row, others)
    kept = [x for k, x in enumerate(classified) if k not in dropped]
    return kept, list(dropped.values())


def dependent_rows(states: States, rows: Sequence[Row]) -> list[Redundant]:
    """The rows whose Jacobian depends on those before, on every state tried."""
    tried = [table for _, table in tables(states, rows, _STATES)]
    found: list[Redundant] = []
    for line in _entangled(tried):
        reduced = [table.reduce(line) for table in tried]
        depends = [table.depends(line, left) for table, (left, _) in zip(tried, reduced)]
        row = tried[0].rows[line]
        if row is not None and all(depends):
            found.append(Redundant(row, _others(tried[0], line, reduced[0][1])))
            continue
        for table, settled, (left, factors) in zip(tried, depends, reduced):
            if not settled:
                table.add(line, left, factors)
    return found


def _others(table: Reduced, line: int, factors: Mapping[int, float]) -> tuple[int, ...]:
    """The rows that a line is made of, where it is more than rounding."""
    size = dict(zip(table.rows, table.sizes))
    made = table.made_of(factors).items()
    return tuple(sorted([k for k, x in made if abs(x) * size[k] > VANISHES * table.sizes[line]]))


def _entangled(tried: Sequence[Reduced]) -> list[int]:
    """The lines that may depend on each other."""
    if not tried:
        return []
    lines = range(len(tried[0].rows))
    sure = [[table.surely(line) for table in tried] for line in lines]
    return entangled([{j: all([own[j] for own in each]) for j in each[0]} for each in sure])


def entangled(rows: Sequence[Mapping[int, bool]]) -> list[int]:
    """Return the rows that may depend on each other, each given as column -> whether its entry is surely
    nonzero: a vanishing sum contains no row that is alone in a column, recursively."""
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


def _dropped(row: Row, others: Sequence[Row]) -> Dropped:
    why = f"it follows from {_labels(others)}" if others else "it holds whatever the motion"
    return Dropped(row.label, tuple([y.label for y in others]), f"row `{row.label}` is left out: {why}")


def _labels(rows: Sequence[Row]) -> str:
    return ", ".join(f"`{row.label}`" for row in rows)


def follows(states: States, row: Row, others: Sequence[Row]) -> bool:
    """Return whether it is proved, on the constraints, that rate and Jacobian of `row` are one combination of
    those of `others`, with the same numbers for all configurations, speeds, parameters and branches."""
    from lagc.mechanics.identities.sampling_domains import on_rows  # loaded where there is a question
    from lagc.mechanics.identities.zero_test import ZeroTest
    from lagc.mechanics.numeric.piecewise_branches import spelt_out
    from lagc.symbolic.finite_field import Undefined

    rows = [*others, row]
    flat = [x for r in rows for x in (r.rate, *r.jacobian.values())]
    spelt = spelt_out(states.graph, flat)
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
    taken = Echelon()
    for entries in beside[:-1]:
        taken.grows(entries)
    return count > 1 and not taken.reduce(beside[-1])
