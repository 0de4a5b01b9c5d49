"""The part of generated modules that differs for models with contacts (`contacts.py`)."""

from __future__ import annotations

from typing import Any

from lagc.codegen.python.support.base import Trajectory

# -- what follows is part of generated modules --


def others_so_far(state: Any) -> int:
    """Return the number of events so far that are no changes of modes."""
    return 0


def other_events(state: Any) -> list[Any]:
    """Return those of the last event."""
    return []


def trajectory(state: Any, others: list[Any], **values: Any) -> Trajectory:
    return Trajectory(**values)


def other_inputs(work: Any) -> dict[str, Any]:
    """Return inputs of the outputs that only such models have."""
    return {}


def is_plain(x: Any) -> Any:
    """Return which of many states `rhs_many` may evaluate at once."""
    return True
