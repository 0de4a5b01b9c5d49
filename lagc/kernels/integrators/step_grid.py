"""The grid of fixed steps: time is counted, begin + index * step, and not added up.

A call that ends within round-off of a point of the grid ends at this point.  If several points have the same
time in this precision, as with steps of 1 ms at 1e6 s in float, a call passes as many points as the last one.
"""

from math import fabs, floor

from lagc.kernels.call_boundary import state_changed
from lagc.kernels.language.vocabulary import *

WITHIN_ROUNDOFF = 1e-9  # of a step: part of the round-off of a point
LENGTHENED = by_type(1e-2, 1e-6, "1e-6")  # of a step: a step to the end of a call is lengthened by this share
MOST_COUNTED = 1e9  # steps of one call whose end is searched on the grid


def grid_time(s: State, index: Count) -> Real:
    """Return the time of a point of the grid."""
    return s.grid.begin + float(index) * s.grid.step


def grid_roundoff(s: State, t: Real) -> Real:
    """Return the round-off of a point of the grid at t, and of the time that a caller computes for it."""
    counted = 2.0 * SPACING * fabs(t - s.grid.begin)
    return SPACING * fabs(t) + counted + WITHIN_ROUNDOFF * fabs(s.grid.step)


def is_grid_point(s: State, index: Count, t: Real) -> bool:
    """Return whether t is the time of a point of the grid, within round-off."""
    return fabs(grid_time(s, index) - t) <= grid_roundoff(s, t)


def begin_grid(s: State, t1: Real, o: Options) -> None:
    """Begin a call to t1: find the point of the grid where it ends, s.grid.goal.  The grid begins anew if
    the caller changed the step, the direction or the state."""
    # Same step and unchanged state: the grid goes on. It is counted from its beginning, so that ten calls of
    # 0.1 s are one of 1 s.
    forward = t1 > s.t or (t1 == s.t and s.grid.step >= 0.0)
    step = o.step if forward else -o.step
    if s.grid.step != step:
        s.grid.stride = 1
    if s.grid.step != step or state_changed(s):
        s.grid.step = step
        s.grid.begin = s.t
        s.grid.index = 0
        s.grid.rest = o.step
    s.grid.goal = s.grid.index
    # A call of the same number of points as the last one, then the nearest point to t1; else the call ends
    # between points.
    if is_grid_point(s, s.grid.index + s.grid.stride, t1):
        s.grid.goal += s.grid.stride
        return
    steps = (t1 - grid_time(s, s.grid.index)) / step
    nearest: Count = 1
    if steps > 1.0 and steps < MOST_COUNTED:
        nearest = whole(floor(steps + 0.5))
    if is_grid_point(s, s.grid.index + nearest, t1):
        s.grid.goal += nearest


def is_reached(s: State, t1: Real, o: Options) -> bool:
    """Return whether a call to t1 has ended."""
    return s.t == t1 and (o.step == 0.0 or s.grid.index >= s.grid.goal)


def plan_fixed_step(s: State, target: Real, t1: Real, a: Trial) -> None:
    """Set the end of a fixed step: the next point of the grid, or `target`, the end of the call or an event
    time, if that comes first."""
    following = grid_time(s, s.grid.index + 1)
    # The call ends on a point: steps are those of the grid, whatever round-off says about times.
    if target == t1 and s.grid.goal > s.grid.index:
        a.ends_on_grid = True
        a.ends_on_target = s.grid.index + 1 == s.grid.goal
    else:
        # Else the target counts if it comes before the next point, or so little behind it that a step of that
        # rest would be round-off.
        beyond = (target - following) * a.direction
        near = grid_roundoff(s, target)
        a.ends_on_target = beyond <= near or (
            target == t1 and beyond <= near + LENGTHENED * fabs(s.grid.step)
        )
        a.ends_on_grid = beyond >= -near and (beyond <= near or not a.ends_on_target)
    # The rest of a step that an event has split, or the way to the target; the time is that of the grid, not
    # a sum.
    a.size = s.grid.rest if a.ends_on_grid else fabs(target - s.t)
    a.h = a.size * a.direction
    a.t_new = following
    if a.ends_on_target or (following - target) * a.direction > 0.0:
        a.t_new = target
    elif (following - s.t) * a.direction < 0.0:
        a.t_new = s.t


def fixed_step_underflows(s: State, t1: Real, a: Trial) -> bool:
    """Return whether the steps are too short for the remaining time."""
    return not a.ends_on_target and 0.1 * a.size <= LEAST_STEP * fabs(t1 - s.t)


def pass_grid(s: State, t1: Real, a: Trial) -> None:
    """Count an accepted step."""
    # A point of the grid; the end of a call between points, where a grid begins anew; an event within a step.
    if a.ends_on_grid:
        s.grid.index += 1
        s.grid.rest = fabs(s.grid.step)
    elif a.ends_on_target and a.t_new == t1:
        s.grid.begin = t1
        s.grid.index = 0
        s.grid.goal = 0
        s.grid.rest = fabs(s.grid.step)
    else:  # at an event
        s.grid.rest -= a.size
        if s.grid.rest <= WITHIN_ROUNDOFF * fabs(s.grid.step):
            s.grid.index += 1
            s.grid.rest += fabs(s.grid.step)
