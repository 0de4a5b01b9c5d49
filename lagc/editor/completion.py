"""Completion: what may stand at a place by the tables of the parser, and the names that fit there."""

from collections.abc import Iterator

from lagc.base.records import dataclass
from lagc.diagnostics.faults import Source, Span
from lagc.editor import words
from lagc.editor.names import Declared, Index
from lagc.semantics.joints import KINDS
from lagc.semantics.values.members import AXES, OF_BODY, OF_ORIENTATION
from lagc.syntax.lalr import Machine
from lagc.syntax.lalr_tables import tables
from lagc.syntax.lexer import END, SYMBOL, WORD, Lexed, Token, tokenise
from lagc.syntax.recovery import recover

_MARK = "\0"  # a token that fits nowhere, so that the parser stops with its states as they are before it
_MEMBERS = {"frame": AXES, "point": AXES, "body": OF_BODY}
_NO_VALUES = ("model", "type", "scene", "effect")  # kinds of names that are no part of an expression


@dataclass(frozen=True)
class Offer:
    """One completion: `kind` is keyword, type, unit, function, thing, argument, or that of a declaration."""

    label: str
    kind: str
    detail: str = ""


def completions(source: Source, index: Index, offset: int) -> list[Offer]:
    """Return what may be written at an offset, where a word may have been begun; the likely first."""
    begun = offset
    while begun and (source.text[begun - 1].isalnum() or source.text[begun - 1] == "_"):
        begun -= 1
    before = Source(source.name, source.text[:begun])
    lexed = tokenise(before)
    # In a text, in a comment, in a unit.
    unclosed = {fault.code for fault in lexed.faults if fault.span and _reaches_end(fault.span)}
    comment = lexed.comments and lexed.comments[-1]
    if "LAG0102" in unclosed or (comment and comment.end == begun and comment.text.startswith("//")):
        return []
    if "LAG0104" in unclosed:
        return [Offer(symbol, "unit") for symbol in words.UNITS]
    if any(fault.code == "LAG0103" for fault in lexed.faults):
        return []
    found = _Place(before, lexed, index).offers()
    return list({offer.label: offer for offer in reversed([*found])}.values())[::-1]


def _reaches_end(span: Span) -> bool:
    """Whether the text ends in the line of a span, after blanks at most."""
    return "\n" not in span.source.text[span.start :]


class _Place:
    """The end of a text: the tokens before it, and the states of the parser there."""

    def __init__(self, before: Source, lexed: Lexed, index: Index):
        self.index, self.names = index, index.scope(len(before.text))
        end = lexed.tokens[-1].start
        lexed.tokens[-1:-1] = [Token(SYMBOL, _MARK, end, end)]
        machine = Machine(before, tables(), lexed)
        machine.run(_go_on)
        self.states, self.blocks, self.closed = machine.states, machine.blocks, machine.last_closed
        self.tokens = [token for token in machine.tokens[: machine.position] if token.text != _MARK]
        self.last = self.tokens[-1].text if self.tokens else ""

    def offers(self) -> list[Offer]:
        keywords = [
            Offer(word, "keyword")
            for word, terminal in tables().keywords.items()
            if self.row(terminal) is not None
        ]
        if self.last == ".":
            return [*self._members()]
        if self.last == "end":
            return [*([Offer(self.closed.end_name, "block")] if self.closed else ()), *keywords]
        # The symbols of the grammar that may begin here tell what a name would stand for.
        row = self.row("NAME") or {}
        if "item" in row:
            values = self._values() if self._keyword(past=True) == "initial" else ()
            return [*keywords, *values, *self._named("model", "package"), *_calls("thing", words.MADE[""])]
        if "place" in row:
            return [*self._named("effect"), *keywords]
        if "type" in row:
            in_scene = bool(self.blocks) and self.blocks[-1].word.text == "scene"
            types = [Offer(name, "type", unit) for name, unit in words.types().items()]
            return [*(self._named("parameter") if in_scene else ()), *types, *self._named("type"), *keywords]
        if "path" in row:
            return [*self._named("model", "package"), *keywords]
        return [
            *(self._arguments() if "argument" in row else ()),
            *(self._values() if "postfix" in row else ()),
            *keywords,
        ]

    def row(self, terminal: str) -> dict[str, int] | None:
        """Return the row of the parser's table in which a terminal is shifted here, or None if it cannot
        follow."""
        found, states = tables(), list(self.states)
        while True:
            row = found.actions[states[-1]]
            action = row.get(terminal)
            if action is None or action >= 0:
                return None if action is None else row
            origin, length, _, _ = found.rules[~action]
            if length:
                del states[-length:]
            states.append(found.actions[states[-1]][origin])

    def _keyword(self, past: bool = False) -> str:
        """Return the keyword that begins the declaration, or "" if it has none; `past`: or else that of a
        declaration before."""
        first = tables().actions[tables().start]
        for token in reversed(self.tokens):
            if token.text == ";" and not past:
                return ""
            if token.terminal in first and token.terminal == tables().keywords.get(token.text):
                return token.text
        return ""

    def _named(self, *kinds: str) -> Iterator[Offer]:
        return (_offer(d) for d in self.index.visible(self.names) if d.kind in kinds)

    def _values(self) -> Iterator[Offer]:
        """Yield the parts of an expression."""
        keyword = self._keyword()
        if self.last == "=" and keyword in words.MADE and [t.text for t in self.tokens[-3:-2]] == [keyword]:
            yield from _calls("thing", words.MADE[keyword])
        if self.last == "then" and keyword == "when":
            yield from (Offer(name, "function") for name in words.ACTIONS)
        yield from (Offer(name, "variable") for name in sorted(self.names.variables))
        yield from (_offer(d) for d in self.index.visible(self.names) if d.kind not in _NO_VALUES)
        yield from _calls("function", words.FUNCTIONS)
        yield from (Offer(name, "constant") for name in words.NAMED_VALUES)

    def _members(self) -> Iterator[Offer]:
        """Yield the members of the path before the `.`."""
        path: list[str] = []
        tokens = _without_subscripts(self.tokens)
        while len(tokens) > 1 and tokens[-1].text == "." and tokens[-2].kind == WORD:
            path.insert(0, tokens[-2].text)
            del tokens[-2:]
        found = self.index.lookup(tuple(path), self.names) if path else None
        inside = self.index.inside(found)
        if inside is not None:
            yield from (_offer(d) for block in self.index.extended(inside) for d in block.own.values())
        kind, type = (found.kind, found.type) if found is not None else ("frame", "")  # `world`
        members = OF_ORIENTATION if type == "Orientation" else _MEMBERS.get(kind, ())
        if kind == "joint" and type in KINDS:
            members = tuple(KINDS[type].coordinates)
        yield from (Offer(name, "member") for name in members)

    def _arguments(self) -> Iterator[Offer]:
        """Yield the names of the arguments in the parentheses that are open."""
        depth, at = 0, len(self.tokens) - 1
        while at > 0 and depth >= 0:
            depth += (self.tokens[at].text in (")", "]", "}")) - (self.tokens[at].text in ("(", "[", "{"))
            at -= 1
        called, before = self.tokens[at], self.tokens[at - 1]
        yield from (Offer(name, "argument") for name in words.arguments(called.text, self._keyword()))
        model = self.index.lookup(
            (before.text,), self.names
        )  # of an instance `Chain a(`, or `extends Chain(`
        model = self.index.lookup((called.text,), self.names) if before.text == "extends" else model
        if model is not None and model.kind == "model" and model.inside is not None:
            given = (d for block in self.index.extended(model.inside) for d in block.own.values())
            yield from (
                Offer(d.name, "argument", d.type) for d in given if d.kind in ("parameter", "structural")
            )


def _go_on(machine: Machine) -> bool:
    """Recover from a fault before the end."""
    token = machine.tokens[machine.position]
    return token.text != _MARK and token.kind != END and recover(machine)


def _offer(declared: Declared) -> Offer:
    return Offer(declared.name, declared.kind, declared.description or declared.type)


def _calls(kind: str, known: dict[str, words.Call]) -> Iterator[Offer]:
    return (Offer(name, kind, words.shown(name, call)) for name, call in known.items())


def _without_subscripts(tokens: list[Token]) -> list[Token]:
    """Return the tokens of the path at the end, `a[i].b.` as `a.b.`, and those before it."""
    found: list[Token] = []
    depth = 0
    for token in reversed(tokens):
        depth += token.text == "]"
        if depth == 0:
            found.append(token)
        depth -= token.text == "["
    return found[::-1]
