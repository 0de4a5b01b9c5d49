"""The Model: one scene of a file with every name resolved and every number in SI.

All expressions are nodes of `Model.graph`.  Its leaves are `Symbol`s:

kind            name                 stands for
parameter       l, a.b[2].m          a parameter, kept symbolic to the end
input           u                    a quantity given from outside, a function of time
time            time                 the time t
coordinate      theta, o.w           q_i; an orientation o brings the components w x y z of a unit quaternion
rate            der(theta)           q'_i of a scalar coordinate, order 1
rate            o.rate.x             body-axes angular velocity of an orientation (rad/s), order 0
speed           u1                   a declared generalized speed
acceleration    der(der(theta))      the time derivative of a rate or speed, der(o.rate.x); outputs only
multiplier      string, roll[2]      multiplier of a constraint's row; outputs only

and whole-system quantities, filled in by `mechanics`; outputs only:

energy          energy()             also kinetic() and potential()
power           power(F)             of an action
generalized_force                    of an action (`owner`) along the rate of a coordinate (`component`)
momentum        momentum(theta)      of a coordinate; momentum().x in total
angular_momentum  angular_momentum().x   in total, about the origin

A time derivative taken here (`der(e)`, `velocity(P)`) is already in terms of the rates:
`semantics` differentiates, `mechanics` substitutes rates by speeds where speeds are declared.

A name is the user's, with instance path and subscripts: `a.bob[3]`.  `effect` is the effect
a thing was declared in, or None.
"""

from __future__ import annotations

from typing import TypeAlias

from lagc.base.records import dataclass, field
from lagc.diagnostics.faults import Fault, Span
from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.vectors import Matrix, Vector, dot, matvec
from lagc.syntax.tree import Expression


@dataclass(frozen=True, slots=True)
class Parameter:
    name: str
    symbol: Node
    unit: str  # SI unit text, "" for pure numbers
    display_unit: str
    value: float | None  # SI; None: the run must give it
    minimum: float
    maximum: float
    span: Span
    description: str = ""
    whole: bool = False  # an Integer


@dataclass(frozen=True, slots=True)
class Limit:
    """A computed value with bounds that it must not leave."""

    name: str
    value: Node
    unit: str
    minimum: float
    maximum: float
    span: Span
    remedy: str = ""


@dataclass(frozen=True, slots=True)
class Input:
    name: str
    symbol: Node
    unit: str
    default: float
    minimum: float
    maximum: float
    span: Span
    description: str = ""


@dataclass(frozen=True, slots=True)
class Discrete:
    """A variable that only `when` clauses change. A truth value is stored as 0 or 1."""

    name: str
    symbol: Node
    unit: str
    display_unit: str
    start: Node  # in parameters
    boolean: bool
    span: Span
    description: str = ""


# Levels of a stated initial value: a more specific one is given up later, `FIXED` never.
UNSTATED, DECLARED, SCENE, RUN, FIXED = range(5)


@dataclass(frozen=True, slots=True)
class Statement:
    """The level at which an initial value was stated, and the place."""

    level: int
    span: Span


@dataclass(frozen=True, slots=True)
class Coordinate:
    """A scalar generalized coordinate.  `start` and `rate` are expressions in parameters."""

    name: str
    symbol: Node
    rate_symbol: Node
    unit: str
    display_unit: str
    start: Node
    rate: Node
    start_stated: Statement
    rate_stated: Statement
    span: Span
    description: str = ""
    effect: str | None = None


@dataclass(frozen=True, slots=True)
class Orientation:
    """A unit quaternion (w, x, y, z), body to world; its speeds are the body rates."""

    name: str
    symbols: tuple[Node, Node, Node, Node]
    rate_symbols: Vector
    start: tuple[Node, Node, Node, Node]
    rate: Vector
    start_stated: Statement  # one for all four components
    rate_stated: tuple[Statement, Statement, Statement]
    span: Span
    description: str = ""
    effect: str | None = None


@dataclass(frozen=True, slots=True)
class Speed:
    """A declared generalized speed: `expression` is linear in the rates. `start` is an expression in
    parameters, or None if it follows from the initial rates."""

    name: str
    symbol: Node
    expression: Node
    unit: str
    span: Span
    description: str = ""
    start: Node | None = None
    start_stated: Statement | None = None  # None: not stated


@dataclass(frozen=True, slots=True)
class Frame:
    """`axes[i][j]`: component i (world) of unit vector j, so x_world = axes . x_frame. `angular_velocity` in
    the frame's own axes, `spin` the same in those of the world, in terms of rates."""

    name: str
    parent: str
    axes: Matrix
    angular_velocity: Vector
    spin: Vector
    span: Span | None
    effect: str | None = None


@dataclass(frozen=True, slots=True)
class Point:
    name: str
    position: Vector  # world axes, m
    span: Span
    effect: str | None = None


@dataclass(frozen=True, slots=True)
class Body:
    """A particle (`frame` and `inertia` None) or a solid. `position` is the centre of mass in world axes;
    `inertia` about the centre of mass in the axes of `frame`."""

    name: str
    mass: Node
    position: Vector
    velocity: Vector  # d(position)/dt in terms of rates
    frame: Frame | None
    inertia: Matrix | None
    span: Span
    effect: str | None = None

    @property
    def kinetic_energy(self) -> Node:
        """Return the kinetic energy in terms of rates."""
        energy = 0.5 * self.mass * dot(self.velocity, self.velocity)
        if self.frame is not None and self.inertia is not None:
            spin = self.frame.angular_velocity
            energy = energy + 0.5 * dot(spin, matvec(self.inertia, spin))
        return energy


@dataclass(frozen=True, slots=True)
class Potential:
    """`energy` V(q, t), as in T - V; of a gravity also its strength g and its direction, a unit vector."""

    name: str
    energy: Node
    span: Span
    effect: str | None = None
    gravity: tuple[Node, Vector] | None = None


@dataclass(frozen=True, slots=True)
class Force:
    """`vector` (world axes) applied at a point with `velocity` (world axes, in rates; with `from`, relative).
    `at` is the point, `on_body` tells whether it belongs to a body; `mentioned` are the velocities that the
    vector contains, with their places; `target` is the place of the point in the text."""

    name: str
    vector: Vector
    velocity: Vector
    span: Span
    effect: str | None = None
    target: Span | None = None
    mentioned: tuple[tuple[Vector, Span], ...] = ()
    at: Vector | None = None
    on_body: bool = False


@dataclass(frozen=True, slots=True)
class Torque:
    """`vector` (world axes) on `frame`, and its opposite on `reaction` (None: the ground). `mentioned` and
    `target` as for a force."""

    name: str
    vector: Vector
    frame: Frame
    reaction: Frame | None
    span: Span
    effect: str | None = None
    target: Span | None = None
    mentioned: tuple[tuple[Vector, Span], ...] = ()


@dataclass(frozen=True, slots=True)
class Dissipation:
    """Rayleigh function D(q, rates, t): generalized force -dD/d(rate)."""

    name: str
    function: Node
    span: Span
    effect: str | None = None


@dataclass(frozen=True, slots=True)
class Lagrangian:
    """A free term L(q, rates, t) added to the Lagrangian; `kinetic` adds one to K instead."""

    name: str
    function: Node
    is_kinetic: bool
    span: Span
    effect: str | None = None


Action: TypeAlias = Potential | Force | Torque | Dissipation | Lagrangian


@dataclass(frozen=True, slots=True)
class Constraint:
    """`residuals` = lhs - rhs, one per equation, in coordinates, rates, parameters and time. `labels` names
    the equations: the constraint's name, or `name[1]` ... for a vector (world axes x y z). Residuals that are
    identically zero are not listed."""

    name: str
    labels: tuple[str, ...]
    residuals: tuple[Node, ...]
    units: tuple[str, ...]  # SI unit of each residual
    span: Span
    left: Expression  # as written
    right: Expression
    effect: str | None = None
    actuator: str = ""  # the load that holds it, times its multiplier, in place of its gradient


@dataclass(frozen=True, slots=True)
class Contact:
    """A one-sided constraint gap >= 0, in coordinates, parameters and time, or in velocities too; or the
    friction of a constraint gap = 0 or a joint, whose gap is the constant 0: a contact that always touches,
    with its `normals` in multipliers and reactions. `state` is a discrete variable: 0 open, 1 touching; with
    friction 1 or -1 slipping forwards or backwards, 2 sticking. In space there is no -1."""

    name: str
    label: str  # the name of the constraint, or `name[1]` ... for a vector
    gap: Node
    unit: str
    state: Node
    restitution: Node
    span: Span
    effect: str | None = None
    slip: tuple[Node, ...] = ()  # the velocity with which it slides, of 1 to 3 components; none: no friction
    friction: Node | None = None  # its coefficient
    static: Node | None = None  # that of a contact that sticks
    poisson: bool = False  # the restitution is one of impulses; else of velocities
    normals: tuple[Node, ...] = ()  # components of the normal force of a two-sided contact, which never opens
    bounds_rate: bool = False  # the gap is one between velocities

    @property
    def title(self) -> str:
        return (
            f"the friction of `{self.label}`" if self.normals else f"the one-sided constraint `{self.label}`"
        )

    @property
    def otherwise(self) -> str:
        """The remedy where contacts are not followed. Loads do not depend on reactions of joints."""
        if not self.normals:
            return "write it with `=` where it always touches"
        if self.gap.is_zero:
            return "write the friction as a smooth load, `-c*tanh(s/s0)`"
        return f"write the friction as a load of `reaction({self.label})`, smooth at rest as `tanh(s/s0)` is"

    @property
    def states(self) -> str:
        """The meaning of its state."""
        named = ("1: touches", "1, -1: slips forwards, backwards; 2: sticks", "1: slips; 2: sticks")
        return named[self.slip_rows]

    @property
    def slip_rows(self) -> int:
        """The directions in which it slides: 0 without friction, 1 in a plane motion, 2 in space."""
        count = len(self.slip)
        return count if count < 3 else sum(not node.is_zero for node in self.slip) - 1

    @property
    def mode(self) -> Discrete:
        """The discrete variable that tells whether it touches; a run finds out at its beginning."""
        start = self.state.graph.zero
        return Discrete(self.label, self.state, "", "", start, False, self.span, self.states)


@dataclass(frozen=True, slots=True)
class InitialCondition:
    """A scalar initial equation: residual(q, rates, parameters) = 0."""

    residual: Node
    span: Span


@dataclass(frozen=True, slots=True)
class Table:
    """A function through points: its name, the key of its points and interpolation, and its file and
    column."""

    name: str
    key: str
    file: str = ""
    column: str = ""


@dataclass(frozen=True, slots=True)
class When:
    """An event: when `condition` becomes true, the states in `changes` get new values, computed from the
    values before. The run ends if there is a `reason`, as failed if it `fails`; `marks` are names of the
    event."""

    words: str  # the text of the condition
    condition: Node
    changes: tuple[tuple[Node, Node], ...]
    reason: str | None
    marks: tuple[str, ...]
    span: Span
    effect: str | None = None
    fails: bool = False


@dataclass(frozen=True, slots=True)
class Output:
    name: str
    expression: Node  # may hold acceleration, multiplier and quantity symbols
    unit: str
    display_unit: str
    span: Span
    description: str = ""


@dataclass(frozen=True, slots=True)
class Joint:
    """A joint between two bodies ("world") or two joints. An open one brings `coordinates`, a closing one
    `equations`. `at` is its place in world axes, `axis` its axis; of a `Distance`, `at` and `to` are its
    ends. `about` is the point of the second body about which the moment of its reaction is taken. None: it
    has none."""

    name: str
    kind: str
    between: tuple[str, str]
    coordinates: tuple[str, ...]
    equations: int
    span: Span
    at: Vector | None = None
    axis: Vector | None = None
    to: Vector | None = None
    about: Vector | None = None


@dataclass(frozen=True, slots=True)
class Release:
    """A virtual release: coordinates of the released model that do not move. `forces` are the symbols of the
    reaction in outputs, one for each of the `rates`, in the axes of `axes` (None: as they are). The reaction
    is `held` times the force that holds them, all constraints released, plus `pushed` times the force on them
    of the explicit constraints."""

    forces: tuple[Node, ...]
    rates: tuple[Node, ...]
    values: tuple[tuple[Node, float], ...]  # of the added coordinates; a parameter has its own
    axes: Matrix | None
    held: float
    pushed: float


@dataclass(frozen=True, slots=True)
class Figure:
    """A figure that is drawn. It is carried by the body `body`, or stands at a place ("") or between several:
    `points`. `kind` is Ball, Box, Cylinder, Ring, Plane, Line or Coil; `axis` is a unit vector in world axes;
    `sizes` are lengths in parameters, in the order of the arguments."""

    name: str
    kind: str
    body: str
    points: tuple[Vector, ...]
    axis: Vector | None
    sizes: tuple[Node, ...]
    span: Span
    effect: str | None = None


StateOrGiven: TypeAlias = Parameter | Input | Coordinate | Orientation | Speed | Discrete
Shape: TypeAlias = Frame | Point | Body | Joint | Figure
ModelObject: TypeAlias = StateOrGiven | Shape | Action | Constraint | Contact | Output | Limit | Release


@dataclass(frozen=True, slots=True)
class Effect:
    name: str
    description: str
    used: bool
    span: Span


@dataclass(frozen=True)
class Model:
    name: str
    scene: str
    description: str
    graph: Graph
    time: Node
    parameters: tuple[Parameter, ...]
    inputs: tuple[Input, ...]
    coordinates: tuple[Coordinate | Orientation, ...]  # in order of declaration
    speeds: tuple[Speed, ...]
    frames: tuple[Frame, ...]
    points: tuple[Point, ...]
    bodies: tuple[Body, ...]
    actions: tuple[Action, ...]
    constraints: tuple[Constraint, ...]
    initial_conditions: tuple[InitialCondition, ...]
    outputs: tuple[Output, ...]
    effects: tuple[Effect, ...]
    scenes: tuple[str, ...]
    simulate: dict[str, float] = field(default_factory=dict)  # stop, accuracy, ... of the scene
    whens: tuple[When, ...] = ()
    joints: tuple[Joint, ...] = ()
    discretes: tuple[Discrete, ...] = ()  # the last are the modes of contacts
    contacts: tuple[Contact, ...] = ()
    tables: tuple[Table, ...] = ()
    figures: tuple[Figure, ...] = ()
    limits: tuple[Limit, ...] = ()  # of computed parameters
    scales: dict[str, float] = field(default_factory=dict)  # of quantities that are declared with one
    built_in: tuple[str, ...] = ()  # parameters that a run cannot change: structural, or dependent on others
    imports: tuple[tuple[str, str | None], ...] = ()  # path and fingerprint of every file asked for
    notes: tuple[str, ...] = ()  # assumptions, such as the choice of a scene
    warnings: tuple[Fault, ...] = ()
    released: Model | None = None  # the same scene with the releases that reactions in outputs need
    releases: tuple[Release, ...] = ()
    asked: tuple[str, ...] | None = None  # names of what a run is for; all of them: None

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {self.name}, scene {self.scene}>"

    @property
    def undetermined(self) -> list[Node]:
        """Return the symbols of inputs and discrete variables: no equation of motion determines them."""
        return [*(x.symbol for x in self.inputs), *(x.symbol for x in self.discretes)]

    @property
    def states(self) -> int:
        """Return the number of states: coordinates, and rates or declared speeds."""
        return sum(2 if isinstance(each, Coordinate) else 7 for each in self.coordinates)

    @property
    def turning(self) -> list[Frame]:
        """The frames, also those that only a body has."""
        found = [*self.frames, *(body.frame for body in self.bodies if body.frame is not None)]
        return list(dict.fromkeys(found))
