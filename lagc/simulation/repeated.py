"""Runs of one model with many values, in C and without objects of Python for each run.

Only plain runs are done here: by hand, without constraints and contacts, to their end.  `simulate` does all
others, with the same bits, and says why a run failed.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Mapping, Sequence
from ctypes import byref, c_double, c_long, c_size_t, sizeof
from math import isfinite
from operator import itemgetter

from lagc.kernels import DEFAULT_METHOD
from lagc.simulation.backends.c import CModel
from lagc.simulation.request import Request
from lagc.simulation.simulate import by_hand
from lagc.simulation.system import INTERRUPTED, OK, System
from lagc.symbolic.leaves import derived

SLICE = 20_000  # steps between two looks at the clock and at signals

Progress = Callable[[float], None]
Columns = list[list[float]]


def repeated(system: System, request: Request, names: Sequence[str], last: bool) -> Repeated | None:
    """Return what repeats the complete `request`, whose initial values may change; None if its runs need
    `simulate`.  `names` are the columns of its results, `last`: only at the end."""
    interface = system.interface
    model = getattr(system, "model", None)
    plain = request.by_hand and request.step is None and not (request.guesses or request.sensitivity)
    own = not interface.methods or (request.method or DEFAULT_METHOD) in interface.methods
    searched = interface.needs_consistency or interface.contacts or interface.limits or interface.doubtful
    ended = any(
        clause.reason is not None for clause in interface.whens
    )  # by a clause: usually, if there is one
    if not (plain and own and isinstance(model, CModel)) or searched or ended:
        return None
    return Repeated(model, request, names, last)


class Repeated:
    """Arrays and functions of the runs of one request; for one thread."""

    def __init__(self, model: CModel, request: Request, names: Sequence[str], last: bool):
        interface, self.call = model.interface, model.functions
        self.nx, self.last = interface.nx, last
        self.fields = len(interface.parameters) + len(interface.inputs)
        self.p = (c_double * max(self.fields + interface.prepared, 1))()
        self.prepared = bool(interface.prepared)
        self.x, self.energies = (c_double * self.nx)(), (c_double * 3)()
        self.room = ctypes.create_string_buffer(self.call["state_size"]())
        self.state = model.state.from_buffer(self.room)
        options = by_hand(request)
        options.report = False  # events are not kept
        self.options = model.options(options)
        self.times = [request.stop or 0.0] if last else request.grid()
        self.grid = (c_double * len(self.times))(*self.times)
        self.states, self.done = (c_double * (len(self.times) * self.nx))(), c_size_t(0)
        self.work, self.size = model.work(), self.call["work_size"]()
        # The columns of a point: states, then rates of coordinates, then outputs.
        self.columns_work = model.work()
        outputs = [output.name for output in interface.outputs]
        discretes = [x.name for x in interface.discretes]
        known = {name: i for i, name in enumerate(interface.state_names)}
        known.update((name, self.nx - len(discretes) + i) for i, name in enumerate(discretes))
        rates = {derived(name): self.nx + i for i, name in enumerate(interface.q_names)}
        known = {**rates, **known, **{name: self.nx + interface.nq + i for i, name in enumerate(outputs)}}
        places = [known[name] for name in names]
        self.pick = itemgetter(*places) if len(places) > 1 else lambda row: tuple(row[k] for k in places)
        self.rates = [0.0] * interface.nq
        self.has_rates = any(self.nx <= k < self.nx + interface.nq for k in places)
        self.has_outputs = any(k >= self.nx + interface.nq for k in places)
        self.xdot, self.lam = (c_double * self.nx)(), (c_double * max(interface.nc, 1))()
        self.y, self.nq = (c_double * max(len(outputs), 1))(), interface.nq

    def run(self, values: Sequence[float], starts: Mapping[int, float], progress: Progress) -> Columns | None:
        """Return the columns of the run with the array p = `values`, at its points or at the end alone; None
        if it does not begin as usual, or does not reach its end: `simulate` tells why.  `starts` are initial
        values by their place in x."""
        call, p, x, state = self.call, self.p, self.x, self.state
        p[: self.fields] = [*values]
        if self.prepared:
            call["bind"](p)
        call["start"](p, x)
        for place, value in starts.items():
            x[place] = value
        call["energies"](p, c_double(0.0), x, self.energies)
        if not isfinite(sum(self.energies)):
            return None
        ctypes.memset(self.work, 0, self.size)
        call["begin"](byref(state), c_double(0.0), x)
        self.done.value, status = 0, INTERRUPTED
        progress(0.0)
        while status == INTERRUPTED:
            status = call["record"](
                p, byref(state), byref(self.options), self.grid, c_size_t(len(self.times)), self.states,
                byref(self.done), c_long(SLICE), self.work,
            )  # fmt: skip
            if status == INTERRUPTED:
                progress(state.t)
        return self._columns() if status == OK else None

    def _columns(self) -> Columns:
        nx, states = self.nx, self.states[:]
        rows = [self._row(t, k, states[k * nx : (k + 1) * nx]) for k, t in enumerate(self.times)]
        return [[*column] for column in zip(*rows)]

    def _row(self, t: float, k: int, x: list[float]) -> tuple[float, ...]:
        """The columns at point k, of the state x at t."""
        rates, outputs, place = self.rates, [], byref(self.states, k * sizeof(c_double) * self.nx)
        if self.has_rates:
            self.call["rhs"](self.p, c_double(t), place, self.xdot, self.lam, self.columns_work)
            rates = self.xdot[: self.nq]
        if self.has_outputs:
            self.call["outputs"](self.p, c_double(t), place, self.y, self.columns_work)
            outputs = self.y[:]
        return self.pick([*x, *rates, *outputs])
