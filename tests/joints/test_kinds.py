"""Every kind of joint, open with coordinates and closed with equations, gives the same motion."""

import pytest

import lagc
from lagc.api import Run
from lagc.semantics.joints import KINDS, Pair

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
