"""The command `derive` and `model.derivation()`."""

import json
import shutil
from pathlib import Path

import pytest

import lagc
from lagc.cli.main import main

Capture = pytest.CaptureFixture[str]


def test_markdown_is_printed(capsys: Capture) -> None:
    assert main(["derive", "simple_pendulum"]) == 0
    text = capsys.readouterr().out
    assert (
        text.startswith("# A mass on a massless string")
        and r"l \, \ddot{\theta} + g \, \sin \theta = 0" in text
    )


@pytest.mark.parametrize(
    "ending, begins", [(".md", "# "), (".tex", r"\documentclass"), (".html", "<!DOCTYPE html>")]
)
def test_the_ending_chooses_the_format(ending: str, begins: str, tmp_path: Path, capsys: Capture) -> None:
    path = tmp_path / f"solution{ending}"
    assert main(["derive", "simple_pendulum", "--language", "fr", "-o", str(path)]) == 0
    text = path.read_text(encoding="utf-8")
    assert text.startswith(begins) and "Énergie cinétique" in text
    assert capsys.readouterr().err == f"{path} written\n"


def test_another_ending_is_refused(capsys: Capture) -> None:
    assert main(["derive", "simple_pendulum", "-o", "solution.doc"]) == 2
    assert ".md, .tex, .html, .pdf" in capsys.readouterr().err


def test_a_pdf_without_latex_is_refused(
    tmp_path: Path, capsys: Capture, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(shutil, "which", lambda _: None)
    path = tmp_path / "solution.pdf"
    assert main(["derive", "simple_pendulum", "-o", str(path)]) == 2
    assert "pdflatex" in capsys.readouterr().err and not path.exists()


def test_the_scene_is_chosen_and_json_holds_the_text(capsys: Capture) -> None:
    assert main(["derive", "simple_pendulum", "--scene", "room", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["scene"] == "room" and "drag" in found["solution"]


def test_notebooks_fold_the_sections() -> None:
    found = lagc.load("simple_pendulum").derivation("de")
    assert found._repr_html_().count("<details >") == 12 and "Kinematik" in found._repr_markdown_()


def test_long_formulas_are_abbreviated_and_counted_unless_all_is_asked_for() -> None:
    total = " + ".join([f"cos({n}*x)" for n in range(1, 43)])
    text = f"""model M
  parameter Mass m = 1 [kg];
  parameter Length l = 1 [m];
  coordinate Angle x;
  body b = Particle(mass = m, at = {{l*x, 0, 0}});
  potential V = 1 [J]*({total});
end M;
"""
    model = lagc.loads(text).compile()
    short, whole = model.derivation(), model.derivation(full=True)
    assert "(34 more terms)" in short.markdown and "Abbreviated formulas" in short.markdown
    assert "more terms" not in whole.markdown and len(whole.markdown) > len(short.markdown)
