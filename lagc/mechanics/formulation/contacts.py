"""Contacts: slips along a surface, rows of gaps and slips, and a model in one mode of its contacts.

**Slips.** A slip that is given as a velocity in space has two components along the surface. A contact at a
place with the velocity w has the gap rate n . w: the normal n of the surface follows from the gradients of
gap rate and w by the speeds. The force along the gap is 1/|n| of the normal force.

Two directions along a surface that turns in space are those of T. Duff et al., J. Comput. Graph. Tech. 6,
2017, 1-8. They have no value where n points against the pole: the one of +z and -z that n is nearer to at the
initial state. A plane motion has one slip. It is positive along the x axis or, where it is across this at the
initial state, along y or z. A random state takes the place of an initial one that is singular, as that of a
stretched arm: it has too few independent velocities.

**Rows** of contacts, one-sided or rough, are the gap, its rate and its acceleration in the speeds:

    gap(t,q) >= 0      d(gap)/dt = R v + d(gap)/dt|_q      d2(gap)/dt2 = R a + bias
    gap(t,q,v) >= 0    of a bound of velocities: in place of its rate, d(gap)/dt = R a + bias
    slip(t,q,v)                                            d(slip)/dt = R_t a + bias_t

F. Pfeiffer, C. Glocker, Multibody Dynamics with Unilateral Contacts, Wiley 1996, chapter 5.

**Modes.** In one mode of its contacts a model has equations and loads in place of what touches. A contact
that touches is the constraint gap = 0. If it sticks, its slips are zero too. If it slides, the friction mu
p_n is a load against the slip (F. Pfeiffer, C. Glocker, Multibody Dynamics with Unilateral Contacts, 1996,
5.2). An open contact is nothing.
"""

from collections.abc import Mapping, Sequence, Set

from lagc.base.records import replace
from lagc.diagnostics.faults import Fault, Refused
from lagc.mechanics.formulation.equations import ContactRow, Law, Level, Row, SlipRow
from lagc.mechanics.formulation.jacobian import gradients
from lagc.mechanics.formulation.states import States, build_states
from lagc.mechanics.identities.samples import samples
from lagc.semantics.model import Action, Constraint, Contact, Force, Model, Torque
from lagc.semantics.units import S, over, si_text
from lagc.semantics.units import unit as unit_of
from lagc.symbolic.derivative import tangent
from lagc.symbolic.graph import Node
from lagc.symbolic.vectors import Vector, add, cross, dot, norm, scale, sub
from lagc.symbolic.walk import evaluate, substitute, symbols
from lagc.syntax.tree import Name

Gradient = Mapping[int, Node]
_State = Mapping[Node, float]

_INDEPENDENT = 1e-12  # part of the square of a velocity that others do not have
_ROUNDOFF = 1e-9  # of a unit vector


def along_surface(states: States, contact: Contact, normal: Gradient) -> tuple[list[Node], Node]:
    """Return the slip of a contact in its components along the surface, and the normal force over that along
    the gap: the slip as it is given, and 1; of a velocity in space its parts across the normal. `normal` is
    the gradient of the rate of the gap. Virtual releases change neither. Raises Refused if the normal is not
    found."""
    # One or two components are given along the surface already.
    given = states.in_speeds(contact.slip)
    if len(given) < 3:
        return given, states.graph.one
    # Without the rates of virtual releases, which are no motions of the model.
    released = [rate for release in states.model.releases for rate in release.rates]
    freed = {states.place_of_v[rate] for rate in released}
    parts = [_without(row, freed) for row in gradients(states.graph, given, states.place_of_v)]
    found = _normal(states, _without(normal, freed), parts)
    if found is None:
        message = f"the velocity of the place of `{contact.label}` does not show the direction of its surface"
        remedy = (
            "give the place where the bodies touch, or write two components along the surface that are "
            "perpendicular to each other: `slip = {der(x), der(y)}`"
        )
        raise Refused([Fault("LAG0235", message, contact.span, remedy=remedy)])
    velocity = (given[0], given[1], given[2])
    # The world's axes are split into two directions across the normal; a component that no motion has is left
    # out.
    n, state = found
    directions = _across(states, n, state)
    rates = [dot(direction, velocity) for direction in directions]
    held = substitute(states.graph, rates, dict.fromkeys(released, states.graph.zero))
    slips = [k for k in range(2) if not held[k].is_zero]
    # Of one direction the sign is the first component that is not zero.
    if len(slips) == 1 and _is_backward(states, directions[slips[0]], state):
        rates[slips[0]] = -rates[slips[0]]
    return [rates[k] for k in slips], norm(n)


def _is_backward(states: States, direction: Vector, state: _State | None) -> bool:
    """Return whether the first component of a unit vector, beyond round-off, is negative at a state."""
    fixed = all(x.is_const for x in direction)
    values = evaluate(states.in_speeds(direction), state or {}) if fixed or state else []
    return next((value < 0.0 for value in values if abs(value) > _ROUNDOFF), False)


def _without(row: Gradient, columns: Set[int]) -> Gradient:
    return {j: node for j, node in row.items() if j not in columns}


def _normal(
    states: States, normal: Gradient, parts: Sequence[Gradient]
) -> tuple[Vector, _State | None] | None:
    """Return n with normal = n . parts, an axis of the world or the shortest one, and the state of its signs;
    None if there is no n."""
    # The simplest answers first: a surface across an axis of the world is frequent, and its rows stay short.
    zero, start = states.graph.zero, _initial(states)
    for k in range(3):
        for sign in (1.0, -1.0):
            x, y, z = (states.graph.const(sign) if i == k else zero for i in range(3))
            if _fits(states, (x, y, z), normal, parts):
                return (x, y, z), start
    # Else the shortest n, with signs of the initial state or, if that is singular, of a random one.
    for state in (start, next(samples(states.model, 1), None)):
        n = _shortest(states, normal, parts, state)
        if any(not x.is_zero for x in n) and _fits(states, n, normal, parts):
            return n, state
    return None


def _shortest(states: States, normal: Gradient, parts: Sequence[Gradient], state: _State | None) -> Vector:
    """Return the shortest n with normal = n . parts. The partial velocities of the place, simple ones first,
    are made orthogonal (Gram-Schmidt); those that depend on others at `state` are left out. Each adds the
    rate of the gap along it."""
    zero = states.graph.zero
    n: Vector = (zero, zero, zero)
    # Columns with more constant entries first: their vectors need no division.
    columns = sorted({*normal, *(j for part in parts for j in part)})
    columns.sort(key=lambda j: sum(j in part and not part[j].is_const for part in parts))
    basis: list[tuple[Vector, Node]] = []
    # Gram-Schmidt: n = sum over the orthogonal velocities e of (rate along e) e / e^2.
    for j in columns:
        x, y, z = (part.get(j, zero) for part in parts)
        move, rate = (x, y, z), normal.get(j, zero)
        for e, rate_along in basis:
            share = dot((x, y, z), e) / dot(e, e)
            move, rate = sub(move, scale(share, e)), rate - share * rate_along
        squares = states.in_speeds([dot(move, move), dot((x, y, z), (x, y, z))])
        left, whole = evaluate(squares, state) if state else (0.0, 1.0)
        if left > _INDEPENDENT * whole:
            basis.append((move, rate))
            n = add(n, scale(rate / dot(move, move), move))
    return n


def _initial(states: States) -> _State | None:
    """Return the initial state, with random speeds; None if it has values outside a domain."""
    return next(samples(states.model, 1, vary=False, spread=0.0), None)


def _fits(states: States, n: Sequence[Node], normal: Gradient, parts: Sequence[Gradient]) -> bool:
    """Return whether normal = n . parts."""
    graph = states.graph
    # normal - n . parts, column by column; what is not zero by structure is tested in the field.
    left = []
    for j in {*normal, *(j for part in parts for j in part)}:
        total = graph.sum([x * part[j] for x, part in zip(n, parts) if j in part])
        left.append(normal.get(j, graph.zero) - total)
    left = [node for node in left if not node.is_zero]
    if any(node.is_const for node in left):
        return False
    if not left:
        return True
    from lagc.mechanics.identities.sampling_domains import all_states  # loaded where there is a question
    from lagc.mechanics.identities.zero_test import ZeroTest

    return ZeroTest(all_states(states)).vanish(left) is not None


def _across(states: States, n: Vector, state: _State | None) -> tuple[Vector, Vector]:
    """Return two unit vectors across n and each other: one is an axis of the world if n is across one."""
    graph, length = states.graph, norm(n)
    # An axis across n, if n has a zero component, gives short expressions.
    zero, one = graph.zero, graph.one
    for k in (2, 1, 0):
        if n[k].is_zero:
            axis = (one if k == 0 else zero, one if k == 1 else zero, one if k == 2 else zero)
            other = cross(n, axis)
            return (other[0] / length, other[1] / length, other[2] / length), axis
    # Duff et al.: an orthonormal basis without a root, singular only at one pole, so the pole opposite to the
    # initial n is taken.
    x, y, z = n[0] / length, n[1] / length, n[2] / length
    if state is not None and evaluate(states.in_speeds([n[2]]), state)[0] < 0.0:
        x, y, z = -x, -y, -z
    part = -one / (one + z)
    return (one + x * x * part, x * y * part, -x), (x * y * part, one + y * y * part, -y)


def contact_rows(states: States) -> tuple[ContactRow, ...]:
    """Return the rows of the model's contacts in the order of declaration. Two-sided contacts have no gap.
    Raises Refused if a bound of velocities is not linear in the speeds."""
    contacts, graph = states.model.contacts, states.graph
    if not contacts:
        return ()
    # Rates and biases by d/dt with the speeds held, as for constraints; a bound of velocities is a rate
    # already.
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


def touching_row(contact: ContactRow) -> Row:
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
    # Slips need the normal to know the surface; their rows are differentiated as those of gaps.
    rates, factor = along_surface(states, contact, normal)
    biases = tangent(states.graph, rates, states.drift)
    jacobians = gradients(states.graph, rates, states.place_of_v)
    for jacobian in jacobians:
        if not _is_linear(states, jacobian):
            message = f"the slip of `{contact.label}` is not a velocity: it is not linear in the speeds"
            remedy = "write the velocity with which it slides: `slip = der(x)`"
            raise Refused([Fault("LAG0235", message, contact.span, remedy=remedy)])
    # Coefficients of the force along the gap: mu times |force| over the row of the gap.
    given = states.in_speeds([contact.friction, contact.static or contact.friction])
    symbol = states.graph.symbol
    forces = [symbol("multiplier", contact.label, f"slip{k + 1}") for k in range(len(rates))]
    rows = [SlipRow(*row) for row in zip(rates, jacobians, biases, forces)]
    return tuple(rows), tuple([factor * node for node in given])


MODE_STICKS = 2


def hold_contacts(model: Model, modes: Sequence[int]) -> Model:
    """Return `model` without contacts, in these modes: 0 open, 1 and -1 sliding forwards and backwards or
    without friction, 2 sticking. The multiplier of a contact is still its push; those of a contact `c` that
    sticks are `c.slip[1]`, `c.slip[2]`. Raises Refused, LAG0623, for friction of two-sided contacts."""
    for contact in model.contacts:
        if contact.normals:
            message = f"linear models do not follow {contact.title} yet"
            raise Refused([Fault("LAG0623", message, contact.span, remedy=contact.otherwise)])
    # Slips need the kinematics of the free model.
    states = build_states(model)
    constraints, loads = list(model.constraints), _without_pushes(model, modes)
    for contact, mode in zip(model.contacts, modes):
        # Closed: gap = 0, and slips = 0 while it sticks; sliding friction is a load on the push.
        if mode:
            slips, factor = _slips(states, contact)
            constraints.append(_closed_constraint(contact, slips if mode == MODE_STICKS else []))
            if slips and mode != MODE_STICKS:
                loads.append(_sliding(model, contact, mode, slips, factor))
    # The modes of contacts are no states any more.
    own = {contact.state for contact in model.contacts}
    return replace(
        model,
        constraints=tuple(constraints),
        actions=tuple(loads),
        contacts=(),
        discretes=tuple([d for d in model.discretes if d.symbol not in own]),
        released=None if model.released is None else hold_contacts(model.released, modes),
    )


def _without_pushes(model: Model, modes: Sequence[int]) -> list[Action]:
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


def _closed_constraint(contact: Contact, slips: Sequence[Node]) -> Constraint:
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
    # One slip: the mode is its direction. Two: against the velocity, which has no value at a stop.
    assert contact.friction is not None
    force = -contact.friction * factor * graph.symbol("multiplier", contact.label)
    if len(slips) == 1:
        vector, along = (graph.const(float(mode)) * force, zero, zero), (slips[0], zero, zero)
    else:
        along = (slips[0], slips[1], zero)
        speed = norm(along)
        vector = (force * slips[0] / speed, force * slips[1] / speed, zero)
    return Force(contact.label, vector, along, contact.span, contact.effect)
