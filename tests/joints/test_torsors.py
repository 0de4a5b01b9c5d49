"""Torsors of joints and loads, and generalized forces of actions, in outputs.

Truths: Euler's second law of each body about the origin, by differences of its angular momentum; the power of
an action as the sum of its generalized forces times the rates; closed forms.
"""

import re
from typing import Any

import numpy as np
import pytest

import lagc
from lagc.diagnostics.faults import Refused
from lagc.host import model_library

H = 1e-4  # s between recorded points: differences of the fourth order are exact to about 1e-9


def run_with(text: str, outputs: str) -> Any:
    text = re.sub(r"\nend (\w+);\s*$", rf"\n{outputs}\nend \1;\n", text.rstrip() + "\n")
    return lagc.loads(text).compile(backend="numpy").simulate(40 * H, points=41, method="dop853", rtol=1e-12)


def slope(column: Any) -> Any:
    """The derivative at all points but two at each end, by differences of the fourth order."""
    x = np.asarray(column)
    return (x[:-4] - 8.0 * x[1:-3] + 8.0 * x[3:-1] - x[4:]) / (12.0 * H)


# the joints of each body with the sign of what they do to it, by model
LINKS = {
    "slider_crank_joints": {"crank": "+main -crankpin", "rod": "+crankpin -pin"},
    "universal_joint": {"input_shaft": "+bearing -cross_piece", "output_shaft": "+cross_piece +outlet"},
}
TUBE = """model Tube
  body arm = Solid(mass = 1 [kg], inertia = {0.1, 0.2, 0.3} [kg.m2], com = {0.3, 0, 0} [m]);
  body tube = Solid(mass = 2 [kg], inertia = {0.2, 0.1, 0.2} [kg.m2], com = {1, 0.2, 0.1} [m]);
  joint bearing = Revolute(world, arm, axis = world.z, at = {0, 0, 0}, angle(rate = 3 [rad/s]));
  joint knuckle = Spherical(arm, tube, at = {1, 0, 0} [m]);
  joint sleeve = PointOnLine(world, tube, axis = world.y, at = {1, 0.5, 0} [m]);
  torque spring = -0.5 [N.m]*world.z on arm;
end Tube;
"""


def euler(text: str, links: dict[str, str], torques: dict[str, str]) -> None:
    outputs = []
    for body, joints in links.items():
        terms = [f"{name[0]} torsor({name[1:]}, at = {{0, 0, 0}})" for name in joints.split()]
        for part in ("force", "moment"):
            total = " ".join([f"{term}.{part}" for term in terms])
            unit = "Torque" if part == "moment" else "Force"
            extra = f" + {torques[body]}" if part == "moment" and body in torques else ""
            outputs.append(f"  output {unit} {part}_{body}[3] = {total}{extra};")
        outputs.append(f"  output AngularMomentum spin_{body}[3] = angular_momentum({body});")
        outputs.append(f"  output Momentum way_{body}[3] = momentum({body});")
    run = run_with(text, "\n".join(outputs))
    for body in links:
        for part, momentum in (("moment", "spin"), ("force", "way")):
            for k in (1, 2, 3):
                found = np.asarray(run[f"{part}_{body}[{k}]"])[2:-2]
                size = 1.0 + np.abs(found).max()
                assert np.abs(found - slope(run[f"{momentum}_{body}[{k}]"])).max() <= 1e-6 * size, (
                    body,
                    part,
                    k,
                )


@pytest.mark.parametrize("name", LINKS)
def test_eulers_law_of_each_body(name: str) -> None:
    euler(model_library.read(name).text, LINKS[name], {})


SLIDE = """model Slide
  body block = Solid(mass = 1 [kg], inertia = {0.1, 0.2, 0.3} [kg.m2], com = {0.3, 0.2, 0.1} [m]);
  body arm = Solid(mass = 2 [kg], inertia = {0.2, 0.1, 0.2} [kg.m2], com = {0.3, 0.7, 0.1} [m]);
  body far = Solid(mass = 1 [kg], inertia = {0.1, 0.2, 0.3} [kg.m2], com = {0.8, 0.7, 0.4} [m]);
  joint rail = Prismatic(world, block, axis = world.x, slide(rate = 2 [m/s]));
  joint pivot = Universal(block, arm, axis = world.z, at = {0.3, 0.4, 0.1} [m], along = world.x,
    angle1(rate = 4 [rad/s]));
  joint tube = Cylindrical(arm, far, axis = world.y, at = {0.6, 0.7, 0.1} [m], angle(rate = 5 [rad/s]));
end Slide;
"""


def test_eulers_law_of_open_joints() -> None:
    """A slide without a point, a cross whose axes turn, a tube that slides."""
    euler(SLIDE, {"block": "+rail -pivot", "arm": "+pivot -tube", "far": "+tube"}, {})


def test_eulers_law_where_a_loop_closes_on_a_line() -> None:
    """The point of the second body moves along the line: the moment is about where it is now."""
    links = {"arm": "+bearing -knuckle", "tube": "+knuckle +sleeve"}
    euler(TUBE, links, {"arm": "torsor(spring, at = {5, 0, 0} [m]).moment"})


PENDULUM = """model P
  parameter Mass m = 2 [kg];
  parameter Length l = 0.5 [m];
  coordinate Angle a(start = 1 [rad], rate = 2 [rad/s]), b(start = 0.5 [rad]);
  SPEEDS
  point A = l*{sin(a), 0, -cos(a)};
  body p = Particle(mass = m, at = A);
  body q = Particle(mass = m, at = A + l*{sin(b), 0, -cos(b)});
  Gravity field;
  force drag = -0.1 [kg/m]*norm(velocity(q))*velocity(q) at q;
  force wind = {3, 0, 1} [N] at A;
  potential spring = 1/2*40 [N/m]*norm(position(q))^2;
  dissipation oil = 1/2*0.2 [N.m.s]*(der(a) - der(b))^2;
  frame F = rotate_y(world, b);
  torque motor = {0, 0.7, 0} [N.m] on F;
  lagrangian tide = 0.3 [N.m]*sin(a)*cos(b);
end P;
"""
ACTIONS = ("field", "drag", "wind", "spring", "oil", "motor", "tide")


@pytest.mark.parametrize("speeds", ["", "speed AngularVelocity u = der(a) + der(b), w = der(a) - der(b);"])
def test_power_is_that_of_the_generalized_forces(speeds: str) -> None:
    outputs = [
        f"  output Torque {x}_a = generalized_force({x}, a), {x}_b = generalized_force({x}, b);\n"
        f"  output Power P_{x} = power({x});\n"
        f"  output AngularVelocity da_{x} = der(a), db_{x} = der(b);"
        for x in ACTIONS
    ]
    run = run_with(PENDULUM.replace("SPEEDS", speeds), "\n".join(outputs))
    for x in ACTIONS:
        a, b, power = (np.asarray(run[name]) for name in (f"{x}_a", f"{x}_b", f"P_{x}"))
        found = a * np.asarray(run[f"da_{x}"]) + b * np.asarray(run[f"db_{x}"])
        assert np.abs(found - power).max() <= 1e-12 * (1.0 + np.abs(power).max())
    first, second = np.asarray(run["a"]), np.asarray(run["b"])
    assert np.abs(np.asarray(run["field_a"]) + 2 * 2 * 9.81 * 0.5 * np.sin(first)).max() < 1e-12
    assert np.abs(np.asarray(run["wind_a"]) - 0.5 * (3 * np.cos(first) + np.sin(first))).max() < 1e-12
    assert np.abs(np.asarray(run["motor_a"])).max() == 0.0 and np.ptp(np.asarray(run["motor_b"])) == 0.0
    assert np.abs(np.asarray(run["tide_b"]) + 0.3 * np.sin(first) * np.sin(second)).max() < 1e-12


def test_the_moment_of_a_load_moves_with_the_point() -> None:
    run = run_with(
        PENDULUM.replace("SPEEDS", ""),
        "  output Torque M[3] = torsor(wind, at = {1, 2, 3} [m]).moment;\n"
        "  output Force R[3] = torsor(wind, at = q).force;\n  output Length x = A.x, z = A.z;",
    )
    arm = np.stack(
        [np.asarray(run["x"]) - 1.0, 0.0 * np.asarray(run["x"]) - 2.0, np.asarray(run["z"]) - 3.0], 1
    )
    moment = np.stack([np.asarray(run[f"M[{k}]"]) for k in (1, 2, 3)], 1)
    assert np.abs(moment - np.cross(arm, [3.0, 0.0, 1.0])).max() < 1e-14
    assert [run.final[f"R[{k}]"] for k in (1, 2, 3)] == [3.0, 0.0, 1.0]


@pytest.mark.parametrize(
    ("output", "words"),
    [
        ("Torque x = generalized_force(p, a)", "takes a force, torque, potential or dissipation"),
        ("Torque x = generalized_force(drag, 2*a)", "takes a coordinate as its second argument"),
        ("Torque x = generalized_force(lag, a)", "its share is inertial"),
        ("Torque x[3] = torsor(field, at = A).moment", "`torsor` takes a joint, a body, a force or a torque"),
        ("Torque x[3] = torsor(wind, at = 3).moment", "the point of a torsor"),
    ],
)
def test_refused(output: str, words: str) -> None:
    text = PENDULUM.replace("SPEEDS", "lagrangian lag = 0.1 [kg.m2]*der(a)*der(b);")
    with pytest.raises(Refused) as refused:
        lagc.loads(text.replace("end P;", f"  output {output};\nend P;")).compile()
    assert words in str(refused.value)
