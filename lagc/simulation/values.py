"""The values of all symbols of the equations of motion at a state."""

from __future__ import annotations

from collections.abc import Sequence

from lagc.mechanics.formulation.equations import EquationsOfMotion
from lagc.simulation.backends.python import NumpySystem
from lagc.simulation.system import System
from lagc.symbolic.graph import Node


def values_at(
    equations: EquationsOfMotion, system: System, t: float, x: Sequence[float], forces: bool = True
) -> dict[Node, float]:
    """Return the values of time, parameters, inputs, states and discrete variables at (t, x), in SI units.
    With `forces` also accelerations, multipliers and, if `system` is one in Python, forces of contacts; those
    that are not determined there have no meaning."""
    interface, model = system.interface, equations.model
    given = dict(zip([f.name for f in (*interface.parameters, *interface.inputs)], system.parameters))
    names = [*((p.symbol, p.name) for p in model.parameters), *((u.symbol, u.name) for u in model.inputs)]
    found = {equations.time: t, **{symbol: given[name] for symbol, name in names if name in given}}
    moving = system.nq + system.nv
    found.update(zip((*equations.q, *equations.v), x))
    found.update(zip([d.symbol for d in model.discretes], x[moving + system.nz :]))
    if forces:
        a, lam = system.accelerations(t, x)
        found.update(zip((*equations.a, *equations.lam), (*a, *lam)))
        if equations.contacts and isinstance(system, NumpySystem):
            own = [force for contact in equations.contacts for force in contact.forces]
            found.update(zip(own, system.contact_forces))
    return found
