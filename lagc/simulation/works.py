"""The work of each action along a run.

The power of each action and of each constraint that moves is summed by Gauss's rule between events, with
twice as many panels until the sums agree.  The work that is left of the run's own integral is that of
contacts, and of energies and velocities that are given functions of time.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from math import ceil, inf

from lagc.base.records import dataclass
from lagc.codegen.python.support.base import MOST_CORNERS
from lagc.mechanics.formulation.equations import EquationsOfMotion, Law
from lagc.simulation.system import Options, System, Trajectory, arrived, work_of
from lagc.simulation.values import values_at
from lagc.symbolic.graph import Node
from lagc.symbolic.walk import evaluate, reachable

# Gauss-Legendre of 5 points on (0, 1): M. Abramowitz, I. Stegun, 1964, table 25.4
NODES = (0.04691007703066800, 0.2307653449471585, 0.5, 0.7692346550528415, 0.9530899229693320)
WEIGHTS = (0.1184634425280945, 0.2393143352496832, 0.2844444444444444, 0.2393143352496832, 0.1184634425280945)
RTOL = 1e-11  # of the run
FEWEST = 50  # panels
MOST = 1_000_000  # evaluated nodes of expressions
AGREE = 1e-8  # of the largest work or energy


@dataclass(frozen=True)
class Works:
    """Works and energies in J.  `actions` are those of each action, potentials included, `rows` those of
    constraints by their label, `clauses` those of `when` clauses by their number; `rest` is that of contacts
    and drives, `of_contacts` if there are no drives.  `bar`: how well the sums agree.

    end = start + actions that are not conservative + rows + clauses + rest"""

    actions: Mapping[str, float]
    rows: Mapping[str, float]
    clauses: Mapping[int, float]
    rest: float
    of_contacts: bool
    start: float
    end: float
    bar: float


def works(
    equations: EquationsOfMotion,
    system: System,
    x: Sequence[float],
    stop: float,
    method: str,
    pointwise: System | None = None,
) -> Works | None:
    """Return the works of a run from the state x at 0; None if it fails before `stop`, or has so many
    events or so long powers that the sums would take long.  `pointwise`: the system that tells forces at
    single states, in Python if there are contacts; default: the same."""
    options = Options(method=method, rtol=RTOL, max_steps=0, report=True)
    graph = equations.graph
    # Powers: of each load, and of each constraint that does work, its multiplier times the velocity along it.
    rows = [row for row in equations.rows if row.time_dependent or not row.holonomic]
    rows = [row for row in rows if row.law is Law.PERFECT]  # the actuator of another is an action
    moved = [graph.sum(slope * equations.v[j] for j, slope in row.jacobian.items()) for row in rows]
    powers = [*(c.power for c in equations.contributions), *(r.multiplier * u for r, u in zip(rows, moved))]
    within = reachable(powers)
    # Panels of Gauss quadrature lie between events, where powers are smooth.
    run, panels = system.integrate(options, 0.0, x, [0.0, stop]), FEWEST
    if not arrived(run) or len(run.corners) >= MOST_CORNERS:
        return None
    stop = run.t
    start, end = (system.energies(t, y)[2] for t, y in ((0.0, run.states[0]), (stop, run.states[-1])))
    times = {0.0, stop, *(t for t, _ in run.events), *(t for t, _, _ in run.corners)}
    cuts = list(pairwise(sorted(times)))
    sums: list[float] | None = None
    bar = inf
    # Panels are halved until two sums agree.
    while True:
        parts = _panels(cuts, stop / panels)
        if len(parts) * len(NODES) * max(len(within), 1) > MOST:
            break
        before, panels = sums, 2 * panels
        states = system.integrate(options, 0.0, x, [0.0, *_nodes(parts)]).states[1:]
        sums = _sums(equations, powers, within, pointwise or system, states, parts)
        size = max(map(abs, [*sums, start, end]))
        if before is not None:
            bar = max((abs(a - b) for a, b in zip(sums, before)), default=0.0)
        if bar <= AGREE * size:
            break
    if sums is None or bar == inf:
        return None
    # The works of clauses, and the rest of the whole work, which is that of contacts.
    clauses = _jumps(system, run)
    count = len(equations.contributions)
    by_row = dict(zip([row.label for row in rows], sums[count:]))
    given = sum(work for c, work in zip(equations.contributions, sums) if not c.conservative)
    given += sum(by_row.values()) + sum(clauses.values())
    total = work_of(system, run.states[-1]) - work_of(system, run.states[0])
    known = graph.sum(c.power for c in equations.contributions if not c.conservative)
    size = max(map(abs, [*sums, start, end]), default=0.0)
    driven = equations.power is not known
    alone = not (driven or equations.contacts) or abs(total - given) <= AGREE * size
    named = dict(zip([c.name for c in equations.contributions], sums))
    return Works(named, by_row, clauses, 0.0 if alone else total - given, not driven, start, end, bar)


def _panels(cuts: Sequence[tuple[float, float]], longest: float) -> list[tuple[float, float]]:
    """Return begin and length of each panel."""
    found = []
    for begin, end in cuts:
        count = ceil((end - begin) / longest)
        length = (end - begin) / count
        found += [(begin + k * length, length) for k in range(count)]
    return found


def _nodes(panels: Sequence[tuple[float, float]]) -> list[float]:
    return [begin + node * length for begin, length in panels for node in NODES]


def _sums(
    equations: EquationsOfMotion, powers: Sequence[Node], within: Sequence[Node], system: System,
    states: Sequence[Sequence[float]], panels: Sequence[tuple[float, float]],
) -> list[float]:  # fmt: skip
    """Return the integrals of the powers from the states at the nodes."""
    own = {*equations.lam, *(force for contact in equations.contacts for force in contact.forces)}
    forces, found = not own.isdisjoint(within), [0.0] * len(powers)
    for k, (t, y) in enumerate(zip(_nodes(panels), states)):
        weight = WEIGHTS[k % len(WEIGHTS)] * panels[k // len(WEIGHTS)][1]
        known = values_at(equations, system, t, y, forces)
        for i, power in enumerate(evaluate(powers, known, within)):
            found[i] += weight * power
    return found


def _jumps(system: System, run: Trajectory) -> dict[int, float]:
    """Return the changes of the energy by `when` clauses. Those that set discrete variables alone change
    nothing else, where a contact has an impact at the same time."""
    found: dict[int, float] = {}
    first = len(system.interface.relations)
    moving = system.interface.nx - len(system.interface.discretes)
    for t, before, after in run.corners:
        giving = [k - first for at, k in run.events if at == t and k >= first]
        giving = [k for k in giving if system.interface.whens[k].states]
        if giving:
            if all(state >= moving for k in giving for state in system.interface.whens[k].states):
                before = [*after[:moving], *before[moving:]]
            change = system.energies(t, after)[2] - system.energies(t, before)[2]
            found[giving[0]] = found.get(giving[0], 0.0) + change
    return found
