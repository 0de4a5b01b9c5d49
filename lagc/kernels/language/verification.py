"""The records of a verified run."""

from lagc.kernels.language.records import State, Work
from lagc.kernels.language.sizes import *
from lagc.kernels.language.words import Count, IVec, Length, Mat, Params, Real, Vec, struct


@struct
class Goal:
    """The request of a verified run, and the facts known before it."""

    accuracy: Real  # the largest error of each quantity over its scale
    law: Real  # error over tolerance, of an earlier run of the model; 0: not known.  The run replaces it
    most: Count  # limit of evaluations of the right-hand side in all attempts; 0: none
    slice: Count  # steps after which a call returns INTERRUPTED: call again to continue; 0: none


@struct
class Report:
    """The result of a verified run."""

    estimated: Real  # the largest error of a quantity over its scale; infinite: the end was not reached
    until: Real  # the accuracy is met until this time
    rtol: Real  # tolerance of the returned run
    attempts: Count  # pairs of runs
    rhs: Count  # evaluations of the right-hand side in all
    steps: Count  # of the returned run
    skipped: Count  # comparisons left out, since the runs had not passed the same events
    done: Length  # recorded times


@struct
class Verification:
    """Workspace of a verified run: the run, its check, and what is compared.  Fill it with zeros before the
    first use."""

    phase: int  # of the call: 0 a new run, 1 continues
    alone: bool  # error weights are relative to each state alone
    error: Vec[NQUANTITY]  # estimated error of each quantity
    scale: Vec[NQUANTITY]  # what it is relative to
    size: Vec[NQUANTITY]  # of the terms of the quantity
    constant: IVec[NQUANTITY]  # 1: does not move; 2: round-off keeps it from its own range; 3: is round-off
    if NZ > 0:
        work_error: Real  # largest difference of the work integrals, which have no error control
    if NLEAP > 0:
        time_error: Real  # estimated error of the times of jumps, and of the end by a clause
    run: State
    run_work: Work
    # Private from here on: the library alone reads and writes these fields.
    check: State
    check_work: Work
    p: Params  # of the check
    gap: Vec[NQUANTITY]  # largest difference of the two runs at recorded times and the end
    near: Vec[NQUANTITY]  # in the last block
    apart: Vec[NQUANTITY]  # over the whole motion
    low: Vec[NQUANTITY]  # range of the quantity
    high: Vec[NQUANTITY]
    terms: Vec[NQUANTITY]  # sum of the magnitudes of the terms of an output
    roundoff: Vec[NX]  # of the rates of speeds
    rate: Vec[NX]  # accelerations at the last comparison
    varies: IVec[NX]  # 1: this acceleration changes
    wider_change: Vec[NQUANTITY]  # of an output, under a wider change of the state
    start: Vec[NX]
    known: IVec[NX]  # 1: the two runs have agreed on a digit of the state
    begin_time: Real
    of_run: Vec[NQUANTITY]  # the quantities at one time
    of_check: Vec[NQUANTITY]
    x: Vec[NX]
    before: Mat[SEVEN, NQUANTITY]  # quantities of the run at the ends of the check's steps
    block_times: Vec[SEVEN]  # ends of the steps of the block
    check_times: Vec[SEVEN]  # ends of the check's steps
    if NMODE > 0:
        block_changes: Vec[SEVEN]  # events of the run before each of its steps
        lag: Count  # events of the run that the check has not, and will not have
        changes_before: Count  # events of both before this block
        check_before: Count
    if NLEAP > 0:
        time_gap: Real  # largest difference of the times of a jump
        run_jumps: Vec[SEVEN]  # times of the last jumps, each at its number modulo 7
        check_jumps: Vec[SEVEN]
        jump_lag: Count
    compared: IVec[SEVEN]  # 1: `before` has this row
    steps_done: int  # steps of the run in this block
    checked: Length  # recorded times that were compared
    tolerance: Real  # of the attempt
    duration: Real  # of the whole run
    check_ended: bool  # a clause has ended the check
    predicted: Real  # estimated error at the end, by that so far
    failures: int  # attempts that ended by an error
    set_out_time: Real  # of the last comparison at which a quantity has moved twice as far as before
    misses_by_small: bool  # the worst quantity is small in its scaling group
