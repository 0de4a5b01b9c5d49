"""A reference interpreter of Program functions: operations in `math`, one after the other."""

import math
from collections.abc import Mapping, Sequence

from lagc.lowering.program import Function, Program
from lagc.symbolic.leaves import Table

FUNCTIONS = {
    "neg": lambda a: -a,
    "add": lambda a, b: a + b,
    "sub": lambda a, b: a - b,
    "mul": lambda a, b: a * b,
    "div": lambda a, b: a / b if b else math.copysign(math.inf, a) if a else math.nan,
    "abs": math.fabs,
    "sign": lambda a: float((a > 0) - (a < 0)),
    "floor": lambda a: float(math.floor(a)),
    "min": lambda a, b: b if b < a else a,
    "max": lambda a, b: b if b > a else a,
    "lt": lambda a, b: a < b,
    "le": lambda a, b: a <= b,
    "eq": lambda a, b: a == b,
    "and": lambda a, b: a and b,
    "or": lambda a, b: a or b,
    "not": lambda a: not a,
    "select": lambda c, a, b: a if c else b,
    **{name: getattr(math, name) for name in (
        "sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "exp", "log", "sqrt",
        "atan2", "pow",
    )},
}  # fmt: skip


def interpret(function: Function, inputs: Mapping[str, Sequence[float]]) -> dict[str, list[float]]:
    """Output array -> its entries.  An array that is read and written starts as it is given;
    an entry that is never written is NaN."""
    values: list[float] = []
    for o in function.operations:
        if o.op == "const":
            assert isinstance(o.payload, float)
            values.append(o.payload)
        elif o.op == "load":
            assert isinstance(o.payload, tuple)
            array, index = o.payload
            assert array in function.inputs
            values.append(inputs[array][index])
        elif isinstance(o.payload, Table):
            # Counted, not searched for; every comparison with NaN is false.
            x = values[o.operands[0]]
            above = [x < number for number in o.payload]
            place = max((above.index(True) if any(above) else len(above)) - 1, 0)
            values.append(float(place) if o.op == "piece" else o.payload.numbers[int(x)])
        else:
            values.append(FUNCTIONS[o.op](*(values[k] for k in o.operands)))
    found = {
        array: list(inputs[array]) if array in function.inputs else [math.nan] * length
        for array, length in function.outputs
    }
    for s in function.stores:
        found[s.array][s.index] = values[s.value]
    return found


def ask(program: Program, name: str, inputs: Mapping[str, Sequence[float]]) -> dict[str, list[float]]:
    """A function of `program`; p are parameters and inputs, which are bound here."""
    return interpret(program.functions[name], {**inputs, "p": bound(program, inputs["p"])})


def bound(program: Program, p: Sequence[float]) -> list[float]:
    """p with what is prepared of it."""
    bind = program.functions.get("bind")
    return [*p, *(interpret(bind, {"p": p})["prepared"] if bind is not None else ())]
