"""Indicators of contacts: forces instead of gaps where they touch, and slips.

A force needs a solve: it is sampled at the evaluations of a step, and on parts of its dense output.
"""

from math import fabs

from lagc.kernels.contact.touching import find_touching, rates_at, slip_along, slip_relation
from lagc.kernels.events.sampled_indicators import add_sample, enclose_samples
from lagc.kernels.language.vocabulary import *


def indicate_forces(p: Params, t: Real, x: Vec[NX], w: Work) -> None:
    """Set w.events.indicators of contacts that touch to their forces at (t, x), and to -1 if there are none.
    That of a slip becomes its speed along its direction, the friction that a contact which sticks could bear
    beside its own, and 1 for an open contact; the second one of a slip in space is always 1."""
    found = True
    # Forces need the rates; those of contacts are stored as the evaluation's by-product.
    if find_touching(x, w):
        found = not failed(rates_at(p, t, x, w.contacts.rates, w.contacts.lam, w))
    # `rates_at` with a failure may have left the list of contacts unfinished.
    find_touching(x, w)
    # All are positive within the modes: a force that holds, friction that is left, speed along the slip.
    for i in range(NCON):
        if w.contacts.touched[i] > 0:
            w.events.indicators[NMODE - NCON + i] = w.contacts.force_margins[i] if found else -1.0
        if NSLIP > 0:
            if contact_slips[i] > 0:
                k = slip_relation(i)
                if w.contacts.touched[i] == 0:
                    w.events.indicators[k] = 1.0
                elif w.contacts.modes[i] == 2:
                    w.events.indicators[k] = w.contacts.cone_margins[i] if found else -1.0
                elif w.contacts.modes[i] < 0:
                    w.events.indicators[k] = -w.events.indicators[k]
                elif NSPACE > 0:
                    if contact_slips[i] == 2:
                        w.events.indicators[k] = slip_along(i, w.events.indicators, w)
                if NSPACE > 0:
                    if contact_slips[i] == 2:
                        w.events.indicators[k + 1] = 1.0


def enclose_slip_along(i: int, w: Work) -> None:
    """Set w.events.enclosures of the first relation of a slip in space to those along its direction, and of
    the second one to 1."""
    # Bounds of the sum of two intervals with the axis as coefficients.
    j = slip_relation(i) - NTIMED
    low = 0.0
    high = 0.0
    for k in range(2):
        part = w.contacts.slip_axes[2 * i + k]
        below = w.events.enclosures[2 * (j + k)]
        above = w.events.enclosures[2 * (j + k) + 1]
        low += part * (below if part > 0.0 else above)
        high += part * (above if part > 0.0 else below)
    w.events.enclosures[2 * j] = low
    w.events.enclosures[2 * j + 1] = high
    w.events.enclosures[2 * j + 2] = 1.0
    w.events.enclosures[2 * j + 3] = 1.0


def enclose_slip(i: int, mode: Real, w: Work) -> None:
    """Set w.events.enclosures of the slip of a contact, as its indicator."""
    j = slip_relation(i) - NTIMED
    if NSPACE > 0:
        if contact_slips[i] == 2:
            enclose_slip_along(i, w)
    low = w.events.enclosures[2 * j]
    high = w.events.enclosures[2 * j + 1]
    # Slipping backwards is positive within its mode after a change of sign. An open contact has no slip; one
    # that sticks is watched by its cone, whose margin is sampled.
    if mode < 0.0:
        w.events.enclosures[2 * j] = -high
        w.events.enclosures[2 * j + 1] = -low
    if mode == 0.0:
        w.events.enclosures[2 * j] = 1.0
        w.events.enclosures[2 * j + 1] = 1.0
    if mode == 2.0:
        enclose_samples(slip_relation(i), w)


def enclose_forces(s: State, w: Work) -> None:
    """Set w.events.enclosures of contacts that touch to the range of their forces."""
    for i in range(NCON):
        if s.x[NX - NCON + i] != 0.0:
            enclose_samples(NMODE - NCON + i, w)
        if NSLIP > 0:
            if contact_slips[i] > 0:
                enclose_slip(i, s.x[NX - NCON + i], w)


def force_range(p: Params, t: Real, x: Vec[NX], w: Work) -> None:
    """Add the forces at (t, x) to the ranges of forces."""
    if not w.contacts.flies and find_touching(x, w):
        if failed(rates_at(p, t, x, w.contacts.rates, w.contacts.lam, w)):
            for k in range(NMODE - NCON - NSLIP, NMODE):
                add_sample(k, -UNKNOWN, w)


def spare_contacts(s: State, w: Work) -> None:
    """Set the indicators and rates of contacts that touch to 0: their gaps are not watched. Those of slips
    are taken along the direction of slip."""
    for i in range(NCON):
        if NSLIP > 0:
            if contact_slips[i] > 0:
                k = slip_relation(i)
                mode = s.x[NX - NCON + i]
                along = mode if fabs(mode) == 1.0 else 0.0
                if NSPACE > 0:
                    if contact_slips[i] == 2:
                        w.events.indicators[k] = slip_along(i, w.events.indicators, w)
                        w.events.rates[k] = slip_along(i, w.events.rates, w)
                        w.events.indicators[k + 1] = 1.0
                        w.events.rates[k + 1] = 0.0
                w.events.indicators[k] *= along
                w.events.rates[k] *= along
        if s.x[NX - NCON + i] != 0.0:
            w.events.indicators[NMODE - NCON + i] = 0.0
            w.events.rates[NMODE - NCON + i] = 0.0


def force_crosses(s: State, w: Work) -> bool:
    """Return whether a contact in w.events.crossed touches, or a slip is in it."""
    for i in range(NCON):
        if w.events.crossed[NMODE - NCON + i] > 0 and s.x[NX - NCON + i] != 0.0:
            return True
        if NSLIP > 0:
            if contact_slips[i] > 0:
                if w.events.crossed[slip_relation(i)] > 0:
                    return True
    return False
