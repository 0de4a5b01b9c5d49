"""The forms that the equations can be solved in."""

from __future__ import annotations

from collections.abc import Iterator
from math import inf

from lagc.mechanics.equations import EquationsOfMotion
from lagc.optimize.elimination import eliminate
from lagc.optimize.kkt import Solver
from lagc.optimize.lift import Lifted, lifted, plain, together

MOST_SPEEDS = 20  # of a system whose mass matrix is formed though it may be solved without


def solvers(equations: EquationsOfMotion, most: float = inf) -> Iterator[Solver]:
    """Those of about `most` operations at most."""
    for system in _forms(equations):
        plan = eliminate(system.structure)
        if plan is None:
            continue
        solver = Solver(system, plan)
        if solver.size <= most:
            yield solver


def _forms(equations: EquationsOfMotion) -> Iterator[Lifted]:
    raised = lifted(equations)
    if raised is not None:
        yield raised
    if raised is None or len(equations.v) <= MOST_SPEEDS:
        apart = plain(equations)
        yield apart
        one = together(equations, apart)
        if any(a is not b for a, b in zip(apart.right, one.right)):
            yield one
