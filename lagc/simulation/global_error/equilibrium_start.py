"""Initial states from which nothing moves: equilibria to round-off, and mechanisms locked by their
constraints."""

from __future__ import annotations

import sys
from collections.abc import Sequence

from lagc.simulation.system import FAILED, OK, System, Trajectory, rates_at, row_gradients

ULP = 2.0**-52
DIRECTIONS = 8  # combinations of signs by which time, state and parameters are perturbed
# Ratio of a rate to its round-off estimate: a rate with half its digits correct is not round-off.
CLEAR = 2.0**26
SURE = 2.0**40  # the same for one of eight samples of round-off
SEVERAL = 2.0  # ratio of a rate to its round-off estimate: it is round-off
NORMAL = sys.float_info.min  # a rounding unit of smaller numbers may be all of the number
MET = 1e-13  # scaled residual: with a larger one, a mechanism near a singular configuration may seem locked


def rests(system: System, x: Sequence[float], times: Sequence[float]) -> bool:
    """Return True if only round-off moves the state x during `times`. No coordinate changes by one rounding
    unit of its scaling group over the whole time, and each acceleration is no larger than its round-off
    estimate."""
    if system.interface.timed or any(0.0 < abs(p) < NORMAL for p in system.parameters):
        return False
    nq, span = system.nq, times[-1] - times[0]
    kinds = system.interface.kinds[:nq]
    plain = rates_at(system, times[0], x)
    sizes = {kind: max(abs(a) for a, k in zip(x, kinds) if k == kind) for kind in kinds}
    if plain is None or any(abs(a) * span > ULP * sizes[kind] for a, kind in zip(plain, kinds)):
        return False
    if any(plain[nq + system.nv :]):  # work is done
        return False
    accelerations = plain[nq : nq + system.nv]
    changes = [0.0] * system.nv
    for direction in range(DIRECTIONS):
        found = _last_places(system, times[0], x, plain, direction)
        changes = [max(c, change) for c, change in zip(changes, found)]
        # Further directions change an estimate of round-off by less than this.
        if any(abs(a) > SURE * c > 0.0 for a, c in zip(accelerations, changes)):
            return False
    if any(abs(a) > CLEAR * c > 0.0 for a, c in zip(accelerations, changes)):
        return False
    return all(abs(a) <= SEVERAL * c for a, c in zip(accelerations, changes))


def locked(system: System, x: Sequence[float], t: float) -> bool:
    """Return True if the constraints, independent of time, allow no motion from x. The constraint gradients
    must have the rank nv.  Their rank is the trace of the projection onto them in the metric of the mass
    matrix."""
    nq, nv = system.nq, system.nv
    if system.nc < nv or system.interface.driven:
        return False
    at_rest = [*x[:nq], *[0.0] * (len(x) - nq)]
    if any(system.velocity(t, at_rest)) or system.assemble(t, at_rest) in FAILED:
        return False
    if any(abs(a) > MET * size for a, size in zip(system.position(t, at_rest), system.scales(t, at_rest))):
        return False
    columns = zip(*row_gradients(system, t, at_rest))
    return sum(system.solve([*[0.0] * nv, *column])[j] for j, column in enumerate(columns)) > nv - 0.5


def trajectory_at_rest(x: Sequence[float], times: Sequence[float]) -> Trajectory:
    """The trajectory of a system that stays at x."""
    return Trajectory(list(times), [list(x) for _ in times], times[-1], list(x), OK)


def _last_places(
    system: System, t: float, x: Sequence[float], plain: Sequence[float], direction: int
) -> list[float]:
    """The change of each acceleration from `plain` with all numbers perturbed by one rounding unit."""
    p = system.parameters
    last = [
        1.0 - ULP if (i + 1) * (2 * direction + 3) >> 1 & 1 else 1.0 + ULP for i in range(len(x) + len(p))
    ]
    other = system.bind([a * b for a, b in zip(p, last[len(x) :])])
    rates = rates_at(other, t, [a * b for a, b in zip(x, last)]) or plain
    accelerations = slice(system.nq, system.nq + system.nv)
    return [abs(a - b) for a, b in zip(rates[accelerations], plain[accelerations])]
