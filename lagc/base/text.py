"""Text from users and for users: numbers of the command line, and printable text.

`printable` writes control characters, DEL, characters that change the writing direction and other invisible
characters as escapes, so that no text can control a terminal.
"""

from __future__ import annotations

import re
import sys
from typing import TYPE_CHECKING, TypeAlias

from lagc.base.records import dataclass

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

FINEST = 1e-15  # least relative tolerance, set by round-off
WIDTH, NARROW = 80, 20  # characters of a line on a terminal; of a column that is broken into lines
MOST_POINTS = sys.maxsize // 2  # limit on the length of a list
# Compiled at the first use, which most runs never need.
_NUMBER = r"[+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"
_WHOLE = r"[+-]?[0-9]{1,4000}"
_NONE = r"(?i)[+-]?(?:nan|inf|infinity)"
_SIZE = r"([0-9]{1,18}(?:\.[0-9]{1,18})?)\s*([KMG]?)B?"
_SECONDS = {"": 1.0, "s": 1.0, "min": 60.0, "h": 3600.0, "d": 86400.0}
_TIME = r"([0-9]{1,18}(?:\.[0-9]{1,18})?)\s*(?:(s|min|h|d)|\[(s|min|h|d)\])?"


@dataclass(frozen=True)
class Quantity:
    """A number with its unit; None: an SI unit, or none."""

    value: float
    unit: str | None = None


Given: TypeAlias = "Mapping[str, float | Quantity]"


def number(text: str) -> float | None:
    """Return the number in `text`, as in a model file but with a sign, or None. `nan` and `inf` are accepted,
    so that the caller can report that a finite number is needed."""
    return float(text) if re.fullmatch(_NUMBER, text) or re.fullmatch(_NONE, text) else None


def size(text: str) -> float | None:
    """Return the number of bytes for a text such as `500M` or `2G`, or None."""
    found = re.fullmatch(_SIZE, text.strip().upper(), re.ASCII)
    return None if found is None else float(found[1]) * 1000.0 ** " KMG".index(found[2] or " ")


def seconds(text: str) -> float | None:
    """Return the number of seconds for a text such as `90`, `10min` or `2h`, or None."""
    found = re.fullmatch(_TIME, text.strip(), re.ASCII)
    return None if found is None else float(found[1]) * _SECONDS[found[2] or found[3] or ""]


def whole(text: str) -> int | None:
    return int(text) if re.fullmatch(_WHOLE, text) else None


def printable(text: str) -> str:
    """Return `text` with characters that could control a terminal escaped; line ends are kept."""
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() or c == "\n" else _escape(c) for c in text)


def one_line(text: str) -> str:
    """Return `printable` text with escaped line ends."""
    return printable(text).replace("\n", "\\n")


def table(head: Sequence[str], rows: Sequence[Sequence[str]], width: int = WIDTH) -> list[str]:
    """Return the lines of a table with columns as wide as they need, indented by two. The last column breaks
    its words into lines where the table is wider than `width`."""
    widths = [max(len(row[k]) for row in (head, *rows)) for k in range(len(head))]
    before = 2 + sum([w + 2 for w in widths[:-1]])
    found = []
    for row in (head, *rows):
        cells = "".join([f"{cell:{w}}  " for cell, w in zip(row[:-1], widths)])
        first, *more = broken(row[-1], max(width - before, NARROW))
        found += [f"  {cells}{first}".rstrip(), *[f"{'':{before}}{line}" for line in more]]
    return found


def broken(text: str, width: int) -> list[str]:
    """Return the words of a text in lines that are not longer than `width`, if its words are not."""
    if len(text) <= width:
        return [text]
    lines = [""]
    for word in text.split(" "):
        if lines[-1] and len(lines[-1]) + 1 + len(word) > width:
            lines.append(word)
        else:
            lines[-1] += f" {word}" if lines[-1] else word
    return lines


def entry(key: str, text: str, indent: int = 12) -> list[str]:
    """Return a line `key text` of a report, the text from the column `indent` on, in lines that fit a
    terminal."""
    first, *more = broken(text, WIDTH - indent)
    return [f"  {key:{indent - 2}}{first}".rstrip(), *[f"{'':{indent}}{line}" for line in more]]


def json_text(value: object, indent: int | None = None, encoding: str = "utf-8") -> str:
    """Return `value` as JSON. Characters that are not printable, or not in `encoding`, are escaped.  Numbers
    that are not finite become null."""
    import json

    text = json.dumps(_finite(value), indent=indent, ensure_ascii=False, allow_nan=False)
    if text.isascii():
        return text.replace("\x7f", "\\u007f")
    try:
        text.encode(encoding)
    except UnicodeEncodeError:
        return json.dumps(_finite(value), indent=indent).replace("\x7f", "\\u007f")
    return "".join(c if c.isprintable() or c == "\n" else json.dumps(c)[1:-1] for c in text)


def _finite(value: object) -> object:
    if isinstance(value, float):
        return value if value - value == 0.0 else None
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_finite(item) for item in value]
    return value


def _escape(char: str) -> str:
    code = ord(char)
    return f"\\x{code:02x}" if code < 256 else f"\\u{code:04x}" if code < 65536 else f"\\U{code:08x}"
