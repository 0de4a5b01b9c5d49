"""The sensitivities of a run as a record, and the parameters and initial values that they refer to."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from lagc.base.records import dataclass, field, replace
from lagc.diagnostics.faults import Fault, Refused
from lagc.lowering.program import Field, Interface
from lagc.semantics.units import UnknownUnit, quotient
from lagc.simulation.linearization.derivatives import Array, Point
from lagc.simulation.request import unknown
from lagc.symbolic.leaves import derived

if TYPE_CHECKING:
    from lagc.simulation.backends.python import NumpySystem
    from lagc.simulation.system import System

CLEAR = 10.0  # times the round-off: a sensitivity that is significant
FAINT = 1e-14  # of the terms of its rates: round-off of S


@dataclass(frozen=True, slots=True)
class Direction:
    """A parameter or initial value: its index in p (`parameter`) or x (`state`), or neither if it has no
    effect."""

    name: str
    unit: str
    parameter: int | None = None
    state: int | None = None


@dataclass(frozen=True, slots=True)
class Mode:
    """The code of a motion, in one mode of its contacts: the system with the derivatives of its equations,
    the one with the kernels that follow S, and the directions as its parameters and states."""

    system: NumpySystem
    followed: System
    directions: tuple[Direction, ...]

    def of(self, kept: Sequence[int]) -> Mode:
        """The same with these directions."""
        return replace(self, directions=tuple([self.directions[k] for k in kept]))

    @property
    def parameters(self) -> tuple[list[int], list[int]]:
        """The directions that are parameters, and the indices of these in p."""
        found = [(k, d.parameter) for k, d in enumerate(self.directions) if d.parameter is not None]
        return [k for k, _ in found], [place for _, place in found]


def directions(
    interface: Interface, names: Sequence[str], unused: Sequence[Field], built_in: Collection[str]
) -> tuple[Direction, ...]:
    """The directions named `l`, `start(theta)` or `start(der(theta))`, each once; all entries of an array.
    Raises Refused: LAG0601, LAG0606 for an unknown name, LAG0607 for a parameter that is part of the code."""
    # Not differentiated are friction of two-sided contacts, actuators of constraints, discrete variables.
    rough = [contact.name for contact in interface.contacts if contact.normals]
    if rough:
        message = f"sensitivities do not follow the friction of `{rough[0]}` yet"
        raise Refused([Fault("LAG0623", message, remedy="compare runs with values that differ a little")])
    held = [k for k, by in zip(interface.loading_rows, interface.held_rows) if by]
    if held:
        message = f"sensitivities do not follow the actuator that holds `{interface.row_labels[held[0]]}` yet"
        raise Refused([Fault("LAG0623", message, remedy="compare runs with values that differ a little")])
    if len(interface.discretes) > len(interface.contacts):
        message = (
            f"`{interface.discretes[0].name}` is a discrete variable: its jumps are not differentiated, so "
            "runs of this model have no sensitivities"
        )
        raise Refused([Fault("LAG0622", message, remedy="compare runs with values that differ a little")])
    fields = [*interface.parameters, *interface.inputs]
    given = {f.name: Direction(f.name, f.unit, parameter=k) for k, f in enumerate(fields)}
    given.update((f.name, Direction(f.name, f.unit)) for f in unused)
    states = [*zip(interface.q_names, interface.q_units), *zip(interface.v_names, interface.v_units)]
    starts = {name: Direction(f"start({name})", unit, state=k) for k, (name, unit) in enumerate(states)}
    # A name is that of a parameter or an input, or `start(...)` of a coordinate or speed.
    faults: list[Fault] = []
    found: dict[str, Direction] = {}
    for word in names:
        name = word.strip()
        at = name[len("start(") : -1].strip() if name.startswith("start(") and name.endswith(")") else None
        meant = _meant(name, given) if at is None else _meant(at, starts)
        if name in built_in:
            fault = f"`{name}` is built into the compiled model: nothing is differentiated by it"
            faults.append(Fault("LAG0607", fault))
        elif meant:
            found.update((d.name, d) for d in meant)
        elif not (name if at is None else at):
            faults.append(Fault("LAG0601", "a name of `sensitivity` is empty"))
        elif at is not None:
            faults.append(unknown(at, starts, "coordinate or speed", "LAG0606"))
        elif name in starts:
            fault = f"`{name}` is no parameter, and has no one value"
            faults.append(Fault("LAG0601", fault, remedy=f"by its start: `start({name})`"))
        else:
            faults.append(unknown(name, given, "parameter", "LAG0601"))
    if faults:
        raise Refused(faults)
    return tuple(found.values())


def _meant(name: str, known: Mapping[str, Direction]) -> list[Direction]:
    """The directions of a name: its own, or those of the entries of an array."""
    if name in known:
        return [known[name]]
    stem, closed = (name[:-1], "])") if name.startswith("der(") else (name, "]")
    return [d for own, d in known.items() if name and own.startswith(f"{stem}[") and own.endswith(closed)]


@dataclass
class Sensitivities:
    """The sensitivities of a run.

    `mode_of` returns the code for a whole state. `values` is d(q, v)/dtheta at the recorded times, (times, nq
    + nv, directions), in SI units; NaN without a value.  `estimated` is the largest error over all times,
    relative to the largest sensitivity of the same scaling group to the same theta; None if unknown.
    `doubts`, (nq + nv, directions), is the error of `values` by the estimate or by round-off.  `message`
    tells why they end early or miss the accuracy.  The cost is that of all integrations, with an evaluation
    of the derivatives for each step."""

    mode_of: Callable[[Sequence[float]], Mode]
    directions: tuple[Direction, ...]
    times: list[float]
    states: list[list[float]]
    values: Array
    doubts: Array
    estimated: float | None
    message: str
    interrupted: bool
    steps: int
    rejected: int
    integrations: int
    run_s: float
    _columns: dict[str, Array] = field(default_factory=dict, repr=False)
    _doubts: dict[str, Array] = field(default_factory=dict, repr=False)

    def __str__(self) -> str:
        by = ", ".join([d.name for d in self.directions])
        known = "not verified" if self.estimated is None else f"estimated {self.estimated:.1e}"
        return (f"to {by}: {known}; {self.steps} steps ({self.rejected} rejected), {self.derivatives} "
                f"derivatives in {self.integrations} integrations, run {self.run_s:.3g} s")  # fmt: skip

    @property
    def derivatives(self) -> int:
        return self.steps + self.rejected

    def named(self, quantities: Iterable[str]) -> dict[str, tuple[str, Direction]]:
        """The columns of these quantities, such as `d(theta)/d(l)`, with quantity and direction."""
        return {f"d({name})/d({d.name})": (name, d) for name in quantities for d in self.directions}

    def units(self, units: Mapping[str, str]) -> dict[str, str]:
        """The units of the columns, from those of the quantities. Modes of contacts have no derivatives."""
        return {column: _quotient(units[name], d.unit) for column, (name, d) in self.named(units).items()
                if column in self._names}  # fmt: skip

    def __contains__(self, column: str) -> bool:
        return column in self._names

    def column(self, column: str) -> list[float]:
        """The sensitivity of a state, the rate of a coordinate or an output, at the recorded times."""
        name, direction = self._names[column]
        self._fill()
        found: list[float] = self._columns[name][:, self.directions.index(direction)].tolist()
        return found

    def doubt(self, column: str) -> float:
        """The error of a column; a smaller value is not significant."""
        name, direction = self._names[column]
        self._fill()
        return float(self._doubts[name][self.directions.index(direction)])

    @cached_property
    def _interface(self) -> Interface:
        return self.mode_of(self.states[0]).system.interface

    @cached_property
    def _names(self) -> dict[str, tuple[str, Direction]]:
        interface = self._interface
        rates = [derived(name) for name in interface.q_names]
        outputs = [o.name for o in interface.outputs]
        return self.named([*interface.state_names, *rates, *outputs])

    def last(self) -> Sensitivities:
        """The sensitivities at the last recorded time only."""
        end = slice(-1, None)
        return replace(
            self, times=self.times[end], states=self.states[end], values=self.values[end], _columns={},
            _doubts={},
        )  # fmt: skip

    def as_data(self) -> dict[str, Any]:
        """The summary for JSON."""
        return {
            "of": [d.name for d in self.directions],
            "estimated": self.estimated,
            "message": self.message,
            "cost": {"steps": self.steps, "rejected": self.rejected, "derivatives": self.derivatives,
                     "run_s": self.run_s},
        }  # fmt: skip

    def _fill(self) -> None:
        """Compute the columns of rates and outputs, and their errors, from those of the states."""
        if self._columns:
            return
        interface = self._interface
        states = interface.state_names
        rates = [derived(name) for name in interface.q_names]
        outputs = [o.name for o in interface.outputs]
        more = np.full((len(self.times), len(rates) + len(outputs), len(self.directions)), np.nan)
        off, n = np.zeros(more.shape[1:]), len(states)
        for k, (t, x, own) in enumerate(zip(self.times, self.states, self.values)):
            if np.isnan(own).all():
                continue
            with np.errstate(all="ignore"):
                mode = self.mode_of(x)
                columns, places = mode.parameters
                try:
                    point = Point(mode.system, t, x[:n])
                except ArithmeticError:
                    continue
                for part, rows in (("qdot", slice(len(rates))), ("output", slice(len(rates), None))):
                    by_state = point.total(part, "state")
                    more[k, rows] = by_state @ own
                    terms = np.abs(by_state) @ np.abs(own)
                    if places:
                        by_parameter = point.total(part, "parameter")[:, places]
                        more[k, rows, columns] += by_parameter.T
                        terms[:, columns] += np.abs(by_parameter)
                    here = np.abs(by_state) @ self.doubts + CLEAR * FAINT * terms
                    off[rows] = np.fmax(off[rows], here)
        self._doubts = dict(zip((*rates, *outputs), off)) | dict(zip(states, self.doubts))
        found = {name: self.values[:, k] for k, name in enumerate(states)}
        found.update({name: more[:, k] for k, name in enumerate((*rates, *outputs)) if name not in found})
        self._columns = found


def _quotient(above: str, below: str) -> str:
    try:
        return quotient(above, below)
    except UnknownUnit:  # a root of a unit has no name
        return f"({above or '1'})/({below})"
