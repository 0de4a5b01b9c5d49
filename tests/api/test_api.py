"""The Python interface."""

import functools
import json
import math
import pickle
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy
import pytest

import lagc
from lagc.simulation.backends import compile as c_compiler
from lagc.simulation.formats import CannotSave
from lagc.simulation.initialization.initialize import consistent_start
from lagc.simulation.initialization.result import Start
from lagc.simulation.request import Request
from lagc.simulation.supervision import CompileTimer, SlowRun, compile_time
from lagc.simulation.system import System

pytestmark = pytest.mark.usefixtures("own_cache")
needs_c = pytest.mark.skipif(c_compiler.compiler() is None, reason="no C compiler")


@pytest.fixture(scope="module")
def pendulum() -> lagc.CompiledModel:
    return lagc.load("simple_pendulum").compile(scene="vacuum", backend="numpy")


def test_a_run_is_arrays_by_name(pendulum: lagc.CompiledModel) -> None:
    run = pendulum.simulate(stop=2, accuracy=1e-8, parameters={"l": 0.7}, points=21)
    assert run.status == "ok"
    assert run.t.shape == run["theta"].shape == run["der(theta)"].shape == run["E"].shape == (21,)
    assert run.x.shape == (21, pendulum.interface.nx)
    assert run["theta"][0] == math.radians(60)
    assert run.units["theta"] == "rad" and run.units["E"] == "J"
    assert "theta" in run and "phi" not in run


def test_an_unknown_name_is_answered_with_the_near_one(pendulum: lagc.CompiledModel) -> None:
    run = pendulum.simulate(stop=0.1)
    with pytest.raises(KeyError, match="did you mean `theta`"):
        run["thet"]


def test_parameters_change_without_compiling_again(pendulum: lagc.CompiledModel) -> None:
    system = pendulum.system
    a = pendulum.simulate(stop=1, parameters={"l": 0.25})
    b = pendulum.simulate(stop=1, parameters={"l": (25, "cm")})
    assert a["theta"].tolist() == b["theta"].tolist()
    assert pendulum.simulate(stop=1)["theta"][-1] != a["theta"][-1]
    assert pendulum.system is system
    # columns are computed with the parameters of their own run, whatever came after
    assert a["E"][0] == pytest.approx(-9.81 * 0.25 * 0.5)


def test_the_right_hand_side_serves_other_integrators(pendulum: lagc.CompiledModel) -> None:
    integrate = pytest.importorskip("scipy.integrate")
    x0 = pendulum.start()
    assert x0.tolist() == [math.radians(60), 0.0]
    found = integrate.solve_ivp(pendulum.rhs, (0.0, 2.0), x0, rtol=1e-10, atol=1e-10)
    run = pendulum.simulate(stop=2.0, accuracy=1e-9)
    assert found.y[0, -1] == pytest.approx(run["theta"][-1], abs=1e-8)
    with pytest.raises(ValueError, match="3 entries"):
        pendulum.rhs(0.0, [1.0, 2.0, 3.0])


WORK = """model W
  coordinate Length x(rate = 1);
  body b = Particle(mass = 1, at = {x, 0, 0});
  force f = -1 [N.s/m]*velocity(b) at b;
end W;
"""


def test_a_state_has_no_work() -> None:
    """The integral of the work is one of the columns of a run, but none of the state."""
    system = lagc.loads(WORK).compile(backend="numpy")
    run = system.simulate(stop=1.0, points=2)
    assert run.x.shape == (2, 3) and system.rhs(0.0, run.x[0, :2]).tolist() == [1.0, -1.0]
    with pytest.raises(ValueError, match=r"x has 3 entries, not 2: x, der\(x\)"):
        system.rhs(0.0, run.x[0])


def test_a_refusal_shows_the_place_and_the_remedy() -> None:
    text = WORK.replace("-1 [N.s/m]*velocity(b)", "-c*velocity(b)").replace("Length x", "Lenght x")
    with pytest.raises(lagc.Refused) as refused:
        lagc.loads(text, "work.lag").compile()
    assert str(refused.value) == (
        "LAG0203: there is no type `Lenght`\n"
        "  --> work.lag:2:14\n"
        "   |\n"
        " 2 |   coordinate Lenght x(rate = 1);\n"
        "   |              ^^^^^^\n"
        "   = help: did you mean `Length`?\n"
        "\n"
        "LAG0201: `c` is not declared\n"
        "  --> work.lag:4:14\n"
        "   |\n"
        " 4 |   force f = -c*velocity(b) at b;\n"
        "   |              ^\n"
        "   = help: declare it, `parameter Damping c = 1 [N.s/m];`"
    )
    first, second = refused.value.faults
    found = refused.value
    assert (found.code, found.file, found.line, found.column) == ("LAG0203", "work.lag", 2, 14)
    assert found.remedy == first.remedy == "did you mean `Length`?"
    assert (second.code, second.file, second.line, second.column) == ("LAG0201", "work.lag", 4, 14)
    assert str(pickle.loads(pickle.dumps(found))) == str(found)
    with pytest.raises(lagc.Refused) as refused:
        lagc.loads(WORK).compile().simulate(1.0, starts={"X": 1.0})
    assert (refused.value.file, refused.value.line, refused.value.column) == (None, None, None)
    assert str(refused.value) == "LAG0606: there is no coordinate or speed `X`\n  = help: did you mean `x`?"


def test_wrong_values_are_refused(pendulum: lagc.CompiledModel) -> None:
    for given in ({"L": 1.0}, {"l": -1.0}, {"l": math.nan}, {"l": (1.0, "kg")}):
        with pytest.raises(lagc.Refused):
            pendulum.simulate(stop=1, parameters=given)
    with pytest.raises(lagc.Refused):
        pendulum.simulate(stop=(1.0, "m"))
    with pytest.raises(lagc.Refused):
        pendulum.simulate(stop=1, starts={"phi": 1.0})
    with pytest.raises(ValueError, match="backend"):
        lagc.load("simple_pendulum").compile(backend="fortran")


@pytest.mark.parametrize("backend", ["numpy", pytest.param("c", marks=needs_c)])
def test_numbers_of_every_kind_are_those_that_they_are(backend: str) -> None:
    """Also where the accuracy of the same run is known by then."""
    numpy = pytest.importorskip("numpy")
    pendulum = lagc.load("simple_pendulum").compile(backend=backend)
    given = {"points": numpy.int64(5), "accuracy": numpy.float32(2.0**-20), "stop": numpy.float64(0.5)}
    plain = pendulum.simulate(0.5, points=5, accuracy=2.0**-20)
    own = numpy.array(pendulum.system.parameters)
    for _ in range(2):
        run = pendulum.simulate(**given)
        assert run.x.tolist() == plain.x.tolist()
        assert json.loads(json.dumps(run.to_dict()))["accuracy"] == {
            "asked": 2.0**-20, "estimated": run.estimated
        }  # fmt: skip
        request = Request(stop=numpy.float64(0.5), points=numpy.int32(5), accuracy=Fraction(1, 2**20))
        assert pendulum.run(request, own).x.tolist() == plain.x.tolist()


@pytest.mark.parametrize(
    "given", [{"points": 3.5}, {"points": "5"}, {"accuracy": "1e-6"}, {"rtol": (1e-6, "1")}, {"atol": 1j},
              {"accuracy": 10**400}],
)  # fmt: skip
def test_what_is_no_number_is_refused(pendulum: lagc.CompiledModel, given: dict[str, Any]) -> None:
    with pytest.raises(lagc.Refused, match=f"LAG0604: `{next(iter(given))}` must be a"):
        pendulum.simulate(1.0, **given)


def test_arrays_of_another_length_are_refused(pendulum: lagc.CompiledModel) -> None:
    for x in ([], [1.0], [1.0, 2.0, 3.0]):
        rates = functools.partial(pendulum.jacobian, "rates", "state")
        for call in (pendulum.linearize, pendulum.rhs, rates):
            with pytest.raises(ValueError, match=f"x has {len(x)} entries, not 2"):
                call(0.0, x)
    for shape in ((2, 2), (1, 2), ()):
        with pytest.raises(ValueError, match=r"x has the shape .*, not \(2,\)"):
            pendulum.rhs(0.0, numpy.zeros(shape))
    for wrong in (1.0, "theta", None):
        with pytest.raises(TypeError, match="x must be a sequence of 2 numbers"):
            pendulum.rhs(0.0, wrong)  # type: ignore[arg-type]
    string = lagc.load("string_pendulum").compile(backend="numpy")
    for name, wanted in (("a", 2), ("lam", 1)):
        for given in ([], [1.0] * (wanted + 1)):
            with pytest.raises(ValueError, match=f"{name} has {len(given)} entries, not {wanted}"):
                string.jacobian("forces", "state", 0.0, [0.3, -0.4, 0.0, 0.0], **{name: given})


def test_starts_have_units_and_names_may_be_one(pendulum: lagc.CompiledModel) -> None:
    assert pendulum.start(theta=(30, "deg"))[0] == pytest.approx(math.pi / 6.0, rel=1e-15)
    assert pendulum.start(**{"der(theta)": (60, "rpm")})[1] == pytest.approx(2.0 * math.pi, rel=1e-15)
    model = lagc.load("simple_pendulum")
    assert model.compile(use="air").interface.effects == model.compile(use=["air"]).interface.effects
    assert "gravity" not in model.compile(without="gravity").interface.effects


def test_half_a_motion_has_no_linear_model(pendulum: lagc.CompiledModel) -> None:
    with pytest.raises(lagc.Refused, match="LAG0801: the run took longer"), lagc.Limits(time=3600.0) as block:
        pendulum.linearize(
            1e9, progress=lambda t: setattr(block, "end", 0.0)
        )  # the time is up within the run

    def interrupted(t: float) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        pendulum.linearize(100.0, progress=interrupted)


def test_a_text_is_a_model_too() -> None:
    text = (
        "model Spring\n  parameter Mass m = 2 [kg];\n  coordinate Length x(start = 1 [m]);\n"
        "  body b = Particle(mass = m, at = {x, 0, 0});\n  potential V = 4 [N/m]*x^2;\nend Spring;\n"
    )
    run = lagc.loads(text).compile(backend="numpy").simulate(stop=math.pi, accuracy=1e-9)
    assert run["x"][-1] == pytest.approx(1.0, abs=1e-9)  # x'' = -4 x
    with pytest.raises(lagc.Refused) as refused:
        lagc.loads(text.replace("*x^2", "*y^2"), "spring.lag").compile()
    assert "spring.lag:5" in str(refused.value.faults[0].span)
    assert lagc.loads(text).check() == []


def test_structural_integers_are_built_in() -> None:
    chain = lagc.load("classic/chain")
    two = chain.compile(parameters={"n": 2}, backend="numpy")
    three = chain.compile(parameters={"n": 3}, backend="numpy")
    assert (two.interface.nq, three.interface.nq) == (2, 3)
    again = chain.compile(parameters={"n": 2}, backend="numpy")
    assert again.interface == two.interface


@pytest.mark.sample(1)
@pytest.mark.parametrize("kept", [False, True])
def test_all_of_a_compiled_model_is_of_the_same_files(
    kept: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also where what was compiled first came out of the cache."""
    part = "partial model P parameter Stiffness k = {} [N/m]; coordinate Length x(start = 1);\
            body b = Particle(mass = 1, at = {{x, 0, 0}}); potential v = 1/2*k*x^2; end P;"
    (tmp_path / "m.lag").write_text('import "p.lag"; model M extends P; end M;')

    def compiled(k: float, text: str = part) -> lagc.CompiledModel:
        (tmp_path / "p.lag").write_text(text.format(k))
        return lagc.load(str(tmp_path / "m.lag")).compile(backend="numpy")

    if kept:
        compiled(1.0)
    model = pickle.loads(pickle.dumps(compiled(1.0)))
    newer = compiled(4.0)
    with pytest.raises(lagc.Refused, match=r"LAG0705: .*p\.lag` has changed since"):
        model.linearize()
    assert model.simulate(math.pi)["x"][-1] == pytest.approx(-1.0, rel=1e-6)
    assert newer.linearize().A[1][0] == -4.0
    compiled(1.0)
    assert model.linearize().A[1][0] == -1.0


def test_what_is_built_in_belongs_to_no_run() -> None:
    chain = lagc.load("classic/chain").compile(parameters={"n": 2}, backend="numpy")
    derived = lagc.loads(
        "model M\n  parameter Mass m = 2 [kg], twice = 2*m, idle = 1 [kg];\n"
        "  coordinate Length x(start = 1);\n"
        "  body b = Particle(mass = twice, at = {x, 0, 0});\n  potential V = 1 [N/m]*x^2;\nend M;\n"
    ).compile(backend="numpy")
    for model, name in ((chain, "n"), (derived, "twice")):
        for ask in (
            lambda given, model=model: model.bind(given),
            lambda given, model=model: model.simulate(stop=0.1, parameters=given),
            lambda given, model=model: model.start(given),
        ):
            with pytest.raises(lagc.Refused) as refused:
                ask({name: 5})
            assert [f.code for f in refused.value.faults] == ["LAG0607"]
    assert chain.bind({"n": 2}).interface.nq == 2  # as it is
    assert derived.bind({"idle": 3.0, "m": 4.0}).rhs(0.0, [1.0, 0.0])[1] == -2.0 / 8.0


@pytest.mark.full
def test_a_data_frame(pendulum: lagc.CompiledModel) -> None:
    pytest.importorskip("pandas")
    frame = pendulum.simulate(stop=1, points=5).to_pandas()
    assert list(frame.columns) == ["theta", "der(theta)", "E"] and len(frame) == 5
    assert frame.attrs["units"]["theta"] == "rad"


def test_a_file_that_cannot_be_written_says_why(pendulum: lagc.CompiledModel, tmp_path: Path) -> None:
    run = pendulum.simulate(stop=0.1)
    for name in ("x.h5", "x.mat", "x", "no/such/x.csv"):
        with pytest.raises(CannotSave):
            run.save(str(tmp_path / name))
    with pytest.raises(CannotSave) as refused:
        run.save(str(tmp_path / "\x1b[2J" / "x.csv"))
    assert str(refused.value).isprintable()


@pytest.mark.full
def test_a_notebook_shows_equations_and_plots(pendulum: lagc.CompiledModel) -> None:
    shown = pendulum._repr_latex_()
    assert "theta" in shown and shown.startswith("$$") and shown.endswith("$$")
    assert lagc.load("simple_pendulum")._repr_latex_() == shown
    long = (
        lagc.load("chain").compile(parameters={"n": 9})._repr_latex_()
    )  # browsers hang on some 100,000 characters
    assert long == "9 equations; `lagc equations` prints them"
    pytest.importorskip("matplotlib")
    assert "<" in pendulum.simulate(stop=1)._repr_html_()


@needs_c
def test_auto_begins_in_numpy_and_changes_to_c_where_a_run_is_long(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(c_compiler, "cached_library", lambda sources: False)
    monkeypatch.setattr("lagc.simulation.supervision.compile_time", lambda interface: 600.0)
    short = lagc.load("simple_pendulum").compile(scene="room")
    assert short.simulate(stop=1).system.backend == "numpy"
    monkeypatch.setattr("lagc.simulation.supervision.compile_time", lambda interface: 0.05)
    long = lagc.load("double_pendulum").compile()
    run = long.simulate(stop=50, rtol=1e-12)
    assert run.status == "ok" and run.system.backend == "c"


@needs_c
def test_auto_takes_c_for_a_second_run_if_fifty_such_runs_pay_for_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(c_compiler, "cached_library", lambda sources: False)
    for seconds, backend in ((1e-3, "c"), (600.0, "numpy")):
        monkeypatch.setattr("lagc.simulation.supervision.compile_time", lambda interface, s=seconds: s)
        monkeypatch.setattr("lagc.simulation.supervision.CompileTimer", lambda limit, inner: inner)
        model = lagc.load("simple_pendulum").compile(scene="room")
        runs = [model.simulate(stop=1, parameters={"l": l}) for l in (0.5, 0.5, 0.7)]  # noqa: E741
        assert [run.system.backend for run in runs] == ["numpy", backend, backend]
        assert runs[1].states == runs[0].states and runs[2].status == "ok"


@needs_c
def test_auto_goes_on_in_numpy_if_a_second_run_cannot_be_compiled(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(
        c_compiler, "library", lambda sources: c_compiler.build_library({"x.c": "int main( {"})
    )
    monkeypatch.setattr("lagc.simulation.backends.c.library", c_compiler.library)
    monkeypatch.setattr(c_compiler, "cached_library", lambda sources: False)
    monkeypatch.setattr("lagc.simulation.supervision.compile_time", lambda interface: 0.01)
    model = lagc.load("simple_pendulum").compile(scene="room")
    runs = [model.simulate(stop=1) for _ in range(3)]
    assert [run.system.backend for run in runs] == ["numpy"] * 3
    assert "error" in runs[1].backend_reason and runs[2].status == "ok"


@needs_c
def test_a_run_that_changes_to_c_seeks_its_start_once_and_tells_all_of_its_time(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    sought: list[System] = []

    def noted(system: System, *given: Any) -> Start:
        sought.append(system)
        return consistent_start(system, *given)

    monkeypatch.setattr("lagc.simulation.initialization.initialize.consistent_start", noted)
    monkeypatch.setattr(c_compiler, "cached_library", lambda sources: False)
    monkeypatch.setattr("lagc.simulation.supervision.compile_time", lambda interface: 0.05)
    run = lagc.load("double_pendulum").compile().simulate(stop=50, rtol=1e-12)
    assert run.system.backend == "c" and [system.backend for system in sought] == ["numpy"]
    assert run.cost.start_s > 0.0 and run.cost.run_s > 0.05 + run.cost.start_s


@pytest.mark.full
def test_what_compiling_takes_is_guessed_from_the_text_not_from_how_often_it_is_gone_through() -> None:
    """The text of a chain does not grow with it."""
    few, many = (lagc.load("chain").compile(parameters={"n": n}, backend="numpy") for n in (50, 200))
    assert many.operations > 3.9 * few.operations
    assert compile_time(many.interface) < 1.1 * compile_time(few.interface)


@pytest.mark.full
def test_auto_without_a_compiler_is_numpy(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("LAGC_CACHE", str(tmp_path))
    monkeypatch.setattr(c_compiler, "compiler", lambda: None)
    model = lagc.load("simple_pendulum").compile()
    assert model.simulate(stop=1).system.backend == "numpy"
    with pytest.raises(c_compiler.CannotCompile, match="no C compiler"):
        lagc.load("simple_pendulum").compile(backend="c").simulate(stop=1)


@needs_c
def test_patience_ends() -> None:
    with pytest.raises(SlowRun):
        CompileTimer(-1.0, None)(0.0)


@needs_c
def test_a_compiler_that_fails_is_quoted(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("LAGC_CACHE", str(tmp_path))
    with pytest.raises(c_compiler.CannotCompile, match="error"):
        c_compiler.build_library({"x.c": "int main( {"})


@pytest.mark.full
@needs_c
def test_concurrent_runs_share_a_library(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    import subprocess
    import sys

    monkeypatch.setenv("LAGC_CACHE", str(tmp_path))
    command = [sys.executable, "-m", "lagc", "sim", "simple_pendulum", "--backend", "c", "-q", "--stop", "1"]
    running = [subprocess.Popen(command, stdout=subprocess.PIPE, text=True) for _ in range(3)]
    answers = [p.communicate(timeout=120)[0] for p in running]
    assert all(p.returncode == 0 for p in running) and len(set(answers)) == 1
    assert not list(tmp_path.rglob("*.tmp"))


@pytest.mark.full
def test_what_a_console_shows_is_one_line() -> None:
    pendulum = lagc.load("simple_pendulum")
    system = pendulum.compile(backend="numpy")
    run = system.simulate(stop=1, points=4000)
    assert repr(system) == "<CompiledModel of SimplePendulum, scene vacuum>"
    assert repr(run).startswith("<Run of SimplePendulum, scene vacuum: ok, 4000 points to t = 1 s, estimated")
    (rest,) = system.equilibria(tries=0)
    nouns = (system.model, system.equations, rest)
    for shown in (pendulum, run, run.accuracy, run.energy, run.cost, *nouns):
        assert len(repr(shown)) < 200 and "\n" not in repr(shown)
