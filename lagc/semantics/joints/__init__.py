"""Joints: the table of kinds, the places of the bodies that they tie, and their equations.

The kinds are those of ISO 3952-1.  A joint has an axis z, a direction x across it and y = z x x, drawn with
its first body.  The second body moves against the first by slides along these axes, then by turns.  The
equations of a joint that closes a loop are the slides and turns that it does not allow.
"""

from __future__ import annotations

from collections.abc import Mapping

from lagc.base.records import dataclass, field
from lagc.semantics.model import Frame
from lagc.symbolic.vectors import Vector, add, matvec, sub

ENDS = ("a", "b")
NO_TURN, ABOUT_Z, ABOUT_Z_AND_X, ANY_TURN = range(4)


@dataclass(frozen=True, slots=True)
class Pair:
    """A pair of bodies: `slides` are coordinates by axis, `turns` those of the rotation. In a `helical` pair
    the turn about z slides the body along z, by the pitch each time round."""

    parameters: tuple[str, ...]
    required: int
    slides: Mapping[str, str] = field(default_factory=dict)
    turns: int = NO_TURN
    angles: tuple[str, ...] = ()
    helical: bool = False

    @property
    def coordinates(self) -> dict[str, str]:
        """Return the type of each coordinate of an open joint."""
        turned = (
            {"orientation": "Orientation"} if self.turns == ANY_TURN else dict.fromkeys(self.angles, "Angle")
        )
        return {**dict.fromkeys(self.slides.values(), "Length"), **turned}

    @property
    def torsor(self) -> str:
        """The force and the moment that the pair can transmit without friction, in its axes x, y, z."""
        force = ", ".join(["0" if axis in self.slides else letter for axis, letter in zip("xyz", "XYZ")])
        moment = ("L, M, N", "L, M, 0", "0, M, 0", "0, 0, 0")[self.turns]
        return f"{force} | {moment if not self.helical else 'L, M, -Z*pitch/(2*pi)'}"


@dataclass(frozen=True, slots=True)
class Condition:
    """A joint without coordinates of its own, which ties bodies that have a place, or joints."""

    parameters: tuple[str, ...]
    required: int
    ties: str = "body"
    torsor: str = ""
    coordinates: Mapping[str, str] = field(default_factory=dict)


_AXIS, _POINT = (*ENDS, "axis", "at", "along"), (*ENDS, "at")
_SLIDE, _XY = {"z": "slide"}, {"x": "x", "y": "y"}

KINDS: dict[str, Pair | Condition] = {
    "Weld": Pair(_POINT, 2),
    "Revolute": Pair((*_AXIS, "friction", "static", "radius"), 4, turns=ABOUT_Z, angles=("angle",)),
    "Prismatic": Pair((*_AXIS, "friction", "static"), 3, _SLIDE),
    "Cylindrical": Pair(_AXIS, 4, _SLIDE, ABOUT_Z, ("angle",)),
    "Screw": Pair((*ENDS, "axis", "at", "pitch", "along"), 5, turns=ABOUT_Z, angles=("angle",), helical=True),
    "Spherical": Pair(_POINT, 3, turns=ANY_TURN),
    "Universal": Pair(_AXIS, 5, turns=ABOUT_Z_AND_X, angles=("angle1", "angle2")),
    "Planar": Pair(_AXIS, 4, _XY, ABOUT_Z, ("angle",)),
    "PointOnPlane": Pair(_AXIS, 4, _XY, ANY_TURN),
    "LineOnPlane": Pair(_AXIS, 5, _XY, ABOUT_Z_AND_X, ("angle", "tilt")),
    "PointOnLine": Pair(_AXIS, 4, _SLIDE, ANY_TURN),
    "Free": Pair(_POINT, 2, {"x": "x", "y": "y", "z": "z"}, ANY_TURN),
    "Distance": Condition((*ENDS, "at", "to"), 4, torsor="X, 0, 0 | 0, 0, 0"),
    "Rolling": Condition((*ENDS, "normal", "at", "radius", "axis", "along"), 5, torsor="X, Y, Z | 0, 0, 0"),
    "Gear": Condition((*ENDS, "ratio"), 3, "joint"),
    "RackAndPinion": Condition((*ENDS, "radius"), 3, "joint"),
}


@dataclass(frozen=True, slots=True)
class Pose:
    """The place of a body: its point drawn at `drawn` is at `now`; `frame` has the axes of the drawing."""

    frame: Frame
    drawn: Vector
    now: Vector

    def place_of(self, point: Vector) -> Vector:
        """Return the place of the point of the body that is drawn at `point`."""
        return add(self.now, matvec(self.frame.axes, sub(point, self.drawn)))

    def direction_of(self, direction: Vector) -> Vector:
        """Return a drawn direction of the body, in world axes."""
        return matvec(self.frame.axes, direction)
