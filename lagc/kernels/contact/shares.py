"""Shares of a load that contacts may bear in many ways: the smallest forces within their friction cones.

The rows of closed contacts, Q z = c with orthonormal Q, leave the scaled forces z open. The smallest ones in
the product K of the cones, min 1/2 z' D z, are z = P(D^-1 Q' y), where P projects on K. The load that they
leave, c - Q z, is the gradient of a concave function of y. Newton's method takes the generalised derivative
of P (L. Qi, J. Sun, Math. Programming 58 (1993) 353-367) and adds to it a part of the load that is left, as
near the limit of what the cones bear y has no bound (D.-H. Li, M. Fukushima, L. Qi, N. Yamashita, Comput.
Optim. Appl. 28 (2004) 131-147). Beyond the limit z tends to the forces in K that leave the least load. Where
a load r that is left has Q' r in the polar cone of K and r' c > 0, no forces in K bear it (J. Farkas, 1902).
Contacts that no row connects are solved apart: neither decides about the other.
"""

from math import fabs, sqrt

from lagc.kernels.contact.law import CONTACT_STICKS, is_admissible, relative_motion, slip_forces, solve_modes
from lagc.kernels.language.vocabulary import *

MOST_SHARINGS = 80  # Newton iterations
SHARED = by_type(1e-5, 1e-13, "1e-28")  # of the load: what is left ends the iterations
BORNE = by_type(1e-4, 1e-10, "1e-20")  # of the load: with less left, it is borne
FARTHEST_SHARE = by_type(1e2, 1e4, "1e8")  # over the load: larger forces do not count, as in a wedge
SHARE_DAMPING = 1e-5  # of the second derivative, for a load that is left whole
SHORTEST_STEP = 1e-4  # of a step
AT_BOUND = by_type(1e-4, 1e-9, "1e-18")  # of the largest force: a force, or a distance from a cone, is zero

OUTSIDE = 0  # places of what is projected: the nearest forces are 0
WITHIN = 1
ON_SURFACE = 2  # the nearest forces are on the surface of the cone


def is_in_block(law: ContactLaw, e: int) -> bool:
    """Return whether an unknown belongs to the block that is solved."""
    return law.block[law.contact[e]] == law.block_now


def sticking_rows(law: ContactLaw, e: int) -> int:
    """Return how many unknowns of friction follow the normal force e; -1 if e is none of the block."""
    i = law.contact[e]
    if law.unknown[e] != law.first[i] or not is_in_block(law, e):
        return -1
    return law.slips[i] if law.mode[i] == CONTACT_STICKS else 0


def aside_of(law: ContactLaw, e: int, m: int) -> Real:
    """Return the length of the friction in law.pull that follows the normal force e."""
    total = 0.0
    for k in range(1, m + 1):
        total += law.pull[e + k] * law.pull[e + k]
    return sqrt(total)


def project_pull(law: ContactLaw) -> None:
    """Set law.share to the projection of law.pull on the cones, and law.place."""
    # Projection on the cone |p_t| <= mu p_n in closed form, for each contact alone.
    for e in range(law.unknowns):
        m = sticking_rows(law, e)
        if m >= 0:
            mu = law.mu[law.contact[e]]
            normal = law.pull[e]
            aside = aside_of(law, e, m)
            slip = 1.0
            law.place[e] = WITHIN
            # In the polar cone, mu |p_t| <= -p_n, the nearest point is the tip. Between the two cones it is
            # on the surface: p_n' = (p_n + mu |p_t|) / (1 + mu^2) and |p_t'| = mu p_n'.
            if not (normal >= 0.0 and aside <= mu * normal):
                law.place[e] = OUTSIDE if mu * aside <= -normal else ON_SURFACE
                normal = (normal + mu * aside) / (1.0 + mu * mu) if law.place[e] == ON_SURFACE else 0.0
                slip = mu * normal / aside if aside > 0.0 else 0.0
            law.share[e] = normal
            for k in range(1, m + 1):
                law.share[e + k] = slip * law.pull[e + k]


def share_slope(law: ContactLaw, e: int, m: int, k: int, j: int) -> Real:
    """Return the derivative of entry e + k of law.share by entry e + j of law.pull."""
    # Within the cone the projection is the identity, in the polar cone zero.
    if law.place[e] != ON_SURFACE:
        return 1.0 if law.place[e] == WITHIN and k == j else 0.0
    # On the surface P is the projection on the ray (1, mu t), t = p_t / |p_t|, plus, between entries of
    # friction, what turning the ray adds: mu p_n / |p_t| (I - t t').
    mu = law.mu[law.contact[e]]
    aside = aside_of(law, e, m)
    one = 1.0 if k == 0 else mu * law.pull[e + k] / aside
    other = 1.0 if j == 0 else mu * law.pull[e + j] / aside
    value = one * other / (1.0 + mu * mu)
    if k > 0 and j > 0:
        across = (1.0 if k == j else 0.0) - law.pull[e + k] * law.pull[e + j] / (aside * aside)
        value += mu * law.share[e] / aside * across
    return value


def pull_along(law: ContactLaw, dual: Vec[NCROW]) -> None:
    """Set law.pull to Q' y."""
    n = law.unknowns
    for e in range(n):
        total = 0.0
        for k in range(law.rank):
            if law.row_block[k] == law.block_now:
                total += law.matrix[law.order[k] * n + e] * dual[k]
        law.pull[e] = total


def share_value(law: ContactLaw) -> Real:
    """Set law.share for law.dual; return the value of the convex function, and set law.share_terms to
    the sum of the magnitudes of its terms."""
    # z = P(D^-1 Q' y)
    pull_along(law, law.dual)
    for e in range(law.unknowns):
        law.pull[e] /= law.metric[e]
    project_pull(law)
    # 1/2 z' D z - c' y, whose gradient is Q z - c. Its terms are added up to know its round-off.
    value = 0.0
    for e in range(law.unknowns):
        if is_in_block(law, e):
            value += 0.5 * law.metric[e] * law.share[e] * law.share[e]
    law.share_terms = value
    for k in range(law.rank):
        if law.row_block[k] == law.block_now:
            term = law.right[law.order[k]] * law.dual[k]
            law.share_terms += fabs(term)
            value -= term
    return value


def load_left(law: ContactLaw) -> Real:
    """Set law.left to the load that law.share does not bear; return its length."""
    n = law.unknowns
    length = 0.0
    for k in range(law.rank):
        if law.row_block[k] != law.block_now:
            continue
        row = law.order[k]
        total = law.right[row]
        for e in range(n):
            if is_in_block(law, e):
                total -= law.matrix[row * n + e] * law.share[e]
        law.left[k] = total
        length += total * total
    return sqrt(length)


def no_share(law: ContactLaw, load: Real) -> bool:
    """Return whether no forces up to the farthest share bear the load, by law.left. Changes law.share."""
    # Farkas: by the polar cone and r' c. Forces up to `FARTHEST_SHARE` times the load do not count, so P(Q'
    # r) may be small instead of zero: |P(Q' r)| bounds z' Q' r over all z in K of length 1.
    pull_along(law, law.left)
    project_pull(law)
    total = 0.0
    for e in range(law.unknowns):
        if is_in_block(law, e):
            total += law.share[e] * law.share[e]
    along = 0.0
    for k in range(law.rank):
        if law.row_block[k] == law.block_now:
            along += law.left[k] * law.right[law.order[k]]
    return FARTHEST_SHARE * load * sqrt(total) <= along


def second_derivative(law: ContactLaw, k: int, j: int) -> Real:
    """Return an entry of Q P' D^-1 Q'."""
    # Blocks of P' are those of contacts: the sum goes over contacts, and over the entries of each.
    n = law.unknowns
    row = law.order[k] * n
    other = law.order[j] * n
    total = 0.0
    for e in range(n):
        m = sticking_rows(law, e)
        if m >= 0 and law.place[e] != OUTSIDE:
            own = 0.0
            for a in range(m + 1):
                for b in range(m + 1):
                    if law.matrix[row + e + a] != 0.0 and law.matrix[other + e + b] != 0.0:
                        slope = share_slope(law, e, m, a, b)
                        own += law.matrix[row + e + a] * slope * law.matrix[other + e + b]
            total += own / law.metric[e]
    return total


def newton_step_of_dual(law: ContactLaw, part: Real) -> None:
    """Set law.step to the step of law.dual for law.left, by the factors L L' of the second derivative.
    To its diagonal a part of the largest entry of D^-1 is added."""
    # The regularization of Li and Fukushima: a part of the largest entry of D^-1, in proportion to what is
    # left.
    n = law.unknowns
    largest = 0.0
    for e in range(n):
        if is_in_block(law, e) and 1.0 / law.metric[e] > largest:
            largest = 1.0 / law.metric[e]
    for k in range(law.rank):
        # Row k of L, then the solution of L s = left. Rows of other blocks are those of a unit matrix.
        if law.row_block[k] != law.block_now:
            for j in range(k + 1):
                law.factor[k * n + j] = 1.0 if j == k else 0.0
            law.step[k] = 0.0
            continue
        for j in range(k + 1):
            total = second_derivative(law, k, j)
            for i in range(j):
                total -= law.factor[k * n + i] * law.factor[j * n + i]
            if k == j:
                least = SPACING * largest
                total += part * largest
                law.factor[k * n + k] = sqrt(total if total > least else least)
            else:
                law.factor[k * n + j] = total / law.factor[j * n + j]
        total = law.left[k]
        for j in range(k):
            total -= law.factor[k * n + j] * law.step[j]
        law.step[k] = total / law.factor[k * n + k]
    # L' s = s, backwards.
    for k in range(law.rank - 1, -1, -1):
        total = law.step[k]
        for j in range(k + 1, law.rank):
            total -= law.factor[j * n + k] * law.step[j]
        law.step[k] = total / law.factor[k * n + k]


def set_share_metric(law: ContactLaw) -> None:
    """Set law.metric, D, which measures all forces alike along gaps of one unit. Those along gaps of other
    units are measured by the scales of their contacts."""
    # D is the same for all contacts of one unit (their mean scale): equal contacts under a load then have
    # equal forces, whatever W makes of their scales.
    for e in range(law.unknowns):
        unit = law.unit[law.contact[e]]
        total = 0.0
        count = 0.0
        for k in range(law.unknowns):
            if law.unit[law.contact[k]] == unit:
                total += law.scale[law.unknown[k]]
                count += 1.0
        own = law.scale[law.unknown[e]] * count / total
        law.metric[e] = own * own


def find_shares(law: ContactLaw, load: Real) -> Real:
    """Compute law.share, the smallest forces in the cones that bear the load of the block, or those that
    leave the least of it. Return the length of what they leave; 0 if that is round-off."""
    # Begin with y = c, as z = Q' c is the shortest solution without cones.
    value = share_value(law)
    lack = load_left(law)
    for turn in range(MOST_SHARINGS):
        if lack <= SHARED * load:
            break
        # `no_share` overwrites the forces, which the step needs.
        ends = no_share(law, load)
        value = share_value(law)
        if ends:
            break
        # Newton's step, damped by the part of the load that is left; 4 units in the last place keep the
        # factor regular.
        newton_step_of_dual(law, SHARE_DAMPING * lack / load + 4.0 * SPACING)
        terms = law.share_terms
        slope = 0.0
        for k in range(law.rank):
            if law.row_block[k] == law.block_now:
                slope += law.step[k] * law.left[k]
            law.dual_before[k] = law.dual[k]
        # The step is halved until the function falls by a part of its slope, or by round-off.
        # Armijo's rule with the slope -step . left.
        part = 1.0
        while part > SHORTEST_STEP:
            for k in range(law.rank):
                law.dual[k] = law.dual_before[k] + part * law.step[k]
            if share_value(law) <= value - 1e-4 * part * slope + 4.0 * SPACING * terms:
                break
            part *= 0.5
        lack = load_left(law)
    return 0.0 if lack <= BORNE * load else lack


def set_blocks(law: ContactLaw) -> None:
    """Set law.block, a number for the contacts that rows connect, and law.row_block."""
    n = law.unknowns
    # Contacts that a row of Q connects get one number: union by relabelling, as there are few.
    for i in range(law.count):
        law.block[i] = i
    for k in range(law.rank):
        block = -1
        for e in range(n):
            if law.matrix[law.order[k] * n + e] != 0.0:
                other = law.block[law.contact[e]]
                if block < 0:
                    block = other
                elif other != block:
                    for i in range(law.count):
                        if law.block[i] == other:
                            law.block[i] = block
    for k in range(law.rank):
        for e in range(n):
            if law.matrix[law.order[k] * n + e] != 0.0:
                law.row_block[k] = law.block[law.contact[e]]
                break


def find_sharing(law: ContactLaw) -> bool:
    """Set law.shared to 1 for closed contacts whose block bears its load in many ways, after `solve_modes`,
    and law.lack to 0. Return whether there are any. Blocks with two-sided contacts have the shortest
    forces."""
    for i in range(law.count):
        law.shared[i] = 0
        law.lack[i] = 0.0
    # Unique forces, unknown slip angles and least forces have no shares to choose from.
    if law.rank >= law.unknowns or law.turning:
        return False
    for i in range(law.count):
        if law.least[i] > 0.0:
            return False
    set_blocks(law)
    found = False
    for i in range(law.count):
        if law.block[i] != i:  # one contact of each block has its number
            continue
        # A block has more unknowns than independent rows if its forces are open.
        law.block_now = i
        more = 0
        for e in range(law.unknowns):
            if is_in_block(law, e):
                more += 1
        for k in range(law.rank):
            if law.row_block[k] == i:
                more -= 1
        for k in range(law.count):
            if law.block[k] == i and law.two_sided[k] > 0:
                more = 0
        if more > 0:
            found = True
            for k in range(law.count):
                if law.block[k] == i:
                    law.shared[k] = 1
    return found


def share_block(law: ContactLaw) -> None:
    """Set law.p of the block to its smallest forces in the cones. If there are none, only law.lack, the
    load that is left, and law.share are set."""
    n = law.unknowns
    # y begins with c.
    load = 0.0
    for k in range(law.rank):
        if law.row_block[k] == law.block_now:
            law.dual[k] = law.right[law.order[k]]
            load += law.dual[k] * law.dual[k]
    lack = find_shares(law, sqrt(load))
    for i in range(law.count):
        if law.block[i] == law.block_now:
            law.lack[i] = lack
    if lack > 0.0:
        return
    # Where the forces are not at the tip of a cone, the residual left is added along Q', so that u = 0 to
    # round-off.
    outside = False
    for e in range(n):
        if is_in_block(law, e):
            if law.unknown[e] == law.first[law.contact[e]]:
                outside = law.place[e] == OUTSIDE
            for k in range(law.rank):  # u = 0 to round-off
                if law.row_block[k] == law.block_now and not outside:
                    law.share[e] += law.matrix[law.order[k] * n + e] * law.left[k]
            law.p[law.unknown[e]] = law.scale[law.unknown[e]] * law.share[e]


def share_load(law: ContactLaw) -> None:
    """Set law.p and law.u to the smallest forces in the cones, of the contacts in law.shared, after
    `solve_modes` in modes that leave them open."""
    if not find_sharing(law):
        return
    set_share_metric(law)
    for i in range(law.count):
        if law.shared[i] > 0 and law.block[i] == i:
            law.block_now = i
            share_block(law)
    # u and p of all rows follow; what was solved for is zero.
    slip_forces(law)
    relative_motion(law)
    for e in range(law.unknowns):
        law.u[law.unknown[e]] = 0.0


def meets_law(law: ContactLaw) -> bool:
    """Return whether the law has a solution in the modes law.mode, law.p and law.u."""
    if not solve_modes(law):
        return False
    if NBESIDE > 0:
        share_load(law)
    return is_admissible(law)
