"""Well-typed random models, by a seed: what the language can say, in names and numbers nobody would choose.

Dimensions are right by construction, and what moves has inertia; most pass `lagc check`.
Random derivations of the grammar, such as those of `hypothesis.extra.lark`, do not: of 300 none did.
"""

from __future__ import annotations

import random
from collections.abc import Callable
from dataclasses import dataclass, field

from tests.fuzz.declarations import KEPT, Writer
from tests.fuzz.expressions import GIVEN, MOTION, PLACE, Scope
from tests.fuzz.words import NUMBER, TIME, TURN, description, name, times


@dataclass(frozen=True)
class Case:
    """A model text with the files that it imports, and words for the commands that run it."""

    text: str
    files: dict[str, str] = field(default_factory=dict)
    options: tuple[str, ...] = ()  # of every command that takes a model
    run: tuple[str, ...] = ()  # of `sim`


def model(seed: int) -> Case:
    """The model of this seed."""
    chance = random.Random(seed)
    return _File(chance).case()


class _File:
    def __init__(self, chance: random.Random):
        self.chance = chance
        self.wild = chance.choice([0, 0, 0, 0, 0.02, 0.2])
        self.nasty = chance.choice([0.05, 0.3, 0.9])
        self.names: set[str] = {"world", "time", "pi"}
        self.head: list[str] = []
        self.files: dict[str, str] = {}

    def case(self) -> Case:
        chance = self.chance
        scope = Scope()
        if chance.random() < 0.15:
            own = name(chance, self.names, self.nasty)
            self.head.append(f"constant Real {own} = {chance.choice(['2', 'pi/2', '1e-3'])};")
        for _ in range(chance.choice([0, 0, 0, 1, 2])):
            self.head.append(self.writer(scope).function())
        if chance.random() < 0.1:
            own = name(chance, self.names, self.nasty)
            self.head.append(
                f"type {own} = {chance.choice(['Length', 'Real[kg/m]', 'Angle(min = -4)', 'Mass'])};"
            )
        parts = [self.part(scope) for _ in range(chance.choice([0, 0, 0, 1, 2]))]
        partial = self.part(scope, "partial ") if chance.random() < 0.15 else None
        main = _Model(self, self.writer(scope.copy()))
        text = main.text("", parts, partial)
        head = "\n".join(self.head)
        text = f"{head}\n{text}" if head else text
        return Case(text, self.files, main.options(), main.run())

    def writer(self, scope: Scope, taken: set[str] | None = None) -> Writer:
        return Writer(self.chance, scope, self.wild, self.nasty, self.names if taken is None else taken)

    def part(self, scope: Scope, partial: str = "") -> tuple[str, _Model]:
        """A model for instances (or to be extended), here, in a package or in another file: its name where
        it is used, and what is in it."""
        chance = self.chance
        taken = self.names if partial else set(self.names)
        inner = _Model(self, self.writer(scope.copy(), taken), small=True)
        own = inner.name
        text = inner.text(partial, [], None)
        where = chance.choice(["here", "here", "package", "file", "package in a file"])
        if scope.functions and where != "here":
            where = "here"  # functions of this file are not known in others
        path = own
        if "package" in where:
            package = name(chance, self.names, self.nasty)
            text = f"package {package}{description(chance)}\n{text}end {package};\n"
            path = f"{package}.{own}"
        if "file" in where:
            file = f"{path.split('.')[0]}.lag"
            self.files[file] = text
            ways = [f'"{file}"', path, f"{package}.*", "alias"] if "package" in where else [f'"{file}"']
            way = chance.choice(ways)
            if way == "alias":
                own = name(chance, self.names, self.nasty)
                way = f"{own} = {path}"
            self.head.insert(0, f"import {way};")
            path = path if way.startswith('"') else own
        else:
            self.head.append(text.rstrip("\n"))
        return path, inner


class _Model:
    """One model, written into a Writer."""

    def __init__(self, file: _File, writer: Writer, small: bool = False):
        self.file, self.chance, self.writer, self.small = file, file.chance, writer, small
        self.name = name(file.chance, file.names, file.nasty)
        self.scenes: list[str] = []
        self.effects: list[str] = []  # those of instances too, as scenes name them

    def text(self, partial: str, parts: list[tuple[str, _Model]], base: tuple[str, _Model] | None) -> str:
        writer, chance = self.writer, self.chance
        for dimension in KEPT:
            writer.parameter(dimension)
        self._several(writer.parameter, [0, 1, 2] if self.small else [0, 1, 2, 4])
        if base is not None:
            self._extend(*base)
        self._several(writer.link, [1] if self.small else [1, 1, 2, 3])
        if chance.random() < 0.15:
            writer.chain()
        for path, part in parts:
            self._instance(path, part)
        self._several(writer.speed, [0, 0, 0, 0, 1])
        effects = [] if self.small and chance.random() < 0.7 else self._effects()
        writer.effects = [e for e, _ in effects]
        self.effects += writer.effects
        self._several(writer.constraint, [0, 0, 0, 0, 1, 1, 2])
        self._several(writer.action, [0, 1] if self.small else [0, 1, 2, 3])
        self._several(writer.output, [0] if self.small else [0, 1, 2, 3])
        self.scenes = [] if self.small else self._scenes(self.effects)
        items = [*writer.items, *(text for _, text in effects), *self.scenes]
        if chance.random() < 0.3:
            chance.shuffle(items)
        if not self.small and chance.random() < 0.1:
            items.append(self._initial())
        if chance.random() < 0.1:
            items.append(self._when())
        body = "".join(f"  {line}\n" for item in items for line in item.split("\n"))
        return f"{partial}model {self.name}{description(chance)}\n{body}end {self.name};\n"

    def _several(self, write: Callable[[], None], counts: list[int]) -> None:
        for _ in range(self.chance.choice(counts)):
            write()

    def _extend(self, path: str, base: _Model) -> None:
        given = self._modifications(base)
        self.writer.items.insert(0, f"extends {path}{given};")
        self._take(base.writer.scope, base, "")

    def _instance(self, path: str, part: _Model) -> None:
        own = self.writer.name()
        if self.chance.random() < 0.2:
            self.writer.items.append(f"{path} {own}[2];")
            own = f"{own}[{self.chance.choice([1, 2])}]"
        else:
            self.writer.items.append(f"{path} {own}{self._modifications(part)}{self.writer.tail_only()}")
        self._take(part.writer.scope.within(own), part, f"{own}.")

    def _take(self, scope: Scope, part: _Model, prefix: str) -> None:
        scope.functions = []
        self.writer.scope.add(scope)
        for kind in ("parameters", "coordinates", "speeds", "rows"):
            getattr(self.writer, kind).extend((prefix + own, d) for own, d in getattr(part.writer, kind))
        self.writer.actions.extend(prefix + own for own in part.writer.actions)
        self.effects.extend(prefix + own for own in part.effects)

    def _modifications(self, part: _Model) -> str:
        writer, chance = self.writer, self.chance
        given = [
            f"{own} = {writer.leaf(d, GIVEN, 0.6)}"
            for own, d in part.writer.parameters
            if chance.random() < 0.2
        ]
        given += [
            f"{own}(start = {writer.literal(d)})"
            for own, d in part.writer.coordinates
            if "[" not in own and chance.random() < 0.1
        ]
        return f"({', '.join(given)})" if given else ""

    def _effects(self) -> list[tuple[str, str]]:
        """(name, text)"""
        writer, chance, found = self.writer, self.chance, list[tuple[str, str]]()
        for _ in range(chance.choice([0, 0, 1, 2])):
            own = writer.name()
            inner = self.file.writer(writer.scope.copy(), writer.taken)
            inner.coordinates = list(writer.coordinates)
            self._fill(inner)
            others = [e for e, _ in found]
            if others and chance.random() < 0.3:
                inner.items.insert(0, f"{chance.choice(['requires', 'excludes'])} {chance.choice(others)};")
            body = "".join(f"  {line}\n" for item in inner.items for line in item.split("\n"))
            found.append((own, f"effect {own}{description(chance)}\n{body}end {own};"))
        return found

    def _fill(self, inner: Writer) -> None:
        self._several(inner.parameter, [0, 1])
        self._several(inner.link, [0, 0, 0, 1])
        self._several(inner.action, [1, 2])
        self._several(inner.constraint, [0, 0, 0, 1])
        self._several(inner.output, [0, 0, 1])

    def _scenes(self, effects: list[str]) -> list[str]:
        chance, writer, found = self.chance, self.writer, list[str]()
        for _ in range(chance.choice([0, 1, 1, 2])):
            own = writer.name()
            used = [e for e in effects if chance.random() < 0.6]
            inside = []
            if writer.parameters and chance.random() < 0.3:
                p, d = chance.choice(writer.parameters)
                inside.append(f"parameter {p} = {writer.literal(d)};")
            if writer.coordinates and chance.random() < 0.4:
                q, d = chance.choice(writer.coordinates)
                rate = chance.random() < 0.3
                inside.append(
                    f"start der({q}) = {writer.literal(times(d, TURN))};"
                    if rate
                    else f"start {q} = {writer.literal(d)};"
                )
            if writer.speeds and chance.random() < 0.3:
                u, d = chance.choice(writer.speeds)
                inside.append(f"start {u} = {writer.literal(d)};")
            if chance.random() < 0.5:
                inside.append(chance.choice(SIMULATIONS))
            uses = f" uses {', '.join(used)}" if used else ""
            if inside:
                body = "".join(f"  {line}\n" for line in inside)
                found.append(f"scene {own}{description(chance)}{uses}\n{body}end {own};")
            else:
                found.append(f"scene {own}{description(chance)}{uses};")
        return found

    def _initial(self) -> str:
        writer, chance = self.writer, self.chance
        if writer.coordinates and chance.random() < 0.5:
            q, d = chance.choice(writer.coordinates)
            rate = times(d, TURN)
            return f"initial\nder({q}) = {writer.scalar(rate, MOTION, 1)};"
        return f"initial\n{writer.scalar(NUMBER, PLACE, 1)} = {writer.leaf(NUMBER, GIVEN)};"

    def _when(self) -> str:
        """What is written as a condition, and what is done then."""
        writer, chance = self.writer, self.chance
        given = [
            ("time", TIME),
            *writer.coordinates,
            *((f"der({q})", times(d, TURN)) for q, d in writer.coordinates),
        ]
        parts = []
        for _ in range(chance.choice([1, 1, 2])):
            left, dimension = chance.choice(given)
            parts.append(f"{left} {chance.choice(['<', '<=', '>', '>='])} {writer.leaf(dimension, GIVEN)}")
        lines = []
        for target, dimension in chance.sample(given[1:], min(len(given) - 1, chance.choice([0, 1, 1, 2]))):
            lines.append(f"reinit({target}, {writer.scalar(dimension, MOTION, 1)});")
        if chance.random() < 0.3:
            lines.append('terminate("enough");')
        if chance.random() < 0.3:
            lines.append(f'mark("{chance.choice(["tick", "a b", "*/ %s"])}");')
        return f"when {chance.choice([' and ', ' or ']).join(parts)} then\n{' '.join(lines)}\nend when;"

    def options(self) -> tuple[str, ...]:
        """Words that every command takes."""
        chance, words = self.chance, list[str]()
        for own, _ in self.writer.parameters:
            if chance.random() < 0.02:
                words += ["-p", f"{own}={chance.choice(VALUES)}"]
        return tuple(words)

    def run(self) -> tuple[str, ...]:
        """Words for `sim`, now and then senseless ones."""
        chance, words = self.chance, list[str]()
        for own, _ in (*self.writer.coordinates, *self.writer.speeds):
            if chance.random() < 0.05:
                words += ["--start", f"{own}={chance.choice(VALUES)}"]
        if chance.random() < 0.1:
            words += [chance.choice(["--points", "--every", "--rtol", "--atol"]), chance.choice(VALUES)]
        return tuple(words)


VALUES = [
    "0", "1", "-1", "0.5", "2", "1e-30", "1e30", "1e300", "-0.0", "1e-320", "nan", "inf", "5", "1[m]", "1_0",
    "٣", "",
]  # fmt: skip
SIMULATIONS = [
    "simulate(stop = 0.1 [s]);", "simulate(stop = 1 [ms], points = 5);",
    "simulate(stop = 20 [s], accuracy = 1e-8);",
    "simulate(stop = 0.1, every = 0.01 [s]);", "simulate(stop = 0.01 [s], rtol = 1e-6, atol = 1e-9);",
    "simulate(step = 1e-3 [s], stop = 5e-3);", "simulate(accuracy = 1e-4);",
]  # fmt: skip
