"""The text of every stage for a dozen models, so that a change shows what it changes.

Nothing is proved by it: LAGC_GOLDEN=update writes the files anew, and the difference is read.
"""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from lagc.cli.main import main
from lagc.codegen.c.emit import render as render_c
from lagc.codegen.c.functions import function_text
from lagc.codegen.c.header import places
from lagc.codegen.identifiers import local_names
from lagc.codegen.python.emit import render as render_numpy
from lagc.diagnostics.faults import Source
from lagc.syntax.formatter import format_source
from tests.codegen.tools import MODELS, of_model

FOLDER = Path(__file__).parent / "golden"
NAMES = (
    "classic/double_pendulum", "classic/four_bar", "classic/heavy_top_quaternion", "classic/rolling_disc",
    "classic/chaplygin_sleigh_speeds", "classic/kepler", "classic/relativistic_particle",
    "classic/driven_oscillator",
    "classic/slider_crank", "classic/coupled_oscillators", "course/simple_pendulum", "course/string_pendulum",
)  # fmt: skip
WHOLE = ("course/simple_pendulum", "classic/heavy_top_quaternion")  # with their runtime


def compare(name: str, found: str) -> None:
    path = FOLDER / name
    if os.environ.get("LAGC_GOLDEN") == "update":
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(found, encoding="utf-8")
    assert found == path.read_text(encoding="utf-8"), f"{name}: LAGC_GOLDEN=update writes what is new"


@pytest.mark.sample(2)
@pytest.mark.parametrize("name", NAMES)
def test_stages(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    source = Source(f"{name}.lag", (MODELS / f"{name}.lag").read_text(encoding="utf-8"))
    compare(f"{name}/model.lag", format_source(source))
    for command in ("explain", "equations"):
        assert main([command, name]) == 0
        compare(f"{name}/{command}.txt", capsys.readouterr().out)
    program = of_model(name)
    fields = places(program.interface)
    own = local_names(program, ())
    compare(f"{name}/program.c", "\n".join(function_text(f, own, fields) for f in program.functions.values()))


@pytest.mark.parametrize("name", WHOLE)
def test_generated_files(name: str) -> None:
    program = of_model(name)
    for file, text in {**render_c(program), **render_numpy(program)}.items():
        compare(f"{name}/{file}.txt", text)


def test_no_file_is_left_over() -> None:
    known = {FOLDER / name for name in NAMES}
    assert {p.parent for p in FOLDER.rglob("*") if p.is_file()} == known
