"""To and from sympy: for equations that people read, and as an oracle of the tests.

sympy is imported when it is used; nothing on the way from a model to its motion needs it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.operators import LOOKED_UP, OPERATORS, spelling
from lagc.symbolic.walk import reachable

_NAMES = spelling("sympy")
_KNOWN = {op: name for op, name in _NAMES.items() if op not in LOOKED_UP}


def to_sympy(nodes: Sequence[Node], names: Callable[[Node], Any] | None = None) -> list[Any]:
    """The sympy expressions of `nodes`. `names` gives the sympy object of a symbol; without it a real symbol
    of the symbol's own name. Floats that are integers or simple fractions (0.5, 0.25) become exact
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


def from_sympy(graph: Graph, expr: Any, symbols: Mapping[Any, Node]) -> Node:
    """The node of a sympy expression whose symbols are the keys of `symbols`. Raises ValueError for a
    function that the graph does not have, or for an unknown symbol."""
    import sympy

    known: dict[Any, Node] = dict(symbols)
    stack = [sympy.sympify(expr)]
    while stack:
        top = stack[-1]
        if top in known:
            stack.pop()
            continue
        missing = [a for a in _arguments(sympy, top) if a not in known]
        if missing:
            stack.extend(missing)
            continue
        stack.pop()
        known[top] = _from(sympy, graph, top, known)
    return known[sympy.sympify(expr)]


def _arguments(sympy: Any, expr: Any) -> list[Any]:
    if isinstance(expr, sympy.Piecewise):
        return [part for pair in expr.args for part in pair.args]
    return list(expr.args)


def _from(sympy: Any, graph: Graph, expr: Any, known: Mapping[Any, Node]) -> Node:
    if expr.is_Number or isinstance(expr, sympy.NumberSymbol):
        return graph.const(float(expr))
    if expr in (sympy.true, sympy.false):
        return graph.const(float(bool(expr)))
    args = [known[a] for a in _arguments(sympy, expr)]
    if isinstance(expr, sympy.Add):
        return graph.sum(args)
    if isinstance(expr, sympy.Mul):
        product = graph.one
        for factor in args:
            product = product * factor
        return product
    if isinstance(expr, sympy.Pow):
        if expr.exp == sympy.Rational(-1, 2):
            return 1.0 / graph.sqrt(args[0])
        return graph.pow(*args)
    if isinstance(expr, sympy.Piecewise):
        return _piecewise(graph, args)
    name = type(expr).__name__
    if name in ("GreaterThan", "StrictGreaterThan"):
        return graph.binary("le" if name == "GreaterThan" else "lt", args[1], args[0])
    op = next((op for op, spelt in _KNOWN.items() if type(expr) is getattr(sympy, spelt)), None)
    if op is not None and len(args) == OPERATORS[op].arity == 1:
        return graph.logical_not(args[0]) if op == "not" else graph.unary(op, args[0])
    if op is not None and len(args) >= OPERATORS[op].arity == 2:
        total = args[0]
        for argument in args[1:]:
            total = graph.binary(op, total, argument)
        return total
    raise ValueError(f"no node for the sympy expression {expr!r}")


def _piecewise(graph: Graph, args: Sequence[Node]) -> Node:
    """Nested choices; the last branch is taken where no condition holds."""
    total = args[-2]
    for k in range(len(args) - 4, -1, -2):
        total = graph.select(args[k + 1], args[k], total)
    return total
