"""What is installed holds all that it needs: the grammar, its tables, the models, the support code."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder as `pip install` lays it out, outside of the checkout."""
    pytest.importorskip("hatchling")
    folder = tmp_path_factory.mktemp("wheel")
    source = folder / "source"
    for name in ("lagc", "grammar", "models"):
        leave = shutil.ignore_patterns("__pycache__", "tables.json")
        shutil.copytree(ROOT / name, source / name, ignore=leave)
    for name in ("pyproject.toml", "hatch_build.py", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, source / name)
    build = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(folder)]
    subprocess.run(build, cwd=source, check=True, capture_output=True, timeout=120)
    site = folder / "site"
    with zipfile.ZipFile(next(folder.glob("*.whl"))) as archive:
        archive.extractall(site)
    return site


def run(site: Path, *words: str) -> str:
    environment = {**os.environ, "PYTHONPATH": str(site), "LAGC_CACHE": ""}
    program = "import sys, lagc.cli.main as m; assert sys.argv.pop(1) in m.__file__; sys.exit(m.main())"
    done = subprocess.run(
        [sys.executable, "-c", program, str(site), *words],
        cwd=site.parent,
        env=environment,
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_a_model_of_the_library_is_simulated(installed: Path) -> None:
    assert "theta" in run(installed, "sim", "simple_pendulum", "--backend", "numpy")


def test_code_is_generated(installed: Path) -> None:
    run(installed, "build", "course/string_pendulum", "-o", str(installed.parent / "made"))
    assert (installed.parent / "made" / "string_pendulum.c").stat().st_size > 10_000


def test_nothing_is_left_behind(installed: Path) -> None:
    for name in ("grammar/lag.lark", "frontend/tables.json", "models/classic/kepler.lag"):
        assert (installed / "lagc" / name).is_file()
    for path in (ROOT / "lagc").rglob("*"):
        if path.suffix in (".py", ".c", ".h"):
            assert (installed / "lagc" / path.relative_to(ROOT / "lagc")).is_file(), path
