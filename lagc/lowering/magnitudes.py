"""Magnitudes of sums and gradients before cancellation.

A gradient through shared sums has an entry for each pair of a row and a leaf. Its length is computed from
node to node instead, without its entries.
"""

from collections.abc import Mapping, Sequence

from lagc.symbolic.derivative import partial
from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.walk import leaves_below, reachable

_MOST_TERMS = 1000
_ROOT = 3  # products that a root costs, with what stands about it


def terms(graph: Graph, node: Node) -> list[Node]:
    """Return the terms of a sum, with sums inside it opened."""
    # A sum of sums as one list of terms, with their numbers multiplied in. Long ones stay as they are from
    # some length on.
    found: list[Node] = []
    stack: list[tuple[float, Node]] = [(1.0, node)]
    while stack:
        c, top = stack.pop()
        if top.op == "scale":
            stack.append((c * top.value, top.args[0]))
        elif top.op == "add" and len(found) + len(stack) < _MOST_TERMS:
            stack.extend([(c, a) for a in reversed(top.args)])
        else:
            found.append(graph.scale(c, top))
    return found


def magnitudes(graph: Graph, nodes: Sequence[Node]) -> list[Node]:
    """Return the absolute values of `nodes` before cancellation: magnitudes add in sums and multiply in
    products."""
    # |a + b| <= |a| + |b| before cancellation. A divisor keeps its own value: it may cancel, and then the
    # quotient is large.
    found: dict[Node, Node] = {}
    for node in reachable(nodes):
        if node.op == "add":
            found[node] = graph.add(*(found[a] for a in node.args))
        elif node.op == "scale":
            found[node] = graph.scale(abs(node.value), found[node.args[0]])
        elif node.op == "mul":
            factors = [
                (found[base] if exponent > 0 else graph.unary("abs", base), exponent)
                for base, exponent in zip(node.args, node.value)
            ]
            found[node] = graph.product(factors)
        else:
            found[node] = graph.unary("abs", node)
    return [found[node] for node in nodes]


def gradient_magnitudes(graph: Graph, nodes: Sequence[Node], weights: Mapping[Node, Node]) -> list[Node]:
    """Return for each of `nodes` the sum over leaves w of |weights[w] d(node)/dw| before cancellation. All
    products along a path contribute the same in any order, so no gradient is formed."""
    # Backpropagation of one number per node: sum over arguments a of |d node / d a| times the number of a.
    # Nodes without leaves of `weights` contribute nothing.
    order = reachable(nodes)
    bits = leaves_below(order, weights)
    moving = [node for node in order if node in bits and node not in weights]
    steps = [(node, k) for node in moving for k, a in enumerate(node.args) if a in bits]
    slopes = magnitudes(graph, [partial(graph, node, k) for node, k in steps])
    found = dict(zip(weights, magnitudes(graph, list(weights.values()))))
    for (node, k), slope in zip(steps, slopes):
        share = slope * found[node.args[k]]
        found[node] = found[node] + share if node in found else share
    return [found.get(node, graph.zero) for node in nodes]


def gradient_bounds(graph: Graph, nodes: Sequence[Node], weights: Mapping[Node, Node]) -> list[Node] | None:
    """Return an upper bound of the sum over leaves w of |weights[w] d(node)/dw| for each of `nodes`, by the
    Cauchy-Schwarz inequality: the root of the sum of squares times their number. None if that takes as many
    products as the gradients. The product of two gradients is that of the arguments of the later node, each
    times its slope."""
    bits = leaves_below(reachable(nodes), weights)
    # Entries of gradients are counted by bits; a root costs about three products.
    most = sum([2 * bits.get(node, 0).bit_count() - _ROOT for node in nodes])
    # The pairs of nodes whose products of gradients are needed, from the pairs of roots down; given up as
    # soon as they are more than the gradients themselves have entries.
    seen = {(node, node) for node in nodes if node in bits}
    stack = list(seen)
    while stack:
        if len(seen) > most:
            return None
        later, other = stack.pop()
        for a in later.args:
            if bits.get(a, 0) & bits[other]:
                pair = (a, other) if a.index >= other.index else (other, a)
                if pair not in seen:
                    seen.add(pair)
                    stack.append(pair)
    # grad x . grad y = sum over arguments a of x of (dx/da) grad a . grad y, x the later one: in the
    # order of the indices, every product on the right is known.
    found: dict[tuple[Node, Node], Node] = {}
    slopes: dict[Node, list[Node | None]] = {}
    for pair in sorted(seen, key=_indices):
        later, other = pair
        if later in weights:
            found[pair] = weights[later] * weights[later] if later is other else graph.zero
            continue
        if later not in slopes:
            arguments = enumerate(later.args)
            slopes[later] = [partial(graph, later, k) if a in bits else None for k, a in arguments]
        total = graph.zero
        for a, slope in zip(later.args, slopes[later]):
            known = found.get((a, other) if a.index >= other.index else (other, a))
            if slope is not None and known is not None:
                total = total + slope * known
        found[pair] = total
    # Of n entries sum |e| <= sqrt(n sum e^2) (Cauchy and Schwarz).
    counts = [bits.get(node, 0).bit_count() for node in nodes]
    squares = [graph.scale(n, found.get((node, node), graph.zero)) for n, node in zip(counts, nodes)]
    return [graph.unary("sqrt", graph.unary("abs", square)) for square in squares]  # which rounding may turn


def _indices(pair: tuple[Node, Node]) -> tuple[int, int]:
    return pair[0].index, pair[1].index
