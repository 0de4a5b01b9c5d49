"""Error weights, and the size of the first step."""

from math import fabs, sqrt

from lagc.kernels.contact.touching import rates_at
from lagc.kernels.integrators.dispatch import beta, error_exponent
from lagc.kernels.integrators.step_size import rational_power
from lagc.kernels.language.vocabulary import *

TOO_FAR = 1e-3  # time scale over look-ahead: below it the look-ahead says nothing about the beginning
LOOK_AHEAD_REDUCTION = 1e-5  # factor from one look-ahead to the next
MIXED_SIZE = 1e-6  # of the size of its group: a projection may be all of a smaller state


def extend_groups_at_rest(s: State, h: Real, w: Work, sizes: Vec[NGROUP]) -> None:
    """Raise the sizes of scaling groups that are exactly at rest to those that they would reach over the
    longest step so far. If a motion begins with a kink, its sizes after a short step are as small as its
    errors, and no step would be accepted."""
    # The distance in this step, times the ratio of the longest step so far to it.
    longer = w.error.longest_step / fabs(h)
    for i in range(NQ + NV):
        if s.sizes[scaling_group[i]] == 0.0:
            distance = fabs(s.x_new[i] - s.x[i]) * longer
            if distance > sizes[scaling_group[i]]:
                sizes[scaling_group[i]] = distance


def size_alone(s: State, i: int, h: Real, of_group: Real, w: Work) -> Real:
    """Return the largest magnitude of state i so far, with the end of the step over h; at least what it would
    reach over the longest step so far if it was exactly zero. The least is LEAST_SIZE of the size of its
    group: the first traces of a motion that spreads would limit the steps."""
    # The largest magnitude in its own range, both ends and the new one.
    size = fabs(s.x_new[i])
    if s.highest[i] > size:
        size = s.highest[i]
    if -s.lowest[i] > size:
        size = -s.lowest[i]
    if w.error.longest_step > 0.0 and s.lowest[i] == 0.0 and s.highest[i] == 0.0:
        if w.error.longest_step > fabs(h):
            size *= w.error.longest_step / fabs(h)
    return size if size > LEAST_SIZE * of_group else LEAST_SIZE * of_group


def set_error_weights(s: State, o: Options, h: Real, w: Work) -> None:
    """Set w.error.weights for a step over h, and w.error.sizes. An error is scaled by atol + rtol * size of
    its group + round-off, w.error.rate_roundoff and w.error.coordinate_roundoff over ten steps. An angle that
    winds is scaled by its own magnitude, so that it does not weaken others. With the option `alone` the size
    is that of the state. With constraints, such a weight below MIXED_SIZE of the group is at least
    PROJECTION_ROUNDOFF of its size: a projection mixes the states."""
    # Size of each group: the largest so far, with the end of the step, and of groups at rest what they reach.
    sizes = vector(NGROUP)
    for k in range(NGROUP):
        sizes[k] = 0.0
    if w.error.longest_step > 0.0:
        extend_groups_at_rest(s, h, w, sizes)
    w.error.sizes[:] = s.sizes
    enlarge_sizes(s.x_new, w.error.sizes)
    for k in range(NGROUP):
        if w.error.sizes[k] > sizes[k]:
            sizes[k] = w.error.sizes[k]
    rtol = o.rtol
    atol = o.atol
    ten_steps = 10.0 * fabs(h)
    for i in range(NQ + NV):
        of_group = sizes[scaling_group[i]]
        size = size_alone(s, i, h, of_group, w) if o.alone else of_group
        # Group 0 has the angles.
        if scaling_group[i] == 0 and size > 1.0:
            size = fabs(s.x_new[i]) if fabs(s.x_new[i]) > 1.0 else 1.0
        weight = rtol * size
        if NC > 0:
            if o.alone and size < MIXED_SIZE * of_group and weight < PROJECTION_ROUNDOFF * of_group:
                weight = PROJECTION_ROUNDOFF * of_group
        # No error below round-off is asked for.
        weight += atol + ten_steps * (w.error.rate_roundoff[i] + w.error.coordinate_roundoff[i])
        w.error.weights[i] = weight if weight > TINY else TINY
    # The entries of a quaternion have size 1 together.
    if NQUAT > 0:
        if o.alone:
            for k in range(NQUAT):
                for i in range(quaternion[k], quaternion[k] + 4):
                    weight = (
                        atol + rtol + ten_steps * (w.error.rate_roundoff[i] + w.error.coordinate_roundoff[i])
                    )
                    w.error.weights[i] = weight


def event_time_roundoff(s: State) -> Real:
    """Return the round-off of the time of the last event. A motion that began with the event has gone on
    for that time."""
    return EVENT_TIME_ULPS * SPACING * (fabs(s.t) + s.longest_step)


def shortest_time_scale(
    p: Params, s: State, h: Real, direction: Real, sizes: Vec[NGROUP], rates: Vec[NGROUP], most: Real, w: Work
) -> Real:
    """Return the shortest time in which a scaling group changes by its own size, by its rates and their
    change over h; at most `most`, and 0 if the rates after h do not exist. Times within round-off of an
    event time do not count."""
    # Second derivatives from the rates after an Euler step over h.
    curvatures = vector(NGROUP)
    for k in range(NGROUP):
        curvatures[k] = 0.0
    if NDISC > 0:
        keep_discrete(s.x, s.x_new)
    for k in range(NINT):
        s.x_new[k] = s.x[k] + h * direction * s.k[0][k]
    s.rhs += 1
    if failed(rates_at(p, s.t + h * direction, s.x_new, s.k[1], w.lam, w)):
        return 0.0
    for k in range(NINT):
        s.x_new[k] = (s.k[1][k] - s.k[0][k]) / h
    enlarge_sizes(s.x_new, curvatures)
    # Time scales of a group: sqrt(size / curvature), size / rate, rate / curvature. The second one counts
    # where it is shorter, the third where it is longer, as the group is nearly at rest.
    best = most
    shortest = event_time_roundoff(s)
    for k in range(NGROUP):
        if not curvatures[k] > 0.0:
            continue
        scale = sqrt(sizes[k] / curvatures[k])
        if sizes[k] < scale * rates[k]:
            scale = sizes[k] / rates[k]
        if rates[k] > scale * curvatures[k]:
            scale = rates[k] / curvatures[k]
        if scale > shortest and scale < best:
            best = scale
    return best


def first_step_size(p: Params, s: State, t1: Real, direction: Real, o: Options, w: Work) -> Real:
    """Return the size of the first step: the shortest time scale of all scaling groups times a power of
    the tolerance, by the order of the method (compare HNW II.4). A group at rest gets the size that it
    reaches in that time, so that a force that sets in does not count as an error."""
    # A first guess: a hundredth of the shortest size / rate.
    largest = fabs(t1 - s.t)
    rates = vector(NGROUP)
    for k in range(NGROUP):
        rates[k] = 0.0
    guess = 0.01 * largest
    enlarge_sizes(s.k[0], rates)
    sizes = vector(NGROUP)
    for k in range(NGROUP):
        sizes[k] = s.sizes[k] if s.sizes[k] > event_time_roundoff(s) * rates[k] else 0.0
        if sizes[k] > 0.0 and 0.01 * sizes[k] < guess * rates[k]:
            guess = 0.01 * sizes[k] / rates[k]
    # The look-ahead must stay within the time scale that it finds, so it is shortened until it does.
    h = guess
    best = 0.0
    while h > 0.0:
        best = shortest_time_scale(p, s, h, direction, sizes, rates, largest, w)
        if best > TOO_FAR * h:
            break
        h *= LOOK_AHEAD_REDUCTION
    if h == 0.0:
        return guess
    # The strictest tolerance of a group.
    tolerance = 1.0
    for k in range(NGROUP):
        size = sizes[k] if sizes[k] > 0.0 else best * rates[k]
        if size > 0.0 and o.rtol + o.atol / size < tolerance:
            tolerance = o.rtol + o.atol / size
    # An error of order q over the time scale T is (h/T)^q: a hundredth of the tolerance is aimed at.
    h = best * rational_power(0.01 * tolerance, error_exponent(o.method) + 0.75 * beta(o.method))
    if h > largest:
        h = largest
    for k in range(NGROUP):
        if sizes[k] == 0.0 and h * rates[k] > s.sizes[k]:
            s.sizes[k] = h * rates[k]
    return h
