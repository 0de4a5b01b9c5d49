"""Properties of a system that follow from its equations of motion.

Each property is proved, by exact values on every branch (`zero_test`) or by a rank that cannot be larger
(`mobility`), or it *seems* to hold: in all tested states that meet the constraints.
"""

import math
from collections.abc import Mapping, Sequence
from itertools import chain

from lagc.base.records import dataclass, replace
from lagc.mechanics.analysis.integrability import Integrable, integrable_rows, rate_coefficients
from lagc.mechanics.analysis.mobility import Mobility, mobility
from lagc.mechanics.balance.energy import WHOLE
from lagc.mechanics.balance.outputs import Quantities, momenta
from lagc.mechanics.formulation.equations import EquationsOfMotion, Row, triples
from lagc.mechanics.formulation.euler_lagrange import free_terms, with_rates
from lagc.mechanics.formulation.inertia import moving_parts
from lagc.mechanics.formulation.states import States, build_states
from lagc.mechanics.identities.constraint_manifold import Consistent, onto, walk
from lagc.mechanics.identities.samples import samples
from lagc.mechanics.identities.sampling_domains import LARGEST, all_states, far_away, on_motion, on_rows
from lagc.mechanics.identities.zero_test import ZeroTest
from lagc.semantics.model import Coordinate, Lagrangian, Potential
from lagc.symbolic.derivative import gradient, tangent
from lagc.symbolic.graph import Node
from lagc.symbolic.leaves import Symbol
from lagc.symbolic.vectors import dot, sub
from lagc.symbolic.walk import depends, substitute, symbols

_STATES = 3
_FEW = 20  # rows with which states far away are tried


@dataclass(frozen=True, slots=True)
class RowKind:
    """The kind of a constraint equation. `integrable` is None if it does not apply or was not examined;
    `proved` says how it is known."""

    label: str
    constraint: str
    holonomic: bool
    time_dependent: bool
    affine: bool
    integrable: bool | None
    explanation: str
    proved: bool


@dataclass(frozen=True, slots=True)
class Conserved:
    """A quantity that keeps its value, in t, q, v, and why; not `proved`, it seems to."""

    name: str
    expression: Node
    reason: str
    proved: bool


@dataclass(frozen=True, slots=True)
class Seems:
    """Claims from states that were tried, not proved; names and labels."""

    cyclic: tuple[str, ...]
    redundant: tuple[str, ...]
    degrees_of_freedom: bool
    positional_freedom: bool


@dataclass(frozen=True)
class Analysis:
    """Plain facts, and nodes of the graph of the equations. `kinetic_parts` are K2, K1, K0 by degree in v;
    None if K is no polynomial of degree 2."""

    coordinates: int
    speeds: int
    rows: int
    redundant: tuple[str, ...]  # labels of rows that follow from others where all hold
    open_reactions: tuple[str, ...]  # labels of rows with multipliers that are not unique
    unseen: tuple[str, ...]  # labels of rows that do not, though double precision cannot tell
    degrees_of_freedom: int  # of the velocities: n less the rank of the rows where they hold
    positional_freedom: int  # degrees of freedom of the positions: integrable rows count
    more_at_start: int  # degrees of freedom that the initial configuration alone adds
    kinetic_parts: tuple[Node, Node, Node] | None
    cyclic: tuple[str, ...]
    conserved: tuple[Conserved, ...]
    constraints: tuple[RowKind, ...]
    dropped: tuple[str, ...]
    seems: Seems
    not_examined: tuple[str, ...]  # what would have been too much work, or met no consistent state

    @property
    def unknowns(self) -> int:
        return self.speeds + self.rows


def analyse(equations: EquationsOfMotion) -> Analysis:
    """Return the counts, the kinds of constraints, the cyclic coordinates and the conserved quantities of a
    system."""
    states = build_states(equations.model)
    rows = equations.rows
    # Ranks are asked for on the rows, where closed loops lose some that they have elsewhere.
    met = walk(states, rows)
    moving = mobility(states, rows, met)
    holonomic = [row for row in rows if row.holonomic]
    places = mobility(states, holonomic, met) if len(holonomic) < len(rows) else moving
    # Velocity rows that are integrable restrict positions, beside the independent holonomic ones.
    asked = [row for k, row in enumerate(rows) if not row.holonomic or k not in places.spare]
    integrable = integrable_rows(states, asked, met.by_distance)
    relations = places.rank + integrable.relations
    cyclic = _cyclic(states)
    # Conserved quantities are looked for with independent rows, whose multipliers are unique.
    kept = [(k, row) for k, row in enumerate(rows) if k not in moving.spare]
    spare = tuple([rows[k].label for k in sorted(moving.spare)])
    conserved, left = _conserved(equations, states, kept, met, cyclic, moving.proved)
    return Analysis(
        coordinates=len(equations.q),
        speeds=len(equations.v),
        rows=len(rows),
        redundant=spare,
        open_reactions=tuple([rows[k].label for k in sorted(moving.entangled)]),
        degrees_of_freedom=len(equations.v) - moving.rank,
        positional_freedom=len(equations.v) - relations,
        unseen=tuple([rows[k].label for k in sorted(moving.unseen)]),
        more_at_start=0 if moving.at_start is None else moving.rank - len(moving.unseen) - moving.at_start,
        kinetic_parts=_kinetic_parts(equations),
        cyclic=tuple(cyclic),
        conserved=tuple(conserved),
        constraints=tuple(_kinds(equations, integrable)),
        dropped=equations.dropped,
        seems=Seems(
            cyclic=tuple([name for name, proved in cyclic.items() if not proved]),
            redundant=() if moving.proved else spare,
            degrees_of_freedom=not moving.proved,
            positional_freedom=not (places.proved and integrable.proved and not integrable.open),
        ),
        not_examined=tuple(_not_examined(moving, integrable, left)),
    )


def _not_examined(moving: Mobility, integrable: Integrable, quantities: Sequence[str]) -> list[str]:
    found: list[str] = []
    if not moving.examined:
        found.append("the rank of the rows where they hold")
    if integrable.open:
        found.append("whether velocity rows are integrable")
    return [*found, *quantities]


def _kinds(equations: EquationsOfMotion, integrable: Integrable) -> list[RowKind]:
    found: list[RowKind] = []
    for row in equations.rows:
        holonomic = row.holonomic
        closed = holonomic or not row.linear or row.label in integrable.open
        answer: bool | None = None if closed else row.label in integrable.rows
        if holonomic:
            why = "a relation between positions"
        elif not row.linear:
            why = "it is not affine in the rates"
        elif row.label in integrable.open:
            why = "whether it restricts positions was not examined"
        else:
            why = integrable.rows.get(row.label, "it restricts speeds without restricting positions")
        proved = answer is None or row.label not in integrable.doubtful
        found.append(
            RowKind(row.label, row.constraint, holonomic, row.time_dependent, row.linear, answer, why, proved)
        )
    return found


def _kinetic_parts(equations: EquationsOfMotion) -> tuple[Node, Node, Node] | None:
    graph, v, parts = equations.graph, equations.v, equations.inertias
    if depends(equations.further_inertia.values(), v):
        return None
    slopes = gradient(graph, {equations.kinetic: graph.one}, v)
    moving = [x for part in parts for x in part.velocity]
    at_rest, *rest = substitute(
        graph, [equations.kinetic, *slopes.values(), *moving], dict.fromkeys(v, graph.zero)
    )
    one = graph.sum(x * slope for x, slope in zip(slopes, rest))
    entries = equations.further_inertia.items()
    terms = [graph.scale(0.5 if i == j else 1.0, m * v[i] * v[j]) for (i, j), m in entries]
    for part, velocity_at_rest in zip(parts, triples(rest[len(slopes) :])):
        own = sub(part.velocity, velocity_at_rest)
        terms.append(graph.scale(0.5, dot(own, part.momentum(own))))
    return graph.sum(terms), one, at_rest


def _cyclic(states: States) -> dict[str, bool]:
    """Return the scalar coordinates that the Lagrangian does not depend on, each with whether that is
    proved."""
    lagrangian = _lagrangian(states)
    scalars = [c for c in states.model.coordinates if isinstance(c, Coordinate)]
    slopes = gradient(states.graph, {lagrangian: states.graph.one}, [c.symbol for c in scalars])
    asked = [[slopes[c.symbol]] if c.symbol in slopes else [] for c in scalars]
    verdicts = zip(scalars, ZeroTest(all_states(states)).vanish_each(asked))
    return {c.name: verdict for c, verdict in verdicts if verdict is not None}


def _lagrangian(states: States) -> Node:
    """Return L in rates, with the potentials that inputs or jumps in time change too."""
    actions = states.model.actions
    kinetic = [body.kinetic_energy for body in states.model.bodies]
    free = [x.function for x in actions if isinstance(x, Lagrangian)]
    potentials = [-x.energy for x in actions if isinstance(x, Potential)]
    return states.in_rates([states.graph.sum(chain(kinetic, free, potentials))])[0]


def _conserved(
    equations: EquationsOfMotion,
    states: States,
    rows: Sequence[tuple[int, Row]],
    met: Consistent,
    cyclic: Mapping[str, bool],
    sure: bool,
) -> tuple[list[Conserved], list[str]]:
    """Return the quantities that are constant along the motion with the independent `rows`, by index, `sure`
    or not that these are all; and those that were not examined. Where loads depend on
    reactions none is."""
    pushes = [contact.multiplier for contact in equations.contacts]
    if symbols(equations.given_forces) & {*equations.lam, *pushes}:
        energy = equations.balance if equations.balance != WHOLE else "energy"
        return [], [f"{energy} and momenta: loads depend on reactions, which are not known without a run"]
    kept = [row for _, row in rows]
    # The motion itself, with accelerations and multipliers, is sampled for small systems only.
    small = len(equations.v) + len(rows) <= LARGEST
    tries = _tries(states, kept, met, small)
    parts = moving_parts(states)
    free = free_terms(states, with_rates(states))
    found: list[Conserved] = []
    positions = on_rows(states, kept, tries)
    motion = ZeroTest(on_motion(equations, states, rows, tries) if small else positions)
    at_rows = ZeroTest(positions)
    # Energy is constant where its power vanishes: on the motion, or already on the rows.
    fed = small or symbols([equations.power]).isdisjoint([*equations.a, *equations.lam])
    steady = motion.vanish([equations.power]) if fed else None
    if steady is not None:
        proved = steady and (sure or equations.power.is_zero)
        name, reason = "energy", "nothing brings power or takes it"
        if equations.balance != WHOLE:
            name, reason = (
                equations.balance,
                "only what drives brings power: Jacobi's integral, not the energy",
            )
        found.append(Conserved(name, equations.energy, reason, proved))
    # A cyclic coordinate has a constant momentum if no force acts along its rate.
    forces = _along_rates(equations, states)
    for c in states.model.coordinates:
        if isinstance(c, Coordinate) and c.name in cyclic:
            unpushed = at_rows.vanish(forces.get(c.rate_symbol, []))
            if unpushed is not None:
                momentum = momenta(states, parts, free, [c.rate_symbol])[c.rate_symbol]
                reason = f"`{c.name}` is cyclic and no force acts along it"
                proved = unpushed and cyclic[c.name]
                found.append(Conserved(Symbol("momentum", c.name).name, momentum, reason, proved))
    # Of the whole system: momenta whose derivatives along the motion vanish.
    if equations.model.bodies and small:
        quantities = Quantities(states, parts, (), free, equations.kinetic, equations.potential)
        found.extend(_totals(states, quantities, motion, at_rows, sure))
    left = [] if fed else [equations.balance if equations.balance != WHOLE else "energy"]
    if not small and equations.model.bodies:
        left.append("total momenta")
    return [_with_cuts(states, c, at_rows) for c in found], left


def _with_cuts(states: States, c: Conserved, at_rows: ZeroTest) -> Conserved:
    """Return a conserved quantity with a remark if it jumps where an `atan2` passes its cut. The slopes do
    not show such a jump by a full turn."""
    graph, node = states.graph, c.expression
    moving = depends([node], states.q)
    for angle in [x for x in moving if x.op == "atan2"]:
        (turned,) = substitute(graph, [node], {angle: angle + math.tau})
        if at_rows.vanish([turned - node]) is None:
            return replace(c, reason=f"{c.reason}, as long as no `atan2` passes its cut, where it jumps")
    return c


def _tries(states: States, rows: Sequence[Row], met: Consistent, small: bool) -> list[dict[Node, float]]:
    """Return consistent states: with the default parameters, near the start and farther away, then with other
    parameters."""
    count = _STATES if small else 1
    drawn = list(samples(states.model, count))
    if len(rows) <= _FEW and not any(row.holonomic for row in rows):
        drawn += far_away(states)  # beside closed loops these may be other ways to assemble them
    beside = map(onto(states, rows), drawn)
    start = [] if met.start is None else [met.start]
    return [*start, *met.beside[:1], *met.far[-2:], *(s for s in beside if s is not None)]


def _along_rates(equations: EquationsOfMotion, states: States) -> dict[Node, list[Node]]:
    """Return, by rate, the forces along it: of each action without a potential, and of each multiplier."""
    forces = [c.forces for c in equations.contributions if not c.conservative]
    found: dict[Node, list[Node]] = {}
    for table in chain(forces, [row.jacobian for row in equations.rows]):
        for rate, node in rate_coefficients(states, table).items():
            found.setdefault(rate, []).append(node)
    return found


def _totals(
    states: States, quantities: Quantities, motion: ZeroTest, at_rows: ZeroTest, sure: bool
) -> list[Conserved]:
    """Return the components of the total momenta that are constant along the motion and not zero."""
    found: list[Conserved] = []
    for kind, reason in (
        ("momentum", "no net force acts along it"),
        ("angular_momentum", "no net torque acts about it"),
    ):
        for axis in "xyz":
            asked = Symbol(kind, component=axis)
            node = quantities.value(asked)
            if at_rows.vanish([node]) is not None:
                continue
            proved = motion.vanish([tangent(states.graph, [node], states.flow)[0]])
            if proved is not None:
                found.append(Conserved(asked.name, node, reason, proved and sure))
    return found
