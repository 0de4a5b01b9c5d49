"""Long runs: what accumulates, and what must not.  In Python they are shorter."""

from math import atan, atanh, cos, hypot, pi, sin, sinh, sqrt, tanh

import numpy as np

from lagc.study.hard.case import Found, Lab, how

QUARTER = 1.8540746773013719  # K(1/sqrt 2), a quarter of the period of a pendulum released at 90 deg


def pendulum(tolerance: float, lab: Lab) -> tuple[Found, float, float]:
    """The run, its energy error over m g l, and its phase error in periods, for 1e5 periods."""
    length, g = 0.5, 9.81
    period = 4.0 * QUARTER * sqrt(length / g)
    periods, more = lab.long(1e5, 200.0, "periods")
    periods = round(periods)
    model = lab.compile("course/string_pendulum")
    run = lab.run(
        model, periods * period, method="dop853", rtol=tolerance, atol=tolerance, points=2,
        starts={"x": length, "z": 0.0},
    )  # fmt: skip
    end = run.final
    rate = (end["x"] * end["der(z)"] - end["z"] * end["der(x)"]) / length**2
    late = -rate * length / g / period  # at the turning point the rate is -(g/l) dt
    energy = abs(run.energy.imbalance) / (g * length)  # grows with the time, the phase with its square
    residual = max(run.position_drift, run.velocity_drift)
    return Found((residual,), how(run), run=run), energy * more, abs(late) * more**2


def pendulum_phase(lab: Lab) -> Found:
    found, energy, phase = pendulum(1e-15, lab)
    return Found((energy, phase), found.method)


def pendulum_projected(lab: Lab) -> Found:
    found, energy, _ = pendulum(1e-12, lab)
    return Found((*found.values, energy), found.method)


def sleigh(lab: Lab) -> Found:
    m, inertia, a, v0, w0, stop = 1.0, 0.1, 0.2, 0.3, 3.0, 2000.0
    run = lab.run(lab.compile("classic/chaplygin_sleigh"), stop, accuracy=1e-9, points=2)
    # v = V tanh(k (t - t0)), w = (V/c) sech(k (t - t0)), theta the Gudermannian
    c = sqrt((inertia + m * a * a) / m)
    top = hypot(v0, c * w0)
    k = a * top / c**2
    t0 = -atanh(v0 / top) / k
    begin, straight = atan(sinh(-k * t0)), 30.0
    heading = (c / a) * (pi / 2.0 - begin)
    nodes, weights = np.polynomial.legendre.leggauss(20)
    path = [top * (stop - straight) * cos(heading), top * (stop - straight) * sin(heading)]
    panels = 200
    for j in range(panels):
        half = straight / panels / 2.0
        for node, weight in zip(nodes, weights):
            t = half * (2 * j + 1 + float(node))
            theta = (c / a) * (atan(sinh(k * (t - t0))) - begin)
            for i, part in enumerate((cos(theta), sin(theta))):
                path[i] += float(weight) * half * top * tanh(k * (t - t0)) * part
    end = run.final
    errors = [abs(end["v"] - top) / top, abs(end["theta"] - heading)]
    errors += [abs(end[name] - place) / (top * stop) for name, place in zip("xy", path)]
    return Found((run.velocity_drift, max(errors)), how(run), run=run)


def free_solid(name: str, lab: Lab) -> Found:
    turns, more = lab.long(1e4, 100.0, "turns")
    stop = turns * 2.0 * pi / 1.2  # the body turns with 1.15 to 1.26 rad/s
    run = lab.run(lab.compile(f"classic/{name}"), stop, method="dop853", rtol=1e-15, atol=1e-15, points=501)
    w, x, y, z = (run[f"o.{i}"] for i in "wxyz")
    norm = float(abs(np.sqrt(w * w + x * x + y * y + z * z) - 1.0).max())
    l1, l2, l3 = 3.0 * run["w1"], 2.0 * run["w2"], 1.0 * run["w3"]
    momentum = [
        (1 - 2 * (y * y + z * z)) * l1 + 2 * (x * y - w * z) * l2 + 2 * (x * z + w * y) * l3,
        2 * (x * y + w * z) * l1 + (1 - 2 * (x * x + z * z)) * l2 + 2 * (y * z - w * x) * l3,
        2 * (x * z - w * y) * l1 + 2 * (y * z + w * x) * l2 + (1 - 2 * (x * x + y * y)) * l3,
    ]
    size = np.sqrt(sum(component**2 for component in momentum))
    turned = float(np.ptp(size) / size[0])
    energy = abs(run.energy.imbalance) / run.energy.start
    return Found((norm, energy * more, turned * more), how(run), run=run)
