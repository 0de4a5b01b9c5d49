"""Discrete variables: hysteresis, sampled control, modes; where they are reported, and what is refused."""

import json
import subprocess
from math import exp, log
from pathlib import Path

import pytest

import lagc
from lagc.cli.main import main
from lagc.diagnostics.faults import Refused

pytestmark = pytest.mark.usefixtures("own_cache")
MODELS = Path(__file__).parents[3] / "models" / "classic"
BOTH = pytest.mark.parametrize("backend", ["numpy", "c"])


def model(name: str, backend: str = "numpy") -> lagc.CompiledModel:
    return lagc.load(str(MODELS / f"{name}.lag")).compile(backend=backend)


def text(declarations: str, force: str = "{0, 0, 0}") -> str:
    return f"""model M
      coordinate Length x(rate = 1 [m/s]);
      body b = Particle(mass = 1 [kg], at = {{x, 0, 0}});
      force f = {force} at b;
      {declarations}
    end M;"""


# -- closed forms --


@pytest.mark.sample(1)
@BOTH
def test_a_motor_with_hysteresis_switches_where_the_closed_form_does(backend: str) -> None:
    """v' = (F on - c v)/m between v_low and v_high: exponentials with the time m/c."""
    tau, end, low, high = 4.0, 4.0, 1.0, 1.5
    pulls, rests = tau * log((end - low) / (end - high)), tau * log(high / low)
    t = tau * log(end / (end - high))
    times, names = [t], ["off"]
    while t < 20.0 - rests:
        t += rests if names[-1] == "off" else pulls
        names.append("on" if names[-1] == "off" else "off")
        times.append(t)
    run = model("on_off_drive", backend).simulate(20.0, accuracy=1e-9)
    assert run.status == "ok" and [event.name for event in run.events][: len(names)] == names
    assert [event.t for event in run.events][: len(times)] == pytest.approx(times, abs=1e-7)
    assert set(run["on"]) == {0.0, 1.0}
    for t, on, v in zip(run.t, run["on"], run["der(x)"]):
        last = max((k for k, at in enumerate(times) if at < t - 1e-9), default=-1)
        began, speed = (times[last], high if names[last] == "off" else low) if last >= 0 else (0.0, 0.0)
        assert on == (0.0 if last >= 0 and names[last] == "off" else 1.0) or abs(t - began) < 1e-6
        final = end if on else 0.0
        assert v == pytest.approx(final + (speed - final) * exp(-(t - began) / tau), abs=1e-7)


def sampled(T: float, n: int, kp: float = 4.0, kd: float = 1.5) -> list[tuple[float, float, float]]:
    x, v, found = 1.0, 0.0, []
    for _ in range(n):
        u = -kp * x - kd * v
        found.append((x, v, u))
        x, v = x + v * T + u * T * T / 2.0, v + u * T
    return found


@pytest.mark.sample(1)
@BOTH
@pytest.mark.parametrize("T", [0.1, 0.25])
def test_a_sampled_controller_gives_the_sequence_of_zero_order_hold(T: float, backend: str) -> None:
    wanted = sampled(T, 20)
    run = model("sampled_pd", backend).simulate(19.5 * T, every=T / 4.0, parameters={"T": T})
    assert run.status == "ok" and len(run.events) == 19
    assert [event.t for event in run.events] == pytest.approx([(k + 1) * T for k in range(19)], abs=1e-12)
    for t, x, v, u, soon in zip(run.t, *(run[name] for name in ("x", "der(x)", "u", "next"))):
        part, k = t / T % 1.0, int(t / T)
        if part < 0.2 or part > 0.8:
            continue  # the moments of the samples
        x0, v0, force = wanted[k]
        s = t - k * T
        assert (u, soon) == pytest.approx((force, (k + 1) * T), abs=1e-9)
        assert (x, v) == pytest.approx((x0 + v0 * s + force * s * s / 2.0, v0 + force * s), abs=1e-9)


@pytest.mark.sample(1)
@BOTH
def test_a_belt_by_modes_sticks_and_slips(backend: str) -> None:
    from tests.simulation.events.test_when_at_jumps import belt_at

    run = model("stick_slip_belt", backend).simulate(20.0, accuracy=1e-9)
    assert run.status == "ok" and run.estimated is not None and run.estimated <= 1e-9
    assert list(run["x"]) == pytest.approx([belt_at(t) for t in run.t], abs=1e-8)
    assert set(run["mode"]) == {0.0, 1.0}
    slips = model("stick_slip_belt", backend).simulate(0.05, starts={"mode": 1.0, "der(x)": 0.0})
    assert slips["mode"][-1] == 1.0
    assert slips["der(x)"][-1] == pytest.approx(3.0 / 10.0**0.5 * 0.1581138, rel=1e-2)


def test_energy_of_a_potential_that_jumps_is_work() -> None:
    """The spring's far end goes from 1 m to 3 m as the mass passes 0.5 m: V rises by (2.5^2 - 0.5^2) k/2."""
    declared = """discrete Length far(start = 1 [m]);
      potential spring = 1/2*(1 [N/m])*(x - far)^2;
      when x > 0.5 [m] then reinit(far, far + 2 [m]); end when;"""
    run = lagc.loads(text(declared)).compile(backend="numpy").simulate(1.0)
    assert run.status == "ok" and run["far"][-1] == 3.0
    assert run.energy.work == pytest.approx(3.0) and abs(run.energy.imbalance) < 1e-9


# -- in results and from outside --


def test_discrete_variables_are_columns_with_units(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = str(MODELS / "sampled_pd.lag")
    assert main(["sim", path, "--stop", "0.35", "--json", "-o", str(tmp_path / "run.csv")]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["final"]["next"] == pytest.approx(0.4) and "u" in found["final"]
    head, *rows = (tmp_path / "run.csv").read_text().splitlines()
    assert head == "time,x,der(x),u,next" and len({row.split(",")[3] for row in rows}) == 4
    assert main(["explain", path]) == 0
    assert "u [N] starts at -kp*x0, changed by `when` alone" in capsys.readouterr().out
    assert main(["equations", path]) == 0
    assert "u := -kd*x' - kp*x  when (next <= t)" in capsys.readouterr().out
    run = model("sampled_pd").simulate(0.05, starts={"u": 2.0})
    assert (
        run.units["u"] == "N"
        and run["u"][-1] == 2.0
        and run["x"][-1] == pytest.approx(1.0 + 2.0 * 0.05**2 / 2)
    )
    assert run.x.shape == (len(run.t), run.system.nx)


def test_starts_are_given_by_scene_and_command(capsys: pytest.CaptureFixture[str]) -> None:
    declared = """discrete Real mode(start = 1);
      discrete Boolean on[2](each start = false);
      scene s start mode = 2; start on[2] = true; end s;"""
    system = lagc.loads(text(declared)).compile(backend="numpy")
    assert system.simulate(0.1).states[-1][-3:] == [2.0, 0.0, 1.0]
    run = system.simulate(0.1, starts={"mode": 7.0, "on[1]": True})
    assert run.states[-1][-3:] == [7.0, 1.0, 1.0]
    with pytest.raises(Refused, match="true or false, not 3"):
        system.simulate(0.1, starts={"on[1]": 3.0})
    with pytest.raises(Refused, match="discrete variable `modd`"):
        system.simulate(0.1, starts={"modd": 3.0})


def test_the_right_hand_side_holds_them() -> None:
    system = lagc.loads(text("discrete Force F(start = 3 [N]);", "F*world.x")).compile(backend="numpy")
    assert list(system.rhs(0.0, [0.0, 1.0])) == [1.0, 3.0]
    assert list(system.rhs(0.0, [0.0, 1.0, 5.0])) == [1.0, 5.0, 0.0]
    held = system.linearize()
    assert held.inputs == ("F",) and held.B.ravel().tolist() == [0.0, 1.0]


@pytest.mark.full
def test_generated_c_has_them_as_named_entries(tmp_path: Path) -> None:
    assert main(["build", str(MODELS / "stick_slip_belt.lag"), "--target", "c", "-o", str(tmp_path)]) == 0
    (tmp_path / "main.c").write_text("""
#include "stick_slip_belt.h"
#include <stdio.h>
int main(void)
{
    static stick_slip_belt_work w;
    static stick_slip_belt_state s;
    stick_slip_belt_params p = stick_slip_belt_default_params();
    stick_slip_belt_options o = stick_slip_belt_default_options();
    double x[STICK_SLIP_BELT_NX], rate[STICK_SLIP_BELT_NX] = {9, 9, 9};
    int status = 0, k = 0;
    stick_slip_belt_bind(&p);
    stick_slip_belt_start(&p, x);
    stick_slip_belt_begin(&s, 0.0, x);
    while (s.t < 20.0 && status == 0)
        status = k++ % 2 ? stick_slip_belt_step(&p, &s, 20.0, &o, &w)
                         : stick_slip_belt_advance(&p, &s, s.t + 0.01 < 20.0 ? s.t + 0.01 : 20.0, &o, &w);
    stick_slip_belt_rhs(&p, 0.0, x, rate, NULL, &w);
    printf("%d %.9f %g %g\\n", status, s.x[0], s.x[STICK_SLIP_BELT_X_mode], rate[STICK_SLIP_BELT_X_mode]);
    s.x[STICK_SLIP_BELT_X_mode] = 0;
    s.x[1] = 0.5;
    status = stick_slip_belt_advance(&p, &s, 20.1, &o, &w);
    printf("%d %.9f\\n", status, s.x[1]);
    return 0;
}
""")
    sources = [str(tmp_path / name) for name in ("main.c", "stick_slip_belt.c")]
    command = [
        "cc", "-std=c99", "-Wall", "-Wextra", "-Werror", "-O1", *sources, "-lm", "-o", str(tmp_path / "a"),
    ]  # fmt: skip
    subprocess.run(command, check=True)
    lines = subprocess.run([str(tmp_path / "a")], capture_output=True, text=True, check=True).stdout.split(
        "\n"
    )
    status, x, mode, rate = lines[0].split()
    assert (status, mode, rate) == ("0", "1", "0") and float(x) == pytest.approx(0.0500290327, abs=1e-6)
    assert lines[1].split() == ["0", "0.500000000"]


# -- what is refused --

FAULTS = {
    "discrete Real k;": ("LAG0210", "write `discrete Real k(start = 0);`"),
    "discrete Boolean on;": ("LAG0210", "write `discrete Boolean on(start = false);`"),
    "discrete Length k = 1 [m];": ("LAG0209", "write `discrete Length k(start = 1 [m]);`"),
    "discrete Boolean on(start = 1);": ("LAG0307", "write `true` or `false`"),
    "discrete Real k(start = x/(1 [m]));": ("LAG0311", None),
    "discrete Real k(start = 0, fixed = true);": ("LAG0209", "a discrete variable has start, displayUnit"),
    "discrete Boolean on(start = true); when x > 1 [m] then reinit(on, 1); end when;": (
        "LAG0307", "write `reinit(on, true)`",
    ),
    "discrete Real k(start = 0); when x > 1 [m] then k = 1; end when;": ("LAG0227", "write `reinit(k, 1)`"),
    "discrete Real k(start = 0); constraint c: x = k*(1 [m]);": ("LAG0232", "let `k` act through a force"),
    "discrete Real k(start = 0); speed Velocity u = der(x)*(1 + k);": ("LAG0232", "let `k` act"),
    "parameter Mass m = 1 [kg]; when x > 1 [m] then reinit(m, 2 [kg]); end when;": (
        "LAG0228", "declare it as `discrete Real m(start = ...);`",
    ),
}  # fmt: skip


@pytest.mark.parametrize("declarations", FAULTS)
def test_wrong_declarations_are_refused_with_the_line_to_write(declarations: str) -> None:
    code, remedy = FAULTS[declarations]
    faults = lagc.loads(text(declarations)).check()
    assert [fault.code for fault in faults][:1] == [code]
    assert remedy is None or remedy in (faults[0].remedy or "")


def test_sensitivities_are_refused() -> None:
    system = lagc.loads(
        text("parameter Force P = 1 [N]; discrete Real k(start = 1);", "k*P*world.x")
    ).compile()
    with pytest.raises(Refused, match="its jumps are not differentiated"):
        system.simulate(1.0, sensitivity="P")


@pytest.mark.sample(1)
@BOTH
def test_a_wrong_sequence_of_events_is_an_error(backend: str) -> None:
    """A counter of grazing passes: the error of a count counts, so it is verified like any quantity."""
    declared = """discrete Real n(start = 0);
      potential spring = 1/2*(100 [N/m])*x^2;
      when x > 0.05 [m] then reinit(n, n + 1); end when;"""
    run = lagc.loads(text(declared)).compile(backend=backend).simulate(10.0)
    assert run.status == "ok" and run["n"][-1] == 16.0


@pytest.mark.full
def test_the_cost_of_accuracy_is_measured(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["cost", str(MODELS / "sampled_pd.lag"), "--stop", "0.5"]) == 0
    assert "the errors are those of round-off" in capsys.readouterr().out


# -- coordinates without inertia, whose rates follow new values --


@BOTH
def test_a_temperature_without_inertia_follows_the_heater(backend: str) -> None:
    """T' = (Te - T)/tau with Te = 30 or 10: exponentials between the switches at 21 and 19."""
    tau, t, T, on = 20.0, 0.0, 15.0, True
    times = []
    while True:
        final, edge = (30.0, 21.0) if on else (10.0, 19.0)
        lasts = tau * log((final - T) / (final - edge))
        if t + lasts > 60.0:
            break
        t, T, on = t + lasts, edge, not on
        times.append(t)
    run = model("thermostat", backend).simulate(60.0, accuracy=1e-9)
    assert run.status == "ok"
    assert [event.t for event in run.events] == pytest.approx(times, abs=1e-6)
    last = final + (T - final) * exp(-(60.0 - t) / tau)
    assert run.final["T"] == pytest.approx(last, rel=1e-8)
    assert run.final["der(T)"] == pytest.approx((final - last) / tau, rel=1e-7)


RESET = """model Reset
  parameter Time tau = 20 [s];
  coordinate Real T(start = 15);
  constraint heat: der(T) = (30 - T)/tau;
  when T > 21 then reinit(T, 15); end when;
end Reset;
"""


@BOTH
def test_a_filter_that_is_reset_has_its_new_rate(backend: str) -> None:
    """From 15 to 21 in tau log(15/9), again and again."""
    run = lagc.loads(RESET).compile(backend=backend).simulate(35.0, accuracy=1e-9)
    period = 20.0 * log(15.0 / 9.0)
    assert run.status == "ok"
    assert [event.t for event in run.events] == pytest.approx([period, 2 * period, 3 * period], abs=1e-6)
    last = 30.0 - 15.0 * exp(-(35.0 - 3 * period) / 20.0)
    assert run.final["T"] == pytest.approx(last, rel=1e-8)
    assert run.final["der(T)"] == pytest.approx((30.0 - last) / 20.0, rel=1e-7)


def test_speeds_with_inertia_do_not_follow_and_sensitivities_end() -> None:
    """A clause that leaves a rod's other speed off its constraint is an error; S has no rule for rates
    that follow."""
    tied = """model Tied
  coordinate Length x(rate = 1 [m/s]), y;
  body a = Particle(mass = 1 [kg], at = {x, 0, 0});
  body b = Particle(mass = 1 [kg], at = {0, y, 0});
  constraint c: der(y) = 2*der(x);
  when x > 1 [m] then reinit(der(x), -1 [m/s]); end when;
end Tied;
"""
    run = lagc.loads(tied).compile(backend="numpy").simulate(2.0)
    assert run.status == "failed" and "leaves `der(y)` unchanged" in run.message
    run = lagc.loads(RESET).compile(backend="numpy").simulate(15.0, sensitivity=["tau"])
    assert "has no inertia, follows new values" in run.message
