"""Where runs are compared: at the times that are asked for, and between these where they are few.

Two runs may err alike at one time or two by chance; all along the motion they seldom do.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import ceil

from lagc.simulation.system import Trajectory

ENOUGH = 32  # parts of the time, at whose ends runs are compared at least


class Watched:
    """`times` are all of them, in order."""

    def __init__(self, asked: Sequence[float]):
        self.parts = parts = ceil(
            ENOUGH / max(len(asked) - 1, 1)
        )  # of the time between two that are asked for
        self.times = [a + (b - a) * (k / parts) for a, b in pairwise(asked) for k in range(parts)]
        self.times += asked[-1:]

    def told(self, run: Trajectory) -> Trajectory:
        """`run` at the times that are asked for."""
        if self.parts == 1:
            return run
        return run.changed(times=run.times[:: self.parts], states=run.states[:: self.parts])
