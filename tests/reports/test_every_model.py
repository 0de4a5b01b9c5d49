"""The equations that people read are the derived ones, for every model of the library."""

import math
from collections.abc import Mapping
from pathlib import Path

import pytest

from lagc.mechanics.derive import derive
from lagc.mechanics.formulation.equations import EquationsOfMotion
from lagc.mechanics.identities.samples import Chance, samples
from lagc.reports.equations.write import write
from lagc.symbolic.graph import Node
from lagc.symbolic.walk import evaluate
from tests.mechanics.random_systems import random_system
from tests.reports.models import EVERYTHING, LONG, MODELS, derived, equations_of
from tests.reports.scripts import script_residuals, values_at

FILES = sorted(MODELS.rglob("*.lag"))
STATES = 4


def states(equations: EquationsOfMotion) -> list[dict[Node, float]]:
    """Random states at which the equations are numbers; the parameters are the defaults throughout,
    so that a factor of parameters is one number."""
    chance = Chance(4711)
    found = []
    for state in samples(equations.model, 4 * STATES, vary=False):
        state.update((symbol, chance.draw()) for symbol in (*equations.v, *equations.a, *equations.lam))
        state.update((force, 0.0) for contact in equations.contacts for force in contact.forces)  # open
        if all(math.isfinite(t) for terms in motion_terms(equations, state) for t in terms):
            found.append(state)
    return found[:STATES]


def motion_terms(equations: EquationsOfMotion, state: Mapping[Node, float]) -> list[list[float]]:
    """The terms of M a + h - tau - G^T lam, row by row."""
    n = len(equations.v)
    rows: list[list[float]] = [[] for _ in range(n)]
    masses = evaluate(list(equations.mass_matrix.values()), state)
    for (i, j), m in zip(equations.mass_matrix, masses):
        rows[i].append(m * state[equations.a[j]])
        if i != j:
            rows[j].append(m * state[equations.a[i]])
    for i, (h, tau) in enumerate(
        zip(evaluate(equations.bias_forces, state), evaluate(equations.given_forces, state))
    ):
        rows[i] += [h, -tau]
    for row, lam in zip(equations.rows, equations.lam):
        for i, g in zip(row.jacobian, evaluate(list(row.jacobian.values()), state)):
            rows[i].append(-g * state[lam])
    return rows


@pytest.mark.sample(0, 9)
@pytest.mark.parametrize("path", FILES, ids=lambda p: p.stem)
def test_written_equations_are_the_derived_ones(path: Path) -> None:
    """In every scene."""
    name = str(path.relative_to(MODELS).with_suffix(""))
    for scene in derived(name).model.scenes:
        assert_same(derived(name, scene))


@pytest.mark.full
@pytest.mark.parametrize("text", [EVERYTHING, LONG], ids=["every function", "named parts"])
def test_unusual_equations_are_the_derived_ones(text: str) -> None:
    assert_same(equations_of(text))


@pytest.mark.sample(0, 4)
@pytest.mark.parametrize("seed", range(24))
def test_equations_of_random_systems_are_the_derived_ones(seed: int) -> None:
    assert_same(derive(random_system(seed)))


def assert_same(equations: EquationsOfMotion) -> None:
    script = write(equations, "sympy")
    kinematic = sum(not (e in equations.v and n == f"der({q})") for e, n, q in kinematics(equations))
    motion = range(kinematic, kinematic + len(equations.v))
    pairs: list[list[tuple[float, float, float]]] = [[] for _ in equations.v]
    met = states(equations)
    assert met
    for state in met:
        written = script_residuals(script, values_at(equations, state), state[equations.model.time])
        terms = motion_terms(equations, state)
        # Kinematics and constraints are written as they are, the equations of motion up to a factor.
        for residual in written[:kinematic]:
            assert abs(residual) <= 1e-12 * (1.0 + size(state))
        for row, k in zip(pairs, motion):
            i = k - kinematic
            row.append((written[k], math.fsum(terms[i]), math.fsum(map(abs, terms[i]))))
        residuals = evaluate([row.residual for row in equations.rows], state)
        for residual, value in zip(written[motion.stop :], residuals):
            assert abs(residual - value) <= 1e-12 * (1.0 + size(state)) ** 2
    for row in pairs:
        assert_proportional(row)


def kinematics(equations: EquationsOfMotion) -> list[tuple[Node, str, str]]:
    names = dict(zip(equations.v, equations.v_names))
    return [(e, names.get(e, ""), q) for e, q in zip(equations.qdot, equations.q_names)]


def size(state: Mapping[Node, float]) -> float:
    return max((abs(x) for x in state.values()), default=0.0)


def assert_proportional(row: list[tuple[float, float, float]]) -> None:
    """written = factor*derived at every state.  Both are sums of some tens of terms whose sizes add
    up to `scale`: 1e-12 of it is far above rounding and far below any term."""
    written, value, _ = max(row, key=lambda p: abs(p[1]))
    if value == 0.0:
        assert all(w == 0.0 for w, _, _ in row)
        return
    factor = written / value
    assert factor != 0.0
    for written, value, scale in row:
        assert abs(written - factor * value) <= 1e-12 * abs(factor) * scale
