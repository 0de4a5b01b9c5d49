"""Sums and products in the order in which their parts are ready.

A processor executes independent operations at the same time, so the longest chain of operations counts as
much as their number. In a long sum whose partial sums have no other use, the terms that are known first are
added first; products likewise.

The shortest chain results if the two parts that are ready first are combined, repeatedly (J.-L. Baer, D. P.
Bovet, *Compilation of arithmetic expressions for parallel computations*, 1968).
"""

from collections.abc import Sequence
from heapq import heapify, heappop, heappush

from lagc.lowering.program import Function, Operation
from lagc.lowering.scalar.value_numbering import Block, Row
from lagc.symbolic.operators import OPERATORS

# About how many cycles until a result can be used.
_CYCLES = {
    "const": 0, "load": 5, "neg": 1, "add": 4, "sub": 4, "mul": 4, "div": 14,
    **{op: row.cycles for op, row in OPERATORS.items()},
}  # fmt: skip
_LARGEST = 1500  # operations that are put in order; more are divided into functions, each on its own
_KIND = {"add": "sum", "sub": "sum", "neg": "sum", "mul": "product"}


def balanced(function: Function) -> Function:
    """Return `function` with sums and products in the order that ends first, and the longest chains first."""
    return _Balance(function).run()


class _Balance:
    def __init__(self, function: Function) -> None:
        self.function = function
        self.block = Block()
        self.references: list[int] = []  # of each operation; of an inner one, not used
        self.ready: dict[int, int] = {self.block.zero: 0, self.block.one: 0}  # value number -> cycles
        self.inner = _inner(function)

    def run(self) -> Function:
        function, block = self.function, self.block
        # Inner sums and products are part of their root, which is rebuilt in the order in which its parts are
        # ready.
        for k, o in enumerate(function.operations):
            if self.inner[k]:
                self.references.append(block.zero)
            elif o.op in _KIND:
                self.references.append(self._combine(k))
            else:
                self.references.append(self._plain(o))
        first = len(function.operations)
        for k, store in enumerate(function.stores):
            comment = function.comments.get(first + k, "")
            block.store(store.array, store.index, self.references[store.value], comment)
        schedule = by_height if first <= _LARGEST else None
        about = function.description
        return block.function(function.name, function.inputs, function.outputs, about, schedule)

    # A result is ready its own time after the last of its operands.
    def _plain(self, o: Operation) -> int:
        operands = [self.references[k] for k in o.operands]
        return self._note_time(self.block.repeat(o, operands), operands, _CYCLES[o.op])

    def _note_time(self, found: int, operands: Sequence[int], cycles: int) -> int:
        start = max([self._ready_time(a) for a in operands], default=0)
        self.ready.setdefault(max(found, ~found), start + cycles)
        return found

    def _ready_time(self, a: int) -> int:
        return self.ready.get(max(a, ~a), 0)

    def _combine(self, root: int) -> int:
        """Return the sum or product at `root`: the two parts that are ready first are combined, again and
        again (D. A. Huffman, Proc. IRE 40, 1952)."""
        # The two parts that are ready first are combined, again and again: Huffman's tree for ready times.
        # Ties keep the order of the text, so that the result does not depend on hashes.
        block, product = self.block, _KIND[self.function.operations[root].op] == "product"
        parts = self._parts(root)
        heap = [(self._ready_time(a), n, a) for n, a in enumerate(parts)]
        heapify(heap)
        count = len(heap)
        while len(heap) > 1:
            _, _, a = heappop(heap)
            _, _, b = heappop(heap)
            found = block.mul(a, b) if product else block.add(a, b)
            self._note_time(found, (a, b), 4)
            heappush(heap, (self._ready_time(found), count, found))
            count += 1
        return heap[0][2]

    def _parts(self, root: int) -> list[int]:
        """Return the references of the terms or factors of the sum or product at `root`, left to right."""
        operations, found = self.function.operations, []
        # Signs go to the parts: a - (b - c) has the parts a, -b, c.
        stack = [(root, False)]
        while stack:
            k, negative = stack.pop()
            if k != root and not self.inner[k]:
                found.append(~self.references[k] if negative else self.references[k])
                continue
            o = operations[k]
            signs = (False, o.op == "sub") if len(o.operands) == 2 else (True,)
            for operand, turned in reversed(list(zip(o.operands, signs))):
                stack.append((operand, negative != turned))
        return found


def _inner(function: Function) -> list[bool]:
    """Return, for each operation, whether its only user is a sum (or product) and it is one itself."""
    # Only a value with one user of the same kind is inside: others need it by itself.
    operations = function.operations
    uses = [0] * len(operations)
    by = [-1] * len(operations)
    for k, o in enumerate(operations):
        for operand in o.operands:
            uses[operand] += 1
            by[operand] = k
    for store in function.stores:
        uses[store.value] += 1
        by[store.value] = -1
    return [
        uses[k] == 1 and by[k] >= 0 and o.op in _KIND and _KIND[o.op] == _KIND.get(operations[by[k]].op)
        for k, o in enumerate(operations)
    ]


def by_height(rows: Sequence[Row], roots: Sequence[int]) -> list[int]:
    """Return the operations that `roots` need: of all that could come next, the one with the longest chain to
    an end. Loads and constants stand before their first use."""
    # Height: cycles from an operation to the end of the function. List scheduling by height (T. C. Hu, Oper.
    # Res. 9 (1961) 841-848): the longest chain first.
    needed = _needed(rows, roots)
    height = [0] * len(rows)  # cycles from the start of an operation to the end of the function
    users: dict[int, list[int]] = {v: [] for v in needed}
    for v in reversed(needed):
        height[v] += _CYCLES[rows[v][0]]
        for operand in rows[v][1]:
            height[operand] = max(height[operand], height[v])
            users[operand].append(v)
    # An operation comes when its operands have come; leaves come just before their first use, so that they
    # need no register before.
    missing = {v: len(rows[v][1]) for v in needed}
    order: list[int] = []
    late = {v for v in needed if not rows[v][1]}
    next_ones: list[tuple[int, int]] = []

    def done(v: int) -> None:
        for user in users[v]:
            missing[user] -= 1
            if not missing[user]:
                heappush(next_ones, (-height[user], user))

    for v in needed:
        if v in late:
            done(v)
    while next_ones:
        _, v = heappop(next_ones)
        for operand in rows[v][1]:
            if operand in late:
                late.discard(operand)
                order.append(operand)
        order.append(v)
        done(v)
    return order + [v for v in needed if v in late]


def _needed(rows: Sequence[Row], roots: Sequence[int]) -> list[int]:
    found = set(roots)
    stack = list(found)
    while stack:
        for operand in rows[stack.pop()][1]:
            if operand not in found:
                found.add(operand)
                stack.append(operand)
    return sorted(found)
