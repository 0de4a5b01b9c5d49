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
    NH,
    NHEALTH,
    NJUMP,
    NK,
    NKIND,
    NLOOK,
    NM,
    NMODE,
    NNEAR,
    NPOLE,
    NQ,
    NR,
    NREACH,
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
NOWHERE = 0
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
        lost: bool  # rows of G are known to depend on others
    lam: Vec[NC]
    xdot: Vec[NX]
    a: Vec[NV]
    reached: Vec[NKIND]  # sizes of the kinds of states, with the one that is tried
    weights: Vec[NX]
    longest: Real  # that of the trajectory, in a second attempt at a step
    play: Vec[NX]  # rates that what projection leaves of coordinates is over a step
    end: Vec[NX]  # of what is tried beside the step
    health: Vec[NHEALTH]
    power: Vec[TWO]
    qdot: Vec[NQ]
    if NM > 0:
        M: Vec[NM]  # packed by rows of the lower triangle
        force: Vec[NV]
        low: Vec[NM]
        heads: IVec[NV]  # where rows of low begin to differ from zero
        column: Vec[NV]
        G: Vec[NG]
        gamma: Vec[NC]
    position_left: Real  # scaled residuals after a projection
    velocity_left: Real
    if NC > 0:
        sizes: Vec[NC]  # of the terms of gamma
        if NM > 0:
            weight: Real
        miss: Real
        slight: Vec[NC]
        reaches: Vec[NREACH]
        own: Vec[NKIND]
        if NM > 0:
            b: Mat[NC, NV]
            begins: IVec[NC]  # where rows of b begin to differ from zero, and where they cease to
            stops: IVec[NC]
            f: Mat[NC, NC]
            table: Mat[NC, NC]
            normal: Mat[NC, NC]
            lengths: Vec[NC]
        free: Vec[NC]
        found: Vec[NC]
        scales: Vec[NC]  # of residuals, and of their rates
        rates: Vec[NC]
        rows: Vec[NC]
        right: Vec[NR]
        left: Vec[NR]
        moved: Vec[NX]
        dq: Vec[NQ]
        if NM > 0:
            order: IVec[NC]
        known: IVec[NC]  # rows that were redundant before a look at another state
        if NM > 0:
            tail: Vec[NC]
            mu: Vec[NC]
            rank: Size
            dense: bool
        else:
            rest: Vec[NR]
            change: Vec[NR]
        assembled: bool  # the factors of this projection are there
    if NH > 0:
        parts: Mat[TWO, NX]  # of the error of a step
        other: Mat[TWO, NX]  # the same of another attempt
        nudged: Vec[NX]
    if NWORK > 0:
        entries: Vec[NWORK]
    if NMODE > 0:
        held: bool  # the modes are those of a step
        modes: Vec[NMODE]
        sides: Vec[NMODE]  # what each switch changes at
        beside: Vec[NMODE]
        turning: Vec[NMODE]  # rates of the sides
        before: Vec[NMODE]
        left_sides: Vec[NMODE]  # on the branch that it leaves
        own_modes: Vec[NMODE]
        jumped: IVec[NMODE]  # 1: its side, as others changed
        left_rates: Vec[NX]  # of the state, on the branch that it leaves
        crossed: IVec[NMODE]  # 1: it changes at the end of the step
        halted: IVec[NFREE]  # 1: its side comes to zero then, too
    if NWHEN > 0:
        holds: Vec[NWHEN]  # 1: a condition does
        due: IVec[NWHEN]  # 1: it has become true
        shifted: IVec[NFREE]  # 1: its side, by what was done at this moment
        x_before: Vec[NX]  # and all else that is put back where what is to be done cannot be
        went: bool  # the state is at the time of a change
        held_before: Vec[NWHEN]
        modes_before: Vec[NMODE]
        slack_before: Vec[NMODE]
    if NJUMP > 0:
        fresh_values: Vec[NJUMP]
        landed: Vec[NX]
        energies: Vec[THREE]
    if NEDGES > 0:
        edges: Vec[NEDGES]  # of the modes
        left_edges: Vec[NEDGES]
    if NTIMED > 0:
        slopes: Vec[NTIMED]
        when: Vec[NTIMED]
    if NFREE > 0:
        ends: Vec[NENDS]
        margins: Vec[NFREE]  # how far each side is from where its switch changes
        spans: Vec[NFREE]
        blurs: Vec[NFREE]  # what last places are worth in these sides
    if NFEAT > 0:
        bounds: Vec[NBOUNDS]
        values: Vec[NFEAT]
        floors: Vec[NFEAT]  # between which each is seen
        tops: Vec[NFEAT]
    if NPOLE > 0:
        divisors: Vec[NNEAR]  # between which each is
        clear: Vec[NPOLE]  # how far from zero each is to stay
        here: Vec[NPOLE]
        midway: Vec[NPOLE]
        there: Vec[NPOLE]
        wary: bool  # whether any is to
    if NLOOK > 0:
        box: Vec[NBOX]  # least time and states, largest time and states
        arrived: Vec[NX]
        left_x: Vec[NX]
        middle: Vec[NX]
        right_x: Vec[NX]


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
    sizes: Vec[NKIND]  # of coordinates, and speeds, of one unit: the largest so far
    if NMODE > 0:
        changes: Count  # times at which a switch has changed
        changed: IVec[NMODE]  # 1: a switch that did at the last of these
        jolts: Vec[NX]  # what the last place of these times is worth in the states, in all
    if NWHEN > 0:
        acts: int  # of clauses `when` then
        acted: IVec[NACTS]  # which, in the order in which they did
        jumps: Count  # acts that gave states new values
        x_left: Vec[NX]  # where the last step ended, before anything was done there
    longest: Real  # step that was tried at first
    listening: bool  # the error of the last step was judged with its rounding
    recalled: Real  # 1 where rounding made a step good, and less the longer ago that is; 0: forgotten
    noise: Vec[NX]  # that rounding, of the rates
    entered: Count  # steps and attempts before this call
    called: bool  # from here on for the functions below: no step was made since the caller had it
    known: bool  # p is that of the last step
    method: int  # of the last step
    rate: int  # at (t, x): k[0], the last of k, or to be found
    dense: int  # of the last step: r, k, or to be found
    if NC > 0:
        lost: bool
    on_grid: Count
    grid: Real
    stride: Real
    h: Real
    error_old: Real
    h_old: Real
    x_old: Vec[NX]
    t_seen: Real
    x_seen: Vec[NX]  # where the last step ended
    p: Params  # of the last step
    if NMODE > 0:
        modes: Vec[NMODE]  # the branch of the next step: sign(e), or floor(e), of each switch
        modes_old: Vec[NMODE]  # of the last
        slack: Vec[NMODE]  # how far a side is beyond its change
        fresh: bool  # the last step ended with one
        rough: Real  # time that errors of the last step are worth
        little: Real  # time, beside the last step: what is of second order in it is less than its error
        halved: bool  # it was the first half of one that would
        changes_here: Count  # changes at the time t_changed
        t_changed: Real
    if NWHEN > 0:
        held: Vec[NWHEN]  # 1: a condition that holds
        acquainted: bool  # these are known
        came: Vec[NFREE]  # when each switch that the state changes did last
    y: Vec[NX]  # where the next may end
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
    lands: bool  # on t1, exactly
    heard: bool  # the error was judged with its rounding
    if NMODE > 0:
        meets: bool  # it ends where a switch changes
        half: bool  # it is the first of one that would
        whole: Real  # the size that was accepted before it was made to
    rejected: int  # attempts before
