"""Mistakes with keywords, names and the parts of declarations."""

import re
from itertools import pairwise

from lagc.diagnostics.faults import Fault, Span
from lagc.diagnostics.suggest import AS_JOINT, closest, foreign, remedy_of_word
from lagc.syntax.lexer import END, NUMBER, STRING, SYMBOL, UNIT, WORD
from lagc.syntax.mistakes import HEADERS, Explained, Repair, Where, explained, token_of


def first_word(w: Where) -> Explained | None:
    """Explain a declaration that begins with an unknown, foreign or misspelt keyword."""
    word = w.first.text
    if w.first.kind != WORD or word in w.keywords:
        return None
    # `word.x`, `word[1]` and `word = ...` do not begin a declaration with a keyword.
    if w.inside and w.tokens[w.begin + 1].text in (".", "[", "="):
        return None
    entry = foreign("keywords").get(word)
    if entry is not None:
        message = f"`{word}` is not a keyword of the language"
        # Entries with backticks are explanations; others are words that can stand in the place of this one.
        repair = None if "`" in entry else w.replace_first(*entry.split())
        return explained("LAG0118", message, w.span(w.first), remedy_of_word("keywords", word), repair)
    # An unknown word before something that is not a name is no declaration at all.
    if w.tokens[w.begin + 1].kind != WORD:
        return None
    if word.lower() in w.keywords:
        message = "keywords are written in lower case"
        repair = w.replace_first(word.lower())
        return explained("LAG0119", message, w.span(w.first), f"write `{word.lower()}`", repair)
    near = closest(word, w.keywords)
    if near is None or not w.inside:
        return None
    message = f"`{word}` is not a keyword"
    return explained("LAG0119", message, w.span(w.first), f"did you mean `{near}`?", w.replace_first(near))


def else_when(w: Where) -> Explained | None:
    if w.before.text != "elsewhen":
        return None
    message, remedy = (
        "`elsewhen` is not a keyword of the language",
        f"end the clause and begin another: `end when; when {_until(w, 'then') or 'condition'} then`",
    )
    fault = Fault("LAG0118", message, w.span(w.before), remedy=remedy)
    words = [token_of(word, w.before.start) for word in ("end", "when", ";", "when")]
    return Explained(fault, Repair(w.position - 1, 1, tuple(words)))


def _until(w: Where, word: str) -> str:
    """Return the text from the unexpected token to the next `word` of the same line."""
    text = w.source.text[w.token.start :].partition("\n")[0]
    before, found, _ = text.partition(f" {word}")
    return before.strip() if found else ""


def joint_form(w: Where) -> Explained | None:
    """Explain `joint Revolute j(...)`, which has another form than the language reads."""
    if w.first.text != "joint" or not w.inside:
        return None
    kind = remedy_of_word("models", w.tokens[w.begin + 1].text) or AS_JOINT
    return explained("LAG0221", "a joint has another form", w.span(w.first), kind)


def python_choice(w: Where) -> Explained | None:
    """Explain `a if condition else b`."""
    if w.token.text != "if" or not w.inside or w.new_line():
        return None
    # The value goes back from `if` to the opening bracket, comma or equals sign that it follows at its own
    # depth of brackets.
    first, depth = w.position - 1, 0
    while first > w.begin:
        text = w.tokens[first].text
        depth += (text in ")]}") - (text in "([{") if w.tokens[first].kind == SYMBOL else 0
        if depth < 0 or (depth == 0 and text in (",", "=", ";")):
            break
        first -= 1
    # The other value ends at the closing bracket, comma or semicolon, or where a load names its place.
    otherwise, last, depth = 0, w.position, 0
    while w.tokens[last].kind != END:
        text = w.tokens[last].text
        depth += (text in "([{") - (text in ")]}") if w.tokens[last].kind == SYMBOL else 0
        if depth < 0 or (depth == 0 and text in (",", ";", "at", "on")):
            break
        otherwise = last if text == "else" and depth == 0 else otherwise
        last += 1
    value, condition = w.tokens[first + 1 : w.position], w.tokens[w.position + 1 : otherwise]
    other = w.tokens[otherwise + 1 : last]
    if not value or not condition or not other:
        return None
    a, b, c = (w.span(part[0], part[-1]).text for part in (value, condition, other))
    message = "a choice begins with its condition"
    fault = Fault("LAG0110", message, w.span(w.token), remedy=f"write `if {b} then {a} else {c}`")
    # Parsing goes on with the tokens in the order of the language, so that faults further on are found.
    ordered = [token_of("if", value[0].start), *condition, token_of("then", w.token.start), *value,
               token_of("else", w.token.start), *other]  # fmt: skip
    return Explained(fault, Repair(first + 1, last - first - 1, tuple(ordered)))


def conditional_component(w: Where) -> Explained | None:
    """Explain `Gravity field if air;`."""
    if w.token.text != "if" or not w.inside or w.new_line() or not w.accepts("SEMICOLON"):
        return None
    last = w.last_of_declaration()
    name = w.tokens[last].text if last == w.position + 1 and w.tokens[last].kind == WORD else "option"
    declared = w.span(w.first, w.before).text
    message = "an optional part of a model is an effect, which a scene uses"
    remedy = f"write `effect {name} {declared}; end {name};` and `scene lab uses {name};`"
    repair = Repair(w.position, last + 1 - w.position, ())
    return explained("LAG0118", message, w.span(w.token, w.tokens[last]), remedy, repair)


def scene_arguments(w: Where) -> Explained | None:
    """Explain `scene lab(l = 0.7);`, which parses as a scene whose body begins with `(`."""
    name = w.tokens[w.begin - 1]
    if w.first.text != "(" or w.begin < 2 or w.tokens[w.begin - 2].text != "scene":
        return None
    last = w.begin
    while w.tokens[last].text != ";" and w.tokens[last].kind != END:
        last += 1
    # All up to the semicolon; names of coordinates set a start, the others a parameter.
    written = w.source.text[w.first.end : w.tokens[last].start].strip().removesuffix(")")
    starts = {t.text for k, t in enumerate(w.tokens) if k > 1 and w.tokens[k - 2].text == "coordinate"}
    given = [part.strip() for part in written.split(",")]
    lines = [f"{'start' if part.split()[0] in starts else 'parameter'} {part};" for part in given if part]
    message = "a scene has no arguments: it sets values in its body"
    remedy = f"write `scene {name.text} {' '.join(lines)} end {name.text};`"
    repair = Repair(w.begin, last - w.begin, ())
    return explained("LAG0114", message, w.span(name, w.tokens[last - 1]), remedy, repair)


def solver_call(w: Where) -> Explained | None:
    """Explain `[t, y] = ode45(f, [0, 10], y0);`."""
    # Up to the first semicolon outside of brackets: a row of a matrix may contain one.
    last, depth = w.begin, 0
    while w.tokens[last].kind != END and (depth > 0 or w.tokens[last].text != ";"):
        depth += (w.tokens[last].text in ("(", "[", "{")) - (w.tokens[last].text in (")", "]", "}"))
        last += 1
    solver = next((t for t in w.tokens[w.begin : last] if t.text in foreign("solvers")), None)
    if solver is None:
        return None
    message = f"`{solver.text}` is not needed: lagc integrates the equations of motion"
    remedy = f"delete this; {foreign('keywords')['solve']}"
    return explained(
        "LAG0118",
        message,
        w.span(solver),
        remedy,
        Repair(w.begin, last - w.begin + (w.tokens[last].kind != END), ()),
    )


def without_kind(w: Where) -> Explained | None:
    """Explain `Real[m] x(start = 1);`."""
    if w.first.text != "Real" or w.token.kind != UNIT or w.position != w.begin + 1:
        return None
    last = w.last_of_declaration()
    # The words inside suggest the kind: a start belongs to a coordinate, a derivative is computed, a value is
    # a parameter's.
    declared = w.span(w.first, w.tokens[last])
    kind = "output" if "der" in declared.text else "parameter" if "=" in declared.text else "coordinate"
    kind = "coordinate" if "start" in declared.text else kind
    message = "the declaration of a quantity begins with its kind, such as `parameter` or `coordinate`"
    repair = Repair(w.begin, 0, (token_of(kind, w.first.start),))
    return explained("LAG0119", message, w.span(w.first), f"write `{kind} {declared.text};`", repair)


def if_statement(w: Where) -> Explained | None:
    if w.first.text != "if":
        return None
    remedy = (
        "use it in a value: `force f = if y > 0 [m] then a else b at P;`; an action at one moment is a "
        "`when`, and an optional part of a model is an `effect`"
    )
    message = "`if` belongs in an expression and does not begin a declaration"
    return explained("LAG0118", message, w.span(w.first), remedy)


def missing_end_word(w: Where) -> Explained | None:
    """Explain `room;` instead of `end room;`."""
    if (
        w.token.text != ";"
        or w.position - w.begin != 1
        or w.block is None
        or w.first.text != w.block.end_name
    ):
        return None
    message = f"an `end` is missing before `{w.first.text}`"
    fault = w.block.fault("LAG0112", message, w.span(w.first))
    return Explained(fault, Repair(w.begin, 0, (token_of("end", w.first.start),)))


def stray_end(w: Where) -> Explained | None:
    if w.inside or w.token.text != "end":
        return None
    return explained("LAG0113", "there is no open block that this `end` could close", w.span(w.token))


def brace_for_block(w: Where) -> Explained | None:
    if w.token.text == "{" and w.first.text == "for" and w.accepts("LOOP"):
        return Explained(_loop_fault(w), w.replace("loop"))
    if w.first.text != "{" or w.begin < 2 or w.tokens[w.begin - 2].text not in HEADERS:
        return None
    message = "a block ends with `end name;` and has no braces"
    return explained("LAG0114", message, w.span(w.first), "delete it", Repair(w.begin, 1, ()))


def family(w: Where) -> Explained | None:
    """Explain `sum(i^2 for i in 1:n)` and `{i*j for i in 1:n, j in 1:m}`."""
    if not w.brackets or w.new_line():
        return None
    # `for` was read already for an index before this comma: then this is a second one.
    behind = [t for t in w.tokens[w.begin : w.position] if t.start > w.brackets[-1].start]
    again = w.token.text == "," and w.brackets[-1].text == "{" and any(t.text == "for" for t in behind)
    if not again and w.token.text != "for":
        return None
    message = "a list of values for each index has its own braces: `{i^2 for i in 1:n}`"
    remedy = "for two indices write `{{i*j for j in 1:m} for i in 1:n}`" if again else None
    return explained("LAG0110", message, w.span(w.token), remedy)


def _loop_fault(w: Where) -> Fault:
    message = "a `loop` is missing: `for i in 1:n loop ... end for;`"
    return Fault("LAG0128", message, w.span(w.token), remedy="write `loop`")


def missing_word(w: Where) -> Explained | None:
    if w.first.text == "for" and w.accepts("LOOP"):
        return Explained(_loop_fault(w), w.insert("loop"))
    if w.first.text == "for" and w.accepts("IN"):
        message = "an `in` is missing: `for i in 1:n loop ... end for;`"
        repair: Repair | None = w.replace("in") if w.token.text == "=" else w.insert("in")
        return explained("LAG0128", message, w.span(w.token), repair=repair)
    for word in ("then", "else"):
        if w.accepts(word.upper()):
            message = f"an `{word}` is missing" if word == "else" else "a `then` is missing"
            whole = "`if condition then value else other`"
            if w.first.text == "when":
                whole = "`when condition then ... end when;`"
            remedy = f"write `{word}`" + (" and the other value" if word == "else" else "")
            repair = w.insert(word) if word == "then" else None
            return explained("LAG0128", f"{message}: {whole}", w.span(w.token), remedy, repair)
    return None


def load_target(w: Where) -> Explained | None:
    kind = w.first.text
    right = {"force": "AT", "torque": "ON"}.get(kind)
    if right is None or not w.accepts(right) or (w.before.kind == NUMBER and w.before.end == w.token.start):
        return None
    needed = right.lower()
    shown = "a force acts `at` a point" if kind == "force" else "a torque acts `on` a body"
    example = "force F = vector at point;" if kind == "force" else "torque M = vector on body;"
    other = w.token.text in ("at", "on")
    remedy = f"write `{needed}`" if other else None
    on = next((k for k in range(w.begin, w.position) if w.tokens[k].text == "on"), None)
    if kind == "force" and on is not None:
        target = w.span(w.tokens[on + 1], w.before).text
        quantity = _coordinates(w).get(w.tokens[on + 1].text)
        # A force on a body also needs its point; the name after `on` is taken for the body.
        remedy = f"write `at {target}`, or `on {target} at P` for a point P of the body"
        if quantity == "Angle":
            value = w.span(w.tokens[w.begin + 1], w.tokens[on]).text
            remedy = f"write `torque {value} rotate_y(world, {target})` for the frame that the angle turns"
        elif quantity is not None:
            remedy = f"`{target}` is a coordinate: write `at` and a body or a point that it moves"
    elif remedy is None:
        # A body of the file itself is the best example of a place.
        pairs, words = pairwise(w.tokens), ("body", "Particle", "Solid")
        place = next((b.text for a, b in pairs if a.text in words and b.kind == WORD), "b")
        written = w.span(w.first, w.before).text
        remedy = f"write `{written} {needed} {place};`"
    repair = w.replace(needed) if other else None
    return explained("LAG0127", f"{shown}: `{example}`", w.span(w.token), remedy, repair)


def _coordinates(w: Where) -> dict[str, str]:
    """Return the type of each coordinate of the text by its name."""
    found, kind = dict[str, str](), ""
    for before, token in pairwise(w.tokens):
        if before.text == "coordinate":
            kind = token.text
        elif token.text == ";":
            kind = ""
        elif kind and token.kind == WORD and (before.text in (kind, ",") or before.kind == UNIT):
            found[token.text] = kind
    return found


def load_target_first(w: Where) -> Explained | None:
    """Explain `force f at b = {1, 0, 0};`."""
    if w.first.text not in ("force", "torque") or w.token.text not in ("at", "on") or not w.accepts("EQUALS"):
        return None
    end = w.source.text.find(";", w.token.start)
    place, _, value = w.source.text[w.token.start : end].partition("=")
    if not value or "\n" in value or len(value) > 80:
        return None
    message = f"a {w.first.text} acts `{w.token.text}` what follows its value"
    remedy = f"write `{w.span(w.first, w.before).text} = {value.strip()} {place.strip()};`"
    return explained("LAG0127", message, w.span(w.token), remedy)


def loop_of_another_language(w: Where) -> Explained | None:
    """Explain `for i = 1 to 3`, `for i in 1..3`, `for i in range(3):` and `for (int i = 0; i < 3; i++)`."""
    found = _LOOP.match(w.source.text, w.first.start) if w.first.text == "for" else None
    if found is None:
        return None
    index, first, last = found["i"] or found["j"] or found["k"], found["first"] or "1", ""
    last = found["last"] or found["count"] or found["bound"]
    message = "a loop has the form `for i in 1:n loop ... end for;`"
    span = Span(w.source, w.first.start, found.end())
    return explained("LAG0128", message, span, f"write `for {index} in {first}:{last} loop`")


_LOOP = re.compile(
    r"for\s+(?:(?P<i>\w+)\s*(?:=|\bin\b)\s*(?P<first>\w+)\s*(?:\bto\b|\.\.)\s*(?P<last>\w+)"
    r"|(?P<j>\w+)\s+in\s+range\((?P<count>\w+)\)"
    r"|\(\s*(?:int\s+)?(?P<k>\w+)\s*=\s*\w+\s*;\s*\w+\s*<=?\s*(?P<bound>\w+)\s*;[^)\n]*\))"
)


def constraint_parts(w: Where) -> Explained | None:
    if w.first.text != "constraint":
        return None
    form = "`constraint name: left = right;`"
    if w.accepts("COLON") and w.position - w.begin == 2:
        rest = w.source.text[w.before.start :].partition(";")[0]
        remedy = f"write `constraint c: {rest};`" if len(rest) <= 60 and "\n" not in rest else None
        return explained("LAG0129", f"a constraint has a name: {form}", w.span(w.token), remedy)
    if w.accepts("EQUALS") and w.token.text == ";":
        remedy = f"write `{w.span(w.first, w.before).text} = 0;` if it is to be 0"
        return explained("LAG0129", f"a constraint has two sides: {form}", w.span(w.token), remedy)
    return None


def description_last(w: Where) -> Explained | None:
    if w.before.kind != STRING or w.token.text not in ("=", "(", "[", "at", "on", "unless", ":", "uses"):
        return None
    message = "write the description last, right before the `;` or the `,`"
    return explained("LAG0125", message, w.span(w.before))


def annotation_behind(w: Where) -> Explained | None:
    """Explain `parameter Mass m = 1 annotation(...);`."""
    if w.token.text != "annotation" or not w.inside or not w.accepts("SEMICOLON"):
        return None
    last = w.last_of_declaration()
    message = "an annotation has no effect, and belongs to no declaration"
    repair = Repair(w.position, last + 1 - w.position, ())
    return explained("LAG0118", message, w.span(w.token, w.tokens[last]), "delete it", repair)


def import_as(w: Where) -> Explained | None:
    """Explain `import numpy as np`."""
    if w.first.text != "import" or w.token.text != "as":
        return None
    path, name = w.span(w.tokens[w.begin + 1], w.before).text, w.tokens[w.position + 1].text
    message = "`as` is not a keyword of the language"
    remedy = foreign("libraries").get(path.partition(".")[0], f"write `import {name} = {path};`")
    return explained("LAG0118", message, w.span(w.token), remedy)


def another_name(w: Where) -> Explained | None:
    """Explain `coordinate Length x; y;`."""
    before = w.tokens[w.begin - 1] if w.begin else None
    if before is None or before.text != ";" or w.first.kind != WORD or w.before is not w.first:
        return None
    if w.token.text not in (";", ",") or "\n" in w.source.text[before.end : w.first.start]:
        return None
    message = f"`{w.first.text}` does not begin a declaration; names in a list are separated by `,`"
    repair = Repair(w.begin - 1, 1, (token_of(",", before.start),))
    return explained("LAG0130", message, w.span(before, w.first), f"write `, {w.first.text}`", repair)


def missing_name(w: Where) -> Explained | None:
    name = _NAMED.get(w.first.text)
    if name is not None and w.token.text == ";" and w.tokens[w.begin + 1].text in ("(", ";"):
        rest = w.span(w.first, w.before).text.removeprefix(w.first.text)
        missing = f"a name is missing after `{w.first.text}`"
        line = f"write `{w.first.text} {name}{rest};`"
        return explained("LAG0132", missing, w.span(w.first), line)
    if not w.inside or not w.accepts("NAME") or w.accepts("NUMBER") or w.accepts("SEMICOLON"):
        return None
    message = f"a name is missing after `{w.before.text}`; {w.shown} is not a name"
    remedy = "write `constraint c:`" if w.first.text == "constraint" and w.token.text == ":" else None
    return explained("LAG0132", message, w.span(w.token), remedy)


_NAMED = {"Gravity": "field", "Particle": "b", "Solid": "b"}
