"""The LALR(1) parser.  `recovery` handles faults.

The tables are those of Lark; its interactive parser takes twice as long with them, and to import it takes a
fifth of the time in which a small model is checked.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any

from lagc.base.records import dataclass
from lagc.diagnostics.faults import Edit, Fault, Source, Span
from lagc.syntax.lalr_tables import Tables
from lagc.syntax.lexer import END, NUMBER, STRING, SYMBOL, UNIT, WORD, Lexed, Token
from lagc.syntax.tree_builder import Builder

DEEPEST = 100  # nesting of brackets, `if`s, signs and blocks
MOST_FAULTS = 50

_FIXED = {NUMBER: "NUMBER", STRING: "STRING", UNIT: "UNIT", END: "$END"}
ALWAYS = frozenset({"if", "not", "true", "false", "end"})
# Keywords that a `(` or a sign may follow.
BEFORE_SIGNS = {"simulate": "(", "annotation": "(", "initial": "(+-", "when": "(+-"}
_BLOCKS = frozenset({"MODEL", "PACKAGE", "EFFECT", "SCENE", "FOR", "WHEN"})
_OUTSIDE = {  # blocks that others cannot contain
    "effect": ("MODEL", "PACKAGE", "EFFECT", "SCENE"),
    "scene": ("MODEL", "PACKAGE", "EFFECT", "SCENE"),
    "model": ("MODEL", "PACKAGE"),
}
_NESTING = frozenset({"LPAR", "LBRACE", "LSQB", "IF", "NOT", *_BLOCKS})
AFTER_NAMES = frozenset(("<=", ">=", "==", "<>", *"=.[+-*/^,)]}:<>("))


@dataclass(frozen=True, slots=True)
class Block:
    """An open block: its keyword, its name, and the height of the stack below it."""

    word: Token
    name: Token
    height: int

    @property
    def end_name(self) -> str:
        """Return the name that its `end` needs."""
        return self.word.text if self.word.text in ("for", "when") else self.name.text

    @property
    def shown(self) -> str:
        word = self.word.text
        return f"this `{word}`" if self.end_name == word else f"{word} `{self.end_name}`"

    def fault(self, code: str, message: str, span: Span, edits: tuple[Edit, ...] = ()) -> Fault:
        """Return a fault of its `end`, with the place where the block begins."""
        last = self.word if self.end_name == self.word.text else self.name
        opened = Span(span.source, self.word.start, max(self.word.end, last.end))
        return Fault(
            code, message, span, ((opened, "opened here"),), f"write `end {self.end_name};`", edits=edits
        )


class Machine:
    """One parse of one text. Four parallel stacks: states, values (tokens and nodes), starts (the number of
    the first token of each value) and depths (nesting)."""

    def __init__(self, source: Source, tables: Tables, lexed: Lexed):
        self.source = source
        self.tables = tables
        self.lexed = lexed
        self.tokens = lexed.tokens
        self.faults: list[Fault] = []
        self.position = 0
        self.states = [tables.start]
        self.values: list[Any] = [None]
        self.starts = [0]
        self.depths = [0]
        self.blocks: list[Block] = []
        self.last_closed: Block | None = None
        self.last_end = 0  # end of the last token
        self.reduced = False  # since then
        self.recoveries = 0
        self._reported: set[int] = set()  # beginnings of declarations with a fault
        # Name -> how many tokens before the end of the text its last `end name` stands: changes are
        # made before that only.
        self._last_ends = {
            name.text: len(self.tokens) - number
            for number, (end, name) in enumerate(pairwise(self.tokens))
            if end.text == "end"
        }
        self.builder = Builder(source)
        self.callbacks: list[Any] = [
            None if name is None else getattr(self.builder, name) for _, _, name, _ in tables.rules
        ]

    def run(self, recover: Callable[[Machine], bool]) -> Any:
        """Return the tree, or None if parsing cannot continue; `recover` is called at each fault. `faults`
        and `builder.faults` hold the faults."""
        actions = self.tables.actions
        states = self.states
        accept = self.tables.accept
        # Most rules of expressions only return their child.
        passed = [
            origin if length == 1 and name is None and origin[0] != "_" else None
            for origin, length, name, _ in self.tables.rules
        ]
        while True:
            # One token: reductions until it can be shifted.
            token = self.tokens[self.position]
            terminal = self.terminal(self.position, states[-1])
            contextual = token.kind == WORD and token.text in self.tables.keywords
            while True:
                action = actions[states[-1]].get(terminal)
                if action is None:
                    # A word is a keyword or a name by the state, which the reductions have changed.
                    if contextual:
                        again = self.terminal(self.position, states[-1])
                        if again != terminal:
                            terminal = again
                            continue
                    if not recover(self):
                        return None
                    break
                if action >= 0:
                    if not self.shift(token, terminal, action):
                        return None
                    break
                # A rule that returns its only child changes the state alone.
                origin = passed[~action]
                if origin is not None:
                    states[-1] = actions[states[-2]][origin]
                    self.reduced = True
                else:
                    self.reduce(~action)
                if states[-1] == accept and token.kind == END:
                    return self.values[-1]

    def terminal(self, position: int, state: int) -> str:
        """Return the terminal of token number `position` in `state`."""
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
        if word in ALWAYS or after not in AFTER_NAMES:
            return False
        return after not in BEFORE_SIGNS.get(word, "")

    # -- the two moves --------------------------------------------------------------------

    def shift(self, token: Token, terminal: str, state: int) -> bool:
        # Nesting is limited, as later stages walk the tree recursively. A sign counts too: `----x`.
        depth = self.depths[-1]
        if terminal in _NESTING or (terminal in ("PLUS", "MINUS") and self._is_sign()):
            depth += 1
            if depth > DEEPEST:
                span = Span(self.source, token.start, token.end)
                self.faults.append(Fault("LAG0106", f"this is nested more than {DEEPEST} levels deep", span))
                return False
        # `end` closes the innermost open block; one that closes nothing, or an outer block, is a fault that
        # recovery handles.
        if terminal == "END" and not self._closes():
            return True
        if terminal in _BLOCKS and self._begins_block():
            if self._left_open(terminal):
                return True
            self.blocks.append(Block(token, self.tokens[self.position + 1], len(self.states)))
        # The state is pushed with its value, first token and depth: four stacks of one height.
        token.terminal = terminal
        self.states.append(state)
        self.values.append(token)
        self.starts.append(self.position)
        self.depths.append(depth)
        self.last_end = token.end
        self.position += 1
        self.reduced = False
        return True

    def reduce(self, number: int) -> None:
        origin, length, _, recipe = self.tables.rules[number]
        callback = self.callbacks[number]
        values = self.values
        if length:
            first = len(values) - length
            if callback is None and length == 1 and origin[0] != "_":
                value = values[-1]
                start = self.starts[-1]
            else:
                # The recipe picks the children that the rule keeps; those of inlined rules are lists.
                children: list[Any] = []
                for place in recipe:
                    child = None if place < 0 else values[first + place]
                    if type(child) is not list:
                        children.append(child)
                    elif children:
                        children.extend(child)
                    else:
                        children = child  # a growing list that is not shared
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
        # A scene without a body ends without an `end`.
        if origin == "scene":
            self.blocks = [block for block in self.blocks if block.height < len(self.states)]
        self.reduced = True
        self.states.append(self.tables.actions[self.states[-1]][origin])
        values.append(value)
        self.starts.append(start)
        self.depths.append(self.depths[-1])

    def _is_sign(self) -> bool:
        before = self.tokens[self.position - 1]
        return before.kind == SYMBOL and before.text not in (")", "]", "}")

    def _begins_block(self) -> bool:
        """Return whether this word begins a block (not `end for` or `{i^2 for i in 1:n}`)."""
        open_ = self.tables.actions[self.states[-1]].keys() & {"RBRACE", "RPAR"}
        return not open_ and self.tokens[self.position - 1].text != "end"

    # -- blocks and their ends ---------------------------------------------------------------

    def _closes(self) -> bool:
        """Return whether the next `end` closes the innermost block. A missing `end` of an inner block is
        reported and inserted."""
        name = self.tokens[self.position + 1]
        self.last_closed = None
        if not self.blocks:
            return True
        block = self.blocks[-1]
        if name.kind == WORD and name.text != block.end_name:
            if any(outer.end_name == name.text for outer in self.blocks[:-1]):
                self.insert_end(block)
                return False
            if block.end_name != "when" and self.recoveries < MOST_FAULTS and self._ends_further_on(block):
                self._leave_end_out(block, name)
                return False
            self.report(self._wrong_end(block, name), self.tokens[self.position])
            self.tokens[self.position + 1] = Token(WORD, block.end_name, name.start, name.end)
        self.last_closed = self.blocks.pop()
        return True

    def _wrong_end(self, block: Block, name: Token) -> Fault:
        message = f"this `end` names `{name.text}`, but it closes {block.shown}"
        edits = (Edit(name.start, name.end, block.end_name),)
        return block.fault("LAG0113", message, Span(self.source, name.start, name.end), edits)

    def _left_open(self, terminal: str) -> bool:
        """Return whether a block begins that the innermost one cannot contain, and whose `end` is missing; it
        is inserted."""
        if not self.blocks or terminal not in _OUTSIDE.get(self.blocks[-1].word.text, ()):
            return False
        block = self.blocks[-1]
        if self._ends_further_on(block):
            return False
        self.insert_end(block)
        return True

    def _ends_further_on(self, block: Block) -> bool:
        last = self._last_ends.get(block.end_name)
        return last is not None and len(self.tokens) - last >= self.position + 2

    def _leave_end_out(self, block: Block, name: Token) -> None:
        """Skip an `end` that belongs to no block, or to a block whose first line has a fault."""
        if not self.recoveries:
            self.report(self._wrong_end(block, name), self.tokens[self.position])
        self.recoveries += 1
        count = 3 if self.tokens[self.position + 2].text == ";" else 2
        del self.tokens[self.position : self.position + count]
        # The `end` reduced the declarations so far; more may follow.
        declared = self.values.pop()
        del self.states[-1], self.starts[-1], self.depths[-1]
        if declared:
            actions = self.tables.actions
            row = actions[self.states[-1]]
            # The state after `item*`.
            (behind,) = (row[name] for name in row if name.startswith("__") and "item" in actions[row[name]])
            self.states.append(behind)
            self.values.append(list(declared))
            self.starts.append(self.position)
            self.depths.append(self.depths[-1])

    def insert_end(self, block: Block) -> None:
        at = self.tokens[self.position]
        before = "the end of the file" if at.kind == END else f"this `{at.text}`"
        message = f"{block.shown} is not closed before {before}"
        edits = (self._missing_end(block, at),)
        self.report(block.fault("LAG0112", message, Span(self.source, at.start, at.end), edits), block.word)
        self.tokens[self.position : self.position] = [
            Token(WORD, "end", at.start, at.start),
            Token(WORD, block.end_name, at.start, at.start),
            Token(SYMBOL, ";", at.start, at.start),
        ]

    def _missing_end(self, block: Block, before: Token) -> Edit:
        """Return the `end` of a block: where a line begins, a line that is indented as the block is."""
        text, end = self.source.text, f"end {block.end_name};"
        line, opened = (text.rfind("\n", 0, token.start) + 1 for token in (before, block.word))
        if text[line : before.start].strip():
            return Edit(before.start, before.start, f" {end} ")
        indent = text[opened : block.word.start]
        return Edit(line, line, f"{'' if indent.strip() else indent}{end}\n")

    def report(self, fault: Fault, first: Token) -> bool:
        """Report at most one fault per declaration (first token `first`), and none where the lexer found
        one. Return whether it is reported."""
        end = self.source.text.find("\n", self.tokens[self.position].end)
        end = len(self.source.text) if end < 0 else end
        odd = fault.code != "LAG0112" and any(
            known.span is not None and first.start <= known.span.start < end for known in self.lexed.faults
        )
        if odd or first.start in self._reported:
            return False
        self._reported.add(first.start)
        self.faults.append(fault)
        return True
