"""Classical Runge-Kutta of order 4, for fixed steps.

W. Kutta 1901; Hairer, Norsett, Wanner 1993, table II.1.2.  Dense output is the cubic Hermite interpolant.
"""

TITLE = "Classical Runge-Kutta 4, fixed steps"
FAMILY = "explicit_runge_kutta"
ORDER = 4
END_RATE = 4
USES_END_RATE = 0
EXPONENT, BETA = "1/4", "0"
SHRINK, GROW = "1/5", "5"
STABILITY = ()
C = ("0", "1/2", "1/2", "1")
A: tuple[dict[int, str], ...] = ({}, {1: "1/2"}, {2: "1/2"}, {3: "1"})
B = {1: "1/6", 2: "1/3", 3: "1/3", 4: "1/6"}
ERROR = ()
EXTRA_C = ()
EXTRA_A = ()
DENSE = ()
