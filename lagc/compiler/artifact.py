"""A compiled model in the cache: its interface and generated text, as plain data.

Each model has two entries.  The *head*, found by the text and the choice alone, tells which files were
imported and which parameters are built in.  The *artifact* is found by these.
"""

import marshal
from collections.abc import Iterable, Mapping
from types import CodeType
from typing import Any

from lagc.base.records import dataclass, names
from lagc.host import cache
from lagc.host.cache import tool_fingerprint
from lagc.host.model_library import LARGEST_DATA, Unreadable, content, fingerprint
from lagc.lowering.program import Block, Clause, Contact, Field, Interface
from lagc.version import __version__

# The fields of an interface that hold records, and their types.
FIELDS: dict[str, type] = {
    "parameters": Field, "inputs": Field, "outputs": Field, "limits": Field, "whens": Clause,
    "discretes": Field, "contacts": Contact, "blocks": Block,
}  # fmt: skip


@dataclass(frozen=True)
class Head:
    """Imports and structural parameters of a model: its artifact's key is computed from them."""

    imports: tuple[tuple[str, str | None], ...]  # path and fingerprint; None if there was no file
    structural: tuple[str, ...]  # parameters that are built into the generated code

    @property
    def paths(self) -> list[str]:
        """The imported files that existed."""
        return [path for path, found in self.imports if found is not None]

    @property
    def is_current(self) -> bool:
        return all(_fingerprint(path) == found for path, found in self.imports)


@dataclass(frozen=True)
class Artifact:
    """A compiled model. `unused` are the parameters that have no effect but may be given, and those that are
    `built_in`.  `code` is the compiled text of a Python module."""

    interface: Interface
    sources: Mapping[str, str]
    unused: tuple[Field, ...] = ()
    code: tuple[CodeType, ...] = ()

    @property
    def built_in(self) -> tuple[str, ...]:
        """The parameters whose values are part of the code: a run cannot change them."""
        return tuple([f.name for f in self.unused if f.value is None and not f.place])

    def __getstate__(self) -> dict[str, object]:
        """Return the state without `code`, which belongs to one version of Python and can be compiled
        again."""
        return {**vars(self), "code": ()}


def load_head(key: str) -> Head | None:
    head = cache.load("head", key, _head)
    return head if head is not None and head.is_current else None


def store_head(key: str, head: Head) -> None:
    cache.store("head", key, marshal.dumps((head.imports, head.structural)))


def load_artifact(key: str) -> Artifact | None:
    return cache.load("artifact", key, _artifact)


def store_artifact(key: str, artifact: Artifact) -> None:
    unused = [_row(field) for field in artifact.unused]
    plain = (_plain(artifact.interface), dict(artifact.sources), unused, artifact.code)
    cache.store("artifact", key, marshal.dumps(plain))


def _fingerprint(path: str) -> str | None:
    try:
        return fingerprint(path, content(path, largest=LARGEST_DATA))
    except Unreadable:
        return None


def _head(body: bytes) -> Head:
    return Head(*marshal.loads(body))


def _artifact(body: bytes) -> Artifact:
    plain, sources, unused, code = marshal.loads(body)
    plain.update({name: _made(kind, plain[name]) for name, kind in FIELDS.items()})
    return Artifact(Interface(**plain), sources, _made(Field, unused), code)


def version_key() -> str:
    """Return the versions of lagc and Python that an artifact depends on."""
    return f"lagc {__version__} {cache.PYTHON} {tool_fingerprint()}"


def _plain(interface: Interface) -> dict[str, Any]:
    plain: dict[str, Any] = {name: getattr(interface, name) for name in names(Interface)}
    return {**plain, **{name: [_row(field) for field in plain[name]] for name in FIELDS}}


def _row(record: Any) -> tuple[object, ...]:
    return tuple([getattr(record, name) for name in names(type(record))])


def _made(kind: type, rows: Iterable[tuple[Any, ...]]) -> tuple[Any, ...]:
    return tuple([kind(*row) for row in rows])
