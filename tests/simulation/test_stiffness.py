"""A run whose steps stability limits is told so, and no other one is. Fixed steps that are too long: what
they lead to is not blamed on the model."""

import random
from typing import Any

import pytest

import lagc
from lagc.diagnostics.faults import Refused
from lagc.simulation.simulate import stability_note
from lagc.simulation.system import Options
from tests.simulation.test_radau import SLIDE, SPRING

pytestmark = pytest.mark.usefixtures("own_cache")
# Decays of 1e6/s and 1e-2/s; a slow pendulum on a spring that rings at 1e4 rad/s and decays.
DAMPED, PAIR = SLIDE, SPRING.replace("k = 1e6", "k = 1e8").replace("c = 0", "c = 2e3")


def integrated(text: str, stop: float, backend: str = "c", **given: Any) -> Any:
    system = lagc.loads(text).compile(backend=backend).load(backend)
    return system.integrate(Options(**given), 0.0, system.start(), [stop])


@pytest.mark.parametrize("text, rate", [(DAMPED, 1e6), (PAIR, 1e4)], ids=["decay", "ringing"])
@pytest.mark.parametrize("method, bound", [("dop853", 6.1), ("dopri5", 3.25)])
def test_steps_at_the_border_of_stability(text: str, rate: float, method: str, bound: float) -> None:
    """The steps are as long as the largest eigenvalue of the equations allows, whatever the tolerance. Where
    it is complex, single tests of a thousand steps miss it: about half of them find it."""
    stop, found, tests = 4e4 / rate, 0, 0
    for rtol in (1e-4, 1e-5, 1e-6, 1e-7):
        run = integrated(text, stop, method=method, rtol=rtol)
        assert run.steps == pytest.approx(stop * rate / bound, rel=0.4)
        found, tests = found + run.stiff, tests + run.steps // 1000
    assert found >= (0.6 if text == DAMPED else 0.4) * tests > 1


@pytest.mark.parametrize("method", ["dop853", "dopri5"])
@pytest.mark.parametrize("name", ["simple_pendulum", "double_pendulum", "four_bar"])
def test_steps_that_accuracy_limits(name: str, method: str) -> None:
    system = lagc.load(name).compile(backend="c").load("c")
    start = lagc.load(name).compile(backend="numpy").start()
    x = [*map(float, start), *[0.0] * (system.nx - len(start))]
    for rtol in (1e-3, 1e-6, 1e-10):
        run: Any = system.integrate(Options(method=method, rtol=rtol), 0.0, x, [200.0])
        assert run.stiff == 0


def test_c_and_python_count_the_same() -> None:
    one, two = (integrated(DAMPED, 1e-2, backend, rtol=1e-6) for backend in ("c", "numpy"))
    assert (one.steps, one.stiff) == (two.steps, two.stiff) and one.stiff > 0


def test_the_note_names_the_steps() -> None:
    run = integrated(DAMPED, 0.7, rtol=1e-6)
    assert run.steps > 100_000
    (note,) = stability_note(run)
    assert str(run.steps) in note and "--method radau5" in note
    assert not stability_note(run.changed(steps=99_999)) and not stability_note(run.changed(stiff=1))


@pytest.mark.full
def test_a_run_has_the_note() -> None:
    model = lagc.loads(DAMPED).compile(backend="c")
    assert any("stability limited" in note for note in model.simulate(0.7, rtol=1e-6).notes)
    assert not any("stability limited" in note for note in model.simulate(0.1, rtol=1e-6).notes)


GRAVITY = "effect gravity\n Gravity field;\nend gravity;\nscene lab uses gravity;\n"


def stiff(dice: random.Random) -> tuple[str, float]:
    """A pair of springs, and the time of the faster."""
    k = 10 ** dice.uniform(2, 8)
    text = f"""coordinate Length x(start = {dice.uniform(0.1, 1)!r}), y(start = {dice.uniform(-1, 1)!r});
      body b = Particle(mass = 1, at = {{x, y, 0}});
      potential s = 1/2*({k!r} [N/m])*x^2 + 1/2*(3 [N/m])*(y - x)^2 + {dice.uniform(1, 9)!r} [N/m2]*x*y*x;"""
    return text, k**-0.5


def strings(dice: random.Random) -> tuple[str, float]:
    """A chain of weights on strings, and about the time in which it falls."""
    lines, before = list[str](), "{0, 0, 0} [m]"
    for k in range(dice.randint(1, 3)):
        lines.append(f"""coordinate Length x{k}(start = {dice.uniform(0.1, 0.9) + k!r}), z{k};
          body b{k} = Particle(mass = {dice.uniform(0.5, 2)!r}, at = {{x{k}, 0, z{k}}});
          constraint c{k}: norm({{x{k}, 0, z{k}}} - {before}) = 1.2 [m];""")
        before = f"{{x{k}, 0, z{k}}}"
    return "\n".join(lines), 0.3


def rolling(dice: random.Random) -> tuple[str, float]:
    """A ball that rolls inside an upright tube, and the time of a turn."""
    rate = dice.uniform(1, 4)
    text = f"""parameter Length R = 0.05 [m], d = 0.4 [m];
      coordinate Angle a; coordinate Length z; coordinate Orientation o;
      point C = {{d*cos(a), d*sin(a), z}};
      body b = Solid(mass = 0.3, inertia = 2/5*(0.3 [kg])*R^2*{{1, 1, 1}}, frame = rotate(world, o), com = C);
      constraint roll: velocity(b, at = C + R*{{cos(a), sin(a), 0}}) = {{0, 0, 0}} [m/s];
      initial
      der(a) = {rate!r} [rad/s];"""
    return text, 0.1 / rate


@pytest.mark.sample(1)
@pytest.mark.parametrize("make", [stiff, strings, rolling])
def test_a_step_that_is_too_long_is_named(make: object) -> None:
    """The solution fails at a state that a step reached, not because of the model."""
    assert callable(make)
    dice = random.Random(make.__name__)
    failed = 0
    for _ in range(5):
        text, time = make(dice)
        body, initial, conditions = text.partition("initial")
        system = lagc.loads(f"model M\n{body}\n{GRAVITY}{initial}{conditions}\nend M;\n").compile(
            backend="numpy"
        )
        for _ in range(3):
            step = time * 10 ** dice.uniform(-0.5, 1.5)
            try:
                run = system.simulate(60 * step, method=dice.choice(("rk4", "bs32", "dopri5")), step=step)
            except Refused as refused:
                raise AssertionError(text) from refused
            if run.status == "ok":
                continue
            failed += 1
            assert f"the fixed step of {step:g} s may be too long" in run.message, (text, run.message)
    assert failed >= 4
