"""Suggestions: the known name that is most like an unknown one."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from functools import lru_cache
from operator import itemgetter

from lagc.diagnostics.faults import Fault, Span
from lagc.diagnostics.foreign_words import ARGUMENTS

LONGEST = 64  # characters of a name that is compared
MOST = 2000  # known names that are looked at
NEAREST = 50  # of them, by their letters, that are compared
MANY_RADIANS = 10  # more than a turn and a half, and in degrees a usual angle


def closest(name: str, known: Iterable[str]) -> str | None:
    """Return the name in `known` that is most similar to `name`, or None. Letter case and `_` count little:
    `Theta0` finds `theta_0`.  So do parts of a path: `u.damp.c` finds `u.c` before `c`."""
    candidates = tuple(dict.fromkeys(known))[:MOST]
    return _closest(name, candidates) if candidates and len(name) <= LONGEST else None


@lru_cache(maxsize=256)
def _closest(name: str, known: Sequence[str]) -> str | None:
    """Return the closest name; cached, because every scene of a model asks for the same names."""
    import difflib

    plain = _plain(name)
    same = [c for c in known if _plain(c) == plain and c != name]
    if same:
        return same[0]
    parts = name.split(".")
    paths = {c: c.split(".") for c in known}
    pathwise = [c for c, path in paths.items() if _leaves_out(path, parts) or _leaves_out(parts, path)]
    if pathwise:
        return min(pathwise, key=lambda c: abs(len(paths[c]) - len(parts)))
    near = _nearest(name, known)
    found = difflib.get_close_matches(name, near, n=1, cutoff=0.6)
    if found:
        return found[0]
    by_plain = {_plain(c): c for c in reversed(near)}
    found = difflib.get_close_matches(plain, by_plain, n=1, cutoff=0.7)
    return by_plain[found[0]] if found else None


def _nearest(name: str, known: Sequence[str]) -> Sequence[str]:
    """Return the names that share the most letters with `name`, since a full comparison is slow."""
    if len(known) <= NEAREST:
        return known
    letters = set(_plain(name))
    alike = []
    for k, candidate in enumerate(known):
        other = set(_plain(candidate))
        length = abs(len(candidate) - len(name))
        alike.append((-len(letters & other) / (len(letters | other) or 1), length, k))
    return [known[k] for _, _, k in sorted(sorted(alike)[:NEAREST], key=itemgetter(2))]


def _leaves_out(path: Sequence[str], other: Sequence[str]) -> bool:
    """Whether `path` is `other` with some parts left out."""
    left = iter(other)
    return len(path) < len(other) and path[-1] == other[-1] and all(part in left for part in path)


def did_you_mean(name: str, known: Iterable[str]) -> str | None:
    """Return a remedy with the closest name, or None."""
    found = closest(name, known)
    return None if found is None else f"did you mean `{found}`?"


def meant_argument(name: str, known: Collection[str]) -> str | None:
    """Return a remedy with the argument of `known` that is called `name` elsewhere, or that is most alike."""
    others = ARGUMENTS.get(name)
    if others == ():
        return "leave it out"
    meant = next((other for other in others or () if other in known), None)
    return did_you_mean(name, known) if meant is None else f"write `{meant}`"


def moments(written: Sequence[str], k: int) -> str:
    """Return a remedy for three moments of inertia if number k exceeds the sum of the two others."""
    others = [str(i + 1) for i in range(3) if i != k]
    if all(written[int(i) - 1] == "0" for i in others):
        whole = [written[k] if i == k else f"{written[k]}/2" for i in range(3)]
        return (
            f"the moments {' and '.join(others)} are missing: for a flat body write `inertia = "
            f"{{{', '.join(whole)}}}`"
        )
    return f"make the moments {' and '.join(others)} together at least as large as moment {k + 1}"


def _plain(name: str) -> str:
    return name.lower().replace("_", "")


def is_many_radians(value: float) -> bool:
    """Whether a number without a unit looks like an angle in degrees."""
    return abs(value) >= MANY_RADIANS and float(value).is_integer()


def many_radians(name: str, text: str, sign: str = "", span: Span | None = None) -> Fault:
    """Return the warning of an angle that looks like degrees; `text` is its magnitude."""
    remedy = f"if degrees are meant, write `{text} [deg]`, else `{text} [rad]`"
    return Fault("LAG0618", f"`{name}` is {sign}{text} radians", span, remedy=remedy, severity="warning")


def in_hertz(name: str, remedy: str, span: Span | None = None) -> Fault:
    """Return the warning of an angular velocity whose unit is that of a frequency."""
    message = f"`{name}` is an angular velocity: 1 [Hz] of it is 1 rad/s, not a turn in each second"
    return Fault("LAG0619", message, span, remedy=remedy, severity="warning")
