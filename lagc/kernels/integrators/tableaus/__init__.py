"""The integration methods, one file each.

TITLE, FAMILY (of `lagc.kernels.FAMILIES`) and ORDER of a method. END_RATE is the row of the stored rates with
the rate at the new state.

The tableau C, A, B of an explicit Runge-Kutta method: k_i = f(t + c_i h, x + h sum a_ij k_j),
x1 = x + h sum b_i k_i.  Rows map stages, counted from 1, to coefficients that are not zero, as decimal text
or quotients exactly as published.

ERROR: one row gives the error estimate, times h; two rows e5 and e3 are combined to
h e5^2 / sqrt(e5^2 + 0.01 e3^2).
Dense output: EXTRA_C and EXTRA_A are stages after the rate at the new state; DENSE gives r4 and on in

    x(t + s h) = x + s (r1 + (1-s) (r2 + s (r3 + (1-s) (r4 + ...))))
    r1 = x1 - x,  r2 = h k_1 - r1,  r3 = r1 - h k_(s+1) - r2,  r4 ... = h times rows of DENSE

The size of the next step is h / clip(err^EXPONENT err_old^-BETA / 0.9, 1/GROW, 1/SHRINK).
EXPONENT and BETA are sums of powers of 1/2: with an error of order q, EXPONENT + 3/4 BETA is about 1/(q + 1).
STABILITY: the product of step size and largest eigenvalue at the border of stability, for methods whose last
stage is at the end of the step; else nothing.
USES_END_RATE: 1 if the error estimate contains the rate at the new state.
"""

from importlib import import_module


def order(name: str) -> int:
    """Return the order of a method."""
    found: int = import_module(f"lagc.kernels.integrators.tableaus.{name}").ORDER
    return found


def adapts(name: str) -> bool:
    """Return whether a method estimates its errors; else it takes only fixed steps."""
    return len(import_module(f"lagc.kernels.integrators.tableaus.{name}").ERROR) > 0
