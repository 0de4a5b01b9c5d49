"""The LALR(1) machine: tokens in, tree out, with repair and recovery.

At a fault it tries the small repairs first (one sign put in, replaced or left out, after which
the text reads on); else it gives the declaration up and goes on behind it.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from lagc.diagnostics.faults import Fault, Source, Span
from lagc.frontend import mistakes
from lagc.frontend.build import Builder
from lagc.frontend.lexer import END, NUMBER, STRING, SYMBOL, UNIT, WORD, Lexed, Token
from lagc.frontend.tables import Tables

DEEPEST = 100  # brackets, `if`s, signs and blocks inside one another
MOST_FAULTS = 50

_FIXED = {NUMBER: "NUMBER", STRING: "STRING", UNIT: "UNIT", END: "$END"}
_ALWAYS = frozenset({"if", "not", "true", "false", "end"})
_CALLED = frozenset({"simulate", "annotation", "initial"})  # keywords before a `(`
_BLOCKS = frozenset({"MODEL", "PACKAGE", "EFFECT", "SCENE", "FOR", "WHEN"})
_NESTING = frozenset({"LPAR", "LBRACE", "LSQB", "IF", "NOT", *_BLOCKS})
_AFTER_NAMES = frozenset(("<=", ">=", "==", "<>", *"=.[+-*/^,)]}:<>("))


@dataclass(slots=True)
class Block:
    """An open block: the word that opened it, its name's token, the height of the stack below."""

    word: Token
    name: Token
    height: int


@dataclass
class Machine:
    """One reading of one text."""

    source: Source
    tables: Tables
    lexed: Lexed
    faults: list[Fault] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.tokens = self.lexed.tokens
        self.position = 0
        self.states = [self.tables.start]
        self.values: list[Any] = [None]
        self.starts = [0]  # the number of each entry's first token
        self.depths = [0]
        self.blocks: list[Block] = []
        self.last_end = 0  # where the last token taken ends
        self.builder = Builder(self.source)
        self.callbacks: list[Any] = [
            None if name is None else getattr(self.builder, name) for _, _, name, _ in self.tables.rules
        ]

    def run(self) -> Any:
        """The tree; `faults` and `builder.faults` tell what was wrong.  None where nothing could
        be read on."""
        actions = self.tables.actions
        states = self.states
        accept = self.tables.accept
        while True:
            token = self.tokens[self.position]
            terminal = _FIXED.get(token.kind) or self.terminal(self.position, states[-1])
            contextual = token.kind == WORD and token.text in self.tables.keywords
            while True:
                action = actions[states[-1]].get(terminal)
                if action is None:
                    if contextual:
                        again = self.terminal(self.position, states[-1])
                        if again != terminal:
                            terminal = again
                            continue
                    if not self._recover(terminal):
                        return None
                    break
                if action >= 0:
                    if not self._shift(token, terminal, action):
                        return None
                    break
                self._reduce(~action)
                if states[-1] == accept and token.kind == END:
                    return self.values[-1]

    def terminal(self, position: int, state: int) -> str:
        """What token number `position` is where the machine is in `state`."""
        token = self.tokens[position]
        fixed = _FIXED.get(token.kind)
        if fixed is not None:
            return fixed
        if token.kind == SYMBOL:
            return self.tables.symbols.get(token.text, "?")
        keyword = self.tables.keywords.get(token.text)
        row = self.tables.actions[state]
        if keyword is None or keyword not in row:
            return "NAME"
        if "NAME" in row and self._reads_as_name(token.text, self.tokens[position + 1].text):
            return "NAME"
        return keyword

    def _reads_as_name(self, word: str, after: str) -> bool:
        if word in _ALWAYS or after not in _AFTER_NAMES:
            return False
        if word in _CALLED and after == "(":
            return False
        return word != "initial" or after not in ("-", "+")

    # -- the two moves --------------------------------------------------------------------

    def _shift(self, token: Token, terminal: str, state: int) -> bool:
        depth = self.depths[-1]
        if terminal in _NESTING or (terminal in ("PLUS", "MINUS") and self._is_sign()):
            depth += 1
            if depth > DEEPEST:
                span = Span(self.source, token.start, token.end)
                self.faults.append(Fault("LAG0106", f"this is nested more than {DEEPEST} deep", span))
                return False
        if terminal == "END" and not self._closes():
            return True
        if terminal in _BLOCKS and self.tokens[self.position - 1].text != "end":
            self.blocks.append(Block(token, self.tokens[self.position + 1], len(self.states)))
        self.states.append(state)
        self.values.append(token)
        self.starts.append(self.position)
        self.depths.append(depth)
        self.last_end = token.end
        self.position += 1
        return True

    def _reduce(self, number: int) -> None:
        origin, length, _, recipe = self.tables.rules[number]
        callback = self.callbacks[number]
        values = self.values
        if length:
            first = len(values) - length
            if callback is None and length == 1 and origin[0] != "_":
                value = values[-1]
                start = self.starts[-1]
            else:
                children: list[Any] = []
                for place in recipe:
                    child = None if place < 0 else values[first + place]
                    if type(child) is list:
                        children.extend(child)
                    else:
                        children.append(child)
                start = self.starts[first]
                if callback is not None:
                    begin = self.tokens[start].start
                    value = callback(children, Span(self.source, begin, max(begin, self.last_end)))
                else:
                    value = children if origin[0] == "_" else children[0]
            del values[first:], self.states[first:], self.starts[first:], self.depths[first:]
        else:
            start = self.position
            begin = self.tokens[start].start
            value = callback([None] * len(recipe), Span(self.source, begin, begin))
        if origin == "scene":
            self.blocks = [block for block in self.blocks if block.height < len(self.states)]
        self.states.append(self.tables.actions[self.states[-1]][origin])
        values.append(value)
        self.starts.append(start)
        self.depths.append(self.depths[-1])

    def _is_sign(self) -> bool:
        before = self.tokens[self.position - 1]
        return before.kind == SYMBOL and before.text not in (")", "]", "}")

    # -- blocks and their ends ---------------------------------------------------------------

    def _closes(self) -> bool:
        """Look at the `end` that comes: does it close the innermost block?  Where an inner block's
        own `end` is missing, put it in and say so; False then."""
        name = self.tokens[self.position + 1]
        if not self.blocks:
            return True
        block = self.blocks[-1]
        if name.kind != WORD or name.text == closing_word(block):
            self.blocks.pop()
            return True
        if any(closing_word(outer) == name.text for outer in self.blocks[:-1]):
            self._insert_end(block)
            return False
        span = Span(self.source, name.start, name.end)
        self._fault(mistakes.wrong_end(self.source, block.word, block.name, name, span))
        name.text = closing_word(block)
        self.blocks.pop()
        return True

    def _insert_end(self, block: Block) -> None:
        at = self.tokens[self.position]
        where = at.start
        self._fault(mistakes.missing_end(self.source, block.word, block.name, at))
        self.tokens[self.position : self.position] = [
            Token(WORD, "end", where, where),
            Token(WORD, closing_word(block), where, where),
            Token(SYMBOL, ";", where, where),
        ]

    # -- recovery ------------------------------------------------------------------------------

    def _recover(self, terminal: str) -> bool:
        """Say what is wrong at the token that cannot stand here, and get past it.  False where the
        reading ends."""
        if len(self.faults) >= MOST_FAULTS:
            return False
        token = self.tokens[self.position]
        bottom = self._item_bottom()
        if token.kind == END and self.blocks and bottom == len(self.states) - 1:
            self._insert_end(self.blocks[-1])
            return True
        if bottom is None:
            return False
        begin = self.starts[bottom + 1] if bottom + 1 < len(self.states) else self.position
        where = mistakes.Where(self, begin)
        found = mistakes.explain(where)
        self._fault(found.fault)
        if found.repair is not None and self._repair(found.repair):
            return True
        self._give_up(bottom, begin)
        return True

    def _fault(self, fault: Fault) -> None:
        self.faults.append(fault)

    def _item_bottom(self) -> int | None:
        """The height of the topmost state in which a declaration may begin."""
        for height in range(len(self.states) - 1, -1, -1):
            if "item" in self.tables.actions[self.states[height]]:
                return height
        return None

    def _repair(self, repair: tuple[int, list[Token]]) -> bool:
        """Replace so many tokens by others, where the text then reads on."""
        count, others = repair
        before = self.tokens[self.position : self.position + count]
        self.tokens[self.position : self.position + count] = others
        if self._reads_on(len(others) + 2):
            return True
        self.tokens[self.position : self.position + len(others)] = before
        return False

    def _reads_on(self, count: int) -> bool:
        """Can the machine take the next `count` tokens?  Nothing is built."""
        actions = self.tables.actions
        states = list(self.states)
        for position in range(self.position, min(self.position + count, len(self.tokens))):
            while True:
                action = actions[states[-1]].get(self.terminal(position, states[-1]))
                if action is None:
                    return False
                if action >= 0:
                    states.append(action)
                    break
                origin, length, _, _ = self.tables.rules[~action]
                if length:
                    del states[-length:]
                states.append(actions[states[-1]][origin])
            if self.tokens[position].kind == END:
                break
        return True

    def _give_up(self, bottom: int, begin: int) -> None:
        """Drop the declaration that began at token `begin` and go on behind it."""
        del self.states[bottom + 1 :], self.values[bottom + 1 :], self.starts[bottom + 1 :]
        del self.depths[bottom + 1 :]
        self.blocks = [block for block in self.blocks if block.height < len(self.states)]
        self.position = mistakes.behind(self.source, self.tokens, begin, self.position, self.tables.keywords)


def closing_word(block: Block) -> str:
    """What its `end` names."""
    return block.word.text if block.word.text in ("for", "when") else block.name.text
