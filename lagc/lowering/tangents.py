"""The functions of sensitivities: changes along a direction in q, v and parameters.

tangent  (p,t,x,a,lam,dx,dp) -> dqdot[nq], dr[nv+nc]   of qdot and -(M a - f - G^T lam; G a - gamma)
tied     (p,t,x,dx,dp)       -> c[nh+nc]               of phi and psi
"""

from __future__ import annotations

from lagc.base.records import replace
from lagc.lowering.jacobians import condition_rows, groups, motion_by_sweeps
from lagc.lowering.program import Function
from lagc.lowering.program_functions import made
from lagc.lowering.storage import STATE, Places
from lagc.symbolic.derivative import tangent


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
