"""Specialization: decide compile-time flags, and unroll loops over known values.

A flag is `N > 0` for a size N, or a name in FLAGS. A kernel is specialized for the flags of a model; which
of them it reads decides for which other models it is the same.
"""

from __future__ import annotations

import ast
from collections.abc import Mapping
from copy import copy
from fractions import Fraction
from typing import Any, TypeVar

from lagc.codegen.kernel_compiler.kernel_syntax import Outside, clone, exact, identifier
from lagc.codegen.kernel_compiler.pruning import Pruning

FLAGS = ("STRAIGHT", "HAS_DISPLACE", "COMPLETE")
# Sizes and kernels that are another one in models without a size: name -> (that size, the other name).
SAME_WITHOUT = {
    "NINT": ("NDISC", "NX"), "rates_at": ("NCON", "motion_at"),
    "motion_at": ("NLOADED", "rhs_at"), "put_on_constraints": ("NCON", "project"),
    "pass_event": ("NCON", "handle_event"),
}  # fmt: skip
Flags = Mapping[str, bool]
N = TypeVar("N", bound=ast.AST)


class NotStatic(Exception):
    """An expression without a value before the model is known."""


def tested(node: ast.expr, sizes: frozenset[str]) -> str | None:
    """Return the flag that a condition is, or None."""
    match node:
        case ast.Name(id=name) if name in FLAGS:
            return name
        case ast.Compare(left=ast.Name(id=name), ops=[ast.Gt()], comparators=[ast.Constant(value=0)]):
            return name if name in sizes else None
    return None


class Statics:
    """The specialization of one kernel. `known`: names of known numbers, texts, tuples, dictionaries (rows of
    tableaus), and objects with such attributes (methods). `sizes`: names of sizes. `prefix`: prefix of the
    kernels `own`, for a file that is printed several times."""

    def __init__(self, file: str, flags: Flags, sizes: frozenset[str], known: Mapping[str, Any],
                 pruning: Pruning, prefix: str = "", own: frozenset[str] = frozenset()):  # fmt: skip
        self.file, self.flags, self.sizes, self.known = file, flags, sizes, known
        self.pruning, self.prefix, self.own = pruning, prefix, own

    def block(self, body: list[ast.stmt]) -> list[ast.stmt]:
        """Return the remaining statements, as copies."""
        out: list[ast.stmt] = []
        # Statements behind a return are dropped: a flag may end the kernel early.
        for node in body:
            out += self.statement(node)
            if out and isinstance(out[-1], ast.Return | ast.Break | ast.Continue):
                break  # the rest is not reached
        return out

    def statement(self, node: ast.stmt) -> list[ast.stmt]:
        if isinstance(node, ast.If):
            return self.branch(node)
        match node:
            case ast.For(target=ast.Name(id=name), iter=ast.Call(func=ast.Name(id="static"), args=[values])):
                out = []
                for value in self.value(values, node):
                    inner = copy(self)
                    inner.known = {**self.known, name: value}
                    out += inner.block(node.body)
                return out
        found = self.parts(node)
        # A call that became a number or nothing, and a loop without a body.
        is_idle = isinstance(found, ast.Expr) and not isinstance(found.value, ast.Call)
        return [] if is_idle or (isinstance(found, ast.For) and not found.body) else [found]

    def branch(self, node: ast.If) -> list[ast.stmt]:
        # A known test leaves one of its blocks; else both are specialized, and a block that became empty
        # turns the test.
        test = self.test(node.test)
        if isinstance(test, bool):
            return self.block(node.body if test else node.orelse)
        found = _bare(node)
        found.test, found.body, found.orelse = test, self.block(node.body), self.block(node.orelse)
        return self.pruning.choice(found)

    def test(self, node: ast.expr) -> ast.expr | bool:
        """Return a condition, or its value if it is known; known operands of `and` and `or` are dropped."""
        # Known operands of `and` and `or` decide the test or drop out; the only method needs no test.
        known = self.flag(node)
        if known is not None:
            return known
        if isinstance(node, ast.Call) and identifier(node.func) == "is_method":
            number, method = node.args
            if len(self.carried(self.known["METHODS"])) == 1:
                return True
            equal = ast.Compare(number, [ast.Eq()], [ast.Attribute(method, "NUMBER", ast.Load())])
            return self.expression(ast.copy_location(equal, node))
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not):
            inner = self.test(node.operand)
            if isinstance(inner, bool):
                return not inner
            return ast.copy_location(ast.UnaryOp(ast.Not(), inner), node)
        if isinstance(node, ast.BoolOp):
            absorbing, left = isinstance(node.op, ast.Or), list[ast.expr]()
            for part in node.values:
                value = self.test(part)
                if value is absorbing:
                    if not any(map(self.pruning.is_acting, left)):
                        return absorbing
                    left.append(ast.copy_location(ast.Constant(value), node))
                    break
                if not isinstance(value, bool):
                    left.append(value)
            if not left:
                return not absorbing
            return left[0] if len(left) == 1 else ast.copy_location(ast.BoolOp(node.op, left), node)
        try:
            return bool(self.static(node))
        except NotStatic:
            pass
        found = self.expression(node)
        match found:
            case ast.Constant(value=bool() as value):
                return value
            case ast.Compare(left=ast.Constant(value=a), ops=[op], comparators=[ast.Constant(value=b)]):
                return bool(_COMPARISONS[type(op)](a, b))
        return found

    def flag(self, node: ast.expr) -> bool | None:
        name = tested(node, self.sizes)
        return None if name is None else self.flags[name]

    # -- expressions --

    def expression(self, node: ast.expr) -> ast.expr:
        # Kernels that are another one without some size.
        if isinstance(node, ast.Name) and node.id in SAME_WITHOUT:
            flag, other = SAME_WITHOUT[node.id]
            if not self.flags[flag]:
                return self.expression(ast.copy_location(ast.Name(other, ast.Load()), node))
        # Then words of tableaus: a known test, a combination, a number, a kernel or constant of a method.
        if isinstance(node, ast.BoolOp) or (isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not)):
            test = self.test(node)
            return ast.copy_location(ast.Constant(test), node) if isinstance(test, bool) else test
        if isinstance(node, ast.IfExp):
            test = self.test(node.test)
            if isinstance(test, bool):
                return self.expression(node.body if test else node.orelse)
        elif isinstance(node, ast.Call) and identifier(node.func) == "combination":
            return self.combination(node)
        elif isinstance(node, ast.Call) and identifier(node.func) == "number":
            return _number(exact(self.value(node.args[0], node)), node)
        elif identifier(node) in self.own:
            return ast.copy_location(ast.Name(self.prefix + identifier(node), ast.Load()), node)
        elif isinstance(node, ast.Attribute) and identifier(node.value) in self.known:
            owner = self.known[identifier(node.value)]
            value = getattr(owner, node.attr, None)
            if isinstance(value, int | Fraction):
                return _number(value, node)
            if isinstance(value, ast.Name):  # of a constant
                return ast.copy_location(ast.Name(value.id, ast.Load()), node)
            kernel = ast.Name(f"{owner.NAME}_{node.attr}", ast.Load())
            return ast.copy_location(kernel, node)
        # Arithmetic of known names is done here and now.
        elif any(isinstance(n, ast.Name) and n.id in self.known and isinstance(n.ctx, ast.Load)
                 for n in ast.walk(node)):  # fmt: skip
            try:
                value = self.static(node)
            except NotStatic:
                pass
            else:
                if isinstance(value, int | Fraction):
                    return _number(value, node)
        # All else is copied with its parts specialised.
        found = self.parts(node)
        return self.pruning.call(found) if isinstance(found, ast.Call) else found

    def parts(self, node: N) -> N:
        """Return a copy with specialised parts."""
        found = _bare(node)
        for name, value in ast.iter_fields(node):
            if name in ("body", "orelse") and isinstance(value, list):
                setattr(found, name, self.block(value))
            elif isinstance(value, ast.expr):
                setattr(found, name, self.expression(value))
            elif isinstance(value, list) and value and isinstance(value[0], ast.expr):
                setattr(found, name, [self.expression(v) for v in value])
        return found

    def combination(self, node: ast.Call) -> ast.expr:
        """Return c_1 * k[0][i] + c_2 * k[1][i] ..., from left to right, without zeros."""
        # Coefficients of 1 and -1 are no products, zeros no terms: the text has as few operations as a
        # tableau allows.
        row, (k, i) = self.value(node.args[0], node), (self.expression(a) for a in node.args[1:])
        total: ast.expr | None = None
        for stage, text in row.items():
            value = exact(text)
            entry = ast.Subscript(
                ast.Subscript(clone(k), ast.Constant(stage - 1), ast.Load()), clone(i), ast.Load()
            )
            term: ast.expr = entry
            if abs(value) != 1 or (total is None and value < 0):
                term = ast.BinOp(_number(value if total is None else abs(value), node), ast.Mult(), entry)
            total = term if total is None else ast.BinOp(total, ast.Sub() if value < 0 else ast.Add(), term)
        if total is None:
            raise Outside(self.file, node, "a combination of nothing")
        for n in ast.walk(total):
            ast.copy_location(n, node)
        return total

    def carried(self, methods: tuple[Any, ...]) -> tuple[Any, ...]:
        """Return the methods that a model carries."""
        return tuple([m for m in methods if self.flags[m.NAME.upper()]])

    def value(self, node: ast.expr, where: ast.AST) -> Any:
        try:
            return self.static(node)
        except NotStatic:
            raise Outside(self.file, where, f"not known when printed: {ast.unparse(node)}") from None

    def static(self, node: ast.expr) -> Any:
        """Return the value of an expression of known names and literals. Raises NotStatic if it has none."""
        match node:
            case ast.Constant(value=int() | str() as value) if not isinstance(value, bool):
                return value
            case ast.Name(id="METHODS") if "METHODS" in self.known:
                return self.carried(self.known["METHODS"])
            case ast.Name(id=name) if name in self.known:
                return self.known[name]
            case ast.Attribute(value=value, attr=attr):
                found = getattr(self.static(value), attr, None)
                if found is not None:
                    return found
            case ast.Subscript(value=value, slice=index):
                return self.static(value)[self.static(index)]
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                return -self.static(operand)
            case ast.BinOp(left=left, op=op, right=right) if type(op) in _ARITHMETIC:
                return _ARITHMETIC[type(op)](self.static(left), self.static(right))
            case ast.Compare(left=left, ops=[op], comparators=[right]) if type(op) in _COMPARISONS:
                return _COMPARISONS[type(op)](self.static(left), self.static(right))
            case ast.Call(func=ast.Name(id="range" | "len" as name), args=args):
                return {"range": range, "len": len}[name](*(self.static(a) for a in args))  # type: ignore[operator]
        raise NotStatic


_ARITHMETIC: dict[type, Any] = {
    ast.Add: lambda a, b: a + b, ast.Sub: lambda a, b: a - b, ast.Mult: lambda a, b: a * b,
    ast.Mod: lambda a, b: a % b, ast.FloorDiv: lambda a, b: a // b,
}  # fmt: skip
_COMPARISONS: dict[type, Any] = {
    ast.Eq: lambda a, b: a == b, ast.NotEq: lambda a, b: a != b, ast.Lt: lambda a, b: a < b,
    ast.Gt: lambda a, b: a > b, ast.LtE: lambda a, b: a <= b, ast.GtE: lambda a, b: a >= b,
}  # fmt: skip


def _bare(node: N) -> N:
    """Return a copy that shares the children of the original."""
    found = node.__class__.__new__(node.__class__)
    found.__dict__.update(node.__dict__)
    return found


def _number(value: int | Fraction, node: ast.AST) -> ast.expr:
    found = ast.copy_location(ast.Constant(value if isinstance(value, int) else float(value)), node)
    found.exact = value  # type: ignore[attr-defined]
    return found
