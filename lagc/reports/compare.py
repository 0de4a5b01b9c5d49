"""Scenes of a model side by side, as tables and as plain data."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from lagc.base.text import WIDTH, printable, table
from lagc.simulation.solution import Solution

COLUMNS = 6  # quantities that a table shows


@dataclass(frozen=True)
class Compared:
    """Runs of scenes over the same recorded times. `names` are the coordinates and outputs that all have;
    `differences` are the largest from the first scene over time, each of the largest range in a scene;
    None where a run ended before."""

    scenes: tuple[str, ...]
    runs: tuple[Solution, ...]
    names: tuple[str, ...]
    differences: tuple[dict[str, float | None], ...]


def compare(scenes: Sequence[str], runs: Sequence[Solution]) -> Compared:
    """Compare the runs with the first."""
    first = runs[0]
    own = [(*run.system.interface.q_names, *(x.name for x in run.system.interface.outputs)) for run in runs]
    names = tuple([name for name in own[0] if all(name in others for others in own)])
    spans = {name: _span([run.column(name) for run in runs]) for name in names}
    found: list[dict[str, float | None]] = []
    for run in runs:
        differences: dict[str, float | None] = {}
        for name in names:
            here, there = first.column(name), run.column(name)
            whole = len(there) == len(here)
            apart = max(abs(a - b) for a, b in zip(here, there))
            differences[name] = apart / spans[name] if whole and apart else 0.0 if whole else None
        found.append(differences)
    return Compared(tuple(scenes), tuple(runs), names, tuple(found))


def _span(columns: Sequence[Sequence[float]]) -> float:
    """The largest range of a column; where none moves, the largest magnitude."""
    ranges = max(max(column) - min(column) for column in columns)
    return ranges or max(max(map(abs, column)) for column in columns)


def text(found: Compared, all_names: bool = False) -> str:
    """Return the tables for a terminal."""
    first = found.runs[0]
    lines = [f"{first.system.interface.model}, 0 to {first.end:g} s"]
    head = ["scene", "operations", "evaluations", "estimated", "ended"]
    rows = []
    for scene, run in zip(found.scenes, found.runs):
        alone = run.cost.alone or run.cost.rhs
        estimated = "" if run.estimated is None else f"{run.estimated:.0e}"
        rows.append([scene, str(run.cost.operations), str(alone), estimated, run.message])
    lines += table(head, rows)
    names = found.names if all_names else _fitting(found)
    if len(found.runs) > 1 and names:
        lines += ["", f"Largest difference from `{found.scenes[0]}`, of the largest range in a scene"]
        rows = [
            [scene, *("" if own[n] is None else f"{own[n]:.1e}" for n in names)]
            for scene, own in list(zip(found.scenes, found.differences))[1:]
        ]
        lines += table(["scene", *names], rows)
    lines += ["", "Final values"]
    labels = [_label(first, name) for name in names]
    rows = [
        [scene, *(f"{run.final[name]:.9g}" for name in names)] for scene, run in zip(found.scenes, found.runs)
    ]
    lines += table(["scene", *labels], rows)
    if len(names) < len(found.names):
        lines.append(f"  ({len(found.names) - len(names)} more: -v shows them)")
    return "\n".join(map(printable, lines)) + "\n"


def _label(run: Solution, name: str) -> str:
    return f"{name} [{run.units[name]}]" if run.units.get(name) else name


def _fitting(found: Compared) -> tuple[str, ...]:
    """Return the first names whose columns fit a terminal, at least one."""
    first, width = found.runs[0], 4 + max(map(len, ("scene", *found.scenes)))
    for k, name in enumerate(found.names):
        values = [f"{run.final[name]:.9g}" for run in found.runs]
        width += max(map(len, (_label(first, name), *values))) + 2
        if k and width > WIDTH + 2:
            return found.names[:k]
    return found.names


def to_dict(found: Compared) -> dict[str, Any]:
    """Return the object that `lagc compare --json` prints."""
    return {
        "compared": list(found.names),
        "scenes": [
            {"scene": scene, "differences": dict(own), **run.to_dict()}
            for scene, run, own in zip(found.scenes, found.runs, found.differences)
        ],
    }
