"""Models, systems and runs travel to other processes, and back."""

import copy
import multiprocessing
import pickle
import subprocess
import sys
from operator import attrgetter, methodcaller
from pathlib import Path

import pytest

import lagc
from lagc.simulation.backends import compile as c_compiler
from lagc.simulation.system import Options
from tests.simulation.programs import BACKENDS, NAMES, build, programs

pytestmark = pytest.mark.usefixtures("own_cache")


@pytest.mark.sample(1, 7)
@BACKENDS
@pytest.mark.parametrize("name", NAMES)
def test_a_system_comes_back(name: str, backend: str) -> None:
    system = build(programs()[name], backend)
    system = system.bind([1.25 * v for v in system.parameters])
    back = pickle.loads(pickle.dumps(system))
    assert back.parameters == system.parameters and back.interface == system.interface
    x = system.start()
    one, other = (s.integrate(Options(rtol=1e-7), 0.0, x, [0.1, 0.3]) for s in (system, back))
    assert repr(vars(one)) == repr(vars(other))
    assert copy.deepcopy(system) is system and copy.copy(system) is system
    both = pickle.loads(pickle.dumps((system, system.bind(system.parameters))))
    assert both[0].compiled is both[1].compiled  # what is shared stays shared


@pytest.mark.sample(0, 2)
@BACKENDS
@pytest.mark.parametrize("name", ["simple_pendulum", "classic/four_bar"])
def test_everything_travels(name: str, backend: str) -> None:
    """To a process that was not forked: a file, a model bound to values, its run; and the run back."""
    file = lagc.load(name)
    model = file.compile(backend=backend)
    values = {f.name: 1.01 * (f.value or 0.0) for f in model.interface.parameters[:1]}
    bound = model.bind(values)
    here = bound.simulate(stop=0.2, accuracy=1e-7, points=6)
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        there = pool.apply(methodcaller("simulate", stop=0.2, accuracy=1e-7, points=6), (bound,))
        again = pool.apply(methodcaller("compile", backend=backend), (file,))
        final = pool.apply(attrgetter("final"), (here,))
    assert there.states == here.states and there.parameters == here.parameters
    for column in here.columns:
        assert there[column].tolist() == here[column].tolist(), column
    assert final == here.final
    assert (
        again.interface == model.interface and again.bind(values).system.parameters == here.system.parameters
    )
    assert again.equations.q and copy.deepcopy(again) is again and copy.copy(again) is again


@pytest.mark.sample(1)
@BACKENDS
def test_a_model_travels_before_it_has_run(backend: str) -> None:
    model = lagc.load("simple_pendulum").compile(scene="room", backend=backend, parameters={"l": (70, "cm")})
    back = pickle.loads(pickle.dumps(model))
    assert back.simulate(stop=0.1).states == model.simulate(stop=0.1).states
    assert "theta" in back._repr_latex_()


@pytest.mark.full
@BACKENDS
def test_a_run_is_read_where_nothing_was_compiled(
    backend: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    run = lagc.load("simple_pendulum").compile(scene="vacuum", backend=backend).simulate(stop=0.3, points=4)
    (tmp_path / "run.pickle").write_bytes(pickle.dumps(run))
    monkeypatch.setenv("LAGC_CACHE", str(tmp_path / "cache"))
    script = "import pickle; run = pickle.load(open('run.pickle', 'rb'))\n"
    script += "print(run['theta'].tolist(), run['E'].tolist())"
    root = Path(lagc.__file__).parents[1]
    monkeypatch.setenv("PYTHONPATH", str(root))
    done = subprocess.run([sys.executable, "-c", script], cwd=tmp_path, capture_output=True, text=True)
    assert done.stdout.strip() == f"{run['theta'].tolist()} {run['E'].tolist()}", done.stderr


def test_the_numbers_of_a_run_need_no_compiler(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    if c_compiler.compiler() is None:
        pytest.skip("there is no C compiler")
    run = lagc.load("simple_pendulum").compile(backend="c").simulate(stop=0.3, points=4)
    data = pickle.dumps(run)
    monkeypatch.setenv("LAGC_CACHE", str(tmp_path))
    monkeypatch.setattr(c_compiler, "compiler", lambda: None)
    back = pickle.loads(data)
    assert back["theta"].tolist() == run["theta"].tolist()
    with pytest.raises(c_compiler.CannotCompile):
        back["E"]


def test_auto_takes_what_is_there(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A model that ran in C goes on in Python where there is no compiler."""
    if c_compiler.compiler() is None:
        pytest.skip("there is no C compiler")
    lagc.load("simple_pendulum").compile(backend="c").simulate(stop=0.1)
    model = lagc.load("simple_pendulum").compile()
    run = model.simulate(stop=0.3, points=4)
    assert run.system.backend == model.backend == "c"
    data = pickle.dumps(model)
    assert pickle.loads(data).simulate(stop=0.3).system.backend == "c"
    monkeypatch.setenv("LAGC_CACHE", str(tmp_path))
    monkeypatch.setattr(c_compiler, "compiler", lambda: None)
    back = pickle.loads(data)
    assert back.rhs(0.0, back.start()).tolist() == model.rhs(0.0, model.start()).tolist()
    assert back.simulate(stop=0.3, points=4).states == run.states


def test_a_refusal_travels() -> None:
    text = "model M\n  coordinate Length x;\n  body b = Particle(mass = 1 [kg], at = {y, 0, 0});\nend M;\n"
    with pytest.raises(lagc.Refused) as here:
        lagc.loads(text, "m.lag").compile()
    back = pickle.loads(pickle.dumps(here.value))
    assert back.faults == here.value.faults and str(back) == str(here.value)
    assert str(back.faults[0].span) == "m.lag:3:42"
