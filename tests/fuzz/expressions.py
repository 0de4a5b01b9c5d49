"""Random expressions of a wanted dimension, over what is known at their place."""

from __future__ import annotations

import random
from dataclasses import dataclass, field, replace

from tests.fuzz.words import LENGTH, NUMBER, SPECIAL, SPEED, TIME, TURN, Dimension, over, times, unit

# What an expression may depend on.
GIVEN = frozenset("p")  # constants, parameters
PLACE = frozenset("pqt")  # coordinates and time too
MOTION = frozenset("pqtv")  # rates and speeds too
SHOWN = frozenset("pqtvao")  # inputs (o for all that only outputs and forces may use), accelerations


@dataclass(frozen=True)
class Known:
    """Something with a value: its text, dimension, and what it depends on."""

    text: str
    dimension: Dimension
    on: frozenset[str]
    positive: bool = False


@dataclass(frozen=True)
class Function:
    """A declared function: the dimensions of its parameters and of its result."""

    name: str
    parameters: tuple[Dimension, ...]
    result: Dimension


@dataclass
class Scope:
    """What is known at a place of a model; points and centres of mass are among the vectors."""

    scalars: list[Known] = field(default_factory=list)
    vectors: list[Known] = field(default_factory=list)
    frames: list[tuple[str, frozenset[str]]] = field(default_factory=list)
    solids: list[str] = field(default_factory=list)
    particles: list[str] = field(default_factory=list)
    functions: list[Function] = field(default_factory=list)

    def copy(self) -> Scope:
        return Scope(*(list(getattr(self, name)) for name in self.__dataclass_fields__))

    def within(self, instance: str) -> Scope:
        """All of it, seen from outside of `instance`."""

        def dotted(known: list[Known]) -> list[Known]:
            return [replace(k, text=_prefixed(k.text, instance)) for k in known]

        return Scope(
            dotted(self.scalars),
            dotted(self.vectors),
            [(f"{instance}.{frame}", on) for frame, on in self.frames],
            [f"{instance}.{body}" for body in self.solids],
            [f"{instance}.{body}" for body in self.particles],
        )

    def add(self, other: Scope) -> None:
        for name in self.__dataclass_fields__:
            getattr(self, name).extend(getattr(other, name))


def _prefixed(text: str, instance: str) -> str:
    function, opening, inside = text.rpartition("(")
    return f"{function}{opening}{instance}.{inside}"


class Expressions:
    """Writes expressions; `wild` is how often a number is a special one."""

    def __init__(self, chance: random.Random, scope: Scope, wild: float):
        self.chance, self.scope, self.wild = chance, scope, wild

    def number(self) -> str:
        chance = self.chance
        if chance.random() < self.wild:
            return chance.choice(SPECIAL)
        return chance.choice(
            ["1", "2", "0.5", "3", "0.1", "1.5", "2e-1", "7", f"{chance.uniform(0.1, 5):.3g}"]
        )

    def literal(self, dimension: Dimension) -> str:
        """A positive number in some unit, SI mostly."""
        chance = self.chance
        if dimension == NUMBER and chance.random() < 0.8:
            return self.number()
        for _ in range(20):
            written = unit(dimension, chance)
            if chance.random() < 0.3 or written in _SI or "." in written:
                break
        return f"{self.number()} [{written}]"

    def leaf(self, dimension: Dimension, on: frozenset[str], literal: float = 0.25) -> str:
        fitting = [k.text for k in self.scope.scalars if k.dimension == dimension and k.on <= on]
        if fitting and self.chance.random() > literal:
            return self.chance.choice(fitting)
        if dimension == TIME and "t" in on and self.chance.random() < 0.3:
            return "time"
        return self.literal(dimension)

    def positive(self, dimension: Dimension) -> str:
        """Of parameters and numbers."""
        fitting = [k.text for k in self.scope.scalars if k.dimension == dimension and k.positive]
        return (
            self.chance.choice(fitting) if fitting and self.chance.random() < 0.8 else self.literal(dimension)
        )

    def scalar(self, dimension: Dimension, on: frozenset[str], depth: int = 2, smooth: bool = True) -> str:
        """An expression of `dimension` that depends on no more than `on`; without kinks where `smooth`.
        It is closed: a factor of a product may be made of it."""
        chance = self.chance
        if depth <= 0 or chance.random() < 0.15:
            return self.leaf(dimension, on)

        def again(wanted: Dimension = dimension) -> str:
            return self.scalar(wanted, on, depth - 1, smooth)

        forms = [
            "sum", "sum", "scaled", "product", "product", "quotient", "vector", "function", "square", "call",
        ]  # fmt: skip
        form = chance.choice(forms if smooth else [*forms, "kink", "condition"])
        if form == "sum":
            return f"({again()} {chance.choice('+-')} {again()})"
        if form == "scaled":
            return chance.choice(
                [f"{self.number()}*{again()}", f"(-{again()})", f"(+{again()})", f"{again()}/2"]
            )
        if form == "product":
            known = [k for k in self.scope.scalars if k.on <= on]
            if known:
                one = chance.choice(known)
                return f"{one.text}*{self.leaf(over(dimension, one.dimension), on, 0.6)}"
        if form == "quotient":
            one = chance.choice([LENGTH, TIME, NUMBER])
            return f"({again(times(dimension, one))}/{self.positive(one)})"
        if form == "vector":
            return self._of_vector(dimension, on, depth, smooth)
        if form == "function" and dimension == NUMBER:
            return self._function(again, on)
        if form == "square" and not any(exponent % 2 for exponent in dimension):
            a, b, c, d = (exponent // 2 for exponent in dimension)
            return f"{self.leaf((a, b, c, d), on)}^2"
        if form == "square":
            root = again(times(dimension, dimension)), self.literal(times(dimension, dimension))
            return f"sqrt(({root[0]})^2/{root[1]} + {root[1]})"
        if form == "call":
            fitting = [f for f in self.scope.functions if f.result == dimension]
            if fitting:
                called = chance.choice(fitting)
                return f"{called.name}({', '.join(again(d) for d in called.parameters)})"
        if form == "kink":
            return self._kink(again, dimension, on)
        if form == "condition":
            return f"(if {self._condition(on, depth - 1)} then {again()} else {again()})"
        return self.leaf(dimension, on)

    def _function(self, again: object, on: frozenset[str]) -> str:
        assert callable(again)
        chance = self.chance
        one = chance.choice([LENGTH, SPEED, NUMBER])
        return chance.choice([
            f"sin({again()})", f"cos({again()})", f"tanh({again()})", f"atan({again()})",
            f"exp(-({again()})^2)", f"log(2 + sin({again()}))", f"log10(3 + cos({again()}))",
            f"sqrt(1 + ({again()})^2)", f"atan2({self.leaf(one, on)}, {self.literal(one)})",
            f"asin(0.9*sin({again()}))", f"acos(0.5*cos({again()}))", f"sinh(sin({again()}))",
            f"cosh(tanh({again()}))", f"tan(0.5*sin({again()}))", f"(1 + ({again()})^2)^(-1)",
            f"{again()}^3", f"(1 + ({again()})^2)^0.5", f"(2 + sin({again()}))^sin({again()})",
            f"1/(2 + sin({again()}))",
        ])  # fmt: skip

    def _kink(self, again: object, dimension: Dimension, on: frozenset[str]) -> str:
        assert callable(again)
        chance = self.chance
        found = [
            f"abs({again()})", f"min({again()}, {again()})", f"max({again()}, {again()}, 0)",
            f"max({again()}, 0)", f"sign({self.leaf(LENGTH, on)})*{again()}",
            f"sum({{{again()}, {again()}}})", f"sum({{each_one*{again()} for each_one in 1:2}})",
            f"sum(each_one*{again()} for each_one in {self.chance.choice(['1:3', '2:1', '2:-1:1'])})",
            f"mod({again()}, {self.literal(dimension)})", f"max({{{again()}, {again()}}})",
        ]  # fmt: skip
        if dimension == NUMBER:
            found += [f"floor({again()})", f"ceil({again()})", "size({1, 2, 3})"]
        return chance.choice(found)

    def _condition(self, on: frozenset[str], depth: int) -> str:
        chance = self.chance
        if depth > 0 and chance.random() < 0.4:
            a, b = self._condition(on, depth - 1), self._condition(on, depth - 1)
            return chance.choice([f"({a} and {b})", f"({a} or {b})", f"not ({a})"])
        if chance.random() < 0.05:
            return chance.choice(["true", "false"])
        dimension = chance.choice([LENGTH, NUMBER, TIME])
        relation = chance.choice(["<", ">", "<=", ">="])
        return f"{self.leaf(dimension, on)} {relation} {self.leaf(dimension, on, 0.6)}"

    def _of_vector(self, dimension: Dimension, on: frozenset[str], depth: int, smooth: bool) -> str:
        chance = self.chance
        vector = self.vector(dimension, on, depth - 1, smooth)
        if chance.random() < 0.4:
            return f"dot({vector}, {self.direction(on)})"
        if chance.random() < 0.3 and not smooth:
            return f"norm({vector})"
        return f"({vector}){chance.choice(['.x', '.y', '.z', '[1]', '[2]', '[3]'])}"

    def direction(self, on: frozenset[str]) -> str:
        """A unit vector."""
        chance = self.chance
        frames = [text for text, depends in self.scope.frames if depends <= on]
        if frames and chance.random() < 0.6:
            return f"{chance.choice(frames)}.{chance.choice('xyz')}"
        return chance.choice(
            ["world.x", "world.y", "world.z", "{0, 0, 1}", "{1, 0, 0}", "normalize({1, 2, 2})"]
        )

    def vector(self, dimension: Dimension, on: frozenset[str], depth: int = 2, smooth: bool = True) -> str:
        """Closed, as `scalar` is."""
        chance = self.chance

        def part(deeper: int = 1) -> str:
            return self.scalar(dimension, on, depth - deeper, smooth)

        fitting = [k.text for k in self.scope.vectors if k.dimension == dimension and k.on <= on]
        if fitting and chance.random() < 0.5:
            return chance.choice(fitting)
        if dimension in (SPEED, TURN) and on >= MOTION:
            moving = [f"velocity({body})" for body in (*self.scope.solids, *self.scope.particles)]
            turning = [f"angular_velocity({b})" for b in self.scope.solids]
            turning += [f"angular_velocity({text})" for text, depends in self.scope.frames if depends <= on]
            found = moving if dimension == SPEED else turning
            if found:
                return chance.choice(found)
        form = chance.choice(["parts", "parts", "along", "along", "sum", "scaled", "cross", "unit"])
        if depth <= 0 or form == "parts":
            return f"{{{part()}, {part()}, {part()}}}"
        if form == "unit":
            a, b, c = self.number(), self.number(), self.number()
            return f"{{{a}, -{b}, {c}}} [{unit(dimension, chance)}]"
        if form == "sum":
            a, b = (self.vector(dimension, on, depth - 1, smooth) for _ in "ab")
            return f"({a} {chance.choice('+-')} {b})"
        if form == "scaled":
            factor = self.scalar(NUMBER, on, depth - 1, smooth)
            return f"{factor}*{self.vector(dimension, on, depth - 1, smooth)}"
        if form == "cross":
            return f"cross({self.direction(on)}, {self.vector(dimension, on, depth - 1, smooth)})"
        return f"{part()}*{self.direction(on)}"


_SI = frozenset(
    {"kg", "m", "s", "N", "J", "W", "m/s", "rad/s", "1/s", "rad", "m/s2", "C", "N/m", "N.s/m", "kg.m2"}
)
