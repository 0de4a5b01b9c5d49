"""Numbers that belong to the arithmetic: of float, double and __float128.

Where a kernel compares with a number that rounding decides, it stands here for each type of real.
"""

from __future__ import annotations

from lagc.kernels.language.words import by_type

TINY = by_type(1e-30, 1e-300, "1e-4000")  # stands for zero where it divides zero
SPACING = by_type(1.2e-7, 2.3e-16, "2e-34")  # of numbers near 1
SINGULAR = by_type(1e-5, 1e-13, "1e-30")  # pivot ratio of a mass matrix that is singular
# Pivot ratio of a straight solve that is good enough; with constraints the square of the share below
# which rows count as dependent.
LEAST_PIVOT = by_type(1e-4, 1e-10, "1e-10")
# Pivot ratio above which nobody looks at what a straight solve leaves: some last places of 1 over the ratio.
TRUSTED_PIVOT = by_type(1e-2, 1e-2, "1e-2")
# Square of a residual of a straight solve, to be refined; rows are sums, and of many unknowns the
# root grows as they do.
REFINED_RESIDUAL = by_type(1e-11, 1e-28, "1e-64")
LARGEST_RESIDUAL = by_type(1e-7, 1e-20, "1e-50")  # the same, beyond trust
FAINT_GRADIENT = by_type(
    1e-2, 1e-6, "1e-13"
)  # of the longest gradient: one that may be rounding of its terms
DEPENDENT = by_type(1e-2, 1e-5, "1e-5")
STILL_DEPENDENT = by_type(5e-2, 1e-4, "1e-4")
CONTRADICTION = by_type(1e-2, 1e-3, "1e-3")  # of the size of accelerations
ROUNDOFF_RESIDUAL = by_type(1e-6, 1e-15, "1e-32")  # scaled residual that is taken for rounding
# The same that is left as it is: more than that, left at each step, adds up, as it has one sign for long.
UNPROJECTED_RESIDUAL = by_type(1e-7, 1e-16, "1e-33")
EVENT_TIME_ULPS = 100.0  # last places of the time
LEAST_STEP = by_type(1e-30, 1e-40, "1e-400")  # of the way to go
FOUR_ULPS = by_type(4.8e-7, 8.881784197001252e-16, "7.7e-34")  # four units of the last place of 1
# Ways to where rows are dependent, of the size of coordinates: their product, and what projection leaves.
CROSSING_BRANCHES = by_type(1e-6, 3e-15, "1e-30")
BRANCH_DISTANCE = by_type(1e-5, 1e-12, "1e-28")
# Of a consistent start: scaled residuals at which one is taken, if nothing improves it; at which it is left
# as it is; at which the iteration ends.
ACCEPTED = by_type(1e-4, 1e-9, "1e-18")
CLOSE = by_type(3e-6, 1e-13, "1e-30")
EXACT = by_type(3e-7, 1e-15, "1e-32")
FOLLOWING = by_type(1e-4, 1e-11, "1e-24")  # of its length: the rest of a row that follows from others
FADED = by_type(1e-14, 1e-30, "1e-60")  # an entry of a unit vector that is far below its rounding
SURELY_FOLLOWING = by_type(1e-2, 1e-5, "1e-12")
NEGLIGIBLE = by_type(1e-4, 1e-9, "1e-20")  # of the largest slope of a row: a pivot that counts as zero
UNMOVED = by_type(1e-9, 1e-22, "1e-56")  # squared, in weights
LEAST_WEIGHT = by_type(1e-30, 1e-290, "1e-4900")  # of an unknown
MOST_WEIGHT = by_type(1e30, 1e290, "1e4900")
# Of its size: a move of an unknown that may be none; where rows are quadratic, rounding leaves its root.
TRACE = by_type(3e-3, 1e-6, "1e-13")
UNKNOWN = by_type(1e38, 1e75, "1e75")  # the end of an enclosure of which nothing is known, as in expr
FARTHEST = by_type(3e3, 1e8, "1e17")  # from a guess, in its sizes: derivatives are looked at
NO_EDGE = by_type(3.2e38, 1.7e308, "1.7e308")  # of a table of edges: there is none
