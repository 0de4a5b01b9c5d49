"""Pruning: leave out of a specialized kernel what does nothing.

Of many kernels a model with few features needs nothing, a number, or another kernel: calls are replaced by
that. Then go assignments to names that nothing reads, and tests and loops without a body.
"""

import ast
from collections.abc import Callable, Collection
from typing import NamedTuple

from lagc.codegen.kernel_compiler.kernel_syntax import clone, identifier, loaded, root

_NUMBERS = ast.Constant | ast.UnaryOp | ast.BinOp | ast.operator | ast.unaryop
_PLACES = ast.Attribute | ast.Name | ast.expr_context


class Short(NamedTuple):
    """A kernel that needs no function of its own: `value`, in terms of its `parameters`; None: nothing."""

    parameters: tuple[str, ...]
    value: ast.expr | None


def short(parameters: tuple[str, ...], body: list[ast.stmt], constants: Collection[str]) -> Short | None:
    """Return what a kernel with this body needs if that is nothing, a number, or a call of another kernel
    with no more arguments, which are parameters and members of them; else None."""
    *before, last = body or [ast.Return(None)]
    match before if isinstance(last, ast.Return) and last.value is None else body:
        case []:
            return Short(parameters, None)
        case [ast.Return(value=ast.expr() as value) | ast.Expr(value=value)]:
            nodes = list(ast.walk(value))
            number = all(isinstance(n, _NUMBERS) for n in nodes) or identifier(value) in constants
            if number or (isinstance(value, ast.Call) and _passes_on(value, parameters)):
                return Short(parameters, value)
    return None


def _passes_on(call: ast.Call, parameters: tuple[str, ...]) -> bool:
    plain = all(isinstance(n, _PLACES) for a in call.args for n in ast.walk(a))
    return plain and len(call.args) <= len(parameters) and all(root(a) in parameters for a in call.args)


class _Filled(ast.NodeTransformer):
    """Puts arguments in the place of parameters."""

    def __init__(self, arguments: dict[str, ast.expr]):
        self.arguments = arguments

    def visit_Name(self, node: ast.Name) -> ast.expr:
        return clone(self.arguments[node.id]) if node.id in self.arguments else node


class Pruning:
    """The pruning of one kernel. `needs`: what a kernel is short for, or None; `acts`: whether a call of a
    kernel may change what its arguments hold."""

    def __init__(self, needs: Callable[[str], Short | None], acts: Callable[[str], bool]):
        self.needs, self.acts = needs, acts

    def call(self, node: ast.Call) -> ast.expr:
        """Return an expression with the value of a call: the constant None if the call does nothing."""
        found = self.needs(identifier(node.func))
        if found is None or len(found.parameters) != len(node.args):
            return node
        value = ast.Constant(None) if found.value is None else found.value
        # Each argument is evaluated once, as before, unless that has no effect.
        read = [identifier(n) for n in ast.walk(value) if isinstance(n, ast.Name)]
        if any(read.count(n) != 1 and self.is_acting(a) for n, a in zip(found.parameters, node.args)):
            return node
        filled = _Filled(dict(zip(found.parameters, node.args))).visit(clone(value))
        for n in ast.walk(filled):
            ast.copy_location(n, node)
        assert isinstance(filled, ast.expr)
        return filled

    def is_acting(self, node: ast.expr) -> bool:
        """Return whether the evaluation of an expression may change anything."""
        return any(isinstance(n, ast.Call) and self.acts(identifier(n.func)) for n in ast.walk(node))

    def effect(self, node: ast.expr) -> list[ast.stmt]:
        """Return statements with the effect of an expression whose value is not used."""
        if not self.is_acting(node):
            return []
        if isinstance(node, ast.UnaryOp):
            return self.effect(node.operand)
        if isinstance(node, ast.BoolOp):
            first, *rest = node.values
            behind = self.effect(rest[0] if len(rest) == 1 else ast.BoolOp(node.op, rest))
            if behind:
                test = first if isinstance(node.op, ast.And) else ast.UnaryOp(ast.Not(), first)
                return [ast.copy_location(ast.If(test, behind, []), node)]
            return self.effect(first)
        return [ast.copy_location(ast.Expr(node), node)]

    def choice(self, node: ast.If) -> list[ast.stmt]:
        """Return a test, turned if its first block is empty; only its effect if both are."""
        if not node.body:
            if not node.orelse:
                return self.effect(node.test)
            test = ast.copy_location(ast.UnaryOp(ast.Not(), node.test), node.test)
            node.test, node.body, node.orelse = test, node.orelse, []
        return [node]

    def finished(self, body: list[ast.stmt], before: list[ast.stmt]) -> list[ast.stmt]:
        """Return the statements without assignments to names that are read in `before`, but not here."""
        kept = loaded(before)
        while spare := _assigned(body).keys() & kept - loaded(body):
            body = self._without(body, spare)
        return body

    def _without(self, block: list[ast.stmt], spare: set[str]) -> list[ast.stmt]:
        out = list[ast.stmt]()
        for node in block:
            match node:
                case ast.Assign(targets=[ast.Name(id=name)]) | ast.AugAssign(target=ast.Name(id=name)):
                    out += self.effect(node.value) if name in spare else [node]
                case ast.If():
                    node.body, node.orelse = (self._without(b, spare) for b in (node.body, node.orelse))
                    out += self.choice(node)
                case ast.For() | ast.While():
                    node.body = self._without(node.body, spare)
                    out += [node] if node.body or isinstance(node, ast.While) else []
                case _:
                    out.append(node)
        return out


def known_values(body: list[ast.stmt]) -> dict[str, bool]:
    """Return the truth values of names that are assigned once, as constants."""
    found = {}
    for name, values in _assigned(body).items():
        match values:
            case [ast.Constant(value=bool() as value)]:
                found[name] = value
    return found


def _assigned(body: list[ast.stmt]) -> dict[str, list[ast.expr]]:
    """Return the names that statements assign, with their values."""
    found = dict[str, list[ast.expr]]()
    for statement in body:
        for node in ast.walk(statement):
            match node:
                case ast.Assign(targets=[ast.Name(id=name)]) | ast.AugAssign(target=ast.Name(id=name)):
                    found.setdefault(name, []).append(node.value)
    return found
