"""Reactions by virtual release: multipliers of explicit constraints, and the laws of Newton and Euler."""

import math
import random

import pytest

import lagc
from lagc.diagnostics.faults import Refused

GRAVITY = """
  effect gravity
    Gravity field;
  end gravity;
  scene lab uses gravity;
"""
MASSES = """
  parameter Mass m[2] = {1.3, 0.4} [kg];
  parameter Length l[2] = {0.8, 0.5} [m];
"""
WIND = "  force wind = {0.7 [N], 0, 0} at two;\n  force drag = -0.3 [kg/s]*velocity(one) at one;\n"
IMPLICIT = f"""model Implicit
{MASSES}  coordinate Angle a, b;
  point P = l[1]*{{sin(a), 0, -cos(a)}};
  body one = Particle(mass = m[1], at = P);
  body two = Particle(mass = m[2], at = P + l[2]*{{sin(b), 0, -cos(b)}});
  potential spring = 1/2*20 [N/m]*norm(position(two) - {{1 [m], 0, 0}})^2;
{WIND}{GRAVITY}
  output Force T[2] = {{reaction(l[1]), reaction(l[2])}};
  output Force on_one[3] = reaction(one), on_two[3] = reaction(two);
end Implicit;
"""
EXPLICIT = f"""model Explicit
{MASSES}  coordinate Length x[2], z[2];
  body one = Particle(mass = m[1], at = {{x[1], 0, z[1]}});
  body two = Particle(mass = m[2], at = {{x[2], 0, z[2]}});
  constraint rod: norm(position(one)) = l[1];
  constraint tie: norm(position(two) - position(one)) = l[2];
  potential spring = 1/2*20 [N/m]*norm(position(two) - {{1 [m], 0, 0}})^2;
{WIND}{GRAVITY}
  output Force T[2] = {{reaction(rod), reaction(tie)}}, held[2] = {{reaction(l[1]), reaction(l[2])}};
  output Force on_one[3] = reaction(one), on_two[3] = reaction(two);
end Explicit;
"""
TOP = f"""model Top
  parameter Mass m = 1.7 [kg];
  parameter Length d = 0.1 [m];
  coordinate Orientation o(start = {{0.8, 0.6, 0, 0}}, rate = {{1, 2, 30}} [rad/s]);
  frame B = rotate(world, o);
  body top = Solid(mass = m, inertia = {{2e-3, 3e-3, 1e-3}} [kg.m2], frame = B, com = d*(B.z + 0.2*B.x));
  torque motor = 0.2 [N.m]*B.z on top;
{GRAVITY}
  output Force F[3] = reaction(top).force, along = reaction(d);
  output Force newton[3] = m*(acceleration(top) + 9.81 [m/s2]*world.z);
  output Torque M[3] = reaction(top).moment, euler[3] = -cross(position(top), newton);
  output Real pressed = dot(newton, B.z + 0.2*B.x)/(1 [N]);
end Top;
"""


def _at_start(text: str, **starts: float) -> dict[str, float]:
    system = lagc.loads(text).compile(backend="numpy")
    run = system.simulate(1e-6, points=2, rtol=1e-6, starts=starts)
    return {x.name: float(run[x.name][0]) for x in system.interface.outputs}


def _vector(found: dict[str, float], name: str) -> list[float]:
    return [found[f"{name}[{k}]"] for k in (1, 2, 3)]


@pytest.mark.parametrize("seed", range(5))
def test_release_gives_the_multipliers_of_explicit_rods(seed: int) -> None:
    pick = random.Random(seed)
    a, b, wa, wb = (pick.uniform(-3.0, 3.0) for _ in range(4))
    implicit = _at_start(IMPLICIT, **{"a": a, "b": b, "der(a)": wa, "der(b)": wb})
    x, z = 0.8 * math.sin(a), -0.8 * math.cos(a)
    vx, vz = 0.8 * wa * math.cos(a), 0.8 * wa * math.sin(a)
    explicit = _at_start(
        EXPLICIT,
        **{
            "x[1]": x, "z[1]": z, "x[2]": x + 0.5 * math.sin(b), "z[2]": z - 0.5 * math.cos(b),
            "der(x[1])": vx, "der(z[1])": vz,
            "der(x[2])": vx + 0.5 * wb * math.cos(b), "der(z[2])": vz + 0.5 * wb * math.sin(b),
        },
    )  # fmt: skip
    size = max(abs(value) for value in explicit.values())
    for name, value in implicit.items():
        assert abs(value - explicit[name]) <= 1e-12 * size, name
    for k in (1, 2):  # what holds a parameter of an explicit constraint is its multiplier
        assert abs(explicit[f"held[{k}]"] - explicit[f"T[{k}]"]) <= 1e-12 * size


def test_solid_obeys_newton_and_euler() -> None:
    found = _at_start(TOP)
    newton, moment = _vector(found, "newton"), _vector(found, "M")
    assert _vector(found, "F") == pytest.approx(newton, rel=1e-12)
    assert moment == pytest.approx(_vector(found, "euler"), rel=1e-11)  # the support has no moment
    assert found["along"] == pytest.approx(found["pressed"], rel=1e-12)


def test_equations_do_not_change() -> None:
    asked = lagc.loads(TOP).compile(backend="numpy")
    lines = [line for line in TOP.splitlines() if not line.lstrip().startswith("output")]
    plain = lagc.loads("\n".join(lines)).compile(backend="numpy")
    state = asked.start()
    assert asked.rhs(0.0, state) == pytest.approx(plain.rhs(0.0, plain.start()), rel=1e-13)
    assert asked.interface.nq == plain.interface.nq


def test_parameter_of_an_instance_and_declared_speeds() -> None:
    text = f"""model Part
  parameter Length l = 0.5 [m];
  coordinate Angle th(start = 1);
  speed AngularVelocity w = 2*der(th);
  body bob = Particle(mass = 2 [kg], at = l*{{sin(th), 0, -cos(th)}});
end Part;
model Two
  Part a, b(l = 0.3 [m]);
{GRAVITY}
  output Force T = -reaction(b.l);
end Two;
"""
    found = _at_start(text, **{"b.w": 3.0})
    assert found["T"] == pytest.approx(2.0 * (0.3 * 1.5**2 + 9.81 * math.cos(1.0)), rel=1e-13)


@pytest.mark.parametrize(
    ("output", "code"),
    [
        ("output Force T = reaction(th);", "LAG0221"),
        ("output Force T = reaction(2*l);", "LAG0221"),
        ("output Force T = reaction(rod);", "LAG0307"),
        ("output Force T[3] = reaction(rod).torque;", "LAG0206"),
        ("output Torque T = reaction(l);", "LAG0302"),
        ("force F = {reaction(l), 0, 0} at rod;", "LAG0219"),
    ],
)
def test_refusals(output: str, code: str) -> None:
    text = f"""model Rod
  parameter Length l = 0.5 [m];
  coordinate Angle th;
  frame B = rotate_y(world, th);
  body rod = Solid(mass = 1 [kg], inertia = {{1, 1, 1}} [kg.m2], frame = B, com = -l*B.z);
  {output}
end Rod;
"""
    with pytest.raises(Refused) as caught:
        lagc.loads(text).compile(backend="numpy")
    assert [fault.code for fault in caught.value.faults] == [code]
