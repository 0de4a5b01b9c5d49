"""Whether a motion is none: in an equilibrium, as well as numbers of finite length can say, or because
constraints leave no other."""

from __future__ import annotations

import sys
from collections.abc import Sequence

from lagc.simulation.global_error.rounding import ULP, rounded_rates
from lagc.simulation.system import FAILED, OK, System, Trajectory, rates_at, row_gradients

WAYS = 8  # in which time, state and parameters are changed in their last place
CLEAR = 2.0**26  # times what last places change: a rate that keeps half its digits is no rounding
SEVERAL = 2.0  # such changes of a rate are rounding
NORMAL = sys.float_info.min  # a last place of what is less may be all of it
MET = 1e-13  # scaled residual: farther off, a mechanism at a singular posture may seem to be locked


def rests(system: System, x: Sequence[float], times: Sequence[float]) -> bool:
    """Whether nothing but rounding moves the state x, where no time moves it either: no coordinate changes
    in the last place of the largest of its kind over the whole time, and changes of state and parameters
    in their last place, or other rounding, change each acceleration by as much as it is."""
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
    changes = _last_places(system, times[0], x, plain)
    if any(abs(a) > CLEAR * c > 0.0 for a, c in zip(accelerations, changes)):
        return False
    changes = [*map(max, changes, _other_rounding(system, times[0], x, plain))]
    return all(abs(a) <= SEVERAL * c for a, c in zip(accelerations, changes))


def locked(system: System, x: Sequence[float], t: float) -> bool:
    """Whether constraints that do not depend on time hold x where it is: no speed is one of theirs, and
    they tell all speeds.  The rank of their rows is the trace of the projection, in the metric of the
    mass matrix, onto what they see of the speeds; it counts as at the right-hand side."""
    nq, nv = system.nq, system.nv
    if system.nc < nv or system.interface.driven:
        return False
    still = [*x[:nq], *[0.0] * (len(x) - nq)]
    if any(system.velocity(t, still)) or system.assemble(t, still) in FAILED:
        return False
    if any(abs(a) > MET * size for a, size in zip(system.position(t, still), system.scales(t, still))):
        return False
    columns = zip(*row_gradients(system, t, still))
    return sum(system.solve([*[0.0] * nv, *column])[j] for j, column in enumerate(columns)) > nv - 0.5


def resting(x: Sequence[float], times: Sequence[float]) -> Trajectory:
    """The motion that is none."""
    return Trajectory(list(times), [list(x) for _ in times], times[-1], list(x), OK)


def _last_places(system: System, t: float, x: Sequence[float], plain: Sequence[float]) -> list[float]:
    """How far each acceleration changes where all numbers are changed in their last place."""
    p, others = system.parameters, []
    for way in range(WAYS):
        last = [1.0 - ULP if (i + 1) * (2 * way + 3) >> 1 & 1 else 1.0 + ULP for i in range(len(x) + len(p))]
        other = system.bind([a * b for a, b in zip(p, last[len(x) :])])
        others.append(rates_at(other, t, [a * b for a, b in zip(x, last)]))
    return _changes(system, others, plain)


def _other_rounding(system: System, t: float, x: Sequence[float], plain: Sequence[float]) -> list[float]:
    """How far each acceleration changes where arithmetic is rounded up, or down."""
    return _changes(system, [r for way in (1, -1) for r in rounded_rates([system], [t], [x], way)], plain)


def _changes(system: System, others: Sequence[Sequence[float] | None], plain: Sequence[float]) -> list[float]:
    found = [0.0] * system.nv
    for rates in others:
        moved = zip(found, (rates or plain)[system.nq :], plain[system.nq :])
        found = [max(c, abs(a - b)) for c, a, b in moved]
    return found
