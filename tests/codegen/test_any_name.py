"""Any name works: those of the headers of C, C++ and POSIX, of Python, of LaTeX, and random ones."""

import ast
import builtins
import keyword
import math
import random
import re
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest

from lagc.api import CompiledModel
from lagc.codegen.identifiers import Names, is_reserved, prefix
from lagc.compiler import pipeline
from lagc.diagnostics.faults import Refused, Source
from lagc.reports.equations.write import write as equations_as
from tests.codegen.tools import COMPILERS, call, present, write

_C99 = """
    assert complex ctype errno fenv float inttypes iso646 limits locale math setjmp signal stdarg stdbool
    stddef stdint stdio stdlib string tgmath time wchar wctype
"""
_POSIX = """
    aio arpa/inet dirent dlfcn fcntl fnmatch ftw glob grp iconv langinfo libgen net/if netdb netinet/in
    netinet/tcp nl_types poll pthread pwd regex sched search semaphore spawn strings sys/ipc sys/mman
    sys/msg sys/resource sys/select sys/sem sys/shm sys/socket sys/stat sys/statvfs sys/time sys/times
    sys/types sys/uio sys/un sys/utsname sys/wait syslog tar termios unistd utime utmpx wordexp
"""
_CPP = """
    algorithm array chrono complex functional iostream limits map memory mutex numeric random string
    thread tuple vector
"""
_LATEX = """
    alpha beta frac left right sum int prod sqrt vec dot ddot hat bar text mathrm begin end input include
    def let catcode newcommand ensuremath displaystyle over above atop par item label ref cite tiny huge
    space quad qquad infty partial nabla cdot times to in ni neg not le ge ll gg sin cos tan log ln exp
    lim max min det dim ker deg gcd hom arg inf sup Pr top bot
"""
_OURS = """
    M_cart M_1 M_PI INT INTERVAL UINT8 EXIT_1 HUGE_m MATH_x INT_ M_E HUGE_ FP_x the_x the_M_E its_x lagc
    lagc_x fn_x x0 t1 lam2 work_size default_params none p_ x_ Names self cls np math numpy
"""
C99, POSIX, CPP, LATEX, OURS = (words.split() for words in (_C99, _POSIX, _CPP, _LATEX, _OURS))
TARGETS = ["x86_64-windows-gnu", "x86_64-macos", "aarch64-freebsd", "x86_64-netbsd", "x86_64-linux-musl"]


def including(headers: list[str], end: str = ".h") -> str:
    return "".join(f"#if __has_include(<{h}{end}>)\n#include <{h}{end}>\n#endif\n" for h in headers)


@cache
def of_headers() -> tuple[str, ...]:
    """Every identifier that the headers of this machine show, macros included."""
    words: set[str] = set()
    text = including([*C99, *POSIX])
    zig = [sys.executable, "-m", "ziglang"]
    calls = [(["gcc", "-D_GNU_SOURCE", "-x", "c"], text), (["g++", "-x", "c++"], including(CPP, ""))]
    calls += [([*zig, "cc", "-x", "c", "-target", target], text) for target in TARGETS]
    for command, source in calls:
        if present("zig" if command[0] == sys.executable else command[0]):
            for flags in (["-dM", "-E"], ["-E"]):
                done = subprocess.run([*command, *flags, "-"], input=source, capture_output=True, text=True)
                words.update(re.findall(r"\b[A-Za-z]\w*", done.stdout))
    return tuple(sorted(words))


def of_python() -> list[str]:
    return [*keyword.kwlist, *keyword.softkwlist, *dir(builtins), *dir(math), *dir(object)]


def of_chance(seed: int, count: int) -> list[str]:
    chance = random.Random(seed)
    parts = ["M_", "INT", "E", "_", "__", "x", "PI", "2", "0", "der", "MAX", "a", "T", "si_", "PRI", "d", "f"]
    return ["n" * chance.randrange(2) + "".join(chance.choices(parts, k=chance.randrange(1, 7)))
            for _ in range(count)]  # fmt: skip


def every() -> list[str]:
    return [*OURS, *of_python(), *LATEX, *of_chance(1, 2000), *of_headers()]


@pytest.mark.full
def test_each_name_is_given_at_once_and_once() -> None:
    words = every()
    for variables in (False, True):
        names = Names(["x", "t", "p"], ["lagc_", "LAGC_", "the_"], variables)
        given = [names.give(word) for word in [*words, *words]]
        assert len(set(given)) == len(given)
        assert not any(is_reserved(name) or name.startswith(("lagc_", "LAGC_", "the_")) for name in given)
        assert not {"x", "t", "p"} & set(given)


def test_the_same_name_many_times() -> None:
    names = Names()
    assert len({names.give("INT_MAX") for _ in range(20_000)}) == 20_000


def test_names_of_people_stay() -> None:
    short = ("B1", "m", "R", "k_t", "F_N", "J12", "Ixx")
    for name in (*short, "M_cart", "M_1", "L_rod", "L_12", "w_rel", "E_kin"):
        assert Names().give(name) == name


@pytest.mark.full
@pytest.mark.parametrize("target", TARGETS)
def test_no_macro_of_the_standard_headers_is_given(target: str, tmp_path: Path) -> None:
    if not present("zig"):
        pytest.skip("no zig")
    (tmp_path / "a.c").write_text(including(C99))
    defined = call(*COMPILERS["zig"], "-target", target, "-dM", "-E", tmp_path / "a.c").splitlines()
    macros = [line.split()[1] for line in defined]
    objects = [name for name in macros if "(" not in name and not name.startswith("_")]
    assert [name for name in objects if not is_reserved(name) and name != "OpenBSD7_8"] == []


@pytest.mark.full
@pytest.mark.parametrize("compiler", ["gcc", "g++"])
def test_compilers_take_all_of_them(compiler: str, tmp_path: Path) -> None:
    """As members of a struct after every header of C, and as variables after those of the generated C."""
    if not present(compiler):
        pytest.skip(f"no {compiler}")
    members, variables = Names(), Names(["x", "p"], variables=True)
    names = dict.fromkeys(every())
    fields = "\n".join(f"double {members.give(name)};" for name in names)
    inside = "\n".join(f"{{ double {v} = x; s += {v}; }}" for v in map(variables.give, names))
    (tmp_path / "a.c").write_text(
        f"{including(C99 if compiler == 'gcc' else [h for h in C99 if h != 'tgmath'])}"
        f"typedef struct {{\n{fields}\n}} all;\nall none(void) {{ all a = {{0}}; return a; }}\n"
    )
    (tmp_path / "b.c").write_text(
        f"#include <stddef.h>\n#include <math.h>\ndouble f(double x);\n"
        f"double f(double x) {{ double s = 0;\n{inside}\nreturn s; }}\n"
    )
    for file in ("a.c", "b.c"):
        assert call(*COMPILERS[compiler], "-w", "-fsyntax-only", tmp_path / file) == ""


MODEL = """model {0}
  parameter Mass {1} = 1 [kg];
  parameter Mass {2} = 2 [kg];
  coordinate Length {3}(start = 1 [m]);
  coordinate Length {4};
  speed Velocity {5} = 2*der({4});
  body {6} = Particle(mass = {1}, at = {{{3}, 0, 0}});
  body {7} = Particle(mass = {2}, at = {{{4}, 0, 0}});
  effect {8}
    potential {9} = 0.5 [N/m]*({3}^2 + {4}^2);
  end {8};
  scene {10} uses {8};
  output Length {11} = {3} + {4};
end {0};
"""
WELL_KNOWN = [*OURS, *of_python(), *LATEX]


@pytest.mark.sample(0, 2)
@pytest.mark.parametrize("seed", range(6))
def test_models_with_such_names_are_built_and_run(seed: int, tmp_path: Path) -> None:
    """In each role; what the language refuses, it refuses with a reason."""
    chance = random.Random(seed)
    pool = [*WELL_KNOWN, *chance.sample(of_headers(), 200)] if of_headers() else WELL_KNOWN
    built = 0
    for _ in range(12):
        words = list(dict.fromkeys(chance.sample(pool, 30)))[:12]
        source = Source("any.lag", MODEL.format(*words))
        try:
            program = pipeline.program(source, pipeline.Choice())
        except Refused as refused:
            assert all(fault.span is not None and fault.message for fault in refused.faults)
            continue
        files = write(pipeline.render(program, "c"), tmp_path)
        for name in ("gcc", "g++"):
            if present(name):
                call(*COMPILERS[name], "-w", "-fsyntax-only", files[".c"])
        model = pipeline.Compilation(source, pipeline.Choice())
        for form in ("text", "latex", "sympy"):
            text = equations_as(model.equations, form)
            assert text.isascii() or form == "text"
            if form == "sympy":
                ast.parse(text)
        run = CompiledModel(model, "numpy").simulate(stop=0.5, accuracy=1e-6)
        assert run.status == "ok" and abs(run[words[3]][-1] - math.cos(0.5)) < 1e-5
        built += 1
    assert built > 0


@pytest.mark.full
def test_no_constant_of_a_model_is_one_of_a_header() -> None:
    """FE_INVALID is of fenv.h, and would be of a model FE."""
    source = Source("any.lag", MODEL.format("Zyxw", *"abcdefghijk"))
    header = pipeline.render(pipeline.program(source, pipeline.Choice()), "c")["zyxw.h"]
    endings = {word.removeprefix("ZYXW_") for word in re.findall(r"ZYXW_\w+", header)}
    taken = set(of_headers())
    heads = {word.rpartition(f"_{ending}")[0] for word in taken for ending in endings
             if word.endswith(f"_{ending}")}  # fmt: skip
    assert heads or not taken
    for head in (head for head in heads if "_" not in head):
        own = prefix(head.capitalize())
        assert not {f"{own.upper()}_{ending}" for ending in endings} & taken
