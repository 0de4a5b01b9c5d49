"""Runs of one model with many values, in C and without objects of Python for each run.

Only plain runs are done here: without constraints and contacts, to their end, by hand or verified at once.
`simulate` does all others, with the same bits, and says why a run failed.
"""

from __future__ import annotations

import ctypes
from abc import ABC, abstractmethod
from array import array
from collections.abc import Callable, Mapping, Sequence
from ctypes import byref, c_double, c_long, c_size_t, sizeof
from math import isfinite
from operator import itemgetter
from typing import cast

from lagc.codegen.c.lanes import METHOD
from lagc.codegen.python.support.base import FIRST_LOOK
from lagc.kernels import DEFAULT_METHOD
from lagc.simulation.backends.c import CSystem
from lagc.simulation.backends.compile import CannotCompile
from lagc.simulation.backends.lanes import Lanes
from lagc.simulation.error_measure import quantity_names
from lagc.simulation.global_error.energy_balance import balance
from lagc.simulation.global_error.verified_run import ULP, longest_step
from lagc.simulation.request import Request
from lagc.simulation.simulate import by_hand
from lagc.simulation.system import INTERRUPTED, OK, TERMINATED, Options, System, Trajectory
from lagc.symbolic.leaves import derived

SLICE = 20_000  # steps of a run by hand between two looks at the clock and at signals
ZERO = c_double(0.0)
MOST_NUMBERS = 20_000  # of a run in lanes
MOVED = 2.0**-26  # of a coordinate: half of its digits

Progress = Callable[[float], None]
Columns = list[list[float]]


def repeated(system: System, request: Request, names: Sequence[str], last: bool) -> Repeated | None:
    """Return what repeats the complete `request`, whose initial values may change; None if its runs need
    `simulate`.  `names` are the columns of its results, `last`: only at the end."""
    interface = system.interface
    plain = request.step is None and not (request.guesses or request.sensitivity)
    own = not interface.methods or (request.method or DEFAULT_METHOD) in interface.methods
    searched = interface.needs_consistency or interface.contacts or interface.limits or interface.doubtful
    if not (plain and own and isinstance(system, CSystem)) or searched:
        return None
    if request.by_hand:
        return RunsByHand(system, request, names, last)
    return None if interface.relations or interface.nc else VerifiedRuns(system, request, names)


class Repeated(ABC):
    """Arrays and functions of the runs of one request; for one thread.  Each run leaves the states at its
    `times`, its estimated error in `estimated`, and in `ended` how a clause ended it."""

    estimated, ended = float("nan"), ""

    def __init__(self, system: CSystem, names: Sequence[str], times: Sequence[float]):
        interface, self.call, self.system = system.interface, system.model.functions, system
        self.nx, self.nq, self.nv, self.nz = interface.nx, interface.nq, interface.nv, interface.nz
        self.fields = len(interface.parameters) + len(interface.inputs)
        self.p = (c_double * max(self.fields + interface.prepared, 1))()
        self.prepared, self.x = bool(interface.prepared), (c_double * self.nx)()
        self.times, self.grid = list(times), (c_double * len(times))(*times)
        self.flat = (c_double * (len(times) * self.nx))()
        # The columns of a point: states, then rates of coordinates, then outputs.
        outputs = [output.name for output in interface.outputs]
        discretes = [x.name for x in interface.discretes]
        known = {derived(name): self.nx + i for i, name in enumerate(interface.q_names)}
        known.update((name, self.nx - len(discretes) + i) for i, name in enumerate(discretes))
        known.update((name, i) for i, name in enumerate(interface.state_names))
        known.update((name, self.nx + self.nq + i) for i, name in enumerate(outputs))
        places = [known[name] for name in names]
        self.pick = itemgetter(*places) if len(places) > 1 else lambda row: tuple(row[k] for k in places)
        self.has_rates = any(self.nx <= k < self.nx + self.nq for k in places)
        self.has_outputs = any(k >= self.nx + self.nq for k in places)
        self.work, self.no_rates = system.model.work(), [0.0] * self.nq
        self.xdot, self.lam = (c_double * self.nx)(), (c_double * max(interface.nc, 1))()
        self.y, self.e = (c_double * max(len(outputs), 1))(), (c_double * 3)()

    def run(self, values: Sequence[float], starts: Mapping[int, float], progress: Progress) -> bool:
        """Run with the array p = `values` and initial values `starts` by their place in x; return whether it
        went as asked: else `simulate` tells why not."""
        self._begin(values, starts)
        self.call["energies"](self.p, ZERO, self.x, self.e)
        if not isfinite(sum(self.e)):
            return False
        progress(0.0)
        return self._run(progress)

    def _begin(self, values: Sequence[float], starts: Mapping[int, float]) -> None:
        """Set p and x."""
        p, x = self.p, self.x
        p[: self.fields] = [*values]
        if self.prepared:
            self.call["bind"](p)
        self.call["start"](p, x)
        for place, value in starts.items():
            x[place] = value

    @abstractmethod
    def _run(self, progress: Progress) -> bool: ...

    def energies(self, t: float, x: list[float]) -> list[float]:
        self.x[:] = [*x]
        self.call["energies"](self.p, c_double(t), self.x, self.e)
        return self.e[:]

    def columns(self) -> Columns:
        """The columns of the run over its times."""
        return [[*column] for column in zip(*map(self.row, range(len(self.times))))]

    def row(self, k: int) -> tuple[float, ...]:
        """The columns at point k of the run."""
        nx, t, rates, outputs = self.nx, c_double(self.times[k]), self.no_rates, list[float]()
        x = byref(self.flat, k * sizeof(c_double) * nx)
        if self.has_rates:
            self.call["rhs"](self.p, t, x, self.xdot, self.lam, self.work)
            rates = self.xdot[: self.nq]
        if self.has_outputs:
            self.call["outputs"](self.p, t, x, self.y, self.work)
            outputs = self.y[:]
        return self.pick([*self.flat[k * nx : (k + 1) * nx], *rates, *outputs])


class RunsByHand(Repeated):
    """Runs with given tolerances."""

    def __init__(self, system: CSystem, request: Request, names: Sequence[str], last: bool):
        super().__init__(system, names, [request.stop or 0.0] if last else request.grid())
        model = system.model
        options = by_hand(request)
        options.report = False  # events are not kept
        self.options, self.done = model.options(options), c_size_t(0)
        self.room = ctypes.create_string_buffer(self.call["state_size"]())
        self.state = model.state.from_buffer(self.room)
        self.space = model.work()
        self.has_lanes = len(self.flat) <= MOST_NUMBERS and (request.method or DEFAULT_METHOD) == METHOD
        self.lanes: Lanes | None = None
        self.ready = dict[bytes, bytes]()

    def run_lanes(self, points: Sequence[tuple[Sequence[float], Mapping[int, float]]]) -> None:
        """Make the next runs side by side, where that is possible; `run` takes their results."""
        if not (self.has_lanes and points):
            return
        try:
            self.lanes = self.lanes or Lanes(self.system.model)
        except CannotCompile:
            self.has_lanes = False
            return
        p, x = array("d"), array("d")
        for point in points:
            self._begin(*point)
            p.extend(self.p)
            x.extend(self.x)
        self.ready = self.lanes.record(p, x, len(points), self.options, self.grid, SLICE)
        self.has_lanes = bool(self.ready)  # none: long runs, or no such processor

    def _run(self, progress: Progress) -> bool:
        known = self.ready.pop(bytes(self.p) + bytes(self.x), None)
        if known is not None:
            ctypes.memmove(self.flat, known, len(known))
            return True
        state, status = self.state, INTERRUPTED
        self.times, self.ended = self.grid[:], ""
        ctypes.memset(self.space, 0, sizeof(self.space))
        self.call["begin"](byref(state), ZERO, self.x)
        self.done.value = 0
        while status == INTERRUPTED:
            status = self.call["record"](
                self.p, byref(state), byref(self.options), self.grid, c_size_t(len(self.times)), self.flat,
                byref(self.done), c_long(SLICE), self.space,
            )  # fmt: skip
            if status == INTERRUPTED:
                progress(state.t)
        if status == TERMINATED:
            clause, count = self.system.interface.whens[state.culprit], self.done.value
            if count == 0 or self.times[count - 1] != state.t:
                self.flat[count * self.nx : (count + 1) * self.nx] = state.x
                self.times[count:] = [state.t]
            self.ended = f"at t = {state.t:.6g} s: {clause.reason}"
            return not clause.fails
        return bool(status == OK)


class VerifiedRuns(Repeated):
    """Short smooth runs that reach their accuracy.  The others are done again: long ones, which might take
    another method, and those that hardly move, which may be at rest."""

    def __init__(self, system: CSystem, request: Request, names: Sequence[str]):
        super().__init__(system, names, request.grid())
        interface, model, self.accuracy = system.interface, system.model, request.accuracy or 0.0
        options = Options(method=request.method or DEFAULT_METHOD)
        options.max_step = longest_step(system, self.times[-1], request.max_step)
        self.options = model.options(options)
        known = {**interface.scales, **request.scales}
        scales = [known.get(name, 0.0) for name in quantity_names(interface)]
        self.scales, self.report = (c_double * len(scales))(*scales), model.report()
        self.goal = model.goal(accuracy=self.accuracy, slice=FIRST_LOOK - 1)
        self.outputs = (c_double * max(len(self.times) * len(interface.outputs), 1))()
        self.room = ctypes.create_string_buffer(self.call["verification_size"]())
        self.verification = model.verification.from_buffer(self.room)
        turning = zip(interface.q_names, interface.state_units)
        self.turning = [known.get(name, 1.0) if unit == "rad" else 0.0 for name, unit in turning]

    def _run(self, progress: Progress) -> bool:
        ctypes.memset(self.room, 0, sizeof(self.room))
        self.goal.law = 0.0
        status = self.call["verified"](
            self.p, self.x, self.grid, c_size_t(len(self.times)), byref(self.goal), self.scales,
            byref(self.options), self.flat, self.outputs, byref(self.report), self.room,
        )  # fmt: skip
        self.estimated = self.report.estimated
        if status != OK or not self.estimated <= self.accuracy or not self._moves():
            return False
        v, nx, flat = self.verification, self.nx, self.flat[:]
        states = [flat[k : k + nx] for k in range(0, len(flat), nx)]
        run = Trajectory(self.times, states, self.times[-1], states[-1], OK, rhs=v.run.rhs)
        own = cast("System", self)  # its energies
        return balance(own, run, v.scale[:], self.accuracy, getattr(v, "work_error", 0.0)).holds

    def _moves(self) -> bool:
        """Whether a coordinate moves by more than round-off, and no angle turns so often that the spacing of
        numbers counts."""
        ranges = zip(self.verification.run.lowest[: self.nq], self.verification.run.highest[: self.nq])
        moves = False
        for scale, (low, high) in zip(self.turning, ranges):
            size = max(-low, high)
            if ULP * size > self.accuracy * scale > 0.0:
                return False
            moves = moves or high - low > MOVED * size
        return moves
