"""Values of the symbols of a model, at the states of a run and at random configurations, and of expressions
over them."""

import math
import random
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from lagc.semantics.model import Coordinate, Model
from lagc.simulation.solution import Solution
from lagc.simulation.system import FAILED
from lagc.symbolic.graph import Node
from lagc.symbolic.operators import VALUES
from lagc.symbolic.walk import reachable

Array: TypeAlias = NDArray[np.float64]
Given: TypeAlias = Mapping[Node, Any]

_NAMES = {
    "asin": "arcsin", "acos": "arccos", "atan": "arctan", "atan2": "arctan2", "pow": "power",
    "min": "minimum", "max": "maximum", "lt": "less", "le": "less_equal", "eq": "equal", "and": "logical_and",
    "or": "logical_or", "not": "logical_not", "select": "where",
    **{name: name for name in ("sin", "cos", "tan", "sinh", "cosh", "tanh", "exp", "log", "sqrt", "abs",
                               "floor", "sign")},
}  # fmt: skip
_FUNCTIONS = {ours: getattr(np, theirs) for ours, theirs in _NAMES.items()}


def values(nodes: Sequence[Node], given: Given, size: int) -> Array:
    """Return the values of `nodes`, (len(nodes), size), at `size` states.

    `given` has arrays or numbers for symbols, and for any other node that is not to be computed: so a
    derivative by a subexpression is taken.  A symbol without a value is NaN."""
    known: dict[Node, Any] = {}
    with np.errstate(all="ignore"):
        for node in reachable(nodes):
            known[node] = given[node] if node in given else _value(node, known)
    rows = [np.broadcast_to(np.asarray(known[node], float), size) for node in nodes]
    return np.array(rows, float).reshape(len(nodes), size)


def _value(node: Node, known: Mapping[Node, Any]) -> Any:
    op = node.op
    if op == "const":
        return float(node.value)
    if op == "symbol":
        return np.nan  # an acceleration, a multiplier
    x = [known[a] for a in node.args]
    if op == "add":
        return x[0] + x[1]
    if op == "scale":
        return node.value * x[0]
    if op == "mul":
        product: Any = 1.0
        for base, exponent in zip(x, node.value):
            product = product * np.asarray(base, float) ** float(exponent)
        return product
    if op in _FUNCTIONS:
        return _FUNCTIONS[op](*x)
    extra = () if node.value is None else (node.value,)  # tables
    rows = np.broadcast_arrays(*x)
    return np.array([VALUES[op](*extra, *row) for row in zip(*(np.atleast_1d(r) for r in rows))], float)


SAMPLES = 24  # random configurations
AROUND = 0.2  # of the range of a coordinate: how far from it a random one may be
LEAST_RANGE = 0.3  # of the largest value of a coordinate
REST_RANGE = 0.1  # m, of a coordinate that is zero in the whole run


def constants(model: Model, run: Solution) -> dict[Node, Any]:
    """Return the values of parameters and inputs of the run by their symbols."""
    interface = run.system.interface
    numbers = dict(zip([f.name for f in (*interface.parameters, *interface.inputs)], run.parameters))
    found: dict[Node, Any] = {p.symbol: numbers.get(p.name, p.value) for p in model.parameters}
    found |= {i.symbol: numbers.get(i.name, i.default) for i in model.inputs}
    return {symbol: math.nan if value is None else value for symbol, value in found.items()}


def rates_of(run: Solution, times: Array, states: Array) -> Array:
    """Return dx/dt at states, (len(times), nx); zero where the right-hand side has no value."""
    system = run.system
    rates, lam = np.zeros(states.shape), [0.0] * system.nc
    for k, (t, row) in enumerate(zip(times.tolist(), states.tolist())):
        out = [0.0] * system.nx
        if system.rhs(t, row, out, lam) not in FAILED:
            rates[k] = out
    return rates


def of_states(model: Model, run: Solution, times: Array, x: Array, rates: Array) -> dict[Node, Any]:
    """Return the values of all symbols at states x, (n, nx), with the rates dx/dt: arrays of length n."""
    interface = run.system.interface
    given = constants(model, run) | {model.time: np.asarray(times, float)}
    columns = {name: x[:, i] for i, name in enumerate(interface.state_names)}
    i = 0
    for c in model.coordinates:
        if isinstance(c, Coordinate):
            given[c.symbol], given[c.rate_symbol] = x[:, i], rates[:, i]
            i += 1
        else:
            given.update(zip(c.symbols, x[:, i : i + 4].T))
            given.update(zip(c.rate_symbols, body_rates(x[:, i : i + 4], rates[:, i : i + 4]).T))
            i += 4
    given.update((s.symbol, columns[s.name]) for s in model.speeds if s.name in columns)
    places = {d.name: x.shape[1] - len(interface.discretes) + k for k, d in enumerate(interface.discretes)}
    given.update((d.symbol, x[:, places[d.name]]) for d in model.discretes if d.name in places)
    return given


def random_configurations(model: Model, run: Solution) -> dict[Node, Any]:
    """Return the values of all symbols at random configurations: angles anywhere, lengths around those of the
    run, at random times of the run. The same model gives the same ones."""
    chance, x = random.Random(1), np.array(run.states)
    end = run.times[-1] or 1.0
    given = constants(model, run) | {model.time: _drawn(lambda: chance.uniform(0.0, end))}
    i = 0
    for c in model.coordinates:
        if isinstance(c, Coordinate):
            low, high = float(x[:, i].min()), float(x[:, i].max())
            if c.unit == "rad":
                low, high = -math.pi, math.pi
            else:
                wide = max(high - low, LEAST_RANGE * max(abs(low), abs(high))) or REST_RANGE
                low, high = low - AROUND * wide, high + AROUND * wide
            given[c.symbol] = _drawn(partial(chance.uniform, low, high))
            given[c.rate_symbol] = _drawn(lambda: chance.gauss(0.0, 1.0))
            i += 1
        else:
            q = np.array([_drawn(lambda: chance.gauss(0.0, 1.0)) for _ in range(4)])
            given.update(zip(c.symbols, q / np.linalg.norm(q, axis=0)))
            given.update((s, _drawn(lambda: chance.gauss(0.0, 1.0))) for s in c.rate_symbols)
            i += 4
    # Declared speeds and discrete variables move no place.
    zero = [*(s.symbol for s in model.speeds), *(d.symbol for d in model.discretes)]
    given.update(dict.fromkeys(zero, np.zeros(SAMPLES)))
    return given


def _drawn(draw: Callable[[], float]) -> Array:
    return np.array([draw() for _ in range(SAMPLES)])


def body_rates(q: Array, dq: Array) -> Array:
    """Return 2 conj(q) dq/dt, (n, 3): the angular velocity in body axes of quaternions w x y z (n, 4)."""
    w, x, y, z = q.T
    a, b, c, d = dq.T
    return 2.0 * np.column_stack(
        [-x * a + w * b + z * c - y * d, -y * a - z * b + w * c + x * d, -z * a + y * b - x * c + w * d]
    )
