"""Loop rerolling: repeated sequences of operations become loops.

A model of n equal parts has n copies of the same operations. In the order in which they were made, operations
form a text with periods: sequences that repeat with the same edges among themselves. Each repetition is a
`Run` of the function, which printers write as a loop; operands from outside come from a table unless they are
consecutive. No operation and no operand changes, so results have the same bits.
"""

import math
from collections import Counter
from collections.abc import Iterator, Sequence
from itertools import product
from typing import NamedTuple, TypeAlias

from lagc.base.records import replace
from lagc.lowering.program import LEAVES, Function, Operation, Run
from lagc.lowering.scalar.value_numbering import STRAIGHT, ordered, reordered

_GRAM = 16  # operations: what comes again is found by so many of them
_LONGEST = 3000  # operations of one repetition
_HOPS = 30  # periods that are tried at a place
_LEAST = 3  # repetitions
_WORTH = 32  # operations, in all repetitions, that make a loop
_GAIN = 1.02  # a shorter period goes before a longer one that does not cover so much more
_TOGETHER = 4  # repetitions that may be made one, where operands lie side by side then
_ENDS = 2  # repetitions at either end that may be left out for that
_MUCH = 0.2  # of a function's length: a cost of loops that may be worth another order
_TEXT = 0.35  # of an iteration or an index: what an operation of text costs more than one done again
_LONG = 4000  # operations; beyond, one is paid for by the room that it takes, too
_ENTRIES = 4  # of tables that take as much room as an operation
_FEW = 8  # operations between leaves and what is made where it is asked for
_COMMUTE = ("add", "mul")

Letter: TypeAlias = "tuple[str, ...]"


def rerolled(function: Function, often: bool = False) -> Function:
    """Return `function` with its `runs` if it is long and loops cost less, else in the order of `ordered`. A
    function that is called `often` is optimized for time, others for size."""
    straight = len(function.operations) + len(function.stores)
    # Short functions stay straight: a loop would not make them faster or shorter.
    if straight <= STRAIGHT:
        return function
    # In the order in which they were made, equal parts repeat. A function that is called often may pay for
    # another order, in which values are used where they are made.
    if not moves_itself(function):
        cost, found = _with_loops(function, often)
        if often and cost > _MUCH * straight:
            cost, found = min((cost, found), _with_loops(local(function), often), key=lambda form: form[0])
        if cost < _cost(often, straight):
            return found
    return ordered(function)


def _with_loops(function: Function, often: bool) -> tuple[float, Function]:
    """Return the cost of the function with loops, and the function: its operations stay in their order, and
    runs of equal ones are loops."""
    function, letters = as_letters(function)
    text = _Text(function, letters)
    runs = tuple(text.runs())
    cost = _cost(often, sum([run.period for run in runs]), sum([text.indexing(run) for run in runs]))
    return cost, replace(function, runs=runs)


def as_letters(function: Function) -> tuple[Function, list[Letter]]:
    """Return the operations with commutative operands in one order, and a letter for each: operation or store
    without the places of operands."""
    # A letter is an operation with the kinds of its operands: equal letters are equal code up to places.
    kinds = _kinds(function)
    operations = tuple([_in_one_order(o, kinds) for o in function.operations])
    letters: list[Letter] = [(o.op, *_table(o), *[kinds[k] for k in o.operands]) for o in operations]
    letters += [(store.array, kinds[store.value]) for store in function.stores]
    return replace(function, operations=operations), letters


def _cost(often: bool, text: int, indexing: int = 0) -> float:
    """Return the cost of so many operations of text, and indices from tables."""
    if often:
        return _TEXT * text + max(text - _LONG, 0) + indexing
    return text + indexing / _ENTRIES


def local(function: Function) -> Function:
    """Return the function with its operations store by store, each followed by those that it makes possible,
    so that operations on one value and on one part are adjacent. A value of few operations on leaves is
    computed where it is needed."""
    # Two kinds of values: those of few operations on leaves (`cone`), which are computed where they are
    # needed, and the others, which are made once, as early as they can be.
    operations = function.operations
    cone = [0] * len(operations)  # operations that lead to each, as far as they are few
    users: list[list[int]] = [[] for _ in operations]
    for k, o in enumerate(operations):
        if o.op not in LEAVES:
            cone[k] = min(1 + sum([cone[a] for a in o.operands]), _FEW + 1)
            for operand in set(o.operands):
                users[operand].append(k)
    done = [o.op in LEAVES for o in operations]
    order = [k for k, leaf in enumerate(done) if leaf]

    def waits(k: int) -> bool:
        return any([not done[a] and cone[a] > _FEW for a in operations[k].operands])

    # Depth first from each store; when a value is done, operations that it makes possible and that wait for
    # nothing else come at once: they work on the same part of the model.
    for store in function.stores:
        stack = [store.value]
        while stack:
            k = stack[-1]
            missing = [] if done[k] else [a for a in operations[k].operands if not done[a]]
            if missing:
                stack += reversed(missing)
                continue
            stack.pop()
            if not done[k]:
                done[k] = True
                order.append(k)
                stack += [u for u in reversed(users[k]) if not done[u] and cone[u] > _FEW and not waits(u)]
    return reordered(function, order)


def _kinds(function: Function) -> list[str]:
    """Return the source of each value: an array, an operation, or a number, which is its own kind if it is
    frequent."""
    operations = function.operations
    often = Counter([k for o in operations for k in o.operands] + [store.value for store in function.stores])
    return [
        "" if o.op not in LEAVES else
        o.payload[0] if isinstance(o.payload, tuple) else f"{o.op} {k}" if often[k] >= _GRAM else o.op
        for k, o in enumerate(operations)
    ]  # fmt: skip


def _table(o: Operation) -> tuple[str, ...]:
    """Return the letter of the table of an operation that is looked up."""
    return () if o.payload is None else (repr(o.payload),)


def _in_one_order(o: Operation, kinds: Sequence[str]) -> Operation:
    """Return an operation with operands that may change places in the order of their kinds."""
    if o.op in _COMMUTE and kinds[o.operands[0]] > kinds[o.operands[1]]:
        return Operation(o.op, o.operands[::-1])
    return o


def moves_itself(function: Function) -> bool:
    """Return whether a function stores a value that it loads from a place which another store overwrites."""
    written = {(store.array, store.index) for store in function.stores}
    return any([function.operations[store.value].payload in written for store in function.stores])


class _Repeated(NamedTuple):
    """A repetition: `period` letters from `at` on, `times` times."""

    at: int
    period: int
    times: int

    @property
    def length(self) -> int:
        return self.period * self.times


class _Text:
    """The text of a function: its operations without leaves, then its stores, as letters."""

    def __init__(self, function: Function, letters: Sequence[Letter]) -> None:
        operations, stores = function.operations, function.stores
        self.first = first = sum([o.op in LEAVES for o in operations])
        self.stores = len(operations)
        signs: dict[Letter, str] = {}
        # The text: one sign for each different letter, so that substrings are compared by the string search
        # of Python.
        self.letters = "".join([signs.setdefault(letter, chr(33 + len(signs))) for letter in letters[first:]])
        # Operands: from outside by their place in an array, from inside by how far back they are.
        # By place among the operands: where in its array a leaf is, which value another one is, no operand.
        where = [o.payload[1] if isinstance(o.payload, tuple) else k for k, o in enumerate(operations)]
        operands = [o.operands for o in operations[first:]] + [(store.value,) for store in stores]
        self.far = far = len(operations) + len(stores)
        items = list(enumerate(operands, first))
        slots = range(max(map(len, operands)))
        self.outer = [[where[o[slot]] if slot < len(o) else 0 for o in operands] for slot in slots]
        # How far back each is; what is no operation, farther than anything else.
        self.back = [
            [k - o[slot] if slot < len(o) and o[slot] >= first else far for k, o in items] for slot in slots
        ]

        self.same_to: dict[int, int] = {}  # by period: where letters that were the same so far back end

    def runs(self) -> Iterator[Run]:
        """Yield the runs of the whole text: at each place the repetition that goes farthest, else straight
        code."""
        # Left to right: the longest repetition at a place becomes a run, and the search goes on behind it.
        nexts, at, straight = self._nexts(), 0, 0
        while at < len(self.letters):
            found = self._longest(at, nexts)
            if found is None:
                at += 1
                continue
            found = self._with_fewer_tables(found)
            if found.at > straight:
                yield Run(self.first + straight, found.at - straight, 1)
            yield Run(self.first + found.at, found.period, found.times)
            at = straight = found.at + found.length
        if at > straight:
            yield Run(self.first + straight, at - straight, 1)

    def _nexts(self) -> list[int]:
        """Return, for each place, the next place at which the same letters begin."""
        # `seen` is filled from the end, so it holds the next place with the same letters.
        count = len(self.letters)
        found, seen = [count] * count, dict[str, int]()
        for k in range(count - _GRAM, -1, -1):
            gram = self.letters[k : k + _GRAM]
            found[k] = seen.get(gram, count)
            seen[gram] = k
        return found

    def _longest(self, at: int, nexts: Sequence[int]) -> _Repeated | None:
        # Each return of the same 16 letters is a candidate for the period. Periods that cannot repeat three
        # times in the text that remains end the search.
        count, found, other = len(self.letters), list[_Repeated](), nexts[at]
        for _ in range(_HOPS):
            period = other - at
            if other == count or period > _LONGEST or _LEAST * period > count - at:
                break
            times = 1 + self._common_length(at, other) // period
            if times >= _LEAST and period * times >= _WORTH:
                found.append(_Repeated(at, period, times))
            other = nexts[other]
        # From the longest on: a repetition must also have the same edges. A shorter period wins over a longer
        # one that covers hardly more.
        best: _Repeated | None = None
        least: float = _WORTH
        for one in sorted(found, key=lambda one: (-one.length, one.period)):
            if one.length < least:
                break
            one = one._replace(times=self._equal_repetitions(one))
            if one.times >= _LEAST and one.length >= least:
                best, least = one, one.length * _GAIN
        return best

    def _common_length(self, a: int, b: int) -> int:
        """Return how many letters are the same from a and from b > a on."""
        # Letters that were found equal at this distance before are not compared again; else the length is
        # found by doubling, then halving.
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

    def _equal_repetitions(self, one: _Repeated) -> int:
        """Return how many repetitions have the same edges among their operations as the first one."""
        # Operands inside a repetition are equally far back in each. One that points before the repetition is
        # no edge inside it: its place comes from outside.
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

    def _with_fewer_tables(self, one: _Repeated) -> _Repeated:
        """Return the repetition with several repetitions taken as one, or without some at its ends, if that
        needs fewer tables."""
        # Operands from outside need a table unless their places grow evenly. Two or more repetitions as one,
        # or one less at an end, may make more of them even.
        best, least = one, math.inf
        for together in range(1, _TOGETHER + 1):
            period, times = together * one.period, one.times // together
            if together > 1:
                if times < _LEAST + 2 or least <= period:
                    break
                times = self._equal_repetitions(_Repeated(one.at, period, times))
            if times < _LEAST:
                continue
            # Room: the text of the loop, its tables at a quarter of an operation each, and what stays
            # outside.
            columns = self._table_columns(_Repeated(one.at, period, times))
            for first, last in product(range(_ENDS + 1), repeat=2):
                form = _Repeated(one.at + first * period, period, times - first - last)
                if form.times < _LEAST:
                    continue
                tables = sum([not _is_even(column[first : times - last]) for column in columns])
                room = period + form.times * tables / _ENTRIES + one.length - form.length
                if room < least:
                    best, least = form, room
        return best

    def indexing(self, run: Run) -> int:
        """Return the cost of the indices of a run: its entries of tables, and one for each iteration unless
        the run only stores values that stand side by side."""
        if run.count == 1:
            return 0
        # Without a table and without a value from before, an iteration costs nothing more than its
        # operations.
        tables = len(self._table_columns(_Repeated(run.first - self.first, run.period, run.count)))
        first = run.first - self.first
        alone = run.first < self.stores or self.far in self.back[0][first : first + run.period]
        return run.count * (tables + alone)

    def _table_columns(self, one: _Repeated) -> list[list[int]]:
        """Return the columns of operands, one entry for each repetition, that do not grow evenly."""
        # Columns of equal operands in all repetitions. Equal columns share one table.
        found: dict[tuple[int, ...], list[int]] = {}
        for outer, back in zip(self.outer, self.back):
            for k in range(one.period):
                begin, end = one.at + k, one.at + one.length
                if back[begin] <= k:
                    continue
                column = outer[begin : end : one.period]
                # The first value before a run of row to row (as in a recurrence) may lie elsewhere: it is
                # taken for even.
                if back[begin] < self.far:  # what comes before a row may lie before it
                    column[0] = 2 * column[1] - column[2]
                if not _is_even(column):
                    found[tuple(column)] = column
        return list(found.values())


def _is_even(column: Sequence[int]) -> bool:
    """Return whether the numbers of a column grow evenly."""
    first, step = column[0], column[1] - column[0]
    return column == [first + step * n for n in range(len(column))]
