"""Indicators that accelerations and reactions decide, as of `reaction(rope) < 0`.

They are known where the equations of motion are solved: each value costs an evaluation of the rates. They
are sampled, and their rates are difference quotients.
"""

from math import fabs

from lagc.kernels.contact.touching import rates_at
from lagc.kernels.events.sampled_indicators import add_sample, enclose_samples, forget_samples
from lagc.kernels.integrators.dispatch import end_rate_row
from lagc.kernels.language.vocabulary import *

LATE_DIFFERENCE = 0.0009765625  # of the last step: time over which a difference quotient is taken
STEP_SAMPLES = 4  # parts of a step between its samples


def late_relation(j: Size) -> int:
    """Return the relation of a late indicator."""
    return NMODE - NCON - NSLIP - NLATE + j


def late_at(p: Params, t: Real, x: Vec[NX], s: State, w: Work) -> bool:
    """Compute w.late.values, the late indicators at (t, x), and w.late.modes, the modes that they give.
    Return whether the equations of motion have a solution there."""
    s.rhs += 1
    if failed(rates_at(p, t, x, w.late.rates, w.late.lam, w)):
        return False
    # Accelerations, multipliers and forces of contacts, in the order in which `fn_late_on` reads them.
    w.late.known[:NV] = part(w.late.rates, NQ, NQ + NV)
    for i in range(NC):
        w.late.known[NV + i] = w.late.lam[i]
    if NCON > 0:
        for i in range(NCROW):
            w.late.known[NV + NC + i] = w.contacts.forces[i]
    fn_late_on(p, t, x, w.modes, w.late.known, w.late.values, w.late.modes)
    return True


def indicators_at(
    p: Params, t: Real, x: Vec[NX], modes: Vec[NMODE], found: Vec[NMODE], s: State, w: Work
) -> None:
    """Compute the event indicators at (t, x) in w.modes; a late one is 0 where it has no value."""
    fn_indicators_on(p, t, x, modes, found)
    if not NLATE > 0:
        return
    known = late_at(p, t, x, s, w)
    for j in range(NLATE):
        found[late_relation(j)] = w.late.values[j] if known else 0.0


def indicator_rates_at(
    p: Params, t: Real, x: Vec[NX], modes: Vec[NMODE], rates: Vec[NX], found: Vec[NMODE], s: State, w: Work
) -> None:
    """Compute the rates of the event indicators for the rates of the state, at (t, x) in w.modes. That of a
    late one is 0 before the first step, and where it has no value."""
    fn_indicator_rates_on(p, t, x, modes, rates, found)
    if not NLATE > 0:
        return
    # A difference quotient backwards in time along the motion: the state before is x - time x'. Forwards it
    # might reach beyond the crossing.
    time = LATE_DIFFERENCE * s.h_old
    known = time != 0.0 and late_at(p, t, x, s, w)
    if known:
        w.late.here[:] = w.late.values
        w.late.x[:] = x
        for i in range(NINT):
            w.late.x[i] -= time * rates[i]
        known = late_at(p, t - time, w.late.x, s, w)
    for j in range(NLATE):
        found[late_relation(j)] = (w.late.here[j] - w.late.values[j]) / time if known else 0.0


def adopt_late_modes(w: Work) -> None:
    """Set w.events.candidate_modes of late indicators to the modes that their last values give."""
    for j in range(NLATE):
        w.events.candidate_modes[late_relation(j)] = w.late.modes[j]


def set_late_modes(p: Params, t: Real, x: Vec[NX], s: State, w: Work) -> None:
    """Set w.modes of late indicators by their values at (t, x). Repeat, since modes change others."""
    for turn in range(NLATE):
        done = True
        if late_at(p, t, x, s, w):
            for j in range(NLATE):
                if w.modes[late_relation(j)] != w.late.modes[j]:
                    w.modes[late_relation(j)] = w.late.modes[j]
                    done = False
        if done:
            break


def forget_late_range(w: Work) -> None:
    """Begin the ranges of late indicators anew."""
    forget_samples(late_relation(0), late_relation(NLATE), w)


def add_late_range(p: Params, t: Real, x: Vec[NX], s: State, w: Work) -> None:
    """Add the late indicators at (t, x) to their ranges."""
    known = late_at(p, t, x, s, w)
    for j in range(NLATE):
        add_sample(late_relation(j), w.late.values[j] if known else -UNKNOWN, w)
        add_sample(late_relation(j), w.late.values[j] if known else UNKNOWN, w)


def sample_late_step(p: Params, s: State, method: int, a: Trial, w: Work) -> None:
    """Set the ranges of late indicators to those of the cubic through both ends of the step from s.x to
    s.x_new, (HNW II.6.7)."""
    forget_late_range(w)
    # Five points of the cubic Hermite interpolant.
    for k in range(STEP_SAMPLES + 1):
        part_of = float(k) / float(STEP_SAMPLES)
        w.late.x[:] = s.x
        for i in range(NINT):
            apart = s.x_new[i] - s.x[i]
            correction = (1.0 - 2.0 * part_of) * apart
            correction += a.h * ((part_of - 1.0) * s.k[0][i] + part_of * s.k[end_rate_row(method)][i])
            w.late.x[i] += part_of * apart + part_of * (part_of - 1.0) * correction
        add_late_range(p, s.t + part_of * a.h, w.late.x, s, w)


def enclose_late(w: Work) -> None:
    """Set w.events.enclosures of late indicators to their ranges."""
    for j in range(NLATE):
        enclose_samples(late_relation(j), w)


def estimate_late_roundoff(p: Params, s: State, reach: Vec[NX], w: Work) -> None:
    """Compute w.events.roundoff of late indicators: their largest change where all states, and where every
    other one, change by one unit in the last place of their size or `reach`."""
    known = late_at(p, s.t, s.x, s, w)
    w.late.here[:] = w.late.values
    for j in range(NLATE):
        w.events.roundoff[late_relation(j) - NTIMED] = SPACING * fabs(w.late.here[j]) if known else 0.0
    # All states up, then every other one: sums and differences both show their round-off.
    for turn in range(2):
        w.late.x[:] = s.x
        for i in range(NQ + NV):
            size = fabs(s.x[i]) if fabs(s.x[i]) > fabs(reach[i]) else fabs(reach[i])
            if turn == 0 or i % 2 == 0:
                w.late.x[i] += SPACING * size
        known = known and late_at(p, s.t, w.late.x, s, w)
        for j in range(NLATE):
            change = fabs(w.late.values[j] - w.late.here[j])
            if known and change > w.events.roundoff[late_relation(j) - NTIMED]:
                w.events.roundoff[late_relation(j) - NTIMED] = change


def late_span(k: int, distance: Real, w: Work) -> Real:
    """Return how far relation k moved over the samples of the last part of a step if it is late, else
    `distance`."""
    late = k >= late_relation(0) and k < late_relation(NLATE)
    return w.events.sampled_high[k] - w.events.sampled_low[k] if late else distance
