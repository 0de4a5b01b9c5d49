"""Questions about syntax trees."""

from __future__ import annotations

import ast
from typing import Any


def identifier(node: ast.expr) -> str:
    """Of what is a name alone; else empty."""
    return node.id if isinstance(node, ast.Name) else ""


def root(node: ast.expr) -> str:
    """The name that an entry or a member belongs to."""
    while isinstance(node, ast.Subscript | ast.Attribute):
        node = node.value
    return identifier(node)


def roots(node: ast.expr) -> set[str]:
    """The names that an expression of arrays is part of."""
    if isinstance(node, ast.IfExp):
        return roots(node.body) | roots(node.orelse)
    return {root(node)} - {""}


def targets(body: list[ast.stmt]) -> set[str]:
    """The names that statements bind."""
    return {
        n.id for s in body for n in ast.walk(s) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)
    }


def returns(body: list[ast.stmt]) -> bool:
    """Whether the end of a block is never reached."""
    if not body:
        return False
    last = body[-1]
    if isinstance(last, ast.If):
        return returns(last.body) and returns(last.orelse)
    if isinstance(last, ast.While) and isinstance(last.test, ast.Constant):
        return not any(isinstance(n, ast.Break) for s in last.body for n in _own(s))
    return isinstance(last, ast.Return)


def _own(node: ast.stmt) -> list[ast.AST]:
    """The nodes of a statement, without those of loops in it."""
    if isinstance(node, ast.For | ast.While):
        return []
    found: list[ast.AST] = [node]
    for inner in (*getattr(node, "body", ()), *getattr(node, "orelse", ())):
        found += _own(inner)
    return found


def clone(node: Any) -> Any:
    """A copy of a tree with its comments: what copy.deepcopy does, five times as fast."""
    if isinstance(node, list):
        return [clone(n) for n in node]
    if not isinstance(node, ast.AST):
        return node
    found = node.__class__.__new__(node.__class__)
    for name, value in node.__dict__.items():
        found.__dict__[name] = clone(value) if isinstance(value, ast.AST | list) else value
    return found
