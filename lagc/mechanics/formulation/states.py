"""States of the motion: q, v, a, how q moves, and the rates in terms of the speeds.

**Choice of speeds.** A declared speed u_k = A_k(t,q) . rates + b_k(t,q) replaces one rate; the other rates
stay speeds. The choice keeps the system solvable on a few states, and sparse. Small systems are solved by
Cramer's rule (a rotated pair of rates has the determinant cos^2 + sin^2 = 1 and needs no division), others by
elimination.
"""

from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property

from lagc.base.records import dataclass
from lagc.diagnostics.faults import Fault, Refused
from lagc.mechanics.formulation.equations import StartValue, StatedRate
from lagc.mechanics.identities.samples import samples
from lagc.semantics.model import UNSTATED, Coordinate, Model, Orientation, Speed, Statement
from lagc.symbolic.derivative import gradient, seeds
from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.operators import Interval
from lagc.symbolic.vectors import axis_rates
from lagc.symbolic.walk import depends, evaluate, substitute

_LARGEST_CRAMER = 4
_SMALL = 1e-9  # relative; a pivot that cancels is about 1e-16, one that does not about 1


@dataclass(frozen=True, slots=True)
class ChosenSpeeds:
    """`replaces[i]`: the declared speed in the place of rate i; `solved`: rate -> expression in v."""

    replaces: dict[int, Speed]
    solved: dict[Node, Node]


def choose_speeds(model: Model, rates: Sequence[Node]) -> ChosenSpeeds:
    """Solve the declared speeds for as many rates. Raises Refused: LAG0401 not affine in the rates, LAG0402
    dependent on each other, LAG0403 more speeds than rates."""
    declared = model.speeds
    if not declared:
        return ChosenSpeeds({}, {})
    # u = A rates + b: slopes by the rates must contain neither rates nor speeds.
    graph = model.graph
    if len(declared) > len(rates):
        raise Refused([_too_many(declared, len(rates))])
    table = [gradient(graph, {s.expression: graph.one}, rates) for s in declared]
    rows = [{i: row[rate] for i, rate in enumerate(rates) if rate in row} for row in table]
    faults = [
        _not_affine(speed)
        for speed, row in zip(declared, rows)
        if depends(row.values(), [*rates, *(s.symbol for s in declared)])
    ]
    if faults:
        raise Refused(faults)
    # b is the value at rest; the rates that stay speeds are known on the right-hand side.
    at_rest = dict.fromkeys(rates, graph.zero)
    offsets = substitute(graph, [s.expression for s in declared], at_rest)
    pivots = _pivots(model, rows)
    held = set(pivots)
    right: list[Node] = []
    for speed, row, offset in zip(declared, rows, offsets):
        rest = graph.sum(node * rates[i] for i, node in row.items() if i not in held)
        right.append(speed.symbol - offset - rest)
    solution = solve_rows(graph, rows, right, pivots)
    return ChosenSpeeds(
        {i: declared[k] for k, i in enumerate(pivots)}, {rates[i]: solution[i] for i in pivots}
    )


def _pivots(model: Model, rows: Sequence[Mapping[int, Node]]) -> list[int]:
    """Return the rate that each speed replaces: independent of the others on every sampled state, the
    simplest one first."""
    # Numerical elimination on four random states tells which choice stays solvable; the tables are reduced
    # along with each choice.
    flat = [node for row in rows for node in row.values()]
    tables: list[list[dict[int, float]]] = []
    for sample in samples(model, 4):
        values = iter(evaluate(flat, sample))
        tables.append([{i: next(values) for i in row} for row in rows])
    users = {i: sum(i in row for row in rows) for row in rows for i in row}
    pivots: list[int] = []
    for k, row in enumerate(rows):
        candidates = [
            i
            for i in set().union(*(table[k] for table in tables))
            if i not in pivots and all(_is_pivot(table[k], i) for table in tables)
        ]
        if not candidates:
            raise Refused([_dependent(model.speeds[k], model.speeds[:k])])
        # A constant coefficient before others, then a rate that few speeds use, then the first.
        best = min(candidates, key=lambda i: (not _constant(row.get(i)), users.get(i, 0), i))
        pivots.append(best)
        for table in tables:
            _eliminate(table, k, best)
    return pivots


def _is_pivot(row: Mapping[int, float], i: int) -> bool:
    largest = max((abs(x) for x in row.values()), default=0.0)
    return i in row and abs(row[i]) > _SMALL * largest and abs(row[i]) > 0.0


def _constant(node: Node | None) -> bool:
    return node is not None and node.is_const


def _eliminate(table: list[dict[int, float]], k: int, pivot: int) -> None:
    for row in table[k + 1 :]:
        if pivot in row:
            size = max(abs(x) for x in row.values())
            # Entries that cancel are removed, so that structure does not see round-off.
            factor = row[pivot] / table[k][pivot]
            for i, x in table[k].items():
                row[i] = row.get(i, 0.0) - factor * x
            for i in [i for i, x in row.items() if i == pivot or abs(x) <= _SMALL * size]:
                del row[i]


def solve_rows(
    graph: Graph, rows: Sequence[Mapping[int, Node]], right: Sequence[Node], pivots: Sequence[int]
) -> dict[int, Node]:
    """Solve rows x = right for the unknowns `pivots` (row k for pivots[k] after the rows before), ignoring
    other entries, block by block of rows that share none."""
    solution: dict[int, Node] = {}
    # Blocks of rows that share unknowns are solved apart.
    for block in _blocks(rows, pivots):
        columns = [pivots[k] for k in block]
        matrix = [[rows[k].get(i, graph.zero) for i in columns] for k in block]
        wanted = [right[k] for k in block]
        method = _cramer if len(block) <= _LARGEST_CRAMER else _gauss
        solution.update(zip(columns, method(graph, matrix, wanted)))
    return solution


def _blocks(rows: Sequence[Mapping[int, Node]], pivots: Sequence[int]) -> list[list[int]]:
    # Union of rows that use a column of each other.
    owner = {i: k for k, i in enumerate(pivots)}
    group = list(range(len(rows)))
    for k, row in enumerate(rows):
        for i in row:
            if i in owner and group[owner[i]] != group[k]:
                old, new = group[owner[i]], group[k]
                group = [new if g == old else g for g in group]
    return [[k for k in range(len(rows)) if group[k] == g] for g in sorted(set(group))]


def _cramer(graph: Graph, matrix: list[list[Node]], right: list[Node]) -> list[Node]:
    size = len(right)
    # x_j = sum of cofactor_ij r_i / det. Divided term by term: common factors cancel in the graph.
    whole = determinant(graph, matrix)
    found: list[Node] = []
    for j in range(size):
        cofactors = [
            graph.scale((-1.0) ** (i + j), determinant(graph, _minor(matrix, i, j))) for i in range(size)
        ]
        found.append(graph.sum(graph.div(c, whole) * r for c, r in zip(cofactors, right)))
    return found


def determinant(graph: Graph, matrix: list[list[Node]]) -> Node:
    """Return the determinant, by expansion along the first row; for sizes up to 4."""
    if not matrix:
        return graph.one
    return graph.sum(
        graph.scale((-1.0) ** j, x * determinant(graph, _minor(matrix, 0, j)))
        for j, x in enumerate(matrix[0])
        if not x.is_zero
    )


def _minor(matrix: list[list[Node]], i: int, j: int) -> list[list[Node]]:
    return [row[:j] + row[j + 1 :] for k, row in enumerate(matrix) if k != i]


def _gauss(graph: Graph, matrix: list[list[Node]], right: list[Node]) -> list[Node]:
    """Solve by elimination along the diagonal, which `_pivots` has found to be free of zeros."""
    size = len(right)
    for k in range(size):
        for i in range(k + 1, size):
            if not matrix[i][k].is_zero:
                factor = matrix[i][k] / matrix[k][k]
                matrix[i] = [x - factor * y for x, y in zip(matrix[i], matrix[k])]
                right[i] = right[i] - factor * right[k]
    found = [graph.zero] * size
    for k in reversed(range(size)):
        known = graph.sum(matrix[k][j] * found[j] for j in range(k + 1, size))
        found[k] = (right[k] - known) / matrix[k][k]
    return found


def _names(speeds: Iterable[Speed]) -> str:
    return ", ".join(f"`{s.name}`" for s in speeds)


def _too_many(declared: Sequence[Speed], count: int) -> Fault:
    rates = f"{count} rate{'' if count == 1 else 's'}"
    return Fault(
        "LAG0403",
        f"{len(declared)} speeds are declared, but the coordinates have only {rates}",
        declared[count].span,
        remedy=f"remove {len(declared) - count} of {_names(declared)}",
    )


def _not_affine(speed: Speed) -> Fault:
    return Fault(
        "LAG0401",
        f"the speed `{speed.name}` is not linear in the rates of the coordinates",
        speed.span,
        remedy="write it as a sum of rates, each multiplied by something free of rates and speeds",
    )


def _dependent(speed: Speed, before: Sequence[Speed]) -> Fault:
    reason = f"follows from {_names(before)}" if before else "depends on no rate of a coordinate"
    return Fault(
        "LAG0402",
        f"the speed `{speed.name}` {reason}, so the rates cannot be found from the speeds",
        speed.span,
        tuple((s.span, "this speed") for s in before),
        remedy=f"remove `{speed.name}` or make it another combination of the rates",
    )


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
        """Random states: near the start, farther and far away."""
        from lagc.mechanics.identities.samples import samples  # for what is asked of some models only

        return tuple([x for spread in (0.3, 3.0, 30.0) for x in samples(self.model, 3, spread=spread)])

    @cached_property
    def bounds(self) -> dict[Node, Interval]:
        return {p.symbol: (p.minimum, p.maximum) for p in self.model.parameters}

    @cached_property
    def zero_rates(self) -> dict[Node, Node]:
        """Every rate and declared speed -> 0, for expressions that still contain rates."""
        # A speed may be declared by speeds before it, so each is replaced in turn.
        zeros: dict[Node, Node] = dict.fromkeys(self.rates, self.graph.zero)
        for speed in self.model.speeds:
            zeros[speed.symbol] = substitute(self.graph, [speed.expression], zeros)[0]
        return zeros

    @cached_property
    def spelt(self) -> dict[Node, Node]:
        """Every declared speed -> its expression in rates."""
        found: dict[Node, Node] = {}
        for speed in self.model.speeds:
            found[speed.symbol] = substitute(self.graph, [speed.expression], found)[0]
        return found

    def in_rates(self, nodes: Sequence[Node]) -> list[Node]:
        """Return `nodes` with declared speeds replaced by their expressions in rates."""
        return list(nodes) if self.plain else substitute(self.graph, nodes, self.spelt)

    def in_speeds(self, nodes: Sequence[Node]) -> list[Node]:
        """Return `nodes` with rates replaced by their expressions in v."""
        return list(nodes) if self.plain else substitute(self.graph, nodes, self.rates)

    def at_rest(self, nodes: Sequence[Node]) -> list[Node]:
        """Return `nodes` (in rates) with every rate zero: the part that drives impose."""
        return substitute(self.graph, nodes, self.zero_rates)

    def to_speeds(self, weights: dict[Node, Node]) -> dict[int, Node]:
        """Return the generalized forces on v of the virtual power sum of weights[x] * x, with x affine in
        v."""
        found = gradient(self.graph, weights, self.place_of_v)
        return {self.place_of_v[v]: node for v, node in found.items()}

    def force_of(self, slopes: dict[Node, Node]) -> dict[int, Node]:
        """Return the generalized forces on v of the forces slopes[q_i] on the q_i: N^T slopes."""
        pairs = [(self.qdot[self.place_of_q[q]], slope) for q, slope in slopes.items()]
        return self.to_speeds(seeds(self.graph, pairs))


def build_states(model: Model) -> States:
    """Lay out q and v in the order of declaration.  Raises Refused as `choose_speeds` does."""
    graph = model.graph
    rates_in_order = [r for c in model.coordinates for r in rate_symbols(c)]
    chosen = choose_speeds(model, rates_in_order)
    # The speed in the place of each rate: the rate itself, or a declared speed.
    v: list[Node] = []
    v_units: list[str] = []
    units = [u for c in model.coordinates for u in _rate_units(c)]
    for i, rate in enumerate(rates_in_order):
        speed = chosen.replaces.get(i)
        v.append(rate if speed is None else speed.symbol)
        v_units.append(units[i] if speed is None else speed.unit)
    rates = {r: chosen.solved.get(r, r) for r in rates_in_order}
    # How the coordinates move: q' is a rate, or for a quaternion e' = 1/2 e*(0, w).
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
    """Return q' = 1/2 q * (0, w) with w in body axes."""
    # Hamilton product; the first component is the scalar.
    ew, ex, ey, ez = e
    return [
        -0.5 * (ex * w[0] + ey * w[1] + ez * w[2]),
        0.5 * (ew * w[0] + ey * w[2] - ez * w[1]),
        0.5 * (ew * w[1] + ez * w[0] - ex * w[2]),
        0.5 * (ew * w[2] + ex * w[1] - ey * w[0]),
    ]


def position_symbols(c: Coordinate | Orientation) -> tuple[Node, ...]:
    """Return the coordinates q of `c`."""
    return (c.symbol,) if isinstance(c, Coordinate) else c.symbols


def rate_symbols(c: Coordinate | Orientation) -> tuple[Node, ...]:
    """Return the rates of `c`."""
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
    """Return the start of each speed: that of its rate; of a declared speed its own, or the value that the
    starts of its rates give at t = 0."""
    # Values at the start, in the order in which they build on each other: positions, rates, then declared
    # speeds.
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
    """Return the stated rates among `order`, which have these `units`, that are not speeds."""
    starts, speeds = _rate_starts(model), set(v)
    return [
        StatedRate(rate, unit, rates[rate], starts[rate])
        for rate, unit in zip(order, units)
        if rate not in speeds and starts[rate].stated.level != UNSTATED
    ]
