"""The removal of parts of a system that the outputs and results of a run do not depend on.

Speeds that the mass matrix, constraints or contacts couple are one component.  A component reads what its
forces, inertia, constraints and events contain.  Components that are not read from what is asked for are left
out: their motion acts on nothing that stays, by the structure of the equations.

Coordinates that nothing uses or that move no mass are left out too.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import chain

from lagc.base.records import replace
from lagc.diagnostics.faults import Fault, Refused, Span
from lagc.lowering.kkt.articulated_body import ArticulatedBody, plain
from lagc.lowering.kkt.fill_ordering import eliminate
from lagc.mechanics.formulation.equations import EquationsOfMotion, Moving, WhenEquations, with_jacobians
from lagc.mechanics.formulation.jacobian import with_places
from lagc.mechanics.formulation.states import position_symbols, rate_symbols
from lagc.symbolic.graph import Node
from lagc.symbolic.walk import substitute, symbols


class Components:
    """Disjoint sets of symbols: coordinates, speeds, accelerations, multipliers, discrete variables; and the
    nodes that each reads."""

    def __init__(self, equations: EquationsOfMotion) -> None:
        self.leader: dict[Node, Node] = {}
        self.read: list[tuple[Node, Sequence[Node]]] = []
        # Union-find over symbols: each term that couples symbols makes them one component, and `read` stores
        # what the component depends on. Accelerations belong to their speeds.
        v = equations.v
        known = {*equations.q, *v, *(x.symbol for x in equations.model.discretes)}
        self.tie([(v[j], equations.a[j]) for j in range(len(v))])
        # Inertia couples both speeds; rates couple a coordinate with its speeds; a quaternion is one.
        for (i, j), m in equations.mass_matrix.items():
            self.add([v[i], v[j]], [m])
        for q, qdot in zip(equations.q, equations.qdot):
            self.add([q, *(symbols([qdot]) & set(v))], [qdot])
        for k in equations.quaternions:
            self.add(equations.q[k : k + 4], [])
        # Forces, constraints and contacts: a row couples all speeds that it acts on, with its multiplier.
        for j, forces in enumerate(zip(equations.bias_forces, equations.given_forces)):
            self.add([v[j]], forces)
        for row in equations.rows:
            self.add([row.multiplier, *(v[j] for j in row.jacobian)], [row.residual, row.rate, row.gamma])
        for contact in equations.contacts:
            touched = [v[j] for own in contact.jacobians for j in own]
            self.add([*contact.forces, contact.contact.state, *touched], contact.nodes)
        # Equations of the start and new values of clauses.
        for residual, _ in equations.initial_conditions:
            self.add([s for s in symbols([residual]) if s in known], [])
        for when in equations.whens:
            for state, value in when.changes:
                self.add([state], [when.condition, value])

    def tie(self, pairs: Sequence[tuple[Node, Node]]) -> None:
        for a, b in pairs:
            self.leader[self.find(a)] = self.find(b)

    def add(self, together: Sequence[Node], reads: Sequence[Node]) -> None:
        """Join symbols to one component, which reads these nodes."""
        self.tie([(together[0], other) for other in together] if together else [])
        self.read += [(together[0], reads)] if together else []

    def find(self, symbol: Node) -> Node:
        # Path halving (Tarjan and van Leeuwen 1984): each symbol on the way then points two steps ahead.
        while (above := self.leader.setdefault(symbol, symbol)) is not symbol:
            self.leader[symbol] = symbol = self.leader[above]
        return symbol

    def reached(self, symbols_: set[Node]) -> set[Node]:
        """Return the leaders of all components that these symbols depend on."""
        # Transitive closure: a component that is reached reaches what it reads.
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
    # The roots: outputs, what was asked for by name, conditions of clauses that end the run.
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

    # Components that no root reaches act on nothing that stays, so they can go.
    q = [i for i, s in enumerate(equations.q) if stays(s)]
    v = [j for j, s in enumerate(equations.v) if stays(s)]
    if not v or (len(q) == len(equations.q) and len(v) == len(equations.v)):
        return equations, (list(range(len(equations.q))), list(range(len(equations.v))))
    return _without_components(equations, components, reached), (q, v)


def _without_components(
    equations: EquationsOfMotion, components: Components, reached: set[Node]
) -> EquationsOfMotion:
    """Return `equations` with the components that are not `reached` at rest, in the old columns."""
    graph, model, v, inertias = equations.graph, equations.model, equations.v, equations.inertias

    def gone(symbol: Node) -> bool:
        return symbol in components.leader and components.find(symbol) not in reached

    # Symbols that are left out rest at their starts, with all rates zero.
    rest = {s: start.value for s, start in zip(equations.q, equations.starts_q) if gone(s)}
    rest.update((s, graph.zero) for s in (*equations.v, *equations.a, *equations.lam) if gone(s))
    rest.update((x.symbol, x.start) for x in model.discretes if gone(x.symbol))

    def at_rest(nodes: Sequence[Node]) -> list[Node]:
        return substitute(graph, nodes, rest)

    def reduced(node: Node) -> Node:
        """Return a sum without the terms that consist of symbols that are left out."""
        if node.op == "add":
            return graph.add(*[reduced(term) for term in node.args])
        if node.op == "scale":
            return graph.scale(node.value, reduced(node.args[0]))
        found = symbols([node])
        if found & rest.keys() and not found & (known - rest.keys()):
            return graph.zero
        return at_rest([node])[0]

    # Bodies that rest without what is left out, and did not before, carry no energy any more.
    known = {*equations.q, *equations.v, *equations.a, *equations.lam, *(x.symbol for x in model.discretes)}
    parts = [_at_rest(part, at_rest) for part in inertias]
    idle = {id(part.body) for part in inertias} - {
        id(new.body) for new, old in zip(parts, inertias)
        if not all(x.is_zero for x in new.velocity) or all(x.is_zero for x in old.velocity)}  # fmt: skip
    sums = [reduced(x) for x in (equations.kinetic, equations.potential, equations.energy, equations.power)]
    whens = [replace(w, changes=tuple([(s, x) for s, x in w.changes if not gone(s)]))
             for w in equations.whens if _is_asked(w) or not all(gone(s) for s, _ in w.changes)]  # fmt: skip
    contacts = tuple([c for c in equations.contacts if not gone(c.multiplier)])
    model = replace(
        model,
        bodies=tuple([b for b in model.bodies if id(b) not in idle]),
        contacts=tuple([c.contact for c in contacts]),
        discretes=tuple([x for x in model.discretes if not gone(x.symbol)]),
        whens=tuple([w.clause for w in whens if w.clause in model.whens]),
    )
    return replace(
        equations, model=model,
        inertias=tuple([part for part in parts if id(part.body) not in idle]),
        further_inertia={at: m for at, m in equations.further_inertia.items() if not gone(v[at[0]])},
        rows=tuple([row for row in equations.rows if not gone(row.multiplier)]), contacts=contacts,
        loads=_loads(equations, at_rest), whens=tuple(whens), kinetic=sums[0], potential=sums[1],
        energy=sums[2], power=sums[3],
        initial_conditions=tuple([
            given for given in equations.initial_conditions if not any(map(gone, symbols(given[:1])))
        ]),
        contributions=tuple([
            replace(c, power=reduced(c.power), forces={j: x for j, x in c.forces.items() if not gone(v[j])})
            for c in equations.contributions
        ]),
    )  # fmt: skip


def _loads(equations: EquationsOfMotion, at_rest: Callable[[Sequence[Node]], list[Node]]) -> dict[Node, Node]:
    """Return the loads on velocities where some symbols are at rest: those on a constant velocity do nothing,
    those on one velocity add."""
    graph, count = equations.graph, len(equations.loads)
    velocities = at_rest([*equations.loads, *equations.loads.values()])
    found: dict[Node, Node] = {}
    for velocity, weight in zip(velocities, velocities[count:]):
        if not velocity.is_const:
            found[velocity] = graph.add(found.get(velocity, graph.zero), weight)
    return found


def _at_rest(part: Moving, at_rest: Callable[[Sequence[Node]], list[Node]]) -> Moving:
    """Return a moving part with the coordinates that are left out at rest at their initial values."""
    velocity, drive, explicit = (at_rest(x) for x in (part.velocity, part.at_rest, part.explicit))
    return replace(
        part,
        # Rest means the velocity is a function of what stays: the parts of `Moving` with zeros for the rest.
        velocity=(velocity[0], velocity[1], velocity[2]),
        at_rest=(drive[0], drive[1], drive[2]),
        explicit=(explicit[0], explicit[1], explicit[2]),
    )


_MOST_NAMED = 8  # independent parts that a note lists


def prune(equations: EquationsOfMotion) -> tuple[EquationsOfMotion, tuple[str, ...]]:
    """Return `equations` without the coordinates and speeds that no inertia, force, constraint, output or
    condition contains, and their names; where outputs are asked for, also without those that these do not
    depend on. If that would remove all of them, none is removed."""
    model = equations.model
    # First what is asked for, if anything is; then what nothing uses.
    if model.asked is not None:
        equations, (q, v) = leave_out(equations)
        equations = _restrict(equations, q, v) if len(v) < len(equations.v) else equations
    q, v = _used_indices(equations)
    if v and not (len(q) == len(equations.q) and len(v) == len(equations.v)):
        equations = _restrict(equations, q, v)
    kept = {*equations.q, *equations.v}
    names = [c.name for c in model.coordinates if kept.isdisjoint(position_symbols(c))]
    names += [speed.name for speed in model.speeds if speed.symbol not in kept]
    return equations, tuple(names)


def _used_indices(equations: EquationsOfMotion) -> tuple[list[int], list[int]]:
    """Return the indices of the coordinates and speeds that stay."""
    # Speeds stay if mass moves with them, a row or contact acts on them, a force is not zero, or something
    # reads them or their accelerations.
    reached = symbols(sources(equations))
    moving = set(equations.massive) | {j for at in equations.further_inertia for j in at}
    moving.update(j for row in equations.rows for j in row.jacobian)
    moving.update(j for contact in equations.contacts for row in contact.jacobians for j in row)
    forces = zip(equations.bias_forces, equations.given_forces)
    moving.update(j for j, (h, tau) in enumerate(forces) if not (h.is_zero and tau.is_zero))
    number = {symbol: j for j, symbol in enumerate(equations.v)}
    moving.update(number[symbol] for symbol in reached if symbol in number)
    a = {symbol: j for j, symbol in enumerate(equations.a)}
    moving.update(a[symbol] for symbol in reached if symbol in a)
    pending = _groups(equations)
    by_group = {group: symbols([equations.qdot[i] for i in group]) for group in pending}
    q: set[int] = set()
    while True:  # a coordinate that stays keeps the speeds and coordinates of its rate
        staying = [
            group
            for group in pending
            if any(equations.q[i] in reached for i in group)
            or any(number[s] in moving for s in by_group[group] if s in number)
        ]
        if not staying:
            return sorted(q), sorted(moving)
        for group in staying:
            pending.remove(group)
            q.update(group)
            reached |= by_group[group]
            moving.update(number[s] for s in by_group[group] if s in number)


def _groups(equations: EquationsOfMotion) -> list[tuple[int, ...]]:
    """Return the sets of coordinates that stay or go together: the four of a quaternion, else one."""
    inside = {k + i for k in equations.quaternions for i in range(4)}
    return [tuple(range(k, k + 4)) if k in inside else (k,)
            for k in range(len(equations.q)) if k not in inside or k in equations.quaternions]  # fmt: skip


def sources(equations: EquationsOfMotion) -> list[Node]:
    """Return all nodes in which a coordinate may have an effect, except its own rate."""
    found = [
        *_inertial(equations), *equations.bias_forces, *equations.given_forces,
        equations.kinetic, equations.potential, equations.energy, equations.power,
        *(residual for residual, _ in equations.initial_conditions),
        *(node for when in equations.whens for node in (when.condition, *chain(*when.changes))),
        *(o.expression for o in equations.outputs),
    ]  # fmt: skip
    # Constraints and contacts read all that they are made of.
    for row in equations.rows:
        found += [row.residual, row.rate, row.gamma]
    for contact in equations.contacts:
        found += contact.nodes
    return found


def _inertial(equations: EquationsOfMotion) -> list[Node]:
    """Return the nodes that the mass matrix is made of."""
    found = list(equations.further_inertia.values())
    for part in equations.inertias:
        found += part.carried
        found += [x for row in part.mass for x in row] if isinstance(part.mass, tuple) else [part.mass]
    return found


def _restrict(equations: EquationsOfMotion, q: Sequence[int], v: Sequence[int]) -> EquationsOfMotion:
    new_q = {old: new for new, old in enumerate(q)}
    new_v = {old: new for new, old in enumerate(v)}
    # New places of coordinates and speeds; what stays keeps its order.
    gone = {s for i, s in enumerate(equations.q) if i not in new_q}
    gone |= {s for j, s in enumerate(equations.v) if j not in new_v}

    # Gradients are sparse in the speeds: their places move with them. Those of rows, of contacts and of
    # forces share sums, so each set is renumbered at once.
    jacobians = with_places([row.jacobian for row in equations.rows], new_v, len(v))
    rows = [row for contact in equations.contacts for row in contact.jacobians]
    gradients = with_places(rows, new_v, len(v))
    forces = with_places([c.forces for c in equations.contributions], new_v, len(v))
    return replace(
        equations,
        q=tuple([equations.q[i] for i in q]),
        q_units=tuple([equations.q_units[i] for i in q]),
        qdot=tuple([equations.qdot[i] for i in q]),
        starts_q=tuple([equations.starts_q[i] for i in q]),
        quaternions=tuple([new_q[k] for k in equations.quaternions if k in new_q]),
        v=tuple([equations.v[j] for j in v]),
        a=tuple([equations.a[j] for j in v]),
        v_units=tuple([equations.v_units[j] for j in v]),
        starts_v=tuple([equations.starts_v[j] for j in v]),
        stated_rates=tuple([s for s in equations.stated_rates if not gone & symbols([s.rate])]),
        bias_forces=tuple([equations.bias_forces[j] for j in v]),
        given_forces=tuple([equations.given_forces[j] for j in v]),
        further_inertia={(new_v[i], new_v[j]): node for (i, j), node in equations.further_inertia.items()},
        rows=tuple([replace(row, jacobian=own) for row, own in zip(equations.rows, jacobians)]),
        contacts=with_jacobians(equations.contacts, gradients),
        contributions=tuple([replace(c, forces=own) for c, own in zip(equations.contributions, forces)]),
    )


def independent(equations: EquationsOfMotion, system: ArticulatedBody) -> tuple[str, ...]:
    """Return a note if the motion consists of parts that no inertia, force, constraint or event couples.
    `system` are its equations in any form."""
    # First by the structure of M and G, and by the rates of coordinates: most models are one part.
    parts = _Parts(system.structure.unknowns)
    ties = [*system.entries.items(), *system.coefficients.items()]
    for (i, j), _ in ties:
        parts.tie(i, j)
    number = {symbol: j for own in (equations.v, equations.a) for j, symbol in enumerate(own)}
    number.update({row.multiplier: len(equations.v) + k for k, row in enumerate(equations.rows)})
    for q, qdot in zip(equations.q, equations.qdot):
        near = sorted(number[s] for s in symbols([qdot]) if s in number)
        for j in near[1:]:
            parts.tie(near[0], j)
        if near and q not in number:
            number[q] = near[0]
    if parts.count() == 1:
        return ()
    # Then by what entries, forces, rows, contacts and events read.
    for (i, _), node in ties:
        _tie_to(parts, i, [node], number)
    for j, (h, tau) in enumerate(zip(equations.bias_forces, equations.given_forces)):
        _tie_to(parts, j, [h, tau], number)
    for k, row in enumerate(equations.rows):
        _tie_to(parts, len(equations.v) + k, [row.residual, row.gamma], number)
    for contact in equations.contacts:
        reached = [equations.v[j] for row in contact.jacobians for j in row]
        _tie_to(parts, min(j for row in contact.jacobians for j in row), [*contact.nodes, *reached], number)
    for when in equations.whens:
        for state, value in when.changes:
            if state in number:
                _tie_to(parts, number[state], [when.condition, value], number)
    # More than a few parts are a swarm of equal bodies, which nobody wants listed.
    groups = parts.groups(len(equations.v))
    if len(groups) < 2 or len(groups) > _MOST_NAMED:
        return ()
    names = equations.v_names
    named = ["(" + ", ".join(names[j] for j in group) + ")" for group in groups]
    return ("the motion falls into independent parts: " + " ".join(named),)


def _tie_to(parts: _Parts, j: int, nodes: list[Node], number: dict[Node, int]) -> None:
    for k in sorted(number[s] for s in symbols(nodes) if s in number):
        parts.tie(j, k)


class _Parts:
    """Disjoint sets of unknowns."""

    def __init__(self, size: int) -> None:
        self._leader = list(range(size))

    def find(self, j: int) -> int:
        while self._leader[j] != j:
            self._leader[j] = self._leader[self._leader[j]]
            j = self._leader[j]
        return j

    def tie(self, i: int, j: int) -> None:
        a, b = self.find(i), self.find(j)
        self._leader[max(a, b)] = min(a, b)

    def count(self) -> int:
        return sum(self.find(j) == j for j in range(len(self._leader)))

    def groups(self, size: int) -> list[list[int]]:
        found: dict[int, list[int]] = {}
        for j in range(size):
            found.setdefault(self.find(j), []).append(j)
        return list(found.values())


def with_pivots(equations: EquationsOfMotion) -> EquationsOfMotion:
    """Return `equations` with pivots for all speeds. A massless speed without force that has a row of its
    own, `der(y) = ...`, gets a unit inertia and the force gamma, so that the multiplier is 0 in any units.
    Raises Refused, LAG0501 for each speed that neither inertia nor rows determine."""
    # Straight elimination has no pivot for a speed that neither mass nor rows determine. A row of its own,
    # der(y) = ..., gives one.
    bare = [j for j in range(len(equations.v)) if j not in equations.massive]
    if not bare or eliminate(plain(equations).structure) is not None:
        return equations
    tied = _connected_speeds(equations, [j for j in range(len(equations.v)) if j not in bare])
    free = [j for j in bare if j not in tied]
    found = _with_units(equations, free)
    if eliminate(plain(found).structure) is not None:
        return found
    culprits = [j for j in free if j not in found.massive] or bare
    raise Refused([_fault(equations, j) for j in culprits])


def _with_units(equations: EquationsOfMotion, free: Sequence[int]) -> EquationsOfMotion:
    matrix, given = dict(equations.further_inertia), list(equations.given_forces)
    loads, pivots = dict(equations.loads), set[int]()
    # A unit inertia on such a speed with the force gamma: then a = gamma, whatever the unit, and the
    # multiplier is 0.
    forces, one = equations.applied_forces, equations.graph.one
    for j in free:
        rows = [row for row in equations.rows if j in row.jacobian]
        if len(rows) == 1 and forces[j].is_zero:
            slope = rows[0].jacobian[j]
            if len(rows[0].jacobian) == 1 and slope in (one, -one):
                given[j], matrix[j, j] = slope * rows[0].gamma, one
                loads[equations.v[j]] = given[j]
                pivots.add(j)
    return replace(
        equations, further_inertia=matrix, given_forces=tuple(given), loads=loads,
        unit_pivots=frozenset(pivots),
    )  # fmt: skip


def _connected_speeds(equations: EquationsOfMotion, massive: list[int]) -> set[int]:
    """Return the speeds that constraints connect, directly or through others, to a speed with inertia."""
    # Rows that share a speed with inertia determine the others, one row after the next.
    found = set(massive)
    left = [set(row.jacobian) for row in equations.rows]
    while True:
        adjacent = [columns for columns in left if not found.isdisjoint(columns)]
        if not adjacent:
            return found
        left = [columns for columns in left if found.isdisjoint(columns)]
        for columns in adjacent:
            found |= columns


def _fault(equations: EquationsOfMotion, j: int) -> Fault:
    # The message names the coordinate as it is written, and what would give it a pivot.
    name = equations.v_names[j]
    span: Span | None = None
    line = "give it an inertia"
    for c in equations.model.coordinates:
        if equations.v[j] in rate_symbols(c):
            name, span = c.name, c.span
            unit = {"m": "kg", "rad": "kg.m2", "1": "kg.m2"}.get(getattr(c, "unit", ""))
            if unit is not None:
                line += f", `kinetic T = 1/2*(1 [{unit}])*der({name})^2;`"
    for speed in equations.model.speeds:
        if speed.symbol is equations.v[j]:
            span = speed.span
    rows = ", ".join(f"`{row.label}`" for row in equations.rows if j in row.jacobian)
    if rows:
        return Fault(
            "LAG0501",
            f"nothing that has mass moves with `{name}`, and {rows} alone cannot balance what acts on it",
            span,
            remedy=f"where no force acts on it, solve the constraint for its rate, `der({name}) = ...`; else"
            f" {line}, which changes no other motion where constraints alone give its rate",
        )
    return Fault(
        "LAG0501",
        f"nothing that has mass moves with `{name}`, so its acceleration cannot be found",
        span,
        remedy=f"put a body where `{name}` moves it or {line}; tie it to one by a constraint; or, where it is"
        " a given function of time, write that function in its place",
    )
