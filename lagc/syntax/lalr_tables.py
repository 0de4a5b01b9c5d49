"""The parser tables, made from `grammar/lag.lark` by Lark.

Lark builds the LALR(1) automaton when lagc is installed (`hatch_build.py`), and the tables are stored as
plain data, so that a run does not need Lark.  If they are missing or belong to another grammar, as in a
checkout, they are made when first needed and stored in the cache.
"""

import marshal
import os
import sys
from collections.abc import Callable
from functools import cache
from typing import Any

from lagc.base.records import dataclass
from lagc.host import cache as store
from lagc.host.cache import grammar_path

_LAYOUT = "tables 1"  # version of the data below

# The positions of the children that a rule uses, -1 for "not written".
Recipe = tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Tables:
    """actions[state][symbol]: the next state, or ~rule (negative) to reduce. rules: (nonterminal, length,
    callback or None, recipe).  A rule without a callback returns its only child, or the list of its children
    if the nonterminal is inlined (`_name`)."""

    actions: list[dict[str, int]]
    rules: list[tuple[str, int, str | None, Recipe]]
    start: int
    accept: int
    keywords: dict[str, str]  # text -> terminal
    symbols: dict[str, str]


@cache
def tables() -> Tables:
    grammar = grammar_text()
    shipped = _load_shipped(grammar)
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
    """Return the path of the tables made at installation."""
    return os.path.join(os.path.dirname(os.path.abspath(__file__)), "tables.json")


def packed() -> str:
    """Return the tables as text, with the key of their grammar."""
    import json

    grammar = grammar_text()
    return json.dumps([store.key(_LAYOUT, grammar), *_build(grammar)], separators=(",", ":"))


def _load_shipped(grammar: str) -> Tables | None:
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
    # States and rules are numbered by their first use, since Lark's numbers are not reproducible.
    order = _in_order(automaton)
    number = {state: position for position, state in enumerate(order)}
    rules: list[tuple[str, int, str | None, Recipe]] = []
    rule_number: dict[int, int] = {}
    actions: list[dict[str, int]] = []
    for state in order:
        row: dict[str, int] = {}
        for symbol, (reduces, argument) in sorted(automaton["states"][state].items(), key=_by_name(symbols)):
            # A reduction is stored as ~rule, a shift as the number of the next state.
            if reduces:
                key = argument["@"]
                if key not in rule_number:
                    rule_number[key] = len(rules)
                    rules.append(_rule(Rule.deserialize(memo[key], memo)))
                row[symbols[symbol]] = ~rule_number[key]
            else:
                row[symbols[symbol]] = number[argument]
        actions.append(row)
    # Terminals that are one text: keywords and signs.
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
    """Return the states in the order of their first use, because Lark's numbers differ from run to run."""
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
