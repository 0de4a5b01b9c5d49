"""The kernels of sine and cosine, for models that have angles."""

from __future__ import annotations

from collections.abc import Iterable

from lagc.codegen.kernel_compiler.linker import Chosen, chosen
from lagc.codegen.kernel_compiler.shipped import parts

NAMES = ("sine_cosine", "sine_cosine_two")


def turning(functions: Iterable[str]) -> Chosen:
    """Those of NAMES that the printed `functions` of a model call, and what these call."""
    text = "\n".join(functions)
    return chosen(parts(), {}, [name for name in NAMES if f"{name}(" in text])
