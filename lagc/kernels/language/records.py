"""What a run keeps: its options, its state, and room to work in."""

from __future__ import annotations

from lagc.kernels.language.sizes import (
    NACTS,
    NBOUNDS,
    NBOX,
    NC,
    ND,
    NEDGES,
    NENDS,
    NFEAT,
    NFREE,
    NG,
    NGROUP,
    NH,
    NHEALTH,
    NJUMP,
    NK,
    NM,
    NMODE,
    NNEAR,
    NPOLE,
    NQ,
    NR,
    NREACH,
    NSEARCH,
    NTIMED,
    NV,
    NWHEN,
    NWORK,
    NX,
    THREE,
    TWO,
)
from lagc.kernels.language.words import Code, Count, IVec, Mat, Params, Real, Size, Vec, record

# The culprit of INVALID; of a parameter or an input: LAGC_BAD_PARAMETER + its place in lagc_params; behind
# these, of a value that is made of parameters: its place in lagc_limits.
BAD_METHOD = Code(0)
BAD_MAX_STEPS = Code(1)
BAD_RTOL = Code(2)
BAD_ATOL = Code(3)
BAD_STEP = Code(4)
BAD_FIRST_STEP = Code(5)
BAD_MAX_STEP = Code(6)
BAD_TIME = Code(7)  # s->t, t1, t, times, or n and *done
BAD_BUDGET = Code(8)
BAD_LEVEL = Code(9)
BAD_BINDING = Code(10)  # lagc_bind was not called, or a parameter was changed since
BAD_PARAMETER = Code(16)

# Where a rate, or the dense output, is to be found.
ABSENT = 0
STAGES = 1  # a rate: the first of them
READY = 2  # a rate: the last of the stages


@record
class Options:
    """Numbers are finite and not negative."""

    method: int  # lagc_method
    project: bool  # 0: let the constraints drift
    max_steps: Count  # of one call, accepted and rejected; 0: no limit
    rtol: Real  # below 1; of the largest magnitude so far of the states of the same kind
    atol: Real  # added for every state; where it is 0, rtol is 1e-15 at least
    step: Real  # > 0: fixed steps, rtol and atol unused
    first_step: Real  # 0: chosen
    max_step: Real  # 0: no limit
    if NMODE > 0:
        report: (
            int  # 1: advance and record return INTERRUPTED at each time at which switches change: s->changed
        )
        halves: bool  # 1: steps that end where switches change, or with the call, are made in two


@record
class Work:
    """Room for the calls below; fill it with zeros before its first use.  Between calls it holds nothing
    that another needs, but for lagc_solve after lagc_assemble: it may serve any states, in any order."""

    culprit: int  # what a status refers to: an index of v or x, or a row
    fallbacks: Count  # linear solves that took the slower, safer way
    if NC > 0:
        redundant: IVec[NC]  # 1: this row was found to depend on others
        rank_deficient: bool  # rows of G are known to depend on others
    lam: Vec[NC]
    xdot: Vec[NX]
    a: Vec[NV]
    trial_sizes: Vec[NGROUP]  # sizes of the kinds of states, with the one that is tried
    error_weights: Vec[NX]
    longest_step: Real  # that of the trajectory, in a second attempt at a step
    coordinate_roundoff: Vec[NX]  # rates that what projection leaves of coordinates is over a step
    health: Vec[NHEALTH]
    power: Vec[TWO]
    qdot: Vec[NQ]
    if NM > 0:
        M: Vec[NM]  # packed by rows of the lower triangle
        force: Vec[NV]
        cholesky: Vec[NM]
        row_begin: IVec[NV]  # where rows of low begin to differ from zero
        pivot_column: Vec[NV]
        G: Vec[NG]
        gamma: Vec[NC]
    position_residual: Real  # scaled residuals after a projection
    velocity_residual: Real
    if NC > 0:
        gamma_sizes: Vec[NC]  # of the terms of gamma
        if NM > 0:
            penalty: Real
        constraint_violation: Real
        regularity: Vec[NC]
        reaches: Vec[NREACH]
        group_sizes: Vec[NGROUP]
        if NM > 0:
            q_rows: Mat[NC, NV]
            q_begin: IVec[NC]  # where rows of b begin to differ from zero, and where they cease to
            q_end: IVec[NC]
            q_factor: Mat[NC, NC]
            dependence: Mat[NC, NC]
            normal_matrix: Mat[NC, NC]
            row_lengths: Vec[NC]
        row_room: Vec[NC]
        row_room2: Vec[NC]
        row_scales: Vec[NC]  # of residuals, and of their rates
        rate_scales: Vec[NC]
        row_values: Vec[NC]
        kkt_rhs: Vec[NR]
        kkt_solution: Vec[NR]
        x_candidate: Vec[NX]
        dq: Vec[NQ]
        if NM > 0:
            row_order: IVec[NC]
        redundant_before: IVec[NC]  # rows that were redundant before a look at another state
        if NM > 0:
            row_rhs: Vec[NC]
            mu: Vec[NC]
            rank: Size
            is_dense: bool
        else:
            kkt_residual: Vec[NR]
            kkt_correction: Vec[NR]
        is_assembled: bool  # the factors of this projection are there
    if NH > 0:
        error_parts: Mat[TWO, NX]  # of the error of a step
        error_parts_before: Mat[TWO, NX]  # the same of another attempt
        x_perturbed: Vec[NX]
    if NWORK > 0:
        kkt_entries: Vec[NWORK]
    if NMODE > 0:
        modes_fixed: bool  # the modes are those of a step
        modes: Vec[NMODE]
        indicators: Vec[NMODE]  # what each switch changes at
        indicators_before: Vec[NMODE]
        indicator_rates: Vec[NMODE]  # rates of the sides
        old_indicator_rates: Vec[NMODE]
        old_indicators: Vec[NMODE]  # on the branch that it leaves
        candidate_modes: Vec[NMODE]
        indicator_jumped: IVec[NMODE]  # 1: its side, as others changed
        old_rates: Vec[NX]  # of the state, on the branch that it leaves
        crossed: IVec[NMODE]  # 1: it changes at the end of the step
        sliding_candidates: IVec[NFREE]  # 1: its side comes to zero then, too
    if NWHEN > 0:
        conditions: Vec[NWHEN]  # 1: a condition does
        triggered: IVec[NWHEN]  # 1: it has become true
        indicator_reset: IVec[NFREE]  # 1: its side, by what was done at this moment
        x_saved: Vec[NX]  # and all else that is put back where what is to be done cannot be
        at_event_time: bool  # the state is at the time of a change
        conditions_saved: Vec[NWHEN]
        modes_saved: Vec[NMODE]
        slack_saved: Vec[NMODE]
    if NJUMP > 0:
        reinit_values: Vec[NJUMP]
        x_reinit: Vec[NX]
        energies: Vec[THREE]
    if NEDGES > 0:
        edges: Vec[NEDGES]  # of the modes
        old_edges: Vec[NEDGES]
    if NTIMED > 0:
        indicator_slopes: Vec[NTIMED]
        event_times: Vec[NTIMED]
    if NFREE > 0:
        enclosures: Vec[NENDS]
        margins: Vec[NFREE]  # how far each side is from where its switch changes
        margin_changes: Vec[NFREE]
        indicator_roundoff: Vec[NFREE]  # what last places are worth in these sides
    if NFEAT > 0:
        feature_bounds: Vec[NBOUNDS]
        feature_values: Vec[NFEAT]
        feature_low: Vec[NFEAT]  # between which each is seen
        feature_high: Vec[NFEAT]
    if NPOLE > 0:
        divisor_bounds: Vec[NNEAR]  # between which each is
        divisor_limits: Vec[NPOLE]  # how far from zero each is to stay
        divisor_begin: Vec[NPOLE]
        divisor_middle: Vec[NPOLE]
        divisor_end: Vec[NPOLE]
        guards_divisors: bool  # whether any is to
    if NSEARCH > 0:
        box: Vec[NBOX]  # least time and states, largest time and states
        x_trial: Vec[NX]
        x_part_begin: Vec[NX]
        x_part_middle: Vec[NX]
        x_part_end: Vec[NX]


@record
class State:
    """A state on its way: t and x now, and the last step, with all that dense output of it and the next
    step need.  A copy is a state of its own."""

    t: Real
    x: Vec[NX]
    t_old: Real  # where the last step began
    position_drift: Real  # largest scaled residuals after a step
    velocity_drift: Real
    steps: Count
    rejected: Count
    rhs: Count  # evaluations
    culprit: int
    sizes: Vec[NGROUP]  # of coordinates, and speeds, of one unit: the largest so far
    if NMODE > 0:
        changes: Count  # times at which a switch has changed
        changed: IVec[NMODE]  # 1: a switch that did at the last of these
        event_roundoff: Vec[NX]  # what the last place of these times is worth in the states, in all
    if NWHEN > 0:
        acts: int  # of clauses `when` then
        acted: IVec[NACTS]  # which, in the order in which they did
        jumps: Count  # acts that gave states new values
        x_before_event: Vec[NX]  # where the last step ended, before anything was done there
    longest_step: Real  # step that was tried at first
    roundoff_estimated: bool  # the error of the last step was judged with its rounding
    roundoff_memory: Real  # 1 where rounding made a step good, and less the longer ago that is; 0: forgotten
    rate_roundoff: Vec[NX]  # that rounding, of the rates
    steps_before_call: Count  # steps and attempts before this call
    is_new_call: bool  # from here on for the functions below: no step was made since the caller had it
    parameters_known: bool  # p is that of the last step
    method: int  # of the last step
    rate_place: int  # at (t, x): k[0], the last of k, or to be found
    dense_place: int  # of the last step: r, k, or to be found
    if NC > 0:
        rank_deficient: bool
    grid_index: Count
    grid_begin: Real
    grid_step: Real
    h: Real
    error_old: Real
    h_old: Real
    x_old: Vec[NX]
    t_end: Real
    x_end: Vec[NX]  # where the last step ended
    p: Params  # of the last step
    if NMODE > 0:
        modes: Vec[NMODE]  # the branch of the next step: sign(e), or floor(e), of each switch
        modes_old: Vec[NMODE]  # of the last
        slack: Vec[NMODE]  # how far a side is beyond its change
        after_event: bool  # the last step ended with one
        event_time_error: Real  # time that errors of the last step are worth
        first_order_time: (
            Real  # time, beside the last step: what is of second order in it is less than its error
        )
        is_split: bool  # it was the first half of one that would
        changes_at_time: Count  # changes at the time t_changed
        t_changed: Real
    if NWHEN > 0:
        conditions: Vec[NWHEN]  # 1: a condition that holds
        conditions_known: bool  # these are known
        crossing_times: Vec[NFREE]  # when each switch that the state changes did last
    x_new: Vec[NX]  # where the next may end
    k: Mat[NK, NX]  # rates at the stages
    r: Mat[ND, NX]  # coefficients of the dense output


@record
class Trial:
    """One attempt at a step from (s.t, s.x)."""

    direction: Real
    size: Real  # |h| that is wanted
    h: Real
    t_new: Real
    error: Real  # at most 1 where it is accepted
    ends_on_target: bool  # on t1, exactly
    roundoff_estimated: bool  # the error was judged with its rounding
    if NMODE > 0:
        ends_at_event: bool  # it ends where a switch changes
        is_split: bool  # it is the first of one that would
        size_before_event: Real  # the size that was accepted before it was made to
    rejected: int  # attempts before
