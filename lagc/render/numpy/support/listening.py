"""What of the error of a step that was rejected is rounding."""

from __future__ import annotations

from collections.abc import Callable
from math import sqrt

from lagc.render.numpy.support.base import FAILED
from lagc.render.numpy.support.problem import Problem

# -- what follows is part of generated modules --

FADING = 0.9  # of rounding that made a step good is left after a step as long as any so far
FORGOTTEN = 0.03  # so little of it is forgotten
LOST = 1e-4  # of its size, an error with which a state is not told at all


def listen(
    problem: Problem,
    stages: Callable[..., tuple[int, list[float]]] | None,
    t: float,
    x: list[float],
    h: float,
    k: list[list[float]],
    noise: list[float],
) -> None:
    """Raise `noise` to what the rates k, one at least, change by at (t, x), where time, state and parameters
    are shaken in their last places; with the stages of a method, along its step over h: what is rounding
    now and then need not be so at the start, and what changes there moves the state along it."""
    again, lam = [[0.0] * len(x) for _ in k], [0.0] * problem.nc
    status = problem.rhs(t, x, again[0], lam)
    if stages is not None and status not in FAILED:
        status, _ = stages(problem, t, x, h, again, lam)
    if status in FAILED:
        return
    for one, other in zip(again, k):
        for i in range(len(noise)):
            if abs(one[i] - other[i]) > noise[i]:
                noise[i] = abs(one[i] - other[i])


def parts_norm(parts: list[list[float]], weights: list[float], h: float) -> float:
    """The norm of an error with such parts; see `dop853_error`."""
    sums = []
    for part in parts:
        total = 0.0
        for weight, a in zip(weights, part):
            e = a / weight
            total += e * e
        sums.append(total)
    total = sums[0] + 0.01 * sums[1]
    if total == 0.0:
        return 0.0
    return abs(h) * sums[0] * sqrt(1.0 / (len(weights) * total))
