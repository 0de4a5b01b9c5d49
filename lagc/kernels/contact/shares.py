"""Shares of a load that contacts may bear in many ways: the smallest forces within their friction cones.

The rows of closed contacts, Q z = c with orthonormal Q, leave the scaled forces z open. The smallest ones in the
product K of the cones, min 1/2 z' D z, are z = P(D^-1 Q' y), where P projects on K and Q z = c. This is the
gradient of a convex function of y. Newton's method takes the generalised derivative of P (L. Qi, J. Sun, Math.
Programming 58 (1993) 353-367) and adds to it a part of the load that is left, as near the limit of what the cones
bear y has no bound (D.-H. Li, M. Fukushima, L. Qi, N. Yamashita, Comput. Optim. Appl. 28 (2004) 131-147). Beyond
the limit z tends to the forces in K that leave the least load. Where a load r that is left has Q' r in the polar
cone of K and r' c > 0, no forces in K bear it (J. Farkas, 1902).
"""

from math import fabs, sqrt

from lagc.kernels.contact.conditions import is_admissible
from lagc.kernels.contact.frozen_modes import CONTACT_STICKS, relative_motion, slip_forces, solve_modes
from lagc.kernels.language.vocabulary import *

MOST_SHARINGS = 80  # Newton iterations
SHARED = by_type(1e-5, 1e-13, "1e-28")  # of the load: what is left ends the iterations
BORNE = by_type(1e-4, 1e-10, "1e-20")  # of the load: with less left, it is borne
FARTHEST_SHARE = by_type(1e2, 1e4, "1e8")  # over the load: larger forces do not count, as in a wedge
SHARE_DAMPING = 1e-5  # of the second derivative, for a load that is left whole
SHORTEST_STEP = 1e-4  # of a step
AT_BOUND = by_type(
    1e-4, 1e-9, "1e-18"
)  # of the largest force: a force, or a distance from a cone, that is zero

OUTSIDE = 0  # places of what is projected: the nearest forces are 0
WITHIN = 1
ON_SURFACE = 2  # the nearest forces are on the surface of the cone


def sticking_rows(w: Work, e: int) -> int:
    """Return how many unknowns of friction follow the normal force e; -1 if e is none."""
    i = w.law_contact[e]
    if w.law_unknown[e] != w.law_first[i]:
        return -1
    return w.law_slips[i] if w.law_mode[i] == CONTACT_STICKS else 0


def aside_of(w: Work, e: int, m: int) -> Real:
    """Return the length of the friction in w.law_pull that follows the normal force e."""
    total = 0.0
    for k in range(1, m + 1):
        total += w.law_pull[e + k] * w.law_pull[e + k]
    return sqrt(total)


def project_pull(w: Work) -> None:
    """Set w.law_share to the projection of w.law_pull on the cones, and w.law_place. Forces of two-sided contacts
    have none."""
    for e in range(w.law_unknowns):
        m = sticking_rows(w, e)
        if m >= 0:
            mu = w.law_mu[w.law_contact[e]]
            normal = w.law_pull[e]
            aside = aside_of(w, e, m)
            slip = 1.0
            w.law_place[e] = WITHIN
            if w.law_two_sided[w.law_contact[e]] == 0 and not (normal >= 0.0 and aside <= mu * normal):
                w.law_place[e] = OUTSIDE if mu * aside <= -normal else ON_SURFACE
                normal = (normal + mu * aside) / (1.0 + mu * mu) if w.law_place[e] == ON_SURFACE else 0.0
                slip = mu * normal / aside if aside > 0.0 else 0.0
            w.law_share[e] = normal
            for k in range(1, m + 1):
                w.law_share[e + k] = slip * w.law_pull[e + k]


def share_slope(w: Work, e: int, m: int, k: int, j: int) -> Real:
    """Return the derivative of entry e + k of w.law_share by entry e + j of w.law_pull."""
    if w.law_place[e] != ON_SURFACE:
        return 1.0 if w.law_place[e] == WITHIN and k == j else 0.0
    mu = w.law_mu[w.law_contact[e]]
    aside = aside_of(w, e, m)
    one = 1.0 if k == 0 else mu * w.law_pull[e + k] / aside
    other = 1.0 if j == 0 else mu * w.law_pull[e + j] / aside
    value = one * other / (1.0 + mu * mu)
    if k > 0 and j > 0:
        across = (1.0 if k == j else 0.0) - w.law_pull[e + k] * w.law_pull[e + j] / (aside * aside)
        value += mu * w.law_share[e] / aside * across
    return value


def pull_along(w: Work, dual: Vec[NLAW]) -> None:
    """Set w.law_pull to Q' y."""
    n = w.law_unknowns
    for e in range(n):
        total = 0.0
        for k in range(w.law_rank):
            total += w.law_matrix[w.law_order[k] * n + e] * dual[k]
        w.law_pull[e] = total


def share_value(w: Work) -> Real:
    """Set w.law_share for w.law_dual; return the value of the convex function, and set w.law_share_terms to the
    sum of the magnitudes of its terms."""
    pull_along(w, w.law_dual)
    for e in range(w.law_unknowns):
        w.law_pull[e] /= w.law_metric[e]
    project_pull(w)
    value = 0.0
    for e in range(w.law_unknowns):
        value += 0.5 * w.law_metric[e] * w.law_share[e] * w.law_share[e]
    w.law_share_terms = value
    for k in range(w.law_rank):
        term = w.law_right[w.law_order[k]] * w.law_dual[k]
        w.law_share_terms += fabs(term)
        value -= term
    return value


def load_left(w: Work) -> Real:
    """Set w.law_left to the load that w.law_share does not bear; return its length."""
    n = w.law_unknowns
    length = 0.0
    for k in range(w.law_rank):
        row = w.law_order[k]
        total = w.law_right[row]
        for e in range(n):
            total -= w.law_matrix[row * n + e] * w.law_share[e]
        w.law_left[k] = total
        length += total * total
    return sqrt(length)


def no_share(w: Work, load: Real) -> bool:
    """Return whether no forces up to the farthest share bear the load, by w.law_left. Changes w.law_share."""
    pull_along(w, w.law_left)
    project_pull(w)
    total = 0.0
    for e in range(w.law_unknowns):
        total += w.law_share[e] * w.law_share[e]
    along = 0.0
    for k in range(w.law_rank):
        along += w.law_left[k] * w.law_right[w.law_order[k]]
    return FARTHEST_SHARE * load * sqrt(total) <= along


def second_derivative(w: Work, k: int, j: int) -> Real:
    """Return an entry of Q P' D^-1 Q'."""
    n = w.law_unknowns
    row = w.law_order[k] * n
    other = w.law_order[j] * n
    total = 0.0
    for e in range(n):
        m = sticking_rows(w, e)
        if m >= 0 and w.law_place[e] != OUTSIDE:
            own = 0.0
            for a in range(m + 1):
                for b in range(m + 1):
                    if w.law_matrix[row + e + a] != 0.0 and w.law_matrix[other + e + b] != 0.0:
                        slope = share_slope(w, e, m, a, b)
                        own += w.law_matrix[row + e + a] * slope * w.law_matrix[other + e + b]
            total += own / w.law_metric[e]
    return total


def newton_step_of_dual(w: Work, part: Real) -> None:
    """Set w.law_step to the step of w.law_dual for w.law_left, by the factors L L' of the second derivative. To its
    diagonal a part of the largest entry of D^-1 is added."""
    n = w.law_unknowns
    largest = 0.0
    for e in range(n):
        if 1.0 / w.law_metric[e] > largest:
            largest = 1.0 / w.law_metric[e]
    for k in range(w.law_rank):
        # Row k of L, then the solution of L s = left.
        for j in range(k + 1):
            total = second_derivative(w, k, j)
            for i in range(j):
                total -= w.law_factor[k * n + i] * w.law_factor[j * n + i]
            if k == j:
                least = SPACING * largest
                total += part * largest
                w.law_factor[k * n + k] = sqrt(total if total > least else least)
            else:
                w.law_factor[k * n + j] = total / w.law_factor[j * n + j]
        total = w.law_left[k]
        for j in range(k):
            total -= w.law_factor[k * n + j] * w.law_step[j]
        w.law_step[k] = total / w.law_factor[k * n + k]
    for k in range(w.law_rank - 1, -1, -1):
        total = w.law_step[k]
        for j in range(k + 1, w.law_rank):
            total -= w.law_factor[j * n + k] * w.law_step[j]
        w.law_step[k] = total / w.law_factor[k * n + k]


def set_share_metric(w: Work) -> None:
    """Set w.law_metric, D, which measures all forces alike along gaps of one unit. Those along gaps of other units
    are measured by the scales of their contacts."""
    for e in range(w.law_unknowns):
        unit = w.law_unit[w.law_contact[e]]
        total = 0.0
        count = 0.0
        for k in range(w.law_unknowns):
            if w.law_unit[w.law_contact[k]] == unit:
                total += w.law_scale[w.law_unknown[k]]
                count += 1.0
        own = w.law_scale[w.law_unknown[e]] * count / total
        w.law_metric[e] = own * own


def find_shares(w: Work, load: Real) -> None:
    """Compute w.law_share, the smallest forces in the cones that bear the load, or those that leave the least of
    it, with the length of what they leave, w.law_lack."""
    value = share_value(w)
    w.law_lack = load_left(w)
    for turn in range(MOST_SHARINGS):
        if w.law_lack <= SHARED * load:
            break
        ends = no_share(w, load)
        value = share_value(w)
        if ends:
            break
        newton_step_of_dual(w, SHARE_DAMPING * w.law_lack / load + 4.0 * SPACING)
        terms = w.law_share_terms
        slope = 0.0
        for k in range(w.law_rank):
            slope += w.law_step[k] * w.law_left[k]
            w.law_dual_before[k] = w.law_dual[k]
        part = 1.0
        while part > SHORTEST_STEP:
            for k in range(w.law_rank):
                w.law_dual[k] = w.law_dual_before[k] + part * w.law_step[k]
            if share_value(w) <= value - 1e-4 * part * slope + 4.0 * SPACING * terms:
                break
            part *= 0.5
        w.law_lack = load_left(w)
    if w.law_lack <= BORNE * load:
        w.law_lack = 0.0


def is_shared(w: Work) -> bool:
    """Return whether closed contacts bear their load in many ways, after `solve_modes`."""
    if w.law_rank >= w.law_unknowns or w.law_turning:
        return False
    for i in range(w.law_count):
        if w.law_least[i] > 0.0:
            return False
    return True


def share_load(w: Work) -> None:
    """Set w.law_p and w.law_u to the smallest forces in the cones, after `solve_modes` in modes that leave them
    open. If there are none, only w.law_lack, the load that is left, and w.law_share are set."""
    n = w.law_unknowns
    load = 0.0
    for k in range(w.law_rank):
        w.law_dual[k] = w.law_right[w.law_order[k]]
        load += w.law_dual[k] * w.law_dual[k]
    set_share_metric(w)
    find_shares(w, sqrt(load))
    if w.law_lack > 0.0:
        return
    for e in range(n):
        if not (sticking_rows(w, e) >= 0 and w.law_place[e] == OUTSIDE):
            for k in range(w.law_rank):  # u = 0 to round-off
                w.law_share[e] += w.law_matrix[w.law_order[k] * n + e] * w.law_left[k]
        w.law_p[w.law_unknown[e]] = w.law_scale[w.law_unknown[e]] * w.law_share[e]
    slip_forces(w)
    relative_motion(w)
    for e in range(n):
        w.law_u[w.law_unknown[e]] = 0.0


def meets_law(w: Work) -> bool:
    """Return whether the law has a solution in the modes w.law_mode, w.law_p and w.law_u."""
    if not solve_modes(w):
        return False
    if is_shared(w):
        share_load(w)
    return is_admissible(w)
