"""Functions of motion: positions, velocities, time derivatives, and what only a run knows."""

from __future__ import annotations

from lagc.diagnostics.faults import Span
from lagc.semantics.context import Context
from lagc.semantics.model import Body, Constraint, Frame, Potential
from lagc.semantics.names.scope import (
    Array,
    Scalar,
    Thing,
    Value,
    expect,
    kind,
    scalar_of,
    vector_of,
    vector_value,
)
from lagc.semantics.time_derivatives import BIT, LATE, VELOCITY
from lagc.semantics.types.refusals import Wrong
from lagc.semantics.types.units import ENERGY, KG, NONE, POWER, Dimension, M, S, dimension, over, times
from lagc.semantics.types.units import unit as unit_of
from lagc.semantics.values.functions import Argument, Table
from lagc.symbolic import vectors
from lagc.symbolic.graph import Node

TABLE = Table()

SPEED = over(M, S)
TURN = over(NONE, S)
MOMENTUM = times(KG, SPEED)
ANGULAR_MOMENTUM = dimension(kg=1, m=2, s=-1)


def derivative(context: Context, node: Node, span: Span) -> Node:
    """d(node)/dt.  Raises Wrong for what has none that is known."""
    mask = context.clock.mask(node)
    if mask & BIT["input"]:
        raise Wrong(
            "LAG0311",
            "the time derivative of an input is not known",
            span,
            "write it as a function of `time`",
        )
    if mask & LATE:
        what = "an acceleration, a reaction or an energy of the run"
        raise Wrong("LAG0219", f"the time derivative of {what} is not known", span)
    return context.clock.derivative(node)


@TABLE.enter("der", "x")
def _der(context: Context, span: Span, x: Argument) -> Value:
    def one(value: Value) -> Value:
        if isinstance(value, Array):
            return Array(tuple([one(element) for element in value.elements]))
        if not isinstance(value, Scalar):
            raise Wrong("LAG0307", f"`der` takes a number or a vector, this is {kind(value)}", x.span)
        found = derivative(context, value.node, x.span)
        return Scalar(found, None if value.dimension is None else over(value.dimension, S))

    return one(x.value)


@TABLE.enter("position", "of")
def _position(context: Context, span: Span, of: Argument) -> Value:
    vector, found = vector_of(of.value, of.span, "what has a position")
    expect(found, M, of.span, "a position")
    return vector_value(vector, M)


def velocity_of(context: Context, of: Argument, at: Argument | None) -> vectors.Vector:
    """Of a point or a centre of mass; with `at`, of the body's material point that is there."""
    if at is not None:
        return material_velocity(context, of, at)
    if isinstance(of.value, Body):
        return of.value.velocity
    vector, found = vector_of(of.value, of.span, "what has a velocity")
    expect(found, M, of.span, "a position")
    x, y, z = (derivative(context, node, of.span) for node in vector)
    return (x, y, z)


def material_velocity(context: Context, of: Argument, at: Argument) -> vectors.Vector:
    """Of the point of a body that is at a place now: v + w x r.  A particle has only its own place."""
    body = of.value
    if not isinstance(body, Body):
        has = ", which has no place" if isinstance(body, Frame) else ""
        raise Wrong("LAG0221", f"`at` names a point of a body, this is {kind(body)}{has}", of.span)
    place, there = vector_of(at.value, at.span, "a point")
    expect(there, M, at.span, "a point")
    if body.frame is not None:
        arm = vectors.sub(place, body.position)
        return vectors.add(body.velocity, vectors.cross(body.frame.spin, arm))
    if place != body.position:
        raise Wrong(
            "LAG0221",
            f"`{body.name}` is a particle, and it is not at this point",
            at.span,
            f"write `at {body.name}`, or make it a `Solid`, which has more points than one",
            ((body.span, "declared here"),),
        )
    return body.velocity


@TABLE.enter("velocity", "of", "at", required=1)
def _velocity(context: Context, span: Span, of: Argument, at: Argument | None) -> Value:
    found = velocity_of(context, of, at)
    context.mentioned_velocities.append((found, span))
    return vector_value(found, SPEED)


@TABLE.enter("acceleration", "of")
def _acceleration(context: Context, span: Span, of: Argument) -> Value:
    x, y, z = (derivative(context, node, of.span) for node in velocity_of(context, of, None))
    return vector_value((x, y, z), over(SPEED, S))


@TABLE.enter("angular_velocity", "of")
def _angular_velocity(context: Context, span: Span, of: Argument) -> Value:
    frame = of.value.frame if isinstance(of.value, Body) else of.value
    if not isinstance(frame, Frame):
        raise Wrong(
            "LAG0221", f"a frame or a solid has an angular velocity, this is {kind(of.value)}", of.span
        )
    context.mentioned_velocities.append((frame.spin, span))
    return vector_value(frame.spin, TURN)


# -- quantities that only a run knows ------------------------------------------------------------


def _quantity(context: Context, kind: str, meant: Dimension, owner: str = "", component: str = "") -> Scalar:
    return Scalar(context.graph.symbol(kind, owner, component), meant)


def _quantities(context: Context, kind: str, meant: Dimension) -> Value:
    return Array(tuple([_quantity(context, kind, meant, component=axis) for axis in "xyz"]))


@TABLE.enter("energy")
def _energy(context: Context, span: Span) -> Value:
    return _quantity(context, "energy", ENERGY)


@TABLE.enter("kinetic", "of", required=0)
def _kinetic(context: Context, span: Span, of: Argument | None) -> Value:
    if of is None:
        return _quantity(context, "kinetic", ENERGY)
    body = of.value
    if not isinstance(body, Body):
        raise Wrong("LAG0221", f"a body has a kinetic energy, this is {kind(body)}", of.span)
    return Scalar(body.kinetic_energy, ENERGY)


@TABLE.enter("potential", "of", required=0)
def _potential(context: Context, span: Span, of: Argument | None) -> Value:
    if of is None:
        return _quantity(context, "potential", ENERGY)
    nouns = of.value.entry.nouns if isinstance(of.value, Thing) else []
    energies = [noun.energy for noun in nouns if isinstance(noun, Potential)]
    if not energies:
        raise Wrong("LAG0221", f"`potential` takes a potential, this is {kind(of.value)}", of.span)
    return Scalar(context.graph.sum(energies), ENERGY)


@TABLE.enter("momentum", "of", required=0)
def _momentum(context: Context, span: Span, of: Argument | None) -> Value:
    if of is None:
        return _quantities(context, "momentum", MOMENTUM)
    if isinstance(of.value, Body):
        return vector_value(vectors.scale(of.value.mass, of.value.velocity), MOMENTUM)
    scalar = scalar_of(of.value, of.span, "what has a momentum")
    symbol = scalar.node.record if scalar.node.op == "symbol" else None
    if symbol is None or symbol.kind != "coordinate" or symbol.component or scalar.dimension is None:
        raise Wrong("LAG0221", "a coordinate or a body has a momentum, this is neither", of.span)
    return _quantity(context, "momentum", over(times(ENERGY, S), scalar.dimension), symbol.owner)


@TABLE.enter("angular_momentum", "of", required=0)
def _angular_momentum(context: Context, span: Span, of: Argument | None) -> Value:
    if of is None:
        return _quantities(context, "angular_momentum", ANGULAR_MOMENTUM)
    body = of.value
    if not isinstance(body, Body):
        raise Wrong("LAG0221", f"a body has an angular momentum, this is {kind(body)}", of.span)
    total = vectors.cross(body.position, vectors.scale(body.mass, body.velocity))
    if body.frame is not None and body.inertia is not None:
        spin = vectors.matvec(body.inertia, body.frame.angular_velocity)
        total = vectors.add(total, vectors.matvec(body.frame.axes, spin))
    return vector_value(total, ANGULAR_MOMENTUM)


@TABLE.enter("power", "of")
def _power(context: Context, span: Span, of: Argument) -> Value:
    if not isinstance(of.value, Thing) or of.value.entry.kind not in _ACTIONS:
        raise Wrong("LAG0221", f"a given action has a power, this is {kind(of.value)}", of.span)
    return _quantity(context, "power", POWER, of.value.entry.path)


_ACTIONS = ("force", "torque", "dissipation", "potential", "gravity", "lagrangian")


@TABLE.enter("reaction", "of")
def _reaction(context: Context, span: Span, of: Argument) -> Value:
    """The multipliers of a constraint; 0 for a row that says nothing."""
    nouns = (
        of.value.entry.nouns if isinstance(of.value, Thing) and of.value.entry.kind == "constraint" else []
    )
    if not nouns or not isinstance(nouns[0], Constraint):
        raise Wrong("LAG0221", f"a constraint has a reaction, this is {kind(of.value)}", of.span)
    row = nouns[0]
    assert isinstance(of.value, Thing)
    found: dict[str, Scalar] = {}
    for label, unit, residual in zip(row.labels, row.units, row.residuals):
        work = POWER if context.clock.mask(residual) & VELOCITY else ENERGY
        meant = over(work, unit_of(unit or "1").dimension)
        found[label] = Scalar(context.graph.symbol("multiplier", label), meant)
    size = of.value.entry.size
    if size is None:
        return found.get(row.name, Scalar(context.graph.zero, None))
    none = Scalar(context.graph.zero, None)
    return Array(tuple([found.get(f"{row.name}[{k + 1}]", none) for k in range(size)]))
