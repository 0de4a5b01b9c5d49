"""Contacts written by hand: the line that the message of the run advises runs, with the same motion."""

import re

import pytest

import lagc

BOUNCE = """model Bounce
  coordinate Length z(start = 1 [m]);
  body b = Particle(mass = 1 [kg], at = {0, 0, z});
  Gravity g(g = 10 [m/s2]);
  when z < 0 [m] then
    reinit(der(z), -0.8*der(z));
  end when;
end Bounce;
"""
RUB = """model Rub
  coordinate Length x(rate = 3 [m/s]), z;
  body b = Particle(mass = 1 [kg], at = {x, 0, z});
  Gravity g(g = 10 [m/s2]);
  constraint plane: z = 0 [m];
  force pull = {1 [N], 0, 0} at b;
  force rub = {-3 [N]*sign(der(x)), 0, 0} at b;
end Rub;
"""


def line_of(message: str) -> str:
    (line,) = re.findall(r"`(constraint floor: [^`]*;)`", message)
    return str(line)


@pytest.mark.full
def test_bounces_that_accumulate() -> None:
    """They end at sqrt(2 h/g) (1 + e)/(1 - e) = 4.0249 s; the ball then rests."""
    run = lagc.loads(BOUNCE).compile(backend="numpy").simulate(6)
    assert run.status == "failed" and run.t[-1] < 4.025
    text = re.sub(r"when .*end when;", line_of(run.message), BOUNCE, flags=re.DOTALL)
    after = lagc.loads(text).compile(backend="numpy").simulate(6, points=61)
    assert after.status == "ok" and after["z"][-1] == pytest.approx(0.0, abs=1e-9)
    (rest,) = [event.t for event in after.events if event.kind == "rests"]
    assert rest == pytest.approx((2 / 10) ** 0.5 * 9.0, rel=1e-6)


@pytest.mark.full
def test_dry_friction_that_sticks() -> None:
    """0.3 of the weight of 10 N, less a pull of 1 N: it stops after 1.5 s and 2.25 m, and is held."""
    run = lagc.loads(RUB).compile(backend="numpy").simulate(2)
    assert run.status == "failed" and run.t[-1] == pytest.approx(1.5, abs=1e-2)
    kept = [line for line in RUB.splitlines() if "rub" not in line and "plane" not in line]
    text = "\n".join([*kept[:-1], line_of(run.message), kept[-1]])
    after = lagc.loads(text).compile(backend="numpy").simulate(2)
    assert after.status == "ok" and after.final["x"] == pytest.approx(2.25, rel=1e-6)
