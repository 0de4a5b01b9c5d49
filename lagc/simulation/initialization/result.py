"""The state to begin with, and what had to move for it, or what contradicts what."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

from lagc.base.records import dataclass
from lagc.simulation.system import more

_MOST_FOUND = 6  # values or conditions that are named in one note
_MOST_ALIKE = 2  # conditions of a family that are named one by one
_DIGITS = 6  # of a value, more where it differs from another only behind them
_SLIGHTLY = 0.01  # of their size: moves such as rounding leaves


@dataclass(frozen=True, slots=True)
class Change:
    """A start value that differs from the given one, in SI; the four parts of a stated orientation. `forced`
    are the conditions that forced the change of a stated value."""

    name: str
    given: float | tuple[float, ...]
    used: float | tuple[float, ...]
    unit: str
    stated: bool = False
    place: str = ""
    forced: tuple[str, ...] = ()
    share: float = 0.0  # how far it moved, of its size

    def __str__(self) -> str:
        place = f" ({self.place})" if self.place else ""
        forced = f", because of {_listed(self.forced)}" if self.forced else ""
        digits = _DIGITS
        while digits < 17 and _value(self.used, "", digits) == _value(self.given, "", digits):
            digits += 1
        values = f"{_value(self.used, self.unit, digits)} instead of {_value(self.given, self.unit, digits)}"
        return f"`{self.name}` starts at {values}{place}{forced}"


# A part of the model: ("row", label), ("initial", number), ("start" or "state" or "speed", name).
Anchor: TypeAlias = tuple[str, str]


@dataclass(frozen=True, slots=True)
class Unmet:
    """A condition that the start does not meet: `name` as the user knows it, by how much (SI)."""

    name: str
    amount: float
    unit: str
    anchor: Anchor

    def __str__(self) -> str:
        if not abs(self.amount) < float("inf"):
            return f"{self.name} is no finite number there"
        return f"{self.name} is missed by {self.amount:.3g}{' ' + self.unit if self.unit else ''}"


def unmet_lines(unmet: Sequence[Unmet]) -> list[str]:
    """A sentence for each, and one for those of a family: elements of arrays, and their instances."""
    import re

    families: dict[tuple[str, bool], list[Unmet]] = {}
    for one in unmet:
        family = re.sub(r"\[[^\]]*\]", "[]", one.name), abs(one.amount) < float("inf")
        families.setdefault(family, []).append(one)
    found: list[str] = []
    for (_, finite), members in families.items():
        worst = max(members, key=lambda one: abs(one.amount)) if finite else members[0]
        others = f"{len(members) - 1} more of its kind"
        if len(members) > _MOST_ALIKE:
            found.append(f"{worst}, and {others} by no more" if finite else f"{worst}, nor are {others}")
        else:
            found += map(str, members)
    return found


@dataclass(frozen=True, slots=True)
class Start:
    """The initial state. `unmet` is empty if it is consistent; else these conditions and the fixed values
    `held` are a minimal contradiction."""

    x: list[float]
    changes: tuple[Change, ...] = ()
    unmet: tuple[Unmet, ...] = ()
    held: tuple[str, ...] = ()
    anchors: tuple[Anchor, ...] = ()  # of the values held
    beyond: tuple[str, ...] = ()  # lines on bounds that the given start is beyond by little
    seconds: float = 0.0  # that it took

    @property
    def notes(self) -> tuple[str, ...]:
        """Return a line for each stated value that moved, or one line if they are many or moved little; and
        one line for the other values."""
        stated = [c for c in self.changes if c.stated]
        found = [c for c in self.changes if not c.stated]
        lines = [str(c) for c in stated]
        if len(stated) > _MOST_FOUND or (len(stated) > 2 and max(c.share for c in stated) < _SLIGHTLY):
            lines = [_summary(stated)]
        if found:
            shown = [f"`{c.name}` = {_value(c.used, c.unit)}" for c in found[:_MOST_FOUND]]
            lines.append(f"found for the start: {', '.join(shown)}{more(found, _MOST_FOUND)}")
        return (*lines, *self.beyond)


def _summary(changes: Sequence[Change]) -> str:
    """Return a line that says which stated values moved, and why."""
    forced = list(dict.fromkeys(name for c in changes for name in c.forced))
    shown = ", ".join(f"`{c.name}`" for c in changes[:_MOST_FOUND]) + more(changes, _MOST_FOUND)
    reason = f" to meet {', '.join(forced[:_MOST_FOUND])}{more(forced, _MOST_FOUND)}" if forced else ""
    return (
        f"stated values moved by at most {max(c.share for c in changes):.2g} of their size{reason}: {shown}"
    )


def _listed(parts: Sequence[str]) -> str:
    if len(parts) > _MOST_FOUND:
        return f"{', '.join(parts[:_MOST_FOUND])}{more(parts, _MOST_FOUND)}"
    return parts[0] if len(parts) == 1 else f"{', '.join(parts[:-1])} and {parts[-1]}"


def _value(value: float | tuple[float, ...], unit: str, digits: int = _DIGITS) -> str:
    if isinstance(value, tuple):
        return "{" + ", ".join(f"{a:.{digits}g}" for a in value) + "}"
    return f"{value:.{digits}g} {unit}" if unit else f"{value:.{digits}g}"
