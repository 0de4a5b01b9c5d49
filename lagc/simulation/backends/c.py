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
from lagc.codegen.python.support.base import MOST_CORNERS, MOST_EVENTS
from lagc.codegen.python.support.contacts import ContactTrajectory, contact_events
from lagc.codegen.python.support.slices import record_in_slices
from lagc.kernels import METHODS
from lagc.simulation.backends.base import Branch, Compiled, CompiledSystem
from lagc.simulation.backends.compile import library
from lagc.simulation.system import OK, Options, Trajectory, Vector

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
    def functions(self) -> dict[str, Any]:
        """The functions of the header by their names without the prefix.  Raises CannotCompile."""
        compiled, (own, text) = library(self.sources), self.header
        found = {}
        for result, name in re.findall(rf"^([a-z]\w*) {own}_(\w+)\(", text, re.M):
            found[name] = getattr(compiled, f"{own}_{name}")
            found[name].restype = _TYPES.get(result, c_int)
        return found

    @once
    def state(self) -> type[Any]:
        return self._struct("state")

    @once
    def head(self) -> type[Any]:
        return self._struct("work")

    @once
    def option_struct(self) -> type[Any]:
        return self._struct("options")

    def _struct(self, name: str) -> type[Any]:
        """The struct of the header, up to its private members."""
        own, text = self.header
        body = text.partition(f"}} {own}_{name};")[0].rpartition("typedef struct {")[2]
        sizes = dict(re.findall(r"#define (\w+) +(\d+)", text))
        fields = []
        for kind, member, length in re.findall(
            r"^ +(\w+) (\w+)(?:\[(\w+)\])?;", body.partition("/* Private")[0], re.M
        ):
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
        return self._bound(0)

    def _bound(self, direction: int) -> Any:
        """The parameters, with derived values computed in arithmetic rounded up (1) or down (-1); 0: to
        nearest."""
        p = (c_double * max(len(self._values) + self.interface.prepared, 1))(*self._values)
        if self.interface.prepared:
            bind = self.model.functions["bind"]
            (_rounded(bind, direction) if direction else bind)(p)
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

    def rounded(self, t: float, x: Vector, xdot: list[float], lam: list[float], direction: int) -> int | None:
        from lagc.simulation.backends.directed_rounding import control

        if control() is None:
            return None
        workspace = self._at(x)
        rhs = _rounded(workspace.rhs, direction)
        status: int = rhs(
            self._bound(direction), c_double(t), workspace.x, workspace.xdot, workspace.lam, workspace.work
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
        direction: int = 0,
    ) -> Trajectory:
        options.check()
        other = self.compiled.other(options.method, self._values)
        if other is not None:
            return other.integrate(options, t0, x0, times, progress, direction)
        nx, n, call, work = self.nx, len(times), self.model.functions, self.model.work()
        room = ctypes.create_string_buffer(call["state_size"]())
        state = self.model.state.from_buffer(room)
        call["begin"](ctypes.byref(state), c_double(t0), (c_double * nx)(*x0))
        asked = self.model.options(options)
        events: list[tuple[float, int]] = []
        jumps: list[float] = []
        corners: list[tuple[float, list[float], list[float]]] = []
        contacts: list[tuple[float, int, int, float, float, float]] = []
        touching = bool(self.interface.contacts)
        relations, whens, noted = (
            len(self.interface.relations),
            len(self.interface.whens),
            self.interface.noted,
        )
        grid, states, done = (c_double * n)(*times), (c_double * (n * nx))(), c_size_t(0)
        head = self.model.head.from_buffer(work)
        p = self._p
        if direction:
            from lagc.simulation.backends.directed_rounding import turns

            p, directions = self._bound(direction), turns(direction)

        def record(steps: int, max_steps: int) -> int:
            asked.max_steps = max_steps
            kernel = _rounded(call["record"], next(directions)) if direction else call["record"]
            seen = state.changes if self.interface.relations else 0
            settled = state.settlements if touching else 0
            status: int = kernel(
                p, ctypes.byref(state), ctypes.byref(asked), grid, c_size_t(n), states,
                ctypes.byref(done), c_long(steps), work,
            )  # fmt: skip
            if self.interface.relations and asked.report and state.changes > seen:
                events.extend((state.t, k) for k in noted if state.changed[k])
                if len(corners) < MOST_CORNERS:
                    x = state.x[:]
                    struck = touching and state.settlements > settled
                    jumped = struck or (whens and state.jumps > len(jumps))
                    corners.append((state.t, state.x_before_event[:] if jumped else x, x))
                if whens:
                    events.extend((state.t, relations + k) for k in state.acted[: state.acts])
                    jumps.extend([state.t] * (state.jumps - len(jumps)))
                if touching and state.settlements > settled:
                    contacts.extend(contact_events(state))
                asked.report = max(len(events), len(contacts)) < MOST_EVENTS
            return status

        def result(status: int) -> Trajectory:
            known: dict[str, Any] = {"events": events, "jumps": jumps, "corners": corners}
            if touching:
                known.update(contacts=contacts, penetration=state.penetration)
            return self._trajectory(
                status, state, head, times[: done.value], states[: done.value * nx], known
            )

        return record_in_slices(state, options, record, result, progress, None if direction else perf_counter)

    def _trajectory(
        self, status: int, state: Any, head: Any, times: Sequence[float], flat: list[float],
        known: dict[str, Any],
    ) -> Trajectory:  # fmt: skip
        """The trajectory with the recorded states `flat`, and its events, jumps and corners `known`."""
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
            event_roundoff=state.event_roundoff[:] if events else (),
            changes=state.changes if events else 0, **known,
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


def _rounded(function: Callable[..., int], direction: int) -> Callable[..., int]:
    """Return `function` with arithmetic rounded up (1) or down (-1)."""
    from lagc.simulation.backends.directed_rounding import directed

    def call(*given: Any) -> int:
        with directed(direction):
            return function(*given)

    return call
