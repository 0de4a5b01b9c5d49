"""Quantities of the whole system for outputs: energies, powers, momenta, accelerations, reactions."""

from __future__ import annotations

from collections.abc import Sequence

from lagc.mechanics.balance.energy import Energies
from lagc.mechanics.balance.generalized_forces import Acting, force_along
from lagc.mechanics.formulation.equations import OutputEquation
from lagc.mechanics.formulation.euler_lagrange import FreeTerms
from lagc.mechanics.formulation.mass_matrix import Moving
from lagc.mechanics.formulation.states import States, rate_symbols
from lagc.semantics.model import Body, Coordinate, Output
from lagc.symbolic.derivative import gradient, seeds, tangent
from lagc.symbolic.graph import Node
from lagc.symbolic.leaves import QUANTITIES, Symbol
from lagc.symbolic.vectors import Matrix, Vector, add, cross, matvec
from lagc.symbolic.walk import substitute, symbols

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
    return tuple([_equation(o, node) for o, node in zip(outputs, nodes)])


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
    if states.model.released is not None and any(s.record.kind == "reaction" for s in asked):
        from lagc.mechanics.balance.reactions import reactions  # where outputs ask for them

        expressions = substitute(graph, expressions, reactions(states.model.released))
        asked = sorted(symbols(expressions), key=lambda s: s.index)
    filled: dict[Node, Node] = {}
    labels = {label for c in states.model.constraints for label in c.labels}
    labels.update(c.label for c in states.model.contacts)
    quantities = Quantities(states, parts, acting, free, totals.kinetic, totals.potential)
    for symbol in asked:
        record = symbol.record
        if record.kind in QUANTITIES:
            filled[symbol] = quantities.value(record)
        elif record.kind == "multiplier" and (record.owner in dropped or record.owner not in labels):
            filled[symbol] = graph.zero
    filled.update(_accelerations(states, asked))
    filled.update(() if states.plain else states.rates.items())
    return substitute(graph, expressions, filled)


def _equation(output: Output, node: Node) -> OutputEquation:
    return OutputEquation(output.name, node, output.unit, output.display_unit)


def _accelerations(states: States, asked: Sequence[Node]) -> dict[Node, Node]:
    """d(rate)/dt -> its expression in a (and v), for rates that are no speeds themselves."""
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
        """The node of a quantity of `Model`."""
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
        """dL/d(rate) of a scalar coordinate, or along one axis of an orientation."""
        where = (asked.owner, asked.component)
        rates = [rate for c in self.states.model.coordinates for rate in rate_symbols(c)]
        rate = next(x for x in rates if (x.record.owner, x.record.component) == where)
        return momenta(self.states, self.parts, self.free, [rate])[rate]

    def _linear(self) -> Vector:
        """sum of m v over the bodies, world axes."""
        total = self._nothing()
        for part in self.parts:
            if not isinstance(part.mass, tuple):
                total = add(total, part.momentum(part.velocity))
        return total

    def _angular(self) -> Vector:
        """sum of r x m v + R I w over the bodies: about the origin, world axes."""
        total = self._nothing()
        for part in self.parts:
            p = part.momentum(part.velocity)
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
    """dL/d(rate), in v, for each of `rates`."""
    graph = states.graph
    raw = [x for part in parts for x in _velocity(part)]
    weights = [x for part in parts for x in part.momentum(part.velocity)]
    marks = [graph.symbol("weight", str(k)) for k in range(len(weights))]
    found = gradient(graph, seeds(graph, zip(raw, marks)), rates)
    filled = {**dict(zip(marks, weights)), **({} if states.plain else states.rates)}
    nodes = substitute(graph, [found.get(rate, graph.zero) for rate in rates], filled)
    return {rate: node + free.momenta.get(rate, graph.zero) for rate, node in zip(rates, nodes)}


def _velocity(part: Moving) -> Vector:
    """In rates, as the model gives it."""
    if isinstance(part.mass, tuple) and part.body.frame is not None:
        return part.body.frame.angular_velocity
    return part.body.velocity
