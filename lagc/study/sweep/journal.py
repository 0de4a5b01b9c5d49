"""The journal of a sweep: a file that keeps finished chunks, so that the same sweep goes on after any end.

The first line names the sweep.  A record is a line of JSON, and behind it the rows as doubles.  A record that
is not complete, since the process was killed or the disk was full, is cut off.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping
from contextlib import suppress
from typing import BinaryIO
from zlib import crc32

from lagc.base.records import dataclass
from lagc.diagnostics.faults import Fault, Refused

HEAD = b"lagc sweep 1 "


class NotKept(Exception):
    """The journal cannot be written, for the reason in the message; it has all records before."""


@dataclass(frozen=True)
class Record:
    """Finished runs from the point `first` on: rows as bytes, reasons by their place in the record."""

    first: int
    rows: bytes
    reasons: Mapping[int, tuple[str, str]]


class Journal:
    """The open journal `path` of the sweep `key`; it is created if there is none.  Raises Refused (LAG0706)
    if the file belongs to another sweep or another process writes to it, NotKept."""

    def __init__(self, path: str, key: str):
        self.path, self.head = path, HEAD + key.encode() + b"\n"
        try:
            self.file: BinaryIO = open(path, "a+b", buffering=0)  # noqa: SIM115
        except OSError as error:
            raise NotKept(f"`{path}` cannot be opened: {error.strerror or error}") from None
        try:
            self._lock()
            self.file.seek(0)
            found = self.file.readline()
            if found != self.head and self.head.startswith(found):  # new, or killed at once
                self.file.truncate(0)
                self._append(self.head)
            elif found != self.head:
                message = f"`{path}` has finished runs of another sweep, or of another version of lagc"
                raise Refused([Fault("LAG0706", message, remedy="remove it, or write to another file")])
        except BaseException:
            self.file.close()
            raise

    def _lock(self) -> None:
        """Keep other processes out, where the system can; the lock ends with the process."""
        try:
            import fcntl
        except ImportError:
            return
        try:
            fcntl.flock(self.file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            message = f"`{self.path}` is in use: the same sweep is running"
            raise Refused(
                [Fault("LAG0706", message, remedy="wait for it, or write to another file")]
            ) from None
        except OSError:  # a file system without locks
            return

    def records(self) -> Iterator[Record]:
        """Read all complete records, and cut off the rest."""
        self.file.seek(len(self.head))
        end = len(self.head)
        with open(self.path, "rb") as file:
            file.seek(end)
            while (record := _read(file)) is not None:
                end = file.tell()
                yield record
        self.file.truncate(end)

    def add(self, record: Record) -> None:
        """Append a record.  Raises NotKept; the file then ends with the record before."""
        about = {
            "first": record.first, "bytes": len(record.rows), "check": crc32(record.rows),
            "reasons": [[k, *reason] for k, reason in record.reasons.items()],
        }  # fmt: skip
        self._append(json.dumps(about).encode() + b"\n" + record.rows)

    def _append(self, data: bytes) -> None:
        end = self.file.seek(0, os.SEEK_END)
        try:
            rest = memoryview(data)
            while rest:  # a disk that is nearly full takes a part
                rest = rest[self.file.write(rest) or 0 :]
        except OSError as error:
            with suppress(OSError):
                self.file.truncate(end)
            raise NotKept(f"`{self.path}` cannot be written: {error.strerror or error}") from None

    def close(self) -> None:
        self.file.close()


def _read(file: BinaryIO) -> Record | None:
    """The next record of a file; None if it is not complete."""
    line = file.readline()
    if not line.endswith(b"\n"):
        return None
    try:
        about = json.loads(line)
        rows = file.read(about["bytes"])
        if len(rows) != about["bytes"] or crc32(rows) != about["check"]:
            return None
        return Record(about["first"], rows, {k: (code, message) for k, code, message in about["reasons"]})
    except (ValueError, TypeError, KeyError):
        return None
