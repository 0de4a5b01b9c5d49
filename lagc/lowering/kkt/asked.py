"""Parts of a system that nothing asked for depends on.

Speeds that the mass matrix, constraints or contacts couple are one component.  A component reads what its
forces, inertia, constraints and events contain.  Components that are not read from what is asked for are left
out: their motion acts on nothing that stays, by the structure of the equations.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from lagc.base.records import replace
from lagc.mechanics.formulation.equations import EquationsOfMotion, Moving, WhenEquations
from lagc.mechanics.formulation.states import position_symbols, rate_symbols
from lagc.symbolic.graph import Node
from lagc.symbolic.walk import substitute, symbols


class Components:
    """Disjoint sets of symbols: coordinates, speeds, accelerations, multipliers, discrete variables; and the
    nodes that each reads."""

    def __init__(self, equations: EquationsOfMotion) -> None:
        self.leader: dict[Node, Node] = {}
        self.read: list[tuple[Node, Sequence[Node]]] = []
        v = equations.v
        known = {*equations.q, *v, *(x.symbol for x in equations.model.discretes)}
        self.tie([(v[j], equations.a[j]) for j in range(len(v))])
        for (i, j), m in equations.mass_matrix.items():
            self.add([v[i], v[j]], [m])
        for q, qdot in zip(equations.q, equations.qdot):
            self.add([q, *(symbols([qdot]) & set(v))], [qdot])
        for k in equations.quaternions:
            self.add(equations.q[k : k + 4], [])
        for j, forces in enumerate(zip(equations.bias_forces, equations.given_forces)):
            self.add([v[j]], forces)
        for row in equations.rows:
            self.add([row.multiplier, *(v[j] for j in row.jacobian)], [row.residual, row.rate, row.gamma])
        for contact in equations.contacts:
            touched = [v[j] for own in contact.jacobians for j in own]
            self.add([*contact.forces, contact.contact.state, *touched], contact.nodes)
        for residual, _ in equations.initial_conditions:
            self.add([s for s in symbols([residual]) if s in known], [])
        for when in equations.whens:
            for state, value in when.changes:
                self.add([state], [when.condition, value])

    def tie(self, pairs: Sequence[tuple[Node, Node]]) -> None:
        for a, b in pairs:
            self.leader[self.find(a)] = self.find(b)

    def add(self, together: Sequence[Node], reads: Sequence[Node]) -> None:
        """Tie symbols, which read these nodes."""
        self.tie([(together[0], other) for other in together] if together else [])
        self.read += [(together[0], reads)] if together else []

    def find(self, symbol: Node) -> Node:
        while self.leader.setdefault(symbol, symbol) is not symbol:
            symbol = self.leader[symbol]
        return symbol

    def reached(self, symbols_: set[Node]) -> set[Node]:
        """The leaders of all components that these symbols depend on."""
        reads: dict[Node, set[Node]] = {}
        for symbol, nodes in self.read:
            reads.setdefault(self.find(symbol), set()).update(symbols(nodes))
        found: set[Node] = set()
        pending = [self.find(s) for s in symbols_ if s in self.leader]
        while pending:
            leader = pending.pop()
            if leader not in found:
                found.add(leader)
                pending += [self.find(s) for s in reads.get(leader, ()) if s in self.leader]
        return found


def _is_asked(when: WhenEquations) -> bool:
    """Return whether a clause ends the run, or gives no state a new value."""
    return when.clause.reason is not None or not when.changes


def leave_out(equations: EquationsOfMotion) -> tuple[EquationsOfMotion, tuple[list[int], list[int]]]:
    """Return `equations` without what `model.asked` and the outputs do not depend on, with the old columns,
    and the q and v that stay.  Clauses that end the run or give no new values are asked for."""
    model = equations.model
    components = Components(equations)
    wanted = symbols([o.expression for o in equations.outputs])
    asked = set(model.asked or ())
    for c in model.coordinates:
        own = (*position_symbols(c), *rate_symbols(c))
        if c.name in asked or any(s.record.name in asked for s in own):
            wanted.update(own)
    wanted.update(s for s in equations.v if s.record.name in asked)
    wanted |= symbols([w.condition for w in equations.whens if _is_asked(w)])
    reached = components.reached(wanted)

    def stays(symbol: Node) -> bool:
        return components.find(symbol) in reached

    q = [i for i, s in enumerate(equations.q) if stays(s)]
    v = [j for j, s in enumerate(equations.v) if stays(s)]
    if not v or (len(q) == len(equations.q) and len(v) == len(equations.v)):
        return equations, (list(range(len(equations.q))), list(range(len(equations.v))))
    return _without(equations, components, reached), (q, v)


def _without(equations: EquationsOfMotion, components: Components, reached: set[Node]) -> EquationsOfMotion:
    graph, model, v = equations.graph, equations.model, equations.v

    def gone(symbol: Node) -> bool:
        return symbol in components.leader and components.find(symbol) not in reached

    rest = {s: start.value for s, start in zip(equations.q, equations.starts_q) if gone(s)}
    rest.update((s, graph.zero) for s in (*equations.v, *equations.a, *equations.lam) if gone(s))
    rest.update((x.symbol, x.start) for x in model.discretes if gone(x.symbol))
    lost = set(rest)

    def at_rest(nodes: Sequence[Node]) -> list[Node]:
        return substitute(graph, nodes, rest)

    def own(node: Node) -> Node:
        """A sum without the terms of what is left out alone."""
        if node.op == "add":
            return graph.add(*[own(term) for term in node.args])
        if node.op == "scale":
            return graph.scale(node.value, own(node.args[0]))
        found = symbols([node])
        if found & lost and not found & (known - lost):
            return graph.zero
        return at_rest([node])[0]

    known = {*equations.q, *equations.v, *equations.a, *equations.lam, *(x.symbol for x in model.discretes)}
    parts = [_at_rest(part, at_rest) for part in equations.inertias]
    idle = {id(part.body) for part in equations.inertias} - {
        id(part.body) for part, old in zip(parts, equations.inertias)
        if not all(x.is_zero for x in part.velocity) or all(x.is_zero for x in old.velocity)
    }  # fmt: skip
    sums = [own(x) for x in (equations.kinetic, equations.potential, equations.energy, equations.power)]
    whens = [replace(w, changes=tuple([(s, x) for s, x in w.changes if not gone(s)]))
             for w in equations.whens if _is_asked(w) or not all(gone(s) for s, _ in w.changes)]  # fmt: skip
    velocities = at_rest([*equations.loads, *equations.loads.values()])
    loads: dict[Node, Node] = {}
    for velocity, weight in zip(velocities, velocities[len(equations.loads) :]):
        if not velocity.is_const:
            loads[velocity] = graph.add(loads.get(velocity, graph.zero), weight)
    contacts = tuple([c for c in equations.contacts if not gone(c.multiplier)])
    return replace(
        equations,
        model=replace(
            model,
            bodies=tuple([b for b in model.bodies if id(b) not in idle]),
            contacts=tuple([c.contact for c in contacts]),
            discretes=tuple([x for x in model.discretes if not gone(x.symbol)]),
            whens=tuple([w.clause for w in whens if w.clause in model.whens]),
        ),
        inertias=tuple([part for part in parts if id(part.body) not in idle]),
        further_inertia={
            at: m for at, m in equations.further_inertia.items() if not gone(equations.v[at[0]])
        },
        loads=loads,
        rows=tuple([row for row in equations.rows if not gone(row.multiplier)]),
        contacts=contacts,
        whens=tuple(whens),
        initial_conditions=tuple(
            [given for given in equations.initial_conditions if not any(map(gone, symbols([given[0]])))]
        ),
        kinetic=sums[0], potential=sums[1], energy=sums[2], power=sums[3],
        contributions=tuple([
            replace(c, power=own(c.power), forces={j: x for j, x in c.forces.items() if not gone(v[j])})
            for c in equations.contributions
        ]),
    )  # fmt: skip


def _at_rest(part: Moving, at_rest: Callable[[Sequence[Node]], list[Node]]) -> Moving:
    """A moving part whose left out coordinates rest at their initial values."""
    velocity, drive, explicit = (at_rest(x) for x in (part.velocity, part.at_rest, part.explicit))
    return replace(
        part,
        velocity=(velocity[0], velocity[1], velocity[2]),
        at_rest=(drive[0], drive[1], drive[2]),
        explicit=(explicit[0], explicit[1], explicit[2]),
    )
