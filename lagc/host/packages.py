"""Packages that a user may have installed."""

import sys
from importlib.util import find_spec

PICTURES = "pictures need matplotlib: pip install matplotlib"


def is_installed(package: str) -> bool:
    """Return whether `package` can be imported, as far as a look at its place tells."""
    try:
        return find_spec(package) is not None
    except (ImportError, ValueError):  # a finder refuses it, or it was put there by hand
        return False


def missing(error: BaseException) -> str:
    """Return the package that an import did not find, with the line that installs it, or ""."""
    package = (error.name or "").partition(".")[0] if isinstance(error, ModuleNotFoundError) else ""
    if package in ("", "lagc") or package in sys.stdlib_module_names:
        return ""
    return f"this needs the package {package}: pip install {package}"
