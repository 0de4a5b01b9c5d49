"""The forms that the equations can be solved in."""

from __future__ import annotations

from collections.abc import Iterator

from lagc.base.records import replace
from lagc.lowering.kkt.articulated_body import Lifted, lifted, plain, together
from lagc.lowering.kkt.fill_ordering import Elimination, Structure, eliminate
from lagc.lowering.kkt.prune import sources
from lagc.lowering.kkt.solve import Solver
from lagc.mechanics.formulation.equations import EquationsOfMotion
from lagc.symbolic.graph import Node
from lagc.symbolic.walk import symbols

LARGEST = 3000  # operations of a straight solve; beyond, it is a loop
LARGEST_GROWING = 2_000_000  # the same where work grows with the model
LARGEST_SPARSE = 250_000  # the same beside a dense solve, a loop: C compilers take minutes for more
DENSE = 10  # times its operations a straight solve saves, where it is longer than LARGEST
SPARSE = 100  # operations for each unknown that are straight, however many unknowns
_MOST_SPEEDS = 20
_MOST_UNKNOWNS = 100  # speeds and multipliers: beyond, a dense solve is as long as some hundred straight ones
_WORTH = 0.8  # of the operations, at most, where bodies keep their velocities


def forms_matrix(equations: EquationsOfMotion) -> bool:
    """Whether the mass matrix is formed though the equations may be solved without."""
    if equations.rows:
        return len(equations.v) + len(equations.rows) <= _MOST_UNKNOWNS
    return len(equations.v) <= _MOST_SPEEDS


def solvers(equations: EquationsOfMotion) -> Iterator[Solver]:
    """Those that straight-line code is made of."""
    for system in _forms(equations):
        plan = _plan(system)
        if plan is not None:
            yield Solver(system, plan)
            if system.structure.definitions and not forms_matrix(equations):
                return


def _plan(system: Lifted) -> Elimination | None:
    """All lifted velocities substituted, which loses no digits, or bodies' own kept where that is cheaper
    by far, as with many loops."""
    structure, kept = system.structure, None
    most: float = _most(structure)
    if system.heavy and structure.multipliers:
        kept = eliminate(replace(structure, kept=system.heavy), most)
        most = most if kept is None else min(most, kept.flops / _WORTH)
    return eliminate(structure, most) or kept


def _most(structure: Structure) -> int:
    """Operations of a straight solve; a dense one, of n^3/3, is a loop, of little code."""
    if structure.definitions:
        return LARGEST_GROWING
    dense = structure.size**3 // 3
    return max(LARGEST, SPARSE * structure.size, min(LARGEST_SPARSE, dense // DENSE))


def _forms(equations: EquationsOfMotion) -> Iterator[Lifted]:
    known = symbols(sources(equations))
    raised = lifted(equations)
    if raised is not None and _is_made_of(known, raised):
        yield raised
        if not (equations.rows or forms_matrix(equations)):
            return
    apart = plain(equations)
    yield apart
    one = together(equations, apart)
    if any(a is not b for a, b in zip(apart.right, one.right)) and _is_made_of(known, one):
        yield one


def _is_made_of(known: set[Node], system: Lifted) -> bool:
    """Whether `system` reads nothing but those symbols: what cancels where forces are put together, as those
    inside a body do, may not where they are not, and parameters and coordinates may be for nothing else."""
    return symbols([*system.entries.values(), *system.coefficients.values(), *system.right]) <= known
