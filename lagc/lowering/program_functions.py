"""The functions of a program besides the solve: one maker each, None where it does not exist."""

from collections.abc import Container, Iterable, Mapping, Sequence
from typing import NamedTuple

from lagc.base.records import replace
from lagc.lowering.interface import kinds, rates
from lagc.lowering.jacobians import condition_rows, start_units
from lagc.lowering.kkt.solve import row_comments
from lagc.lowering.magnitudes import gradient_bounds, gradient_magnitudes, magnitudes, terms
from lagc.lowering.program import Function
from lagc.lowering.scalar.value_numbering import Block
from lagc.lowering.storage import STATE, Places, cheapest, lower
from lagc.mechanics.formulation.equations import Row
from lagc.symbolic.derivative import Slopes, gradient, tangent
from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.walk import reachable, substitute, symbols

_MOST_ZEROS = 3000  # that are stored one by one
_TINY = 1e-300  # stands for zero where it divides zero
_BESIDE = 1e-6  # of other rows of its unit: smaller, the terms of a row may be rounding of theirs


def system(places: Places, rare: bool) -> Function:
    """Return the function of M, r = tau - h, G and gamma for a dense solve; zeros of M and G are stored
    too."""
    equations, n = places.equations, len(places.equations.v)
    packed = {i * (i + 1) // 2 + j: node for (i, j), node in equations.mass_matrix.items()}
    jacobian = {k * n + j: node for k, row in enumerate(equations.rows) for j, node in row.jacobian.items()}
    return made(
        places, "system", places.state,
        (
            ("qdot", equations.qdot), ("M", matrix(places, packed, n * (n + 1) // 2)),
            ("r", equations.applied_forces), ("G", matrix(places, jacobian, len(equations.rows) * n)),
            ("gamma", [row.gamma for row in equations.rows]),
        ),
        "mass matrix, forces and constraint equations",
        rare=rare,
    )  # fmt: skip


def forces(places: Places) -> Function:
    """Return the function of qdot and the right-hand side, without a matrix."""
    equations = places.equations
    right = [*equations.applied_forces, *(row.gamma for row in equations.rows)]
    outputs = (("qdot", equations.qdot), ("r", right))
    return made(places, "forces", places.state, outputs, "qdot, forces, gamma of the rows", rare=True)


class Sparse(NamedTuple):
    """An array of `length` with few `entries`."""

    length: int
    entries: dict[int, Node]


def matrix(places: Places, entries: Mapping[int, Node], length: int) -> Sparse | list[Node]:
    """Return all entries of a matrix or, if there are very many zeros, the entries that are not zero."""
    found = {k: node for k, node in sorted(entries.items()) if not node.is_zero}
    if length - len(found) > _MOST_ZEROS:
        return Sparse(length, found)
    return [found.get(k, places.graph.zero) for k in range(length)]


def displace(places: Places) -> Function | None:
    """Return the function dq = N(t,q) d; None if qdot = v."""
    equations, graph = places.equations, places.graph
    if equations.qdot == equations.v:
        return None
    d = [graph.symbol("displacement", name) for name in equations.v_names]
    dq = tangent(graph, equations.qdot, dict(zip(equations.v, d)))
    more = replace(places, arrays={**places.arrays, **{node: ("d", k) for k, node in enumerate(d)}})
    return made(more, "displace", (*STATE, "d"), (("dq", dq),), "dq = N(t,q) d")


def position(places: Places) -> Function:
    rows = [row for row in places.equations.rows if row.holonomic]
    residuals = [row.residual for row in rows]
    comments = row_comments(rows)
    return made(places, "position", STATE, (("phi", residuals),), "holonomic residuals", comments)


def velocity(places: Places) -> Function:
    rows = places.equations.rows
    rates = [row.rate for row in rows]
    return made(
        places, "velocity", STATE, (("psi", rates),), "rates of the constraint equations", row_comments(rows)
    )


def scales(places: Places) -> Function:
    """Return the sum of the absolute terms of each row. A further term for each coordinate that is no angle
    (speed, for a velocity row) covers cancellation inside products, as in dot(v, u)."""
    # Products of a coordinate and its slope count too, where terms inside a product cancel.
    graph, equations = places.graph, places.equations
    states = kinds(equations.q_units, equations.v_units)
    lengths = {x: k for k, (x, kind) in enumerate(zip(equations.q, states)) if kind > 0}
    sizes: list[Node] = []
    for row in equations.rows:
        if row.holonomic:
            slopes = gradient(graph, {row.residual: graph.one}, lengths)
        else:
            slopes = {equations.v[k]: row.jacobian[k] for k in sorted(row.jacobian)}
        parts = [*terms(graph, row.residual), *(slope * x for x, slope in slopes.items())]
        size = graph.sum(graph.unary("abs", part) for part in parts)
        sizes.append(graph.sum([size, graph.const(_TINY)]))
    sizes = _with_least_share(places, equations.rows, sizes)
    return made(places, "scales", STATE, (("s", sizes),), "size of the terms of each constraint equation")


def _with_least_share(places: Places, rows: Sequence[Row], sizes: Sequence[Node]) -> list[Node]:
    """Return `sizes`, each at least a share of the largest of its unit if all terms of a row may vanish: the
    round-off of a point at the origin is no measure of its row."""
    # Rows of one unit are compared: a row all of whose terms may vanish has at least a share of the largest.
    graph, found = places.graph, list(sizes)
    moving = {*places.equations.q, *places.equations.v}
    largest: dict[str, Node] = {}
    for row, size in zip(rows, sizes):
        largest[row.unit] = graph.binary("max", largest[row.unit], size) if row.unit in largest else size
    for i, row in enumerate(rows):
        alone = largest[row.unit] is sizes[i]
        if not alone and all(moving & symbols([part]) for part in terms(graph, row.residual)):
            found[i] = graph.binary("max", sizes[i], _BESIDE * largest[row.unit])
    return found


def gamma_sizes(places: Places) -> Function:
    """Return the sum of the absolute terms of each row's gamma. If the gradient of the row vanishes, gamma is
    compared with it alone."""
    graph, speeds = places.graph, places.equations.v
    gammas = [row.gamma for row in places.equations.rows]
    slopes = gradient_magnitudes(graph, gammas, dict(zip(speeds, speeds)))
    sizes = [size + slope for size, slope in zip(magnitudes(graph, gammas), slopes)]
    described = "size of the terms of each row's gamma"
    return made(places, "gamma_sizes", STATE, (("s", sizes),), described, rare=True)


def gradient_sizes(places: Places) -> Function:
    """Return the sum of the absolute terms of each row's gradient. A gradient far below it is round-off."""
    graph, equations = places.graph, places.equations
    ones = dict.fromkeys(equations.v, graph.one)
    sizes = gradient_magnitudes(graph, [row.rate for row in equations.rows], ones)
    described = "size of the terms of each row's gradient"
    return made(places, "gradient_sizes", STATE, (("s", sizes),), described, rare=True)


def gradients(places: Places) -> Function:
    """Return the sum of the absolute values of the entries of each row's gradient, or an upper bound of
    it."""
    graph, rows = places.graph, places.equations.rows
    sums = gradient_bounds(graph, [row.rate for row in rows], dict.fromkeys(places.equations.v, graph.one))
    if sums is None:
        sums = [graph.sum(graph.unary("abs", a) for a in row.jacobian.values()) for row in rows]
    return made(places, "gradients", STATE, (("s", sums),), "size of each row's gradient", rare=True)


def reaches(places: Places) -> Function:
    """Return the change of each row if every coordinate (speed, for a velocity row) changes by the size c[k]
    of its scaling group or of the place that it is added to; then the same for the rates of holonomic rows
    and for their gradients; then these sizes."""
    graph, equations = places.graph, places.equations
    states = kinds(equations.q_units, equations.v_units)
    given = {k: graph.symbol("size", str(k)) for k in range(max(states) + 1)}
    holonomic = [row for row in equations.rows if row.holonomic]
    others = [row for row in equations.rows if not row.holonomic]
    # Each coordinate and speed moves by the size of its group, a displacement at least by that of the
    # place that it is added to.
    weights = {x: given[kind] for x, kind in zip((*equations.q, *equations.v), states)}
    displaced = _displacement_sizes(graph, holonomic, {x for x, k in zip(equations.q, states) if k})
    for x, place in displaced.items():
        weights[x] = graph.binary("max", weights[x], place)

    def of_slopes(slopes: Iterable[tuple[Node, Node]]) -> list[Node]:
        by_size: dict[Node, list[Node]] = {}
        for x, slope in slopes:
            by_size.setdefault(weights[x], []).append(graph.unary("abs", slope))
        return [graph.sum(found) * size for size, found in by_size.items()]

    def changes(rows: Sequence[Row], nodes: Sequence[Node], leaves: Sequence[Node]) -> list[list[Node]]:
        """Return how much each of `nodes`, of `rows`, changes as `leaves` do, as sums."""
        bounds = gradient_bounds(graph, nodes, {x: weights[x] for x in leaves})
        if bounds is not None:
            return [[bound] for bound in bounds]
        if leaves is equations.v:
            return [of_slopes((leaves[k], row.jacobian[k]) for k in sorted(row.jacobian)) for row in rows]
        found = (gradient(graph, {node: graph.one}, leaves) for node in nodes)
        return [of_slopes(slopes.items()) for slopes in found]

    def reach(sums: Sequence[Node], parts: Sequence[Node] = ()) -> Node:
        return graph.sum([*sums, *(graph.unary("abs", part) for part in parts), graph.const(_TINY)])

    # The rate of a holonomic row changes with the speeds, and with the coordinates at the pace at which
    # these change by their sizes.
    size = dict(given)
    for x, kind in zip(equations.q, states):
        if x in displaced:
            size[kind] = graph.binary("max", size[kind], weights[x])
    # A coordinate that is displaced from a place changes at least by the size of the place.
    pace = graph.zero  # at which the coordinates change by their sizes
    for kind, speed in rates(equations.q_units, equations.v_units).items():
        one = given[speed] if kind == 0 else given[speed] / (size[kind] + _TINY)
        pace = graph.binary("max", pace, one)
    # Holonomic rows by coordinates, others by speeds; then the rates of the holonomic ones by speeds, and by
    # coordinates at the pace of these.
    own = changes(holonomic, [row.residual for row in holonomic], equations.q)
    own += changes(others, [row.rate for row in others], equations.v)
    found = _with_least_share(places, equations.rows, [reach(sums) for sums in own])
    of_rates: list[Node] = []
    for row, sums in zip(holonomic, changes(holonomic, [row.rate for row in holonomic], equations.v)):
        parts = terms(graph, row.rate) if row.time_dependent else []
        parts += [part * pace for part in terms(graph, row.residual)]
        of_rates.append(reach(sums, parts))
    found += _with_least_share(places, holonomic, of_rates)
    found += (size[k] for k in sorted(size))
    more = replace(places, arrays={**places.arrays, **{node: ("c", k) for k, node in given.items()}})
    return made(more, "reaches", (*STATE, "c"), (("s", found),), "reach of each constraint equation")


def _displacement_sizes(graph: Graph, rows: Sequence[Row], coordinates: Container[Node]) -> dict[Node, Node]:
    """Return the sizes of the places from which coordinates are displaced in `rows`, as l in `z - l`. Such
    coordinates may begin at zero; the place gives their size."""
    # z - l: the place l, over the factor of z, is the size of z there. A factor may vanish: |f| / f^2 is 1 /
    # |f| without a branch.
    found: dict[Node, Node] = {}
    for node in _sums([row.residual for row in rows]):
        parts = [(part, _lever(part, coordinates)) for part in terms(graph, node)]
        place = graph.sum(graph.unary("abs", part) for part, lever in parts if lever is None)
        for x, factor in (lever for _, lever in parts if lever and not place.is_zero):
            size = place * graph.unary("abs", factor) / (factor * factor + _TINY)
            found[x] = graph.binary("max", found[x], size) if x in found else size
    return found


def _sums(nodes: Sequence[Node]) -> list[Node]:
    """Return the sums in `nodes`, without those whose only user is another sum."""
    below = reachable(nodes)
    users: dict[Node, list[Node]] = {}
    for node in below:
        for a in node.args:
            users.setdefault(a, []).append(node)
    return [x for x in below if x.op == "add" and [a.op for a in users.get(x, ())] != ["add"]]


def _lever(part: Node, coordinates: Container[Node]) -> tuple[Node, Node] | None:
    """Return the coordinate that a part of a sum is proportional to, and its factor of parameters. Sines and
    cosines count as 1."""
    factor, part = (part.value, part.args[0]) if part.op == "scale" else (1.0, part)
    graph = part.graph
    # The part is factor * x with factor made of parameters, and perhaps of sines.
    powers = dict(zip(part.args, part.value)) if part.op == "mul" else {part: 1}
    moved = [x for x, power in powers.items() if x in coordinates]
    if len(moved) != 1 or powers[moved[0]] != 1:
        return None
    lever = graph.const(factor)
    for x, power in powers.items():
        if x is not moved[0] and not (x.op in ("sin", "cos") and power > 0):
            if any(a.value.kind != "parameter" for a in symbols([x])):
                return None
            lever = lever * graph.power(x, power)
    return moved[0], lever


def energies(places: Places) -> Function:
    equations = places.equations
    e = [equations.kinetic, equations.potential, equations.energy]
    names = ["kinetic energy", "potential energy", "energy of the balance"]
    # sums over bodies, which have few factors in common
    return made(places, "energies", STATE, (("e", e),), "energies", names, rare=True, factors=False)


def power(places: Places) -> Function | None:
    equations = places.equations
    if equations.power.is_zero:
        return None
    pushes = symbols([equations.power]) & {contact.multiplier for contact in equations.contacts}
    inputs = (*places.state, "a", "lam", *(("contact_forces",) if pushes else ()))
    return made(places, "power", inputs, (("e", [equations.power]),), "rate of that energy", rare=True)


def outputs(places: Places) -> Function | None:
    found = [o.expression for o in places.equations.outputs]
    if not found:
        return None
    names = [o.name for o in places.equations.outputs]
    late = ("a", "lam", "contact_forces") if places.equations.contacts else ("a", "lam")
    inputs: tuple[str, ...] = (*STATE, *late)
    shared = _energies_in(places, found)
    if shared:
        known = {node: places.graph.symbol("shared", str(k)) for node, k in shared.items()}
        found, inputs = substitute(places.graph, found, known), (*STATE, "e", *late)
        arrays = {known[node]: ("e", k) for node, k in shared.items()}
        places = replace(places, arrays={**places.arrays, **arrays})
    return made(places, "outputs", inputs, (("y", found),), "outputs of the model", names, rare=True)


def _energies_in(places: Places, nodes: Sequence[Node]) -> dict[Node, int]:
    """Return the kinetic and potential energies with their places in `energies`, if `nodes` contain them and
    share little else with them."""
    equations = places.equations
    # Energies of the model are known to outputs that contain them, if little else is shared: else the common
    # parts would be computed twice.
    parts = {node: k for k, node in enumerate((equations.kinetic, equations.potential)) if node.args}
    if not parts.keys() <= set(reachable(nodes)):
        return {}
    made_of = reachable(parts)
    rest = set(reachable(substitute(places.graph, nodes, dict.fromkeys(parts, places.graph.zero))))
    again = [node for node in made_of if node.args and node in rest]
    return parts if 2 * len(again) < len(made_of) else {}


def start(places: Places, work: bool) -> Function:
    equations = places.equations
    x = [s.value for s in (*equations.starts_q, *equations.starts_v)]
    if work:
        x.append(places.graph.zero)
    x += [variable.start for variable in equations.model.discretes]
    names = equations.state_names
    return made(places, "start", ("p",), (("x", x),), "start values and guesses", names, rare=True)


def limits(places: Places) -> Function | None:
    """Return the function of the values made of parameters that have bounds."""
    found = [limit.value for limit in places.equations.model.limits]
    parts = (("b", found),)
    described = "derived values that have bounds"
    return made(places, "limits", ("p",), parts, described, rare=True) if found else None


def conditions(places: Places, slopes: Slopes) -> Function | None:
    """Return the initial equations c = 0: phi, psi, the `initial` section, and the stated rates (less their
    values, which are unknowns too); their derivatives that are not identically zero, `slopes` row by row and
    then those of sums; and the sum of the absolute terms of each row."""
    equations, graph = places.equations, places.graph
    rows = condition_rows(equations)
    if not rows:
        return None
    jacobian = [slope for row in (*slopes.rows, *slopes.sums) for slope in row.values()]
    sizes = [graph.sum([graph.unary("abs", part) for part in terms(graph, row)]) for row in rows]
    parts = (("c", rows), ("J", jacobian), ("sizes", sizes))
    return made(places, "conditions", STATE, parts, "conditions of a consistent start", rare=True)


def measures(places: Places) -> Function | None:
    """Return the values of the stated rates, and the largest parameter of each unit of a coordinate or speed
    (0 if there is none)."""
    equations, graph = places.equations, places.graph
    if not condition_rows(equations):
        return None
    largest: list[Node] = []
    for unit in start_units(equations):
        node = graph.zero
        for p in equations.model.parameters:
            if p.unit == unit and p.symbol in places.arrays:
                node = graph.binary("max", node, graph.unary("abs", p.symbol))
        largest.append(node)
    values = [s.start.value for s in equations.stated_rates]
    parts = (("s", values), ("largest", largest))
    return made(places, "measures", ("p",), parts, "stated rates, sizes of parameters", rare=True)


def made(
    places: Places,
    name: str,
    inputs: tuple[str, ...],
    outputs: tuple[tuple[str, Sequence[Node] | Sparse], ...],
    description: str,
    comments: Sequence[str] = (),
    rare: bool = False,
    factors: bool = True,
) -> Function:
    """Return the function. `comments` belong to the first entries of the first output; `rare`: no step calls
    it; for `factors` see `lower`."""

    def make(nodes: Sequence[Node]) -> list[Function]:
        block = Block()
        following = iter(lower(places, block, nodes, rare, factors)[1])
        for number, (array, indices) in enumerate(stored):
            for k in indices:
                comment = comments[k] if number == 0 and k < len(comments) else ""
                block.store(array, k, next(following), comment)
        return [block.function(name, inputs, lengths, description)]

    # Of a sparse output the function stores the entries, and sets all others to zero first.
    sparse = {array: part for array, part in outputs if isinstance(part, Sparse)}
    dense = {array: part for array, part in outputs if not isinstance(part, Sparse)}
    lengths = tuple([(a, sparse[a].length if a in sparse else len(dense[a])) for a, _ in outputs])
    stored = [(a, sparse[a].entries if a in sparse else range(len(dense[a]))) for a, _ in outputs]
    nodes = [node for a, _ in outputs for node in (sparse[a].entries.values() if a in sparse else dense[a])]
    (found,) = cheapest(places, nodes, make, rare)
    return replace(found, cleared=tuple(sparse))
