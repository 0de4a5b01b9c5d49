"""The code of a run has the method that it takes, and that of evaluations in C has none."""

import pickle

import pytest

import lagc
from lagc.simulation.backends.compile import compiler
from lagc.simulation.system import OK, Options
from tests.simulation.scaled import system as with_all_methods

pytestmark = pytest.mark.usefixtures("own_cache")
needs_c = pytest.mark.skipif(compiler() is None, reason="no C compiler")
PENDULUM = """model P
  coordinate Angle theta(start = 60 [deg]);
  body bob = Particle(mass = 1 [kg], at = 1 [m]*{sin(theta), 0, -cos(theta)});
  Gravity field(g = 9.81 [m/s2], direction = {0, 0, -1});
end P;
"""
ASKED = [Options(), Options("rk4", step=0.01), Options("dopri5", rtol=1e-6), Options("bs32", rtol=1e-4)]


def test_the_code_has_the_default_method() -> None:
    model = lagc.loads(PENDULUM).compile(backend="numpy")
    (text,) = model.artifact.sources.values()
    assert model.interface.methods == ("dop853",)
    assert "dop853_stages" in text and not [m for m in ("dopri5", "rk4", "bs32") if m in text]


@pytest.mark.parametrize("options", ASKED, ids=lambda options: options.method)
def test_other_methods_have_the_same_bits(options: Options) -> None:
    """As in code that has all of them, also after a way through a pickle."""
    model = lagc.loads(PENDULUM).compile(backend="numpy")
    own, all_ = model.load("numpy"), with_all_methods(model.program, "numpy")
    x = own.start()
    runs = [s.integrate(options, 0.0, x, [0.3, 1.0]) for s in (own, all_, pickle.loads(pickle.dumps(own)))]
    assert runs[0].status == OK and runs[0].t == 1.0
    assert runs[0].states == runs[1].states == runs[2].states


def test_runs_share_the_code_of_a_method() -> None:
    model = lagc.loads(PENDULUM).compile(backend="numpy")
    runs = [model.simulate(1.0, method=m, rtol=1e-6) for m in ("dopri5", "dop853", "dopri5")]
    codes = [run.system.model for run in runs]  # type: ignore[attr-defined]
    assert codes[0] is codes[2] and codes[1] is model.load("numpy").model  # type: ignore[attr-defined]
    assert codes[0].interface.methods == ("dopri5",)


@needs_c
def test_an_evaluation_in_c_compiles_no_integrator() -> None:
    model = lagc.loads(PENDULUM).compile(backend="c")
    other = lagc.loads(PENDULUM).compile(backend="numpy")
    assert list(model.rhs(0.0, [0.3, 2.0])) == list(other.rhs(0.0, [0.3, 2.0]))
    assert "record" not in model.system.model.functions  # type: ignore[attr-defined]


EVALUATED = [
    "course/simple_pendulum", "contact/bouncing_ball", "classic/four_bar", "classic/heavy_top_quaternion",
    "classic/on_off_drive", "classic/chaplygin_sleigh", "classic/sampled_pd",
]  # fmt: skip


@needs_c
@pytest.mark.full
@pytest.mark.parametrize("name", EVALUATED)
def test_evaluations_have_the_bits_of_runs(name: str) -> None:
    """All functions, a run of the system without an integrator, and the way through a pickle."""
    model = lagc.load(name).compile(backend="c")
    lean = model.system
    assert not lean.compiled.integrates  # type: ignore[attr-defined]
    full, x = model.load("c"), [*model.start(), *[0.0] * lean.nz]
    x += lean.start()[len(x) :]
    for system in (lean, pickle.loads(pickle.dumps(lean)), lean.on(0.0, x)):
        for function in ("accelerations", "position", "velocity", "scales", "energies", "gaps", "outputs",
                         "conditions", *(["assemble"] if full.nc else [])):  # fmt: skip
            assert getattr(system, function)(0.0, x) == getattr(full, function)(0.0, x), function
        assert system.start() == full.start() and system.measures() == full.measures()
        assert system.limits() == full.limits()
        assert not full.interface.contacts or system.seated(0.0, x) == full.seated(0.0, x)
        right = [0.5 + k for k in range(full.nv + full.nc)]
        assert full.nc == 0 or system.solve(right) == full.solve(right)
        runs = [s.integrate(Options(), 0.0, x, [0.05, 0.1]) for s in (system, full)]
        assert runs[0].states == runs[1].states and runs[0].rhs == runs[1].rhs
    assert model.system is full
