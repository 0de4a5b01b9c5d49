"""Every model of the library against Lagrange's equations by differences in 90 digits."""

import random
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lagc.diagnostics.faults import Source
from lagc.mechanics.derive import derive
from lagc.mechanics.formulation.equations import EquationsOfMotion
from lagc.semantics.model import Coordinate, Model
from lagc.semantics.resolve import resolve
from lagc.semantics.scenes import variants
from lagc.symbolic.graph import Node
from lagc.symbolic.walk import evaluate, symbols
from lagc.syntax.parse import parse
from tests.oracle.lagrange import Oracle

MODELS = Path(__file__).resolve().parents[2] / "models"
FILES = sorted(MODELS.rglob("*.lag"))
CLOSE = 1e-12  # of the largest entry: some thousand roundings of 1e-16
LINKS = {"chain": 3}  # the number of structural parts that the slow oracle can stand


def richest(path: Path) -> Model:
    """The model in the scene that uses most effects."""
    tree = parse(Source(path.name, path.read_text()))
    found: list[Model] = []
    for v in variants(tree):
        given = {"n": LINKS[path.stem]} if path.stem in LINKS else None
        found.append(resolve(tree, v.scene, v.with_effects, v.without_effects, v.model, given))
    return max(found, key=lambda m: sum(e.used for e in m.effects))


def random_state(model: Model, e: EquationsOfMotion, seed: str) -> dict[Node, float]:
    """Near the start, so that denominators stay away from zero; rates of any direction."""
    chance = random.Random(seed)
    state: dict[Node, float] = {model.time: chance.uniform(0.1, 1.0)}
    for p in model.parameters:
        assert p.value is not None
        state[p.symbol] = p.value
    state.update({symbol: chance.uniform(-1, 1) for symbol in model.undetermined})
    for c in model.coordinates:
        if isinstance(c, Coordinate):
            start = evaluate([c.start], state)[0]
            state[c.symbol] = start + chance.uniform(0.05, 0.3) * max(abs(start), 0.2)
        else:
            around = [a + chance.uniform(-0.5, 0.5) for a in evaluate(c.start, state)]
            norm = sum(a * a for a in around) ** 0.5
            state.update(zip(c.symbols, [a / norm for a in around]))
    state.update({v: chance.uniform(-1, 1) for v in e.v})
    return state


def assert_close(found: Sequence[float], expected: Any) -> None:
    a = np.array(found, dtype=float)
    b = np.array([float(x) for x in expected])
    assert a.shape == b.shape
    if a.size:
        assert np.abs(a - b).max() <= CLOSE * max(np.abs(b).max(), np.abs(a).max(), 1e-300)


@pytest.mark.sample(0, 9)
@pytest.mark.parametrize("path", FILES, ids=lambda p: p.stem)
def test_the_equations_are_lagranges(path: Path) -> None:
    model = richest(path)
    e = derive(model)
    multipliers = {*e.lam, *(contact.multiplier for contact in e.contacts)}
    if any(c.actuator for c in model.constraints) or symbols(e.given_forces) & multipliers:
        pytest.skip("its loads depend on multipliers: see test_loads_of_reactions.py")
    state = random_state(model, e, path.stem)
    mass, forces, jacobian, gamma = Oracle(model, state, e.v).equations()
    n = len(e.v)
    lower = [(i, j) for i in range(n) for j in range(i + 1)]
    values = iter(evaluate([e.mass_matrix.get(p, e.graph.zero) for p in lower], state))
    assert_close(list(values), [mass[p] for p in lower])
    tau, h = evaluate(e.given_forces, state), evaluate(e.bias_forces, state)
    size = max(*map(abs, [*tau, *h]), max(abs(float(x)) for x in mass))  # speeds are about 1
    found = np.array(tau) - np.array(h)
    assert np.abs(found - np.array([float(x) for x in forces])).max() <= CLOSE * size
    labels = [label for c in model.constraints for label in c.labels]
    for row in e.rows:
        k = labels.index(row.label)
        entries = evaluate([row.jacobian.get(j, e.graph.zero) for j in range(n)], state)
        assert_close(entries, [jacobian[k, j] for j in range(n)])
        assert_close(
            [*entries, evaluate([row.gamma], state)[0]], [*(jacobian[k, j] for j in range(n)), gamma[k]]
        )


def test_a_wrong_equation_is_seen() -> None:
    """The oracle against a model whose kinetic energy is changed by a millionth."""
    path = MODELS / "classic" / "double_pendulum.lag"
    model = richest(path)
    e = derive(model)
    state = random_state(model, e, "wrong")
    oracle = Oracle(model, state, e.v)
    oracle.masses = [mass * (1 + 1e-6) for mass in oracle.masses]
    mass, _, _, _ = oracle.equations()
    with pytest.raises(AssertionError):
        assert_close(evaluate([e.mass_matrix[0, 0]], state), [mass[0, 0]])
