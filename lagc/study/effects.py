"""The effects of a scene: what each changes and costs, and the cheapest scene for an accuracy.

The changes of a set are predicted by the sum of the absolute difference curves of its members, which needs no
luck with signs.  A set that is recommended was run and compared with the full scene.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from math import inf
from typing import Protocol

import numpy as np
import numpy.typing as npt

from lagc.simulation.works import Works

Array = npt.NDArray[np.float64]

FINER = 10.0  # the full run is this much more exact than the finest accuracy asked
FINEST = 1e-11  # accuracy of any run
CLEAR = 10.0  # error bars: a smaller change is measured with the effect amplified
AS_LONG = 0.05  # relative difference of times that does not count
NOTHING = 2.0**-1000  # scale of a quantity whose unit has no size in the full scene

Names = frozenset[str]
Progress = Callable[[float, str], None]


@dataclass(frozen=True)
class Motion:
    """A verified run: a row of `values` for each name.  `ends` says why it failed; "" if it did not, or
    if it is `cut`: beyond its last time it is not predictable."""

    times: Array
    values: Mapping[str, Array]
    states: Sequence[Sequence[float]]
    errors: Mapping[str, float]
    events: tuple[tuple[float, str], ...]
    method: str
    rtol: float
    ends: str = ""
    cut: bool = False
    clauses: frozenset[str] = frozenset()  # names of all events that the scene may have


class Variant(Protocol):
    """The scene without some effects, compiled."""

    names: tuple[str, ...]  # of coordinates and outputs
    units: dict[str, str]
    parameters: tuple[str, ...]
    operations: int
    states: int

    def motion(self, accuracy: float, scaled: tuple[str, float] | None = None) -> Motion:
        """Return a run; `scaled`: with one parameter multiplied."""

    def plain(self, setting: Motion, repeats: int) -> tuple[float, int]:
        """Return CPU time and evaluations of the plain run with the method and tolerance of `setting`."""

    def same_along(self, motion: Motion, other: Variant, without: str = "") -> bool:
        """Return whether the rates at the recorded states of a motion are those of `other`; `without`: with
        this parameter 0."""

    def nearest(self, motion: Motion, other: Variant) -> tuple[tuple[str, float], ...]:
        """Return the relations that `other` lacks, each with the least size of its event indicator."""

    def works(self, motion: Motion) -> tuple[Works | None, dict[str, float]]:
        """Return the works of a motion, and those of the actions and clauses of each effect, in J."""


@dataclass
class Change:
    """An effect left out, with the effects that need it, or one added.  `change` is the largest difference of
    all quantities over time, each of its scale; None if the run ends differently (`ends`)."""

    effect: str
    along: tuple[str, ...]
    operations: int = 0
    states: int = 0
    rhs: int = 0
    time: float = inf  # of the full scene
    change: float | None = None
    bar: float = 0.0
    how: str = "left out"
    ends: str = ""
    per: dict[str, float] = field(default_factory=dict)
    acted: bool = True
    work: float | None = None  # of actions, clauses, contacts in the full scene, J; None: it has none
    events: tuple[str, ...] = ()  # its own ones, which vanish
    nearest: tuple[tuple[str, float], ...] = ()  # of its conditions to 0, if it did not act
    until: dict[float, float] = field(default_factory=dict)  # s that it stays below an accuracy
    curve: Array | None = None

    @property
    def members(self) -> Names:
        return frozenset((self.effect, *self.along))


@dataclass(frozen=True)
class Choice:
    """The cheapest scene for an accuracy.  `found` is False where no set that was tried stays below it."""

    accuracy: float
    left_out: tuple[str, ...]
    predicted: float
    change: float
    bar: float
    time: float
    predicted_time: float
    operations: int
    states: int
    tries: int
    found: bool = True
    cancelling: tuple[str, ...] = ()


@dataclass(frozen=True)
class Elsewhere:
    """A recommended set for another initial state, where `change` is None if the run ends differently."""

    start: str
    accuracy: float
    left_out: tuple[str, ...]
    change: float | None
    bar: float
    ends: str = ""

    @property
    def holds(self) -> bool:
        return self.change is not None and self.change + self.bar <= self.accuracy


@dataclass
class Effects:
    """The results; `complete` is False where the user ended it early."""

    scene: str
    stop: float
    effects: tuple[str, ...]
    scales: dict[str, tuple[float, str]] = field(default_factory=dict)  # size, and what it is
    units: dict[str, str] = field(default_factory=dict)
    not_compared: tuple[str, ...] = ()
    operations: int = 0
    states: int = 0
    rhs: int = 0
    seconds: float = 0.0
    bar: float = 0.0  # of the full run
    energy: Works | None = None  # of the full scene
    horizon: float | None = None  # s, the end of what is compared, where a run is chaotic
    left_out: list[Change] = field(default_factory=list)
    added: list[Change] = field(default_factory=list)
    sets: list[Choice] = field(default_factory=list)
    also: list[Elsewhere] = field(default_factory=list)
    not_tried: tuple[str, ...] = ()
    notes: list[str] = field(default_factory=list)
    spent: float = 0.0
    complete: bool = False


class Refusal(Exception):
    """The full scene does not run to its end."""


class Comparison:
    """The full scene, its variants and their runs."""

    def __init__(
        self, make: Callable[[Names, Names], Variant | None], found: Effects, finest: float,
        of: Sequence[str] = (),
    ):  # fmt: skip
        self.make, self.found, self.of = make, found, of
        self.accuracy = max(finest / FINER, FINEST)
        self.variants: dict[tuple[Names, Names], Variant | None] = {}
        full = self.variant(frozenset())
        assert full is not None
        self.full = full
        self.base = full.motion(self.accuracy)
        if self.base.ends:
            raise Refusal(self.base.ends)
        self.names: tuple[str, ...] = ()
        self.count = len(self.base.times)

    def variant(self, without: Names, more: Names = frozenset()) -> Variant | None:
        if (without, more) not in self.variants:
            self.variants[without, more] = self.make(without, more)
        return self.variants[without, more]

    def compare_in(self, variants: Iterable[Variant]) -> None:
        """Set the quantities that all of these variants have, their scales, and the time until which all runs
        are predictable."""
        variants = list(variants)
        motions = [variant.motion(self.accuracy) for variant in variants]
        cut = [motion for motion in (self.base, *motions) if motion.cut]
        if cut:
            self.count = min(len(motion.times) for motion in (self.base, *cut))
            self.found.horizon = float(self.base.times[self.count - 1])
        # A quantity is compared if every variant has it. Its scale is its range; where it stands still
        # within ten error bars its size; where it is zero the largest quantity of its unit.
        own = [name for name in self.full.names if not self.of or name in self.of]
        kept = [name for name in own if all(name in variant.names for variant in variants)]
        found, base = self.found, self.base
        self.names = tuple(kept)
        found.not_compared = tuple([name for name in self.full.names if name not in kept])
        units = self.full.units
        kept_values = {name: values[: self.count] for name, values in base.values.items()}
        largest = {name: float(np.abs(values).max(initial=0.0)) for name, values in kept_values.items()}
        for name in kept:
            span, size = float(np.ptp(kept_values[name])), largest[name]
            unit = max(largest[other] for other in largest if units.get(other) == units.get(name))
            least = CLEAR * base.errors.get(name, 0.0)
            scale = (span, "range") if span > least else (size, "size") if size > least else (unit, "unit")
            found.scales[name] = scale
        found.units = {name: units.get(name, "") for name in kept}
        found.bar = self.bar(base)

    def scale(self, name: str) -> float:
        return self.found.scales[name][0] or NOTHING

    def bar(self, motion: Motion) -> float:
        """The error bars of a run and of the full one, each of its scale."""
        base = self.base if motion is not self.base else None
        sums = [
            (motion.errors.get(name, 0.0) + (base.errors.get(name, 0.0) if base else 0.0)) / self.scale(name)
            for name in self.names
        ]
        return max(sums, default=0.0)

    def curves(self, motion: Motion, factor: float = 1.0) -> Array | str:
        """Return the differences from the full run, a row for each quantity; or why they do not compare.
        Between the two times of an event that both runs have, and at these, quantities may jump: such times
        do not count, but the shift of the event does, as a part of the time."""
        base, count = self.base, self.count
        if motion.ends:
            return motion.ends
        if len(motion.times) < count or (count == len(base.times) != len(motion.times) and not base.cut):
            return "it ends at another time"
        times = base.times[:count]
        both = motion.clauses & base.clauses  # events of what is left out are no difference
        own, others = (
            [(t, name) for t, name in run.events if t <= times[-1] and name in both] for run in (motion, base)
        )  # fmt: skip
        if [name for _, name in own] != [name for _, name in others]:
            return "other events happen, or in another order"
        # Differences over the scales. `factor` is the amplification of the effect, to which they are
        # proportional.
        rows = [(motion.values[n][:count] - base.values[n][:count]) / self.scale(n) for n in self.names]
        found = np.array(rows).reshape(len(self.names), count) / factor
        # Between the two times of an event one run has jumped and the other has not: there the difference
        # says nothing but the shift in time, which gets a row of its own.
        shift = np.zeros(count)
        for (t, _), (other, _) in zip(own, others):
            inside = (times >= min(t, other)) & (times <= max(t, other))
            found[:, inside] = 0.0
            shift[np.searchsorted(times, other).clip(max=count - 1)] = abs(t - other) / (times[-1] - times[0])
        return np.vstack([found, shift / factor]) if base.events else found


def largest(curves: Array) -> float:
    return float(np.abs(curves).max(initial=0.0))


def joined(sets: Sequence[Choice]) -> list[list[Choice]]:
    """Group neighbours that leave out the same."""
    groups: list[list[Choice]] = []
    for before, one in pairwise([None, *sets]):
        assert one is not None
        same = before is not None and (before.left_out, before.found) == (one.left_out, one.found)
        if same:
            groups[-1].append(one)
        else:
            groups.append([one])
    return groups
