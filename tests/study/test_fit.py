"""Fits: known values are found, intervals are those of the theory, and unseen parameters are named."""

import json
from math import cos, sin, sqrt
from pathlib import Path

import numpy as np
import pytest

import lagc
from lagc.api.fit import measured_values
from lagc.cli.main import main
from lagc.diagnostics.faults import Refused
from lagc.reports.fit import rounded, text
from lagc.simulation.request import Request
from lagc.study.fit import Fit, Measured, NotEvaluated, Parameter, fit

pytest.importorskip("scipy")
SPRING = """model Spring
  parameter Mass m(min = 0.1) = 1 [kg];
  parameter Real[N/m] k(min = 0) = 4;
  parameter Mass idle(min = 0) = 1 [kg];
  coordinate Length x(start = 1 [m]);
  body b = Particle(mass = m, at = {x, 0, 0});
  potential V = 1/2*k*x^2;
  output Length double = 2*x + 0*idle/1[kg]*1[m];
end Spring;
"""
T = np.linspace(0.0, 3.0, 41)


@pytest.fixture(scope="module")
def spring() -> lagc.CompiledModel:
    return lagc.loads(SPRING, "spring.lag").compile(backend="numpy")


def line(sigma: float, n: int, seed: int) -> tuple[list[Parameter], Measured]:
    """Values of y = 2 + 3 t with noise."""
    t = np.linspace(0.0, 1.0, n)
    noise = np.random.default_rng(seed).normal(size=n) * sigma
    return [Parameter("a", "m", 1.0), Parameter("b", "m/s", 1.0)], Measured(
        "y", "y", "m", t, 2 + 3 * t + noise
    )


def straight(t: np.ndarray):  # type: ignore[no-untyped-def]
    return lambda p: ([p[0] + p[1] * t], [np.column_stack([np.ones_like(t), t])])


def test_a_straight_line_has_the_intervals_of_the_textbook() -> None:
    """N. R. Draper, H. Smith, Applied Regression Analysis, 1998, section 1.4: var b = s^2/Sxx, var a = s^2
    sum t^2/(n Sxx)."""
    parameters, y = line(0.1, 12, 0)
    found = fit(parameters, [y], straight(y.times), 1e-9)
    b, a = np.polyfit(y.times, y.values, 1)
    r = y.values - a - b * y.times
    s2, sxx = r @ r / 10, float(((y.times - y.times.mean()) ** 2).sum())
    assert found.values == pytest.approx({"a": a, "b": b}, rel=1e-7)
    assert found.deviations["b"] == pytest.approx(sqrt(s2 / sxx), rel=1e-6)
    assert found.deviations["a"] == pytest.approx(sqrt(s2 * (y.times @ y.times) / (12 * sxx)), rel=1e-6)
    # Student's t for 10 degrees of freedom, 97.5 %: 2.228139 (table in the same book).
    assert found.intervals["b"] / found.deviations["b"] == pytest.approx(2.228139, abs=1e-6)
    assert found.freedom == 10 and found.converged and not found.unseen
    assert found.correlation[0, 1] == pytest.approx(-y.times.mean() / sqrt(y.times @ y.times / 12), rel=1e-9)


@pytest.mark.full
def test_intervals_contain_the_truth_as_often_as_they_say() -> None:
    """Of 400 samples 95 % +- 4 standard errors, which are 1.1 %."""
    inside = 0
    for seed in range(400):
        parameters, y = line(0.1, 8, seed)
        found = fit(parameters, [y], straight(y.times), 1e-9)
        inside += abs(found.values["b"] - 3.0) <= found.intervals["b"]
    assert abs(inside / 400 - 0.95) < 4.0 * sqrt(0.95 * 0.05 / 400)


def test_quantities_are_weighted_by_their_noise() -> None:
    """Two measurements of one value with noise of 1 and of 0.01: the second one decides."""
    rng = np.random.default_rng(1)
    t = np.linspace(0.0, 1.0, 50)
    y = [
        Measured(name, name, "", t, 5.0 + sigma * rng.normal(size=50))
        for name, sigma in (("a", 1.0), ("b", 0.01))
    ]
    one = [np.ones((50, 1))] * 2
    found = fit([Parameter("p", "", 1.0)], y, lambda p: ([np.full(50, p[0])] * 2, one), 1e-9)
    assert found.sigmas == pytest.approx({"a": 1.0, "b": 0.01}, rel=0.3)
    assert found.values["p"] == pytest.approx(float(y[1].values.mean()), abs=0.001)
    assert found.deviations["p"] == pytest.approx(0.01 / sqrt(50), rel=0.3)


def test_a_search_turns_back_where_there_is_no_motion() -> None:
    t = np.linspace(0.1, 1.0, 20)
    y = Measured("y", "y", "", t, np.sqrt(0.04 * t))
    parameter = Parameter("p", "", 3.0)

    def root(p):  # type: ignore[no-untyped-def]
        return None if p[0] <= 0.0 else ([np.sqrt(p[0] * t)], [(0.5 * np.sqrt(t / p[0]))[:, None]])

    assert fit([parameter], [y], root, 1e-9).values["p"] == pytest.approx(0.04, rel=1e-6)
    with pytest.raises(NotEvaluated):
        fit([Parameter("p", "", -1.0)], [y], root, 1e-9)


def test_a_value_stays_within_its_bounds() -> None:
    parameters, y = line(0.1, 12, 0)
    found = fit([parameters[0], Parameter("b", "m/s", 1.0, 0.0, 2.0)], [y], straight(y.times), 1e-9)
    assert found.values["b"] == pytest.approx(2.0, abs=1e-6)
    assert any("`b` is at its bound" in note for note in found.notes)


def measured(noise: float = 0.0, seed: int = 0) -> dict[str, np.ndarray]:
    """x = cos(w t) of a spring with k/m = 6, and its speed, in centimetres."""
    w, rng = sqrt(6.0), np.random.default_rng(seed)
    x = np.array([cos(w * t) for t in T]) + noise * rng.normal(size=len(T))
    speed = np.array([-w * sin(w * t) for t in T])
    return {"time": T, "place [cm]": 100.0 * x, "speed": speed}


@pytest.mark.full
def test_a_spring_is_found_from_its_motion(spring: lagc.CompiledModel) -> None:
    found = spring.fit(measured(0.01), ["k", "start(x)"], {"x": "place"})
    # Linear theory at the truth: d/dk cos(w t) = -t/(2 w) sin(w t) for m = 1, d/dx0 = cos(w t).
    w = sqrt(6.0)
    J = np.column_stack([-T / (2 * w) * np.sin(w * T), np.cos(w * T)])
    deviations = 0.01 * np.sqrt(np.diag(np.linalg.inv(J.T @ J)))
    for (name, truth), deviation in zip({"k": 6.0, "start(x)": 1.0}.items(), deviations):
        assert abs(found.values[name] - truth) < 4.0 * deviation
        assert found.deviations[name] == pytest.approx(deviation, rel=0.4)  # s of 39 degrees of freedom
    assert found.sigmas["x"] == pytest.approx(0.01, rel=0.4) and not found.notes
    assert found.run is not None and found.run.times[-1] == 3.0


def test_parameters_that_cannot_be_seen_are_named(spring: lagc.CompiledModel) -> None:
    found = spring.fit(
        measured(0.01), ["k", "m", "idle", "start(x)"], {"x": "place", "der(x)": "speed"}, rtol=1e-7
    )
    assert found.values["k"] / found.values["m"] == pytest.approx(6.0, rel=0.01)
    assert sorted(found.unseen) == [
        "`idle` cannot be seen: no measured value depends on it",
        "`k` and `m` cannot be separated: a change of `k` by +1 %, `m` by +1 % changes no measured value",
    ]
    assert [np.isinf(found.intervals[name]) for name in found.intervals] == [True, True, True, False]
    assert "not determined" in text(found, "Spring")


@pytest.mark.full
def test_residuals_that_follow_a_pattern_are_noted(spring: lagc.CompiledModel) -> None:
    """The drift of a sensor is no noise."""
    data = measured(0.001)
    data["place [cm]"] = data["place [cm]"] + 10.0 * T
    found = spring.fit(data, "k", {"x": "place"})
    assert any("follow a pattern" in note for note in found.notes)
    assert not spring.fit(measured(0.05), "k", {"x": "place"}).notes


@pytest.mark.parametrize(
    "vary, columns, code",
    [("q", {"x": "place"}, "LAG0601"), ("start(q)", {"x": "place"}, "LAG0606"),
     ("k", {"q": "place"}, "LAG0601"),
     ("k", {"x": "plac"}, "LAG0601"), ("k", {"x": "place[s]"}, "LAG0605"), ("k", {}, "LAG0601"),
     ((), {"x": "place"}, "LAG0601"), ("k", {"x": "place", "time": "clock"}, "LAG0601")],
)  # fmt: skip
def test_a_fit_that_is_wrong_is_refused(
    spring: lagc.CompiledModel, vary: str, columns: dict[str, str], code: str
) -> None:
    with pytest.raises(Refused) as refused:
        spring.fit(measured(), vary, columns)
    assert refused.value.code == code


def table(path: Path, text: str) -> str:
    path.write_text(text)
    return str(path)


@pytest.mark.parametrize(
    "text, said",
    [("t,x\n0,1\n\n1,abc\n", "line 4: the column `x` has 'abc'"),
     ("t,x\n0,\n1,\n", "data.csv`: the column `x`"),
     ("t;x\n0,5;1\n", "separate columns by commas"), ("t,x\n\n0\n", "line 3: 1 values for 2 columns")],
)  # fmt: skip
def test_a_file_that_is_wrong_is_named_with_its_line(tmp_path: Path, text: str, said: str) -> None:
    with pytest.raises(Refused) as refused:
        measured_values(table(tmp_path / "data.csv", text), {"x": "x"}, lambda _: "m")
    assert "data.csv" in str(refused.value) and said in str(refused.value)


@pytest.mark.full
def test_the_command_reads_units_and_gaps(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "spring.lag").write_text(SPRING)
    data, path = measured(0.01), tmp_path / "data.csv"
    rows = [f"{1e3 * t},{x},{'' if k % 5 else v}" for k, (t, x, v) in enumerate(zip(*data.values()))]
    path.write_text(
        "\ufeffclock [ms], place [cm], speed\n" + "\n".join(reversed(rows)) + "\n\n", encoding="utf-8"
    )
    words = ["fit", str(tmp_path / "spring.lag"), str(path), "-p", "k, start(x)", "time=clock", "x=place"]
    words += ["--backend", "numpy"]
    assert main([*words, "-p", "k=5,m=1", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    k, x = told["parameters"]
    assert k["name"] == "k" and k["begin"] == 5.0 and abs(k["value"] - 6.0) < 2.0 * k["interval"] < 0.2
    assert x["unit"] == "m" and told["residuals"][0]["points"] == 41
    assert main([*words, "der(x)=speed", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["residuals"][1]["points"] == 9
    assert "32 of 41 rows have no value of `speed` or no time" in told["notes"]
    assert main([*words, "-p", "m"]) == 3  # not determined
    assert "cannot be separated" in capsys.readouterr().out
    path.write_text("time,place\n0,1\n1,x\n")
    assert main(["fit", str(tmp_path / "spring.lag"), str(path), "-p", "k", "x=place"]) == 2
    assert "not a number" in capsys.readouterr().err
    path.write_text("time,place\n-1,1\n0,2\n")
    assert main(["fit", str(tmp_path / "spring.lag"), str(path), "-p", "k", "x=place"]) == 2
    assert "the column `time` has the time -1 s" in capsys.readouterr().err
    assert main(["fit", str(tmp_path / "spring.lag"), str(path), "-p", "k=5", "x=place"]) == 2
    assert "add `-p k`" in capsys.readouterr().err


@pytest.mark.full
def test_a_fit_is_drawn(spring: lagc.CompiledModel, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    from lagc.reports.plots.fit import draw

    found = spring.fit(measured(0.01), ["k"], {"x": "place", "der(x)": "speed"})
    figure = draw(found, "Spring")
    assert len(figure.axes) == 4
    (points,) = [entry for entry in figure.axes[1].lines if entry.get_marker() == "."]
    assert np.array_equal(points.get_ydata(), found.residuals["x"])


@pytest.mark.parametrize(
    "value, half, shown",
    [(0.620931, 0.00112, ("0.6209", "0.0011")), (12.3456, 0.55, ("12.35", "0.55")),
     (1234.5, 31.0, ("1234", "31")), (1234567.0, 3456.0, ("1.2346e+06", "3.5e+03")),
     (1.0, float("inf"), ("1", "not determined")), (3.0, 0.0, ("3", "0"))],
)  # fmt: skip
def test_a_value_has_the_digits_that_its_interval_leaves(
    value: float, half: float, shown: tuple[str, str]
) -> None:
    assert rounded(value, half) == shown


def test_few_values_have_no_interval() -> None:
    parameters, y = line(0.0, 2, 0)
    found = fit(parameters, [y], straight(y.times), 1e-9)
    assert found.freedom == 0 and all(np.isnan(half) for half in found.intervals.values())
    assert isinstance(found, Fit) and any("more measured values" in note for note in found.notes)


def test_recorded_times_are_those_of_the_data() -> None:
    found = Request(times=(0.3, 0.1, 0.3)).completed({"stop": 5.0, "points": 7.0})
    assert found.grid() == [0.0, 0.1, 0.3] and found.stop == 0.3 and found.points is None
    with pytest.raises(Refused, match="not negative"):
        Request(times=(-1.0, 1.0)).completed({})
