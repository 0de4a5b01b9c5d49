"""Slips at an event: which contacts begin, end or go on to slip, and where to.

In space a contact slips along its velocity. The direction at the beginning of a step is its axis. Where the
velocity has no part along the axis, the slip stops, or it has turned and gets a new axis. A slip that begins
has no direction that stages could follow, as u/|u| has none at zero: it keeps its axis for a step.
"""

from math import fabs, inf, sqrt

from lagc.kernels.contact.law import CONTACT_SLIPS
from lagc.kernels.contact.responses import respond, set_accelerations
from lagc.kernels.contact.touching import (
    close,
    find_touching,
    list_contacts,
    rates_at,
    set_frictions,
    slip_along,
    slip_relation,
)
from lagc.kernels.language.vocabulary import *

REACHES = 1  # a gap is closed
RELEASES = 2  # a force has fallen to zero
STOPS = 3  # a slip has ended
SLIDES = 4  # static friction no longer holds
PARTS = 5  # a jump has put it apart
TURNS = 6  # the normal force of a two-sided contact changes its sign
LEFT_BY_STOP = 1.0  # speed at which a slip in space ends, over the error of a step
PASSING = by_type(1e-2, 1e-5, "1e-12")  # of the acceleration of a slip: friction that cannot stop it
ALONG_STOP = 0.01  # the same along its direction
ASIDE_STOP = 0.2  # the same across it, in a step
ASIDE_START = 0.1  # speed across the axis of a slip that begins, over that along it, at the end of a step


def reach_of(i: int, s: State) -> Real:
    """Return the largest magnitude of a state so far."""
    return s.highest[i] if s.highest[i] > -s.lowest[i] else -s.lowest[i]


def speed_size(row: int, s: State, w: Work) -> Real:
    """Return the speed of a row that states of their sizes so far have."""
    own = w.contacts.speeds[row]
    reach = 0.0
    for j in range(NV):
        entry = w.contacts.rows[row * NV + j]
        own -= entry * s.x[NQ + j]
        reach += fabs(entry) * reach_of(NQ + j, s)
    return reach + fabs(own)


def slip_speed(i: int, w: Work) -> Real:
    """Return the speed at which a contact with friction slips."""
    row = contact_first[i] + 1
    if NSPACE > 0:
        if contact_slips[i] == 2:
            one = w.contacts.speeds[row]
            other = w.contacts.speeds[row + 1]
            return sqrt(one * one + other * other)
    return fabs(w.contacts.speeds[row])


def slip_size(i: int, s: State, w: Work) -> Real:
    """Return the speed that states of their sizes so far have along its slip rows."""
    size = speed_size(contact_first[i] + 1, s, w)
    if NSPACE > 0:
        if contact_slips[i] == 2:
            other = speed_size(contact_first[i] + 2, s, w)
            size = other if other > size else size
    return size


def is_pushed(i: int, w: Work) -> bool:
    """Return whether static friction no longer holds a contact, whose direction of slip is given."""
    given = w.contacts.slides[2 * i] != 0.0 or w.contacts.slides[2 * i + 1] != 0.0
    return w.settling.hit[i] == SLIDES and given


def is_passing(n: int, push: Real, rate: Real, w: Work) -> bool:
    """Return whether friction of a normal force `push` cannot stop a slip with this acceleration: a mechanism
    has no motion along the slip row, as a crank at its dead centre, and the slip passes zero there."""
    law = w.contacts.law
    k = law.first[n] + 1
    return law.W[k * law.rows + k] * law.static_friction[n] * push <= PASSING * fabs(rate)


def pass_slips(w: Work) -> None:
    """Let listed contacts whose slip passes zero slip along its acceleration, which forces do not change."""
    # The largest diagonal entry of slip rows stands for the scale that this row does not have. Forces that
    # keep each gap closed alone bound the normal forces of contacts of one side.
    law = w.contacts.law
    largest = 0.0
    bound = 0.0
    for n in range(law.count):
        k = law.first[n] + 1
        if law.slips[n] > 0 and law.W[k * law.rows + k] > largest:
            largest = law.W[k * law.rows + k]
        own = law.W[law.first[n] * law.rows + law.first[n]]
        if law.two_sided[n] == 0 and own > 0.0:
            bound += fabs(law.b[law.first[n]]) / own
    for n in range(law.count):
        k = law.first[n] + 1
        if law.slips[n] == 1 and law.moves[n] == 0:
            # The normal force of a two-sided contact adds that without contacts, |N0|_1.
            push = bound
            if NTWO > 0:
                for m in range(contact_normals[w.contacts.touching[n]]):
                    push += fabs(w.contacts.normal_given[normal_first[w.contacts.touching[n]] + m])
            seen = fabs(law.b[k]) > CONTACT_ROUNDOFF * law.terms[k]
            # The row leaves the problem: b and W of it become 0, and its friction is a given force along the
            # slip.
            if seen and is_passing(n, push, law.b[k], w):
                law.moves[n] = 1
                law.direction[2 * n] = 1.0 if law.b[k] > 0.0 else -1.0
                law.b[k] = 0.0
                for r in range(law.rows):
                    law.W[k * law.rows + r] = 0.0
                law.W[k * law.rows + k] = largest  # the scale of its forces


def keep_passing(p: Params, s: State, w: Work) -> Status:
    """Let the slips that pass zero go on: clear their stops in w.settling.hit. The rates w.contacts.rates are
    those of the contacts that touch."""
    # The acceleration of each slip is compared with what its friction adds to it.
    fn_contact_rows_on(p, s.t, s.x, w.modes, w.contacts.rows, w.contacts.speeds, w.contacts.bias)
    list_contacts(True, w)
    status = respond(p, s.t, s.x, w)
    set_accelerations(w.contacts.rates, w)
    set_frictions(p, s.t, s.x, w)
    law = w.contacts.law
    for n in range(law.count):
        i = w.contacts.touching[n]
        if law.slips[n] == 1 and w.settling.hit[i] == STOPS:
            if is_passing(n, fabs(w.contacts.forces[contact_first[i]]), law.b[law.first[n] + 1], w):
                w.settling.hit[i] = 0
    return status


def find_slips(s: State, w: Work) -> None:
    """Set the listed contacts that move along their slip rows, and those whose static friction no longer
    holds, to slip."""
    # A slip that is more than round-off has a direction: that of its velocity.
    if NSLIP > 0:
        law = w.contacts.law
        for n in range(law.count):
            if law.slips[n] > 0:
                i = w.contacts.touching[n]
                speed = slip_speed(i, w)
                if speed > CONTACT_ROUNDOFF * slip_size(i, s, w):
                    law.moves[n] = 1
                    for k in range(law.slips[n]):
                        law.direction[2 * n + k] = w.contacts.speeds[contact_first[i] + 1 + k] / speed
                # A contact that is pushed beyond static friction begins to slip. In space the law finds the
                # direction, if the force falls at the same time (static above kinetic friction); else the
                # direction is against the force that held.
                elif is_pushed(i, w):
                    if law.slips[n] == 2 and law.static_friction[n] > law.friction[n]:
                        law.static_friction[n] = law.friction[n]  # the law finds the direction
                    else:
                        law.moves[n] = 1
                        for k in range(law.slips[n]):
                            law.direction[2 * n + k] = w.contacts.slides[2 * i + k]


def slides_back(w: Work) -> bool:
    """Return whether a contact that was set to slip would do so against its direction; it is not set then."""
    found = False
    if NSLIP > 0:
        law = w.contacts.law
        for n in range(law.count):
            i = w.contacts.touching[n]
            # Acceleration along the direction in which it was set to slip; negative beyond round-off means
            # that the contact would move with its friction, not against it.
            if law.slips[n] > 0 and is_pushed(i, w):
                along = 0.0
                least = 0.0
                for k in range(law.slips[n]):
                    r = law.first[n] + 1 + k
                    along += law.u[r] * w.contacts.slides[2 * i + k]
                    least += CONTACT_ROUNDOFF * law.terms[r]
                if law.mode[n] == CONTACT_SLIPS and law.moves[n] > 0 and along < -least:
                    w.contacts.slides[2 * i] = 0.0
                    w.contacts.slides[2 * i + 1] = 0.0
                    law.moves[n] = 0
                    found = True
    return found


def let_slip(p: Params, s: State, w: Work) -> None:
    """Set the friction of the listed contacts that stop to bounce and go on slipping. To take the speed of a
    gap away at once is a pull; it takes away the friction that is too much afterwards."""
    # Coulomb's law for impulses: it slips on if its speed exceeds mu times the change of the normal speed.
    # All others lose their friction for this change.
    if NSLIP > 0:
        law = w.contacts.law
        set_frictions(p, s.t, s.x, w)
        for n in range(law.count):
            i = w.contacts.touching[n]
            first = contact_first[i]
            slips = False
            if law.slips[n] > 0 and w.settling.closed[i] == 0:
                speed = slip_speed(i, w)
                slips = speed > law.friction[n] * fabs(w.contacts.speeds[first])
                for k in range(law.slips[n]):
                    law.direction[2 * n + k] = w.contacts.speeds[first + 1 + k] / (speed + TINY)
            if not slips:
                law.friction[n] = 0.0


def push_slip(i: int, w: Work) -> None:
    """Set w.contacts.slides of a contact against its friction."""
    force = 0.0
    for k in range(contact_slips[i]):
        own = w.contacts.forces[contact_first[i] + 1 + k]
        force += own * own
    for k in range(contact_slips[i]):
        w.contacts.slides[2 * i + k] = -w.contacts.forces[contact_first[i] + 1 + k] / (sqrt(force) + TINY)


def slip_error(i: int, w: Work) -> Real:
    """Return the error of a slip in space that the speeds of a step may have."""
    found = 0.0
    for k in range(2):
        for j in range(NV):
            entry = w.contacts.rows[(contact_first[i] + 1 + k) * NV + j]
            found += fabs(entry) * w.error.weights[NQ + j]
    return found


def keep_slip_errors(s: State, w: Work) -> None:
    """Keep the errors of slips in space of an accepted step."""
    for i in range(NCON):
        if contact_slips[i] == 2:
            s.slips.begins[i] = 0
            s.slips.errors[i] = LEFT_BY_STOP * slip_error(i, w)


def turns_fast(s: State, w: Work) -> bool:
    """Return whether a slip in space falls below half of its speed in a step and turns: its direction turns
    ever faster towards a stop, and a step that passes much of that is not accurate within. Or a slip that has
    begun leaves the axis that it keeps by more than the error of the step, or has turned."""
    # The change of direction between the ends of the step: `aside` is the velocity across the axis at the
    # beginning.
    for i in range(NCON):
        begins = not w.contacts.slip_roundoff[i] < inf
        turns = begins or s.slips.speeds[i] > s.slips.roundoff[i]
        if contact_slips[i] == 2 and s.x[NX - NCON + i] == 1.0 and turns:
            one = w.contacts.speeds[contact_first[i] + 1]
            other = w.contacts.speeds[contact_first[i] + 2]
            along = w.contacts.slip_axes[2 * i] * one + w.contacts.slip_axes[2 * i + 1] * other
            aside = w.contacts.slip_axes[2 * i] * other - w.contacts.slip_axes[2 * i + 1] * one
            if begins and fabs(aside) > ASIDE_START * along:
                return True
            slows = begins or along < 0.5 * s.slips.speeds[i]
            if slows and fabs(aside) > ASIDE_STOP * slip_error(i, w):
                return True
    return False


def is_stopped(i: int, w: Work) -> bool:
    """Return whether a slip has ended whose part along its direction is zero. In space it may have turned
    instead: it ends if the rest is an error that the step may make."""
    if NSPACE > 0:
        if contact_slips[i] == 2:
            return slip_speed(i, w) <= LEFT_BY_STOP * slip_error(i, w)
    return True


def stop_slips(p: Params, s: State, w: Work) -> Status:
    """Stop the contacts in w.contacts.touched whose slip has ended, and set w.contacts.slides of those whose
    static friction no longer holds."""
    # Nothing has stopped or been pushed: no evaluation is needed.
    found = False
    for i in range(NCON):
        if w.settling.hit[i] == STOPS or w.settling.hit[i] == SLIDES:
            found = True
    if not found:
        return OK
    # Forces at the event tell the direction of the push, and whether friction can stop the slip.
    status = rates_at(p, s.t, s.x, w.contacts.rates, w.contacts.lam, w)
    s.rhs += 1
    if failed(status):
        return status
    find_touching(s.x, w)
    status = keep_passing(p, s, w)
    if failed(status):
        return status
    for i in range(NCON):
        # Each slip that was pushed begins against its static friction.
        if NSLIP > 0:
            w.contacts.slides[2 * i] = 0.0
            w.contacts.slides[2 * i + 1] = 0.0
            if w.settling.hit[i] == SLIDES:
                push_slip(i, w)
        # A slip that has ended sticks: its speed across the axis, which is an error, is removed below with
        # the gap rates.
        if w.settling.hit[i] == STOPS and is_stopped(i, w):
            w.contacts.modes[i] = 2
    list_contacts(True, w)  # a slip that begins does so at zero
    status = close(p, s.t, s.x, w)
    for i in range(NCON):
        w.contacts.touched[i] = w.settling.near[i]
    return status


def turn_slips(p: Params, s: State, w: Work) -> None:
    """Set the directions of slips in space, s.slips.axes and w.contacts.slip_axes, at (s.t, s.x). One that is
    round-off is as before."""
    if NSPACE > 0:
        # The axis of the next step is the direction of the velocity now. A velocity below its round-off, or
        # below the error that the last step may have made, has no direction: the axis stays.
        if find_touching(s.x, w):
            fn_contact_rows_on(p, s.t, s.x, w.modes, w.contacts.rows, w.contacts.speeds, w.contacts.bias)
            for i in range(NCON):
                if contact_slips[i] == 2 and w.contacts.modes[i] == 1:
                    speed = slip_speed(i, w)
                    s.slips.speeds[i] = speed
                    s.slips.roundoff[i] = CONTACT_ROUNDOFF * slip_size(i, s, w)
                    if s.slips.errors[i] > s.slips.roundoff[i]:
                        s.slips.roundoff[i] = s.slips.errors[i]
                    if speed > s.slips.roundoff[i]:
                        for k in range(2):
                            s.slips.axes[2 * i + k] = w.contacts.speeds[contact_first[i] + 1 + k] / speed
        w.contacts.slip_axes[:] = s.slips.axes
        w.contacts.slip_roundoff[:] = s.slips.roundoff
        for i in range(NCON):
            if contact_slips[i] == 2 and w.contacts.modes[i] == 1:
                least = CONTACT_ROUNDOFF * slip_size(i, s, w) if s.slips.begins[i] > 0 else 0.0
                if slip_speed(i, w) <= least:
                    w.contacts.slip_roundoff[i] = inf


def time_to_stop(p: Params, s: State, t: Real, rates: Vec[NX], w: Work) -> Real:
    """Return the time from t to the stop of a slip in space that crosses, for the end s.x_new of a step and
    its rates; 0 if none does. Where a slip turns ever faster, the dense output is less accurate than the
    step."""
    found = 0.0
    # Newton's step of the event time on the speed along the axis, at the end of the step.
    if NSPACE > 0:
        fn_indicators_on(p, t, s.x_new, w.modes, w.events.indicators)
        fn_indicator_rates_on(p, t, s.x_new, w.modes, rates, w.events.rates)
        for i in range(NCON):
            if contact_slips[i] == 2 and s.x[NX - NCON + i] == 1.0:
                if w.events.crossed[slip_relation(i)] > 0:
                    along = slip_along(i, w.events.indicators, w)
                    rate = slip_along(i, w.events.rates, w)
                    if fabs(along) > ALONG_STOP * slip_error(i, w) and rate != 0.0:
                        found = -along / rate
    return found
