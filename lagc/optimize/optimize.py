"""optimize: EquationsOfMotion -> Program."""

from __future__ import annotations

from collections.abc import Mapping

from lagc.expr.graph import Node
from lagc.expr.walk import reachable
from lagc.mechanics.equations import EquationsOfMotion
from lagc.optimize import functions, kkt
from lagc.optimize.balance import balanced
from lagc.optimize.interface import interface, used_parameters
from lagc.optimize.ldlt import Elimination, Entry, flops
from lagc.optimize.limits import bounded
from lagc.optimize.massless import with_pivots
from lagc.optimize.preparation import Preparation
from lagc.optimize.program import Function, Program
from lagc.optimize.prune import independent, prune, sources
from lagc.optimize.symbols import Places, places
from lagc.records import replace

LARGEST = 3000  # operations of a straight right-hand side; beyond, the solve is a loop
SPARSE = 30  # operations for each unknown that are straight, however many unknowns


def optimize(equations: EquationsOfMotion, work: bool = False) -> Program:
    """The functions of `equations`, each as short as it gets.

    `work` adds the integral of the power to the state where the power is not identically zero.
    Raises Refused with LAG0501 where a coordinate has no inertia of any kind.
    """
    equations, left_out = prune(equations)
    equations = with_pivots(equations)
    equations = replace(equations, model=bounded(equations.model))
    work = work and not equations.power.is_zero
    parameters = used_parameters(equations, _roots(equations))
    at = places(equations, parameters)
    entries = kkt.kkt_entries(equations)
    plan = _straight(equations, entries)
    preparation = Preparation(len(parameters), len(parameters) + len(equations.model.inputs))
    found, read = preparation.finished(_functions(at, entries, plan, work, preparation))
    return Program(
        interface(
            equations,
            parameters,
            found,
            read=read,
            work=work,
            straight=plan is not None,
            work_size=kkt.work_size(plan) if plan and equations.rows else 0,
            operations=_operations(equations, found, plan),
            dropped=left_out,
            remarks=independent(equations),
        ),
        found,
    )


def _roots(equations: EquationsOfMotion) -> list[Node]:
    """Every node that any function stores."""
    limits = [limit.value for limit in equations.model.limits]
    return [*equations.qdot, *(s.value for s in equations.starts), *limits, *sources(equations)]


def _straight(equations: EquationsOfMotion, entries: Mapping[Entry, Node]) -> Elimination | None:
    """The elimination, where the right-hand side stays within `LARGEST` operations, or as many for each
    unknown as where little is coupled."""
    most = max(LARGEST, SPARSE * (len(equations.v) + len(equations.rows)))
    if len(entries) > most:
        return None
    right = [*kkt.applied_forces(equations), *(row.gamma for row in equations.rows)]
    size = len(reachable([*entries.values(), *right]))
    if size > 2 * most:
        return None
    plan = kkt.order_of(equations, entries)
    return plan if plan and size + flops(plan) <= most else None


def _functions(
    at: Places,
    entries: Mapping[Entry, Node],
    plan: Elimination | None,
    work: bool,
    preparation: Preparation,
) -> dict[str, Function]:
    constrained = bool(at.equations.rows)
    made: list[Function | None] = []
    if plan is not None:
        made.append(kkt.rhs(at, entries, plan, work))
    made.append(functions.system(at, seldom=plan is not None))
    if plan is not None and constrained:
        made += [kkt.assemble(at, entries, plan), kkt.factorize(plan), kkt.solver(plan), kkt.refiner(plan)]
    made.append(functions.displace(at))
    if constrained:
        made += [functions.position(at), functions.velocity(at), functions.scales(at)]
        made += [functions.gamma_sizes(at), functions.gradient_sizes(at)]
        made.append(functions.reaches(at))
    made += [functions.energies(at), functions.power(at), functions.outputs(at)]
    made += [functions.start(at, work), functions.conditions(at), functions.measures(at)]
    made.append(functions.limits(at))
    found = {f.name: preparation.separated(f) for f in made if f is not None}
    if plan is not None and constrained:
        found["rhs"] = balanced(found["rhs"])
    return found


def _operations(equations: EquationsOfMotion, found: Mapping[str, Function], plan: Elimination | None) -> int:
    """Of one right-hand side; the dense solve of a looped one counts n^3/3."""
    if plan is not None:
        return found["rhs"].cost
    n = len(equations.v) + len(equations.rows)
    return found["system"].cost + n * n * n // 3 + 2 * n * n
