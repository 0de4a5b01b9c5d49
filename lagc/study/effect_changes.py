"""The change by each effect alone, and the times of runs."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from lagc.study.effects import CLEAR, Change, Comparison, Motion, Names, Progress, Variant, largest

AMPLIFIED = tuple(10.0**k for k in range(1, 8))
AGREE = 0.01  # between two amplifications
ROUNDS = 9  # in which times are measured in turn
LEAST_TIME = 2e-3  # s of one measurement


def measure_alone(
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
    # All variants are compiled before any is run: what they have in common is what is compared.
    comparison.compare_in(variants.values())
    found.operations, found.states = full.operations, full.states
    found.energy, works = full.works(comparison.base)
    for k, (effect, variant) in enumerate(variants.items()):
        progress(0.4 + 0.2 * k / max(len(variants), 1), f"run without {effect}")
        along = tuple(sorted((units[effect] or frozenset()) - {effect}))
        one = Change(effect, along, variant.operations, variant.states, work=works.get(effect))
        _compare(comparison, one, variant, variant.motion(comparison.accuracy))
        found.left_out.append(one)
    _time(comparison, found.left_out, variants)
    # Effects that the scene leaves out are compared only where they bring the same quantities.
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
    gone = [name for _, name in comparison.base.events if name not in motion.clauses]
    one.events = tuple(dict.fromkeys(gone))
    if variant is None or one.along or one.change >= CLEAR * one.bar:
        return
    if comparison.full.same_along(comparison.base, variant):
        one.acted, one.change, one.curve = False, 0.0, np.zeros_like(curves)
        one.nearest = comparison.full.nearest(comparison.base, variant)
    else:
        _amplify(comparison, one, variant)


def _amplify(comparison: Comparison, one: Change, variant: Variant) -> None:
    """Measure a change below the error bars with a stronger effect.  A strength is a parameter of the effect
    without which the equations are those of the variant; the change is proportional to it."""
    full = comparison.full
    for parameter in full.parameters:
        if parameter in variant.parameters or not full.same_along(comparison.base, variant, parameter):
            continue
        # The factor grows until two amplifications agree: then the change is proportional to it, and stands
        # clear of its error bar.
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
