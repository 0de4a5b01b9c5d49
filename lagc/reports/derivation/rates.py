"""The rates in which a solution is written, with a virtual velocity for each.

Declared speeds are replaced by the rates of coordinates: a person derives in these, and takes the equations
to the speeds at the end. An orientation has three rates, the components of its rotation vector in the axes of
the body.
"""

from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property

from lagc.base.records import dataclass, replace
from lagc.mechanics.formulation.equations import EquationsOfMotion, Law
from lagc.mechanics.formulation.euler_lagrange import with_rates
from lagc.mechanics.formulation.states import States, build_states
from lagc.semantics.model import (
    Action,
    Coordinate,
    Dissipation,
    Force,
    Frame,
    Lagrangian,
    Model,
    Orientation,
    Potential,
    Torque,
)
from lagc.symbolic.derivative import gradient, tangent
from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.vectors import Vector, cross, dot, sub


@dataclass(frozen=True, slots=True)
class Term:
    """The share of one action or reaction in the equations: its generalized forces, by rate. The kinds are
    "given", "perfect" and "imperfect"."""

    name: str
    kind: str
    forces: Mapping[int, Node]


@dataclass(frozen=True)
class Rates:
    """The motion of `equations` in rates. `model` has frames that all have names."""

    equations: EquationsOfMotion
    model: Model
    states: States  # without declared speeds
    declared: States

    @property
    def graph(self) -> Graph:
        return self.equations.graph

    @property
    def symbols(self) -> tuple[Node, ...]:
        """The rates."""
        return self.states.v

    @cached_property
    def stars(self) -> dict[Node, Node]:
        """The virtual velocity of each rate."""
        symbol = self.graph.symbol
        return {v: symbol("virtual", v.record.name) for v in self.states.v}

    @cached_property
    def positions(self) -> dict[int, Node]:
        """The scalar coordinate of each rate that has one."""
        place = self.states.place_of_v
        scalars = [c for c in self.model.coordinates if isinstance(c, Coordinate)]
        return {place[c.rate_symbol]: c.symbol for c in scalars}

    @cached_property
    def rotations(self) -> list[tuple[Orientation, tuple[int, ...]]]:
        """The orientations, each with its three rates."""
        place = self.states.place_of_v
        turning = [c for c in self.model.coordinates if isinstance(c, Orientation)]
        return [(c, tuple([place[r] for r in c.rate_symbols])) for c in turning]

    def in_rates(self, nodes: Iterable[Node]) -> list[Node]:
        """Return `nodes` with declared speeds replaced by their expressions in rates."""
        return self.declared.in_rates(list(nodes))

    def virtual(self, vector: Sequence[Node]) -> list[Node]:
        """Return the parts of velocities that are linear in the rates, with stars: drives have no share."""
        return tangent(self.graph, self.in_rates(vector), self.stars)

    def velocity(self, vector: Vector) -> Vector:
        """Return the rate of change of a position."""
        x, y, z = tangent(self.graph, list(vector), self.states.drift)
        return x, y, z

    def acceleration(self, velocity: Vector) -> Vector:
        x, y, z = self.change(velocity)
        return x, y, z

    def change(self, nodes: Sequence[Node]) -> list[Node]:
        """Return the time derivatives along the motion, in rates and second derivatives."""
        return tangent(self.graph, list(nodes), self.states.flow)

    # -- energies -----------------------------------------------------------------------------------

    @cached_property
    def displacement(self) -> dict[Node, Node]:
        """Seeds of the virtual change of positions: coordinates and axes of frames."""
        motion = self.states.motion
        return dict(zip(motion, self.virtual(list(motion.values()))))

    @cached_property
    def kinetic(self) -> Node:
        """K in rates, with the free terms that are kinetic."""
        energies = [body.kinetic_energy for body in self.model.bodies]
        return self.graph.sum([*energies, *[x.function for x in self.free_terms if x.is_kinetic]])

    @cached_property
    def free_terms(self) -> list[Lagrangian]:
        """The terms of the Lagrangian that hold rates, in rates."""
        terms = with_rates(self.declared)
        return [replace(x, function=f) for x, f in zip(terms, self.in_rates([x.function for x in terms]))]

    def momenta(self, energy: Node) -> list[Node]:
        """Return the derivatives by the rates."""
        found = gradient(self.graph, {energy: self.graph.one}, list(self.symbols))
        return [found.get(v, self.graph.zero) for v in self.symbols]

    def slopes(self, energy: Node, displacement: dict[Node, Node] | None = None) -> list[Node]:
        """Return the derivatives along the displacement of each rate, the rates held."""
        (change,) = tangent(self.graph, [energy], displacement or self.displacement)
        found = gradient(self.graph, {change: self.graph.one}, list(self.stars.values()))
        return [found.get(star, self.graph.zero) for star in self.stars.values()]

    def gyroscopic(self, momenta: Sequence[Node]) -> dict[int, Node]:
        """Return w x p for the rates w of orientations (L. Euler; H. Poincare, 1901)."""
        found: dict[int, Node] = {}
        for _, (i, j, k) in self.rotations:
            w = (self.symbols[i], self.symbols[j], self.symbols[k])
            found.update(zip((i, j, k), cross(w, (momenta[i], momenta[j], momenta[k]))))
        return found

    def inertial_terms(self, energy: Node) -> list[Node]:
        """Return d/dt(dK/dq') - dK/dq for each rate, with w x dK/dw for those of orientations."""
        momenta = self.momenta(energy)
        turned = self.gyroscopic(momenta)
        zero = self.graph.zero
        changes = zip(self.change(momenta), self.slopes(energy))
        return [p - s + turned.get(j, zero) for j, (p, s) in enumerate(changes)]

    # -- actions ------------------------------------------------------------------------------------

    def virtual_power(self, action: Action) -> Node:
        """Return the virtual power of an action. A free term acts with dL/dq - d/dt(dL/dq')."""
        graph = self.graph
        if isinstance(action, Force | Torque):
            velocity = action.velocity if isinstance(action, Force) else relative_spin(action)
            power: Node = dot(self.in_rates(action.vector), self.virtual(velocity))
            return self.actuators.get(action.name, graph.one) * power
        if isinstance(action, Potential):
            return tangent(graph, [-action.energy], self.displacement)[0]
        if isinstance(action, Dissipation):
            slopes = self.momenta(self.in_rates([action.function])[0])
            return graph.sum(-slope * star for slope, star in zip(slopes, self.stars.values()))
        if action.name not in {x.name for x in self.free_terms}:
            return tangent(graph, [action.function], self.displacement)[0]
        (function,) = self.in_rates([action.function])
        return graph.sum(-e * star for e, star in zip(self.inertial_terms(function), self.stars.values()))

    @cached_property
    def actuators(self) -> dict[str, Node]:
        """The multiplier of each load that holds a constraint."""
        held = [c for c in self.model.constraints if c.actuator]
        return {c.actuator: self.graph.symbol("multiplier", c.labels[0]) for c in held}

    def forces(self, power: Node) -> dict[int, Node]:
        """Return the generalized forces of a virtual power: its coefficients."""
        found = gradient(self.graph, {power: self.graph.one}, list(self.stars.values()))
        return {j: found[star] for j, star in enumerate(self.stars.values()) if star in found}

    @cached_property
    def given_terms(self) -> list[Term]:
        """The terms of the actions, in the order of the model; those of kinetic terms are empty."""
        found = []
        for action in self.model.actions:
            in_kinetic = isinstance(action, Lagrangian) and action.is_kinetic
            forces = {} if in_kinetic else self.forces(self.virtual_power(action))
            found.append(Term(action.name, "given", forces))
        return found

    @cached_property
    def reactions(self) -> list[Term]:
        """The terms of perfect constraints and of contacts."""
        found = []
        for row in self.equations.rows:
            if row.law is not Law.SERVO:  # the load that holds it is a given action
                found.append(Term(row.label, "perfect", self.along(row.multiplier, row.rate)))
        for contact in self.equations.contacts:
            push = self.along(contact.multiplier, contact.rate)
            if not contact.normals:
                found.append(Term(contact.label, "perfect", push))
            for slip in contact.slips:
                found.append(Term(contact.label, "imperfect", self.along(slip.force, slip.rate)))
        return found

    def along(self, force: Node, rate: Node) -> dict[int, Node]:
        """Return the generalized forces of a force along a rate."""
        (virtual,) = self.virtual([rate])
        return {j: force * slope for j, slope in self.forces(virtual).items()}


def relative_spin(torque: Torque) -> Vector:
    """Return the angular velocity on which a torque does work."""
    spin = torque.frame.spin
    return spin if torque.reaction is None else sub(spin, torque.reaction.spin)


def rates_of(equations: EquationsOfMotion) -> Rates:
    """Return the motion of `equations` in rates."""
    model = with_named_frames(equations.model)
    declared = build_states(model)
    return Rates(equations, model, build_states(replace(model, speeds=())), declared)


def with_named_frames(model: Model) -> Model:
    """Return the model with the name of a body for its frame where a joint brought that without one."""
    unnamed = [body for body in model.bodies if body.frame is not None and not body.frame.name]
    frames: dict[Frame | None, Frame] = {}
    for body in unnamed:
        if body.frame is not None:
            frames.setdefault(body.frame, replace(body.frame, name=body.name))
    if not frames:
        return model
    bodies = [replace(b, frame=frames.get(b.frame, b.frame)) for b in model.bodies]
    torques = [a for a in model.actions if isinstance(a, Torque)]
    turned = [(frames.get(a.frame, a.frame), frames.get(a.reaction, a.reaction)) for a in torques]
    named = {a.name: replace(a, frame=f, reaction=g) for a, (f, g) in zip(torques, turned)}
    actions = [named.get(a.name, a) for a in model.actions]
    return replace(model, bodies=tuple(bodies), actions=tuple(actions))
