"""Balls that touch collide where they approach each other, and only there."""

from math import pi, sqrt

import pytest

import lagc

pytestmark = pytest.mark.usefixtures("own_cache")
BOTH = pytest.mark.parametrize("backend", ["numpy", "c"])


def dropped(m1: float, m2: float, e: float) -> str:
    share = "m2*(1 + e)/(m1 + m2)", "m1*(1 + e)/(m1 + m2)"
    return f"""model Dropped
      parameter Mass m1 = {m1} [kg], m2 = {m2} [kg];
      parameter Real e = {e};
      coordinate Length y1(start = 1 [m]), y2(start = 1 [m]);
      Gravity field(g = 9.81 [m/s2], direction = {{0, -1, 0}});
      body lower = Particle(mass = m1, at = {{0, y1, 0}});
      body upper = Particle(mass = m2, at = {{0, y2, 0}});
      when y1 < 0 then reinit(der(y1), -e*der(y1)); mark("floor"); end when;
      when y2 < y1 then
        reinit({{der(y1), der(y2)}}, {{der(y1) + {share[0]}*(der(y2) - der(y1)),
                                       der(y2) - {share[1]}*(der(y2) - der(y1))}});
        mark("pair");
      end when;
    end Dropped;"""


@pytest.mark.sample(1)
@BOTH
@pytest.mark.parametrize("m1, m2", [(4.0, 1.0), (7.0, 0.3), (1.3, 0.1), (1e3, 1e-3)])
def test_balls_that_fall_together_collide_at_the_floor_first(m1: float, m2: float, backend: str) -> None:
    """Both at t = sqrt(2/g): the lower one with the floor, then with the upper one."""
    g, e = 9.81, 0.5
    system = lagc.loads(dropped(m1, m2, e)).compile(backend=backend)
    t = sqrt(2.0 / g)
    for accuracy in (1e-5, 1e-8, 1e-10):
        falling = system.simulate(0.999 * t, accuracy=accuracy)
        assert falling.status == "ok" and not falling.events, falling.events
    run = system.simulate(1.01 * t, rtol=1e-10)
    assert run.status == "ok" and [e.name for e in run.events[:2]] == ["floor", "pair"], run.events
    assert [event.t for event in run.events[:2]] == pytest.approx([t, t], abs=1e-12)
    low, high = e * g * t, -g * t
    high -= m1 * (1.0 + e) / (m1 + m2) * (high - low)
    assert run["y2"][-1] == pytest.approx(high * 0.01 * t - g * (0.01 * t) ** 2 / 2.0, abs=1e-9)


def cradle(n: int) -> str:
    return f"""model Cradle
      structural Integer n = {n};
      parameter Mass m = 1 [kg];
      parameter Length l = 1 [m], d = 0.1 [m];
      coordinate Length x[n];
      for i in 1:n loop
        body b[i] = Particle(mass = m, at = {{d*i + x[i], 0, 0}});
        potential spring[i] = 1/2*m*(1 [1/s2])*x[i]^2;
      end for;
      for i in 1:n-1 loop
        when x[i+1] < x[i] then
          reinit({{der(x[i]), der(x[i+1])}}, {{der(x[i+1]), der(x[i])}});
        end when;
      end for;
    end Cradle;"""


@pytest.mark.sample(1)
@BOTH
@pytest.mark.parametrize("rtol", [1e-5, 1e-6, 1e-7, 1e-8, 1e-10, 1e-11])
@pytest.mark.parametrize("n", [3, 5])
def test_a_blow_passes_through_balls_that_rest_in_contact(n: int, rtol: float, backend: str) -> None:
    """Balls on springs of one frequency: each half period the outer ones change roles, by n - 1 impacts."""
    system = lagc.loads(cradle(n)).compile(backend=backend)
    run = system.simulate(6.25 * pi, rtol=rtol, starts={"x[1]": -0.3})
    assert run.status == "ok", run.message
    assert len(run.events) == 6 * (n - 1)
    times = [(k + 0.5) * pi for k in range(6) for _ in range(n - 1)]
    assert [event.t for event in run.events] == pytest.approx(times, abs=100.0 * rtol)
    outer = 0.3 * sqrt(0.5)
    wanted = [0.0] * n
    wanted[0] = -outer
    assert [run[f"x[{i + 1}]"][-1] for i in range(n)] == pytest.approx(wanted, abs=100.0 * rtol)


@pytest.mark.parametrize("speed", [1.0, 1e-6, 1e-11])
def test_a_slow_approach_is_a_collision(speed: float) -> None:
    text = f"""model Slow
      coordinate Length x[2](start = {{1 [m], 1 [m] + {speed} [m]}}, rate = {{1 + {speed}, 1}});
      for i in 1:2 loop body b[i] = Particle(mass = 1 [kg], at = {{x[i], 0, 0}}); end for;
      when x[2] < x[1] then
        reinit({{der(x[1]), der(x[2])}}, {{der(x[2]), der(x[1])}});
      end when;
    end Slow;"""
    run = lagc.loads(text).compile(backend="numpy").simulate(3.0)
    assert len(run.events) == 1
    assert run.events[0].t == pytest.approx(1.0, abs=1e-14 / speed + 1e-9)
    if speed < 1e-8:  # round-off of the places, over the speed
        assert run.status == "failed" and "(the time of an event)" in run.message
    else:
        assert run.status == "ok"


@pytest.mark.full
@BOTH
def test_bounces_lower_than_round_off_end(backend: str) -> None:
    """A ball of three masses below one of a third of it stops dead on the floor: what it does there is rest,
    and not ten million bounces."""
    run = lagc.loads(dropped(3.0, 1.0, 1.0)).compile(backend=backend).simulate(0.46, rtol=1e-9)
    assert run.status == "failed" and "occurs again and again" in run.message
    assert run.cost.steps < 5000
