"""Every scene of every model of the library, compiled once for all tests."""

import re
from collections.abc import Iterator
from functools import cache

import lagc
from lagc.host.model_library import library_models, read

SCENE = re.compile(r"^\s*scene (\w+)(?: uses ([\w.]+(?:,\s*[\w.]+)*))?", re.MULTILINE)


def declared() -> Iterator[tuple[str, str, int]]:
    """Model, scene and number of effects that it names. Nothing is compiled: this is called at collection."""
    for name in library_models():
        for scene, uses in SCENE.findall(read(name).text) or [("default", "")]:
            yield name, scene, len(uses.split(",")) if uses else 0


def scenes() -> list[tuple[str, str]]:
    """(model, scene), sorted."""
    return [(name, scene) for name, scene, _ in declared()]


def fullest() -> list[tuple[str, str]]:
    """(model, scene) with the scene of each model that uses the most effects."""
    found: dict[str, tuple[int, str]] = {}
    for name, scene, count in declared():
        if name not in found or count > found[name][0]:
            found[name] = (count, scene)
    return [(name, scene) for name, (_, scene) in found.items()]


@cache
def compiled(name: str, scene: str, backend: str) -> lagc.CompiledModel:
    return lagc.load(name).compile(scene, backend=backend)


def brief(system: lagc.CompiledModel) -> float:
    """A stop time that shows the motion and costs little, s."""
    return min(2.0, float(system.interface.simulate.get("stop", 2.0)))
