"""Which arguments a kernel changes, in any model: these are not const in C."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping

from lagc.codegen.kernel_compiler.kernel_syntax import Function, identifier, roots
from lagc.codegen.kernel_compiler.specialization import SAME_WITHOUT
from lagc.codegen.kernel_compiler.type_check import Signature
from lagc.kernels import METHODS


def written(function: Function, known: Mapping[str, Signature], prefix: str) -> list[bool]:
    """Return for each parameter whether the kernel, before it is specialised, may change its contents;
    `known`: the kernels before it."""
    touched, parts = set[str](), dict[str, set[str]]()  # parts: name -> names that it may be part of
    for statement in function.body:
        for node in ast.walk(statement):
            if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
                parts.setdefault(node.targets[0].id, set()).update(_bases(node.value))
            elif isinstance(node, ast.Subscript | ast.Attribute) and isinstance(node.ctx, ast.Store):
                touched |= roots(node)
            elif isinstance(node, ast.Call):
                for callee in _callees(node, prefix):
                    if callee in known:
                        for argument, is_written in zip(node.args, known[callee].writes):
                            touched |= roots(argument) if is_written else set()
    more = set(touched)
    while more:
        more = {base for name in more for base in parts.get(name, ())} - touched
        touched |= more
    return [name in touched for name, _ in function.parameters]


def _bases(value: ast.expr) -> set[str]:
    """Return the names that a value may be part of; the result of a call is a number."""
    if isinstance(value, ast.Name | ast.Attribute | ast.Subscript | ast.IfExp):
        return roots(value)
    return set()


def _callees(call: ast.Call, prefix: str) -> Iterator[str]:
    """Return the kernels that a call may mean: those that replace it in some models, those of all methods."""
    if isinstance(call.func, ast.Attribute):
        yield from (f"{method}_{call.func.attr}" for method in METHODS)
    name = identifier(call.func)
    while name:
        yield from (name, prefix + name)
        name = SAME_WITHOUT.get(name, ("", ""))[1]
