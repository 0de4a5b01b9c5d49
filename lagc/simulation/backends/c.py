"""The generated C code, compiled to a shared library and called through ctypes, as a `System`."""

from __future__ import annotations

import ctypes
import re
from collections.abc import Callable, Sequence
from ctypes import c_double, c_int, c_long, c_size_t, sizeof
from itertools import chain
from time import perf_counter
from typing import Any

from lagc.base.records import once
from lagc.codegen.python.support.contacts import ContactTrajectory
from lagc.codegen.python.support.slices import record_in_slices
from lagc.kernels import METHODS
from lagc.simulation.backends.base import Branch, Compiled, CompiledSystem
from lagc.simulation.backends.checked import checked, run_in_slices
from lagc.simulation.backends.compile import library
from lagc.simulation.backends.event_log import EventLog
from lagc.simulation.system import OK, Checked, Options, Trajectory, Vector

QUICK = ("-Og",)  # takes half the time of -O2 or less; calls from Python cost more than it saves
_TYPES: dict[str, Any] = {"int": c_int, "long": c_long, "double": c_double, "size_t": c_size_t, "void": None}


class CModel(Compiled):
    """The shared library; compiled when it is first needed, unless it is in the cache."""

    backend = "c"

    @once
    def header(self) -> tuple[str, str]:
        """The prefix of the model, and the text of its header."""
        ((name, text),) = [(n, t) for n, t in self.sources.items() if n.endswith(".h")]
        return name.removesuffix(".h"), text

    @once
    def integrates(self) -> bool:
        own, text = self.header
        return f" {own}_record(" in text

    @once
    def functions(self) -> dict[str, Any]:
        """The functions of the header by their names without the prefix.  Raises CannotCompile."""
        compiled, (own, text) = library(self.sources, () if self.integrates else QUICK), self.header
        found = {}
        for result, name in re.findall(rf"^([a-z]\w*) {own}_(\w+)\(", text, re.M):
            found[name] = getattr(compiled, f"{own}_{name}")
            found[name].restype = _TYPES.get(result, c_int)
        return found

    @once
    def state(self) -> type[Any]:
        return self._struct("state")

    @once
    def verification(self) -> type[Any]:
        """The struct of the header up to the state of the run, without its private members."""
        return self._struct("verification")

    @once
    def head(self) -> type[Any]:
        return self._struct("work")

    @once
    def option_struct(self) -> type[Any]:
        return self._struct("options")

    @once
    def goal(self) -> type[Any]:
        return self._struct("goal")

    @once
    def report(self) -> type[Any]:
        return self._struct("report")

    def _struct(self, name: str) -> type[Any]:
        """The struct of the header, up to its private members."""
        own, text = self.header
        body = text.partition(f"}} {own}_{name};")[0].rpartition("typedef struct {")[2]
        sizes = dict(re.findall(r"#define (\w+) +(\d+)", text))
        fields = []
        for kind, member, length in re.findall(
            r"^ +(\w+) (\w+)(?:\[(\w+)\])?;", body.partition("/* Private")[0], re.M
        ):
            if kind == f"{own}_state":  # what follows it is behind its private members
                fields.append((member, self.state))
                break
            plain = _TYPES[kind]
            fields.append((member, plain * int(sizes.get(length, length)) if length else plain))
        return type(name, (ctypes.Structure,), {"_fields_": fields})

    def bind(self, values: Sequence[float], branch: Branch | None = None) -> CSystem:
        return CSystem(self, values, branch)

    def options(self, o: Options) -> Any:
        """Return the struct lagc_options."""
        given = {name: getattr(o, name) for name, _ in self.option_struct._fields_}
        return self.option_struct(**{**given, "method": METHODS.index(o.method)})

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
        other = self.compiled.for_method(options.method, self._values)
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
        other = self.compiled.for_method(options.method, self._values)
        if other is not None:
            return other.verify(options, x0, times, accuracy, scales, progress)
        nx, ny, n, model = self.nx, len(self.interface.outputs), len(times), self.model
        call, byref = model.functions, ctypes.byref
        room = ctypes.create_string_buffer(call["verification_size"]())
        v = model.verification.from_buffer(room)
        head = model.head.from_buffer(room, model.verification.run.offset + call["state_size"]())
        goal, report, asked = model.goal(accuracy=accuracy), model.report(), model.options(options)
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
            shared_contacts=tuple([i for i, shares in enumerate(getattr(head, "shared", ())) if shares]),
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
