"""Slack of contacts: round-off by which their indicators may be beyond zero where a step begins."""

from lagc.kernels.contact.frozen_modes import CONTACT_STICKS
from lagc.kernels.contact.slips import reach_of
from lagc.kernels.contact.touching import find_touching, rates_at, set_gaps, slip_along, slip_relation
from lagc.kernels.events.location import SLACK_GROWTH, estimate_indicator_roundoff
from lagc.kernels.language.vocabulary import *


def force_roundoff(n: int, k: int, w: Work) -> Real:
    """Return the round-off of the force along row k of a listed contact: that of its acceleration over its
    response. It is zero for contacts that share a load, which cross at once, and along a slip that
    constraints hold."""
    row = w.law_first[n] + k
    response = w.law_w[row * w.law_rows + row]
    if w.law_shared[n] > 0 or not response > 0.0:
        return 0.0
    return CONTACT_ROUNDOFF * w.law_sizes[row] / response


def set_force_slack(s: State, w: Work) -> None:
    """Set the slack of the listed contacts: of their forces, and of friction that they could still bear."""
    for n in range(w.law_count):
        i = w.touching[n]
        least = force_roundoff(n, 0, w)
        margin = w.force_margins[i]
        s.slack[NMODE - NCON + i] = least - (2.0 * margin if margin < 0.0 else 0.0)
        if NSLIP > 0:
            if w.law_mode[n] == CONTACT_STICKS:
                for m in range(w.law_slips[n]):
                    least += force_roundoff(n, 1 + m, w)
                margin = w.cone_margins[i]
                s.slack[slip_relation(i)] = least - (2.0 * margin if margin < 0.0 else 0.0)


def set_contact_slack(p: Params, s: State, w: Work) -> None:
    """Set the slack of contacts: of open ones by the round-off of their gaps, of those that touch by the
    round-off of their forces, w.contact_forces at (s.t, s.x)."""
    for i in range(NQ + NV):
        w.x_part_middle[i] = reach_of(i, s)
    estimate_indicator_roundoff(p, s, w.x_part_middle, w)
    set_gaps(p, s.t, s.x, w)
    w.indicators[:] = w.contact_indicators
    for i in range(NCON):
        beyond = -w.contact_gaps[i] if w.contact_gaps[i] < 0.0 else 0.0
        if w.contact_leaves[i] == 0:
            beyond += SLACK_GROWTH * w.indicator_roundoff[NFREE - NCON + i]
        s.slack[NMODE - NCON + i] = beyond
        if NSLIP > 0:
            if contact_slips[i] > 0:
                k = slip_relation(i)
                speed = s.x[NX - NCON + i] * w.indicators[k]
                least = SLACK_GROWTH * w.indicator_roundoff[k - NTIMED]
                if NSPACE > 0:
                    if contact_slips[i] == 2:
                        speed = slip_along(i, w.indicators, w)
                        least += SLACK_GROWTH * w.indicator_roundoff[k + 1 - NTIMED]
                s.slack[k] = least - (2.0 * speed if speed < 0.0 else 0.0)
    if find_touching(s.x, w):
        status = rates_at(p, s.t, s.x, w.contact_rates, w.contact_lam, w)
        s.rhs += 1
        if not failed(status):
            set_force_slack(s, w)
