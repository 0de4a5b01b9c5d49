"""What a person who wrote this most likely meant: syntax mistakes in the user's terms.

`explain` asks the functions of `_TABLE` in turn; the first that knows the mistake answers.
"""

from __future__ import annotations

from collections.abc import Callable

from lagc.diagnostics.faults import Fault
from lagc.syntax.mistakes import keywords, punctuation
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
    punctuation.foreign_operator,
    punctuation.comma_in_list,
    keywords.brace_for_block,
    keywords.else_when,
    keywords.if_statement,
    keywords.first_word,
    punctuation.comparison_for_equation,
    punctuation.equation_for_comparison,
    punctuation.decimal_comma,
    punctuation.comma_between_starts,
    punctuation.chained,
    punctuation.semicolon_too_many,
    keywords.missing_end_word,
    keywords.stray_end,
    punctuation.bare_unit,
    keywords.family,
    punctuation.brackets,
    keywords.load_target,
    keywords.missing_word,
    keywords.constraint_parts,
    keywords.description_last,
    punctuation.missing_semicolon,
    punctuation.missing_comma,
    punctuation.missing_operator,
    punctuation.missing_sign,
    punctuation.unit_behind_expression,
    punctuation.missing_value,
    keywords.missing_name,
)
