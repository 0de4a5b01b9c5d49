"""Small Programs built by hand, and random ones over all operations."""

import random
from typing import Any

from lagc.lowering.program import Function, Operation, Program, Store, operands
from lagc.symbolic.leaves import Table
from lagc.symbolic.operators import LOOKED_UP
from tests.interfaces import field, interface


class Builder:
    """Writes one function operation by operation."""

    def __init__(self, name: str, inputs: tuple[str, ...], outputs: tuple[tuple[str, int], ...]) -> None:
        self.name, self.inputs, self.outputs = name, inputs, outputs
        self.operations: list[Operation] = []
        self.stores: list[Store] = []
        self.comments: dict[int, str] = {}

    def const(self, value: float) -> int:
        return self._add(Operation("const", (), value))

    def load(self, array: str, index: int = 0) -> int:
        return self._add(Operation("load", (), (array, index)))

    def op(self, op: str, *operands: int) -> int:
        return self._add(Operation(op, operands))

    def look_up(self, op: str, table: Table, value: int) -> int:
        return self._add(Operation(op, (value,), table))

    def store(self, array: str, index: int, value: int) -> None:
        self.stores.append(Store(array, index, value))

    def note(self, text: str) -> None:
        self.comments[len(self.operations)] = text

    def _add(self, operation: Operation) -> int:
        self.operations.append(operation)
        return len(self.operations) - 1

    def function(self, description: str = "") -> Function:
        stores = tuple(self.stores)
        return Function(self.name, self.inputs, self.outputs, tuple(self.operations), stores, description,
                        self.comments)  # fmt: skip


def program(model: str, functions: list[Function], **changes: Any) -> Program:
    """With one angle and the parameters m, l, g, unless `changes` say otherwise."""
    plain: dict[str, Any] = {
        "q_names": ("theta",), "v_names": ("der(theta)",), "q_units": ("rad",), "v_units": ("rad/s",),
        "parameters": (field("m"), field("l"), field("g", 9.81)), "massless": (), "start_levels": (4, 4),
        "operations": next((f.cost for f in functions if f.name == "rhs"), 0),
        "functions": tuple(f.name for f in functions),
    }  # fmt: skip
    return Program(interface(model, **{**plain, **changes}), {f.name: f for f in functions})


def pendulum(model: str = "Pendulum", **changes: Any) -> Program:
    """theta'' = -g/l sin(theta), with energies; mass matrix m l^2."""
    rhs = Builder("rhs", ("p", "t", "x"), (("xdot", 2), ("lam", 0), ("health", 2)))
    theta, omega = rhs.load("x", 0), rhs.load("x", 1)
    g, length = rhs.load("p", 2), rhs.load("p", 1)
    rhs.note("m l^2 a = -m g l sin(theta)   pendulum.lag:7")
    force = rhs.op("neg", rhs.op("mul", rhs.op("div", g, length), rhs.op("sin", theta)))
    one, zero = rhs.const(1.0), rhs.const(0.0)
    for index, value in enumerate((omega, force)):
        rhs.store("xdot", index, value)
    rhs.store("health", 0, one)
    rhs.store("health", 1, zero)

    system = Builder("system", ("p", "t", "x"), (("qdot", 1), ("M", 1), ("r", 1), ("G", 0), ("gamma", 0)))
    theta, omega = system.load("x", 0), system.load("x", 1)
    m, length, g = (system.load("p", k) for k in range(3))
    ml = system.op("mul", m, length)
    system.store("qdot", 0, omega)
    system.store("M", 0, system.op("mul", ml, length))
    system.store("r", 0, system.op("neg", system.op("mul", system.op("mul", ml, g), system.op("sin", theta))))

    energies = Builder("energies", ("p", "t", "x"), (("e", 3),))
    theta, omega = energies.load("x", 0), energies.load("x", 1)
    m, length, g = (energies.load("p", k) for k in range(3))
    speed = energies.op("mul", length, omega)
    kinetic = energies.op("mul", energies.op("mul", energies.const(0.5), m), energies.op("mul", speed, speed))
    weight = energies.op("mul", energies.op("mul", m, g), length)
    potential = energies.op("neg", energies.op("mul", weight, energies.op("cos", theta)))
    for index, value in enumerate((kinetic, potential, energies.op("add", kinetic, potential))):
        energies.store("e", index, value)

    start = Builder("start", ("p",), (("x", 2),))
    start.store("x", 0, start.const(2.0))
    start.store("x", 1, start.const(0.0))
    return program(
        model, [rhs.function("xdot"), system.function(), energies.function(), start.function()], **changes
    )


TABLES = [
    (Table([-0.5, -0.5, 0.0, 1.25e-3, 0.7]), Table([0.1, -0.25, 0.0, 1e-300, 0.9])),
    (Table([0.0, 1.0]), Table([-1.0, 0.3])),
]  # of pieces, and a number for each
TRUTHS = ("lt", "le", "eq", "and", "or", "not")


def random_function(seed: int, size: int = 120, states: int = 4, name: str = "outputs") -> Function:
    """`size` operations on random earlier values; several outputs.  No function is taken of
    constants alone: the graph has none, and C compilers would round it in their own way."""
    rng = random.Random(seed)
    build = Builder(name, ("p", "t", "x"), (("y", 8),))
    numbers = [build.load("x", k) for k in range(states)] + [build.load("p", 0), build.load("t")]
    numbers += [build.const(v) for v in (0.0, -0.0, 1.0, -2.5, 1e-300, 0.1)]
    truths: list[int] = []
    fixed = set(numbers[-6:])
    count = operands()
    ops = [o for o in count if o not in ("const", "load")]
    while len(build.operations) < size:
        op = rng.choice(ops)
        if op in ("and", "or", "not", "select") and not truths:
            continue
        if op == "select":
            numbers.append(build.op(op, rng.choice(truths), rng.choice(numbers), rng.choice(numbers)))
        elif op in ("and", "or", "not"):
            truths.append(build.op(op, *(rng.choice(truths) for _ in range(count[op]))))
        else:
            chosen = [rng.choice(numbers[-12:]) for _ in range(count[op])]
            if fixed.issuperset(chosen):
                continue
            if op in LOOKED_UP:
                knots, row = rng.choice(TABLES)
                value = build.look_up("piece", knots, *chosen)
                value = value if op == "piece" else build.look_up("entry", row, value)
            else:
                value = build.op(op, *chosen)
            (truths if op in TRUTHS else numbers).append(value)
        if rng.random() < 0.1:
            build.note(f"block {len(build.operations)} of /* a \\ ??/ */ comment")
    for index in range(8):
        build.store("y", index, numbers[-1 - index * 3])
    return build.function("random")


def repeated_function(seed: int, name: str, states: int = 60, outputs: int = 64) -> Function:
    """Kernels of a few operations, each again and again on other operands: entries of x and numbers side by
    side, from end to beginning and in no order, values of the repetition before and of others before; and
    between them operations that come once.  All values stay between -1 and 1."""
    rng = random.Random(seed)
    build = Builder(name, ("p", "t", "x"), (("y", outputs),))
    x = [build.load("x", k) for k in range(states)]
    fixed = [build.load("p", 0), build.load("t"), build.const(-0.5)]
    half = build.const(0.5)
    many = [build.const(rng.uniform(-1.0, 1.0)) for _ in range(30)]
    rows: list[list[int]] = [x, many]
    for _ in range(rng.randint(2, 5)):
        times = rng.randint(3, 30)
        sources = [_source(rng, rows, fixed, times) for _ in range(rng.randint(1, 4))]
        kernel = [(rng.randrange(9), rng.random(), rng.random()) for _ in range(rng.randint(2, 9))]
        carried = rng.choice(x)
        made: list[list[int]] = [[] for _ in kernel]
        for n in range(times):
            known = [carried, *(source[n] for source in sources)]
            for k, (kind, one, other) in enumerate(kernel):
                a, b = known[int(one * len(known))], known[int(other * len(known))]
                value = _step(build, kind, a, b, half)
                known.append(value)
                made[k].append(value)
            carried = known[-1]
        rows += [row for row in made if rng.random() < 0.6]
        for _ in range(rng.randrange(3)):
            a, b = (rng.choice(rng.choice(rows)) for _ in range(2))
            rows.append([_step(build, rng.randrange(9), a, b, half)])
    known = rng.choice(rows[2:])
    for index in range(outputs):
        build.store("y", index, known[index] if index < len(known) else rng.choice(rng.choice(rows)))
    return build.function("repeated")


def _source(rng: random.Random, rows: list[list[int]], fixed: list[int], times: int) -> list[int]:
    """What an operand is in each of `times` repetitions."""
    row = rng.choice(rows)
    kind = rng.randrange(5)
    if kind == 0:
        return [rng.choice(fixed)] * times
    if kind == 1 or len(row) < times:
        return [rng.choice(row) for _ in range(times)]
    first = rng.randrange(len(row) - times + 1)
    found = row[first : first + times]
    return found[::-1] if kind == 2 else found


def _step(build: Builder, kind: int, a: int, b: int, half: int) -> int:
    if kind < 2:
        return build.op("mul", build.op(("add", "sub")[kind], a, b), half)
    if kind == 2:
        return build.op("mul", a, b)
    if kind == 3:
        return build.op("neg", a)
    if kind == 4:
        return build.op("select", build.op("lt", a, b), a, build.op("abs", b))
    if kind > 6:
        knots, row = TABLES[kind - 7]
        return build.look_up("entry", row, build.look_up("piece", knots, a))
    return build.op(("min", "max")[kind - 5], a, b)
