"""Dry friction of sleeves, points on lines and planes, and threads, against closed forms and scipy."""

import math
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import lagc
from lagc.api import Run, System
from lagc.diagnostics.faults import Refused

WAYS = [
    (False, "numpy"),
    pytest.param(False, "c", marks=pytest.mark.full),
    pytest.param(True, "numpy", marks=pytest.mark.full),
]
CLOSES = [False, pytest.param(True, marks=pytest.mark.full)]
ENDS = ["world, nut", pytest.param("nut, world", marks=pytest.mark.full)]
G = 9.81
S, C = 0.5, math.cos(math.radians(30.0))


def _system(text: str, backend: str = "numpy", stop: float = 1.0) -> System:
    return lagc.loads(f"""model M
  parameter Real C = cos(30 [deg]), S = sin(30 [deg]), mu = 0.2;
  parameter Torque T = 0 [N.m];
  parameter AngularVelocity w = 3 [rad/s];
  body nut = Solid(mass = 2 [kg], inertia = {{0.004, 0.004, 0.004}} [kg.m2], com = {{0, 0, 0}});
  Gravity field;
  {text}
  scene s
    simulate(stop = {stop} [s]);
  end s;
end M;
""").compile(backend=backend)


def _run(text: str, backend: str = "numpy", stop: float = 1.0) -> Run:
    return _system(text, backend, stop).simulate(accuracy=1e-9)


@pytest.mark.parametrize(("closes", "backend"), WAYS)
def test_a_sleeve_slides_and_turns_against_one_friction(closes: bool, backend: str) -> None:
    """On a sloping rod: mu m g cos(slope) against the slip (u, r w) of its surface."""
    rod = "joint rod = Cylindrical(world, nut, axis = {C, 0, S}, along = world.y, at = {0, 0, 0},"
    if closes:
        text = f"""parameter AngularVelocity W = 40 [rad/s];
  joint free = Free(world, nut, x(rate = -C*(1 [m/s])), z(rate = -S*(1 [m/s])),
    orientation(rate = {{C*W, 0, S*W}}));
  {rod} friction = mu, radius = 0.03 [m]);
  output Velocity u = C*der(free.x) + S*der(free.z);
  output AngularVelocity turn = C*angular_velocity(nut).x + S*angular_velocity(nut).z;"""
    else:
        text = f"""{rod} friction = mu, radius = 0.03 [m], slide(rate = -1 [m/s]), angle(rate = 40 [rad/s]));
  output Velocity u = der(rod.slide);
  output AngularVelocity turn = der(rod.angle);"""
    run = _run(text, backend)

    def motion(t: float, y: Any) -> list[float]:
        push = 0.2 * 2.0 * G * C / math.hypot(y[0], 0.03 * y[1])
        return [-G * S - push * y[0] / 2.0, -push * 0.03**2 * y[1] / 0.004]

    exact = solve_ivp(motion, (0.0, 1.0), [-1.0, 40.0], rtol=1e-11, atol=1e-12).y[:, -1]
    assert [run.final["u"], run.final["turn"]] == pytest.approx(exact, rel=1e-8)
    assert run.status == "ok" and not run.events and run.final["rod"] == 1.0


@pytest.mark.parametrize("ends", ENDS)
def test_a_point_slides_up_a_line_and_back(ends: str) -> None:
    run = _run(f"joint line = PointOnLine({ends}, axis = {{C, 0, S}}, along = world.y, at = {{0, 0, 0}},"
               " friction = mu, slide(rate = 1 [m/s]));")  # fmt: skip
    (turns,) = run.events
    stops = 1.0 / (G * (S + 0.2 * C))
    assert turns.kind == "slips" and turns.t == pytest.approx(stops, abs=1e-11)
    assert run.final["der(line.slide)"] == pytest.approx(-G * (S - 0.2 * C) * (1.0 - stops), abs=1e-9)


@pytest.mark.full
@pytest.mark.parametrize("ends", ["rod, nut", "nut, rod"])
def test_a_bead_on_a_rod_that_turns(ends: str) -> None:
    """The rod pushes with 2 m w u sideways and m g upwards, wherever the joint names it."""
    run = _run("body rod = Solid(mass = 1 [kg], inertia = {0.1, 0.1, 0.1} [kg.m2], com = {0, 0, 0});"
               "joint axle = Revolute(world, rod, axis = world.z, at = {0, 0, 0});"
               f"joint line = PointOnLine({ends}, axis = world.x, at = {{0, 0, 0}}, friction = mu,"
               " slide(start = 0.1 [m], rate = 1 [m/s]));"
               "constraint drive: axle.angle = w*time;")  # fmt: skip

    def motion(t: float, y: Any) -> list[float]:
        return [y[1], 9.0 * y[0] - 0.2 * math.hypot(6.0 * y[1], G)]

    exact = solve_ivp(motion, (0.0, 1.0), [0.1, 1.0], rtol=1e-11, atol=1e-13).y[:, -1]
    assert [run.final["line.slide"], run.final["der(line.slide)"]] == pytest.approx(exact, rel=1e-8)


@pytest.mark.parametrize(("closes", "backend"), WAYS)
def test_a_point_thrown_across_a_sloping_plane_stops(closes: bool, backend: str) -> None:
    free, rate = (
        ("joint free = Free(world, nut, y(rate = 3 [m/s]));", "") if closes else ("", ", x(rate = 3 [m/s])")
    )
    run = _run(f"{free} joint plane = PointOnPlane(world, nut, axis = {{-S, 0, C}}, along = world.y,"
               f" at = {{0, 0, 0}}, friction = 0.7{rate});", backend, 2.0)  # fmt: skip
    (stops,) = run.events
    exact = 0.7 * C * 3.0 / (G * (0.49 * C**2 - S**2))
    assert stops.kind == "sticks" and stops.t == pytest.approx(exact, abs=2e-9)
    assert run.final["plane"] == 2.0


LEAD = 0.02 / (2.0 * math.pi * 0.01)  # its tangent


def _screw(closes: bool, pitch: float = 0.02) -> System:
    guide = "joint guide = Cylindrical(world, nut, axis = world.z, at = {0, 0, 0});" if closes else ""
    return _system(f"""{guide}
  joint thread = Screw(world, nut, axis = world.z, at = {{0, 0, 0}}, pitch = {pitch} [m], friction = mu,
    radius = 0.01 [m]);
  torque drive = T*world.z on nut;
  output AngularVelocity turn = angular_velocity(nut).z;
  output Force load = reaction(thread).force.z;""")


@pytest.mark.parametrize("closes", CLOSES)
def test_a_screw_holds_its_load_where_friction_exceeds_the_lead(closes: bool) -> None:
    """It locks itself if mu > tan(lead) = 0.318, and else comes down as a block on a slope."""
    system, force = _screw(closes), 2.0 * G
    still = system.simulate(accuracy=1e-9, parameters={"mu": 0.33})
    assert still.final["turn"] == 0.0 and still.final["thread"] == 2.0 and not still.events
    falls = system.simulate(accuracy=1e-9, parameters={"mu": 0.31})
    c = 1.0 / math.hypot(1.0, LEAD)
    s = LEAD * c
    # m r tan(lead) a = N (cos + mu sin) - m g,  I a = -N r (sin - mu cos)
    rows = [[2.0 * 0.01 * LEAD, -(c + 0.31 * s)], [0.004, 0.01 * (s - 0.31 * c)]]
    a = np.linalg.solve(rows, [-force, 0.0])[0]
    assert falls.final["turn"] == pytest.approx(a, rel=1e-9)


@pytest.mark.parametrize("closes", CLOSES)
@pytest.mark.parametrize("hand", [1.0, pytest.param(-1.0, marks=pytest.mark.full)])
def test_a_screw_lifts_and_lowers_with_the_torque_of_the_textbook(hand: float, closes: bool) -> None:
    """Steady: T = F r (mu + tan)/(1 - mu tan) upwards, F r (mu - tan)/(1 + mu tan) downwards (Shigley)."""
    system, force = _screw(closes, 0.02 * hand), 2.0 * G
    for up in (1.0, -1.0):
        torque = hand * up * force * 0.01 * (0.4 + up * LEAD) / (1.0 - up * 0.4 * LEAD)
        starts = {"der(guide.angle)" if closes else "der(thread.angle)": hand * up}
        run = system.simulate(accuracy=1e-9, parameters={"mu": 0.4, "T": torque}, starts=starts)
        assert run.final["turn"] == pytest.approx(hand * up, abs=1e-9)
        assert run.final["load"] == pytest.approx(force, rel=1e-9)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("Cylindrical(world, nut, axis = world.z, at = {0, 0, 0}, friction = 0.1)",
         "LAG0235: the friction of a pin needs its `radius` beside it"),
        ("Cylindrical(world, nut, axis = world.z, at = {0, 0, 0}, friction = 0.1, radius = 0 [m])",
         "LAG0235: the radius of a pin is not 0"),
        ("Screw(world, nut, axis = world.z, at = {0, 0, 0}, pitch = 1 [mm], friction = 0.1)",
         "LAG0235: the friction of a thread needs its `radius` beside it"),
        ("Screw(world, nut, axis = world.z, at = {0, 0, 0}, pitch = 1 [mm], friction = 1, radius = -1 [mm])",
         "LAG0235: the radius of a thread is not negative"),
        ("PointOnLine(world, nut, axis = world.x, at = {0, 0, 0}, static = 0.1)",
         "LAG0235: `static` needs `friction` beside it"),
    ],
)  # fmt: skip
def test_wrong_friction_is_refused(text: str, expected: str) -> None:
    with pytest.raises(Refused) as caught:
        _system(f"joint j = {text};")
    (fault,) = caught.value.faults
    assert f"{fault.code}: {fault.message}".startswith(expected)
