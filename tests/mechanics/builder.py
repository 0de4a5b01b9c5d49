"""A small builder of Models, so that the mechanics is tested without the language."""

from collections.abc import Sequence

from lagc.diagnostics.faults import Source, Span
from lagc.mechanics.formulation.states import quaternion_rate
from lagc.semantics.model import (
    FIXED,
    UNSTATED,
    Action,
    Body,
    Constraint,
    Coordinate,
    Dissipation,
    Force,
    Frame,
    InitialCondition,
    Input,
    Lagrangian,
    Model,
    Orientation,
    Output,
    Parameter,
    Potential,
    Speed,
    Statement,
    Torque,
)
from lagc.symbolic.derivative import tangent
from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.vectors import Matrix, Vector, matmul, matvec, transpose
from lagc.syntax.tree import Name

SPAN = Span(Source("built.lag", "built\n"), 0, 5)
SIDE = Name("built", SPAN)


class Builder:
    """Collects things and makes the Model; vectors are triples of nodes or numbers."""

    def __init__(self, name: str = "Built") -> None:
        self.name = name
        self.graph = Graph()
        self.time = self.graph.symbol("time", "time")
        self.parameters: list[Parameter] = []
        self.inputs: list[Input] = []
        self.coordinates: list[Coordinate | Orientation] = []
        self.speeds: list[Speed] = []
        self.frames: list[Frame] = []
        self.bodies: list[Body] = []
        self.actions: list[Action] = []
        self.constraints: list[Constraint] = []
        self.conditions: list[InitialCondition] = []
        self.outputs: list[Output] = []
        one, zero = self.graph.one, self.graph.zero
        axes: Matrix = ((one, zero, zero), (zero, one, zero), (zero, zero, one))
        self.world = Frame("world", "", axes, (zero, zero, zero), (zero, zero, zero), None)

    # -- leaves ---------------------------------------------------------------

    def parameter(self, name: str, value: float = 1.0) -> Node:
        symbol = self.graph.symbol("parameter", name)
        inf = float("inf")
        self.parameters.append(Parameter(name, symbol, "", "", value, -inf, inf, SPAN))
        return symbol

    def input(self, name: str, default: float = 0.0) -> Node:
        symbol = self.graph.symbol("input", name)
        inf = float("inf")
        self.inputs.append(Input(name, symbol, "", default, -inf, inf, SPAN))
        return symbol

    def coordinate(
        self, name: str, start: float = 0.3, rate: float = 0.0, unit: str = "", fixed: bool = False
    ) -> Node:
        g = self.graph
        symbol, speed = g.symbol("coordinate", name), g.symbol("rate", name, order=1)
        said = Statement(FIXED if fixed else UNSTATED, SPAN)
        self.coordinates.append(
            Coordinate(name, symbol, speed, unit, unit, g.const(start), g.const(rate), said, said, SPAN)
        )
        return symbol

    def orientation(self, name: str, rate: Sequence[float] = (0.0, 0.0, 0.0)) -> tuple[Frame, Orientation]:
        """A quaternion and the frame that it turns."""
        g = self.graph
        ew, x, y, z = (g.symbol("coordinate", name, k) for k in "wxyz")
        w = self.vector([g.symbol("rate", name, k) for k in "xyz"])
        start = (g.one, g.zero, g.zero, g.zero)
        said = Statement(UNSTATED, SPAN)
        o = Orientation(name, (ew, x, y, z), w, start, self.vector(rate), said, (said,) * 3, SPAN)
        self.coordinates.append(o)
        axes = (
            (1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - ew * z), 2.0 * (x * z + ew * y)),
            (2.0 * (x * y + ew * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - ew * x)),
            (2.0 * (x * z - ew * y), 2.0 * (y * z + ew * x), 1.0 - 2.0 * (x * x + y * y)),
        )
        frame = Frame(f"{name}.frame", "world", axes, w, matvec(axes, w), SPAN)
        self.frames.append(frame)
        return frame, o

    def speed(self, name: str, expression: Node) -> Node:
        symbol = self.graph.symbol("speed", name)
        self.speeds.append(Speed(name, symbol, expression, "", SPAN))
        return symbol

    # -- kinematics -----------------------------------------------------------

    def vector(self, v: Sequence[Node | float]) -> Vector:
        x, y, z = (self.graph.as_node(c) for c in v)
        return (x, y, z)

    @property
    def flow(self) -> dict[Node, Node]:
        flow = {self.time: self.graph.one}
        for c in self.coordinates:
            if isinstance(c, Coordinate):
                flow[c.symbol] = c.rate_symbol
            else:
                flow.update(zip(c.symbols, quaternion_rate(c.symbols, c.rate_symbols)))
        return flow

    def der(self, node: Node) -> Node:
        return tangent(self.graph, [node], self.flow)[0]

    def velocity(self, position: Vector) -> Vector:
        x, y, z = tangent(self.graph, list(position), self.flow)
        return (x, y, z)

    def rotate(self, name: str, parent: Frame, axis: str, angle: Node) -> Frame:
        """`parent` turned about its own x, y or z."""
        g = self.graph
        c, s, one, zero = g.cos(angle), g.sin(angle), g.one, g.zero
        turns: dict[str, Matrix] = {
            "x": ((one, zero, zero), (zero, c, -s), (zero, s, c)),
            "y": ((c, zero, s), (zero, one, zero), (-s, zero, c)),
            "z": ((c, -s, zero), (s, c, zero), (zero, zero, one)),
        }
        turn = turns[axis]
        carried = matvec(transpose(turn), parent.angular_velocity)
        w = list(carried)
        w["xyz".index(axis)] = w["xyz".index(axis)] + self.der(angle)
        axes, own = matmul(parent.axes, turn), (w[0], w[1], w[2])
        frame = Frame(name, parent.name, axes, own, matvec(axes, own), SPAN)
        self.frames.append(frame)
        return frame

    # -- bodies, actions, constraints -------------------------------------------

    def particle(self, name: str, mass: Node, at: Sequence[Node | float]) -> Body:
        position = self.vector(at)
        body = Body(name, mass, position, self.velocity(position), None, None, SPAN)
        self.bodies.append(body)
        return body

    def solid(
        self,
        name: str,
        mass: Node,
        inertia: Sequence[Node | float],
        frame: Frame,
        at: Sequence[Node | float] = (0.0, 0.0, 0.0),
    ) -> Body:
        """`inertia`: the principal triple."""
        position, zero = self.vector(at), self.graph.zero
        a, b, c = self.vector(inertia)
        matrix = ((a, zero, zero), (zero, b, zero), (zero, zero, c))
        body = Body(name, mass, position, self.velocity(position), frame, matrix, SPAN)
        self.bodies.append(body)
        return body

    def potential(self, name: str, energy: Node) -> None:
        self.actions.append(Potential(name, energy, SPAN))

    def gravity(self, g: Node | float) -> None:
        """One potential m g z for all bodies so far, along -z."""
        self.potential("field", self.graph.sum(b.mass * g * b.position[2] for b in self.bodies))

    def force(self, name: str, vector: Sequence[Node | float], at: Sequence[Node | float]) -> None:
        point = self.vector(at)
        self.actions.append(Force(name, self.vector(vector), self.velocity(point), SPAN))

    def torque(
        self, name: str, vector: Sequence[Node | float], frame: Frame, reaction: Frame | None = None
    ) -> None:
        self.actions.append(Torque(name, self.vector(vector), frame, reaction, SPAN))

    def dissipation(self, name: str, function: Node) -> None:
        self.actions.append(Dissipation(name, function, SPAN))

    def lagrangian(self, name: str, function: Node, is_kinetic: bool = False) -> None:
        self.actions.append(Lagrangian(name, function, is_kinetic, SPAN))

    def constraint(self, name: str, *residuals: Node | float) -> None:
        nodes = [self.graph.as_node(r) for r in residuals]
        labels = [name] if len(nodes) == 1 else [f"{name}[{k + 1}]" for k in range(len(nodes))]
        kept = [(label, r) for label, r in zip(labels, nodes) if not r.is_zero]
        labels, nodes = [x for x, _ in kept], [r for _, r in kept]
        units = ("",) * len(kept)
        self.constraints.append(Constraint(name, tuple(labels), tuple(nodes), units, SPAN, SIDE, SIDE))

    def initially(self, residual: Node) -> None:
        self.conditions.append(InitialCondition(residual, SPAN))

    def output(self, name: str, expression: Node) -> None:
        self.outputs.append(Output(name, expression, "", "", SPAN))

    def quantity(self, kind: str, owner: str = "", component: str = "") -> Node:
        return self.graph.symbol(kind, owner, component)

    def model(self) -> Model:
        return Model(
            name=self.name,
            scene="default",
            description="",
            graph=self.graph,
            time=self.time,
            parameters=tuple(self.parameters),
            inputs=tuple(self.inputs),
            coordinates=tuple(self.coordinates),
            speeds=tuple(self.speeds),
            frames=tuple(self.frames),
            points=(),
            bodies=tuple(self.bodies),
            actions=tuple(self.actions),
            constraints=tuple(self.constraints),
            initial_conditions=tuple(self.conditions),
            outputs=tuple(self.outputs),
            effects=(),
            scenes=("default",),
        )
