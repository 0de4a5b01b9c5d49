"""Texts changed statement by statement: declarations of one put into another, moved, doubled, renamed."""

import random
import re
from collections.abc import Callable, Iterator
from functools import lru_cache
from typing import Any

from lagc.diagnostics.faults import Refused, Source
from lagc.syntax.parse import parse


@lru_cache(maxsize=4096)
def _blocks(text: str) -> tuple[tuple[str, tuple[tuple[int, int], ...]], ...]:
    """Of each block that holds declarations its kind, and where each of these stands; none where the text is
    no model."""
    try:
        tree = parse(Source("text", text))
    except Refused:
        return ()
    found: list[tuple[str, tuple[tuple[int, int], ...]]] = []

    def walk(kind: str, items: Any) -> None:
        if items:
            found.append((kind, tuple((item.span.start, item.span.end) for item in items)))
        for item in items:
            body = getattr(item, "body", ())  # an expression, of loads and functions
            walk(type(item).__name__, body if isinstance(body, tuple) else ())

    walk("file", tree.declarations)
    return tuple(found)


def spliced(texts: list[str], seed: int) -> str:
    """One of the texts, with one to four changes of whole statements."""
    chance = random.Random(seed)
    text = chance.choice(texts)
    for _ in range(chance.choice([1, 1, 2, 4])):
        text = chance.choice(CHANGES)(text, chance, texts)
    return text


def _statement(text: str, chance: random.Random, kind: str | None = None) -> tuple[str, int, int] | None:
    """The kind of its block, and where it stands; in a block of `kind`, where one is given."""
    blocks = [block for block in _blocks(text) if kind in (None, block[0])]
    if not blocks:
        return None
    found, statements = chance.choice(blocks)
    return (found, *chance.choice(statements))


def _pair(text: str, other: str, chance: random.Random) -> tuple[tuple[int, int], str] | None:
    """Where a statement of `text` stands, and one of `other` that may mostly stand there too."""
    where = _statement(text, chance)
    if where is None:
        return None
    what = _statement(other, chance, where[0] if chance.random() < 0.95 else None)
    return None if what is None else ((where[1], where[2]), other[what[1] : what[2]])


def _insert(text: str, chance: random.Random, texts: list[str]) -> str:
    found = _pair(text, chance.choice(texts), chance)
    return text if found is None else f"{text[: found[0][0]]}{found[1]}\n{text[found[0][0] :]}"


def _double(text: str, chance: random.Random, texts: list[str]) -> str:
    return _insert(text, chance, [text])


def _delete(text: str, chance: random.Random, texts: list[str]) -> str:
    what = _statement(text, chance)
    return text if what is None else text[: what[1]] + text[what[2] :]


def _replace(text: str, chance: random.Random, texts: list[str]) -> str:
    found = _pair(text, chance.choice(texts), chance)
    return text if found is None else text[: found[0][0]] + found[1] + text[found[0][1] :]


def _rename(text: str, chance: random.Random, texts: list[str]) -> str:
    names = sorted(set(re.findall(r"[A-Za-z_]\w*", text)))
    if not names:
        return text
    old, new = chance.choice(names), chance.choice(names)
    return re.sub(rf"\b{old}\b", new, text)


CHANGES: list[Callable[[str, random.Random, list[str]], str]] = [
    *(_insert, _insert, _insert, _replace, _replace, _double, _delete, _rename)
]


def smaller(text: str) -> Iterator[str]:
    """The text without some of its statements: many at once first, then single ones; then without lines."""
    spans = sorted({span for _, block in _blocks(text) for span in block}, key=lambda s: s[0] - s[1])
    for start, end in spans:
        yield text[:start] + text[end:]
    lines = text.splitlines(keepends=True)
    width = len(lines) // 2
    while width:
        for k in range(0, len(lines), width):
            yield "".join(lines[:k] + lines[k + width :])
        width //= 2
