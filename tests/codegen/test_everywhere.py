"""Generated C gives the same bits everywhere, and analysers and memory checkers have nothing to say of it.

A sample of models; `python -m tests.supply generated` asks for all of the library.
"""

import re
from pathlib import Path

import pytest

from tests.codegen.everywhere import LEVELS, clang, compilers, machines, prepare, printed, tools
from tests.codegen.tools import STRICT, of_model

EXTREME = [LEVELS[0], LEVELS[-1]]


@pytest.mark.sample(0, 2)
@pytest.mark.parametrize(
    ("model", "levels"),
    [("classic/double_pendulum", LEVELS), ("classic/four_bar", EXTREME), ("classic/gyroscope", EXTREME)],
)
def test_the_same_bits_at_every_level_of_every_compiler(
    model: str, levels: list[list[str]], tmp_path: Path
) -> None:
    if not compilers():
        pytest.skip("neither gcc nor clang is here")
    units = prepare(of_model(model), tmp_path)
    found = {
        (name, *level): printed([*words, *STRICT, *level], units, tmp_path)
        for name, words in compilers().items()
        for level in levels
    }
    (text,) = set(found.values())
    assert len(text.split()) > 100 and "nan" not in text


@pytest.mark.skipif(not machines(), reason="no other machine is here, or LAGC_MACHINES does not ask for them")
@pytest.mark.parametrize("model", ["double_pendulum", "four_bar", "heavy_top_quaternion", "andrews_squeezer"])
def test_the_same_bits_on_every_machine(model: str, tmp_path: Path) -> None:
    """Whole runs too, in steps that are chosen by their error."""
    units = prepare(of_model(f"classic/{model}"), tmp_path)
    here = printed([*(clang() or ()), "-O2"], units, tmp_path)
    for name, machine in machines().items():
        assert printed(machine.compile_, units, tmp_path, machine.under) == here, name


@pytest.mark.full
@pytest.mark.parametrize("name", tools())
def test_checkers_report_nothing(name: str, tmp_path: Path) -> None:
    tool = tools()[name]
    if tool is None:
        pytest.skip(f"{name} is not here")
    models = (
        ["course/string_pendulum"] if tool.analyse else ["classic/double_pendulum", "course/string_pendulum"]
    )
    for model in models:
        tool.ask(prepare(of_model(model), tmp_path), tmp_path)


BAD = """\
#include <stdlib.h>
int f(int n) { volatile int x[2]; if (n > 5) x[0] = 1; if (x[0] > 2) return 1; return 0; }
int g(int n) { volatile int *p = (int *)malloc(8); if (!p) return 1; free((int *)p); *p = n; return *p; }
"""
MAIN = """\
#include <stdio.h>
int f(int);
int g(int);
int main(int c, char **v) { (void)v; if (f(c) > 0) puts("f"); return g(c) == 77; }
"""


@pytest.mark.sample(1)
@pytest.mark.parametrize("name", tools())
def test_checkers_find_errors(name: str, tmp_path: Path) -> None:
    tool = tools()[name]
    if tool is None:
        pytest.skip(f"{name} is not here")
    (tmp_path / "bad.c").write_text(BAD)
    (tmp_path / "main.c").write_text(MAIN)
    with pytest.raises(AssertionError):
        tool.ask([str(tmp_path / "bad.c"), str(tmp_path / "main.c")], tmp_path)


@pytest.mark.full
def test_the_program_calls_every_public_function(tmp_path: Path) -> None:
    units = prepare(of_model("classic/four_bar"), tmp_path)
    text = (tmp_path / "four_bar.h").read_text()
    public = set(re.findall(r"^(?:\w+ )+\**(four_bar_\w+)\(", text, re.M))
    called = set(re.findall(r"four_bar_\w+", (tmp_path / "everywhere.c").read_text()))
    assert len(public) > 15 and len(units) == 9
    assert public <= called | {
        "four_bar_measures",
        "four_bar_check",
        "four_bar_status_text",
        "four_bar_displace",
        "four_bar_gaps",
        "four_bar_hold",
        "four_bar_seated",
    }  # numbers and texts; functions that have nothing to do
