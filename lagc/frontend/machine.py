"""The LALR(1) machine: tokens in, tree out, with repair and recovery.

At a fault it tries the small repairs first (one sign put in, replaced or left out, after which
the text reads on); else it gives the declaration up and goes on behind it.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from lagc.diagnostics.faults import Fault, Source, Span
from lagc.frontend.build import Builder
from lagc.frontend.lexer import END, NUMBER, STRING, SYMBOL, UNIT, WORD, Lexed, Token
from lagc.frontend.tables import Tables

if TYPE_CHECKING:
    from lagc.frontend.mistakes import Repair

DEEPEST = 100  # brackets, `if`s, signs and blocks inside one another
MOST_FAULTS = 50
MOST_REPAIRS = 200

_FIXED = {NUMBER: "NUMBER", STRING: "STRING", UNIT: "UNIT", END: "$END"}
_ALWAYS = frozenset({"if", "not", "true", "false", "end"})
# Keywords behind which a `(` or a sign may stand.
_BEFORE_SIGNS = {"simulate": "(", "annotation": "(", "initial": "(+-", "when": "(+-"}
_BLOCKS = frozenset({"MODEL", "PACKAGE", "EFFECT", "SCENE", "FOR", "WHEN"})
_OUTSIDE = {  # blocks that cannot stand in others
    "effect": ("MODEL", "PACKAGE", "EFFECT", "SCENE"),
    "scene": ("MODEL", "PACKAGE", "EFFECT", "SCENE"),
    "model": ("MODEL", "PACKAGE"),
}
_NESTING = frozenset({"LPAR", "LBRACE", "LSQB", "IF", "NOT", *_BLOCKS})
_AFTER_NAMES = frozenset(("<=", ">=", "==", "<>", *"=.[+-*/^,)]}:<>("))


@dataclass(slots=True)
class Block:
    """An open block: the word that opened it, its name's token, the height of the stack below."""

    word: Token
    name: Token
    height: int

    @property
    def closing(self) -> str:
        """What its `end` names."""
        return self.word.text if self.word.text in ("for", "when") else self.name.text

    @property
    def shown(self) -> str:
        word = self.word.text
        return f"this `{word}`" if self.closing == word else f"{word} `{self.closing}`"

    def span(self, source: Source) -> Span:
        last = self.word if self.closing == self.word.text else self.name
        return Span(source, self.word.start, max(self.word.end, last.end))


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
        self.last_closed: Block | None = None
        self._reported: set[int] = set()  # where declarations with a fault begin
        self._recoveries = 0
        self._reduced = False  # since the last token was taken
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
                    if not self._recover():
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
        return after not in _BEFORE_SIGNS.get(word, "")

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
            if self._left_open(terminal):
                return True
            self.blocks.append(Block(token, self.tokens[self.position + 1], len(self.states)))
        token.terminal = terminal
        self.states.append(state)
        self.values.append(token)
        self.starts.append(self.position)
        self.depths.append(depth)
        self.last_end = token.end
        self.position += 1
        self._reduced = False
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
        self._reduced = True
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
        self.last_closed = None
        if not self.blocks:
            return True
        block = self.blocks[-1]
        if name.kind == WORD and name.text != block.closing:
            if any(outer.closing == name.text for outer in self.blocks[:-1]):
                self._insert_end(block)
                return False
            self._report(_wrong_end(self.source, block, name), self.tokens[self.position])
            self.tokens[self.position + 1] = Token(WORD, block.closing, name.start, name.end)
        self.last_closed = self.blocks.pop()
        return True

    def _left_open(self, terminal: str) -> bool:
        """Does a block begin that the innermost open one cannot hold, and which has no `end` of its
        own further on?  Then that is put in."""
        if not self.blocks or terminal not in _OUTSIDE.get(self.blocks[-1].word.text, ()):
            return False
        block = self.blocks[-1]
        for number in range(self.position, len(self.tokens) - 1):
            if self.tokens[number].text == "end" and self.tokens[number + 1].text == block.closing:
                return False
        self._insert_end(block)
        return True

    def _insert_end(self, block: Block) -> None:
        at = self.tokens[self.position]
        self._report(_missing_end(self.source, block, at), block.word)
        self.tokens[self.position : self.position] = [
            Token(WORD, "end", at.start, at.start),
            Token(WORD, block.closing, at.start, at.start),
            Token(SYMBOL, ";", at.start, at.start),
        ]

    # -- recovery ------------------------------------------------------------------------------

    def _recover(self) -> bool:
        """Say what is wrong at the token that cannot stand here, and get past it.  False where the
        reading ends."""
        from lagc.frontend import mistakes

        self._recoveries += 1
        if len(self.faults) >= MOST_FAULTS or self._recoveries > MOST_REPAIRS:
            return False
        token = self.tokens[self.position]
        if self._end_unfinished():
            return True
        self._settle()
        bottom, begin = self._declaration(self.position)
        if token.kind == END and begin == self.position:
            if not self.blocks:
                return False
            self._insert_end(self.blocks[-1])
            return True
        brackets: list[Token] = []
        for value in self.values[bottom + 1 :]:
            if type(value) is Token and value.kind == SYMBOL and value.text in "([{":
                brackets.append(value)
            elif type(value) is Token and value.kind == SYMBOL and value.text in ")]}" and brackets:
                brackets.pop()
        found = mistakes.explain(mistakes.Where(self, begin, brackets))
        self._report(found.fault, self.tokens[begin])
        if found.repair is None or not self._repair(found.repair):
            self._give_up(bottom, begin)
        return True

    def _end_unfinished(self) -> bool:
        """Behind `end name`, or `end` alone: put in what is missing."""
        block = self.last_closed
        top = self.values[-1]
        if block is None or type(top) is not Token:
            return False
        at = self.tokens[self.position].start
        if top.text == "end" and "SEMICOLON" not in self.tables.actions[self.states[-1]]:
            span = Span(self.source, top.start, top.end)
            opened = ((block.span(self.source), "opened here"),)
            message, remedy = "an `end` names what it closes", f"write `end {block.closing};`"
            self._report(Fault("LAG0113", message, span, opened, remedy), top)
            self.tokens.insert(self.position, Token(WORD, block.closing, at, at))
            return True
        before = self.values[-2]
        if type(before) is not Token or before.text != "end" or top.text != block.closing:
            return False
        span = Span(self.source, top.end, top.end)
        remedy = f"write `end {block.closing};`"
        self._report(Fault("LAG0111", "a `;` is missing", span, (), remedy), before)
        self.tokens.insert(self.position, Token(SYMBOL, ";", at, at))
        return True

    def _settle(self) -> None:
        """Undo the reductions that the token at fault brought about, so that what may stand here can
        be told, and end the declaration that a `;` has ended."""
        if self._reduced and self.tokens[self.position - 1].text != ";":
            bottom, begin = self._declaration(self.position - 1)
            position = self.position
            self._drop(bottom, begin)
            self.position = begin
            self._replay(position)
        while self.position and self.tokens[self.position - 1].text == ";":
            actions = set(self.tables.actions[self.states[-1]].values())
            action = actions.pop()
            if actions or action >= 0:
                return
            self._reduce(~action)

    def _replay(self, position: int) -> None:
        """Take the tokens before number `position` again; they have been taken before."""
        while self.position < position:
            terminal = self.terminal(self.position, self.states[-1])
            action = self.tables.actions[self.states[-1]][terminal]
            if action < 0:
                self._reduce(~action)
            else:
                self._shift(self.tokens[self.position], terminal, action)

    def _report(self, fault: Fault, first: Token) -> None:
        """One fault a declaration, which begins with the token `first`, and none where its text has
        signs that are none."""
        end = self.source.text.find("\n", self.tokens[self.position].end)
        end = len(self.source.text) if end < 0 else end
        odd = fault.code != "LAG0112" and any(
            known.span is not None and first.start <= known.span.start < end for known in self.lexed.faults
        )
        if not odd and first.start not in self._reported:
            self._reported.add(first.start)
            self.faults.append(fault)

    def _declaration(self, position: int) -> tuple[int, int]:
        """The declaration around token number `position`: the height of the stack below it, and the
        number of its first token (that of the next token where none has begun)."""
        for height in range(len(self.states) - 1, -1, -1):
            if "item" in self.tables.actions[self.states[height]]:
                begin = self.starts[height + 1] if height + 1 < len(self.states) else self.position
                if begin <= position:
                    return height, begin
        return 0, 0

    def accepts(self, *terminals: str) -> bool:
        """Could such tokens stand here, one behind the other?"""
        states = list(self.states)
        return all(self._takes(states, terminal) for terminal in terminals)

    def _takes(self, states: list[int], terminal: str) -> bool:
        """Move `states` over one token; nothing is built."""
        actions = self.tables.actions
        while True:
            action = actions[states[-1]].get(terminal)
            if action is None:
                return False
            if action >= 0:
                states.append(action)
                return True
            origin, length, _, _ = self.tables.rules[~action]
            if length:
                del states[-length:]
            states.append(actions[states[-1]][origin])
            if terminal == "$END" and states[-1] == self.tables.accept:
                return True

    def _repair(self, repair: Repair) -> bool:
        """Make the change if the text then reads on, past the place of the fault.  A change before
        that place reads the declaration around it again from its beginning."""
        again = repair.at < self.position
        bottom, begin = self._declaration(repair.at)
        first = begin if again else repair.at
        tokens = self.tokens
        others = list(repair.others)
        before = tokens[repair.at : repair.at + repair.count]
        tokens[repair.at : repair.at + repair.count] = others
        last = max(self.position - repair.count, repair.at) + len(others) + (0 if again else 1)
        states = self.states[: bottom + 1] if again else list(self.states)
        if not self._reads_on(states, first, last):
            tokens[repair.at : repair.at + len(others)] = before
            return False
        if again:
            self._drop(bottom, begin)
            self.position = begin
        return True

    def _reads_on(self, states: list[int], first: int, last: int) -> bool:
        """Can the tokens first..last be taken from `states` on?"""
        for position in range(first, min(last + 1, len(self.tokens))):
            while True:
                terminal = self.terminal(position, states[-1])
                action = self.tables.actions[states[-1]].get(terminal)
                if action is None or action >= 0:
                    break
                origin, length, _, _ = self.tables.rules[~action]
                if length:
                    del states[-length:]
                states.append(self.tables.actions[states[-1]][origin])
                if terminal == "$END" and states[-1] == self.tables.accept:
                    return True
            if action is None:
                return terminal == "$END"  # what is open is closed there
            states.append(action)
        return True

    def _drop(self, bottom: int, begin: int) -> None:
        """Forget the declaration that began at token `begin`, on top of height `bottom`."""
        del self.states[bottom + 1 :], self.values[bottom + 1 :], self.starts[bottom + 1 :]
        del self.depths[bottom + 1 :]
        self.blocks = [block for block in self.blocks if block.height < len(self.states)]
        self.last_end = self.tokens[begin - 1].end if begin else 0
        self._reduced = False

    def _give_up(self, bottom: int, begin: int) -> None:
        """Drop the declaration that began at token `begin` and go on behind it: behind its `;`, or
        at an `end` or another keyword that begins a line."""
        self._drop(bottom, begin)
        for number in range(max(self.position, begin), len(self.tokens)):
            token = self.tokens[number]
            self.position = number
            if token.kind == END:
                return
            if token.kind == SYMBOL and token.text == ";":
                self.position = number + 1
                return
            keyword = number > begin and token.kind == WORD and token.text in self.tables.keywords
            if keyword and "\n" in self.source.text[self.tokens[number - 1].end : token.start]:
                return


def _wrong_end(source: Source, block: Block, name: Token) -> Fault:
    return Fault(
        "LAG0113",
        f"this `end` names `{name.text}`, but it closes {block.shown}",
        Span(source, name.start, name.end),
        related=((block.span(source), "opened here"),),
        remedy=f"write `end {block.closing};`",
    )


def _missing_end(source: Source, block: Block, at: Token) -> Fault:
    before = "the end of the file" if at.kind == END else f"this `{at.text}`"
    return Fault(
        "LAG0112",
        f"{block.shown} is not closed before {before}",
        Span(source, at.start, at.end),
        related=((block.span(source), "opened here"),),
        remedy=f"write `end {block.closing};`",
    )
