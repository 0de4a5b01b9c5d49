"""Contacts of systems that do not depend on each other: each moves as it does alone."""

import math
from collections.abc import Sequence
from types import CodeType
from typing import Any

import pytest

import lagc
from lagc.api import Run
from lagc.simulation.backends import python

BACKENDS = ["numpy", pytest.param("c", marks=pytest.mark.full)]
G = 9.81
TIME = (
    1e-13  # s: event times are located to the spacing of floating-point numbers, with those of others beside
)


def _balls(heights: Sequence[float], restitution: float = 0.5, more: str = "", law: str = "newton") -> str:
    n = len(heights)
    return f"""model Balls
  coordinate Length y[{n}](start = {{{", ".join(map(str, heights))}}} [m]);
  Gravity field(g = {G} [m/s2], direction = {{0, -1, 0}});
  for i in 1:{n} loop
    body ball[i] = Particle(mass = 1 [kg], at = {{i*1 [m], y[i], 0}});
    constraint floor[i]: y[i] >= 0 (restitution = {restitution}, law = {law});
  end for;
{more}  scene s
    simulate(stop = 2 [s]);
  end s;
end Balls;
"""


def _run(text: str, backend: str = "numpy", **values: Any) -> Run:
    compiled = lagc.loads(text).compile(backend=backend)
    run = compiled.simulate(method="dop853", rtol=1e-9, points=3, **values)
    assert run.status == "ok"
    return run


def _blocks(text: str) -> int:
    return len(lagc.loads(text).compile(backend="numpy").interface.blocks)


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("law", ["newton", pytest.param("poisson", marks=pytest.mark.full)])
def test_each_ball_moves_as_if_it_were_alone(backend: str, law: str) -> None:
    """Flights of 2 e^n sqrt(2h/g), and rest at sqrt(2h/g)(1 + e)/(1 - e), at the times of the single ball."""
    heights = (1.0, 0.6)
    run = _run(_balls(heights, law=law), backend)
    for i, h in enumerate(heights, 1):
        alone = _run(_balls([1.0], law=law), backend, starts={"y[1]": h}).events
        own = [e for e in run.events if e.contact == f"floor[{i}]"]
        assert [e.kind for e in own] == [e.kind for e in alone]
        assert [e.t for e in own] == pytest.approx([e.t for e in alone], abs=TIME)
        assert [e.impulse for e in own] == pytest.approx([e.impulse for e in alone], rel=1e-9)
        fall = math.sqrt(2.0 * h / G)
        for n, event in enumerate(own[:-1]):
            assert event.t == pytest.approx(
                fall * (1.0 + 2.0 * sum(0.5**j for j in range(1, n + 1))), abs=1e-12
            )
        assert own[-1].kind == "rests" and own[-1].t == pytest.approx(3.0 * fall, abs=1e-12)
        assert run.final[f"y[{i}]"] == 0.0 == run.final[f"der(y[{i}])"]


def test_impacts_at_once_in_several_blocks() -> None:
    """Equal heights: each event has an impact of both, with impulses m (1 + e) e^n sqrt(2gh)."""
    run = _run(_balls((1.0, 1.0)))
    one, other = ([e for e in run.events if e.contact == f"floor[{i}]"] for i in (1, 2))
    assert [(e.t, e.impulse) for e in one] == [(e.t, e.impulse) for e in other] and len(one) > 10
    for n, event in enumerate(one[:-1]):
        assert event.impulse == pytest.approx(1.5 * 0.5**n * math.sqrt(2.0 * G), rel=1e-6)


SLIDING = """  coordinate Length x(rate = 3 [m/s]), z;
  body puck = Particle(mass = 2 [kg], at = {x, z, 0});
  constraint ice: z >= 0 (friction = 0.2, slip = der(x));
"""
WEIGHED = """  coordinate Length u, w;
  body box = Particle(mass = 2 [kg], at = {u, w, 0});
  force push = {4 [N/s]*time, 0, 0} at box;
  constraint ground: w >= 0 (friction = 0.5, slip = der(u));
"""


@pytest.mark.full
def test_friction_beside_bounces() -> None:
    """A puck stops at v/(mu g) and stays, whatever bounces beside it; a box slips when its push, which grows
    with time, exceeds mu m g."""
    run = _run(_balls((1.0,), more=SLIDING + WEIGHED, restitution=0.8), stop=3.0)
    stop, start = (next(e for e in run.events if e.contact == name) for name in ("ice", "ground"))
    assert stop.kind == "sticks" and stop.t == pytest.approx(3.0 / (0.2 * G), abs=1e-11)
    assert run.final["x"] == pytest.approx(9.0 / (0.4 * G), rel=1e-10) and run.final["der(x)"] == 0.0
    assert start.kind == "slips" and start.t == pytest.approx(0.5 * 2.0 * G / 4.0, abs=1e-9)


COLLIDING = """model Meeting
  coordinate Length x1(rate = 2 [m/s]), z1(start = 0.5 [m]), x2(start = 1 [m]), z2;
  Gravity field(g = 9.81 [m/s2]);
  body one = Particle(mass = 1 [kg], at = {x1, 0, z1});
  body two = Particle(mass = 1 [kg], at = {x2, 0, z2});
  constraint floor1: z1 >= 0 (restitution = 0.5);
  constraint floor2: z2 >= 0;
  constraint pair: x2 >= x1 + 0.1 [m] (restitution = 1);
  scene s
    simulate(stop = 2 [s]);
  end s;
end Meeting;
"""


def test_blocks_that_meet() -> None:
    """Two bodies, one of which bounces, meet at .9/2 s and exchange their speeds; the bounces go on."""
    run = _run(COLLIDING)
    (meets,) = (e for e in run.events if e.contact == "pair")
    assert meets.t == pytest.approx(0.45, abs=1e-13) and meets.impulse == pytest.approx(2.0)
    assert run.final["der(x1)"] == 0.0 and run.final["der(x2)"] == pytest.approx(2.0)
    bounces = [e.t for e in run.events if e.contact == "floor1" and e.kind == "impact"]
    fall = math.sqrt(1.0 / G)
    for n, t in enumerate(bounces):
        assert t == pytest.approx(fall * (1.0 + 2.0 * sum(0.5**j for j in range(1, n + 1))), abs=1e-12)


COUPLED = {
    "spring": ("  potential spring = 50 [N/m]*(y[1] - y[2])^2;\n", 2),
    "damper": ("  dissipation damper = 5 [N.s/m]*(der(y[1]) - der(y[2]))^2;\n", 2),
    "rod": ("  constraint rod: y[1] = y[2];\n", 2),
    "pair": ("  constraint pair: y[2] >= y[1];\n", 2),
    "clause": ("  when y[1] < 0.5 [m] then\n    reinit(der(y[2]), 1 [m/s]);\n  end when;\n", 3),
    "nothing": ("", 3),
}


@pytest.mark.sample(3)
@pytest.mark.parametrize("name", COUPLED)
def test_blocks_are_systems_that_do_not_depend_on_each_other(name: str) -> None:
    """Inertia, forces, constraints, contacts and clauses connect; a floor that is fixed does not."""
    more, count = COUPLED[name]
    expected = 2 if name == "clause" else count
    assert _blocks(_balls((1.0, 2.0, 3.0), more=more)) == expected


def test_impacts_that_follow_within_a_step() -> None:
    """Six balls land at sqrt(2h/g), by pairs within 1e-1 to 1e-5 of a step: none is passed over while parts
    of the step are searched for the gaps of others, and each leaves beside those that come."""
    heights = (1.0, 1.00001, 1.003, 1.1, 1.1001, 0.99)
    run = _run(_balls(heights), stop=1.2)
    for i, h in enumerate(heights, 1):
        fall = math.sqrt(2.0 * h / G)
        found = [e.t for e in run.events if e.contact == f"floor[{i}]"]
        assert found[:2] == pytest.approx([fall, 2.0 * fall], abs=1e-12)


def test_a_ball_at_rest_follows_an_input() -> None:
    """The forces that are kept of a ball at rest do not outlast a change of what lifts it, F/m - g."""
    lift = "  input Force F = 0 [N];\n  force lift = {0, F, 0} at ball[1];\n"
    s = lagc.loads(_balls((0.0, 1.0), more=lift)).compile(backend="numpy").stepper(method="dop853", rtol=1e-9)
    s.advance(0.3)
    s.advance(0.3)
    assert s["y[1]"] == 0.0
    s.advance(0.5, F=G + 2.0)
    assert s["y[1]"] == pytest.approx(0.25, rel=1e-9)


@pytest.mark.usefixtures("no_cache")
def test_forces_that_cannot_change_are_not_solved_for_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """A ball at rest beside a pendulum and a ball that bounces: its law is solved where the run begins, not
    in each step or at each impact of the other one, which has three laws of its own."""
    counts = {"law": 0, "stages": 0}
    executed = python.executed

    def counting(code: Sequence[CodeType]) -> dict[str, Any]:
        module = executed(code)
        solve, stages = module["solve_frozen"], module["dop853_stages"]

        def solved(law: Any) -> bool:
            counts["law"] += 1
            return bool(solve(law))

        def staged(*values: Any) -> Any:
            counts["stages"] += 1
            return stages(*values)

        module.update(solve_frozen=solved, dop853_stages=staged)
        return module

    monkeypatch.setattr(python, "executed", counting)
    swing = "  body bob = Particle(mass = 1 [kg], at = {sin(a), cos(a), 1}*1 [m]);\n"
    run = _run(_balls((0.0, 1.0), more=f"  coordinate Angle a(start = 1 [rad]);\n{swing}"), stop=1.5)
    impacts = len(run.events)
    assert run.final["y[1]"] == 0.0 and impacts > 1 and {e.contact for e in run.events} == {"floor[2]"}
    assert counts["stages"] > 2 * impacts and counts["law"] <= 4 + 3 * impacts
