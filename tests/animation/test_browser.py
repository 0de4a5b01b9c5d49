"""Pages in a real browser, and the bundle against its sources.  Needs Node, the packages of `web/` (`npm ci`)
and Chromium; each test is skipped by name without them."""

import shutil
import subprocess
from pathlib import Path

import pytest

import lagc
from tests.animation.test_page import EVIL

WEB = Path(__file__).resolve().parents[2] / "web"
PAGE = WEB.parent / "lagc" / "reports" / "animation" / "page"
MODELS = (
    "simple_pendulum", "double_pendulum", "four_bar", "slider_crank_joints", "heavy_top_quaternion",
    "rolling_disc", "tumbling_box", "newtons_cradle", "elastic_pendulum", "gyroscope_in_gimbals",
    "whipple_bicycle", "thermostat",
)  # fmt: skip

pytestmark = pytest.mark.long


def node(*arguments: str, cwd: Path = WEB) -> str:
    done = subprocess.run(["node", *arguments], cwd=cwd, capture_output=True, text=True, timeout=1800)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def browser() -> str:
    """The path of Chromium."""
    found = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    if found is None:
        pytest.skip("there is no Chromium")
    if shutil.which("node") is None or not (WEB / "node_modules" / "playwright-core").exists():
        pytest.skip("there is no Node with playwright-core: `npm ci` in web/")
    return found


def page(folder: Path, name: str, text: str | None = None) -> str:
    system = (lagc.load(name) if text is None else lagc.loads(text)).compile(backend="numpy")
    path = folder / f"{name}.html"
    system.simulate(method="dop853", rtol=1e-6).animate(str(path))
    return str(path)


@pytest.mark.parametrize("name", MODELS)
def test_a_page_says_nothing_and_asks_for_nothing(name: str, browser: str, tmp_path: Path) -> None:
    shown = node("test/check.mjs", browser, str(tmp_path), page(tmp_path, name))
    assert shown.count(": ok") == 4  # 1280 and 390 px, light and dark


def test_texts_of_a_model_do_not_run(browser: str, tmp_path: Path) -> None:
    shown = node("test/check.mjs", browser, str(tmp_path), page(tmp_path, "evil", EVIL))
    assert shown.count(": ok") == 4


@pytest.mark.parametrize("name", ["tumbling_box", "gyroscope_in_gimbals"])
def test_controls_of_a_page(name: str, browser: str, tmp_path: Path) -> None:
    assert "FAIL" not in node("test/interact.mjs", browser, page(tmp_path, name), str(tmp_path))


def test_the_bundle_is_that_of_its_sources(tmp_path: Path) -> None:
    """A fresh installation of the locked packages builds the same bytes."""
    if shutil.which("npm") is None:
        pytest.skip("there is no npm")
    copy = tmp_path / "web"
    shutil.copytree(WEB, copy, ignore=shutil.ignore_patterns("node_modules"))
    install = ["npm", "ci", "--ignore-scripts", "--no-audit", "--no-fund"]
    done = subprocess.run(install, cwd=copy, capture_output=True, text=True, timeout=600)
    if done.returncode:
        pytest.skip(f"npm cannot install the packages: {done.stderr.splitlines()[-1:]}")
    node("build.mjs", str(tmp_path / "built"), cwd=copy)
    for name in ("animate.min.js", "animate.min.css"):
        assert (tmp_path / "built" / name).read_bytes() == (PAGE / name).read_bytes()
