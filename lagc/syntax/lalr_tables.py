"""The parser's tables, made from `grammar/lag.lark` by Lark.

Lark reads the grammar and builds the LALR(1) automaton when lagc is installed (`hatch_build.py`);
what is kept is plain data, so that a run needs neither Lark nor the grammar's analysis.  Where it
is missing or belongs to another grammar, as in a checkout that is being worked on, the tables are
made when they are first needed, and kept in the cache.
"""

from __future__ import annotations

import marshal
import os
import sys
from collections.abc import Callable
from functools import cache
from typing import Any

from lagc.base.records import dataclass
from lagc.host import cache as store
from lagc.host.cache import grammar_path

_LAYOUT = "tables 1"  # of the data below; another one where it changes

# What a rule makes of its children: the places of those that count, -1 for "not written".
Recipe = tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Tables:
    """actions[state][symbol]: a terminal leads to the next state, or to ~rule (negative) to
    reduce; a nonterminal leads to the next state.

    rules: (nonterminal, length, callback or None, recipe).  Without a callback a rule passes its
    only child on, or, where the nonterminal is inlined (`_name`), the list of its children.
    """

    actions: list[dict[str, int]]
    rules: list[tuple[str, int, str | None, Recipe]]
    start: int
    accept: int
    keywords: dict[str, str]  # text -> terminal
    symbols: dict[str, str]


@cache
def tables() -> Tables:
    """The tables of the language."""
    grammar = grammar_text()
    shipped = _shipped(grammar)
    if shipped is not None:
        return shipped
    name = store.key(_LAYOUT, grammar, sys.version)
    kept = store.load("grammar", name, lambda body: Tables(*marshal.loads(body)))
    if kept is not None:
        return kept
    fields = _build(grammar)
    store.store("grammar", name, marshal.dumps(fields))
    return Tables(*fields)


def grammar_text() -> str:
    with open(grammar_path(), encoding="utf-8") as file:
        return file.read()


def shipped_path() -> str:
    """Where the tables lie that were made when lagc was installed."""
    return os.path.join(os.path.dirname(os.path.abspath(__file__)), "tables.json")


def packed() -> str:
    """The tables as text, with the key of their grammar: what `hatch_build.py` ships."""
    import json

    grammar = grammar_text()
    return json.dumps([store.key(_LAYOUT, grammar), *_build(grammar)], separators=(",", ":"))


def _shipped(grammar: str) -> Tables | None:
    import json

    try:
        with open(shipped_path(), encoding="utf-8") as file:
            key, *fields = json.load(file)
        return Tables(*fields) if key == store.key(_LAYOUT, grammar) else None
    except (OSError, ValueError, TypeError):
        return None


def _build(grammar: str) -> tuple[Any, ...]:
    from lark import Lark
    from lark.grammar import Rule
    from lark.lexer import PatternStr, TerminalDef

    lark = Lark(grammar, parser="lalr", start="file", maybe_placeholders=True)
    data, memo = lark.memo_serialize([TerminalDef, Rule])
    automaton = data["parser"]["parser"]
    symbols = automaton["tokens"]
    order = _in_order(automaton)
    number = {state: position for position, state in enumerate(order)}
    rules: list[tuple[str, int, str | None, Recipe]] = []
    rule_number: dict[int, int] = {}
    actions: list[dict[str, int]] = []
    for state in order:
        row: dict[str, int] = {}
        for symbol, (reduces, argument) in sorted(automaton["states"][state].items(), key=_by_name(symbols)):
            if reduces:
                key = argument["@"]
                if key not in rule_number:
                    rule_number[key] = len(rules)
                    rules.append(_rule(Rule.deserialize(memo[key], memo)))
                row[symbols[symbol]] = ~rule_number[key]
            else:
                row[symbols[symbol]] = number[argument]
        actions.append(row)
    fixed = {t.pattern.value: t.name for t in lark.terminals if isinstance(t.pattern, PatternStr)}
    keywords = {text: name for text, name in fixed.items() if text[0].isalpha()}
    signs = {text: name for text, name in fixed.items() if not text[0].isalpha()}
    return (
        actions,
        rules,
        number[automaton["start_states"]["file"]],
        number[automaton["end_states"]["file"]],
        keywords,
        signs,
    )


def _by_name(symbols: dict[int, str]) -> Callable[[tuple[int, Any]], str]:
    return lambda item: symbols[item[0]]


def _in_order(automaton: dict[str, Any]) -> list[int]:
    """The states as they are met from the first one on: Lark's own numbers differ from run to run."""
    order: list[int] = [automaton["start_states"]["file"]]
    met = set(order)
    for state in order:  # which grows
        for _, (reduces, argument) in sorted(
            automaton["states"][state].items(), key=_by_name(automaton["tokens"])
        ):
            if not reduces and argument not in met:
                met.add(argument)
                order.append(argument)
    return order


def _rule(rule: Any) -> tuple[str, int, str | None, Recipe]:
    origin = str(rule.origin.name)  # in Lark 1.2 a token
    recipe: list[int] = []
    written = rule.options.empty_indices or (False,) * len(rule.expansion)
    position = 0
    for absent in written:
        if absent:
            recipe.append(-1)
            continue
        symbol = rule.expansion[position]
        if rule.options.keep_all_tokens or not (symbol.is_term and symbol.filter_out):
            recipe.append(position)
        position += 1
    callback: str | None = str(rule.alias or origin)
    if rule.alias is None and (origin.startswith("_") or (rule.options.expand1 and len(recipe) == 1)):
        callback = None
    return origin, len(rule.expansion), callback, tuple(recipe)
