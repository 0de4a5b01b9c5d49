"""Rows that touch zero and do not cross it: `x^2 = 0`, `norm(a - b) = 0`.

The gradient of such a row vanishes wherever the row holds, so no multiplier can enforce it, and what
it restricts is more than one row says.  Sums of squares are seen as such.  Others are found by Newton's
method: towards a simple zero its steps shrink faster and faster, towards one of multiplicity m each is
1 - 1/m of that before.  A norm has half the multiplicity of what is below its root, so it is asked of that.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence

from lagc.diagnostics.faults import Fault, Refused
from lagc.expr.evaluate import evaluate
from lagc.expr.graph import Node
from lagc.expr.walk import symbols
from lagc.mechanics.constraints import Classified
from lagc.mechanics.equations import Row
from lagc.mechanics.magnitude import magnitudes
from lagc.mechanics.manifold import onto
from lagc.mechanics.redundancy import dependent_rows
from lagc.mechanics.samples import samples
from lagc.mechanics.states import States

_STATES = 3
_STEPS = 200
_LAST = 6  # steps by which a zero is judged
_SLOW = 0.3  # ratio of these, on average, towards a multiple zero at least
_ARRIVED = 1e-14  # of the coordinates: a step that is rounding
_FLAT = 1e-3  # of the steepest gradient on the way
_HOLDS = 1e-7  # of its terms, on a state that meets other rows to 1e-12
_FOUND = 1e-6  # of the residual at first
_NOISE = 1e-6  # of the coordinates: steps that grow and are shorter are rounding
_LARGEST = 60  # rows beyond which this is not asked
_HELD = re.compile(r"\s*(?:norm\((?P<norm>.*)\)|dot\((?P<dot>.*)\)|(?P<square>[^+^]*)\^\d+)\s*")


def refuse_touching(states: States, classified: Sequence[Classified]) -> None:
    """Raises Refused: LAG0413 rows whose gradient vanishes wherever they hold, and that others do not
    bring about."""
    if len(classified) > _LARGEST:
        return
    tries = [*samples(states.model, _STATES, vary=False), *samples(states.model, _STATES)]
    suspects = [
        x
        for x in classified
        if (x.row.kind == "holonomic" or not x.row.linear)
        and (_is_made_of_squares(states, x.row.residual) or _is_multiple_everywhere(states, x.row, tries))
    ]
    if not suspects:
        return
    rows = [x.row for x in classified if x not in suspects]
    spare = {r.row for r in dependent_rows(states, rows)}
    met = [onto(states, [row for k, row in enumerate(rows) if k not in spare], s) for s in tries]
    faults = [_fault(x) for x in suspects if not _follows(x.row, [s for s in met if s is not None])]
    if faults:
        raise Refused(faults)


def _follows(row: Row, met: Sequence[Mapping[Node, float]]) -> bool:
    """Whether it holds on states that meet the other rows: then nothing has to enforce it."""
    found = [magnitudes([row.residual], state)[0] for state in met]
    return bool(found) and all(abs(value) <= _HOLDS * size for value, size in found)


def _is_multiple_everywhere(states: States, row: Row, tries: Sequence[Mapping[Node, float]]) -> bool:
    """Whether the zeros next to all states are multiple ones; one that is not settles it."""
    found = False
    for state in tries:
        multiple = _is_multiple(states, row, state)
        if multiple is False:
            return False
        found = found or multiple is True
    return found


def _is_multiple(states: States, row: Row, sample: Mapping[Node, float]) -> bool | None:
    """Whether the zero of the residual next to a state is a multiple one; None where none is found."""
    state, moving = dict(sample), states.v if row.kind == "velocity" else states.q
    rooted = _is_root(row.residual)
    columns, slopes = [states.v[j] for j in row.jacobian], list(row.jacobian.values())
    lengths: list[float] = []
    steepness: list[float] = []
    first = abs(evaluate([row.residual], state)[0])
    for _ in range(_STEPS):
        value = evaluate([row.residual], state)[0]
        gradient = evaluate(slopes, state)
        square = sum(g * g for g in gradient)
        if value == 0.0 or not 0.0 < square < math.inf:
            break
        steepness.append(math.sqrt(square) * (abs(value) if rooted else 1.0))
        share = 0.5 if rooted else 1.0
        step = {v: -share * value * g / square for v, g in zip(columns, gradient)}
        change = step if row.kind == "velocity" else _displacement(states, state, step)
        state.update((x, state[x] + d) for x, d in change.items())
        lengths.append(math.hypot(*change.values()))
        reach = max(abs(state[x]) for x in moving)
        if lengths[-1] <= _ARRIVED * reach:
            break
        if len(lengths) > 2 and lengths[-2] < lengths[-1] < _NOISE * reach:
            del lengths[-2:]
            break
    else:
        return None
    if not abs(value) <= _FOUND * first:
        return None
    slow = len(lengths) > _LAST and lengths[-1] > _SLOW**_LAST * lengths[-1 - _LAST]
    return slow and lengths[-1] > _SLOW * lengths[-2] and steepness[-1] < _FLAT * max(steepness)


def _is_root(node: Node) -> bool:
    return (node.args[0] if node.op == "scale" else node).op == "sqrt"


def _is_made_of_squares(states: States, node: Node) -> bool:
    """A sum of squares of one sign, or one product of powers beyond the first, or the root of these."""
    node = node.args[0] if node.op == "scale" else node
    pending, terms = [node.args[0] if node.op == "sqrt" else node], []
    while pending:
        term = pending.pop()
        if term.op == "add":
            pending.extend(term.args)
        else:
            terms.append((term.value < 0.0, term.args[0]) if term.op == "scale" else (False, term))
    given = {p.symbol for p in states.model.parameters}
    moving = 0
    for _, term in terms:
        if term.op != "mul":
            return False
        for base, exponent in zip(term.args, term.value):
            if symbols([base]) <= given:
                if exponent % 2 and len(terms) > 1:
                    return False
            elif exponent < 2 or (exponent % 2 and len(terms) > 1):
                return False
            else:
                moving += 1
    return moving >= len(terms) and len({sign for sign, _ in terms}) == 1


def _displacement(
    states: States, state: Mapping[Node, float], step: Mapping[Node, float]
) -> dict[Node, float]:
    """What a step of the speeds changes the coordinates by."""
    still = {**state, **dict.fromkeys(states.v, 0.0)}
    drift = evaluate(states.qdot, still)
    moved = evaluate(states.qdot, {**still, **step})
    return {q: b - a for q, a, b in zip(states.q, drift, moved)}


def _fault(x: Classified) -> Fault:
    return Fault(
        "LAG0413",
        f"the gradient of the constraint `{x.row.label}` vanishes wherever the constraint holds, so that no "
        "force can enforce it",
        x.constraint.span,
        remedy=_remedy(x.constraint.left_span.text, x.constraint.right_span.text)
        or "write what has to vanish itself, each part as a row of its own: `a = b` in place of "
        "`norm(a - b) = 0`",
    )


def _remedy(left: str, right: str) -> str | None:
    """For the usual ways to write such a row, what it says."""
    found = _HELD.fullmatch(left)
    if found is None or right.strip() != "0":
        return None
    if found["square"] is not None:
        return f"write `{found['square'].strip()} = 0`"
    inside = found["norm"]
    if inside is None:
        first, comma, second = found["dot"].partition(",")
        if comma == "" or first.strip() != second.strip():
            return None
        inside = first
    return f"write `{inside.strip()} = {{0, 0, 0}}`, a row for each component"
