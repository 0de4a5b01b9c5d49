"""Rows of the contacts, one-sided or rough: gap, its rate and its acceleration in the speeds.

    gap(t,q) >= 0      d(gap)/dt = R v + d(gap)/dt|_q      d2(gap)/dt2 = R a + bias
    gap(t,q,v) >= 0    of a bound of velocities: in place of its rate, d(gap)/dt = R a + bias
    slip(t,q,v)                                            d(slip)/dt = R_t a + bias_t

F. Pfeiffer, C. Glocker, Multibody Dynamics with Unilateral Contacts, Wiley 1996, chapter 5.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from lagc.base.records import replace
from lagc.diagnostics.faults import Fault, Refused
from lagc.mechanics.formulation.equations import ContactRow, Law, Level, Row, SlipRow
from lagc.mechanics.formulation.jacobian import gradients
from lagc.mechanics.formulation.slips import along_surface
from lagc.mechanics.formulation.states import States
from lagc.semantics.model import Contact
from lagc.symbolic.derivative import tangent
from lagc.symbolic.graph import Node
from lagc.symbolic.walk import symbols


def contact_rows(states: States) -> tuple[ContactRow, ...]:
    """Return the rows of the model's contacts in the order of declaration. Two-sided contacts have no gap.
    Raises Refused if a bound of velocities is not linear in the speeds."""
    contacts, graph = states.model.contacts, states.graph
    if not contacts:
        return ()
    gaps = states.in_speeds([c.gap for c in contacts])
    rates = tangent(graph, gaps, states.drift)
    rates = [gap if c.bounds_rate else rate for c, gap, rate in zip(contacts, gaps, rates)]
    biases = tangent(graph, rates, states.drift)
    jacobians = gradients(graph, rates, states.place_of_v)
    for c, jacobian in zip(contacts, jacobians):
        if c.bounds_rate and not _is_linear(states, jacobian):
            message = f"the bound `{c.label}` is not linear in the velocities: its force has no direction"
            remedy = "bound a component of a velocity, or the rate of a coordinate"
            raise Refused([Fault("LAG0235", message, c.span, remedy=remedy)])
    restitutions = states.in_speeds([c.restitution for c in contacts])
    found = [
        ContactRow(c, graph.symbol("multiplier", c.label, "normal" if c.normals else ""), gap, rate, jacobian,
                   bias, restitution, *_friction(states, c, jacobian), c.normals)
        for c, gap, rate, jacobian, bias, restitution in zip(
            contacts, gaps, rates, jacobians, biases, restitutions)
    ]  # fmt: skip
    return tuple([_without_gap(row) if row.normals else row for row in found])


def _is_linear(states: States, jacobian: Mapping[int, Node]) -> bool:
    """Return whether a rate with this gradient is a velocity: it changes with the speeds, and linearly."""
    return bool(jacobian) and symbols(list(jacobian.values())).isdisjoint(states.place_of_v)


def _without_gap(row: ContactRow) -> ContactRow:
    zero = row.gap.graph.zero
    return replace(row, gap=zero, rate=zero, jacobian={}, bias=zero)


def held(contact: ContactRow) -> Row:
    """Return the row of a contact that touches."""
    return Row(
        contact.label, contact.contact.name, Level.POSITION, Law.PERFECT,
        contact.multiplier, contact.gap, contact.rate, contact.jacobian, -contact.bias, contact.contact.unit,
        False, True, contact.contact.span,
    )  # fmt: skip


def with_normals(contacts: Sequence[ContactRow], nodes: Sequence[Node]) -> tuple[ContactRow, ...]:
    """Return contacts with these components of their normal forces, in the order of `ContactRow.normals`. One
    that is always zero is left out beside another one."""
    given, found = iter(nodes), list[ContactRow]()
    for contact in contacts:
        own = [next(given) for _ in contact.normals]
        found.append(replace(contact, normals=tuple([node for node in own if not node.is_zero] or own[:1])))
    return tuple(found)


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
    for jacobian in jacobians:
        if not _is_linear(states, jacobian):
            message = f"the slip of `{contact.label}` is not a velocity: it is not linear in the speeds"
            remedy = "write the velocity with which it slides: `slip = der(x)`"
            raise Refused([Fault("LAG0235", message, contact.span, remedy=remedy)])
    given = states.in_speeds([contact.friction, contact.static or contact.friction])
    symbol = states.graph.symbol
    forces = [symbol("multiplier", contact.label, f"slip{k + 1}") for k in range(len(rates))]
    rows = [SlipRow(*row) for row in zip(rates, jacobians, biases, forces)]
    return tuple(rows), tuple([factor * node for node in given])
