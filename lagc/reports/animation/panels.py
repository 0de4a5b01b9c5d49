"""The plots beside an animation: the columns of a run by unit, its energy error, residuals of constraints."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from lagc.reports.animation.arrays import Array
from lagc.reports.animation.channels import Channels
from lagc.reports.plots.curves import scales
from lagc.reports.plots.plot import by_unit, shown_names
from lagc.simulation.solution import Solution
from lagc.simulation.system import work_of

if TYPE_CHECKING:
    from lagc.reports.animation.shown import Shown

MOST_LINES = 8  # of one panel
LEAST_RESIDUAL = 1e-18  # on a logarithmic axis


def panels(shown: Shown, channels: Channels) -> list[dict[str, Any]]:
    """Return the data of all panels; columns of angles are in degrees."""
    run, model, found = shown.run, shown.scene.model, list[dict[str, Any]]()
    described = {x.name: x.description for x in (*model.coordinates, *model.outputs, *model.parameters)}
    units, known = run.units, scales(run)
    for unit, names in by_unit(run, shown_names(run)).items():
        factor = 180.0 / math.pi if "deg" in unit and not unit.startswith("orientation") else 1.0
        columns = [
            {"name": name, "about": described.get(name) or described.get(name.partition("[")[0], ""),
             "unit": units.get(name, ""), "size": factor * known.sizes.get(name, 0.0),
             "flat": known.is_flat(name, _finite(run.column(name)), units.get(name, "")),
             "y": [channels.add(r[name] * factor) if name in r else None for r in shown.runs]}
            for name in names[:MOST_LINES]
        ]  # fmt: skip
        found.append({"unit": "" if unit.startswith("orientation") else unit, "columns": columns,
                      "more": max(0, len(names) - MOST_LINES)})  # fmt: skip
    error = energy_error(run)
    if error is not None:
        column = {"name": "energy error", "about": "energy - start - work of the loads", "unit": "J",
                  "y": [channels.add(error)]}  # fmt: skip
        found.append({"unit": "J", "title": "energy error", "columns": [column], "more": 0, "folded": True})
    rows = residuals(run)
    if rows:
        columns = [{"name": name, "about": "", "unit": "", "y": [channels.add(y)]}
                   for name, y in rows[:MOST_LINES]]  # fmt: skip
        found.append({"unit": "", "title": "constraint residuals, scaled", "log": True, "columns": columns,
                      "more": max(0, len(rows) - MOST_LINES)})  # fmt: skip
    return found


def _finite(x: Sequence[float]) -> list[float]:
    return [value for value in x if math.isfinite(value)] or [0.0]


def energy_error(run: Solution) -> Array | None:
    """Return energy - start - work at the recorded points, in J; None if the energy has no value."""
    if not run.times or not math.isfinite(run.energy.start):
        return None
    system = run.system
    balance = np.array([system.energies(t, x)[2] - work_of(system, x) for t, x in zip(run.times, run.states)])
    error: Array = balance - balance[0]
    return error


def residuals(run: Solution) -> list[tuple[str, Array]]:
    """Return the label and the scaled residual, absolute, of each holonomic constraint over the recorded
    points."""
    system = run.system
    if not system.nh or not run.times:
        return []
    points = [*zip(run.times, run.states)]
    y = np.abs(np.array([system.position(t, x) for t, x in points]))
    size = np.array([system.scales(t, x)[: system.nh] for t, x in points])
    y = y / np.where(size > 0.0, size, 1.0)
    return [*zip(system.interface.row_labels, np.maximum(y, LEAST_RESIDUAL).T)]
