"""Units as people write them: `Nm`, `kgm2`, `Kg`, `°`, `N·m`, `m s^-2`, `meters`; the unit that is meant."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from functools import lru_cache
from itertools import islice, product

from lagc.diagnostics.suggest import foreign, unit_symbol
from lagc.semantics.units import BROKEN, SYMBOLS, Dimension, UnknownUnit, unit

_SIGNS = str.maketrans({**dict.fromkeys("·⋅×∙•", "."), "−": "-", "⁻": "-", "º": "°", "μ": "u", "^": ""})
_WORD = re.compile(r"[^\W\d_]+|[%°]+")
_POWERS = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹", "0123456789")
_COMMON = ("kg", "mm", "cm", "km", "ms", "kN", "kHz", "mN", "MPa", "GPa", "kPa", "kJ", "kW", "mrad")
_PIECES = ("kg", "N", "m", "s", "rad", "J", "W", "K", "A", "V", "Pa", "g", "mm", "cm", "km", "kN", "Hz")
_MOST = 2000  # spellings that are tried
_LONGEST = 40


def unit_remedy(text: str, wanted: Dimension | None = None) -> str | None:
    """Return the remedy for a text that is not a unit, or None."""
    if BROKEN.search(text):
        return "raise a pure number to that power: `k*(x/(1 [m]))^1.5`, with k in newtons"
    value = foreign("unit_values").get(text.strip())
    if value is not None:
        known = f"write it in a unit of the language: 1 {text.strip()} is `{value}`"
        return value if "`" in value else known
    for needed in dict.fromkeys((wanted, None)):
        if (meant := meant_unit(text, needed)) is not None:
            return f"write `[{meant}]`"
        if (close := meant_unit(text, needed, _close)) is not None:
            return f"did you mean `[{close}]`?"
    return None


def meant_unit(
    text: str, wanted: Dimension | None = None, meanings: Callable[[str], Iterator[str]] | None = None
) -> str | None:
    """Return the unit, of dimension `wanted` if it is given, that a text means, or None.  `meanings` yields
    the symbols that a word may mean."""
    if len(text) > _LONGEST:
        return None
    meanings = meanings or _meanings
    plain = re.sub(r"\*\*", "^", text.strip()).translate(_SIGNS).translate(_POWERS)
    plain = re.sub(r"\s*(\bper\b|/)\s*", "/", plain)
    plain = re.sub(r"\s*[.*]\s*|\s+|(?<=[A-Za-z])-(?=[A-Za-z])", ".", plain)
    words = list(_WORD.finditer(plain))
    for chosen in islice(product(*(tuple(meanings(word[0])) for word in words)), _MOST):
        spelled, at = "", 0
        for word, symbol in zip(words, chosen):
            spelled, at = spelled + plain[at : word.start()] + symbol, word.end()
        spelled += plain[at:]
        try:
            found = unit(spelled)
        except UnknownUnit:
            continue
        if wanted is None or found.dimension == wanted:
            return spelled
    return None


def _meanings(word: str) -> Iterator[str]:
    """Yield the symbols that a word may mean, the likeliest first."""
    if _is_unit(word):
        yield word
    plain = word.lower()
    yield unit_symbol(word)
    for prefix, short in foreign("unit_prefixes").items():
        if plain.startswith(prefix):
            yield short + unit_symbol(plain.removeprefix(prefix))
    yield from (symbol for symbol in (*_COMMON, *SYMBOLS) if symbol.lower() in (plain, plain.rstrip("s")))
    yield from sorted(_products(word), key=_unlikely)[:4]


def _close(word: str) -> Iterator[str]:
    """Yield the symbols that are most like a word."""
    import difflib

    if _is_unit(word):
        yield word
    yield from difflib.get_close_matches(word, [*_COMMON, *SYMBOLS], n=6, cutoff=0.5)


@lru_cache(maxsize=64)
def _products(word: str) -> Sequence[str]:
    """Return the products that a word may be: `N.m.s` and `N.ms` for `Nms`."""
    found = []
    for piece in _PIECES:
        if word.startswith(piece) and word != piece:
            rest = word[len(piece) :]
            others = (*_products(rest), *([rest] if rest in _PIECES else []))
            found += [f"{piece}.{other}" for other in others]
    return tuple(found)


def _unlikely(written: str) -> float:
    """Return how unlikely a product is: by its factors, prefixes, and factors that come twice."""
    parts = written.split(".")
    prefixed = sum(part in ("mm", "cm", "km", "kN", "g") for part in parts)
    return len(parts) + 1.5 * prefixed + 3 * (len(parts) - len(set(parts)))


def _is_unit(word: str) -> bool:
    try:
        unit(word)
    except UnknownUnit:
        return False
    return True
