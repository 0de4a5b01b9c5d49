"""Indicators of contacts: forces instead of gaps where they touch, and slips.

A force needs a solve, so its range over a step is that of the evaluations of the step, widened. It is
sampled, unlike the enclosures of other indicators.
"""

from math import fabs

from lagc.kernels.contact.touching import find_touching, rates_at, slip_along, slip_relation
from lagc.kernels.language.vocabulary import *

FORCE_MARGIN = 0.25  # of the range of forces: what is added to it


def indicate_forces(p: Params, t: Real, x: Vec[NX], w: Work) -> None:
    """Set w.indicators of contacts that touch to their forces at (t, x), and to -1 if there are none. That of
    a slip becomes its speed along its direction, the friction that a contact which sticks could bear beside
    its own, and 1 for an open contact; the second one of a slip in space is always 1."""
    found = True
    if find_touching(x, w):
        found = not failed(rates_at(p, t, x, w.contact_rates, w.contact_lam, w))
    find_touching(x, w)
    # All are positive within the modes: a force that holds, friction that is left, speed along the slip.
    for i in range(NCON):
        if w.touched[i] > 0:
            w.indicators[NMODE - NCON + i] = w.force_margins[i] if found else -1.0
        if NSLIP > 0:
            if contact_slips[i] > 0:
                k = slip_relation(i)
                if w.touched[i] == 0:
                    w.indicators[k] = 1.0
                elif w.contact_modes[i] == 2:
                    w.indicators[k] = w.cone_margins[i] if found else -1.0
                elif w.contact_modes[i] < 0:
                    w.indicators[k] = -w.indicators[k]
                elif NSPACE > 0:
                    if contact_slips[i] == 2:
                        w.indicators[k] = slip_along(i, w.indicators, w)
                if NSPACE > 0:
                    if contact_slips[i] == 2:
                        w.indicators[k + 1] = 1.0


def enclose_slip_along(i: int, w: Work) -> None:
    """Set w.enclosures of the first relation of a slip in space to those along its direction, and of the
    second one to 1."""
    j = slip_relation(i) - NTIMED
    low = 0.0
    high = 0.0
    for k in range(2):
        part = w.slip_axes[2 * i + k]
        below = w.enclosures[2 * (j + k)]
        above = w.enclosures[2 * (j + k) + 1]
        low += part * (below if part > 0.0 else above)
        high += part * (above if part > 0.0 else below)
    w.enclosures[2 * j] = low
    w.enclosures[2 * j + 1] = high
    w.enclosures[2 * j + 2] = 1.0
    w.enclosures[2 * j + 3] = 1.0


def enclose_slip(i: int, mode: Real, w: Work) -> None:
    """Set w.enclosures of the slip of a contact, as its indicator."""
    j = slip_relation(i) - NTIMED
    if NSPACE > 0:
        if contact_slips[i] == 2:
            enclose_slip_along(i, w)
    low = w.enclosures[2 * j]
    high = w.enclosures[2 * j + 1]
    if mode < 0.0:
        w.enclosures[2 * j] = -high
        w.enclosures[2 * j + 1] = -low
    if mode == 0.0:
        w.enclosures[2 * j] = 1.0
        w.enclosures[2 * j + 1] = 1.0
    if NSLIP > 0:
        if mode == 2.0:
            more = FORCE_MARGIN * (w.cone_high[i] - w.cone_low[i])
            w.enclosures[2 * j] = w.cone_low[i] - more
            w.enclosures[2 * j + 1] = w.cone_high[i] + more


def enclose_forces(s: State, w: Work) -> None:
    """Set w.enclosures of contacts that touch to the range of their forces, widened by a quarter."""
    for i in range(NCON):
        if s.x[NX - NCON + i] != 0.0:
            j = NFREE - NCON + i
            more = FORCE_MARGIN * (w.force_high[i] - w.force_low[i])
            w.enclosures[2 * j] = w.force_low[i] - more
            w.enclosures[2 * j + 1] = w.force_high[i] + more
        if NSLIP > 0:
            if contact_slips[i] > 0:
                enclose_slip(i, s.x[NX - NCON + i], w)


def force_range(p: Params, t: Real, x: Vec[NX], w: Work) -> None:
    """Add the forces at (t, x) to the ranges of forces."""
    if find_touching(x, w):
        if failed(rates_at(p, t, x, w.contact_rates, w.contact_lam, w)):
            for i in range(NCON):
                w.force_low[i] = -UNKNOWN
                if NSLIP > 0:
                    w.cone_low[i] = -UNKNOWN


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
                        w.indicators[k] = slip_along(i, w.indicators, w)
                        w.indicator_rates[k] = slip_along(i, w.indicator_rates, w)
                        w.indicators[k + 1] = 1.0
                        w.indicator_rates[k + 1] = 0.0
                w.indicators[k] *= along
                w.indicator_rates[k] *= along
        if s.x[NX - NCON + i] != 0.0:
            w.indicators[NMODE - NCON + i] = 0.0
            w.indicator_rates[NMODE - NCON + i] = 0.0


def force_crosses(s: State, w: Work) -> bool:
    """Return whether a contact in w.crossed touches, or a slip is in it."""
    for i in range(NCON):
        if w.crossed[NMODE - NCON + i] > 0 and s.x[NX - NCON + i] != 0.0:
            return True
        if NSLIP > 0:
            if contact_slips[i] > 0:
                if w.crossed[slip_relation(i)] > 0:
                    return True
    return False
