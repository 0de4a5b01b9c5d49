"""Bogacki and Shampine 3(2).

P. Bogacki, L. F. Shampine: A 3(2) pair of Runge-Kutta formulas, Appl. Math. Lett. 2 (1989) 321-325.  Dense
output is the cubic Hermite interpolant.
"""

TITLE = "Bogacki and Shampine 3(2)"
FAMILY = "explicit_runge_kutta"
ORDER = 3
END_RATE = 3
USES_END_RATE = 1
EXPONENT, BETA = "21/64", "0"
SHRINK, GROW = "1/5", "5"
STABILITY = ()
C = ("0", "1/2", "3/4")
A: tuple[dict[int, str], ...] = ({}, {1: "1/2"}, {2: "3/4"})
B = {1: "2/9", 2: "1/3", 3: "4/9"}
ERROR = ({1: "-5/72", 2: "1/12", 3: "1/9", 4: "-1/8"},)
EXTRA_C = ()
EXTRA_A = ()
DENSE = ()
