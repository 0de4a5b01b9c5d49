"""Runs of generated code that estimate their own error, against closed forms."""

import subprocess
from math import cos, inf, sin, sqrt
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from lagc.base.records import replace
from lagc.codegen.c.emit import render as emit_c
from lagc.codegen.python.emit import render as emit_python
from lagc.diagnostics.faults import Source
from tests.codegen.tools import STRICT, of_model, of_source, present

OSCILLATOR = """model Oscillator
  coordinate Length x(start = 1, rate = 0);
  body b = Particle(mass = 1, at = {x, 0, 0});
  potential spring = 1/2*1[N/m]*x^2;
  output Length twice = 2*x;
end Oscillator;
"""
FALL = """model Fall "ends at the floor, 1 m below"
  coordinate Length z(start = 1, rate = 0);
  body b = Particle(mass = 1, at = {0, 0, z});
  Gravity field(g = 2);
  when z < 0 then terminate("down"); end when;
end Fall;
"""
TIMES = [0.25 * k for k in range(41)]
DRIVER = r"""
#include <stdio.h>
#include <stdlib.h>
#include "NAME.h"
static NAME_verification v; /* zeros */
int main(int argc, char **argv)
{
    NAME_params p = NAME_default_params();
    NAME_options o = NAME_default_options();
    NAME_goal g = {0};
    NAME_report r;
    NAME_status status;
    static double t[41], x0[CAPS_NX], states[41*CAPS_NX], outputs[41*(CAPS_NY + 1)];
    int k;
    (void)argc;
    for (k = 0; k < 41; k++)
        t[k] = 0.25*k;
    g.accuracy = atof(argv[1]);
    g.slice = atoi(argv[2]);
    BIND;
    NAME_start(&p, x0);
    do
        status = NAME_verified(&p, x0, t, 41, &g, NULL, &o, states, outputs, &r, &v);
    while (status == CAPS_INTERRUPTED);
    printf("%d %a %a %ld %ld %zu\n", (int)status, r.estimated, r.until, r.attempts, r.rhs, r.done);
    for (k = 0; k < (int)r.done*CAPS_NX; k++)
        printf("%a\n", states[k]);
    return 0;
}
"""


def module(text: str) -> ModuleType:
    """The generated module of a model."""
    (code,) = emit_python(of_source(Source("m.lag", text))).values()
    found = ModuleType("generated")
    exec(code, found.__dict__)
    return found


def run(m: Any, accuracy: float, scales: list[float] | None = None, **goal: float) -> Any:
    """A verified run over TIMES: status, states, outputs, report, workspace, goal."""
    g, r, v, o = m.Goal(), m.Report(), m.Verification(), m.KernelOptions(m.Options())
    g.accuracy = accuracy
    for name, value in goal.items():
        setattr(g, name, value)
    states, outputs = [[0.0] * m.NX for _ in TIMES], [[0.0] * m.NY for _ in TIMES]
    given = (m.equations().p, m.start(), TIMES, len(TIMES), g, scales, o, states, outputs, r, v)
    status = m.verified(*given)
    while status == m.INTERRUPTED:
        status = m.verified(*given)
    return status, states, outputs, r, v, g


@pytest.fixture(scope="module")
def oscillator() -> ModuleType:
    return module(OSCILLATOR)


@pytest.mark.parametrize("accuracy", [1e-3, 1e-6, 1e-9, 1e-11])
def test_the_estimate_contains_the_error(oscillator: ModuleType, accuracy: float) -> None:
    """x = cos t.  The errors are estimated to a small factor: the difference is 1 - (5/6)^8 of them, and the
    safety is 1.2 and up to 3."""
    status, states, outputs, r, v, _ = run(oscillator, accuracy)
    errors = [
        max(abs(x[0] - cos(t)) for t, x in zip(TIMES, states)),
        max(abs(x[1] + sin(t)) for t, x in zip(TIMES, states)),
        max(abs(y[0] - 2 * cos(t)) for t, y in zip(TIMES, outputs)),
    ]
    assert status == oscillator.OK and r.done == len(TIMES) and r.until == TIMES[-1]
    assert r.estimated <= accuracy
    assert v.scale == pytest.approx([2, 2, 4], rel=2e-2)  # ranges; extrema lie between compared times
    for error, bar in zip(errors, v.error):
        assert 0.8 * error <= bar <= max(12 * error, 1e-12)


def test_a_law_saves_attempts(oscillator: ModuleType) -> None:
    """The run leaves error over tolerance in the goal: the next one of the model needs one attempt."""
    *_, first, _, goal = run(oscillator, 1e-7)
    *_, second, _, _ = run(oscillator, 1e-8, law=goal.law)
    assert goal.law == pytest.approx(first.estimated / first.rtol)
    assert second.attempts == 1 and second.estimated <= 1e-8


def test_slices_change_nothing(oscillator: ModuleType) -> None:
    whole, parts = run(oscillator, 1e-8), run(oscillator, 1e-8, slice=3)
    assert whole[1] == parts[1] and whole[3].rhs == parts[3].rhs and whole[4].error == parts[4].error


def test_a_given_scale_replaces_the_range(oscillator: ModuleType) -> None:
    *_, r, v, _ = run(oscillator, 1e-6, [100.0, 0.0, 0.0])
    assert v.scale[0] == 100.0 and v.scale[1] < 3.0 and r.estimated >= v.error[1] / v.scale[1]


def test_a_limit_of_evaluations_ends_the_search(oscillator: ModuleType) -> None:
    """The accuracy is beyond double precision; what was reached is returned."""
    status, *_, r, _, _ = run(oscillator, 1e-17, most=2000)
    assert status == oscillator.OK and r.estimated > 1e-17 and r.rhs < 6000
    *_, r, _, _ = run(oscillator, 1e-3, most=50)
    assert r.estimated == inf and 0 < r.done < len(TIMES) and r.until < TIMES[-1]


def test_clauses_end_both_runs() -> None:
    """1 m is fallen through with g = 2 in 1 s; both runs end there, each at its own time."""
    m = module(FALL)
    status, states, _, r, v, _ = run(m, 1e-9)
    assert status == m.TERMINATED and r.done == 4 and r.estimated <= 1e-9
    assert v.run.t == pytest.approx(1.0, abs=1e-9)
    assert states[2][0] == pytest.approx(1 - 0.25, abs=1e-9)


def test_unordered_times_are_refused(oscillator: ModuleType) -> None:
    m = oscillator
    g, r, v, o = m.Goal(), m.Report(), m.Verification(), m.KernelOptions(m.Options())
    g.accuracy = 1e-6
    rows = [[0.0] * m.NX for _ in range(3)]
    given = (m.equations().p, m.start(), [0.0, 2.0, 1.0], 3, g, None, o, rows, [[0.0]] * 3, r, v)
    assert m.verified(*given) == m.INVALID and v.run.culprit == m.BAD_TIME


@pytest.mark.full
@pytest.mark.skipif(not present("gcc"), reason="there is no gcc")
@pytest.mark.parametrize(
    "name", ["classic/double_pendulum", "contact/bouncing_ball", "classic/stick_slip_belt"]
)
def test_c_and_python_give_the_same_bits(name: str, tmp_path: Path) -> None:
    program = of_model(name)
    program = replace(program, interface=replace(program.interface, verified=True))
    for file, text in emit_c(program).items():
        (tmp_path / file).write_text(text)
    own = name.partition("/")[2]
    bind = f"{own}_bind(&p)" if program.interface.prepared else ""
    text = DRIVER.replace("NAME", own).replace("CAPS", own.upper()).replace("BIND", bind)
    (tmp_path / "main.c").write_text(text)
    options = ["-std=c99", "-O2", *STRICT, "-Wno-conversion"]
    subprocess.run(["gcc", *options, "main.c", f"{own}.c", "-lm", "-o", "main"], cwd=tmp_path, check=True)
    (code,) = emit_python(program).values()
    m: Any = ModuleType("generated")
    exec(code, m.__dict__)
    for accuracy, slice_ in (("1e-4", "0"), ("1e-6", "7")):
        done = subprocess.run(["./main", accuracy, slice_], cwd=tmp_path, capture_output=True, text=True)
        head, *values = done.stdout.splitlines()
        status, states, _, r, _, _ = run(m, float(accuracy))
        found = (status, r.estimated.hex(), r.until.hex(), r.attempts, r.rhs, r.done)
        shown = head.split()
        assert [int(shown[0]), *map(int, shown[3:])] == [int(found[0]), *found[3:]]
        assert [float.fromhex(s) for s in shown[1:3]] == [r.estimated, r.until]
        assert [float.fromhex(s) for s in values] == [x for row in states[: r.done] for x in row]


@pytest.mark.full
@pytest.mark.parametrize("slice_", [0, 1, 4])
def test_motions_between_events_are_compared(slice_: int) -> None:
    """A block that sticks and slips has one or two steps between events. At recorded times within these, the
    error is that of the dense output.  The reference is 1e5 times as accurate."""
    m = module((Path(__file__).parents[2] / "models" / "classic" / "stick_slip_belt.lag").read_text())
    _, exact, *_ = run(m, 1e-9)
    status, states, _, r, v, _ = run(m, 1e-4, slice=slice_)
    assert status == m.OK and r.estimated <= 1e-4 and 0.0 < v.time_error <= 1e-4 * TIMES[-1]
    for i in range(2):
        error = max(abs(x[i] - y[i]) for x, y in zip(states, exact))
        assert 0.8 * error <= v.error[i] <= 1e-4 * v.scale[i]
    assert v.scale[2] == 1.0 and v.error[2] == 0.0  # the mode


@pytest.mark.full
def test_bounces_are_verified() -> None:
    """A ball dropped from 1 m: height and time of each flight in closed form (Goldsmith, Impact, 1960)."""
    text = (Path(__file__).parents[2] / "models" / "contact" / "bouncing_ball.lag").read_text()
    m = module(text)
    status, states, _, r, v, _ = run(m, 1e-8)
    assert status == m.OK and r.estimated <= 1e-8
    p = dict(zip(m.PARAMETERS, m.default_params()))
    h, e, g = m.start()[0], next(v for k, v in p.items() if k == "e"), 9.81
    begin, speed = sqrt(2 * h / g), sqrt(2 * g * h)
    for t, x in zip(TIMES, states):
        if t <= begin:
            z = h - 0.5 * g * t * t
        else:
            since, after = t - begin, e * speed
            while after > 1e-9 and since > 2 * after / g:
                since, after = since - 2 * after / g, e * after
            z = after * since - 0.5 * g * since * since if since <= 2 * after / g else 0.0
        assert abs(x[0] - z) <= 1.2 * v.error[0] + 1e-9
