"""Clauses `when`: at the moment that a condition becomes true, and as exactly as the motion itself."""

import math
from pathlib import Path
from typing import Any

import pytest
from numpy.polynomial import Polynomial

import lagc
from lagc.cli.main import main
from lagc.codegen.python.emit import render
from lagc.kernels.language.statuses import INTERRUPTED, OK, TERMINATED
from lagc.simulation.system import Options
from tests.codegen.tools import STRICT, call
from tests.simulation.events.jumping import STOP, case, motion

pytestmark = pytest.mark.usefixtures("no_cache")
ROUNDOFF = 1e-12  # relative: of the times of events
TIMES = [STOP * k / 7 for k in range(8)]


@pytest.mark.full
@pytest.mark.parametrize("first", range(0, 60, 15))
def test_walls_kicks_limits(first: int) -> None:
    """No true error is above the estimate, but for round-off of a few events, no estimate above what was
    asked, every event is found."""
    known = 0
    for seed in range(first, first + 15):
        exact = motion(case(seed), TIMES)
        if exact is None:
            continue
        known += 1
        accuracy = 10.0 ** -(4 + seed % 7)
        run = lagc.loads(case(seed).text).compile(backend="numpy").simulate(STOP, points=8, accuracy=accuracy)
        assert run.status == "ok", run.message
        states, events = exact
        assert run.estimated is not None and run.estimated <= accuracy
        for i, name in enumerate(("x", "der(x)")):
            error = max(abs(state[i] - value) for state, value in zip(states, run[name]))
            assert error <= run.errors[name] + ROUNDOFF * run.scales[name], (seed, name)
        assert [e.t for e in run.events] == pytest.approx([float(t) for t in events], abs=10.0 * accuracy)
        energy = run.energy
        assert abs(energy.imbalance) <= 100.0 * accuracy * max(energy.start, energy.end, abs(energy.work))
    assert known > 10


@pytest.mark.sample(1)
@pytest.mark.parametrize("seed", [1, 4, 9])
def test_both_backends_are_equal_to_the_bit(seed: int) -> None:
    runs = [
        lagc.loads(case(seed).text).compile(backend=backend).simulate(STOP, points=8, accuracy=1e-8)
        for backend in ("numpy", "c")
    ]
    assert runs[0].states == runs[1].states and runs[0].cost.rhs == runs[1].cost.rhs
    assert runs[0].events == runs[1].events != ()


def model(whens: str, start: str = "x(start = 0 [m], rate = 1 [m/s])", more: str = "") -> lagc.CompiledModel:
    return lagc.loads(
        f"model M\n  coordinate Length {start};\n  body b = Particle(mass = 2 [kg], at = {{x, 0, 0}});\n"
        f"  {more}\n  {whens}\nend M;"
    ).compile(backend="numpy")


def test_what_comes_true_at_one_moment_acts_in_order() -> None:
    """(1 + 1)*2, not 1*2 + 1; values of one clause are all of the state before it."""
    run = model(
        "when time > 1 [s] then reinit(der(x), der(x) + 1 [m/s]); end when;\n"
        "when time >= 1 [s] then reinit(der(x), 2*der(x)); end when;\n"
        "when time > 2 [s] then reinit(x, der(x)*1 [s]); reinit(der(x), x/(1 [s])); end when;"
    ).simulate(3.0, every=1.0)
    assert [*run["der(x)"]] == pytest.approx([1.0, 4.0, 5.0, 5.0])
    assert [*run["x"]] == pytest.approx([0.0, 1.0, 4.0, 9.0])
    assert run.energy.work == pytest.approx(0.5 * 2.0 * (25.0 - 1.0))


def test_what_a_clause_makes_true_acts_too() -> None:
    run = model(
        'when x > 1 [m] then reinit(x, 5 [m]); mark("far"); end when;\n'
        'when x > 4 [m] then reinit(der(x), 0); mark("still"); end when;'
    ).simulate(3.0)
    assert [(e.t, e.name) for e in run.events] == [(pytest.approx(1.0), "far"), (pytest.approx(1.0), "still")]
    assert run["x"][-1] == pytest.approx(5.0)


def test_what_holds_from_the_start_on_does_not_come_true() -> None:
    run = model('when x < 1 [m] then terminate("near"); end when;').simulate(1.5)
    assert run.status == "ok" and not run.events
    back = model('when x < 1 [m] then terminate("near"); end when;', more="force f = {-2 [N], 0, 0} at b;",
                 start="x(start = 0 [m], rate = 2 [m/s])").simulate(9.0)  # fmt: skip
    assert back.status == "terminated" and back.t[-1] == pytest.approx(2.0 + math.sqrt(2.0), rel=1e-6)


@pytest.mark.parametrize("base", ["x", "x + 1e-9 [m]"])
def test_a_power_of_what_dips_below_zero(base: str) -> None:
    """x = 10 - 4.7 t + t^2/2 comes to -1 at 4.4 and is back at 5; only its value tells that n is whole."""
    run = model(
        f'when (({base})/(1 [m]))^n < -1 then terminate("low"); end when;',
        start="x(start = 10 [m], rate = -4.7 [m/s])",
        more="parameter Real n = 3; force f = {2 [N], 0, 0} at b;",
    ).simulate(12.0)
    assert run.status == "terminated" and run.t[-1] == pytest.approx(4.4, abs=1e-6)


@pytest.mark.parametrize("condition", ["exp(x/(1 [m])) > 1e97", "1e-97*exp(x/(1 [m])) > 1"])
def test_numbers_beyond_those_of_which_enclosures_know(condition: str) -> None:
    """x = 30 t - t^2 comes to 97 log(10) at 15 less the root of 225 less that."""
    run = model(
        f'when {condition} then terminate("large"); end when;',
        start="x(start = 0 [m], rate = 30 [m/s])",
        more="force f = {-4 [N], 0, 0} at b;",
    ).simulate(40.0)
    assert run.status == "terminated"
    assert run.t[-1] == pytest.approx(15.0 - math.sqrt(225.0 - 97.0 * math.log(10.0)), abs=1e-6)


@pytest.mark.sample(1)
@pytest.mark.parametrize(
    ("method", "rtol", "v", "force", "below"),
    [
        ("dop853", 1e-6, -1.0, (0.985009293, -0.659445209, 0.12954891, -0.00763851424), -1.060075),
        ("dop853", 1e-4, -0.0414577882, (0.217301629, -0.480199030, 0.173358771, -0.0147631455), -0.659956),
        ("dopri5", 1e-6, 0.433660142, (-1.28893523, 0.685232903, -0.067713335), -2.791648),
        ("dop853", 1e-6, 1.0, (-1.82798145, 1.21254517, -0.219356629, 0.0119479956), -2.381747),
        ("dopri5", 1e-6, -0.0376075927, (0.0487605271, -0.0395883152, 0.00758825424), -0.0206760),
    ],
)
def test_a_dip_within_one_long_step(
    method: str, rtol: float, v: float, force: tuple[float, ...], below: float
) -> None:
    """Steps of a polynomial are as long as it likes; whether x dips within one no cubic tells."""
    terms = " + ".join(f"({a!r})*(time/(1 [s]))^{k}" for k, a in enumerate(force))
    run = model(
        f'when x < {below!r} [m] then terminate("low"); end when;',
        start=f"x(start = 0 [m], rate = {v!r} [m/s])",
        more=f"force f = {{2 [N]*({terms}), 0, 0}} at b;",
    ).simulate(10.0, method=method, rtol=rtol)
    motion = Polynomial([-below, v, *(a / ((k + 1) * (k + 2)) for k, a in enumerate(force))])
    first = min(t.real for t in motion.roots() if t.imag == 0.0 and t.real > 0.0)
    assert run.status == "terminated" and run.t[-1] == pytest.approx(first, abs=1e-3)


@pytest.mark.parametrize(("relation", "fires"), [("<", True), ("<=", False)])
def test_a_start_on_the_change(relation: str, fires: bool) -> None:
    """x < 0 becomes true as it leaves 0; x <= 0 holds already."""
    run = model(
        f"when x {relation} 0 then reinit(der(x), -der(x)); end when;", start="x(rate = -1 [m/s])"
    ).simulate(1.0)
    assert run["x"][-1] == pytest.approx(1.0 if fires else -1.0)


@pytest.mark.sample(1)
@pytest.mark.parametrize("backend", ["numpy", "c"])
def test_a_run_ends_where_a_clause_says_so(backend: str) -> None:
    """The time is as exact as the motion, the last state is that of it."""
    run = lagc.loads(
        "model M\n  coordinate Length y(start = 1 [m]), x(rate = 2 [m/s]);\n"
        "  Gravity field(g = 10 [m/s2], direction = {0, -1, 0});\n"
        "  body b = Particle(mass = 1 [kg], at = {x, y, 0});\n"
        '  when y < 0 then terminate("it hit the ground"); end when;\nend M;'
    ).compile(backend=backend).simulate(3.0, every=0.1, accuracy=1e-9)  # fmt: skip
    assert run.status == "terminated" and "it hit the ground" in run.message
    assert run.t[-1] == pytest.approx(math.sqrt(0.2), rel=1e-9) and len(run) == 6
    assert run["x"][-1] == pytest.approx(2.0 * math.sqrt(0.2), rel=1e-9)
    assert run["der(y)"][-1] == pytest.approx(-math.sqrt(20.0), rel=1e-9)
    assert run.estimated is not None and run.estimated <= 1e-9


PENDULUM = """model P
  coordinate Length x(start = 1 [m]), y;
  Gravity field(g = 10 [m/s2], direction = {0, -1, 0});
  body b = Particle(mass = 1 [kg], at = {x, y, 0});
  constraint rod: x^2 + y^2 = 1 [m2];
  when x < 0 then %s end when;
end P;"""


@pytest.mark.full
def test_new_values_meet_the_constraints() -> None:
    """Thrown back at the lowest point it comes to where it began, as often as it likes."""
    back = lagc.loads(PENDULUM % "reinit({der(x), der(y)}, {-der(x), -der(y)});").compile(backend="numpy")
    run = back.simulate(6.0, points=2001, accuracy=1e-8)
    assert run.status == "ok" and len(run.events) == 5
    assert run.energy.imbalance == pytest.approx(0.0, abs=1e-6)
    assert min(run["x"]) > -1e-6 and max(run["x"]) <= 1.0 + 1e-9
    gaps = [b.t - a.t for a, b in zip(run.events, run.events[1:])]
    assert gaps == pytest.approx([2.0 * run.events[0].t] * 4, rel=1e-7)


def test_new_values_that_do_not_are_refused() -> None:
    run = lagc.loads(PENDULUM % "reinit(der(y), 1 [m/s]);").compile(backend="numpy").simulate(6.0)
    assert run.status == "failed" and "do not meet the constraints" in run.message
    assert run.t[-1] > 0.5


@pytest.mark.full
@pytest.mark.parametrize("restitution", [0.5, 0.8, 0.95])
def test_bounces_that_are_ever_shorter_are_followed_to_the_end_of_numbers(restitution: float) -> None:
    """They come to t_1 (1 + e)/(1 - e), and no ball falls through."""
    run = model(
        f"when x < 0 then reinit(der(x), -{restitution!r}*der(x)); end when;",
        start="x(start = 1 [m])", more="Gravity field(g = 10 [m/s2], direction = {-1, 0, 0});",
    ).simulate(40.0)  # fmt: skip
    first = math.sqrt(0.2)
    ends = first * (1.0 + restitution) / (1.0 - restitution)
    assert run.status == "failed" and "bounces" in run.message
    assert run.events[-1].t == pytest.approx(ends, rel=1e-11)
    assert min(run["x"]) > -1e-12


def test_a_declared_speed_takes_a_new_value() -> None:
    text = (
        "model M\n  coordinate Length x;\n  speed Velocity u(start = 1 [m/s]) = 2*der(x);\n"
        "  body b = Particle(mass = 1 [kg], at = {x, 0, 0});\n  when x > 1 [m] then %s end when;\nend M;"
    )
    run = lagc.loads(text % "reinit(u, -u);").compile(backend="numpy").simulate(4.0)
    assert run["x"][-1] == pytest.approx(0.0, abs=1e-6) and run["u"][-1] == pytest.approx(-1.0)
    with pytest.raises(lagc.Refused, match="LAG0427"):
        lagc.loads(text % "reinit(der(x), 0);").compile()


def test_a_body_that_turns_takes_a_new_angular_velocity() -> None:
    run = lagc.loads(
        "model M\n  coordinate Orientation o(rate = {0, 0, 1} [rad/s]);\n"
        "  frame F = rotate(world, o);\n"
        "  body b = Solid(mass = 1 [kg], inertia = {1, 2, 3} [kg.m2], com = {0, 0, 0}, frame = F);\n"
        "  when time > 1 [s] then reinit(o.rate, {0, 0, -2} [rad/s]); end when;\nend M;"
    ).compile(backend="numpy").simulate(2.0)  # fmt: skip
    assert run["o.rate.z"][-1] == pytest.approx(-2.0)
    assert run["o.z"][-1] == pytest.approx(math.sin(-0.5), rel=1e-6)  # half of 1 - 2


def test_clauses_of_effects_loops_and_instances() -> None:
    text = (
        "model Ball\n  parameter Length floor_ = 0;\n  coordinate Length x(start = 1 [m]);\n"
        "  body b = Particle(mass = 1 [kg], at = {x, 0, 0});\n"
        "  when x < floor_ then reinit(der(x), -der(x)); end when;\nend Ball;\n"
        "model M\n  Gravity field(g = 10 [m/s2], direction = {-1, 0, 0});\n  Ball one;\n"
        "  Ball other(floor_ = 0.5 [m]);\n"
        '  effect stop when time > 0.6 [s] then terminate("time"); end when; end stop;\n'
        '  for k in 1:3 loop when time > k*0.2 [s] then mark("tick"); end when; end for;\n'
        "  scene free;\n  scene short uses stop;\nend M;"
    )
    run = lagc.loads(text).compile(backend="numpy").simulate(1.0)
    assert run.status == "ok"
    ticks = [e.t for e in run.events if e.name == "tick"]
    assert ticks == pytest.approx([0.2, 0.4, 0.6])
    bounces = sorted(e.t for e in run.events if e.name != "tick")
    assert bounces == pytest.approx([math.sqrt(0.1), math.sqrt(0.2), 3.0 * math.sqrt(0.1)], rel=1e-6)
    short = lagc.loads(text).compile("short", backend="numpy").simulate(1.0)
    assert short.status == "terminated" and short.t[-1] == pytest.approx(0.6)


HEAD = (
    "model M\n  coordinate Length x(rate = 1 [m/s]);\n  body b = Particle(mass = 1 [kg], at = {x, 0, 0});\n"
)


def built(text: str, folder: Path) -> dict[str, str]:
    folder.mkdir()
    (folder / "m.lag").write_text(text)
    assert main(["build", str(folder / "m.lag"), "-o", str(folder / "c"), "-q"]) == 0
    return {path.name: path.read_text() for path in (folder / "c").iterdir()}


def test_what_is_not_there_costs_nothing(tmp_path: Path) -> None:
    """A clause of an effect that is not used leaves no trace in the generated code."""
    effect = "  effect e when x > 1 [m] then reinit(x, 0); end when; end e;\n"
    codes = [built(f"{HEAD}{more}end M;", tmp_path / name) for name, more in (("a", ""), ("b", effect))]
    assert codes[0] == codes[1]
    assert "reinit" not in str(codes) and "acted" not in str(codes)


MAIN = """
#include <stdio.h>
#include "m.h"
static m_work w;
static m_state s;
int main(void)
{
    const m_params p = m_default_params();
    m_options o = m_default_options();
    const double x[M_NX] = {0.0, 1.0};
    int status;
    m_begin(&s, 0.0, x);
    o.report = 1;
    do {
        status = m_advance(&p, &s, 9.0, &o, &w);
        printf("%d %.15g %d %d\\n", status, s.t, s.acts, s.acted[0]);
    } while (status == M_INTERRUPTED);
    return 0;
}
"""


@pytest.mark.full
def test_c_stops_where_clauses_act(tmp_path: Path) -> None:
    """x = t to 1, whence it is thrown back at twice the speed, to -1 at 2."""
    whens = (
        "  when x > 1 [m] then reinit(der(x), -2*der(x)); end when;\n"
        '  when x < -1 [m] then terminate("there"); end when;\n'
    )
    built(f"{HEAD}{whens}end M;", tmp_path / "m")
    (tmp_path / "main.c").write_text(MAIN)
    folder = tmp_path / "m" / "c"
    call("gcc", "-std=c99", *STRICT, "-fsanitize=address,undefined", "-I", folder, folder / "m.c",
         tmp_path / "main.c", "-o", tmp_path / "main", "-lm")  # fmt: skip
    lines = [line.split() for line in call(tmp_path / "main").splitlines()]
    ended, interrupted = int(TERMINATED), int(INTERRUPTED)
    assert [int(line[0]) for line in lines] == [*[interrupted] * (len(lines) - 1), ended]
    acts = [(float(t), int(k)) for _, t, count, k in lines if count == "1"]
    assert acts[0] == (pytest.approx(1.0), 0) and acts[-1] == (pytest.approx(2.0), 1)


@pytest.mark.full
def test_a_clock_comes_to_its_own_amplitude() -> None:
    """Its speed after a tick tends to k/(1 - exp(-2 pi d/sqrt(1 - d^2))), as fast as that power of it."""
    system = lagc.load("classic/clock").compile(backend="numpy")
    run = system.simulate(40.0, accuracy=1e-9, points=2)
    lost, ticks = math.exp(-2.0 * math.pi * 0.05 / math.sqrt(1.0 - 0.05**2)), len(run.events)
    period = 1.0 / math.sqrt(1.0 - 0.05**2)
    assert [e.t for e in run.events] == pytest.approx([n * period for n in range(ticks)], rel=1e-8, abs=1e-12)
    after = 0.2 / (1.0 - lost) + (0.4 - 0.2 / (1.0 - lost)) * lost ** (ticks - 1)
    energy = system.simulate(run.events[-1].t + 1e-9, accuracy=1e-9, points=2)["E"][-1]
    assert energy == pytest.approx(0.5 * after**2, rel=1e-6)


@pytest.mark.sample(2)
@pytest.mark.parametrize("floor", [0.1, -0.5, 1e6])
@pytest.mark.parametrize("restitution", [0.2, 0.5, 0.8])
def test_no_ball_falls_through_a_floor_that_is_elsewhere(floor: float, restitution: float) -> None:
    """There, bounces end in last places of the height, long before those of the time."""
    action = f"when x < {floor!r} [m] then reinit(der(x), -{restitution!r}*der(x)); end when;"
    run = model(
        action, start=f"x(start = {floor!r} [m] + 1 [m])",
        more="Gravity field(g = 10 [m/s2], direction = {-1, 0, 0});",
    ).simulate(20.0)  # fmt: skip
    ends = math.sqrt(0.2) * (1.0 + restitution) / (1.0 - restitution)
    places = math.sqrt(max(1.0, abs(floor)) * 2.0**-52)  # of the time in which so little is fallen
    assert run.status == "failed" and "bounces" in run.message
    assert run.events[-1].t == pytest.approx(ends, abs=100.0 * places)
    assert min(run["x"]) > floor - 1e-9 * max(1.0, abs(floor))


@pytest.mark.parametrize("accuracy", [1e-4, 1e-5, 1e-7])
def test_a_clause_acts_again_at_the_same_moment(accuracy: float) -> None:
    """A wall that halves the speed; what is too slow is thrown back, into the wall, which halves it again."""
    run = model(
        "when x > 0.3 [m] then reinit(der(x), -0.5*der(x)); end when;\n"
        "when abs(der(x)) < 0.6 [m/s] then reinit(der(x), -der(x)); end when;"
    ).simulate(1.0, accuracy=accuracy)
    assert [e.name for e in run.events].count("when x > 0.3 [m]") == 2 and len(run.events) == 3
    assert run["x"][-1] == pytest.approx(0.3 - 0.7 * 0.25) and run["der(x)"][-1] == pytest.approx(-0.25)


@pytest.mark.parametrize("stop", [3.0 - 1e-9, 3.0, 3.0 + 1e-9])
def test_an_end_beside_an_event(stop: float) -> None:
    """|x - 1| = 1 - |t mod 2 - 1|: it bounces at 1, 3, 5."""
    run = model(
        "when x > 1 [m] then reinit(der(x), -der(x)); end when;\n"
        "when x < -1 [m] then reinit(der(x), -der(x)); end when;"
    ).simulate(stop)
    assert run.status == "ok" and abs(run["x"][-1]) == pytest.approx(1.0)


def test_what_time_brings_at_the_end_is_done() -> None:
    run = model('when time >= 2 [s] then terminate("now"); end when;').simulate(2.0)
    assert run.status == "terminated" and run.t[-1] == 2.0


def test_what_was_recorded_before_an_end_is_kept() -> None:
    """One step leads to the event, over 99 points."""
    run = model("when x > 1 [m] then reinit(der(x), sqrt(0.5 - x/(1 [m]))*1 [m/s]); end when;").simulate(
        3.0, every=0.01
    )
    assert run.status == "failed" and "not finite" in run.message
    assert run.t[-1] >= 0.99


def test_a_table_in_a_condition() -> None:
    run = model(
        'when table(time, {0, 1, 2, 3} [s], {0, 2, 0, 2} [N]) > 1 [N] then mark("up"); end when;'
    ).simulate(3.0)
    assert [e.t for e in run.events] == pytest.approx([0.5, 2.5])


def test_what_an_act_moves_away_is_not_at_its_change() -> None:
    """y = 0.25 + t to 0.3, whence back to 0.1, which makes it faster by a half, again and again."""
    run = model(
        "when x > 0.3 [m] then reinit(x, x - 0.2 [m]); end when;\n"
        "when x < 0.2 [m] then reinit(der(x), 1.5*der(x)); end when;",
        start="x(start = 0.25 [m], rate = 1 [m/s])",
    ).simulate(0.15, points=3)
    assert [*run["x"]] == pytest.approx([0.25, 0.1375, 0.25], abs=1e-6) and len(run.events) == 2


@pytest.mark.sample(2)
@pytest.mark.parametrize("floor", [0.0, 0.1, 10.0])
def test_an_input_that_changes_at_events_moves_no_ball(floor: float) -> None:
    """What the caller gives at a moment of an act does not let it act twice."""
    text = (
        f"model M\n  input Force u = 0;\n  coordinate Length x(start = {floor!r} [m] + 1 [m]);\n"
        "  body b = Particle(mass = 1 [kg], at = {x, 0, 0});\n  force f = {u - 10 [N], 0, 0} at b;\n"
        f"  when x < {floor!r} [m] then reinit(der(x), -0.9*der(x)); end when;\nend M;"
    )
    module: dict[str, Any] = {}
    exec(render(lagc.loads(text).compile().program, complete=False)["m.py"], module)
    problem = module["Equations"]([0.0])
    run = module["Integrator"](problem, module["Options"](rtol=1e-10), 0.0, [floor + 1.0, 0.0, 0.0])
    bounces = 0
    while run.t < 3.0:
        assert run.step(3.0) == 0
        if run.acts:
            bounces += run.jumps > bounces
            problem.p[0] = 0.1 * (bounces % 2)
    assert run.jumps == bounces > 2 and run.x[0] > floor - 1e-9


def test_what_constraints_tie_and_is_not_given_is_told() -> None:
    text = """model M
      coordinate Length x(start = 0.6 [m], rate = 0.4 [m/s]), z(start = 0.8 [m], rate = -0.3 [m/s]);
      body b = Particle(mass = 1 [kg], at = {x, 0, z});
      constraint circle: x^2 + z^2 = 1 [m2];
      when time > 0.5 [s] then reinit(der(x), 2 [m/s]); end when;
    end M;"""
    run = lagc.loads(text).compile(backend="numpy").simulate(1.0)
    assert run.status == "failed"
    assert "leaves `der(z)` unchanged, which constraint `circle` may couple to them" in run.message


class Unread(float):
    """What nobody may look at."""

    def __eq__(self, other: object) -> bool:
        raise AssertionError("read before it was written")

    __hash__ = None  # type: ignore[assignment]


def test_a_first_step_that_fails_leaves_nothing_that_counts() -> None:
    """In C the parameters of a step that was not made are whatever lies there."""
    model = lagc.loads(
        "model M\n  parameter Real a = 0.5;\n  coordinate Real x(rate = 1 [1/s]);\n"
        "  body b = Particle(mass = 1 [kg], at = {x, 0, 0}*1 [m]);\n"
        "  force f = {(if x > a then -2 else sin(x))*1 [N], 0, 0} at b;\nend M;"
    ).compile(backend="numpy")
    system = model.differentiated()
    options = Options(method="dop853", rtol=1e-9, first_step=50.0, max_steps=1)
    s = system.model.module["Integrator"](system.equations(), options, 0.0, system.start())
    assert s.step(60.0) not in (OK, TERMINATED) and s.steps == 0
    s.p[:] = [Unread(1.0)] * len(s.p)
    s.options.max_steps = 0
    assert s.step(1.0) == OK and s.steps == 1
