"""The sensitivities of a run, by the code that follows them.

A model with contacts is followed in each of their modes by a model of its own.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING

from lagc.compiler.loaded import Loaded
from lagc.simulation.backends.python import NumpySystem
from lagc.simulation.linearization.contact_modes import modes_of
from lagc.simulation.request import Request
from lagc.simulation.sensitivity.sensitivities import Direction, Mode, directions
from lagc.simulation.sensitivity.verified_sensitivities import sensitivities

if TYPE_CHECKING:
    from lagc.lowering.program import Interface
    from lagc.simulation.solution import Solution

Progress = Callable[[float], None]


def directions_of(loaded: Loaded, names: Sequence[str]) -> tuple[Direction, ...]:
    """Return the directions of these names.  Raises Refused for what has none, before a run."""
    own = loaded.artifact
    return directions(own.interface, names, own.unused, own.built_in)


def add_sensitivities(
    loaded: Loaded, run: Solution, request: Request, parameters: Sequence[float], progress: Progress | None
) -> None:
    """Add the sensitivities of `request` to `run`, which has these parameters and inputs."""
    complete, whole = request.completed(loaded.artifact.interface.simulate), None
    if loaded.artifact.interface.contacts:
        system = loaded.system("numpy").bind(parameters)
        assert isinstance(system, NumpySystem)
        whole = Mode(system, run.system, directions_of(loaded, request.sensitivity))
    modes = _Modes(loaded, request.sensitivity, run.system.backend, parameters)
    sensitivities(modes, whole, run, complete, progress)


class _Modes:
    """The code of a motion in the modes of its contacts: for each a model of its own, with what touches as
    constraints and loads. It is compiled when a state in these modes is first asked for."""

    def __init__(self, loaded: Loaded, names: Sequence[str], backend: str, parameters: Sequence[float]):
        self.loaded, self.names, self.backend, self.parameters = loaded, names, backend, parameters
        self.found = dict[tuple[int, ...], Mode]()

    def __call__(self, x: Sequence[float]) -> Mode:
        held = modes_of(self.loaded.artifact.interface, x)
        if held not in self.found:
            self.found[held] = self._mode(held) if held else self._without_contacts()
        return self.found[held]

    def _without_contacts(self) -> Mode:
        system = self.loaded.differentiated.model.bind(self.parameters)
        followed = self.loaded.sensitive(self.backend).bind(self.parameters)
        return Mode(system, followed, directions_of(self.loaded, self.names))

    def _mode(self, held: tuple[int, ...]) -> Mode:
        own, system = self.loaded.artifact, self.loaded.in_contact_modes(held)
        followed = self.loaded.sensitive(self.backend, held)
        # Parameters and inputs may reach nothing in these modes: directions by them are zero.
        used = {f.name for f in (*system.interface.parameters, *system.interface.inputs)}
        fields = (*own.unused, *own.interface.parameters, *own.interface.inputs)
        unused = [field for field in fields if field.name not in used]
        known = _by_name(own.interface, self.parameters)
        return Mode(
            system.model.bind(_values(system.interface, known)),
            followed.bind(_values(followed.interface, known)),
            directions(system.interface, self.names, unused, own.built_in),
        )


def _by_name(interface: Interface, values: Sequence[float]) -> dict[str, float]:
    return {f.name: value for f, value in zip((*interface.parameters, *interface.inputs), values)}


def _values(interface: Interface, known: Mapping[str, float]) -> list[float]:
    return [known[f.name] for f in (*interface.parameters, *interface.inputs)]
