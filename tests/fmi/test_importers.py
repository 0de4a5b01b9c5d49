"""Model Exchange in a small explicit importer in C, with three habits of stopping at roots."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

import lagc
from tests.fmi.units import archive, program

HABITS = ("before", "on", "behind")
# Model, end, step: the error of the classical method at these steps is below 1e-9.
RUNS = [
    ("thermostat", 15.0, 0.05),
    ("bouncing_ball", 3.0, 0.01),
    ("sampled_pd", 0.95, 0.002),
    ("stick_slip_belt", 2.0, 0.005),
    ("block_on_belt", 4.0, 0.02),
    ("string_breaks", 1.0, 0.001),
    ("rod_impact", 0.6, 0.005),
    ("on_off_drive", 2.0, 0.01),
    ("rough_pin", 1.0, 0.002),
    ("conveyor", 1.0, 0.002),
]


@pytest.mark.sample(0)
@pytest.mark.skipif(shutil.which("gcc") is None, reason="there is no gcc")
@pytest.mark.parametrize(("model", "stop", "step"), RUNS, ids=[run[0] for run in RUNS])
def test_roots_are_passed_in_any_way(model: str, stop: float, step: float, tmp_path: Path) -> None:
    """An importer may stop before a root, as near to it as it gets, or behind it: each event of a run by
    lagc happens, at the same time, and the motion ends at the same state."""
    path = program(archive(model), "importer.c", tmp_path)
    system = lagc.load(model).compile()
    run = system.simulate(stop=stop, accuracy=1e-10)
    own = [event.t for event in run.events if event.t < stop]
    scale = [max(abs(run[name]).max() for name in names) for names in grouped(system)]
    for habit in range(3):
        done = subprocess.run(
            [path, str(habit), str(stop), str(step)], capture_output=True, text=True, timeout=60
        )
        assert done.returncode == 0, done.stderr
        rows = [line.split() for line in done.stdout.splitlines()]
        times = [float(row[1]) for row in rows if row[0] == "event"]
        for t in own:
            assert min(abs(t - other) for other in times) < 1e-7 * stop, (HABITS[habit], t)
        states = [float(row[1]) for row in rows if row[0] == "state"]
        for name, value, size in zip(system.interface.state_names, states, scale):
            assert abs(value - run[name][-1]) < 1e-6 * size, (HABITS[habit], name)


def grouped(system: lagc.api.CompiledModel) -> list[list[str]]:
    """The states of the scaling group of each state."""
    interface = system.interface
    return [
        [name for name, other in zip(interface.state_names, interface.kinds) if other == kind]
        for kind in interface.kinds
    ]
