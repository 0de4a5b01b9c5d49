"""Exact values in a finite field: identities vanish, and nothing else does."""

import math
import random
from collections.abc import Callable
from fractions import Fraction

import pytest

from lagc.symbolic.finite_field import P, Point, Undefined, fraction, has_root, turns_of
from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.walk import reachable

IDENTITIES: dict[str, Callable[[Graph, Node, Node, Node], Node]] = {
    "double angle": lambda g, x, y, z: g.sin(2.0 * x) - 2.0 * g.sin(x) * g.cos(x),
    "addition": lambda g, x, y, z: g.cos(x * z - y) - g.cos(x * z) * g.cos(y) - g.sin(x * z) * g.sin(y),
    "half angle": lambda g, x, y, z: 2.0 * g.sin(0.5 * x) ** 2 - 1.0 + g.cos(x),
    "third of an angle": lambda g, x, y, z: g.sin(x) - 3.0 * g.sin(x / 3.0) + 4.0 * g.sin(x / 3.0) ** 3,
    "circle": lambda g, x, y, z: g.sin(x + y) ** 2 + g.cos(y + x) ** 2 - 1.0,
    "steps": lambda g, x, y, z: g.unary("floor", x * y + 2.5) - g.unary("floor", x * y + 0.5) - 2.0,
    "steps down": lambda g, x, y, z: g.unary("floor", x - 0.25) + g.unary("floor", 1.25 - x),
    "whole steps": lambda g, x, y, z: g.unary("floor", x - x * y / y + 7.5) - 7.0,
    "quarter turn": lambda g, x, y, z: g.sin(x + math.pi / 2.0) - g.cos(x),
    "half turn back": lambda g, x, y, z: g.cos(x * y - math.pi) + g.cos(y * x),
    "tangent": lambda g, x, y, z: g.unary("tan", x) * g.cos(x) - g.sin(x),
    "exponential": lambda g, x, y, z: g.unary("exp", x + y) / g.unary("exp", x) - g.unary("exp", y),
    "hyperbola": lambda g, x, y, z: g.unary("cosh", x * y) ** 2 - g.unary("sinh", x * y) ** 2 - 1.0,
    "tanh": lambda g, x, y, z: g.unary("tanh", z) * g.unary("cosh", z) - g.unary("sinh", z),
    "root": lambda g, x, y, z: g.sqrt(x * x + y) * g.sqrt(y + x * x) - x * x - y,
    "inverse root": lambda g, x, y, z: 1.0 / (g.sqrt(x + y) - z) - (g.sqrt(x + y) + z) / (x + y - z * z),
    "power": lambda g, x, y, z: g.pow(x, z + 1.0) - x * g.pow(x, z),
    "power of a number": lambda g, x, y, z: g.pow(x, g.const(2.5)) / g.pow(x, g.const(0.5)) - x * x,
    "the same arguments": lambda g, x, y, z: g.unary("log", x * (y + z)) - g.unary("log", x * y + x * z),
    "quotients": lambda g, x, y, z: 1.0 / (x - y) + 1.0 / (x + y) - 2.0 * x / (x * x - y * y),
    "thirds": lambda g, x, y, z: x / 3.0 + x / 6.0 - 0.5 * x,
    "turns": lambda g, x, y, z: g.cos(math.pi * x) - 1.0 + 2.0 * g.sin(math.pi / 2.0 * x) ** 2,
    "pi": lambda g, x, y, z: math.pi * x + math.pi / 2.0 * x - 1.5 * math.pi * x,
    "decimals with rounding": lambda g, x, y, z: 0.7123456789012345 * x * y - x * y * 1.424691357802469 / 2.0,
    "a turned frame": lambda g, x, y, z: (math.sin(0.3) * x) ** 2 + (math.cos(0.3) * x) ** 2 - x * x,
}  # fmt: skip


def symbols() -> tuple[Graph, Node, Node, Node]:
    g = Graph()
    x, y, z = (g.symbol("coordinate", k) for k in "xyz")
    return g, x, y, z


def values(node: Node, count: int = 6) -> list[int]:
    found = []
    for seed in range(60):
        try:
            found.append(Point(seed).values([node])[0])
        except Undefined:
            continue
    return found[:count]


@pytest.mark.parametrize("name", IDENTITIES)
def test_identities_vanish(name: str) -> None:
    g, x, y, z = symbols()
    node = IDENTITIES[name](g, x, y, z)
    assert node.is_zero or set(values(node)) == {0}


@pytest.mark.sample(6, 12)
@pytest.mark.parametrize("size", [1.0, 1e-12, 1e-300])
@pytest.mark.parametrize("name", IDENTITIES)
def test_what_is_added_to_an_identity_is_seen(name: str, size: float) -> None:
    g, x, y, z = symbols()
    found = values(IDENTITIES[name](g, x, y, z) + size * x * y * g.sin(z))
    assert len(found) == 6 and 0 not in found


@pytest.mark.parametrize("seed", range(20))
def test_values_are_those_of_rational_arithmetic(seed: int) -> None:
    """A random polynomial, multiplied out by hand here with whole numbers."""
    rng = random.Random(seed)
    g, x, y, z = symbols()
    point = Point(seed)
    place = {s: rng.randrange(1, P) for s in (x, y, z)}
    point.place(place)
    node, expected = g.zero, 0
    for _ in range(6):
        c, factors = rng.randint(-9, 9), [rng.choice((x, y, z)) for _ in range(rng.randint(1, 4))]
        term, value = g.const(c), c
        for s in factors:
            term, value = term * s, value * place[s]
        node, expected = node + term, expected + value
    assert point.values([node, node / (x + y)]) == [
        expected % P,
        expected * pow(place[x] + place[y], -1, P) % P,
    ]


def test_a_division_by_zero_has_no_value() -> None:
    g, x, _, _ = symbols()
    with pytest.raises(Undefined):
        Point(1).values([1.0 / (g.sin(2.0 * x) - 2.0 * g.sin(x) * g.cos(x))])


def test_what_is_exact_is_known() -> None:
    g, x, y, _ = symbols()
    for node, exact in ((g.sin(x) * y, True), (g.unary("log", x), False), (0.7123456789012345 * x, False)):
        point = Point(3)
        point.values([node])
        assert point.exact is exact
    point = Point(3, roots=False)
    point.values([g.sqrt(x)])
    assert not point.exact


def test_roots_are_sought() -> None:
    g = Graph()
    places = [g.symbol("coordinate", f"x{i}") for i in range(6)]
    under = [(a - b) ** 2 + 1.0 for i, a in enumerate(places) for b in places[:i]]
    point = Point(5)
    assert point.seek_roots(under, {})
    assert point.values([g.sqrt(u) ** 2 - u for u in under]) == [0] * len(under)


def test_roots_are_sought_within_roots_and_under_powers_of_a_half() -> None:
    """As in a row of contacts: a distance is a root, and so is its distance to the 5/2."""
    g = Graph()
    x, y = ([g.symbol("coordinate", f"{name}{i}") for i in range(30)] for name in "xy")
    apart = [g.sqrt((a - b) ** 2 + (c - d) ** 2) for a, b, c, d in zip(x, x[1:], y, y[1:])]
    pressed = [1.0 - distance for distance in apart]
    powers = [g.binary("pow", u, g.const(2.5)) for u in pressed]
    under = [node.args[0] for node in reachable(powers) if has_root(node)]
    assert len(under) == 2 * len(apart)
    point = Point(5)
    assert point.seek_roots(under, {})
    assert not any(point.values([p**2 - u**5 for p, u in zip(powers, pressed)]))
    assert point.exact and point.rooted
    assert not any(has_root(node) for node in (g.binary("pow", x[0], y[0]), x[0] ** 2, g.one))


@pytest.mark.parametrize("value", [0.1, 1.0 / 3.0, 2.0 / 7.0 * 1e-12, 1e300, 4.0 / 3.0 * 0.07, 9.81])
def test_numbers_are_what_is_meant(value: float) -> None:
    meant = fraction(value)
    assert meant is not None and abs(float(meant) - value) <= 4.0 * math.ulp(value)
    assert len(str(meant.numerator)) + len(str(meant.denominator)) < 330


def test_numbers_with_rounding_in_them_are_none() -> None:
    assert fraction(math.sqrt(2.0)) is None and fraction(math.inf) is None


@pytest.mark.parametrize("seed", range(4))
def test_numbers_of_any_size_are_no_angles(seed: int) -> None:
    """Multiples of pi are what they are; no other number is met for one, however large."""
    rng = random.Random(seed)
    for _ in range(2000):
        value = rng.uniform(-1.0, 1.0) * 10.0 ** rng.uniform(-20.0, 300.0)
        assert turns_of(value) is None
        assert turns_of(float(f"{value:.8e}")) is None
        turns = Fraction(rng.randint(-720, 720), rng.randint(1, 180))
        assert turns_of(float(turns) * math.pi) == (turns or None)


@pytest.mark.parametrize("size", [1e8, 1.1e11, 3.844e11, 1.495978707e11, 3.986e14, 2.1e11, 1e20])
def test_identities_between_large_numbers_vanish(size: float) -> None:
    _, x, y, _ = symbols()
    a, b = 3.0 * size, size
    point = Point(2)
    assert point.values([(x + a) * y - (x + b) * y - (a - b) * y]) == [0] and point.exact


def test_numbers_of_any_size_have_a_value() -> None:
    """Also those whose products and quotients are beyond all that a double holds, and what is no number."""
    chance = random.Random(4)
    _, x, y, _ = symbols()
    for seed in range(200):
        sizes = [chance.choice((-1.0, 1.0)) * math.ldexp(0.5 + chance.random(), chance.randrange(-1100, 1024))
                 for _ in range(8)]  # fmt: skip
        nodes = [a * x + y for a in (*sizes, 5e-324, 1.7e308, math.inf, -math.inf, math.nan) if a]
        assert all(0 <= value < P for value in Point(seed).values(nodes))
