"""The code of a run has the method that it takes; other methods are compiled when a run asks for them."""

import pickle

import pytest

import lagc
from lagc.simulation.system import OK, Options
from tests.simulation.scaled import system as with_all_methods

pytestmark = pytest.mark.usefixtures("own_cache")
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
