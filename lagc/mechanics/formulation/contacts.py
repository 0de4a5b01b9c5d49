"""Rows of the one-sided constraints: gap, its rate and its acceleration in the speeds.

    gap(t,q) >= 0      d(gap)/dt = R v + d(gap)/dt|_q      d2(gap)/dt2 = R a + bias
    slip(t,q,v)                                            d(slip)/dt = R_t a + bias_t

F. Pfeiffer, C. Glocker, Multibody Dynamics with Unilateral Contacts, Wiley 1996, chapter 5.
"""

from __future__ import annotations

from collections.abc import Mapping

from lagc.diagnostics.faults import Fault, Refused
from lagc.mechanics.formulation.equations import ContactRow, SlipRow
from lagc.mechanics.formulation.jacobian import gradients
from lagc.mechanics.formulation.slips import along_surface
from lagc.mechanics.formulation.states import States
from lagc.semantics.model import Contact
from lagc.symbolic.derivative import tangent
from lagc.symbolic.graph import Node
from lagc.symbolic.walk import symbols


def contact_rows(states: States, friction: bool = True) -> tuple[ContactRow, ...]:
    """Return the rows of the model's contacts in the order of declaration, their slip rows if `friction`."""
    contacts, graph = states.model.contacts, states.graph
    if not contacts:
        return ()
    gaps = states.in_speeds([c.gap for c in contacts])
    rates = tangent(graph, gaps, states.drift)
    biases = tangent(graph, rates, states.drift)
    jacobians = gradients(graph, rates, states.place_of_v)
    restitutions = states.in_speeds([c.restitution for c in contacts])
    return tuple([
        ContactRow(c, graph.symbol("multiplier", c.label), gap, rate, jacobian, bias, restitution,
                   *(_friction(states, c, jacobian) if friction else ()))
        for c, gap, rate, jacobian, bias, restitution in zip(
            contacts, gaps, rates, jacobians, biases, restitutions)
    ])  # fmt: skip


def _friction(
    states: States, contact: Contact, normal: Mapping[int, Node]
) -> tuple[tuple[SlipRow, ...], tuple[Node, ...]]:
    """Return the slip rows of a contact and the coefficients of friction while it slips and while it sticks,
    none without. `normal` is the gradient of its normal row. Raises Refused if a slip is not linear in v."""
    if contact.friction is None:
        return (), ()
    rates, factor = along_surface(states, contact, normal)
    biases = tangent(states.graph, rates, states.drift)
    jacobians = gradients(states.graph, rates, states.place_of_v)
    speeds = frozenset(states.place_of_v)
    for jacobian in jacobians:
        if not jacobian or symbols(list(jacobian.values())) & speeds:
            message = f"the slip of `{contact.label}` is not a velocity: it is not linear in the speeds"
            remedy = "write the velocity with which it slides: `slip = der(x)`"
            raise Refused([Fault("LAG0235", message, contact.span, remedy=remedy)])
    given = states.in_speeds([contact.friction, contact.static or contact.friction])
    rows = [SlipRow(*row) for row in zip(rates, jacobians, biases)]
    return tuple(rows), tuple([factor * node for node in given])
