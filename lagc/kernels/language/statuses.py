"""Statuses: the result of a call."""

from lagc.kernels import Status

OK = Status(0)  # Success.
# The mass matrix is singular or not positive definite; culprit: an index of v
SINGULAR_MASS = Status(1)
# Success with redundant constraints: the multipliers are the smallest that fit; culprit: a constraint
# equation
REDUNDANT = Status(2)
INCONSISTENT = Status(3)  # The constraints contradict each other; culprit: a constraint equation
# A value is not finite; culprit: the index of x that is not finite, or whose rate is not
NOT_FINITE = Status(4)
STEP_UNDERFLOW = Status(5)  # The step size underflowed; culprit: none
MAX_STEPS = Status(6)  # The step limit of one call is reached; call again to continue; culprit: none
INTERRUPTED = Status(7)  # Interrupted; call again to continue; culprit: none
# An option, a time or a parameter is not valid; culprit: one of LAGC_BAD_...
INVALID = Status(8)
# Modes change without end at one time; culprit: the relation, or the number of relations + the `when` clause
CHATTERING = Status(9)
TERMINATED = Status(10)  # A `when` clause ended the run; call again to continue; culprit: the clause
# The new values of a `when` clause are not finite or violate the constraints; culprit: the clause
MISPLACED = Status(11)
NOT_CONVERGED = Status(12)  # The equations of an implicit step were not solved; culprit: none
# Laws of contacts, or loads of reactions, have no solution or several; culprit: the contact or the row
PARADOX = Status(13)
# A bound or a clause `when` has put bodies beyond a bound; culprit: the contact
PENETRATION = Status(14)


def failed(status: Status) -> bool:
    """Return whether an evaluation has no result; redundant constraints have one."""
    return status != OK and status != REDUNDANT
