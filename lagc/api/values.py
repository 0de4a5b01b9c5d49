"""Values as Python users give them: numbers, pairs of a number and its unit, texts, points over time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, SupportsFloat, TypeAlias

from lagc.base.text import Given, Quantity, number
from lagc.compiler.loaded import Loaded
from lagc.diagnostics.faults import Fault, Refused, Source
from lagc.simulation.request import bound_parameters, expression, si

if TYPE_CHECKING:
    from lagc.compiler.artifact import Artifact
    from lagc.lowering.program import Interface
    from lagc.semantics.context import Points

MOST_LISTED = 8  # names of entries in a message

Value: TypeAlias = float | tuple[float, str] | Quantity
Input: TypeAlias = "Value | str | tuple[Sequence[float], Sequence[float]] | Points"


def separate(
    given: Mapping[str, Input] | None,
) -> tuple[dict[str, float | Quantity], dict[str, Source | Points]]:
    """Separate inputs that are numbers from all others."""
    numbers: dict[str, float | Quantity] = {}
    courses: dict[str, Source | Points] = {}
    for name, value in _named("inputs", given).items():
        if isinstance(value, str):
            courses[name] = expression(value)
        elif isinstance(value, tuple) and value and hasattr(value[0], "__len__"):
            courses[name] = _points(name, *value)
        else:
            numbers[name] = _quantity(name, value)
    return numbers, courses


def _points(name: str, *given: Any) -> Points:
    try:
        times, values, *kind = given
        (method,) = kind or ["linear"]
        return tuple(map(float, times)), tuple(map(float, values)), str(method)
    except (TypeError, ValueError, OverflowError):
        message = f'`{name}` must be a number, a text, or `(t, values)` or `(t, values, "cubic")`'
        raise Refused([Fault("LAG0602", message)]) from None


def quantities(what: str, given: Mapping[str, Value] | None) -> dict[str, float | Quantity]:
    """Values by their names; `what` names the argument in messages."""
    return {name: _quantity(name, value) for name, value in _named(what, given).items()}


def _named(what: str, given: Any) -> Mapping[str, Any]:
    """Return the mapping of values by name; empty for None.  Raises TypeError."""
    if given is None:
        return {}
    if not isinstance(given, Mapping) or not all(isinstance(name, str) for name in given):
        raise TypeError(f"`{what}` must be values by name, {{'name': value}}, not {given!r}")
    return given


def _quantity(name: str, value: Value) -> float | Quantity:
    if isinstance(value, Quantity):
        return value
    try:
        if isinstance(value, tuple):
            written, unit = value
            return Quantity(real(name, written), unit)
        return real(name, value)
    except (TypeError, ValueError, OverflowError):
        remedy = 'a number with its unit is a pair: `(30, "deg")`'
        raise Refused(
            [Fault("LAG0602", f"`{name}` must be a number, not {value!r}", remedy=remedy)]
        ) from None


def real(name: str, value: object) -> float:
    """Return a number; a text is read as strictly as on the command line.  Raises ValueError or TypeError."""
    if type(value) is float:  # of perhaps a million
        return value
    if isinstance(value, SupportsFloat):
        try:
            return float(value)
        except OverflowError:  # an integer
            raise ValueError(f"`{name}` is too large") from None
    found = number(value) if isinstance(value, str) else None
    if found is None:
        kind = ValueError if isinstance(value, str) else TypeError
        raise kind(f"`{name}` must be a number, not {value!r}")
    return found


def reals(name: str, values: Sequence[float], wanted: int, names: Sequence[str] = ()) -> list[float]:
    """`wanted` numbers, with their `names` for messages.  Raises ValueError or TypeError."""
    shape = getattr(values, "shape", (0,))
    if isinstance(values, str) or not hasattr(values, "__len__"):
        raise TypeError(f"{name} must be a sequence of {wanted} numbers, not {values!r}")
    if len(shape) != 1:
        raise ValueError(f"{name} has the shape {tuple(shape)}, not ({wanted},)")
    if len(values) != wanted:
        more = ["..."] if len(names) > MOST_LISTED else []
        listed = ": " + ", ".join([*names[:MOST_LISTED], *more]) if names else ""
        raise ValueError(f"{name} has {len(values)} entries, not {wanted}{listed}")
    return [real(name, value) for value in values]


def words(what: str, given: str | Sequence[str]) -> tuple[str, ...]:
    """Names; a single text is one name.  Raises TypeError."""
    found = (given,) if isinstance(given, str) else tuple(given)
    if not all(isinstance(name, str) for name in found):
        raise TypeError(f"`{what}` must be names, not {given!r}")
    return found


def word(what: str, given: str | None) -> str | None:
    """Return a text or None.  Raises TypeError."""
    if not isinstance(given, str | None):
        raise TypeError(f"`{what}` must be a text, not {given!r}")
    return given


def condition(given: str | None) -> str | None:
    """Return the condition `until`.  Raises TypeError, or Refused if the text is empty."""
    if word("until", given) is not None and not str(given).strip():
        raise Refused([Fault("LAG0604", "`until` needs a condition, such as 'x > 3 [m]'")])
    return given


def seconds(name: str, value: Value | None) -> float | None:
    if value is None:
        return None
    faults: list[Fault] = []
    found = si(name, _quantity(name, value), "s", faults)
    if faults:
        raise Refused(faults)
    return found


class Parametrized:
    """A compiled model with values of its parameters."""

    _loaded: Loaded
    _given: Given

    @property
    def artifact(self) -> Artifact:
        """The generated code and its interface."""
        return self._loaded.artifact

    @property
    def interface(self) -> Interface:
        """Names, units and sizes of states, parameters, inputs and outputs."""
        return self.artifact.interface

    def _bound(self, parameters: Mapping[str, Value] | None, demanding: bool = True) -> list[float]:
        given = self._with_given(parameters) if parameters is not None else self._given
        return bound_parameters(self.interface, given, self.artifact.unused, demanding)

    def _with_given(self, parameters: Mapping[str, Value]) -> dict[str, float | Quantity]:
        """Return the values of this model, replaced by those of `parameters`."""
        more = quantities("parameters", parameters)
        for name in self.artifact.built_in:
            if name in more and more[name] != self._given.get(name):
                fault = Fault("LAG0607", f"`{name}` is built into the compiled model: no run can change it",
                              remedy="give it to `compile(parameters=...)`")  # fmt: skip
                raise Refused([fault])
        return {**self._given, **more}
