"""What is kept of a compiled model: its interface and its generated text, as plain data.

Kept in the user's cache under the hash of all that it depends on.  Two entries a model: a
*head*, found by the text and the choice alone, says which files were imported and which
parameters are built in; with these known, the *artifact* itself is found.
"""

from __future__ import annotations

import json
import marshal
import sys
from collections.abc import Mapping
from types import CodeType
from typing import Any

from lagc import cache
from lagc.cache.sources import tool_fingerprint
from lagc.library import Unreadable, content, fingerprint
from lagc.optimize.program import Field, Interface
from lagc.records import dataclass, names
from lagc.version import __version__


@dataclass(frozen=True)
class Head:
    """What must be known of a model before its artifact can be found."""

    imports: tuple[tuple[str, str | None], ...]  # path, fingerprint of each file; None where there was none
    structural: tuple[str, ...]  # parameters that are built into the generated code

    @property
    def is_current(self) -> bool:
        return all(_fingerprint(path) == found for path, found in self.imports)


@dataclass(frozen=True)
class Artifact:
    """A compiled model.  `unused` are the parameters that reach nothing, which may be given, to no
    effect; and those that are `built_in`.  `code` is the compiled text of a Python target."""

    interface: Interface
    sources: Mapping[str, str]
    unused: tuple[Field, ...] = ()
    code: CodeType | None = None

    @property
    def built_in(self) -> tuple[str, ...]:
        """The parameters whose values are a part of the code: no run can change them."""
        return tuple([f.name for f in self.unused if f.value is None and not f.place])

    def __getstate__(self) -> dict[str, object]:
        """Without `code`, which belongs to one version of Python: it can be made from the text."""
        return {**vars(self), "code": None}


def load_head(key: str) -> Head | None:
    head = cache.load("head", key, _head)
    return head if head is not None and head.is_current else None


def store_head(key: str, head: Head) -> None:
    plain = {"imports": head.imports, "structural": head.structural}
    cache.store("head", key, json.dumps(plain).encode())


def load_artifact(key: str) -> Artifact | None:
    return cache.load("artifact", key, _artifact)


def store_artifact(key: str, artifact: Artifact) -> None:
    plain = {
        "interface": interface_to_plain(artifact.interface),
        "sources": dict(artifact.sources),
        "unused": [_row(f) for f in artifact.unused],
    }
    text = json.dumps(plain).encode()
    code = b"" if artifact.code is None else marshal.dumps(artifact.code)
    cache.store("artifact", key, len(text).to_bytes(8, "little") + text + code)


def _fingerprint(path: str) -> str | None:
    try:
        return fingerprint(path, content(path))
    except Unreadable:
        return None


def _head(body: bytes) -> Head:
    plain = json.loads(body)
    return Head(tuple((p, d) for p, d in plain["imports"]), tuple(plain["structural"]))


def _artifact(body: bytes) -> Artifact:
    length = int.from_bytes(body[:8], "little")
    plain = json.loads(body[8 : 8 + length])
    code = marshal.loads(body[8 + length :]) if len(body) > 8 + length else None
    unused = tuple(Field(*row) for row in plain["unused"])
    return Artifact(interface_from_plain(plain["interface"]), plain["sources"], unused, code)


def version_key() -> str:
    """What an artifact depends on besides the model: the tool and the Python that compiled it."""
    return f"lagc {__version__} {sys.implementation.cache_tag} {sys.hexversion:x} {tool_fingerprint()}"


def interface_to_plain(interface: Interface) -> dict[str, Any]:
    plain: dict[str, Any] = {name: getattr(interface, name) for name in names(Interface)}
    for name in ("parameters", "inputs", "outputs", "limits"):
        plain[name] = [_row(field) for field in getattr(interface, name)]
    return plain


def interface_from_plain(plain: Mapping[str, Any]) -> Interface:
    values: dict[str, Any] = {k: tuple(v) if isinstance(v, list) else v for k, v in plain.items()}
    for name in ("parameters", "inputs", "outputs", "limits"):
        values[name] = tuple(Field(*row) for row in plain[name])
    return Interface(**values)


def _row(field: Field) -> list[object]:
    return [getattr(field, name) for name in names(Field)]
