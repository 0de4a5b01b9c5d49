"""Requests: what a run is asked for, and the parameter values that it is given."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from math import inf, isfinite, tau
from operator import index
from typing import Any, SupportsFloat

from lagc.base.records import dataclass, field
from lagc.base.run_options import RUN_OPTIONS
from lagc.base.text import FINEST, MOST_POINTS, Given, Quantity
from lagc.diagnostics.faults import Fault, Refused, Source
from lagc.diagnostics.suggest import did_you_mean, in_hertz, is_many_radians, many_radians
from lagc.kernels import IMPLICIT, METHODS, SERIES
from lagc.lowering.program import Field, Interface
from lagc.simulation.system import FIXED, System

ACCURACY = 1e-6  # global relative error by default
STOP = 10.0  # s
POINTS = 501  # recorded points by default


@dataclass(frozen=True)
class Request:
    """End time, accuracy and recorded grid of a run.  Times are in s; None means the scene's value, or else a
    default.

    `accuracy` is the global relative error. With `rtol`, `atol` or `step`, or a `method` alone, the run is
    controlled by hand instead. `every` or `points` give the recorded grid, or `times` are recorded besides 0;
    these do not change the steps. No step is longer than `max_step`. `starts` replaces initial values of
    coordinates and speeds by name, in SI units; `guesses` say where to search for values that are not stated.
    `scales` are those of quantities by name, in SI units: the accuracy is relative to them. `sensitivity`
    names the parameters and initial values by which the motion is differentiated."""

    stop: float | None = None
    accuracy: float | None = None
    method: str | None = None
    rtol: float | None = None
    atol: float | None = None
    step: float | None = None
    every: float | None = None
    points: int | None = None
    max_step: float | None = None
    starts: Mapping[str, float] = field(default_factory=dict)
    guesses: Mapping[str, float] = field(default_factory=dict)
    scales: Mapping[str, float] = field(default_factory=dict)
    sensitivity: tuple[str, ...] = ()
    times: tuple[float, ...] = ()
    complete: bool = False  # nothing is left to fill in

    @property
    def by_hand(self) -> bool:
        own = self.method if self.accuracy is None else None
        return any(x is not None for x in (own, self.rtol, self.atol, self.step))

    def completed(self, scene: Mapping[str, float]) -> Request:
        """Fill in the values of the scene's `simulate(...)`, then the defaults. Raises Refused (LAG0604) if a
        value is invalid."""
        if self.complete:
            return self
        values: dict[str, Any] = dict(self.__dict__)
        for name in RUN_OPTIONS:
            values[name] = _plain(name, values[name])
        gridded = self.every is not None or self.points is not None or self.times
        skipped = {"every", "points"} if gridded else set()
        if self.by_hand:
            skipped |= {"accuracy"}
        if self.accuracy is not None or self.step is not None:
            skipped |= {"rtol", "atol"}
        if self.step is not None:
            skipped |= {"max_step"}
        if any(x is not None for x in (self.accuracy, self.rtol, self.atol, self.max_step)):
            skipped |= {"step"}
        for name, option in RUN_OPTIONS.items():
            said = option.of_scene
            if values[name] is None and said in scene and name not in skipped:
                values[name] = int(scene[said]) if option.whole else scene[said]
        if self.times:
            values["stop"] = max(self.times)
        elif values["stop"] is None:
            values["stop"] = STOP
        values["complete"] = True
        done = Request(**values)
        if done.accuracy is None and not done.by_hand:
            done = Request(**{**values, "accuracy": ACCURACY})
        done.check()
        return done

    def check(self) -> None:
        """Raise Refused with all invalid values."""
        # Each value alone: its sign, and whether it is finite.
        faults = []
        for name, option in RUN_OPTIONS.items():
            value = getattr(self, name)
            if value is None or option.whole:
                continue
            if not isfinite(value) or value < 0.0 or (value == 0.0 and not option.may_be_zero):
                kind = "not negative" if option.may_be_zero else "positive"
                faults.append(_request(f"`{name}` must be {kind} and finite, not {value:g}"))
        if self.points is not None and self.points < 2:
            faults.append(_request(f"`points` must be 2 or more, not {self.points}"))
        # Control by accuracy and control by hand exclude each other.
        if self.accuracy is not None and self.by_hand:
            faults.append(_request("`accuracy` chooses the tolerance: leave it out or leave out `rtol`, "
                                   "`atol` and `step`"))  # fmt: skip
        if self.scales and self.by_hand:
            faults.append(_request("a scale belongs to an accuracy: leave out the scales or leave out "
                                   "`rtol`, `atol` and `step`"))  # fmt: skip
        for name, option in RUN_OPTIONS.items():
            value = getattr(self, name)
            if option.relative and value is not None and isfinite(value) and value >= 1.0:
                faults.append(_request(f"`{name}` is a relative {option.relative}, below 1, not {value:g}"))
        if self.rtol is not None and 0.0 < self.rtol < FINEST:
            faults.append(_request(f"`rtol` is below {FINEST:g}, the limit of double precision"))
        if self.rtol == 0.0 and not self.atol:
            faults.append(_request("one of `rtol` and `atol` must be positive"))
        # The method, and what it can do.
        if self.method is not None and self.method not in METHODS:
            faults.append(_request(f"`method` is one of {', '.join(METHODS)}, not {self.method!r}"))
        elif self.method is not None and self.step is None and not _adapts(self.method):
            faults.append(_request(f"`{self.method}` has no error estimate: give it a fixed `step`"))
        if self.method in (*IMPLICIT, *SERIES) and self.sensitivity:
            faults.append(
                _request(
                    f"`sensitivity` follows explicit Runge-Kutta methods only: leave out `{self.method}`"
                )
            )
        if self.step is not None and (self.rtol is not None or self.atol is not None):
            faults.append(_request("a fixed `step` has no tolerance: leave out `rtol` and `atol`"))
        if self.step is not None and self.max_step is not None:
            faults.append(_request("a fixed `step` excludes `max_step`: leave one out"))
        # The grid of recorded times.
        if not all(0.0 <= t < inf for t in self.times):
            faults.append(_request("recorded times must be finite and not negative"))
        if self.every is not None and self.points is not None:
            faults.append(_request("`every` and `points` both give the grid: leave one out"))
        if self.every and self.stop and not faults and self.stop / self.every > MOST_POINTS:
            faults.append(_request(f"a point every {self.every:g} s makes more than {MOST_POINTS:,} points"))
        if self.points is not None and self.points > MOST_POINTS:
            faults.append(_request(f"`points` is more than {MOST_POINTS:,}"))
        if faults:
            raise Refused(faults)

    def size(self) -> int:
        """The number of recorded points."""
        stop = self.stop or 0.0
        if self.times:
            return len(self.times) + 1
        if stop == 0.0:
            return 1
        if self.every is not None:
            return int(stop / self.every * (1.0 - 1e-12)) + 2
        return self.points or POINTS

    def grid(self) -> list[float]:
        """The recorded times, from 0 to `stop` inclusive."""
        if self.times:
            return sorted({0.0, *self.times})
        stop, n = self.stop or 0.0, self.size() - 1
        if self.every is not None:
            return [*(k * self.every for k in range(n)), stop]
        if not isfinite(stop * n):
            return [*(k * (stop / n) for k in range(n)), stop]
        return [*(stop * k / n for k in range(n)), stop]


_COLUMN = r"""(?i)([^"]+\.csv)(?::([^"]+))?"""


def expression(text: str) -> Source:
    """The source text of an input: an expression, or `drive.csv:u` for the column u over time."""
    import re

    column = re.fullmatch(_COLUMN, text.strip())
    if column is not None:
        named = [word.replace("\\", "\\\\") for word in column.groups() if word is not None]
        words = ", ".join(f'"{word}"' for word in named)
        text = f"table(time, {words})"
    return Source("<input>", text, asked=True)


def bound_parameters(
    interface: Interface, given: Given, unused: Sequence[Field] = (), demanding: bool = True
) -> list[float]:
    """Return the array p in SI units: the model's values, replaced by the `given` ones. Parameters without a
    value are NaN if `demanding` is False.  Raises Refused: LAG0601 unknown name, LAG0602 out of its bounds or
    not a number, LAG0603 no value, LAG0605 wrong unit, LAG0617 a value of the model out of bounds."""
    fields = [*interface.parameters, *interface.inputs]
    faults: list[Fault] = []
    values = given_values(given, (*fields, *unused), faults)
    result: list[float] = []
    for f in fields:
        found = values.get(f.name, f.value)
        if found is not None and f.name not in given:
            faults += _bounds(f, found, "LAG0617")
        if found is None:
            if demanding and f.name not in given:
                unit = f" [{f.unit}]" if f.unit else ""
                faults.append(Fault("LAG0603", f"parameter `{f.name}`{unit} ({f.place}) has no value",
                                    remedy=f"give it one: -p {f.name}=..."))  # fmt: skip
            found = float("nan")
        result.append(found)
    if faults:
        raise Refused(faults)
    return result


def given_values(given: Given, fields: Iterable[Field], faults: list[Fault]) -> dict[str, float]:
    """The valid values in SI units; errors are appended to `faults`."""
    known = {f.name: f for f in fields}
    values: dict[str, float] = {}
    for name, number in given.items():
        if name not in known:
            faults.append(unknown(name, known, "parameter or input", "LAG0601"))
            continue
        value = si(name, number, known[name].unit, faults)
        if value is not None:
            faults += _bounds(known[name], value)
            values[name] = value
    return values


def angle_warnings(given: Mapping[str, object], units: Mapping[str, str]) -> list[Fault]:
    """Return warnings of given angles that look like degrees, and of angular velocities in hertz; `units` are
    those of quantities by name."""
    found: list[Fault] = []
    for name, number in given.items():
        if not isinstance(number, Quantity):
            continue
        if number.unit is None and units.get(name) == "rad" and is_many_radians(number.value):
            found.append(many_radians(name, f"{abs(number.value):g}", "-" if number.value < 0.0 else ""))
        elif (number.unit or "").endswith("Hz") and units.get(name) == "rad/s":
            found.append(in_hertz(name, f"for a frequency give {tau:.10g} times the number"))
    return found


def is_of_other_value(warning: str, given: Mapping[str, object]) -> bool:
    """Whether a warning, with its code, is of a quantity that gets another value."""
    codes = ("LAG0618", "LAG0619")
    return warning.startswith(tuple([f"{code}: `{name}` is " for name in given for code in codes]))


def warnings_of(interface: Interface, given: Mapping[str, object]) -> tuple[str, ...]:
    """Return the warnings of a model with the given parameters, inputs and initial values."""
    units = {f.name: f.unit for f in (*interface.parameters, *interface.inputs)}
    units.update(zip(interface.state_names, interface.state_units))
    more = [f"{fault.code}: {fault.message}; {fault.remedy}" for fault in angle_warnings(given, units)]
    return (*[w for w in interface.warnings if not is_of_other_value(w, given)], *more)


def keep_limits(system: System) -> None:
    """Raise Refused (LAG0617) if a value derived from parameters is out of its bounds."""
    limits = system.interface.limits
    if limits and not any(p != p for p in system.parameters):
        faults = [
            fault
            for f, value in zip(limits, system.limits())
            for fault in _bounds(f, value, "LAG0617", f.description)
        ]
        if faults:
            raise Refused(faults)


def bound_starts(interface: Interface, given: Given) -> dict[str, float]:
    """Return initial values by name in SI units.  Raises Refused: LAG0606 unknown name, LAG0602, LAG0605."""
    units = dict(zip(interface.state_names, interface.state_units))
    units.update({x.name: x.unit for x in interface.discretes})
    truths = {x.name for x, truth in zip(interface.discretes, interface.booleans) if truth}
    faults: list[Fault] = []
    found: dict[str, float] = {}
    for name, number in given.items():
        if name not in units:
            what = "coordinate, speed or discrete variable" if interface.discretes else "coordinate or speed"
            faults.append(unknown(name, units, what, "LAG0606"))
            continue
        value = si(name, number, units[name], faults)
        if name in truths and value not in (0.0, 1.0, None):
            message = f"`{name}` is true or false, not {value:g}"
            faults.append(Fault("LAG0602", message, remedy="give 1 for true, 0 for false"))
        elif value is not None:
            found[name] = value
    if faults:
        raise Refused(faults)
    return found


def bound_guesses(interface: Interface, given: Given, starts: Given) -> dict[str, float]:
    """Return guesses by name in SI units.  Raises Refused as `bound_starts`, and LAG0608 for a value that is
    fixed or stated for the run too."""
    found = bound_starts(interface, given)
    held = [name for name, level in zip(interface.state_names, interface.start_levels) if level == FIXED]
    faults = [
        Fault("LAG0608", f"a guess for `{name}` has no effect: its initial value is {why}")
        for names, why in ((held, "fixed"), (starts, "stated for this run"),
                           ([x.name for x in interface.discretes], "what the model or `--start` says"))
        for name in names if name in found
    ]  # fmt: skip
    if faults:
        raise Refused(faults)
    return found


def bound_scales(interface: Interface, given: Given) -> dict[str, float]:
    """Return scales of quantities by name in SI units.  Raises Refused (LAG0601 for a name, LAG0602 or
    LAG0605 for a value)."""
    from lagc.simulation.error_measure import quantity_names, quantity_units

    units = dict(zip(quantity_names(interface), quantity_units(interface)))
    faults: list[Fault] = []
    found: dict[str, float] = {}
    for name, number in given.items():
        if name not in units:
            faults.append(unknown(name, units, "quantity", "LAG0601"))
            continue
        value = si(name, number, units[name], faults)
        if value is not None and not value > 0.0:
            faults.append(Fault("LAG0602", f"the scale of `{name}` must be positive, not {value:g}"))
        elif value is not None:
            found[name] = value
    if faults:
        raise Refused(faults)
    return found


def si(name: str, number: float | Quantity, unit: str, faults: list[Fault]) -> float | None:
    """Return `number` in SI units, where `unit` is the SI unit of `name`; None after adding a fault."""
    if not isinstance(number, Quantity):
        value = float(number)
    elif number.unit is None:
        value = number.value
    else:
        from lagc.semantics.units import UnknownUnit, to_si
        from lagc.semantics.values.unit_hints import spelling_remedy

        try:
            value = to_si(number.value, number.unit, unit)
        except UnknownUnit as error:
            faults.append(Fault("LAG0605", f"`{name}`: {error.reason}", remedy=spelling_remedy(error.text)))
            return None
    if not isfinite(value):
        faults.append(Fault("LAG0602", f"`{name}` must be a finite number, not {value:g}"))
        return None
    return value


def unknown(name: str, known: Iterable[str], what: str, code: str) -> Fault:
    names = list(known)
    parts = [n for n in names if n.startswith((f"{name}[", f"{name}."))]
    remedy = did_you_mean(name, names)
    if parts:
        remedy = f"`{name}` has parts: give " + ", ".join(f"`{n}`" for n in parts[:4])
    if remedy is None and 0 < len(names) <= 12:
        remedy = "there are " + ", ".join(f"`{n}`" for n in names)
    return Fault(code, f"there is no {what} `{name}`", remedy=remedy)


def _bounds(field: Field, value: float, code: str = "LAG0602", remedy: str = "") -> list[Fault]:
    if field.whole and value % 1.0:
        return [Fault(code, f"`{field.name}` = {value:g} is not whole; it is an Integer ({field.place})")]
    if field.minimum <= value <= field.maximum:
        return []
    unit = f" {field.unit}" if field.unit else ""
    if value != value:
        return [Fault(code, f"`{field.name}` is not a number for these parameters ({field.place})")]
    low = value < field.minimum
    bound = f"below its minimum, {field.minimum:g}" if low else f"above its maximum, {field.maximum:g}"
    return [
        Fault(
            code, f"`{field.name}` = {value:g}{unit} is {bound}{unit} ({field.place})", remedy=remedy or None
        )
    ]


def _adapts(method: str) -> bool:
    from lagc.kernels.integrators.tableaus import adapts

    return adapts(method)


def _plain(name: str, value: Any) -> float | int | None:
    """The value as a Python number.  Raises Refused if it is not a number."""
    try:
        if value is None or name == "points":
            return None if value is None else index(value)
        if isinstance(value, SupportsFloat):
            return float(value)
    except (TypeError, ValueError, OverflowError):
        pass
    kind = "whole number" if name == "points" else "number"
    raise Refused([_request(f"`{name}` must be a {kind}, not {value!r}")])


def _request(message: str) -> Fault:
    return Fault("LAG0604", message)
