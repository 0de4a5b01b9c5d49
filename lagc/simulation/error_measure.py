"""Scaling groups and their sizes, the compared quantities, and what contacts did in a run."""

from __future__ import annotations

from collections.abc import Sequence

from lagc.codegen.python.support.contacts import RESTS
from lagc.lowering.program import Interface
from lagc.simulation.system import Trajectory


def sizes(trajectory: Trajectory, interface: Interface) -> list[tuple[list[int], float]]:
    """Return the state indices of each scaling group and the largest magnitude of these states. The magnitude
    is taken over the recorded times and the ends of all steps."""
    largest = [max(max(column), -min(column)) for column in zip(*trajectory.states)]
    found = []
    for group in scaling_groups(interface):
        seen = [trajectory.sizes[interface.kinds[group[0]]]] if trajectory.sizes else [0.0]
        found.append((group, max(seen + [largest[i] for i in group] if largest else seen)))
    return found


def scaling_groups(interface: Interface) -> list[list[int]]:
    """The indices of the coordinates and speeds that share a scale."""
    groups: dict[int, list[int]] = {}
    for i, kind in enumerate(interface.kinds):
        groups.setdefault(kind, []).append(i)
    return list(groups.values())


def quantity_names(interface: Interface) -> list[str]:
    fields = (*interface.outputs, *interface.discretes)
    return [*interface.state_names, *(field.name for field in fields)]


def quantity_units(interface: Interface) -> list[str]:
    fields = (*interface.outputs, *interface.discretes)
    return [*interface.state_units, *(field.unit for field in fields)]


def contacts_of(run: Trajectory) -> Sequence[tuple[float, int, int, float, float, float]]:
    """Return what contacts did, as `ContactTrajectory` has it; nothing without contacts."""
    found: Sequence[tuple[float, int, int, float, float, float]] = getattr(run, "contacts", ())
    return found


def last_bounces(run: Trajectory) -> list[tuple[float, float]]:
    """The times between which a contact rests that would still bounce."""
    return [(t, end) for t, _, kind, _, _, end in contacts_of(run) if kind == RESTS]
