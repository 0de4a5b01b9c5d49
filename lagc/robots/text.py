"""The text of a model that has the motion of a `Robot`."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from textwrap import wrap

from lagc.base.text import one_line
from lagc.diagnostics.faults import Source
from lagc.robots.robot import GROUND, Body, Coupling, Joint, Robot, Rounding, Vector

UNITS = {
    "Revolute": ("angle", "rad", "N.m", "Torque", "kg.m2"),
    "Prismatic": ("slide", "m", "N", "Force", "kg"),
}
RATES = {"Spherical": ("orientation.rate.x", "orientation.rate.y", "orientation.rate.z")}
WIDTH = 96  # of a line
ROUNDOFF = 1e-14  # a change that is not worth a note
WORDS = ("world", "time", "field", "gravity", "damping", "robot")


class Names:
    """Names of the language, one for each name of the robot, in the order in which they are asked for."""

    def __init__(self) -> None:
        from lagc.syntax.lalr_tables import tables

        self.taken = {*WORDS, *tables().keywords}
        self.known: dict[str, str] = {GROUND: "world"}

    def fresh(self, name: str, kind: str = "") -> str:
        """Return a new name like `name`; the `kind` follows if the language or the robot has it already."""
        plain = re.sub(r"_+", "_", re.sub(r"[^A-Za-z0-9_]", "_", name)).strip("_")
        base = plain if plain[:1].isalpha() else f"n{plain}"
        found = f"{base}_{kind}" if kind and base in self.taken else base
        number = 1
        while found in self.taken:
            number += 1
            found = f"{base}_{number}"
        self.taken.add(found)
        return found

    def of(self, kind: str, name: str) -> str:
        """Return the name of a body or joint."""
        key = f"{kind} {name}" if name else GROUND
        if key not in self.known:
            self.known[key] = self.fresh(name, kind)
        return self.known[key]


def model(robot: Robot, exact: bool) -> str:
    """Return the text, formatted.  The changes by rounding are added to `robot.notes`."""
    from lagc.syntax.formatter import format_source

    return format_source(Source("robot.lag", _Writer(robot, exact).text()))


class _Writer:
    def __init__(self, robot: Robot, exact: bool):
        self.robot, self.rounding, self.names = robot, Rounding(robot, exact), Names()
        words = re.split(r"[^A-Za-z0-9]+", robot.name)
        title = "".join(word[:1].upper() + word[1:] for word in words)
        self.title = title if title[:1].isalpha() else f"Robot{title}"
        self.names.taken.add(self.title)
        for body in robot.bodies:
            self.names.of("body", body.name)
        for joint in robot.joints:
            self.names.of("joint", joint.name)

    def text(self) -> str:
        robot = self.robot
        body = [line for lines in (self._bodies(), self._joints(), self._couplings(), self._motors(),
                                   self._effects()) for line in lines]  # fmt: skip
        largest = {what: change for what, change in self.rounding.largest.items() if change > ROUNDOFF}
        if largest:
            changes = ", ".join(f"{what} by up to {change:.1e}" for what, change in largest.items())
            robot.notes.append(f"rounded: {changes}")
        origin = f"Imported from {os.path.basename(robot.source)}."
        head = [f"// {row}" for note in (origin, *robot.notes) for row in wrap(one_line(note), WIDTH)]
        opening = f'model {self.title} "{_quoted(robot.name)}"'
        return (
            "\n".join([*head, opening, *(f"  {line}".rstrip() for line in body), f"end {self.title};"]) + "\n"
        )

    def _bodies(self) -> Iterator[str]:
        for body in self.robot.bodies:
            yield f"body {self.names.of('body', body.name)} = {self._solid(body)};"

    def _solid(self, body: Body) -> str:
        rows = self.rounding.inertia(body.inertia)
        flat = not any(rows[i][j] for i in range(3) for j in range(3) if i != j)
        inertia = _listed([rows[k][k] for k in range(3)]) if flat else _braces(map(_listed, rows))
        mass, com = self.rounding.number(body.mass), self.rounding.place(body.com)
        return f"Solid(mass = {_number(mass)} [kg], com = {_listed(com)} [m], inertia = {inertia} [kg.m2])"

    def _joints(self) -> Iterator[str]:
        yield ""
        yield "// The drawing has all coordinates of the joints at zero."
        for joint in self.robot.joints:
            given = [self.names.of("body", joint.parent), self.names.of("body", joint.child)]
            if joint.axis is not None:
                given.append(f"axis = {self._axis(joint.axis)}")
            if joint.at is not None and joint.kind != "Prismatic":
                given.append(f"at = {_listed(self.rounding.place(joint.at))} [m]")
            if joint.start:
                member, unit, *_ = UNITS[joint.kind]
                given.append(f"{member}(start = {_number(self.rounding.number(joint.start))} [{unit}])")
            name = self.names.of("joint", joint.name)
            if joint.note:
                yield f"// {name}: {one_line(joint.note)}"
            yield f"joint {name} = {joint.kind}({', '.join(given)});"

    def _axis(self, axis: Vector, frame: str = "world") -> str:
        """Return a direction of the drawing in the axes of a frame that has those of the world there."""
        numbers = self.rounding.axis(axis)
        terms = [(x, f"{frame}.{name}") for x, name in zip(numbers, "xyz") if x]
        if frame == "world" and len(terms) > 1:
            return _listed(numbers)
        spelled = [
            name if x == 1.0 else f"-{name}" if x == -1.0 else f"{_number(x)}*{name}" for x, name in terms
        ]
        return " + ".join(spelled).replace("+ -", "- ")

    def _coordinate(self, joint: Joint) -> str:
        return f"{self.names.of('joint', joint.name)}.{UNITS[joint.kind][0]}"

    def _couplings(self) -> Iterator[str]:
        joints = {joint.name: joint for joint in self.robot.joints}
        for coupling in self.robot.couplings:
            follower = joints[coupling.follower]
            name = self.names.fresh(coupling.name)
            yield f"constraint {name}: {self._coordinate(follower)} = {self._polynomial(coupling, joints)};"

    def _polynomial(self, coupling: Coupling, joints: dict[str, Joint]) -> str:
        """Return the polynomial in the coordinate of the leader, with the unit of the follower."""
        own = UNITS[joints[coupling.follower].kind][1]
        first, *others = [self.rounding.number(c) for c in coupling.coefficients]
        terms = [f"{_number(first)} [{own}]"] if first or not any(others) else []
        if any(others):
            leader = joints[coupling.leader]
            unit, q = UNITS[leader.kind][1], self._coordinate(leader)
            for power, c in enumerate(others, 1):
                is_plain = own == unit and power == 1
                raised = f"^{power}" if power > 1 else ""
                factor = "" if is_plain else f" [{own}/{unit}{raised[1:]}]"
                if c and is_plain and abs(c) == 1.0:
                    terms.append(q if c > 0.0 else f"-{q}")
                elif c:
                    terms.append(f"{_number(c)}{factor}*{q}{raised}")
        return " + ".join(terms).replace("+ -", "- ")

    def _motors(self) -> Iterator[str]:
        driven = [joint for joint in self.robot.joints if joint.driven and joint.kind in UNITS]
        if driven:
            yield ""
            yield "// Motors"
        for joint in driven:
            name, quantity = self.names.of("joint", joint.name), UNITS[joint.kind][3]
            given = self.names.fresh(f"{'tau' if quantity == 'Torque' else 'f'}_{name}")
            yield f"input {quantity} {given} = 0;"
            child, parent = [self.names.of("body", b) for b in (joint.child, joint.parent)]
            axis = self._axis(joint.axis, f"{child}.frame")
            along = f"{given}*({axis})" if " " in axis else f"{given}*{axis}".replace("*-", "*")
            sign = "-" if axis.startswith("-") and " " not in axis else ""
            place = f"on {child}" + (f" at {child}" if quantity == "Force" else "")
            counter = "" if joint.parent == GROUND else f" from {parent}"
            yield f"{quantity.lower()} {self.names.fresh(f'motor_{name}')} = {sign}{along} {place}{counter};"

    def _effects(self) -> Iterator[str]:
        effects = ["gravity"]
        yield ""
        yield from self._kinetic()
        yield "effect gravity"
        yield f"  {self._gravity()}"
        yield "end gravity;"
        losses = [*self._losses()]
        if losses:
            effects.append("damping")
            yield ""
            yield "effect damping"
            yield from (f"  {line}" for line in losses)
            yield "end damping;"
        yield ""
        yield f"scene robot uses {', '.join(effects)}"
        yield "  simulate(stop = 2 [s]);"
        yield "end robot;"

    def _gravity(self) -> str:
        g = [float(x) for x in self.robot.gravity]
        size = sum(x * x for x in g) ** 0.5
        direction = (
            _listed([self.rounding.number(x / size) if size else 0.0 for x in g]) if size else "-world.z"
        )
        return f"Gravity field(g = {_number(self.rounding.number(size))} [m/s2], direction = {direction});"

    def _kinetic(self) -> Iterator[str]:
        """Return rotors and springs, which are there in every scene."""
        lines = [line for joint in self.robot.joints for line in self._stored(joint)]
        yield from [*lines, ""] if lines else []

    def _stored(self, joint: Joint) -> Iterator[str]:
        """Return the energies of a joint beside those of bodies."""
        name = self.names.of("joint", joint.name)
        rates, inertia, stiffness = self._rates(joint)
        if joint.armature:
            own = self.names.fresh(f"rotor_{name}")
            value = f"{_number(self.rounding.number(joint.armature))} [{inertia}]"
            yield f"kinetic {own} = 1/2*{value}*{_squares(rates)};"
        if joint.stiffness and joint.kind in UNITS:
            turned, rest = self._coordinate(joint), self.rounding.number(joint.rest)
            if rest:
                turned = f"({turned} - {_number(rest)} [{UNITS[joint.kind][1]}])".replace("- -", "+ ")
            own = self.names.fresh(f"spring_{name}")
            value = f"{_number(self.rounding.number(joint.stiffness))} [{stiffness}]"
            yield f"potential {own} = 1/2*{value}*{turned}^2;"

    def _losses(self) -> Iterator[str]:
        for joint in self.robot.joints:
            if joint.damping:
                name = self.names.of("joint", joint.name)
                rates, _, _ = self._rates(joint)
                unit = "N.s/m" if joint.kind == "Prismatic" else "N.m.s"
                c = self.names.fresh(f"c_{name}")
                yield f"parameter Real[{unit}] {c} = {_number(self.rounding.number(joint.damping))};"
                yield f"dissipation {self.names.fresh(f'loss_{name}')} = 1/2*{c}*{_squares(rates)};"

    def _rates(self, joint: Joint) -> tuple[list[str], str, str]:
        """Return the rates of a joint, and the units of an inertia and of a stiffness along them."""
        name = self.names.of("joint", joint.name)
        if joint.kind in UNITS:
            _, unit, force, _, inertia = UNITS[joint.kind]
            return [f"der({self._coordinate(joint)})"], inertia, f"{force}/{unit}"
        return [f"{name}.{rate}" for rate in RATES.get(joint.kind, ())], "kg.m2", "N.m/rad"


def _squares(rates: list[str]) -> str:
    """Return the sum of the squares of rates, as a factor."""
    text = " + ".join(f"{rate}^2" for rate in rates)
    return text if len(rates) == 1 else f"({text})"


def _listed(values: list[float]) -> str:
    return _braces(map(_number, values))


def _number(value: float) -> str:
    return repr(value).removesuffix(".0")


def _braces(texts: Iterator[str] | map[str]) -> str:
    return "{" + ", ".join(texts) + "}"


def _quoted(text: str) -> str:
    return one_line(text).replace("\\", "/").replace('"', "'")
