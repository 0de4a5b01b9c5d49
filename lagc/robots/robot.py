"""A robot, drawn in one configuration: bodies, joints, and what belongs to them."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from math import log10, pi
from typing import TYPE_CHECKING, Any, TypeAlias

from lagc.base.records import dataclass, field

if TYPE_CHECKING:
    from lagc.diagnostics.faults import Fault

Vector: TypeAlias = Any  # an array of 3 numbers
Matrix: TypeAlias = Any  # an array of 3 x 3 numbers

GROUND = ""  # the name of the world as a body
DIGITS = 9  # of places and axes, from the size of the robot
PRODUCT = 1e-9  # a product of inertia below this share of its two moments counts as zero
SIGNIFICANT = 12  # digits of masses and moments
PARTS = 12  # of half a turn: angles that are meant to be multiples of one
LEAST_DIGITS = 5  # of such an angle


@dataclass(frozen=True)
class Body:
    """A rigid body in the drawing: its centre of mass, and the inertia about it in the axes of the world."""

    name: str
    mass: float
    com: Vector
    inertia: Matrix


@dataclass(frozen=True)
class Joint:
    """A joint between two bodies; `kind` is that of lagc.  Numbers are in SI units."""

    name: str
    kind: str
    parent: str
    child: str
    axis: Vector | None = None
    at: Vector | None = None
    damping: float = 0.0
    armature: float = 0.0  # inertia or mass that its rate moves beside the bodies
    stiffness: float = 0.0
    rest: float = 0.0  # coordinate where its spring has no force
    start: float = 0.0
    driven: bool = True  # a motor acts on it
    note: str = ""  # limits


@dataclass(frozen=True)
class Coupling:
    """A joint that follows another one: q = c[0] + c[1] p + c[2] p^2 + ..., of the coordinates; without
    `leader` q = c[0]."""

    name: str
    follower: str
    leader: str
    coefficients: Sequence[float]


@dataclass
class Robot:
    """A robot; the parent of a joint may be the GROUND.  `notes` say what was rounded, changed or left
    out."""

    name: str
    source: str  # the name of its file
    bodies: list[Body] = field(default_factory=list)
    joints: list[Joint] = field(default_factory=list)
    couplings: list[Coupling] = field(default_factory=list)
    gravity: Vector = (0.0, 0.0, -9.81)
    notes: list[str] = field(default_factory=list)
    warnings: list[Fault] = field(default_factory=list)


def lumped(name: str, parts: Iterable[tuple[float, Vector, Matrix]]) -> Body:
    """Return the body of rigidly connected parts: mass, centre of mass, and inertia about it."""
    import numpy as np

    parts = [part for part in parts if part[0] != 0.0 or part[2].any()]
    mass = sum(part[0] for part in parts)
    if not parts:
        return Body(name, 0.0, np.zeros(3), np.zeros((3, 3)))
    com = sum(m * at for m, at, _ in parts) / mass if mass else parts[0][1]
    inertia = np.zeros((3, 3))
    for m, at, own in parts:
        d = at - com
        inertia += own + m * (d @ d * np.eye(3) - np.outer(d, d))
    return Body(name, float(mass), com, (inertia + inertia.T) / 2.0)


def possible(inertia: Matrix) -> tuple[Matrix, list[float]] | None:
    """Return the nearest inertia that a body has, and the principal moments of the given one, which no body
    has; None if there is nothing to change.  No moment is negative, or exceeds the sum of the two others."""
    import numpy as np

    moments, axes = np.linalg.eigh(inertia)
    least = np.maximum(moments, 0.0)
    least[2] = min(least[2], least[0] + least[1])
    if (moments >= -1e-12 * abs(moments[2])).all() and moments[2] <= least[2] * (1.0 + 1e-9):
        return None
    return axes @ np.diag(least) @ axes.T, [float(moment) for moment in moments]


def meant(text: str) -> float:
    """Return the multiple of pi/12 that a decimal number stands for, if it has enough digits and agrees with
    it in all of them, rounded or cut; else the number."""
    value = float(text)
    digits = re.sub(r"[eE].*", "", text).lstrip("+-").lstrip("0.").replace(".", "")
    decimals = len(text.partition(".")[2])
    near = round(value * PARTS / pi) * pi / PARTS
    if (
        near
        and len(digits) >= LEAST_DIGITS
        and "e" not in text.lower()
        and abs(value - near) < 10.0**-decimals
    ):
        return near
    return value


class Rounding:
    """Rounds places and axes to DIGITS of the robot's size, and remembers the largest change."""

    def __init__(self, robot: Robot, exact: bool):
        places = [abs(x) for joint in robot.joints if joint.at is not None for x in joint.at]
        places += [abs(x) for body in robot.bodies for x in body.com]
        size = max(places, default=0.0)
        self.exact = exact
        self.decimals = DIGITS - (int(log10(size)) if size > 0.0 else 0)
        self.largest = {"places [m]": 0.0, "axes": 0.0}

    def place(self, values: Vector) -> list[float]:
        return self._recorded("places [m]", values, [round(float(x), self.decimals) + 0.0 for x in values])

    def axis(self, values: Vector) -> list[float]:
        """Return a unit vector without components that are round-off."""
        kept = [float(x) if abs(x) > 10.0**-DIGITS else 0.0 for x in values]
        length = sum(x * x for x in kept) ** 0.5
        return self._recorded("axes", values, [x / length for x in kept])

    def _recorded(self, what: str, values: Vector, rounded: list[float]) -> list[float]:
        """Return the rounded values, after a look at how much they change, or the exact ones."""
        exact = [float(x) + 0.0 for x in values]
        if self.exact:
            return exact
        self.largest[what] = max(self.largest[what], *(abs(a - b) for a, b in zip(rounded, exact)))
        return rounded

    def number(self, value: float) -> float:
        """Return a mass, moment or coefficient with SIGNIFICANT digits."""
        return float(value) if self.exact else float(f"{value:.{SIGNIFICANT}g}")

    def inertia(self, matrix: Matrix) -> list[list[float]]:
        """Return the rows of an inertia without products that are round-off."""
        found = [[self.number(x) for x in row] for row in matrix]
        for i in range(3):
            for j in range(3):
                small = abs(matrix[i][j]) < PRODUCT * abs(matrix[i][i] * matrix[j][j]) ** 0.5
                if i != j and small and not self.exact:
                    found[i][j] = 0.0
        return found
