"""Planar contact as a linear complementarity problem: w = M z + q, w >= 0, z >= 0, w z = 0.

A contact with friction has three unknowns: p_n, mu p_n + p_t, and the part of u_t against its slip row
(F. Pfeiffer, C. Glocker, Multibody Dynamics with Unilateral Contacts, 1996, section 5.3). One without
friction, or that slips already, has p_n alone. Lemke's method with the lexicographic rule for ties
(R. W. Cottle, J.-S. Pang, R. E. Stone, The Linear Complementarity Problem, 1992, sections 4.4 and 4.9).
"""

from math import fabs

from lagc.kernels.contact.frozen_modes import relative_motion
from lagc.kernels.language.vocabulary import *

LAW_TIE = by_type(1e-5, 1e-12, "1e-28")  # difference of two ratios that is a tie, and a pivot that is zero
MOST_PIVOTS = 50  # for each unknown


def has_cone(w: Work, i: int) -> bool:
    """Return whether a contact may stick or slip in either direction."""
    return w.law_slips[i] > 0 and w.law_slides[i] == 0 and w.law_mu[i] > 0.0


def count_complementary(w: Work) -> int:
    """Set w.law_block; return the number of unknowns."""
    n = 0
    for i in range(w.law_count):
        w.law_block[i] = n
        n += 3 if has_cone(w, i) else 1
    return n


def normal_effect(w: Work, i: int, j: int) -> Real:
    """Return the derivative of u_j by p_n of a contact, with the friction that follows it."""
    first = w.law_first[i]
    value = w.law_w[j * w.law_rows + first]
    if has_cone(w, i):
        value -= w.law_mu[i] * w.law_w[j * w.law_rows + first + 1]
    elif w.law_mu[i] > 0.0:
        for k in range(w.law_slips[i]):
            value -= w.law_mu[i] * w.law_direction[2 * i + k] * w.law_w[j * w.law_rows + first + 1 + k]
    return value


def fill_row(w: Work, n: int, row: int, j: int) -> None:
    """Set the row of the tableau of u_j, scaled."""
    start = row * (n + 2)
    for i in range(w.law_count):
        first = w.law_first[i]
        place = start + w.law_block[i]
        w.law_tableau[place] = w.law_row_scale[j] * normal_effect(w, i, j) * w.law_scale[first]
        if has_cone(w, i):
            own = w.law_w[j * w.law_rows + first + 1]
            w.law_tableau[place + 1] = w.law_row_scale[j] * own * w.law_scale[first]
            w.law_tableau[place + 2] = 0.0
    w.law_tableau[start + n] = 1.0
    w.law_tableau[start + n + 1] = w.law_row_scale[j] * w.law_u[j]


def fill_tableau(w: Work, n: int) -> None:
    """Set the tableau: each basic variable as a sum of the others, the artificial one, and a constant."""
    for i in range(w.law_count):
        first = w.law_first[i]
        w.law_p[first] = w.law_least[i]
        for k in range(w.law_slips[i]):
            along = 1.0 if has_cone(w, i) else w.law_direction[2 * i + k]
            w.law_p[first + 1 + k] = -w.law_mu[i] * w.law_least[i] * along if w.law_mu[i] > 0.0 else 0.0
    relative_motion(w)
    for k in range(n):
        w.law_basic[k] = k
        w.law_cobasic[k] = n + k
    w.law_cobasic[n] = 2 * n
    for i in range(w.law_count):
        first = w.law_first[i]
        row = w.law_block[i]
        fill_row(w, n, row, first)
        if has_cone(w, i):
            fill_row(w, n, row + 1, first + 1)
            w.law_tableau[(row + 1) * (n + 2) + row + 2] = 1.0
            start = (row + 2) * (n + 2)
            for k in range(n):
                w.law_tableau[start + k] = 0.0
            w.law_tableau[start + row] = 2.0 * w.law_mu[i]
            w.law_tableau[start + row + 1] = -1.0
            w.law_tableau[start + n] = 1.0
            w.law_tableau[start + n + 1] = 2.0 * w.law_mu[i] * w.law_least[i] / w.law_scale[first]


def exchange(w: Work, n: int, row: int, column: int) -> None:
    """Exchange a basic variable with another one."""
    start = row * (n + 2)
    pivot = w.law_tableau[start + column]
    for k in range(n + 2):
        w.law_tableau[start + k] = -w.law_tableau[start + k] / pivot
    w.law_tableau[start + column] = 1.0 / pivot
    for i in range(n):
        factor = w.law_tableau[i * (n + 2) + column]
        if i != row and factor != 0.0:
            w.law_tableau[i * (n + 2) + column] = 0.0
            for k in range(n + 2):
                w.law_tableau[i * (n + 2) + k] += factor * w.law_tableau[start + k]
    other = w.law_basic[row]
    w.law_basic[row] = w.law_cobasic[column]
    w.law_cobasic[column] = other


def perturbation(w: Work, n: int, row: int, k: int) -> Real:
    """Return by how much a basic variable follows a symbolic perturbation of the k-th constant."""
    if w.law_basic[row] == k:
        return 1.0
    for c in range(n + 1):
        if w.law_cobasic[c] == k:
            return -w.law_tableau[row * (n + 2) + c]
    return 0.0


def is_before(w: Work, n: int, row: int, other: int, column: int) -> bool:
    """Return whether a basic variable reaches zero before another one. The artificial one is first at ties;
    others are ordered by symbolic perturbations of the constants."""
    own = -w.law_tableau[row * (n + 2) + column]
    its = -w.law_tableau[other * (n + 2) + column]
    apart = w.law_tableau[row * (n + 2) + n + 1] / own - w.law_tableau[other * (n + 2) + n + 1] / its
    if fabs(apart) > LAW_TIE * w.law_size:
        return apart < 0.0
    if w.law_basic[row] == 2 * n or w.law_basic[other] == 2 * n:
        return w.law_basic[row] == 2 * n
    for k in range(n):
        apart = perturbation(w, n, row, k) / own - perturbation(w, n, other, k) / its
        if fabs(apart) > LAW_TIE:
            return apart < 0.0
    return row < other


def leaving_row(w: Work, n: int, column: int) -> int:
    """Return the row of the basic variable that reaches zero first as another variable grows; -1: none."""
    best = -1
    for row in range(n):
        if w.law_tableau[row * (n + 2) + column] < -LAW_TIE:
            if best < 0 or is_before(w, n, row, best, column):
                best = row
    return best


def pivot_to_solution(w: Work, n: int) -> bool:
    """Make the pivots of Lemke's method. Return False at a secondary ray."""
    row = 0
    for k in range(n):
        if w.law_tableau[k * (n + 2) + n + 1] <= w.law_tableau[row * (n + 2) + n + 1]:
            row = k
    if w.law_tableau[row * (n + 2) + n + 1] >= 0.0:
        return True
    column = n
    for count in range(MOST_PIVOTS * n):
        left = w.law_basic[row]
        exchange(w, n, row, column)
        if left == 2 * n:
            return True
        entering = left + n if left < n else left - n
        for c in range(n + 1):
            if w.law_cobasic[c] == entering:
                column = c
        row = leaving_row(w, n, column)
        if row < 0:
            return False
    return False


def solve_complementarity(w: Work) -> bool:
    """Compute w.law_p and w.law_u of one-sided contacts with at most one slip row each. Return False if the
    method ends without a solution; without friction there is none then."""
    n = count_complementary(w)
    fill_tableau(w, n)
    if not pivot_to_solution(w, n):
        return False
    for row in range(n):
        k = w.law_basic[row] - n
        for i in range(w.law_count):
            first = w.law_first[i]
            value = w.law_tableau[row * (n + 2) + n + 1] * w.law_scale[first]
            if value > 0.0:
                if k == w.law_block[i]:
                    w.law_p[first] += value
                    for m in range(w.law_slips[i]):
                        along = 1.0 if has_cone(w, i) else w.law_direction[2 * i + m]
                        if w.law_mu[i] > 0.0:
                            w.law_p[first + 1 + m] -= w.law_mu[i] * value * along
                elif has_cone(w, i) and k == w.law_block[i] + 1:
                    w.law_p[first + 1] += value
    relative_motion(w)
    return True
