"""A motion that is made again, with its sensitivities S: the kernel `follow`, in C or in Python.

Arrays of S by directions have a row for each direction.
"""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from ctypes import c_double, c_int, c_long, c_size_t
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from lagc.codegen.sizes import CONSTANT_SIZES
from lagc.simulation.linearization.derivatives import Array
from lagc.simulation.system import Options

if TYPE_CHECKING:
    from lagc.simulation.backends.c import CSystem
    from lagc.simulation.backends.python import NumpySystem


class Follower(Protocol):
    """`s` is the state of the motion and `w` the workspace of S, with the fields of the kernels' records."""

    s: Any
    w: Any
    nx: int

    @property
    def reached(self) -> int:
        """Number of recorded times."""
        ...

    def relations(self) -> tuple[list[float], list[float], list[int], list[int]]:
        """Modes after and before the last step; of each relation, whether it changed, and whether it jumped
        with others."""
        ...

    def arrays(self) -> tuple[Array, Array, Array, Array]:
        """S now, its largest values by scaling groups, its round-off and behind it the largest terms that
        cancelled, and S at the recorded times by times, directions and states."""
        ...

    def change(self, now: Array, sizes: Array, rounding: Array) -> None:
        """Set the first three of these."""
        ...

    def record(self, k: int, now: Array) -> None:
        """Set S at a recorded time."""
        ...

    def set_state(self, x: Sequence[float]) -> None:
        """Set the state of the motion."""
        ...

    def follow(self, budget: int) -> int:
        """Make at most so many steps, to the next event; return the status."""
        ...


def follower(
    system: Any, options: Options, times: Sequence[float], x: Sequence[float], columns: Sequence[int],
    now: Array, sizes: Array, rounding: Array,
) -> Follower:  # fmt: skip
    """A follower from (times[0], x) and S as it is given, in the directions of these parameters (-1:
    another)."""
    kind: Any = InC if system.backend == "c" else InPython
    found: Follower = kind(system, options, times, x, columns)
    found.change(now, sizes, rounding)
    found.record(0, now)
    return found


class InPython:
    """The kernel in Python."""

    def __init__(
        self, system: NumpySystem, options: Options, times: Sequence[float], x: Sequence[float],
        columns: Sequence[int],
    ):  # fmt: skip
        self.module, m, self.nx = system.model.module, len(columns), system.nx
        self.s: Any = self.module["Integrator"](
            system.equations(), Options(**vars(options)), times[0], list(x)
        )
        self.w, self.kept = self.module["TangentWork"](), self.module["State"]()
        self.times, self.done, self.longest, self.columns = list(times), [1], options.max_step, list(columns)
        self.found, self.now, self.after, self.table = (
            [[0.0] * self.nx for _ in range(count)]
            for count in (len(times) * m, m, m, m * CONSTANT_SIZES["NK"])
        )
        self.found = [[np.nan] * self.nx for _ in self.found]
        self.noise: list[list[float]] = []
        self.blur: list[list[float]] = []

    @property
    def reached(self) -> int:
        return self.done[0]

    def relations(self) -> tuple[list[float], list[float], list[int], list[int]]:
        work = self.s.problem.work
        return list(self.s.modes), list(self.s.modes_old), list(work.events.crossed), list(work.events.jumped)

    def arrays(self) -> tuple[Array, Array, Array, Array]:
        found = np.array(self.found).reshape(len(self.times), -1, self.nx)
        return np.array(self.now), np.array(self.sizes), np.array(self.rounding), found

    def change(self, now: Array, sizes: Array, rounding: Array) -> None:
        self.now, self.sizes, self.rounding = now.tolist(), sizes.tolist(), rounding.tolist()
        self.noise = self.noise or [[0.0] * len(row) for row in self.sizes]
        self.blur = self.blur or [[0.0] * len(row) for row in self.rounding]

    def record(self, k: int, now: Array) -> None:
        self.found[k * len(now) : (k + 1) * len(now)] = now.tolist()
        self.done[0] = max(self.done[0], k + 1)

    def set_state(self, x: Sequence[float]) -> None:
        self.s.x = list(x)

    def follow(self, budget: int) -> int:
        s = self.s
        return int(self.module["follow"](
            s.problem.p, s, self.kept, self.module["KernelOptions"](s.options), self.longest, self.times,
            len(self.times), self.done, len(self.columns), self.columns, self.now, self.after, self.table,
            self.sizes, self.noise, self.blur, self.rounding, self.found, budget, s.problem.work, self.w,
        ))  # fmt: skip


class InC:
    """The kernel in C."""

    def __init__(
        self, system: CSystem, options: Options, times: Sequence[float], x: Sequence[float],
        columns: Sequence[int],
    ):  # fmt: skip
        call, m, n, self.nx = system.model.functions, len(columns), len(times), system.nx
        self.call, self.m, self.relation_count = call, m, len(system.interface.relations)
        room, kept = (ctypes.create_string_buffer(call["state_size"]()) for _ in range(2))
        self.work, own = system.model.work(), ctypes.create_string_buffer(call["tangent_work_size"]())
        self.room, self.s, self.w = room, system.model.state.from_buffer(room), _TangentWork.from_buffer(own)
        self.done = c_size_t(1)
        groups = max(system.interface.kinds, default=0) + 1
        self.now, after, self.found = (np.zeros((count, self.nx)) for count in (m, m, n * m))
        table = np.zeros((m * CONSTANT_SIZES["NK"], self.nx))
        self.sizes, noise, blur, self.rounding = (np.zeros((k * m, groups)) for k in (1, 1, 2, 2))
        self.found[:] = np.nan
        self.held = after, table, noise, blur, kept, own  # as long as the pointers to them
        call["begin"](room, c_double(times[0]), (c_double * self.nx)(*x))
        self.before_budget = (
            system.parameter_struct, room, kept, ctypes.byref(system.model.options(options)),
            c_double(options.max_step), (c_double * n)(*times), c_size_t(n), ctypes.byref(self.done),
            c_size_t(m), (c_int * m)(*columns),
            *(ctypes.c_void_p(a.ctypes.data) for a in
              (self.now, after, table, self.sizes, noise, blur, self.rounding, self.found)),
        )  # fmt: skip
        self.after_budget = self.work, own

    @property
    def reached(self) -> int:
        return self.done.value

    def relations(self) -> tuple[list[float], list[float], list[int], list[int]]:
        n = self.relation_count
        modes, before, crossed, jumped = (c_double * n)(), (c_double * n)(), (c_int * n)(), (c_int * n)()
        self.call["event_facts"](self.room, self.work, modes, before, crossed, jumped)
        return modes[:], before[:], crossed[:], jumped[:]

    def arrays(self) -> tuple[Array, Array, Array, Array]:
        return self.now, self.sizes, self.rounding, self.found.reshape(-1, self.m, self.nx)

    def change(self, now: Array, sizes: Array, rounding: Array) -> None:
        self.now[:], self.sizes[:], self.rounding[:] = now, sizes, rounding

    def record(self, k: int, now: Array) -> None:
        self.found[k * self.m : (k + 1) * self.m] = now
        self.done.value = max(self.done.value, k + 1)

    def set_state(self, x: Sequence[float]) -> None:
        self.s.x[:] = x

    def follow(self, budget: int) -> int:
        return int(self.call["follow"](*self.before_budget, c_long(budget), *self.after_budget))


class _TangentWork(ctypes.Structure):
    """The first members of lagc_tangent_work."""

    _fields_ = (
        ("stepped", c_int), ("reason", c_int), ("steps", c_long), ("rejected", c_long), ("pace", c_double),
    )  # fmt: skip
