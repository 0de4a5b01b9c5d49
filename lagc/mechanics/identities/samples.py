"""Random states, and values together with the sizes of their terms.

**States** are seeded, near the defaults and the initial values. An identity that holds at a few random states
holds everywhere, up to a set of measure zero (Schwartz-Zippel for analytic functions); cancellation leaves
about 1e-16.

**Sizes.** A number is zero only relative to its terms: cancellation leaves about 1e-16 of them. Sizes that
add in sums and multiply in products are far too large for long expressions, as components of a vector that
was rotated ten times. So the size is measured: the change of the value if each operation is perturbed by a
small relative error, over that error (stochastic arithmetic: J. Vignes, *Math. Comput. Simul.* 35, 1993).
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from random import Random

from lagc.base.records import dataclass
from lagc.semantics.model import Coordinate, Model, Parameter
from lagc.symbolic.graph import Node
from lagc.symbolic.operators import FLAT, LOGIC, STEP, smooth_as
from lagc.symbolic.walk import evaluate, reachable, value_of

_TRIES = 8  # states tried for every one wanted, where expressions leave their domain


@dataclass
class Chance:
    """A generator of numbers in (-1, 1), the same on every machine and version: G. Marsaglia's multiply with
    carry."""

    state: int = 20011

    def draw(self) -> float:
        self.state = (self.state * 6364136223846793005 + 1442695040888963407) % (1 << 64)
        return (self.state >> 11) / (1 << 52) - 1.0


def samples(model: Model, count: int, vary: bool = True, spread: float = 0.3) -> Iterator[dict[Node, float]]:
    """Return `count` states, symbol -> value (fewer if initial values are outside a domain). With `vary`
    False the parameters keep their defaults; with `spread` 0 the positions are the initial ones and only
    speeds are random."""
    chance = Chance()
    given = 0
    sizes = unit_sizes(model)
    for _ in range(count * _TRIES):
        state = _draw(model, chance, vary, spread, sizes)
        if all(math.isfinite(x) for x in state.values()):
            yield state
            given += 1
        if given == count:
            return


def unit_sizes(model: Model) -> dict[str, float]:
    """Return the size of scalar coordinates of each unit: the largest start, or the median value of a
    parameter of that unit if that is larger; 1 for numbers, angles and units without either."""
    values = {p.symbol: p.value if p.value is not None else 1.0 for p in model.parameters}
    found: dict[str, float] = {}
    for c in model.coordinates:
        if isinstance(c, Coordinate) and c.unit not in ("", "rad"):
            start = abs(evaluate([c.start], values)[0])
            found[c.unit] = max(found.get(c.unit, 0.0), start if math.isfinite(start) else 0.0)
    for unit, size in found.items():
        same = sorted(abs(p.value) for p in model.parameters if p.unit == unit and p.value)
        found[unit] = max(size, same[len(same) // 2] if same else 0.0) or 1.0
    return found


def _draw(
    model: Model, chance: Chance, vary: bool, spread: float, sizes: Mapping[str, float]
) -> dict[Node, float]:
    state: dict[Node, float] = {
        p.symbol: _parameter(p, chance, vary, sizes.get(p.unit, 1.0)) for p in model.parameters
    }
    for given in model.inputs:
        state[given.symbol] = given.default + chance.draw()
    for variable in model.discretes:
        start = evaluate([variable.start], state)[0]
        state[variable.symbol] = float(chance.draw() > 0.0) if variable.boolean else start + chance.draw()
    # Start values may depend on parameters, and on nothing that moves.
    starts: dict[Node, float] = dict(state)
    state[model.time] = 0.5 + 0.4 * chance.draw()
    for c in model.coordinates:
        if isinstance(c, Coordinate):
            start, size = evaluate([c.start], starts)[0], sizes.get(c.unit, 1.0)
            state[c.symbol] = start + spread * max(size, abs(start)) * chance.draw()
            state[c.rate_symbol] = size * chance.draw()
        else:
            turned = [0.3 + chance.draw() for _ in range(4)] if spread else evaluate(c.start, starts)
            size = math.sqrt(sum(x * x for x in turned))
            state.update(zip(c.symbols, [x / size for x in turned]))
            state.update((symbol, chance.draw()) for symbol in c.rate_symbols)
    for speed in model.speeds:
        state[speed.symbol] = sizes.get(speed.unit.removesuffix("/s"), 1.0) * chance.draw()
    return state


def _parameter(p: Parameter, chance: Chance, vary: bool, size: float) -> float:
    step = chance.draw()
    if p.value is not None and not vary:
        return p.value
    centre = 1.0 if p.value is None else p.value
    value = centre + 0.2 * step * (abs(centre) or size)
    return min(max(value, p.minimum), p.maximum)


VANISHES = 1e-9  # of its terms
_OFF = 2.0**-26  # of a result: far more than rounding, and what goes with its square is far less
_DRAWS = 2
_EXACT = smooth_as(STEP, FLAT, LOGIC) | {"const"}


def magnitudes(
    nodes: Sequence[Node], state: Mapping[Node, float], within: Sequence[Node] | None = None
) -> list[tuple[float, float]]:
    """Return the value and the size of each node, which is at least the value. `within` as in `evaluate`."""
    order = reachable(nodes) if within is None else within
    value = {**state, **dict(zip(order, evaluate(order, state, order)))}
    size = [abs(value[node]) for node in nodes]
    chance = Random(0)
    for _ in range(_DRAWS):
        moved = _perturbed(order, state, value, chance)
        for k, node in enumerate(nodes):
            size[k] = max(size[k], abs(moved[node] - value[node]) / _OFF)
    return [(value[node], own) for node, own in zip(nodes, size)]


def _perturbed(
    order: Sequence[Node], state: Mapping[Node, float], value: Mapping[Node, float], chance: Random
) -> dict[Node, float]:
    """Return the values with each operation perturbed; a value that does not exist is not changed."""
    moved: dict[Node, float] = {}
    for node in order:
        own = value[node]
        if node.op not in _EXACT and not (node in state and node.op != "symbol"):
            there = own if node in state else value_of(node, moved)
            there *= 1.0 + _OFF * chance.uniform(-1.0, 1.0)
            own = there if math.isfinite(there) else own
        moved[node] = own
    return moved
