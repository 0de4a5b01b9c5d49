"""What the equations of motion tell of a system before it moves: for people to read.

Questions that symbols do not answer (does a long sum vanish?) are asked at a few random states.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import chain

from lagc.expr.derivative import gradient, tangent
from lagc.expr.evaluate import evaluate
from lagc.expr.graph import Node
from lagc.expr.walk import depends, substitute
from lagc.meaning.model import Coordinate
from lagc.mechanics.actions import act
from lagc.mechanics.equations import EquationsOfMotion
from lagc.mechanics.forms import rate_coefficients
from lagc.mechanics.freeterms import free_terms, with_rates
from lagc.mechanics.inertia import moving_parts
from lagc.mechanics.integrability import integrable_rows
from lagc.mechanics.linear import solve
from lagc.mechanics.magnitude import vanishes
from lagc.mechanics.manifold import onto
from lagc.mechanics.quantities import Quantities, momenta
from lagc.mechanics.redundancy import dependent_rows
from lagc.mechanics.samples import Chance, samples
from lagc.mechanics.states import States, build_states
from lagc.records import dataclass

_STATES = 3
_LARGEST = 60  # speeds and rows for which motions are solved for


@dataclass(frozen=True, slots=True)
class RowKind:
    """What a constraint's row is.  `integrable` is None where the question does not arise."""

    label: str
    constraint: str
    holonomic: bool
    time_dependent: bool
    affine: bool
    integrable: bool | None
    explanation: str


@dataclass(frozen=True, slots=True)
class Conserved:
    """A quantity that keeps its value, in t, q, v, and why."""

    name: str
    expression: Node
    reason: str


@dataclass(frozen=True)
class Analysis:
    """Plain facts, and nodes of the graph of the equations.

    n speeds and p rows make n + p unknowns (accelerations and multipliers) and as many equations.
    `kinetic_parts` are K2, K1, K0, by degree in v; None where K is no polynomial of degree 2.
    """

    coordinates: int
    speeds: int
    rows: int
    redundant: tuple[str, ...]  # labels of holonomic rows that follow from others
    degrees_of_freedom: int  # of the velocities: n less the independent rows
    positional_freedom: int  # degrees of freedom of the positions: integrable rows count
    kinetic_parts: tuple[Node, Node, Node] | None
    cyclic: tuple[str, ...]
    conserved: tuple[Conserved, ...]
    constraints: tuple[RowKind, ...]
    integrable_combinations: int  # relations between positions that rows bring only in combination
    dropped: tuple[str, ...]

    @property
    def unknowns(self) -> int:
        return self.speeds + self.rows


def analyse(equations: EquationsOfMotion) -> Analysis:
    """Counts, kinds, cyclic coordinates and conserved quantities of a system."""
    states = build_states(equations.model)
    rows = equations.rows
    spare = {r.row for r in dependent_rows(states, rows)}
    integrable = integrable_rows(states, [row for k, row in enumerate(rows) if k not in spare])
    independent = len(rows) - len(spare)
    relations = sum(row.kind == "holonomic" or row.label in integrable.rows for row in rows)
    positional = relations + integrable.combinations - len(spare)
    cyclic = _cyclic(states)
    return Analysis(
        coordinates=len(equations.q),
        speeds=len(equations.v),
        rows=len(rows),
        redundant=tuple([rows[k].label for k in sorted(spare)]),
        degrees_of_freedom=len(equations.v) - independent,
        positional_freedom=len(equations.v) - positional,
        kinetic_parts=_kinetic_parts(equations),
        cyclic=cyclic,
        conserved=tuple(_conserved(equations, states, spare, cyclic)),
        constraints=tuple(_kinds(equations, integrable.rows)),
        integrable_combinations=integrable.combinations,
        dropped=equations.dropped,
    )


def _kinds(equations: EquationsOfMotion, integrable: Mapping[str, str]) -> list[RowKind]:
    found: list[RowKind] = []
    for row in equations.rows:
        holonomic = row.kind == "holonomic"
        answer: bool | None = None if holonomic or not row.linear else row.label in integrable
        if holonomic:
            why = "it holds no rate"
        elif not row.linear:
            why = "it is not affine in the rates"
        else:
            why = integrable.get(row.label, "it restricts speeds without restricting positions")
        found.append(
            RowKind(row.label, row.constraint, holonomic, row.time_dependent, row.linear, answer, why)
        )
    return found


def _kinetic_parts(equations: EquationsOfMotion) -> tuple[Node, Node, Node] | None:
    graph, v = equations.graph, equations.v
    if depends(equations.mass_matrix.values(), v):
        return None
    still = dict.fromkeys(v, graph.zero)
    slopes = gradient(graph, {equations.kinetic: graph.one}, v)
    at_rest = substitute(graph, [equations.kinetic, *slopes.values()], still)
    one = graph.sum(x * slope for x, slope in zip(slopes, at_rest[1:]))
    entries = equations.mass_matrix.items()
    two = graph.sum(graph.scale(0.5 if i == j else 1.0, m * v[i] * v[j]) for (i, j), m in entries)
    return two, one, at_rest[0]


def _cyclic(states: States) -> tuple[str, ...]:
    """The scalar coordinates that the Lagrangian does not depend on."""
    lagrangian = _lagrangian(states)
    scalars = [c for c in states.model.coordinates if isinstance(c, Coordinate)]
    slopes = gradient(states.graph, {lagrangian: states.graph.one}, [c.symbol for c in scalars])
    tries = list(samples(states.model, _STATES))
    return tuple([c.name for c in scalars if c.symbol not in slopes or vanishes(slopes[c.symbol], tries)])


def _lagrangian(states: States) -> Node:
    """L in rates."""
    kinetic = [body.kinetic_energy for body in states.model.bodies]
    free = [x.function for x in with_rates(states)]
    stored = [-x.stored for x in act(states)]
    return states.in_rates([states.graph.sum(chain(kinetic, free, stored))])[0]


def _conserved(
    equations: EquationsOfMotion, states: States, spare: set[int], cyclic: Sequence[str]
) -> list[Conserved]:
    parts = moving_parts(states)
    free = free_terms(states, with_rates(states))
    found: list[Conserved] = []
    rows = [row for k, row in enumerate(equations.rows) if k not in spare]
    met = [onto(states, rows, s) for s in samples(equations.model, _STATES)]
    tries = [s for s in met if s is not None]
    multiplied = [_with_multipliers(equations, s) for s in tries]
    if vanishes(equations.power, multiplied):
        found.append(Conserved("energy", equations.energy, "nothing brings power or takes it"))
    pushed = _pushed(equations, states, tries)
    for c in states.model.coordinates:
        if isinstance(c, Coordinate) and c.name in cyclic and c.rate_symbol not in pushed:
            momentum = momenta(states, parts, free, [c.rate_symbol])[c.rate_symbol]
            reason = f"`{c.name}` is cyclic and no force acts along it"
            found.append(Conserved(f"momentum({c.name})", momentum, reason))
    if equations.model.bodies and len(equations.v) + len(rows) <= _LARGEST:
        quantities = Quantities(states, parts, (), free, equations.kinetic, equations.potential)
        found.extend(_totals(equations, states, quantities, spare, tries))
    return found


def _with_multipliers(equations: EquationsOfMotion, state: Mapping[Node, float]) -> dict[Node, float]:
    chance = Chance()
    return {**state, **{x: chance.draw() for x in equations.lam}}


def _pushed(equations: EquationsOfMotion, states: States, tries: Sequence[Mapping[Node, float]]) -> set[Node]:
    """The rates along which a force acts that no potential gives, or a multiplier."""
    forces = [c.forces for c in equations.contributions if not c.conservative]
    pushed: set[Node] = set()
    for table in chain(forces, [row.jacobian for row in equations.rows]):
        weights = rate_coefficients(states, table)
        pushed |= {rate for rate, x in weights.items() if not vanishes(x, tries)}
    return pushed


def _totals(
    equations: EquationsOfMotion,
    states: States,
    quantities: Quantities,
    spare: set[int],
    tries: Sequence[Mapping[Node, float]],
) -> list[Conserved]:
    """Components of the total momenta that are constant along the motion, where they are not zero."""
    moving = [m for m in (_with_accelerations(equations, s, spare) for s in tries) if m is not None]
    found: list[Conserved] = []
    for head, reason in (
        ("momentum", "no net force acts along it"),
        ("angular_momentum", "no net torque acts about it"),
    ):
        for axis in "xyz":
            name = f"{head}().{axis}"
            node = quantities.value(name)
            rate = tangent(states.graph, [node], states.flow)[0]
            if not vanishes(node, tries) and vanishes(rate, moving):
                found.append(Conserved(name, node, reason))
    return found


def _with_accelerations(
    equations: EquationsOfMotion, state: Mapping[Node, float], spare: set[int]
) -> dict[Node, float] | None:
    """`state` with a and lam of its motion; None where the system is singular there."""
    nv = len(equations.v)
    rows = [row for k, row in enumerate(equations.rows) if k not in spare]
    size = nv + len(rows)
    table = [[0.0] * size for _ in range(size)]
    masses = evaluate(list(equations.mass_matrix.values()), state)
    for (i, j), m in zip(equations.mass_matrix, masses):
        table[i][j] = table[j][i] = m
    for k, row in enumerate(rows, nv):
        for j, g in zip(row.jacobian, evaluate(list(row.jacobian.values()), state)):
            table[k][j], table[j][k] = g, -g
    given = evaluate(equations.given_forces, state)
    bias = evaluate(equations.bias_forces, state)
    right = [t - h for t, h in zip(given, bias)] + evaluate([row.gamma for row in rows], state)
    solution = solve(table, right) if all(map(math.isfinite, chain(right, *table))) else None
    if solution is None:
        return None
    multipliers = [equations.lam[k] for k in range(len(equations.rows)) if k not in spare]
    zeros = dict.fromkeys(equations.lam, 0.0)
    return {**state, **zeros, **dict(zip([*equations.a, *multipliers], solution))}
