"""Stable text of an expression, for messages, comments and golden files."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, TypeAlias

from lagc.symbolic.operators import INFIX
from lagc.symbolic.walk import missing, reachable

if TYPE_CHECKING:
    from lagc.symbolic.graph import Node

_SUM, _PRODUCT, _POWER, _ATOM = 1, 2, 3, 4
Texts: TypeAlias = "dict[Node, tuple[str, int]]"  # text and precedence of nodes
_LONGEST = 120  # characters of a short text
_BREAKS = re.compile(r" (?:[-+<>=]+|and|or|then|else) |[*/]")


def number(value: float) -> str:
    """Return the shortest text that reads back exactly; integers have no point."""
    return repr(int(value)) if value == int(value) and abs(value) < 1e15 else repr(value)


def text(node: Node) -> str:
    """Return `node` in the model language, e.g. `m*l^2*der(theta) - 2*cos(theta)`."""
    done: Texts = {}
    for below in reachable([node]):
        done[below] = _write(below, done)
    return done[node][0]


def brief(node: Node, known: Texts | None = None) -> str:
    """Return the text of `node`, with the middle of a long one left out; `known` caches the texts of nodes
    below."""
    done: Texts = {} if known is None else known
    for below in missing([node], done):
        whole, level = _write(below, done)
        done[below] = _abridged(whole), level
    return done[node][0]


def _abridged(whole: str) -> str:
    """Return a long text cut at operators, with one ellipsis."""
    if len(whole) <= _LONGEST:
        return whole
    first, last = whole[: _LONGEST // 2].split("...")[0], whole[-_LONGEST // 3 :].split("...")[-1]
    ends, begin = [found.end() for found in _BREAKS.finditer(first)], _BREAKS.search(last)
    return f"{first[: ends[-1] if ends else None]}...{last[begin.start() if begin else 0 :]}"


def _wrap(part: tuple[str, int], level: int) -> str:
    return part[0] if part[1] >= level else f"({part[0]})"


def _write(node: Node, done: Texts) -> tuple[str, int]:
    # Each text comes with how tightly it binds; a part that binds less than its place needs parentheses.
    op, parts = node.op, [done[a] for a in node.args]
    if op == "const":
        value: float = node.value
        return number(value), _ATOM if value >= 0 else _SUM
    if op == "symbol":
        return node.record.name, _ATOM
    if op == "add":
        left, right = (_wrap(part, _SUM) for part in parts)
        if right.startswith("-"):
            return f"{left} - {right[1:]}", _SUM
        return f"{left} + {right}", _SUM
    if op == "scale":
        factor = _wrap(parts[0], _PRODUCT)
        if node.value == -1.0:
            return f"-{factor}", _SUM
        sign = "-" if node.value < 0 else ""
        return f"{sign}{number(abs(node.value))}*{factor}", _SUM if sign else _PRODUCT
    if op == "mul":
        return _monomial(parts, node.value)
    if op == "select":
        return f"if {parts[0][0]} then {parts[1][0]} else {parts[2][0]}", 0
    if op in INFIX:
        return f"({parts[0][0]} {INFIX[op]} {parts[1][0]})", _ATOM
    if op == "piece":
        return f"piece({node.value.name}, {parts[0][0]})", _ATOM
    if op == "entry":
        return f"{node.value.name}[{parts[0][0]}]", _ATOM
    if op == "pow":
        return f"{_wrap(parts[0], _ATOM)}^{_wrap(parts[1], _ATOM)}", _POWER
    return f"{op}({', '.join(p[0] for p in parts)})", _ATOM


def _monomial(parts: list[tuple[str, int]], exponents: tuple[int, ...]) -> tuple[str, int]:
    over = [_factor(p, e) for p, e in zip(parts, exponents) if e > 0]
    under = [_factor(p, -e) for p, e in zip(parts, exponents) if e < 0]
    top = "*".join(over) or "1"
    if not under:
        return top, _PRODUCT
    bottom = under[0] if len(under) == 1 else f"({'*'.join(under)})"
    return f"{top}/{bottom}", _PRODUCT


def _factor(part: tuple[str, int], exponent: int) -> str:
    if exponent == 1:
        return _wrap(part, _POWER)
    return f"{_wrap(part, _ATOM)}^{exponent}"
