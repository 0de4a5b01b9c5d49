"""What the imports of a file, a package or a model bring, all found together.

The first name of `import a.b.C;` may itself be imported, by a line above or below.  So whatever is found
wakes the imports that wait for a name that it brings; each is woken once, in whatever order they stand.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, TypeAlias

from lagc.semantics.names.values import Wrong
from lagc.syntax import tree

if TYPE_CHECKING:
    from lagc.semantics.names.namespace import Found, Namespace

    Result: TypeAlias = Found | Namespace | Wrong  # of an import of one thing, of all in a place, at fault


class Imports:
    """Of the imports of a file, a package or a model; `faults` are theirs."""

    def __init__(self, declarations: Sequence[tree.Import], space: Namespace):
        self.declarations = declarations
        self.results = _Search(declarations, space).run()
        self.faults = [result for result in self.results if isinstance(result, Wrong)]
        self._names: dict[str, Found] | None = None
        self._missing: dict[str | None, Wrong] = {}  # by name; None: one that might have brought any

    def get(self, name: str) -> Found | None:
        """Raises Wrong where there is no such name and an import at fault may be to blame."""
        if self._names is None:
            self._names = self._merged()
        found = self._names.get(name)
        wrong = None if found is not None else self._missing.get(name, self._missing.get(None))
        if wrong is not None:
            raise wrong.with_traceback(None)  # which would grow, as it is raised for every name that is asked
        return found

    def _merged(self) -> dict[str, Found]:
        """Where two imports bring a name, it is what the first brings."""
        names: dict[str, Found] = {}
        seen: set[int] = set()
        for declaration, result in zip(self.declarations, self.results):
            if isinstance(result, Wrong):
                self._missing.setdefault(declaration.alias, result)
            elif isinstance(result, tuple):
                names.setdefault(declaration.alias or "", result)
            elif id(result) not in seen:
                seen.add(id(result))
                for name, declared in result.names.items():
                    names.setdefault(name, (declared, result))
        return names


class _Search:
    """Imports by their number, and by the first name of their path while they wait for that."""

    def __init__(self, declarations: Sequence[tree.Import], space: Namespace):
        self.declarations = declarations
        self.space = space
        self.results: dict[int, Result] = {}
        self.waiting: dict[str, list[int]] = {}
        for i, declaration in enumerate(declarations):
            if declaration.file is None:
                self.waiting.setdefault(declaration.path[0], []).append(i)

    def run(self) -> list[Result]:
        """What stands here, and what that brings, goes before what is known around, and this before files."""
        for i, declaration in enumerate(self.declarations):
            if declaration.file is not None:
                self._try(i, self.space.importer.file, declaration)
        named = list(self.results)
        for name, found in self._waited_for(self.space):
            named += self._meet(name, found)
        self._wake(named)
        batches = list(self._batches())
        for batch in batches:
            for seek in (self._around, self._in_files):  # all of them before what they bring is known
                self._wake([i for name in batch for i in seek(name)])
        for name in (name for batch in batches for name in batch):
            absent = self.waiting.pop(name, [])
            for i in absent:
                self.results[i] = self.space.importer.nothing(self.declarations[i])
            self._wake(absent)
        return [self.results[i] for i in range(len(self.declarations))]

    def _batches(self) -> Iterator[list[str]]:
        """The names that are waited for; what an import brings comes behind the first name of its path."""
        before: dict[str, str] = {}
        for declaration in self.declarations:
            if declaration.alias in self.waiting and declaration.path[0] in self.waiting:
                before.setdefault(declaration.alias, declaration.path[0])
        behind: dict[str, list[str]] = {}
        for name, first in before.items():
            behind.setdefault(first, []).append(name)
        left = dict.fromkeys(self.waiting)
        batch = [name for name in left if before.get(name, name) == name]
        while batch:
            yield batch
            for name in batch:
                del left[name]
            batch = [after for name in batch for after in behind.get(name, ()) if after != name]
        yield list(left)  # names that wait for each other

    def _wake(self, settled: list[int]) -> None:
        """Settle those that wait for what these bring, and on, round by round."""
        while settled:
            settled = [
                woken
                for i in sorted(settled)
                for name, result in self._brought(i)
                for woken in self._meet(name, result)
            ]

    def _brought(self, i: int) -> Iterable[tuple[str, Found | Wrong]]:
        """What import `i` brings under names that are waited for."""
        result, alias = self.results[i], self.declarations[i].alias
        if isinstance(result, Wrong | tuple):
            return [(alias, result)] if alias is not None and alias in self.waiting else []
        return self._waited_for(result)

    def _waited_for(self, place: Namespace) -> list[tuple[str, Found]]:
        names = sorted(self.waiting.keys() & place.names.keys())
        return [(name, (place.names[name], place)) for name in names]

    def _meet(self, name: str, met: Found | Wrong) -> list[int]:
        """Settle all that wait for this name, where it is a package or a fault."""
        if isinstance(met, tuple) and not isinstance(met[0], tree.Package):
            return []
        woken = self.waiting.pop(name, [])
        for i in woken:
            if isinstance(met, Wrong):
                self.results[i] = met
            else:
                self._try(i, self.space.importer.member, self.declarations[i], met)
        return woken

    def _around(self, name: str) -> list[int]:
        if self.space.parent is None or name not in self.waiting:
            return []
        try:
            found: Found | Wrong | None = self.space.parent.lookup(name)
        except Wrong as wrong:
            found = wrong
        return [] if found is None else self._meet(name, found)

    def _in_files(self, name: str) -> list[int]:
        asked = self.waiting.pop(name, [])
        for i in asked:
            self._try(i, self.space.importer.in_files, self.declarations[i])
        left = [i for i in asked if i not in self.results]
        if left:
            self.waiting[name] = left
        return [i for i in asked if i in self.results]

    def _try(self, i: int, seek: Callable[..., Result | None], *arguments: object) -> None:
        try:
            result = seek(*arguments)
        except Wrong as wrong:
            result = wrong
        if result is not None:
            self.results[i] = result
