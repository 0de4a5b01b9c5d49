"""The kernels of sine and cosine that the functions of a model call."""

from __future__ import annotations

from collections.abc import Iterable

from lagc.codegen.kernel_compiler.linker import Chosen, chosen
from lagc.codegen.kernel_compiler.shipped import parts

NAMES = ("sine_cosine", "sine_cosine_two")


def sine_cosine_kernels(functions: Iterable[str]) -> Chosen:
    """Return the kernels in NAMES that the printed `functions` of a model call, with those that they call."""
    text = "\n".join(functions)
    return chosen(parts(), {}, [name for name in NAMES if f"{name}(" in text])
