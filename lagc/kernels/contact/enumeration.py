"""Contact modes by enumeration, which shows that there is no solution, one, or several.

P. Painleve, Lecons sur le frottement, 1895: a rod that slides on a rough floor may have none or several.
"""

from math import inf, sqrt

from lagc.kernels.contact.conditions import differs, has_friction, keep_solution, read_modes, restore_solution
from lagc.kernels.contact.frozen_modes import (
    CONTACT_OPEN,
    CONTACT_SLIPS,
    CONTACT_STICKS,
    LEAST_SLIPS,
    LEAST_STICKS,
    is_closed,
    is_sticking,
    solve_modes,
)
from lagc.kernels.contact.shares import meets_law
from lagc.kernels.language.vocabulary import *

LAW_ONE = 0  # results of `set_law`: the only solution
LAW_FOUND = 1  # one solution; others were not excluded
LAW_NONE = 2  # no modes meet the law
LAW_SEVERAL = 3  # several modes meet it; w.law_other_mode is the second
LAW_FAILED = 4  # no solution was found


def tangential_choices(w: Work, i: int) -> int:
    """Return in how many modes a closed contact may be."""
    if not has_friction(w, i) or w.law_slides[i] > 0:
        return 1
    return 3 if w.law_slips[i] == 1 else 2


def choices(w: Work, i: int) -> int:
    """Return in how many modes a contact may be."""
    n = tangential_choices(w, i)
    if NTWO > 0:
        if w.law_two_sided[i] == 2:
            return n
    return 2 * n if w.law_two_sided[i] > 0 or w.law_least[i] > 0.0 else n + 1


def choose(w: Work, i: int, choice: int) -> None:
    """Put a contact into a mode."""
    n = tangential_choices(w, i)
    w.law_sign[i] = 1
    w.law_turns[i] = 0
    closed = True
    state = choice
    if w.law_two_sided[i] > 0:
        if choice >= n:
            w.law_sign[i] = -1
            state = choice - n
    elif w.law_least[i] > 0.0:
        closed = choice >= n
        if closed:
            state = choice - n
    else:
        if choice == 0:
            w.law_mode[i] = CONTACT_OPEN
            return
        state = choice - 1
    sticks = state == n - 1 and n > 1
    if sticks:
        w.law_mode[i] = CONTACT_STICKS if closed else LEAST_STICKS
    else:
        w.law_mode[i] = CONTACT_SLIPS if closed else LEAST_SLIPS
        if n == 2:
            w.law_turns[i] = 1
        if n == 3:
            w.law_direction[2 * i] = 1.0 if state == 0 else -1.0


def guess_directions(w: Work) -> None:
    """Set unknown slip directions against the forces that would make these contacts stick."""
    found = False
    for i in range(w.law_count):
        w.law_kept_mode[i] = w.law_mode[i]
        if w.law_turns[i] > 0:
            found = True
            w.law_mode[i] = CONTACT_STICKS if is_closed(w.law_mode[i]) else LEAST_STICKS
            w.law_turns[i] = 2
    if not found:
        return
    solved = solve_modes(w)
    for i in range(w.law_count):
        w.law_mode[i] = w.law_kept_mode[i]
        if w.law_turns[i] > 0:
            w.law_turns[i] = 1
            row = w.law_first[i] + 1
            force = sqrt(w.law_p[row] * w.law_p[row] + w.law_p[row + 1] * w.law_p[row + 1])
            known = solved and force > 0.0 and force < inf
            w.law_direction[2 * i] = -w.law_p[row] / force if known else 1.0
            w.law_direction[2 * i + 1] = -w.law_p[row + 1] / force if known else 0.0


def advance_choice(w: Work) -> bool:
    """Set w.law_choice to the next combination. Return False after the last one."""
    for i in range(w.law_count):
        w.law_choice[i] += 1
        if w.law_choice[i] < choices(w, i):
            return True
        w.law_choice[i] = 0
    return False


def name_culprit(w: Work, found: int) -> None:
    """Set w.law_culprit to a contact whose modes differ, or to the one that sinks in fastest by itself."""
    deepest = 0.0
    for i in range(w.law_count):
        row = w.law_first[i]
        if found == LAW_SEVERAL:
            if w.law_mode[i] != w.law_other_mode[i]:
                w.law_culprit = i
        elif w.law_row_scale[row] * w.law_b[row] < deepest:
            deepest = w.law_row_scale[row] * w.law_b[row]
            w.law_culprit = i


def shares_load(w: Work) -> bool:
    """Return whether contacts share their load in many ways; w.law_p are the smallest forces then."""
    sticking = 0
    for i in range(w.law_count):
        if is_sticking(w.law_mode[i]):
            sticking += 1
    return w.law_rank < w.law_unknowns and sticking < 2  # rows of two that stick depend on each other


def enumerate_modes(w: Work) -> int:
    """Try all modes; return LAW_ONE, LAW_NONE or LAW_SEVERAL. Of modes with the same u the last one gives p:
    it has the most contacts closed and sticking. Solutions that differ in slips alone may share the load of
    the same contacts in many ways; then the smallest forces are taken, and LAW_FOUND is returned."""
    found = LAW_NONE
    apart = False
    for i in range(w.law_count):
        w.law_choice[i] = 0
    while not apart:
        for i in range(w.law_count):
            choose(w, i, w.law_choice[i])
        guess_directions(w)
        if meets_law(w):
            if found == LAW_NONE or not differs(w, True):
                found = LAW_ONE if found == LAW_NONE else found
                keep_solution(w)
            else:
                apart = differs(w, False)
                if not apart and shares_load(w):
                    found = LAW_FOUND
                    keep_solution(w)
                elif apart or found == LAW_ONE:
                    found = LAW_SEVERAL
                    read_modes(w)
                    w.law_other_mode[:] = w.law_mode
        if not advance_choice(w):
            break
    if found != LAW_NONE:
        restore_solution(w)
        read_modes(w)
    if found > LAW_FOUND:
        name_culprit(w, found)
    return found
