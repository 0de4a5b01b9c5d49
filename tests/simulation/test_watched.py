"""Runs are looked at between the times that are asked for: that changes nothing of what is told."""

from __future__ import annotations

from random import Random

import pytest

import lagc
from lagc.simulation.error_measure import FEWEST_PARTS, ComparisonGrid
from lagc.simulation.system import Options, Trajectory

pytestmark = pytest.mark.usefixtures("no_cache")


@pytest.mark.parametrize("seed", range(20))
def test_the_grid_has_all_recorded_times(seed: int) -> None:
    chance = Random(seed)
    size = 10.0 ** chance.uniform(-307.0, 308.0)
    asked = sorted(size * chance.random() for _ in range(chance.choice((1, 2, 3, 5, 33, 34, 100))))
    grid = ComparisonGrid(asked, chance.choice((0, 1, 32)))
    assert grid.times == sorted(grid.times)
    assert len(grid.times) > FEWEST_PARTS or len(asked) == 1
    run = Trajectory(grid.times, [[t] for t in grid.times], asked[-1], [asked[-1]])
    told = grid.recorded(run)
    assert told.times == asked and told.states == [[t] for t in asked]
    kept = chance.randrange(len(grid.times) + 1)  # a part of it
    told = grid.recorded(run.changed(times=run.times[:kept], states=run.states[:kept]))
    assert told.times == [t for t in asked if t in grid.times[:kept]] == [x for (x,) in told.states]


@pytest.mark.sample(2)
@pytest.mark.parametrize("name", ["double_pendulum", "string_pendulum", "heavy_top_quaternion", "four_bar"])
def test_a_run_on_the_grid_is_the_run_on_the_recorded_times(name: str) -> None:
    model = lagc.load(f"classic/{name}" if name != "string_pendulum" else name).compile(backend="numpy")
    x0 = model.simulate(0.0).states[0]
    for points in (1, 2, 5):
        asked = [0.5 * k / points for k in range(points + 1)]
        grid = ComparisonGrid(asked, 7)
        for tol in (1e-5, 1e-9):
            more, alone = (model.system.integrate(Options(rtol=tol), 0.0, x0, t) for t in (grid.times, asked))
            assert grid.recorded(more).states == alone.states and more.steps == alone.steps
