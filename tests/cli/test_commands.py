"""The other commands: what they print and write, and their exit codes."""

import io
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from lagc.cli.main import main
from lagc.host.model_library import library_models

WRONG = "model M\n  coordinate Length x;\n  body b = Particle(mass = 1 [kg], at = {y, 0, 0});\nend M;\n"
Capture = pytest.CaptureFixture[str]


@pytest.fixture
def pendulum(tmp_path: Path, capsys: Capture) -> str:
    path = tmp_path / "Swing.lag"
    assert main(["new", str(path), "-q"]) == 0
    return str(path)


@pytest.mark.parametrize(
    "verb, command",
    [("run", "sim"), ("simulate", "sim"), ("compile", "build"), ("plot", "sim FILE --plot"), 
     ("format", "fmt"), ("chek", "check"), ("pendulum.lag", "lagc sim pendulum.lag")],
)  # fmt: skip
def test_verbs_of_other_tools_are_answered_with_the_command(
    verb: str, command: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([verb, "pendulum.lag"]) == 2
    assert f"there is no command `{verb}` (did you mean `{command}`?)" in capsys.readouterr().err


def test_version_and_help_are_words_too(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["version"]) == main(["help"]) == main(["help", "sim"]) == 0
    shown = capsys.readouterr().out
    assert shown.startswith("lagc ") and "usage: lagc COMMAND" in shown and "usage: lagc sim" in shown


def test_a_new_model_is_sound_and_simulates(pendulum: str, capsys: Capture) -> None:
    assert main(["check", pendulum]) == 0
    assert main(["sim", pendulum, "-q", "--backend", "numpy", "--stop", "1"]) == 0


def test_a_file_that_is_there_is_not_replaced(pendulum: str, capsys: Capture) -> None:
    assert main(["new", pendulum]) == 2
    assert "--force" in capsys.readouterr().err
    assert main(["new", pendulum, "--force"]) == 0


@pytest.mark.parametrize("name", ["1x", "a-b", "", "no/such/folder/x"])
def test_a_new_model_needs_a_name_and_a_folder(name: str, capsys: Capture) -> None:
    assert main(["new", name]) == 2
    assert len(capsys.readouterr().err.splitlines()) == 1


def test_the_models_of_the_library_are_listed(capsys: Capture) -> None:
    assert main(["new", "--list"]) == 0
    listed = dict(line.split(maxsplit=1) for line in capsys.readouterr().out.splitlines())
    assert list(listed) == library_models()
    assert listed["large/ball_chain"] == "A chain of rods with ball joints"
    assert main(["new"]) == 2 and "--list" in capsys.readouterr().err


def test_check_tells_every_fault_with_its_place(tmp_path: Path, capsys: Capture) -> None:
    path = tmp_path / "wrong.lag"
    path.write_text(WRONG)
    assert main(["check", str(path)]) == 1
    shown = capsys.readouterr().out
    assert "wrong.lag:3:42" in shown and "^" in shown
    assert main(["check", str(path), "--format", "json"]) == 1
    (fault,) = json.loads(capsys.readouterr().out)["faults"]
    assert (fault["line"], fault["column"], fault["severity"]) == (3, 42, "error")


def test_check_has_reached_nothing_of_a_file_that_is_not_there(tmp_path: Path, capsys: Capture) -> None:
    assert main(["check", str(tmp_path / "none.lag"), "--json"]) == 2
    assert len(json.loads(capsys.readouterr().out)["unseen"]) == 4


@pytest.mark.parametrize(
    ("line", "unseen"),
    [
        ("potential V = 1 [J", ["names and dimensions", "equations", "initial conditions"]),
        ("potential V = 1 [N];", ["equations", "initial conditions"]),
        ("constraint c: x - x = 1 [m];", ["initial conditions"]),
        ("constraint c: x^2 = -1 [m2];", []),
    ],
)
def test_check_says_which_stages_were_not_reached(
    line: str, unseen: list[str], tmp_path: Path, capsys: Capture
) -> None:
    path = tmp_path / "wrong.lag"
    path.write_text(WRONG.replace("y, 0, 0});", f"x, 0, 0}});\n  {line}"))
    assert main(["check", str(path), "--json"]) == 1
    assert json.loads(capsys.readouterr().out)["unseen"] == unseen
    assert main(["check", str(path)]) == 1
    assert ("fix this to check" in capsys.readouterr().out) == bool(unseen)


def test_standard_input_is_read_once(capsys: Capture) -> None:
    assert main(["check", "-", "-"]) == 2
    assert "once" in capsys.readouterr().err


def test_check_goes_on_after_a_missing_file(tmp_path: Path, capsys: Capture) -> None:
    path = tmp_path / "wrong.lag"
    path.write_text(WRONG)
    assert main(["check", "nofile.lag", str(path)]) == 1
    shown = capsys.readouterr().out
    assert "nofile.lag" in shown and "wrong.lag:3" in shown


def test_check_explains_a_code(capsys: Capture) -> None:
    assert main(["check", "--explain", "lag0601"]) == 0
    assert "LAG0601" in capsys.readouterr().out
    assert main(["check", "--explain", "LAG9999"]) == 2


@pytest.mark.parametrize("target, files", [("c", {"swing.h", "swing.c"}), ("numpy", {"swing.py"})])
def test_build_writes_files_with_the_values_given(
    target: str, files: set[str], pendulum: str, tmp_path: Path, capsys: Capture
) -> None:
    folder = tmp_path / "out"
    words = ["build", pendulum, "--target", target, "-o", str(folder), "-p", "l=90[cm]", "--json"]
    assert main(words) == 0
    found = json.loads(capsys.readouterr().out)
    assert {Path(f).name for f in found["files"]} == {f.name for f in folder.iterdir()} == files
    assert main(words[:-1]) == 0
    assert any("0.9" in f.read_text() for f in folder.iterdir())


@pytest.mark.parametrize("where", ["taken", "taken/below/it", "./taken"])
def test_build_into_a_file_is_wrong_usage_before_anything_is_compiled(
    where: str, pendulum: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    from lagc.compiler import pipeline

    monkeypatch.setattr(pipeline, "Compilation", None)
    monkeypatch.chdir(tmp_path)
    Path("taken").write_text("kept")
    assert main(["build", pendulum, "-o", where]) == 2
    assert "`" + where.removesuffix("/below/it") + "` is no folder" in capsys.readouterr().err
    assert Path("taken").read_text() == "kept"


@pytest.mark.parametrize(
    "words", [["-p", "zz=1"], ["--scene", "nowhere"], ["-o", "/dev/null/x"], ["--target", "ada"]]
)
def test_build_of_nonsense_is_wrong_usage(words: list[str], pendulum: str, capsys: Capture) -> None:
    assert main(["build", pendulum, *words]) == 2
    assert "Traceback" not in capsys.readouterr().err


def test_every_command_refuses_a_missing_file(capsys: Capture) -> None:
    assert main(["check"]) == 2
    for name in ("check", "fmt", "explain", "equations", "sim", "build", "linearize"):
        assert main([name, "nofile.lag"]) == 2, name
        captured = capsys.readouterr()
        assert "nofile.lag" in captured.out + captured.err


UGLY = "model  A\ncoordinate Length x;// c\nbody b=Particle(mass=1[kg],at={x,0,0});end A;"
LAID_OUT = (
    "model A\n  coordinate Length x;  // c\n  body b = Particle(mass = 1 [kg], at = {x, 0, 0});\nend A;\n"
)


def test_fmt_lays_a_file_out_once(tmp_path: Path, capsys: Capture) -> None:
    path = tmp_path / "a.lag"
    path.write_text(UGLY)
    path.chmod(0o640)
    assert main(["fmt", "--check", str(path)]) == 1 and path.read_text() == UGLY
    assert main(["fmt", str(path)]) == 0
    assert path.read_text() == LAID_OUT and path.stat().st_mode & 0o777 == 0o640
    assert main(["fmt", "--check", str(path)]) == 0


def test_fmt_of_standard_input_is_written_to_standard_output(
    monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    class Stdin:
        buffer = io.BytesIO(UGLY.encode())

    monkeypatch.setattr(sys, "stdin", Stdin())
    assert main(["fmt", "-"]) == 0
    assert capsys.readouterr().out == LAID_OUT


def test_fmt_leaves_a_file_with_mistakes_alone(tmp_path: Path, capsys: Capture) -> None:
    path = tmp_path / "a.lag"
    path.write_text("model A coordinate")
    assert main(["fmt", str(path)]) == 1
    assert path.read_text() == "model A coordinate"


def test_matrices_are_no_work_for_threads() -> None:
    """These wait for each other where others work; what a user says counts."""
    text = (
        "import os\nfrom lagc.cli.program import program\nassert 'numpy' not in __import__('sys').modules\n"
        "program()\nprint(os.environ['OPENBLAS_NUM_THREADS'], os.environ['MKL_NUM_THREADS'])"
    )
    own = {k: v for k, v in os.environ.items() if k not in ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")}
    done = subprocess.run(
        [sys.executable, "-c", text, "--version"],
        env={**own, "MKL_NUM_THREADS": "2"},
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.splitlines()[-1] == "1 2"
