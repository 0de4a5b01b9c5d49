"""Programs written by hand: Python functions on traced values become functions of a Program."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

from lagc.lowering.program import Function, Operation, Program, Store
from tests.interfaces import field, interface


class Traced:
    """A value of a function under construction."""

    def __init__(self, trace: Trace, number: int) -> None:
        self.trace, self.number = trace, number

    def __add__(self, other: Any) -> Traced:
        return self.trace.op("add", self, other)

    def __radd__(self, other: Any) -> Traced:
        return self.trace.op("add", other, self)

    def __sub__(self, other: Any) -> Traced:
        return self.trace.op("sub", self, other)

    def __rsub__(self, other: Any) -> Traced:
        return self.trace.op("sub", other, self)

    def __mul__(self, other: Any) -> Traced:
        return self.trace.op("mul", self, other)

    def __rmul__(self, other: Any) -> Traced:
        return self.trace.op("mul", other, self)

    def __truediv__(self, other: Any) -> Traced:
        return self.trace.op("div", self, other)

    def __rtruediv__(self, other: Any) -> Traced:
        return self.trace.op("div", other, self)

    def __neg__(self) -> Traced:
        return self.trace.op("neg", self)

    def __abs__(self) -> Traced:
        return self.trace.op("abs", self)

    def call(self, name: str) -> Traced:
        return self.trace.op(name, self)


class Trace:
    def __init__(self) -> None:
        self.operations: list[Operation] = []
        self.loads: dict[tuple[str, int], Traced] = {}

    def op(self, name: str, *operands: Any) -> Traced:
        numbers = tuple(self.value(o).number for o in operands)
        return self.add(Operation(name, numbers))

    def add(self, operation: Operation) -> Traced:
        self.operations.append(operation)
        return Traced(self, len(self.operations) - 1)

    def value(self, given: Any) -> Traced:
        return given if isinstance(given, Traced) else self.add(Operation("const", (), float(given)))

    def load(self, array: str, index: int) -> Traced:
        if (array, index) not in self.loads:
            self.loads[array, index] = self.add(Operation("load", (), (array, index)))
        return self.loads[array, index]


def sin(x: Any) -> Any:
    return x.call("sin") if isinstance(x, Traced) else math.sin(x)


def cos(x: Any) -> Any:
    return x.call("cos") if isinstance(x, Traced) else math.cos(x)


def sqrt(x: Any) -> Any:
    return x.call("sqrt") if isinstance(x, Traced) else math.sqrt(x)


class _Array:
    def __init__(self, trace: Trace, name: str) -> None:
        self.trace, self.name = trace, name

    def __getitem__(self, index: int) -> Traced:
        return self.trace.load(self.name, index)


def trace(
    name: str,
    inputs: Sequence[str],
    outputs: Sequence[tuple[str, int]],
    body: Callable[..., Sequence[Sequence[Any]]],
) -> Function:
    """`body` of the inputs (arrays to index; t a value) gives the values of each output."""
    t = Trace()
    results = body(*(t.load("t", 0) if i == "t" else _Array(t, i) for i in inputs))
    stores = []
    for (array, length), values in zip(outputs, results):
        assert len(values) == length, (name, array)
        stores += [Store(array, i, t.value(v).number) for i, v in enumerate(values)]
    return Function(name, tuple(inputs), tuple(outputs), tuple(t.operations), tuple(stores))


PTX = ("p", "t", "x")


def program(
    name: str,
    nq: int,
    nv: int,
    nc: int,
    nh: int,
    functions: Sequence[Function],
    parameters: dict[str, float],
    **more: Any,
) -> Program:
    made = interface(
        name, nq, nv, nc, nh=nh, functions=tuple(f.name for f in functions),
        parameters=tuple(field(k, v) for k, v in parameters.items()), **more,
    )  # fmt: skip
    return Program(made, {f.name: f for f in functions})
