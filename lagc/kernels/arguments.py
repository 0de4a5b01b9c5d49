"""Checks of options, times and parameters of a call."""

from math import fabs, inf

from lagc.kernels.integrators.dispatch import is_carried
from lagc.kernels.language.vocabulary import *


def bad_option(o: Options) -> int:
    """Return the code of an option that is not valid, or -1."""
    if not is_carried(o.method):
        return BAD_METHOD
    if o.max_steps < 0:
        return BAD_MAX_STEPS
    if not (o.rtol >= 0.0 and o.rtol < 1.0) or (
        o.step == 0.0 and o.atol == 0.0 and o.rtol < ROUNDOFF_RESIDUAL
    ):
        return BAD_RTOL
    if not (o.atol >= 0.0 and o.atol < inf):
        return BAD_ATOL
    if not (o.step >= 0.0 and o.step < inf):
        return BAD_STEP
    for m in static(METHODS):
        if len(m.ERROR) == 0:
            if o.method == m.NUMBER and o.step == 0.0:  # a method without error estimate needs a fixed step
                return BAD_STEP
    if not (o.first_step >= 0.0 and o.first_step < inf):
        return BAD_FIRST_STEP
    return -1 if o.max_step >= 0.0 and o.max_step < inf else BAD_MAX_STEP


def bad_parameter(p: Params) -> int:
    """Return the code of a parameter, or a value computed from parameters, that is not finite or out of
    its bounds; BAD_BINDING if parameters changed since `bind`; or -1."""
    for k in range(NP):
        if not fabs(p[k]) < inf:
            return BAD_PARAMETER + k
    if NBOUNDED > 0:
        for k in range(NBOUNDED):
            value = p[bounded[k]]
            if not (value >= bounds[k][0] and value <= bounds[k][1]):
                return BAD_PARAMETER + bounded[k]
    if NLIMITS > 0:
        derived = vector(NLIMITS)
        fn_limits(p, derived)
        for k in range(NLIMITS):
            if not (derived[k] >= derived_bounds[k][0] and derived[k] <= derived_bounds[k][1]):
                return BAD_PARAMETER + NP + k
    if NPREPARED > 0:
        if not is_bound(p):
            return BAD_BINDING
    return -1


@public
def check(p: Params, o: Options, culprit: Cell[int]) -> Status:
    """Check that parameters and inputs are finite and within their bounds, and that options are valid.
    Returns OK or INVALID, with *culprit one of LAGC_BAD_..., or -1. Each argument may be NULL: it is not
    checked then."""
    found = -1
    if present(o):
        found = bad_option(o)
    if found < 0 and present(p):
        found = bad_parameter(p)
    if present(culprit):
        culprit[0] = found
    return OK if found < 0 else INVALID


def check_call(p: Params, s: State, t1: Real, o: Options) -> Status:
    """Check a call that goes to t1. Returns OK, INVALID or NOT_FINITE, with s.culprit."""
    culprit = bad_option(o)
    if culprit < 0 and not (fabs(t1) < inf and fabs(s.t) < inf and fabs(t1 - s.t) < inf):
        culprit = BAD_TIME
    if COMPLETE:
        if culprit < 0:
            culprit = bad_parameter(p)
    if culprit >= 0:
        s.culprit = culprit
        return INVALID
    s.culprit = not_finite(s.x, NX)
    return OK if s.culprit < 0 else NOT_FINITE
