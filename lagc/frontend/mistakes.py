"""What a person who wrote this most likely meant: syntax mistakes in the user's terms."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from lagc.diagnostics.faults import Fault, Source, Span
from lagc.frontend.lexer import END, SYMBOL, WORD, Token

if TYPE_CHECKING:
    from lagc.frontend.machine import Machine


@dataclass(frozen=True, slots=True)
class Explained:
    """A fault, and the repair with which the text reads on: how many tokens to leave out at the
    place, and those to put there."""

    fault: Fault
    repair: tuple[int, list[Token]] | None = None


class Where:
    """The place of a mistake: the machine, and the number of the declaration's first token."""

    def __init__(self, machine: Machine, begin: int):
        self.machine = machine
        self.source = machine.source
        self.tokens = machine.tokens
        self.position = machine.position
        self.begin = begin
        self.token = machine.tokens[machine.position]


def explain(where: Where) -> Explained:
    token = where.token
    shown = "the end of the file" if token.kind == END else f"`{token.text}`"
    return Explained(
        Fault("LAG0110", f"{shown} cannot stand here", Span(where.source, token.start, token.end))
    )


def wrong_end(source: Source, word: Token, name: Token, found: Token, span: Span) -> Fault:
    loop = word.text in ("for", "when")
    right = word.text if loop else name.text
    opened = Span(source, word.start, max(word.end, name.end if not loop else word.end))
    return Fault(
        "LAG0113",
        f"this `end` names `{found.text}`, but it closes {_block(word, name)}",
        span,
        related=((opened, "opened here"),),
        remedy=f"write `end {right};`",
    )


def missing_end(source: Source, word: Token, name: Token, at: Token) -> Fault:
    loop = word.text in ("for", "when")
    right = word.text if loop else name.text
    opened = Span(source, word.start, word.end if loop else max(word.end, name.end))
    return Fault(
        "LAG0112",
        f"{_block(word, name)} is not closed before {'the end of the file' if at.kind == END else 'this `end`'}",
        Span(source, at.start, at.end),
        related=((opened, "opened here"),),
        remedy=f"write `end {right};`",
    )


def _block(word: Token, name: Token) -> str:
    return f"this `{word.text}`" if word.text in ("for", "when") else f"{word.text} `{name.text}`"


def behind(source: Source, tokens: list[Token], begin: int, position: int, keywords: Mapping[str, str]) -> int:
    """The number of the token with which to go on, where the declaration from `begin` on is given
    up at `position`: behind its `;`, or at an `end` or a declaration that begins a line."""
    start = max(position, begin)
    for number in range(start, len(tokens)):
        token = tokens[number]
        if token.kind == END:
            return number
        if token.kind == SYMBOL and token.text == ";":
            return number + 1
        if number > begin and token.kind == WORD and token.text in keywords and _first_on_line(source, token):
            return number
    return len(tokens) - 1


def _first_on_line(source: Source, token: Token) -> bool:
    return not source.text[source.text.rfind("\n", 0, token.start) + 1 : token.start].strip()
