"""A motion that is advanced call by call: the bits of the generated C, closed forms, events, copies."""

import math
import shutil
import subprocess
import time
from pathlib import Path
from typing import Any

import pytest

import lagc
from lagc.codegen.c.emit import render
from lagc.diagnostics.faults import Refused
from lagc.simulation.backends import compile as compile_
from tests.codegen.tools import of_source

CART = """model Cart
  parameter Mass M(min = 0) = 1 [kg], m(min = 0) = 0.1 [kg];
  parameter Length l(min = 0) = 0.5 [m];
  input Force u(min = -10, max = 10) = 0;
  coordinate Length x;
  coordinate Angle theta(start = 5 [deg]);
  body cart = Particle(mass = M, at = {x, 0, 0});
  body bob = Particle(mass = m, at = {x + l*sin(theta), 0, l*cos(theta)});
  force motor = u*world.x at cart;
  force loss = -0.2 [N.s/m]*velocity(cart) at cart;
  Gravity field(g = 9.81 [m/s2], direction = {0, 0, -1});
  output Energy E = energy();
end Cart;
"""
BLOCK = """model Block
  parameter Mass m = 2 [kg];
  input Force u = 0;
  coordinate Length x;
  body block = Particle(mass = m, at = {x, 0, 0});
  force push = u*world.x at block;
  when x > 1 [m] then
    terminate("there");
  end when;
end Block;
"""
ESCAPE = """model Escape
  coordinate Length x;
  body b = Particle(mass = 1 [kg], at = {x, 0, 0});
  force f = 1 [N]*sqrt(1 - x/1 [m])*world.x at b;
  initial der(x) = 1 [m/s];
end Escape;
"""
C = """#include "cart.h"
#include <stdio.h>
int main(void)
{
    static cart_work w;
    static cart_state s;
    cart_params p = cart_default_params();
    const cart_options o = cart_default_options();
    double y[CART_NY];
    int k;
    cart_bind(&p);
    cart_start(&p, s.x);
    cart_begin(&s, 0, s.x);
    for (k = 1; k <= 120; k++) {
        p.u = k % 40 < 20 ? 2 : -1.5;
        if (k == 60) {
            p.m = 0.2;
            cart_bind(&p);
        }
        if (cart_advance(&p, &s, 0.005 * k, &o, &w) || cart_outputs(&p, s.t, s.x, y, &w))
            return 1;
        printf("%a %a %a %a %a\\n", s.x[0], s.x[1], s.x[2], s.x[3], y[0]);
    }
    return 0;
}
"""


def driven(backend: str) -> list[list[float]]:
    """The motion of the program C, by a stepper."""
    s = lagc.loads(CART).compile(backend=backend).stepper()
    rows = []
    for k in range(1, 121):
        if k == 60:
            s["m"] = 0.2
        s.advance(0.005, u=2 if k % 40 < 20 else -1.5)
        rows.append([*s.x, s["E"]])
    assert s.t == 0.005 * 120 and s["u"] == 2
    return rows


@pytest.mark.full
@pytest.mark.skipif(shutil.which("gcc") is None, reason="there is no gcc")
def test_the_bits_of_generated_c(tmp_path: Path) -> None:
    program = of_source(lagc.loads(CART, "cart.lag").source, work=False)
    for name, text in {**render(program), "main.c": C}.items():
        (tmp_path / name).write_text(text)
    build = ["gcc", "-std=c99", "-ffp-contract=off", "main.c", "cart.c", "-lm", "-o", "main"]
    subprocess.run(build, cwd=tmp_path, check=True)
    ran = subprocess.run(["./main"], cwd=tmp_path, capture_output=True, text=True, check=True)
    expected = [[float.fromhex(word) for word in line.split()] for line in ran.stdout.splitlines()]
    assert driven("c") == expected
    assert driven("numpy") == expected


def test_an_input_that_switches() -> None:
    """A block under a force of +1 N, then -1 N: x = t^2/(2 m), then back to rest at 1/m s^2 N."""
    s = lagc.loads(BLOCK).compile(backend="numpy").stepper(parameters={"m": 4.0})
    for _ in range(10):
        s.advance(0.1, u=1)
    assert s.t == 1.0 and s["x"] == pytest.approx(0.125, rel=1e-12)
    for _ in range(10):
        s.advance(0.1, u=-1)
    assert s["x"] == pytest.approx(0.25, rel=1e-12) and abs(s["der(x)"]) < 1e-15


def test_a_clause_that_terminates() -> None:
    """The motion stops at x = 1 m, t = sqrt(2 m) s, and the next call goes on from there."""
    s = lagc.loads(BLOCK).compile(backend="numpy").stepper()
    while not s.ended:
        s.advance(0.3, u=1)
    assert s.t == pytest.approx(2.0, rel=1e-12) and "there" in s.ended
    assert [event.name for event in s.events] == ["when x > 1 [m]"]
    s.advance(0.5)
    assert not s.ended and not s.events and s.t == pytest.approx(2.5, rel=1e-12)


@pytest.mark.parametrize("backend", ["numpy", pytest.param("c", marks=pytest.mark.full)])
@pytest.mark.parametrize("name", ["bouncing_ball", "sampled_pd"])
def test_the_events_of_a_run(name: str, backend: str) -> None:
    system = lagc.load(name).compile(backend=backend)
    s, found, run = system.stepper(), [], system.simulate(stop=1.5, rtol=1e-9)
    for _ in range(15):
        s.advance(0.1)
        found += s.events
    assert [e.name for e in found] == [e.name for e in run.events] and found
    assert [e.t for e in found] == pytest.approx([e.t for e in run.events], rel=1e-9)


@pytest.mark.parametrize("backend", ["numpy", pytest.param("c", marks=pytest.mark.full)])
def test_copies_and_resets(backend: str) -> None:
    """A copy makes the same bits as its original; restored and reset motions repeat theirs."""
    s = lagc.loads(CART).compile(backend=backend).stepper(starts={"theta": (10, "deg")})
    first = s.copy()

    def motion(stepper: Any) -> list[list[float]]:
        rows = []
        for _ in range(5):
            stepper.advance(0.01, u=1.0)
            rows.append([stepper.t, *stepper.x])
        return rows

    begin = motion(s)
    twin = s.copy()
    later = motion(s)
    assert motion(twin) == later
    s.restore(first)
    assert motion(s) == begin and s["theta"] != math.radians(10)
    s.reset({"theta": (10, "deg")})
    assert s.t == 0.0 and s["theta"] == math.radians(10) and motion(s) == begin
    s.reset()
    assert s["theta"] == math.radians(5)


def test_values_that_are_refused() -> None:
    s = lagc.loads(CART).compile(backend="numpy").stepper()
    for wrong in (math.nan, math.inf, 11.0):
        with pytest.raises(ValueError, match="`u` must be from -10 to 10"):
            s.advance(0.1, u=wrong)
    with pytest.raises(TypeError, match="`u` must be a number, not '1'"):
        s.advance(0.1, u="1")  # type: ignore[arg-type]
    with pytest.raises(KeyError, match="theta"):
        s["thata"]
    with pytest.raises(KeyError, match="parameter or input"):
        s["theta"] = 1.0
    for wrong in (math.nan, math.inf):
        with pytest.raises(ValueError):
            s.advance(wrong)
    with pytest.raises(Refused, match="phi"):
        s.reset({"phi": 1.0})
    with pytest.raises(ValueError, match="another model"):
        s.restore(lagc.loads(BLOCK).compile(backend="numpy").stepper())
    s.advance(0.1)
    assert s.t == 0.1


@pytest.mark.parametrize("backend", ["numpy", pytest.param("c", marks=pytest.mark.full)])
def test_a_motion_that_fails(backend: str) -> None:
    """x'' = sqrt(1 - x) has no value beyond x = 1; the motion before remains, v^2/2 + 2/3 (1 - x)^(3/2)."""
    s = lagc.loads(ESCAPE).compile(backend=backend).stepper()
    with pytest.raises(ArithmeticError):
        s.advance(2.0)
    x, v = s.x
    assert 0.9 < x <= 1.0 and 0.0 < s.t < 2.0
    assert v * v / 2 + 2 / 3 * (1 - x) ** 1.5 == pytest.approx(1 / 2 + 2 / 3, rel=1e-8)


@pytest.mark.long
@pytest.mark.skipif(shutil.which("gcc") is None, reason="there is no gcc")
def test_a_step_takes_at_most_three_microseconds(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(compile_, "FLAGS", ("-O2", *compile_.FLAGS))  # as outside of the tests
    s = lagc.load("simple_pendulum").compile(backend="c").stepper()
    began = time.process_time()
    for _ in range(1_000_000):
        s.advance(0.001)
    assert time.process_time() - began < 3.0
    assert s.t == 1000.0
