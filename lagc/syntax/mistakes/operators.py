"""Mistakes with operators and comparisons, and expressions of other languages."""

from __future__ import annotations

import re

from lagc.diagnostics.faults import Fault
from lagc.diagnostics.suggest import foreign
from lagc.syntax.mistakes.context import Explained, Repair, Where, token_of
from lagc.syntax.tokens import END, NUMBER, SYMBOL, WORD, Token

_BRACKETS = {"(": 1, "[": 1, "{": 1, ")": -1, "]": -1, "}": -1}
_LONGEST = 60  # characters of an expression that a remedy repeats
_ARGUMENTS = re.compile(r"\s*\(\s*\w+\s*=[^=].*$")
_FUNCTIONS = {
    "def": re.compile(r"def\s+(\w+)\s*\(([^()]*)\)\s*:\s*return\s+([^\n;]+)"),
    "lambda": re.compile(r"lambda\s+([\w\s,]*):\s*([^\n;]+)"),
}
_VECTORS = frozenset({"{", "velocity", "position", "acceleration", "cross", "momentum", "angular_velocity"})
FUNCTIONS = frozenset({
    "sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "exp", "log", "sqrt", "abs", "norm",
    "der", "velocity", "position",
})  # fmt: skip


def foreign_operator(w: Where) -> Explained | None:
    text = w.token.text
    if w.token.kind != SYMBOL or text not in foreign("operators"):
        return None
    message = f"`{text}` is not an operator of the language"
    special = _bars(w) if text in ("|", "||") else _assignment(w) if text[-1] == "=" else None
    special = _remainder(w) if text == "%" else special
    if special is not None:
        first, last, remedy, repair = special
        return Explained(Fault("LAG0117", message, w.span(first, last), remedy=remedy), repair)
    if text == "...":
        remedy = "leave it out: a declaration ends with `;`, and may have several lines"
        return Explained(Fault("LAG0117", message, w.span(w.token), remedy=remedy), w.replace())
    ours = foreign("operators")[text]
    return Explained(Fault("LAG0117", message, w.span(w.token), remedy=f"write `{ours}`"), w.replace(ours))


Special = tuple[Token, Token, str, Repair | None]


def _bars(w: Where) -> Special | None:
    """Explain `|x|` and `||v||`."""
    if not w.accepts("NUMBER"):
        return None
    last = w.position + 1
    while w.tokens[last].kind != END and w.tokens[last].text not in (w.token.text, ";"):
        last += 1
    inner = w.tokens[w.position + 1 : last]
    if w.tokens[last].text != w.token.text or not inner:
        return None
    function = "norm" if inner[0].text in _VECTORS or w.token.text == "||" else "abs"
    start = w.token.start
    words = (token_of(function, start), token_of("(", start), *inner, token_of(")", inner[-1].end))
    remedy = f"write `{function}({w.span(inner[0], inner[-1]).text})`"
    return w.token, w.tokens[last], remedy, Repair(w.position, last + 1 - w.position, words)


def _assignment(w: Where) -> Special | None:
    """Explain `n := 2` in a `when` clause, and `n += 1`."""
    text, in_when = w.token.text, w.block is not None and w.block.closing == "when"
    if text in ("!=", "~=") or (text == ":=" and not in_when):
        return None
    left = w.source.text[: w.token.start].replace("then", ";").rpartition(";")[2].strip()
    right = w.source.text[w.token.end :].partition(";")[0].strip()
    if text != ":=":
        simple = re.fullmatch(r"[\w.]+|\(.*\)", right) or text == "+="
        right = f"{left} {text[0]} {right if simple else f'({right})'}"
    short = len(left + right) <= _LONGEST and "\n" not in left + right
    if not in_when:
        return w.token, w.token, f"write `{left} = {right}`" if short else "write `x = x + 1`", None
    remedy = f"write `reinit({left}, {right});`" if short else "write `reinit(state, value);`"
    return w.token, w.token, remedy, None


def _remainder(w: Where) -> Special | None:
    """Explain `a % b`."""
    after = w.tokens[w.position + 1]
    plain = w.before.kind in (WORD, NUMBER) and after.kind in (WORD, NUMBER)
    if not plain or w.tokens[w.position + 2].text in ("(", ".", "^", "["):
        return w.token, w.token, "write `mod(a, b)` for the remainder of `a/b`", None
    words = [token_of(text, w.before.start) for text in ("mod", "(", ",", ")")]
    repair = Repair(w.position - 1, 3, (words[0], words[1], w.before, words[2], after, words[3]))
    return w.token, w.token, f"write `mod({w.before.text}, {after.text})`", repair


def power_of_function(w: Where) -> Explained | None:
    """Explain `sin^2(x)`, `sin^2 x` and `sin^-1(x)`."""
    inverse = w.tokens[w.position - 2].text == "-"
    at = w.position - (4 if inverse else 3)
    if at < w.begin or w.tokens[at].text not in FUNCTIONS or w.tokens[at + 1].text != "^":
        return None
    if w.before.kind != NUMBER or (w.token.text != "(" and w.token.kind != WORD):
        return None
    last, depth = w.position, _BRACKETS.get(w.token.text, 0)
    while depth and w.tokens[last].kind != END:
        last += 1
        depth += _BRACKETS.get(w.tokens[last].text, 0)
    name, argument = w.tokens[at].text, w.span(w.token, w.tokens[last]).text
    argument = argument if w.token.text == "(" else f"({argument})"
    power = f"^{'(-' * inverse}{w.before.text}{')' * inverse}"
    arc = inverse and w.before.text == "1" and name in ("sin", "cos", "tan")
    written = f"a{name}{argument}" if arc else f"{name}{argument}{power}"
    message = f"the power of a function follows its argument, not `{name}`"
    fault = Fault("LAG0130", message, w.span(w.tokens[at], w.token), remedy=f"write `{written}`")
    inner = w.tokens[w.position : last + 1]
    if w.token.text != "(":
        inner = [token_of("(", w.token.start), *inner, token_of(")", w.token.end)]
    exponent = [] if arc else [w.tokens[at + 1], w.before]
    ours = token_of(f"a{name}", w.tokens[at].start) if arc else w.tokens[at]
    return Explained(fault, Repair(at, last + 1 - at, (ours, *inner, *exponent)))


def python_function(w: Where) -> Explained | None:
    """Explain `def f(x): return x^2` and `f = lambda x: x^2`."""
    near = w.tokens[w.begin : w.position + 3]
    word = next((token for token in near if token.text in ("def", "lambda")), None)
    found = None if word is None else _FUNCTIONS[word.text].match(w.source.text, word.start)
    if found is None or word is None:
        return None
    name, names, value = found.groups() if word.text == "def" else (w.first.text, *found.groups())
    name = w.tokens[w.begin + 1].text if name in w.keywords else name
    arguments = ", ".join(f"Real {word.strip()}" for word in names.split(",") if word.strip())
    message = f"`{word.text}` is not a keyword of the language"
    remedy = f"write `function {name}({arguments}) = {value.strip()};`, with the types of its arguments"
    return Explained(Fault("LAG0118", message, w.span(word), remedy=remedy))


def comparison_for_equation(w: Where) -> Explained | None:
    text = w.token.text
    if w.token.kind != SYMBOL:
        return None
    if text == "==" and w.accepts("EQUALS"):
        message = "`==` compares two values; a declaration uses a single `=`"
        return Explained(Fault("LAG0115", message, w.span(w.token), remedy="write `=`"), w.replace("="))
    if text in ("<", ">", "<>") and w.first.text == "constraint" and w.accepts("EQUALS"):
        message = f"a constraint uses `=`, `>=` or `<=`, not `{text}`"
        remedy = None if text == "<>" else f"write `{text}=`"
        repair = None if text == "<>" else w.replace(text + "=")
        return Explained(Fault("LAG0115", message, w.span(w.token), remedy=remedy), repair)
    return None


def equation_for_comparison(w: Where) -> Explained | None:
    if w.token.text != "=" or not w.accepts(w.sign("==")):
        return None
    words = {token.text for token in w.tokens[w.begin : w.position] if token.kind == WORD}
    if not words & {"if", "elseif", "when"}:
        return None
    message = "a condition compares with `==`"
    return Explained(Fault("LAG0116", message, w.span(w.token), remedy="write `==`"), w.replace("=="))


def chained(w: Where) -> Explained | None:
    if w.token.text == "^":
        message = "`a^b^c` is ambiguous"
        return Explained(Fault("LAG0126", message, w.span(w.token), remedy="write `a^(b^c)` or `(a^b)^c`"))
    if w.token.text in ("<", "<=", ">", ">=", "==", "<>") and not w.accepts("EQUALS"):
        depth = 0
        for token in reversed(w.tokens[w.begin : w.position]):
            depth -= _BRACKETS.get(token.text, 0)
            if depth < 0 or token.text in ("and", "or", "if", "elseif", "then", "else", ",", "="):
                break
            if depth == 0 and token.text in ("<", "<=", ">", ">=", "==", "<>"):
                message = "comparisons cannot be chained"
                fault = Fault(
                    "LAG0126", message, w.span(w.token),
                    related=((w.span(token), "the first comparison"),),
                    remedy=_two_bounds(w, token) or "join two comparisons with `and`",
                )  # fmt: skip
                return Explained(fault)
    return None


def _two_bounds(w: Where, first: Token) -> str | None:
    """Return how to write the constraint a <= b <= c, whose first comparison is `first`."""
    colon = next((x for x in w.tokens[w.begin : w.position] if x.text == ":"), None)
    if w.first.text != "constraint" or colon is None:
        return None
    name = w.source.text[w.first.end : colon.start].strip()
    left, middle, right = (
        w.source.text[start:end].strip()
        for start, end in (
            (colon.end, first.start),
            (first.end, w.token.start),
            (w.token.end, len(w.source.text)),
        )
    )
    last = right.partition(";")[0]
    found = _ARGUMENTS.search(last)
    own, bound = (found[0], last[: found.start()]) if found else ("", last)  # arguments belong to both
    bounds = f"{left} {first.text} {middle}{own}", f"{middle} {w.token.text} {bound}{own}"
    if any("\n" in bound or len(bound) > 60 for bound in bounds):
        return "write two constraints, one for each bound"
    return (
        f"write two constraints: `constraint {name}_1: {bounds[0]};` and `constraint {name}_2: {bounds[1]};`"
    )
