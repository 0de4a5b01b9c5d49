"""Warnings of friction that can bring energy, and of friction where nothing slips.

A load opposes a velocity if the quadratic form of minus its power on that velocity is nowhere negative. The
form consists of derivatives by the speeds, at a few states with the values of the parameters and with slow
random speeds, at which laws as tanh(v/v0) are not saturated.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import chain, permutations
from typing import TypeAlias

import numpy as np

from lagc.base.records import dataclass
from lagc.diagnostics.faults import Fault, Span
from lagc.mechanics.formulation.contacts import touching_row
from lagc.mechanics.formulation.equations import ContactRow, Row
from lagc.mechanics.formulation.states import States
from lagc.mechanics.identities.constraint_manifold import jacobian, onto, scales
from lagc.mechanics.identities.linear_algebra import Span as Spanned
from lagc.mechanics.identities.samples import VANISHES, magnitudes, samples
from lagc.semantics.model import Force, Torque
from lagc.symbolic.derivative import gradient
from lagc.symbolic.graph import Node
from lagc.symbolic.vectors import Vector
from lagc.symbolic.walk import depends, symbols

Load = Force | Torque
Array: TypeAlias = np.ndarray[tuple[int, ...], np.dtype[np.float64]]

LARGEST = 60  # speeds and constraints; forms of more are not made
_MOST = 40  # loads that are looked at
_STATES = 2
_SLOW = 1e-2  # of random speeds
_DIFFERS = 1e-6  # of a length: a state is on its rows to 1e-12
_KEPT = 1e-7  # of the largest: less is round-off, or the residual of a state on the constraints


@dataclass(frozen=True, slots=True)
class _Velocity:
    """The sum of sign * vector (world components, in rates), and its words."""

    terms: tuple[tuple[float, Vector], ...]
    words: str = ""
    span: Span | None = None

    def plus(self, other: _Velocity, sign: float = 1.0) -> _Velocity:
        terms = tuple([(sign * factor, vector) for factor, vector in other.terms])
        return _Velocity((*self.terms, *terms), f"{self.words} - {other.words}", self.span)


@dataclass(frozen=True, slots=True)
class _State:
    """A state, and the directions of the speeds that the constraints allow, as columns."""

    values: Mapping[Node, float]
    allowed: Array


def active_loads(states: States, rows: Sequence[Row]) -> Iterator[Fault]:
    """Yield LAG0412 of loads that oppose a velocity that they are written with, and act on another one, on
    which their power can be positive."""
    # Only loads that mention a velocity can oppose it.
    loads = [x for x in _of_rates(states)[:_MOST] if x.mentioned]
    if not loads or len(states.v) + len(rows) > LARGEST:
        return
    forms = _Forms(states)
    acted = _acting_velocities(loads)
    free, bound = _states(states, ()), _states(states, rows)
    asked = [(x, own) for x, own in acted if not _is_plain(x) and forms.brings([(x, own)], free)]
    # Free of constraints first: a load that brings no energy there brings none with them.
    if not asked or not forms.brings(asked, bound):
        return
    for load, own in asked:
        written = [_Velocity(((1.0, vector),), span.text, span) for vector, span in load.mentioned]
        # Velocities that were written, and differences of two: the load may oppose the relative velocity.
        candidates = [*written, *(a.plus(b, -1.0) for a, b in permutations(written, 2))]
        if forms.brings([(load, own)], bound):
            opposed = next((c for c in candidates if forms.takes(load, c, bound)), None)
            if opposed is not None:
                yield _opposes_another(load, opposed)


def _of_rates(states: States) -> list[Load]:
    """Return the loads that depend on the rates, and on no reaction."""
    loads = [x for x in states.model.actions if isinstance(x, Load)]
    rates = [*states.rates, *(speed.symbol for speed in states.model.speeds)]
    moving = depends(chain.from_iterable(x.vector for x in loads), rates)
    found = [x for x in loads if not moving.isdisjoint(x.vector)]
    return [x for x in found if all(s.record.kind != "multiplier" for s in symbols(x.vector))]


def _is_plain(load: Load) -> bool:
    """Return whether it is written with the velocity that it acts on, and with no other."""
    written = list(dict.fromkeys(vector for vector, _ in load.mentioned))
    if isinstance(load, Force):
        return written == [load.velocity]
    return load.reaction is None and written == [load.frame.spin]


def _acting_velocities(loads: Sequence[Load]) -> list[tuple[Load, _Velocity]]:
    """Return the velocity that each load acts on; of loads of one vector, and of its opposite, the first one
    stands for all, as for the two forces of a damper."""
    found: dict[tuple[type, Vector], tuple[Load, _Velocity]] = {}
    for load in loads:
        x, y, z = load.vector
        own = _velocity_of(load)
        for sign, vector in ((1.0, (x, y, z)), (-1.0, (-x, -y, -z))):
            if (type(load), vector) in found:
                first, before = found[type(load), vector]
                found[type(load), vector] = first, before.plus(own, sign)
                break
        else:
            found[type(load), load.vector] = load, own
    return list(found.values())


def _velocity_of(load: Load) -> _Velocity:
    """Return the velocity that the power of a load is taken on."""
    if isinstance(load, Force):
        return _Velocity(((1.0, load.velocity),))
    turning = _Velocity(((1.0, load.frame.spin),))
    return turning if load.reaction is None else turning.plus(_Velocity(((1.0, load.reaction.spin),)), -1.0)


def _states(states: States, rows: Sequence[Row]) -> list[_State]:
    """Return states near the start with the values of the parameters, on `rows`."""
    slow = [*states.v, *states.rates]
    drawn = [
        {**state, **{x: _SLOW * state[x] for x in slow}}
        for state in samples(states.model, _STATES, vary=False)
    ]
    n, sizes = len(states.v), [scales(states)[v] for v in states.v]
    if not rows:
        return [_State(state, np.eye(n)) for state in drawn]
    linear, found = [row for row in rows if row.linear], []
    for state in map(onto(states, rows), drawn):
        if state is not None:
            held = Spanned(jacobian(linear, sizes, state)) if linear else None
            free = np.eye(n) if held is None else np.array(held.null_space()).reshape(-1, n)
            found.append(_State(state, np.array(sizes)[:, None] * free.T))
    return found


class _Forms:
    """Quadratic forms of minus the power of loads on velocities, at states."""

    def __init__(self, states: States):
        self._states = states
        self._slopes: dict[Vector, list[dict[Node, Node]]] = {}

    def brings(self, loads: Sequence[tuple[Load, _Velocity]], at: Sequence[_State]) -> bool:
        """Return whether the sum of the forms is negative in some direction."""
        # v . form v is minus the power for a velocity v: negative means that energy comes in.
        forms = [np.sum([self._form(x, u, state) for x, u in loads], axis=0) for state in at]
        return not all(map(_is_nowhere_negative, forms))

    def takes(self, load: Load, velocity: _Velocity, at: Sequence[_State]) -> bool:
        """Return whether the form is nowhere negative, and not zero throughout."""
        forms = [self._form(load, velocity, state) for state in at]
        return all(map(_is_nowhere_negative, forms)) and any(form.any() for form in forms)

    def _form(self, load: Load, velocity: _Velocity, state: _State) -> Array:
        # The load and the velocity as matrices on the allowed directions: power = u^T f, its symmetric part
        # counts.
        force = self._map(load.vector, state)
        terms = [sign * self._map(vector, state) for sign, vector in velocity.terms]
        moved, largest = np.sum(terms, axis=0), np.sum(np.abs(terms), axis=0)
        power, size = moved.T @ force, largest.T @ np.abs(force)
        # Products below the round-off of their terms are zero.
        power[np.abs(power) <= VANISHES * size] = 0.0
        form: Array = -0.5 * (power + power.T)
        return form

    def _map(self, vector: Vector, state: _State) -> Array:
        """Return the derivatives of a vector by the allowed directions of the speeds, a row a component."""
        states = self._states
        if vector not in self._slopes:
            one = states.graph.one
            self._slopes[vector] = [
                gradient(states.graph, {x: one}, states.place_of_v) for x in states.in_speeds(vector)
            ]
        slopes = self._slopes[vector]
        # Round-off of an entry is that of its terms, or of the largest of all.
        entries = magnitudes([x for row in slopes for x in row.values()], state.values)
        most = max((size for _, size in entries if math.isfinite(size)), default=0.0)
        found, matrix = iter(entries), np.zeros((len(slopes), len(states.v)))
        for row, own in zip(matrix, slopes):
            for v in own:
                x, size = next(found)
                row[states.place_of_v[v]] = x if abs(x) > VANISHES * min(size, most) else 0.0
        matrix = matrix @ state.allowed
        matrix[np.abs(matrix) <= _KEPT * np.max(np.abs(matrix), initial=0.0)] = 0.0
        return matrix


def _is_nowhere_negative(form: Array) -> bool:
    """Return whether v . form v >= 0: the least eigenvalue of the form with diagonal entries 1."""
    # Scaled to diagonal entries of 1, so that small masses and lengths count as large ones.
    diagonal = np.diag(form)
    sizes = np.where(diagonal == 0.0, np.max(np.abs(form), axis=1, initial=0.0), np.sqrt(np.abs(diagonal)))
    sizes[sizes == 0.0] = 1.0
    return bool(np.linalg.eigvalsh(form / np.outer(sizes, sizes)).min(initial=0.0) >= -_KEPT)


def _opposes_another(load: Load, opposed: _Velocity) -> Fault:
    on, words = ("at", "`velocity(b, at = P)` with `on b at P`, or `velocity(P)` with `at P`")
    if isinstance(load, Torque):
        on, words = ("on", "`angular_velocity(B) - angular_velocity(A)` with `on B from A`")
    return Fault(
        "LAG0412",
        f"`{load.name}` opposes the velocity `{opposed.words}` and acts {on} "
        f"`{load.target.text if load.target else ''}`, which moves otherwise: it can bring energy into the "
        "system",
        load.target,
        () if opposed.span is None else ((opposed.span, "the velocity that it opposes"),),
        f"a friction acts on the velocity that it opposes: write both alike, {words}, and its opposite on "
        "the other body; a drive or a control may stay as it is",
        "warning",
    )


def slips_held(states: States, rows: Sequence[Row], contacts: Sequence[ContactRow]) -> Iterator[Fault]:
    """Yield LAG0433 of contacts that never slip: their slip rows depend on those of the constraints."""
    columns = {j for row in rows for j in row.jacobian}
    if any(row.time_dependent for row in rows):  # they may move what they hold
        return
    # A slip row that lies in the span of the constraints has no remainder there.
    sizes = [scales(states)[v] for v in states.v]
    for contact in contacts:
        touching = rows if contact.normals else [*rows, touching_row(contact)]
        if not contact.slips or not columns.issuperset(j for slip in contact.slips for j in slip.jacobian):
            continue
        linear, found = [row for row in touching if row.linear], _states(states, touching)
        spans = [Spanned(jacobian(linear, sizes, state.values)) for state in found]
        slips = [np.array(jacobian(contact.slips, sizes, state.values)) for state in found]
        parts = [np.array([span.remainder(row) for row in own.tolist()]) for span, own in zip(spans, slips)]
        sizes_of = zip(parts, slips)
        if found and all(np.all(_lengths(a) <= _DIFFERS * _lengths(b)) for a, b in sizes_of):
            message = f"`{contact.label}` can never slip: the constraints of the model hold its slip"
            remedy = "leave out its friction, or write the velocity of a place that may slide"
            yield Fault("LAG0433", message, contact.contact.span, remedy=remedy, severity="warning")


def _lengths(rows: Array) -> Array:
    found: Array = np.linalg.norm(rows, axis=1)
    return found
