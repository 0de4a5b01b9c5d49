"""Frames of an animation: positions and attitudes at times so close that straight lines between them do.

Frames are the recorded points and both sides of each event, so nothing is drawn across an impact. Between
them states are interpolated by the cubic Hermite polynomial of states and rates (E. Hairer, S. P. Norsett,
G. Wanner, *Solving Ordinary Differential Equations I*, 1993, II.6), until a straight line is as good.
"""

import math
from collections.abc import Callable
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from lagc.reports.animation.places import positions
from lagc.reports.animation.scene import Scene
from lagc.reports.animation.states import Array, Given, of_states, rates_of, values
from lagc.simulation.solution import Solution

Indices: TypeAlias = NDArray[np.intp]

TOLERANCE = 1e-3  # of the scene: the error between two frames
MOST_FRAMES = 16_001
FEW_FRAMES = 200  # fewer are not thinned
TURN = 0.7  # rad between two frames: a turn that counts as an error of the tolerance
REACH = 0.15  # of the scene: the radius of a wheel whose turn is an error
ROUNDING = 1.0 / 131_070  # of the range of a channel


class Frames:
    """Frames of one run: times `t` (n,), states `x` (n, nx), positions `p` (places, 3, n), unit quaternions
    w x y z by place, `q[place]` (n, 4). `error` is the largest distance, relative to the scene, of a place
    from where it is drawn between two frames; `curved_error` is the part that more recorded points avoid."""

    def __init__(self, scene: Scene, run: Solution):
        self.scene, self.run = scene, run
        last = run.times[-1]
        corners = [(t, x) for t, *states in run.corners if t <= last for x in states]
        points = sorted([*corners, *zip(run.times, run.states)], key=lambda point: point[0])
        self.events = {t for t, _ in corners}
        self.t = np.array([t for t, _ in points])
        self.x = np.array([x for _, x in points]).reshape(len(points), -1)
        # The error of straight lines falls with the square of their number, so one refinement by its root
        # is nearly enough. Thinning doubles the distance: fourfold error.
        self.rates = rates_of(run, self.t, self.x)
        self._place()
        straight = self._straight_error()
        self.curved_error = self._curved_error() if straight > TOLERANCE else 0.0
        while straight > TOLERANCE and 2 * len(self.t) <= MOST_FRAMES:
            self._refine(min(math.ceil(math.sqrt(straight / TOLERANCE)), MOST_FRAMES // len(self.t)))
            straight = self._straight_error()
        while 4.0 * straight <= TOLERANCE and len(self.t) > 2 * FEW_FRAMES:
            if not self._thin():
                break
            straight = self._straight_error()
        self.error = straight + self.curved_error + ROUNDING

    @property
    def symbol_values(self) -> Given:
        """The values of all symbols at the frames."""
        return of_states(self.scene.model, self.run, self.t, self.x, self.rates)

    def _place(self) -> None:
        """Compute positions and attitudes of the frames."""
        self.p = positions(self.scene.places, self.symbol_values, len(self.t))
        self.q = self._attitudes(self.symbol_values, len(self.t))

    def _attitudes(self, given: Given, n: int) -> dict[int, Array]:
        found: dict[int, Array] = {}
        for body in self.scene.bodies:
            if body.frame is not None:
                axes = values([node for row in body.frame.axes for node in row], given, n).reshape(3, 3, n)
                found[body.place] = quaternions(axes)
        return found

    def _straight_error(self) -> float:
        """Return the error of straight lines between frames, relative to the scene: a quarter of that between
        every other frame. A turn of `TURN` between two frames counts as the tolerance."""
        before, middle, after = self._triples()
        if not len(middle):
            return 0.0
        moved = (self.p[:, :, before] + self.p[:, :, after]) / 2.0 - self.p[:, :, middle]
        distance = np.linalg.norm(moved, axis=1)
        worst = float(np.nanmax(distance, initial=0.0)) / self.scene.scale / 4.0
        for q in self.q.values():
            cosine = np.abs((q[before] * q[after]).sum(axis=1))
            turn = float(
                np.arccos(np.clip(cosine, 0.0, 1.0)).max(initial=0.0)
            )  # half of that over two frames
            worst = max(worst, TOLERANCE * turn / TURN)
        return worst

    def _triples(self) -> tuple[Indices, Indices, Indices]:
        """Return the indices of frames with neighbours at equal distances in time."""
        middle = np.arange(1, len(self.t) - 1)
        left, right = self.t[middle] - self.t[middle - 1], self.t[middle + 1] - self.t[middle]
        middle = middle[(left > 0.0) & (np.abs(left - right) <= 0.02 * left)]
        return middle - 1, middle, middle + 1

    def _curved_error(self) -> float:
        """Return the error of the Hermite polynomial between frames, relative to the scene: a sixteenth of
        that between every other frame."""
        before, middle, after = self._triples()
        if not len(middle):
            return 0.0
        x, rates = self._between(before, after, np.full(len(middle), 0.5))
        given = of_states(self.scene.model, self.run, self.t[middle], x, rates)
        moved = positions(self.scene.places, given, len(middle)) - self.p[:, :, middle]
        worst = float(np.nanmax(np.linalg.norm(moved, axis=1), initial=0.0)) / self.scene.scale
        for place, q in self._attitudes(given, len(middle)).items():
            cosine = np.abs((q * self.q[place][middle]).sum(axis=1))
            turn = 2.0 * float(np.arccos(np.clip(cosine, 0.0, 1.0)).max(initial=0.0))
            worst = max(worst, REACH * turn)
        return worst / 16.0

    def _between(self, i: Indices, j: Indices, u: Array) -> tuple[Array, Array]:
        """Return states and rates at the parts u of the intervals from frame i to frame j."""
        h, s = (self.t[j] - self.t[i])[:, None], u[:, None]
        a, b = self.x[i], self.x[j]
        da, db = h * self.rates[i], h * self.rates[j]
        x = (a * (1.0 + 2.0 * s) * (1.0 - s) ** 2 + b * s**2 * (3.0 - 2.0 * s)
             + da * s * (1.0 - s) ** 2 - db * s**2 * (1.0 - s))  # fmt: skip
        slope = 6.0 * s * (1.0 - s) * (b - a) + da * (1.0 - s) * (1.0 - 3.0 * s) + db * s * (3.0 * s - 2.0)
        discretes = len(self.run.system.interface.discretes)
        if discretes:
            x[:, -discretes:] = a[:, -discretes:]
        for k in self.run.system.quaternions:
            x[:, k : k + 4] /= np.linalg.norm(x[:, k : k + 4], axis=1)[:, None]
        return x, slope / h

    def _refine(self, parts: int) -> None:
        """Put frames into every interval, which divide it into `parts`."""
        i = np.flatnonzero(np.diff(self.t) > 0.0)
        i = np.repeat(i, parts - 1)
        u = np.tile(np.arange(1, parts) / parts, len(i) // max(parts - 1, 1))
        x, rates = self._between(i, i + 1, u)
        t = self.t[i] + u * (self.t[i + 1] - self.t[i])
        place = np.concatenate([np.arange(len(self.t)), i + u])
        order = np.argsort(place, kind="stable")
        self.t = np.concatenate([self.t, t])[order]
        self.x = np.concatenate([self.x, x])[order]
        self.rates = np.concatenate([self.rates, rates])[order]
        self._place()

    def _thin(self) -> bool:
        """Leave out every other frame, but none at an event; return whether any is left out."""
        plain = [k for k, t in enumerate(self.t.tolist()) if t not in self.events]
        dropped = set(plain[1:-1:2])
        kept = np.array([k for k in range(len(self.t)) if k not in dropped])
        self.t, self.x, self.rates, self.p = self.t[kept], self.x[kept], self.rates[kept], self.p[:, :, kept]
        self.q = {place: q[kept] for place, q in self.q.items()}
        return bool(dropped)


def quaternions(axes: Array) -> Array:
    """Return unit quaternions w x y z, (n, 4), of rotation matrices (3, 3, n), without jumps of the sign (I.
    Y. Bar-Itzhack, *New Method for Extracting the Quaternion from a Rotation Matrix*, 2000)."""
    m = np.moveaxis(axes, 2, 0)
    n = len(m)
    k = np.empty((n, 4, 4))
    xx, yy, zz = m[:, 0, 0], m[:, 1, 1], m[:, 2, 2]
    k[:, 0, 0] = xx + yy + zz
    k[:, 0, 1] = k[:, 1, 0] = m[:, 2, 1] - m[:, 1, 2]
    k[:, 0, 2] = k[:, 2, 0] = m[:, 0, 2] - m[:, 2, 0]
    k[:, 0, 3] = k[:, 3, 0] = m[:, 1, 0] - m[:, 0, 1]
    k[:, 1, 1] = xx - yy - zz
    k[:, 1, 2] = k[:, 2, 1] = m[:, 0, 1] + m[:, 1, 0]
    k[:, 1, 3] = k[:, 3, 1] = m[:, 0, 2] + m[:, 2, 0]
    k[:, 2, 2] = yy - xx - zz
    k[:, 2, 3] = k[:, 3, 2] = m[:, 1, 2] + m[:, 2, 1]
    k[:, 3, 3] = zz - xx - yy
    q: Array = np.linalg.eigh(np.nan_to_num(k))[1][:, :, 3]
    turns = np.sign((q[1:] * q[:-1]).sum(axis=1))
    q[1:] *= np.cumprod(np.where(turns == 0.0, 1.0, turns))[:, None]
    return q


def frames_of(scene: Scene, run: Solution, again: Callable[[int], Solution] | None = None) -> Frames:
    """Return the frames of a run. If its recorded points are too few, `again` repeats it with more."""
    frames = Frames(scene, run)
    if again is None or frames.curved_error <= TOLERANCE or len(run.times) >= MOST_FRAMES:
        return frames
    points = len(run.times) * math.ceil(2.0 * (frames.curved_error / TOLERANCE) ** 0.25)
    return Frames(scene, again(min(points, MOST_FRAMES)))
