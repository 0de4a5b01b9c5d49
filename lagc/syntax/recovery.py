"""Recovery from syntax faults: explain the fault, repair the text, continue.

Small repairs come first (one token inserted, replaced or removed, after which the text can be parsed).
Otherwise the declaration is skipped.  `explain` asks the functions of `_TABLE` in turn; the first that knows
the mistake answers.
"""

from collections.abc import Callable

from lagc.base.records import replace
from lagc.diagnostics.faults import Edit, Fault, Span
from lagc.syntax.lalr import MOST_FAULTS, Machine
from lagc.syntax.lexer import END, SYMBOL, WORD, Token
from lagc.syntax.mistakes import Explained, Repair, Where, explained, keywords, signs

MOST_RECOVERIES = 200
_CLOSE = tuple(";,)]}([")  # no blank stands before them


def recover(machine: Machine) -> bool:
    """Report the unexpected token and get past it.  Return False if parsing ends here."""
    return Recovery(machine).run()


class Recovery:
    def __init__(self, machine: Machine):
        self.machine = machine

    def run(self) -> bool:
        """Report the unexpected token and get past it.  Return False if parsing ends here."""
        machine = self.machine
        machine.recoveries += 1
        # A file that is no model at all would otherwise be reported token by token.
        if len(machine.faults) >= MOST_FAULTS or machine.recoveries > MOST_RECOVERIES:
            return False
        token = machine.tokens[machine.position]
        # Before anything is undone: `end` is the last thing on the stack, which the steps below would take
        # away.
        if self._end_unfinished():
            return True
        self._end_reductions()
        bottom, begin = self._declaration(machine.position)
        # At the end of the text, between declarations: nothing is unexpected but the end, so open blocks are
        # closed from the inside out, each with its fault.
        if token.kind == END and begin == machine.position:
            if not machine.blocks:
                return False
            machine.insert_end(machine.blocks[-1])
            return True
        # Brackets that are open in this declaration, from the tokens that are still on the stack; those of
        # finished expressions have been reduced.
        brackets: list[Token] = []
        for value in machine.values[bottom + 1 :]:
            if type(value) is Token and value.kind == SYMBOL and value.text in "([{":
                brackets.append(value)
            elif type(value) is Token and value.kind == SYMBOL and value.text in ")]}" and brackets:
                brackets.pop()
        found = explain(Where(machine, self.accepts, begin, brackets))
        reported, count = machine.report(found.fault, machine.tokens[begin]), len(machine.faults)
        # Edits are computed first: a repair changes the list of tokens.
        edits = self._edits(found.repair) if found.repair is not None else ()
        if found.repair is None or not self._repair(found.repair):
            self._give_up(bottom, begin)
        # An edit is offered to the user only if parsing got past the fault with it.
        elif reported:
            machine.faults[count - 1] = replace(found.fault, edits=edits)
        return True

    def _edits(self, repair: Repair) -> tuple[Edit, ...]:
        """Return a repair as an edit of the text."""
        tokens, source, text = self.machine.tokens, self.machine.source.text, ""
        # Blanks as a formatter would set them: none before punctuation, none after an opening bracket.
        for token in repair.others:
            close = not text or token.text in _CLOSE or text[-1] in "([{"
            text += token.text if close else f" {token.text}"
        old = tokens[repair.at : repair.at + repair.count]
        at = old[0].start if old else tokens[repair.at - 1].end if repair.at else 0
        # New text needs a blank before it where it would join a word; an insertion also where it is no
        # punctuation.
        apart = text[:1] not in _CLOSE if not old else text[:1].isalnum() and source[at - 1 : at].isalnum()
        return (Edit(at, old[-1].end if old else at, f" {text}" if apart else text),)

    def _end_unfinished(self) -> bool:
        """Complete an `end` without a name or without `;`."""
        machine = self.machine
        block = machine.last_closed
        top = machine.values[-1]
        if block is None or type(top) is not Token:
            return False
        at = machine.tokens[machine.position].start
        # The state after `end` expects a name, unless this block has none, so that `;` may follow.
        if top.text == "end" and "SEMICOLON" not in machine.tables.actions[machine.states[-1]]:
            span = Span(machine.source, top.start, top.end)
            edits = (Edit(top.end, top.end, f" {block.end_name}"),)
            fault = block.fault("LAG0113", "`end` needs the name of its block", span, edits)
            machine.report(fault, top)
            machine.tokens.insert(machine.position, Token(WORD, block.end_name, at, at))
            return True
        before = machine.values[-2]
        if type(before) is not Token or before.text != "end" or top.text != block.end_name:
            return False
        span = Span(machine.source, top.end, top.end)
        remedy = f"write `end {block.end_name};`"
        edits = (Edit(top.end, top.end, ";"),)
        machine.report(Fault("LAG0111", "a `;` is missing", span, (), remedy, edits=edits), before)
        machine.tokens.insert(machine.position, Token(SYMBOL, ";", at, at))
        return True

    def _end_reductions(self) -> None:
        """Undo the reductions that the unexpected token caused, and finish a declaration that a `;` ended."""
        machine = self.machine
        # An LALR parser with default reductions reduces before it notices the error (Aho et al., *Compilers*,
        # 2006, section 4.8), so the stack no longer shows the state in which the token was unexpected. The
        # declaration is parsed again up to there.
        if machine.reduced and machine.tokens[machine.position - 1].text != ";":
            bottom, begin = self._declaration(machine.position - 1)
            position = machine.position
            self._drop(bottom, begin)
            machine.position = begin
            self._replay(position)
        # Behind a `;` the only action left is to reduce what it ended: done now, so that repairs do not touch
        # the finished declaration.
        while machine.position and machine.tokens[machine.position - 1].text == ";":
            actions = set(machine.tables.actions[machine.states[-1]].values())
            action = actions.pop()
            if actions or action >= 0:
                return
            machine.reduce(~action)

    def _replay(self, position: int) -> None:
        """Parse the tokens before number `position` again."""
        machine = self.machine
        while machine.position < position:
            terminal = machine.terminal(machine.position, machine.states[-1])
            action = machine.tables.actions[machine.states[-1]].get(terminal)
            if action is None:
                return
            if action < 0:
                machine.reduce(~action)
            else:
                machine.shift(machine.tokens[machine.position], terminal, action)

    def _declaration(self, position: int) -> tuple[int, int]:
        """Return the height of the stack below the declaration at token `position`, and the number of its
        first token."""
        machine = self.machine
        # From the top of the stack down to the innermost state in which a declaration (`item`) could begin,
        # and has begun at or before this token.
        for height in range(len(machine.states) - 1, -1, -1):
            if "item" in machine.tables.actions[machine.states[height]]:
                begin = machine.starts[height + 1] if height + 1 < len(machine.states) else machine.position
                if begin <= position:
                    return height, begin
        return 0, 0

    def accepts(self, *terminals: str) -> bool:
        """Return whether these terminals can follow here, one after the other."""
        # The simulation works on a copy of the states alone, so asking costs no nodes and changes nothing.
        states = list(self.machine.states)
        return all(self._takes(states, terminal) for terminal in terminals)

    def _takes(self, states: list[int], terminal: str) -> bool:
        """Advance `states` over one terminal without building nodes."""
        machine = self.machine
        actions = machine.tables.actions
        while True:
            action = actions[states[-1]].get(terminal)
            if action is None:
                return False
            if action >= 0:
                states.append(action)
                return True
            # A negative action is the complement of the number of a rule: pop its right side, go to its left
            # side.
            origin, length, _, _ = machine.tables.rules[~action]
            if length:
                del states[-length:]
            states.append(actions[states[-1]][origin])
            if terminal == "$END" and states[-1] == machine.tables.accept:
                return True

    def _repair(self, repair: Repair) -> bool:
        """Apply a repair if the text can then be parsed past the fault. A repair before the fault parses the
        declaration around it again from its beginning."""
        machine = self.machine
        # A repair before the fault needs states that are gone, so the declaration begins anew; one at the
        # fault goes on from the present states.
        again = repair.at < machine.position
        bottom, begin = self._declaration(repair.at)
        first = begin if again else repair.at
        tokens = machine.tokens
        others = list(repair.others)
        before = tokens[repair.at : repair.at + repair.count]
        tokens[repair.at : repair.at + repair.count] = others
        # The repaired text must parse through the token that was unexpected, or, if that was replaced,
        # through the one after it: a repair that only moves the fault is none.
        last = max(machine.position - repair.count, repair.at) + len(others) + (0 if again else 1)
        states = machine.states[: bottom + 1] if again else list(machine.states)
        if not self._reads_on(states, first, last):
            tokens[repair.at : repair.at + len(others)] = before
            return False
        if again:
            self._drop(bottom, begin)
            machine.position = begin
        return True

    def _reads_on(self, states: list[int], first: int, last: int) -> bool:
        """Return whether the tokens first..last can be parsed from `states` on."""
        machine = self.machine
        for position in range(first, min(last + 1, len(machine.tokens))):
            while True:
                terminal = machine.terminal(position, states[-1])
                action = machine.tables.actions[states[-1]].get(terminal)
                if action is None or action >= 0:
                    break
                origin, length, _, _ = machine.tables.rules[~action]
                if length:
                    del states[-length:]
                states.append(machine.tables.actions[states[-1]][origin])
                if terminal == "$END" and states[-1] == machine.tables.accept:
                    return True
            if action is None:
                return terminal == "$END"  # what is open is closed there
            states.append(action)
        return True

    def _drop(self, bottom: int, begin: int) -> None:
        """Remove the declaration that began at token `begin` from the stacks."""
        machine = self.machine
        for stack in (machine.states, machine.values, machine.starts, machine.depths):
            del stack[bottom + 1 :]
        # Blocks that began within the declaration go with it.
        machine.blocks = [block for block in machine.blocks if block.height < len(machine.states)]
        machine.last_end = machine.tokens[begin - 1].end if begin else 0
        machine.reduced = False

    def _give_up(self, bottom: int, begin: int) -> None:
        """Skip the declaration up to its `;`, or to an `end` or another keyword at the beginning of a
        line."""
        machine = self.machine
        self._drop(bottom, begin)
        for number in range(max(machine.position, begin), len(machine.tokens)):
            token = machine.tokens[number]
            machine.position = number
            if token.kind == END:
                return
            if token.kind == SYMBOL and token.text == ";":
                machine.position = number + 1
                return
            # A keyword at the beginning of a line probably begins the next declaration: a missing `;` then
            # does not swallow that one.
            keyword = number > begin and token.kind == WORD and token.text in machine.tables.keywords
            if keyword and "\n" in machine.source.text[machine.tokens[number - 1].end : token.start]:
                return


def explain(where: Where) -> Explained:
    """Return the fault of an unexpected token."""
    for known in _TABLE:
        explained = known(where)
        if explained is not None:
            return explained
    return _anything_else(where)


def _anything_else(w: Where) -> Explained:
    if not w.inside:
        message = f"{w.shown} does not begin a declaration"
        begins = "begin with a keyword (`parameter`, `body`, ...) or the name of a model"
        return explained("LAG0110", message, w.span(w.token), begins)
    remedy = "a `;` or an operator may be missing" if w.accepts("SEMICOLON") else None
    message = f"{w.shown} cannot stand after `{w.before.text}`"
    return explained("LAG0110", message, w.span(w.token), remedy)


# The order matters: the first that recognizes the text explains it. Specific patterns of other languages come
# first. Last come missing words and signs, which fit almost any text.
_TABLE: tuple[Callable[[Where], Explained | None], ...] = (
    keywords.solver_call,
    keywords.scene_arguments,
    signs.python_function,
    signs.foreign_operator,
    signs.step_by_one,
    signs.energy_without_name,
    signs.comma_in_list,
    keywords.brace_for_block,
    keywords.else_when,
    keywords.if_statement,
    keywords.joint_form,
    keywords.without_kind,
    keywords.another_name,
    keywords.import_as,
    keywords.annotation_behind,
    keywords.first_word,
    signs.comparison_for_equation,
    signs.equation_for_comparison,
    signs.decimal_comma,
    signs.comma_between_starts,
    signs.power_of_function,
    signs.chained_comparison,
    signs.semicolon_too_many,
    keywords.missing_end_word,
    keywords.stray_end,
    signs.number_of_another_language,
    signs.bare_unit,
    signs.size_before_name,
    keywords.family,
    keywords.python_choice,
    keywords.conditional_component,
    signs.vector_in_brackets,
    signs.vector_in_parentheses,
    signs.colon_for_equal,
    signs.brackets,
    keywords.load_target_first,
    keywords.load_target,
    keywords.loop_of_another_language,
    keywords.missing_word,
    keywords.constraint_parts,
    keywords.description_last,
    signs.missing_semicolon,
    signs.missing_comma,
    signs.missing_operator,
    signs.missing_sign,
    signs.unit_behind_expression,
    signs.missing_value,
    keywords.missing_name,
)
