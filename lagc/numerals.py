"""Numbers that people write outside of a model: on the command line, in the environment."""

from __future__ import annotations

import re

# Compiled when one is read, which most runs never do.
_NUMBER = r"[+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"
_WHOLE = r"[+-]?[0-9]{1,4000}"
_NONE = r"(?i)[+-]?(?:nan|inf|infinity)"


def number(text: str) -> float | None:
    """The number that `text` is in a model file, with a sign; None where it is none.  The words for what
    is not finite are taken too, so that who needs a finite number says so."""
    return float(text) if re.fullmatch(_NUMBER, text) or re.fullmatch(_NONE, text) else None


def whole(text: str) -> int | None:
    """The whole number that `text` is; None where it is none."""
    return int(text) if re.fullmatch(_WHOLE, text) else None
