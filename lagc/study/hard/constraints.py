"""Constraints that are not linear in the speeds, and constraints that move."""

from __future__ import annotations

from lagc.study.hard.case import Case, Figure, Found, Lab, how


def constant_speed(lab: Lab) -> Found:
    steps, _ = lab.long(2e5, 2000.0, "steps")
    model = lab.compile("hard/constant_speed")
    run = lab.run(model, 0.01 * round(steps), method="dopri5", step=0.01, points=101)
    off = float(abs(run["der(x)"] ** 2 + run["der(y)"] ** 2 - 1.0).max())
    return Found((max(off, run.velocity_drift),), how(run), run=run)


def drive(lab: Lab) -> Found:
    run = lab.run(lab.compile("hard/driven_slider"), 1.0, method="dop853", rtol=1e-11, atol=1e-11, points=201)
    balance = abs(run.energy.imbalance) / max(abs(run.energy.work), abs(run.energy.end))
    return Found((run.position_drift, run.velocity_drift, balance), how(run), run=run)


CASES = (
    Case(
        "speed", "a constraint quadratic in the speeds, 2e5 steps",
        "x'^2 + y'^2 = 1 at each instant: no linear projection keeps it.",
        "P. Appell 1911; N. G. Chetaev 1933: the constraint itself is the reference",
        "Speeds are projected by Newton's method on the constraint after each step, to one rounding.",
        "hard/constant_speed", "lagc sim constant_speed --method dopri5 --step 0.01 --stop 2000",
        (Figure("drift", 1e-14),), constant_speed,
    ),
    Case(
        "drive", "a slider-crank that is turned as a function of time",
        "Nothing is left to integrate: position, speed and acceleration come from the constraints alone.",
        "The work of the motor is the energy that the parts gain",
        "Both levels are projected with the explicit derivatives by time; the work is integrated with the "
        "motion.",
        "hard/driven_slider", "lagc sim driven_slider --method dop853 --rtol 1e-11 --atol 1e-11",
        (Figure("position residual", 1e-14), Figure("velocity residual", 1e-14),
         Figure("work and energy, relative", 1e-9)), drive,
    ),
)  # fmt: skip
