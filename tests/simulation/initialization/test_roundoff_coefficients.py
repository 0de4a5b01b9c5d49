"""Coefficients that are round-off, as cos(a) where a, a parameter or a coordinate, is a quarter turn."""

import shutil
from math import cos, pi, radians, sin

import pytest

from lagc.simulation.initialization.initialize import consistent_start
from tests.simulation.initialization.generated_starts import (
    Starts,
    program_of,
    start_of,
    stated_moves,
    system_of,
)

needs_gcc = pytest.mark.skipif(shutil.which("gcc") is None, reason="there is no gcc")

MODEL = """\
model M
  parameter Angle a = {a!r} [deg];
  coordinate Length x(start = 1.5 [m], rate = -2 [m/s]), z(start = 0 [m], rate = 0, fixed = true), w;
  frame F = rotate_{axis}(world, a);
  body b = Particle(mass = 1, at = {{x, w, z}});
  constraint c: z = dot(x*F.{own}, world.{other});
  constraint d: w = 3*x;
  constraint e: 2*z = {zero}(a)*w;
end M;
"""


def model(quarters: float, axis: str) -> str:
    """What of a turned axis lies along one that it is square to, for a whole number of quarter turns."""
    own, other = {"x": ("y", "z"), "y": ("z", "x"), "z": ("x", "y")}[axis]
    zero = "cos"
    if round(quarters) % 2:  # the axis that was turned lies along the other
        other = own
    else:
        zero = "sin"
    return MODEL.format(a=90 * quarters, axis=axis, own=own, other=other, zero=zero)


@pytest.mark.sample(0, 3)
@needs_gcc
@pytest.mark.parametrize("axis", "xyz")
@pytest.mark.parametrize("quarters", [1, 2, -3, 7, 40, -1001])
def test_a_rounded_quarter_turn_moves_nothing(quarters: int, axis: str) -> None:
    twins = Starts(program_of(model(quarters, axis)))
    levels = twins.interface.start_levels
    found = twins.by_python(0.0, twins.guess, levels)
    assert repr(found) == repr(twins.by_c(0.0, twins.guess, None))
    assert found[0] == 0
    start = dict(zip((*twins.interface.q_names, *twins.interface.v_names), found[2]))
    assert (start["x"], start["z"], start["der(x)"], start["der(z)"]) == (1.5, 0.0, -2.0, 0.0)
    assert (start["w"], start["der(w)"]) == pytest.approx((4.5, -6.0), rel=1e-14)


@pytest.mark.sample(2)
@pytest.mark.parametrize("off", [1e-2, 1e-4, 1e-6, -1e-6])
def test_what_is_a_coefficient_counts(off: float) -> None:
    """The turn is none of quarters, and z = 0 asks for x = 0."""
    a = 90.0 + off
    assert abs(cos(radians(a))) > 1e-14 and abs(sin(radians(a))) > 0.9
    start = start_of(model(a / 90.0, "z"))
    assert (start["x"], start["w"]) == pytest.approx((0.0, 0.0), abs=1e-12)


def test_beside_a_jump_a_coefficient_is_what_it_is() -> None:
    """A parameter where a comparison changes: one last place less, and the row is another."""
    text = """\
model M
  parameter Real p = 1;
  coordinate Length x(start = 1 [m]), z(start = 0 [m], fixed = true);
  body b = Particle(mass = 1, at = {x, 0, z});
  constraint c: z = (if p >= 1 then 1 else 2)*x;
end M;
"""
    assert start_of(text)["x"] == 0.0


CRANK = """\
model Crank
  parameter Length r = 0.1 [m];
  coordinate Angle a(start = {angle!r} [rad]), b;
  coordinate Length s(rate = 0.5 [m/s]), h;
  body p = Particle(mass = 1, at = {{s, h, 0}});
  body c = Solid(mass = 1, inertia = {{1, 1, 1}}, frame = rotate_z(world, a), com = {{0, 0, 0}});
  body d = Solid(mass = 1, inertia = {{1, 1, 1}}, frame = rotate_z(world, b), com = {{0, 0, 0}});
  constraint k: der(s) = r*cos(a)*der(a) + {other};
end Crank;
"""


@pytest.mark.sample(1)
@pytest.mark.parametrize("turns", (-1.5, -0.5, 0.5, 1.5, 10.5))
def test_rounding_is_no_lever(turns: float) -> None:
    """Where cos(a) is zero but for rounding, a' moves nothing: b' does all, or h', or nothing can."""
    angle = turns * pi
    for other, name, value in (("r*der(b)", "der(b)", 5.0), ("3*der(h)", "der(h)", 0.5 / 3)):
        system = system_of(CRANK.format(angle=angle, other=other))
        start = consistent_start(system)
        found = dict(zip([*system.interface.q_names, *system.interface.v_names], start.x))
        assert stated_moves(start) == []
        assert found[name] == pytest.approx(value, rel=1e-12) and abs(found["der(a)"]) < 1e-12
    alone = consistent_start(system_of(CRANK.format(angle=angle, other="0*r*der(b)")))
    assert "der(s)" in stated_moves(alone)
    found = dict(zip([c.name for c in alone.changes], [c.used for c in alone.changes]))
    assert found["der(s)"] == pytest.approx(0.0, abs=1e-12)
