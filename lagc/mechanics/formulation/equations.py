"""EquationsOfMotion: the noun that `derive` returns.

    qdot = N(t,q) v + n(t,q)
    M(t,q) a + h(t,q,v) = tau(t,q,v) + G(t,q,v)^T lam
    phi(t,q) = 0      psi(t,q,v) = 0      G a = gamma

All entries are nodes of `graph`, in the symbols t, q, v and the parameters; `lam` and
`a` appear in `outputs` and `power` only.

**Mass matrix.** With the partial velocities d(v_C)/d(v_j) and d(w)/d(v_j)

    M_ij = sum of m dv_C/dv_i . dv_C/dv_j + dw/dv_i . I dw/dv_j

of the velocities that carry inertia (`Moving`, see `inertia`). The sums are reverse sweeps over the graph of
the velocities: a chain of n links costs O(n) nodes for each row. M is formed when it is used.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from enum import Enum
from functools import cached_property

from lagc.base.records import dataclass, replace
from lagc.diagnostics.faults import Fault, Span
from lagc.semantics.model import FIXED, Body, Contact, Model, Statement, When
from lagc.symbolic.derivative import gradient, seeds, tangent
from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.vectors import Matrix, Vector, matvec, scale
from lagc.symbolic.walk import depends, linked, symbols


class Level(Enum):
    """Whether a row restricts positions or velocities."""

    POSITION = "position"
    VELOCITY = "velocity"


class Law(Enum):
    """How the force of a row depends on the motion; that of a perfect one does no work on it, that of a servo
    is a load, times the multiplier."""

    PERFECT = "perfect"
    SERVO = "servo"


@dataclass(frozen=True, slots=True)
class Row:
    """One scalar constraint, and the multiplier of its force.

    At the level of positions: residual = phi(t,q), rate = d(phi)/dt (in v).
    At the level of velocities: residual = rate = psi(t,q,v).
    jacobian = {column of v: d(rate)/d(v)}; gamma as in G a = gamma.
    """

    label: str  # the constraint's row label, unique
    constraint: str
    level: Level
    law: Law
    multiplier: Node  # a symbol
    residual: Node
    rate: Node
    jacobian: Mapping[int, Node]
    gamma: Node
    unit: str
    time_dependent: bool
    linear: bool  # affine in v (holonomic rows are)
    span: Span
    effect: str | None = None

    @property
    def holonomic(self) -> bool:
        return self.level is Level.POSITION


@dataclass(frozen=True, slots=True)
class SlipRow:
    """A slip row of a contact with friction, in t, q and v. The acceleration of the slip is
    jacobian a + bias."""

    rate: Node
    jacobian: Mapping[int, Node]
    bias: Node
    force: Node  # a symbol: the friction along the slip


@dataclass(frozen=True, slots=True)
class ContactRow:
    """The normal row of a contact, in t, q and v. jacobian = {column of v: d(rate)/d(v)}; the acceleration of
    the gap is jacobian a + bias."""

    contact: Contact
    multiplier: Node  # a symbol: the force that pushes the gap open
    gap: Node
    rate: Node
    jacobian: Mapping[int, Node]
    bias: Node
    restitution: Node
    slips: tuple[SlipRow, ...] = ()  # 1 or 2 with friction
    frictions: tuple[Node, ...] = ()  # the coefficients while it slips and while it sticks
    # Components of the normal force of a two-sided contact, in t, q, v, a, lam and forces of contacts; no gap
    normals: tuple[Node, ...] = ()

    @property
    def label(self) -> str:
        return self.contact.label

    @property
    def nodes(self) -> list[Node]:
        """Return what the contact is made of, without its gradient."""
        slips = [node for slip in self.slips for node in (slip.rate, slip.bias)]
        return [self.gap, self.rate, self.bias, self.restitution, *slips, *self.frictions, *self.normals]

    @property
    def forces(self) -> list[Node]:
        """The symbols of the forces along its normal row and its slip rows."""
        return [self.multiplier, *(slip.force for slip in self.slips)]

    @property
    def jacobians(self) -> list[Mapping[int, Node]]:
        """The gradient of its normal row, then those of its slip rows."""
        return [self.jacobian, *(slip.jacobian for slip in self.slips)]


def with_jacobians(
    contacts: Sequence[ContactRow], jacobians: Sequence[Mapping[int, Node]]
) -> tuple[ContactRow, ...]:
    """Return contacts with other gradients of their rows, in the order of `ContactRow.jacobians`."""
    given, found = iter(jacobians), list[ContactRow]()
    for contact in contacts:
        normal = next(given)
        slips = tuple([replace(slip, jacobian=next(given)) for slip in contact.slips])
        found.append(replace(contact, jacobian=normal, slips=slips))
    return tuple(found)


@dataclass(frozen=True, slots=True)
class Contribution:
    """The contribution of a body or an action: its generalized force, a node for each speed ({} for a body,
    whose share is in M and h). The kinds are potential, force, torque, dissipation, lagrangian.
    `conservative` ones are in `potential`; others have `power`."""

    name: str
    kind: str
    effect: str | None
    forces: Mapping[int, Node]
    power: Node  # of this action along the motion, in v
    conservative: bool


@dataclass(frozen=True, slots=True)
class OutputEquation:
    name: str
    expression: Node  # in t q v a lam parameters
    unit: str
    display_unit: str


@dataclass(frozen=True, slots=True)
class WhenEquations:
    """A clause `when` in terms of the states: `changes` are states and their new values, all in t, q, v."""

    clause: When
    condition: Node
    changes: tuple[tuple[Node, Node], ...]


@dataclass(frozen=True, slots=True)
class StartValue:
    """A state's start: its expression in parameters, and how firmly and where it was stated."""

    value: Node
    stated: Statement

    @property
    def fixed(self) -> bool:
        return self.stated.level == FIXED


@dataclass(frozen=True, slots=True)
class StatedRate:
    """A rate with a start value that a declared speed replaces, as an expression in t, q, v."""

    symbol: Node
    unit: str
    rate: Node
    start: StartValue

    @property
    def name(self) -> str:
        return self.symbol.record.name


@dataclass(frozen=True)
class EquationsOfMotion:
    model: Model
    graph: Graph
    time: Node
    q: tuple[Node, ...]  # symbols
    v: tuple[Node, ...]  # symbols: rates, or declared speeds
    a: tuple[Node, ...]  # symbols: d(v)/dt
    q_units: tuple[str, ...]
    v_units: tuple[str, ...]
    qdot: tuple[Node, ...]
    quaternions: tuple[int, ...]  # first q index of each unit quaternion
    inertias: tuple[Moving, ...]  # the velocities that carry inertia
    further_inertia: dict[tuple[int, int], Node]  # what free Lagrangians bring to M
    bias_forces: tuple[Node, ...]
    given_forces: tuple[Node, ...]
    loads: dict[Node, Node]  # weights on velocities: tau - h is what they bring to the speeds
    rows: tuple[Row, ...]  # holonomic first
    contributions: tuple[Contribution, ...]
    kinetic: Node
    potential: Node  # of the conservative actions
    energy: Node  # the quantity whose balance is kept: K2 - K0 + V (K + V when scleronomic)
    balance: str  # how it is written
    power: Node  # d(energy)/dt: of non-conservative actions, drives and rheonomic rows (may use lam)
    starts_q: tuple[StartValue, ...]
    starts_v: tuple[StartValue, ...]
    stated_rates: tuple[StatedRate, ...]
    initial_conditions: tuple[tuple[Node, Span], ...]  # residual in q, v, parameters
    whens: tuple[WhenEquations, ...]
    outputs: tuple[OutputEquation, ...]
    contacts: tuple[ContactRow, ...]
    rates: dict[Node, Node]  # rate symbol -> its expression in v (identity for default speeds)
    dropped: tuple[str, ...] = ()  # rows found identically dependent, with the reason
    warnings: tuple[Fault, ...] = ()  # what may not be meant as it is written
    unit_pivots: frozenset[int] = frozenset()  # speeds without inertia that have got one, 1, as a pivot

    def __repr__(self) -> str:
        sizes = f"{len(self.q)} coordinates, {len(self.v)} speeds, {len(self.rows)} rows of constraints"
        return f"<{type(self).__name__} of {self.model.name}, scene {self.model.scene}: {sizes}>"

    @cached_property
    def mass_matrix(self) -> dict[tuple[int, int], Node]:
        """Return the nonzero entries (i, j) with i >= j, in q and t (also in v if a free Lagrangian is not
        quadratic)."""
        inertia = Inertia(self.graph, self.v, self.inertias)
        found = {(i, j): m for i in range(len(self.v)) for j, m in inertia.row(i, range(i + 1)).items()}
        for at, node in self.further_inertia.items():
            found[at] = self.graph.add(found[at], node) if at in found else node
        return {at: node for at, node in found.items() if not node.is_zero}

    def mass_rows(self, which: Sequence[int]) -> list[dict[int, Node]]:
        """Return whole rows of M, by column, without zeros; M itself is not formed."""
        inertia, others = Inertia(self.graph, self.v, self.inertias), set(range(len(self.v))) - set(which)
        rows = {i: inertia.row(i, others.union(k for k in which if k <= i)) for i in which}
        for i in which:
            for j in which:
                if j < i and j in rows[i]:
                    rows[j][i] = rows[i][j]
        for (i, j), node in self.further_inertia.items():
            for at, other in {(i, j), (j, i)}:
                if at in rows:
                    before = rows[at].get(other)
                    rows[at][other] = node if before is None else self.graph.add(before, node)
        return [{j: m for j, m in sorted(rows[i].items()) if not m.is_zero} for i in which]

    @property
    def inertial_forces(self) -> list[Node]:
        """M a."""
        found = inertial_forces(self.graph, self.v, self.a, self.inertias)
        for (i, j), node in sorted(self.further_inertia.items()):
            for k, other in {(i, j), (j, i)}:
                found[k] = found[k] + node * self.a[other]
        return found

    @property
    def constraint_forces(self) -> list[Node]:
        """G^T lam."""
        pairs = seeds(self.graph, ((row.rate, row.multiplier) for row in self.rows))
        found = gradient(self.graph, pairs, self.v)
        return [found.get(v, self.graph.zero) for v in self.v]

    @cached_property
    def massive(self) -> frozenset[int]:
        """The speeds that move what has inertia: those with an entry on the diagonal of M."""
        moved = symbols([x for part in self.inertias for x in part.carried])
        own = {j for j, v in enumerate(self.v) if v in moved}
        return frozenset(own | {i for i, j in self.further_inertia if i == j})

    @property
    def applied_forces(self) -> list[Node]:
        """r = tau - h."""
        return [self.graph.sub(tau, h) for tau, h in zip(self.given_forces, self.bias_forces)]

    @property
    def lam(self) -> tuple[Node, ...]:
        """The multipliers of the rows."""
        return tuple([row.multiplier for row in self.rows])

    @property
    def q_names(self) -> tuple[str, ...]:
        return tuple([x.record.name for x in self.q])

    @property
    def v_names(self) -> tuple[str, ...]:
        """The names of the speeds: `der(theta)`, `u1`, `o.rate.x`."""
        return tuple([x.record.name for x in self.v])

    @property
    def state_names(self) -> tuple[str, ...]:
        return (*self.q_names, *self.v_names)

    @property
    def starts(self) -> tuple[StartValue, ...]:
        """The start values of q, of v, and of the stated rates."""
        return (*self.starts_q, *self.starts_v, *(s.start for s in self.stated_rates))


@dataclass(frozen=True, slots=True)
class Moving:
    """The velocity of a centre of mass, or an angular velocity in body axes, and its inertia."""

    body: Body
    velocity: Vector  # in v
    at_rest: Vector  # the same when every rate is zero: the drive's share
    explicit: Vector  # its derivative by t alone, coordinates and rates held
    mass: Node | Matrix

    def momentum(self, velocity: Vector) -> Vector:
        """Return the linear or angular momentum that goes with `velocity`."""
        if isinstance(self.mass, tuple):
            return matvec(self.mass, velocity)
        return scale(self.mass, velocity)

    @property
    def carried(self) -> list[Node]:
        """The components of the velocity that inertia goes with."""
        if not isinstance(self.mass, tuple):
            return list(self.velocity)
        return [x for x, row in zip(self.velocity, self.mass) if not all(m.is_zero for m in row)]


def triples(flat: Sequence[Node]) -> list[Vector]:
    """Return the vectors whose components follow each other in `flat`."""
    return [(flat[k], flat[k + 1], flat[k + 2]) for k in range(0, len(flat), 3)]


def inertial_forces(
    graph: Graph, speeds: Sequence[Node], accelerations: Sequence[Node], parts: Sequence[Moving]
) -> list[Node]:
    """M a, in two sweeps: M is not made for it."""
    flat = [x for part in parts for x in part.velocity]
    rates = triples(tangent(graph, flat, dict(zip(speeds, accelerations))))
    pairs = [pair for part, rate in zip(parts, rates) for pair in zip(part.velocity, part.momentum(rate))]
    found = gradient(graph, seeds(graph, pairs), speeds)
    return [found.get(v, graph.zero) for v in speeds]


class Inertia:
    """Rows of M, each in time in proportion to what its speed moves and what that is made of."""

    def __init__(self, graph: Graph, speeds: Sequence[Node], parts: Sequence[Moving]):
        self._graph, self._speeds, self._parts = graph, speeds, parts
        moving = depends([x for part in parts for x in part.velocity], speeds)
        self._arguments = {node: [a for a in node.args if a in moving] for node in moving}
        self._users: dict[Node, list[Node]] = {node: [] for node in moving}
        for node, below in self._arguments.items():
            for a in below:
                self._users[a].append(node)
        self._carried: dict[Node, list[int]] = {}
        for k, part in enumerate(parts):
            for node in part.velocity:
                self._carried.setdefault(node, []).append(k)
        self._index = {v: i for i, v in enumerate(speeds)}

    def row(self, i: int, columns: Collection[int]) -> dict[int, Node]:
        """Return the entries M_ij of row i for j in `columns`, without zeros."""
        graph, speed, index = self._graph, self._speeds[i], self._index
        changed = linked([speed], self._users) if speed in self._users else []
        driven = [self._parts[k] for k in sorted({k for x in changed for k in self._carried.get(x, ())})]
        partial = tangent(graph, [x for part in driven for x in part.velocity], {speed: graph.one}, changed)
        pairs: list[tuple[Node, Node]] = []
        for part, rate in zip(driven, triples(partial)):
            if not all(x.is_zero for x in rate):
                pairs.extend(zip(part.velocity, part.momentum(rate)))
        within = linked([node for node, _ in pairs if node in self._arguments], self._arguments)
        wrt = sorted((x for x in within if index.get(x, -1) in columns), key=index.__getitem__)
        return {index[v]: m for v, m in gradient(graph, seeds(graph, pairs), wrt, within).items()}
