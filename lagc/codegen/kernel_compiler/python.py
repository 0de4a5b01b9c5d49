"""Print kernels as Python for any size. They are Python already: a few words are replaced."""

from __future__ import annotations

import ast

from lagc.codegen.kernel_compiler.kernel_syntax import clone
from lagc.codegen.kernel_compiler.type_check import Types

# Functions of Python that return what C does, also where those of the same name raise.
CAREFUL = {"sqrt": "root", "whole": "int"}


def function(types: Types) -> str:
    """Return the text of a kernel."""
    body = [Words(types).visit(clone(statement)) for statement in types.body]
    doc = [ast.Expr(ast.Constant(types.function.doc))] if types.function.doc else []
    arguments = ast.arguments([], [ast.arg(name) for name in types.parameters], None, [], [], None, [])
    found = ast.FunctionDef(types.name, arguments, [*doc, *body] or [ast.Pass()], [], None, None)
    return ast.unparse(ast.fix_missing_locations(found)) + "\n"


class Words(ast.NodeTransformer):
    """Replaces the words of the kernel language. Division that might raise becomes a call of `quotient`."""

    def __init__(self, types: Types):
        self.constants = types.known.constants

    def visit_Call(self, node: ast.Call) -> ast.expr:
        self.generic_visit(node)
        arguments, load = node.args, ast.Load()
        match node.func:
            case ast.Name(id="vector" | "indices" | "params" as name):
                zero = ast.Constant(0 if name == "indices" else 0.0)
                size = arguments[0] if arguments else ast.Name("NALL", load)
                return ast.BinOp(ast.List([zero], load), ast.Mult(), size)
            case ast.Name(id="size"):
                return arguments[0]
            case ast.Name(id="part"):
                return ast.Subscript(arguments[0], ast.Slice(*arguments[1:]), load)
            case ast.Name(id="present"):
                return ast.Compare(arguments[0], [ast.IsNot()], [ast.Constant(None)])
            case ast.Name(id=name) if name in CAREFUL:
                node.func = ast.Name(CAREFUL[name], load)
        return node

    def visit_For(self, node: ast.For) -> ast.stmt:
        self.generic_visit(node)
        node.body = node.body or [ast.Pass()]
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
        return ast.Assign([node.target], self.visit_BinOp(ast.BinOp(before, node.op, node.value)))

    def is_number(self, node: ast.expr) -> bool:
        """Return whether a divisor is a number of the text, or a constant of kernels: these are not 0."""
        if isinstance(node, ast.BinOp):
            return self.is_number(node.left) and self.is_number(node.right)
        constant = isinstance(node, ast.Name) and node.id in self.constants
        return constant or (isinstance(node, ast.Constant) and node.value != 0.0)
