"""The cheapest set of effects for an accuracy."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from math import prod
from time import perf_counter

import numpy as np

from lagc.study.effect_changes import in_turn, measure_alone
from lagc.study.effects import (
    AS_LONG,
    FINEST,
    Change,
    Choice,
    Comparison,
    Effects,
    Elsewhere,
    Names,
    Progress,
    Refusal,
    Variant,
    largest,
)

MOST = 12  # effects whose sets are all tried
Make = Callable[[Names, Names], Variant | None]
TRIES = 6  # sets that are run for one accuracy
CLEAR_COST = (0.8, 1.25)  # ratios of evaluations outside are no chance


def study(
    comparison: Comparison,
    closure: Callable[[Names], Names | None],
    offered: Sequence[str],
    accuracies: Sequence[float],
    progress: Progress,
    elsewhere: Mapping[str, Make] | None = None,
) -> Effects:
    """Fill in the results of `comparison`.  `closure(names)` gives a set with all effects that need it, None
    if the scene needs it.  `offered` are effects that the scene leaves out.  `elsewhere` makes the variants
    of other initial states."""
    found, began = comparison.found, perf_counter()
    try:
        # Sets are predicted from the curves of single effects, so these come first.
        measure_alone(comparison, closure, offered, progress)
        _sets(comparison, accuracies, progress)
        for start, make in (elsewhere or {}).items():
            _verify(comparison, start, make)
        found.complete = True
    except KeyboardInterrupt:
        found.notes.append("interrupted: this is what was measured until then")
    found.spent = perf_counter() - began
    return found


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
    times = comparison.base.times[: comparison.count]
    for one in usable:
        assert one.curve is not None
        above = np.abs(one.curve).max(axis=0, initial=0.0)
        for accuracy in accuracies:
            if above.max(initial=0.0) > accuracy:
                one.until[accuracy] = float(times[np.argmax(above > accuracy)])
    for k, accuracy in enumerate(accuracies):
        progress(0.65 + 0.35 * k / max(len(accuracies), 1), f"scene for {accuracy:.0e}")
        found.sets.append(_cheapest(comparison, known, accuracy))


def _verify(comparison: Comparison, start: str, make: Make) -> None:
    """Run the recommended sets from another initial state."""
    found = comparison.found
    chosen = [one for one in found.sets if one.left_out]
    there = Effects(found.scene, found.stop, found.effects)
    try:
        other = Comparison(make, there, 10.0 * comparison.accuracy, comparison.of)
    except Refusal as reason:
        found.also += [Elsewhere(start, c.accuracy, c.left_out, None, 0.0, str(reason)) for c in chosen]
        return
    made = {one.left_out: other.variant(frozenset(one.left_out)) for one in chosen}
    other.compare_in([variant for variant in made.values() if variant is not None])
    for one in chosen:
        variant = made[one.left_out]
        assert variant is not None  # as it was here
        motion = variant.motion(other.accuracy)
        curves = other.curves(motion)
        change, ends = (None, curves) if isinstance(curves, str) else (largest(curves), "")
        bar = other.bar(motion) if change is not None else 0.0
        found.also.append(Elsewhere(start, one.accuracy, one.left_out, change, bar, ends))


def _candidates(comparison: Comparison, usable: Sequence[Change]) -> Iterable[_Set]:
    """Yield the sets of effects that are closed: with an effect, those that need it."""
    found = comparison.found
    stepping = _stepping(found)
    by_name = {one.effect: one for one in usable}
    for count in range(len(usable) + 1):
        for names in combinations(by_name, count):
            members = frozenset(names)
            if not all(by_name[name].members <= members for name in names):
                continue
            # An effect that another one takes along is counted in that one. By the triangle inequality the
            # change of a set is at most the sum of absolute differences, `bound`; with their signs they may
            # cancel, `signed`.
            needed = {other for name in names for other in by_name[name].along}
            parts = [by_name[name] for name in names if name not in needed]
            curves = [part.curve for part in parts if part.curve is not None]
            bound = largest(sum((np.abs(c) for c in curves[1:]), np.abs(curves[0]))) if curves else 0.0
            signed = largest(sum(curves[1:], curves[0])) if curves else 0.0
            operations = max(found.operations + sum(p.operations - found.operations for p in parts), 1)
            # t = rhs (s + (1 - s) operations): counts of right-hand sides multiply, where they differ by
            # more than chance, and s is the part of the time that the steps take.
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
        # The set is compared in two runs: an exact one, whose change is reported, and one with half of the
        # accuracy, which the user will make; its change includes the error of the run.
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
