"""The price of accuracy: errors against closed forms, laws against made points, and the reports."""

import json
from contextlib import nullcontext
from math import cos, sqrt
from pathlib import Path
from time import perf_counter, sleep
from typing import Any

import pytest

import lagc
from lagc.cli.main import main
from lagc.diagnostics.faults import Refused
from lagc.kernels import METHODS
from lagc.kernels.integrators.tableaus import adapts
from lagc.simulation.backends.compile import CannotCompile
from tests.simulation.programs import needs_compiler

np = pytest.importorskip("numpy")

from lagc.study import cost  # noqa: E402
from lagc.study.advice import Point, advise, fitted  # noqa: E402
from lagc.study.cost import Study, errors_of, scales_of  # noqa: E402
from lagc.study.probe import Late, Probe, Setting, Shot  # noqa: E402

SPRING = """\
model Spring
  parameter Mass m = 2 [kg];
  parameter Stiffness k = 8 [N/m];
  coordinate Length x(start = 0.5 [m]);
  body b = Particle(mass = m, at = {x, 0, 0});
  potential V = 1/2*k*x^2;
  output Energy E = energy();
  scene s
    simulate(stop = 4 [s]);
  end s;
end Spring;
"""


def point(method: str, size: float, error: float, seconds: float) -> Point:
    setting = Setting(method, step=size) if method == "rk4" else Setting(method, rtol=size)
    return Point(setting, np.array([error]), 1, 1, 0, seconds)


def made(factor: float, power: float, order: int, method: str = "dop853") -> list[Point]:
    sizes = [10.0 ** (-0.5 * k) for k in range(2, 28)]
    return [point(method, s, factor * s**power, 1e-5 * s ** (-power / order)) for s in sizes]


def test_a_law_is_found_again_and_its_setting_meets_the_target() -> None:
    points = made(30.0, 1.02, 8)
    law = fitted(points, 1e-17)
    assert law is not None
    assert (law.factor, law.power, law.scatter) == pytest.approx((30.0, 1.02, 1.0), rel=1e-9)
    for target in (1e-3, 1e-6, 1e-9):
        advice = advise(points, {"dop853": law}, target)
        assert advice.setting is not None and advice.digit is not None
        assert 30.0 * advice.setting.rtol**1.02 == pytest.approx(target, rel=1e-9)
        assert advice.digit == pytest.approx(10 ** (1 / 8) - 1, rel=1e-6)


def test_scatter_makes_a_setting_finer() -> None:
    """Errors jump between a third and three times the law: the setting is finer than that of the law."""
    points = made(1.0, 1.0, 8)
    for k, p in enumerate(points):
        p.errors *= 3.0 if k % 2 else 1 / 3.0
    law = fitted(points, 1e-17)
    assert law is not None and 2.0 < law.scatter < 4.0
    assert law.size_for(1e-6) < 0.5e-6


class Straight:
    """A probe whose error is `factor` times the tolerance."""

    def __init__(self, factor: float):
        self.factor = factor

    def run(self, setting: Setting, times: object, repeats: int = 1) -> Shot:
        end = 1.0 + (self.factor * setting.rtol if setting.rtol > 1e-14 else 0.0)
        return Shot(np.array([[0.0], [end]]), np.zeros((2, 1)), 1, 1, 0, 1e-5, False)


def test_a_setting_is_corrected_until_it_meets_its_target_at_nearby_parameters() -> None:
    """The law says error = rtol; at nearby parameters it is three times that."""
    study = Study(("x",), 1.0, 2, 1)
    study.points = made(1.0, 1.0, 8)
    exact = Straight(1.0).run(Setting("dop853", rtol=1e-14), ())
    study.reference = cost.Reference(exact, np.array([1.0]), 0.0, 0.0, "")
    study.conclude()
    cost.look_nearby(study, Straight(1.0), lambda k: Straight(3.0), (0.0, 1.0), float("inf"))  # type: ignore[arg-type, return-value]
    study.conclude()
    for advice in study.advice[:3]:
        assert advice.setting is not None and (advice.met, advice.tried) == (20, 20)
        assert 0.2 * advice.target < advice.setting.rtol <= advice.target / 3.0


class Timed(Straight):
    """One that keeps its deadline."""

    deadline = float("inf")

    def run(self, setting: Setting, times: object, repeats: int = 1) -> Shot:
        if perf_counter() > self.deadline:
            raise Late
        return super().run(setting, times, repeats)


def test_settings_are_measured_after_a_compilation_that_took_longer_than_the_budget() -> None:
    def verify(accuracy: float) -> Any:
        raise AssertionError("there is no time left")

    study = Study(("x",), 1.0, 2, 1)
    study.began, study.budget = perf_counter() - 100.0, 0.2
    cost.study(
        lambda real, flags: Timed(1.0),  # type: ignore[arg-type, return-value]
        verify, lambda values: np.array([1.0]), lambda k: None, study, (0.0, 1.0), lambda share, words: None,
    )  # fmt: skip
    assert study.complete and not study.notes
    assert study.points and study.laws and study.advice


def test_the_cheapest_method_is_taken_and_what_cannot_be_reached_is_told() -> None:
    slow = made(1.0, 1.0, 3, "bs32")
    fast = made(1.0, 1.0, 8)
    laws = {"bs32": fitted(slow, 1e-17), "dop853": fitted(fast, 1e-17)}
    advice = advise([*slow, *fast], laws, 1e-9)  # type: ignore[arg-type]
    assert advice.setting is not None and advice.setting.method == "dop853"
    assert advise(slow[:6], {"bs32": fitted(slow[:6], 1e-17)}, 1e-12).setting is None  # type: ignore[dict-item]


def test_errors_that_do_not_follow_the_tolerance_make_no_law() -> None:
    assert fitted([point("dop853", 10.0**-k, 1e-4, 1.0) for k in range(3, 12)], 1e-17) is None
    assert fitted(made(1.0, 1.0, 8)[:3], 1e-17) is None


def test_the_front_is_what_nothing_beats() -> None:
    study = Study(("x",), 1.0, 2, 1)
    study.points = [
        point("dop853", 1.0, e, s) for e, s in ((1e-2, 1.0), (1e-3, 2.0), (1e-1, 1.5), (1e-3, 3.0))
    ]
    assert [(p.error, p.seconds) for p in study.front] == [(1e-2, 1.0), (1e-3, 2.0)]


def test_the_time_of_a_point_is_the_least_and_its_scatter_the_median_above_it() -> None:
    measured = point("dop853", 1e-6, 1e-6, 9.0)
    assert (measured.seconds, measured.spread) == (9.0, 0.0)
    measured.times = [1.2, 1.0, 1.1, 5.0, 1.1]
    assert measured.seconds == 1.0 and measured.spread == pytest.approx(0.1)


def test_every_method_is_tried_with_tolerances_or_steps() -> None:
    pilot = Shot(np.zeros((1, 1)), np.zeros((1, 1)), 0, 100, 0, 0.0, False)
    tried = list(cost.settings(pilot, 10.0))
    assert {s.method for s in tried} == set(METHODS)
    assert all((s.rtol > 0.0) == adapts(s.method) != (s.step > 0.0) for s in tried)


@needs_compiler
@pytest.mark.full
def test_a_limit_of_time_ends_a_study_with_the_code_of_limits(tmp_path: Path) -> None:
    (tmp_path / "spring.lag").write_text(SPRING)
    assert main(["cost", str(tmp_path / "spring.lag"), "--max-time", "1.5 s", "-q"]) == 4


@needs_compiler
@pytest.mark.full
def test_the_budget_contains_the_time_of_compiling(monkeypatch: pytest.MonkeyPatch) -> None:
    """A model that takes longer to compile than its budget gets the least study: no verified runs."""
    from lagc.compiler import pipeline

    own = pipeline.render

    def slow(*given: object, **named: object) -> object:
        sleep(0.6)
        return own(*given, **named)  # type: ignore[arg-type]

    monkeypatch.setattr(pipeline, "render", slow)
    study = lagc.loads(SPRING).compile(backend="c").cost(points=21, budget=0.5)
    assert study.points and not study.verified and study.spent > 0.6


def test_scales_are_ranges_or_sizes_of_terms() -> None:
    values = np.array([[1.0, 5.0, 0.0, np.nan], [3.0, 5.0 + 1e-15, 0.0, 1.0]])
    assert list(scales_of(values, np.array([3.0, 5.0, 20.0, 1.0]))) == [2.0, 5.0, 20.0, 0.0]


@needs_compiler
@pytest.mark.full
@pytest.mark.parametrize("real", ["double", "quad"])
def test_a_probe_follows_a_closed_form(real: str) -> None:
    """x = 0.5 cos(2 t); quad to the spacing of the doubles that the times are."""
    from lagc.compiler import pipeline

    model = lagc.loads(SPRING).compile()
    program = pipeline.delivered(model.compilation)
    sources = pipeline.render(program, "c", real=real)
    probe = Probe(sources, program.interface, [2.0, 8.0], [0.5, 0.0], real)
    times = [0.25 * k for k in range(17)]
    shot = probe.run(Setting("dop853", rtol=1e-20 if real == "quad" else 1e-13), times, 2)
    exact = np.array([[0.5 * cos(2 * t)] for t in times])
    assert np.abs(shot.hi[:, :1] - exact).max() < (2e-16 if real == "quad" else 1e-12)
    assert np.abs(shot.hi[:, 2] - 1.0).max() < 1e-12 and shot.steps > 10 and shot.seconds > 0.0
    if real == "quad":  # energy is kept to more digits than a double has
        assert 0.0 < np.abs((shot.hi[:, 2] - 1.0) + shot.lo[:, 2]).max() < 1e-18


@needs_compiler
@pytest.mark.full
def test_a_run_in_slices_is_the_same_and_ends_at_its_deadline(monkeypatch: pytest.MonkeyPatch) -> None:
    """Between slices it looks at the clock and listens to signals; the numbers are those of one call."""
    from lagc.compiler import pipeline

    model = lagc.loads(SPRING).compile()
    program = pipeline.delivered(model.compilation)
    probe = Probe(pipeline.render(program, "c"), program.interface, [2.0, 8.0], [0.5, 0.0])
    setting, times = Setting("dop853", rtol=1e-10), [0.25 * k for k in range(17)]
    whole, looks = probe.run(setting, times), list[int]()
    monkeypatch.setattr(probe, "_slice", 1)
    monkeypatch.setattr(probe, "look", lambda: looks.append(1))
    parts = probe.run(setting, times)
    assert len(looks) >= whole.steps > 5
    assert np.array_equal(parts.hi, whole.hi) and np.array_equal(parts.lo, whole.lo)
    assert (parts.rhs, parts.steps, parts.rejected) == (whole.rhs, whole.steps, whole.rejected)
    monkeypatch.setattr("lagc.study.probe.perf_counter", lambda: float(len(looks)))
    monkeypatch.setattr(probe, "deadline", len(looks) + 2.5)
    before = len(looks)
    with pytest.raises(Late):
        probe.run(setting, times)
    assert len(looks) == before + 3


@pytest.mark.parametrize("over", [False, True])
def test_a_run_that_is_late_is_no_failure_of_its_setting(over: bool) -> None:
    """The deadline of corrections ends these, that of the study ends the study."""

    class Endless(Straight):
        deadline = float("-inf") if over else float("inf")

        def run(self, setting: Setting, times: object, repeats: int = 1) -> Shot:
            raise Late

    study = Study(("x",), 1.0, 2, 1)
    study.points = made(1.0, 1.0, 8)
    exact = Straight(1.0).run(Setting("dop853", rtol=1e-14), ())
    study.reference = cost.Reference(exact, np.array([1.0]), 0.0, 0.0, "")
    study.conclude()
    with pytest.raises(Late) if over else nullcontext():
        cost.look_nearby(study, Endless(1.0), lambda k: Straight(3.0), (0.0, 1.0), float("inf"))  # type: ignore[arg-type, return-value]
    assert not study.sizes


@needs_compiler
@pytest.mark.full
def test_a_study_of_a_spring() -> None:
    """Errors are those of the closed form; a recommended setting meets its target at nearby parameters."""
    model = lagc.loads(SPRING).compile(backend="c")
    study = model.cost(points=41, budget=6.0)
    assert study.complete and study.reference is not None and study.reference.agreement < 1e-15
    times = np.linspace(0, 4, 41)
    for p in study.points[::7]:
        words = {"step": p.setting.step} if p.setting.step else {"rtol": p.setting.rtol}
        run = model.simulate(4, method=p.setting.method, points=41, **words)
        error = np.abs(run["x"] - 0.5 * np.cos(2 * times)).max() / (0.5 - min(0.5 * np.cos(2 * times)))
        assert p.errors[0] == pytest.approx(error, rel=0.05, abs=1e-14)
    for (
        method,
        law,
    ) in study.laws.items():  # the error per unit step of an embedded method goes as its tolerance
        assert 0.7 < law.power < (4.6 if method == "rk4" else 1.35)
    met = 0
    for advice in study.advice[:3]:
        assert advice.setting is not None
        words = {"step": advice.setting.step} if advice.setting.step else {"rtol": advice.setting.rtol}
        for k in (7.0, 7.5, 8.5, 9.0):
            run = model.simulate(4, method=advice.setting.method, points=41, parameters={"k": k}, **words)
            exact = 0.5 * np.cos(sqrt(k / 2) * times)
            met += np.abs(run["x"] - exact).max() / np.ptp(exact) < advice.target
    assert met >= 10  # of 12


@needs_compiler
@pytest.mark.full
def test_the_report_in_all_its_forms(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("matplotlib")
    (tmp_path / "spring.lag").write_text(SPRING)
    outputs = [str(tmp_path / name) for name in ("c.html", "c.json", "c.png", "c.svg")]
    words = [w for path in outputs for w in ("-o", path)]
    assert main(["cost", str(tmp_path / "spring.lag"), "--points", "21", "--budget", "3", *words]) == 0
    said = capsys.readouterr().out
    assert "one digit more" in said and "the front" in said and "quad" in said
    found = json.loads(Path(outputs[1]).read_text())
    assert {p["method"] for p in found["points"]} == set(METHODS)
    assert found["quantities"] == ["x", "der(x)", "E"] and len(found["advice"]) == 4
    page = Path(outputs[0]).read_text()
    assert page.startswith("<!DOCTYPE html>") and "<svg" in page and "http" not in page.split("<svg")[0]
    assert Path(outputs[2]).read_bytes()[1:4] == b"PNG" and "<svg" in Path(outputs[3]).read_text()


@needs_compiler
@pytest.mark.full
def test_an_interruption_keeps_what_was_measured() -> None:
    def progress(part: float, doing: str) -> None:
        if doing.startswith("round 2"):
            raise KeyboardInterrupt

    study = lagc.loads(SPRING).compile().cost(points=21, budget=5.0, progress=progress)
    assert not study.complete and len(study.points) > 20 and study.advice and "interrupted" in study.notes[0]


@needs_compiler
@pytest.mark.full
def test_a_run_longer_than_the_budget_ends_the_study(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The exit code is that of a limit, not that of Ctrl-C."""

    def late(*given: object) -> None:
        raise Late("a run takes longer than the budget")

    monkeypatch.setattr(cost, "look_nearby", late)
    (tmp_path / "spring.lag").write_text(SPRING)
    assert main(["cost", str(tmp_path / "spring.lag"), "--points", "21", "--budget", "3", "-q"]) == 4
    assert "a run took too long: the results so far" in capsys.readouterr().out


@needs_compiler
@pytest.mark.full
def test_without_quadruple_precision_the_report_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    own = Probe.__init__

    def refuse(self: Probe, *given: object, **named: object) -> None:
        if "quad" in given:
            raise CannotCompile("no __float128")
        own(self, *given, **named)  # type: ignore[arg-type]

    monkeypatch.setattr(Probe, "__init__", refuse)
    study = lagc.loads(SPRING).compile().cost(points=21, budget=3.0)
    assert study.reference is not None and "double precision" in study.reference.words
    assert any("no quadruple precision" in note for note in study.notes)


def test_wrong_words_are_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "spring.lag").write_text(SPRING)
    for words, said in ((["-o", "x.txt"], "the ending gives the format"), (["--budget", "0"], "positive")):
        assert main(["cost", str(tmp_path / "spring.lag"), *words]) == 2
        assert said in capsys.readouterr().err
    with pytest.raises(Refused, match="LAG0604"):
        lagc.loads(SPRING).compile(backend="numpy").cost(points=1)


def test_errors_are_over_the_scale_of_each_quantity() -> None:
    zero = np.zeros((2, 2))
    exact = Shot(np.array([[0.0, 1.0], [2.0, 1.0]]), zero, 0, 0, 0, 0.0, False)
    other = Shot(np.array([[0.0, 1.0], [2.2, 1.5]]), zero, 0, 0, 0, 0.0, False)
    reference = cost.Reference(exact, np.array([2.0, 0.0]), 0.0, 0.0, "")
    assert list(errors_of(other.hi, other.lo, reference)) == pytest.approx([0.1, 0.0])
