"""State shared while one model is resolved: the graph, time derivatives, faults and chosen effects."""

from __future__ import annotations

from collections.abc import Callable, Container, Sequence
from typing import TYPE_CHECKING, Any, TypeVar

from lagc.base.records import dataclass, replace
from lagc.diagnostics.faults import Fault, Poisoned, Refused, Span, Wrong
from lagc.semantics.model import Frame, Table
from lagc.semantics.names.namespace import Importer
from lagc.semantics.names.scope import LARGEST, Entry, Environment, Uses, Value
from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.leaves import QUANTITIES
from lagc.symbolic.vectors import Matrix, Vector, axis_rates
from lagc.syntax import tree

if TYPE_CHECKING:
    from collections.abc import Mapping


T = TypeVar("T")

_LEAVES = "parameter input time coordinate rate speed discrete acceleration multiplier"
KINDS = (*_LEAVES.split(), *QUANTITIES)
BIT = {kind: 1 << k for k, kind in enumerate(KINDS)}
MOVING = BIT["input"] | BIT["time"] | BIT["coordinate"] | BIT["rate"] | BIT["speed"] | BIT["discrete"]
# Known once the equations are solved.
LATE = BIT["acceleration"] | BIT["multiplier"] | sum(BIT[kind] for kind in QUANTITIES)
VELOCITY = BIT["rate"] | BIT["speed"]


class Clock:
    """Time derivatives of nodes; `set_rate` gives those of the symbols."""

    def __init__(self, graph: Graph):
        self.graph = graph
        self._rate: dict[Node, Node] = {}
        self._mask: dict[Node, int] = {}
        self.axes: dict[Node, Matrix] = {}  # component -> axes of the first frame that has it

    def set_rate(self, symbol: Node, rate: Node) -> None:
        """Set d(symbol)/dt = rate."""
        self._rate[symbol] = rate

    def add_frame(self, frame: Frame) -> None:
        """Set the time derivatives of the axes of a frame, e_k' = w x e_k."""
        for component in (x for row in frame.axes for x in row):
            node = component.args[0] if component.op == "scale" else component
            if not node.is_const:
                self.axes.setdefault(node, frame.axes)
        for node, rate in axis_rates(frame.axes, frame.angular_velocity).items():
            self._rate.setdefault(node, rate)

    def derivative(self, node: Node) -> Node:
        """Return d(node)/dt.  Inputs, multipliers and similar symbols have none (check `mask` first)."""
        from lagc.symbolic.derivative import partials  # loaded where something moves

        graph = self.graph

        def rate(top: Node, known: dict[Node, Node]) -> Node:
            total = graph.zero
            if any(not known[a].is_zero for a in top.args):
                for local, argument in zip(partials(graph, top), top.args):
                    total = total + local * known[argument]
            return total

        return _value_by_arguments(node, self._rate, rate)

    def mask(self, node: Node) -> int:
        """Return the kinds of symbols below `node`, one bit each."""

        def kinds(top: Node, known: dict[Node, int]) -> int:
            found = BIT[top.record.kind] if top.op == "symbol" else 0
            for argument in top.args:
                found |= known[argument]
            return found

        return _value_by_arguments(node, self._mask, kinds)


def set_quaternion_rate(clock: Clock, q: tuple[Node, Node, Node, Node], w: tuple[Node, Node, Node]) -> None:
    """Set q' = 1/2 q (0, w) for a unit quaternion with the body rates w, and the derivatives of w."""
    a, b, c = w
    e, x, y, z = q
    runs = (-x * a - y * b - z * c, e * a + y * c - z * b, e * b + z * a - x * c, e * c + x * b - y * a)
    for symbol, rate in zip(q, runs):
        clock.set_rate(symbol, 0.5 * rate)
    for rate in w:
        clock.set_rate(rate, clock.graph.leaf(rate.record.derivative))


def _value_by_arguments(node: Node, known: dict[Node, T], find: Callable[[Node, dict[Node, T]], T]) -> T:
    """Return `known[node]`, computed from its arguments in a loop, because graphs are deep."""
    stack = [node]
    while stack:
        top = stack[-1]
        if top in known:
            stack.pop()
            continue
        missing = [a for a in top.args if a not in known]
        if missing:
            stack.extend(missing)
            continue
        stack.pop()
        known[top] = find(top, known)
    return known[node]


Points = tuple[Sequence[float], Sequence[float], str]

MOST_FAULTS = 200
MOST_CALLERS = 3  # calls shown with a fault in a function, the innermost first
DEEPEST_CHAIN = 1000  # nested evaluations of declarations


@dataclass(frozen=True, slots=True)
class Given:
    """A value from a scene or the command for `owner` or for its rate. It is one of: an `expression` with its
    `environment`; a `number` in `unit` (SI if None); or `points` of time and value in SI with the kind of
    interpolation."""

    owner: str
    expression: tree.Expression | None = None
    environment: Environment | None = None
    number: float = 0.0
    unit: str | None = None
    points: Points | None = None
    span: Span | None = None


class Context:
    """State of one resolution. `parameters` and `starts` hold the values from outside the model, by full
    name; used names are added to `taken`. `declare` finds the value of a declaration, `evaluators` the value
    of each kind of expression."""

    def __init__(
        self,
        importer: Importer,
        uses: Uses,
        declare: Callable[[Context, Entry], Value],
        evaluators: Mapping[type, Callable[..., Value]],
        before: Context | None = None,
    ):
        """`before` is the resolution of the same scene without the releases that its reactions need."""
        # The graph of the resolution before is shared, so that nodes of both can be compared.
        self.graph: Graph = Graph() if before is None else before.graph
        self.held: set[str] = set()  # parameters and bodies whose reactions outputs ask for
        self.released: set[str] = set() if before is None else before.held
        self.clock = Clock(self.graph)
        self.time: Node = self.graph.symbol("time", "time")
        self.clock.set_rate(self.time, self.graph.one)
        # Kinematics: the world, and caches of vectors in the axes of frames.
        self.world = _world(self.graph)
        self.components: dict[tuple[Matrix, Vector], Vector] = {}  # vectors in the axes of frames
        self.turns: dict[Matrix, tuple[Matrix, Matrix]] = {}  # axes -> parent axes and rotation
        self.importer = importer
        self.uses = uses
        # Values from outside the model, and which of them were used.
        self.parameters: dict[str, Given] = {}
        self.starts: dict[str, Given] = {}
        self.taken: set[str] = set()
        # Effects, and names that `unless` mentions.
        self.effects: dict[str, tree.Effect] = {}  # by full name
        self.mentioned: list[tuple[tree.Name, str]] = []  # with the paths of instances
        # Gathered by declarations as they are evaluated, for those that come later.
        self.mentioned_velocities: list[tuple[Vector, Span]] = []  # since the last reset
        self.impulses: dict[str, Any] = {}  # the `Discrete` of each contact whose impulse is asked for
        self.actuators: dict[str, str] = {}  # loads that hold a constraint, and that
        self.has_joints = False
        self.linkage: Any = None  # the `Linkage` of the joints, once it is asked for
        # Bodies that joints place: from a drawn point to its place.
        self.poses: dict[str, Callable[[Vector], Vector]] = {}
        self.conditions: list[tuple[tree.Condition, Environment]] = []
        self.whens: list[tuple[tree.When, Environment, str | None]] = []
        self.curves: dict[str, Table] = {}  # by name
        self.fields: dict[tuple[str, tuple[object, ...]], Entry] = {}  # gravity by body and direction
        self.built_in: list[str] = []  # parameters that a run cannot change
        self.scales: dict[str, float] = {}  # that quantities are declared with
        # Faults and warnings, each once.
        self.faults: list[Fault] = []
        self.warnings: dict[tuple[Span, Span], Fault] = {}  # one for each pair of places
        self.hushed = False  # faults are not reported, while a remedy is looked for
        self._reported: set[tuple[str, Span | None, str]] = set()
        # Guards against endless models: declarations, nested evaluations, calls.
        self.count = 0
        self.chain: list[Entry] = []  # declarations that are evaluated, the outermost first
        self.callers: list[Span] = []  # places of the nested calls
        self.all_calls = 0
        # Functions are inlined: results by their arguments.
        self.called: set[int] = set()  # functions, by identity
        self.results: dict[tuple[str, int, tuple[Value, ...]], Value] = {}  # results of functions
        self.constants: dict[tuple[int, str], Value] = {}  # constants of files and packages
        self.running: set[tuple[int, str]] = set()
        self._declare = declare
        self.evaluators = evaluators

    def report(self, wrong: Wrong) -> None:
        fault = wrong.fault
        key = (fault.code, fault.span, fault.message)
        if self.hushed or len(self.faults) >= MOST_FAULTS or key in self._reported:
            return
        self._reported.add(key)
        if self.callers and fault.span is not None:
            calls = [(span, "called here") for span in self.callers[: -MOST_CALLERS - 1 : -1]]
            fault = replace(fault, related=(*fault.related, *calls))
        self.faults.append(fault)

    def attempt(self, job: Callable[..., object], *arguments: Any) -> bool:
        """Call `job`.  Return False if it failed, after its fault is reported, or if there are too many
        faults."""
        if len(self.faults) >= MOST_FAULTS:
            return False
        try:
            job(*arguments)
        except Wrong as wrong:
            self.report(wrong)
            return False
        except Poisoned:
            return False
        return True

    def look(self, job: Callable[[], object], codes: Container[str]) -> None:
        """Call `job` and keep only its faults with these `codes`."""
        before, self.faults = self.faults, []
        self.attempt(job)
        self.faults = before + [fault for fault in self.faults if fault.code in codes]

    def grow(self, span: Span) -> None:
        """Count one more declaration.  Raises Wrong if there are too many."""
        self.count += 1
        if self.count > LARGEST:
            raise Wrong("LAG0218", f"the model has more than {LARGEST} declarations and list elements", span)

    def value(self, entry: Entry, span: Span) -> Value:
        """Return the value of a declaration, computed at the first call. `span` is the place that uses it.
        Raises Wrong if the declaration depends on itself, Poisoned if its own fault is already reported."""
        if entry.state == "done" and entry.value is not None:
            return entry.value
        if entry.state == "poisoned":
            raise Poisoned
        if entry.state == "running":
            message = f"`{entry.path}` depends on itself"
            remedy = "break the circle: one of these declarations must not depend on the others"
            related = ((entry.span, "declared here"),)
            raise Wrong("LAG0205", message, span, remedy, related)
        if len(self.chain) >= DEEPEST_CHAIN:
            message = f"a chain of more than {DEEPEST_CHAIN} declarations depend on one another"
            remedy = "put each declaration before those that depend on it"
            raise Wrong("LAG0218", message, span, remedy)
        # A fault is reported once, at its own place; declarations that depend on it raise Poisoned. While
        # faults are hushed, as for a trial, the declaration stays new, so that it is reported later.
        entry.state = "running"
        self.chain.append(entry)
        try:
            entry.value = self._declare(self, entry)
        except Wrong as wrong:
            self.report(wrong)
            entry.state = "new" if self.hushed else "poisoned"
            raise Poisoned from None
        except Poisoned:
            entry.state = "new" if self.hushed else "poisoned"
            raise
        finally:
            self.chain.pop()
        entry.state = "done"
        return entry.value

    def give(self, table: Mapping[str, Given], name: str) -> Given | None:
        """Return the entry `name` of `table` and mark it as used."""
        found = table.get(name)
        if found is not None:
            self.taken.add(name)
        return found

    def refuse_faults(self) -> None:
        """Raise Refused if there are faults."""
        for wrong in self.importer.faults:
            self.report(wrong)
        faults = list(self.faults)
        for refused in self.importer.refused:
            faults.extend(refused.faults)
        if any(f.severity == "error" for f in faults):
            raise Refused(list(dict.fromkeys(faults)))


def _world(graph: Graph) -> Frame:
    one, zero = graph.one, graph.zero
    axes, zeros = ((one, zero, zero), (zero, one, zero), (zero, zero, one)), (zero, zero, zero)
    return Frame("world", "", axes, zeros, zeros, None)
