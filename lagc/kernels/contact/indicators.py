"""Event indicators of contacts that touch: their forces, which fall to zero where a contact opens.

A force needs a solve and has no enclosure. The values at the stages of a step, and on parts of its dense
output, tell its range.
"""

from lagc.kernels.contact.touching import find_touching, rates_at
from lagc.kernels.language.vocabulary import *

FORCE_MARGIN = 0.25  # of a range of forces: what is added to it


def indicate_forces(p: Params, t: Real, x: Vec[NX], w: Work) -> None:
    """Set w.indicators of contacts that touch to their forces at (t, x), and to -1 if there are none."""
    if not find_touching(x, w):
        return
    found = not failed(rates_at(p, t, x, w.contact_rates, w.contact_lam, w))
    find_touching(x, w)
    for i in range(NCON):
        if w.touched[i] > 0:
            w.indicators[NMODE - NCON + i] = w.contact_forces[contact_first[i]] if found else -1.0


def enclose_forces(s: State, w: Work) -> None:
    """Set w.enclosures of contacts that touch to the range of their forces, widened by a quarter."""
    for i in range(NCON):
        if s.x[NX - NCON + i] != 0.0:
            j = NFREE - NCON + i
            more = FORCE_MARGIN * (w.force_high[i] - w.force_low[i])
            w.enclosures[2 * j] = w.force_low[i] - more
            w.enclosures[2 * j + 1] = w.force_high[i] + more


def force_range(p: Params, t: Real, x: Vec[NX], w: Work) -> None:
    """Add the forces at (t, x) to the ranges of forces."""
    if find_touching(x, w):
        if failed(rates_at(p, t, x, w.contact_rates, w.contact_lam, w)):
            for i in range(NCON):
                w.force_low[i] = -UNKNOWN


def force_crosses(s: State, w: Work) -> bool:
    """Return whether a contact in w.crossed touches."""
    for i in range(NCON):
        if w.crossed[NMODE - NCON + i] > 0 and s.x[NX - NCON + i] != 0.0:
            return True
    return False


def spare_contacts(s: State, w: Work) -> None:
    """Set the indicators and rates of contacts that touch to 0: their gaps are not watched."""
    for i in range(NCON):
        if s.x[NX - NCON + i] != 0.0:
            w.indicators[NMODE - NCON + i] = 0.0
            w.indicator_rates[NMODE - NCON + i] = 0.0
