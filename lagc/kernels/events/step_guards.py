"""What a step may hide: terms that are nothing at both its ends, and much within it; divisors that come much
nearer to zero there."""

from __future__ import annotations

from math import fabs, inf

from lagc.kernels.events.enclosing import COARSEST, NONE, dense_of_trial, enclose_step, is_known, look_at
from lagc.kernels.events.location import FINEST, THINNEST
from lagc.kernels.integrators.dispatch import method_at
from lagc.kernels.language.model import (
    fn_feature_bounds,
    fn_feature_bounds_on,
    fn_features,
    fn_features_on,
    fn_pole_bounds,
    fn_pole_bounds_on,
    fn_poles,
    fn_poles_on,
)
from lagc.kernels.language.records import State, Trial, Work
from lagc.kernels.language.sizes import NFEAT, NMODE, NPOLE, NX
from lagc.kernels.language.statuses import failed
from lagc.kernels.language.words import Params, Real, Vec

MUCH = 0.1  # in the measure of features
NEARLY_ALL = 0.9
MUCH_NEARER = 0.0625  # of what a divisor is at the ends
SMOOTH = 0.0625  # of a step: what is as short is told by three values, of divisors that do not jump
MOST_UNSEEN = 256  # parts shorter than the finest: some four for each halving on the way to the thinnest
AT_ZERO = 1e-8  # of what a divisor is at the other end: there the rates show what it does


def bound_features(p: Params, w: Work) -> None:
    """w.bounds in w.box."""
    if NMODE > 0:
        fn_feature_bounds_on(p, w.modes, w.box, w.bounds)
    else:
        fn_feature_bounds(p, w.box, w.bounds)


def features_at(p: Params, t: Real, x: Vec[NX], values: Vec[NFEAT], w: Work) -> None:
    if NMODE > 0:
        fn_features_on(p, t, x, w.modes, values)
    else:
        fn_features(p, t, x, values)


def steep(p: Params, s: State, method: int, a: Trial, w: Work) -> Real:
    """The part of the step after which a feature, which goes from w.floors to w.tops, goes nearly all of its
    way within a quarter; NONE."""
    for k in range(NFEAT):
        w.bounds[k] = w.floors[k]
    for quarter in range(4):
        right = 0.25 * float(quarter + 1)
        method_at(method, right, s, w.middle)
        features_at(p, s.t + right * a.h, w.middle, w.values, w)
        for k in range(NFEAT):
            way = fabs(w.tops[k] - w.floors[k])
            if way > MUCH and fabs(w.values[k] - w.bounds[k]) > NEARLY_ALL * way:
                return right - 0.25
        for k in range(NFEAT):
            w.bounds[k] = w.values[k]
    return NONE


def goes_far(w: Work) -> bool:
    for k in range(NFEAT):
        if fabs(w.tops[k] - w.floors[k]) > MUCH:
            return True
    return False


def limit_features(rtol: Real, w: Work) -> None:
    """w.floors and w.tops, the ends of a step: what is seen of each there, and half of that more."""
    for k in range(NFEAT):
        one = w.floors[k]
        other = w.tops[k]
        more = 0.5 * (fabs(one) + fabs(other)) + rtol
        w.floors[k] = (one if one < other else other) - more
        w.tops[k] = (one if one > other else other) + more


def bound_poles(p: Params, w: Work) -> None:
    """w.divisors in w.box."""
    if NMODE > 0:
        fn_pole_bounds_on(p, w.modes, w.box, w.divisors)
    else:
        fn_pole_bounds(p, w.box, w.divisors)


def poles_at(p: Params, t: Real, x: Vec[NX], values: Vec[NPOLE], w: Work) -> None:
    if NMODE > 0:
        fn_poles_on(p, t, x, w.modes, values)
    else:
        fn_poles(p, t, x, values)


def from_zero(k: int, w: Work) -> Real:
    """How far this divisor stays from it, at least; below zero where it may pass."""
    return w.divisors[2 * k] if w.divisors[2 * k] > 0.0 else -w.divisors[2 * k + 1]


def limit_poles(p: Params, s: State, a: Trial, w: Work) -> None:
    """w.clear, where a divisor may change by much in w.box."""
    bound_poles(p, w)
    w.wary = False
    for k in range(NPOLE):
        most = fabs(w.divisors[2 * k])
        if fabs(w.divisors[2 * k + 1]) > most:
            most = fabs(w.divisors[2 * k + 1])
        if not from_zero(k, w) >= MUCH_NEARER * most:
            w.wary = True
    if not w.wary:
        return
    poles_at(p, s.t, s.x, w.here, w)
    poles_at(p, a.t_new, s.y, w.there, w)
    for k in range(NPOLE):
        least = fabs(w.here[k])
        most = fabs(w.there[k])
        if most < least:
            least = fabs(w.there[k])
            most = fabs(w.here[k])
        w.clear[k] = MUCH_NEARER * least if least > AT_ZERO * most else -inf


def stays_clear(p: Params, w: Work) -> bool:
    """Whether no divisor comes nearer to zero than it is to in w.box."""
    bound_poles(p, w)
    for k in range(NPOLE):
        if not from_zero(k, w) >= w.clear[k]:
            return False
    return True


def bends_clear(p: Params, t: Real, h: Real, left: Real, right: Real, w: Work) -> bool:
    """The same of a part of a step by values at its ends and its middle, as states are enclosed there: where
    all that a divisor is the difference of moves far, it may hardly change."""
    poles_at(p, t + left * h, w.left_x, w.here, w)
    poles_at(p, t + 0.5 * (left + right) * h, w.middle, w.midway, w)
    poles_at(p, t + right * h, w.right_x, w.there, w)
    for k in range(NPOLE):
        low = w.here[k] if w.here[k] < w.there[k] else w.there[k]
        high = w.there[k] if w.here[k] < w.there[k] else w.here[k]
        more = 0.25 * fabs(w.here[k] - 2.0 * w.midway[k] + w.there[k])
        w.divisors[2 * k] = (low if low < w.midway[k] else w.midway[k]) - more
        w.divisors[2 * k + 1] = (high if high > w.midway[k] else w.midway[k]) + more
        if not from_zero(k, w) >= w.clear[k]:
            return False
    return True


def features_seen(p: Params, w: Work) -> bool:
    """Whether w.box hides nothing of them."""
    bound_features(p, w)
    for k in range(NFEAT):
        low = w.bounds[2 * k]
        high = w.bounds[2 * k + 1]
        if not (is_known(low, high) and low >= w.floors[k] and high <= w.tops[k]):
            return False
    return True


def is_seen(p: Params, t: Real, h: Real, left: Real, right: Real, w: Work) -> bool:
    """Whether w.box, of this part of a step, hides nothing."""
    if NFEAT > 0:
        if not features_seen(p, w):
            return False
    if NPOLE > 0:
        if w.wary and not stays_clear(p, w):
            return right - left <= SMOOTH and bends_clear(p, t, h, left, right, w)
    return True


def stands_out(p: Params, t: Real, x: Vec[NX], w: Work) -> bool:
    """Whether the values of a state are beyond what is to be seen."""
    if NFEAT > 0:
        features_at(p, t, x, w.values, w)
        for k in range(NFEAT):
            if not (w.values[k] >= w.floors[k] and w.values[k] <= w.tops[k]):
                return True
    if NPOLE > 0:
        if w.wary:
            poles_at(p, t, x, w.midway, w)
            for k in range(NPOLE):
                if not fabs(w.midway[k]) >= w.clear[k]:
                    return True
    return False


def first_unseen(p: Params, s: State, method: int, a: Trial, w: Work) -> Real:
    """The part of a step with dense output from which on `is_seen` does not hold; NONE.  Where that is so of
    many short parts, enclosures are too wide to tell, and states have to."""
    unseen = 0
    left = 0.0
    width = COARSEST
    w.left_x[:] = s.x
    while left < 1.0:
        right = left + width if left + width < 1.0 else 1.0
        look_at(s, method, a, left, right, w)
        if is_seen(p, s.t, a.h, left, right, w):
            if width < COARSEST:
                width *= 2.0
        elif width > FINEST:
            width *= 0.5
            continue
        elif unseen < MOST_UNSEEN:
            if width <= THINNEST:
                return left
            unseen += 1
            width *= 0.5
            continue
        elif stands_out(p, s.t + 0.5 * (left + right) * a.h, w.middle, w):
            return left
        else:
            width = FINEST
        left = right
        w.left_x[:] = w.right_x
    return NONE


def next_to_zero(p: Params, s: State, method: int, a: Trial, w: Work) -> Real:
    """The part of a step after which a divisor is next to nothing; NONE."""
    for k in range(NPOLE):
        w.clear[k] *= AT_ZERO
    part = first_unseen(p, s, method, a, w)
    return part if part < 1.0 and not stays_clear(p, w) else NONE


def first_hidden(p: Params, s: State, method: int, a: Trial, rtol: Real, w: Work) -> Real:
    """The part of the step from s.x to s.y after which something begins that its ends do not show; NONE;
    below zero where that cannot be told."""
    far = False
    if NFEAT > 0:
        features_at(p, s.t, s.x, w.floors, w)
        features_at(p, a.t_new, s.y, w.tops, w)
        far = goes_far(w)
        if far:
            if failed(dense_of_trial(p, s, method, a, w)):
                return -1.0
            begins = steep(p, s, method, a, w)
            if begins < 1.0:
                return begins
        limit_features(rtol, w)
    enclose_step(s, method, a, w)
    if NPOLE > 0:
        limit_poles(p, s, a, w)
    if is_seen(p, s.t, a.h, 0.0, 1.0, w):
        return NONE
    if not far:
        if failed(dense_of_trial(p, s, method, a, w)):
            return -1.0
    part = first_unseen(p, s, method, a, w)
    if NPOLE > 0:
        if part < 1.0 and w.wary:
            zero = next_to_zero(p, s, method, a, w)
            if zero < 1.0:
                return zero
    return part
