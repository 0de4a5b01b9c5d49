"""Odd files, long ones, deep ones, damaged ones: a tree or a refusal, and soon."""

import gc
import random
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from lagc.diagnostics.faults import Refused, Source
from lagc.syntax import tree
from lagc.syntax.formatter import format_source
from lagc.syntax.lexer import tokenise
from lagc.syntax.parse import parse, parse_recovering

MODELS = sorted((Path(__file__).resolve().parents[2] / "models").glob("*/*.lag"))


def model(expression: str) -> Source:
    return Source("x", f"model M\n  potential V = {expression};\nend M;\n")


def faults(source: Source) -> list[tuple[str, int, int]]:
    _, found = parse_recovering(source)
    return [(f.code, f.span.line, f.span.column) for f in found if f.span is not None]


@pytest.mark.parametrize("text", ["", "\n\n", "// nothing\n", "/* nothing */", "\ufeff", "\r\n", " \t"])
def test_files_without_declarations(text: str) -> None:
    assert parse(Source("x", text)).declarations == ()


def test_line_ends_tabs_and_byte_order_mark() -> None:
    text = "\ufeffmodel M\r\n\tparameter Mass m = 1 [kg];\r\nend M;\r\n"
    (read,) = parse(Source("x", text)).declarations
    assert isinstance(read, tree.ModelDeclaration)
    quantities = read.body[0]
    assert (quantities.span.line, quantities.span.column) == (2, 2)
    assert format_source(Source("x", text)) == "model M\n  parameter Mass m = 1 [kg];\nend M;\n"


@pytest.mark.parametrize(
    "where", ["model M // {}\nend M;\n", 'model M "{}"\nend M;\n', "model M {}\nend M;\n"]
)
def test_no_command_takes_nul_anywhere(where: str) -> None:
    source = Source("x", where.format("\0"))
    for command in (parse, format_source):
        with pytest.raises(Refused) as refused:
            command(source)
        (fault,) = refused.value.faults
        assert fault.code == "LAG0101"
        assert fault.span is not None
        assert source.text[fault.span.start] == "\0"


def test_columns_count_characters() -> None:
    source = Source("x", "model M\n  /* ünïcödé 𝛼 */ parameter Mass m == 1;\nend M;\n")
    assert faults(source) == [("LAG0115", 2, 36)]


def test_no_break_spaces_are_blanks() -> None:
    assert parse(Source("x", "model\u00a0M\u2003end M;")).declarations


@pytest.mark.full
def test_ten_thousand_terms() -> None:
    begin = time.process_time()
    read = parse(model(" + ".join(f"a{i}*b" for i in range(10_000))))
    assert time.process_time() - begin < 5
    (declaration,) = read.declarations
    assert isinstance(declaration, tree.ModelDeclaration)
    construct = declaration.body[0]
    assert isinstance(construct, tree.Construct)
    depth, node = 0, construct.value
    while isinstance(node, tree.Binary) and node.op == "+":
        depth, node = depth + 1, node.left
    assert depth == 9_999


@pytest.mark.full
def test_ten_thousand_declarations() -> None:
    lines = "".join(f"  parameter Mass m{i}(min = 0) = 1 [kg];\n" for i in range(10_000))
    begin = time.process_time()
    (read,) = parse(Source("x", f"model M\n{lines}end M;\n")).declarations
    assert time.process_time() - begin < 10
    assert isinstance(read, tree.ModelDeclaration) and len(read.body) == 10_000


@pytest.mark.parametrize(
    ("opening", "closing", "levels"),
    [
        ("(", ")", 99), ("{", "}", 99), ("f(", ")", 99), ("1 + (", ")", 99), ("a[", "]", 99),
        ("-", "", 99), ("if a then b else ", "", 99),
    ],
)  # fmt: skip
def test_depth_is_bounded(opening: str, closing: str, levels: int) -> None:
    """A hundred, of which the model is one."""
    assert parse(model(opening * levels + "1" + closing * levels))
    too_deep = model(opening * (levels + 1) + "1" + closing * (levels + 1))
    with pytest.raises(Refused) as refused:
        parse(too_deep)
    (fault,) = refused.value.faults
    assert fault.code == "LAG0106" and "100" in fault.message


@pytest.mark.full
@pytest.mark.parametrize(
    "part", ["(", "{", "[", "f(", "-", "if a then ", "not ", "for i in 1:n loop ", "effect e "]
)
def test_absurdly_deep_files_are_refused_soon(part: str) -> None:
    begin = time.process_time()
    with pytest.raises(Refused):
        parse(Source("x", "model M potential V = " + part * 50_000))
    assert time.process_time() - begin < 5


@pytest.mark.full
@pytest.mark.parametrize("part", [".a", "[1]", ".a[2]"])
def test_parts_of_a_name_are_bounded(part: str) -> None:
    count = part.count("a") + part.count("[")
    assert parse(model("a" + part * (99 // count)))
    with pytest.raises(Refused) as refused:
        parse(model("a" + part * 20_000))
    assert {fault.code for fault in refused.value.faults} == {"LAG0106"}


@pytest.mark.full
def test_parts_of_a_name_in_a_scene_are_bounded() -> None:
    text = "model M scene s parameter a{} = 1; end s; end M;"
    assert parse(Source("x", text.format(".b" * 99)))
    with pytest.raises(Refused) as refused:
        parse(Source("x", text.format(".b" * 20_000)))
    assert [fault.code for fault in refused.value.faults] == ["LAG0106"]


def test_numbers_out_of_range() -> None:
    assert faults(model("1e999")) == [("LAG0105", 2, 17)]
    assert parse(model("1e-999 + " + "9" * 300))


def test_at_most_fifty_faults() -> None:
    with pytest.raises(Refused) as refused:
        parse(Source("x", "model M\n" + "parameter Mass m = ;\n" * 500 + "end M;\n"))
    assert len(refused.value.faults) == 50


WORDS = sorted(
    {token.text for path in MODELS[:20] for token in tokenise(Source("x", path.read_text("utf-8"))).tokens}
    | {"**", "==", '"', "/*", "?", "θ", "\x00", "when", "initial", "unless", "\n", ";", "[", "{", "("}
)


def mutated(text: str, chance: random.Random) -> str:
    """A few random edits: parts left out, doubled, words and characters put in."""
    for _ in range(chance.randint(1, 6)):
        start = chance.randrange(len(text) + 1)
        stop = min(len(text), start + chance.randint(1, 30))
        kind = chance.randrange(5)
        if kind == 0:
            text = text[:start] + text[stop:]
        elif kind == 1:
            text = text[:start] + chance.choice(WORDS) + text[start:]
        elif kind == 2:
            text = text[:stop] + text[start:]
        elif kind == 3:
            odd = chr(chance.choice((chance.randrange(32, 127), chance.randrange(0x3000))))
            text = text[:start] + odd + text[stop:]
        else:
            text = text[:start] if chance.random() < 0.2 else text[start:] + text[:start]
    return text


@pytest.fixture
def uncollected() -> Iterator[None]:
    """Garbage of other tests is none of their time."""
    gc.disable()
    yield
    gc.enable()


@pytest.mark.sample(0, 12)
@pytest.mark.usefixtures("uncollected")
@pytest.mark.parametrize("seed", range(20))
def test_damaged_models(seed: int) -> None:
    """2,000 damaged texts: each is read or refused within a second, and what is read is laid out
    without a change of its tokens."""
    chance = random.Random(seed)
    for _ in range(100):
        text = mutated(chance.choice(MODELS).read_text("utf-8"), chance)
        begin = time.process_time()
        try:
            parse(Source("x", text))
        except Refused as refused:
            assert refused.faults
            for fault in refused.faults:
                assert fault.span is not None
                assert 0 <= fault.span.start <= fault.span.end <= len(text)
        else:
            laid_out = format_source(Source("x", text))
            assert words(laid_out) == words(text)
            assert format_source(Source("x", laid_out)) == laid_out
        assert time.process_time() - begin < 1


def words(text: str) -> list[str]:
    tokens = tokenise(Source("x", text)).tokens
    return [token.text.replace(" ", "") for token in tokens if token.kind != "string"]
