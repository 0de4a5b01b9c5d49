"""The workspace of the initialization."""

from lagc.kernels.language.vocabulary import *

# Priority of a start value: in a conflict the lower level gives way; FIXED never does.
UNSTATED = Code(0)
DECLARED = Code(1)
SCENE = Code(2)
RUN = Code(3)
FIXED = Code(4)


@struct
class StartWork:
    """Workspace of lagc_consistent. Its initial content does not matter."""

    # Of a failure: the equation with the largest residual; of NOT_FINITE the index in q, v and the stated
    # rates; of INVALID see LAGC_BAD_...
    culprit: int
    # The unknowns: q, v, and the stated rates.
    free: IVec[NU]  # 1: this value may have moved
    y: Vec[NU]
    guess: Vec[NU]
    levels: IVec[NU]
    part: IVec[NU]  # 1: of a quaternion, behind its first
    unknowns: IVec[NU]  # those of the selected equations
    unknown_count: int
    ordered: IVec[NU]  # the same, coupled ones side by side
    columns: IVec[NU]  # the unknowns of the matrix
    column_count: int
    column_of: IVec[NU]  # the column of each unknown, -1: none
    candidates: IVec[NU]  # stated values of one level that may move
    picked: IVec[NU]
    marks: IVec[NU]
    # Scaling.
    scaling: Vec[NU]  # the size of each unknown
    unit_scaling: Vec[NU]  # the same, alike in a unit
    step_scaling: Vec[NU]  # weights of the unknowns in a least-norm step
    unit_size: Vec[NU]  # by number of the unit
    magnitude: Vec[NU]  # how large each unknown may be
    # Points of the search.
    begin: Vec[NU]
    best: Vec[NU]
    trial: Vec[NU]
    tried: Vec[NU]
    saved: Vec[NU]
    restored: Vec[NU]
    combined: Vec[NU]  # the starts of all blocks
    block_begin: Vec[NU]
    free_before: IVec[NU]
    step: Vec[NU]
    moves: Vec[NU]
    least_residual: Real  # of attempts that failed
    most_residual: Real
    nearest: Real  # distance of the best start from the guess, scaled
    work: int  # number of factorisations
    full_steps: bool  # no line search
    # The selected equations; equations of positions come first.
    rows: IVec[NE]
    row_count: int
    position_rows: int
    all_rows: IVec[NE]
    selected: IVec[NE]
    block: IVec[NE]
    if NMASSLESS > 0:
        held: IVec[NU]  # 1: a speed with inertia that waits for speeds without
        whole: IVec[NE]  # the equations of both
    if NPIECE > 0:
        first_piece: int  # groups that are evaluated alone
        end_piece: int
    # Residuals, their Jacobian by rows, and the sizes of their terms.
    c: Vec[NE]
    J: Vec[NJ]
    term_sizes: Vec[NE]
    trial_c: Vec[NE]
    trial_J: Vec[NJ]
    trial_term_sizes: Vec[NE]
    guess_term_sizes: Vec[NE]
    row_scaling: Vec[NE]
    roundoff: Vec[NE]  # a residual up to it is 0
    residual_roundoff: Vec[NE]  # of parameters, at the guess
    slope_roundoff: Vec[NJ]  # the same, of J
    entry_roundoff: Vec[NJ]  # the same, of positions too
    column: IVec[NJ]  # the unknown of each derivative
    equation_of: IVec[NJ]
    previous: IVec[NJ]  # the derivative before by the same unknown
    last: IVec[NU]
    # The least-norm problem.
    matrix: Mat[NE, NROW]
    orthogonal: Mat[NE, NROW]  # remainders of the rows, then orthonormal rows
    right: Vec[NE]
    chosen: IVec[NE]
    first_column: IVec[NE]  # the nonzero range of a row
    end_column: IVec[NE]
    first_nonzero: IVec[NE]  # the same, of w.orthogonal
    end_nonzero: IVec[NE]
    by_first: IVec[NE]
    first_counts: IVec[NROW]
    reach_so_far: IVec[NE]
    neighbours: IVec[NE]
    remaining: Vec[NE]  # squared length of the remainder; -1: none
    tournament: IVec[NTREE]
    dropped_rows: int  # dependent rows of the last step
