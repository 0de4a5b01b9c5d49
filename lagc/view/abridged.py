"""Equations of large models on a page: some of many, and sums whose terms follow a rule written as such.

What is left out is said.  A rule is read off the written terms: those that differ in their indices and their
coefficient alone, each by the same from one to the next.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from fractions import Fraction
from typing import TypeAlias

from lagc.records import dataclass

MOST = 20  # formulas of a kind, all of which are shown
TERMS = 30  # of a sum
_FIRST, _LAST = 2, 1  # of formulas of one kind, where not all are
FEW = 6  # terms of a sum that stays as it is
_LEAST = 4  # terms of a series
_SIMPLE = 1000  # denominators of rules
_ROUNDING = Fraction(1, 10**13)  # of coefficients
ALL = "--full shows them"


Member: TypeAlias = tuple[int, list[Fraction]]  # number of a term; its coefficient, then its indices


@dataclass(frozen=True, slots=True)
class Chosen:
    """The formulas that are shown, by number, and the words for the others ("" where there are none)."""

    numbers: list[int]
    words: str


def chosen(labels: Sequence[str], full: bool) -> Chosen:
    """Of formulas with such labels."""
    if full or len(labels) <= MOST:
        return Chosen(list(range(len(labels))), "")
    kinds: dict[str, list[int]] = {}
    for k, label in enumerate(labels):
        kinds.setdefault(re.sub(r"\d+", "0", label), []).append(k)
    shown: list[int] = []
    gaps: list[str] = []
    for numbers in kinds.values():
        middle = numbers[_FIRST:-_LAST]
        if len(middle) < _LEAST:
            middle = []
        shown += [k for k in numbers if k not in middle]
        if middle:
            gaps.append(f"{labels[middle[0]]} to {labels[middle[-1]]}")
    shown.sort()
    if len(shown) > MOST:
        gaps, shown = [*gaps, "others"], shown[:MOST]
    left_out = len(labels) - len(shown)
    return Chosen(shown, f"and {left_out} more, of {', '.join(gaps)}: {ALL}" if left_out else "")


@dataclass(frozen=True, slots=True)
class Term:
    """A term as it is written without its coefficient."""

    coefficient: Fraction
    text: str


@dataclass(frozen=True, slots=True)
class Series:
    """The sum over k from `first` to `last` of `factor` (a + b k) times a text, in whose `pieces` an index
    a + b k stands between every two; `weight` and `indices` are these a, b."""

    factor: Fraction
    weight: tuple[int, int]
    pieces: list[str]
    indices: list[tuple[int, int]]
    first: int
    last: int


def series(terms: Sequence[Term], index: re.Pattern[str]) -> list[Term | Series]:
    """`terms` with those that follow a rule in the place of their first; `index` matches an index."""
    alike: dict[tuple[str, ...], list[Member]] = {}
    for number, term in enumerate(terms):
        values = [term.coefficient, *(Fraction(found) for found in index.findall(term.text))]
        alike.setdefault(tuple(index.split(term.text)), []).append((number, values))
    found: dict[int, Term | Series] = dict(enumerate(terms))
    for pieces, group in alike.items():
        for run in _runs(group):
            made = _series(list(pieces), [values for _, values in run])
            if made is not None:
                for number, _ in run:
                    del found[number]
                found[run[0][0]] = made
    return [found[number] for number in sorted(found)]


def _runs(group: Sequence[Member]) -> list[list[Member]]:
    """Consecutive members whose values change by the same, as many as may be; those that are long enough."""
    runs: list[list[Member]] = []
    run: list[Member] = []
    for member in group:
        if len(run) > 1 and not _goes_on(run, member):
            runs.append(run)
            run = [] if len(run) >= _LEAST else run[-1:]
        run.append(member)
    return [run for run in (*runs, run) if len(run) >= _LEAST]


def _goes_on(run: Sequence[Member], member: Member) -> bool:
    """Indices exactly; coefficients, which may be decimals, but for rounding: of what changes evenly, an end
    is the largest."""
    n = len(run)
    expected = [a + n * (b - a) for a, b in zip(run[0][1], run[1][1])]
    slack = _ROUNDING * max(abs(x[1][0]) for x in (run[0], run[-1], member))
    return expected[1:] == member[1][1:] and abs(expected[0] - member[1][0]) <= n * slack


def _series(pieces: list[str], values: list[list[Fraction]]) -> Series | None:
    """Counted by the first index that goes up by one, or down; None where there is none, or no short rule for
    the coefficients."""
    changes = [b - a for a, b in zip(*values[:2])]
    steps = [k for k, change in enumerate(changes) if k > 0 and abs(change) == 1]
    if not steps:
        return None
    if changes[steps[0]] < 0:
        values = values[::-1]
    first, last = int(values[0][steps[0]]), int(values[-1][steps[0]])
    ends = zip(values[0], values[-1])
    (start, step), *others = (
        (a - (b - a) / (last - first) * first, (b - a) / (last - first)) for a, b in ends
    )
    indices = [(int(a), int(b)) for a, b in others]
    if abs(step) * (last - first) <= _ROUNDING * abs(values[0][0]):
        return Series(values[0][0], (1, 0), pieces, indices, first, last)
    ratio = (start / abs(step)).limit_denominator(_SIMPLE)
    if abs(ratio - start / abs(step)) > _ROUNDING * _SIMPLE * (abs(ratio) + 1):
        return None
    weight = (ratio.numerator, ratio.denominator if step > 0 else -ratio.denominator)
    return Series(_simple(abs(step) / ratio.denominator), weight, pieces, indices, first, last)


def _simple(c: Fraction) -> Fraction:
    """The simple fraction that c is, but for rounding."""
    near = c.limit_denominator(_SIMPLE)
    return near if abs(near - c) <= _ROUNDING * abs(c) else c


def linear(start: int, step: int, variable: str, times: str = "*") -> str:
    """start + step*variable: `k + 1`, `13 - k`."""
    part = variable if abs(step) == 1 else f"{abs(step)}{times}{variable}"
    if step == 0:
        return str(start)
    if start == 0:
        return part if step > 0 else f"-{part}"
    if step < 0:
        return f"{start} - {part}" if start > 0 else f"-{part} - {-start}"
    return f"{part} + {start}" if start > 0 else f"{part} - {-start}"
