"""What a model is made of is not written over."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from lagc.cli.exits import Usage

if TYPE_CHECKING:
    from lagc.compiler.pipeline import Compilation


def spare(compilation: Compilation, *paths: str | None) -> None:
    """Raises Usage where one of these is the file of the model, or one that it reads, links followed."""
    files = [compilation.source.name, *(compilation.read.paths if compilation.read else ())]
    read = set(map(_real, files))
    for path in paths:
        if path and _real(path) in read:
            raise Usage(f"`{path}` is read by the model, and not written over: name another file")


def _real(path: str) -> str:
    """Itself where the folder that it is relative to is gone."""
    try:
        return os.path.realpath(path)
    except OSError:
        return path
