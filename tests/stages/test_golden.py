"""The text of every stage for a dozen models, so that a change shows what it changes: of two models as it is,
of the others and of whole generated files a hash of each.

Nothing is proved by it.  To read what a hash that differs stands for, write all texts before the change and
after it, and compare the folders:

    LAGC_GOLDEN=before python -m pytest -m '' tests/stages/test_golden.py
    LAGC_GOLDEN=after python -m pytest -m '' tests/stages/test_golden.py
    diff -r before after

LAGC_GOLDEN=update writes the texts and hashes anew.
"""

import hashlib
import json
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
TEXTS = ("course/simple_pendulum", "course/string_pendulum")  # without and with a constraint
WHOLE = ("course/simple_pendulum", "classic/heavy_top_quaternion")  # with their runtime
HASHES = FOLDER / "hashes.json"  # of each other text: its SHA-256
HELP = "see the beginning of tests/stages/test_golden.py: how to see what differs, and how to accept it"


def compare(name: str, text: str) -> None:
    chosen = os.environ.get("LAGC_GOLDEN")
    readable = name.startswith(TEXTS) and not name.endswith((".c.txt", ".h.txt", ".py.txt"))
    digest = hashlib.sha256(text.encode()).hexdigest()
    if chosen and (readable or chosen != "update"):
        path = (FOLDER if chosen == "update" else Path(chosen)) / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    elif chosen:
        FOLDER.mkdir(exist_ok=True)
        hashes = {**known_hashes(), name: digest}
        HASHES.write_text(json.dumps(hashes, indent=0, sort_keys=True) + "\n")
    if chosen in (None, "update"):
        same = text == (FOLDER / name).read_text() if readable else digest == known_hashes().get(name)
        assert same, f"{name} differs; {HELP}"


def known_hashes() -> dict[str, str]:
    hashes: dict[str, str] = json.loads(HASHES.read_text()) if HASHES.exists() else {}
    return hashes


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


def test_no_text_is_left_over() -> None:
    folders = {p.parent for p in FOLDER.rglob("*") if p.is_file()}
    assert folders == {FOLDER, *(FOLDER / name for name in TEXTS)}
    assert {name.rpartition("/")[0] for name in known_hashes()} == {*NAMES[:-1]}  # the last has texts alone
