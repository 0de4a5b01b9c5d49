"""Contact forces in given modes.

Contacts that touch move by u = W p + b: p are forces and u relative accelerations, or p are impulses and u
relative velocities. Each contact has a normal row and 0, 1 or 2 slip rows. A closed contact has u_n = 0. If
it sticks, its slip rows have u_t = 0. If it slips along d, p_t = -mu d |p_n|, which makes the system
unsymmetric; a direction d that is not given is found with p, from u_t along d, by Newton's method.
F. Pfeiffer, C. Glocker, Multibody Dynamics with Unilateral Contacts, 1996, chapter 5.
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


def is_closed(mode: int) -> bool:
    """Return whether u_n = 0 and p_n is an unknown."""
    return mode == CONTACT_SLIPS or mode == CONTACT_STICKS


def is_sticking(mode: int) -> bool:
    """Return whether u_t = 0 and p_t is an unknown."""
    return mode == CONTACT_STICKS or mode == LEAST_STICKS


def count_scaled(w: Work, j: int) -> None:
    """Count the scaled b of a row, and its round-off, in w.law_size and w.law_roundoff."""
    size = w.law_row_scale[j] * fabs(w.law_b[j])
    if size > w.law_size:
        w.law_size = size
    roundoff = LAW_ROUNDOFF * SPACING * w.law_row_scale[j] * w.law_sizes[j]
    if roundoff > w.law_roundoff:
        w.law_roundoff = roundoff


def scale_two_sided(w: Work) -> None:
    """Scale the normal forces of two-sided contacts by the largest of them. Slips in a given direction do not
    count: where a mechanism has no motion along one, its scale has no bound."""
    w.law_size = 0.0
    w.law_roundoff = 0.0
    force = 0.0
    for i in range(w.law_count):
        first = w.law_first[i]
        if w.law_two_sided[i] > 0 and w.law_sizes[first] > force:
            force = w.law_sizes[first]
        begin = first if w.law_two_sided[i] == 0 else first + 1
        if w.law_two_sided[i] == 0 or w.law_slides[i] == 0:
            for j in range(begin, first + w.law_slips[i] + 1):
                count_scaled(w, j)
    scale = force / w.law_size if w.law_size > 0.0 else force
    for i in range(w.law_count):
        first = w.law_first[i]
        if w.law_two_sided[i] > 0:
            w.law_scale[first] = scale if scale > 0.0 else 1.0
            w.law_row_scale[first] = 1.0 / w.law_scale[first]
            count_scaled(w, first)


def set_law_scales(w: Work) -> None:
    """Set w.law_scale and w.law_row_scale, which make the blocks of W on the diagonal about 1 and measure
    all rows by the root of their energy, w.law_size, the largest scaled b, and w.law_roundoff, the largest
    round-off of one."""
    w.law_size = 0.0
    w.law_roundoff = 0.0
    for i in range(w.law_count):
        first = w.law_first[i]
        begin = first
        if w.law_two_sided[i] > 0 and w.law_slips[i] > 0:
            begin = first + 1
        end = first + w.law_slips[i] + 1
        total = 0.0
        for j in range(begin, end):
            total += fabs(w.law_w[j * w.law_rows + j])
        scale = sqrt(float(end - begin) / total) if total > 0.0 else 1.0
        for j in range(first, end):
            w.law_scale[j] = scale
            w.law_row_scale[j] = scale
        if begin > first and w.law_w[first * w.law_rows + first] != 0.0:
            w.law_row_scale[first] = 1.0 / (scale * fabs(w.law_w[first * w.law_rows + first]))
        for j in range(first, end):
            count_scaled(w, j)
    if NTWO > 0:
        scale_two_sided(w)


def list_unknowns(w: Work, turning: bool) -> None:
    """List the unknowns of these modes, w.law_unknown: p_n of closed contacts, p_t of those that stick, and,
    if `turning`, slip angles. Each has an equation: u_n = 0, u_t = 0, or u_t has no part across the slip."""
    n = 0
    w.law_turning = False
    for i in range(w.law_count):
        if is_closed(w.law_mode[i]):
            w.law_contact[n] = i
            w.law_unknown[n] = w.law_first[i]
            n += 1
        if is_sticking(w.law_mode[i]):
            for k in range(w.law_slips[i]):
                w.law_contact[n] = i
                w.law_unknown[n] = w.law_first[i] + 1 + k
                n += 1
        elif w.law_turns[i] > 0 and turning:
            w.law_turning = True
            w.law_contact[n] = i
            w.law_unknown[n] = w.law_rows
            n += 1
    w.law_unknowns = n


def across(w: Work, i: int, k: int) -> Real:
    """Return an entry of the unit vector across the slip direction of a contact."""
    return -w.law_direction[2 * i + 1] if k == 0 else w.law_direction[2 * i]


def effect(w: Work, unknown: int, j: int) -> Real:
    """Return the derivative of u_j by a scaled unknown."""
    i = w.law_contact[unknown]
    row = w.law_unknown[unknown]
    first = w.law_first[i]
    start = j * w.law_rows
    if row == w.law_rows:
        value = 0.0
        for k in range(w.law_slips[i]):
            value += across(w, i, k) * w.law_w[start + first + 1 + k]
        return -w.law_mu[i] * fabs(w.law_p[first]) * value
    value = w.law_w[start + row]
    if row == first and w.law_mode[i] == CONTACT_SLIPS and w.law_mu[i] > 0.0:
        grip = w.law_mu[i] * float(w.law_sign[i])
        for k in range(w.law_slips[i]):
            value -= grip * w.law_direction[2 * i + k] * w.law_w[start + first + 1 + k]
    return w.law_scale[row] * value


def slip_forces(w: Work) -> None:
    """Set p_t of contacts that slip."""
    for i in range(w.law_count):
        first = w.law_first[i]
        if not is_sticking(w.law_mode[i]):
            for k in range(w.law_slips[i]):
                w.law_p[first + 1 + k] = 0.0
                if w.law_mu[i] > 0.0 and w.law_p[first] != 0.0:
                    grip = w.law_mu[i] * float(w.law_sign[i]) * w.law_p[first]
                    w.law_p[first + 1 + k] = -grip * w.law_direction[2 * i + k]


def relative_motion(w: Work) -> None:
    """Compute u = W p + b."""
    for j in range(w.law_rows):
        value = w.law_b[j]
        for k in range(w.law_rows):
            value += w.law_w[j * w.law_rows + k] * w.law_p[k]
        w.law_u[j] = value


def assemble_law(w: Work) -> None:
    """Set w.law_matrix and w.law_right: scaled equations for a change of the unknowns."""
    n = w.law_unknowns
    for e in range(n):
        i = w.law_contact[e]
        row = w.law_unknown[e]
        first = w.law_first[i]
        if row < w.law_rows:
            for k in range(n):
                w.law_matrix[e * n + k] = w.law_row_scale[row] * effect(w, k, row)
            w.law_right[e] = -w.law_row_scale[row] * w.law_u[row]
        else:
            scale = w.law_row_scale[first + 1]
            for k in range(n):
                w.law_matrix[e * n + k] = scale * (
                    across(w, i, 0) * effect(w, k, first + 1) + across(w, i, 1) * effect(w, k, first + 2)
                )
            along = w.law_direction[2 * i] * w.law_u[first + 1]
            along += w.law_direction[2 * i + 1] * w.law_u[first + 2]
            w.law_matrix[e * n + e] -= scale * along
            aside = across(w, i, 0) * w.law_u[first + 1] + across(w, i, 1) * w.law_u[first + 2]
            w.law_right[e] = -scale * aside


def divide_law_row(w: Work, e: int, length: Real) -> None:
    """Divide an equation by a length."""
    n = w.law_unknowns
    for k in range(n):
        w.law_matrix[e * n + k] /= length
    w.law_right[e] /= length


def remove_law_row(w: Work, e: int, other: int) -> None:
    """Remove from an equation its part along another one, of unit length."""
    n = w.law_unknowns
    share = 0.0
    for k in range(n):
        share += w.law_matrix[e * n + k] * w.law_matrix[other * n + k]
    if share != 0.0:
        for k in range(n):
            w.law_matrix[e * n + k] -= share * w.law_matrix[other * n + k]
        w.law_right[e] -= share * w.law_right[other]


def law_row_length(w: Work, e: int) -> Real:
    """Return the length of an equation."""
    n = w.law_unknowns
    total = 0.0
    for k in range(n):
        total += w.law_matrix[e * n + k] * w.law_matrix[e * n + k]
    return sqrt(total)


def least_norm_change(w: Work) -> bool:
    """Compute w.law_step, the shortest solution, by modified Gram-Schmidt with pivoting; each row is made
    orthogonal twice (A. Bjorck, Numerical Methods for Least Squares Problems, SIAM 1996, section 2.4).
    Return False, with w.law_culprit, if rows contradict each other."""
    n = w.law_unknowns
    largest = w.law_size
    for e in range(n):
        w.law_order[e] = e
        w.law_step[e] = 0.0
        length = law_row_length(w, e)
        if length > 0.0:
            divide_law_row(w, e, length)
        if fabs(w.law_right[e]) > largest:
            largest = fabs(w.law_right[e])
    w.law_rank = n
    for k in range(n):
        best = k
        longest = 0.0
        for j in range(k, n):
            length = law_row_length(w, w.law_order[j])
            if length > longest:
                longest = length
                best = j
        if not longest > LEAST_PIVOT:
            w.law_rank = k
            break
        row = w.law_order[best]
        w.law_order[best] = w.law_order[k]
        w.law_order[k] = row
        for j in range(k):
            remove_law_row(w, row, w.law_order[j])
        divide_law_row(w, row, law_row_length(w, row))
        for j in range(k + 1, n):
            remove_law_row(w, w.law_order[j], row)
        for j in range(n):
            w.law_step[j] += w.law_right[row] * w.law_matrix[row * n + j]
    for k in range(w.law_rank, n):
        row = w.law_order[k]
        if not fabs(w.law_right[row]) <= CONTRADICTS * largest + w.law_roundoff:
            w.law_culprit = w.law_contact[row]
            return False
    return True


def take_step(w: Work) -> Real:
    """Add w.law_step to the unknowns; return the largest change of a slip angle. Angles change by at most a
    radian."""
    turned = 0.0
    for e in range(w.law_unknowns):
        i = w.law_contact[e]
        row = w.law_unknown[e]
        if row < w.law_rows:
            w.law_p[row] += w.law_scale[row] * w.law_step[e]
        else:
            angle = w.law_step[e]
            if fabs(angle) > turned:
                turned = fabs(angle)
            if fabs(angle) > 1.0:
                angle = 1.0 if angle > 0.0 else -1.0
            one = w.law_direction[2 * i] + angle * across(w, i, 0)
            other = w.law_direction[2 * i + 1] + angle * across(w, i, 1)
            length = sqrt(one * one + other * other)
            w.law_direction[2 * i] = one / length
            w.law_direction[2 * i + 1] = other / length
    return turned


def correct_unknowns(w: Work) -> Real:
    """Make one Newton step for the listed unknowns; return the largest change of a slip angle, or -1 if rows
    contradict each other."""
    slip_forces(w)
    relative_motion(w)
    assemble_law(w)
    if not least_norm_change(w):
        return -1.0
    turned = take_step(w)
    slip_forces(w)
    relative_motion(w)
    return turned


def shares_force(i: int, w: Work) -> bool:
    """Return whether the normal force of a closed contact is one of many, after `least_norm_change`: its unit
    vector is no sum of the rows, which are orthonormal then."""
    n = w.law_unknowns
    if w.law_rank < n:
        for e in range(n):
            if w.law_contact[e] == i and w.law_unknown[e] == w.law_first[i]:
                total = 0.0
                for k in range(w.law_rank):
                    own = w.law_matrix[w.law_order[k] * n + e]
                    total += own * own
                return not total > 1.0 - LEAST_PIVOT
    return False


def solve_modes(w: Work) -> bool:
    """Compute w.law_p and w.law_u in the modes w.law_mode, with slip directions as unknowns where
    w.law_turns says so. Return False if the modes contradict each other."""
    for i in range(w.law_count):
        w.law_p[w.law_first[i]] = w.law_least[i]
        for k in range(w.law_slips[i]):
            w.law_p[w.law_first[i] + 1 + k] = 0.0
    list_unknowns(w, False)
    turned = correct_unknowns(w)
    list_unknowns(w, True)
    if turned == 0.0 and w.law_turning:
        turned = inf
        for turn in range(MOST_TURNS):
            turned = correct_unknowns(w)
            if turned <= TURNED:
                break
    for e in range(w.law_unknowns):
        if w.law_unknown[e] < w.law_rows:
            w.law_u[w.law_unknown[e]] = 0.0
    return turned >= 0.0 and turned <= TURNED


def solve_frozen(w: Work) -> bool:
    """Compute the forces w.law_p and relative accelerations w.law_u of contacts in the modes w.law_mode.
    Contacts that slip do so along w.law_direction. Forces of rows that depend on others are the smallest.
    Signs are not tested. Return False, with w.law_culprit, if the modes contradict each other."""
    for i in range(w.law_count):
        w.law_turns[i] = 0
        w.law_least[i] = 0.0
        w.law_mu[i] = w.law_friction[i]
        if w.law_two_sided[i] == 0:
            w.law_sign[i] = 1
        if NTWO > 0:
            w.law_slides[i] = 1 if w.law_mode[i] == CONTACT_SLIPS else 0
    set_law_scales(w)
    return solve_modes(w)
