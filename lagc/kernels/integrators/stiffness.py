"""Detection of stiffness: steps that stability limits, not accuracy.

E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, Springer 1996, section IV.2.  The estimate
of h |lambda| there is averaged over 15 steps, since that of an oscillation changes from step to step.
"""

from lagc.kernels.integrators.dispatch import method_add_stability
from lagc.kernels.language.vocabulary import *

BETWEEN_TESTS = 985  # steps
TESTED = 15  # steps in a test
NEAR_BORDER = 0.64  # square of h |lambda| over that at the border of stability


def detect_stiffness(s: State, w: Work) -> None:
    """Count in s.stiff the tests that find the steps at the border of stability, one in 1000 steps."""
    # 985 steps without a test, then 15 that add to the sums.
    s.stability_due -= 1
    if s.stability_due >= TESTED:
        return
    method_add_stability(s.method, s, w)
    if s.stability_due > 0:
        return
    # (h |lambda|)^2 averaged over these steps, by two sums, near the border of stability of the method.
    if s.states_apart > 0.0 and s.rates_apart > NEAR_BORDER * s.states_apart:
        s.stiff += 1
    s.rates_apart = 0.0
    s.states_apart = 0.0
    s.stability_due = BETWEEN_TESTS + TESTED
