"""What kernels know of a model: sizes, tables, its functions, and the methods, from the files that declare
them."""

from __future__ import annotations

import ast
import importlib
import os
from functools import cache
from typing import Any

from lagc.codegen.kernel_compiler.syntax import Function, folder
from lagc.codegen.kernel_compiler.type_check import Type, parsed


def _tree(name: str) -> ast.Module:
    with open(os.path.join(folder(), f"{name}.py"), encoding="utf-8") as file:
        return ast.parse(file.read())


@cache
def sizes() -> frozenset[str]:
    return frozenset(n.name for n in _tree("language/sizes").body if isinstance(n, ast.ClassDef))


@cache
def tables() -> dict[str, Type]:
    found = {}
    for node in _tree("language/tables").body:
        if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
            found[node.target.id] = parsed(ast.unparse(node.annotation), lambda name: False)
    return found


@cache
def functions() -> dict[str, Function]:
    found = {}
    for node in _tree("language/model").body:
        if isinstance(node, ast.FunctionDef):
            parameters = tuple((a.arg, ast.unparse(a.annotation)) for a in node.args.args if a.annotation)
            found[node.name] = Function(
                "language/model.py", node.lineno, node.name, parameters, "None", "", [], False, ()
            )
    return found


class Method:
    """A method as kernels see it: `tableau` are the names of its file; NAME, and NUMBER, the constant
    that stands for its place."""

    def __init__(self, name: str, number: int, tableau: dict[str, Any], title: str):
        self.NAME, self.number, self.tableau, self.title = name, number, tableau, title
        self.NUMBER = ast.Name(name.upper(), ast.Load())

    def __getattr__(self, name: str) -> Any:
        try:
            return self.tableau[name]
        except KeyError:
            raise AttributeError(name) from None


def method(name: str, number: int) -> Method:
    """The method of `kernels/integrators/tableaus/<name>.py`."""
    module = importlib.import_module(f"lagc.kernels.integrators.tableaus.{name}")
    tableau = {k: v for k, v in vars(module).items() if k.isupper()}
    return Method(name, number, tableau, module.TITLE)
