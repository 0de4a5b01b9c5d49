"""The user's cache folder: entries that may vanish, be damaged or refuse to be written at any time.

An entry is a file that begins with the hash of what follows.  One that does not match is as
good as absent; one that cannot be written is not written.  Nothing here is ever an error.
"""

from __future__ import annotations

import hashlib
import os
import sys
from _thread import get_ident
from functools import lru_cache

_MAGIC = b"lagc-cache-1 "


def folder() -> str | None:
    """`LAGC_CACHE`, else `lagc` in the platform's cache folder; None where there is none (an
    empty `LAGC_CACHE` turns the cache off)."""
    own = os.environ.get("LAGC_CACHE")
    if own is not None:
        return own or None
    xdg = os.environ.get("XDG_CACHE_HOME")
    if xdg and os.path.isabs(xdg):
        return os.path.join(xdg, "lagc")
    home = os.path.expanduser("~")
    if home == "~":
        return None
    if sys.platform == "win32":
        return os.path.join(
            os.environ.get("LOCALAPPDATA", os.path.join(home, "AppData", "Local")), "lagc", "cache"
        )
    if sys.platform == "darwin":
        return os.path.join(home, "Library", "Caches", "lagc")
    return os.path.join(home, ".cache", "lagc")


def key(*parts: str) -> str:
    """One name for all of `parts`: where any differs, it differs."""
    digest = hashlib.sha256()
    for part in parts:
        data = part.encode("utf-8", "surrogatepass")
        digest.update(len(data).to_bytes(8, "little"))
        digest.update(data)
    return digest.hexdigest()


@lru_cache(maxsize=1)
def tool_fingerprint() -> str:
    """Stands for the sources of lagc itself: they change under the same version in a checkout."""
    stamps = []
    for folder, folders, files in os.walk(os.path.dirname(os.path.abspath(__file__))):
        folders[:] = [f for f in folders if not f.startswith(("__", "."))]
        for name in files:
            if name.endswith((".py", ".c", ".lark")):
                stamps.append(f"{name}:{os.stat(os.path.join(folder, name)).st_mtime_ns}")
    return key(*sorted(stamps))


def load(name: str) -> bytes | None:
    """The entry `name`, or None."""
    path = _path(name)
    if path is None:
        return None
    try:
        with open(path, "rb") as file:
            if hasattr(os, "geteuid") and os.fstat(file.fileno()).st_uid != os.geteuid():
                return None  # entries hold code, so that only one's own are trusted
            data = file.read()
    except OSError:
        return None
    head, _, body = data.partition(b"\n")
    return body if head == _MAGIC + hashlib.sha256(body).hexdigest().encode() else None


def store(name: str, body: bytes) -> None:
    """Keep `body` as entry `name`, whole or not at all."""
    path = _path(name)
    if path is None:
        return
    temporary = temporary_name(path)
    try:
        os.makedirs(os.path.dirname(path), mode=0o700, exist_ok=True)
        with open(temporary, "wb") as file:
            file.write(_MAGIC + hashlib.sha256(body).hexdigest().encode() + b"\n" + body)
        os.replace(temporary, path)
    except OSError:
        try:
            os.unlink(temporary)
        except OSError:
            return


def temporary_name(path: str) -> str:
    """A name beside `path` that no other thread writes to."""
    return f"{path}.{os.getpid()}.{get_ident()}.tmp"


def _path(name: str) -> str | None:
    root = folder()
    return None if root is None else os.path.join(root, name[:2], name[2:])
