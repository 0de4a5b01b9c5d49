"""Expressions of SymPy, which is imported when it is used: a motion does not need it."""

from collections.abc import Callable, Sequence
from typing import Any

from lagc.symbolic.graph import Node
from lagc.symbolic.operators import LOOKED_UP, spelling
from lagc.symbolic.walk import reachable

_NAMES = spelling("sympy")


def to_sympy(nodes: Sequence[Node], names: Callable[[Node], Any] | None = None) -> list[Any]:
    """Return the sympy expressions of `nodes`. `names` gives the sympy object of a symbol; without it a real
    symbol of the symbol's own name. Floats that are integers or simple fractions (0.5, 0.25) become exact
    numbers."""
    import sympy

    def plain(symbol: Node) -> Any:
        return sympy.Symbol(symbol.record.name, real=True)

    leaf = names or plain
    known: dict[Node, Any] = {}
    for node in reachable(nodes):
        args = [known[a] for a in node.args]
        known[node] = leaf(node) if node.op == "symbol" else _to(sympy, node, args)
    return [known[node] for node in nodes]


def _to(sympy: Any, node: Node, args: list[Any]) -> Any:
    op = node.op
    if op == "const":
        return _number(sympy, node.value)
    if op == "add":
        return args[0] + args[1]
    if op == "scale":
        return _number(sympy, node.value) * args[0]
    if op == "mul":
        exponents: tuple[int, ...] = node.value
        return sympy.Mul(*[base**e for base, e in zip(args, exponents)])
    if op == "pow":
        return args[0] ** args[1]
    if op == "select":
        return sympy.Piecewise((args[1], args[0]), (args[2], True))
    if op in LOOKED_UP:
        return sympy.Function(f"{op}_{node.value.name}", real=True)(*args)
    return getattr(sympy, _NAMES[op])(*args)


def _number(sympy: Any, value: float) -> Any:
    if value == int(value) and abs(value) < 1e15:
        return sympy.Integer(int(value))
    numerator, denominator = value.as_integer_ratio()
    return sympy.Rational(numerator, denominator) if denominator <= 64 else sympy.Float(value)
