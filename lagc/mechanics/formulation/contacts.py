"""Rows of the one-sided constraints: gap, its rate and its acceleration in the speeds.

    gap(t,q) >= 0      d(gap)/dt = R v + d(gap)/dt|_q      d2(gap)/dt2 = R a + bias

F. Pfeiffer, C. Glocker, Multibody Dynamics with Unilateral Contacts, Wiley 1996, chapter 5.
"""

from __future__ import annotations

from lagc.mechanics.formulation.equations import ContactRow
from lagc.mechanics.formulation.jacobian import gradients
from lagc.mechanics.formulation.states import States
from lagc.symbolic.derivative import tangent


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
    return tuple([
        ContactRow(c, graph.symbol("multiplier", c.label), gap, rate, jacobian, bias, restitution)
        for c, gap, rate, jacobian, bias, restitution in zip(
            contacts, gaps, rates, jacobians, biases, restitutions)
    ])  # fmt: skip
