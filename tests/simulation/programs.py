"""Small models as Programs, and systems of both backends."""

from collections.abc import Sequence
from functools import cache
from math import cos, sin

import pytest

import lagc
from lagc.codegen.c.emit import render as render_c
from lagc.codegen.python.emit import render as render_python
from lagc.lowering.program import Program
from lagc.simulation.backends import load
from lagc.simulation.backends.compile import compiler
from lagc.simulation.system import System

needs_compiler = pytest.mark.skipif(compiler() is None, reason="there is no C compiler")
BACKENDS = pytest.mark.parametrize("backend", ["numpy", pytest.param("c", marks=needs_compiler)])

DOUBLE_PENDULUM = """model DoublePendulum "two equal point masses on rods, in absolute angles"
  parameter Mass m = 1 [kg];
  parameter Length l = 1 [m];
  coordinate Angle a(start = 2 [rad]), b(start = 2.5 [rad]);
  body upper = Particle(mass = m, at = l*{sin(a), 0, -cos(a)});
  body lower = Particle(mass = m, at = upper.position + l*{sin(b), 0, -cos(b)});
  Gravity field;
end DoublePendulum;
"""
PENDULUM = """model Pendulum
  parameter Length l = 1 [m];
  coordinate Length x(start = 0.6 [m], rate = 1.6 [m/s]), y(start = -0.8 [m], rate = 1.2 [m/s]);
  body bob = Particle(mass = 2 [kg], at = {x, 0, y});
  Gravity field(g = 9.81);
end Pendulum;
"""
BODY = """model Body "a rigid body whose point is held at the origin"
  coordinate Length x(start = -0.3 [m]), y, z(start = 0.7 [m]);
  coordinate Orientation o(rate = {0.3, 2, 1} [rad/s]);
  frame F = rotate(world, o);
  body one = Solid(mass = 1.5 [kg], inertia = {0.4, 0.9, 1.1} [kg.m2], frame = F, com = {x, y, z});
  constraint pivot: position(one) + F.x*0.3 [m] - F.z*0.7 [m] = {0, 0, 0};
  Gravity field;
end Body;
"""
SPRINGS = """model Springs "two coordinates that share a kinetic energy"
  coordinate Length x(start = 1 [m], rate = -1 [m/s]), y(start = 1 [m]);
  body one = Particle(mass = 1.5 [kg], at = {x, 0, 0});
  body two = Particle(mass = 0.5 [kg], at = {x + y, 0, 0});
  potential V = 1 [N/m]*(x^2 + 3*y^2)/2;
end Springs;
"""


def program(text: str) -> Program:
    return lagc.loads(text).compile(backend="numpy").program


def pendulum(copies: Sequence[float] = (1.0,)) -> Program:
    """A point mass (x, y) on a rod; row k is copies[k] (x^2 + y^2 - l^2)/2 = 0."""
    rows = "\n".join(f"  constraint r{k}: {c!r}*(x^2 + y^2 - l^2)/2 = 0;" for k, c in enumerate(copies))
    return program(PENDULUM.replace("end Pendulum", f"{rows}\nend Pendulum"))


def four_bar(count: int, angle: float, speed: float, spare: bool = False) -> Program:
    """`count` parallelograms in a row: cranks of length 1 on the places (i, 0), at `angle` and turning with
    `speed`, masses at their ends, joined by rods of length 1. All are in line at angle 0 and pi, where
    motions that keep the cranks parallel meet others. `spare`: a rod from the first mass to the last."""
    u, v = -speed * sin(angle), speed * cos(angle)
    lines, rods = [], [*((k, k + 1, 1.0) for k in range(count)), *([(0, count, float(count))] * spare)]
    for k in range(count + 1):
        x = f"x{k}(start = {k + cos(angle)!r}, rate = {u!r}), z{k}(start = {sin(angle)!r}, rate = {v!r})"
        lines.append(f"coordinate Length {x}; body b{k} = Particle(mass = 1, at = {{x{k}, 0, z{k}}});")
        lines.append(f"constraint crank{k}: ((x{k} - {k} [m])^2 + z{k}^2 - 1 [m2])/2 = 0;")
    for a, b, length in rods:
        square = f"(x{b} - x{a})^2 + (z{b} - z{a})^2 - {length**2} [m2]"
        lines.append(f"constraint rod{a}{b}{'s' * (b - a != 1)}: ({square})/2 = 0;")
    return program(f"model FourBar {' '.join(lines)} Gravity field; end FourBar;")


@cache
def programs() -> dict[str, Program]:
    """Return the programs by name."""
    return {
        "double pendulum": program(DOUBLE_PENDULUM),
        "pendulum": pendulum(),
        "pendulum three times": pendulum((1.0, -2.0, 0.5)),
        "body": program(BODY),
        "springs": program(SPRINGS),
        "four bars, flat": four_bar(2, 0.0, -4.0),
    }


NAMES = ("double pendulum", "pendulum", "pendulum three times", "body", "springs", "four bars, flat")


def build(program: Program, backend: str) -> System:
    sources = render_c(program) if backend == "c" else render_python(program)
    return load(program.interface, sources, backend)


@cache
def built(name: str, backend: str) -> System:
    return build(programs()[name], backend)


def rates(system: System, x: list[float], t: float = 0.0) -> tuple[int, list[float], list[float]]:
    """Return the status, the rates of the state and the multipliers."""
    xdot, lam = [0.0] * system.nx, [0.0] * system.nc
    return system.rhs(t, x, xdot, lam), xdot, lam
