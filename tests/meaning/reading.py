"""Models read for the tests of this room."""

from __future__ import annotations

from typing import Any

from lagc.diagnostics.faults import Source
from lagc.expr.evaluate import evaluate
from lagc.expr.graph import Node
from lagc.frontend.parse import parse
from lagc.meaning.model import Model
from lagc.meaning.resolve import resolve

HEAD = "model M parameter Mass m = 2; coordinate Length x; body b = Particle(mass = m, at = {x, 0, 0});\n"


def read(text: str, **choice: Any) -> Model:
    return resolve(parse(Source("model.lag", text)), **choice)


def read_body(lines: str, **choice: Any) -> Model:
    """A model with a coordinate x, a mass m = 2 and a body b, and these lines."""
    return read(f"{HEAD}{lines}\nend M;", **choice)


def value(model: Model, node: Node, **motion: float) -> float:
    """`node` at the parameters' values and the given motion (`x`, `o.w`, `der_x`, `time`)."""
    table: dict[Node, float] = {p.symbol: p.value for p in model.parameters if p.value is not None}
    graph = model.graph
    for name, number in motion.items():
        if name == "time":
            table[model.time] = number
        elif name.startswith("der_"):
            table[graph.symbol("rate", name[4:], order=1)] = number
        else:
            owner, _, component = name.partition(".")
            table[graph.symbol("coordinate", owner, component)] = number
    return evaluate([node], table)[0]


def output(model: Model, name: str, **motion: float) -> float:
    return value(model, next(o.expression for o in model.outputs if o.name == name), **motion)
