"""Conditions of a start that share no unknown are evaluated some at a time: to the bit as all together."""

from __future__ import annotations

import random
import subprocess
from array import array
from math import sin
from pathlib import Path
from typing import Any

import pytest

import lagc
from lagc.compiler import pipeline
from lagc.simulation.initialization.solver import Conditions
from lagc.simulation.system import System
from tests.codegen.test_functions import needs_gcc

pytestmark = pytest.mark.usefixtures("own_cache")

BAR = """model FourBar
  parameter Length a = 0.2, b = 1, c = 0.7, d = 1;
  coordinate Angle p(start = 0.3, rate = 1), q(start = 0.5), s(start = 1);
  point A = {a*cos(p), 0, a*sin(p)};
  point B = A + {b*cos(q), 0, b*sin(q)};
  body m1 = Particle(mass = 1, at = A);
  body m2 = Particle(mass = 1, at = B);
  constraint over: B.x = d + c*cos(s);
  constraint up: B.z = c*sin(s);
end FourBar;
"""
BARS = BAR + "model Bars structural Integer n = 30; FourBar f[n]; Gravity g; end Bars;"
# beside others: a pendulum without a twin, which time moves, and rods of another number
MIXED = (
    BAR
    + """model Mixed
  structural Integer n = 30, m = 5;
  FourBar f[n];
  coordinate Length x[m](start = 0.5), z[m](each start = -0.5), u(start = 0.6), w(start = 0.8);
  for i in 1:m loop
    body b[i] = Particle(mass = 1, at = {x[i], 0, z[i]});
    constraint rod[i]: norm(position(b[i])) = exp(0.1*i)*1 [m];
  end for;
  body own = Particle(mass = 1, at = {u, 0, w});
  constraint driven: u^2 + w^2 = 1 [m2] + 0.1 [m2/s]*time;
  Gravity g;
end Mixed;"""
)
# one of them driven in time, beside chains of rods, which have loops of their own
UNLIKE = (
    BAR
    + """model Driven
  extends FourBar;
  constraint drive: p = 0.3 + sin(time/(1 [s]));
end Driven;
model Rods
  structural Integer k = 4;
  coordinate Length x[k](start = {0.9*i for i in 1:k} [m]), z[k](each start = -0.5);
  for i in 1:k loop
    body b[i] = Particle(mass = 1, at = {x[i], 0, z[i]});
    constraint rod[i]: (x[i] - (if i > 1 then x[max(i - 1, 1)] else 0 [m]))^2
      + (z[i] - (if i > 1 then z[max(i - 1, 1)] else 0 [m]))^2 = exp(0.1*i)*1 [m2];
  end for;
end Rods;
model Unlike
  structural Integer n = 12;
  FourBar f[n];
  Driven d;
  FourBar g[n];
  Rods r[n];
  Gravity field;
end Unlike;"""
)
# each tied to the next one: no pieces
TIED = (
    BAR
    + """model Tied
  structural Integer n = 30;
  FourBar f[n];
  for i in 1:n-1 loop
    constraint tie[i]: der(f[i].p) = 2*der(f[i+1].p);
  end for;
end Tied;"""
)


def system(text: str, backend: str) -> System:
    return lagc.loads(text).compile(backend=backend).system


@pytest.mark.sample(0, 2)
@pytest.mark.parametrize("backend", ["numpy", "c"])
@pytest.mark.parametrize("text, number", [(BARS, 30), (MIXED, 36), (UNLIKE, 37)])
def test_some_at_a_time_are_what_all_are(text: str, number: int, backend: str) -> None:
    own = system(text, backend)
    pieces = own.interface.pieces
    assert set(pieces) - {-1} == {*range(number)}
    chance = random.Random(1)
    x = [chance.uniform(-1.0, 1.0) for _ in range(own.nq + own.nv)]
    found: list[list[float]] = []
    for turn in range(60):
        touched = [chance.randrange(len(x)) for _ in range(chance.choice([0, 1, 1, 1, 2, 3]))]
        for k in touched:
            x[k] = chance.choice([0.0, -0.0, 1e200, chance.uniform(-2.0, 2.0)])
        t = 0.5 * (turn // 20)
        if turn % 20 == 0:  # all of them, in lists that are longer than need be
            found = [[*(-7.0 for _ in values), -7.0] for values in own.conditions(t, x)]
            first, last = 0, number
        else:
            of = [pieces[k] for k in touched if k < len(pieces) and pieces[k] >= 0]
            first, last = min(of, default=3), max(of, default=2) + 1
        own.some_conditions(t, x, *found, first, last)
        assert same(found, own.conditions(t, x))


def same(found: list[list[float]], all_: tuple[list[float], ...]) -> bool:
    """To the bit, and nothing behind."""
    return [array("d", a).tobytes() for a in found] == [array("d", [*a, -7.0]).tobytes() for a in all_]


LARGE = """model Small
  coordinate Angle psi(start = 0.2);
  coordinate Length x(start = 1), y(start = 0.1);
  body p = Particle(mass = 1, at = {x, y, 0});
  body w = Solid(mass = 1, inertia = {1, 1, 1}, frame = rotate_z(world, psi), com = {x, y, 0});
  constraint skid: der(x)*sin(psi) = der(y)*cos(psi);
initial
  der(x)^2 + der(y)^2 = 1 [m2/s2];
end Small;
model Big
  coordinate Real a(start = 0.5), b(start = 0.4), c(start = 0.3);
  body p = Particle(mass = 1, at = {a, b, c}*1 [m]);
  constraint u: a = 0.1*(cos(b)*cosh(b) + b^2*tan(0.3*b) + b^3*cos(c) + sqrt(2 + c^2)*b^2);
  constraint v: b = 0.1*(c^3*sin(a) + sqrt(2 + a^2)*sqrt(2 + a^2) + sin(c)*sqrt(2 + c^2) + cosh(c)*cos(b));
end Big;
model M
  Small f[60];
  Big b, c;
end M;"""


STRICT = ["gcc", "-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-O2", "-c"]


@pytest.mark.full
@needs_gcc
def test_compilers_have_nothing_to_say(tmp_path: Path) -> None:
    """Of a piece in several segments one keeps what another reads, each where it is asked for."""
    program = lagc.loads(LARGE).compile(backend="numpy").program
    for name, text in pipeline.render(program, "c").items():
        (tmp_path / name).write_text(text)
    done = subprocess.run([*STRICT, "m.c", "-o", "m.o"], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


@pytest.mark.full
def test_what_hangs_together_has_no_pieces() -> None:
    assert not system(TIED, "numpy").interface.pieces
    assert not system(BARS.replace("n = 30", "n = 2"), "numpy").interface.pieces


@pytest.mark.sample(0, 2)
@pytest.mark.parametrize("text", [BARS, MIXED, UNLIKE], ids=["alike", "beside others", "unlike"])
def test_a_start_is_the_same_without_them(text: str, monkeypatch: pytest.MonkeyPatch) -> None:
    with_them = system(text, "numpy")
    found = lagc.loads(text).compile(backend="numpy").start()
    before = Conditions.__init__

    def without(self: Conditions, *given: object, **named: object) -> None:
        assert named.keys() == {"pieces", "some", "massless"}
        before(self, *given, massless=named["massless"])  # type: ignore[arg-type]

    monkeypatch.setattr(Conditions, "__init__", without)
    assert with_them.interface.pieces
    assert list(lagc.loads(text).compile(backend="numpy").start()) == list(found)


UNEVEN = """model Uneven
  structural Integer n = 100;
  coordinate Real a[n](each start = 0.7), b[n](each start = 0.2), c[n](each start = 0.3);
  for i in 1:n loop
    body p[i] = Particle(mass = 1, at = {a[i], b[i], c[i]}*1 [m]);
    constraint x[i]: a[i]*b[i] = sqrt(c[i])*sin(c[i]) - 0.1;
  end for;
end Uneven;"""


@pytest.mark.full
@pytest.mark.parametrize("backend", ["numpy", "c"])
def test_loops_that_leave_some_out(backend: str) -> None:
    """Of 100 rows alike the operations come out as a loop of 99, and the stores as one of 100."""
    assert set(system(UNEVEN, backend).interface.pieces) - {-1} == {*range(100)}
    one = lagc.loads(UNEVEN).compile(parameters={"n": 2}, backend=backend).start()
    many = lagc.loads(UNEVEN).compile(backend=backend).start()
    assert list(many[::100]) == list(one[::2])


@pytest.mark.full
def test_where_arithmetic_raises_in_a_piece_it_is_as_all_together() -> None:
    """The logarithm of an angle that is guessed below zero."""
    own = system(BARS.replace("d + c*cos(s)", "d + c*cos(s)*log(2 + s)"), "numpy")
    assert own.interface.pieces
    pieces, x = own.interface.pieces, [0.7] * (own.nq + own.nv)
    found = [[*values, -7.0] for values in own.conditions(0.0, x)]
    for k in (0, 2, 44, 89):
        x[k] = -2.5
        own.some_conditions(0.0, x, *found, pieces[k], pieces[k] + 1)
        assert same(found, own.conditions(0.0, x))


# a force from a table, which code looks up by a function `piece`
LOOKED_UP = BARS.replace(
    "end FourBar;", "  force drag = {table(time, {0, 1, 3} [s], {0, 2, 5} [N]), 0, 0} at B;\nend FourBar;"
)


@pytest.mark.full
@needs_gcc
def test_they_stand_beside_tables(tmp_path: Path) -> None:
    program = lagc.loads(LOOKED_UP).compile(backend="numpy").program
    assert program.interface.pieces
    ((name, text),) = pipeline.render(program, "numpy").items()
    module: dict[str, Any] = {"__name__": "bars"}
    exec(compile(text, name, "exec"), module)
    x = list(module["start"]())
    for file, text in pipeline.render(program, "c").items():
        (tmp_path / file).write_text(text)
    done = subprocess.run([*STRICT, "bars.c", "-o", "bars.o"], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    in_c = lagc.loads(LOOKED_UP).compile(backend="c")
    n = len(in_c.state_names)  # without the work
    assert list(module["rhs"](0.5, x))[:n] == list(in_c.rhs(0.5, x[:n]))


@pytest.mark.full
@pytest.mark.parametrize("backend", ["numpy", "c"])
def test_a_condition_without_slopes_is_looked_at(backend: str) -> None:
    """What is made of an unknown, but changes nowhere with it, belongs to that piece too."""
    bars = BARS.replace(
        "end FourBar;",
        """  coordinate Length u(start = U);
  body side = Particle(mass = 1, at = {u, 0, 0});
initial
  sign(u) = 1;
end FourBar;""",
    )
    assert len(lagc.loads(bars.replace("= U", "= 0.3")).compile(backend=backend).start()) == 240
    with pytest.raises(lagc.Refused):
        lagc.loads(bars.replace("= U", "= -0.3")).compile(backend=backend).start()


@pytest.mark.sample(1)
@pytest.mark.parametrize("backend", ["numpy", "c"])
def test_conditions_by_sums_are_made_together(backend: str) -> None:
    way = """model Way
      structural Integer n = 24;
      coordinate Angle x[n](each start = 0.3);
      point P[0] = {0, 0, 0};
      for i in 1:n loop
        body b[i] = Particle(mass = 1, at = {x[i], 0, 0}*1 [m]);
        point P[i] = P[i-1] + {sin(x[i]), 0, cos(x[i])}*1 [m];
      end for;
      constraint far: P[n].x = 3 [m] + 0.01 [m]*n;
    initial
      for i in 1:n loop
        der(P[i].x) = 0;
      end for;
    end Way;
    model Ways
      Way w[5];
    end Ways;"""
    own = system(way, backend)
    assert own.interface.part_ends and not own.interface.pieces
    c, _, _ = own.conditions(0.0, [0.3] * (own.nq + own.nv))
    assert c[0] == pytest.approx(24 * sin(0.3) - 3.24, rel=1e-12)
