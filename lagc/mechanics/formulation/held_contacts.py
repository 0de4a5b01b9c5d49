"""A model in one mode of its contacts: what touches becomes equations and loads.

A contact that touches is the constraint gap = 0. If it sticks, its slips are zero too. If it slides, the
friction mu p_n is a load against the slip (F. Pfeiffer, C. Glocker, Multibody Dynamics with Unilateral
Contacts, 1996, 5.2). An open contact is nothing.
"""

from __future__ import annotations

from collections.abc import Sequence

from lagc.base.records import replace
from lagc.diagnostics.faults import Fault, Refused
from lagc.mechanics.formulation.jacobian import gradients
from lagc.mechanics.formulation.slips import along_surface
from lagc.mechanics.formulation.states import States, build_states
from lagc.semantics.model import Action, Constraint, Contact, Force, Model, Torque
from lagc.semantics.units import S, over, si_text
from lagc.semantics.units import unit as unit_of
from lagc.symbolic.derivative import tangent
from lagc.symbolic.graph import Node
from lagc.symbolic.vectors import norm
from lagc.symbolic.walk import substitute
from lagc.syntax.tree import Name

MODE_STICKS = 2


def hold_contacts(model: Model, modes: Sequence[int]) -> Model:
    """Return `model` without contacts, in these modes: 0 open, 1 and -1 sliding forwards and backwards or
    without friction, 2 sticking. The multiplier of a contact is still its push; those of a contact `c` that
    sticks are `c.slip[1]`, `c.slip[2]`. Raises Refused, LAG0623, for friction of two-sided contacts."""
    for contact in model.contacts:
        if contact.normals:
            message = f"linear models do not follow {contact.title} yet"
            raise Refused([Fault("LAG0623", message, contact.span, remedy=contact.otherwise)])
    states = build_states(model)
    constraints, loads = list(model.constraints), _without(model, modes)
    for contact, mode in zip(model.contacts, modes):
        if mode:
            slips, factor = _slips(states, contact)
            constraints.append(_closed(contact, slips if mode == MODE_STICKS else []))
            if slips and mode != MODE_STICKS:
                loads.append(_sliding(model, contact, mode, slips, factor))
    own = {contact.state for contact in model.contacts}
    return replace(
        model,
        constraints=tuple(constraints),
        actions=tuple(loads),
        contacts=(),
        discretes=tuple([d for d in model.discretes if d.symbol not in own]),
        released=None if model.released is None else hold_contacts(model.released, modes),
    )


def _without(model: Model, modes: Sequence[int]) -> list[Action]:
    """Return the actions where the pushes of open contacts, on which loads may depend, are zero."""
    graph = model.graph
    pushes = {
        graph.symbol("multiplier", contact.label): graph.zero
        for contact, mode in zip(model.contacts, modes)
        if not mode
    }
    found: list[Action] = []
    for action in model.actions:
        if isinstance(action, Force | Torque):
            x, y, z = substitute(graph, list(action.vector), pushes)
            found.append(replace(action, vector=(x, y, z)))
        else:
            found.append(action)
    return found


def _slips(states: States, contact: Contact) -> tuple[list[Node], Node]:
    """Return the velocities with which a contact slides, in rates if they are given, and the normal force
    over that along the gap."""
    one = states.graph.one
    if len(contact.slip) < 3:
        return list(contact.slip), one
    (gap,) = states.in_speeds([contact.gap])
    rates = tangent(states.graph, [gap], states.drift)
    return along_surface(states, contact, gradients(states.graph, rates, states.place_of_v)[0])


def _closed(contact: Contact, slips: Sequence[Node]) -> Constraint:
    """Return the equations of a contact that touches, and does not slip along `slips`."""
    velocity = si_text(over(unit_of(contact.unit or "1").dimension, S))
    labels = [contact.label, *(f"{contact.label}.slip[{k + 1}]" for k in range(len(slips)))]
    place = Name(contact.label, contact.span)
    return Constraint(
        contact.label, tuple(labels), (contact.gap, *slips),
        (contact.unit, *([velocity] * len(slips))), contact.span, place, place, contact.effect,
    )  # fmt: skip


def _sliding(model: Model, contact: Contact, mode: int, slips: Sequence[Node], factor: Node) -> Force:
    """Return the friction of a contact that slides, as a load of its push on the slip."""
    graph, zero = model.graph, model.graph.zero
    assert contact.friction is not None
    force = -contact.friction * factor * graph.symbol("multiplier", contact.label)
    if len(slips) == 1:
        vector, along = (graph.const(float(mode)) * force, zero, zero), (slips[0], zero, zero)
    else:
        along = (slips[0], slips[1], zero)
        speed = norm(along)
        vector = (force * slips[0] / speed, force * slips[1] / speed, zero)
    return Force(contact.label, vector, along, contact.span, contact.effect)
