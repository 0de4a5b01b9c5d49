"""Every claim over the library and over random systems: what is said to be conserved keeps its value along
the motion, and what is not said to be does not, at some state at least."""

import math
from collections.abc import Mapping
from pathlib import Path

import pytest

from lagc.mechanics.analysis.analysis import analyse
from lagc.mechanics.balance.energy import WHOLE
from lagc.mechanics.balance.outputs import Quantities
from lagc.mechanics.derive import derive
from lagc.mechanics.formulation.equations import EquationsOfMotion
from lagc.mechanics.formulation.euler_lagrange import free_terms, with_rates
from lagc.mechanics.formulation.inertia import moving_parts
from lagc.mechanics.formulation.states import States, build_states
from lagc.mechanics.identities.constraint_manifold import walk
from lagc.mechanics.identities.samples import magnitudes, samples
from lagc.symbolic.derivative import tangent
from lagc.symbolic.graph import Node
from lagc.symbolic.leaves import Symbol
from lagc.symbolic.walk import evaluate
from tests.mechanics.numbers import mass_matrix, motion
from tests.mechanics.random_systems import random_system
from tests.reports.models import MODELS, derived

FILES = sorted(MODELS.rglob("*.lag"))
TOTALS = [Symbol(kind, component=axis) for kind in ("momentum", "angular_momentum") for axis in "xyz"]
State = dict[Node, float]


def rates(e: EquationsOfMotion, state: State) -> State:
    """d/dt of t, q and v along the motion."""
    moved = motion(e, state)
    return {e.time: 1.0, **dict(zip(e.q, evaluate(e.qdot, state))), **{v: moved[a] for v, a in zip(e.v, e.a)}}


def moved(e: EquationsOfMotion, state: State, steps: int = 4) -> State:
    """Some short steps of the classical method of order 4: its error is about 1e-15."""
    first = rates(e, state)
    sizes = [abs(r) / max(1.0, abs(state[x])) for x, r in first.items()]
    h = 1e-3 / max(1.0, *sizes)

    def ahead(slope: Mapping[Node, float], size: float) -> State:
        return {**state, **{x: state[x] + size * r for x, r in slope.items()}}

    for _ in range(steps):
        k1 = rates(e, state)
        k2 = rates(e, ahead(k1, 0.5 * h))
        k3 = rates(e, ahead(k2, 0.5 * h))
        k4 = rates(e, ahead(k3, h))
        state = ahead({x: (k1[x] + 2.0 * k2[x] + 2.0 * k3[x] + k4[x]) / 6.0 for x in k1}, h)
    return state


def total_momenta(e: EquationsOfMotion, states: States) -> dict[str, Node]:
    parts = moving_parts(states)
    free = free_terms(states, with_rates(states))
    quantities = Quantities(states, parts, (), free, e.kinetic, e.potential)
    return {asked.name: quantities.value(asked) for asked in TOTALS}


def assert_true(e: EquationsOfMotion) -> None:
    found = analyse(e)
    states = build_states(e.model)
    found_states = walk(states, e.rows).by_distance
    assert found_states
    tries = [s for s in found_states if all(map(math.isfinite, mass_matrix(e, s).flat))][:3]
    apart = [magnitudes([e.energy - e.kinetic - e.potential], s)[0] for s in samples(e.model, 3)]
    assert (e.balance == WHOLE) == all([not abs(rest) > 1e-11 * size for rest, size in apart])
    claimed = {c.name: c.expression for c in found.conserved}
    for state in tries if claimed else ():
        later = moved(e, state)
        for name, node in claimed.items():
            ((before, size),), ((after, _),) = magnitudes([node], state), magnitudes([node], later)
            assert abs(after - before) <= 1e-11 * size, name
    asked = {name: x for name, x in total_momenta(e, states).items() if name not in claimed}
    slopes = tangent(e.graph, list(asked.values()), states.flow)
    kept = set(asked)
    for state in tries:
        full = motion(e, state)
        for (name, node), slope in zip(asked.items(), slopes):
            ((rate, size),), (value,) = magnitudes([slope], full), evaluate([node], state)
            if abs(rate) > 1e-8 * size or abs(value) <= 1e-12:  # it changes, or it is nothing
                kept.discard(name)
    assert not (tries and kept)


LOADED = ("journal_bearing", "driven_cart_pole", "rough_tube_explicit", "rolling_cart")


@pytest.mark.sample(0, 8)
@pytest.mark.parametrize("path", FILES, ids=lambda p: p.stem)
def test_claims_over_the_library(path: Path) -> None:
    name = str(path.relative_to(MODELS).with_suffix(""))
    if path.stem in LOADED:
        pytest.skip("its loads depend on reactions: states alone do not have them")
    if path.stem == "walls":
        pytest.skip("no state of the samples reaches a wall: momentum stays there")
    for scene in derived(name).model.scenes:
        assert_true(derived(name, scene))


@pytest.mark.sample(1, 7)
@pytest.mark.parametrize("seed", range(16))
def test_claims_over_random_systems(seed: int) -> None:
    e = derive(random_system(seed))
    if walk(build_states(e.model), e.rows).by_distance:
        assert_true(e)


@pytest.mark.sample(1, 7)
@pytest.mark.parametrize("seed", range(16))
def test_claims_over_random_systems_that_keep_their_energy(seed: int) -> None:
    """Without drives, friction and given loads: energy is claimed."""
    e = derive(random_system(seed, lossless=True))
    if walk(build_states(e.model), e.rows).by_distance:
        assert "energy" in [c.name for c in analyse(e).conserved]
        assert_true(e)


@pytest.mark.full
def test_nothing_in_the_library_only_seems_so() -> None:
    """But for the rows of Bennett's linkage, whose rank is that of its lengths, rolling wheels, the brackets
    of whose rows are too long to be formed, and the momentum of two shafts about the axis across both,
    which the input shaft alone brings. Where loads depend on reactions, no conserved quantity is
    looked for."""
    for path in FILES:
        found = analyse(derived(str(path.relative_to(MODELS).with_suffix(""))))
        if path.stem in ("whipple_bicycle", "rolling_coin", "bennett"):
            assert all(c.proved for c in found.conserved)
            continue
        if path.stem == "universal_joint":
            assert [c.name for c in found.conserved if not c.proved] == ["angular_momentum().y"]
            assert all(c.proved for c in found.constraints)
            continue
        assert all(c.proved for c in (*found.conserved, *found.constraints))
        if path.stem in LOADED:
            (left,) = found.not_examined
            assert left.startswith("energy and momenta: loads depend on reactions")
            continue
        assert not any((found.seems.cyclic, found.seems.redundant, found.seems.degrees_of_freedom,
                        found.seems.positional_freedom, found.not_examined))  # fmt: skip
