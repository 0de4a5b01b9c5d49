"""The law of contact as one equation F(p) = 0, and Newton's method for it.

With scaled forces p and accelerations u = W p + b, each contact has

    F_n = u_n if p_n - u_n > least, else p_n - least
    F_t = p_t - P(p_t - u_t), where P projects on the disc with the radius mu p_n

(M. Jean, Comput. Methods Appl. Mech. Engrg. 177 (1999) 235-257, after P. Alart, A. Curnier, ibid. 92 (1991)
353-375). F is not smooth but has one of several derivatives everywhere: each is the system of given modes. What is
found is a solution; others are not excluded, and none may be found where there is one.
"""

from math import fabs, sqrt

from lagc.kernels.contact.conditions import (
    differs,
    has_friction,
    is_admissible,
    keep_solution,
    largest_force,
    read_modes,
    restore_solution,
)
from lagc.kernels.contact.frozen_modes import least_norm_change, relative_motion
from lagc.kernels.contact.shares import meets_law
from lagc.kernels.language.vocabulary import *

MOST_STARTS = 4
MOST_STEPS = 40  # of Newton's method, for each start
MOST_HALVES = 6  # of a step
LAW_SOLVED = by_type(1e-5, 1e-11, "1e-26")  # of the largest scaled force: F that ends the iterations


def set_law_row(w: Work, row: int) -> None:
    """Let F of a row be its scaled u."""
    for k in range(w.law_rows):
        w.law_matrix[row * w.law_rows + k] = (
            w.law_row_scale[row] * w.law_w[row * w.law_rows + k] * w.law_scale[k]
        )
    w.law_right[row] = -w.law_row_scale[row] * w.law_u[row]


def set_force_row(w: Work, row: int, force: Real) -> None:
    """Let F of a row be its scaled force less a given one."""
    for k in range(w.law_rows):
        w.law_matrix[row * w.law_rows + k] = 0.0
    w.law_matrix[row * w.law_rows + row] = 1.0
    w.law_right[row] = force - w.law_p[row] / w.law_scale[row]


def set_slip_rows(w: Work, i: int) -> None:
    """Set F of the slip rows of a contact with friction."""
    first = w.law_first[i]
    n = w.law_rows
    force = w.law_p[first]
    sign = 1.0
    if w.law_two_sided[i] > 0 and force < 0.0:
        sign = -1.0
    elif w.law_two_sided[i] == 0 and force < w.law_least[i]:
        sign = 0.0
        force = w.law_least[i]
    grip = w.law_mu[i] / w.law_scale[first + 1]
    limit = grip * fabs(force)
    grip *= sign * w.law_scale[first]
    pulls = vector(TWO)
    size = 0.0
    for k in range(w.law_slips[i]):
        row = first + 1 + k
        pulls[k] = w.law_p[row] / w.law_scale[row] - w.law_row_scale[row] * w.law_u[row]
        size += pulls[k] * pulls[k]
    size = sqrt(size)
    for k in range(w.law_slips[i]):
        row = first + 1 + k
        if size <= limit and w.law_slides[i] == 0:
            set_law_row(w, row)
            continue
        along = -w.law_direction[2 * i + k] if w.law_slides[i] > 0 else pulls[k] / size
        set_force_row(w, row, limit * along)
        if w.law_slides[i] == 0 and w.law_slips[i] == 2:  # the direction turns with the pulls
            for m in range(2):
                other = first + 1 + m
                turn = limit / size * ((1.0 if k == m else 0.0) - along * pulls[m] / size)
                w.law_matrix[row * n + other] -= turn
                for j in range(n):
                    own = w.law_row_scale[other] * w.law_w[other * n + j] * w.law_scale[j]
                    w.law_matrix[row * n + j] += turn * own
        w.law_matrix[row * n + first] -= grip * along


def linearize_law(w: Work) -> Real:
    """Set w.law_matrix to the derivative of F by the scaled forces and w.law_right to -F; return its length."""
    w.law_unknowns = w.law_rows
    relative_motion(w)
    for i in range(w.law_count):
        first = w.law_first[i]
        closing = w.law_p[first] / w.law_scale[first] - w.law_row_scale[first] * w.law_u[first]
        if w.law_two_sided[i] > 0 or closing > w.law_least[i] / w.law_scale[first]:
            set_law_row(w, first)
        else:
            set_force_row(w, first, w.law_least[i] / w.law_scale[first])
        w.law_contact[first] = i
        for k in range(1, w.law_slips[i] + 1):
            w.law_contact[first + k] = i
            if not has_friction(w, i):
                set_force_row(w, first + k, 0.0)
        if has_friction(w, i):
            set_slip_rows(w, i)
    total = 0.0
    for j in range(w.law_rows):
        total += w.law_right[j] * w.law_right[j]
    return sqrt(total)


def set_start(w: Work, start: int) -> None:
    """Begin with no forces, then with equal normal forces, then with different ones."""
    for i in range(w.law_count):
        first = w.law_first[i]
        times = float(start * (i + 1 if start > 1 else 1))
        w.law_p[first] = w.law_least[i] + times * w.law_size * w.law_scale[first]
        for k in range(1, w.law_slips[i] + 1):
            w.law_p[first + k] = 0.0


def advance_forces(w: Work, length: Real) -> Real:
    """Take a step of Newton's method with a line search, or the whole step if no part of it makes F shorter;
    return the new length of F. In dependent equations the step is the shortest one."""
    least_norm_change(w)
    w.law_kept_p[:] = w.law_p
    found = length
    part = 1.0
    for halving in range(MOST_HALVES + 2):
        for j in range(w.law_rows):
            w.law_p[j] = w.law_kept_p[j] + part * w.law_scale[j] * w.law_step[j]
        found = linearize_law(w)
        if found <= (1.0 - 1e-4 * part) * length:
            break
        part = 0.5 * part if halving < MOST_HALVES else 1.0
    return found


def solve_law_equation(w: Work) -> bool:
    """Compute w.law_p and w.law_u by Newton's method; return whether it ended."""
    for start in range(MOST_STARTS):
        set_start(w, start)
        length = linearize_law(w)
        for step in range(MOST_STEPS):
            if length <= LAW_SOLVED * largest_force(w):
                return True
            length = advance_forces(w, length)
    return False


def search_by_newton(w: Work) -> bool:
    """Compute w.law_p, w.law_u and the modes by Newton's method. Return False if it finds none that meet the law."""
    if not solve_law_equation(w):
        return False
    read_modes(w)
    keep_solution(w)
    if meets_law(w) and not differs(w, True):
        read_modes(w)
        return True
    restore_solution(w)  # friction moves a set that slides by the share: these forces meet the law
    return is_admissible(w)
