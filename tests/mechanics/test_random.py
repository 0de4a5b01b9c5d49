"""Random systems against Lagrange's equations by differences in 90 digits, and energy balance.

LAGC_RANDOM_SYSTEMS sets how many systems are tried.
"""

import os

import numpy as np
import pytest

from lagc.mechanics.derive import derive
from lagc.mechanics.formulation.equations import EquationsOfMotion
from lagc.mechanics.formulation.states import build_states
from lagc.symbolic.derivative import tangent
from lagc.symbolic.walk import evaluate
from tests.invariants import verify
from tests.mechanics.models import ALL
from tests.mechanics.numbers import consistent_state, jacobian, mass_matrix, motion, random_state, vector
from tests.mechanics.random_systems import random_system
from tests.oracle.lagrange import Oracle

COUNT = int(os.environ.get("LAGC_RANDOM_SYSTEMS", "120"))
CLOSE = 1e-12  # of the largest entry: some thousand roundings in doubles of 1e-16


def derived(seed: int) -> EquationsOfMotion:
    return derive(random_system(seed))


def assert_close(found: object, expected: object, scale: float = 0.0) -> None:
    a = np.array(found, dtype=float)
    b = np.array(expected, dtype=float)
    assert a.shape == b.shape or a.size == b.size == 0
    size = max(scale, float(np.abs(b).max(initial=0.0)), 1.0)
    assert np.abs(a - b).max(initial=0.0) <= CLOSE * size


@pytest.mark.sample(0, 10)
@pytest.mark.parametrize("seed", range(0, COUNT, 3))
def test_rows_of_the_mass_matrix_are_its_rows(seed: int) -> None:
    e = derived(seed)
    which = list(range(seed % 2, len(e.v), 1 + seed % 3))
    state, rows = random_state(e, seed), e.mass_rows(which)
    found = np.zeros((len(which), len(e.v)))
    for k, row in enumerate(rows):
        found[k, list(row)] = evaluate(list(row.values()), state)
    assert_close(found, mass_matrix(e, state)[which])


@pytest.mark.sample(1, 8)
@pytest.mark.parametrize("seed", range(COUNT))
def test_equations_agree_with_differences(seed: int) -> None:
    assert_lagranges(derived(seed), seed)


@pytest.mark.sample(1)
@pytest.mark.parametrize(
    "name", sorted(ALL.keys() - {"relativistic"})
)  # whose speeds are below that of light
def test_standard_systems_agree_with_differences(name: str) -> None:
    assert_lagranges(derive(ALL[name]()), 7)


def assert_lagranges(e: EquationsOfMotion, seed: int) -> None:
    verify(e)
    state = random_state(e, seed)
    mass, forces, g, gamma = Oracle(e.model, state, e.v).equations()
    assert_close(mass_matrix(e, state), mass.tolist())
    found = vector(e.given_forces, state) - vector(e.bias_forces, state)
    assert_close(found, [float(x) for x in forces])
    declared = [label for c in e.model.constraints for label in c.labels]
    places = [declared.index(row.label) for row in e.rows]
    if places:
        assert_close(jacobian(e, state), [g[k, :].tolist()[0] for k in places])
        assert_close(vector([row.gamma for row in e.rows], state), [gamma[k] for k in places])


@pytest.mark.sample(1, 10)
@pytest.mark.parametrize("seed", range(COUNT))
def test_energy_changes_by_the_power(seed: int) -> None:
    e = derived(seed)
    state = consistent_state(e, seed)
    if state is None:
        pytest.skip("no state near the random one meets the rows")
    state = motion(e, state)
    flow = build_states(e.model).flow
    rate, power = evaluate([tangent(e.graph, [e.energy], flow)[0], e.power], state)
    moving = np.array([state[x] for x in (*e.v, *e.a, *e.lam)])
    # a and lam carry the error of a solve: its condition times the rounding of the forces
    size = 1.0 + float(np.abs(moving).max()) ** 2 * float(np.abs(mass_matrix(e, state)).max())
    assert abs(rate - power) <= 1e-10 * size
