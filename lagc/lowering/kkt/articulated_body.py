"""The articulated-body form of the equations: shared velocities become unknowns.

The velocities of bodies and rows are sums that build on one another, for instance along a chain. A sum that
is used more than once becomes an unknown w_k with one definition

    w_k = sum of c_u u        over speeds and earlier velocities u.

A body contributes its mass to the few unknowns of its velocity, a row its gradient, and

    [A G^T; G 0] (w, -lam) = (r, gamma),      M = J^T A J  with  (v, w) = J v,

is solved without M, at a cost proportional to the number of bodies. Without definitions A is M. For trees
this is the articulated-body method (R. Featherstone, *Rigid Body Dynamics Algorithms*, 2008, ch. 7), found
from the structure of the sums alone.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import islice

from lagc.base.records import dataclass, replace
from lagc.lowering.kkt.fill_ordering import Entry, Structure, entry
from lagc.mechanics.formulation.equations import EquationsOfMotion, Moving
from lagc.mechanics.formulation.states import rate_symbols
from lagc.symbolic.derivative import gradient, partial
from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.walk import evaluate, reachable, substitute, symbols

_Slopes = dict[int, Node]  # by unknown


@dataclass(frozen=True)
class ArticulatedBody:
    """The matrix [A G^T; G 0] and the definitions, as nodes. The unknowns are speeds, multipliers and shared
    velocities."""

    structure: Structure
    entries: dict[Entry, Node]
    coefficients: dict[Entry, Node]  # (lifted unknown, unknown of its definition)
    right: list[Node]  # r and gamma, and what acts on lifted velocities
    heavy: tuple[int, ...] = ()  # lifted velocities that bodies with mass move with


def plain(equations: EquationsOfMotion) -> ArticulatedBody:
    """Return the system without shared velocities: [M G^T; G 0], and tau - h."""
    found = {at: node for at, node in equations.mass_matrix.items() if not node.is_zero}
    n = len(equations.v)
    for k, row in enumerate(equations.rows):
        found.update(((n + k, j), node) for j, node in row.jacobian.items() if not node.is_zero)
    entries = dict(sorted(found.items()))
    structure = Structure(n, len(equations.rows), tuple(entries))
    return ArticulatedBody(structure, entries, {}, [*equations.applied_forces, *_gammas(equations)])


def with_summed_loads(equations: EquationsOfMotion, system: ArticulatedBody) -> ArticulatedBody:
    """Return the plain `system` with given forces and those of inertia carried to the speeds in one sweep."""
    weights = gradient(equations.graph, equations.loads, equations.v)
    r = [weights.get(v, equations.graph.zero) for v in equations.v]
    return replace(system, right=[*r, *_gammas(equations)])


def _gammas(equations: EquationsOfMotion) -> list[Node]:
    return [row.gamma for row in equations.rows]


def articulated_body(equations: EquationsOfMotion) -> ArticulatedBody | None:
    """Return the articulated-body form; None if no velocity is shared."""
    sums = _Sums(equations)
    return sums.system() if sums.definitions else None


class _Sums:
    """The graph of the velocities, and which of its sums are unknowns."""

    def __init__(self, equations: EquationsOfMotion):
        self.equations = equations
        self.rates = [row.rate for row in equations.rows]
        # Velocities of bodies and rows, as far as they depend on speeds; those that are affine in them; and
        # how often each is used.
        carried = [x for part in equations.inertias for x in part.velocity]
        self.moving, self.linear, _ = _affine([*carried, *self.rates, *equations.loads], equations.v)
        _, _, users = _affine([*carried, *self.rates], equations.v)  # loads alone are worth no unknown
        self.number = {v: j for j, v in enumerate(equations.v)}
        self.definitions: dict[int, _Slopes] = {}
        first = len(equations.v) + len(equations.rows)
        # Numbered in the order of the graph: each definition uses speeds and earlier velocities only.
        for node in self._choose(users):
            slopes = self._slopes(dict.fromkeys(node.args, equations.graph.one))
            if slopes:  # else its terms cancel
                k = self.number[node] = first + len(self.definitions)
                self.definitions[k] = slopes

    def _choose(self, users: Mapping[Node, int]) -> list[Node]:
        """Return the sums of two moving terms that bodies and rows use more than once and that combine more
        than one vector. Sums of the components of one vector, as in w x r, stay."""
        # `made_of`: the vectors that a node combines, one of them or more (two stand for any number).
        group = _groups(self.equations)
        made_of: dict[Node, frozenset[object]] = {v: frozenset([group.get(v, v)]) for v in self.equations.v}
        found: list[Node] = []
        for node in self.moving:
            if node in made_of or node not in self.linear:
                continue
            below = [made_of[a] for a in node.args if a in self.linear]
            made_of[node] = frozenset(islice(frozenset().union(*below), 2))  # one, or more than that
            # A sum of two that several bodies or rows share becomes an unknown. From there on it is a vector
            # of its own.
            if node.op == "add" and len(below) == 2 and users.get(node, 0) > 1 and len(made_of[node]) > 1:
                found.append(node)
                made_of[node] = frozenset([group.get(node, node)])
        return found

    def system(self) -> ArticulatedBody:
        n, graph = len(self.equations.v), self.equations.graph
        # A: mass of each body in the unknowns of its velocity; further inertia; the gradients of rows. Then
        # the right-hand side, by one sweep over all loads.
        entries = _Entries(graph)
        for (i, j), node in self.equations.further_inertia.items():
            entries.add(i, j, node)
        moved = self._inertias(entries)
        for k, rate in enumerate(self.rates):
            for u, slope in self._slopes({rate: graph.one}).items():
                entries.add(n + k, u, slope)
        definitions = {k: tuple(slopes) for k, slopes in self.definitions.items()}
        coefficients = {
            (k, u): slope for k, slopes in self.definitions.items() for u, slope in slopes.items()
        }
        kept = dict(sorted(entries.found.items()))
        structure = Structure(n, len(self.rates), tuple(kept), definitions, _influence(definitions, moved))
        acting = self._slopes(self.equations.loads)
        right = [acting.get(u, graph.zero) for u in range(structure.moving)]
        right[n : structure.size] = _gammas(self.equations)
        heavy = sorted(self._heavy()) if self.rates else ()
        return ArticulatedBody(structure, kept, coefficients, right, tuple(heavy))

    def _heavy(self) -> set[int]:
        """Return the shared velocities that a body moves with whose mass is positive for the stated values of
        its parameters."""
        # A mass is positive by its value or by the parameters as they are stated. Only then may a velocity be
        # kept: its mass is the pivot.
        model = self.equations.model
        given = {p.symbol: p.value for p in model.parameters if p.value is not None}
        masses = dict.fromkeys(part.mass for part in self.equations.inertias if isinstance(part.mass, Node))
        known = [mass for mass in masses if symbols([mass]) <= given.keys()]
        positive = {mass for mass, value in zip(known, evaluate(known, given)) if value > 0.0}
        found, one = set[int](), self.equations.graph.one
        for part in self.equations.inertias:
            if part.mass in positive:
                for x in part.velocity:
                    found.update(u for u, slope in self._slopes({x: one}).items() if slope is one)
        return found & self.definitions.keys()

    def _inertias(self, entries: _Entries) -> dict[int, int]:
        """Add the inertias to A. Return, for each unknown, the set of bodies whose velocities contain it, as
        bits of a number."""
        one = self.equations.graph.one
        moved: dict[int, int] = {}
        bodies: dict[str, int] = {}
        # Bodies as bits: the number of bodies that an unknown moves decides the order of elimination.
        for part in self.equations.inertias:
            bit = 1 << bodies.setdefault(part.body.name, len(bodies))
            slopes = [self._slopes({x: one}) for x in part.velocity]
            for row in slopes:
                for u in row:
                    moved[u] = moved.get(u, 0) | bit
            _add_inertia(entries, part, slopes)
        return moved

    def _slopes(self, seeds: Mapping[Node, Node]) -> _Slopes:
        """Return the derivatives of sum of seeds[node] * node by the unknowns: a reverse sweep that ends at
        unknowns."""
        # Reverse accumulation: weights are summed per node from the roots down (users before arguments) and
        # stop at unknowns, which keeps the gradient as short as the definitions.
        graph = self.equations.graph
        found: _Slopes = {}
        weights = dict(seeds)
        for node in reversed(self._moving_below(seeds)):
            weight = weights.get(node)
            if weight is None or weight.is_zero:
                continue
            if node in self.number:
                found[self.number[node]] = weight
                continue
            for k, a in enumerate(node.args):
                if a in self.moving:
                    share = weight if node.op == "add" else graph.mul(weight, partial(graph, node, k))
                    weights[a] = graph.add(weights[a], share) if a in weights else share
        return dict(sorted(found.items()))

    def _moving_below(self, nodes: Iterable[Node]) -> list[Node]:
        """Return the moving nodes below `nodes`, down to unknowns, arguments before users."""
        seen = {node for node in nodes if node in self.moving}
        stack = [node for node in seen if node not in self.number]
        while stack:
            for a in stack.pop().args:
                if a in self.moving and a not in seen:
                    seen.add(a)
                    if a not in self.number:
                        stack.append(a)
        return sorted(seen, key=lambda node: node.index)


class _Entries:
    """Sums of contributions to a symmetric matrix."""

    def __init__(self, graph: Graph):
        self.graph = graph
        self.found: dict[Entry, Node] = {}

    def add(self, i: int, j: int, node: Node) -> None:
        if not node.is_zero:
            at = entry(i, j)
            held = self.found.get(at)
            self.found[at] = node if held is None else self.graph.add(held, node)


def _add_inertia(entries: _Entries, part: Moving, slopes: Sequence[_Slopes]) -> None:
    """Add slopes^T mass slopes, summed over the axes."""
    for i, j, mass in _masses(part):
        # The upper triangle is the mirror of the lower one: each pair counts once.
        for u, c in slopes[i].items():
            for w, d in slopes[j].items():
                if u >= w:
                    entries.add(u, w, c * mass * d)


def _masses(part: Moving) -> Iterator[tuple[int, int, Node]]:
    """Yield the entries of a part's inertia that are not zero."""
    for i in range(3):
        if not isinstance(part.mass, tuple):
            yield i, i, part.mass
            continue
        for j in range(3):
            if not part.mass[i][j].is_zero:
                yield i, j, part.mass[i][j]


def _affine(
    outputs: Sequence[Node], speeds: Sequence[Node]
) -> tuple[dict[Node, None], set[Node], dict[Node, int]]:
    """Return the nodes below `outputs` that depend on speeds, arguments first; those that are affine in the
    speeds; and the number of uses of each, outputs included."""
    # Depth first in the order of the graph. A product is affine if one factor, in the first power, moves.
    linear, moving = set(speeds), dict.fromkeys(speeds)
    users = dict.fromkeys(speeds, 0)
    for node in reachable(outputs):
        if node in moving:
            continue
        changed = [k for k, a in enumerate(node.args) if a in moving]
        if not changed:
            continue
        moving[node], users[node] = None, 0
        for k in changed:
            users[node.args[k]] += 1
        if all(node.args[k] in linear for k in changed) and (
            node.op in ("add", "scale")
            or (node.op == "mul" and len(changed) == 1 and node.value[changed[0]] == 1)
        ):
            linear.add(node)
    for node in outputs:
        if node in users:
            users[node] += 1
    return moving, linear, users


def _groups(equations: EquationsOfMotion) -> dict[Node, object]:
    """Return the nodes that are components of a vector, each with its vector: rates of an orientation,
    angular velocity of a frame."""
    found: dict[Node, object] = {}
    for number, c in enumerate(equations.model.coordinates):
        for rate in rate_symbols(c):
            found[rate] = found[equations.rates[rate]] = ("rates", number)
    for number, frame in enumerate(equations.model.turning):
        for x in _in_speeds(equations, [*frame.angular_velocity, *frame.spin]):
            found.setdefault(x, ("turn", number))
    return found


def _in_speeds(equations: EquationsOfMotion, nodes: Sequence[Node]) -> Sequence[Node]:
    replaced = {rate: node for rate, node in equations.rates.items() if rate is not node}
    return substitute(equations.graph, nodes, replaced) if replaced else nodes


def _influence(definitions: Mapping[int, Sequence[int]], moved: Mapping[int, int]) -> dict[int, int]:
    """Return the number of bodies that a speed moves. A shared velocity has the smallest number of the speeds
    in it."""
    # Backwards over definitions: bodies that move with a shared velocity move with its parts. Then its own
    # number is that of the part that moves fewest.
    reached = dict(moved)
    for k in sorted(definitions, reverse=True):
        for u in definitions[k]:
            reached[u] = reached.get(u, 0) | reached.get(k, 0)
    found = {u: bodies.bit_count() for u, bodies in reached.items() if u not in definitions}
    for k in sorted(definitions):
        found[k] = min(found.get(u, 0) for u in definitions[k])
    return found
