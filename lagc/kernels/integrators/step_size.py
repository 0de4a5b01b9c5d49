"""Step size control.

E. Hairer, S. P. Norsett, G. Wanner, Solving Ordinary Differential Equations I, Springer 1993 (HNW),
sections II.4 and IV.2 (PI controller).
"""

from math import fabs, sqrt

from lagc.kernels.integrators.dispatch import beta, error_exponent, largest_growth, largest_reduction
from lagc.kernels.language.vocabulary import *


def rational_power(a: Real, exponent: Real) -> Real:
    """Return a^exponent, for an exponent below 1 that is a sum of few powers of 1/2. Square roots and
    products have the same bits on every machine."""
    # Binary digits of the exponent, largest first: a^(1/2) is one root, a^(1/4) two, and so on.
    value = 1.0
    rest = exponent
    base = a
    while rest > 0.0:
        base = sqrt(base)
        rest *= 2.0
        if rest >= 1.0:
            value *= base
            rest -= 1.0
    return value


def plan_step(s: State, t1: Real, a: Trial) -> None:
    """Set the end of an attempt of a.size. It is lengthened by up to 1 %, or shortened, to end at t1. The
    motion goes on for the time that passes, a multiple of the spacing of the time."""
    rest = fabs(t1 - s.t)
    a.ends_on_target = a.size * 1.01 >= rest
    a.t_new = t1
    if a.ends_on_target:
        a.size = rest
    else:
        a.t_new = s.t + a.size * a.direction
    a.h = a.t_new - s.t


def step_underflows(s: State, t1: Real, a: Trial) -> bool:
    """Return whether the step is within round-off of the time, or too short for the remaining time."""
    least = SPACING * fabs(s.t) + LEAST_STEP * fabs(t1 - s.t)
    return (a.rejected > 0 or not a.ends_on_target) and 0.1 * a.size <= least


def shrink_step(a: Trial, o: Options) -> None:
    """Reduce the size of the attempt after an error above 1, as the method does or by (HNW II.4.13)."""
    for m in static(METHODS):
        if m.CONTROLS > 0 and is_method(o.method, m):
            a.size = m.reduced_size(a)
            return
    # 0.9 (1 / err)^exponent, at most by the method's factor.
    most = largest_reduction(o.method)
    factor = rational_power(a.error, error_exponent(o.method)) / 0.9
    a.size /= factor if factor < most else most


def next_size(s: State, a: Trial, o: Options) -> Real:
    """Return the size of the next step, as the method has it or by the errors of this and the last step."""
    for m in static(METHODS):
        if m.CONTROLS > 0 and is_method(o.method, m):
            return m.next_size(s, a)
    most = largest_reduction(o.method)
    least = largest_growth(o.method)
    # PI controller, (HNW II.4, IV.2): err_n^exponent err_(n-1)^-beta; errors below 1e-4 do not make the
    # next step bolder.
    factor = rational_power(a.error, error_exponent(o.method))
    if beta(o.method) > 0.0:
        factor /= rational_power(s.error_old, beta(o.method))
        s.error_old = a.error if a.error > 1e-4 else 1e-4
    factor /= 0.9
    if factor > most:
        factor = most
    if factor < least:
        factor = least
    return a.size / factor


def set_next_step(s: State, a: Trial, o: Options) -> None:
    """Set the size of the next step. A step that was shortened to end at a time or an event does not shorten
    it."""
    following = next_size(s, a, o)
    # After a rejection the size does not grow (HNW II.4). A step that was cut by an event or a target leaves
    # the size that was planned for it.
    if a.rejected > 0 and following > a.size:
        following = a.size
    if NMODE > 0:
        if a.ends_at_event or a.is_split:
            tried = s.h if a.rejected == 0 else a.size_before_event
            if following < tried:
                following = tried
    if a.ends_on_target and a.rejected == 0 and following < s.h:
        following = s.h  # the step was short to end at the time
    s.h = following
