"""`lagc sim --animate --overlay --show`, and expressions of `--output`."""

import csv
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from lagc.cli.main import main
from lagc.reports.plots import panels
from tests.animation.pages import Page

PENDULUM = "simple_pendulum"


def sim(*words: str) -> int:
    return main(["sim", PENDULUM, "--backend", "numpy", "--stop", "2", *words])


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_animate_writes_a_page_and_says_where(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert sim("--animate") == 0
    assert "animation written to SimplePendulum_vacuum.html" in capsys.readouterr().err
    assert (
        Page((folder / "SimplePendulum_vacuum.html").read_text(encoding="utf-8")).data["model"]
        == "SimplePendulum"
    )
    assert sim("--animate", "own.html", "-q") == 0
    assert (folder / "own.html").exists() and not capsys.readouterr().err


def test_overlays_are_other_scenes_and_values(folder: Path) -> None:
    overlays = ["room", "theta=80[deg]", "l=0.3,der(theta)=1"]
    assert sim("--animate", "x.html", *(word for o in overlays for word in ("--overlay", o))) == 0
    page = Page((folder / "x.html").read_text(encoding="utf-8"))
    assert [run["label"] for run in page.data["runs"]] == ["", *overlays]
    start = [page.path("bob", [0.0], run=k)[0] for k in range(4)]
    assert start[1] == pytest.approx(start[0], abs=1e-3)
    assert np.degrees(np.arctan2(start[2][0], -start[2][2])) == pytest.approx(80.0, abs=0.1)
    assert np.linalg.norm(start[3]) == pytest.approx(0.3, abs=1e-3)


def test_an_expression_in_brackets_is_a_column(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert (
        sim("-o", "norm(velocity(bob))", "-o", "run.csv", "-o", "(theta/2)", "-o", "theta^2", "--json") == 0
    )
    final = json.loads(capsys.readouterr().out)["final"]
    with open(folder / "run.csv", encoding="utf-8", newline="") as file:
        last = list(csv.DictReader(file))[-1]
    assert float(last["norm(velocity(bob))"]) == final["norm(velocity(bob))"] == pytest.approx(
        abs(0.5 * final["der(theta)"]), rel=1e-12)  # fmt: skip
    assert float(last["(theta/2)"]) == final["theta"] / 2
    assert float(last["theta^2"]) == pytest.approx(final["theta"] ** 2, rel=1e-15)
    assert sim("-o", "run (1).csv") == 0 and (folder / "run (1).csv").exists()


@pytest.mark.parametrize(
    ("words", "code", "says"),
    [
        (["--animate", "x.pdf"], 2, ".html .gif .mp4"),
        (["--animate", "no/such/folder/x.html"], 2, "cannot be written"),
        (["--overlay", "room"], 2, "--animate"),
        (["--show", "theta"], 2, "--plot"),
        (["--plot", "p.svg", "--overlay", "room"], 2, "--show"),
        (["--plot", "p.svg", "--show", "tetha"], 2, "theta"),
        (["--plot", "p.svg", "--show", "norm(velocity(boob))"], 2, "bob"),
        (["--plot", "p.svg", "--show", "path(boob)"], 2, "bob"),
        (["--animate", "--overlay", "rom"], 2, "room"),
        (["--animate", "--overlay", "zz=1"], 2, "zz"),
        (["--animate", "--overlay", "l=1[s]"], 2, "`s`"),
        (["--animate", "--overlay", "room", "--overlay", "room"], 2, "twice"),
        (["-o", "norm(velocity(boob))"], 2, "bob"),
        (["-o", "a.csv", "-o", "b.csv"], 2, "one file"),
    ],
)
def test_what_is_wrong_is_reported_before_anything_runs(
    words: list[str], code: int, says: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert sim(*words) == code
    shown = capsys.readouterr()
    assert says in shown.err and not shown.out and not list(folder.iterdir())


def test_an_animation_does_not_overwrite_the_model(folder: Path) -> None:
    text = Path(__file__).parents[2] / "models" / "course" / "simple_pendulum.lag"
    (folder / "m.html").write_bytes(text.read_bytes())
    assert main(["sim", "m.html", "--animate", "m.html"]) == 2
    assert (folder / "m.html").read_bytes() == text.read_bytes()


def test_panels_are_drawn_from_columns_expressions_and_paths(folder: Path) -> None:
    pytest.importorskip("matplotlib")
    shown = ["theta*", "norm(velocity(bob))", "theta:der(theta)", "path(bob)", "energy"]
    words = [word for panel in shown for word in ("--show", panel)]
    assert sim("--plot", "p.svg", "--overlay", "room", *words) == 0
    assert (folder / "p.svg").read_text(encoding="utf-8").startswith("<?xml")


def test_words_of_show() -> None:
    names = ["a[1]", "a[2]", "b", "der(b)", "energy_in"]
    (panel,) = panels.parse(["a[*], b"], names)
    assert panel == panels.Panel("time", ("a[1]", "a[2]", "b"))
    (phase,) = panels.parse(["b : der(b), a*"], names)
    assert phase == panels.Panel("phase", ("der(b)", "a[1]", "a[2]"), "b")
    (path,) = panels.parse(["path(P, frame(1, 2).Q)"], names)
    assert path == panels.Panel("path", ("P", "frame(1, 2).Q"))
    assert [p.kind for p in panels.parse(["energy", "residuals"], names)] == ["energy", "residuals"]
    assert panels.expressions([path, phase], names) == ["position(P)", "position(frame(1, 2).Q)"]
    with pytest.raises(ValueError, match="der"):
        panels.parse(["dr(b)x"[:2]], ["der(b)", "dx"])


@pytest.mark.parametrize(
    "module", ["lagc.reports.animation", "lagc.reports.plots.panels", "lagc.compiler.probed"]
)
def test_a_run_without_pictures_loads_none_of_this(module: str) -> None:
    words = ["sim", PENDULUM, "-q", "--stop", "1"]
    program = f"import sys, lagc.cli.main as m; sys.exit(m.main({words}) or {module!r} in sys.modules)"
    assert subprocess.run([sys.executable, "-c", program], capture_output=True, timeout=120).returncode == 0
