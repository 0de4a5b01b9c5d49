"""Mistakes with operators, comparisons, brackets, separators and units."""

import re
from collections.abc import Sequence
from itertools import takewhile

from lagc.diagnostics.faults import Fault, Source, Span
from lagc.diagnostics.suggest import foreign, looks_like_unit, unit_symbol
from lagc.syntax.lexer import END, NUMBER, STRING, SYMBOL, UNIT, WORD, Token, tokenise
from lagc.syntax.mistakes import HEADERS, Explained, Repair, Where, explained, token_of

_BRACKETS = {"(": 1, "[": 1, "{": 1, ")": -1, "]": -1, "}": -1}
_LONGEST = 60  # characters of an expression that a remedy repeats
_ARGUMENTS = re.compile(r"\s*\(\s*\w+\s*=[^=].*$")
_FUNCTIONS = {
    "def": re.compile(r"def\s+(\w+)\s*\(([^()]*)\)\s*:\s*return\s+([^\n;]+)"),
    "lambda": re.compile(r"lambda\s+([\w\s,]*):\s*([^\n;]+)"),
}
_VECTORS = frozenset({"{", "velocity", "position", "acceleration", "cross", "momentum", "angular_velocity"})
_ENERGIES = {"potential": "V", "kinetic": "T", "lagrangian": "L", "dissipation": "D"}
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
        return explained("LAG0117", message, w.span(first, last), remedy, repair)
    if text == "...":
        remedy = "leave it out: a declaration ends with `;`, and may have several lines"
        return explained("LAG0117", message, w.span(w.token), remedy, w.replace())
    ours = foreign("operators")[text]
    return explained("LAG0117", message, w.span(w.token), f"write `{ours}`", w.replace(ours))


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
    text, in_when = w.token.text, w.block is not None and w.block.end_name == "when"
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
    inner = [*takewhile(lambda token: token.kind != END and token.text != ";", w.tokens[w.position + 1 :])]
    if text != ":=" or left != w.before.text or not inner:
        return w.token, w.token, remedy, None
    begin, comma, close = (token_of(mark, w.token.start) for mark in "(,)")
    words = (token_of("reinit", w.before.start), begin, w.before, comma, *inner, close)
    return w.token, w.token, remedy, Repair(w.position - 1, len(inner) + 2, words)


def step_by_one(w: Where) -> Explained | None:
    """Explain `n++;` and `n--;`."""
    sign = w.token.text
    if sign not in ("+", "-") or w.before.kind != WORD:
        return None
    after = w.tokens[w.position + 1]
    if after.text != sign or after.start != w.token.end:
        return None
    message = f"`{sign}{sign}` is not an operator of the language"
    remedy = f"write `reinit({w.before.text}, {w.before.text} {sign} 1);`"
    return Explained(Fault("LAG0117", message, w.span(w.token, after), remedy=remedy))


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
    return explained("LAG0118", message, w.span(word), remedy)


def comparison_for_equation(w: Where) -> Explained | None:
    text = w.token.text
    if w.token.kind != SYMBOL:
        return None
    if text == "==" and w.accepts("EQUALS"):
        message = "`==` compares two values; a declaration uses a single `=`"
        return explained("LAG0115", message, w.span(w.token), "write `=`", w.replace("="))
    if text in ("<", ">", "<>") and w.first.text == "constraint" and w.accepts("EQUALS"):
        message = f"a constraint uses `=`, `>=` or `<=`, not `{text}`"
        remedy = None if text == "<>" else f"write `{text}=`"
        repair = None if text == "<>" else w.replace(text + "=")
        return explained("LAG0115", message, w.span(w.token), remedy, repair)
    return None


def equation_for_comparison(w: Where) -> Explained | None:
    if w.token.text != "=" or not w.accepts(w.sign("==")):
        return None
    words = {token.text for token in w.tokens[w.begin : w.position] if token.kind == WORD}
    if not words & {"if", "elseif", "when"}:
        return None
    message = "a condition compares with `==`"
    return explained("LAG0116", message, w.span(w.token), "write `==`", w.replace("=="))


def chained_comparison(w: Where) -> Explained | None:
    if w.token.text == "^":
        message = "`a^b^c` is ambiguous"
        return explained("LAG0126", message, w.span(w.token), "write `a^(b^c)` or `(a^b)^c`")
    if w.token.text in ("<", "<=", ">", ">=", "==", "<>") and not w.accepts("EQUALS"):
        depth = 0
        for token in reversed(w.tokens[w.begin : w.position]):
            depth -= _BRACKETS.get(token.text, 0)
            if depth < 0 or token.text in ("and", "or", "if", "elseif", "then", "else", ",", "="):
                break
            if depth == 0 and token.text in ("<", "<=", ">", ">=", "==", "<>"):
                message = "comparisons cannot be chained"
                remedy = _two_bounds(w, token) or "join two comparisons with `and`"
                related = ((w.span(token), "the first comparison"),)
                return explained("LAG0126", message, w.span(w.token), remedy, related=related)
    return None


def _two_bounds(w: Where, first: Token) -> str | None:
    """Return how to write the constraint a <= b <= c, whose first comparison is `first`."""
    colon = next((x for x in w.tokens[w.begin : w.position] if x.text == ":"), None)
    if w.first.text != "constraint" or colon is None:
        return None
    name = w.source.text[w.first.end : colon.start].strip()
    text = w.source.text
    left, middle = text[colon.end : first.start].strip(), text[first.end : w.token.start].strip()
    right = text[w.token.end :].strip()
    last = right.partition(";")[0]
    found = _ARGUMENTS.search(last)
    own, bound = (found[0], last[: found.start()]) if found else ("", last)  # arguments belong to both
    bounds = f"{left} {first.text} {middle}{own}", f"{middle} {w.token.text} {bound}{own}"
    if any("\n" in bound or len(bound) > 60 for bound in bounds):
        return "write two constraints, one for each bound"
    return (
        f"write two constraints: `constraint {name}_1: {bounds[0]};` and `constraint {name}_2: {bounds[1]};`"
    )


CLOSING = {"(": ")", "[": "]", "{": "}"}
_FACTOR = re.compile(r"((?:[/.*]| )?)([A-Za-zµ°]+)((?:\^[-+]?)?\d*)")  # of a unit that is written bare
_LISTED = re.compile(r"\s*[-\w.]+(\s+[-\w.]+)+\s*$")  # `1 0 -2`, numbers or names with blanks between
_OPENING = {closing: opening for opening, closing in CLOSING.items()}
_OPERATORS = frozenset(("<=", ">=", "==", "<>", *"=+-*/^<>,:({["))


def decimal_comma(w: Where) -> Explained | None:
    at = w.position - (w.token.text != ",")  # at the unexpected comma, or before the unexpected number
    whole, comma, part = w.tokens[max(at - 1, 0)], w.tokens[at], w.tokens[min(at + 1, len(w.tokens) - 1)]
    if (whole.kind, comma.text, part.kind) != (NUMBER, ",", NUMBER):
        return None
    if whole.end != comma.start or comma.end != part.start or not (whole.text + part.text[:1]).isdigit():
        return None
    number = token_of("0", whole.start)
    number.kind, number.text, number.end = NUMBER, f"{whole.text}.{part.text}", part.end
    repair = Repair(at - 1, 3, (number,))
    remedy = f"write `{number.text}`"
    return explained("LAG0105", "decimals are written with a point", w.span(whole, part), remedy, repair)


def comma_between_starts(w: Where) -> Explained | None:
    """Explain `start x = 1, y = 2;`."""
    if w.token.text != "," or w.first.text != "start" or not w.accepts("SEMICOLON"):
        return None
    place, last = w.tokens[w.position + 1], w.position + 1
    while w.tokens[last].text not in ("=", ",", ";") and w.tokens[last].kind != END:
        last += 1
    if place.kind != WORD or w.tokens[last].text != "=":
        return None
    message, end = "each `start` sets one value", w.tokens[last - 1]
    another = w.source.text[place.start : end.end]
    repair = w.replace(";", "start")
    return explained("LAG0110", message, w.span(w.token, end), f"write `; start {another}`", repair)


def bare_unit(w: Where) -> Explained | None:
    """Explain `30 deg`, `9.81 m/s^2`, `1e3_N/m` and `1 (kg)`."""
    inside = w.token.text == "("
    first = w.position + inside
    start = w.tokens[first].start + w.tokens[first].text.startswith("_")
    if w.before.kind != NUMBER or w.new_line() or w.tokens[first].kind != WORD:
        return None
    # A unit is factors that look like units, joined by signs: read from the text, as the lexer knows no
    # units here.
    text, unit, end = w.source.text, "", start
    while (part := _FACTOR.match(text, end)) is not None and looks_like_unit(part[2]):
        if bool(unit) != bool(part[1]) or (part[1] == " " and "-" not in part[3]):
            break
        sign = "." if part[1] in ("*", " ") else part[1]
        unit, end = f"{unit}{sign}{unit_symbol(part[2])}{part[3]}", part.end()
    last = first
    while w.tokens[last].end < end:
        last += 1
    last += inside
    if not unit or w.tokens[last - inside].end != end or (inside and w.tokens[last].text != ")"):
        return None
    near = w.before.end == w.token.start or w.tokens[w.position - 2].text == "/"
    if near and _is_declared(w, w.tokens[first].text):
        return None  # `2l` and `1/2 m` are products
    remedy = f"write `{w.before.text} [{unit}]`"
    fault = Fault("LAG0121", "a unit is written in brackets", w.span(w.token, w.tokens[last]), remedy=remedy)
    repair = Repair(w.position, last + 1 - w.position, (token_of(f"[{unit}]", w.token.start),))
    return Explained(fault, repair)


def _is_declared(w: Where, name: str) -> bool:
    """Return whether a quantity of this name is declared: `Length l`, `Real[m] l`, `k = 1, l = 2`."""
    near = zip(w.tokens, w.tokens[1:], w.tokens[2:])
    return any(
        here.text == name
        and (
            (before.kind == WORD and before.text not in w.keywords)
            or (before.kind == UNIT and after.text in ("=", "(", ";", ","))
            or (before.text == "," and after.text == "=")
        )
        for before, here, after in near
    )


def unit_behind_expression(w: Where) -> Explained | None:
    if w.token.kind != UNIT and not (w.token.text == "[" and w.before.text in (")", "]")):
        return None
    message = "a unit follows a number, a vector in braces, or `Real`"
    return explained("LAG0121", message, w.span(w.token))


def vector_in_brackets(w: Where) -> Explained | None:
    """Explain `[x, 0, 0]` and `[1, 2; 3, 4]`."""
    if w.token.text != "[" or w.token.kind != SYMBOL or not w.accepts("LBRACE"):
        return None
    last, depth = w.position, 0
    while True:
        token = w.tokens[last]
        if token.kind == END or token.text in ("=", "end"):
            return None
        depth += (token.text == "[") - (token.text == "]")
        if depth == 0:
            break
        last += 1
    shown = _in_braces(w.source.text, w.tokens[w.position : last + 1])
    message = "a vector or an array is written in braces"
    fault = Fault("LAG0114", message, w.span(w.token, w.tokens[last]), remedy=f"write `{shown}`")
    others = tokenise(Source("", shown)).tokens[:-1]
    for token in others:
        token.start = token.end = w.token.start
    return Explained(fault, Repair(w.position, last + 1 - w.position, tuple(others)))


def _in_braces(text: str, tokens: Sequence[Token]) -> str:
    """Return `[x, 0]`, `[1 2; 3 4]` or the column `[x; 0]` as a vector or a matrix in braces."""
    first, last = tokens[0].start, tokens[-1].end
    characters = list(text[first:last])
    for token in tokens:
        if token.kind == SYMBOL and token.text in "[]":
            characters[token.start - first] = "{" if token.text == "[" else "}"
    rows = "".join(characters[1:-1]).strip(" ;").split(";")
    split = [row.split() if "," not in row and _LISTED.match(row) else [row.strip()] for row in rows]
    if len(rows) > 1 and all(len(row) == 1 and "," not in row[0] for row in split):
        split = [[row[0] for row in split]]
    lists = [", ".join(row) for row in split]
    return "{" + (lists[0] if len(lists) == 1 else ", ".join(f"{{{row}}}" for row in lists)) + "}"


def vector_in_parentheses(w: Where) -> Explained | None:
    """Explain `(0, 0, 1)`."""
    if w.token.text != "," or not w.brackets or w.brackets[-1].text != "(":
        return None
    opening = next((k for k in range(w.begin, w.position) if w.tokens[k] is w.brackets[-1]), None)
    if opening is None:
        return None
    last, depth = opening, 0
    while depth or last == opening:
        token = w.tokens[last]
        if token.kind == END or token.text in (";", "="):
            return None
        depth += (token.text in _OPENING.values()) - (token.text in _OPENING)
        last += 1
    tokens = w.tokens[opening:last]
    inner = w.source.text[tokens[0].end : tokens[-1].start]
    message = "a vector or an array is written in braces"
    fault = Fault("LAG0114", message, w.span(tokens[0], tokens[-1]), remedy=f"write `{{{inner}}}`")
    braces = [token_of("{", tokens[0].start), *tokens[1:-1], token_of("}", tokens[-1].start)]
    return Explained(fault, Repair(opening, len(tokens), tuple(braces)))


def colon_for_equal(w: Where) -> Explained | None:
    """Explain `x(start: 1)` and `parameter Length l: 0.5;`."""
    argument = bool(w.brackets) and w.brackets[-1].text == "("
    if w.token.text != ":" or not w.accepts("EQUALS") or (w.brackets and not argument) or not w.inside:
        return None
    if w.first.text == "constraint":
        return None
    message = "an argument has the form `name = value`" if argument else "a value follows `=`"
    return explained("LAG0123", message, w.span(w.token), "write `=`", w.replace("="))


def brackets(w: Where) -> Explained | None:
    text = w.token.text if w.token.kind == SYMBOL else ""
    if text in _OPENING:
        # A closing bracket without an open one: a block in braces, or a bracket too many.
        if not w.brackets:
            if w.first.text in ("model", "package", "effect", "scene") or not w.inside:
                message, remedy = "a block ends with `end name;`", None
                if w.block is not None and text == "}":
                    remedy = f"write `end {w.block.end_name};`"
                    repair = w.replace("end", w.block.end_name, ";")
                    return explained("LAG0114", message, w.span(w.token), remedy, repair)
            else:
                message, remedy = f"no bracket is open for this `{text}`", "delete it"
            return explained("LAG0114", message, w.span(w.token), remedy, w.replace())
        # A closing bracket of another kind: that of an outer bracket means that the inner one is open.
        opening = w.brackets[-1]
        if CLOSING[opening.text] != text and w.accepts(w.sign(CLOSING[opening.text])):
            right = CLOSING[opening.text]
            message = f"this `{text}` does not match the `{opening.text}`"
            outer = any(CLOSING[bracket.text] == text for bracket in w.brackets[:-1])
            repair = w.insert(right) if outer else w.replace(right)
            remedy = f"write `{right}{text}`" if outer else f"write `{right}`"
            related = ((w.span(opening), "opened here"),)
            return explained("LAG0114", message, w.span(w.token), remedy, repair, related=related)
        return None
    # An open bracket where the declaration ends, or where the token fits behind the bracket alone.
    ends = w.token.kind == END or text == ";" or (w.token.kind == WORD and w.new_line())
    if w.brackets:
        opening = w.brackets[-1]
        right = CLOSING[opening.text]
        # `m(min = 0 = 1 [kg]`: the token could follow the bracket.
        follows = text in w.signs and w.accepts(w.sign(right), w.sign(text))
        if not w.accepts(w.sign(right)) or not (ends or follows):
            return None
        message = f"this `{opening.text}` is not closed"
        repair = w.insert(right)
        remedy = f"close it with `{right}`"
        related = ((w.span(w.token), f"a `{right}` is missing before this"),)
        return explained("LAG0114", message, w.span(opening), remedy, repair, related=related)
    return None


def semicolon_too_many(w: Where) -> Explained | None:
    if w.token.text not in (";", ":") or w.token.kind != SYMBOL:
        return None
    header = w.tokens[max(w.position - 2, 0)].text in HEADERS
    body = w.tokens[w.position + 1].text in ("start", "parameter", "simulate")
    if w.token.text == ":" and not body and w.tokens[max(w.position - 2, 0)].text == "scene":
        message = "a scene lists its effects after `uses`"
        return explained("LAG0124", message, w.span(w.token), "write `uses`", w.replace("uses"))
    if w.before.text in ("then", "loop", "else") or header:
        message = f"there must be no `{w.token.text}` after `{w.before.text}`"
    elif not w.inside and w.token.text == ";":
        message = "this `;` is superfluous"
    else:
        return None
    return explained("LAG0124", message, w.span(w.token), "delete it", w.replace())


def missing_semicolon(w: Where) -> Explained | None:
    if not w.inside or not w.accepts("SEMICOLON"):
        return None
    if not w.new_line() and not (w.token.kind == WORD and w.token.text in w.keywords):
        return None
    if w.token.kind == SYMBOL:
        return None
    at = Span(w.source, w.before.end, w.before.end)
    return explained("LAG0111", "a `;` is missing", at, "end the declaration with `;`", w.insert(";"))


def comma_in_list(w: Where) -> Explained | None:
    """Explain `uses a b;` and `uses a + b;`, which parse as a scene whose body begins with `b`."""
    at = w.begin - 1
    if not w.inside or at < 1 or w.tokens[at].kind != WORD or (w.first.kind != WORD and w.first.text != "+"):
        return None
    joined = w.first.text in ("+", "and")
    if w.first.text in w.keywords and not joined:  # of the body of the scene
        return None
    while at > 0 and (w.tokens[at].kind == WORD or w.tokens[at].text == ","):
        if w.tokens[at].text == "uses":
            before, after = w.tokens[w.begin - 1], w.tokens[w.begin + joined]
            message = f"a `,` is missing between `{before.text}` and `{after.text}`"
            remedy = f"separate the names in a list by `,`: `{before.text}, {after.text}`"
            repair = Repair(w.begin - 1, 1 + joined, (before, token_of(",", w.first.start)))
            return explained("LAG0130", message, w.span(before, after), remedy, repair)
        at -= 1
    return None


def missing_sign(w: Where) -> Explained | None:
    """Explain `body b Particle(...)` and `coordinate Angle a b`."""
    if w.new_line() or w.before.kind != WORD or (w.token.kind == SYMBOL and w.token.text != "{"):
        return None
    if not w.accepts("EQUALS") or w.accepts("TIMES") or not w.inside:
        return None
    span = w.span(w.before, w.token)
    if w.accepts("COMMA"):
        message = f"a `,` or `=` is missing between `{w.before.text}` and `{w.token.text}`"
        return explained("LAG0130", message, span, "write `,` or `=`")
    message = f"a `=` is missing between `{w.before.text}` and `{w.token.text}`"
    return explained("LAG0130", message, span, "write `=`", w.insert("="))


def missing_comma(w: Where) -> Explained | None:
    """Explain `Particle(mass = m at = P)`."""
    named = w.token.kind == WORD and w.tokens[w.position + 1].text == "="
    if not named or not w.brackets or w.new_line() or not w.accepts("COMMA"):
        return None
    message = f"a `,` is missing between `{w.before.text}` and `{w.token.text}`"
    return explained("LAG0130", message, w.span(w.before, w.token), "write `,`", w.insert(","))


def number_of_another_language(w: Where) -> Explained | None:
    """Explain `3.0f`, `1_000` and `0x1F`."""
    if w.before.kind != NUMBER or w.token.kind != WORD or w.token.start != w.before.end:
        return None
    number, rest = w.before.text, w.token.text
    if re.fullmatch(r"(_\d+)+", rest):
        meant = number + rest.replace("_", "")
    elif number == "0" and re.fullmatch(r"[xX][0-9a-fA-F]+", rest):
        meant = str(int(rest[1:], 16))
    elif rest in ("f", "d", "u") and not _is_declared(w, rest):
        meant = number
    else:
        return None
    message = "a number consists of digits, a point and an exponent"
    fault = Fault("LAG0105", message, w.span(w.before, w.token), remedy=f"write `{meant}`")
    token = Token(NUMBER, meant, w.before.start, w.token.end)
    return Explained(fault, Repair(w.position - 1, 2, (token,)))


def size_before_name(w: Where) -> Explained | None:
    """Explain `output Length[3] r;`."""
    if w.token.kind != WORD or w.before.text != "]" or w.position - w.begin != 5 or not w.inside:
        return None
    kind, meant, _, size, _ = w.tokens[w.begin : w.position]
    remedy = f"write `{kind.text} {meant.text} {w.token.text}[{size.text}]`"
    message = "the size of an array follows its name"
    order = (w.token, *w.tokens[w.begin + 2 : w.position])
    return explained("LAG0110", message, w.span(meant, w.token), remedy, Repair(w.begin + 2, 4, order))


def multiplied(w: Where, begin: int, whole: bool) -> str:
    """Return the product that begins with token `begin`, as `m g l (1 - cos a)`, with its signs and
    parentheses; with `whole`, all up to the `;`."""
    text, before, depth = "", w.tokens[begin], 0
    for token in w.tokens[begin:]:
        begins = token.kind in (WORD, NUMBER) or token.text == "("
        ends = token.text == ";" or token.kind == END or (token.kind == WORD and token.text in w.keywords)
        if ends or (token.text == ")" and not depth) or not (begins or depth or whole):
            break
        depth += _BRACKETS.get(token.text, 0)
        apart = before is not token and begins and (before.kind in (WORD, NUMBER) or before.text == ")")
        if apart and before.kind == WORD and before.text in FUNCTIONS:
            text += token.text if token.text == "(" else f"({token.text})"
        elif apart and (token.start > before.end or before.kind == NUMBER):
            text += f"*{token.text}"
        else:
            text += w.source.text[before.end : token.start] + token.text if text else token.text
        before = token
    return text


def energy_without_name(w: Where) -> Explained | None:
    """Explain `potential m*g*z;`."""
    name = _ENERGIES.get(w.first.text)
    second, third = (w.tokens + [w.tokens[-1]] * 2)[w.begin + 1 : w.begin + 3]
    called = third.kind != SYMBOL and second.text[:1].isupper()  # `potential V m*g*z;`
    if second.kind == WORD and (third.text in ("=", "[", ";", ":=", "(") or called):
        return None
    if name is None or second.kind in (STRING, END) or second.text == "=" or second.text in w.keywords:
        return None
    remedy = f"write `{w.first.text} {name} = {multiplied(w, w.begin + 1, True)};`"
    message = f"a name is missing after `{w.first.text}`"
    return Explained(Fault("LAG0132", message, w.span(w.first), remedy=remedy))


def missing_operator(w: Where) -> Explained | None:
    operand = w.token.kind in (WORD, NUMBER) or w.token.text in ("(", "{")
    if not operand or w.new_line() or not w.accepts("TIMES") or w.before.kind == STRING:
        return None
    if w.token.kind == WORD and w.token.text in w.keywords:
        return None
    if w.before.text == "new":
        repair = Repair(w.position - 1, 1, ())
        remedy = "leave it out"
        message = "`new` is not a keyword of the language"
        return explained("LAG0118", message, w.span(w.before), remedy, repair)
    if w.before.text in ("Particle", "Solid"):
        remedy = f"write `{w.before.text}(...)` in place of `{w.before.text}{{...}}`"
        return explained("LAG0114", "arguments stand in parentheses", w.span(w.token), remedy)
    message = f"an operator is missing between `{w.before.text}` and `{w.token.text}`"
    product = multiplied(w, w.position - 1, False)
    if "*" not in product or len(product) > _LONGEST:  # it begins with a bracket or a keyword, or is long
        product = f"{w.before.text}*{w.token.text}"
    remedy = f"to multiply write `{product}`"
    if w.before.text in FUNCTIONS and w.token.kind == WORD:
        remedy = f"write `{w.before.text}({w.token.text})`"
    return explained("LAG0130", message, w.span(w.before, w.token), remedy, w.insert("*"))


def missing_value(w: Where) -> Explained | None:
    if not w.accepts("NUMBER") or w.before.text not in _OPERATORS or w.before.kind != SYMBOL:
        return None
    message = f"a value is missing between `{w.before.text}` and {w.shown}"
    return explained("LAG0131", message, w.span(w.before, w.token))
