"""The list of implicit constraints is right, or is not shown. Generalized forces against differences of
virtual work in 90 digits: displacements of points and turns of frames by central differences, potentials
and dissipation functions by differences of their values."""

import math

import pytest

from lagc.base.records import replace
from lagc.mechanics.identities.samples import samples
from lagc.reports.derivation.draft import Draft
from lagc.reports.derivation.implicit import implicit_constraints
from lagc.reports.derivation.rates import rates_of
from lagc.semantics.model import Action, Force, Lagrangian, Potential, Torque
from lagc.symbolic.graph import Node
from lagc.symbolic.walk import evaluate, reachable, substitute, symbols
from tests.derivation.test_every_model import CASES
from tests.oracle.lagrange import Oracle
from tests.reports.models import derived, equations_of


def texts(name: str) -> list[str]:
    return [x.text for x in implicit_constraints(Draft(derived(name), "en", False))]


def counts(name: str) -> list[int]:
    return [int(text.rpartition("(")[2].rstrip(")")) for text in texts(name)]


@pytest.mark.parametrize("name, expected", [
    ("course/simple_pendulum", [1, 1]),  # the plane, the string
    ("classic/double_pendulum", [1, 1, 1, 1]),
    ("classic/heavy_top", [3]),  # a ball joint
    ("classic/compound_pendulum", [5]),  # a pivot
    ("classic/four_bar", [5, 5, 5]),
    ("classic/spherical_pendulum_angles", [1]),  # the string
    ("course/wheel_rolling_implicit", [1, 1, 1, 2]),  # the plane, the ground, rolling, the axis
    ("course/rough_wedge_implicit", [1, 1, 1, 1]),  # both in the plane, the wedge on the ground, the face
])  # fmt: skip
def test_known_mechanisms(name: str, expected: list[int]) -> None:
    assert counts(name) == expected


@pytest.mark.sample(6)
@pytest.mark.parametrize("name", CASES)
def test_a_list_adds_up(name: str) -> None:
    model, n = derived(name).model, len(derived(name).v)
    free = sum(3 if b.frame is None else 6 for b in model.bodies)
    found = counts(name)
    assert not found or sum(found) == free - n


def test_most_models_have_a_list() -> None:
    """Of those of the course with implicit constraints, all."""
    missing = []
    for name in [x for x in CASES if x.startswith("course/")]:
        model, n = derived(name).model, len(derived(name).v)
        if sum(3 if b.frame is None else 6 for b in model.bodies) > n and not texts(name):
            missing.append(name)
    assert not missing


def test_a_mechanism_that_is_not_understood_has_none() -> None:
    """A particle on a surface that is given by two parameters which are no components of its place."""
    text = """
model Odd
  parameter Mass m = 1 [kg];
  parameter Length l = 1 [m];
  coordinate Angle a, b;
  body p = Particle(mass = m, at = l*{sin(a) + b, cos(a)*b, a*b});
end Odd;
"""
    assert implicit_constraints(Draft(equations_of(text), "en", False)) == []


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
