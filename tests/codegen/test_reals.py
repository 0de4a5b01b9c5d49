"""Generated C for other types of reals: float to its own accuracy, quad against many digits."""

import os
import random
import shutil
from pathlib import Path

import mpmath
import pytest

import lagc
from lagc.cli.main import main
from lagc.codegen.c.emit import render
from lagc.codegen.identifiers import prefix
from lagc.codegen.kernel_compiler.real_types import DOUBLE, QUAD, SINGLE, TYPES, Arithmetic
from lagc.compiler import pipeline
from lagc.diagnostics.faults import Refused, Source
from lagc.lowering.program import Program
from tests.codegen.tools import MODELS, call, of_model, of_source, write

pytestmark = pytest.mark.skipif(shutil.which("gcc") is None, reason="gcc is not there")
HERE = Path(__file__).parent
WARNINGS = ["-Wall", "-Wextra", "-Wconversion", "-Wshadow", "-Werror", "-ffp-contract=off"]


def built(model: str | Program, real: Arithmetic, folder: Path) -> Path:
    """The program of `reals.c` for a model, of the library by its name."""
    program = of_model(model) if isinstance(model, str) else model
    own = prefix(program.interface.model)
    for file, text in render(program, False, real).items():
        (folder / file).write_text(text)
    header, more = f"{own}.h", ["-Wpedantic", "-Wdouble-promotion"]
    libraries = ["-lm"]
    if real == QUAD:
        more, libraries = ["-DQUAD"], ["-lquadmath", "-lm"]
    words = [f"-DPREFIX={own}", f"-DUPPER={own.upper()}", f"-DREAL={real.name}", "-include", folder / header]
    words += ["-DPREPARED"] if program.interface.prepared else []
    source = folder / header.replace(".h", ".c")
    # the driver prints doubles
    call("gcc", "-std=c99", "-O1", *WARNINGS, *more, "-c", source, "-o", folder / "model.o")
    call("gcc", "-std=gnu99", "-O1", *words, *more[-1:], "-c", HERE / "reals.c", "-o", folder / "main.o")
    call("gcc", folder / "main.o", folder / "model.o", *libraries, "-o", folder / "run")
    return folder / "run"


def end(run: Path, t1: float, rtol: str, x: list[str], method: int = 0) -> list[str]:
    status, *found = call(run, str(t1), rtol, str(method), *x).split()
    assert status == "0"
    return found


def kepler(e: str, t: str) -> list[mpmath.mpf]:
    """x, y and their rates at t of a planet with G M = a = 1 that starts where it is nearest."""
    e_, t_ = mpmath.mpf(e), mpmath.mpf(t)
    u = mpmath.findroot(lambda u: u - e_ * mpmath.sin(u) - t_, t_)
    short, rate = mpmath.sqrt(1 - e_**2), 1 / (1 - e_ * mpmath.cos(u))
    return [mpmath.cos(u) - e_, short * mpmath.sin(u), -mpmath.sin(u) * rate, short * mpmath.cos(u) * rate]


@pytest.mark.full
def test_quad_follows_a_closed_form_to_25_digits(tmp_path: Path) -> None:
    run = built("classic/kepler", QUAD, tmp_path)
    with mpmath.workdps(50):
        truth = kepler("0.6", "0.75")
        found = [mpmath.mpf(x) for x in end(run, 0.75, "1e-28", ["0.4", "0", "0", "2"])]
        assert max(abs(a - b) for a, b in zip(found, truth)) < 1e-25


@pytest.mark.full
def test_quad_keeps_a_constrained_motion_on_its_constraint(tmp_path: Path) -> None:
    """A mass on a string of 0.5 m, from rest at x = 0.3 m: its length and its energy."""
    run = built("course/string_pendulum", QUAD, tmp_path)
    with mpmath.workdps(50):
        x, z, vx, vz = (mpmath.mpf(v) for v in end(run, 0.75, "1e-28", ["0.3", "-0.4", "0", "0"])[:4])
        assert abs(x**2 + z**2 - 0.25) < 1e-31 and abs(x * vx + z * vz) < 1e-31
        assert abs((vx**2 + vz**2) / 2 + mpmath.mpf("9.81") * (z + mpmath.mpf("0.4"))) < 1e-25


# LAGC_ALL=1: with every model of the library.
NAMES = sorted(p.stem for p in (MODELS / "classic").glob("*.lag"))[:: 1 if os.environ.get("LAGC_ALL") else 6]


@pytest.mark.sample(0, 2)
@pytest.mark.parametrize("name", NAMES)
def test_float_runs_the_library_on_its_own_tolerances(name: str, tmp_path: Path) -> None:
    """A part of the motion of a scene, with floats to 1e-5: the states of doubles to a few 1e-3 of the
    largest of their kind (a few hundred steps of rounding by 6e-8, and what the motion makes of them)."""
    model = lagc.load(f"classic/{name}").compile(backend="numpy")
    stop = min(0.3, 0.3 * model.program.interface.simulate["stop"])
    truth = model.simulate(stop=stop, accuracy=1e-6)
    run = built(f"classic/{name}", SINGLE, tmp_path)
    found = [float(x) for x in end(run, float(truth.times[-1]), "1e-5", [repr(x) for x in truth.states[0]])]
    interface = model.program.interface
    n = interface.nq + interface.nv
    size = [0.0] * (max(interface.kinds) + 1)
    for x in truth.states:
        for kind, value in zip(interface.kinds, x[:n]):
            size[kind] = max(size[kind], abs(value))
    for kind, a, b in zip(interface.kinds, found, truth.states[-1]):
        assert abs(a - b) <= 5e-3 * size[kind]


@pytest.mark.full
@pytest.mark.parametrize("real", TYPES)
@pytest.mark.parametrize("over", ["time", "y/1 [m/s]"])
def test_tables_that_bend_are_of_every_type(real: str, over: str, tmp_path: Path) -> None:
    """Beyond their ends too: a force that rises and falls for 1 s each leaves 1 kg at 1 m, with 1 m/s."""
    text = """model T coordinate Length x, y(rate = 1 [m/s]); body a = Particle(mass = 1, at = {x, 0, 0});
    body b = Particle(mass = 1, at = {0, y, 0});
    force f = {table(OVER, {0, 1, 2}, {0, 1, 0}), 0, 0} at a; end T;"""
    model = pipeline.resolve(pipeline.parse(Source("t.lag", text.replace("OVER", over))), pipeline.Choice())
    run = built(pipeline.optimize(pipeline.derive(model), True), TYPES[real], tmp_path)
    x, y, vx, vy = (float(v) for v in end(run, 3.0, "1e-5", ["0", "0", "0", "1"])[:4])
    assert (x, y, vx, vy) == pytest.approx((2.0, 3.0, 1.0, 1.0), rel=1e-4)


LATE = """
#include "osc.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* t0, time between calls: prints the largest error of cos(t - t0) within 10 s */
int main(int count, char **words)
{
    const double t0 = atof(words[1]), every = atof(words[2]);
    osc_params p = osc_default_params();
    osc_options o = osc_default_options();
    static osc_work w;
    static osc_state s;
    double worst = 0.0;
    osc_start(&p, s.x);
    osc_begin(&s, (float)t0, s.x);
    for (int k = 1; k * every <= 10.0; k++) {
        if (osc_advance(&p, &s, (float)(t0 + k * every), &o, &w) != OSC_OK)
            return 1;
        worst = fmax(worst, fabs(s.x[0] - cos(s.t - t0)));
    }
    printf("%g\\n", worst);
    return count - 3;
}
"""


@pytest.mark.full
def test_late_times_of_float_lose_no_accuracy(tmp_path: Path) -> None:
    """Their spacing is 6e-5 s at 1000 s and 4e-3 s at 40000 s. The equations do not depend on time, and the
    closed form is one in the time that the state has."""
    text = "model Osc coordinate Length x(start = 1); body b = Particle(mass = 1, at = {x, 0, 0});"
    source = Source("osc.lag", text + " potential u = 1/2*1 [N/m]*x^2; end Osc;")
    files = render(of_source(source), False, SINGLE)
    paths = write({**files, "late.c": LATE}, tmp_path)
    run = tmp_path / "late"
    call("gcc", "-std=c99", "-O1", paths[".c"], tmp_path / "osc.c", "-lm", "-o", run)
    for t0 in ("0", "1000", "10000", "40000"):
        assert float(call(run, t0, "0.001")) < 1e-4, t0  # the tolerance of a step
        assert float(call(run, t0, "5")) < 1e-4, t0


@pytest.mark.full
def test_the_command_line_builds_for_floats(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["build", "double_pendulum", "--real", "float", "-o", str(tmp_path), "-q"]) == 0
    text = (tmp_path / "double_pendulum.h").read_text() + (tmp_path / "double_pendulum.c").read_text()
    assert "double " not in "\n".join(line for line in text.splitlines() if "*" not in line[:3])
    assert (
        main(["build", "double_pendulum", "--real", "float", "--target", "numpy", "-o", str(tmp_path)]) == 2
    )
    assert "--target c" in capsys.readouterr().err


# LAGC_ALL=1: every model of the library.
LIBRARY = sorted(str(p.relative_to(MODELS).with_suffix("")) for p in MODELS.rglob("*.lag"))
SAMPLE = LIBRARY if os.environ.get("LAGC_ALL") else ["course/simple_pendulum", *LIBRARY[3::25]]


def as_c_and_cpp(program: Program, real: Arithmetic, folder: Path) -> None:
    """Compiled as both without a warning.  The suffix of literals of __float128 is GNU's own."""
    files = write(render(program, real=real), folder)
    more = [] if real == QUAD else ["-Wpedantic", *(["-Wdouble-promotion"] if real == SINGLE else [])]
    for words in ["gcc", "-std=c99"], ["g++", "-x", "c++", "-std=gnu++11" if real == QUAD else "-std=c++11"]:
        call(*words, *WARNINGS, *more, "-fsyntax-only", files[".c"])


@pytest.mark.full
@pytest.mark.parametrize("name", SAMPLE)
def test_every_type_compiles_as_c_and_as_cpp(name: str, tmp_path: Path) -> None:
    for real in TYPES.values():
        as_c_and_cpp(of_model(name), real, tmp_path)


BOUNDED = """model Bounded
  parameter Mass m(min = {low}, max = {high}) = {value};
  parameter Force none;
  coordinate Length x(start = 1);
  body b = Particle(mass = m, at = {{x, 0, 0}});
  force F = none*world.x at b;
end Bounded;
"""
ASK = """
#include "bounded.h"
#include <stdio.h>
int main(void)
{
    bounded_params p = bounded_default_params();
    if (p.none == p.none)
        return 1;
    p.none = 0;
#ifdef BOUNDED_NPREPARED
    bounded_bind(&p);
#endif
    printf("%d\\n", bounded_check(&p, NULL, NULL) == BOUNDED_OK);
    return 0;
}
"""


def bounded(low: str, high: str, value: str) -> Program:
    source = Source("b.lag", BOUNDED.format(low=low, high=high, value=value))
    model = pipeline.resolve(pipeline.parse(source), pipeline.Choice())
    return pipeline.optimize(pipeline.derive(model), True)


@pytest.mark.sample(0, 2)
@pytest.mark.parametrize("real", TYPES)
def test_a_value_on_its_bound_is_within(real: str, tmp_path: Path) -> None:
    """Bounds are of the type, as values are: 0.1, 1/3, none at all, and those that a float does not hold."""
    (tmp_path / "main.c").write_text(ASK)
    for case in [("0.1", "0.1", "0.1"), ("1/3", "1/3", "1/3"), ("0", "1e200", "2"), ("1e-200", "0.3", "0.3")]:
        write(render(bounded(*case), real=TYPES[real]), tmp_path)
        libraries = ["-lquadmath", "-lm"] if real == "quad" else ["-lm"]
        call(
            "gcc", *WARNINGS, tmp_path / "main.c", tmp_path / "bounded.c", "-o", tmp_path / "run", *libraries
        )
        assert call(tmp_path / "run") == "1\n", case


@pytest.mark.parametrize("value", ["1e39", "1e-39"])
def test_what_a_float_does_not_hold_is_refused(value: str) -> None:
    program = bounded("0", "1e300", value)
    render(program)
    with pytest.raises(Refused, match="LAG0590"):
        render(program, real=SINGLE)


@pytest.mark.full
def test_quad_has_all_digits_of_numbers_that_are_meant() -> None:
    """Decimals of 12 digits, quotients of whole numbers, and such multiples of powers of pi, as doubles."""
    chance = random.Random(5)
    with mpmath.workdps(50):
        for _ in range(2000):
            decimal = f"{chance.randrange(1, 10**12)}e{chance.randrange(-30, 20)}"
            assert mpmath.mpf(QUAD.literal(float(decimal))[:-1]) == mpmath.mpf(decimal)
            p, q = chance.randrange(1, 3000), chance.randrange(1, 3000)
            for power in (0, 1, -1, 2):
                truth = mpmath.mpf(p) / q * mpmath.pi**power
                found = mpmath.mpf(QUAD.literal(-float(truth))[:-1])
                assert abs(found + truth) < 1e-38 * truth, (p, q, power)


def test_quad_takes_no_other_number_for_one_of_these() -> None:
    """All 17 digits of random doubles, and of what rounding left of 0.1 + 0.2."""
    chance = random.Random(6)
    for value in [0.1 + 0.2, *(chance.uniform(-10.0, 10.0) for _ in range(3000))]:
        assert QUAD.literal(value) == f"{value!r}Q"
    assert DOUBLE.literal(1 / 3) == repr(1 / 3)
