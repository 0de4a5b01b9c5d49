"""Separate contacts: n balls that fall on one floor from heights of their own, beside MuJoCo.

    python -m tools.benchmarks contacts [--sizes 5,10,20,40]

CPU times of 100 s, in which each ball bounces and comes to rest.  lagc has DOP853 in C at a relative
tolerance of 1e-8; its error is that of the third landing times, sqrt(2h/g) (1 + 2e + 2e^2).  MuJoCo has
springs and dampers with the same restitution in place of impacts, a contact of 20 steps, and the longest step
of 16 ms / 2^k with which these times are within 25 ms.
"""

from __future__ import annotations

import argparse
import importlib
import math
from collections.abc import Sequence
from statistics import linear_regression
from time import process_time
from typing import Any

import lagc
from lagc.compiler import pipeline, stages
from lagc.study.probe import Probe, Setting
from tools.benchmarks.tables import Cell, machine, table

G, E, STOP = 9.81, 0.8, 100.0
LANDINGS, WITHIN = 3, 0.025  # s
CONTACT = 20  # steps
ROUNDS = 3

TEXT = f"""\
model Balls "Balls that fall on one floor, each from its own height"
  structural Integer n = 20;
  coordinate Length y[n](start = {{1 + 0.05*k for k in 1:n}} [m]);
  Gravity field(g = {G} [m/s2], direction = {{0, -1, 0}});
  for i in 1:n loop
    body ball[i] = Particle(mass = 1 [kg], at = {{i*1 [m], y[i], 0}});
    constraint floor[i]: y[i] >= 0 (restitution = {E});
  end for;
end Balls;
"""


def heights(n: int) -> list[float]:
    return [1.0 + 0.05 * k for k in range(1, n + 1)]


def landing(height: float) -> float:
    """The time of the last landing that is compared."""
    return math.sqrt(2.0 * height / G) * (1.0 + 2.0 * sum(E**k for k in range(1, LANDINGS)))


def by_lagc(n: int) -> tuple[float, float]:
    """CPU time in s, and the largest error of the landing times."""
    model = lagc.loads(TEXT).compile(parameters={"n": n}, backend="c")
    program = pipeline.delivered(model.compilation, pipeline.Contents(["dop853"]))
    start = [float(x) for x in model.start(None)]
    probe = Probe(stages.render(program, "c"), program.interface, model._bound(None), start)
    seconds = min(probe.run(Setting("dop853", rtol=1e-8), [0.0, STOP]).seconds for _ in range(ROUNDS))
    run = model.simulate(landing(max(heights(n))) + 0.1, method="dop853", rtol=1e-8)
    found: dict[str, list[float]] = {}
    for event in run.events:
        found.setdefault(event.contact, []).append(event.t)
    pairs = [(found[f"floor[{i}]"][LANDINGS - 1], landing(h)) for i, h in enumerate(heights(n), 1)]
    return seconds, max(abs(a - b) for a, b in pairs)


def damping_ratio() -> float:
    """That of a spring and damper with the restitution, which part where they would pull (T. Schwager,
    T. Poschel, Granul. Matter 9 (2007) 465-469)."""
    ratio = 0.0
    for _ in range(100):  # a fixed point
        angle = math.atan2(2.0 * ratio * math.sqrt(1.0 - ratio**2), 1.0 - 2.0 * ratio**2)
        slope = -math.log(E) / (math.pi - angle)
        ratio = slope / math.hypot(1.0, slope)
    return ratio


def scene(n: int, step: float) -> str:
    """The balls for MuJoCo: half a period of the spring of a contact is CONTACT steps."""
    damping = damping_ratio()
    spring = (math.pi / (CONTACT * step)) ** 2 / (1.0 - damping**2)
    law = f'solref="{-spring!r} {-2.0 * damping * math.sqrt(spring)!r}" solimp="0.9999 0.9999 1" condim="1"'
    balls = "".join(
        f'<body pos="{i} 0 {0.1 + h!r}"><joint type="slide" axis="0 0 1"/>'
        f'<geom type="sphere" size="0.1" mass="1" contype="2" conaffinity="1" {law}/></body>'
        for i, h in enumerate(heights(n))
    )
    floor = f'<geom type="plane" size="0 0 1" contype="1" conaffinity="2" {law}/>'
    option = f'<option timestep="{step!r}" gravity="0 0 {-G}" integrator="implicitfast"/>'
    return f"<mujoco>{option}<worldbody>{floor}{balls}</worldbody></mujoco>"


def errors(mujoco: Any, n: int, step: float) -> float:
    """The largest error of the landing times: those at which a ball turns upwards."""
    model = mujoco.MjModel.from_xml_string(scene(n, step))
    data = mujoco.MjData(model)
    found: list[list[float]] = [[] for _ in range(n)]
    before = data.qvel.copy()
    while data.time < landing(max(heights(n))) + 0.1:
        mujoco.mj_step(model, data)
        for i in range(n):
            if before[i] < 0.0 <= data.qvel[i]:
                found[i].append(data.time)
        before = data.qvel.copy()
    times = [own[LANDINGS - 1] if len(own) >= LANDINGS else math.inf for own in found]
    return max(abs(t - landing(h)) for t, h in zip(times, heights(n)))


def by_mujoco(n: int) -> tuple[float, float, float]:
    """CPU time in s of the longest step that is accurate enough, its error and the step."""
    mujoco = importlib.import_module("mujoco")
    step = 0.016
    while (error := errors(mujoco, n, step)) > WITHIN and step > 1e-4:
        step *= 0.5
    model = mujoco.MjModel.from_xml_string(scene(n, step))
    data = mujoco.MjData(model)
    began = process_time()
    mujoco.mj_step(model, data, nstep=round(STOP / step))
    return process_time() - began, error, step


def exponent(sizes: Sequence[int], times: Sequence[float]) -> float:
    return linear_regression([math.log(n) for n in sizes], [math.log(t) for t in times]).slope


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--sizes", default="5,10,20,40", help="numbers of balls, separated by commas")
    sizes = [int(n) for n in parser.parse_args().sizes.split(",")]
    found: list[list[Cell]] = []
    for n in sizes:
        seconds, error = by_lagc(n)
        row: list[Cell] = [str(n), 1e3 * seconds, error]
        try:
            peer, apart, step = by_mujoco(n)
            row += [1e3 * peer, apart, 1e3 * step, peer / seconds]
        except ImportError:
            row += [None] * 4
        found.append(row)
    print(machine())
    times = [row[1] for row in found if isinstance(row[1], float)]
    if len(sizes) > 1:
        found.append(["exponent", exponent(sizes, times), *[None] * 5])
    head = ("balls", "ms lagc", "error, s", "ms MuJoCo", "error, s", "step, ms", "MuJoCo over lagc")
    table(f"{STOP:g} s", head, found)


if __name__ == "__main__":
    main()
