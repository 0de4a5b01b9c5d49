"""The records of the law of contacts that touch, and of their impacts."""

from lagc.kernels.language.sizes import *
from lagc.kernels.language.words import IVec, Real, Vec, struct


@struct
class ContactLaw:
    """The law of contacts, u = W p + b: a problem, its solution, and the workspace of its solver."""

    count: int  # contacts
    rows: int
    first: IVec[NCON]  # normal row of each contact; its slip rows follow
    slips: IVec[NCON]  # slip rows of each: 0, 1 or 2
    unit: IVec[NCON]  # unit of its gap: a number, the same for the same unit
    two_sided: IVec[NCON]  # it never opens; 1: its normal force has a sign, 2: a direction
    friction: Vec[NCON]  # coefficient of friction while it slips
    static_friction: Vec[NCON]  # the same while it sticks
    moves: IVec[NCON]  # 1: it slips already, along its direction
    direction: Vec[NDIRECT]  # unit vector of the slip
    W: Vec[NDELASSUS]  # by rows
    b: Vec[NCROW]
    terms: Vec[NCROW]  # sum of the magnitudes of the terms of b; 0: not known
    mode: IVec[NCON]  # modes before, then the modes found
    # The solution
    p: Vec[NCROW]  # forces or impulses
    u: Vec[NCROW]  # relative accelerations or velocities
    other_mode: IVec[NCON]  # of a second solution
    culprit: int  # a contact that contradicts others, sinks in, or has several modes
    rank: int  # of the equations
    unknowns: int
    # The equations in given modes
    slides: IVec[NCON]  # 1: the direction of its slip is given
    turns: IVec[NCON]  # 1: its slip direction is an unknown
    turning: bool  # there is such a contact
    sign: IVec[NCON]  # sign of the normal force while it slips: -1 at some two-sided contacts
    mu: Vec[NCON]
    least: Vec[NCON]  # least normal force
    scale: Vec[NCROW]  # of forces
    row_scale: Vec[NCROW]  # of u
    size: Real  # the largest scaled b
    roundoff: Real  # of scaled b
    contact: IVec[NCROW]  # contact of each unknown
    unknown: IVec[NCROW]  # its row; `rows`: a slip angle
    matrix: Vec[NDELASSUS]
    right: Vec[NCROW]
    step: Vec[NCROW]
    order: IVec[NCROW]  # of the rows of the matrix
    # The search of modes
    choice: IVec[NCON]
    kept_mode: IVec[NCON]
    kept_p: Vec[NCROW]
    kept_u: Vec[NCROW]
    # Shares of a load: the smallest forces in the cones
    share: Vec[NCROW]
    pull: Vec[NCROW]  # what is projected on the cones
    place: IVec[NCROW]  # where it is
    metric: Vec[NCROW]
    dual: Vec[NCROW]
    dual_before: Vec[NCROW]
    left: Vec[NCROW]  # load that is not borne
    factor: Vec[NDELASSUS]
    share_terms: Real
    block: IVec[NCON]  # of contacts that rows connect: the number of one of them
    row_block: IVec[NCROW]
    block_now: int  # that is solved
    shared: IVec[NCON]  # 1: its block bears its load in many ways
    lack: Vec[NCON]  # load that no forces of its block bear


@struct
class ImpactWork:
    """Workspace of an impact of the contacts of a law: its rounds, and what it takes."""

    hits: ContactLaw  # of the contacts that take part in a round
    contact: IVec[NCON]  # number of each of them among all contacts
    restitution: Vec[NCON]  # of all contacts
    if NPOISSON > 0:
        poisson: IVec[NCON]  # 1: Poisson's law, 0: Newton's law
    loss: Vec[NCON]  # energy that each contact took
    rounds: int
    terms: Vec[NCROW]  # of u
    u_before: Vec[NCROW]  # of a round
    p_before: Vec[NCROW]
