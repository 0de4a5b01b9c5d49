"""The order of elimination of the matrix of the equations (see `articulated_body`), and its cost.

Unknown n + c of [A G^T; G 0] (a, -lam) = (r, gamma) is minus the multiplier of row c, so that the matrix is
symmetric. There are two steps:

* *pivot*: a speed; a multiplier after all speeds of its row (its pivot is then -G M^-1 G^T < 0); a massless
  speed after the multipliers of its rows: L D L^T;
* *substitution*: a shared velocity w_k = sum of c_u u that no other definition uses. Together with the
  multiplier of its definition it has the pivot [[A_kk, -1], [-1, 0]], which needs no division.

Unknowns that move few bodies come first, from the leaves of a tree to its root; then the cheapest.

With many loops, as in a ladder, each substitution couples all outer loops. The shared velocity of a body may
then be *kept*: its mass is its pivot, its definition is a row, the multiplier of that row is the force in the
joint, and the graph of the bodies remains.

G. Golub, C. Van Loan, *Matrix Computations*, 4.1; R. Vanderbei, *Symmetric quasidefinite matrices*, SIAM J.
Optim. 5 (1995), for the signs of the pivots.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from heapq import heapify, heappop, heappush
from math import inf

from lagc.base.records import dataclass, field

Entry = tuple[int, int]  # row, column; row >= column


def entry(i: int, j: int) -> Entry:
    return (i, j) if i >= j else (j, i)


@dataclass(frozen=True)
class Structure:
    """The nonzero entries. The unknowns are speeds, multipliers, shared velocities, and multipliers of kept
    definitions, in this order."""

    speeds: int
    multipliers: int
    entries: tuple[Entry, ...]
    definitions: Mapping[int, tuple[int, ...]] = field(default_factory=dict)  # of lifted velocities
    influence: Mapping[int, int] = field(default_factory=dict)  # bodies that move with an unknown
    kept: tuple[int, ...] = ()  # lifted velocities that are not substituted

    @property
    def size(self) -> int:
        """The length of a right-hand side."""
        return self.speeds + self.multipliers

    @property
    def moving(self) -> int:
        """The number of speeds, multipliers and shared velocities."""
        return self.size + len(self.definitions)

    @property
    def unknowns(self) -> int:
        return self.moving + len(self.kept)

    def is_row(self, k: int) -> bool:
        return self.speeds <= k < self.size or k >= self.moving

    @property
    def ties(self) -> Iterator[tuple[int, int]]:
        """Yield each velocity that is kept, with the multiplier of its definition."""
        return zip(self.kept, range(self.moving, self.unknowns))


@dataclass(frozen=True, slots=True)
class Step:
    """A step of the elimination: the unknown, its neighbours at that step, and those in its definition (none
    for a pivot)."""

    unknown: int
    near: tuple[int, ...]
    definition: tuple[int, ...]
    massive: bool  # it has an entry on the diagonal

    @property
    def flops(self) -> int:
        """Operations of its part in the factorisation and in one solve, about."""
        d, c = len(self.near), len(self.definition)
        # A substitution: c d products into the neighbours, c (c + 1) / 2 pairs within the definition, each a
        # product or two and a sum, and c for the right-hand side twice.
        if c:
            return 2 * c * d + 3 * c * (c + 1) // 2 + (2 * c if self.massive else 0) + 4 * c
        # A pivot: d (d + 1) / 2 products and sums for the rest of the matrix, d products for L, and 4 d for a
        # solve.
        return d * (d + 1) + 5 * d + 2


@dataclass(frozen=True)
class Elimination:
    """The part of the factorization that is known at compile time."""

    structure: Structure
    steps: tuple[Step, ...]

    @property
    def speeds(self) -> int:
        return self.structure.speeds

    @property
    def multipliers(self) -> int:
        return self.structure.multipliers

    @property
    def size(self) -> int:
        return self.structure.size

    @property
    def flops(self) -> int:
        """Operations of the factorisation and one solve, about."""
        return sum([step.flops for step in self.steps])

    @property
    def pivots(self) -> tuple[Step, ...]:
        return tuple([step for step in self.steps if not step.definition])

    @property
    def lower(self) -> tuple[Entry, ...]:
        """The entries of L below its unit diagonal, (row, column) as unknowns."""
        return tuple([(i, step.unknown) for step in self.pivots for i in step.near])


def eliminate(structure: Structure, most: float = inf) -> Elimination | None:
    """Choose the order. None if no order without pivoting exists (a massless speed that no constraint
    determines, a row without speeds) or if it takes more than `most` operations."""
    search = _Search(structure)
    steps = tuple(search.steps(most))
    return Elimination(structure, steps) if len(steps) == structure.unknowns else None


class _Search:
    """The search of an order: the structure of the matrix that remains after the steps so far."""

    def __init__(self, structure: Structure):
        self.structure = structure
        count = structure.unknowns
        # The graph of the matrix: a pivot makes a clique of its neighbours.
        self.near: list[set[int]] = [set() for _ in range(count)]
        self.massive = [False] * count
        for i, j in structure.entries:
            if i == j:
                self.massive[i] = True
            else:
                self.near[i].add(j)
                self.near[j].add(i)
        # An unknown waits until all of a definition, or all that a row needs, is eliminated.
        self.frees = _frees(structure, self.near, self.massive)
        self.definitions = dict(structure.definitions)
        for k, row in structure.ties:
            self._tie(row, {k, *self.definitions.pop(k)})
        self.waits = [0] * count  # for how many that have to go before
        for unknowns in self.frees.values():
            for u in unknowns:
                self.waits[u] += 1
        self.gone = [False] * count

    def steps(self, most: float) -> Sequence[Step]:
        """Return the steps that the first `most` operations are enough for."""
        found: list[Step] = []
        # Minimum degree with a lazy heap: ranks change with each step, so an unknown may stand in the heap
        # more than once. Only the entry with its present rank counts (J. A. George, J. W. H. Liu, SIAM Rev.
        # 31 (1989) 1-19).
        heap = [rank for k in range(len(self.near)) if (rank := self._rank(k)) is not None]
        heapify(heap)
        while heap:
            rank = heappop(heap)
            k = -rank[-1]
            if rank != self._rank(k):
                continue  # it has another by now, or is gone
            step = Step(k, tuple(sorted(self.near[k])), self.definitions.pop(k, ()), self.massive[k])
            most -= step.flops
            if most < 0:
                break
            found.append(step)
            self.gone[k] = True
            for j in self._without(step):
                new = self._rank(j)
                if new is not None:
                    heappush(heap, new)
        return found

    def _rank(self, k: int) -> tuple[int, int, int] | None:
        """Return the rank of unknown k, the lowest is eliminated next; None if it cannot be eliminated
        now."""
        if self.gone[k] or self.waits[k]:
            return None
        # A row may be a pivot only after the speeds that it holds: then its pivot is -G M^-1 G^T, of definite
        # sign (R. Vanderbei 1995).
        near, structure = self.near[k], self.structure
        if structure.is_row(k):
            holds = self._is_defined if k >= structure.moving else self._holds
            if not self.massive[k] or any(not structure.is_row(j) and holds(j) for j in near):
                return None
            return 1 if structure.kept else 0, len(near) * (len(near) + 1) // 2, -k
        # A speed that is plain: by the number of its neighbours' pairs, the fill it may make.
        definition = self.definitions.get(k)
        if definition is None:
            return (1, len(near) * (len(near) + 1) // 2, -k) if self.massive[k] else None
        # A shared velocity waits for neighbours that move fewer bodies: from the leaves of a tree to its
        # root.
        influence = structure.influence
        for j in near:  # from the leaves to the root
            if not structure.is_row(j) and influence[j] < influence[k] and self._goes_before(j):
                return None
        c = len(definition)
        return 1, c * (c + 1) // 2 + c * len(near), -k

    def _holds(self, j: int) -> bool:
        """Return whether a row waits for j. It does not wait for speeds that only rows can give a pivot."""
        return j in self.definitions or self.waits[j] > 0 or self.massive[j]

    def _is_defined(self, j: int) -> bool:
        """Return whether the definition of a kept velocity waits for j. Its speeds have their pivots from
        it."""
        return j >= self.structure.size

    def _goes_before(self, j: int) -> bool:
        return j in self.definitions or (self.waits[j] == 0 and self.massive[j])

    def _without(self, step: Step) -> set[int]:
        """Remove the unknown of a step from the graph; return the unknowns whose rank may change."""
        # Neighbours of a pivot become a clique. A substitution couples those in the definition to the
        # neighbours of k, and among themselves if k has a mass.
        k, near, freed = step.unknown, step.near, self.frees.get(step.unknown, ())
        changed = {*near, *step.definition}
        for j in near:
            self.near[j].discard(k)
        for u in freed:
            self.waits[u] -= 1
        if step.definition:
            filled = set(near)
            if step.massive:
                filled |= changed
            for u in step.definition:
                self._tie(u, filled)
                if u in near:
                    self._tie(u, set(step.definition))
        else:
            for i in near:
                self._tie(i, changed)
        # Rows next to what has changed may be ready now.
        rows = {i for j in changed if not self.structure.is_row(j) for i in self.near[j]}
        return {*changed, *freed} | {i for i in rows if self.structure.is_row(i)}

    def _tie(self, u: int, others: set[int]) -> None:
        for j in others:
            if j == u:
                self.massive[u] = True
            else:
                self.near[u].add(j)
                self.near[j].add(u)


def _frees(
    structure: Structure, near: Sequence[set[int]], massive: Sequence[bool]
) -> dict[int, tuple[int, ...]]:
    """Return the unknowns that wait for each unknown, besides its neighbours.

    A velocity waits for the definitions that use it, unless these are rows. A constraint on a kept velocity
    waits for the massive speeds in its definitions: before that, all rows but these speeds are dependent."""
    # A definition frees its parts: these wait until the velocity is substituted.
    found = dict(structure.definitions)
    rows: dict[int, list[int]] = {}
    for k, row in structure.ties:
        found[row] = tuple([u for u in found.pop(k) if u < structure.speeds])
    # A row on a kept velocity waits for the massive speeds below it.
    if structure.kept:
        moving = _moving_mass(structure, massive)
        for i in range(structure.speeds, structure.size):
            for j in _nearest_speeds(structure, near[i]) & moving:
                rows.setdefault(j, []).append(i)
    return found | {j: tuple(waiting) for j, waiting in rows.items()}


def _nearest_speeds(structure: Structure, unknowns: Iterable[int]) -> set[int]:
    """Return the speeds among `unknowns`, and of each velocity the speeds of the first level of definitions
    below it that has any."""
    found: set[int] = set()
    for unknown in unknowns:
        # Down the definitions until a level contains speeds.
        left, own = {unknown}, set[int]()
        while left and not own:
            own = {u for u in left if u < structure.speeds}
            left = {u for k in left for u in structure.definitions.get(k, ())}
        found |= own
    return found


def _moving_mass(structure: Structure, massive: Sequence[bool]) -> set[int]:
    """Return the speeds and shared velocities that have a mass, or that a velocity with a mass contains."""
    # Mass of a velocity is mass of the parts of its definition, down to the speeds.
    left = [k for k in range(structure.speeds) if massive[k]]
    left += [k for k in structure.definitions if massive[k]]
    found = set(left)
    while left:
        for u in structure.definitions.get(left.pop(), ()):
            if u not in found:
                found.add(u)
                left.append(u)
    return found
