"""The implicit constraints: those that the positions of the bodies satisfy for all values of the parameters.

They are looked for as a person reads a drawing: joints of bodies at a point, known components, lengths that
stay, components that follow from others, turns about fixed axes. Each is a set of linear forms on the free
velocities of the bodies at a generic state. A list is proved where its forms vanish on all motions of the
model, are independent, and are as many as the parameters that the constraints saved.
"""

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple, TypeAlias

from lagc.mechanics.identities.linear_algebra import dimension, least_norm
from lagc.mechanics.identities.linear_algebra import dot as product
from lagc.mechanics.identities.samples import samples
from lagc.reports.algebra.expansion import TooLarge
from lagc.reports.algebra.polynomials import NotFinite
from lagc.reports.derivation.document import math as formula
from lagc.reports.derivation.draft import Draft
from lagc.semantics.model import Body
from lagc.symbolic.derivative import gradient, tangent
from lagc.symbolic.graph import Node
from lagc.symbolic.vectors import Vector, cross, dot, sub
from lagc.symbolic.walk import evaluate

ROUNDING = 1e-9  # relative: exact zeros are about 1e-15 there
KINDS = {1: "pivot", 2: "universal", 3: "ball"}  # of joints, by the rank of the relative rotation
Numbers: TypeAlias = "tuple[float, float, float]"
AXES: tuple[Numbers, ...] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


class Implicit(NamedTuple):
    """Constraints that belong together, as forms on the free velocities of all bodies."""

    text: str
    forms: list[list[float]]


class Point(NamedTuple):
    """A point: its letters, and at the state its place and its velocity in each motion."""

    letters: str
    position: Vector
    place: Numbers
    velocities: list[Numbers]


def implicit_constraints(draft: Draft) -> list[Implicit]:
    """Return the implicit constraints of a model, none if the list is not proved."""
    for state in samples(draft.model, 1, spread=1.0):
        try:
            search = _Search(draft, state)
            found = search.constraints()
            return found if search.proves(found) else []
        except (TooLarge, NotFinite):
            break
    return []


class _Search:
    """The search at one state. The motions are a unit of each rate, and the drives alone."""

    def __init__(self, draft: Draft, state: dict[Node, float]):
        self.draft, self.bodies = draft, draft.model.bodies
        self.state = {
            draft.graph.symbol("number", "pi"): math.pi,
            **dict.fromkeys(draft.rates.symbols, 0.5),
            **state,
        }
        sizes = [3 if body.frame is None else 6 for body in self.bodies]
        self.at = {body.name: sum(sizes[:k]) for k, body in enumerate(self.bodies)}
        self.size, zero = sum(sizes), draft.graph.zero
        self.spins = {b.name: self._motions(b.frame.spin) for b in self.bodies if b.frame is not None}
        self.centres = {b.name: self._point(draft.centres[b.name], b.position) for b in self.bodies}
        name = draft.writer.name
        self.points = [self._point("O", (zero, zero, zero))]
        self.points += [self._point(name(p.name), p.position) for p in draft.model.points]
        self.points += [*self.centres.values(), *self._partial_sums()]
        self.references: dict[Node, list[float]] = {}  # a form for the rate of a coordinate

    def _partial_sums(self) -> list[Point]:
        """Return the points that are partial sums of a centre's position, such as O + r x_C."""
        draft, found = self.draft, list[Point]()
        for body in self.bodies:
            components = draft.vectors.express(body.position)
            for k in range(1, len(components)):
                terms = [(draft.writer.node_of(p), unit) for p, unit in components[:k]]
                x, y, z = (draft.graph.sum(node * unit.axis[i] for node, unit in terms) for i in range(3))
                letters = " + ".join(draft.components(components[:k], (x, y, z), "a point"))
                found.append(self._point(f"O + {letters}", (x, y, z)))
        return found

    def constraints(self) -> list[Implicit]:
        found: list[Implicit] = []
        known = [point for point in self.points if self._belongs(None, point)]
        for k, body in enumerate(self.bodies):
            if k:
                last = self.bodies[k - 1]
                known.append(self.centres[last.name])
                known += [p for p in self.points if last.frame is not None and self._belongs(last, p)]
            joint = self._joint(body, self.bodies[:k]) if body.frame is not None else None
            found += [joint] if joint is not None else [*self._place(body, known), *self._turns(body)]
        return found

    # -- kinds ------------------------------------------------------------------------------------

    def _joint(self, body: Body, before: Sequence[Body]) -> Implicit | None:
        """Return a point of the body that belongs to the ground or to a body before it, too."""
        for other in (None, *[b for b in before if b.frame is not None]):
            spins = self.spins[body.name]
            relative = [sub(a, b) for a, b in zip(spins, self.spins[other.name])] if other else spins
            turns = dimension(relative, ROUNDING)
            for point in [p for p in self.points if self._belongs(body, p) and self._belongs(other, p)]:
                if turns in KINDS:
                    say, who = self.draft.say, self._letters(other) if other else self.draft.say("ground")
                    text = say(KINDS[turns], formula(point.letters), who, self._letters(body))
                    forms = [self._velocity(body, point, n, other) for n in AXES]
                    forms += [self._turn(body, other, n) for n in _perpendicular(relative)]
                    return Implicit(f"{text} ({6 - turns})", forms)
        return None

    def _place(self, body: Body, known: Sequence[Point]) -> list[Implicit]:
        """Return known components of a centre, a length that stays, components that follow from others."""
        centre, found = self.centres[body.name], list[Implicit]()
        slopes = [self._slopes(x) for x in body.position]
        for k in [k for k in range(3) if not slopes[k]]:
            found.append(self._component(body, k, self._velocity(body, centre, AXES[k])))
        # Components that move: by the rotation of the body, along coordinates that are components
        # themselves, at a constant distance, or by components that are known from bodies before.
        moving = [k for k in range(3) if slopes[k]]
        turning = self._from_spin(body, {q: x for k in moving for q, x in slopes[k].items()})
        if moving and all(slopes[k].keys() <= turning.keys() for k in moving):
            forms = [self._less(body, k, slopes[k], turning) for k in moving]
            return [*found, *[self._component(body, k, form) for k, form in zip(moving, forms)]]
        plain = {x for x in body.position if x in self.draft.rates.states.q}
        length = None if len(plain) == len(moving) else self._length(body, centre, known)
        if length is not None:
            return [*found, length]
        for k in moving:
            unknown = slopes[k].keys() - self.references.keys()
            if not unknown:
                found.append(self._component(body, k, self._less(body, k, slopes[k], self.references)))
            elif len(unknown) == 1:
                (coordinate,) = unknown
                others = {q: slope for q, slope in slopes[k].items() if q != coordinate}
                form = self._less(body, k, others, self.references)
                self.references[coordinate] = [x / slopes[k][coordinate] for x in form]
        return found

    def _less(
        self, body: Body, k: int, slopes: Mapping[Node, float], references: Mapping[Node, list[float]]
    ) -> list[float]:
        """Return the form of a component of a centre, less the share of coordinates."""
        form = self._velocity(body, self.centres[body.name], AXES[k])
        for coordinate, slope in slopes.items():
            form = [a - slope * b for a, b in zip(form, references[coordinate])]
        return form

    def _from_spin(self, body: Body, slopes: Mapping[Node, float]) -> dict[Node, list[float]]:
        """Return the rates that are a component of the rotation of the body, as forms."""
        found, positions = dict[Node, list[float]](), self.draft.rates.positions
        spins = [(i, w) for i, w in enumerate(self.spins.get(body.name, [])) if math.hypot(*w) > ROUNDING]
        for j in [j for j, _ in spins if positions.get(j) in slopes]:
            x, y, z = least_norm([w for _, w in spins], [float(i == j) for i, _ in spins])
            if all(abs(product(w, (x, y, z)) - (i == j)) < ROUNDING for i, w in spins):
                found[positions[j]] = self._turn(body, None, (x, y, z))
        return found

    def _length(self, body: Body, centre: Point, known: Sequence[Point]) -> Implicit | None:
        """Return a constant distance of a centre from a known point."""
        for point in reversed(known):
            arm, size = sub(centre.place, point.place), math.dist(centre.place, point.place)
            moves = [sub(a, b) for a, b in zip(centre.velocities, point.velocities)]
            if size == 0.0 or any(abs(product(arm, v)) > ROUNDING * size * math.hypot(*v) for v in moves):
                continue
            writer, difference = self.draft.writer, sub(centre.position, point.position)
            length = writer.algebra.root(writer.polynomial(dot(difference, difference)))
            letters = rf"\left|{point.letters}\,{centre.letters}\right|"
            text = formula(f"{letters} = {writer.latex.total(writer.total(length))}")
            owners = [b for b in self.bodies if self._belongs(b, point) and not self._belongs(None, point)]
            form = self._velocity(body, centre, arm)
            if owners:
                form = [a - b for a, b in zip(form, self._velocity(owners[0], point, arm))]
            return Implicit(f"{text} (1)", [form])
        return None

    def _turns(self, body: Body) -> list[Implicit]:
        """Return the axes about which a solid does not turn, if it turns about one at most."""
        spins = self.spins.get(body.name)
        axes = [k for k in range(3) if spins is not None and any(abs(w[k]) > ROUNDING for w in spins)]
        if spins is None or len(axes) > 1:
            return []
        forms = [self._turn(body, None, AXES[k]) for k in range(3) if k not in axes]
        key, axis = "does_not_turn", ""
        if axes:
            key, axis = "turns_about", formula(self.draft.vectors.world[axes[0]].latex)
        return [Implicit(f"{self.draft.say(key, self._letters(body), axis)} ({len(forms)})", forms)]

    # -- forms on the free velocities -----------------------------------------------------------------

    def _velocity(self, body: Body, point: Point, n: Numbers, other: Body | None = None) -> list[float]:
        """Return the form V(P) . n = V(C) . n + w . (CP x n) of a point of a body, less that of another."""
        form = [0.0] * self.size
        for each, sign in ((body, 1.0), (other, -1.0)):
            if each is not None:
                at, arm = self.at[each.name], cross(sub(point.place, self.centres[each.name].place), n)
                form[at : at + 3] = [sign * x for x in n]
                if each.frame is not None:
                    form[at + 3 : at + 6] = [sign * x for x in arm]
        return form

    def _turn(self, body: Body, other: Body | None, n: Numbers) -> list[float]:
        """Return the form w . n of a body, less that of another."""
        form = [0.0] * self.size
        for each, sign in ((body, 1.0), (other, -1.0)):
            if each is not None:
                form[self.at[each.name] + 3 : self.at[each.name] + 6] = [sign * x for x in n]
        return form

    def proves(self, found: Sequence[Implicit]) -> bool:
        """Whether the forms vanish on all motions, and are as many and as independent as they should be."""
        forms = [_unit(form) for each in found for form in each.forms]
        motions: list[list[float]] = [[] for _ in self.draft.rates.symbols]
        for body in self.bodies:
            for column, v, w in zip(motions, self.centres[body.name].velocities, self._spins(body)):
                column += [*v, *w]
        missing = self.size - dimension(motions, ROUNDING)
        vanish = all(abs(product(f, m)) <= ROUNDING * math.hypot(*m) for f in forms for m in motions)
        return len(forms) == missing == dimension(forms, ROUNDING) and vanish

    def _spins(self, body: Body) -> Sequence[Sequence[float]]:
        return self.spins.get(body.name, [()] * len(self.draft.rates.symbols))

    # -- values at the state --------------------------------------------------------------------------

    def _motions(self, velocity: Sequence[Node]) -> list[Numbers]:
        """Return the derivatives of a velocity by each rate, and its value where all rates vanish."""
        graph, rates = self.draft.graph, self.draft.rates
        slopes = [tangent(graph, velocity, {rate: graph.one}) for rate in rates.symbols]
        flat = evaluate([x for each in (*slopes, rates.declared.at_rest(velocity)) for x in each], self.state)
        return [(flat[k], flat[k + 1], flat[k + 2]) for k in range(0, len(flat), 3)]

    def _point(self, letters: str, position: Vector) -> Point:
        x, y, z = evaluate(position, self.state)
        return Point(letters, position, (x, y, z), self._motions(self.draft.rates.velocity(position)))

    def _slopes(self, node: Node) -> dict[Node, float]:
        """Return the derivatives by the coordinates that a component depends on."""
        graph = self.draft.graph
        found = gradient(graph, {node: graph.one}, list(self.draft.rates.states.q))
        values = zip(found, evaluate(list(found.values()), self.state))
        return {q: value for q, value in values if abs(value) > ROUNDING}

    def _belongs(self, body: Body | None, point: Point) -> bool:
        """Whether a point moves as a place of the body, or not at all as one of the ground."""
        zero = (0.0, 0.0, 0.0)
        if body is None:
            return all(math.hypot(*v) <= ROUNDING for v in point.velocities)
        centre = self.centres[body.name]
        if body.frame is None and point is not centre:
            return False
        arm, spins = (
            sub(point.place, centre.place),
            self.spins.get(body.name, [zero] * len(centre.velocities)),
        )
        gaps = [sub(sub(v, c), cross(w, arm)) for v, c, w in zip(point.velocities, centre.velocities, spins)]
        size = 1.0 + max([math.hypot(*v) for v in point.velocities])
        return all(math.hypot(*gap) <= ROUNDING * size for gap in gaps)

    # -- texts ------------------------------------------------------------------------------------------

    def _letters(self, body: Body) -> str:
        return formula(self.draft.writer.name(body.name))

    def _component(self, body: Body, k: int, form: list[float]) -> Implicit:
        value = self.draft.writer.text(body.position[k], f"a component of {body.name}")
        letters = f"{'xyz'[k]}_{{{self.centres[body.name].letters}}}"
        return Implicit(f"{formula(f'{letters} = {value}')} (1)", [form])


def _unit(vector: Sequence[float]) -> list[float]:
    size = math.hypot(*vector)
    return [x / size for x in vector] if size else list(vector)


def _perpendicular(vectors: Sequence[Numbers]) -> list[Numbers]:
    """Return unit vectors that span the directions perpendicular to `vectors` in space."""
    basis: list[Numbers] = []
    for v in vectors:
        rest = _perpendicular_part(v, basis)
        if math.hypot(*rest) > ROUNDING:
            basis.append(_scaled(rest))
    count = len(basis)
    while len(basis) < 3:
        basis.append(
            _scaled(max([_perpendicular_part(axis, basis) for axis in AXES], key=lambda x: math.hypot(*x)))
        )
    return basis[count:]


def _perpendicular_part(vector: Numbers, basis: Sequence[Numbers]) -> Numbers:
    """Return the part of a vector that is perpendicular to unit vectors (Gram and Schmidt)."""
    for unit in basis:
        part = product(vector, unit)
        vector = (vector[0] - part * unit[0], vector[1] - part * unit[1], vector[2] - part * unit[2])
    return vector


def _scaled(vector: Numbers) -> Numbers:
    size = math.hypot(*vector)
    return vector[0] / size, vector[1] / size, vector[2] / size
