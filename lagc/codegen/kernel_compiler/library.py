"""The kernels that a model needs, in one language.

A part is compiled (`compiler`) when a model first needs it with its flags, and kept in the cache with the
flags that it depends on. An installation brings the parts of common models.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from typing import Any

from lagc.base.records import dataclass
from lagc.codegen.kernel_compiler.parts import FUNCTION, RECORD, Part
from lagc.host import cache as store
from lagc.host.cache import contents, files, tool_fingerprint

SINE_COSINE = ("sine_cosine", "sine_cosine_two")


@dataclass(frozen=True)
class Chosen:
    """The parts of a model, in the order of the files, and all names that these use."""

    functions: tuple[Part, ...]
    records: tuple[Part, ...]
    constants: tuple[Part, ...]
    names: frozenset[str]


class Library:
    """The parts that were compiled for one language: `python`, or `double`, `float` or `quad` for C.
    `texts`: the fields of the parts of each name, which differ in their flags, as JSON."""

    def __init__(self, language: str, texts: Mapping[str, str]):
        self.language, self.texts = language, dict(texts)
        self.rows: dict[str, list[Any]] = {}  # of the names that were asked for: to read all takes 8 ms
        self.compiler: Any = None
        self.is_changed = False

    def part(self, name: str, flags: Mapping[str, bool]) -> Part:
        """Return a part for these flags. Raises KeyError for an unknown name."""
        if name not in self.rows:
            self.rows[name] = json.loads(self.texts.get(name, "[]"))
        for row in self.rows[name]:
            if all(flags.get(flag) == value for flag, value in row[-1].items()):
                return Part(*row)
        if self.compiler is None:
            from lagc.codegen.kernel_compiler.compiler import Compiler

            self.compiler = Compiler(self.language)
        found: Part = self.compiler.part(name, flags)
        self.rows[name].append(found)
        self.texts[name] = json.dumps(self.rows[name], separators=(",", ":"))
        self.is_changed = True
        return found

    def constants(self, file: str, kind: str) -> list[Part]:
        """Return the constants of a kernel file. Raises KeyError if it has none of this kind."""
        return [self.part(name, {}) for name in self.part(f"{file} {kind}", {}).needs]

    def title(self, place: Sequence[int]) -> Part:
        """Return the title of the file of a part."""
        return self.part(f"{place[0]}#{place[1]}", {})

    def chosen(self, roots: Iterable[str], flags: Mapping[str, bool]) -> Chosen:
        """Return the parts `roots` and all that they need. Raises KeyError for an unknown name."""
        found: dict[str, Part] = {}
        wanted = list(roots)
        while wanted:
            name = wanted.pop()
            if name not in found:
                found[name] = self.part(name, flags)
                wanted += found[name].needs
        parts = sorted(found.values(), key=lambda part: tuple(part.place))
        kinds = {kind: tuple([p for p in parts if p.kind == kind]) for kind in (FUNCTION, RECORD)}
        others = tuple([p for p in parts if p.kind not in kinds])
        self.save()
        names = frozenset(found).union(*(part.names for part in parts))
        return Chosen(kinds[FUNCTION], kinds[RECORD], others, names)

    def save(self) -> None:
        """Keep what was compiled in the cache."""
        if self.is_changed:
            self.is_changed = False
            store.store("kernels", store.key(_key(), self.language), self.packed().encode())

    def packed(self) -> str:
        """Return the lines of a file of these parts."""
        return "".join(f"{name}\t{text}\n" for name, text in self.texts.items())


@cache
def library(language: str) -> Library:
    """Return the library of a language, with what an earlier process or the installation left."""
    texts = store.load("kernels", store.key(_key(), language), lambda data: _unpacked(data.decode()))
    return Library(language, _shipped(language) if texts is None else texts)


def _unpacked(text: str) -> dict[str, str]:
    return dict(line.split("\t", 1) for line in text.splitlines())  # JSON has no line breaks


def sine_cosine_kernels(functions: Iterable[str], language: str) -> Chosen:
    """Return the kernels of sine and cosine that the printed `functions` of a model call."""
    text = "\n".join(functions)
    return library(language).chosen([name for name in SINE_COSINE if f"{name}(" in text], {})


def shipped_path(language: str) -> str:
    """Return the path of the parts that an installation brings (`hatch_build.py`)."""
    return os.path.join(os.path.dirname(os.path.abspath(__file__)), f"kernels.{language}.txt")


def packed(language: str) -> str:
    """Return the text of that file: the parts that this process has compiled."""
    return f"{_key()}\n{library(language).packed()}"


def _shipped(language: str) -> dict[str, str]:
    """Return the parts that came with the installation, if they belong to its kernels."""
    try:
        with open(shipped_path(language), encoding="utf-8") as file:
            key, _, text = file.read().partition("\n")
        return _unpacked(text) if key == _key() else {}
    except (OSError, ValueError):
        return {}


@cache
def _key() -> str:
    """Return the key of the kernels and of their compiler; it is kept, as it depends on sixty files."""
    tool = store.key(tool_fingerprint())
    found = store.load("printers", tool, bytes.decode)
    if found is None:
        found = contents({path: os.stat(path) for path in sources()})
        store.store("printers", tool, found.encode())
    return found


def sources() -> list[str]:
    """Return the files on which compiled kernels depend."""
    here = os.path.dirname(os.path.abspath(__file__))
    kernels = os.path.join(os.path.dirname(os.path.dirname(here)), "kernels")
    found = [path for folder in (kernels, here) for path, _ in files(folder) if path.endswith(".py")]
    return [*sorted(found), os.path.join(os.path.dirname(here), "sizes.py")]
