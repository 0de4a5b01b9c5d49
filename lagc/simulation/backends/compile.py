"""C compilers, and shared libraries of generated code: from the cache, or compiled now."""

from __future__ import annotations

import errno
import os
import sys
from collections.abc import Mapping, Sequence
from contextlib import suppress
from functools import lru_cache
from itertools import count
from typing import TYPE_CHECKING, Any

from lagc.host import cache
from lagc.host.atomic_write import scratch
from lagc.host.budgets import stage

if TYPE_CHECKING:
    import ctypes
    from subprocess import CompletedProcess

FLAGS = ("-O2", "-ffp-contract=off", "-fPIC", "-shared", "-std=c99")
COMPILERS = ("cc", "gcc", "clang")
NO_ROOM = {  # messages of compilers, linkers and loaders, besides those of the system
    errno.ENOSPC: (),
    errno.ENOMEM: ("out of memory", "memory exhausted", "bad_alloc", "failed to map", "signal terminated"),
}
LONGEST = 600.0  # s for one compilation
_loaded = count(1)
SUFFIX = ".dll" if sys.platform == "win32" else ".so"


class CannotCompile(Exception):
    """There is no C compiler, or it fails, or disk (`full`) or memory (`starved`) is exhausted; the message
    tells which."""

    def __init__(self, message: str, number: int | None = None):
        super().__init__(message)
        self.full = number in (errno.ENOSPC, errno.EDQUOT)
        self.starved = number == errno.ENOMEM


@lru_cache(maxsize=1)
def compiler() -> tuple[str, ...] | None:
    """The command of the C compiler, or None. `LAGC_CC` if it is set, or else cc, gcc or clang, or else `zig
    cc` if the package ziglang is installed."""
    import shutil

    own = os.environ.get("LAGC_CC")
    if own is not None:
        words = tuple(own.split())
        return words if words and shutil.which(words[0]) else None
    for name in COMPILERS:
        path = shutil.which(name)
        if path:
            return (path,)
    from lagc.host.packages import is_installed

    if is_installed("ziglang"):
        return (sys.executable, "-m", "ziglang", "cc")
    return None


def library_key(sources: Mapping[str, str], more: Sequence[str] = ()) -> str:
    """The cache key of the library of `sources`: their content, the flags (and `more`) and the machine."""
    words = [item for name in sorted(sources) for item in (name, sources[name])]
    return cache.key("1", sys.platform, _machine(), *FLAGS, *more, os.environ.get("LAGC_CC", ""), *words)


def cached_library(sources: Mapping[str, str]) -> bool:
    return cache.holds("library", library_key(sources))


def build_library(
    sources: Mapping[str, str], more: Sequence[str] = (), words: Sequence[str] | None = None
) -> bytes:
    """Compile the shared library of `sources` (file name -> text), with `more` flags behind the usual ones,
    by the compiler of this machine, or by the command `words`. C files that others include do not count.
    Raises CannotCompile."""
    words = words or compiler()
    if words is None:
        raise CannotCompile("no C compiler was found (cc, gcc, clang, or the package `ziglang`)")
    try:
        with (
            stage("compiling the code", LONGEST),
            scratch() as work,
            open(_compile(words, sources, work, more), "rb") as file,
        ):
            built = file.read()
    except OSError as error:
        message = f"the C compiler could not be used: {error.strerror or error}"
        raise CannotCompile(message, error.errno) from None
    if not _is_whole(built):
        raise CannotCompile(f"`{os.path.basename(words[0])}` wrote an incomplete library")
    return built


def _is_whole(library: bytes) -> bool:
    """Whether a library file is complete. A process that maps an incomplete one dies at the first missing
    page.  Checks the program headers of 64-bit ELF files; other files must not be empty."""
    if library[:6] != b"\x7fELF\x02\x01":
        return len(library) > 0
    import struct

    try:
        (start,) = struct.unpack_from("<Q", library, 0x20)
        size, count = struct.unpack_from("<HH", library, 0x36)
        segments = [struct.unpack_from("<8xQ16xQ", library, start + k * size) for k in range(count)]
    except struct.error:
        return False
    return all(offset + length <= len(library) for offset, length in segments)


def _compile(words: Sequence[str], sources: Mapping[str, str], folder: str, more: Sequence[str]) -> str:
    import subprocess

    for name, text in sources.items():
        with open(os.path.join(folder, name), "w", encoding="utf-8", newline="\n") as file:
            file.write(text)
    texts = "".join(sources.values())
    units = [name for name in sources if name.endswith(".c") and f'#include "{name}"' not in texts]
    target = "model" + SUFFIX  # some libraries hold this name: it does not tell the folder
    command = [*words, *FLAGS, "-o", target, *units, *more, "-lm"]
    try:
        done = _finished(command, folder)
    except subprocess.TimeoutExpired:
        raise CannotCompile(f"`{words[0]}` took longer than {LONGEST:g} s") from None
    if done.returncode != 0:
        said = done.stderr or done.stdout
        for number, others in NO_ROOM.items():
            if any(each in said for each in (os.strerror(number), *others)):
                raise OSError(number, os.strerror(number), folder)
        lines = said.strip().splitlines()
        first = next((line for line in lines if "error" in line), lines[0] if lines else "it said nothing")
        raise CannotCompile(f"`{os.path.basename(words[0])}` failed (exit code {done.returncode}): {first}")
    return os.path.join(folder, target)


def _finished(command: Sequence[str], folder: str) -> CompletedProcess[str]:
    """Run `command` in `folder`, which also holds its temporary files. It has its own process group, which is
    killed if this process is interrupted.  Raises TimeoutExpired, OSError."""
    import signal
    import subprocess

    group: dict[str, Any] = {"process_group": 0} if hasattr(os, "killpg") else {}
    process = subprocess.Popen(
        command, cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
        text=True, errors="replace", env={**os.environ, "TMPDIR": folder}, **group,
    )  # fmt: skip
    try:
        out, err = process.communicate(timeout=LONGEST)
    except BaseException:
        with suppress(OSError):  # it may have ended already
            if group:
                os.killpg(process.pid, signal.SIGKILL)
            else:
                process.kill()
        process.communicate()
        raise
    return subprocess.CompletedProcess(command, process.returncode, out, err)


def _machine() -> str:
    return os.uname().machine if hasattr(os, "uname") else os.environ.get("PROCESSOR_ARCHITECTURE", "")


def library(sources: Mapping[str, str], more: Sequence[str] = ()) -> ctypes.CDLL:
    """Return the library of `sources` (file name -> text), compiled unless the cache has a valid one, with
    `more` flags.  Raises CannotCompile."""
    key = library_key(sources, more)
    found = cache.load("library", key, load)
    if found is not None:
        return found
    data = build_library(sources, more)
    cache.store("library", key, data)
    try:
        return load(data)
    except OSError as error:
        raise CannotCompile(f"the compiled library cannot be loaded: {error}") from None


def load(data: bytes) -> ctypes.CDLL:
    """Load a library from its bytes. It is mapped from sealed memory that no one can change, or from a
    private copy if the system has none. Raises OSError."""
    memory = _sealed(data)
    if memory is None:
        return _load_copy(data)
    import ctypes

    try:
        # The loader identifies libraries by name, and numbers of
        # descriptors recur: `/.` for the ones of a binary counter makes each name unique.
        unlike = "".join("/." if digit == "1" else "/" for digit in f"{next(_loaded):b}")
        return ctypes.CDLL(f"/proc/self/fd{unlike}/{memory}")
    except OSError:  # no /proc, or memory files cannot be executed
        return _load_copy(data)
    finally:
        os.close(memory)


def _sealed(data: bytes) -> int | None:
    """A descriptor of sealed memory that contains `data` (Linux), or None."""
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
    import ctypes
    import shutil
    import tempfile

    private = tempfile.mkdtemp(prefix="lagc-")
    try:
        path = os.path.join(private, "model" + SUFFIX)
        with open(path, "wb") as file:
            file.write(data)
        found = ctypes.CDLL(path)
        if sys.platform == "win32":  # a loaded library file cannot be deleted
            import atexit
            from _ctypes import FreeLibrary

            atexit.register(shutil.rmtree, private, ignore_errors=True)
            atexit.register(FreeLibrary, found._handle)
        return found
    finally:
        if sys.platform != "win32":
            shutil.rmtree(private, ignore_errors=True)
