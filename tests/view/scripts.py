"""Evaluates a generated SymPy script on numbers: a stand-in module `sympy` whose symbols are floats."""

from __future__ import annotations

import math
from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any

from lagc.expr.evaluate import evaluate
from lagc.expr.graph import Node
from lagc.mechanics.equations import EquationsOfMotion

FUNCTIONS = (
    "sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "exp", "log", "sqrt",
    "floor", "atan2",
)  # fmt: skip


class Value(float):
    """A function of time: its value, and those of its derivatives."""

    derivatives: tuple[float, ...]

    def diff(self, t: float, order: int = 1) -> float:
        return self.derivatives[order - 1]


def moving(value: float, *derivatives: float) -> Value:
    found = Value(value)
    found.derivatives = derivatives
    return found


def script_residuals(text: str, values: Mapping[str, float | Value], time: float) -> list[float]:
    """left - right of each equation of the script, in order, for values of its names."""

    def symbol(name: str, **_: Any) -> float:
        return time if name == "t" else values[name]

    def function(name: str, **_: Any) -> Any:
        return lambda t: values[name]

    stand_in = SimpleNamespace(
        Symbol=symbol, Function=function, Rational=lambda a, b: a / b, Float=float, pi=math.pi,
        Eq=lambda a, b: a - b, Lt=lambda a, b: a < b, Le=lambda a, b: a <= b,
        Abs=abs, Min=min, Max=max, sign=lambda x: (x > 0) - (x < 0),
        And=lambda a, b: a and b, Or=lambda a, b: a or b, Piecewise=lambda a, b: a[0] if a[1] else b[0],
        **{name: getattr(math, name) for name in FUNCTIONS},
    )  # fmt: skip
    space: dict[str, Any] = {"sympy": stand_in, "__name__": "script"}
    exec(text.replace("import sympy\n", ""), space)
    residuals: list[float] = space["equations"]
    return residuals


def values_at(equations: EquationsOfMotion, state: Mapping[Node, float]) -> dict[str, float | Value]:
    """What the names of a script stand for at a state that holds q, v, a, lam and parameters."""
    model = equations.model
    found: dict[str, float | Value] = {p.name: state[p.symbol] for p in model.parameters}
    found |= {i.name: state[i.symbol] for i in model.inputs}
    qdot = dict(zip(equations.q_names, evaluate(equations.qdot, state)))
    acceleration = {n: state[a] for n, a in zip(equations.v_names, equations.a)}
    for name, q in zip(equations.q_names, equations.q):
        found[name] = moving(state[q], qdot[name], acceleration.get(f"der({name})", math.nan))
    for name, v in zip(equations.v_names, equations.v):
        if not name.startswith("der("):
            found[name] = moving(state[v], acceleration[name])
    for row, lam in zip(equations.rows, equations.lam):
        found[f"lambda_{row.label}"] = state[lam]
    return found
