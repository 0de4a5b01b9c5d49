"""The generated C code, compiled to a shared library and called through ctypes, as a `System`."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence
from ctypes import c_double, c_int, c_long, c_size_t, sizeof
from itertools import chain
from time import perf_counter
from typing import Any

from lagc.base.records import once
from lagc.codegen.python.support.contacts import ContactTrajectory
from lagc.codegen.python.support.slices import record_in_slices
from lagc.kernels import METHODS, MOST_ACTS
from lagc.lowering.program import Interface
from lagc.simulation.backends.base import Branch, Compiled, CompiledSystem
from lagc.simulation.backends.checked import checked, run_in_slices
from lagc.simulation.backends.compile import library
from lagc.simulation.backends.event_log import EventLog
from lagc.simulation.error_measure import quantity_names
from lagc.simulation.system import OK, Checked, Options, Trajectory, Vector


class _Options(ctypes.Structure):
    """lagc_options"""

    _fields_ = (
        ("method", c_int), ("project", c_int), ("alone", c_int), ("max_steps", c_long), ("rtol", c_double),
        ("atol", c_double), ("step", c_double), ("first_step", c_double), ("max_step", c_double),
        ("report", c_int), ("halves", c_int),
    )  # fmt: skip


class _Goal(ctypes.Structure):
    """lagc_goal"""

    _fields_ = (("accuracy", c_double), ("law", c_double), ("most", c_long), ("slice", c_long))


class _Report(ctypes.Structure):
    """lagc_report"""

    _fields_ = (
        ("estimated", c_double), ("until", c_double), ("rtol", c_double), ("attempts", c_long),
        ("rhs", c_long), ("steps", c_long), ("skipped", c_long), ("done", c_size_t),
    )  # fmt: skip


# The functions of the header and their result types; a model may lack some.
_RESULTS: dict[str, Any] = {
    **dict.fromkeys(("rhs", "outputs", "assemble", "record", "verified", "seated"), c_int),
    **dict.fromkeys(("follow",), c_int),
    **dict.fromkeys(("work_size", "state_size", "verification_size", "tangent_work_size"), c_size_t),
    **dict.fromkeys(("position", "velocity", "scales", "energies", "start", "displace", "gaps"), None),
    **dict.fromkeys(("solve", "begin", "bind", "hold", "conditions"), None),
    **dict.fromkeys(("measures", "limits", "event_facts"), None),
}


class CModel(Compiled):
    """The shared library; compiled when it is first needed, unless it is in the cache."""

    backend = "c"

    @once
    def functions(self) -> dict[str, Any]:
        """The functions by their names in the header, without the prefix.  Raises CannotCompile."""
        compiled = library(self.sources)
        (own,) = [name.removesuffix(".c") for name in self.sources if name.endswith(".c")]
        found = {}
        for name, result in _RESULTS.items():
            function = getattr(compiled, f"{own}_{name}", None)
            if function is not None:
                function.restype = result
                found[name] = function
        return found

    @once
    def state(self) -> type[Any]:
        interface = self.interface
        kinds = max(interface.kinds, default=0) + 1
        acts, contacts = MOST_ACTS * len(interface.whens), len(interface.contacts)
        return _state_type(interface.nx, kinds, len(interface.relations), acts, contacts)

    @once
    def verification(self) -> type[Any]:
        return _verification_type(self.interface, self.state)

    @once
    def head(self) -> type[Any]:
        return _head_type(self.interface.nc)

    def bind(self, values: Sequence[float], branch: Branch | None = None) -> CSystem:
        return CSystem(self, values, branch)

    def options(self, o: Options) -> Any:
        """Return the struct lagc_options."""
        return _Options(METHODS.index(o.method), o.project, o.alone, o.max_steps, o.rtol, o.atol, o.step,
                        o.first_step, o.max_step, o.report, o.halves)  # fmt: skip

    def work(self) -> Any:
        """Return a new workspace."""
        return ctypes.create_string_buffer(self.functions["work_size"]())


class _Workspace:
    """The workspace and the arrays of one thread."""

    __slots__ = ("call", "conditions", "head", "lam", "rhs", "work", "x", "xdot")

    def __init__(self, model: CModel):
        interface = model.interface
        self.call = model.functions
        self.rhs = self.call["rhs"]
        self.work = model.work()
        self.head = model.head.from_buffer(self.work)
        self.x = (c_double * interface.nx)()
        self.xdot = (c_double * interface.nx)()
        self.lam = (c_double * max(interface.nc, 1))()


class CSystem(CompiledSystem):
    backend = "c"

    def __init__(self, model: CModel, values: Sequence[float], branch: Branch | None = None):
        super().__init__(model, values, branch, _Workspace)
        self.model = model

    def _branch(self, t: float, x: Vector) -> Branch:
        work = self.model.work()
        self.model.functions["hold"](self._p, c_double(t), (c_double * self.nx)(*x), work)
        return work.raw

    def _set_branch(self, workspace: _Workspace, branch: Branch) -> None:
        workspace.work[:] = branch

    @property
    def parameter_struct(self) -> Any:
        """The struct lagc_params."""
        return self._p

    @once
    def _p(self) -> Any:
        """The struct lagc_params with all derived values."""
        p = (c_double * max(len(self._values) + self.interface.prepared, 1))(*self._values)
        if self.interface.prepared:
            self.model.functions["bind"](p)
        return p

    @property
    def culprit(self) -> int:
        return int(self._thread.workspace.head.culprit)

    def rhs(self, t: float, x: Vector, xdot: list[float], lam: list[float]) -> int:
        workspace = self._thread.workspace
        workspace.x[:] = x
        status: int = workspace.rhs(
            self._p, c_double(t), workspace.x, workspace.xdot, workspace.lam, workspace.work
        )
        xdot[:] = workspace.xdot[:]
        lam[:] = workspace.lam[: self.nc]
        return status

    def outputs(self, t: float, x: Vector) -> list[float]:
        n = len(self.interface.outputs)
        if n == 0:
            return []
        y, workspace = (c_double * n)(), self._at(x)
        workspace.call["outputs"](self._p, c_double(t), workspace.x, y, workspace.work)
        return y[:]

    def output_columns(self, times: Vector, states: Sequence[Vector]) -> list[Sequence[float]]:
        n, nx, workspace = len(self.interface.outputs), self.nx, self._thread.workspace
        x, y = (c_double * (len(times) * nx))(*chain.from_iterable(states)), (c_double * (len(times) * n))()
        outputs, p, work, byref = workspace.call["outputs"], self._p, workspace.work, ctypes.byref
        from_x, from_y = sizeof(c_double) * nx, sizeof(c_double) * n
        for k, t in enumerate(times):
            outputs(p, c_double(t), byref(x, k * from_x), byref(y, k * from_y), work)
        return [y[i::n] for i in range(n)]

    def start(self) -> list[float]:
        x = (c_double * self.nx)()
        self.model.functions["start"](self._p, x)
        return x[:]

    def displace(self, t: float, x: Vector, d: Vector) -> list[float]:
        if "displace" not in self.interface.functions:
            return list(d)
        moved, workspace = (c_double * self.nq)(), self._at(x)
        workspace.call["displace"](self._p, c_double(t), workspace.x, (c_double * self.nv)(*d), moved)
        return moved[:]

    def seated(self, t: float, x: Vector) -> list[float]:
        workspace = self._at(x)
        workspace.call["seated"](self._p, c_double(t), workspace.x, workspace.work)
        found: list[float] = workspace.x[:]
        return found

    def assemble(self, t: float, x: Vector) -> int:
        workspace = self._at(x)
        status: int = workspace.call["assemble"](self._p, c_double(t), workspace.x, workspace.work)
        return status

    def solve(self, r: Vector) -> list[float]:
        n, workspace = self.nv + self.nc, self._thread.workspace
        s = (c_double * n)()
        workspace.call["solve"]((c_double * n)(*r), s, workspace.work)
        return s[:]

    def integrate(
        self,
        options: Options,
        t0: float,
        x0: Vector,
        times: Sequence[float],
        progress: Callable[[float], None] | None = None,
    ) -> Trajectory:
        options.check()
        other = self.compiled.other(options.method, self._values)
        if other is not None:
            return other.integrate(options, t0, x0, times, progress)
        nx, n, call, work = self.nx, len(times), self.model.functions, self.model.work()
        room = ctypes.create_string_buffer(call["state_size"]())
        state = self.model.state.from_buffer(room)
        call["begin"](ctypes.byref(state), c_double(t0), (c_double * nx)(*x0))
        asked = self.model.options(options)
        log = EventLog(self.interface, state, options.report)
        grid, states, done = (c_double * n)(*times), (c_double * (n * nx))(), c_size_t(0)
        head = self.model.head.from_buffer(work)

        def record(steps: int, max_steps: int) -> int:
            asked.max_steps, asked.report, seen = max_steps, log.open, log.seen()
            status: int = call["record"](
                self._p, ctypes.byref(state), ctypes.byref(asked), grid, c_size_t(n), states,
                ctypes.byref(done), c_long(steps), work,
            )  # fmt: skip
            log.add(seen)
            return status

        def result(status: int) -> Trajectory:
            return self._trajectory(status, state, head, times[: done.value], states[: done.value * nx], log)

        return record_in_slices(state, options, record, result, progress, perf_counter)

    def verify(
        self, options: Options, x0: Vector, times: Sequence[float], accuracy: float, scales: Vector,
        progress: Callable[[float], None] | None = None,
    ) -> Checked:  # fmt: skip
        other = self.compiled.other(options.method, self._values)
        if other is not None:
            return other.verify(options, x0, times, accuracy, scales, progress)
        nx, ny, n, model = self.nx, len(self.interface.outputs), len(times), self.model
        call, byref = model.functions, ctypes.byref
        room = ctypes.create_string_buffer(call["verification_size"]())
        v = model.verification.from_buffer(room)
        head = model.head.from_buffer(room, model.verification.run.offset + call["state_size"]())
        goal, report, asked = _Goal(accuracy=accuracy), _Report(), model.options(options)
        log = EventLog(self.interface, v.run, options.report)
        grid, states, outputs = (c_double * n)(*times), (c_double * (n * nx))(), (c_double * max(n * ny, 1))()
        given = (
            self._p, (c_double * nx)(*x0), grid, c_size_t(n), byref(goal), (c_double * len(scales))(*scales),
            byref(asked), states, outputs, byref(report), room,
        )  # fmt: skip

        def advance(steps: int) -> int:
            goal.slice, asked.report = steps, log.open
            status: int = call["verified"](*given)
            return status

        def result(status: int) -> Trajectory:
            done = report.done
            return self._trajectory(status, v.run, head, times[:done], states[: done * nx], log)

        status = run_in_slices(advance, log, lambda: int(report.attempts), result, options, progress)
        return checked(result(status), v, report, asked)

    def _trajectory(
        self, status: int, state: Any, head: Any, times: Sequence[float], flat: list[float], log: EventLog
    ) -> Trajectory:
        """The trajectory with the recorded states `flat`, and the events of `log`."""
        nx, events = self.nx, bool(self.interface.relations)
        rows = head.redundant if self.nc else ()
        make = ContactTrajectory if self.interface.contacts else Trajectory
        return make(
            times=list(times),
            states=[flat[k : k + nx] for k in range(0, len(flat), nx)],
            t=state.t, x=state.x[:], status=status, culprit=-1 if status == OK else state.culprit,
            steps=state.steps, rejected=state.rejected, rhs=state.rhs, stiff=state.stiff,
            step=state.t - state.t_old, fallbacks=head.fallbacks,
            redundant_rows=tuple([i for i, lost in enumerate(rows) if lost]),
            position_drift=state.position_drift, velocity_drift=state.velocity_drift,
            sizes=state.sizes[:], lowest=state.lowest[:], highest=state.highest[:],
            changes=state.changes if events else 0, **log.known(),
        )  # fmt: skip

    def _at(self, x: Vector) -> Any:
        """The workspace of this thread, with its x set."""
        workspace = self._thread.workspace
        workspace.x[:] = x
        return workspace

    def _ask(self, name: str, length: int, t: float, x: Vector) -> list[float]:
        if length == 0:
            return []
        values, workspace = (c_double * length)(), self._at(x)
        workspace.call[name](self._p, c_double(t), workspace.x, values)
        return values[:]

    def _fill(self, name: str, lengths: tuple[int, ...], t: float = 0.0, x: Vector = ()) -> list[list[float]]:
        arrays = [(c_double * max(length, 1))() for length in lengths]
        if name in self.interface.functions:
            state = (c_double(t), (c_double * self.nx)(*x)) if x else ()
            self.model.functions[name](self._p, *state, *arrays)
        return [array[:length] for array, length in zip(arrays, lengths)]


def _state_type(nx: int, kinds: int, relations: int, acts: int, contacts: int) -> type[Any]:
    """The first members of lagc_state."""

    class State(ctypes.Structure):
        _fields_ = (
            ("t", c_double), ("x", c_double * nx), ("t_old", c_double), ("position_drift", c_double),
            ("velocity_drift", c_double), ("steps", c_long), ("rejected", c_long), ("rhs", c_long),
            ("stiff", c_long), ("culprit", c_int), ("sizes", c_double * kinds),
            ("lowest", c_double * nx), ("highest", c_double * nx),
            *(
                (("changes", c_long), ("changed", c_int * relations))
                if relations
                else ()
            ),
            *(
                (("acts", c_int), ("acted", c_int * acts))
                if acts
                else ()
            ),
            *((("jumps", c_long), ("x_before_event", c_double * nx)) if acts or contacts else ()),
            *(
                (("settlements", c_long), ("contact_kinds", c_int * contacts),
                 ("contact_impulses", c_double * contacts), ("contact_losses", c_double * contacts),
                 ("rest_times", c_double * contacts), ("penetration", c_double))
                if contacts
                else ()
            ),
        )  # fmt: skip

    return State


def _head_type(nc: int) -> type[Any]:
    """The first members of lagc_work."""

    class Head(ctypes.Structure):
        _fields_ = (("culprit", c_int), ("fallbacks", c_long), ("redundant", c_int * nc))

    return Head


def _verification_type(interface: Interface, state: type[Any]) -> type[Any]:
    """The first members of lagc_verification; `run` begins with those of `state`."""
    n = len(quantity_names(interface))
    leaps = interface.whens or interface.contacts

    class Verification(ctypes.Structure):
        _fields_ = (
            ("phase", c_int), ("alone", c_int), ("error", c_double * n), ("scale", c_double * n),
            ("size", c_double * n), ("constant", c_int * n), *((("time_error", c_double),) if leaps else ()),
            ("run", state),
        )  # fmt: skip

    return Verification
