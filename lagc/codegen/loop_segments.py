"""Segments of a rolled function (`lagc.lowering.loop_rolling`): loops, and straight code between them.

A segment computes from arrays into arrays. Values that another segment or repetition needs are stored in an
array of the function, the values of one operation in consecutive places; a value that only the next
repetition needs is carried by a variable. A store belongs to the segment that computes its value, unless
entries of its array are also read, or only some repetitions store.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Mapping, Sequence
from itertools import pairwise
from typing import TypeAlias

from lagc.base.records import dataclass, replace
from lagc.lowering.program import LEAVES, Function, Operation, Run, Store
from lagc.lowering.scalar.value_numbering import reordered

KEPT = "kept"  # the array of values that other segments need
NUMBERS = ""  # an array whose entries equal their indices
READ, WRITTEN, CARRIED = "r", "w", "d"  # arrays of a body: entries of `reads`, `writes`, `carries`
_LARGEST = 400  # operations of a segment that is no loop
_TURNS = {"sin": "cos", "cos": "sin"}

_Place: TypeAlias = "tuple[int, int]"  # segment, operation in its body


@dataclass(frozen=True, slots=True)
class Access:
    """The entries of an array that the repetitions use, one each."""

    array: str
    indices: Sequence[float]

    @property
    def stride(self) -> int | None:
        """Return the constant distance between these entries, or None."""
        if self.array == NUMBERS:
            return None
        # An empty set is that of a single repetition: stride 0.
        strides = {int(b - a) for a, b in pairwise(self.indices)} or {0}
        return strides.pop() if len(strides) == 1 else None


@dataclass(frozen=True, slots=True)
class Segment:
    """The repetitions of `body`, which loads from READ and CARRIED and stores to WRITTEN and CARRIED."""

    body: Function
    run: Run
    reads: Sequence[Access]
    writes: Sequence[Access]
    carries: Sequence[Access]  # what each is at first: one entry


def in_parts(function: Function) -> Function:
    """Return a straight function as one run that can be split into segments; sine and cosine of one angle
    stay together."""
    operations = function.operations
    order = [k for k, o in enumerate(operations) if o.op in LEAVES]
    first, partners = len(order), dict[tuple[str, int], int]()
    # C libraries and numpy compute the sine and cosine of an angle together if both stand side by side.
    for k, o in enumerate(operations):
        if o.op in _TURNS:
            partners[o.op, o.operands[0]] = k
    placed = set(order)
    for k, o in enumerate(operations):
        other = partners.get((_TURNS[o.op], o.operands[0])) if o.op in _TURNS else None
        for one in (k, other):
            if one is not None and one not in placed:
                placed.add(one)
                order.append(one)
    found = reordered(function, order)
    return replace(found, runs=(Run(first, len(operations) + len(function.stores) - first, 1),))


def segments(function: Function) -> tuple[list[Segment], int]:
    """Return the segments, and the number of values that are kept."""
    return _Segments(function).result()


class _Segments:
    def __init__(self, function: Function) -> None:
        self.function = function
        self.operations = function.operations
        self.first = function.runs[0].first
        self.runs = list(_divided(function))
        self.owner = [-1] * self.first  # of each operation and store
        for number, run in enumerate(self.runs):
            self.owner += [number] * (run.period * run.count)
        operands = [o.operands for o in self.operations] + [(store.value,) for store in function.stores]
        self.operands = operands
        # By place among the operands, as slices give columns; what has none there is not asked.
        self.slots = [[o[slot] if slot < len(o) else -1 for o in operands] for slot in range(3)]
        self.written: dict[
            _Place, list[tuple[int, Access]]
        ] = {}  # store and entries of what is stored at once
        self.done: set[_Place] = set()  # stores of bodies that others do
        self._at_once()
        self.columns = [_Columns(self, number) for number in range(len(self.runs))]
        self.places = _Places(self)

    def result(self) -> tuple[list[Segment], int]:
        made = [columns.segment() for columns in self.columns]
        return [segment for segment in made if segment.writes or segment.carries], self.places.size

    def row(self, value: int) -> _Place:
        number = self.owner[value]
        run = self.runs[number]
        return number, (value - run.first) % run.period

    def at(self, value: int) -> int:
        run = self.runs[self.owner[value]]
        return (value - run.first) // run.period

    def _at_once(self) -> None:
        """Find stores that can be done in the segment of their values: their array is not read, and all
        repetitions store."""
        count, stores = len(self.operations), self.function.stores
        read = {o.payload[0] for o in self.operations if isinstance(o.payload, tuple)}
        columns: dict[_Place, range] = {}
        for number, run in enumerate(self.runs):
            for k in range(run.period if run.first >= count else 0):
                # A store may move forward to its value only if nothing reads the array in between, and if the
                # value is no leaf.
                items = range(run.first + k, run.end, run.period)
                found = [stores[item - count] for item in items]
                if found[0].array not in read and min([store.value for store in found]) >= self.first:
                    columns[number, k] = items
        # Stores of one repetition that drop out can make those of others incomplete: repeat until nothing
        # changes.
        while len(self.done) != len(columns):
            self.done = set(columns)
            rows: dict[tuple[_Place, str], dict[int, int]] = {}  # -> items by repetition
            for items in columns.values():
                for item in items:
                    store = stores[item - count]
                    rows.setdefault((self.row(store.value), store.array), {})[self.at(store.value)] = item
            # Only a row whose repetitions all store can store inside the loop.
            complete = [made for (row, _), made in rows.items() if len(made) == self.runs[row[0]].count]
            whole = {item for made in complete for item in made.values()}
            columns = {place: items for place, items in columns.items() if whole.issuperset(items)}
        for (row, array), made in rows.items() if self.done else ():
            access = Access(array, [stores[made[n] - count].index for n in range(len(made))])
            self.written.setdefault(row, []).append((made[0], access))


def _divided(function: Function) -> Iterator[Run]:
    """Return the runs of the segments. All values are computed before the first store is done."""
    operations, stores = function.operations, len(function.operations)
    for run in function.runs:
        if run.count > 1:
            yield run
            continue
        first = run.first
        while first < run.end:
            # Long straight code is cut: compilers need more than linear time and memory for one long
            # function.
            end = min(first + _LARGEST, run.end, stores if first < stores else run.end)
            # Sine and cosine of one angle are not cut apart.
            if end < min(run.end, stores) and _TURNS.get(operations[end - 1].op) == operations[end].op:
                end += 1  # that may be of one angle
            yield replace(run, first=first, period=end - first)
            first = end


class _Columns:
    """The inputs of the repetitions of one run: for each operand of its body its values."""

    def __init__(self, all_: _Segments, number: int) -> None:
        self.all, self.number, self.run = all_, number, all_.runs[number]
        run = self.run
        self.outer: dict[tuple[int, int], list[int]] = {}  # operation of the body, slot -> values
        self.carried: dict[tuple[int, int], int] = {}  # the same -> operation of the body it is made by
        for k in range(run.period):
            if (number, k) in all_.done:
                continue
            for slot, operand in enumerate(all_.operands[run.first + k]):
                # An operand from inside the same repetition is a local value.
                if operand >= run.first:
                    continue
                column = all_.slots[slot][run.first + k : run.end : run.period]
                source = self._carrying(column)
                if source is None:
                    self.outer[k, slot] = column
                else:
                    self.carried[k, slot] = source
                    self.outer[k, slot] = [operand]

    def _carrying(self, column: Sequence[int]) -> int | None:
        """Return the operation of the body whose value of the repetition before is this operand, or None."""
        run = self.run
        # Carried: the operand of the second repetition is made in the first, and so on at the distance of one
        # period. The first repetition reads what was computed before the loop.
        if run.count == 1 or not run.first <= column[1] < run.first + run.period:
            return None
        before = range(column[1], column[1] + run.period * (run.count - 1), run.period)
        return column[1] - run.first if column[1:] == [*before] else None

    def values(self) -> Iterator[list[int]]:
        """Return the columns of values that must be kept."""
        return (column for column in self.outer.values() if column[0] >= self.all.first)

    def segment(self) -> Segment:
        return _Body(self).segment()


class _Places:
    """The places of kept values: a row of consecutive places for each operation of a body whose values are
    needed elsewhere. Rows that are read one after the other are adjacent."""

    def __init__(self, all_: _Segments) -> None:
        self.all = all_
        self.start: dict[_Place, int] = {}
        self.last: dict[_Place, int] = {}  # segment that reads it
        following: dict[_Place, _Place] = {}
        before: dict[_Place, _Place] = {}
        for columns in all_.columns:
            for column in columns.values():
                # One row in strides is a single access; otherwise each value brings its own row.
                rows = (
                    [self.all.row(column[0])]
                    if self.stride_in_row(column) is not None
                    else [self.all.row(value) for value in column]
                )
                for row in dict.fromkeys(rows):
                    self.last[row] = columns.number
                for k, (one, other) in enumerate(pairwise(rows)):
                    if one != other:
                        self._link(column[k], column[k + 1], following, before)
        # Rows that one column reads one after the other get adjacent places, so that the column has one
        # stride.
        self.size = 0
        self._allocate(following, before)

    def stride_in_row(self, column: Sequence[int]) -> int | None:
        """Return the stride of values that are all in one row, or None."""
        number = self.all.owner[column[0]]
        run, count = self.all.runs[number], len(column)
        step = column[1] - column[0] if count > 1 else 0
        inside = run.first <= column[-1] < run.end and step % run.period == 0
        if inside and column == [column[0] + step * k for k in range(count)]:
            return step // run.period
        return None

    def _link(self, a: int, b: int, following: dict[_Place, _Place], before: dict[_Place, _Place]) -> None:
        """Make rows adjacent if a column continues from the end of one to the beginning of the other."""
        for one, other in ((a, b), (b, a)):
            left, right = self.all.row(one), self.all.row(other)
            at_end = self.all.at(one) == self.all.runs[left[0]].count - 1 and self.all.at(other) == 0
            if (
                at_end
                and left not in following
                and right not in before
                # Never closing a ring: each row has one neighbour on each side at most.
                and not _leads(right, left, following)
            ):
                following[left], before[right] = right, left
                return

    def _allocate(self, following: Mapping[_Place, _Place], before: Mapping[_Place, _Place]) -> None:
        """Allocate places one after the other; places are reused after the last segment that reads them."""
        free: list[tuple[int, int]] = []  # first, count
        ends: dict[int, list[tuple[int, int]]] = {}
        heads = sorted(row for row in self.last if row not in before)
        by_segment: dict[int, list[list[_Place]]] = {}
        # A chain is allocated as a whole before its first segment runs, and freed after the last segment that
        # reads any of it (linear scan; M. Poletto, V. Sarkar, 1999).
        for head in heads:
            chain = [head]
            while chain[-1] in following:
                chain.append(following[chain[-1]])
            by_segment.setdefault(min(chain)[0], []).append(chain)
        for number in range(len(self.all.runs)):
            for chain in by_segment.get(number, ()):
                count = sum([self.all.runs[row[0]].count for row in chain])
                at = self._take(free, count)
                ends.setdefault(max([self.last[row] for row in chain]), []).append((at, count))
                for row in chain:
                    self.start[row] = at
                    at += self.all.runs[row[0]].count
            free = _joined([*free, *ends.get(number, ())])

    def _take(self, free: list[tuple[int, int]], count: int) -> int:
        # First fit: the free ranges are sorted and few.
        for k, (first, length) in enumerate(free):
            if length >= count:
                free[k : k + 1] = [(first + count, length - count)] if length > count else []
                return first
        self.size += count
        return self.size - count

    def of(self, column: Sequence[int]) -> Sequence[int]:
        """Return the places of the values of a column."""
        stride, first = self.stride_in_row(column), self._place(column[0])
        if stride:
            return range(first, first + stride * len(column), stride)
        return [first] * len(column) if stride == 0 else [self._place(value) for value in column]

    def _place(self, value: int) -> int:
        return self.start[self.all.row(value)] + self.all.at(value)


def _leads(row: _Place, end: _Place, following: Mapping[_Place, _Place]) -> bool:
    while row != end and row in following:
        row = following[row]
    return row == end


def _joined(free: Sequence[tuple[int, int]]) -> list[tuple[int, int]]:
    found: list[tuple[int, int]] = []
    for first, count in sorted(free):
        if found and sum(found[-1]) == first:
            found[-1] = found[-1][0], found[-1][1] + count
        else:
            found.append((first, count))
    return found


class _Body:
    """Builder of the body of one segment."""

    def __init__(self, columns: _Columns) -> None:
        self.columns, self.all, self.run = columns, columns.all, columns.run
        self.operations: list[Operation] = []
        self.stores: list[Store] = []
        self.comments: dict[int, str] = {}  # by store
        self.number: dict[int, int] = {}  # operation of the body -> position
        self.reads: dict[tuple[str, Hashable], int] = {}  # -> position
        self.accesses: list[Access] = []
        self.writes: list[Access] = []
        self.carries: dict[tuple[int, int], int] = {}  # what is carried, and at first -> position of its load
        self.initial: list[Access] = []

    def segment(self) -> Segment:
        run, count = self.run, len(self.all.operations)
        for k in range(run.period):
            if (self.columns.number, k) in self.all.done:
                continue
            item = run.first + k
            operands = tuple([self._operand(k, slot, a) for slot, a in enumerate(self.all.operands[item])])
            if item < count:
                self.number[k] = len(self.operations)
                self.operations.append(replace(self.all.operations[item], operands=operands))
                row = (self.columns.number, k)
                if row in self.all.places.start:
                    first = self.all.places.start[row]
                    self._write(Access(KEPT, range(first, first + run.count)), self.number[k])
                for item, access in self.all.written.get(row, ()):
                    self._write(access, self.number[k], item)
            else:
                stores = self.all.function.stores[item - count : run.end - count : run.period]
                self._write(Access(stores[0].array, [s.index for s in stores]), operands[0], item)
        # At the end of each repetition: the values that the next one reads.
        for number, (source, _) in enumerate(self.carries):
            self.stores.append(Store(CARRIED, number, self.number[source]))
        comments = {len(self.operations) + k: text for k, text in self.comments.items()}
        body = Function("", (), (), tuple(self.operations), tuple(self.stores), "", comments)
        return Segment(body, run, self.accesses, self.writes, self.initial)

    def _write(self, access: Access, value: int, item: int = -1) -> None:
        comments = self.all.function.comments
        if item in comments and self.run.count == 1:
            self.comments[len(self.stores)] = comments[item]
        self.stores.append(Store(WRITTEN, len(self.writes), value))
        self.writes.append(access)

    def _operand(self, k: int, slot: int, operand: int) -> int:
        """Return the position of an operand in the body."""
        if operand >= self.run.first:
            return self.number[operand - self.run.first]
        source = self.columns.carried.get((k, slot))
        if source is None:
            return self._read(self.columns.outer[k, slot])
        if (source, operand) not in self.carries:
            self.carries[source, operand] = self._load(CARRIED, len(self.initial))
            self.initial.append(self._access([operand]))
        return self.carries[source, operand]

    def _read(self, column: list[int]) -> int:
        access = self._access(column)
        indices = access.indices
        key = access.array, indices if isinstance(indices, range) else tuple(indices)
        if key not in self.reads:
            # A number that is equal in all repetitions is a constant of the body; others are read from a
            # table.
            if access.array == NUMBERS and len(set(access.indices)) == 1:
                self.reads[key] = len(self.operations)
                self.operations.append(Operation("const", (), access.indices[0]))
            else:
                self.reads[key] = self._load(READ, len(self.accesses))
                self.accesses.append(access)
        return self.reads[key]

    def _access(self, column: Sequence[int]) -> Access:
        """Return the entries where the values of a column are."""
        if column[0] >= self.all.first:
            return Access(KEPT, self.all.places.of(column))
        leaves = [self.all.operations[value] for value in column]
        assert leaves[0].op in LEAVES
        if not isinstance(leaves[0].payload, tuple):
            return Access(NUMBERS, [float(o.payload) for o in leaves if isinstance(o.payload, float | int)])
        return Access(leaves[0].payload[0], [o.payload[1] for o in leaves if isinstance(o.payload, tuple)])

    def _load(self, array: str, index: int) -> int:
        self.operations.append(Operation("load", (), (array, index)))
        return len(self.operations) - 1
