"""Mistakes with keywords, names and the parts of declarations."""

from __future__ import annotations

from lagc.diagnostics.faults import Fault
from lagc.diagnostics.suggest import FOREIGN, closest
from lagc.syntax.lexer import NUMBER, STRING, WORD
from lagc.syntax.mistakes.context import HEADERS, Explained, Repair, Where, token_of


def first_word(w: Where) -> Explained | None:
    """Explain a declaration that begins with an unknown, foreign or misspelt keyword."""
    word = w.first.text
    if w.first.kind != WORD or word in w.keywords:
        return None
    if w.inside and w.tokens[w.begin + 1].text in (".", "[", "="):
        return None
    foreign = FOREIGN.get(word.lower())
    if foreign is not None:
        message = f"`{word}` is not a keyword of the language"
        fault = Fault("LAG0118", message, w.span(w.first), remedy=foreign.remedy)
        repair = None if foreign.ours is None else w.replace_first(*foreign.ours)
        return Explained(fault, repair)
    if w.tokens[w.begin + 1].kind != WORD:
        return None
    if word.lower() in w.keywords:
        message = "keywords are written in lower case"
        fault = Fault("LAG0119", message, w.span(w.first), remedy=f"write `{word.lower()}`")
        return Explained(fault, w.replace_first(word.lower()))
    near = closest(word, w.keywords)
    if near is None or not w.inside:
        return None
    message = f"`{word}` is not a keyword"
    fault = Fault("LAG0119", message, w.span(w.first), remedy=f"did you mean `{near}`?")
    return Explained(fault, w.replace_first(near))


def else_when(w: Where) -> Explained | None:
    if w.before.text != "elsewhen":
        return None
    message, remedy = (
        "`elsewhen` is not a keyword of the language",
        "write a separate `when ... end when;` for each condition",
    )
    fault = Fault("LAG0118", message, w.span(w.before), remedy=remedy)
    words = [token_of(word, w.before.start) for word in ("end", "when", ";", "when")]
    return Explained(fault, Repair(w.position - 1, 1, tuple(words)))


def if_statement(w: Where) -> Explained | None:
    if w.first.text != "if":
        return None
    remedy = (
        "use it in a value: `force f = if y > 0 [m] then a else b at P;`; an action at one moment is a "
        "`when`, and an optional part of a model is an `effect`"
    )
    message = "`if` belongs in an expression and does not begin a declaration"
    return Explained(Fault("LAG0118", message, w.span(w.first), remedy=remedy))


def missing_end_word(w: Where) -> Explained | None:
    """Explain `room;` instead of `end room;`."""
    if w.token.text != ";" or w.position - w.begin != 1 or w.block is None or w.first.text != w.block.closing:
        return None
    message = f"an `end` is missing before `{w.first.text}`"
    fault = w.block.fault("LAG0112", message, w.span(w.first))
    return Explained(fault, Repair(w.begin, 0, (token_of("end", w.first.start),)))


def stray_end(w: Where) -> Explained | None:
    if w.inside or w.token.text != "end":
        return None
    return Explained(Fault("LAG0113", "there is no open block that this `end` could close", w.span(w.token)))


def brace_for_block(w: Where) -> Explained | None:
    if w.token.text == "{" and w.first.text == "for" and w.accepts("LOOP"):
        return Explained(_loop_fault(w), w.replace("loop"))
    if w.first.text != "{" or w.begin < 2 or w.tokens[w.begin - 2].text not in HEADERS:
        return None
    message = "a block ends with `end name;` and has no braces"
    fault = Fault("LAG0114", message, w.span(w.first), remedy="delete it")
    return Explained(fault, Repair(w.begin, 1, ()))


def family(w: Where) -> Explained | None:
    """Explain `sum(i^2 for i in 1:n)` and `{i*j for i in 1:n, j in 1:m}`."""
    if not w.brackets or w.new_line():
        return None
    behind = [t for t in w.tokens[w.begin : w.position] if t.start > w.brackets[-1].start]
    again = w.token.text == "," and w.brackets[-1].text == "{" and any(t.text == "for" for t in behind)
    if not again and w.token.text != "for":
        return None
    message = "a list of values for each index has its own braces: `{i^2 for i in 1:n}`"
    remedy = "for two indices write `{{i*j for j in 1:m} for i in 1:n}`" if again else None
    return Explained(Fault("LAG0110", message, w.span(w.token), remedy=remedy))


def _loop_fault(w: Where) -> Fault:
    message = "a `loop` is missing: `for i in 1:n loop ... end for;`"
    return Fault("LAG0128", message, w.span(w.token))


def missing_word(w: Where) -> Explained | None:
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
            if w.first.text == "when":
                whole = "`when condition then ... end when;`"
            fault = Fault("LAG0128", f"{message}: {whole}", w.span(w.token))
            return Explained(fault, w.insert(word) if word == "then" else None)
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
    fault = Fault("LAG0127", f"{shown}: `{example}`", w.span(w.token), remedy=remedy)
    return Explained(fault, w.replace(needed) if other else None)


def constraint_parts(w: Where) -> Explained | None:
    if w.first.text != "constraint":
        return None
    form = "`constraint name: left = right;`"
    if w.accepts("COLON") and w.position - w.begin == 2:
        return Explained(Fault("LAG0129", f"a constraint has a name: {form}", w.span(w.token)))
    if w.accepts("EQUALS") and w.token.text == ";":
        return Explained(Fault("LAG0129", f"a constraint has two sides: {form}", w.span(w.token)))
    return None


def description_last(w: Where) -> Explained | None:
    if w.before.kind != STRING or w.token.text not in ("=", "(", "[", "at", "on", "unless", ":", "uses"):
        return None
    message = "write the description last, right before the `;` or the `,`"
    return Explained(Fault("LAG0125", message, w.span(w.before)))


def missing_name(w: Where) -> Explained | None:
    if not w.inside or not w.accepts("NAME") or w.accepts("NUMBER") or w.accepts("SEMICOLON"):
        return None
    what = f"after `{w.before.text}`"
    return Explained(Fault("LAG0132", f"a name is missing {what}; {w.shown} is not a name", w.span(w.token)))
