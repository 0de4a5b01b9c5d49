"""No step passes over an encounter, a barrier or a wall, where a divisor comes near zero."""

from math import atan, cos, cosh, hypot, sin, sinh, sqrt
from typing import Any

import pytest
from mpmath import mp, mpf, quad
from scipy.special import sici

import lagc
from lagc.api import Run

pytestmark = pytest.mark.usefixtures("no_cache")

LINE = """model M
  coordinate Length x(start = 1 [m], rate = {v!r} [m/s]);
  body b = Particle(mass = 1 [kg], at = {{x, 0, 0}});
  {action}
end M;"""


def run(text: str, stop: float, accuracy: float, backend: str = "numpy") -> Run:
    found = lagc.loads(text).compile(backend=backend).simulate(stop, accuracy=accuracy, points=21)
    assert found.status == "ok", found.message
    return found


@pytest.mark.sample(1)
@pytest.mark.parametrize("backend", ["numpy", "c"])
@pytest.mark.parametrize("accuracy", [1e-3, 1e-4, 1e-6])
@pytest.mark.parametrize("near", [1e-3, 1e-5, 1e-7])
def test_encounters(near: float, accuracy: float, backend: str) -> None:
    """Kepler's hyperbola a (e - cosh F), b sinh F past a centre that turns the speed of 1 m/s by much within
    `near` of the 4 m before and behind: the end mirrors the start."""
    a, e = near, 2.0  # GM = a v^2
    b = a * sqrt(e * e - 1.0)
    far = mp.findroot(lambda f: a * (e * mp.cosh(f) - 1) - 4, mp.acosh(4 / (a * e)))
    f = float(far)
    half, r = a * (e * sinh(f) - f), a * (e * cosh(f) - 1.0)
    x, y = a * (e - cosh(f)), -b * sinh(f)
    vx, vy = a * sinh(f) / r, b * cosh(f) / r
    found = run(
        f"""model Encounter
  parameter Real[m3/s2] GM = {a!r};
  coordinate Length x(start = {x!r}, rate = {vx!r}), y(start = {y!r}, rate = {vy!r});
  body b = Particle(mass = 1, at = {{x, y, 0}});
  potential V = -1 [kg]*GM/norm(position(b));
end Encounter;""",
        2.0 * half,
        accuracy,
        backend,
    )
    assert found["der(x)"][-1] == pytest.approx(-vx, abs=3 * accuracy)
    assert found["der(y)"][-1] == pytest.approx(vy, abs=3 * accuracy)
    assert hypot(found["x"][-1] - x, found["y"][-1] + y) <= 3 * accuracy * 4.0


@pytest.mark.sample(3, 12)
@pytest.mark.parametrize("accuracy", [1e-3, 1e-4, 1e-6, 1e-8])
@pytest.mark.parametrize("size", [1e-2, 1e-4, 1e-6])
@pytest.mark.parametrize("cut", [False, True])
def test_hard_cores(cut: bool, size: float, accuracy: float) -> None:
    """(s/x)^12, whole or cut off, sends back: until then and from then on the way is the integral of v dt."""
    force = f"120 [J]/x*({size!r} [m]/x)^12"
    force = f"if x < 3*({size!r} [m]) then {force} else 0" if cut else force
    found = run(LINE.format(v=-1.0, action=f"force f = {{{force}, 0, 0}} at b;"), 2.0, accuracy)
    s, energy = mpf(size), mpf("0.5") + (mpf(10) / 3**12 if cut else 10 * mpf(size) ** 12)
    turn = s * (10 / energy) ** (mpf(1) / 12)

    def late(w: mpf) -> mpf:
        """dx (1/v - 1), by the root of what x is beyond `turn`."""
        return 2 * w * (1 / mp.sqrt(2 * energy * -mp.expm1(-12 * mp.log1p(w * w / turn))) - 1)

    ends = [2 * s, 3 * s] if cut else [2 * s, 10 * s, mpf(1)]
    behind = 2 * quad(late, [0, *(mp.sqrt(x - turn) for x in ends)]) - 2 * turn
    assert found["der(x)"][-1] == pytest.approx(1.0, abs=3 * accuracy)
    assert found["x"][-1] == pytest.approx(float(1 - behind), abs=3 * accuracy)


@pytest.mark.sample(2)
@pytest.mark.parametrize(
    ("exponent", "declared"), [("n", -13.0), ("n - 1/2", -12.0), ("-12.5", 0.0), ("-13", 0.0)]
)
def test_exponents_that_are_parameters(exponent: str, declared: float) -> None:
    """The core F (x/s)^n sends back, however its exponent is written: what comes in goes out."""
    action = f"parameter Real n = {declared!r}; force f = {{1e5 [N]*(x/(1e-5 [m]))^({exponent}), 0, 0}} at b;"
    found = run(LINE.format(v=-1.0, action=action), 3.0, 1e-6)
    n = declared - 0.5 if "1/2" in exponent else declared or float(exponent)
    assert found["der(x)"][-1] == pytest.approx(1.0, abs=3e-6)
    turn = 1e-5 * (-0.5 * (n + 1.0)) ** (1.0 / (n + 1.0))  # F s = 1 J

    def late(w: mpf) -> mpf:
        return 2 * w * (1 / mp.sqrt(-mp.expm1((n + 1) * mp.log1p(w * w / turn))) - 1)

    behind = 2 * quad(late, [0, *(mp.sqrt(x - turn) for x in (2e-5, 1e-4, mpf(1)))]) - 2 * turn
    assert found["x"][-1] == pytest.approx(float(2 - behind), abs=1e-6)


def test_exponents_above_zero_divide_by_nothing() -> None:
    """A contact whose exponent is a parameter costs what it does with a number."""
    contact = "force f = {{1e3 [N]*(max(0, -x)/(1 [m]))^{n}, 0, 0}} at b; parameter Real n = 1.5;"
    costs = [run(LINE.format(v=-1.0, action=contact.format(n=n)), 3.0, 1e-6).cost.rhs for n in ("n", "1.5")]
    assert costs[0] == pytest.approx(costs[1], rel=0.05)


@pytest.mark.sample(2)
@pytest.mark.parametrize("strength", [1e-4, 1e-8, 1e-12])
@pytest.mark.parametrize("accuracy", [1e-3, 1e-6])
def test_centrifugal_barriers(strength: float, accuracy: float) -> None:
    """c/x^2: x^2 is x0^2 + 2 x0 v0 t + 2 E t^2."""
    found = run(LINE.format(v=-1.0, action=f"potential V = {strength!r} [J.m2]/x^2;"), 2.3, accuracy)
    energy = 0.5 + strength
    assert found["x"][-1] == pytest.approx(sqrt(1.0 - 4.6 + 2.0 * energy * 2.3**2), abs=3 * accuracy)


def test_poles_of_functions() -> None:
    """A spike of tan(a)^2 at a quarter turn sends back as a wall does."""
    text = """model M
  coordinate Angle a(start = 1, rate = 3);
  kinetic K = 1/2*1 [kg.m2]*der(a)^2;
  potential V = 1e-9 [J]*tan(a)^2;
end M;"""
    found = run(text, 0.5, 1e-6)
    energy, c = 4.5 + 1e-9 * (sin(1.0) / cos(1.0)) ** 2, 1e-9
    # sin(a) = A sin(w t + phase), with w = sqrt(2 (E + c)), A^2 = E/(E + c)
    w, most = sqrt(2.0 * (energy + c)), sqrt(energy / (energy + c))
    phase = atan(sin(1.0) / sqrt(most**2 - sin(1.0) ** 2))
    assert sin(found["a"][-1]) == pytest.approx(most * sin(w * 0.5 + phase), abs=1e-5)
    assert found["a"].max() < 1.5708 and found["der(a)"][-1] < 0.0


def test_quotients_that_have_a_value_there() -> None:
    """sin(x)/x is passed many times: V = 3/2 x^2 + 0.8 x - Si(x) keeps the energy."""
    action = "force f = {1 [N]*(sin(x/(1 [m]))/(x/(1 [m])) - 0.8) - 3 [N/m]*x, 0, 0} at b;"
    found = run(LINE.format(v=0.0, action=action), 30.0, 1e-7)
    energy = [0.5 * v * v + 1.5 * x * x + 0.8 * x - sici(x)[0] for x, v in zip(found["x"], found["der(x)"])]
    assert energy == pytest.approx([energy[0]] * len(energy), abs=1e-5)


SATELLITES = """model Satellites
  parameter Real[m3/s2] mu = 3.986e14;
  parameter Real[m3/s2] g = 1e-12;
  parameter Length R = 7e6 [m];
  parameter Length d = 0.1 [m];
  coordinate Length x1(start = R), y1(rate = sqrt(mu/R)), x2(start = R + d), y2(rate = sqrt(mu/(R + d)));
  body a = Particle(mass = 1 [kg], at = {x1, y1, 0});
  body b = Particle(mass = 1 [kg], at = {x2, y2, 0});
  potential V = -mu*1 [kg]*(1/norm(position(a)) + 1/norm(position(b)));
  %s
end Satellites;"""


@pytest.mark.parametrize(
    "near",
    [
        "potential near = -g*1 [kg]/norm(position(b) - position(a));",
        "potential near = 1e-12 [J]*exp(-(norm(position(b) - position(a))/(1 [m]))^2);",
    ],
)
def test_neighbours_cost_no_extra_steps(near: str) -> None:
    """Boxes of the one and the other overlap on all but parts of 1e-7 of a step, and how far they are apart
    hardly changes."""
    alone = run(SATELLITES % "", 600.0, 1e-6)
    compiled = lagc.loads(SATELLITES % near).compile(backend="numpy")
    enclosed = counted(compiled.load("numpy").model.module, "_bounds")
    both = compiled.simulate(600.0, accuracy=1e-6, points=21)
    assert both.status == "ok"
    assert both.cost.rhs < 2 * alone.cost.rhs
    assert 0 < len(enclosed) < 4 * both.cost.rhs


def counted(module: dict[str, Any], ending: str) -> list[str]:
    """The names of the functions of the model with that ending, once for each call from now on."""
    found: list[str] = []
    for name in [name for name in module if name.startswith("fn_") and name.endswith(ending)]:

        def noted(*given: Any, own: Any = module[name], name: str = name) -> None:
            found.append(name)
            own(*given)

        module[name] = noted
    return found


def test_models_without_divisors_have_no_guards() -> None:
    from lagc.compiler.pipeline import program
    from lagc.compiler.stages import Choice
    from lagc.host.model_library import read

    assert program(read("kepler"), Choice()).interface.poles == 1
    assert "poles" not in program(read("double_pendulum"), Choice()).functions
