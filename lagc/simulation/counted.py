"""A system whose evaluations beside integrations are counted: what verifies a run is a part of its cost."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from lagc.simulation.system import System, Vector


class Counted:
    """`system` with its functions, and how often rates or energies were asked of it."""

    def __init__(self, system: System):
        self.system, self._counts = system, [0]

    @property
    def evaluations(self) -> int:
        return self._counts[0]

    def bind(self, values: Sequence[float]) -> Counted:
        """The system with other parameters; what it does counts here."""
        return self._beside(self.system.bind(values))

    def on(self, t: float, x: Vector) -> Counted:
        """The system on the branch of (t, x); what it does counts here."""
        return self._beside(self.system.on(t, x))

    def _beside(self, system: System) -> Counted:
        found = Counted(system)
        found._counts = self._counts
        return found

    def __getattr__(self, name: str) -> Any:
        return getattr(self.system, name)

    def rhs(self, t: float, x: Vector, xdot: list[float], lam: list[float]) -> int:
        self._counts[0] += 1
        return self.system.rhs(t, x, xdot, lam)

    def rounded(self, t: float, x: Vector, xdot: list[float], lam: list[float], way: int) -> int | None:
        status = self.system.rounded(t, x, xdot, lam, way)
        self._counts[0] += status is not None
        return status

    def energies(self, t: float, x: Vector) -> list[float]:
        self._counts[0] += 1
        return self.system.energies(t, x)
