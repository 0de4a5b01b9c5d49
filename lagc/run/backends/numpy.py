"""The generated Python module as a System.

One state at a time runs on Python floats, which NumPy would slow down; the module uses NumPy for
many states at once.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from types import CodeType
from typing import Any

from lagc.optimize.program import Interface
from lagc.run.backends.base import CompiledSystem
from lagc.run.problem import Options, Trajectory, Vector


def compiled(sources: Mapping[str, str]) -> CodeType:
    """The module's text (the one file of `sources`) as code."""
    ((name, text),) = sources.items()
    return compile(text, name, "exec", dont_inherit=True)


class NumpySystem(CompiledSystem):
    """`module` is the namespace that the generated text makes."""

    backend = "numpy"

    def __init__(self, interface: Interface, code: CodeType):
        super().__init__(interface)
        self.module: dict[str, Any] = {"__name__": __name__}
        exec(code, self.module)
        self._p: list[float] = [f.value or 0.0 for f in (*interface.parameters, *interface.inputs)]
        self.inner: Any = self._equations()

    @property
    def parameters(self) -> list[float]:
        return self._p

    @parameters.setter
    def parameters(self, values: Sequence[float]) -> None:
        self._p = list(values)
        self.inner = self._equations()

    @property
    def culprit(self) -> int:
        found: int = self.inner.culprit
        return found

    @culprit.setter
    def culprit(self, value: int) -> None:
        self.inner.culprit = value

    def rhs(self, t: float, x: Vector, xdot: list[float], lam: list[float]) -> int:
        status: int = self.inner.rhs(t, x, xdot, lam)
        return status

    def assemble(self, t: float, x: Vector) -> int:
        status: int = self.inner.assemble(t, x)
        return status

    def solve(self, r: Vector) -> list[float]:
        found: list[float] = self.inner.solve(r)
        return found

    def displace(self, t: float, x: Vector, d: Vector) -> list[float]:
        found: list[float] = self.inner.displace(t, x, d)
        return found

    def start(self) -> list[float]:
        x = [0.0] * self.nx
        self.module["fn_start"](self._p, x)
        return x

    def initial(self, t: float, x: Vector) -> tuple[list[float], list[float]]:
        ni = len(self.interface.initial_places)
        c, jacobian = [0.0] * ni, [0.0] * (ni * (self.nq + self.nv))
        if ni:
            self.module["fn_initial"](self._p, t, x, c, jacobian)
        return c, jacobian

    def accelerations(self, t: float, x: Vector) -> tuple[list[float], list[float]]:
        xdot, lam = [0.0] * self.nx, [0.0] * self.nc
        self.inner.rhs(t, x, xdot, lam)
        return xdot[self.nq : self.nq + self.nv], lam

    def integrate(
        self,
        options: Options,
        t0: float,
        x0: Vector,
        times: Sequence[float],
        progress: Callable[[float], None] | None = None,
    ) -> Trajectory:
        own = self.module["Options"](**vars(options))
        done: Trajectory = self.module["_integrate"](self.inner, own, t0, list(x0), list(times), progress)
        return done

    def _ask(self, name: str, length: int, t: float, x: Vector) -> list[float]:
        """The function `name` of the Program, with those of p t x a lam that it reads."""
        result = [0.0] * length
        if length:
            function = self.module[f"fn_{name}"]
            names = function.__code__.co_varnames[: function.__code__.co_argcount - 1]
            given: dict[str, Any] = {"p": self._p, "t": t, "x": x}
            if "a" in names or "lam" in names:
                given["a"], given["lam"] = self.accelerations(t, x)
            function(*(given[n] for n in names), result)
        return result

    def _equations(self) -> Any:
        return self.module["Equations"](self.module, self._p)
