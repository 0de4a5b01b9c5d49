"""Suspected indicators: those that the bounds over a step, or over a part of it, leave open.

Others are known to stay in their modes there. Of the dense output only the states that suspected indicators
depend on are evaluated.
"""

from lagc.kernels.contact.indicators import enclose_forces
from lagc.kernels.events.late_indicators import enclose_late
from lagc.kernels.language.vocabulary import *


def is_known(low: Real, high: Real) -> bool:
    """Return whether these are finite bounds of an expression."""
    return low > -UNKNOWN and high < UNKNOWN and low <= high


def within_mode(k: int, low: Real, high: Real, w: Work) -> bool:
    """Return whether an indicator between these bounds stays in its mode."""
    if NEDGES > 0:
        if has_edges[k] > 0:
            return low > w.events.edges[2 * k] and high < w.events.edges[2 * k + 1]
    if w.modes[k] == 0.0:
        return low >= 0.0 and high <= 0.0
    return low > 0.0 if w.modes[k] > 0.0 else high < 0.0


def suspect_all(w: Work) -> None:
    """Suspect all indicators that depend on the state: none of them is known to stay in its mode."""
    w.events.suspects = size(NFREE)
    for j in range(NFREE):
        w.events.suspect[j] = j
    if NCON > 0:
        w.events.seeks_forces = True


def enclose_indicators(p: Params, s: State, w: Work) -> None:
    """Set w.events.enclosures for w.search.box."""
    # Interval arithmetic for indicators of time and state, samples for those that need a solve.
    fn_enclosure_on(p, w.modes, w.search.box, w.events.enclosures)
    if NLATE > 0:
        enclose_late(w)
    if NCON > 0:
        if w.events.seeks_forces:
            enclose_forces(s, w)


def may_cross(j: int, s: State, w: Work) -> bool:
    """Return whether the enclosure of an indicator contains a crossing."""
    # An unbounded or empty enclosure says nothing, so it does not exclude.
    low = w.events.enclosures[2 * j]
    high = w.events.enclosures[2 * j + 1]
    slack = s.slack[NTIMED + j]
    return not (is_known(low, high) and within_mode(NTIMED + j, low + slack, high - slack, w))


def find_suspects(p: Params, s: State, w: Work) -> int:
    """Put the suspected indicators that may cross in w.search.box first in w.events.suspect; return how many
    these are."""
    enclose_indicators(p, s, w)
    found = 0
    for n in range(w.events.suspects):
        j = w.events.suspect[n]
        if may_cross(j, s, w):
            w.events.suspect[n] = w.events.suspect[found]
            w.events.suspect[found] = j
            found += 1
    return found


def watch_all(w: Work) -> None:
    """Watch all states on the parts of a step."""
    w.search.watching = size(NMOVED)
    for i in range(NQ + NV):
        w.search.watched[i] = i


def is_block_suspected(block: int, w: Work) -> bool:
    """Return whether a suspected indicator is the gap of a contact of this block."""
    for n in range(w.events.suspects):
        if contact_block[w.events.suspect[n] - NFREE + NCON] == block:
            return True
    return False


def suspect(count: int, s: State, w: Work) -> None:
    """Suspect the first indicators of w.events.suspect alone, and watch the states that they depend on: those
    of blocks, if all are gaps; else all."""
    w.events.suspects = count
    watch_all(w)
    if NCON > 0:
        # Forces are solved for where that of a contact which touches, or a slip, may end.
        w.events.seeks_forces = False
        others = False
        for n in range(count):
            k = NTIMED + w.events.suspect[n]
            if k < NMODE - NCON - NSLIP:
                others = True
            elif k < NMODE - NCON or s.x[NX - NMODE + k] != 0.0:
                w.events.seeks_forces = True
        if others or w.events.seeks_forces:
            return
        w.search.watching = 0
        for block in range(NBLOCK):
            if is_block_suspected(block, w):
                for c in range(state_begin[block], state_end[block]):
                    w.search.watched[w.search.watching] = block_state[c]
                    w.search.watching += 1
