"""Contact forces of many contacts, in plane and space: projected Gauss-Seidel sweeps.

Each sweep moves the force of each contact against its relative motion, back into its cone (P. Alart, A.
Curnier, Comput. Methods Appl. Mech. Engrg. 92 (1991) 353-375). The modes in which it ends are solved by
Newton's method.
"""

from math import fabs, sqrt

from lagc.kernels.contact.conditions import (
    differs,
    has_friction,
    is_admissible,
    keep_solution,
    restore_solution,
)
from lagc.kernels.contact.frozen_modes import (
    CONTACT_OPEN,
    CONTACT_SLIPS,
    CONTACT_STICKS,
    LEAST_SLIPS,
    LEAST_STICKS,
    relative_motion,
    solve_modes,
)
from lagc.kernels.language.vocabulary import *

MOST_SWEEPS = 4096


def add_force(w: Work, row: int, change: Real) -> None:
    """Change a force, and u by it."""
    w.law_p[row] += change
    for j in range(w.law_rows):
        w.law_u[j] += w.law_w[j * w.law_rows + row] * change


def sweep_normal(w: Work, i: int, step: Real) -> bool:
    """Move a normal force; return whether the contact is closed."""
    row = w.law_first[i]
    force = w.law_p[row] - step * w.law_row_scale[row] * w.law_scale[row] * w.law_u[row]
    closed = w.law_two_sided[i] > 0 or force > w.law_least[i]
    add_force(w, row, (force if closed else w.law_least[i]) - w.law_p[row])
    w.law_sign[i] = -1 if w.law_p[row] < 0.0 else 1
    return closed


def sweep_friction(w: Work, i: int, step: Real) -> bool:
    """Move the friction of a contact; return whether it sticks."""
    first = w.law_first[i]
    limit = w.law_mu[i] * fabs(w.law_p[first])
    forces = vector(TWO)
    total = 0.0
    for k in range(w.law_slips[i]):
        row = first + 1 + k
        if w.law_slides[i] > 0:
            forces[k] = -limit * w.law_direction[2 * i + k]
        else:
            forces[k] = w.law_p[row] - step * w.law_row_scale[row] * w.law_scale[row] * w.law_u[row]
        total += forces[k] * forces[k]
    size = sqrt(total)
    sticks = size <= limit and w.law_slides[i] == 0
    for k in range(w.law_slips[i]):
        if not sticks and w.law_slides[i] == 0:
            w.law_direction[2 * i + k] = -forces[k] / size
            forces[k] = forces[k] / size * limit
        add_force(w, first + 1 + k, forces[k] - w.law_p[first + 1 + k])
    return sticks


def sweep(w: Work) -> None:
    """Move the forces of all contacts, and set their modes."""
    for i in range(w.law_count):
        step = 1.0 / float(w.law_slips[i] + 1)
        closed = sweep_normal(w, i, step)
        sticks = False
        w.law_turns[i] = 0
        if has_friction(w, i):
            sticks = sweep_friction(w, i, step)
            if not sticks and w.law_slides[i] == 0 and w.law_slips[i] == 2:
                w.law_turns[i] = 1
        if closed:
            w.law_mode[i] = CONTACT_STICKS if sticks else CONTACT_SLIPS
        elif w.law_least[i] > 0.0:
            w.law_mode[i] = LEAST_STICKS if sticks else LEAST_SLIPS
        else:
            w.law_mode[i] = CONTACT_OPEN
            w.law_turns[i] = 0


def sweep_to_solution(w: Work) -> bool:
    """Compute w.law_p and w.law_u. Return False if the sweeps do not end in modes that meet the law."""
    for j in range(w.law_rows):
        w.law_p[j] = 0.0
    next_try = 1
    for count in range(MOST_SWEEPS):
        relative_motion(w)
        sweep(w)
        if count + 1 == next_try:
            next_try = 2 * next_try
            relative_motion(w)
            keep_solution(w)
            if solve_modes(w):
                if is_admissible(w):
                    return True
                if not differs(w, True):
                    # Dependent rows: the smallest forces are not admissible, those of the sweeps are.
                    w.law_p[:] = w.law_kept_p
                    if is_admissible(w):
                        return True
            restore_solution(w)
    return False
