"""Commands after `pip install .` alone: in a process where matplotlib cannot be imported.

A picture is refused before the computation; a page is written without it.
"""

import json
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
WITHOUT = """
import os, sys

class Hidden:
    def find_spec(self, name, path=None, target=None):
        extras = {"matplotlib", "pandas", "pyarrow", "sympy", "scipy", "xarray", "distributed"}
        if name.partition(".")[0] in {*extras, os.environ.get("HIDDEN")}:
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)

sys.meta_path.insert(0, Hidden())
from lagc.cli.program import program
sys.exit(program())
"""
MODEL = """model Drop
  coordinate Length z(start = 1 [m]);
  body b = Particle(mass = 1 [kg], at = {0, 0, z});
  force drag = -0.1 [kg/s]*velocity(b) at b;
  effect gravity
    Gravity field;
  end gravity;
  scene lab uses gravity
    simulate(stop = 0.1 [s]);
  end lab;
end Drop;
"""


def lagc(folder: Path, *words: str) -> subprocess.CompletedProcess[str]:
    done = subprocess.run(
        [sys.executable, "-c", WITHOUT, *words], cwd=folder, capture_output=True, text=True, timeout=300,
        check=False,
    )  # fmt: skip
    assert "LAG0799" not in done.stderr and "Traceback" not in done.stderr, done.stderr
    return done


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "drop.lag").write_text(MODEL, encoding="utf-8")
    return tmp_path


def commands() -> list[str]:
    """The commands of the README."""
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    (block,) = re.findall(r"^```sh\n(lagc .*?)^```", text, re.MULTILINE | re.DOTALL)
    return [line for line in block.splitlines() if line]


@pytest.mark.full
def test_the_commands_of_the_readme(tmp_path: Path) -> None:
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    (model,) = re.findall(r"^```modelica\n(model SimplePendulum .*?)^```", text, re.MULTILINE | re.DOTALL)
    (tmp_path / "pendulum.lag").write_text(model, encoding="utf-8")
    assert len(commands()) >= 6
    for line in commands():
        words = shlex.split(line, comments=True)[1:]
        budget = ["--budget", "2", "--max-time", "none"] if words[0] == "cost" else []
        done = lagc(tmp_path, *words, *budget)
        if "--plot" in words:
            assert done.returncode == 2 and "pip install matplotlib" in done.stderr, line
        else:
            assert done.returncode == 0, (line, done.stderr)
    assert "matplotlib" in (tmp_path / "cost.html").read_text(encoding="utf-8")


STUDIES = {
    "cost": ("cost", "drop.lag", "--budget", "1", "--max-time", "none"),
    "effects": ("effects", "drop.lag", "--accuracy", "1e-3"),
    "hard": ("hard", "kepler"),
}


@pytest.mark.full
@pytest.mark.parametrize("study", STUDIES)
def test_a_page_without_its_picture_has_the_results(folder: Path, study: str) -> None:
    done = lagc(folder, *STUDIES[study], "-o", "page.html", "-o", "data.json")
    assert done.returncode in (0, 3), done.stderr
    assert "pip install matplotlib" in done.stderr and len(done.stdout.splitlines()) > 3
    page = (folder / "page.html").read_text(encoding="utf-8")
    assert "pip install matplotlib" in page and "<svg" not in page
    assert done.stdout.split(maxsplit=1)[0].rstrip(",:") in page
    assert json.loads((folder / "data.json").read_text(encoding="utf-8"))


@pytest.mark.parametrize("study", STUDIES)
def test_a_picture_is_refused_before_the_study(folder: Path, study: str) -> None:
    done = lagc(folder, *STUDIES[study], "-o", "picture.svg")
    assert done.returncode == 2 and "pip install matplotlib" in done.stderr
    assert not done.stdout and not (folder / "picture.svg").exists()


@pytest.mark.parametrize(
    "words",
    [
        ("sim", "--plot", "p.png"), ("linearize", "--plot", "p.png"), ("compare", "--plot", "p.png"),
        ("sim", "-o", "p.parquet"), ("sweep", "-o", "p.parquet"), ("sweep", "-o", "p.nc"),
        ("fit", "data.csv"),
        ("sweep", "z=1,2", "-o", "p.csv", "--dask", "tcp://head:8786"),
    ],
)  # fmt: skip
def test_a_package_is_asked_for_before_the_run(folder: Path, words: tuple[str, ...]) -> None:
    done = lagc(folder, words[0], "drop.lag", *words[1:])
    assert done.returncode == 2 and "pip install" in done.stderr and not done.stdout


@pytest.mark.parametrize(
    ("package", "words", "install"),
    [
        ("numpy", ("linearize", "drop.lag"), "pip install numpy"),
        ("pygls", ("lsp",), 'pip install "lagc[lsp]"'),
    ],
)
def test_a_command_says_what_is_missing(
    folder: Path, monkeypatch: pytest.MonkeyPatch, package: str, words: tuple[str, ...], install: str
) -> None:
    monkeypatch.setenv("HIDDEN", package)
    done = lagc(folder, *words)
    assert done.returncode == 2 and install in done.stderr and not done.stdout


def test_a_sweep_needs_no_package(folder: Path) -> None:
    words = ("start(z)=1,2", "--rtol", "1e-6", "--backend", "numpy", "-o", "out.csv")
    done = lagc(folder, "sweep", "drop.lag", *words)
    assert done.returncode == 0, done.stderr
    assert len((folder / "out.csv").read_text(encoding="utf-8").splitlines()) == 3
