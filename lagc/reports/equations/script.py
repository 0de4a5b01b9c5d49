"""Formulas as a Python script that builds the equations with SymPy."""

from __future__ import annotations

import keyword
import re
from collections.abc import Hashable, Mapping, Sequence
from math import inf
from typing import Any, NamedTuple, TypeAlias

from lagc.base.records import dataclass
from lagc.mechanics.formulation.equations import EquationsOfMotion
from lagc.reports.algebra.expansion import TABLE
from lagc.reports.algebra.polynomials import Exponent
from lagc.reports.equations.formulas import LETTER
from lagc.reports.equations.modes import IMPACTS
from lagc.reports.equations.page import Page
from lagc.reports.equations.plain_text import TextWriter
from lagc.reports.names import Name, Names, forces_of_contacts, pi_of
from lagc.reports.patterns.formula_trees import (
    INDEX,
    Counters,
    Line,
    Linear,
    Symbol,
    Total,
    all_of,
    filled,
    indices,
)
from lagc.reports.patterns.index_rules import ruled
from lagc.symbolic.graph import Node
from lagc.symbolic.operators import TRUTHS, spelling

RULED = {"sum", "range", "parts"}  # what scripts of rules use besides
WORDS = spelling("sympy")
LAWS = ("closed", "complement", "bound", "stick", "slip")
PRINTED = {"mode": "(mode, modes[mode])"}


Titled: TypeAlias = tuple[str, "ScriptWriter", Page]  # a mode


def write_script(equations: EquationsOfMotion, modes: Sequence[tuple[str, Page]]) -> str:
    """Return the text of the script: symbols, shared parts, the list `equations` of sympy.Eq, and with `when`
    clauses the list `events` of pairs: a condition, and a dict of states with their new values. By rules,
    arrays are dicts by index, and shared parts are functions of time in the list `parts`. With contacts, the
    dict `modes` has lists of equations and conditions by the titles of modes, `impacts` pairs of what changes
    and its new value, `laws` the laws of two-sided contacts."""
    _, found = modes[0]
    # Symbols are declared once, for the equations of open contacts and for those of all modes.
    declared = _declared(equations, found.names)
    parts = _parts(found) if found.ruled else []
    declared += [(name, "Function", "", "") for name in parts if indices(name)]
    writer = ScriptWriter(found, _variables(equations, found))
    model = equations.model
    lines = [f"# Equations of motion of {_plain(model.name)}, scene {_plain(model.scene)}, in SI units.", ""]
    lines += ["import sympy", ""]
    time = found.names[equations.time].base
    lines += [f't = sympy.Symbol("{time}", real=True)', *_declarations(declared, writer)]
    lines += _unindexed([name for name in parts if not indices(name)])
    every = [(title, ScriptWriter(each, _variables(equations, each)), each) for title, each in modes[1:]]
    body = _body(found, writer, every)
    seen = {name for each in (writer, *(own for _, own, _ in every)) for name in each.seen}
    for op, name in found.names.items():
        if isinstance(op, str) and name in seen:  # a table
            value = f"sympy.Function({name.base!r}, real=True)"
            lines.append(_with(f"{writer.variables[name.base]} = {value}", _source(name)))
    return "\n".join([*lines, "", *body])


def _body(found: Page, writer: ScriptWriter, modes: Sequence[Titled]) -> list[str]:
    """Return the lines behind the declarations."""
    # Shared parts are assigned before the equations that use them; laws, modes and events come after these.
    lines, shown = list[str](), ["equation"]
    shared = [line for line in found.lines if line.kind == "shared"]
    if found.ruled and shared:
        lines += ["parts = [", *[writer.equation(line) for line in shared], "]"]
    else:
        named = [line for line in found.lines if line.kind == "entry"]
        lines += [f"{line.label} = {writer.total(line.right)}" for line in [*shared, *named]]
    lines.append("equations = [")
    lines += [
        writer.equation(line)
        for line in found.lines
        if line.kind not in ("shared", "entry", "contact", "event", *LAWS, *IMPACTS)
    ]
    lines.append("]")
    gaps = [line for line in found.lines if line.kind == "contact"]
    if gaps:
        lines.append("gaps = [  # are not negative; the equations are those of open contacts")
        lines += [f"    {writer.total(line.left)}," for each in gaps for line in all_of(each)]
        lines.append("]")
    laws = [line for line in found.lines if line.kind in LAWS]
    if laws:
        lines += ["laws = [", *[writer.equation(line) for line in laws], "]"]
        shown.append("law")
    if modes:
        lines += _modes(modes)
        shown.append("mode")
    events = [line for line in found.lines if line.kind == "event"]
    if events:
        lines += ["events = [", *[writer.event(clause) for clause in _clauses(events)], "]"]
        shown.append("event")
    lines += ["", 'if __name__ == "__main__":']
    for one in shown:
        lines += [f"    for {one} in {one}s:", f"        sympy.pprint({PRINTED.get(one, one)})"]
    return lines


def _modes(modes: Sequence[Titled]) -> list[str]:
    """Return the lines that make `modes` and `impacts`."""
    lines = ["modes = {}"]
    for title, own, found in modes:
        shared = [line for line in found.lines if line.kind == "shared"]
        if found.ruled:
            parts = _parts(found)
            indexed: list[Declared] = [(name, "Function", "", "") for name in parts if indices(name)]
            lines += [
                *_declarations(indexed, own),
                *_unindexed([name for name in parts if not indices(name)]),
            ]
        else:
            lines += [f"{line.label} = {own.total(line.right)}" for line in shared]
        kept = [x for x in found.lines if x.kind not in IMPACTS and (found.ruled or x.kind != "shared")]
        lines += [f"modes[{title.replace('`', '')!r}] = [", *[own.equation(line) for line in kept], "]"]
        impacts = [own.equation(line) for line in found.lines if line.kind in IMPACTS]
        lines += ["impacts = [", *impacts, "]"] if impacts else []
    return lines


@dataclass(frozen=True, slots=True)
class Clause:
    """The changes at an event, for all values of the `counters`; further counters of a line belong to its own
    changes."""

    counters: Counters
    lines: list[Line]


def _clauses(lines: Sequence[Line]) -> list[Clause]:
    """Return the clauses. Rules that take a clause apart are written out first."""
    every = [line for each in lines for line in all_of(each)]
    found = _by_clause(lines)
    several = sum([len({line.clause for each in one.lines for line in all_of(each)}) for one in found])
    return found if several == len({line.clause for line in every}) else _by_clause(every)


def _by_clause(lines: Sequence[Line]) -> list[Clause]:
    """Return the clauses by their number, which may follow counters."""
    found: dict[Hashable, Clause] = {}
    for line in lines:
        slopes = line.clause.slopes if isinstance(line.clause, Linear) else ()
        named = {name for name, _ in slopes}
        outer = tuple([each for each in line.counters if each[0] in named])
        found.setdefault((line.clause, outer), Clause(outer, [])).lines.append(line)
    return list(found.values())


def _plain(text: str) -> str:
    """Return a text on one line, so that it stays inside a comment."""
    return " ".join(text.split())


def _parts(found: Page) -> list[str]:
    """The names of the shared parts."""
    return [
        filled(line.label, [str(x) for x in line.indices])
        for whole in found.lines
        if whole.kind == "shared"
        for line in all_of(whole)
    ]


def _unindexed(names: list[str]) -> list[str]:
    """Return one declaration of all names, which are identifiers."""
    if not names:
        return []
    return [f"{', '.join(names)}, = [sympy.Function(name, real=True)(t) for name in {names}]"]


def _variables(equations: EquationsOfMotion, found: Page) -> dict[str, str]:
    """Name that is shown, where arrays are written without indices, -> Python identifier."""
    shared = {line.label for line in found.lines if line.kind in ("shared", "entry")}
    taken = {"t", "sympy", "equations", "equation"} | (RULED if found.ruled else shared)
    taken |= {"events", "event"} if equations.whens else set()
    taken |= {"gaps", "laws", "law", "modes", "mode", "impacts"} if equations.contacts else set()
    variables = {"pi": "sympy.pi"} if pi_of(equations) is not None else {}
    for node, name in found.names.items():
        base = INDEX.sub("", name.base) if found.ruled else name.base
        if node is equations.time or base in variables or (base in shared and not found.ruled):
            continue
        word = re.sub(r"\W+", "_", base).strip("_") or "n"
        word = f"n{word}" if word[0].isdigit() else word
        while word in taken or keyword.iskeyword(word):
            word += "_"
        taken.add(word)
        variables[base] = word
    return variables


Declared: TypeAlias = tuple[str, str, str, str]  # name, how it is made, its unit, what it is


def _declared(equations: EquationsOfMotion, names: Names) -> list[Declared]:
    model = equations.model
    found = [
        (p.symbol, "nonnegative" if p.minimum >= 0 else "real", p.unit, p.description)
        for p in model.parameters
    ]
    found += [(x.symbol, "real", x.unit, x.description) for x in model.discretes]
    moving = [(i.symbol, i.unit, i.description) for i in model.inputs]
    moving += [(q, unit, "") for q, unit in zip(equations.q, equations.q_units)]
    moving += [(v, unit, "") for v, unit in zip(equations.v, equations.v_units) if v.record.order == 0]
    moving += [(row.multiplier, "", f"multiplier of {row.label}") for row in equations.rows]
    moving += [(node, "", about) for node, _, about in forces_of_contacts(equations)]
    moving += [(node, "", "") for node in names if isinstance(node, Node) and node.record.kind == LETTER
               and node.record.component and not node.record.order]  # fmt: skip
    found += [(node, "Function", unit, description) for node, unit, description in moving]
    return [
        (names[node].base, how, unit, ", ".join([x for x in (_source(names[node]), description) if x]))
        for node, how, unit, description in found
    ]


def _source(name: Name) -> str:
    """Return the full name of a short one."""
    return name.full if name.full != name.base else ""


def _declarations(declared: Sequence[Declared], writer: ScriptWriter) -> list[str]:
    if not writer.ruled:
        return [_declaration(writer.variables[name], repr(name), *how) for name, *how in declared]
    nothing, lines, begun = Total(()), [], set[str]()
    # Declarations of families are lines too, whose rules make dicts by index.
    as_lines = [
        Line(
            "\n".join([how, unit, _plain(INDEX.sub("", description))]), name, indices(name), nothing, nothing
        )
        for name, how, unit, description in declared
    ]
    for line in ruled(as_lines, writer.taken):
        word = writer.variables[INDEX.sub("", line.label)]
        how, unit, description = line.kind.split("\n")
        numbers = [writer.number(x) for x in line.indices]
        if not numbers:
            lines.append(_declaration(word, repr(line.label), how, unit, description))
            continue
        name = "f" + repr(
            filled(line.label.replace("{", "{{").replace("}", "}}"), [f"{{{x}}}" for x in numbers])
        )
        key = numbers[0] if len(numbers) == 1 else f"({', '.join(numbers)})"
        value, _, comment = _declaration("", name, how, unit, description)[3:].partition("  # ")
        found = f"{word} {'|=' if word in begun else '='} {{{key}: {value}{writer.counters(line.counters)}}}"
        lines.append(_with(found, comment))
        begun.add(word)
    return lines


def _declaration(variable: str, name: str, how: str, unit: str, description: str) -> str:
    if how == "Function":
        value = f"sympy.Function({name}, real=True)(t)"
    else:
        value = f"sympy.Symbol({name}, {how}=True)"
    return _with(f"{variable} = {value}", ", ".join([part for part in (unit, _plain(description)) if part]))


def _with(code: str, comment: str) -> str:
    return code + (f"  # {comment}" if comment else "")


class ScriptWriter(TextWriter):
    relations: Mapping[str, str] = {
        "=": "sympy.Eq({}, {})",
        "contact": "sympy.Ge({}, {})",
        "complement": "sympy.And(sympy.Ge({0}, 0), sympy.Ge({1}, 0), sympy.Eq(({0})*({1}), 0))",
        "bound": "sympy.Le({}, {})",
        "stick": "sympy.Or(sympy.Ne({2}, 0), sympy.Le({0}, {1}))",
        "slip": "sympy.Or(sympy.Eq({2}, 0), sympy.Eq({0}, {1}))",
        **dict.fromkeys(IMPACTS, "({}, {})"),
    }

    def __init__(self, found: Page, variables: Mapping[str, str]) -> None:
        super().__init__(found.names)
        self.variables, self.ruled, self.taken = variables, found.ruled, found.taken

    def equation(self, line: Line) -> str:
        """Return an equation as an entry of a list."""
        condition = "" if line.condition is None else self.total(line.condition)
        relation = self.relations.get(line.kind, self.relations["="])
        equation = relation.format(self.total(line.left), self.total(line.right), condition)
        label = _plain(self.indexed(line.label, line))
        if line.counters:
            equation = f"*[{equation}{self.counters(line.counters)}]"
        return f"    {equation},  # {label}"

    def event(self, clause: Clause) -> str:
        first, changes = clause.lines[0], []
        for line in clause.lines:
            change = f"{self.total(line.left)}: {self.total(line.right)}"
            own = self.counters(tuple([each for each in line.counters if each not in clause.counters]))
            changes.append(f"**{{{change}{own}}}" if own else change)
        assert first.condition is not None
        event = f"({self.total(first.condition)}, {{{', '.join(changes)}}})"
        if clause.counters:
            event = f"*[{event}{self.counters(clause.counters)}]"
        return f"    {event},"

    def series(self, counter: str, first: str, last: str, text: str) -> str:
        return f"sum({text} for {counter} in {_range(first, last)})"

    def counters(self, counters: Counters) -> str:
        return "".join([f" for {k} in {_range(self.number(a), self.number(b))}" for k, a, b in counters])

    def quotient(self, top: str, over: list[str], bottom: str, under: list[str]) -> str:
        if bottom != "1":
            top, bottom = f"sympy.Rational({top}, {bottom})", "1"
        return super().quotient(top, over, bottom, under)

    def decimal(self, written: str) -> str:
        """Return a number; one that no double holds is a text in quotes."""
        return f"sympy.Float({written})" if 0.0 < float(written) < inf else f"sympy.Float({written!r})"

    def root(self, text: str) -> str:
        return f"sympy.sqrt({text})"

    def raised(self, base: str, exponent: Exponent) -> str:
        if exponent == 1:
            return base
        if exponent.denominator == 1:
            return f"{base}**{exponent}"
        return f"{base}**sympy.Rational({exponent.numerator}, {exponent.denominator})"

    def symbol(self, symbol: Symbol, exponent: Exponent) -> str:
        name = self.names.get(symbol.node)
        if name is None or name.full == "time":
            return self.raised("t", exponent)
        base = INDEX.sub("", name.base) if self.ruled else name.base
        word = self.variables.get(base, base)
        if self.ruled and symbol.indices:
            word += f"[{', '.join([self.number(x) for x in symbol.indices])}]"
        if name.order:
            word += ".diff(t)" if name.order == 1 else f".diff(t, {name.order})"
        return self.raised(word, exponent)

    def slope(self, base: str, primes: str) -> str:
        return f"sympy.Function({base + primes!r}, real=True)" if primes else self.variables[base]

    def function(self, op: str, args: list[str], exponent: Exponent) -> str:
        if op == "pow":
            return self.raised(f"(({args[0]})**({args[1]}))", exponent)
        if op == "select":
            return self.raised(f"sympy.Piecewise(({args[1]}, {args[0]}), ({args[2]}, True))", exponent)
        word = self.table(op) if op.startswith(TABLE) else f"sympy.{WORDS[op]}"
        text = f"{word}({', '.join(args)})"
        return text if op in TRUTHS else self.raised(text, exponent)


def _range(first: str, last: str) -> str:
    if last.isdigit():
        return f"range({first}, {int(last) + 1})"
    return (
        f"range({first}, {last.removesuffix(' - 1')})"
        if last.endswith(" - 1")
        else f"range({first}, {last} + 1)"
    )


class Matrices(NamedTuple):
    """M a + h = tau + G^T lam, G a = gamma, qdot = N v + n, in the symbols `q`, `v` and those of the
    parameters, which are real and have the names of the model. Shapes: q (nq, 1), v (nv, 1), qdot (nq, 1),
    mass_matrix (nv, nv), bias_forces and given_forces (nv, 1), constraint_jacobian (nc, nv), gamma (nc,
    1)."""

    q: Any
    v: Any
    qdot: Any
    mass_matrix: Any
    bias_forces: Any
    given_forces: Any
    constraint_jacobian: Any
    gamma: Any


def matrices(equations: EquationsOfMotion) -> Matrices:
    """Raises ImportError, with what to install, where SymPy is missing."""
    try:
        import sympy
    except ModuleNotFoundError:
        raise ImportError("matrices need SymPy: pip install sympy") from None
    from lagc.symbolic.sympy import to_sympy

    zero, nv, nc = equations.graph.zero, len(equations.v), len(equations.rows)
    # M is symmetric, and kept by its lower half. All expressions are changed at once, so that shared parts
    # are.
    pairs = [(max(i, j), min(i, j)) for i in range(nv) for j in range(nv)]
    parts = [
        list(equations.q),
        list(equations.v),
        list(equations.qdot),
        [equations.mass_matrix.get(pair, zero) for pair in pairs],
        list(equations.bias_forces),
        list(equations.given_forces),
        [row.jacobian.get(j, zero) for row in equations.rows for j in range(nv)],
        [row.gamma for row in equations.rows],
    ]
    found = iter(to_sympy([node for part in parts for node in part]))
    shapes = [(len(part), 1) for part in parts]
    shapes[3], shapes[6] = (nv, nv), (nc, nv)
    filled = [
        sympy.Matrix(*shape, [next(found) for _ in part]) for shape, part in zip(shapes, parts, strict=True)
    ]
    return Matrices(*filled)
