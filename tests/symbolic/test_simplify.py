"""The length of a vector does not know how the vector is turned, whatever turns it."""

import math
import random

import pytest

from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.simplify import MOST
from lagc.symbolic.vectors import Vector, add, dot, norm, scale
from lagc.symbolic.walk import evaluate, reachable, symbols


def turned(graph: Graph, axes: tuple[Vector, ...], k: int, angle: Node) -> tuple[Vector, ...]:
    """`axes`, turned about number k of them, as the functions `rotate_x`, ... do."""
    found = list(axes)
    i, j = (k + 1) % 3, (k + 2) % 3
    c, s = graph.cos(angle), graph.sin(angle)
    found[i] = add(scale(c, axes[i]), scale(s, axes[j]))
    found[j] = add(scale(c, axes[j]), scale(-s, axes[i]))
    return tuple(found)


def random_vector(graph: Graph, rng: random.Random) -> tuple[Vector, Node, set[Node], dict[Node, float]]:
    """A vector in turned axes, its squared length, the symbols of that, and values of all."""
    zero, one = graph.zero, graph.one
    axes: tuple[Vector, ...] = ((one, zero, zero), (zero, one, zero), (zero, zero, one))
    names = [graph.symbol("coordinate", f"q{k}") for k in range(3)]
    angles = [graph.symbol("coordinate", f"u{k}") for k in range(3)]
    time, rate = graph.symbol("time", "t"), graph.symbol("parameter", "w")
    for angle in rng.sample(angles, rng.randrange(1, 4)):
        axes = turned(graph, axes, rng.randrange(3), rng.choice((angle, angle + rate * time, 0.3 * angle)))
    parts = [rng.choice((zero, names[k], graph.const(rng.uniform(-3, 3)), rate * names[k])) for k in range(3)]
    vector: Vector = (zero, zero, zero)
    for part, axis in zip(parts, axes):
        vector = add(vector, scale(part, axis))
    square = dot((parts[0], parts[1], parts[2]), (parts[0], parts[1], parts[2]))
    values = {s: rng.uniform(-2.0, 2.0) for s in (*names, *angles, time, rate)}
    return vector, square, symbols([square]), values


@pytest.mark.sample(6, 12)
@pytest.mark.parametrize("seed", range(200))
def test_angles_drop_out_of_the_length_of_what_they_turn(seed: int) -> None:
    graph, rng = Graph(), random.Random(seed)
    vector, square, known, values = random_vector(graph, rng)
    length = norm(vector)
    assert symbols([length]) <= known
    (found, square_value) = evaluate([length, square], values)
    assert found == pytest.approx(math.sqrt(square_value), rel=1e-12, abs=1e-150)


@pytest.mark.parametrize("seed", range(50))
def test_angles_that_have_influence_stay_and_change_nothing(seed: int) -> None:
    """Between a turned point and one that is not, the distance is as it was written."""
    graph, rng = Graph(), random.Random(seed)
    vector, _, _, values = random_vector(graph, rng)
    away = add(vector, (graph.symbol("parameter", "a"), graph.zero, graph.one))
    if symbols(away) <= symbols([dot(vector, vector)]):
        return
    values = values | {graph.symbol("parameter", "a"): rng.uniform(-2.0, 2.0)}
    found, plain = evaluate([norm(away), dot(away, away)], values)
    assert found == pytest.approx(math.sqrt(plain), rel=1e-12)


def test_what_is_long_or_deep_stays_as_it_is_written() -> None:
    """And costs no more than its nodes: nothing is multiplied out beyond the bound."""
    graph = Graph()
    u, x = graph.symbol("coordinate", "u"), graph.symbol("coordinate", "x")
    deep = x
    for k in range(5000):
        deep = (deep + graph.const(k + 1.0)) * x
    before = len(graph.nodes)
    vector = (deep * graph.sin(u), deep * graph.cos(u), graph.sum(x**k for k in range(2, 60)))
    assert math.isfinite(evaluate([norm(vector)], {u: 1.0, x: 1e-3})[0])
    assert len(graph.nodes) - before < 4 * MOST
    assert len(reachable([norm(vector)])) > 5000
