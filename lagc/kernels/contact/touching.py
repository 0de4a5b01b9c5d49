"""Motion with contacts that touch: rates, forces and projection.

The rows R of contacts that touch stay out of the compiled elimination. For K = [M G^T; G 0],

    X = K^-1 R^T      W = R X      0 = W p + R a0 + bias      a = a0 + X p

where a0 is the acceleration without them: the matrix W of G. Delassus, Memoire sur la theorie des liaisons
finies unilaterales, Ann. Sci. Ecole Norm. Sup. 34 (1917) 95-179. An open contact costs its gap alone.
"""

from math import fabs, sqrt

from lagc.kernels.arithmetic.quaternions import normalise
from lagc.kernels.constraints.projection import project
from lagc.kernels.contact.kept_blocks import keep_block, recall_blocks, recall_rates
from lagc.kernels.contact.law import CONTACT_SLIPS, CONTACT_STICKS, shares_force, solve_frozen
from lagc.kernels.contact.modes import LAW_FOUND, LAW_NONE, set_law
from lagc.kernels.contact.normal_forces import set_normals_given, solve_touching
from lagc.kernels.contact.responses import (
    add_cancelling,
    keep_begin,
    largest_scaled,
    loads_follow,
    move_with_loads,
    reactions_agree,
    respond,
    response_to_forces,
    set_accelerations,
    set_delassus,
    set_loads,
    set_responses,
    store_power,
)
from lagc.kernels.contact.shares import AT_BOUND, share_load
from lagc.kernels.dynamics.loaded_reactions import MOST_LOAD_STEPS, motion_at
from lagc.kernels.dynamics.rhs import rhs_at
from lagc.kernels.events.sampled_indicators import add_sample, forget_samples
from lagc.kernels.language.vocabulary import *

MOST_SEATINGS = 4  # Newton iterations of the gaps of contacts that touch


def find_touching(x: Vec[NX], w: Work) -> bool:
    """Set w.contacts.touched and w.contacts.modes by the modes in x, which may be perturbed by round-off.
    Return whether any contact touches."""
    # In flight they are those of the beginning of the step.
    if w.contacts.flies:
        return w.contacts.touches
    found = False
    for i in range(NCON):
        # Modes are exactly -1, 0, 1 or 2; thresholds between them allow for perturbations of x, by which
        # round-off is estimated.
        mode = x[NX - NCON + i]
        w.contacts.touched[i] = 1 if fabs(mode) > 0.5 else 0
        w.contacts.modes[i] = -1 if mode < 0.0 else 1
        if w.contacts.touched[i] == 0 or mode > 1.5:
            w.contacts.modes[i] = 2 * w.contacts.touched[i]
        if w.contacts.touched[i] > 0:
            found = True
    return found


def list_blocks(first: int, last: int, sliding: bool, w: Work) -> None:
    """List the contacts in w.contacts.touched of blocks first..last - 1 for the law, closed in the modes
    w.contacts.modes and without friction, and with slip rows if `sliding`; else for displacements, which
    bounds of velocities do not restrict."""
    law = w.contacts.law
    w.contacts.first_block = first
    w.contacts.last_block = last
    w.contacts.slots = 0
    # Entry n of the law is contact touching[n]; its row r is row touching_rows[r] of all contacts, and row
    # slot[r] of its block.
    n = 0
    m = 0
    block = first
    slot = 0
    for c in range(contact_begin[first], contact_end[last - 1]):
        i = block_contact[c]
        if w.contacts.touched[i] > 0 and (sliding or contact_bounds_rate[i] == 0):
            if contact_block[i] != block:
                block = contact_block[i]
                slot = 0
            w.contacts.touching[n] = i
            law.first[n] = m
            law.slips[n] = contact_slips[i] if sliding else 0
            law.two_sided[n] = 0
            law.unit[n] = contact_unit[i]
            law.friction[n] = 0.0
            law.static_friction[n] = 0.0
            law.moves[n] = 0
            sticks = w.contacts.modes[i] == 2 and law.slips[n] > 0
            law.mode[n] = CONTACT_STICKS if sticks else CONTACT_SLIPS
            law.direction[2 * n] = -1.0 if w.contacts.modes[i] < 0 else 1.0
            law.direction[2 * n + 1] = 0.0
            for k in range(law.slips[n] + 1):
                w.contacts.touching_rows[m] = contact_first[i] + k
                w.contacts.slot[m] = slot
                slot += 1
                m += 1
            if slot > w.contacts.slots:
                w.contacts.slots = slot
            n += 1
    law.count = n
    law.rows = m


def list_contacts(sliding: bool, w: Work) -> None:
    """List the contacts in w.contacts.touched of all blocks."""
    list_blocks(0, size(NBLOCK), sliding, w)


def set_slip_directions(w: Work) -> None:
    """Let the listed contacts that slip in space do so along their velocities. In a step these are taken
    beyond a stop: a velocity against that at its beginning has the same direction as this one. A velocity
    that is round-off has the direction at the beginning."""
    for n in range(w.contacts.law.count):
        i = w.contacts.touching[n]
        if contact_slips[i] == 2:
            # The velocity along both slip rows, and its length.
            one = w.contacts.speeds[contact_first[i] + 1]
            other = w.contacts.speeds[contact_first[i] + 2]
            size = sqrt(one * one + other * other)
            # Within a step the direction must be a smooth function of x, also where the velocity is round-off
            # or beyond the stop: a right-hand side that turns by 180 degrees there would look like an error
            # of the step.
            if w.modes_fixed:
                if w.contacts.slips_held or size <= w.contacts.slip_roundoff[i]:
                    one = w.contacts.slip_axes[2 * i]
                    other = w.contacts.slip_axes[2 * i + 1]
                    size = 1.0
                elif one * w.contacts.slip_axes[2 * i] + other * w.contacts.slip_axes[2 * i + 1] < 0.0:
                    size = -size
            w.contacts.law.direction[2 * n] = one / size if size != 0.0 else 0.0
            w.contacts.law.direction[2 * n + 1] = other / size if size != 0.0 else 0.0


def slip_relation(i: int) -> int:
    """Return the first relation of the slip of a contact with friction; it has one for each slip row."""
    return NMODE - NCON - NSLIP + contact_first[i] - i


def slip_along(i: int, rates: Vec[NMODE], w: Work) -> Real:
    """Return the part of these rates of relations along the direction in which a contact slips in space."""
    k = slip_relation(i)
    return w.contacts.slip_axes[2 * i] * rates[k] + w.contacts.slip_axes[2 * i + 1] * rates[k + 1]


def list_frictions(w: Work) -> None:
    """Set the friction of the listed contacts to w.contacts.frictions."""
    if NSLIP > 0:
        for n in range(w.contacts.law.count):
            w.contacts.law.friction[n] = w.contacts.frictions[2 * w.contacts.touching[n]]
            w.contacts.law.static_friction[n] = w.contacts.frictions[2 * w.contacts.touching[n] + 1]


def set_frictions(p: Params, t: Real, x: Vec[NX], w: Work) -> None:
    """Set the friction of the listed contacts at (t, x)."""
    if NSLIP > 0:
        fn_frictions_on(p, t, x, w.modes, w.contacts.frictions)
        list_frictions(w)


def cone_margin(i: int, w: Work) -> Real:
    """Return how much more friction a contact that sticks could bear, by w.contacts.forces."""
    margin = 0.0
    if NSLIP > 0:
        row = contact_first[i]
        force = fabs(w.contacts.forces[row + 1])
        if NSPACE > 0:
            if contact_slips[i] == 2:
                other = w.contacts.forces[row + 2]
                force = sqrt(force * force + other * other)
        margin = w.contacts.frictions[2 * i + 1] * w.contacts.forces[row] - force
    return margin


def bear_load(w: Work) -> None:
    """Let contacts that bear their load in many ways do so by the smallest forces within their cones. If
    these do not bear it, modes change: the forces stay, as if the cones were wider, and w.contacts.law.lack
    is not zero."""
    law = w.contacts.law
    for n in range(law.count):
        if law.mode[n] == CONTACT_STICKS:
            law.mu[n] = law.static_friction[n]
    share_load(w.contacts.law)


def set_margins_of_block(block: int, w: Work) -> None:
    """Set the margins of contacts that share a load. At the bound of a cone the margin is minus the load that
    is left; while some shares bear the load, it is the largest force."""
    law = w.contacts.law
    # The size that forces are compared with is the largest normal force of the block.
    size = 0.0
    slides = False
    for n in range(law.count):
        if law.block[n] == block and fabs(w.contacts.force_margins[w.contacts.touching[n]]) > size:
            size = fabs(w.contacts.force_margins[w.contacts.touching[n]])
    least = AT_BOUND * size
    # If a contact that presses is at the bound of its cone, the block begins to slide there: then contacts at
    # zero force need not open.
    if NSLIP > 0:
        for n in range(law.count):
            i = w.contacts.touching[n]
            if law.block[n] == block and law.mode[n] == CONTACT_STICKS:
                if w.contacts.force_margins[i] > least and w.contacts.cone_margins[i] <= least:
                    slides = True
    # A margin that is zero because the smallest shares put it there is no event while some shares bear the
    # load.
    for n in range(law.count):
        if law.block[n] == block:
            i = w.contacts.touching[n]
            opens = w.contacts.force_margins[i] <= least
            if opens:
                w.contacts.force_margins[i] = size if slides or law.lack[n] == 0.0 else -law.lack[n]
            if NSLIP > 0:
                if law.mode[n] == CONTACT_STICKS and w.contacts.cone_margins[i] <= least:
                    w.contacts.cone_margins[i] = size if opens or law.lack[n] == 0.0 else -law.lack[n]


def force_roundoff(n: int, k: int, w: Work) -> Real:
    """Return the round-off of the force along row k of a listed contact: that of its acceleration over its
    response. It is zero for contacts that share a load, which cross at once, and along a slip that
    constraints hold."""
    law = w.contacts.law
    row = law.first[n] + k
    response = law.W[row * law.rows + row]
    if law.shared[n] > 0 or not response > 0.0:
        return 0.0
    return CONTACT_ROUNDOFF * law.terms[row] / response


def set_margins(w: Work) -> None:
    """Set w.contacts.force_margins and w.contacts.cone_margins of the listed contacts, by w.contacts.forces:
    what falls to zero where they open or slip. Contacts that share a load do so where no shares bear it;
    those of a block that are at the bounds of their cones begin. Set their round-off."""
    law = w.contacts.law
    # Each contact by itself: its normal force, and the friction that is left to it.
    for n in range(law.count):
        i = w.contacts.touching[n]
        w.contacts.force_margins[i] = w.contacts.forces[contact_first[i]]
        w.contacts.force_roundoff[i] = force_roundoff(n, 0, w)
        if NSLIP > 0:
            w.contacts.cone_margins[i] = cone_margin(i, w) if law.mode[n] == CONTACT_STICKS else 0.0
            w.contacts.cone_roundoff[i] = w.contacts.force_roundoff[i]
            for k in range(law.slips[n]):
                w.contacts.cone_roundoff[i] += force_roundoff(n, 1 + k, w)
    if NBESIDE > 0:
        for n in range(law.count):
            if law.shared[n] > 0 and law.block[n] == n:
                set_margins_of_block(n, w)


def take_forces(xdot: Vec[NX], lam: Vec[NC], w: Work) -> None:
    """Add the forces w.contacts.law.p to accelerations and multipliers, and store them in w.contacts.pushes,
    w.contacts.forces and their samples."""
    law = w.contacts.law
    # a = a0 + X p and lam = lam0 + X_lam p. Accelerations that cancel to round-off become zero.
    add_cancelling(xdot, w)
    for i in range(NC):
        for r in range(law.rows):
            if row_block[w.contacts.touching_rows[r]] == equation_block[i]:
                lam[i] += w.contacts.responses[w.contacts.slot[r] * NR + NV + i] * law.p[r]
    for r in range(law.rows):
        w.contacts.pushes[w.contacts.touching_rows[r]] = law.p[r]
        w.contacts.forces[w.contacts.touching_rows[r]] = law.p[r]
    # Where no shares bear the load, those that leave the least of it stand for the forces: their margins tell
    # which contact gives way.
    if NBESIDE > 0:
        for e in range(law.unknowns):
            row = law.unknown[e]
            if law.lack[law.contact[e]] > 0.0:
                w.contacts.forces[w.contacts.touching_rows[row]] = law.scale[row] * law.share[e]
        for n in range(law.count):
            if law.shared[n] > 0:
                w.shared[w.contacts.touching[n]] = 1
    set_margins(w)


def sample_forces(w: Work) -> None:
    """Add the margins of contacts that touch to their ranges."""
    # Forces are sampled at each evaluation: the range of samples takes the place of an enclosure, as a force
    # needs a solve.
    for i in range(NCON):
        if w.contacts.touched[i] > 0:
            add_sample(NMODE - NCON + i, w.contacts.force_margins[i], w)
            if NSLIP > 0:
                if w.contacts.modes[i] == 2 and contact_slips[i] > 0:
                    add_sample(slip_relation(i), w.contacts.cone_margins[i], w)


def open_push(w: Work) -> int:
    """Return a listed contact whose normal force loads depend on and other contacts share; -1 without."""
    for n in range(w.contacts.law.count):
        for k in range(NPUSHED):
            if pushed_contact[k] == w.contacts.touching[n] and shares_force(n, w.contacts.law):
                return n
    return -1


def solve_loaded(
    p: Params, t: Real, x: Vec[NX], rates: Vec[NX], lam: Vec[NC], decides: bool, w: Work
) -> Status:
    """Solve the law of the listed contacts with loads that depend on reactions, by Newton's method for these:
    in the modes w.contacts.law.mode or, if it `decides`, in those that it finds. w.loads.begin is the motion
    without both; `rates` and `lam` become the motion without forces of contacts. Returns PARADOX, with
    w.culprit: a contact; or, counted behind these, a constraint equation or a contact whose force loads leave
    open."""
    # Each turn linearizes the loads at the reactions so far; loads that are linear need one turn alone.
    for turn in range(MOST_LOAD_STEPS):
        status = respond(p, t, x, w)
        if failed(status):
            return status
        begins = False
        # Curved loads begin with the reactions that the motion without them has, so the first turn solves
        # that motion only.
        if NCURVED > 0:
            begins = turn == 0  # with the reactions without these loads
        # The tangent f + D (s' - s) changes the responses and the motion without contacts; then the law is
        # solved as without loads.
        if not begins:
            set_loads(p, t, x, w)
            if not (loads_follow(w) and move_with_loads(rates, lam, w)):
                w.culprit += NCON
                return PARADOX
        set_accelerations(rates, w)
        if decides:
            found = set_law(w.contacts.law)
        else:
            found = LAW_FOUND if solve_frozen(w.contacts.law) else LAW_NONE
        # A first guess without solution is no paradox: the loads may bring one. Its forces are taken as 0.
        if found > LAW_FOUND:
            if not begins:
                w.culprit = w.contacts.touching[w.contacts.law.culprit]
                return PARADOX
            for r in range(w.contacts.law.rows):
                w.contacts.law.p[r] = 0.0
        # If the normal force is one of many, the loads have no value. While modes are decided this may pass.
        if not decides:
            shared = open_push(w)
            if shared >= 0:
                w.culprit = NCON + NC + w.contacts.touching[shared]
                return PARADOX
        # Newton's method ends where the reactions are those that the loads were linearized at.
        agree = reactions_agree(lam, w)
        if NCURVED > 0:
            if begins or not agree:
                agree = False
        else:
            agree = True
        if agree:
            return OK
    w.culprit = NCON + NC + w.contacts.touching[0]
    return PARADOX


def solve_block(p: Params, t: Real, x: Vec[NX], xdot: Vec[NX], lam: Vec[NC], w: Work) -> Status:
    """Add the forces of the listed contacts, in the modes in which they are listed, to xdot and lam. Their
    rows and responses are known."""
    if NSPACE > 0:
        set_slip_directions(w)
    list_frictions(w)
    if NLOADS > 0:
        status = solve_loaded(p, t, x, xdot, lam, False, w)
        if failed(status):
            return status
    else:
        set_delassus(w)
        set_accelerations(xdot, w)
        if NTWO > 0:
            set_normals_given(xdot, lam, w)
        if not solve_touching(w):
            w.culprit = w.contacts.touching[w.contacts.law.culprit]
            return PARADOX
    # Forces that are not unique are the smallest ones in the cones: a rule that depends on x smoothly and not
    # on the order of the contacts.
    if NBESIDE > 0:
        bear_load(w)
    take_forces(xdot, lam, w)
    return OK


def moves_freely(p: Params, t: Real, x: Vec[NX], xdot: Vec[NX], lam: Vec[NC], w: Work) -> Status:
    """Compute xdot and lam with loads that depend on reactions where no contact touches; a culprit of PARADOX
    is counted behind the contacts."""
    status = motion_at(p, t, x, xdot, lam, w)
    if status == PARADOX:
        w.culprit += NCON
    return status


def solve_blocks(p: Params, t: Real, x: Vec[NX], xdot: Vec[NX], lam: Vec[NC], w: Work) -> Status:
    """Add the forces of contacts in w.contacts.touched to accelerations and multipliers, block by block."""
    fn_contact_rows_on(p, t, x, w.modes, w.contacts.rows, w.contacts.speeds, w.contacts.bias)
    if NSLIP > 0:
        fn_frictions_on(p, t, x, w.modes, w.contacts.frictions)
    if NTWO > 0:
        fn_normals_on(p, t, x, w.modes, w.contacts.normal_rows, w.contacts.normal_bias)
    list_contacts(True, w)
    if NLOADS > 0:
        keep_begin(xdot, lam, w)
    else:
        status = set_responses(p, t, x, w)
        if failed(status):
            return status
    for block in range(NBLOCK):
        if NAPART > 0:
            list_blocks(block, block + 1, True, w)
        if w.contacts.law.count > 0:
            status = solve_block(p, t, x, xdot, lam, w)
            if failed(status):
                return status
            keep_block(block, x, xdot, lam, w)
    return OK


def rates_at(p: Params, t: Real, x: Vec[NX], xdot: Vec[NX], lam: Vec[NC], w: Work) -> Status:
    """Compute xdot and lam at (t, x) with the contacts that touch by the modes in x, and their forces."""
    # In flight the forces are those of blocks at rest.
    if w.contacts.flies:
        if NLOADED > 0:
            return moves_freely(p, t, x, xdot, lam, w)
        if not w.contacts.touches:
            return rhs_at(p, t, x, xdot, lam, w)
        status = rhs_at(p, t, x, xdot, lam, w)
        for n in range(w.contacts.constant_count):
            recall_rates(w.contacts.constant[n], xdot, lam, w)
        store_power(p, t, x, xdot, lam, w)
        return status
    # Forces of open contacts are zero, also where this evaluation ends early.
    for r in range(NCROW):
        w.contacts.forces[r] = 0.0
        w.contacts.pushes[r] = 0.0
    # Without contacts these loads are solved by `motion_at`, which is cheaper.
    if NLOADED > 0:
        if not find_touching(x, w):
            return moves_freely(p, t, x, xdot, lam, w)
    status = rhs_at(p, t, x, xdot, lam, w)
    if failed(status) or not find_touching(x, w):
        return status
    if recall_blocks(x, xdot, lam, w):
        status = solve_blocks(p, t, x, xdot, lam, w)
        if failed(status):
            return status
    find_touching(x, w)
    sample_forces(w)
    store_power(p, t, x, xdot, lam, w)
    return OK


def forget_forces(w: Work) -> None:
    """Begin the ranges of forces, and of the friction that is left, anew."""
    if not w.contacts.flies:
        forget_samples(NMODE - NCON - NSLIP, NMODE, w)


def displace_contacts(p: Params, t: Real, x: Vec[NX], w: Work) -> None:
    """Move the coordinates by the displacement X w.contacts.law.p."""
    largest = largest_scaled(w)
    for j in range(NV):
        w.contacts.solution[j] = 0.0
    for block in range(w.contacts.first_block, w.contacts.last_block):
        for c in range(speed_begin[block], speed_end[block]):
            moved = block_speed[c]
            w.contacts.solution[moved] = response_to_forces(moved, block, 0.0, largest, w)
    if HAS_DISPLACE:
        fn_displace(p, t, x, w.contacts.solution, w.contacts.shift)
        for i in range(NQ):
            x[i] += w.contacts.shift[i]
    else:
        for i in range(NQ):
            x[i] += w.contacts.solution[i]
    if NQUAT > 0:
        normalise(x)


def set_gaps(p: Params, t: Real, x: Vec[NX], w: Work) -> None:
    """Set w.contacts.gaps at (t, x), on the modes of relations w.modes."""
    fn_indicators_on(p, t, x, w.modes, w.contacts.indicators)
    for i in range(NCON):
        w.contacts.gaps[i] = w.contacts.indicators[NMODE - NCON + i]


def largest_gap(w: Work) -> Real:
    """Return the largest distance of a listed contact from touching, by the scale of its row."""
    worst = 0.0
    for n in range(w.contacts.law.count):
        own = w.contacts.law.row_scale[w.contacts.law.first[n]] * fabs(
            w.contacts.gaps[w.contacts.touching[n]]
        )
        if not own <= worst:
            worst = own
    return worst


def are_seated(w: Work) -> bool:
    """Return whether the gaps of all listed contacts are zero."""
    for n in range(w.contacts.law.count):
        if w.contacts.gaps[w.contacts.touching[n]] != 0.0:
            return False
    return True


def seat(p: Params, t: Real, x: Vec[NX], w: Work) -> Status:
    """Move the coordinates so that the gaps of the listed contacts are zero, by Newton's method with the
    shortest displacements in the metric of the mass matrix."""
    law = w.contacts.law
    set_gaps(p, t, x, w)
    # Newton's method for the gaps. The rows at each place are their gradients.
    for n in range(MOST_SEATINGS):
        if are_seated(w):
            break
        # The law of displacements: W p + gap = 0 moves each coordinate by X p.
        fn_contact_rows_on(p, t, x, w.modes, w.contacts.rows, w.contacts.speeds, w.contacts.bias)
        status = respond(p, t, x, w)
        if failed(status):
            return status
        for k in range(law.count):
            law.b[law.first[k]] = w.contacts.gaps[w.contacts.touching[k]]
            law.terms[law.first[k]] = 0.0
        solve_frozen(w.contacts.law)
        # Steps go on while they make the largest gap smaller; the last one that does not is taken back.
        before = largest_gap(w)
        w.contacts.x[:] = x
        displace_contacts(p, t, x, w)
        set_gaps(p, t, x, w)
        if not largest_gap(w) < before:
            x[:] = w.contacts.x
            break
    return OK


def stop(p: Params, t: Real, x: Vec[NX], w: Work) -> Status:
    """Remove the rates w.contacts.speeds of the listed rows by the least change of the speeds in the metric
    of the mass matrix."""
    moves = False
    for r in range(w.contacts.law.rows):
        w.contacts.law.b[r] = w.contacts.speeds[w.contacts.touching_rows[r]]
        w.contacts.law.terms[r] = 0.0
        if w.contacts.law.b[r] != 0.0:
            moves = True
    if not moves:
        return OK
    status = respond(p, t, x, w)
    if failed(status):
        return status
    solve_frozen(w.contacts.law)
    add_cancelling(x, w)
    return OK


def close(p: Params, t: Real, x: Vec[NX], w: Work) -> Status:
    """Change the speeds so that the gaps of the listed contacts keep their lengths, and those that stick do
    not slip, by the least change in the metric of the mass matrix."""
    fn_contact_rows_on(p, t, x, w.modes, w.contacts.rows, w.contacts.speeds, w.contacts.bias)
    return stop(p, t, x, w)


def put_on_constraints(p: Params, t: Real, x: Vec[NX], sizes: Vec[NGROUP], w: Work) -> Status:
    """Project x onto the constraints and onto the contacts that touch by the modes in x."""
    status = project(p, t, x, sizes, w)
    if failed(status) or w.contacts.flies or not find_touching(x, w):
        return status
    # Blocks do not move each other's gaps: those of all are known at once.
    set_gaps(p, t, x, w)
    for block in range(NBLOCK):
        list_blocks(block, block + 1, False, w)
        if not are_seated(w):
            status = seat(p, t, x, w)
            if failed(status):
                return status
    fn_contact_rows_on(p, t, x, w.modes, w.contacts.rows, w.contacts.speeds, w.contacts.bias)
    for block in range(NBLOCK):
        list_blocks(block, block + 1, True, w)
        if w.contacts.law.count > 0:
            status = stop(p, t, x, w)
            if failed(status):
                return status
    return OK


@public
def seated(p: Params, t: Real, x: Vec[NX], w: Work) -> Status:
    """Project x, which is near them, onto the constraints and onto the contacts that touch by x."""
    sizes = vector(NGROUP)
    for i in range(NGROUP):
        sizes[i] = 0.0
    enlarge_sizes(x, sizes)
    fn_modes(p, t, x, w.modes)
    return put_on_constraints(p, t, x, sizes, w)
