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
    trial_dense_output,
)
from lagc.kernels.events.suspects import is_known, watch_all
from lagc.kernels.integrators.dispatch import has_series, method_dense_at
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
    """Compute w.guards.feature_bounds in w.search.box."""
    if NMODE > 0:
        fn_feature_bounds_on(p, w.modes, w.search.box, w.guards.feature_bounds)
    else:
        fn_feature_bounds(p, w.search.box, w.guards.feature_bounds)


def features_at(p: Params, t: Real, x: Vec[NX], values: Vec[NFEAT], w: Work) -> None:
    """Compute the features at (t, x)."""
    if NMODE > 0:
        fn_features_on(p, t, x, w.modes, values)
    else:
        fn_features(p, t, x, values)


def find_steep_quarter(p: Params, s: State, method: int, a: Trial, w: Work) -> Real:
    """Return the beginning of the quarter of the step in which a feature makes nearly all of its change from
    w.guards.feature_low to w.guards.feature_high, or NO_EVENT."""
    # Values at the ends of quarters of the dense output: one that makes 90 % of the visible change is where
    # the step is to end.
    for k in range(NFEAT):
        w.guards.feature_bounds[k] = w.guards.feature_low[k]
    for quarter in range(4):
        right = 0.25 * float(quarter + 1)
        method_dense_at(method, right, s, w.search.x_part_middle)
        features_at(p, s.t + right * a.h, w.search.x_part_middle, w.guards.feature_values, w)
        for k in range(NFEAT):
            change = fabs(w.guards.feature_high[k] - w.guards.feature_low[k])
            if (
                change > VISIBLE_CHANGE
                and fabs(w.guards.feature_values[k] - w.guards.feature_bounds[k]) > STEEP_SHARE * change
            ):
                return right - 0.25
        for k in range(NFEAT):
            w.guards.feature_bounds[k] = w.guards.feature_values[k]
    return NO_EVENT


def features_differ(w: Work) -> bool:
    """Return whether a feature changes visibly from w.guards.feature_low to w.guards.feature_high."""
    for k in range(NFEAT):
        if fabs(w.guards.feature_high[k] - w.guards.feature_low[k]) > VISIBLE_CHANGE:
            return True
    return False


def set_feature_limits(rtol: Real, w: Work) -> None:
    """Set w.guards.feature_low and w.guards.feature_high, the values at both ends of the step, to the range
    that these show, which is half as much wider."""
    # [low, high] is the range of both ends, wider by half of their sizes: what leaves it within the step is
    # hidden.
    for k in range(NFEAT):
        one = w.guards.feature_low[k]
        other = w.guards.feature_high[k]
        more = 0.5 * (fabs(one) + fabs(other)) + rtol
        w.guards.feature_low[k] = (one if one < other else other) - more
        w.guards.feature_high[k] = (one if one > other else other) + more


def enclose_divisors(p: Params, w: Work) -> None:
    """Compute w.guards.divisor_bounds in w.search.box."""
    if NMODE > 0:
        fn_pole_bounds_on(p, w.modes, w.search.box, w.guards.divisor_bounds)
    else:
        fn_pole_bounds(p, w.search.box, w.guards.divisor_bounds)


def divisors_at(p: Params, t: Real, x: Vec[NX], values: Vec[NPOLE], w: Work) -> None:
    """Compute the divisors at (t, x)."""
    if NMODE > 0:
        fn_poles_on(p, t, x, w.modes, values)
    else:
        fn_poles(p, t, x, values)


def distance_from_zero(k: int, w: Work) -> Real:
    """Return the least distance of a divisor from zero within its bounds; negative if they contain zero."""
    return (
        w.guards.divisor_bounds[2 * k]
        if w.guards.divisor_bounds[2 * k] > 0.0
        else -w.guards.divisor_bounds[2 * k + 1]
    )


def set_divisor_limits(p: Params, s: State, a: Trial, w: Work) -> None:
    """Set w.guards.guards_divisors if a divisor may come much nearer to zero in w.search.box than elsewhere
    there, and w.guards.divisor_limits by the values at both ends of the step."""
    # A divisor whose enclosure stays away from zero, by a share of its size, needs no guard.
    enclose_divisors(p, w)
    w.guards.guards_divisors = False
    for k in range(NPOLE):
        most = fabs(w.guards.divisor_bounds[2 * k])
        if fabs(w.guards.divisor_bounds[2 * k + 1]) > most:
            most = fabs(w.guards.divisor_bounds[2 * k + 1])
        if not distance_from_zero(k, w) >= NEAR_ZERO_SHARE * most:
            w.guards.guards_divisors = True
    if not w.guards.guards_divisors:
        return
    # Limits: a sixteenth of the smaller end value. A divisor that is almost zero at one end (1e-8 of the
    # other) shows its effect in the rates already.
    divisors_at(p, s.t, s.x, w.guards.divisor_begin, w)
    divisors_at(p, a.t_new, s.x_new, w.guards.divisor_end, w)
    for k in range(NPOLE):
        least = fabs(w.guards.divisor_begin[k])
        most = fabs(w.guards.divisor_end[k])
        if most < least:
            least = fabs(w.guards.divisor_end[k])
            most = fabs(w.guards.divisor_begin[k])
        w.guards.divisor_limits[k] = NEAR_ZERO_SHARE * least if least > ZERO_SHARE * most else -inf


def divisors_stay_clear(p: Params, w: Work) -> bool:
    """Return whether all divisors stay beyond their limits in w.search.box."""
    enclose_divisors(p, w)
    for k in range(NPOLE):
        if not distance_from_zero(k, w) >= w.guards.divisor_limits[k]:
            return False
    return True


def divisors_interpolate_clear(p: Params, t: Real, h: Real, left: Real, right: Real, w: Work) -> bool:
    """Return the same for a part of a step by the values at its ends and middle. A divisor may hardly
    change while the terms that it is the difference of change much, so that their enclosure is too wide."""
    # The parabola through three values of each divisor, with twice its excess beyond their hull.
    divisors_at(p, t + left * h, w.search.x_part_begin, w.guards.divisor_begin, w)
    divisors_at(p, t + 0.5 * (left + right) * h, w.search.x_part_middle, w.guards.divisor_middle, w)
    divisors_at(p, t + right * h, w.search.x_part_end, w.guards.divisor_end, w)
    for k in range(NPOLE):
        low = (
            w.guards.divisor_begin[k]
            if w.guards.divisor_begin[k] < w.guards.divisor_end[k]
            else w.guards.divisor_end[k]
        )
        high = (
            w.guards.divisor_end[k]
            if w.guards.divisor_begin[k] < w.guards.divisor_end[k]
            else w.guards.divisor_begin[k]
        )
        more = 0.25 * fabs(
            w.guards.divisor_begin[k] - 2.0 * w.guards.divisor_middle[k] + w.guards.divisor_end[k]
        )
        w.guards.divisor_bounds[2 * k] = (
            low if low < w.guards.divisor_middle[k] else w.guards.divisor_middle[k]
        ) - more
        w.guards.divisor_bounds[2 * k + 1] = (
            high if high > w.guards.divisor_middle[k] else w.guards.divisor_middle[k]
        ) + more
        if not distance_from_zero(k, w) >= w.guards.divisor_limits[k]:
            return False
    return True


def features_stay_visible(p: Params, w: Work) -> bool:
    """Return whether all features stay in their ranges in w.search.box."""
    enclose_features(p, w)
    for k in range(NFEAT):
        low = w.guards.feature_bounds[2 * k]
        high = w.guards.feature_bounds[2 * k + 1]
        if not (is_known(low, high) and low >= w.guards.feature_low[k] and high <= w.guards.feature_high[k]):
            return False
    return True


def hides_nothing(p: Params, t: Real, h: Real, left: Real, right: Real, w: Work) -> bool:
    """Return whether the ends of the step show all of this part, enclosed in w.search.box."""
    # Features by their enclosures; divisors by enclosures, on short parts by interpolation.
    if NFEAT > 0:
        if not features_stay_visible(p, w):
            return False
    if NPOLE > 0:
        if w.guards.guards_divisors and not divisors_stay_clear(p, w):
            return right - left <= INTERPOLATED_PART and divisors_interpolate_clear(p, t, h, left, right, w)
    return True


def exceeds_limits(p: Params, t: Real, x: Vec[NX], w: Work) -> bool:
    """Return whether a feature or divisor at (t, x) is outside of its range."""
    if NFEAT > 0:
        features_at(p, t, x, w.guards.feature_values, w)
        for k in range(NFEAT):
            if not (
                w.guards.feature_values[k] >= w.guards.feature_low[k]
                and w.guards.feature_values[k] <= w.guards.feature_high[k]
            ):
                return True
    if NPOLE > 0:
        if w.guards.guards_divisors:
            divisors_at(p, t, x, w.guards.divisor_middle, w)
            for k in range(NPOLE):
                if not fabs(w.guards.divisor_middle[k]) >= w.guards.divisor_limits[k]:
                    return True
    return False


def first_hidden_part(p: Params, s: State, method: int, a: Trial, w: Work) -> Real:
    """Return the part of a step after which its ends do not show all, or NO_EVENT. After many short parts
    the values in their middles decide, as enclosures are too wide then."""
    unseen = 0
    left = 0.0
    width = LONGEST_PART
    watch_all(w)
    w.search.x_part_begin[:] = s.x
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
        elif exceeds_limits(p, s.t + 0.5 * (left + right) * a.h, w.search.x_part_middle, w):
            return left
        else:
            width = SHORTEST_PART
        left = right
        w.search.x_part_begin[:] = w.search.x_part_end
    return NO_EVENT


def first_part_near_zero(p: Params, s: State, method: int, a: Trial, w: Work) -> Real:
    """Return the part of a step after which a divisor nearly vanishes, or NO_EVENT."""
    # Divisors that would come within 1e-8 of their limits: a singularity of the model, whose place the step
    # should approach, not step over.
    for k in range(NPOLE):
        w.guards.divisor_limits[k] *= ZERO_SHARE
    part = first_hidden_part(p, s, method, a, w)
    return part if part < 1.0 and not divisors_stay_clear(p, w) else NO_EVENT


def find_hidden_event(p: Params, s: State, method: int, a: Trial, rtol: Real, w: Work) -> Real:
    """Return the part of the step from s.x to s.x_new after which something begins that its ends do not
    show, NO_EVENT, or a negative number if the dense output failed."""
    # The step of a power series is a part of the distance to the nearest singularity of the motion
    # (`taylor.planned_size`): no divisor comes near zero within it.
    if NSERIES > 0:
        if NFEAT == 0 and has_series(method):
            return NO_EVENT
    # Features at the ends come first, which need no enclosure. The dense output is made once, where needed.
    far = False
    if NFEAT > 0:
        features_at(p, s.t, s.x, w.guards.feature_low, w)
        features_at(p, a.t_new, s.x_new, w.guards.feature_high, w)
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
        if part < 1.0 and w.guards.guards_divisors:
            zero = first_part_near_zero(p, s, method, a, w)
            if zero < 1.0:
                return zero
    return part
