"""Shared libraries for other machines, by `zig cc` of the package ziglang."""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping, Sequence
from typing import NamedTuple

from lagc.simulation.backends.compile import build_library


class Platform(NamedTuple):
    """A platform: its names in FMI 3.0 and 2.0, the target of zig, the suffix of libraries."""

    name: str
    old_name: str
    target: str
    suffix: str


PLATFORMS = (  # the C library of linux is that of 2012, so that later ones serve
    Platform("x86_64-linux", "linux64", "x86_64-linux-gnu.2.17", ".so"),
    Platform("aarch64-linux", "aarch64-linux", "aarch64-linux-gnu.2.17", ".so"),
    Platform("x86_64-windows", "win64", "x86_64-windows-gnu", ".dll"),
    Platform("x86_64-darwin", "darwin64", "x86_64-macos", ".dylib"),
    Platform("aarch64-darwin", "aarch64-darwin", "aarch64-macos", ".dylib"),
)


def named(name: str) -> Platform | None:
    """Return the platform of this name, as FMI 3.0 or 2.0 writes it."""
    return next((p for p in PLATFORMS if name in (p.name, p.old_name)), None)


def this_machine() -> Platform | None:
    """Return the platform of this machine."""
    system = {"linux": "linux", "darwin": "darwin", "win32": "windows"}.get(sys.platform, sys.platform)
    machine = os.uname().machine if hasattr(os, "uname") else os.environ.get("PROCESSOR_ARCHITECTURE", "")
    machine = {"arm64": "aarch64", "AMD64": "x86_64"}.get(machine, machine)
    return named(f"{machine}-{system}")


NO_PLACES = ("-g0", "-s")  # tables for debuggers tell where files were, and Windows' libraries when


def cross_library(sources: Mapping[str, str], more: Sequence[str], platform: Platform) -> bytes:
    """Compile the shared library of `sources` for a platform. Raises CannotCompile."""
    zig = (sys.executable, "-m", "ziglang", "cc", "-target", platform.target)
    return build_library(sources, (*more, *NO_PLACES), zig)
