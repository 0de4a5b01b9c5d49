"""Joints: the table of their kinds, the places of the bodies that they tie, and the linkage of a model.

The kinds are those of ISO 3952-1.  A joint has an axis z, a direction x across it and y = z x x, drawn with
its first body.  The second body moves against the first by slides along these axes, then by turns.  The
equations of a joint that closes a loop are the slides and turns that it does not allow.

The *linkage* tells which joint places each body, and where the bodies are.
A mechanism is drawn in one configuration.  In it, all coordinates of the joints are zero.  A body is placed
by the first joint, in the order of the text, that ties it to a placed body or to the world; the joints that
are left close loops (the spanning tree of J. Wittenburg, *Dynamics of Multibody Systems*, 2008, section
5.3).  The place of a drawn point is a product of the motions of the joints on the way (R. W. Brockett,
*Robotic Manipulators and the Product of Exponentials Formula*, 1984).

A *virtual release* adds coordinates for a reaction in an output to a copy of the model.  The reaction of a
perfect constraint is the generalized force that holds the coordinate which its release adds (J. L. Lagrange,
*Mecanique analytique*, 1788, part 1, section 4; C. Lanczos, *The Variational Principles of Mechanics*, 1970,
section V.5).  The copy is derived once, for the outputs; it is never integrated.
"""

import math
from collections.abc import Mapping
from heapq import heappop, heappush

from lagc.base.records import dataclass, field
from lagc.diagnostics.faults import Poisoned, Span, Wrong
from lagc.diagnostics.suggest import AS_JOINT, did_you_mean
from lagc.semantics.context import LATE, MOVING, Context, set_quaternion_rate
from lagc.semantics.declarations.actions import placeholder_value
from lagc.semantics.model import (
    UNSTATED,
    Body,
    Coordinate,
    Frame,
    ModelObject,
    Orientation,
    Release,
    Statement,
)
from lagc.semantics.names.scope import (
    Entry,
    Environment,
    Instance,
    Modifier,
    Part,
    Scalar,
    Value,
    scalar_in,
    vector_in,
    vector_of,
)
from lagc.semantics.units import NONE, Dimension, M
from lagc.semantics.values.calls import match
from lagc.semantics.values.evaluate import evaluate, evaluate_as, integer
from lagc.semantics.values.frame_vectors import unit_vector
from lagc.semantics.values.kinematics import turned_about, turned_by, turned_frame
from lagc.symbolic.graph import Node
from lagc.symbolic.vectors import Matrix, Vector, add, cross, dot, matvec, scale, sub, transpose
from lagc.symbolic.walk import substitute, symbols
from lagc.syntax import tree

ENDS = ("a", "b")
NO_TURN, ABOUT_Z, ABOUT_Z_AND_X, ANY_TURN = range(4)


@dataclass(frozen=True, slots=True)
class Pair:
    """A pair of bodies: `slides` are coordinates by axis, `turns` those of the rotation. In a `helical` pair
    the turn about z slides the body along z, by the pitch each time round."""

    parameters: tuple[str, ...]
    required: int
    slides: Mapping[str, str] = field(default_factory=dict)
    turns: int = NO_TURN
    angles: tuple[str, ...] = ()
    helical: bool = False

    @property
    def coordinates(self) -> dict[str, str]:
        """Return the type of each coordinate of an open joint."""
        turned = (
            {"orientation": "Orientation"} if self.turns == ANY_TURN else dict.fromkeys(self.angles, "Angle")
        )
        return {**dict.fromkeys(self.slides.values(), "Length"), **turned}

    @property
    def torsor(self) -> str:
        """The force and the moment that the pair can transmit without friction, in its axes x, y, z."""
        # A joint transmits no force along an axis on which it slides freely, and no moment about one on which
        # it turns freely (virtual power of a perfect joint).
        force = ", ".join(["0" if axis in self.slides else letter for axis, letter in zip("xyz", "XYZ")])
        moment = ("L, M, N", "L, M, 0", "0, M, 0", "0, 0, 0")[self.turns]
        # In a screw the force along the axis and the moment about it do no work together: N*angle' +
        # Z*pitch/(2*pi)*angle' = 0.
        return f"{force} | {moment if not self.helical else 'L, M, -Z*pitch/(2*pi)'}"


@dataclass(frozen=True, slots=True)
class Condition:
    """A joint without coordinates of its own, which ties bodies that have a place, or joints."""

    parameters: tuple[str, ...]
    required: int
    ties: str = "body"
    torsor: str = ""
    coordinates: Mapping[str, str] = field(default_factory=dict)


_AXIS, _POINT = (*ENDS, "axis", "at", "along"), (*ENDS, "at")
_ROUGH = ("friction", "static")
_SLIDE, _XY = {"z": "slide"}, {"x": "x", "y": "y"}

KINDS: dict[str, Pair | Condition] = {
    "Weld": Pair(_POINT, 2),
    "Revolute": Pair((*_AXIS, *_ROUGH, "radius"), 4, turns=ABOUT_Z, angles=("angle",)),
    "Prismatic": Pair((*_AXIS, *_ROUGH), 3, _SLIDE),
    "Cylindrical": Pair((*_AXIS, *_ROUGH, "radius"), 4, _SLIDE, ABOUT_Z, ("angle",)),
    "Screw": Pair(
        (*ENDS, "axis", "at", "pitch", "along", *_ROUGH, "radius"),
        5,
        turns=ABOUT_Z,
        angles=("angle",),
        helical=True,
    ),
    "Spherical": Pair(_POINT, 3, turns=ANY_TURN),
    "Universal": Pair(_AXIS, 5, turns=ABOUT_Z_AND_X, angles=("angle1", "angle2")),
    "Planar": Pair(_AXIS, 4, _XY, ABOUT_Z, ("angle",)),
    "PointOnPlane": Pair((*_AXIS, *_ROUGH), 4, _XY, ANY_TURN),
    "LineOnPlane": Pair(_AXIS, 5, _XY, ABOUT_Z_AND_X, ("angle", "tilt")),
    "PointOnLine": Pair((*_AXIS, *_ROUGH), 4, _SLIDE, ANY_TURN),
    "Free": Pair(_POINT, 2, {"x": "x", "y": "y", "z": "z"}, ANY_TURN),
    "Distance": Condition((*ENDS, "at", "to"), 4, torsor="X, 0, 0 | 0, 0, 0"),
    "Rolling": Condition((*ENDS, "normal", "at", "radius", "axis", "along"), 5, torsor="X, Y, Z | 0, 0, 0"),
    "Gear": Condition((*ENDS, "ratio"), 3, "joint"),
    "RackAndPinion": Condition((*ENDS, "radius"), 3, "joint"),
}


@dataclass(frozen=True, slots=True)
class Pose:
    """The place of a body: its point drawn at `drawn` is at `now`; `frame` has the axes of the drawing."""

    frame: Frame
    drawn: Vector
    now: Vector

    def place_of(self, point: Vector) -> Vector:
        """Return the place of the point of the body that is drawn at `point`."""
        return add(self.now, matvec(self.frame.axes, sub(point, self.drawn)))

    def direction_of(self, direction: Vector) -> Vector:
        """Return a drawn direction of the body, in world axes."""
        return matvec(self.frame.axes, direction)


TWO_PI = 2.0 * math.pi


class Joint:
    """A joint with its arguments. `ends` are the entries of two bodies (None: the world) or of two joints."""

    def __init__(self, context: Context, entry: Entry):
        source = entry.source
        assert isinstance(source, tree.Construct)
        self.name, self.kind = kind_of(source)
        assert isinstance(source.value, tree.Call)
        self.context, self.entry, self.call = context, entry, source.value
        own = tree.Call(self.call.function, plain_arguments(source, self.kind), self.call.span)
        found = match(context, own, self.kind.parameters, self.kind.required, f"`{self.name}`")
        self.written = {p: e for p, e in zip(self.kind.parameters, found) if e is not None}
        self.ends = [self._end(end) for end in ENDS]
        if self.ends[0] is self.ends[1]:
            raise Wrong("LAG0233", f"`{entry.path}` ties a body to itself", self.written["b"].span)

    def _end(self, end: str) -> Entry | None:
        expression = self.written[end]
        wanted = self.kind.ties if isinstance(self.kind, Condition) else "body"
        if wanted == "body" and isinstance(expression, tree.Name) and expression.name == "world":
            return None
        found = _entry(self.context, expression, self.entry.environment)
        if found is None or found.kind != wanted:
            what = "two joints" if wanted == "joint" else "two bodies, or a body to `world`"
            raise Wrong("LAG0233", f"`{self.name}` ties {what}; this is neither", expression.span)
        return found

    def span(self, name: str) -> Span:
        return self.written[name].span

    def _value(self, name: str, meant: Dimension) -> Value:
        return evaluate_as(self.context, self.written[name], self.entry.environment, meant)

    def _drawn(self, name: str, nodes: tuple[Node, ...]) -> None:
        # The drawing is one configuration in which the mechanism fits together. A place that depends on
        # coordinates, inputs or time would be drawn differently at each of them.
        if any(self.context.clock.mask(node) & (MOVING | LATE) for node in nodes):
            message = f"`{name}` of `{self.entry.path}` moves; it is a place in the drawing of the mechanism"
            raise Wrong("LAG0234", message, self.span(name), "write it with numbers and parameters")

    def point(self, name: str) -> Vector:
        """Return a drawn point; the origin if it is left out."""
        if name not in self.written:
            zero = self.context.graph.zero
            return (zero, zero, zero)
        vector = vector_in(M, self._value(name, M), self.span(name), f"`{name}`")
        self._drawn(name, vector)
        return vector

    def direction(self, name: str) -> Vector:
        """Return a drawn unit vector."""
        vector = vector_in(NONE, self._value(name, NONE), self.span(name), f"`{name}`")
        self._drawn(name, vector)
        return unit_vector(self.context, vector, self.span(name))

    def number(self, name: str, meant: Dimension) -> Node:
        node = scalar_in(meant, self._value(name, meant), self.span(name), f"`{name}`")
        self._drawn(name, (node,))
        return node

    def axes(self) -> dict[str, Vector]:
        """Return the directions x, y, z of the joint; those of the world if it has no axis."""
        if "axis" not in self.written:
            return dict(zip("xyz", self.context.world.axes))
        z = self.direction("axis")
        x = self.across(z)
        return {"x": x, "y": cross(z, x), "z": z}

    def across(self, z: Vector) -> Vector:
        """Return a direction across z: `along`, else the world axis with the least share in z, made
        perpendicular."""
        if "along" in self.written:
            given = self.direction("along")
            # Gram-Schmidt: the part of `along` perpendicular to the axis.
            across = sub(given, scale(dot(given, z), z))
            if all(node.is_zero for node in across):
                raise Wrong("LAG0233", "`along` has the direction of the axis", self.span("along"))
            return unit_vector(self.context, across, self.span("along"))
        # Constant components decide at once; a component that depends on parameters counts as infinite, as
        # its size is not known while the model is compiled.
        shares = [abs(node.value) if node.is_const else math.inf for node in z]
        k = min(range(3), key=shares.__getitem__)
        # With an unknown component only a world axis with no share at all in z is certain to be across it.
        if shares[k] > 0.0 and math.inf in shares:
            remedy = "give one direction across the axis, `along = ...`"
            raise Wrong("LAG0210", f"`{self.name}` needs the argument `along` here", self.call.span, remedy)
        own = self.context.world.axes[k]
        return unit_vector(self.context, sub(own, scale(dot(own, z), z)), self.call.span)

    def coordinate(self, name: str) -> Value:
        """Return the value of a coordinate, and make it a member of the joint."""
        entry = next(e for e in self.entry.inner if e.name == name)
        value = self.context.value(entry, self.entry.span)
        self.entry.parts[name] = value
        return value

    def scalar(self, name: str) -> Node:
        """Return the symbol of a coordinate."""
        value = self.coordinate(name)
        assert isinstance(value, Scalar)
        return value.node


class Linkage:
    """The joints of a model. `placing` is the joint that places a body; the others close loops."""

    def __init__(self, context: Context, entries: list[Entry]):
        self.context = context
        self.joints: dict[Entry, Joint] = {}
        self.placing: dict[Entry, Joint] = {}
        self.poses: dict[Entry, Pose] = {}
        self.roots: set[Entry] = set()  # bodies that move by coordinates of their own
        self.unplaced: set[Entry] = set()  # bodies of joints that nothing places
        self.has_faults = False  # of joints: the bodies that they would place are unknown
        for entry in entries:
            # A fault makes its own joint useless, but not the others: all of them are checked.
            if entry.kind == "joint" and entry.elements is None:
                try:
                    self.joints[entry] = Joint(context, entry)
                except (Wrong, Poisoned) as fault:
                    entry.state, self.has_faults = "poisoned", True
                    if isinstance(fault, Wrong):
                        context.report(fault)

    def place(self) -> None:
        """Find the joint that places each body.  Raises Wrong."""
        pairs = [joint for joint in self.joints.values() if isinstance(joint.kind, Pair)]
        # A spanning tree of the graph whose nodes are bodies and whose edges are joints: the joints of the
        # tree place bodies, each of the others closes a loop (J. Wittenburg, *Dynamics of Systems of Rigid
        # Bodies*, 1977).
        around: dict[Entry | None, list[int]] = {}
        for k, joint in enumerate(pairs):
            for end in joint.ends:
                around.setdefault(end, []).append(k)
        reached: set[Entry | None] = set()

        def spread(root: Entry | None) -> None:
            reached.add(root)
            # Among the joints that touch the tree, the one declared first is next: which joints close loops
            # depends on the order of declarations alone, and an author can choose it.
            queue = sorted(around.get(root, ()))
            while queue:
                joint = pairs[heappop(queue)]
                for end in joint.ends:
                    if end is not None and end not in reached:
                        reached.add(end)
                        self.placing[end] = joint
                        for k in around[end]:
                            heappush(queue, k)

        # First all that hangs on the world. Then what hangs on bodies that the model itself moves; these
        # bodies keep their own coordinates. Anything else floats without a place.
        spread(None)
        tied = [end for end in around if end is not None]
        for end in tied:
            if end not in reached and self._moves(end):
                self.roots.add(end)
                spread(end)
        unplaced = [end for end in tied if end not in reached]
        self.unplaced.update(unplaced)
        # One report is enough: all of a detached part follow from one missing joint.
        for end in unplaced[:1]:
            remedy = f"for a body that moves freely, write `joint free = Free(world, {end.path});`"
            message = f"no joint ties `{end.path}` to the world, not even through other bodies"
            raise Wrong("LAG0233", message, end.span, remedy)

    def _moves(self, body: Entry) -> bool:
        """Return whether a body that no joint has reached moves by coordinates of its own."""
        nodes: list[Node] = []
        for expression in places_of(body):
            try:
                value = evaluate(self.context, expression, body.environment)
                if isinstance(value, Frame):
                    nodes += [x for row in value.axes for x in row]
                else:
                    nodes += vector_of(value, expression.span, "the position of a body")[0]
            except (Wrong, Poisoned):  # reported when the body is declared
                continue
        return any(self.context.clock.mask(node) & MOVING for node in nodes)

    def closes(self, joint: Joint) -> bool:
        return all(self.placing.get(end) is not joint for end in joint.ends if end is not None)

    def pose(self, body: Entry | None) -> Pose:
        """Return the place of a body; of the world, and of one that no joint places, as drawn."""
        chain: list[Entry] = []
        while body is not None and body not in self.poses and body in self.placing:
            chain.append(body)
            a, b = self.placing[body].ends
            body = a if body is b else b
        if body is None:
            zero = self.context.graph.zero
            pose = Pose(self.context.world, (zero, zero, zero), (zero, zero, zero))
        elif body in self.poses:
            pose = self.poses[body]
        else:
            pose = self.poses[body] = self._own_pose(body)
        for own in reversed(chain):
            # Down the chain from the first placed ancestor: a loop, as chains of thousands of bodies would
            # exceed the depth of recursion.
            joint = self.placing[own]
            pose = self.poses[own] = self._pose_beyond(joint, pose, reverse=own is joint.ends[0])
        return pose

    def _own_pose(self, body: Entry) -> Pose:
        """Return the pose of a body that moves by coordinates of its own, drawn where they and time are 0."""
        value = self.context.value(body, body.span)
        assert isinstance(value, Body)
        frame = self.context.world if value.frame is None else value.frame
        nodes = [*value.position, *(x for row in frame.axes for x in row)]
        graph = self.context.graph
        # The pose where coordinates and time are zero is taken for the drawing; w = 1 of a quaternion is no
        # rotation.
        moving = [x for x in symbols(nodes) if x.record.kind in ("coordinate", "time")]
        at_zero = {x: graph.one if x.record.component == "w" else graph.zero for x in moving}
        drawn = substitute(graph, nodes, at_zero)
        axes = transpose(_matrix(drawn[3:]))
        # R(now) R(drawn)^T turns drawn directions into those of now.
        return Pose(turned_by(self.context, frame, axes), (drawn[0], drawn[1], drawn[2]), value.position)

    def _pose_beyond(self, joint: Joint, pose: Pose, reverse: bool) -> Pose:
        """Return the pose beyond an open joint.  In `reverse`, from b to a, the coordinates of a joint with
        one axis keep their sense: that of b against a."""
        released = joint.entry.path in self.context.released
        at = joint.point("at") if "at" in joint.written or released else pose.drawn
        now, frame, kind = pose.place_of(at), pose.frame, joint.kind
        assert isinstance(kind, Pair)
        axes = joint.axes() if kind.slides or kind.turns in (ABOUT_Z, ABOUT_Z_AND_X) else {}
        sense = -1.0 if reverse and kind.turns <= ABOUT_Z and set(kind.slides) <= {"z"} else 1.0
        # From b to a, all displacements and turns have the other sign, as long as they commute: slides along
        # z and turns about z do. With several axes the order would change too, and coordinates are those of a
        # against b.
        for axis, name in kind.slides.items():
            # Slides first, along the axes of the body before the turn; turns follow, about z, then about the
            # x that has turned with it.
            now = add(now, scale(sense * joint.scalar(name), pose.direction_of(axes[axis])))
        for axis, name in zip("zx", kind.angles):
            turn = sense * joint.scalar(name)
            frame = turned_about(self.context, frame, axes[axis], turn, joint.call.span)
        if kind.turns == ANY_TURN:
            orientation = joint.coordinate("orientation")
            assert isinstance(orientation, Orientation)
            frame = turned_frame(self.context, frame, orientation)
        if kind.helical:
            advance = joint.number("pitch", M) / TWO_PI * (sense * joint.scalar("angle"))
            now = add(now, scale(advance, pose.direction_of(axes["z"])))
        moved = Pose(frame, at, now)
        if released:
            return release_pose(self.context, joint.entry, moved, -1.0 if reverse else 1.0)
        return moved


def _matrix(flat: list[Node]) -> Matrix:
    rows = [(flat[k], flat[k + 1], flat[k + 2]) for k in (0, 3, 6)]
    return rows[0], rows[1], rows[2]


def places_of(body: Entry) -> list[tree.Expression]:
    """Return the expressions of the centre of mass and the frame of a body."""
    source = body.source
    call = source.value if isinstance(source, tree.Construct) else source
    arguments = call.arguments if isinstance(call, tree.Call | tree.Declarator) else ()
    return [a.value for a in arguments if a.name in ("at", "com", "frame") and a.value is not None]


def linkage_of(context: Context, entry: Entry) -> Linkage:
    """Return the linkage of the model that an entry belongs to."""
    found: Linkage | None = context.linkage
    if found is None:
        instance = entry.environment.instance
        while instance.parent is not None:
            instance = instance.parent
        found = context.linkage = Linkage(context, instance.in_order())
        found.place()
    return found


def kind_of(source: tree.Construct) -> tuple[str, Pair | Condition]:
    """Return the name and the kind of a joint.  Raises Wrong."""
    name = ""
    if isinstance(source.value, tree.Call) and isinstance(source.value.function, tree.Name):
        name = source.value.function.name
    if name not in KINDS:
        listed = ", ".join(f"`{known}`" for known in KINDS)
        remedy = did_you_mean(name, KINDS) or AS_JOINT
        raise Wrong("LAG0233", f"a joint is one of these kinds: {listed}", source.value.span, remedy)
    return name, KINDS[name]


def plain_arguments(source: tree.Construct, kind: Pair | Condition) -> tuple[tree.Argument, ...]:
    """Return the arguments without the attributes of coordinates, `angle(start = 1)`."""
    assert isinstance(source.value, tree.Call)
    return tuple([a for a in source.value.arguments if attributes_in(a, kind) is None])


def attributes_in(
    argument: tree.Argument, kind: Pair | Condition
) -> tuple[str, tuple[tree.Argument, ...]] | None:
    """Return the coordinate and its attributes, of `angle(start = 1)`; None of a plain argument."""
    call = argument.value
    if argument.name is not None or not isinstance(call, tree.Call):
        return None
    name = call.function.name if isinstance(call.function, tree.Name) else ""
    return (name, call.arguments) if name in kind.coordinates else None


def _entry(context: Context, e: tree.Expression, environment: Environment) -> Entry | None:
    """Return the declaration that a name means, without its value; None if there is none."""
    if isinstance(e, tree.Name):
        if e.name not in environment.instance.entries:
            evaluate(context, e, environment)  # raises Wrong
            return None
        entry = environment.instance.entries[e.name]
        # Bodies of effects with placeholders mean the entry that the scene gave for them.
        if isinstance(entry.source, tree.Placeholder):
            given = placeholder_value(entry)
            return _entry(context, given.argument.value or e, given.environment)
        return entry
    if isinstance(e, tree.Member):
        base = evaluate(context, e.base, environment)
        found = base.instance.entries.get(e.name) if isinstance(base, Part) else None
    elif isinstance(e, tree.Index):
        base_entry = _entry(context, e.base, environment)
        elements = {} if base_entry is None else base_entry.elements or {}
        found = elements.get(tuple([integer(context, i, environment, "a subscript") for i in e.indices]))
    else:
        return None
    if found is None:
        evaluate(context, e, environment)  # raises Wrong
    return found


def coordinates_of(joint: Entry, instance: Instance) -> list[Entry]:
    """Return the entries of the coordinates that the joint brings if it is open.  Raises Wrong."""
    source = joint.source
    assert isinstance(source, tree.Construct)
    _, kind = kind_of(source)
    assert isinstance(source.value, tree.Call)
    attributes: dict[str, tuple[tree.Argument, ...]] = {}
    for argument in source.value.arguments:
        found = attributes_in(argument, kind)
        if found is not None:
            if found[0] in attributes:
                raise Wrong("LAG0209", f"`{found[0]}` is given twice", argument.span)
            attributes[found[0]] = found[1]
    inner = Instance(f"{joint.path}.", instance.declaration, instance, instance.depth + 1)
    # Coordinates of a joint are members of it, `hinge.angle`, declared as if they were written in a model of
    # their own.
    span, environment = source.name_span, joint.environment
    for name, type_name in kind.coordinates.items():
        declarator = tree.Declarator(name, span, (), (), None, f"{name} of the joint `{joint.path}`", span)
        declaration = tree.Quantities(
            "coordinate", tree.TypeName((type_name,), None, span), (declarator,), (), span
        )
        place = Environment(inner, environment.space, environment.bindings)
        entry = Entry("coordinate", name, declaration, declarator, place, joint.effect)
        entry.modifiers = [
            Modifier(tree.Argument(name, span, None, span, False, attributes.get(name, ())), environment)
        ]
        inner.entries[name] = entry
    return list(inner.entries.values())


ON_BODY = (1.0, 0.0)  # the factors `held`, `pushed`: the force of all constraints
BY_GEOMETRY = (1.0, -1.0)  # the force of what was released, the explicit constraints act as loads
BY_EQUATIONS = (0.0, 1.0)  # the force of the explicit constraints


def release_parameter(context: Context, entry: Entry, symbol: Node, unit: str) -> list[ModelObject]:
    """Return the parameter as a coordinate that does not move."""
    added = _release_coordinate(context, entry, symbol, unit)
    force = context.graph.symbol("reaction", symbol.record.owner)
    return [added, Release((force,), (added.rate_symbol,), (), None, *BY_GEOMETRY)]


def release_place(
    context: Context, entry: Entry, place: Vector, factors: tuple[float, float] = ON_BODY
) -> Vector:
    """Return `place` displaced by three coordinates, along the axes of the world."""
    graph = context.graph
    moved = [graph.symbol("coordinate", f"reaction({entry.path}).{axis}") for axis in "xyz"]
    added = [_release_coordinate(context, entry, symbol, "m") for symbol in moved]
    forces = [graph.symbol("reaction", entry.path, f"force.{axis}") for axis in "xyz"]
    values = [(symbol, 0.0) for symbol in moved]
    rates = tuple([coordinate.rate_symbol for coordinate in added])
    entry.objects += [*added, Release(tuple(forces), rates, tuple(values), None, *factors)]
    return add(place, (moved[0], moved[1], moved[2]))


def release_frame(
    context: Context, entry: Entry, frame: Frame, factors: tuple[float, float] = ON_BODY
) -> Frame:
    """Return `frame` rotated by an orientation."""
    graph, owner = context.graph, f"reaction({entry.path})"
    w, x, y, z = (graph.symbol("coordinate", owner, part) for part in "wxyz")
    a, b, c = (graph.symbol("rate", owner, axis) for axis in "xyz")
    set_quaternion_rate(context.clock, (w, x, y, z), (a, b, c))
    one, zero = graph.one, graph.zero
    start, held = (one, zero, zero, zero), _no_statement(entry.span)
    added = Orientation(owner, (w, x, y, z), (a, b, c), start, (zero, zero, zero), held, (held, held, held),
                        entry.span)  # fmt: skip
    moments = [graph.symbol("reaction", entry.path, f"moment.{axis}") for axis in "xyz"]
    values = tuple(zip((w, x, y, z), (1.0, 0.0, 0.0, 0.0)))
    entry.objects += [added, Release(tuple(moments), (a, b, c), values, frame.axes, *factors)]
    return turned_frame(context, frame, added)


def release_pose(context: Context, joint: Entry, pose: Pose, sense: float) -> Pose:
    """Return a pose beyond an open joint with all six freedoms; `sense` is -1 if it is that of the first
    body."""
    factors = (sense * BY_GEOMETRY[0], sense * BY_GEOMETRY[1])
    now = release_place(context, joint, pose.now, factors)
    return Pose(release_frame(context, joint, pose.frame, factors), pose.drawn, now)


def release_far_side(context: Context, joint: Entry, pose: Pose, at: Vector) -> Pose:
    """Return the pose of the second body of a joint that closes a loop, free against the body itself."""
    now = release_place(context, joint, pose.place_of(at), BY_EQUATIONS)
    return Pose(release_frame(context, joint, pose.frame, BY_EQUATIONS), at, now)


def _release_coordinate(context: Context, entry: Entry, symbol: Node, unit: str) -> Coordinate:
    """Return a coordinate with this symbol."""
    graph, name = context.graph, symbol.record.owner
    rate = graph.symbol("rate", name, order=1)
    context.clock.set_rate(symbol, rate)
    context.clock.set_rate(rate, graph.leaf(rate.record.derivative))
    zero, held = graph.zero, _no_statement(entry.span)
    return Coordinate(name, symbol, rate, unit, unit, zero, zero, held, held, entry.span)


def _no_statement(span: Span) -> Statement:
    return Statement(UNSTATED, span)
