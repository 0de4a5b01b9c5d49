"""The list of implicit constraints is right, or is not shown."""

import pytest

from lagc.reports.derivation.draft import Draft
from lagc.reports.derivation.implicit import implicit_constraints
from tests.derivation.test_every_model import CASES
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
