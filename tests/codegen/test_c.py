"""Generated C compiles with any C99 or C++ compiler, without warnings or undefined behaviour."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from lagc.codegen.c.emit import render
from lagc.diagnostics.faults import Source
from lagc.lowering.lower_equations import optimize
from lagc.lowering.program import Program
from lagc.mechanics.derive import derive
from tests.codegen.programs import pendulum
from tests.codegen.test_names import TRICKY
from tests.codegen.tools import COMPILERS, STRICT, call, of_model, of_source, present, write
from tests.interfaces import field
from tests.mechanics.models import entangled

WORDS = ["int", "lambda", "double", "main", "q", "t", "None", "I", "E", "j0", "PENDULUM_NQ", "a.b[2].m", "θ"]


def tricky() -> Program:
    fields = tuple(
        field(name, place="a */ #include <x> ??/\n.lag:3", description="naïve \\ /* */") for name in TRICKY
    )
    return pendulum(
        "int",
        parameters=fields,
        q_names=("lambda",),
        v_names=("der(None)",),
        scene="*/ evil",
        source_name="a\nb*/",
    )


NOTHING_TO_MOVE = """
model M
  coordinate Length x(start = 1);
  body b = Particle(mass = 1 [kg], at = {x, 0, 0});
initial
  der(x) = der(x) - 2 [m/s];
end M;
"""

LEVELS = {"gcc": "-O2"}  # looks for more, the better it optimizes; clang does not
PROGRAMS = {
    "pendulum": pendulum,
    "tricky": tricky,
    "free": lambda: of_model("classic/double_pendulum"),
    "driven": lambda: of_model("classic/driven_oscillator"),
    "loop": lambda: of_model("classic/four_bar"),
    "rolling": lambda: of_model("classic/sphere_on_turntable"),
    "quaternion": lambda: of_model("classic/heavy_top_quaternion"),
    "velocity rows only": lambda: of_model("classic/knife_edge"),
    "lifted": lambda: of_model("classic/chain", n=30),
    "condition of nothing": lambda: of_source(Source("m.lag", NOTHING_TO_MOVE)),
    "looped": lambda: optimize(derive(entangled(25))),
}


@pytest.mark.sample(0, 4)
@pytest.mark.parametrize("compiler", COMPILERS)
@pytest.mark.parametrize("name", PROGRAMS)
def test_compiles_without_a_warning(name: str, compiler: str, tmp_path: Path) -> None:
    if not present(compiler):
        pytest.skip(f"no {compiler}")
    if compiler.startswith("zig") and name not in ("tricky", "rolling", "quaternion"):
        pytest.skip("clang: three programs are enough")
    files = write(render(PROGRAMS[name]()), tmp_path)
    level = LEVELS.get(compiler, "-O0")
    call(*COMPILERS[compiler], *STRICT, level, "-c", files[".c"], "-o", tmp_path / "made.o")
    assert (tmp_path / "made.o").stat().st_size


@pytest.mark.sample(1)
@pytest.mark.parametrize("word", WORDS)
def test_any_word_can_be_a_coordinate_and_a_parameter(word: str, tmp_path: Path) -> None:
    if not present("gcc"):
        pytest.skip("no gcc")
    more = (field(word), *pendulum().interface.parameters[1:])
    program = pendulum("Pendulum", q_names=(word,), v_names=(f"der({word})",), parameters=more)
    files = write(render(program), tmp_path)
    for compiler in ("gcc", "g++"):
        assert call(*COMPILERS[compiler], *STRICT, "-fsyntax-only", files[".c"]) == ""


@pytest.mark.sample(4)
@pytest.mark.parametrize("name", PROGRAMS)
def test_text_is_ascii_without_calls_of_other_libraries(name: str) -> None:
    for text in render(PROGRAMS[name]()).values():
        assert text.isascii() and "\t" not in text and "\r" not in text
        assert not re.search(r"\blagc_|\bLAGC_|\bmalloc|\bprintf|\bstatic (double|int) \w+\s*[;=]", text)
        assert re.findall(r"^#\s*include.*", text, re.M) in (
            ["#include <stddef.h>"],
            [
                f'#include "{_header(text)}"',
                "#include <float.h>",
                "#include <math.h>",
                "#include <stdbool.h>",
                "#include <string.h>",
            ],
        )


def _header(text: str) -> str:
    found = re.search(r'#include "(\w+\.h)"', text)
    return found[1] if found else ""


def test_nothing_unused_is_written() -> None:
    text = render(of_model("classic/double_pendulum"))["double_pendulum.c"]
    free = re.sub(r"/\*.*?\*/", "", text, flags=re.DOTALL)
    free = re.sub(r'\{"options", .*\}', "", free)  # rows of the table of members
    assert (
        "project" not in free.replace("o.project", "")
        and "quaternion" not in free
        and "_position" not in free
    )
    assert "_sign" not in free and "_min(" not in free


@pytest.mark.full
def test_public_names_carry_the_prefix(tmp_path: Path) -> None:
    if not present("gcc"):
        pytest.skip("no gcc")
    files = write(render(of_model("classic/four_bar")), tmp_path)
    call("gcc", "-O1", "-std=c99", "-c", files[".c"], "-o", tmp_path / "made.o")
    symbols = call("nm", tmp_path / "made.o").split("\n")
    kinds = {tuple(line.split()[-2:]) for line in symbols if line}
    assert all(symbol.startswith("four_bar_") for kind, symbol in kinds if kind == "T")
    assert not [symbol for kind, symbol in kinds if kind in "BDCG"]  # no variable data
    assert "four_bar_rhs" in {symbol for kind, symbol in kinds if kind == "T"}
    undefined = {symbol for kind, symbol in kinds if kind == "U"}
    assert undefined <= {"sqrt", "fabs", "floor", "memset", "memcpy", "memmove",
                         "_GLOBAL_OFFSET_TABLE_",
                         "__stack_chk_fail"}  # fmt: skip


@pytest.mark.sample(0, 2)
@pytest.mark.parametrize("name", ["free", "loop", "quaternion", "lifted", "looped"])
def test_sanitizers_find_nothing(name: str, tmp_path: Path) -> None:
    """A whole run with all public functions, from a main of its own."""
    if not present("gcc"):
        pytest.skip("no gcc")
    program = PROGRAMS[name]()
    files = write(render(program), tmp_path)
    stem = files[".c"].stem
    (tmp_path / "main.c").write_text(MAIN.replace("MODEL_", f"{stem.upper()}_").replace("model", stem))
    more = ["-DCONSTRAINED"] if program.interface.nc else []
    more += ["-DDENSE"] if "system" in program.functions else []
    sanitize = ["-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-g", "-O0"]
    call(
        "gcc",
        "-std=c99",
        *STRICT,
        *sanitize,
        *more,
        files[".c"],
        tmp_path / "main.c",
        "-o",
        tmp_path / "main",
        "-lm",
    )
    lines = call(tmp_path / "main").split()
    assert lines[0] == "0" and float(lines[1]) == 0.1


MAIN = """\
#include "model.h"
#include <stdio.h>

static model_work work;

int main(void)
{
    model_params p = model_default_params();
    const model_options o = model_default_options();
    model_state s;
    double x[MODEL_NX], xdot[MODEL_NX], M[MODEL_NV * MODEL_NV], r[MODEL_NV], e[3], states[3 * MODEL_NX];
    const double times[3] = {0.05, 0.07, 0.1};
    size_t done = 0;
    model_status status;
#ifdef MODEL_NPREPARED
    model_bind(&p);
#endif
    model_start(&p, x);
    status = model_rhs(&p, 0.0, x, xdot, NULL, &work);
#ifdef DENSE
    model_mass_matrix(&p, 0.0, x, M, &work);
    model_forces(&p, 0.0, x, r, &work);
#else
    (void)M, (void)r;
#endif
    model_energies(&p, 0.0, x, e);
#ifdef CONSTRAINED
    {
        double phi[MODEL_NC], psi[MODEL_NC], G[MODEL_NC * MODEL_NV], gamma[MODEL_NC];
        model_constraints(&p, 0.0, x, phi, psi, G, gamma, &work);
        model_constraints(&p, 0.0, x, NULL, NULL, NULL, NULL, &work);
    }
#endif
    model_begin(&s, 0.0, x);
    while (status == MODEL_OK) {
        status = model_record(&p, &s, &o, times, 3, states, &done, 4, &work);
        if (status == MODEL_INTERRUPTED)
            status = MODEL_OK;
        if (done == 3)
            break;
    }
    printf("%d %.17g %.17g\\n", (int)status, s.t, s.x[0]);
    return 0;
}
"""


@pytest.mark.full
@pytest.mark.parametrize("target", ["c", "python"])
def test_the_same_bytes_whatever_the_hash_seed(target: str) -> None:
    code = (
        "import hashlib; from tests.codegen.tools import of_model; from tests.codegen.test_c import tricky;"
        f"from lagc.codegen.{target}.emit import render;"
        "texts = [*render(of_model('classic/four_bar')).values(), *render(tricky()).values()];"
        "print(hashlib.sha256(''.join(texts).encode()).hexdigest())"
    )
    root = Path(__file__).parents[2]
    found = {
        subprocess.run([sys.executable, "-c", code], env={**os.environ, "PYTHONHASHSEED": seed}, cwd=root,
                       check=True, capture_output=True, text=True).stdout
        for seed in ("0", "1", "2")
    }  # fmt: skip
    assert len(found) == 1 and found != {""}
