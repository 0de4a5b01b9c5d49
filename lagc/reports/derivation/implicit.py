"""The implicit constraints: those that the positions of the bodies satisfy for all values of the parameters.

They are looked for as a person reads a drawing: joints of bodies at a point, known components, lengths that
stay, components that follow from others, turns about fixed axes. Each is a set of linear forms on the free
velocities of the bodies. A list is proved where its forms vanish on all motions of the model and their rank is
the number of parameters that the constraints saved.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TypeAlias

from lagc.base.records import dataclass
from lagc.mechanics.numeric.dense_linear import dimension
from lagc.mechanics.numeric.dense_linear import dot as product
from lagc.mechanics.numeric.samples import samples
from lagc.reports.algebra.expansion import TooLarge
from lagc.reports.algebra.polynomials import NotFinite
from lagc.reports.derivation.document import Text, plain
from lagc.reports.derivation.document import math as formula
from lagc.reports.derivation.draft import Draft
from lagc.semantics.model import Body
from lagc.symbolic.derivative import gradient, tangent
from lagc.symbolic.evaluate import evaluate
from lagc.symbolic.graph import Node
from lagc.symbolic.vectors import Vector, cross, dot, matvec, sub, transpose

ROUNDING = 1e-9  # relative: of forms on unit twists, where what vanishes is about 1e-15
KINDS = {1: "pivot", 2: "universal", 3: "ball"}  # of joints, by the rank of the relative rotation
Point: TypeAlias = "tuple[str, Vector]"  # letters and position
Numbers: TypeAlias = "tuple[float, float, float]"
AXES: tuple[Numbers, ...] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


@dataclass(frozen=True, slots=True)
class Implicit:
    """Constraints that belong together, as forms on the free velocities of all bodies at a state."""

    text: Text
    forms: list[list[float]]


def implicit_constraints(draft: Draft) -> list[Implicit]:
    """Return the implicit constraints of a model, none if the list is not proved."""
    states = list(samples(draft.model, 1, spread=1.0))
    try:
        search = _Search(draft, states[0]) if states else None
        found = [] if search is None else search.constraints()
    except (TooLarge, NotFinite):
        return []
    return found if search is not None and search.proves(found) else []


class _Search:
    """The search at one generic `state`."""

    def __init__(self, draft: Draft, state: dict[Node, float]):
        self.draft, self.state, self.writer = draft, {**state}, draft.writer
        self.state.setdefault(draft.graph.symbol("number", "pi"), math.pi)
        self.state.update((rate, 0.5) for rate in draft.rates.symbols if rate not in state)
        self.bodies = draft.model.bodies
        sizes = [3 if body.frame is None else 6 for body in self.bodies]
        self.places = {body.name: sum(sizes[:k]) for k, body in enumerate(self.bodies)}
        self.size = sum(sizes)
        self.moving = {*draft.rates.states.q, draft.equations.time}
        self.references: dict[Node, tuple[list[float], float]] = {}  # by coordinate: a form is slope * rate
        self.points = self._points()

    def _points(self) -> list[Point]:
        """Return the origin, the declared points, the centres, and partial sums of the centres."""
        draft, zero = self.draft, self.draft.graph.zero
        found: list[Point] = [("O", (zero, zero, zero))]
        found += [(self.writer.name(p.name), p.position) for p in draft.model.points]
        found += [(draft.centres[b.name], b.position) for b in self.bodies]
        for body in self.bodies:
            components = draft.vectors.express(body.position)
            for k in range(1, len(components)):
                terms = [(self.writer.node_of(p), unit) for p, unit in components[:k]]
                x, y, z = (draft.graph.sum(node * unit.axis[i] for node, unit in terms) for i in range(3))
                if any(self._vanishes(sub((x, y, z), place)) for _, place in found):
                    continue
                letters = " + ".join(draft.components(components[:k], (x, y, z), "a point"))
                found.append((f"O + {letters}", (x, y, z)))
        return found

    def constraints(self) -> list[Implicit]:
        found: list[Implicit] = []
        known = [point for point in self.points if self._belongs(None, point[1])]
        for k, body in enumerate(self.bodies):
            if k:
                last = self.bodies[k - 1]
                known.append((self.draft.centres[last.name], last.position))
                known += [p for p in self.points if last.frame is not None and self._belongs(last, p[1])]
            joint = self._joint(body, self.bodies[:k]) if body.frame is not None else None
            found += [joint] if joint is not None else [*self._place(body, known), *self._turns(body)]
        return found

    # -- kinds ------------------------------------------------------------------------------------

    def _joint(self, body: Body, before: Sequence[Body]) -> Implicit | None:
        """Return a point of the body that belongs to the ground or to a body before it, too."""
        for other in (None, *[b for b in before if b.frame is not None]):
            for letters, place in self.points:
                if not (self._belongs(body, place) and self._belongs(other, place)):
                    continue
                relative = self._relative_spin(body, other)
                turns = dimension(relative, ROUNDING)
                if turns not in KINDS:
                    continue
                say = self.draft.say
                who = plain(say.word("ground")) if other is None else self._letters(other)
                text = say(KINDS[turns], formula(letters), who, self._letters(body))
                forms = [self._difference(body, other, place, axis) for axis in AXES]
                forms += [self._turn(body, other, n) for n in _perpendicular(relative)]
                return Implicit(_counted(text, 6 - turns), forms)
        return None

    def _place(self, body: Body, known: Sequence[Point]) -> list[Implicit]:
        """Return known components of a centre, a length that stays, components that follow from others."""
        q, writer, name = set(self.draft.rates.states.q), self.writer, self.draft.centres[body.name]
        polynomials, found = writer.polynomials(body.position), list[Implicit]()
        inside = [writer.symbols_in(p) & q for p in polynomials]
        for k in [k for k in range(3) if not inside[k]]:
            found.append(
                Implicit(self._component(k, name, body), [self._velocity(body, body.position, AXES[k])])
            )
        moving = [k for k in range(3) if inside[k]]
        plain_ones = [body.position[k] for k in moving]
        independent = len({*plain_ones} & q) == len(moving)
        length = None if independent or not moving else self._length(body, known)
        if length is not None:
            return [*found, length]
        for k in moving:
            if len(inside[k]) == 1 and not inside[k] & self.references.keys():
                (coordinate,) = inside[k]
                form = self._velocity(body, body.position, AXES[k])
                self.references[coordinate] = form, self._slopes(body.position[k])[coordinate]
            elif inside[k] <= self.references.keys():
                found.append(Implicit(self._component(k, name, body), [self._made(body, k)]))
        return found

    def _length(self, body: Body, known: Sequence[Point]) -> Implicit | None:
        for other, place in reversed(known):
            difference = sub(body.position, place)
            square = self.writer.polynomial(dot(difference, difference))
            if not square or self.writer.symbols_in(square) & self.moving:
                continue
            length = self.writer.latex.total(self.writer.total(self.writer.algebra.root(square)))
            text = formula(rf"\left|{other}\,{self.draft.centres[body.name]}\right| = {length}")
            form = self._velocity(body, body.position, self._numbers(difference))
            for base in self.bodies:  # the other end moves with a body, or not at all
                if self._belongs(base, place) and not self._belongs(None, place):
                    back = self._velocity(base, place, self._numbers(difference))
                    return Implicit(_counted(text, 1), [[a - b for a, b in zip(form, back)]])
            return Implicit(_counted(text, 1), [form])
        return None

    def _made(self, body: Body, k: int) -> list[float]:
        """Return the form of a component that follows from those that are references."""
        form = self._velocity(body, body.position, AXES[k])
        for coordinate, slope in self._slopes(body.position[k]).items():
            reference, own = self.references[coordinate]
            form = [a - slope / own * b for a, b in zip(form, reference)]
        return form

    def _turns(self, body: Body) -> list[Implicit]:
        """Return the axes about which a solid does not turn, if it turns about one at most."""
        if body.frame is None:
            return []
        spin = self.writer.polynomials(body.frame.spin)
        axes = [k for k in range(3) if spin[k]]
        if len(axes) > 1:
            return []
        forms = [self._turn(body, None, AXES[k]) for k in range(3) if k not in axes]
        if not axes:
            return [Implicit(_counted(self.draft.say("does_not_turn", self._letters(body)), 3), forms)]
        axis = formula(self.draft.vectors.world[axes[0]].latex)
        return [Implicit(_counted(self.draft.say("turns_about", self._letters(body), axis), 2), forms)]

    # -- forms on the free velocities -----------------------------------------------------------------

    def _velocity(self, body: Body, place: Vector, n: Numbers) -> list[float]:
        """Return the form V(P) . n = V(C) . n + w . (CP x n) of a point P of a body with the centre C."""
        form, at = [0.0] * self.size, self.places[body.name]
        form[at : at + 3] = n
        if body.frame is not None:
            form[at + 3 : at + 6] = cross(self._numbers(sub(place, body.position)), n)
        return form

    def _difference(self, body: Body, other: Body | None, place: Vector, n: Numbers) -> list[float]:
        form = self._velocity(body, place, n)
        return form if other is None else [a - b for a, b in zip(form, self._velocity(other, place, n))]

    def _turn(self, body: Body, other: Body | None, n: Numbers) -> list[float]:
        form = [0.0] * self.size
        for each, sign in ((body, 1.0), (other, -1.0)):
            if each is not None:
                at = self.places[each.name] + 3
                form[at : at + 3] = [sign * x for x in n]
        return form

    def proves(self, found: Sequence[Implicit]) -> bool:
        """Whether the forms vanish on all motions, and are as many and as independent as they should be."""
        forms = [form for each in found for form in each.forms]
        flat = [x for b in self.bodies for x in (*b.velocity, *(b.frame.spin if b.frame is not None else ()))]
        motions = self._columns(flat)
        sizes = [math.sqrt(product(x, x)) for x in forms]
        if len(forms) != self.size - dimension(motions, ROUNDING) or not all(sizes):
            return False
        units = [[x / size for x in form] for form, size in zip(forms, sizes)]
        largest = max([abs(x) for column in motions for x in column], default=0.0)
        vanish = all(abs(product(f, m)) <= ROUNDING * largest for f in units for m in motions)
        return vanish and dimension(units, ROUNDING) == len(forms)

    # -- numbers --------------------------------------------------------------------------------------

    def _numbers(self, vector: Vector) -> Numbers:
        x, y, z = evaluate(vector, self.state)
        return x, y, z

    def _columns(self, velocities: Sequence[Node]) -> list[list[float]]:
        """Return the derivatives of velocities by each rate."""
        graph = self.draft.graph
        return [
            evaluate(tangent(graph, velocities, {rate: graph.one}), self.state)
            for rate in self.draft.rates.symbols
        ]

    def _slopes(self, node: Node) -> dict[Node, float]:
        """Return the derivatives by the coordinates that a position depends on."""
        graph = self.draft.graph
        found = gradient(graph, {node: graph.one}, list(self.draft.rates.states.q))
        return dict(zip(found, evaluate(list(found.values()), self.state)))

    def _relative_spin(self, body: Body, other: Body | None) -> list[list[float]]:
        assert body.frame is not None
        spin = body.frame.spin
        if other is not None and other.frame is not None:
            spin = sub(spin, other.frame.spin)
        return self._columns(spin)

    # -- exact tests ----------------------------------------------------------------------------------

    def _belongs(self, body: Body | None, place: Vector) -> bool:
        """Whether a point is a place of the body, or of the ground, whatever the motion."""
        if body is not None:
            place = sub(place, body.position)
            place = place if body.frame is None else matvec(transpose(body.frame.axes), place)
        polynomials = self.writer.polynomials(place)
        if body is not None and body.frame is None:
            return not any(polynomials)
        return not any(self.writer.symbols_in(p) & self.moving for p in polynomials)

    def _vanishes(self, vector: Vector) -> bool:
        return not any(self.writer.polynomials(vector))

    # -- texts ------------------------------------------------------------------------------------------

    def _letters(self, body: Body) -> Text:
        return formula(self.writer.name(body.name))

    def _component(self, k: int, name: str, body: Body) -> Text:
        value = self.writer.text(body.position[k], f"a component of {body.name}")
        return _counted(formula(f"{'xyz'[k]}_{{{name}}} = {value}"), 1)


def _counted(text: Text, saved: int) -> Text:
    return (*text, *plain(f" ({saved})"))


def _perpendicular(vectors: Sequence[Sequence[float]]) -> list[Numbers]:
    """Return unit vectors that span what is perpendicular to `vectors` in space."""
    basis = [list(v) for v in vectors]
    found: list[Numbers] = []
    while dimension(basis, ROUNDING) < 3:
        rests = [_rest(axis, basis) for axis in AXES]
        n = max(rests, key=lambda x: product(x, x))
        size = math.sqrt(product(n, n))
        found.append((n[0] / size, n[1] / size, n[2] / size))
        basis.append(list(found[-1]))
    return found


def _rest(vector: Sequence[float], basis: Sequence[Sequence[float]]) -> list[float]:
    """Return the part of a vector that is perpendicular to all of `basis`, by Gram and Schmidt."""
    units: list[list[float]] = []
    for each in [*basis, vector]:
        rest = list(each)
        for unit in [*units, *units]:  # twice is enough (W. Kahan)
            part = product(rest, unit)
            rest = [a - part * b for a, b in zip(rest, unit)]
        if each is vector:
            return rest
        size = math.sqrt(product(rest, rest))
        if size > ROUNDING:
            units.append([x / size for x in rest])
    return list(vector)
