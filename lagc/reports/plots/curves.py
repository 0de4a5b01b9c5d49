"""Curves of a run with their corners, and which of their changes are round-off."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import isfinite
from typing import TYPE_CHECKING

from lagc.base.records import dataclass, replace

if TYPE_CHECKING:
    from lagc.simulation.solution import Solution
    from lagc.simulation.system import Trajectory

SAMPLES = 20  # states at which outputs are asked what they are made of
BESIDE = 1e-6  # of the sizes of states: how far from these
CONSTANT = 1e-6  # of its values: a change below it is shown as none, as of an energy that is kept
ROUNDING = 1e-12  # of what an output is made of: a change below it is no more than rounding


@dataclass(frozen=True, slots=True)
class Scales:
    """Changes that are round-off: all changes of `constant`, changes of outputs below their `sizes`, and of
    sensitivities within their `doubts`."""

    constant: frozenset[str]
    sizes: dict[str, float]
    doubts: dict[str, float]

    def is_flat(self, name: str, values: Sequence[float], unit: str) -> bool:
        """Whether what is shown of `name`, in SI, is a constant."""
        share = CONSTANT if unit == "J" else ROUNDING
        least = max(share * self.sizes.get(name, 0.0), 2.0 * self.doubts.get(name, 0.0))
        return name in self.constant or is_constant(values, least)


def is_constant(values: Sequence[float], least: float = 0.0) -> bool:
    """Return whether the change is negligible relative to the values, or at most `least`: round-off must not
    fill an axis."""
    low, high = min(values), max(values)
    return high - low <= max(CONSTANT * max(abs(low), abs(high)), least)


def with_corners(solution: Solution) -> Solution:
    """With the states at events among those that are recorded: curves bend there, or jump."""
    last = solution.times[-1] if solution.times else 0.0
    corners = [(t, x) for t, *states in solution.corners if t <= last for x in states]
    points = sorted([*corners, *zip(solution.times, solution.states)], key=lambda point: point[0])
    return replace(
        solution, times=[t for t, _ in points], states=[x for _, x in points], sensitivities=None,
        expressions={}, _columns={},
    )  # fmt: skip


def scales(solution: Solution) -> Scales:
    from lagc.simulation.system import Trajectory

    if len(solution) < 2:
        return Scales(frozenset(), {}, {})
    times, states = solution.times, solution.states
    run = Trajectory(times, states, times[-1], states[-1], steps=solution.cost.steps)
    doubts = _doubts(solution)
    zero = [name for name, doubt in doubts.items() if all(abs(x) <= doubt for x in solution.column(name))]
    return Scales(frozenset([*_constant(solution, run), *zero]), _sizes(solution, run), doubts)


def _doubts(solution: Solution) -> dict[str, float]:
    varied = solution.sensitivities
    return {} if varied is None else {n: varied.doubt(n) for n in solution.names if n in varied}


def _constant(solution: Solution, run: Trajectory) -> Iterator[str]:
    """The states that rounding alone moves."""
    from lagc.simulation.error_measure import state_groups
    from lagc.simulation.global_error.roundoff_estimate import find_noise_groups, quick_estimate

    system, names = solution.system, solution.state_names
    groups = [(group, max(abs(x[i]) for x in run.states for i in group))
              for group in state_groups(system.interface)]  # fmt: skip
    bounds = find_noise_groups(system, run, groups, quick_estimate(system, run, groups))
    for k, (group, size) in enumerate(groups):
        if size <= bounds.get(k, 0.0):
            yield from (names[i] for i in group)


def _sizes(solution: Solution, run: Trajectory) -> dict[str, float]:
    """Return the change of each output if the states changed by their sizes, angles by at most a radian."""
    from lagc.simulation.error_measure import sizes
    from lagc.simulation.global_error.roundoff_estimate import generic

    system, interface = solution.system, solution.system.interface
    direction = [0.0] * system.nx
    for group, size in sizes(run, interface):
        for i in group:
            direction[i] = generic(i) * (min(size, 1.0) if interface.kinds[i] == 0 else size)
    found = [0.0] * len(interface.outputs)
    step = max(1, len(solution) // SAMPLES)
    for t, x in [*zip(solution.times, solution.states)][::step] if found else ():
        beside = system.outputs(t, [a + BESIDE * b for a, b in zip(x, direction)])
        changes = [abs(b - a) / BESIDE for a, b in zip(system.outputs(t, x), beside)]
        found = [max(a, b) if isfinite(b) else a for a, b in zip(found, changes)]
    return {output.name: size for output, size in zip(interface.outputs, found)}
