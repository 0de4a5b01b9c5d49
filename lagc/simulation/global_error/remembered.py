"""What was found of the accuracy of a run, kept in the cache: the same question is answered by one run."""

from __future__ import annotations

import marshal
from collections.abc import Sequence

from lagc.base.records import dataclass, names
from lagc.host import cache
from lagc.host.cache.sources import tool_fingerprint
from lagc.simulation.error_measure import Sizes
from lagc.simulation.system import System, Trajectory

FORMAT = 4  # which every Python reads


def name_of(
    system: System, x0: Sequence[float], times: Sequence[float], accuracy: float, method: str,
    max_step: float | None,
) -> str:  # fmt: skip
    """The same question has the same answer, whether it is remembered or not; so all of it counts."""
    interface = system.interface
    values = [repr(v) for v in (accuracy, max_step, list(system.parameters), list(x0), list(times))]
    tool = tool_fingerprint()
    return cache.key("accuracy 8", tool, interface.model_hash, method, system.backend, *values)


@dataclass
class Remembered:
    """`end`: the last state, which the same run reaches again.  `still`: see `lagc.simulation.global_error.noise_groups`."""

    rtol: float
    estimated: float
    end: list[float]
    still: list[tuple[int, float]]


def recall(name: str) -> Remembered | None:
    return cache.load("accuracy", name, lambda body: Remembered(*marshal.loads(body)))


def remember(name: str, found: Remembered) -> None:
    cache.store("accuracy", name, marshal.dumps([getattr(found, name) for name in names(Remembered)], FORMAT))


def strays(trajectory: Trajectory, end: Sequence[float], groups: Sizes) -> float:
    """The scaled distance between the last state and `end`."""
    last = trajectory.states[-1]
    return max((abs(last[i] - end[i]) / size for group, size in groups if size for i in group), default=0.0)
