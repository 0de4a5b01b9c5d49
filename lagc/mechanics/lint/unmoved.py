"""Coordinates that stay where they are: nothing acts on them, and they have no initial rate."""

from __future__ import annotations

from lagc.diagnostics.faults import Fault
from lagc.mechanics.formulation.equations import EquationsOfMotion
from lagc.semantics.model import UNSTATED
from lagc.symbolic.walk import substitute, symbols

MOST = 6  # names in a message


def unmoved(equations: EquationsOfMotion) -> list[Fault]:
    """Return a warning that names all such coordinates, or none. The speeds v_S of a set S stay 0 if, at v_S
    = 0, the forces on S vanish identically, no constraint holds a speed of S, and the mass matrix couples no
    speed of S to another one."""
    v, graph = equations.v, equations.graph
    left = set(range(len(v))) - _set_in_motion(equations)
    while left:
        order = sorted(left)
        forces = [graph.sub(equations.given_forces[i], equations.bias_forces[i]) for i in order]
        at_rest = substitute(graph, forces, {v[i]: graph.zero for i in order})
        driven = {i for i, force in zip(order, at_rest) if not force.is_zero}
        if not driven:
            coupled = [pair for pair in equations.mass_matrix if (pair[0] in left) != (pair[1] in left)]
            driven = {i for pair in coupled for i in pair} & left
        if not driven:
            break
        left -= driven
    names = _beside_no_motion(equations, left)
    return [_fault(equations, names)] if names else []


def _beside_no_motion(equations: EquationsOfMotion, left: set[int]) -> list[str]:
    """Return the coordinates whose rates depend on the speeds `left` only.  A coordinate of a body that moves
    otherwise is left out, as y is in a motion in the plane x, z."""
    graph, stopped = equations.graph, {equations.v[i]: equations.graph.zero for i in left}
    rates = substitute(graph, equations.qdot, stopped)
    moving = {q.record.owner for q, rate in zip(equations.q, rates) if not rate.is_zero}
    found = {q.record.owner for q in equations.q} - moving
    for body in equations.model.bodies:
        axes = [] if body.frame is None else [x for row in body.frame.axes for x in row]
        found_there = symbols([*body.position, *axes])
        owners = {symbol.record.owner for symbol in found_there}
        if owners & moving or equations.time in found_there:
            found -= owners
    return [thing.name for thing in equations.model.coordinates if thing.name in found]


def _set_in_motion(equations: EquationsOfMotion) -> set[int]:
    """Return the speeds that constraints, initial values, initial equations or events may set."""
    place = {symbol: i for i, symbol in enumerate(equations.v)}
    found = {i for row in equations.rows for i in row.jacobian}
    found |= {i for contact in equations.contacts for row in contact.jacobians for i in row}
    found |= {i for i, start in enumerate(equations.starts_v) if start.stated.level != UNSTATED}
    written = [residual for residual, _ in equations.initial_conditions]
    written += [rate.rate for rate in equations.stated_rates]
    written += [state for clause in equations.whens for state, _ in clause.changes]
    found |= {place[symbol] for symbol in symbols(written) if symbol in place}
    return found


def _fault(equations: EquationsOfMotion, names: list[str]) -> Fault:
    model = equations.model
    first = next(thing for thing in model.coordinates if thing.name == names[0])
    listed = ", ".join(f"`{name}`" for name in names[:MOST]) + (", ..." if len(names) > MOST else "")
    where = f" in the scene `{model.scene}`" if len(model.scenes) > 1 else ""
    own = names[0].partition("[")[0]
    it, has = ("it", "it has") if len(names) == 1 else ("them", "they have")
    message = f"nothing moves {listed}{where}: no force, energy or constraint acts on {it}, and {has} no "
    remedy = f"write a force, an energy, `Gravity field;`, or an initial rate such as `{own}(rate = 1)`"
    return Fault("LAG0429", message + "initial rate", first.span, remedy=remedy, severity="warning")
