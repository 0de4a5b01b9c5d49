"""Rows that touch zero and do not cross it: `x^2 = 0`, `norm(a - b) = 0`, `x^2*y = 0` where x = 0.

The gradient of such a row vanishes wherever the row holds, or on one of its branches, so no multiplier
can enforce it there, and what it restricts is more than one row says.  Sums of squares and roots of one
sign, and products with repeated factors, are seen as such.  Others are found by Newton's method: towards
a simple zero its steps shrink faster and faster, towards one of multiplicity m each is 1 - 1/m of that
before.  A norm has half the multiplicity of what is below its root, so it is asked of that.  A multiple
zero all around which there are such is a branch of them; one beside simple zeros is a cusp or a crossing.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence

from lagc.base.records import dataclass
from lagc.diagnostics.faults import Fault, Refused
from lagc.mechanics.formulation.constraints import Classified
from lagc.mechanics.formulation.equations import Row
from lagc.mechanics.formulation.states import States
from lagc.mechanics.identities.constraint_manifold import onto, scales
from lagc.mechanics.lint.constraint_remedies import held
from lagc.mechanics.lint.sections import Section, Sections
from lagc.mechanics.numeric.cancellation import magnitudes
from lagc.mechanics.numeric.samples import Chance, samples
from lagc.mechanics.redundancy.redundancy import dependent_rows
from lagc.symbolic.derivative import gradient, tangent
from lagc.symbolic.evaluate import evaluate
from lagc.symbolic.graph import Node
from lagc.symbolic.text import brief
from lagc.symbolic.walk import depends, reachable, symbols

_STATES = 3
_STEPS = 200
_LAST = 6  # steps by which a zero is judged
_SLOW = 0.3  # ratio of these, on average, towards a multiple zero at least
_ARRIVED = 1e-14  # of the coordinates: a step that is rounding
_FLAT = 1e-3  # of the steepest gradient on the way
_HOLDS = 1e-7  # of its terms, on a state that meets other rows to 1e-12
_FOUND = 1e-6  # of the residual at first
_NOISE = 1e-6  # of the coordinates: steps that grow and are shorter are rounding
_BESIDE = 1e-2  # of the sizes of the unknowns: how far around a multiple zero others are looked for
_APART = 1e-4  # of these sizes
_PAIRS = 3

State = Mapping[Node, float]
Slopes = Mapping[Node, Node]


@dataclass(frozen=True, slots=True)
class _Suspect:
    """A row, and where its gradient vanishes, as far as that is known."""

    found: Classified
    everywhere: bool = False
    factor: Node | None = None  # where this is zero


def refuse_touching(states: States, classified: Sequence[Classified]) -> None:
    """Raises Refused: LAG0413 rows whose gradient vanishes wherever they hold, or on a branch of them,
    and that others do not bring about."""
    model = states.model
    tries = [*samples(model, _STATES, vary=False), *samples(model, _STATES)]
    start = list(samples(model, 1, vary=False, spread=0.0))
    asked = [x for x in classified if x.row.holonomic or not x.row.linear]
    given, carried, sizes = {p.symbol for p in model.parameters}, _carried(states), scales(states)
    sections = Sections(states, [x.row for x in asked], start[0], carried) if start else None
    residuals = [x.row.residual for x in asked]
    moving = depends(residuals, symbols(residuals) - given)
    suspects: list[_Suspect] = []
    for x in asked:
        search = _Search(states, not x.row.holonomic, sizes, carried, given, moving)
        section = sections.of(x.row, tries[:_STATES]) if sections else None
        suspects += _suspect(x, search, section, start, tries)
    if not suspects:
        return
    seen = [s.found for s in suspects]
    rows = [x.row for x in classified if x not in seen]
    spare = {r.row for r in dependent_rows(states, rows)}
    met = map(onto(states, [row for k, row in enumerate(rows) if k not in spare]), tries)
    on_others = [s for s in met if s is not None]
    faults = [_fault(s) for s in suspects if not _follows(s.found.row, on_others)]
    if faults:
        raise Refused(faults)


def _follows(row: Row, met: Sequence[State]) -> bool:
    """Whether it holds on states that meet the other rows: then nothing has to enforce it."""
    found = [magnitudes([row.residual], state)[0] for state in met]
    return bool(found) and all(abs(value) <= _HOLDS * size for value, size in found)


def _suspect(
    x: Classified, search: _Search, section: Section | None, start: Sequence[State], tries: Sequence[State]
) -> list[_Suspect]:
    """The row, or nothing."""
    states = search.states
    moving, repeated = _factors(x.row.residual, search.moves)
    vanishing = [f for f in repeated if _touches(f, search.moves) or search.finds(f, tries)]
    if vanishing:
        regular = any(search.finds(f, tries) for f in moving if f not in repeated)
        return [_Suspect(x, factor=vanishing[0]) if regular else _Suspect(x, everywhere=True)]
    if section is not None and search.is_plain(section):
        return []
    slopes = {states.v[j]: node for j, node in x.row.jacobian.items()}
    node = x.row.residual
    beside = any(_is_branch(search, node, slopes, z, tries) for z in search.zeros(node, slopes, start))
    return [_Suspect(x)] if beside or search.all_multiple(node, slopes, tries) else []


def _is_branch(search: _Search, node: Node, slopes: Slopes, zero: _Zero, tries: Sequence[State]) -> bool:
    """Whether it is multiple, with other parameters too, and zeros all around are and are others than
    this one, where there is room for others: from afar a small circle is a point."""
    given = [x for x in zero.state if x in search.given]
    turned = [{**zero.state, **{p: other[p] for p in given}} for other in tries]
    if not zero.multiple or not any(z.multiple for z in search.zeros(node, slopes, turned[_STATES:])):
        return False
    sizes, chance = search.sizes, Chance(911)
    moving = [x for x in search.moving(slopes) if x in symbols([node])]
    beside = []
    for _ in range(_PAIRS):
        step = {x: _BESIDE * sizes[x] * chance.draw() for x in moving}
        for sign in (1.0, -1.0):
            beside.append({**zero.state, **{x: zero.state[x] + sign * d for x, d in step.items()}})
    found = list(search.zeros(node, slopes, beside))
    apart = any(abs(z.state[x] - zero.state[x]) > _APART * sizes[x] for z in found for x in moving)
    every = len(found) == len(beside) and all(z.multiple for z in found)
    return every and (apart or len(moving) == 1)


@dataclass(frozen=True, slots=True)
class _Zero:
    state: State
    multiple: bool


@dataclass(frozen=True, slots=True)
class _Search:
    """Newton's method in the positions, or in the speeds of a velocity row, each over its size; `carried`
    are the coordinates that each speed moves, `given` the parameters, `moves` what is made of more."""

    states: States
    velocity: bool
    sizes: Mapping[Node, float]
    carried: Mapping[Node, Mapping[Node, Node]]
    given: set[Node]
    moves: set[Node]

    def moving(self, slopes: Slopes) -> list[Node]:
        """The unknowns of a row with such slopes."""
        if self.velocity:
            return list(slopes)
        return list(dict.fromkeys(q for v in slopes for q in self.carried.get(v, ())))

    def is_plain(self, section: Section) -> bool:
        """Whether a zero next to its states is found, and is no multiple one."""
        zero = next(self.zeros(section.node, section.slopes, section.states), None)
        return zero is not None and not zero.multiple

    def finds(self, node: Node, tries: Sequence[State]) -> bool:
        """Whether `node` is zero anywhere near the states."""
        states = self.states
        rate = node if self.velocity else tangent(states.graph, [node], states.drift)[0]
        slopes = gradient(states.graph, {rate: states.graph.one}, states.place_of_v)
        return any(True for _ in self.zeros(node, slopes, tries))

    def all_multiple(self, node: Node, slopes: Slopes, tries: Sequence[State]) -> bool:
        """Whether the zeros next to the states are multiple ones; one that is not settles it."""
        found = False
        for zero in self.zeros(node, slopes, tries):
            if not zero.multiple:
                return False
            found = True
        return found

    def zeros(self, node: Node, slopes: Slopes, tries: Sequence[State]) -> Iterator[_Zero]:
        """Those that are found; `slopes` are the derivatives of the rate of `node` by speeds."""
        rates = {q: rate for v in slopes for q, rate in self.carried.get(v, {}).items()}
        below = reachable([node, *slopes.values()])
        found = (self._zero(node, slopes, rates, below, state) for state in tries)
        return (zero for zero in found if zero is not None)

    def _zero(
        self, node: Node, slopes: Slopes, rates: Slopes, below: Sequence[Node], sample: State
    ) -> _Zero | None:
        """`below` is all that `node` and `slopes` are made of."""
        moving = self.moving(slopes)
        needed = {x for x in below if x.op == "symbol"} | symbols(rates.values()) | set(moving)
        state = {x: sample[x] for x in needed}
        rooted = _bare(node).op == "sqrt"
        lengths: list[float] = []
        steepness: list[float] = []
        values: list[float] = []
        for _ in range(_STEPS):
            value, *gradients = evaluate([node, *slopes.values()], state, below)
            values.append(abs(value))
            slope = {v: g * self.sizes[v] for v, g in zip(slopes, gradients)}
            steep = math.hypot(*slope.values())
            if value == 0.0 or not 0.0 < steep < math.inf:
                break
            steepness.append(steep * (abs(value) if rooted else 1.0))
            length = (0.5 if rooted else 1.0) * value / steep
            step = {v: -length * (a / steep) * self.sizes[v] for v, a in slope.items()}
            change = step if self.velocity else self._displacement(rates, state, step)
            state.update((x, state[x] + d) for x, d in change.items())
            lengths.append(math.hypot(*(d / self.sizes[x] for x, d in change.items())))
            reach = max(abs(state[x]) / self.sizes[x] for x in moving)
            if lengths[-1] <= _ARRIVED * reach:
                break
            if len(lengths) > 2 and lengths[-2] < lengths[-1] < _NOISE * reach:
                del lengths[-2:]
                break
        else:
            return None
        if not values[-1] <= _FOUND * values[0]:
            return None
        slow = len(lengths) > _LAST and lengths[-1] > _SLOW**_LAST * lengths[-1 - _LAST]
        multiple = slow and lengths[-1] > _SLOW * lengths[-2] and steepness[-1] < _FLAT * max(steepness)
        return _Zero(state, multiple)

    def _displacement(self, rates: Slopes, state: State, step: Mapping[Node, float]) -> dict[Node, float]:
        """What a step of the speeds changes the coordinates with such `rates` by."""
        still = {x: 0.0 if x in self.carried else value for x, value in state.items()}
        nodes = list(rates.values())
        drift, moved = evaluate(nodes, still), evaluate(nodes, {**still, **step})
        return {q: b - a for q, a, b in zip(rates, drift, moved)}


def _bare(node: Node) -> Node:
    return node.args[0] if node.op == "scale" else node


def _factors(node: Node, moves: set[Node]) -> tuple[list[Node], list[Node]]:
    """The factors of a row that move, and those of them on whose zeros its gradient vanishes."""
    node = _bare(node)
    powers = list(zip(node.args, node.value)) if node.op == "mul" else [(node, 1)]
    moving = [(base, e) for base, e in powers if e > 0 and base in moves]
    return [b for b, _ in moving], [b for b, e in moving if e > 1 or _touches(b, moves)]


def _touches(node: Node, moves: set[Node]) -> bool:
    """Whether it is a sum of terms of one sign, each of which is zero with its gradient, or without one."""
    pending, signs = [node], set[bool]()
    while pending:
        term = pending.pop()
        if term.op == "add":
            pending.extend(term.args)
        elif _is_square(_bare(term), moves):
            signs.add(term.op == "scale" and term.value < 0.0)
        else:
            return False
    return len(signs) == 1


def _is_square(term: Node, moves: set[Node]) -> bool:
    """Whether a term is nowhere negative, as a product of even powers and roots, and moves."""
    if term.op == "sqrt":
        return _touches(term.args[0], moves)
    if term.op != "mul":
        return False
    for base, exponent in zip(term.args, term.value):
        if exponent % 2 and not (base.op == "sqrt" and exponent > 0):
            return False
        if exponent < 0 and base in moves:
            return False
    return term in moves


def _carried(states: States) -> dict[Node, dict[Node, Node]]:
    """By speed, the coordinates that it moves, each with its rate."""
    found: dict[Node, dict[Node, Node]] = {v: {} for v in states.v}
    for q, rate in zip(states.q, states.qdot):
        for v in symbols([rate]) & found.keys():
            found[v][q] = rate
    return found


def _fault(s: _Suspect) -> Fault:
    x = s.found
    if s.factor is not None:
        where = f"where `{brief(s.factor)}` is zero, which is one way to meet it, so that no force can "
        where += "enforce it there"
    elif s.everywhere:
        where = "wherever the constraint holds, so that no force can enforce it"
    else:
        where = "on states where the constraint holds, so that no force can enforce it there"
    return Fault(
        "LAG0413",
        f"the gradient of the constraint `{x.row.label}` vanishes {where}",
        x.constraint.span,
        remedy=_remedy(s),
    )


def _remedy(s: _Suspect) -> str:
    if s.factor is not None:
        return (
            "write the factor that is meant to vanish, as a row of its own and to the first power: "
            "`y = 0` or `x = 0` in place of `x^2*y = 0`"
        )
    c = s.found.constraint
    rows = held(c.left, c.right) if len(c.residuals) == 1 else None
    if rows:
        return f"write {_listed(rows)}{', each as a row of its own' if len(rows) > 1 else ''}"
    return (
        "write what has to vanish itself, each part as a row of its own: `a = b` in place of "
        "`norm(a - b) = 0`, `x = 0` in place of `x^2 = 0`"
    )


def _listed(rows: Sequence[str]) -> str:
    *first, last = [f"`{row}`" for row in rows]
    return f"{', '.join(first)} and {last}" if first else last
