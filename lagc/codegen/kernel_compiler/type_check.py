"""Type check of kernels. Constructs outside of the subset are refused, with file and line."""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from lagc.codegen.kernel_compiler.kernel_syntax import (
    Function,
    Missing,
    Outside,
    identifier,
    returns,
    roots,
    targets,
)

Type = tuple[str, ...]  # ("Real",) ("int",) ("Vec", "NX") ("Mat", "NK", "NX") ("Record", "Work") ...
REAL, INT, COUNT, LENGTH, BOOL, STATUS, VOID, PAIR = (
    (name,) for name in ("Real", "int", "Count", "Length", "bool", "Status", "None", "Pair")
)
WHOLE = (INT, COUNT, LENGTH)
SCALARS = (REAL, *WHOLE, BOOL, STATUS)
ARRAYS = ("Vec", "IVec", "Mat", "Rows")
MATH = {"sqrt": 1, "fabs": 1, "floor": 1}
MADE = ("vector", "indices", "params")
_LENGTHS = {"Vec": 1, "IVec": 1, "Mat": 2, "Rows": 1, "Cell": 1}
_SPELLED = {"Size": "int", "Out": "Vec"}


def parsed(annotation: str, records: Callable[[str], bool]) -> Type:
    """Return the type of an annotation. Raises ValueError."""
    found = re.fullmatch(r"(\w+)(?:\[([\w, ]+)\])?", annotation)
    if found is None:
        raise ValueError(annotation)
    name, given = _SPELLED.get(found[1], found[1]), tuple(found[2].split(", ")) if found[2] else ()
    if len(given) == _LENGTHS.get(name, 0):
        if name in _LENGTHS or name == "Params" or (name,) in (*SCALARS, VOID, PAIR):
            return (name, *given)
        if records(name):
            return ("Record", name)
    raise ValueError(annotation)


@dataclass
class Signature:
    """`writes`: whether a call may change the contents of each argument; `place`: where the kernel stands."""

    parameters: tuple[Type, ...]
    returns: Type
    writes: list[bool]
    place: tuple[int, ...]


@dataclass
class Known:
    """The names that a kernel may use besides its own, for one choice of flags."""

    signatures: Mapping[str, Signature]  # of kernels, and of functions of the model
    members: Callable[[str], Mapping[str, Type]]  # of a record; KeyError
    is_record: Callable[[str], bool]
    constants: Mapping[str, Type]
    tables: Mapping[str, Type]
    sizes: frozenset[str]


@dataclass
class Types:
    """The types of one function: `locals` in the order of their first assignment; the type of an
    expression is its attribute `type`."""

    function: Function
    name: str
    body: list[ast.stmt]
    known: Known
    parameters: dict[str, Type] = field(default_factory=dict)
    locals: dict[str, Type] = field(default_factory=dict)
    counters: set[str] = field(default_factory=set)
    roots: dict[str, set[str]] = field(default_factory=dict)  # alias -> names that it may be part of
    assigned: dict[str, int] = field(default_factory=dict)
    touched: set[str] = field(default_factory=set)
    read: set[str] = field(default_factory=set)
    calls: dict[str, None] = field(default_factory=dict)
    records: dict[str, None] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for name, annotation in self.function.parameters:
            self.parameters[name] = self.annotated(annotation)
            if self.parameters[name] == PAIR:
                raise self.fail(self.function.line, "a Pair is a result only")
        self.returns = self.annotated(self.function.returns)
        self.block(self.body)
        if self.returns != VOID and not returns(self.body):
            raise self.fail(self.function.line, f"{self.name} may end without a result")

    def fail(self, node: ast.AST | int, what: str) -> Outside:
        return Outside(self.function.file, node, what)

    def annotated(self, text: str) -> Type:
        try:
            kind = parsed(text, self.known.is_record)
            sizes = () if kind[0] in ("Cell", "Record") else kind[1:]
            if not set(sizes) <= {*self.known.sizes, "Any"} or (
                kind[0] == "Cell" and (kind[1],) not in SCALARS
            ):
                raise ValueError(text)
            if kind[0] == "Record":
                self.records[kind[1]] = None
            return kind
        except ValueError:
            raise self.fail(self.function.line, f"{text} is not a type of the subset") from None

    @property
    def writes(self) -> list[bool]:
        """Whether each parameter is written, in any model."""
        return self.known.signatures[self.name].writes

    # -- statements --

    def block(self, body: list[ast.stmt]) -> None:
        for node in body:
            self.statement(node)

    def statement(self, node: ast.stmt) -> None:
        # Each case checks that the statement belongs to the subset, and types its expressions. A statement
        # that no case takes is refused.
        match node:
            case ast.Assign(targets=[ast.Name(id=name)], value=value):
                self.bind(node, name, value)
            case ast.Assign(targets=[ast.Subscript(slice=ast.Slice()) as target], value=value):
                self.copied(node, target, value)
            case ast.Assign(targets=[ast.Subscript() | ast.Attribute() as target], value=value):
                self.touch(target)
                self.fits(node, self.of(target), value)
            case ast.AugAssign(
                target=target, op=ast.Add() | ast.Sub() | ast.Mult() | ast.Div() as op, value=value
            ):
                if isinstance(target, ast.Name):
                    self.assigned[target.id] = self.assigned.get(target.id, 0) + 2
                    if target.id in self.parameters:
                        raise self.fail(node, f"the argument {target.id} is assigned")
                else:
                    self.touch(target)
                kind = self.of(target)
                if kind != REAL and isinstance(op, ast.Div):
                    raise self.fail(node, "integers are divided by //")
                self.fits(node, kind, value)
            case ast.If(test=test, body=body, orelse=orelse):
                self.condition(test)
                self.block(body)
                self.block(orelse)
            case ast.While(test=test, body=body, orelse=[]):
                self.condition(test)
                self.block(body)
            case ast.For(
                target=ast.Name(id=name),
                iter=ast.Call(func=ast.Name(id="range"), args=args, keywords=[]),
                orelse=[],
            ):
                self.loop(node, name, args)
            case ast.Return(value=None) | ast.Break() | ast.Continue():
                if isinstance(node, ast.Return) and self.returns != VOID:
                    raise self.fail(node, "a result is missing")
            case ast.Return(value=ast.Tuple(elts=[first, second])) if self.returns == PAIR:
                self.fits(node, REAL, first)
                self.fits(node, REAL, second)
            case ast.Return(value=value) if value is not None:
                self.fits(node, self.returns, value)
            case ast.Expr(value=ast.Call() as call):
                self.of(call)
            case _:
                text = ast.unparse(node).splitlines()[0]
                raise self.fail(node, f"{type(node).__name__} is not in the subset: {text}")

    def loop(self, node: ast.For, name: str, args: list[ast.expr]) -> None:
        # A range has ends that the body cannot change, so that C and Python make the same number of turns.
        kinds = [self.of(a) for a in args]
        for a, kind in zip(args, kinds):
            if kind not in WHOLE:
                raise self.fail(node, "the ends of a range are integers")
            if {n.id for n in ast.walk(a) if isinstance(n, ast.Name)} & targets(node.body):
                raise self.fail(node, "an end of the range changes in the loop")
        if len(args) == 3 and ast.unparse(args[2]) != "-1":
            raise self.fail(node, "a range steps by 1 or -1")
        kind = LENGTH if LENGTH in kinds else COUNT if COUNT in kinds else INT
        if name in self.parameters or (name in self.locals and name not in self.counters):
            raise self.fail(node, f"{name} is more than a counter")
        if name in targets(node.body):
            raise self.fail(node, f"the counter {name} is assigned")
        node.kind = kind  # type: ignore[attr-defined]
        before, self.locals[name] = self.locals.get(name), kind
        self.counters.add(name)
        self.block(node.body)
        del self.locals[name]  # its last value is not used
        if before is not None:
            raise self.fail(node, f"the counter {name} counts in a loop of {name}")

    def bind(self, node: ast.stmt, name: str, value: ast.expr) -> None:
        # The first assignment gives a local its type; an integer may be assigned to a real later, nothing
        # else changes.
        if name in self.parameters:
            raise self.fail(node, f"the argument {name} is assigned")
        if name in self.counters:
            raise self.fail(node, f"{name} is a counter elsewhere")
        made = identifier(value.func) if isinstance(value, ast.Call) else ""
        if isinstance(value, ast.Call) and made in MADE:
            sizes = [ast.unparse(a) for a in value.args]
            found: Type = ({"vector": "Vec", "indices": "IVec"}.get(made, "Params"), *sizes)
            if len(sizes) != (0 if made == "params" else 1) or not set(sizes) <= self.known.sizes:
                raise self.fail(node, f"a size is missing: {ast.unparse(value)}")
            self.read.update(sizes)
        elif isinstance(value, ast.Call) and self.known.is_record(made):
            found = ("Record", made)
            self.records[made] = None
        else:
            found = self.of(value)
            if hasattr(node, "annotation"):
                found = self.annotated(node.annotation)
                self.fits(node, found, value)
        old = self.locals.setdefault(name, found)
        if old != found and not (old == REAL and found in WHOLE):
            raise self.fail(node, f"{name} is {old[0]} before, {found[0]} here")
        if found[0] in (*ARRAYS, "Params", "Record") and not isinstance(value, ast.Call):
            self.roots.setdefault(name, set()).update(roots(value))
        self.assigned[name] = self.assigned.get(name, 0) + 1

    def copied(self, node: ast.Assign, target: ast.Subscript, value: ast.expr) -> None:
        # Two sides of a copy: a vector, a part of one, or the pair that a kernel returns.
        self.touch(target.value)
        match target.slice, value:
            case (
                ast.Slice(lower=ast.Constant(value=int(first)), upper=ast.Constant(value=last)),
                ast.Call(func=ast.Name(id=name), args=args),
            ) if last == first + 2 and self.of(target.value)[0] == "Vec" and name != "part":
                value.type = self.call(value, name, args, put=True)  # type: ignore[attr-defined]
                if value.type == PAIR:  # type: ignore[attr-defined]
                    return
        if isinstance(value, ast.Call) and identifier(value.func) == "part":
            found = self.of(value.args[0])
            ends = value.args[1:]
        else:
            found, ends = self.of(value), []
        if found[0] != self.of(target.value)[0] or found[0] not in ("Vec", "IVec", "Params"):
            raise self.fail(node, "only a vector, or a part of one, is copied into a vector")
        assert isinstance(target.slice, ast.Slice)
        for end in (target.slice.lower, target.slice.upper, *ends):
            if end is not None and self.of(end) not in WHOLE:
                raise self.fail(node, "the ends of a part are integers")
        if target.slice.upper is None and "Any" in self.of(target.value):
            raise self.fail(node, "how much is copied is to be said")

    def fits(self, node: ast.AST, wanted: Type, value: ast.expr) -> None:
        found = self.of(value)
        if wanted not in SCALARS:
            raise self.fail(node, "vectors and records are not assigned: v[:] = w copies")
        if found != wanted and not (wanted in (REAL, *WHOLE) and found in WHOLE):
            raise self.fail(node, f"{ast.unparse(value)} is {found[0]}, not {wanted[0]}")

    def condition(self, node: ast.expr) -> None:
        if self.of(node) != BOOL:
            raise self.fail(node, f"a condition is a truth value: {ast.unparse(node)}")

    def touch(self, node: ast.expr) -> None:
        self.touched |= roots(node)

    def is_written(self, name: str) -> bool:
        """Return whether the contents of an argument, in any model, or of an alias change."""
        # A name may be an alias of a member of another record: writing through it changes that.
        if name in self.parameters:
            return self.writes[[*self.parameters].index(name)]
        seen, more = set[str](), set(self.touched)
        while more - seen:
            seen |= more
            more = {root for n in seen for root in self.roots.get(n, ())}
        return name in seen

    # -- expressions --

    def of(self, node: ast.expr) -> Type:
        found = self._of(node)
        node.type = found  # type: ignore[attr-defined]
        return found

    def _of(self, node: ast.expr) -> Type:
        # A case returns the type, or falls through to the refusal at the end.
        match node:
            case ast.Constant(value=value):
                if type(value) in (bool, int, float):
                    return {bool: BOOL, int: INT, float: REAL}[type(value)]
            case ast.Name(id=name):
                return self.named(node, name)
            case ast.Attribute(value=value, attr=attr):
                owner = self.of(value)
                if owner[0] == "Record":
                    members = self.known.members(owner[1])
                    if attr in members:
                        return members[attr]
                    raise Missing(self.function.file, node, f"{owner[1]} has no {attr} here")
            case ast.Subscript(value=value, slice=index):
                owner = self.of(value)
                if self.of(index) not in WHOLE:
                    raise self.fail(node, f"an index is an integer: {ast.unparse(node)}")
                row, plain = ("Vec", owner[-1]), {"Vec": REAL, "Params": REAL, "IVec": INT, "Cell": owner[1:]}
                if owner[0] in (*ARRAYS, "Cell", "Params"):
                    return plain.get(owner[0], row)
            case ast.BinOp(left=left, op=op, right=right):
                return self.binary(node, op, self.of(left), self.of(right))
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                if self.of(operand) in (REAL, INT, COUNT):
                    return self.of(operand)
            case ast.UnaryOp(op=ast.Not(), operand=operand):
                self.condition(operand)
                return BOOL
            case ast.BoolOp(values=values):
                for value in values:
                    self.condition(value)
                return BOOL
            case ast.Compare(left=left, ops=[op], comparators=[right]):
                a, b = self.of(left), self.of(right)
                order = not isinstance(op, ast.Eq | ast.NotEq)
                numbers = {a, b} <= {REAL, INT, COUNT} or {a, b} <= {LENGTH, INT}
                if numbers or (a == b and a in (LENGTH, STATUS)) or (a == b == BOOL and not order):
                    return BOOL
            case ast.IfExp(test=test, body=body, orelse=orelse):
                self.condition(test)
                a, b = self.of(body), self.of(orelse)
                if a == b:
                    return a
                if {a, b} <= {REAL, INT, COUNT}:
                    return REAL if REAL in (a, b) else COUNT
            case ast.Call(func=ast.Name(id=name), args=args, keywords=[]):
                return self.call(node, name, args)
        raise self.fail(node, f"not in the subset: {ast.unparse(node)}")

    def binary(self, node: ast.BinOp, op: ast.operator, a: Type, b: Type) -> Type:
        if {a, b} <= {REAL, *WHOLE}:
            real = REAL in (a, b)
            whole = LENGTH if LENGTH in (a, b) else COUNT if COUNT in (a, b) else INT
            if isinstance(op, ast.FloorDiv | ast.Mod | ast.RShift | ast.BitAnd) and not real:
                return whole
            if isinstance(op, ast.Add | ast.Sub | ast.Mult):
                return REAL if real else whole
            if isinstance(op, ast.Div) and real:
                return REAL
        raise self.fail(node, f"not in the subset: {ast.unparse(node)}")

    def named(self, node: ast.expr, name: str) -> Type:
        self.read.add(name)
        for names in (self.parameters, self.locals, self.known.constants, self.known.tables):
            if name in names:
                return names[name]
        if name in self.known.sizes:
            return INT
        if name == "inf":
            return REAL
        raise self.fail(node, f"{name} is not known here")

    def call(self, node: ast.Call, name: str, args: list[ast.expr], put: bool = False) -> Type:
        given = [self.of(a) for a in args]
        if name in MATH and len(args) == MATH[name] and set(given) <= {REAL, INT}:
            return REAL
        if name == "float" and len(given) == 1 and given[0] in WHOLE:
            return REAL
        if name == "size" and given == [INT]:
            return INT
        if name == "whole" and given == [REAL]:
            return COUNT
        if name == "present" and len(given) == 1 and given[0] not in SCALARS:
            return BOOL
        callee = self.known.signatures.get(name)
        if callee is None or not callee.place < self.known.signatures[self.name].place:
            raise self.fail(node, f"{name} is no kernel that stands before, nor a function of the model")
        if callee.returns == PAIR and not put:
            raise self.fail(node, f"a Pair is put into two entries of a vector: v[0:2] = {name}(...)")
        self.calls[name] = None
        if len(callee.parameters) != len(given) or not all(map(_passes, given, callee.parameters)):
            raise self.fail(node, f"{name} takes {callee.parameters}, not {tuple(given)}")
        for a, writes in zip(args, callee.writes):
            if writes:
                self.touch(a)
        return callee.returns


def _passes(given: Type, wanted: Type) -> bool:
    if given[0] == wanted[0] in ("Vec", "IVec"):
        return given[1] == wanted[1] or "Any" in (given[1], wanted[1])
    return given == wanted or (wanted in (REAL, COUNT, LENGTH) and given in WHOLE)
