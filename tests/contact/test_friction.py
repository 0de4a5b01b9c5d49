"""Dry friction of one-sided constraints in the plane, against closed forms, and what is refused."""

import math
import random
from typing import Any

import numpy as np
import pytest

import lagc
from lagc.api import Run
from lagc.diagnostics.faults import Refused

BACKENDS = ["numpy", pytest.param("c", marks=pytest.mark.full)]
G = 9.81
HEAD = """model M
  coordinate Length x, y;
  Gravity field(g = 9.81 [m/s2], direction = {0, -1, 0});
  body block = Particle(mass = 2 [kg], at = {x, y, 0});
"""


def _run(name: str, backend: str, stop: float | None = None, **values: Any) -> Run:
    scene, accuracy = values.pop("scene", None), values.pop("accuracy", 1e-9)
    compiled = lagc.load(name).compile(backend=backend, scene=scene)
    return compiled.simulate(stop, accuracy=accuracy, parameters=values)


def _model(text: str) -> lagc.ModelFile:
    return lagc.loads(f"{HEAD}{text}\n  scene s\n    simulate(stop = 1 [s]);\n  end s;\nend M;\n")


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_block_stops_on_a_slope_and_stays(backend: str) -> None:
    """It stops after v/(g (sin a + mu cos a)), and stays: creep is exactly zero."""
    run = _run("incline", backend)
    (stops,) = run.events
    assert stops.kind == "sticks" and stops.t == pytest.approx(0.2764468284185231380951, abs=1e-12)
    still = np.array(run["s"])[np.array(run.t) > stops.t]
    assert still[0] == pytest.approx(0.4146702426277847071427, abs=1e-9)
    assert np.all(still == still[0]) and np.all(np.array(run["n"]) == 0.0)
    assert run.final["N"] == pytest.approx(G * math.cos(math.radians(30.0)), abs=1e-12)


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_block_slides_back(backend: str) -> None:
    run = _run("incline", backend, scene="slides_back")
    (turns,) = run.events
    assert turns.kind == "slips" and turns.t == pytest.approx(0.4024839828489269925364, abs=1e-12)
    assert run.final["s"] == pytest.approx(0.0, abs=1e-8)
    assert run.final["der(s)"] == pytest.approx(-1.686743494205304883868, abs=1e-8)


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_block_on_a_belt_sticks_and_slips(backend: str) -> None:
    """J. P. Den Hartog, Mechanical Vibrations, 1956, 7.3: it slips where the spring pulls by mu_s m g."""
    run = _run("block_on_belt", backend)
    k, w, mu, mu_s = 10.0, 0.1, 0.2, 0.3
    first, slip = mu_s * G / k / w, (mu_s - mu) * G / k
    lasts = (2.0 * math.pi - 2.0 * math.atan(slip * math.sqrt(k) / w)) / math.sqrt(k)
    period = lasts + 2.0 * slip / w
    expected = [first, first + lasts, first + period, first + period + lasts, first + 2.0 * period]
    assert [event.kind for event in run.events] == ["slips", "sticks"] * 2 + ["slips"]
    assert [event.t for event in run.events] == pytest.approx(expected, abs=1e-8)


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_ball_slips_and_then_rolls(backend: str) -> None:
    """A. Sommerfeld, Mechanics, 1952, section 27: 5/7 of its speed, after 2/7 v/(mu g)."""
    run = _run("bowling_ball", backend)
    (rolls,) = run.events
    assert rolls.kind == "sticks" and rolls.t == pytest.approx(2.0 / 7.0 * 8.0 / (0.1 * G), abs=1e-11)
    assert run.final["der(x)"] == pytest.approx(5.0 / 7.0 * 8.0, rel=1e-9)
    assert run.final["der(x)"] == pytest.approx(0.11 * run.final["der(phi)"], rel=1e-14)
    assert run.final["E"] == pytest.approx(
        7.0 / 10.0 * 7.0 * (5.0 / 7.0 * 8.0) ** 2 + 7.0 * G * 0.11, rel=1e-9
    )


@pytest.mark.parametrize("backend", BACKENDS)
def test_friction_acts_beside_two_sided_constraints(backend: str) -> None:
    """A block on a slope in x and y, tied to a mass of 1 g that moves along the slope without weight."""
    text = """model Tied
  coordinate Length x(rate = 3*cos(30 [deg])*1 [m/s]), y(rate = 1.5 [m/s]), w(rate = 3 [m/s]);
  Gravity field(g = 9.81 [m/s2], direction = {0, -1, 0});
  body block = Particle(mass = 1 [kg], at = {x, y, 0});
  body tag = Particle(mass = 1e-3 [kg], at = {0, 0, w});
  constraint tie: w = x*cos(30 [deg]) + y*sin(30 [deg]);
  constraint slope: y*cos(30 [deg]) - x*sin(30 [deg]) >= 0 (friction = 0.3, slip = der(w));
  scene s
    simulate(stop = 1 [s]);
  end s;
end Tied;
"""
    run = lagc.loads(text).compile(backend=backend).simulate(accuracy=1e-8)
    slows = G * (0.5 + 0.3 * math.cos(math.radians(30.0))) / 1.001
    back = G * (0.5 - 0.3 * math.cos(math.radians(30.0))) / 1.001
    (turns,) = run.events
    assert turns.kind == "slips" and turns.t == pytest.approx(3.0 / slows, abs=1e-8)
    assert run.final["der(w)"] == pytest.approx(-back * (1.0 - 3.0 / slows), abs=1e-7)


@pytest.mark.parametrize(("pull", "sticks"), [(0.2999, True), (0.3001, False)])
def test_static_friction_holds_up_to_its_coefficient(pull: float, sticks: bool) -> None:
    text = f"""  force F = {{{pull * 2.0 * G}, 0, 0}} on block at {{x, y, 0}};
  constraint floor: y >= 0 (friction = 0.25, static = 0.3, slip = der(x));"""
    run = _model(text).compile(backend="numpy").simulate(1.0)
    assert run.final["x"] == pytest.approx(0.0 if sticks else (pull - 0.25) * G / 2.0, abs=1e-6)


def test_a_contact_whose_friction_is_zero_slides_both_ways() -> None:
    """A spring draws a block over a floor: it turns back as without a floor."""
    text = """  parameter Real mu = 0;
  potential spring = 1/2*50 [N/m]*x^2;
  constraint floor: y >= 0 (friction = mu, slip = der(x));
  initial
    x = 1 [m];
    der(x) = 0;"""
    run = _model(text).compile(backend="numpy").simulate(0.7, accuracy=1e-6)
    turns = [math.pi / 5.0]
    assert run.status == "ok" and [event.t for event in run.events] == pytest.approx(turns, abs=1e-6)
    assert run.final["x"] == pytest.approx(math.cos(3.5), abs=2e-6)


def test_friction_may_depend_on_the_slip() -> None:
    """mu = c v slows a block as exp(-c g t)."""
    text = """  constraint floor: y >= 0 (friction = 0.1 [s/m]*der(x), slip = der(x));
  initial
    der(x) = 2 [m/s];"""
    run = _model(text).compile(backend="numpy").simulate(1.0, accuracy=1e-8)
    assert run.final["der(x)"] == pytest.approx(2.0 * math.exp(-0.1 * G), abs=1e-6)


@pytest.mark.sample(1)
@pytest.mark.parametrize("seed", range(12))
def test_boxes_thrown_on_a_rough_floor_lose_energy_and_never_sink_in(seed: int) -> None:
    chance = np.random.default_rng(seed)
    compiled = lagc.load("tumbling_box").compile(backend="numpy" if seed == 0 else "c")
    for _ in range(1 if seed == 0 else 5):
        values = {
            "mu": float(chance.choice([0.1, 0.4, 0.8])), "e": float(chance.choice([0.0, 0.5, 0.8])),
            "vx": chance.uniform(-2.0, 2.0), "vy": chance.uniform(-1.0, 1.0),
            "omega": chance.uniform(-5.0, 5.0), "phi0": chance.uniform(-3.0, 3.0),
        }  # fmt: skip
        run = compiled.simulate(1.0 if seed == 0 else 4.0, rtol=1e-9, points=201, parameters=values)
        x = np.array(run.x)
        energy = 0.5 * (x[:, 3] ** 2 + x[:, 4] ** 2 + 0.13 / 3.0 * x[:, 5] ** 2) + G * x[:, 1]
        corners = np.array([[0.3, 0.2], [-0.3, 0.2], [-0.3, -0.2], [0.3, -0.2]])
        gaps = x[:, 1:2] + np.sin(x[:, 2:3]) * corners[:, 0] + np.cos(x[:, 2:3]) * corners[:, 1]
        assert run.status == "ok" and np.max(np.diff(energy)) < 1e-7 and np.min(gaps) > -1e-8


@pytest.mark.full
@pytest.mark.parametrize("seed", range(4))
def test_stacks_of_blocks_that_fall_and_slide_lose_energy(seed: int) -> None:
    """Four blocks on each other and on a floor, thrown with random speeds: at last all rest."""
    chance, n = np.random.default_rng(seed), 4
    mass = chance.uniform(0.5, 2.0, n)
    text = "model Stack\n  Gravity field(g = 9.81 [m/s2], direction = {0, -1, 0});\n"
    for i in range(n):
        v = chance.uniform(-3.0, 3.0)
        text += f"""  coordinate Length x{i}(rate = {v} [m/s]), y{i}(start = {0.3 * i + 0.1} [m]);
  body b{i} = Particle(mass = {mass[i]} [kg], at = {{x{i}, y{i}, 0}});
"""
        gap, slip = (
            ("y0", "der(x0)") if i == 0 else (f"y{i} - y{i - 1} - 0.2 [m]", f"der(x{i}) - der(x{i - 1})")
        )
        law = f"friction = {chance.uniform(0.1, 0.8)}, restitution = {chance.choice([0.0, 0.3, 0.6])}"
        text += f"  constraint c{i}: {gap} >= 0 ({law}, slip = {slip});\n"
    text += "  output Energy E = energy();\n  scene s\n    simulate(stop = 12 [s]);\n  end s;\nend Stack;\n"
    run = lagc.loads(text).compile(backend="c").simulate(rtol=1e-9, points=301)
    x = np.array(run.x)
    speeds, heights = x[:, 2 * n : 4 * n], x[:, 1 : 2 * n : 2]
    energy = 0.5 * speeds**2 @ np.repeat(mass, 2) + G * heights @ mass
    assert run.status == "ok" and np.max(np.diff(energy)) < 1e-7
    assert np.min(np.diff(heights, axis=1)) > 0.2 - 1e-8 and np.min(heights) > -1e-8
    assert np.max(np.abs(speeds[-1])) < 1e-9


@pytest.mark.parametrize(
    ("arguments", "message"),
    [("friction = 0.3", "`friction` needs `slip` or `at`"),
     ("slip = der(x)", "`slip` needs `friction`"),
     ("static = 0.3", "`static` needs `friction`"),
     ("friction = -0.1, slip = der(x)", "the friction is -0.1"),
     ("friction = 0.3, static = 0.2, slip = der(x)", "less than the friction"),
     ("friction = 0.3, slip = x", "[m/s]"),
     ("friction = 0.3, slip = 1 [m/s]", "no velocity"),
     ("friction = 0.3, slip = der(x)^2/(1 [m/s])", "not linear in the speeds"),
     ("friction = 0.3 [m], slip = der(x)", "a number")],
)  # fmt: skip
def test_what_makes_no_sense_is_refused(arguments: str, message: str) -> None:
    with pytest.raises(Refused) as found:
        _model(f"  constraint floor: y >= 0 ({arguments});").compile(backend="numpy")
    texts = [f"{fault.message} {fault.remedy}" for fault in found.value.faults]
    assert any(message in text for text in texts), texts


def test_a_vector_of_contacts_has_no_friction() -> None:
    with pytest.raises(Refused, match="vector"):
        _model("  constraint floor: {x, y} >= {0, 0} (friction = 0.3, slip = der(x));").compile(
            backend="numpy"
        )


@pytest.mark.parametrize("angle", [1.0, 1.3])
def test_painleve_rod_ends_the_run(angle: float) -> None:
    """F. Genot, B. Brogliato, Eur. J. Mech. A/Solids 18 (1999) 653-677: from .8839 to 1.2749 for mu = 1.5."""
    model = lagc.loads(f"""model Rod
  coordinate Length x(rate = -1 [m/s]), y(start = {math.sin(angle)} [m]);
  coordinate Angle th(start = {angle});
  Gravity field(g = 9.81 [m/s2], direction = {{0, -1, 0}});
  frame F = rotate_z(world, th);
  point C = {{x, y, 0}};
  body rod = Solid(mass = 1 [kg], inertia = 1/3*{{1, 1, 1}}, frame = F, com = C);
  point tip = C - 1 [m]*F.x;
  constraint floor: tip.y >= 0 (friction = 1.5, slip = der(tip.x));
  scene s
    simulate(stop = 0.01 [s]);
  end s;
end Rod;
""")
    run = model.compile(backend="numpy").simulate(rtol=1e-8)
    assert (run.status == "failed") == (angle < 1.27)


@pytest.mark.parametrize("backend", ["numpy", "c"])
def test_bounces_that_end_in_rest_rub_as_all_of_them(backend: str) -> None:
    """A block is thrown and bounces: friction takes mu of what the floor gives, m g t + m v of the first
    impact, as long as it slips. Then der(x) = v0 - mu g t: the fall before gains what the impacts give."""
    model = lagc.loads("""model Throw
  coordinate Length x(rate = 3 [m/s]), y(start = 0.5 [m]);
  Gravity field(g = 9.81 [m/s2], direction = {0, -1, 0});
  body block = Particle(mass = 1 [kg], at = {x, y, 0});
  constraint floor: y >= 0 (restitution = 0.4, friction = 0.2, slip = der(x));
end Throw;
""")
    run = model.compile(backend=backend).simulate(1.0, accuracy=1e-9)
    fall, e, mu, g = math.sqrt(2 * 0.5 / 9.81), 0.4, 0.2, 9.81
    x, v, t, up = 3.0 * fall, 3.0, fall, g * fall
    while up > 1e-14:
        v -= mu * (1 + e) * up
        up *= e
        x, t = x + v * 2 * up / g, t + 2 * up / g
    x += v * (1.0 - t) - mu * g * (1.0 - t) ** 2 / 2
    assert run.final["der(x)"] == pytest.approx(3.0 - mu * g, abs=1e-10)
    assert run.final["der(x)"] == pytest.approx(v - mu * g * (1.0 - t), abs=1e-10)
    assert run.final["x"] == pytest.approx(x, abs=1e-9)


@pytest.mark.long
def test_300_thrown_boxes_end_within_their_accuracy() -> None:
    """Boxes of any shape, friction, restitution, against runs with a hundredth of the accuracy. Energy never
    grows. A run that does not reach its end says why."""
    chance = random.Random(1)
    system = lagc.load("tumbling_box").compile(backend="c")
    ended = 0
    for _ in range(300):
        given = {"a": chance.uniform(0.1, 0.5), "b": chance.uniform(0.1, 0.5),
                 "mu": chance.choice([0.0, chance.uniform(0.0, 0.8)]),
                 "e": chance.choice([0.0, chance.uniform(0.0, 0.8)]), "vx": chance.uniform(-3.0, 3.0),
                 "vy": chance.uniform(-1.0, 1.0), "omega": chance.uniform(-6.0, 6.0),
                 "phi0": chance.uniform(-3.0, 3.0)}  # fmt: skip
        run = system.simulate(2.0, accuracy=1e-6, parameters=given, points=201)
        energy = run["E"]
        assert (energy[1:] - energy[:-1]).max() <= 2e-6 * abs(energy).max()
        assert run.status == "ok" or run.message
        ended += run.status == "ok"
        fine = system.simulate(2.0, accuracy=1e-8, parameters=given, points=201)
        if run.status == fine.status == "ok":
            for names in (("x", "y"), ("phi",), ("der(x)", "der(y)"), ("der(phi)",)):
                size = max(abs(run[name]).max() for name in names)
                assert all(abs(run.final[name] - fine.final[name]) <= 1e-6 * size for name in names)
    assert ended >= 299
