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
    stage: IVec[NU]  # in which an unknown is found: 0 positions, 1 speeds, 2 unstated speeds without inertia
    scaling: Vec[NU]  # the size of each unknown
    unit_size: Vec[NU]  # by number of the unit
    reached: IVec[NU]  # 1: of the part of the equations that is solved
    ordered: IVec[NU]  # all unknowns, coupled ones side by side
    columns: IVec[NU]  # the unknowns of the matrix
    column_count: int
    column_of: IVec[NU]  # the column of each unknown, -1: none
    # Points of the search.
    trial: Vec[NU]
    begun: Vec[NU]
    ended: Vec[NU]  # where the attempt from the guess ended
    last: Vec[NU]  # the same of the last part that was not met
    best: Vec[NU]
    before: Vec[NU]
    step: Vec[NU]
    step_scaling: Vec[NU]  # weights of the unknowns in a least-norm step
    work: int  # number of factorizations
    # The equations that are asked for, stage by stage.
    asked: IVec[NE]  # 1: this equation counts
    rows: IVec[NE]
    stage_begin: IVec[FOUR]  # in rows
    # Residuals, their Jacobian by rows, and the sizes of their terms.
    c: Vec[NE]
    J: Vec[NJ]
    other_J: Vec[NJ]
    roundoff: IVec[NJ]  # 1: a derivative that is round-off
    term_sizes: Vec[NE]
    row_scaling: Vec[NE]
    share: Real  # weight of the sizes of the unknowns in it
    worst: Real  # the largest relative residual
    column: IVec[NJ]  # the unknown of each derivative
    # The least-norm problem.
    matrix: Mat[NE, NROW]
    orthogonal: Mat[NE, NROW]  # remainders of the rows, then orthonormal rows
    right: Vec[NE]
    lengths: Vec[NE]  # of the rows, before they are normalized
    first_column: IVec[NE]  # the nonzero range of a row
    end_column: IVec[NE]
    first_nonzero: IVec[NE]  # the same, of w.orthogonal
    end_nonzero: IVec[NE]
    remaining: Vec[NE]  # squared length of the remainder; 0: chosen; -1: dropped
