"""States of the motion: q, v, a, how q moves, and the rates in terms of the speeds."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

from lagc.base.records import dataclass
from lagc.mechanics.formulation.equations import StartValue, StatedRate
from lagc.mechanics.formulation.speeds import choose_speeds
from lagc.semantics.model import UNSTATED, Coordinate, Model, Orientation, Statement
from lagc.symbolic.derivative import gradient, seeds
from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.operators import Interval
from lagc.symbolic.vectors import axis_rates
from lagc.symbolic.walk import substitute


@dataclass(frozen=True)
class States:
    """The symbols of the motion. `rates` maps each rate symbol to its expression in v, the identity if no
    speed is declared (`plain`)."""

    model: Model
    q: tuple[Node, ...]
    v: tuple[Node, ...]
    a: tuple[Node, ...]
    q_units: tuple[str, ...]
    v_units: tuple[str, ...]
    qdot: tuple[Node, ...]
    quaternions: tuple[int, ...]
    rates: dict[Node, Node]
    starts_q: tuple[StartValue, ...]
    starts_v: tuple[StartValue, ...]
    stated_rates: tuple[StatedRate, ...]

    @property
    def graph(self) -> Graph:
        return self.model.graph

    @cached_property
    def plain(self) -> bool:
        return not self.model.speeds

    @cached_property
    def place_of_q(self) -> dict[Node, int]:
        return {q: k for k, q in enumerate(self.q)}

    @cached_property
    def place_of_v(self) -> dict[Node, int]:
        return {v: k for k, v in enumerate(self.v)}

    @cached_property
    def drift(self) -> dict[Node, Node]:
        """Seeds of d/dt with the speeds held: q -> qdot, t -> 1, the axes of frames turn with them."""
        return {**self.motion, self.model.time: self.graph.one}

    @cached_property
    def motion(self) -> dict[Node, Node]:
        """The same with time held."""
        found = dict(zip(self.q, self.qdot))
        for frame in self.model.turning:
            rates = axis_rates(frame.axes, frame.angular_velocity)
            for node, rate in zip(rates, self.in_speeds(list(rates.values()))):
                found.setdefault(node, rate)
        return found

    @cached_property
    def flow(self) -> dict[Node, Node]:
        """Seeds of d/dt along the motion: `drift` and v -> a."""
        return {**self.drift, **dict(zip(self.v, self.a))}

    @cached_property
    def scattered(self) -> tuple[dict[Node, float], ...]:
        """States at random, near the start, farther and far away."""
        from lagc.mechanics.numeric.samples import samples  # for what is asked of some models only

        return tuple([x for spread in (0.3, 3.0, 30.0) for x in samples(self.model, 3, spread=spread)])

    @cached_property
    def bounds(self) -> dict[Node, Interval]:
        return {p.symbol: (p.minimum, p.maximum) for p in self.model.parameters}

    @cached_property
    def rest(self) -> dict[Node, Node]:
        """Every rate and declared speed -> 0, in expressions that still hold rates."""
        at_rest: dict[Node, Node] = dict.fromkeys(self.rates, self.graph.zero)
        for speed in self.model.speeds:  # one may be declared in terms of those before it
            at_rest[speed.symbol] = substitute(self.graph, [speed.expression], at_rest)[0]
        return at_rest

    @cached_property
    def spelt(self) -> dict[Node, Node]:
        """Every declared speed -> its expression in rates."""
        found: dict[Node, Node] = {}
        for speed in self.model.speeds:
            found[speed.symbol] = substitute(self.graph, [speed.expression], found)[0]
        return found

    def in_rates(self, nodes: Sequence[Node]) -> list[Node]:
        """Declared speeds replaced by their expressions in rates."""
        return list(nodes) if self.plain else substitute(self.graph, nodes, self.spelt)

    def in_speeds(self, nodes: Sequence[Node]) -> list[Node]:
        """Rates replaced by their expressions in v."""
        return list(nodes) if self.plain else substitute(self.graph, nodes, self.rates)

    def at_rest(self, nodes: Sequence[Node]) -> list[Node]:
        """`nodes` (in rates) where every rate is zero: the part that drives bring."""
        return substitute(self.graph, nodes, self.rest)

    def to_speeds(self, weights: dict[Node, Node]) -> dict[int, Node]:
        """Generalized forces on v of the virtual power sum of weights[x] * x, x affine in v."""
        found = gradient(self.graph, weights, self.place_of_v)
        return {self.place_of_v[v]: node for v, node in found.items()}

    def force_of(self, slopes: dict[Node, Node]) -> dict[int, Node]:
        """Generalized forces on v of the forces slopes[q_i] on the q_i, in their order: N^T slopes."""
        pairs = [(self.qdot[self.place_of_q[q]], slope) for q, slope in slopes.items()]
        return self.to_speeds(seeds(self.graph, pairs))


def build_states(model: Model) -> States:
    """Lay out q and v in the order of declaration.  Raises Refused as `choose_speeds` does."""
    graph = model.graph
    rates_in_order = [r for c in model.coordinates for r in rate_symbols(c)]
    chosen = choose_speeds(model, rates_in_order)
    v: list[Node] = []
    v_units: list[str] = []
    units = [u for c in model.coordinates for u in _rate_units(c)]
    for i, rate in enumerate(rates_in_order):
        speed = chosen.replaces.get(i)
        v.append(rate if speed is None else speed.symbol)
        v_units.append(units[i] if speed is None else speed.unit)
    rates = {r: chosen.solved.get(r, r) for r in rates_in_order}
    q: list[Node] = []
    q_units: list[str] = []
    qdot: list[Node] = []
    quaternions: list[int] = []
    for c in model.coordinates:
        if isinstance(c, Coordinate):
            q.append(c.symbol)
            q_units.append(c.unit)
            qdot.append(rates[c.rate_symbol])
        else:
            quaternions.append(len(q))
            q.extend(c.symbols)
            q_units.extend(["", "", "", ""])
            qdot.extend(quaternion_rate(c.symbols, [rates[r] for r in c.rate_symbols]))
    return States(
        model=model,
        q=tuple(q),
        v=tuple(v),
        a=tuple([graph.leaf(x.record.derivative) for x in v]),
        q_units=tuple(q_units),
        v_units=tuple(v_units),
        qdot=tuple(qdot),
        quaternions=tuple(quaternions),
        rates=rates,
        starts_q=tuple(_position_starts(model)),
        starts_v=tuple(_speed_starts(model, v)),
        stated_rates=tuple(_stated_rates(model, rates_in_order, units, rates, v)),
    )


def quaternion_rate(e: Sequence[Node], w: Sequence[Node]) -> list[Node]:
    """q' = 1/2 q * (0, w) with w in body axes."""
    ew, ex, ey, ez = e
    return [
        -0.5 * (ex * w[0] + ey * w[1] + ez * w[2]),
        0.5 * (ew * w[0] + ey * w[2] - ez * w[1]),
        0.5 * (ew * w[1] + ez * w[0] - ex * w[2]),
        0.5 * (ew * w[2] + ex * w[1] - ey * w[0]),
    ]


def position_symbols(c: Coordinate | Orientation) -> tuple[Node, ...]:
    """The q that `c` brings."""
    return (c.symbol,) if isinstance(c, Coordinate) else c.symbols


def rate_symbols(c: Coordinate | Orientation) -> tuple[Node, ...]:
    """The rates that `c` brings."""
    return (c.rate_symbol,) if isinstance(c, Coordinate) else c.rate_symbols


def _rate_units(c: Coordinate | Orientation) -> tuple[str, ...]:
    if isinstance(c, Orientation):
        return ("rad/s", "rad/s", "rad/s")
    return (f"{c.unit}/s" if c.unit else "1/s",)


def _position_starts(model: Model) -> list[StartValue]:
    found: list[StartValue] = []
    for c in model.coordinates:
        starts = (c.start,) if isinstance(c, Coordinate) else c.start
        found.extend([StartValue(start, c.start_stated) for start in starts])
    return found


def _rate_starts(model: Model) -> dict[Node, StartValue]:
    found: dict[Node, StartValue] = {}
    for c in model.coordinates:
        if isinstance(c, Coordinate):
            found[c.rate_symbol] = StartValue(c.rate, c.rate_stated)
        else:
            found.update((x, StartValue(r, s)) for x, r, s in zip(c.rate_symbols, c.rate, c.rate_stated))
    return found


def _speed_starts(model: Model, v: Sequence[Node]) -> list[StartValue]:
    """A rate's own start; a declared speed's, or what those of its rates make it (t = 0)."""
    found = _rate_starts(model)
    at_start: dict[Node, Node] = {model.time: model.graph.zero}
    for c in model.coordinates:
        at_start.update(zip(position_symbols(c), (c.start,) if isinstance(c, Coordinate) else c.start))
    at_start.update((rate, start.value) for rate, start in found.items())
    for speed in model.speeds:
        from_rates = substitute(model.graph, [speed.expression], at_start)[0]
        start = from_rates if speed.start is None else speed.start
        at_start[speed.symbol] = start
        found[speed.symbol] = StartValue(start, speed.start_stated or Statement(UNSTATED, speed.span))
    return [found[symbol] for symbol in v]


def _stated_rates(
    model: Model, order: Sequence[Node], units: Sequence[str], rates: dict[Node, Node], v: Sequence[Node]
) -> list[StatedRate]:
    """Those of the rates (`order`, with their `units`) that are stated and no speeds."""
    starts, speeds = _rate_starts(model), set(v)
    return [
        StatedRate(rate, unit, rates[rate], starts[rate])
        for rate, unit in zip(order, units)
        if rate not in speeds and starts[rate].stated.level != UNSTATED
    ]
