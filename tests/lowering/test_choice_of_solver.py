"""Where a dense solve takes far more operations a straight one is taken, whatever the size."""

import pytest

from lagc.compiler.pipeline import Compilation
from lagc.compiler.stages import Choice
from lagc.diagnostics.faults import Source
from lagc.lowering.kkt.solve import solvers
from lagc.mechanics.formulation.equations import EquationsOfMotion

NET = """
model Net "knots, joined to their neighbours by rods"
  structural Integer n = 3;
  parameter Length d = 0.3 [m];
  coordinate Length x[n*n], y[n*n], z[n*n];
  for i in 1:n loop
    point P[i, 0] = {i*d, 0, 0};
    for j in 1:n loop
      point P[i, j] = {i*d + x[(i-1)*n+j], y[(i-1)*n+j], -j*d + z[(i-1)*n+j]};
      body knot[i, j] = Particle(mass = 1, at = P[i, j]);
      constraint down[i, j]: norm(P[i, j] - P[i, j-1]) = d;
    end for;
  end for;
  for i in 1:n-1 loop
    for j in 1:n loop
      constraint across[i, j]: norm(P[i+1, j] - P[i, j]) = d;
    end for;
  end for;
end Net;
"""


def net(n: int) -> EquationsOfMotion:
    return Compilation(Source("net.lag", NET), Choice(parameters={"n": n})).equations


@pytest.mark.sample(0, 2)
@pytest.mark.parametrize("n", (6, 7, 9, 12))
def test_a_net_is_solved_by_its_own_structure(n: int) -> None:
    e = net(n)
    (solver,) = solvers(e)
    unknowns = len(e.v) + len(e.rows)
    assert 10 * solver.plan.flops < unknowns**3 / 3
