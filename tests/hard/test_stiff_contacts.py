"""Springs that act on one side only, of any stiffness, in generated C with its default options.

A first step into a stiff wall is far too long: its stages explode.  Such a step must be rejected, whatever
it shows of itself.  Truth: flight between two walls and half periods of a harmonic motion in them, in closed
form; SciPy's DOP853 from kink to kink for a floor with loss.
"""

import random
import re
import shutil
import subprocess
from math import cos, inf, isclose, pi, sin, sqrt
from pathlib import Path

import pytest
from scipy.integrate import solve_ivp

import lagc
from lagc.codegen.c.emit import render
from lagc.codegen.identifiers import prefix as prefix_of

pytestmark = pytest.mark.skipif(shutil.which("gcc") is None, reason="there is no gcc")

WALLS = """\
model Walls
  parameter Mass m = 1 [kg];
  parameter Stiffness right = 1e4, left = 1e4;
  parameter Length x0 = 0;
  parameter Velocity v0 = 3;
  coordinate Length x(start = x0, rate = v0);
  body ball = Particle(mass = m, at = {x, 0, 0});
  potential in_right = 1/2*right*max(x - 1[m], 0[m])^2;
  potential in_left = 1/2*left*max(-x - 1[m], 0[m])^2;
end Walls;
"""
FLOOR = """\
model SoftFloor
  parameter Mass m = 1 [kg];
  parameter Stiffness k = 2e4;
  parameter Real[N.s/m2] c = 300;
  parameter Length z0 = 1;
  parameter Velocity v0 = 0;
  coordinate Length z(start = z0, rate = v0);
  body ball = Particle(mass = m, at = {0, 0, z});
  Gravity field(g = 9.81 [m/s2]);
  potential floor = 1/2*k*max(-z, 0[m])^2;
  dissipation loss = 1/2*c*max(-z, 0[m])*der(z)^2;
end SoftFloor;
"""
MAIN = """\
#include <stdio.h>
#include <string.h>
#include "NAME.h"

int main(void)
{
    static NAME_work w;
    static NAME_state s;
    double given[5], end, rtol;
    int method;
    while (scanf("%lf %lf %lf %lf %lf %lf %lf %d", given, given + 1, given + 2, given + 3, given + 4,
                 &end, &rtol, &method) == 8)
        for (int way = 0; way < 3; way++) {
            NAME_params p = NAME_default_params();
            NAME_options o = NAME_default_options();
            int status = NAME_OK;
            memcpy(&p, given, sizeof given);
            NAME_bind(&p);
            o.method = method;
            o.max_steps = 1000000;
            if (rtol > 0)
                o.rtol = rtol;
            memset(&w, 0, sizeof w);
            NAME_start(&p, s.x);
            NAME_begin(&s, 0.0, s.x);
            if (way == 0)
                while (status == NAME_OK && s.t < end)
                    status = NAME_step(&p, &s, end, &o, &w);
            else if (way == 1)
                status = NAME_advance(&p, &s, end, &o, &w);
            else {
                double times[20], states[20 * NAME_NX];
                size_t done = 0;
                for (int i = 0; i < 20; i++)
                    times[i] = i < 19 ? end * (i + 1) / 20 : end;
                status = NAME_record(&p, &s, &o, times, 20, states, &done, 0, &w);
            }
            printf("%d %.17g %.17g\\n", status, s.x[0], s.x[1]);
        }
    return 0;
}
"""


def build(text: str, folder: Path) -> Path:
    """The program that reads cases and prints a status and a state for step, advance and record each."""
    program = lagc.loads(text).compile().program
    name = prefix_of(program.interface.model)
    sources = {
        **render(program),
        "main.c": re.sub("NAME(?=_[A-Z])", name.upper(), MAIN).replace("NAME", name),
    }
    for file, source in sources.items():
        (folder / file).write_text(source)
    units = [file for file in sources if file.endswith(".c")]
    subprocess.run(["gcc", "-std=c99", "-O1", *units, "-lm", "-o", "main"], cwd=folder, check=True)
    return folder / "main"


def ends(program: Path, cases: list[tuple[float, ...]]) -> list[list[tuple[int, float, float]]]:
    text = "".join(" ".join(map(repr, case)) + "\n" for case in cases)
    lines = subprocess.run([program], input=text, capture_output=True, text=True, check=True).stdout.split(
        "\n"
    )
    rows = [(int(a), float(b), float(c)) for a, b, c in (line.split() for line in lines if line)]
    assert len(rows) == 3 * len(cases)
    return [rows[3 * i : 3 * i + 3] for i in range(len(cases))]


def between_walls(m: float, right: float, left: float, x: float, v: float, end: float) -> tuple[float, float]:
    while end > 0.0:
        flight = (1.0 - x) / v if v > 0.0 else (-1.0 - x) / v if v < 0.0 else inf
        if flight >= end:
            return x + v * end, v
        end -= flight
        x = 1.0 if v > 0.0 else -1.0
        omega = sqrt((right if v > 0.0 else left) / m)
        if pi / omega >= end:
            return x + v / omega * sin(omega * end), v * cos(omega * end)
        end -= pi / omega
        v = -v
    return x, v


def on_floor(m: float, k: float, c: float, z: float, v: float, end: float) -> tuple[float, float]:
    def rates(_: float, y: tuple[float, float]) -> tuple[float, float]:
        depth = max(-y[0], 0.0)
        return y[1], -9.81 + (k - c * y[1]) * depth / m

    def touches(_: float, y: tuple[float, float]) -> float:
        return y[0]

    touches.terminal = True  # type: ignore[attr-defined]
    t = 0.0
    while t < end:
        run = solve_ivp(rates, (t, end), (z, v), "DOP853", events=touches, rtol=1e-13, atol=1e-13)
        t, z, v = float(run.t[-1]), float(run.y[0][-1]), float(run.y[1][-1])
        if run.status == 1:  # on to the other side of the kink
            h = min(1e-12, end - t)
            t, z = t + h, z + h * v
    return z, v


def drawn(seed: int, n: int) -> list[tuple[float, ...]]:
    """Masses, two stiffnesses, a place, a speed; end, tolerance (0: the default), method."""
    dice = random.Random(seed)
    return [
        (
            dice.uniform(0.5, 2.0), 10.0 ** dice.uniform(1.0, 9.0), 10.0 ** dice.uniform(1.0, 9.0),
            dice.uniform(-1.0, 1.0), dice.uniform(-3.0, 3.0), dice.uniform(0.5, 3.0),
            (0.0, 1e-4, 1e-9)[i % 3], (0, 1, 3)[i // 3 % 3],
        )
        for i in range(n)
    ]  # fmt: skip


# The local tolerance is no bound of the global error: some contacts at 1e-4 cost two digits.
CLOSE = {0.0: 1e-3, 1e-4: 0.1, 1e-9: 1e-5}


@pytest.mark.full
@pytest.mark.parametrize("n", [18, 300])
def test_walls_of_any_stiffness(n: int, tmp_path: Path) -> None:
    cases = drawn(1, n)
    for case, found in zip(cases, ends(build(WALLS, tmp_path), cases), strict=True):
        x, v = between_walls(*case[:6])
        for status, *state in found:
            assert status == 0, case
            assert state == pytest.approx([x, v], rel=0.0, abs=CLOSE[case[6]] * (1.0 + abs(v))), case


@pytest.mark.sample(1)
@pytest.mark.parametrize("n", [18, 300])
def test_floors_with_loss(n: int, tmp_path: Path) -> None:
    cases = [(m, k, c**0.5, abs(z), v, *rest) for m, k, c, z, v, *rest in drawn(2, n)]
    for case, found in zip(cases, ends(build(FLOOR, tmp_path), cases), strict=True):
        z, v = on_floor(*case[:6])
        for status, *state in found:
            assert status == 0, case
            assert state == pytest.approx([z, v], rel=0.0, abs=CLOSE[case[6]] * (1.0 + abs(v))), case


def test_the_default_options_meet_a_soft_floor(tmp_path: Path) -> None:
    case = (1.0, 2e4, 300.0, 1.0, 0.0, 3.0, 0.0, 0)
    assert isclose(on_floor(*case[:6])[0], 0.00954811, rel_tol=1e-6)
    for status, z, _ in ends(build(FLOOR, tmp_path), [case])[0]:
        assert status == 0
        assert z == pytest.approx(0.00954811, abs=1e-6)
