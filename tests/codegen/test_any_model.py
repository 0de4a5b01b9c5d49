"""What callers of any model rely on: functions that exist everywhere, tables of members, CMake, --only."""

import ctypes
import json
import os
import re
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest

from lagc.cli.main import main
from lagc.codegen.c.emit import render
from lagc.codegen.description import describe, functions
from lagc.codegen.identifiers import prefix
from lagc.codegen.kernel_compiler.real_types import TYPES
from tests.codegen.tools import STRICT, call, of_model, write

MODELS = ["course/simple_pendulum", "classic/four_bar", "contact/bouncing_ball", "classic/stick_slip_belt",
          "classic/heavy_top_quaternion"]  # fmt: skip
EVERYWHERE = {
    "advance", "begin", "bind", "check", "consistent", "constraints", "default_options", "default_params",
    "dense", "displace", "energies", "gaps", "hold", "members", "outputs", "params_size", "record", "rhs",
    "seated", "start", "state_size", "status_text", "step", "work_size",
}  # fmt: skip


@pytest.mark.sample(2)
@pytest.mark.parametrize("name", MODELS)
def test_functions_that_exist_everywhere(name: str) -> None:
    program = of_model(name, work=False)
    header = next(text for file, text in render(program).items() if file.endswith(".h"))
    assert functions(header, prefix(program.interface.model)).keys() >= EVERYWHERE


class Member(ctypes.Structure):
    _fields_ = [*((name, ctypes.c_char_p) for name in ("record", "name", "unit", "type")),
                ("offset", ctypes.c_size_t), ("length", ctypes.c_size_t)]  # fmt: skip


def loaded(files: dict[str, str], folder: Path) -> Any:
    """The shared library of generated C."""
    source = write(files, folder)[".c"]
    call("gcc", "-std=c99", "-O0", *STRICT, "-shared", "-fPIC", source, "-lm", "-o", folder / "model.so")
    return ctypes.CDLL(str(folder / "model.so"))


@pytest.mark.full
@pytest.mark.skipif(shutil.which("gcc") is None, reason="there is no gcc")
@pytest.mark.parametrize("name", ["classic/driven_oscillator", "contact/bouncing_ball"])
@pytest.mark.parametrize("real", ["double", "float"])
def test_a_caller_that_knows_the_tables_alone(name: str, real: str, tmp_path: Path) -> None:
    """A program in another language sets a parameter by its name, and reads a state by its name."""
    program = of_model(name, work=False)
    interface, own = program.interface, prefix(program.interface.model)
    files = render(program, real=TYPES[real])
    library = loaded(files, tmp_path)
    kind = {"double": ctypes.c_double, "float": ctypes.c_float}[real]

    def call_(function: str, *given: Any, gives: Any = ctypes.c_int) -> Any:
        found = getattr(library, f"{own}_{function}")
        found.restype = gives
        return found(*given)

    rows: dict[tuple[str, str], Member] = {}
    for row in call_("members", gives=ctypes.POINTER(Member)):
        if row.name is None:
            break
        rows[row.record.decode(), row.name.decode()] = row
    facts = json.loads(json.dumps(describe(interface, files[f"{own}.h"], real)))
    size, nx = facts["real"]["size"], facts["sizes"]["NX"]
    for field in (*facts["parameters"], *facts["inputs"]):
        row = rows["params", field["name"]]
        assert (row.offset, row.unit.decode(), row.type) == (field["offset"], field["unit"], b"real")
    for part, array in (("coordinates", "x"), ("speeds", "x"), ("discretes", "x"), ("outputs", "y")):
        for entry in facts[part]:
            assert rows[array, entry["name"]].offset == entry["index"] * size
    assert ctypes.sizeof(kind) == size and rows["state", "x"].length == nx
    params = type("Params", (ctypes.Structure,), {"_fields_": [("p", kind * (call_("params_size") // size))]})
    p = call_("default_params", gives=params)
    state, work = [ctypes.create_string_buffer(call_(f"{n}_size")) for n in ("state", "work")]
    kind.from_buffer(p, rows["params", facts["parameters"][0]["name"]].offset).value = 2.0
    p = ctypes.byref(p)
    x, xdot, again = (kind * nx)(), (kind * nx)(), (kind * nx)()
    call_("bind", p)
    call_("start", p, x)
    assert call_("consistent", p, kind(0), x, None, ctypes.create_string_buffer(1 << 16)) == 0
    call_("begin", state, kind(0), x)
    begin = rows["state", "x"].offset
    assert [kind.from_buffer(state, begin + k * size).value for k in range(nx)] == [*x]
    assert call_("rhs", p, kind(0), x, xdot, None, work) == 0
    call_("hold", p, kind(0), x, work)
    assert call_("rhs", p, kind(0), x, again, None, work) == 0
    assert bytes(xdot) == bytes(again)


@pytest.mark.parametrize("name", ["l", "lagc_mass", "L_1", 'a"b\\c', "thêta", "lagc_lagc_", "x??/"])
def test_strings_of_c(name: str) -> None:
    """A string holds the bytes of the name, and survives the renaming of the printer's prefixes."""
    from lagc.codegen.c.any_model import quoted

    text = quoted(name)
    assert text.isascii() and not re.search(r"lagc_|LAGC_|\?\?", text)
    assert eval(f"b{text}").decode() == name


C_MAIN = """#include "simple_pendulum.h"
#include <stdio.h>
int main(void)
{
    static simple_pendulum_work w;
    static simple_pendulum_state s;
    simple_pendulum_params p = simple_pendulum_default_params();
    simple_pendulum_options o = simple_pendulum_default_options();
    simple_pendulum_bind(&p);
    simple_pendulum_start(&p, s.x);
    simple_pendulum_begin(&s, 0, s.x);
    if (simple_pendulum_advance(&p, &s, 2, &o, &w))
        return 1;
    printf("%.17g\\n", s.x[0]);
    return 0;
}
"""
PROJECT = """cmake_minimum_required(VERSION 3.15)
project(app C CXX)
if(HOW STREQUAL "find")
  find_package(simple_pendulum 1.1 REQUIRED)
elseif(HOW STREQUAL "add")
  add_subdirectory(${GENERATED} generated)
else()
  include(FetchContent)
  FetchContent_Declare(simple_pendulum SOURCE_DIR ${GENERATED})
  FetchContent_MakeAvailable(simple_pendulum)
endif()
add_executable(in_c main.c)
add_executable(in_cxx main.cpp)
target_link_libraries(in_c PRIVATE lagc::simple_pendulum)
target_link_libraries(in_cxx PRIVATE lagc::simple_pendulum)
"""


@pytest.mark.full
@pytest.mark.skipif(shutil.which("cmake") is None, reason="there is no CMake")
@pytest.mark.skipif(shutil.which("g++") is None, reason="there is no C++ compiler")
def test_projects_of_cmake(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """find_package with a version, add_subdirectory, FetchContent and pkg-config, in C and C++: the same
    digits, also in a project that is compiled with -ffast-math."""
    generated, app, prefix_ = tmp_path / "generated", tmp_path / "app", tmp_path / "prefix"
    assert (
        main(["build", "simple_pendulum", "--cmake", "--version", "1.2.0", "-o", str(generated), "-q"]) == 0
    )
    capsys.readouterr()
    app.mkdir()
    (app / "CMakeLists.txt").write_text(PROJECT)
    (app / "main.c").write_text(C_MAIN)
    (app / "main.cpp").write_text(C_MAIN)
    quick = ["-DCMAKE_BUILD_TYPE=Debug"]
    call("cmake", "-S", generated, "-B", tmp_path / "lib", *quick, f"-DCMAKE_INSTALL_PREFIX={prefix_}",
         "-DBUILD_SHARED_LIBS=ON", "-DCMAKE_C_FLAGS=-Wall -Wextra -Werror")  # fmt: skip
    call("cmake", "--build", tmp_path / "lib")
    call("cmake", "--install", tmp_path / "lib")
    found = []
    for how in ("find", "add", "fetch"):
        fast = ["-DCMAKE_C_FLAGS=-ffast-math -O1"] if how == "add" else []
        call("cmake", "-S", app, "-B", tmp_path / how, *quick, *fast, f"-DHOW={how}",
             f"-DCMAKE_PREFIX_PATH={prefix_}", f"-DGENERATED={generated}")  # fmt: skip
        call("cmake", "--build", tmp_path / how)
        found += [call(tmp_path / how / "in_c"), call(tmp_path / how / "in_cxx")]
    if shutil.which("pkg-config"):
        (folder,) = {path.parent for path in prefix_.rglob("simple_pendulum.pc")}
        asked = ["env", f"PKG_CONFIG_PATH={folder}", "pkg-config"]
        assert call(*asked, "--modversion", "simple_pendulum").strip() == "1.2.0"
        flags = call(*asked, "--cflags", "--libs", "simple_pendulum").split()
        call("gcc", app / "main.c", *flags, "-o", tmp_path / "by_pkg_config")
        found.append(call("env", f"LD_LIBRARY_PATH={folder.parent}", tmp_path / "by_pkg_config"))
    assert len(set(found)) == 1 and abs(float(found[0])) < 1.0472
    done = subprocess.run(
        ["cmake", "-S", app, "-B", tmp_path / "newer", "-DHOW=find", f"-DCMAKE_PREFIX_PATH={prefix_}"],
        capture_output=True,
    )
    assert done.returncode == 0
    (app / "CMakeLists.txt").write_text(PROJECT.replace("simple_pendulum 1.1", "simple_pendulum 2.0"))
    with pytest.raises(AssertionError, match="requested version"):
        call("cmake", "-S", app, "-B", tmp_path / "other", "-DHOW=find", f"-DCMAKE_PREFIX_PATH={prefix_}")


@pytest.mark.full
@pytest.mark.skipif(shutil.which("gcc") is None, reason="there is no gcc")
@pytest.mark.parametrize("name", MODELS)
def test_code_without_integrators(name: str, tmp_path: Path) -> None:
    """`--only` compiles without a warning, has these functions alone, and a workspace of what they use."""
    program = of_model(name, work=False)
    own = prefix(program.interface.model)
    files = render(program, only=("rhs", "outputs"))
    header = next(text for file, text in files.items() if file.endswith(".h"))
    assert functions(header, own).keys() == {"default_params", "bind", "rhs", "outputs", "work_size"}
    assert f"{own}_state" not in header and f"{own}_options" not in header
    evaluating, whole = tmp_path / "evaluating", tmp_path / "whole"
    evaluating.mkdir()
    whole.mkdir()
    part, all_ = loaded(files, evaluating), loaded(render(program), whole)
    nx = program.interface.nx
    p, x = (ctypes.c_double * 1024)(), (ctypes.c_double * nx)()
    for k, field in enumerate((*program.interface.parameters, *program.interface.inputs)):
        p[k] = 1.0 if field.value is None else field.value
    getattr(all_, f"{own}_bind")(p)
    getattr(all_, f"{own}_start")(p, x)
    found, sizes = [], []
    for library in (part, all_):
        xdot = (ctypes.c_double * nx)()
        sizes.append(getattr(library, f"{own}_work_size")())
        work = ctypes.create_string_buffer(sizes[-1])
        getattr(library, f"{own}_bind")(p)
        status = getattr(library, f"{own}_rhs")(p, ctypes.c_double(0), x, xdot, None, work)
        found.append((status, bytes(xdot)))
    assert found[0] == found[1] and sizes[0] < sizes[1]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--only", "rhs,foo"], "`foo` is no function"),
        (["--only", "advance"], "`advance` is no function"),
        (["--only", "rhs", "--target", "numpy"], "--only needs --target c"),
        (["--cmake", "--target", "numpy"], "--cmake needs --target c"),
        (["--version", "1.0"], "--version needs --cmake"),
        (["--cmake", "--version", "1.x"], "no version"),
        (["--only", "rhs", "--events"], "give one of them"),
    ],
)
def test_options_that_do_not_fit(
    words: list[str], said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["build", "simple_pendulum", "-o", str(tmp_path), *words]) == 2
    assert said in capsys.readouterr().err and not os.listdir(tmp_path)


@pytest.mark.long
@pytest.mark.skipif(shutil.which("arm-none-eabi-gcc") is None, reason="there is no compiler for ARM")
def test_a_float_pendulum_on_a_controller(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Cortex-M4 with single precision: no double arithmetic, and a few hundred bytes without integrator."""
    program = of_model("course/simple_pendulum", work=False)
    sizes = {}
    for kind, only in (("rhs, outputs", ("rhs", "outputs")), ("all", ())):
        source = write(render(program, real=TYPES["float"], only=only), tmp_path)[".c"]
        call("arm-none-eabi-gcc", "-std=c99", "-Os", "-mcpu=cortex-m4", "-mthumb", "-mfpu=fpv4-sp-d16",
             "-mfloat-abi=hard", "-Wall", "-Wextra", "-Wdouble-promotion", "-Werror", "-c", source,
             "-o", tmp_path / "model.o")  # fmt: skip
        sizes[kind] = int(call("arm-none-eabi-size", tmp_path / "model.o").splitlines()[1].split()[0])
    with capsys.disabled():
        print("bytes of code and constants:", sizes)
    assert sizes["rhs, outputs"] < 1000 and sizes["all"] < 40_000
    calls = call("arm-none-eabi-nm", "-u", tmp_path / "model.o")
    assert not re.search(r"__aeabi_d|malloc|printf", calls)
