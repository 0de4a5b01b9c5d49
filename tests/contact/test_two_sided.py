"""Dry friction of constraints with `=` and of joints, against closed forms and other formulations."""

import math
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq

import lagc
from lagc.api import Run
from lagc.cli.main import main
from lagc.diagnostics.faults import Refused

BACKENDS = ["numpy", pytest.param("c", marks=pytest.mark.full)]
G = 9.81
RAIL = """model M
  parameter Real one = 1;
  coordinate Length x(rate = 3 [m/s]), y;
  Gravity field;
  body block = Particle(mass = 2 [kg], at = {{x, 0, y}});
  {}
  scene s
    simulate(stop = 1 [s]);
  end s;
end M;
"""


def _model(text: str) -> lagc.ModelFile:
    return lagc.loads(RAIL.format(text))


def _run(name: str, backend: str, stop: float | None = None, **values: Any) -> Run:
    compiled = lagc.load(name).compile(backend=backend)
    return compiled.simulate(stop, accuracy=values.pop("accuracy", 1e-9), parameters=values)


def _refused(model: lagc.ModelFile) -> str:
    with pytest.raises(Refused) as caught:
        model.compile(backend="numpy").simulate()
    (fault,) = caught.value.faults
    return f"{fault.code}: {fault.message}"


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_block_in_a_rail_stops_and_does_not_creep(backend: str) -> None:
    run = _run("block_in_rail", backend)
    a = math.radians(20.0)
    slows = G * (math.sin(a) + 0.3 * math.cos(a))
    (stops,) = run.events
    assert stops.kind == "sticks" and stops.t == pytest.approx(3.0 / slows, abs=1e-11)
    still = np.array(run["way"])[np.array(run.t) > stops.t]
    assert run.t[-1] == 1000.0 and len(still) > 10
    assert still[0] == pytest.approx(4.5 / slows, rel=1e-9)
    assert np.ptp(still) <= 2.0**-52  # a unit in the last place
    assert run.final["rail"] == 2.0


@pytest.mark.parametrize(("side", "sign"), [("", 1.0), ("force lift = {0, 0, 60} [N] at block;", -1.0)])
def test_friction_is_the_same_on_both_sides(side: str, sign: float) -> None:
    """A force of 60 N upwards lets the rail hold the block down: |N| is 40.38 N instead of 19.62 N."""
    run = (
        _model(f"constraint rail: y = 0 (friction = 0.25, slip = der(x)); {side}")
        .compile(backend="numpy")
        .simulate(2.0, accuracy=1e-9)
    )
    push = 2.0 * G if sign > 0.0 else 60.0 - 2.0 * G
    (stops,) = run.events
    assert stops.t == pytest.approx(3.0 / (0.25 * push / 2.0), abs=1e-11)


def _square_of_speed(theta: float, start: float, at: float, grip: float, radius: float) -> float:
    """v^2 on a hoop at an angle from below, from v^2 = start at the angle `at`, where grip = mu sign(N) on
    the way up: d(v^2)/d(theta) = -2 g R sin(theta) - 2 grip (v^2 + g R cos(theta))."""
    g, k = G * radius, 2.0 * grip
    # particular solution A sin + B cos of w' + k w = -2 g sin - k g cos
    a = (-2.0 * g * k - k * g) / (k * k + 1.0)
    b = (2.0 * g - k * k * g) / (k * k + 1.0)
    own = start - a * math.sin(at) - b * math.cos(at)
    return a * math.sin(theta) + b * math.cos(theta) + own * math.exp(-k * (theta - at))


@pytest.mark.full
@pytest.mark.parametrize("backend", ["numpy", "c"])
def test_a_bead_on_a_rough_hoop_presses_outwards_and_inwards(backend: str) -> None:
    """It climbs with N > 0 up to the angle where v^2 = -g R cos, then with N < 0 until it stops: the time is
    the integral of R/v, and it turns back there."""
    radius, mu = 0.5, 0.2
    outer = lambda theta: _square_of_speed(theta, 36.0, 0.0, mu, radius)  # noqa: E731
    lifts = brentq(lambda theta: outer(theta) + G * radius * math.cos(theta), 1.6, 3.1, xtol=1e-15)
    inner = lambda theta: _square_of_speed(theta, outer(lifts), lifts, -mu, radius)  # noqa: E731
    stops = brentq(inner, lifts, math.pi, xtol=1e-15)
    time = quad(lambda theta: radius / math.sqrt(outer(theta)), 0.0, lifts, epsabs=1e-13)[0]
    # v = 0 at the end: with theta = stops - u^2
    ends = math.sqrt(stops - lifts)
    time += quad(lambda u: 2.0 * radius * u / math.sqrt(inner(stops - u * u)), 0.0, ends, epsabs=1e-13)[0]
    run = _run("rough_hoop", backend)
    assert [event.kind for event in run.events] == ["slips", "slips", "slips", "sticks"]
    assert run.events[0].t == pytest.approx(time, abs=1e-8)
    forces = np.array(run["N"])
    assert forces.min() < -0.1 and forces.max() > 5.0
    rest = np.array(run.t) > run.events[-1].t
    assert np.ptp(np.array(run["x"])[rest]) < 1e-16 and abs(run.final["x"] / run.final["z"]) < mu
    energy = np.array(run["E"])
    assert np.all(np.diff(energy) <= 1e-9)
    assert abs(run.energy.imbalance) < 1e-8


def _swings(count: int) -> list[float]:
    """The times at which a pendulum on a rough pin turns, by integration in the angle and its rate: the
    torque of friction is mu r |N| with the N that the motion itself gives."""
    m, length, r, inertia, mu = 1.0, 0.5, 0.05, 0.1, 0.2

    def rates(_: float, y: np.ndarray, sense: float) -> list[float]:
        angle, rate = y

        def left(a: float) -> float:
            x = -length * (a * math.cos(angle) - rate * rate * math.sin(angle))
            z = length * (a * math.sin(angle) + rate * rate * math.cos(angle))
            torque = mu * r * math.hypot(m * x, m * z + m * G)
            return (inertia + m * length * length) * a + m * G * length * math.sin(angle) + sense * torque

        return [rate, brentq(left, -100.0, 100.0, xtol=1e-14, rtol=1e-14)]

    times, y, t, sense = [], [math.pi / 3.0, 0.0], 0.0, -1.0
    for _ in range(count):

        def turns(_: float, y: np.ndarray, sense: float) -> float:
            return float(y[1])

        turns.terminal, turns.direction = True, -sense  # type: ignore[attr-defined]
        found = solve_ivp(rates, (t, t + 5.0), y, rtol=1e-11, atol=1e-12, events=turns, args=(sense,))
        t, y, sense = found.t[-1], [found.y[0, -1], 0.0], -sense
        times.append(t)
    return times


@pytest.mark.full
@pytest.mark.parametrize("backend", ["numpy", "c"])
def test_a_pendulum_on_a_rough_pin_swings_and_stops(backend: str) -> None:
    run = _run("rough_pin", backend)
    assert [event.t for event in run.events[:6]] == pytest.approx(_swings(6), abs=1e-7)
    assert run.events[-1].kind == "sticks" and abs(run.final["der(pin.angle)"]) < 1e-100
    still = np.array(run["pin.angle"])[np.array(run.t) > run.events[-1].t]
    assert np.ptp(still) == 0.0
    assert math.sin(abs(still[0])) < 0.2 * 0.05 / 0.5
    assert run.final["M"] == pytest.approx(G * 0.5 * math.sin(still[0]), abs=1e-9)
    assert np.all(np.diff(np.array(run["E"])) <= 1e-9)
    assert abs(run.energy.imbalance) < 1e-8


_JOINTS = {
    "main": "Revolute(world, crank, axis = world.y, at = {0, 0, 0}, friction = 0.3, radius = 0.02 [m],"
    " angle(start = 1 [rad], rate = 20 [rad/s]))",
    "crankpin": "Revolute(crank, rod, axis = world.y, at = {0.05, 0, 0} [m],"
    " friction = 0.3, radius = 0.02 [m])",
    "pin": "Revolute(rod, piston, axis = world.y, at = {0.2, 0, 0} [m], friction = 0.3, radius = 0.02 [m])",
    "guide": "Prismatic(world, piston, axis = world.x, friction = 0.3)",
}
_CRANK = """model Crank
  body crank = Solid(mass = 1 [kg], inertia = {{0.005, 0.005, 0.01}} [kg.m2], com = {{0.01, 0, 0}} [m]);
  body rod = Solid(mass = 0.4 [kg], inertia = {{0.002, 0.01, 0.01}} [kg.m2], com = {{0.1, 0, 0}} [m]);
  body piston = Particle(mass = 0.5 [kg], at = {{0.2, 0, 0}} [m]);
  {}
  Gravity field;
  output Length travel = position(piston).x;
  output Energy E = energy();
  output Force held = reaction(guide).force[3];
  scene s
    simulate(stop = 2 [s]);
  end s;
end Crank;
"""


@pytest.mark.full
def test_open_and_closing_joints_rub_alike() -> None:
    """One mechanism, with another joint closing its loop: forces by virtual release and multipliers."""
    orders = ["main crankpin pin guide", "main guide pin crankpin", "main crankpin guide pin"]
    runs = []
    for order in orders:
        joints = "\n  ".join([f"joint {name} = {_JOINTS[name]};" for name in order.split()])
        model = lagc.loads(_CRANK.format(joints)).compile(backend="c")
        runs.append(model.simulate(accuracy=1e-8))
    kinds = sorted((round(event.t, 6), event.contact, event.kind) for event in runs[0].events)
    for run in runs:
        assert run.status == "ok"
        assert sorted((round(e.t, 6), e.contact, e.kind) for e in run.events) == kinds
        for name in ("travel", "E", "held"):
            assert run.final[name] == pytest.approx(runs[0].final[name], abs=1e-7)
        assert np.all(np.diff(np.array(run["E"])) <= 1e-8)
        at_rest = np.array(run["travel"])[np.array(run.t) > run.events[-1].t]
        assert len(at_rest) > 10 and np.ptp(at_rest) < 1e-12
    assert {name for _, name, kind in kinds if kind == "sticks"} == set(_JOINTS)


def test_a_slide_with_friction_stops() -> None:
    """On a slope, along its axis: |N| = m g cos is the norm of the force of the joint across the axis."""
    text = """model Slide
  parameter Angle a = 30 [deg];
  body slider = Particle(mass = 2 [kg], at = {0, 0, 0});
  joint guide = Prismatic(world, slider, axis = {cos(a), 0, sin(a)}, along = world.y, friction = 0.4,
                          slide(rate = 2 [m/s]));
  Gravity field;
  scene s
    simulate(stop = 1 [s]);
  end s;
end Slide;
"""
    run = lagc.loads(text).compile(backend="numpy").simulate(accuracy=1e-9)
    c, s = math.cos(math.radians(30.0)), 0.5
    (turns,) = run.events
    stops = 2.0 / (G * (s + 0.4 * c))
    assert turns.kind == "slips" and turns.t == pytest.approx(stops, abs=1e-11)
    assert run.final["der(guide.slide)"] == pytest.approx(-G * (s - 0.4 * c) * (1.0 - stops), abs=1e-9)


def test_painleve_klein_decides_below_the_limit() -> None:
    """N (2 cot phi + mu) = F while the masses move to the right, N (2 cot phi - mu) = F to the left."""
    run = _run("painleve_klein", "numpy")
    c = 2.0 / math.tan(math.radians(60.0))
    slows, back = 1.0 + 0.1 * 2.0 / (c + 0.2), 1.0 - 0.1 * 2.0 / (c - 0.2)
    (turns,) = run.events
    assert turns.t == pytest.approx(1.0 / slows, abs=1e-11)
    assert run.final["N"] == pytest.approx(2.0 / (c - 0.2), abs=1e-9)
    assert run.final["der(x1)"] == pytest.approx(-back * (1.0 - 1.0 / slows), abs=1e-9)


@pytest.mark.parametrize("push", [2.0, -2.0])
def test_painleve_klein_is_refused_beyond_the_limit(push: float) -> None:
    """mu tan(phi) = 2.6 > 2: two motions for F > 0, none for F < 0."""
    compiled = lagc.load("painleve_klein").compile(backend="numpy")
    run = compiled.simulate(parameters={"F": push, "mu": 1.5})
    assert run.status == "failed" and len(run.t) == 0
    assert "no solution, or several, where `guide1` touches" in run.message


@pytest.mark.full
def test_an_impact_rubs_at_the_pin() -> None:
    """A rod on a rough pin falls on a stop: it leaves with e times its speed, whatever the pin takes."""
    text = """model Door
  body rod = Solid(mass = 1 [kg], inertia = {0.1, 0.1, 0.1} [kg.m2], com = {0, 0, -0.5} [m]);
  joint pin = Revolute(world, rod, axis = world.y, at = {0, 0, 0}, friction = 0.4, radius = 0.05 [m],
                       angle(start = 60 [deg]));
  Gravity field;
  constraint stop: pin.angle >= 0 (restitution = 0.6);
  scene s
    simulate(stop = 1.4 [s]);
  end s;
end Door;
"""
    run = lagc.loads(text).compile(backend="numpy").simulate(accuracy=1e-9, points=1401)
    hit = next(event for event in run.events if event.kind == "impact")
    assert [event.kind for event in run.events[:2]] == ["slips", "impact"]
    assert hit.t == pytest.approx(0.46212779566, abs=1e-9)  # scipy, rtol 1e-12
    rates = np.array(run["der(pin.angle)"])[np.array(run.t) > hit.t]
    assert rates[0] == pytest.approx(0.6 * 3.537320696787, abs=0.05) and rates[0] > 0.0
    second = [event.t for event in run.events if event.kind == "impact"][1]
    assert second == pytest.approx(1.31949125576, abs=1e-8)


@pytest.mark.parametrize("relation", ["=", ">="])
def test_a_law_of_slip_by_stribeck(relation: str) -> None:
    """It slows a block by g (a + b exp(-v/v0)): the time of the stop is an integral over the speed."""
    text = (
        f"constraint rail: y {relation} 0 (friction = 0.1 + 0.1*exp(-abs(slip)/(0.5 [m/s])), slip = der(x));"
    )
    run = _model(text).compile(backend="numpy").simulate(3.0, accuracy=1e-9)
    expected = quad(lambda v: 1.0 / (G * (0.1 + 0.1 * math.exp(-v / 0.5))), 0.0, 3.0)[0]
    (stops,) = run.events
    assert stops.t == pytest.approx(expected, abs=1e-9)


def test_without_friction_nothing_changes() -> None:
    """The equations are those of the constraint; friction is no row of them, and its forces cost more."""
    plain = _model("constraint rail: y = 0;").compile(backend="numpy")
    rough = _model("constraint rail: y = 0 (friction = 0.1, slip = der(x));").compile(backend="numpy")
    assert rough.interface.row_labels == plain.interface.row_labels == ("rail",)
    free, rubs = (model.program.functions["rhs"].cost for model in (plain, rough))
    assert free == rubs == plain.interface.operations < rough.interface.operations
    assert not plain.interface.contacts and rough.interface.contacts[0].normals == 1


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("constraint rail: y = 0 (friction = 0.1);", "LAG0235: `friction` needs `slip` or `at` beside it"),
        ("constraint rail: y = 0 (friction = -0.1, slip = der(x));",
         "LAG0235: the friction is -0.1, and not from 0"),
        ("constraint rail: y = 0 (slip = der(x));", "LAG0235: `slip` needs `friction` beside it"),
        ("constraint rail: y = 0 (friction = 0.1, slip = x);", "LAG0302: the slip is a position; it must be"),
        ("constraint rail: der(y) = 0 (friction = 0.1, slip = der(x));",
         "LAG0235: `rail` restricts velocities"),
        ("constraint rail: {x, y} = {0, 0} (friction = 0.1, slip = der(x));",
         "LAG0235: a vector of constraints"),
        ("constraint rail: y = 0 (restitution = 0.1);", "LAG0209: a constraint with `=` has no `res"),
        ("constraint rail: y = y (friction = 0.1, slip = der(x));", "LAG0235: `rail` always holds"),
        ("constraint rail: y = 0 (friction = 0.1, slip = der(x)); constraint again: 2*y = 0;",
         "LAG0431: the friction of `rail` depends on a force that is one of many"),
        ("constraint rail: y = 0 (friction = 0.1, slip = der(x)); output Force p = impulse(rail)/(1 [s]);",
         "LAG0221: `impulse` takes a one-sided constraint"),
        ("constraint rail: y = 0 (friction = ?, slip = der(x));", "LAG0101: `?` is not a character"),
        ("constraint rail: y = 0 (bye = pull);", "LAG0209: a constraint with `=` has no `bye`"),
        ("force pull = {1 [N], 0, 0} at block; "
         "constraint rail: y = 0 (by = pull, friction = 0.1, slip = der(x));",
         "LAG0209: an actuator and friction do not combine"),
        ("force pull = {1 [N], 0, 0} at block; constraint rail: y = 0 (by = pull, by = pull);",
         "LAG0209: `by` is given once"),
        ("constraint rail: y = 0 (friction = 0.1, slip = der(x)); "
         "force drag = -0.1*reaction(rail)*world.x at block;",
         "LAG0431: `drag` depends on `reaction(rail)`, beside the friction of `rail`"),
        ("constraint rail: y = 0 (friction = 0.1, slip = der(x)); "
         "force motor = {1 [N], 0, 0} at block; constraint path: x = 3 [m/s]*time (by = motor);",
         "LAG0431: `motor` holds `path`, beside the friction of `rail`"),
    ],
)  # fmt: skip
def test_wrong_friction_is_refused(text: str, expected: str) -> None:
    assert _refused(_model(text)).startswith(expected)


@pytest.mark.parametrize(
    ("more", "expected"),
    [
        ("friction = 0.1", "LAG0235: the friction of a pin needs its `radius` beside it"),
        ("radius = 0.1 [m]", "LAG0235: `radius` needs `friction` beside it"),
        ("friction = -1, radius = 0.1 [m]", "LAG0235: the friction is -1, and not from 0"),
        ("friction = 1 [m], radius = 0.1 [m]", "LAG0302: the friction must be a number"),
    ],
)
def test_wrong_friction_of_a_joint_is_refused(more: str, expected: str) -> None:
    text = f"""model Pin
  body rod = Solid(mass = 1 [kg], inertia = {{1, 1, 1}} [kg.m2], com = {{0, 0, -1}} [m]);
  joint pin = Revolute(world, rod, axis = world.y, at = {{0, 0, 0}}, {more});
  Gravity field;
  scene s
    simulate(stop = 1 [s]);
  end s;
end Pin;
"""
    assert _refused(lagc.loads(text)).startswith(expected)


def test_methods_without_contacts_name_the_friction() -> None:
    model = _model("constraint rail: y = 0 (friction = 0.1, slip = der(x));")
    with pytest.raises(Refused, match="the friction of `rail`") as caught:
        model.compile(backend="numpy").simulate(1.0, method="taylor")
    assert caught.value.faults[0].remedy == "take dop853"


def test_linear_models_and_sensitivities_name_the_friction() -> None:
    compiled = _model("constraint rail: y = 0 (friction = 0.1, slip = der(x));").compile(backend="numpy")
    for call in (compiled.linearize, lambda: compiled.simulate(sensitivity=["start(x)"])):
        with pytest.raises(Refused, match="the friction of `rail`"):
            call()


def test_friction_of_a_joint_is_to_be_written_without_its_reaction(capsys: Any) -> None:
    """Loads do not depend on reactions of joints. The command says what the library says."""
    assert main(["linearize", "rough_pin"]) == 1
    said = capsys.readouterr().err
    assert "linear models do not follow the friction of `pin`" in said and "a smooth load" in said
    assert "reaction" not in said


CRANK = """model Crank "a slider-crank whose slider lies on a rough guide"
  parameter Length r = 0.1 [m], l = 0.3 [m];
  coordinate Angle a(start = 0.3 [rad], rate = 25 [rad/s]), b(guess = -0.1 [rad]);
  coordinate Length s(guess = 0.4 [m]), y(start = 0 [m], rate = 0 [m/s]);
  frame A = rotate_z(world, a);
  frame B = rotate_z(world, b);
  point Q = r*A.x + l*B.x;
  body crank = Solid(mass = 1 [kg], inertia = {{0.01, 0.01, 0.01}} [kg.m2], frame = A, at = {{0, 0, 0}});
  body slider = Particle(mass = 2 [kg], at = {{s, y, 0}});
  Gravity field(direction = {{0, -1, 0}});
  constraint pin: {{Q.x, Q.y}} = {{s, y}};
  constraint guide: y {} 0 [m] (friction = 0.1, slip = der(s));
  output Force N = reaction(guide);
end Crank;
"""


@pytest.mark.full
@pytest.mark.parametrize("accuracy", [1e-4, 1e-6])
def test_a_slip_passes_the_dead_centres_of_a_crank_on_a_floor_as_in_a_guide(accuracy: float) -> None:
    """A floor that always bears the slider is a guide. At a dead centre the slip is zero, and friction cannot
    stop it: to remove what round-off leaves of it would change the speed of the crank. Both are two problems
    of forces with the same motion, and take about the same steps."""
    models = (lagc.loads(CRANK.format(relation)).compile(backend="numpy") for relation in (">=", "="))
    floor, guide = (model.simulate(2.0, accuracy=accuracy) for model in models)
    assert floor.status == guide.status == "ok" and min(floor["N"]) > 0.0
    assert [event.kind for event in floor.events] == ["slips"] * 9
    for name in ("a", "der(a)"):
        errors = floor.errors[name] + guide.errors[name]
        assert np.abs(np.array(floor[name]) - guide[name]).max() <= errors
    assert floor.cost.steps <= 1.2 * guide.cost.steps
