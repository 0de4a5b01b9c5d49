"""At a fault: what is wrong is said, and the text is read on behind it.

The small repairs are tried first (one sign put in, replaced or left out, after which the text
reads on); else the declaration is given up and reading goes on behind it.
"""

from __future__ import annotations

from lagc.diagnostics.faults import Fault, Span
from lagc.frontend import mistakes
from lagc.frontend.lexer import END, SYMBOL, WORD, Token
from lagc.frontend.machine import MOST_FAULTS, Machine

MOST_RECOVERIES = 200


def recover(machine: Machine) -> bool:
    """Say what is wrong at the token that cannot stand where the machine is, and get past it.  False
    where the reading ends."""
    return Recovery(machine).run()


class Recovery:
    """One fault of one text."""

    def __init__(self, machine: Machine):
        self.machine = machine

    def run(self) -> bool:
        """Say what is wrong at the token that cannot stand here, and get past it.  False where the
        reading ends."""
        self.machine.recoveries += 1
        if len(self.machine.faults) >= MOST_FAULTS or self.machine.recoveries > MOST_RECOVERIES:
            return False
        token = self.machine.tokens[self.machine.position]
        if self._end_unfinished():
            return True
        self._settle()
        bottom, begin = self._declaration(self.machine.position)
        if token.kind == END and begin == self.machine.position:
            if not self.machine.blocks:
                return False
            self.machine.insert_end(self.machine.blocks[-1])
            return True
        brackets: list[Token] = []
        for value in self.machine.values[bottom + 1 :]:
            if type(value) is Token and value.kind == SYMBOL and value.text in "([{":
                brackets.append(value)
            elif type(value) is Token and value.kind == SYMBOL and value.text in ")]}" and brackets:
                brackets.pop()
        found = mistakes.explain(mistakes.Where(self, begin, brackets))
        self.machine.report(found.fault, self.machine.tokens[begin])
        if found.repair is None or not self._repair(found.repair):
            self._give_up(bottom, begin)
        return True

    def _end_unfinished(self) -> bool:
        """Behind `end name`, or `end` alone: put in what is missing."""
        block = self.machine.last_closed
        top = self.machine.values[-1]
        if block is None or type(top) is not Token:
            return False
        at = self.machine.tokens[self.machine.position].start
        if top.text == "end" and "SEMICOLON" not in self.machine.tables.actions[self.machine.states[-1]]:
            span = Span(self.machine.source, top.start, top.end)
            opened = ((block.span(self.machine.source), "opened here"),)
            message, remedy = "an `end` names what it closes", f"write `end {block.closing};`"
            self.machine.report(Fault("LAG0113", message, span, opened, remedy), top)
            self.machine.tokens.insert(self.machine.position, Token(WORD, block.closing, at, at))
            return True
        before = self.machine.values[-2]
        if type(before) is not Token or before.text != "end" or top.text != block.closing:
            return False
        span = Span(self.machine.source, top.end, top.end)
        remedy = f"write `end {block.closing};`"
        self.machine.report(Fault("LAG0111", "a `;` is missing", span, (), remedy), before)
        self.machine.tokens.insert(self.machine.position, Token(SYMBOL, ";", at, at))
        return True

    def _settle(self) -> None:
        """Undo the reductions that the token at fault brought about, so that what may stand here can
        be told, and end the declaration that a `;` has ended."""
        if self.machine.reduced and self.machine.tokens[self.machine.position - 1].text != ";":
            bottom, begin = self._declaration(self.machine.position - 1)
            position = self.machine.position
            self._drop(bottom, begin)
            self.machine.position = begin
            self._replay(position)
        while self.machine.position and self.machine.tokens[self.machine.position - 1].text == ";":
            actions = set(self.machine.tables.actions[self.machine.states[-1]].values())
            action = actions.pop()
            if actions or action >= 0:
                return
            self.machine.reduce(~action)

    def _replay(self, position: int) -> None:
        """Take the tokens before number `position` again; they have been taken before."""
        while self.machine.position < position:
            terminal = self.machine.terminal(self.machine.position, self.machine.states[-1])
            action = self.machine.tables.actions[self.machine.states[-1]].get(terminal)
            if action is None:
                return
            if action < 0:
                self.machine.reduce(~action)
            else:
                self.machine.shift(self.machine.tokens[self.machine.position], terminal, action)

    def _declaration(self, position: int) -> tuple[int, int]:
        """The declaration around token number `position`: the height of the stack below it, and the
        number of its first token (that of the next token where none has begun)."""
        for height in range(len(self.machine.states) - 1, -1, -1):
            if "item" in self.machine.tables.actions[self.machine.states[height]]:
                begin = (
                    self.machine.starts[height + 1]
                    if height + 1 < len(self.machine.states)
                    else self.machine.position
                )
                if begin <= position:
                    return height, begin
        return 0, 0

    def accepts(self, *terminals: str) -> bool:
        """Could such tokens stand here, one behind the other?"""
        states = list(self.machine.states)
        return all(self._takes(states, terminal) for terminal in terminals)

    def _takes(self, states: list[int], terminal: str) -> bool:
        """Move `states` over one token; nothing is built."""
        actions = self.machine.tables.actions
        while True:
            action = actions[states[-1]].get(terminal)
            if action is None:
                return False
            if action >= 0:
                states.append(action)
                return True
            origin, length, _, _ = self.machine.tables.rules[~action]
            if length:
                del states[-length:]
            states.append(actions[states[-1]][origin])
            if terminal == "$END" and states[-1] == self.machine.tables.accept:
                return True

    def _repair(self, repair: mistakes.Repair) -> bool:
        """Make the change if the text then reads on, past the place of the fault.  A change before
        that place reads the declaration around it again from its beginning."""
        again = repair.at < self.machine.position
        bottom, begin = self._declaration(repair.at)
        first = begin if again else repair.at
        tokens = self.machine.tokens
        others = list(repair.others)
        before = tokens[repair.at : repair.at + repair.count]
        tokens[repair.at : repair.at + repair.count] = others
        last = max(self.machine.position - repair.count, repair.at) + len(others) + (0 if again else 1)
        states = self.machine.states[: bottom + 1] if again else list(self.machine.states)
        if not self._reads_on(states, first, last):
            tokens[repair.at : repair.at + len(others)] = before
            return False
        if again:
            self._drop(bottom, begin)
            self.machine.position = begin
        return True

    def _reads_on(self, states: list[int], first: int, last: int) -> bool:
        """Can the tokens first..last be taken from `states` on?"""
        for position in range(first, min(last + 1, len(self.machine.tokens))):
            while True:
                terminal = self.machine.terminal(position, states[-1])
                action = self.machine.tables.actions[states[-1]].get(terminal)
                if action is None or action >= 0:
                    break
                origin, length, _, _ = self.machine.tables.rules[~action]
                if length:
                    del states[-length:]
                states.append(self.machine.tables.actions[states[-1]][origin])
                if terminal == "$END" and states[-1] == self.machine.tables.accept:
                    return True
            if action is None:
                return terminal == "$END"  # what is open is closed there
            states.append(action)
        return True

    def _drop(self, bottom: int, begin: int) -> None:
        """Forget the declaration that began at token `begin`, on top of height `bottom`."""
        del (
            self.machine.states[bottom + 1 :],
            self.machine.values[bottom + 1 :],
            self.machine.starts[bottom + 1 :],
        )
        del self.machine.depths[bottom + 1 :]
        self.machine.blocks = [
            block for block in self.machine.blocks if block.height < len(self.machine.states)
        ]
        self.machine.last_end = self.machine.tokens[begin - 1].end if begin else 0
        self.machine.reduced = False

    def _give_up(self, bottom: int, begin: int) -> None:
        """Drop the declaration that began at token `begin` and go on behind it: behind its `;`, or
        at an `end` or another keyword that begins a line."""
        self._drop(bottom, begin)
        for number in range(max(self.machine.position, begin), len(self.machine.tokens)):
            token = self.machine.tokens[number]
            self.machine.position = number
            if token.kind == END:
                return
            if token.kind == SYMBOL and token.text == ";":
                self.machine.position = number + 1
                return
            keyword = number > begin and token.kind == WORD and token.text in self.machine.tables.keywords
            if (
                keyword
                and "\n" in self.machine.source.text[self.machine.tokens[number - 1].end : token.start]
            ):
                return
