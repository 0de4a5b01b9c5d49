"""Boxes that hold time and states over a step, and over parts of its dense output."""

from __future__ import annotations

from math import fabs

from lagc.kernels.integrators.dispatch import last, method_at, method_coefficients, method_strays
from lagc.kernels.language.records import NOWHERE, State, Trial, Work
from lagc.kernels.language.sizes import NQ, NV
from lagc.kernels.language.tolerances import UNKNOWN
from lagc.kernels.language.words import Params, Real, Status

COARSEST = 0.125  # of a step: the longest part that is enclosed in one
WIDER = 0.25  # of what a cubic between the ends of a step keeps to
NONE = 2.0  # no part of a step: nothing changes within it


def is_known(low: Real, high: Real) -> bool:
    """Whether these are ends that an expression keeps to."""
    return low > -UNKNOWN and high < UNKNOWN and low <= high


def enclose_time(t0: Real, t1: Real, w: Work) -> None:
    w.box[0] = t0 if t0 < t1 else t1
    w.box[NQ + NV + 1] = t1 if t0 < t1 else t0


def enclose_state(i: int, low: Real, high: Real, more: Real, w: Work) -> None:
    w.box[1 + i] = low - more
    w.box[NQ + NV + 2 + i] = high + more


def enclose_step(s: State, method: int, a: Trial, w: Work) -> None:
    """About what the step keeps to: the hull of the cubic between its ends, a quarter more, and twice what
    rates at the stages allow to be beside it."""
    enclose_time(s.t, a.t_new, w)
    method_strays(method, a.h, s, w.middle)
    for i in range(NQ + NV):
        low = s.x[i]
        high = low
        for j in range(3):
            if j == 0:
                value = s.y[i]
            elif j == 1:
                value = s.x[i] + a.h * s.k[0][i] / 3.0
            else:
                value = s.y[i] - a.h * s.k[last(method)][i] / 3.0
            if value < low:
                low = value
            if value > high:
                high = value
        enclose_state(i, low, high, WIDER * (high - low) + fabs(a.h) * w.middle[i], w)


def enclose_part(t: Real, h: Real, left: Real, right: Real, w: Work) -> None:
    """What this part of a step keeps to: the hull of its ends and its middle, and a quarter of what these
    bend by, twice as much as a parabola asks for."""
    enclose_time(t + left * h, t + right * h, w)
    for i in range(NQ + NV):
        low = w.left_x[i]
        high = low
        if w.middle[i] < low:
            low = w.middle[i]
        if w.middle[i] > high:
            high = w.middle[i]
        if w.right_x[i] < low:
            low = w.right_x[i]
        if w.right_x[i] > high:
            high = w.right_x[i]
        enclose_state(i, low, high, 0.25 * fabs(w.left_x[i] - 2.0 * w.middle[i] + w.right_x[i]), w)


def look_at(s: State, method: int, a: Trial, left: Real, right: Real, w: Work) -> None:
    """Enclose a part of a step with dense output: behind w.left_x, which is known."""
    method_at(method, right, s, w.right_x)
    method_at(method, 0.5 * (left + right), s, w.middle)
    enclose_part(s.t, a.h, left, right, w)


def dense_of_trial(p: Params, s: State, method: int, a: Trial, w: Work) -> Status:
    """The coefficients of dense output of the step from s.x to s.y."""
    w.arrived[:] = s.y
    status = method_coefficients(method, p, s.t, s.x, w.arrived, a.h, s, w)
    s.y[:] = w.arrived
    s.dense = NOWHERE
    return status
