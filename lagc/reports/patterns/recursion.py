"""Equations of motion as recursions: shared parts of bodies are members of arrays, each made of earlier ones.

M a + h - tau - G^T lam is one reverse sweep over the velocities (virtual power), so the number of parts is
proportional to the model, and they repeat with it.
"""

from collections import Counter
from collections.abc import Hashable, Sequence
from fractions import Fraction

from lagc.base.records import dataclass
from lagc.mechanics.formulation.equations import EquationsOfMotion, triples
from lagc.reports.names import Name, Names
from lagc.reports.patterns.formula_trees import (
    Call,
    Form,
    Line,
    Numbers,
    Part,
    Series,
    Symbol,
    Term,
    Total,
    pattern,
)
from lagc.reports.patterns.index_rules import LEAST
from lagc.symbolic.derivative import gradient, seeds, tangent
from lagc.symbolic.graph import Node

_ROUNDS = 2  # parts of parts that are told apart


def residuals(equations: EquationsOfMotion) -> list[Node]:
    """M a + h - tau - G^T lam, a node a speed."""
    graph = equations.graph
    flat = [x for part in equations.inertias for x in part.velocity]
    rates = triples(tangent(graph, flat, dict(zip(equations.v, equations.a))))
    pairs = [
        pair
        for part, rate in zip(equations.inertias, rates)
        for pair in zip(part.velocity, part.momentum(rate))
    ]
    pairs += [(velocity, graph.scale(-1.0, load)) for velocity, load in equations.loads.items()]
    pairs += [(row.rate, graph.scale(-1.0, row.multiplier)) for row in equations.rows]
    weights = gradient(graph, seeds(graph, pairs), equations.v)
    found = [weights.get(v, graph.zero) for v in equations.v]
    for (i, j), node in sorted(equations.further_inertia.items()):
        for k, other in {(i, j), (j, i)}:
            found[k] = graph.add(found[k], graph.mul(node, equations.a[other]))
    return found


@dataclass(frozen=True, slots=True)
class Use:
    """A symbol with one index in a line."""

    node: Node
    index: int


@dataclass(frozen=True, slots=True)
class Member:
    """A line that may be a member of an array: its part of the model (None of an equation), its form without
    numbers and parts, its numbers, and its symbols."""

    node: Node | None
    shape: Hashable
    numbers: tuple[Fraction, ...]
    uses: list[Use]


@dataclass(frozen=True, slots=True)
class Array:
    members: list[Member]
    indices: list[int]


def arrays(parts: Sequence[Node], lines: Sequence[Line], others: Sequence[Line], letter: str) -> Names:
    """Return names for `parts`, which `lines` define, as members of arrays: equal forms, each with the index
    of its operands. `others` use them too."""
    members = [*map(_member, parts, lines), *[_member(None, line) for line in others]]
    at = _Arrays(members).at
    found: Names = {}
    numbers: dict[int | Node, int] = {}
    for node in parts:
        group, index = at.get(node, (node, 0))
        number = numbers.setdefault(group, len(numbers) + 1)
        name = f"{letter}{number}" if isinstance(group, Node) else f"{letter}{number}[{index}]"
        found[node] = Name(name, name)
    return found


class _Arrays:
    """`at`: array and index of parts; the others stand alone."""

    def __init__(self, members: Sequence[Member]) -> None:
        self.own = {member.node: member for member in members if member.node is not None}
        self.at: dict[Node, tuple[int, int]] = {}
        self.arrays = [self._aligned(k, group) for k, group in enumerate(_groups(members))]
        while any([self._joined(k) for k in range(len(self.arrays))]):
            pass

    def _aligned(self, number: int, members: list[Member]) -> Array:
        """The index of a member is that of something that it is made of, else its place."""
        found = list(range(1, len(members) + 1))
        # Indices of the model first, those of other arrays last: an array counts as the bodies do.
        columns = [list(column) for column in zip(*[member.uses for member in members])]
        for column in sorted(columns, key=lambda column: column[0].node in self.own):
            known = [self._index(use) for use in column]
            if None not in known and len(set(known)) == len(known):
                found = [k for k in known if k is not None]
                break
        for member, index in zip(members, found):
            if member.node is not None:
                self.at[member.node] = (number, index)
        return Array(members, found)

    def _index(self, use: Use) -> int | None:
        if use.node in self.own:
            return self.at[use.node][1] if use.node in self.at else None
        return use.index

    def _joined(self, number: int) -> bool:
        """Return whether single parts joined an array: they stand in a line of array `number` where most
        others have a member of it."""
        array, some = self.arrays[number], False
        for column in zip(*[member.uses for member in array.members]):
            steps = Counter(
                (self.at[use.node][0], self.at[use.node][1] - k)
                for use, k in zip(column, array.indices)
                if use.node in self.at
            )
            if steps:
                (other, step), times = steps.most_common(1)[0]
                if times >= LEAST:
                    for use, k in zip(column, list(array.indices)):
                        if use.node in self.own and use.node not in self.at:
                            some |= self._join(self.own[use.node], other, k + step)
        return some

    def _join(self, member: Member, number: int, index: int) -> bool:
        assert member.node is not None
        taken = {k for group, k in self.at.values() if group == number}
        if index in taken or index < 0:
            return False
        self.at[member.node] = (number, index)
        array = self.arrays[number]
        if array.members[0].shape == member.shape:
            array.members.append(member)
            array.indices.append(index)
        return True


def _groups(members: Sequence[Member]) -> list[list[Member]]:
    """Members that are alike, and made of parts that are."""
    keys: list[Hashable] = [member.shape for member in members]
    # Refine by the groups of the operands, as the states of an automaton are told apart (E. F. Moore,
    # 1956).
    for _ in range(_ROUNDS):
        group_of: dict[Node | None, int] = {}
        own: dict[int, int] = {}
        for number, group in enumerate(_by_key(keys)):
            if len(group) >= LEAST:
                group_of.update((members[k].node, number) for k in group)
                own.update((k, number) for k in group)
        keys = [
            (key, *_groups_of_operands(member, group_of, own.get(k)))
            for k, (key, member) in enumerate(zip(keys, members))
        ]
    found = []
    for group in _by_key(keys):
        apart = _by_key([members[k].numbers for k in group])
        if len(apart) * LEAST > len(group):
            apart = [list(range(len(group)))]  # their numbers follow a rule, or none
        found += [[members[group[k]] for k in part] for part in apart if len(part) >= LEAST]
    return found


def _groups_of_operands(
    member: Member, group_of: dict[Node | None, int], own: int | None
) -> list[int | None]:
    """The groups of what it is made of, but for its own: an array may begin with something else."""
    groups = [group_of.get(use.node) for use in member.uses]
    return [None if group == own else group for group in groups]


def _by_key(keys: Sequence[Hashable]) -> list[list[int]]:
    groups: dict[Hashable, list[int]] = {}
    for place, key in enumerate(keys):
        groups.setdefault(key, []).append(place)
    return list(groups.values())


def _member(node: Node | None, line: Line) -> Member:
    sides = [line.right] if node is not None else [line.left, line.right]
    numbers: Numbers = []
    shape = (node is None, line.kind, *[pattern(side, numbers) for side in sides])
    uses: list[Use] = []
    for side in sides:
        _collect(side, uses)
    sizes = tuple([x for x in numbers if not isinstance(x, int)])
    return Member(node, shape, sizes, uses)


def _collect(form: Form | Part, found: list[Use]) -> None:
    if isinstance(form, Symbol):
        if len(form.indices) == 1 and isinstance(form.indices[0], int):
            found.append(Use(form.node, form.indices[0]))
    elif not isinstance(form, Series):
        for x in operands(form):
            _collect(x, found)


def operands(form: Call | Total | Term) -> Sequence[Form | Part]:
    if isinstance(form, Call):
        return form.args
    return form.terms if isinstance(form, Total) else [factor for factor, _ in form.factors]
