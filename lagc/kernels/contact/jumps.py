"""Contacts after a jump: new values of a clause `when`, or a bound that jumps with its relations."""

from math import fabs

from lagc.kernels.contact.settle import settle
from lagc.kernels.contact.slips import PARTS, reach_of, speed_size
from lagc.kernels.contact.touching import find_touching, set_gaps
from lagc.kernels.events.location import SLACK_GROWTH, estimate_indicator_roundoff
from lagc.kernels.language.vocabulary import *

MOST_PENETRATION = 1e-6  # of the terms of a gap: a contact that touched goes on to do so within it


def settle_jump(p: Params, s: State, w: Work) -> Status:
    """Let contacts act at (s.t, s.x) after a jump, as at a start. Returns PENETRATION, with the contact and
    its depth, if it is beyond its bound; s.x is as before then."""
    set_gaps(p, s.t, s.x, w)
    for i in range(NQ + NV):
        w.x_part_middle[i] = reach_of(i, s)
    estimate_indicator_roundoff(p, s, w.x_part_middle, w)
    w.contacts_go_on = False
    for i in range(NCON):
        least = (0.5 * MOST_PENETRATION / SPACING + SLACK_GROWTH) * w.indicator_roundoff[NFREE - NCON + i]
        if w.contact_gaps[i] < -least and contact_bounds_rate[i] == 0:
            w.culprit = i
            s.penetration = -w.contact_gaps[i]
            return PENETRATION
        w.contact_hit[i] = PARTS if w.contact_gaps[i] > least and contact_bounds_rate[i] == 0 else 0
        s.bounce_speeds[i] = 0.0
    return settle(p, s, False, w)


def bounds_jump(p: Params, s: State, w: Work) -> bool:
    """Return whether a gap, or the rate of one that is closed, differs between the modes of relations
    w.modes_before and w.modes."""
    fn_indicators_on(p, s.t, s.x, w.modes_before, w.indicators)
    set_gaps(p, s.t, s.x, w)
    estimate_indicator_roundoff(p, s, s.x, w)
    for i in range(NCON):
        change = fabs(w.contact_gaps[i] - w.indicators[NMODE - NCON + i])
        if change > SLACK_GROWTH * w.indicator_roundoff[NFREE - NCON + i]:
            return True
    if find_touching(s.x, w):
        fn_contact_rows_on(p, s.t, s.x, w.modes, w.contact_rows, w.contact_speeds, w.contact_bias)
        for i in range(NCON):
            row = contact_first[i]
            if w.touched[i] > 0 and fabs(w.contact_speeds[row]) > CONTACT_ROUNDOFF * speed_size(row, s, w):
                return True
    return False
