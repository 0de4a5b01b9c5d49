"""Numbers that people write outside of a model: on the command line, in the environment."""

from __future__ import annotations

import re

_NUMBER = re.compile(r"[+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
_WHOLE = re.compile(r"[+-]?[0-9]{1,4000}")
_NONE = re.compile(r"[+-]?(?:nan|inf|infinity)", re.IGNORECASE)


def number(text: str) -> float | None:
    """The number that `text` is in a model file, with a sign; None where it is none.  The words for what
    is not finite are taken too, so that who needs a finite number says so."""
    return float(text) if _NUMBER.fullmatch(text) or _NONE.fullmatch(text) else None


def whole(text: str) -> int | None:
    """The whole number that `text` is; None where it is none."""
    return int(text) if _WHOLE.fullmatch(text) else None
