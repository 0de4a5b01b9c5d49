"""Long functions in parts: the time that C compilers take grows faster than the length of a function.

A value that a later part needs goes through an array; an entry of an input array is read again.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence

LONGEST = 600  # lines of a function that is left whole
PART = 300
SHARED = "lagc_shared"

_DECLARATION = re.compile(r"const (lagc_real|int) (\w+) = (.*);$")
_TURN = re.compile(r"lagc_real (\w+)\[(\d)\]; lagc_sine_cosine(?:_two)?\((.*), \1\);$")  # one name for all
_ENTRY = re.compile(r"(\w+)(->\w+)?(\[\d+\])?$")
_WORD = re.compile(r"(?<!->)(?<!\w)[A-Za-z_]\w*")  # no member of the parameters


def divided(body: Sequence[str], written: Collection[str]) -> tuple[list[list[str]], int]:
    """The lines of the parts of `body`, and how many values they share; `written`: the arrays that
    it writes to, which may not be read again."""
    parts = [list(body[k : k + PART]) for k in range(0, len(body), PART)]
    declared: dict[str, str] = {}  # name -> its declaration, of the parts before
    places: dict[str, int] = {}  # name -> its place in the shared array, from which on there is room for it
    written = {*written, *(turn[1] for line in body if (turn := _TURN.match(line)))}
    heads: list[list[str]] = []
    own: list[tuple[dict[str, str], dict[str, None]]] = []
    for part in parts:
        new = {name: line for line in part if (name := _declared(line))}
        used = dict.fromkeys(word for line in part for word in _words(line))
        head = []
        for name in used:
            if name in declared and name not in new:
                head.append(_again(name, declared, written, places))
        heads.append(head)
        declared.update(new)
        own.append((new, used))
    result = []
    for part, head, (new, used) in zip(parts, heads, own):
        tail = [
            text for name, line in new.items() if name in places for text in _kept(name, line, places[name])
        ]
        for name, line in new.items():
            if name not in used and name not in places:  # read again where it is needed
                part.remove(line)
        result.append([*head, *part, *tail])
    return result, _room(places, declared)


def _declared(line: str) -> str:
    """The name that a line declares, if it does."""
    found, turn = _DECLARATION.match(line), _TURN.match(line)
    return found[2] if found else turn[1] if turn else ""


def _kept(name: str, line: str, place: int) -> list[str]:
    """A value, or those of a call, into the shared array."""
    if turn := _TURN.match(line):
        return [f"{SHARED}[{place + k}] = {name}[{k}];" for k in range(int(turn[2]))]
    return [f"{SHARED}[{place}] = {name};"]


def _room(places: dict[str, int], declared: Mapping[str, str]) -> int:
    """What the values that have places take, one behind the other."""
    last = next(reversed(places), None)
    if last is None:
        return 0
    turn = _TURN.match(declared[last])
    return places[last] + (int(turn[2]) if turn else 1)


def _words(line: str) -> list[str]:
    """The names that a line uses."""
    found, turn = _DECLARATION.match(line), _TURN.match(line)
    return [] if line[0] == "/" else _WORD.findall(found[3] if found else turn[3] if turn else line)


def _again(name: str, declared: Mapping[str, str], written: Collection[str], places: dict[str, int]) -> str:
    """The declaration of a value of an earlier part; it gets a place where it needs one."""
    declaration = declared[name]
    found = _DECLARATION.match(declaration)
    entry = _ENTRY.match(found[3]) if found else None
    if entry is not None and entry[1] not in written:
        return declaration
    if name not in places:
        places[name] = _room(places, declared)
    if found is None:
        return f"const lagc_real *const {name} = {SHARED} + {places[name]};"
    return f"const {found[1]} {name} = {SHARED}[{places[name]}]{' != 0.0' if found[1] == 'int' else ''};"
