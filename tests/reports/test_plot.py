"""Pictures of runs."""

import math
import sys
from itertools import pairwise
from pathlib import Path

import pytest

import lagc
from lagc.api import Run
from lagc.base.records import replace
from lagc.reports.plots.curves import is_constant
from lagc.reports.plots.plot import by_unit, plot, plot_modes, show, solution_html, table
from tests.reports.models import MODELS

pytest.importorskip("matplotlib")


def run_of(name: str, stop: float = 1.0, **choice: str) -> Run:
    return (
        lagc.load(str(MODELS / f"{name}.lag"))
        .compile(backend="numpy", **choice)
        .simulate(stop=stop, points=51)
    )


@pytest.mark.sample(1)
@pytest.mark.parametrize(("ending", "start"), [("png", b"\x89PNG"), ("svg", b"<?xml"), ("pdf", b"%PDF")])
def test_the_ending_says_the_format(tmp_path: Path, ending: str, start: bytes) -> None:
    path = tmp_path / f"run.{ending}"
    plot(run_of("course/simple_pendulum"), path=str(path))
    assert path.read_bytes().startswith(start)


@pytest.mark.full
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
    assert is_constant([0.0, 1e-9], 1e-6)
    assert is_constant([0.0, 0.0])


def test_an_unknown_name_is_refused() -> None:
    with pytest.raises(KeyError, match="thetta"):
        plot(run_of("course/simple_pendulum"), names=["thetta"])


@pytest.mark.full
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


@pytest.mark.full
def test_a_run_in_a_notebook_is_its_picture() -> None:
    run = run_of("course/simple_pendulum")
    assert "<svg" in run._repr_html_()
    assert "theta" in table(run)


@pytest.mark.sample(1)
@pytest.mark.parametrize("backend", ["numpy", "c"])
def test_curves_bend_and_jump_at_events_that_are_not_recorded(backend: str) -> None:
    run = (
        lagc.load(str(MODELS / "contact/bouncing_ball.lag")).compile(backend=backend).simulate(1.8, points=20)
    )
    height, _, energy = (axis.lines[0].get_xydata() for axis in plot(run).axes)
    assert len(run.times) == 20 and len(height) == 20 + 2 * len(run.events)
    for event in run.events:
        there = [k for k, (t, _) in enumerate(height) if t == event.t]
        assert len(there) == 2 and all(abs(height[k][1]) < 1e-9 for k in there)
        before, behind = (energy[k][1] for k in there)
        assert behind == pytest.approx(0.64 * before, rel=1e-6)


def test_corners_are_the_same_in_c() -> None:
    system = lagc.load(str(MODELS / "contact/bouncing_ball.lag"))
    one, other = (system.compile(backend=name).simulate(rtol=1e-8) for name in ("numpy", "c"))
    assert one.corners and one.corners == other.corners


@pytest.mark.full
def test_no_corner_lies_behind_what_is_told() -> None:
    """The run ends where it can be foretold no longer."""
    run = (
        lagc.loads(
            "model S\n  coordinate Angle a(start = 2, rate = 1), b(start = 2);\n"
            "  point p = {sin(a), 0, -cos(a)}*1[m];\n  point q = p + {sin(b), 0, -cos(b)}*1[m];\n"
            "  body m = Particle(mass = 1 [kg], at = p);\n  body n = Particle(mass = 1 [kg], at = q);\n"
            "  force f = {-1e-3 [N]*max(0, sin(a)), 0, 0} at n;\n  Gravity field;\nend S;"
        )
        .compile(backend="numpy")
        .simulate(60.0)
    )
    assert run.status == "failed" and run.times[-1] < 60.0
    assert run.corners and run.corners[-1][0] <= run.times[-1] and run.events[-1].t <= run.times[-1]


def test_a_long_title_has_lines() -> None:
    run = run_of("course/simple_pendulum")
    run.status, run.message = "failed", "what is said of it " * 30
    figure = plot(run)
    figure.draw_without_rendering()
    assert figure.get_suptitle().count("\n") > 4
    assert figure._suptitle.get_window_extent().x1 < figure.bbox.x1


CART = """model Cart
  coordinate Length x;
  coordinate Angle a(start = 50 [deg]), b(start = -50 [deg]);
  body cart = Particle(mass = 2 [kg], at = {x, 0, 0});
  body left = Particle(mass = 0.3 [kg], at = {x + 0.7[m]*sin(a), 0, -0.7[m]*cos(a)});
  body right = Particle(mass = 0.1 [kg]*3, at = {x + 0.7[m]*sin(b), 0, -0.7[m]*cos(b)});
  Gravity field;
  output Momentum px = momentum().x;
end Cart;"""


@pytest.mark.parametrize("by_hand", [False, True])
def test_rounding_does_not_fill_an_axis(by_hand: bool) -> None:
    options = {"rtol": 1e-9} if by_hand else {}
    run = lagc.loads(CART).compile(backend="numpy").simulate(5.0, points=501, **options)
    assert 0.0 < max(abs(run["x"])) < 1e-10
    axes = {axis.get_ylabel(): axis for axis in plot(run).axes}
    assert axes["x [m]"].get_ylim() == (-1.0, 1.0)
    low, high = axes["px [kg.m/s]"].get_ylim()
    assert high - low > 0.1


def test_what_is_small_and_no_rounding_fills_its_axis() -> None:
    run = lagc.loads(CART.replace("start = 50", "start = 50.0001")).compile(backend="numpy").simulate(5.0)
    axis = next(axis for axis in plot(run).axes if axis.get_ylabel() == "x [m]")
    low, high = axis.get_ylim()
    assert high - low < 2.5 * max(abs(run["x"])) < 1e-4


@pytest.mark.full
@pytest.mark.parametrize("by_hand", [False, True])
def test_what_a_sensitivity_is_off_by_does_not_fill_an_axis(by_hand: bool) -> None:
    """The mass cancels; the energy changes with the length by m*g*cos(theta0), all the time."""
    options = {"rtol": 1e-8} if by_hand else {}
    model = lagc.load(str(MODELS / "course/simple_pendulum.lag")).compile(backend="numpy")
    run = model.simulate(10.0, sensitivity=["l", "m", "start(theta)"], **options)
    axes = {axis.get_ylabel().partition(" ")[0]: axis for axis in plot(run).axes}
    assert max(abs(run["d(theta)/d(m)"])) < 1e-12  # of which a machine may leave nothing
    assert axes["d(theta)/d(m)"].get_ylim() == (-1.0, 1.0)
    low, high = axes["d(theta)/d(l)"].get_ylim()
    assert high - low < 2.5 * 180.0 / math.pi * max(abs(run["d(theta)/d(l)"]))
    if not by_hand:
        low, high = axes["d(E)/d(l)"].get_ylim()
        assert low < -5.5 and high > -4.5
        assert not axes["d(E)/d(l)"].yaxis.get_major_formatter().get_useOffset()


@pytest.mark.full
def test_what_a_sensitivity_is_off_by_covers_what_it_is() -> None:
    """Rates and outputs have the doubts of what they are made of."""
    model = lagc.load(str(MODELS / "course/simple_pendulum.lag")).compile(backend="numpy")
    run = model.simulate(10.0, accuracy=1e-5, sensitivity=["l", "m"])
    exact = model.simulate(10.0, accuracy=1e-11, sensitivity=["l", "m"])
    assert run.sensitivities is not None
    for name in run.names:
        if name in run.sensitivities:
            size = max(abs(exact[name]))
            assert run.sensitivities.doubt(name) <= 2e-4 * size or size < 1e-12
    energy = run["d(E)/d(l)"]
    assert max(energy) - min(energy) <= 2.0 * run.sensitivities.doubt("d(E)/d(l)")


@pytest.mark.full
def test_many_panels_stand_in_columns() -> None:
    run = lagc.load(str(MODELS / "classic/gyroscope.lag")).compile(backend="numpy").simulate(
        0.05, points=11, sensitivity=["A1", "C", "m", "d", "field.g", "start(beta)"]
    )  # fmt: skip
    figure = plot(run)
    width, height = figure.get_size_inches()
    assert len(figure.axes) > 12 and 0.4 < width / height < 2.5
    named = [axis for axis in figure.axes if axis.get_xlabel()]
    assert len(named) == round(width / 8.0) and all(
        axis.xaxis.get_tick_params()["labelbottom"] for axis in named
    )


def test_many_orientations_share_an_axis() -> None:
    run = lagc.load(str(MODELS / "large/ball_chain.lag")).compile(backend="numpy", parameters={"n": 8})
    assert len(plot(run.simulate(0.01, points=3)).axes) == 3


@pytest.mark.full
def test_of_many_coordinates_every_second_is_named(tmp_path: Path) -> None:
    chain = lagc.load(str(MODELS / "classic/spring_chain.lag")).compile(parameters={"n": 50}, backend="numpy")
    figure = plot_modes(chain.linearize(), "modes")
    figure.draw_without_rendering()
    lowest = figure.axes[-1]
    boxes = [label.get_window_extent() for label in lowest.get_xticklabels()]
    assert len(boxes) == 25
    assert min(b.x1 - a.x1 for a, b in pairwise(boxes)) > lowest.get_xticklabels()[0].get_fontsize()


def test_errors_that_can_be_seen_are_shaded() -> None:
    run = lagc.load("simple_pendulum").compile(backend="numpy").simulate(2)
    for error, bands in ((1e-6, 0), (0.1, 1)):
        figure = plot(replace(run, error_bars=(error, error, 0.0), _columns={}))
        found = [band for axis in figure.axes for band in axis.collections]
        assert len(found) == bands
    (path,) = found[0].get_paths()
    high, low = path.vertices[:, 1].max(), path.vertices[:, 1].min()
    degrees = 180.0 / math.pi
    span = degrees * (max(run["theta"]) - min(run["theta"]))
    assert high - low == pytest.approx(span + 0.2 * degrees)
