"""Names declared in files and packages, and imports.

Imports and data files stay within the roots: the folder of the importing file, and the given folders.

All imports of a place are resolved together, because the first name of `import a.b.C;` may itself be imported
by another line.  Each resolved import wakes the imports that wait for a name it provides.
"""

from __future__ import annotations

import math
import os
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import TypeAlias

from lagc.base.records import dataclass
from lagc.diagnostics.faults import Refused, Source, Span, Wrong
from lagc.diagnostics.suggest import did_you_mean, foreign
from lagc.host.model_library import (
    LARGEST_DATA,
    Outside,
    Unreadable,
    content,
    decoded,
    fingerprint,
    folder_of,
    is_within,
    models_folder,
)
from lagc.syntax import tree

TOGETHER = 40_000_000  # bytes of all imports

Declared = (
    tree.ModelDeclaration | tree.Package | tree.TypeDeclaration | tree.FunctionDeclaration | tree.Quantities
)


class Namespace:
    """The names of one file, package or model body; lookups continue in `parent`."""

    def __init__(
        self, declarations: Iterable[tree.Declaration], parent: Namespace | None, importer: Importer
    ):
        self.parent = parent
        self.importer = importer
        self.names: dict[str, Declared] = {}
        self.imports: list[tree.Import] = []
        self._imported: Imports | None = None
        for declaration in declarations:
            if isinstance(declaration, tree.Import):
                self.imports.append(declaration)
            elif isinstance(declaration, tree.Quantities):
                for declarator in declaration.declarators:
                    self.names.setdefault(declarator.name, declaration)
            elif isinstance(
                declaration,
                tree.ModelDeclaration | tree.Package | tree.TypeDeclaration | tree.FunctionDeclaration,
            ):
                self._add(declaration)

    def _add(
        self,
        declaration: tree.ModelDeclaration | tree.Package | tree.TypeDeclaration | tree.FunctionDeclaration,
    ) -> None:
        first = self.names.get(declaration.name)
        if first is not None:
            place = first.span if isinstance(first, tree.Quantities) else first.name_span
            message = f"`{declaration.name}` is declared twice"
            related = ((place, "first here"),)
            self.importer.report(Wrong("LAG0202", message, declaration.name_span, related=related))
            return
        self.names[declaration.name] = declaration

    def imports_here(self) -> Imports:
        """Return the imports of this place, resolved at the first call."""
        if self._imported is None:
            self._imported = Imports(self.imports, self)
        return self._imported

    def lookup(self, name: str) -> Found | None:
        """Return the declaration called `name` and its namespace, or None. Raises Wrong if the name is
        unknown and an import that failed might have declared it."""
        space: Namespace | None = self
        while space is not None:
            declared = space.names.get(name)
            found = (declared, space) if declared is not None else space.imports_here().get(name)
            if found is not None:
                return found
            space = space.parent
        return None

    def known(self) -> Iterator[str]:
        space: Namespace | None = self
        while space is not None:
            yield from space.names
            yield from (i.alias or (i.path[-1] if i.path else "") for i in space.imports)
            space = space.parent

    def find(self, path: tuple[str, ...], span: Span, what: str) -> Found:
        """Return the declaration called `a.b.c`.  Raises Wrong."""
        return self.follow(self.lookup(path[0]), path, span, what)

    def follow(self, found: Found | None, path: tuple[str, ...], span: Span, what: str) -> Found:
        """Return the declaration called `a.b.c`, where `found` is that of `a`.  Raises Wrong."""
        near: Iterable[str] = self.known()
        for name in path[1:]:
            if found is None:
                break
            declaration, space = found
            if not isinstance(declaration, tree.Package):
                raise Wrong("LAG0206", f"`{path[0]}` is not a package and has no `{name}`", span)
            inner = self.importer.inside(declaration, space)
            near = inner.names
            member = inner.names.get(name)
            found = None if member is None else (member, inner)
        if found is None:
            remedy = did_you_mean(path[-1], sorted(set(near)))
            raise Wrong("LAG0203", f"there is no {what} `{'.'.join(path)}`", span, remedy)
        return found


Found: TypeAlias = tuple[Declared, Namespace]  # a declaration and its namespace
Result: TypeAlias = Found | Namespace | Wrong  # of an import: one declaration, all of a namespace, or a fault


class Imports:
    """The resolved imports of a file, a package or a model, with their `faults`."""

    def __init__(self, declarations: Sequence[tree.Import], space: Namespace):
        self.declarations = declarations
        self.results = _Search(declarations, space).run()
        self.faults = [result for result in self.results if isinstance(result, Wrong)]
        self._names: dict[str, Found] | None = None
        self._missing: dict[str | None, Wrong] = {}  # faults by name; None: a fault that may concern any name

    def get(self, name: str) -> Found | None:
        """Return the imported declaration called `name`, or None. Raises Wrong if the name is unknown and an
        import that failed might have declared it."""
        if self._names is None:
            self._names = self._merge()
        found = self._names.get(name)
        wrong = None if found is not None else self._missing.get(name, self._missing.get(None))
        if wrong is not None:
            raise wrong.with_traceback(None)  # the traceback would grow with every raise
        return found

    def _merge(self) -> dict[str, Found]:
        """Return all imported names; where two imports provide the same name, the first wins."""
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
    """Imports by number; waiting imports are listed by the first name of their path."""

    def __init__(self, declarations: Sequence[tree.Import], space: Namespace):
        self.declarations = declarations
        self.space = space
        self.results: dict[int, Result] = {}
        self.waiting: dict[str, list[int]] = {}
        for i, declaration in enumerate(declarations):
            if declaration.file is None:
                self.waiting.setdefault(declaration.path[0], []).append(i)

    def run(self) -> list[Result]:
        """Resolve all imports.  Names of this place and its imports come first, then the surroundings, then
        files."""
        for i, declaration in enumerate(self.declarations):
            if declaration.file is not None:
                self._try(i, self.space.importer.file, declaration)
        named = list(self.results)
        for name, found in self._waited_for(self.space):
            named += self._meet(name, found)
        self._wake(named)
        batches = list(self._batches())
        for batch in batches:
            for seek in (
                self._modules_around,
                self._in_files,
            ):  # all names first, before the results are used
                self._wake([i for name in batch for i in seek(name)])
        for name in (name for batch in batches for name in batch):
            absent = self.waiting.pop(name, [])
            for i in absent:
                self.results[i] = self.space.importer.nothing(self.declarations[i])
            self._wake(absent)
        return [self.results[i] for i in range(len(self.declarations))]

    def _batches(self) -> Iterator[list[str]]:
        """Yield the awaited names; a name that an import provides comes after the first name of its path."""
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
        """Resolve the imports that wait for names that `settled` imports provide, round by round."""
        while settled:
            settled = [
                woken
                for i in sorted(settled)
                for name, result in self._brought(i)
                for woken in self._meet(name, result)
            ]

    def _brought(self, i: int) -> Iterable[tuple[str, Found | Wrong]]:
        """Return the awaited names that import `i` provides."""
        result, alias = self.results[i], self.declarations[i].alias
        if isinstance(result, Wrong | tuple):
            return [(alias, result)] if alias is not None and alias in self.waiting else []
        return self._waited_for(result)

    def _waited_for(self, place: Namespace) -> list[tuple[str, Found]]:
        names = sorted(self.waiting.keys() & place.names.keys())
        return [(name, (place.names[name], place)) for name in names]

    def _meet(self, name: str, met: Found | Wrong) -> list[int]:
        """Resolve all imports that wait for this name, if it is a package or a fault."""
        if isinstance(met, tuple) and not isinstance(met[0], tree.Package):
            return []
        woken = self.waiting.pop(name, [])
        for i in woken:
            if isinstance(met, Wrong):
                self.results[i] = met
            else:
                self._try(i, self.space.importer.member, self.declarations[i], met)
        return woken

    def _modules_around(self, name: str) -> list[int]:
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


class Importer:
    """Reads imported files, each once, and collects the faults."""

    def __init__(self, main: Source, roots: tuple[str, ...]):
        folder = folder_of(main.name if os.path.exists(main.name) else "")
        self.roots = tuple(dict.fromkeys(os.path.realpath(r) for r in (folder, *roots) if r))
        self.free: list[Source] = []  # texts that may name files anywhere
        self.faults: list[Wrong] = []
        self.refused: list[Refused] = []
        self.files: dict[str, Namespace] = {}
        self.broken: set[str] = set()
        self.asked: dict[str, str | None] = {}  # path -> fingerprint; None where there is no such file
        self.size = 0  # bytes read
        self._fingerprints: dict[str, str] = {}
        self._data: dict[str, Columns] = {}
        self._inner: dict[int, Namespace] = {}  # by identity of packages and models

    def report(self, wrong: Wrong) -> None:
        self.faults.append(wrong)

    def inside(self, outer: tree.Package | tree.ModelDeclaration, parent: Namespace) -> Namespace:
        """Return the namespace inside a package or model; the same one at every call."""
        space = self._inner.get(id(outer))
        if space is None:
            space = self._inner[id(outer)] = Namespace(outer.body, parent, self)
        return space

    def look_at(self, declarations: Iterable[tree.Declaration], space: Namespace) -> None:
        """Collect the faults of all imports among `declarations`, used or not."""
        self.faults += space.imports_here().faults
        for declaration in declarations:
            if isinstance(declaration, tree.Package | tree.ModelDeclaration):
                self.look_at(declaration.body, self.inside(declaration, space))

    def file(self, declaration: tree.Import) -> Namespace:
        """Return the namespace that `import "..."` provides: of a file in the folder, or else of the library.
        Raises Wrong."""
        path = self._path_beside(declaration.file or "", declaration.span)
        shipped = os.path.join(models_folder(), declaration.file or "")
        inside = is_within(os.path.realpath(shipped), [os.path.realpath(models_folder())])
        if inside and os.path.isfile(shipped) and not os.path.exists(path):
            self.asked[path] = None
            path = shipped
        return self._read(path, declaration.span)

    def member(self, declaration: tree.Import, found: Found) -> Found | Namespace:
        """Return what an import provides, where `found` is the first name of its path.  Raises Wrong."""
        return self._open(
            declaration, found[1].follow(found, declaration.path, declaration.span, "declaration")
        )

    def _open(self, declaration: tree.Import, found: Found) -> Found | Namespace:
        if not declaration.wildcard:
            return found
        container, outer = found
        if not isinstance(container, tree.Package):
            raise Wrong("LAG0216", f"`{'.'.join(declaration.path)}` is not a package", declaration.span)
        return self.inside(container, outer)

    def data(self, written: str, span: Span) -> Columns:
        """Return the columns of a data file, located like an import.  Raises Wrong."""
        path = self._path_beside(written, span)
        real = os.path.realpath(path)
        try:
            if real not in self._data:
                roots = None if span.source in self.free else self.roots
                found = content(path, largest=LARGEST_DATA, roots=roots)
                self._count(found, span)
                self._fingerprints[real] = fingerprint(path, found)
                self._data[real] = columns(decoded(found))
        except Outside:
            raise _outside_fault(written, span) from None
        except Unreadable as error:
            raise Wrong("LAG0226", f"`{written}` {error}", span, error.remedy) from None
        except Unfit as error:
            raise Wrong("LAG0314", f"`{written}` {error}", span, error.remedy) from None
        finally:
            self.asked[path] = self._fingerprints.get(real)
        return self._data[real]

    def _path_beside(self, written: str, span: Span) -> str:
        """Return the path of a file named in a text.  Raises Wrong if it is outside the roots."""
        path = os.path.join(folder_of(span.source.name) or os.sep, written)
        if span.source not in self.free and not is_within(os.path.realpath(path), self.roots):
            raise _outside_fault(written, span)
        return path

    def _count(self, data: bytes, span: Span) -> None:
        """Add to the total size of imports.  Raises Wrong if it is too large."""
        self.size += len(data)
        if self.size > TOGETHER:
            raise Wrong("LAG0216", f"the imports together are larger than {TOGETHER // 1_000_000} MB", span)

    def in_files(self, declaration: tree.Import) -> Found | Namespace | None:
        """Return what an import provides from a file named by its path, or None.  Raises Wrong."""
        names = declaration.path
        for root in self.roots:
            for length in range(len(names), 0, -1):
                path = os.path.join(root, *names[:length]) + ".lag"
                if not os.path.exists(path):
                    self.asked[path] = None
                    continue
                if not is_within(os.path.realpath(path), self.roots):
                    continue
                file = self._read(path, declaration.span)
                if names[length - 1] in file.names:
                    found = file.find(names[length - 1 :], declaration.span, "declaration")
                    return self._open(declaration, found)
        return None

    def nothing(self, declaration: tree.Import) -> Wrong:
        names = declaration.path
        remedy = f"looked for {_candidates(names)} in: {', '.join(shown(r) or '.' for r in self.roots)}"
        if names[0] in foreign("libraries"):
            remedy = foreign("libraries")[names[0]]
        message = f"`{'.'.join(names)}` cannot be imported: no file declares it"
        return Wrong("LAG0216", message, declaration.span, remedy)

    def _read(self, asked: str, span: Span) -> Namespace:
        path = os.path.realpath(asked)
        if path not in self.files and path not in self.broken:
            self._parse(path, span)
        if path in self.broken:
            raise Wrong("LAG0216", f"`{os.path.basename(path)}` has errors", span)
        self.asked[asked] = self._fingerprints[path]
        return self.files[path]

    def _parse(self, path: str, span: Span) -> None:
        """Parse a file into `files`, or add it to `broken`."""
        from lagc.syntax.parse import parse

        try:
            data = content(path, roots=(*self.roots, os.path.realpath(models_folder())))
            text = decoded(data)
        except Outside:
            raise _outside_fault(os.path.basename(path), span) from None
        except Unreadable as error:
            message = f"`{os.path.basename(path)}` cannot be imported: it {error}"
            raise Wrong("LAG0216", message, span, error.remedy) from None
        self._count(data, span)
        self._fingerprints[path] = fingerprint(path, data)
        try:
            parsed = parse(Source(shown(path), text))
        except Refused as refused:
            self.refused.append(refused)
            self.broken.add(path)
            return
        self.files[path] = Namespace(parsed.declarations, None, self)


def _outside_fault(written: str, span: Span) -> Wrong:
    message = f"`{written}` is outside the folders that may be imported from"
    return Wrong("LAG0217", message, span, "move the file into the folder of the model or a subfolder")


def _candidates(names: tuple[str, ...]) -> str:
    return " and ".join(f"{'/'.join(names[:n])}.lag" for n in range(1, len(names) + 1))


def shown(path: str) -> str:
    """Return the path for messages: relative if it is below the current folder."""
    here = folder_of("")
    if not here:
        return path
    return os.path.relpath(path, here) if path == here or path.startswith(here + os.sep) else path


MOST_ROWS = 1_000_000
_INDEX = re.compile(r"\s*\d+(?:\s*,\s*\d+)*\s*", re.ASCII)
_NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?", re.ASCII)


class Unfit(Exception):
    """A file without columns of numbers; the message follows the name of the file."""

    def __init__(self, message: str, remedy: str | None = None):
        super().__init__(message)
        self.remedy = remedy


@dataclass(frozen=True)
class Columns:
    """`heads`: name and unit (None if absent) of each column."""

    heads: Sequence[tuple[str, str | None]]
    rows: Sequence[tuple[int, list[str]]]  # line and cells

    def place(self, name: str) -> int | None:
        """Return the index of the column called `name`, or None."""
        return next((k for k, (head, _) in enumerate(self.heads) if head == name), None)

    def numbers(self, k: int) -> list[float]:
        """Return the numbers of column k in its unit.  Raises Unfit."""
        found = []
        for line, cells in self.rows:
            cell = cells[k].strip()
            if not _NUMBER.fullmatch(cell) or not math.isfinite(float(cell)):
                shown = f"`{cell}` is not a finite number" if cell else "the cell is empty"
                raise Unfit(f"has no value of `{self.heads[k][0]}` in line {line}: {shown}")
            found.append(float(cell))
        return found


def columns(text: str) -> Columns:
    """Read a line of column names, some with a unit (`u [N]`), and lines with as many numbers.  Raises
    Unfit."""
    import csv  # where a model looks numbers up

    reader = csv.reader(text.splitlines(), strict=True)
    rows: list[tuple[int, list[str]]] = []
    try:
        for cells in reader:
            if len(rows) > MOST_ROWS:
                raise Unfit(f"has more than {MOST_ROWS:,} rows")
            rows.append((reader.line_num, cells))
    except csv.Error as error:
        raise Unfit(f"is not a file of comma-separated values: {error} in line {reader.line_num}") from None
    # Empty lines at the end are none. Names must be names: a file of numbers alone has lost its head.
    while rows and not rows[-1][1]:
        rows.pop()
    if not rows:
        raise Unfit("is empty", "name the columns in the first line: `time,u`")
    (_, names), *rows = rows
    heads = [_head(name) for name in names]
    if any(_NUMBER.fullmatch(name) for name, _ in heads):
        raise Unfit("has no column names", "name the columns in the first line: `time,u` or `time [s],u [N]`")
    for k, (name, _) in enumerate(heads):
        if name in [other for other, _ in heads[:k]]:
            raise Unfit(f"has two columns called `{name}`")
    for line, cells in rows:
        if len(cells) != len(heads):
            message = f"has {len(heads)} columns, but {len(cells)} values in line {line}"
            raise Unfit(message, "separate the numbers by commas and write decimals with a point")
    return Columns(heads, rows)


def _head(written: str) -> tuple[str, str | None]:
    """Return name and unit.  An index right after a name belongs to the name: `th[1]`, `K[1,2] [N/m]`."""
    text = written.strip()
    name, bracket, inner = text[:-1].rpartition("[")
    if not (text.endswith("]") and bracket) or "]" in inner:
        return text, None
    if name[-1:].strip() and _INDEX.fullmatch(inner):
        return text, None
    return name.rstrip(), inner
