"""A run in a dozen lines: where it ended, how well, and at what price.  Nothing heavy is imported."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from lagc.run.solution import Solution

SHOWN = 24  # final values; of longer lists the first are shown
DEGREE = math.pi / 180.0


def summary(solution: Solution, color: bool = False) -> str:
    """The summary as text, without a newline at its end; `color` for a terminal."""
    bold, dim, red, plain = ("\033[1m", "\033[2m", "\033[31m", "\033[0m") if color else ("", "", "", "")
    lines = [f"{bold}{_title(solution)}{plain}", f"{dim}{_how(solution)}{plain}"]
    if solution.status != "ok":
        mark = red if solution.status == "failed" else bold
        lines.append(f"{mark}{solution.status}: {solution.message}{plain}")
    for event in solution.events:
        lines.append(f"event      {event.name} at t = {value(event.t)} s")
    if solution.times:
        lines += ["", f"at t = {value(solution.times[-1])} s", *_finals(solution)]
    lines += ["", *_quality(solution), _price(solution)]
    return "\n".join(lines)


def value(x: float) -> str:
    """Nine digits."""
    return f"{x:.9g}"


def size(x: float) -> str:
    """An order of magnitude: two digits."""
    return f"{x:.2g}"


def _title(solution: Solution) -> str:
    interface = solution.system.interface
    effects = ", ".join(interface.effects) or "none"
    return f"{interface.model}, scene {interface.scene} (effects: {effects})"


def _how(solution: Solution) -> str:
    way = f"rtol {size(solution.rtol)}, atol {size(solution.atol)}"
    if solution.step:
        way = f"steps of {solution.step:g} s"
    return f"{solution.method}, {way}, backend {solution.system.backend}"


def _finals(solution: Solution) -> list[str]:
    final, units = solution.final(), solution.units
    names = list(final)[:SHOWN] if len(final) > SHOWN else list(final)
    wide = max((len(n) for n in names), default=0)
    lines = []
    for name in names:
        unit = units.get(name, "")
        line = f"  {name:<{wide}}  {value(final[name]):>16} {unit}".rstrip()
        if unit in ("rad", "rad/s"):
            line = f"{line:<{wide + 26}} {value(final[name] / DEGREE):>16} {unit.replace('rad', 'deg')}"
        lines.append(line)
    if len(final) > SHOWN:
        lines.append(f"  and {len(final) - SHOWN} more: -o FILE saves all of them")
    return lines


def _quality(solution: Solution) -> list[str]:
    lines = []
    if solution.asked is not None:
        estimate = "not estimated" if solution.estimated is None else f"estimated {size(solution.estimated)}"
        lines.append(f"accuracy   asked {size(solution.asked)}, {estimate}")
    if solution.system.nc:
        drift = f"positions {size(solution.position_drift)}, velocities {size(solution.velocity_drift)}"
        lines.append(f"drift      {drift} (largest constraint residuals, scaled)")
    energy = solution.energy
    work = f", work {value(energy.work)} J" if energy.work else ""
    ends = f"start {value(energy.start)} J, end {value(energy.end)} J"
    lines.append(f"energy     {ends}{work}, imbalance {size(energy.imbalance)} J")
    return lines


def _price(solution: Solution) -> str:
    cost = solution.cost
    rejected = f" ({cost.rejected} rejected)" if cost.rejected else ""
    runs = f" in {cost.integrations} integrations" if cost.integrations > 1 else ""
    times = f"run {duration(cost.run_s)}, compile {duration(cost.compile_s)}"
    return (
        f"price      {cost.steps} steps{rejected}{runs}, {cost.rhs} x {cost.operations} operations, {times}"
    )


def duration(seconds: float) -> str:
    if seconds >= 1.0:
        return f"{seconds:.2f} s"
    return f"{seconds * 1e3:.3g} ms" if seconds >= 1e-3 else f"{seconds * 1e6:.3g} us"
