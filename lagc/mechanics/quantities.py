"""What outputs ask of the whole system: energies, powers, momenta, accelerations, reactions."""

from __future__ import annotations

from collections.abc import Sequence

from lagc.expr.derivative import gradient, tangent
from lagc.expr.graph import Node
from lagc.expr.vectors import Matrix, Vector, add, cross, matvec
from lagc.expr.walk import substitute, symbols
from lagc.meaning.model import Body, Output
from lagc.mechanics.actions import Acting
from lagc.mechanics.energy import Energies
from lagc.mechanics.equations import OutputEquation
from lagc.mechanics.freeterms import FreeTerms
from lagc.mechanics.inertia import Moving
from lagc.mechanics.states import States, key, rate_symbols, seeds

_AXES = ("x", "y", "z")


def output_equations(
    states: States,
    parts: Sequence[Moving],
    acting: Sequence[Acting],
    free: FreeTerms,
    totals: Energies,
    dropped: Sequence[str],
) -> tuple[OutputEquation, ...]:
    """The outputs in t, q, v, a, lam and parameters.

    `dropped` are the labels of rows that were found superfluous: their multipliers are zero.
    """
    graph, outputs = states.graph, states.model.outputs
    asked = sorted(symbols([o.expression for o in outputs]), key=lambda s: s.index)
    filled: dict[Node, Node] = {}
    quantities = Quantities(states, parts, acting, free, totals.kinetic, totals.potential)
    for symbol in asked:
        kind, name = key(symbol)
        if kind == "quantity":
            filled[symbol] = quantities.value(name)
        elif kind == "multiplier" and name in dropped:
            filled[symbol] = graph.zero
    filled.update(_accelerations(states, asked))
    filled.update(() if states.plain else states.rates.items())
    nodes = substitute(graph, [o.expression for o in outputs], filled)
    return tuple([_equation(o, node) for o, node in zip(outputs, nodes)])


def _equation(output: Output, node: Node) -> OutputEquation:
    return OutputEquation(output.name, node, output.unit, output.display_unit)


def _accelerations(states: States, asked: Sequence[Node]) -> dict[Node, Node]:
    """d(rate)/dt -> its expression in a (and v), for rates that are no speeds themselves."""
    names = {f"der({key(rate)[1]})": rate for rate in states.rates}
    wanted = [s for s in asked if key(s)[0] == "acceleration" and s not in states.a]
    rates = [states.rates[names[key(s)[1]]] for s in wanted]
    return dict(zip(wanted, tangent(states.graph, rates, states.flow)))


class Quantities:
    """Whole-system quantities by name, each computed where asked for."""

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
        self.known = {
            "energy()": kinetic + potential,
            "kinetic()": kinetic,
            "potential()": potential,
        }

    def value(self, name: str) -> Node:
        """The node of a quantity named as `Model` says; KeyError for any other name."""
        if name in self.known:
            return self.known[name]
        head, _, rest = name.partition("(")
        argument, _, axis = rest.rpartition(")")
        if axis:
            total = self._linear() if head == "momentum" else self._angular()
            return total[_AXES.index(axis[1:])]
        if head == "power":
            return next(x.contribution.power for x in self.acting if x.contribution.name == argument)
        return self._generalized(argument)

    def _generalized(self, coordinate: str) -> Node:
        """dL/d(rate) of a scalar coordinate, or of one body rate, `o.rate.x`."""
        for c in self.states.model.coordinates:
            for rate in rate_symbols(c):
                if key(rate)[1] in (f"der({coordinate})", coordinate):
                    return momenta(self.states, self.parts, self.free, [rate])[rate]
        raise KeyError(coordinate)

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
