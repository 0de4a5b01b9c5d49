"""Dry friction of joints: of the pin of a `Revolute` joint, and along the axis of a `Prismatic` one.

The normal force is the force of the joint across its axis. That of an open joint is a reaction by virtual
release, that of one that closes a loop has the multipliers of its equations as components.
"""

from __future__ import annotations

from lagc.semantics import model as objects
from lagc.semantics.context import Context
from lagc.semantics.declarations.contacts import coefficients
from lagc.semantics.joints.linkage import Joint
from lagc.semantics.joints.poses import Pose
from lagc.semantics.names.scope import Scalar
from lagc.semantics.refusals import Wrong
from lagc.semantics.units import NONE, M, S, over
from lagc.semantics.values.kinematics import SPEED, derivative
from lagc.symbolic.graph import Node
from lagc.symbolic.vectors import Vector, dot, sub


def rub(context: Context, joint: Joint, a: Pose, b: Pose, closes: bool) -> objects.Contact:
    """Return the friction of a joint between bodies at `a` and `b` as a contact that always touches. Raises
    Wrong."""
    entry, turns = joint.entry, joint.name == "Revolute"
    if turns and "radius" not in joint.written:
        message, remedy = "the friction of a pin needs its `radius` beside it", "add `radius = 5e-3 [m]`"
        raise Wrong("LAG0235", message, joint.span("friction"), remedy)
    slip = _slip(context, joint, a, b, closes)
    friction, static = coefficients(context, entry, joint.written, (slip,), over(NONE, S) if turns else SPEED)
    if turns:
        radius = joint.number("radius", M)
        if radius.is_const and radius.value < 0.0:
            message = f"the radius of a pin is not negative: {radius.value:g} m"
            raise Wrong("LAG0235", message, joint.span("radius"), "write the radius without its sign")
        friction, static = friction * radius, None if static is None else static * radius
    symbol = context.graph.symbol("discrete", entry.path)
    context.clock.set_rate(symbol, context.graph.zero)
    zero = context.graph.zero
    return objects.Contact(
        entry.path, entry.path, zero, "", symbol, zero, entry.span, entry.effect, (slip,), friction, static,
        normals=_across(context, joint, a, closes),
    )  # fmt: skip


def _slip(context: Context, joint: Joint, a: Pose, b: Pose, closes: bool) -> Node:
    """Return the rate of the only motion that the joint allows."""
    if not closes:
        value = joint.entry.parts["angle" if joint.name == "Revolute" else "slide"]
        assert isinstance(value, Scalar)
        return derivative(context, value.node, joint.call.span)
    axis = a.along(joint.axes()["z"])
    if joint.name == "Revolute":
        return dot(axis, sub(b.frame.spin, a.frame.spin))
    at = joint.point("at")
    return derivative(context, dot(axis, sub(b.attached(at), a.attached(at))), joint.call.span)


def _across(context: Context, joint: Joint, a: Pose, closes: bool) -> tuple[Node, ...]:
    """Return the two components of the force of the joint across its axis."""
    path, graph = joint.entry.path, context.graph
    if closes:
        return tuple([graph.symbol("multiplier", f"{path}[{k + 1}]") for k in range(2)])
    context.held.add(path)
    x, y, z = (graph.symbol("reaction", path, f"force.{axis}") for axis in "xyz")
    force: Vector = (x, y, z)
    drawn = joint.axes()
    return dot(a.along(drawn["x"]), force), dot(a.along(drawn["y"]), force)
