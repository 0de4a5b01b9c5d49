"""The compiler of kernels: one kernel, record or constant for the flags of a model, in one language.

Input: the files of `lagc.kernels`. A definition is specialised (`specialization`), its types are checked
(`type_check`), and it is printed (`c`, `python`).
"""

from __future__ import annotations

import ast
import importlib
import os
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from typing import Any, NamedTuple

from lagc.codegen.kernel_compiler import python
from lagc.codegen.kernel_compiler.c import CPrinter
from lagc.codegen.kernel_compiler.kernel_syntax import (
    Constant,
    Function,
    Module,
    Outside,
    Record,
    folder,
    read,
)
from lagc.codegen.kernel_compiler.lanes import LANES, LanePrinter
from lagc.codegen.kernel_compiler.parts import FUNCTION, LIST, RECORD, TITLE, Part
from lagc.codegen.kernel_compiler.pruning import Pruning, Short, known_values, short
from lagc.codegen.kernel_compiler.real_types import DOUBLE, TYPES
from lagc.codegen.kernel_compiler.specialization import Statics, tested
from lagc.codegen.kernel_compiler.type_check import INT, REAL, STATUS, Known, Signature, Type, Types, parsed
from lagc.codegen.kernel_compiler.written_arguments import written
from lagc.codegen.sizes import SPELLED
from lagc.kernels import FAMILIES, FILES, IMPLICIT, METHODS

KINDS = {"int": INT, "Real": REAL, "Reals": ("Vec", "Any"), "Status": STATUS, "Code": INT, "Method": INT}


class Method:
    """A method, as kernels use it. `tableau`: the names of its file and of its family; NAME; NUMBER, the
    constant of its position."""

    def __init__(self, name: str, number: int, tableau: dict[str, Any]):
        self.NAME, self.number, self.title = name, number, tableau["TITLE"]
        self.family = FAMILIES[tableau["FAMILY"]]
        self.tableau = {**self.family._asdict(), "IMPLICIT": int(name in IMPLICIT), **tableau}
        self.NUMBER = ast.Name(name.upper(), ast.Load())

    def __getattr__(self, name: str) -> Any:
        try:
            return self.tableau[name]
        except KeyError:
            raise AttributeError(name) from None


def read_method(name: str, number: int) -> Method:
    """Return the method of `kernels/integrators/tableaus/<name>.py`."""
    module = importlib.import_module(f"lagc.kernels.integrators.tableaus.{name}")
    return Method(name, number, {k: v for k, v in vars(module).items() if k.isupper()})


class Definition(NamedTuple):
    """A definition of a kernel file. A file of a family of methods is read once for each of them: `known` has
    the tableau, and `own` the functions whose names get the `prefix` of the method."""

    part: Function | Record | Constant
    place: tuple[int, int, int]  # number of the file, number of the method, line
    known: Mapping[str, Any]
    prefix: str = ""
    own: frozenset[str] = frozenset()


class Member(NamedTuple):
    """A member of a record; it exists if all `when` hold."""

    kind: Type
    when: tuple[tuple[str, bool], ...]
    lead: tuple[str, ...]
    trail: str


class Members(Mapping[str, Type]):
    """The members of a record for one choice of flags."""

    def __init__(self, members: Mapping[str, Member], flags: Mapping[str, bool]):
        self.members, self.flags = members, flags

    def __contains__(self, name: object) -> bool:
        return name in self.members and all(self.flags[f] == v for f, v in self.members[str(name)].when)

    def __getitem__(self, name: str) -> Type:
        return self.members[name].kind

    def __iter__(self) -> Iterator[str]:
        return (name for name in self.members if name in self)

    def __len__(self) -> int:
        return sum(1 for _ in self)


@dataclass
class Definitions:
    """The definitions of all kernel files, by name; the language does not matter."""

    sizes: frozenset[str]
    tables: Mapping[str, Type]
    signatures: dict[str, Signature] = field(default_factory=dict)
    named: dict[str, Definition] = field(default_factory=dict)
    records: dict[str, dict[str, Member]] = field(default_factory=dict)
    constants: dict[str, Type] = field(default_factory=dict)
    lists: dict[str, tuple[str, ...]] = field(default_factory=dict)  # file and kind -> names of constants
    titles: dict[tuple[int, int], tuple[str, str]] = field(default_factory=dict)
    bodies: dict[str, list[tuple[Mapping[str, bool], list[ast.stmt]]]] = field(default_factory=dict)

    def add(self, module: Module, file: int, known: Mapping[str, Any], method: Method | None = None) -> None:
        """Add the definitions of a file, which stand behind those before."""
        number, prefix, own = 0, "", frozenset[str]()
        title = module.title
        if method is not None:
            number, prefix, known, title = method.number, f"{method.NAME}_", method.tableau, method.title
            own = frozenset(p.name for p in module.parts if isinstance(p, Function))
        self.titles[file, number] = title, module.text
        for part in module.parts:
            name = prefix + part.name if isinstance(part, Function) else part.name
            place = (file, number, part.line)
            if self.is_taken(name, part):
                raise Outside(part.file, part.line, f"{name} is there already")
            self.named[name] = Definition(part, place, known, prefix, own)
            if isinstance(part, Constant):
                self.constants[name] = KINDS[part.kind]
                key = f"{module.file.removesuffix('.py')} {part.kind}"
                self.lists[key] = (*self.lists.get(key, ()), name)
            elif isinstance(part, Record):
                self.records[name] = {}
                self._members(part, part.body, (), self.records[name])
            else:
                self.signatures[name] = self._signature(name, self.named[name])

    def is_taken(self, name: str, part: Function | Record | Constant) -> bool:
        """Return whether a name means something already, or its name in C does."""
        vectors = {n.lower() for n, kind in self.constants.items() if kind[0] == "Vec"}
        if isinstance(part, Constant):
            return name in self.named
        known = name in self.named or name in self.tables or name in vectors or name in self.signatures
        return known or name == "piece" or re.fullmatch(r"table\d+", name) is not None

    def is_record(self, name: str) -> bool:
        return name in self.records

    def _signature(self, name: str, definition: Definition) -> Signature:
        part = definition.part
        assert isinstance(part, Function)
        try:
            kinds = tuple(parsed(a, self.is_record) for _, a in part.parameters)
            returns = parsed(part.returns, self.is_record)
        except ValueError as error:
            raise Outside(part.file, part.line, f"{error} is not a type of the subset") from None
        writes = written(part, self.signatures, definition.prefix)
        return Signature(kinds, returns, writes, definition.place)

    def _members(self, part: Record, body: list[ast.stmt], when: tuple[tuple[str, bool], ...],
                 members: dict[str, Member]) -> None:  # fmt: skip
        for node in body:
            if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name) and node.value is None:
                try:
                    kind = parsed(ast.unparse(node.annotation), self.is_record)
                except ValueError as error:
                    raise Outside(part.file, node, f"{error} is not a type of the subset") from None
                members[node.target.id] = Member(kind, when, tuple(node.lead), node.trail)  # type: ignore[attr-defined]
            elif isinstance(node, ast.If):
                flag = tested(node.test, self.sizes)
                if flag is None:
                    raise Outside(part.file, node.test, f"not a flag: {ast.unparse(node.test)}")
                self._members(part, node.body, (*when, (flag, True)), members)
                self._members(part, node.orelse, (*when, (flag, False)), members)
            else:
                raise Outside(part.file, node, "a record has fields only")


@cache
def definitions() -> Definitions:
    """Return the definitions of all kernel files."""
    found = Definitions(declared_sizes(), declared_tables(), model_functions())
    methods = tuple(read_method(name, k) for k, name in enumerate(METHODS))
    names = [Constant("", k, m.NAME.upper(), "Method", k, (), m.title) for k, m in enumerate(methods)]
    found.add(Module("methods.py", "", "", tuple(names)), -1, {})
    for k, name in enumerate(FILES):
        module = read(name)
        own = [method for method in methods if name in method.family.files]
        for method in own or (None,):
            found.add(module, k, {"METHODS": methods}, method)
    return found


def _tree(name: str) -> ast.Module:
    with open(os.path.join(folder(), f"{name}.py"), encoding="utf-8") as file:
        return ast.parse(file.read(), file.name)


def declared_sizes() -> frozenset[str]:
    return frozenset(n.name for n in _tree("language/sizes").body if isinstance(n, ast.ClassDef))


def declared_tables() -> dict[str, Type]:
    found = {}
    for node in _tree("language/model_tables").body:
        if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
            found[node.target.id] = parsed(ast.unparse(node.annotation), lambda name: False)
    return found


def model_functions() -> dict[str, Signature]:
    found = {}
    for node in _tree("language/model_functions").body:
        if isinstance(node, ast.FunctionDef):
            named = [(a.arg, ast.unparse(a.annotation)) for a in node.args.args if a.annotation]
            kinds = tuple(parsed(a, lambda name: name in ("State", "Work")) for _, a in named)
            writes = [a.startswith("Out") or n == "kept" or a == "Work" for n, a in named]
            found[node.name] = Signature(kinds, ("None",), writes, (-1, 0, 0))
    return found


class Noted(Mapping[str, bool]):
    """Flags that note which of them are asked for."""

    def __init__(self, flags: Mapping[str, bool]):
        self.flags, self.asked = flags, dict[str, bool]()

    def __getitem__(self, name: str) -> bool:
        self.asked[name] = self.flags[name]
        return self.asked[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.flags)

    def __len__(self) -> int:
        return len(self.flags)


class Compiler:
    """Prints definitions in one language: `python`, or C with the type of reals that the language names."""

    def __init__(self, language: str, known: Definitions | None = None):
        self.known = known or definitions()
        self.real = TYPES.get(language)
        texts = {n: f"lagc_{n.lower()}" if kind[0] == "Vec" else f"LAGC_{n}"
                 for n, kind in self.known.constants.items()}  # fmt: skip
        self.printer = CPrinter(self.real, SPELLED, texts) if self.real else None
        if language == LANES:
            self.real, self.printer = DOUBLE, LanePrinter(SPELLED, texts)

    def part(self, name: str, given: Mapping[str, bool]) -> Part:
        """Return a definition for these flags, and the flags that it depends on. Raises KeyError for an
        unknown name, Missing for a kernel that models with such flags do not have."""
        flags = Noted(given)
        if name in self.known.lists:
            found = Part(name, LIST, needs=self.known.lists[name])
        elif "#" in name:
            file, number = map(int, name.split("#"))
            title, text = self.known.titles[file, number]
            found = Part(name, TITLE, (file, number, 0), title, text)
        else:
            definition = self.known.named[name]
            match definition.part:
                case Constant() as part:
                    found = self.constant(name, part, definition.place)
                case Record() as part:
                    found = self.record(part, definition.place, flags)
                case Function() as part:
                    found = self.function(name, part, definition, flags)
        return found._replace(flags=flags.asked)

    def constant(self, name: str, part: Constant, place: tuple[int, int, int]) -> Part:
        """Return a constant; its text is its value."""
        value, note = part.value, " ".join([*part.lead, part.trail]).strip()
        if self.real is None:
            text = repr(value[1] if part.kind == "Real" and isinstance(value, tuple) else value)
        elif part.kind == "Reals":
            text = ", ".join(self.real.literal(v) for v in value)
        else:
            value = value[self.real.column] if isinstance(value, tuple) else value
            text = str(value) if isinstance(value, int) else self.real.literal(value)
        return Part(name, part.kind, place, text, note)

    def record(self, part: Record, place: tuple[int, int, int], flags: Mapping[str, bool]) -> Part:
        """Return the members of a record: name, type, comments before and beside."""
        members = self.known.records[part.name]
        there = [(n, *members[n]) for n in Members(members, flags)]
        inner = [kind[1] for _, kind, *_ in there if kind[0] == "Record"]
        return Part(part.name, RECORD, place, "", part.doc, needs=tuple(dict.fromkeys(inner)),
                    members=tuple([(n, kind, lead, trail) for n, kind, _, lead, trail in there]))  # fmt: skip

    def body(self, definition: Definition, flags: Noted) -> list[ast.stmt]:
        """Return the statements of a kernel that are left for these flags."""
        part, known = definition.part, self.known
        assert isinstance(part, Function)
        kept = known.bodies.setdefault(definition.prefix + part.name, [])
        for asked, found in kept:
            if all(flags.flags[flag] == value for flag, value in asked.items()):
                flags.asked.update(asked)
                return found

        def needs(name: str) -> Short | None:
            callee = known.named.get(name)
            if callee is None or not isinstance(callee.part, Function) or not callee.place < definition.place:
                return None
            names = tuple([parameter for parameter, _ in callee.part.parameters])
            return short(names, self.body(callee, own), known.constants)

        own = Noted(flags.flags)
        pruning = Pruning(needs, lambda name: name in known.signatures and any(known.signatures[name].writes))
        statics = Statics(part.file, own, known.sizes, definition.known, pruning, definition.prefix,
                          definition.own)  # fmt: skip
        found = pruning.finished(statics.block(part.body), part.body)
        if values := known_values(found):  # once more, with what is known now
            statics.known = {**statics.known, **values}
            found = pruning.finished(statics.block(found), part.body)
        kept.append((own.asked, found))
        flags.asked.update(own.asked)
        return found

    def function(self, name: str, part: Function, definition: Definition, flags: Noted) -> Part:
        known = self.known
        seen = Known(known.signatures, lambda r: Members(known.records[r], flags), known.is_record,
                     known.constants, known.tables, known.sizes)  # fmt: skip
        types = Types(part, name, self.body(definition, flags), seen)
        unused = set(types.locals) - types.read
        if unused:
            raise types.fail(part.line, f"{name}: {', '.join(sorted(unused))} is never read")
        used = types.read - {*types.parameters, *types.locals, *types.counters}
        names = {*types.calls, *types.records, *used}
        head = ""
        if self.printer:
            text = self.printer.function(types)
            head = self.printer.head(types) if part.public else ""
        else:
            text = python.function(types)
        lead = "\n".join(part.lead) if head else ""
        return Part(name, FUNCTION, definition.place, text, part.doc if head else "", head, lead,
                    needs=tuple(sorted(names & known.named.keys())),
                    names=tuple(sorted(names - known.named.keys())))  # fmt: skip
