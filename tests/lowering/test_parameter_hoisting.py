"""What depends on parameters alone is computed by `bind`: all of it, once, and no digit is lost."""

import math
import random
from collections.abc import Sequence
from types import SimpleNamespace
from typing import Any

import mpmath
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import lagc
from lagc.lowering.program import Function, Operation
from lagc.lowering.scalar.expand import Coefficients, Lowering
from lagc.lowering.scalar.parameter_hoisting import Preparation
from lagc.lowering.scalar.value_numbering import Block
from lagc.lowering.storage import Places, lower
from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.operators import TRUTHS
from lagc.symbolic.walk import evaluate, reachable
from tests.invariants import verify
from tests.lowering.interpret import interpret
from tests.lowering.test_lower import compare, random_nodes

PARAMETERS, INPUTS = 2, 1  # of the four symbols of random expressions; the last is a coordinate


def prepared(functions: list[Function]) -> tuple[dict[str, Function], tuple[int, ...]]:
    preparation = Preparation(PARAMETERS, PARAMETERS + INPUTS)
    return preparation.finished({f.name: preparation.separated(f) for f in functions})


def function(graph: Graph, x: list[Node], nodes: list[Node], name: str = "f") -> Function:
    given_ = PARAMETERS + INPUTS
    arrays = {s: ("p", k) if k < given_ else ("x", k - given_) for k, s in enumerate(x)}
    equations: Any = SimpleNamespace(graph=graph)
    block = Block()
    for k, value in enumerate(lower(Places(equations, arrays, tuple(x[:PARAMETERS])), block, nodes)[1]):
        block.store("y", k, value)
    return block.function(name, ("p", "t", "x"), (("y", len(nodes)),), "")


def asked(functions: dict[str, Function], name: str, values: list[float]) -> list[float]:
    p, x = values[: PARAMETERS + INPUTS], values[PARAMETERS + INPUTS :]
    if "bind" in functions:
        p = p + interpret(functions["bind"], {"p": p})["prepared"]
    return interpret(functions[name], {"p": p, "t": [0.0], "x": x})["y"]


def idle(f: Function) -> list[str]:
    """Operations that could have been prepared: made of parameters, or what is prepared, and numbers."""
    below: list[set[bool]] = []
    found = []
    for o in f.operations:
        if isinstance(o.payload, tuple):
            array, index = o.payload
            below.append({array == "p" and not PARAMETERS <= index < PARAMETERS + INPUTS})
        else:
            below.append(set().union(*(below[k] for k in o.operands)))
            if below[-1] == {True} and o.op != "neg" and o.op not in TRUTHS:
                found.append(o.op)
    return found


@pytest.mark.full
@settings(max_examples=100, deadline=None)
@given(st.integers(0, 10**6))
def test_values_are_those_of_the_expressions_and_nothing_is_left_to_prepare(seed: int) -> None:
    graph, x, nodes = random_nodes(seed)
    rng = random.Random(seed + 1)
    found, read = prepared([function(graph, x, nodes), function(graph, x, nodes[:3], "g")])
    for f in found.values():
        verify(f)
    assert not idle(found["f"]) and not idle(found["g"])
    bind = found.get("bind")
    if bind is not None:
        assert {o.payload for o in bind.operations if o.op == "load"} == {("p", k) for k in read}
        assert max(read) < PARAMETERS  # an input may change at any time
        copies = bind.stores[-len(read) :]
        assert [bind.operations[s.value].payload for s in copies] == [("p", k) for k in read]
        values = [s.value for s in bind.stores[: -len(read)]]
        assert len(set(values)) == len(values)  # what two functions need is there once
    values_ = [rng.uniform(-1.5, 1.5) for _ in x]
    wanted = evaluate(nodes, dict(zip(x, values_)))
    if all(math.isfinite(w) and abs(w) < 1e6 for w in wanted):
        compare(asked(found, "f", values_), wanted)
        compare(asked(found, "g", values_), wanted[:3])


def written(nodes: list[Node], values: dict[Node, float]) -> dict[Node, tuple[Any, Any]]:
    """The value of each node, and how far off arithmetic that rounds each operation may be, in units of 2^-53
    (N. J. Higham, *Accuracy and Stability of Numerical Algorithms*, 3.3: running error analysis)."""
    found: dict[Node, tuple[Any, Any]] = {}
    for node in reachable(nodes):
        parts = [found[a] for a in node.args]
        if node.op in ("const", "symbol"):
            found[node] = (mpmath.mpf(node.value if node.is_const else values[node]), mpmath.mpf(0))
            continue
        if node.op == "add":
            value, off = sum(v for v, _ in parts), sum(e for _, e in parts)
        elif node.op == "scale":
            value, off = node.value * parts[0][0], abs(node.value) * parts[0][1]
        else:
            assert node.op == "mul"
            value = mpmath.fprod(v**e for (v, _), e in zip(parts, node.value))
            off = abs(value) * sum(abs(e) * (d / abs(v) + 1) for (v, d), e in zip(parts, node.value))
        found[node] = value, off + abs(value)
    return found


@pytest.mark.parametrize("seed", range(40))
def test_no_digits_are_lost(seed: int) -> None:
    """Sums of products of parameters with differences of near numbers, x - x0: a constant that is moved from
    one difference to another would cost nine digits."""
    rng = random.Random(seed)
    graph = Graph()
    p = [graph.symbol("parameter", f"p{k}") for k in range(4)]
    x = [graph.symbol("coordinate", f"x{k}") for k in range(4)]
    values = {s: rng.uniform(0.5, 2.0) * 10.0 ** rng.randint(-3, 3) for s in p}
    values.update({s: values[a] * (1.0 + rng.uniform(-1e-9, 1e-9)) for s, a in zip(x, p)})
    nodes = []
    for _ in range(4):
        total = graph.zero
        for _ in range(rng.randint(2, 5)):
            k = rng.randrange(4)
            term = rng.choice([1.0, -0.5, 3.0]) * (x[k] - p[k])
            for _ in range(rng.randint(0, 3)):
                term = term * rng.choice(p) if rng.random() < 0.7 else term / (rng.choice(p) * rng.choice(x))
            total = total + term
        nodes.append(total)
    with mpmath.workdps(60):
        truth = written(nodes, values)
        parts = Coefficients(graph, nodes, p)
        block = Block()
        known = {s: block.load("p", k) for k, s in enumerate(p)}
        known.update({s: block.load("x", k) for k, s in enumerate(x)})
        lowering = Lowering(block, known)
        lowering.known.update(zip(parts.meaning, lowering(list(parts.meaning.values()))))
        for k, value in enumerate(lowering(parts.nodes)):
            block.store("y", k, value)
        preparation = Preparation(len(p), len(p))
        f = preparation.separated(block.function("f", ("p", "t", "x"), (("y", len(nodes)),), ""))
        found, _ = preparation.finished({"f": f})
        given_ = [values[s] for s in p]
        given_ += interpret(found["bind"], {"p": given_})["prepared"] if "bind" in found else []
        y = interpret(found["f"], {"p": given_, "t": [0.0], "x": [values[s] for s in x]})["y"]
        for node, one in zip(nodes, y):
            value, off = truth[node]
            assert abs(one - value) <= 2 * off * mpmath.mpf(2) ** -53


@pytest.mark.parametrize("name", ["wedge_and_block", "yo_yo", "double_atwood_machine"])
def test_constant_accelerations_cost_nothing(name: str) -> None:
    """Masses and slopes alone decide them: mass matrix, its factors and the solution are prepared."""
    program = lagc.load(name).compile(backend="numpy").program
    assert program.functions["rhs"].cost == 0 < program.interface.preparation


def test_numbers_that_are_made_of_numbers_are_made_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """The elimination of a mass matrix of numbers is a chain of them, each made of several before."""
    made, again = [0], Block.repeat

    def counted(self: Block, o: Operation, operands: Sequence[int]) -> int:
        made[0] += 1
        assert made[0] < 100_000
        return again(self, o, operands)

    monkeypatch.setattr(Block, "repeat", counted)
    model = """model Rail
      structural Integer n = 16;
      coordinate Length x[n];
      point P[0] = {0, 0, 0};
      for i in 1:n loop
        point P[i] = P[i-1] + {x[i], 0, 0};
        body b[i] = Particle(mass = 1, at = P[i]);
        force f[i] = {-1[N/m]*x[i], 0, 0} at b[i];
      end for;
    end Rail;"""
    assert lagc.loads(model).compile().program.interface.nv == 16
