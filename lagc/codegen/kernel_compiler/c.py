"""Print kernels as C99 that is also C++."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Mapping, Sequence
from textwrap import fill

from lagc.codegen.kernel_compiler.kernel_syntax import identifier, root
from lagc.codegen.kernel_compiler.real_types import Arithmetic
from lagc.codegen.kernel_compiler.type_check import (
    BOOL,
    INT,
    MADE,
    PAIR,
    REAL,
    SCALARS,
    VOID,
    WHOLE,
    Type,
    Types,
)

CHOICE, OR, AND, BITS, EQUAL, COMPARE, SHIFT, SUM, PRODUCT, SIGN, ATOM = range(1, 12)
_OPERATORS = {
    ast.Add: ("+", SUM), ast.Sub: ("-", SUM), ast.Mult: ("*", PRODUCT), ast.Div: ("/", PRODUCT),
    ast.FloorDiv: ("/", PRODUCT), ast.Mod: ("%", PRODUCT), ast.RShift: (">>", SHIFT), ast.BitAnd: ("&", BITS),
    ast.Lt: ("<", COMPARE), ast.LtE: ("<=", COMPARE), ast.Gt: (">", COMPARE), ast.GtE: (">=", COMPARE),
    ast.Eq: ("==", EQUAL), ast.NotEq: ("!=", EQUAL),
}  # fmt: skip


class CPrinter:
    """Prints with `lagc_` and `LAGC_` before each name of the interface. `numbers`: sizes that have no name;
    `constants`: their text."""

    def __init__(self, real: Arithmetic, numbers: Mapping[str, str], constants: Mapping[str, str]):
        self.real, self.numbers, self.constants = real, numbers, constants

    # -- declarations --

    def ctype(self, kind: Type) -> str:
        name = {
            "Real": self.real.name, "Vec": self.real.name, "Mat": self.real.name, "Rows": self.real.name,
            "int": "int", "IVec": "int", "bool": "bool", "Count": "long", "Length": "size_t", "None": "void",
            "Status": "lagc_status", "Params": "lagc_params", "Pair": "void",
        }.get(kind[0])  # fmt: skip
        if kind[0] == "Cell":
            return self.ctype(INT if kind[1] == "bool" else (kind[1],))
        return (f"lagc_{snake(kind[1])}" if name is None else name) + " "

    def size(self, name: str) -> str:
        return self.numbers.get(name, f"LAGC_{name}")

    def member(self, kind: Type, name: str) -> str:
        """Return the declaration of a member; truth values are ints for callers in other languages."""
        return self.declared(INT if kind == BOOL else kind, name)

    def declared(self, kind: Type, name: str) -> str:
        """Return the declaration of a variable."""
        lengths = kind[1:] if kind[0] in ("Vec", "IVec", "Mat") else ()
        return self.ctype(kind) + name + "".join(f"[{self.size(n)}]" for n in lengths)

    def argument(self, kind: Type, name: str, written: bool) -> str:
        if kind in SCALARS:
            return self.ctype(kind) + name
        if kind[0] == "Mat":  # C99 does not convert rows to const rows
            return f"{self.ctype(kind)}(*{name})[{self.size(kind[2])}]"
        return ("" if written else "const ") + self.ctype(kind) + "*" + name

    def head(self, types: Types) -> str:
        parts = [self.argument(k, n, w) for (n, k), w in zip(types.parameters.items(), types.writes)]
        if types.returns == PAIR:
            parts.append(f"{self.real.name} *pair_")
        static = "" if types.function.public else "static inline " if types.function.inline else "static "
        return f"{static}{self.ctype(types.returns)}lagc_{types.name}({', '.join(parts) or 'void'})"

    # -- functions --

    def function(self, types: Types) -> str:
        self.now, self.places = types, places(types.body)
        lines = [f"    {self.local(name)};" for name in types.locals if self.places[name] is None]
        lines += [f"    {ignored(n for n in types.parameters if n not in types.read)}"]
        self.block(types.body, "    ", lines)
        if lines[-1:] == ["    return;"]:
            lines.pop()
        doc = ""
        if not types.function.public:  # the header has these
            doc = block_comment(fill(first_sentence(self.spelled(types.function.doc)), WIDTH))
        body = "\n".join(folded(line) for line in lines if line.strip())
        return f"{doc}{self.head(types)}\n{{\n{body}\n}}\n"

    def spelled(self, text: str) -> str:
        """Write members of records in comments as in C: w->rank."""
        named = {**self.now.parameters, **self.now.locals}
        records = [n for n, kind in named.items() if kind[0] == "Record" and not self.is_held(n)]
        return re.sub(rf"\b({'|'.join(records)})\.(?=[a-z])", r"\1->", text) if records else text

    def local(self, name: str) -> str:
        """Return the declaration of a local; const if it is assigned once."""
        kind = self.now.locals[name]
        if name in self.now.roots:
            const = "" if self.now.is_written(name) else "const "
            if kind[0] == "Mat":
                return f"{const}{self.ctype(kind)}(*{name})[{self.size(kind[2])}]"
            return f"{const}{self.ctype(kind)}*{name}"
        once = self.now.assigned[name] == 1 and self.places[name] is not None
        return ("const " if once and kind in SCALARS else "") + self.declared(kind, name)

    def block(self, body: Sequence[ast.stmt], indent: str, out: list[str]) -> None:
        for node in body:
            self.statement(node, indent, out)

    def statement(self, node: ast.stmt, indent: str, out: list[str]) -> None:
        # Kernels are C already but for assignments of vectors, loops, and a pair as result, which is an
        # argument in C.
        match node:
            case ast.Assign(targets=[ast.Name(id=name)], value=value):
                self.bind(node, name, value, indent, out)
            case ast.Assign(targets=[ast.Subscript(slice=ast.Slice()) as target], value=value):
                self.copy(target, value, indent, out)
            case ast.Assign(targets=[target], value=value):
                kind: Type = target.type  # type: ignore[attr-defined]
                out.append(f"{indent}{self.text(target)} = {self.converted(value, kind)};")
            case ast.AugAssign(target=target, op=op, value=value):
                sign, kind = _OPERATORS[type(op)][0], target.type  # type: ignore[union-attr]
                if isinstance(value, ast.Constant) and value.value == 1 and sign in "+-" and kind in WHOLE:
                    out.append(f"{indent}{self.text(target)}{sign * 2};")
                else:
                    out.append(f"{indent}{self.text(target)} {sign}= {self.converted(value, kind)};")
            case ast.If():
                self.branch(node, indent, out)
            case ast.While(test=test, body=body):
                forever = isinstance(test, ast.Constant)
                out.append(f"{indent}for (;;)" if forever else f"{indent}while ({self.condition(test)})")
                self.braced(body, indent, out)
            case ast.For():
                self.loop(node, indent, out)
            case ast.Return(value=None):
                out.append(indent + "return;")
            case ast.Return(value=ast.Tuple(elts=ends)):
                out += [f"{indent}pair_[{k}] = {self.converted(end, REAL)};" for k, end in enumerate(ends)]
                out.append(indent + "return;")
            case ast.Return(value=value):
                assert value is not None
                out.append(f"{indent}return {self.converted(value, self.now.returns)};")
            case ast.Break() | ast.Continue():
                out.append(indent + ast.unparse(node) + ";")
            case ast.Expr(value=value):
                void = "(void)" if value.type != VOID else ""  # type: ignore[attr-defined]
                out.append(f"{indent}{void}{self.text(value)};")

    def loop(self, node: ast.For, indent: str, out: list[str]) -> None:
        assert isinstance(node.target, ast.Name) and isinstance(node.iter, ast.Call)
        # The end of a range is evaluated once, as in Python; a constant needs no variable. Members and calls
        # may change in the body, names may not (the type check refuses that).
        i, args = node.target.id, node.iter.args
        kind: Type = node.kind  # type: ignore[attr-defined]
        first, end = ("0", args[0]) if len(args) == 1 else (self.text(args[0]), args[1])
        limit = self.operand(end, None, SHIFT)
        if not self.stays(end, node.body):
            first, limit = f"{first}, {i}_end = {self.text(end)}", f"{i}_end"
        test = f"{i} < {limit}"
        if len(args) == 3:
            test = f"{i} >= 0" if limit == "-1" else f"{i} > {limit}"
        step = "--" if len(args) == 3 else "++"
        out.append(f"{indent}for ({self.ctype(kind)}{i} = {first}; {test}; {i}{step})")
        self.braced(node.body, indent, out)

    def stays(self, end: ast.expr, body: Sequence[ast.stmt]) -> bool:
        """Return whether a loop changes nothing that the end of its range reads: a member of its name, or
        any by a call."""
        inside, nodes = list(ast.walk(end)), [n for statement in body for n in ast.walk(statement)]
        read = {n.attr for n in inside if isinstance(n, ast.Attribute)}
        stored = {n.attr for n in nodes if isinstance(n, ast.Attribute) and isinstance(n.ctx, ast.Store)}
        calls = [identifier(n.func) for n in nodes if isinstance(n, ast.Call)]
        known = self.now.known.signatures
        acts = any(name in known and any(known[name].writes) for name in calls)
        plain = not any(isinstance(n, ast.Call | ast.Subscript) for n in inside)
        return plain and not (read & stored) and not (read and acts)

    def braced(self, body: Sequence[ast.stmt], indent: str, out: list[str]) -> None:
        """Print the block after the head that is the last line."""
        out[-1] += " {"
        self.block(body, indent + "    ", out)
        out.append(indent + "}")

    def bind(self, node: ast.stmt, name: str, value: ast.expr, indent: str, out: list[str]) -> None:
        # The declaration stands at the first assignment if that is in the block of all uses; records begin as
        # zeros.
        kind = self.now.locals[name]
        declare = self.places[name] is node
        if isinstance(value, ast.Call) and identifier(value.func) in MADE:
            out += [f"{indent}{self.local(name)};"] if declare else []
        elif kind[0] == "Record" and isinstance(value, ast.Call):
            out += [f"{indent}{self.local(name)};"] if declare else []
            out.append(f"{indent}(void)memset(&{name}, 0, sizeof {name});")
        else:
            text = self.passed(value, kind)
            out.append(f"{indent}{self.local(name) if declare else name} = {text};")

    def copy(self, target: ast.Subscript, value: ast.expr, indent: str, out: list[str]) -> None:
        # v[a:b] = w, or a part of it; parameters are a struct, which C copies; a pair writes through a
        # pointer.
        cut, kind = target.slice, target.value.type  # type: ignore[attr-defined]
        assert isinstance(cut, ast.Slice)
        if kind[0] == "Params":
            out.append(f"{indent}{self.pointed(target.value)} = {self.pointed(value)};")
            return
        place = self.text(target.value) + self.offset(cut.lower)
        if getattr(value, "type", VOID) == PAIR:
            out.append(f"{indent}{self.text(value)[:-1]}, {place});")
            return
        source, offset = value.args[:2] if isinstance(value, ast.Call) else (value, None)
        count = self.length(cut.lower, cut.upper) if cut.upper else self.size(kind[1])
        name = "copy_numbers" if kind[0] == "IVec" else "copy"
        out.append(f"{indent}lagc_{name}({place}, {self.text(source)}{self.offset(offset)}, {count});")

    def offset(self, first: ast.expr | None) -> str:
        """Return what leads from a vector to its part from `first` on."""
        if first is None or isinstance(first, ast.Constant):
            return f" + {first.value}" if first and first.value else ""  # type: ignore[str-bytes-safe]
        return f" + {self.operand(first, None, SUM)}"

    def length(self, first: ast.expr | None, end: ast.expr) -> str:
        """Return the length of a part."""
        if isinstance(end, ast.BinOp) and first and ast.unparse(end.left) == ast.unparse(first):
            return self.text(end.right)
        return f"{self.text(end)} - {self.operand(first, None, PRODUCT)}" if first else self.text(end)

    def pointed(self, node: ast.expr) -> str:
        """Return the struct of parameters itself, not a pointer."""
        return self.text(node) if self.is_own(node) else f"*{self.text(node)}"

    def is_own(self, node: ast.expr) -> bool:
        """Return whether an expression is a record or struct of parameters itself, not a pointer to one."""
        return isinstance(node, ast.Attribute) or self.is_held(identifier(node))

    def is_held(self, name: str) -> bool:
        return name in self.now.locals and name not in self.now.roots

    def passed(self, node: ast.expr, wanted: Type) -> str:
        """Return an argument, or the value of a local: of a record its address."""
        is_struct = wanted[0] in ("Record", "Params") and self.is_own(node)
        return ("&" if is_struct else "") + self.converted(node, wanted)

    def branch(self, node: ast.If, indent: str, out: list[str]) -> None:
        """Print a chain of tests."""
        word, now = indent, node
        while True:
            out.append(f"{word}if ({self.condition(now.test)}) {{")
            self.block(now.body, indent + "    ", out)
            match now.orelse:
                case [ast.If() as other]:
                    word, now = f"{indent}}} else ", other
                    continue
                case [_, *_] as others:
                    out.append(f"{indent}}} else {{")
                    self.block(others, indent + "    ", out)
            out.append(indent + "}")
            return

    # -- expressions --

    def converted(self, node: ast.expr, wanted: Type) -> str:
        """Return an expression where the type `wanted` is expected, with explicit conversion."""
        kind: Type = node.type  # type: ignore[attr-defined]
        if wanted == BOOL:
            return self.condition(node)
        if kind == wanted or kind[0] in ("Vec", "IVec", "Mat", "Rows", "Record", "Params", "Cell"):
            return self.text(node)
        return self.operand(node, wanted, 0)

    def operand(self, node: ast.expr, wanted: Type | None, least: int, strict: bool = False) -> str:
        """Return an operand of an operator that binds as `least`, converted to `wanted`. It has parentheses
        unless it is no operation, or one that binds as the operator does: precedence is explicit (MISRA C
        2012, rule 12.1)."""
        # Parentheses by binding strength, as few as C needs; conversions of integers are written out.
        kind: Type = node.type  # type: ignore[attr-defined]
        text, binds = self.expression(node)
        if wanted in (REAL, *WHOLE) and kind != wanted and kind in WHOLE:
            assert wanted is not None
            if isinstance(node, ast.Constant) and wanted != REAL:
                return text  # fits any
            return f"({self.ctype(wanted).strip()}){text if binds == ATOM else f'({text})'}"
        apart = least > 0 and (binds != least or strict) and binds < (ATOM if least == ATOM else SIGN)
        return f"({text})" if apart else text

    def condition(self, node: ast.expr, least: int = 0) -> str:
        """Return a condition, as an operand of an operator that binds as `least`; a number is compared with
        zero (MISRA C 2012, rule 14.4)."""
        if not self.is_number(node):
            return self.operand(node, None, least)
        text = f"{self.operand(node, None, EQUAL)} != 0"
        return f"({text})" if least else text

    def is_number(self, node: ast.expr) -> bool:
        """Return whether a truth value is an int: a member of a record, or an entry."""
        return isinstance(node, ast.Attribute | ast.Subscript)

    def text(self, node: ast.expr) -> str:
        return self.expression(node)[0]

    def expression(self, node: ast.expr) -> tuple[str, int]:
        # Text and binding strength of each expression: the caller decides on parentheses.
        match node:
            case ast.Constant(value=bool() as value):
                return str(value).lower(), ATOM
            case ast.Constant(value=int() as value):
                return str(value), ATOM if value >= 0 else SIGN
            case ast.Constant(value=value):
                text = self.real.literal(getattr(node, "exact", value))  # type: ignore[arg-type]
                return text, SIGN if text.startswith("-") else ATOM
            case ast.Name(id=name):
                return self.name(name)
            case ast.Attribute(value=value, attr=attr):
                return f"{self.text(value)}{'.' if self.is_own(value) else '->'}{attr}", ATOM
            case ast.Subscript(value=value, slice=index):
                return self.entry(value, index)
            case ast.BinOp(left=left, op=op, right=right):
                sign, binds = _OPERATORS[type(op)]
                kind: Type = node.type  # type: ignore[attr-defined]
                if isinstance(op, ast.BitAnd | ast.RShift):  # compilers warn without parentheses
                    return f"{self.operand(left, kind, ATOM)} {sign} {self.operand(right, kind, ATOM)}", binds
                left_, right_ = self.operand(left, kind, binds), self.operand(right, kind, binds, True)
                return f"{left_} {sign} {right_}", binds
            case ast.Compare(left=left, ops=[op], comparators=[right]):
                sign, binds = _OPERATORS[type(op)]
                kinds = (left.type, right.type)  # type: ignore[attr-defined]
                common = next((k for k in (REAL, *reversed(WHOLE)) if k in kinds), None)
                ends = [self.operand(n, common, binds) for n in (left, right)]
                return f" {sign} ".join(ends), binds
            case ast.BoolOp(op=op, values=values):
                sign, binds = ("&&", AND) if isinstance(op, ast.And) else ("||", OR)
                return f" {sign} ".join(self.condition(v, binds) for v in values), binds
            case ast.UnaryOp(op=ast.Not(), operand=operand):
                if self.is_number(operand):
                    return f"{self.text(operand)} == 0", EQUAL
                return f"!{self.operand(operand, None, ATOM)}", SIGN
            case ast.UnaryOp(operand=operand):
                return f"-{self.operand(operand, None, ATOM)}", SIGN
            case ast.IfExp(test=test, body=body, orelse=orelse):
                wanted: Type = node.type  # type: ignore[attr-defined]
                ends = [self.operand(n, wanted, CHOICE) for n in (body, orelse)]
                return f"{self.condition(test, CHOICE)} ? {ends[0]} : {ends[1]}", CHOICE
            case ast.Call(func=ast.Name(id=name), args=args):
                return self.call(name, args)
        raise AssertionError(ast.dump(node))

    def name(self, name: str) -> tuple[str, int]:
        if name in self.now.parameters or name in self.now.locals or name in self.now.counters:
            return name, ATOM
        if name in self.constants:
            return self.constants[name], ATOM
        if name in self.now.known.tables:
            return f"lagc_{name}", ATOM
        return self.real.infinity if name == "inf" else self.size(name), ATOM

    def entry(self, value: ast.expr, index: ast.expr) -> tuple[str, int]:
        # Rows of a caller are one block; a struct of parameters is read as an array of reals.
        kind: Type = value.type  # type: ignore[attr-defined]
        if kind[0] == "Rows":
            row = f"{self.operand(index, None, PRODUCT)} * {self.size(kind[1])}"
            return f"({self.text(value)} + ({row}))", ATOM
        if kind[0] == "Params":  # all members are reals
            pointer = self.passed(value, kind)
            written = self.now.is_written(root(value))
            return f"(({'' if written else 'const '}{self.real.name} *){pointer})[{self.text(index)}]", ATOM
        return f"{self.text(value)}[{self.text(index)}]", ATOM

    def call(self, name: str, args: Sequence[ast.expr]) -> tuple[str, int]:
        if name == "float":
            if isinstance(args[0], ast.Constant):
                return self.real.literal(float(args[0].value)), ATOM  # type: ignore[arg-type]
            return self.operand(args[0], REAL, 0), SIGN
        if name == "whole":
            return f"(long){self.operand(args[0], None, ATOM)}", SIGN
        if name == "size":
            return self.expression(args[0])
        if name == "present":
            return f"{self.text(args[0])} != NULL", EQUAL
        # A name without signature is a function of C's library, in the spelling of the type of reals.
        callee = self.now.known.signatures.get(name)
        if callee is None:
            spelled = self.real.call.format(name)
            return f"{spelled}({', '.join(self.converted(a, REAL) for a in args)})", ATOM
        parts = [self.passed(a, kind) for a, kind in zip(args, callee.parameters)]
        return f"lagc_{name}({', '.join(parts)})", ATOM


def places(body: Sequence[ast.stmt]) -> dict[str, ast.stmt | None]:
    """Return for each local the first assignment, if it can declare the local: it is in the innermost
    block that holds all uses. None: it is declared at the top, as its value may outlive an iteration."""
    uses: dict[str, list[tuple[Sequence[ast.stmt], ...]]] = {}  # name -> blocks around each use, outer first
    first: dict[str, ast.stmt | None] = {}

    def note(name: str, path: tuple[Sequence[ast.stmt], ...], node: ast.stmt | None) -> None:
        first.setdefault(name, node)
        uses.setdefault(name, []).append(path)

    def names(node: ast.AST) -> list[str]:
        return [n.id for n in ast.walk(node) if isinstance(n, ast.Name)]

    def walk(block: Sequence[ast.stmt], path: tuple[Sequence[ast.stmt], ...]) -> None:
        path = (*path, block)
        for node in block:
            if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
                for name in names(node.value):
                    note(name, path, None)
                note(node.targets[0].id, path, node)
                continue
            for child in ast.iter_child_nodes(node):
                if not isinstance(child, ast.stmt):
                    for name in names(child):
                        note(name, path, None)
            walk_inner(node, path)

    def walk_inner(node: ast.stmt, path: tuple[Sequence[ast.stmt], ...]) -> None:
        for inner in (getattr(node, "body", None), getattr(node, "orelse", None)):
            if inner:
                walk(inner, path)

    # A use is known by the blocks around it, outermost first.
    walk(body, ())
    # The innermost block around all uses is their common beginning. The first assignment may declare the
    # local if it stands directly in that block.
    found: dict[str, ast.stmt | None] = {}
    for name, paths in uses.items():
        shared = paths[0]
        for path in paths[1:]:
            common = [a for a, b in zip(shared, path) if a is b]
            shared = tuple(common)
        block, start = shared[-1], first[name]
        found[name] = start if any(start is node for node in block) else None
    return found


# -- layout: comments, long lines, names of structs --

WIDTH = 98  # of a line
COPIES = {"copy": "lagc_real", "copy_numbers": "int"}  # of vectors: function, type of an entry
_BREAKS = (" + ", " - ", " || ", " && ", " : ", " = ")


def block_comment(text: str) -> str:
    if not text:
        return ""
    lines = text.splitlines()
    return "/* " + "\n".join([lines[0], *((" * " + line.strip()).rstrip() for line in lines[1:])]) + " */\n"


def copies(text: str) -> list[str]:
    """Return the definitions of the COPIES that a text calls."""
    return [
        f"static void lagc_{name}({kind} *to, const {kind} *from, int n)\n{{\n"
        "    (void)memmove(to, from, (size_t)n * sizeof *to);\n}\n"
        for name, kind in COPIES.items()
        if f"lagc_{name}(" in text
    ]


def first_sentence(text: str) -> str:
    """Return the first sentence of a description, on one line."""
    return re.split(r"(?<=[^A-Z][.:])\s+(?=[A-Z`])", " ".join(text.split()), maxsplit=1)[0]


def ignored(names: Iterable[str]) -> str:
    """Return statements that say that parameters are not used, on one line."""
    return " ".join(f"(void){name};" for name in names)


def folded(line: str) -> str:
    """Break a long line before an operator or after a comma. Its indentation will be half of what it is."""
    lead = len(line) - len(line.lstrip())
    indent, width = " " * (lead + 8), WIDTH + lead // 2
    rows = []
    while len(line) > width:
        cuts = [line.rfind(sign, len(indent) + 12, width) for sign in _BREAKS]
        cut = max(*cuts, line.rfind(", ", len(indent) + 12, width) + 1)
        if cut < 1:
            break
        rows.append(line[:cut])
        line = indent + line[cut + 1 :]
    return "\n".join([*rows, line])


def snake(name: str) -> str:
    """Return the name of a record in C: start_work for StartWork."""
    return "".join(f"_{c.lower()}" if c.isupper() else c for c in name).lstrip("_")
