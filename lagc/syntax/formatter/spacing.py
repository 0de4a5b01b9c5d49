"""Blanks between the tokens of a declaration, and where a long one is broken."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import pairwise
from math import inf

from lagc.base.records import dataclass
from lagc.syntax import tree
from lagc.syntax.lexer import NUMBER, SYMBOL, UNIT, WORD, Token

_OPENING = ("(", "[", "{")
_CLOSING = (")", "]", "}")
_TIGHT = ("*", "/", "^", ".")
_CONTINUED = "  "  # before the further lines of a declaration
_BEFORE_BREAKS = frozenset({"AT", "ON", "FROM", "UNLESS", "THEN", "ELSE", "ELSEIF", "USES", "AND", "OR"})


@dataclass(slots=True)
class Piece:
    """A token or a comment of a line: `space` before it; `rank` how well the line breaks before it
    (0: never, then smaller is better); `comment` tells which it is; `ends` where the line must end
    behind it."""

    text: str
    space: bool
    rank: int = 0
    comment: bool = False
    ends: bool = False


class Spacing:
    """The blanks of one text."""

    def __init__(self, read: tree.Tree, tokens: list[Token]):
        self.tokens = tokens
        # Where the options of a constraint begin: a blank before their `(` keeps them from being
        # read as the arguments of the name before it.
        found = _constraints(read.declarations)
        options = {constraint.arguments[0].span.start for constraint in found if constraint.arguments}
        self.options = {before.start for before, token in pairwise(tokens) if token.start in options}

    def pieces(self, position: int, stop: int, comments: Sequence[Token]) -> list[Piece]:
        """Tokens position..stop, and the comments that stand among them."""
        made: list[Piece] = []
        waiting = list(comments)
        brackets: list[str] = []
        ranged = inf  # how many brackets are open around the range that has begun
        for number in range(position, stop):
            token = self.tokens[number]
            while waiting and waiting[0].start < token.start:
                made.append(_comment(waiting.pop(0)))
            if token.text in _CLOSING and token.kind == SYMBOL:
                brackets.pop()
            if token.terminal == "FOR":
                ranged = len(brackets)
            elif token.terminal == "LOOP" or len(brackets) < ranged:
                ranged = inf
            tight = ranged < inf or "[" in brackets
            before = self.tokens[number - 1] if number > position else None
            space = before is not None and self.space(number, tight)
            if made and made[-1].comment:
                space = space or token.text not in (",", ";", *_CLOSING)
            made.append(Piece(_text(token), space, self.rank(number, space, len(brackets))))
            if token.text in _OPENING and token.kind == SYMBOL:
                brackets.append(token.text)
        return made

    def space(self, number: int, tight: bool) -> bool:
        """Is there a blank before token `number`?  `tight`: inside subscripts and ranges."""
        token, before = self.tokens[number], self.tokens[number - 1]
        if token.kind == UNIT:
            return before.kind == NUMBER or before.text == "}"
        if token.kind == SYMBOL:
            return self._before_sign(number, tight)
        return self._behind(number, tight)

    def _before_sign(self, number: int, tight: bool) -> bool:
        token, before = self.tokens[number], self.tokens[number - 1]
        text = token.text
        if text in (",", ";", ".*", ":", "[", *_CLOSING) or text in _TIGHT:
            return False
        if text in ("+", "-"):
            if self._is_sign(number):
                return self._behind(number, tight)
            return not tight
        if text == "(" and token.start in self.options:
            return True
        if text == "(":
            if before.kind == WORD:
                return before.terminal not in ("NAME", "SIMULATE", "ANNOTATION")
            if before.text in _CLOSING:
                return False
            return self._behind(number, tight)
        if text == "{":
            return self._behind(number, tight)
        return True  # = and comparisons

    def _behind(self, number: int, tight: bool) -> bool:
        """Is there a blank before an operand, as far as the token before it tells?"""
        before = self.tokens[number - 1]
        if before.kind != SYMBOL:
            return True
        text = before.text
        if text in _OPENING or text in _TIGHT:
            return False
        if text == ":":
            return not tight
        if text in ("+", "-"):
            return not (tight or self._is_sign(number - 1))
        return True

    def _is_sign(self, number: int) -> bool:
        """Is this `+` or `-` the sign of what follows?"""
        before = self.tokens[number - 1]
        if before.kind == SYMBOL:
            return before.text not in _CLOSING
        return before.kind == WORD and before.terminal != "NAME" and before.terminal not in ("TRUE", "FALSE")

    def rank(self, number: int, space: bool, depth: int) -> int:
        if not space:
            return 0
        token, before = self.tokens[number], self.tokens[number - 1]
        if token.terminal in _BEFORE_BREAKS or token.terminal == "STRING":
            return 4 * depth + 1
        if before.text == "," and before.kind == SYMBOL:
            return 4 * depth + 1
        if token.text in ("+", "-") and not self._is_sign(number):
            return 4 * depth + 2
        if before.text == "=" and depth == 0:
            return 4 * depth + 3
        return 0


def wrapped(pieces: Sequence[Piece], indent: str, width: int) -> list[str]:
    """The lines of one declaration, each of at most `width` characters where it can be broken."""
    lines: list[str] = []
    line: list[Piece] = []
    lead = indent
    for piece in pieces:
        line.append(piece)
        while _length(line, lead) > width:
            at = _break(line, lead, width)
            if at is None:
                break
            lines.append(lead + _joined(line[:at]))
            line = line[at:]
            lead = indent + _CONTINUED
        if piece.ends:
            lines.append(lead + _joined(line))
            line = []
            lead = indent + _CONTINUED
    if line:
        lines.append(lead + _joined(line))
    return lines


def _break(line: list[Piece], lead: str, width: int) -> int | None:
    """Where to break a line that is too long: at its best place, the last one of these; places in
    its first quarter only where there is no other."""
    best: int | None = None
    best_rank = 0
    length = len(lead)
    for number, piece in enumerate(line):
        if number and piece.rank and length <= width:
            rank = piece.rank + (1000 if length < width // 4 else 0)
            if best is None or rank <= best_rank:
                best, best_rank = number, rank
        length += len(piece.text) + (piece.space and number > 0)
    return best


def _length(line: Iterable[Piece], lead: str) -> int:
    return len(lead) + len(_joined(line))


def _joined(line: Iterable[Piece]) -> str:
    text = "".join((" " if piece.space else "") + piece.text for piece in line)
    return text.lstrip(" ")


def _comment(comment: Token) -> Piece:
    text = "\n".join(part.rstrip() for part in comment.text.split("\n"))
    return Piece(text, True, comment=True, ends=text.startswith("//") or "\n" in text)


def _text(token: Token) -> str:
    return f"[{token.text[1:-1].strip()}]" if token.kind == UNIT else token.text


def _constraints(declarations: Iterable[tree.Declaration]) -> Iterator[tree.Constraint]:
    blocks = (tree.ModelDeclaration, tree.Package, tree.Effect, tree.ForLoop)
    for declaration in declarations:
        if isinstance(declaration, tree.Constraint):
            yield declaration
        elif isinstance(declaration, blocks):
            yield from _constraints(declaration.body)
