"""Models read for the tests of this room."""

from typing import Any

from lagc.diagnostics.faults import Source
from lagc.semantics.model import Model
from lagc.semantics.resolve import resolve
from lagc.symbolic.graph import Node
from lagc.symbolic.leaves import derived
from lagc.symbolic.walk import evaluate
from lagc.syntax.parse import parse

HEAD = "model M parameter Mass m = 2; coordinate Length x; body b = Particle(mass = m, at = {x, 0, 0});\n"


def read(text: str, **choice: Any) -> Model:
    return resolve(parse(Source("model.lag", text)), **choice)


def read_body(lines: str, **choice: Any) -> Model:
    """A model with a coordinate x, a mass m = 2 and a body b, and these lines."""
    return read(f"{HEAD}{lines}\nend M;", **choice)


def value(model: Model, node: Node, **motion: float) -> float:
    """`node` at the parameters' values and the given motion (`x`, `o.w`, `der_x`, `time`)."""
    table: dict[Node, float] = {p.symbol: p.value for p in model.parameters if p.value is not None}
    leaves = (x for x in model.graph.nodes if x.op == "symbol" and x.record.kind in ("coordinate", "rate"))
    named = {leaf.record.name: leaf for leaf in leaves}
    for name, number in motion.items():
        if name == "time":
            table[model.time] = number
        elif name.startswith("der_"):
            table[named[derived(name[4:])]] = number
        else:
            table[named[name]] = number
    return evaluate([node], table)[0]


def output(model: Model, name: str, **motion: float) -> float:
    return value(model, next(o.expression for o in model.outputs if o.name == name), **motion)
