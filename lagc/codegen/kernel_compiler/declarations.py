"""Where C may declare the locals of a function."""

from __future__ import annotations

import ast
from collections.abc import Sequence


def places(body: Sequence[ast.stmt]) -> dict[str, ast.stmt | None]:
    """Of each name its first assignment, where that stands in the innermost block that holds all its uses,
    and can declare it; None where it is declared at the top, as its value may outlive a turn of a loop."""
    uses: dict[str, list[tuple[Sequence[ast.stmt], ...]]] = {}  # name -> blocks around each use, outer first
    first: dict[str, ast.stmt | None] = {}

    def note(name: str, path: tuple[Sequence[ast.stmt], ...], node: ast.stmt | None) -> None:
        first.setdefault(name, node)
        uses.setdefault(name, []).append(path)

    def names(node: ast.AST) -> list[str]:
        return [n.id for n in ast.walk(node) if isinstance(n, ast.Name)]

    def walk(block: Sequence[ast.stmt], path: tuple[Sequence[ast.stmt], ...]) -> None:
        path = (*path, block)
        for node in block:
            if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
                for name in names(node.value):
                    note(name, path, None)
                note(node.targets[0].id, path, node)
                continue
            for child in ast.iter_child_nodes(node):
                if not isinstance(child, ast.stmt):
                    for name in names(child):
                        note(name, path, None)
            walk_inner(node, path)

    def walk_inner(node: ast.stmt, path: tuple[Sequence[ast.stmt], ...]) -> None:
        for inner in (getattr(node, "body", None), getattr(node, "orelse", None)):
            if inner:
                walk(inner, path)

    walk(body, ())
    found: dict[str, ast.stmt | None] = {}
    for name, paths in uses.items():
        shared = paths[0]
        for path in paths[1:]:
            common = [a for a, b in zip(shared, path) if a is b]
            shared = tuple(common)
        block, start = shared[-1], first[name]
        found[name] = start if any(start is node for node in block) else None
    return found
