"""From text to tokens.

The lexer does not distinguish keywords from names; the parser does.  A bracket after a number, a `}` or the
word `Real` is a unit, any other bracket begins subscripts.
"""

from __future__ import annotations

import re

from lagc.diagnostics.faults import Fault, Source, Span
from lagc.syntax.tokens import END, NUMBER, STRING, SYMBOL, UNIT, WORD, Lexed, Token

_PATTERN = re.compile(
    r"""
    (?P<blank>[ \t\r\n\f]+)
  | (?P<comment>//[^\n]*|/\*.*?\*/)
  | (?P<word>[^\W\d]\w*)
  | (?P<number>(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)
  | (?P<string>"(?:[^"\\\n]|\\.)*")
  | (?P<unclosed>/\*|")
  | (?P<symbol>:=|==|<=|>=|<>|!=|~=|=>|->|\*\*|&&|\|\||\.[*/^]|\.\.\.?|[-+*/]=
      |[-+*/^=<>(){}\[\],;:.!%&|?@\#$~`'\\])
  | (?P<odd>.)
    """,
    re.VERBOSE | re.DOTALL,
)
_UNIT = re.compile(r"\[[^\[\]\n]*\]")
_UNIT_START = re.compile(r"\[[^\[\]\n,;)}]*")
_UNKNOWN = frozenset("?@#$~`'\\%")  # explained here; the parser explains the other ones

_BLANKS = frozenset(
    "\u00a0\u2000\u2001\u2002\u2003\u2004\u2005\u2006\u2007\u2008\u2009\u200a\u202f\u3000\v\x85\u2028\u2029"
)


def tokenise(source: Source) -> Lexed:
    """Return the tokens of a text.  Other characters are reported, and skipped or replaced by their likely
    meaning."""
    text = source.text
    lexed = Lexed([], [], [])
    tokens = lexed.tokens
    match = _PATTERN.match
    position = 1 if text.startswith("\ufeff") else 0  # a byte order mark
    length = len(text)
    while position < length:
        found = match(text, position)
        assert found is not None  # `odd` takes any character
        kind = found.lastgroup
        end = found.end()
        if kind == "blank":
            pass
        elif kind == "word":
            word = found.group()
            if not word.isascii():
                from lagc.syntax.mistakes.characters import foreign_word  # where there is a fault

                lexed.faults.append(foreign_word(source, word, position))
            tokens.append(Token(WORD, word, position, end))
        elif kind == "symbol":
            symbol = found.group()
            if symbol == "[" and tokens and _unit_follows(tokens[-1]):
                end = _unit(source, lexed, position)
            elif symbol in _UNKNOWN:
                end = _foreign(source, lexed, position)
            else:
                tokens.append(Token(SYMBOL, symbol, position, end))
        elif kind == "comment":
            lexed.comments.append(Token("comment", found.group(), position, end))
        elif kind == "unclosed":
            end = _unclosed(source, lexed, found.group(), position)
        elif kind == "odd":
            end = end if found.group() in _BLANKS else _foreign(source, lexed, position)
        else:
            assert kind is not None
            tokens.append(Token(kind, found.group(), position, end))
        position = end
    tokens.append(Token(END, "", length, length))
    return lexed


def _unit_follows(before: Token) -> bool:
    return before.kind == NUMBER or before.text == "}" or (before.kind == WORD and before.text == "Real")


def _foreign(source: Source, lexed: Lexed, start: int) -> int:
    from lagc.syntax.mistakes.characters import foreign_character  # where there is a fault

    return foreign_character(source, lexed, start)


def _unit(source: Source, lexed: Lexed, start: int) -> int:
    found = _UNIT.match(source.text, start)
    if found is None:
        found = _UNIT_START.match(source.text, start)
        assert found is not None  # it begins with the bracket
        end = start + len(found.group().rstrip())
        lexed.faults.append(
            Fault(
                "LAG0104",
                "this unit is not closed",
                Span(source, start, end),
                remedy=f"write `{source.text[start:end]}]`" if end > start + 1 else "close it with `]`",
            )
        )
        lexed.tokens.append(Token(UNIT, source.text[start:end] + "]", start, end))
        return end
    lexed.tokens.append(Token(UNIT, found.group(), start, found.end()))
    return found.end()


def _unclosed(source: Source, lexed: Lexed, opening: str, start: int) -> int:
    """Report an unclosed comment, which ends with the file, or text, which ends with its line."""
    text = source.text
    if opening == "/*":
        span = Span(source, start, start + 2)
        lexed.faults.append(Fault("LAG0103", "this comment is not closed", span, remedy="close it with `*/`"))
        return len(text)
    newline = text.find("\n", start)
    end = len(text) if newline < 0 else newline
    line = text[start:end].rstrip()
    line = line[:-1].rstrip() if line.endswith(";") else line
    end = start + len(line)
    span = Span(source, start, end)
    message = "this text is not closed on its line"
    lexed.faults.append(Fault("LAG0102", message, span, remedy='close it with `"`'))
    lexed.tokens.append(Token(STRING, line + '"', start, end))
    return end
