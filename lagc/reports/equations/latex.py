"""Formulas in LaTeX: `l \\ddot{\\theta} + g \\sin\\theta = 0`."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from lagc.mechanics.formulation.equations import EquationsOfMotion
from lagc.reports.algebra.expansion import TABLE
from lagc.reports.algebra.polynomials import Exponent
from lagc.reports.equations.modes import IMPACTS, modes
from lagc.reports.equations.page import Page, page
from lagc.reports.equations.plain_text import TextWriter
from lagc.reports.names import Names, where
from lagc.reports.patterns.formula_trees import INDEX, Counters, Line, Symbol, filled
from lagc.symbolic.graph import Node
from lagc.symbolic.leaves import Symbol as Leaf
from lagc.symbolic.operators import INFIX, spelling

_GREEK = """
    alpha beta gamma delta epsilon zeta eta theta iota kappa lambda mu nu xi pi rho sigma tau upsilon
    phi chi psi omega Gamma Delta Theta Lambda Xi Pi Sigma Upsilon Phi Psi Omega
"""
GREEK = frozenset(_GREEK.split())
WORDS = spelling("latex")
COUNTED = re.compile(r"(-?(\d+ )?[a-z]|\d+)( [+-] (\d+|(\d+ )?[a-z]))*")  # an index of a rule
VERBATIM = str.maketrans(
    {c: f"\\{c}" for c in "_%#&${}"}
    | {"\\": r"\textbackslash{}", "^": r"\textasciicircum{}", "~": r"\textasciitilde{}", '"': r"\symbol{34}"}
)
DOTS = ("", r"\dot", r"\ddot")


def equations_latex(equations: EquationsOfMotion) -> str:
    """Return the equations as one displayed block for a notebook; of many equations some."""
    return f"$$\n\\begin{{aligned}}\n{_aligned(equations)}\n\\end{{aligned}}\n$$"


def equation_rows(equations: EquationsOfMotion) -> list[str]:
    """Return the rows of `equations_latex`, each a formula of its own."""
    return [row.replace("&", "", 1).strip() for row in _aligned(equations).split(" \\\\\n")]


def _aligned(equations: EquationsOfMotion) -> str:
    rows, _ = _systems([(mode.title, page(mode.equations, False, mode.laws)) for mode in modes(equations)])
    return rows


def write_latex(modes: Sequence[tuple[str, Page]]) -> str:
    """Return the text between \\begin{document} and \\end{document}; it needs the package amsmath."""
    rows, writers = _systems(modes)
    text = f"\\begin{{align*}}\n{rows}\n\\end{{align*}}"
    seen = {name for each in writers for name in each.seen}
    legend = [
        rf"${writers[0].letters(short, short)}$ is \texttt{{{full.translate(VERBATIM)}}}"
        for short, full in where(seen)
    ]
    return text + ("\nwhere " + ",\n".join(legend) if legend else "")


def _systems(modes: Sequence[tuple[str, Page]]) -> tuple[str, list[LatexWriter]]:
    """Return the rows of all modes, with a row for each title, and the writers."""
    blocks, writers = list[str](), list[LatexWriter]()
    for title, found in modes:
        writers.append(LatexWriter(found.names, found.ruled))
        rows = _rows(found, writers[-1])
        blocks.append(
            rf"  & \text{{{title.translate(VERBATIM).replace('`', '')}:}} \\" + f"\n{rows}" if title else rows
        )
    return " \\\\\n".join(blocks), writers


def _rows(found: Page, writer: LatexWriter) -> str:
    lines = []
    for kind, group in found.by_kind():
        if kind in IMPACTS:
            lines.append(r"  & \text{at impacts:}")
        for line in group:
            lines.append(f"  {writer.line(line)}")
    return " \\\\\n".join(lines)


class LatexWriter(TextWriter):
    times = r" \, "
    relations: Mapping[str, str] = {
        "=": "{} &= {}",
        "contact": r"{} &\ge {}",
        "complement": r"0 \le {} &\perp {} \ge 0",
        "bound": r"{} &\le {}",
        "stick": r"{} &\le {} \quad \text{{if }} {} = 0",
        "slip": r"{} &= {} \quad \text{{if }} {} \ne 0",
        "impact": r"{} &\mathrel{{:=}} {}",
        "event": r"{} &\mathrel{{:=}} {} \quad \text{{when }} {}",
    }

    def __init__(self, names: Names, cut: bool = False) -> None:
        super().__init__(names, cut)
        self.literal = alike(names)

    def letters(self, name: str, written: str, dots: int = 0, word: str = "") -> str:
        """A name, `written` with its indices, by the letters of `word` where no other has these."""
        if INDEX.sub("", name) not in self.literal:
            return letter(word or written, dots)
        return _accented(rf"\mathit{{{_escaped(written)}}}", dots)

    def series(self, counter: str, first: str, last: str, text: str) -> str:
        return rf"\sum_{{{counter}={first}}}^{{{last}}} {text}"

    def indexed(self, text: str, symbol: Symbol | Line) -> str:
        """A comma parts indices."""
        return filled(text, [self.number(x).replace(self.times, " ") for x in symbol.indices])

    def counters(self, counters: Counters) -> str:
        """The values that they take."""
        if not counters:
            return ""
        ranges = [rf"{k} = {self.number(a)}, \ldots, {self.number(b)}" for k, a, b in counters]
        return r" \quad \text{for } " + r" \text{ and } ".join(ranges)

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

    def symbol(self, symbol: Symbol, exponent: Exponent) -> str:
        name, record = self.named(symbol.node), symbol.node.record
        base, order = (record.base, record.order) if name is None else (name.base, name.order)
        turning = _turning(record, self.indexed(record.owner, symbol)) if record.is_body_rate else ""
        return self.raised(self.letters(base, self.indexed(base, symbol), order, turning), exponent)

    def slope(self, base: str, primes: str) -> str:
        return self.letters(base, base) + primes

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
        word = self.table(op) if op.startswith(TABLE) else WORDS[op]
        head = self.raised(word, exponent) if whole else word
        short = op in WORDS and len(args) == 1 and _is_short(args[0])
        text = f"{head} {args[0]}" if short else rf"{head}\left({', '.join(args)}\right)"
        return text if whole else self.raised(rf"\left({text}\right)", exponent)


def alike(names: Names) -> set[str]:
    """Return the names, without indices, that would look like another one: all but one, which is an array or
    else the shortest."""
    found: dict[str, set[str]] = {}
    for of, name in names.items():
        record = of.record if isinstance(of, Node) else Leaf("table")
        word = _turning(record, record.owner) if record.is_body_rate else name.base
        found.setdefault(letter(word), set()).add(INDEX.sub("", name.base))
    return {name for same in found.values() for name in sorted(same, key=_unnatural)[1:]}


def _unnatural(name: str) -> tuple[bool, int, str]:
    return "[" not in name, len(name), name


def _turning(record: Leaf, owner: str) -> str:
    """Return the word of a body rate, `omega_top_x`."""
    owner = re.sub(r"[^\w +*-]+", "_", owner).strip("_")
    return f"omega_{owner}_{record.component}"


def letter(name: str, dots: int = 0) -> str:
    """A name with its subscripts and dots: `th[2]` is th_2, `a.bob[3]` is bob_{a,3}."""
    path = name.split(".")
    last, *indices = re.split(r"[\[\],]+", path[-1].rstrip("]"))
    base, subscripts = _base(last)
    subscripts += [_plain(p) for p in path[:-1]] + [_plain(i) for i in indices]
    text = _accented(base, dots)
    return f"{text}_{{{','.join(subscripts)}}}" if subscripts else text


def _accented(text: str, dots: int) -> str:
    accent = DOTS[dots] if dots < len(DOTS) else ""
    return f"{accent}{{{text}}}" if accent else text


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
    if re.fullmatch(r"[A-Za-z]", inner) or COUNTED.fullmatch(inner):
        return inner
    return f"\\{inner}" if inner in GREEK else rf"\mathrm{{{_escaped(inner)}}}"


def _escaped(word: str) -> str:
    return word.replace("_", r"\_").replace("'", "")


def _is_short(text: str) -> bool:
    return re.fullmatch(r"\\?[A-Za-z]+(_\{[^{}]*\})?", text) is not None


def _bare(text: str) -> str:
    """Return a formula without the outer parentheses, which a fraction makes needless."""
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
