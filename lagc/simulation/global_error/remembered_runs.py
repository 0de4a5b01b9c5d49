"""Verified runs in the cache: the same question is answered by one run at a known tolerance.

The last runs of a model are in one file, so that many runs of a model leave no more than that.
"""

from __future__ import annotations

import marshal
from collections.abc import Mapping, Sequence

from lagc.base.records import dataclass, names
from lagc.host import cache
from lagc.host.cache import tool_fingerprint
from lagc.simulation.system import System

FORMAT = 4  # of marshal, readable by every version of Python
MOST = 16  # runs of a model

Runs = dict[str, list[object]]


@dataclass
class Remembered:
    """A verified run in the cache: tolerance, whether it holds for each state alone, estimated error, last
    state, and by quantity the errors and scales; notes."""

    rtol: float
    alone: bool
    estimated: float
    end: list[float]
    errors: list[float]
    scales: list[float]
    notes: list[str]


def name_of(
    system: System, x0: Sequence[float], times: Sequence[float], accuracy: float, method: str,
    max_step: float | None, scales: Mapping[str, float],
) -> str:  # fmt: skip
    """The name of a verified run of a model, which contains everything else that determines its result."""
    given = sorted(scales.items())
    values = [repr(v) for v in (accuracy, max_step, given, list(system.parameters), list(x0), list(times))]
    return cache.key(method, system.backend, *values)


def recall(system: System, name: str) -> Remembered | None:
    found = _runs(system).get(name)
    return None if found is None else Remembered(*found)  # type: ignore[arg-type]


def remember(system: System, name: str, found: Remembered) -> None:
    """Store a verified run, and forget the oldest of the model if there are many."""
    runs = {**_runs(system), name: [getattr(found, part) for part in names(Remembered)]}
    kept = dict([*runs.items()][-MOST:])
    cache.store("accuracy", _model(system), marshal.dumps(kept, FORMAT))


def _runs(system: System) -> Runs:
    return cache.load("accuracy", _model(system), _read) or {}


def _read(body: bytes) -> Runs:
    runs: Runs = marshal.loads(body)
    for values in runs.values():
        Remembered(*values)  # type: ignore[arg-type]
    return runs


def _model(system: System) -> str:
    return cache.key("accuracy 12", tool_fingerprint(), system.interface.model_hash)
