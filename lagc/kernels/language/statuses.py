"""Statuses: what a call ends with."""

from __future__ import annotations

from lagc.kernels import Status

OK = Status(0)  # done
SINGULAR_MASS = Status(1)  # the mass matrix is singular, or not positive definite; culprit: index of v
# rows of constraints depend on each other; culprit: a row; a success: lambda is the smallest that fits
REDUNDANT = Status(2)
INCONSISTENT = Status(3)  # rows of constraints contradict each other; culprit: a row
# a value is not finite; culprit: index of x: of what is not finite there, else of its rate
NOT_FINITE = Status(4)
# the step became too small, for the tolerance or beside the way to go, of more than 1e38 steps; culprit: none
STEP_UNDERFLOW = Status(5)
MAX_STEPS = Status(6)  # the steps that one call may take are used up; culprit: none; call again to go on
INTERRUPTED = Status(7)  # interrupted; culprit: none; call again to go on
INVALID = Status(8)  # an option, a time or a parameter makes no sense; culprit: see LAGC_BAD_METHOD and on
# a switch changes to and fro at once, without end; culprit: the switch, or behind these a clause `when`
CHATTERING = Status(9)

TERMINATED = Status(10)  # a `when` ended the run; culprit: the clause; call again to go on
MISPLACED = Status(11)  # new values are not finite, or do not meet the constraints; culprit: the clause


def failed(status: Status) -> bool:
    """Whether an evaluation gave nothing: rows that depend on others are solved."""
    return status != OK and status != REDUNDANT
