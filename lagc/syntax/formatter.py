"""The standard layout of a model.

Indentation of two blanks, one declaration per line, lines of at most WIDTH characters, at most one blank line
between two lines; comments and descriptions are kept.  A block with one declaration that was written on one
line stays on one line.  Tokens are never changed, so the meaning is the same.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import pairwise
from math import inf

from lagc.base.records import dataclass, field
from lagc.diagnostics.faults import Refused, Source
from lagc.syntax import tree
from lagc.syntax.lexer import END, NUMBER, SYMBOL, UNIT, WORD, Lexed, Token
from lagc.syntax.parse import read

WIDTH = 100
INDENT = "  "

_HEADS = frozenset({"MODEL", "PACKAGE", "EFFECT", "SCENE", "FOR", "WHEN", "PARTIAL"})


def format_source(source: Source) -> str:
    """Return the formatted text of `source`.  Raises Refused if its syntax has faults."""
    tree, lexed, faults = read(source)
    if faults:
        raise Refused(faults)
    return _Layout(source, lexed, Spacing(tree, lexed.tokens)).text()


@dataclass
class _Layout:
    source: Source
    lexed: Lexed
    spacing: Spacing
    lines: list[str] = field(default_factory=list)
    depth: int = 0
    fresh: bool = True  # right after the beginning of the file or of a block
    end: int = 0  # end of the written text in the source
    initial: bool = False
    next_comment: int = 0

    def text(self) -> str:
        tokens = self.lexed.tokens
        open_blocks: list[bool] = []  # for each open block: whether it was in an initial section
        position = 0
        while tokens[position].kind != END:
            first = tokens[position].terminal
            # `end` closes a block, and the section of initial equations that is open in it.
            if first == "END":
                self.comments(tokens[position].start)
                self.depth = len(open_blocks) - 1
                self.initial = open_blocks.pop()
                self.depth += self.initial
                self.fresh = True
                position = self.line(position, self.statement_end(position))
                continue
            # That section also ends with the first declaration.
            if self.initial and not self.is_condition(position):
                self.comments(tokens[position].start)
                self.initial = False
                self.depth -= 1
            # A block of one line stays one line; any other block indents what is in it.
            short = self.short_block_end(position)
            if short is not None:
                position = self.line(position, short)
            elif first in _HEADS and (stop := self.header_end(position)) is not None:
                position = self.line(position, stop)
                open_blocks.append(self.initial)
                self.depth += 1
                self.initial = False
                self.fresh = True
            elif first == "INITIAL":
                position = self.line(position, position + 1)
                self.initial = True
                self.depth += 1
                self.fresh = True
            else:
                position = self.line(position, self.statement_end(position))
        self.depth = 0
        self.comments(tokens[position].start)
        return "".join(line + "\n" for line in self.lines)

    # -- where statements end ------------------------------------------------------------------

    def statement_end(self, position: int) -> int:
        tokens = self.lexed.tokens
        while tokens[position].text != ";" or tokens[position].kind == WORD:
            position += 1
        return position + 1

    def header_end(self, position: int) -> int | None:
        """Return the position after the first line of a block, or None for a scene without a body."""
        tokens = self.lexed.tokens
        kind = tokens[position].terminal
        if kind in ("FOR", "WHEN"):
            last = "LOOP" if kind == "FOR" else "THEN"
            ours = 1
            while ours:  # the condition of a `when` may contain `then`
                ours += last == "THEN" and tokens[position].terminal in ("IF", "ELSEIF")
                ours -= tokens[position].terminal == last
                position += 1
            return position
        position += 3 if kind == "PARTIAL" else 2
        if tokens[position].terminal == "STRING":
            position += 1
        if kind == "SCENE" and tokens[position].terminal == "USES":
            position = self._behind_path(position + 1)
            while tokens[position].text == ",":
                position = self._behind_path(position + 1)
        return None if tokens[position].text == ";" else position

    def _behind_path(self, position: int) -> int:
        """Return the position after a path such as `cars[2].drag`."""
        tokens = self.lexed.tokens
        position += 1
        while tokens[position].text in (".", "["):
            closing = tokens[position].text == "["
            position += 2
            while closing and tokens[position - 1].text != "]":
                position += 1
        return position

    def short_block_end(self, position: int) -> int | None:
        """Return the position after a block with one declaration on one line, or None."""
        tokens = self.lexed.tokens
        if tokens[position].terminal not in _HEADS:
            return None
        body = self.header_end(position)
        if body is None or tokens[body].terminal in (*_HEADS, "END", "INITIAL"):
            return None
        end = self.statement_end(body)
        if tokens[end].terminal != "END":
            return None
        end = self.statement_end(end)
        first, last = tokens[position], tokens[end - 1]
        if "\n" in self.source.text[first.start : last.end]:
            return None
        comments = self.lexed.comments
        if any(first.start < comment.start < last.end for comment in comments):
            return None
        pieces = self.spacing.pieces(position, end, [])
        long = sum(len(piece.text) + piece.space for piece in pieces) + len(INDENT) * self.depth > WIDTH
        return None if long else end

    def is_condition(self, position: int) -> bool:
        """Return whether a line of the initial section, or a loop of such lines, begins here."""
        tokens = self.lexed.tokens
        while tokens[position].terminal == "FOR":
            stop = self.header_end(position)
            assert stop is not None  # loops have bodies
            position = stop
        if tokens[position].kind == WORD and tokens[position].terminal not in ("NAME", "NOT", "IF"):
            return False
        end = self.statement_end(position)
        depth = 0
        for token in tokens[position:end]:
            depth += (token.text in ("(", "[", "{")) - (token.text in (")", "]", "}"))
            if token.terminal == "EQUALS" and depth == 0:
                return True
        return False

    # -- lines ------------------------------------------------------------------------------------

    def line(self, position: int, stop: int) -> int:
        """Write tokens position..stop, with the comments before, between and right after them."""
        tokens = self.lexed.tokens
        self.comments(tokens[position].start)
        self.blank(tokens[position].start)
        among = self.taken_until(tokens[stop - 1].start)
        pieces = self.spacing.pieces(position, stop, among)
        self.lines.extend(wrap(pieces, INDENT * self.depth, WIDTH))
        self.end = tokens[stop - 1].end
        self.fresh = False
        self.add_trailing_comments(tokens[stop].start)
        return stop

    def taken_until(self, end: int) -> list[Token]:
        comments = self.lexed.comments
        begin = self.next_comment
        while self.next_comment < len(comments) and comments[self.next_comment].start < end:
            self.next_comment += 1
        return comments[begin : self.next_comment]

    def comments(self, end: int) -> None:
        """Write the comments before character `end`, one per line."""
        for comment in self.taken_until(end):
            self.blank(comment.start)
            self.lines.append(INDENT * self.depth + comment_text(comment))
            self.end = comment.end
            self.fresh = False

    def add_trailing_comments(self, following: int) -> None:
        """Add the comments on the line that was just written."""
        comments = self.lexed.comments
        while self.next_comment < len(comments):
            comment = comments[self.next_comment]
            if comment.start > following or "\n" in self.source.text[self.end : comment.start]:
                return
            self.lines[-1] += "  " + comment_text(comment)
            self.end = comment.end
            self.next_comment += 1
            if "\n" in comment.text:
                return

    def blank(self, start: int) -> None:
        """Keep a blank line before character `start`, except at the beginning of a block."""
        between = self.source.text[self.end : start]
        if not self.fresh and between.count("\n") > 1:
            self.lines.append("")


def comment_text(comment: Token) -> str:
    return "\n".join(line.rstrip() for line in comment.text.split("\n"))


_OPENING = ("(", "[", "{")
_CLOSING = (")", "]", "}")
_TIGHT = ("*", "/", "^", ".")
_CONTINUED = "  "  # before the further lines of a declaration
_BEFORE_BREAKS = frozenset({"AT", "ON", "FROM", "UNLESS", "THEN", "ELSE", "ELSEIF", "USES", "AND", "OR"})


@dataclass(slots=True)
class Piece:
    """A token or a comment of a line. `space`: a blank before it; `rank`: how good a line break before it is
    (0: never, then smaller is better); `comment`: the kind of comment; `ends`: the line must end after it."""

    text: str
    space: bool
    rank: int = 0
    comment: bool = False
    ends: bool = False


class Spacing:
    """The blanks between the tokens of a text."""

    def __init__(self, read: tree.Tree, tokens: list[Token]):
        self.tokens = tokens
        # Where the options of a constraint begin: a blank before their `(` keeps them from being
        # read as the arguments of the name before it.
        found = _constraints(read.declarations)
        options = {constraint.arguments[0].span.start for constraint in found if constraint.arguments}
        self.options = {before.start for before, token in pairwise(tokens) if token.start in options}

    def pieces(self, position: int, stop: int, comments: Sequence[Token]) -> list[Piece]:
        """Return tokens position..stop and the comments between them."""
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
        """Return whether there is a blank before token `number`; `tight`: inside subscripts and ranges."""
        token, before = self.tokens[number], self.tokens[number - 1]
        if token.kind == UNIT:
            return before.kind == NUMBER or before.text == "}"
        if token.kind == SYMBOL:
            return self._before_sign(number, tight)
        return self._has_blank_before(number, tight)

    def _before_sign(self, number: int, tight: bool) -> bool:
        token, before = self.tokens[number], self.tokens[number - 1]
        text = token.text
        if text in (",", ";", ".*", ":", "[", *_CLOSING) or text in _TIGHT:
            return False
        if text in ("+", "-"):
            if self._is_sign(number):
                return self._has_blank_before(number, tight)
            return not tight
        if text == "(" and token.start in self.options:
            return True
        if text == "(":
            if before.kind == WORD:
                return before.terminal not in ("NAME", "SIMULATE", "ANNOTATION")
            if before.text in _CLOSING:
                return False
            return self._has_blank_before(number, tight)
        if text == "{":
            return self._has_blank_before(number, tight)
        return True  # = and comparisons

    def _has_blank_before(self, number: int, tight: bool) -> bool:
        """Return whether there is a blank before an operand, depending on the token before it."""
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


def wrap(pieces: Sequence[Piece], indent: str, width: int) -> list[str]:
    """Return the lines of one declaration, at most `width` characters long where possible."""
    lines: list[str] = []
    line: list[Piece] = []
    lead = indent
    for piece in pieces:
        line.append(piece)
        while _length(line, lead) > width:
            at = _break(line, lead, width)
            if at is None:
                break
            lines.append(lead + _join(line[:at]))
            line = line[at:]
            lead = indent + _CONTINUED
        if piece.ends:
            lines.append(lead + _join(line))
            line = []
            lead = indent + _CONTINUED
    if line:
        lines.append(lead + _join(line))
    return lines


def _break(line: list[Piece], lead: str, width: int) -> int | None:
    """Return the best break of a line that is too long, preferably not in its first quarter."""
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
    return len(lead) + len(_join(line))


def _join(line: Iterable[Piece]) -> str:
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
