"""Boxes that hold time and states over a step, and over parts of its dense output."""

from __future__ import annotations

from math import fabs

from lagc.kernels.integrators.dispatch import (
    last_stage,
    method_dense_at,
    method_dense_output,
    method_stage_deviations,
)
from lagc.kernels.language.records import ABSENT, State, Trial, Work
from lagc.kernels.language.sizes import NQ, NV
from lagc.kernels.language.tolerances import UNKNOWN
from lagc.kernels.language.words import Params, Real, Status

LONGEST_PART = 0.125  # of a step: the longest part that is enclosed in one
ENCLOSURE_MARGIN = 0.25  # of what a cubic between the ends of a step keeps to
NO_EVENT = 2.0  # no part of a step: nothing changes within it


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
    method_stage_deviations(method, a.h, s, w.x_part_middle)
    for i in range(NQ + NV):
        low = s.x[i]
        high = low
        for j in range(3):
            if j == 0:
                value = s.x_new[i]
            elif j == 1:
                value = s.x[i] + a.h * s.k[0][i] / 3.0
            else:
                value = s.x_new[i] - a.h * s.k[last_stage(method)][i] / 3.0
            if value < low:
                low = value
            if value > high:
                high = value
        enclose_state(i, low, high, ENCLOSURE_MARGIN * (high - low) + fabs(a.h) * w.x_part_middle[i], w)


def enclose_part(t: Real, h: Real, left: Real, right: Real, w: Work) -> None:
    """What this part of a step keeps to: the hull of its ends and its middle, and a quarter of what these
    bend by, twice as much as a parabola asks for."""
    enclose_time(t + left * h, t + right * h, w)
    for i in range(NQ + NV):
        low = w.x_part_begin[i]
        high = low
        if w.x_part_middle[i] < low:
            low = w.x_part_middle[i]
        if w.x_part_middle[i] > high:
            high = w.x_part_middle[i]
        if w.x_part_end[i] < low:
            low = w.x_part_end[i]
        if w.x_part_end[i] > high:
            high = w.x_part_end[i]
        enclose_state(
            i, low, high, 0.25 * fabs(w.x_part_begin[i] - 2.0 * w.x_part_middle[i] + w.x_part_end[i]), w
        )


def enclose_dense_output(s: State, method: int, a: Trial, left: Real, right: Real, w: Work) -> None:
    """Enclose a part of a step with dense output: behind w.x_part_begin, which is known."""
    method_dense_at(method, right, s, w.x_part_end)
    method_dense_at(method, 0.5 * (left + right), s, w.x_part_middle)
    enclose_part(s.t, a.h, left, right, w)


def trial_dense_output(p: Params, s: State, method: int, a: Trial, w: Work) -> Status:
    """The coefficients of dense output of the step from s.x to s.x_new."""
    w.x_trial[:] = s.x_new
    status = method_dense_output(method, p, s.t, s.x, w.x_trial, a.h, s, w)
    s.x_new[:] = w.x_trial
    s.dense_place = ABSENT
    return status
