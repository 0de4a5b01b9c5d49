"""The law of contacts that touch: their forces in given modes, and the conditions that these must meet.

Contacts move by u = W p + b: p are forces and u relative accelerations, or p are impulses and u relative
velocities. Each contact has a normal row and 0, 1 or 2 slip rows. The law is (A. Signorini; C. A. Coulomb)

    u_n >= 0, p_n >= 0, u_n p_n = 0      |p_t| <= mu p_n, and p_t = -mu p_n u_t / |u_t| if u_t is not zero

In given modes it is a system of equations: a closed contact has u_n = 0, one that sticks u_t = 0, and one
that slips along d has p_t = -mu d |p_n|, which makes the system unsymmetric. A direction d that is not given
is found with p, from u_t along d, by Newton's method. F. Pfeiffer, C. Glocker, Multibody Dynamics with
Unilateral Contacts, 1996, chapter 5.
"""

from math import fabs, inf, sqrt

from lagc.kernels.language.vocabulary import *

CONTACT_OPEN = 0  # p_n = 0
CONTACT_SLIPS = 1  # closed; also a contact without slip rows
CONTACT_STICKS = 2
LEAST_SLIPS = 3  # p_n is the least normal force, with friction; u_n >= 0
LEAST_STICKS = 4
LAW_ROUNDOFF = 1e3  # units in the last place of the terms of b, and of forces: a difference of u
CONTRADICTS = by_type(1e-3, 1e-7, "1e-14")  # of the size of u: residual of a dependent row
MOST_TURNS = 40  # Newton iterations for slip directions
TURNED = by_type(1e-3, 1e-7, "1e-15")  # last change of a slip angle; the next one is its square
LAW_ZERO = by_type(1e-4, 1e-9, "1e-20")  # of the size of u or p: it is zero
DISTINCT = by_type(1e-2, 1e-6, "1e-12")  # of the size of u: solutions that differ


def is_closed(mode: int) -> bool:
    """Return whether u_n = 0 and p_n is an unknown."""
    return mode == CONTACT_SLIPS or mode == CONTACT_STICKS


def is_sticking(mode: int) -> bool:
    """Return whether u_t = 0 and p_t is an unknown."""
    return mode == CONTACT_STICKS or mode == LEAST_STICKS


def count_scaled(law: ContactLaw, j: int) -> None:
    """Count the scaled b of a row, and its round-off, in law.size and law.roundoff."""
    size = law.row_scale[j] * fabs(law.b[j])
    if size > law.size:
        law.size = size
    roundoff = LAW_ROUNDOFF * SPACING * law.row_scale[j] * law.terms[j]
    if roundoff > law.roundoff:
        law.roundoff = roundoff


def scale_two_sided(law: ContactLaw) -> None:
    """Scale the normal forces of two-sided contacts by the largest of them. Slips in a given direction do not
    count: where a mechanism has no motion along one, its scale has no bound."""
    law.size = 0.0
    law.roundoff = 0.0
    force = 0.0
    # The row of such a force, p_n - e . N = 0, is a force itself: the size of all others comes first.
    for i in range(law.count):
        first = law.first[i]
        if law.two_sided[i] > 0 and law.terms[first] > force:
            force = law.terms[first]
        begin = first if law.two_sided[i] == 0 else first + 1
        if law.two_sided[i] == 0 or law.slides[i] == 0:
            for j in range(begin, first + law.slips[i] + 1):
                count_scaled(law, j)
    scale = force / law.size if law.size > 0.0 else force
    for i in range(law.count):
        first = law.first[i]
        if law.two_sided[i] > 0:
            law.scale[first] = scale if scale > 0.0 else 1.0
            law.row_scale[first] = 1.0 / law.scale[first]
            count_scaled(law, first)


def set_law_scales(law: ContactLaw) -> None:
    """Set law.scale and law.row_scale, which make the blocks of W on the diagonal about 1 and measure
    all rows by the root of their energy, law.size, the largest scaled b, and law.roundoff, the largest
    round-off of one. All rows of a contact have one scale, so that its cone remains round."""
    law.size = 0.0
    law.roundoff = 0.0
    for i in range(law.count):
        first = law.first[i]
        begin = first
        if law.two_sided[i] > 0 and law.slips[i] > 0:
            begin = first + 1
        end = first + law.slips[i] + 1
        # The mean diagonal entry; the normal row of a two-sided contact has none in this unit.
        total = 0.0
        for j in range(begin, end):
            total += fabs(law.W[j * law.rows + j])
        scale = sqrt(float(end - begin) / total) if total > 0.0 else 1.0
        for j in range(first, end):
            law.scale[j] = scale
            law.row_scale[j] = scale
        if begin > first and law.W[first * law.rows + first] != 0.0:
            law.row_scale[first] = 1.0 / (scale * fabs(law.W[first * law.rows + first]))
        for j in range(first, end):
            count_scaled(law, j)
    if NTWO > 0:
        scale_two_sided(law)


def list_unknowns(law: ContactLaw, turning: bool) -> None:
    """List the unknowns of these modes, law.unknown: p_n of closed contacts, p_t of those that stick, and,
    if `turning`, slip angles. Each has an equation: u_n = 0, u_t = 0, or u_t has no part across the slip."""
    n = 0
    # Derivatives with respect to angles: p_t = -mu |p_n| d, and d changes by `across` for each radian.
    law.turning = False
    for i in range(law.count):
        if is_closed(law.mode[i]):
            law.contact[n] = i
            law.unknown[n] = law.first[i]
            n += 1
        if NSLIP > 0:
            if is_sticking(law.mode[i]):
                for k in range(law.slips[i]):
                    law.contact[n] = i
                    law.unknown[n] = law.first[i] + 1 + k
                    n += 1
            elif law.turns[i] > 0 and turning:
                law.turning = True
                law.contact[n] = i
                law.unknown[n] = law.rows
                n += 1
    law.unknowns = n


def across(law: ContactLaw, i: int, k: int) -> Real:
    """Return an entry of the unit vector across the slip direction of a contact."""
    return -law.direction[2 * i + 1] if k == 0 else law.direction[2 * i]


def effect(law: ContactLaw, unknown: int, j: int) -> Real:
    """Return the derivative of u_j by a scaled unknown: of a normal force with the friction that follows it,
    W_jn - mu d W_jt, and of a slip angle, -mu p_n W_jt across d."""
    row = law.unknown[unknown]
    value = 0.0
    # The column of a slip angle.
    if NSPACE > 0:
        if row == law.rows:
            own = law.contact[unknown]
            normal = law.first[own]
            for k in range(law.slips[own]):
                value += across(law, own, k) * law.W[j * law.rows + normal + 1 + k]
            return -law.mu[own] * fabs(law.p[normal]) * value
    value = law.W[j * law.rows + row]
    if NSLIP > 0:
        # The column of a force; a normal force carries its friction along, which is what makes W unsymmetric.
        i = law.contact[unknown]
        first = law.first[i]
        if row == first and law.mode[i] == CONTACT_SLIPS and law.mu[i] > 0.0:
            grip = law.mu[i] * float(law.sign[i])
            for k in range(law.slips[i]):
                value -= grip * law.direction[2 * i + k] * law.W[j * law.rows + first + 1 + k]
    return law.scale[row] * value


def slip_forces(law: ContactLaw) -> None:
    """Set p_t of contacts that slip."""
    if NSLIP > 0:
        for i in range(law.count):
            first = law.first[i]
            if not is_sticking(law.mode[i]):
                for k in range(law.slips[i]):
                    law.p[first + 1 + k] = 0.0
                    if law.mu[i] > 0.0 and law.p[first] != 0.0:
                        grip = law.mu[i] * float(law.sign[i]) * law.p[first]
                        law.p[first + 1 + k] = -grip * law.direction[2 * i + k]


def relative_motion(law: ContactLaw) -> None:
    """Compute u = W p + b."""
    for j in range(law.rows):
        value = law.b[j]
        for k in range(law.rows):
            value += law.W[j * law.rows + k] * law.p[k]
        law.u[j] = value


def assemble_law(law: ContactLaw) -> None:
    """Set law.matrix and law.right: scaled equations for a change of the unknowns, u + du = 0 of rows that
    do not move and, of a slip angle, c . (u_t + du_t) - (d . u_t) dangle = 0 with c across d."""
    # One equation for each unknown, in the same order.
    n = law.unknowns
    for e in range(n):
        row = law.unknown[e]
        if row < law.rows:
            for k in range(n):
                law.matrix[e * n + k] = law.row_scale[row] * effect(law, k, row)
            law.right[e] = -law.row_scale[row] * law.u[row]
        # The derivative of c . u_t by the angle has two parts: c . du_t, which `effect` contains, and dc .
        # u_t = -d . u_t.
        elif NSPACE > 0:
            i = law.contact[e]
            first = law.first[i]
            scale = law.row_scale[first + 1]
            for k in range(n):
                law.matrix[e * n + k] = scale * (
                    across(law, i, 0) * effect(law, k, first + 1)
                    + across(law, i, 1) * effect(law, k, first + 2)
                )
            along = law.direction[2 * i] * law.u[first + 1]
            along += law.direction[2 * i + 1] * law.u[first + 2]
            law.matrix[e * n + e] -= scale * along
            aside = across(law, i, 0) * law.u[first + 1] + across(law, i, 1) * law.u[first + 2]
            law.right[e] = -scale * aside


def divide_law_row(law: ContactLaw, e: int, length: Real) -> None:
    """Divide an equation by a length."""
    n = law.unknowns
    for k in range(n):
        law.matrix[e * n + k] /= length
    law.right[e] /= length


def remove_law_row(law: ContactLaw, e: int, other: int) -> None:
    """Remove from an equation its part along another one, of unit length."""
    n = law.unknowns
    share = 0.0
    for k in range(n):
        share += law.matrix[e * n + k] * law.matrix[other * n + k]
    if share != 0.0:
        for k in range(n):
            law.matrix[e * n + k] -= share * law.matrix[other * n + k]
        law.right[e] -= share * law.right[other]


def law_row_length(law: ContactLaw, e: int) -> Real:
    """Return the length of an equation."""
    n = law.unknowns
    total = 0.0
    for k in range(n):
        total += law.matrix[e * n + k] * law.matrix[e * n + k]
    return sqrt(total)


def least_norm_change(law: ContactLaw) -> bool:
    """Compute law.step, the shortest solution, by modified Gram-Schmidt with pivoting; each row is made
    orthogonal twice (A. Bjorck, Numerical Methods for Least Squares Problems, SIAM 1996, section 2.4).
    Return False, with law.culprit, if rows contradict each other."""
    n = law.unknowns
    # Rows of unit length: their right-hand sides are then distances, which tell what contradicts.
    largest = law.size
    for e in range(n):
        law.order[e] = e
        law.step[e] = 0.0
        length = law_row_length(law, e)
        if length > 0.0:
            divide_law_row(law, e, length)
        if fabs(law.right[e]) > largest:
            largest = fabs(law.right[e])
    # The longest row that is left comes next. Each is made orthogonal when it is removed from and when its
    # turn has come; the shortest solution is then the sum of the rows times their right-hand sides.
    law.rank = n
    for k in range(n):
        best = k
        longest = 0.0
        for j in range(k, n):
            length = law_row_length(law, law.order[j])
            if length > longest:
                longest = length
                best = j
        if not longest > LEAST_PIVOT:
            law.rank = k
            break
        row = law.order[best]
        law.order[best] = law.order[k]
        law.order[k] = row
        for j in range(k):
            remove_law_row(law, row, law.order[j])
        divide_law_row(law, row, law_row_length(law, row))
        for j in range(k + 1, n):
            remove_law_row(law, law.order[j], row)
        for j in range(n):
            law.step[j] += law.right[row] * law.matrix[row * n + j]
    # Rows that depend on these have nothing left, on the right too, unless they contradict.
    for k in range(law.rank, n):
        row = law.order[k]
        if not fabs(law.right[row]) <= CONTRADICTS * largest + law.roundoff:
            law.culprit = law.contact[row]
            return False
    return True


def turn_slip(law: ContactLaw, i: int, angle: Real) -> None:
    """Turn the slip direction of a contact by an angle, at most a radian."""
    part_of = angle
    if fabs(angle) > 1.0:
        part_of = 1.0 if angle > 0.0 else -1.0
    one = law.direction[2 * i] + part_of * across(law, i, 0)
    other = law.direction[2 * i + 1] + part_of * across(law, i, 1)
    length = sqrt(one * one + other * other)
    law.direction[2 * i] = one / length
    law.direction[2 * i + 1] = other / length


def take_step(law: ContactLaw) -> Real:
    """Add law.step to the unknowns; return the largest change of a slip angle."""
    turned = 0.0
    for e in range(law.unknowns):
        row = law.unknown[e]
        if row < law.rows:
            law.p[row] += law.scale[row] * law.step[e]
        elif NSPACE > 0:
            if fabs(law.step[e]) > turned:
                turned = fabs(law.step[e])
            turn_slip(law, law.contact[e], law.step[e])
    return turned


def correct_unknowns(law: ContactLaw) -> Real:
    """Make one Newton step for the listed unknowns; return the largest change of a slip angle, or -1 if rows
    contradict each other."""
    slip_forces(law)
    relative_motion(law)
    assemble_law(law)
    if not least_norm_change(law):
        return -1.0
    turned = take_step(law)
    slip_forces(law)
    relative_motion(law)
    return turned


def shares_force(i: int, law: ContactLaw) -> bool:
    """Return whether the normal force of a closed contact is one of many, after `least_norm_change`: its unit
    vector is no sum of the rows, which are orthonormal then."""
    n = law.unknowns
    if law.rank < n:
        for e in range(n):
            if law.contact[e] == i and law.unknown[e] == law.first[i]:
                total = 0.0
                for k in range(law.rank):
                    own = law.matrix[law.order[k] * n + e]
                    total += own * own
                return not total > 1.0 - LEAST_PIVOT
    return False


def solve_modes(law: ContactLaw) -> bool:
    """Compute law.p and law.u in the modes law.mode, with slip directions as unknowns where
    law.turns says so. Return False if the modes contradict each other."""
    for i in range(law.count):
        # Normal forces begin at their least values and those of friction at 0, as all equations are linear
        # for given directions.
        law.p[law.first[i]] = law.least[i]
        for k in range(law.slips[i]):
            law.p[law.first[i] + 1 + k] = 0.0
    # The equations are linear for given directions: these forces first, then the angles with them.
    list_unknowns(law, False)
    turned = correct_unknowns(law)
    if NSPACE > 0:
        list_unknowns(law, True)
        if turned == 0.0 and law.turning:
            turned = inf
            for turn in range(MOST_TURNS):
                turned = correct_unknowns(law)
                if turned <= TURNED:
                    break
    # Rates that were solved for are zero exactly; round-off of W p + b would look like a motion.
    for e in range(law.unknowns):
        if law.unknown[e] < law.rows:
            law.u[law.unknown[e]] = 0.0
    return turned >= 0.0 and turned <= TURNED


def solve_frozen(law: ContactLaw) -> bool:
    """Compute the forces law.p and relative accelerations law.u of contacts in the modes law.mode.
    Contacts that slip do so along law.direction. Forces of rows that depend on others are the smallest.
    Signs are not tested. Return False, with law.culprit, if the modes contradict each other."""
    for i in range(law.count):
        law.turns[i] = 0
        law.least[i] = 0.0
        law.mu[i] = law.friction[i]
        if law.two_sided[i] == 0:
            law.sign[i] = 1
        if NTWO > 0:
            law.slides[i] = 1 if law.mode[i] == CONTACT_SLIPS else 0
    set_law_scales(law)
    return solve_modes(law)


def has_friction(law: ContactLaw, i: int) -> bool:
    """Return whether a contact has friction."""
    return law.slips[i] > 0 and law.mu[i] > 0.0


def slip_force(law: ContactLaw, i: int) -> Real:
    """Return |p_t| of a contact, scaled."""
    total = 0.0
    for k in range(law.slips[i]):
        value = law.p[law.first[i] + 1 + k]
        total += value * value
    return sqrt(total) / law.scale[law.first[i]]


def slip_rate(law: ContactLaw, i: int) -> Real:
    """Return |u_t| of a contact, scaled."""
    total = 0.0
    for k in range(law.slips[i]):
        row = law.first[i] + 1 + k
        value = law.row_scale[row] * law.u[row]
        total += value * value
    return sqrt(total)


def largest_force(law: ContactLaw) -> Real:
    """Return the largest scaled force, or the size of u if that is larger."""
    largest = law.size
    for j in range(law.rows):
        if fabs(law.p[j]) / law.scale[j] > largest:
            largest = fabs(law.p[j]) / law.scale[j]
    return largest


def zero_rate(law: ContactLaw, force: Real) -> Real:
    """Return the scaled u that counts as zero, for the largest scaled force."""
    return LAW_ZERO * law.size + law.roundoff + LAW_ROUNDOFF * SPACING * force


def is_admissible(law: ContactLaw) -> bool:
    """Return whether law.p and law.u meet the law in the modes law.mode."""
    force = largest_force(law)
    # Tolerances are relative to the largest force and to the size of u, both scaled to roots of energy, so
    # that contacts of a large and a small body are alike.
    if not force < inf:
        return False
    zero_u = zero_rate(law, force)
    for i in range(law.count):
        # Along the normal: an open contact does not sink in, and a closed one pushes.
        first = law.first[i]
        normal = law.p[first] / law.scale[first]
        if NTWO > 0:
            if law.two_sided[i] == 2:  # its direction follows
                normal = fabs(normal)
        if not is_closed(law.mode[i]) and law.row_scale[first] * law.u[first] < -zero_u:
            return False
        # Poisson's law asks for a least force in the expansion; otherwise `least` is 0 (A. Signorini).
        if law.two_sided[i] == 0 and normal < law.least[i] / law.scale[first] - LAW_ZERO * force:
            return False
        # Along the slip: a force in the cone, or one that opposes the slip.
        if NSLIP > 0:
            if has_friction(law, i) and law.mode[i] != CONTACT_OPEN:
                if is_sticking(law.mode[i]):
                    if slip_force(law, i) > law.mu[i] * fabs(normal) + LAW_ZERO * force:
                        return False
                    continue
                # A contact that slips has the sign of the normal force that its friction was written for.
                if float(law.sign[i]) * normal < -LAW_ZERO * force:
                    return False
                # Friction opposes the slip: u_t has no part against d. A direction that is given (`slides`)
                # is not tested, as the slip has a speed already.
                along = 0.0
                for k in range(law.slips[i]):
                    row = first + 1 + k
                    along += law.direction[2 * i + k] * law.row_scale[row] * law.u[row]
                if law.slides[i] == 0 and along < -zero_u:
                    return False
    return True


def differs(law: ContactLaw, motion: bool) -> bool:
    """Return whether law.u is not the kept one, in all rows or, with `motion` False, in normal rows. Each
    of them may be off by what counts as zero."""
    least = DISTINCT * law.size + 2.0 * zero_rate(law, largest_force(law))
    for i in range(law.count):
        for j in range(law.first[i], law.first[i] + (law.slips[i] + 1 if motion else 1)):
            if fabs(law.u[j] - law.kept_u[j]) * law.row_scale[j] > least:
                return True
    return False


def keep_solution(law: ContactLaw) -> None:
    """Keep p and u."""
    law.kept_p[:] = law.p
    law.kept_u[:] = law.u


def restore_solution(law: ContactLaw) -> None:
    """Restore p and u."""
    law.p[:] = law.kept_p
    law.u[:] = law.kept_u


def read_modes(law: ContactLaw) -> None:
    """Set law.mode and the directions of slip by u, as forces of dependent rows are not unique. Values that
    count as zero become zero."""
    zero = zero_rate(law, largest_force(law))
    for i in range(law.count):
        # The gap opens, or its rate is zero; then the slip has a direction, or it sticks.
        first = law.first[i]
        opens = law.two_sided[i] == 0 and law.row_scale[first] * law.u[first] > zero
        if not opens:
            law.u[first] = 0.0
        law.turns[i] = 0
        law.sign[i] = -1 if law.p[first] < 0.0 and law.two_sided[i] > 0 else 1
        sticks = False
        if NSLIP > 0:
            if law.slips[i] > 0 and law.slides[i] == 0:
                rate = slip_rate(law, i)
                sticks = rate <= zero and has_friction(law, i)
                for k in range(law.slips[i]):
                    row = first + 1 + k
                    if rate > zero:
                        law.direction[2 * i + k] = law.row_scale[row] * law.u[row] / rate
                    elif sticks and not opens:
                        law.u[row] = 0.0
        if opens and not law.least[i] > 0.0:
            law.mode[i] = CONTACT_OPEN
        elif opens:
            law.mode[i] = LEAST_STICKS if sticks else LEAST_SLIPS
        else:
            law.mode[i] = CONTACT_STICKS if sticks else CONTACT_SLIPS
