"""Results whose place cannot be written in the end are kept under another name, which is said."""

import errno
import os
import re
import shutil
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from lagc.api import CompiledModel, Run
from lagc.cli.main import main
from lagc.simulation.backends.compile import compiler

pytestmark = pytest.mark.usefixtures("own_cache")
Capture = pytest.CaptureFixture[str]
SIM = ["sim", "simple_pendulum", "--backend", "numpy", "--stop", "1"]


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The current folder, and that of temporary files."""
    for name in ("here", "tmp", "far"):
        (tmp_path / name).mkdir()
    monkeypatch.chdir(tmp_path / "here")
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "tmp"))
    return tmp_path


def after_the_run(monkeypatch: pytest.MonkeyPatch, happens: Callable[[], object]) -> None:
    run = CompiledModel.run

    def changed(*arguments: Any, **named: Any) -> Run:
        found = run(*arguments, **named)
        happens()
        return found

    monkeypatch.setattr(CompiledModel, "run", changed)


def full(*_: object) -> None:
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def kept(here: Path, said: str) -> Path:
    found = re.search(r"the result is kept in (.*)", said)
    assert found is not None and Path(found[1]).exists()
    return Path(found[1])


@pytest.mark.parametrize("ending", [".csv", ".npz", ".svg", pytest.param(".parquet", marks=pytest.mark.full)])
def test_a_folder_that_goes_while_it_is_computed(
    ending: str, here: Path, monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    option = "--plot" if ending == ".svg" else "-o"
    pytest.importorskip({".parquet": "pyarrow", ".svg": "matplotlib"}.get(ending, "numpy"))
    assert main([*SIM, option, str(here / f"run{ending}")]) == 0
    wanted = (here / f"run{ending}").read_bytes()
    after_the_run(monkeypatch, lambda: shutil.rmtree(here / "far"))
    capsys.readouterr()
    assert main([*SIM, option, str(here / "far" / f"run{ending}")]) == 74
    out, err = capsys.readouterr()
    assert "theta" in out and "cannot be written" in err
    path = kept(here, err)
    assert path.parent == here / "here" and path.suffix == ending and path.read_bytes() == wanted


def test_where_the_current_folder_is_gone_too(
    here: Path, monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    if sys.platform == "win32":
        pytest.skip("a current folder cannot go")

    def happens() -> None:
        shutil.rmtree(here / "far")
        shutil.rmtree(here / "here")

    after_the_run(monkeypatch, happens)
    assert main([*SIM, "-o", str(here / "far" / "run.csv")]) == 74
    assert kept(here, capsys.readouterr().err).parent == here / "tmp"


@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EDQUOT, errno.EIO, errno.EROFS, errno.EACCES])
def test_every_fault_of_the_disk_is_told_and_leaves_the_old_file(
    number: int, here: Path, monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    fsync, failing = os.fsync, [1]

    def faulty(descriptor: int) -> None:
        if failing:
            failing.pop()
            raise OSError(number, os.strerror(number))
        fsync(descriptor)

    (here / "far" / "run.csv").write_text("old")
    monkeypatch.setattr(os, "fsync", faulty)
    assert main([*SIM, "-o", str(here / "far" / "run.csv")]) == 74
    err = capsys.readouterr().err
    assert os.strerror(number) in err
    assert len(kept(here, err).read_text().splitlines()) == 502
    assert [p.name for p in (here / "far").iterdir()] == ["run.csv"]
    assert (here / "far" / "run.csv").read_text() == "old"


def test_where_nothing_can_be_written_the_result_is_printed(
    here: Path, monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    after_the_run(monkeypatch, lambda: monkeypatch.setattr(os, "fsync", full))
    assert main([*SIM, "-o", str(here / "far" / "run.csv")]) == 74
    out, err = capsys.readouterr()
    assert "theta" in out and "could not be kept elsewhere" in err
    assert not [p for p in here.rglob("*") if p.is_file()]


@pytest.mark.parametrize("letter", ["x", "\N{LATIN SMALL LETTER E WITH ACUTE}", "\N{SNOWMAN}", "\U0001f600"])
def test_a_long_name_is_written_or_kept_or_refused_before(
    letter: str, here: Path, monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    most, size = os.pathconf(here, "PC_NAME_MAX"), len(letter.encode())
    name = letter * ((most - len(".csv.json")) // size) + ".csv"
    assert main([*SIM, "-o", str(here / "far" / name)]) == 0
    content = (here / "far" / name).read_bytes()
    assert main([*SIM, "-o", str(here / "far" / f"xxxx{name}")]) == 2  # what is beside it has no name
    assert main([*SIM, "--plot", str(here / "far" / f"xxxxxxxxx{name[:-4]}.svg")]) == 2
    after_the_run(monkeypatch, lambda: shutil.rmtree(here / "far"))
    capsys.readouterr()
    assert main([*SIM, "-o", str(here / "far" / name)]) == 74
    assert kept(here, capsys.readouterr().err).read_bytes() == content


def test_what_shows_before_is_wrong_usage(here: Path, capsys: Capture) -> None:
    (here / "far" / "run.csv.json").mkdir()
    for path in ("nowhere/run.csv", "far/run.csv", "../far/run.csv", "run"):
        assert main([*SIM, "-o", str(here / path)]) == 2
        assert len(capsys.readouterr().err.splitlines()) == 1


@pytest.mark.parametrize("words", [
    ["build", "simple_pendulum", "-o", "out/of/it"], ["new", "Swing"],
    ["new", "Swing", "--force"], ["fmt", "ugly.lag"],
])  # fmt: skip
def test_a_full_disk_is_no_wrong_usage(
    words: list[str], here: Path, monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    ugly = "model  A\ncoordinate Length x;body b=Particle(mass=1[kg],at={x,0,0});end A;"
    Path("ugly.lag").write_text(ugly)

    monkeypatch.setattr(os, "fsync", full)
    assert main(words) == 74
    assert "No space left" in capsys.readouterr().err
    assert Path("ugly.lag").read_text() == ugly
    assert {p.name for p in Path().iterdir()} == {"ugly.lag"}


@pytest.mark.full
def test_files_that_are_named_after_a_model_have_a_name_however_long_that_is(
    here: Path, monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    pytest.importorskip("matplotlib")
    monkeypatch.setattr("lagc.reports.plots.plot.has_display", lambda: False)
    before: set[Path] = set()
    for length in (59, 61, 120, 121, 254, 1000):
        for last in "ab":  # models that differ in the end only
            name = "A" * length + last
            Path("m.lag").write_text(
                f"model {name}\n  coordinate Length x;\n"
                f"  body b = Particle(mass = 1 [kg], at = {{x, 0, 0}});\nend {name};\n",
                encoding="utf-8",
            )
            words = ["sim", "m.lag", "-q", "--backend", "numpy", "--stop", "1"]
            if length == 254:
                words.append("--plot")
            for each in (["build", "m.lag"], ["build", "m.lag", "--target", "numpy"], words):
                assert main(each) == 0, (each, capsys.readouterr().err)
            found = {path for path in Path().iterdir() if path.name != "m.lag"}
            assert len(found - before) == (4 if length == 254 else 3)
            before = found


@pytest.mark.skipif(shutil.which("cc") is None, reason="a C compiler")
def test_a_model_of_a_long_name_is_compiled(here: Path, capsys: Capture) -> None:
    name = "A" * 300
    text = f"model {name}\n  coordinate Length x;\n  body b = Particle(mass = 1 [kg], at = {{x, 0, 0}});\n"
    Path("m.lag").write_text(f"{text}end {name};\n")
    assert main(["sim", "m.lag", "-q", "--backend", "c", "--stop", "1"]) == 0, capsys.readouterr().err


@pytest.mark.skipif(not hasattr(os, "fork"), reason="a compiler that is a script")
def test_a_full_disk_while_compiling_is_no_wrong_usage(
    here: Path, monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    """Also where it is the compiler that tells of it; any other fault of a compiler is one of usage."""
    words, full = ["sim", "simple_pendulum", "-q", "--backend", "c", "--stop", "1"], os.strerror(errno.ENOSPC)
    for said, code in ((f"cc: fatal error: writing: {full}", 74), ("cc: error: syntax", 2)):
        compiler.cache_clear()
        Path("cc").write_text(f"#!/bin/sh\necho '{said}' >&2\nexit 1\n")
        Path("cc").chmod(0o755)
        monkeypatch.setenv("LAGC_CC", str(here / "here" / "cc"))
        assert main(words) == code
        assert full in capsys.readouterr().err or code == 2
    for number, code in ((errno.ENOSPC, 74), (errno.EDQUOT, 74), (errno.ENOEXEC, 2)):

        def fails(*_: object, number: int = number) -> None:
            raise OSError(number, os.strerror(number))

        monkeypatch.setattr("lagc.simulation.backends.compile._compile", fails)
        assert main(words) == code
        assert os.strerror(number) in capsys.readouterr().err
    compiler.cache_clear()
