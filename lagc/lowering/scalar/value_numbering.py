"""Block: the operations of one function while it is built, with value numbering.

A *reference* is an integer: `k` for value number k and `~k` for its negative. So a sign costs nothing until
it is stored; sums with negative terms become differences.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import isfinite
from operator import add, mul, sub, truediv
from typing import Any, TypeAlias

from lagc.base.records import replace
from lagc.lowering.program import LEAVES, Function, Operation, Store
from lagc.symbolic.leaves import Table
from lagc.symbolic.operators import TRUTHS
from lagc.symbolic.walk import double

STRAIGHT = 1500  # operations and stores; more are in the order in which they were made, see `rolling`

_OF_NUMBERS: dict[str, Callable[[Any, Any], float]] = {"add": add, "sub": sub, "mul": mul, "div": truediv}

_Payload: TypeAlias = "float | tuple[str, int] | Table | None"
Row: TypeAlias = "tuple[str, tuple[int, ...], _Payload]"  # an Operation, before it is one
Schedule: TypeAlias = "Callable[[Sequence[Row], Sequence[int]], list[int]]"


class Block:
    """Maker of one function.  Two operations that are alike are one value."""

    def __init__(self) -> None:
        self._rows: list[Row] = []
        self.stores: list[Store] = []
        self._comments: dict[int, str] = {}  # position in `stores` -> what is stored there
        self._numbers: dict[Row, int] = {}
        self.zero = self.const(0.0)
        self.one = self.const(1.0)

    # -- values ---------------------------------------------------------------

    def _value(self, op: str, operands: tuple[int, ...], payload: _Payload = None) -> int:
        # Equal operations on equal operands are one value (value numbering, J. Cocke, J. T. Schwartz 1970).
        # Results of two numbers are numbers.
        row = (op, operands, payload)
        number = self._numbers.get(row)
        if number is None:
            known = self._known(op, operands)
            if known is not None:
                return self.const(known)
            number = self._numbers[row] = len(self._rows)
            self._rows.append(row)
        return number

    def _known(self, op: str, operands: tuple[int, ...]) -> float | None:
        """Return the result of two numbers if it is a number. Otherwise only some compilers would compute it,
        and with other rounding if arithmetic is rounded up."""
        if op not in _OF_NUMBERS:
            return None
        a, b = self._rows[operands[0]], self._rows[operands[1]]
        if a[0] != "const" or b[0] != "const":
            return None
        try:
            found: float = _OF_NUMBERS[op](a[2], b[2])
        except ArithmeticError:
            return None
        return found if isfinite(found) else None

    def load(self, array: str, index: int) -> int:
        return self._value("load", (), (array, index))

    def const(self, value: float) -> int:
        """Return the reference to a number. Raises Refused if it is infinite."""
        if double(value) < 0.0:
            return ~self._value("const", (), -value)
        return self._value("const", (), value + 0.0)

    def unsigned(self, a: int) -> int:
        """Return the value number of a reference, whatever its sign."""
        return a if a >= 0 else ~a

    def plain(self, a: int) -> int:
        """Return the value number that holds `a` with its sign."""
        return a if a >= 0 else self._value("neg", (~a,))

    def apply(self, op: str, *operands: int) -> int:
        """Return a function or comparison of the language, `op` of `Operation`, of these operands."""
        plain = tuple([a if a >= 0 else self._value("neg", (~a,)) for a in operands])
        if op in ("min", "max") and plain[0] == plain[1]:
            return plain[0]
        return self._value(op, plain)

    def look_up(self, op: str, table: Table, a: int) -> int:
        """Return `piece` or `entry` of a table at `a`."""
        return self._value(op, (self.plain(a),), table)

    # -- arithmetic -----------------------------------------------------------

    def add(self, a: int, b: int) -> int:
        # Zero disappears, equal values of opposite sign cancel, signs go outside: so a + b and b + a, and a -
        # b and -(b - a), are one value.
        zero = self.zero
        if a == zero or a == ~zero:
            return b
        if b == zero or b == ~zero or a == ~b:
            return a if a != ~b else zero
        if (a < 0) != (b < 0):
            return self._difference(a, ~b) if b < 0 else self._difference(b, ~a)
        if a < 0:
            return ~self.add(~a, ~b)
        return self._value("add", (a, b) if a <= b else (b, a))

    def _difference(self, a: int, b: int) -> int:
        """Return a - b, or -(b - a) if b - a is a value already."""
        turned = self._numbers.get(("sub", (b, a), None))
        return self._value("sub", (a, b)) if turned is None else ~turned

    def sub(self, a: int, b: int) -> int:
        return self.add(a, ~b)

    def mul(self, a: int, b: int) -> int:
        # The sign of a product is that of its factors: they are multiplied without theirs.
        if (a < 0) != (b < 0):
            return ~self.mul(a if a >= 0 else ~a, b if b >= 0 else ~b)
        if a < 0:
            a, b = ~a, ~b
        if a == self.zero or b == self.zero:
            return self.zero
        if a == self.one:
            return b
        if b == self.one:
            return a
        return self._value("mul", (a, b) if a <= b else (b, a))

    def div(self, a: int, b: int) -> int:
        if (a < 0) != (b < 0):
            return ~self.div(a if a >= 0 else ~a, b if b >= 0 else ~b)
        if a < 0:
            a, b = ~a, ~b
        if b == self.one or a == self.zero:
            return a
        return self._value("div", (a, b))

    def abs(self, a: int) -> int:
        return self._value("abs", (self.unsigned(a),))

    def is_zero(self, a: int) -> bool:
        return a == self.zero or a == ~self.zero

    def repeat(self, o: Operation, operands: Sequence[int]) -> int:
        """Return the operation `o` on other operands."""
        arithmetic = _ARITHMETIC.get(o.op)
        if arithmetic:
            return arithmetic(self, *operands)
        if o.op == "const":
            assert isinstance(o.payload, float | int)
            return self.const(o.payload)
        if o.op == "load":
            assert isinstance(o.payload, tuple)
            return self.load(*o.payload)
        if o.op == "neg":
            return ~operands[0]
        if isinstance(o.payload, Table):
            return self.look_up(o.op, o.payload, *operands)
        return self.apply(o.op, *operands)

    def row(self, a: int) -> Row:
        """Return the operation that makes value number `a`."""
        return self._rows[a]

    def needed_for(self, roots: Sequence[int]) -> set[int]:
        """Return the value numbers that `roots` are made of."""
        return set(_schedule(self._rows, [self.unsigned(a) for a in roots]))

    def split_off(self, wanted: int, array: str, first: int, parameters: int) -> tuple[Block, int]:
        """Return another block that computes `wanted` and the reference to it there. It reads `parameters`
        and the values that the stores of this block need, which are stored from array[first] on."""
        # Two kinds of values are computed again in the other block: those of parameters alone, and those that
        # nothing here needs. All others are stored here and loaded there.
        here = self.needed_for([store.value for store in self.stores])
        again: list[bool] = []  # what is made of parameters alone, or nobody else needs
        fixed: list[bool] = []
        for k, (op, operands, payload) in enumerate(self._rows):
            given = payload[0] == "p" and payload[1] < parameters if isinstance(payload, tuple) else True
            fixed.append(given and all([fixed[i] for i in operands]))
            again.append(fixed[k] or k not in here or op in TRUTHS)
        # Down from the root, as far as values are computed again.
        root = self.unsigned(wanted)
        needed, asked = {root}, [root]
        while asked:
            k = asked.pop()
            asked += set(self._rows[k][1]) - needed if again[k] else ()
            needed.update(asked)
        other, made = Block(), dict[int, int]()
        for k in sorted(needed):
            op, operands, payload = self._rows[k]
            if again[k]:
                made[k] = other.repeat(Operation(op, (), payload), [made[i] for i in operands])
            else:
                self.store(array, first, k)
                made[k] = other.load(array, first)
                first += 1
        return other, made[root] if wanted >= 0 else ~made[root]

    # -- the result -----------------------------------------------------------

    def store(self, array: str, index: int, a: int, comment: str = "") -> None:
        if comment:
            self._comments[len(self.stores)] = comment
        self.stores.append(Store(array, index, self.plain(a)))

    def function(
        self,
        name: str,
        inputs: tuple[str, ...],
        outputs: Sequence[tuple[str, int]],
        description: str,
        schedule: Schedule | None = None,
    ) -> Function:
        """Return the operations that the stores need, each close before its first use, or in the order that
        `schedule` gives: (operations and operands, roots) -> value numbers. A long function keeps the order
        in which it was made, leaves first."""
        # Long functions stay in the order in which they were made, which loops need; short ones have each
        # value close to its first use.
        roots = [s.value for s in self.stores]
        order = _as_made(self._rows, roots) if len(self._rows) + len(roots) > STRAIGHT else []
        if len(order) + len(roots) <= STRAIGHT:
            order = (schedule or _schedule)(self._rows, roots)
        number = {old: new for new, old in enumerate(order)}
        operations = []
        for old in order:
            op, operands, payload = self._rows[old]
            operations.append(Operation(op, tuple([number[k] for k in operands]), payload))
        stores = tuple([Store(s.array, s.index, number[s.value]) for s in self.stores])
        comments = {len(operations) + k: text for k, text in self._comments.items()}
        return Function(name, inputs, tuple(outputs), tuple(operations), stores, description, comments)


_ARITHMETIC: dict[str, Callable[..., int]] = {
    "add": Block.add, "sub": Block.sub, "mul": Block.mul, "div": Block.div, "abs": Block.abs,
}  # fmt: skip


def _as_made(rows: Sequence[Row], roots: Sequence[int]) -> list[int]:
    """Return the value numbers that `roots` need, in their order, leaves first."""
    # Needed values, by marks from the last to the first; leaves before all others.
    needed = bytearray(len(rows))
    for root in roots:
        needed[root] = 1
    leaves: list[int] = []
    others: list[int] = []
    for k in range(len(rows) - 1, -1, -1):
        if needed[k]:
            op, operands, _ = rows[k]
            (leaves if op in LEAVES else others).append(k)
            for operand in operands:
                needed[operand] = 1
    return leaves[::-1] + others[::-1]


def _schedule(rows: Sequence[Row], roots: Sequence[int]) -> list[int]:
    """Return the value numbers in depth-first postorder from `roots`."""
    # Depth-first postorder without recursion: a value is placed when all of its operands are.
    order: list[int] = []
    state = bytearray(len(rows))  # 1: operands asked for, 2: placed
    for root in roots:
        stack = [root]
        while stack:
            value = stack[-1]
            if state[value]:
                stack.pop()
                if state[value] == 1:
                    state[value] = 2
                    order.append(value)
                continue
            state[value] = 1
            for operand in reversed(rows[value][1]):
                if not state[operand]:
                    stack.append(operand)
    return order


def ordered(function: Function) -> Function:
    """Return the function with each operation close before its first use."""
    rows = [(o.op, o.operands, o.payload) for o in function.operations]
    return reordered(function, _schedule(rows, [s.value for s in function.stores]))


def reordered(function: Function, order: Sequence[int]) -> Function:
    """Return the function with the operations that `order` names, in this order; the others are not used."""
    number = {old: new for new, old in enumerate(order)}
    operations = [function.operations[k] for k in order]
    behind = len(order) - len(function.operations)
    return replace(
        function,
        operations=tuple(
            [Operation(o.op, tuple([number[k] for k in o.operands]), o.payload) for o in operations]
        ),
        stores=tuple([Store(s.array, s.index, number[s.value]) for s in function.stores]),
        comments={behind + k: text for k, text in function.comments.items()},
    )
