"""Print kernels as Python for any size, with loops over vectors as comprehensions and `zip`."""

from __future__ import annotations

import ast
from collections import Counter
from collections.abc import Mapping, Sequence

from lagc.codegen.kernel_compiler.kernel_syntax import clone
from lagc.codegen.kernel_compiler.type_check import Type, Types

# Kernels for which functions of Python give the same result.
FASTER = {
    "not_finite": '''\
def not_finite(values, n):
    """Return the index of the first value that is infinite or NaN, or -1."""
    total = sum(values[:n])
    if total - total == 0.0:
        return -1
    for i in range(n):
        if not values[i] - values[i] == 0.0:
            return i
    return -1
'''
}
# Functions of Python that return what C does, also where those of the same name raise.
CAREFUL = {"sqrt": "root", "whole": "int"}
Short = tuple[Sequence[str], ast.expr]  # arguments and result of a kernel


def short(types: Types) -> Short | None:
    """Return arguments and expression of a kernel that is one expression without calls; it replaces its
    calls."""
    match types.body:
        case [ast.Return(value=ast.expr() as value)]:
            if not any(isinstance(n, ast.Call) for n in ast.walk(value)):
                return tuple(types.parameters), value
    return None


def function(types: Types, short: Mapping[str, Short]) -> str:
    """Return the text of a kernel; `short`: kernels that replace their calls."""
    if types.name in FASTER:
        return FASTER[types.name]
    body = _merged(Zipped(types, short).block([clone(s) for s in types.body]))
    hoisted, body = _hoisted(types, body)
    lines = [f"# {line}" for line in types.function.lead]
    lines.append(f"def {types.name}({', '.join(types.parameters)}):")
    if types.function.doc:
        doc = types.function.doc.splitlines()
        inner = ["    " + line if line else "" for line in doc[1:]]
        lines += [f'    """{doc[0]}' + ('"""' if not inner else ""), *inner[:-1]]
        lines += [inner[-1] + '"""'] if inner else []
    count = len(_record_names(types, body))
    _block(body[:count], "    ", lines) if count else None
    lines += ["    " + line for line in hoisted]
    _block(body[count:], "    ", lines)
    return "\n".join(lines) + "\n"


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
            if isinstance(node, ast.For):
                out.append(f"{indent}for {ast.unparse(node.target).strip('()')} in {ast.unparse(node.iter)}:")
            else:
                out.append(f"{indent}while {ast.unparse(node.test)}:")
            _block(node.body, indent + "    ", out)
        else:
            out.append(indent + ast.unparse(node))
        if getattr(node, "trail", ""):
            out[here] += f"  # {node.trail}"  # type: ignore[attr-defined]
    if len(out) == start:
        out.append(indent + "pass")


class Zipped(ast.NodeTransformer):
    """Turns for i in range(n): a[i] = f(b[i], c[i]) into a[:n] = [f(b_, c_) for b_, c_ in zip(b[:n], c)], and
    loops that only read at [i] into loops over zip. The operations and their order stay the same."""

    def __init__(self, types: Types, short: Mapping[str, Short]):
        self.types, self.short = types, short

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
        if name in self.short and all(isinstance(a, ast.Name | ast.Constant) for a in node.args):
            parameters, value = self.short[name]
            return self.visit(_Put(dict(zip(parameters, node.args))).visit(clone(value)))  # type: ignore[no-any-return]
        if name in ("vector", "indices"):
            zero = ast.Constant(0.0 if name == "vector" else 0)
            return ast.BinOp(ast.List([zero], ast.Load()), ast.Mult(), node.args[0])
        if name == "params":
            return ast.parse("[0.0] * NALL", mode="eval").body
        if name == "size":
            return node.args[0]
        if name in CAREFUL:
            node.func = ast.Name(CAREFUL[name], ast.Load())
        if name == "part":
            return ast.Subscript(node.args[0], ast.Slice(*node.args[1:]), ast.Load())
        if name == "present":
            return ast.Compare(node.args[0], [ast.IsNot()], [ast.Constant(None)])
        return node

    def visit_BinOp(self, node: ast.BinOp) -> ast.expr:
        self.generic_visit(node)
        if not isinstance(node.op, ast.Div) or self.is_number(node.right):
            return node
        return ast.Call(ast.Name("quotient", ast.Load()), [node.left, node.right], [])

    def visit_AugAssign(self, node: ast.AugAssign) -> ast.stmt:
        self.generic_visit(node)
        if not isinstance(node.op, ast.Div) or self.is_number(node.value):
            return node
        before = ast.parse(ast.unparse(node.target), mode="eval").body
        value = self.visit_BinOp(ast.BinOp(before, node.op, node.value))
        found = ast.copy_location(ast.Assign([node.target], value), node)
        found.lead, found.trail = node.lead, node.trail  # type: ignore[attr-defined]
        return found

    def is_number(self, node: ast.expr) -> bool:
        """Return whether a divisor is a number of the text, or a constant of kernels."""
        if isinstance(node, ast.BinOp):
            return self.is_number(node.left) and self.is_number(node.right)
        constant = isinstance(node, ast.Name) and node.id in self.types.known.constants
        return constant or (isinstance(node, ast.Constant) and node.value != 0.0)

    def visit_For(self, node: ast.For) -> ast.stmt:
        node.body = self.block(node.body)
        assert isinstance(node.iter, ast.Call) and isinstance(node.target, ast.Name)
        i, ends = node.target.id, node.iter.args
        calls = any(isinstance(n, ast.Call) for n in ast.walk(ends[0]))
        found = self.zipped(node, i, ends[0]) if len(ends) == 1 and not calls else None
        if found is not None:
            found.lead, found.trail = node.lead, node.trail  # type: ignore[attr-defined]
        return found or node

    def zipped(self, node: ast.For, i: str, end: ast.expr) -> ast.stmt | None:
        inner = [n for s in node.body for n in ast.walk(s)]
        if any(isinstance(n, ast.Call) and getattr(n.func, "id", "") in self.types.calls for n in inner):
            return None
        if any(isinstance(n, ast.Attribute) and isinstance(n.ctx, ast.Store) for n in inner):
            return None
        stores = [n for n in inner if isinstance(n, ast.Subscript) and isinstance(n.ctx, ast.Store)]
        assigned = {n.id for n in inner if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)} | {i}
        return self.mapped(node, i, end, stores) or self.looped(node, i, end, stores, assigned)

    def mapped(self, node: ast.For, i: str, end: ast.expr, stores: list[ast.Subscript]) -> ast.stmt | None:
        """Return the loop as one assignment to a vector."""
        only = node.body[0] if len(node.body) == 1 else None
        if len(stores) != 1 or not isinstance(only, ast.Assign | ast.AugAssign):
            return None
        if ast.unparse(stores[0].slice) != i:
            return None
        array, limit = stores[0].value, ast.unparse(end)
        value = only.value
        if isinstance(only, ast.AugAssign):
            entry = ast.Subscript(clone(array), ast.Name(i, ast.Load()), ast.Load())
            value = ast.BinOp(entry, only.op, value)
        entries = _Entries(node, i, {i}, set())
        value = entries.visit(clone(value))
        target = ast.unparse(array)
        if _mentions(value, i) or _mentions(array, i) or target in map(ast.unparse, _arrays(value)):
            return None
        cut = "[:]" if _length(array) == limit else f"[:{limit}]"
        if entries.found:
            return ast.parse(f"{target}{cut} = [{ast.unparse(value)} {entries.loop(limit)}]").body[0]
        if not _simple(value):
            return None
        times = limit if isinstance(end, ast.Name | ast.Constant) else f"({limit})"
        return ast.parse(f"{target}{cut} = [{ast.unparse(value)}] * {times}").body[0]

    def looped(
        self, node: ast.For, i: str, end: ast.expr, stores: list[ast.Subscript], assigned: set[str]
    ) -> ast.stmt | None:
        """Return the loop over entries of vectors, with its counter if that has other uses."""
        entries = _Entries(node, i, assigned, {ast.unparse(n.value) for n in stores})
        limit, body = ast.unparse(end), [entries.visit(clone(s)) for s in node.body]
        counted = any(_mentions(s, i) for s in body)
        if not entries.found or (counted and entries.uses < 2):
            return None
        found = ast.parse(f"{entries.loop(limit, i if counted else '')}: pass").body[0]
        found.body = body  # type: ignore[attr-defined]
        return found


class _Put(ast.NodeTransformer):
    """Replaces parameters by arguments."""

    def __init__(self, given: Mapping[str, ast.expr]):
        self.given = given

    def visit_Name(self, node: ast.Name) -> ast.expr:
        return self.given.get(node.id, node)


class _Entries(ast.NodeTransformer):
    """Replaces b[i] by a name, for vectors that the loop neither assigns (`assigned`) nor writes to."""

    def __init__(self, loop: ast.For, i: str, assigned: set[str], written: set[str]):
        self.i, self.assigned, self.written, self.found = i, assigned, written, dict[str, str]()
        self.lengths: set[str] = set()
        self.uses = 0
        inner = (n.id[1:] for n in ast.walk(loop) if isinstance(n, ast.Name) and n.id[:1] == "_")
        self.first = 1 + max(map(int, inner), default=-1)  # of the names that inner loops leave

    def visit_Subscript(self, node: ast.Subscript) -> ast.expr:
        if isinstance(node.slice, ast.Name) and node.slice.id == self.i and isinstance(node.ctx, ast.Load):
            text = ast.unparse(node.value)
            names = {n.id for n in ast.walk(node.value) if isinstance(n, ast.Name)}
            if not names & self.assigned and text not in self.written:
                self.uses += 1
                self.lengths.add(_length(node.value))
                return ast.Name(self.found.setdefault(text, f"_{self.first + len(self.found)}"), ast.Load())
        return self.generic_visit(node)  # type: ignore[return-value]

    def loop(self, limit: str, counter: str = "") -> str:
        names, lists = list(self.found.values()), list(self.found)
        if counter:
            names, lists = [counter, *names], [f"range({limit})", *lists]
        elif limit not in self.lengths:
            lists[0] += f"[:{limit}]"
        if len(lists) == 1:
            return f"for {names[0]} in {lists[0]}"
        return f"for {', '.join(names)} in zip({', '.join(lists)})"


def _merged(body: list[ast.stmt]) -> list[ast.stmt]:
    """Merge the declaration of a local vector with the statement that fills it."""
    out: list[ast.stmt] = []
    for node in body:
        for name in ("body", "orelse"):
            if getattr(node, name, None):
                setattr(node, name, _merged(getattr(node, name)))
        made = out[-1] if out else None
        match made, node:
            case (
                ast.Assign(targets=[ast.Name(id=first)], value=ast.BinOp(left=ast.List())),
                ast.Assign([ast.Subscript(ast.Name(id=second), ast.Slice(None, None))], value),
            ) if first == second and not _mentions(value, first):
                fresh = isinstance(value, ast.ListComp | ast.BinOp)
                made.value = value if fresh else ast.parse(f"{ast.unparse(value)}[:]", mode="eval").body
            case _:
                out.append(node)
    return out


def _arrays(node: ast.expr) -> list[ast.expr]:
    """Return the arrays that an expression indexes or passes on."""
    return [n for n in ast.walk(node) if isinstance(n, ast.Name | ast.Attribute | ast.Subscript)]


def _length(node: ast.expr) -> str:
    """Return the size of a vector by its type."""
    kind: Type = getattr(node, "type", ("",))
    return kind[1] if kind[0] in ("Vec", "IVec") else ""


def _mentions(node: ast.AST, name: str) -> bool:
    return any(isinstance(n, ast.Name) and n.id == name for n in ast.walk(node))


def _simple(node: ast.expr) -> bool:
    """Return whether an expression costs nothing and is constant in a loop."""
    plain = isinstance(node, ast.Constant | ast.Name)
    return plain or (isinstance(node, ast.UnaryOp) and _simple(node.operand))


def _record_names(types: Types, body: list[ast.stmt]) -> list[str]:
    """Return the names of records of records that the first statements give."""
    found = list[str]()
    for node in body:
        match node:
            case ast.Assign(targets=[ast.Name(id=name)], value=ast.Attribute()) if (
                types.locals[name][0] == "Record" and types.assigned[name] == 1
            ):
                found.append(name)
            case _:
                break
    return found


def _hoisted(types: Types, body: list[ast.stmt]) -> tuple[list[str], list[ast.stmt]]:
    """Load arrays of records, and their rows with a constant index, into locals if they are used more than
    once; they are never assigned."""
    finder = _Arrays(types, {*types.parameters, *_record_names(types, body)})
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
    """Counts the uses of arrays of the records `roots`, and of the records that these contain."""

    def __init__(self, types: Types, roots: set[str]):
        self.types, self.roots, self.found = types, roots, Counter[str]()

    def kind(self, node: ast.expr) -> str:
        return self.record_or_array(node)[0] if isinstance(node, ast.Attribute) else ""

    def record_or_array(self, node: ast.expr) -> Type:
        if isinstance(node, ast.Name) and node.id in self.roots:
            return {**self.types.locals, **self.types.parameters}[node.id]
        if isinstance(node, ast.Attribute):
            owner = self.record_or_array(node.value)
            if owner[0] == "Record":
                return self.types.known.members(owner[1])[node.attr]
        return ("",)

    def visit_For(self, node: ast.For) -> None:
        self.visit(node.iter)
        for statement in (*node.body, *node.body):  # more than once
            self.visit(statement)

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
