"""Dispatch: the functions and coefficients of a method by its number."""

from lagc.kernels.language.vocabulary import *


def is_carried(method: int) -> bool:
    """Return whether this library has a method of this number."""
    for m in static(METHODS):
        if method == m.NUMBER:
            return True
    return False


def method_stages(method: int, p: Params, t: Real, x: Vec[NX], h: Real, s: State, w: Work) -> Status:
    """Compute the stages of a step from (t, x), and its end in s.x_new; count the evaluations. A failure
    leads to a shorter step."""
    for m in static(METHODS):
        if is_method(method, m):
            return m.stages(p, t, x, h, s, w)
    return OK


def method_error(method: int, h: Real, s: State, w: Work) -> Real:
    """Return the scaled error of a step."""
    for m in static(METHODS):
        if is_method(method, m):
            return m.error(h, s, w)
    return 0.0


def method_add_stability(method: int, s: State, w: Work) -> None:
    """Add the differences that tell whether stability limits the step, if the method has them."""
    for m in static(METHODS):
        if len(m.STABILITY) > 0 and is_method(method, m):
            m.add_stability(s, w)


def has_two_estimates(method: int) -> bool:
    """Return whether the error combines two estimates."""
    for m in static(METHODS):
        if len(m.ERROR) == 2 and is_method(method, m):
            return True
    return False


def method_error_parts(method: int, s: State, w: Work) -> None:
    """Compute these estimates in w.error.parts."""
    for m in static(METHODS):
        if len(m.ERROR) == 2 and is_method(method, m):
            m.error_parts(s, w)


def method_stage_deviation(method: int, i: int, h: Real, s: State) -> Real:
    """Return the largest deviation of the rate of a state at the stages from the cubic through both ends."""
    for m in static(METHODS):
        if is_method(method, m):
            return m.stage_deviation(i, h, s)
    return 0.0


def method_dense_output(method: int, p: Params, t: Real, x: Vec[NX], z: Vec[NX], h: Real, s: State,
                        w: Work) -> Status:  # fmt: skip
    """Compute the coefficients of the dense output of the step from x to z."""
    for m in static(METHODS):
        if is_method(method, m):
            if len(m.EXTRA_C) > 0:
                s.rhs += len(m.EXTRA_C)
            return m.dense_output(p, t, x, z, h, s, w)
    return OK


def method_dense_at(method: int, part: Real, s: State, x: Vec[NX]) -> None:
    """Evaluate the dense output at a part of the step."""
    for m in static(METHODS):
        if is_method(method, m):
            m.dense_at(part, s, x)


def method_watched_at(method: int, part: Real, s: State, x: Vec[NX], w: Work) -> None:
    """Evaluate the dense output of the watched states alone, w.search.watched, at a part of the step."""
    for m in static(METHODS):
        if is_method(method, m):
            for n in range(w.search.watching):
                x[w.search.watched[n]] = m.dense_state(part, w.search.watched[n], s)


def is_implicit(method: int) -> bool:
    """Return whether a method solves equations by derivatives."""
    for m in static(METHODS):
        if m.IMPLICIT > 0 and is_method(method, m):
            return True
    return False


def method_keep_stages(method: int, s: State) -> None:
    """Keep the stages of a step that is accepted, if the next one extrapolates them."""
    for m in static(METHODS):
        if m.IMPLICIT > 0 and is_method(method, m):
            m.keep_stages(s)


def method_estimate_roundoff(method: int, p: Params, t: Real, x: Vec[NX], h: Real, s: State, w: Work) -> None:
    """Raise w.error.rate_roundoff to the round-off of a step over h from x."""
    for m in static(METHODS):
        if m.IMPLICIT > 0 and is_method(method, m):
            m.estimate_roundoff(p, t, x, h, s, w)


def method_restore_stages(method: int, s: State) -> None:
    """Take these stages for those of the last step."""
    for m in static(METHODS):
        if m.IMPLICIT > 0 and is_method(method, m):
            m.restore_stages(s)


def has_series(method: int) -> bool:
    """Return whether a method expands the motion in a power series before each step."""
    for m in static(METHODS):
        if m.SERIES > 0 and is_method(method, m):
            return True
    return False


def method_begin_step(method: int, p: Params, s: State, o: Options, a: Trial, w: Work) -> Status:
    """Expand the motion from the beginning of a step, and set its size."""
    for m in static(METHODS):
        if m.SERIES > 0 and is_method(method, m):
            return m.begin_step(p, s, o, a, w)
    return OK


def method_keep_series(method: int, s: State) -> None:
    """Keep the series of an accepted step."""
    for m in static(METHODS):
        if m.SERIES > 0 and is_method(method, m):
            m.keep_series(s)


def method_restore_series(method: int, s: State, w: Work) -> Status:
    """Take the series of the last step again."""
    for m in static(METHODS):
        if m.SERIES > 0 and is_method(method, m):
            return m.restore_series(s, w)
    return OK


def end_rate_row(method: int) -> int:
    """Return the row of s.k with the rate at the end of a step, behind those of the stages."""
    for m in static(METHODS):
        if is_method(method, m):
            return m.END_RATE
    return 0


def keeps_constraints(method: int) -> bool:
    """Return whether the steps of a method stay on the constraints without a projection."""
    for m in static(METHODS):
        if m.PROJECTS == 0 and is_method(method, m):
            return True
    return False


def needs_end_rate(method: int) -> bool:
    """Return whether the error estimate contains the rate at the end of the step."""
    for m in static(METHODS):
        if m.USES_END_RATE > 0 and is_method(method, m):
            return True
    return False


def error_exponent(method: int) -> Real:
    """Return the exponent of the error in the next step size."""
    for m in static(METHODS):
        if is_method(method, m):
            return number(m.EXPONENT)
    return 1.0


def beta(method: int) -> Real:
    """Return the exponent of the error of the step before (PI controller)."""
    for m in static(METHODS):
        if is_method(method, m):
            return number(m.BETA)
    return 0.0


def largest_reduction(method: int) -> Real:
    """Return the largest factor by which one step shortens the next."""
    for m in static(METHODS):
        if is_method(method, m):
            return 1.0 / number(m.SHRINK)
    return 1.0


def largest_growth(method: int) -> Real:
    """Return the inverse of the largest factor by which one step lengthens the next."""
    for m in static(METHODS):
        if is_method(method, m):
            return 1.0 / number(m.GROW)
    return 1.0
