"""Every model of the library: no faults, a run, its energy balance, its constraints."""

import re

import pytest

import lagc
from lagc.host.model_library import library_models
from lagc.host.model_library import read as read_model
from tests.physics.library import brief, compiled, scenes

SCENES = scenes()
IDS = [f"{name}-{scene}" for name, scene in SCENES]


@pytest.mark.sample(0, 8)
@pytest.mark.parametrize("name", library_models())
def test_model_has_no_faults_in_any_scene(name: str) -> None:
    assert lagc.load(name).check() == []


@pytest.mark.parametrize("name", library_models())
def test_model_is_told_and_named(name: str) -> None:
    text = read_model(name).text
    story = re.match(r"(//[^\n]*\n)+", text)
    assert story is not None and len(story[0].splitlines()) >= 4
    model = re.findall(r"^model (\w+)", text, re.MULTILINE)[-1]
    snake = re.sub(r"(?<!^)(?=[A-Z])", "_", model).lower()
    assert snake == name.rpartition("/")[2]
    assert max(map(len, text.splitlines())) <= 120


@pytest.mark.sample(1, 12)
@pytest.mark.parametrize(("name", "scene"), SCENES, ids=IDS)
def test_scene_runs_with_its_energy_accounted_for(name: str, scene: str) -> None:
    system = compiled(name, scene, "numpy")
    run = system.simulate(brief(system), accuracy=1e-8, points=50)
    assert run.status == "ok", run.message
    assert run.times[-1] == brief(system)
    # energy moves on the scale of what the motion exchanges; the run is good to 1e-8 of the state
    energy = run.energy
    kinetic = max(system.system.energies(t, x)[0] for t, x in zip(run.times, run.states))
    scale = max(abs(energy.start), abs(energy.end), abs(energy.work), kinetic, 1e-3)
    assert abs(energy.imbalance) <= 1e-6 * scale


@pytest.mark.sample(6, 12)
@pytest.mark.parametrize(("name", "scene"), SCENES, ids=IDS)
def test_scene_stays_on_its_constraints(name: str, scene: str) -> None:
    system = compiled(name, scene, "numpy")
    run = system.simulate(brief(system), method="dop853", rtol=1e-8, atol=1e-8, points=2)
    assert run.status == "ok", run.message
    assert run.position_drift <= 1e-14
    assert run.velocity_drift <= 1e-14
