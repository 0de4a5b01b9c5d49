"""Fixed steps that are too long: what they lead to is not blamed on the model."""

import random

import pytest

import lagc
from lagc.diagnostics.faults import Refused

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
