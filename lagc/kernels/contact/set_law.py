"""The law of contact with dry friction: modes and forces of contacts that touch.

Few contacts are decided by `enumeration`, many by their modes before or by Newton's method (`semismooth`).
Modes are read from u, since the forces of dependent rows are not unique."""

from lagc.kernels.contact.conditions import has_friction, read_modes
from lagc.kernels.contact.enumeration import (
    LAW_FAILED,
    LAW_FOUND,
    LAW_NONE,
    LAW_ONE,
    LAW_SEVERAL,
    choices,
    enumerate_modes,
)
from lagc.kernels.contact.frozen_modes import CONTACT_OPEN, CONTACT_SLIPS, CONTACT_STICKS, set_law_scales
from lagc.kernels.contact.semismooth import search_by_newton
from lagc.kernels.contact.shares import meets_law
from lagc.kernels.language.vocabulary import *

MOST_CHOICES = 256  # combinations of modes that are enumerated: four planar contacts that may stick
MOST_SPATIAL = 27  # the same with slip directions in space


def is_convex(w: Work) -> bool:
    """Return whether all contacts are one-sided and without friction and W is symmetric: motion is unique
    then."""
    if NLOADS > 0:
        return False
    for i in range(w.law_count):
        if w.law_two_sided[i] > 0 or has_friction(w, i):
            return False
    return True


def is_spatial(w: Work) -> bool:
    """Return whether a contact may slip in any direction of a plane."""
    for i in range(w.law_count):
        if has_friction(w, i) and w.law_slides[i] == 0 and w.law_slips[i] > 1:
            return True
    return False


def is_enumerable(w: Work) -> bool:
    """Return whether all combinations of modes are tried."""
    total = 1
    for i in range(w.law_count):
        total = total * choices(w, i)
        if total > MOST_CHOICES:
            return False
    return total <= (MOST_SPATIAL if is_spatial(w) else MOST_CHOICES)


def holds_as_before(w: Work) -> bool:
    """Return whether the modes before meet the law; where they are not known, whether contacts stick."""
    for i in range(w.law_count):
        if w.law_least[i] > 0.0:
            return False
        if w.law_mode[i] < CONTACT_OPEN:
            w.law_mode[i] = CONTACT_SLIPS if w.law_slides[i] > 0 else CONTACT_STICKS
        if w.law_mode[i] != CONTACT_OPEN and not has_friction(w, i):
            w.law_mode[i] = CONTACT_SLIPS
        slips = w.law_mode[i] == CONTACT_SLIPS and has_friction(w, i) and w.law_slides[i] == 0
        w.law_turns[i] = 1 if slips and w.law_slips[i] == 2 else 0
    return meets_law(w)


def search_modes(w: Work) -> int:
    """Return the result of `set_law` for given w.law_slides and w.law_mu."""
    if is_convex(w):
        if holds_as_before(w) or search_by_newton(w):
            read_modes(w)
            return LAW_ONE
    enumerable = is_enumerable(w)
    if enumerable:
        found = enumerate_modes(w)
        if found != LAW_NONE or not is_spatial(w):
            return found
    # Slip directions in space may have more than one solution in the same modes.
    if (not enumerable and holds_as_before(w)) or search_by_newton(w):
        read_modes(w)
        return LAW_FOUND
    return LAW_NONE if enumerable else LAW_FAILED


def start_slips(w: Work) -> bool:
    """Let contacts that begin to slip do so with the friction of slip, in space in a direction that is found
    with it. Return whether there are any."""
    found = False
    for i in range(w.law_count):
        slips = w.law_mode[i] == CONTACT_SLIPS and has_friction(w, i) and w.law_slides[i] == 0
        if slips and w.law_friction[i] != w.law_mu[i]:
            w.law_slides[i] = 1 if w.law_slips[i] == 1 else 0
            w.law_mu[i] = w.law_friction[i]
            found = True
    return found


def rests(w: Work) -> bool:
    """Return whether contacts that do not move stay as they are by some forces in the static cones, with
    these forces. If not, modes and culprit are as before."""
    culprit = w.law_culprit
    for i in range(w.law_count):
        if w.law_slides[i] > 0:
            return False
        w.law_kept_mode[i] = w.law_mode[i]
        w.law_mode[i] = CONTACT_STICKS if has_friction(w, i) else CONTACT_SLIPS
        w.law_turns[i] = 0
    if meets_law(w):
        return True
    w.law_culprit = culprit
    for i in range(w.law_count):
        w.law_mode[i] = w.law_kept_mode[i]
    return False


def set_law(w: Work) -> int:
    """Find the modes of contacts that touch, with w.law_p and w.law_u. A contact that does not move sticks up
    to its static friction; it is solved with the friction of slip if it begins to slip. Of several solutions
    rest is taken."""
    for i in range(w.law_count):
        w.law_least[i] = 0.0
        w.law_slides[i] = w.law_moves[i]
        w.law_mu[i] = w.law_friction[i] if w.law_moves[i] > 0 else w.law_static[i]
        if w.law_moves[i] == 0 and w.law_mode[i] == CONTACT_SLIPS and has_friction(w, i):
            w.law_mode[i] = CONTACT_STICKS  # it has no direction of slip yet
    set_law_scales(w)
    found = search_modes(w)
    if NSLIP > 0:
        if found == LAW_SEVERAL and rests(w):
            read_modes(w)
            found = LAW_FOUND
        while found <= LAW_FOUND and start_slips(w):
            found = search_modes(w)
    return found
