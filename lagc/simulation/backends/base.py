"""What the backends share: a compiled model without values, and the same with parameters bound."""

from __future__ import annotations

from _thread import _local
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypeAlias, cast

from lagc.base.records import RLock
from lagc.lowering.program import Interface
from lagc.simulation.system import System, Vector

Branch: TypeAlias = Any  # its modes, as a backend keeps them


class Compiled(ABC):
    """A compiled model: nothing of it changes, and any number of threads may use it.

    It pickles as its interface and its text; what runs is loaded when it is first needed.
    """

    def __init__(self, interface: Interface, sources: Mapping[str, str]):
        self.interface, self.sources = interface, sources
        self.lock = RLock()

    @abstractmethod
    def bind(self, values: Sequence[float], branch: Branch | None = None) -> System:
        """The system with the array p = `values`; with a `branch`, on that."""

    def defaults(self) -> list[float]:
        """The model's own values of p; NaN where it gives none."""
        fields = (*self.interface.parameters, *self.interface.inputs)
        return [float("nan") if f.value is None else f.value for f in fields]

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.interface, dict(self.sources))

    def __copy__(self) -> Compiled:
        return self

    def __deepcopy__(self, _: object) -> Compiled:
        return self


class CompiledSystem(ABC):
    """A compiled model with its parameters, which never change.

    Every function is one of its arguments alone.  Any number of threads may call them: each has a
    desk of its own, made when it first calls.  Of `assemble` then `solve`, and of `culprit`, a thread
    sees its own.
    """

    def __init__(
        self, compiled: Compiled, values: Sequence[float], branch: Branch | None, desk: Callable[..., Any],
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
        self._own = _Own(desk, compiled, *given, self._hold)

    @property
    def parameters(self) -> tuple[float, ...]:
        """The array p: parameters, then inputs."""
        return self._values

    def bind(self, values: Sequence[float]) -> System:
        """The same model with other values of p."""
        return self.compiled.bind(values, self.branch)

    def on(self, t: float, x: Vector) -> System:
        """The same on the branch of (t, x), whatever the state that is asked and however arithmetic is
        rounded then."""
        if not self.interface.switches:
            return cast("System", self)
        return self.compiled.bind(self._values, self._branch(t, x))

    def _hold(self, desk: Any) -> None:
        """The branch for a desk that was made."""
        if self.branch is not None:
            self._held(desk, self.branch)

    @abstractmethod
    def _branch(self, t: float, x: Vector) -> Branch:
        """That of (t, x)."""

    @abstractmethod
    def _held(self, desk: Any, branch: Branch) -> None:
        """`desk` evaluates on the branch from here on."""

    @abstractmethod
    def rhs(self, t: float, x: Vector, xdot: list[float], lam: list[float]) -> int:
        """Fills xdot and lam; the status."""

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

    def outputs(self, t: float, x: Vector) -> list[float]:
        return self._ask("outputs", len(self.interface.outputs), t, x)

    def conditions(self, t: float, x: Vector) -> tuple[list[float], list[float], list[float]]:
        n = len(self.interface.condition_ends)
        lengths = n, len(self.interface.condition_columns), n
        if self.interface.pieces:
            c, jacobian, sizes = ([0.0] * length for length in lengths)
            self.some_conditions(t, x, c, jacobian, sizes, 0, max(self.interface.pieces) + 1)
        else:
            c, jacobian, sizes = self._fill("conditions", lengths, t, x)
        return c, jacobian, sizes

    @abstractmethod
    def some_conditions(self, t: float, x: Vector, c: list[float], jacobian: list[float], sizes: list[float],
                        first: int, last: int) -> None:  # fmt: skip
        """See `System`."""

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
        """The arrays of these lengths that the function `name` of the Program gives, at (t, x) where
        it depends on them."""

    @abstractmethod
    def _ask(self, name: str, length: int, t: float, x: Vector) -> list[float]:
        """The array of `length` that the function `name` of the Program gives at (t, x)."""

    def __reduce__(self) -> tuple[Any, ...]:
        return _bound, (self.compiled, self._values, self.branch)

    def __copy__(self) -> CompiledSystem:
        return self

    def __deepcopy__(self, _: object) -> CompiledSystem:
        return self


def _bound(compiled: Compiled, values: Sequence[float], branch: Branch | None) -> System:
    return compiled.bind(values, branch)


class _Own(_local):
    """What a thread calls with: its `desk`, made when it first asks for it."""

    def __init__(self, make: Callable[..., Any], *given: Any):
        self.make, (*self.given, self.made) = make, given

    def __getattr__(self, name: str) -> Any:
        if name != "desk":
            raise AttributeError(name)
        self.desk = self.make(*self.given)
        self.made(self.desk)
        return self.desk
