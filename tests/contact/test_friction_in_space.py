"""Dry friction along a surface, against closed forms, and what is refused."""

import math
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import lagc
from lagc.diagnostics.faults import Refused

BACKENDS = ["numpy", pytest.param("c", marks=pytest.mark.full)]
G = 9.81
HEAD = """model M
  coordinate Length x, y, z;
  Gravity field(g = 9.81 [m/s2], direction = {0, 0, -1});
  body block = Particle(mass = 2 [kg], at = {x, y, z});
"""


def _model(text: str, head: str = HEAD, stop: str = "1 [s]") -> lagc.ModelFile:
    return lagc.loads(f"{head}{text}\n  scene s\n    simulate(stop = {stop});\n  end s;\nend M;\n")


def _stop(mu: float) -> float:
    """Return when a puck stops that is thrown with 3 m/s across a slope of 30 degrees."""
    s, c = 0.5, math.cos(math.radians(30.0))
    return mu * c * 3.0 / (G * (mu**2 * c**2 - s**2))


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_puck_thrown_across_a_slope_stops(backend: str) -> None:
    compiled = lagc.load("thrown_across").compile(backend=backend)
    run = compiled.simulate(accuracy=1e-9 if backend == "c" else 1e-7)
    (stops,) = run.events
    exact = 1.577767669071785
    assert exact == pytest.approx(_stop(0.7), abs=1e-13)
    # Times of events are accurate relative to the time of the run.
    near = 1e-10 if backend == "c" else 1e-7 * run.times[-1]
    assert stops.kind == "sticks" and stops.t == pytest.approx(exact, abs=near)
    assert run.final["der(x)"] == run.final["der(y)"] == 0.0
    x = np.array(run.x)
    before = np.array(run.t) < stops.t - 1e-6
    law = 0.7 * math.cos(math.radians(30.0)) * np.hypot(x[:, 3], x[:, 4]) - 0.5 * x[:, 4]
    falls = G * (0.49 * 0.75 - 0.25)
    start = 0.7 * math.cos(math.radians(30.0)) * 3.0
    assert np.max(np.abs(law - start + falls * np.array(run.t))[before]) < 1e-7


@pytest.mark.full
@pytest.mark.parametrize("mu", [0.6, 1.0, 2.0, 5.0])
def test_it_stops_at_other_frictions_within_its_estimate(mu: float) -> None:
    """With 0.6 it comes to its stop along the slope smoothly."""
    compiled = lagc.load("thrown_across").compile(backend="c")
    run = compiled.simulate(1.2 * _stop(mu), accuracy=1e-9, parameters={"mu": mu})
    assert run.status == "ok" and [event.kind for event in run.events] == ["sticks"]
    assert run.events[0].t == pytest.approx(_stop(mu), abs=1e-9 * max(1.0, _stop(mu)))


@pytest.mark.parametrize("backend", BACKENDS)
def test_with_the_friction_of_the_slope_it_ends_straight_down(backend: str) -> None:
    run = lagc.load("thrown_across").compile(backend=backend, scene="ends_straight").simulate(accuracy=1e-8)
    x = np.array(run.x)
    assert not run.events
    assert np.hypot(x[:, 3], x[:, 4]) - x[:, 4] * -1.0 == pytest.approx(3.0 + 2.0 * x[:, 4], abs=1e-7)


@pytest.mark.parametrize(("scene", "r", "mu", "v", "w"), [
    ("masse", 0.028, 0.2, 2.0, (-60.0, -40.0)),
    pytest.param("bowling", 0.11, 0.1, 8.0, (30.0, 20.0), marks=pytest.mark.full),
])  # fmt: skip
def test_a_ball_with_spin_slips_on_a_parabola_and_rolls(
    scene: str, r: float, mu: float, v: float, w: tuple[float, float]
) -> None:
    """It rolls after 2/7 |u|/(mu g), with v - 2/7 u; its slip keeps its direction."""
    run = lagc.load("billiard").compile(backend="c", scene=scene).simulate(accuracy=1e-8)
    slip = np.array([v - r * w[1], r * w[0]])
    speed = math.hypot(*slip)
    (rolls,) = run.events
    assert rolls.kind == "sticks" and rolls.t == pytest.approx(2.0 / 7.0 * speed / (mu * G), abs=1e-9)
    final = np.array([v, 0.0]) - 2.0 / 7.0 * slip
    assert [run.final["der(x)"], run.final["der(y)"]] == pytest.approx(final, abs=1e-8)
    t, end = rolls.t, run.t[-1]
    path = np.array([v, 0.0]) * t - 0.5 * mu * G * slip / speed * t**2 + final * (end - t)
    assert [run.final["x"], run.final["y"]] == pytest.approx(path, abs=1e-7)


@pytest.mark.parametrize(
    "law", ["at = block", "slip = velocity(block)", "slip = {der(y), cos(a)*der(x) + sin(a)*der(z)}"]
)
def test_ways_to_write_a_slip_on_a_slope(law: str) -> None:
    """z >= x tan(a) is no distance: the push along the gap is cos(a) of the normal force."""
    mu = "mu/cos(a)" if "der" in law else "mu"  # of the normal force
    text = f"""  parameter Angle a = 30 [deg];
  parameter Real mu = 0.7;
  constraint slope: z >= tan(a)*x (friction = {mu}, {law});
  initial
    der(y) = 3 [m/s];"""
    run = _model(text, stop="1.6 [s]").compile(backend="numpy").simulate(rtol=1e-7)
    (stops,) = run.events
    assert stops.kind == "sticks" and stops.t == pytest.approx(_stop(0.7), abs=1e-6)


def test_a_place_in_a_plane_motion_has_one_slip() -> None:
    """A ball that is thrown rolls after 2/7 v/(mu g), with 5/7 of its speed."""
    text = """model M
  coordinate Length x(rate = 8 [m/s]), y(start = 0.11 [m]);
  coordinate Angle phi;
  Gravity field(g = 9.81 [m/s2], direction = {0, -1, 0});
  point C = {x, y, 0};
  body ball = Solid(mass = 7 [kg], inertia = 2/5*7 [kg]*0.0121 [m2]*{1, 1, 1}, frame = rotate_z(world, phi),
    com = C);
"""
    lane = "  constraint lane: C.y >= 0.11 [m] (friction = 0.1, on = ball, at = C - 0.11 [m]*world.y);"
    compiled = _model(lane, text, "3 [s]").compile(backend="numpy")
    run = compiled.simulate(rtol=1e-8)
    (rolls,) = run.events
    assert rolls.kind == "sticks" and rolls.t == pytest.approx(2.0 / 7.0 * 8.0 / (0.1 * G), abs=1e-9)
    assert run.final["der(x)"] == pytest.approx(40.0 / 7.0, rel=1e-9)


@pytest.mark.parametrize(
    ("angle", "pull", "slides"), [(0.3, 0.2999, False), (0.3, 0.3001, True), (2.0, 0.3001, True)]
)
def test_static_friction_holds_in_every_direction(angle: float, pull: float, slides: bool) -> None:
    force = [pull * 2.0 * G * math.cos(angle), pull * 2.0 * G * math.sin(angle)]
    text = f"""  force F = {{{force[0]}, {force[1]}, 0}} on block at {{x, y, z}};
  constraint floor: z >= 0 (friction = 0.25, static = 0.3, at = block);"""
    run = _model(text).compile(backend="numpy").simulate(rtol=1e-8)
    way = (pull - 0.25) * G / 2.0 if slides else 0.0
    expected = [way * math.cos(angle), way * math.sin(angle)]
    assert [run.final["x"], run.final["y"]] == pytest.approx(expected, abs=1e-7)


@pytest.mark.full
def test_a_pull_that_turns_and_grows_lets_a_block_slip_against_its_friction() -> None:
    """It slips where the pull reaches mu_s m g, in the direction of the pull there."""
    text = """  parameter Force F0 = 2*0.3*9.81 [N];
  force F = F0*time/(0.5 [s])*{cos(1 [rad/s]*time), sin(1 [rad/s]*time), 0} on block at {x, y, z};
  constraint floor: z >= 0 (friction = 0.2, static = 0.3, at = block);"""
    run = _model(text, stop="0.5001 [s]").compile(backend="numpy").simulate(rtol=1e-9)
    (slips,) = run.events
    assert slips.kind == "slips" and slips.t == pytest.approx(0.5, abs=1e-9)
    assert math.atan2(run.final["der(y)"], run.final["der(x)"]) == pytest.approx(0.5, abs=1e-3)


@pytest.mark.full
def test_a_slip_under_a_pull_that_turns_needs_static_friction() -> None:
    """m u' = F - mu m g u/|u|. With mu_s = mu it begins without a rate: a run says what to write."""
    text = """  parameter Real mu_s = 0.3;
  force F = 0.6*9.81 [N]*time/(0.5 [s])*{cos(1 [rad/s]*time), sin(1 [rad/s]*time), 0} on block at {x, y, z};
  constraint floor: z >= 0 (friction = 0.3, static = mu_s, at = block);"""
    compiled = _model(text, stop="0.8 [s]").compile(backend="c")
    run = compiled.simulate(accuracy=1e-8, parameters={"mu_s": 0.303})
    assert run.status == "ok" and run.events[0].t == pytest.approx(0.505, abs=1e-9)

    def rates(t: float, u: Any) -> Any:
        pull = 0.6 * G * t * np.array([math.cos(t), math.sin(t)])
        return pull - 0.3 * G * u / np.hypot(*u)

    start = 1e-12 * np.array([math.cos(0.505), math.sin(0.505)])
    exact = solve_ivp(rates, (0.505, 0.8), start, "Radau", rtol=1e-10, atol=1e-14).y[:, -1]
    assert [run.final["der(x)"], run.final["der(y)"]] == pytest.approx(exact, abs=1e-7)
    fails = compiled.simulate(accuracy=1e-8)
    assert fails.status == "failed" and "`static`" in fails.message and "radau5" not in fails.message


@pytest.mark.parametrize("backend", BACKENDS)
def test_an_impact_takes_the_slip_along_its_direction(backend: str) -> None:
    """A block falls on a rough floor: it loses mu of the impulse, in the direction of its slip."""
    text = """  constraint floor: z >= 0 (restitution = 0.5, friction = 0.2, at = block);
  initial
    z = 1 [m];
    der(x) = 3 [m/s];
    der(y) = -4 [m/s];"""
    run = _model(text, stop="0.6 [s]").compile(backend=backend).simulate(rtol=1e-9)
    (hit,) = run.events
    lost = 0.2 * 1.5 * math.sqrt(2.0 * G)
    assert hit.kind == "impact" and hit.impulse == pytest.approx(2.0 * 1.5 * math.sqrt(2.0 * G), rel=1e-9)
    assert [run.final["der(x)"], run.final["der(y)"]] == pytest.approx(
        [3.0 * (1.0 - lost / 5.0), -4.0 * (1.0 - lost / 5.0)], rel=1e-9
    )


def test_the_reaction_of_a_body_is_push_and_friction() -> None:
    text = """  constraint floor: z >= 0 (friction = 0.3, at = block);
  output Force R[3] = reaction(block);
  initial
    der(x) = 3 [m/s];
    der(y) = 4 [m/s];"""
    run = _model(text, stop="0.1 [s]").compile(backend="numpy").simulate(rtol=1e-8)
    weight = 2.0 * G
    found = [run.final[f"R[{k}]"] for k in (1, 2, 3)]
    assert found == pytest.approx([-0.18 * weight, -0.24 * weight, weight], rel=1e-12)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [("friction = 0.3", "`friction` needs `slip` or `at`"),
     ("at = block", "`at` needs `friction`"),
     ("friction = 0.3, on = block", "`on` needs `at`"),
     ("friction = 0.3, slip = {der(x), der(y)}, at = block", "two ways to say the same"),
     ("friction = 0.3, slip = {der(x), der(y), der(x), der(z)}", "the slip has 4 components"),
     ("friction = 0.3, slip = {der(x), 1 [m/s]}", "component 2 of the slip is no velocity"),
     ("friction = 0.3, slip = {der(x), y}", "different dimensions"),
     ("friction = 0.3, slip = {x, y}", "[m/s]"),
     ("friction = 0.3, at = {x, y, x}", "does not show the direction of its surface"),
     ("friction = 0.3, at = world", "a vector"),
     ("friction = -0.3, at = block", "the friction is -0.3")],
)  # fmt: skip
def test_what_makes_no_sense_is_refused(arguments: str, message: str) -> None:
    with pytest.raises(Refused) as found:
        _model(f"  constraint floor: z >= 0 ({arguments});").compile(backend="numpy")
    texts = [f"{fault.message} {fault.remedy}" for fault in found.value.faults]
    assert any(message in text for text in texts), texts


FEET = [(0.3, 0.0, -0.1), (-0.2, 0.25, -0.1), (-0.2, -0.25, -0.1), (0.0, 0.0, 0.2)]


def _tetrahedron(feet: list[tuple[float, float, float]], spin: float) -> lagc.ModelFile:
    text = f"""model M
  coordinate Length x(rate = 1 [m/s]), y(rate = 0.5 [m/s]), z(start = 0.3 [m]);
  coordinate Orientation o(rate = {{0.5, 0.3, {spin}}} [rad/s]);
  Gravity field(g = 9.81 [m/s2], direction = {{0, 0, -1}});
  frame F = rotate(world, o);
  point C = {{x, y, z}};
  body box = Solid(mass = 1 [kg], inertia = {{0.02, 0.025, 0.03}}, frame = F, com = C);
"""
    for i, (a, b, c) in enumerate(feet):
        text += f"  point P{i} = C + {a} [m]*F.x + {b} [m]*F.y + {c} [m]*F.z;\n"
        text += f"  constraint c{i}: P{i}.z >= 0 (friction = 0.4, restitution = 0.2, at = P{i});\n"
    return _model("  output Energy E = energy();", text, "3 [s]")


@pytest.mark.full
@pytest.mark.parametrize("spin", [-2.0, 1.0, 4.0])
def test_a_tetrahedron_thrown_on_a_rough_floor_loses_energy_and_rests(spin: float) -> None:
    run = _tetrahedron(FEET, spin).compile(backend="c").simulate(rtol=1e-8, points=301)
    energy = np.array(run["E"])
    assert run.status == "ok" and len(run.events) > 3 and np.max(np.diff(energy)) < 1e-7
    assert energy[-1] == pytest.approx(9.81 * 0.1, abs=1e-6)
    assert np.max(np.abs(np.array(run.x)[-1, 7:13])) < 1e-9


PLATE = [(0.3, 0.2, -0.1), (-0.3, 0.2, -0.1), (0.3, -0.2, -0.1), (-0.3, -0.2, -0.1)]


@pytest.mark.full
def test_a_plate_that_turns_on_four_feet_stops_as_if_each_bore_a_quarter() -> None:
    """Its weight is shared in many ways, and friction turns it by the share: the smallest forces are taken.
    About its middle it turns with omega - mu g r t m/I, where r is the distance of a foot."""
    thrown = "x(rate = 1 [m/s]), y(rate = 0.5 [m/s]), z(start = 0.3 [m])"
    text = _tetrahedron(PLATE, 4.0).source.text.replace(thrown, "x, y, z(start = 0.1 [m])")
    run = lagc.loads(text.replace("0.5, 0.3, 4", "0, 0, 4")).compile(backend="c").simulate(0.2, accuracy=1e-7)
    expected = 4.0 * 0.03 / (0.4 * G * math.hypot(0.3, 0.2))
    assert run.status == "ok" and [e.t for e in run.events] == pytest.approx([expected] * 4, abs=1e-9)


@pytest.mark.full
@pytest.mark.parametrize("spin", [-6.0, 4.0])
def test_a_plate_that_slides_and_turns_on_four_feet_loses_energy_and_rests(spin: float) -> None:
    run = _tetrahedron(PLATE, spin).compile(backend="c").simulate(accuracy=1e-6, points=301)
    energy = np.array(run["E"])
    assert run.status == "ok" and np.max(np.diff(energy)) < 1e-7
    assert energy[-1] == pytest.approx(0.981, abs=1e-6)
    assert [run.final[f"c{i}"] for i in range(4)] == [2.0] * 4
