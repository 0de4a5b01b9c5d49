"""A program that calls all of the generated C, and the compilers and tools that it is given to.

What it prints are all digits of all results: the same at every level of optimisation of every compiler, and
on every machine.  LAGC_MACHINES asks for other machines, for each of which zig makes a C library first.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from importlib.util import find_spec
from pathlib import Path

from lagc.codegen.c.emit import render
from lagc.lowering.program import Program
from lagc.simulation.backends.compile import FLAGS

MAIN = Path(__file__).with_name("everywhere.c")
WASI = MAIN.with_name("wasi.mjs")
EXACT = ["-std=c99", *(flag for flag in FLAGS if flag.startswith("-f") and flag != "-fPIC")]
LEVELS = [["-O0"], ["-O1"], ["-O2"], ["-O3"], ["-O3", "-march=native"]]
VALGRIND = ("valgrind", "-q", "--error-exitcode=1")
CPPCHECK = ("cppcheck", "-q", "--std=c99", "--enable=warning,performance,portability")


def clang() -> list[str] | None:
    """The words that call clang: its own name, else that of the package `ziglang`, without the checks that
    it has at -O0, which bring a mathematical library of their own, with other bits."""
    if shutil.which("clang"):
        return ["clang"]
    return [sys.executable, "-m", "ziglang", "cc", "-fno-sanitize=all"] if find_spec("ziglang") else None


def compilers() -> dict[str, list[str]]:
    """Of gcc and clang those that are here."""
    found = {"gcc": ["gcc"] if shutil.which("gcc") else None, "clang": clang()}
    return {name: words for name, words in found.items() if words}


@cache
def wide() -> bool:
    """Whether there is a gcc that computes with x87, in 64 bits, and libquadmath."""
    program = "#include <quadmath.h>\nint main(void) { return sinq(0) != 0; }\n"
    words = ["gcc", "-mfpmath=387", "-x", "c", "-", "-o", os.devnull, "-lquadmath", "-lm"]
    return (
        bool(shutil.which("gcc"))
        and not subprocess.run(words, input=program, capture_output=True, text=True).returncode
    )


@cache
def machines() -> dict[str, Tool]:
    """Other machines that can be asked here: AArch64, which has fused multiply-add, and WebAssembly."""
    if "LAGC_MACHINES" not in os.environ or find_spec("ziglang") is None:
        return {}
    zig = (sys.executable, "-m", "ziglang", "cc", "-fno-sanitize=all", "-O2", "-target")
    qemu = shutil.which("qemu-aarch64") or shutil.which("qemu-aarch64-static")
    node = shutil.which("node")
    found = {
        "aarch64": qemu and Tool((*zig, "aarch64-linux-musl"), under=(qemu,)),
        "wasm32": node and Tool((*zig, "wasm32-wasi"), under=(node, "--no-warnings", str(WASI))),
    }
    return {name: machine for name, machine in found.items() if isinstance(machine, Tool)}


def prepare(program: Program, folder: Path) -> list[str]:
    """Write the generated files and the program that calls them into `folder`; what a compiler is told."""
    files = render(program)
    stem = next(name[:-2] for name in files if name.endswith(".c"))
    for name, text in files.items():
        (folder / name).write_text(text)
    main = re.sub(r"\bMODEL_", f"{stem.upper()}_", MAIN.read_text())
    (folder / "everywhere.c").write_text(re.sub(r"\bmodel(?=[_.])", stem, main))
    has = {"CONSTRAINED": program.interface.nc, "OBSERVED": f"{stem}_outputs(" in files[f"{stem}.h"],
           "LIMITED": len(program.interface.limits), "FORMED": f"{stem}_mass_matrix(" in files[f"{stem}.h"],
           "STARTED": f"{stem}_consistent(" in files[f"{stem}.h"],
           "CONDITIONED": len(program.interface.condition_ends),
           "SLOPES": len(program.interface.condition_columns)}  # fmt: skip
    return [*(f"-D{word}={int(there)}" for word, there in has.items() if there), str(folder / f"{stem}.c"),
            str(folder / "everywhere.c")]  # fmt: skip


def told(*words: str | Path, folder: Path) -> tuple[int, str, str]:
    """Exit status, standard output, and what was said besides."""
    done = subprocess.run([str(w) for w in words], cwd=folder, capture_output=True, text=True, timeout=900)
    return done.returncode, done.stdout, done.stderr


def printed(compile_: Iterable[str], units: list[str], folder: Path, under: Iterable[str] = ()) -> str:
    """What the program prints, compiled by `compile_`, started by `under`.  Raises AssertionError with what
    compiler or program complain of."""
    status, out, said = told(*compile_, *EXACT, *units, "-o", "everywhere", "-lm", folder=folder)
    assert (status, out, said) == (0, "", ""), out + said
    status, out, said = told(*under, folder / "everywhere", folder=folder)
    assert (status, said) == (0, ""), said
    return out


@dataclass(frozen=True)
class Tool:
    """A checker: `compile_` makes the program, which runs `under` another one; or, where it is empty,
    `analyse` is given the generated file alone.  All have nothing to say."""

    compile_: tuple[str, ...] = ()
    under: tuple[str, ...] = ()
    analyse: tuple[str, ...] = ()

    def ask(self, units: list[str], folder: Path) -> None:
        """Raises AssertionError with what it says."""
        if self.compile_:
            printed(self.compile_, units, folder, self.under)
        else:
            status, out, said = told(*self.analyse, units[-2], folder=folder)
            assert (status, out, said) == (0, "", ""), out + said


@cache
def tools() -> dict[str, Tool | None]:
    """The checkers by name; None for what is not on this machine."""
    gcc, llvm = compilers().get("gcc"), compilers().get("clang")
    checked = ["-g", "-fno-sanitize-recover=all"]
    analyse = ["--analyze", "-std=c99", "-o", "/dev/null", "-Wno-unused-command-line-argument"]
    found: dict[str, Tool | str | Iterable[str] | None] = {
        "valgrind": gcc and shutil.which("valgrind") and Tool((*gcc, "-O1", "-g"), under=VALGRIND),
        "address and undefined": gcc and Tool((*gcc, "-O0", *checked, "-fsanitize=address,undefined")),
        "memory": llvm and _memory(llvm) and Tool((*llvm, "-O1", *checked, "-fsanitize=memory")),
        "clang --analyze": llvm and Tool(analyse=(*llvm, *analyse)),
        "gcc -fanalyzer": gcc and Tool(analyse=(*gcc, "-std=c99", "-O1", "-fanalyzer", "-c")),
        "cppcheck": shutil.which("cppcheck") and Tool(analyse=CPPCHECK),
    }
    return {name: tool if isinstance(tool, Tool) else None for name, tool in found.items()}


def _memory(llvm: list[str]) -> bool:
    """Whether there is the library for it: `zig cc` takes -fsanitize=memory, and has none."""
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "empty.c").write_text("int main(void) { return 0; }\n")
        words = [*llvm, "-fsanitize=memory", "empty.c", "-o", "empty"]
        return told(*words, folder=Path(folder))[0] == 0
