"""What is claimed to be conserved or cyclic is: symmetries that are planted are found and proved, and
what breaks them is seen wherever it hides."""

import math
import random
from collections.abc import Callable

import pytest

from lagc.mechanics.analysis.analysis import Analysis, analyse
from lagc.mechanics.derive import derive
from lagc.symbolic.graph import Node
from tests.mechanics.builder import Builder

Breaker = Callable[[Builder, Node, random.Random], Node]


def swarm(
    rng: random.Random, potential: Callable[[Builder, list[Node], list[Node]], Node]
) -> tuple[Builder, list[list[Node]]]:
    """Two or three particles in space, with forces between pairs of them only."""
    b = Builder()
    places = []
    for i in range(rng.randint(2, 3)):
        places.append([b.coordinate(f"{k}{i}", rng.uniform(-1.0, 1.0)) for k in "xyz"])
        b.particle(f"p{i}", b.parameter(f"m{i}", rng.uniform(0.5, 2.0)), places[i])
    for i, p in enumerate(places):
        for j, q in enumerate(places[:i]):
            b.potential(f"V{i}{j}", b.parameter(f"k{i}{j}", rng.uniform(0.5, 2.0)) * potential(b, p, q))
    return b, places


def gap(b: Builder, p: list[Node], q: list[Node]) -> Node:
    return b.graph.sum((x - y) ** 2 for x, y in zip(p, q))


POTENTIALS: dict[str, Callable[[Builder, list[Node], list[Node]], Node]] = {
    "springs": lambda b, p, q: (b.graph.sqrt(gap(b, p, q)) - 0.3) ** 2,
    "gravitation": lambda b, p, q: -1.0 / b.graph.sqrt(gap(b, p, q)),
    "smooth": lambda b, p, q: b.graph.unary("exp", -gap(b, p, q)),
    "logarithm": lambda b, p, q: b.graph.unary("log", 1.0 + gap(b, p, q)),
    "stops": lambda b, p, q: b.graph.binary("max", 0.0 * p[0] + b.graph.const(0.0), gap(b, p, q) - 2.0) ** 2,
    "switched": lambda b, p, q: gap(b, p, q) + b.graph.select(
        b.graph.binary("lt", gap(b, p, q), b.graph.const(40.0)), b.graph.zero, (gap(b, p, q) - 40.0) ** 3
    ),
}  # fmt: skip
TOTALS = [f"{head}().{axis}" for head in ("momentum", "angular_momentum") for axis in "xyz"]


def facts(a: Analysis) -> dict[str, bool]:
    return {c.name: c.proved for c in a.conserved}


@pytest.mark.parametrize("name", POTENTIALS)
def test_forces_between_pairs_keep_all_momenta(name: str) -> None:
    b, _ = swarm(random.Random(name), POTENTIALS[name])
    found = facts(analyse(derive(b.model())))
    assert found == dict.fromkeys(["energy", *TOTALS], True)


# What breaks a symmetry along x, with the function of x that says how.
def far_step(b: Builder, x: Node, rng: random.Random) -> Node:
    edge = b.graph.const(rng.choice([3.0, 50.0, 1e6]))
    return b.graph.select(b.graph.binary("lt", edge, x), x - edge, b.graph.zero)


def far_stop(b: Builder, x: Node, rng: random.Random) -> Node:
    return b.graph.binary("max", b.graph.zero, x - rng.choice([5.0, 1e3])) ** 2


def far_well(b: Builder, x: Node, rng: random.Random) -> Node:
    return b.graph.unary("exp", -((x - rng.choice([40.0, 300.0])) ** 2))


def tiny(b: Builder, x: Node, rng: random.Random) -> Node:
    return rng.choice([1e-12, 1e-30, 1e-200]) * b.graph.sin(x)


def beyond_a_stop(b: Builder, x: Node, rng: random.Random) -> Node:
    return b.graph.unary("abs", x - 7.0) - b.graph.unary("abs", x - 9.0) + 2.0 * b.graph.unary("abs", x - 8.0)


def both_conditions(b: Builder, x: Node, rng: random.Random) -> Node:
    g = b.graph
    inside = g.binary("and", g.binary("lt", g.const(11.0), x), g.binary("lt", x, g.const(12.0)))
    return g.select(inside, (x - 11.0) ** 2 * (x - 12.0) ** 2, g.zero)


def half_of_a_line(b: Builder, x: Node, rng: random.Random) -> Node:
    return b.graph.sqrt((x - 20.0) ** 2) - (20.0 - x)


def stairs(b: Builder, x: Node, rng: random.Random) -> Node:
    steps = 0.01 * x + 0.5
    return b.graph.unary("floor", steps) * b.graph.sin(math.pi * steps) ** 2


BREAKERS: list[Breaker] = [
    half_of_a_line, stairs, far_step, far_stop, far_well, tiny, beyond_a_stop, both_conditions,
]  # fmt: skip


@pytest.mark.sample(6, 12)
@pytest.mark.parametrize("as_force", [False, True], ids=["potential", "force"])
@pytest.mark.parametrize("breaker", BREAKERS)
@pytest.mark.parametrize("kind", ["springs", "smooth", "gravitation"])
def test_what_breaks_a_symmetry_is_seen(kind: str, breaker: Breaker, as_force: bool) -> None:
    rng = random.Random(f"{kind} {breaker.__name__} {as_force}")
    b, places = swarm(rng, POTENTIALS[kind])
    push = breaker(b, places[0][0], rng)
    if as_force:
        b.force("breaker", (push, 0.0, 0.0), places[0])
    else:
        b.potential("breaker", push)
    found = facts(analyse(derive(b.model())))
    assert not {"momentum().x", "angular_momentum().y", "angular_momentum().z"} & found.keys()
    assert ("energy" in found) != as_force
    assert found["momentum().y"] and found["momentum().z"] and found["angular_momentum().x"]


@pytest.mark.parametrize("breaker", BREAKERS)
def test_what_breaks_a_cyclic_coordinate_is_seen(breaker: Breaker) -> None:
    b = Builder()
    rng = random.Random(breaker.__name__)
    r, phi = b.coordinate("r", 1.0), b.coordinate("phi")
    g = b.graph
    b.particle("p", b.parameter("m"), (r * g.cos(phi), r * g.sin(phi), 0.0))
    b.potential("spring", 0.5 * (r - 1.0) ** 2)
    a = analyse(derive(b.model()))
    assert a.cyclic == ("phi",) and not a.seems.cyclic
    assert facts(a) == {"energy": True, "momentum(phi)": True, "angular_momentum().z": True}
    b.potential("breaker", breaker(b, phi, rng))
    a = analyse(derive(b.model()))
    assert a.cyclic == () and facts(a) == {"energy": True}


def test_a_tiny_push_on_one_of_many_is_seen() -> None:
    """Seven planets, twenty-one roots."""
    for push in (0.0, 1e-12):
        b = Builder()
        g = b.graph
        places = [
            [b.coordinate(f"{k}{i}", (1.0 + i) ** (0.5 + n)) for n, k in enumerate("xy")] for i in range(7)
        ]
        for i, p in enumerate(places):
            b.particle(f"p{i}", b.parameter(f"m{i}", 1.0 + i), (*p, 0.0))
            for j, q in enumerate(places[:i]):
                b.potential(f"V{i}{j}", -1.0 / g.sqrt(gap(b, p, q)))
        if push:
            b.potential("push", push * places[3][0])
        found = facts(analyse(derive(b.model())))
        kept = ["momentum().y"] if push else ["momentum().x", "momentum().y", "angular_momentum().z"]
        assert found == dict.fromkeys(["energy", *kept], True)


def test_friction_behind_a_condition_takes_energy() -> None:
    for c in (1.0, 1e-12):
        b = Builder()
        g = b.graph
        x, y = b.coordinate("x"), b.coordinate("y")
        b.particle("p", b.parameter("m"), (x, y, 0.0))
        rough = g.select(g.binary("lt", g.const(100.0), x), g.const(c), g.zero)
        b.force("friction", (-rough * b.der(x), 0.0, 0.0), (x, y, 0.0))
        assert facts(analyse(derive(b.model()))) == {"momentum(y)": True, "momentum().y": True}


def test_conditions_on_parameters_are_decided_by_their_values() -> None:
    b = Builder()
    g = b.graph
    x = b.coordinate("x")
    b.particle("p", b.parameter("m"), (x, 0.0, 0.0))
    on = g.binary("lt", g.const(0.5), b.parameter("switch", 0.0))
    b.force("push", (g.select(on, g.one, g.zero), 0.0, 0.0), (x, 0.0, 0.0))
    assert facts(analyse(derive(b.model())))["momentum(x)"]


def test_what_only_numbers_show_seems_so() -> None:
    """log(u v) = log u + log v is no relation that is used: the force vanishes, it seems."""
    b = Builder()
    g = b.graph
    x, y = b.coordinate("x"), b.coordinate("y")
    b.particle("p", b.parameter("m"), (x, y, 0.0))
    u, v = 1.0 + x * x, 2.0 + x * x
    hidden = g.unary("log", u * v) - g.unary("log", u) - g.unary("log", v)
    b.force("hidden", (hidden, 0.0, 0.0), (x, y, 0.0))
    found = facts(analyse(derive(b.model())))
    assert found["momentum(x)"] is False and found["momentum(y)"] is True


def test_a_multiplier_that_is_nothing_pulls_nothing() -> None:
    """A particle on a plane without weight: the plane does not push, all along it is kept."""
    b = Builder()
    x, y, z = (b.coordinate(k) for k in "xyz")
    b.particle("p", b.parameter("m"), (x, y, z))
    b.constraint("plane", x + 2.0 * y - z)
    found = facts(analyse(derive(b.model())))
    assert found == dict.fromkeys(["energy", *TOTALS], True)


def test_a_loop_that_closes_for_nothing_too_is_not_taken_for_that() -> None:
    """A parallelogram closes for lengths of zero whatever its angles; the motion is of another kind."""
    b = Builder()
    g = b.graph
    one, two, three = (b.coordinate(f"q{k}", s, unit="rad") for k, s in enumerate((0.7, 0.0, 0.7)))
    length, base = b.parameter("l", 1.0), b.parameter("b", 2.0)
    for k, angle in enumerate((one, two, three)):
        b.particle(f"p{k}", g.one, (length * g.cos(angle), length * g.sin(angle), 0.0))
    b.force("push", (one, 0.0, 0.0), (length * g.cos(one), length * g.sin(one), 0.0))
    x = length * g.cos(one) + base * g.cos(two) - base - length * g.cos(three)
    b.constraint("loop", x, length * g.sin(one) + base * g.sin(two) - length * g.sin(three))
    assert facts(analyse(derive(b.model()))) == {}


@pytest.mark.sample(4)
@pytest.mark.parametrize("push", [0.0, 1e-13, 1e-200])
@pytest.mark.parametrize("squared", [False, True])
def test_rods_hold_where_it_is_asked(squared: bool, push: float) -> None:
    """A triangle of rods keeps all its momenta, given as lengths or squares, and a tiny push is seen."""
    b = Builder()
    g = b.graph
    starts = ((0.1, 0.2, 0.3), (1.1, 0.4, 0.2), (0.5, 1.2, 0.6))
    places = [[b.coordinate(f"{k}{i}", x) for k, x in zip("xyz", at)] for i, at in enumerate(starts)]
    for i, place in enumerate(places):
        b.particle(f"p{i}", b.parameter(f"m{i}", 1.0 + i), place)
        for j in range(i):
            square, length = gap(b, place, places[j]), b.parameter(f"l{i}{j}")
            b.constraint(f"rod{i}{j}", square - length**2 if squared else g.sqrt(square) - length)
    if push:
        b.force("push", (push * places[0][1], 0.0, 0.0), places[0])
    found = facts(analyse(derive(b.model())))
    if push:
        assert found == dict.fromkeys(["momentum().y", "momentum().z", "angular_momentum().x"], True)
    else:
        assert found == dict.fromkeys(["energy", *TOTALS], True)


@pytest.mark.parametrize("push", [0.0, 1e-12])
@pytest.mark.parametrize("count", [3, 5])
def test_many_conditions_are_seen_all(count: int, push: float) -> None:
    """Particles that touch each other, up to ten conditions: all momenta are kept, and a push behind
    one of them is seen."""
    b = Builder()
    g = b.graph
    places = [[b.coordinate(f"{k}{i}", 0.3 * i + 0.1 * n) for n, k in enumerate("xy")] for i in range(count)]
    for i, p in enumerate(places):
        b.particle(f"p{i}", b.parameter(f"m{i}", 1.0 + i), (*p, 0.0))
        for j, q in enumerate(places[:i]):
            depth = g.binary("max", g.zero, 0.5 - g.sqrt(gap(b, p, q)))
            b.potential(f"V{i}{j}", 1e3 * depth**2)
    if push:
        x = places[-1][0]
        b.force("push", (push * g.binary("max", g.zero, x - 50.0), 0.0, 0.0), (*places[-1], 0.0))
    found = facts(analyse(derive(b.model())))
    kept = ["momentum().y"] if push else ["energy", "momentum().x", "momentum().y", "angular_momentum().z"]
    assert found == dict.fromkeys(kept, True)


@pytest.mark.parametrize("kind", ["input", "jump in time", "time"])
def test_a_potential_that_is_no_stored_energy_is_in_the_lagrangian(kind: str) -> None:
    b = Builder()
    g = b.graph
    x, y = b.coordinate("x", 0.5), b.coordinate("y", 0.5)
    b.particle("p", b.parameter("m"), (x, y, 0.0))
    jump = g.select(g.binary("lt", b.time, g.const(1e5)), g.one, g.const(2.0))
    gain = {"input": b.input("k", 1.0), "jump in time": jump, "time": g.sin(b.time)}[kind]
    b.potential("V", gain * x**2)
    a = analyse(derive(b.model()))
    assert a.cyclic == ("y",)
    assert facts(a) == {"momentum(y)": True, "momentum().y": True}


@pytest.mark.parametrize(
    "terms", [(0.1, 0.2, -0.3), (0.7, 0.1, -0.8), (1.1, 2.2, -3.3), (0.1,) * 10 + (-1.0,)]
)
def test_numbers_that_cancel_in_decimals_leave_nothing(terms: tuple[float, ...]) -> None:
    """Springs along x whose rates add up to none: in binary numbers rounding would be left."""
    b = Builder()
    x, y = b.coordinate("x", 0.5), b.coordinate("y", 0.5)
    b.particle("p", b.parameter("m"), (x, y, 0.0))
    for k, c in enumerate(terms):
        b.potential(f"V{k}", c * x)
    a = analyse(derive(b.model()))
    assert a.cyclic == ("x", "y") and not a.seems.cyclic and facts(a)["momentum(x)"]


CUTS: dict[str, Callable[[Builder, Node, Node], tuple[Node, bool]]] = {
    "angle": lambda b, x, y: (b.graph.binary("atan2", y, x), True),
    "spring": lambda b, x, y: ((b.graph.binary("atan2", y, x) - 0.3) ** 2, True),
    "turned": lambda b, x, y: (b.graph.cos(3.0 * b.graph.binary("atan2", x - y, x + y)), False),
    "half turned": lambda b, x, y: (b.graph.sin(0.5 * b.graph.binary("atan2", x, y)), True),
    "difference": lambda b, x, y: (
        b.graph.binary("atan2", y, x) - b.graph.binary("atan2", y, x - 1.0), True
    ),
    "of parameters": lambda b, x, y: (x * b.graph.binary("atan2", b.parameter("p"), b.parameter("r")), False),
}  # fmt: skip


@pytest.mark.parametrize("name", CUTS)
def test_a_cut_that_a_quantity_jumps_at_is_named(name: str) -> None:
    b = Builder()
    x, y = b.coordinate("x", 0.5), b.coordinate("y", 0.2)
    b.particle("p", b.parameter("m"), (x, y, 0.0))
    potential, jumps = CUTS[name](b, x, y)
    b.potential("V", potential)
    (energy,) = [c for c in analyse(derive(b.model())).conserved if c.name == "energy"]
    assert ("atan2" in energy.reason) is jumps


HIDDEN: dict[str, Callable[[Builder, Node], Node]] = {
    "folded angle": lambda b, u: b.graph.unary("asin", b.graph.sin(u)) - u,
    "folded cosine": lambda b, u: b.graph.sqrt(1.0 - b.graph.sin(u) ** 2) - b.graph.cos(u),
    "spelt out": lambda b, u: b.graph.sqrt(u * u - 6.0 * u + 9.0) - (3.0 - u),
    "in parts": lambda b, u: b.graph.sqrt(u * u - 5.0 * u + 6.25) + b.graph.sqrt(u * u + 1.0) ** 2
    - (2.5 - u) - u * u - 1.0,
}  # fmt: skip


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("along", ["x", "time"])
@pytest.mark.parametrize("name", HIDDEN)
def test_a_root_that_bends_far_away_is_seen(name: str, along: str, seed: int) -> None:
    """Zero beside the start, by roots of squares that are not written as such, and not beyond."""
    b = Builder()
    x, y = b.coordinate("x", random.Random(seed).uniform(-0.3, 0.3)), b.coordinate("y", 0.3)
    b.particle("p", b.parameter("m"), (x, y, 0.0))
    b.force("hidden", (HIDDEN[name](b, x if along == "x" else b.time), 0.0, 0.0), (x, y, 0.0))
    found = facts(analyse(derive(b.model())))
    assert found == {"momentum(y)": True, "momentum().y": True}


@pytest.mark.parametrize("count", [3, 9, 14])
def test_what_only_one_of_many_branches_breaks_is_seen(count: int) -> None:
    """A push, and a row, that are there where many conditions hold and as many do not."""
    for as_row in (False, True):
        b = Builder()
        g = b.graph
        places = [b.coordinate(f"x{k}") for k in range(count)]
        for k, x in enumerate(places):
            b.particle(f"p{k}", g.one, (x, 0.0, 0.0))
        y, z = b.coordinate("y"), b.coordinate("z")
        b.particle("p", g.one, (0.0, y, z))
        corner = g.one
        for k, x in enumerate(places):
            corner = (
                corner * g.binary(*(("max", x - 10.0, g.zero) if k % 2 else ("min", x + 10.0, g.zero))) ** 2
            )
        if as_row:
            b.constraint("row", b.der(y) - b.der(z))
            b.constraint("bent", b.der(y) - (1.0 + corner) * b.der(z))
        else:
            b.force("push", (0.0, corner, 0.0), (0.0, y, z))
        e = derive(b.model())
        assert len(e.rows) == (2 if as_row else 0)
        if not as_row:
            assert not {"momentum(y)", "momentum().y"} & facts(analyse(e)).keys()
