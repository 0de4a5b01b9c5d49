"""From text to tokens.

The lexer does not distinguish keywords from names; the parser does.  A bracket after a number, a `}` or the
word `Real` is a unit, any other bracket begins subscripts.
"""

from __future__ import annotations

import re

from lagc.base.records import dataclass, replace
from lagc.diagnostics.faults import Fault, Source, Span

WORD, NUMBER, STRING, UNIT, SYMBOL, END = "word", "number", "string", "unit", "symbol", "end"


class Token:
    """One token: its kind, its text, and the characters start..end of the source. `terminal` is set by the
    parser (`NAME`, `PARAMETER`, ...)."""

    __slots__ = ("end", "kind", "start", "terminal", "text")

    def __init__(self, kind: str, text: str, start: int, end: int):
        self.kind = kind
        self.text = text
        self.start = start
        self.end = end
        self.terminal = ""

    def __repr__(self) -> str:
        return f"{self.kind} {self.text!r} at {self.start}"


@dataclass(frozen=True, slots=True)
class Lexed:
    """The tokens of a text (the last is of kind END), its comments, and the faults."""

    tokens: list[Token]
    comments: list[Token]
    faults: list[Fault]


_PATTERN = re.compile(
    r"""
    (?P<blank>[ \t\r\n\f]+)
  | (?P<comment>//[^\n]*|/\*.*?\*/)
  | (?P<word>[^\W\d]\w*)
  | (?P<number>(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)
  | (?P<string>"(?:[^"\\\n]|\\.)*")
  | (?P<unclosed>/\*|")
  | (?P<symbol>:=|==|<=|>=|<>|!=|\*\*|&&|\|\||\.[*/^]|\.\.\.?|[-+*/]=|[-+*/^=<>(){}\[\],;:.!%&|?@\#$~`'\\])
  | (?P<odd>.)
    """,
    re.VERBOSE | re.DOTALL,
)
_UNIT = re.compile(r"\[[^\[\]\n]*\]")
_UNIT_START = re.compile(r"\[[^\[\]\n,;)}]*")
_PRIMES = re.compile("'+")
_UNKNOWN = frozenset("?@#$~`'\\")  # no sign of any use here; the parser explains the other ones

# Characters that are typed or pasted instead of an ASCII character of the language.
_MEANT = {
    "−": "-", "–": "-", "—": "-", "·": "*", "×": "*", "⋅": "*", "∙": "*", "÷": "/",
    "∕": "/", "≤": "<=", "≥": ">=", "≠": "<>", "；": ";", "，": ",", "：": ":",
}  # fmt: skip
_BLANKS = frozenset(
    "\u00a0\u2000\u2001\u2002\u2003\u2004\u2005\u2006\u2007\u2008\u2009\u200a\u202f\u3000\v\x85\u2028\u2029"
)
_HINTS = {
    "²": "write `^2`",
    "³": "write `^3`",
    "°": "write the unit in brackets: `30 [deg]`",
    "“": 'write texts between straight quotes, "..."',
    "”": 'write texts between straight quotes, "..."',
    "„": 'write texts between straight quotes, "..."',
    "'": 'write texts between double quotes, "..."',
    "`": 'write texts between double quotes, "..."',
    "#": "comments begin with `//`",
    "?": "write `if condition then value else other`",
    "√": "write `sqrt(...)`",
    "½": "write `1/2`",
    "∞": "leave out the bound",
    "\ufeff": "delete it",
}
_GREEK_NAMES = """
    alpha beta gamma delta epsilon zeta eta theta theta iota kappa lambda mu mu nu xi omicron pi rho
    sigma sigma tau upsilon phi phi chi psi omega Gamma Delta Theta Lambda Xi Pi Sigma Phi Psi Omega
"""
_GREEK = dict(zip("αβγδεζηθϑικλμµνξοπρσςτυφϕχψωΓΔΘΛΞΠΣΦΨΩ", _GREEK_NAMES.split()))


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
                lexed.faults.append(_foreign_word(source, word, position))
            tokens.append(Token(WORD, word, position, end))
        elif kind == "symbol":
            symbol = found.group()
            if symbol == "[" and tokens and _unit_follows(tokens[-1]):
                end = _unit(source, lexed, position)
            elif symbol in _UNKNOWN:
                end = _unknown(source, lexed, symbol, position)
            else:
                tokens.append(Token(SYMBOL, symbol, position, end))
        elif kind == "comment":
            lexed.comments.append(Token("comment", found.group(), position, end))
        elif kind == "unclosed":
            end = _unclosed(source, lexed, found.group(), position)
        elif kind == "odd":
            _odd_character(source, lexed, found.group(), position)
        else:
            assert kind is not None
            tokens.append(Token(kind, found.group(), position, end))
        position = end
    tokens.append(Token(END, "", length, length))
    return lexed


def _unit_follows(before: Token) -> bool:
    return before.kind == NUMBER or before.text == "}" or (before.kind == WORD and before.text == "Real")


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


def _odd_character(source: Source, lexed: Lexed, character: str, start: int) -> None:
    if character in _BLANKS:
        return
    meant = _MEANT.get(character)
    if meant is None:
        lexed.faults.append(_odd(source, character, start))
        return
    lexed.faults.append(
        Fault(
            "LAG0101",
            f"`{character}` is not a character of the language",
            Span(source, start, start + 1),
            remedy=f"write `{meant}`",
        )
    )
    lexed.tokens.append(Token(SYMBOL, meant, start, start + 1))


def _odd(source: Source, character: str, start: int) -> Fault:
    shown = f"`{character}`" if character.isprintable() else f"the character U+{ord(character):04X}"
    return Fault(
        "LAG0101",
        f"{shown} is not a character of the language",
        Span(source, start, start + 1),
        remedy=_HINTS.get(character),
    )


def _unknown(source: Source, lexed: Lexed, character: str, start: int) -> int:
    """Report an unused character and return its end.  `x'` and `x''`, as equations print rates, give one
    fault; a `#` begins a comment."""
    if character == "'" and source.text[start - 1] == "'":
        return start + 1
    fault = _odd(source, character, start)
    before = lexed.tokens[-1] if lexed.tokens else None
    if character == "'" and before is not None and before.kind == WORD and before.end == start:
        primes = _PRIMES.match(source.text, start)
        assert primes is not None
        order = len(primes[0])
        rate = "der(" * order + before.text + ")" * order if order < 3 else f"der({before.text})"
        fault = replace(fault, span=Span(source, start, primes.end()), remedy=f"write `{rate}`")
    lexed.faults.append(fault)
    newline = source.text.find("\n", start) if character == "#" else start + 1
    return len(source.text) if newline < 0 else newline


def _foreign_word(source: Source, word: str, start: int) -> Fault:
    import unicodedata

    spelled = "".join(_GREEK.get(character, character) for character in word)
    plain = unicodedata.normalize("NFKD", spelled)
    plain = "".join(c for c in plain if not unicodedata.combining(c))
    good = plain.isascii() and plain.isidentifier()
    return Fault(
        "LAG0101",
        f"`{word}` is not a name; names consist of the letters A-Z and a-z, digits and `_`",
        Span(source, start, start + len(word)),
        remedy=f"write `{plain}`" if good else None,
    )
