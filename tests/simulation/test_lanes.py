"""Runs in the lanes of vectors have the bits of single runs, whatever their neighbours do."""

import sys
from collections.abc import Mapping, Sequence
from platform import machine
from random import Random
from typing import Any

import pytest

import lagc
from lagc.codegen.c.lanes import WIDTHS, lanes
from lagc.simulation.backends.lanes import Lanes
from lagc.simulation.repeated import RunsByHand
from lagc.simulation.request import Request
from lagc.simulation.solution import columns_of

RUNS = 37  # no multiple of a width


@pytest.mark.parametrize(
    "name", ["bouncing_ball", "four_bar", "thermostat", "heavy_top_quaternion", "spherical_pendulum"]
)
@pytest.mark.full
def test_models_with_events_or_constraints_have_none(name: str) -> None:
    system = lagc.load(name).compile(backend="c")
    model = system._loaded.system("c").model
    assert lanes(model.interface, model.sources) is None


def runs_of(system: lagc.CompiledModel, request: Request) -> RunsByHand:
    complete = request.completed(system.interface.simulate)
    columns = columns_of(system.interface)
    return RunsByHand(system._loaded.system("c"), complete, columns, False)  # type: ignore[arg-type]


def points_of(system: lagc.CompiledModel) -> list[tuple[list[float], dict[int, float]]]:
    """Values and starts that differ from run to run: some angles are far, some at rest."""
    dice, interface = Random(2), system.interface
    fields = [f.value or 0.0 for f in (*interface.parameters, *interface.inputs)]
    found: list[tuple[list[float], dict[int, float]]] = []
    for k in range(RUNS):
        starts = {i: dice.uniform(-2.0, 2.0) for i in range(interface.nx)}
        if k % 5 == 0:
            starts = {0: 1e6 * k} if interface.state_units[0] == "rad" else {}
        found.append(([value * dice.uniform(0.8, 1.2) for value in fields], starts))
    return found


def results(runs: RunsByHand, points: Sequence[tuple[list[float], Mapping[int, float]]]) -> list[Any]:
    found = []
    for values, starts in points:
        went = runs.run(values, starts, lambda t: None)
        found.append((went, bytes(runs.flat) if went else b""))
    return found


# Two angles and one, the time, roots and other functions, models with many states.
MODELS = ["double_pendulum", "simple_pendulum", "driven_oscillator", "kepler", "elastic_pendulum",
          "toda_lattice", "three_body_figure_eight"]  # fmt: skip


@pytest.mark.full
@pytest.mark.skipif(machine() != "x86_64" or sys.platform == "win32", reason="vectors")
@pytest.mark.parametrize("name", MODELS)
def test_lanes_have_the_bits_of_single_runs(name: str) -> None:
    system = lagc.load(name).compile(backend="c")
    points = points_of(system)
    for request in (Request(stop=3.0, rtol=1e-9, points=7), Request(stop=2.0, rtol=1e-13, points=2)):
        alone = results(runs_of(system, request), points)
        assert sum(went for went, _ in alone) > RUNS // 2
        for width, needed in WIDTHS.items():
            runs = runs_of(system, request)
            runs.lanes = Lanes(runs.system.model, {width: needed})
            if runs.lanes.count != width:
                continue  # this processor has no such vectors
            runs.run_lanes(points)
            assert len(runs.ready) > RUNS // 2
            assert results(runs, points) == alone
            assert not runs.ready
