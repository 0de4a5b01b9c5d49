"""No step passes over a smooth term that is large for a moment and negligible otherwise."""

import math
from random import Random

import pytest
from mpmath import mp, mpf, quad

import lagc
from lagc.api import Run

pytestmark = pytest.mark.usefixtures("no_cache")

MODEL = """model M
  coordinate Length x(start = {x!r} [m], rate = {v!r} [m/s], fixed = true);
  body b = Particle(mass = 1 [kg], at = {{x, 0, 0}});
  {action}
end M;"""
BELLS = ("exp(-1/2*u^2)", "1/(1 + u^2)^4", "1/cosh(u)^2", "(tanh(u + 1) - tanh(u - 1))/2", "2^(-u^2)")
AREAS = [math.sqrt(2.0 * math.pi), 5.0 * math.pi / 16.0, 2.0, 2.0]  # under them
AREAS.append(math.sqrt(math.pi / math.log(2.0)))


def run(action: str, x: float, v: float, stop: float, accuracy: float = 1e-7) -> Run:
    return lagc.loads(MODEL.format(x=x, v=v, action=action)).compile(backend="numpy").simulate(
        stop, accuracy=accuracy
    )  # fmt: skip


@pytest.mark.sample(1)
@pytest.mark.parametrize("seed", range(10))
def test_kicks(seed: int) -> None:
    """One of 1e-5 to 0.1 s somewhere in 10 s; by symmetry it moves what a blow in its middle does."""
    chance = Random(seed)
    width, at, bell = 10.0 ** chance.uniform(-5.0, -1.0), chance.uniform(2.0, 8.0), seed % 5
    force = f"1 [N.s]/({AREAS[bell] * width!r} [s])*({BELLS[bell]})".replace(
        "u", f"((time - {at!r} [s])/({width!r} [s]))"
    )
    found = run(f"force f = {{{force}, 0, 0}} at b;", 0.0, 0.0, 10.0, 1e-6)
    tails = 1e-6 if bell != 1 else 1e-6 + (width / 2.0) ** 7
    assert found.status == "ok", found.message
    assert found["der(x)"][-1] == pytest.approx(1.0, abs=2 * tails)
    assert found["x"][-1] == pytest.approx(10.0 - at, abs=2e-6 * 10.0 + 10.0 * tails)


@pytest.mark.parametrize("exponent", ["n", "-41/2"])
def test_a_kick_whose_exponent_is_a_parameter_or_no_whole_number(exponent: str) -> None:
    """Under (1 + u^2)^n is the area sqrt(pi) Gamma(-n - 1/2)/Gamma(-n)."""
    area = math.sqrt(math.pi) * math.gamma(20.0) / math.gamma(20.5)
    u = "((time - 4.3 [s])/(1e-5 [s]))"
    force = f"1 [N.s]/({area!r}*1e-5 [s])*(1 + {u}^2)^({exponent})"
    found = run(f"parameter Real n = -20.5; force f = {{{force}, 0, 0}} at b;", 0.0, 1.0, 10.0, 1e-6)
    assert found["der(x)"][-1] == pytest.approx(2.0, abs=2e-6)
    assert found["x"][-1] == pytest.approx(15.7, abs=2e-5)


@pytest.mark.sample(2)
@pytest.mark.parametrize("seed", range(8))
def test_barriers_and_wells(seed: int) -> None:
    """Of 1e-5 to 0.1 m in 10 m: higher than its energy it sends back, else it takes the time that is the
    integral of dx/v."""
    chance = Random(seed)
    width, at, bell = 10.0 ** chance.uniform(-5.0, -1.0), chance.uniform(-1.0, 1.0), seed % 2
    height = (4.0, 0.5, -3.0)[seed % 3] * 0.5  # of the energy 0.5 J
    u = f"((x - {at!r} [m])/({width!r} [m]))"
    found = run(f"potential V = {height!r} [J]*({BELLS[bell].replace('u', u)});", -5.0, 1.0, 10.0)
    assert found.status == "ok", found.message

    def speed(x: mpf) -> mpf:
        z = (x - at) / width
        return mp.sqrt(1 - 2 * height * (mp.exp(-z * z / 2), 1 / (1 + z * z) ** 4)[bell])

    if height > 0.5:
        assert found["der(x)"][-1] == pytest.approx(-1.0, abs=1e-5) and found["x"][-1] < -3.0
        return
    near = [at + k * width for k in (-100, -30, -10, -3, -1, 0, 1, 3, 10, 30, 100)]
    taken = quad(lambda x: 1 / speed(x) - 1, near)  # more than freely
    assert found["x"][-1] == pytest.approx(5.0 - float(taken), abs=2e-6)


def test_terms_of_angles() -> None:
    """exp(atan2(y, x)) on circles is exp(x1) along x1 = w t, but for last places."""
    text = """model M
  coordinate Length x(start = 1 [m]), y(rate = 0.5 [m/s]), s;
  body b = Particle(mass = 1 [kg], at = {x, y, s});
  potential V = 1/8*(1 [N/m])*(x^2 + y^2);
  force f = {0, 0, 1 [N]*exp(atan2(y, x))} at b;
end M;"""
    found = lagc.loads(text).compile(backend="numpy").simulate(6.0, accuracy=1e-8)
    assert found.status == "ok", found.message
    assert found["der(s)"][-1] == pytest.approx(2.0 * (math.exp(3.0) - 1.0), rel=1e-7)


def test_models_without_features_have_no_guards() -> None:
    """A chain of exponential springs shows all that it is at the ends of its steps."""
    from lagc.compiler.pipeline import program
    from lagc.compiler.stages import Choice
    from lagc.host.model_library import read

    assert program(read("toda_lattice"), Choice()).interface.features == 6
    assert "features" not in program(read("double_pendulum"), Choice()).functions
