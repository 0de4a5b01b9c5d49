"""Reasons for which a run failed, found at the state where it ended.

rank         a constraint nearly depends on others, or its gradient vanishes (`losing_rank`, `kept_share`)
kink         a constraint is not differentiable (`kink`)
singularity  a speed becomes infinite in finite time
slip         a slip in space has just begun
stiffness    the fastest component is far faster than the motion, and its stability limits the step size
             (E. Hairer, G. Wanner, Solving ODEs II, 1996, IV.2)
growth       differences of two runs grow exponentially (`tenfold_time`)
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import exp, inf, isfinite, log, sqrt

from lagc.codegen.python.support.contacts import SLIPS
from lagc.simulation.error_measure import contacts_of, scaling_groups, sizes
from lagc.simulation.system import (
    FAILED,
    REDUNDANT,
    System,
    Trajectory,
    rates_at,
    row_gradients,
    row_name,
    state_name,
)

NEAR = 1e3  # displacement in radians or sizes, for a residual of the size of its terms: rank is lost nearby
OFFSETS = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7)  # of the elapsed time
MOMENT = 1e-5  # of the elapsed time: a speed that doubles in less becomes infinite
SLOWER = 100.0  # ratio of the fastest rate to that of the motion, for a stiff system
UNSTABLE = 1.0  # step size times the fastest rate
DIFFERENCE = 1e-7  # of the sizes of states
LINEAR = 1e-2  # of the sizes: smaller differences grow in proportion to themselves
TENFOLD = log(10.0)
# Growth in the last nine tenths of the time; the errors of a regular motion grow as t or t^2, by 100 at most.
MOST_REGULAR = 1e4
LATE = (0.2, 0.8)  # share of the second half in exponential growth: 0.5 on the average; of a jump, 0 or 1
CHECKED = 40  # recorded states
AT_ONCE = 1e-9  # of the time: a slip has begun just before
ROUNDING = 1e-11  # own share of a constraint's gradient that round-off may cause
OWN = 1e-3  # own share that the solver never treats as dependent

Point = tuple[float, Sequence[float]]  # t, x


def cause(system: System, run: Trajectory, t: float, x: list[float]) -> str:
    """Return the reason found at (t, x) in words, or "" if there is none."""
    if len(x) < system.nx or not all(map(isfinite, x)):
        return ""
    return (
        obstacle(system, run, t, x)
        or _slip_start(system, run)
        or _singularity(system, run, t, x)
        or _stiffness(system, run, t, x)
    )


def _slip_start(system: System, run: Trajectory) -> str:
    """Name a contact whose slip in space begins at the end of the run, or return ""."""
    for t, k, kind, *_ in reversed(contacts_of(run)[-1:]):
        contact = system.interface.contacts[k]
        if kind == SLIPS and contact.slips == 2 and run.t - t <= AT_ONCE * abs(run.t):
            return (f"`{contact.name}` begins to slip there without an acceleration, and its direction turns "
                    "ever faster; it begins smoothly with `static` a hundredth above `friction`")  # fmt: skip
    return ""


def obstacle(system: System, run: Trajectory, t: float, x: list[float]) -> str:
    """Return a reason at (t, x) that no explicit method can pass, or ""."""
    return losing_rank(system, run, t, x) or kink(system, run, t, x)


def losing_rank(system: System, run: Trajectory, t: float, x: list[float]) -> str:
    """Name a constraint that nearly depends on others at (t, x), or return "". To change its residual by the
    size of its terms, a coordinate would have to move by NEAR sizes of its scaling group, or an angle by NEAR
    radians."""
    if system.nc == 0 or len(x) < system.nx:
        return ""
    status = system.assemble(t, x)
    if status in FAILED:
        return ""
    row = system.culprit if status == REDUNDANT else -1
    farthest, limits = NEAR, _coordinate_sizes(system, run, x)
    for i, scale in enumerate(system.scales(t, x) if status != REDUNDANT else ()):
        r = [0.0] * (system.nv + system.nc)
        r[system.nv + i] = scale
        moved = system.displace(t, x, system.solve(r)[: system.nv])
        distance = max((abs(a) / b for a, b in zip(moved, limits)), default=0.0)
        if distance > farthest:
            row, farthest = i, distance
    return (
        f"{row_name(system, row)} nearly depends on others at this configuration, or vanishes"
        if row >= 0
        else ""
    )


def _coordinate_sizes(system: System, run: Trajectory, x: list[float]) -> list[float]:
    """The size of each coordinate's scaling group so far (infinite if zero); 1 rad for an angle."""
    found = [0.0] * system.nq
    for group in scaling_groups(system.interface):
        size = max(abs(y[i]) for y in [*run.states, x] for i in group) or inf
        for i in group:
            if i < system.nq:
                found[i] = 1.0 if i in system.interface.angles else size
    return found


def kink(system: System, run: Trajectory, t: float, x: list[float]) -> str:
    """Name a constraint or a bound that is not differentiable at (t, x), or return "". Along the motion,
    r(t + h) - 2 r(t) + r(t - h) is proportional to h^2 if r is smooth, and to h at a kink."""
    rates = rates_at(system, t, x) if len(x) == system.nx else None
    if rates is None:
        return ""

    def residuals(d: float) -> list[float]:
        at = t + d, [a + d * b for a, b in zip(x, rates)]
        return [*system.position(*at), *system.gaps(*at)]

    here, contacts = residuals(0.0), system.interface.contacts
    differences: list[list[float]] = []
    for offset in OFFSETS:
        h = offset * _elapsed(run, t)
        differences.append([abs(a - 2.0 * b + c) for a, b, c in zip(residuals(-h), here, residuals(h))])
    for k, of_row in enumerate(zip(*differences)):
        ratios = [a / b for a, b in pairwise(of_row) if b > 0.0]
        if any(all(5.0 < r < 20.0 for r in three) for three in zip(ratios, ratios[1:], ratios[2:])):
            if k >= len(here) - len(contacts):
                name = contacts[k - len(here)].name
                return (f"the bound `{name}` has a kink there: write a constraint for each of its sides, as "
                        "`y >= x` and `y >= -x` instead of `y >= abs(x)`")  # fmt: skip
            return f"{row_name(system, k)} is not differentiable there: the speeds would have to jump"
    return ""


def _elapsed(run: Trajectory, t: float) -> float:
    return abs(t - run.times[0]) if run.times else 0.0


def _singularity(system: System, run: Trajectory, t: float, x: list[float]) -> str:
    rates = rates_at(system, t, x)
    if rates is None:
        return ""
    for i in range(system.nq, system.nq + system.nv):
        before = max((abs(y[i]) for y in run.states[: len(run.states) // 2 + 1]), default=0.0)
        if abs(x[i]) > 10.0 * before and abs(x[i]) < MOMENT * _elapsed(run, t) * abs(rates[i]):
            return f"{state_name(system, i)} grows without bound there: the motion has a singularity"
    return ""


def _stiffness(system: System, run: Trajectory, t: float, x: list[float]) -> str:
    rates = rates_at(system, t, x)
    if rates is None or run.steps == 0:
        return ""
    fastest, own = _spectral_radius(system, run, t, x, rates), 0.0
    for group in scaling_groups(system.interface):
        size = max((abs(y[i]) for y in [*run.states, x] for i in group), default=0.0)
        own = max(own, max(abs(rates[i]) for i in group) / size if size > 0.0 else 0.0)
    step = _elapsed(run, t) / run.steps
    if not isfinite(fastest) or fastest * step < UNSTABLE or fastest < SLOWER * own:
        return ""
    times = fastest / max(own, 1e-300)
    found = f"the motion is too stiff for this method: its fastest component is {times:.1g} times faster"
    return found if system.interface.stiff else f"{found}; if that decays, take the method radau5"


def _spectral_radius(system: System, run: Trajectory, t: float, x: list[float], rates: list[float]) -> float:
    """Spectral radius of the Jacobian of the rates, by the power method in scaled states (1/s); 0 if
    unknown."""
    n = system.nq + system.nv
    scales = _state_sizes(system, run)[:n]
    direction = [1.0 / sqrt(n)] * n
    logarithms: list[float] = []
    for _ in range(20):
        y = [a + DIFFERENCE * s * d for a, s, d in zip(x, scales, direction)]
        moved = rates_at(system, t, [*y, *x[n:]])
        if moved is None or 0.0 in (DIFFERENCE * s for s in scales):
            return 0.0
        change = [(b - a) / (DIFFERENCE * s) for a, b, s in zip(rates, moved, scales)]
        norm = sqrt(sum(a * a for a in change))
        if norm == 0.0 or not isfinite(norm):
            return 0.0
        logarithms.append(log(norm))
        direction = [a / norm for a in change]
    late = logarithms[len(logarithms) // 2 :]
    return exp(sum(late) / len(late))  # the mean, because an oscillation alternates


def _state_sizes(system: System, run: Trajectory) -> list[float]:
    """The size of each state's scaling group; 1 if it is zero."""
    found = [1.0] * system.nx
    for group, size in sizes(run, system.interface):
        for i in group:
            found[i] = size or 1.0
    return found


def tenfold_time(system: System, run: Trajectory, other: Trajectory) -> float | None:
    """The time in which differences of two runs grow tenfold, while they are below LINEAR; None unless they
    grow exponentially: by more than MOST_REGULAR in the time after its first tenth, and in both halves of it.
    """
    found: list[tuple[float, float]] = []
    largest = 0.0
    groups = [(group, size) for group, size in sizes(run, system.interface) if size > 0.0]
    for t, x, y in zip(run.times, run.states, other.states):
        largest = max([largest, *(abs(x[i] - y[i]) / size for group, size in groups for i in group)])
        if 0.0 < largest <= LINEAR:
            found.append((t, log(largest)))
    begin = run.times[0]
    found = [(t, a) for t, a in found if t - begin >= 0.1 * (found[-1][0] - begin)]
    if len(found) < 8 or found[-1][1] - found[0][1] < log(MOST_REGULAR):
        return None
    (first, low), (_, middle), (last, high) = found[0], found[len(found) // 2], found[-1]
    exponential = LATE[0] < (high - middle) / (high - low) < LATE[1]
    return TENFOLD * (last - first) / (high - low) if exponential else None


def kept_share(system: System, run: Trajectory) -> tuple[int, float] | None:
    """Return a constraint that was treated as dependent but is not, and its own share, or None. Near a
    configuration where constraints lose rank, the solver leaves out those that nearly depend on others.  One
    that keeps a small share of its own at most of the states demands something that the motion does not
    meet."""
    return own_share(system, run, run.redundant_rows, _checked(run))


def open_reactions(system: System, run: Trajectory) -> list[int]:
    """The constraints whose multipliers are not unique at most of the states: those with z[k] not 0 for a z
    with G^T z = 0.  If there are none, those that were left out somewhere."""
    from lagc.mechanics.identities.linear_algebra import Span
    from lagc.simulation.initialization.inertia_check import sizes_of_speeds

    states = _checked(run)
    scales = sizes_of_speeds(system, *states[0])
    counts = [0] * system.nc
    for t, x in states:
        rows = [[a * s for a, s in zip(row, scales)] for row in row_gradients(system, t, x)]
        for k in Span(rows).entangled():
            counts[k] += 1
    found = [k for k, count in enumerate(counts) if 2 * count > len(states)]
    return found or list(run.redundant_rows)


def own_share(
    system: System, run: Trajectory, rows: Sequence[int], states: Sequence[Point]
) -> tuple[int, float] | None:
    """Return the first of `rows` with a small own share (ROUNDING to OWN) at most of `states`, and the share.
    The own share is the part of the gradient, in scaled speeds, that is orthogonal to the other gradients."""
    if not rows or not states:
        return None
    order = [*(i for i in range(system.nc) if i not in rows), *rows]
    shares = _shares(system, run, order, states, ROUNDING)
    return next(((row, _median(shares[row])) for row in rows if ROUNDING < _median(shares[row]) < OWN), None)


def _shares(
    system: System, run: Trajectory, order: Sequence[int], states: Sequence[Point], least: float
) -> list[list[float]]:
    """The own share of each constraint beside those before it in `order`, at each of the states. Gradients
    with a share above `least` join the orthonormal basis (Gram-Schmidt, done twice)."""
    scales = _state_sizes(system, run)[system.nq : system.nq + system.nv]
    shares: list[list[float]] = [[] for _ in order]
    for t, x in states:
        gradients = row_gradients(system, t, x)
        basis: list[list[float]] = []
        for i in order:
            rest, _ = _unit([a * s for a, s in zip(gradients[i], scales)])
            for other in (*basis, *basis):
                part = sum(a * b for a, b in zip(rest, other))
                rest = [a - part * b for a, b in zip(rest, other)]
            rest, share = _unit(rest)
            shares[i].append(share)
            if share > least:
                basis.append(rest)
    return shares


def _unit(row: list[float]) -> tuple[list[float], float]:
    """The vector over its length, and the length, without overflow; zero stays zero."""
    largest = max(map(abs, row), default=0.0)
    if not largest > 0.0:
        return row, 0.0
    length = largest * sqrt(sum((a / largest) ** 2 for a in row))
    return [a / length for a in row], length


def _checked(run: Trajectory) -> list[Point]:
    every = range(len(run.states))[:: -(-len(run.states) // CHECKED) or 1]
    return [(run.times[k], run.states[k]) for k in every]


def _median(values: Sequence[float]) -> float:
    return sorted(values)[len(values) // 2]
