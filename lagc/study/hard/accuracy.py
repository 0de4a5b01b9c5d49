"""Errors that a run reports, chaos, stiffness, events, and a linear model."""

from math import asin, cos, inf, log, pi, sin, sqrt

from lagc.simulation.system import Options
from lagc.study.hard.case import Found, Lab, how
from lagc.study.hard.exact import double_pendulum, kepler_orbit


def kepler(lab: Lab) -> Found:
    model, below, above, truth = lab.compile("classic/kepler", "comet"), 0.0, 0.0, 0.0
    for asked in (1e-4, 1e-6, 1e-8):
        run = lab.run(model, 20.0 * pi, accuracy=asked)
        found = [run[name] for name in ("x", "y", "der(x)", "der(y)")]
        sizes = [max(abs(found[k]).max(), abs(found[k + 1]).max()) for k in (0, 0, 2, 2)]
        apart = [abs(f - x).max() for f, x in zip(found, kepler_orbit(run.t, 0.9))]
        true = float(max(d / s for d, s in zip(apart, sizes)))
        below, above = max(below, true / run.estimated), max(above, run.estimated / true)
        truth = max(truth, true / asked)
    return Found((truth, below, above), how(run), run=run)


def chaos(lab: Lab) -> Found:
    model = lab.compile("classic/double_pendulum", "chaotic")
    stop = 100.0
    run = model.simulate(stop, accuracy=1e-6, progress=lab.clock(stop))
    if run.interrupted:
        raise KeyboardInterrupt
    horizon = run.times[-1]
    exact = double_pendulum(horizon)
    scale = max(abs(run["theta1"]).max(), abs(run["theta2"]).max())
    error = max(abs(run[name][-1] - value) for name, value in zip(("theta1", "theta2"), exact))
    beyond = 0.0 if run.status == "failed" and horizon < stop else 1.0
    return Found((float(error / scale), beyond), how(run), f"predictable until t = {horizon:.3g} s", run)


STIFF = 1e10  # N/m


def stiff_spring(lab: Lab) -> Found:
    stop = 2.0 if lab.backend == "c" else 0.02
    start = pi / 3.0
    model = lab.compile("classic/elastic_pendulum", parameters={"k": STIFF})
    run = lab.run(model, stop, method="dop853", rtol=1e-10,
                  starts={"theta": start, "s": 9.81 * cos(start) / STIFF})  # fmt: skip
    if stop < 2.0:
        lab.notes.append("0.02 of 2 s")
    error = abs(run.final["theta"] - swing(start, stop))
    return Found((error,), how(run), run=run)


def swing(start: float, t: float, length: float = 1.0, g: float = 9.81) -> float:
    """The angle of a pendulum that is released at `start`: 2 asin(k cd(w t)) by the descending Landen
    transformation (M. Abramowitz, I. Stegun, Handbook of Mathematical Functions, 16.4 and 17.6)."""
    k = sin(start / 2.0)
    a, b, c = [1.0], [sqrt(1.0 - k * k)], [k]
    while abs(c[-1]) > 1e-17 and len(a) < 12:
        a, b, c = [*a, (a[-1] + b[-1]) / 2.0], [*b, sqrt(a[-1] * b[-1])], [*c, (a[-1] - b[-1]) / 2.0]
    n = len(a) - 1
    quarter = pi / (2.0 * a[n])
    phase = 2.0**n * a[n] * (quarter - sqrt(g / length) * t)
    for i in range(n, 0, -1):
        phase = (phase + asin(c[i] * sin(phase) / a[i])) / 2.0
    return 2.0 * asin(k * sin(phase))


ROD = ("pivot", "air", "wind", "hair", "buoyancy")


def stiff_rod(lab: Lab) -> Found:
    model = lab.compile("effects/stiff_rod", "all", without=ROD, parameters={"k": STIFF, "c": 2e4})
    run = lab.run(model, 2.0, method="radau5", rtol=1e-6)
    error = abs(run.final["th"] - swing(pi / 3.0, 2.0))
    system = model.system
    x = model.start().tolist() + [0.0] * (system.nx - system.nq - system.nv)
    seen = system.integrate(Options("dop853", rtol=1e-6, max_steps=4000), 0.0, x, [2.0])
    stiff = seen.stiff / max(seen.steps // 1000, 1)  # of the checks, one in a thousand steps
    return Found((error, 0.0 if stiff > 0.5 else 1.0), how(run), f"{run.cost.rhs} evaluations", run)


def _between_walls(t: float) -> tuple[float, float]:
    """x and v of `hard/walls`, in closed form."""
    x, v, right, left = 0.2, 3.0, 1e9, 1e7
    while t > 0.0:
        flight = (1.0 - x) / v if v > 0.0 else (-1.0 - x) / v
        if flight >= t:
            return x + v * t, v
        t -= flight
        x = 1.0 if v > 0.0 else -1.0
        omega = sqrt(right if v > 0.0 else left)
        if pi / omega >= t:
            return x + v / omega * sin(omega * t), v * cos(omega * t)
        t -= pi / omega
        v = -v
    return x, v


def walls(lab: Lab) -> Found:
    run = lab.run(lab.compile("hard/walls"), 10.0, method="dop853", rtol=1e-12)
    x, v = _between_walls(10.0)
    error = max(abs(run.final["x"] - x), abs(run.final["der(x)"] - v) / 3.0)
    return Found((error,), how(run), f"{run.cost.steps} steps", run)


def relay(lab: Lab) -> Found:
    run = lab.run(lab.compile("classic/on_off_drive"), 200.0, method="dop853", rtol=1e-12)
    tau, low, high, end = 2.0 / 0.5, 1.0, 1.5, 2.0 / 0.5
    pull, rest = tau * log((end - low) / (end - high)), tau * log(high / low)
    t, on, worst = tau * log(end / (end - high)), True, 0.0
    for event in run.events:
        worst = max(worst, abs(event.t - t) / t) if event.name.endswith("off" if on else "on") else inf
        on = not on
        t += pull if on else rest
    missing = abs(len(run.events) - 2 * int(200.0 / (pull + rest)))
    return Found((worst, 0.0 if missing <= 2 else missing), how(run), f"{len(run.events)} events", run)


# Speed: weave (one of the pair, or two real values), capsize, caster (J. P. Meijaard and others, table 2).
BICYCLE: dict[float, tuple[complex, ...]] = {
    0.0: (5.53094371765393, 3.13164324790656, -3.13164324790656, -5.53094371765393),
    2.0: (2.68234517512745 + 1.68066296590675j, -3.07158645641514, -8.67387984831735),
    5.0: (-0.77534188219585 + 4.46486771378823j, -0.32286642900409, -14.07838969279825),
    8.0: (-2.69348683581097 + 8.46037971396931j, 0.14327879765713, -20.27940894394569),
    10.0: (-3.72016840437287 + 10.90681139476287j, 0.16105338653172, -24.62459635017404),
}


def bicycle(lab: Lab) -> Found:
    model, worst = lab.compile("classic/whipple_bicycle", "straight"), 0.0
    for v, published in BICYCLE.items():
        values = model.linearize(parameters={"v": v}).eigenvalues
        for value in published:
            for one in {value, complex(value).conjugate()}:
                worst = max(worst, float(min(abs(values - one))))
    return Found((worst,), "linearize")
