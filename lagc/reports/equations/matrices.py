"""The equations of motion as SymPy matrices, for people's own algebra."""

from __future__ import annotations

from typing import Any, NamedTuple

from lagc.mechanics.formulation.equations import EquationsOfMotion


class Matrices(NamedTuple):
    """M a + h = tau + G^T lam, G a = gamma, qdot = N v + n; all in the symbols `q`, `v` and those of
    the parameters, which are real and carry the names of the model.

    Shapes: q (nq, 1), v (nv, 1), qdot (nq, 1), mass_matrix (nv, nv), bias_forces and given_forces (nv, 1),
    constraint_jacobian (nc, nv), gamma (nc, 1).
    """

    q: Any
    v: Any
    qdot: Any
    mass_matrix: Any
    bias_forces: Any
    given_forces: Any
    constraint_jacobian: Any
    gamma: Any


def matrices(equations: EquationsOfMotion) -> Matrices:
    """Raises ImportError, with what to install, where SymPy is missing."""
    try:
        import sympy
    except ModuleNotFoundError:
        raise ImportError("matrices need SymPy: pip install sympy") from None
    from lagc.symbolic.sympy import to_sympy

    zero, nv, nc = equations.graph.zero, len(equations.v), len(equations.rows)
    pairs = [(max(i, j), min(i, j)) for i in range(nv) for j in range(nv)]
    parts = [
        list(equations.q),
        list(equations.v),
        list(equations.qdot),
        [equations.mass_matrix.get(pair, zero) for pair in pairs],
        list(equations.bias_forces),
        list(equations.given_forces),
        [row.jacobian.get(j, zero) for row in equations.rows for j in range(nv)],
        [row.gamma for row in equations.rows],
    ]
    found = iter(to_sympy([node for part in parts for node in part]))
    shapes = [(len(part), 1) for part in parts]
    shapes[3], shapes[6] = (nv, nv), (nc, nv)
    filled = [
        sympy.Matrix(*shape, [next(found) for _ in part]) for shape, part in zip(shapes, parts, strict=True)
    ]
    return Matrices(*filled)
