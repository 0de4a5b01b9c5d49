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
    # Without contacts the motion and its derivatives are those of the model itself.
    own = loaded.artifact
    complete, wanted = request.completed(own.interface.simulate), directions_of(loaded, request.sensitivity)
    if not own.interface.contacts:
        followed = loaded.sensitive(run.system.backend).bind(parameters)
        mode = Mode(loaded.differentiated.model.bind(parameters), followed, wanted)
        sensitivities(lambda x: mode, None, run, complete, progress)
        return
    # With contacts each of their modes is a model of its own, with what touches as constraints and loads.
    known, modes = _by_name(own.interface, parameters), dict[tuple[int, ...], Mode]()

    def mode_of(x: Sequence[float]) -> Mode:
        held = modes_of(own.interface, x)
        if held not in modes:
            modes[held] = _mode(loaded, held, request.sensitivity, run.system.backend, known)
        return modes[held]

    system = loaded.system("numpy").bind(parameters)
    assert isinstance(system, NumpySystem)
    sensitivities(mode_of, Mode(system, run.system, wanted), run, complete, progress)


def _mode(
    loaded: Loaded, held: tuple[int, ...], names: Sequence[str], backend: str, known: Mapping[str, float]
) -> Mode:
    """Return the code in which contacts are held in these modes, with parameters and inputs that are known by
    name."""
    own, system, followed = loaded.artifact, loaded.in_contact_modes(held), loaded.sensitive(backend, held)
    # Parameters and inputs may reach nothing in these modes: directions by them are zero.
    used = {f.name for f in (*system.interface.parameters, *system.interface.inputs)}
    fields = (*own.unused, *own.interface.parameters, *own.interface.inputs)
    unused = [field for field in fields if field.name not in used]
    return Mode(
        system.model.bind(_values(system.interface, known)),
        followed.bind(_values(followed.interface, known)),
        directions(system.interface, names, unused, own.built_in),
    )


def _by_name(interface: Interface, values: Sequence[float]) -> dict[str, float]:
    return {f.name: value for f, value in zip((*interface.parameters, *interface.inputs), values)}


def _values(interface: Interface, known: Mapping[str, float]) -> list[float]:
    return [known[f.name] for f in (*interface.parameters, *interface.inputs)]
