"""Did you mean: the known name that an unknown one was probably meant to be."""

from __future__ import annotations

from collections.abc import Iterable

LONGEST = 64  # characters of a name that is compared
MOST = 2000  # known names that are compared


def closest(name: str, known: Iterable[str]) -> str | None:
    """The one of `known` that is most like `name`, or None where none is like it.

    Letter case and `_` count little: `Theta0` finds `theta_0`.
    """
    import difflib

    candidates = list(dict.fromkeys(known))[:MOST]
    if not candidates or len(name) > LONGEST:
        return None
    plain = _plain(name)
    same = [c for c in candidates if _plain(c) == plain and c != name]
    if same:
        return same[0]
    found = difflib.get_close_matches(name, candidates, n=1, cutoff=0.6)
    if found:
        return found[0]
    by_plain = {_plain(c): c for c in reversed(candidates)}
    found = difflib.get_close_matches(plain, by_plain, n=1, cutoff=0.7)
    return by_plain[found[0]] if found else None


def did_you_mean(name: str, known: Iterable[str]) -> str | None:
    """A remedy for a fault, or None."""
    found = closest(name, known)
    return None if found is None else f"did you mean `{found}`?"


def _plain(name: str) -> str:
    return name.lower().replace("_", "")
