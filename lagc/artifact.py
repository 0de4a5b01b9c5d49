"""What is kept of a compiled model: its interface and its generated text, as plain data.

Kept in the user's cache under the hash of all that it depends on.  Two entries a model: a
*head*, found by the text and the choice alone, says which files were imported and which
parameters are built in; with these known, the *artifact* itself is found.
"""

from __future__ import annotations

import hashlib
import json
import marshal
import sys
from collections.abc import Mapping
from types import CodeType
from typing import Any

from lagc import cache
from lagc.optimize.program import Field, Interface
from lagc.records import dataclass, names
from lagc.version import __version__


@dataclass(frozen=True)
class Head:
    """What must be known of a model before its artifact can be found."""

    imports: tuple[tuple[str, str], ...]  # path, SHA-256 of each imported file
    structural: tuple[str, ...]  # parameters that are built into the generated code

    @property
    def is_current(self) -> bool:
        return all(fingerprint(path) == digest for path, digest in self.imports)


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


def fingerprint(path: str) -> str | None:
    """The SHA-256 of a file; None where it cannot be read."""
    try:
        with open(path, "rb") as file:
            return hashlib.sha256(file.read()).hexdigest()
    except OSError:
        return None


def load_head(name: str) -> Head | None:
    body = cache.load(name)
    if body is None:
        return None
    plain = json.loads(body)
    head = Head(tuple((p, d) for p, d in plain["imports"]), tuple(plain["structural"]))
    return head if head.is_current else None


def store_head(name: str, head: Head) -> None:
    cache.store(name, json.dumps({"imports": head.imports, "structural": head.structural}).encode())


def load_artifact(name: str) -> Artifact | None:
    body = cache.load(name)
    if body is None:
        return None
    length = int.from_bytes(body[:8], "little")
    plain = json.loads(body[8 : 8 + length])
    code = marshal.loads(body[8 + length :]) if len(body) > 8 + length else None
    unused = tuple(Field(*row) for row in plain["unused"])
    return Artifact(interface_from_plain(plain["interface"]), plain["sources"], unused, code)


def store_artifact(name: str, artifact: Artifact) -> None:
    plain = {
        "interface": interface_to_plain(artifact.interface),
        "sources": dict(artifact.sources),
        "unused": [_row(f) for f in artifact.unused],
    }
    text = json.dumps(plain).encode()
    code = b"" if artifact.code is None else marshal.dumps(artifact.code)
    cache.store(name, len(text).to_bytes(8, "little") + text + code)


def version_key() -> str:
    """What an artifact depends on besides the model: the tool and the Python that compiled it."""
    return f"lagc {__version__} {sys.implementation.cache_tag} {sys.hexversion:x} {cache.tool_fingerprint()}"


def interface_to_plain(interface: Interface) -> dict[str, Any]:
    plain: dict[str, Any] = {name: getattr(interface, name) for name in names(Interface)}
    for name in ("parameters", "inputs", "outputs"):
        plain[name] = [_row(field) for field in getattr(interface, name)]
    return plain


def interface_from_plain(plain: Mapping[str, Any]) -> Interface:
    values: dict[str, Any] = {k: tuple(v) if isinstance(v, list) else v for k, v in plain.items()}
    for name in ("parameters", "inputs", "outputs"):
        values[name] = tuple(Field(*row) for row in plain[name])
    return Interface(**values)


def _row(field: Field) -> list[object]:
    return [getattr(field, name) for name in names(Field)]
