"""From text to tokens.

The lexer does not distinguish keywords from names; the parser does.  A bracket after a number, a `}` or the
word `Real` is a unit, any other bracket begins subscripts.  The last part explains characters that the
language does not use: Greek letters, signs of other alphabets, LaTeX, primes.
"""

import re
from collections.abc import Callable

from lagc.base.records import dataclass
from lagc.diagnostics.faults import Fault, Source, Span
from lagc.diagnostics.suggest import fill_template, foreign, remedy_of

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
        matched = match(text, position)
        assert matched is not None  # `odd` takes any character
        kind = matched.lastgroup
        end = matched.end()
        # Blanks and words are most of a text: their branches come first.
        if kind == "blank":
            pass
        elif kind == "word":
            word = matched.group()
            if not word.isascii():
                lexed.faults.append(_foreign_word(source, word, position))
            tokens.append(Token(WORD, word, position, end))
        # `[` begins a unit behind a number or a closing bracket; elsewhere it is a subscript.
        elif kind == "symbol":
            symbol = matched.group()
            if symbol == "[" and tokens and _unit_follows(tokens[-1]):
                end = _unit(source, lexed, position)
            elif symbol in _UNKNOWN:
                end = _foreign_character(source, lexed, position)
            else:
                tokens.append(Token(SYMBOL, symbol, position, end))
        elif kind == "comment":
            lexed.comments.append(Token("comment", matched.group(), position, end))
        elif kind == "unclosed":
            end = _end_unclosed(source, lexed, matched.group(), position)
        elif kind == "odd":
            end = end if matched.group() in _BLANKS else _foreign_character(source, lexed, position)
        else:
            assert kind is not None
            tokens.append(Token(kind, matched.group(), position, end))
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
        message = "this unit is not closed"
        remedy = f"write `{source.text[start:end]}]`" if end > start + 1 else "close it with `]`"
        lexed.faults.append(Fault("LAG0104", message, Span(source, start, end), remedy=remedy))
        lexed.tokens.append(Token(UNIT, source.text[start:end] + "]", start, end))
        return end
    lexed.tokens.append(Token(UNIT, found.group(), start, found.end()))
    return found.end()


def _end_unclosed(source: Source, lexed: Lexed, opening: str, start: int) -> int:
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


_LATEX = re.compile(r"\\([A-Za-z]+)((?:\{[^{}\n]*(?:\{[^{}\n]*\}[^{}\n]*)*\})*)")
_EXPONENT = re.compile("[⁰¹²³⁴-⁹⁻]+")
_ARGUMENT = re.compile(r"\([^()]*\)")
_DEFINE = re.compile(r"#\s*define\s+(\w+)\s+([^\n;]*[^\s;])")
_BRACES = re.compile(r"\{([^{}]*(?:\{[^{}]*\}[^{}]*)*)\}")


def _foreign_word(source: Source, word: str, start: int) -> Fault:
    """Return the fault of a name with other letters than those of the language."""
    import unicodedata

    exponent = _EXPONENT.search(source.text, start, start + len(word))
    base = word if exponent is None else word[: exponent.start() - start]
    spelled = "".join(foreign("greek").get(character, character) for character in base)
    plain = unicodedata.normalize("NFKD", spelled)
    plain = "".join(c for c in plain if not unicodedata.combining(c))
    good = plain.isascii() and plain.isidentifier()
    remedy = f"write `{plain}`" if good else None
    if exponent is not None and (good or not plain):
        remedy = _power_remedy(source, plain, exponent)
    elif word in foreign("characters"):
        remedy = remedy_of(foreign("characters")[word])
    message = f"`{word}` is not a name; names consist of the letters A-Z and a-z, digits and `_`"
    return Fault("LAG0101", message, Span(source, start, start + len(word)), remedy=remedy)


def _foreign_character(source: Source, lexed: Lexed, start: int) -> int:
    """Report what begins with a character that the language does not use, and return its end."""
    character = source.text[start]
    explained = _EXPLAINED.get(character)
    end = explained(source, lexed, start) if explained is not None else None
    if end is not None:
        return end
    meant = foreign("signs").get(character)
    entry = foreign("characters").get(character) if meant is None else meant
    _report(source, lexed, start, start + 1, None if entry is None else remedy_of(entry))
    if meant is not None:
        lexed.tokens.append(Token(SYMBOL, meant, start, start + 1))
    return start + 1


def _report(source: Source, lexed: Lexed, start: int, end: int, remedy: str | None) -> int:
    text = source.text[start:end]
    shown = f"`{text}`" if text.isprintable() else f"the character U+{ord(text[0]):04X}"
    what = "a character" if len(text) == 1 else "a word"
    message = f"{shown} is not {what} of the language"
    lexed.faults.append(Fault("LAG0101", message, Span(source, start, end), remedy=remedy))
    return end


def _comment(source: Source, lexed: Lexed, start: int) -> int | None:
    """Skip the rest of a line after `#`, or after a `%` that ends or begins a declaration."""
    before = lexed.tokens[-1] if lexed.tokens else None
    operand = before is not None and before.text != ";" and "\n" not in source.text[before.end : start]
    if source.text[start] == "%" and operand:
        lexed.tokens.append(Token(SYMBOL, "%", start, start + 1))
        return start + 1
    defined = _DEFINE.match(source.text, start)
    remedy = f"write `constant Real {defined[1]} = {defined[2]};`" if defined else foreign("characters")["#"]
    _report(source, lexed, start, start + 1, remedy)
    newline = source.text.find("\n", start)
    return len(source.text) if newline < 0 else newline


def _quote(source: Source, lexed: Lexed, start: int) -> int | None:
    """Explain the rates `x'` and `x''`, the transpose `(...)'` and the text `'...'`."""
    text, end = source.text, start + 1
    before = lexed.tokens[-1] if lexed.tokens else None
    near = before is not None and before.end == start
    if before is not None and near and before.kind == WORD:
        while text[end : end + 1] == "'":
            end += 1
        order = end - start if end - start < 3 else 1
        return _report(source, lexed, start, end, f"write `{'der(' * order}{before.text}{')' * order}`")
    if before is not None and near and before.text in (")", "]", "}"):
        return _report(source, lexed, start, end, "leave it out: a vector is neither a row nor a column")
    closing = text.find("'", end, max(text.find("\n", end), end))
    if closing < 0:
        return None
    words = text[end:closing]
    _report(source, lexed, start, closing + 1, f'write `"{words}"`')
    lexed.tokens.append(Token(STRING, f'"{words}"', start, closing + 1))
    return closing + 1


def _latex(source: Source, lexed: Lexed, start: int) -> int | None:
    """Explain `\\theta`, `\\frac{1}{2}` and `\\dot{x}`."""
    found = _LATEX.match(source.text, start)
    if found is None:
        return None
    name, template = found[1], foreign("latex").get(found[1])
    if template is None or "{" not in template:
        end = found.end(1)
        return _report(source, lexed, start, end, remedy_of(name if template is None else template))
    parts = [" ".join(part.replace("\\", " ").split()) for part in _BRACES.findall(found[2])]
    line = fill_template(template, parts) if template.count("{") <= len(parts) else template
    return _report(source, lexed, start, found.end(), f"write `{line}`")


def _degrees(source: Source, lexed: Lexed, start: int) -> int | None:
    """Explain `30°`."""
    number = lexed.tokens[-1].text if lexed.tokens else ""
    if not number[:1].isdigit():
        return None
    return _report(source, lexed, start, start + 1, f"write `{number} [deg]`")


def _power(source: Source, lexed: Lexed, start: int) -> int | None:
    """Explain `s⁻²`."""
    found = _EXPONENT.match(source.text, start)
    return found and _report(source, lexed, start, found.end(), _power_remedy(source, "", found))


def _power_remedy(source: Source, base: str, exponent: re.Match[str]) -> str:
    """Return a remedy for `x²` and `sin²(x)`."""
    import unicodedata

    power = unicodedata.normalize("NFKD", exponent[0]).replace("\u2212", "-")
    power = f"({power})" if power.startswith("-") else power
    argument = _ARGUMENT.match(source.text, exponent.end())
    return f"write `{base}{argument[0] if argument and base else ''}^{power}`"


_EXPLAINED: dict[str, Callable[[Source, Lexed, int], int | None]] = {
    "#": _comment, "%": _comment, "'": _quote, "\\": _latex, "°": _degrees, "º": _degrees,
    "⁻": _power,
}  # fmt: skip
