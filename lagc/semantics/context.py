"""State shared while one model is resolved: the graph, time derivatives, faults and chosen effects."""

from __future__ import annotations

from collections.abc import Callable, Container, Sequence
from typing import TYPE_CHECKING, Any

from lagc.base.records import dataclass, replace
from lagc.diagnostics.faults import Fault, Refused, Span
from lagc.semantics.model import Frame, Table
from lagc.semantics.names.namespace import Importer
from lagc.semantics.names.scope import LARGEST, Entry, Environment, Uses, Value
from lagc.semantics.refusals import Poisoned, Wrong
from lagc.semantics.time_derivatives import Clock
from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.vectors import Matrix, Vector
from lagc.syntax import tree

if TYPE_CHECKING:
    from collections.abc import Mapping

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
        self.graph: Graph = Graph() if before is None else before.graph
        self.held: set[str] = set()  # parameters and bodies whose reactions outputs ask for
        self.released: set[str] = set() if before is None else before.held
        self.clock = Clock(self.graph)
        self.time: Node = self.graph.symbol("time", "time")
        self.clock.set_rate(self.time, self.graph.one)
        self.world = _world(self.graph)
        self.components: dict[tuple[Matrix, Vector], Vector] = {}  # vectors in the axes of frames
        self.turns: dict[Matrix, tuple[Matrix, Matrix]] = {}  # axes -> parent axes and rotation
        self.importer = importer
        self.uses = uses
        self.parameters: dict[str, Given] = {}
        self.starts: dict[str, Given] = {}
        self.taken: set[str] = set()
        self.effects: dict[str, tree.Effect] = {}  # by full name
        self.mentioned: list[
            tuple[tree.Name, str]
        ] = []  # effects named by `unless`, with the instance's path
        self.mentioned_velocities: list[tuple[Vector, Span]] = []  # since the last reset
        self.impulses: dict[str, Any] = {}  # the `Discrete` of each contact whose impulse is asked for
        self.actuators: dict[str, str] = {}  # loads that hold a constraint, and that
        self.has_joints = False
        self.linkage: Any = None  # the `Linkage` of the joints, once it is asked for
        self.poses: dict[
            str, Callable[[Vector], Vector]
        ] = {}  # bodies that joints place: drawn point -> place
        self.conditions: list[tuple[tree.Condition, Environment]] = []
        self.whens: list[tuple[tree.When, Environment, str | None]] = []
        self.curves: dict[str, Table] = {}  # by name
        self.fields: dict[tuple[str, tuple[object, ...]], Entry] = {}  # gravity by body and direction
        self.built_in: list[str] = []  # parameters that a run cannot change
        self.scales: dict[str, float] = {}  # that quantities are declared with
        self.faults: list[Fault] = []
        self.warnings: dict[tuple[Span, Span], Fault] = {}  # one for each pair of places
        self.hushed = False  # faults are not reported, while a remedy is looked for
        self._reported: set[tuple[str, Span | None, str]] = set()
        self.count = 0
        self.chain: list[Entry] = []  # declarations that are evaluated, the outermost first
        self.callers: list[Span] = []  # places of the nested calls
        self.all_calls = 0
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
            raise Wrong(
                "LAG0205",
                f"`{entry.path}` depends on itself",
                span,
                related=((entry.span, "declared here"),),
                remedy="break the circle: one of these declarations must not depend on the others",
            )
        if len(self.chain) >= DEEPEST_CHAIN:
            raise Wrong(
                "LAG0218",
                f"a chain of more than {DEEPEST_CHAIN} declarations depend on one another",
                span,
                "put each declaration before those that depend on it",
            )
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
