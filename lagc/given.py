"""Values as Python gives them: numbers, pairs of a number and its unit, texts, points over time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, SupportsFloat, TypeAlias

from lagc.diagnostics.faults import Fault, Refused, Source
from lagc.numerals import number
from lagc.run.request import Quantity, expression, si

if TYPE_CHECKING:
    from lagc.meaning.context import Points

Value: TypeAlias = float | tuple[float, str] | Quantity
Input: TypeAlias = "Value | str | tuple[Sequence[float], Sequence[float]] | Points"


def parted(given: Mapping[str, Input]) -> tuple[dict[str, float | Quantity], dict[str, Source | Points]]:
    """Inputs that are numbers, and others."""
    numbers: dict[str, float | Quantity] = {}
    courses: dict[str, Source | Points] = {}
    for name, value in given.items():
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
        (way,) = kind or ["linear"]
        return tuple(map(float, times)), tuple(map(float, values)), str(way)
    except (TypeError, ValueError, OverflowError):
        message = f'`{name}` is given by a number, a text, or `(t, values)` or `(t, values, "cubic")`'
        raise Refused([Fault("LAG0602", message)]) from None


def quantities(given: Mapping[str, Value]) -> dict[str, float | Quantity]:
    return {name: _quantity(name, value) for name, value in given.items()}


def _quantity(name: str, value: Value) -> float | Quantity:
    if isinstance(value, Quantity):
        return value
    try:
        if isinstance(value, tuple):
            written, unit = value
            return Quantity(_float(written), unit)
        return _float(value)
    except (TypeError, ValueError, OverflowError):
        raise Refused([Fault("LAG0602", f"`{name}` must be a number, not {value!r}")]) from None


def _float(value: object) -> float:
    """Text is read as strictly as on the command line."""
    if isinstance(value, SupportsFloat):
        return float(value)
    found = number(value) if isinstance(value, str) else None
    if found is None:
        raise ValueError
    return found


def words(given: str | Sequence[str]) -> tuple[str, ...]:
    """Names; a text is one."""
    return (given,) if isinstance(given, str) else tuple(given)


def seconds(name: str, value: Value | None) -> float | None:
    if value is None:
        return None
    faults: list[Fault] = []
    found = si(name, _quantity(name, value), "s", faults)
    if faults:
        raise Refused(faults)
    return found
