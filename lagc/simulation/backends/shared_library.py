"""Shared libraries: out of the cache or compiled now, loaded from the bytes that were verified."""

from __future__ import annotations

import ctypes
import os
import sys
from collections.abc import Mapping
from itertools import count

from lagc.host import cache
from lagc.simulation.backends.compile import SUFFIX, CannotCompile, build_library, library_key

_loaded = count(1)


def library(sources: Mapping[str, str]) -> ctypes.CDLL:
    """The library of `sources` (file name -> text), compiled where no whole one is in the cache.  Raises
    CannotCompile."""
    key = library_key(sources)
    found = cache.load("library", key, load)
    if found is not None:
        return found
    data = build_library(sources)
    cache.store("library", key, data)
    try:
        return load(data)
    except OSError as error:
        raise CannotCompile(f"the compiled library cannot be loaded: {error}") from None


def load(data: bytes) -> ctypes.CDLL:
    """The library whose file would be `data`.  It is mapped from memory that nobody can change or cut
    off; where there is no such memory, from a copy of its own.  Raises OSError."""
    memory = _sealed(data)
    if memory is None:
        return _load_copy(data)
    try:
        # The loader takes what has the name of an earlier library for that one, and numbers of
        # descriptors return: the name is made another one by `/.` in the places of a count's ones.
        unlike = "".join("/." if digit == "1" else "/" for digit in f"{next(_loaded):b}")
        return ctypes.CDLL(f"/proc/self/fd{unlike}/{memory}")
    except OSError:  # no /proc here, or nothing in memory may be executed
        return _load_copy(data)
    finally:
        os.close(memory)


def _sealed(data: bytes) -> int | None:
    """A descriptor of memory that holds `data` for good (Linux)."""
    if not hasattr(os, "memfd_create"):
        return None
    import fcntl

    try:
        memory = os.memfd_create("lagc-model", os.MFD_CLOEXEC | os.MFD_ALLOW_SEALING)
    except OSError:
        return None
    try:
        left = memoryview(data)
        while left:
            left = left[os.write(memory, left) :]
        seals = fcntl.F_SEAL_WRITE | fcntl.F_SEAL_SHRINK | fcntl.F_SEAL_GROW | fcntl.F_SEAL_SEAL
        fcntl.fcntl(memory, fcntl.F_ADD_SEALS, seals)
    except OSError:
        os.close(memory)
        return None
    return memory


def _load_copy(data: bytes) -> ctypes.CDLL:
    import shutil
    import tempfile

    private = tempfile.mkdtemp(prefix="lagc-")
    try:
        path = os.path.join(private, "model" + SUFFIX)
        with open(path, "wb") as file:
            file.write(data)
        found = ctypes.CDLL(path)
        if sys.platform == "win32":  # which keeps the file of a library as long as it is loaded
            import atexit
            from _ctypes import FreeLibrary

            atexit.register(shutil.rmtree, private, ignore_errors=True)
            atexit.register(FreeLibrary, found._handle)
        return found
    finally:
        if sys.platform != "win32":
            shutil.rmtree(private, ignore_errors=True)
