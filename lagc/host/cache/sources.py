"""What stands for the sources of lagc itself, which change under the same version in a checkout."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from functools import lru_cache
from time import time

from lagc.host import cache
from lagc.host.cache.folders import hashed

PACKAGE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
ENDINGS = (".py", ".c", ".h", ".lark", ".json")
FRESH = 2.0  # s in which a file may change without a change of its times


def grammar_path() -> str:
    """`grammar/lag.lark`: inside the package where it was installed, beside it in a checkout."""
    inside = os.path.join(PACKAGE, "grammar", "lag.lark")
    return inside if os.path.exists(inside) else os.path.join(os.path.dirname(PACKAGE), "grammar", "lag.lark")


@lru_cache(maxsize=1)
def tool_fingerprint() -> str:
    """The hash of all sources.  It is kept for their sizes and times, so that they are read again only
    where one of them may have changed."""
    try:
        found = dict(sorted(_files()))
        stamps = [f"{path}:{s.st_size}:{s.st_mtime_ns}:{s.st_ctime_ns}" for path, s in found.items()]
        stamp = cache.key("\n".join(stamps))
        if cache.folder() is None:
            return stamp
        kept = cache.load("sources", stamp, bytes.decode)
        if kept is None:
            kept = _contents(found)
            if all(abs(time() - max(s.st_mtime, s.st_ctime)) > FRESH for s in found.values()):
                cache.store("sources", stamp, kept.encode())
        return kept
    except OSError:  # one of them went while it was looked at: nothing is known of this tool
        return os.urandom(32).hex()


def _files() -> Iterator[tuple[str, os.stat_result]]:
    folders = [PACKAGE]
    for folder in folders:  # which grows
        with os.scandir(folder) as entries:
            for entry in entries:
                if entry.name.endswith(ENDINGS):
                    yield entry.path, entry.stat()
                elif not entry.name.startswith(("__", ".")) and entry.is_dir():
                    folders.append(entry.path)
    grammar = grammar_path()
    if os.path.exists(grammar):
        yield grammar, os.stat(grammar)


def _contents(found: Mapping[str, os.stat_result]) -> str:
    """The hash of files and their names, read as fast as they can be."""
    whole = hashed(b"")
    for path, status in found.items():
        file = os.open(path, os.O_RDONLY | getattr(os, "O_BINARY", 0))
        try:
            data = os.read(file, status.st_size + 1)
        finally:
            os.close(file)
        if len(data) != status.st_size:
            raise OSError
        name = path.removeprefix(PACKAGE) if path.startswith(PACKAGE) else os.path.basename(path)
        whole.update(f"{name}\n{len(data)}\n".encode("utf-8", "surrogatepass"))
        whole.update(data)
    return whole.hexdigest()
