"""What changes move sensitivities by: closed forms, and differences of tight runs."""

from fractions import Fraction

import numpy as np
import pytest
from mpmath import mp, mpf
from scipy.integrate import solve_ivp

import lagc

pytestmark = pytest.mark.usefixtures("own_cache")


def test_who_wraps_around_has_them() -> None:
    """x = x0 + v t - n a."""
    text = """model Saw
      parameter Length a = 1 [m];
      coordinate Length x(start = 0.2 [m], rate = 1.1 [m/s]);
      body b = Particle(mass = 1 [kg], at = {x, 0, 0});
      when x > a then reinit(x, x - a); end when;
    end Saw;"""
    asked = ["a", "start(x)", "start(der(x))"]
    run = lagc.loads(text).compile(backend="numpy").simulate(5.0, points=6, sensitivity=asked)
    assert run.status == "ok", run.message
    for name, expected in zip(asked, (-np.arange(6.0), np.ones(6), np.arange(6.0))):
        assert run.sensitivity("x", name) == pytest.approx(expected, abs=1e-12)


def test_at_the_time_of_an_event_what_is_behind_it_is_recorded() -> None:
    text = """model Kick
      parameter Real j = 2;
      coordinate Length x(rate = 1 [m/s]);
      body b = Particle(mass = 1 [kg], at = {x, 0, 0});
      when time > 1 [s] then reinit(der(x), j*der(x)); end when;
    end Kick;"""
    run = lagc.loads(text).compile(backend="numpy").simulate(2.0, points=3, sensitivity=["j"])
    assert run["der(x)"] == pytest.approx([1.0, 2.0, 2.0])
    assert run.sensitivity("der(x)", "j") == pytest.approx([0.0, 1.0, 1.0])
    assert run.sensitivity("x", "j") == pytest.approx([0.0, 0.0, 1.0])


MIRRORED = """model Mirrored
  parameter Real X = 0.3, v = 3;
  coordinate Real x(start = 0.1, rate = v*1 [1/s]);
  body b = Particle(mass = 1 [kg], at = {x, 0, 0}*1 [m]);
  force f = {-FORCE*1 [N], 0, 0} at b;
  when x > X then reinit(x, -x); end when;
end Mirrored;"""


@pytest.mark.full
def test_new_values_move_their_own_condition() -> None:
    """x = x0 + v t - 2 n X, at every accuracy, recorded beside events too."""
    model = lagc.loads(MIRRORED.replace("FORCE", "0")).compile(backend="numpy")
    for accuracy in (1e-4, 1e-6, 1e-9):
        run = model.simulate(2.0, accuracy=accuracy, points=31, sensitivity=["X", "v"])
        assert run.status == "ok", run.message
        passed = np.array([sum(e.t <= t for e in run.events) for t in run.times])
        clear = [all(abs(e.t - t) > 1e-9 for e in run.events) for t in run.times]
        assert 20 < sum(clear) < 31
        assert run.sensitivity("x", "X")[clear] == pytest.approx(-2.0 * passed[clear], abs=1e-9)
        assert run.sensitivity("x", "v") == pytest.approx(run.times, rel=1e-9)


@pytest.mark.full
@pytest.mark.parametrize("force", ["9.81*sin(x)", "10*x + 3*sin(time/(1 [s]))"])
def test_where_steps_are_curved(force: str) -> None:
    """By differences, where no event is near."""
    model = lagc.loads(MIRRORED.replace("FORCE", f"({force})")).compile(backend="numpy")
    for accuracy in (1e-4, 1e-8):
        run = model.simulate(1.9, accuracy=accuracy, points=8, sensitivity=["X", "v"])
        assert run.status == "ok" and run.sensitivities is not None, run.message
        for name, value in (("X", 0.3), ("v", 3.0)):
            step = 1e-4 * value
            two = [model.simulate(1.9, accuracy=1e-12, points=8, parameters={name: value + way * step})
                   for way in (-1.0, 1.0)]  # fmt: skip
            expected = (np.array(two[1]["x"]) - np.array(two[0]["x"])) / (2.0 * step)
            clear = [all(abs(e.t - t) > 1e-2 for e in run.events) for t in run.times]
            off = np.abs(np.array(run.sensitivity("x", name)) - expected)[clear].max()
            size = np.abs(expected).max()
            assert off <= (run.sensitivities.estimated or 0.0) * size + 1e-6 * size, (accuracy, name)


@pytest.mark.full
def test_what_cancels_at_a_change_is_none() -> None:
    """The torque on the axle is the same on both sides of the turn, whenever that is made: d(spin)/dT = 0."""
    text = """model Disc
      parameter Length R = 0.3 [m]; parameter Time T = 0.6189 [s]; parameter Angle turn = 0.9 [rad];
      parameter AngularVelocity s0 = 1.3536 [rad/s], y0 = 1.3127 [rad/s];
      coordinate Length x(rate = R*s0), y;
      coordinate Angle yaw(rate = y0), spin(rate = s0);
      frame Y = rotate_z(world, yaw);
      frame D = rotate_y(Y, spin);
      body disc = Solid(mass = 1 [kg], inertia = 1 [kg]*R^2*{1/4, 1/2, 1/4}, frame = D, com = {x, y, R});
      torque drive = -0.104 [N.m]*Y.y + 0.05 [N.m]*world.z on disc;
      constraint roll: velocity(disc, at = {x, y, 0}) = {0, 0, 0};
      when time >= T then
        reinit(yaw, yaw + turn);
        reinit({der(x), der(y)}, R*der(spin)*{cos(yaw + turn), sin(yaw + turn)});
      end when;
    end Disc;"""
    model = lagc.loads(text).compile(backend="numpy")
    for accuracy in (1e-4, 1e-6, 1e-8):
        run = model.simulate(3.0, points=7, accuracy=accuracy, sensitivity=["T"])
        assert run.status == "ok", run.message
        assert np.abs(run.sensitivity("spin", "T")).max() <= accuracy
        assert np.abs(run.sensitivity("x", "T")).max() > 0.01


def test_one_clause_makes_another_act() -> None:
    """x = sin t; where it is X its speed v = sqrt(1 - X^2) gives y the speed j v, and that gives x the speed
    e j v.  The clause that acts first stands behind."""
    text = """model Cascade
      parameter Real j = 1.5, e = 0.5, X = 0.6;
      coordinate Real x(rate = 1 [1/s]), y;
      body b = Particle(mass = 1 [kg], at = {x, y, 0}*1 [m]);
      force f = {-x*1 [N], 0, 0} at b;
      when der(y) > 0.5 [1/s] then reinit(der(x), e*der(y)); mark("second"); end when;
      when x > X then reinit(der(y), j*der(x)); mark("first"); end when;
    end Cascade;"""
    model, names = lagc.loads(text).compile(backend="numpy"), ("j", "e", "X")
    run = model.simulate(2.0, points=3, accuracy=1e-8, sensitivity=list(names))
    assert run.status == "ok", run.message
    assert [e.name for e in run.events] == ["first", "second"]

    def end(values: dict[str, Fraction]) -> list[mpf]:
        j, e, edge = (mpf(values[n].numerator) / values[n].denominator for n in names)
        left, v = 2 - mp.asin(edge), mp.sqrt(1 - edge**2)
        return [edge * mp.cos(left) + e * j * v * mp.sin(left), j * v * left]

    exact = {"j": Fraction(3, 2), "e": Fraction(1, 2), "X": Fraction(3, 5)}
    with mp.workdps(40):
        for name in names:
            step = Fraction(1, 10**12)
            two = [end({**exact, name: exact[name] + way * step}) for way in (-1, 1)]
            for quantity, low, high in zip("xy", *two):
                known = float((high - low) / (2 * mpf(step.numerator) / step.denominator))
                assert run.sensitivity(quantity, name)[-1] == pytest.approx(known, abs=1e-7)


@pytest.mark.sample(1)
@pytest.mark.parametrize(
    ("force", "more", "same"),
    [
        ("-3*x", "output Real s = if x > 0 then 1 else 0, a = abs(x);", True),
        ("-3*x*abs(x)", "", True),
        ("-(if x > 0 then 3 else 4)*x", "", False),
        ("if x > 0 then 1 else 2", "", False),
        ("-3*x", "when x > 0 then reinit(der(x), 2*der(x)); end when;", False),
    ],
)
def test_a_start_on_a_change_that_moves_nothing_has_them(force: str, more: str, same: bool) -> None:
    """To first order the side does not matter where force and slope are the same on both."""
    text = f"""model M
      coordinate Real x(rate = 1 [1/s]);
      body b = Particle(mass = 1 [kg], at = {{x, 0, 0}}*1 [m]);
      force f = {{({force})*1 [N], 0, 0}} at b;
      {more}
    end M;"""
    model = lagc.loads(text).compile(backend="numpy")
    run = model.simulate(1.0, points=2, accuracy=1e-8, sensitivity=["start(x)"])
    assert ("at the initial state itself" not in run.message) == same
    if same:
        two = [
            model.simulate(1.0, points=2, accuracy=1e-11, starts={"x": way * 1e-4})["x"][-1]
            for way in (-1, 1)
        ]
        known = (two[1] - two[0]) / 2e-4
        assert run.sensitivity("x", "start(x)")[-1] == pytest.approx(known, abs=1e-6)


@pytest.mark.full
@pytest.mark.parametrize("exponent", [1.5, 2.0, 2.5, 3.5])
@pytest.mark.parametrize("stiff", [3.16, 316.0])
def test_behind_the_kink_of_a_contact(exponent: float, stiff: float) -> None:
    """Hertz' contact is bent as z^1.5 where it begins, and what the stiffness changes departs there from zero
    as t^(n + 2): every step that begins there is as wrong by its own size.  SciPy, on the equations of the
    variations, from the contact on."""
    n, m, g, d, h = exponent, 0.01, 9.81, 1e-3, 3e-6
    text = f"""model Hertz
      parameter Force k = {stiff};
      coordinate Length z(start = {h});
      body b = Particle(mass = {m}, at = {{0, 0, z}});
      Gravity field(g = {g}, direction = {{0, 0, -1}});
      potential contact = k*{d} [m]/{n + 1}*max(-z/({d} [m]), 0)^{n + 1};
    end Hertz;"""

    def rates(t: float, y: np.ndarray) -> list[float]:
        z, v, z_k, v_k, z_h, v_h = y
        deep = max(-z / d, 0.0)
        slope = -n * stiff / m / d * deep ** (n - 1)
        return [v, stiff / m * deep**n - g, v_k, deep**n / m + slope * z_k, v_h, slope * z_h]

    met = np.sqrt(2.0 * h / g)
    stop = 2e-3
    sizes = np.array([1e-5, 1e-2, 1e-8, 1e-5, 1.0, 1e2])
    exact = solve_ivp(rates, (met, stop), [0.0, -g * met, 0.0, 0.0, 1.0, 0.0], method="DOP853",
                      rtol=1e-13, atol=1e-13 * sizes).y[:, -1]  # fmt: skip
    asked = ["k", "start(z)"]
    for accuracy in (1e-5, 1e-8):
        run = (
            lagc.loads(text)
            .compile(backend="numpy")
            .simulate(stop, points=2, accuracy=accuracy, sensitivity=asked)
        )
        assert run.status == "ok", run.message
        found = [run.sensitivity(what, by)[-1] for by in asked for what in ("z", "der(z)")]
        assert np.abs(np.array(found) / exact[2:] - 1.0).max() < 10.0 * accuracy


@pytest.mark.full
@pytest.mark.parametrize("rest", [0.0, 0.1, 10.0])
def test_a_ball_meets_one_that_rests_on_a_spring(rest: float) -> None:
    """By Hertz' contact, at t = 0.04: d/dk departs from zero by t^6.5, and with a spring that rests elsewhere
    than at zero is mostly rounding of y - rest at first.  SciPy, from the contact on, where rest is zero."""
    text = f"""model HertzSpring
      parameter Stiffness k = 2000 [N/m];
      coordinate Length x(start = {rest} [m] - 80 [mm], rate = 2 [m/s]), y(start = {rest});
      body a = Particle(mass = 1, at = {{x, 0, 0}});
      body b = Particle(mass = 2, at = {{y, 0, 0}});
      potential c = 2/5*1e6 [N]*(1 [m])*max(0, (x - y)/(1 [m]))^2.5;
      potential s = 1/2*k*(y - {rest} [m])^2;
    end HertzSpring;"""

    def rates(t: float, u: np.ndarray) -> list[float]:
        x, y, v, w, a, b, c, d = u
        deep = max(0.0, x - y)
        force, slope = 1e6 * deep**1.5, 1.5e6 * np.sqrt(deep) * (a - b)
        return [v, w, -force, (force - 2000.0 * y) / 2.0, c, d, -slope, (slope - 2000.0 * b - y) / 2.0]

    begin = [0.0, 0.0, 2.0, *([0.0] * 5)]
    exact = solve_ivp(rates, (0.04, 0.05), begin, method="DOP853", rtol=1e-12, atol=1e-20, max_step=1e-5)
    model = lagc.loads(text).compile(backend="numpy")
    run = model.simulate(0.05, points=2, accuracy=1e-6, sensitivity=["k"])
    assert run.status == "ok", run.message
    found = [run.sensitivity(what, "k")[-1] for what in ("x", "y", "der(x)", "der(y)")]
    assert np.abs(np.array(found) / exact.y[4:, -1] - 1.0).max() < 1e-5
