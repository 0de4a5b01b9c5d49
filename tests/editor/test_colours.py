"""Colours against the words, units and comments of the parser; the grammar of the folder `editors`."""

import json
from pathlib import Path

import pytest

from lagc.diagnostics.faults import Source
from lagc.editor.colours import textmate
from lagc.syntax.parse import read
from tests.editor.texts import LIBRARY, ROOT, text_of

lexers = pytest.importorskip("lagc.editor.pygments_lexer")
CLASSES = {  # of the parser -> the beginnings of Pygments' tokens
    "keyword": ("Token.Keyword", "Token.Operator.Word"),
    "name": ("Token.Name", "Token.Keyword.Type"),
    "unit": ("Token.Name.Attribute",), "number": ("Token.Literal.Number",),
    "string": ("Token.Literal.String",),
    "comment": ("Token.Comment",),
}  # fmt: skip


def test_the_grammar_for_editors_is_made_from_the_table() -> None:
    path = ROOT / "editors" / "vscode" / "syntaxes" / "lag.tmLanguage.json"
    assert json.loads(path.read_text(encoding="utf-8")) == textmate()


def different(path: Path) -> tuple[list[str], int]:
    """The words of a text that have another colour than by the parser, and the number of all."""
    text = text_of(path)
    _, lexed, faults = read(Source(str(path), text))
    assert not faults
    tokens = [""] * len(text)
    for start, token, value in lexers.LagLexer(stripnl=False, ensurenl=False).get_tokens_unprocessed(text):
        tokens[start : start + len(value)] = [str(token)] * len(value)
    assert "Token.Error" not in tokens
    found: list[str] = []
    known = [token for token in (*lexed.tokens, *lexed.comments) if token.kind not in ("symbol", "end")]
    for token in known:
        kind = token.kind if token.kind != "word" else "name" if token.terminal == "NAME" else "keyword"
        if not tokens[token.end - 1].startswith(CLASSES[kind]):
            found.append(f"{token.text} in line {text.count(chr(10), 0, token.start) + 1} of {path.stem}")
    return found, len(known)


@pytest.mark.sample(10)
@pytest.mark.parametrize("path", LIBRARY, ids=lambda path: path.stem)
def test_colours_are_those_of_the_parser(path: Path) -> None:
    """A keyword is told by the sign that follows: a scene `start uses a` is taken for one."""
    found, count = different(path)
    assert count > 30 and len(found) <= 1, found
