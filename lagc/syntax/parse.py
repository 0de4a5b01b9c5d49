"""From text to syntax tree: the entry points, and passages of Modelica that are left out before.

Sections of equations, `within` and short classes are reported once each, with the line to write instead.
"""

import re

from lagc.diagnostics.faults import Fault, Refused, Source, Span
from lagc.syntax.lalr import MOST_FAULTS, Machine
from lagc.syntax.lalr_tables import tables
from lagc.syntax.lexer import END, SYMBOL, WORD, Lexed, Token, tokenise
from lagc.syntax.tree import Declarator, Expression, Quantities, Tree

_FOREIGN = re.compile(r"\b(?:equation|algorithm|within)\b|\b(?:model|block|class|package|record)\s+\w+\s*=")


def parse(source: Source) -> Tree:
    """Return the tree of a text.  Raises Refused with its syntax faults, at most MOST_FAULTS."""
    tree, faults = parse_recovering(source)
    if faults:
        raise Refused(faults)
    return tree


def parse_recovering(source: Source) -> tuple[Tree, list[Fault]]:
    """Return the readable part of a text as a tree, and its syntax faults in the order of the text."""
    tree, _, faults = read(source)
    return tree, faults


def parse_expression(source: Source) -> Expression:
    """Return the expression of a text.  Raises Refused."""
    lexed, length = tokenise(source), len(source.text)
    before = [Token(WORD, word, 0, 0) for word in ("constant", "Real", "value")]
    lexed.tokens[:0] = [*before, Token(SYMBOL, "=", 0, 0)]
    lexed.tokens[-1:-1] = [Token(SYMBOL, ";", length, length)]
    machine = Machine(source, tables(), lexed)
    tree, faults = machine.run(_recover), _faults_of(lexed, machine)
    if faults:
        raise Refused(faults)
    match tree:
        case Tree(
            declarations=(Quantities(declarators=(Declarator(value=value, description=None),), unless=()),)
        ):
            if value is not None:
                return value
    message = "this is not a single expression"
    raise Refused([Fault("LAG0110", message, Span(source, 0, length), remedy="write it without `;`")])


def read(source: Source) -> tuple[Tree, Lexed, list[Fault]]:
    """Return the tree, the tokens and the faults of a text."""
    nul = source.text.find("\0")
    if nul >= 0:  # in a comment too
        message, remedy = ("the language does not use the character U+0000", "save the file as UTF-8 text")
        fault = Fault("LAG0101", message, Span(source, nul, nul + 1), remedy=remedy)
        return Tree(source, ()), Lexed([], [], []), [fault]
    lexed = tokenise(source)
    if _FOREIGN.search(source.text):
        _leave_out(source, lexed, frozenset(tables().keywords))
    machine = Machine(source, tables(), lexed)
    tree = machine.run(_recover)
    return tree if tree is not None else Tree(source, ()), lexed, _faults_of(lexed, machine)


def _recover(machine: Machine) -> bool:
    from lagc.syntax.recovery import recover  # where there is a fault

    return recover(machine)


def _faults_of(lexed: Lexed, machine: Machine) -> list[Fault]:
    """Return the faults of a text in the order of the text."""
    found = {(fault.code, _start(fault)): fault for fault in machine.faults + machine.builder.faults}
    lost = [_start(fault) for fault in lexed.faults if fault.code == "LAG0103"]
    if lost:  # an unclosed comment hides the text after it
        read = machine.source.text[: lost[0]].rstrip()
        found = {key: fault for key, fault in found.items() if key[1] < len(read)}
    return sorted(lexed.faults + list(found.values()), key=_start)[:MOST_FAULTS]


def _start(fault: Fault) -> int:
    return fault.span.start if fault.span is not None else 0


_SECTIONS = frozenset({"equation", "algorithm"})
_AROUND = _SECTIONS | {"public", "protected"}
_INSIDE = frozenset({"if", "for", "when", "while", "then", "loop", "not", "each"})  # keywords of equations
_PREFIXES = frozenset({"replaceable", "redeclare", "encapsulated", "final", "inner", "outer", "partial"})
_CLASSES = frozenset({"model", "block", "class", "package", "record"})
_LONGEST = 60  # characters of an equation that is shown


def _leave_out(source: Source, lexed: Lexed, keywords: frozenset[str]) -> None:
    """Report such passages and remove their tokens."""
    tokens, kept, at = lexed.tokens, list[Token](), 0
    while at < len(tokens):
        found = _passage(source, tokens, at, keywords)
        if found is None:
            kept.append(tokens[at])
            at += 1
        else:
            fault, at = found
            lexed.faults.append(fault)
    lexed.tokens[:] = kept


def _passage(
    source: Source, tokens: list[Token], at: int, keywords: frozenset[str]
) -> tuple[Fault, int] | None:
    """Return the fault of a passage that begins at token `at`, and the number of the token after it."""
    token = tokens[at]
    if token.kind != WORD:
        return None
    # Sections, packages and classes of Modelica: a whole passage is one fault, and what follows is read on.
    if token.text in _SECTIONS:
        if at and tokens[at - 1].text == "initial":
            message = "the section of initial equations begins with `initial` alone"
            fault = Fault("LAG0118", message, _span(source, token, token), remedy=f"delete `{token.text}`")
            return fault, at + 1
        return _section(source, tokens, at, keywords) if _begins_section(source, tokens, at) else None
    if token.text == "within" and at == 0:
        message = "`within` is not a keyword of the language"
        remedy = "delete this line; to put models into a package write `package Name ... end Name;`"
        fault = Fault("LAG0118", message, _span(source, token, token), remedy=remedy)
        return fault, _after_semicolon(tokens, at)
    if token.text == "function" and tokens[at + 1].kind == WORD and tokens[at + 2].text != "(":
        return _function(source, tokens, at)
    return _short_class(source, tokens, at)


def _function(source: Source, tokens: list[Token], at: int) -> tuple[Fault, int] | None:
    """Explain `function f input Real x; ... end f;`."""
    name, last = tokens[at + 1], at + 2
    while tokens[last].kind != END and (tokens[last].text != "end" or tokens[last + 1].text != name.text):
        last += 1
    if tokens[last].kind == END:
        return None
    message = f"the function `{name.text}` must be one expression"
    remedy = f"write `function {name.text}(Type x) = expression;`"
    fault = Fault("LAG0118", message, _span(source, tokens[at], name), remedy=remedy)
    return fault, _after_semicolon(tokens, last)


def _begins_section(source: Source, tokens: list[Token], at: int) -> bool:
    """Return whether the word begins a line and is no name: `equation` is a name in `Mass equation = 1;`."""
    before, after = tokens[at - 1] if at else None, tokens[at + 1]
    if before is not None and before.kind == SYMBOL and before.text not in (";", ")", "]", "}"):
        return False
    return _new_line(source, tokens, at) and after.text not in ("=", ";", ",", ".", "[", ":")


def _new_line(source: Source, tokens: list[Token], at: int) -> bool:
    return at == 0 or "\n" in source.text[tokens[at - 1].end : tokens[at].start]


def _section(source: Source, tokens: list[Token], at: int, keywords: frozenset[str]) -> tuple[Fault, int]:
    last = at + 1
    while tokens[last].kind != END and not _ends_section(source, tokens, last, keywords):
        last += 1
    word = tokens[at].text
    message = f"there is no {word} section: lagc derives the equations of motion"
    remedy = _instead(source, tokens[:at], tokens[at + 1 : last])
    return Fault("LAG0118", message, _span(source, tokens[at], tokens[at]), remedy=remedy), last


def _ends_section(source: Source, tokens: list[Token], at: int, keywords: frozenset[str]) -> bool:
    word, after = tokens[at].text, tokens[at + 1].text
    if word == "end":
        return after not in ("if", "for", "when", "while")
    if tokens[at].kind != WORD or not _new_line(source, tokens, at) or after in ("=", ":=", "."):
        return False
    return word in _AROUND or (word in keywords and word not in _INSIDE)


def _instead(source: Source, before: list[Token], section: list[Token]) -> str:
    """Return what to write in place of the equations of a section; `before` are the tokens before it."""
    words = {token.text for token in section}
    parts = []
    if "der" in words:
        parts.append("delete the equations of motion, which follow from bodies, forces and constraints")
    if "connect" in words:
        parts.append("connect bodies by constraints, `constraint c: position(a) = position(b);`")
    if "when" in words:
        parts.append("write `when ... end when;` directly into the model")
    plain = _plain_equation(source, section)
    left, _, right = plain.partition(" = ")
    kind = _declared_as(left, before) if right else ""
    if kind.startswith("output "):
        parts.append(f"write `{kind} {plain};`")
    elif plain:
        parts.append(f"write an equation that always holds as `constraint c: {plain};`")
    return "; ".join(parts) or "delete it"


def _declared_as(name: str, before: list[Token]) -> str:
    """Return the words before the name in its declaration, `output Real`."""
    for k in range(2, len(before)):
        if before[k].text == name and before[k - 2].text == "output":
            return f"output {before[k - 1].text}"
    return ""


def _plain_equation(source: Source, section: list[Token]) -> str:
    """Return the first equation of a section that is neither one of motion nor a connection."""
    begin = 0
    for k, token in enumerate(section):
        if token.text != ";":
            continue
        words = {t.text for t in section[begin:k]}
        if words & {"=", ":="} and not words & {"der", "connect", "when", "if", "for", "loop", "then"}:
            text = " ".join(source.text[section[begin].start : token.start].split()).replace(":=", "=")
            return text if len(text) <= _LONGEST else "left = right"
        begin = k + 1
    return ""


def _short_class(source: Source, tokens: list[Token], at: int) -> tuple[Fault, int] | None:
    """Explain `replaceable model A = B;`."""
    word = at
    while tokens[word].text in _PREFIXES:
        word += 1
    if tokens[word].text not in _CLASSES or tokens[word + 1].kind != WORD or tokens[word + 2].text != "=":
        return None
    after = _after_semicolon(tokens, word)
    name, begin, end = tokens[word + 1].text, tokens[word + 3].start, tokens[max(after - 2, word + 2)].end
    base = " ".join(source.text[begin:end].split())
    if tokens[word].text == "package":
        instead = f"import {name} = {base};"
    else:
        instead = f"model {name} extends {base}; end {name};"
    message = f"a {tokens[word].text} is not declared with `=`"
    shown = len(base) <= _LONGEST and base
    remedy = f"write `{instead}`" if shown else "write `model A extends B; end A;`"
    return Fault("LAG0118", message, _span(source, tokens[at], tokens[word]), remedy=remedy), after


def _after_semicolon(tokens: list[Token], at: int) -> int:
    """Return the number of the token after the `;` that ends the declaration at token `at`."""
    while tokens[at].text != ";" and tokens[at].kind != END:
        at += 1
    return at + (tokens[at].text == ";")


def _span(source: Source, first: Token, last: Token) -> Span:
    return Span(source, first.start, last.end)
