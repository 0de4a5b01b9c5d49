"""Declarations of frames, points, loads, energies and constraints, and placeholders for some of them."""

from collections.abc import Callable

from lagc.base.records import replace
from lagc.diagnostics.faults import Span, Wrong
from lagc.semantics import model as objects
from lagc.semantics.context import BIT, LATE, VELOCITY, Context
from lagc.semantics.declarations.attributes import no_modifiers, no_rates
from lagc.semantics.model import Body, Frame
from lagc.semantics.names.scope import (
    Array,
    Entry,
    Environment,
    Indexed,
    Instance,
    Modifier,
    Reference,
    Scalar,
    Value,
    kind,
    scalar_of,
    vector_in,
    vector_of,
    vector_value,
)
from lagc.semantics.units import ENERGY, FORCE, NONE, POWER, Dimension, M, describe, over, si_text, times
from lagc.semantics.values.evaluate import Argument, all_values, both, each, evaluate, evaluate_as
from lagc.semantics.values.unit_hints import expect_of, is_bare, unit_remedy
from lagc.symbolic.graph import Node
from lagc.symbolic.vectors import Vector, sub
from lagc.syntax import tree

KINDS = ("body", "point", "frame")


def placeholder_value(entry: Entry) -> Modifier:
    """Return the outermost argument that gives the placeholder its value.  Raises Wrong if there is none."""
    source = entry.source
    assert isinstance(source, tree.Placeholder)
    if source.kind not in KINDS:
        message = f"the {source.kind} `{entry.name}` needs a value"
        raise Wrong("LAG0210", message, entry.span, f"write `{source.kind} {entry.name} = ...;`")
    for modifier in entry.modifiers:
        if modifier.argument.value is not None:
            return modifier
        raise Wrong("LAG0210", f"`{entry.name}` needs a value", modifier.argument.span)
    inner = entry.environment.instance
    if inner.parent is not None:
        raise _not_given(inner, inner.parent)
    remedy = (
        f"write `{inner.declaration.name} name({entry.name} = ...)` in a model that has this {source.kind}"
    )
    remedy = f"give it here, `{source.kind} {entry.name} = ...;`, or {remedy}"
    raise Wrong("LAG0210", f"the {source.kind} `{entry.path}` is not given", entry.span, remedy)


def _not_given(inner: Instance, parent: Instance) -> Wrong:
    """Return the fault of an instance that lacks placeholders, at its own line, with all of them."""
    instance = parent.entries[inner.path[len(parent.path) : -1].partition("[")[0]]
    written, source = instance.declaration, instance.source
    assert isinstance(written, tree.Instance) and isinstance(source, tree.Declarator)
    missing = {e.span: e.source for e in inner.entries.values() if not e.modifiers}
    lacking = [(span, s) for span, s in missing.items() if isinstance(s, tree.Placeholder)]
    sizes = f"[{', '.join(map(_text, source.dimensions))}]" if source.dimensions else ""
    each = "each " if sizes else ""
    given = [_text(argument) for argument in source.arguments]
    given += [f"{each}{s.name} = {_candidate(parent, s.kind)}" for _, s in lacking]
    remedy = f"write `{'.'.join(written.type.path)} {source.name}{sizes}({', '.join(given)});`"
    lacks = " and ".join(f"the {s.kind} `{s.name}`" for _, s in lacking)
    related = tuple([(span, "declared here") for span, _ in lacking])
    return Wrong("LAG0210", f"`{instance.path}` is not given {lacks}", instance.span, remedy, related)


def _text(written: tree.Argument | tree.Expression) -> str:
    return written.span.text


def _candidate(parent: Instance, kind: str) -> str:
    """Return the only thing of the model that may be meant, or dots."""
    kinds = ("body", "point") if kind == "point" else (kind,)
    known = [e.name for e in parent.entries.values() if e.elements is None and _kind(e) in kinds]
    if not known and kind == "frame":
        return "world"
    return known[0] if len(known) == 1 else "..."


def _kind(entry: Entry) -> str:
    return entry.source.kind if isinstance(entry.source, tree.Placeholder) else entry.kind


def declare_placeholder(context: Context, entry: Entry) -> Value:
    """Return the body, point or frame that the instance gives.  Raises Wrong if it is of another kind."""
    modifier = placeholder_value(entry)
    source, written = entry.source, modifier.argument.value
    assert isinstance(source, tree.Placeholder) and written is not None
    value = evaluate_as(context, written, modifier.environment, M)
    if isinstance(value, Indexed) and modifier.index and not modifier.argument.each:
        from lagc.semantics.values.members import element

        index = tree.Index(written, (written,) * len(modifier.index), written.span)
        value = element(context, value, list(modifier.index), index)
    if source.kind == "point":
        vector = vector_in(M, value, written.span, "a point")
        for node in vector:
            no_rates(context, node, written.span, "a point")
        return vector_value(vector, M)
    if not isinstance(value, Body if source.kind == "body" else Frame):
        message = f"`{entry.name}` of `{entry.environment.instance.declaration.name}` is a {source.kind}"
        related = ((entry.span, "declared here"),)
        raise Wrong("LAG0209", f"{message}; this is {kind(value)}", written.span, related=related)
    return value


_LOADS = (objects.Force, objects.Torque)


def _construct_of(entry: Entry) -> tree.Construct:
    assert isinstance(entry.source, tree.Construct)
    no_modifiers(entry)
    return entry.source


def refuse_late(context: Context, node: Node, span: Span, what: str) -> None:
    if context.clock.mask(node) & LATE:
        late = "an acceleration, a reaction or an energy of the run"
        message = f"{what} depends on {late}, which are only known after the equations are solved"
        remedy = "use them only in outputs and in conditions of `when`"
        if what == "a force":
            remedy = (
                "for friction write `reaction(c)` of a constraint `c`, or the normal force as an expression, "
                "such as `m*g`; use others only in outputs and in conditions of `when`"
            )
        raise Wrong("LAG0219", message, span, remedy)


def declare_frame(context: Context, entry: Entry) -> Value:
    source = _construct_of(entry)
    value = evaluate(context, source.value, entry.environment)
    if not isinstance(value, Frame):
        raise Wrong(
            "LAG0221", f"a frame is a rotation of another frame; this is {kind(value)}", source.value.span
        )
    for row in value.axes:
        for node in row:
            no_rates(context, node, source.value.span, "a frame")
            refuse_late(context, node, source.value.span, "a frame")
    frame = replace(value, name=entry.path, span=entry.span, effect=entry.effect)
    entry.objects.append(frame)
    return frame


def declare_point(context: Context, entry: Entry) -> Value:
    source = _construct_of(entry)
    value = evaluate_as(context, source.value, entry.environment, M)
    vector = vector_in(M, value, source.value.span, "a point")
    for node in vector:
        no_rates(context, node, source.value.span, "a point")
        refuse_late(context, node, source.value.span, "a point")
    entry.objects.append(objects.Point(entry.path, vector, entry.span, entry.effect))
    return vector_value(vector, M)


def _energy_like(context: Context, entry: Entry, meant: Dimension) -> tuple[Node, Span]:
    source = _construct_of(entry)
    span = source.value.span
    scalar = scalar_of(
        evaluate_as(context, source.value, entry.environment, meant), span, f"the {entry.kind} `{entry.name}`"
    )
    expect_of(source.value, scalar.dimension, meant, f"the {entry.kind} `{entry.name}`", describe(meant))
    refuse_late(context, scalar.node, span, f"a {entry.kind}")
    return scalar.node, span


def declare_potential(context: Context, entry: Entry) -> Value:
    node, span = _energy_like(context, entry, ENERGY)
    if context.clock.mask(node) & VELOCITY:
        message = "a potential must not depend on a rate"
        remedy = "write a term of the Lagrangian with rates as `lagrangian L = ...;`"
        raise Wrong("LAG0313", message, span, remedy)
    entry.objects.append(objects.Potential(entry.path, node, entry.span, entry.effect))
    return Reference(entry)


def declare_free_term(context: Context, entry: Entry) -> Value:
    """Declare a `lagrangian` or `kinetic` term."""
    node, _ = _energy_like(context, entry, ENERGY)
    term = objects.Lagrangian(entry.path, node, entry.kind == "kinetic", entry.span, entry.effect)
    entry.objects.append(term)
    return Reference(entry)


def declare_dissipation(context: Context, entry: Entry) -> Value:
    try:
        node, _ = _energy_like(context, entry, POWER)
    except Wrong as wrong:
        fault = wrong.fault
        remedy = _of_rate(context, entry) or fault.remedy
        raise Wrong(fault.code, fault.message, fault.span, remedy, fault.related) from None
    entry.objects.append(objects.Dissipation(entry.path, node, entry.span, entry.effect))
    return Reference(entry)


def _is_rate(part: tree.Expression) -> bool:
    return isinstance(part, tree.Call) and part.span.text.startswith("der(")


def _of_rate(context: Context, entry: Entry) -> str | None:
    """Return a remedy for a dissipation that is a force, `c*der(x)`, and not half its power."""
    value = _construct_of(entry).value
    if not isinstance(value, tree.Binary) or value.op != "*" or not _is_rate(value.right):
        return None
    from lagc.semantics.names.undeclared import dimension_of  # where there is a fault

    rate = dimension_of(context, value.right, entry.environment)
    if rate is None:
        return None
    unit = f" [{si_text(over(POWER, times(rate, rate)))}]" if is_bare(value.left) else ""
    factor, speed = value.left.span.text, value.right.span.text
    return f"a dissipation is half the power: write `1/2*{factor}{unit}*{speed}^2`"


def declare_load(context: Context, entry: Entry) -> Value:
    """Declare `force F = vector on body at point` or `torque M = vector on body from other`."""
    source = entry.source
    assert isinstance(source, tree.Load)
    no_modifiers(entry)
    is_force = source.kind == "force"
    meant = FORCE if is_force else ENERGY
    context.mentioned_velocities = []
    # All parts are evaluated before one is checked, so that the faults of all are reported.
    written = [(source.value, meant), (source.target, M)]
    written += [(part, M) for part in (source.body, source.reaction) if part is not None]
    value, target, *others = each(
        context, lambda part: evaluate_as(context, part[0], entry.environment, part[1]), written
    )
    body = others.pop(0) if source.body is not None else None
    reaction = others.pop(0) if source.reaction is not None else None
    mentioned = tuple(context.mentioned_velocities)
    place = Argument(target, source.target.span)

    # The multipliers of constraints are the only late quantities that a load may depend on: friction.
    def load() -> Vector:
        about = None if is_force or not isinstance(value, Scalar) else _about_axis(source, target)
        vector, found = vector_of(value, source.value.span, f"a {source.kind}", about)
        named = "Force [N]" if is_force else "Torque [N.m]"
        expect_of(source.value, found, meant, f"the {source.kind} `{entry.name}`", named)
        for node in vector:
            if context.clock.mask(node) & LATE & ~BIT["multiplier"]:
                refuse_late(context, node, source.value.span, f"a {source.kind}")
        return vector

    # A force acts on a point, with its velocity; a torque on frames, with their angular velocities.
    if is_force:
        vector, (velocity, at, on_body) = both(
            context, load, lambda: _where_applied(context, source, place, body, reaction)
        )
        force = objects.Force(
            entry.path, vector, velocity, entry.span, entry.effect, source.target.span, mentioned, at, on_body
        )
        entry.objects.append(force)
    else:
        vector, (frame, opposite) = both(context, load, lambda: _frames(source, target, reaction))
        torque = objects.Torque(
            entry.path, vector, frame, opposite, entry.span, entry.effect, source.target.span, mentioned
        )
        entry.objects.append(torque)
    # The load of this name can be referred to, as by an actuator.
    return Reference(entry)


def _about_axis(source: tree.Load, target: Value) -> str:
    """Return a remedy for a torque that is a number: the axis about which the frame turns, or any axis."""
    size = source.value.span.text
    if isinstance(source.value, tree.Binary | tree.Conditional):
        size = f"({size})"
    frame = target.frame if isinstance(target, Body) else target
    if not isinstance(frame, Frame):
        return f"for a torque about the axis z write `{size}*world.z`"
    name = source.target.span.text + ("" if frame is target else ".frame")
    turning = [k for k in range(3) if not frame.angular_velocity[k].is_zero]
    if len(turning) == 1:
        axis = "xyz"[turning[0]]
        return f"`{name}` turns about its axis {axis}: write `{size}*{name}.{axis}`"
    return f"name the axis: `{size}*{name}.x`, `{size}*{name}.y` or `{size}*{name}.z`"


def _where_applied(
    context: Context, source: tree.Load, place: Argument, body: Value | None, reaction: Value | None
) -> tuple[Vector, Vector, bool]:
    """Return the velocity of the point where a force acts, that point, and whether it belongs to a body. With
    `from`, the velocity is relative to the material point of the other body."""
    from lagc.semantics.values.kinematics import material_velocity, velocity_of  # loaded where it acts

    at = place.value.position if isinstance(place.value, Body) else None
    if body is None or source.body is None:
        if source.reaction is not None:
            message = "`from` is only allowed for a torque, or for a force `on` a body"
            remedy = "write `on body at point from other`, or declare the opposite force separately"
            raise Wrong("LAG0221", message, source.reaction.span, remedy)
        is_body, at = at is not None, at or vector_of(place.value, place.span, "a point")[0]
        return velocity_of(context, place, None), at, is_body
    velocity = material_velocity(context, Argument(body, source.body.span), place)
    at = at or vector_of(place.value, place.span, "a point")[0]
    if reaction is None or source.reaction is None:
        return velocity, at, True
    other = material_velocity(context, Argument(reaction, source.reaction.span), place)
    return sub(velocity, other), at, True


def _frames(source: tree.Load, target: Value, reaction: Value | None) -> tuple[Frame, Frame | None]:
    """Return the frames on which a torque and its reaction act."""
    opposite = _frame_of(reaction, source.reaction) if reaction and source.reaction else None
    return _frame_of(target, source.target), opposite


def _frame_of(value: Value, written: tree.Expression) -> Frame:
    if isinstance(value, Frame):
        return value
    if isinstance(value, Body) and value.frame is not None:
        return value.frame
    message, remedy = f"a torque acts on a solid or a frame; this is {kind(value)}", None
    if isinstance(value, Body):
        message += " without a frame"
        remedy = "write `body b = Solid(mass = m, inertia = {I1, I2, I3}, frame = F, com = P);`"
    elif isinstance(value, Scalar):
        angle = written.span.text
        remedy = f"if this is an angle, write `on rotate_y(world, {angle})` for the frame that it turns"
    raise Wrong("LAG0221", message, written.span, remedy)


def declare_constraint(context: Context, entry: Entry) -> Value:
    """Declare the equations lhs - rhs = 0; components that are identically zero are left out."""
    source = entry.source
    assert isinstance(source, tree.Constraint)
    no_modifiers(entry)
    held = any(argument.name == "by" for argument in source.arguments)
    motor = _actuator(context, entry, source) if held else None
    left, right = all_values(context, [source.left, source.right], entry.environment)
    differences = residuals(left, right, source)
    entry.size = None if isinstance(left, Scalar) else len(differences)
    labels: list[str] = []
    rows: list[Node] = []
    units: list[str] = []
    # A component that is identically zero is no equation, but keeps its number: `c[3]` may follow `c[1]`.
    for k, (node, found) in enumerate(differences):
        refuse_late(context, node, source.left.span.to(source.right.span), "a constraint")
        if not node.is_zero:
            labels.append(entry.path if entry.size is None else f"{entry.path}[{k + 1}]")
            rows.append(node)
            units.append(si_text(found or NONE))
    sides = source.left, source.right
    by = "" if motor is None else motor.path
    constraint = objects.Constraint(
        entry.path, tuple(labels), tuple(rows), tuple(units), entry.span, *sides, entry.effect, by
    )
    entry.objects.append(constraint)
    if motor is not None and len(labels) != 1:
        message = f"`{motor.name}` is one actuator; `{entry.name}` has {len(labels)} equations"
        raise Wrong("LAG0221", message, entry.span, "write a constraint and an actuator for each equation")
    return Reference(entry)


def _actuator(context: Context, entry: Entry, source: tree.Constraint) -> Entry:
    """Return the force or torque that holds a constraint: `(by = motor)`."""
    argument = source.arguments[0]
    if argument.name != "by" or argument.value is None or len(source.arguments) > 1:
        message = "`by` is given once, and names the force or torque that holds the constraint"
        remedy = "write `constraint path: x = f(time) (by = motor);`, or no argument"
        raise Wrong("LAG0209", message, argument.span, remedy)
    value = evaluate(context, argument.value, entry.environment)
    loads = value.entry.objects if isinstance(value, Reference) else []
    if not isinstance(value, Reference) or not any(isinstance(x, _LOADS) for x in loads):
        message = f"an actuator is a force or a torque; this is {kind(value)}"
        remedy = "declare what it does for a multiplier of 1: `force motor = {1 [N], 0, 0} at cart;`"
        raise Wrong("LAG0221", message, argument.value.span, remedy)
    if value.entry.path in context.actuators:
        message = f"`{value.entry.name}` holds `{context.actuators[value.entry.path]}` already"
        raise Wrong("LAG0221", message, argument.value.span, "declare an actuator for each constraint")
    context.actuators[value.entry.path] = entry.name
    return value.entry


def residuals(
    left: Value, right: Value, source: tree.Constraint | tree.Condition
) -> list[tuple[Node, Dimension | None]]:
    """Return left - right for each component, with its dimension.  Raises Wrong."""
    for value, side in ((left, source.left), (right, source.right)):
        if not isinstance(value, Scalar | Array | Body):
            raise Wrong("LAG0307", f"an equation needs numbers or vectors; this is {kind(value)}", side.span)
    if isinstance(left, Scalar) and isinstance(right, Scalar):
        pairs = [(left, right)]
    elif isinstance(left, Array) and isinstance(right, Array) and len(left.elements) == len(right.elements):
        what, components = "a component", zip(left.elements, right.elements)
        one, other = source.left.span, source.right.span
        pairs = [(scalar_of(a, one, what), scalar_of(b, other, what)) for a, b in components]
    else:
        message = f"the two sides have different shapes: {kind(left)} and {kind(right)}"
        raise Wrong("LAG0306", message, source.relation_span, _zeros(left, right))
    found: list[tuple[Node, Dimension | None]] = []
    # A zero or a number of unknown dimension takes that of the other side.
    for a, b in pairs:
        if a.dimension is not None and b.dimension is not None and a.dimension != b.dimension:
            first, second = describe(a.dimension), describe(b.dimension)
            message = f"the two sides have different dimensions: {first} and {second}"
            remedy = unit_remedy(source.left, b.dimension) or unit_remedy(source.right, a.dimension)
            related = ((source.left.span, first), (source.right.span, second))
            raise Wrong("LAG0301", message, source.relation_span, remedy, related)
        found.append((a.node - b.node, a.dimension or b.dimension))
    return found


def _zeros(left: Value, right: Value) -> str | None:
    """Return the remedy for a scalar 0 that is compared with an array."""
    for zero, array in ((left, right), (right, left)):
        if isinstance(array, Array) and isinstance(zero, Scalar) and zero.node.is_zero:
            return f"write `{{{', '.join('0' * len(array.elements))}}}` instead of `0`"
    return None


def condition(
    context: Context, written: tree.Condition, environment: Environment
) -> list[objects.InitialCondition]:
    """Return the scalar initial equations of one line of an `initial` section.  Raises Wrong."""
    left, right = all_values(context, [written.left, written.right], environment)
    found: list[objects.InitialCondition] = []
    for node, _ in residuals(left, right, written):
        refuse_late(context, node, written.left.span.to(written.right.span), "an initial condition")
        if not node.is_zero:
            found.append(objects.InitialCondition(node, written.span))
    return found


DECLARE: dict[str, Callable[[Context, Entry], Value]] = {
    "frame": declare_frame, "point": declare_point, "potential": declare_potential,
    "kinetic": declare_free_term, "lagrangian": declare_free_term, "dissipation": declare_dissipation,
    "force": declare_load, "torque": declare_load, "constraint": declare_constraint,
    "placeholder": declare_placeholder,
}  # fmt: skip
