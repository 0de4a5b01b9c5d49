"""Impacts with restitution and dry friction.

All contacts that approach act at once, then again those that approach then, until none does. Newton's law
sets u_n after = -e u_n before. Poisson's law brings contacts to rest and gives back at least e times each
normal impulse of that; unlike Newton's law, it does not add energy where friction acts. In both, impulses
meet Coulomb's law with the velocities after (F. Pfeiffer, C. Glocker, Multibody Dynamics with Unilateral
Contacts, 1996, chapter 8; C. Glocker, Set-Valued Force Laws, 2001, chapter 12).
"""

from math import fabs

from lagc.kernels.contact.law import set_law_scales
from lagc.kernels.contact.modes import LAW_FAILED, LAW_FOUND, search_modes
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


def row_of_all(law: ContactLaw, a: ImpactWork, i: int, k: int) -> int:
    """Return the row among all contacts of a row of contact i of the round."""
    return law.first[a.contact[i]] + k


def select_hits(law: ContactLaw, a: ImpactWork) -> bool:
    """List the contacts that approach, and two-sided ones, as those of the round, with their part of W.
    Return whether any approaches."""
    hits = a.hits
    # A two-sided contact may take part by its friction in whatever impact there is.
    n = 0
    rows = 0
    found = False
    for i in range(law.count):
        first = law.first[i]
        approaches = law.u[first] < -APPROACHES * a.terms[first]
        if approaches and law.two_sided[i] == 0:
            found = True
        # Entries of the law of this round. mode = -1: nothing is known before.
        if approaches or law.two_sided[i] > 0:
            a.contact[n] = i
            hits.first[n] = rows
            hits.slips[n] = law.slips[i]
            hits.two_sided[n] = law.two_sided[i]
            hits.unit[n] = law.unit[i]
            hits.sign[n] = 1
            hits.mu[n] = law.friction[i]
            hits.slides[n] = 0
            hits.least[n] = 0.0
            hits.mode[n] = -1
            n += 1
            rows += law.slips[i] + 1
    hits.count = n
    hits.rows = rows
    # Their part of W: others take no part, whatever these impulses make of their velocities.
    for i in range(n):
        for k in range(hits.slips[i] + 1):
            from_row = row_of_all(law, a, i, k) * law.rows
            to_row = (hits.first[i] + k) * rows
            for j in range(n):
                for m in range(hits.slips[j] + 1):
                    hits.W[to_row + hits.first[j] + m] = law.W[from_row + row_of_all(law, a, j, m)]
    return found


def give_impulses(law: ContactLaw, a: ImpactWork) -> None:
    """Add the impulses of the round to law.p, change all velocities law.u by them, and count their terms."""
    hits = a.hits
    # u = u + W p in all rows, also of contacts that take no part: they may approach then.
    for i in range(hits.count):
        for k in range(hits.slips[i] + 1):
            column = row_of_all(law, a, i, k)
            impulse = hits.p[hits.first[i] + k]
            law.p[column] += impulse
            for j in range(law.rows):
                law.u[j] += law.W[j * law.rows + column] * impulse
    # Terms grow with what passed through: after many rounds a velocity has the round-off of its largest term.
    for j in range(law.rows):
        size = fabs(law.u[j])
        for i in range(hits.count):
            for k in range(hits.slips[i] + 1):
                entry = law.W[j * law.rows + row_of_all(law, a, i, k)]
                size += fabs(entry * hits.p[hits.first[i] + k])
        if size > a.terms[j]:
            a.terms[j] = size


def solve_impulses(law: ContactLaw, a: ImpactWork, restitution: bool) -> int:
    """Solve the law of the round for velocities after. With `restitution`, those of Newton's law."""
    hits = a.hits
    # b of the round is the velocity before, (1 + e) u_n in the normal row: then u_n = 0 of the law means u_n
    # after = -e u_n before.
    for i in range(hits.count):
        for k in range(hits.slips[i] + 1):
            row = hits.first[i] + k
            hits.b[row] = law.u[row_of_all(law, a, i, k)]
            hits.terms[row] = a.terms[row_of_all(law, a, i, k)]
        if restitution and hits.two_sided[i] == 0:
            hits.b[hits.first[i]] *= 1.0 + a.restitution[a.contact[i]]
    set_law_scales(a.hits)
    return search_modes(a.hits)


def strike_twice(law: ContactLaw, a: ImpactWork) -> int:
    """Solve a round by Poisson's law, compression and then expansion. Return the result of the law."""
    # Compression: impulses P_c bring the contacts to rest.
    hits = a.hits
    found = solve_impulses(law, a, False)
    if found > LAW_FOUND:
        return found
    # Expansion: at least e P_c in each contact that was compressed (S. D. Poisson); others may open freely.
    # Forces of the compression are given already, so velocities go on from there.
    give_impulses(law, a)
    expands = False
    for i in range(hits.count):
        if hits.two_sided[i] == 0:
            hits.least[i] = a.restitution[a.contact[i]] * hits.p[hits.first[i]]
            if hits.least[i] > 0.0:
                expands = True
            hits.mode[i] = -1
    if expands:
        found = solve_impulses(law, a, False)
        if found <= LAW_FOUND:
            give_impulses(law, a)
    return found


def strike(law: ContactLaw, a: ImpactWork) -> int:
    """Solve a round and give its impulses. Return the result of the law. If a contact has Poisson's law, all
    have it."""
    if NPOISSON > 0:
        for i in range(a.hits.count):
            if a.poisson[a.contact[i]] > 0:
                return strike_twice(law, a)
    found = solve_impulses(law, a, True)
    if found <= LAW_FOUND:
        give_impulses(law, a)
    return found


def count_loss(law: ContactLaw, a: ImpactWork) -> bool:
    """Add the energy that each contact took in a round to its loss, -p (u before + u after) / 2. Return False
    if energy has grown."""
    # Work of an impulse is p (u before + u after) / 2, exact since u is linear in p. Newton's law with
    # friction may gain energy (W. J. Stronge, Proc. R. Soc. Lond. A 431 (1990) 169-181): that is refused.
    gain = 0.0
    passed = 0.0
    for i in range(law.count):
        for k in range(law.slips[i] + 1):
            row = law.first[i] + k
            impulse = law.p[row] - a.p_before[row]
            work = 0.5 * impulse * (a.u_before[row] + law.u[row])
            a.loss[i] -= work
            gain += work
            passed += 0.5 * fabs(impulse) * (fabs(a.u_before[row]) + fabs(law.u[row]))
    return gain <= GAINED * passed


def impact(law: ContactLaw, a: ImpactWork) -> int:
    """Compute the impulses law.p of all contacts that touch, whose velocities before are law.b, and the
    velocities after, law.u, with the number of rounds and the energy that each contact took."""
    # Terms bound the round-off of velocities; they are at least |b|.
    for j in range(law.rows):
        law.p[j] = 0.0
        law.u[j] = law.b[j]
        a.terms[j] = law.terms[j] if law.terms[j] > fabs(law.b[j]) else fabs(law.b[j])
    for i in range(law.count):
        a.loss[i] = 0.0
    # Each round may make others approach: a blow passes through a row of balls.
    a.rounds = 0
    result = IMPACT_NONE
    while select_hits(law, a):
        if a.rounds == MOST_ROUNDS:
            result = IMPACT_ENDLESS
            break
        # u and p before the round, for its energy.
        a.u_before[:] = law.u
        a.p_before[:] = law.p
        found = strike(law, a)
        if found > LAW_FOUND:
            result = IMPACT_FAILED if found == LAW_FAILED else IMPACT_PARADOX
            break
        a.rounds += 1
        result = IMPACT_DONE
        if not count_loss(law, a):
            result = IMPACT_GAINS
            break
    return result
