"""Events that the dense output of an implicit step does not resolve.

A contact that opens as its force falls to zero, and a slip that begins, leave zero with a rate of zero. The
dense output has the error that the tolerance admits, so it may cross zero again at once. In the first step
they may be beyond zero by that. A step that ends beyond, or at a crossing that the motion moves away from, is
made shorter.
"""

from math import fabs

from lagc.kernels.contact.indicators import force_crosses, spare_contacts
from lagc.kernels.contact.settle import OPENS, SLIPS
from lagc.kernels.contact.slips import speed_size
from lagc.kernels.contact.touching import slip_relation
from lagc.kernels.events.late_indicators import indicator_rates_at, indicators_at
from lagc.kernels.events.location import all_move_away, estimate_indicator_roundoff, moves_away
from lagc.kernels.events.modes import margin
from lagc.kernels.integrators.dispatch import end_rate_row, is_implicit
from lagc.kernels.language.vocabulary import *

MOST_UNRESOLVED = 12  # attempts of a step that do not resolve its events


def find_departures(p: Params, s: State, error: Real, w: Work) -> None:
    """Set w.settling.departs to the relations that leave zero with a rate of zero, and their slack to what
    this relative error of the states makes of them."""
    for i in range(NCON):
        w.settling.departs[i] = -1
    if not s.after_event or s.settlements == 0:
        return
    # Speeds of their rows, and what the error makes of gaps and slips.
    fn_contact_rows_on(p, s.t, s.x, w.modes, w.contacts.rows, w.contacts.speeds, w.contacts.bias)
    for i in range(NQ + NV):
        w.search.x_part_middle[i] = s.sizes[scaling_group[i]]
    estimate_indicator_roundoff(p, s, w.search.x_part_middle, w)
    for i in range(NCON):
        row = contact_first[i]
        k = NMODE - NCON + i
        if NSLIP > 0:
            if s.contact_kinds[i] == SLIPS:
                row += 1
                k = slip_relation(i)
        if (s.contact_kinds[i] == OPENS or s.contact_kinds[i] == SLIPS) and fabs(
            w.contacts.speeds[row]
        ) <= CONTACT_ROUNDOFF * speed_size(row, s, w):
            w.settling.departs[i] = k
            least = error / SPACING * w.events.roundoff[k - NTIMED]
            if s.slack[k] < least:
                s.slack[k] = least


def end_departures(s: State, w: Work) -> None:
    """Take away this slack at the end of the step."""
    for i in range(NCON):
        if w.settling.departs[i] >= 0:
            s.slack[w.settling.departs[i]] = 0.0


def has_returned(a: Trial, w: Work) -> bool:
    """Return whether what has left zero in this attempt is beyond it and does not move away, by
    w.events.indicators and w.events.rates at its end."""
    for i in range(NCON):
        k = w.settling.departs[i]
        if k >= 0:
            if margin(k, w.events.indicators[k], 0.0, w) < 0.0 and not moves_away(k, a.direction, w):
                return True
    return False


def leaves_event_unresolved(p: Params, s: State, o: Options, a: Trial, w: Work) -> bool:
    """Shorten an implicit step whose dense output does not resolve its event; return whether it was
    shortened."""
    if not is_implicit(o.method) or o.step > 0.0 or a.rejected == MOST_UNRESOLVED:
        return False
    rates = s.k[end_rate_row(o.method)]
    indicators_at(p, a.t_new, s.x_new, w.modes, w.events.indicators, s, w)
    indicator_rates_at(p, a.t_new, s.x_new, w.modes, rates, w.events.rates, s, w)
    crosses = a.ends_at_event and not force_crosses(s, w)
    # The step, made to a crossing of the dense output, moves away there.
    if crosses and all_move_away(a.direction, w):
        a.size = 0.25 * a.size_before_event
    else:
        spare_contacts(s, w)
        if not has_returned(a, w):
            return False
        a.size *= 0.5
    a.ends_at_event = False
    a.rejected += 1
    s.rejected += 1
    return True
