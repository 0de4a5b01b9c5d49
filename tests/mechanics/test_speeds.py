"""Declared speeds: any choice of them gives the motion that the rates give."""

import random

import pytest

from lagc.mechanics.derive import derive
from lagc.mechanics.formulation.states import build_states
from lagc.semantics.model import Model
from lagc.symbolic.derivative import tangent
from lagc.symbolic.expression_text import text
from lagc.symbolic.walk import evaluate
from tests.invariants import verify
from tests.mechanics.builder import Builder
from tests.mechanics.numbers import mass_matrix, motion, random_state


def arm(n: int, count: int, seed: int) -> Model:
    """A spatial arm of n joints, with `count` declared speeds of random coefficients."""
    r = random.Random(seed)
    b = Builder()
    g = b.graph
    q = [b.coordinate(f"q{i}", r.uniform(-1, 1), r.uniform(-1, 1)) for i in range(n)]
    frame, at = b.world, b.vector((0.0, 0.0, 0.0))
    for i, angle in enumerate(q):
        frame = b.rotate(f"F{i}", frame, "xyz"[i % 3], angle)
        at = b.vector([a + 0.7 * row[(i + 1) % 3] for a, row in zip(at, frame.axes)])
        b.solid(f"b{i}", g.const(1.0 + 0.1 * i), (0.1, 0.2, 0.3), frame, at)
    b.gravity(9.81)
    b.dissipation("friction", 0.1 * g.sum(b.der(x) ** 2 for x in q))
    for k in range(count):
        mix = g.sum(r.uniform(-1, 1) * g.cos(q[(i + k) % n]) * b.der(x) for i, x in enumerate(q))
        b.speed(f"u{k}", mix + 2.0 * b.der(q[k]) + g.sin(b.time))
    b.force("tip", (0.1, 0.2, g.sin(b.time)), at)
    b.constraint("flat", b.der(q[0]) * g.cos(q[-1]) - 0.3 * b.der(q[-1]))
    return b.model()


@pytest.mark.sample(1)
@pytest.mark.parametrize("n, count", [(1, 1), (2, 1), (3, 3), (4, 2), (5, 5), (6, 6)])
def test_same_accelerations_as_rates(n: int, count: int) -> None:
    """Sizes below and above what Cramer's rule serves."""
    plain, spoken = derive(arm(n, 0, 5)), derive(arm(n, count, 5))
    verify(spoken)
    names = {**dict(zip(plain.v_names, plain.v))}
    first = motion(plain, random_state(plain, 1))
    second = {x: first[y] for x, y in zip(spoken.q, plain.q)} | {spoken.time: first[plain.time]}
    wanted = {rate: first[names[rate.record.name]] for rate in spoken.rates}
    speeds = {s.symbol: s.expression for s in spoken.model.speeds}
    second |= {v: evaluate([speeds.get(v, v)], {**second, **wanted})[0] for v in spoken.v}
    rates = list(spoken.rates)
    assert evaluate([spoken.rates[x] for x in rates], second) == pytest.approx([wanted[x] for x in rates])
    second = motion(spoken, second)
    changes = tangent(spoken.graph, [spoken.rates[x] for x in rates], build_states(spoken.model).flow)
    expected = [first[plain.a[plain.v_names.index(x.record.name)]] for x in rates]
    # three solves, of condition below 1e4
    assert evaluate(changes, second) == pytest.approx(expected, rel=1e-9, abs=1e-9)
    energies = [evaluate([e.energy, e.power], s) for e, s in ((plain, first), (spoken, second))]
    assert energies[0] == pytest.approx(energies[1], rel=1e-9, abs=1e-9)


def test_a_rotated_pair_needs_no_division() -> None:
    b = Builder()
    x, y, phi = b.coordinate("x"), b.coordinate("y"), b.coordinate("phi")
    g = b.graph
    b.particle("p", b.parameter("m"), (x, y, 0.0))
    b.speed("u", b.der(x) * g.cos(phi) + b.der(y) * g.sin(phi))
    b.speed("w", b.der(y) * g.cos(phi) - b.der(x) * g.sin(phi))
    e = derive(b.model())
    assert text(e.rates[b.der(x)]) == "cos(phi)*u - sin(phi)*w"
    assert e.mass_matrix.keys() == {(0, 0), (1, 1)}


def test_speeds_of_a_quaternion_may_be_declared() -> None:
    """World axes instead of the body's own."""
    b = Builder()
    frame, o = b.orientation("o")
    b.solid("s", b.parameter("m"), (0.1, 0.2, 0.3), frame)
    for i, k in enumerate("xyz"):
        b.speed(f"w{k}", b.graph.sum(frame.axes[i][j] * o.rate_symbols[j] for j in range(3)))
    e = derive(b.model())
    state = random_state(e, 2)
    w = [state[x] for x in e.v]
    body = evaluate([e.rates[x] for x in o.rate_symbols], state)
    axes = evaluate([x for row in frame.axes for x in row], state)
    turned = [sum(axes[3 * i + j] * w[i] for i in range(3)) for j in range(3)]
    assert body == pytest.approx(turned, abs=1e-12)
    kinetic = sum(c * x * x for c, x in zip((0.1, 0.2, 0.3), turned)) / 2
    assert evaluate([e.kinetic], state)[0] == pytest.approx(kinetic, rel=1e-12)
    assert mass_matrix(e, state).shape == (3, 3)
