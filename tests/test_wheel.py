"""What is installed holds all that it needs: the grammar, its tables, the models, the support code."""

import json
import os
import shutil
import subprocess
import sys
import tarfile
import tomllib
import zipfile
from pathlib import Path

import pytest

pytestmark = pytest.mark.full  # they build the package

ROOT = Path(__file__).resolve().parents[1]
HATCH = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["hatch"]
SHIPPED = ["/pyproject.toml", "/.gitignore", *HATCH["build"]["targets"]["sdist"]["include"]]


def checkout(target: Path) -> Path:
    """What the repository has under version control, as far as it is shipped, in a folder of its own."""
    leave = shutil.ignore_patterns("__pycache__", "tables.json", "kernels.*.json", "*.pyc")
    target.mkdir(parents=True)
    for pattern in SHIPPED:
        for path in ROOT.glob(pattern.removeprefix("/")):
            if path.is_dir():
                shutil.copytree(path, target / path.name, ignore=leave)
            else:
                shutil.copy(path, target / path.name)
    return target


def build(source: Path, **environment: str) -> Path:
    """The folder of the sdist and the wheel of `source`."""
    pytest.importorskip("hatchling")
    kept = {name: value for name, value in os.environ.items() if name != "SOURCE_DATE_EPOCH"}
    command = [sys.executable, "-m", "hatchling", "build", "-d", "dist"]
    subprocess.run(
        command, cwd=source, env={**kept, **environment}, check=True, capture_output=True, timeout=120
    )
    return source / "dist"


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build(checkout(tmp_path_factory.mktemp("built") / "source"), PYTHONHASHSEED="0")


@pytest.fixture(scope="module")
def installed(built: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder as `pip install` lays it out, outside of the checkout."""
    site = tmp_path_factory.mktemp("wheel") / "site"
    with zipfile.ZipFile(next(built.glob("*.whl"))) as archive:
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
    for name in (
        "grammar/lag.lark",
        "syntax/tables.json",
        "codegen/kernel_compiler/kernels.double.json",
        "codegen/kernel_compiler/kernels.python.json",
        "models/classic/kepler.lag",
        "messages/syntax.md",
    ):
        assert (installed / "lagc" / name).is_file()
    for path in (ROOT / "lagc").rglob("*"):
        if path.suffix in (".py", ".c", ".h", ".txt"):
            assert (installed / "lagc" / path.relative_to(ROOT / "lagc")).is_file(), path


def test_two_builds_have_the_same_bytes(built: Path, tmp_path: Path) -> None:
    """Elsewhere, with other rights, times, locale and order of hashes; and from what the sdist holds."""
    other = checkout(tmp_path / "a longer name" / "of a folder")
    for path in [other, *other.rglob("*")]:
        path.chmod(0o700 if path.is_dir() else 0o600)
        os.utime(path, (1_000_000_000, 1_000_000_000))
    again = build(other, PYTHONHASHSEED="77", LC_ALL="C", TZ="Asia/Tokyo", LAGC_CACHE="")
    with tarfile.open(next(again.glob("*.tar.gz"))) as archive:
        archive.extractall(tmp_path, filter="data")
    third = build(next(tmp_path.glob("lagc-*")))
    for first in built.iterdir():
        assert {path.read_bytes() for path in (first, again / first.name, third / first.name)} == {
            first.read_bytes()
        }
    assert len(list(built.iterdir())) == 2


def test_the_sdist_holds_what_tests_and_licence_need(built: Path) -> None:
    with tarfile.open(next(built.glob("*.tar.gz"))) as archive:
        names = {name.partition("/")[2] for name in archive.getnames()}
        owners = {(member.uid, member.gid, member.uname) for member in archive.getmembers()}
    assert {
        "LICENSE", "SECURITY.md", "requirements-dev.lock", "docs/how-to/embed-the-c.md", "tests/conftest.py",
    } <= names  # fmt: skip
    listed = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True)
    tracked = {name for name in listed.stdout.splitlines() if not name.startswith(".ci/")}
    assert tracked <= names and len(owners) == 1


def test_the_wheel_lists_what_it_holds_of_others(installed: Path) -> None:
    """A bill of materials in CycloneDX (PEP 770) with the bundles of the page and the headers of FMI."""
    (folder,) = installed.glob("lagc-*.dist-info")
    bill = json.loads((folder / "sboms" / "lagc.cdx.json").read_text(encoding="utf-8"))
    assert (bill["bomFormat"], bill["specVersion"]) == ("CycloneDX", "1.6")
    parts = {(part["name"], part["version"]): part for part in bill["components"]}
    wanted = json.loads((ROOT / "web" / "package.json").read_text(encoding="utf-8"))["dependencies"]
    assert {*wanted.items(), ("fmi-standard", "2.0"), ("fmi-standard", "3.0")} == parts.keys()
    refs = {part["bom-ref"] for part in (bill["metadata"]["component"], *bill["components"])}
    assert {entry["ref"] for entry in bill["dependencies"]} == refs and len(refs) == len(parts) + 1
    assert all(part["purl"].startswith("pkg:") and part["licenses"] for part in parts.values())
    assert f"{folder.name}/sboms/lagc.cdx.json" in (folder / "RECORD").read_text()


def test_the_wheel_holds_its_licence_and_bounds(installed: Path) -> None:
    (folder,) = installed.glob("lagc-*.dist-info")
    assert (folder / "licenses" / "LICENSE").read_text() == (ROOT / "LICENSE").read_text()
    text = (folder / "METADATA").read_text(encoding="utf-8")
    assert "License-Expression: MIT" in text and "Requires-Dist: numpy<3,>=" in text
    assert str(ROOT) not in text
