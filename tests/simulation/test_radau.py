"""Radau IIA of order 5: damped stiff systems, constraints, events, types of reals, both backends.

References are closed forms, published numbers, SciPy's solvers on the same right-hand side, or the motion
without the stiff part.
"""

import re
import subprocess
from math import exp, pi, sqrt
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import lagc
from lagc.cli.main import main
from lagc.codegen.sizes import methods_of
from lagc.compiler import pipeline
from lagc.diagnostics.faults import Refused, Source
from lagc.lowering import linearizations
from tests.physics.references import compiled as of_reference
from tests.physics.references import read

SLIDE = """model Slide "overdamped: x' = -k/c x after 1e-6 s"
  parameter Mass m = 1e-3 [kg];
  parameter Stiffness k = 10 [N/m];
  parameter Damping c = 1e3 [N.s/m];
  coordinate Length x(start = 1 [m]);
  body b = Particle(mass = m, at = {x, 0, 0});
  potential V = 1/2*k*x^2;
  dissipation D = 1/2*c*der(x)^2;
end Slide;"""
SPRING = """model SpringPendulum "a pendulum on a stiff spring with a damper"
  parameter Stiffness k = 1e6 [N/m];
  parameter Damping c = 0 [N.s/m];
  coordinate Length r(start = 1 [m]);
  coordinate Angle theta(start = 60 [deg]);
  body bob = Particle(mass = 1 [kg], at = {r*sin(theta), 0, -r*cos(theta)});
  potential spring = 1/2*k*(r - 1 [m])^2;
  dissipation damper = 1/2*c*der(r)^2;
  Gravity field(g = 9.81 [m/s2], direction = {0, 0, -1});
end SpringPendulum;"""
PENDULUM = """model Pendulum
  parameter Angle start = 1 [rad];
  coordinate Angle theta(start = start);
  body b = Particle(mass = 1 [kg], at = {1 [m]*sin(theta), 0 [m], -1 [m]*cos(theta)});
  Gravity field(g = 9.81 [m/s2], direction = {0, 0, -1});
end Pendulum;"""
RODS = """model Rods "rod, spring, rod, spring: rods are constraints"
  parameter Length l = 0.5 [m];
  parameter Stiffness k = 1e8 [N/m];
  parameter Damping c = 2e3 [N.s/m];
  coordinate Length x1(start = l), y1, s1(start = l), x3(start = 3*l), y3, s2(start = l);
  coordinate Angle a1(start = 90 [deg]), a2(start = 90 [deg]);
  body b1 = Particle(mass = 1 [kg], at = {x1, 0, y1});
  body b2 = Particle(mass = 1 [kg], at = {x1 + s1*sin(a1), 0, y1 - s1*cos(a1)});
  body b3 = Particle(mass = 1 [kg], at = {x3, 0, y3});
  body b4 = Particle(mass = 1 [kg], at = {x3 + s2*sin(a2), 0, y3 - s2*cos(a2)});
  constraint rod1: x1^2 + y1^2 = l^2;
  constraint rod2: (x3 - x1 - s1*sin(a1))^2 + (y3 - y1 + s1*cos(a1))^2 = l^2;
  potential springs = 1/2*k*(s1 - l)^2 + 1/2*k*(s2 - l)^2;
  dissipation dampers = 1/2*c*der(s1)^2 + 1/2*c*der(s2)^2;
  Gravity field(g = 9.81 [m/s2], direction = {0, 0, -1});
end Rods;"""
FLOOR = """model Floor "a ball that comes to rest on a stiff floor"
  coordinate Length y(start = 1 [m]);
  body b = Particle(mass = 1 [kg], at = {0, y, 0});
  force contact = (if y < 0 [m] then max(0 [N], -1e5 [N/m]*y - 100 [N.s/m]*der(y)) else 0 [N])*world.y at b;
  Gravity field(g = 9.81 [m/s2], direction = {0, -1, 0});
end Floor;"""
SAMPLED = """model Sampled "a stiff drive whose goal a clause changes every quarter of a second"
  parameter Time T = 0.25 [s];
  coordinate Length x(start = 1 [m]);
  discrete Length goal(start = 0 [m]);
  discrete Time next(start = T);
  body b = Particle(mass = 1e-3 [kg], at = {x, 0, 0});
  potential V = 1/2*2e4 [N/m]*(x - goal)^2;
  dissipation D = 1/2*1e4 [N.s/m]*der(x)^2;
  when time >= next then
    reinit(goal, 1 [m] - goal);
    reinit(next, next + T);
  end when;
end Sampled;"""


IMPACT = """model Impact "a ball with a stiff damped axle that bounces"
  coordinate Length y(start = 1 [m]), u(start = 0 [m]);
  body b = Particle(mass = 1 [kg], at = {0, y, 0});
  body wheel = Particle(mass = 0.1 [kg], at = {0, y + u, 0});
  potential V = 1/2*1e8 [N/m]*u^2;
  dissipation D = 1/2*1e4 [N.s/m]*der(u)^2;
  Gravity field(g = 9.81 [m/s2], direction = {0, -1, 0});
  when y < 0 [m] then
    reinit(der(y), -0.8*der(y));
  end when;
end Impact;"""

ROD = """model Rod "a pendulum whose rod is a stiff spring with a critical damper"
  coordinate Length r(start = 1 [m]);
  coordinate Angle th(start = 60 [deg]);
  body b = Particle(mass = 1 [kg], at = r*{sin(th), 0, -cos(th)});
  force f = -(1e6 [N/m]*(r - 1 [m]) + 2e3 [N.s/m]*der(r))*{sin(th), 0, -cos(th)} at b;
  Gravity field(g = 9.81 [m/s2], direction = {0, 0, -1});
end Rod;"""


def compiled(text: str, backend: str = "numpy", **given: Any) -> Any:
    return lagc.loads(text).compile(backend=backend, **given)


def simulated(text: str, stop: float, backend: str = "numpy", points: int = 11, **given: Any) -> Any:
    return compiled(text, backend).simulate(stop, method="radau5", points=points, **given)


def test_an_overdamped_slide_follows_its_slow_motion() -> None:
    run = simulated(SLIDE, 100.0, rtol=1e-8)
    slow = (1e3 - sqrt(1e6 - 4e-2 * 1.0)) / 2e-3  # the slow root of m s^2 + c s + k
    assert run.final["x"] == pytest.approx(exp(-100.0 * slow), rel=1e-7)
    assert run.cost.rhs < 2000


@pytest.mark.parametrize("step", [0.5, 0.25])
def test_fixed_steps_far_beyond_the_border_of_stability(step: float) -> None:
    run = simulated(SLIDE, 10.0, step=step)
    assert run.status == "ok" and run.cost.steps == round(10.0 / step)
    assert run.final["x"] == pytest.approx(exp(-0.1), rel=1e-6)


@pytest.mark.parametrize("k", [1e6, pytest.param(1e8, marks=pytest.mark.full), 1e10])
def test_a_stiff_spring_pendulum(k: float) -> None:
    """To 1e-6 under 8,000 evaluations, against SciPy's LSODA on the same right-hand side or, at 1e10 N/m, a
    rigid rod: the spring yields by 1e-9."""
    model = compiled(SPRING, parameters={"k": k, "c": 0.2 * sqrt(k)})
    run = model.simulate(10.0, method="radau5", rtol=1e-6, points=2)
    assert run.status == "ok" and run.cost.rhs < 8000
    if k < 1e9:
        found = solve_ivp(model.rhs, (0.0, 10.0), model.start(), "LSODA", rtol=1e-10, atol=1e-12)
        expected = found.y[1, -1]
    else:
        rod = compiled(PENDULUM, parameters={"start": pi / 3.0})
        expected = rod.simulate(10.0, method="dop853", rtol=1e-13, points=2).final["theta"]
    assert run.final["theta"] == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize("rtol", [1e-8, 1e-10, 1e-12])
def test_no_collapse_where_round_off_is_all_that_is_left(rtol: float) -> None:
    """The increments of the Newton method are round-off of the spring force there, at all tolerances."""
    model = compiled(SPRING, parameters={"k": 1e10, "c": 2e4})
    run = model.simulate(2.0, method="radau5", rtol=rtol, points=2)
    assert run.status == "ok" and run.cost.rhs < 20_000
    rod = PENDULUM
    limit = (
        compiled(rod, parameters={"start": 60.0 * pi / 180.0})
        .simulate(2.0, method="dop853", rtol=1e-13, points=2)
        .final["theta"]
    )
    assert run.final["theta"] == pytest.approx(limit, abs=2e-8)  # the spring yields by 1e-9


def test_constraints_and_stiff_springs() -> None:
    """The rods keep their length, and the energy is in balance."""
    run = compiled(RODS).simulate(0.5, method="radau5", rtol=1e-5, points=2)
    assert run.status == "ok" and run.cost.rhs < 2000
    assert max(run.position_drift, run.velocity_drift) < 1e-12
    assert abs(run.energy.imbalance) < 1e-5


@pytest.mark.full
def test_constraints_and_stiff_springs_by_another_method() -> None:
    run = compiled(RODS).simulate(2.0, method="radau5", rtol=1e-5, points=2)
    assert run.cost.rhs < 4000
    other = compiled(RODS, "c").simulate(2.0, method="dop853", rtol=1e-9, points=2)
    assert run.final["a1"] == pytest.approx(other.final["a1"], abs=3e-6)
    assert run.final["x3"] == pytest.approx(other.final["x3"], abs=3e-6)


@pytest.mark.full
@pytest.mark.parametrize("name", ["car_axis", "andrews_squeezer"])
def test_published_mechanisms(name: str) -> None:
    """The reference solutions of the Test Set for IVP Solvers (Mazzia, Magherini 2008), both of index 3."""
    published = read(name)
    sample = published.samples[-1]
    run = of_reference(name, "numpy").simulate(
        sample.t, method="radau5", rtol=1e-8, points=2, starts=published.starts
    )
    assert run.status == "ok", run.message
    for quantity, value in sample.values.items():
        assert abs(run.final[quantity] - value) / published.scale(quantity) < 1e-5, quantity


def test_a_ball_rests_on_a_stiff_floor() -> None:
    run = simulated(FLOOR, 5.0, rtol=1e-7)
    assert run.status == "ok" and len(run.events) > 5
    assert run.final["y"] == pytest.approx(-9.81e-5, rel=1e-5)
    explicit = compiled(FLOOR).simulate(5.0, method="dop853", rtol=1e-11)
    first = [event.t for event in explicit.events][:4]
    assert [event.t for event in run.events][:4] == pytest.approx(first, abs=1e-5)


def test_clauses_and_discrete_variables() -> None:
    run = simulated(SAMPLED, 0.9, rtol=1e-8, points=10)
    x = 1.0
    for goal in (0.0, 1.0, 0.0):
        x = goal + (x - goal) * exp(-2.0 * 0.25)
    assert run.final["x"] == pytest.approx(1.0 + (x - 1.0) * exp(-2.0 * 0.15), rel=1e-5)


def test_recorded_times_lie_on_the_collocation_polynomial() -> None:
    """They do not change the steps, and their errors are those of the tolerance."""
    few, many = (simulated(SLIDE, 10.0, rtol=1e-8, points=n) for n in (2, 301))
    assert few.cost.steps == many.cost.steps and few.final["x"] == many.final["x"]
    times = np.array(many.times)
    assert np.abs(np.array(many["x"]) - np.exp(-1e-2 * times)).max() < 1e-6


@pytest.mark.full
@pytest.mark.parametrize("text", [SPRING, RODS, FLOOR, SAMPLED], ids=["spring", "rods", "floor", "sampled"])
def test_c_and_python_have_the_same_bits(text: str) -> None:
    one, two = (simulated(text, 0.3, backend, points=31, rtol=1e-6) for backend in ("c", "numpy"))
    assert one.states == two.states and one.cost.rhs == two.cost.rhs


def test_calls_of_any_length_give_one_motion() -> None:
    """A trajectory of single steps is that of one call, to the bit."""
    compilation = pipeline.Compilation(Source("spring.lag", SPRING), pipeline.Choice(parameters={"c": 200.0}))
    ((_, text),) = pipeline.render(
        pipeline.delivered(compilation, pipeline.Contents(["radau5"])), "numpy"
    ).items()
    space: dict[str, Any] = {}
    exec(text, space)
    ends = []
    for single in (False, True):
        options = space["Options"](method="radau5", rtol=1e-6)
        equations = space["Equations"](space["default_params"]())
        run = space["Integrator"](equations, options, 0.0, [1.0, 1.0, 0.0, 0.0])
        if not single:
            assert run.advance(0.3) == 0
        while run.t < 0.3:
            assert run.step(0.3) == 0
        ends.append((run.t, run.x, run.steps, run.rejected, run.rhs))
    assert ends[0] == ends[1]


def test_derivatives_by_columns_are_those_by_entries(monkeypatch: pytest.MonkeyPatch) -> None:
    """Large models derive the equations along one direction after the other."""
    compilation = pipeline.Compilation(Source("rods.lag", RODS), pipeline.Choice())
    found = []
    for most in (linearizations.MOST, -1):
        monkeypatch.setattr(linearizations, "MOST", most)
        program = pipeline.delivered(compilation, pipeline.Contents(["radau5"]))
        assert ("newton_column" in program.functions) == (most < 0)
        space: dict[str, Any] = {}
        exec("".join(pipeline.render(program, "numpy").values()), space)
        run = space["Integrator"](
            space["Equations"](space["default_params"]()), space["Options"](method="radau5", rtol=1e-6), 0.0,
            [0.5, 0.0, 0.5, 1.5, 0.0, 0.5, pi / 2.0, pi / 2.0, *[0.0] * 8],
        )  # fmt: skip
        assert run.step(0.1) == 0
        found.append((run.t, run.newton.slopes[:], run.newton.mass[:], run.x))
    assert found[0][0] == found[1][0]
    for one, two in zip(found[0][1:], found[1][1:]):
        scale = max(map(abs, one))
        assert max(abs(a - b) for a, b in zip(one, two)) <= 1e-14 * scale


def test_models_carry_it_only_when_asked() -> None:
    source = Source("spring.lag", SPRING)
    plain, stiff = (
        pipeline.delivered(pipeline.Compilation(source, pipeline.Choice()), pipeline.Contents(m))
        for m in (["dop853"], ["radau5"])
    )
    assert "radau5" not in methods_of(plain.interface) and "radau5" in methods_of(stiff.interface)
    texts = ["".join(pipeline.render(program, "c").values()).lower() for program in (plain, stiff)]
    assert "radau" not in texts[0] and "newton" not in texts[0] and "radau5" in texts[1]


@pytest.mark.full
@pytest.mark.parametrize("real, digits", [("float", 2e-3), ("double", 2e-5), ("quad", 2e-5)])
def test_generated_c_of_any_type(real: str, digits: float, tmp_path: Path) -> None:
    (tmp_path / "rods.lag").write_text(RODS)
    given = ["--method", "radau5", "--real", real, "-o", str(tmp_path), "-q"]
    assert main(["build", str(tmp_path / "rods.lag"), *given]) == 0
    (tmp_path / "main.c").write_text("""#include "rods.h"
#include <stdio.h>
static rods_work w; static rods_state s; static rods_start_work c;
int main(void) {
    rods_params p = rods_default_params();
    rods_bind(&p);
    rods_options o = rods_default_options();
    o.method = RODS_RADAU5;
    o.rtol = 1e-4;
    rods_real x[RODS_NX];
    rods_start(&p, x);
    rods_consistent(&p, 0, x, 0, &c);
    rods_begin(&s, 0, x);
    int status = rods_advance(&p, &s, 0.5, &o, &w);
    printf("%d %.17g\\n", status, (double)s.x[RODS_Q_x3]);
    return 0;
}
""")  # fmt: skip
    sources = [str(tmp_path / "main.c"), str(tmp_path / "rods.c")]
    flags = ["-std=gnu99", "-Wall", "-Werror", "-O1", *sources, "-o", str(tmp_path / "a")]
    flags += ["-lquadmath", "-lm"]
    subprocess.run(["cc", *flags], check=True)
    status, x3 = subprocess.run([str(tmp_path / "a")], check=True, capture_output=True).stdout.split()
    expected = compiled(RODS, "c").simulate(0.5, method="dop853", rtol=1e-9, points=2).final["x3"]
    assert int(status) == 0 and float(x3) == pytest.approx(expected, abs=digits)


def test_a_verified_run_by_this_method() -> None:
    run = compiled(SLIDE).simulate(10.0, accuracy=1e-6, method="radau5")
    assert run.status == "ok" and run.method == "radau5" and run.estimated <= 1e-6
    assert run.final["x"] == pytest.approx(exp(-0.1), rel=1e-6)


def test_a_default_run_that_stability_limits_takes_it() -> None:
    run = compiled(SLIDE).simulate(100.0)
    assert run.status == "ok" and run.method == "radau5"
    assert any("stability limits" in note for note in run.notes)
    assert run.final["x"] == pytest.approx(exp(-1.0), rel=1e-6)


@pytest.mark.full
def test_a_run_that_misses_its_accuracy_by_stability_takes_it() -> None:
    """The length of the rod is at the border of stability."""
    run = compiled(ROD, "c").simulate(10.0, accuracy=1e-6)
    assert run.status == "ok" and run.method == "radau5"
    assert abs(run.energy.imbalance) < 1e-7
    other = compiled(ROD, "c").simulate(10.0, accuracy=1e-8, method="radau5")
    for name in ("r", "th"):
        assert abs(run[name] - other[name]).max() <= 2e-6 * run.scales[name]


@pytest.mark.full
def test_round_off_at_the_border_of_stability_has_no_accuracy_to_miss() -> None:
    """The spring at rest is moved by round-off alone; the ball bounces with 0.8 of its speed."""
    run = compiled(IMPACT, "c").simulate(2.0, accuracy=1e-5)
    assert run.status == "ok" and run.scales["u"] == 0.0 and run.cost.rhs < 10_000
    fall = sqrt(2.0 / 9.81)
    assert [event.t for event in run.events[:2]] == pytest.approx([fall, 2.6 * fall], rel=1e-6)


@pytest.mark.full
def test_undamped_stiff_motion_stays_explicit() -> None:
    """Nothing decays: an implicit method would have to follow the vibration as well."""
    run = compiled(SPRING, "c").simulate(20.0, parameters={"k": 1e8, "c": 0.0}, accuracy=1e-3)
    assert run.method != "radau5"


@pytest.mark.parametrize(
    "given, words",
    [
        ({"sensitivity": "k"}, "explicit Runge-Kutta methods only"),
        ({"rtol": 1e-6, "accuracy": 1e-6}, "chooses the tolerance"),
    ],
)
@pytest.mark.parametrize("method", ["radau5", "taylor"])
def test_refusals(method: str, given: dict[str, Any], words: str) -> None:
    with pytest.raises(Refused, match=re.escape(words)):
        compiled(SLIDE).simulate(1.0, method=method, **given)


@pytest.mark.full
def test_the_error_follows_the_tolerance_where_one_iteration_is_enough() -> None:
    """A ratio of convergence from many steps ago is not trusted: errors stayed at 1e-6 then."""
    double_pendulum = lagc.load("double_pendulum").compile(backend="c")
    exact = double_pendulum.simulate(10, method="dop853", rtol=1e-14, points=21)
    errors = []
    for rtol in (1e-6, 1e-8, 1e-10):
        run = double_pendulum.simulate(10, method="radau5", rtol=rtol, points=21)
        errors.append(max(np.ptp(run[q] - exact[q]) / np.ptp(exact[q]) for q in ("theta1", "theta2")))
    assert errors[0] < 1e-5 and errors[1] < 1e-7 and errors[2] < 3e-9
