"""Normal forces of two-sided contacts: constraints and joints with friction.

A component of such a force is a sum of accelerations, multipliers and forces of contacts,

    N = N0 + n_a a + n_lam lam + n_p p

and friction is at most mu |N|. The law has the row u_n = p_n - e . N = 0 with the direction e = N / |N|. To
solve it with this e, and again with that of the N that follows, is Newton's method for p_n = |N|: the
derivative of |N| is e. One component has a sign in place of a direction.
"""

from math import fabs, sqrt

from lagc.kernels.contact.impact import IMPACT_FAILED, IMPACT_NONE, impact
from lagc.kernels.contact.law import MOST_TURNS, TURNED, solve_frozen
from lagc.kernels.contact.modes import LAW_FAILED, LAW_FOUND, set_law
from lagc.kernels.language.vocabulary import *


def set_normals_given(a: Vec[NX], lam: Vec[NC], w: Work) -> None:
    """Set w.contacts.normal_given by accelerations, in the rates `a`, and multipliers."""
    # N0 + n_a a + n_lam lam: the normal force without forces of contacts.
    for k in range(NNORMAL):
        total = w.contacts.normal_bias[k]
        for j in range(NV):
            total += w.contacts.normal_rows[k * NKNOWN + j] * a[NQ + j]
        for j in range(NC):
            total += w.contacts.normal_rows[k * NKNOWN + NV + j] * lam[j]
        w.contacts.normal_given[k] = total


def set_normal_effects(w: Work) -> None:
    """Set w.contacts.normal_effects: the derivatives of components by the forces of listed rows."""
    # A force p_r acts on N directly, and by the accelerations and multipliers that it causes: n_p + n_(a,lam)
    # X.
    for k in range(NNORMAL):
        for r in range(w.contacts.law.rows):
            total = w.contacts.normal_rows[k * NKNOWN + NR + w.contacts.touching_rows[r]]
            for j in range(NR):
                total += w.contacts.normal_rows[k * NKNOWN + j] * w.contacts.responses[r * NR + j]
            w.contacts.normal_effects[k * w.contacts.law.rows + r] = total


def set_normal_axis(i: int, forces: Vec[NNORMAL], w: Work) -> Real:
    """Set w.contacts.normal_axes of a contact to the direction of its components; return their change."""
    first = normal_first[i]
    # e = N / |N|. Without a force any direction will do; the first axis is taken.
    total = 0.0
    for k in range(contact_normals[i]):
        total += forces[first + k] * forces[first + k]
    length = sqrt(total)
    turned = 0.0
    for k in range(contact_normals[i]):
        axis = forces[first + k] / length if length > 0.0 else 0.0
        if not length > 0.0 and k == 0:
            axis = 1.0
        if fabs(axis - w.contacts.normal_axes[first + k]) > turned:
            turned = fabs(axis - w.contacts.normal_axes[first + k])
        w.contacts.normal_axes[first + k] = axis
    return turned


def aim_normals(held: bool, w: Work) -> None:
    """Set the directions of the normal forces of listed contacts to those without the forces of contacts; if
    `held`, signs to w.contacts.normal_signs."""
    # Each contact's kind in the law: 1 for one component, whose sign may be negative, 2 for a direction.
    set_normal_effects(w)
    for n in range(w.contacts.law.count):
        i = w.contacts.touching[n]
        if contact_normals[i] > 0:
            w.contacts.law.two_sided[n] = 1 if contact_normals[i] == 1 else 2
            w.contacts.law.sign[n] = 1
            set_normal_axis(i, w.contacts.normal_given, w)
            if held and contact_normals[i] == 1 and w.contacts.normal_signs[i] != 0:
                w.contacts.normal_axes[normal_first[i]] = float(w.contacts.normal_signs[i])


def set_normal_laws(w: Work) -> None:
    """Set the rows of the law of normal forces for their directions."""
    # The row u_n = p_n - e . N = 0 of the law: b = -e . N without contacts, W = 1 for p_n itself less e .
    # dN/dp.
    law = w.contacts.law
    for n in range(law.count):
        i = w.contacts.touching[n]
        if contact_normals[i] > 0:
            row = law.first[n]
            total = 0.0
            size = 0.0
            for m in range(contact_normals[i]):
                k = normal_first[i] + m
                total -= w.contacts.normal_axes[k] * w.contacts.normal_given[k]
                size += fabs(w.contacts.normal_given[k])
            law.b[row] = total
            law.terms[row] = size
            for r in range(law.rows):
                total = 0.0
                for m in range(contact_normals[i]):
                    k = normal_first[i] + m
                    total -= w.contacts.normal_axes[k] * w.contacts.normal_effects[k * law.rows + r]
                law.W[row * law.rows + r] = total
            law.W[row * law.rows + row] = 1.0


def turn_normals(held: bool, w: Work) -> bool:
    """Turn the directions of normal forces to those of w.contacts.law.p; if `held`, not the signs. Return
    whether one has turned."""
    law = w.contacts.law
    # N that follows from the forces of the law, and the directions that it has. The law is solved again until
    # none has turned.
    forces = vector(NNORMAL)
    turned = 0.0
    for n in range(law.count):
        i = w.contacts.touching[n]
        if contact_normals[i] > 0 and not (held and contact_normals[i] == 1):
            for m in range(contact_normals[i]):
                k = normal_first[i] + m
                forces[k] = w.contacts.normal_given[k]
                for r in range(law.rows):
                    forces[k] += w.contacts.normal_effects[k * law.rows + r] * law.p[r]
            own = set_normal_axis(i, forces, w)
            if not own <= turned:
                turned = own
    return not turned <= TURNED


def solve_touching(w: Work) -> bool:
    """Solve the law in given modes (`solve_frozen`), with normal forces of two-sided contacts."""
    # In given modes signs are held within a step, so that forces pass through zero smoothly. The event that
    # this is belongs to the indicators.
    if NTWO > 0:
        aim_normals(w.modes_fixed, w)
        for n in range(MOST_TURNS):
            set_normal_laws(w)
            if not solve_frozen(w.contacts.law):
                return False
            if not turn_normals(w.modes_fixed, w):
                return True
        w.contacts.law.culprit = 0
        return False
    return solve_frozen(w.contacts.law)


def find_law(w: Work) -> int:
    """Find the modes (`set_law`), with normal forces of two-sided contacts; return the result of the law."""
    # Modes decide with the signs free first: then signs stay as they are found, since an alternation of signs
    # and modes need not end.
    if NTWO > 0:
        aim_normals(False, w)
        for n in range(MOST_TURNS):
            set_normal_laws(w)
            found = set_law(w.contacts.law)
            if found > LAW_FOUND or not turn_normals(True, w):
                return found
        w.contacts.law.culprit = 0
        return LAW_FAILED
    return set_law(w.contacts.law)


def normal_sign(n: int, w: Work) -> int:
    """Return the sign of the normal force of a listed contact with one component."""
    i = w.contacts.touching[n]
    return (
        w.contacts.law.sign[n] if w.contacts.normal_axes[normal_first[i]] > 0.0 else -w.contacts.law.sign[n]
    )


def strike_all(w: Work) -> int:
    """Compute the impulses of listed contacts (`impact`), with normal impulses of two-sided contacts, which
    follow from the changes of speeds; return the result. The direction of one with more components is that of
    its sum over all rounds."""
    # Impulses follow from changes of speeds alone: no N0.
    if NTWO > 0:
        for k in range(NNORMAL):
            w.contacts.normal_given[k] = 0.0
        aim_normals(False, w)
        for n in range(MOST_TURNS):
            set_normal_laws(w)
            found = impact(w.contacts.law, w.contacts.impact)
            if found == IMPACT_NONE or not turn_normals(True, w):
                return found
        return IMPACT_FAILED
    return impact(w.contacts.law, w.contacts.impact)
