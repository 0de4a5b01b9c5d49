"""The equations on one branch: the values of all relations become symbols.

Each condition that a motion may change becomes a *mode*, a symbol of its own: `sign(g)`, `floor(g)` or the
piece of a table that contains the indicator g. The equations are smooth for each choice of modes. `abs(x)` is
mode*x; `a < b` means that the mode of b - a is positive.

A step ends within round-off of a zero of g, and its stages go beyond. A power whose base is not negative on
its branch, as in max(0, x)^1.5, therefore uses the absolute value of the base.
"""

from collections.abc import Mapping, Sequence

from lagc.base.records import dataclass, replace
from lagc.lowering.kkt.prune import sources
from lagc.lowering.program import FARTHEST
from lagc.mechanics.formulation.equations import EquationsOfMotion, with_jacobians
from lagc.mechanics.formulation.jacobian import formed_of, with_values
from lagc.symbolic.derivative import tangent
from lagc.symbolic.enclosures import extended
from lagc.symbolic.expression_text import Texts, brief
from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.leaves import Table
from lagc.symbolic.operators import COMPARISONS, CORNER, STEP, Interval, smooth_as
from lagc.symbolic.vectors import Matrix, Vector
from lagc.symbolic.walk import depends, missing, substitute, symbols, union

_RELATIONS = smooth_as(CORNER, STEP)
_COUNTING = ("floor", "piece")
_POWERS = ("pow", "sqrt")  # undefined below zero
# Time; what states move; modes of relations without a slope; accelerations and reactions
_TIME, _MOVES, _MODES, _LATE = 1, 2, 4, 8


@dataclass(frozen=True, slots=True)
class EventRelation:
    """A condition that a motion may change. `side` is its indicator g on the branches of other modes, `own`
    its mode there, `natural` its mode as a function of the state alone. `edges` bound the indicator of a
    counted relation, by its mode. `slope` is dg/dt if g is affine in time and nothing else moves it."""

    mode: Node
    side: Node
    own: Node
    natural: Node
    edges: tuple[Node, Node] | None
    slope: Node | None
    words: str
    aside: bool = False  # clauses `when` alone ask for it
    late: bool = False  # accelerations or reactions decide it


def frozen(equations: EquationsOfMotion) -> tuple[EquationsOfMotion, tuple[EventRelation, ...]]:
    """Return the equations along a step and their relations, those with a slope first. A relation depends on
    the modes of relations before it."""
    # Relations of conditions and of given forces may ask for accelerations and reactions: `late`.
    conditions = [when.condition for when in equations.whens]
    asking = [*conditions, *equations.given_forces]
    late = frozenset(symbols(asking) & {*equations.a, *equations.lam, *_forces(equations)})
    # Only relations that time, states or late values move become modes; one of parameters alone is a branch
    # of the compiled code.
    changing = [equations.time, *equations.q, *equations.v]
    moved = depends([*deciding(equations), *conditions], [*changing, *late])
    relation_functions = sorted(
        (node for node in moved if node.op in _RELATIONS), key=lambda node: node.index
    )
    if not relation_functions and not equations.contacts:
        return equations, ()
    # Freezing replaces each such relation by its mode, in all that the rates are made of. Relations that no
    # equation uses then are left out.
    made = _Freezing(equations.graph, frozenset(changing), late, equations.time, relation_functions)
    found = _with_branches(equations, made)
    whens = [replace(x, condition=node) for x, node in zip(equations.whens, made.freeze(conditions))]
    found = replace(found, whens=tuple(whens))
    # Time events first, then those of the state, late ones last: kernels rely on this order.
    ordered = sorted(_used_relations(found, made.relations), key=lambda one: (one.slope is None, one.late))
    # A load that a reaction decides sees all branches in its solve; its mode decides events alone.
    if any(relation.late and not relation.aside for relation in ordered):
        found = _with_late_choices(found, ordered)
    return found, (*ordered, *_contact_relations(found, len(made.relations)))


def _with_late_choices(equations: EquationsOfMotion, relations: Sequence[EventRelation]) -> EquationsOfMotion:
    """Return equations whose loads choose their branch by the multipliers themselves, not by modes: a solve
    for the multipliers sees all branches."""
    graph = equations.graph
    chosen = {relation.mode: relation.own for relation in relations if relation.late}

    def with_choices(nodes: Sequence[Node]) -> list[Node]:
        # Modes of late relations may contain each other.
        found = list(nodes)
        while symbols(found) & chosen.keys():
            found = substitute(graph, found, chosen)
        return found

    return replace(
        equations,
        given_forces=tuple(with_choices(equations.given_forces)),
        loads=dict(zip(equations.loads, with_choices(list(equations.loads.values())))),
        power=with_choices([equations.power])[0],
    )


def _forces(equations: EquationsOfMotion) -> list[Node]:
    """Return the symbols of the forces of contacts."""
    return [force for contact in equations.contacts for force in contact.forces]


def _contact_relations(equations: EquationsOfMotion, count: int) -> list[EventRelation]:
    """Return the relations of slips, whose indicator is the velocity of slip, then that of each contact,
    whose indicator is the gap. Their mode is always 1: kernels turn and replace the indicators of contacts
    that touch."""
    graph, one = equations.graph, equations.graph.one
    sides = [(slip.rate, f"{c.label} sticks or slips") for c in equations.contacts for slip in c.slips]
    sides += [(contact.gap, f"{contact.label} touches") for contact in equations.contacts]
    return [
        EventRelation(graph.symbol("mode", str(count + k)), side, one, one, None, None, text, True)
        for k, (side, text) in enumerate(sides)
    ]


def _used_relations(equations: EquationsOfMotion, relations: Sequence[EventRelation]) -> list[EventRelation]:
    """Return the relations that `equations` depend on. A relation of a load on a body may cancel in the
    forces on the speeds."""
    # From the last relation to the first: each uses modes of those before it. A relation that only clauses
    # read is `aside`.
    moving = [*equations.qdot, *sources(replace(equations, whens=()))]
    reached = symbols([*moving, *formed_of(_gradients(equations))])
    asked = symbols([when.condition for when in equations.whens])
    found = []
    for relation in reversed(relations):  # each depends on others before it
        aside = relation.mode not in reached
        if not aside or relation.mode in asked:
            found.append(replace(relation, aside=aside))
            (asked if aside else reached).update(
                symbols([relation.side, relation.own, *(relation.edges or ())])
            )
    return found[::-1]


class _Freezing:
    def __init__(
        self,
        graph: Graph,
        changing: frozenset[Node],
        late: frozenset[Node],
        time: Node,
        relation_functions: Sequence[Node],
    ) -> None:
        self.graph = graph
        self.known: dict[Node, Node] = {}
        self.modes: dict[Node, Node] = {}  # sign(g), floor(g) or piece(g) -> its mode
        self.relations: list[EventRelation] = []
        self._kinds = dict.fromkeys(changing, _MOVES)  # of what nodes are made of
        self._kinds.update(dict.fromkeys(late, _MOVES | _LATE))
        self._kinds[time] = _TIME
        self._time = time
        self._ranges: dict[Node, Interval] = {}
        self._texts: Texts = {}
        self._asked: dict[Node, Node] = {}  # expression -> the first relation that asks for its sign
        for node in relation_functions:
            for side in self._sides(node):
                self._asked.setdefault(side, node)

    def freeze(self, nodes: Sequence[Node]) -> list[Node]:
        known = self.known
        # Arguments before users: each node is rebuilt on frozen arguments. A relation becomes a mode, a power
        # of a base that vanishes at the end of its branch uses its absolute value.
        for node in missing(nodes, known):
            args = tuple([known[a] for a in node.args])
            if node.op in _RELATIONS:
                known[node] = self._relation(node, args)
            elif node.op in _POWERS:
                known[node] = self.graph.rebuild(node, (self._base(node.args[0]), *args[1:]))
            else:
                known[node] = node if args == node.args else self.graph.rebuild(node, args)
        return [known[node] for node in nodes]

    def _kind(self, node: Node) -> int:
        """Return the bits _TIME, _MOVES, _MODES and _LATE of all that a node is made of."""
        kinds = self._kinds
        for below in missing([node], kinds):
            kinds[below] = union(kinds[a] for a in below.args)
        return kinds[node]

    def freeze_one(self, node: Node) -> Node:
        return self.freeze([node])[0]

    def _relation(self, node: Node, args: tuple[Node, ...]) -> Node:
        graph, op = self.graph, node.op
        # A relation of parameters, or one whose arguments are modes, is no event of its own.
        if not any(self._kind(a) & (_TIME | _MOVES) for a in args):
            return node if args == node.args else graph.rebuild(node, args)
        if op in _COUNTING:
            return self._counted_mode(args[0], node)
        if op in ("abs", "sign"):
            mode = self._sign(args[0], node.args[0], node)
            return mode * args[0] if op == "abs" else mode
        plain = node.args
        # a < b asks for the sign of b - a; min and max choose by it.
        mode = self._sign(graph.sub(args[1], args[0]), graph.sub(plain[1], plain[0]), node)
        if op in COMPARISONS:
            return graph.binary("eq", mode, graph.zero) if op == "eq" else graph.binary(op, graph.zero, mode)
        first = (args[0], args[1]) if op == "min" else (args[1], args[0])
        return graph.select(graph.binary("lt", graph.zero, mode), *first)

    def _sides(self, node: Node) -> list[Node]:
        """Return the expression whose sign `node` asks for, without a number before it, and its opposite."""
        # Two relations with the same indicator, up to a number and a sign, share a mode.
        if node.op in _COUNTING:
            return []
        side = node.args[0] if len(node.args) == 1 else self.graph.sub(node.args[1], node.args[0])
        bare = side.args[0] if side.op == "scale" else side
        return [bare, self._opposite(bare)]

    def _opposite(self, side: Node) -> Node:
        return self.graph.add(*map(self._opposite, side.args)) if side.op == "add" else -side

    def _base(self, base: Node) -> Node:
        """Return the base of a power for its branch and beyond: with the sign of the whole if that is known,
        else with the signs of its factors."""
        whole = self._signed_factor(base)
        # The sign of the whole base, else of its factors with odd powers, that some relation asks for.
        if whole is not self.known[base]:
            return whole
        c, product = (base.value, base.args[0]) if base.op == "scale" else (1.0, base)
        if product in self._asked:
            return self.graph.scale(c, self._signed_factor(product))
        factors = zip(product.args, product.value) if product.op == "mul" else ((product, 1),)
        held = ((self._signed_factor(x) if e % 2 else self.known[x], e) for x, e in factors)
        return self.graph.scale(c, self.graph.product(held))

    def _signed_factor(self, factor: Node) -> Node:
        """Return a factor with the sign that it has on its branch, if that is known."""
        # An interval that does not contain zero tells the sign without a relation.
        graph, frozen = self.graph, self.known[factor]
        low, high = extended(self._ranges, factor)
        if low >= 0.0:
            return frozen if extended(self._ranges, frozen)[0] >= 0.0 else graph.unary("abs", frozen)
        if high <= 0.0:
            return frozen if extended(self._ranges, frozen)[1] <= 0.0 else -graph.unary("abs", frozen)
        asking = self._asked.get(factor)
        if asking is None or not self._kind(frozen) & (_TIME | _MOVES):
            return frozen
        return self._sign(frozen, factor, asking) * graph.unary("abs", frozen)

    def _counted_mode(self, side: Node, node: Node) -> Node:
        """Return floor(side), or the piece of a table that contains `side`, as a mode."""
        # The mode k means k <= side < k + 1, or the piece of the table; beyond its ends there is no edge.
        graph, own = self.graph, self.graph.rebuild(node, (side,))
        if own not in self.modes:
            mode = self._symbol()
            edges = (mode, mode + 1.0)
            if node.op == "piece":
                knots = [*node.value][1:]
                ends = (Table([-FARTHEST, *knots]), Table([*knots, FARTHEST]))
                edges = (graph.looked_up("entry", ends[0], mode), graph.looked_up("entry", ends[1], mode))
            self._add(EventRelation(mode, side, own, node, edges, self._slope(side), self._words(node)))
        return self.modes[own]

    def _sign(self, side: Node, plain: Node, node: Node) -> Node:
        """Return sign(side) as a mode; opposite sides have opposite modes."""
        graph = self.graph
        # sign(c x) = sign(c) sign(x), and sign(-x) = -sign(x): one mode stands for all of them.
        if side.op == "scale":
            mode = self._sign(side.args[0], graph.scale(1.0 / side.value, plain), node)
            return mode if side.value > 0.0 else -mode
        known = self.modes.get(graph.unary("sign", self._opposite(side)))
        if known is not None:
            return -known
        # An indicator that cannot vanish has a constant sign.
        low, high = extended(self._ranges, side)
        if low > 0.0 or high < 0.0:
            return graph.one if low > 0.0 else -graph.one
        own = graph.unary("sign", side)
        if own not in self.modes:
            natural, slope = graph.unary("sign", plain), self._slope(side)
            self._add(EventRelation(self._symbol(), side, own, natural, None, slope, self._words(node)))
        return self.modes[own]

    def _symbol(self) -> Node:
        return self.graph.symbol("mode", str(len(self.relations)))

    def _add(self, relation: EventRelation) -> None:
        late = self._kind(relation.side) & _LATE
        self.modes[relation.own] = relation.mode
        self.relations.append(replace(relation, late=late > 0))
        self._kinds[relation.mode] = late | _MODES if relation.slope is None else 0

    def _slope(self, side: Node) -> Node | None:
        """Return the slope of an indicator that is affine in time and depends on nothing else that varies but
        such modes."""
        # dg/dt is constant along the branch, so the time of the crossing is known: g + slope dt = 0.
        if self._kind(side) != _TIME:
            return None
        (slope,) = tangent(self.graph, [side], {self._time: self.graph.one})
        held = any(symbol.record.kind == "discrete" for symbol in symbols([slope]))
        return None if self._kind(slope) & _TIME or slope.is_zero or held else slope

    def _words(self, node: Node) -> str:
        args = node.args
        first = brief(args[0], self._texts)
        if len(args) == 1:
            passed = {"floor": "a whole number", "piece": "a knot of a table"}.get(node.op, "0")
            return f"{first} passes {passed}"
        second = brief(args[1], self._texts)
        return f"{second} passes {first}" if args[0].is_const else f"{first} passes {second}"


def _vector(flat: Sequence[Node]) -> Vector:
    return flat[0], flat[1], flat[2]


def _matrix(flat: Sequence[Node]) -> Matrix:
    return _vector(flat[:3]), _vector(flat[3:6]), _vector(flat[6:])


def deciding(equations: EquationsOfMotion) -> list[Node]:
    """Return the nodes that the rates are made of."""
    # Inertia, gradients and bias of rows, forces, contacts.
    found = [*equations.qdot, *equations.loads, *equations.loads.values()]
    found += [*equations.bias_forces, *equations.given_forces, equations.power]
    for part in equations.inertias:
        found += [*part.velocity, *part.at_rest, *part.explicit]
        found += [x for row in part.mass for x in row] if isinstance(part.mass, tuple) else [part.mass]
    for row in equations.rows:
        found += [row.rate, row.gamma]
    found += formed_of(_gradients(equations))
    for contact in equations.contacts:
        found += contact.nodes
    return [*found, *equations.further_inertia.values()]


def _gradients(equations: EquationsOfMotion) -> list[Mapping[int, Node]]:
    """Return the gradients of all rows by the speeds."""
    found = [row.jacobian for row in equations.rows]
    return found + [row for contact in equations.contacts for row in contact.jacobians]


def _with_branches(equations: EquationsOfMotion, f: _Freezing) -> EquationsOfMotion:
    """Return `equations` with all nodes of the rates replaced by `f`."""

    # f freezes a scalar mass, or each entry of a tensor.
    def mass(given: Node | Matrix) -> Node | Matrix:
        return (
            _matrix(f.freeze([x for row in given for x in row]))
            if isinstance(given, tuple)
            else f.freeze_one(given)
        )

    inertias = [
        replace(
            part,
            velocity=_vector(f.freeze(part.velocity)),
            at_rest=_vector(f.freeze(part.at_rest)),
            explicit=_vector(f.freeze(part.explicit)),
            mass=mass(part.mass),
        )
        for part in equations.inertias
    ]
    # Gradients of rows and contacts share sums, which are frozen once for all rows.
    rows = [
        replace(row, rate=f.freeze_one(row.rate), gamma=f.freeze_one(row.gamma)) for row in equations.rows
    ]
    jacobians = with_values([row.jacobian for row in rows], f.freeze)
    rows = [replace(row, jacobian=own) for row, own in zip(rows, jacobians)]
    gradients = with_values([row for contact in equations.contacts for row in contact.jacobians], f.freeze)
    contacts = [
        replace(
            contact,
            gap=f.freeze_one(contact.gap),
            rate=f.freeze_one(contact.rate),
            bias=f.freeze_one(contact.bias),
            slips=tuple(
                [replace(x, rate=f.freeze_one(x.rate), bias=f.freeze_one(x.bias)) for x in contact.slips]
            ),
            frictions=tuple(f.freeze(contact.frictions)),
            normals=tuple(f.freeze(contact.normals)),
        )
        for contact in with_jacobians(equations.contacts, gradients)
    ]
    # Two velocities may become one on a branch: their weights add.
    loads: dict[Node, Node] = {}
    for velocity, weight in zip(f.freeze(list(equations.loads)), f.freeze(list(equations.loads.values()))):
        loads[velocity] = loads[velocity] + weight if velocity in loads else weight
    return replace(
        equations,
        qdot=tuple(f.freeze(equations.qdot)),
        inertias=tuple(inertias),
        rows=tuple(rows),
        loads=loads,
        contacts=tuple(contacts),
        further_inertia=dict(
            zip(equations.further_inertia, f.freeze(list(equations.further_inertia.values())))
        ),
        bias_forces=tuple(f.freeze(equations.bias_forces)),
        given_forces=tuple(f.freeze(equations.given_forces)),
        power=f.freeze_one(equations.power),
    )
