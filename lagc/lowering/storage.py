"""Where the symbols of the equations live in the arrays of generated functions."""

from collections.abc import Callable, Sequence

from lagc.base.records import dataclass
from lagc.lowering.program import Function
from lagc.lowering.scalar.common_factors import factored, plan
from lagc.lowering.scalar.expand import Coefficients, Lowering, expanded
from lagc.lowering.scalar.parameter_hoisting import FIXED, dependence
from lagc.lowering.scalar.value_numbering import Block
from lagc.mechanics.formulation.equations import EquationsOfMotion
from lagc.semantics.model import Parameter
from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.operators import OPERATORS
from lagc.symbolic.walk import reachable

STATE = ("p", "t", "x")
_LARGEST_TRIAL = 800  # nodes
_LARGEST_RARE = 100  # nodes, of a function that no step calls
_LARGEST_GATHERED = 1000  # nodes; beyond, to gather coefficients costs more than it saves
_LARGEST_SEARCHED = 4000  # nodes, for common factors and shared products, of a function that no step calls
WEIGHTS = {
    "load": 0, "const": 0, "neg": 0, "add": 1, "sub": 1, "mul": 1, "div": 4,
    **{op: row.weight for op, row in OPERATORS.items()},
}  # fmt: skip


@dataclass(frozen=True)
class Places:
    """Symbol -> (array, index), for the parameters that are kept."""

    equations: EquationsOfMotion
    arrays: dict[Node, tuple[str, int]]
    constants: tuple[Node, ...]  # the symbols of parameters
    state: tuple[str, ...] = STATE  # the arrays that the equations are functions of

    @property
    def graph(self) -> Graph:
        return self.equations.graph


def places(
    equations: EquationsOfMotion, parameters: Sequence[Parameter], modes: Sequence[Node] = (), nz: int = 0
) -> Places:
    """Return the places of symbols: parameters and inputs in p, time in t, q and v in x, discrete variables
    there behind `nz` work integrals, modes of relations, a and lam."""
    found: dict[Node, tuple[str, int]] = {equations.time: ("t", 0)}
    given = [*(p.symbol for p in parameters), *(u.symbol for u in equations.model.inputs)]
    for array, symbols in (
        ("p", given), ("x", [*equations.q, *equations.v]), ("modes", modes), ("a", equations.a),
        ("lam", equations.lam),
    ):  # fmt: skip
        found.update((symbol, (array, k)) for k, symbol in enumerate(symbols))
    first = len(equations.q) + len(equations.v) + nz
    for k, variable in enumerate(equations.model.discretes):
        found[variable.symbol] = ("x", first + k)
    row = 0
    for contact in equations.contacts:
        found.update((force, ("contact_forces", row + k)) for k, force in enumerate(contact.forces))
        row += len(contact.jacobians)
    state = (*STATE, "modes") if modes else STATE
    return Places(equations, found, tuple([p.symbol for p in parameters]), state)


def lower(
    places: Places, block: Block, nodes: Sequence[Node], rare: bool = False, factors: bool = True
) -> tuple[Lowering, list[int]]:
    """Return the values of `nodes` in `block`, for a function that is called rarely or often, and the
    lowering for more. Symbols are loaded from their places. Without `factors`, common factors are not
    searched in long functions."""
    graph = places.graph
    known = {symbol: block.load(array, k) for symbol, (array, k) in places.arrays.items()}
    size = len(reachable(nodes))
    if size > _LARGEST_GATHERED:
        searched = factors and (not rare or size <= _LARGEST_SEARCHED)
        if searched:
            nodes = factored(graph, nodes)
        lowering = Lowering(block, known, plan(nodes) if searched and not rare else None)
        return lowering, lowering(nodes)
    found = Coefficients(graph, nodes, places.constants)
    nodes, meaning = factored(graph, found.nodes), factored(graph, list(found.meaning.values()))
    lowering = Lowering(block, known, plan([*meaning, *nodes]))
    lowering.known.update(zip(found.meaning, lowering(meaning)))
    return lowering, lowering(nodes)


def cheapest(
    places: Places,
    nodes: Sequence[Node],
    make: Callable[[Sequence[Node]], list[Function]],
    rare: bool = False,
) -> list[Function]:
    """Return `make(nodes)`, or the same of the expanded nodes if the first of the functions is cheaper. For a
    `rare` function this is tried only if it is fast."""
    plain = make(nodes)
    if len(reachable(nodes)) > (_LARGEST_RARE if rare else _LARGEST_TRIAL):
        return plain
    out = expanded(places.graph, nodes)
    if all(a is b for a, b in zip(nodes, out)):
        return plain
    other = make(out)
    constants = len(places.constants)
    return other if weight(other[0], constants) < weight(plain[0], constants) else plain


def weight(function: Function, parameters: int) -> int:
    """Return about the time of a function in additions, without values that depend on parameters alone."""
    made_of = dependence(function, parameters)
    return sum([WEIGHTS[o.op] for o, kind in zip(function.operations, made_of) if kind != FIXED])
