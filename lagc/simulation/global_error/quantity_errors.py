"""The error of each coordinate, speed, output and discrete variable alone, from the difference of two runs.

The accuracy of a run is relative to the largest state of a scaling group.  A quantity that is small beside
others of its group can be less accurate: it is named.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import islice
from math import inf, isfinite
from operator import sub

from lagc.simulation.error_measure import between, scaling_groups
from lagc.simulation.global_error.truncation import SAFETY
from lagc.simulation.system import System, Trajectory

COMPARED = 1000  # recorded times, at least, at which outputs are compared if there are so many
ROUNDING = 2.0**-42  # of the largest state of its group: an error of round-off
MOST_NAMED = 6
CONSTANT = 3.0  # errors: a quantity that moves by less is constant, as far as is known


def quantity_errors(
    system: System, run: Trajectory, other: Trajectory, factor: float, rounding: float
) -> list[float]:
    """The estimated largest absolute error of each coordinate, speed, output and discrete variable of `run`
    over the recorded times: its difference to `other`, times `factor`, and for a coordinate or speed
    `rounding` of its largest value."""
    n = min(len(run.states), len(other.states))
    left_out = between(run, other)
    kept = [k for k in range(n) if k not in left_out]
    columns = (
        zip(*([states[k] for k in kept] if left_out else states[:n])) for states in (run.states, other.states)
    )
    integrated = system.nq + system.nv
    found = [
        factor * max(map(abs, map(sub, a, b))) + (rounding * max(max(a), -min(a)) if i < integrated else 0.0)
        for i, (a, b) in enumerate(zip(*columns))
    ]
    outputs = [0.0] * len(system.interface.outputs)
    for k in compared(kept) if outputs else ():
        t = run.times[k]
        for i, (a, b) in enumerate(zip(system.outputs(t, run.states[k]), system.outputs(t, other.states[k]))):
            outputs[i] = max(outputs[i], abs(a - b)) if isfinite(a - b) else outputs[i]
    discrete = found[system.interface.nx - len(system.interface.discretes) :]
    every = (*found[:integrated], *(factor * apart for apart in outputs), *discrete)
    return [error if error < inf else inf for error in every]


def compared(kept: Sequence[int]) -> list[int]:
    """The times of `kept` at which outputs are compared; the last one is among them."""
    return sorted(kept[:: -max(len(kept) // COMPARED, 1)])


def poorly_known(system: System, run: Trajectory, errors: Sequence[float], asked: float) -> list[str]:
    """A note on the quantities with an error above `asked` times their own range over the recorded times (and
    the safety factor of the estimate).

    The range of a quantity that is constant within its error is unknown.  Its error is then compared with its
    largest value; for a state that begins at 0 with that of its group, for an output with that of its unit.
    A state that only round-off moves is not named."""
    interface, n = system.interface, system.nq + system.nv
    columns = [*islice(zip(*run.states), n)]
    sizes = [max(max(column), -min(column)) for column in columns]
    group_sizes = [0.0] * n
    for group in scaling_groups(interface):
        for i in group:
            group_sizes[i] = max(sizes[k] for k in group)
    shares: list[tuple[float, str]] = []

    def compare(name: str, values: Sequence[float], error: float, size: float) -> None:
        span = max(values, default=0.0) - min(values, default=0.0)
        if error > SAFETY * asked * (size if span <= CONSTANT * error else span):
            shares.append((error / span if span else inf, name))

    for i, name in enumerate(interface.state_names):
        if errors[i] > ROUNDING * group_sizes[i]:
            compare(name, columns[i], errors[i], sizes[i] if columns[i][0] else group_sizes[i])
    times = compared(range(len(run.states))) if interface.outputs else []
    looked = [(run.times[k], run.states[k]) for k in times]
    rows = [system.outputs(t, x) for t, x in looked]
    largest: dict[str, float] = {}  # by unit
    energies = (
        [system.energies(t, x)[:2] for t, x in looked] if "J" in [o.unit for o in interface.outputs] else []
    )
    for units, table in ((interface.state_units, [x for _, x in looked]),
                         ([o.unit for o in interface.outputs], rows),
                         (["J", "J"], energies)):  # fmt: skip
        for k, unit in enumerate(units):
            values = [abs(row[k]) for row in table if isfinite(row[k])]
            largest[unit] = max([largest.get(unit, 0.0), *values])
    for i, output in enumerate(interface.outputs):
        values = [row[i] for row in rows if isfinite(row[i])]
        if largest[output.unit] > CONSTANT * errors[n + i]:  # else nothing is known of its terms
            compare(output.name, values, errors[n + i], largest[output.unit])
    if not shares:
        return []
    shares.sort(reverse=True)
    named = ", ".join(f"`{name}` by {share:.1g}" for share, name in shares[:MOST_NAMED])
    more = f" and {len(shares) - MOST_NAMED} more" if len(shares) > MOST_NAMED else ""
    return [f"the accuracy {asked:g} is relative to the largest state of the same unit; of their own ranges "
            f"these may be off: {named}{more}"]  # fmt: skip
