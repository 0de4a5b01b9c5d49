"""Closed loops, configurations where the rank drops, constraints that depend on or contradict each other."""

from __future__ import annotations

from functools import partial
from math import pi
from typing import Any

import numpy as np

from lagc.diagnostics.faults import Refused
from lagc.study.hard.case import Case, Figure, Found, Lab, how
from lagc.study.hard.published import read

ANGLES = ("beta", "Theta", "gamma", "Phi", "delta", "Omega", "epsilon")


def by_hand(lab: Lab, model: Any, stop: float, tolerance: float, **given: Any) -> Any:
    given.setdefault("points", 101)
    return lab.run(model, stop, method="dop853", rtol=tolerance, atol=tolerance, **given)


def andrews(lab: Lab) -> Found:
    (sample,) = [s for s in read("andrews_squeezer")["samples"] if s["t"] == 0.03]
    run = by_hand(lab, lab.compile("classic/andrews_squeezer"), 0.03, 1e-8)
    error = max(abs(run.final[name] - sample["values"][name]) for name in ANGLES)
    return Found((error, run.position_drift), how(run), run=run)


def _off_branch(run: Any, windows: int) -> float:
    """How far couplers are from level, and cranks from each other."""
    level = [abs(run[f"ph[{i}]"]).max() for i in range(1, windows + 1)]
    apart = [abs(run[f"th[{i + 1}]"] - run["th[1]"]).max() for i in range(1, windows + 1)]
    return float(max(*level, *apart))


def through_flat(windows: int, lab: Lab) -> Found:
    model = lab.compile("classic/n_four_bar", parameters={"N": windows})
    run = by_hand(lab, model, 10.0, 1e-9)
    return Found((_off_branch(run, windows), abs(run.energy.imbalance)), how(run), run=run)


AWAY = (1e-2, 1e-4, 1e-6, 1e-8, 0.0)  # rad


def from_flat(lab: Lab) -> Found:
    windows = 4
    model = lab.compile("classic/n_four_bar", parameters={"N": windows})
    branch = energy = 0.0
    for away in AWAY:
        starts = {f"th[{i}]": pi / 2.0 + away for i in range(1, windows + 2)}
        run = by_hand(lab, model, 10.0, 1e-9, starts=starts)
        branch = max(branch, _off_branch(run, windows))
        if away:
            energy = max(energy, abs(run.energy.imbalance))
    named = [note for note in run.notes if "hinge[" in note]  # of the run from the flat configuration itself
    return Found((branch, energy, float(not named)), how(run), named[0] if named else "", run)


def twice(lab: Lab) -> Found:
    once = by_hand(lab, lab.compile("hard/four_bar_again"), 2.0, 1e-11)
    again = by_hand(lab, lab.compile("hard/four_bar_again", "closed_twice"), 2.0, 1e-11)
    apart = 0.0
    for name in ("q1", "q2", "q3"):
        for column in (name, f"der({name})"):
            apart = max(apart, float(abs(once[column] - again[column]).max() / abs(once[column]).max()))
    half = abs(2.0 * again["Hx"] / once["Hx"] - 1.0).max()
    named = [note for note in again.notes if "again" in note]
    return Found((apart, float(half), float(not named)), how(again), named[0] if named else "", again)


def _refusal(lab: Lab, model: str, names: tuple[str, ...], **given: Any) -> Found:
    """The names that a refusal does not mention."""
    try:
        run = lab.run(lab.compile(model, **given), 1.0, points=2)
    except Refused as refused:
        fault = refused.faults[0]
        text = " ".join([fault.message, *(label for _, label in fault.related), fault.remedy or ""])
        missing = [name for name in names if name not in text]
        return Found((float(len(missing)),), "initialization", f"refused: {fault.message}")
    return Found((float(len(names)),), how(run), "it ran", run)


def contradiction(lab: Lab) -> Found:
    return _refusal(
        lab, "hard/four_bar_again", ("ring[1]", "again[1]"), scene="closed_twice", parameters={"gap": 0.5}
    )


def massless(lab: Lab) -> Found:
    return _refusal(lab, "hard/massless_link", ("middle",), parameters={"m": 0.0})


def bennett(lab: Lab) -> Found:
    run = by_hand(lab, lab.compile("hard/bennett"), 10.0, 1e-10)
    scale = max(abs(run.energy.start), abs(run["E"]).max())
    opposite = abs(run["th1"] + run["th3"] - 2.0 * pi).max()
    at_rest = 0.0 if np.ptp(run["th1"]) > 1.0 else 1.0
    values = (abs(run.energy.imbalance) / scale, float(opposite), at_rest)
    return Found(values, how(run), "; ".join(run.notes), run)


FLAT = (
    "M. Gonzalez, D. Dopico, U. Lugris, J. Cuadrado, Multibody Syst. Dyn. 16 (2006) 179, problem A02; the "
    "energy as that benchmark bounds it"
)
PASSES = (
    "Column-pivoted QR in the mass metric takes over from LDL^T where the pivots or the residual say "
    "that rows depend on each other.  A step of finite length leaps over the configuration; speeds stay "
    "on the branch, as the projection takes the nearest state."
)

CASES = (
    Case(
        "andrews", "Andrews' squeezing mechanism",
        "Seven bodies in three closed loops within 30 ms: no choice of independent coordinates lasts.",
        "F. Mazzia, C. Magherini, Test Set for IVP Solvers, release 2.4 (2008), problem ANDREWS; values "
        "recomputed in quadruple precision",
        "Index reduction to accelerations needs no choice of coordinates.  At rtol 1e-8 the error of "
        "DOP853 is far below 1e-6; the projection after each step leaves round-off of one evaluation, "
        "1e-16 of the size of the terms.",
        "classic/andrews_squeezer",
        "lagc sim andrews_squeezer --stop 0.03 --method dop853 --rtol 1e-8 --atol 1e-8",
        (Figure("angles [rad]", 1e-6), Figure("position residual", 1e-15)), andrews,
    ),
    *(
        Case(
            f"flat_{n}", f"{n} four-bar window{'s' if n > 1 else ''} through the flat configuration at speed",
            f"Ten times in 10 s all bars lie on one line: the rank drops by {n}, and each window could go on "
            "crossed.",
            FLAT, PASSES, "classic/n_four_bar",
            f"lagc sim n_four_bar -p N={n} --method dop853 --rtol 1e-9 --atol 1e-9",
            (Figure("distance from the branch [rad]", 1e-6), Figure("energy [J]", 5e-5)),
            partial(through_flat, n),
        )
        for n in (1, 4)
    ),
    Case(
        "flat_start", "four windows that start 1e-2 ... 0 rad from the flat configuration",
        "At 0 the constraints do not determine the motion; near it they hardly do.",
        FLAT, PASSES + "  From the flat configuration itself the dependent rows are named; the energy "
        "counts for the starts beside it.", "classic/n_four_bar",
        "lagc sim n_four_bar -p N=4 --start 'th[1]=90[deg]' --start 'th[2]=90[deg]' --start 'th[3]=90[deg]' "
        "--start 'th[4]=90[deg]' --start 'th[5]=90[deg]' --method dop853 --rtol 1e-9 --atol 1e-9",
        (Figure("distance from the branch [rad]", 1e-6), Figure("energy [J]", 5e-5),
         Figure("rank loss not named", 0.0)), from_flat,
    ),
    Case(
        "twice", "a four-bar linkage whose ring is closed twice",
        "Every constraint stated twice: the matrix of the multipliers is singular everywhere.",
        "The run with one ring, which is an independent model; the smallest multipliers by A. Bjorck, "
        "Numerical Methods for Least Squares Problems (1996), 2.7.3",
        "The rows that say nothing new are found by rank-revealing elimination and left out; multipliers of "
        "least norm are shared equally by equal rows.", "hard/four_bar_again",
        "lagc sim four_bar_again --scene closed_twice --method dop853 --rtol 1e-11 --atol 1e-11",
        (Figure("motion, relative", 1e-10), Figure("half of the force each, relative", 1e-9),
         Figure("rows not named", 0.0)), twice,
    ),
    Case(
        "contradiction", "a ring that is closed to two places at once",
        "No position fulfils both rows; a least-squares compromise would look like one.",
        "The two places are 0.5 m apart",
        "The initial residual cannot be made zero; the rows that stay unfulfilled are the ones that "
        "contradict each other.", "hard/four_bar_again",
        "lagc sim four_bar_again --scene closed_twice -p gap=0.5",
        (Figure("rows not named", 0.0),), contradiction,
    ),
    Case(
        "overconstrained", "Bennett's linkage, 10 s",
        "Six closing rows of rank two in every configuration; by Gruebler's count it does not move.",
        "G. T. Bennett, Engineering 76 (1903) 777; no load works, so the energy is constant",
        "The redundant rows are left out by rank in the mass metric at each evaluation, so the motion is "
        "that of the independent rows; the energy error is that of rtol 1e-10 over some thousand steps.",
        "hard/bennett", "lagc sim bennett --stop 10 --method dop853 --rtol 1e-10 --atol 1e-10",
        (Figure("energy, relative", 1e-6), Figure("opposite angles [rad]", 1e-8),
         Figure("stands still", 0.0)), bennett,
    ),
    Case(
        "massless", "a massless bob between two strings",
        "Nothing resists the force across the strings: the accelerations are not determined.",
        "The mass matrix and the two rows have rank three for four coordinates",
        "A pivot of the mass matrix on the null space of the constraints is zero; it belongs to the "
        "coordinate and the body that are named.", "hard/massless_link", "lagc sim massless_link -p m=0",
        (Figure("bodies not named", 0.0),), massless,
    ),
)  # fmt: skip
