"""Values that depend on parameters alone are computed once, by `bind`, and not in every call.

One function computes all values of parameters and numbers that cost an operation, for all other functions. A
quotient by such a value becomes a product with its inverse.
"""

from collections.abc import Mapping

from lagc.base.records import replace
from lagc.lowering.program import Function, Operation, uses
from lagc.lowering.scalar.value_numbering import Block
from lagc.symbolic.operators import TRUTHS

PREPARED = "prepared"  # the array that `bind` fills
NUMBER, FIXED, MOVING = range(3)  # what a value is made of


def dependence(function: Function, parameters: int) -> list[int]:
    """Return for each value whether it is made of numbers alone, of parameters and numbers, or of more."""
    # The most that one of its operands depends on: number < parameter < anything that moves.
    found: list[int] = []
    for o in function.operations:
        if o.op == "load":
            assert isinstance(o.payload, tuple)
            array, index = o.payload
            found.append(FIXED if array == "p" and index < parameters else MOVING)
        elif len(o.operands) == 2:
            a, b = o.operands
            found.append(found[a] if found[a] > found[b] else found[b])
        else:
            found.append(max([found[k] for k in o.operands], default=NUMBER))
    return found


class Preparation:
    """Gathers what `bind` computes; p holds so many `parameters`, then inputs: `given` in all."""

    def __init__(self, parameters: int, given: int) -> None:
        self.parameters, self.given = parameters, given
        self.block = Block()
        self._numbers: list[bool] = []

    def is_number(self, a: int) -> bool:
        """Return whether value number `a` of the block is made of numbers alone."""
        known = self._numbers
        for number in range(len(known), a + 1):
            op, operands, _ = self.block.row(number)
            known.append(op != "load" and all([known[i] for i in operands]))
        return known[a]

    def separated(self, function: Function) -> Function:
        """Return `function` with the prepared values as entries of PREPARED, by their value numbers in the
        block."""
        if "p" not in function.inputs or len(function.inputs) == 1:  # one of p alone is called as rare
            return function
        return _Separation(self, function).run()

    def finished(self, functions: Mapping[str, Function]) -> tuple[dict[str, Function], tuple[int, ...]]:
        """Return `functions` with the places of prepared values behind p; `bind`, if there is any; and the
        parameters that it reads, whose copies it stores last."""
        places: dict[int, int] = {}
        found = {name: self._place_in_block(function, places) for name, function in functions.items()}
        if not places:
            return found, ()
        for number in places:
            self.block.store(PREPARED, len(self.block.stores), number)
        first = self._bind()
        read = sorted({o.payload[1] for o in first.operations if isinstance(o.payload, tuple)})
        for index in read:
            self.block.store(PREPARED, len(self.block.stores), self.block.load("p", index))
        return {"bind": self._bind(), **found}, tuple(read)

    def _bind(self) -> Function:
        about = "what depends on parameters alone, then these"
        return self.block.function("bind", ("p",), ((PREPARED, len(self.block.stores)),), about)

    def _place_in_block(self, function: Function, places: dict[int, int]) -> Function:
        operations = []
        for o in function.operations:
            if isinstance(o.payload, tuple) and o.payload[0] == PREPARED:
                place = places.setdefault(o.payload[1], len(places))
                o = Operation("load", (), ("p", self.given + place))
            operations.append(o)
        return replace(function, operations=tuple(operations))


class _Separation:
    def __init__(self, preparation: Preparation, function: Function) -> None:
        self.preparation, self.function = preparation, function
        self.block, self.shared = Block(), preparation.block
        self.made_of = dependence(function, preparation.parameters)
        self.uses = uses(function)
        self.kept: dict[int, int] = {}  # references in the shared block
        self.moving: dict[int, int] = {}  # and in this function's own
        self.entries: dict[int, int] = {}  # values of the shared block in this function's own
        self.products: dict[int, tuple[int, int]] = {}  # coefficient (shared) and rest (own) of a product

    def run(self) -> Function:
        function, block, made_of = self.function, self.block, self.made_of
        moving, kept, products = self.moving, self.kept, self.products
        for k, o in enumerate(function.operations):
            if not self.uses[k]:
                continue
            if made_of[k] != MOVING:
                kept[k] = self.shared.repeat(o, [kept[i] for i in o.operands])
                continue
            moving[k] = block.repeat(o, [moving[i] if i in moving else self._value(i) for i in o.operands])
            product = o.op == "mul" or (o.op == "div" and made_of[o.operands[1]] == FIXED)
            if product and any([i in kept or i in products for i in o.operands]):
                moving[k] = self._product(k, o)
        first = len(function.operations)
        for n, store in enumerate(function.stores):
            block.store(
                store.array, store.index, self._value(store.value), function.comments.get(first + n, "")
            )
        made = block.function(function.name, function.inputs, function.outputs, function.description)
        return replace(made, cleared=function.cleared)

    def _product(self, k: int, o: Operation) -> int:
        """Return operation k as a prepared coefficient times the rest; unchanged if the coefficient is a
        number."""
        coefficient, rest = self.shared.one, self.block.one
        for i in o.operands:
            one, other = self._factors(i)
            if o.op == "div" and i == o.operands[1]:
                one = self.shared.div(self.shared.one, one)
            coefficient, rest = self.shared.mul(coefficient, one), self.block.mul(rest, other)
        self.products[k] = coefficient, rest
        number = self.preparation.is_number(max(coefficient, ~coefficient))
        return self.moving[k] if number else self.block.mul(self._entry(coefficient), rest)

    def _factors(self, k: int) -> tuple[int, int]:
        """Return the coefficient and the remaining factor of value k."""
        if k in self.kept:
            return self.kept[k], self.block.one
        if k in self.products and self.uses[k] == 1:
            return self.products[k]
        return self.shared.one, self.moving[k]

    def _value(self, k: int) -> int:
        """Return value k in the function's own block."""
        if k not in self.moving:
            o = self.function.operations[k]
            if o.op in TRUTHS:  # no number that could be kept
                self.moving[k] = self.block.repeat(o, [self._value(i) for i in o.operands])
            else:
                self.moving[k] = self._entry(self.kept[k])
        return self.moving[k]

    def _entry(self, a: int) -> int:
        """Return the value of the shared block at `a`, loaded where it costs an operation on parameters."""
        if a < 0:
            return ~self._entry(~a)
        if a not in self.entries:
            op, operands, payload = self.shared.row(a)
            if op == "load" or self.preparation.is_number(a):
                again = Operation(op, (), payload)
                self.entries[a] = self.block.repeat(again, [self._entry(i) for i in operands])
            else:
                self.entries[a] = self.block.load(PREPARED, a)
        return self.entries[a]
