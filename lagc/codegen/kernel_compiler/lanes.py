"""Print kernels as C over vectors of the compiler, in which each lane belongs to another run.

Truth values are masks: both sides of a choice are computed, and `and` and `or` have no short circuits.
Kernels that test reals in statements have no such form.
"""

from __future__ import annotations

import ast
from collections.abc import Mapping, Sequence

from lagc.base.records import replace
from lagc.codegen.kernel_compiler.c import ATOM, BITS, PRODUCT, CPrinter
from lagc.codegen.kernel_compiler.real_types import DOUBLE
from lagc.codegen.kernel_compiler.type_check import BOOL, COUNT, REAL, STATUS, Type

LANES = "lanes"  # the language


class LanePrinter(CPrinter):
    """Prints `Wide` for reals, `Mask` for truth values and counts, `WideState` for records."""

    def __init__(self, numbers: Mapping[str, str], constants: Mapping[str, str]):
        super().__init__(replace(DOUBLE, name="Wide"), numbers, constants)

    def ctype(self, kind: Type) -> str:
        if kind in (BOOL, COUNT):
            return "Mask "
        if kind == STATUS:
            return "Status "
        return f"Wide{kind[-1]} " if kind[0] in ("Record", "Params") else super().ctype(kind)

    def converted(self, node: ast.expr, wanted: Type) -> str:
        text = super().converted(node, wanted)
        return f"{text} - (Wide){{0}}" if wanted == REAL and isinstance(node, ast.Constant) else text

    def condition(self, node: ast.expr, least: int = 0) -> str:
        return self.operand(node, None, least)

    def expression(self, node: ast.expr) -> tuple[str, int]:
        match node:
            case ast.BoolOp(op=op, values=values):
                sign = " & " if isinstance(op, ast.And) else " | "
                return sign.join(self.operand(value, None, ATOM) for value in values), BITS
            case ast.IfExp(test=test, body=body, orelse=orelse):
                return f"wide_pick({', '.join(self.text(n) for n in (test, body, orelse))})", ATOM
        return super().expression(node)

    def call(self, name: str, args: Sequence[ast.expr]) -> tuple[str, int]:
        if name == "whole":  # its last bits
            return f"(Mask)({self.operand(args[0], None, PRODUCT)} + LAGC_ROUNDER)", ATOM
        callee = self.now.known.signatures[name]
        text, binds = super().call(name, args)
        return text.removeprefix("lagc_") if callee.parameters == (STATUS,) else text, binds
