"""Event location: no zero crossing is missed, and the reported error holds."""

import math

import pytest

import lagc
from tests.simulation.events.switched import STOP, case, motion

pytestmark = pytest.mark.usefixtures("no_cache")
ROUNDOFF = 1e-12  # relative: of the times of events
TIMES = [STOP * k / 7 for k in range(8)]


@pytest.mark.full
@pytest.mark.parametrize("first", range(0, 60, 15))
def test_pulses_barriers_square_waves(first: int) -> None:
    """Forces that are constant piece by piece, kicks of 1e-5 s, barriers of 0.1 mm: no true error
    is above the estimate, but for round-off of the events, no estimate above what was asked."""
    known = 0
    for seed in range(first, first + 15):
        exact = motion(case(seed), TIMES)
        if exact is None:
            continue
        accuracy = 10.0 ** -(4 + seed % 6)
        run = lagc.loads(case(seed).text).compile(backend="numpy").simulate(STOP, points=8, accuracy=accuracy)
        if run.status != "ok":  # of many changes, the last places of their times
            assert "round-off" in run.message and len(run.events) > 50, run.message
            continue
        known += 1
        assert run.estimated is not None and run.estimated <= accuracy
        for i, name in enumerate(("x", "der(x)")):
            error = max(abs(state[i] - value) for state, value in zip(exact, run[name]))
            assert error <= run.errors[name] + ROUNDOFF * run.scales[name], (seed, name)
    assert known > 10


@pytest.mark.sample(1)
@pytest.mark.parametrize("seed", [3, 7, 21])
def test_both_backends_are_equal_to_the_bit(seed: int) -> None:
    runs = [
        lagc.loads(case(seed).text).compile(backend=backend).simulate(STOP, points=8, accuracy=1e-8)
        for backend in ("numpy", "c")
    ]
    assert runs[0].states == runs[1].states
    assert runs[0].events == runs[1].events and runs[0].cost.rhs == runs[1].cost.rhs
    assert runs[0].events


def model(action: str, start: str = "x(start = 1 [m], rate = 0 [m/s])") -> lagc.CompiledModel:
    return lagc.loads(
        f"model M\n  coordinate Length {start};\n  body b = Particle(mass = 1 [kg], at = {{x, 0, 0}});\n"
        f"  {action}\nend M;"
    ).compile(backend="numpy")


def test_events_are_reported_with_their_times() -> None:
    """x = 1 - t^2/2 passes 0 at sqrt(2), and time 0.75 s; a fall from 1 m and back."""
    run = model("potential V = 1 [N]*abs(x) + (if time > 0.75 [s] then 0 else 0)*1 [J];").simulate(
        4.0, accuracy=1e-10
    )
    assert [event.name for event in run.events] == ["x passes 0"]
    assert run.events[0].t == pytest.approx(math.sqrt(2.0), abs=1e-12)
    run = model("force f = {if time < 0.75 [s] then 1 [N] else -1 [N], 0, 0} at b;").simulate(4.0)
    assert [(event.t, event.name) for event in run.events] == [(0.75, "time passes 0.75")]


def test_a_bounce_costs_what_its_steps_cost() -> None:
    """The force of V = F |x| jumps at every passage: so many steps a passage, however exact."""
    wedge = model("potential V = 1 [N]*abs(x);")
    run = wedge.simulate(100.0, accuracy=1e-10)
    assert run.status == "ok"
    passages = int((100.0 + math.sqrt(2.0)) / (2.0 * math.sqrt(2.0)))
    assert len(run.events) == passages
    assert run.cost.rhs < 100 * passages * run.cost.integrations


@pytest.mark.parametrize("pull", ["5 [N/m]*(0.1 [m/s]*time - x)", "0.5 [N]"])
def test_chattering_is_reported(pull: str) -> None:
    """Dry friction as a sign, on what sticks: told at once, with the way out."""
    run = model(f"force f = {{{pull} - 3 [N]*sign(der(x)), 0, 0}} at b;", "x(start = 0 [m])").simulate(10.0)
    assert run.status == "failed" and run.cost.rhs < 1000
    assert "der(x) passes 0" in run.message and "tanh(v/v0)" in run.message


def test_equations_may_end_at_a_crossing() -> None:
    """sqrt(x) has no value beyond 0: v^2 = 1 + 2 (1 - 2/3) there."""
    run = model(
        "force f = {-1 [N] + (if x > 0 then 1 [N]*sqrt(x/(1 [m])) else 0 [N]), 0, 0} at b;",
        "x(start = 1 [m], rate = -1 [m/s])",
    ).simulate(5.0, accuracy=1e-9)
    (event,) = run.events
    speed, after = math.sqrt(1.0 + 2.0 / 3.0), 5.0 - event.t
    assert run.status == "ok"
    assert run["x"][-1] == pytest.approx(-speed * after - 0.5 * after**2, rel=1e-9)


@pytest.mark.parametrize(
    ("force", "end"),
    [
        ("table(mod(time, 0.5 [s]), {0, 0.25, 0.5} [s], {0, 1, 0} [N])", 6.0),
        ("table(mod(time, 0.7 [s]), {0, 0.2, 0.35, 0.7} [s], {0, 1, -0.5, 0} [N])", 1.8),
        ("floor(10*mod(time, 0.7 [s])/(1 [s]))*1 [N]", 30.5),
        ("1 [N]*min(mod(time, 1 [s]), mod(-time, 1 [s]))/(1 [s])", 3.5),
        ("1 [N]*mod(floor(time/(0.1 [s])), 3)*floor(mod(time, 0.5 [s])/(0.1 [s]))", 20.7),
    ],
)
def test_indicators_that_jump_with_other_modes(force: str, end: float) -> None:
    """Where a period ends, what counts within it begins anew: sums over periods of 10 s."""
    run = model(f"force f = {{{force}, 0, 0}} at b;", "x(start = 0 [m], rate = 1 [m/s])").simulate(10.0)
    assert run.status == "ok" and run["der(x)"][-1] == pytest.approx(end, rel=1e-9)


@pytest.mark.parametrize("width", [1e-3, 1e-5])
def test_a_condition_that_is_true_for_a_moment(width: float) -> None:
    """Within (x - 5)^2 < w^2 the work is 2 J: v^2 = 1 + 2*2."""
    action = f"force f = {{if (x/(1 [m]) - 5)^2 < {width!r}^2 then 1 [N]/{width!r} else 0 [N], 0, 0}} at b;"
    run = model(action, "x(start = 0 [m], rate = 1 [m/s])").simulate(10.0, accuracy=1e-8)
    assert run.status == "ok" and run["der(x)"][-1] == pytest.approx(math.sqrt(5.0), rel=1e-7)
    assert len(run.events) == 2


@pytest.mark.parametrize(
    "force", ["table(abs(x), {0, 1, 2} [m], {0, 1, 5} [N])", "1 [N]*floor(3*abs(x)/(1 [m]))"]
)
def test_a_corner_that_touches_zero_is_no_crossing(force: str) -> None:
    """abs(x) comes to 0, where the table begins, and goes back: a force that is even in x."""
    run = model(f"force f = {{{force}, 0, 0}} at b;", "x(start = -0.7 [m], rate = 1 [m/s])").simulate(1.0)
    assert run.status == "ok" and run["x"][-1] > 0.3


def test_backwards_fixed_steps_and_other_methods() -> None:
    """A fixed step keeps the order of its method across changes, in time and in place."""
    wedge = model(
        "potential V = 1 [N]*abs(x); force f = {if time < 0.4 [s] then 1 [N] else 0 [N], 0, 0} at b;"
    )
    exact = wedge.simulate(4.0, accuracy=1e-12)
    for method in ("rk4", "bs32", "dopri5", "dop853"):
        run = wedge.simulate(4.0, method=method, step=0.1)
        assert run["x"][-1] == pytest.approx(exact["x"][-1], abs=1e-12), method


def test_rates_do_not_depend_on_earlier_runs() -> None:
    """Beside a run equations are those of the state alone."""
    wedge = model("potential V = 1 [N]*abs(x);")
    system = wedge.simulate(3.0).system
    for x, force in ((0.5, -1.0), (-0.5, 1.0), (0.0, 0.0)):
        xdot = [0.0] * system.nx
        system.rhs(0.0, [x, 0.0], xdot, [])
        assert xdot[1] == force


@pytest.mark.parametrize("accuracy", [1e-6, 1e-8])
def test_a_narrow_bell_with_ends(accuracy: float) -> None:
    """max(0, 1 - u^2), 0.02 mm wide and of 4/3 J: v^2 = 1 + 8/3.  The step that the last one lets expect is a
    million times too long for it."""
    force = "1e5 [N]*max(0, 1 - ((x/(1 [m]) - 5)/1e-5)^2)"
    run = model(f"force f = {{{force}, 0, 0}} at b;", "x(start = 0 [m], rate = 1 [m/s])").simulate(
        10.0, accuracy=accuracy
    )
    assert run.status == "ok" and len(run.events) == 2
    assert run["der(x)"][-1] == pytest.approx(math.sqrt(11.0 / 3.0), rel=accuracy)


@pytest.mark.sample(1)
@pytest.mark.parametrize("backend", ["numpy", "c"])
def test_crossings_at_one_time_within_roundoff(backend: str) -> None:
    """floor(t) at n, sign(sin(pi t)) a last place later: 1 - 1 + 2 - 3 + ... - 9, the last motion whole."""
    text = (
        "model M\n  coordinate Length x(rate = 1 [m/s]);\n"
        "  body b = Particle(mass = 1 [kg], at = {x, 0, 0});\n"
        "  force f = {1 [N]*floor(time/(1 [s]))*sign(sin(pi*time/(1 [s]))), 0, 0} at b;\nend M;"
    )
    run = lagc.loads(text).compile(backend=backend).simulate(10.0, accuracy=1e-9)
    assert run.status == "ok"
    assert run["der(x)"][-1] == pytest.approx(-4.0, rel=1e-9) and run["x"][-1] == pytest.approx(7.5, rel=1e-9)


@pytest.mark.parametrize("places", [5, 9, 13, 17])
def test_crossings_some_ulps_apart(places: int) -> None:
    """Between the two ends a step of 1e-15 s, after one that the hard wall has rejected."""
    text = (
        "model M\n  parameter Length d = 0;\n  parameter Stiffness k = 1e4;\n"
        "  coordinate Length x(start = -1 [m], rate = 1), y(start = -1 [m] - d, rate = 1);\n"
        "  body a = Particle(mass = 1 [kg], at = {x, 0, 0});\n"
        "  body b = Particle(mass = 1 [kg], at = {y, 0, 0});\n"
        "  potential wall = k/2*(max(0, x)^2 + max(0, y)^2);\nend M;"
    )
    system = lagc.loads(text).compile(backend="numpy")
    for rtol in (1e-6, 1e-7, 1e-8, 1e-9, 1e-10):
        run = system.simulate(1.5, method="dop853", rtol=rtol, parameters={"d": places * 2.0**-52})
        assert run.status == "ok" and len(run.events) == 4, run.message
        for place in (run["x"], run["y"]):
            assert place[-1] == pytest.approx(1.0 + math.pi / 100.0 - 1.5, rel=50.0 * rtol)


@pytest.mark.parametrize("p, k", [(0.0, 1.0), (4.0, 0.25)])
@pytest.mark.parametrize("branch", ["1/2*1 [N]*x^2/p", "1 [N]*p*(1 - cos(x/p))"])
def test_a_branch_may_divide_by_a_parameter_that_is_zero(branch: str, p: float, k: float) -> None:
    """Where p is 0 the branch that divides by it is not taken: small oscillations by k."""
    text = f"""model M
  parameter Length p = {p};
  coordinate Length x(start = 1 [um]);
  body b = Particle(mass = 1, at = {{x, 0, 0}});
  potential V = if p > 0 then {branch} else 1/2*1 [N/m]*x^2;
end M;
"""
    run = lagc.loads(text).compile(backend="numpy").simulate(stop=2, accuracy=1e-9)
    assert run.status == "ok", run.message
    assert run["x"][-1] == pytest.approx(1e-6 * math.cos(2 * math.sqrt(k)), abs=1e-14)


def test_a_relation_in_the_kinematics() -> None:
    """w = (1 + max(0, y)^2) y' = 2: y from -1 to 0 in half a second, then y + y^3/3 = 2 t - 1."""
    text = """model M
  coordinate Length x(start = 1), y(start = -1);
  speed Velocity w = (1 + max(0, y/(1 [m]))^2)*der(y);
  body b = Particle(mass = 1, at = {x, 0, 0});
  constraint r: w = 2 [m/s];
  output Length yy = y;
end M;
"""
    run = lagc.loads(text).compile(backend="numpy").simulate(stop=2, accuracy=1e-9)
    assert run.status == "ok", run.message
    y = run["yy"][-1]
    assert y + y**3 / 3 == pytest.approx(3.0, abs=1e-8)


@pytest.mark.parametrize("force", ["", "force f = (if x > u then 1 [N] else 4.72 [N])*world.y at b;"])
def test_a_relation_in_a_force_without_power_is_no_event(force: str) -> None:
    text = f"""model M
  parameter Length u = 0.5;
  coordinate Length x(start = 0.1, rate = 1);
  body b = Particle(mass = 1, at = {{x, 0, 0}});
  {force}
  when x > u then mark("m"); end when;
end M;
"""
    model = lagc.loads(text).compile(backend="numpy")
    assert model.interface.relations_aside == (1,)
    run = model.simulate(stop=1, accuracy=1e-8)
    assert len(run.events) == 1
