"""Taylor series of variable order.

A. Jorba, M. Zou, Experimental Mathematics 14 (2005) 99-117. ORDER is that of a run at a tolerance of machine
precision; others follow from the tolerance.
"""

TITLE = "Taylor series of variable order, by recurrences"
FAMILY = "taylor"
ORDER = 20
END_RATE = 1
USES_END_RATE = 1
EXPONENT, BETA = "1/16", "0"
SHRINK, GROW = "1/2", "8"
STABILITY = ()
ERROR: tuple[dict[int, str], ...] = ({},)
EXTRA_C = ()
