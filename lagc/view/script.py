"""Formulas as a Python script that builds the equations with SymPy."""

from __future__ import annotations

import keyword
import re
from collections.abc import Mapping
from math import inf

from lagc.expr.graph import Node
from lagc.expr.operators import TRUTHS, spelling
from lagc.mechanics.equations import EquationsOfMotion
from lagc.view.algebra import TABLE
from lagc.view.collect import Collector
from lagc.view.formulas import Sheet
from lagc.view.names import Name, pi_of
from lagc.view.polynomials import Exponent
from lagc.view.text import TextWriter

WORDS = spelling("sympy")


def write_script(equations: EquationsOfMotion, found: Sheet) -> str:
    """The text of the script: symbols, shared parts, and the list `equations` of sympy.Eq."""
    variables = _variables(equations, found)
    writer = ScriptWriter(found.collector, found.names, variables)
    model = equations.model
    lines = [f"# Equations of motion of {_plain(model.name)}, scene {_plain(model.scene)}, in SI units.", ""]
    lines += ["import sympy", ""]
    lines += ['t = sympy.Symbol("t", real=True)', *_declarations(equations, variables), ""]
    for formula in found.formulas:
        if formula.kind == "shared":
            lines.append(f"{formula.label} = {writer.sum(formula.right)}")
    lines.append("equations = [")
    for formula in found.formulas:
        if formula.kind not in ("shared", "event"):
            sides = f"{writer.sum(formula.left)}, {writer.sum(formula.right)}"
            lines.append(f"    sympy.Eq({sides}),  # {_plain(formula.label)}")
    lines += ["]", "", 'if __name__ == "__main__":']
    lines += ["    for equation in equations:", "        sympy.pprint(equation)"]
    return "\n".join(lines)


def _plain(text: str) -> str:
    """On one line, so that it stays inside a comment."""
    return " ".join(text.split())


def _variables(equations: EquationsOfMotion, found: Sheet) -> dict[str, str]:
    """Full name in the model -> Python identifier."""
    shared = {f.label for f in found.formulas if f.kind == "shared"}
    taken = {"t", "sympy", "equations", "equation"} | shared
    variables = {"pi": "sympy.pi"} if pi_of(equations) is not None else {}
    for node, name in found.names.items():
        if node is equations.time or name.full in variables or name.full in shared:
            continue
        word = re.sub(r"\W+", "_", name.base).strip("_") or "n"
        word = f"n{word}" if word[0].isdigit() else word
        while word in taken or keyword.iskeyword(word):
            word += "_"
        taken.add(word)
        variables[name.full] = word
    return variables


def _declarations(equations: EquationsOfMotion, variables: Mapping[str, str]) -> list[str]:
    model = equations.model
    lines = []
    for p in model.parameters:
        known = "nonnegative=True" if p.minimum >= 0 else "real=True"
        lines.append(_line(variables[p.name], f"sympy.Symbol({p.name!r}, {known})", p.unit, p.description))
    moving = [(i.name, i.unit, i.description) for i in model.inputs]
    moving += [(name, unit, "") for name, unit in zip(equations.q_names, equations.q_units)]
    speeds = [(x.record, unit) for x, unit in zip(equations.v, equations.v_units)]
    moving += [(record.name, unit, "") for record, unit in speeds if record.order == 0]
    moving += [(f"lambda_{row.label}", "", f"multiplier of {row.label}") for row in equations.rows]
    for name, unit, description in moving:
        lines.append(_line(variables[name], f"sympy.Function({name!r}, real=True)(t)", unit, description))
    return lines


def _line(variable: str, value: str, unit: str, description: str) -> str:
    comment = ", ".join(part for part in (unit, _plain(description)) if part)
    return f"{variable} = {value}" + (f"  # {comment}" if comment else "")


class ScriptWriter(TextWriter):
    def __init__(
        self, collector: Collector, names: Mapping[Node, Name], variables: Mapping[str, str]
    ) -> None:
        super().__init__(collector, names)
        self.variables = variables

    def quotient(self, top: str, over: list[str], bottom: str, under: list[str]) -> str:
        if bottom != "1":
            top, bottom = f"sympy.Rational({top}, {bottom})", "1"
        return super().quotient(top, over, bottom, under)

    def decimal(self, written: str) -> str:
        """In quotes where no double is as large or as small."""
        return f"sympy.Float({written})" if 0.0 < float(written) < inf else f"sympy.Float({written!r})"

    def root(self, text: str) -> str:
        return f"sympy.sqrt({text})"

    def raised(self, base: str, exponent: Exponent) -> str:
        if exponent == 1:
            return base
        if exponent.denominator == 1:
            return f"{base}**{exponent}"
        return f"{base}**sympy.Rational({exponent.numerator}, {exponent.denominator})"

    def symbol(self, node: Node, exponent: Exponent) -> str:
        name = self.names.get(node)
        if name is None or name.full == "time":
            return self.raised("t", exponent)
        word = self.variables.get(name.full, name.base)
        if name.order:
            word += ".diff(t)" if name.order == 1 else f".diff(t, {name.order})"
        return self.raised(word, exponent)

    def function(self, op: str, args: list[str], exponent: Exponent) -> str:
        if op == "pow":
            return self.raised(f"(({args[0]})**({args[1]}))", exponent)
        if op == "select":
            return self.raised(f"sympy.Piecewise(({args[1]}, {args[0]}), ({args[2]}, True))", exponent)
        word = WORDS[op] if op in WORDS else f"Function({op.removeprefix(TABLE)!r})"
        text = f"sympy.{word}({', '.join(args)})"
        return text if op in TRUTHS else self.raised(text, exponent)
