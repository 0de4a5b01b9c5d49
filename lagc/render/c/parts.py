"""Long functions in parts: the time that C compilers take grows faster than the length of a function.

A value that a later part needs goes through an array; an entry of an input array is read again.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence

LONGEST = 600  # lines of a function that is left whole
PART = 300
SHARED = "lagc_shared"

_DECLARATION = re.compile(r"const (lagc_real|int) (\w+) = (.*);$")
_ENTRY = re.compile(r"(\w+)(\[\d+\]|->\w+)$")
_WORD = re.compile(r"(?<!->)(?<!\w)[A-Za-z_]\w*")  # no member of the parameters


def divided(body: Sequence[str], written: Collection[str]) -> tuple[list[list[str]], int]:
    """The lines of the parts of `body`, and how many values they share; `written`: the arrays that
    it writes to, which may not be read again."""
    parts = [list(body[k : k + PART]) for k in range(0, len(body), PART)]
    declared: dict[str, str] = {}  # name -> its declaration, of the parts before
    places: dict[str, int] = {}  # name -> its place in the shared array
    heads: list[list[str]] = []
    own: list[tuple[dict[str, str], dict[str, None]]] = []
    for part in parts:
        new = {found[2]: line for line in part if (found := _DECLARATION.match(line))}
        used = dict.fromkeys(word for line in part for word in _words(line))
        head = []
        for name in used:
            if name in declared and name not in new:
                head.append(_again(name, declared[name], written, places))
        heads.append(head)
        declared.update(new)
        own.append((new, used))
    result = []
    for part, head, (new, used) in zip(parts, heads, own):
        tail = [f"{SHARED}[{places[name]}] = {name};" for name in new if name in places]
        for name, line in new.items():
            if name not in used and name not in places:  # read again where it is needed
                part.remove(line)
        result.append([*head, *part, *tail])
    return result, len(places)


def _words(line: str) -> list[str]:
    """The names that a line uses."""
    found = _DECLARATION.match(line)
    return [] if line[0] == "/" else _WORD.findall(found[3] if found else line)


def _again(name: str, declaration: str, written: Collection[str], places: dict[str, int]) -> str:
    """The declaration of a value of an earlier part; it gets a place where it needs one."""
    found = _DECLARATION.match(declaration)
    assert found is not None
    kind, value = found[1], found[3]
    entry = _ENTRY.match(value)
    if entry is not None and entry[1] not in written:
        return declaration
    place = places.setdefault(name, len(places))
    return f"const {kind} {name} = {SHARED}[{place}]{' != 0.0' if kind == 'int' else ''};"
