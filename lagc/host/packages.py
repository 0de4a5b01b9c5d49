"""Packages that a user may have installed."""

from __future__ import annotations

from importlib.util import find_spec

PICTURES = "pictures need matplotlib: pip install matplotlib"


def is_installed(package: str) -> bool:
    """Return whether `package` can be imported, as far as a look at its place tells."""
    try:
        return find_spec(package) is not None
    except (ImportError, ValueError):  # a finder refuses it, or it was put there by hand
        return False
