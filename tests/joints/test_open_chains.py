"""Joint reactions of random open chains in space, by release, equal those of explicit equations: Newton's and
Euler's of each body, with the accelerations of each joint as constraint rows (NumPy, by hand). Every kind
of joint, open with coordinates and closed with equations, gives the same motion."""

import random
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import lagc
from lagc.api import Run
from lagc.semantics.joints import KINDS, Pair

BODIES = 3
Array = NDArray[np.float64]


class Chain:
    """A chain from the world: masses, inertias and centres in the drawing, joints with axis and point."""

    def __init__(self, seed: int):
        pick = random.Random(seed)

        def vector() -> Array:
            return np.array([pick.uniform(-1.0, 1.0) for _ in range(3)])

        self.turns = [pick.random() < 0.6 for _ in range(BODIES)]
        self.mass = [pick.uniform(0.5, 3.0) for _ in range(BODIES)]
        self.inertia = [np.array([pick.uniform(0.2, 0.35) for _ in range(3)]) for _ in range(BODIES)]
        self.com, self.at = [vector() for _ in range(BODIES)], [vector() for _ in range(BODIES)]
        axes = [vector() for _ in range(BODIES)]
        self.axis = [axis / np.linalg.norm(axis) for axis in axes]
        self.q = [pick.uniform(-2.0, 2.0) for _ in range(BODIES)]
        self.rate = [pick.uniform(-3.0, 3.0) for _ in range(BODIES)]
        self.wind = vector()

    def model(self) -> str:
        def written(values: Any) -> str:
            return "{" + ", ".join(repr(float(x)) for x in values) + "}"

        lines = list[str]()
        for k in range(BODIES):
            lines.append(
                f"body b{k} = Solid(mass = {self.mass[k]!r} [kg], inertia = {written(self.inertia[k])} "
                f"[kg.m2], com = {written(self.com[k])} [m]);"
            )
            kind, unit = ("Revolute", "") if self.turns[k] else ("Prismatic", " [m]")
            first = f"b{k - 1}" if k else "world"
            coordinate = "angle" if self.turns[k] else "slide"
            rate = "[rad/s]" if self.turns[k] else "[m/s]"
            lines.append(
                f"joint j{k} = {kind}({first}, b{k}, axis = {written(self.axis[k])}, at = "
                f"{written(self.at[k])} [m], {coordinate}(start = {self.q[k]!r}{unit}, rate = "
                f"{self.rate[k]!r} {rate}));"
            )
            lines.append(f"output Force F{k}[3] = reaction(j{k}).force;")
            lines.append(f"output Torque M{k}[3] = reaction(j{k}).moment;")
        lines.append(f"force wind = {written(self.wind)} [N] at b{BODIES - 1};")
        return "model Chain\n  Gravity field(g = 9.81 [m/s2]);\n  " + "\n  ".join(lines) + "\nend Chain;\n"

    def reactions(self) -> list[Array]:
        """Force and moment of each joint on its second body, about its point in that body."""
        turn, shift, spin = np.eye(3), np.zeros(3), np.zeros(3)  # of the drawing
        n = 12 * BODIES  # accelerations, angular accelerations, forces, moments
        matrix, right = np.zeros((n, n)), np.zeros(n)
        row = 0
        for k in range(BODIES):
            axis, before = turn @ self.axis[k], (spin, shift, turn)
            place = turn @ self.at[k] + shift  # of the point of the first body
            if self.turns[k]:
                turn = turn @ _rotation(self.axis[k], self.q[k])
                shift = place - turn @ self.at[k]
                spin = spin + axis * self.rate[k]
            else:
                shift = shift + axis * self.q[k]
            point, com = turn @ self.at[k] + shift, turn @ self.com[k] + shift
            a, w, f, m = (12 * k + 3 * i for i in range(4))
            tensor = turn @ np.diag(self.inertia[k]) @ turn.T
            given = np.array([0.0, 0.0, -9.81 * self.mass[k]]) + (self.wind if k == BODIES - 1 else 0.0)
            matrix[row : row + 3, a : a + 3] = self.mass[k] * np.eye(3)
            matrix[row : row + 3, f : f + 3] -= np.eye(3)
            right[row : row + 3] = given
            matrix[row + 3 : row + 6, w : w + 3] = tensor
            matrix[row + 3 : row + 6, m : m + 3] -= np.eye(3)
            matrix[row + 3 : row + 6, f : f + 3] -= _cross(point - com)
            right[row + 3 : row + 6] = -np.cross(spin, tensor @ spin)
            if k:  # the reaction on the body before
                last = before[2] @ self.com[k - 1] + before[1]
                other = row - 12
                matrix[other : other + 3, f : f + 3] += np.eye(3)
                matrix[other + 3 : other + 6, m : m + 3] += np.eye(3)
                matrix[other + 3 : other + 6, f : f + 3] += _cross(point - last)
            # the acceleration of the joint: of its point, and of the angular velocity
            own, bias = np.zeros((6, n)), np.zeros(6)
            own[:3, a : a + 3], own[:3, w : w + 3] = np.eye(3), -_cross(point - com)
            own[3:, w : w + 3] = np.eye(3)
            bias[:3] = np.cross(spin, np.cross(spin, point - com))
            if k:
                own[:3, a - 12 : a - 9], own[:3, w - 12 : w - 9] = -np.eye(3), _cross(point - last)
                own[3:, w - 12 : w - 9] = -np.eye(3)
                bias[:3] -= np.cross(before[0], np.cross(before[0], point - last))
            moved = np.cross(before[0], axis) * self.rate[k]
            bias[:3] -= 0.0 if self.turns[k] else 2.0 * moved
            bias[3:] -= moved if self.turns[k] else 0.0
            across = np.linalg.svd(axis.reshape(1, 3))[2][1:]
            free, held = (slice(3, 6), slice(0, 3)) if self.turns[k] else (slice(0, 3), slice(3, 6))
            matrix[row + 6 : row + 9], right[row + 6 : row + 9] = own[held], -bias[held]
            matrix[row + 9 : row + 11], right[row + 9 : row + 11] = across @ own[free], -across @ bias[free]
            freed = m if self.turns[k] else f
            matrix[row + 11, freed : freed + 3] = axis
            row += 12
        found = np.linalg.solve(matrix, right)
        return [found[12 * k + 6 : 12 * k + 12] for k in range(BODIES)]


def _cross(v: Array) -> Array:
    return np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])


def _rotation(axis: Array, angle: float) -> Array:
    """O. Rodrigues, 1840."""
    k = _cross(axis)
    return np.eye(3) + np.sin(angle) * k + (1.0 - np.cos(angle)) * (k @ k)


@pytest.mark.full
@pytest.mark.parametrize("seed", range(20))
def test_reactions_by_release_equal_those_of_explicit_equations(seed: int) -> None:
    chain = Chain(seed)
    run = lagc.loads(chain.model()).compile(backend="numpy").simulate(1e-6, points=2, rtol=1e-6)
    known = chain.reactions()
    size = max(float(np.abs(own).max()) for own in known)
    for k, own in enumerate(known):
        names = [f"{part}{k}[{i}]" for part in "FM" for i in (1, 2, 3)]
        for name, value in zip(names, own):
            assert abs(float(run[name][0]) - value) <= 1e-10 * size, name


AXIS, ALONG, AT = "axis = {1, 2, 2}", "along = {1, 0, 0.3}", "at = {0.2, 0.1, -0.3} [m]"
ARGUMENTS = {"axis": AXIS, "at": AT, "along": ALONG, "pitch": "pitch = 0.4 [m]"}
FREEDOM = {
    "Weld": 0, "Revolute": 1, "Prismatic": 1, "Cylindrical": 2, "Screw": 1, "Spherical": 3, "Universal": 2,
    "Planar": 3, "PointOnPlane": 5, "LineOnPlane": 4, "PointOnLine": 4, "Free": 6,
}  # fmt: skip
MODEL = """model Pair
  body base = Solid(mass = 3 [kg], inertia = {{0.3, 0.4, 0.5}} [kg.m2], com = {{0.1, 0.2, 0.1}} [m]);
  body arm = Solid(mass = 1 [kg], inertia = {{0.03, 0.05, 0.06}} [kg.m2], com = {{0.4, 0.1, -0.5}} [m]);
  joint pivot = Revolute(world, base, axis = {{0, 1, 0.2}}, at = {{0, 0, 0.1}} [m], angle(rate = 2 [rad/s]));
  {joints}
  potential spring = 1/2*30 [N/m]*norm(attached(arm, {{0.5, 0, 0}} [m]) - {{1, 0.5, 0}} [m])^2;
  effect gravity
    Gravity field;
  end gravity;
  scene lab uses gravity;
  output Length tip[3] = attached(arm, {{0.6, 0.3, 0.2}} [m]), side[3] = attached(arm, {{0, 0.3, 0}} [m]);
  output Force F[3] = reaction(tie).force;
  output Torque M[3] = reaction(tie).moment;
end Pair;
"""


def _joint(kind: str) -> str:
    parameters = [p for p in KINDS[kind].parameters if p in ARGUMENTS]
    return f"{kind}({', '.join(['base', 'arm', *(ARGUMENTS[p] for p in parameters)])})"


def _run(joints: str) -> Run:
    system = lagc.loads(MODEL.format(joints=joints)).compile()
    run = system.simulate(0.6, accuracy=1e-10, points=4)
    assert run.status == "ok", run.message
    return run


PAIRS = [name for name, kind in KINDS.items() if isinstance(kind, Pair)]


@pytest.mark.full
@pytest.mark.parametrize("kind", PAIRS)
def test_open_and_closed_move_alike(kind: str) -> None:
    joint = f"joint tie = {_joint(kind)};"
    opened = _run(joint)
    closed = _run(f"joint free = Free(base, arm, {AT});\n  {joint}")
    assert len(opened.state_names) <= 2 + FREEDOM[kind] * 2 + (FREEDOM[kind] >= 3)
    for name in ("tip", "side"):
        for k in (1, 2, 3):
            assert opened[f"{name}[{k}]"] == pytest.approx(closed[f"{name}[{k}]"], abs=2e-9)
    size = max(abs(opened[f"F[{k}]"]).max() for k in (1, 2, 3)) + 1.0
    for name in ("F", "M"):  # the reaction by release, and from the multipliers of the equations
        for k in (1, 2, 3):
            assert opened[f"{name}[{k}]"] == pytest.approx(closed[f"{name}[{k}]"], abs=1e-7 * size)


def test_freedom() -> None:
    for kind in PAIRS:
        found = KINDS[kind]
        assert isinstance(found, Pair)
        turns = {0: 0, 1: 1, 2: 2, 3: 3}[found.turns]
        assert len(found.slides) + turns == FREEDOM[kind], kind
