"""Formulas in LaTeX: `l \\ddot{\\theta} + g \\sin\\theta = 0`."""

from __future__ import annotations

import re

from lagc.expr.graph import Node
from lagc.expr.operators import INFIX, spelling
from lagc.mechanics.equations import EquationsOfMotion
from lagc.view.algebra import TABLE
from lagc.view.formulas import Sheet, by_kind, sheet
from lagc.view.polynomials import Exponent
from lagc.view.text import TextWriter

_GREEK = """
    alpha beta gamma delta epsilon zeta eta theta iota kappa lambda mu nu xi pi rho sigma tau upsilon
    phi chi psi omega Gamma Delta Theta Lambda Xi Pi Sigma Upsilon Phi Psi Omega
"""
GREEK = frozenset(_GREEK.split())
WORDS = spelling("latex")
DOTS = ("", r"\dot", r"\ddot")


def equations_latex(equations: EquationsOfMotion) -> str:
    """For a notebook: the equations as one displayed block, some where they are many."""
    return f"$$\n{write_latex(sheet(equations, full=False))}\n$$"


def write_latex(found: Sheet) -> str:
    """One aligned block; the text needs the package amsmath."""
    writer = LatexWriter(found.collector, found.names, bool(found.left_out))
    lines = []
    for kind, formulas in by_kind(found):
        for formula in formulas:
            relation, when = "=", ""
            if formula.condition is not None:
                relation, when = r"\mathrel{:=}", rf" \quad \text{{when }} {writer.sum(formula.condition)}"
            lines.append(f"  {writer.sum(formula.left)} &{relation} {writer.sum(formula.right)}{when}")
        if kind in found.left_out:
            lines.append(rf"  & \ldots \text{{ {_worded(found.left_out[kind])}}}")
    return "\\begin{aligned}\n" + " \\\\\n".join(lines) + "\n\\end{aligned}"


def _worded(text: str) -> str:
    """Text among formulas."""
    return re.sub(r"([_#$%&{}])", r"\\\1", text)


class LatexWriter(TextWriter):
    times = r" \, "
    index = re.compile(r"(?<=[{,])\d+(?=[,}])")

    def series(self, variable: str, first: int, last: int, text: str) -> str:
        return rf"\sum_{{{variable}={first}}}^{{{last}}} {text}"

    def more(self, count: int) -> str:
        return rf" + \ldots \text{{ ({count} more terms)}}"

    def quotient(self, top: str, over: list[str], bottom: str, under: list[str]) -> str:
        above = self.times.join(([top] if top != "1" or not over else []) + over)
        below = self.times.join(([bottom] if bottom != "1" or not under else []) + under)
        return above if below == "1" else rf"\frac{{{_bare(above)}}}{{{_bare(below)}}}"

    def decimal(self, written: str) -> str:
        mantissa, _, power = written.partition("e")
        return rf"{mantissa} \cdot 10^{{{int(power)}}}" if power else mantissa

    def parentheses(self, text: str) -> str:
        return rf"\left({text}\right)"

    def root(self, text: str) -> str:
        return rf"\sqrt{{{text}}}"

    def raised(self, base: str, exponent: Exponent) -> str:
        if exponent == 1:
            return base
        return f"{base}^{{{exponent}}}"

    def symbol(self, node: Node, exponent: Exponent) -> str:
        name = self.named(node)
        record = node.record
        base, order = (record.base, record.order) if name is None else (name.base, name.order)
        if record.turns:
            owner = re.sub(r"\W+", "_", record.owner).strip("_")
            base = f"omega_{owner}_{record.component}"
        return self.raised(letter(base, order), exponent)

    def function(self, op: str, args: list[str], exponent: Exponent) -> str:
        if op == "abs":
            return self.raised(rf"\left|{args[0]}\right|", exponent)
        if op == "floor":
            return self.raised(rf"\left\lfloor {args[0]} \right\rfloor", exponent)
        if op == "pow":
            return self.raised(rf"\left(\left({args[0]}\right)^{{{args[1]}}}\right)", exponent)
        if op in INFIX:
            return rf"\left({args[0]} {WORDS[op]} {args[1]}\right)"
        if op == "not":
            return rf"{WORDS[op]} {args[0]}"
        if op == "select":
            cases = rf"{args[1]} & \text{{if }} {args[0]} \\ {args[2]} & \text{{else}}"
            return rf"\begin{{cases}} {cases} \end{{cases}}"
        whole = exponent.denominator == 1
        word = WORDS.get(op) or _slope(op.removeprefix(TABLE))
        head = self.raised(word, exponent) if whole else word
        short = op in WORDS and len(args) == 1 and _is_short(args[0])
        text = f"{head} {args[0]}" if short else rf"{head}\left({', '.join(args)}\right)"
        return text if whole else self.raised(rf"\left({text}\right)", exponent)


def _slope(name: str) -> str:
    """Of a table: `u''`."""
    base = name.rstrip("'")
    return letter(base) + name[len(base) :]


def letter(name: str, dots: int = 0) -> str:
    """A name with its subscripts and dots: `th[2]` is th_2, `a.bob[3]` is bob_{a,3}."""
    path = name.split(".")
    last, *indices = re.split(r"[\[\],]+", path[-1].rstrip("]"))
    base, subscripts = _base(last)
    subscripts += [_plain(p) for p in path[:-1]] + [_plain(i) for i in indices]
    accent = DOTS[dots] if dots < len(DOTS) else ""
    text = f"{accent}{{{base}}}" if accent else base
    return f"{text}_{{{','.join(subscripts)}}}" if subscripts else text


def _base(word: str) -> tuple[str, list[str]]:
    """`theta1` -> theta, 1;  `lambda_string` -> lambda, string;  `I1` -> I, 1."""
    head, _, tail = word.partition("_")
    match = re.fullmatch(r"([A-Za-z]+?)(\d+)", head)
    subscripts = [match[2]] if match else []
    head = match[1] if match else head
    if tail:
        subscripts += [_plain(word) for word in tail.split("_")]
    if head in GREEK:
        return f"\\{head}", subscripts
    return (head if len(head) == 1 else rf"\mathit{{{_escaped(head)}}}"), subscripts


def _plain(word: str) -> str:
    inner = re.sub(r"[\[\]]+", ",", word).strip(",")
    if re.fullmatch(r"[A-Za-z]|\d+", inner):
        return inner
    return f"\\{inner}" if inner in GREEK else rf"\mathrm{{{_escaped(inner)}}}"


def _escaped(word: str) -> str:
    return word.replace("_", r"\_").replace("'", "")


def _is_short(text: str) -> bool:
    return re.fullmatch(r"\\?[A-Za-z]+(_\{[^{}]*\})?", text) is not None


def _bare(text: str) -> str:
    """Without the parentheses that a fraction makes needless."""
    if not (text.startswith(r"\left(") and text.endswith(r"\right)")):
        return text
    inside = text[len(r"\left(") : -len(r"\right)")]
    return text if r"\right)" in inside and _unbalanced(inside) else inside


def _unbalanced(text: str) -> bool:
    depth = 0
    for piece in re.findall(r"\\left\(|\\right\)", text):
        depth += 1 if piece == r"\left(" else -1
        if depth < 0:
            return True
    return False
