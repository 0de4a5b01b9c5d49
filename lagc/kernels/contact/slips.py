"""Slips at an event: which contacts begin, end or go on to slip, and where to.

In space a contact slips along its velocity. The direction at the beginning of a step is its axis. Where the
velocity has no part along the axis, the slip stops, or it has turned and gets a new axis.
"""

from math import fabs, sqrt

from lagc.kernels.contact.law import CONTACT_SLIPS
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


def reach_of(i: int, s: State) -> Real:
    """Return the largest magnitude of a state so far."""
    return s.highest[i] if s.highest[i] > -s.lowest[i] else -s.lowest[i]


def speed_size(row: int, s: State, w: Work) -> Real:
    """Return the speed of a row that states of their sizes so far have."""
    own = w.contact_speeds[row]
    reach = 0.0
    for j in range(NV):
        entry = w.contact_rows[row * NV + j]
        own -= entry * s.x[NQ + j]
        reach += fabs(entry) * reach_of(NQ + j, s)
    return reach + fabs(own)


def slip_speed(i: int, w: Work) -> Real:
    """Return the speed at which a contact with friction slips."""
    row = contact_first[i] + 1
    if NSPACE > 0:
        if contact_slips[i] == 2:
            one = w.contact_speeds[row]
            other = w.contact_speeds[row + 1]
            return sqrt(one * one + other * other)
    return fabs(w.contact_speeds[row])


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
    given = w.contact_slides[2 * i] != 0.0 or w.contact_slides[2 * i + 1] != 0.0
    return w.contact_hit[i] == SLIDES and given


def is_passing(n: int, push: Real, rate: Real, w: Work) -> bool:
    """Return whether friction of a normal force `push` cannot stop a slip with this acceleration: a mechanism
    has no motion along the slip row, as a crank at its dead centre, and the slip passes zero there."""
    k = w.law.first[n] + 1
    return w.law.W[k * w.law.rows + k] * w.law.static_friction[n] * push <= PASSING * fabs(rate)


def pass_slips(w: Work) -> None:
    """Let listed contacts whose slip passes zero slip along its acceleration, which forces do not change."""
    largest = 0.0
    for n in range(w.law.count):
        k = w.law.first[n] + 1
        if w.law.slips[n] > 0 and w.law.W[k * w.law.rows + k] > largest:
            largest = w.law.W[k * w.law.rows + k]
    for n in range(w.law.count):
        k = w.law.first[n] + 1
        if w.law.slips[n] == 1 and w.law.moves[n] == 0 and contact_normals[w.touching[n]] > 0:
            push = 0.0
            for m in range(contact_normals[w.touching[n]]):
                push += fabs(w.normal_given[normal_first[w.touching[n]] + m])
            seen = fabs(w.law.b[k]) > CONTACT_ROUNDOFF * w.law.terms[k]
            if seen and is_passing(n, push, w.law.b[k], w):
                w.law.moves[n] = 1
                w.law.direction[2 * n] = 1.0 if w.law.b[k] > 0.0 else -1.0
                w.law.b[k] = 0.0
                for r in range(w.law.rows):
                    w.law.W[k * w.law.rows + r] = 0.0
                w.law.W[k * w.law.rows + k] = largest  # the scale of its forces


def keep_passing(w: Work) -> None:
    """Do not stop the slips of listed contacts that pass zero."""
    for n in range(w.law.count):
        i = w.touching[n]
        if contact_normals[i] > 0 and w.contact_hit[i] == STOPS:
            rate = w.law.u[w.law.first[n] + 1]
            if is_passing(n, fabs(w.law.p[w.law.first[n]]), rate, w):
                w.contact_hit[i] = 0


def find_slips(s: State, w: Work) -> None:
    """Set the listed contacts that move along their slip rows, and those whose static friction no longer
    holds, to slip."""
    if NSLIP > 0:
        for n in range(w.law.count):
            if w.law.slips[n] > 0:
                i = w.touching[n]
                speed = slip_speed(i, w)
                if speed > CONTACT_ROUNDOFF * slip_size(i, s, w):
                    w.law.moves[n] = 1
                    for k in range(w.law.slips[n]):
                        w.law.direction[2 * n + k] = w.contact_speeds[contact_first[i] + 1 + k] / speed
                elif is_pushed(i, w):
                    if w.law.slips[n] == 2 and w.law.static_friction[n] > w.law.friction[n]:
                        w.law.static_friction[n] = w.law.friction[n]  # the law finds the direction
                    else:
                        w.law.moves[n] = 1
                        for k in range(w.law.slips[n]):
                            w.law.direction[2 * n + k] = w.contact_slides[2 * i + k]


def slides_back(w: Work) -> bool:
    """Return whether a contact that was set to slip would do so against its direction; it is not set then."""
    found = False
    if NSLIP > 0:
        for n in range(w.law.count):
            i = w.touching[n]
            if w.law.slips[n] > 0 and is_pushed(i, w):
                along = 0.0
                least = 0.0
                for k in range(w.law.slips[n]):
                    r = w.law.first[n] + 1 + k
                    along += w.law.u[r] * w.contact_slides[2 * i + k]
                    least += CONTACT_ROUNDOFF * w.law.terms[r]
                if w.law.mode[n] == CONTACT_SLIPS and w.law.moves[n] > 0 and along < -least:
                    w.contact_slides[2 * i] = 0.0
                    w.contact_slides[2 * i + 1] = 0.0
                    w.law.moves[n] = 0
                    found = True
    return found


def let_slip(p: Params, s: State, w: Work) -> None:
    """Set the friction of the listed contacts that stop to bounce and go on slipping. To take the speed of a
    gap away at once is a pull; it takes away the friction that is too much afterwards."""
    if NSLIP > 0:
        set_frictions(p, s.t, s.x, w)
        for n in range(w.law.count):
            i = w.touching[n]
            first = contact_first[i]
            slips = False
            if w.law.slips[n] > 0 and w.contact_closed[i] == 0:
                speed = slip_speed(i, w)
                slips = speed > w.law.friction[n] * fabs(w.contact_speeds[first])
                for k in range(w.law.slips[n]):
                    w.law.direction[2 * n + k] = w.contact_speeds[first + 1 + k] / (speed + TINY)
            if not slips:
                w.law.friction[n] = 0.0


def push_slip(i: int, w: Work) -> None:
    """Set w.contact_slides of a contact against its friction."""
    force = 0.0
    for k in range(contact_slips[i]):
        own = w.contact_forces[contact_first[i] + 1 + k]
        force += own * own
    for k in range(contact_slips[i]):
        w.contact_slides[2 * i + k] = -w.contact_forces[contact_first[i] + 1 + k] / (sqrt(force) + TINY)


def slip_error(i: int, w: Work) -> Real:
    """Return the error of a slip in space that the speeds of a step may have."""
    found = 0.0
    for k in range(2):
        for j in range(NV):
            entry = w.contact_rows[(contact_first[i] + 1 + k) * NV + j]
            found += fabs(entry) * w.error_weights[NQ + j]
    return found


def keep_slip_errors(s: State, w: Work) -> None:
    """Keep the errors of slips in space of an accepted step."""
    for i in range(NCON):
        if contact_slips[i] == 2:
            s.slip_errors[i] = LEFT_BY_STOP * slip_error(i, w)


def turns_fast(s: State, w: Work) -> bool:
    """Return whether a slip in space falls below half of its speed in a step and turns: its direction turns
    ever faster towards a stop, and a step that passes much of that is not accurate within."""
    for i in range(NCON):
        turns = s.slip_speeds[i] > s.slip_roundoff[i]
        if contact_slips[i] == 2 and s.x[NX - NCON + i] == 1.0 and turns:
            one = w.contact_speeds[contact_first[i] + 1]
            other = w.contact_speeds[contact_first[i] + 2]
            along = w.slip_axes[2 * i] * one + w.slip_axes[2 * i + 1] * other
            aside = w.slip_axes[2 * i] * other - w.slip_axes[2 * i + 1] * one
            if along < 0.5 * s.slip_speeds[i] and fabs(aside) > ASIDE_STOP * slip_error(i, w):
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
    """Stop the contacts in w.touched whose slip has ended, and set w.contact_slides of those whose static
    friction no longer holds."""
    found = False
    for i in range(NCON):
        if w.contact_hit[i] == STOPS or w.contact_hit[i] == SLIDES:
            found = True
    if not found:
        return OK
    status = rates_at(p, s.t, s.x, w.contact_rates, w.contact_lam, w)
    s.rhs += 1
    if failed(status):
        return status
    if NTWO > 0:
        keep_passing(w)
    find_touching(s.x, w)
    for i in range(NCON):
        if NSLIP > 0:
            w.contact_slides[2 * i] = 0.0
            w.contact_slides[2 * i + 1] = 0.0
            if w.contact_hit[i] == SLIDES:
                push_slip(i, w)
        if w.contact_hit[i] == STOPS and is_stopped(i, w):
            w.contact_modes[i] = 2
    list_contacts(True, w)  # a slip that begins does so at zero
    status = close(p, s.t, s.x, w)
    for i in range(NCON):
        w.touched[i] = w.contact_near[i]
    return status


def turn_slips(p: Params, s: State, w: Work) -> None:
    """Set the directions of slips in space, s.slip_axes and w.slip_axes, at (s.t, s.x). One that is round-off
    is as before."""
    if NSPACE > 0:
        if find_touching(s.x, w):
            fn_contact_rows_on(p, s.t, s.x, w.modes, w.contact_rows, w.contact_speeds, w.contact_bias)
            for i in range(NCON):
                if contact_slips[i] == 2 and w.contact_modes[i] == 1:
                    speed = slip_speed(i, w)
                    s.slip_speeds[i] = speed
                    s.slip_roundoff[i] = CONTACT_ROUNDOFF * slip_size(i, s, w)
                    if s.slip_errors[i] > s.slip_roundoff[i]:
                        s.slip_roundoff[i] = s.slip_errors[i]
                    if speed > s.slip_roundoff[i]:
                        for k in range(2):
                            s.slip_axes[2 * i + k] = w.contact_speeds[contact_first[i] + 1 + k] / speed
        w.slip_axes[:] = s.slip_axes
        w.slip_roundoff[:] = s.slip_roundoff


def time_to_stop(p: Params, s: State, t: Real, rates: Vec[NX], w: Work) -> Real:
    """Return the time from t to the stop of a slip in space that crosses, for the end s.x_new of a step and
    its rates; 0 if none does. Where a slip turns ever faster, the dense output is less accurate than the
    step."""
    found = 0.0
    if NSPACE > 0:
        fn_indicators_on(p, t, s.x_new, w.modes, w.indicators)
        fn_indicator_rates_on(p, t, s.x_new, w.modes, rates, w.indicator_rates)
        for i in range(NCON):
            if contact_slips[i] == 2 and s.x[NX - NCON + i] == 1.0:
                if w.crossed[slip_relation(i)] > 0:
                    along = slip_along(i, w.indicators, w)
                    rate = slip_along(i, w.indicator_rates, w)
                    if fabs(along) > ALONG_STOP * slip_error(i, w) and rate != 0.0:
                        found = -along / rate
    return found
