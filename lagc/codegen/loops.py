"""Print rolled functions: loops, and the straight code between them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TypeAlias

from lagc.base.records import dataclass, replace
from lagc.codegen.loop_segments import CARRIED, KEPT, NUMBERS, READ, WRITTEN, Access, Segment, segments
from lagc.codegen.statements import Dialect, lines
from lagc.lowering.program import Function, Run

# name, array, first place, stride; None: a table, all of it
Running: TypeAlias = tuple[str, str, int, int | None]


@dataclass(frozen=True)
class Forms:
    """The differences between languages: `array` declares the array of kept values; `variable`, `fixed` and
    `change` declare and assign variables; `table` declares a table of numbers; `head` and `end` enclose a
    loop over a run, with names that run through arrays if `sequences`."""

    array: str
    variable: str
    fixed: str
    change: str
    table: Callable[[str, Sequence[float]], list[str]]
    head: Callable[[Run, Sequence[Running]], str]
    end: str
    sequences: bool = False
    number: str = "{}"  # an entry of a table of reals


def loops(
    function: Function, dialect: Dialect, forms: Forms, locals_: Mapping[tuple[str, int], str]
) -> list[list[str]]:
    """Return the body of a function with `runs`: the declaration of kept values, then the lines of each
    segment. Segments share only arrays. `locals_`: names of entries, for straight code."""
    found, size = segments(function)
    array = [forms.array.format(size=size)] if size else []
    return [array, *(_Printer(segment, dialect, forms, locals_).run() for segment in found)]


class _Printer:
    def __init__(
        self, segment: Segment, dialect: Dialect, forms: Forms, locals_: Mapping[tuple[str, int], str]
    ) -> None:
        self.segment, self.dialect, self.forms, self.locals = segment, dialect, forms, locals_
        self.tables: dict[tuple[float, ...], str] = {}
        self.before: list[str] = []
        self.running: list[Running] = []

    def run(self) -> list[str]:
        segment, forms = self.segment, self.forms
        reads = [self._read(k, access) for k, access in enumerate(segment.reads)]
        writes = [self._index(access) for access in segment.writes]

        def load(array: str, index: int) -> str:
            return reads[index] if array == READ else f"{CARRIED}{index}"

        def store(array: str, index: int | str, value: str) -> str:
            if array == WRITTEN:
                return self.dialect.store(segment.writes[int(index)].array, writes[int(index)], value)
            return forms.change.format(name=f"{CARRIED}{index}", value=value)

        names = {(READ, k): self._name(k) for k, text in enumerate(reads) if not text.isidentifier()}
        body = lines(segment.body, replace(self.dialect, load=load, store=store), names)
        if segment.run.count == 1:
            return body
        for k, access in enumerate(segment.carries):
            value = self._entry(access)
            self.before.append(forms.variable.format(name=f"{CARRIED}{k}", value=value))
        loop = self._block(forms.head(segment.run, self.running), body)
        return [*self.before, *loop]

    def _block(self, head: str, text: Sequence[str]) -> list[str]:
        return [head, *(f"    {line}" for line in text), *([self.forms.end] if self.forms.end else [])]

    def _name(self, k: int) -> str:
        access, own = self.segment.reads[k], f"{READ}{k}"
        return (
            self.locals.get((access.array, int(access.indices[0])), own)
            if self.segment.run.count == 1
            else own
        )

    def _read(self, k: int, access: Access) -> str:
        name, forms, count = f"{READ}{k}", self.forms, self.segment.run.count
        if count == 1:
            return self._entry(access)
        if access.stride == 0:
            self.before.append(forms.fixed.format(name=name, value=self._entry(access)))
            return name
        if not forms.sequences or (access.array == KEPT and self._is_written(access)):
            return self._entry(access)
        if access.stride is None:
            if access.array == NUMBERS:
                self.running.append((name, self._table(access.indices), 0, None))
                return forms.number.format(name)
            self.running.append((f"i{k}", self._table(access.indices), 0, None))
            return self.dialect.entry(access.array, f"i{k}")
        self.running.append((name, access.array, int(access.indices[0]), access.stride))
        return name

    def _is_written(self, access: Access) -> bool:
        """Return whether the loop writes the entries that it reads."""
        first, last = min(access.indices), max(access.indices)
        return any([
            written.array == KEPT and written.indices[0] <= last and first <= written.indices[-1]
            for written in self.segment.writes
        ])  # fmt: skip

    def _entry(self, access: Access) -> str:
        if access.array == NUMBERS:
            return self.forms.number.format(f"{self._table(access.indices)}[i]")
        if access.stride == 0 and access.array != KEPT:
            return self.dialect.load(access.array, int(access.indices[0]))
        return self.dialect.entry(access.array, self._index(access))

    def _index(self, access: Access) -> str:
        first, stride = int(access.indices[0]), access.stride
        if stride is None:
            return f"{self._table(access.indices)}[i]"
        if not stride:
            return str(first)
        times = "i" if abs(stride) == 1 else f"{abs(stride)} * i"
        return f"{first} - {times}" if stride < 0 else f"{first} + {times}" if first else times

    def _table(self, values: Sequence[float]) -> str:
        key = tuple(values)
        if key not in self.tables:
            self.tables[key] = f"n{len(self.tables)}"
            self.before += self.forms.table(self.tables[key], key)
        return self.tables[key]
