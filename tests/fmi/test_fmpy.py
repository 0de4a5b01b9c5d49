"""FMUs in FMPy, which validates them against the schema of FMI and simulates them."""

import ctypes
import shutil
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import lagc
from lagc.simulation.backends.compile import compiler
from tests.fmi.measured import MODELS, errors
from tests.fmi.units import archive

HORIZON = 3.0  # s: errors of chaotic motions grow
fmpy = pytest.importorskip("fmpy")
pytestmark = pytest.mark.skipif(compiler() is None, reason="there is no C compiler")


@contextmanager
def instance(model: str, folder: Path, kind: str = "Slave", version: int = 3, **how: Any) -> Iterator[Any]:
    """An instance that is initialized, with the description of its FMU; `how` is for its instantiation."""
    path = folder / f"{model}{version}.fmu"
    if not path.exists():  # a library that is loaded must not be written again
        path.write_bytes(archive(model, version, None))
        fmpy.extract(str(path), str(path.with_suffix("")))
    about = fmpy.read_model_description(str(path))
    room = __import__(f"fmpy.fmi{version}", fromlist=["*"])
    made = getattr(room, f"FMU{version}{kind}")(
        guid=about.guid, unzipDirectory=str(path.with_suffix("")),
        instanceName="one", modelIdentifier=about.coSimulation.modelIdentifier,
    )  # fmt: skip
    made.instantiate(**how)
    made.about = about
    if version == 2:
        made.setupExperiment()
    made.enterInitializationMode()
    made.exitInitializationMode()
    yield made
    made.freeInstance()


def references(made: Any, *causalities: str) -> list[int]:
    return [v.valueReference for v in made.about.modelVariables if v.causality in causalities]


@pytest.mark.full
@pytest.mark.parametrize("version", [2, 3])
def test_states_are_copied(version: int, tmp_path: Path) -> None:
    """A state that is set again, or comes as bytes to another instance, goes on with the same bits."""
    with (
        instance("bouncing_ball", tmp_path, version=version) as one,
        instance("bouncing_ball", tmp_path, version=version) as two,
    ):
        read = one.getFloat64 if version == 3 else one.getReal
        vrs = references(one, "output")
        one.doStep(0.0, 0.5)
        state = one.getFMUState()
        data = one.serializeFMUState(state)
        one.doStep(0.5, 1.5)
        first = read(vrs)
        one.setFMUState(state)
        one.doStep(0.5, 1.5)
        assert read(vrs) == first
        two.setFMUState(two.deserializeFMUState(data))
        two.doStep(0.5, 1.5)
        assert (two.getFloat64 if version == 3 else two.getReal)(vrs) == first
        with pytest.raises(Exception):  # noqa: B017  (FMPy's own)
            two.deserializeFMUState(b"x" + data[1:])


@pytest.mark.full
def test_wrong_calls_are_refused(tmp_path: Path) -> None:
    with instance("bouncing_ball", tmp_path) as made:
        calls: list[Callable[[], Any]] = [
            lambda: made.doStep(5.0, 0.1),
            lambda: made.doStep(0.0, -0.1),
            lambda: made.enterInitializationMode(),
            lambda: made.setFloat64([references(made, "output")[0]], [1.0]),
            lambda: made.getFloat64([10_000]),
        ]
        for wrong in calls:
            with pytest.raises(Exception):  # noqa: B017
                wrong()
        made.doStep(0.0, 0.1)


@pytest.mark.full
def test_a_wrong_token_is_refused(tmp_path: Path) -> None:
    with instance("simple_pendulum", tmp_path) as made:
        other = type(made)(guid="{0}", unzipDirectory=made.unzipDirectory, instanceName="x",
                           modelIdentifier=made.modelIdentifier)  # fmt: skip
        with pytest.raises(Exception):  # noqa: B017
            other.instantiate()


@pytest.mark.full
def test_communication_points_change_the_end_by_the_tolerance_alone(tmp_path: Path) -> None:
    """Communication points do not change events, and steps that end at them are as accurate."""
    found = []
    for count in (1, 97):
        with instance("bouncing_ball", tmp_path) as made:
            for k in range(count):
                made.doStep(3.0 * k / count, 3.0 * (k + 1) / count - 3.0 * k / count)
            found.append(made.getFloat64(references(made, "output", "local")))
    assert found[0] == pytest.approx(found[1], rel=1e-9, abs=1e-9)


@pytest.mark.full
def test_early_return_at_impacts(tmp_path: Path) -> None:
    run = lagc.load("bouncing_ball").compile().simulate(stop=2.0, accuracy=1e-9)
    hits, t = [], 0.0
    with instance("bouncing_ball", tmp_path, eventModeUsed=True, earlyReturnAllowed=True) as made:
        made.updateDiscreteStates()
        made.enterStepMode()
        while t < 2.0:
            event, _, _, t = made.doStep(t, 2.0 - t)
            if event:
                hits.append(t)
                made.enterEventMode()
                made.updateDiscreteStates()
                made.enterStepMode()
    assert hits == pytest.approx([event.t for event in run.events if event.t < 2.0], rel=1e-9)


@pytest.mark.full
def test_no_early_return_unless_allowed(tmp_path: Path) -> None:
    with instance("bouncing_ball", tmp_path, eventModeUsed=True, earlyReturnAllowed=False) as made:
        made.updateDiscreteStates()
        made.enterStepMode()
        _, _, early, t = made.doStep(0.0, 2.0)  # beyond four impacts
        assert t == 2.0 and not early


@pytest.mark.full
def test_two_threads(tmp_path: Path) -> None:
    """Instances share nothing: two that run at the same time give the bits of one."""
    found: dict[int, list[float]] = {}

    def work(k: int) -> None:
        with instance("double_pendulum", tmp_path) as made:
            for n in range(200):
                made.doStep(n / 100, (n + 1) / 100 - n / 100)
            found[k] = made.getFloat64(references(made, "local", "output"))

    work(0)
    threads = [threading.Thread(target=work, args=(k,)) for k in (1, 2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found[0] == found[1] == found[2]


@pytest.mark.full
@pytest.mark.parametrize("model", ["four_bar", "simple_pendulum", "cart_pendulum"])
def test_directional_derivatives(model: str, tmp_path: Path) -> None:
    """They are those of central differences, whose error is some 1e-9."""
    with instance(model, tmp_path, "Model") as made:
        made.updateDiscreteStates()
        made.enterContinuousTimeMode()
        states = [u.variable.derivative.valueReference for u in made.about.derivatives]
        unknowns = [u.variable.valueReference for u in made.about.derivatives] + references(made, "output")
        n = len(states)
        x = np.array(made.getFloat64(states))
        for k in range(n):
            exact = np.array(made.getDirectionalDerivative(unknowns, [states[k]], [1.0]))
            values = []
            for h in (1e-5, -1e-5):
                y = x.copy()
                y[k] += h
                made.setContinuousStates((ctypes.c_double * n)(*y), n)
                values.append(np.array(made.getFloat64(unknowns)))
            made.setContinuousStates((ctypes.c_double * n)(*x), n)
            rough = (values[0] - values[1]) / 2e-5
            assert exact == pytest.approx(rough, rel=1e-7, abs=1e-7 * max(1.0, abs(rough).max()))


@pytest.mark.full
def test_start_values(tmp_path: Path) -> None:
    """A start value that is set holds; that of the description leaves the one that a parameter gives."""
    path = tmp_path / "bouncing_ball.fmu"
    path.write_bytes(archive("bouncing_ball", 3, None))
    for given, begins in (({"y": 2.0}, 2.0), ({"h": 3.0}, 3.0), ({"h": 3.0, "y": 1.0}, 3.0)):
        found = fmpy.simulate_fmu(
            str(path), start_values=given, stop_time=0.01, fmi_type="CoSimulation", output=["y"]
        )
        assert found["y"][0] == begins


@pytest.mark.full
@pytest.mark.skipif(shutil.which("cmake") is None, reason="there is no CMake")
@pytest.mark.parametrize("version", [2, 3])
def test_sources_are_compiled_by_fmpy(version: int, tmp_path: Path) -> None:
    from fmpy.build import build_platform_binary

    path = tmp_path / "m.fmu"
    path.write_bytes(archive("simple_pendulum", version, ()))
    folder = fmpy.extract(str(path), str(tmp_path / "m"))
    build_platform_binary(folder, configuration="Debug")
    assert fmpy.simulate_fmu(folder, stop_time=0.1)["time"][-1] == 0.1


@pytest.mark.sample(0, 4)
@pytest.mark.parametrize("model", MODELS)
def test_library(model: str, tmp_path: Path) -> None:
    """FMPy finds no fault and simulates both kinds: Co-Simulation by lagc, Model Exchange by CVODE."""
    found = errors(model, tmp_path, (3,), HORIZON)[0]
    assert not found.problems
    assert found.co < 1e-6 and found.exchange < 1e-3, found
