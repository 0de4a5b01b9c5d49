"""Vectors in the unit vectors that a person would choose.

A vector is given by its components in the world. It is written in the candidate with the fewest terms: the
world, a frame of the model, or, angle by angle, unit vectors u, v that turn with it:

    S sin A + C cos A = alpha u + beta v,   u = s sin A + c cos A,   v = s cos A - c sin A

with S, C along two axes s, c of the world. u points from the centre, v in the direction in which A turns.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import TypeAlias

from lagc.base.records import dataclass
from lagc.reports.algebra.expansion import TooLarge
from lagc.reports.algebra.polynomials import Frozen, NotFinite, Polynomial, scaled
from lagc.reports.derivation.writer import FEWER, FormulaWriter, subscript
from lagc.semantics.model import Frame
from lagc.symbolic.graph import Node
from lagc.symbolic.vectors import Vector, matvec, transpose

FUNCTION = 1.5  # terms that a sine or cosine counts
WORLD = "world"
Signed: TypeAlias = "tuple[int, int]"  # an axis of the world and its sign


@dataclass(frozen=True, slots=True)
class Unit:
    """A unit vector: its letters, and its components in the world."""

    latex: str
    axis: Vector


Components: TypeAlias = "list[tuple[Polynomial, Unit]]"


@dataclass(frozen=True, slots=True)
class Turning:
    """Unit vectors that turn with an angle, each with its sign; `s` and `c` are axes of the world."""

    s: Signed
    c: Signed
    u: tuple[int, Unit]
    v: tuple[int, Unit]


class UnitVectors:
    """The unit vectors of a solution. `used` has the letters of those that it writes."""

    def __init__(self, writer: FormulaWriter, frames: Sequence[Frame], positions: Sequence[Vector]):
        self.writer, self.frames = writer, frames
        one, zero = writer.graph.one, writer.graph.zero
        eye: list[Vector] = [(one, zero, zero), (zero, one, zero), (zero, zero, one)]
        self.world = [Unit(rf"\vec{{{x}}}_0", axis) for x, axis in zip("xyz", eye)]
        self.of_frame = {WORLD: self.world}
        for frame in frames:
            name, columns = subscript(frame.name), transpose(frame.axes)
            self.of_frame[frame.name] = [
                Unit(rf"\vec{{{x}}}_{{{name}}}", axis) for x, axis in zip("xyz", columns)
            ]
        self.turning: dict[Frozen, Turning] = {}  # by the angle
        self.made: list[Turning] = []  # those that no frame of the model has
        self.used: set[str] = set()
        for frame in frames:
            self._learn_from_frame(frame)
        self._learn_from_positions(positions)

    # -- angle by angle -----------------------------------------------------------------------------

    def _split(self, p: Polynomial) -> tuple[dict[Frozen, tuple[Polynomial, Polynomial]], Polynomial] | None:
        """Return {A: (S, C)} and the rest of p = rest + the sum of S sin A + C cos A; None if it is not
        so."""
        atoms = self.writer.algebra.atoms
        groups: dict[Frozen, tuple[Polynomial, Polynomial]] = {}
        rest: Polynomial = {}
        for monomial, c in p.items():
            turns = [(a, e) for a, e in monomial if atoms[a].op in ("sin", "cos")]
            if not turns:
                rest[monomial] = c
            elif len(turns) > 1 or turns[0][1] != 1:
                return None
            else:
                (a, _), *_ = turns
                sines = groups.setdefault(atoms[a].args[0], ({}, {}))
                sines[atoms[a].op == "cos"][tuple([x for x in monomial if x[0] != a])] = c
        return groups, rest

    def _plane(self, vector: Sequence[Node]) -> list[tuple[Frozen, Signed, Signed]]:
        """Return the angles A, with signed axes s and c, for which a vector has a part
        k (s sin A + c cos A)."""
        parts = [self._split(p) for p in self._polynomials(vector)]
        # A turn in a plane of the world: the sine stands in one component alone, the cosine in another one,
        # with equal factors.
        tables = [x[0] for x in parts if x is not None]
        if len(tables) < 3:
            return []
        found = []
        for each in sorted({a for table in tables for a in table}):
            sines = [
                (i, table[each][0]) for i, table in enumerate(tables) if each in table and table[each][0]
            ]
            cosines = [
                (i, table[each][1]) for i, table in enumerate(tables) if each in table and table[each][1]
            ]
            if len(sines) != 1 or len(cosines) != 1 or sines[0][0] == cosines[0][0]:
                continue
            (i, p), (j, q) = sines[0], cosines[0]
            first = 1 if p[min(p)] > 0 else -1
            if p == q:
                found.append((each, (i, first), (j, first)))
            elif p == scaled(q, Fraction(-1)):
                found.append((each, (i, first), (j, -first)))
        return found

    def _learn_from_frame(self, frame: Frame) -> None:
        """Take an angle with which two axes of a frame turn in a plane of the world."""
        units = self.of_frame[frame.name]
        for unit in units:
            planes = self._plane(unit.axis)
            if len(planes) != 1 or planes[0][0] in self.turning:
                continue
            ((angle, s, c),) = planes
            u, v = self._pair(angle, s, c)
            ends = [
                (sign, x) for wanted in (u, v) for x in units for sign in (1, -1) if self._is(wanted, x, sign)
            ]
            if len(ends) == 2:
                self.turning[angle] = Turning(s, c, ends[0], ends[1])
                return

    def _is(self, wanted: Vector, unit: Unit, sign: int) -> bool:
        found = self._polynomials([a - float(sign) * b for a, b in zip(wanted, unit.axis)])
        return len(found) == 3 and not any(found)

    def _learn_from_positions(self, positions: Sequence[Vector]) -> None:
        """Make u and v for angles of positions that no frame has."""
        planes: dict[Frozen, tuple[Signed, Signed]] = {}
        for position in positions:
            for angle, s, c in self._plane(position):
                if angle not in self.turning:
                    planes.setdefault(angle, (s, c))
        for angle, (s, c) in planes.items():
            if s[1] < 0 and c[1] < 0:
                s, c = (s[0], 1), (c[0], 1)
            letters = self.writer.latex.total(self.writer.total(dict(angle)))
            index = "" if len(planes) == 1 else f"_{{{letters}}}"
            u, v = self._pair(angle, s, c)
            turn = Turning(s, c, (1, Unit(rf"\vec{{u}}{index}", u)), (1, Unit(rf"\vec{{v}}{index}", v)))
            self.turning[angle] = turn
            self.made.append(turn)

    def _pair(self, angle: Frozen, s: Signed, c: Signed) -> tuple[Vector, Vector]:
        """Return u and v in the axes of the world."""
        graph = self.writer.graph
        node = self.writer.node_of(dict(angle))
        sine, cosine = graph.unary("sin", node), graph.unary("cos", node)
        u, v = [graph.zero] * 3, [graph.zero] * 3
        u[s[0]], u[c[0]] = sine * float(s[1]), cosine * float(c[1])
        v[s[0]], v[c[0]] = cosine * float(s[1]), sine * float(-c[1])
        return (u[0], u[1], u[2]), (v[0], v[1], v[2])

    # -- the choice ---------------------------------------------------------------------------------

    def express(self, vector: Sequence[Node]) -> Components:
        """Return a vector as components along unit vectors: the shortest of those that are not too long.
        Raises TooLarge, NotFinite."""
        polynomials = self._polynomials(vector)
        found = [list(zip(polynomials, self.world))] if polynomials else []
        mixed = self._mixed(polynomials) if polynomials else None
        if mixed is not None:
            found.append(mixed)
        x, y, z = vector
        for frame in self.frames:
            components = self._polynomials(matvec(transpose(frame.axes), (x, y, z)))
            found += [list(zip(components, self.of_frame[frame.name]))] if components else []
        if not found:
            found = [list(zip(self.writer.polynomials(vector), self.world))]
        best = min([[(p, unit) for p, unit in each if p] for each in found], key=self.cost)
        self.used.update(unit.latex for _, unit in best)
        return best

    def cost(self, components: Components) -> float:
        """Return about how long components are."""
        return sum(self.size(p) + 0.1 for p, _ in components)

    def size(self, p: Polynomial) -> float:
        atoms = self.writer.algebra.atoms
        return sum(1.0 + FUNCTION * sum(atoms[a].op in ("sin", "cos") for a, _ in m) for m in p)

    def _mixed(self, polynomials: Sequence[Polynomial]) -> Components | None:
        """Return the rest in axes of the world, and a part along u and v of each angle; None if a part is not
        along these."""
        parts = [self._split(p) for p in polynomials]
        if any(x is None for x in parts):
            return None
        known = [x for x in parts if x is not None]
        found = [(rest, unit) for (_, rest), unit in zip(known, self.world) if rest]
        angles = {angle for table, _ in known for angle in table}
        if not angles <= self.turning.keys():
            return None
        for angle in [each for each in self.turning if each in angles]:
            turn = self.turning[angle]
            # S sin A + C cos A = alpha u + beta v, compared component by component along s and c.
            S, C = ([table.get(angle, ({}, {}))[k] for table, _ in known] for k in (0, 1))
            (i, s), (j, c) = turn.s, turn.c
            alpha, beta = scaled(S[i], Fraction(s)), scaled(C[i], Fraction(s))  # S = alpha s - beta c
            if (
                scaled(C[j], Fraction(c)) != alpha or scaled(S[j], Fraction(-c)) != beta
            ):  # C = alpha c + beta s
                return None
            if any(S[k] or C[k] for k in range(3) if k not in (i, j)):
                return None
            for p, (sign, unit) in ((alpha, turn.u), (beta, turn.v)):
                if p:
                    found.append((scaled(p, Fraction(sign)), unit))
        return found

    def _polynomials(self, vector: Sequence[Node]) -> list[Polynomial]:
        """Return the components as polynomials, none if they are too long."""
        try:
            return self.writer.polynomials(vector, FEWER)
        except (TooLarge, NotFinite):
            return []
