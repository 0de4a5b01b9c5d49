"""Fixed steps in real time: each call makes the same number of evaluations, for days, in every precision."""

import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest

import lagc
from lagc.cli.main import main
from lagc.simulation.system import OK, Options
from tests.simulation.driven import InC, InPython, stepper
from tests.simulation.test_controller import block, compiled, printed

pytestmark = pytest.mark.usefixtures("own_cache")
COMPILED = pytest.mark.skipif(shutil.which("gcc") is None, reason="there is no gcc")
COUNT = """
#include "cart_pole.h"
#include <stdio.h>
#include <stdlib.h>

/* t0, calls, steps in each, the way times are made: computed (0) or added up (1) */
int main(int argc, char **argv)
{
    static cart_pole_work w;
    static cart_pole_state s;
    cart_pole_params p = cart_pole_default_params();
    cart_pole_options o = cart_pole_default_options();
    const double t0 = atof(argv[1]), step = 0.001 * atof(argv[3]);
    const long calls = atol(argv[2]), wanted = 4 * atol(argv[3]);
    cart_pole_real t = t0;
    long k, before, odd = 0;

    o.method = CART_POLE_RK4;
    o.step = 0.001;
    cart_pole_bind(&p);
    cart_pole_start(&p, s.x);
    cart_pole_begin(&s, t, s.x);
    for (k = 1; k <= calls; k++) {
        t = atoi(argv[4]) ? t + (cart_pole_real)step : (cart_pole_real)(t0 + step * k);
        p.u = k % 7;
        before = s.rhs;
        if (cart_pole_advance(&p, &s, t, &o, &w) != CART_POLE_OK || s.t != t)
            return 1;
        odd += s.rhs - before != wanted;
    }
    printf("%ld %ld %.17g %.17g", odd, s.steps, (double)s.x[0], (double)s.x[1]);
    return argc < 5;
}
"""


@pytest.fixture(scope="module", params=["double", "float", "quad"])
def program(request: Any, tmp_path_factory: Any) -> Path:
    folder: Path = tmp_path_factory.mktemp(request.param)
    (folder / "cart_pole.lag").write_text(block("modelica"))
    model = str(folder / "cart_pole.lag")
    options = f"--method rk4 --target c --real {request.param} -q"
    assert main(["build", model, *options.split(), "-o", str(folder)]) == 0
    (folder / "count.c").write_text(COUNT)
    libraries = ["-lquadmath", "-lm"] if request.param == "quad" else ["-lm"]
    command = ["gcc", "-std=gnu99", "-O2", "count.c", "cart_pole.c", *libraries, "-o", "count"]
    subprocess.run(command, cwd=folder, check=True)
    return folder


@pytest.mark.sample(0, 12)
@COMPILED
@pytest.mark.parametrize("t0, steps, added", [
    (0.0, 1, 0), (813.0, 1, 0), (1e4, 1, 0), (1e6, 1, 0), (0.0, 10, 0), (1000.0, 10, 0), (0.0, 1, 1),
])  # fmt: skip
def test_each_call_makes_the_same_steps(program: Path, t0: float, steps: int, added: int) -> None:
    """The equations do not depend on time: neither does the motion, but for the times, which are doubles."""
    calls = 2000 // steps
    found = []
    for begin in (0.0, t0):
        words = ["./count", repr(begin), str(calls), str(steps), str(added)]
        done = subprocess.run(words, cwd=program, capture_output=True, text=True, check=True)
        odd, count, *x = map(float, done.stdout.split())
        assert (odd, count) == (0, calls * steps)
        found.append(x)
    if not added:
        assert found[1] == pytest.approx(found[0], rel=1e-8)


@pytest.mark.full
@COMPILED
def test_an_hour(program: Path) -> None:
    if program.name.startswith("quad"):
        pytest.skip("slow")
    words = ["./count", "0", "3600000", "1", "0"]
    done = subprocess.run(words, cwd=program, capture_output=True, text=True, check=True)
    assert done.stdout.split()[:2] == ["0", "3600000"]


@pytest.mark.full
@COMPILED
@pytest.mark.parametrize("real", ["double", "float"])
def test_the_program_of_the_documentation(tmp_path: Path, real: str) -> None:
    assert printed(block("c", 2), tmp_path, real) == ["100000", "4", "4"]


def times(per_call: float, t0: float = 0.0) -> list[float]:
    return [t0 + per_call * k for k in range(1, 41)]


@pytest.mark.parametrize("t0", [0.0, 86400.0, 1e9])
def test_c_and_python_have_the_same_bits(t0: float) -> None:
    """Beyond 4000 s, the spacing of times is more than 1e-9 of a step; at 1e9 s it is 1e-4 of it."""
    options, found = Options("rk4", step=0.001), []
    for backend, kind in (("c", InC), ("numpy", InPython)):
        system = compiled(backend)
        run: Any = kind(system, options, t0, system.start())
        evaluations = []
        for t in times(0.001, t0):
            run.p[-1] = 1.0 - run.facts()[1][0]
            assert run.advance(t) == OK
            evaluations.append(run.facts()[5])
        assert evaluations == [4 * k for k in range(1, 41)]
        inside = run.facts()[0] - 0.0004
        found.append((run.facts(), run.dense(inside), run.dense(inside)))
    assert found[0] == found[1]
    assert found[0][0][0] == times(0.001, t0)[-1]


@pytest.mark.parametrize("name", ["Cart", "Rod", "Top"])
def test_calls_off_the_grid(name: str) -> None:
    """A call that ends between two steps makes a short step, and the grid begins anew; a call to the same
    time again makes none."""
    for backend in ("c", "numpy"):
        run = stepper(name, backend, Options("rk4", step=0.01))
        for t, steps in ((0.03, 3), (0.03, 3), (0.035, 4), (0.055, 6), (0.056, 7), (0.0, 13)):
            assert run.advance(t) == OK
            assert run.facts()[0] == t and run.facts()[3] == steps
            assert run.advance(t) == OK and run.facts()[3] == steps


def test_events_keep_the_grid() -> None:
    """A step that ends at an event is followed by the rest of it: x = t^2/2 - (t - 0.34)^2 after it."""
    text = """model M
      coordinate Length x;
      body b = Particle(mass = 1 [kg], at = {x, 0, 0});
      force f = (if x < 0.0578 [m] then 1 [N] else -1 [N])*world.x at b;
    end M;"""
    model = lagc.loads(text)
    for backend, kind in (("c", InC), ("numpy", InPython)):
        system: Any = model.compile(backend=backend).load(backend)
        run: Any = kind(system, Options("rk4", step=0.1), 0.0, system.start())
        for k in range(1, 8):
            assert run.advance(0.1 * k) == OK
        _, x, _, steps, *_ = run.facts()
        assert steps == 8 and x[0] == pytest.approx(0.7**2 / 2 - 0.36**2, abs=1e-12)


def test_the_rate_at_the_end_is_that_of_its_step() -> None:
    """Dense output after a call has the inputs of the step, whatever the caller sets then."""
    run = stepper("Cart", "numpy", Options("rk4", step=0.01))
    run.p[-2] = 0.7
    assert run.advance(0.05) == OK
    before = run.dense(0.044)
    run.p[-2] = -3.0
    assert run.dense(0.044) == before
    assert run.advance(0.06) == OK
    fresh = stepper("Cart", "numpy", Options("rk4", step=0.01))
    fresh.p[-2] = 0.7
    assert fresh.advance(0.05) == OK
    fresh.p[-2] = -3.0
    assert fresh.advance(0.06) == OK and fresh.facts()[1] == run.facts()[1]
