"""Quantities of the whole system for outputs: energies, powers, momenta, accelerations, reactions.

**Reactions** follow by virtual release, as the force that holds a coordinate which the release adds. For the
speed w = 0 of such a coordinate, the equation of motion with the acceleration w' = 0 leaves

    reaction = (M v')_w + h_w - tau_w - (G^T lambda)_w,

an expression in the states, accelerations and multipliers of the model itself (T. R. Kane, D. A. Levinson,
*Dynamics: Theory and Applications*, 1985, section 4.9: bringing noncontributing forces into evidence).
"""

from collections.abc import Sequence

from lagc.diagnostics.faults import Fault, Refused
from lagc.mechanics.balance.energy import Acting, Energies, act, force_along
from lagc.mechanics.formulation.constraints import classify
from lagc.mechanics.formulation.contacts import contact_rows
from lagc.mechanics.formulation.equations import Law, Moving, OutputEquation, triples
from lagc.mechanics.formulation.euler_lagrange import FreeTerms, free_terms, with_rates
from lagc.mechanics.formulation.inertia import inertial_loads, moving_parts
from lagc.mechanics.formulation.states import States, build_states, rate_symbols
from lagc.semantics.model import Body, Coordinate, Model, Release
from lagc.symbolic.derivative import gradient, seeds, tangent
from lagc.symbolic.graph import Node
from lagc.symbolic.leaves import QUANTITIES, Symbol
from lagc.symbolic.vectors import Matrix, Vector, add, cross, matvec
from lagc.symbolic.walk import depends, substitute, symbols

_AXES = "xyz"


def output_equations(
    states: States,
    parts: Sequence[Moving],
    acting: Sequence[Acting],
    free: FreeTerms,
    totals: Energies,
    dropped: Sequence[str],
) -> tuple[OutputEquation, ...]:
    """Return the outputs in t, q, v, a, lam and parameters."""
    outputs = states.model.outputs
    nodes = of_motion([o.expression for o in outputs], states, parts, acting, free, totals, dropped)
    pairs = zip(outputs, nodes)
    return tuple([OutputEquation(o.name, node, o.unit, o.display_unit) for o, node in pairs])


def of_motion(
    expressions: Sequence[Node],
    states: States,
    parts: Sequence[Moving],
    acting: Sequence[Acting],
    free: FreeTerms,
    totals: Energies,
    dropped: Sequence[str],
) -> list[Node]:
    """Return expressions in t, q, v, a, lam and parameters. `dropped` are the labels of redundant rows, whose
    multipliers are zero; so are those of rows that only a released model has."""
    graph = states.graph
    asked = sorted(symbols(expressions), key=lambda s: s.index)
    # Reactions first: their expressions contain other quantities, which are then filled in with the rest.
    if states.model.released is not None and any(s.record.kind == "reaction" for s in asked):
        expressions = substitute(graph, expressions, reactions(states.model.released))
        asked = sorted(symbols(expressions), key=lambda s: s.index)
    filled: dict[Node, Node] = {}
    labels = {label for c in states.model.constraints for label in c.labels}
    labels.update(c.label for c in states.model.contacts)
    quantities = Quantities(states, parts, acting, free, totals.kinetic, totals.potential)
    # Only symbols that occur are computed: momenta and powers of the whole system can be larger than the
    # equations of motion.
    for symbol in asked:
        record = symbol.record
        if record.kind in QUANTITIES:
            filled[symbol] = quantities.value(record)
        # A redundant row has no force of its own in the minimum solution chosen, and a row of the released
        # model none outside it.
        elif record.kind == "multiplier" and (record.owner in dropped or record.owner not in labels):
            filled[symbol] = graph.zero
    # The substitution is simultaneous: what replaces a symbol must itself be free of rates, as these
    # expressions in v and a are.
    filled.update(_accelerations(states, asked))
    filled.update(() if states.plain else states.rates.items())
    return substitute(graph, expressions, filled)


def _accelerations(states: States, asked: Sequence[Node]) -> dict[Node, Node]:
    """Return d(rate)/dt in a (and v) for the rates that are no speeds themselves."""
    # Where speeds are declared, x'' is the derivative of the kinematic equation x' = f(q, v, t) along the
    # flow.
    known = {rate.record.derivative: expression for rate, expression in states.rates.items()}
    wanted = [s for s in asked if s.record.kind == "acceleration" and s not in states.a]
    rates = [known[s.record] for s in wanted]
    return dict(zip(wanted, tangent(states.graph, rates, states.flow)))


class Quantities:
    """Whole-system quantities, each computed where asked for."""

    def __init__(
        self,
        states: States,
        parts: Sequence[Moving],
        acting: Sequence[Acting],
        free: FreeTerms,
        kinetic: Node,
        potential: Node,
    ):
        self.states, self.parts, self.acting, self.free = states, parts, acting, free
        self.known = {"energy": kinetic + potential, "kinetic": kinetic, "potential": potential}

    def value(self, asked: Symbol) -> Node:
        """Return the node of a quantity of `Model`."""
        if asked.kind in self.known:
            return self.known[asked.kind]
        if asked.kind == "power":
            return next(x.contribution.power for x in self.acting if x.contribution.name == asked.owner)
        if asked.kind == "generalized_force":
            action = next(x for x in self.states.model.actions if x.name == asked.owner)
            moved = next(c for c in self.states.model.coordinates if c.name == asked.component)
            assert isinstance(moved, Coordinate)
            return force_along(self.states, action, moved)
        if asked.owner:
            return self._generalized(asked)
        total = self._linear() if asked.kind == "momentum" else self._angular()
        return total[_AXES.index(asked.component)]

    def _generalized(self, asked: Symbol) -> Node:
        """Return dL/d(rate) of a scalar coordinate, or along one axis of an orientation."""
        where = (asked.owner, asked.component)
        rates = [rate for c in self.states.model.coordinates for rate in rate_symbols(c)]
        rate = next(x for x in rates if (x.record.owner, x.record.component) == where)
        return momenta(self.states, self.parts, self.free, [rate])[rate]

    def _linear(self) -> Vector:
        """Return the sum of m v over the bodies, in world axes."""
        total = self._nothing()
        for part in self.parts:
            # A part with a matrix of inertia is the rotation of a body; its translation is a part of its own.
            if not isinstance(part.mass, tuple):
                total = add(total, part.momentum(part.velocity))
        return total

    def _angular(self) -> Vector:
        """Return the sum of r x m v + R I w over the bodies, about the origin, in world axes."""
        total = self._nothing()
        for part in self.parts:
            p = part.momentum(part.velocity)
            # The spin R I w is independent of the point of reference; the orbital part r x m v is about the
            # origin.
            if isinstance(part.mass, tuple):
                total = add(total, matvec(_axes(part.body), p))
            else:
                total = add(total, cross(part.body.position, p))
        return total

    def _nothing(self) -> Vector:
        zero = self.states.graph.zero
        return (zero, zero, zero)


def _axes(body: Body) -> Matrix:
    assert body.frame is not None  # a part with a matrix of inertia has a frame
    return body.frame.axes


def momenta(
    states: States, parts: Sequence[Moving], free: FreeTerms, rates: Sequence[Node]
) -> dict[Node, Node]:
    """Return dL/d(rate), in v, for each of `rates`."""
    graph = states.graph
    # dL/dr' = sum of (m v . dv/dr' + I w . dw/dr') plus the terms of L that the model gives itself: one
    # reverse sweep with the momenta as weights, in place of a product for each rate.
    raw = [x for part in parts for x in _velocity(part)]
    weights = [x for part in parts for x in part.momentum(part.velocity)]
    # The weights are symbols during the sweep, so that derivatives do not go into the momenta.
    marks = [graph.symbol("weight", str(k)) for k in range(len(weights))]
    found = gradient(graph, seeds(graph, zip(raw, marks)), rates)
    filled = {**dict(zip(marks, weights)), **({} if states.plain else states.rates)}
    nodes = substitute(graph, [found.get(rate, graph.zero) for rate in rates], filled)
    return {rate: node + free.momenta.get(rate, graph.zero) for rate, node in zip(rates, nodes)}


def _velocity(part: Moving) -> Vector:
    """Return a velocity in rates, as the model gives it."""
    if isinstance(part.mass, tuple) and part.body.frame is not None:
        return part.body.frame.angular_velocity
    return part.body.velocity


def reactions(model: Model) -> dict[Node, Node]:
    """Return the symbol of each component of the reactions -> its expression in t, q, v, a, lam and
    parameters. `model` has the releases.  Raises Refused: LAG0430 the inertia changes with a release."""
    _check(model)
    states = build_states(model)
    rates = [rate for release in model.releases for rate in release.rates]
    # In the released model the coordinate that a release adds has an unbalanced force; the constraint force
    # that holds it is equal and opposite.
    held, pushed = _unbalanced_forces(states, rates)
    # The rate and its derivative are zero, as the release does not move, after the derivatives have been
    # taken.
    at = {rate.record.derivative: states.graph.zero for rate in rates}
    filled = {a: at[a.record] for a in states.a if a.record in at}
    filled.update(dict.fromkeys(rates, states.graph.zero))
    for release in model.releases:
        filled.update((symbol, states.graph.const(value)) for symbol, value in release.values)
    found: dict[Node, Node] = {}
    for release in model.releases:
        # `held`: M v' + h - tau, the force of all constraints together; `pushed`: G^T lambda, that of the
        # explicit ones (see ON_BODY, BY_GEOMETRY and BY_EQUATIONS of joints).
        raw = [release.held * held[r] + release.pushed * pushed[r] for r in release.rates]
        nodes = substitute(states.graph, [*raw, *_flat(release)], filled)
        values, axes = nodes[: len(raw)], triples(nodes[len(raw) :])
        # A moment about coordinates of an orientation is turned into the axes in which it is reported.
        if axes:
            values = [*matvec((axes[0], axes[1], axes[2]), (values[0], values[1], values[2]))]
        found.update(zip(release.forces, values))
    return found


def _flat(release: Release) -> list[Node]:
    return [x for row in release.axes or () for x in row]


def _unbalanced_forces(states: States, rates: Sequence[Node]) -> tuple[dict[Node, Node], dict[Node, Node]]:
    """Return M v' + h - tau for each of the rates, and G^T lambda."""
    graph = states.graph
    parts = moving_parts(states)
    free = free_terms(states, with_rates(states))
    acting = act(states)
    flat = [x for part in parts for x in part.velocity]
    # Jourdain's principle: project m a and the inertial loads on dv/d(rate). The rows of M for these rates
    # alone are needed, not the whole matrix.
    accelerations = triples(tangent(graph, flat, dict(zip(states.v, states.a))))
    pairs = [
        pair
        for part, acceleration in zip(parts, accelerations)
        for pair in zip(part.velocity, part.momentum(acceleration))
    ]
    inertial = gradient(graph, seeds(graph, [*pairs, *inertial_loads(states, parts).items()]), rates)
    # G^T lambda by the same sweep: each row rate of a constraint with its multiplier, contacts with normal
    # and friction.
    weights = [(x.row.rate, x.row.multiplier) for x in classify(states) if x.row.law is Law.PERFECT]
    for contact in contact_rows(states):
        weights += zip([contact.rate, *(slip.rate for slip in contact.slips)], contact.forces)
    pushed = gradient(graph, seeds(graph, weights), rates)
    found: dict[Node, Node] = {}
    for rate in rates:
        i = states.place_of_v[rate]
        terms = [inertial.get(rate, graph.zero), free.bias.get(i, graph.zero)]
        for j, a in enumerate(states.a):
            # The mass matrix is stored as a lower triangle.
            if (max(i, j), min(i, j)) in free.mass_matrix:
                terms.append(free.mass_matrix[max(i, j), min(i, j)] * a)
        terms += [-x.contribution.forces[i] for x in acting if i in x.contribution.forces]
        found[rate] = graph.sum(terms)
    return found, {rate: pushed.get(rate, graph.zero) for rate in rates}


def _check(model: Model) -> None:
    """Raise Refused for the virtual power of a body whose inertia changes: the motion inside the body is not
    known."""
    # The release of a parameter has no values of its own: the parameter keeps that of the run.
    own = [rate.record.owner for release in model.releases if not release.values for rate in release.rates]
    symbols = {p.symbol: p.name for p in model.parameters if p.name in own}
    faults = []
    for body in model.bodies:
        for symbol, name in symbols.items():
            nodes = [body.mass, *(x for row in body.inertia or () for x in row)]
            if not depends(nodes, [symbol]).isdisjoint(nodes):
                faults.append(
                    Fault(
                        "LAG0430",
                        f"`reaction({name})` is not known: the inertia of `{body.name}` depends on `{name}`",
                        body.span,
                        remedy="give the inertia a parameter of its own",
                    )
                )
    if faults:
        raise Refused(faults)
