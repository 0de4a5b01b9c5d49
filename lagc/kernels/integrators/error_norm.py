"""What counts as an error of one step, and how long the first may be."""

from __future__ import annotations

from math import fabs, sqrt

from lagc.kernels.dynamics.rhs import rhs_at
from lagc.kernels.integrators.dispatch import beta, exponent
from lagc.kernels.integrators.step_size import raised
from lagc.kernels.language.records import Options, State, Work
from lagc.kernels.language.scaling_groups import enlarge
from lagc.kernels.language.sizes import NKIND, NQ, NV, NX
from lagc.kernels.language.statuses import failed
from lagc.kernels.language.tables import kind
from lagc.kernels.language.tolerances import NEARLY_THERE, SPACING, TINY
from lagc.kernels.language.words import Params, Real, Vec, vector

BEYOND = 1e-3  # of a look ahead are the times in which kinds change: it tells nothing of the start
NEARER = 1e-5  # of it is the next


def departing(s: State, h: Real, w: Work, sizes: Vec[NKIND]) -> None:
    """Enlarge sizes of kinds that are exactly at rest to those that they take over the longest step so far,
    as they set out in this one: where a motion begins with a kink, no step is short enough to be exact by
    what it reaches itself."""
    longer = w.longest / fabs(h)
    for i in range(NQ + NV):
        if s.sizes[kind[i]] == 0.0:
            way = fabs(s.y[i] - s.x[i]) * longer
            if way > sizes[kind[i]]:
                sizes[kind[i]] = way


def weigh_errors(s: State, o: Options, h: Real, w: Work) -> None:
    """w.reached, those of the trajectory with its new state s.y, and what errors of a step over h are
    measured in; s.noise is the rounding of rates, where it is known.  An angle that winds does not make
    others less telling."""
    sizes = vector(NKIND)
    for k in range(NKIND):
        sizes[k] = 0.0
    if w.longest > 0.0:
        departing(s, h, w, sizes)
    w.reached[:] = s.sizes
    enlarge(s.y, w.reached)
    for k in range(NKIND):
        if w.reached[k] > sizes[k]:
            sizes[k] = w.reached[k]
    rtol = o.rtol
    atol = o.atol
    blur = 10.0 * fabs(h)
    for i in range(NQ + NV):
        size = sizes[kind[i]]
        if kind[i] == 0 and size > 1.0:
            size = fabs(s.y[i]) if fabs(s.y[i]) > 1.0 else 1.0
        weight = atol + rtol * size + blur * (s.noise[i] + w.play[i])
        w.weights[i] = weight if weight > TINY else TINY


def lost_in_time(s: State) -> Real:
    """By what a switch that has just changed may be late: a motion that began with it has had that time."""
    return NEARLY_THERE * SPACING * (fabs(s.t) + s.longest)


def turning(
    p: Params, s: State, h: Real, direction: Real, sizes: Vec[NKIND], rates: Vec[NKIND], most: Real, w: Work
) -> Real:
    """The shortest of the times, none above `most` or lost in the time, in which the kinds change by their
    own size, as their rates and the changes of these over h tell; 0 where there are no rates then."""
    bends = vector(NKIND)
    for k in range(NKIND):
        bends[k] = 0.0
    for k in range(NX):
        s.y[k] = s.x[k] + h * direction * s.k[0][k]
    s.rhs += 1
    if failed(rhs_at(p, s.t + h * direction, s.y, s.k[1], w.lam, w)):
        return 0.0
    for k in range(NX):
        s.y[k] = (s.k[1][k] - s.k[0][k]) / h
    enlarge(s.y, bends)
    best = most
    soon = lost_in_time(s)
    for k in range(NKIND):
        if not bends[k] > 0.0:
            continue
        way = sqrt(sizes[k] / bends[k])
        if sizes[k] < way * rates[k]:
            way = sizes[k] / rates[k]
        if rates[k] > way * bends[k]:
            way = rates[k] / bends[k]
        if way > soon and way < best:
            best = way
    return best


def first_step(p: Params, s: State, t1: Real, direction: Real, o: Options, w: Work) -> Real:
    """A part, by the order of the method, of the shortest of the times in which the kinds change by their own
    size.  Kinds that begin at rest get the size to which it takes them: a force that jumps there is no error
    of any size."""
    largest = fabs(t1 - s.t)
    rates = vector(NKIND)
    for k in range(NKIND):
        rates[k] = 0.0
    guess = 0.01 * largest
    enlarge(s.k[0], rates)
    sizes = vector(NKIND)
    for k in range(NKIND):
        sizes[k] = s.sizes[k] if s.sizes[k] > lost_in_time(s) * rates[k] else 0.0
        if sizes[k] > 0.0 and 0.01 * sizes[k] < guess * rates[k]:
            guess = 0.01 * sizes[k] / rates[k]
    h = guess
    best = 0.0
    while h > 0.0:
        best = turning(p, s, h, direction, sizes, rates, largest, w)
        if best > BEYOND * h:
            break
        h *= NEARER
    if h == 0.0:
        return guess
    tolerance = 1.0
    for k in range(NKIND):
        size = sizes[k] if sizes[k] > 0.0 else best * rates[k]
        if size > 0.0 and o.rtol + o.atol / size < tolerance:
            tolerance = o.rtol + o.atol / size
    h = best * raised(0.01 * tolerance, exponent(o.method) + 0.75 * beta(o.method))
    if h > largest:
        h = largest
    for k in range(NKIND):
        if sizes[k] == 0.0 and h * rates[k] > s.sizes[k]:
            s.sizes[k] = h * rates[k]
    return h
