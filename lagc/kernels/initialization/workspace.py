"""What the search for a consistent start keeps."""

from __future__ import annotations

from lagc.kernels.language.sizes import NE, NJ, NPIECE, NROW, NTREE, NU
from lagc.kernels.language.words import Code, IVec, Mat, Real, Vec, record

# How firmly a start value is stated: in a conflict the smaller gives way, FIXED never does.
UNSTATED = Code(0)
DECLARED = Code(1)
SCENE = Code(2)
RUN = Code(3)
FIXED = Code(4)


@record
class StartWork:
    """Room for lagc_consistent; no need to fill it."""

    # Of a failure: the condition that is missed most; of NOT_FINITE the index in q, v and the stated
    # rates; of INVALID see LAGC_BAD_...
    culprit: int
    loose: IVec[NU]  # 1: this value may have moved
    y: Vec[NU]  # q, v, and the stated rates
    levels: IVec[NU]
    part: IVec[NU]  # 1: of a quaternion, behind its first
    own: IVec[NU]  # the unknowns that the rows hold, and how many they are
    owned: int
    places: IVec[NU]
    picked: IVec[NU]
    values: IVec[NU]
    columns: IVec[NU]
    line: IVec[NU]  # those of own, near each other where conditions tie them
    marks: IVec[NU]
    let: IVec[NU]
    home: Vec[NU]  # the guess
    weights: Vec[NU]
    widths: Vec[NU]
    scale: Vec[NU]  # how far an unknown moves where others could move instead
    common: Vec[NU]
    reach: Vec[NU]  # how large each unknown may be
    moves: Vec[NU]
    now: Vec[NU]
    best: Vec[NU]
    trial: Vec[NU]
    turned: Vec[NU]
    step: Vec[NU]
    kept: Vec[NU]
    held: Vec[NU]
    reached: Vec[NU]
    answer: Vec[NU]
    least: Real  # what attempts missed
    most: Real
    nearest: Real  # start of these, in weights from the guess
    work: int  # factorisations so far
    whole: bool  # steps are not halved: all is met next to there or not at all
    count: int  # of columns
    left_out: int  # rows that the last step does without
    positions: int  # of the rows that follow: conditions of positions come first
    ended: int  # where the rows end: those of one part
    if NPIECE > 0:
        first_piece: int  # of those that the rows are of, and behind the last
        end_piece: int
    rows: IVec[NE]
    all: IVec[NE]
    order: IVec[NE]
    group: IVec[NE]
    chosen: IVec[NE]
    begins: IVec[NE]  # where rows of the matrix begin to differ from zero, and where they cease to
    stops: IVec[NE]
    lows: IVec[NE]  # the same of rests
    highs: IVec[NE]
    sorted: IVec[NE]  # rows by where they begin, and how far those up to there reach
    behind: IVec[NE]
    near: IVec[NE]
    firsts: IVec[NROW]  # of these, those that begin at a place
    longest: IVec[NTREE]
    squares: Vec[NE]
    c: Vec[NE]  # of the rows alone, as sizes, J and those of a trial
    sizes: Vec[NE]
    scales: Vec[NE]
    floors: Vec[NE]
    terms: Vec[NE]  # of each condition at the guess
    trial_c: Vec[NE]
    trial_sizes: Vec[NE]
    right: Vec[NE]
    column: IVec[NJ]  # the unknown of each derivative, its condition, and the one before by the same unknown
    owner: IVec[NJ]
    before: IVec[NJ]
    last: IVec[NU]
    J: Vec[NJ]
    trial_J: Vec[NJ]
    doubts: Vec[NE]  # what last places of parameters change residuals by
    doubted: Vec[NJ]  # and derivatives
    blurs: Vec[NJ]  # the same, where speeds are sought of positions too
    matrix: Mat[NE, NROW]
    rests: Mat[NE, NROW]
