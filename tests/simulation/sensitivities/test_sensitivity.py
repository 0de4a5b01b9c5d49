"""Sensitivities of runs: closed forms, motions under switches in 40 digits, differences of tight runs."""

import json
import pickle
import subprocess
import sys
import warnings
from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from math import cosh, exp, log, pi, sin, sqrt, tanh
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from mpmath import mp, mpf

import lagc
from lagc.api import Run
from lagc.cli.main import main
from lagc.diagnostics.faults import Refused
from lagc.semantics.units import quotient
from lagc.simulation.sensitivity import verified_sensitivities
from lagc.simulation.sensitivity.variational_equations import Followed
from lagc.simulation.sensitivity.verified_sensitivities import _doubts
from tests.simulation.events import switched

pytestmark = pytest.mark.usefixtures("own_cache")

DAMPED = """
model Damped "m x'' + c x' + k x = 0"
  parameter Mass m = 2 [kg];
  parameter Real k = 8; parameter Real c = 0.4; parameter Real unused = 1;
  coordinate Length x(start = 0.3 [m], rate = 0.5 [m/s]);
  body b = Particle(mass = m, at = {x, 0, 0});
  force f = {-k*x*1 [N/m] - c*der(x)*1 [N.s/m], 0, 0} at b;
  output Force pull = k*x*1 [N/m];
end Damped;
"""


@cache
def damped(backend: str) -> lagc.CompiledModel:
    return lagc.loads(DAMPED).compile(backend=backend)


def close(found: Any, expected: Any, accuracy: float) -> None:
    assert np.abs(found - np.array(expected)).max() <= accuracy * np.abs(expected).max(), (found, expected)


@pytest.mark.full
@pytest.mark.parametrize("backend", ["c", "numpy"])
def test_of_a_damped_oscillator(backend: str) -> None:
    """By differences of its closed form in 40 digits."""
    asked = ["m", "k", "c", "unused", "start(x)", "start(der(x))"]
    run = damped(backend).simulate(4, accuracy=1e-9, points=9, sensitivity=asked)
    assert run.status == "ok" and run.sensitivities is not None
    assert 0.0 < (run.sensitivities.estimated or 0.0) < 1e-9

    def x(t: float, m: Any, k: Any, c: Any, x0: Any, v0: Any) -> Any:
        a = c / (2 * m)
        w = mp.sqrt(k / m - a * a)
        return mp.exp(-a * t) * (x0 * mp.cos(w * t) + (v0 + a * x0) / w * mp.sin(w * t))

    values = [2.0, 8.0, 0.4, 0.3, 0.5]
    with mp.workdps(40):
        for k, name in enumerate(("m", "k", "c", "start(x)", "start(der(x))")):
            expected = [float(mp.diff(lambda *p, t=t: x(t, *p), values, tuple(int(i == k) for i in range(5))))
                        for t in run.t]  # fmt: skip
            close(run.sensitivity("x", name), expected, 1e-9)
            pull = 8.0 * np.array(expected) + (run["x"] if name == "k" else 0.0)
            close(run.sensitivity("pull", name), pull, 1e-8)
    assert not run.sensitivity("x", "unused").any()
    assert run.units["d(der(x))/d(m)"] == "m/(s.kg)" and run.units["d(pull)/d(start(x))"] == "N/m"


@pytest.mark.full
@pytest.mark.parametrize("backend", ["numpy", "c"])
@pytest.mark.parametrize("along", ["{0, 0, 1}", "{0.48, 0.64, 0.6}"])
def test_of_drag_by_the_norm_of_a_velocity_from_rest(backend: str, along: str) -> None:
    """norm(v)*v has the derivative 0 at v = 0. z = z0 - m/k log cosh(w t), w = sqrt(g k/m)."""
    text = f"""model Drag
      parameter Real[kg/m] k = 0.1;
      coordinate Length z(start = 10 [m]);
      body bob = Particle(mass = 1 [kg], at = z*{along});
      Gravity field(g = 9.81 [m/s2], direction = -{along});
      force drag = -k*norm(velocity(bob))*velocity(bob) at bob;
    end Drag;"""
    run = lagc.loads(text).compile(backend=backend).simulate(1, sensitivity="k")
    k, g, w = 0.1, 9.81, sqrt(0.981)
    exact = log(cosh(w)) / k**2 - g * tanh(w) / (2.0 * k * w)
    assert run.sensitivity("z", "k")[-1] == pytest.approx(exact, rel=1e-6)


@pytest.mark.full
def test_the_motion_is_what_it_is_without() -> None:
    plain, varied = (damped("c").simulate(4, accuracy=1e-9, sensitivity=asked) for asked in ((), "m"))
    assert plain.states == varied.states and plain.sensitivities is None
    assert set(varied.names) - set(plain.names) == {f"d({name})/d(m)" for name in plain.names}
    assert "sensitivity" not in plain.to_dict() and "sensitivity" in varied.to_dict()
    by_hand = damped("c").simulate(4, method="rk4", step=0.01, points=9, sensitivity="m")
    assert by_hand.status == "ok" and by_hand.sensitivities and by_hand.sensitivities.estimated is None
    fine = damped("c").simulate(4, accuracy=1e-9, points=9, sensitivity="m")
    close(by_hand.sensitivity("x", "m"), fine.sensitivity("x", "m"), 1e-6)


@pytest.mark.sample(0, 7)
@pytest.mark.parametrize("seed", range(16))
def test_of_motions_under_forces_that_jump(seed: int) -> None:
    """By both start values, against differences in 40 digits of parabolas, one after the other."""
    made = switched.case(seed)
    times = [float(t) for t in np.linspace(0.0, 1.5, 8)]
    beside: list[Any] = []
    with mp.workdps(switched.DIGITS):
        step = mpf(10) ** -12
        for way in ((step, 0), (-step, 0), (0, step), (0, -step)):
            moved = replace(made, x=mpf(made.x) + way[0], v=mpf(made.v) + way[1])  # type: ignore[arg-type]
            beside.append(switched.motion(moved, times))
        if any(motion is None for motion in beside):
            pytest.skip("a place of change is all but touched")
        truth = [[[float((p[i] - q[i]) / (2 * step)) for i in range(2)] for p, q in zip(*beside[k : k + 2])]
                 for k in (0, 2)]  # fmt: skip
    model = lagc.loads(made.text).compile(backend="numpy")
    run = model.simulate(1.5, accuracy=1e-8, points=8, sensitivity=["start(x)", "start(der(x))"])
    if run.status != "ok":
        assert "at one time" in run.message or "barely happens" in run.message
        return
    for k, name in enumerate(("start(x)", "start(der(x))")):
        for i, state in enumerate(("x", "der(x)")):
            expected = np.array(truth[k])
            far = np.abs(run.sensitivity(state, name) - expected[:, i]).max()
            assert far <= 1e-6 * max(1.0, np.abs(expected[:, i]).max())


@pytest.mark.full
def test_of_a_kick_whose_times_are_parameters_and_of_a_bounce() -> None:
    text = """model M
      parameter Time T = 0.4 [s]; parameter Time d = 0.1 [s]; parameter Force F = 3 [N];
      parameter Mass m = 2 [kg];
      coordinate Length x(start = 0 [m]);
      body b = Particle(mass = m, at = {x, 0, 0});
      force kick = {if time > T and time < T + d then F else 0 [N], 0, 0} at b;
    end M;"""
    run = lagc.loads(text).compile(backend="c").simulate(2, points=5, sensitivity=["T", "d", "F", "m"])
    t, width, f, m = 2.0, 0.1, 3.0, 2.0
    late = t - 0.4 - width
    expected = {
        "T": -f / m * width,
        "d": f / m * (late + width) - f / m * width,
        "F": (late + width / 2) * width / m,
    }
    expected["d"] = f / m * late
    expected["m"] = -expected["F"] * f / m
    assert {k: run.sensitivity("x", k)[-1] for k in expected} == pytest.approx(expected, rel=1e-9)
    ball = """model Ball
      parameter Real e = 0.8; parameter Acceleration g = 10 [m/s2]; parameter Length ground = 0.1 [m];
      coordinate Length y(start = 1.1 [m]);
      body b = Particle(mass = 1 [kg], at = {0, y, 0});
      force w = {0, -g*1 [kg], 0} at b;
      when y < ground then
        reinit(der(y), -e*der(y));
      end when;
    end Ball;"""
    system = lagc.loads(ball).compile(backend="c")
    run = system.simulate(0.9, points=4, sensitivity=["e", "g", "ground", "start(y)"])

    def height(e: Any, g: Any, ground: Any, y: Any) -> Any:
        fall = mp.sqrt(2 * (y - ground) / g)
        left = mpf(0.9) - fall
        return ground + e * g * fall * left - g * left**2 / 2

    with mp.workdps(30):
        values = [0.8, 10.0, 0.1, 1.1]
        slopes = [float(mp.diff(height, values, tuple(int(i == k) for i in range(4)))) for k in range(4)]
    found = [run.sensitivity("y", name)[-1] for name in ("e", "g", "ground", "start(y)")]
    assert found == pytest.approx(slopes, rel=1e-8)


@pytest.mark.full
def test_of_what_rests() -> None:
    """A pendulum that hangs still, pushed a little; one that stands, which takes its time to fall."""
    for angle, sign in ((0.0, -1.0), (pi, 1.0)):
        model = lagc.load("simple_pendulum").compile("vacuum", backend="numpy", parameters={"l": 0.5})
        run = model.simulate(2, accuracy=1e-8, points=5, starts={"theta": angle, "der(theta)": 0.0},
                             sensitivity=["start(theta)", "l"])  # fmt: skip
        assert run.status == "ok" and np.ptp(run["theta"]) == 0.0
        w = sqrt(9.81 / 0.5)
        expected = np.cos(w * run.t) if sign < 0.0 else np.cosh(w * run.t)
        close(run.sensitivity("theta", "start(theta)"), expected, 1e-7)
        assert np.abs(run.sensitivity("theta", "l")).max() <= 1e-12 * exp(2 * w)


CHECKED = [
    ("course/string_pendulum", 2.0), ("classic/four_bar", 1.0), ("classic/heavy_top", 1.0),
    ("classic/rolling_disc", 1.0), ("classic/sphere_on_turntable", 1.0),
    ("classic/chaplygin_sleigh", 1.0), ("classic/moving_rail", 1.0), ("classic/furuta_pendulum", 1.0),
    ("classic/kepler", 2.0), ("classic/double_pendulum", 1.0), ("classic/relativistic_particle", 1.0),
]  # fmt: skip
SHARE = 1e-3  # of a parameter: by how much differences differ


@pytest.mark.sample(0, 2)
@pytest.mark.parametrize("name, stop", CHECKED)
def test_of_the_library_by_differences(name: str, stop: float) -> None:
    """Of fourth order: what they leave out is (1e-3)^4 and less, with derivatives as large as themselves, and
    errors of 1e-11 in the runs become 1e-8."""
    model = lagc.load(name).compile(backend="c")
    fields = [f for f in model.interface.parameters if f.value]
    columns = [*model.state_names, *(o.name for o in model.interface.outputs)]
    run = model.simulate(stop, accuracy=1e-8, points=6, sensitivity=[f.name for f in fields])
    assert run.status == "ok", run.message
    scales = dict.fromkeys(model.state_names, 1.0)  # the ranges of nearly steady rolling are tiny
    for f in fields:
        assert f.value is not None
        step = SHARE * abs(f.value)
        one, two, three, four = (
            _table(
                model.simulate(
                    stop, accuracy=1e-11, points=6, parameters={f.name: f.value + k * step}, scales=scales
                ),
                columns,
            )
            for k in (-2, -1, 1, 2)
        )
        expected = (one - four + 8.0 * (three - two)) / (12.0 * step)
        found = np.array([run.sensitivity(column, f.name) for column in columns])
        sizes = np.abs(three).max(axis=1) / abs(f.value) + np.abs(expected).max(axis=1)
        assert (np.abs(found - expected).max(axis=1) <= 1e-6 * (sizes + 1e-3 * sizes.max())).all(), f.name


def _table(run: Run, columns: Sequence[str]) -> Any:
    assert run.status == "ok"
    return np.array([run[column] for column in columns])


def test_starts_follow_what_the_conditions_leave() -> None:
    """x is stated, z follows from x^2 + z^2 = l^2; its rate from that of x."""
    text = """model M
      parameter Length l = 0.5 [m]; parameter Length a = 0.3 [m];
      coordinate Length x(start = a, rate = 0.2 [m/s]), z;
      body b = Particle(mass = 1 [kg], at = {x, 0, z});
      force w = {0, 0, -9.81 [N]} at b;
      constraint string: x^2 + z^2 = l^2;
    end M;"""
    model = lagc.loads(text).compile(backend="numpy")
    run = model.simulate(0.0, sensitivity=["l", "a", "start(x)", "start(der(x))"])
    z = run["z"][0]
    assert abs(z) == pytest.approx(0.4)
    found = {
        name: [run.sensitivity(s, name)[0] for s in model.state_names] for name in ("l", "a", "start(der(x))")
    }
    v = -0.3 * 0.2 / z
    assert found["l"] == pytest.approx([0.0, 0.5 / z, 0.0, -v / z * 0.5 / z])
    by_a = -0.3 / z
    assert found["a"] == pytest.approx([1.0, by_a, 0.0, -0.2 / z - v / z * by_a])
    assert found["start(der(x))"] == pytest.approx([0.0, 0.0, 1.0, -0.3 / z])
    assert [run.sensitivity(s, "start(x)")[0] for s in model.state_names] == pytest.approx(found["a"])


@pytest.mark.full
def test_errors_are_estimated() -> None:
    """What the coarse run says of itself is not less than what it is off by."""
    for name, asked in (("simple_pendulum", "l"), ("classic/kepler", "a")):
        model = lagc.load(name).compile(backend="numpy")
        fine = model.simulate(1, accuracy=1e-10, points=20, sensitivity=asked)
        for accuracy in (1e-4, 1e-6):
            run = model.simulate(1, accuracy=accuracy, points=20, sensitivity=asked)
            assert run.sensitivities is not None and fine.sensitivities is not None
            estimated, worst = run.sensitivities.estimated or 0.0, 0.0
            for kind in set(model.interface.kinds):
                mask = np.array(model.interface.kinds) == kind
                one, two = (s.values[:, mask] for s in (run.sensitivities, fine.sensitivities))
                worst = max(worst, np.abs(one - two).max() / np.abs(two).max())
            assert worst <= estimated <= accuracy


@pytest.mark.parametrize(
    "asked, code", [("ll", "LAG0601"), ("x", "LAG0601"), ("start(y)", "LAG0606"), ("n", "LAG0607")]
)
def test_what_makes_no_sense_is_refused(asked: str, code: str) -> None:
    text = DAMPED.replace("parameter Real unused = 1;", "structural Integer n = 2; coordinate Length y[n];")
    model = lagc.loads(text).compile(backend="numpy")
    with pytest.raises(Refused) as refused:
        model.simulate(1, sensitivity=[asked, "m"])
    assert [fault.code for fault in refused.value.faults] == [code]


def test_where_there_are_none_the_reason_is_told() -> None:
    text = """model M
      parameter Length d = 0 [m];
      coordinate Length x(start = 1 [m], rate = -2 [m/s]);
      body b = Particle(mass = 1 [kg], at = {x, 0, 0});
      force f = {2 [N] + (if x > d then 0 [N] else 1 [N]), 0, 0} at b;
    end M;"""
    run = lagc.loads(text).compile(backend="numpy").simulate(2, points=5, sensitivity="start(x)")
    assert run.status == "ok" or "barely happens" in run.message
    held = "model M coordinate Length x(start = 1 [m]); body b = Particle(mass = 1 [kg], at = {x, 0, 0}); " \
           "force f = {-1 [N]*sqrt(x/(1 [m])), 0, 0} at b; constraint c: x = 1 [m]; end M;"  # fmt: skip
    run = lagc.loads(held).compile(backend="numpy").simulate(1, points=3, sensitivity="start(x)")
    assert run.status == "failed" and "the initial equations determine it" in run.message
    assert np.isnan(run.sensitivity("x", "start(x)")).all() and np.isfinite(run["x"]).all()


def test_on_the_command_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file, table = tmp_path / "m.lag", tmp_path / "run.csv"
    file.write_text(DAMPED)
    arguments = ["sim", str(file), "--stop", "1", "--points", "3", "--backend", "numpy", "--units"]
    assert main([*arguments, "--sensitivity", "m, start(x)", "-o", str(table), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["sensitivity"]["of"] == ["m", "start(x)"] and told["sensitivity"]["estimated"] < 1e-6
    assert {"d(x)/d(m)", "d(der(x))/d(start(x))", "d(pull)/d(m)"} <= set(told["final"])
    assert "d(x)/d(m) [m/kg],d(x)/d(start(x))," in table.read_text().splitlines()[0]
    assert main([*arguments, "--sensitivity", "m"]) == 0
    assert "sensitive to m: estimated" in capsys.readouterr().out
    assert main([*arguments, "--sensitivity", "mm"]) == 2


def test_who_does_not_ask_loads_nothing() -> None:
    code = (
        "import sys, lagc; lagc.load('simple_pendulum').compile(backend='numpy').simulate(0.1);"
        "assert not [m for m in sys.modules if m.startswith('lagc.simulation.sensitivity')]"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_units_over_units() -> None:
    for above, below, expected in (
        ("rad/s", "m", "rad/(s.m)"), ("J", "rad", "J/rad"), ("m", "m", ""), ("", "kg", "1/kg"),
        ("m/s", "", "m/s"),
        ("kg.m2/s2", "kg.m2", "1/s2"), ("N", "1/s", "N.s"), ("kg/(m.s)", "m/s2", "kg.s/m2"),
    ):  # fmt: skip
        assert quotient(above, below) == expected


def test_by_the_start_of_an_orientation() -> None:
    """The top spins about its third axis: turned a little about it, everything is."""
    model = lagc.load("classic/euler_top").compile(backend="numpy")
    run = model.simulate(1, points=3, sensitivity=["start(o.x)", "start(o.rate.z)"])
    assert run.status == "ok"
    q = np.array([run[f"o.{part}"] for part in "wxyz"])
    slopes = np.array([run.sensitivity(f"o.{part}", "start(o.x)") for part in "wxyz"])
    assert np.abs((q * slopes).sum(axis=0)).max() < 1e-9  # unit quaternions stay unit quaternions


@pytest.mark.full
def test_units_change_nothing() -> None:
    """By powers of two: the same steps, and the same bits."""
    found = []
    for length, mass in ((1.0, 1.0), (2.0**-60, 1.0), (2.0**60, 2.0**40)):
        text = f"""model S
          parameter Length l = {0.5 * length!r} [m];
          parameter Mass m = {2.0 * mass!r} [kg];
          parameter Real k = {8.0 * mass!r};
          coordinate Length x(start = {0.3 * length!r} [m]), y(start = {-0.1 * length!r} [m]);
          body b = Particle(mass = m, at = {{x, y, 0}});
          force f = {{-k*x*1 [N/m]*(1 + x^2/l^2), -k*1 [N/m]*abs(x), 0}} at b;
        end S;"""
        run = (
            lagc.loads(text)
            .compile(backend="numpy")
            .simulate(2, accuracy=1e-7, points=7, sensitivity=["l", "m", "k", "start(x)"])
        )
        assert run.status == "ok" and run.events and run.sensitivities is not None
        found.append(run.sensitivities.values / length * np.array([length, mass, mass, length]))
    assert (found[1] == found[0]).all() and (found[2] == found[0]).all()


def test_results_pickle_and_are_interrupted() -> None:
    run = damped("numpy").simulate(2, points=5, sensitivity=["k", "start(x)"])
    again = pickle.loads(pickle.dumps(run))
    assert (again["d(pull)/d(k)"] == run["d(pull)/d(k)"]).all()
    with pytest.raises(KeyError, match="did you mean"):
        run.sensitivity("x", "m")

    def progress(t: float) -> None:
        if begun and t > 1.0:
            raise KeyboardInterrupt
        begun.extend([t] if t >= 2.0 else [])

    begun: list[float] = []
    run = damped("numpy").simulate(2, method="dop853", points=5, sensitivity="k", progress=progress)
    assert run.interrupted and "interrupted" in run.message and len(run["x"]) == 5
    found = run.sensitivity("x", "k")
    assert np.isfinite(found[:2]).all() and np.isnan(found[-1])


TWO = """model M
  parameter Real a = 0, b = 0;
  coordinate Real x(start = -1, rate = 1 [1/s], fixed = true), y(start = -1, rate = 1 [1/s], fixed = true);
  body one = Particle(mass = 1 [kg], at = {x*1 [m], 0, 0});
  body other = Particle(mass = 1 [kg], at = {0, y*1 [m], 0});
  force f = {if x > a then 2 [N] else 0 [N], 0, 0} at one;
  force g = {0, if y > b then 2 [N] else 0 [N], 0} at other;
end M;"""


@pytest.mark.parametrize("name", ["a", "start(x)"])
def test_changes_at_one_time_that_part_have_no_derivative(name: str) -> None:
    """Also where what is varied is 0."""
    run = lagc.loads(TWO).compile(backend="numpy").simulate(2.0, sensitivity=[name])
    assert run.status == "failed" and "at one time here" in run.message


def test_a_missed_accuracy_is_told_in_digits_that_differ(monkeypatch: pytest.MonkeyPatch) -> None:
    """An estimate of 1.05e-6 is told as such where 1e-6 was asked for, not as 1e-6."""
    monkeypatch.setattr(
        verified_sensitivities, "_distance", lambda *_: 1.05e-6 / verified_sensitivities.SAFETY
    )
    run = lagc.loads(DAMPED).compile(backend="numpy").simulate(1.0, points=3, sensitivity=["k"])
    assert run.status == "failed" and "seems to be 1.05e-06, 1e-06 was asked for" in run.message


def test_what_one_direction_lacks_leaves_the_others() -> None:
    """x = w t - 1 + (t - 1/w)^2 behind the change, by w = 1 t + 2 (t - 1)."""
    text = TWO.replace("b = 0;", "b = 0, w = 1;").replace("rate = 1 [1/s]", "rate = w*1 [1/s]")
    run = lagc.loads(text).compile(backend="numpy").simulate(2.0, points=3, sensitivity=["a", "w"])
    assert run.status == "failed" and "`a`: at t = 1 s" in run.message and "`w`" not in run.message
    assert np.isnan(run.sensitivity("x", "a")[-1])
    assert run.sensitivity("x", "w") == pytest.approx([0.0, 1.0, 4.0], abs=1e-9)
    assert run.sensitivities is not None and run.sensitivities.estimated is not None


@pytest.mark.parametrize(
    ("condition", "name"), [("time > T*1 [s]", "T"), ("x > T", "T"), ("x > T", "start(x)")]
)
def test_a_start_on_a_change_has_none(condition: str, name: str) -> None:
    text = (
        "model M\n  parameter Real T = 0;\n  coordinate Real x(rate = 1 [1/s]);\n"
        "  body b = Particle(mass = 1 [kg], at = {x*1 [m], 0, 0});\n"
        f"  force f = {{if {condition} then 1 [N] else 0 [N], 0, 0}} at b;\nend M;"
    )
    run = lagc.loads(text).compile(backend="numpy").simulate(1.0, sensitivity=[name])
    assert run.status == "failed" and "at the initial state itself" in run.message


@pytest.mark.full
def test_many_quantities_are_told_in_time_in_proportion(monkeypatch: pytest.MonkeyPatch) -> None:
    """x = cos(w t) with w^2 = k; the unit of each is made once."""
    n, asked = 100, [0]

    def counted(above: str, below: str) -> str:
        asked[0] += 1
        return quotient(above, below)

    model = lagc.loads(
        f"""model W parameter Stiffness k = 1; coordinate Length x[{n}](each start = 1);
        for i in 1:{n} loop body b[i] = Particle(mass = 1, at = {{x[i], 0, 0}});
        force f[i] = {{-k*x[i], 0, 0}} at b[i]; end for; end W;"""
    )
    run = model.compile(backend="numpy").simulate(0.5, points=2, method="rk4", step=0.01, sensitivity="k")
    monkeypatch.setattr("lagc.simulation.sensitivity.sensitivities.quotient", counted)
    final = run.final
    assert len(final) == 4 * n and 0 < asked[0] <= 4 * len(final)
    assert final[f"d(x[{n}])/d(k)"] == pytest.approx(-0.25 * sin(0.5), rel=1e-6)


def test_what_has_no_value_anywhere_is_doubted_in_silence() -> None:
    """One kind of states has none, of the other the largest counts."""
    values = np.full((3, 2, 1), np.nan)
    values[:, 1] = 5.0
    done = SimpleNamespace(values=values, terms=np.array([[1.0], [3.0]]), rounding=np.full((2, 1), 1e-16))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert _doubts(cast(Followed, done), 1e-6, (0, 1)).tolist() == [
            pytest.approx([1e-6]),
            pytest.approx([5e-6]),
        ]


PANEL = """model Panel "of crossed rods, hung at a corner; nothing moves beside its places at the start"
  parameter Length d = 1 [m];
  coordinate Length x[4], z[4];
  point A = {x[1], 0, z[1]};
  point B = {d + x[2], 0, z[2]};
  point C = {d + x[3], 0, z[3] - d};
  point D = {x[4], 0, z[4] - d};
  body a = Particle(mass = 1 [kg], at = A);
  body b = Particle(mass = 1 [kg], at = B);
  body c = Particle(mass = 1 [kg], at = C);
  body e = Particle(mass = 1 [kg], at = D);
  constraint pin: A = {0, 0, 0};
  constraint ab: norm(A - B) = d;
  constraint bc: norm(B - C) = d;
  constraint cd: norm(C - D) = d;
  constraint da: norm(D - A) = d;
  constraint ac: norm(A - C) = sqrt(2)*d;
  constraint bd: norm(B - D) = sqrt(2)*d;
  Gravity field;
end Panel;
"""


@pytest.mark.full
def test_a_start_that_meets_redundant_rows_for_all_values_has_a_slope() -> None:
    """x = d f(t sqrt(g/d)), and so dx/dd = (x - t v/2)/d."""
    run = lagc.loads(PANEL).compile(backend="numpy").simulate(1.0, accuracy=1e-9, points=6, sensitivity="d")
    assert run.status == "ok", run.message
    expected = run["x[4]"] - np.asarray(run.t) * run["der(x[4])"] / 2.0
    close(run.sensitivity("x[4]", "d"), expected, 1e-8)


@pytest.mark.full
def test_an_exponent_has_a_slope_where_its_base_is_zero() -> None:
    """y'' = t^p: y = t^(p + 2)/((p + 1)(p + 2)), from where the base is 0."""
    text = """model Pow
      parameter Real p = 3;
      coordinate Length y;
      body b = Particle(mass = 1, at = {0, y, 0});
      force f = {0, 1 [N]*(time/(1 [s]))^p, 0} at b;
    end Pow;"""
    run = lagc.loads(text).compile(backend="numpy").simulate(2.0, points=2, sensitivity=["p"])
    assert run.status == "ok", run.message
    assert run.sensitivity("y", "p")[-1] == pytest.approx(-1.6 * (1 / 4 + 1 / 5 - log(2.0)), rel=1e-6)


def test_an_exponent_has_none_where_its_base_is_below_zero() -> None:
    text = """model Below
      parameter Real p = 3;
      coordinate Length y(start = -1 [m]);
      body b = Particle(mass = 1, at = {0, y, 0});
      force f = {0, -1 [N]*(y/(1 [m]))^p, 0} at b;
    end Below;"""
    run = lagc.loads(text).compile(backend="numpy").simulate(0.5, points=2, sensitivity=["p"])
    assert run.status == "failed" and "no finite value" in run.message
