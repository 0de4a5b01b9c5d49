"""Mechanisms with joints against closed forms and against models with coordinates of their own."""

import math
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import lagc
from lagc.api import Run
from lagc.diagnostics.faults import Refused

ARM = """model Arm
  body upper = Solid(mass = 1 [kg], inertia = {{1, 1, 1}} [kg.m2], com = {{0, 0, -0.5}} [m]);
  body lower = Solid(mass = 1 [kg], inertia = {{1, 1, 1}} [kg.m2], com = {{0, 0, -1.5}} [m]);
  {lines}
end Arm;
"""
SHOULDER = "joint shoulder = Revolute(world, upper, axis = world.y, at = {0, 0, 0});"
ELBOW = "joint elbow = Revolute(upper, lower, axis = world.y, at = {0, 0, -1} [m]);"


def _run(name: str, stop: float, **options: object) -> Run:
    run = lagc.load(name).compile().simulate(stop, accuracy=1e-9, points=21, **options)
    assert run.status == "ok", run.message
    return run


def test_slider_crank_moves_as_with_its_own_coordinates() -> None:
    joints, own = _run("slider_crank_joints", 0.1), _run("classic/slider_crank", 0.1)
    assert joints["main.angle"] == pytest.approx(own["phi"], rel=1e-8)
    assert joints["guide.slide"] + 0.2 == pytest.approx(own["s"], rel=1e-8)
    size = max(abs(own["Px"]))
    assert joints["P[1]"] == pytest.approx(own["Px"], abs=1e-6 * size)
    assert joints["P[2]"] == pytest.approx(own["Py"], abs=1e-6 * size)


def test_universal_joint_turns_unevenly() -> None:
    run = _run("universal_joint", 1.0)
    b, phi = math.radians(30.0), run["phi"]
    assert "outlet.angle" not in run.state_names  # it closes the loop
    rate = run["der(bearing.angle)"]
    expected = rate * math.cos(b) / (1.0 - (math.sin(b) * np.sin(phi)) ** 2)
    assert run["turning"] == pytest.approx(expected, rel=1e-7)


def test_planet_turns_faster_than_its_arm() -> None:
    run = _run("planetary_gear", 2.0)
    M, J, m, own, R, r = 0.3, 0.05, 2.0, 0.01, 0.2, 0.1
    acceleration = M / (J + m * (R + r) ** 2 + own * (1.0 + R / r) ** 2)
    assert run.final["der(carrier.angle)"] == pytest.approx(acceleration * 2.0, rel=1e-8)
    assert run.final["planet_speed"] == pytest.approx((1.0 + R / r) * acceleration * 2.0, rel=1e-8)
    planet = own * (1.0 + R / r) * acceleration  # the mesh turns the planet by the force planet/r on the sun
    assert run.final["on_housing"] == pytest.approx(-planet / r * R, rel=1e-8)


def test_rack_swings_on_its_spring() -> None:
    run = _run("rack_and_pinion", 1.0)
    r, m, J, k, M = 0.03, 1.5, 2e-3, 400.0, 0.6
    w = math.sqrt(k / (m + J / r**2))
    exact = M / (r * k) * (1.0 - np.cos(w * np.array(run.t)))
    assert run["x"] == pytest.approx(exact, abs=1e-9)
    push = k * exact + m * (M / r - k * exact) / (m + J / r**2)
    assert run["push"] == pytest.approx(push, rel=1e-7)


def test_gyroscope_nods_in_its_gimbals() -> None:
    """Its equation for the dip alone, with the momenta of spin and about the vertical."""
    run = _run("gyroscope_in_gimbals", 0.2)
    own, inner, outer, m, d = 1.2e-3, 3e-4, 4e-4, 0.1, 0.08
    across, spin = own + m * d * d, 2e-3 * 200.0

    def rates(t: float, y: Any) -> list[float]:
        s, c = math.sin(y[0]), math.cos(y[0])
        turn = spin * s / (outer + inner + across * c * c)
        return [y[1], (m * 9.81 * d - spin * turn - across * turn**2 * s) * c / (across + inner), turn]

    exact = solve_ivp(
        rates, (0.0, 0.2), [0.0] * 3, "DOP853", t_eval=run.t, max_step=1e-3, rtol=1e-12, atol=1e-14
    ).y
    assert run["dip"] == pytest.approx(exact[0], abs=1e-9)
    assert run["post.angle"] == pytest.approx(exact[2], abs=1e-9)


def test_coin_rolls_as_with_its_own_coordinates() -> None:
    joints, own = _run("rolling_coin", 2.0), _run("rolling_disc", 2.0)
    for name in ("x", "y", "z", "E"):
        assert joints[name] == pytest.approx(own[name], rel=1e-7, abs=1e-8)


def test_screw_advances() -> None:
    text = """model Press
  body screw = Solid(mass = 2 [kg], inertia = {0.3, 0.3, 0.1} [kg.m2], com = {0, 0, 0});
  joint nut = Screw(world, screw, axis = world.z, at = {0, 0, 0}, pitch = 0.5 [m]);
  effect gravity
    Gravity field;
  end gravity;
  scene lab uses gravity;
  output Length z = screw.position.z;
end Press;
"""
    run = lagc.loads(text).compile(backend="numpy").simulate(1.0, accuracy=1e-9, points=2)
    c = 0.5 / (2.0 * math.pi)  # m per radian: (m c^2 + I) angle'' = -m g c
    assert run.final["z"] == pytest.approx(-0.5 * c * 2.0 * 9.81 * c / (2.0 * c * c + 0.1), rel=1e-8)


def test_rack_moves_with_its_pinion() -> None:
    text = """model Rack
  body pinion = Solid(mass = 2 [kg], inertia = {0.3, 0.3, 0.1} [kg.m2], com = {0, 0, 0});
  body rack = Particle(mass = 3 [kg], at = {0, 0.2, 0} [m]);
  joint axle = Revolute(world, pinion, axis = world.z, at = {0, 0, 0});
  joint guide = Prismatic(world, rack, axis = world.x);
  joint mesh = RackAndPinion(axle, guide, radius = -0.2 [m]);
  torque motor = 0.6 [N.m]*world.z on pinion;
  output Force push = reaction(mesh);
end Rack;
"""
    final = lagc.loads(text).compile(backend="numpy").simulate(1.0, accuracy=1e-9, points=2).final
    turn = 0.6 / (0.1 + 3.0 * 0.2**2)
    assert final["der(guide.slide)"] == pytest.approx(-0.2 * turn, rel=1e-9)
    assert abs(final["push"]) == pytest.approx(3.0 * 0.2 * turn, rel=1e-9)


def test_distance_is_a_massless_rod() -> None:
    text = """model Rod
  body a = Particle(mass = 2 [kg], at = {0, 0, 0});
  body b = Particle(mass = 1 [kg], at = {0, 0, -1} [m]);
  joint rail = Prismatic(world, a, axis = world.x);
  joint sheet = Planar(world, b, axis = world.y, at = {0, 0, -1} [m], along = world.x, y(start = 0));
  joint rod = Distance(a, b, at = {0, 0, 0}, to = {0, 0, -1} [m]);
  constraint plain: sheet.angle = 0;
  effect gravity
    Gravity field;
  end gravity;
  scene lab uses gravity
    start der(sheet.x) = 1 [m/s];
    start der(rail.slide) = 0;
  end lab;
  output Length far = norm(position(b) - position(a));
  output Force tension = -reaction(rod);
  output Momentum p = momentum().x;
end Rod;
"""
    run = lagc.loads(text).compile(backend="numpy").simulate(1.0, accuracy=1e-9, points=5)
    assert run["far"] == pytest.approx(1.0, rel=1e-12)
    assert run["p"] == pytest.approx(1.0, rel=1e-8)
    assert run["tension"][0] == pytest.approx(9.81 + 1.0, rel=1e-9)  # hanging, with relative speed 1 m/s


def test_joint_may_be_written_from_either_side() -> None:
    other = ELBOW.replace("upper, lower", "lower, upper")
    starts = (
        "effect gravity\n Gravity field;\n end gravity;\n"
        " scene s uses gravity\n start elbow.angle = {};\n end s;"
    )
    found = []
    for elbow, start in ((ELBOW, 0.7), (other, -0.7)):
        text = ARM.format(lines="\n".join((SHOULDER, elbow, starts.format(start))))
        found.append(lagc.loads(text).compile(backend="numpy").simulate(1.0, accuracy=1e-9, points=2).final)
    assert found[0]["shoulder.angle"] == pytest.approx(found[1]["shoulder.angle"], rel=1e-8)
    assert found[0]["elbow.angle"] == pytest.approx(-found[1]["elbow.angle"], rel=1e-8)


def test_chain_in_a_loop_moves_as_with_angles_from_the_vertical() -> None:
    field = "effect gravity\n Gravity field;\n end gravity;\n scene lab uses gravity;\n"
    joints = f"""model Joints
  structural Integer n = 3;
  body bob[1] = Particle(mass = 1 [kg], at = {{0, 0, -1}} [m]);
  joint pin[1] = Revolute(world, bob[1], axis = world.y, at = {{0, 0, 0}});
  for i in 2:n loop
    body bob[i] = Particle(mass = 1 [kg], at = {{0, 0, -i}} [m]);
    joint pin[i] = Revolute(bob[i - 1], bob[i], axis = world.y, at = {{0, 0, 1 - i}} [m]);
  end for;
  {field}
  output Length x = bob[n].position.x, z = bob[n].position.z;
end Joints;
"""
    angles = f"""model Angles
  structural Integer n = 3;
  coordinate Angle a[n];
  point P[0] = {{0, 0, 0}};
  for i in 1:n loop
    point P[i] = P[i - 1] - {{sin(a[i]), 0, cos(a[i])}}*(1 [m]);
    body bob[i] = Particle(mass = 1 [kg], at = P[i]);
  end for;
  {field}
  output Length x = P[n].x, z = P[n].z;
end Angles;
"""
    starts = (
        {"pin[1].angle": 0.3, "pin[2].angle": 0.5, "pin[3].angle": -0.2, "der(pin[2].angle)": 1.0},
        {"a[1]": 0.3, "a[2]": 0.8, "a[3]": 0.6, "der(a[2])": 1.0, "der(a[3])": 1.0},
    )
    one, two = (
        lagc.loads(text).compile(backend="numpy").simulate(1.0, accuracy=1e-10, points=5, starts=given)
        for text, given in zip((joints, angles), starts)
    )
    for name in ("x", "z"):
        assert one[name] == pytest.approx(two[name], abs=1e-8)


@pytest.mark.parametrize(
    ("lines", "code"),
    [
        ("joint j = Revolute(upper, upper, axis = world.y, at = {0, 0, 0});", "LAG0233"),
        ("joint j = Revolute(upper, lower, axis = world.y, at = {0, 0, 0});", "LAG0233"),  # not to the world
        ("joint j = Hinge(world, upper, axis = world.y, at = {0, 0, 0});", "LAG0233"),
        ("joint j = Revolute(world, nobody, axis = world.y, at = {0, 0, 0});", "LAG0201"),
        ("joint j = Revolute(world, upper, axis = {0, 0, 0}, at = {0, 0, 0});", "LAG0309"),
        ("joint j = Revolute(world, upper, at = {0, 0, 0});", "LAG0210"),
        ("joint j = Revolute(world, upper, axis = world.y, at = {0, 0, 0}, start = 1);", "LAG0209"),
        (
            "joint j = Revolute(world, upper, axis = world.y, at = {0, 0, 0}, angle(start = 1 [m]));",
            "LAG0302",
        ),
        (f"{SHOULDER} {ELBOW} joint j = Weld(world, lower); output Angle a = j.angle;", "LAG0206"),
        (f"{SHOULDER} {ELBOW} joint j = Gear(shoulder, lower, ratio = 2);", "LAG0233"),
        (f"{SHOULDER} {ELBOW} joint j = RackAndPinion(shoulder, elbow, radius = 2 [m]);", "LAG0233"),
        (f"{SHOULDER} {ELBOW} output Length x = attached(world, {{0, 0, 0}}).x;", "LAG0221"),
        ("joint Revolute j(axis = world.y);", "LAG0221"),
    ],
)
def test_refusals(lines: str, code: str) -> None:
    with pytest.raises(Refused) as caught:
        lagc.loads(ARM.format(lines=lines)).compile(backend="numpy")
    assert code in [fault.code for fault in caught.value.faults], caught.value
    assert all(fault.span is not None for fault in caught.value.faults)


def test_open_and_closing_joints_are_told() -> None:
    text = ARM.format(lines=f"{SHOULDER} {ELBOW} joint shut = Weld(world, lower);")
    shoulder, elbow, shut = lagc.loads(text).compile(backend="numpy").model.joints
    assert (shoulder.kind, shoulder.between) == ("Revolute", ("world", "upper"))
    assert (shoulder.coordinates, elbow.coordinates) == (("shoulder.angle",), ("elbow.angle",))
    assert shut.equations and not shut.coordinates


def test_a_body_with_coordinates_of_its_own_carries_others() -> None:
    field = "effect gravity\n Gravity field;\n end gravity;\n"
    data = "mass = 1 [kg], inertia = {0.1, 0.2, 0.15} [kg.m2]"
    joints = f"""model Joints
  coordinate Length x;
  body cart = Particle(mass = 2 [kg], at = {{x, 0, 0}});
  body pole = Solid({data}, com = {{0, 0, 0.5}} [m]);
  joint j = Revolute(cart, pole, axis = world.y, at = {{0, 0, 0}});
  {field} scene lab uses gravity
    start j.angle = 0.3;
  end lab;
  output Length tip = attached(pole, {{0, 0, 1}} [m]).x, hook = attached(cart, {{0, 0, 0}}).x - x;
end Joints;
"""
    own = f"""model Own
  coordinate Length x;
  coordinate Angle a(start = 0.3);
  body cart = Particle(mass = 2 [kg], at = {{x, 0, 0}});
  frame P = rotate_y(world, a);
  point H = {{x, 0, 0}};
  body pole = Solid({data}, frame = P, com = H + 0.5 [m]*P.z);
  {field} scene lab uses gravity;
  output Length tip = (H + 1 [m]*P.z).x;
end Own;
"""
    one, two = (
        lagc.loads(text).compile(backend="numpy").simulate(1.0, accuracy=1e-10, points=5)
        for text in (joints, own)
    )
    assert one["tip"] == pytest.approx(two["tip"], abs=1e-9)
    assert not one["hook"].any()


def test_a_turning_body_carries_an_arm_and_keeps_the_angular_momentum() -> None:
    text = """model Base
  coordinate Orientation o(rate = {0.1, 0.2, 1} [rad/s]);
  frame B = rotate(rotate_x(world, 30 [deg]), o);
  body base = Solid(mass = 5 [kg], inertia = {1, 1.2, 1.5} [kg.m2], frame = B, com = {0, 0, 0});
  body arm = Solid(mass = 1 [kg], inertia = {0.1, 0.1, 0.1} [kg.m2], com = {1, 0, 0} [m]);
  joint j = Revolute(base, arm, axis = world.z, at = {0.5, 0, 0} [m], angle(rate = 0.3 [rad/s]));
  output AngularMomentum H[3] = angular_momentum();
  output Energy E = energy();
  output Length far = norm(attached(arm, {0.5, 0, 0} [m]) - attached(base, {0.5, 0, 0} [m]));
end Base;
"""
    run = lagc.loads(text).compile(backend="numpy").simulate(2.0, accuracy=1e-9, points=5)
    for name in ("H[1]", "H[2]", "H[3]", "E"):
        assert run[name] == pytest.approx(run[name][0], rel=1e-7, abs=1e-8)
    assert max(abs(run["far"])) < 1e-14


def test_an_axis_of_parameters_needs_a_direction_across_it() -> None:
    """Without `along`, the directions across the axis would depend on the numbers of the parameters."""
    hinge = """model Hinge
  parameter Real u = 1, v = 2, w = 2;
  body plate = Solid(mass = 2 [kg], inertia = {1, 1, 1} [kg.m2], com = {0.3, 0, 0} [m]);
  joint upper = Revolute(world, plate, axis = {u, v, w}, at = {0, 0, 0}, angle(rate = 1 [rad/s]) MORE);
end Hinge;
"""
    with pytest.raises(Refused, match="`along`"):
        lagc.loads(hinge.replace("MORE", "")).compile(backend="numpy")
    run = lagc.loads(hinge.replace("MORE", ", along = {2, -1, 0}")).compile(backend="numpy").simulate(1.0)
    assert run.status == "ok" and run.final["upper.angle"] == pytest.approx(1.0, rel=1e-6)
