"""optimize: EquationsOfMotion -> Program."""

from collections.abc import Mapping, Sequence
from math import inf

from lagc.base.records import replace
from lagc.diagnostics.faults import Fault, Refused
from lagc.lowering import program_functions
from lagc.lowering.event_functions import (
    changing,
    contact_functions,
    features,
    in_boxes,
    poles,
    relation_functions,
    whens,
)
from lagc.lowering.event_relations import EventRelation, frozen
from lagc.lowering.interface import bounded, interface, used_parameters
from lagc.lowering.jacobians import condition_slopes, derivatives
from lagc.lowering.kkt import solve as kkt
from lagc.lowering.kkt.articulated_body import plain
from lagc.lowering.kkt.prune import independent, prune, sources, with_pivots
from lagc.lowering.kkt.solve import Solver, forms_matrix, solvers
from lagc.lowering.linearizations import implicit, tangents
from lagc.lowering.loaded_reactions import loaded, loads_of
from lagc.lowering.loop_rolling import rerolled
from lagc.lowering.program import Function, Program
from lagc.lowering.scalar.parameter_hoisting import Preparation
from lagc.lowering.scalar.scheduling import balanced
from lagc.lowering.series import NoSeries, series
from lagc.lowering.storage import Places, places, weight
from lagc.mechanics.formulation.equations import EquationsOfMotion
from lagc.symbolic.derivative import Slopes
from lagc.symbolic.graph import Node

# Called at every stage of a step.
OFTEN = ("rhs", "watch", "system", "residual", "contact_rows", "frictions")

FAR = 1.2  # times the operations of the best form: another one with the same matrix is no better


def optimize(
    equations: EquationsOfMotion, work: bool = False, differentiate: bool = False, sensitive: bool = False,
    stiff: bool = False, expand: bool = False, directional: bool = False,
) -> Program:  # fmt: skip
    """Return the program of `equations`. `work` adds the integral of the power to the
    state where the power is not identically zero, `differentiate` the functions of `lagc.lowering.jacobians`
    (`directional`: along directions alone), `sensitive` those of `tangents`, `stiff` those of `implicit`,
    `expand` those of `series`.
    Raises Refused with LAG0501 where a coordinate has no inertia of any kind."""
    # Parts that nothing needs go; the rest is frozen on branches between events.
    equations, left_out = prune(equations)
    equations = with_pivots(equations)
    equations = replace(equations, model=bounded(equations.model))
    moving, relations = frozen(equations)
    equations, moving = changing(equations, moving, relations)
    jumps = any(when.changes for when in equations.whens)
    work = work and (jumps or bool(equations.contacts) or not equations.power.is_zero)
    # Where the values of symbols are found, on the state alone and along a branch.
    parameters = used_parameters(equations, _roots(equations))
    loads = loads_of(moving)
    whole = places(moving, parameters, [relation.mode for relation in relations], int(work))
    at = places(equations, parameters, nz=int(work))
    along = whole if loads is None else replace(whole, equations=loads.rest)
    # The form of the linear equations that takes the fewest operations; what depends on parameters alone
    # is separated from each function.
    solver, solving = _solver(along, work)
    system = solver.system if solver else plain(equations)
    preparation = Preparation(len(parameters), len(parameters) + len(equations.model.inputs))
    dense = solver is None or forms_matrix(equations)
    made, slopes = _functions(at, along, relations, solver, solving, work, dense, preparation)
    # Loads that depend on reactions are solved beside the equations without them.
    more = [loaded(whole, loads)] if loads else []
    power = program_functions.power(whole) if loads and loads.pushed else None
    more += [power] if power else []
    # Functions that are asked for in addition: derivatives, sensitivities, implicit methods, series.
    factored = solver if equations.rows or equations.contacts or differentiate or sensitive else None
    differentiated = derivatives(whole, relations, directional) if differentiate else None
    derived = [*(differentiated.functions if differentiated else ()), *(tangents(whole) if sensitive else ())]
    more += _factor_functions(along, solver, False) if derived and solver and not equations.rows else ()
    more += [*derived, *(implicit(whole) if stiff and not equations.contacts else ())]
    made.update((f.name, preparation.separated(f)) for f in more)
    found, read = preparation.finished(made)
    if expand:
        found.update((f.name, f) for f in _series(equations, found, work, loads is not None))
    # Repeated operations become loops at last, when nothing else changes them.
    found = {name: rerolled(function, often=name in OFTEN) for name, function in found.items()}
    return Program(
        interface(
            equations, parameters, found, slopes, loads.described() if loads else {},
            read=read, work=work, straight=solver is not None, relations=relations,
            work_size=kkt.work_size(factored, bool(equations.rows) and not dense) if factored else 0,
            health=dict(found["rhs"].outputs)["health"] if solver else 0,
            operations=_operations(equations, found),
            velocity_unknowns=len(system.structure.definitions),
            dropped=left_out,
            remarks=independent(equations, system),
            derivatives=differentiated.patterns if differentiated else {},
        ),
        found,
    )  # fmt: skip


def _roots(equations: EquationsOfMotion) -> list[Node]:
    """Return every node that a function may store."""
    others = [x.value for x in equations.model.limits] + [x.start for x in equations.model.discretes]
    return [*equations.qdot, *(s.value for s in equations.starts), *others, *sources(equations)]


def _series(
    equations: EquationsOfMotion, found: Mapping[str, Function], work: bool, loaded: bool
) -> list[Function]:
    """Return the functions of the Taylor series of the right-hand side. Raises Refused (LAG0591) if it has an
    operation without a recurrence."""
    reason = "its equations are solved by a loop over a dense matrix"
    if loaded:
        reason = "its loads depend on reactions"
    elif "rhs" in found:
        try:
            return series(found["rhs"], len(equations.q) + len(equations.v) + int(work))
        except NoSeries as missing:
            reason = f"there is no recurrence for {missing}"
    message = f"the method taylor cannot expand the motion of `{equations.model.name}`: {reason}"
    raise Refused([Fault("LAG0591", message, remedy="take another method: --method dop853")])


def _solver(at: Places, work: bool) -> tuple[Solver | None, list[Function]]:
    """Return the form of the equations with the fewest operations, and the functions `rhs` and `watch` of it;
    None and no functions if no form can be solved by straight-line code."""
    # Forms are printed and weighed: the number of operations of the right-hand side decides.
    best: tuple[Solver | None, list[Function]] = (None, [])
    least = inf
    for solver in solvers(at.equations):
        made = kkt.rhs(at, solver, work)
        operations = weight(made[0], len(at.constants))
        if operations < least:
            best, least = (solver, made), operations
        elif operations > FAR * least:  # the last two forms are alike
            break
    return best


def _functions(
    at: Places,
    along: Places,
    relations: Sequence[EventRelation],
    solver: Solver | None,
    solving: Sequence[Function],
    work: bool,
    dense: bool,
    preparation: Preparation,
) -> tuple[dict[str, Function], Slopes]:
    """Return the functions, and the derivatives of the initial equations. `at` has the equations on the state
    alone; `along` those on the branches of a run, which differ if there are relations."""
    constrained = bool(at.equations.rows)
    made: list[Function | None] = [*solving]
    # The linear equations: as a matrix, or as factors with what checks them.
    if dense:
        made.append(program_functions.system(along, rare=solver is not None))
    if solver is not None and constrained:
        made += _factor_functions(along, solver, not dense)
        made += [kkt.refiner(solver)] if dense else [kkt.remainder(solver), program_functions.forces(along)]
    if solver is not None and not constrained and at.equations.contacts:
        made += _factor_functions(along, solver, False)
    made.append(program_functions.displace(at))
    # The constraints: residuals, rates, and the sizes that they are measured by.
    if constrained:
        made += [program_functions.position(at), program_functions.velocity(at), program_functions.scales(at)]
        made += [program_functions.gamma_sizes(at), program_functions.gradient_sizes(at)]
        made += [] if dense else [program_functions.gradients(at)]
        made.append(program_functions.reaches(at))
    made += [program_functions.energies(at), program_functions.power(along), program_functions.outputs(at)]
    made.append(program_functions.start(at, work))
    # The conditions of a start, and the functions of events.
    slopes = condition_slopes(at.equations)
    made += [program_functions.conditions(at, slopes), program_functions.measures(at)]
    made += [program_functions.limits(at), *relation_functions(at, along, relations)]
    made += [*whens(at, along), *contact_functions(at, along)]
    made += in_boxes(along, features(along.equations), "feature", "terms that may be narrow")
    made += in_boxes(along, poles(along.equations), "pole", "divisors that may come near zero")
    found = {f.name: preparation.separated(f) for f in made if f is not None}
    if solver is not None and constrained:
        found.update((f.name, balanced(found[f.name])) for f in solving)
    return found, slopes


def _factor_functions(along: Places, solver: Solver, guarded: bool) -> list[Function]:
    """Return the functions that solve for any right-hand side."""
    return [kkt.assemble(along, solver, guarded), kkt.factorize(solver, guarded), kkt.solve(solver)]


def _operations(equations: EquationsOfMotion, found: Mapping[str, Function]) -> int:
    """Return the operations of one right-hand side while all contacts touch; a dense solve counts n^3/3."""
    # The equations without contacts; n^3/3 multiplications of the dense factorization, 2 n^2 of the solve.
    n = len(equations.v) + len(equations.rows)
    free = found["rhs"].cost if "rhs" in found else found["system"].cost + n * n * n // 3 + 2 * n * n
    return free + (_contact_operations(equations, found) if equations.contacts else 0)


def _contact_operations(equations: EquationsOfMotion, found: Mapping[str, Function]) -> int:
    """Return the operations of the forces of contacts: rows R, X = K^-1 R^T, W = R X, its solve, and X p."""
    rows, n = sum(len(contact.jacobians) for contact in equations.contacts), len(equations.v)

    def cost(*names: str) -> int:
        return sum(found[name].cost for name in names if name in found)

    solve = cost("solve") or 2 * n * n
    terms = cost("contact_rows", "frictions", "normals", "assemble", "factor") + rows * solve
    return terms + 2 * rows * rows * n + rows * rows * rows // 3 + 4 * rows * n
