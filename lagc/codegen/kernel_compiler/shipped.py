"""The printed kernels, which `hatch_build.py` makes when lagc is installed.

If they are missing or belong to other sources, as in a working checkout, they are printed when they are
first needed and kept in the cache.
"""

from __future__ import annotations

import json
import os
from functools import cache
from typing import Any

from lagc.codegen.kernel_compiler.real_types import DOUBLE, Arithmetic
from lagc.host import cache as store
from lagc.host.cache import tool_fingerprint

Parts = tuple[dict[str, Any], ...]


def shipped_path() -> str:
    return os.path.join(os.path.dirname(os.path.abspath(__file__)), "kernels.json")


def packed() -> str:
    """Return all kernels for doubles as text, with the key of their sources, as `hatch_build.py` ships it."""
    return json.dumps([_key(), *printed(DOUBLE)], separators=(",", ":"))


@cache
def parts(real: Arithmetic = DOUBLE) -> Parts:
    """Return files, records, constants and functions in their order (`library`)."""
    name = _key()
    if real == DOUBLE:
        try:
            with open(shipped_path(), encoding="utf-8") as file:
                key, *found = json.load(file)
            if key == name:
                return tuple(found)
        except (OSError, ValueError):
            pass
    else:
        name = store.key(name, real.name)
    kept = store.load("kernels", name, lambda body: tuple(json.loads(body)))
    if kept is not None:
        return kept
    made = printed(real)
    store.store("kernels", name, json.dumps(made).encode())
    return made


def printed(real: Arithmetic) -> Parts:
    from lagc.codegen.kernel_compiler.library import Library

    return tuple(Library(real).load().parts)


def _key() -> str:
    """Return the key of the kernels and of their printers; it is kept, as it depends on fifty files."""
    tool = store.key(tool_fingerprint())
    found = store.load("printers", tool, bytes.decode)
    if found is None:
        texts = []
        for path in sources():
            with open(path, encoding="utf-8") as file:
                texts.append(file.read())
        found = store.key(*texts)
        store.store("printers", tool, found.encode())
    return found


def sources() -> list[str]:
    """Return the files on which the printed kernels depend."""
    from glob import glob

    here = os.path.dirname(os.path.abspath(__file__))
    kernels = os.path.join(os.path.dirname(os.path.dirname(here)), "kernels")
    return sorted(glob(os.path.join(kernels, "**", "*.py"), recursive=True)) + sorted(
        glob(os.path.join(here, "*.py"))
    )
