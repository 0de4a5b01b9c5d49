"""Why a motion could not be followed: told only where it was found at the states themselves.

rank       a constraint all but depends on others, or vanishes (`losing_rank`)
jump       the rates differ on both sides of a state, however near
singular   speeds grow so fast that they are without bound in a moment
stiff      the fastest component is far faster than the motion, and steps are as short as its
           stability demands (E. Hairer, G. Wanner, *Solving ODEs II*, Springer 1996, IV.2)
kink       second differences of a constraint along the motion do not shrink as they should (`bent`)
growth     small differences grow by the same factor again and again
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import exp, inf, isfinite, log, sqrt

from lagc.simulation.error_measure import kinds, sizes
from lagc.simulation.system import FAILED, REDUNDANT, System, Trajectory, rates_at, row_name, state_name

NEAR = 1e3  # radians or sizes of their kind, per size of a row's terms: it loses rank nearby
WAYS = tuple([10.0**-k for k in range(3, 11)])  # of the time, to both sides of a state
JUMP = 0.01  # of the rates
MOMENT = 1e-5  # of the time: speeds that double in less are without bound
SLOWER = 100.0  # times as slow as the fastest component is the motion, where that is stiff
UNSTABLE = 1.0  # step times rate of the fastest component
TENFOLD = log(10.0)


def cause(system: System, run: Trajectory, t: float, x: list[float]) -> str:
    """What was found at (t, x), in words; empty where nothing was."""
    if len(x) < system.nx or not all(map(isfinite, x)):
        return ""
    return pinned(system, run, t, x) or _singular(system, run, t, x) or _stiff(system, run, t, x)


def pinned(system: System, run: Trajectory, t: float, x: list[float]) -> str:
    """A reason at (t, x) beyond which no method of this kind gets; empty where there is none."""
    return losing_rank(system, run, t, x) or bent(system, run, t, x) or _jump(system, run, t, x)


def losing_rank(system: System, run: Trajectory, t: float, x: list[float]) -> str:
    """Which constraint all but depends on others at (t, x), in words; empty where none does.

    To change its residual by the size of its terms alone, a coordinate would have to move very far beside
    the size of its kind, or the angles many turns.
    """
    if system.nc == 0 or len(x) < system.nx:
        return ""
    status = system.assemble(t, x)
    if status in FAILED:
        return ""
    row, farthest = system.culprit, inf
    if status != REDUNDANT:
        row, farthest, reach = -1, NEAR, _reach(system, run, x)
        for i, scale in enumerate(system.scales(t, x)):
            r = [0.0] * (system.nv + system.nc)
            r[system.nv + i] = scale
            moved = system.displace(t, x, system.solve(r)[: system.nv])
            way = max((abs(a) / b for a, b in zip(moved, reach)), default=0.0)
            if way > farthest:
                row, farthest = i, way
    return (
        f"near that posture {row_name(system, row)} all but depends on others, or vanishes"
        if row >= 0
        else ""
    )


def _reach(system: System, run: Trajectory, x: list[float]) -> list[float]:
    """What each coordinate may move by: the size of its kind so far, an angle by 1 rad; anything where a kind
    has been zero."""
    found = [0.0] * system.nq
    for group in kinds(system.interface):
        size = max(abs(y[i]) for y in [*run.states, x] for i in group) or inf
        for i in group:
            if i < system.nq:
                found[i] = 1.0 if i in system.interface.angles else size
    return found


def bent(system: System, run: Trajectory, t: float, x: list[float]) -> str:
    """Which constraint is not smooth at (t, x), in words; empty where all are.

    Along the motion r(t + h) - 2 r(t) + r(t - h) goes with h^2 where r is smooth, with h at a kink.
    """
    rates = rates_at(system, t, x) if len(x) == system.nx else None
    if rates is None:
        return ""
    here = system.position(t, x)
    bends: list[list[float]] = []
    for way in WAYS[:5]:
        h = way * _span(run, t)
        before, after = (system.position(t + d, [a + d * b for a, b in zip(x, rates)]) for d in (-h, h))
        bends.append([abs(a - 2.0 * b + c) for a, b, c in zip(before, here, after)])
    for k, sizes_of in enumerate(zip(*bends)):
        ratios = [a / b for a, b in pairwise(sizes_of) if b > 0.0]
        if any(all(5.0 < r < 20.0 for r in three) for three in zip(ratios, ratios[1:], ratios[2:])):
            return f"{row_name(system, k)} is not smooth there: the speeds would have to jump"
    return ""


def _span(run: Trajectory, t: float) -> float:
    return abs(t - run.times[0]) if run.times else 0.0


def _jump(system: System, run: Trajectory, t: float, x: list[float]) -> str:
    """Forces that jump: what an acceleration changes by from before to after does not go with the time
    between, as it does where it is smooth."""
    here = rates_at(system, t, x)
    changes: list[list[float]] = []
    for way in WAYS if here is not None else ():
        step = way * _span(run, t)
        ends = [rates_at(system, t + d, [a + d * b for a, b in zip(x, here or ())]) for d in (-step, step)]
        if ends[0] is None or ends[1] is None:
            return ""
        speeds = slice(system.nq, system.nq + system.nv)
        before, after = ends[0][speeds], ends[1][speeds]
        size = max(map(abs, [*before, *after]))
        changes.append([abs(b - a) if abs(b - a) > JUMP * size else 0.0 for a, b in zip(before, after)])
    for three in zip(changes, changes[1:], changes[2:]):
        for i, parts in enumerate(zip(*three)):
            if min(parts) > 0.9 * max(parts) > 0.0 and not _singular(system, run, t, x):
                name = state_name(system, system.nq + i)
                return f"the forces on {name} jump there; a smooth law, as tanh(v/v0) for sign(v), does not"
    return ""


def _singular(system: System, run: Trajectory, t: float, x: list[float]) -> str:
    rates = rates_at(system, t, x)
    if rates is None:
        return ""
    for i in range(system.nq, system.nq + system.nv):
        before = max((abs(y[i]) for y in run.states[: len(run.states) // 2 + 1]), default=0.0)
        if abs(x[i]) > 10.0 * before and abs(x[i]) < MOMENT * _span(run, t) * abs(rates[i]):
            return f"{state_name(system, i)} grows without bound there: the motion has a singularity"
    return ""


def _stiff(system: System, run: Trajectory, t: float, x: list[float]) -> str:
    rates = rates_at(system, t, x)
    if rates is None or run.steps == 0:
        return ""
    fastest = _fastest(system, run, t, x, rates)
    own = 0.0
    for group in kinds(system.interface):
        size = max((abs(y[i]) for y in [*run.states, x] for i in group), default=0.0)
        own = max(own, max(abs(rates[i]) for i in group) / size if size > 0.0 else 0.0)
    step = _span(run, t) / run.steps
    if not isfinite(fastest) or fastest * step < UNSTABLE or fastest < SLOWER * own:
        return ""
    times = fastest / max(own, 1e-300)
    return f"the motion is too stiff for this method: its fastest component is {times:.1g} times faster"


def _fastest(system: System, run: Trajectory, t: float, x: list[float], rates: list[float]) -> float:
    """The spectral radius of the rates' Jacobian, by the power method, in states over their sizes (1/s)."""
    weights = [1.0] * system.nx
    for group, size in sizes(run, system.interface):
        for i in group:
            weights[i] = size or 1.0
    n = system.nq + system.nv
    way = [1.0 / sqrt(n) if i < n else 0.0 for i in range(system.nx)]
    norm, products = 0.0, []
    for _ in range(20):
        moved = rates_at(system, t, [a + 1e-7 * w * d for a, w, d in zip(x, weights, way)])
        if moved is None or 0.0 in (1e-7 * w for w in weights):
            return 0.0
        change = [(b - a) / (1e-7 * w) for a, b, w in zip(rates, moved, weights)][:n]
        norm = sqrt(sum(a * a for a in change))
        if norm == 0.0 or not isfinite(norm):
            return 0.0
        products.append(log(norm))
        way = [a / norm for a in change] + [0.0] * (system.nx - n)
    late = products[len(products) // 2 :]
    return exp(sum(late) / len(late))  # two steps of an oscillation together


def growth(system: System, run: Trajectory, other: Trajectory, until: float) -> float | None:
    """The time in which differences of two runs grow tenfold, where they grow exponentially until then:
    by as much in each part of the motion, and better so than by a power of the time.  None where not."""
    found: list[tuple[float, float]] = []
    largest, span = 0.0, until - run.times[0]
    groups = [(group, size) for group, size in sizes(run, system.interface) if size > 0.0]
    for t, x, y in zip(run.times, run.states, other.states):
        largest = max([largest, *(abs(x[i] - y[i]) / size for group, size in groups for i in group)])
        if largest > 0.0 and run.times[0] < t <= until:
            found.append(((t - run.times[0]) / span, log(largest)))
    if len(found) < 8 or found[-1][1] - found[0][1] < 2.0 * TENFOLD:
        return None
    late = found[len(found) // 10 :]
    slope, rest = _line([(t, d) for t, d in late])
    _, power = _line([(log(t), d) for t, d in late])
    parts = [late[k * (len(late) - 1) // 4][1] for k in range(5)]
    steady = max(b - a for a, b in pairwise(parts)) < 0.7 * (parts[-1] - parts[0])
    return TENFOLD / slope * span if slope > 0.0 and rest < power and steady else None


def _line(points: Sequence[tuple[float, float]]) -> tuple[float, float]:
    """Slope and squared residual of the straight line through points."""
    n = len(points)
    a, b = sum(p[0] for p in points) / n, sum(p[1] for p in points) / n
    square = sum((x - a) ** 2 for x, _ in points) or 1e-300
    slope = sum((x - a) * (y - b) for x, y in points) / square
    return slope, sum((y - b - slope * (x - a)) ** 2 for x, y in points)
