"""Generalized forces against differences of virtual work in 90 digits: displacements of points and turns of
frames by central differences, potentials and dissipation functions by differences of their values."""

import math

import pytest

from lagc.base.records import replace
from lagc.mechanics.identities.samples import samples
from lagc.reports.derivation.rates import rates_of
from lagc.semantics.model import Action, Force, Lagrangian, Potential, Torque
from lagc.symbolic.graph import Node
from lagc.symbolic.walk import evaluate, reachable, substitute, symbols
from tests.derivation.test_every_model import CASES
from tests.oracle.lagrange import Oracle
from tests.reports.models import derived

CLOSE = 1e-12  # of the largest: roundings of doubles; the differences have an error of 1e-30
TABLES = ("piece", "entry")  # functions that the oracle does not know
NUMBERS = {"pi": math.pi}


@pytest.mark.sample(12)
@pytest.mark.parametrize("name", CASES)
def test_generalized_forces_are_differences_of_virtual_work(name: str) -> None:
    equations = derived(name)
    rates = rates_of(equations)
    free = {term.name for term in rates.free_terms}
    (state,) = samples(equations.model, 1)
    graph = equations.graph
    for action, term in zip(equations.model.actions, rates.given_terms):
        if action.name in free or isinstance(action, Lagrangian) or equations.model.speeds:
            continue
        if any(node.op in TABLES for node in reachable(parts_of(action))):
            continue
        held = symbols([*parts_of(action), *term.forces.values()])
        kinds = ("multiplier", "number")
        given = {x: graph.const(NUMBERS.get(x.record.owner, 1.0)) for x in held if x.record.kind in kinds}
        alone = replace(equations.model, actions=(with_numbers(action, given),), bodies=(), constraints=())
        true = Oracle(alone, state, rates.symbols).forces_of_rates()
        shown = dict(zip(term.forces, evaluate(substitute(graph, list(term.forces.values()), given), state)))
        size = max([1.0, *map(abs, shown.values())])
        for j, force in enumerate(true):
            assert abs(shown.get(j, 0.0) - float(force)) < CLOSE * size, (action.name, j)


def parts_of(action: Action) -> list[Node]:
    if isinstance(action, Force | Torque):
        return list(action.vector)
    return [action.energy if isinstance(action, Potential) else action.function]


def with_numbers(action: Action, given: dict[Node, Node]) -> Action:
    """The action with numbers for multipliers, which stand for themselves in its generalized forces."""
    if isinstance(action, Force | Torque):
        x, y, z = substitute(action.vector[0].graph, list(action.vector), given)
        return replace(action, vector=(x, y, z))
    return action
