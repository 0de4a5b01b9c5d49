"""Whether a motion starts in an equilibrium, as well as numbers of finite length can say."""

from __future__ import annotations

from collections.abc import Sequence

from lagc.run.problem import FAILED, OK, System, Trajectory
from lagc.run.rounding import rounded_rates

ULP = 2.0**-52
WAYS = 8  # in which time, state and parameters are changed in their last place
SEVERAL = 2.0  # such changes of a rate are rounding


def rests(system: System, x: Sequence[float], times: Sequence[float]) -> bool:
    """Whether nothing but rounding moves the state x, where no time moves it either: no coordinate changes
    in the last place of the largest of its kind over the whole time, and changes of state and parameters
    in their last place, or other rounding, change each acceleration by as much as it is."""
    if system.interface.timed:
        return False
    nq, span = system.nq, times[-1] - times[0]
    kinds = system.interface.kinds[:nq]
    plain = _rates(system, times[0], x)
    sizes = {kind: max(abs(a) for a, k in zip(x, kinds) if k == kind) for kind in kinds}
    if plain is None or any(abs(a) * span > ULP * sizes[kind] for a, kind in zip(plain, kinds)):
        return False
    return all(abs(a) <= limit for a, limit in zip(plain[nq:], _limits(system, times[0], x, plain)))


def resting(x: Sequence[float], times: Sequence[float]) -> Trajectory:
    """The motion that is none."""
    return Trajectory(list(times), [list(x) for _ in times], times[-1], list(x), OK)


def _limits(system: System, t: float, x: Sequence[float], plain: Sequence[float]) -> list[float]:
    """What rounding may bring to each acceleration; 0 for the work, whose rate has to vanish."""
    p, others = system.parameters, []
    for way in range(WAYS):
        last = [1.0 - ULP if (i + 1) * (2 * way + 3) >> 1 & 1 else 1.0 + ULP for i in range(len(x) + len(p))]
        other = system.bind([a * b for a, b in zip(p, last[len(x) :])])
        others.append(_rates(other, t, [a * b for a, b in zip(x, last)]))
    for way in (1, -1):
        others += rounded_rates(system, [t], [x], way)
    found = [0.0] * system.nv
    for rates in others:
        moved = zip(found, (rates or plain)[system.nq :], plain[system.nq :])
        found = [max(c, abs(a - b)) for c, a, b in moved]
    return [SEVERAL * c for c in found] + [0.0] * system.nz


def _rates(system: System, t: float, x: Sequence[float]) -> list[float] | None:
    """None where they cannot be told."""
    xdot, lam = [0.0] * system.nx, [0.0] * system.nc
    return None if system.rhs(t, x, xdot, lam) in FAILED else xdot
