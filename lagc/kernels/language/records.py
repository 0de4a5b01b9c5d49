"""The records of a run: options, workspace, state of a trajectory, and one attempted step."""

from lagc.kernels.language.contact_law import ContactLaw, ImpactWork
from lagc.kernels.language.sizes import *
from lagc.kernels.language.words import Code, Count, IVec, Mat, Params, Real, Size, Vec, struct

# The culprit of INVALID.  A parameter or input has LAGC_BAD_PARAMETER + its place in lagc_params.  A value
# computed from parameters (see lagc_limits) has its place there, behind all parameters and inputs.
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
BAD_BINDING = Code(10)  # lagc_bind was not called since a parameter changed
BAD_PARAMETER = Code(16)

ABSENT = 0  # a rate or dense output that is not stored
STAGES = 1  # a rate in the first stage; a dense output that the stages determine
READY = 2  # a rate in the last stage; a dense output whose coefficients are known
OPEN = 3  # a dense output that the stages determine with the rate at the end, which is not known


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


@struct
class ConstraintWork:
    """Workspace of the constraint equations: solves with [M G^T; G 0], scales of the rows, projection."""

    # Solves with [M G^T; G 0]
    rhs: Vec[NR]
    solution: Vec[NR]
    is_assembled: bool  # the factors of this projection exist
    if NM > 0:
        is_dense: bool  # the factors are those of the rank-revealing factorization
    else:
        residual: Vec[NR]
        correction: Vec[NR]
    # Constraint rows and their scales
    scales: Vec[NC]  # of the residuals
    rate_scales: Vec[NC]  # of the residual rates
    reaches: Vec[NREACH]  # change of each row over the sizes of the states
    gamma_sizes: Vec[NC]  # sum of the magnitudes of the terms of gamma
    regularity: Vec[NC]  # 1; less for a degenerate row, whose gradient nearly vanishes
    violation: Real  # scaled distance of x from the constraints
    group_sizes: Vec[NGROUP]
    values: Vec[NC]
    buffer: Vec[NC]
    buffer2: Vec[NC]
    redundant_before: IVec[NC]
    # Projection
    x_candidate: Vec[NX]
    dq: Vec[NQ]


@struct
class FactorWork:
    """Rank-revealing factorization L^-1 G^T = Q F diag(lengths), with M = L L^T."""

    q_rows: Mat[NC, NV]  # Q^T
    q_begin: IVec[NC]  # first and last column of each row of Q^T that is not zero
    q_end: IVec[NC]
    factor: Mat[NC, NC]  # F
    lengths: Vec[NC]
    order: IVec[NC]  # pivot order
    rank: Size
    penalty: Real  # > 0: L is the factor of M + penalty G^T G
    dependence: Mat[NC, NC]  # dependent rows as combinations of the independent ones
    normal_matrix: Mat[NC, NC]
    rhs: Vec[NC]
    mu: Vec[NC]


@struct
class ErrorWork:
    """Workspace of the estimated error of a step."""

    sizes: Vec[NGROUP]  # s->sizes, with the new state included
    weights: Vec[NX]
    longest_step: Real  # over which groups at rest are extrapolated; 0: they are not
    rate_roundoff: Vec[NX]  # round-off of the rates in the error weights of this attempt
    coordinate_roundoff: Vec[NX]  # residual of the projection of coordinates, divided by the step size
    if NH > 0:
        parts: Mat[TWO, NX]  # the two error estimates of the step
        parts_before: Mat[TWO, NX]  # those of the step before it was perturbed
        x_perturbed: Vec[NX]


@struct
class NewtonWork:
    """Workspace of implicit methods: the stages are solved by Newton's method."""

    loosening: Real  # of the estimated error over that of the weights
    tolerance: Real  # scaled error of the stages
    rtol: Real  # in their weights
    most: int  # iterations
    x_stage: Vec[NX]
    rates_stage: Vec[NX]
    residual: Vec[NNEWTON]
    residual_before: Vec[NNEWTON]
    residual_rows: Vec[NR]
    direction: Vec[NDIRECTION]
    linear: Vec[NLINEAR]
    linear_imaginary: Vec[NLINEAR]
    stage_residuals: Mat[THREE, NNEWTON]
    increments: Mat[THREE, NNEWTON]
    stage_power: Mat[FOUR, TWO]


@struct
class SeriesWork:
    """Workspace of the Taylor series of the motion."""

    values: Vec[NVALUE]  # of the state, for all orders
    scaled: Vec[NSERIES]  # scale times the rates of an order; k, 1/k, the coefficient of time
    end_slopes: Vec[NX]  # of the polynomial
    rates_next: Vec[NX]
    sums: Vec[NCONVOLVED]  # of products of coefficients, lanes, then squares
    left: Mat[NTERM, NLANE]  # coefficients of both factors of each lane
    right: Mat[NTERM, NLANE]
    squares: Mat[NTERM, NSQUARE]


@struct
class EventWork:
    """Workspace of relations: their event indicators, detection and location of zero crossings."""

    indicators: Vec[NMODE]  # event indicators
    rates: Vec[NMODE]
    crossed: IVec[NMODE]  # 1: this indicator crosses zero, or an edge, at the end of the step
    indicators_before: Vec[NMODE]  # in the modes that were looked at before
    jumped: IVec[NMODE]  # 1: this indicator changed with the modes of others
    candidate_modes: Vec[NMODE]
    sliding_candidates: IVec[NFREE]  # 1: this indicator reaches zero at the same time
    # The modes that an event leaves
    old_indicators: Vec[NMODE]
    old_rates: Vec[NMODE]
    old_state_rates: Vec[NX]  # of the state
    if NSAMPLED > 0:
        sampled_low: Vec[NMODE]  # range of indicators over the samples of a part of a step
        sampled_high: Vec[NMODE]
    if NEDGES > 0:
        edges: Vec[NEDGES]  # lower and upper edge of the mode of each stepwise relation
        old_edges: Vec[NEDGES]
    if NTIMED > 0:
        # Relations of time alone
        slopes: Vec[NTIMED]
        times: Vec[NTIMED]
    if NFREE > 0:
        # Detection of zero crossings
        enclosures: Vec[NENDS]  # lower and upper bound of each indicator in the box
        suspects: int  # how many of them may cross in a step, by their bounds over the whole of it
        suspect: IVec[NFREE]  # these
        if NCON > 0:
            seeks_forces: bool  # among them are forces of contacts, or slips
        margins: Vec[NFREE]  # distance of each indicator from its crossing, negative beyond it
        margin_changes: Vec[NFREE]
        roundoff: Vec[NFREE]  # change of each indicator by one unit in the last place of (t, x)


@struct
class SearchWork:
    """The parts of a step in which zero crossings and narrow features are looked for."""

    box: Vec[NBOX]  # lower ends of time and states, then upper ends
    x_trial: Vec[NX]
    x_part_begin: Vec[NX]
    x_part_middle: Vec[NX]
    x_part_end: Vec[NX]
    watched: IVec[NMOVED]  # coordinates and speeds that what is looked for depends on
    watching: int  # how many


@struct
class LoadWork:
    """Workspace of loads that depend on reactions."""

    if NLOADED > 0:
        free: Vec[NC]  # multipliers without them
    lam: Vec[NC]
    force: Vec[NV]
    slopes: Vec[NLOADSLOPES]  # derivatives of the forces by these reactions, one after the other
    if NLOADED > 0:
        rhs: Vec[NR]
        answer: Vec[NR]
        total: Vec[NR]  # accelerations and multipliers that the loads add
        columns: Vec[NLOADCOLUMNS]
        matrix: Vec[NLOADMATRIX]
        sizes: Vec[NLOADMATRIX]  # of the terms of its entries
        step: Vec[NLOADED]
        reach: Vec[NLOADED]  # of the terms of each multiplier
        matrix_kept: Vec[NLOADMATRIX]  # those of one state for many responses
        sizes_kept: Vec[NLOADMATRIX]
    if NCON > 0:
        begin: Vec[NR]  # accelerations and multipliers without loads and contacts
        rest: Vec[NV]  # forces at reactions of zero, by their slopes
        pushes: Vec[NCROW]


@struct
class LateWork:
    """Relations that accelerations or reactions decide."""

    values: Vec[NLATE]  # their indicators
    modes: Vec[NLATE]  # modes that these give
    here: Vec[NLATE]
    known: Vec[NKNOWN]
    x: Vec[NX]
    rates: Vec[NX]
    lam: Vec[NC]


@struct
class ClauseWork:
    """Workspace of clauses `when`."""

    conditions: Vec[NWHEN]  # 1: this condition is true
    triggered: IVec[NWHEN]  # 1: it has become true
    indicator_reset: IVec[NFREE]  # 1: a clause changed this indicator at this event
    act_first: bool  # clauses act on a crossing that forces drive back
    in_contact: IVec[NFREE]  # 1: this indicator of clauses moves by round-off alone
    size_roundoff: Vec[NFREE]  # change of each indicator by one unit in the last place of the sizes
    at_event_time: bool  # the state is that at the time of the crossing
    x_saved: Vec[NX]
    conditions_saved: Vec[NWHEN]
    modes_saved: Vec[NMODE]
    slack_saved: Vec[NMODE]
    if NJUMP > 0:
        reinit_values: Vec[NJUMP]
        x_reinit: Vec[NX]
        energies: Vec[THREE]


@struct
class GuardWork:
    """Workspace of step guards: narrow features, and divisors near zero."""

    if NFEAT > 0:
        # Step guards: narrow features
        feature_bounds: Vec[NBOUNDS]  # lower and upper bound of each in the box
        feature_values: Vec[NFEAT]
        feature_low: Vec[NFEAT]  # range that the ends of the step show
        feature_high: Vec[NFEAT]
    if NPOLE > 0:
        # Step guards: divisors near zero
        divisor_bounds: Vec[NNEAR]  # lower and upper bound of each in the box
        divisor_limits: Vec[NPOLE]  # least distance of each from zero
        divisor_begin: Vec[NPOLE]
        divisor_middle: Vec[NPOLE]
        divisor_end: Vec[NPOLE]
        guards_divisors: bool  # a divisor may come nearer to zero within the step


@struct
class ContactWork:
    """Workspace of contacts: their rows, responses, forces and friction at one state."""

    touched: IVec[NCON]  # 1: it touches
    modes: IVec[NCON]  # 0 open, 1 or -1 slips forwards or backwards, 2 sticks; 1 without friction
    touching: IVec[NCON]  # the listed contacts
    touching_rows: IVec[NCROW]  # their rows
    first_block: int  # the blocks whose contacts are listed
    last_block: int
    slot: IVec[NCROW]  # of each listed row: its number among those of its block
    slots: int  # the largest number of listed rows of a block
    rows: Vec[NGRADIENTS]  # gradients of the rows by the speeds
    speeds: Vec[NCROW]  # rates of the rows
    bias: Vec[NCROW]  # accelerations of the rows where those of the speeds are 0
    gaps: Vec[NCON]
    indicators: Vec[NMODE]
    approach: Vec[NCON]  # speed before an impact
    responses: Vec[NRESPONSES]  # accelerations and multipliers for a unit of each listed row, by slots
    rhs: Vec[NR]
    solution: Vec[NR]
    shift: Vec[NQ]
    forces: Vec[NCROW]  # at the last evaluation
    pushes: Vec[NCROW]  # the same; of contacts that lack shares of a load, those that equations have
    force_margins: Vec[NCON]  # zero where a contact opens: its normal force, or a measure of its set
    force_roundoff: Vec[NCON]  # of normal forces
    x: Vec[NX]
    rates: Vec[NX]
    lam: Vec[NC]
    flies: bool  # no contact touches in this step, but those of blocks at rest
    touches: bool  # one of these does
    constant: IVec[NBLOCK]  # these blocks
    constant_count: int  # how many
    # Blocks whose states do not change within a step keep their rates and forces
    keeps: bool
    known: IVec[NBLOCK]
    kept_x: Vec[NX]
    kept_rates: Vec[NX]
    kept_lam: Vec[NC]
    kept_forces: Vec[NCROW]
    kept_pushes: Vec[NCROW]
    if NSLIP > 0:
        # Friction
        frictions: Vec[NDIRECT]  # of slip and of sticking, of each contact
        slides: Vec[NDIRECT]  # direction in which a contact begins to slip, by its force
        cone_margins: Vec[NCON]  # what falls to zero where it slips
        cone_roundoff: Vec[NCON]
        if NSPACE > 0:
            slip_axes: Vec[NDIRECT]  # direction in which each contact slips at the beginning of a step
            slip_roundoff: Vec[NCON]  # of its slip
            slips_held: bool  # they keep these directions
        if NTWO > 0:
            # Two-sided contacts: their normal forces as sums of accelerations, multipliers and forces
            normal_rows: Vec[NNORMALROWS]  # derivatives of each component
            normal_bias: Vec[NNORMAL]
            normal_given: Vec[NNORMAL]  # without the forces of contacts
            normal_effects: Vec[NNORMALEFFECTS]  # their derivatives by the forces of listed rows
            normal_axes: Vec[NNORMAL]  # direction of each normal force
            normal_signs: IVec[NCON]  # of normal forces with one component; 0: not known
    law: ContactLaw  # of the listed contacts
    impact: ImpactWork  # of them


@struct
class SettlingWork:
    """Workspace of contacts at an event."""

    hit: IVec[NCON]  # what has happened, by the kinds in `slips`
    has_acted: bool  # at this event already
    go_on: bool  # speeds have not jumped: contacts that touched before keep touching
    modes_before: Vec[NMODE]  # of relations, before the event
    indicators_unmoved: IVec[NMODE]  # 1: contacts do not change it
    acts: IVec[NBLOCK]  # 1: something happens in this block
    near: IVec[NCON]
    leaves: IVec[NCON]
    if NNEWTON > 0:
        departs: IVec[NCON]  # relation that leaves zero with a rate of zero; -1: none does
    closed: IVec[NCON]  # modes that the law has found
    rests: IVec[NCON]
    struck: Vec[NCON]  # impulse
    lost: Vec[NCON]  # energy
    energies: Vec[THREE]
    restitutions: Vec[NCON]
    x: Vec[NX]
    rates: Vec[NX]


@struct
class Work:
    """Workspace of the functions below.  Fill it with zeros before the first use.  It may serve any states
    in any order: between calls it keeps nothing, except from lagc_assemble to lagc_solve."""

    culprit: int  # what a status refers to: an index of v or x, or a constraint equation
    fallbacks: Count  # linear solves that used the slower, rank-revealing factorization
    if NC > 0:
        redundant: IVec[NC]  # 1: this constraint equation was found to depend on others
    if NBESIDE > 0:
        shared: IVec[NCON]  # 1: the force of this contact was one choice of many
    # Private from here on: the library alone reads and writes these fields.
    # Right-hand side
    lam: Vec[NC]
    xdot: Vec[NX]
    a: Vec[NV]
    qdot: Vec[NQ]
    power: Vec[TWO]
    health: Vec[NHEALTH]  # smallest pivot ratio and squared residual of the last linear solve
    if NM > 0:
        # Mass matrix, its factor and the dense equations of motion
        M: Vec[NM]  # packed by rows of the lower triangle
        force: Vec[NV]
        cholesky: Vec[NM]  # M = L L^T
        row_begin: IVec[NV]  # first column of each row of L that is not zero
        pivot_column: Vec[NV]
        G: Vec[NG]
        gamma: Vec[NC]
    if NWORK > 0:
        # Sparse factors of [M G^T; G 0]
        kkt_entries: Vec[NWORK]
    if NC > 0:
        rows: ConstraintWork
        rank_deficient: bool  # constraint equations are known to depend on others
        if NM > 0:
            factors: FactorWork
    position_residual: Real  # largest scaled residuals after a projection
    velocity_residual: Real
    error: ErrorWork
    if NNEWTON > 0:
        newton: NewtonWork
    if NSERIES > 0:
        series: SeriesWork
    if NMODE > 0:
        # Modes of relations
        modes: Vec[NMODE]
        modes_fixed: bool  # evaluations keep these modes; else they follow the state
        events: EventWork
    if NLOADS > 0:
        loads: LoadWork
    if NLATE > 0:
        late: LateWork
    if NWHEN > 0:
        clauses: ClauseWork
    if NGUARD > 0:
        guards: GuardWork
    if NCON > 0:
        contacts: ContactWork
        settling: SettlingWork
    if NSEARCH > 0:
        search: SearchWork


@struct
class NewtonState:
    """Jacobian and estimates that an implicit method keeps from step to step."""

    kept_step: Count  # steps behind which the stages of the last one are kept; -1: none
    jacobian_step: Count  # steps at which the derivatives were computed; -1: not known
    factored: Real  # step size of the factors; 0: none
    count: int  # iterations of the last step
    eta: Real  # sum of the increments that follow over the last one
    theta: Real  # ratio of two increments
    slopes: Vec[NSLOPES]  # derivatives of the equations of a stage by q, v and multipliers
    mass: Vec[NMASS]
    real_factors: Vec[NFACTORS]
    real_pivots: IVec[NLINEAR]
    complex_factors: Vec[NFACTORS]
    imaginary_factors: Vec[NFACTORS]
    complex_pivots: IVec[NLINEAR]
    start_lam: Vec[NC]  # multipliers at the beginning of a step
    stage_lam: Mat[THREE, NC]
    kept_lam: Mat[THREE, NC]  # those of the kept stages
    dependent: IVec[NC]  # 1: this constraint equation depends on others


@struct
class SeriesState:
    """The Taylor series of the motion, and what it tells of the next one."""

    coefficients: Mat[NTERM, NX]  # coefficients of the states, in the time over series_scale
    scale: Real
    part: Real  # size of the last step over it
    size: Real  # that the coefficients admit
    tolerance: Real
    ratio: Real  # of successive terms at the end of a step
    fall: Real  # its power k, for the least order k that the radius is estimated from
    order: Count
    step: Count  # steps behind which the coefficients are those of the last one; -1: none
    kept_scale: Real  # of the last step
    kept_order: Count


@struct
class GridState:
    """The grid of fixed steps."""

    begin: Real  # grid of fixed steps
    step: Real  # negative backwards; 0: there is no grid
    index: Count  # points that were passed
    rest: Real  # size of the step to the next point
    goal: Count  # the point where the call ends, or grid_index if it ends at none
    stride: Count  # points that the last call passed


@struct
class SlipState:
    """The directions in which contacts slip in space."""

    axes: Vec[NDIRECT]  # of the next step
    roundoff: Vec[NCON]
    errors: Vec[NCON]  # that the last step may have made
    speeds: Vec[NCON]  # at the beginning of the step
    begins: IVec[NCON]  # 1: the slip has begun, and no step was made
    axes_old: Vec[NDIRECT]  # of the last step
    roundoff_old: Vec[NCON]


@struct
class State:
    """The state of a trajectory: t and x, the last step for dense output, and what the next step needs.
    A copy continues on its own."""

    t: Real
    x: Vec[NX]
    t_old: Real  # beginning of the last step
    position_drift: Real  # largest scaled constraint residuals after a step, so far
    velocity_drift: Real
    steps: Count  # accepted
    rejected: Count
    rhs: Count  # evaluations of the right-hand side
    stiff: Count  # tests that found the steps at the border of stability, one in 1000 steps
    culprit: int  # what the status of the last call refers to
    sizes: Vec[NGROUP]  # largest magnitude so far in each scaling group
    lowest: Vec[NX]  # least and largest value of each state at the ends of steps so far
    highest: Vec[NX]
    if NMODE > 0:
        changes: Count  # events so far: times at which a mode changed
        changed: IVec[NMODE]  # 1: this relation changed at the last event
    if NWHEN > 0:
        acts: int  # clauses `when` that acted at the last event
        acted: IVec[NACTS]  # their numbers, in the order in which they acted
    if NLEAP > 0:
        jumps: Count  # clauses that changed the state, so far
        x_before_event: Vec[NX]  # end of the last step, before clauses changed it
    if NCON > 0:
        settlements: Count  # events of contacts so far
        contact_kinds: IVec[NCON]  # what each contact did at the last event
        contact_impulses: Vec[NCON]  # of impacts at that event
        contact_losses: Vec[NCON]  # of energy
        rest_times: Vec[NCON]  # when bounces end that are not followed
        penetration: Real  # depth of a contact beyond its bound, after PENETRATION
    # Private from here on: the library alone reads and writes these fields.
    # The last step
    h_old: Real
    x_old: Vec[NX]
    t_end: Real  # where it ended
    x_end: Vec[NX]
    p: Params
    method: int
    k: Mat[NK, NX]  # rates at the stages
    r: Mat[ND, NX]  # coefficients of the dense output
    rate_place: int  # where the rate at (t, x) is; 0: nowhere, 1: k[0], 2: the last stage
    dense_place: int  # where the dense output is; 0: nowhere, 1: to be computed from k, 2: r
    # This call
    is_new_call: bool  # no step was made since the caller had this state
    steps_before_call: Count
    parameters_known: bool  # p holds the parameters of the last step
    # Step size
    h: Real  # of the next attempt; 0: to be chosen
    error_old: Real  # scaled error of the last accepted step
    longest_step: Real  # longest first attempt so far
    stability_due: Count  # steps to the end of the next test of stability
    rates_apart: Real  # sums of this test
    states_apart: Real
    grid: GridState
    x_new: Vec[NX]  # end of the step that is attempted
    if NNEWTON > 0:
        newton: NewtonState
    if NSERIES > 0:
        series: SeriesState
    # Round-off
    roundoff_estimated: bool  # the error of the last step was compared with its round-off
    roundoff_memory: Real  # 1 when round-off decided on a step; fades with the distance from it to 0
    rate_roundoff: Vec[NX]  # remembered from accepted steps
    if NC > 0:
        rank_deficient: bool  # constraint equations are known to depend on others
    if NMODE > 0:
        # Events
        modes: Vec[NMODE]  # of the next step: sign(z) or floor(z) of each indicator z
        modes_old: Vec[NMODE]  # of the last step
        slack: Vec[NMODE]  # by how much each indicator is beyond its crossing
        after_event: bool  # the last step ended at an event
        is_split: bool  # the last step was the first half of a split one
        event_time_error: Real  # errors of event times by the tolerance
        first_order_time: Real  # times below it are corrected to first order
        t_changed: Real  # time of the last event
        changes_at_time: Count  # events at that time
    if NWHEN > 0:
        conditions: Vec[NWHEN]  # 1: this condition is true
        conditions_known: bool
        short_bounces: Count  # crossings in a row that return within round-off of the sizes of states
        crossing_times: Vec[NFREE]  # last crossing of each indicator that depends on the state
    if NCON > 0:
        fall_heights: Vec[NCON]  # the largest that each contact fell from
        touch_times: Vec[NCON]  # when each contact touched last
        bounce_speeds: Vec[NCON]  # after the last impact of each contact; 0: there was none
        if NTWO > 0:
            normal_signs: IVec[NCON]  # of the next step
            normal_signs_old: IVec[NCON]  # of the last step
        if NSPACE > 0:
            slips: SlipState
