"""What rounding does to a motion: the part of its error that runs of every tolerance share.

At some of the recorded states the equations are evaluated again, with directed rounding and with each
state changed in its last place: what changes is what an evaluation may be wrong by
(backward errors: N. J. Higham, *Accuracy and Stability of Numerical Algorithms*, SIAM 2002, ch. 1; rounding
modes as a probe: W. Kahan, *How futile are mindless assessments of roundoff*, 2006).  It stands for all
along the motion, as an ill-conditioned mass matrix is wrong in the same way at every step.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import lru_cache
from itertools import pairwise
from typing import Any

from lagc.run.problem import FAILED, System, Trajectory

ULP = 2.0**-52
SAMPLES = 12  # of the recorded states
# FE_UPWARD and FE_DOWNWARD of <fenv.h> on x86, on ARM, and in Microsoft's library
MODES = ((0x800, 0x400), (0x400000, 0x800000), (0x200, 0x100))


def rounding_drift(
    system: System, trajectory: Trajectory, groups: Sequence[tuple[Sequence[int], float]]
) -> float:
    """How far rounding moves the states, relative to their sizes, where differences do not grow.

    `groups`: the indices of the states of each kind, and their size.  A kind whose rates are nothing but
    rounding is at rest, and left out.  Around each state looked at, a kind moves by the change of its rate
    over the time, and by no more than that share of the way that it goes: a close encounter is short.
    """
    n = len(trajectory.states)
    picked = sorted({k * (n - 1) // SAMPLES for k in range(SAMPLES + 1)}) if n else []
    looks: list[tuple[int, list[float], list[float]]] = []  # where, the changes of rates, the rates
    for k in picked:
        found = _evaluations(system, trajectory.times[k], trajectory.states[k])
        if found is not None:
            plain, *others = found
            changes = [max(abs(f[i] - plain[i]) for f in others for i in group) for group, _ in groups]
            looks.append((k, changes, [max(abs(plain[i]) for i in group) for group, _ in groups]))
    bounds = [0, *((a + b) // 2 for (a, _, _), (b, _, _) in pairwise(looks)), n - 1]
    total = 0.0
    for (_, changes, rates), first, last in zip(looks, bounds, bounds[1:]):
        time = abs(trajectory.times[last] - trajectory.times[first])
        worst = 0.0
        for j, (group, size) in enumerate(groups):
            alive = max(r[j] for _, _, r in looks) > 100.0 * max(c[j] for _, c, _ in looks)
            if size > 0.0 and alive:
                way = _way(trajectory, group, first, last)
                moved = changes[j] * (min(time, way / rates[j]) if rates[j] > 0.0 else time)
                worst = max(worst, moved / size)
        total += worst
    return total


def _way(trajectory: Trajectory, group: Sequence[int], first: int, last: int) -> float:
    """How far the states of one kind go between two recorded times; turns that the recorded states do not
    show are as many as there are more steps."""
    states = trajectory.states[first : last + 1]
    way = sum(max(abs(y[i] - x[i]) for i in group) for x, y in pairwise(states))
    return way * max(1.0, trajectory.steps / max(len(trajectory.states) - 1, 1))


def _evaluations(system: System, t: float, x: Sequence[float]) -> list[list[float]] | None:
    """The rates as they are, and twice with other rounding; None where they cannot be told."""
    found: list[list[float]] = []
    for way in (0, 1, -1):
        xdot, lam = [0.0] * system.nx, [0.0] * system.nc
        moved = [a * (1.0 + (way if i % 2 else -way) * ULP) for i, a in enumerate(x)]
        with directed(way):
            status = system.rhs(t, moved, xdot, lam)
        if status in FAILED:
            return None
        found.append(xdot)
    return found


@contextmanager
def directed(way: int) -> Iterator[None]:
    """Arithmetic of this thread rounded up (1) or down (-1), as usual for 0 and where it cannot be."""
    control = _control() if way else None
    if control is None:
        yield
        return
    turn, up, down = control
    turn(up if way > 0 else down)
    try:
        yield
    finally:
        turn(0)


@lru_cache(maxsize=1)
def _control() -> tuple[Callable[[int], Any], int, int] | None:
    """fesetround of the C library and its modes for up and down; None where there is none that works."""
    import ctypes

    try:
        turn = ctypes.CDLL("ucrtbase" if sys.platform == "win32" else None).fesetround
    except (OSError, AttributeError):
        return None
    one, little = float("1"), float("1e-30")
    for up, down in MODES:
        turn(up)
        above = one + little
        turn(down)
        below = one - little
        turn(0)
        if above > one > below and one + little == one:
            return turn, up, down
    return None
