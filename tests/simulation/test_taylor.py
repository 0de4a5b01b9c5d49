"""Taylor series: recurrences, orders, long motions, constraints, events, both backends.

References are closed forms, conservation laws, the motion in other coordinates, or DOP853 at a tolerance
near machine precision.
"""

import re
import subprocess
from math import atan, cos, pi, sqrt
from pathlib import Path
from typing import Any

import mpmath
import pytest

import lagc
from lagc.cli.main import main
from lagc.codegen.sizes import methods_of
from lagc.compiler import pipeline
from lagc.diagnostics.faults import Refused, Source
from lagc.kernels import METHODS
from lagc.simulation import simulate

SPRING = """model Spring
  parameter Stiffness k = 4 [N/m];
  coordinate Length x(start = 1 [m]);
  body b = Particle(mass = 1 [kg], at = {x, 0, 0});
  potential V = 1/2*k*x^2;
end Spring;"""
KEPLER = """model Kepler "an orbit of eccentricity 0.6 and period 2 pi"
  coordinate Length x(start = 0.4 [m]), y(start = 0 [m]);
  body b = Particle(mass = 1 [kg], at = {x, y, 0});
  potential V = -1 [J.m]/sqrt(x^2 + y^2);
initial
  der(x) = 0 [m/s];
  der(y) = 2 [m/s];
end Kepler;"""
PENDULUM = """model Pendulum
  coordinate Angle theta(start = 1 [rad]);
  body b = Particle(mass = 1 [kg], at = {1 [m]*sin(theta), 0 [m], -1 [m]*cos(theta)});
  Gravity field(g = 9.81 [m/s2], direction = {0, 0, -1});
end Pendulum;"""
PLANE = """model Plane "the same pendulum with a rod as a constraint"
  coordinate Length x(start = sin(1) * 1 [m]), z(start = -cos(1) * 1 [m]);
  body b = Particle(mass = 1 [kg], at = {x, 0, z});
  constraint rod: x^2 + z^2 = 1 [m2];
  Gravity field(g = 9.81 [m/s2], direction = {0, 0, -1});
end Plane;"""
BALL = """model Ball "bounces with 0.8 of its speed"
  coordinate Length y(start = 1 [m]);
  body b = Particle(mass = 1 [kg], at = {0, y, 0});
  Gravity field(g = 9.81 [m/s2], direction = {0, -1, 0});
  when y < 0 [m] then
    reinit(der(y), -0.8*der(y));
  end when;
end Ball;"""
STOP = """model Stop "a spring beside a free stretch"
  coordinate Length x(start = 1 [m]);
  body b = Particle(mass = 1 [kg], at = {x, 0, 0});
  force contact = (if x < 0 [m] then -100 [N/m]*x else 0 [N])*world.x at b;
  force pull = -1 [N]*world.x at b;
end Stop;"""
DRIVEN = """model Driven "a function of the coordinate and of time as a force"
  coordinate Length u(start = 0.3 [m]);
  body b = Particle(mass = 1 [kg], at = {u, 0, 0});
  force F = (FORCE)*1 [N]*world.x at b;
end Driven;"""


def driven(force: str) -> str:
    """The model with this force: x is the coordinate and s the time, without units."""
    return DRIVEN.replace("FORCE", re.sub(r"\bx\b", "(u/(1 [m]))", re.sub(r"\bs\b", "(time/(1 [s]))", force)))


def compiled(text: str, backend: str = "numpy", **given: Any) -> Any:
    return lagc.loads(text).compile(backend=backend, **given)


def simulated(text: str, stop: float, backend: str = "numpy", points: int = 11, **given: Any) -> Any:
    return compiled(text, backend).simulate(stop, method="taylor", points=points, **given)


FORCES = (
    "-sin(x) - 0.2*cos(s*x)", "-tan(x)", "-asin(x/2)", "acos(x/3) - 2", "-atan(3*x)", "-sinh(x)",
    "-x*cosh(x)", "-tanh(2*x)", "-exp(x) + exp(-x)", "-log(1 + (x + 1)^2)*x", "-x/sqrt(0.1 + x^2)",
    "-x*(1 + x^2)^0.7", "-atan2(x, 2)", "-abs(x + 2)*x", "1/(2 + x) - x", "3/sqrt(2 + x)^3 - x",
    "s/sqrt(2 + x) - x", "2/((2 + x)*sqrt(2 + x)*sqrt(sqrt(2 + x))) - x", "-x^3 + 0.1*sin(3*s)", "-x^2.0*x",
)  # fmt: skip


@pytest.mark.sample(4, 13)
@pytest.mark.parametrize("force", FORCES)
def test_each_function_has_its_recurrence(force: str) -> None:
    model = compiled(driven(force))
    run = model.simulate(3.0, method="taylor", rtol=1e-11, points=7)
    exact = model.simulate(3.0, method="dop853", rtol=1e-13, points=7)
    for one, two in zip(run.states, exact.states):
        assert one[:2] == pytest.approx(two[:2], abs=1e-10)


@pytest.mark.parametrize("rtol", [1e-4, 1e-7, 1e-10, 1e-13])
def test_the_error_follows_the_tolerance(rtol: float) -> None:
    run = simulated(SPRING, 10.0, rtol=rtol)
    errors = [abs(x[0] - cos(2.0 * t)) for t, x in zip(run.times, run.states)]
    assert max(errors) < 10.0 * rtol + 1e-13
    assert run.cost.steps < 100  # about the same at all tolerances


def test_dense_output_is_the_polynomial_of_the_step() -> None:
    run = simulated(SPRING, 2.0, points=400, rtol=1e-12)
    assert max(abs(x[0] - cos(2.0 * t)) for t, x in zip(run.times, run.states)) < 1e-12


def test_fixed_steps_have_the_order_of_machine_precision() -> None:
    run = simulated(PENDULUM, 2.0, step=0.05)
    exact = compiled(PENDULUM).simulate(2.0, method="dop853", rtol=1e-14)
    assert run.cost.steps == 40
    assert run.final["theta"] == pytest.approx(exact.final["theta"], abs=1e-13)


@pytest.mark.full
def test_an_orbit_over_a_thousand_periods() -> None:
    run = simulated(KEPLER, 2000.0 * pi, "c", points=2, rtol=1e-15)
    assert run.final["x"] == pytest.approx(0.4, abs=1e-8) and abs(run.final["y"]) < 3e-8


@pytest.mark.full
def test_a_fall_ends_at_the_singularity() -> None:
    """From rest at a distance of 1 the centre is reached at pi/sqrt(8); no step passes over it."""
    fall = KEPLER.replace("0.4 [m]", "1 [m]").replace("der(y) = 2", "der(y) = 0")
    run = simulated(fall, 3.0, rtol=1e-9)
    assert run.status == "failed"
    assert f"at t = {pi / sqrt(8.0):.6g} s" in run.message and "singularity" in run.message


def test_a_pendulum_over_ten_thousand_periods() -> None:
    """The period is 4 K(sin(1/2)) / sqrt(g/l) (elliptic integral by the arithmetic-geometric mean)."""
    a, b = 1.0, cos(0.5)
    for _ in range(6):
        a, b = (a + b) / 2.0, sqrt(a * b)
    period = 2.0 * pi / (sqrt(9.81) * a)
    run = simulated(PENDULUM, 1e4 * period, "c", points=2, rtol=1e-14)
    assert run.final["theta"] == pytest.approx(1.0, abs=1e-6)
    assert abs(run.final["der(theta)"]) < 3e-6


def test_a_symmetric_start_whose_last_orders_vanish() -> None:
    """Both rods at rest at 90 degrees: two orders in a row vanish at the beginning."""
    model = lagc.load("double_pendulum").compile(backend="numpy")
    run = model.simulate(5.0, method="taylor", rtol=1e-9, points=21)
    assert abs(run.energy.end - run.energy.start) < 1e-9


def test_a_constraint_is_kept() -> None:
    run, exact = simulated(PLANE, 5.0, rtol=1e-11), simulated(PENDULUM, 5.0, rtol=1e-13)
    assert run.final["z"] == pytest.approx(-cos(exact.final["theta"]), abs=1e-10)
    assert run.position_drift < 1e-14


def test_a_ball_bounces_at_the_times_of_the_closed_form() -> None:
    run = simulated(BALL, 2.5, rtol=1e-10)
    fall = sqrt(2.0 / 9.81)
    assert [e.t for e in run.events] == pytest.approx(
        [fall, 2.6 * fall, 3.88 * fall, 4.904 * fall], rel=1e-12
    )


def test_forces_that_set_in() -> None:
    """Somewhat more than half a period of an oscillation about -1/100, between two flights."""
    run = simulated(STOP, 3.5, rtol=1e-11)
    assert run.events[0].t == pytest.approx(sqrt(2.0), rel=1e-12)
    inside = pi + 2.0 * atan(1.0 / (10.0 * sqrt(2.0)))
    assert run.events[1].t - run.events[0].t == pytest.approx(inside / 10.0, rel=1e-10)


def test_a_verified_run() -> None:
    run = compiled(PENDULUM).simulate(10.0, accuracy=1e-8, method="taylor")
    exact = compiled(PENDULUM).simulate(10.0, method="dop853", rtol=1e-13)
    assert run.status == "ok" and run.estimated <= 1e-8
    assert run.final["theta"] == pytest.approx(exact.final["theta"], abs=1e-8)


@pytest.mark.full
@pytest.mark.parametrize("text, stop", [(KEPLER, 10.0), (PLANE, 3.0), (BALL, 2.5), (STOP, 3.5)])
def test_both_backends_have_the_same_bits(text: str, stop: float) -> None:
    one, two = (simulated(text, stop, backend, points=31, rtol=1e-9) for backend in ("c", "numpy"))
    assert one.states == two.states and one.cost.rhs == two.cost.rhs and one.cost.steps == two.cost.steps


def test_calls_of_any_length_give_one_motion() -> None:
    """A trajectory of single steps is that of one call, to the bit; a failed call leaves the last step."""
    compilation = pipeline.Compilation(Source("pendulum.lag", PENDULUM), pipeline.Choice())
    program = pipeline.delivered(compilation, pipeline.Contents(["taylor"]))
    space: dict[str, Any] = {}
    exec("".join(pipeline.render(program, "numpy").values()), space)
    ends = []
    for single in (False, True):
        equations = space["Equations"](space["default_params"]())
        run = space["Integrator"](equations, space["Options"](method="taylor", rtol=1e-9), 0.0, [1.0, 0.0])
        if not single:
            assert run.advance(1.0) == 0
        while run.t < 1.0:
            assert run.step(1.0) == 0
        middle = run.at(0.5 * (run.t_old + run.t))
        run.series.coefficients[1][0] = float("nan")  # a later attempt
        run.series.step, run.dense_place = -1, 0
        assert run.at(0.5 * (run.t_old + run.t)) == middle
        ends.append((run.t, run.x, run.steps, run.rejected, run.rhs, middle))
    assert ends[0][:4] == ends[1][:4]


def test_models_carry_it_only_when_asked() -> None:
    source = Source("spring.lag", SPRING)
    plain, expanded = (
        pipeline.delivered(pipeline.Compilation(source, pipeline.Choice()), pipeline.Contents(m))
        for m in (["dop853"], ["dop853", "taylor"])
    )
    assert "taylor" not in methods_of(plain.interface) and "taylor" in methods_of(expanded.interface)
    texts = ["".join(pipeline.render(program, "c").values()).lower() for program in (plain, expanded)]
    assert "taylor" not in texts[0] and "series" not in texts[0] and "taylor" in texts[1]


@pytest.mark.full
@pytest.mark.parametrize("real, digits", [("float", 1e-4), ("double", 1e-10), ("quad", 1e-13)])
def test_types_of_reals(real: str, digits: float, tmp_path: Path) -> None:
    compilation = pipeline.Compilation(Source("pendulum.lag", PENDULUM), pipeline.Choice())
    files = pipeline.render(pipeline.delivered(compilation, pipeline.Contents(["taylor"])), "c", real=real)
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    (tmp_path / "run.c").write_text("""#include <stdio.h>
#include "pendulum.h"
static pendulum_work w;
static pendulum_state s;
int main(void) {
    pendulum_params p = pendulum_default_params();
    pendulum_options o = pendulum_default_options();
    pendulum_real x[PENDULUM_NX];
    int status;
    pendulum_start(&p, x);
    o.method = PENDULUM_TAYLOR;
    pendulum_begin(&s, 0, x);
    status = pendulum_advance(&p, &s, 2, &o, &w);
    printf("%d %.17g %ld\\n", status, (double)s.x[0], s.steps);
    return 0;
}
""")
    command = ["gcc", "-std=gnu99", "-O1", "-w", "-ffp-contract=off", "run.c", "pendulum.c", "-o", "run"]
    command += ["-lquadmath", "-lm"] if real == "quad" else ["-lm"]
    subprocess.run(command, cwd=tmp_path, check=True)
    status, theta, steps = subprocess.run(
        [tmp_path / "run"], capture_output=True, text=True, check=True
    ).stdout.split()
    exact = compiled(PENDULUM).simulate(2.0, method="dop853", rtol=1e-14).final["theta"]
    assert int(status) == 0 and float(theta) == pytest.approx(exact, abs=digits) and int(steps) < 40


def test_a_function_without_a_recurrence_is_named() -> None:
    with pytest.raises(Refused, match=r"LAG0591.*pow with an exponent that varies"):
        simulated(driven("-(2 + x)^x"), 1.0, rtol=1e-6)


def test_a_build_has_the_methods_that_are_asked_for(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "spring.lag").write_text(SPRING)
    lengths = []
    for given, names in (
        ([], "dop853"),
        (["--method", "taylor"], "taylor"),
        (["--method", "rk4,dop853"], "dop853 rk4"),
    ):
        assert main(["build", str(tmp_path / "spring.lag"), "-o", str(tmp_path), "-q", *given]) == 0
        text = "".join((tmp_path / f"spring.{end}").read_text().lower() for end in "hc")
        assert [m for m in METHODS if re.search(rf"spring_{m}\b", text)] == names.split()
        assert [m for m in METHODS if re.search(rf"\b{m}_stages\b", text)] == names.split()
        lengths.append(len(text))
    assert lengths[0] < lengths[2]
    assert main(["build", str(tmp_path / "spring.lag"), "-o", str(tmp_path), "--method", "rk4,euler"]) == 2
    assert "'euler' is no method" in capsys.readouterr().err


@pytest.mark.parametrize("method", ["rk4", "taylor"])
def test_a_module_without_the_default_method_has_another_default(method: str) -> None:
    compilation = pipeline.Compilation(Source("spring.lag", SPRING), pipeline.Choice())
    space: dict[str, Any] = {}
    exec(
        "".join(
            pipeline.render(pipeline.delivered(compilation, pipeline.Contents([method])), "numpy").values()
        ),
        space,
    )
    assert space["Options"]().method == method and [*space["METHODS"]] == [method]
    equations = space["Equations"](space["default_params"]())
    run = space["Integrator"](equations, space["Options"](step=0.01), 0.0, [1.0, 0.0])
    assert run.advance(1.0) == 0 and run.x[0] == pytest.approx(cos(2.0), abs=1e-8)


@pytest.mark.full
@pytest.mark.parametrize(
    "long, accuracy, method",
    [(1000, 1e-9, "taylor"), (1000, 1e-7, "taylor"), (1000, 1e-3, "dop853"), (10**6, 1e-9, "dop853")],
)
def test_a_default_run_takes_it_where_it_pays(
    long: int, accuracy: float, method: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By the numbers of operations, for motions of many steps; else the bits of dop853 stay."""
    monkeypatch.setattr(simulate, "LONG_RUN", long)
    model = compiled(PENDULUM, "c")
    run = model.simulate(400.0, accuracy=accuracy, points=5)
    assert run.method == method and any("the work of dop853" in note for note in run.notes) == (
        method == "taylor"
    )
    if method == "dop853":
        assert run.states == model.simulate(400.0, accuracy=accuracy, points=5, method="dop853").states


ELLIPSE = """model Ellipse "Kepler's, e = 0.5"
  coordinate Length x(start = 0.5), y(rate = 1.7320508075688772);
  body p = Particle(mass = 1, at = {x, y, 0});
  potential pull = -1[N.m2]/norm(position(p));
end Ellipse;"""


@pytest.mark.full
def test_ten_thousand_turns_to_a_millionth() -> None:
    """Errors of an undamped motion grow with its length: the tolerance is far finer than 1e-6, and a series
    takes less work. Kepler's equation, solved with 25 digits, gives the truth."""
    run = compiled(ELLIPSE, "c").simulate(62831.853, accuracy=1e-6, points=51)
    assert (run.status, run.method) == ("ok", "taylor"), run.message
    worst = 0.0
    with mpmath.workdps(25):
        for t, x, y in zip(run.t, run["x"], run["y"]):
            u = mpmath.findroot(lambda u, t=t: u - mpmath.sin(u) / 2 - mpmath.mpf(float(t)), float(t))
            there = float(mpmath.cos(u)) - 0.5, float(mpmath.sqrt(3) / 2 * mpmath.sin(u))
            worst = max(worst, abs(x - there[0]) / 2.0, abs(y - there[1]) / sqrt(3.0))
    assert run.estimated is not None and worst <= run.estimated <= 1e-6


def test_dependent_constraints_end_a_run_by_name() -> None:
    """A ring of bars that is closed twice: the equations of all orders have no single solution."""
    system = lagc.load("hard/four_bar_again").compile("closed_twice", backend="numpy")
    run = system.simulate(1.0, method="taylor", rtol=1e-8)
    assert run.status == "failed" and "depend on each other" in run.message and "dop853" in run.message
