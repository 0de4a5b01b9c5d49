"""Responses of the motion to forces along the rows of contacts, with loads that depend on reactions.

For K = [M G^T; G 0] and rows R of contacts, X = K^-1 R^T and W = R X. Loads f(s) of reactions s, which are
multipliers and normal forces of contacts, are linear near given s: f + D (s' - s). A unit of a normal force
then has the response K^-1 (R^T + D_n), and each response is followed by the loads of its multipliers:

    z + K^-1 D_lam s_lam      s_lam = its multipliers, or 0 = these where an actuator holds the row

so that W is no longer symmetric.
"""

from math import fabs

from lagc.kernels.constraints.projection import assemble_at, solve_at
from lagc.kernels.dynamics.loaded_reactions import follow_loads, keep_load_matrix, update_load
from lagc.kernels.dynamics.rhs import assemble_entries, factor_safely, store_rates
from lagc.kernels.language.vocabulary import *
from lagc.kernels.linear_algebra.cholesky import solve_lower, solve_upper

CANCELLED = 64.0  # units in the last place of the terms of an acceleration: it is zero


def factor_motion(p: Params, t: Real, x: Vec[NX], w: Work) -> Status:
    """Factor K at (t, x)."""
    # Sparse factors with constraints are made by `assemble_at`, which falls back on the rank-revealing
    # factorization.
    if NC > 0:
        return assemble_at(p, t, x, w)
    if STRAIGHT:
        assemble_entries(p, t, x, w)
        fn_factor(w.kkt_entries, w.health)
        if w.health[0] >= SINGULAR:
            return OK
        w.culprit = size(NV)
        return SINGULAR_MASS
    return factor_safely(p, t, x, w)


def solve_motion(w: Work) -> None:
    """Solve K w.contacts.solution = w.contacts.rhs."""
    if NC > 0:
        solve_at(w.contacts.rhs, w.contacts.solution, w)
    elif STRAIGHT:
        fn_solve(w.kkt_entries, w.contacts.rhs, w.contacts.solution)
    # Without constraints K is the mass matrix, with its Cholesky factor.
    else:
        w.contacts.solution[:] = w.contacts.rhs
        w.a[:] = part(w.contacts.rhs, 0, NV)
        solve_lower(w, w.a)
        solve_upper(w, w.a)
        w.contacts.solution[:NV] = w.a


def set_responses(p: Params, t: Real, x: Vec[NX], w: Work) -> Status:
    """Compute w.contacts.responses, X by slots, for the rows w.contacts.rows of listed contacts."""
    status = factor_motion(p, t, x, w)
    if failed(status):
        return status
    # X = K^-1 R^T: one factorization, then one solve for each slot. Rows of different blocks move different
    # speeds, so one solve has the responses to a row of each block, side by side (A. R. Curtis, M. J. D.
    # Powell, J. K. Reid, J. Inst. Math. Appl. 13 (1974) 117-119).
    for slot in range(w.contacts.slots):
        for k in range(NR):
            w.contacts.rhs[k] = 0.0
        for r in range(w.contacts.law.rows):
            if w.contacts.slot[r] == slot:
                row = w.contacts.touching_rows[r]
                for c in range(speed_begin[row_block[row]], speed_end[row_block[row]]):
                    j = block_speed[c]
                    w.contacts.rhs[j] = w.contacts.rows[row * NV + j]
        solve_motion(w)
        for k in range(NR):
            w.contacts.responses[slot * NR + k] = w.contacts.solution[k]
    return OK


def set_delassus(w: Work) -> None:
    """Set w.contacts.law.W = R X of the listed rows."""
    law = w.contacts.law
    for r in range(law.rows):
        block = row_block[w.contacts.touching_rows[r]]
        for q in range(law.rows):
            total = 0.0
            other = w.contacts.touching_rows[q]
            if row_block[other] == block:
                for c in range(speed_begin[block], speed_end[block]):
                    j = block_speed[c]
                    total += (
                        w.contacts.rows[other * NV + j] * w.contacts.responses[w.contacts.slot[r] * NR + j]
                    )
            law.W[q * law.rows + r] = total


def respond(p: Params, t: Real, x: Vec[NX], w: Work) -> Status:
    """Compute w.contacts.responses and w.contacts.law.W for the rows w.contacts.rows of listed contacts."""
    status = set_responses(p, t, x, w)
    if not failed(status):
        set_delassus(w)
    return status


def set_accelerations(a: Vec[NX], w: Work) -> None:
    """Set w.contacts.law.b to the accelerations of the listed rows for the rates `a`, and
    w.contacts.law.terms."""
    # b = R a0 + bias. The sum of magnitudes of its terms tells what is round-off in it.
    for r in range(w.contacts.law.rows):
        row = w.contacts.touching_rows[r]
        total = w.contacts.bias[row]
        magnitude = fabs(total)
        for c in range(speed_begin[row_block[row]], speed_end[row_block[row]]):
            j = block_speed[c]
            each = w.contacts.rows[row * NV + j] * a[NQ + j]
            total += each
            magnitude += fabs(each)
        w.contacts.law.b[r] = total
        w.contacts.law.terms[r] = magnitude


def largest_scaled(w: Work) -> Real:
    """Return the largest scaled force of the listed rows."""
    largest = 0.0
    for r in range(w.contacts.law.rows):
        own = fabs(w.contacts.law.p[r]) / w.contacts.law.scale[r]
        if own > largest:
            largest = own
    return largest


def response_to_forces(j: int, block: int, before: Real, largest: Real, w: Work) -> Real:
    """Return a speed, acceleration or displacement of a block with X p added. One that this cancels to
    round-off is zero: what lies at rest has no motion whose error could be measured. The round-off of each
    force is that of the largest one, as they solve equations together."""
    # a + X p with the sum of its terms. |p| is bounded by the largest scaled force: a small force that comes
    # from a system with large ones has their round-off.
    total = before
    terms = fabs(before)
    for r in range(w.contacts.law.rows):
        if row_block[w.contacts.touching_rows[r]] == block:
            response = w.contacts.responses[w.contacts.slot[r] * NR + j]
            total += response * w.contacts.law.p[r]
            terms += fabs(response) * w.contacts.law.scale[r] * largest
    return total if fabs(total) > CANCELLED * SPACING * terms else 0.0


def add_responses(values: Vec[NX], w: Work) -> None:
    """Add X p to the speeds of `values`."""
    for r in range(w.contacts.law.rows):
        block = row_block[w.contacts.touching_rows[r]]
        for c in range(speed_begin[block], speed_end[block]):
            j = block_speed[c]
            values[NQ + j] += w.contacts.responses[w.contacts.slot[r] * NR + j] * w.contacts.law.p[r]


def add_cancelling(values: Vec[NX], w: Work) -> None:
    """Add X p to the speeds, or accelerations, of `values`, of forces that solve equations with
    w.contacts.law.scale."""
    largest = largest_scaled(w)
    for block in range(w.contacts.first_block, w.contacts.last_block):
        for c in range(speed_begin[block], speed_end[block]):
            j = block_speed[c]
            values[NQ + j] = response_to_forces(j, block, values[NQ + j], largest, w)


def respond_to_slope(k: int, w: Work) -> None:
    """Compute w.contacts.solution, the response to derivative k of the loads."""
    for i in range(NR):
        w.contacts.rhs[i] = w.loads.slopes[k * NV + i] if i < NV else 0.0
    solve_motion(w)


def loads_follow(w: Work) -> bool:
    """Let loads follow the forces of the listed rows: change w.contacts.responses and w.contacts.law.W.
    Return False, with w.culprit, if they leave a multiplier open."""
    # A unit of force at row r: the loads that follow its normal force, the response of the row itself, then
    # the loads of the multipliers of both.
    law = w.contacts.law
    for r in range(law.rows):
        row = w.contacts.touching_rows[r]
        for i in range(NR):
            w.contacts.solution[i] = 0.0
        for k in range(NPUSHED):
            if contact_first[pushed_contact[k]] == row:
                respond_to_slope(NLOADED + k, w)
        for i in range(NR):
            w.contacts.solution[i] += w.contacts.responses[r * NR + i]
        if NLOADED > 0:
            if not follow_loads(w.contacts.solution, w):
                return False
        for i in range(NR):
            w.contacts.responses[r * NR + i] = w.contacts.solution[i]
        for q in range(law.rows):
            total = 0.0
            for j in range(NV):
                total += w.contacts.rows[w.contacts.touching_rows[q] * NV + j] * w.contacts.solution[j]
            law.W[q * law.rows + r] = total
    return True


def set_loads(p: Params, t: Real, x: Vec[NX], w: Work) -> None:
    """Linearize the loads at the reactions w.loads.lam and w.contacts.forces, with w.loads.rest, their value
    for reactions of zero."""
    update_load(p, t, x, w)
    # f(0) of the tangent: f - D s, so that the loads of a solution are rest + D s.
    if NCURVED > 0:
        w.loads.rest[:] = w.loads.force
        for k in range(NLOADS):
            if k < NLOADED:
                own = w.loads.lam[loading_row[k]]
            else:
                own = w.contacts.forces[contact_first[pushed_contact[k - NLOADED]]]
            for i in range(NV):
                w.loads.rest[i] -= own * w.loads.slopes[k * NV + i]
    if NLOADED > 0:
        keep_load_matrix(w)


def servos_follow(p: Params, t: Real, x: Vec[NX], w: Work) -> bool:
    """Let the actuators of servo constraints follow the forces of the listed rows, and no other load: in an
    impact, their paths hold by impulses of the actuators. Return False, with w.culprit, if one does not."""
    # All reactions are 0 and all slopes but those of actuators too: in an impact only impulses count, and
    # finite loads have none.
    for i in range(NC):
        w.loads.lam[i] = 0.0
    update_load(p, t, x, w)
    for k in range(NLOADS):
        held = False
        if k < NLOADED:
            held = load_held[k] > 0
        if not held:
            for i in range(NV):
                w.loads.slopes[k * NV + i] = 0.0
    if NLOADED > 0:
        keep_load_matrix(w)
    return loads_follow(w)


def move_with_loads(rates: Vec[NX], lam: Vec[NC], w: Work) -> bool:
    """Compute accelerations and multipliers without forces of contacts, from w.loads.begin without these
    loads. Return False, with w.culprit, if the loads leave a multiplier open."""
    for i in range(NR):
        w.contacts.solution[i] = 0.0
    if NCURVED > 0:
        for i in range(NR):
            w.contacts.rhs[i] = w.loads.rest[i] if i < NV else 0.0
        solve_motion(w)
    for i in range(NR):
        w.contacts.solution[i] += w.loads.begin[i]
    if NLOADED > 0:
        if not follow_loads(w.contacts.solution, w):
            return False
    for i in range(NV):
        rates[NQ + i] = w.contacts.solution[i]
    for i in range(NC):
        lam[i] = w.contacts.solution[NV + i]
    return True


def keep_begin(rates: Vec[NX], lam: Vec[NC], w: Work) -> None:
    """Store accelerations and multipliers without loads of reactions in w.loads.begin, and begin with
    reactions of zero."""
    for i in range(NV):
        w.loads.begin[i] = rates[NQ + i]
    for i in range(NC):
        w.loads.begin[NV + i] = lam[i]
        w.loads.lam[i] = 0.0
    for i in range(NCROW):
        w.contacts.forces[i] = 0.0


def reactions_agree(lam: Vec[NC], w: Work) -> bool:
    """Set the reactions w.loads.lam and w.contacts.forces to those of the forces w.contacts.law.p. Return
    whether they were these, to 1e-10 of them or the round-off of their terms."""
    law = w.contacts.law
    # A reaction that forces of contacts cancel has the round-off of its terms.
    # Reactions with the forces of contacts, against those that the loads were linearized at.
    agree = True
    if NLOADED > 0:
        for k in range(NLOADED):
            row = loading_row[k]
            total = lam[row]
            terms = fabs(total)
            for r in range(law.rows):
                own = w.contacts.responses[r * NR + NV + row] * law.p[r]
                total += own
                terms += fabs(own)
            change = fabs(total - w.loads.lam[row])
            if not change <= LOAD_STEP * fabs(total) + 64.0 * SPACING * terms:
                agree = False
            w.loads.lam[row] = total
    # Normal forces are compared in a vector of their own, as w.contacts.forces still holds the old ones.
    for i in range(NCROW):
        w.loads.pushes[i] = 0.0
    for n in range(law.count):
        row = law.first[n]
        force = law.p[row]
        first = contact_first[w.contacts.touching[n]]
        w.loads.pushes[first] = force
        roundoff = law.scale[row] * law.roundoff
        if not fabs(force - w.contacts.forces[first]) <= LOAD_STEP * fabs(force) + roundoff:
            agree = False
    w.contacts.forces[:] = w.loads.pushes
    return agree


def store_power(p: Params, t: Real, x: Vec[NX], xdot: Vec[NX], lam: Vec[NC], w: Work) -> None:
    """Set the rate of the work integral for accelerations, multipliers and forces of contacts."""
    if NZ > 0:
        # The work integral follows from the accelerations with contacts. Loads of normal forces do work too.
        w.a[:] = part(xdot, NQ, NQ + NV)
        w.qdot[:] = part(xdot, 0, NQ)
        store_rates(p, t, x, xdot, lam, w)
        # Power of the contact forces themselves: p . R v, zero but for slips.
        for i in range(NCON):
            if w.contacts.touched[i] > 0:
                block = contact_block[i]
                for row in range(contact_first[i], contact_first[i] + contact_slips[i] + 1):
                    for c in range(speed_begin[block], speed_end[block]):
                        j = block_speed[c]
                        power = w.contacts.pushes[row] * w.contacts.rows[row * NV + j]
                        xdot[NQ + NV] += power * x[NQ + j]
