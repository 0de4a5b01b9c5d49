"""The effects of a scene: what each changes and costs, and the cheapest scene for an accuracy.

The changes of a set are predicted by the sum of the absolute difference curves of its members, which needs no
luck with signs.  A set that is recommended was run and compared with the full scene.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import combinations, pairwise
from math import inf, prod
from time import perf_counter
from typing import Protocol

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

FINER = 10.0  # the full run is this much more exact than the finest accuracy asked
FINEST = 1e-11  # accuracy of any run
CLEAR = 10.0  # error bars: a smaller change is measured with the effect amplified
AMPLIFIED = tuple(10.0**k for k in range(1, 8))
AGREE = 0.01  # between two amplifications
MOST = 12  # effects whose sets are all tried
TRIES = 6  # sets that are run for one accuracy
CLEAR_COST = (0.8, 1.25)  # ratios of evaluations outside are no chance
AS_LONG = 0.05  # relative difference of times that does not count
ROUNDS = 9  # in which times are measured in turn
LEAST_TIME = 2e-3  # s of one measurement
NOTHING = 2.0**-1000  # scale of a quantity whose unit has no size in the full scene

Names = frozenset[str]
Progress = Callable[[float, str], None]


@dataclass(frozen=True)
class Motion:
    """A verified run: a row of `values` for each name.  `ends` says why it ended early; "" if it did not."""

    times: Array
    values: Mapping[str, Array]
    states: Sequence[Sequence[float]]
    errors: Mapping[str, float]
    events: tuple[tuple[float, str], ...]
    method: str
    rtol: float
    ends: str = ""


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
    left_out: list[Change] = field(default_factory=list)
    added: list[Change] = field(default_factory=list)
    sets: list[Choice] = field(default_factory=list)
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

    def variant(self, without: Names, more: Names = frozenset()) -> Variant | None:
        if (without, more) not in self.variants:
            self.variants[without, more] = self.make(without, more)
        return self.variants[without, more]

    def compare_in(self, variants: Iterable[Variant]) -> None:
        """Set the quantities that all of these variants have, and their scales."""
        own = [name for name in self.full.names if not self.of or name in self.of]
        kept = [name for name in own if all(name in variant.names for variant in variants)]
        found, base = self.found, self.base
        self.names = tuple(kept)
        found.not_compared = tuple([name for name in self.full.names if name not in kept])
        units = self.full.units
        largest = {name: float(np.abs(values).max(initial=0.0)) for name, values in base.values.items()}
        for name in kept:
            span, size = float(np.ptp(base.values[name])), largest[name]
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
        base = self.base
        if motion.ends or len(motion.times) != len(base.times):
            return motion.ends or "it ends at another time"
        if [name for _, name in motion.events] != [name for _, name in base.events]:
            return "other events happen, or in another order"
        rows = [(motion.values[name] - base.values[name]) / self.scale(name) for name in self.names]
        found = np.array(rows).reshape(len(self.names), len(base.times)) / factor
        shift = np.zeros(len(base.times))
        for (t, _), (other, _) in zip(motion.events, base.events):
            inside = (base.times >= min(t, other)) & (base.times <= max(t, other))
            found[:, inside] = 0.0
            shift[np.searchsorted(base.times, other).clip(max=len(shift) - 1)] = abs(t - other) / (
                base.times[-1] - base.times[0]
            )
        return np.vstack([found, shift / factor]) if base.events else found


def largest(curves: Array) -> float:
    return float(np.abs(curves).max(initial=0.0))


def study(
    comparison: Comparison,
    closure: Callable[[Names], Names | None],
    offered: Sequence[str],
    accuracies: Sequence[float],
    progress: Progress,
) -> Effects:
    """Fill in the results of `comparison`.  `closure(names)` gives a set with all effects that need it, None
    if the scene needs it.  `offered` are effects that the scene leaves out."""
    found, began = comparison.found, perf_counter()
    try:
        _singles(comparison, closure, offered, progress)
        _sets(comparison, accuracies, progress)
        found.complete = True
    except KeyboardInterrupt:
        found.notes.append("interrupted: this is what was measured until then")
    found.spent = perf_counter() - began
    return found


# -- each effect alone ----------------------------------------------------------------------------


def _singles(
    comparison: Comparison,
    closure: Callable[[Names], Names | None],
    offered: Sequence[str],
    progress: Progress,
) -> None:
    found, full = comparison.found, comparison.full
    units = {effect: closure(frozenset([effect])) for effect in found.effects}
    variants: dict[str, Variant] = {}
    for k, (effect, unit) in enumerate(units.items()):
        progress(0.4 * k / max(len(units), 1), f"without {effect}")
        variant = None if unit is None else comparison.variant(unit)
        if variant is None:
            found.notes.append(f"`{effect}` cannot be left out: the scene needs it")
        else:
            variants[effect] = variant
    comparison.compare_in(variants.values())
    found.operations, found.states = full.operations, full.states
    for k, (effect, variant) in enumerate(variants.items()):
        progress(0.4 + 0.2 * k / max(len(variants), 1), f"run without {effect}")
        along = tuple(sorted((units[effect] or frozenset()) - {effect}))
        one = Change(effect, along, variant.operations, variant.states)
        _compare(comparison, one, variant, variant.motion(comparison.accuracy))
        found.left_out.append(one)
    _time(comparison, found.left_out, variants)
    for effect in offered:
        variant = comparison.variant(frozenset(), frozenset([effect]))
        if variant is None:
            continue
        one = Change(effect, (), variant.operations, variant.states, how="added")
        added = variant.motion(comparison.accuracy)
        if all(name in variant.names for name in comparison.names):
            _compare(comparison, one, None, added)
            found.added.append(one)


def _compare(comparison: Comparison, one: Change, variant: Variant | None, motion: Motion) -> None:
    """Set the change of one effect; amplified if it is within the error bars."""
    curves = comparison.curves(motion)
    if isinstance(curves, str):
        one.ends = curves
        return
    one.curve, one.change, one.bar = curves, largest(curves), comparison.bar(motion)
    one.per = {name: largest(row) for name, row in zip(comparison.names, curves)}
    if variant is None or one.along or one.change >= CLEAR * one.bar:
        return
    if comparison.full.same_along(comparison.base, variant):
        one.acted, one.change, one.curve = False, 0.0, np.zeros_like(curves)
    else:
        _amplify(comparison, one, variant)


def _amplify(comparison: Comparison, one: Change, variant: Variant) -> None:
    """Measure a change below the error bars with a stronger effect.  A strength is a parameter of the effect
    without which the equations are those of the variant; the change is proportional to it."""
    full = comparison.full
    for parameter in full.parameters:
        if parameter in variant.parameters or not full.same_along(comparison.base, variant, parameter):
            continue
        last = None
        for factor in AMPLIFIED:
            motion = full.motion(comparison.accuracy, (parameter, 1.0 + factor))
            curves = comparison.curves(motion, factor)
            if isinstance(curves, str):
                return
            change, bar = largest(curves), comparison.bar(motion) / factor
            close = last is not None and abs(change - last) <= AGREE * change
            if close and change > CLEAR * bar:
                one.curve, one.change, one.bar = -curves, change, bar + abs(change - (last or 0.0))
                one.how = f"{parameter} times {factor:g}"
                one.per = {name: largest(row) for name, row in zip(comparison.names, curves)}
                return
            last = change
    one.how = "below the error bar"


def _time(comparison: Comparison, changes: Sequence[Change], variants: Mapping[str, Variant]) -> None:
    """Measure the times of runs in turn, with the settings of the full scene for the accuracy 1e-6."""
    found, setting = comparison.found, comparison.full.motion(1e-6)
    times = in_turn({"": comparison.full, **variants}, setting)
    (found.seconds, found.rhs) = times[""]
    for one in changes:
        seconds, one.rhs = times[one.effect]
        one.time = seconds / found.seconds


def in_turn(variants: Mapping[str, Variant], setting: Motion) -> dict[str, tuple[float, int]]:
    """Return the CPU time in s of each run, the least of rounds in which all see the same machine, and its
    evaluations of the right-hand side.  All have the method and tolerance of `setting`: the verified ones
    differ by chance."""
    repeats: dict[str, int] = {}
    rhs: dict[str, int] = {}
    for name, variant in variants.items():
        seconds, rhs[name] = variant.plain(setting, 1)
        repeats[name] = max(1, round(LEAST_TIME / max(seconds, 1e-6)))
    found: dict[str, list[float]] = {name: [] for name in variants}
    for _ in range(ROUNDS):
        for name, variant in variants.items():
            found[name].append(variant.plain(setting, repeats[name])[0])
    return {name: (min(times), rhs[name]) for name, times in found.items()}


# -- sets -----------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Set:
    members: Names
    bound: float  # the largest sum of absolute differences
    signed: float  # the largest sum of differences
    operations: int
    rhs: float  # of the full scene
    time: float  # of the full scene, predicted


def _sets(comparison: Comparison, accuracies: Sequence[float], progress: Progress) -> None:
    found = comparison.found
    usable = [one for one in found.left_out if one.curve is not None]
    usable.sort(key=lambda one: one.change or 0.0)
    found.not_tried = tuple([one.effect for one in usable[MOST:]])
    known = list(_candidates(comparison, usable[:MOST]))
    for k, accuracy in enumerate(accuracies):
        progress(0.65 + 0.35 * k / max(len(accuracies), 1), f"scene for {accuracy:.0e}")
        found.sets.append(_cheapest(comparison, known, accuracy))


def _candidates(comparison: Comparison, usable: Sequence[Change]) -> Iterable[_Set]:
    """All sets that are closed: with an effect, those that need it."""
    found = comparison.found
    stepping = _stepping(found)
    by_name = {one.effect: one for one in usable}
    for count in range(len(usable) + 1):
        for names in combinations(by_name, count):
            members = frozenset(names)
            if not all(by_name[name].members <= members for name in names):
                continue
            needed = {other for name in names for other in by_name[name].along}
            parts = [by_name[name] for name in names if name not in needed]
            curves = [part.curve for part in parts if part.curve is not None]
            bound = largest(sum((np.abs(c) for c in curves[1:]), np.abs(curves[0]))) if curves else 0.0
            signed = largest(sum(curves[1:], curves[0])) if curves else 0.0
            operations = max(found.operations + sum(p.operations - found.operations for p in parts), 1)
            low, high = CLEAR_COST
            ratios = [part.rhs / max(found.rhs, 1) for part in parts]
            rhs = prod(r for r in ratios if not low <= r <= high)
            time = rhs * (stepping + (1.0 - stepping) * operations / max(found.operations, 1))
            yield _Set(members, bound, signed, operations, rhs, time)


def _stepping(found: Effects) -> float:
    """Return the part of the time that does not depend on the operations, from the times of single effects,
    by least squares in t/rhs = s + (1 - s) operations."""
    above = below = 0.0
    for one in found.left_out:
        if one.rhs and one.operations < found.operations:
            saved = 1.0 - one.operations / found.operations
            above += saved * (1.0 - one.time * found.rhs / one.rhs)
            below += saved * saved
    return min(max(1.0 - above / below, 0.0), 1.0) if below else 0.5


def _cheapest(comparison: Comparison, known: Sequence[_Set], accuracy: float) -> Choice:
    """The cheapest set that stays below the accuracy, as run and compared."""
    found, full = comparison.found, comparison.full
    allowed = [s for s in known if s.members and s.bound <= accuracy and s.time <= 1.0 + AS_LONG]
    allowed.sort(key=_price)
    half = max(accuracy / 2.0, FINEST)
    tries = 0
    for one in allowed[:TRIES]:
        tries += 1
        variant = comparison.variant(one.members)
        if variant is None:
            continue
        exact = comparison.curves(variant.motion(comparison.accuracy))
        run = variant.motion(half)
        curves = comparison.curves(run)
        if isinstance(curves, str) or isinstance(exact, str):
            continue
        if largest(curves) + found.bar > accuracy:
            continue
        times = in_turn({"full": full, "set": variant}, full.motion(half))
        ratio = times["set"][0] / times["full"][0]
        if ratio > 1.0 + AS_LONG:
            continue
        left_out = tuple([e for e in found.effects if e in one.members])
        lucky = _cancelling(found, known, one, accuracy)
        return Choice(accuracy, left_out, one.bound, largest(exact), found.bar, ratio, one.time,
                      variant.operations, variant.states, tries, True, lucky)  # fmt: skip
    return Choice(accuracy, (), 0.0, 0.0, found.bar, 1.0, 1.0, full.operations, full.states, tries, not tries)


def _price(one: _Set) -> tuple[float, int, int]:
    """Predicted times that differ by less than AS_LONG are equal."""
    return (round(one.time / AS_LONG), one.operations, -len(one.members))


def _cancelling(found: Effects, known: Sequence[_Set], chosen: _Set, accuracy: float) -> tuple[str, ...]:
    """A cheaper set that stays below the accuracy only as its members cancel; () if there is none."""
    lucky = [
        s for s in known
        if s.signed <= accuracy < s.bound and s.operations < chosen.operations and s.time < chosen.time
    ]  # fmt: skip
    best = min(lucky, key=_price, default=None)
    return () if best is None else tuple([e for e in found.effects if e in best.members])


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
