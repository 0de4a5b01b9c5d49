"""Slips that are no velocity along the surface of their contact, or that constraints hold. Warnings only.

A speed that moves one body alone, and does not turn it, moves its material points alike. The derivatives of
the rate of a gap and of its slips by such speeds give the normal n and the directions t of the slips. These
are across each other, and as long.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations
from math import sqrt

from lagc.diagnostics.faults import Fault
from lagc.mechanics.formulation.equations import ContactRow, Law, Level, Row, SlipRow
from lagc.mechanics.formulation.states import States
from lagc.mechanics.identities.constraint_manifold import jacobian, scales
from lagc.mechanics.lint.velocity_maps import LARGEST, Maps, Pose, poses
from lagc.mechanics.numeric.dense_linear import Span, dot, least_norm
from lagc.symbolic.evaluate import evaluate

_DIFFERS = 1e-6  # of a length, or of a cosine: a pose is on its rows to 1e-12


def slips_aside(states: States, rows: Sequence[Row], contacts: Sequence[ContactRow]) -> Iterator[Fault]:
    """Yield LAG0432 of contacts whose given slips are no velocities along their surface."""
    given = [row for row in contacts if row.slips and len(row.contact.slip) < 3]
    if not given or len(states.v) > LARGEST:
        return
    maps = Maps(states)
    for contact in given:
        reasons = [_reason(states, maps, contact, pose) for pose in poses(states, [*rows, _held(contact)])]
        if reasons and all(reasons):
            remedy = (
                "write the velocity of the place where it touches along the surface, or name the place, "
                "`at = P`; write the gap as a distance, in which the push is a force"
            )
            span = contact.contact.span
            yield Fault("LAG0432", reasons[0], span, remedy=remedy, severity="warning")


def slips_held(states: States, rows: Sequence[Row], contacts: Sequence[ContactRow]) -> Iterator[Fault]:
    """Yield LAG0433 of contacts that never slip: their slip rows depend on those of the constraints."""
    columns = {j for row in rows for j in row.jacobian}
    if any(row.time_dependent for row in rows):  # they may move what they hold
        return
    for contact in contacts:
        held = rows if contact.normals else [*rows, _held(contact)]
        meets = contact.slips and columns.issuperset(j for slip in contact.slips for j in slip.jacobian)
        if meets and _depend(states, held, contact.slips):
            message = f"`{contact.label}` can never slip: the constraints of the model hold its slip"
            remedy = "leave out its friction, or write the velocity of a place that may slide"
            yield Fault("LAG0433", message, contact.contact.span, remedy=remedy, severity="warning")


def _depend(states: States, rows: Sequence[Row], slips: Sequence[SlipRow]) -> bool:
    """Return whether slip rows depend on `rows` in all poses; False if there are none."""
    sizes = [scales(states)[v] for v in states.v]
    found = poses(states, rows)
    for pose in found:
        held = Span(jacobian([row for row in rows if row.linear], sizes, pose.state))
        for row in jacobian(slips, sizes, pose.state):
            rest = held.remainder(row)
            if dot(rest, rest) > _DIFFERS**2 * dot(row, row):
                return False
    return bool(found)


def _held(contact: ContactRow) -> Row:
    """Return the row of a contact that touches."""
    return Row(
        contact.label, contact.contact.name, Level.POSITION, Law.PERFECT,
        contact.multiplier, contact.gap, contact.rate, contact.jacobian, -contact.bias, contact.contact.unit,
        False, True, contact.contact.span,
    )  # fmt: skip


def _reason(states: States, maps: Maps, contact: ContactRow, pose: Pose) -> str:
    """Return what is wrong with the directions of a contact in a pose; nothing if they are not known."""
    bodies = [
        (maps.at(body.velocity, pose), maps.at(body.frame.spin, pose) if body.frame else [])
        for body in states.model.bodies
    ]
    values = [dict(zip(row, evaluate([*row.values()], pose.state))) for row in contact.jacobians]
    for k, (velocity, spin) in enumerate(bodies):
        others = [row for i, maps_of in enumerate(bodies) if i != k for part in maps_of for row in part]
        alone = [
            j
            for j in range(len(states.v))
            if any(row[j] for row in velocity) and not any(row[j] for row in (*spin, *others))
        ]
        partial = [[row[j] for row in velocity] for j in alone]
        if len(alone) <= len(contact.slips) or Span(partial).rank <= len(contact.slips):
            continue
        found = [least_norm(partial, [row.get(j, 0.0) for j in alone]) for row in values]
        sizes = [sqrt(dot(x, x)) for x in found]
        if not all(sizes):
            continue
        slips = ["the slip"] if len(found) == 2 else ["the first slip", "the second slip"]
        names = ["the gap", *slips]
        pairs = [*combinations(range(len(found)), 2)]
        for i, j in pairs:
            if abs(dot(found[i], found[j])) > _DIFFERS * sizes[i] * sizes[j]:
                return f"{names[i]} and {names[j]} of `{contact.label}` are not perpendicular to each other"
        for i, j in pairs:
            if abs(sizes[i] - sizes[j]) > _DIFFERS * sizes[i]:
                ratio = sizes[j] / sizes[i]
                return f"{names[j]} of `{contact.label}` has {ratio:.4g} times the scale of {names[i]}"
    return ""
