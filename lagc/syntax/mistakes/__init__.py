"""Explanations of common syntax mistakes, one function each; here their context, and repairs."""

from collections.abc import Callable, Sequence

from lagc.base.records import dataclass
from lagc.diagnostics.faults import Fault, Span
from lagc.syntax.lalr import Machine
from lagc.syntax.lexer import END, SYMBOL, UNIT, WORD, Token

HEADERS = frozenset(("model", "package", "effect", "scene", "for", "when"))  # words that open a block


@dataclass(frozen=True, slots=True)
class Repair:
    """Replace `count` tokens from number `at` on by others."""

    at: int
    count: int
    others: tuple[Token, ...]


@dataclass(frozen=True, slots=True)
class Explained:
    fault: Fault
    repair: Repair | None = None


def explained(
    code: str,
    message: str,
    span: Span,
    remedy: str | None = None,
    repair: Repair | None = None,
    related: tuple[tuple[Span, str], ...] = (),
) -> Explained:
    return Explained(Fault(code, message, span, related, remedy), repair)


class Where:
    """The place of a mistake: an unexpected token in the declaration that begins with token number
    `begin`."""

    def __init__(self, machine: Machine, accepts: Callable[..., bool], begin: int, brackets: Sequence[Token]):
        self.source = machine.source
        self.tokens = machine.tokens
        self.keywords = machine.tables.keywords
        self.signs = machine.tables.symbols
        self.block = machine.blocks[-1] if machine.blocks else None
        self.accepts = accepts  # whether terminals can follow here, one after the other
        self.position = machine.position
        self.begin = begin
        self.brackets = brackets  # that are open
        self.token = self.tokens[self.position]
        self.before = self.tokens[max(self.position - 1, 0)]
        self.first = self.tokens[begin]
        self.inside = begin < self.position  # a declaration has begun

    @property
    def shown(self) -> str:
        """Return the token for messages."""
        return "the end of the file" if self.token.kind == END else f"`{self.token.text}`"

    def span(self, first: Token, last: Token | None = None) -> Span:
        return Span(self.source, first.start, (last or first).end)

    def sign(self, text: str) -> str:
        return self.signs[text]

    def new_line(self) -> bool:
        """Return whether the token begins a new line."""
        return "\n" in self.source.text[self.before.end : self.token.start] or self.token.kind == END

    def last_of_declaration(self) -> int:
        """Return the number of the token before the next `;`, or the last one of the text."""
        last = self.position
        while self.tokens[last + 1].text != ";" and self.tokens[last + 1].kind != END:
            last += 1
        return last

    def replace(self, *texts: str) -> Repair:
        return Repair(self.position, 1, self._tokens(texts))

    def insert(self, *texts: str) -> Repair:
        return Repair(self.position, 0, self._tokens(texts))

    def replace_first(self, *texts: str) -> Repair:
        return Repair(self.begin, 1, tuple(token_of(text, self.first.start) for text in texts))

    def _tokens(self, texts: Sequence[str]) -> tuple[Token, ...]:
        return tuple(token_of(text, self.token.start) for text in texts)


def token_of(text: str, at: int) -> Token:
    kind = WORD if text[0].isalpha() else UNIT if text[0] == "[" and len(text) > 1 else SYMBOL
    return Token(kind, text, at, at)
