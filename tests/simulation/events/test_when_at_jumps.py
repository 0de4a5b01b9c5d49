"""Clauses that act at the crossing at which a force jumps: friction that brings a block to rest, a belt."""

from math import atan2, cos, pi, sin, sqrt

import pytest

import lagc

pytestmark = pytest.mark.usefixtures("own_cache")

CONDITIONS = (
    "der(x) <= 0", "der(x) < 0", "not der(x) > 0", "v <= 0", "x > 1[m] and 0 > der(x)",
    "2*m*der(x) < 0", "m*der(x) <= 0", "der(x)^3 < 0", "der(x)/m + der(x)^3*(1 [s2/m2.kg]) <= 0",
)  # fmt: skip
FRICTION = ("-(2 [N])*sign(der(x))", "if der(x) >= 0 then -2 [N] else 2 [N]", "-f*der(x)/abs(der(x))")


def braked(condition: str, friction: str, pull: float, action: str) -> str:
    return f"""model Braked
      parameter Mass m = 0.7 [kg];
      parameter Force f = 2 [N];
      coordinate Length x(rate = 4 [m/s]);
      body b = Particle(mass = 1 [kg], at = {{x, 0, 0}});
      force pull = {{{pull} [N], 0, 0}} at b;
      force rub = {{{friction}, 0, 0}} at b;
      output Velocity v = der(x);
      when {condition} then {action} end when;
    end Braked;"""


@pytest.mark.sample(2, 12)
@pytest.mark.parametrize("backend", ["numpy", "c"])
@pytest.mark.parametrize("friction", FRICTION)
@pytest.mark.parametrize("condition", CONDITIONS)
def test_a_clause_acts_where_friction_brings_the_block_to_rest(
    condition: str, friction: str, backend: str
) -> None:
    """Whether the block could stick there or not: at t = v/a, x = v^2/2a."""
    for pull, t in ((1.0, 4.0), (0.0, 2.0)):
        text = braked(condition, friction, pull, 'terminate("at rest");')
        run = lagc.loads(text).compile(backend=backend).simulate(6.0)
        assert run.status == "terminated", run.message
        assert run.times[-1] == pytest.approx(t, abs=1e-12)
        assert run.states[-1][:2] == pytest.approx([2.0 * t, 0.0], abs=1e-12)


@pytest.mark.sample(1)
@pytest.mark.parametrize("condition", CONDITIONS)
def test_a_clause_kicks_the_block_back_where_friction_turns(condition: str) -> None:
    """It goes back at 3 m/s, and friction and pull decelerate it by 3 m/s2 to rest at t = 5 s, x = 6.5 m.
    Then the forces on both sides drive the motion back."""
    text = braked(condition, FRICTION[0], 1.0, "reinit(der(x), -3 [m/s]);")
    run = lagc.loads(text).compile(backend="numpy").simulate(4.5)
    assert run.status == "ok" and len(run.events) <= 2
    assert run.states[-1][:2] == pytest.approx([8.0 - 3.0 * 0.5 + 1.5 * 0.25, -1.5], abs=1e-12)
    failed = lagc.loads(text).compile(backend="numpy").simulate(6.0)
    assert failed.status == "failed" and "at t = 5 s der(x) passes 0" in failed.message


def test_a_mark_does_not_continue_a_motion_that_cannot_continue() -> None:
    text = braked("der(x) <= 0", FRICTION[0], 1.0, 'mark("stops");')
    run = lagc.loads(text).compile(backend="numpy").simulate(6.0)
    assert run.status == "failed" and "at t = 4 s der(x) passes 0" in run.message
    assert "stops" in [event.name for event in run.events]


@pytest.mark.parametrize("condition", ["der(x) <= 0", "m*der(x) <= 0"])
def test_a_mark_tells_where_a_block_sticks(condition: str) -> None:
    text = braked(condition, FRICTION[0], 0.0, 'mark("stops");')
    run = lagc.loads(text).compile(backend="numpy").simulate(6.0)
    assert run.status == "ok" and run.states[-1][:2] == pytest.approx([4.0, 0.0], abs=1e-12)
    assert [e.t for e in run.events if e.name == "stops"] == pytest.approx([2.0])


# -- stick and slip on a belt --

STIFFNESS, BELT, STATIC, KINETIC = 10.0, 0.5, 5.0, 3.0


def belt_at(t: float) -> float:
    """x: it sticks until k x is the static limit, and slips in a circle of x and x'/omega about the place
    where the kinetic force holds it, until it is as fast as the belt again."""
    omega, x = sqrt(STIFFNESS), 0.0
    while True:
        stuck = (STATIC / STIFFNESS - x) / BELT
        if t < stuck:
            return x + BELT * t
        t -= stuck
        a, b = (STATIC - KINETIC) / STIFFNESS, BELT / omega
        turn = 2.0 * (pi + atan2(-a, b))
        phase = min(omega * t, turn)
        x = KINETIC / STIFFNESS + a * cos(phase) + b * sin(phase)
        if phase < turn:
            return x
        t -= turn / omega


STICKS = "when der(x) {sign} vb then reinit(der(x), vb); end when;"
FORMS = (
    ("if der(x) >= vb and k*x <= fs then k*x else fk*sign(vb - der(x))", STICKS.format(sign=">=")),
    ("if not der(x) < vb and abs(k*x) < fs then k*x else fk*sign(vb - der(x))", STICKS.format(sign=">")),
    ("if der(x) == vb and k*x < fs then k*x else fk*sign(vb - der(x))", STICKS.format(sign=">=")),
    ("if der(x) == vb and k*x < fs then k*x else fk*sign(vb - der(x))", ""),
    ("if der(x) >= vb then k*x else fk*sign(vb - der(x))",
     STICKS.format(sign=">") + " when k*x > fs then reinit(der(x), vb - 1e-12 [m/s]); end when;"),
)  # fmt: skip


@pytest.mark.sample(1)
@pytest.mark.parametrize("backend", ["numpy", "c"])
@pytest.mark.parametrize("friction, clauses", FORMS)
def test_a_block_sticks_to_a_belt_and_slips(friction: str, clauses: str, backend: str) -> None:
    text = f"""model Belt
      parameter Stiffness k = {STIFFNESS} [N/m];
      parameter Velocity vb = {BELT} [m/s];
      parameter Force fs = {STATIC} [N], fk = {KINETIC} [N];
      coordinate Length x(rate = vb);
      body b = Particle(mass = 1 [kg], at = {{x, 0, 0}});
      potential spring = k*x^2/2;
      force friction = ({friction})*world.x at b;
      {clauses}
    end Belt;"""
    assert belt_at(20.0) == pytest.approx(0.0500290327, abs=1e-10)
    system = lagc.loads(text).compile(backend=backend)
    for t in (5.0, 20.0) if backend == "c" else (5.0,):
        run = system.simulate(t)
        assert run.status == "ok", run.message
        assert run["x"][-1] == pytest.approx(belt_at(t), abs=1e-7)
