"""The options of a run."""

from lagc.kernels.language.sizes import NMODE
from lagc.kernels.language.words import Count, Real, struct


@struct
class Options:
    """How to integrate.  All numbers are finite and not negative."""

    method: int  # lagc_method
    project: bool  # 1: project onto the constraints after each step; 0: let the constraints drift
    alone: bool  # 1: rtol is relative to each state alone; 0: to the states of its scaling group
    max_steps: Count  # limit of accepted and rejected steps of one call; 0: no limit
    rtol: Real  # below 1; relative to the largest magnitude so far in the scaling group, or see `alone`
    atol: Real  # added for every state; if it is 0, rtol is at least 1e-15
    step: Real  # > 0: fixed step size, rtol and atol are not used
    first_step: Real  # 0: chosen
    max_step: Real  # 0: no limit
    if NMODE > 0:
        report: int  # 1: advance and record return INTERRUPTED after each event, see s->changed
        halves: bool  # 1: the last step before an event, or before the end of a call, is split in two
