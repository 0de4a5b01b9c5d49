"""One-sided constraints: `constraint floor: bob.z >= 0 (restitution = 0.8);`.

The gap of `a >= b` is a - b, that of `a <= b` is b - a. It is never negative. A contact touches where its gap
is zero; then it may push its gap open, and never pulls. A gap between velocities, as that of a one-way clutch
`der(hub) >= der(sprocket)`, is a contact at velocity level: it is hit by impulses alone, without rebound.
"""

from collections.abc import Mapping
from math import inf

from lagc.diagnostics.faults import Wrong
from lagc.diagnostics.suggest import did_you_mean
from lagc.semantics import model as objects
from lagc.semantics.context import BIT, MOVING, VELOCITY, Context
from lagc.semantics.declarations.actions import declare_constraint, refuse_late, residuals
from lagc.semantics.declarations.attributes import no_modifiers
from lagc.semantics.names.scope import (
    Array,
    Entry,
    Environment,
    Reference,
    Scalar,
    Value,
    numbers_of,
    scalar_of,
    vector_value,
)
from lagc.semantics.units import NONE, Dimension, describe, dimension, over, si_text, times
from lagc.semantics.units import unit as unit_of
from lagc.semantics.values.evaluate import Argument, all_values, evaluate, evaluate_as
from lagc.semantics.values.kinematics import SPEED, velocity_of
from lagc.semantics.values.unit_hints import expect_of
from lagc.symbolic.graph import Node
from lagc.symbolic.vectors import Vector, sub
from lagc.symbolic.walk import substitute
from lagc.syntax import tree

_BY = ("by",)
_ROUGH = ("friction", "static", "slip", "at", "on", "against")
ARGUMENTS = ("restitution", "friction", "static", "slip", "at", "on", "against", "law")
SECOND = dimension(s=1)
_PLACES = (
    "the place where it touches: `at = P`, for that of a body that turns with `on = body`, beside a body "
    "that moves too with `against = other`"
)
_SLIPS = (
    "write the velocity with which it slides: `slip = der(x)` in the plane, in space two components along "
    "the surface: `slip = {der(x), der(y)}`"
)


def declare_contact(context: Context, entry: Entry) -> Value:
    """Declare a contact for each component of lhs >= rhs or lhs <= rhs."""
    source = entry.source
    assert isinstance(source, tree.Constraint)
    no_modifiers(entry)
    written = _arguments(source, ARGUMENTS, "a one-sided constraint")
    left, right = all_values(context, [source.left, source.right], entry.environment)
    differences = residuals(left, right, source)
    entry.size = None if isinstance(left, Scalar) else len(differences)
    for k, (node, found) in enumerate(differences):
        # A gap is positive while the contact is open, whatever relation was written.
        gap = node if source.relation == ">=" else -node
        bounds_rate = _check(context, source, gap, written)
        label = entry.path if entry.size is None else f"{entry.path}[{k + 1}]"
        # Whether the contact is closed is a discrete variable: it is constant between events.
        symbol = context.graph.symbol("discrete", label)
        context.clock.set_rate(symbol, context.graph.zero)
        restitution = context.graph.zero
        if "restitution" in written:
            restitution = _number(context, entry.environment, "restitution", written["restitution"], 1.0)
        unit, rough = si_text(found or NONE), _friction(context, entry, written, found)
        contact = objects.Contact(
            entry.path, label, gap, unit, symbol, restitution, entry.span, entry.effect, *rough,
            _is_poisson(written), bounds_rate=bounds_rate,
        )  # fmt: skip
        entry.objects.append(contact)
    return Reference(entry)


def declare_rough(context: Context, entry: Entry) -> Value:
    """Declare a constraint with `=` and its friction, a contact that always touches."""
    source = entry.source
    assert isinstance(source, tree.Constraint)
    written = _arguments(source, (*_ROUGH, *_BY), "a constraint with `=`")
    if "by" in written:
        message = "an actuator and friction do not combine in one constraint"
        raise Wrong("LAG0209", message, written["by"].span, "leave out `by`, or the friction")
    # Friction of a constraint that always holds: gap and normal force are those of the constraint, and the
    # state of the contact is its sliding or sticking alone.
    value = declare_constraint(context, entry)
    (row,) = entry.objects
    assert isinstance(row, objects.Constraint)
    span = source.arguments[0].span
    # A residual that vanishes identically has been dropped, and its multiplier with it.
    if not row.labels:
        raise Wrong("LAG0235", f"`{row.name}` always holds, so it has no normal force", span)
    if any(context.clock.mask(node) & VELOCITY for node in row.residuals):
        message = f"`{row.name}` restricts velocities, so it has no normal force that presses"
        remedy = "give friction to the constraint of positions that keeps the contact"
        raise Wrong("LAG0235", message, span, remedy)
    dimension = unit_of(row.units[0] or "1").dimension
    slip, friction, static = _friction(context, entry, written, dimension)
    symbol = context.graph.symbol("discrete", entry.path)
    context.clock.set_rate(symbol, context.graph.zero)
    normal = context.graph.symbol("multiplier", entry.path)
    path, gap, zero = entry.path, row.residuals[0], context.graph.zero
    where, unit = (entry.span, entry.effect), row.units[0]
    contact = objects.Contact(
        path, path, gap, unit, symbol, zero, *where, slip, friction, static, normals=(normal,)
    )
    entry.objects.append(contact)
    return value


def _friction(
    context: Context, entry: Entry, written: Mapping[str, tree.Expression], found: Dimension | None
) -> tuple[tuple[Node, ...], Node | None, Node | None]:
    """Return slip, friction and static friction of a contact whose gap has this dimension."""
    # Checks in the order in which arguments need each other, so that the first message names what to add
    # first.
    for names, other, why in (
        (
            ("slip", "at", "on", "against", "static"),
            "friction",
            "write the coefficient of friction: `friction = 0.3`",
        ),
        (
            ("on", "against"),
            "at",
            "write the place where the bodies touch in place of a slip: `at = G - R*world.z`",
        ),
    ):
        for name in names:
            if name in written and other not in written:
                raise Wrong("LAG0235", f"`{name}` needs `{other}` beside it", written[name].span, why)
    if "friction" not in written:
        return (), None, None
    span = written["friction"].span
    if "slip" not in written and "at" not in written:
        raise Wrong("LAG0235", "`friction` needs `slip` or `at` beside it", span, f"{_SLIPS}; or {_PLACES}")
    if "slip" in written and "at" in written:
        raise Wrong(
            "LAG0235", "`slip` and `at` are two ways to say the same", written["at"].span, "leave one out"
        )
    if entry.size is not None:
        message = "a vector of constraints has no friction"
        remedy = "write a constraint for each component, with its own slip"
        raise Wrong("LAG0235", message, span, remedy)
    # The multiplier of a gap with unit u has the unit J/u, and the slip must have u/s so that friction times
    # slip is a power. In space the normal force is a force in N, whatever the gap measures.
    meant = over(found or NONE, SECOND)
    slip = _slip(context, entry, written, meant)
    return slip, *coefficients(context, entry, written, slip, SPEED if len(slip) == 3 else meant)


def coefficients(
    context: Context,
    entry: Entry,
    written: Mapping[str, tree.Expression],
    slip: tuple[Node, ...],
    meant: Dimension,
) -> tuple[Node, Node | None]:
    """Return the friction of a contact while it slides and while it sticks. In both, `slip` is the speed of
    the slip, unless the model has something of this name. A contact that sticks holds at least as much as one
    that slides."""
    graph, where = context.graph, entry.environment
    # |s| of the vector of slip: the speed for a law of friction such as Stribeck's.
    speed = graph.sqrt(graph.sum([node * node for node in slip]))
    if "slip" not in where.instance.entries:
        where = where.bind({"slip": Scalar(speed, meant)})

    def coefficient(name: str) -> Node:
        found = _number(context, where, name, written[name])
        # A speed is not negative: in a law of friction |slip| is slip itself.
        return substitute(graph, [found], {graph.unary("abs", speed): speed})[0]

    friction = coefficient("friction")
    static = coefficient("static") if "static" in written else None
    # Constants are compared here. Parameters are compared when a run begins.
    if static is not None and static.is_const and friction.is_const and static.value < friction.value:
        message = f"the static friction, {static.value:g}, is less than the friction of a contact that slides"
        remedy = "exchange both, or leave out `static`"
        raise Wrong("LAG0235", message, written["static"].span, remedy)
    if static is not None and context.clock.mask(static - friction) & MOVING:  # others are compared once
        static = graph.binary("max", static, friction)
    return friction, static


def _is_poisson(written: Mapping[str, tree.Expression]) -> bool:
    """Return whether the law of impact is that of Poisson."""
    law = written.get("law")
    if law is None:
        return False
    if not (isinstance(law, tree.Name) and law.name in ("newton", "poisson")):
        message = "there are two laws of impact, `newton` and `poisson`"
        raise Wrong("LAG0235", message, law.span, "write `law = poisson`, or leave it out for Newton's law")
    if "restitution" not in written:
        remedy = "give what is given back: `restitution = 0.5`"
        raise Wrong("LAG0235", "`law` needs `restitution` beside it", law.span, remedy)
    return law.name == "poisson"


def _slip(
    context: Context, entry: Entry, written: Mapping[str, tree.Expression], meant: Dimension
) -> tuple[Node, ...]:
    """Return the velocity with which a contact slides, in 1 to 3 components."""
    source = written["slip"] if "slip" in written else written["at"]
    span = source.span
    if "slip" in written:
        value = evaluate_as(context, source, entry.environment, meant)
    else:
        value = _velocity_at(context, entry, written)
    if isinstance(value, Array):
        nodes, dimension = numbers_of(value, span, "the slip")
    else:
        scalar = scalar_of(value, span, "the slip")
        nodes, dimension = (scalar.node,), scalar.dimension
    # One component in the plane, two along a surface, three in world axes (the part across the surface is
    # then removed).
    if len(nodes) > 3:
        raise Wrong("LAG0235", f"the slip has {len(nodes)} components", span, _SLIPS)
    if len(nodes) == 3:
        meant = SPEED  # the push is then taken along the normal of the surface, whatever the gap measures
    # `slip = x` in place of `der(x)` is the likely mistake: its dimension times 1/s is right.
    if dimension == times(meant, SECOND):
        parts = source.elements if isinstance(source, tree.Vector) else (source,)
        rates = ", ".join([f"der({part.span.text})" for part in parts])
        remedy = f"write its rate: `slip = {{{rates}}}`" if len(parts) > 1 else f"write `slip = {rates}`"
        message = f"the slip is a position; it must be {describe(meant)}"
        raise Wrong("LAG0302", message, span, remedy)
    expect_of(source, dimension, meant, "the slip", describe(meant))
    # A component without velocity is constant: friction could never act along it. One zero component in space
    # is a mechanism in a plane.
    constant = [k for k, node in enumerate(nodes) if not context.clock.mask(node) & VELOCITY]
    for k, node in enumerate(nodes):
        refuse_late(context, node, span, "the slip")
        if k in constant and not (node.is_zero and len(nodes) == 3 and len(constant) == 1):
            which = f"component {k + 1} of the slip" if len(nodes) > 1 else "the slip"
            raise Wrong(
                "LAG0235", f"{which} is no velocity: it depends on no rate of a coordinate", span, _SLIPS
            )
    return nodes


def _velocity_at(context: Context, entry: Entry, written: Mapping[str, tree.Expression]) -> Value:
    """Return the velocity of the place `at`, or of the material point there of the body `on`, less that of
    the body `against`. The world is at rest."""
    given = {
        name: Argument(evaluate(context, written[name], entry.environment), written[name].span)
        for name in ("at", "on", "against")
        if name in written
    }
    place, rest = given["at"], (context.graph.zero, context.graph.zero, context.graph.zero)

    def moves(name: str) -> Vector:
        body = given[name]
        return rest if body.value == context.world else velocity_of(context, body, place)

    found = moves("on") if "on" in given else velocity_of(context, place, None)
    return vector_value(sub(found, moves("against")) if "against" in given else found, SPEED)


def _check(
    context: Context, source: tree.Constraint, gap: Node, written: Mapping[str, tree.Expression]
) -> bool:
    """Return whether the gap is one between velocities. Refuse what has no place in a gap."""
    span = source.left.span.to(source.right.span)
    refuse_late(context, gap, span, "a constraint")
    mask = context.clock.mask(gap)
    bounds_rate = bool(mask & VELOCITY)
    # A bound between velocities has no impact: velocities do not jump at it, so laws of impact and friction
    # are meaningless.
    if bounds_rate and written:
        name, value = next(iter(written.items()))
        message = f"the bound `{source.name}` restricts velocities, so it has no `{name}`"
        remedy = f"leave out `{name}`, or give it to the bound of a position: only surfaces rebound and rub"
        raise Wrong("LAG0235", message, value.span, remedy)
    # The rate of the gap is needed for the moment of closing; those of an input and of a discrete variable
    # are not known.
    for kind, named in (("input", "an input"), ("discrete", "a discrete variable")):
        if mask & BIT[kind]:
            message = f"the bound `{source.name}` depends on {named}, whose time derivative is not known"
            remedy = "write the bound in coordinates, parameters and time"
            raise Wrong("LAG0235", message, span, remedy)
    if not mask & (BIT["coordinate"] | VELOCITY):
        message = f"the bound `{source.name}` depends on no coordinate, so it restricts nothing"
        remedy = "compare an expression of coordinates: `constraint floor: ball.z >= 0;`"
        raise Wrong("LAG0235", message, span, remedy)
    return bounds_rate


def _arguments(source: tree.Constraint, known: tuple[str, ...], what: str) -> dict[str, tree.Expression]:
    """Return the arguments of a contact by name."""
    by_name: dict[str, tree.Expression] = {}
    for argument in source.arguments:
        name, span = argument.name, argument.name_span or argument.span
        if name not in known:
            remedy = (name and did_you_mean(name, known)) or f"the arguments are {', '.join(known)}"
            if name in ARGUMENTS:
                remedy = f"write `>=` or `<=` for a bound that may be hit: only this has a `{name}`"
            elif name in _BY:
                remedy = "write `=`: an actuator holds what is equal"
            raise Wrong("LAG0209", f"{what} has no `{name or argument.span.text}`", span, remedy)
        if name in by_name:
            raise Wrong("LAG0209", f"`{name}` is given twice", span)
        if argument.value is None or argument.arguments:
            raise Wrong("LAG0210", f"`{name}` needs a value", argument.span)
        by_name[name] = argument.value
    return by_name


def _number(
    context: Context, where: Environment, name: str, written: tree.Expression, most: float = inf
) -> Node:
    """Return a number that is not negative and, if it is constant, at most `most`."""
    value = evaluate_as(context, written, where, NONE)
    scalar = scalar_of(value, written.span, f"the {name}")
    expect_of(written, scalar.dimension, NONE, f"the {name}", "a number")
    refuse_late(context, scalar.node, written.span, f"the {name}")
    if scalar.node.is_const and scalar.node.value < 0.0 and most == inf:
        message = f"the {name} is {scalar.node.value:g}, and not from 0"
        raise Wrong("LAG0235", message, written.span, "friction opposes the slip by itself: write its size")
    if scalar.node.is_const and not 0.0 <= scalar.node.value <= most:
        message = f"the {name} is {scalar.node.value:g}, and not from 0 to 1"
        remedy = "0 is an impact without rebound, 1 one without loss of energy"
        raise Wrong("LAG0235", message, written.span, remedy)
    return scalar.node
