"""Whether a motion starts in an equilibrium, as well as numbers of finite length can say."""

from __future__ import annotations

from collections.abc import Sequence

from lagc.run.problem import FAILED, OK, System, Trajectory

ULP = 2.0**-52
WAYS = 4  # in which time, state and parameters are changed in their last place
SEVERAL = 4.0  # such changes of a rate, or one of the largest of its kind, are rounding
LOOKED_AT = 100  # of the recorded times


def rests(system: System, x: Sequence[float], times: Sequence[float]) -> bool:
    """Whether nothing but rounding moves the state x, now and at later times: no coordinate changes in
    the last place of the largest of its kind over the whole time, and changes of time, state and
    parameters in their last place change each acceleration by as much as it is."""
    nq, span = system.nq, times[-1] - times[0]
    kinds = system.interface.kinds[:nq]
    plain = _rates(system, times[0], x)
    sizes = {kind: max(abs(a) for a, k in zip(x, kinds) if k == kind) for kind in kinds}
    if plain is None or any(abs(a) * span > ULP * sizes[kind] for a, kind in zip(plain, kinds)):
        return False
    limits = _limits(system, times[0], x, plain)
    for k in range(LOOKED_AT + 1):
        rates = _rates(system, times[k * (len(times) - 1) // LOOKED_AT], x)
        if rates is None or not all(abs(a) <= limit for a, limit in zip(rates[nq:], limits)):
            return False
    return True


def resting(x: Sequence[float], times: Sequence[float]) -> Trajectory:
    """The motion that is none."""
    return Trajectory(list(times), [list(x) for _ in times], times[-1], list(x), OK)


def _limits(system: System, t: float, x: Sequence[float], plain: Sequence[float]) -> list[float]:
    """What rounding may bring to each acceleration; 0 for the work, whose rate has to vanish."""
    p, found = system.parameters, [0.0] * (system.nx - system.nq)
    for way in range(WAYS):
        last = [1.0 - ULP if (i + 1) * (2 * way + 3) >> 1 & 1 else 1.0 + ULP for i in range(len(x) + len(p))]
        other = system.bind([a * b for a, b in zip(p, last[len(x) :])])
        rates = _rates(other, t * last[0], [a * b for a, b in zip(x, last)])
        changes = [abs(a - b) for a, b in zip(rates or plain, plain)][system.nq :]
        found = [max(pair) for pair in zip(found, changes)]
    kinds = system.interface.kinds[system.nq :]
    largest = [max(c for c, k in zip(found, kinds) if k == kind) for kind in kinds]
    return [max(SEVERAL * c, most) for c, most in zip(found, largest)] + [0.0] * system.nz


def _rates(system: System, t: float, x: Sequence[float]) -> list[float] | None:
    """None where they cannot be told."""
    xdot, lam = [0.0] * system.nx, [0.0] * system.nc
    return None if system.rhs(t, x, xdot, lam) in FAILED else xdot
