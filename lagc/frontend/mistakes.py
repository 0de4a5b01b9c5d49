"""What a person who wrote this most likely meant: syntax mistakes in the user's terms.

`explain` asks the functions of `_TABLE` in turn; the first that knows the mistake answers.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from lagc.diagnostics.faults import Fault, Span
from lagc.frontend.foreign import FOREIGN, OPERATORS, looks_like_unit
from lagc.frontend.lexer import END, NUMBER, STRING, SYMBOL, UNIT, WORD, Token
from lagc.records import dataclass

if TYPE_CHECKING:
    from lagc.frontend.recovery import Recovery

_CLOSING = {"(": ")", "[": "]", "{": "}"}
_OPENING = {closing: opening for opening, closing in _CLOSING.items()}
_OPERATORS = frozenset(("<=", ">=", "==", "<>", *"=+-*/^<>,:({["))
_HEADERS = frozenset(("model", "package", "effect", "scene", "for", "when"))


@dataclass(frozen=True, slots=True)
class Repair:
    """Replace `count` tokens from number `at` on by others; then the text reads on."""

    at: int
    count: int
    others: tuple[Token, ...]


@dataclass(frozen=True, slots=True)
class Explained:
    fault: Fault
    repair: Repair | None = None


class Where:
    """The place of a mistake: a token that cannot stand there, in the declaration that begins with
    token number `begin`."""

    def __init__(self, recovery: Recovery, begin: int, brackets: Sequence[Token]):
        machine = recovery.machine
        self.source = machine.source
        self.tokens = machine.tokens
        self.keywords = machine.tables.keywords
        self.signs = machine.tables.symbols
        self.block = machine.blocks[-1] if machine.blocks else None
        self.accepts = recovery.accepts
        self.position = machine.position
        self.begin = begin
        self.brackets = brackets  # that are open
        self.token = self.tokens[self.position]
        self.before = self.tokens[max(self.position - 1, 0)]
        self.first = self.tokens[begin]
        self.inside = begin < self.position  # a declaration has begun

    def span(self, first: Token, last: Token | None = None) -> Span:
        return Span(self.source, first.start, (last or first).end)

    def sign(self, text: str) -> str:
        """The terminal of a sign."""
        return self.signs[text]

    def new_line(self) -> bool:
        """Does the token stand on a later line than the one before it?"""
        return "\n" in self.source.text[self.before.end : self.token.start] or self.token.kind == END

    def replace(self, *texts: str) -> Repair:
        return Repair(self.position, 1, self._tokens(texts))

    def insert(self, *texts: str) -> Repair:
        return Repair(self.position, 0, self._tokens(texts))

    def replace_first(self, *texts: str) -> Repair:
        return Repair(self.begin, 1, tuple(_token(text, self.first.start) for text in texts))

    def _tokens(self, texts: Sequence[str]) -> tuple[Token, ...]:
        return tuple(_token(text, self.token.start) for text in texts)


def _token(text: str, at: int) -> Token:
    kind = WORD if text[0].isalpha() else UNIT if text[0] == "[" and len(text) > 1 else SYMBOL
    return Token(kind, text, at, at)


def explain(where: Where) -> Explained:
    """The fault at a token that cannot stand where it does."""
    for known in _TABLE:
        explained = known(where)
        if explained is not None:
            return explained
    return _anything_else(where)


# -- the table ---------------------------------------------------------------------------


def _foreign_operator(w: Where) -> Explained | None:
    if w.token.kind != SYMBOL or w.token.text not in OPERATORS:
        return None
    ours = OPERATORS[w.token.text]
    message = f"`{w.token.text}` is no operator of the language"
    if ours is None:
        return Explained(Fault("LAG0117", message, w.span(w.token)))
    fault = Fault("LAG0117", message, w.span(w.token), remedy=f"write `{ours}`")
    return Explained(fault, w.replace(ours))


def _comparison_for_equation(w: Where) -> Explained | None:
    text = w.token.text
    if w.token.kind != SYMBOL:
        return None
    if text == "==" and w.accepts("EQUALS"):
        message = "`==` compares; here stands a single `=`"
        return Explained(Fault("LAG0115", message, w.span(w.token), remedy="write `=`"), w.replace("="))
    if text in ("<", ">", "<>") and w.first.text == "constraint" and w.accepts("EQUALS"):
        message = f"a constraint is an equation, or an inequality with `>=` or `<=`, and not `{text}`"
        remedy = None if text == "<>" else f"write `{text}=`"
        repair = None if text == "<>" else w.replace(text + "=")
        return Explained(Fault("LAG0115", message, w.span(w.token), remedy=remedy), repair)
    return None


def _equation_for_comparison(w: Where) -> Explained | None:
    if w.token.text != "=" or not w.accepts(w.sign("==")):
        return None
    words = {token.text for token in w.tokens[w.begin : w.position] if token.kind == WORD}
    if not words & {"if", "elseif", "when"}:
        return None
    message = "a condition compares with `==`"
    return Explained(Fault("LAG0116", message, w.span(w.token), remedy="write `==`"), w.replace("=="))


def _decimal_comma(w: Where) -> Explained | None:
    if w.token.kind != NUMBER or w.before.text != "," or w.position < 2:
        return None
    whole = w.tokens[w.position - 2]
    if whole.kind != NUMBER or whole.end != w.before.start or w.before.end != w.token.start:
        return None
    number = _token("0", whole.start)
    number.kind, number.text, number.end = NUMBER, f"{whole.text}.{w.token.text}", w.token.end
    fault = Fault(
        "LAG0105",
        "decimals stand behind a point",
        w.span(whole, w.token),
        remedy=f"write `{number.text}`",
    )
    return Explained(fault, Repair(w.position - 2, 3, (number,)))


def _chained(w: Where) -> Explained | None:
    if w.token.text == "^":
        message = "powers of powers need parentheses: `a^b^c` may mean two things"
        return Explained(Fault("LAG0126", message, w.span(w.token), remedy="write `a^(b^c)` or `(a^b)^c`"))
    if w.token.text in ("<", "<=", ">", ">=", "==", "<>") and not w.accepts("EQUALS"):
        depth = 0
        for token in reversed(w.tokens[w.begin : w.position]):
            depth += (token.text in _OPENING) - (token.text in _CLOSING)
            if depth < 0 or token.text in ("and", "or", "if", "elseif", "then", "else", ",", "="):
                break
            if depth == 0 and token.text in ("<", "<=", ">", ">=", "==", "<>"):
                message = "comparisons do not chain"
                fault = Fault(
                    "LAG0126", message, w.span(w.token),
                    related=((w.span(token), "the first comparison"),),
                    remedy="join two comparisons with `and`",
                )  # fmt: skip
                return Explained(fault)
    return None


def _bare_unit(w: Where) -> Explained | None:
    if w.token.kind != WORD or w.before.kind != NUMBER or w.new_line() or not looks_like_unit(w.token.text):
        return None
    # A unit may be a product: `9.81 m/s2`.
    last = w.position
    tokens = w.tokens
    while (
        tokens[last + 1].text in ("/", ".", "*")
        and tokens[last + 2].kind == WORD
        and looks_like_unit(tokens[last + 2].text)
        and tokens[last + 2].end - tokens[last].end == 1 + len(tokens[last + 2].text)
    ):
        last += 2
    unit = "".join("." if t.text == "*" else t.text for t in tokens[w.position : last + 1])
    fault = Fault(
        "LAG0121",
        "a unit stands in brackets",
        w.span(w.token, tokens[last]),
        remedy=f"write `{w.before.text} [{unit}]`",
    )
    return Explained(fault, Repair(w.position, last + 1 - w.position, (_token(f"[{unit}]", w.token.start),)))


def _unit_behind_expression(w: Where) -> Explained | None:
    if w.token.kind != UNIT and not (w.token.text == "[" and w.before.text in (")", "]")):
        return None
    message = "a unit stands behind a number or a vector in braces, or behind `Real`"
    return Explained(Fault("LAG0121", message, w.span(w.token)))


def _first_word(w: Where) -> Explained | None:
    """A declaration that begins with a word that is no keyword: another language's, capital, misspelt."""
    word = w.first.text
    if w.first.kind != WORD or word in w.keywords:
        return None
    if w.inside and w.tokens[w.begin + 1].text in (".", "[", "="):
        return None
    foreign = FOREIGN.get(word.lower())
    if foreign is not None:
        message = f"`{word}` is no word of the language"
        fault = Fault("LAG0118", message, w.span(w.first), remedy=foreign.remedy)
        repair = None if foreign.ours is None else w.replace_first(*foreign.ours)
        return Explained(fault, repair)
    if w.tokens[w.begin + 1].kind != WORD:
        return None
    if word.lower() in w.keywords:
        message = f"keywords are written in small letters: `{word.lower()}`"
        fault = Fault("LAG0119", message, w.span(w.first), remedy=f"write `{word.lower()}`")
        return Explained(fault, w.replace_first(word.lower()))
    from lagc.diagnostics.suggest import closest

    near = closest(word, w.keywords)
    if near is None or not w.inside:
        return None
    message = f"`{word}` is no keyword"
    fault = Fault("LAG0119", message, w.span(w.first), remedy=f"did you mean `{near}`?")
    return Explained(fault, w.replace_first(near))


def _brackets(w: Where) -> Explained | None:
    text = w.token.text if w.token.kind == SYMBOL else ""
    if text in _OPENING:
        if not w.brackets:
            if w.first.text in ("model", "package", "effect", "scene") or not w.inside:
                message, remedy = "blocks are closed by `end name;`", None
            else:
                message, remedy = f"nothing is open for this `{text}`", "delete it"
            return Explained(Fault("LAG0114", message, w.span(w.token), remedy=remedy), w.replace())
        opening = w.brackets[-1]
        if _CLOSING[opening.text] != text and w.accepts(w.sign(_CLOSING[opening.text])):
            right = _CLOSING[opening.text]
            message = f"this `{text}` cannot close that `{opening.text}`"
            outer = any(_CLOSING[bracket.text] == text for bracket in w.brackets[:-1])
            fault = Fault(
                "LAG0114", message, w.span(w.token), related=((w.span(opening), "opened here"),),
                remedy=f"write `{right}{text}`" if outer else f"write `{right}`",
            )  # fmt: skip
            return Explained(fault, w.insert(right) if outer else w.replace(right))
        return None
    ends = w.token.kind == END or text == ";" or (w.token.kind == WORD and w.new_line())
    if w.brackets:
        opening = w.brackets[-1]
        right = _CLOSING[opening.text]
        # `m(min = 0 = 1 [kg]`: what stands there could stand behind the bracket.
        follows = text in w.signs and w.accepts(w.sign(right), w.sign(text))
        if not w.accepts(w.sign(right)) or not (ends or follows):
            return None
        message = f"this `{opening.text}` is not closed"
        fault = Fault(
            "LAG0114", message, w.span(opening),
            related=((w.span(w.token), f"a `{right}` is missing before this"),),
            remedy=f"close it with `{right}`",
        )  # fmt: skip
        return Explained(fault, w.insert(right))
    return None


def _semicolon_too_many(w: Where) -> Explained | None:
    if w.token.text != ";" or w.token.kind != SYMBOL:
        return None
    header = w.tokens[max(w.position - 2, 0)].text in _HEADERS
    if w.before.text in ("then", "loop", "else") or header:
        message = f"no `;` stands after `{w.before.text}`"
    elif not w.inside:
        message = "this `;` ends nothing"
    else:
        return None
    return Explained(Fault("LAG0124", message, w.span(w.token), remedy="delete it"), w.replace())


def _missing_end_word(w: Where) -> Explained | None:
    """`room;` where `end room;` is meant."""
    if w.token.text != ";" or w.position - w.begin != 1 or w.block is None or w.first.text != w.block.closing:
        return None
    message = f"an `end` is missing before `{w.first.text}`"
    opened = ((w.block.span(w.source), "opened here"),)
    fault = Fault("LAG0112", message, w.span(w.first), opened, f"write `end {w.first.text};`")
    return Explained(fault, Repair(w.begin, 0, (_token("end", w.first.start),)))


def _stray_end(w: Where) -> Explained | None:
    if w.inside or w.token.text != "end":
        return None
    return Explained(Fault("LAG0113", "nothing is open that this `end` could close", w.span(w.token)))


def _brace_for_block(w: Where) -> Explained | None:
    if w.token.text == "{" and w.first.text == "for" and w.accepts("LOOP"):
        return Explained(_loop_fault(w), w.replace("loop"))
    if w.first.text != "{" or w.begin < 2 or w.tokens[w.begin - 2].text not in _HEADERS:
        return None
    message = "blocks stand between their first line and `end name;`, without braces"
    fault = Fault("LAG0114", message, w.span(w.first), remedy="delete it")
    return Explained(fault, Repair(w.begin, 1, ()))


def _comma_in_list(w: Where) -> Explained | None:
    """`uses a b;` reads as if the body of the scene began with `b`."""
    at = w.begin - 1
    if not w.inside or w.first.kind != WORD or at < 1 or w.tokens[at].kind != WORD:
        return None
    while at > 0 and (w.tokens[at].kind == WORD or w.tokens[at].text == ","):
        if w.tokens[at].text == "uses":
            message = f"a `,` is missing between `{w.tokens[w.begin - 1].text}` and `{w.first.text}`"
            span = w.span(w.tokens[w.begin - 1], w.first)
            fault = Fault("LAG0130", message, span, remedy="names in a list stand apart by `,`")
            comma = _token(",", w.first.start)
            return Explained(fault, Repair(w.begin - 1, 1, (w.tokens[w.begin - 1], comma)))
        at -= 1
    return None


def _missing_semicolon(w: Where) -> Explained | None:
    if not w.inside or not w.accepts("SEMICOLON"):
        return None
    if not w.new_line() and not (w.token.kind == WORD and w.token.text in w.keywords):
        return None
    if w.token.kind == SYMBOL:
        return None
    at = Span(w.source, w.before.end, w.before.end)
    fault = Fault("LAG0111", "a `;` is missing", at, remedy="end the declaration with `;`")
    return Explained(fault, w.insert(";"))


def _load_target(w: Where) -> Explained | None:
    kind = w.first.text
    right = {"force": "AT", "torque": "ON"}.get(kind)
    if right is None or not w.accepts(right) or (w.before.kind == NUMBER and w.before.end == w.token.start):
        return None
    needed = right.lower()
    shown = "a force acts `at` a point" if kind == "force" else "a torque acts `on` a body"
    example = "force F = vector at point;" if kind == "force" else "torque M = vector on body;"
    other = w.token.text in ("at", "on")
    remedy = f"write `{needed}`" if other else None
    fault = Fault("LAG0127", f"{shown}: `{example}`", w.span(w.token), remedy=remedy)
    return Explained(fault, w.replace(needed) if other else None)


def _loop_fault(w: Where) -> Fault:
    message = "a `loop` is missing: `for i in 1:n loop ... end for;`"
    return Fault("LAG0128", message, w.span(w.token))


def _missing_word(w: Where) -> Explained | None:
    if w.first.text == "for" and w.accepts("LOOP"):
        return Explained(_loop_fault(w), w.insert("loop"))
    if w.first.text == "for" and w.accepts("IN"):
        message = "an `in` is missing: `for i in 1:n loop ... end for;`"
        repair = w.replace("in") if w.token.text == "=" else w.insert("in")
        return Explained(Fault("LAG0128", message, w.span(w.token)), repair)
    for word in ("then", "else"):
        if w.accepts(word.upper()):
            message = f"an `{word}` is missing" if word == "else" else "a `then` is missing"
            whole = "`if condition then value else other`"
            fault = Fault("LAG0128", f"{message}: {whole}", w.span(w.token))
            return Explained(fault, w.insert(word) if word == "then" else None)
    return None


def _constraint_parts(w: Where) -> Explained | None:
    if w.first.text != "constraint":
        return None
    form = "`constraint name: left = right;`"
    if w.accepts("COLON") and w.position - w.begin == 2:
        return Explained(Fault("LAG0129", f"a constraint has a name: {form}", w.span(w.token)))
    if w.accepts("EQUALS") and w.token.text == ";":
        return Explained(Fault("LAG0129", f"a constraint has two sides: {form}", w.span(w.token)))
    return None


def _description_last(w: Where) -> Explained | None:
    if w.before.kind != STRING or w.token.text not in ("=", "(", "[", "at", "on", "unless", ":", "uses"):
        return None
    message = "the description stands last, right before the `;` or the `,`"
    return Explained(Fault("LAG0125", message, w.span(w.before)))


def _missing_sign(w: Where) -> Explained | None:
    """`body b Particle(...)`, `coordinate Angle a b`."""
    if w.new_line() or w.before.kind != WORD or (w.token.kind == SYMBOL and w.token.text != "{"):
        return None
    if not w.accepts("EQUALS") or w.accepts("TIMES") or not w.inside:
        return None
    span = w.span(w.before, w.token)
    if w.accepts("COMMA"):
        message = f"a sign is missing between `{w.before.text}` and `{w.token.text}`"
        return Explained(Fault("LAG0130", message, span, remedy="a `,` or a `=` stands there"))
    message = f"a `=` is missing between `{w.before.text}` and `{w.token.text}`"
    return Explained(Fault("LAG0130", message, span, remedy="write `=`"), w.insert("="))


def _missing_operator(w: Where) -> Explained | None:
    operand = w.token.kind in (WORD, NUMBER) or w.token.text in ("(", "{")
    if not operand or w.new_line() or not w.accepts("TIMES") or w.before.kind == STRING:
        return None
    if w.token.kind == WORD and w.token.text in w.keywords:
        return None
    message = f"an operator is missing between `{w.before.text}` and `{w.token.text}`"
    remedy = f"to multiply write `{w.before.text}*{w.token.text}`"
    return Explained(Fault("LAG0130", message, w.span(w.before, w.token), remedy=remedy), w.insert("*"))


def _missing_value(w: Where) -> Explained | None:
    if not w.accepts("NUMBER") or w.before.text not in _OPERATORS or w.before.kind != SYMBOL:
        return None
    shown = "the end of the file" if w.token.kind == END else f"`{w.token.text}`"
    message = f"a value is missing between `{w.before.text}` and {shown}"
    return Explained(Fault("LAG0131", message, w.span(w.before, w.token)))


def _missing_name(w: Where) -> Explained | None:
    if not w.inside or not w.accepts("NAME") or w.accepts("NUMBER") or w.accepts("SEMICOLON"):
        return None
    what = f"after `{w.before.text}`"
    shown = "the end of the file" if w.token.kind == END else f"`{w.token.text}`"
    return Explained(Fault("LAG0132", f"a name is missing {what}; {shown} is none", w.span(w.token)))


_TABLE: tuple[Callable[[Where], Explained | None], ...] = (
    _foreign_operator,
    _comma_in_list,
    _brace_for_block,
    _first_word,
    _comparison_for_equation,
    _equation_for_comparison,
    _decimal_comma,
    _chained,
    _semicolon_too_many,
    _missing_end_word,
    _stray_end,
    _bare_unit,
    _brackets,
    _load_target,
    _missing_word,
    _constraint_parts,
    _description_last,
    _missing_semicolon,
    _missing_operator,
    _missing_sign,
    _unit_behind_expression,
    _missing_value,
    _missing_name,
)


def _anything_else(w: Where) -> Explained:
    shown = "the end of the file" if w.token.kind == END else f"`{w.token.text}`"
    if not w.inside:
        message = f"{shown} begins no declaration"
        begins = "one begins with a keyword (`parameter`, `body`, ...) or the name of a model"
        return Explained(Fault("LAG0110", message, w.span(w.token), remedy=begins))
    if w.accepts("SEMICOLON"):
        remedy: str | None = "is a `;` or an operator missing?"
    else:
        remedy = None
    message = f"{shown} cannot stand after `{w.before.text}`"
    return Explained(Fault("LAG0110", message, w.span(w.token), remedy=remedy))
