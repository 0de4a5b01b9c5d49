"""Kernel files as syntax trees with comments. Constructs outside of the subset are refused."""

from __future__ import annotations

import ast
import os
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import lagc.kernels


class Outside(Exception):
    """A construct that is not part of the subset: file, line and reason."""

    def __init__(self, file: str, node: ast.AST | int, what: str):
        super().__init__(f"{file}:{node if isinstance(node, int) else getattr(node, 'lineno', 0)}: {what}")


class Missing(Outside):
    """A member of a record that models with these flags do not have."""


@dataclass(frozen=True)
class Function:
    file: str
    line: int
    name: str
    parameters: tuple[tuple[str, str], ...]  # name, annotation
    returns: str
    doc: str
    body: list[ast.stmt]
    public: bool
    inline: bool  # C compilers get this hint
    lead: tuple[str, ...]  # comments before it


@dataclass(frozen=True)
class Record:
    file: str
    line: int
    name: str
    doc: str
    body: list[ast.stmt]


@dataclass(frozen=True)
class Constant:
    """`kind`: int, Real, Reals (an array), Status (of the interface), Code (of an enumeration of the
    interface)."""

    file: str
    line: int
    name: str
    kind: str
    value: Any  # int, float, of Reals a tuple, or of a Real by type: float, float, decimal text
    lead: tuple[str, ...]
    trail: str


@dataclass(frozen=True)
class Module:
    """A kernel file: its title, and its definitions in order."""

    file: str
    title: str
    text: str  # of the docstring behind its title
    parts: tuple[Function | Record | Constant, ...]


def folder() -> str:
    return os.path.dirname(os.path.abspath(lagc.kernels.__file__))


def read(name: str) -> Module:
    """Read the kernel file `name`."""
    path = os.path.join(folder(), *name.split("/")) + ".py"
    with open(path, encoding="utf-8") as file:
        return module(f"{name}.py", file.read())


def module(file: str, text: str) -> Module:
    tree = ast.parse(text, os.path.join(folder(), file))
    attach(tree.body, _comments(text), 0)
    parts: list[Function | Record | Constant] = []
    for node in tree.body:
        if isinstance(node, ast.FunctionDef):
            parts.append(_function(file, node))
        elif isinstance(node, ast.ClassDef) and [getattr(d, "id", "") for d in node.decorator_list] == [
            "struct"
        ]:
            doc = ast.get_docstring(node) or ""
            parts.append(Record(file, node.lineno, node.name, doc, node.body[1:] if doc else node.body))
        elif isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
            parts.append(_constant(file, node, node.targets[0].id))
        elif not isinstance(node, ast.Import | ast.ImportFrom) and not _is_text(node):
            raise Outside(file, node, f"{type(node).__name__} at the level of the file")
    title, _, rest = (ast.get_docstring(tree) or "").partition("\n\n")
    return Module(file, title.removesuffix("."), rest, tuple(parts))


def _is_text(node: ast.stmt) -> bool:
    return (
        isinstance(node, ast.Expr)
        and isinstance(node.value, ast.Constant)
        and isinstance(node.value.value, str)
    )


def _function(file: str, node: ast.FunctionDef) -> Function:
    a = node.args
    if a.posonlyargs or a.vararg or a.kwonlyargs or a.kwarg or a.defaults:
        raise Outside(file, node, "arguments are plain: no defaults, stars or keywords")
    if node.returns is None or any(arg.annotation is None for arg in a.args):
        raise Outside(file, node, "every argument and the result has a type")
    decorators = [ast.unparse(d) for d in node.decorator_list]
    if not set(decorators) <= {"public", "inline"}:
        raise Outside(file, node, "the only decorators are @public and @inline")
    doc = ast.get_docstring(node) or ""
    parameters = tuple((arg.arg, ast.unparse(arg.annotation)) for arg in a.args if arg.annotation)
    return Function(file, node.lineno, node.name, parameters, ast.unparse(node.returns), doc,
                    node.body[1:] if doc else node.body,
                    "public" in decorators, "inline" in decorators, tuple(node.lead))  # type: ignore[attr-defined]  # fmt: skip


def _constant(file: str, node: ast.Assign, name: str) -> Constant:
    value, kind, found = node.value, "", None
    if isinstance(value, ast.Call) and isinstance(value.func, ast.Name) and not value.keywords:
        kind = {"by_type": "Real", "Status": "Status", "Code": "Code"}.get(value.func.id, "")
        given = [literal(a) for a in value.args]
        if len(given) == (3 if kind == "Real" else 1) and kind and None not in given:
            found = tuple(given) if kind == "Real" else given[0]
    elif isinstance(value, ast.Tuple):
        given, kind = [literal(e) for e in value.elts], "Reals"
        found = tuple(given) if all(isinstance(g, float) for g in given) else None
    else:
        found = literal(value)
        kind = "int" if isinstance(found, int) else "Real"
    if found is None:
        raise Outside(
            file, node, "a constant is a number, reals in a tuple, by_type(...), Status(...) or Code(...)"
        )
    return Constant(file, node.lineno, name, kind, found, tuple(node.lead), node.trail)  # type: ignore[attr-defined]


def literal(node: ast.expr) -> Any:
    """Return the number or text of an expression of literals, or None."""
    match node:
        case ast.Constant(value=int() | float() | str() as value) if not isinstance(value, bool):
            return value
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            inner = literal(operand)
            return None if inner is None or isinstance(inner, str) else -inner
        case ast.BinOp(left=left, op=ast.Div() | ast.Mult() as op, right=right):
            a, b = literal(left), literal(right)
            if isinstance(a, float) and isinstance(b, float):
                return a / b if isinstance(op, ast.Div) else a * b
    return None


def exact(text: str) -> Fraction:
    """Return a coefficient: a decimal number or a quotient of such numbers."""
    above, _, below = text.replace(" ", "").partition("/")
    return Fraction(above) / Fraction(below or "1")


def _comments(text: str) -> dict[int, tuple[str, bool]]:
    """Return for each line its comment, and whether it stands alone."""
    found = {}
    for number, line in enumerate(text.splitlines(), 1):
        code, mark, note = line.partition("#")  # no text of a kernel has this sign
        if mark and not note.startswith((" type:", " fmt:", " noqa")):
            found[number] = (note.partition("  # ")[0].strip(), not code.strip())
    return found


def attach(body: list[ast.stmt], notes: dict[int, tuple[str, bool]], after: int) -> int:
    """Attach comments to definitions and members of records: `lead` before, `trail` beside; return the last
    line that was read.  Comments inside functions are for readers of the kernels alone."""
    for node in body:
        first = min([node.lineno, *(d.lineno for d in getattr(node, "decorator_list", []))])
        node.lead = [notes[n][0] for n in range(after + 1, first) if n in notes]  # type: ignore[attr-defined]
        if isinstance(node, ast.FunctionDef):
            store_types(node.body)
            after = node.end_lineno or node.lineno
            continue
        inner = getattr(node, "body", None)
        last = inner[0].lineno - 1 if inner else (node.end_lineno or node.lineno)
        beside = [n for n in range(node.lineno, last + 1) if n in notes and not notes[n][1]]
        node.trail = " ".join(notes[n][0] for n in beside)  # type: ignore[attr-defined]
        after = max([node.lineno, *beside])
        for block in (inner or [], getattr(node, "orelse", [])):
            after = attach(block, notes, after)
        after = max(after, node.end_lineno or 0)
    return after


def store_types(body: list[ast.stmt]) -> None:
    """Make `count: Count = 0` inside a function an assignment that stores its type."""
    for k, node in enumerate(body):
        match node:
            case ast.AnnAssign(target=ast.Name() as name, value=ast.expr() as value):
                body[k] = ast.copy_location(ast.Assign([name], value), node)
                body[k].annotation = ast.unparse(node.annotation)  # type: ignore[attr-defined]
        for block in (getattr(node, "body", []), getattr(node, "orelse", [])):
            store_types(block)


# -- questions about syntax trees --


def identifier(node: ast.expr) -> str:
    """Return the identifier of an expression that is a name; else an empty text."""
    return node.id if isinstance(node, ast.Name) else ""


def root(node: ast.expr) -> str:
    """Return the name that an entry or a member belongs to."""
    while isinstance(node, ast.Subscript | ast.Attribute):
        node = node.value
    return identifier(node)


def roots(node: ast.expr) -> set[str]:
    """Return the names that an array expression is part of."""
    if isinstance(node, ast.IfExp):
        return roots(node.body) | roots(node.orelse)
    return {root(node)} - {""}


def targets(body: list[ast.stmt]) -> set[str]:
    """Return the names that statements assign."""
    return _names(body, ast.Store)


def loaded(body: list[ast.stmt]) -> set[str]:
    """Return the names that statements read."""
    return _names(body, ast.Load)


def _names(body: list[ast.stmt], how: type[ast.expr_context]) -> set[str]:
    return {n.id for s in body for n in ast.walk(s) if isinstance(n, ast.Name) and isinstance(n.ctx, how)}


def returns(body: list[ast.stmt]) -> bool:
    """Return whether the end of a block is never reached."""
    if not body:
        return False
    last = body[-1]
    if isinstance(last, ast.If):
        return returns(last.body) and returns(last.orelse)
    if isinstance(last, ast.While) and isinstance(last.test, ast.Constant):
        return not any(isinstance(n, ast.Break) for s in last.body for n in _without_inner_loops(s))
    return isinstance(last, ast.Return)


def _without_inner_loops(node: ast.stmt) -> list[ast.AST]:
    """Return the nodes of a statement without those of inner loops."""
    if isinstance(node, ast.For | ast.While):
        return []
    found: list[ast.AST] = [node]
    for inner in (*getattr(node, "body", ()), *getattr(node, "orelse", ())):
        found += _without_inner_loops(inner)
    return found


# Python has one node for each of these: other programs of the process, as IPython, leave attributes in them.
_SHARED = ast.expr_context | ast.boolop | ast.operator | ast.unaryop | ast.cmpop


def clone(node: Any) -> Any:
    """Copy a tree with its comments; five times as fast as copy.deepcopy."""
    if isinstance(node, list):
        return [clone(n) for n in node]
    if not isinstance(node, ast.AST) or isinstance(node, _SHARED):
        return node
    found = node.__class__.__new__(node.__class__)
    for name, value in node.__dict__.items():
        found.__dict__[name] = clone(value) if isinstance(value, ast.AST | list) else value
    return found
