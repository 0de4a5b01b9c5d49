"""Generalized forces of given actions, energies and their balance.

**Forces.** A potential contributes -N^T dV/dq, a force F at a point of velocity u F . du/dv_j, a torque T on
a frame T . dw/dv_j, a Rayleigh function D(rates) -dD/d(rate_i) on each rate. `euler_lagrange` has the free
terms of the Lagrangian.

**Balance.** The balance is that of Jacobi's energy E = sum of rate_i dL/d(rate_i) - L = K2 - K0 + V, because
it needs no force of a drive:

    dE/dt = -dL/dt + sum of Q_i rate_i

with dL/dt at fixed coordinates and rates, and Q the forces without a potential, multipliers included (C.
Lanczos, *The Variational Principles of Mechanics*, ch. V). Without drives E = K + V; without dissipation too,
the power is the constant zero. A body's velocity u = (linear in the rates) + d gives K2 - K0 = K - d.p with
its momentum p.
"""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from lagc.base.records import dataclass
from lagc.mechanics.formulation.constraints import Classified
from lagc.mechanics.formulation.equations import Contribution, Law, Moving
from lagc.mechanics.formulation.euler_lagrange import FreeTerms
from lagc.mechanics.formulation.jacobian import gradients, opposite, weighted
from lagc.mechanics.formulation.states import States
from lagc.semantics.model import Action, Coordinate, Dissipation, Force, Lagrangian, Potential, Torque
from lagc.symbolic.derivative import gradient, seeds, tangent
from lagc.symbolic.graph import Node
from lagc.symbolic.vectors import dot, scale
from lagc.symbolic.walk import depends


@dataclass(frozen=True, slots=True)
class Acting:
    """An action's contribution. `loads` are pairs of a weight and a velocity whose products sum to its
    virtual power; `relative_power` is its power at fixed drives, forces . rates; `stored` is the energy of a
    conservative one."""

    contribution: Contribution
    loads: dict[Node, Node]
    relative_power: Node
    stored: Node


def act(states: States) -> list[Acting]:
    """Return the contribution of every action of the model, in its order."""
    # Potentials by gradients, loads by the velocities that they act on; free terms have their share in M and
    # h.
    zero, actions = states.graph.zero, states.model.actions
    stored = {
        k: x for k, action in enumerate(actions) if (x := _potential_energy(states, action)) is not None
    }
    actuators = _actuators(states)
    written = [_load(states, action, actuators) for action in actions]
    loads = {k: load for k, load in enumerate(written) if load is not None}
    found = dict(zip(stored, _potentials(states, [actions[k] for k in stored], list(stored.values()))))
    found.update(zip(loads, _working(states, list(loads.values()))))
    for k, action in enumerate(actions):
        if k not in found:  # a free term: its share is in M and h
            none = Contribution(action.name, "lagrangian", action.effect, {}, zero, True)
            found[k] = Acting(none, {}, zero, zero)
    return [found[k] for k in range(len(actions))]


def force_along(states: States, action: Action, coordinate: Coordinate) -> Node:
    """Return the generalized force of an action along the rate of a coordinate: -dV/dq, or the sum of its
    weights times the slopes of the velocities."""
    graph, energy = states.graph, _potential_energy(states, action)
    if energy is not None:
        return -gradient(graph, {energy: graph.one}, [coordinate.symbol]).get(coordinate.symbol, graph.zero)
    load, rate = _load(states, action, _actuators(states)), coordinate.rate_symbol
    assert load is not None
    slopes = gradient(graph, seeds(graph, zip(load.velocities, load.weights)), [rate])
    return states.in_speeds([slopes.get(rate, graph.zero)])[0]


def _potential_energy(states: States, action: Action) -> Node | None:
    """Return the energy of a potential, or -L of a Lagrangian without rates, which is one too; else None."""
    if isinstance(action, Potential):
        return action.energy
    if not isinstance(action, Lagrangian) or action.is_kinetic:
        return None
    return None if depends(states.in_rates([action.function]), list(states.rates)) else -action.function


def _potentials(states: States, actions: Sequence[Action], energies: Sequence[Node]) -> list[Acting]:
    graph, model = states.graph, states.model
    # Power of a potential: -dV/dt along the motion. It is no stored energy if an input or a jump in time
    # changes it.
    powers = [-x for x in tangent(graph, energies, states.motion)]
    driven = depends(energies, [given.symbol for given in model.inputs])
    timed = depends(energies, [model.time])
    found: list[Acting] = []
    for action, energy, power, forces in zip(actions, energies, powers, _forces(states, energies, powers)):
        conservative = energy not in driven and not (energy in timed and _jumps_in_time(states, energy))
        kind = "potential" if isinstance(action, Potential) else "lagrangian"
        contribution = Contribution(action.name, kind, action.effect, forces, power, conservative)
        found.append(Acting(contribution, {power: graph.one}, power, energy if conservative else graph.zero))
    return found


def _forces(states: States, energies: Sequence[Node], powers: Sequence[Node]) -> list[Mapping[int, Node]]:
    graph = states.graph
    if states.quaternions:  # rounding takes them off the unit sphere: the same there as along the motion
        return [states.to_speeds({power: graph.one}) for power in powers]
    # The same, in shorter terms: the gradient shares more with others than what the speeds multiply.
    slopes = gradients(graph, energies, states.place_of_q)
    if states.qdot == states.v:
        return opposite(graph, slopes)
    return [states.force_of({states.q[i]: -x for i, x in own.items()}) for own in slopes]


def _jumps_in_time(states: States, energy: Node) -> bool:
    from lagc.mechanics.lint.smoothness import jumps_in_time  # loaded where there is a question

    return jumps_in_time(states, energy)


class _Load(NamedTuple):
    """Weights on velocities, the weights in v, the velocities in rates."""

    action: Action
    kind: str
    velocities: list[Node]
    weights: list[Node]


def _actuators(states: States) -> dict[str, Node]:
    """Return the multipliers of the constraints that actuators hold, by the actuators."""
    found = {c.actuator: c.labels[0] for c in states.model.constraints if c.actuator}
    return {name: states.graph.symbol("multiplier", label) for name, label in found.items()}


def _load(states: States, action: Action, actuators: Mapping[str, Node]) -> _Load | None:
    """Return the load of an action: F on u, T on w, -dD/d(rate_i) on rates; None for a potential or a free
    term. The load of an actuator is multiplied by its multiplier."""
    load = _load_of_one(states, action)
    factor = actuators.get(action.name)
    if load is None or factor is None:
        return load
    return load._replace(weights=[factor * weight for weight in load.weights])


def _load_of_one(states: States, action: Action) -> _Load | None:
    if isinstance(action, Force):
        return _Load(action, "force", list(action.velocity), states.in_speeds(action.vector))
    # A torque acts on the spin of its frame and, with the opposite sign, on that of the frame it reacts on.
    if isinstance(action, Torque):
        pairs = [(action.frame.spin, action.vector)]
        if action.reaction is not None:
            pairs.append((action.reaction.spin, scale(-1.0, action.vector)))
        weights = states.in_speeds([x for _, weight in pairs for x in weight])
        return _Load(action, "torque", [x for spin, _ in pairs for x in spin], weights)
    if not isinstance(action, Dissipation):
        return None
    # -dD/d(rate) on each rate, and on each declared speed that D contains.
    leaves = [*states.rates, *(speed.symbol for speed in states.model.speeds)]
    slopes = gradient(states.graph, {action.function: states.graph.one}, leaves)
    weights = [-x for x in states.in_speeds(list(slopes.values()))]
    return _Load(action, "dissipation", list(slopes), weights)


def _working(states: States, loads: Sequence[_Load]) -> list[Acting]:
    graph = states.graph
    # The velocities in speeds, and at rest: drives move them without any speed.
    velocities = [x for load in loads for x in load.velocities]
    moving, drives_at_rest = iter(states.in_speeds(velocities)), iter(states.at_rest(velocities))
    moved = [[next(moving) for _ in load.velocities] for load in loads]
    at_rest = [[next(drives_at_rest) for _ in load.velocities] for load in loads]
    on_speeds = [seeds(graph, zip(own, load.weights)) for own, load in zip(moved, loads)]
    found: list[Acting] = []
    for load, own, drives, weights, forces in zip(
        loads, moved, at_rest, on_speeds, weighted(graph, on_speeds, states.place_of_v)
    ):
        power = graph.sum(w * x for w, x in zip(load.weights, own))
        drive = graph.sum(w * x for w, x in zip(load.weights, drives))
        contribution = Contribution(load.action.name, load.kind, load.action.effect, forces, power, False)
        found.append(Acting(contribution, weights, power - drive, graph.zero))
    return found


WHOLE, BY_DEGREES, BY_MOMENTA = "K + V", "K2 - K0 + V", "p.v - L"


@dataclass(frozen=True, slots=True)
class Energies:
    kinetic: Node
    potential: Node
    energy: Node  # Jacobi's
    balance: str  # how it is written: K + V where it is proved to be that
    power: Node  # d(energy)/dt along the motion; the constant zero where nothing brings any


def energies(
    states: States,
    parts: Sequence[Moving],
    acting: Sequence[Acting],
    free: FreeTerms,
    rows: Sequence[Classified],
) -> Energies:
    """Return K, V, E and dE/dt of the whole system, in t, q, v (and the multipliers in the power)."""
    graph = states.graph
    momenta = [part.momentum(part.velocity) for part in parts]
    kinetic = graph.sum(0.5 * dot(part.velocity, p) for part, p in zip(parts, momenta))
    drives = graph.sum(dot(part.at_rest, p) for part, p in zip(parts, momenta))
    given = graph.sum(x.stored for x in acting)
    power = graph.sum(x.relative_power for x in acting if not x.contribution.conservative)
    explicit = graph.sum(dot(part.explicit, p) for part, p in zip(parts, momenta)) + free.explicit
    explicit = explicit - tangent(graph, [given], {states.model.time: graph.one})[0]
    if not _vanishes(states, explicit):  # as it does of a steady turn
        power = power - explicit
    power = power + graph.sum(x.row.multiplier * x.drive for x in rows if x.row.law is Law.PERFECT)
    return Energies(
        kinetic=kinetic + free.kinetic,
        potential=given + free.potential,
        energy=kinetic - drives + given + free.jacobi,
        balance=_balance(states, drives, free),
        power=power,
    )


def _balance(states: States, drives: Node, free: FreeTerms) -> str:
    if _vanishes(states, drives - free.beyond):
        return WHOLE
    return BY_DEGREES if not depends(free.mass_matrix.values(), states.v) else BY_MOMENTA


def _vanishes(states: States, node: Node) -> bool:
    if node.is_zero:
        return True
    from lagc.mechanics.identities.sampling_domains import all_states  # loaded where there is a question
    from lagc.mechanics.identities.zero_test import ZeroTest

    return bool(ZeroTest(all_states(states)).vanish([node]))
