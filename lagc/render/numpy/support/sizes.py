"""What errors are measured in: the largest magnitudes of each kind of states, and the first step."""

from __future__ import annotations

from collections.abc import Sequence
from math import pow, sqrt

from lagc.render.numpy.support.base import FAILED, Options
from lagc.render.numpy.support.problem import Problem

# -- what follows is part of generated modules --

TINY = 1e-300  # stands for zero where it divides zero
RESTING = 1e-3  # of the change of a row over the sizes of states: a row whose terms vanish is judged by it
NEARLY = (1.0 + 8.881784197001252e-16, 1.0 - 8.881784197001252e-16)  # by four units of the last place


def enlarge(kinds: Sequence[int], x: Sequence[float], sizes: list[float]) -> None:
    """`sizes`, one a kind, become at least those of `x`.  Kind 0 are the coordinates that are numbers,
    as angles are."""
    for kind, a in zip(kinds, x):
        if abs(a) > sizes[kind]:
            sizes[kind] = abs(a)


def sizes_of(kinds: Sequence[int], x: Sequence[float]) -> list[float]:
    """The largest magnitude of each kind of states."""
    sizes = [0.0] * (max(kinds, default=0) + 1)
    enlarge(kinds, x, sizes)
    return sizes


def departing(
    kinds: Sequence[int],
    sizes: list[float],
    reached: list[float],
    options: Options,
    moved: list[float],
    longer: float,
) -> list[float]:
    """`reached`, at least the sizes that kinds take from rest over the longest step so far, `longer` times
    this one, as they set out in this one: where a motion begins with a kink, no step is short enough to
    be exact by what it reaches itself."""
    found = [0.0] * len(sizes)
    for kind, a in zip(kinds, moved):
        way = abs(a) * longer
        if way > found[kind]:
            found[kind] = way
    for kind, (before, now) in enumerate(zip(sizes, reached)):
        if before > options.rtol * found[kind] or not found[kind] > now:  # it moves already
            found[kind] = now
    return found


def weigh(
    kinds: Sequence[int], sizes: list[float], options: Options, h: float, y: list[float], noise: list[float]
) -> list[float]:
    """What errors of a step over h to y are measured in; `noise` is the rounding of rates.  An angle that
    winds does not make others less telling."""
    weights = []
    for kind, a, b in zip(kinds, y, noise):
        size = sizes[kind]
        if kind == 0 and size > 1.0:
            size = abs(a) if abs(a) > 1.0 else 1.0
        weight = options.atol + options.rtol * size + 10.0 * abs(h) * b
        weights.append(weight if weight > TINY else TINY)
    return weights


def first_step(
    problem: Problem,
    t: float,
    x: list[float],
    sizes: list[float],
    k: list[list[float]],
    largest: float,
    direction: float,
    options: Options,
    order: int,
    lam: list[float],
) -> float:
    """The shortest of the times in which the kinds change by their own size, as their rates k[0] and
    the changes of these over a small step tell; a part of it, by the order of the method.  Kinds that
    begin at rest get the size to which it takes them: a force that jumps there is no error of any size."""
    kinds = problem.kinds
    rates, bends = [0.0] * len(sizes), [0.0] * len(sizes)
    h, tolerance = 0.01 * largest, 1.0
    enlarge(kinds, k[0], rates)
    for size, rate in zip(sizes, rates):
        if size > 0.0 and options.rtol + options.atol / size < tolerance:
            tolerance = options.rtol + options.atol / size
        if size > 0.0 and 0.01 * size < h * rate:
            h = 0.01 * size / rate
    y = [a + h * direction * b for a, b in zip(x, k[0])]
    status = problem.rhs(t + h * direction, y, k[1], lam)
    if status in FAILED or h == 0.0:
        return h
    enlarge(kinds, [(a - b) / h for a, b in zip(k[1], k[0])], bends)
    best = largest
    for size, rate, bend in zip(sizes, rates, bends):
        if not bend > 0.0:
            continue
        way = sqrt(size / bend)
        if size < way * rate:
            way = size / rate
        if rate > way * bend:
            way = rate / bend
        if 0.0 < way < best:
            best = way
    h = best * pow(0.01 * tolerance, 1.0 / order)
    if h > largest:
        h = largest
    for kind, rate in enumerate(rates):
        if sizes[kind] == 0.0:
            sizes[kind] = h * rate
    return h
