"""The journal of a sweep: a file that keeps finished chunks, so that the same sweep goes on after any end.

The first line names the sweep.  A record is a line of JSON.  One that is not complete, since the process was
killed or the disk was full, is cut off.
"""

import json
import os
from base64 import b64decode, b64encode
from collections.abc import Iterator
from contextlib import suppress
from typing import BinaryIO

from lagc.diagnostics.faults import Fault, Refused
from lagc.study.sweep.worker import Record

HEAD = b"lagc sweep 2 "


class NotKept(Exception):
    """The journal cannot be written, for the reason in the message; it has all records before."""


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
        end = self.file.seek(len(self.head))
        with open(self.path, "rb") as file:
            file.seek(end)
            for line in file:
                try:
                    first, rows, reasons = json.loads(line if line.endswith(b"\n") else b"")
                    record = Record(first, b64decode(rows), {k: (code, text) for k, code, text in reasons})
                except (ValueError, TypeError):
                    break
                end += len(line)
                yield record
        self.file.truncate(end)

    def add(self, record: Record) -> None:
        """Append a record.  Raises NotKept; the file then ends with the record before."""
        reasons = [[k, *reason] for k, reason in record.reasons.items()]
        rows = b64encode(record.rows).decode()
        self._append(json.dumps([record.first, rows, reasons]).encode() + b"\n")

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
