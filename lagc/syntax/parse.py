"""From text to syntax tree: the entry points."""

from __future__ import annotations

import re

from lagc.diagnostics.faults import Fault, Refused, Source, Span
from lagc.syntax.lalr import MOST_FAULTS, Machine
from lagc.syntax.lalr_tables import tables
from lagc.syntax.lexer import tokenise
from lagc.syntax.tokens import SYMBOL, WORD, Lexed, Token
from lagc.syntax.tree import Declarator, Expression, Quantities, Tree

_FOREIGN = re.compile(r"\b(?:equation|algorithm|within)\b|\b(?:model|block|class|package|record)\s+\w+\s*=")


def parse(source: Source) -> Tree:
    """Return the tree of a text.  Raises Refused with its syntax faults, at most MOST_FAULTS."""
    tree, faults = parse_recovering(source)
    if faults:
        raise Refused(faults)
    return tree


def parse_recovering(source: Source) -> tuple[Tree, list[Fault]]:
    """Return the readable part of a text as a tree, and its syntax faults in the order of the text."""
    tree, _, faults = read(source)
    return tree, faults


def parse_expression(source: Source) -> Expression:
    """Return the expression of a text.  Raises Refused."""
    lexed, length = tokenise(source), len(source.text)
    before = [Token(WORD, word, 0, 0) for word in ("constant", "Real", "value")]
    lexed.tokens[:0] = [*before, Token(SYMBOL, "=", 0, 0)]
    lexed.tokens[-1:-1] = [Token(SYMBOL, ";", length, length)]
    machine = Machine(source, tables(), lexed)
    tree, faults = machine.run(_recover), _faults_of(lexed, machine)
    if faults:
        raise Refused(faults)
    match tree:
        case Tree(
            declarations=(Quantities(declarators=(Declarator(value=value, description=None),), unless=()),)
        ):
            if value is not None:
                return value
    message = "this is not a single expression"
    raise Refused([Fault("LAG0110", message, Span(source, 0, length), remedy="write it without `;`")])


def read(source: Source) -> tuple[Tree, Lexed, list[Fault]]:
    """Return the tree, the tokens and the faults of a text."""
    nul = source.text.find("\0")
    if nul >= 0:  # in a comment too
        message, remedy = ("the language does not use the character U+0000", "save the file as UTF-8 text")
        fault = Fault("LAG0101", message, Span(source, nul, nul + 1), remedy=remedy)
        return Tree(source, ()), Lexed([], [], []), [fault]
    lexed = tokenise(source)
    if _FOREIGN.search(source.text):
        from lagc.syntax.mistakes import passages

        passages.leave_out(source, lexed, frozenset(tables().keywords))
    machine = Machine(source, tables(), lexed)
    tree = machine.run(_recover)
    return tree if tree is not None else Tree(source, ()), lexed, _faults_of(lexed, machine)


def _recover(machine: Machine) -> bool:
    from lagc.syntax.recovery import recover  # where there is a fault

    return recover(machine)


def _faults_of(lexed: Lexed, machine: Machine) -> list[Fault]:
    """Return the faults of a text in the order of the text."""
    found = {(fault.code, _start(fault)): fault for fault in machine.faults + machine.builder.faults}
    lost = [_start(fault) for fault in lexed.faults if fault.code == "LAG0103"]
    if lost:  # an unclosed comment hides the text after it
        read = machine.source.text[: lost[0]].rstrip()
        found = {key: fault for key, fault in found.items() if key[1] < len(read)}
    return sorted(lexed.faults + list(found.values()), key=_start)[:MOST_FAULTS]


def _start(fault: Fault) -> int:
    return fault.span.start if fault.span is not None else 0
