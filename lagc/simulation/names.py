"""What states, speeds and rows are called in messages."""

from __future__ import annotations

from collections.abc import Sequence

from lagc.simulation.system import System


def state_name(system: System, k: int) -> str:
    """State k, an index of x."""
    names = system.interface.state_names
    if 0 <= k < len(names):
        return f"`{names[k]}`"
    return "the work of the given actions" if k == len(names) else "a state"


def speed_name(system: System, k: int) -> str:
    names = system.interface.v_names
    return f"`{names[k]}`" if 0 <= k < len(names) else "some speed"


def row_name(system: System, k: int) -> str:
    labels = system.interface.row_labels
    return f"constraint `{labels[k]}`" if 0 <= k < len(labels) else "a constraint"


def more(parts: Sequence[object], most: int) -> str:
    """What stands for those behind the first `most`."""
    return f" and {len(parts) - most} more" if len(parts) > most else ""


def event_names(system: System, k: int) -> tuple[str, ...]:
    """Of a switch, or, behind these, of a clause `when`."""
    switches = system.interface.switches
    return (switches[k],) if k < len(switches) else system.interface.whens[k - len(switches)].names
