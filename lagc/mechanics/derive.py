"""Model -> EquationsOfMotion, step by step."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING

from lagc.diagnostics.faults import Fault, Refused
from lagc.mechanics.balance.energy import Acting, act, energies
from lagc.mechanics.balance.outputs import of_motion, output_equations
from lagc.mechanics.formulation.constraints import Classified, classify
from lagc.mechanics.formulation.contacts import contact_rows, with_normals
from lagc.mechanics.formulation.equations import ContactRow, EquationsOfMotion, Law, Row, WhenEquations
from lagc.mechanics.formulation.euler_lagrange import free_terms, with_rates
from lagc.mechanics.formulation.inertia import inertial_loads, moving_parts
from lagc.mechanics.formulation.jacobian import added
from lagc.mechanics.formulation.states import States, build_states
from lagc.semantics.model import Force, Model, Potential, Torque
from lagc.symbolic.derivative import seeds
from lagc.symbolic.graph import Node
from lagc.symbolic.leaves import QUANTITIES
from lagc.symbolic.operators import CORNER, STEP, smooth_as
from lagc.symbolic.walk import depends, symbols

if TYPE_CHECKING:
    from lagc.mechanics.redundancy import Dropped

_RELATIONS = smooth_as(STEP, CORNER)
_OF_MOTION = ("acceleration", "multiplier", *QUANTITIES)


def derive(model: Model) -> EquationsOfMotion:
    """Return the equations of motion of `model`. Raises Refused with LAG04xx for mechanical errors."""
    graph = model.graph
    # Kinematics: states and speeds, and the parts that carry inertia.
    states = build_states(model)
    cuts, stops = _cuts(states)
    parts = moving_parts(states)
    free = free_terms(states, with_rates(states))
    # Virtual power: what acts, and the rows that hold.
    acting = act(states)
    classified, dropped, doubts = _constraint_rows(states)
    totals = energies(states, parts, acting, free, classified)
    # h: inertial forces at the accelerations that speeds leave, and the free terms of Lagrangians.
    inertial = inertial_loads(states, parts)
    # Inertial forces go from velocities to speeds by virtual power; free terms are in speeds already.
    bias = added(graph, [states.to_speeds(inertial), free.bias])
    servos = [x.row for x in classified if x.row.law is Law.SERVO]  # their loads act, not their gradients
    held = [{j: -(row.multiplier * slope) for j, slope in row.jacobian.items()} for row in servos]
    # tau: given forces, less what the gradients of servo rows would add.
    given = added(graph, [*(x.contribution.forces for x in acting), *held])
    initial = [c.residual for c in model.initial_conditions]
    # Outputs and conditions may depend on the motion: accelerations, multipliers, energies.
    zero, labels = graph.zero, [x.label for x in dropped]
    _refuse_reactions(model, dropped, classified, states)
    conditions = [when.condition for when in model.whens]
    if any(symbol.record.kind in _OF_MOTION for symbol in symbols(conditions)):
        conditions = of_motion(conditions, states, parts, acting, free, totals, labels)
    kept = tuple([x.row for x in classified])
    contributions = tuple([x.contribution for x in acting])
    contacts = _contacts(states, lambda nodes: of_motion(nodes, states, parts, acting, free, totals, labels))
    return EquationsOfMotion(
        model=model, graph=graph, time=model.time,
        # The states, their units, and how they start.
        q=states.q, v=states.v, a=states.a, q_units=states.q_units, v_units=states.v_units,
        qdot=states.qdot, quaternions=states.quaternions, rates=states.rates,
        starts_q=states.starts_q, starts_v=states.starts_v, stated_rates=states.stated_rates,
        inertias=tuple(parts),
        further_inertia=free.mass_matrix,
        bias_forces=tuple([bias.get(i, zero) for i in range(len(states.v))]),
        loads=_loads(states, acting, servos, inertial, free.bias),
        given_forces=tuple([given.get(i, zero) for i in range(len(states.v))]),
        rows=kept,
        contributions=contributions,
        kinetic=totals.kinetic, potential=totals.potential, energy=totals.energy, balance=totals.balance,
        power=totals.power,
        initial_conditions=tuple(zip(states.in_speeds(initial), [c.span for c in model.initial_conditions])),
        whens=(*when_equations(states, conditions), *stops),
        outputs=output_equations(states, parts, acting, free, totals, labels),
        contacts=contacts,
        dropped=tuple([x.reason for x in dropped]),
        warnings=(
            *model.warnings,
            *cuts,
            *doubts,
            *_active_load_warnings(states, kept),
            *_immovable_slip_warnings(states, kept, contacts),
            *_shared_reaction_warnings(states, dropped),
            *_doubled_weight_warnings(model),
            *_idle_clause_warnings(model),
        ),
    )  # fmt: skip


def _doubled_weight_warnings(model: Model) -> Iterable[Fault]:
    """Return warnings of weights that are also written as potentials."""
    # All weights come either from `gravity` or from actions: only a mixture can count twice.
    fields = [isinstance(action, Potential) and action.gravity is not None for action in model.actions]
    if all(fields) or not any(fields):
        return ()
    from lagc.mechanics.lint.loads import doubled_weights  # loaded where there may be some

    return doubled_weights(model)


def _idle_clause_warnings(model: Model) -> Iterable[Fault]:
    """Return warnings of clauses that wait for what is true from the start."""
    if not (model.whens and model.discretes):
        return ()
    from lagc.mechanics.lint.clauses import idle_clauses  # loaded where there may be some

    return idle_clauses(model)


def _cuts(states: States) -> tuple[tuple[Fault, ...], tuple[WhenEquations, ...]]:
    """Return warnings of expressions that jump or have a kink, and the clauses that stop a run there."""
    relations = {node for node in states.graph.nodes if node.op in _RELATIONS}
    if not relations:
        return (), ()
    from lagc.mechanics.lint.smoothness import find_cuts  # loaded where something may

    return find_cuts(states, relations)


def _constraint_rows(states: States) -> tuple[list[Classified], list[Dropped], tuple[Fault, ...]]:
    """Return the rows of the constraints that stay, those that are left out, and warnings."""
    found = classify(states)
    if not found:
        return [], [], ()
    from lagc.mechanics.lint.degenerate_constraints import refuse_degenerate
    from lagc.mechanics.redundancy import drop_idle, drop_redundant  # loaded where there are rows

    rows, idle = drop_idle(states, found)
    warnings = refuse_degenerate(states, rows)
    kept, dropped = drop_redundant(states, rows)
    return kept, idle + dropped, warnings


def _contacts(states: States, of: Callable[[Sequence[Node]], list[Node]]) -> tuple[ContactRow, ...]:
    """Return the rows of contacts; `of` gives quantities of the motion."""
    contacts = contact_rows(states)
    normals = [node for contact in contacts for node in contact.normals]
    return with_normals(contacts, of(normals)) if normals else contacts


def _refuse_reactions(
    model: Model, dropped: Sequence[Dropped], classified: Sequence[Classified], states: States
) -> None:
    """Raise Refused, LAG0431, if a load or friction depends on the multiplier of a row that others imply, or
    a load on any reaction, or an actuator holds a constraint, beside friction of a two-sided contact."""
    # Labels of rows that share a reaction: those left out, and those that imply them.
    shared = {label for row in dropped if row.others for label in (row.label, *row.others)}
    rough = [contact for contact in model.contacts if contact.normals]
    faults = []
    # A load on a shared reaction has no value; on any reaction it cannot stand beside friction of two-sided
    # contacts, whose solver has no loads.
    for load in [x for x in model.actions if isinstance(x, Force | Torque)]:
        for owner in sorted(s.record.owner for s in symbols(load.vector) if s.record.kind == "multiplier"):
            if owner in shared:
                message = (
                    f"`{load.name}` depends on `reaction({owner})`, which is one of many: other equations "
                    "imply this one"
                )
                faults.append(Fault("LAG0431", message, load.span, remedy="leave out one of these equations"))
            elif rough:
                message = f"`{load.name}` depends on `reaction({owner})`, beside {rough[0].title}"
                faults.append(Fault("LAG0431", message, load.span, remedy=rough[0].otherwise))
    for servo in [c for c in model.constraints if c.actuator and rough]:
        message = f"`{servo.actuator}` holds `{servo.name}`, beside {rough[0].title}"
        faults.append(Fault("LAG0431", message, servo.span, remedy=rough[0].otherwise))
    # Friction on the normal force of a row that others imply has no value either. Only here the dependent
    # rows that stay are needed.
    if rough and classified:
        from lagc.mechanics.redundancy import dependent_rows  # loaded where there are rows

        rows = [x.row for x in classified]
        shared |= {rows[k].label for x in dependent_rows(states, rows) for k in (x.row, *x.others)}
    for contact in rough:
        for owner in sorted({s.record.owner for s in symbols(contact.normals)} & shared):
            message = (
                f"{contact.title} depends on a force that is one of many: other equations imply `{owner}`"
            )
            faults.append(Fault("LAG0431", message, contact.span, remedy="leave out one of these equations"))
    if faults:
        raise Refused(faults)


def _shared_reaction_warnings(states: States, dropped: Sequence[Dropped]) -> tuple[Fault, ...]:
    """Return warnings of reactions that several rows share in a way that is not unique."""
    if not dropped:
        return ()
    from lagc.mechanics.redundancy import shared_reactions

    return shared_reactions(states, dropped)


def _immovable_slip_warnings(
    states: States, rows: Sequence[Row], contacts: Sequence[ContactRow]
) -> Iterable[Fault]:
    """Return warnings of slips that constraints hold."""
    if not rows or not any(contact.slips for contact in contacts):
        return ()
    from lagc.mechanics.lint.friction import slips_held  # loaded where something slips

    return slips_held(states, rows, contacts)


def _active_load_warnings(states: States, rows: Sequence[Row]) -> Iterable[Fault]:
    """Return warnings of loads that oppose another velocity than the one they act on."""
    if not any(isinstance(action, Force | Torque) and action.mentioned for action in states.model.actions):
        return ()
    from lagc.mechanics.lint.friction import active_loads  # loaded where there may be friction

    return active_loads(states, rows)


def _loads(
    states: States,
    acting: Sequence[Acting],
    servos: Sequence[Row],
    inertial: Mapping[Node, Node],
    bias: Mapping[int, Node],
) -> dict[Node, Node]:
    """Return given loads less inertial loads, on velocities that speeds change."""
    # Inertia and bias with a minus: M a = sum of loads. Servo rows act by their loads, so what their
    # gradients would add is taken away.
    asked = [*inertial.items(), *((states.v[j], node) for j, node in bias.items())]
    given = [pair for x in acting for pair in x.loads.items()]
    given += [(row.rate, -row.multiplier) for row in servos]
    found = seeds(states.graph, [*given, *((node, -weight) for node, weight in asked)])
    moving = depends(found, states.v)
    return {node: weight for node, weight in found.items() if node in moving}


def when_equations(states: States, conditions: Sequence[Node]) -> tuple[WhenEquations, ...]:
    """Return the clauses with these conditions, in t, q, v, a, lam. Raises Refused (LAG0427) where a new
    value is given to what is no state."""
    # New values go to states: to coordinates, to speeds, to discrete variables; a rate that declared speeds
    # replace is none.
    discretes = [variable.symbol for variable in states.model.discretes]
    known, faults, found = {*states.q, *states.v, *discretes}, [], []
    for clause, asked in zip(states.model.whens, conditions):
        for symbol, _ in clause.changes:
            if symbol not in known:
                given = ", ".join([f"`{v.record.name}`" for v in states.v])
                faults.append(
                    Fault(
                        "LAG0427",
                        f"`{symbol.record.name}` is no state of its own, as speeds are declared",
                        clause.span,
                        remedy=f"give new values to the speeds: {given}",
                    )
                )
        (condition,) = states.in_speeds([asked])
        values = states.in_speeds([value for _, value in clause.changes])
        changes = tuple(zip([symbol for symbol, _ in clause.changes], values))
        found.append(WhenEquations(clause, condition, changes))
    if faults:
        raise Refused(faults)
    return tuple(found)
