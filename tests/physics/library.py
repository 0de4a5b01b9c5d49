"""Every scene of every model of the library, compiled once for all tests."""

from __future__ import annotations

from functools import cache

import lagc
from lagc.host.model_library import library_models


@cache
def scenes() -> tuple[tuple[str, str], ...]:
    """(model, scene), sorted."""
    found = []
    for name in library_models():
        model = lagc.load(name).compile(backend="numpy").model
        found += [(name, scene) for scene in model.scenes or ("default",)]
    return tuple(found)


@cache
def fullest() -> tuple[tuple[str, str], ...]:
    """(model, scene) with the scene of each model that uses the most effects."""
    found: dict[str, tuple[int, str]] = {}
    for name, scene in scenes():
        count = sum(effect.used for effect in compiled(name, scene, "numpy").model.effects)
        if name not in found or count > found[name][0]:
            found[name] = (count, scene)
    return tuple((name, scene) for name, (_, scene) in found.items())


@cache
def compiled(name: str, scene: str, backend: str) -> lagc.CompiledModel:
    return lagc.load(name).compile(scene, backend=backend)


def brief(system: lagc.CompiledModel) -> float:
    """A stop time that shows the motion and costs little, s."""
    return min(2.0, float(system.interface.simulate.get("stop", 2.0)))
