"""The playground: lagc in Pyodide gives the bits of a native run, and its page does what it shows.

Needs Node and the packages of `tools/playground` (`npm ci`); the page needs Chromium."""

import json
import shutil
import subprocess
from pathlib import Path
from typing import Any
from zipfile import ZipFile

import pytest

import lagc
from tools.playground.__main__ import HERE, build, members

MODELS = ("double_pendulum", "simple_pendulum", "four_bar", "bouncing_ball", "heavy_top_quaternion")


def node(*arguments: str | Path) -> str:
    if shutil.which("node") is None or not (HERE / "node_modules" / "pyodide").exists():
        pytest.skip("there is no Node with Pyodide: `npm ci` in tools/playground/")
    done = subprocess.run(["node", *arguments], capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stderr[-3000:]
    return done.stdout


@pytest.fixture(scope="module")
def answers(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    path = tmp_path_factory.mktemp("playground") / "lagc.zip"
    with ZipFile(path, "w") as archive:
        for name, content in members():
            archive.writestr(name, content)
    found: dict[str, Any] = json.loads(
        node(Path(__file__).parent / "bits.mjs", path, HERE / "node_modules", *MODELS)
    )
    return found


@pytest.mark.full
@pytest.mark.parametrize("name", MODELS)
def test_runs_have_the_bits_of_native_ones(name: str, answers: dict[str, Any]) -> None:
    assert answers["found"][name] == lagc.load(name).compile(backend="numpy").simulate().states


@pytest.mark.full
def test_answers_of_the_worker(answers: dict[str, Any]) -> None:
    run = answers["run"]
    assert run["status"] == "ok" and run["page"] > 500_000 and run["scenes"] == ["chaotic", "small"]
    assert [s["name"] for s in run["sliders"]] == ["m1", "m2", "l1", "l2", "field.g"]
    assert len(run["latex"]) == 2 and all("&" not in row for row in run["latex"])
    assert answers["check"] == {"faults": []}
    quick, fixes, whole, refused = answers["wrong"]
    assert quick == whole == refused and quick["faults"][0]["remedy"]
    assert fixes["fixes"][0]["edits"][0][2].startswith("theta")
    assert "Particle" in answers["offers"] and "theta1" in answers["hover"]["text"]


@pytest.mark.long
def test_a_first_model_from_an_empty_page(tmp_path: Path) -> None:
    """From the folder itself, without a server: a model is typed, with faults, completion and a fix; runs;
    a slider, a link and Stop do what they say, at both widths."""
    browser = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
    if browser is None or not (HERE / "node_modules" / "playwright-core").exists():
        pytest.skip("there is no Chromium, or no playwright-core: `npm ci` in tools/playground/")
    build(tmp_path / "page")
    shown = node(
        Path(__file__).parent / "walk.mjs", browser, HERE / "node_modules", tmp_path / "page", tmp_path
    )
    assert shown.split()[-1] == "ok", shown
