"""Lines that differ by subscripts alone, as one line with ranges: `th[1..200]`."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from math import prod

_SUBSCRIPTS = re.compile(r"(?<=[\w\]])\[(\d+(?:, ?\d+)*)\]")  # behind a name: no unit, which a space parts
_FEWEST = 3  # lines that are worth a range


def ranged(lines: Iterable[str]) -> list[str]:
    """`lines`, those of a family as one, in place of its first, where their subscripts fill whole ranges."""
    given = [*lines]
    families: dict[tuple[str, ...], list[tuple[int, tuple[int, ...]]]] = {}
    for place, line in enumerate(given):
        parts = _SUBSCRIPTS.split(line)  # what is between, and subscripts, in turn
        shape = [part if k % 2 == 0 else str(part.count(",")) for k, part in enumerate(parts)]
        numbers = [int(n) for part in parts[1::2] for n in part.split(",")]
        families.setdefault(tuple(shape), []).append((place, tuple(numbers)))
    found = dict(enumerate(given))
    for members in families.values():
        texts = _texts([numbers for _, numbers in members]) if len(members) >= _FEWEST else None
        if texts is not None:
            (first, _), *others = members
            found[first] = _with(given[first], texts)
            for place, _ in others:
                del found[place]
    return [*found.values()]


def _texts(rows: Sequence[tuple[int, ...]]) -> list[str] | None:
    """What stands for each subscript of `rows`; None where they do not fill ranges."""
    columns = [*zip(*rows)]
    extents = {column: range(min(column), max(column) + 1) for column in columns}  # once, if always equal
    if prod(map(len, extents.values())) != len(rows) or len({*rows}) != len(rows):
        return None
    return [str(e[0]) if len(e) == 1 else f"{e[0]}..{e[-1]}" for e in map(extents.__getitem__, columns)]


def _with(line: str, texts: Iterable[str]) -> str:
    following = iter(texts)

    def put(found: re.Match[str]) -> str:
        return f"[{', '.join([next(following) for _ in found[1].split(',')])}]"

    return _SUBSCRIPTS.sub(put, line)
