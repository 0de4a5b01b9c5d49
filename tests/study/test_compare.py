"""Scenes side by side: differences against closed forms."""

import json
from math import cos, pi
from pathlib import Path

import pytest

from lagc.cli.main import main

SPRING = """model Spring
  coordinate Length x(start = 1 [m]);
  body b = Particle(mass = 1 [kg], at = {x, 0, 0});
  potential V = 1/2*1 [N/m]*x^2;
  effect push
    parameter Force f = 0.25;
    force one = {f, 0, 0} at b;
  end push;
  scene free;
  scene pushed uses push;
end Spring;
"""


@pytest.fixture
def model(tmp_path: Path) -> str:
    path = tmp_path / "spring.lag"
    path.write_text(SPRING)
    return str(path)


def test_the_difference_is_that_of_the_closed_form(model: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["compare", model, "--stop", str(pi), "--accuracy", "1e-9", "--json", "-p", "f=0.1"]) == 0
    found = json.loads(capsys.readouterr().out)
    free, pushed = found["scenes"]
    assert [free["scene"], pushed["scene"]] == ["free", "pushed"]
    assert free["differences"]["x"] == 0.0
    assert pushed["differences"]["x"] == pytest.approx(0.1 * (1.0 - cos(pi)) / 2.0, rel=1e-7)
    assert found["compared"] == ["x"]


def test_scenes_are_chosen_and_drawn(model: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("matplotlib")
    svg = tmp_path / "a.svg"
    arguments = ["--scene", "pushed", "--scene", "free", "--stop", "1", "--plot", str(svg)]
    assert main(["compare", model, *arguments]) == 0
    shown = capsys.readouterr().out
    assert shown.index("pushed") < shown.index("free") and "Largest difference from `pushed`" in shown
    assert svg.read_text().startswith("<?xml")


def test_an_interrupted_comparison_shows_what_ran(
    model: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    from lagc.api import CompiledModel
    from lagc.cli.output import INTERRUPTED

    own, scenes = CompiledModel.simulate, []

    def once(self: CompiledModel, *given: object, **more: object) -> object:
        scenes.append(self.interface.scene)
        if len(scenes) == 2:
            raise KeyboardInterrupt
        return own(self, *given, **more)  # type: ignore[arg-type]

    monkeypatch.setattr(CompiledModel, "simulate", once)
    assert main(["compare", model, "--stop", "1", "--json"]) == INTERRUPTED
    found = json.loads(capsys.readouterr().out)
    assert found["status"] == "interrupted" and [s["scene"] for s in found["scenes"]] == ["free"]


@pytest.mark.parametrize(
    "arguments", [["--scene", "nope"], ["-p", "zz=1"], ["--start", "y=1"], ["--plot", "a.txt"]]
)
def test_wrong_arguments(model: str, arguments: list[str]) -> None:
    assert main(["compare", model, *arguments, "--quiet"]) != 0
