"""A trajectory in the hands of the caller: the memory of the code of a backend, advanced call by call.

Both backends make the steps of `NAME_advance` of the generated C, with its bits.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from copy import deepcopy
from ctypes import CFUNCTYPE, addressof, c_double, c_int, c_void_p, cast, create_string_buffer
from typing import TYPE_CHECKING, Any, Protocol

from lagc.simulation.system import Options, System

if TYPE_CHECKING:
    from lagc.simulation.backends.c import CSystem
    from lagc.simulation.backends.python import NumpySystem


class Memory(Protocol):
    """Parameters, state and workspace of one trajectory.  `p` begins with parameters and inputs; `state` has
    `t`, `x`, and what happened at the last event."""

    p: Any
    state: Any
    advance: Callable[[float], int]  # to a time; returns a status

    def begin(self, t: float, x: Sequence[float]) -> None:
        """Begin a trajectory at a state that meets the constraints."""
        ...

    def prepare(self) -> None:
        """Compute what depends on parameters alone."""
        ...

    def outputs(self) -> Any:
        """The outputs at the state."""
        ...

    def restore(self, other: Any) -> None:
        """Take parameters and state of another memory of the same model."""
        ...


def memory(system: System, options: Options) -> Memory:
    """Return memory for a trajectory with the parameters of `system`, which has the method of `options`."""
    compiled: Any = system
    return CMemory(compiled, options) if system.backend == "c" else PythonMemory(compiled, options)


class CMemory:
    """The structs of C.  Their addresses are found once, and a call makes no object but its time."""

    def __init__(self, system: CSystem, options: Options):
        model, values, interface = system.model, system.parameters, system.interface
        self.call, self.no_outputs = model.functions, not interface.outputs
        self.prepared = interface.prepared > 0
        self.p: Any = (c_double * max(len(values) + interface.prepared, 1))(*values)
        self.y: Any = (c_double * max(len(interface.outputs), 1))()
        self.options, self.work = model.options(options), model.work()
        self.room: Any = create_string_buffer(self.call["state_size"]())
        self.state = model.state.from_buffer(self.room)
        p, s, o, w = [addressof(part) for part in (self.p, self.room, self.options, self.work)]
        entry = cast(self.call["advance"], c_void_p).value
        advance = CFUNCTYPE(c_int, c_void_p, c_void_p, c_double, c_void_p, c_void_p)(entry or 0)
        self.advance: Callable[[float], int] = lambda t1: advance(p, s, t1, o, w)
        self.prepare()

    def begin(self, t: float, x: Sequence[float]) -> None:
        self.call["begin"](self.room, c_double(t), (c_double * len(x))(*x))

    def prepare(self) -> None:
        if self.prepared:
            self.call["bind"](self.p)

    def outputs(self) -> Any:
        if not self.no_outputs:
            self.call["outputs"](self.p, c_double(self.state.t), self.state.x, self.y, self.work)
        return self.y

    def restore(self, other: CMemory) -> None:
        self.p[:], self.room[:] = other.p[:], other.room[:]


class PythonMemory:
    """The objects of the generated module."""

    def __init__(self, system: NumpySystem, options: Options):
        self.system, self.options, self.problem = system, options, system.equations()
        self.p: Any = self.problem.p

    def begin(self, t: float, x: Sequence[float]) -> None:
        self._take(self.system.model.module["Integrator"](self.problem, self.options, t, list(x)))

    def _take(self, state: Any) -> None:
        self.state, self.advance = state, state.advance

    def prepare(self) -> None:
        self.problem.bind()

    def outputs(self) -> Any:
        given = self.p[: len(self.system.parameters)]
        return self.system.bind(given).outputs(self.state.t, self.state.x)

    def restore(self, other: PythonMemory) -> None:
        self.p[:] = other.p
        shared = {id(other.problem): self.problem, id(other.options): self.options}
        self._take(deepcopy(other.state, shared))
