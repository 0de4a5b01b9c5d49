"""Rules: formulas, and terms of sums, whose numbers follow each other become one with a counter.

A rule is found if all numbers change evenly from one to the next, decimals up to round-off. Written out, it
gives the same formulas. A formula that does not fit stays separate.
"""

from collections import Counter
from collections.abc import Hashable, Sequence
from fractions import Fraction
from typing import Any, TypeAlias

from lagc.base.records import dataclass, replace
from lagc.reports.patterns.formula_trees import (
    INDEX,
    Call,
    Form,
    Line,
    Linear,
    Number,
    Numbers,
    Part,
    Series,
    Term,
    Total,
    counted,
    pattern,
    renumbered,
    terms_of,
    written_out,
)

FEW = 6  # terms of a sum that stays as it is
LEAST = 4  # members of a rule
_STRIDES = 3  # lines that take turns
_SIMPLE = 1000  # denominators of rules
_ROUNDING = Fraction(1, 10**13)  # of coefficients
SUMS, LINES = ("k", "j", "m", "n", "p", "index"), ("i", "j", "m", "n", "p", "number")

Values: TypeAlias = Sequence[Any]


@dataclass(frozen=True, slots=True)
class Rule:
    """Numbers for a counter that goes from `first` to `last`; `backwards` along the members."""

    counter: str
    first: int
    last: int
    numbers: list[Number]
    backwards: bool


def progressions(values: Sequence[Values], strides: int = 1) -> list[list[int]]:
    """Return members whose numbers change evenly from one to the next, also every second or third of them."""
    n = len(values)
    best: list[list[int]] = []
    least = n
    for stride in range(1, strides + 1):
        found = [run for start in range(stride) for run in _runs(range(start, n, stride), values)]
        pieces = n - sum(map(len, found)) + len(found)
        if pieces < least:
            best, least = found, pieces
        if least == 1:
            break
    return best


def _runs(members: Sequence[int], values: Sequence[Values]) -> list[list[int]]:
    """Return the runs of members whose numbers change evenly, each as long as possible, of LEAST members."""
    runs: list[list[int]] = []
    run: list[int] = []
    for member in members:
        if len(run) > 1 and not _goes_on(run, values, values[member]):
            runs.append(run)
            run = [] if len(run) >= LEAST else run[-1:]
        run.append(member)
    return [run for run in (*runs, run) if len(run) >= LEAST]


def _goes_on(run: Sequence[int], values: Sequence[Values], found: Values) -> bool:
    """Return whether numbers continue a run, up to round-off relative to the largest of it, which is at an
    end."""
    n = len(run)
    for start, second, last, x in zip(values[run[0]], values[run[1]], values[run[-1]], found):
        off = abs(start + n * (second - start) - x)
        if off and off > n * _ROUNDING * max(abs(start), abs(last), abs(x)):
            return False
    return True


def rule(values: Sequence[Values], counter: str) -> Rule | None:
    """Return the rule of numbers, whose counter is the first index that changes by one, or else counts from
    1; None where a number has no short rule."""
    changes = [b - a for a, b in zip(*values[:2])]
    if not any(changes):
        return None
    own = next((k for k, x in enumerate(changes) if abs(x) == 1 and isinstance(values[0][k], int)), None)
    backwards = bool(changes[own or 0] < 0)
    if backwards:
        values = values[::-1]
    first = 1 if own is None else int(values[0][own])
    count = len(values) - 1
    numbers: list[Number] = []
    for a, b in zip(values[0], values[-1]):
        number = _number(a, b, first, count, counter)
        if number is None:
            return None
        numbers.append(number)
    return Rule(counter, first, first + count, numbers, backwards)


def _number(a: Any, b: Any, first: int, count: int, counter: str) -> Number | None:
    """Return the rule that goes from a to b as the counter goes from `first` on."""
    if abs(b - a) <= _ROUNDING * abs(a):
        constant: Number = a
        return constant
    if isinstance(a, int) and isinstance(b, int):
        return Linear(a - (b - a) // count * first, ((counter, (b - a) // count),))
    # a + step (k - first) = unit (n k + m) with integers n, m, if start and step have a simple ratio.
    step = (Fraction(b) - a) / count
    start = a - step * first
    ratio = Fraction(start / abs(step)).limit_denominator(_SIMPLE)
    if abs(ratio - start / abs(step)) > _ROUNDING * _SIMPLE * (abs(ratio) + 1):
        return None
    unit = _simple(abs(step) / ratio.denominator)
    slope = unit * ratio.denominator
    return Linear(unit * ratio.numerator, ((counter, slope if step > 0 else -slope),))


def _simple(c: Fraction) -> Fraction:
    """The simple fraction that c is, but for rounding."""
    near = c.limit_denominator(_SIMPLE)
    return near if abs(near - c) <= _ROUNDING * abs(c) else c


# -- sums ---------------------------------------------------------------------


def summed(found: Total, taken: set[str]) -> Total:
    """Return a sum with series for terms that follow a rule, also within its parts. No counter is called as
    one of the words in `taken`."""
    parts = [_inside(part, taken) for part in found.terms]
    while len(parts) > FEW:
        shorter = _series(parts, taken)
        if len(shorter) == len(parts):
            break
        parts = shorter
    return Total(tuple(parts))


def _inside(part: Part, taken: set[str]) -> Part:
    if isinstance(part, Series):
        return part
    return Term(part.negative, part.size, tuple([(_short(x, taken), e) for x, e in part.factors]))


def _short(form: Form, taken: set[str]) -> Form:
    if isinstance(form, Total):
        return summed(form, taken)
    if isinstance(form, Call):
        return Call(form.op, tuple([summed(x, taken) for x in form.args]))
    return form


def _series(parts: Sequence[Part], taken: set[str]) -> list[Part]:
    found: dict[int, Part] = dict(enumerate(parts))
    for members, values in _alike(parts):
        # A rule is made of terms that no earlier rule took.
        for run in progressions(values):
            body = parts[members[run[0]]]
            counter = _free(SUMS, taken | counted(body) | _bound(body))
            made = rule([values[k] for k in run], counter)
            if made is not None and all(members[k] in found for k in run):
                for k in run:
                    del found[members[k]]
                inner: Part = renumbered(body, made.numbers)
                first, last = _reach(inner, made, found)
                found[members[run[0]]] = Series(counter, first, last, inner)
    return [found[k] for k in sorted(found)]


def _reach(body: Part, made: Rule, found: dict[int, Part]) -> tuple[int, int]:
    """Return the bounds of a sum of sums, extended by terms that are there, which are removed from
    `found`."""
    if isinstance(body, Term):
        return made.first, made.last
    places = {_key(part): k for k, part in found.items() if isinstance(part, Term)}
    ends = []
    for end, step in ((made.first, -1), (made.last, 1)):
        while True:
            here = [_key(term) for term in terms_of(body, {made.counter: end + step})]
            if not here or any(places.get(key) not in found for key in here):
                break
            for key in here:
                del found[places[key]]
            end += step
        ends.append(end)
    return ends[0], ends[1]


def _bound(part: Part) -> set[str]:
    return {part.counter} | _bound(part.body) if isinstance(part, Series) else set()


def _alike(forms: Sequence[Part] | Sequence[Line]) -> list[tuple[list[int], list[Numbers]]]:
    """Places and numbers of those that differ in numbers alone."""
    groups: dict[Hashable, tuple[list[int], list[Numbers]]] = {}
    for place, form in enumerate(forms):
        numbers: Numbers = []
        places, values = groups.setdefault(pattern(form, numbers), ([], []))
        places.append(place)
        values.append(numbers)
    return [group for group in groups.values() if len(group[0]) >= LEAST]


def _free(letters: Sequence[str], taken: set[str]) -> str:
    return next((x for x in letters if x not in taken), letters[-1])


# -- lines --------------------------------------------------------------------


def ruled(lines: Sequence[Line], taken: set[str]) -> list[Line]:
    """Lines that follow a rule written once, and those rules by rules again, as long as that is shorter."""
    found = list(lines)
    while True:
        shorter = _once(found, taken)
        if len(shorter) == len(found):
            return found
        found = shorter


def _once(lines: Sequence[Line], taken: set[str]) -> list[Line]:
    runs = [
        ([members[k] for k in run], [values[k] for k in run])
        for members, values in _alike(lines)
        for run in progressions(values, _STRIDES)
    ]
    found: dict[int, Line] = dict(enumerate(lines))
    # Lines of no run may be members of a rule that looks different, as where a sum has one term at an end.
    alone = dict(found)
    for members, _ in runs:
        for place in members:
            del alone[place]
    for members, values in runs:
        body = lines[members[0]]
        counter = _free(LINES, taken | counted(body) | {name for name, _, _ in body.counters})
        made = rule(values, counter)
        if made is None:
            continue
        inner: Line = renumbered(body, made.numbers)
        # The places of the members by their counter; gaps in it end a line.
        at = dict(zip(range(made.first, made.last + 1), members[::-1] if made.backwards else members))
        if not body.counters:
            at |= _members_alone(inner, counter, alone, at)
        for first, last in _spans(sorted(at)):
            places = [at[k] for k in range(first, last + 1)]
            for place in places:
                del found[place]
                alone.pop(place, None)
            found[min(places)] = replace(inner, counters=((counter, first, last), *inner.counters))
    return [found[k] for k in sorted(found)]


def _members_alone(body: Line, counter: str, alone: dict[int, Line], known: dict[int, int]) -> dict[int, int]:
    """Return the places, by their counter, of single lines that a rule gives as well once its sums are
    written out, next to members that are known."""
    places: dict[int, int] = {}
    for place, line in alone.items():
        at = None if line.counters else _counts(body, line)
        if at is not None and at not in known:
            here: Line = written_out(body, {counter: at})
            if (here.indices, here.clause) == (line.indices, line.clause) and _are_equal(here, line):
                places[at] = place
    return {k: place for k, place in places.items() if k - 1 in known | places or k + 1 in known | places}


def _counts(body: Line, line: Line) -> int | None:
    """Return the counter of a rule where that is about the same as a line; None where it never is."""
    if _of(body) != _of(line):
        return None
    for number, index in zip(body.indices, line.indices):
        if isinstance(number, Linear) and isinstance(index, int):
            ((_, slope),) = number.slopes
            at = Fraction(index - number.constant) / slope
            return int(at) if at.denominator == 1 else None
    return None


def _spans(numbers: Sequence[int]) -> list[tuple[int, int]]:
    """Return the first and the last number of each range in a sorted list."""
    spans: list[tuple[int, int]] = []
    for k in numbers:
        if spans and spans[-1][1] == k - 1:
            spans[-1] = (spans[-1][0], k)
        else:
            spans.append((k, k))
    return spans


def _of(line: Line) -> Hashable:
    """Return the kind and label of a line, but for indices."""
    return (line.kind, INDEX.sub("", line.label))


def _are_equal(a: Line, b: Line) -> bool:
    b = written_out(b, {})
    return all(
        (x is None) == (y is None) and (x is None or y is None or _terms(x) == _terms(y))
        for x, y in ((a.left, b.left), (a.right, b.right), (a.condition, b.condition))
    )


def _terms(found: Total) -> Counter[Hashable]:
    """The terms, whatever their order."""
    return Counter([_key(term) for term in found.terms])


def _key(part: Part) -> Hashable:
    numbers: Numbers = []
    return pattern(part, numbers), tuple(numbers)
