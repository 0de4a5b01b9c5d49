"""Print functions of a Program as lines of text, for languages with C's expressions.

A value that is used once is written where it is used, as long as lines stay short; other values get names.
Neither changes an operation or its operands, and every operand that would bind differently has
parentheses, so that no operation is re-associated.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

from lagc.base.records import dataclass
from lagc.lowering.program import Function, Operation, uses
from lagc.symbolic.leaves import Table
from lagc.symbolic.operators import COMPARISONS, INFIX, LOOKED_UP, TRUTHS

SIMPLE = ("load", "const", "add", "sub", "mul", "neg")  # operations that may be computed ahead for an angle
MOST_AHEAD = 16  # of them

# Precedence of expressions, the same in C and in Python.
OR, AND, COMPARISON, SUM, PRODUCT, SIGN, ATOM = range(1, 8)

_INFIX = {
    "add": (" + ", SUM),
    "sub": (" - ", SUM),
    "mul": (" * ", PRODUCT),
    "div": (" / ", PRODUCT),
    **{op: (f" {word} ", COMPARISON) for op, word in INFIX.items() if op in COMPARISONS},
}


def literal(value: float) -> str:
    """Return a finite number as text that gives the same bits when it is read."""
    return repr(float(value))


@dataclass(frozen=True)
class Dialect:
    """The differences between target languages.

    `calls`: operation -> name of a function. `infix`: further operators with their binding; operators in
    `called` are printed as calls. `select`: template of condition, then, else. `number`, `truth`:
    declarations of a temporary; `store`: an assignment to an output; `load`: an entry of an input array;
    `entry`: the same at an index expression; `look_up`: an operation on a table. `turn`: a statement that
    computes sine and cosine of a value, with `sine` and `cosine` to read them; without it they are `calls`.
    `turn_two`: the same of two values."""

    calls: Mapping[str, str]
    infix: Mapping[str, tuple[str, int]]
    select: str
    number: str
    truth: str
    store: Callable[[str, int | str, str], str]
    comment: Callable[[str], str]
    load: Callable[[str, int], str]
    entry: Callable[[str, str], str]
    look_up: Callable[[str, Table, str], str]
    literal: Callable[[float], str] = literal
    called: tuple[str, ...] = ()
    explicit: bool = False  # an operand has parentheses unless it binds as its operator
    width: int = 88
    turn: str = ""
    turn_two: str = ""
    sine: str = ""
    cosine: str = ""


def lines(function: Function, dialect: Dialect, locals_: Mapping[tuple[str, int], str]) -> list[str]:
    """Return the body of `function`, without indentation. A comment is stored under the index of its
    operation, or under the number of operations plus the index of its store. `locals_`: names of entries
    of input arrays, for entries that are read more than once."""
    return _Body(function, dialect, locals_).run()


def loads(function: Function, used: list[int] | None = None) -> list[tuple[str, int]]:
    """Return the entries of input arrays, (array, index), that `function` reads."""
    used = used or uses(function)
    found = [o.payload for o, n in zip(function.operations, used) if n and o.op == "load"]
    return [payload for payload in found if isinstance(payload, tuple)]


class _Body:
    def __init__(self, function: Function, dialect: Dialect, locals_: Mapping[tuple[str, int], str]) -> None:
        self.function = function
        self.dialect = dialect
        self.locals = locals_
        infix = {**_INFIX, **dialect.infix}
        self.infix = {op: how for op, how in infix.items() if op not in dialect.called}
        self.uses = uses(function)
        self.text: list[str] = [""] * len(function.operations)
        self.binds: list[int] = [ATOM] * len(function.operations)
        self.out: list[str] = []
        self.temporaries = 0
        self.turns: dict[int, tuple[int, int]] = {}  # angle -> number of its call, index of its sine
        self.angles = self._angles()
        self.pending: list[str] = []
        self.declared: set[str] = set()
        written = {(store.array, store.index) for store in function.stores}
        loaded = set(loads(function, self.uses))
        self.overwritten = written & loaded  # entries of arrays that are both read and written
        self.stores: dict[int, list[int]] = {}
        for position, store in enumerate(function.stores):
            self.stores.setdefault(store.value, []).append(position)

    def run(self) -> list[str]:
        function = self.function
        for k in range(len(function.operations)):
            if k in function.comments:
                self.pending.append(function.comments[k])
            if self.uses[k] and not self.text[k]:
                self._value(k)
        if self.overwritten:  # compute everything before the first store
            for store in function.stores:
                if function.operations[store.value].op != "const":
                    self._name(store.value)
            for position in range(len(function.stores)):
                self._store(position)
        return self.out

    def _value(self, k: int) -> None:
        operation = self.function.operations[k]
        if operation.op == "const":
            assert isinstance(operation.payload, float | int)
            self.text[k] = self.dialect.literal(operation.payload)
            if self.text[k].startswith("-"):
                self.binds[k] = SIGN
        elif operation.op == "load":
            self._load(k)
        else:
            if operation.op in ("sin", "cos") and self.dialect.turn:
                self._turn(k)
            else:
                self._expression(k)
            if self.uses[k] > 1 and not (self.uses[k] == len(self.stores.get(k, ())) == 1):
                self._name(k)
        if not self.overwritten:
            for position in self.stores.get(k, ()):
                self._store(position)

    def _store(self, position: int) -> None:
        comment = self.function.comments.get(len(self.function.operations) + position)
        if comment is not None:
            self.pending.append(comment)
        store = self.function.stores[position]
        value = self.text[store.value]
        self._statement(self.dialect.store(store.array, store.index, value))

    def _load(self, k: int) -> None:
        payload = self.function.operations[k].payload
        assert isinstance(payload, tuple)
        self.text[k] = self.dialect.load(*payload)
        if payload in self.overwritten:
            self._name(k)
        elif self.uses[k] > 1 and payload in self.locals:
            name = self.locals[payload]
            if name not in self.declared:
                self.declared.add(name)
                self._statement(self.dialect.number.format(name=name, value=self.text[k]))
            self.text[k] = name

    def _expression(self, k: int) -> None:
        """Write value k in terms of its operands; while the line is too long, name the longest operand."""
        operation = self.function.operations[k]
        while True:
            text, binds = self._compose(operation)
            if len(text) <= self.dialect.width:
                break
            longest = max(operation.operands, key=lambda i: len(self.text[i]))
            if self.function.operations[longest].op in ("const", "load") or self.text[longest].isidentifier():
                break
            self._name(longest)
        self.text[k], self.binds[k] = text, binds

    def _angles(self) -> list[int]:
        """Return the angles of sines and cosines, the last one first."""
        operations = self.function.operations
        turned = [o.operands[0] for o, n in zip(operations, self.uses) if n and o.op in ("sin", "cos")]
        return list(dict.fromkeys(turned))[::-1]

    def _turn(self, k: int) -> None:
        """Write one call for sine and cosine of an angle, or of this and the next angle."""
        angle = self.function.operations[k].operands[0]
        if angle not in self.turns:
            number = len({number for number, _ in self.turns.values()})
            self.turns[angle] = number, 0
            other = self._next_angle() if self.dialect.turn_two else None
            if other is None:
                self._statement(self.dialect.turn.format(number=number, value=self.text[angle]))
            else:
                self.turns[other] = number, 2
                words = {"number": number, "value": self.text[angle], "other": self.text[other]}
                self._statement(self.dialect.turn_two.format(**words))
        number, place = self.turns[angle]
        form = self.dialect.sine if self.function.operations[k].op == "sin" else self.dialect.cosine
        self.text[k] = form.format(number=number, sine=place, cosine=place + 1)

    def _next_angle(self) -> int | None:
        """Compute the next angle that has no call, if it consists of few sums and products; else return
        None."""
        while self.angles and self.angles[-1] in self.turns:
            self.angles.pop()
        if not self.angles:
            return None
        ahead, asked = set[int](), [self.angles[-1]]
        while asked:
            k = asked.pop()
            operation = self.function.operations[k]
            if not self.text[k] and k not in ahead:
                if operation.op not in SIMPLE or len(ahead) == MOST_AHEAD:
                    return None
                ahead.add(k)
                asked += operation.operands
        for k in sorted(ahead):
            self._value(k)
        return self.angles[-1]

    def _compose(self, operation: Operation) -> tuple[str, int]:
        text, op, operands = self.text, operation.op, operation.operands
        if op in LOOKED_UP:
            assert isinstance(operation.payload, Table)
            return self.dialect.look_up(op, operation.payload, text[operands[0]]), ATOM
        if op in self.infix:
            symbol, binds = self.infix[op]
            strict = binds in (OR, AND, COMPARISON)
            least = SIGN if self.dialect.explicit else SUM if strict else binds + 1
            left = self._bound(operands[0], least)
            right = self._bound(operands[1], least, right=True)
            if not strict and self.binds[operands[0]] == binds:
                left = text[operands[0]]
            return left + symbol + right, binds
        if op == "neg":
            return "-" + self._bound(operands[0], ATOM), SIGN
        if op == "select":
            least = SIGN if self.dialect.explicit else 0
            return self.dialect.select.format(*(self._bound(k, least) for k in operands)), ATOM
        arguments = ", ".join(text[k] for k in operands)
        return f"{self.dialect.calls[op]}({arguments})", ATOM

    def _bound(self, k: int, least: int, right: bool = False) -> str:
        binds = self.binds[k]
        if binds < least or (right and binds == SIGN):
            return f"({self.text[k]})"
        return self.text[k]

    def _name(self, k: int) -> None:
        if self.text[k].isidentifier():
            return
        truth = self.function.operations[k].op in TRUTHS
        name = f"{'c' if truth else 't'}{self.temporaries}"
        self.temporaries += 1
        form = self.dialect.truth if truth else self.dialect.number
        self._statement(form.format(name=name, value=self.text[k]))
        self.text[k], self.binds[k] = name, ATOM

    def _statement(self, line: str) -> None:
        for comment in self.pending:
            self.out.append(self.dialect.comment(comment))
        self.pending.clear()
        self.out.append(line)
