"""The library of printed kernels: every kernel for every choice of flags that changes it.

A function is a tree [flag, tree if true, tree if false] with texts as leaves.
"""

from __future__ import annotations

import ast
import importlib
import os
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from typing import Any

from lagc.codegen.kernel_compiler import python
from lagc.codegen.kernel_compiler.c import CPrinter
from lagc.codegen.kernel_compiler.kernel_syntax import (
    Constant,
    Function,
    Missing,
    Module,
    Outside,
    Record,
    folder,
    read,
)
from lagc.codegen.kernel_compiler.linker import SPELLED
from lagc.codegen.kernel_compiler.real_types import DOUBLE, Arithmetic
from lagc.codegen.kernel_compiler.specialization import Statics, Undecided
from lagc.codegen.kernel_compiler.type_check import INT, REAL, STATUS, Known, Signature, Type, Types, parsed
from lagc.kernels import FAMILIES, FILES, IMPLICIT, METHODS

Tree = Any  # [flag, Tree, Tree] or what is printed, a dictionary


def _tree(name: str) -> ast.Module:
    with open(os.path.join(folder(), f"{name}.py"), encoding="utf-8") as file:
        return ast.parse(file.read())


@cache
def declared_sizes() -> frozenset[str]:
    return frozenset(n.name for n in _tree("language/sizes").body if isinstance(n, ast.ClassDef))


@cache
def declared_tables() -> dict[str, Type]:
    found = {}
    for node in _tree("language/model_tables").body:
        if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
            found[node.target.id] = parsed(ast.unparse(node.annotation), lambda name: False)
    return found


@cache
def model_functions() -> dict[str, Function]:
    found = {}
    for node in _tree("language/model_functions").body:
        if isinstance(node, ast.FunctionDef):
            parameters = tuple((a.arg, ast.unparse(a.annotation)) for a in node.args.args if a.annotation)
            found[node.name] = Function(
                "language/model_functions.py", node.lineno, node.name, parameters, "None", "", [], False, ()
            )
    return found


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
    tableau = {k: v for k, v in vars(module).items() if k.isupper()}
    return Method(name, number, tableau)


@dataclass
class Member:
    """A member of a record; it exists if all `when` hold."""

    kind: Type
    when: tuple[tuple[str, bool], ...]
    lead: tuple[str, ...]
    trail: str


class Members(Mapping[str, Type]):
    """The members of a record for one choice of flags. Access may raise Undecided."""

    def __init__(self, members: Mapping[str, Member], flags: Mapping[str, bool]):
        self.members, self.flags = members, flags

    def exists(self, name: str) -> bool:
        for flag, value in self.members[name].when:
            if flag not in self.flags:
                raise Undecided(flag)
            if self.flags[flag] != value:
                return False
        return True

    def __contains__(self, name: object) -> bool:
        return name in self.members and self.exists(str(name))

    def __getitem__(self, name: str) -> Type:
        return self.members[name].kind

    def __iter__(self) -> Iterator[str]:
        return (name for name in self.members if self.exists(name))

    def __len__(self) -> int:
        return sum(1 for _ in self)


@dataclass
class Library:
    """Reads and prints kernels in the order of the files; `parts` is the result."""

    real: Arithmetic = DOUBLE
    records: dict[str, dict[str, Member]] = field(default_factory=dict)
    signatures: dict[str, Signature] = field(default_factory=dict)
    constants: dict[str, Type] = field(default_factory=dict)
    spelled: dict[str, str] = field(default_factory=dict)
    tables: dict[str, Type] = field(default_factory=dict)
    sizes: frozenset[str] = frozenset()
    short: dict[str, python.Short] = field(default_factory=dict)
    parts: list[dict[str, Any]] = field(default_factory=list)

    def load(self) -> Library:
        self.sizes = declared_sizes()
        self.tables = declared_tables()
        self.signatures = {name: self._extern(f) for name, f in model_functions().items()}
        methods = tuple(read_method(name, k) for k, name in enumerate(METHODS))
        for method in methods:
            self.constant(Constant("", 0, method.NAME.upper(), "Method", method.number, (), method.title))
        for name in FILES:
            module = read(name)
            own = [method for method in methods if name in method.family.files]
            for method in own:
                self.module(module, method.tableau, f"{method.NAME}_", method.title)
            if not own:
                self.module(module, {"METHODS": methods})
        return self

    def module(self, module: Module, known: Mapping[str, Any], prefix: str = "", title: str = "") -> None:
        name, title = module.file.removesuffix(".py"), title or module.title
        self.parts.append({"kind": "file", "name": name, "title": title, "text": module.text})
        own = (
            frozenset(p.name for p in module.parts if isinstance(p, Function)) if prefix else frozenset[str]()
        )
        for part in module.parts:
            if isinstance(part, Constant):
                self.constant(part)
            elif isinstance(part, Record):
                self.record(part)
            else:
                self.function(part, known, prefix, own)

    # -- constants and records --

    def constant(self, part: Constant) -> None:
        if part.name in self.constants:
            raise Outside(part.file, part.line, f"{part.name} is there already")
        if part.kind == "Reals":
            self.reals(part)
            return
        kinds = {"int": INT, "Real": REAL, "Status": STATUS, "Code": INT, "Method": INT}
        self.constants[part.name], self.spelled[part.name] = kinds[part.kind], f"LAGC_{part.name}"
        value = part.value[self.real.column] if isinstance(part.value, tuple) else part.value
        plain = part.value[1] if isinstance(part.value, tuple) else part.value
        note = " ".join([*part.lead, part.trail]).strip()
        text = str(value) if isinstance(value, int) else self.real.literal(value)
        self.parts.append(
            {"kind": part.kind, "name": part.name, "value": text, "python": repr(plain), "note": note}
        )

    def reals(self, part: Constant) -> None:
        self.constants[part.name], self.spelled[part.name] = ("Vec", "Any"), f"lagc_{part.name.lower()}"
        self.parts.append({
            "kind": part.kind, "name": part.name, "value": [self.real.literal(v) for v in part.value],
            "python": repr(part.value), "note": " ".join([*part.lead, part.trail]).strip(),
        })  # fmt: skip

    def record(self, part: Record) -> None:
        members: dict[str, Member] = {}
        self._members(part, part.body, (), members)
        self.records[part.name] = members
        self.parts.append({
            "kind": "record", "name": part.name, "doc": part.doc,
            "members": [[n, m.kind, m.when, m.lead, m.trail] for n, m in members.items()],
        })  # fmt: skip

    def _members(self, part: Record, body: list[ast.stmt], when: tuple[tuple[str, bool], ...],
                 members: dict[str, Member]) -> None:  # fmt: skip
        for node in body:
            if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name) and node.value is None:
                try:
                    kind = parsed(ast.unparse(node.annotation), self.records.__contains__)
                except ValueError as error:
                    raise Outside(part.file, node, f"{error} is not a type of the subset") from None
                members[node.target.id] = Member(kind, when, tuple(node.lead), node.trail)  # type: ignore[attr-defined]
            elif isinstance(node, ast.If):
                flag = self._flag(part, node.test)
                self._members(part, node.body, (*when, (flag, True)), members)
                self._members(part, node.orelse, (*when, (flag, False)), members)
            else:
                raise Outside(part.file, node, "a record has fields only")

    def _flag(self, part: Record, test: ast.expr) -> str:
        try:
            Statics(part.file, {}, self.sizes, {}).test(test)
        except Undecided as found:
            return found.flag
        raise Outside(part.file, test, f"not a flag: {ast.unparse(test)}")

    # -- functions --

    def _extern(self, function: Function) -> Signature:
        kinds = tuple(parsed(a, lambda name: name in ("State", "Work")) for _, a in function.parameters)
        written = [a.startswith("Out") or n == "kept" or a == "Work" for n, a in function.parameters]
        return Signature(kinds, ("None",), written)

    def function(self, part: Function, known: Mapping[str, Any], prefix: str, own: frozenset[str]) -> None:
        name = prefix + part.name
        taken = {*self.signatures, *self.constants, *self.tables, "piece"}
        if name in taken or f"lagc_{name}" in self.spelled.values() or re.fullmatch(r"table\d+", name):
            raise Outside(part.file, part.line, f"{name} is there already")

        def typed(flags: Mapping[str, bool]) -> Types | str:
            body = Statics(part.file, flags, self.sizes, known, prefix, own).block(part.body)
            seen = Known(self.signatures, lambda r: Members(self.records[r], flags),
                         self.records.__contains__, self.constants, self.tables, self.sizes)  # fmt: skip
            try:
                return Types(part, name, body, seen)
            except Missing as error:
                if flags:
                    return str(error)  # not for such a model
                raise

        tree = _explored(typed, {})
        leaves = [leaf for leaf in _leaves(tree) if isinstance(leaf, Types)]
        if not leaves:
            raise Outside(part.file, part.line, next(str(leaf) for leaf in _leaves(tree)))
        signature = leaves[0].signature
        signature.writes = [any(column) for column in zip(*(leaf.signature.writes for leaf in leaves))]
        self.signatures[name] = signature
        found = python.short(leaves[0]) if len(leaves) == 1 and isinstance(tree, Types) else None
        printer = CPrinter(self.real, SPELLED, self.spelled)
        heads = printer.head(leaves[0], signature.writes)
        self.parts.append({
            "kind": "function", "name": name, "public": part.public, "lead": part.lead if part.public else (),
            "doc": part.doc, "head": heads,
            "tree": _mapped(tree, lambda leaf: self._printed(printer, leaf, signature)),
        })  # fmt: skip
        if found is not None:
            self.short[name] = found

    def _printed(self, printer: CPrinter, leaf: Types | str, signature: Signature) -> dict[str, Any]:
        if isinstance(leaf, str):
            return {"missing": leaf}
        unused = set(leaf.locals) - leaf.read
        if unused:
            raise leaf.fail(leaf.function.line, f"{leaf.name}: {', '.join(sorted(unused))} is never read")
        seen = leaf.read - {*leaf.parameters, *leaf.locals, *leaf.counters}
        return {
            "c": printer.function(leaf, signature.writes), "python": python.function(leaf, self.short),
            "calls": list(leaf.calls), "records": list(leaf.records),
            "uses": sorted(seen & {*self.constants, *self.tables, *self.sizes}),
        }  # fmt: skip


def _explored(find: Callable[[Mapping[str, bool]], Any], flags: Mapping[str, bool]) -> Tree:
    try:
        return find(flags)
    except Undecided as undecided:
        flag = undecided.flag
    return [flag, *(_explored(find, {**flags, flag: value}) for value in (True, False))]


def _leaves(tree: Tree) -> list[Any]:
    return _leaves(tree[1]) + _leaves(tree[2]) if isinstance(tree, list) else [tree]


def _mapped(tree: Tree, change: Callable[[Any], Any]) -> Tree:
    if isinstance(tree, list):
        return [tree[0], _mapped(tree[1], change), _mapped(tree[2], change)]
    return change(tree)
