"""Whether a velocity row is proved to follow from others: then it may be left out before the run."""

from __future__ import annotations

from collections.abc import Sequence

from lagc.base.records import replace
from lagc.mechanics.formulation.equations import Row
from lagc.mechanics.formulation.states import States
from lagc.mechanics.identities.constraint_manifold import onto
from lagc.mechanics.identities.sampling_domains import on_rows
from lagc.mechanics.identities.zero_test import Judge
from lagc.mechanics.numeric.finite_field_linear import RIGHT, Echelon
from lagc.mechanics.numeric.piecewise_branches import spelt_out
from lagc.mechanics.numeric.samples import samples
from lagc.symbolic.finite_field import Undefined

_STATES = 3


def follows(states: States, row: Row, others: Sequence[Row]) -> bool:
    """It is proved, where positions are on the constraints: rate and Jacobian of `row` are one combination of
    those of `others`, with numbers that are the same for all postures, speeds and parameters and
    whatever comparisons say, of parameters too, which a run may give other values."""
    rows = [*others, row]
    flat = [x for r in rows for x in (r.rate, *r.jacobian.values())]
    spelt = spelt_out(states.graph, flat)
    met = map(onto(states, others), samples(states.model, _STATES, vary=False))
    tries = [state for state in met if state is not None]
    ground = replace(on_rows(states, [r for r in others if r.holonomic], tries), values={})
    beside: list[dict[int, int]] = [{} for _ in rows]  # all points beside each other: one combination for all
    width, count = len(states.v) + 1, 0
    for placed, truths in Judge(ground).points(spelt):
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
