"""Lengths of gradients that are not formed, against differences of 50 digits; what they cost."""

import math
import random
from collections.abc import Callable
from functools import cache

import mpmath as mp
import pytest

from lagc.compiler import pipeline
from lagc.compiler.stages import Choice
from lagc.diagnostics.faults import Source
from lagc.lowering.magnitudes import gradient_bounds, gradient_magnitudes
from lagc.lowering.program import Function
from lagc.lowering.program_functions import gamma_sizes, gradient_sizes, gradients, reaches, scales
from lagc.lowering.storage import Places, places
from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.walk import evaluate
from tests.oracle.lagrange import Expressions

STEP = mp.mpf(10) ** -20
LEAVES = 64


def shared(graph: Graph, leaves: list[Node], dice: random.Random, positive: bool) -> list[Node]:
    """Products of two sums that go on from leaf to leaf."""
    odd = ("exp", "sinh") if positive else ("sin", "cos", "exp", "tanh")
    one, two, found = graph.one, graph.one, list[Node]()
    for x in leaves:
        c, d = (dice.uniform(0.1 if positive else -1.0, 1.0) for _ in range(2))
        one = one + c * graph.unary(dice.choice(odd), 0.3 * x)
        two = two + d * x * graph.unary(dice.choice(odd), 0.2 * x)
        found.append(one * two)
    return found


def truth(nodes: list[Node], leaves: list[Node], state: dict[Node, float]) -> list[list[float]]:
    """The entries of the gradients; differences of step 1e-20 are off by 1e-40."""
    with mp.workdps(50):
        at = {x: mp.mpf(value) for x, value in state.items()}
        values = Expressions(nodes)
        pairs = [(values({**at, x: at[x] + STEP}), values({**at, x: at[x] - STEP})) for x in leaves]
        return [[float((a[k] - b[k]) / (2 * STEP)) for a, b in pairs] for k in range(len(nodes))]


@pytest.mark.sample(0, 2)
@pytest.mark.parametrize("positive", [True, False], ids=["positive", "any"])
@pytest.mark.parametrize("seed", range(3))
def test_lengths_of_gradients(seed: int, positive: bool) -> None:
    dice, graph = random.Random(f"{seed} {positive}"), Graph()
    leaves = [graph.symbol("coordinate", f"x{k}") for k in range(LEAVES)]
    scales = [graph.symbol("size", str(k)) for k in range(LEAVES)]
    weights = dict(zip(leaves, scales))
    nodes = shared(graph, leaves, dice, positive)
    state = {x: dice.uniform(0.1, 1.0) for x in [*leaves, *scales]}
    entries = [
        [abs(slope) * state[weights[x]] for x, slope in zip(leaves, row)]
        for row in truth(nodes, leaves, {x: state[x] for x in leaves})
    ]
    bounds = gradient_bounds(graph, nodes, weights)
    assert bounds is not None
    magnitudes = evaluate(gradient_magnitudes(graph, nodes, weights), state)
    for k, (bound, magnitude) in enumerate(zip(evaluate(bounds, state), magnitudes)):
        found = math.fsum(entries[k])
        # The squares of two leaves cancel no more than their products do: 1e-16 of the square of `magnitude`.
        squares = (k + 1) * math.fsum(a * a for a in entries[k])
        assert bound**2 == pytest.approx(squares, rel=1e-12, abs=1e-14 * magnitude**2)
        assert found <= bound * (1.0 + 1e-12)
        assert found <= magnitude * (1.0 + 1e-12)
        if positive:
            assert magnitude == pytest.approx(found, rel=1e-12)


def test_few_entries_are_added_one_by_one() -> None:
    graph = Graph()
    x, y, size = (graph.symbol("coordinate", name) for name in "xyz")
    assert gradient_bounds(graph, [graph.unary("sin", x * y)], {x: size, y: size}) is None


LADDER = """model Ladder
  structural Integer n = 3;
  coordinate Angle a[n](each start = 20 [deg]), b[n](each start = 20 [deg]);
  point P[0] = {0, 0, 0};
  point Q[0] = {1, 0, 0};
  for i in 1:n loop
    point P[i] = P[i-1] + (1 [m])*{sin(a[i]), 0, -cos(a[i])};
    point Q[i] = Q[i-1] + (1 [m])*{sin(b[i]), 0, -cos(b[i])};
    body left[i] = Particle(mass = 1 [kg], at = P[i]);
    body right[i] = Particle(mass = 1 [kg], at = Q[i]);
    constraint rung[i]: (P[i].x - Q[i].x)^2 + (P[i].z - Q[i].z)^2 = 1 [m2];
  end for;
end Ladder;
"""


@cache
def ladder(n: int) -> Places:
    model = pipeline.resolve(pipeline.parse(Source("ladder.lag", LADDER)), Choice(parameters={"n": n}))
    return places(pipeline.derive(model), model.parameters)


@pytest.mark.sample(1)
@pytest.mark.parametrize("make", [scales, gamma_sizes, gradient_sizes, gradients, reaches],
                         ids=lambda make: make.__name__)  # fmt: skip
def test_sizes_of_rows_cost_as_much_as_the_model_is_long(make: Callable[[Places], Function]) -> None:
    """Every rung depends on all angles above it, so that gradients have as many entries as pairs."""
    few, many = (make(ladder(n)).cost for n in (50, 75))
    assert many < 1.55 * few
