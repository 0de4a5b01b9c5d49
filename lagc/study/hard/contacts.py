"""Contacts, impacts and dry friction: files of references, and closed forms."""

from __future__ import annotations

from math import atan2, cos, hypot, inf, sqrt
from typing import Any

from lagc.study.hard.case import Case, Figure, Found, Lab, RunFailed, how
from lagc.study.hard.published import read

REFERENCES = (
    "bouncing_ball",
    "incline",
    "slide_off_sphere",
    "roll_off_sphere",
    "rod_impact",
    "stacked_balls",
    "painleve_rod",
    "rocking_block",
)
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


def _apart(found: float, exact: float) -> float:
    """The relative difference; the difference itself where the exact value is 0."""
    return abs(found - exact) / (abs(exact) or 1.0)


def bouncing_ball(lab: Lab) -> Found:
    known = read("bouncing_ball")["constants"]
    run = lab.run(lab.compile("contact/bouncing_ball"), 4.0, accuracy=1e-9, parameters={"e": 0.7})
    hits = [event for event in run.events if event.kind == "impact"]
    if len(hits) < len(known["impact_times"]) or run.events[-1].kind != "rests":
        return Found((inf, inf, inf, inf), how(run))
    times = max(_apart(hit.t, t) for hit, t in zip(hits, known["impact_times"]))
    gains = 1.0 + 1.0 / 0.7  # the impulse of 1 kg over the speed after
    speeds = max(abs(hit.impulse / (gains * v) - 1.0) for hit, v in zip(hits, known["speeds_after"]))
    rest = _apart(run.events[-1].t, known["rest_time"])
    left = max(abs(run.final["y"]), abs(run.final["der(y)"]))
    return Found((times, speeds, rest, left), how(run), f"{len(hits)} impacts", run)


def incline(lab: Lab) -> Found:
    known = read("incline")["constants"]
    model = lab.compile("contact/incline", "stays")
    run = lab.run(model, 1000.0, accuracy=1e-10, points=3)
    sticks = _first(run, "sticks").t
    creep = abs(run["s"][2] - run["s"][1]) + abs(run.final["der(s)"])
    place = _apart(run.final["s"], known["distance"])
    back = lab.run(model, known["back_time"], accuracy=1e-10, points=2, parameters={"mu": 0.3})
    speed = max(abs(back.final["s"]), _apart(-back.final["der(s)"], known["back_speed"]))
    values = _apart(sticks, known["stop_time"]), place, creep, speed
    return Found(values, how(run), f"{run.cost.steps} steps", run)


def slide_off_sphere(lab: Lab) -> Found:
    known = read("slide_off_sphere")["constants"]
    run = lab.run(lab.compile("contact/slide_off_sphere"), 2.0, accuracy=1e-10)
    opens = _first(run, "opens")
    x = _state_after(run, opens.t)
    angle, speed = atan2(x[0], x[1]), hypot(x[2], x[3])
    leaves = max(_apart(opens.t, known["leave_time"]), _apart(angle, known["leave_angle"]),
                 _apart(speed, known["leave_speed"]))  # fmt: skip
    down = [_apart(run.t[-1], known["down_time"]), _apart(run.final["x"], known["x"])]
    down += [_apart(run.final[f"der({n})"], v) for n, v in zip("xy", known["velocity"])]
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
    return Found((max(_apart(float(a), b) for a, b in pairs),), how(run), run=run)


def stacked_balls(lab: Lab) -> Found:
    known = read("stacked_balls")["constants"]
    model, worst = lab.compile("contact/stacked_balls"), 0.0
    rows = zip(*(known[k] for k in ("masses_1", "masses_2", "restitutions", "lower_after", "upper_after")))
    for m1, m2, e, lower, upper in rows:
        run = lab.run(model, 0.46, accuracy=1e-9, parameters={"m1": m1, "m2": m2, "e": e})
        x = _state_after(run, _first(run, "impact").t)
        pairs = [(x[3], upper)] + ([(x[2], lower)] if lower >= 0.0 else [])  # else it falls back at once
        worst = max(worst, *(_apart(a, b) for a, b in pairs))
    three = lab.compile("contact/newtons_cradle", parameters={"n": 3, "e": 0.9})
    run = lab.run(three, 0.6, accuracy=1e-9)
    after = _state_after(run, _first(run, "impact").t)[3:6]
    shares = [v / sum(after) for v in after]  # of the momentum, all in the first ball before
    return Found((worst, max(_apart(a, b) for a, b in zip(shares, known["row_after"]))), how(run), run=run)


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
    times = [_apart(hit, t) for hit, t in zip(hits, known["impact_times"])]
    ratios = [_apart(x[5] / before[5], known["ratio"]) for t, before, x in run.corners if t in hits[:100]]
    rest = _apart(run.final["E"], known["energy_at_rest"]) if lab.backend == "c" else None
    worst = [max(part, default=inf) for part in (times, ratios)]
    return Found((*worst, rest), how(run), f"{len(hits)} impacts", run)


def tippe_top(lab: Lab) -> Found:
    run = lab.run(lab.compile("contact/tippe_top"), 5.0 if lab.backend == "c" else 0.1, accuracy=1e-8)
    acts = [event.t for event in run.events if event.kind]
    first, last = (acts[0], acts[-1]) if acts else (inf, inf)
    sphere = [j for t, j in zip(run.t, run["J1"]) if t < first]
    stem = [j for t, j in zip(run.t, run["J2"]) if t > last]
    gains = max(after - before for before, after in zip(run["E"], run["E"][1:]))
    values = [max(_apart(j, part[0]) for j in part) if part else None for part in (sphere, stem)]
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


def _of_file(name: str, title: str, hard: str, why: str, line: str, figures: tuple[Figure, ...]) -> Case:
    reference = read(name)
    return Case(
        name, title, hard, reference["citation"], why, reference["model"], line, figures, globals()[name]
    )


CASES = (
    _of_file(
        "bouncing_ball", "a ball bounces through its accumulation point",
        "Infinitely many impacts in a finite time; then it lies.",
        "Impacts are located on the dense output, and each flight is a parabola, which DOP853 follows "
        "exactly.  Bounces below 1e-10 of the size are summed as a geometric series; then it touches.",
        "lagc sim bouncing_ball -p e=0.7 --stop 4 --accuracy 1e-9",
        (Figure("impact times, relative", 1e-12), Figure("speeds after, relative", 1e-7),
         Figure("time of rest, relative", 1e-12), Figure("height and speed at rest", 0.0)),
    ),
    _of_file(
        "incline", "a block stops on a rough slope, 1000 s",
        "Smoothed friction creeps; a force with a sign chatters.",
        "A contact that sticks holds its slip at zero as a constraint, whose projection leaves nothing.",
        "lagc sim incline --scene stays --stop 1000 --accuracy 1e-10",
        (Figure("time of the stop, relative", 1e-10), Figure("distance, relative", 1e-10),
         Figure("creep", 0.0), Figure("return at mu = 0.3, relative", 1e-9)),
    ),
    _of_file(
        "slide_off_sphere", "a bead leaves a sphere where the force is zero",
        "The constraint ends where its force changes sign; nothing shows it in the state.",
        "The force at the stages shows the sign change; the step is repeated to end there.",
        "lagc sim slide_off_sphere --stop 2 --accuracy 1e-10",
        (Figure("leaving, relative", 1e-9), Figure("at the height of the centre below, relative", 1e-9)),
    ),
    _of_file(
        "roll_off_sphere", "a ball rolls off a sphere",
        "Friction that holds a rolling ball, up to a contact without force.",
        "Rolling is a contact that sticks: its friction is what the law needs, and its end is located.",
        "lagc sim roll_off_sphere -p theta0=1e-3 --stop 4 --accuracy 1e-10",
        (Figure("cosine of the angle of leaving", 1e-9), Figure("friction over normal force", 1e-8)),
    ),
    _of_file(
        "rod_impact", "the end of a falling rod hits a floor",
        "The impulse turns the rod; the impact is at the start.",
        "One solve with the mass matrix gives the impulse.",
        "lagc sim rod_impact --scene hit --accuracy 1e-9",
        (Figure("impulse and speeds, relative", 1e-12),),
    ),
    _of_file(
        "stacked_balls", "balls that touch pass a blow on",
        "Several contacts at one moment; round-off decides which are closed.",
        "Contacts that approach act together, then those that approach by it: floor first, then the pair.",
        "lagc sim stacked_balls --accuracy 1e-9",
        (Figure("speeds after, relative", 1e-12), Figure("a row of three, e = 0.9, shares", 1e-12)),
    ),
    Case(
        "cradle", "five pendulums that touch, 10 s, at nine tolerances",
        "Round-off makes pendulums that touch collide.", "equal masses exchange their speeds: 40 impacts",
        "Pendulums that touch without approaching have no impact: a rate below 1e-12 of its terms is zero.",
        "contact/newtons_cradle", "lagc sim newtons_cradle --method dop853 --rtol 1e-7",
        (Figure("impacts missed or added", 0.0),), cradle,
    ),
    _of_file(
        "painleve_rod", "a rod on its tip, with much friction",
        "Beyond mu = 4/3 there are configurations in which rigid bodies have no motion, or several.",
        "All modes of few contacts are tested: none or several solutions are told from one.",
        "lagc sim painleve_rod -p mu=1.4",
        (Figure("configurations answered wrongly, of 7", 0.0),),
    ),
    Case(
        "conveyor", "a belt that is switched on and off, and a kick",
        "New values at an event, beside contacts that stick, slip, open and bounce.",
        "closed form: slips of w/(mu g), flights of 2 v/g, bounces as a geometric series",
        "After new values the contacts act as at a start.",
        "contact/conveyor", "lagc sim conveyor --accuracy 1e-10",
        (Figure("times [s]", 1e-9), Figure("place [m]", 1e-9)), conveyor,
    ),
    _of_file(
        "rocking_block", "a block rocks until it stands",
        "Edges hit and leave in turn, ever faster; friction holds the one that hits.",
        "Only the edge that approaches has an impact, and sticks: the angular momentum about it stays.  "
        "The motion between is smooth, and each impact is located.",
        "lagc sim rocking_block --scene all --accuracy 1e-9",
        (Figure("impact times, relative", 1e-9), Figure("rates after over before, relative", 1e-9),
         Figure("energy at rest, relative", 1e-9)),
    ),
    Case(
        "tippe_top", "a top turns over onto its stem",
        "A fast spin, a slow turn by friction that nearly vanishes, and two contacts that change over.",
        "J. H. Jellett, A Treatise on the Theory of Friction, 1872: L . (G - P) is constant for any friction",
        "Friction is found with the force of the floor at each stage, and follows the slip in its direction.",
        "contact/tippe_top", "lagc sim tippe_top --accuracy 1e-8",
        (Figure("Jellett's integral on the sphere, relative", 1e-7),
         Figure("the same on the stem, relative", 1e-7), Figure("energy gained, relative", 1e-9)), tippe_top,
    ),
)  # fmt: skip
