"""Functions of the equations and their derivatives, for implicit methods and for sensitivities.

Implicit methods have the equations of a stage and their derivatives:

residual  (p,t,x,a,lam) -> qdot[nq], e[nv+nc]   e = (M a - f - G^T lam; psi)
newton    (p,t,x,a,lam) -> J[n*n], B[nv*nv]     J by (q, v, lam) of (-qdot; e), n = nq+nv+nc; B = M
newton_column (p,t,x,a,lam,d) -> s[n]           in its place where that is long: what (-qdot; e) changes
                                                by along a direction d in (q, v, lam, a)

Sensitivities have changes along a direction in q, v and parameters:

tangent  (p,t,x,a,lam,dx,dp) -> dqdot[nq], dr[nv+nc]   of qdot and -(M a - f - G^T lam; G a - gamma)
tied     (p,t,x,dx,dp)       -> c[nh+nc]               of phi and psi
"""

from lagc.base.records import replace
from lagc.lowering.jacobians import condition_rows, entangled, groups, motion_by_entries, motion_by_sweeps
from lagc.lowering.program import Function
from lagc.lowering.program_functions import made, matrix
from lagc.lowering.storage import STATE, Places
from lagc.symbolic.derivative import gradient, tangent

MOST = 4  # times that a sweep for each row may pass each part of the equations


def implicit(places: Places) -> list[Function]:
    """Return these functions."""
    equations, graph = places.equations, places.graph
    rates = [row.rate for row in equations.rows]
    motion = motion_by_sweeps(equations)
    forces = [graph.sub(own, force) for own, force in zip(motion["inertia"], motion["force"])]
    inputs = (*places.state, "a", "lam")
    parts = (("qdot", equations.qdot), ("e", [*forces, *rates]))
    residual = made(places, "residual", inputs, parts, "residual of the equations")
    unknowns = [*equations.q, *equations.v, *equations.lam]
    # Where entries of the Jacobian would take more operations than all columns, one column is a function of
    # its direction; otherwise entries are printed.
    negative = [graph.scale(-1.0, rate) for rate in equations.qdot]
    if entangled([*equations.qdot, *forces, *rates], unknowns, MOST):
        seeds = {x: graph.symbol("direction", str(k)) for k, x in enumerate([*unknowns, *equations.a])}
        ahead = replace(
            places, arrays={**places.arrays, **{d: ("d", k) for k, d in enumerate(seeds.values())}}
        )
        column = tangent(graph, [*negative, *forces, *rates], seeds)
        described = "changes of the equations along a direction"
        return [residual, made(ahead, "newton_column", (*inputs, "d"), (("s", column),), described)]
    motion = motion_by_entries(equations)
    forces = [graph.sub(own, force) for own, force in zip(motion["inertia"], motion["force"])]
    rows = [*negative, *forces, *rates]
    places_of = {x: k for k, x in enumerate(unknowns)}
    slopes = {}
    for i, row in enumerate(rows):
        found = gradient(graph, {row: graph.one}, places_of)
        slopes.update({i * len(unknowns) + places_of[x]: slope for x, slope in found.items()})
    n = len(equations.v)
    mass = {}
    for (i, j), node in sorted(equations.mass_matrix.items()):
        mass[i * n + j] = mass[j * n + i] = node
    outputs = (("J", matrix(places, slopes, len(unknowns) ** 2)), ("B", matrix(places, mass, n * n)))
    newton = made(places, "newton", inputs, outputs, "derivatives of the equations by states and multipliers")
    return [residual, newton]


def tangents(places: Places) -> list[Function]:
    """Return these functions; accelerations and multipliers are given, and stay."""
    equations, graph, by = places.equations, places.graph, groups(places)
    dx = {x: graph.symbol("direction", f"x{k}") for k, x in enumerate(by["state"])}
    dp = {p: graph.symbol("direction", f"p{k}") for k, p in enumerate(by["parameter"])}
    arrays = dict(places.arrays)
    for array, seeds in (("dx", dx), ("dp", dp)):
        arrays.update((d, (array, k)) for k, d in enumerate(seeds.values()))
    ahead, seeds = replace(places, arrays=arrays), dx | dp
    motion, nq, nv = motion_by_sweeps(equations), len(equations.q), len(equations.v)
    forces = [graph.sub(force, inertia) for force, inertia in zip(motion["force"], motion["inertia"])]
    found = tangent(graph, [*equations.qdot, *forces, *motion["row"]], seeds, norms=True)
    change = [*found[nq : nq + nv], *(graph.scale(-1.0, row) for row in found[nq + nv :])]
    inputs = (*places.state, "a", "lam", "dx", "dp")
    parts = (("dqdot", found[:nq]), ("dr", change))
    functions = [made(ahead, "tangent", inputs, parts, "changes of qdot and of the equations of motion")]
    if equations.rows:
        count = len(equations.rows) + sum(1 for row in equations.rows if row.holonomic)
        rows = tangent(graph, condition_rows(equations)[:count], seeds)
        functions.append(
            made(ahead, "tied", (*STATE, "dx", "dp"), (("c", rows),), "changes of the constraints")
        )
    return functions
