"""Random declarations of one model or effect: each method writes one and enters it into the scope."""

import random

from tests.fuzz.expressions import GIVEN, MOTION, PLACE, SHOWN, Expressions, Function, Known, Scope
from tests.fuzz.words import (
    ENERGY,
    FORCE,
    INERTIA,
    LENGTH,
    MASS,
    NUMBER,
    POWER,
    SPEED,
    TIME,
    TURN,
    TYPES,
    Dimension,
    description,
    name,
    over,
    quantity_type,
    times,
    unit,
)

Q, V, P, T = frozenset("q"), frozenset("v"), frozenset("p"), frozenset("t")
KEPT = (MASS, LENGTH, NUMBER)  # of what no model has too few parameters


class Writer(Expressions):
    """Declarations, one a string, in `items`; `taken` are the names of all scopes of this model."""

    def __init__(self, chance: random.Random, scope: Scope, wild: float, nasty: float, taken: set[str]):
        super().__init__(chance, scope, wild)
        self.nasty, self.taken = nasty, taken
        self.items: list[str] = []
        self.effects: list[str] = []  # that `unless` may name
        self.parameters: list[tuple[str, Dimension]] = []
        self.coordinates: list[tuple[str, Dimension]] = []
        self.speeds: list[tuple[str, Dimension]] = []
        self.actions: list[str] = []
        self.rows: list[tuple[str, Dimension]] = []

    def name(self) -> str:
        return name(self.chance, self.taken, self.nasty)

    def tail(self) -> str:
        """What may end a declaration."""
        parts = [description(self.chance)]
        if self.effects and self.maybe(0.1):
            parts.append(f" unless {self.chance.choice(self.effects)}")
        if self.maybe(0.7):
            parts.reverse()
        return "".join(parts) + ";"

    def maybe(self, share: float) -> bool:
        return self.chance.random() < share

    # -- quantities -----------------------------------------------------------------------

    def parameter(self, dimension: Dimension | None = None) -> None:
        chance = self.chance
        wanted = dimension if dimension is not None else chance.choice(list(TYPES.values()))
        own = self.name()
        attributes = []
        value = self.literal(wanted) if self.maybe(0.8) else self.scalar(wanted, GIVEN, 1)
        if self.maybe(0.3):
            attributes.append(
                "min = -1e30"
                if " " in value[1:-1] and "(" in value
                else chance.choice(["min = 0", "min = -3"])
            )
        if self.maybe(0.1):
            attributes.append(f"max = {chance.choice(['1e30', '1e300', '1e6'])}")
        if self.maybe(0.1) and wanted != NUMBER:
            attributes.append(f'displayUnit = "{unit(wanted, chance)}"')
        kind = "constant" if self.maybe(0.15) else "parameter"
        if kind == "constant":
            attributes, value = [], self.literal(wanted)
        written = f"({', '.join(attributes)})" if attributes else ""
        if kind == "parameter" and dimension is None and self.maybe(0.1):
            value = self.literal(wanted)
            kind, on = "input", frozenset("o")
        else:
            on = P
        self.items.append(
            f"{kind} {quantity_type(wanted, chance)} {own}{written} = {value}{description(chance)};"
        )
        self.scope.scalars.append(Known(own, wanted, on, positive=" " not in value and "(" not in value))
        if kind == "parameter":
            self.parameters.append((own, wanted))

    def coordinate(self, dimension: Dimension) -> str:
        chance = self.chance
        own = self.name()
        attributes = []
        if self.maybe(0.7):
            value = self.literal(dimension) if self.maybe(0.85) else self.scalar(dimension, GIVEN, 1)
            attributes.append(f"start = {chance.choice(['', '', '-'])}{value}")
        if self.maybe(0.3):
            attributes.append(f"rate = {chance.choice(['0', self.literal(times(dimension, TURN))])}")
        if self.maybe(0.06):
            attributes.append(f"{chance.choice(['fixed', 'startFixed', 'rateFixed'])} = true")
        written = f"({', '.join(attributes)})" if attributes else ""
        kind = "Angle" if dimension == NUMBER and self.maybe(0.8) else quantity_type(dimension, chance)
        self.items.append(f"coordinate {kind} {own}{written}{description(chance)};")
        self._moves(own, dimension)
        self.coordinates.append((own, dimension))
        return own

    def _moves(self, own: str, dimension: Dimension) -> None:
        self.scope.scalars.append(Known(own, dimension, Q))
        self.scope.scalars.append(Known(f"der({own})", times(dimension, TURN), V))

    def speed(self) -> None:
        """A combination of rates; solvable for the first."""
        if not self.coordinates:
            return
        own, dimension = self.chance.choice(self.coordinates)
        rate = times(dimension, TURN)
        factor = self.chance.choice(["", "2*", f"(2 + sin({self.scalar(NUMBER, frozenset('pq'), 1)}))*"])
        more = self.chance.choice(["", "", f" + {self.scalar(rate, PLACE, 1)}"])
        named = self.name()
        start = f"(start = {self.literal(rate)})" if self.maybe(0.3) else ""
        self.items.append(
            f"speed {quantity_type(rate, self.chance)} {named}{start} = {factor}der({own}){more};"
        )
        self.scope.scalars.append(Known(named, rate, V))
        self.speeds.append((named, rate))

    def output(self) -> None:
        chance = self.chance
        dimension = chance.choice([ENERGY, LENGTH, SPEED, FORCE, NUMBER, (0, 1, -2, 0), POWER])
        shown = [k for k in self.scope.scalars if k.on <= MOTION]
        own = self.name()
        if self.rows and self.maybe(0.2):
            row, dimension = chance.choice(self.rows)
            value = f"reaction({row})"
        elif self.actions and self.maybe(0.2):
            dimension, value = POWER, f"power({chance.choice(self.actions)})"
        elif dimension == ENERGY:
            value = chance.choice(["energy()", "kinetic()", "potential()", "energy() - kinetic()"])
        elif dimension == FORCE and self.coordinates:
            other, its = chance.choice(self.coordinates)
            dimension, value = over((1, 2, -1, 0), its), f"momentum({other})"
        elif dimension == (0, 1, -2, 0) and (self.scope.solids or self.scope.particles):
            body = chance.choice([*self.scope.solids, *self.scope.particles])
            self.items.append(f"output Acceleration {own}[3] = acceleration({body});")
            return
        elif dimension == SPEED:
            self.items.append(
                f"output Velocity {own}[3] = {self.vector(SPEED, MOTION)}{description(chance)};"
            )
            return
        elif shown and self.maybe(0.3):
            one = chance.choice(shown)
            dimension, value = times(one.dimension, TURN), f"der({one.text})"
        else:
            value = self.scalar(dimension, SHOWN, 3, smooth=False)
        self.items.append(f"output {quantity_type(dimension, chance)} {own} = {value}{self.tail()}")

    def function(self) -> str:
        """The declaration; the scope knows the function."""
        chance = self.chance
        result = chance.choice([ENERGY, NUMBER, LENGTH, FORCE])
        own, wanted = (
            self.name(),
            [chance.choice([NUMBER, LENGTH, SPEED, TIME]) for _ in range(chance.choice([1, 2]))],
        )
        names = [f"s{k}" for k in range(len(wanted))]
        inside = Expressions(chance, Scope([Known(n, d, P) for n, d in zip(names, wanted)]), self.wild)
        body = inside.scalar(result, GIVEN, 2)
        self.scope.functions.append(Function(own, tuple(wanted), result))
        given = ", ".join(f"{quantity_type(d, chance)} {n}" for d, n in zip(wanted, names))
        return f"function {own}({given}) = {body}{description(chance)};"

    # -- what moves -------------------------------------------------------------------------

    def frame(self) -> tuple[str, str]:
        """A frame that turns by a new angle; its name, and an axis that moves with it."""
        chance, own = self.chance, self.name()
        frames = [text for text, _ in self.scope.frames] or ["world"]
        base = chance.choice(["world", *frames])
        axis = chance.choice("xyz")
        angle = self.coordinate(NUMBER)
        written = chance.choice(
            [angle, angle, f"-{angle}", f"{angle} + {self.leaf(NUMBER, GIVEN)}", f"2*{angle}"]
        )
        if self.maybe(0.15):
            vector, across = {"x": ("{1, 0, 0}", "y"), "y": ("{0, 2, 0}", "z"), "z": ("{0, 0, 1}", "x")}[axis]
            self.items.append(f"frame {own} = rotate({base}, {vector}, {written}){self.tail_only()}")
        else:
            across = {"x": "y", "y": "z", "z": "x"}[axis]
            self.items.append(f"frame {own} = rotate_{axis}({base}, {written}){self.tail_only()}")
        self.scope.frames.append((own, Q))
        return own, across

    def tail_only(self) -> str:
        return description(self.chance) + ";"

    def body(self, place: str, frame: str | None) -> None:
        own, mass = self.name(), self.positive(MASS)
        if frame is None:
            self.items.append(f"body {own} = Particle(mass = {mass}, at = {place}){self.tail_only()}")
            self.scope.particles.append(own)
        else:
            moment = self.positive(INERTIA)
            matrix = self.chance.choice([
                f"{moment}*{{1, 1, 1}}", f"{moment}*{{1, 2, 2.5}}", f"{{{moment}, {moment}, {moment}}}",
                f"{moment}*{{{{2, 0.1, 0}}, {{0.1, 2, 0}}, {{0, 0, 3}}}}",
            ])  # fmt: skip
            given = [f"mass = {mass}", f"inertia = {matrix}", f"frame = {frame}", f"com = {place}"]
            self.chance.shuffle(given)
            self.items.append(f"body {own} = Solid({', '.join(given)}){self.tail_only()}")
            self.scope.solids.append(own)
        self.scope.vectors.append(Known(f"position({own})", LENGTH, Q))

    def link(self) -> None:
        """Coordinates and a body that moves with them."""
        self.chance.choice(
            [self.slider, self.hinge, self.hinge, self.particle, self.free_solid, self.abstract]
        )()

    def _anchor(self) -> str:
        points = [k.text for k in self.scope.vectors if k.dimension == LENGTH and k.on <= Q]
        return self.chance.choice(points) if points and self.maybe(0.6) else "{0, 0, 0}"

    def point(self, place: str) -> str:
        """A declared point, mostly; else the place itself."""
        if self.maybe(0.4):
            return place
        own = self.name()
        self.items.append(f"point {own} = {place}{self.tail_only()}")
        self.scope.vectors.append(Known(own, LENGTH, Q))
        return own

    def slider(self) -> None:
        anchor, own = self._anchor(), self.coordinate(LENGTH)
        way = self.direction(frozenset("pq"))
        self.body(self.point(f"{anchor} + {own}*{way}"), self.chance.choice([None, "world"]))

    def hinge(self) -> None:
        anchor = self._anchor()
        frame, across = self.frame()
        arm = f"{anchor} + {self.positive(LENGTH)}*{frame}.{across}"
        if self.maybe(0.2):
            arm += f" + {self.scalar(LENGTH, frozenset('pq'), 1)}*{frame}.{across}"
        self.body(self.point(arm), frame if self.maybe(0.6) else None)

    def particle(self) -> None:
        own = [self.coordinate(LENGTH) for _ in range(self.chance.choice([2, 3]))]
        self.body(self.point("{" + ", ".join([*own, "0"][:3]) + "}"), None)

    def free_solid(self) -> None:
        own = [self.coordinate(LENGTH) for _ in range(3)]
        turned, frame = self.name(), self.name()
        given = self.chance.choice(
            ["", "(rate = {1, 0, 0.5} [rad/s])", "(start = {1, 0, 0, 0})", "(start = {1, 2, 0, 0})"]
        )
        self.items += [
            f"coordinate Orientation {turned}{given};",
            f"frame {frame} = rotate(world, {turned});",
        ]
        self.scope.frames.append((frame, Q))
        place = "{" + ", ".join(own) + "}"
        offset = f" + {self.positive(LENGTH)}*{frame}.x" if self.maybe(0.3) else ""
        self.body(self.point(place + offset), frame)

    def abstract(self) -> None:
        """A coordinate of any type with a kinetic energy of its own."""
        dimension = self.chance.choice([NUMBER, LENGTH, (0, 0, 1, 1), (0, 2, 0, 0), MASS])
        own = self.coordinate(dimension)
        rate = times(dimension, TURN)
        factor = over(over(ENERGY, rate), rate)
        kind = self.chance.choice(["kinetic", "kinetic", "lagrangian"])
        self.items.append(
            f"{kind} {self.name()} = 1/2*{self.positive(factor)}*der({own})^2{self.tail_only()}"
        )

    def chain(self) -> None:
        """An array of links, by a loop."""
        chance = self.chance
        n, th, point, body, i = (self.name() for _ in range(5))
        sine, start = (
            chance.choice(["sin", "cos"]),
            chance.choice(["each start = 0.1 [rad]", "start = 0.2", "each rate = 1"]),
        )
        self.items += [
            f"structural Integer {n} = {chance.choice([1, 2, 3])};",
            f"coordinate Angle {th}[{n}]({start});",
            f"point {point}[0] = {{0, 0, 0}};",
            f"for {i} in 1:{n} loop\n"
            f"  point {point}[{i}] = {point}[{i} - 1]"
            f" + {self.positive(LENGTH)}*{{{sine}({th}[{i}]), 0, -cos({th}[{i}])}};\n"
            f"  body {body}[{i}] = Particle(mass = {self.positive(MASS)}, at = {point}[{i}]);\n"
            "end for;",
        ]
        if sine == "cos":  # on a line: with a mass of its own
            factor = self.positive(INERTIA)
            self.items.append(
                f"for {i} in 1:{n} loop\n"
                f"  kinetic {self.name()}[{i}] = 1/2*{factor}*der({th}[{i}])^2;\n"
                "end for;"
            )
        self._moves(f"{th}[1]", NUMBER)
        self.coordinates.append((f"{th}[1]", NUMBER))
        self.scope.vectors.append(Known(f"{point}[1]", LENGTH, Q))
        self.scope.particles.append(f"{body}[1]")

    # -- laws ---------------------------------------------------------------------------------

    def constraint(self) -> None:
        chance, own = self.chance, self.name()
        places = [k.text for k in self.scope.vectors if k.dimension == LENGTH and k.on == Q]
        bodies = [*self.scope.solids, *self.scope.particles]
        form = chance.choice([*["coordinate"] * 3, *["rate"] * 2, "distance", "velocity", "vector"])
        size, work = LENGTH, ENERGY
        if form == "distance" and places:
            place = chance.choice(places)
            row = f"norm({place}) = {self.positive(LENGTH)}"
        elif form == "rate" and self.coordinates:
            other, dimension = chance.choice(self.coordinates)
            size, work = times(dimension, TURN), POWER
            row = f"der({other}) = {self.scalar(size, MOTION, 1)}"
        elif form == "velocity" and bodies:
            size, work = SPEED, POWER
            row = f"dot(velocity({chance.choice(bodies)}), {self.direction(frozenset('pq'))}) = 0"
        elif form == "vector" and places:
            row = f"{chance.choice(places)} = {self.vector(LENGTH, PLACE, 1)}"
            self.items.append(f"constraint {own}: {row}{self.tail()}")
            return
        elif self.coordinates:
            other, size = chance.choice(self.coordinates)
            row = f"{other} = {self.scalar(size, PLACE, 2)}"
        else:
            return
        self.items.append(f"constraint {own}: {row}{self.tail()}")
        self.rows.append((own, over(work, size)))

    def action(self) -> None:
        chance, own = self.chance, self.name()
        bodies = [*self.scope.solids, *self.scope.particles]
        kinds = ["potential", "potential", "dissipation", "lagrangian", "kinetic"]
        kind = chance.choice([*kinds, "force", "force", "gravity"] if bodies else kinds)
        if kind == "torque" or (self.scope.solids and self.maybe(0.2)):
            kind = "torque"
            ends = self.scope.solids
            origin = f" from {chance.choice(ends)}" if self.maybe(0.3) else ""
            load = f"{self.vector(ENERGY, MOTION, 2, False)} on {chance.choice(ends)}{origin}"
            self.items.append(f"torque {own} = {load}{self.tail()}")
        elif kind == "gravity":
            given = chance.choice(
                ["", "(g = 9.81 [m/s2])", f"(direction = {{0, {self.number()}, -1}})", "(g = 0)"]
            )
            self.items.append(f"Gravity {own}{given}{self.tail_only()}")
            return
        elif kind == "force":
            body, force = chance.choice(bodies), self._load()
            if body in self.scope.solids and self.maybe(0.4):
                place = f"position({body})"
                where = f"on {body} at {place}" + chance.choice(["", f" from {chance.choice(bodies)}"])
            else:
                where = f"at {body}"
            self.items.append(f"force {own} = {force} {where}{self.tail()}")
        elif kind == "potential":
            self.items.append(f"potential {own} = {self.scalar(ENERGY, PLACE, 3)}{self.tail()}")
        else:
            rates = [k for k in self.scope.scalars if k.on == V]
            if not rates:
                return
            rate = chance.choice(rates)
            if kind == "lagrangian":
                factor = self.scalar(over((1, 2, -2, 0), rate.dimension), PLACE, 2)
                self.items.append(f"lagrangian {own} = {factor}*{rate.text}{self.tail()}")
            else:
                square = over(
                    over(POWER if kind == "dissipation" else ENERGY, rate.dimension), rate.dimension
                )
                self.items.append(f"{kind} {own} = 1/2*{self.positive(square)}*{rate.text}^2{self.tail()}")
                if kind == "kinetic":
                    return
        self.actions.append(own)

    def _load(self) -> str:
        """A force, that may depend on the motion and on inputs, and may jump."""
        bodies = [*self.scope.solids, *self.scope.particles]
        if self.maybe(0.3):
            body = self.chance.choice(bodies)
            factor = self.positive((1, 0, -1, 0))
            return self.chance.choice(
                [
                    f"-{factor}*velocity({body})",
                    f"-{self.positive((1, -1, 0, 0))}*norm(velocity({body}))*velocity({body})",
                ]
            )
        return self.vector(FORCE, MOTION | {"o"}, 2, smooth=False)
