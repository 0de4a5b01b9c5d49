"""The records of a run: options, workspace, state of a trajectory, and one attempted step."""

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
class Work:
    """Workspace of the functions below.  Fill it with zeros before the first use.  It may serve any states
    in any order: between calls it keeps nothing, except from lagc_assemble to lagc_solve."""

    culprit: int  # what a status refers to: an index of v or x, or a constraint equation
    fallbacks: Count  # linear solves that used the slower, rank-revealing factorization
    if NC > 0:
        redundant: IVec[NC]  # 1: this constraint equation was found to depend on others
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
        # Solves with [M G^T; G 0]
        kkt_rhs: Vec[NR]
        kkt_solution: Vec[NR]
        rank_deficient: bool  # constraint equations are known to depend on others
        is_assembled: bool  # the factors of this projection exist
        if NM > 0:
            is_dense: bool  # the factors are those of the rank-revealing factorization
        else:
            kkt_residual: Vec[NR]
            kkt_correction: Vec[NR]
        # Constraint rows and their scales
        row_scales: Vec[NC]  # of the residuals
        rate_scales: Vec[NC]  # of the residual rates
        reaches: Vec[NREACH]  # change of each row over the sizes of the states
        gamma_sizes: Vec[NC]  # sum of the magnitudes of the terms of gamma
        regularity: Vec[NC]  # 1; less for a degenerate row, whose gradient nearly vanishes
        constraint_violation: Real  # scaled distance of x from the constraints
        group_sizes: Vec[NGROUP]
        row_values: Vec[NC]
        row_buffer: Vec[NC]
        row_buffer2: Vec[NC]
        redundant_before: IVec[NC]
        if NM > 0:
            # Rank-revealing factorization L^-1 G^T = Q F diag(row_lengths)
            q_rows: Mat[NC, NV]  # Q^T
            q_begin: IVec[NC]  # first and last column of each row of Q^T that is not zero
            q_end: IVec[NC]
            q_factor: Mat[NC, NC]  # F
            row_lengths: Vec[NC]
            row_order: IVec[NC]  # pivot order
            rank: Size
            penalty: Real  # > 0: L is the factor of M + penalty G^T G
            dependence: Mat[NC, NC]  # dependent rows as combinations of the independent ones
            normal_matrix: Mat[NC, NC]
            row_rhs: Vec[NC]
            mu: Vec[NC]
        # Projection
        x_candidate: Vec[NX]
        dq: Vec[NQ]
    position_residual: Real  # largest scaled residuals after a projection
    velocity_residual: Real
    # Error of a step
    trial_sizes: Vec[NGROUP]  # s->sizes, with the new state included
    error_weights: Vec[NX]
    longest_step: Real  # over which groups at rest are extrapolated; 0: they are not
    rate_roundoff: Vec[NX]  # round-off of the rates in the error weights of this attempt
    coordinate_roundoff: Vec[NX]  # residual of the projection of coordinates, divided by the step size
    if NH > 0:
        error_parts: Mat[TWO, NX]  # the two error estimates of the step
        error_parts_before: Mat[TWO, NX]  # those of the step before it was perturbed
        x_perturbed: Vec[NX]
    if NNEWTON > 0:
        # Implicit methods
        loosening: Real  # of the estimated error over that of the weights
        newton_tolerance: Real  # scaled error of the stages
        newton_rtol: Real  # in their weights
        newton_most: int  # iterations
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
    if NSERIES > 0:
        # Taylor series
        values: Vec[NVALUE]  # of the state, for all orders
        scaled: Vec[NSERIES]  # scale times the rates of an order; k, 1/k, the coefficient of time
        end_slopes: Vec[NX]  # of the polynomial
        rates_next: Vec[NX]
        sums: Vec[NCONVOLVED]  # of products of coefficients, lanes, then squares
        left: Mat[NTERM, NLANE]  # coefficients of both factors of each lane
        right: Mat[NTERM, NLANE]
        squares: Mat[NTERM, NSQUARE]
    if NMODE > 0:
        # Modes of relations
        modes: Vec[NMODE]
        modes_fixed: bool  # evaluations keep these modes; else they follow the state
        indicators: Vec[NMODE]  # event indicators
        indicator_rates: Vec[NMODE]
        crossed: IVec[NMODE]  # 1: this indicator crosses zero, or an edge, at the end of the step
        indicators_before: Vec[NMODE]  # in the modes that were looked at before
        indicator_jumped: IVec[NMODE]  # 1: this indicator changed with the modes of others
        candidate_modes: Vec[NMODE]
        sliding_candidates: IVec[NFREE]  # 1: this indicator reaches zero at the same time
        # The modes that an event leaves
        old_indicators: Vec[NMODE]
        old_indicator_rates: Vec[NMODE]
        old_rates: Vec[NX]  # of the state
    if NLOADS > 0:
        # Loads that depend on reactions
        if NLOADED > 0:
            load_free: Vec[NC]  # multipliers without them
        load_lam: Vec[NC]
        load_force: Vec[NV]
        load_slopes: Vec[NLOADSLOPES]  # derivatives of the forces by these reactions, one after the other
        if NLOADED > 0:
            load_rhs: Vec[NR]
            load_answer: Vec[NR]
            load_total: Vec[NR]  # accelerations and multipliers that the loads add
            load_columns: Vec[NLOADCOLUMNS]
            load_matrix: Vec[NLOADMATRIX]
            load_sizes: Vec[NLOADMATRIX]  # of the terms of its entries
            load_step: Vec[NLOADED]
            load_reach: Vec[NLOADED]  # of the terms of each multiplier
        if NCON > 0:
            load_begin: Vec[NR]  # accelerations and multipliers without loads and contacts
            load_rest: Vec[NV]  # forces at reactions of zero, by their slopes
            load_pushes: Vec[NCROW]
            if NLOADED > 0:
                load_matrix_kept: Vec[NLOADMATRIX]
                load_sizes_kept: Vec[NLOADMATRIX]
    if NLATE > 0:
        # Relations that accelerations or reactions decide
        late_values: Vec[NLATE]  # their indicators
        late_modes: Vec[NLATE]  # modes that these give
        late_here: Vec[NLATE]
        late_low: Vec[NLATE]  # range over the samples of a part of a step
        late_high: Vec[NLATE]
        late_known: Vec[NKNOWN]
        late_x: Vec[NX]
        late_rates: Vec[NX]
        late_lam: Vec[NC]
    if NEDGES > 0:
        edges: Vec[NEDGES]  # lower and upper edge of the mode of each stepwise relation
        old_edges: Vec[NEDGES]
    if NTIMED > 0:
        # Relations of time alone
        indicator_slopes: Vec[NTIMED]
        event_times: Vec[NTIMED]
    if NFREE > 0:
        # Detection of zero crossings
        enclosures: Vec[NENDS]  # lower and upper bound of each indicator in the box
        margins: Vec[NFREE]  # distance of each indicator from its crossing, negative beyond it
        margin_changes: Vec[NFREE]
        indicator_roundoff: Vec[NFREE]  # change of each indicator by one unit in the last place of (t, x)
    if NWHEN > 0:
        # Clauses `when`
        conditions: Vec[NWHEN]  # 1: this condition is true
        triggered: IVec[NWHEN]  # 1: it has become true
        indicator_reset: IVec[NFREE]  # 1: a clause changed this indicator at this event
        clauses_first: bool  # clauses act on a crossing that forces drive back
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
    if NCON > 0:
        # Contacts
        touched: IVec[NCON]  # 1: it touches
        contact_modes: IVec[NCON]  # 0 open, 1 or -1 slips forwards or backwards, 2 sticks; 1 without friction
        touching: IVec[NCON]  # the listed contacts
        touching_rows: IVec[NCROW]  # their rows
        contact_rows: Vec[NGRADIENTS]  # gradients of the rows by the speeds
        contact_speeds: Vec[NCROW]  # rates of the rows
        contact_bias: Vec[NCROW]  # accelerations of the rows where those of the speeds are 0
        contact_gaps: Vec[NCON]
        contact_indicators: Vec[NMODE]
        contact_sizes: Vec[NCON]  # change of each gap over the sizes of the states
        contact_approach: Vec[NCON]  # speed before an impact
        contact_responses: Vec[NRESPONSES]  # accelerations and multipliers for a unit of each listed row
        contact_rhs: Vec[NR]
        contact_solution: Vec[NR]
        contact_shift: Vec[NQ]
        contact_forces: Vec[NCROW]  # at the last evaluation
        force_margins: Vec[NCON]  # zero where a contact opens: its normal force, or a measure of its set
        force_low: Vec[NCON]  # range of the normal forces over the evaluations of a step
        force_high: Vec[NCON]
        x_contact: Vec[NX]
        contact_rates: Vec[NX]
        contact_lam: Vec[NC]
        # Contacts at an event
        contact_hit: IVec[NCON]  # what has happened, by the kinds in `slips`
        contacts_acted: bool  # at this event already
        contacts_go_on: bool  # speeds have not jumped: contacts that touched before keep touching
        modes_before: Vec[NMODE]  # of relations, before the event
        indicators_unmoved: IVec[NMODE]  # 1: contacts do not change it
        contact_near: IVec[NCON]
        contact_leaves: IVec[NCON]
        contact_closed: IVec[NCON]  # as contact_modes
        contact_rests: IVec[NCON]
        contact_struck: Vec[NCON]  # impulse
        contact_lost: Vec[NCON]  # energy
        contact_energies: Vec[THREE]
        restitutions: Vec[NCON]
        if NSLIP > 0:
            # Friction
            frictions: Vec[NDIRECT]  # of slip and of sticking, of each contact
            contact_slides: Vec[NDIRECT]  # direction in which a contact begins to slip, by its force
            cone_margins: Vec[NCON]  # what falls to zero where it slips
            cone_low: Vec[NCON]  # range of static friction less force over the evaluations of a step
            cone_high: Vec[NCON]
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
        x_settled: Vec[NX]
        rates_settled: Vec[NX]
        # Law of contacts that touch: u = W p + b. First the problem
        law_count: int  # contacts that touch
        law_rows: int  # their rows
        law_first: IVec[NCON]  # normal row of each; its slip rows follow
        law_slips: IVec[NCON]  # slip rows of each: 0, 1 or 2
        law_unit: IVec[NCON]  # unit of its gap: a number, the same for the same unit
        law_two_sided: IVec[NCON]  # it never opens; 1: its normal force has a sign, 2: a direction
        law_friction: Vec[NCON]  # coefficient of friction while it slips
        law_static: Vec[NCON]  # the same while it sticks
        law_moves: IVec[NCON]  # 1: it slips already, along law_direction
        law_direction: Vec[NDIRECT]  # unit vector of the slip
        law_w: Vec[NDELASSUS]  # W by rows
        law_b: Vec[NCROW]
        law_sizes: Vec[NCROW]  # sum of the magnitudes of the terms of b; 0: not known
        law_mode: IVec[NCON]  # modes before, then the modes found
        # Its solution
        law_p: Vec[NCROW]  # forces or impulses
        law_u: Vec[NCROW]  # relative accelerations or velocities
        law_other_mode: IVec[NCON]  # of a second solution
        law_culprit: int  # a contact that contradicts others, sinks in, or has several modes
        law_rank: int  # of the rows of closed contacts
        law_unknowns: int
        # Its solver
        law_slides: IVec[NCON]  # 1: the direction of its slip is given
        law_turns: IVec[NCON]  # 1: its slip direction is an unknown
        law_turning: bool  # there is such a contact
        law_sign: IVec[NCON]  # sign of the normal force while it slips: -1 at some two-sided contacts
        law_mu: Vec[NCON]
        law_least: Vec[NCON]  # least normal force
        law_scale: Vec[NCROW]  # of forces
        law_row_scale: Vec[NCROW]  # of u
        law_size: Real  # the largest scaled b
        law_roundoff: Real  # of scaled b
        law_contact: IVec[NLAW]  # contact of each unknown
        law_unknown: IVec[NLAW]  # its row; law_rows: a slip angle
        law_matrix: Vec[NLAWS]
        law_right: Vec[NLAW]
        law_step: Vec[NLAW]
        law_order: IVec[NLAW]
        law_choice: IVec[NCON]
        # Shares of a load: the smallest forces in the cones
        law_share: Vec[NLAW]
        law_pull: Vec[NLAW]  # what is projected on the cones
        law_place: IVec[NLAW]  # where it is
        law_metric: Vec[NLAW]
        law_dual: Vec[NLAW]
        law_dual_before: Vec[NLAW]
        law_left: Vec[NLAW]  # load that is not borne
        law_factor: Vec[NLAWS]
        law_share_terms: Real
        law_block: IVec[NCON]  # of contacts that rows connect: the number of one of them
        law_row_block: IVec[NLAW]
        law_block_now: int  # that is solved
        law_shared: IVec[NCON]  # 1: its block bears its load in many ways
        law_lack: Vec[NCON]  # load that no forces of its block bear
        law_kept_mode: IVec[NCON]
        law_kept_p: Vec[NCROW]
        law_kept_u: Vec[NCROW]
        law_kept_direction: Vec[NDIRECT]
        # Impacts: their law and results, then what `impact` keeps of all contacts
        law_restitution: Vec[NCON]
        if NPOISSON > 0:
            law_poisson: IVec[NCON]  # 1: Poisson's law, 0: Newton's law
        law_impulse: Vec[NCROW]
        law_loss: Vec[NCON]  # energy that each contact took
        law_rounds: int
        impact_count: int
        impact_rows: int
        impact_first: IVec[NCON]
        impact_slips: IVec[NCON]
        impact_two_sided: IVec[NCON]
        impact_unit: IVec[NCON]
        impact_friction: Vec[NCON]
        impact_of: IVec[NCON]  # contact of each one in a round
        impact_w: Vec[NDELASSUS]
        impact_u: Vec[NCROW]
        impact_u_before: Vec[NCROW]  # of a round
        impact_p_before: Vec[NCROW]
        impact_sizes: Vec[NCROW]  # of the terms of u
    if NSEARCH > 0:
        # Parts of a step
        box: Vec[NBOX]  # lower ends of time and states, then upper ends
        x_trial: Vec[NX]
        x_part_begin: Vec[NX]
        x_part_middle: Vec[NX]
        x_part_end: Vec[NX]


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
    grid_begin: Real  # grid of fixed steps
    grid_step: Real  # negative backwards; 0: there is no grid
    grid_index: Count  # points that were passed
    grid_rest: Real  # size of the step to the next point
    grid_goal: Count  # the point where the call ends, or grid_index if it ends at none
    grid_stride: Count  # points that the last call passed
    x_new: Vec[NX]  # end of the step that is attempted
    if NNEWTON > 0:
        # Implicit methods
        kept_step: Count  # steps behind which the stages of the last one are kept; -1: none
        jacobian_step: Count  # steps at which the derivatives were computed; -1: not known
        factored: Real  # step size of the factors; 0: none
        newton_count: int  # iterations of the last step
        newton_eta: Real  # sum of the increments that follow over the last one
        newton_theta: Real  # ratio of two increments
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
    if NSERIES > 0:
        # Taylor series
        series: Mat[NTERM, NX]  # coefficients of the states, in the time over series_scale
        series_scale: Real
        series_part: Real  # size of the last step over it
        series_size: Real  # that the coefficients admit
        series_tolerance: Real
        series_ratio: Real  # of successive terms at the end of a step
        series_fall: Real  # its power k, for the least order k that the radius is estimated from
        series_order: Count
        series_step: Count  # steps behind which the coefficients are those of the last one; -1: none
        kept_scale: Real  # of the last step
        kept_order: Count
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
            slip_axes: Vec[NDIRECT]  # of the next step
            slip_roundoff: Vec[NCON]
            slip_errors: Vec[NCON]  # that the last step may have made
            slip_speeds: Vec[NCON]  # at the beginning of the step
            slip_axes_old: Vec[NDIRECT]  # of the last step
            slip_roundoff_old: Vec[NCON]
