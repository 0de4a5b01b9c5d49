"""Events of contacts: gaps that close, forces that fall to zero, slips that end.

The slack of their indicators is the round-off by which these may be beyond zero where a step begins.
"""

from lagc.kernels.contact.kept_blocks import keep_blocks, keep_blocks_at_rest
from lagc.kernels.contact.settle import bounds_jump, settle, settle_jump
from lagc.kernels.contact.slips import REACHES, RELEASES, SLIDES, STOPS, TURNS, reach_of
from lagc.kernels.contact.touching import find_touching, rates_at, set_gaps, slip_along, slip_relation
from lagc.kernels.events.location import SLACK_GROWTH, estimate_indicator_roundoff
from lagc.kernels.events.mode_change import MOST_CHANGES, change_modes
from lagc.kernels.events.modes import choose_modes, update_edges
from lagc.kernels.events.when_clauses import (
    act_on_conditions,
    event_delay,
    record_crossing_times,
    restore_state,
    save_state,
    start_modes,
)
from lagc.kernels.language.vocabulary import *


def take_hits(s: State, w: Work) -> bool:
    """Move contacts from w.events.crossed to w.settling.hit; return whether there are any."""
    # A crossing is read by the mode: an open gap closes, a force of a closed contact falls to zero (or turns,
    # of a two-sided contact), a slip stops, static friction gives way.
    found = False
    for i in range(NCON):
        k = NMODE - NCON + i
        w.settling.hit[i] = 0
        mode = s.x[NX - NCON + i]
        if NSLIP > 0:
            if contact_slips[i] > 0:
                if w.events.crossed[slip_relation(i)] > 0:
                    w.events.crossed[slip_relation(i)] = 0
                    w.settling.hit[i] = SLIDES if mode == 2.0 else STOPS
                    w.culprit = k
                    found = True
        if w.events.crossed[k] > 0:
            w.events.crossed[k] = 0
            w.settling.hit[i] = RELEASES if mode != 0.0 else REACHES
            if NTWO > 0:
                if contact_normals[i] > 0:
                    w.settling.hit[i] = TURNS
            w.culprit = k
            found = True
    return found


def others_cross(w: Work) -> bool:
    """Return whether relations cross that are no contacts."""
    for k in range(NMODE):
        if w.events.crossed[k] > 0:
            return True
    return False


def contacts_chatter(s: State) -> bool:
    """Return whether contacts act without end at one time."""
    if s.t != s.t_changed:
        s.t_changed = s.t
        s.changes_at_time = 0
    s.changes_at_time += 1
    return s.changes_at_time > MOST_CHANGES + 2 * NMODE


def unresolved(i: int, margin: Real, s: State, w: Work) -> Real:
    """Return more slack for a force that is not yet zero where an implicit step was to end at its zero, and
    whose zero is nearer than round-off of the time: twice as much each time."""
    if not (w.settling.hit[i] > 0 and margin > 0.0 and s.changes_at_time > 1):
        return 0.0
    slack = margin
    for turn in range(s.changes_at_time):
        slack *= 2.0
    return slack


def set_force_slack(s: State, w: Work) -> None:
    """Set the slack of contacts that touch: of their forces, and of friction that they could still bear."""
    # Normal force: its round-off. A force that is slightly beyond gets twice that as slack. The margin of
    # friction has the round-off of all its rows.
    for i in range(NCON):
        if w.contacts.touched[i] > 0:
            margin = w.contacts.force_margins[i]
            s.slack[NMODE - NCON + i] = w.contacts.force_roundoff[i] - (2.0 * margin if margin < 0.0 else 0.0)
            if NNEWTON > 0:
                s.slack[NMODE - NCON + i] += unresolved(i, margin, s, w)
            if NSLIP > 0:
                if w.contacts.modes[i] == 2:
                    margin = w.contacts.cone_margins[i]
                    least = w.contacts.cone_roundoff[i]
                    s.slack[slip_relation(i)] = least - (2.0 * margin if margin < 0.0 else 0.0)
                    if NNEWTON > 0:
                        s.slack[slip_relation(i)] += unresolved(i, margin, s, w)


def set_contact_slack(p: Params, s: State, w: Work) -> None:
    """Set the slack of contacts: of open ones by the round-off of their gaps, of those that touch by the
    round-off of their forces, w.contacts.forces at (s.t, s.x)."""
    # Round-off of gaps for states of their largest sizes so far.
    for i in range(NQ + NV):
        w.search.x_part_middle[i] = reach_of(i, s)
    estimate_indicator_roundoff(p, s, w.search.x_part_middle, w)
    # One that leaves after an impact has no slack: its gap is watched from zero on.
    set_gaps(p, s.t, s.x, w)
    w.events.indicators[:] = w.contacts.indicators
    # Gaps of open contacts, speeds of slips along their direction: each with its round-off, plus what it is
    # beyond zero now.
    for i in range(NCON):
        beyond = -w.contacts.gaps[i] if w.contacts.gaps[i] < 0.0 else 0.0
        if w.settling.leaves[i] == 0:
            beyond += SLACK_GROWTH * w.events.roundoff[NFREE - NCON + i]
        s.slack[NMODE - NCON + i] = beyond
        if NSLIP > 0:
            if contact_slips[i] > 0:
                k = slip_relation(i)
                speed = s.x[NX - NCON + i] * w.events.indicators[k]
                least = SLACK_GROWTH * w.events.roundoff[k - NTIMED]
                if NSPACE > 0:
                    if contact_slips[i] == 2:
                        speed = slip_along(i, w.events.indicators, w)
                        least += SLACK_GROWTH * w.events.roundoff[k + 1 - NTIMED]
                s.slack[k] = least - (2.0 * speed if speed < 0.0 else 0.0)
    # Forces of contacts that touch replace these gaps; they need the rates at this state.
    if find_touching(s.x, w):
        status = rates_at(p, s.t, s.x, w.contacts.rates, w.contacts.lam, w)
        s.rhs += 1
        if not failed(status):
            set_force_slack(s, w)


def act_after_contacts(p: Params, s: State, direction: Real, since: Real, w: Work) -> Status:
    """Let clauses `when` act whose conditions became true `since` before s.t. New values move contacts."""
    status = OK
    if NWHEN > 0:
        status = act_on_conditions(p, s, direction, since, w)
        if NJUMP > 0:
            if w.clauses.at_event_time and (status == TERMINATED or not failed(status)):
                set_contact_slack(p, s, w)
    return status


def find_unmoved(p: Params, s: State, w: Work) -> None:
    """Set w.settling.indicators_unmoved: indicators of the state that are w.events.indicators_before at (s.t,
    s.x) too."""
    fn_indicators_on(p, s.t, s.x, w.modes, w.events.indicators)
    for k in range(NMODE):
        w.settling.indicators_unmoved[k] = 0
        if k < NMODE - NCON - NSLIP - NLATE and w.events.indicators[k] == w.events.indicators_before[k]:
            w.settling.indicators_unmoved[k] = 1


def settle_event(p: Params, s: State, direction: Real, jumps: bool, w: Work) -> Status:
    """Let contacts act, then find the modes of relations that they change, and let clauses `when` act.
    `jumps`: a bound has jumped."""
    # Bounds may jump with the modes of relations, as a floor that a switch raises; then contacts act as after
    # a jump.
    fn_indicators_on(p, s.t, s.x, w.modes, w.events.indicators_before)
    w.settling.go_on = True
    status = settle_jump(p, s, w) if jumps else settle(p, s, False, w)
    if failed(status):
        return status
    # Relations that contacts did not move keep their modes; the others are chosen by their values. k[0] is
    # lent to this evaluation.
    find_unmoved(p, s, w)
    w.settling.rates[:] = s.k[0]
    status = choose_modes(p, s, direction, w)
    w.contacts.rates[:] = s.k[0]
    s.k[0][:] = w.settling.rates  # the dense output of the step before needs it
    s.rate_place = ABSENT
    if failed(status):
        return status
    # Contacts have acted, so no relation is left to cross; clauses may follow what contacts changed.
    for k in range(NMODE):
        w.events.crossed[k] = 0
    if NWHEN > 0:
        w.xdot[:] = w.contacts.rates
    set_contact_slack(p, s, w)
    return act_after_contacts(p, s, direction, 0.0, w)


def pass_hits(p: Params, s: State, direction: Real, w: Work) -> Status:
    """Do what happens where contacts in w.settling.hit and relations in w.events.crossed cross, at (s.t,
    s.x)."""
    # First relations that cross at the same time (their modes change the forces), then contacts, then
    # clauses.
    if contacts_chatter(s):
        return CHATTERING
    jumps = False
    for k in range(NMODE):
        s.changed[k] = 0
    if NWHEN > 0:
        s.acts = 0
    if NPLAIN > 0:
        if others_cross(w):
            status = change_modes(p, s, direction, w)
            if failed(status):
                return status
            w.modes[:] = s.modes
            jumps = bounds_jump(p, s, w)
    return settle_event(p, s, direction, jumps, w)


def pass_relations(p: Params, s: State, direction: Real, w: Work) -> Status:
    """Do what happens where relations in w.events.crossed cross, at (s.t, s.x)."""
    status = change_modes(p, s, direction, w)
    if status != OK:
        return status
    if bounds_jump(p, s, w):
        if NWHEN > 0:
            s.acts = 0
        return settle_event(p, s, direction, True, w)
    if NWHEN > 0:
        return act_after_contacts(p, s, direction, event_delay(s, direction, w), w)
    return OK


def pass_event(p: Params, s: State, direction: Real, w: Work) -> Status:
    """Do what happens where relations or contacts in w.events.crossed cross, at (s.t, s.x)."""
    keep_blocks_at_rest(True, w)
    w.settling.has_acted = False
    w.settling.modes_before[:] = s.modes
    if NWHEN > 0:
        # Clauses may fail after contacts have acted: all is restored then.
        save_state(s, w)
    status = OK
    if take_hits(s, w):
        status = pass_hits(p, s, direction, w)
    elif NPLAIN > 0:
        status = pass_relations(p, s, direction, w)
    if NWHEN > 0:
        if failed(status) and status != TERMINATED:
            restore_state(s, w)
        else:
            record_crossing_times(s, w)
    keep_blocks(False, w)
    return status


def start_contacts(p: Params, s: State, direction: Real, elsewhere: bool, w: Work) -> Status:
    """Let contacts act at the beginning of a call, then find the modes of relations and the rates."""
    # At the beginning of a trajectory contacts settle without an event; later a change by the caller is a
    # jump.
    w.modes[:] = s.modes
    if elsewhere:
        fn_modes(p, s.t, s.x, w.modes)
    update_edges(w)
    w.settling.has_acted = False
    for i in range(NCON):
        w.settling.hit[i] = 0
    for k in range(NMODE):
        w.settling.indicators_unmoved[k] = 0
    begins = not s.parameters_known
    w.settling.go_on = False
    status = settle(p, s, True, w) if begins else settle_jump(p, s, w)
    if failed(status):
        return status
    status = start_modes(p, s, direction, elsewhere, w)
    if not failed(status):
        set_contact_slack(p, s, w)
    return status
