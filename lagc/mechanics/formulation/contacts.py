"""Rows of the one-sided constraints: gap, its rate and its acceleration in the speeds.

    gap(t,q) >= 0      d(gap)/dt = R v + d(gap)/dt|_q      d2(gap)/dt2 = R a + bias
    slip(t,q,v)                                            d(slip)/dt = R_t a + bias_t

F. Pfeiffer, C. Glocker, Multibody Dynamics with Unilateral Contacts, Wiley 1996, chapter 5.
"""

from __future__ import annotations

from lagc.diagnostics.faults import Fault, Refused
from lagc.mechanics.formulation.equations import ContactRow, SlipRow
from lagc.mechanics.formulation.jacobian import gradients
from lagc.mechanics.formulation.states import States
from lagc.symbolic.derivative import tangent
from lagc.symbolic.walk import symbols


def contact_rows(states: States) -> tuple[ContactRow, ...]:
    """Return the rows of the model's contacts in the order of declaration."""
    contacts, graph = states.model.contacts, states.graph
    if not contacts:
        return ()
    gaps = states.in_speeds([c.gap for c in contacts])
    rates = tangent(graph, gaps, states.drift)
    biases = tangent(graph, rates, states.drift)
    jacobians = gradients(graph, rates, states.place_of_v)
    restitutions = states.in_speeds([c.restitution for c in contacts])
    slips = iter(_slip_rows(states))
    return tuple([
        ContactRow(c, graph.symbol("multiplier", c.label), gap, rate, jacobian, bias, restitution,
                   None if c.slip is None else next(slips))
        for c, gap, rate, jacobian, bias, restitution in zip(
            contacts, gaps, rates, jacobians, biases, restitutions)
    ])  # fmt: skip


def _slip_rows(states: States) -> list[SlipRow]:
    """Return the slip rows of contacts with friction. Raises Refused if a slip is not linear in v."""
    graph = states.graph
    contacts = [c for c in states.model.contacts if c.slip is not None]
    if not contacts:
        return []
    rates = states.in_speeds([c.slip or graph.zero for c in contacts])
    biases = tangent(graph, rates, states.drift)
    jacobians = gradients(graph, rates, states.place_of_v)
    speeds = frozenset(states.place_of_v)
    for contact, jacobian in zip(contacts, jacobians):
        if not jacobian or symbols(list(jacobian.values())) & speeds:
            message = f"the slip of `{contact.label}` is not a velocity: it is not linear in the speeds"
            remedy = "write the velocity with which it slides: `slip = der(x)`"
            raise Refused([Fault("LAG0235", message, contact.span, remedy=remedy)])
    frictions = states.in_speeds([c.friction or graph.zero for c in contacts])
    statics = states.in_speeds([c.static or c.friction or graph.zero for c in contacts])
    return [SlipRow(*row) for row in zip(rates, jacobians, biases, frictions, statics)]
