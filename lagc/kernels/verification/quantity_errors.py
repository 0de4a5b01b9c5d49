"""The errors of quantities by the difference of a run and its check, and the scales they are relative to.

The error of a method of order p is h^p times a function of the trajectory (HNW, Theorem II.3.4), so a check
with steps of 5/6 errs by (5/6)^p of the error of the run, and their difference is 1 - (5/6)^p of it.  Both
round independently: round-off is part of their difference, but for that of accelerations that stay the same.
"""

from math import fabs, inf

from lagc.kernels.contact.touching import rates_at
from lagc.kernels.integrators.dispatch import has_series
from lagc.kernels.integrators.roundoff import perturb_inputs
from lagc.kernels.language.vocabulary import *

BLOCK = 5  # steps of the run between two comparisons; the check makes one more
SAFETY = 1.2  # of the estimated error
FINE_SAFETY = 2.0  # near the finest tolerance, where the difference is one sample of round-off
FINE = by_type(2e-5, 2e-14, "2e-30")  # tolerance below which round-off is a large part of errors
FINER_SERIES = 0.1  # tolerance of the check over that of the run, for a method whose order follows from it
EARLY = 1e-3  # of the size of its group: least scale of a quantity that has hardly begun to move
SMALL = 1e-2  # of the size of its group: a state below it that misses gets an error weight of its own
HARDLY = 1e-6  # of the largest range in its group: a state that moves less may be lost in round-off
CONSTANT = 1e-9  # of its terms: range of a quantity that does not move
SURELY_MOVES = 1e-3
BY_CHANCE = 20.0  # differences of the two runs: range of a quantity that only errors move
OFFSET = by_type(2.4e-4, 1.5e-8, "1e-17")  # relative change of a state that shows the terms of outputs
WIDER = by_type(64.0, 1e3, "1e3")  # ratio of a second one, by which terms, but no round-off, change more
AT_RANDOM = 16.0  # ratio of changes that are all round-off
STEADY = 1e-6  # relative: change of an acceleration that stays the same
SEVERAL = 3.0  # factor on the round-off of rates at a few states


def state_quantities(p: Params, t: Real, x: Vec[NX], y: Vec[NQUANTITY], w: Work) -> None:
    """Set y to the coordinates, speeds, outputs and discrete variables at (t, x)."""
    for i in range(NQ + NV):
        y[i] = x[i]
    if NY > 0:
        observed = vector(NY)
        fn_observe(p, t, x, observed, w)
        for i in range(NY):
            y[NQ + NV + i] = observed[i]
    for i in range(NDISC):
        y[NQ + NV + NY + i] = x[NINT + i]


def compare_quantities(v: Verification) -> None:
    """Enlarge the ranges to the values of the run, and the differences of the two runs in the block and over
    the whole motion. Values of outputs that are not finite are left out."""
    if NZ > 0:
        gap = fabs(v.run.x[NQ + NV] - v.check.x[NQ + NV])
        if v.run.t == v.check.t and gap > v.work_error:
            v.work_error = gap
    for i in range(NQUANTITY):
        gap = fabs(v.of_run[i] - v.of_check[i])
        if not gap - gap == 0.0:
            continue
        if gap > v.near[i]:
            v.near[i] = gap
        if gap > v.apart[i]:
            v.apart[i] = gap
        if v.of_run[i] < v.low[i]:
            v.low[i] = v.of_run[i]
        if v.of_run[i] > v.high[i]:
            v.high[i] = v.of_run[i]


def count_near(v: Verification) -> None:
    """Count the differences of a block with a time that is delivered: the difference may pass zero there
    before the error does."""
    for i in range(NQUANTITY):
        if v.near[i] > v.gap[i]:
            v.gap[i] = v.near[i]


def observe_offset(p: Params, offset: Real, v: Verification) -> None:
    """Set v.of_check to the quantities at the state of the run, changed relatively by `offset`."""
    v.x[:] = v.run.x
    for i in range(NQ + NV):
        v.x[i] *= 1.0 + (offset if i % 2 == 1 else -offset)
    state_quantities(p, v.run.t, v.x, v.of_check, v.check_work)


def measure_terms(p: Params, v: Verification) -> None:
    """Enlarge the terms of the outputs to their change under a small relative change of the state: the sum of
    the magnitudes of what an output is made of, which bounds its round-off (J. Vignes, Math. Comput. Simul.
    35, 1993).  Where values are as small as these changes, measure those under a wider change
    too."""
    state_quantities(p, v.run.t, v.run.x, v.of_run, v.check_work)
    observe_offset(p, OFFSET, v)
    doubtful = 0
    for i in range(NQ + NV, NQ + NV + NY):
        term = fabs(v.of_run[i] - v.of_check[i]) / OFFSET
        if term > v.terms[i] and term < inf:
            v.terms[i] = term
        if v.of_run[i] != 0.0 and fabs(v.of_run[i]) <= AT_RANDOM * OFFSET * v.terms[i]:
            doubtful = 1
    if doubtful == 1:
        observe_offset(p, WIDER * OFFSET, v)
        for i in range(NQ + NV, NQ + NV + NY):
            change = fabs(v.of_run[i] - v.of_check[i])
            if change > v.wider_change[i]:
                v.wider_change[i] = change


def measure_roundoff(p: Params, v: Verification) -> None:
    """Enlarge the round-off of the rates of speeds to their change under perturbations of all data by a few
    units in the last place, and by that over the least pivot of the mass matrix. Note the accelerations that
    vary."""
    other = params()
    rates = vector(NX)
    t = perturb_inputs(p, v.run, v.run.steps, v.x, other)
    v.check.rhs += 2
    if failed(rates_at(p, v.run.t, v.run.x, rates, v.check_work.lam, v.check_work)):
        return
    pivot = 1.0
    if NM > 0 and NC == 0:
        pivot = v.check_work.health[0]
    if failed(rates_at(other, t, v.x, v.check_work.xdot, v.check_work.lam, v.check_work)):
        return
    for i in range(NQ, NQ + NV):
        change = fabs(v.check_work.xdot[i] - rates[i]) + SPACING / pivot * fabs(rates[i])
        if change > v.roundoff[i] and change < inf:
            v.roundoff[i] = change
        if v.rate[i] < inf and fabs(rates[i] - v.rate[i]) > STEADY * fabs(rates[i]):
            v.varies[i] = 1
        v.rate[i] = rates[i]
    # Coordinates move by what speeds of this size bring to them.
    if HAS_DISPLACE:
        speeds = vector(NV)
        moved = vector(NQ)
        for j in range(NV):
            speeds[j] = v.roundoff[NQ + j]
        fn_displace(p, v.run.t, v.run.x, speeds, moved)
        for i in range(NQ):
            if fabs(moved[i]) > v.roundoff[i]:
                v.roundoff[i] = fabs(moved[i])
    else:
        for i in range(NQ):
            v.roundoff[i] = v.roundoff[i + NQ]


def known_part(method: int) -> Real:
    """Return the difference of the two runs over the error of the run: 1 - (5/6)^order, or the part that the
    tolerance of the check leaves."""
    if NSERIES > 0:
        if has_series(method):
            return 1.0 - FINER_SERIES
    rest = 1.0
    for m in static(METHODS):
        if is_method(method, m):
            for count in range(m.ORDER):
                rest *= BLOCK / (BLOCK + 1.0)
    return 1.0 - rest


def roundoff_of(i: Size, v: Verification) -> Real:
    """Return a bound of how far round-off of the rates moves a state over the time of the run so far."""
    time = SEVERAL * (v.run.t - v.begin_time)
    if i >= NQ and i < NQ + NV:
        return time * v.roundoff[i]
    if i < NQ:
        return time * (v.run.t - v.begin_time) * v.roundoff[i]
    return 0.0


def shared_roundoff(i: Size, v: Verification) -> Real:
    """Return the part of `roundoff_of` that the difference of the runs does not show: an acceleration that
    stays the same is rounded alike in both."""
    if i < NQ and not HAS_DISPLACE:
        return roundoff_of(i, v) if v.varies[i + NQ] == 0 else 0.0
    return roundoff_of(i, v) if i >= NQ and v.varies[i] == 0 else 0.0


def scale_of(i: Size, group: Real, moved: Real, accuracy: Real, underway: bool, scales: Vec[NQUANTITY],
             v: Verification) -> Real:  # fmt: skip
    """Return the scale of a quantity: the one that is given, the range, or for a quantity that does not move
    the size of its terms. `group` is the size of the scaling group of a state, `moved` the largest range in
    it."""
    largest = fabs(v.low[i]) if fabs(v.low[i]) > fabs(v.high[i]) else fabs(v.high[i])
    # A state below its noise cannot be told from zero beside the others of its group.
    noise = (PROJECTED_NOISE if NC > 0 or NCON > 0 else LEAST_COMPARED) * group
    size = v.terms[i] if v.terms[i] > largest else largest
    if 0.1 * noise > size:
        size = 0.1 * noise
    v.size[i] = size
    v.constant[i] = 0
    scale = v.high[i] - v.low[i]
    if present(scales):
        if scales[i] > 0.0:
            return scales[i]
    if largest == 0.0 and v.apart[i] == 0.0:
        return 0.0
    if NY > 0:
        # Round-off alone: values are as small as the changes, which do not grow with those of the state.
        random = AT_RANDOM * OFFSET * v.terms[i]
        if i >= NQ + NV and i < NQ + NV + NY and largest <= random and v.wider_change[i] <= random:
            v.constant[i] = 3
            return 0.0
    by_chance = scale <= BY_CHANCE * v.apart[i] or scale <= SPACING * group
    if scale <= CONSTANT * size or (scale <= SURELY_MOVES * size and by_chance):
        scale = group if largest <= noise else size
        v.constant[i] = 1
    # The speed of a coordinate that stands: its errors count by how far they move the coordinate.
    if not HAS_DISPLACE:
        if i >= NQ and i < NQ + NV and by_chance and v.constant[i - NQ] == 1:
            stands = v.scale[i - NQ] / (v.run.t - v.begin_time)
            if stands > group:
                stands = group
            if stands > scale:
                scale = stands
                v.constant[i] = 1
    if NQUAT > 0:
        for k in range(NQUAT):
            if i >= quaternion[k] and i < quaternion[k] + 4:
                scale = 1.0
    # Round-off alone moves this state, or keeps it, beside others of its group, from the accuracy.
    roundoff = roundoff_of(i, v)
    if i < NQ + NV:
        if largest > BY_CHANCE * v.apart[i]:
            v.known[i] = 1
        elif v.known[i] == 0 and v.tolerance <= FINE and largest > roundoff:
            roundoff = largest
        if fabs(v.start[i]) <= BY_CHANCE * v.apart[i] and largest <= roundoff and group <= roundoff:
            v.constant[i] = 0
            return 0.0
    is_small = largest < SMALL * group or scale < HARDLY * moved
    if group > scale and is_small and roundoff > accuracy * scale:
        v.constant[i] = 2
        return group
    # A quantity that has hardly begun to move has no range yet.
    least = EARLY * (group if i < NQ + NV else size)
    return least if underway and scale < least else scale


def estimate_errors(scales: Vec[NQUANTITY], accuracy: Real, method: int, underway: bool,
                    v: Verification) -> Real:  # fmt: skip
    """Set errors and scales of the quantities from what was compared so far; return the largest error over
    scale, of a run that is underway as if it ended here. That of the times of jumps is relative to the time
    of the run."""
    # The difference of both runs is the part `known_part` of the error of the run. The margin is larger for
    # few steps, for events, and for tolerances near round-off.
    events: Count = 0
    if NMODE > 0:
        events = v.run.changes
    margin = SAFETY / known_part(method) * (1.0 + (1.0 + events) / (v.run.steps + 1.0))
    if v.tolerance <= FINE:
        margin *= FINE_SAFETY
    # The largest range of a state in each scaling group.
    ranges = vector(NGROUP)
    for k in range(NGROUP):
        ranges[k] = 0.0
    for i in range(NQ + NV):
        if v.high[i] - v.low[i] > ranges[scaling_group[i]]:
            ranges[scaling_group[i]] = v.high[i] - v.low[i]
    # The error of a quantity: the margin times the difference, and the round-off that both runs share.
    worst = 0.0
    v.misses_by_small = False
    for i in range(NQUANTITY):
        group = v.run.sizes[scaling_group[i]] if i < NQ + NV else 0.0
        moved = ranges[scaling_group[i]] if i < NQ + NV else 0.0
        before = v.scale[i]
        scale = scale_of(i, group, moved, accuracy, underway, scales, v)
        v.scale[i] = scale
        if scale > 2.0 * before:
            v.set_out_time = v.run.t
        gap = v.near[i] if underway and v.near[i] > v.gap[i] else v.gap[i]
        v.error[i] = margin * gap
        if i < NQ + NV + NY:
            v.error[i] += SPACING * v.size[i]
        if i < NQ + NV:
            v.error[i] += shared_roundoff(i, v)
        if scale > 0.0 and not v.error[i] <= worst * scale:
            worst = v.error[i] / scale
            v.misses_by_small = i < NQ + NV and v.size[i] < SMALL * group
    if NLEAP > 0:
        v.time_error = margin * v.time_gap
        if v.time_error > worst * v.duration:
            worst = v.time_error / v.duration
    return worst
