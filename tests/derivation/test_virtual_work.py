"""Generalized forces against differences of virtual work in 90 digits: displacements of points and turns of
frames by central differences, potentials and dissipation functions by differences of their values."""

from __future__ import annotations

import pytest

from lagc.base.records import replace
from lagc.mechanics.numeric.samples import samples
from lagc.reports.derivation.rates import rates_of
from lagc.symbolic.evaluate import evaluate
from lagc.symbolic.walk import symbols
from tests.derivation.test_every_model import CASES
from tests.oracle.lagrange import Oracle
from tests.reports.models import derived

CLOSE = 1e-12  # of the largest: roundings of doubles; the differences have an error of 1e-30
FUNCTIONS = ("piece", "entry")  # of tables, which the oracle does not know


@pytest.mark.sample(12)
@pytest.mark.parametrize("name", CASES)
def test_generalized_forces_are_differences_of_virtual_work(name: str) -> None:
    equations = derived(name)
    rates = rates_of(equations)
    free = {term.name for term in rates.free_terms}
    (state,) = samples(equations.model, 1)
    for action, term in zip(equations.model.actions, rates.given):
        nodes = list(term.forces.values())
        held = {x for x in symbols(nodes) if x.record.kind == "multiplier"}
        if action.name in free or any(node.op in FUNCTIONS for node in equations.graph.nodes):
            continue
        alone = replace(equations.model, actions=(action,), bodies=(), constraints=(), speeds=())
        if equations.model.speeds:
            continue  # of no action in the library's models
        true = Oracle(alone, {**state, **dict.fromkeys(held, 1.0)}, rates.symbols).forces_of_rates()
        values = evaluate(nodes, {**state, **dict.fromkeys(held, 1.0)})
        size = max([1.0, *map(abs, values)])
        for j in range(len(true)):
            shown = values[list(term.forces).index(j)] if j in term.forces else 0.0
            assert abs(shown - float(true[j])) < CLOSE * size, (action.name, j)
