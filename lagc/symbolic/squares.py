"""c x sin(u)^2 + c x cos(u)^2 = c x, on monomials of nodes or of whatever else has sines and cosines."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import Any, TypeVar

Base = TypeVar("Base")


def exchanged(
    monomial: Iterable[tuple[Base, Any]], twin: Callable[[Base, Any], Base | None]
) -> Iterator[tuple[dict[Base, Any], Base]]:
    """For each factor of `monomial` that has a `twin`, cos(u) for a power of sin(u) and sin(u) for one of
    cos(u): x, the monomial without its square, and the twin.  Exponents are integers or fractions, 0 where
    a factor is gone."""
    powers = dict(monomial)
    for base, exponent in powers.items():
        other = twin(base, exponent)
        if other is not None:
            yield {**powers, base: exponent - 2}, other
