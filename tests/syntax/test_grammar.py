"""The grammar file is the syntax: Lark's own parser reads the models by it; the cache is a cache."""

from pathlib import Path

import pytest
from lark import Lark, Token

from lagc.diagnostics.faults import Source
from lagc.host import cache
from lagc.syntax import lalr_tables
from lagc.syntax.lalr import Machine
from lagc.syntax.lexer import tokenise
from lagc.syntax.recovery import recover

MODELS = sorted((Path(__file__).resolve().parents[2] / "models").rglob("*.lag"))


@pytest.fixture(scope="module")
def lark() -> Lark:
    return Lark(lalr_tables.grammar_text(), parser="lalr", start="file", maybe_placeholders=True)


@pytest.mark.sample(1, 12)
@pytest.mark.parametrize("path", MODELS, ids=lambda path: path.stem)
def test_lark_reads_the_models(lark: Lark, path: Path) -> None:
    """Fed with the same tokens (which a lexer alone cannot tell apart, as the grammar says)."""
    source = Source(str(path), path.read_text("utf-8"))
    lexed = tokenise(source)
    ours = Machine(source, lalr_tables.tables(), lexed).run(recover)
    theirs = lark.parse_interactive()
    for token in lexed.tokens[:-1]:
        theirs.feed_token(Token(token.terminal, token.text))
    assert len(theirs.feed_eof().children) == len(ours.declarations)


@pytest.mark.full
def test_tables_are_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("LAGC_CACHE", str(tmp_path))
    monkeypatch.setattr(lalr_tables, "shipped_path", lambda: str(tmp_path / "none"))
    lalr_tables.tables.cache_clear()
    made = lalr_tables.tables()
    (entry,) = [path for path in tmp_path.rglob("*") if path.is_file()]
    lalr_tables.tables.cache_clear()
    monkeypatch.setattr(lalr_tables, "_build", lambda grammar: pytest.fail("built again"))
    assert lalr_tables.tables() == made
    lalr_tables.tables.cache_clear()
    monkeypatch.undo()
    monkeypatch.setenv("LAGC_CACHE", str(tmp_path))
    monkeypatch.setattr(lalr_tables, "shipped_path", lambda: str(tmp_path / "none"))
    entry.write_bytes(entry.read_bytes()[:-10])
    assert lalr_tables.tables() == made
    lalr_tables.tables.cache_clear()


def test_no_cache_at_all(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lalr_tables, "shipped_path", lambda: str(tmp_path / "none"))
    monkeypatch.setenv("LAGC_CACHE", "")
    assert cache.folder() is None
    lalr_tables.tables.cache_clear()
    assert lalr_tables.tables().keywords["model"] == "MODEL"
    lalr_tables.tables.cache_clear()


@pytest.mark.full
def test_tables_made_at_installation(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "tables.json"
    path.write_text(lalr_tables.packed(), encoding="utf-8")
    monkeypatch.setattr(lalr_tables, "shipped_path", lambda: str(path))
    monkeypatch.setattr(lalr_tables, "_build", lambda grammar: pytest.fail("built again"))
    lalr_tables.tables.cache_clear()
    assert lalr_tables.tables().keywords["model"] == "MODEL"
    lalr_tables.tables.cache_clear()
    path.write_text('["another grammar"]', encoding="utf-8")
    monkeypatch.setattr(lalr_tables, "_build", lambda grammar: [[{}], [], 0, 0, {}, {}])
    monkeypatch.setenv("LAGC_CACHE", "")
    assert lalr_tables.tables().keywords == {}
    lalr_tables.tables.cache_clear()
