"""Contacts, impacts and dry friction: files of references, and closed forms."""

from math import atan2, cos, hypot, inf, sqrt
from typing import Any

from lagc.study.hard.case import Found, Lab, RunFailed, how, read

G = 9.81


def _first(run: Any, kind: str) -> Any:
    """The first event of this kind. Raises RunFailed if there is none."""
    found = [event for event in run.events if event.kind == kind]
    if not found:
        raise RunFailed(f"no contact {kind}")
    return found[0]


def _state_after(run: Any, t: float) -> list[float]:
    """The state after the event at t. Raises RunFailed if there is none."""
    found = [after for time, _, after in run.corners if time == t]
    if not found:
        raise RunFailed(f"nothing happens at t = {t:g} s")
    return list(found[-1])


def _relative_error(found: float, exact: float) -> float:
    """The relative difference; the difference itself where the exact value is 0."""
    return abs(found - exact) / (abs(exact) or 1.0)


def bouncing_ball(lab: Lab) -> Found:
    known = read("bouncing_ball")["constants"]
    run = lab.run(lab.compile("contact/bouncing_ball"), 4.0, accuracy=1e-9, parameters={"e": 0.7})
    hits = [event for event in run.events if event.kind == "impact"]
    if len(hits) < len(known["impact_times"]) or run.events[-1].kind != "rests":
        return Found((inf, inf, inf, inf), how(run))
    times = max(_relative_error(hit.t, t) for hit, t in zip(hits, known["impact_times"]))
    gains = 1.0 + 1.0 / 0.7  # the impulse of 1 kg over the speed after
    speeds = max(abs(hit.impulse / (gains * v) - 1.0) for hit, v in zip(hits, known["speeds_after"]))
    rest = _relative_error(run.events[-1].t, known["rest_time"])
    left = max(abs(run.final["y"]), abs(run.final["der(y)"]))
    return Found((times, speeds, rest, left), how(run), f"{len(hits)} impacts", run)


def incline(lab: Lab) -> Found:
    known = read("incline")["constants"]
    model = lab.compile("contact/incline", "stays")
    run = lab.run(model, 1000.0, accuracy=1e-10, points=3)
    sticks = _first(run, "sticks").t
    creep = abs(run["s"][2] - run["s"][1]) + abs(run.final["der(s)"])
    place = _relative_error(run.final["s"], known["distance"])
    back = lab.run(model, known["back_time"], accuracy=1e-10, points=2, parameters={"mu": 0.3})
    speed = max(abs(back.final["s"]), _relative_error(-back.final["der(s)"], known["back_speed"]))
    values = _relative_error(sticks, known["stop_time"]), place, creep, speed
    return Found(values, how(run), f"{run.cost.steps} steps", run)


def slide_off_sphere(lab: Lab) -> Found:
    known = read("slide_off_sphere")["constants"]
    run = lab.run(lab.compile("contact/slide_off_sphere"), 2.0, accuracy=1e-10)
    opens = _first(run, "opens")
    x = _state_after(run, opens.t)
    angle, speed = atan2(x[0], x[1]), hypot(x[2], x[3])
    leaves = max(_relative_error(opens.t, known["leave_time"]), _relative_error(angle, known["leave_angle"]),
                 _relative_error(speed, known["leave_speed"]))  # fmt: skip
    down = [_relative_error(run.t[-1], known["down_time"]), _relative_error(run.final["x"], known["x"])]
    down += [_relative_error(run.final[f"der({n})"], v) for n, v in zip("xy", known["velocity"])]
    return Found((leaves, max(down)), how(run), run=run)


def roll_off_sphere(lab: Lab) -> Found:
    known = read("roll_off_sphere")["constants"]
    start = 1e-3  # the file begins at the top; cos(leave) = 10/17 cos(start)
    run = lab.run(lab.compile("contact/roll_off_sphere"), 4.0, accuracy=1e-10, parameters={"theta0": start},
                  points=4001)  # fmt: skip
    x = _state_after(run, _first(run, "opens").t)
    leaves = abs(cos(atan2(x[0], x[1])) / cos(start) - cos(known["leave_angle"]))
    worst, a = 0.0, 2.0 / 7.0
    for angle, push, rub in zip(run["theta"], run["N"], run["F"]):
        if push > 0.01 * run["N"][0]:  # |F|/N by the energy of the file, from `start`
            exact = a * sqrt(1.0 - cos(angle) ** 2) / ((17.0 * cos(angle) - 10.0 * cos(start)) / 7.0)
            worst = max(worst, abs(rub / push - exact))
    half = a * sqrt(1.0 - cos(0.5) ** 2) / ((17.0 * cos(0.5) - 10.0) / 7.0)
    worst = max(worst, abs(half - known["friction_at_half"]))
    return Found((leaves, worst), how(run), run=run)


def rod_impact(lab: Lab) -> Found:
    known = read("rod_impact")["constants"]
    run = lab.run(lab.compile("contact/rod_impact", "hit"), 0.01, accuracy=1e-9)
    pairs = (
        (_first(run, "impact").impulse, known["impulse"]),
        (run["der(y)"][0], known["speed"]),
        (abs(run["der(angle)"][0]), known["turning"]),
        (run["der(y)"][0] + abs(run["der(angle)"][0]) * cos(0.7) / 2.0, known["tip"]),
    )
    return Found((max(_relative_error(float(a), b) for a, b in pairs),), how(run), run=run)


def stacked_balls(lab: Lab) -> Found:
    known = read("stacked_balls")["constants"]
    model, worst = lab.compile("contact/stacked_balls"), 0.0
    rows = zip(*(known[k] for k in ("masses_1", "masses_2", "restitutions", "lower_after", "upper_after")))
    for m1, m2, e, lower, upper in rows:
        run = lab.run(model, 0.46, accuracy=1e-9, parameters={"m1": m1, "m2": m2, "e": e})
        x = _state_after(run, _first(run, "impact").t)
        pairs = [(x[3], upper)] + ([(x[2], lower)] if lower >= 0.0 else [])  # else it falls back at once
        worst = max(worst, *(_relative_error(a, b) for a, b in pairs))
    three = lab.compile("contact/newtons_cradle", parameters={"n": 3, "e": 0.9})
    run = lab.run(three, 0.6, accuracy=1e-9)
    after = _state_after(run, _first(run, "impact").t)[3:6]
    shares = [v / sum(after) for v in after]  # of the momentum, all in the first ball before
    return Found(
        (worst, max(_relative_error(a, b) for a, b in zip(shares, known["row_after"]))), how(run), run=run
    )


def cradle(lab: Lab) -> Found:
    model, wrong = lab.compile("contact/newtons_cradle"), 0
    for k in range(4, 13):
        run = lab.run(model, 10.0, method="dop853", rtol=10.0**-k)
        wrong += abs(len([event for event in run.events if event.kind == "impact"]) - 40)
    return Found((float(wrong),), how(run), run=run)


def painleve_rod(lab: Lab) -> Found:
    known = read("painleve_rod")["constants"]
    model, wrong = lab.compile("contact/painleve_rod"), 0.0
    low, high = known["range_at_1.5"]
    critical = known["angle"]
    cases = ((1.3, critical, True), (known["least_friction"] * (1.0 - 1e-4), critical, True),
             (known["least_friction"] * (1.0 + 1e-6), critical, False), (1.4, critical, False),
             (1.5, low + 1e-6, False), (1.5, high - 1e-6, False), (1.5, high + 1e-6, True))  # fmt: skip
    said = ""
    for mu, angle, moves in cases:
        try:
            lab.run(model, 1e-4, accuracy=1e-6, parameters={"mu": mu, "th0": angle})
            failure = ""
        except RunFailed as error:
            failure = str(error)
        named = "no solution, or several, where `floor` touches" in failure and f"th = {angle:.6g}" in failure
        wrong += (failure == "") != moves or (not moves and not named)
        if mu == 1.4:
            said = failure
    return Found((wrong,), "dop853", said)


def rocking_block(lab: Lab) -> Found:
    known = read("rocking_block")["constants"]
    stop = 10.0 if lab.backend == "c" else 3.0
    run = lab.run(lab.compile("contact/rocking_block", "all"), stop, accuracy=1e-8)
    hits = [event.t for event in run.events if event.kind == "impact"]
    times = [_relative_error(hit, t) for hit, t in zip(hits, known["impact_times"])]
    ratios = [
        _relative_error(x[5] / before[5], known["ratio"]) for t, before, x in run.corners if t in hits[:100]
    ]
    rest = _relative_error(run.final["E"], known["energy_at_rest"]) if lab.backend == "c" else None
    worst = [max(part, default=inf) for part in (times, ratios)]
    return Found((*worst, rest), how(run), f"{len(hits)} impacts", run)


def tippe_top(lab: Lab) -> Found:
    run = lab.run(lab.compile("contact/tippe_top"), 5.0 if lab.backend == "c" else 0.1, accuracy=1e-8)
    acts = [event.t for event in run.events if event.kind]
    first, last = (acts[0], acts[-1]) if acts else (inf, inf)
    sphere = [j for t, j in zip(run.t, run["J1"]) if t < first]
    stem = [j for t, j in zip(run.t, run["J2"]) if t > last]
    gains = max(after - before for before, after in zip(run["E"], run["E"][1:]))
    values = [max(_relative_error(j, part[0]) for j in part) if part else None for part in (sphere, stem)]
    said = f"it leans by {run.final['theta']:.3g} rad"
    return Found((*values, max(gains / run["E"][0], 0.0)), how(run), said, run)


def conveyor(lab: Lab) -> Found:
    run = lab.run(lab.compile("contact/conveyor"), 4.0, accuracy=1e-10)
    slips, flight = 1.0 / (0.3 * G), 2.0 * 1.5 / G
    exact = [0.5, 0.5 + slips, 1.5, 1.5 + slips, 2.5, 2.5 + flight, 2.5 + flight / 0.8]
    kinds = ["slips", "sticks", "slips", "sticks", "opens", "impact", "rests"]
    acts = [event for event in run.events if event.kind]
    shown = [*acts[:6], *acts[-1:]]
    if [event.kind for event in shown] != kinds:
        return Found((inf, inf), how(run))
    times = max(abs(event.t - t) for event, t in zip(shown, exact))
    return Found((times, abs(run.final["x"] - 1.0)), how(run), run=run)
