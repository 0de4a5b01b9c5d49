"""The accuracy holds for each quantity by its own scale: closed forms and independent integrations."""

from collections.abc import Callable, Mapping
from math import cos, pi, sin, sqrt
from typing import TypeAlias

import mpmath
import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

import lagc
from lagc.api import Run
from lagc.diagnostics.faults import Refused
from tests.simulation.programs import BACKENDS

Array: TypeAlias = NDArray[np.float64]
Exact: TypeAlias = Mapping[str, Array]

FAST_SLOW = """\
model FastSlow "1000 Hz at a nanometre beside 1 Hz at a metre"
  parameter Mass m = 1 [kg];
  parameter Stiffness k = 40 [N/m], K = 4e7 [N/m];
  coordinate Length slow(start = 1 [m]), fast(start = 1e-9 [m]);
  body a = Particle(mass = m, at = {slow, 0, 0});
  body b = Particle(mass = m, at = {0, fast, 0});
  potential p = 1/2*k*slow^2 + 1/2*K*fast^2;
  output Length sum = slow + fast;
end FastSlow;
"""
TWO_SCALES = """\
model TwoScales "a satellite that carries a small oscillator"
  parameter Velocity V = 1e4 [m/s];
  coordinate Length x(rate = V), y(start = 0.01 [m]);
  body craft = Particle(mass = 1 [kg], at = {x, 0, 0});
  body bob = Particle(mass = 1 [kg], at = {0, y, 0});
  potential spring = 1/2*1 [N/m]*y^2 + 1/4*1e4 [N/m3]*y^4;
end TwoScales;
"""
WHEEL_NOD = """\
model WheelNod "a wheel that winds and a small nod: both are angles"
  coordinate Angle phi(rate = 1000 [rad/s]), nod(start = 0.001 [rad]);
  body rim = Particle(mass = 1 [kg], at = {cos(phi)*1 [m], sin(phi)*1 [m], 0});
  body flap = Particle(mass = 1 [kg], at = {5 [m] + 1 [m]*nod, 0, 0});
  potential soft = 1/2*1 [J]*nod^2 + 1/4*1e6 [J]*nod^4;
end WheelNod;
"""
TRAIN = """\
model Train "a pendulum in a train at 80 m/s"
  coordinate Length x(rate = 80 [m/s]), s(start = 0.02 [m]) "arc of the bob";
  body train = Particle(mass = 1e5 [kg], at = {x, 0, 0});
  body bob = Particle(mass = 0.1 [kg], at = {x + 0.1 [m]*sin(s/0.1 [m]), 0, -0.1 [m]*cos(s/0.1 [m])});
  potential weight = -0.1 [kg]*9.81 [m/s2]*0.1 [m]*cos(s/0.1 [m]);
  output Length swing = 0.1 [m]*sin(s/0.1 [m]);
end Train;
"""
TANDEM = """\
model Tandem "two satellites in one orbit: the distance is what one wants"
  coordinate Length x1(start = 7e6 [m]), y1(rate = 7546.05 [m/s]);
  coordinate Length x2(start = 7.000001e6 [m]), y2(rate = 7546.05 [m/s]);
  body one = Particle(mass = 1 [kg], at = {x1, y1, 0});
  body two = Particle(mass = 1 [kg], at = {x2, y2, 0});
  potential g1 = -3.986e14 [m3.kg/s2]/sqrt(x1^2 + y1^2);
  potential g2 = -3.986e14 [m3.kg/s2]/sqrt(x2^2 + y2^2);
  output Length d = sqrt((x1 - x2)^2 + (y1 - y2)^2);
end Tandem;
"""
OFFSET = """\
model Offset "a centimetre of motion about a place at 1e6 m"
  parameter Length d = 1e6 [m];
  coordinate Length x(start = d + 0.01 [m]);
  body a = Particle(mass = 1 [kg], at = {x, 0, 0});
  potential p = 1/2*1 [N/m]*(x - d)^2;
end Offset;
"""


def integrated(f: Callable[[float, Array], list[float]], x: list[float], t: Array) -> Array:
    found: Array = solve_ivp(f, (0.0, t[-1]), x, "DOP853", t, rtol=3e-14, atol=1e-17).y
    return found


def oscillator(cubic: float, start: float, t: Array) -> Array:
    """y'' = -y - cubic y^3, in units of `start`, so that nothing is small."""
    found: Array = start * integrated(
        lambda _, y: [y[1], -y[0] - cubic * start**2 * y[0] ** 3], [1.0, 0.0], t
    )
    return found


def fast_slow(t: Array) -> Exact:
    a, b = sqrt(40.0), sqrt(4e7)
    return {"slow": np.cos(a * t), "fast": 1e-9 * np.cos(b * t), "der(fast)": -1e-9 * b * np.sin(b * t)}


def two_scales(t: Array) -> Exact:
    y, v = oscillator(1e4, 0.01, t)
    return {"x": 1e4 * t, "y": y, "der(y)": v}


def wheel_nod(t: Array) -> Exact:
    nod, v = oscillator(1e6, 0.001, t)
    return {"phi": 1000.0 * t, "nod": nod, "der(nod)": v}


def train(t: Array) -> Exact:
    """In the frame that moves with 80 m/s."""
    total, m, length = 1e5 + 0.1, 0.1, 0.1

    def f(_: float, z: Array) -> list[float]:
        _, s, w, v = z
        c, n = cos(s / length), sin(s / length)
        a = m * n * (v * v / length + 9.81 * c) / (total - m * c * c)
        return [w, v, a, -9.81 * n - c * a]

    x, s, w, v = integrated(f, [0.0, 0.02, 0.0, 0.0], t)
    swing = length * np.sin(s / length)
    return {"x": 80.0 * t + x, "s": s, "der(x)": 80.0 + w, "der(s)": v, "swing": swing}


def eccentric(mean: mpmath.mpf, e: mpmath.mpf) -> mpmath.mpf:
    return mpmath.findroot(lambda u: u - e * mpmath.sin(u) - mean, mean)


def tandem(t: Array) -> Exact:
    """Kepler's ellipses, with 30 digits."""
    mu, places = mpmath.mpf("3.986e14"), []
    for r in (mpmath.mpf(7000000), mpmath.mpf(7000001)):
        v = mpmath.mpf(7546.05)
        a = 1 / (2 / r - v * v / mu)
        e = 1 - r / a  # from the apsis where it begins
        n, root = mpmath.sqrt(mu / a**3), mpmath.sqrt(1 - e * e)
        anomalies = [eccentric(n * mpmath.mpf(time), e) for time in t]
        places.append([(a * (mpmath.cos(u) - e), a * root * mpmath.sin(u)) for u in anomalies])
    apart = [float(mpmath.hypot(p[0] - q[0], p[1] - q[1])) for p, q in zip(*places)]
    return {"x1": np.array([float(x) for x, _ in places[0]]), "d": np.array(apart)}


MODELS: dict[str, tuple[str, Callable[[Array], Exact], float, float]] = {
    "wheel_nod": (WHEEL_NOD, wheel_nod, 10.0, 1e-6),
    "fast_slow": (FAST_SLOW, fast_slow, 0.2, 1e-9),  # to the time; the finest accuracy that is met
    "two_scales": (TWO_SCALES, two_scales, 20.0, 1e-6),
    "train": (TRAIN, train, 10.0, 1e-6),
    "tandem": (TANDEM, tandem, 3000.0, 1e-6),
}


def true_errors(run: Run, exact: Exact) -> dict[str, float]:
    """Largest errors over the range of each quantity."""
    n = len(run.t)
    return {
        name: float(np.abs(run[name] - known[:n]).max() / np.ptp(known))
        for name, known in exact.items()
        if not np.ptp(known) <= 1e-12 * np.abs(known).max()
    }


@pytest.mark.sample(3, 15)
@pytest.mark.parametrize("accuracy", [1e-3, 1e-6, 1e-9])
@pytest.mark.parametrize("name", MODELS)
def test_each_quantity_has_the_accuracy_or_is_named(name: str, accuracy: float) -> None:
    text, exact, stop, finest = MODELS[name]
    run = lagc.loads(text).compile(backend="numpy" if name != "fast_slow" else "c").simulate(
        stop, accuracy=accuracy, points=31
    )  # fmt: skip
    errors = true_errors(run, exact(run.t))
    if accuracy >= finest:
        assert run.status == "ok", run.message
    if run.status == "ok":
        small = " ".join([note for note in run.notes if "the accuracy of the own range" in note])
        errors = {name: error for name, error in errors.items() if f"`{name}`" not in small}
        assert all(error <= accuracy for error in errors.values()), errors
        assert run.estimated is not None and max(errors.values()) <= 1.5 * run.estimated + 1e-12
    else:
        assert "cannot be" in run.message


@BACKENDS
def test_a_motion_far_from_the_origin_is_named(backend: str) -> None:
    model = lagc.loads(OFFSET).compile(backend=backend)
    run = model.simulate(5, accuracy=1e-4, points=31)
    assert run.status == "ok", run.message
    assert np.abs(run["x"] - 1e6 - 0.01 * np.cos(run.t)).max() <= 1e-4 * 0.02
    assert run.scales["x"] == pytest.approx(0.02, rel=0.01)
    run = model.simulate(5, accuracy=1e-9, points=31)
    assert run.status == "failed"
    assert "`x` has the scale 0.02 m and terms of 1e+06 m" in run.message
    assert "Shift the origin" in run.message and "--scale 'x=1e+06'" in run.message
    given = model.simulate(5, accuracy=1e-9, points=31, scales={"x": 1e3, "der(x)": 1.0e3})
    assert given.status == "ok" and given.scales["x"] == 1e3


SPRING = """\
model Spring
  coordinate Length x(start = 0.5 [m]), y, z(start = 3 [m]);
  body b = Particle(mass = 2 [kg], at = {x, z, 0});
  body c = Particle(mass = 2 [kg], at = {0, y, 0});
  potential V = 4 [N/m]*(x^2 + y^2);
  output Energy E = energy();
  output Velocity v = der(x);
  output Length none = x - x*cos(0*time/1 [s]);
end Spring;
"""


@BACKENDS
@pytest.mark.parametrize("accuracy", [1e-3, 1e-7, 1e-11])
def test_errors_of_states_and_outputs(backend: str, accuracy: float) -> None:
    """Quantities that do not move fail no run: a note tells what their errors are relative to."""
    model = lagc.loads(SPRING).compile(backend=backend)
    run = model.simulate(5, accuracy=accuracy)
    assert run.status == "ok", run.message
    assert set(run.errors) == set(run.scales) == {
        *("x", "y", "z", "der(x)", "der(y)", "der(z)", "E", "v", "none")
    }  # fmt: skip
    (note,) = [note for note in run.notes if "constant" in note]
    assert "`E` (" in note and "`z` (3 m)" in note and "`x`" not in note and "`y`" not in note
    assert run.scales["x"] == pytest.approx(1.0, rel=1e-2) and run.scales["y"] == 0.0
    true = max(abs(x - 0.5 * cos(2 * t)) for t, x in zip(run.t, run["x"]))
    speed = max(abs(v + sin(2 * t)) for t, v in zip(run.t, run["v"]))
    assert true <= 1.5 * run.errors["x"] < 3 * accuracy and speed <= 1.5 * run.errors["v"] < 6 * accuracy
    assert run.errors["y"] < 1e-20
    again = lagc.loads(SPRING).compile(backend=backend).simulate(5, accuracy=accuracy)
    assert again.errors == run.errors and again.scales == run.scales  # also for a run that is remembered
    assert again.notes == run.notes
    found = run.to_dict()
    assert found["errors"] == run.errors and found["scales"] == run.scales


@BACKENDS
def test_recorded_times_that_meet_a_motion_at_one_phase_do_not_hide_its_range(backend: str) -> None:
    """Ten periods between any two points: a state has the range over the steps."""
    run = lagc.loads(SPRING).compile(backend=backend).simulate(20 * pi, accuracy=1e-6, points=3)
    assert run.status == "ok", run.message
    assert run.scales["x"] == pytest.approx(1.0, rel=1e-3) and run.scales["v"] == pytest.approx(2.0, rel=0.1)
    assert len(run.t) == 3 and abs(run["x"][-1] - 0.5) <= 1e-6


def test_runs_that_are_not_verified_have_no_errors() -> None:
    run = lagc.loads(SPRING).compile(backend="numpy").simulate(1, rtol=1e-6)
    assert run.errors == run.scales == {}


@pytest.mark.parametrize("start", [0.0, pi])
def test_a_pendulum_at_rest_names_nothing(start: float) -> None:
    run = lagc.load("simple_pendulum").compile(backend="numpy").simulate(1, starts={"theta": start})
    assert not [note for note in run.notes if "constant" in note]


def test_scales_that_are_given_count() -> None:
    """A loose scale asks for less, a strict one for more."""
    model = lagc.loads(SPRING).compile(backend="numpy")
    steps = []
    for scale in (100.0, 1.0, 1e-3):
        run = model.simulate(5, accuracy=1e-8, points=31, scales={"x": scale, "der(x)": scale, "v": scale})
        assert run.status == "ok"
        assert max(abs(x - 0.5 * cos(2 * t)) for t, x in zip(run.t, run["x"])) <= 1e-8 * scale
        steps.append(run.cost.rhs)
    assert steps[0] < steps[2]


SCALED = """\
model Scaled
  parameter Length L = 1 [m];
  coordinate Length x(start = 0.5 [m], scale = 2 [mm]), y[2](scale = 1 [mm]);
  body b = Particle(mass = 2 [kg], at = {x, y[1], y[2]});
  potential V = 4 [N/m]*(x^2 + y[1]^2 + y[2]^2);
  output Velocity v(scale = 3 [m/s], displayUnit = "km/h") = der(x);
end Scaled;
"""


def test_scales_in_the_model() -> None:
    model = lagc.loads(SCALED).compile(backend="numpy")
    run = model.simulate(1)
    assert {name: run.scales[name] for name in ("x", "y[1]", "y[2]", "v")} == {
        "x": 0.002, "y[1]": 0.001, "y[2]": 0.001, "v": 3.0,
    }  # fmt: skip
    assert model.simulate(1, scales={"x": 7.0}).scales["x"] == 7.0
    assert model.simulate(1, rtol=1e-6).status == "ok"


@pytest.mark.parametrize(
    ("written", "code"),
    [
        ("scale = 0", "LAG0208"),
        ("scale = -1 [m]", "LAG0208"),
        ("scale = 2*L", "LAG0208"),
        ("scale = 2 [s]", "LAG0302"),
    ],
)
def test_scales_in_a_model_that_are_refused(written: str, code: str) -> None:
    faults = lagc.loads(SCALED.replace("scale = 2 [mm]", written)).check()
    assert [fault.code for fault in faults if fault.severity == "error"] == [code]


@pytest.mark.parametrize(
    ("scales", "code"),
    [
        ({"w": 1.0}, "LAG0601"),
        ({"x": 0.0}, "LAG0602"),
        ({"x": -1.0}, "LAG0602"),
        ({"x": float("inf")}, "LAG0602"),
    ],
)
def test_scales_that_are_refused(scales: dict[str, float], code: str) -> None:
    with pytest.raises(Refused) as refused:
        lagc.loads(SPRING).compile(backend="numpy").simulate(1, scales=scales)
    assert [fault.code for fault in refused.value.faults] == [code]


def test_a_scale_without_an_accuracy_is_refused() -> None:
    with pytest.raises(Refused, match="belongs to an accuracy"):
        lagc.loads(SPRING).compile(backend="numpy").simulate(1, rtol=1e-6, scales={"x": 1.0})


STEEP = """\
model Steep "outputs that peak between two looks or at the end, and a value that a clause keeps"
  coordinate Length x(start = 1 [m], rate = 0);
  discrete Length kept(start = 0);
  discrete Boolean late(start = false);
  body b = Particle(mass = 1 [kg], at = {x, 0, 0});
  potential V = 2 [N/m]*x^2;
  output Real peak = 1/((time/(1 [s]) - 3.16)^2 + 1e-4)*x/(1 [m]);
  output Real last = 1/(10.001 - time/(1 [s]))*x/(1 [m]);
  when time > 3.15 [s] then
    reinit(kept, x);
    reinit(late, true);
  end when;
end Steep;
"""


@BACKENDS
def test_outputs_that_peak_once_and_kept_values(backend: str) -> None:
    """The error bars hold for every recorded time, also for the last one; closed form."""
    run = lagc.loads(STEEP).compile(backend=backend).simulate(10, accuracy=1e-5)
    assert run.status == "ok"
    for name, factor in (
        ("peak", lambda t: 1 / ((t - 3.16) ** 2 + 1e-4)),
        ("last", lambda t: 1 / (10.001 - t)),
    ):
        true = max(abs(value - factor(t) * cos(2 * t)) for t, value in zip(run.t, run[name]))
        assert 0.0 < true <= run.errors[name] < 1.0
    assert 0.0 < abs(run["kept"][-1] - cos(2 * 3.15)) <= run.errors["kept"] < 1e-4
    assert run.errors["late"] == 0.0


PAIR = """\
model Pair "two equal oscillators, by their mean and a tiny difference"
  coordinate Length x(start = 1 [m]), y(start = 1e-9 [m]);
  body a = Particle(mass = 1 [kg], at = {x + y, 0, 0});
  body b = Particle(mass = 1 [kg], at = {x - y, 0, 0});
  potential p = 1/4*1 [N/m3]*((x + y)^4 + (x - y)^4);
end Pair;
"""


@BACKENDS
def test_a_state_that_only_round_off_keeps_from_the_accuracy_fails_no_run(backend: str) -> None:
    """Forces on `y` are differences of those on `x`: of its 1e-9 m, the last 1e-16 m are lost at each step.
    The reference integrates y/1e-9 with the differences expanded."""
    run = lagc.loads(PAIR).compile(backend=backend).simulate(10, accuracy=1e-8, points=31)
    assert run.status == "ok", run.message
    small, known = 1e-9, integrated(
        lambda _, s: [s[2], s[3], -(s[0] ** 3) - 3e-18 * s[0] * s[1] ** 2,
                      -3.0 * s[0] ** 2 * s[1] - 1e-18 * s[1] ** 3],
        [1.0, 1.0, 0.0, 0.0], run.t,
    )  # fmt: skip
    (note,) = [note for note in run.notes if "round-off exceeds the accuracy of the own range" in note]
    assert "`y`" in note and "`der(y)`" in note and "`x`" not in note
    errors = {
        name: float(np.abs(run[name] - exact).max())
        for name, exact in zip(("x", "y", "der(x)", "der(y)"), known * [[1.0], [small], [1.0], [small]])
    }
    assert errors["x"] <= 1e-8 * 2.0 and errors["der(x)"] <= 1e-8 * 1.4
    assert all(error <= run.errors[name] for name, error in errors.items())
    assert errors["y"] > 1e-8 * np.ptp(known[1]) * small  # the note is true


@pytest.mark.parametrize("accuracy", [1e-3, 1e-5])
def test_the_speed_of_a_coordinate_that_stands_counts_by_what_it_moves(accuracy: float) -> None:
    """The lean of a coin on its steady circle is constant, so that its rate is an error alone."""
    run = lagc.load("classic/rolling_disc").compile(backend="numpy").simulate(3.0, accuracy=accuracy)
    assert run.status == "ok" and run.rtol > 1e-2 * accuracy  # the first tolerance, not the finest one
    assert abs(run["lean"] - 0.3).max() <= run.errors["lean"] <= accuracy * 0.3
    assert abs(run["der(lean)"]).max() <= run.errors["der(lean)"] <= accuracy * 0.1


@pytest.mark.full
def test_links_of_a_chain_that_have_hardly_begun_to_move() -> None:
    """The last links of a chain turn by less than the round-off of their angles. The reference has 64 bits:
    sum_j a_ij (cos(q_i - q_j) q_j'' + sin(q_i - q_j) q_j'^2) + a_ii g/l sin(q_i) = 0."""
    n, stop = 12, 0.1
    model = lagc.load("chain").compile(backend="numpy", parameters={"n": n})
    run = model.simulate(stop, accuracy=1e-6, points=11)
    assert run.status == "ok", run.message
    assert any("round-off exceeds the accuracy of the own range" in note for note in run.notes)
    real = np.longdouble
    a = np.array([[real(n - max(i, j)) for j in range(n)] for i in range(n)])

    def accelerations(q: Array, v: Array) -> Array:
        apart = q[:, None] - q[None, :]
        m, f = (
            a * np.cos(apart),
            -(a * np.sin(apart)) @ (v * v) - real(9.81) / real(0.2) * np.diag(a) * np.sin(q),
        )
        for k in range(n):  # Gauss without pivots: the matrix is positive definite
            for i in range(k + 1, n):
                c = m[i, k] / m[k, k]
                m[i, k:] -= c * m[k, k:]
                f[i] -= c * f[k]
        for k in reversed(range(n)):
            f[k] = (f[k] - m[k, k + 1 :] @ f[k + 1 :]) / m[k, k]
        return f

    def end(steps: int) -> Array:
        h = real(stop) / steps
        x = np.array([[real(start)] * n for start in (run["th[1]"][0], 0.0)])
        for _ in range(steps):  # the classic method of order 4
            k = []
            for part in (0.0, 0.5, 0.5, 1.0):
                y = x + (part * h * k[-1] if k else 0.0)
                k.append(np.array([y[1], accelerations(y[0], y[1])]))
            x = x + h / 6 * (k[0] + 2 * k[1] + 2 * k[2] + k[3])
        return x

    coarse, fine = end(100), end(200)
    known = (fine + (fine - coarse) / 15).astype(float)
    for i in range(n):
        for name, exact in ((f"th[{i + 1}]", known[0][i]), (f"der(th[{i + 1}])", known[1][i])):
            error, moved = abs(run[name][-1] - exact), np.ptp(run[name])
            assert error <= min(run.errors[name] + 1e-15, 1e-6 * run.scales[name]), name
            assert moved < 1e-6 or error <= 1e-6 * moved, name


def test_bars_of_a_motion_that_is_cut_are_those_of_the_time_shown() -> None:
    model = lagc.load("double_pendulum").compile(backend="c")
    run = model.simulate(60, accuracy=1e-8, points=601)
    assert run.status == "failed" and run.cut and run.t[-1] < 60
    near = model.simulate(float(run.t[-1]), accuracy=1e-10, points=len(run.t))
    for name in ("theta1", "theta2", "der(theta1)", "der(theta2)"):
        assert run.errors[name] <= 3e-8 * run.scales[name], name
        assert np.abs(run[name] - near[name]).max() <= run.errors[name] + near.errors[name], name


@pytest.mark.parametrize("start", [1e10, 1e12, 1e14, 1e16])
def test_whole_turns_are_no_size_of_an_angle(start: float) -> None:
    """At 1e10 rad numbers are 2e-6 rad apart: nothing is known to 1e-6, and to 1e-3 what is said is true. The
    reference begins at the angle without its turns, and has bits to spare."""
    model = lagc.load("simple_pendulum").compile(backend="numpy")
    run = model.simulate(5, starts={"theta": start}, accuracy=1e-6, points=11)
    assert run.status == "failed" and run.message.count("Leave out whole turns") == 1
    assert "scale" not in run.message
    scales = {"theta": 1e13, "der(theta)": 1e13, "E": 1e13}
    assert model.simulate(5, starts={"theta": start}, accuracy=1e-6, points=11, scales=scales).status == "ok"
    coarse = model.simulate(5, starts={"theta": start}, accuracy=1e-3, points=11)
    assert coarse.status == ("ok" if start == 1e10 else "failed")
    with mpmath.workdps(40):
        angle = float(mpmath.fmod(mpmath.mpf(start), 2 * mpmath.pi))
    near = model.simulate(5, starts={"theta": angle}, accuracy=1e-9, points=11)
    n = len(coarse.t)
    true = np.abs(coarse["der(theta)"] - near["der(theta)"][:n]).max()
    if start < 1e16:  # the spacing is a third of a turn there
        assert true <= coarse.errors["der(theta)"] + 1e-12
        assert coarse.status == "failed" or true <= 1e-3 * 10.0
