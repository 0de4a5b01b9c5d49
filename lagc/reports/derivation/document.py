"""The parts of a written solution, without the marks of a format.

A text is a string in which `math` and `bold` have marked formulas in LaTeX and names. A block is a heading, a
paragraph, rows of formulas, a list, a table or a picture. `formats` and `html` write blocks.
"""

import re
from collections.abc import Callable
from typing import TypeAlias

from lagc.base.records import dataclass

_MARKED = re.compile("([\x01\x02])(.*?)\x03", re.DOTALL)  # control characters, which no model contains


def math(latex: str) -> str:
    return f"\x01{latex}\x03"


def bold(name: str) -> str:
    return f"\x02{name}\x03"


def spelt(text: str, plain: Callable[[str], str], math: Callable[[str], str], bold: str) -> str:
    """Return a text with its formulas and plain words as two functions write them; names fill `bold`."""
    found, at = [], 0
    for marked in _MARKED.finditer(text):
        found.append(plain(text[at : marked.start()]))
        found.append(math(marked[2]) if marked[1] == "\x01" else bold.format(plain(marked[2])))
        at = marked.end()
    return "".join([*found, plain(text[at:])])


@dataclass(frozen=True, slots=True)
class Heading:
    """The title is of level 1, a section of level 2, an equation within it of level 3."""

    level: int
    text: str


@dataclass(frozen=True, slots=True)
class Row:
    """`left` = the sum of the `lines`, with a `note` behind the last, all in LaTeX. Without a `left` there is
    no equals sign; "=" continues the row before."""

    left: str
    lines: tuple[str, ...]
    note: str = ""

    @property
    def latex(self) -> list[str]:
        """The lines, with `&` where they are aligned."""
        head = {"": "& ", "=": "&= "}.get(self.left, f"{self.left} &= ")
        lines = [head + self.lines[0], *[rf"&\quad {line}" for line in self.lines[1:]]]
        return [*lines[:-1], lines[-1] + self.note]


@dataclass(frozen=True, slots=True)
class Formulas:
    rows: tuple[Row, ...]

    @property
    def latex(self) -> list[str]:
        return [line for row in self.rows for line in row.latex]


@dataclass(frozen=True, slots=True)
class Items:
    items: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Table:
    """The first row is the head."""

    rows: tuple[tuple[str, ...], ...]


@dataclass(frozen=True, slots=True)
class Picture:
    """A plot. Files that hold it are called `name`."""

    name: str
    svg: bytes
    pdf: bytes


Block: TypeAlias = "Heading | str | Formulas | Items | Table | Picture"  # a string is a paragraph
