"""Suggestions: the known name that is most like an unknown one, and the text for a word of another language.

`foreign_words.txt` has these words: one table for each place in a text.
"""

import os
import re
from collections.abc import Collection, Iterable, Sequence
from functools import cache, lru_cache
from operator import itemgetter

from lagc.diagnostics.faults import Fault, Span

LONGEST = 64  # characters of a name that is compared
MOST = 2000  # known names that are looked at
NEAREST = 50  # of them, by their letters, that are compared
MANY_RADIANS = 10  # more than a turn and a half, and in degrees a usual angle
AS_JOINT = (
    "write `joint name = Kind(a, b, ...);`, for example `joint j = Revolute(a, b, axis = world.y, at = P);`"
)
_PLAIN = re.compile(r"(?<![\w])\(([\w.]+(?:\([^()]*\)|\[[^\[\]]*\])?)\)")  # parentheses around one operand
_LONGEST_LINE = 80  # characters of a remedy's line


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
    # From the surest to the least sure: other capitals or signs, a path with a part too few or too many, a
    # few other letters.
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
    """Return whether `path` is `other` with some parts left out."""
    left = iter(other)
    return len(path) < len(other) and path[-1] == other[-1] and all(part in left for part in path)


def did_you_mean(name: str, known: Iterable[str]) -> str | None:
    """Return a remedy with the closest name, or None."""
    found = closest(name, known)
    return None if found is None else f"did you mean `{found}`?"


def meant_argument(name: str, known: Collection[str]) -> str | None:
    """Return a remedy with the argument of `known` that is called `name` elsewhere, or that is most alike."""
    others = foreign("arguments").get(name)
    if others == "":
        return "leave it out"
    meant = next((other for other in (others or "").split(", ") if other in known), None)
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
    """Return whether a number without a unit looks like an angle in degrees."""
    return abs(value) >= MANY_RADIANS and float(value).is_integer()


def many_radians(name: str, text: str, sign: str = "", span: Span | None = None) -> Fault:
    """Return the warning of an angle that looks like degrees; `text` is its magnitude."""
    remedy = f"if degrees are meant, write `{text} [deg]`, else `{text} [rad]`"
    return Fault("LAG0618", f"`{name}` is {sign}{text} radians", span, remedy=remedy, severity="warning")


def in_hertz(name: str, remedy: str, span: Span | None = None) -> Fault:
    """Return the warning of an angular velocity whose unit is that of a frequency."""
    message = f"`{name}` is an angular velocity: 1 [Hz] of it is 1 rad/s, not a turn in each second"
    return Fault("LAG0619", message, span, remedy=remedy, severity="warning")


# -- words of other languages ------------------------------------------------------------------


@cache
def foreign(table: str) -> dict[str, str]:
    """Return a table of `foreign_words.txt`: what to write instead of each word."""
    return _foreign_words()[table]


@cache
def _foreign_words() -> dict[str, dict[str, str]]:
    path = os.path.join(os.path.dirname(__file__), "foreign_words.txt")
    with open(path, encoding="utf-8") as file:
        _, *tables = file.read().replace("\n  ", " ").split("\n== ")
    found: dict[str, dict[str, str]] = {}
    for table in tables:
        title, *rows = table.strip("\n").split("\n")
        words = found[title.partition(":")[0]] = {}
        for row in rows:
            foreign_words, _, text = row.partition(" ==>")
            for word in foreign_words.split(", "):
                words[chr(int(word[2:], 16)) if word.startswith("U+") else word] = text.lstrip()
    return found


def unit_symbol(word: str) -> str:
    """Return the symbol of a unit that is written as a word, `deg` for `Degrees`, or the word itself."""
    words = foreign("unit_words")
    return words.get(word) or words.get(word.lower().rstrip("s"), word)


def looks_like_unit(word: str) -> bool:
    """Return whether a word looks like a unit, maybe with an exponent: `kg`, `s2`, `degrees`."""
    word = word.rstrip("0123456789")
    return word in foreign("units") or unit_symbol(word) != word


def remedy_of(entry: str) -> str:
    """Return the remedy of a table's entry."""
    return entry if "`" in entry else f"write `{entry}`" if entry else "leave it out"


def remedy_of_word(table: str, name: str) -> str | None:
    """Return the remedy for a word of a table, or None."""
    entry = foreign(table).get(name)
    return None if entry is None else remedy_of(entry)


def fill_template(template: str, arguments: Sequence[str]) -> str:
    """Return a template with its arguments; superfluous parentheses are left out.  Raises IndexError."""
    text = _PLAIN.sub(r"\1", template.format(*arguments, all=", ".join(arguments)))
    return re.sub(r"([\d.])\*1 \[", r"\1 [", text)


def foreign_call(name: str, arguments: Sequence[str] = ()) -> str | None:
    """Return the remedy for a call of a function of another language, or None: `sin(30 [deg])` for
    `sind(30)`."""
    template = foreign("calls").get(name)
    if template is None or "`" in template:
        return template
    try:
        line = fill_template(template, arguments)
    except IndexError:
        line = "\n"
    shown = len(line) <= _LONGEST_LINE and "\n" not in line
    return f"write `{line if shown else fill_template(template, 'xyz')}`"


def remedy_of_surplus(name: str, arguments: Sequence[str]) -> str | None:
    """Return the remedy for a call with too many arguments, or None: `der(der(x))` for `der(x, 2)`."""
    template = "der(der({0}))" if name == "der" and arguments[1] == "2" else foreign("surplus").get(name)
    return template and f"write `{fill_template(template, arguments)}`"


def keeps_argument(name: str, k: int) -> bool:
    """Return whether argument number k of a call is written in its remedy: not the `t` of `diff(x, t)`."""
    template = foreign("calls").get(name, "`")
    return "`" in template or f"{{{k}}}" in template or "{all}" in template
