"""The equations of a model with contacts in each of their modes.

An open contact exerts no force. One that touches pushes with lambda >= 0 along its gap (A. Signorini, 1933),
and rubs along its slip: less than mu lambda while it sticks, -mu lambda u/|u| while it slips (C. A. Coulomb,
1785). F. Pfeiffer, C. Glocker, Multibody Dynamics with Unilateral Contacts, 1996, 5.2. The equations of one
contact are written in each mode, those of several once, with the laws that hold in all modes.
"""

from collections.abc import Mapping, Sequence

from lagc.base.records import dataclass, replace
from lagc.mechanics.formulation.equations import ContactRow, EquationsOfMotion
from lagc.reports.names import impulses, slip_speeds
from lagc.symbolic.graph import Node
from lagc.symbolic.vectors import norm
from lagc.symbolic.walk import substitute

IMPACTS = ("impact", "poisson")  # kinds of laws


@dataclass(frozen=True, slots=True)
class Law:
    """A relation that holds beside the equations of motion. The kinds are contact (left >= 0), closed (left =
    right), bound (left <= right), complement (0 <= left, right >= 0, one of them 0), stick and slip (as bound
    and closed, where `condition` is zero, or is not), impact (`left` takes the value `right`), poisson (as
    closed)."""

    kind: str
    label: str
    left: Node
    right: Node
    condition: Node | None = None


@dataclass(frozen=True, slots=True)
class Mode:
    """The equations of motion in one mode, or in all, with their laws. `title` is empty for open contacts."""

    title: str
    equations: EquationsOfMotion
    laws: tuple[Law, ...]


def modes(equations: EquationsOfMotion) -> list[Mode]:
    """Return the equations of open contacts, with the friction of two-sided ones, then those of the modes in
    which contacts touch."""
    # Two-sided contacts touch in all modes; those that open have one mode without forces.
    free = [contact for contact in equations.contacts if not contact.normals]
    rough = [contact for contact in equations.contacts if contact.normals]
    laws = [Law("contact", contact.label, contact.gap, equations.graph.zero) for contact in free]
    laws += [law for contact in rough for law in _laws(contact)]
    found = [Mode("", with_forces(equations, _forces(rough)), tuple(laws))]
    if not free:
        return found
    if len(equations.contacts) == 1:
        touching = _modes_of(equations, free[0])
    else:
        every = [law for contact in equations.contacts for law in _laws(contact)]
        touching = [
            Mode(
                "with the forces of contacts",
                with_forces(equations, _forces(equations.contacts)),
                tuple(every),
            )
        ]
    # At an impact impulses act as the forces do, so its law stands with the last mode of contacts.
    impacts = [_impact(contact) for contact in free]
    touching[-1] = replace(touching[-1], laws=(*touching[-1].laws, *impacts))
    return found + [replace(mode, equations=replace(mode.equations, whens=())) for mode in touching]


def _forces(contacts: Sequence[ContactRow]) -> dict[Node, Node]:
    return {force: force for contact in contacts for force in contact.forces}


def _impact(contact: ContactRow) -> Law:
    """Return the law of impacts: of Newton, or of Poisson in the impulses of compression and restitution."""
    if contact.contact.poisson:
        (_, first), (_, second) = impulses(contact)
        return Law("poisson", contact.label, second, contact.restitution * first)
    return Law("impact", contact.label, contact.rate, -(contact.restitution * contact.rate))


def with_forces(equations: EquationsOfMotion, forces: Mapping[Node, Node]) -> EquationsOfMotion:
    """Return `equations` with these forces of contacts, by their symbols, added to the given ones. Others are
    zero, also in loads that depend on them."""
    if not equations.contacts:
        return equations
    graph, zero = equations.graph, equations.graph.zero
    given, loads, every = list(equations.given_forces), dict(equations.loads), dict[Node, Node]()
    for contact in equations.contacts:
        rates = [contact.rate, *(slip.rate for slip in contact.slips)]
        for symbol, rate, jacobian in zip(contact.forces, rates, contact.jacobians):
            every[symbol] = forces.get(symbol, zero)
            if jacobian:
                loads[rate] = loads.get(rate, zero) + symbol
            for j, slope in jacobian.items():
                given[j] = given[j] + symbol * slope
    shown = substitute(graph, [*given, *loads.values()], every)
    return replace(
        equations, given_forces=tuple(shown[: len(given)]), loads=dict(zip(loads, shown[len(given) :]))
    )


def _modes_of(equations: EquationsOfMotion, contact: ContactRow) -> list[Mode]:
    """Return the modes in which the only contact touches; with friction it sticks or slips."""
    zero, push, label = equations.graph.zero, contact.multiplier, contact.label
    system = with_forces(equations, _forces([contact]))
    closed = [Law("closed", label, contact.gap, zero), Law("contact", label, push, zero)]
    if not contact.slips:
        return [Mode(f"`{label}` touches", system, tuple(closed))]
    stuck = [Law("closed", label, slip.rate, zero) for slip in contact.slips]
    stuck.append(
        Law("bound", label, _size([slip.force for slip in contact.slips]), contact.frictions[1] * push)
    )
    slipping = [*_slips(contact), *(Law("closed", label, *pair) for pair in _rubbing(contact).items())]
    return [
        Mode(f"`{label}` touches and sticks", system, (*closed, *stuck)),
        Mode(f"`{label}` touches and slips", system, (*closed, *slipping)),
    ]


def _laws(contact: ContactRow) -> list[Law]:
    """Return what holds in all modes. The normal force of a two-sided contact is the size of a reaction."""
    push, label = contact.multiplier, contact.label
    if contact.normals:
        laws = [Law("closed", label, push, _size(contact.normals))]
    else:
        laws = [Law("complement", label, contact.gap, push)]
    if contact.slips:
        rates = slip_speeds(contact)
        speed = rates[0] if len(rates) == 1 else norm(rates)
        laws += _slips(contact)
        friction = _size([slip.force for slip in contact.slips])
        laws.append(Law("stick", label, friction, contact.frictions[1] * push, speed))
        laws += [Law("slip", label, *pair, speed) for pair in _rubbing(contact).items()]
    return laws


def _rubbing(contact: ContactRow) -> dict[Node, Node]:
    """Return the friction of a contact that slips, by the symbols of its components."""
    graph, force = contact.gap.graph, -(contact.frictions[0] * contact.multiplier)
    rates, forces = slip_speeds(contact), [slip.force for slip in contact.slips]
    if len(rates) == 1:
        return {forces[0]: force * graph.unary("sign", rates[0])}
    return {own: force * rate / norm(rates) for own, rate in zip(forces, rates)}


def _slips(contact: ContactRow) -> list[Law]:
    """Return the slips that have a name."""
    pairs = zip(slip_speeds(contact), contact.slips)
    return [Law("closed", contact.label, speed, slip.rate) for speed, slip in pairs if speed != slip.rate]


def _size(parts: Sequence[Node]) -> Node:
    """Return the length of a vector."""
    return norm(parts) if len(parts) > 1 else parts[0].graph.unary("abs", parts[0])
