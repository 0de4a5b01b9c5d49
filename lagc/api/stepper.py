"""A motion that the caller advances: for controllers, games and reinforcement learning."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import isfinite
from typing import TYPE_CHECKING, Any

from lagc.api.values import Parametrized, Value, quantities, seconds
from lagc.codegen.python.support.contacts import ContactTrajectory, contact_events
from lagc.kernels import DEFAULT_METHOD
from lagc.kernels.language.statuses import INTERRUPTED, INVALID, OK, REDUNDANT
from lagc.simulation.request import Request, bound_guesses, bound_starts, keep_limits, unknown
from lagc.simulation.simulate import RTOL, by_hand, events_of
from lagc.simulation.solution import Event
from lagc.simulation.stepping import Memory, memory
from lagc.simulation.system import Trajectory
from lagc.simulation.verdict import verdict

if TYPE_CHECKING:
    from lagc.simulation.initialization.result import Start
    from lagc.simulation.solution import Array
    from lagc.simulation.system import Options, System


class Stepper:
    """A motion that is advanced call by call, from t = 0, with the bits of `NAME_advance` of the generated C.

    `stepper[name]` is the value of a coordinate, speed, discrete variable, output, parameter or input at the
    time `t`; parameters and inputs may be set between two calls.  `events` are those of the last call, and
    `ended` is the reason if a clause `terminate` ended it, else "".  For one thread at a time."""

    def __init__(self, system: System, options: Options, begin: Callable[[System, Request], Start]):
        interface = system.interface
        options.report = bool(interface.relations)
        self.system, self._options, self._begin = system, options, begin
        self._memory: Memory = memory(system, options)
        fields = (*interface.parameters, *interface.inputs)
        self._fields = {field.name: k for k, field in enumerate(fields)}
        self._bounds = [(field.minimum, field.maximum) for field in fields]
        first = interface.nx - len(interface.discretes)
        self._states = {name: k for k, name in enumerate(interface.state_names)}
        self._states |= {field.name: first + k for k, field in enumerate(interface.discretes)}
        self._outputs = {field.name: k for k, field in enumerate(interface.outputs)}
        self._inputs_from = len(interface.parameters)
        self._initial: tuple[object, list[float]] | None = None
        self.events: tuple[Event, ...] = ()
        self.ended = ""

    def reset(
        self, starts: Mapping[str, Value] | None = None, guesses: Mapping[str, Value] | None = None
    ) -> None:
        """Go back to t = 0, with the parameters and inputs as they are.  `starts` and `guesses` are initial
        values by name, as for `simulate`.  Raises Refused if there is no consistent initial state."""
        values, interface = self._memory.p[: len(self._fields)], self.system.interface
        given = quantities("starts", starts), quantities("guesses", guesses)
        if self._initial is None or self._initial[0] != (values, given):
            system = self._current()
            keep_limits(system)
            request = Request(
                starts=bound_starts(interface, given[0]), guesses=bound_guesses(interface, given[1], given[0])
            )
            self._initial = (values, given), self._begin(system, request).x
        self._memory.begin(0.0, self._initial[1])
        self._rebase(0.0)

    def _rebase(self, t: float) -> None:
        """Count steps from the time t on: a sum of steps would gather round-off."""
        self._from, self._count, self._step = t, 0, 0.0
        self.events, self.ended = (), ""
        self._seen = self._counts()

    def advance(self, step: float, /, **inputs: float) -> None:
        """Advance the motion by `step` in s, with `inputs` set to numbers in SI units from its beginning on.

        The k-th of equal steps from the time t0 ends at t0 + k*step.  Raises ValueError for an invalid input
        or step, ArithmeticError if the motion cannot be continued; it is then at the end of the last step
        of the method, where another call may continue."""
        for name in inputs:
            self[name] = inputs[name]
        # Equal steps are counted, not added up, so that the k-th one ends at t0 + k step without piled up
        # round-off.
        if step != self._step:
            if not isfinite(step):
                raise ValueError(f"a step is a finite number of seconds, not {step!r}")
            self._from, self._count, self._step = self._from + self._count * self._step, 0, step
        if self.events or self.ended:
            self.events, self.ended = (), ""
        goal = self._from + (self._count + 1) * step
        status = self._memory.advance(goal)
        if status != OK:
            self._pass_events(status, goal)
        if not self.ended:
            self._count += 1

    def _pass_events(self, status: int, goal: float) -> None:
        """Go on to `goal` behind events.  Where the motion ends before, steps are counted from there."""
        events: list[tuple[float, int]] = []
        contacts: list[tuple[float, int, int, float, float, float]] = []
        self._note(events, contacts)
        while status == INTERRUPTED:
            status = self._memory.advance(goal)
            self._note(events, contacts)
        if status == INVALID:
            raise ValueError(f"a step of {self._step:g} s from t = {self.t:g} s leaves the range of times")
        reached = status in (OK, REDUNDANT)
        if not reached:
            self._rebase(self.t)
        self._seen, run = self._counts(), self._trajectory(status, events, contacts)
        self.events = events_of(self.system, run)
        if not reached:
            outcome, message = verdict(self._current(), run, goal)
            if outcome != "terminated":
                raise ArithmeticError(message)
            self.ended = message

    def _note(self, events: list[tuple[float, int]], contacts: list[Any]) -> None:
        """Append what happened since the last call."""
        state, interface, seen = self._memory.state, self.system.interface, self._seen
        self._seen = self._counts()
        if self._seen[0] > seen[0]:
            events += [(state.t, k) for k in interface.noted if state.changed[k]]
            if interface.whens:
                events += [(state.t, len(interface.relations) + k) for k in state.acted[: state.acts]]
        if self._seen[1] > seen[1]:
            contacts += contact_events(state)

    def _counts(self) -> tuple[int, int]:
        """The numbers of events, and of those of contacts, so far."""
        state, interface = self._memory.state, self.system.interface
        return (state.changes if interface.relations else 0, state.settlements if interface.contacts else 0)

    def _trajectory(self, status: int, events: list[tuple[float, int]], contacts: list[Any]) -> Trajectory:
        """The motion of a call, as messages and events need it."""
        state = self._memory.state
        known: dict[str, Any] = {"t": state.t, "x": state.x[:], "status": status, "events": events}
        known.update({name: getattr(state, name) for name in ("culprit", "steps", "rejected", "rhs")})
        known.update(times=[], states=[], step=state.t - state.t_old, sizes=state.sizes[:])
        if not self.system.interface.contacts:
            return Trajectory(**known)
        return ContactTrajectory(contacts=contacts, penetration=state.penetration, **known)

    def _current(self) -> System:
        """The system with the parameters and inputs of now."""
        return self.system.bind(self._memory.p[: len(self._fields)])

    def __getitem__(self, name: str) -> float:
        """Return the value of a quantity at the time `t`, in SI units.  Raises KeyError."""
        k = self._states.get(name)
        if k is not None:
            return float(self._memory.state.x[k])
        k = self._outputs.get(name)
        if k is not None:
            return float(self._memory.outputs()[k])
        k = self._fields.get(name)
        if k is None:
            raise self._unknown(name, {**self._states, **self._outputs, **self._fields}, "quantity")
        return float(self._memory.p[k])

    def __setitem__(self, name: str, value: float) -> None:
        """Set a parameter or an input, to a number in SI units.  Raises KeyError, TypeError if the value is
        not a number, ValueError if it is out of its bounds."""
        k = self._fields.get(name)
        if k is None:
            raise self._unknown(name, self._fields, "parameter or input")
        low, high = self._bounds[k]
        try:
            valid = low <= value <= high and isfinite(value)
        except TypeError:
            raise TypeError(f"`{name}` must be a number, not {value!r}") from None
        if not valid:
            raise ValueError(f"`{name}` must be from {low:g} to {high:g}, not {value!r}")
        self._memory.p[k] = value
        if k < self._inputs_from:
            self._memory.prepare()

    @staticmethod
    def _unknown(name: str, known: Mapping[str, int], what: str) -> KeyError:
        fault = unknown(name, known, what, "LAG0601")
        return KeyError(fault.message + (f"; {fault.remedy}" if fault.remedy else ""))

    @property
    def t(self) -> float:
        """The time in s."""
        return float(self._memory.state.t)

    @property
    def x(self) -> Array:
        """The state (q, v), a new array, in SI units."""
        import numpy

        return numpy.array(self._memory.state.x[: len(self.system.interface.state_names)])

    def copy(self) -> Stepper:
        """Return a stepper that continues from here on its own."""
        other = Stepper(self.system, self._options, self._begin)
        other._initial = self._initial
        other.restore(self)
        return other

    def restore(self, other: Stepper) -> None:
        """Go to where `other` is, a stepper of the same model, with its parameters and inputs.  Raises
        ValueError if it is of another model."""
        if other.system.interface is not self.system.interface or other.system.backend != self.system.backend:
            raise ValueError(f"{other!r} is of another model")
        self._memory.restore(other._memory)
        self._from, self._count, self._step = other._from, other._count, other._step
        self.events, self.ended, self._seen = other.events, other.ended, other._seen

    def __repr__(self) -> str:
        interface = self.system.interface
        return f"<Stepper of {interface.model}, scene {interface.scene}, at t = {self.t:g} s>"


class Steppable(Parametrized):
    """A compiled model whose motion may be advanced call by call."""

    def stepper(
        self,
        *,
        method: str | None = None,
        rtol: float | None = None,
        atol: float | None = None,
        step: Value | None = None,
        max_step: Value | None = None,
        parameters: Mapping[str, Value] | None = None,
        starts: Mapping[str, Value] | None = None,
        guesses: Mapping[str, Value] | None = None,
    ) -> Stepper:
        """Return the motion at t = 0, to be advanced call by call, with the arguments of `simulate`.

        The tolerance is that of a step (default 1e-9), or `step` is a fixed step; an error of the whole
        motion is not estimated.  The backend "auto" is C if there is a compiler.  Raises Refused as
        `simulate`."""
        request = Request(
            method=method, rtol=RTOL if rtol is None and step is None else rtol, atol=atol,
            step=seconds("step", step), max_step=seconds("max_step", max_step),
        ).completed({})  # fmt: skip
        system = self._loaded.taking(request.method or DEFAULT_METHOD).for_steps()
        found = Stepper(system.bind(self._bound(parameters)), by_hand(request), self._loaded.initialize)
        found.reset(starts, guesses)
        return found
