"""Names of kernels in C."""

from __future__ import annotations


def snake(name: str) -> str:
    """lagc_start_work of StartWork."""
    return "".join(f"_{c.lower()}" if c.isupper() else c for c in name).lstrip("_")
