"""The kernels of sine and cosine that the functions of a model call."""

from __future__ import annotations

from collections.abc import Iterable

from lagc.codegen.kernel_compiler.library import Chosen, library

NAMES = ("sine_cosine", "sine_cosine_two")


def sine_cosine_kernels(functions: Iterable[str], language: str) -> Chosen:
    """Return the kernels in NAMES that the printed `functions` of a model call, with those that they call."""
    text = "\n".join(functions)
    return library(language).chosen([name for name in NAMES if f"{name}(" in text], {})
