"""Kinds of states: coordinates, or speeds, of one unit, which share a size.

Kind 0 are the coordinates that are numbers, as angles are, also where there are none.
"""

from __future__ import annotations

from collections.abc import Sequence

from lagc.semantics.units import NONE, Dimension, S, over, unit


def kinds(q_units: Sequence[str], v_units: Sequence[str]) -> tuple[int, ...]:
    """The kind of each coordinate, then of each speed; those of coordinates come first."""
    known: dict[tuple[str, Dimension], int] = {("q", NONE): 0}
    states = [("q", _dimension(u)) for u in q_units] + [("v", _dimension(u)) for u in v_units]
    return tuple([known.setdefault(state, len(known)) for state in states])


def rates(q_units: Sequence[str], v_units: Sequence[str]) -> dict[int, int]:
    """The kinds of coordinates, each with the kind of speeds that are its rates, where there is one."""
    states = kinds(q_units, v_units)
    speeds = {_dimension(u): kind for u, kind in zip(v_units, states[len(q_units) :])}
    pairs = {kind: speeds.get(over(_dimension(u), S)) for u, kind in zip(q_units, states)}
    return {kind: speed for kind, speed in pairs.items() if speed is not None}


def _dimension(text: str) -> Dimension:
    return unit(text or "1").dimension
