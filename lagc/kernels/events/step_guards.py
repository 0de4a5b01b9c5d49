"""Step guards: reject steps over a narrow feature, or over a divisor that comes near zero.

A feature is a term that may be negligible at both ends of a step and large within it, such as a short
pulse. Features and divisors are enclosed over parts of the dense output (R. E. Moore, Interval Analysis,
1966).
"""

from math import fabs, inf

from lagc.kernels.events.location import (
    LONGEST_PART,
    NARROWEST_PART,
    NO_EVENT,
    SHORTEST_PART,
    enclose_dense_output,
    enclose_step,
    is_known,
    trial_dense_output,
)
from lagc.kernels.integrators.dispatch import method_dense_at
from lagc.kernels.language.vocabulary import *

VISIBLE_CHANGE = 0.1  # of a feature, in its own scale
STEEP_SHARE = 0.9  # of the change of a feature over a step
NEAR_ZERO_SHARE = 0.0625  # of a divisor at the ends of a step
# Length of a part of a step up to which values at three points bound a smooth divisor.
INTERPOLATED_PART = 0.0625
# Number of shorter parts in a step: about four for each halving down to the narrowest.
MOST_HIDDEN_PARTS = 256
ZERO_SHARE = 1e-8  # of a divisor at the other end: so near to zero the rates show its effect


def enclose_features(p: Params, w: Work) -> None:
    """Compute w.feature_bounds in w.box."""
    if NMODE > 0:
        fn_feature_bounds_on(p, w.modes, w.box, w.feature_bounds)
    else:
        fn_feature_bounds(p, w.box, w.feature_bounds)


def features_at(p: Params, t: Real, x: Vec[NX], values: Vec[NFEAT], w: Work) -> None:
    """Compute the features at (t, x)."""
    if NMODE > 0:
        fn_features_on(p, t, x, w.modes, values)
    else:
        fn_features(p, t, x, values)


def find_steep_quarter(p: Params, s: State, method: int, a: Trial, w: Work) -> Real:
    """Return the beginning of the quarter of the step in which a feature makes nearly all of its change from
    w.feature_low to w.feature_high, or NO_EVENT."""
    for k in range(NFEAT):
        w.feature_bounds[k] = w.feature_low[k]
    for quarter in range(4):
        right = 0.25 * float(quarter + 1)
        method_dense_at(method, right, s, w.x_part_middle)
        features_at(p, s.t + right * a.h, w.x_part_middle, w.feature_values, w)
        for k in range(NFEAT):
            change = fabs(w.feature_high[k] - w.feature_low[k])
            if (
                change > VISIBLE_CHANGE
                and fabs(w.feature_values[k] - w.feature_bounds[k]) > STEEP_SHARE * change
            ):
                return right - 0.25
        for k in range(NFEAT):
            w.feature_bounds[k] = w.feature_values[k]
    return NO_EVENT


def features_differ(w: Work) -> bool:
    """Return whether a feature changes visibly from w.feature_low to w.feature_high."""
    for k in range(NFEAT):
        if fabs(w.feature_high[k] - w.feature_low[k]) > VISIBLE_CHANGE:
            return True
    return False


def set_feature_limits(rtol: Real, w: Work) -> None:
    """Set w.feature_low and w.feature_high, the values at both ends of the step, to the range that these
    show, which is half as much wider."""
    for k in range(NFEAT):
        one = w.feature_low[k]
        other = w.feature_high[k]
        more = 0.5 * (fabs(one) + fabs(other)) + rtol
        w.feature_low[k] = (one if one < other else other) - more
        w.feature_high[k] = (one if one > other else other) + more


def enclose_divisors(p: Params, w: Work) -> None:
    """Compute w.divisor_bounds in w.box."""
    if NMODE > 0:
        fn_pole_bounds_on(p, w.modes, w.box, w.divisor_bounds)
    else:
        fn_pole_bounds(p, w.box, w.divisor_bounds)


def divisors_at(p: Params, t: Real, x: Vec[NX], values: Vec[NPOLE], w: Work) -> None:
    """Compute the divisors at (t, x)."""
    if NMODE > 0:
        fn_poles_on(p, t, x, w.modes, values)
    else:
        fn_poles(p, t, x, values)


def distance_from_zero(k: int, w: Work) -> Real:
    """Return the least distance of a divisor from zero within its bounds; negative if they contain zero."""
    return w.divisor_bounds[2 * k] if w.divisor_bounds[2 * k] > 0.0 else -w.divisor_bounds[2 * k + 1]


def set_divisor_limits(p: Params, s: State, a: Trial, w: Work) -> None:
    """Set w.guards_divisors if a divisor may come much nearer to zero in w.box than elsewhere there, and
    w.divisor_limits by the values at both ends of the step."""
    enclose_divisors(p, w)
    w.guards_divisors = False
    for k in range(NPOLE):
        most = fabs(w.divisor_bounds[2 * k])
        if fabs(w.divisor_bounds[2 * k + 1]) > most:
            most = fabs(w.divisor_bounds[2 * k + 1])
        if not distance_from_zero(k, w) >= NEAR_ZERO_SHARE * most:
            w.guards_divisors = True
    if not w.guards_divisors:
        return
    divisors_at(p, s.t, s.x, w.divisor_begin, w)
    divisors_at(p, a.t_new, s.x_new, w.divisor_end, w)
    for k in range(NPOLE):
        least = fabs(w.divisor_begin[k])
        most = fabs(w.divisor_end[k])
        if most < least:
            least = fabs(w.divisor_end[k])
            most = fabs(w.divisor_begin[k])
        w.divisor_limits[k] = NEAR_ZERO_SHARE * least if least > ZERO_SHARE * most else -inf


def divisors_stay_clear(p: Params, w: Work) -> bool:
    """Return whether all divisors stay beyond their limits in w.box."""
    enclose_divisors(p, w)
    for k in range(NPOLE):
        if not distance_from_zero(k, w) >= w.divisor_limits[k]:
            return False
    return True


def divisors_interpolate_clear(p: Params, t: Real, h: Real, left: Real, right: Real, w: Work) -> bool:
    """Return the same for a part of a step by the values at its ends and middle. A divisor may hardly
    change while the terms that it is the difference of change much, so that their enclosure is too wide."""
    divisors_at(p, t + left * h, w.x_part_begin, w.divisor_begin, w)
    divisors_at(p, t + 0.5 * (left + right) * h, w.x_part_middle, w.divisor_middle, w)
    divisors_at(p, t + right * h, w.x_part_end, w.divisor_end, w)
    for k in range(NPOLE):
        low = w.divisor_begin[k] if w.divisor_begin[k] < w.divisor_end[k] else w.divisor_end[k]
        high = w.divisor_end[k] if w.divisor_begin[k] < w.divisor_end[k] else w.divisor_begin[k]
        more = 0.25 * fabs(w.divisor_begin[k] - 2.0 * w.divisor_middle[k] + w.divisor_end[k])
        w.divisor_bounds[2 * k] = (low if low < w.divisor_middle[k] else w.divisor_middle[k]) - more
        w.divisor_bounds[2 * k + 1] = (high if high > w.divisor_middle[k] else w.divisor_middle[k]) + more
        if not distance_from_zero(k, w) >= w.divisor_limits[k]:
            return False
    return True


def features_stay_visible(p: Params, w: Work) -> bool:
    """Return whether all features stay in their ranges in w.box."""
    enclose_features(p, w)
    for k in range(NFEAT):
        low = w.feature_bounds[2 * k]
        high = w.feature_bounds[2 * k + 1]
        if not (is_known(low, high) and low >= w.feature_low[k] and high <= w.feature_high[k]):
            return False
    return True


def hides_nothing(p: Params, t: Real, h: Real, left: Real, right: Real, w: Work) -> bool:
    """Return whether the ends of the step show all of this part, enclosed in w.box."""
    if NFEAT > 0:
        if not features_stay_visible(p, w):
            return False
    if NPOLE > 0:
        if w.guards_divisors and not divisors_stay_clear(p, w):
            return right - left <= INTERPOLATED_PART and divisors_interpolate_clear(p, t, h, left, right, w)
    return True


def exceeds_limits(p: Params, t: Real, x: Vec[NX], w: Work) -> bool:
    """Return whether a feature or divisor at (t, x) is outside of its range."""
    if NFEAT > 0:
        features_at(p, t, x, w.feature_values, w)
        for k in range(NFEAT):
            if not (w.feature_values[k] >= w.feature_low[k] and w.feature_values[k] <= w.feature_high[k]):
                return True
    if NPOLE > 0:
        if w.guards_divisors:
            divisors_at(p, t, x, w.divisor_middle, w)
            for k in range(NPOLE):
                if not fabs(w.divisor_middle[k]) >= w.divisor_limits[k]:
                    return True
    return False


def first_hidden_part(p: Params, s: State, method: int, a: Trial, w: Work) -> Real:
    """Return the part of a step after which its ends do not show all, or NO_EVENT. After many short parts
    the values in their middles decide, as enclosures are too wide then."""
    unseen = 0
    left = 0.0
    width = LONGEST_PART
    w.x_part_begin[:] = s.x
    while left < 1.0:
        # A part that may hide something is halved; one that does not makes the next one longer.
        right = left + width if left + width < 1.0 else 1.0
        enclose_dense_output(s, method, a, left, right, w)
        if hides_nothing(p, s.t, a.h, left, right, w):
            if width < LONGEST_PART:
                width *= 2.0
        elif width > SHORTEST_PART:
            width *= 0.5
            continue
        elif unseen < MOST_HIDDEN_PARTS:
            if width <= NARROWEST_PART:
                return left
            unseen += 1
            width *= 0.5
            continue
        elif exceeds_limits(p, s.t + 0.5 * (left + right) * a.h, w.x_part_middle, w):
            return left
        else:
            width = SHORTEST_PART
        left = right
        w.x_part_begin[:] = w.x_part_end
    return NO_EVENT


def first_part_near_zero(p: Params, s: State, method: int, a: Trial, w: Work) -> Real:
    """Return the part of a step after which a divisor nearly vanishes, or NO_EVENT."""
    for k in range(NPOLE):
        w.divisor_limits[k] *= ZERO_SHARE
    part = first_hidden_part(p, s, method, a, w)
    return part if part < 1.0 and not divisors_stay_clear(p, w) else NO_EVENT


def find_hidden_event(p: Params, s: State, method: int, a: Trial, rtol: Real, w: Work) -> Real:
    """Return the part of the step from s.x to s.x_new after which something begins that its ends do not
    show, NO_EVENT, or a negative number if the dense output failed."""
    # Features at the ends come first, which need no enclosure. The dense output is made once, where needed.
    far = False
    if NFEAT > 0:
        features_at(p, s.t, s.x, w.feature_low, w)
        features_at(p, a.t_new, s.x_new, w.feature_high, w)
        far = features_differ(w)
        if far:
            if failed(trial_dense_output(p, s, method, a, w)):
                return -1.0
            begins = find_steep_quarter(p, s, method, a, w)
            if begins < 1.0:
                return begins
        set_feature_limits(rtol, w)
    enclose_step(s, method, a, w)
    if NPOLE > 0:
        set_divisor_limits(p, s, a, w)
    if hides_nothing(p, s.t, a.h, 0.0, 1.0, w):
        return NO_EVENT
    if not far:
        if failed(trial_dense_output(p, s, method, a, w)):
            return -1.0
    part = first_hidden_part(p, s, method, a, w)
    if NPOLE > 0:
        if part < 1.0 and w.guards_divisors:
            zero = first_part_near_zero(p, s, method, a, w)
            if zero < 1.0:
                return zero
    return part
