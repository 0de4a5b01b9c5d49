"""Which effects are used: by path, as `cars[2].drag`, for all elements of an array, `cars.drag`, and by the
name that those of all instances share, `drag`."""

from __future__ import annotations

import re
from collections.abc import Iterator

from lagc.base.records import dataclass

_SUBSCRIPT = re.compile(r"\[[^]]*\]")


@dataclass(frozen=True, slots=True)
class Uses:
    """What a scene names, and what a run adds and leaves out, which counts more, and by a path more than by a
    name."""

    named: frozenset[str] = frozenset()
    added: frozenset[str] = frozenset()
    removed: frozenset[str] = frozenset()

    @property
    def all(self) -> frozenset[str]:
        return self.named | self.added | self.removed

    def has(self, path: str) -> bool:
        for key in keys(path):
            if key in self.removed:
                return False
            if key in self.added:
                return True
        return not self.named.isdisjoint(keys(path))

    def has_beside(self, place: str, name: str) -> bool:
        """Of what an instance (its path, with a point) calls by `name`: its own, or that of all."""
        return self.has(place + name) or ("." in name and self.has(name))


def keys(path: str) -> Iterator[str]:
    """What an effect may be called by, the closest first."""
    yield path
    yield without_subscripts(path)
    yield path.rpartition(".")[2]


def without_subscripts(path: str) -> str:
    """What all elements of arrays are called together."""
    return _SUBSCRIPT.sub("", path)
