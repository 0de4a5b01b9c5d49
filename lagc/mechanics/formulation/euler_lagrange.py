"""Free terms of the Lagrangian: `lagrangian` and `kinetic`, by Euler-Lagrange in the rates.

With p_i = dL/d(rate_i):   E_i = d(p_i)/dt - dL/d(position)_i   for a scalar coordinate,
                           E   = d(p)/dt + w x p - dL/d(rotation) for the body rates w of an
orientation (Euler-Poincare; both are Boltzmann-Hamel equations: A. M. Bloch, *Nonholonomic
Mechanics and Control*, 2015, sec. 3.8).  E is then taken to the speeds by virtual power.
"""

from collections.abc import Sequence

from lagc.base.records import dataclass
from lagc.diagnostics.faults import Fault, Refused
from lagc.mechanics.formulation.states import States, position_symbols, quaternion_rate
from lagc.semantics.model import Coordinate, Lagrangian, Model
from lagc.symbolic.derivative import gradient, seeds, tangent
from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.vectors import cross
from lagc.symbolic.walk import depends


@dataclass(frozen=True, slots=True)
class FreeTerms:
    """Contributions of the free terms: to M (i >= j), to h, to the momenta and to the energies."""

    mass_matrix: dict[tuple[int, int], Node]
    bias: dict[int, Node]
    momenta: dict[Node, Node]  # rate symbol -> dL/d(rate), in v
    kinetic: Node  # of `kinetic` terms themselves; of a Lagrangian its energy less that at rest
    potential: Node  # of Lagrangians: minus their value at rest
    jacobi: Node  # sum of rate_i p_i - L
    beyond: Node  # by which that of `kinetic` terms is more than themselves
    explicit: Node  # dL/dt with coordinates and rates held


def with_rates(states: States) -> list[Lagrangian]:
    """Return the free terms of the model that hold rates: the others are mere potentials."""
    terms = [x for x in states.model.actions if isinstance(x, Lagrangian)]
    functions = states.in_rates([x.function for x in terms])
    moving = depends(functions, list(states.rates))
    return [x for x, f in zip(terms, functions) if x.is_kinetic or f in moving]


def free_terms(states: States, terms: Sequence[Lagrangian]) -> FreeTerms:
    """Return the contributions of the free terms `terms`. Raises Refused: LAG0406 a free term that depends on
    an input."""
    graph, rates = states.graph, list(states.rates)
    _check(states.model, terms)
    # Lagrangians and kinetic terms differ in the energy alone: of a Lagrangian, what is not kinetic counts as
    # potential.
    functions = states.in_rates([term.function for term in terms])
    pure = graph.sum(x for x, term in zip(functions, terms) if not term.is_kinetic)
    kinetic = graph.sum(x for x, term in zip(functions, terms) if term.is_kinetic)
    total = pure + kinetic
    # p_i = dL/d(rate_i), and dL/dt with positions and rates held.
    momenta = gradient(graph, {total: graph.one}, rates)
    explicit = tangent(graph, [total], {states.model.time: graph.one})[0]
    matrix, bias = _equations(states, total, momenta)
    potential = -states.at_rest([pure])[0]
    # All of it in terms of the speeds.
    moved = states.in_speeds(
        [kinetic, _jacobi(graph, pure, rates), _jacobi(graph, kinetic, rates), explicit, *momenta.values()]
    )
    return FreeTerms(
        mass_matrix=matrix,
        bias=bias,
        momenta=dict(zip(momenta, moved[4:])),
        kinetic=moved[0] + moved[1] - potential,
        potential=potential,
        jacobi=moved[1] + moved[2],
        beyond=moved[2] - moved[0],
        explicit=moved[3],
    )


def _jacobi(graph: Graph, function: Node, rates: Sequence[Node]) -> Node:
    """Return the sum of rate_i dL/d(rate_i) - L."""
    slopes = gradient(graph, {function: graph.one}, rates)
    return graph.sum(rate * p for rate, p in slopes.items()) - function


def _equations(
    states: States, total: Node, momenta: dict[Node, Node]
) -> tuple[dict[tuple[int, int], Node], dict[int, Node]]:
    graph, model = states.graph, states.model
    rates = list(states.rates)
    moved = [states.rates[r] for r in rates]
    # dL/dq along each rate; d(p)/dt with the accelerations zero: that is the bias.
    slopes = _displacement_slopes(graph, model, total)
    in_v = dict(zip(momenta, states.in_speeds(list(momenta.values()))))
    changes = dict(zip(in_v, tangent(graph, list(in_v.values()), states.drift)))
    left = {rate: changes.get(rate, graph.zero) - slopes.get(rate, graph.zero) for rate in rates}
    # Body rates of an orientation: + w x p (Euler-Poincare).
    for c in model.coordinates:
        if not isinstance(c, Coordinate):
            p = (in_v.get(c.rate_symbols[0], graph.zero), in_v.get(c.rate_symbols[1], graph.zero),
                 in_v.get(c.rate_symbols[2], graph.zero))  # fmt: skip
            w = (states.rates[c.rate_symbols[0]], states.rates[c.rate_symbols[1]],
                 states.rates[c.rate_symbols[2]])  # fmt: skip
            for rate, x in zip(c.rate_symbols, cross(w, p)):
                left[rate] = left[rate] + x
    # By virtual power from rates to speeds; the mass matrix is the Hessian by the speeds: d(p)/d(v) carried
    # over in the same way.
    forces = states.in_speeds([left[r] for r in rates])
    weights = seeds(graph, zip(moved, forces))
    matrix: dict[tuple[int, int], Node] = {}
    number = {v: j for j, v in enumerate(states.v)}
    for i, speed in enumerate(states.v):
        partial = tangent(graph, list(in_v.values()), {speed: graph.one})
        pairs = [(states.rates[r], x) for r, x in zip(in_v, partial) if not x.is_zero]
        if pairs:
            row = gradient(graph, seeds(graph, pairs), states.v[: i + 1])
            matrix.update(((i, number[v]), node) for v, node in row.items())
    return matrix, states.to_speeds(weights)


def _displacement_slopes(graph: Graph, model: Model, total: Node) -> dict[Node, Node]:
    """Return, for each rate, dL along the displacement that it makes with all rates held, in rates."""
    places = [x for c in model.coordinates for x in position_symbols(c)]
    slopes = gradient(graph, {total: graph.one}, places)
    found: dict[Node, Node] = {}
    for c in model.coordinates:
        if isinstance(c, Coordinate):
            if c.symbol in slopes:
                found[c.rate_symbol] = slopes[c.symbol]
        else:
            turned = quaternion_rate(c.symbols, c.rate_symbols)
            pairs = [(x, slopes[e]) for x, e in zip(turned, c.symbols) if e in slopes]
            found.update(gradient(graph, seeds(graph, pairs), c.rate_symbols))
    return found


def _check(model: Model, terms: Sequence[Lagrangian]) -> None:
    driven = depends([term.function for term in terms], model.undetermined)
    faults = [
        Fault(
            "LAG0406",
            f"the Lagrangian's term `{term.name}` depends on an input or a discrete variable, whose time "
            "derivative is not known",
            term.span,
            remedy="write the input's share as a force, a torque or a function of `time`",
        )
        for term in terms
        if term.function in driven
    ]
    if faults:
        raise Refused(faults)
