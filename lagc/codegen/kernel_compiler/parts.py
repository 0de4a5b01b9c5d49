"""The parts of compiled kernel files."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

FUNCTION, RECORD, TITLE, LIST = "function", "record", "file", "list"  # kinds of parts beside constants


class Part(NamedTuple):
    """A kernel, a record, a constant, the title of a file, or the list of its constants of one kind."""

    name: str
    kind: str  # of a constant: int, Real, Reals, Status, Code or Method
    place: Sequence[int] = ()  # file, method, line
    text: str = ""  # the definition; the value of a constant; the title of a file
    note: str = ""  # the comment
    head: str = ""  # in C: the declaration of a public function, and
    lead: str = ""  # what stands before it in the file
    needs: Sequence[str] = ()  # parts
    names: Sequence[str] = ()  # sizes, tables and functions of the model that it uses
    members: Sequence[tuple[str, Sequence[str], Sequence[str], str]] = ()  # name, type, comments
    flags: Mapping[str, bool] = {}  # that it depends on
