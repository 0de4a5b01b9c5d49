"""Text to syntax tree."""

from __future__ import annotations

from lagc.diagnostics.faults import Fault, Refused, Source
from lagc.frontend.lexer import tokenise
from lagc.frontend.machine import MOST_FAULTS, Machine
from lagc.frontend.tables import tables
from lagc.frontend.tree import Tree


def parse(source: Source) -> Tree:
    """The tree of a text.  Raises Refused with every fault of its syntax, at most MOST_FAULTS."""
    tree, faults = parse_recovering(source)
    if faults:
        raise Refused(faults)
    return tree


def parse_recovering(source: Source) -> tuple[Tree, list[Fault]]:
    """What could be read of a text, and the faults of its syntax in the order of the text."""
    lexed = tokenise(source)
    machine = Machine(source, tables(), lexed)
    tree = machine.run()
    faults = lexed.faults + machine.faults + machine.builder.faults
    faults.sort(key=lambda fault: fault.span.start if fault.span is not None else 0)
    return tree if tree is not None else Tree(source, ()), faults[:MOST_FAULTS]
