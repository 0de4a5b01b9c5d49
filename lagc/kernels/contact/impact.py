"""Impacts with restitution and dry friction.

All contacts that approach act at once, then again those that approach then, until none does. Newton's law
sets u_n after = -e u_n before. Poisson's law brings contacts to rest and gives back at least e times each
normal impulse of that; unlike Newton's law, it does not add energy where friction acts. In both, impulses
meet Coulomb's law with the velocities after (F. Pfeiffer, C. Glocker, Multibody Dynamics with Unilateral
Contacts, 1996, chapter 8; C. Glocker, Set-Valued Force Laws, 2001, chapter 12).
"""

from math import fabs

from lagc.kernels.contact.enumeration import LAW_FAILED, LAW_FOUND
from lagc.kernels.contact.frozen_modes import set_law_scales
from lagc.kernels.contact.set_law import search_modes
from lagc.kernels.language.vocabulary import *

IMPACT_DONE = 0  # results of `impact`
IMPACT_NONE = 1  # no contact approaches
IMPACT_PARADOX = 2  # no impulses, or several, meet the law
IMPACT_GAINS = 3  # energy would grow
IMPACT_ENDLESS = 4  # contacts approach again after MOST_ROUNDS
IMPACT_FAILED = 5  # impulses were not found
MOST_ROUNDS = 1000
APPROACHES = by_type(1e-5, 1e-12, "1e-28")  # of the terms of a velocity: contacts with less do not approach
GAINED = by_type(1e-3, 1e-9, "1e-20")  # of the energy that passed through contacts: round-off


def keep_problem(w: Work) -> None:
    """Keep the data of all contacts, and set w.impact_u."""
    w.impact_count = w.law_count
    w.impact_rows = w.law_rows
    w.impact_first[:] = w.law_first
    w.impact_slips[:] = w.law_slips
    w.impact_two_sided[:] = w.law_two_sided
    w.impact_unit[:] = w.law_unit
    w.impact_friction[:] = w.law_friction
    w.impact_w[:] = w.law_w
    w.impact_u[:] = w.law_b
    w.impact_sizes[:] = w.law_sizes
    for j in range(w.impact_rows):
        w.law_impulse[j] = 0.0
        if fabs(w.impact_u[j]) > w.impact_sizes[j]:
            w.impact_sizes[j] = fabs(w.impact_u[j])
    for i in range(w.impact_count):
        w.law_loss[i] = 0.0


def restore_problem(w: Work) -> None:
    """Restore the data of all contacts. Their modes are not known."""
    w.law_count = w.impact_count
    w.law_rows = w.impact_rows
    w.law_first[:] = w.impact_first
    w.law_slips[:] = w.impact_slips
    w.law_two_sided[:] = w.impact_two_sided
    w.law_unit[:] = w.impact_unit
    w.law_friction[:] = w.impact_friction
    w.law_w[:] = w.impact_w
    w.law_u[:] = w.impact_u
    for i in range(w.law_count):
        w.law_mode[i] = -1


def row_of_all(w: Work, i: int, k: int) -> int:
    """Return the row among all contacts of a row of contact i of the impact."""
    return w.impact_first[w.impact_of[i]] + k


def select_hits(w: Work) -> bool:
    """Make the problem of contacts that approach, and of two-sided ones. Return whether any approaches."""
    n = 0
    rows = 0
    found = False
    for i in range(w.impact_count):
        first = w.impact_first[i]
        hits = w.impact_u[first] < -APPROACHES * w.impact_sizes[first]
        if hits and w.impact_two_sided[i] == 0:
            found = True
        if hits or w.impact_two_sided[i] > 0:
            w.impact_of[n] = i
            w.law_first[n] = rows
            w.law_slips[n] = w.impact_slips[i]
            w.law_two_sided[n] = w.impact_two_sided[i]
            w.law_unit[n] = w.impact_unit[i]
            w.law_mu[n] = w.impact_friction[i]
            w.law_slides[n] = 0
            w.law_least[n] = 0.0
            w.law_mode[n] = -1
            n += 1
            rows += w.impact_slips[i] + 1
    w.law_count = n
    w.law_rows = rows
    for i in range(n):
        for k in range(w.law_slips[i] + 1):
            from_row = row_of_all(w, i, k) * w.impact_rows
            to_row = (w.law_first[i] + k) * rows
            for j in range(n):
                for m in range(w.law_slips[j] + 1):
                    w.law_w[to_row + w.law_first[j] + m] = w.impact_w[from_row + row_of_all(w, j, m)]
    return found


def give_impulses(w: Work) -> None:
    """Add w.law_p of the problem to the impulses, and change all velocities by it."""
    for i in range(w.law_count):
        for k in range(w.law_slips[i] + 1):
            column = row_of_all(w, i, k)
            impulse = w.law_p[w.law_first[i] + k]
            w.law_impulse[column] += impulse
            for j in range(w.impact_rows):
                w.impact_u[j] += w.impact_w[j * w.impact_rows + column] * impulse
    for j in range(w.impact_rows):
        size = fabs(w.impact_u[j])
        for i in range(w.law_count):
            for k in range(w.law_slips[i] + 1):
                entry = w.impact_w[j * w.impact_rows + row_of_all(w, i, k)]
                size += fabs(entry * w.law_p[w.law_first[i] + k])
        if size > w.impact_sizes[j]:
            w.impact_sizes[j] = size


def solve_impulses(w: Work, restitution: bool) -> int:
    """Solve the problem for velocities after. With `restitution`, those of Newton's law."""
    for i in range(w.law_count):
        for k in range(w.law_slips[i] + 1):
            row = w.law_first[i] + k
            w.law_b[row] = w.impact_u[row_of_all(w, i, k)]
            w.law_sizes[row] = w.impact_sizes[row_of_all(w, i, k)]
        if restitution and w.law_two_sided[i] == 0:
            w.law_b[w.law_first[i]] *= 1.0 + w.law_restitution[w.impact_of[i]]
    set_law_scales(w)
    return search_modes(w)


def follows_poisson(w: Work) -> bool:
    """Return whether a contact of the impact has Poisson's law; then all have it."""
    for i in range(w.law_count):
        if w.law_poisson[w.impact_of[i]] > 0:
            return True
    return False


def strike_twice(w: Work) -> int:
    """Solve such an impact by Poisson's law, compression and then expansion. Return the result of the law."""
    found = solve_impulses(w, False)
    if found > LAW_FOUND:
        return found
    give_impulses(w)
    expands = False
    for i in range(w.law_count):
        if w.law_two_sided[i] == 0:
            w.law_least[i] = w.law_restitution[w.impact_of[i]] * w.law_p[w.law_first[i]]
            if w.law_least[i] > 0.0:
                expands = True
            w.law_mode[i] = -1
    if expands:
        found = solve_impulses(w, False)
        if found <= LAW_FOUND:
            give_impulses(w)
    return found


def strike(w: Work) -> int:
    """Solve the impact of the selected contacts and give their impulses. Return the result of the law."""
    if NPOISSON > 0:
        if follows_poisson(w):
            return strike_twice(w)
    found = solve_impulses(w, True)
    if found <= LAW_FOUND:
        give_impulses(w)
    return found


def count_loss(w: Work) -> bool:
    """Add the energy that each contact took in a round to w.law_loss; w.law_u and w.law_p hold velocities and
    impulses before the round, of all contacts. Return False if energy has grown."""
    gain = 0.0
    passed = 0.0
    for i in range(w.impact_count):
        for k in range(w.impact_slips[i] + 1):
            row = w.impact_first[i] + k
            impulse = w.law_impulse[row] - w.impact_p_before[row]
            work = 0.5 * impulse * (w.impact_u_before[row] + w.impact_u[row])
            w.law_loss[i] -= work
            gain += work
            passed += 0.5 * fabs(impulse) * (fabs(w.impact_u_before[row]) + fabs(w.impact_u[row]))
    return gain <= GAINED * passed


def impact(w: Work) -> int:
    """Compute the impulses w.law_impulse of all contacts that touch, whose velocities before are w.law_b, and
    the velocities after, w.law_u, with the number of rounds and the energy that each contact took."""
    keep_problem(w)
    w.law_rounds = 0
    result = IMPACT_NONE
    while select_hits(w):
        if w.law_rounds == MOST_ROUNDS:
            result = IMPACT_ENDLESS
            break
        w.impact_u_before[:] = w.impact_u
        w.impact_p_before[:] = w.law_impulse
        found = strike(w)
        if found > LAW_FOUND:
            result = IMPACT_FAILED if found == LAW_FAILED else IMPACT_PARADOX
            break
        w.law_rounds += 1
        result = IMPACT_DONE
        if not count_loss(w):
            result = IMPACT_GAINS
            break
    restore_problem(w)
    return result
