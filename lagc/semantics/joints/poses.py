"""The place of a body."""

from __future__ import annotations

from lagc.base.records import dataclass
from lagc.semantics.model import Frame
from lagc.symbolic.vectors import Vector, add, matvec, sub


@dataclass(frozen=True, slots=True)
class Pose:
    """The place of a body: its point drawn at `drawn` is at `now`; `frame` has the axes of the drawing."""

    frame: Frame
    drawn: Vector
    now: Vector

    def attached(self, point: Vector) -> Vector:
        """Return the place of the point of the body that is drawn at `point`."""
        return add(self.now, matvec(self.frame.axes, sub(point, self.drawn)))

    def along(self, direction: Vector) -> Vector:
        """Return a drawn direction of the body, in world axes."""
        return matvec(self.frame.axes, direction)
