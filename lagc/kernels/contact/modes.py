"""The modes of contacts that touch: which are open, stick or slip, with their forces.

Few contacts are decided by enumeration, which shows that there is no solution, one, or several: a rod that
slides on a rough floor may have none or several (P. Painleve, Lecons sur le frottement, 1895). Many are
decided by their modes before or by Newton's method for the law as one equation F(p) = 0. With scaled forces p
and accelerations u = W p + b, each contact has

    F_n = u_n if p_n - u_n > least, else p_n - least
    F_t = p_t - P(p_t - u_t), where P projects on the disc with the radius mu p_n

(M. Jean, Comput. Methods Appl. Mech. Engrg. 177 (1999) 235-257, after P. Alart, A. Curnier, ibid. 92 (1991)
353-375). F is not smooth but has one of several derivatives everywhere: each is the system of given modes.
The method finds a solution. It excludes no others, and may find none where there is one.
"""

from math import fabs, inf, sqrt

from lagc.kernels.contact.law import (
    CONTACT_OPEN,
    CONTACT_SLIPS,
    CONTACT_STICKS,
    LEAST_SLIPS,
    LEAST_STICKS,
    differs,
    has_friction,
    is_admissible,
    is_closed,
    is_sticking,
    keep_solution,
    largest_force,
    least_norm_change,
    read_modes,
    relative_motion,
    restore_solution,
    set_law_scales,
    solve_modes,
)
from lagc.kernels.contact.shares import meets_law
from lagc.kernels.language.vocabulary import *

LAW_ONE = 0  # results of `set_law`: the only solution
LAW_FOUND = 1  # one solution; others were not excluded
LAW_NONE = 2  # no modes meet the law
LAW_SEVERAL = 3  # several modes meet it; law.other_mode is the second
LAW_FAILED = 4  # no solution was found
MOST_CHOICES = 256  # combinations of modes that are enumerated: four planar contacts that may stick
MOST_SPATIAL = 27  # the same with slip directions in space
MOST_STARTS = 4
MOST_STEPS = 40  # of Newton's method, for each start
MOST_HALVES = 6  # of a step
LAW_SOLVED = by_type(1e-5, 1e-11, "1e-26")  # of the largest scaled force: F that ends the iterations


def set_law_row(law: ContactLaw, row: int) -> None:
    """Let F of a row be its scaled u."""
    for k in range(law.rows):
        law.matrix[row * law.rows + k] = law.row_scale[row] * law.W[row * law.rows + k] * law.scale[k]
    law.right[row] = -law.row_scale[row] * law.u[row]


def set_force_row(law: ContactLaw, row: int, force: Real) -> None:
    """Let F of a row be its scaled force less a given one."""
    for k in range(law.rows):
        law.matrix[row * law.rows + k] = 0.0
    law.matrix[row * law.rows + row] = 1.0
    law.right[row] = force - law.p[row] / law.scale[row]


def set_slip_rows(law: ContactLaw, i: int) -> None:
    """Set F of the slip rows of a contact with friction."""
    # F_t = p_t - P(p_t - u_t), P on the disc with radius mu |p_n|. An open contact has a disc of radius 0; a
    # least force keeps its own.
    first = law.first[i]
    n = law.rows
    force = law.p[first]
    sign = 1.0
    if law.two_sided[i] > 0 and force < 0.0:
        sign = -1.0
    elif law.two_sided[i] == 0 and force < law.least[i]:
        sign = 0.0
        force = law.least[i]
    # The disc, its radius mu p_n, and what is projected on it.
    grip = law.mu[i] / law.scale[first + 1]
    limit = grip * fabs(force)
    grip *= sign * law.scale[first]
    pulls = vector(TWO)
    size = 0.0
    for k in range(law.slips[i]):
        row = first + 1 + k
        pulls[k] = law.p[row] / law.scale[row] - law.row_scale[row] * law.u[row]
        size += pulls[k] * pulls[k]
    size = sqrt(size)
    # Within the disc F_t is u_t. Outside, P has derivatives by the radius and, in space, by the direction.
    for k in range(law.slips[i]):
        row = first + 1 + k
        if size <= limit and law.slides[i] == 0:
            set_law_row(law, row)
            continue
        along = -law.direction[2 * i + k] if law.slides[i] > 0 else pulls[k] / size
        set_force_row(law, row, limit * along)
        if law.slides[i] == 0 and law.slips[i] == 2:
            for m in range(2):
                other = first + 1 + m
                turn = limit / size * ((1.0 if k == m else 0.0) - along * pulls[m] / size)
                law.matrix[row * n + other] -= turn
                for j in range(n):
                    own = law.row_scale[other] * law.W[other * n + j] * law.scale[j]
                    law.matrix[row * n + j] += turn * own
        law.matrix[row * n + first] -= grip * along


def linearize_law(law: ContactLaw) -> Real:
    """Set law.matrix to the derivative of F by the scaled forces and law.right to -F; return its
    length."""
    # F is piecewise smooth: each contact has the piece that its p and u are in, and the derivative of that
    # piece.
    law.unknowns = law.rows
    relative_motion(law)
    # The normal row decides by what would press it; slip rows without friction have no force.
    for i in range(law.count):
        first = law.first[i]
        closing = law.p[first] / law.scale[first] - law.row_scale[first] * law.u[first]
        if law.two_sided[i] > 0 or closing > law.least[i] / law.scale[first]:
            set_law_row(law, first)
        else:
            set_force_row(law, first, law.least[i] / law.scale[first])
        law.contact[first] = i
        for k in range(1, law.slips[i] + 1):
            law.contact[first + k] = i
            if not has_friction(law, i):
                set_force_row(law, first + k, 0.0)
        if NSLIP > 0:
            if has_friction(law, i):
                set_slip_rows(law, i)
    # Its length measures the progress of the line search.
    total = 0.0
    for j in range(law.rows):
        total += law.right[j] * law.right[j]
    return sqrt(total)


def set_start(law: ContactLaw, start: int) -> None:
    """Begin with no forces, then with equal normal forces, then with different ones."""
    for i in range(law.count):
        first = law.first[i]
        times = float(start * (i + 1 if start > 1 else 1))
        law.p[first] = law.least[i] + times * law.size * law.scale[first]
        for k in range(1, law.slips[i] + 1):
            law.p[first + k] = 0.0


def advance_forces(law: ContactLaw, length: Real) -> Real:
    """Take a step of Newton's method with a line search, or the whole step if no part of it makes F shorter;
    return the new length of F. In dependent equations the step is the shortest one."""
    least_norm_change(law)
    # Armijo's rule for |F|. If no part of the step makes it shorter, the whole step is taken: it changes the
    # piece.
    law.kept_p[:] = law.p
    found = length
    part = 1.0
    # The last turn is the whole step.
    for halving in range(MOST_HALVES + 2):
        for j in range(law.rows):
            law.p[j] = law.kept_p[j] + part * law.scale[j] * law.step[j]
        found = linearize_law(law)
        if found <= (1.0 - 1e-4 * part) * length:
            break
        part = 0.5 * part if halving < MOST_HALVES else 1.0
    return found


def solve_law_equation(law: ContactLaw) -> bool:
    """Compute law.p and law.u by Newton's method; return whether it ended."""
    for start in range(MOST_STARTS):
        set_start(law, start)
        length = linearize_law(law)
        for step in range(MOST_STEPS):
            if length <= LAW_SOLVED * largest_force(law):
                return True
            length = advance_forces(law, length)
    return False


def search_by_newton(law: ContactLaw) -> bool:
    """Compute law.p, law.u and the modes by Newton's method. Return False if it finds none that meet the
    law."""
    # Newton's method finds forces, modes follow from them; then the system of these modes is solved, which is
    # linear and exact. The forces of the method stay only where that leads to another motion.
    if not solve_law_equation(law):
        return False
    read_modes(law)
    keep_solution(law)
    if meets_law(law) and not differs(law, True):
        read_modes(law)
        return True
    restore_solution(law)  # friction moves a set that slides by the share: these forces meet the law
    return is_admissible(law)


def tangential_choices(law: ContactLaw, i: int) -> int:
    """Return in how many modes a closed contact may be."""
    # A given slip, or no friction, leaves one mode; in a plane forwards, backwards, sticking; in space
    # slipping (with a direction to be found) or sticking.
    if not has_friction(law, i) or law.slides[i] > 0:
        return 1
    return 3 if law.slips[i] == 1 else 2


def choices(law: ContactLaw, i: int) -> int:
    """Return in how many modes a contact may be."""
    n = tangential_choices(law, i)
    if NTWO > 0:
        if law.two_sided[i] == 2:
            return n
    return 2 * n if law.two_sided[i] > 0 or law.least[i] > 0.0 else n + 1


def choose(law: ContactLaw, i: int, choice: int) -> None:
    """Put a contact into a mode."""
    # Choices are numbered with those along the slip innermost.
    n = tangential_choices(law, i)
    law.sign[i] = 1
    law.turns[i] = 0
    # Modes along the normal: both signs of the force, the least force or more, open or closed.
    closed = True
    state = choice
    if law.two_sided[i] > 0:
        if choice >= n:
            law.sign[i] = -1
            state = choice - n
    elif law.least[i] > 0.0:
        closed = choice >= n
        if closed:
            state = choice - n
    else:
        if choice == 0:
            law.mode[i] = CONTACT_OPEN
            return
        state = choice - 1
    # Modes along the slip: forwards, backwards or sticking; in space an unknown direction or sticking.
    sticks = state == n - 1 and n > 1
    if sticks:
        law.mode[i] = CONTACT_STICKS if closed else LEAST_STICKS
    else:
        law.mode[i] = CONTACT_SLIPS if closed else LEAST_SLIPS
        if n == 2:
            law.turns[i] = 1
        if n == 3:
            law.direction[2 * i] = 1.0 if state == 0 else -1.0


def guess_directions(law: ContactLaw) -> None:
    """Set unknown slip directions against the forces that would make these contacts stick."""
    # Sticking forces are what friction would have to be; a slip begins against them.
    found = False
    for i in range(law.count):
        law.kept_mode[i] = law.mode[i]
        if law.turns[i] > 0:
            found = True
            law.mode[i] = CONTACT_STICKS if is_closed(law.mode[i]) else LEAST_STICKS
            law.turns[i] = 2
    if not found:
        return
    # If no sticking solution exists, the first axis is as good as any.
    solved = solve_modes(law)
    for i in range(law.count):
        law.mode[i] = law.kept_mode[i]
        if law.turns[i] > 0:
            law.turns[i] = 1
            row = law.first[i] + 1
            force = sqrt(law.p[row] * law.p[row] + law.p[row + 1] * law.p[row + 1])
            known = solved and force > 0.0 and force < inf
            law.direction[2 * i] = -law.p[row] / force if known else 1.0
            law.direction[2 * i + 1] = -law.p[row + 1] / force if known else 0.0


def advance_choice(law: ContactLaw) -> bool:
    """Set law.choice to the next combination. Return False after the last one."""
    for i in range(law.count):
        law.choice[i] += 1
        if law.choice[i] < choices(law, i):
            return True
        law.choice[i] = 0
    return False


def name_culprit(law: ContactLaw, found: int) -> None:
    """Set law.culprit to a contact whose modes differ, or to the one that sinks in fastest by itself."""
    # Several: where the two differ. None: what the load without forces presses in most, by its scaled b.
    deepest = 0.0
    for i in range(law.count):
        row = law.first[i]
        if found == LAW_SEVERAL:
            if law.mode[i] != law.other_mode[i]:
                law.culprit = i
        elif law.row_scale[row] * law.b[row] < deepest:
            deepest = law.row_scale[row] * law.b[row]
            law.culprit = i


def shares_load(law: ContactLaw) -> bool:
    """Return whether contacts share their load in many ways; law.p are the smallest forces then."""
    sticking = 0
    for i in range(law.count):
        if is_sticking(law.mode[i]):
            sticking += 1
    return law.rank < law.unknowns and sticking < 2  # rows of two that stick depend on each other


def enumerate_modes(law: ContactLaw) -> int:
    """Try all modes; return LAW_ONE, LAW_NONE or LAW_SEVERAL. Of modes with the same u the last one gives p:
    it has the most contacts closed and sticking. Solutions that differ in slips alone may share the load of
    the same contacts in many ways; then the smallest forces are taken, and LAW_FOUND is returned."""
    # Solutions are compared by their motion u: forces of one motion may be many.
    found = LAW_NONE
    apart = False
    for i in range(law.count):
        law.choice[i] = 0
    # The loop ends early once two answers differ in their gaps.
    while not apart:
        # Directions of slip in space begin against the forces that would hold these contacts.
        for i in range(law.count):
            choose(law, i, law.choice[i])
        if NSPACE > 0:
            guess_directions(law)
        if meets_law(law):
            if found == LAW_NONE or not differs(law, True):
                found = LAW_ONE if found == LAW_NONE else found
                keep_solution(law)
            else:
                # Two gaps that move differently are two answers. Slips alone may differ by the share.
                apart = differs(law, False)
                if not apart and shares_load(law):
                    found = LAW_FOUND
                    keep_solution(law)
                elif apart or found == LAW_ONE:
                    found = LAW_SEVERAL
                    read_modes(law)
                    law.other_mode[:] = law.mode
        if not advance_choice(law):
            break
    # The solution kept last, with the modes that its motion shows.
    if found != LAW_NONE:
        restore_solution(law)
        read_modes(law)
    if found > LAW_FOUND:
        name_culprit(law, found)
    return found


def is_convex(law: ContactLaw) -> bool:
    """Return whether all contacts are one-sided and without friction and W is symmetric: motion is unique
    then."""
    if NLOADS > 0:
        return False
    for i in range(law.count):
        if law.two_sided[i] > 0 or has_friction(law, i):
            return False
    return True


def is_spatial(law: ContactLaw) -> bool:
    """Return whether a contact may slip in any direction of a plane."""
    for i in range(law.count):
        if has_friction(law, i) and law.slides[i] == 0 and law.slips[i] > 1:
            return True
    return False


def is_enumerable(law: ContactLaw) -> bool:
    """Return whether all combinations of modes are tried."""
    total = 1
    # The product is compared in the loop so that it cannot overflow.
    for i in range(law.count):
        total = total * choices(law, i)
        if total > MOST_CHOICES:
            return False
    return total <= (MOST_SPATIAL if is_spatial(law) else MOST_CHOICES)


def holds_as_before(law: ContactLaw) -> bool:
    """Return whether the modes before meet the law; where they are not known, whether contacts stick."""
    # -1 means that the mode before is not known. Sticking is tried then: it is the only mode without a
    # direction.
    for i in range(law.count):
        if law.least[i] > 0.0:
            return False
        if law.mode[i] < CONTACT_OPEN:
            law.mode[i] = CONTACT_SLIPS if law.slides[i] > 0 else CONTACT_STICKS
        if law.mode[i] != CONTACT_OPEN and not has_friction(law, i):
            law.mode[i] = CONTACT_SLIPS
        slips = law.mode[i] == CONTACT_SLIPS and has_friction(law, i) and law.slides[i] == 0
        law.turns[i] = 1 if slips and law.slips[i] == 2 else 0
    return meets_law(law)


def choose_alone(law: ContactLaw) -> int:
    """Return the result of the law of one contact without friction: it is closed if it pushes then."""
    # Of one contact with W > 0 the law has exactly one solution: closed if that pushes, else open.
    law.mode[0] = CONTACT_SLIPS
    if not meets_law(law):
        law.mode[0] = LEAST_SLIPS if law.least[0] > 0.0 else CONTACT_OPEN
        if not meets_law(law):
            law.culprit = 0
            return LAW_NONE
    read_modes(law)
    return LAW_ONE


def search_modes(law: ContactLaw) -> int:
    """Return the result of `set_law` for given law.slides and law.mu."""
    # A model with one contact row and no loads is compiled without the search.
    if NBESIDE > 0 or NLOADS > 0:
        # Without friction the motion is unique: what is found first is the only one.
        convex = is_convex(law)
        if convex and (holds_as_before(law) or search_by_newton(law)):
            read_modes(law)
            return LAW_ONE
        enumerable = is_enumerable(law)
        if enumerable:
            found = enumerate_modes(law)
            if found != LAW_NONE or not is_spatial(law):
                return found
        # Slip directions in space may have more than one solution in the same modes.
        if not convex and ((not enumerable and holds_as_before(law)) or search_by_newton(law)):
            read_modes(law)
            return LAW_FOUND
        return LAW_NONE if enumerable else LAW_FAILED
    return choose_alone(law)


def start_slips(law: ContactLaw) -> bool:
    """Let contacts that begin to slip do so with the friction of slip, in space in a direction that is found
    with it. Return whether there are any."""
    found = False
    for i in range(law.count):
        slips = law.mode[i] == CONTACT_SLIPS and has_friction(law, i) and law.slides[i] == 0
        if slips and law.friction[i] != law.mu[i]:
            law.slides[i] = 1 if law.slips[i] == 1 else 0
            law.mu[i] = law.friction[i]
            found = True
    return found


def rests(law: ContactLaw) -> bool:
    """Return whether contacts that do not move stay as they are by some forces in the static cones, with
    these forces. If not, modes and culprit are as before."""
    # Where several motions meet the law, as in Painleve's examples, rest is that of the moment before.
    culprit = law.culprit
    for i in range(law.count):
        if law.slides[i] > 0:
            return False
        law.kept_mode[i] = law.mode[i]
        law.mode[i] = CONTACT_STICKS if has_friction(law, i) else CONTACT_SLIPS
        law.turns[i] = 0
    if meets_law(law):
        return True
    law.culprit = culprit
    for i in range(law.count):
        law.mode[i] = law.kept_mode[i]
    return False


def set_law(law: ContactLaw) -> int:
    """Find the modes of contacts that touch, with law.p and law.u. A contact that does not move sticks up
    to its static friction; it is solved with the friction of slip if it begins to slip. Of several solutions
    rest is taken."""
    # Friction of a slip for contacts that move, static friction for others.
    for i in range(law.count):
        law.least[i] = 0.0
        law.slides[i] = law.moves[i]
        law.mu[i] = law.friction[i] if law.moves[i] > 0 else law.static_friction[i]
        if law.moves[i] == 0 and law.mode[i] == CONTACT_SLIPS and has_friction(law, i):
            law.mode[i] = CONTACT_STICKS  # it has no direction of slip yet
    set_law_scales(law)
    found = search_modes(law)
    if NSLIP > 0:
        if found == LAW_SEVERAL and rests(law):
            read_modes(law)
            found = LAW_FOUND
        # Every contact that begins to slip gets the lower friction, and the law is solved again. Contacts
        # only join these, so the loop ends.
        while found <= LAW_FOUND and start_slips(law):
            found = search_modes(law)
    return found
