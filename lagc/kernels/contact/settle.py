"""The settling of contacts at one time: impacts, then closed and open contacts by their accelerations.

1. Contacts that are hit, and those that touch, are put on gap = 0.
2. While touching contacts approach, those that do have an impact (`impact`).
3. The law of contact decides which of those at rest stay closed (`set_law`).
4. A contact whose next bounce stays below the least height rests. The bounces that are left take the time of
   a geometric series: 2 u / |a| / (1 - r), where r is the ratio of two speeds of rebound.
"""

from math import fabs

from lagc.kernels.contact.impact import IMPACT_DONE, IMPACT_ENDLESS, IMPACT_NONE
from lagc.kernels.contact.law import CONTACT_OPEN, CONTACT_STICKS
from lagc.kernels.contact.modes import LAW_FOUND
from lagc.kernels.contact.normal_forces import find_law, normal_sign, set_normals_given, strike_all
from lagc.kernels.contact.responses import (
    add_cancelling,
    add_responses,
    keep_begin,
    respond,
    servos_follow,
    set_accelerations,
)
from lagc.kernels.contact.slips import (
    PARTS,
    REACHES,
    RELEASES,
    TURNS,
    find_slips,
    let_slip,
    pass_slips,
    reach_of,
    slides_back,
    speed_size,
    stop_slips,
    turn_slips,
)
from lagc.kernels.contact.touching import (
    close,
    find_touching,
    list_contacts,
    moves_freely,
    seat,
    set_frictions,
    set_gaps,
    solve_loaded,
)
from lagc.kernels.dynamics.rhs import rhs_at
from lagc.kernels.events.location import SLACK_GROWTH, estimate_indicator_roundoff
from lagc.kernels.language.vocabulary import *

STRIKES = 1  # what a contact did at an event: it had an impact
RESTS = 2  # it came to rest after ever shorter bounces
CLOSES = 3
OPENS = 4
STICKS = 5
SLIPS = 6  # it begins to slip, or slips the other way
LONGEST_AFTER_BOUNCE = 64.0  # next step, over the time of flight
MOST_PENETRATION = 1e-6  # of the terms of a gap: a contact that touched goes on to do so within it


def spare_blocks(w: Work) -> None:
    """Clear w.contacts.touched of blocks in which nothing happens."""
    for i in range(NCON):
        if w.settling.acts[contact_block[i]] == 0:
            w.contacts.touched[i] = 0


def find_acting_blocks(w: Work) -> None:
    """Set w.settling.acts: at an event, blocks without a hit go on as before, as their forces do not depend
    on others; else all act."""
    for block in range(NBLOCK):
        w.settling.acts[block] = 0 if w.settling.go_on else 1
    for i in range(NCON):
        if w.settling.hit[i] > 0:
            w.settling.acts[contact_block[i]] = 1


def find_near_contacts(p: Params, s: State, w: Work) -> None:
    """Set w.contacts.touched to contacts of blocks that act which touch, are hit, or are within round-off of
    touching, and to bounds of velocities, which any impulse may hit."""
    # A contact touches by its mode or by its hit; one that a jump has put apart does not.
    set_gaps(p, s.t, s.x, w)
    estimate_indicator_roundoff(p, s, s.x, w)
    for i in range(NCON):
        near = w.contacts.gaps[i] <= SLACK_GROWTH * w.events.roundoff[NFREE - NCON + i]
        near = near or contact_bounds_rate[i] > 0
        touches = s.x[NX - NCON + i] != 0.0 or w.settling.hit[i] > 0
        w.contacts.touched[i] = 1 if (touches or near) and w.settling.hit[i] != PARTS else 0
        w.contacts.modes[i] = 1
    spare_blocks(w)


def set_speeds(s: State, w: Work) -> None:
    """Set w.contacts.law.b to the speeds of the listed rows, and w.contacts.law.terms to their sizes."""
    for r in range(w.contacts.law.rows):
        row = w.contacts.touching_rows[r]
        w.contacts.law.b[r] = w.contacts.speeds[row]
        w.contacts.law.terms[r] = speed_size(row, s, w)


def fastest_approach(w: Work) -> int:
    """Return the listed contact that approaches fastest."""
    fastest = w.contacts.touching[0]
    for n in range(w.contacts.law.count):
        if w.contacts.approach[w.contacts.touching[n]] > w.contacts.approach[fastest]:
            fastest = w.contacts.touching[n]
    return fastest


def strike_contacts(p: Params, s: State, w: Work) -> Status:
    """Let the listed contacts that approach have an impact, and set w.settling.leaves: 1 for those that leave
    then."""
    law = w.contacts.law
    # Responses X and W of all contacts that touch, not only of those that approach: an impulse may open a
    # gap, or close one that rests.
    fn_contact_rows_on(p, s.t, s.x, w.modes, w.contacts.rows, w.contacts.speeds, w.contacts.bias)
    status = respond(p, s.t, s.x, w)
    if failed(status):
        return status
    if NHELD > 0:
        if not servos_follow(p, s.t, s.x, w):
            w.culprit += NCON
            return PARADOX
    # The problem: W of the responses, the speeds before as b, and what each pair of surfaces does.
    set_speeds(s, w)
    set_frictions(p, s.t, s.x, w)
    fn_restitutions(p, s.t, s.x, w.settling.restitutions)
    for n in range(law.count):
        w.contacts.impact.restitution[n] = w.settling.restitutions[w.contacts.touching[n]]
        if NPOISSON > 0:
            w.contacts.impact.poisson[n] = contact_poisson[w.contacts.touching[n]]
    if NTWO > 0:
        fn_normals_on(p, s.t, s.x, w.modes, w.contacts.normal_rows, w.contacts.normal_bias)
    for n in range(law.count):
        w.contacts.approach[w.contacts.touching[n]] = -law.b[law.first[n]]
    found = strike_all(w)
    if found != IMPACT_NONE:
        if found != IMPACT_DONE:
            w.culprit = fastest_approach(w)
            if found == IMPACT_ENDLESS:
                w.culprit += NMODE - NCON
                return CHATTERING
            return PARADOX
        # The impulses change all speeds; a two-sided contact is not struck by its constraint.
        add_responses(s.x, w)
        for n in range(law.count):
            w.settling.struck[w.contacts.touching[n]] = law.p[law.first[n]]
            w.settling.lost[w.contacts.touching[n]] = w.contacts.impact.loss[n]
            if NTWO > 0:
                if contact_normals[w.contacts.touching[n]] > 0:
                    w.settling.struck[w.contacts.touching[n]] = 0.0
        fn_contact_rows_on(p, s.t, s.x, w.modes, w.contacts.rows, w.contacts.speeds, w.contacts.bias)
        set_speeds(s, w)
    for n in range(law.count):
        r = law.first[n]
        w.settling.leaves[w.contacts.touching[n]] = 1 if law.b[r] > CONTACT_ROUNDOFF * law.terms[r] else 0
    return OK


def closed_mode(n: int, w: Work) -> int:
    """Return the mode of a listed contact that the law has found."""
    law = w.contacts.law
    if law.mode[n] == CONTACT_OPEN:
        return 0
    if law.slips[n] == 0:
        return 1
    if law.mode[n] == CONTACT_STICKS:
        return 2
    return -1 if law.slips[n] == 1 and law.direction[2 * n] < 0.0 else 1


def decide_loaded(p: Params, s: State, w: Work) -> Status:
    """Find the modes of the listed contacts, with loads that depend on reactions."""
    keep_begin(w.contacts.rates, w.contacts.lam, w)
    set_frictions(p, s.t, s.x, w)
    find_slips(s, w)
    status = solve_loaded(p, s.t, s.x, w.contacts.rates, w.contacts.lam, True, w)
    if not failed(status) and slides_back(w):
        status = solve_loaded(p, s.t, s.x, w.contacts.rates, w.contacts.lam, True, w)
    return status


def drop_immovable(w: Work) -> bool:
    """Leave out listed contacts whose gaps no motion changes at this place, as that of a pendulum over the
    floor at its lowest point: neither a force nor its lack tells whether they stay closed. Return whether
    there are any."""
    # No entry on the diagonal of W: no impulse at this gap changes its rate. Two-sided contacts have another
    # quantity in this row (see `normal_forces`).
    law = w.contacts.law
    found = False
    for n in range(law.count):
        i = w.contacts.touching[n]
        k = law.first[n]
        held = law.W[k * law.rows + k] == 0.0
        if NTWO > 0:
            held = held and contact_normals[i] == 0
        if held:
            w.contacts.touched[i] = 0
            found = True
    if found:
        list_contacts(True, w)
    return found


def decide(p: Params, s: State, w: Work) -> Status:
    """Find which contacts in w.contacts.touched stay closed, w.settling.closed, and the rates
    w.contacts.rates."""
    law = w.contacts.law
    # Without contacts that touch, the free motion is the answer.
    for i in range(NCON):
        w.settling.closed[i] = 0
    list_contacts(True, w)
    if NLOADED > 0:
        if law.count == 0:
            s.rhs += 1
            for i in range(NCROW):
                w.contacts.forces[i] = 0.0
            return moves_freely(p, s.t, s.x, w.contacts.rates, w.contacts.lam, w)
    # b of the law is the acceleration without forces of contacts, and W their responses.
    status = rhs_at(p, s.t, s.x, w.contacts.rates, w.contacts.lam, w)
    s.rhs += 1
    if failed(status) or law.count == 0:
        return status
    # Loads that depend on reactions change b and W with the forces, so they have their own iteration.
    if NLOADS > 0:
        status = decide_loaded(p, s, w)
        if failed(status):
            return status
    else:
        status = respond(p, s.t, s.x, w)
        # A gap that nothing moves makes a row of zeros, for which any force would do.
        if not failed(status) and drop_immovable(w):
            status = respond(p, s.t, s.x, w)
        if failed(status) or law.count == 0:
            return status
        set_accelerations(w.contacts.rates, w)
        set_frictions(p, s.t, s.x, w)
        find_slips(s, w)
        if NTWO > 0:
            fn_normals_on(p, s.t, s.x, w.modes, w.contacts.normal_rows, w.contacts.normal_bias)
            set_normals_given(w.contacts.rates, w.contacts.lam, w)
        if NSLIP > 0:
            pass_slips(w)
        # A slip that was set to begin against its force may move the other way: then it sticks.
        found = find_law(w)
        if found <= LAW_FOUND and slides_back(w):
            found = find_law(w)
        if found > LAW_FOUND:
            w.culprit = w.contacts.touching[law.culprit]
            return PARADOX
    # The forces of the law make the accelerations. Modes, signs and slip axes are those that the law has
    # found, for the evaluations of the next steps.
    add_cancelling(w.contacts.rates, w)
    for n in range(law.count):
        w.settling.closed[w.contacts.touching[n]] = closed_mode(n, w)
        if NTWO > 0:
            contact = w.contacts.touching[n]
            if contact_normals[contact] == 1:
                falls = w.settling.hit[contact] == TURNS and s.normal_signs[contact] != 0
                w.contacts.normal_signs[contact] = -s.normal_signs[contact] if falls else normal_sign(n, w)
        if NSPACE > 0:
            for k in range(2):
                w.contacts.slip_axes[2 * w.contacts.touching[n] + k] = law.direction[2 * n + k]
    return OK


def gap_acceleration(i: int, w: Work) -> Real:
    """Return the acceleration of a gap for the rates w.contacts.rates."""
    row = contact_first[i]
    total = w.contacts.bias[row]
    for j in range(NV):
        total += w.contacts.rows[row * NV + j] * w.contacts.rates[NQ + j]
    return total


def acceleration_roundoff(i: int, w: Work) -> Real:
    """Return the round-off of this acceleration."""
    row = contact_first[i]
    total = fabs(w.contacts.bias[row])
    for j in range(NV):
        total += fabs(w.contacts.rows[row * NV + j] * w.contacts.rates[NQ + j])
    return CONTACT_ROUNDOFF * total


def decide_released(p: Params, s: State, w: Work) -> Status:
    """Decide without contacts whose force has fallen to zero; if one would sink in, decide with them too."""
    released = False
    # First the answer that the event proposes: contacts whose force fell to zero open.
    for i in range(NCON):
        w.settling.near[i] = w.contacts.touched[i]
        if w.settling.hit[i] == RELEASES and w.contacts.touched[i] > 0:
            w.contacts.touched[i] = 0
            released = True
    status = decide(p, s, w)
    if failed(status) or not released:
        return status
    # It holds if their gaps do not accelerate inwards. Else other forces have changed at the same time, and
    # all contacts are decided together.
    sinks = False
    for i in range(NCON):
        if w.settling.hit[i] == RELEASES and w.settling.near[i] > 0:
            if gap_acceleration(i, w) < -acceleration_roundoff(i, w):
                sinks = True
    if sinks:
        for i in range(NCON):
            w.contacts.touched[i] = w.settling.near[i]
        return decide(p, s, w)
    return status


def find_rests(s: State, w: Work) -> bool:
    """Return whether further contacts rest: their next bounce, by w.contacts.rates, stays below the least
    height, a part of the largest one that they fell from. That is half the speed before the impact times the
    time since they touched: the height of a fall from rest, up to twice that of a flight up and down. Set
    s.rest_times."""
    found = False
    for i in range(NCON):
        speed = fabs(w.contacts.speeds[contact_first[i]])
        if w.settling.leaves[i] > 0 and w.settling.rests[i] == 0 and contact_bounds_rate[i] == 0:
            # The next bounce: of the height u^2 / (2 a) and the duration 2 u / a.
            falls = -gap_acceleration(i, w)
            before = s.bounce_speeds[i]
            s.bounce_speeds[i] = speed
            # The height of the fall is estimated from the impact and the time since the last touch, since
            # gaps are not recorded within steps.
            if falls > 0.0:
                flight = 2.0 * speed / falls
                height = 0.5 * w.contacts.approach[i] * fabs(s.t - s.touch_times[i])
                if height > s.fall_heights[i]:
                    s.fall_heights[i] = height
                least = LOWEST_BOUNCE * s.fall_heights[i]
                least += SLACK_GROWTH * w.events.roundoff[NFREE - NCON + i]
                # u^2 / (2 a) = u flight / 4 is below the least height.
                if speed * flight < 4.0 * least:
                    # Ratios of speeds are those of flights: the rest of the series takes flight / (1 - r).
                    ratio = speed / before if before > speed else w.settling.restitutions[i]
                    if ratio < 1.0:
                        w.settling.rests[i] = 1
                        s.rest_times[i] = s.t + flight / (1.0 - ratio)
                        found = True
                # A step that is long beside the flight would jump over the bounces that follow.
                elif s.h > LONGEST_AFTER_BOUNCE * flight:
                    s.h = LONGEST_AFTER_BOUNCE * flight
    return found


def bring_to_rest(p: Params, s: State, w: Work) -> Status:
    """Stop the contacts in w.settling.rests, and decide again."""
    # The gaps of all contacts that are closed or stop lose their speed, by the least change in the metric of
    # the mass matrix; then forces decide again, as one that stopped may carry others.
    for i in range(NCON):
        w.contacts.touched[i] = 1 if w.settling.closed[i] != 0 or w.settling.rests[i] > 0 else 0
        w.settling.near[i] = w.contacts.touched[i]
        w.contacts.modes[i] = w.settling.closed[i] if w.settling.closed[i] != 0 else 1
    list_contacts(True, w)
    let_slip(p, s, w)
    status = close(p, s.t, s.x, w)
    if failed(status):
        return status
    fn_contact_rows_on(p, s.t, s.x, w.modes, w.contacts.rows, w.contacts.speeds, w.contacts.bias)
    for i in range(NCON):
        w.contacts.touched[i] = w.settling.near[i]
    return decide(p, s, w)


def keep_closed(p: Params, s: State, w: Work) -> Status:
    """Stop the gaps of contacts that touched before, which the seating of those that are hit has moved, and
    put bounds of velocities that are reached on gap = 0: a speed of round-off would let them take part in the
    impact, or leave."""
    status = OK
    find_touching(s.x, w)
    spare_blocks(w)
    for i in range(NCON):
        if contact_bounds_rate[i] > 0 and w.settling.hit[i] == REACHES:
            w.contacts.touched[i] = 1
    list_contacts(True, w)
    if w.contacts.law.count > 0:
        status = close(p, s.t, s.x, w)
    for i in range(NCON):
        w.contacts.touched[i] = w.settling.near[i]
        w.contacts.modes[i] = 1
    return status


def keep_mode(i: int, s: State, w: Work) -> None:
    """Make the mode of a contact that was decided, w.settling.closed, that of the state."""
    before = s.x[NX - NCON + i]
    if w.settling.leaves[i] > 0 or before != 0.0 or w.settling.closed[i] != 0:
        s.touch_times[i] = s.t
    if w.settling.closed[i] != 0:
        s.bounce_speeds[i] = 0.0
    if NSPACE > 0:
        s.slips.begins[i] = 1 if w.settling.closed[i] == 1 and before != 1.0 else 0
    s.x[NX - NCON + i] = float(w.settling.closed[i])


def settle_states(p: Params, s: State, w: Work) -> Status:
    """Do what contacts do at (s.t, s.x), with the hits w.settling.hit. Their modes in s.x follow."""
    # Every record of this event begins empty: impulses, losses, who leaves and who rests.
    find_acting_blocks(w)
    find_near_contacts(p, s, w)
    for i in range(NCON):
        w.settling.struck[i] = 0.0
        w.settling.lost[i] = 0.0
        w.settling.leaves[i] = 0
        w.settling.rests[i] = 0
        w.contacts.approach[i] = 0.0
        w.settling.near[i] = w.contacts.touched[i]
    list_contacts(True, w)
    # Gaps first (positions), then slips that have ended, then impacts (speeds), then forces (accelerations):
    # each level presumes the ones before it. Rows of slips are not listed for displacements.
    if w.contacts.law.count > 0:
        list_contacts(False, w)
        status = seat(p, s.t, s.x, w)
        if not failed(status) and w.settling.go_on:
            status = keep_closed(p, s, w)
        if failed(status):
            return status
        if NSLIP > 0:
            status = stop_slips(p, s, w)
            if failed(status):
                return status
        list_contacts(True, w)
        status = strike_contacts(p, s, w)
        if failed(status):
            return status
    # Contacts that fly away after the impact are no candidates of the law of forces.
    for i in range(NCON):
        w.contacts.touched[i] = 1 if w.settling.near[i] > 0 and w.settling.leaves[i] == 0 else 0
    status = decide_released(p, s, w)
    if failed(status):
        return status
    while find_rests(s, w):  # one that rests may press on others
        status = bring_to_rest(p, s, w)
        if failed(status):
            return status
    # The decision becomes the state: the modes of contacts are part of x. Bounces of a closed contact are
    # over.
    for i in range(NCON):
        if w.settling.acts[contact_block[i]] > 0:
            keep_mode(i, s, w)
    # Round-off of the speeds of closed contacts is removed; the axes of slips follow the final speeds.
    if not find_touching(s.x, w):
        return OK
    spare_blocks(w)
    list_contacts(True, w)
    status = close(p, s.t, s.x, w)
    if NTWO > 0:
        s.normal_signs[:] = w.contacts.normal_signs
    if NSPACE > 0:
        s.slips.axes[:] = w.contacts.slip_axes
        turn_slips(p, s, w)
    return status


def report_contacts(s: State, begins: bool, w: Work) -> bool:
    """Store what each contact did, beside what it did before at this event; return whether any did something.
    w.settling.x is the state before."""
    # Impulses and rest tell more than a change of modes. At the beginning of a trajectory a contact that
    # touches is no event.
    found = False
    for i in range(NCON):
        before = w.settling.x[NX - NCON + i]
        now = s.x[NX - NCON + i]
        kind = 0
        if w.settling.rests[i] > 0:
            kind = RESTS
        elif w.settling.struck[i] > 0.0:
            kind = STRIKES
        elif before != now and not begins:
            kind = CLOSES if before == 0.0 else OPENS
            if before != 0.0 and now != 0.0:
                kind = STICKS if now == 2.0 else SLIPS
        if kind > 0:
            found = True
        # An event may settle several times (a clause acts, then contacts again). Impulses and losses add up;
        # a later round without an act keeps the kind of the earlier one.
        if w.settling.has_acted:
            w.settling.struck[i] += s.contact_impulses[i]
            w.settling.lost[i] += s.contact_losses[i]
            if kind == 0 or (kind != RESTS and w.settling.struck[i] > 0.0):
                kind = s.contact_kinds[i] if kind == 0 else STRIKES
        s.contact_kinds[i] = kind
        s.contact_impulses[i] = w.settling.struck[i]
        # The impulse is a state that a model reads. Ever softer impacts end with one that is not felt.
        if NIMPULSE > 0:
            if impulse_state[i] >= 0 and (w.settling.struck[i] > 0.0 or kind == RESTS):
                s.x[impulse_state[i]] = 0.0 if kind == RESTS else w.settling.struck[i]  # ever softer impacts
        s.contact_losses[i] = w.settling.lost[i]
    w.settling.has_acted = True
    return found


def settle(p: Params, s: State, begins: bool, w: Work) -> Status:
    """Do what contacts do at (s.t, s.x), with the hits w.settling.hit, and report it in *s. The work integral
    gains the change of the energy. A failure ends the run: s.x is as before, and the
    records of bounces are not."""
    w.settling.x[:] = s.x
    # Impacts change the energy at once: the work integral takes the change, so that the energy balance still
    # closes.
    if NZ > 0:
        fn_energies(p, s.t, s.x, w.settling.energies)
        before = w.settling.energies[2]
    status = settle_states(p, s, w)
    if failed(status):
        # After a failure the caller sees the state before the event.
        s.x[:] = w.settling.x
        return status
    enlarge_sizes(s.x, s.sizes)
    widen_ranges(s.x, s.lowest, s.highest)
    if NZ > 0:
        fn_energies(p, s.t, s.x, w.settling.energies)
        s.x[NINT - 1] += w.settling.energies[2] - before
    if report_contacts(s, begins, w):
        s.settlements += 1
        s.changes += 1
        s.after_event = True
    return OK


def settle_jump(p: Params, s: State, w: Work) -> Status:
    """Let contacts act at (s.t, s.x) after a jump, as at a start. Returns PENETRATION, with the contact and
    its depth, if it is beyond its bound; s.x is as before then."""
    set_gaps(p, s.t, s.x, w)
    # Gaps are compared with round-off of states of their largest sizes so far, as a jump may have put them at
    # zero.
    for i in range(NQ + NV):
        w.search.x_part_middle[i] = reach_of(i, s)
    estimate_indicator_roundoff(p, s, w.search.x_part_middle, w)
    w.settling.go_on = False
    for i in range(NCON):
        least = (0.5 * MOST_PENETRATION / SPACING + SLACK_GROWTH) * w.events.roundoff[NFREE - NCON + i]
        if w.contacts.gaps[i] < -least and contact_bounds_rate[i] == 0:
            w.culprit = i
            s.penetration = -w.contacts.gaps[i]
            return PENETRATION
        w.settling.hit[i] = PARTS if w.contacts.gaps[i] > least and contact_bounds_rate[i] == 0 else 0
        s.bounce_speeds[i] = 0.0
    return settle(p, s, False, w)


def bounds_jump(p: Params, s: State, w: Work) -> bool:
    """Return whether a gap, or the rate of one that is closed, differs between the modes of relations
    w.settling.modes_before and w.modes."""
    fn_indicators_on(p, s.t, s.x, w.settling.modes_before, w.events.indicators)
    set_gaps(p, s.t, s.x, w)
    estimate_indicator_roundoff(p, s, s.x, w)
    for i in range(NCON):
        change = fabs(w.contacts.gaps[i] - w.events.indicators[NMODE - NCON + i])
        if change > SLACK_GROWTH * w.events.roundoff[NFREE - NCON + i]:
            return True
    if find_touching(s.x, w):
        fn_contact_rows_on(p, s.t, s.x, w.modes, w.contacts.rows, w.contacts.speeds, w.contacts.bias)
        for i in range(NCON):
            row = contact_first[i]
            if w.contacts.touched[i] > 0 and fabs(w.contacts.speeds[row]) > CONTACT_ROUNDOFF * speed_size(
                row, s, w
            ):
                return True
    return False
