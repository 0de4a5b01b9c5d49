"""Long functions as loops: where the same operations come again and again on other operands.

What is made of n like parts takes n times the same operations, as values are made part by part in every
stage before.  In the order in which they were made, operations are then a text with periods: so many of its
letters come again at once, with the same edges among themselves.  Each such run is a `Run` of the function,
which printers write as a loop; what it takes from outside may come from anywhere, and needs a table where it
does not come from side by side.  No operation and no operand changes, and so no bit of a result.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from typing import NamedTuple

from lagc.optimize.block import STRAIGHT, ordered
from lagc.optimize.program import LEAVES, Function, Operation, Run
from lagc.records import replace

_GRAM = 16  # operations: what comes again is found by so many of them
_LONGEST = 3000  # operations of one repetition
_HOPS = 30  # periods that are tried at a place
_LEAST = 3  # repetitions
_WORTH = 32  # operations, in all repetitions, that make a loop
_GAIN = 1.02  # a shorter period goes before a longer one that does not cover so much more
_TOGETHER = 4  # repetitions that may be made one, where operands lie side by side then
_ENTRIES = 4  # of tables that take as much room as an operation
_SHARE = 0.25  # of the operations that may stay, for loops to be worth it
_COMMUTE = ("add", "mul")


def rolled(function: Function) -> Function:
    """`function` with its `runs` where it is long and mostly repetition, else in the order of `ordered`."""
    if len(function.operations) + len(function.stores) <= STRAIGHT:
        return function
    kinds = _kinds(function)
    function = replace(function, operations=tuple([_alike(o, kinds) for o in function.operations]))
    text = _Text(function, kinds)
    runs = tuple(text.runs())
    if _moves_itself(function, kinds) or sum([run.period for run in runs]) > _SHARE * len(text.letters):
        return ordered(function)
    return replace(function, runs=runs)


def _kinds(function: Function) -> list[str]:
    """Where each value comes from: a number, which stands for itself where it comes often, an array, an
    operation."""
    operations = function.operations
    often = Counter([k for o in operations for k in o.operands] + [store.value for store in function.stores])
    return [
        "" if o.op not in LEAVES else
        o.payload[0] if isinstance(o.payload, tuple) else f"{o.op} {k}" if often[k] >= _GRAM else o.op
        for k, o in enumerate(operations)
    ]  # fmt: skip


def _table(o: Operation) -> tuple[str, ...]:
    """What stands for the table of one that is looked up."""
    return () if o.payload is None else (repr(o.payload),)


def _alike(o: Operation, kinds: Sequence[str]) -> Operation:
    """With operands that may change places in the order of their kinds."""
    if o.op in _COMMUTE and kinds[o.operands[0]] > kinds[o.operands[1]]:
        return Operation(o.op, o.operands[::-1])
    return o


def _moves_itself(function: Function, kinds: Sequence[str]) -> bool:
    """Whether an entry that it stores is one that another store may have changed by then."""
    return not {kinds[store.value] for store in function.stores}.isdisjoint(a for a, _ in function.outputs)


class _Repeated(NamedTuple):
    """`times` the `period` letters from `at` on."""

    at: int
    period: int
    times: int

    @property
    def length(self) -> int:
        return self.period * self.times


class _Text:
    """The operations of a function behind its leaves, then its stores, as letters."""

    def __init__(self, function: Function, kinds: Sequence[str]) -> None:
        operations, stores = function.operations, function.stores
        self.first = first = sum([o.op in LEAVES for o in operations])
        sorts = [(o.op, *_table(o), *[kinds[k] for k in o.operands]) for o in operations[first:]]
        sorts += [(store.array, kinds[store.value]) for store in stores]
        letters: dict[tuple[str, ...], str] = {}
        self.letters = "".join([letters.setdefault(sort, chr(33 + len(letters))) for sort in sorts])
        # By place among the operands: where in its array a leaf is, which value another one is, no operand.
        where = [o.payload[1] if isinstance(o.payload, tuple) else k for k, o in enumerate(operations)]
        operands = [o.operands for o in operations[first:]] + [(store.value,) for store in stores]
        far, items = len(operations) + len(stores), list(enumerate(operands, first))
        slots = range(max(map(len, operands)))
        self.outer = [[where[o[slot]] if slot < len(o) else 0 for o in operands] for slot in slots]
        # How far back each is; what is no operation, farther than anything else.
        self.back = [
            [k - o[slot] if slot < len(o) and o[slot] >= first else far for k, o in items] for slot in slots
        ]

        self.same_to: dict[int, int] = {}  # by period: where letters that were the same so far back end

    def runs(self) -> Iterator[Run]:
        """Of all letters: of the periods that begin at a place the one that goes farthest."""
        nexts, at, straight = self._nexts(), 0, 0
        while at < len(self.letters):
            found = self._longest(at, nexts)
            if found is None:
                at += 1
                continue
            found = self._shaped(found)
            if found.at > straight:
                yield Run(self.first + straight, found.at - straight, 1)
            yield Run(self.first + found.at, found.period, found.times)
            at = straight = found.at + found.length
        if at > straight:
            yield Run(self.first + straight, at - straight, 1)

    def _nexts(self) -> list[int]:
        """Where the letters that begin at each place come next."""
        count = len(self.letters)
        found, seen = [count] * count, dict[str, int]()
        for k in range(count - _GRAM, -1, -1):
            gram = self.letters[k : k + _GRAM]
            found[k] = seen.get(gram, count)
            seen[gram] = k
        return found

    def _longest(self, at: int, nexts: Sequence[int]) -> _Repeated | None:
        count, found, other = len(self.letters), list[_Repeated](), nexts[at]
        for _ in range(_HOPS):
            period = other - at
            if other == count or period > _LONGEST or _LEAST * period > count - at:
                break
            times = 1 + self._common(at, other) // period
            if times >= _LEAST and period * times >= _WORTH:
                found.append(_Repeated(at, period, times))
            other = nexts[other]
        best: _Repeated | None = None
        least: float = _WORTH
        for one in sorted(found, key=lambda one: (-one.length, one.period)):
            if one.length < least:
                break
            one = one._replace(times=self._same(one))
            if one.times >= _LEAST and one.length >= least:
                best, least = one, one.length * _GAIN
        return best

    def _common(self, a: int, b: int) -> int:
        """How many letters are the same from a and from b > a on."""
        if self.same_to.get(b - a, 0) > a:
            return self.same_to[b - a] - a
        letters, length, step = self.letters, 0, 64
        while step:
            end = b + length + step
            if end <= len(letters) and letters[a + length : a + length + step] == letters[b + length : end]:
                length, step = length + step, 2 * step
            else:
                step //= 2
        self.same_to[b - a] = a + length
        return length

    def _same(self, one: _Repeated) -> int:
        """How many repetitions have the edges of the first among themselves."""
        pattern = [back[one.at : one.at + one.period] for back in self.back]
        for n in range(1, one.times):
            begin = one.at + n * one.period
            for back, wanted in zip(self.back, pattern):
                found = back[begin : begin + one.period]
                if found != wanted and any(
                    [a != b and min(a, b) <= k for k, (a, b) in enumerate(zip(wanted, found))]
                ):
                    return n
        return one.times

    def _shaped(self, one: _Repeated) -> _Repeated:
        """The same with several repetitions as one, or without the first or the last, where fewer tables are
        needed then."""
        at, period, times = one
        forms = [one] if self._tables(one) else []
        for n in range(2, _TOGETHER + 1 if forms else 0):
            form = _Repeated(at, n * period, times // n)
            if form.times >= _LEAST + 2:
                forms.append(form._replace(times=self._same(form)))
        forms += [_Repeated(form.at + form.period, form.period, form.times - 1) for form in forms]
        forms += [form._replace(times=form.times - 1) for form in forms]

        def room(form: _Repeated) -> float:
            return form.period + form.times * self._tables(form) / _ENTRIES + one.length - form.length

        return min([form for form in forms if form.times >= _LEAST], key=room, default=one)

    def _tables(self, one: _Repeated) -> int:
        """How many operands do not come from side by side."""
        tables: set[tuple[int, ...]] = set()
        for outer, back in zip(self.outer, self.back):
            for k in range(one.period):
                begin, end = one.at + k, one.at + one.length
                if back[begin] <= k:
                    continue
                column = outer[begin : end : one.period]
                if back[begin] < len(self.letters) + self.first:  # what comes before a row may lie before it
                    column = column[1:]
                first, step = column[0], column[1] - column[0]
                if column != [first + step * n for n in range(len(column))]:
                    tables.add(tuple(column))
        return len(tables)
