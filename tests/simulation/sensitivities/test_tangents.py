"""The kernels of sensitivities: C and Python agree, and both with independent integrations."""

from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import least_squares

import lagc
from lagc.api import Run
from lagc.simulation.sensitivity.followers import InPython

pytestmark = pytest.mark.usefixtures("own_cache")

PENDULUM = """model Pendulum
  parameter Length l = 0.7 [m]; parameter Mass m = 2 [kg]; parameter Real[N.m.s] c = 0.3;
  coordinate Angle theta(start = 1.2, rate = 0.4);
  body bob = Particle(mass = m, at = {l*sin(theta), 0, -l*cos(theta)});
  dissipation air = 1/2*c*der(theta)^2;
  Gravity field(g = 9.81 [m/s2], direction = {0, 0, -1});
end Pendulum;"""
ASKED = ["l", "m", "c", "start(theta)", "start(der(theta))"]
MODELS = {
    "pendulum": (PENDULUM, ASKED),
    "rod": ("""model Rod
      parameter Length l = 0.5 [m]; parameter Mass m = 2 [kg]; parameter Force f = 3 [N];
      coordinate Length x(start = 0.3), z(start = -0.4);
      body b = Particle(mass = m, at = {x, 0, z});
      force w = {f, 0, -9.81 [m/s2]*m} at b;
      constraint rod: x^2 + z^2 = l^2;
    end Rod;""", ["m", "f", "start(x)"]),
    "bounce": ("""model Bounce
      parameter Real e = 0.8; parameter Length ground = 0.1 [m];
      coordinate Length y(start = 1.1 [m]);
      body b = Particle(mass = 1 [kg], at = {0, y, 0});
      force w = {0, -10 [N], 0} at b;
      when y < ground then
        reinit(der(y), -e*der(y));
      end when;
    end Bounce;""", ["e", "ground", "start(y)"]),
}  # fmt: skip


def run(name: str, backend: str, stop: float = 0.9, **given: Any) -> Run:
    text, asked = MODELS[name]
    found = lagc.loads(text).compile(backend=backend).simulate(stop, points=7, sensitivity=asked, **given)
    assert found.status == "ok", found.message
    return found


@pytest.mark.full
@pytest.mark.parametrize("name", MODELS)
@pytest.mark.parametrize("given", [{}, {"accuracy": 1e-9}, {"method": "rk4", "step": 0.01},
                                   {"method": "dopri5", "rtol": 1e-7}], ids=str)  # fmt: skip
def test_c_and_python_have_the_same_bits(name: str, given: dict[str, Any]) -> None:
    one, two = (run(name, backend, **given) for backend in ("c", "numpy"))
    assert one.sensitivities is not None and two.sensitivities is not None
    assert np.array_equal(one.sensitivities.values, two.sensitivities.values)
    assert one.sensitivities.estimated == two.sensitivities.estimated
    assert one.sensitivities.steps == two.sensitivities.steps


@pytest.mark.full
def test_against_variations_by_scipy() -> None:
    """theta'' = -g/l sin(theta) - c/(m l^2) theta', differentiated by hand."""
    g, l, m, c = 9.81, 0.7, 2.0, 0.3  # noqa: E741

    def rates(_: float, y: Any) -> Any:
        q, v = y[:2]
        s, r = y[2:7], y[7:]
        d = c / (m * l * l)
        own = [g / l**2 * np.sin(q) + 2 * d / l * v, d / m * v, -d / c * v, 0.0, 0.0]
        return [v, -g / l * np.sin(q) - d * v, *r, *(-g / l * np.cos(q) * s - d * r + own)]

    begin = [1.2, 0.4, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1]
    exact = solve_ivp(rates, (0.0, 3.0), begin, "DOP853", rtol=1e-12, atol=1e-13).y[2:, -1]
    found = run("pendulum", "c", 3.0, accuracy=1e-9).sensitivities
    assert found is not None
    assert found.values[-1] == pytest.approx(exact.reshape(2, 5), rel=1e-8, abs=1e-9)


def test_nothing_that_a_rejected_step_shows_is_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    """A run that begins with a step that is far too long for S ends with the errors of one that does not."""
    model = lagc.loads(PENDULUM).compile(backend="numpy")
    plain = model.simulate(1.0, rtol=1e-8, points=2, sensitivity=ASKED).sensitivities
    begin = InPython.follow
    begun: list[InPython] = []

    def hasty(self: InPython, budget: int) -> int:
        if self not in begun:
            begun.append(self)
            self.s.options.first_step = 0.6
        return begin(self, budget)

    monkeypatch.setattr(InPython, "follow", hasty)
    far = model.simulate(1.0, rtol=1e-8, points=2, sensitivity=ASKED).sensitivities
    fine = model.simulate(1.0, accuracy=1e-10, points=2, sensitivity=ASKED).sensitivities
    assert plain is not None and far is not None and fine is not None and far.rejected + far.steps > 0
    sizes = np.abs(fine.values[-1]).max(axis=1, keepdims=True)
    assert (np.abs(far.values[-1] - fine.values[-1]) < 1e-6 * sizes).all()


def test_a_motion_that_does_not_depend_on_a_mass() -> None:
    model = lagc.load("simple_pendulum").compile("vacuum", backend="numpy")
    found = model.simulate(1.0, points=5, sensitivity="m")
    assert found.status == "ok" and not found.sensitivity("theta", "m").any()


@pytest.mark.full
def test_a_fit_of_two_parameters() -> None:
    model = lagc.loads(PENDULUM).compile()
    given = {"l": 0.62, "c": 0.2}
    measured = model.simulate(1.0, points=21, parameters=given)["theta"]
    runs = list[Any]()

    def at(guess: Any) -> Run:
        values = dict(zip(given, map(float, guess)))
        runs.append(model.simulate(1.0, points=21, parameters=values, sensitivity=list(given)))
        return runs[-1]

    fit = least_squares(
        lambda guess: at(guess)["theta"] - measured, [0.5, 0.5],
        lambda guess: np.column_stack([at(guess).sensitivity("theta", name) for name in given]),
    )  # fmt: skip
    assert fit.x == pytest.approx([0.62, 0.2], rel=1e-6)
    assert {type(run.status) for run in runs} == {str} and {run.status for run in runs} == {"ok"}
