"""Evaluates a generated SymPy script on numbers: a stand-in module `sympy` whose symbols are floats."""

import math
import re
from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any

from lagc.mechanics.formulation.equations import EquationsOfMotion
from lagc.reports.names import forces_of_contacts, names
from lagc.symbolic.graph import Node
from lagc.symbolic.walk import evaluate

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
    at = {"t": time, "time": time} | values

    def symbol(name: str, **_: Any) -> float:
        return at[name]

    def function(name: str, **_: Any) -> Any:
        return lambda t: values[name]

    stand_in = SimpleNamespace(
        Symbol=symbol, Function=function, Rational=lambda a, b: a / b, Float=float, pi=math.pi,
        Eq=equal, Lt=lambda a, b: a < b, Le=lambda a, b: a <= b,
        Ge=lambda a, b: a >= b, Ne=lambda a, b: a != b,
        Abs=abs, Min=min, Max=max, sign=lambda x: (x > 0) - (x < 0),
        And=lambda *parts: all(parts), Or=lambda a, b: a or b, Piecewise=lambda a, b: a[0] if a[1] else b[0],
        **{name: getattr(math, name) for name in FUNCTIONS},
    )  # fmt: skip
    space: dict[str, Any] = {"sympy": stand_in, "__name__": "script"}
    exec(text.replace("import sympy\n", ""), space)
    residuals: list[float] = space["equations"]
    return residuals


def equal(a: Any, b: Any) -> Any:
    """Return left - right of an equation, which is a condition too."""
    return Equal(a - b) if isinstance(a - b, float) else a - b


class Equal(float):
    """left - right, which holds if it is 0."""

    def __bool__(self) -> bool:
        return float(self) == 0.0


def values_at(equations: EquationsOfMotion, state: Mapping[Node, float]) -> dict[str, float | Value]:
    """What the names of a script stand for at a state that holds q, v, a, lam and parameters."""
    model = equations.model
    found: dict[Node, float | Value] = {p.symbol: state[p.symbol] for p in model.parameters}
    found |= {symbol: state[symbol] for symbol in model.undetermined}
    acceleration = {name: state[a] for name, a in zip(equations.v_names, equations.a)}
    for name, q, rate in zip(equations.q_names, equations.q, evaluate(equations.qdot, state)):
        found[q] = moving(state[q], rate, acceleration.get(f"der({name})", math.nan))
    for name, v in zip(equations.v_names, equations.v):
        if not name.startswith("der("):
            found[v] = moving(state[v], acceleration[name])
    found |= {lam: state[lam] for lam in equations.lam}
    for symbol, _, _ in forces_of_contacts(equations):  # none acts; a slip has a direction
        found[symbol] = state.get(symbol, float(symbol.record.kind == "slip"))
    shown = names(equations)
    assert len({shown[node].base for node in found}) == len(found)
    return {shown[node].base: value for node, value in found.items()}


def states_of(space: Mapping[str, Any], equations: EquationsOfMotion, state: Mapping[Node, float]) -> Any:
    """Numbers of `state` for what a script that SymPy has read is made of: rates, functions, symbols."""
    import sympy

    made = [x for value in space.values() for x in (value.values() if isinstance(value, dict) else [value])]
    values = {"t": state[equations.time]} | values_at(equations, state)
    found: dict[Any, float] = {}
    for each in made:
        if isinstance(each, sympy.Function) and each.args == (space["t"],):
            value = values[each.func.__name__]
            found[each] = float(value)
            if isinstance(value, Value):
                found |= {each.diff(space["t"], k): x for k, x in enumerate(value.derivatives, 1)}
        elif isinstance(each, sympy.Symbol):
            found[each] = float(values[each.name])
    return found


class Part(float):
    """A shared part whose value is not known yet."""

    name: str


def ruled_residuals(text: str, values: Mapping[str, float | Value], time: float) -> dict[str, float]:
    """left - right of each equation of a script by rules, by what it is about: parts are computed from those
    that are known, again and again."""
    known: dict[str, float | Value] = dict(values)
    at = {"t": time, "time": time} | known

    def function(name: str, **_: Any) -> Any:
        if name in known:
            return lambda t: known[name]
        part = Part("nan")
        part.name = name
        return lambda t: part

    stand_in = SimpleNamespace(
        Symbol=lambda name, **_: at[name], Function=function,
        Rational=lambda a, b: a / b, Float=float, pi=math.pi, Eq=lambda a, b: (a, b),
        **{name: getattr(math, name) for name in FUNCTIONS},
    )  # fmt: skip
    while True:
        space: dict[str, Any] = {"sympy": stand_in, "__name__": "script"}
        exec(text.replace("import sympy\n", ""), space)
        found = {a.name: b for a, b in space.get("parts", ()) if isinstance(a, Part) and b == b}
        if not found:
            break
        known |= found
    return _labelled(text, space["equations"])


def _labelled(text: str, pairs: list[tuple[float, float]]) -> dict[str, float]:
    """By the comments behind the lines, in which counters stand."""
    body = text.partition("equations = [\n")[2].partition("\n]\n")[0]
    labels: list[str] = []
    for line in body.splitlines():
        equation, _, label = line.rpartition(",  # ")
        counters = re.findall(r" for (\w+) in (range\([^()]*\))", _after_equation(equation))
        inner = "".join(f" for {name} in {span}" for name, span in counters)
        written = repr(re.sub(r"(?<=[\[,])[^\[\],]+(?=[,\]])", lambda m: f"{{{m[0]}}}", label))
        labels += eval(f"[f{written}{inner}]") if counters else [label]
    return {label: left - right for label, (left, right) in zip(labels, pairs, strict=True)}


def _after_equation(text: str) -> str:
    """What stands behind `sympy.Eq(...)` in a list."""
    depth, start = 0, text.index("sympy.Eq(") + len("sympy.Eq")
    for k in range(start, len(text)):
        depth += {"(": 1, ")": -1}.get(text[k], 0)
        if depth == 0:
            return text[k + 1 :]
    return ""
