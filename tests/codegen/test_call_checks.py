"""Generated C and Python refuse every option, time, parameter and pointer that is not valid, with its
name."""

import math
import subprocess
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from lagc.codegen.c.emit import render
from lagc.codegen.heading import status_texts
from lagc.codegen.identifiers import prefix
from lagc.codegen.kernel_compiler.library import library
from lagc.codegen.python.emit import render as render_python
from lagc.compiler import pipeline
from lagc.diagnostics.faults import Source
from lagc.kernels import METHODS
from lagc.kernels.language import statuses
from lagc.lowering.program import Program
from tests.codegen.tools import COMPILERS, present

GIVEN = """
  parameter Mass m(min = 0.5, max = 4) = 1;
  parameter Length l(min = 0) = 1;
  parameter Acceleration g = 9.81;
  input Force u = 0;
  force drive = u*world.x at bob;
"""
MODELS = {
    "free": f"""model Swing{GIVEN}
  coordinate Angle a(start = 1);
  body bob = Particle(mass = m, at = {{l*sin(a), 0, -l*cos(a)}});
  potential V = -m*g*l*cos(a);
end Swing;
""",
    "bound": f"""model Bead{GIVEN}
  coordinate Length x(start = 1);
  coordinate Length y;
  body bob = Particle(mass = m, at = {{x, 0, y}});
  potential V = m*g*y;
  constraint wire: x^2 + y^2 = l^2;
end Bead;
""",
}
PARAMETERS = ("m", "l", "g", "u")
OPTIONS = ("method", "max_steps", "rtol", "atol", "step", "first_step", "max_step")
REALS = {"nan": math.nan, "inf": math.inf, "-inf": -math.inf, "-1": -1.0, "-5e-324": -5e-324}
NAN, INF = math.nan, math.inf
WRONG_OPTIONS: list[tuple[str, float]] = [
    *((name, value) for name in OPTIONS[2:] for value in REALS.values()),
    ("method", len(METHODS)), ("method", -1), ("method", 2**31 - 1),
    ("max_steps", -1), ("max_steps", -(2**31)),
    ("rtol", 0.0), ("rtol", 5e-324), ("rtol", 1.0), ("rtol", 1e300),
]  # fmt: skip
WRONG_TIMES = [NAN, INF, -INF]
WRONG_PARAMETERS = [
    *((name, value) for name in PARAMETERS for value in (NAN, INF, -INF)),
    ("m", 0.0), ("m", 4.000001), ("m", 1e300), ("m", 5e-324), ("l", -5e-324), ("l", -1.0),
]  # fmt: skip
# Neither nonsense nor to be met: a step that is too short, or an end that is too far.
HOPELESS = [("max_step", 5e-324), ("step", 5e-324)]

MAIN = """
#include "@file@.h"
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static @_work w;
static @_params p;
static @_options o;
static @_state s, before;
static double x0[@@_NX], states[4 * @@_NX];

static void own(void)
{
    p = @_default_params();
    @_bind(&p);
}

static void anew(void)
{
    own();
    o = @_default_options();
    o.max_steps = 2000;
    memcpy(s.x, x0, sizeof x0);
    @_begin(&s, 0.0, x0);
    (void)@_step(&p, &s, 1e-3, &o, &w);
}

static void told(const char *label, int status)
{
    before.culprit = s.culprit;
    printf("%s %d %d %d\\n", label, status, s.culprit, memcmp(&s, &before, sizeof s) == 0);
}

/* Every function that takes options, times and parameters. */
static void tried(const char *label)
{
    double times[3] = {0.0, 0.1, 0.2};
    size_t done = 0;
    int culprit = 77;
    before = s;
    times[0] = s.t;
    told(label, @_step(&p, &s, 0.2, &o, &w));
    s = before;
    told(label, @_advance(&p, &s, 0.2, &o, &w));
    s = before;
    told(label, @_record(&p, &s, &o, times, 3, states, &done, 0, &w));
    s = before;
    s.culprit = @_check(&p, &o, &culprit) == @@_INVALID ? culprit : -1;
    told(label, s.culprit < 0 ? @@_OK : @@_INVALID);
    if (@_check(&p, &o, NULL) != (s.culprit < 0 ? @@_OK : @@_INVALID) || @_check(NULL, NULL, NULL) != @@_OK)
        printf("NULL is refused\\n");
}

int main(void)
{
    double x[@@_NX], times[3] = {0.1, 0.2, 0.3};
    size_t done = 0;
    int i;
    own();
    @_start(&p, x0);
@consistent@
    anew();
    tried("good");
@cases@
    for (i = 0; i < @@_NX; i++) {
        anew();
        s.x[i] = NAN;
        before = s;
        told("state", @_advance(&p, &s, 0.2, &o, &w));
        told("state", @_step(&p, &s, 0.2, &o, &w));
        told("state", @_record(&p, &s, &o, times, 3, states, &done, 0, &w));
        told("state", @_advance(&p, &s, s.t, &o, &w));
        told("dense", @_dense(&p, &s, s.t, &o, x, &w));
        if (i < @@_NQ) { /* on which the rates depend */
            memcpy(x, x0, sizeof x);
            x[i] = INFINITY;
            s.culprit = @_rhs(&p, 0.0, x, states, NULL, &w) == @@_NOT_FINITE ? w.culprit : -2;
            told("rhs", @@_NOT_FINITE);
        }
    }
    anew();
    before = s;
    told("budget", @_record(&p, &s, &o, times, 3, states, &done, -1, &w));
    done = 4;
    told("grid", @_record(&p, &s, &o, times, 3, states, &done, 0, &w));
    done = 0;
    times[1] = 0.05;
    told("grid", @_record(&p, &s, &o, times, 3, states, &done, 0, &w));
    times[1] = NAN;
    told("grid", @_record(&p, &s, &o, times, 3, states, &done, 0, &w));
    times[1] = 0.2;
    times[0] = -1.0;
    told("grid", @_record(&p, &s, &o, times, 3, states, &done, 0, &w));
    told("good", @_record(&p, &s, &o, NULL, 0, NULL, &done, 0, &w));
    anew(); /* another grid than that which was begun */
    times[0] = s.t;
    times[1] = 0.2;
    if (@_record(&p, &s, &o, times, 3, states, &done, 1, &w) != @@_INTERRUPTED || done != 1)
        return 1;
    before = s;
    times[1] = 1e20;
    told("grid", @_record(&p, &s, &o, times, 3, states, &done, 0, &w));
    times[1] = 0.5 * times[0];
    told("grid", @_record(&p, &s, &o, times, 3, states, &done, 0, &w));
    anew(); /* farther than there are numbers */
    s.t = 1e308;
    before = s;
    told("now", @_step(&p, &s, -1e308, &o, &w));
    told("now", @_advance(&p, &s, -1e308, &o, &w));
    for (i = -3; i < 14; i++)
        printf("text %s\\n", @_status_text(i));
    return 0;
}
"""
CONSISTENT = """
    {
        static @_start_work c;
        int levels[@@_NU] = {0}, k;
        const double bad[3] = {NAN, INFINITY, -INFINITY};
        for (k = 0; k < 3; k++) {
            s.culprit = @_consistent(&p, bad[k], x0, NULL, &c) == @@_INVALID ? c.culprit : -2;
            told("clock", @@_INVALID);
        }
        for (k = 0; k < 2; k++) {
            levels[1] = k ? 5 : -1;
            s.culprit = @_consistent(&p, 0.0, x0, levels, &c) == @@_INVALID ? c.culprit : -2;
            told("level", @@_INVALID);
        }
        p.@l@ = -1.0;
        s.culprit = @_consistent(&p, 0.0, x0, NULL, &c) == @@_INVALID ? c.culprit : -2;
        told("length", @@_INVALID);
        p = @_default_params();
        s.culprit = @_consistent(&p, 0.0, x0, NULL, &c) == @@_INVALID ? c.culprit : -2;
        told("unbound", @@_INVALID);
        own();
        if (@_consistent(&p, 0.0, x0, NULL, &c) != @@_OK)
            return 1;
    }
"""
NUMBER: dict[str, int] = {name: value for name, value in vars(statuses).items() if name.isupper()}
OK, INVALID, NOT_FINITE = NUMBER["OK"], NUMBER["INVALID"], NUMBER["NOT_FINITE"]
BAD_TIME, BAD_BUDGET, BAD_LEVEL, BAD_BINDING, BAD_PARAMETER = 7, 8, 9, 10, 16


@cache
def program(name: str) -> Program:
    model = pipeline.resolve(pipeline.parse(Source(f"{name}.lag", MODELS[name])), pipeline.Choice())
    return pipeline.optimize(pipeline.derive(model), True)


def literal(value: float) -> str:
    if value != value:
        return "NAN"
    return ("-" if value < 0 else "") + ("INFINITY" if abs(value) == INF else repr(abs(value)))


def text_of_main(name: str) -> str:
    made = program(name)
    own, cases = prefix(made.interface.model), []
    for k, (option, value) in enumerate([*WRONG_OPTIONS, *HOPELESS]):
        number = f"(int)({value})" if isinstance(value, int) else literal(value)
        cases.append(f'    anew(); o.{option} = {number}; tried("option{k}");')
    for k, (parameter, value) in enumerate(WRONG_PARAMETERS):
        cases.append(f'    anew(); p.{parameter} = {literal(value)}; tried("parameter{k}");')
    cases.append('    anew(); p = @_default_params(); tried("unbound");')
    cases.append('    anew(); p.m *= 0.5; tried("unbound"); @_bind(&p); tried("good");')
    cases.append('    anew(); p.u = 0.1; tried("good");')
    for value in WRONG_TIMES:
        cases.append(f'    anew(); before = s; told("time", @_step(&p, &s, {literal(value)}, &o, &w));')
        cases.append(f'    told("time", @_advance(&p, &s, {literal(value)}, &o, &w));')
        recorded = "@_record(&p, &s, &o, times, 3, states, &done, 0, &w)"
        cases.append(f'    times[2] = {literal(value)}; told("time", {recorded}); times[2] = 0.3;')
        cases.append(f'    told("time", @_dense(&p, &s, {literal(value)}, &o, x, &w));')
        cases.append(f'    s.t = {literal(value)}; before = s; told("now", @_advance(&p, &s, 1.0, &o, &w));')
    cases.append('    anew(); before = s; told("time", @_dense(&p, &s, s.t + 1.0, &o, x, &w));')
    text = MAIN.replace("@consistent@", CONSISTENT if name == "bound" else "")
    text = text.replace("@cases@", "\n".join(cases)).replace("@l@", "l").replace("@file@", f"{name}")
    return text.replace("@@", own.upper()).replace("@", own)


@pytest.mark.full
@pytest.mark.parametrize("name", MODELS)
@pytest.mark.parametrize("compiler_", ["gcc", "zig"])
def test_c_refuses_what_is_not_valid(name: str, compiler_: str, tmp_path: Path) -> None:
    if not present(compiler_):
        pytest.skip(f"there is no {compiler_}")
    files = {("main" if k.endswith(".c") else k): v for k, v in render(program(name)).items()}
    header, source = next(k for k in files if k.endswith(".h")), files.pop("main")
    (tmp_path / header).write_text(files[header])
    (tmp_path / "model.c").write_text(source)
    (tmp_path / "main.c").write_text(text_of_main(name).replace(f'"{name}.h"', f'"{header}"'))
    command = [*COMPILERS[compiler_], "-g", "-O0", "-ffp-contract=off", "-Wall", "-Wextra", "-Werror"]
    units = ["main.c", "model.c", "-lm", "-o", "main"]
    checks = ["-fsanitize=undefined" if compiler_ == "zig" else "-fsanitize=address,undefined",
              "-fno-sanitize-recover=all"]  # fmt: skip
    for extra in (checks, []):
        done = subprocess.run([*command, *extra, *units], cwd=tmp_path, capture_output=True, text=True)
        if done.returncode == 0:
            break
    assert done.returncode == 0, done.stderr[:3000]
    ran = subprocess.run(["./main"], cwd=tmp_path, capture_output=True, text=True, timeout=60)
    assert ran.returncode == 0, ran.stderr
    lines = [line.split() for line in ran.stdout.splitlines() if not line.startswith("text")]
    expected = {"time": BAD_TIME, "now": BAD_TIME, "grid": BAD_TIME, "clock": BAD_TIME, "budget": BAD_BUDGET,
                "level": BAD_LEVEL, "unbound": BAD_BINDING,
                "length": BAD_PARAMETER + PARAMETERS.index("l")}  # fmt: skip
    expected.update({f"option{k}": OPTIONS.index(o) for k, (o, _) in enumerate(WRONG_OPTIONS)})
    for k, (parameter, _) in enumerate(WRONG_PARAMETERS):
        expected[f"parameter{k}"] = BAD_PARAMETER + PARAMETERS.index(parameter)
    hopeless = [f"option{len(WRONG_OPTIONS) + k}" for k in range(len(HOPELESS))]
    seen = dict.fromkeys(expected, 0)
    found: dict[str, list[int]] = {"state": [], "dense": [], "rhs": []}
    for label, *numbers in lines:
        status, culprit, unchanged = map(int, numbers)
        if label == "good":
            assert status == OK
        elif label in found:
            assert status == NOT_FINITE and (unchanged or label != "state")
            found[label].append(culprit)
        elif label in hopeless:
            assert status in (NUMBER["STEP_UNDERFLOW"], NUMBER["MAX_STEPS"], OK)
        else:
            assert (status, culprit, unchanged) == (INVALID, expected[label], 1), label
            seen[label] += 1
    left_out = {"clock", "level", "length"} if name == "free" else set()
    assert all(n > 0 for label, n in seen.items() if label not in left_out)
    nx = program(name).interface.nx
    assert found["state"] == [i for i in range(nx) for _ in range(4)] and found["dense"] == [*range(nx)]
    assert found["rhs"] == [*range(program(name).interface.nq)]
    told = [line[5:] for line in ran.stdout.splitlines() if line.startswith("text")]
    texts = list(status_texts(library("double"), program(name).interface))
    end = 3 + len(texts)
    assert told[3:end] == texts and set(told[:3] + told[end:]) == {"No such status."}


@cache
def module(name: str) -> Any:
    ((file, text),) = render_python(program(name)).items()
    made = ModuleType(file)
    exec(compile(text, file, "exec"), vars(made))
    return made


def attempts(m: Any, p: list[float], options: Any) -> list[Any]:
    """All functions that take options, times and parameters."""
    x = m.start() if not hasattr(m, "consistent") else m.consistent()
    run = None if options.method not in METHODS else m.Integrator(m.equations(), m.Options(), 0.0, x)
    if run is not None:
        run.options, run.problem.p[: len(p)] = options, p
        run.problem.bind()
    found = [lambda: m.check(p, options), lambda: m.integrate(0.0, x, [0.1, 0.2], p, options)]
    return [*found, lambda: run.step(0.2), lambda: run.advance(0.2)] if run is not None else found


@pytest.mark.parametrize("name", MODELS)
def test_python_refuses_what_is_not_valid(name: str) -> None:
    m = module(name)
    x = m.start() if name == "free" else m.consistent()
    for call in attempts(m, m.default_params(), m.Options()):
        call()
    for option, value in WRONG_OPTIONS:
        options = m.Options(**{option: str(value) if option == "method" else value})
        for call in attempts(m, m.default_params(), options):
            with pytest.raises(ValueError, match=f"option {option} "):
                call()
    for parameter, value in WRONG_PARAMETERS:
        p = m.default_params()
        p[PARAMETERS.index(parameter)] = value
        for call in attempts(m, p, m.Options()):
            with pytest.raises(ValueError, match=f"parameter '{parameter}' "):
                call()
    run = m.Integrator(m.equations(), m.Options(), 0.0, x)
    run.problem.p[PARAMETERS.index("m")] *= 0.5
    for call in (run.step, run.advance):
        with pytest.raises(ValueError, match=r"call .Equations.bind."):
            call(0.1)
    run.problem.bind()
    assert run.step(0.1) == m.OK
    for t in WRONG_TIMES:
        run = m.Integrator(m.equations(), m.Options(), 0.0, x)
        given = (lambda t: m.integrate(0.0, x, [0.1, t]), lambda t: m.integrate(t, x, [0.1]))
        for call in (run.step, run.advance, run.at, *given):
            with pytest.raises(ValueError, match=r"time"):
                call(t)
    for times in ([0.2, 0.1, 0.3], [0.1, NAN, 0.3], [-1.0, 0.3]):
        with pytest.raises(ValueError, match="in order"):
            m.integrate(0.0, x, times)
    for i in range(len(x)):
        run = m.Integrator(m.equations(), m.Options(), 0.0, [*x[:i], NAN, *x[i + 1 :]])
        for advance in (run.step, run.advance):
            assert advance(0.1) == m.NOT_FINITE and run.culprit == i
        assert run.advance(0.0) == m.NOT_FINITE and run.at(0.0)[0] == m.NOT_FINITE and run.culprit == i
    with pytest.raises(ValueError, match="entries"):
        m.Integrator(m.equations(), m.Options(), 0.0, x[1:])
    if name == "bound":
        for given in ({"t": NAN}, {"levels": [0, 0, 0, 9]}, {"levels": [0]}, {"p": [1.0, -1.0, 9.81, 0.0]}):
            with pytest.raises(ValueError, match=r"time|levels|parameter"):
                m.consistent(**given)


@pytest.mark.parametrize("name", MODELS)
def test_a_step_limit_counts_the_steps_of_one_call(name: str) -> None:
    """It is on by default, and a call goes on where the last one ended, with the same steps, but for one
    that was rejected there: the next call tries it as a step of its own."""
    m = module(name)
    assert 0 < m.Options().max_steps < 2**31
    x = m.start() if name == "free" else m.consistent()
    run = m.Integrator(m.equations(), m.Options(max_steps=3), 0.0, x)
    calls = 1
    while run.advance(5.0) == m.MAX_STEPS:
        assert run.steps + run.rejected == 3 * calls
        calls += 1
    assert run.t == 5.0 and calls > 3
    whole = m.Integrator(m.equations(), m.Options(), 0.0, x)
    assert whole.advance(5.0) == m.OK and whole.x == pytest.approx(run.x, rel=1e-8)
