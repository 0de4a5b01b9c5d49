"""The statuses of generated code, the same in every language: see `lagc.kernels.language.statuses`."""

from __future__ import annotations

from lagc.codegen.kernel_compiler.shipped import parts


def texts() -> tuple[str, ...]:
    """What each means, in English."""
    notes = [part["note"] for part in parts() if part["kind"] == "Status"]
    return tuple([note.partition("; culprit: ")[0] for note in notes])
