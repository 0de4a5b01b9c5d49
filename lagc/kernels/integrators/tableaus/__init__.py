"""Integration methods, one file each: what `runge_kutta` and step control know of them.

TITLE, ORDER; a tableau k_i = f(t + c_i h, x + h sum a_ij k_j), x1 = x + h sum b_i k_i, with rows that leave
out zeros, stages counted from 1, and numbers as decimal text or quotients, exactly as published.

ERROR: the error of a step is h times its one row; with two rows e5 and e3 it is
h e5^2 / sqrt(e5^2 + 0.01 e3^2).
Dense output: stages EXTRA after the rate at the new state, and

    x(t + s h) = x + s (r1 + (1-s) (r2 + s (r3 + (1-s) (r4 + ...))))
    r1 = x1 - x,  r2 = h k_1 - r1,  r3 = r1 - h k_(s+1) - r2,  r4 ... = h times rows of DENSE

The size of the next step is h / clip(err^EXPONENT err_old^-BETA / 0.9, 1/GROW, 1/SHRINK).
EXPONENT and BETA are sums of powers of 1/2: with an error of order q, EXPONENT + 3/4 BETA is about 1/(q + 1).
USES_END_RATE: whether the error needs the rate at the new state.
"""

from __future__ import annotations

from importlib import import_module


def order(name: str) -> int:
    """Of the method of that file."""
    found: int = import_module(f"lagc.kernels.integrators.tableaus.{name}").ORDER
    return found


def adapts(name: str) -> bool:
    """Whether it estimates its errors; otherwise it takes fixed steps alone."""
    return len(import_module(f"lagc.kernels.integrators.tableaus.{name}").ERROR) > 0
