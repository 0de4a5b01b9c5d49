"""The solution of a run: the motion, and what it cost."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeAlias

from lagc.base.records import dataclass, field, replace
from lagc.simulation.request import unknown
from lagc.simulation.system import System
from lagc.symbolic.leaves import derived
from lagc.version import __version__

if TYPE_CHECKING:
    from numpy import float64
    from numpy.typing import NDArray

    from lagc.lowering.program import Interface
    from lagc.simulation.sensitivity.sensitivities import Sensitivities

    Array: TypeAlias = NDArray[float64]


@dataclass(frozen=True, slots=True)
class Energy:
    """The energy balance of the run, in J: imbalance = end - start - work of the non-conservative forces."""

    start: float
    end: float
    work: float

    @property
    def imbalance(self) -> float:
        return self.end - self.start - self.work


@dataclass(frozen=True, slots=True)
class Cost:
    """The cost of all integrations of a run, including those that verify its accuracy. `operations` is for
    one right-hand side.  `compile_s`, `run_s` and `start_s` are wall times in s; `start_s`, the
    initialization, is part of `run_s`, which includes a run in another backend."""

    steps: int = 0
    rejected: int = 0
    rhs: int = 0
    operations: int = 0
    compile_s: float = 0.0
    run_s: float = 0.0
    start_s: float = 0.0
    integrations: int = 1
    alone: int = 0  # right-hand sides of the returned run, without those that verify it


@dataclass(frozen=True, slots=True)
class Event:
    """An event at the time t, in s. That of a contact has a kind ("impact", "rests", "closes", "opens"), an
    impact also the normal impulse and the energy that it took (SI units)."""

    t: float
    name: str
    contact: str = ""
    kind: str = ""
    impulse: float = 0.0
    loss: float = 0.0

    def as_data(self) -> dict[str, object]:
        """The event as plain data."""
        found: dict[str, object] = {"t": self.t, "name": self.name}
        if self.contact:
            found.update(contact=self.contact, kind=self.kind)
        if self.kind == "impact":
            found.update(impulse=self.impulse, loss=self.loss)
        return found


def units_of(interface: Interface) -> dict[str, str]:
    """Return the SI units of states, rates, discrete variables and outputs by name; "" for numbers."""
    found = dict(zip(interface.state_names, interface.state_units))
    for name, unit in zip(interface.q_names, interface.q_units):
        found.setdefault(derived(name), f"{unit}/s" if unit else "1/s")
    found.update({x.name: x.unit for x in (*interface.discretes, *interface.outputs)})
    return found


def quaternion_rates(interface: Interface) -> set[str]:
    """Return the rates that are no columns: those of quaternions, because the body rates are there."""
    return {derived(interface.q_names[k + i]) for k in interface.quaternions for i in range(4)}


def columns_of(interface: Interface) -> tuple[str, ...]:
    """Return the names that are saved and printed: states, rates of coordinates, outputs."""
    parts = quaternion_rates(interface)
    return tuple([name for name in units_of(interface) if name not in parts])


@dataclass
class Solution:
    """States at the recorded times, and everything that follows from them, in SI units.

    `run["theta"]` is an array over `run.t`: a coordinate, a speed, the rate `der(theta)` of a coordinate, an
    output, or a sensitivity `d(theta)/d(l)`.  `status` is "ok", "terminated" or "failed"; a failed run keeps
    the results so far, and `message` says what happened.  `asked` is the global relative error asked for
    (None: by hand) and `estimated` its estimate (None: not verified); its norm is defined in
    `lagc.simulation.global_error.verified_run`.  `corners` are the times of events with the states before and
    after, which need not be recorded.  `system` has the parameters of the run."""

    system: System
    times: list[float]
    states: list[list[float]]
    status: str
    message: str
    method: str
    rtol: float
    atol: float
    step: float
    asked: float | None
    estimated: float | None
    position_drift: float
    velocity_drift: float
    energy: Energy
    cost: Cost
    end: float  # the end time asked for
    notes: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()
    open_reactions: tuple[str, ...] = ()
    alone: bool = False  # whether rtol is relative to each state, not to its scaling group
    # Of coordinates, speeds, outputs and discrete variables; empty for a run that is not verified
    error_bars: tuple[float, ...] = ()
    scale_values: tuple[float, ...] = ()
    events: tuple[Event, ...] = ()
    corners: tuple[tuple[float, list[float], list[float]], ...] = ()
    interrupted: bool = False
    cut: bool = False  # the motion is not predictable beyond the last time
    backend_reason: str = ""  # why `auto` chose this backend
    sensitivities: Sensitivities | None = None
    expressions: dict[str, tuple[str, list[float]]] = field(default_factory=dict)  # name: unit, values
    _columns: dict[str, list[float]] = field(default_factory=dict, repr=False)

    def __repr__(self) -> str:
        interface, t = self.system.interface, self.times[-1] if self.times else 0.0
        found = "" if self.estimated is None else f", estimated error {self.estimated:.1g}"
        return (f"<{type(self).__name__} of {interface.model}, scene {interface.scene}: {self.status}, "
                f"{len(self.times)} points to t = {t:g} s{found}>")  # fmt: skip

    @property
    def parameters(self) -> list[float]:
        """The array p of the run: parameters, then inputs."""
        return list(self.system.parameters)

    @property
    def state_names(self) -> tuple[str, ...]:
        """The recorded states: coordinates, then speeds."""
        return self.system.interface.state_names

    @property
    def units(self) -> dict[str, str]:
        """The SI unit of every name; "" for numbers."""
        found = units_of(self.system.interface)
        found.update({name: unit for name, (unit, _) in self.expressions.items()})
        if self.sensitivities is not None:
            found.update(self.sensitivities.units(found))
        return found

    @property
    def names(self) -> tuple[str, ...]:
        """Every name that `run[...]` accepts: states, rates, discrete variables, outputs, sensitivities."""
        return tuple(self.units)

    @property
    def columns(self) -> tuple[str, ...]:
        """The names that are saved and printed: states, rates of coordinates, outputs, sensitivities."""
        parts = quaternion_rates(self.system.interface)
        if self.sensitivities is not None:
            parts.update(self.sensitivities.named(parts))
        return tuple([n for n in self.units if n not in parts])

    @property
    def t(self) -> Array:
        """The recorded times in s."""
        import numpy

        return numpy.array(self.times)

    @property
    def x(self) -> Array:
        """The recorded states, (len(t), nx): coordinates, speeds, work, discrete variables."""
        import numpy

        return numpy.array(self.states).reshape(len(self.times), self.system.nx)

    def __getitem__(self, name: str) -> Array:
        import numpy

        return numpy.array(self.column(name))

    def __contains__(self, name: str) -> bool:
        return name in self.units

    def __len__(self) -> int:
        return len(self.times)

    def column(self, name: str) -> list[float]:
        """The values of `name` at the recorded times.  Raises KeyError with similar names."""
        if not isinstance(name, str):
            raise TypeError(f"the name of a column must be a text, not {name!r}")
        found = self._columns.get(name)
        if found is not None:
            return found
        if name in self.expressions:
            return self.expressions[name][1]
        interface, states = self.system.interface, self.state_names
        discretes = [x.name for x in interface.discretes]
        if name in states or name in discretes:
            i = (
                states.index(name)
                if name in states
                else interface.nx - len(discretes) + discretes.index(name)
            )
            return self._columns.setdefault(name, [x[i] for x in self.states])
        if self.sensitivities is not None and name in self.sensitivities:
            return self._columns.setdefault(name, self.sensitivities.column(name))
        if name not in self.units:
            fault = unknown(name, self.units, "quantity", "LAG0601")
            raise KeyError(fault.message + (f"; {fault.remedy}" if fault.remedy else ""))
        if name in {o.name for o in self.system.interface.outputs}:
            self._fill_outputs()
        else:
            self._fill_rates()
        return self._columns[name]

    def sensitivity(self, name: str, by: str) -> Array:
        """d(name)/d(by) at the recorded times, by a parameter or an initial value that the run was asked
        for."""
        return self[f"d({name})/d({by})"]

    @property
    def final(self) -> dict[str, float]:
        """Every column at the last recorded time."""
        last = replace(self, times=self.times[-1:], states=self.states[-1:], _columns={})
        last.expressions = {name: (unit, x[-1:]) for name, (unit, x) in self.expressions.items()}
        if self.sensitivities is not None:
            last.sensitivities = self.sensitivities.last()
        return {name: last.column(name)[0] for name in self.columns} if self.times else {}

    @property
    def accuracy(self) -> dict[str, float | None]:
        """The global relative error: "asked" and "estimated"."""
        return {"asked": self.asked, "estimated": self.estimated}

    @property
    def errors(self) -> dict[str, float]:
        """The estimated largest absolute error of each coordinate, speed, output and discrete variable; empty
        for a run that is not verified."""
        return self._by_name(self.error_bars)

    @property
    def scales(self) -> dict[str, float]:
        """The value that the accuracy of each of these is relative to; 0 for one that round-off moves."""
        return self._by_name(self.scale_values)

    def _by_name(self, values: tuple[float, ...]) -> dict[str, float]:
        interface = self.system.interface
        names = (*self.state_names, *(x.name for x in (*interface.outputs, *interface.discretes)))
        return dict(zip(names, values))

    @property
    def drift(self) -> dict[str, float]:
        """The largest scaled residuals of the constraints over all steps: "position" and "velocity"."""
        return {"position": self.position_drift, "velocity": self.velocity_drift}

    def metadata(self) -> dict[str, object]:
        """The metadata that a saved file contains, as plain data."""
        interface = self.system.interface
        fields = (*interface.parameters, *interface.inputs)
        return {
            "tool": f"lagc {__version__}", "model": interface.model, "scene": interface.scene,
            "effects": list(interface.effects), "source": interface.source_name,
            "model_hash": interface.model_hash, "backend": self.system.backend,
            "method": self.method, "rtol": self.rtol, "atol": self.atol, "step": self.step,
            "parameters": {f.name: v for f, v in zip(fields, self.parameters)},
            "units": {"time": "s", **self.units},
            "accuracy": self.accuracy, "errors": self.errors, "scales": self.scales, "drift": self.drift,
            "status": self.status, "message": self.message,
            "events": [e.as_data() for e in self.events],
            **self._varied(),
        }  # fmt: skip

    def _varied(self) -> dict[str, object]:
        return {} if self.sensitivities is None else {"sensitivity": self.sensitivities.as_data()}

    def to_dict(self) -> dict[str, object]:
        """The object that `lagc sim --json` prints."""
        interface = self.system.interface
        cost, energy = self.cost, self.energy
        return {
            "status": self.status, "message": self.message, "model": interface.model,
            "scene": interface.scene, "effects": list(interface.effects), "backend": self.system.backend,
            "method": self.method, "t": self.times[-1] if self.times else 0.0, "final": self.final,
            "events": [e.as_data() for e in self.events],
            "accuracy": self.accuracy, "errors": self.errors, "scales": self.scales,
            **self._varied(), "drift": self.drift,
            "energy": {"of": interface.balance, "start": energy.start, "end": energy.end, "work": energy.work,
                       "imbalance": energy.imbalance},
            "cost": {"steps": cost.steps, "rejected": cost.rejected, "rhs": cost.rhs, "alone": cost.alone,
                     "operations": cost.operations, "compile_s": cost.compile_s, "run_s": cost.run_s,
                     "start_s": cost.start_s},
            "warnings": list(self.warnings), "dropped": list(interface.dropped),
            "open_reactions": list(self.open_reactions), "notes": list(self.notes),
        }  # fmt: skip

    def to_pandas(self) -> object:
        """Return a pandas DataFrame: one column for each quantity, indexed by time, with the metadata in
        `attrs`. Raises ImportError if pandas is not installed."""
        import importlib

        try:
            pandas = importlib.import_module("pandas")
        except ImportError:
            raise ImportError("a table needs pandas: pip install pandas") from None
        frame = pandas.DataFrame({n: self[n] for n in self.columns}, index=pandas.Index(self.t, name="time"))
        frame.attrs.update(self.metadata())
        return frame

    def _fill_rates(self) -> None:
        system = self.system
        nq = system.nq
        rows: list[list[float]] = []
        for t, x in zip(self.times, self.states):
            xdot, lam = [0.0] * system.nx, [0.0] * system.nc
            system.rhs(t, x, xdot, lam)
            rows.append(xdot[:nq])
        for i, name in enumerate(system.interface.q_names):
            self._columns.setdefault(derived(name), [row[i] for row in rows])

    def _fill_outputs(self) -> None:
        system = self.system
        rows = [system.outputs(t, x) for t, x in zip(self.times, self.states)]
        for i, output in enumerate(system.interface.outputs):
            self._columns.setdefault(output.name, [row[i] for row in rows])
