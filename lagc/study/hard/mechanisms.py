"""Closed loops, lost ranks, constraints that depend on or contradict each other, or move, and long chains."""

from math import pi
from time import process_time
from typing import Any

import numpy as np

from lagc.diagnostics.faults import Refused
from lagc.simulation.system import Options
from lagc.study.hard.case import Found, Lab, how, read
from lagc.study.hard.exact import chain_accelerations

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


# -- chains ----------------------------------------------------------------------------------------

ROUNDS = 5  # the fastest counts


def _random_state(n: int, angle: float) -> tuple[Any, Any]:
    """Angles and rates up to `angle` and twice as much."""
    random = np.random.default_rng(1)
    return random.uniform(-angle, angle, n), random.uniform(-2.0 * angle, 2.0 * angle, n)


def _error(lab: Lab, name: str, n: int, angle: float, masses: list[float], **parameters: float) -> float:
    model = lab.compile(name, parameters={"n": n, **parameters})
    angles, rates = _random_state(n, angle)
    found = model.rhs(0.0, [*angles, *rates])[n:]
    expected = np.array(chain_accelerations(angles.tolist(), rates.tolist(), masses, 0.2, 9.81))
    return float(abs(found - expected).max() / abs(expected).max())


def chain(lab: Lab) -> Found:
    n = 1000
    error = _error(lab, "classic/chain", n, 1.0, [1.0] * n)
    if lab.backend != "c":
        return Found((error, None), "right-hand side")
    model = lab.compile("classic/chain", parameters={"n": n})
    x = [1e-3] * n + [0.0] * n
    times = []
    for _ in range(ROUNDS):
        began = process_time()
        done = model.system.integrate(Options("rk4", step=1e-4), 0.0, x, [0.0, 0.025])
        times.append((process_time() - began) / done.rhs)
    said = f"{model.operations / n:.0f} operations a link"
    return Found((error, 1e6 * min(times)), "right-hand side", said)


def tip_mass(lab: Lab) -> Found:
    n = 100
    error = _error(lab, "hard/tip_mass", n, 1e-3, [1.0] * (n - 1) + [1e6], tip=1e6)
    return Found((error,), "right-hand side")


def tip_strings(lab: Lab) -> Found:
    n, link = 100, 0.2
    model = lab.compile("hard/tip_strings", parameters={"n": n, "tip": 1e6})
    angles, rates = _random_state(n, 1e-3)
    sine, cosine = np.sin(angles), np.cos(angles)
    state = [link * sine, -link * cosine, link * cosine * rates, link * sine * rates]
    found = model.rhs(0.0, [value for part in state for value in np.cumsum(part)])[2 * n : 3 * n]
    turns = chain_accelerations(angles.tolist(), rates.tolist(), [1.0] * (n - 1) + [1e6], link, 9.81)
    expected = np.cumsum(link * (cosine * np.array(turns) - sine * rates**2))
    return Found((float(abs(found - expected).max() / abs(expected).max()),), "right-hand side")
