"""`lagc hard`: what it prints, its exit codes, its files, and what Ctrl-C leaves."""

import json
import shlex
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

import lagc
from lagc.cli.main import Parser, main
from lagc.cli.output import DONE, FAILED, INTERRUPTED, USAGE
from lagc.reports.hard import to_dict
from lagc.study.hard import case
from lagc.study.hard.cases import CASES

Capture = pytest.CaptureFixture[str]


def test_cases_are_listed_with_their_figures(capsys: Capture) -> None:
    assert main(["hard", "--list"]) == DONE
    shown = capsys.readouterr().out
    for each in CASES:
        (line,) = [line for line in shown.splitlines() if line.startswith(f"  {each.name} ")]
        assert each.title in line and each.figures[0].words in line


def test_a_case_is_explained_and_measured(capsys: Capture) -> None:
    assert main(["hard", "contradiction", "--backend", "numpy"]) == DONE
    shown = capsys.readouterr().out
    model, line = "four_bar_again.lag", "lagc sim four_bar_again"
    for word in ("what is hard", "source", "why", model, line, "kept: 1 of 1"):
        assert word in shown


def test_an_unknown_case_is_named_with_the_closest(capsys: Capture) -> None:
    assert main(["hard", "contradictio"]) == USAGE
    assert "did you mean `contradiction`?" in capsys.readouterr().err


@pytest.mark.full
def test_a_missed_figure_is_told_and_fails(capsys: Capture) -> None:
    words = ["hard", "contradiction", "tip_angles", "--backend", "numpy"]
    assert main([*words, "--json"]) == FAILED
    found = json.loads(capsys.readouterr().out)
    kept = {each["name"]: each["kept"] for each in found["cases"]}
    assert kept == {"contradiction": True, "tip_angles": False} and not found["kept"]
    (figure,) = found["cases"][1]["figures"]
    assert not figure["kept"] and figure["measured"] > figure["required"] == 1e-13
    assert main([*words, "--markdown", "-q"]) == FAILED
    assert "**missed**" in capsys.readouterr().out


def test_a_run_that_fails_is_a_missed_case(monkeypatch: pytest.MonkeyPatch, capsys: Capture) -> None:
    def failing(lab: case.Lab) -> case.Found:
        raise case.RunFailed("the step size underflowed")

    (one,) = [each for each in CASES if each.name == "contradiction"]
    row = case.measured(case.Case(**{**vars(one), "measure": failing}), case.Lab(lagc.load, "numpy"))
    assert not row.meets_figures and row.failure == "the step size underflowed"


def test_values_are_plain_numbers() -> None:
    """Measured with arrays, printed as JSON."""
    (one,) = [each for each in CASES if each.name == "contradiction"]
    measure = lambda lab: case.Found((np.float64(1.0),), "none")  # noqa: E731
    row = case.measured(case.Case(**{**vars(one), "measure": measure}), case.Lab(lagc.load, "numpy"))
    json.dumps(to_dict(case.Hard([row])))


def test_an_interrupt_leaves_the_rows_so_far(monkeypatch: pytest.MonkeyPatch, capsys: Capture) -> None:
    def stopped(lab: case.Lab) -> case.Found:
        raise KeyboardInterrupt

    table = [each for each in CASES if each.name in ("contradiction", "massless")]
    table[1] = case.Case(**{**vars(table[1]), "measure": stopped})
    monkeypatch.setattr("lagc.study.hard.cases.CASES", tuple(table))
    assert main(["hard", "--backend", "numpy"]) == INTERRUPTED
    shown = capsys.readouterr().out
    assert "kept: 1 of 1 cases; ended early" in shown


@pytest.mark.full
def test_files_have_the_table_and_the_picture(tmp_path: Path, capsys: Capture) -> None:
    pytest.importorskip("matplotlib")
    files = [tmp_path / f"hard.{ending}" for ending in ("html", "json", "png", "svg")]
    words = [word for file in files for word in ("-o", str(file))]
    assert main(["hard", "speed", "--backend", "numpy", *words]) == DONE
    assert files[0].read_text().count("<svg") == 1 and "drift" in files[0].read_text()
    assert json.loads(files[1].read_text())["kept"]
    assert files[2].read_bytes().startswith(b"\x89PNG")


def test_a_file_needs_a_known_ending(tmp_path: Path) -> None:
    assert main(["hard", "speed", "-o", str(tmp_path / "hard.txt")]) == USAGE


@pytest.mark.parametrize("each", CASES, ids=[each.name for each in CASES])
def test_the_line_of_a_case_is_a_command(each: case.Case) -> None:
    program, command, *words = shlex.split(each.line)
    assert program == "lagc"
    module = import_module(f"lagc.cli.{command}")
    parser = Parser(prog="lagc", allow_abbrev=False)
    module.add_options(parser)
    options = parser.parse_args(words)
    assert lagc.load(options.file).source.text == lagc.load(each.model).source.text
