"""Mechanisms that are hard on the equations: closed loops, configurations where the rank drops,
constraints that depend on each other everywhere, stated twice, or contradicting each other."""

import math
from statistics import median

import numpy
import pytest
from scipy.integrate import solve_ivp

import lagc
from lagc.api import Run
from lagc.host.model_library import read as read_model
from lagc.simulation.backends.compile import compiler
from lagc.simulation.system import OK, Options
from lagc.simulation.verdict import verdict

BACKEND = "c" if compiler() is not None else "numpy"


def _run(
    system: lagc.CompiledModel, stop: float, tolerance: float, starts: dict[str, float] | None = None
) -> Run:
    run = system.simulate(
        stop, method="dop853", rtol=tolerance, atol=tolerance, points=101, starts=starts
    )  # fmt: skip
    assert run.status == "ok", run.message
    return run


@pytest.mark.sample(1)
@pytest.mark.parametrize("windows", [1, 4])
def test_what_is_claimed_from_the_flat_configuration_is_true(windows: int) -> None:
    """There multipliers are quotients of rounding, and what a first step does is chance: energy is no bound.
    So the motion is compared with the pendulum that it is; where a fine accuracy is not claimed, the row
    is named."""
    system = lagc.load("classic/n_four_bar").compile(parameters={"N": windows})
    starts = {f"th[{i}]": math.pi / 2.0 for i in range(1, windows + 2)}
    times = numpy.linspace(0.0, 10.0, 101)
    rate = 9.81 * ((windows + 1) / 2 + windows) / ((windows + 1) / 3 + windows)
    exact = solve_ivp(lambda _, x: [x[1], rate * math.sin(x[0])], (0.0, 10.0), [math.pi / 2.0, 1.0],
                      "DOP853", times, rtol=1e-13, atol=1e-13).y  # fmt: skip
    for accuracy in (1e-4, 1e-6, 1e-8):
        run = system.simulate(10.0, accuracy=accuracy, points=101, starts=starts)
        assert run.status == "ok" or ((windows > 1 or accuracy < 1e-4) and "hinge[" in run.message), (
            run.message
        )
        for i in range(1, windows + 2) if run.status == "ok" else ():
            for name, column in zip((f"th[{i}]", f"der(th[{i}])"), exact):
                assert abs(run[name] - column).max() <= accuracy * abs(column).max()


@pytest.mark.sample(1)
@pytest.mark.parametrize("windows", [1, 2, 4])
def test_windows_pass_the_flat_configuration_at_any_tolerance(windows: int) -> None:
    # each passage meets it at other distances, down to where multipliers are nothing but rounding
    model = lagc.load("classic/n_four_bar").compile(parameters={"N": windows})
    system = model.load(BACKEND)
    x = system.start()
    start = system.energies(0.0, x)[2]
    ratios, tolerances = [], [10.0 ** (-6.0 - k / 8.0) for k in range(40)]
    tolerances = tolerances[:: 1 if BACKEND == "c" else 5]
    for tolerance in tolerances:
        done = system.integrate(Options("dop853", tolerance, tolerance, max_steps=5000), 0.0, x, [0.0, 10.0])
        if done.status == OK:  # never on another branch, which needs other energy
            ratios.append(abs(system.energies(10.0, done.x)[2] - start) / (tolerance * start))
            assert max(abs(done.x[windows + 1 + i]) for i in range(windows)) <= 1e-6
        else:
            assert "hinge[" in verdict(system, done, 10.0)[1]
    assert len(ratios) >= 0.9 * len(tolerances)
    # some 60 steps of one tolerance each; of one in thousands, that leaps two radians through the
    # flat configuration, the difference of two embedded formulas may tell a thousandth of the error
    assert median(ratios) <= 10.0 and max(ratios) <= 1e3


FOUR_BAR = read_model("classic/four_bar").text
RING = "constraint ring: D = {0, 0, 0};"


def _four_bar(more: str) -> lagc.CompiledModel:
    assert RING in FOUR_BAR
    return lagc.loads(FOUR_BAR.replace(RING, f"{RING}\n  {more}")).compile("upright")


@pytest.mark.full
def test_scaled_copy_of_a_constraint_is_found_redundant() -> None:
    run = _run(_four_bar("constraint again: 3*D = {0, 0, 0};"), 1.0, 1e-10)
    assert any("again" in note for note in run.notes)


@pytest.mark.parametrize(
    ("more", "first", "second"),
    [
        ("constraint other: D = {0.5 [m], 0, 0};", "other[1]", "ring[1]"),
        (
            "constraint one: q1 = 2.1 [rad] + 0.3 [rad/s]*time;\n"
            "  constraint two: q1 = 2.1 [rad] + 0.4 [rad/s]*time;",
            "two",
            "one",
        ),
    ],
)
def test_contradictory_constraints_are_refused_by_name(more: str, first: str, second: str) -> None:
    with pytest.raises(lagc.Refused) as refused:
        _four_bar(more).simulate(1.0)
    message = " ".join(fault.message for fault in refused.value.faults)
    assert first in message and second in message
