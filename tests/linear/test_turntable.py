"""A linkage on a turntable, whose angle is a function of time that nothing depends on."""

import random

import numpy as np
import pytest

import lagc
from lagc.simulation.linearization.derivatives import Point

CLOSE = 1e-10  # relative: eigenvalues of small matrices, of equilibria that Newton's method found
LINKAGE = """
model Linkage
  structural Integer n = 3;
  parameter Mass m = 1 [kg];
  parameter Length l = 0.2 [m], r = 0.1 [m];
  parameter AngularVelocity w = 2 [rad/s];
  coordinate Angle th[n], ph[n];
  frame table = TABLE;
  point P[0] = r*table.x;
  for i in 1:n loop
    frame F[i] = rotate_x(rotate_y(table, th[i]), ph[i]);
    point P[i] = P[i-1] - l*F[i].z;
    body b[i] = Particle(mass = m, at = P[i]);
    FORCES
  end for;
  effect gravity
    Gravity field(g = 9.81 [m/s2], direction = {0, 0, -1});
  end gravity;
  scene s uses gravity;
end Linkage;
"""
INERTIAL = """
    force centrifugal[i] = m*w^2*{P[i].x, P[i].y, 0 [m]} at b[i];
    force coriolis[i] = 2*m*w*{velocity(b[i]).y, -velocity(b[i]).x, 0 [m/s]} at b[i];
"""


def varying() -> lagc.CompiledModel:
    return _compiled("rotate_z(world, w*time)", "")


def _compiled(table: str, forces: str) -> lagc.CompiledModel:
    return lagc.loads(LINKAGE.replace("TABLE", table).replace("FORCES", forces)).compile(backend="numpy")


@pytest.mark.full
def test_it_is_that_of_inertial_forces_and_at_no_time_another() -> None:
    """What is rounding beside other derivatives does not depend on time."""
    ours, theirs = (model.equilibria()[0] for model in (varying(), _compiled("world", INERTIAL)))
    assert ours.equilibrium and not ours.time_dependent and not ours.linear and not ours.momentary
    assert ours.stability == theirs.stability and ours.stability is not None
    mine, others = (np.sort_complex(one.eigenvalues) for one in (ours, theirs))
    assert np.abs(mine - others).max() <= CLOSE * np.abs(others).max()


@pytest.mark.sample(1)
@pytest.mark.parametrize("seed", range(3))
def test_derivatives_by_time_are_nothing(seed: int) -> None:
    """Whatever the state: of a column by itself no size tells what is rounding."""
    system, chance = varying().differentiated(), random.Random(seed)
    for _ in range(20):
        x = [chance.uniform(-1.0, 1.0) for _ in range(system.nq + system.nv)]
        assert not Point(system, chance.uniform(0.1, 1.0), x, clean=True).by("time").any()
