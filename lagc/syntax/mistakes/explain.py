"""What a person who wrote this most likely meant: syntax mistakes in the user's terms.

`explain` asks the functions of `_TABLE` in turn; the first that knows the mistake answers.
"""

from __future__ import annotations

from collections.abc import Callable

from lagc.diagnostics.faults import Fault
from lagc.syntax.mistakes import keywords as words
from lagc.syntax.mistakes import punctuation as signs
from lagc.syntax.mistakes.context import Explained, Where


def explain(where: Where) -> Explained:
    """The fault at a token that cannot stand where it does."""
    for known in _TABLE:
        explained = known(where)
        if explained is not None:
            return explained
    return _anything_else(where)


def _anything_else(w: Where) -> Explained:
    if not w.inside:
        message = f"{w.shown} begins no declaration"
        begins = "one begins with a keyword (`parameter`, `body`, ...) or the name of a model"
        return Explained(Fault("LAG0110", message, w.span(w.token), remedy=begins))
    remedy = "is a `;` or an operator missing?" if w.accepts("SEMICOLON") else None
    message = f"{w.shown} cannot stand after `{w.before.text}`"
    return Explained(Fault("LAG0110", message, w.span(w.token), remedy=remedy))


_TABLE: tuple[Callable[[Where], Explained | None], ...] = (
    signs.foreign_operator,
    signs.comma_in_list,
    words.brace_for_block,
    words.else_when,
    words.if_statement,
    words.first_word,
    signs.comparison_for_equation,
    signs.equation_for_comparison,
    signs.decimal_comma,
    signs.comma_between_starts,
    signs.chained,
    signs.semicolon_too_many,
    words.missing_end_word,
    words.stray_end,
    signs.bare_unit,
    words.family,
    signs.brackets,
    words.load_target,
    words.missing_word,
    words.constraint_parts,
    words.description_last,
    signs.missing_semicolon,
    signs.missing_comma,
    signs.missing_operator,
    signs.missing_sign,
    signs.unit_behind_expression,
    signs.missing_value,
    words.missing_name,
)
