"""Shares of a load that contacts may bear in many ways: the smallest forces within their friction cones.

The rows of closed contacts, Q z = c with orthonormal Q, leave forces z open. The smallest ones in the product K
of the cones, min 1/2 z' D z, are z = P(D^-1 Q' y), where P projects on K and y solves Q P(D^-1 Q' y) = c. This is
the gradient of a convex function: Newton's method with its generalised derivative, which in the plane ends after
finitely many steps (L. Qi, J. Sun, Math. Programming 58 (1993) 353-367). Where a residual r has Q' r in the polar
cone of K and r' c > 0, no forces in K bear the load (J. Farkas, 1902).
"""

from math import fabs, sqrt

from lagc.kernels.contact.conditions import is_admissible
from lagc.kernels.contact.frozen_modes import CONTACT_STICKS, relative_motion, slip_forces, solve_modes
from lagc.kernels.language.vocabulary import *

FEW_SHARINGS = 20  # Newton iterations for the smallest forces
MOST_SHARINGS = 60  # the same for the largest margin, for each weight
SHARED = by_type(1e-5, 1e-13, "1e-28")  # residual of a load that is borne, over the load
FARTHEST_SHARE = by_type(1e2, 1e4, "1e8")  # over the load: larger forces do not count
SHARE_DAMPING = by_type(1e-3, 1e-6, "1e-12")  # of the second derivative
OPEN_SHARE = by_type(1e-4, 1e-9, "1e-18")  # of the load: a force or a margin that is zero


def share_slips(w: Work, e: int) -> int:
    """Return how many unknowns of friction follow the normal force e; -1 if e is none."""
    i = w.law_contact[e]
    if w.law_unknown[e] != w.law_first[i]:
        return -1
    return w.law_slips[i] if w.law_mode[i] == CONTACT_STICKS else 0


def project_share(w: Work, pull: Vec[NLAW], share: Vec[NLAW]) -> None:
    """Project forces on the cones. w.law_share_place: 0 at the apex, 1 within, 2 on the boundary."""
    for e in range(w.law_unknowns):
        m = share_slips(w, e)
        if m >= 0:
            i = w.law_contact[e]
            mu = w.law_mu[i]
            total = 0.0
            for k in range(1, m + 1):
                total += pull[e + k] * pull[e + k]
            aside = sqrt(total)
            w.law_share_place[e] = 2
            normal = 0.0
            slip = 0.0
            if w.law_two_sided[i] > 0 or (pull[e] >= 0.0 and aside <= mu * pull[e]):
                w.law_share_place[e] = 1
                normal = pull[e]
                slip = 1.0
            elif pull[e] <= 0.0 and mu * aside <= -pull[e]:
                w.law_share_place[e] = 0
            else:
                normal = (pull[e] + mu * aside) / (1.0 + mu * mu)
                slip = mu * normal / aside
            share[e] = normal
            for k in range(1, m + 1):
                share[e + k] = slip * pull[e + k]


def share_slope(w: Work, e: int, m: int, k: int, j: int) -> Real:
    """Return the derivative of entry k of the projection by entry j of what is projected, for a block e."""
    if w.law_share_place[e] != 2:
        return 1.0 if w.law_share_place[e] == 1 and k == j else 0.0
    mu = w.law_mu[w.law_contact[e]]
    total = 0.0
    for i in range(1, m + 1):
        total += w.law_share_pull[e + i] * w.law_share_pull[e + i]
    aside = sqrt(total)
    along = 1.0
    across = 0.0
    if k > 0 and j > 0:
        across = (1.0 if k == j else 0.0) - w.law_share_pull[e + k] * w.law_share_pull[e + j] / total
    if k > 0:
        along *= mu * w.law_share_pull[e + k] / aside
    if j > 0:
        along *= mu * w.law_share_pull[e + j] / aside
    return along / (1.0 + mu * mu) + mu * w.law_share[e] / aside * across


def pull_share(w: Work, dual: Vec[NLAW], metric: bool) -> None:
    """Set w.law_share_pull to Q' y, or to D^-1 Q' y."""
    n = w.law_unknowns
    for e in range(n):
        total = 0.0
        for k in range(w.law_rank):
            total += w.law_matrix[w.law_order[k] * n + e] * dual[k]
        w.law_share_pull[e] = total / w.law_share_metric[e] if metric else total


def share_value(w: Work) -> Real:
    """Set w.law_share for w.law_share_dual; return the value of the convex function."""
    pull_share(w, w.law_share_dual, True)
    project_share(w, w.law_share_pull, w.law_share)
    total = 0.0
    for e in range(w.law_unknowns):
        total += 0.5 * w.law_share_metric[e] * w.law_share[e] * w.law_share[e]
    for k in range(w.law_rank):
        total -= w.law_right[w.law_order[k]] * w.law_share_dual[k]
    return total


def share_rest(w: Work) -> Real:
    """Set w.law_share_rest to the load that is not borne; return its length."""
    n = w.law_unknowns
    length = 0.0
    for k in range(w.law_rank):
        row = w.law_order[k]
        total = w.law_right[row]
        for e in range(n):
            total -= w.law_matrix[row * n + e] * w.law_share[e]
        w.law_share_rest[k] = total
        length += total * total
    return sqrt(length)


def no_share(w: Work, load: Real) -> bool:
    """Return whether no forces up to the farthest share bear the load, by w.law_share_rest."""
    pull_share(w, w.law_share_rest, False)
    project_share(w, w.law_share_pull, w.law_share_step)
    total = 0.0
    for e in range(w.law_unknowns):
        total += w.law_share_step[e] * w.law_share_step[e]
    along = 0.0
    for k in range(w.law_rank):
        along += w.law_share_rest[k] * w.law_right[w.law_order[k]]
    return FARTHEST_SHARE * load * sqrt(total) <= along


def solve_share(w: Work, count: int) -> None:
    """Solve L L' w.law_share_step = w.law_share_rest for the factor in w.law_share_matrix."""
    n = w.law_unknowns
    for k in range(count):
        total = w.law_share_rest[k]
        for j in range(k):
            total -= w.law_share_matrix[k * n + j] * w.law_share_step[j]
        w.law_share_step[k] = total / w.law_share_matrix[k * n + k]
    for k in range(count):
        last = count - 1 - k
        total = w.law_share_step[last]
        for j in range(last + 1, count):
            total -= w.law_share_matrix[j * n + last] * w.law_share_step[j]
        w.law_share_step[last] = total / w.law_share_matrix[last * n + last]


def share_direction(w: Work) -> None:
    """Set w.law_share_step to the step of Newton's method for w.law_share_dual, by Cholesky's method."""
    n = w.law_unknowns
    rank = w.law_rank
    largest = 0.0
    for e in range(n):
        if 1.0 / w.law_share_metric[e] > largest:
            largest = 1.0 / w.law_share_metric[e]
    for k in range(rank):
        for j in range(k + 1):
            total = SHARE_DAMPING * largest if k == j else 0.0
            for e in range(n):
                m = share_slips(w, e)
                if m >= 0 and w.law_share_place[e] > 0:
                    for a in range(m + 1):
                        for b in range(m + 1):
                            own = w.law_matrix[w.law_order[k] * n + e + a] * w.law_matrix[w.law_order[j] * n + e + b]
                            if own != 0.0:
                                total += own * share_slope(w, e, m, a, b) / w.law_share_metric[e]
            w.law_share_matrix[k * n + j] = total
    for k in range(rank):
        for j in range(k + 1):
            total = w.law_share_matrix[k * n + j]
            for i in range(j):
                total -= w.law_share_matrix[k * n + i] * w.law_share_matrix[j * n + i]
            if k == j:
                least = 1e-3 * SHARE_DAMPING * largest
                w.law_share_matrix[k * n + k] = sqrt(total if total > least else least)
            else:
                w.law_share_matrix[k * n + j] = total / w.law_share_matrix[j * n + j]
    solve_share(w, rank)


def set_share_metric(w: Work) -> Real:
    """Set w.law_share_metric, which measures all forces alike, and w.law_share_dual; return the size of the load."""
    mean = 0.0
    for e in range(w.law_unknowns):
        mean += w.law_scale[w.law_unknown[e]] / float(w.law_unknowns)
    for e in range(w.law_unknowns):
        own = w.law_scale[w.law_unknown[e]] / mean
        w.law_share_metric[e] = own * own
    load = 0.0
    for k in range(w.law_rank):
        own = w.law_right[w.law_order[k]]
        w.law_share_dual[k] = own
        load += own * own
    return sqrt(load)


def span_open(w: Work) -> int:
    """Set the rows of w.law_share_basis to orthonormal vectors across the equations; return their number. Set
    w.law_share_origin to the shortest forces."""
    n = w.law_unknowns
    rank = w.law_rank
    count = n - rank
    for e in range(n):
        total = 0.0
        for k in range(rank):
            total += w.law_matrix[w.law_order[k] * n + e] * w.law_right[w.law_order[k]]
        w.law_share_origin[e] = total
    for i in range(count):
        best = 0
        most = -1.0
        for e in range(n):
            left = 1.0
            for k in range(rank):
                own = w.law_matrix[w.law_order[k] * n + e]
                left -= own * own
            for k in range(i):
                left -= w.law_share_basis[k * n + e] * w.law_share_basis[k * n + e]
            if left > most:
                most = left
                best = e
        for e in range(n):
            w.law_share_basis[i * n + e] = 1.0 if e == best else 0.0
        for turn in range(2):
            for k in range(rank + i):
                total = 0.0
                for e in range(n):
                    own = w.law_matrix[w.law_order[k] * n + e] if k < rank else w.law_share_basis[(k - rank) * n + e]
                    total += own * w.law_share_basis[i * n + e]
                for e in range(n):
                    own = w.law_matrix[w.law_order[k] * n + e] if k < rank else w.law_share_basis[(k - rank) * n + e]
                    w.law_share_basis[i * n + e] -= total * own
        total = 0.0
        for e in range(n):
            total += w.law_share_basis[i * n + e] * w.law_share_basis[i * n + e]
        for e in range(n):
            w.law_share_basis[i * n + e] /= sqrt(total)
    return count


def cone_shift(w: Work, e: int) -> Real:
    """Return the entry e of the vector by which cones are moved inwards for a margin of 1."""
    m = share_slips(w, e)
    if m < 0:
        return 0.0
    return 1.0 if m == 0 else 1.0 / w.law_mu[w.law_contact[e]]


def cone_square(w: Work, e: int, m: int) -> Real:
    """Return mu^2 a^2 - |b|^2 of a block of w.law_share_pull; negative outside its cone."""
    mu = w.law_mu[w.law_contact[e]] if m > 0 else 1.0
    total = mu * mu * w.law_share_pull[e] * w.law_share_pull[e]
    for k in range(1, m + 1):
        total -= w.law_share_pull[e + k] * w.law_share_pull[e + k]
    return total if w.law_share_pull[e] > 0.0 else -1.0


def place_share(w: Work, count: int) -> bool:
    """Set w.law_share and w.law_share_pull, these forces in cones moved by the margin, for the unknowns
    w.law_share_dual; return whether they are inside."""
    n = w.law_unknowns
    for e in range(n):
        total = w.law_share_origin[e]
        for k in range(count):
            total += w.law_share_basis[k * n + e] * w.law_share_dual[k]
        w.law_share[e] = total
        w.law_share_pull[e] = total - w.law_share_dual[count] * cone_shift(w, e)
    for e in range(n):
        m = share_slips(w, e)
        if m >= 0 and not cone_square(w, e, m) > 0.0:
            return False
    return True


def barrier_column(w: Work, e: int, k: int, count: int) -> Real:
    """Return the derivative of entry e of w.law_share_pull by unknown k."""
    return w.law_share_basis[k * w.law_unknowns + e] if k < count else -cone_shift(w, e)


def barrier_step(w: Work, count: int, weight: Real) -> Real:
    """Set w.law_share_step to Newton's step for the largest margin with logarithmic barriers; return its decrement
    squared."""
    n = w.law_unknowns
    for k in range(count + 1):
        w.law_share_rest[k] = weight if k == count else 0.0
        for j in range(k + 1):
            w.law_share_matrix[k * n + j] = 0.0
    for e in range(n):
        m = share_slips(w, e)
        if m >= 0:
            mu = w.law_mu[w.law_contact[e]] if m > 0 else 1.0
            square = cone_square(w, e, m)
            for k in range(count + 1):
                along = 2.0 * mu * mu * w.law_share_pull[e] * barrier_column(w, e, k, count)
                for a in range(1, m + 1):
                    along -= 2.0 * w.law_share_pull[e + a] * barrier_column(w, e + a, k, count)
                w.law_share_rest[k] += along / square
                w.law_share_before[k] = along / square
                for j in range(k + 1):
                    second = mu * mu * barrier_column(w, e, k, count) * barrier_column(w, e, j, count)
                    for a in range(1, m + 1):
                        second -= barrier_column(w, e + a, k, count) * barrier_column(w, e + a, j, count)
                    own = w.law_share_before[k] * w.law_share_before[j] - 2.0 * second / square
                    w.law_share_matrix[k * n + j] += own
    for k in range(count + 1):
        w.law_share_before[k] = w.law_share_rest[k]
    least = SHARE_DAMPING * SPACING
    for k in range(count + 1):
        size = w.law_share_matrix[k * n + k]
        for j in range(k + 1):
            total = w.law_share_matrix[k * n + j]
            for i in range(j):
                total -= w.law_share_matrix[k * n + i] * w.law_share_matrix[j * n + i]
            if k == j:
                w.law_share_matrix[k * n + k] = sqrt(total if total > least * size else least * size)
            else:
                w.law_share_matrix[k * n + j] = total / w.law_share_matrix[j * n + j]
    solve_share(w, count + 1)
    decrement = 0.0
    for k in range(count + 1):
        decrement += w.law_share_step[k] * w.law_share_before[k]
    return decrement


def widest_share(w: Work, load: Real) -> Real:
    """Compute w.law_share, the forces that bear the load with the largest margin in all cones, and return it:
    negative where none bear it (Y. Nesterov, A. Nemirovskii, Interior-Point Polynomial Algorithms in Convex
    Programming, 1994, 5.4)."""
    count = span_open(w)
    cones = 0.0
    least = 0.0
    for k in range(count):
        w.law_share_dual[k] = 0.0
    for e in range(w.law_unknowns):
        m = share_slips(w, e)
        if m >= 0:
            cones += 2.0
            total = 0.0
            for k in range(1, m + 1):
                total += w.law_share_origin[e + k] * w.law_share_origin[e + k]
            own = w.law_share_origin[e] / cone_shift(w, e) - sqrt(total)
            if own < least:
                least = own
    w.law_share_dual[count] = least - load
    weight = cones / load
    inside = place_share(w, count)
    while inside and cones > SHARED * load * weight:
        for turn in range(MOST_SHARINGS):
            decrement = barrier_step(w, count, weight)
            if not decrement > 0.0:
                break
            part = 1.0 / (1.0 + sqrt(decrement)) if decrement > 0.25 else 1.0
            for k in range(count + 1):
                w.law_share_before[k] = w.law_share_dual[k]
            inside = False
            while not inside and part > 1e-9:
                for k in range(count + 1):
                    w.law_share_dual[k] = w.law_share_before[k] + part * w.law_share_step[k]
                inside = place_share(w, count)
                part *= 0.5
            if not inside:
                for k in range(count + 1):
                    w.law_share_dual[k] = w.law_share_before[k]
                place_share(w, count)
            if decrement < 0.01 or not inside or w.law_share_dual[count] > load:
                break
        if w.law_share_dual[count] > load:  # as of a wedge, that holds any load
            break
        weight *= 8.0
    return w.law_share_dual[count]


def find_share(w: Work, load: Real) -> bool:
    """Compute w.law_share, the smallest forces in the cones that bear the load. Return False if there are none."""
    value = share_value(w)
    for turn in range(FEW_SHARINGS):
        w.law_share_lack = share_rest(w)
        if w.law_share_lack <= SHARED * load:
            w.law_share_lack = 0.0
            return True
        if no_share(w, load):
            break
        value = share_value(w)
        share_direction(w)
        slope = 0.0
        for k in range(w.law_rank):
            slope += w.law_share_step[k] * w.law_share_rest[k]
            w.law_share_before[k] = w.law_share_dual[k]
        part = 1.0
        while part > 1e-9:
            for k in range(w.law_rank):
                w.law_share_dual[k] = w.law_share_before[k] + part * w.law_share_step[k]
            if share_value(w) <= value - 1e-4 * part * slope + 4.0 * SPACING * fabs(value):
                break
            part *= 0.5
    for i in range(w.law_count):
        if w.law_two_sided[i] > 0 or (w.law_mode[i] == CONTACT_STICKS and not w.law_mu[i] > 0.0):
            return False
    margin = widest_share(w, load)
    for e in range(w.law_unknowns):
        w.law_share_place[e] = 1
    w.law_share_lack = 0.0 if margin > 0.0 else -margin
    return margin > 0.0


def is_shared(w: Work) -> bool:
    """Return whether closed contacts bear their load in many ways, after `solve_modes`."""
    if w.law_rank >= w.law_unknowns or w.law_turning:
        return False
    for i in range(w.law_count):
        if w.law_least[i] > 0.0:
            return False
    return True


def share_load(w: Work) -> bool:
    """Set w.law_p and w.law_u to the smallest forces in the cones, after `solve_modes` in modes that leave them
    open. Return False, with the load that cannot be borne w.law_share_lack, if there are none."""
    load = set_share_metric(w)
    w.law_share_lack = 0.0
    if load > 0.0:
        if not find_share(w, load):
            return False
        n = w.law_unknowns
        share_rest(w)
        for e in range(n):
            for k in range(w.law_rank):
                w.law_share[e] += w.law_matrix[w.law_order[k] * n + e] * w.law_share_rest[k]
            if share_slips(w, e) >= 0 and w.law_share_place[e] == 0:
                w.law_share[e] = 0.0
            w.law_p[w.law_unknown[e]] = w.law_scale[w.law_unknown[e]] * w.law_share[e]
        slip_forces(w)
        relative_motion(w)
        for e in range(w.law_unknowns):
            w.law_u[w.law_unknown[e]] = 0.0
    return True


def meets_law(w: Work) -> bool:
    """Return whether the law has a solution in the modes w.law_mode, w.law_p and w.law_u."""
    if not solve_modes(w):
        return False
    if is_shared(w):
        share_load(w)
    return is_admissible(w)
