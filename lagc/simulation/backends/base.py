"""The common part of the backends: a compiled model without values, and a system with parameters."""

from __future__ import annotations

from _thread import _local
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypeAlias, cast

from lagc.base.records import RLock
from lagc.lowering.program import Interface
from lagc.simulation.system import System, Vector

Branch: TypeAlias = Any  # the modes of all relations, in the form of the backend
Another: TypeAlias = "Callable[[str, str], System]"  # from a backend and a method


class Compiled(ABC):
    """A compiled model; immutable, for any number of threads. Pickles as its interface and its text.  The
    code is loaded when it is first needed.  It may have a few methods of integration only, or none: `another`
    returns the system with another one."""

    backend: str
    integrates = True

    def __init__(self, interface: Interface, sources: Mapping[str, str]):
        self.interface, self.sources = interface, sources
        self.another: Another | None = None
        self.lock = RLock()

    def for_method(self, method: str, values: Sequence[float]) -> System | None:
        """The system with the array p = `values` and a method that this code lacks; None if it has it."""
        methods = self.interface.methods
        if self.another is None or (self.integrates and (not methods or method in methods)):
            return None
        return self.another(self.backend, method).bind(values)

    @abstractmethod
    def bind(self, values: Sequence[float], branch: Branch | None = None) -> System:
        """The system with the array p = `values`, on a fixed `branch` if one is given."""

    def defaults(self) -> list[float]:
        """The model's own values of p; NaN for those without a value."""
        fields = (*self.interface.parameters, *self.interface.inputs)
        return [float("nan") if f.value is None else f.value for f in fields]

    def __reduce__(self) -> tuple[Any, ...]:
        return _restored, (type(self), self.interface, dict(self.sources), self.another)

    def __copy__(self) -> Compiled:
        return self

    def __deepcopy__(self, _: object) -> Compiled:
        return self


class CompiledSystem(ABC):
    """A compiled model with its parameters; immutable. Every function depends on its arguments alone.  Any
    number of threads may call them: each has a workspace, created at its first call.  The results of
    `assemble` for `solve`, and `culprit`, belong to the thread."""

    def __init__(
        self, compiled: Compiled, values: Sequence[float], branch: Branch | None,
        workspace: Callable[..., Any],
        *given: Any,
    ):  # fmt: skip
        interface = compiled.interface
        wanted = len(interface.parameters) + len(interface.inputs)
        if len(values) != wanted:
            raise ValueError(f"p has {len(values)} entries, not {wanted}")
        self.compiled, self.interface = compiled, interface
        self.nq, self.nv, self.nz, self.nx = interface.nq, interface.nv, interface.nz, interface.nx
        self.nc, self.nh, self.quaternions = interface.nc, interface.nh, interface.quaternions
        self._values = tuple(values)
        self.lock = RLock()
        self.branch = branch
        self._thread = _PerThread(workspace, compiled, *given, self._apply_branch)

    @property
    def parameters(self) -> tuple[float, ...]:
        """The array p: parameters, then inputs."""
        return self._values

    def bind(self, values: Sequence[float]) -> System:
        """The same model with other values of p."""
        return self.compiled.bind(values, self.branch)

    def on(self, t: float, x: Vector) -> System:
        """The same system on the branch of (t, x): the modes of all relations stay fixed at other states."""
        if not self.interface.relations:
            return cast("System", self)
        return self.compiled.bind(self._values, self._branch(t, x))

    def _apply_branch(self, workspace: Any) -> None:
        if self.branch is not None:
            self._set_branch(workspace, self.branch)

    @abstractmethod
    def _branch(self, t: float, x: Vector) -> Branch:
        """The branch of (t, x)."""

    @abstractmethod
    def _set_branch(self, workspace: Any, branch: Branch) -> None:
        """Fix the branch of a workspace."""

    @abstractmethod
    def rhs(self, t: float, x: Vector, xdot: list[float], lam: list[float]) -> int:
        """Fill xdot and lam; return the status."""

    def accelerations(self, t: float, x: Vector) -> tuple[list[float], list[float]]:
        xdot, lam = [0.0] * self.nx, [0.0] * self.nc
        self.rhs(t, x, xdot, lam)
        return xdot[self.nq : self.nq + self.nv], lam

    def position(self, t: float, x: Vector) -> list[float]:
        return self._ask("position", self.nh, t, x)

    def velocity(self, t: float, x: Vector) -> list[float]:
        return self._ask("velocity", self.nc, t, x)

    def scales(self, t: float, x: Vector) -> list[float]:
        return self._ask("scales", self.nc, t, x)

    def energies(self, t: float, x: Vector) -> list[float]:
        return self._ask("energies", 3, t, x)

    def gaps(self, t: float, x: Vector) -> list[float]:
        return self._ask("gaps", len(self.interface.contacts), t, x)

    def outputs(self, t: float, x: Vector) -> list[float]:
        return self._ask("outputs", len(self.interface.outputs), t, x)

    def output_columns(self, times: Vector, states: Sequence[Vector]) -> list[Sequence[float]]:
        return [*zip(*map(self.outputs, times, states))] or [()] * len(self.interface.outputs)

    def conditions(self, t: float, x: Vector) -> tuple[list[float], list[float], list[float]]:
        n = len(self.interface.condition_ends)
        lengths = n, len(self.interface.condition_columns), n
        c, jacobian, sizes = self._fill("conditions", lengths, t, x)
        return c, jacobian, sizes

    def measures(self) -> tuple[list[float], list[float]]:
        rates, units = len(self.interface.rate_names), len(set(self.interface.start_units))
        if "measures" not in self.interface.functions:
            return [0.0] * rates, [0.0] * units
        s, largest = self._fill("measures", (rates, units))
        return s, largest

    def limits(self) -> list[float]:
        return self._fill("limits", (len(self.interface.limits),))[0]

    @abstractmethod
    def _fill(self, name: str, lengths: tuple[int, ...], t: float = 0.0, x: Vector = ()) -> list[list[float]]:
        """The arrays of these lengths that the function `name` of the program computes, at (t, x) if it
        depends on them."""

    @abstractmethod
    def _ask(self, name: str, length: int, t: float, x: Vector) -> list[float]:
        """The array of `length` that the function `name` of the program computes at (t, x)."""

    def __reduce__(self) -> tuple[Any, ...]:
        return _bound, (self.compiled, self._values, self.branch)

    def __copy__(self) -> CompiledSystem:
        return self

    def __deepcopy__(self, _: object) -> CompiledSystem:
        return self


def _restored(
    kind: type[Compiled], interface: Interface, sources: Mapping[str, str], another: Another | None
) -> Compiled:
    found = kind(interface, sources)
    found.another = another
    return found


def _bound(compiled: Compiled, values: Sequence[float], branch: Branch | None) -> System:
    return compiled.bind(values, branch)


class _PerThread(_local):
    """The workspace of a thread, created when it first asks for it."""

    def __init__(self, make: Callable[..., Any], *given: Any):
        self.make, (*self.given, self.made) = make, given

    def __getattr__(self, name: str) -> Any:
        if name != "workspace":
            raise AttributeError(name)
        self.workspace = self.make(*self.given)
        self.made(self.workspace)
        return self.workspace
