"""Conditions of the law of contact with dry friction, for given forces and modes.

u_n >= 0, p_n >= 0, u_n p_n = 0 (Signorini); |p_t| <= mu p_n, and p_t = -mu p_n u_t / |u_t| if u_t is not zero
(Coulomb). Comparisons with zero are relative to the largest scaled u and p.
"""

from math import fabs, inf, sqrt

from lagc.kernels.contact.frozen_modes import (
    CONTACT_OPEN,
    CONTACT_SLIPS,
    CONTACT_STICKS,
    LAW_ROUNDOFF,
    LEAST_SLIPS,
    LEAST_STICKS,
    is_closed,
    is_sticking,
)
from lagc.kernels.language.vocabulary import *

LAW_ZERO = by_type(1e-4, 1e-9, "1e-20")  # of the size of u or p: it is zero
DISTINCT = by_type(1e-2, 1e-6, "1e-12")  # of the size of u: solutions that differ


def has_friction(w: Work, i: int) -> bool:
    """Return whether a contact has friction."""
    return w.law_slips[i] > 0 and w.law_mu[i] > 0.0


def slip_force(w: Work, i: int) -> Real:
    """Return |p_t| of a contact, scaled."""
    total = 0.0
    for k in range(w.law_slips[i]):
        value = w.law_p[w.law_first[i] + 1 + k]
        total += value * value
    return sqrt(total) / w.law_scale[w.law_first[i]]


def slip_rate(w: Work, i: int) -> Real:
    """Return |u_t| of a contact, scaled."""
    total = 0.0
    for k in range(w.law_slips[i]):
        row = w.law_first[i] + 1 + k
        value = w.law_row_scale[row] * w.law_u[row]
        total += value * value
    return sqrt(total)


def largest_force(w: Work) -> Real:
    """Return the largest scaled force, or the size of u if that is larger."""
    largest = w.law_size
    for j in range(w.law_rows):
        if fabs(w.law_p[j]) / w.law_scale[j] > largest:
            largest = fabs(w.law_p[j]) / w.law_scale[j]
    return largest


def zero_rate(w: Work, force: Real) -> Real:
    """Return the scaled u that counts as zero, for the largest scaled force."""
    return LAW_ZERO * w.law_size + w.law_roundoff + LAW_ROUNDOFF * SPACING * force


def is_admissible(w: Work) -> bool:
    """Return whether w.law_p and w.law_u meet the law in the modes w.law_mode."""
    force = largest_force(w)
    if not force < inf:
        return False
    zero_u = zero_rate(w, force)
    for i in range(w.law_count):
        first = w.law_first[i]
        normal = w.law_p[first] / w.law_scale[first]
        if NTWO > 0:
            if w.law_two_sided[i] == 2:  # its direction follows
                normal = fabs(normal)
        if not is_closed(w.law_mode[i]) and w.law_row_scale[first] * w.law_u[first] < -zero_u:
            return False
        if w.law_two_sided[i] == 0 and normal < w.law_least[i] / w.law_scale[first] - LAW_ZERO * force:
            return False
        if has_friction(w, i) and w.law_mode[i] != CONTACT_OPEN:
            if is_sticking(w.law_mode[i]):
                if slip_force(w, i) > w.law_mu[i] * fabs(normal) + LAW_ZERO * force:
                    return False
                continue
            if float(w.law_sign[i]) * normal < -LAW_ZERO * force:
                return False
            along = 0.0
            for k in range(w.law_slips[i]):
                row = first + 1 + k
                along += w.law_direction[2 * i + k] * w.law_row_scale[row] * w.law_u[row]
            if w.law_slides[i] == 0 and along < -zero_u:
                return False
    return True


def differs(w: Work, motion: bool) -> bool:
    """Return whether w.law_u is not the kept one, in all rows or, with `motion` False, in normal rows. Each
    of them may be off by what counts as zero."""
    least = DISTINCT * w.law_size + 2.0 * zero_rate(w, largest_force(w))
    for i in range(w.law_count):
        for j in range(w.law_first[i], w.law_first[i] + (w.law_slips[i] + 1 if motion else 1)):
            if fabs(w.law_u[j] - w.law_kept_u[j]) * w.law_row_scale[j] > least:
                return True
    return False


def keep_solution(w: Work) -> None:
    """Keep p and u."""
    w.law_kept_p[:] = w.law_p
    w.law_kept_u[:] = w.law_u


def restore_solution(w: Work) -> None:
    """Restore p and u."""
    w.law_p[:] = w.law_kept_p
    w.law_u[:] = w.law_kept_u


def read_modes(w: Work) -> None:
    """Set w.law_mode and the directions of slip by u."""
    zero = zero_rate(w, largest_force(w))
    for i in range(w.law_count):
        first = w.law_first[i]
        opens = w.law_two_sided[i] == 0 and w.law_row_scale[first] * w.law_u[first] > zero
        if not opens:
            w.law_u[first] = 0.0
        w.law_turns[i] = 0
        w.law_sign[i] = -1 if w.law_p[first] < 0.0 and w.law_two_sided[i] > 0 else 1
        sticks = False
        if w.law_slips[i] > 0 and w.law_slides[i] == 0:
            rate = slip_rate(w, i)
            sticks = rate <= zero and has_friction(w, i)
            for k in range(w.law_slips[i]):
                row = first + 1 + k
                if rate > zero:
                    w.law_direction[2 * i + k] = w.law_row_scale[row] * w.law_u[row] / rate
                elif sticks and not opens:
                    w.law_u[row] = 0.0
        if opens and not w.law_least[i] > 0.0:
            w.law_mode[i] = CONTACT_OPEN
        elif opens:
            w.law_mode[i] = LEAST_STICKS if sticks else LEAST_SLIPS
        else:
            w.law_mode[i] = CONTACT_STICKS if sticks else CONTACT_SLIPS
