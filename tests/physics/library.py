"""Every scene of every model of the library, compiled once for all tests."""

from __future__ import annotations

from functools import cache

import lagc
from lagc.library import library_models


@cache
def scenes() -> tuple[tuple[str, str], ...]:
    """(model, scene), sorted."""
    found = []
    for name in library_models():
        model = lagc.load(name).compile(backend="numpy").model
        found += [(name, scene) for scene in model.scenes or ("default",)]
    return tuple(found)


@cache
def compiled(name: str, scene: str, backend: str) -> lagc.CompiledModel:
    return lagc.load(name).compile(scene, backend=backend)


def brief(system: lagc.CompiledModel) -> float:
    """A stop time that shows the motion and costs little, s."""
    return min(2.0, float(system.interface.simulate.get("stop", 2.0)))
