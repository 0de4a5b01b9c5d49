"""Pictures of runs."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

import lagc
from lagc.api import Run
from lagc.view.html import solution_html, table
from lagc.view.plot import by_unit, is_constant, plot, show
from tests.view.models import MODELS

pytest.importorskip("matplotlib")


def run_of(name: str, stop: float = 1.0, **choice: str) -> Run:
    return (
        lagc.load(str(MODELS / f"{name}.lag"))
        .compile(backend="numpy", **choice)
        .simulate(stop=stop, points=51)
    )


@pytest.mark.parametrize(("ending", "start"), [("png", b"\x89PNG"), ("svg", b"<?xml"), ("pdf", b"%PDF")])
def test_the_ending_says_the_format(tmp_path: Path, ending: str, start: bytes) -> None:
    path = tmp_path / f"run.{ending}"
    plot(run_of("course/simple_pendulum"), path=str(path))
    assert path.read_bytes().startswith(start)


def test_the_same_run_gives_the_same_file(tmp_path: Path) -> None:
    for name in ("a.svg", "b.svg"):
        plot(run_of("course/simple_pendulum"), path=str(tmp_path / name))
    assert (tmp_path / "a.svg").read_bytes() == (tmp_path / "b.svg").read_bytes()


def test_an_axis_a_unit_with_its_label() -> None:
    figure = plot(run_of("course/simple_pendulum"))
    assert [axis.get_ylabel() for axis in figure.axes] == ["theta [deg]", "E [J]"]
    assert figure.axes[-1].get_xlabel() == "time [s]"


def test_angles_are_in_degrees() -> None:
    figure = plot(run_of("course/simple_pendulum"), names=["theta"])
    assert figure.axes[0].lines[0].get_ydata()[0] == pytest.approx(60.0, rel=1e-12)


def test_rounding_of_a_conserved_energy_does_not_fill_its_axis() -> None:
    """The double pendulum starts with energy 0: what is left of it is beside kinetic energies."""
    run = run_of("classic/double_pendulum")
    axis = next(axis for axis in plot(run).axes if "J" in axis.get_ylabel())
    low, high = axis.get_ylim()
    assert high - low > 0.1


def test_parts_of_a_quaternion_share_an_axis() -> None:
    run = run_of("classic/euler_top", stop=0.1)
    assert by_unit(run, ["o.w", "o.x", "o.y", "o.z"]) == {"orientation o": ["o.w", "o.x", "o.y", "o.z"]}


def test_what_is_constant() -> None:
    assert is_constant([1.0, 1.0 + 1e-9])
    assert not is_constant([0.0, 1e-9])
    assert is_constant([0.0, 1e-9], size=1.0)
    assert is_constant([0.0, 0.0])


def test_an_unknown_name_is_refused() -> None:
    with pytest.raises(KeyError, match="thetta"):
        plot(run_of("course/simple_pendulum"), names=["thetta"])


def test_without_a_display_the_picture_lies_beside(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    run = run_of("course/simple_pendulum")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "platform", "linux")
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    path = show(run)
    assert path == "SimplePendulum_vacuum.png"
    assert (tmp_path / path).exists()


def test_without_matplotlib_the_fault_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    run = run_of("course/simple_pendulum")
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(ImportError, match=r"pip install matplotlib"):
        plot(run)
    assert solution_html(run) == table(run)


def test_a_run_in_a_notebook_is_its_picture() -> None:
    run = run_of("course/simple_pendulum")
    assert "<svg" in run._repr_html_()
    assert "theta" in table(run)
