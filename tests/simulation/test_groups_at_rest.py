"""Scaling groups that are zero except for round-off: symmetric systems, compared with the model without
these coordinates."""

import math
from collections.abc import Callable
from random import Random
from typing import Any

import mpmath as mp
import pytest

import lagc
from lagc.api import Run

GRAVITY = "effect gravity\n Gravity field;\n end gravity;\n scene lab uses gravity;\n"
Pair = tuple[
    str, str, dict[str, str]
]  # a model, the same without what is zero, and what its states are there


def carts(chance: Random) -> Pair:
    """Pendulums in opposite pairs on a cart, with dampers, against each alone on what does not move."""
    lines, alone, same = [], [], {}
    for k in range(chance.randint(1, 3)):
        mass, long, a = chance.uniform(0.3, 2.0), chance.uniform(0.3, 1.5), chance.uniform(0.2, 2.0)
        rate, c = chance.choice((0.0, chance.uniform(-1.0, 1.0))), chance.choice((0.0, 0.4))
        for side, sign in (("a", 1.0), ("b", -1.0)):
            name = f"{side}{k}"
            lines.append(f"""
              coordinate Angle {name}(start = {sign * a!r}, rate = {sign * rate!r} [rad/s]);
              body p{name} = Particle(mass = {mass!r} [kg],
                at = {{x, 0, 0}} + ({long!r} [m])*{{sin({name}), 0, -cos({name})}});
              force f{name} = -({c!r} [N.s/m])*velocity(p{name}) at p{name};""")
            same[name] = f"a{k}" if sign > 0 else f"-a{k}"
        alone.append(lines[-2].replace("{x, 0, 0} + ", ""))
    mass = chance.uniform(0.5, 5.0)
    cart = f"coordinate Length x;\nbody cart = Particle(mass = {mass!r} [kg], at = {{x, 0, 0}});"
    return framed([cart, *lines]), framed(alone), same


def springs(chance: Random) -> Pair:
    """A pendulum and a slider, joined by a spring that stays relaxed."""
    long, k = chance.uniform(0.3, 1.5), chance.uniform(1.0, 9.0)
    bob = (f"coordinate Angle a(start = {chance.uniform(0.3, 2.0)!r});\n"
           f"body bob = Particle(mass = 1 [kg], at = ({long!r} [m])*{{sin(a), 0, -cos(a)}});")  # fmt: skip
    slider = (
        f"coordinate Length x;\nbody c = Particle(mass = 1 [kg], at = {{x, 0, 0}});\n"
        f"potential s = 1/2*({k!r} [N/m])*(norm(position(bob) - position(c)) - {long!r} [m])^2;"
    )
    return framed([bob, slider]), framed([bob]), {"a": "a"}


def framed(lines: list[str]) -> str:
    return "model M\n" + "\n".join(lines) + "\n" + GRAVITY + "end M;"


def column(run: Run, name: str) -> Any:
    return -run[name[1:]] if name.startswith("-") else run[name]


@pytest.mark.full
@pytest.mark.usefixtures("no_cache")
@pytest.mark.parametrize("backend", ["numpy", "c"])
@pytest.mark.parametrize("make", [carts, springs])
def test_what_is_zero_but_for_rounding_is_no_motion(make: Callable[[Random], Pair], backend: str) -> None:
    chance = Random(make.__name__)
    dear = []
    for _ in range(10 if backend == "numpy" else 2):
        text, reduced, same = make(chance)
        accuracy = chance.choice((1e-4, 1e-6, 1e-8))
        run = lagc.loads(text).compile(backend=backend).simulate(3.0, accuracy=accuracy, points=31)
        alone = lagc.loads(reduced).compile(backend="numpy")
        one = alone.simulate(3.0, accuracy=1e-11, points=31)
        assert run.status == "ok" and run.estimated is not None and run.estimated <= accuracy, run.message
        size = max(abs(run[name]).max() for name in same)
        true = max(abs(run[name] - column(one, other)).max() for name, other in same.items()) / size
        assert true <= run.estimated / 0.7 + 1e-10
        moved = abs(run["x"]).max()
        assert moved < 1e-12
        assert moved == 0.0 or any(
            "only by round-off" in note and "`x`" in note for note in run.to_dict()["notes"]
        )
        dear.append(run.cost.rhs > 3 * alone.simulate(3.0, accuracy=accuracy, points=31).cost.rhs)
    assert 2 * sum(dear) <= len(dear)  # round-off that happens to cancel at a state costs steps


def cart(more_mass: float, stiffness: float) -> str:
    """Of a metre and 3 kg, with two pendulums, of which one is heavier by so much."""
    return framed([
        "coordinate Length x;\nbody cart = Particle(mass = 3 [kg], at = {x, 0, 0});",
        f"potential s = 1/2*({stiffness!r} [N/m])*x^2;",
        "coordinate Angle a(start = 1), b(start = -1);",
        "body p = Particle(mass = 1 [kg], at = {x, 0, 0} + 0.7 [m]*{sin(a), 0, -cos(a)});",
        f"body q = Particle(mass = 1 [kg] + {more_mass!r} [kg], "
        "at = {x, 0, 0} + 0.7 [m]*{sin(b), 0, -cos(b)});",
    ])  # fmt: skip


@pytest.mark.sample(1)
@pytest.mark.usefixtures("no_cache")
@pytest.mark.parametrize(("more_mass", "accuracy"), [(1e-7, 1e-6), (1e-9, 1e-3), (1e-12, 1e-6)])
def test_a_small_motion_that_is_determined_is_told(more_mass: float, accuracy: float) -> None:
    """It is in proportion to the mass that is more, as that is little."""
    run = (
        lagc.loads(cart(more_mass, 0.0)).compile(backend="numpy").simulate(2.0, accuracy=accuracy, points=11)
    )
    assert not any("only by round-off" in note for note in run.notes)
    assert (run.status == "ok") == (more_mass > 1e-11)
    if run.status == "ok":
        other = lagc.loads(cart(1e-5, 0.0)).compile(backend="numpy").simulate(2.0, accuracy=1e-9, points=11)
        far = abs(run["x"] / more_mass - other["x"] / 1e-5).max() / abs(other["x"] / 1e-5).max()
        assert far <= accuracy + 2e-5  # the second order of 1e-5


def pairs(stiffness: float) -> str:
    """Of a cart with three pairs of pendulums: forces on it sum up to nothing but rounding."""
    lines = [
        "coordinate Length x;\nbody cart = Particle(mass = 3 [kg], at = {x, 0, 0});",
        f"potential s = 1/2*({stiffness!r} [N/m])*x^2;",
    ]
    for sign in (1, -1):
        for k, long in enumerate((0.7, 0.9, 1.3)):
            name = f"{'a' if sign > 0 else 'b'}{k}"
            lines.append(f"coordinate Angle {name}(start = {sign * (1.0 - 0.3 * k)!r});")
            lines.append(f"body p{name} = Particle(mass = {1.0 + 0.1 * k!r} [kg], "
                         f"at = {{x, 0, 0}} + {long!r} [m]*{{sin({name}), 0, -cos({name})}});")  # fmt: skip
    return framed(lines)


@pytest.mark.full
def test_a_saddle_that_rounding_leaves_is_no_rest() -> None:
    """x grows exponentially from 1e-16 m or so."""
    run = lagc.loads(pairs(-100.0)).compile(backend="numpy").simulate(8.0, accuracy=1e-6, points=81)
    assert run.status == "failed" and "until t = " in run.message
    assert 0.5 < run.times[-1] <= 8.0
    assert 0.0 < abs(run["x"]).max() <= run.errors["x"]


@pytest.mark.full
def test_a_saddle_on_which_rounding_happens_to_cancel_is_no_rest() -> None:
    run = lagc.loads(cart(0.0, -100.0)).compile(backend="numpy").simulate(8.0, accuracy=1e-6, points=81)
    assert run.status == "failed" and "until t = " in run.message
    assert 0.5 < run.times[-1] < 8.0  # what is given has not moved
    assert abs(run["x"]).max() < 1e-5


@pytest.mark.sample(1)
@pytest.mark.parametrize("stiffness", [10.0, 300.0, 1e3, 3e3, 1e5, 1e6])
def test_a_spring_holds_what_rounding_moves(stiffness: float) -> None:
    run = lagc.loads(pairs(stiffness)).compile(backend="numpy").simulate(3.0, accuracy=1e-6, points=31)
    assert 0.0 < abs(run["x"]).max() < 1e-12
    assert run.status == "ok" and any("only by round-off" in note for note in run.notes)


ROLLING = """model Roll
  parameter Length R = 0.1 [m];
  coordinate Length x;
  coordinate Angle phi(rate = 20 [rad/s]);
  body ball = Solid(mass = 1 [kg], inertia = 2/5*(1 [kg])*R^2*{1, 1, 1}, frame = rotate_y(world, phi),
                    com = {x, 0, R});
  force rub = -0.3*(9.81 [N])*sign(der(x) - R*der(phi))*world.x on ball at {x, 0, 0};
end Roll;"""


@pytest.mark.sample(1)
@pytest.mark.usefixtures("no_cache")
@pytest.mark.parametrize("backend", ["numpy", "c"])
@pytest.mark.parametrize("accuracy", [1e-6, 1e-12])
def test_friction_that_comes_to_rest_has_moved_its_body(accuracy: float, backend: str) -> None:
    """The ball slides until it rolls; rounding alone tells the sign of the slip from then on."""
    run = lagc.loads(ROLLING).compile(backend=backend).simulate(3.0, accuracy=accuracy, points=31)
    assert run.status == "ok" and not run.notes
    rolls = 2.0 / (0.3 * 9.81 * 3.5)
    true = 4.0 / 7.0 * (3.0 - 0.5 * rolls)
    assert run.estimated is not None and abs(run["x"][-1] - true) <= run.estimated * true + 1e-15


PLATFORM = """model Platform
  coordinate Length x(start = 0.3 [m]), z;
  coordinate Angle a;
  point C = {x, 0, z - 1 [m]};
  frame F = rotate_y(world, a);
  body p = Solid(mass = 5 [kg], inertia = {1, 1, 1}, frame = F, com = C);
  for i in 1:3 loop
    constraint rod[i]: norm(C + (i - 2)*0.4 [m]*F.x - {(i - 2)*0.4 [m], 0, 0}) = 1 [m];
  end for;
  Gravity field(g = 9.81, direction = {0, 0, -1});
end Platform;
"""


@pytest.mark.full
def test_a_platform_on_three_parallel_rods_does_not_turn() -> None:
    """Its centre moves on a circle, as a pendulum of that length; one rod more than would do bears load."""
    length, tilt = 1.0, math.asin(0.3)
    stop = 3.0
    run = lagc.loads(PLATFORM).compile(backend="numpy").simulate(stop=stop, accuracy=1e-9)
    assert run.status == "ok", run.message
    assert any("only by round-off" in note and "`a`" in note for note in run.notes)
    k = math.sin(tilt / 2)
    quarter = float(mp.ellipk(k * k))
    sine = k * float(mp.ellipfun("sn", quarter + stop * math.sqrt(9.81 / length), k=k))
    assert run["x"][-1] == pytest.approx(length * math.sin(2 * math.asin(sine)), abs=1e-9)


@pytest.mark.full
def test_a_table_slides_on_four_legs() -> None:
    """Towards a spring at x = 1 m, as a harmonic oscillator does."""
    text = """model Table
  coordinate Length x(start = 0.2 [m]), y, z;
  coordinate Angle yaw, pitch, roll;
  frame C = rotate_x(rotate_y(rotate_z(world, yaw), pitch), roll);
  point G = {x, y, z + 0.5 [m]};
  body t = Solid(mass = 8 [kg], inertia = {0.5, 0.6, 0.7}, frame = C, com = G);
  constraint l1: (G + 0.4 [m]*C.x + 0.3 [m]*C.y - 0.5 [m]*C.z).z = 0;
  constraint l2: (G - 0.4 [m]*C.x + 0.3 [m]*C.y - 0.5 [m]*C.z).z = 0;
  constraint l3: (G + 0.4 [m]*C.x - 0.3 [m]*C.y - 0.5 [m]*C.z).z = 0;
  constraint l4: (G - 0.4 [m]*C.x - 0.3 [m]*C.y - 0.5 [m]*C.z).z = 0;
  potential s = 0.5*50 [N/m]*((x - 1 [m])^2 + y^2);
  Gravity field;
end Table;
"""
    run = lagc.loads(text).compile(backend="numpy").simulate(stop=2.0, accuracy=1e-9)
    assert run.status == "ok", run.message
    assert run["x"][-1] == pytest.approx(1.0 - 0.8 * math.cos(2.0 * math.sqrt(50 / 8)), abs=1e-9)
