"""The modes of contacts at a state, and the states at which two modes meet.

A linear model belongs to one mode. There is none where a small change of the state may change the mode: where
an open contact has no gap, one that touches no push, one that slides no slip, or where one that sticks is
about to slip.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product
from math import hypot
from typing import TYPE_CHECKING

import numpy as np

from lagc.base.records import replace
from lagc.codegen.python.support.contacts import RESTS, STRIKES
from lagc.mechanics.formulation.contacts import MODE_STICKS
from lagc.simulation.error_measure import contacts_of
from lagc.simulation.initialization.initialize import sizes_of_gaps, with_contact_modes
from lagc.simulation.linearization.derivatives import DEPENDENT, Array, Point
from lagc.simulation.linearization.linear_model import Linear, size_of_states
from lagc.simulation.system import OK, Options

if TYPE_CHECKING:
    from lagc.lowering.program import Contact, Interface
    from lagc.simulation.backends.python import NumpySystem

ZERO = 1e-9  # of its terms: a gap, push, slip or margin of friction that is zero
MOST_MODES = 16  # combinations in which equilibria are looked for
SHARED = "contacts share their pushes in many ways: it is not known whether one of them is zero"


class Elsewhere(ArithmeticError):
    """A state of another mode."""


def word_of(contact: Contact, mode: int) -> str:
    """Return what a contact does in a mode."""
    if mode == 0:
        return "open"
    if contact.slips == 0:
        return "touches"
    if mode == MODE_STICKS:
        return "sticks"
    return "slips" if contact.slips == 2 else "slips backwards" if mode < 0 else "slips forwards"


def modes_of(interface: Interface, whole: Sequence[float]) -> tuple[int, ...]:
    """Return the modes of the contacts in the whole state."""
    return tuple([round(mode) for mode in whole[interface.nx - len(interface.contacts) :]])


def settled(system: NumpySystem, t: float, x: Sequence[float]) -> list[float]:
    """Return the whole state x in the modes of its contacts. Raises Refused beyond a bound, ArithmeticError
    if a contact has an impact there, or the laws of contacts have no or several solutions."""
    run = system.integrate(Options(report=True), t, with_contact_modes(system, t, x), [t])
    if run.status != OK:
        raise ArithmeticError(f"the modes of contacts are not determined at t = {t:g} s")
    for _, contact, kind, *_ in contacts_of(run):
        if kind in (STRIKES, RESTS):
            raise ArithmeticError(f"`{system.interface.contacts[contact].name}` has an impact at t = {t:g} s")
    return list(run.x)


def other_modes(interface: Interface, whole: Sequence[float]) -> list[list[float]]:
    """Return the whole state in other modes in which it may be at rest, none if there are too many."""
    each = [(0, 1) if c.slips == 0 else (0, MODE_STICKS, 1, -1)[: 5 - c.slips] for c in interface.contacts]
    first = interface.nx - len(each)
    if np.prod([len(modes) for modes in each]) > MOST_MODES:
        return []
    own = modes_of(interface, whole)
    return [[*whole[:first], *map(float, modes)] for modes in product(*each) if modes != own]


def in_mode(system: NumpySystem, found: Linear, whole: Sequence[float]) -> Linear:
    """Return the linear model `found` with what contacts do in its whole state. `system` is that with
    contacts. Raises Elsewhere if they are in other modes there, ArithmeticError at the edge of a mode."""
    for words, beyond in sorted(edges(system, whole, found), key=lambda edge: not edge[1]):
        kind = Elsewhere if beyond else ArithmeticError
        raise kind(f"{words}: two modes meet, and there is no linear model")
    pairs = zip(system.interface.contacts, modes_of(system.interface, whole))
    notes = (*found.notes, SHARED) if shares(found) else found.notes
    return replace(found, contacts={c.name: word_of(c, mode) for c, mode in pairs}, notes=notes)


def edges(acting: NumpySystem, whole: Sequence[float], found: Linear) -> Iterator[tuple[str, bool]]:
    """Yield why contacts are at the edge of their modes at the state of `found`, or beyond it (True).
    `acting` is the system with contacts, `whole` its state. Forces that contacts share in many ways are not
    tested."""
    interface, modes = acting.interface, modes_of(acting.interface, whole)
    gaps, shared = acting.gaps(found.t, whole), shares(found)
    pushes = {} if shared else _forces(found)
    slips, frictions = _slips(acting, found.t, whole), _frictions(acting, found.t, whole)
    first = 0
    for k, (contact, mode) in enumerate(zip(interface.contacts, modes)):
        own, first = slips[first + 1 : first + 1 + contact.slips], first + 1 + contact.slips
        said, name = word_of(contact, mode), contact.name
        if mode == 0:
            alike = [x for x, unit in zip(size_of_states(acting), interface.q_units) if unit == contact.unit]
            size = ZERO * max([sizes_of_gaps(acting, found.t, whole)[k], *alike])
            if gaps[k] <= size:
                yield f"`{name}` is open there, with a gap of zero", gaps[k] < -size
            continue
        if contact.slips and mode != MODE_STICKS:
            speed = hypot(*(value for value, _ in own))
            if speed <= ZERO * hypot(*(size for _, size in own)):
                yield f"`{name}` {said} there, with a slip of zero", True
            elif contact.slips == 1 and mode * own[0][0] < 0.0:
                yield f"`{name}` slips the other way there", True
        if name not in pushes:
            continue
        push, size = pushes[name]
        if push <= ZERO * size:
            yield f"`{name}` {said} there, with a push of zero", push < -ZERO * size
        elif mode == MODE_STICKS:
            parts = [pushes.get(f"{name}.slip[{n + 1}]", (0.0, 0.0)) for n in range(contact.slips)]
            margin = frictions[2 * k + 1] * push - hypot(*(part for part, _ in parts))
            size += hypot(*(of for _, of in parts))
            if margin <= ZERO * size:
                yield f"`{name}` sticks there, and is about to slip", margin < -ZERO * size


def shares(found: Linear) -> bool:
    """Whether the rows of the constraints depend on each other."""
    system = found.system
    point = Point(system, found.t, found.x, [0.0] * system.nv, [0.0] * system.nc)
    rows = point.partial("row", "acceleration")[:, : system.nv]
    return bool(system.nc and np.linalg.matrix_rank(_scaled(rows), tol=DEPENDENT) < system.nc)


def _scaled(rows: Array) -> Array:
    lengths = np.abs(rows).max(axis=1, initial=0.0, keepdims=True)
    scaled: Array = rows / np.where(lengths > 0.0, lengths, 1.0)
    return scaled


def _forces(found: Linear) -> dict[str, tuple[float, float]]:
    """The multipliers of the constraints, by label, and the sizes of their terms."""
    system, nv = found.system, found.system.nv
    point = Point(system, found.t, found.x)
    bare = Point(system, found.t, found.x, [0.0] * nv, [0.0] * system.nc)
    given = np.concatenate([bare.value("inertia") - bare.value("force"), bare.value("row")])
    sizes = np.abs(point.inverse) @ np.abs(given)
    sizes += point.sizes("state") @ np.maximum(np.abs(found.x), size_of_states(system))
    sizes += point.sizes("parameter") @ np.abs(system.parameters)
    return dict(zip(system.interface.row_labels, zip(point.lam, sizes[nv:].tolist())))


def _slips(system: NumpySystem, t: float, x: Sequence[float]) -> list[tuple[float, float]]:
    """The rate of each row of the contacts, and the size of its terms."""
    n = sum(1 + contact.slips for contact in system.interface.contacts)
    rows, rates, biases = [0.0] * (n * system.nv), [0.0] * n, [0.0] * n
    system.model.module["fn_contact_rows_on"](system._p, t, x, system.modes(t, x), rows, rates, biases)
    terms = np.array(rows).reshape(n, -1) * x[system.nq : system.nq + system.nv]
    drives = np.array(rates) - terms.sum(axis=1)
    return list(zip(rates, (np.abs(terms).sum(axis=1) + np.abs(drives)).tolist()))


def _frictions(system: NumpySystem, t: float, x: Sequence[float]) -> list[float]:
    """The coefficients of each contact, of slip and of rest."""
    found = [0.0] * (2 * len(system.interface.contacts))
    if any(contact.slips for contact in system.interface.contacts):
        system.model.module["fn_frictions_on"](system._p, t, x, system.modes(t, x), found)
    return found
