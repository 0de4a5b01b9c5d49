"""Sensitivities across events of contacts, against closed forms and differences of runs."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import lagc
from lagc import Refused
from lagc.cli.main import main

BACKENDS = ["numpy", pytest.param("c", marks=pytest.mark.full)]
THROWN = """model Thrown
  parameter Real e = 0.6, mu = 0.05; parameter Length h = 1 [m]; parameter Velocity v = 5 [m/s];
  coordinate Length x(rate = v), y(start = h);
  body b = Particle(mass = 1 [kg], at = {x, y, 0});
  Gravity field(g = 9.81 [m/s2], direction = {0, -1, 0});
  constraint floor: y >= 0 (restitution = e, friction = mu, at = b);
end Thrown;"""
SLIDING = """model Sliding
  parameter Real mu = 0.3; parameter Velocity v = 2 [m/s];
  coordinate Length x(rate = v), y;
  body b = Particle(mass = 1 [kg], at = {x, y, 0});
  Gravity field(g = 9.81 [m/s2], direction = {0, -1, 0});
  constraint floor: y >= 0 (friction = mu, at = b);
end Sliding;"""


def thrown(t: float, h: complex, e: complex, g: complex, v: complex, mu: complex) -> tuple[complex, ...]:
    """The flights between impacts: each takes mu (1 + e) u off the horizontal speed v, if that is more, and
    leaves e u of the vertical one. A derivative is an imaginary part (J. N. Lyness, C. B. Moler, SIAM J.
    Numer. Anal. 4, 1967, 202-210)."""
    x, u, left, flight = 0.0 * v, np.sqrt(2.0 * g * h), t, np.sqrt(2.0 * h / g)
    if t < flight.real:
        return x + v * t, h - g * t**2 / 2.0
    while left >= flight.real:
        x, left = x + v * flight, left - flight
        v, u = v - mu * (1.0 + e) * u, e * u
        flight = 2.0 * u / g
    return x + v * left, u * left - g * left**2 / 2.0


def derivatives(times: list[float], name: str, **values: float) -> np.ndarray:
    moved = {n: complex(value, 1e-30 * (n == name)) for n, value in values.items()}
    return np.array([[part.imag / 1e-30 for part in thrown(t, **moved)] for t in times])


def differences(
    model: lagc.CompiledModel, stop: float, points: int, name: str, value: float, accuracy: float = 1e-12
) -> dict[str, np.ndarray]:
    """The derivatives of the states by central differences of the fourth order, where all runs have the same
    events behind them."""
    step = 1e-3 * value
    runs = [
        model.simulate(stop, points=points, accuracy=accuracy, parameters={name: value + k * step})
        for k in (-2, -1, 1, 2)
    ]
    passed = np.array([[sum(e.t <= t for e in run.events) for t in run.t] for run in runs])
    found = {}
    for state in model.state_names:
        a = [np.array(run[state]) for run in runs]
        slope = (8.0 * (a[2] - a[1]) - (a[3] - a[0])) / (12.0 * step)
        found[state] = np.where((passed == passed[0]).all(axis=0), slope, np.nan)
    return found


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_flight(backend: str) -> None:
    """y = h - g t^2/2: the restitution has no effect before the impact."""
    ball = lagc.load("bouncing_ball").compile(backend=backend)
    run = ball.simulate(0.4, accuracy=1e-9, sensitivity=["h", "e", "field.g"])
    assert run.status == "ok"
    t = np.array(run.t)
    assert np.allclose(run["d(y)/d(field.g)"], -(t**2) / 2.0, 0.0, 1e-12)
    assert np.allclose(run["d(y)/d(h)"], 1.0, 1e-12) and not any(run["d(y)/d(e)"])


@pytest.mark.parametrize("backend", BACKENDS)
def test_bounces(backend: str) -> None:
    ball = lagc.load("bouncing_ball").compile(backend=backend)
    names = {"h": "h", "e": "e", "field.g": "g"}
    run = ball.simulate(1.5, points=16, accuracy=1e-9, sensitivity=[*names, "m"])
    assert run.status == "ok" and len(run.events) == 2, run.message
    for name, own in names.items():
        exact = derivatives(run.t, own, h=1.0, e=0.8, g=9.81, v=0.0, mu=0.0)[:, 1]
        assert np.allclose(run[f"d(y)/d({name})"], exact, 0.0, 1e-10)
    assert not any(run["d(y)/d(m)"])


@pytest.mark.full
@pytest.mark.parametrize("backend", BACKENDS)
def test_bounces_that_rub_and_come_to_rest(backend: str) -> None:
    """Bounces end at t1 (1 + e)/(1 - e) = 1.806 s; from then on the ball slides on the floor: v' = -mu g, as
    the bounces had on average."""
    ball = lagc.loads(THROWN).compile(backend=backend)
    values = {"h": 1.0, "e": 0.6, "g": 9.81, "v": 5.0, "mu": 0.05}
    run = ball.simulate(3.0, points=31, accuracy=1e-8, sensitivity=["h", "e", "field.g", "v", "mu"])
    assert run.status == "ok" and run.events[-1].name == "floor rests", run.message
    early = np.array(run.t) < 1.805
    for name in values:
        exact = derivatives(list(np.array(run.t)[early]), name, **values)
        by = "field.g" if name == "g" else name
        for column, own in zip("xy", exact.T):
            assert np.allclose(run[f"d({column})/d({by})"][early], own, 0.0, 1e-7 * np.abs(own).max() + 1e-9)
    # At last x = v t - mu g s^2/2 - mu u s, a time s after the first impact at u, as if nothing had bounced.
    fall = np.sqrt(2.0 / 9.81)
    s = 3.0 - fall
    assert run["d(x)/d(mu)"][-1] == pytest.approx(-9.81 * s**2 / 2.0 - 9.81 * fall * s, rel=1e-6)
    assert run["d(x)/d(v)"][-1] == pytest.approx(3.0, rel=1e-9)


@pytest.mark.full
@pytest.mark.parametrize("backend", BACKENDS)
def test_a_block_slides_to_rest(backend: str) -> None:
    """x = v^2/(2 mu g)."""
    block = lagc.loads(SLIDING).compile(backend=backend)
    run = block.simulate(1.0, points=11, accuracy=1e-9, sensitivity=["v", "mu", "field.g"])
    assert run.status == "ok", run.message
    x = 4.0 / (2.0 * 0.3 * 9.81)
    for name, exact in (("v", x), ("mu", -x / 0.3), ("field.g", -x / 9.81)):
        assert run[f"d(x)/d({name})"][-1] == pytest.approx(exact, rel=1e-10)
        assert run[f"d(der(x))/d({name})"][-1] == 0.0


@pytest.mark.full
def test_a_pendulum_against_a_wall() -> None:
    """SciPy, from impact to impact."""
    text = """model Wall
      parameter Length length = 1 [m], d = 0.2 [m]; parameter Real e = 0.7;
      coordinate Angle a(start = 1 [rad]);
      body b = Particle(mass = 1 [kg], at = {length*sin(a), -length*cos(a), 0});
      Gravity field(g = 9.81 [m/s2], direction = {0, -1, 0});
      constraint wall: length*sin(a) >= -d (restitution = e);
    end Wall;"""

    def end(length: float = 1.0, d: float = 0.2, e: float = 0.7) -> float:
        t, state = 0.0, [1.0, 0.0]

        def gap(_: float, y: np.ndarray) -> float:
            return float(length * np.sin(y[0]) + d)

        gap.terminal, gap.direction = True, -1.0  # type: ignore[attr-defined]
        while True:
            found = solve_ivp(
                lambda _, y: [y[1], -9.81 / length * np.sin(y[0])], (t, 4.0), state, method="DOP853",
                rtol=1e-13, atol=1e-13, events=gap,
            )  # fmt: skip
            if not found.t_events[0].size:
                return float(found.y[0, -1])
            t, state = found.t_events[0][0], [float(found.y[0, -1]), -e * float(found.y[1, -1])]

    model, values = lagc.loads(text).compile(backend="numpy"), {"length": 1.0, "d": 0.2, "e": 0.7}
    exact = {}
    for name, value in values.items():
        step = 1e-3 * value
        ends = [end(**{name: value + k * step}) for k in (-2, -1, 1, 2)]
        exact[name] = (8.0 * (ends[2] - ends[1]) - (ends[3] - ends[0])) / (12.0 * step)
    # The estimate covers the error.
    for accuracy in (1e-4, 1e-7):
        run = model.simulate(4.0, accuracy=accuracy, points=41, sensitivity=[*values])
        assert run.status == "ok" and len(run.events) == 3, run.message
        assert run.sensitivities is not None and run.sensitivities.estimated is not None
        for name, known in exact.items():
            column = run.sensitivity("a", name)
            off = run.sensitivities.estimated * np.abs(column).max()
            assert abs(column[-1] - known) <= off + 1e-8 * abs(known)


@pytest.mark.full
@pytest.mark.parametrize(
    ("model", "stop", "values"),
    [
        ("slack_rope", 3.0, {"l": 1.0, "v0": 6.0}),  # goes slack, and taut again
        ("block_on_belt", 6.5, {"w": 0.1, "mu": 0.2}),  # sticks and slips
        ("rocking_block", 1.2, {"theta0": 0.1, "R": 0.5}),
        ("bowling_ball", 4.0, {"mu": 0.1, "v": 8.0}),  # slips, then rolls
        ("incline", 1.0, {"mu": 0.7, "v": 3.0}),
    ],
)
def test_of_the_library_by_differences(model: str, stop: float, values: dict[str, float]) -> None:
    loaded = lagc.load(model).compile(backend="numpy")
    run = loaded.simulate(stop, points=14, accuracy=1e-7, sensitivity=[*values])
    assert run.status == "ok" and run.events, run.message
    for name, value in values.items():
        for state, slope in differences(loaded, stop, 14, name, value).items():
            known, size = ~np.isnan(slope), np.nanmax(np.abs(slope))
            assert known.sum() > 10
            assert np.allclose(run.sensitivity(state, name)[known], slope[known], 0.0, 1e-6 * size + 1e-9)


@pytest.mark.full
def test_a_slip_in_space_that_stops() -> None:
    """A cue ball slips at u = (v - r wy, r wx), a straight way that ends at 2 |u|/(7 mu g); then it rolls."""
    ball = lagc.load("billiard").compile(backend="numpy")
    run = ball.simulate(0.8, points=5, accuracy=1e-6, sensitivity=["mu", "v"])
    assert run.status == "ok" and run.events[0].name == "table sticks", run.message
    for name in ("mu", "v"):
        mu, v = (complex(value, 1e-30 * (name == n)) for n, value in (("mu", 0.2), ("v", 2.0)))
        u = np.array([v + 0.028 * 40.0, -0.028 * 60.0])
        size = np.sqrt(u[0] ** 2 + u[1] ** 2)
        for column, speed, along in zip("xy", (v, 0.0), u / size):
            stop, t = 2.0 * size / (7.0 * mu * 9.81), 0.8
            x = speed * stop - mu * 9.81 * along * stop**2 / 2.0
            x += (speed - mu * 9.81 * along * stop) * (t - stop)
            assert run[f"d({column})/d({name})"][-1] == pytest.approx(x.imag / 1e-30, rel=1e-5)


@pytest.mark.full
@pytest.mark.parametrize("along", [0.0, 0.1])
def test_a_slip_that_begins_at_the_start(along: float) -> None:
    """On a slope (a, b) of length s a block slides by g (s - mu n) t^2/2. At other speeds friction is
    opposite on both sides."""
    text = f"""model Slope
      parameter Real mu = 0.3, a = 0.5;
      coordinate Length x, y, z;
      body b = Particle(mass = 1 [kg], at = {{x, y, z}});
      Gravity field(g = 9.81 [m/s2], direction = {{a, {along}, -0.8}});
      constraint floor: z >= 0 (friction = mu, at = b);
      {"constraint rail: y = 0;" if along == 0.0 else ""}
    end Slope;"""
    run = lagc.loads(text).compile(backend="numpy").simulate(
        1.0, points=5, accuracy=1e-8, sensitivity=["mu", "a", "start(der(x))"]
    )  # fmt: skip
    assert "`start(der(x))`: at t = 0 s: `floor` begins to slip" in run.message
    t = np.array(run.t)
    for name in ("mu", "a"):
        mu, a = (complex(value, 1e-30 * (name == n)) for n, value in (("mu", 0.3), ("a", 0.5)))
        s, length = np.sqrt(a**2 + along**2), np.sqrt(a**2 + along**2 + 0.64)
        slope = (9.81 * a / s * (s - 0.8 * mu) / length / 2.0).imag / 1e-30
        assert np.allclose(run[f"d(x)/d({name})"], slope * t**2, 0.0, 1e-7)


@pytest.mark.full
def test_both_backends_are_equal_to_the_bit() -> None:
    values = []
    for backend in ("numpy", "c"):
        belt = lagc.load("block_on_belt").compile(backend=backend)
        run = belt.simulate(5.0, points=21, accuracy=1e-7, sensitivity=["w", "mu"])
        assert run.sensitivities is not None and run.status == "ok"
        values.append(run.sensitivities.values)
    assert np.array_equal(*values)


@pytest.mark.full
def test_two_balls_at_one_time() -> None:
    """Together they fall for any g; for other heights one comes first, and there is no derivative."""
    text = """model Two
      parameter Length h = 1 [m], k = 1 [m];
      coordinate Length y(start = h), z(start = k);
      body a = Particle(mass = 1 [kg], at = {0, y, 0});
      body b = Particle(mass = 1 [kg], at = {1 [m], z, 0});
      Gravity field(g = 9.81 [m/s2], direction = {0, -1, 0});
      constraint one: y >= 0 (restitution = 0.5);
      constraint two: z >= 0 (restitution = 0.5);
    end Two;"""
    run = lagc.loads(text).compile(backend="numpy").simulate(0.8, points=9, sensitivity=["field.g", "h"])
    assert run.status == "failed" and "`one touches` and `two touches` happen at one time" in run.message
    assert not np.isnan(run["d(y)/d(field.g)"]).any() and np.isnan(run["d(y)/d(h)"][-1])


@pytest.mark.full
def test_an_impact_that_changes_its_kind() -> None:
    """An inelastic ball that hits the floor with the least angle at which it does not slip."""
    tangent = 1.0 / (0.5 * 4.429446918070013)
    model = lagc.loads(THROWN).compile(backend="numpy")
    given = {"e": 0.0, "mu": 0.5, "v": 1.0 / tangent}
    run = model.simulate(0.6, points=4, parameters=given, sensitivity=["v"])
    assert run.status == "failed" and "the smallest change decides what contacts do" in run.message


@pytest.mark.full
@pytest.mark.parametrize("backend", BACKENDS)
def test_a_fit_of_restitution_and_friction(backend: str) -> None:
    ball = lagc.loads(THROWN).compile(backend=backend)
    seen = ball.simulate(1.5, points=31, accuracy=1e-9, parameters={"e": 0.7, "mu": 0.08})
    fit = ball.fit({"time": seen.t, "x": seen["x"], "y": seen["y"]}, ["e", "mu"], {"x": "x", "y": "y"})
    assert fit.values == pytest.approx({"e": 0.7, "mu": 0.08}, rel=1e-6)


@pytest.mark.full
@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(("name", "value"), [("l", 1.0), ("field.g", 9.81)])
def test_a_taut_rope_is_followed(backend: str, name: str, value: float) -> None:
    """Against differences of runs with 1e-12; the start moves with the rope."""
    model = lagc.load("slack_rope").compile(backend=backend)
    found = model.simulate(0.4, accuracy=1e-9, sensitivity=name)
    assert found.status == "ok"
    far = 1e-4 * value
    up, down = (model.simulate(0.4, accuracy=1e-12, parameters={name: value + s * far}) for s in (1, -1))
    for column in ("x", "z", "der(x)", "tension"):
        slopes = (np.array(up[column]) - np.array(down[column])) / (2.0 * far)
        size = np.abs(slopes).max()
        assert np.allclose(found[f"d({column})/d({name})"], slopes, 0.0, 1e-6 * size)


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_block_that_sticks_to_its_belt(backend: str) -> None:
    """x = w t, and E = m w^2/2 + k x^2/2."""
    belt = lagc.load("block_on_belt").compile(backend=backend)
    run = belt.simulate(2.0, accuracy=1e-9, sensitivity=["w", "k"])
    t = np.array(run.t)
    assert run.status == "ok" and np.allclose(run["d(x)/d(w)"], t, 0.0, 1e-12)
    assert np.allclose(run["d(E)/d(k)"], (0.1 * t) ** 2 / 2.0, 0.0, 1e-12)


def test_what_is_not_followed() -> None:
    for name, code in (("rough_pin", "LAG0623"), ("conveyor", "LAG0622")):
        with pytest.raises(Refused) as refused:
            lagc.load(name).compile(backend="numpy").simulate(0.1, sensitivity="mu")
        assert refused.value.faults[0].code == code
    with pytest.raises(Refused) as refused:
        lagc.load("bouncing_ball").compile(backend="numpy").simulate(0.1, sensitivity="nothing")
    assert refused.value.faults[0].code == "LAG0601"


def test_an_impact_at_the_start() -> None:
    """y = e v t - g t^2/2."""
    ball = lagc.load("bouncing_ball").compile(backend="numpy")
    starts = {"y": 0.0, "der(y)": -1.0}
    run = ball.simulate(0.1, points=3, starts=starts, sensitivity=["e", "start(der(y))"])
    assert run.status == "ok", run.message
    assert np.allclose(run["d(y)/d(e)"], run.t, 0.0, 1e-9)
    assert np.allclose(run["d(y)/d(start(der(y)))"], -0.8 * np.array(run.t), 0.0, 1e-9)


def test_the_command(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["sim", "bouncing_ball", "--stop", "1", "--sensitivity", "h"]) == 0
    assert "d(y)/d(h)" in "".join(capsys.readouterr())
