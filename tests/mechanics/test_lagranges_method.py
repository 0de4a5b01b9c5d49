"""The standard systems against sympy's LagrangesMethod, which knows Lagrangians and no virtual power."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import sympy
from sympy.physics import mechanics

from lagc.mechanics.derive import derive
from lagc.semantics.model import Coordinate, Force, Model, Potential
from lagc.symbolic.sympy import to_sympy
from tests.mechanics.models import ALL
from tests.mechanics.numbers import jacobian, mass_matrix, random_state, vector

T = mechanics.dynamicsymbols._t
NAMES = ["pendulum", "double pendulum", "string pendulum", "knife edge", "rheonomic disc"]
CLOSE = 1e-12


def lagranges_method(model: Model) -> tuple[Any, list[Any], list[Any]]:
    """The method's object, and sympy's coordinates and rates."""
    coordinates = [c for c in model.coordinates if isinstance(c, Coordinate)]
    q = [sympy.Function(c.name)(T) for c in coordinates]
    names = {c.symbol: x for c, x in zip(coordinates, q)}
    names |= {c.rate_symbol: x.diff(T) for c, x in zip(coordinates, q)}
    names[model.time] = T
    names |= {p.symbol: sympy.Symbol(p.name) for p in model.parameters}

    def convert(*nodes: Any) -> list[Any]:
        return to_sympy(nodes, names.__getitem__)

    kinetic: Any = 0
    for body in model.bodies:
        velocity = [x.diff(T) for x in convert(*body.position)]
        kinetic += convert(body.mass)[0] * sum(u * u for u in velocity) / 2
        if body.frame is not None and body.inertia is not None:
            axes = sympy.Matrix(3, 3, convert(*(x for row in body.frame.axes for x in row)))
            skew = axes.T * axes.diff(T)
            w = sympy.Matrix([skew[2, 1], skew[0, 2], skew[1, 0]])
            inertia = sympy.Matrix(3, 3, convert(*(x for row in body.inertia for x in row)))
            kinetic += (w.T * inertia * w)[0] / 2
    lagrangian = kinetic - sum(convert(a.energy)[0] for a in model.actions if isinstance(a, Potential))
    frame = mechanics.ReferenceFrame("N")
    forces = []
    for action in model.actions:
        if isinstance(action, Force):
            point = mechanics.Point(action.name)
            u, f = convert(*action.velocity), convert(*action.vector)
            point.set_vel(frame, u[0] * frame.x + u[1] * frame.y + u[2] * frame.z)
            forces.append((point, f[0] * frame.x + f[1] * frame.y + f[2] * frame.z))
    rows = {r.label: r for r in derive(model).rows}
    holonomic, velocity_rows = [], []
    for c in model.constraints:
        for label, residual in zip(c.labels, c.residuals):
            if label in rows:
                (holonomic if rows[label].holonomic else velocity_rows).append(convert(residual)[0])
    method = mechanics.LagrangesMethod(
        lagrangian, q, forcelist=forces, frame=frame, hol_coneqs=holonomic, nonhol_coneqs=velocity_rows
    )
    method.form_lagranges_equations()
    return method, q, [x.diff(T) for x in q]


@pytest.mark.sample(1)
@pytest.mark.parametrize("name", NAMES)
def test_same_matrices_as_sympy(name: str) -> None:
    model = ALL[name]()
    e = derive(model)
    method, q, rates = lagranges_method(model)
    state = random_state(e, 7)
    values = {sympy.Symbol(p.name): state[p.symbol] for p in model.parameters} | {T: state[e.time]}
    moving = dict(zip(rates, [state[x] for x in e.v]))
    placed = dict(zip(q, [state[x] for x in e.q]))

    def number(matrix: Any) -> Any:
        return np.array(sympy.Matrix(matrix).subs(moving).subs(placed).subs(values).evalf(), dtype=float)

    n = len(e.v)
    damping = vector([c.forces.get(i, e.graph.zero) for c in e.contributions if c.kind == "dissipation"
                      for i in range(n)], state).reshape(-1, n).sum(axis=0)  # fmt: skip
    # sympy: M a = forcing; it has no dissipation functions
    forcing = vector(e.given_forces, state) - vector(e.bias_forces, state) - damping
    assert np.allclose(mass_matrix(e, state), number(method.mass_matrix[:, :n]), rtol=CLOSE, atol=CLOSE)
    assert np.allclose(forcing, number(method.forcing[:n, :]).ravel(), rtol=CLOSE, atol=CLOSE * 10)
    if e.rows:
        # sympy's multipliers stand on the side of the accelerations: M a + lam_coeffs^T lam = forcing
        assert np.allclose(jacobian(e, state), -number(method.lam_coeffs), rtol=CLOSE, atol=CLOSE)
