"""Reactions by virtual release: the force that holds a coordinate which the release adds.

For the speed w = 0 of such a coordinate, the equation of motion with the acceleration w' = 0 leaves

    reaction = (M v')_w + h_w - tau_w - (G^T lambda)_w,

an expression in the states, accelerations and multipliers of the model itself (T. R. Kane, D. A. Levinson,
*Dynamics: Theory and Applications*, 1985, section 4.9: bringing noncontributing forces into evidence).
"""

from __future__ import annotations

from collections.abc import Sequence

from lagc.diagnostics.faults import Fault, Refused
from lagc.mechanics.balance.generalized_forces import act
from lagc.mechanics.formulation.constraints import classify
from lagc.mechanics.formulation.contacts import contact_rows
from lagc.mechanics.formulation.equations import Law
from lagc.mechanics.formulation.euler_lagrange import free_terms, with_rates
from lagc.mechanics.formulation.inertia import inertial_loads, moving_parts
from lagc.mechanics.formulation.mass_matrix import triples
from lagc.mechanics.formulation.states import States, build_states
from lagc.semantics.model import Model, Release
from lagc.symbolic.derivative import gradient, seeds, tangent
from lagc.symbolic.graph import Node
from lagc.symbolic.vectors import matvec
from lagc.symbolic.walk import depends, substitute


def reactions(model: Model) -> dict[Node, Node]:
    """Return the symbol of each component of the reactions -> its expression in t, q, v, a, lam and
    parameters. `model` has the releases.  Raises Refused: LAG0430 the inertia changes with a release."""
    _check(model)
    states = build_states(model)
    rates = [rate for release in model.releases for rate in release.rates]
    held, pushed = _held(states, rates)
    at = {rate.record.derivative: states.graph.zero for rate in rates}
    filled = {a: at[a.record] for a in states.a if a.record in at}
    filled.update(dict.fromkeys(rates, states.graph.zero))
    for release in model.releases:
        filled.update((symbol, states.graph.const(value)) for symbol, value in release.values)
    found: dict[Node, Node] = {}
    for release in model.releases:
        raw = [release.held * held[r] + release.pushed * pushed[r] for r in release.rates]
        nodes = substitute(states.graph, [*raw, *_flat(release)], filled)
        values, axes = nodes[: len(raw)], triples(nodes[len(raw) :])
        if axes:
            values = [*matvec((axes[0], axes[1], axes[2]), (values[0], values[1], values[2]))]
        found.update(zip(release.forces, values))
    return found


def _flat(release: Release) -> list[Node]:
    return [x for row in release.axes or () for x in row]


def _held(states: States, rates: Sequence[Node]) -> tuple[dict[Node, Node], dict[Node, Node]]:
    """Return M v' + h - tau for each of the rates, and G^T lambda."""
    graph = states.graph
    parts = moving_parts(states)
    free = free_terms(states, with_rates(states))
    acting = act(states)
    flat = [x for part in parts for x in part.velocity]
    accelerations = triples(tangent(graph, flat, dict(zip(states.v, states.a))))
    pairs = [
        pair
        for part, acceleration in zip(parts, accelerations)
        for pair in zip(part.velocity, part.momentum(acceleration))
    ]
    inertial = gradient(graph, seeds(graph, [*pairs, *inertial_loads(states, parts).items()]), rates)
    weights = [(x.row.rate, x.row.multiplier) for x in classify(states) if x.row.law is Law.PERFECT]
    for contact in contact_rows(states):
        weights += zip([contact.rate, *(slip.rate for slip in contact.slips)], contact.forces)
    pushed = gradient(graph, seeds(graph, weights), rates)
    found: dict[Node, Node] = {}
    for rate in rates:
        i = states.place_of_v[rate]
        terms = [inertial.get(rate, graph.zero), free.bias.get(i, graph.zero)]
        for j, a in enumerate(states.a):
            if (max(i, j), min(i, j)) in free.mass_matrix:
                terms.append(free.mass_matrix[max(i, j), min(i, j)] * a)
        terms += [-x.contribution.forces[i] for x in acting if i in x.contribution.forces]
        found[rate] = graph.sum(terms)
    return found, {rate: pushed.get(rate, graph.zero) for rate in rates}


def _check(model: Model) -> None:
    """The virtual power of a body whose inertia changes is not known: what moves inside is not said."""
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
