"""What the systems of all backends share."""

from __future__ import annotations

from abc import ABC, abstractmethod

from lagc.optimize.program import Interface
from lagc.run.problem import Vector


class CompiledSystem(ABC):
    """The sizes of a System, and those of its functions that give one array."""

    def __init__(self, interface: Interface):
        self.interface = interface
        self.nq, self.nv, self.nz, self.nx = interface.nq, interface.nv, interface.nz, interface.nx
        self.nc, self.nh, self.quaternions = interface.nc, interface.nh, interface.quaternions

    def position(self, t: float, x: Vector) -> list[float]:
        return self._ask("position", self.nh, t, x)

    def velocity(self, t: float, x: Vector) -> list[float]:
        return self._ask("velocity", self.nc, t, x)

    def scales(self, t: float, x: Vector) -> list[float]:
        return self._ask("scales", self.nc, t, x)

    def energies(self, t: float, x: Vector) -> list[float]:
        return self._ask("energies", 3, t, x)

    def outputs(self, t: float, x: Vector) -> list[float]:
        return self._ask("outputs", len(self.interface.outputs), t, x)

    @abstractmethod
    def _ask(self, name: str, length: int, t: float, x: Vector) -> list[float]:
        """The array of `length` that the function `name` of the Program gives at (t, x)."""
