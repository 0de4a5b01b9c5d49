"""Kernels as Python for any size: loops over the entries of vectors as comprehensions and `zip`."""

from __future__ import annotations

import ast
from collections import Counter
from collections.abc import Mapping, Sequence

from lagc.render.kernels.syntax import clone
from lagc.render.kernels.typed import REAL, Type, Types

HELPERS = '''\
from math import copysign, fabs, floor, inf, nan, pow, sqrt


def quotient(a, b):
    """a / b as the arithmetic of the machine has it."""
    if b != 0.0:
        return a / b
    return nan if a == 0.0 or a != a else copysign(inf, a) * copysign(1.0, b)
'''


def function(types: Types) -> str:
    zipped = Zipped(types)
    body = zipped.block([clone(s) for s in types.body])
    hoisted, body = _hoisted(types, body)
    lines = [f"# {line}" for line in types.function.lead]
    lines.append(f"def {types.name}({', '.join(types.parameters)}):")
    if types.function.doc:
        doc = types.function.doc.splitlines()
        inner = ["    " + line if line else "" for line in doc[1:]]
        lines += [f'    """{doc[0]}' + ('"""' if not inner else ""), *inner[:-1]]
        lines += [inner[-1] + '"""'] if inner else []
    lines += ["    " + line for line in hoisted]
    _block(body, "    ", lines)
    return "\n".join(lines) + "\n"


def record(name: str, doc: str, members: Sequence[tuple[str, Type]]) -> str:
    slots = "".join(f'"{m}", ' for m, _ in members)
    lines = [f"class {name}:", f'    """{doc.splitlines()[0] if doc else name}"""', "", f"    __slots__ = ({slots.rstrip()})",
             "", "    def __init__(self):"]  # fmt: skip
    lines += [f"        self.{m} = {zero(kind)}" for m, kind in members]
    return "\n".join(lines) + "\n"


def zero(kind: Type) -> str:
    if kind[0] in ("Vec", "IVec"):
        return f"[{'0.0' if kind[0] == 'Vec' else '0'}] * {kind[1]}"
    if kind[0] == "Mat":
        return f"[[0.0] * {kind[2]} for _ in range({kind[1]})]"
    if kind[0] == "Params":
        return "[0.0] * NP"
    return "0.0" if kind == REAL else "False" if kind == ("bool",) else "0"


def _block(body: Sequence[ast.stmt], indent: str, out: list[str]) -> None:
    start = len(out)
    for node in body:
        out += [f"{indent}# {line}" for line in getattr(node, "lead", ())]
        here = len(out)
        if isinstance(node, ast.If):
            out.append(f"{indent}if {ast.unparse(node.test)}:")
            _block(node.body, indent + "    ", out)
            if node.orelse:
                out.append(f"{indent}else:")
                _block(node.orelse, indent + "    ", out)
        elif isinstance(node, ast.For | ast.While):
            head = f"for {ast.unparse(node.target)} in {ast.unparse(node.iter)}:" if isinstance(node, ast.For) else ""
            out.append(indent + (head or f"while {ast.unparse(node.test)}:"))  # type: ignore[attr-defined]
            _block(node.body, indent + "    ", out)
        else:
            out.append(indent + ast.unparse(node))
        if getattr(node, "trail", ""):
            out[here] += f"  # {node.trail}"  # type: ignore[attr-defined]
    if len(out) == start:
        out.append(indent + "pass")


class Zipped(ast.NodeTransformer):
    """for i in range(n): a[i] = f(b[i], c[i])  ->  a[:n] = [f(b_, c_) for b_, c_ in zip(b[:n], c)];
    loops that only read at [i] run over zip too.  Nothing changes what is computed, nor its order."""

    def __init__(self, types: Types):
        self.types = types

    def block(self, body: list[ast.stmt]) -> list[ast.stmt]:
        return [self.visit(node) for node in body]

    def visit_If(self, node: ast.If) -> ast.stmt:
        self.generic_visit(node.test)
        node.test = self.visit(node.test)
        node.body, node.orelse = self.block(node.body), self.block(node.orelse)
        return node

    def visit_While(self, node: ast.While) -> ast.stmt:
        node.test, node.body = self.visit(node.test), self.block(node.body)
        return node

    def visit_Call(self, node: ast.Call) -> ast.expr:
        self.generic_visit(node)
        name = node.func.id if isinstance(node.func, ast.Name) else ""
        if name in ("vector", "indices"):
            return ast.BinOp(ast.List([ast.Constant(0.0 if name == "vector" else 0)], ast.Load()), ast.Mult(), node.args[0])
        if name == "params":
            return ast.parse("[0.0] * NP", mode="eval").body
        if name == "size":
            return node.args[0]
        if name == "part":
            return ast.Subscript(node.args[0], ast.Slice(*node.args[1:]), ast.Load())
        if name == "present":
            return ast.Compare(node.args[0], [ast.IsNot()], [ast.Constant(None)])
        return node

    def visit_For(self, node: ast.For) -> ast.stmt:
        node.body = self.block(node.body)
        assert isinstance(node.iter, ast.Call) and isinstance(node.target, ast.Name)
        i, ends = node.target.id, node.iter.args
        found = self.zipped(node, i, ends[0]) if len(ends) == 1 else None
        if found is not None:
            found.lead, found.trail = node.lead, node.trail  # type: ignore[attr-defined]
        return found or node

    def zipped(self, node: ast.For, i: str, end: ast.expr) -> ast.stmt | None:
        inner = [n for s in node.body for n in ast.walk(s)]
        stores = [n for n in inner if isinstance(n, ast.Subscript) and isinstance(n.ctx, ast.Store)]
        if any(isinstance(n, ast.Call) and getattr(n.func, "id", "") in self.types.calls for n in inner):
            return None
        if any(isinstance(n, ast.Attribute) and isinstance(n.ctx, ast.Store) for n in inner):
            return None
        only = node.body[0] if len(node.body) == 1 and isinstance(node.body[0], ast.Assign) else None
        mapped = only is not None and stores == only.targets and ast.unparse(stores[0].slice) == i
        if stores and not mapped:
            return None
        assigned = {n.id for n in inner if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)} | {i}
        entries = _Entries(i, assigned)
        limit = ast.unparse(end)
        if mapped:
            assert only is not None
            target = ast.unparse(stores[0].value)
            cut = "[:]" if _length(stores[0].value) == limit else f"[:{limit}]"
            value = entries.visit(clone(only.value))
            if _mentions(value, i) or i in target:
                return None
            if not entries.found:
                whole = ast.unparse(value) if _simple(value) else None
                return ast.parse(f"{target}{cut} = [{whole}] * {limit}").body[0] if whole else None
            return ast.parse(f"{target}{cut} = [{ast.unparse(value)} {entries.loop(limit)}]").body[0]
        body = [entries.visit(clone(s)) for s in node.body]
        if not entries.found or any(_mentions(s, i) for s in body):
            return None
        found = ast.parse(f"{entries.loop(limit)}: pass").body[0]
        found.body = body  # type: ignore[attr-defined]
        return found


class _Entries(ast.NodeTransformer):
    """b[i] -> a name of its own, for vectors that the loop does not bind anew."""

    def __init__(self, i: str, assigned: set[str]):
        self.i, self.assigned, self.found = i, assigned, dict[str, str]()
        self.lengths: set[str] = set()

    def visit_Subscript(self, node: ast.Subscript) -> ast.expr:
        if isinstance(node.slice, ast.Name) and node.slice.id == self.i and isinstance(node.ctx, ast.Load):
            if not {n.id for n in ast.walk(node.value) if isinstance(n, ast.Name)} & self.assigned:
                text = ast.unparse(node.value)
                self.lengths.add(_length(node.value))
                return ast.Name(self.found.setdefault(text, f"_{len(self.found)}"), ast.Load())
        return self.generic_visit(node)  # type: ignore[return-value]

    def loop(self, limit: str) -> str:
        lists = list(self.found)
        first = lists[0] if limit in self.lengths else f"{lists[0]}[:{limit}]"
        if len(lists) == 1:
            return f"for {self.found[lists[0]]} in {first}"
        return f"for {', '.join(self.found.values())} in zip({', '.join([first, *lists[1:]])})"


def _length(node: ast.expr) -> str:
    """The size that a vector has by its type."""
    kind: Type = getattr(node, "type", ("",))
    return kind[1] if kind[0] in ("Vec", "IVec") else ""


def _mentions(node: ast.AST, name: str) -> bool:
    return any(isinstance(n, ast.Name) and n.id == name for n in ast.walk(node))


def _simple(node: ast.expr) -> bool:
    """Whether it costs nothing and stays the same along a loop."""
    return isinstance(node, ast.Constant | ast.Name) or (isinstance(node, ast.UnaryOp) and _simple(node.operand))


def _hoisted(types: Types, body: list[ast.stmt]) -> tuple[list[str], list[ast.stmt]]:
    """Arrays of records, and their rows of known number, that are used more than once, as locals: they
    are never bound anew."""
    finder = _Arrays(types)
    for s in body:
        finder.visit(s)
    taken = {n.id for s in body for n in ast.walk(s) if isinstance(n, ast.Name)} | set(types.parameters)
    names: dict[str, str] = {}
    for text, count in finder.found.items():
        name = text.replace(".", "_").replace("[", "").replace("]", "")
        if count > 1 and name not in taken:
            names[text] = name
    replace = _Replace(names)
    return [f"{name} = {text}" for text, name in names.items()], [replace.visit(s) for s in body]


class _Arrays(ast.NodeVisitor):
    def __init__(self, types: Types):
        self.types, self.found = types, Counter[str]()

    def kind(self, node: ast.expr) -> str:
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            owner = self.types.parameters.get(node.value.id, ("",))
            if owner[0] == "Record":
                return self.types.known.members(owner[1])[node.attr][0]
        return ""

    def visit_Attribute(self, node: ast.Attribute) -> None:
        if self.kind(node) in ("Vec", "IVec", "Mat"):
            self.found[ast.unparse(node)] += 1

    def visit_Subscript(self, node: ast.Subscript) -> None:
        if self.kind(node.value) == "Mat" and isinstance(node.slice, ast.Constant):
            self.found[ast.unparse(node)] += 1
        else:
            self.generic_visit(node)


class _Replace(ast.NodeTransformer):
    def __init__(self, names: Mapping[str, str]):
        self.names = names

    def visit_Attribute(self, node: ast.Attribute) -> ast.expr:
        name = self.names.get(ast.unparse(node))
        return ast.Name(name, ast.Load()) if name else node

    def visit_Subscript(self, node: ast.Subscript) -> ast.expr:
        known = isinstance(node.slice, ast.Constant) and isinstance(node.value, ast.Attribute)
        name = self.names.get(ast.unparse(node)) if known else None
        return ast.Name(name, ast.Load()) if name else self.generic_visit(node)  # type: ignore[return-value]

