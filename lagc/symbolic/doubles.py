"""Numbers of equations as doubles."""

from __future__ import annotations

from lagc.diagnostics.faults import Fault, Refused


def double(value: float) -> float:
    """`value`.  Raises Refused (LAG0590) where it is infinite or none."""
    if value - value != 0.0:
        raise Refused((Fault("LAG0590", "a number of the equations is too large for a double", None),))
    return value
