"""Maintenance of the cache: list, verify, clear and shrink it."""

import os
import re
import shutil
from collections.abc import Iterator
from time import time

from lagc.base.records import dataclass
from lagc.base.text import size as size_of
from lagc.host.cache.folders import Folder, Unfit, note, reason

LIMIT = 1_000_000_000  # bytes, without LAGC_CACHE_SIZE
BLOCK = 4096  # bytes, the least disk space of a file
ABANDONED = 3600.0  # s after which no process, on any machine that shares the folder, still writes a file
LEFT = 0.75  # fraction of the limit that is kept
_ENTRY = re.compile(r"([a-z]+)-[0-9a-f]{64}")
_TEMPORARY = re.compile(r"tmp-[0-9a-f]{16}")


@dataclass(frozen=True)
class Entry:
    """A file of the cache: `size` in whole disk blocks, `used` the time of last use to the day (s since
    1970)."""

    name: str
    kind: str
    size: int
    used: float


def limit() -> int:
    """Return the maximum size of the cache in bytes: `LAGC_CACHE_SIZE`, such as `500M` or `2G`."""
    given = os.environ.get("LAGC_CACHE_SIZE", "")
    found = size_of(given)
    if found is None:
        if given.strip():
            note(
                f"LAGC_CACHE_SIZE={given} is not a size such as 500M or 2G; {LIMIT // 1_000_000_000}G is used"
            )
        return LIMIT
    return int(found)


def entries(place: Folder) -> list[Entry]:
    found = _files(place, _ENTRY)
    return [
        Entry(name, name.partition("-")[0], -(-s.st_size // BLOCK) * BLOCK, s.st_mtime) for name, s in found
    ]


def unfinished(place: Folder) -> list[str]:
    """Return the temporary files of running and ended processes."""
    return [name for name, _ in _files(place, _TEMPORARY)]


def damaged(place: Folder) -> list[tuple[str, str]]:
    """Return the damaged entries with reasons, and remove them."""
    found = []
    for entry in entries(place):
        try:
            place.read(entry.name)
        except FileNotFoundError:
            continue
        except (OSError, Unfit) as error:
            found.append((entry.name, reason(error)))
            _remove(place, entry.name)
    _sweep(place)
    return found


def clear(place: Folder) -> int:
    """Remove all entries and return their number."""
    before = {e.name for e in entries(place)}
    for name in [*before, *unfinished(place)]:
        _remove(place, name)
    return len(before - {e.name for e in entries(place)})


def shrink(place: Folder) -> None:
    """Remove the least recently used entries if the cache is too large, and orphans."""
    _sweep(place)
    found, most = entries(place), limit()
    total = sum(e.size for e in found)
    if total > most:
        for entry in sorted(found, key=lambda e: e.used):
            if total <= LEFT * most:
                return
            total -= entry.size
            _remove(place, entry.name)


def _files(place: Folder, pattern: re.Pattern[str]) -> Iterator[tuple[str, os.stat_result]]:
    for name in sorted(place.names()):
        if pattern.fullmatch(name):
            try:
                status = place.status(name)
            except OSError:
                continue  # just removed
            yield name, status


def _sweep(place: Folder) -> None:
    """Remove temporary files that are so old that their processes have ended."""
    for name, status in _files(place, _TEMPORARY):
        if time() - status.st_mtime > ABANDONED:
            place.remove(name)


def _remove(place: Folder, name: str) -> None:
    """Remove a file, or a folder in its place."""
    place.remove(name)
    if place.descriptor is None:
        shutil.rmtree(os.path.join(place.path, name), ignore_errors=True)
    else:
        shutil.rmtree(name, ignore_errors=True, dir_fd=place.descriptor)
