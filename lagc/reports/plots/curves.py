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
SEVERAL = 3.0  # factor on the round-off of rates at a few states
UNITS = 4.0 * 2.0**-52
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
    """Return the run with the states at events among those that are recorded: curves bend there, or jump."""
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
    """The states that rounding alone moves: those of a verified run without a scale; of another run the
    groups that stay within the round-off of their rates, their change with the rounding unit of a state."""
    if solution.scales:
        yield from (name for name in solution.state_names if solution.scales.get(name, 1.0) == 0.0)
        return
    from lagc.simulation.error_measure import sizes
    from lagc.simulation.system import rates_at

    system, time = solution.system, SEVERAL * abs(run.times[-1] - run.times[0])
    change = [0.0] * system.nx
    for t, x in [*zip(run.times, run.states)][:: max(1, len(run.times) // SAMPLES)]:
        near = [a * (1.0 + UNITS * _generic(i)) for i, a in enumerate(x)]
        here, there = rates_at(system, t, x), rates_at(system, t, near)
        if here is not None and there is not None:
            change = [max(c, abs(b - a)) for c, a, b in zip(change, here, there)]
    # A rate that is round-off moves a state by at most its size times the time; a coordinate moves by its
    # speed.
    moved = [time * c for c in change]
    if system.nq == system.nv:
        moved[: system.nq] = [time * m for m in moved[system.nq :][: system.nv]]
    for group, size in sizes(run, system.interface):
        if size <= max(moved[i] for i in group):
            yield from (solution.state_names[i] for i in group)


def _generic(k: int) -> float:
    """A number of magnitude 1/2 to 3/2, without a pattern in k."""
    return (0.5 + 0.6180339887498949 * k % 1.0) * (1.0 if (k * 0x9E3779B1) & 0x4000 else -1.0)


def _sizes(solution: Solution, run: Trajectory) -> dict[str, float]:
    """Return the change of each output if the states changed by their sizes, angles by at most a radian."""
    from lagc.simulation.error_measure import sizes

    system, interface = solution.system, solution.system.interface
    direction = [0.0] * system.nx
    for group, size in sizes(run, interface):
        for i in group:
            direction[i] = _generic(i) * (min(size, 1.0) if interface.kinds[i] == 0 else size)
    found = [0.0] * len(interface.outputs)
    step = max(1, len(solution) // SAMPLES)
    for t, x in [*zip(solution.times, solution.states)][::step] if found else ():
        beside = system.outputs(t, [a + BESIDE * b for a, b in zip(x, direction)])
        changes = [abs(b - a) / BESIDE for a, b in zip(system.outputs(t, x), beside)]
        found = [max(a, b) if isfinite(b) else a for a, b in zip(found, changes)]
    return {output.name: size for output, size in zip(interface.outputs, found)}
