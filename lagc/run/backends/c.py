"""The generated C, compiled to a shared library and called through ctypes, as a System."""

from __future__ import annotations

import ctypes
import os
from collections.abc import Callable, Mapping, Sequence
from ctypes import c_double, c_int, c_long, c_size_t
from time import perf_counter
from typing import Any

from lagc.optimize.program import Interface
from lagc.render.names import prefix
from lagc.run.backends.base import CompiledSystem
from lagc.run.backends.compile import CannotCompile, build_library
from lagc.run.problem import INTERRUPTED, OK, Options, Trajectory, Vector

METHODS = {"dop853": 0, "dopri5": 1}  # lagc_method of the header
SLICE = 0.05  # s between two calls of `progress`
FIRST_BUDGET = 64  # steps of the first slice


class _Options(ctypes.Structure):
    """lagc_options"""

    _fields_ = (
        ("method", c_int), ("project", c_int), ("max_steps", c_long), ("rtol", c_double),
        ("atol", c_double), ("step", c_double), ("first_step", c_double), ("max_step", c_double),
    )  # fmt: skip


class CSystem(CompiledSystem):
    """One library with parameters of its own, and a workspace: for one thread at a time."""

    backend = "c"

    def __init__(self, interface: Interface, sources: Mapping[str, str]):
        super().__init__(interface)
        self.prefix = prefix(interface.model)
        self.library = _open(sources)
        self._functions: dict[str, Any] = {}
        self._state_type = _state_type(self.nx)
        work_size = self._plain("work_size", c_size_t)()
        if self._plain("state_size", c_size_t)() != ctypes.sizeof(self._state_type):
            raise CannotCompile("the compiled library does not fit this version of lagc")
        self._work = ctypes.create_string_buffer(work_size)
        self._head = _head_type(self.nc).from_buffer(self._work)
        self._x = (c_double * self.nx)()
        self._xdot = (c_double * self.nx)()
        self._lam = (c_double * max(self.nc, 1))()
        self.parameters = [f.value or 0.0 for f in (*interface.parameters, *interface.inputs)]

    @property
    def parameters(self) -> list[float]:
        return self._values

    @parameters.setter
    def parameters(self, values: Sequence[float]) -> None:
        self._values = list(values)
        self._p = (c_double * max(len(values), 1))(*values)
        ctypes.memset(self._work, 0, len(self._work))

    @property
    def culprit(self) -> int:
        return int(self._head.culprit)

    @culprit.setter
    def culprit(self, value: int) -> None:
        self._head.culprit = value

    def rhs(self, t: float, x: Vector, xdot: list[float], lam: list[float]) -> int:
        status = self._rhs(t, x)
        xdot[:] = self._xdot
        lam[:] = self._lam[: self.nc]
        return status

    def accelerations(self, t: float, x: Vector) -> tuple[list[float], list[float]]:
        self._rhs(t, x)
        return self._xdot[self.nq : self.nq + self.nv], self._lam[: self.nc]

    def outputs(self, t: float, x: Vector) -> list[float]:
        n = len(self.interface.outputs)
        if n == 0:
            return []
        y = (c_double * n)()
        self._x[:] = list(x)
        self._plain("outputs", c_int)(self._p, c_double(t), self._x, y, self._work)
        return y[:]

    def start(self) -> list[float]:
        x = (c_double * self.nx)()
        self._plain("start", None)(self._p, x)
        return x[:]

    def initial(self, t: float, x: Vector) -> tuple[list[float], list[float]]:
        ni = len(self.interface.initial_places)
        if ni == 0:
            return [], []
        c, jacobian = (c_double * ni)(), (c_double * (ni * (self.nq + self.nv)))()
        self._x[:] = list(x)
        self._plain("initial", None)(self._p, c_double(t), self._x, c, jacobian)
        return c[:], jacobian[:]

    def displace(self, t: float, x: Vector, d: Vector) -> list[float]:
        if "displace" not in self.interface.functions:
            return list(d)
        moved = (c_double * self.nq)()
        self._x[:] = list(x)
        self._plain("displace", None)(self._p, c_double(t), self._x, (c_double * self.nv)(*d), moved)
        return moved[:]

    def assemble(self, t: float, x: Vector) -> int:
        self._x[:] = list(x)
        status: int = self._plain("assemble", c_int)(self._p, c_double(t), self._x, self._work)
        return status

    def solve(self, r: Vector) -> list[float]:
        n = self.nv + self.nc
        s = (c_double * n)()
        self._plain("solve", None)((c_double * n)(*r), s, self._work)
        return s[:]

    def integrate(
        self,
        options: Options,
        t0: float,
        x0: Vector,
        times: Sequence[float],
        progress: Callable[[float], None] | None = None,
    ) -> Trajectory:
        nx, n = self.nx, len(times)
        state = self._state_type()
        begin = self._plain("begin", None)
        self._x[:] = list(x0)
        begin(ctypes.byref(state), c_double(t0), self._x)
        asked = _Options(METHODS[options.method], options.project, options.max_steps, options.rtol,
                         options.atol, options.step, options.first_step, options.max_step)  # fmt: skip
        grid, states, done = (c_double * n)(*times), (c_double * (n * nx))(), c_size_t(0)
        record = self._plain("record", c_int)
        fallbacks = self._head.fallbacks
        self._head.culprit = -1
        budget, status = FIRST_BUDGET, INTERRUPTED
        try:
            while status == INTERRUPTED:
                began = perf_counter()
                status = record(self._p, ctypes.byref(state), ctypes.byref(asked), grid, c_size_t(n), states,
                                ctypes.byref(done), c_long(budget), self._work)  # fmt: skip
                if progress is not None:
                    progress(state.t)
                if perf_counter() - began < 0.5 * SLICE:
                    budget *= 2
        except KeyboardInterrupt:
            status = INTERRUPTED
        flat = states[: done.value * nx]
        rows = self._head.redundant if self.nc else ()
        return Trajectory(
            times=list(times[: done.value]),
            states=[flat[k : k + nx] for k in range(0, len(flat), nx)],
            t=state.t, x=state.x[:], status=status, culprit=-1 if status == OK else state.culprit,
            steps=state.steps, rejected=state.rejected, rhs=state.rhs,
            fallbacks=self._head.fallbacks - fallbacks,
            redundant_rows=tuple([i for i, lost in enumerate(rows) if lost]),
            position_drift=state.position_drift, velocity_drift=state.velocity_drift,
        )  # fmt: skip

    def _rhs(self, t: float, x: Vector) -> int:
        self._x[:] = list(x)
        function = self._plain("rhs", c_int)
        status: int = function(self._p, c_double(t), self._x, self._xdot, self._lam, self._work)
        return status

    def _ask(self, name: str, length: int, t: float, x: Vector) -> list[float]:
        if length == 0:
            return []
        values = (c_double * length)()
        self._x[:] = list(x)
        self._plain(name, None)(self._p, c_double(t), self._x, values)
        return values[:]

    def _plain(self, name: str, result: Any) -> Any:
        """The public function `name` of the header."""
        found = self._functions.get(name)
        if found is None:
            found = getattr(self.library, f"{self.prefix}_{name}")
            found.restype = result
            self._functions[name] = found
        return found


def _open(sources: Mapping[str, str]) -> ctypes.CDLL:
    """The library, compiled where it is not in the cache, and once more where the cached one is damaged."""
    path = build_library(sources)
    try:
        return ctypes.CDLL(path)
    except OSError:
        pass
    try:
        os.unlink(path)
        return ctypes.CDLL(build_library(sources))
    except OSError as error:
        raise CannotCompile(f"the compiled library cannot be loaded: {error}") from None


def _state_type(nx: int) -> type[Any]:
    """lagc_state"""

    class State(ctypes.Structure):
        _fields_ = (
            ("t", c_double), ("x", c_double * nx), ("t_old", c_double), ("x_old", c_double * nx),
            ("h_old", c_double), ("h", c_double), ("error_old", c_double), ("grid", c_double),
            ("position_drift", c_double), ("velocity_drift", c_double), ("on_grid", c_long),
            ("steps", c_long), ("rejected", c_long), ("rhs", c_long), ("arrived", c_int),
            ("has_dense", c_int), ("culprit", c_int),
        )  # fmt: skip

    return State


def _head_type(nc: int) -> type[Any]:
    """The first members of lagc_work."""

    class Head(ctypes.Structure):
        _fields_ = (("culprit", c_int), ("lost", c_int), ("fallbacks", c_long), ("redundant", c_int * nc))

    return Head
