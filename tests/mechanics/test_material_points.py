"""Forces on material points: generalized forces against virtual displacements of points that are
carried along, by differences in 90 digits; closed forms of what slides until it rolls; and which
readings are warned of."""

import math
import random
from typing import Any

import pytest

import lagc
from lagc.diagnostics.faults import Source
from lagc.mechanics.derive import derive
from lagc.mechanics.formulation.equations import EquationsOfMotion
from lagc.semantics.model import Body, Coordinate, Model
from lagc.semantics.resolve import resolve
from lagc.symbolic.graph import Node
from lagc.symbolic.vectors import Vector
from lagc.symbolic.walk import evaluate
from lagc.syntax.parse import parse
from tests.oracle.lagrange import STEP, Expressions, mp


def derived(text: str) -> EquationsOfMotion:
    return derive(resolve(parse(Source("loads.lag", text))))


# -- virtual work --------------------------------------------------------------------------------


def two_solids(chance: random.Random, loads: str) -> str:
    """Two solids of random shape of motion, the second carried by the first."""
    turns = [chance.choice("xyz") for _ in range(3)]
    a, b, c, d = (round(chance.uniform(0.2, 1.5), 3) for _ in range(4))
    return f"""
model Two
  parameter Length a = {a}, b = {b}, c = {c}, d = {d};
  parameter Force f = 2.5;
  coordinate Length s;
  coordinate Angle u, v, w;
  frame A = rotate_{turns[0]}(world, u);
  frame B = rotate_{turns[1]}(rotate_{turns[2]}(A, v), w);
  point O = {{s, a*sin(u + v), b*cos(2*u)}};
  point H = O + c*A.x - d*A.z*sin(time/(1 [s]));
  body one = Solid(mass = 1, inertia = {{1, 2, 2.5}}, frame = A, com = O);
  body two = Solid(mass = 2, inertia = {{1, 1.5, 2}}, frame = B, com = H + b*B.y);
  point wild = {{a*cos(w), s + b*u, d*v*time/(1 [s])}};
  point fixed = H - a*B.x + c*B.z;
{loads}
end Two;
"""


def virtual_work(
    model: Model, body: Body, at: Vector, force: list[float], state: dict[Node, float]
) -> list[float]:
    """F . dr/dq_j of the point of `body` that is at `at`, carried along by differences."""
    assert body.frame is not None
    pose = Expressions([*body.position, *(x for row in body.frame.axes for x in row)])
    exact = {symbol: mp.mpf(x) for symbol, x in state.items()}
    here = Expressions(list(at))(exact)

    def placed(values: list[Any], arm: list[Any]) -> list[Any]:
        return [values[i] + sum(values[3 + 3 * i + k] * arm[k] for k in range(3)) for i in range(3)]

    now = pose(exact)
    apart = [here[i] - now[i] for i in range(3)]
    arm = [sum(now[3 + 3 * i + k] * apart[i] for i in range(3)) for k in range(3)]
    found = []
    for c in model.coordinates:
        assert isinstance(c, Coordinate)
        ahead = placed(pose({**exact, c.symbol: exact[c.symbol] + STEP}), arm)
        behind = placed(pose({**exact, c.symbol: exact[c.symbol] - STEP}), arm)
        moved = [(p - q) / (2 * STEP) for p, q in zip(ahead, behind)]
        found.append(float(sum(f * d for f, d in zip(force, moved))))
    return found


@pytest.mark.sample(6)
@pytest.mark.parametrize("seed", range(12))
def test_a_force_on_a_body_does_the_work_of_its_material_point(seed: int) -> None:
    chance = random.Random(4100 + seed)
    text = two_solids(chance, """
  force direct = f*{1, -2, 0.5} on two at wild;
  force pair = f*{1, -2, 0.5} on two at wild from one;
  force carried = f*{1, -2, 0.5} on two at fixed;
  force plain = f*{1, -2, 0.5} at fixed;
""")  # fmt: skip
    equations = derived(text)
    assert not equations.warnings
    model = equations.model
    one, two = model.bodies
    points = {p.name: p.position for p in model.points}
    state = {p.symbol: p.value or 0.0 for p in model.parameters}
    state |= {x: chance.uniform(-1, 1) for x in (*equations.q, *equations.v, equations.time)}
    force = [2.5, -5.0, 1.25]
    direct = virtual_work(model, two, points["wild"], force, state)
    opposite = virtual_work(model, one, points["wild"], force, state)
    carried = virtual_work(model, two, points["fixed"], force, state)
    expected = {
        "direct": direct,
        "pair": [x - y for x, y in zip(direct, opposite)],
        "carried": carried,
        "plain": carried,
    }
    for c in equations.contributions:
        found = [evaluate([c.forces[j]], state)[0] if j in c.forces else 0.0 for j in range(4)]
        assert found == pytest.approx(expected[c.name], rel=1e-12, abs=1e-12), c.name


# -- sliding until it rolls -------------------------------------------------------------------------

SLIDES = """
model Slides
  parameter Mass m = 2 [kg];
  parameter Length R = 0.3 [m];
  parameter Real k = %(k)s "moment of inertia over m R^2";
  parameter Damping c = 1.7;
  parameter Real mu = 0.2;
  coordinate Length x(rate = 3 [m/s]);
  coordinate Angle phi;
  frame B = rotate_y(world, phi);
  point G = {x, 0, R};
  point P = G - R*world.z;
  body wheel = Solid(mass = m, inertia = k*m*R^2*{1, 1, 1}, frame = B, com = G);
  %(load)s
end Slides;
"""
VISCOUS = [
    "force rub = -c*velocity(wheel, at = P) on wheel at P;",
    "force rub = -c*velocity(wheel, at = P) on wheel at {x, 0, 0};",
    "force rub = -c*velocity(wheel, at = P) at wheel; "
    "torque turn = cross(P - G, -c*velocity(wheel, at = P)) on wheel;",
    "dissipation rub = 1/2*c*norm(velocity(wheel, at = P))^2;",
]
DRY = "force rub = -mu*m*9.81 [m/s2]*normalize(velocity(wheel, at = P)) on wheel at P;"


@pytest.mark.sample(1)
@pytest.mark.parametrize("load", VISCOUS)
@pytest.mark.parametrize("k", [0.5, 0.4, 1.0])
def test_viscous_friction_ends_in_rolling(k: float, load: str) -> None:
    """x' = v0 (1 - (1 - exp(-(1 + 1/k) c t/m)) / (1 + 1/k)): 2/3 v0 for a disc, 5/7 for a sphere."""
    run = lagc.loads(SLIDES % {"k": k, "load": load}).compile().simulate(stop=8, accuracy=1e-9)
    assert run.status == "ok"
    assert not run.system.interface.warnings
    b = 1 + 1 / k
    expected = [3 * (1 - (1 - math.exp(-b * 1.7 * t / 2)) / b) for t in run.t]
    assert run["der(x)"] == pytest.approx(expected, rel=1e-8)
    assert run["der(x)"][-1] == pytest.approx(3 / (1 + k), rel=1e-5)
    assert 0.3 * run["der(phi)"][-1] == pytest.approx(3 / (1 + k), rel=1e-5)
    assert run.energy.imbalance == pytest.approx(0.0, abs=1e-8)


@pytest.mark.parametrize("k", [0.5, 0.4])
def test_dry_friction_slows_and_spins(k: float) -> None:
    text = SLIDES % {"k": k, "load": DRY}
    run = lagc.loads(text).compile().simulate(stop=0.99 * 3 / (0.2 * 9.81 * (1 + 1 / k)), accuracy=1e-9)
    assert run.status == "ok" and not run.system.interface.warnings
    assert run["der(x)"] == pytest.approx([3 - 0.2 * 9.81 * t for t in run.t], rel=1e-8)
    assert run["der(phi)"] == pytest.approx([0.2 * 9.81 * t / (k * 0.3) for t in run.t], rel=1e-8, abs=1e-12)


RIM = [
    "force pull = 4 [N]*world.x on wheel at G + R*world.z;",
    "force pull = 4 [N]*world.x at wheel; torque turn = R*4 [N]*world.y on wheel;",
    "body p = Particle(mass = 0, at = G); force pull = 4 [N]*world.x at p; torque turn = R*4 [N]*B.y on B;",
]


@pytest.mark.parametrize("load", RIM)
def test_a_wheel_pulled_at_its_rim_rolls_twice_as_fast(load: str) -> None:
    rolls = "constraint roll: der(x) = R*der(phi);"
    text = (SLIDES % {"k": 0.5, "load": load + rolls}).replace("rate = 3", "rate = 0")
    run = lagc.loads(text).compile().simulate(stop=2, accuracy=1e-9)
    assert not run.system.interface.warnings
    assert run["der(x)"] == pytest.approx([2 * 4 * t / (2 * 1.5) for t in run.t], rel=1e-8, abs=1e-12)
    assert run.energy.work == pytest.approx(2 * 4 * run["x"][-1], rel=1e-8)


PUSHED = """
model Pushed
  parameter Force f = 3;
  parameter Velocity u = 0.5;
  coordinate Angle th;
  frame rod = rotate_z(world, th);
  body bar = Solid(mass = 1, inertia = {0.1, 0.75, 0.75}, frame = rod, com = 0.5 [m]*rod.x);
  point hand = u*time*rod.x;
  %s
end Pushed;
"""


@pytest.mark.parametrize("load", [
    "force push = f*rod.y on bar at hand;",
    "force push = f*rod.y at hand;",
    "torque push = f*u*time*world.z on bar;",
    "body p = Particle(mass = 0, at = hand); force push = f*rod.y at p;",
])  # fmt: skip
def test_a_rod_is_pushed_where_a_hand_slides_along_it(load: str) -> None:
    run = lagc.loads(PUSHED % load).compile().simulate(stop=1.5, accuracy=1e-9)
    assert not run.system.interface.warnings
    assert run["th"] == pytest.approx([3 * 0.5 * t**3 / 6 for t in run.t], rel=1e-8, abs=1e-12)


# -- what is warned of -------------------------------------------------------------------------------

SCENE = """
model Scene
  parameter Mass m = 1 [kg];
  parameter Length R = %(R)s [m], l = 2 [m];
  parameter Damping c = 2;
  parameter Force f = 3;
  parameter RotationalDamping d = 0.4;
  parameter Damping bad = -2;
  coordinate Length x, y, h, s;
  coordinate Angle phi, lean, th, pin, elbow;
  frame L = rotate_x(world, lean);
  frame B = rotate_y(L, phi);
  point G = {x, y, h};
  body disc = Solid(mass = m, inertia = m*R^2*{1/4, 1/2, 1/4}, frame = B, com = G);
  frame rod = rotate_z(world, th);
  body bar = Solid(mass = m, inertia = {0.1, 1, 1}, frame = rod, com = l/2*rod.x);
  frame arm = rotate_z(rod, elbow);
  body slider = Particle(mass = m, at = s*rod.x);
  body cart = Particle(mass = m, at = {0, y, 0});
  frame link = rotate_x(world, pin);
  body bob = Particle(mass = m, at = cart.position + l*link.y);
  %(lines)s
end Scene;
"""
UNDER, LOW = "G - R*world.z", "G - R*L.z"


def codes(lines: str, radius: float = 0.1) -> list[str]:
    return [w.code for w in derived(SCENE % {"R": radius, "lines": lines}).warnings]


BETWEEN, BACK = "velocity(bob) - velocity(cart)", "velocity(cart) - velocity(bob)"
TAKING = [
    f"force F = -c*velocity(disc, at = {UNDER}) on disc at {UNDER};",
    "force F = -c*velocity(disc) at disc;",
    f"force F = -c*velocity(disc, at = {UNDER}).x*world.x on disc at {UNDER};",
    f"force F = -c*norm(velocity(disc, at = {LOW}))*velocity(disc, at = {LOW})/(1 [m/s]) on disc at {LOW};",
    "force F = -c*(velocity(slider) - velocity(bar, at = s*rod.x)) on slider at s*rod.x from bar;",
    *(
        f"force F = {sign}c*({one}) at bob; force E = {opposite}c*({other}) at cart;"
        for sign, one, opposite, other in (
            ("-", BETWEEN, "", BETWEEN),
            ("-", BETWEEN, "-", BACK),
            ("", BACK, "-", BACK),
            ("", BACK, "", BETWEEN),
        )
    ),
    "force F = -c*(velocity(bob) - {1 [m/s], 2 [m/s], 0}) at bob;",
    "force F = -c*(velocity(bob) - {sin(time/(1 [s]))*1 [m/s], 0, 0}) at bob;",
    "torque T = -d*angular_velocity(bar) on bar;",
    "force F = -c*velocity(slider) on bar at s*rod.x;",
    "torque T = -d*(angular_velocity(disc) - angular_velocity(bar)) on disc from bar;",
    "torque T = -d*der(phi)*B.y on B from L;",
    "torque T = -d*der(elbow)*world.z on arm from rod;",
    "force F = cross({0, 0, c}, velocity(bob)) at bob;",
    "force F = -f*normalize(velocity(bob)) at bob;",
    # a drive, a control, an unstable oscillator: not what looks like friction
    "force F = (-2*c*der(y) + 3*c*der(pin)*l)*world.y at cart;",
    "force F = c*(1 - (y/(1 [m]))^2)*velocity(cart) at cart;",
    "force F = c*velocity(bob) at bob;",
    "force F = bad*velocity(bob) at bob;",
    "torque T = d*(angular_velocity(bar) - angular_velocity(disc)) on disc from bar;",
    "torque T = d*(angular_velocity(disc) - angular_velocity(bar)) on bar from disc;",
    "torque T = -d*norm(angular_velocity(arm))*(angular_velocity(arm) - angular_velocity(rod))*(1 [s]) "
    "on arm from rod;",
    "force F = -c*(velocity(bob) - {bad*(1 [m/kg]), 0, 0}) at bob;",
    "force F = bad*(1 [m/s])*world.y at bob;",
    "force F = (f*y/(1 [m]) + 3*c*der(y) + 5*f*pin + 2*c*l*der(pin))*world.y at cart;",
    "force F = -c*der(y)*world.y at cart;",
    f"force F = -c*(der(x) - R*cos(lean)*der(phi))*world.x on disc at {UNDER};",
    "torque T = -d*(der(th) + der(elbow))*world.z on arm;",
    "torque T = -d*(der(th) - der(phi))*world.z on rod;",
    "force F = -c*der(s)*rod.x at slider;",
]
FEEDING = [
    f"force F = -c*velocity(disc) on disc at {UNDER};",
    f"force F = -c*velocity(disc, at = {UNDER}) at disc;",
    f"force F = -c*velocity(disc, at = {UNDER}) on disc at {LOW} + R*B.x;",
    f"force F = -c*norm(velocity(disc))*velocity(disc)/(1 [m/s]) on disc at {UNDER};",
    f"force F = -f*tanh(velocity(disc).x/(1 [m/s]))*world.x on disc at {UNDER};",
    "force F = -c*velocity(bob) at cart;",
    "force F = -c*(velocity(bob) - velocity(cart)) at bob;",
    "torque T = -d*(angular_velocity(arm) - angular_velocity(rod)) on arm;",
    "torque T = -d*angular_velocity(bar) on bar from disc;",
    # the two of a pair exchanged
    "torque T = -d*(angular_velocity(bar) - angular_velocity(disc)) on disc from bar;",
    "torque T = -d*(angular_velocity(disc) - angular_velocity(bar)) on bar from disc;",
    "force F = -c*(velocity(bar, at = s*rod.x) - velocity(slider)) on slider at s*rod.x from bar;",
]


@pytest.mark.sample(6, 12)
@pytest.mark.parametrize("radius", [1e-3, 0.1, 30.0])
@pytest.mark.parametrize("lines", TAKING)
def test_what_takes_energy_or_is_a_drive_is_not_warned_of(lines: str, radius: float) -> None:
    assert "LAG0412" not in codes(lines, radius)


@pytest.mark.sample(6, 12)
@pytest.mark.parametrize("radius", [1e-3, 0.1, 30.0])
@pytest.mark.parametrize("lines", FEEDING)
def test_frictions_that_feed_are_warned_of(lines: str, radius: float) -> None:
    assert codes(lines, radius) == ["LAG0412"]


def test_velocities_that_agree_on_the_constraints_are_the_same() -> None:
    """The ground under a disc that lies on it: {x, y, 0} is where G - R*world.z is."""
    held = "constraint touch: h = R; constraint upright: lean = 0;"
    friction = "force F = -c*velocity(disc, at = {x, y, h - R}) on disc at {x, y, 0};"
    assert "LAG0412" in codes(friction.replace("h - R", "h"))
    assert codes(held + friction) == []


def test_a_particle_has_no_other_points() -> None:
    with pytest.raises(lagc.Refused, match="is not at this point"):
        codes("force F = f*world.x on bob at G;")
    with pytest.raises(lagc.Refused, match="which has no place"):
        codes("force F = f*world.x on B at G;")


def test_damping_in_joints_is_plain() -> None:
    lines = ["coordinate Angle q0; frame F0 = rotate_x(world, q0);"]
    for i in range(1, 8):
        turn, before = "xyz"[i % 3], f"F{i - 1}"
        lines.append(f"coordinate Angle q{i}; frame F{i} = rotate_{turn}({before}, q{i});")
        lines.append(f"body b{i} = Solid(mass = 1, inertia = {{1, 1, 1.5}}, frame = F{i}, com = R*F{i}.y);")
        lines.append(f"torque T{i} = -d*der(q{i})*F{i}.{turn} on F{i} from {before};")
        lines.append(f"force E{i} = -c*velocity(b{i}, at = R*F{i}.x) on b{i} at R*F{i}.x;")
    assert codes("\n".join(lines)) == []
