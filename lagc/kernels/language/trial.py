"""The records of one attempted step, and of sensitivities."""

from lagc.kernels.language.sizes import *
from lagc.kernels.language.words import Count, Mat, Real, Status, Vec, struct


@struct
class Trial:
    """One attempt of a step from (s.t, s.x)."""

    direction: Real  # 1 or -1
    size: Real  # |h|
    h: Real
    t_new: Real
    error: Real  # scaled; at most 1: the step is accepted
    is_accepted: bool
    ends_on_target: bool  # it ends at the given time exactly
    ends_on_grid: bool  # a fixed step: it ends at the next point of the grid
    leaves_end_rate: bool  # the rate at its end is not evaluated: the caller may change inputs there
    roundoff_estimated: bool  # the error was compared with its round-off
    if NMODE > 0:
        ends_at_event: bool
        is_split: bool  # it is the first half of a step
        size_before_event: Real  # accepted size before the step was shortened to end at an event
    if NGUARD > 0:
        reductions: int  # of the size, since something might be hidden
    rejected: int  # attempts before this one
    cause: Status  # of the last attempt, if it failed
    status: Status  # of the call, if there is no further attempt


@struct
class TangentWork:
    """Workspace of sensitivities. Fill it with zeros before the first use."""

    stepped: bool  # the motion made a step
    reason: int  # why S ended: 1: it has no finite value, 2: its derivatives grow without bound
    steps: Count  # accepted
    rejected: Count  # because of S
    pace: Real  # the longest step for S; 0: no limit
    error: Real  # scaled, of S in the last step
    extra_known: bool  # the stages of the dense output exist
    dense: bool  # the factors are those of the dense matrix
    k: Mat[NK, NX]  # rates of S at the stages, in one direction
    own: Vec[NX]
    x: Vec[NX]
    there: Vec[NX]  # the state at a recorded time
    xdot: Vec[NX]
    a: Vec[NV]
    lam: Vec[NC]
    seeds: Vec[NP]  # the direction in the parameters
    dqdot: Vec[NQ]
    dr: Vec[NR]
    solution: Vec[NR]
    tied: Vec[NTIED]
    weights: Vec[NX]  # of the error of S
    terms: Vec[NGROUP]  # that cancel in the change of S over the step
    longest: Real  # longest attempt of a step so far
