"""Numbers that depend on the type of reals: float, double and __float128.

A kernel compares with a number from here where the result depends on round-off.
"""

from lagc.kernels.language.words import by_type

MOST_ITERATED = 7  # Newton iterations of a step with error control, and
MOST_FIXED = 50  # of a fixed step
TINY = by_type(1e-30, 1e-300, "1e-4000")  # replaces zero in a divisor
NO_LENGTH = by_type(1e-30, 1e-60, "1e-120")  # offset from a state where a derivative has no value
SPACING = by_type(1.2e-7, 2.3e-16, "2e-34")  # of numbers near 1
SINGULAR = by_type(1e-5, 1e-13, "1e-30")  # pivot ratio of a singular mass matrix
# Least pivot ratio of a sparse solve.  With constraints also the square of the share of a row that is
# independent of others.
LEAST_PIVOT = by_type(1e-4, 1e-10, "1e-10")
TRUSTED_PIVOT = by_type(1e-2, 1e-2, "1e-2")  # pivot ratio above which the residual is not checked
# Squared residual of a sparse solve above which it is refined; it grows with the number of unknowns.
REFINED_RESIDUAL = by_type(1e-11, 1e-28, "1e-64")
LARGEST_RESIDUAL = by_type(1e-7, 1e-20, "1e-50")  # squared residual above which a sparse solve has failed
FAINT_GRADIENT = by_type(1e-2, 1e-6, "1e-13")  # of the longest one: a gradient that may be round-off
DEPENDENT = by_type(1e-2, 1e-5, "1e-5")  # independent share below which a row counts as dependent
REMAINS_DEPENDENT = by_type(5e-2, 1e-4, "1e-4")  # the same once rows are known to be dependent
CONTRADICTION = by_type(1e-2, 1e-3, "1e-3")  # of the size of accelerations: residual of a dependent row
ROUNDOFF_RESIDUAL = by_type(1e-6, 1e-15, "1e-32")  # scaled residual that counts as round-off
# Scaled residual below which a projection does nothing.  It is smaller than the one before, since residuals
# that remain at every step have the same sign for many steps and add up.
UNPROJECTED_RESIDUAL = by_type(1e-7, 1e-16, "1e-33")
LEAST_SIZE = by_type(3e-4, 1.5e-8, "1.5e-8")  # of a state, over that of its group
# Of the size of its group: round-off of a state after projections, SPACING^(3/4). Projections move a state by
# units in the last place of its group, and by more near configurations where constraints are dependent.
PROJECTION_ROUNDOFF = by_type(6e-6, 1.8e-12, "5e-26")
EVENT_TIME_ULPS = 100.0  # round-off of an event time, in units in the last place
LEAST_STEP = by_type(1e-30, 1e-40, "1e-400")  # step size over the remaining time
FOUR_ULPS = by_type(4.8e-7, 8.881784197001252e-16, "7.7e-34")  # four units in the last place of 1
# Distance to a configuration with dependent rows, over the size of the coordinates: the product of motion and
# projection residual, and the projection residual.
CROSSING_BRANCHES = by_type(1e-6, 3e-15, "1e-30")
BRANCH_DISTANCE = by_type(1e-5, 1e-12, "1e-28")
# Scaled residuals of initial conditions: the largest that is accepted if the iteration stalls; below this,
# nothing is iterated; below this, the iteration ends.
ACCEPTED = by_type(1e-4, 1e-9, "1e-18")
CLOSE = by_type(3e-6, 1e-13, "1e-30")
EXACT = by_type(3e-7, 1e-15, "1e-32")
FOLLOWING = by_type(1e-4, 1e-11, "1e-24")  # remainder of a dependent row over its length
FADED = by_type(1e-14, 1e-30, "1e-60")  # an entry of a unit vector that is far below its rounding
SURELY_FOLLOWING = by_type(1e-2, 1e-5, "1e-12")
LEAST_SHARE = by_type(1e-3, 1e-7, "1e-14")  # move of a stated value over its size that counts as none
LEAST_WEIGHT = by_type(1e-30, 1e-290, "1e-4900")  # of an unknown
MOST_WEIGHT = by_type(1e30, 1e290, "1e4900")
# Of its size: a move of an unknown that may be none; where rows are quadratic, rounding leaves its root.
TRACE = by_type(3e-3, 1e-6, "1e-13")
UNKNOWN = by_type(1e38, 1e75, "1e75")  # end of an enclosure without a bound, as in `symbolic`
FARTHEST = by_type(3e3, 1e8, "1e17")  # from a guess, in its sizes: derivatives are looked at
NO_EDGE = by_type(3.2e38, 1.7e308, "1.7e308")  # edge of an outermost mode
# Contacts, of the sizes of what is compared: a speed, acceleration or force that is round-off; height of
# bounces that count as rest.
CONTACT_ROUNDOFF = by_type(1e-5, 1e-12, "1e-29")
LOAD_STEP = by_type(1e-4, 1e-10, "1e-20")  # step of Newton's method for loads of reactions, of its terms
LOWEST_BOUNCE = by_type(1e-4, 1e-10, "1e-20")
# Of the largest magnitude of its scaling group: a state that is round-off, without and with projections.
LEAST_COMPARED = by_type(1e-5, 1e-13, "1e-30")
PROJECTED_NOISE = by_type(1e-3, 1e-9, "1e-20")
