"""Whether a run on its way is worth its time.

How long it would take follows from what its last part took.  A smooth motion that takes long is followed
in steps in which something moves by a good part of its size, however many these are: it goes on.  A run
that creeps, in steps in which nothing moves, as where forces jump to and fro, ends; and so does one
whose steps shrink without end before a singularity.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import TypeAlias

from lagc.simulation.diagnosis.cause import pinned
from lagc.simulation.error_measure import kinds
from lagc.simulation.system import System, Trajectory, rates_at

CREEPING = 1e-4  # of their sizes: what states move by in a step that is too short for any smooth motion
NOTHING = 1e-20  # of the kinetic energy
ALLOWED = 0.5  # of the longest step: those are as short as somebody asked for
LONG = 1e9  # operations, about a second: such a run ends where a reason is found
TOO_LONG = 1e11  # minutes: it ends in any case
SHORTER = 0.8  # a way of twice the steps than the one before
CONVERGING = 3  # such ways in succession
CALL = 50.0  # operations that a right-hand side takes beside its own

Look: TypeAlias = tuple[float, int, float]  # the time reached, steps, operations


def hopeless(system: System, run: Trajectory, end: float, longest: float, looks: list[Look]) -> bool:
    """Whether `run`, in steps of up to `longest`, after twice as many as at the last of `looks`, would take
    long and will not reach the time `end`, or creeps.  What it is now becomes the last of them."""
    looks.append((run.t, run.steps, _work(system, run)))
    way, steps, work = (b - a for a, b in zip(looks[-2], looks[-1]))
    left = work * (end - run.t) / way if way != 0.0 else work
    if left < LONG:
        return False
    if _ends(looks, end):
        return True
    step = abs(way) / steps
    if step > ALLOWED * longest or not _creeps(system, run, step):
        return False
    return left > TOO_LONG or pinned(system, run, run.t, run.x) != ""


def _ends(looks: Sequence[Look], end: float) -> bool:
    """Whether times converge before `end`: with twice the steps each, the last ways grew shorter."""
    ways = [abs(b[0] - a[0]) for a, b in pairwise(looks[-CONVERGING - 2 :])]
    if len(ways) <= CONVERGING or any(b > SHORTER * a for a, b in pairwise(ways)):
        return False
    return ways[-1] * SHORTER / (1.0 - SHORTER) < abs(end - looks[-1][0])


def _work(system: System, run: Trajectory) -> float:
    """In operations; those of a dense solve are as many as its products, without a dense matrix about those
    of eight right-hand sides."""
    nv, nc, own = system.nv, system.nc, system.interface.operations
    safe = 4.0 * nv * (nc * nc + nv * nv) if "system" in system.interface.functions else 8.0 * own
    return run.rhs * (own + CALL) + run.fallbacks * safe


def _creeps(system: System, run: Trajectory, step: float) -> bool:
    """Whether no state moves by a good part of the size of its kind, so far, in a step.  Speeds of a kind
    that has no kinetic energy are what rounding leaves where nothing moves."""
    groups = kinds(system.interface)
    x, moving = list(run.x), list(groups)
    kinetic = system.energies(run.t, x)[0]
    for group in groups:
        y = [0.0 if i in group else a for i, a in enumerate(x)]
        if min(group) >= system.nq and abs(system.energies(run.t, y)[0] - kinetic) <= NOTHING * kinetic:
            moving.remove(group)
            x = y
    rates = rates_at(system, run.t, x)
    if rates is None:
        return True
    for group in moving:
        size = max((abs(y[i]) for y in [*run.states, run.x] for i in group), default=0.0)
        if any(abs(rates[i]) * step > CREEPING * size for i in group):
            return False
    return True
