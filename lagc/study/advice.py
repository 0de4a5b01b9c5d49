"""The setting to take for a target: the law of the errors of a method, and the price of a setting."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from statistics import median

import numpy as np

from lagc.kernels.integrators.tableaus import adapts
from lagc.study.probe import Array, Setting

FINEST = {"dop853": 3e-15, "bs32": 1e-10, "radau5": 1e-11}  # tolerances
USUAL = 1e-13  # the finest tolerance of the other methods
SAFE = 0.9  # share of runs that meet the target with the setting for it
FLOOR = 30.0  # times the uncertainty of the reference, or of double precision: errors above follow a law
LEAST_POWER = 0.3  # of a tolerance or step in the law of the error
COARSE = 0.03  # errors above follow no law yet

Sizes = Mapping[tuple[str, float], float]  # a tolerance or step by method and target
NO_SIZES: Sizes = {}


@dataclass
class Point:
    """A setting with its errors, by quantity, and its CPU times in s."""

    setting: Setting
    errors: Array
    rhs: int
    steps: int
    rejected: int
    estimate: float  # s, from the run that gave the errors
    times: list[float] = field(default_factory=list)

    @property
    def error(self) -> float:
        return float(self.errors.max(initial=0.0))

    @property
    def seconds(self) -> float:
        """The least of all times: other work on the machine makes a run slower, never faster."""
        return min(self.times, default=self.estimate)

    @property
    def spread(self) -> float:
        """The median over the least time, less 1."""
        return median(self.times) / self.seconds - 1.0 if self.times else 0.0


@dataclass(frozen=True)
class Law:
    """error = factor size^power; nine of ten runs err by less than `scatter` times that."""

    factor: float
    power: float
    scatter: float

    def size_for(self, target: float) -> float:
        """The tolerance or step with which an error above `target` is unlikely."""
        return float((target / (self.factor * self.scatter)) ** (1.0 / self.power))


@dataclass(frozen=True)
class Advice:
    """The setting for a target, its predicted time, and the price of one digit more (None: not reached).
    `met` of `tried` motions at nearby parameters meet the target."""

    target: float
    setting: Setting | None
    seconds: float
    digit: float | None
    met: int = 0
    tried: int = 0


def setting_of(method: str, size: float) -> Setting:
    """The setting with a tolerance, or with a step in s where the method takes fixed steps."""
    return Setting(method, rtol=size) if adapts(method) else Setting(method, step=size)


def finest(method: str) -> float:
    """The finest tolerance, or step, that is tried."""
    return FINEST.get(method, USUAL) if adapts(method) else 0.0


def fitted(points: Sequence[Point], floor: float) -> Law | None:
    """The law of the points of one method by least squares in logarithms; None for fewer than four."""
    used = [p for p in points if FLOOR * floor < p.error < COARSE]
    if len(used) < 4:
        return None
    x, y = np.log([p.setting.size for p in used]), np.log([p.error for p in used])
    power, offset = np.polyfit(x, y, 1)
    if not power > LEAST_POWER:
        return None  # the error does not follow the setting
    above = float(np.quantile(y - offset - power * x, SAFE))
    return Law(float(np.exp(offset)), float(power), float(np.exp(max(above, 0.0))))


def advise(
    points: Sequence[Point], laws: Mapping[str, Law], target: float, sizes: Sizes = NO_SIZES
) -> Advice:
    """The cheapest setting that meets `target` by the laws, or by the `sizes` that are known better."""
    found: list[tuple[float, Setting, float | None]] = []
    # Methods with a law: its size for the target, and the price of a tenth of the error.
    for method, law in laws.items():
        own = sorted((p for p in points if p.setting.method == method), key=lambda p: p.setting.size)
        size = min(sizes.get((method, target), law.size_for(target)), own[-1].setting.size)
        cost = predicted(own, size)
        if cost is None:
            continue
        more = predicted(own, size * 0.1 ** (1.0 / law.power))
        digit = None if more is None else max(more / cost - 1.0, 0.0)
        found.append((cost, setting_of(method, size), digit))
    # Methods without one count where all their settings meet the target.
    for method in dict.fromkeys(p.setting.method for p in points if p.setting.method not in laws):
        own = [p for p in points if p.setting.method == method]
        if len(own) > 3 and max(p.error for p in own) <= target:  # as where only events limit the steps
            best = min(own, key=lambda p: p.seconds)
            found.append((best.seconds, best.setting, 0.0))
    if not found:
        return Advice(target, None, 0.0, None)
    cost, setting, digit = min(found, key=lambda each: each[0])
    return Advice(target, setting, cost, digit)


def predicted(points: Sequence[Point], size: float) -> float | None:
    """The time at a tolerance or step, from the line through the logarithms of the points nearest to it; None
    below the finest point."""
    if len(points) < 2 or size < 0.99 * points[0].setting.size:
        return None
    near = sorted(points, key=lambda p: abs(np.log(p.setting.size / size)))[:4]
    x, y = np.log([p.setting.size for p in near]), np.log([p.seconds for p in near])
    slope, offset = np.polyfit(x, y, 1)
    return float(np.exp(offset + slope * np.log(size)))
