"""Turns about axes that are none of a frame: places, angular velocities and accelerations against Rodrigues'
formula and Lagrange's equations at many digits, and how the work grows along chains."""

from collections.abc import Callable, Sequence
from typing import Any

import mpmath
import numpy as np
import pytest

from lagc.compiler.checking import check
from lagc.compiler.stages import Choice, parse, resolve
from lagc.diagnostics.faults import Source
from lagc.mechanics.derive import derive
from lagc.mechanics.formulation.equations import EquationsOfMotion
from lagc.symbolic.walk import reachable
from tests.mechanics.numbers import motion, random_state, vector

mp = mpmath.mp.clone() if hasattr(mpmath.mp, "clone") else mpmath.MPContext()
mp.dps = 80
STEP = mp.mpf(10) ** -14
WORLD = mp.eye(3)
INERTIA, ARM = (1, 2, 2.5), (0.3, -0.2, 1)

MODEL = """model M
parameter Real p = 0.7, k = -0.2;
coordinate Angle a, b, c;
frame F = {0}; frame G = {1}; frame H = {2};
point T = 0.3 [m]*G.x - 0.2 [m]*G.y + 1 [m]*G.z; point U = T + 0.3 [m]*H.x - 0.2 [m]*H.y + 1 [m]*H.z;
body s = Solid(mass = 1 [kg], inertia = {{1, 2, 2.5}}, frame = F, com = {{0, 0, 0}});
body t = Solid(mass = 1 [kg], inertia = {{1, 2, 2.5}}, frame = G, com = T);
body u = Solid(mass = 1 [kg], inertia = {{1, 2, 2.5}}, frame = H, com = U);
output Real e[9] = {{H.x.x, H.y.x, H.z.x, H.x.y, H.y.y, H.z.y, H.x.z, H.y.z, H.z.z}};
output AngularVelocity w[3] = angular_velocity(H);
end M;"""


def turned(axis: Sequence[Any] | Any, angle: Any, frame: Any) -> Any:
    """`frame` turned about an axis of the world."""
    a = mp.matrix(list(axis))
    a = a / mp.sqrt(sum(x * x for x in a))
    x = mp.matrix([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])
    return (mp.eye(3) + mp.sin(angle) * x + (1 - mp.cos(angle)) * x * x) * frame


def own(frame: Any, *components: float) -> Any:
    return frame * mp.matrix(list(components))


# of each, the frame by lagc and that of the angles a, b, c and the frames before
Turn = tuple[str, Callable[..., Any]]
FIRST: Turn = ("rotate(world, {1, 0.5, 0}, a)", lambda q: turned((1, 0.5, 0), q[0], WORLD))
EULER: Turn = (
    "rotate_x(rotate_z(world, a), b)",
    lambda q: turned((0, 0, 1), q[0], WORLD) * turned((1, 0, 0), q[1], WORLD),
)
CHAINS: dict[str, tuple[Turn, Turn, Turn]] = {
    "one axis of the world": (
        FIRST,
        ("rotate(F, {1, 0.5, 0}, b)", lambda q, f: turned((1, 0.5, 0), q[1], f)),
        ("rotate(G, {2, 1, 0}, c)", lambda q, f, g: turned((2, 1, 0), q[2], g)),
    ),
    "axes of the world": (
        FIRST,
        ("rotate(F, {0, 0, -3}, b)", lambda q, f: turned((0, 0, -3), q[1], f)),
        ("rotate(G, {1, 2, 3}, c)", lambda q, f, g: turned((1, 2, 3), q[2], g)),
    ),
    "axes of the frames": (
        FIRST,
        ("rotate(F, F.x - 0.3*F.y, b)", lambda q, f: turned(own(f, 1, -0.3, 0), q[1], f)),
        ("rotate(G, -normalize(2*G.x + G.z), c)", lambda q, f, g: turned(own(g, -2, 0, -1), q[2], g)),
    ),
    "parameters": (
        FIRST,
        ("rotate(F, {p, k, 1}, b)", lambda q, f: turned((0.7, -0.2, 1), q[1], f)),
        ("rotate(G, p*G.x + k*(G.z - G.y), c)", lambda q, f, g: turned(own(g, 0.7, 0.2, -0.2), q[2], g)),
    ),
    "axes of frames before": (
        EULER,
        ("rotate_y(F, c)", lambda q, f: f * turned((0, 1, 0), q[2], WORLD)),
        ("rotate(G, F.x + F.y, b)", lambda q, f, g: turned(own(f, 1, 1, 0), q[1], g)),
    ),
    "axes that move": (
        EULER,
        ("rotate(F, {cos(a), c, 0.2}, b)", lambda q, f: turned((mp.cos(q[0]), q[2], 0.2), q[1], f)),
        (
            "rotate(G, F.x + a*G.y, c)",
            lambda q, f, g: turned(own(f, 1, 0, 0) + q[0] * own(g, 0, 1, 0), q[2], g),
        ),
    ),
}


def equations(text: str) -> EquationsOfMotion:
    return derive(resolve(parse(Source("m.lag", text)), Choice()))


def frames(chain: tuple[Turn, Turn, Turn], q: Sequence[Any]) -> list[Any]:
    first = chain[0][1](q)
    second = chain[1][1](q, first)
    return [first, second, chain[2][1](q, first, second)]


def kinetic(chain: tuple[Turn, Turn, Turn], q: Sequence[Any], v: Sequence[Any]) -> Any:
    """Of three solids, by differences of their frames and places."""
    sides = [frames(chain, [x + s * STEP * y for x, y in zip(q, v)]) for s in (1, 0, -1)]
    total, speed = mp.mpf(0), mp.zeros(3, 1)
    for k in range(3):
        rate = (sides[0][k] - sides[2][k]) / (2 * STEP)
        if k:
            speed = speed + rate * mp.matrix([mp.mpf(str(x)) for x in ARM])
            total += (speed.T * speed)[0] / 2
        spin = sides[1][k].T * rate
        total += sum(i * w**2 for i, w in zip(INERTIA, (spin[2, 1], spin[0, 2], spin[1, 0]))) / 2
    return total


def lagrange(chain: tuple[Turn, Turn, Turn], q: Sequence[Any], v: Sequence[Any]) -> list[float]:
    """The accelerations without forces: d/dt dT/dv = dT/dq."""
    h = mp.mpf(10) ** -12
    unit = [[h if i == j else mp.mpf(0) for j in range(3)] for i in range(3)]

    def energy(*moves: tuple[int, Sequence[Any]]) -> Any:
        at, rate = list(q), list(v)
        for kind, move in moves:
            (at if kind == 0 else rate)[:] = [x + y for x, y in zip(at if kind == 0 else rate, move)]
        return kinetic(chain, at, rate)

    def minus(move: Sequence[Any]) -> list[Any]:
        return [-x for x in move]

    def second(first: tuple[int, Sequence[Any]], other: tuple[int, Sequence[Any]]) -> Any:
        a, b = (first[0], minus(first[1])), (other[0], minus(other[1]))
        return (energy(first, other) - energy(first, b) - energy(a, other) + energy(a, b)) / (4 * h * h)

    mass = mp.matrix(3, 3)
    right = mp.matrix(3, 1)
    along = [h * x for x in v]
    for i in range(3):
        for j in range(3):
            mass[i, j] = second((1, unit[i]), (1, unit[j]))
        right[i] = (energy((0, unit[i])) - energy((0, minus(unit[i])))) / (2 * h) - second(
            (1, unit[i]), (0, along)
        )
    return [float(x) for x in mp.lu_solve(mass, right)]


@pytest.mark.full
@pytest.mark.parametrize("name", CHAINS)
def test_frames_and_accelerations_are_those_of_rodrigues_formula(name: str) -> None:
    chain = CHAINS[name]
    e = equations(MODEL.format(*[text for text, _ in chain]))
    state = random_state(e, 5)
    q, v = ([mp.mpf(state[x]) for x in leaves] for leaves in (e.q, e.v))
    outputs = {o.name: o.expression for o in e.outputs}
    last = frames(chain, q)[2]
    found = vector([outputs[f"e[{k}]"] for k in range(1, 10)], state)
    assert found == pytest.approx([float(last[i, j]) for i in range(3) for j in range(3)], abs=1e-14)
    beside = [frames(chain, [x + s * STEP * y for x, y in zip(q, v)])[2] for s in (1, -1)]
    spin = (beside[0] - beside[1]) / (2 * STEP) * last.T
    found = vector([outputs[f"w[{k}]"] for k in (1, 2, 3)], state)
    assert found == pytest.approx([float(spin[2, 1]), float(spin[0, 2]), float(spin[1, 0])], abs=1e-13)
    accelerations = np.array([motion(e, state)[a] for a in e.a])
    assert accelerations == pytest.approx(lagrange(chain, q, v), rel=1e-10, abs=1e-10)


# -- how it grows ---------------------------------------------------------------------------------

CHAIN = """model C
coordinate Angle a[{n}](each start = 0.1);
frame F[0] = world; point P[0] = {{0, 0, 0}};
for i in 1:{n} loop
  frame F[i] = rotate(F[i-1], {axis}, a[i]);
  point P[i] = P[i-1] + 1 [m]*F[i].z;
  body b[i] = Solid(mass = 1 [kg], inertia = {{1, 2, 2}}, frame = F[i], com = P[i]);
end for;
end C;"""
AXES = ("{1, 0.5, 0}", "{i, 0.5, 1}", "F[i-1].x + 0.5*F[i-1].y", "normalize(F[i-1].x + 0.5*F[i-1].y)")


@pytest.mark.sample(2)
@pytest.mark.parametrize("axis", AXES)
def test_a_link_adds_as_much_to_the_expressions_whatever_the_axis(axis: str) -> None:
    def nodes(n: int) -> tuple[int, bool]:
        model = resolve(parse(Source("m.lag", CHAIN.format(n=n, axis=axis))), Choice())
        solids = [(b.frame, b.velocity) for b in model.bodies if b.frame]
        parts = [x for frame, v in solids for row in (*frame.axes, frame.angular_velocity, v) for x in row]
        below = reachable(parts)
        return len(below), any(x.op == "sqrt" for x in below)

    (few, _), (some, _), (many, roots) = nodes(8), nodes(16), nodes(24)
    assert not roots
    assert many - some <= 1.1 * (some - few)


def test_lengths_of_what_stands_in_a_frame_are_numbers() -> None:
    e = equations(
        "model M coordinate Angle a[9](each start = 0.1); frame F[0] = world;"
        "for i in 1:9 loop frame F[i] = rotate(F[i-1], F[i-1].x + F[i-1].y, a[i]); end for;"
        "parameter Length l = 2; point P = {1, 0, 0}; point Q = P + l*F[9].x - 3 [m]*F[9].y;"
        "body b = Particle(mass = 1 [kg], at = Q); output Length d = norm(Q - P); end M;"
    )
    (distance,) = (o.expression for o in e.outputs if o.name == "d")
    assert [x.record.name for x in reachable([distance]) if x.op == "symbol"] == ["l"]
    assert vector([distance], random_state(e, 1)) == pytest.approx(13.0**0.5)


@pytest.mark.full
def test_chains_about_any_axis_are_without_fault() -> None:
    for axis in AXES:
        faults = check(Source("m.lag", CHAIN.format(n=3, axis=axis)), Choice())
        assert {fault.code for fault in faults} <= {"LAG0429"}  # no force acts
